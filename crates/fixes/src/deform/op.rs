//! The op of fix deform: sets the box at each step and moves the particles with it.

use super::Remap;
use super::lean::{self, Lean};
use super::track::{self, Track};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::par;
use perigrain_plan::{About, Needs, Op, Span, Stage, Tick, When};
use perigrain_styles::common::check_flat;
use perigrain_styles::near::{bonds_across, bonds_fit};
use perigrain_world::domain::Flow;
use perigrain_world::field::{BONDS, BOX, FAMILIES, LISTS, MASK, MEMO, SLOTS, TAG, X};
use perigrain_world::{Domain, Fields, GroupId, Numbers, World};

/// The box at a step.
pub struct Shape {
    lo: [f64; 3],
    hi: [f64; 3],
    tilt: [f64; 3],
    /// Rates of the lengths.
    rate: [f64; 3],
    /// Rates of the tilts.
    turning: [f64; 3],
}

impl Shape {
    pub fn at(tracks: &[Track; 3], leans: &[Lean; 3], w: &World, t: &Tick) -> Result<Self> {
        let (lo, hi, rate) = track::faces(tracks, w, t)?;
        let (tilt, turning) = lean::tilts(leans, w, t, [0, 1, 2].map(|d| hi[d] - lo[d]))?;
        Ok(Self { lo, hi, tilt, rate, turning })
    }

    /// Velocity gradient for periodic images and for particles that cross faces. LAMMPS uses the rates of
    /// compute temp/deform.
    pub fn flow(
        &self,
        tracks: &[Track; 3],
        leans: &[Lean; 3],
        (w, group): (&World, GroupId),
        first: bool,
    ) -> Flow {
        if w.settings.lammps() {
            let [rate, _, tilt] = self.streaming(tracks, leans, w, first);
            return Flow { rate, tilt, group };
        }
        Flow { rate: self.rate, tilt: self.turning, group }
    }

    /// Rates of lengths, lower faces and tilts for compute temp/deform.
    pub fn streaming(&self, tracks: &[Track; 3], leans: &[Lean; 3], w: &World, first: bool) -> [[f64; 3]; 3] {
        let lengths = [0, 1, 2].map(|d| self.hi[d] - self.lo[d]);
        let [rate, low] = track::streaming(tracks, w, (self.rate, lengths), first);
        [rate, low, lean::streaming(leans, w, self.turning, first)]
    }
}

/// Stores the rates of lengths, lower faces and tilts in the world.
pub fn store_streaming(w: &mut World, key: Numbers, [rate, low, turning]: [[f64; 3]; 3], remap: Remap) {
    let remapped = f64::from(u8::from(remap == Remap::Positions));
    let row = w.memo.get_or(key, Vec::new);
    row.clear();
    row.extend(rate.into_iter().chain(low).chain([remapped]).chain(turning));
}

/// Moves the faces.
pub struct Move {
    /// Name of the op.
    pub name: String,
    /// Key of the stored rates.
    pub stretch: Numbers,
    /// Motion of the faces.
    pub tracks: [Track; 3],
    /// Motion of the tilts.
    pub leans: [Lean; 3],
    /// Whether a box that tilts too far is flipped.
    pub flips: bool,
    /// What moves with the box.
    pub remap: Remap,
    /// The particles that move with it.
    pub group: GroupId,
    /// Steps at which the faces move.
    pub when: When,
    /// Whether peridynamic bonds cross faces whose edges change.
    pub crossed: bool,
}

impl Move {
    /// Whether images move otherwise than particles, along edges whose tilt changes.
    fn turns_images(&self) -> bool {
        self.remap == Remap::Velocities && self.leans.iter().any(Lean::moves)
    }

    /// Which edges change.
    fn changes(&self) -> [bool; 3] {
        let mut changes = self.tracks.each_ref().map(Track::moves);
        for (k, _) in self.leans.iter().enumerate().filter(|(_, lean)| lean.moves()) {
            changes[lean::ACROSS[k]] = true;
        }
        changes
    }

