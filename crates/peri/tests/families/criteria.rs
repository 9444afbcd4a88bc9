//! Bonds that break by work, stress or strain: energies never rise, works are energies, layouts break the same bonds.

use perigrain_base::math::rng::ParkMiller;
use perigrain_base::par;
use perigrain_peri::families::*;

use super::scene::{Scene, named};
use super::threads;

const DX: f64 = 1e-3;
const KINDS: [&str; 7] = ["pmb", "shaped", "plastic", "nonlinear", "lps", "ves", "eps"];
const CRITERIA: [Criterion; 5] = [
    Criterion::Stretch,
    Criterion::Work,
    Criterion::Stress(1.2e7),
    Criterion::Strain(0.004),
    Criterion::Shear(1e7),
];
/// K = πcδ⁴/18 of bonds, and G at ν = 1/4 and above.
const C: f64 = 1e21;

/// A block of so many sites along each axis, in true forces and without contact.
fn block(kind: &'static str, criterion: Criterion, layout: Layout, sites: [i32; 3]) -> Scene {
    let horizon = 2.015 * DX;
    let mut s = Scene::new(DX, 4e-8, 1);
    (s.options.layout, s.options.unit, s.options.no_repulsion) = (layout, ForceUnit::Newton, true);
    s.options.criterion = criterion;
    s.fill(DX, sites.map(|n| [0, n - 1]), 1, 2200.0, |_| true);
    s.density.iter_mut().zip(&s.volume).for_each(|(m, v)| *m *= v);
    s.table.set(1, 1, PmbCoeff { c: C, horizon, s00: 0.004, alpha: 0.25 }).unwrap();
    s.law.kind = named(kind).into();
    let bulk = std::f64::consts::PI * C * horizon.powi(4) / 18.0;
    let shear = if s.law.kind.bond_based { 0.6 * bulk } else { 0.3 * bulk };
    let (lambda, tau) = if kind == "ves" { (0.6, 3e-7) } else { (0.0, 0.0) };
    s.law.moduli = vec![Moduli { bulk, shear, lambda, tau, yield_stress: 5e7, ..Moduli::default() }];
    s.law.yields = vec![-0.002];
    s.setup();
    s.families.as_mut().unwrap().work_limits = vec![0.5 * C * 0.004 * 0.004 * DX];
    s
}

/// Moves all particles to random places about those that a random strain gives them.
fn shake(s: &mut Scene, random: &mut ParkMiller, strain: f64) {
    let mut draw = || 2.0 * random.uniform() - 1.0;
    let f: [[f64; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| strain * draw()));
    for (x, x0) in s.x.iter_mut().zip(&s.x0) {
        *x = std::array::from_fn(|k| {
            x0[k] + (0..3).map(|d| f[k][d] * x0[d]).sum::<f64>() + 0.5 * strain * DX * draw()
        });
    }
}

/// 10⁴ random states for each law and criterion: where bonds break, the energy at the same places falls or stays.
#[test]
fn breaking_never_makes_energy() {
    let _alone = threads::alone();
    par::set_threads(1);
    for (k, kind) in KINDS.into_iter().enumerate() {
        for criterion in CRITERIA {
            let mut random = ParkMiller::new(17 + k as u32);
            let (mut states, mut breaks, mut round) = (0, 0, 0);
            while states < 10_000 {
                let layout = if round % 2 == 0 { Layout::Auto } else { Layout::List };
                round += 1;
                let mut s = block(kind, criterion, layout, [3, 3, 3]);
                let mut most = 0.0f64;
                for _ in 0..20 {
                    let strain = 0.008 * random.uniform();
                    shake(&mut s, &mut random, strain);
                    let living = s.families.as_ref().unwrap().live_bonds();
                    s.forces(true);
                    let before = s.energy;
                    states += 1;
                    most = most.max(before);
                    if s.families.as_ref().unwrap().live_bonds() == living {
                        continue;
                    }
                    breaks += 1;
                    s.forces(false);
                    // Rounding of sums over some hundred bonds.
                    assert!(
                        s.energy <= before + 1e-12 * most,
                        "{kind} {criterion:?}: {before:e} {:e}",
                        s.energy
                    );
                }
            }
            assert!(breaks > 1000, "{kind} {criterion:?}: {breaks} of {states}");
        }
    }
}

