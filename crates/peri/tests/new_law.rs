//! A law that the crate does not have, in one file: a spring that stiffens. It runs on lattices and in lists, whole and while it breaks.

#![allow(clippy::unwrap_used)]

use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, cross, dot};
use perigrain_peri::families::*;
use perigrain_peri::law::{Angles, BondLaw, Ends, Moment, Stretch, Style};

/// c (s + β s²), with the energy density c (½ s² + ⅓ β s³) |xi|.
struct Stiffening;

/// β.
const BETA: f64 = 6.0;

static STIFFENING: Style = Style { bond_based: true, ..Style::of::<Stiffening>("stiffening", 1000) };

impl BondLaw for Stiffening {
    const COLUMNS: usize = 0;
    const MEMORY: usize = 0;
    const DILATED: bool = false;
    const ALL_FORMS: bool = false;
    #[inline(always)]
    fn pull<R: Real>(bond: &Stretch<R>, _: R, _: &Ends<R>, _: &mut [R; 2], _: &Moment) -> (R, R) {
        let pull = bond.s * (bond.s * BETA + 1.0) * bond.inverse;
        (pull, pull)
    }
    #[inline(always)]
    fn squares<R: Real>(bond: &Stretch<R>, _: R, _: &[Angles<R>; 2], _: &[R; 2], _: &Moment) -> (R, R) {
        let twice = bond.s * bond.s * (bond.s * (2.0 / 3.0 * BETA) + 1.0);
        (twice, twice)
    }
}

/// Cells along each edge of the body.
const SIDE: usize = 9;

/// A cube of spacing and volumes 1 under this law, whose forces are true ones.
struct Body {
    x0: Vec<Vec3>,
    families: Families,
}

/// Forces and energy of an evaluation.
struct Found {
    f: Vec<Vec3>,
    energy: f64,
}

impl Body {
    fn new(layout: Layout) -> Self {
        let at = |i: usize| [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE].map(|k| k as f64);
        let x0: Vec<Vec3> = (0..SIDE.pow(3)).map(at).collect();
        let mut table = PmbTable::new(1);
        table.set(1, 1, PmbCoeff { c: 2.0, horizon: 3.015, s00: 0.05, alpha: 0.0 }).unwrap();
        let unit = ForceUnit::Newton;
        let options = FamilyOptions { layout, unit, no_repulsion: true, ..FamilyOptions::new(1.0) };
        let (influence, moduli) = (Influence::One, vec![Moduli::default()]);
        let law = Law { kind: (&STIFFENING).into(), influence, moduli, ..Law::default() };
        let families = of(&x0, &x0, |view| Families::build_of(view, &table, options, law)).unwrap();
        assert_eq!(families.lattices.len(), usize::from(layout == Layout::Auto));
        Self { x0, families }
    }

    fn force(&mut self, x: &[Vec3], advance: bool) -> Found {
        let mut f = vec![[0.0; 3]; x.len()];
        let mut sums = PeriTally::default();
        of(x, &self.x0, |view| self.families.force(view, &mut f, advance, Some(&mut sums)));
        Found { f, energy: sums.energy }
    }

    /// Places under a wave of this strength, pulled apart along x by `pull`.
    fn moved(&self, wave: f64, pull: f64) -> Vec<Vec3> {
        let place = |x: &Vec3| {
            let u = [0, 1, 2].map(|k| wave * (0.7 * x[k] + 0.4 * x[(k + 1) % 3]).sin());
            [x[0] + u[0] + pull * (x[0] - 4.0).max(0.0), x[1] + u[1], x[2] + u[2]]
        };
        self.x0.iter().map(place).collect()
    }

