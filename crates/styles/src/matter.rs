//! What many styles need to know about particles: the members of a group, their masses, their unwrapped places.

use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::par::{self, add};
use perigrain_plan::Tick;
use perigrain_world::{AtomStyle, Compat, GroupId, Key, Region, SlotId, Vectors, World};

/// The mass of each particle: its own where the atom style has one, else its type's.
#[derive(Clone, Copy)]
pub enum Masses<'a> {
    /// Each its own.
    Own(&'a [f64]),
    /// By type (from 1).
    ByType(&'a [u16], &'a [Option<f64>]),
}

impl<'a> Masses<'a> {
    /// The masses of a world's particles.
    pub fn of(w: &'a World) -> Self {
        let p = &w.particles;
        Self::new(p.style, &p.mass, &p.kind, &w.type_mass)
    }

    /// As `of`, where the world is borrowed in parts.
    pub fn new(style: AtomStyle, own: &'a [f64], kind: &'a [u16], by_type: &'a [Option<f64>]) -> Self {
        if style.own_mass() { Self::Own(own) } else { Self::ByType(kind, by_type) }
    }

    /// The mass of particle `i`; NaN where its type has none, which [`check_masses`] rules out.
    #[inline]
    pub fn get(&self, i: usize) -> f64 {
        match self {
            Self::Own(mass) => mass[i],
            Self::ByType(kind, table) => {
                table.get(usize::from(kind[i]) - 1).copied().flatten().unwrap_or(f64::NAN)
            }
        }
    }
}

/// I / (m R²) of a solid sphere.
const SPHERE: f64 = 0.4;

/// Whether spheres count with their own inertia and spin where moments of several particles are added up; LAMMPS 22Jul2025 takes them for
/// points.
pub fn solid(w: &World) -> bool {
    w.particles.style.sphere && w.settings.compat != Compat::Lammps2025
}

/// The moment of inertia of particle `i`, of mass `m`, about its own centre [mass length²].
pub fn own_inertia(w: &World, i: usize, m: f64) -> f64 {
    let r = w.particles.radius[i];
    SPHERE * m * r * r
}

/// Checks that every particle has a mass.
///
/// # Errors
/// A type in use without `mass`.
pub fn check_masses(w: &World, span: Span) -> Result<()> {
    if w.particles.style.own_mass() {
        return Ok(());
    }
    let without = |k: &&u16| w.type_mass.get(usize::from(**k).wrapping_sub(1)).copied().flatten().is_none();
    match w.particles.kind.iter().find(without) {
        None => Ok(()),
        Some(k) => Err(Diagnostic::error(Code::INCOMPLETE, span, format!("atom type {k} has no mass"))
            .help(format!("write `mass {k} …` before the run"))
            .into()),
    }
}

/// How many particles belong to a group.
pub fn count(w: &World, group: GroupId) -> usize {
    let (mask, bit) = (&w.particles.mask, group.bit());
    par::reduce(mask.len(), |r| r.filter(|&i| mask[i] & bit != 0).count(), |a, b| a + b).unwrap_or(0)
}

/// Adds up `term(i)` over the particles of a group: the same bits for any number of threads and ranks.
pub fn sum<const N: usize>(w: &World, group: GroupId, term: impl Fn(usize) -> [f64; N] + Sync) -> [f64; N] {
    let (mask, bit) = (&w.particles.mask, group.bit());
    w.sum_rows(|i| (mask[i] & bit != 0).then(|| term(i)))
}

/// Mass and centre of mass of a group, unwrapped; the centre of nothing is the origin.
pub fn centre(w: &World, group: GroupId) -> (f64, [f64; 3]) {
    let masses = Masses::of(w);
    let [mass, moment @ ..] = sum::<4>(w, group, |i| {
        let (x, m) = (unwrapped(w, i), masses.get(i));
        [m, m * x[0], m * x[1], m * x[2]]
    });
    (mass, if mass > 0.0 { moment.map(|a| a / mass) } else { [0.0; 3] })
}

