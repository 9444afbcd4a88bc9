//! Bodies between ends: numbers of the documentation of bonded particles, bounds, energy fractions.

use super::dsm::{Answer, Stop, relax};
use super::ends::{Ends, Held, Hold, Sample, affine, poisson, reaction};
use super::energy_shares;
use super::lattices::{Body, SC, block, lattice, random, standard};
use super::network::Network;
use super::pcg::{Preconditioner, solve};
use super::precond::Blocks;
use perigrain_base::par;
use perigrain_bonded::stiffness::{Beam, Shear, Stiffness};

/// Results of a test of a body along z.
struct Tested {
    k: f64,
    by_force: [f64; 2],
    answer: Answer,
    network: Network,
    delta: f64,
    held: Held,
}

fn test(body: &Body, network: Network, hold: Hold, rotations: bool, stop: Stop, zero: bool) -> Tested {
    let radius = body.radii(0.5e-3);
    let sample = Sample { x: &body.x, radius: &radius, axis: 2 };
    let ends = Ends::new(&sample, sample.mean_radius());
    let held = Held::new(&sample, &ends, [hold; 2], rotations, &network.pieces());
    assert!(held.through && !ends.overlap());
    let delta = -0.01 * ends.free_length();
    let mut start = affine(&sample, &ends, [hold; 2], &held, delta, [0.2, 0.2, 0.0]);
    if zero {
        for (row, held) in start.iter_mut().zip(&held.mask) {
            *row = std::array::from_fn(|c| if held >> c & 1 == 1 { row[c] } else { 0.0 });
        }
    }
    let blocks = Blocks::of_network(&network, &held.mask);
    let answer = relax(&network, &blocks, &held, start, rotations, stop);
    let force = |end: usize| reaction(&network, &answer.field, &ends.members[end], 2) / delta;
    let by_force = [-force(0), force(1)];
    Tested { k: 2.0 * answer.energy() / delta / delta, by_force, answer, network, delta, held }
}

fn near(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{a} {b}");
}

/// Section 10.4 of the documentation, printed with 12 digits.
#[test]
fn blocks_of_a_lattice() {
    for (holes, rotations, hold, k) in [
        (false, true, Hold::Grip, 5430321.8781),
        (false, true, Hold::Plate, 5269009.41211),
        (false, false, Hold::Grip, 5466126.86364),
        (false, false, Hold::Plate, 5290542.81508),
        (true, true, Hold::Grip, 3960026.58303),
        (true, true, Hold::Plate, 3817739.48593),
        (true, false, Hold::Grip, 4199711.67804),
        (true, false, Hold::Plate, 4073193.33602),
    ] {
        let body = block(holes);
        let network = body.network(|_, l| standard(l));
        let sizes = [(256, 1176), (238, 1006)][usize::from(holes)];
        assert_eq!((body.x.len(), network.bonds()), sizes);
        let t = test(&body, network, hold, rotations, Stop::Residual(1e-9), true);
        // Twelve digits are printed; reactions are as accurate as the residual, 1e-9 N of 400 N.
        near(t.k, k, 3e-12);
        near(t.by_force[0], k, 1e-10);
        near(t.by_force[1], k, 1e-10);
        println!(
            "{hold:?} rotations {rotations} holes {holes}: {} iterations from zero",
            t.answer.solved.iterations
        );
        assert!(t.answer.solved.done && t.held.left_out == [0, 0]);
        // From the affine field, stopped by the decrease of the energy: within the requested tolerance, from
        // above.
        for tol in [0.05, 0.01, 1e-3, 1e-6] {
            let t =
                test(&body, body.network(|_, l| standard(l)), hold, rotations, Stop::Estimate(tol), false);
            assert!(t.k >= k * (1.0 - 1e-11) && t.k <= k * (1.0 + tol), "{} {k} {tol}", t.k);
        }
    }
}

/// n² k_n/(n_z − 1), for any ends and shear model.
#[test]
fn simple_cubic_blocks() {
    for shear in [Shear::Paper, Shear::None] {
        let body = lattice(&SC.0, SC.1, 4, false);
        let beam = |_: usize, length: f64| {
            Beam { young: 1e9, poisson: 0.2, radius: 0.4e-3, length }.stiffness(shear)
        };
        for hold in [Hold::Grip, Hold::Plate] {
            let t = test(&body, body.network(beam), hold, true, Stop::Estimate(1e-12), false);
            // Rounding.
            near(t.k, 16.0 * 502654.824574367 / 3.0, 1e-11);
        }
    }
}

/// Bonds in a row: section 10.2.
fn chain(n: usize, length: f64, beam: impl Fn(f64) -> Stiffness) -> Network {
    let ends: Vec<[u32; 2]> = (0..n as u32).map(|k| [k, k + 1]).collect();
    let step = length / n as f64;
    Network::new(n + 1, &ends, |_| ([step, 0.0, 0.0], beam(step)))
}