/// The works on bonds add up to the energy of the body, exactly for forces that are linear in extensions whatever the path, once
/// each is multiplied with the weight of its partial volumes and both volumes.
#[test]
fn works_are_the_energy() {
    for (kind, layout) in
        ["pmb", "shaped", "lps"].into_iter().flat_map(|k| [(k, Layout::Auto), (k, Layout::List)])
    {
        let mut s = block(kind, Criterion::Work, layout, [5, 4, 3]);
        s.families.as_mut().unwrap().work_limits = vec![f64::INFINITY];
        let mut random = ParkMiller::new(5);
        for _ in 0..7 {
            shake(&mut s, &mut random, 0.003);
            s.forces(true);
            let sum = total_work(&s);
            // Rounding of tensions over the largest energy on the way, and of stretches.
            assert!((sum / s.energy - 1.0).abs() < 1e-10, "{kind} {layout:?}: {sum:e} {:e}", s.energy);
        }
    }
}

/// Σ w times both volumes and the weight of partial volumes over all bonds.
fn total_work(s: &Scene) -> f64 {
    let f = s.families.as_ref().unwrap();
    let share = |length: f64| s.options.volume.weight(length, 2.015 * DX, DX) * s.volume[0] * s.volume[0];
    let mut sum = 0.0;
    for body in &f.lattices {
        for (k, own) in body.work.iter().enumerate() {
            let xi = body.xi(k / 8 % body.stencil.len());
            sum += own[0] * share(xi.iter().map(|x| x * x).sum::<f64>().sqrt());
        }
    }
    for (b, own) in f.list.work.iter().enumerate() {
        let [i, j] = [f.list.owner[b / 8], f.list.partner[b]].map(|r| f.list.record[r as usize].reference);
        sum += own[0] * share((0..3).map(|k| (i[k] - j[k]).powi(2)).sum::<f64>().sqrt());
    }
    sum
}

/// Ends of living bonds after a block has been torn in so many steps.
fn torn(kind: &'static str, criterion: Criterion, layout: Layout, threads: usize) -> Vec<[u32; 2]> {
    par::set_threads(threads);
    let mut s = block(kind, criterion, layout, [10, 5, 4]);
    for (v, x) in s.v.iter_mut().zip(&s.x) {
        *v = [4e3 * (x[0] - 4.5 * DX), 900.0 * x[2], 5.0 * (900.0 * x[0]).sin()];
    }
    let whole = s.families.as_ref().unwrap().live_bonds();
    for _ in 0..40 {
        s.step();
    }
    let f = s.families.as_ref().unwrap();
    let left = f.live_bonds();
    assert!(left < whole && 10 * left > whole, "{kind} {criterion:?}: {left} of {whole}");
    let mut living = vec![];
    f.bonds_as_kept(false, |i, j| living.push([i.min(j), i.max(j)]));
    living.sort_unstable();
    living
}

/// Sums are rounded otherwise in lists and on lattices, to some 1e-15 of what bonds bear: no bond of these comes as close to its
/// limit.
#[test]
fn lists_and_lattices_break_the_same_bonds_whatever_the_threads() {
    let _alone = threads::alone();
    for (kind, criterion) in KINDS.into_iter().flat_map(|k| CRITERIA.map(|c| (k, c))) {
        let lattice = torn(kind, criterion, Layout::Auto, 1);
        assert!(lattice == torn(kind, criterion, Layout::List, 1), "{kind} {criterion:?}");
        assert!(lattice == torn(kind, criterion, Layout::Auto, 3), "{kind} {criterion:?}");
        assert!(lattice == torn(kind, criterion, Layout::List, 3), "{kind} {criterion:?}");
    }
}

/// One bond of pmb breaks by work at √(2w/(cL)); the factor of its weaker end counts with its square.
#[test]
fn one_bond_breaks_at_its_work() {
    for (layout, factor) in
        [(Layout::Auto, 1.0), (Layout::List, 1.0), (Layout::Auto, 0.5), (Layout::List, 0.5)]
    {
        for side in [1.0 - 1e-9, 1.0 + 1e-9] {
            let mut s = block("pmb", Criterion::Work, layout, [2, 1, 1]);
            let families = s.families.as_mut().unwrap();
            families.scatter(&[1.0, factor], &[]);
            s.x[1][0] = DX * (1.0 - 0.003);
            s.forces(true);
            s.x[1][0] = DX * (1.0 + 0.004 * factor * side);
            s.forces(true);
            assert_eq!(s.families.as_ref().unwrap().live_bonds(), if side < 1.0 { 2 } else { 0 });
        }
    }
}

