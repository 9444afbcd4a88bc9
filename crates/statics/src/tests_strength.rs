//! Bodies that break bond by bond: bundles and chains in closed form, and the balance of energy.

use super::ends::{Ends, Held, Hold, Sample, affine};
use super::lattices::{Body, block, standard};
use super::network::Network;
use super::pcg::{Preconditioner, solve};
use super::precond::Blocks;
use super::strength::{Avalanche, Limits, Path, crumble};
use perigrain_base::par;
use perigrain_bonded::weibull;

/// A body pulled along z by its grips, with strengths in tension alone; returns `delta` and the path.
fn pull(
    body: &Body,
    network: Network,
    strength: impl Fn(usize) -> f64 + Sync,
    limits: &Limits,
) -> (f64, Path) {
    let radius = body.radii(0.5e-3);
    let sample = Sample { x: &body.x, radius: &radius, axis: 2 };
    let ends = Ends::new(&sample, sample.mean_radius());
    let held = Held::new(&sample, &ends, [Hold::Grip; 2], true, &network.pieces());
    let delta = 0.01 * ends.free_length();
    let mut field = affine(&sample, &ends, [Hold::Grip; 2], &held, delta, [0.0; 3]);
    let blocks = Blocks::of_network(&network, &held.mask);
    solve(
        |u, out| network.product(u, out),
        &mut Preconditioner::plain(&blocks),
        None,
        &mut field,
        0.0,
        10_000,
        |_| false,
    );
    let origin = network.pairs.origin.clone();
    let share = |k: usize, bears: &[f64; 4]| bears[0] / strength(origin[k] as usize);
    (delta, crumble(network, &held, field, limits, share))
}

const LAST: Limits = Limits { avalanche: Avalanche::One, until: 0.0, most: 10_000, tol: 1e-8, together: 0.0 };

/// `n` separate chains of `links` bonds side by side.
fn bundle(n: usize, links: usize) -> Body {
    let x = |k: usize| [5e-3 * (k / (links + 1)) as f64, 0.0, 1e-3 * (k % (links + 1)) as f64];
    Body::new((0..n * (links + 1)).map(x).collect(), 1.05e-3, [0.0; 3])
}

/// H. E. Daniels, Proc. R. Soc. A 183, 405 (1945): in a bundle of n fibres with strengths f₁ < f₂ < … the
/// k-th breaks under (n − k + 1) f_k.
#[test]
fn bundles_of_chains() {
    for links in [2, 3] {
        let body = bundle(40, links);
        // The first link of each chain is the weakest.
        let strength = |k: usize| {
            let [a, b] = body.bonds[k].0;
            let of_chain = weibull::strength(3.0, 5, [a / (links as u32 + 1), 1000]);
            if a % (links as u32 + 1) == 0 { of_chain } else { 2.0 * of_chain + f64::from(b) * 1e-3 }
        };
        let mut sorted: Vec<f64> = (0..40).map(|k| weibull::strength(3.0, 5, [k, 1000])).collect();
        sorted.sort_by(f64::total_cmp);
        let (delta, path) = pull(&body, body.network(|_, l| standard(l)), strength, &LAST);
        assert!(path.done && !path.whole && path.breaks.len() == 40);
        let wanted: Vec<f64> = sorted.iter().enumerate().map(|(k, f)| (40 - k) as f64 * f).collect();
        for (it, wanted) in path.breaks.iter().zip(&wanted) {
            // Chains are solved to rounding.
            assert!((it.force(delta) - wanted).abs() < 1e-9 * wanted, "{} {wanted}", it.force(delta));
        }
        let most = wanted.iter().fold(0.0f64, |a, b| a.max(*b));
        assert!((path.breaks[path.peak].force(delta) - most).abs() < 1e-9 * most);
    }
}