/// The mass or the number of particles of a group by which a sum over it is divided: the present one, but that of a run's beginning where
/// LAMMPS has it so (`-compat lammps`), also once particles have been lost or have come. Of dynamic groups it is the present one there too.
#[derive(Clone, Copy, Debug)]
pub struct Whole(Option<f64>);

impl Whole {
    /// The mass, for a run that begins now.
    pub fn mass(w: &World, group: GroupId) -> Self {
        Self::begun(w, group, |w| centre(w, group).0)
    }

    /// The number of particles, for a run that begins now.
    pub fn number(w: &World, group: GroupId) -> Self {
        Self::begun(w, group, |w| count(w, group) as f64)
    }

    fn begun(w: &World, group: GroupId, now: impl Fn(&World) -> f64) -> Self {
        let kept = w.settings.lammps() && w.groups.dynamic(group).is_none();
        Self(kept.then(|| now(w)))
    }

    /// It, where it is `present` now.
    pub fn of(self, present: f64) -> f64 {
        self.0.unwrap_or(present)
    }

    /// The mass and the centre of mass it makes of a group.
    pub fn centre(self, w: &World, group: GroupId) -> (f64, [f64; 3]) {
        let (present, at) = centre(w, group);
        let mass = self.of(present);
        // Without a mass LAMMPS' sum stays as it is.
        let over = if mass > 0.0 { mass } else { 1.0 };
        (mass, if mass == present { at } else { at.map(|a| a * present / over) })
    }
}

/// Where particle `i` would be had it never been wrapped into a periodic box.
pub fn unwrapped(w: &World, i: usize) -> [f64; 3] {
    let by = w.edges().shift(w.particles.image[i].map(f64::from));
    let x = w.particles.x[i];
    std::array::from_fn(|k| x[k] + by[k])
}

/// Keeps `what` of every particle of a group in a vector column, for those it does not hold yet; a scalar column of the same name
/// marks which particles these are.
pub fn keep_places(w: &mut World, key: Vectors, group: GroupId, what: impl Fn(&World, usize) -> [f64; 3]) {
    let (n, bit) = (w.n(), group.bit());
    w.columns.vector(key, n);
    let mut known = std::mem::take(w.columns.scalar(key.of(), n));
    for (i, known) in known.iter_mut().enumerate() {
        if *known == 0.0 && w.particles.mask[i] & bit != 0 {
            *known = 1.0;
            let kept = what(w, i);
            w.columns.vector(key, n)[i] = kept;
        }
    }
    *w.columns.scalar(key.of(), n) = known;
}

/// The particles a force acts on: a group, or its members inside a region.
#[derive(Clone)]
pub struct Chosen {
    bit: u32,
    region: Option<Key<Region>>,
}

impl Chosen {
    /// A group, limited to the region of this name if one is given.
    ///
    /// # Errors
    /// The region no longer exists.
    pub fn new(w: &World, group: GroupId, region: Option<&str>, span: Span) -> Result<Self> {
        let gone = |name| {
            let text = format!("there is no region `{name}` any more");
            Diagnostic::error(Code::UNKNOWN_NAME, span, text)
        };
        let region = region.map(|name| w.regions.find(name).ok_or_else(|| gone(name))).transpose()?;
        Ok(Self { bit: group.bit(), region })
    }

    /// The bit of the group, if no region limits it.
    pub fn bit_alone(&self) -> Option<u32> {
        self.region.is_none().then_some(self.bit)
    }

    /// The particles that are meant at this moment: regions may move. Of a region that is gone there are none.
    pub fn resolve<'w>(&self, w: &'w World) -> ResolvedChoice<'w> {
        match self.region {
            None => ResolvedChoice { bit: self.bit, region: None },
            Some(key) => {
                let region = w.regions.get(key);
                ResolvedChoice { bit: if region.is_some() { self.bit } else { 0 }, region }
            }
        }
    }
}

/// The particles that are meant at one moment.
#[derive(Clone, Copy)]
pub struct ResolvedChoice<'w> {
    bit: u32,
    region: Option<&'w Region>,
}

impl ResolvedChoice<'_> {
    /// Whether a particle with these group bits at this place is meant.
    #[inline]
    pub fn has(&self, mask: u32, x: [f64; 3]) -> bool {
        mask & self.bit != 0 && self.region.is_none_or(|r| r.contains(x))
    }
}

