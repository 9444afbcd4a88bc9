//! Counts chunks and assigns particles to them.

use super::bins::{Layers, Shells};
use super::words::{Discard, Ids, Spec, What};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::memory;
use perigrain_styles::Reading;
use perigrain_styles::common::orthogonal;
use perigrain_world::{Domain, Key, Numbers, Region, Slot, World};

/// The layout of chunks, valid until they are counted again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// Number of chunks.
    pub n: usize,
    /// Layers of bins.
    pub layers: [Layers; 3],
    /// Centre, inner and outer radius of shells.
    pub shells: [f64; 5],
    /// Original numbers in use, sorted, under `compress`.
    pub used: Vec<f64>,
}

impl Layout {
    /// As numbers, for storage in the world.
    fn pack(&self) -> Vec<f64> {
        let mut out = vec![self.n as f64];
        out.extend(self.layers.iter().flat_map(|l| [l.lo, l.count as f64]));
        out.extend(self.shells);
        out.extend(&self.used);
        out
    }

    /// The shells at their positions when chunks were counted.
    fn of(&self, s: &Shells) -> Shells {
        let [x, y, z, lo, hi] = self.shells;
        Shells { center: [x, y, z], lo, hi, ..*s }
    }

    fn unpack(a: &[f64]) -> Option<Self> {
        let (head, used) = a.split_at_checked(12)?;
        let layer = |k: usize| Layers { lo: head[1 + 2 * k], count: head[2 + 2 * k] as usize };
        let shells = *head.last_chunk()?;
        Some(Self { n: head[0] as usize, layers: [0, 1, 2].map(layer), shells, used: used.to_vec() })
    }
}

/// The window in which an averaging fix locks the number of chunks: its first step and its last, if any.
type Lock = Option<(i64, Option<i64>)>;

/// Key of the state of a `compute chunk/atom`, in the world's memory and in a column.
pub fn key(id: &str) -> Numbers {
    Key::new(&format!("compute {id} chunks"))
}

/// Suffix of a window's name.
const WINDOW: &str = " window";

/// Key of the window in which the number of chunks is locked.
pub fn window(id: &str) -> Numbers {
    Key::new(&format!("compute {id}{WINDOW}"))
}

/// Locks the number of chunks of the `compute chunk/atom` with this window from a step on, to the last step
/// of an average or for good.
///
/// # Errors
/// Another fix has locked it for other steps.
pub fn hold(w: &mut World, key: Numbers, step: i64, last: Option<i64>, span: Span) -> Result<()> {
    let mut window = vec![step as f64];
    window.extend(last.map(|last| last as f64));
    if let Some(old) = w.memo.get(key) {
        let open = old.get(1).is_none_or(|last| *last >= step as f64);
        if open && old.len() == 1 && last.is_none() {
            return Ok(());
        }
        if open && *old != window {
            let text = format!(
                "another fix holds the chunks of {} for other steps",
                key.text().trim_end_matches(WINDOW)
            );
            return Err(Diagnostic::error(Code::CONFLICT, span, text)
                .help("give each of them a compute chunk/atom of its own, or the same steps")
                .into());
        }
    }
    w.memo.insert(key, window);
    Ok(())
}

/// Releases the lock.
pub fn let_go(w: &mut World, key: Numbers) {
    w.memo.remove(key);
}

fn lock(w: &World, key: Numbers, step: i64) -> Lock {
    let held = w.memo.get(key)?;
    let (first, last) = (*held.first()? as i64, held.get(1).map(|a| *a as i64));
    (step >= first && last.is_none_or(|l| step <= l)).then_some((first, last))
}

/// One use of a compute chunk/atom.
pub struct Task<'a> {
    /// Its declaration.
    pub spec: &'a Spec,
    /// Keys of its state and of its window.
    pub keys: [Numbers; 2],
    /// The region that particles must be in, if any.
    pub region: Option<&'a Region>,
    /// The value that numbers particles, if there is one.
    pub value: Option<&'a Reading>,
    /// Span of the line.
    pub span: Span,
}