    /// Forces are the slope of the energy, and push nothing as a whole, nor turn it.
    fn check(&mut self, x: &[Vec3]) -> Found {
        let here = self.force(x, false);
        let most = here.f.iter().flatten().fold(0.0f64, |most, f| most.max(f.abs()));
        assert!(most > 0.01, "{most}");
        let total = |of: &dyn Fn(usize) -> Vec3| {
            (0..x.len()).map(of).fold([0.0; 3], |sum: Vec3, a| [0, 1, 2].map(|k| sum[k] + a[k]))
        };
        // Sums of some 700 forces, and of these times places of up to 9.
        assert!(total(&|i| here.f[i]).iter().all(|f| f.abs() < 1e-12 * most * 700.0));
        assert!(total(&|i| cross(x[i], here.f[i])).iter().all(|t| t.abs() < 1e-11 * most * 700.0));
        let way: Vec<Vec3> =
            (0..x.len()).map(|i| [0, 1, 2].map(|k| (0.3 * (i * (k + 2)) as f64).cos())).collect();
        let step = 1e-6;
        let mut at = |sign: f64| {
            let there: Vec<Vec3> =
                x.iter().zip(&way).map(|(x, d)| [0, 1, 2].map(|k| x[k] + sign * step * d[k])).collect();
            self.force(&there, false).energy
        };
        let slope = (at(1.0) - at(-1.0)) / (2.0 * step);
        let work: f64 = here.f.iter().zip(&way).map(|(f, d)| dot(*f, *d)).sum();
        // Energies of some units with 16 digits over 2e-6, and the third derivative times 1e-12.
        assert!((slope + work).abs() < 1e-7 * most, "{slope} {work} {most}");
        here
    }
}

fn of<T>(x: &[Vec3], x0: &[Vec3], act: impl FnOnce(&PeriView) -> T) -> T {
    let (kind, volume) = (vec![1; x.len()], vec![1.0; x.len()]);
    let bounds = Bounds { lo: [-20.0; 3], hi: [40.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
    act(&PeriView { x, x0, kind: &kind, volume: &volume, bounds, excluded: None })
}

fn close(a: &Found, b: &Found) {
    let most = a.f.iter().flatten().fold(0.0f64, |most, f| most.max(f.abs()));
    let off = a.f.iter().flatten().zip(b.f.iter().flatten()).map(|(a, b)| (a - b).abs());
    // Sums of some hundred forces in another order.
    assert!(off.fold(0.0, f64::max) < 1e-12 * most && (a.energy / b.energy - 1.0).abs() < 1e-12);
}

#[test]
fn one_bond_takes_the_integral_of_its_force() {
    let families = Body::new(Layout::List).families;
    let (r0, end, steps) = (2.0, 2.09, 4000);
    let force = |r: f64| families.bond_alone([1, 1], r0, r)[0];
    let step = (end - r0) / f64::from(steps);
    let middle = |k: i32| force(r0 + (f64::from(k) + 0.5) * step);
    let integral: f64 = (0..steps).map(middle).sum::<f64>() * step;
    let [_, energy] = families.bond_alone([1, 1], r0, end);
    // The midpoint rule with 4000 points: 1/24 of 1/4000² of the second derivative, which is below 10.
    assert!((integral / energy - 1.0).abs() < 1e-6, "{integral} {energy}");
    // c (s + β s²) with c = 2, s = 0.045.
    assert!((force(end) - 2.0 * (0.045 + BETA * 0.045 * 0.045)).abs() < 1e-14);
}

#[test]
fn a_law_of_ones_own_runs_on_lattices_and_in_lists() {
    let mut bodies = [Layout::Auto, Layout::List].map(Body::new);
    let whole = bodies[0].families.live_bonds();
    for wave in [1e-5, 1e-3, 0.01] {
        let x = bodies[0].moved(wave, 0.003);
        let [a, b] = bodies.each_mut().map(|body| body.check(&x));
        close(&a, &b);
    }
    // Nothing breaks in the first step that advances.
    for step in 0..8 {
        let x = bodies[0].moved(0.004, 0.011 * f64::from(step));
        bodies.iter_mut().for_each(|body| drop(body.force(&x, true)));
    }
    let [left, listed] = bodies.each_ref().map(|body| body.families.live_bonds());
    assert!(left == listed && left < whole - whole / 20 && left > whole / 2, "{left} {listed} of {whole}");
    let x = bodies[0].moved(0.004, 0.02);
    let [a, b] = bodies.each_mut().map(|body| body.check(&x));
    close(&a, &b);
}
