//! Bonds that soften: against a plain loop over pairs, in both layouts, in lanes and without, for any number of threads.

use perigrain_base::par;
use perigrain_peri::families::*;

use super::scene::{Scene, named};

const DX: f64 = 1e-3;
/// What is left of the peak where an exponential bond breaks.
const REST: f64 = 1e-3;
const KINDS: [&str; 2] = ["softening/linear", "softening/exponential"];
const C: f64 = 1e21;

/// A brick of one or two types whose halves fly apart.
fn brick(kind: &'static str, types: u16, layout: Layout) -> Scene {
    let mut s = Scene::new(DX, 4e-8, usize::from(types));
    (s.options.layout, s.options.unit) = (layout, ForceUnit::Newton);
    s.fill(DX, [[0, 9], [0, 4], [0, 4]], 1, 2200.0, |_| true);
    s.density.iter_mut().zip(&s.volume).for_each(|(m, v)| *m *= v);
    let n = usize::from(types);
    s.law = Law { kind: named(kind).into(), influence: Influence::One, yields: vec![0.0; n * n], ..s.law };
    s.law.moduli = vec![Moduli::default(); n];
    for (a, b) in (1..=types).flat_map(|a| (1..=types).map(move |b| (a, b))) {
        let apart = f64::from(a + b) / 2.0;
        let (peak, s00) = (1e-3 * apart, 6e-3 + 1e-3 * apart);
        s.table.set(a, b, PmbCoeff { c: C, horizon: 3.015 * DX, s00, alpha: 0.0 }).unwrap();
        s.law.yields[(usize::from(a) - 1) * n + usize::from(b) - 1] = peak;
    }
    for i in 0..s.x.len() {
        s.kind[i] = if s.x[i][1] < 2.5 * DX { 1 } else { types };
        s.v[i] = [if s.x[i][0] < 4.5 * DX { -8.0 } else { 8.0 }, 3e3 * s.x[i][2], 0.0];
    }
    s
}

/// A bond by itself.
struct Bond {
    ends: [usize; 2],
    length: f64,
    weight: f64,
    peak: f64,
    last: f64,
    /// The largest stretch so far.
    most: f64,
    alive: bool,
}

impl Bond {
    fn envelope(&self, kind: &'static str, s: f64) -> f64 {
        match kind {
            _ if s <= self.peak => s,
            "softening/linear" => self.peak * (self.last - s).max(0.0) / (self.last - self.peak),
            _ => self.peak * (REST.ln() * (s - self.peak) / (self.last - self.peak)).exp(),
        }
    }

    /// 1 − d.
    fn intact(&self, kind: &'static str) -> f64 {
        self.envelope(kind, self.most) / self.most
    }

    /// What damage has taken, over c w |xi| V²: the area under the curve without the triangle it goes back along.
    fn lost(&self, kind: &'static str) -> f64 {
        let most = if kind == "softening/linear" { self.most.min(self.last) } else { self.most };
        let force = self.envelope(kind, most);
        let beyond = match kind {
            "softening/linear" => 0.5 * (self.peak + force) * (most - self.peak),
            _ => (self.peak - force) * (self.last - self.peak) / -REST.ln(),
        };
        0.5 * self.peak * self.peak + beyond - 0.5 * force * most
    }
}

/// All bonds of a scene as they are at first.
fn bonds(s: &Scene) -> Vec<Bond> {
    let mut all = vec![];
    let n = s.law.moduli.len();
    for i in 0..s.x.len() {
        for j in 0..i {
            let xi = [0, 1, 2].map(|k| s.x[j][k] - s.x[i][k]);
            let length = xi.iter().map(|x| x * x).sum::<f64>().sqrt();
            let c = s.table.get(s.kind[i], s.kind[j]).unwrap();
            if length <= c.horizon {
                let weight = s.options.volume.weight(length, c.horizon, DX);
                let peak = s.law.yields[(usize::from(s.kind[i]) - 1) * n + usize::from(s.kind[j]) - 1];
                all.push(Bond { ends: [i, j], length, weight, peak, last: c.s00, most: peak, alive: true });
            }
        }
    }
    all
}