    /// In the setup of a run: finds the bonds through the faces, and checks that they are allowed.
    fn begin(&mut self, w: &mut World) -> Result<()> {
        if self.turns_images() && !w.bonds.is_empty() {
            // The damping of a bond has no access to the image it leads to, nor to its velocity.
            let text = "bonds do not go with tilts that change with `remap v`";
            return Err(Diagnostic::error(Code::NOT_SUPPORTED, None, text).help("`remap x` will do").into());
        }
        let along = self.remap == Remap::Positions;
        self.crossed = bonds_across(w, self.changes(), along)?.is_some();
        if self.crossed && self.flips && self.leans.iter().any(Lean::moves) {
            let text = "peridynamic bonds cross periodic faces: the box cannot flip";
            let help = "use `flip no`: bonds go by the edges of the box at the first run";
            return Err(Diagnostic::error(Code::NOT_SUPPORTED, None, text).help(help).into());
        }
        Ok(())
    }

    /// Moves particles affinely from the box `before` to the new one; in a `flat` scene within their plane.
    fn carry(&self, w: &mut World, [before, domain]: [&Domain; 2], flat: bool) {
        let (mut places, bit) = (std::mem::take(&mut w.particles.x), self.group.bit());
        let tilted = before.tilted() || domain.tilted();
        let (from, length, to) = (before.lo, before.lengths(), domain.lengths());
        let place = |x: &mut [f64; 3]| {
            if tilted {
                let z = x[2];
                *x = domain.at(before.fractions(x));
                if flat {
                    x[2] = z;
                }
                return;
            }
            // Fractional coordinates, then positions in the new box: unchanged dimensions keep their bits.
            for d in (0..if flat { 2 } else { 3 }).filter(|&d| self.tracks[d].moves()) {
                x[d] = (x[d] - from[d]) / length[d] * to[d] + domain.lo[d];
            }
        };
        let world: &World = w;
        par::each((&mut places[..], &world.particles.mask[..]), |first, (x, mask)| {
            let own = world.moved_in(first..first + mask.len()).flatten().map(|row| row - first);
            own.filter(|k| mask[*k] & bit != 0).for_each(|k| place(&mut x[k]));
        });
        w.particles.x = places;
    }
}

impl Op for Move {
    fn about(&self) -> About {
        let of = |there: bool, field: Fields| if there { field } else { Fields::NONE };
        let needs = Needs::new()
            .read(TAG | MASK | SLOTS | FAMILIES | of(self.turns_images(), BONDS))
            .write(X | BOX | of(self.flips, LISTS))
            .keep(MEMO);
        let about = About::new(&self.name, Stage::EndOfStep, needs);
        About { when: self.when.clone(), in_setup: true, ..about }
    }

    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let shape = Shape::at(&self.tracks, &self.leans, w, t)?;
        store_streaming(w, self.stretch, shape.streaming(&self.tracks, &self.leans, w, t.setup), self.remap);
        let flow = shape.flow(&self.tracks, &self.leans, (w, self.group), t.setup);
        let Shape { lo, hi, tilt, .. } = shape;
        // Particles of a flat scene stay in their plane.
        let flat = w.settings.two_dimensional && !w.settings.lammps();
        if self.remap == Remap::Velocities
            && let Some(domain) = &mut *w.domain
        {
            domain.flow = Some(flow);
        }
        if t.setup {
            return self.begin(w);
        }
        let Some(domain) = &mut *w.domain else { return Ok(()) };
        let before = domain.clone();
        check_flat(domain.boundary, (lo[2], hi[2]), flat)?;
        (domain.lo, domain.hi) = (lo, hi);
        if domain.tilt.is_some() {
            domain.tilt = Some(tilt);
        }
        let edges = domain.periods();
        if self.crossed {
            bonds_fit(w, &edges)?;
        }
        let Some(domain) = &mut *w.domain else { return Ok(()) };
        if self.flips {
            domain.flip = lean::flip(domain);
            if domain.flip.is_some() {
                w.rebuild.due = true;
            }
        }
        if self.remap == Remap::Positions {
            let now = domain.clone();
            self.carry(w, [&before, &now], flat);
        }
        Ok(())
    }

    fn span(&mut self, _: &mut World, t: &Tick) -> Span {
        // The setup inspects all bonds to find those through the faces.
        if t.setup { Span::All } else { Span::Own }
    }

    fn finish(&mut self, w: &mut World) -> Result<()> {
        w.domain.iter_mut().for_each(|d| d.flow = None);
        Ok(())
    }
}