#[test]
fn cantilevers_are_beams() {
    let (load, length) = (1e-3, 1e-2);
    for (n, paper) in [
        (1, 1.2481726412e-5),
        (2, 1.55902213942e-5),
        (5, 1.64605999893e-5),
        (10, 1.65849397886e-5),
        (20, 1.66160247384e-5),
        (40, 1.66237959758e-5),
    ] {
        for (shear, w) in [(Shear::Paper, paper), (Shear::Timoshenko(0.9), 1.66316915531e-5)] {
            let beam =
                |length: f64| Beam { young: 1e9, poisson: 0.2, radius: 0.4e-3, length }.stiffness(shear);
            let network = chain(n, length, beam);
            let mut mask = vec![0u8; n + 1];
            mask[0] = 0b111111;
            let mut tip = vec![[0.0; 6]; n + 1];
            // Perpendicular to the bar, along it, and a twist.
            (tip[n][1], tip[n][0], tip[n][3]) = (load, 2.0 * load, 1e-6);
            let mut u = vec![[0.0; 6]; n + 1];
            let blocks = Blocks::of_network(&network, &mask);
            let out = solve(
                |u, o| network.product(u, o),
                &mut Preconditioner::plain(&blocks),
                Some(&tip),
                &mut u,
                0.0,
                10_000,
                |_| false,
            );
            // Printed with 12 digits; conjugate gradients on a chain of 40 bending bonds leave a relative
            // error of 1e-9.
            near(u[n][1], w, 1e-9);
            near(u[n][5], 2.48679598581e-3, 1e-9);
            let k = beam(length / n as f64);
            near(u[n][0], 2.0 * load * n as f64 / k.normal, 1e-9);
            near(u[n][3], 1e-6 * n as f64 / k.twist, 1e-9);
            // Half of the work of the load.
            near(-2.0 * out.energy, load * w + 2.0 * load * u[n][0] + 1e-6 * u[n][3], 1e-9);
        }
    }
}

#[test]
fn rigid_motions_cost_nothing() {
    let body = random(11, 60, 0.9);
    let network = body.network(|_, l| standard(l));
    let (shift, turn) = ([1e-4, -2e-4, 3e-4], [0.01, -0.02, 0.015]);
    let u: Vec<_> = (body.x.iter())
        .map(|x| {
            let moved = perigrain_base::math::vec3::add(shift, perigrain_base::math::vec3::cross(turn, *x));
            super::network::row(moved, turn)
        })
        .collect();
    let mut f = vec![[0.0; 6]; u.len()];
    network.product(&u, &mut f);
    let stiffest = network.k.iter().map(|k| k.normal).fold(0.0, f64::max);
    // Rounding of displacements of 1e-3 length units, summed over a dozen bonds.
    assert!(f.iter().all(|f| f[..3].iter().all(|a| a.abs() < 1e-15 * stiffest * 1e-2)));
    assert!(network.energy(&u).iter().all(|e| *e < 1e-12));
}

#[test]
fn bounds_hold_and_fall() {
    for seed in 1..12 {
        // With few bonds there are dangling chains and separate pieces.
        let body = random(seed, 150, if seed % 2 == 0 { 0.45 } else { 0.9 });
        let beam = |k: usize, length: f64| {
            let young = if k.is_multiple_of(3) { 4e9 } else { 1e9 };
            Beam { young, poisson: 0.2, radius: 0.3e-3, length }.stiffness(Shear::Paper)
        };
        let exact = test(&body, body.network(beam), Hold::Grip, true, Stop::Residual(1e-10), true);
        let network = body.network(beam);
        let radius = body.radii(0.5e-3);
        let sample = Sample { x: &body.x, radius: &radius, axis: 2 };
        let ends = Ends::new(&sample, sample.mean_radius());
        let held = Held::new(&sample, &ends, [Hold::Grip; 2], true, &network.pieces());
        let blocks = Blocks::of_network(&network, &held.mask);
        let delta = exact.delta;
        let mut u = affine(&sample, &ends, [Hold::Grip; 2], &held, delta, [0.2, 0.2, 0.0]);
        let certificate =
            super::certificate::Certificate::new(&network, |k| held.mask[k] == 63, &held.out, true);
        let energy: f64 = network.energy(&u).iter().sum();
        let (mut last, mut upper, mut gap) = (f64::INFINITY, 0.0, 0.0);
        let least = exact.answer.energy();
        solve(
            |u, o| network.product(u, o),
            &mut Preconditioner::plain(&blocks),
            None,
            &mut u,
            energy,
            5_000,
            |now| {
                assert!(now.energy <= last);
                last = now.energy;
                upper = network.energy(now.field).iter().sum();
                // The decrease by the steps plus the rest, to rounding.
                near(now.energy, upper, 1e-9);
                gap = certificate.gap(&network, now.r);
                assert!(upper >= least * (1.0 - 1e-10) && upper - gap <= least * (1.0 + 1e-10), "{seed}");
                gap < 1e-3 * upper
            },
        );
        assert!(gap < 1e-3 * upper, "seed {seed}");
        // As the command uses it.
        let t = test(&body, body.network(beam), Hold::Grip, true, Stop::Certified(1e-3), false);
        assert!(t.answer.gap.is_some_and(|gap| gap <= 1e-3 * t.answer.energy()));
    }
}