/// Load ratios of a bond that is only looked at: its work over what breaks it, and for what its ends bear as much.
#[test]
fn ratios_are_those_that_break() {
    for (criterion, layout) in CRITERIA.into_iter().flat_map(|c| [(c, Layout::Auto), (c, Layout::List)]) {
        // An even strain of a block along x; breaking begins where the ratio has come to 1.
        let mut s = block("pmb", criterion, layout, [5, 4, 4]);
        s.forces(true);
        let mut pull = |strain: f64, advance: bool| {
            s.x.iter_mut().zip(&s.x0).for_each(|(x, x0)| x[0] = x0[0] * (1.0 + strain));
            s.forces(advance);
            let families = s.families.as_ref().unwrap();
            (families.load_ratio(&s.view()), families.live_bonds())
        };
        let whole = pull(0.0, true).1;
        let (half, _) = pull(1e-4, false);
        assert!(half > 0.0 && half < 1.0, "{criterion:?} {half}");
        // Work goes with the square of a strain, stresses nearly with it.
        let mut at = 1e-4 * if criterion == Criterion::Work { half.sqrt() } else { half }.recip();
        for _ in 0..20 {
            let (ratio, _) = pull(at, false);
            at /= if criterion == Criterion::Work { ratio.sqrt() } else { ratio };
        }
        // Limits of strains bend: some 1e-6 beyond and below is enough.
        assert_eq!(pull(at * (1.0 - 1e-6), true).1, whole, "{criterion:?} {layout:?}");
        assert!(pull(at * (1.0 + 1e-6), true).1 < whole, "{criterion:?} {layout:?}");
    }
}

/// Two bonds far from each other, one stretched twice as much: cycles until each ends, with a threshold, a ratio of loads and a batch.
#[test]
fn bonds_tire_by_their_stretch() {
    use perigrain_peri::criteria::fatigue::Fatigue;
    let rules = Fatigue { init: [1e9, 3.0, 0.0], grow: [1e9, 3.0], ratio: 0.0, cracked: 0.5 };
    for layout in [Layout::Auto, Layout::List] {
        let stretched = || {
            let mut s = block("pmb", Criterion::Stretch, layout, [2, 1, 2]);
            // Bonds across are as they were; those askew and the two along x differ.
            s.x[1][0] += 1e-3 * DX;
            s.x[3][0] += 2e-3 * DX;
            s.forces(true);
            s
        };
        let tire = |s: &mut Scene, rules: &Fatigue, most: f64, batch: f64| {
            let mut families = s.families.take().unwrap();
            let tired = families.tire(&s.view(), rules, most, batch);
            s.families = Some(families);
            tired
        };
        let mut s = stretched();
        let longest = 2e-3f64;
        let life = 1.0 / (1e9 * longest.powi(3));
        let first = tire(&mut s, &rules, 1e30, 0.0);
        assert!((first.cycles / life - 1.0).abs() < 1e-12 && first.broken == 1, "{first:?}");
        assert!((first.stretch / longest - 1.0).abs() < 1e-12);
        // Not enough cycles, and none that count.
        let mut s = stretched();
        let some = tire(&mut s, &rules, 0.25 * life, 0.0);
        assert_eq!((some.cycles, some.broken), (0.25 * life, 0));
        let rest = tire(&mut s, &rules, 1e30, 0.0);
        assert!((rest.cycles / (0.75 * life) - 1.0).abs() < 1e-12 && rest.broken == 1, "{rest:?}");
        let mut s = stretched();
        let below = tire(&mut s, &Fatigue { init: [1e9, 3.0, 2.1e-3], ..rules }, 1e3, 0.0);
        assert_eq!((below.cycles, below.broken), (1e3, 0));
        // Between R = 1/2 and 1 the range is half as large.
        let mut s = stretched();
        let half = tire(&mut s, &Fatigue { ratio: 0.5, ..rules }, 1e30, 0.0);
        assert!((half.cycles / (8.0 * life) - 1.0).abs() < 1e-12);
        // All bonds with a life to lose end with the first.
        let mut s = stretched();
        let living = s.families.as_ref().unwrap().live_bonds();
        let batch = tire(&mut s, &rules, 1e30, 1.0);
        assert!(batch.broken > 1 && s.families.as_ref().unwrap().live_bonds() == living - 2 * batch.broken);
    }
}