impl Task<'_> {
    /// Assigns chunk numbers to particles in `out`; stores persistent state in the world.
    pub fn run(&self, w: &mut World, step: i64, out: &mut Slot) -> Result<()> {
        let (spec, [key, window]) = (self.spec, self.keys);
        let old = w.memo.get(key).and_then(|a| Layout::unpack(a));
        let lock = lock(w, window, step);
        let numbered = w.columns.get_scalar(key).is_some();
        let keep = numbered
            && match spec.ids {
                Ids::Once => true,
                Ids::Window => lock.is_some_and(|(first, _)| step > first),
                Ids::Every => false,
            };
        let raw = self.raw(w, old.as_ref().filter(|_| lock.is_some() || spec.once))?;
        let layout = match old {
            Some(old) if lock.is_some() || spec.once => old,
            _ => {
                let new = self.count(w, &raw)?;
                w.memo.insert(key, new.pack());
                new
            }
        };
        // With bins, this use may have created a new layout.
        let raw = if self.binned() { self.raw(w, Some(&layout))? } else { raw };
        out.cols = 1;
        out.atom.clear();
        match w.columns.get_scalar(key).filter(|_| keep) {
            Some(kept) => out.atom.extend_from_slice(kept),
            None => out.atom.extend(raw.iter().map(|&a| self.number(a, &layout))),
        }
        if spec.ids != Ids::Every && !keep {
            let n = w.n();
            w.columns.scalar(key, n).clone_from(&out.atom);
        }
        self.describe(w, &layout, out)
    }

    /// Refuses bins that do not fit a tilted box: they tilt with it.
    fn check_box(&self, d: &Domain) -> Result<()> {
        let text = match self.spec.what {
            What::Sphere(_) | What::Cylinder(..) if d.tilted() => {
                "compute chunk/atom with spheres or cylinders"
            }
            What::Bins(_) if d.tilt.is_some() && !self.spec.reduced => {
                "compute chunk/atom without `units reduced`"
            }
            _ => return Ok(()),
        };
        Err(orthogonal(text).at(self.span))
    }

    fn binned(&self) -> bool {
        self.spec.what.binned()
    }

    /// The chunk number of each particle before compression, limit and discarding; NaN for none.
    fn raw(&self, w: &World, layout: Option<&Layout>) -> Result<Vec<f64>> {
        let d = w.domain()?;
        self.check_box(d)?;
        let found;
        let layout = match layout {
            Some(l) => l,
            None => {
                found = self.bins(d)?;
                &found
            }
        };
        let p = &w.particles;
        let bit = self.spec.group.bit();
        let one = |i: usize| {
            if p.mask[i] & bit == 0 || self.region.is_some_and(|r| !r.contains(p.x[i])) {
                return f64::NAN;
            }
            let bin = match &self.spec.what {
                What::Type => return f64::from(p.kind[i]),
                What::Molecule => return f64::from(p.molecule[i]),
                What::Value(_) => return self.value.map_or(0.0, |v| whole(v.atom(w, i))),
                _ => self.bin(d, layout, p.x[i], w.settings.lammps()),
            };
            bin.map_or(f64::NAN, |b| b as f64 + 1.0)
        };
        Ok((0..w.n()).map(one).collect())
    }

    /// Bins of the current box.
    fn bins(&self, d: &Domain) -> Result<Layout> {
        let mut layers = [Layers::default(); 3];
        let axes = match &self.spec.what {
            What::Bins(axes) => axes.as_slice(),
            What::Cylinder(axis, _) => std::slice::from_ref(axis),
            _ => &[],
        };
        for (l, a) in layers.iter_mut().zip(axes) {
            *l = match a.layers(d, self.spec.reduced) {
                Some(l) => l,
                None => return fail(Code::BAD_VALUE, self.span, "no bin lies inside these bounds"),
            };
        }
        let mut shells = [0.0; 5];
        if let What::Sphere(s) | What::Cylinder(_, s) = &self.spec.what {
            let s = s.in_box(d, self.spec.reduced);
            shells = [s.center[0], s.center[1], s.center[2], s.lo, s.hi];
        }
        Ok(Layout { layers, shells, ..Layout::default() })
    }

    /// The bin of a position, counted from 0.
    fn bin(&self, d: &Domain, layout: &Layout, x: [f64; 3], lammps: bool) -> Option<usize> {
        let inside = if d.tilted() { d.fractions(&x) } else { x };
        // Particles that have crossed a face since the last rebuild are not wrapped yet.
        let wrapped = |k: usize| {
            let (lo, hi) = (d.lo[k], d.hi[k]);
            let mut a = x[k];
            if d.boundary.periodic(k) {
                if a < lo {
                    a += hi - lo;
                }
                if a >= hi {
                    a -= hi - lo;
                }
            }
            a
        };
        let along = |k: usize| {
            if d.tilted() {
                let turns = if d.boundary.periodic(k) { inside[k].floor() } else { 0.0 };
                return inside[k] - turns;
            }
            let a = wrapped(k);
            if self.spec.reduced { (a - d.lo[k]) * (1.0 / (d.hi[k] - d.lo[k])) } else { a }
        };
        let round = || std::array::from_fn(wrapped);
        let (spec, layers) = (self.spec, &layout.layers);
        match &spec.what {
            What::Bins(axes) => {
                let mut bin = 0usize;
                for (a, l) in axes.iter().zip(layers) {
                    // Saturates for too many bins, which `count` refuses.
                    bin = bin.saturating_mul(l.count).saturating_add(a.layer(
                        l,
                        along(a.dim),
                        spec.discard,
                        lammps,
                    )?);
                }
                Some(bin)
            }
            What::Sphere(s) => layout.of(s).shell(d, round(), spec.pbc, spec.discard),
            What::Cylinder(a, s) => {
                let axial = a.layer(&layers[0], along(a.dim), spec.discard, lammps)?;
                let ring = layout.of(s).shell(d, round(), spec.pbc, spec.discard)?;
                Some(ring.saturating_mul(layers[0].count).saturating_add(axial))
            }
            _ => None,
        }
    }

    /// The number of chunks, and with `compress` the original numbers in use.
    fn count(&self, w: &World, raw: &[f64]) -> Result<Layout> {
        let spec = self.spec;
        let d = w.domain()?;
        let bins = self.bins(d)?;
        let layers = bins.layers;
        let all: f64 = match &spec.what {
            What::Type => w.types as f64,
            What::Molecule | What::Value(_) => raw.iter().fold(1.0, |a: f64, b| a.max(*b)),
            What::Bins(axes) => layers[..axes.len()].iter().map(|l| l.count as f64).product(),
            What::Sphere(s) => s.count as f64,
            What::Cylinder(_, s) => layers[0].count as f64 * s.count as f64,
        };
        if all > MOST as f64 && !spec.compress {
            let text =
                format!("{all} chunks are too many: `compress yes` leaves out those without particles");
            return fail(Code::BAD_VALUE, self.span, text);
        }
        if all > MOST_NUMBERS {
            let text = format!("{all:e} chunks cannot be numbered");
            return fail(Code::TOO_LARGE, self.span, text);
        }
        let mut used = vec![];
        if spec.compress {
            used.extend(raw.iter().map(|&a| self.limited(a)).filter(|a| !a.is_nan()));
            used.sort_by(f64::total_cmp);
            used.dedup();
        }
        let mut n = if spec.compress { used.len() } else { all as usize };
        if let Some(l) = spec.limit {
            n = if l.exact { l.n } else { n.min(l.n) };
        }
        if let Some(d) = memory::lacking(n as f64 * BYTES_PER_CHUNK, &format!("{n} chunks")) {
            return Err(d.at(self.span).into());
        }
        Ok(Layout { n, used, ..bins })
    }

    /// A number after a `limit` that stands before `compress`.
    fn limited(&self, raw: f64) -> f64 {
        match self.spec.limit {
            Some(l) if l.first && raw > l.n as f64 => {
                if self.spec.discard == Discard::No {
                    l.n as f64
                } else {
                    f64::NAN
                }
            }
            _ => raw,
        }
    }

    /// A particle's chunk from 1, or 0 for none.
    fn number(&self, raw: f64, layout: &Layout) -> f64 {
        if raw.is_nan() {
            return 0.0;
        }
        let n = layout.n as f64;
        let outside = if self.spec.discard == Discard::No { n } else { 0.0 };
        let number = if self.spec.compress {
            match layout.used.binary_search_by(|u| u.total_cmp(&self.limited(raw))) {
                Ok(k) => k as f64 + 1.0,
                // A bin that was empty when chunks were counted is not a chunk.
                Err(_) if self.binned() => return 0.0,
                Err(_) => outside,
            }
        } else {
            raw
        };
        if number < 1.0 || number > n { outside } else { number }
    }

    /// Number, volume and coordinates of every chunk.
    fn describe(&self, w: &World, layout: &Layout, out: &mut Slot) -> Result<()> {
        let d = w.domain()?;
        out.inner.clear();
        for k in 0..layout.n {
            let id =
                layout.used.get(k).copied().unwrap_or(if self.spec.compress { 0.0 } else { k as f64 + 1.0 });
            out.inner.push(id);
            self.place(d, layout, (id - 1.0).max(0.0) as usize, &mut out.inner);
        }
        Ok(())
    }

    /// Volume and coordinates of a bin, counted from 0.
    fn place(&self, d: &Domain, layout: &Layout, bin: usize, out: &mut Vec<f64>) {
        let lengths = d.lengths();
        let extent = |k: usize, delta: f64| if self.spec.reduced { delta * lengths[k] } else { delta };
        let center = |l: &Layers, k: usize, delta: f64| l.lo + (k as f64 + 0.5) * delta;
        let radius = |s: &Shells, k: usize| s.lo + (k as f64 + 0.5) * s.delta();
        let ends = |s: &Shells, k: usize| (s.lo + k as f64 * s.delta(), s.lo + (k as f64 + 1.0) * s.delta());
        match &self.spec.what {
            What::Bins(axes) => {
                let mut volume = 1.0;
                axes.iter().for_each(|a| volume *= extent(a.dim, a.delta));
                (0..3).filter(|k| axes.iter().all(|a| a.dim != *k)).for_each(|k| volume *= lengths[k]);
                out.push(volume);
                let mut rest = bin;
                let mut places = vec![];
                for (a, l) in axes.iter().zip(&layout.layers).rev() {
                    places.push(center(l, rest % l.count.max(1), a.delta));
                    rest /= l.count.max(1);
                }
                out.extend(places.iter().rev());
            }
            What::Sphere(s) => {
                let s = layout.of(s);
                let (lo, hi) = ends(&s, bin);
                out.push(4.0 / 3.0 * std::f64::consts::PI * (hi * hi * hi - lo * lo * lo));
                out.push(radius(&s, bin));
            }
            What::Cylinder(a, s) => {
                let s = layout.of(s);
                let l = &layout.layers[0];
                let (ring, axial) = (bin / l.count.max(1), bin % l.count.max(1));
                let (lo, hi) = ends(&s, ring);
                out.push(extent(a.dim, a.delta) * std::f64::consts::PI * (hi * hi - lo * lo));
                out.push(radius(&s, ring));
                out.push(center(l, axial, a.delta));
            }
            _ => out.push(d.volume()),
        }
    }
}

/// A value as a chunk number: rounded towards zero, no NaN, no negative zero.
fn whole(a: f64) -> f64 {
    if a.is_nan() { 0.0 } else { a.trunc() + 0.0 }
}

/// Bytes per chunk in the styles that use it: sums, means and output rows.
const BYTES_PER_CHUNK: f64 = 100.0;

/// Above this number, doubles cannot distinguish chunks.
const MOST_NUMBERS: f64 = 9e15;

/// A larger number of chunks is refused (for example particle ids without `compress`).
const MOST: usize = 100_000_000;