/// Changes the force on each chosen particle and adds up what `change(world, i, force)` returns; the world it sees
/// lacks the forces.
pub fn change_forces<const N: usize>(
    w: &mut World,
    chosen: &Chosen,
    change: impl Fn(&World, usize, &mut [f64; 3]) -> [f64; N] + Sync,
) -> [f64; N] {
    let mut forces = std::mem::take(&mut w.particles.f);
    let total = change_column(w, &mut forces, chosen, change);
    w.particles.f = forces;
    total
}

/// The same with torques.
pub fn change_torques<const N: usize>(
    w: &mut World,
    chosen: &Chosen,
    change: impl Fn(&World, usize, &mut [f64; 3]) -> [f64; N] + Sync,
) -> [f64; N] {
    let mut torques = std::mem::take(&mut w.particles.torque);
    let total = change_column(w, &mut torques, chosen, change);
    w.particles.torque = torques;
    total
}

fn change_column<const N: usize>(
    world: &World,
    column: &mut [[f64; 3]],
    chosen: &Chosen,
    change: impl Fn(&World, usize, &mut [f64; 3]) -> [f64; N] + Sync,
) -> [f64; N] {
    let chosen = chosen.resolve(world);
    let columns = (column, &world.particles.x[..], &world.particles.mask[..]);
    let chunk = |start: usize, (f, x, mask): (&mut [[f64; 3]], &[[f64; 3]], &[u32])| {
        let mut total = [0.0; N];
        for rows in world.moved_in(start..start + x.len()) {
            let own = rows.start - start..rows.end - start;
            let (f, x, mask) = (&mut f[own.clone()], &x[own.clone()], &mask[own]);
            for (k, ((f, x), mask)) in f.iter_mut().zip(x).zip(mask).enumerate() {
                if chosen.has(*mask, *x) {
                    let term = change(world, rows.start + k, f);
                    (0..N).for_each(|k| total[k] += term[k]);
                }
            }
        }
        total
    };
    let total = par::reduce_each(columns, chunk, add).unwrap_or([0.0; N]);
    // Of this rank's rows alone there is no sum.
    if world.is_narrow() { [f64::NAN; N] } else { total }
}

/// Adds to the virials that are wanted what each chosen particle has of a fix, `of(world, i)`: xx yy zz xy xz yz [energy].
pub fn add_virial(w: &mut World, t: &Tick, chosen: &Chosen, of: impl Fn(&World, usize) -> [f64; 6] + Sync) {
    let (x, mask) = (&w.particles.x, &w.particles.mask);
    if t.virial {
        let now = chosen.resolve(w);
        let one = |i: usize| if now.has(mask[i], x[i]) { of(w, i) } else { [0.0; 6] };
        let total = sum(w, GroupId::ALL, one);
        w.tally.fixes = add(w.tally.fixes, total);
    }
    if t.atom_virial {
        let mut atoms = std::mem::take(&mut w.tally.atom_fixes);
        let (now, p) = (chosen.resolve(w), &w.particles);
        for (i, own) in atoms.iter_mut().enumerate().filter(|(i, _)| now.has(p.mask[*i], p.x[*i])) {
            *own = add(*own, of(w, i));
        }
        w.tally.atom_fixes = atoms;
    }
}

/// Writes a fix's global values into its slot.
pub fn publish(w: &mut World, slot: SlotId, t: &Tick, scalar: f64, vector: &[f64]) {
    let out = w.slots.get_mut(slot);
    out.step = Some(t.step);
    out.scalar = scalar;
    out.vector.clear();
    out.vector.extend_from_slice(vector);
}

/// Writes what a fix takes away in every one of several levels of steps into its slot: all levels together.
pub fn publish_levels<const N: usize>(w: &mut World, slot: SlotId, t: &Tick, taken: &[f64; N]) {
    let mut sum = *taken;
    if t.phase.level > 0 {
        sum.iter_mut().zip(&w.slots.get(slot).vector).for_each(|(all, inner)| *all += inner);
    }
    publish(w, slot, t, 0.0, &sum);
}