/// In a bundle with strengths within 10 %, the nearest half breaks at once, as if all had the smallest
/// strength.
#[test]
fn what_breaks_together() {
    let body = bundle(4, 2);
    let strength = |k: usize| [1.0, 1.04, 1.06, 1.2][body.bonds[k].0[0] as usize / 3];
    let run =
        |together: f64| pull(&body, body.network(|_, l| standard(l)), strength, &Limits { together, ..LAST });
    let (delta, path) = run(0.05);
    // Both links of a chain have the same load; 1.04 lacks 4 % of the load of the first, 1.06 more.
    let broken: Vec<usize> = path.breaks.iter().map(|b| b.bonds.len()).collect();
    assert_eq!(broken, [4, 2, 2]);
    for (it, wanted) in path.breaks.iter().zip([4.0, 2.12, 1.2]) {
        assert!((it.force(delta) - wanted).abs() < 1e-9 * wanted, "{} {wanted}", it.force(delta));
    }
}

/// A lattice block with scattered strengths: released plus remaining energy equals the work of the ends; the
/// tolerance is relative to the peak.
#[test]
fn energies_add_up() {
    let body = block(true);
    let strength = |k: usize| 50.0 * weibull::strength(4.0, 11, body.bonds[k].0);
    let run = |limits: &Limits| pull(&body, body.network(|_, l| standard(l)), strength, limits);
    let (delta, exact) = run(&Limits { until: 0.3, ..LAST });
    let (mut work, mut released, mut last) = (0.0, 0.0, [0.0; 2]);
    for it in &exact.breaks {
        let before = [it.load * delta, it.force(delta)];
        work += 0.5 * (last[1] + before[1]) * (before[0] - last[0]);
        released += it.released();
        last = [before[0], 2.0 * it.energy[1] * it.load / delta];
    }
    let left = 0.5 * last[0] * last[1];
    // Solutions are accurate to 1e-8 of the change by a break.
    assert!((work - released - left).abs() < 1e-7 * work, "{work} {released} {left}");
    assert!(
        exact.breaks.len() > 20 && exact.peak > 5 && exact.whole,
        "{} {}",
        exact.breaks.len(),
        exact.peak
    );
    let (_, path) = run(&Limits { until: 0.3, tol: 1e-4, ..LAST });
    let peak = |path: &Path| path.breaks[path.peak].force(delta);
    assert!((peak(&path) / peak(&exact) - 1.0).abs() < 1e-3, "{} {}", peak(&path), peak(&exact));
    let same = path.breaks.iter().zip(&exact.breaks).take_while(|(a, b)| a.bonds == b.bonds).count();
    assert!(same > exact.peak, "{same} of {}", exact.peak);
    // Fixed ends while every bond beyond its strength breaks: never a higher force, and never at a smaller
    // load than before.
    let (_, all) = run(&Limits { avalanche: Avalanche::All, until: 0.3, tol: 1e-4, ..LAST });
    assert!(peak(&all) <= peak(&path) * 1.0001 && all.breaks.len() < path.breaks.len());
    assert!(all.breaks.windows(2).all(|two| two[1].load >= two[0].load));
    // Bonds within 3 % of the breaking load break together: never a higher force, at most 3 % lower, with
    // fewer solutions.
    let (_, rough) =
        run(&Limits { avalanche: Avalanche::All, until: 0.3, tol: 1e-4, together: 0.03, ..LAST });
    let kept = peak(&rough) / peak(&all);
    assert!((0.97..1.0001).contains(&kept), "{kept}");
    assert!(rough.breaks.len() < all.breaks.len() && rough.iterations < all.iterations);
    // The field returned is that of the peak.
    let network = body.network(|_, l| standard(l));
    let first = network.energy(&path.field).iter().sum::<f64>();
    assert!(first > path.breaks[path.peak].energy[0] * path.breaks[path.peak].load.powi(2));
    // The same bits for any number of threads.
    let breaks = |threads: usize| {
        par::set_threads(threads);
        let (_, path) = run(&Limits { until: 0.5, most: 10, tol: 1e-4, ..LAST });
        par::set_threads(1);
        path.breaks.iter().map(|b| (b.bonds.clone(), b.load.to_bits())).collect::<Vec<_>>()
    };
    assert_eq!(breaks(1), breaks(3));
}