#[test]
fn shares_of_the_energy_are_logarithmic_derivatives() {
    let body = random(5, 200, 0.9);
    let solved = |young: f64, radius: f64, poisson: f64| {
        let beam = |k: usize, length: f64| {
            if k % 5 < 2 {
                Beam { young, poisson, radius, length }.stiffness(Shear::Paper)
            } else {
                Beam { young: 1e9, poisson: 0.2, radius: 0.3e-3, length }.stiffness(Shear::Paper)
            }
        };
        test(&body, body.network(beam), Hold::Grip, true, Stop::Residual(1e-12), true)
    };
    let base = [2e9, 0.3e-3, 0.2];
    let t = solved(base[0], base[1], base[2]);
    let kinds = energy_shares::by_kind(&t.network, &t.answer.field, 2, |k| {
        usize::from(t.network.pairs.origin[k] % 5 < 2)
    });
    let total: f64 = kinds.iter().flatten().sum();
    near(total, t.answer.energy(), 1e-13);
    let of = |d: [f64; 4]| {
        let moved = |k: usize| [t.network.moved(k, &t.answer.field, None); 2];
        let d = |k: usize| if t.network.pairs.origin[k] % 5 < 2 { d } else { [0.0; 4] };
        energy_shares::change(&t.network, moved, d) / (2.0 * total)
    };
    near(of([1.0; 4]), kinds[1].iter().sum::<f64>() / total, 1e-13);
    // E; r: 2 from stretch and shear, 4 from bend and twist; ν: G ~ 1/(1 + ν).
    let nu = -base[2] / (1.0 + base[2]);
    for (p, d) in [(0, [1.0; 4]), (1, [2.0, 2.0, 4.0, 4.0]), (2, [0.0, nu, 0.0, nu])] {
        let at = |factor: f64| {
            let mut changed = base;
            changed[p] *= factor;
            solved(changed[0], changed[1], changed[2]).k.ln()
        };
        let h: f64 = 1e-3;
        let slope = (at(h.exp()) - at((-h).exp())) / (2.0 * h);
        // Central differences: h² of a second derivative of order 1.
        assert!((of(d) - slope).abs() < 1e-6, "{p}: {} {slope}", of(d));
    }
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let body = lattice(&super::lattices::FCC.0, super::lattices::FCC.1, 12, false);
    assert!(body.x.len() > 3 * par::CHUNK);
    let one = |threads: usize| {
        par::set_threads(threads);
        let young = |k: usize| if k.is_multiple_of(7) { 0.1e9 } else { 1e9 };
        let network = body.network(|k, length| {
            Beam { young: young(k), poisson: 0.2, radius: 0.4e-3, length }.stiffness(Shear::Paper)
        });
        let t = test(&body, network, Hold::Grip, true, Stop::Estimate(1e-3), false);
        par::set_threads(1);
        (t.k.to_bits(), t.answer.solved.iterations, t.answer.field)
    };
    let first = one(1);
    assert!(first.1 > 3);
    for threads in [2, 3] {
        assert!(one(threads) == first, "{threads} threads");
    }
}

#[test]
fn poisson_of_a_body_that_is_stretched_evenly() {
    let body = block(false);
    let radius = body.radii(0.5e-3);
    let sample = Sample { x: &body.x, radius: &radius, axis: 2 };
    let u: Vec<_> = body.x.iter().map(|x| [-3e-3 * x[0], -1e-3 * x[1], 1e-2 * x[2], 0.0, 0.0, 0.0]).collect();
    let [x, y] = poisson(&sample, &u, &vec![false; u.len()], 1e-2);
    near(x, 0.3, 1e-12);
    near(y, 0.1, 1e-12);
}

#[test]
fn pieces_that_nothing_holds_are_left_out() {
    let mut body = block(false);
    let n = body.x.len() as u32;
    // Two bonded particles apart from the block, and a single one.
    body.x.extend([[9e-3, 9e-3, 2e-3], [9e-3, 9e-3, 3e-3], [20e-3, 0.0, 2e-3]]);
    body.bonds.push(([n, n + 1], [0.0, 0.0, 1e-3]));
    for hold in [Hold::Grip, Hold::Plate] {
        let network = body.network(|_, l| standard(l));
        let t = test(&body, network, hold, true, Stop::Estimate(1e-11), false);
        assert_eq!(t.held.left_out, [3, 2]);
        let k = if hold == Hold::Grip { 5430321.8781 } else { 5269009.41211 };
        near(t.k, k, 1e-10);
    }
}