/// Forces and what the scene holds and has lost, bond by bond; then bonds break.
fn plain(s: &Scene, bonds: &mut [Bond], lost: &mut f64) -> (Vec<[f64; 3]>, f64) {
    let (kind, volume) = (s.law.kind.name, s.volume[0] * s.volume[0]);
    let (mut f, mut held) = (vec![[0.0; 3]; s.x.len()], 0.0);
    for b in bonds.iter_mut().filter(|b| b.alive) {
        let [i, j] = b.ends;
        let y = [0, 1, 2].map(|k| s.x[j][k] - s.x[i][k]);
        let now = y.iter().map(|x| x * x).sum::<f64>().sqrt();
        let stretch = now / b.length - 1.0;
        let before = b.lost(kind);
        b.most = b.most.max(stretch);
        let share = if stretch > 0.0 { b.intact(kind) } else { 1.0 };
        let scale = C * b.weight * volume;
        for k in 0..3 {
            let pull = scale * share * stretch * y[k] / now;
            f[i][k] += pull;
            f[j][k] -= pull;
        }
        let energy = 0.5 * scale * b.length * share * stretch * stretch;
        *lost += scale * b.length * (b.lost(kind) - before);
        b.alive = stretch <= b.last;
        held += if b.alive { energy } else { 0.0 };
        *lost += if b.alive { 0.0 } else { energy };
    }
    (f, held)
}

#[test]
fn forces_and_losses_are_those_of_a_plain_loop() {
    let forms = [(Layout::Auto, false), (Layout::Auto, true), (Layout::List, false), (Layout::List, true)];
    for (kind, types, (layout, portable)) in
        KINDS.into_iter().flat_map(|k| [1, 2].map(|t| (k, t))).flat_map(|(k, t)| forms.map(|f| (k, t, f)))
    {
        let name = format!("{kind:?} {types} {layout:?} {portable}");
        let mut s = brick(kind, types, layout);
        s.options.portable = portable;
        let mut bonds = bonds(&s);
        let mut lost = 0.0;
        s.setup();
        s.families.as_mut().unwrap().counts_losses = true;
        let (mut unloads, mut broken) = (false, 0);
        for step in 0..45 {
            if step == 8 || step == 13 {
                // There and back.
                s.v.iter_mut().flatten().for_each(|v| *v = -*v);
            }
            unloads |= step == 10 && bonds.iter().any(|b| b.most > b.peak);
            s.step();
            let (f, _) = plain(&s, &mut bonds, &mut lost);
            let most = f.iter().flatten().fold(0.0f64, |m, f| m.max(f.abs()));
            let mut sum = [0.0; 3];
            for (ours, f) in s.f.iter().zip(&f) {
                for k in 0..3 {
                    sum[k] += ours[k];
                    // Stretches of 1e-4 from absolute lengths lose 12 of 16 digits; so may a stretch right at the peak or the end.
                    assert!((ours[k] - f[k]).abs() < 1e-9 * most, "{name} at {step}: {} {}", ours[k], f[k]);
                }
            }
            assert!(sum.iter().all(|sum| sum.abs() < 1e-12 * most), "{name}: {sum:?}");
            let families = s.families.as_ref().unwrap();
            let alive = bonds.iter().filter(|b| b.alive).count();
            assert_eq!(families.live_bonds(), 2 * alive, "{name} at {step}");
            broken = bonds.len() - alive;
            // As for forces.
            assert!((families.released - lost).abs() <= 1e-9 * lost, "{name}: {} {lost}", families.released);
        }
        assert!(unloads && broken > 50 && lost > 0.0, "{name}: {broken} of {}", bonds.len());
    }
}

#[test]
fn bits_do_not_depend_on_threads_or_skipping() {
    let _alone = super::threads::alone();
    for (kind, layout) in KINDS.into_iter().flat_map(|k| [(k, Layout::Auto), (k, Layout::List)]) {
        let mut bits = vec![];
        for (threads, skip_rest) in [(1, true), (2, true), (7, true), (2, false)] {
            par::set_threads(threads);
            let mut s = brick(kind, 1, layout);
            s.options.skip_rest = skip_rest;
            s.setup();
            (0..25).for_each(|_| s.step());
            let state: Vec<u64> = s.x.iter().chain(&s.v).chain(&s.f).flatten().map(|x| x.to_bits()).collect();
            bits.push((state, s.energy.to_bits(), s.families.as_ref().unwrap().live_bonds()));
        }
        par::set_threads(1);
        assert!(bits.windows(2).all(|b| b[0] == b[1]), "{kind:?} {layout:?}");
    }
}
