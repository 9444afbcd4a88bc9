//! Coarse levels: their guarantees for any body, and the reduction of steps.

use super::coarse::{Coarse, Parts, Sizes};
use super::contact::Contact;
use super::contacts::{Contacts, Touching};
use super::ends::{ROTATIONS, WHOLE};
use super::lattices::{Body, FCC, lattice, random, standard};
use super::network::Network;
use super::pcg::{PATIENCE, Preconditioner, Progress, solve};
use super::precond::Blocks;
use super::six::Six;
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::{Vec3, length};
use perigrain_base::par;

fn noise(n: usize, seed: u32) -> Vec<Six> {
    let mut rng = ParkMiller::new(seed);
    // Rotations in units of a diameter, 1 mm.
    (0..n).map(|_| std::array::from_fn(|c| (rng.uniform() - 0.5) * if c < 3 { 1.0 } else { 1e-3 })).collect()
}

fn dot(a: &[Six], b: &[Six]) -> f64 {
    a.iter().zip(b).flat_map(|(a, b)| (0..6).map(move |c| a[c] * b[c])).sum()
}

/// z = P B Pᵀ r.
fn applied(coarse: &Coarse, blocks: &Blocks, r: &[Six]) -> Vec<Six> {
    let mut z = vec![[0.0; 6]; r.len()];
    coarse.add_to(&mut z, r, blocks);
    z
}

/// A body, its held components, and springs to the ground.
struct Case {
    network: Network,
    held: Vec<u8>,
    grounds: Vec<(u32, usize, f64)>,
}

/// Random bodies with dangling ends, held at some places, with and without rotations, with springs to the
/// ground, and cells small enough for clusters to meet their own images.
fn bodies() -> Vec<Case> {
    let mut out = vec![];
    for (seed, n, keep) in [(1, 60, 0.9), (2, 700, 0.5), (3, 4000, 0.7)] {
        let network = random(seed, n, keep).network(|_, l| standard(l));
        let mut rng = ParkMiller::new(seed + 10);
        let mut some = || (0..n).map(|_| if rng.uniform() < 0.05 { WHOLE } else { 0 }).collect::<Vec<u8>>();
        let (grips, plates) = (some(), some().iter().map(|m| m & 0b100).collect());
        let grounds = (0..n as u32).step_by(7).map(|k| (k, 2, 3e5)).collect();
        out.push(Case { network: network.clone(), held: grips, grounds: vec![] });
        out.push(Case { network: network.clone(), held: plates, grounds });
        out.push(Case { network, held: vec![ROTATIONS; n], grounds: vec![] });
    }
    for cells in [2, 5] {
        let network = lattice(&FCC.0, FCC.1, cells, true).network(|_, l| standard(l));
        out.push(Case { held: vec![0; network.particles], network, grounds: vec![] });
    }
    out
}

#[test]
fn symmetric_and_positive() {
    for (which, Case { network, held, grounds }) in bodies().into_iter().enumerate() {
        let blocks = Blocks::of_network(&network, &held);
        let coarse = Coarse::new(&Parts { ties: &[&network], grounds: &grounds }, &blocks, Sizes::NEXT);
        let free = |r: Vec<Six>| r.iter().enumerate().map(|(k, r)| blocks.free(k, r)).collect::<Vec<_>>();
        let [a, b] = [7, 8].map(|seed| free(noise(network.particles, seed)));
        let [x, y] = [&a, &b].map(|r| applied(&coarse, &blocks, r));
        let (one, other) = (dot(&a, &y), dot(&b, &x));
        let [aa, bb] = [dot(&a, &x), dot(&b, &y)];
        assert!(aa > 0.0 && bb > 0.0, "{which}");
        // Rounding, times the error of single precision in the factors of blocks.
        assert!((one - other).abs() < 1e-8 * (aa * bb).sqrt(), "{which} {one} {other}");
    }
}

/// For a body with a single level, the solution is exact among rigid motions of its clusters: the residual
/// does no work on any of them.
#[test]
fn one_level_is_galerkins() {
    let network = random(5, 300, 0.8).network(|_, l| standard(l));
    let n = network.particles;
    let held: Vec<u8> = (0..n).map(|k| [0, 0, WHOLE, 0b100, 0][k % 5]).collect();
    let blocks = Blocks::of_network(&network, &held);
    let grounds = [(4, 0, 2e5), (11, 1, 1e5)];
    let coarse = Coarse::new(&Parts { ties: &[&network], grounds: &grounds }, &blocks, Sizes::NEXT);
    let free = |rows: Vec<Six>| rows.iter().enumerate().map(|(k, r)| blocks.free(k, r)).collect::<Vec<_>>();
    let r = free(noise(n, 3));
    let half = |z: Vec<Six>| z.iter().map(|z| z.map(|a| 0.5 * a)).collect::<Vec<Six>>();
    // The correction is scaled by two.
    let z = half(applied(&coarse, &blocks, &r));
    let mut kz = vec![[0.0; 6]; n];
    network.product(&z, &mut kz);
    grounds.iter().for_each(|(k, c, stiffness)| kz[*k as usize][*c] += stiffness * z[*k as usize][*c]);
    let kz = free(kz);
    // P B Pᵀ K P B Pᵀ r = P B Pᵀ r.
    let again = half(applied(&coarse, &blocks, &kz));
    let energy = dot(&r, &z);
    for seed in [20, 21] {
        let w = free(noise(n, seed));
        let size = dot(&w, &half(applied(&coarse, &blocks, &w))) * energy;
        assert!((dot(&w, &z) - dot(&w, &again)).abs() < 1e-9 * size.sqrt());
    }
    assert!((dot(&z, &kz) - energy).abs() < 1e-9 * energy);
}

/// A comb of slender bending beams, four particles thick: the slowest case for block Jacobi.
fn slender() -> Body {
    let mut x: Vec<Vec3> = vec![];
    for k in 0..2 * 2 * 150 {
        x.push([k % 2, k / 2 % 2, k / 4].map(|c| 1e-3 * c as f64));
    }
    Body::new(x, 1.5e-3, [0.0; 3])
}

#[test]
fn what_bends_is_found_in_few_steps() {
    let network = slender().network(|_, l| standard(l));
    let n = network.particles;
    let held: Vec<u8> = (0..n).map(|k| if k < 4 { WHOLE } else { 0 }).collect();
    let mut load = vec![[0.0; 6]; n];
    load[n - 1][0] = 1e-3;
    let blocks = Blocks::of_network(&network, &held);
    let make = || Coarse::of_network(&network, &blocks);
    let solved = [Preconditioner::plain(&blocks), Preconditioner::deep(&blocks, &make)].map(|mut by| {
        let mut u = vec![[0.0; 6]; n];
        let first = std::cell::Cell::new(None);
        let done = |now: &Progress| {
            let first = first.get().unwrap_or_else(|| {
                first.set(Some(now.residual));
                now.residual
            });
            now.residual < 1e-9 * first
        };
        let solved = solve(|u, o| network.product(u, o), &mut by, Some(&load), &mut u, 0.0, 100_000, done);
        assert!(solved.done);
        (u[n - 1][0], solved.iterations)
    });
    let [(tip, plain), (deep_tip, deep)] = solved;
    println!("{plain} steps by blocks, {deep} with coarse levels");
    // The condition number of such a slender beam, 10⁹ or more, is between residual and tip displacement.
    assert!((tip - deep_tip).abs() < 1e-5 * tip.abs(), "{tip} {deep_tip}");
    assert!(deep < plain / 4, "{plain} {deep}");
}

/// Two rods in contact side by side, one of them held: contacts connect clusters like bonds, open ones do
/// not.
#[test]
fn contacts_tie_clusters() {
    let rod = |x: f64| (0..60).map(move |k| [x, 0.0, 1e-3 * f64::from(k)]);
    let body = Body::new(rod(0.0).chain(rod(1.9e-3)).collect(), 1.1e-3, [0.0; 3]);
    let network = body.network(|_, l| standard(l));
    let n = network.particles;
    let ends: Vec<[u32; 2]> = (0..60).map(|k| [k, k + 60]).collect();
    for touches in [true, false] {
        let contact = Contact {
            n: [1.0, 0.0, 0.0],
            overlap: if touches { 1e-5 } else { -1e-5 },
            normal: 3e7,
            tangential: 5e7,
            arms: [0.95e-3; 2],
            relaxed: true,
        };
        let contacts = Contacts::new(n, &ends, |_| contact);
        let springs = contacts.tangent(&vec![[0.0; 6]; n], None);
        let held: Vec<u8> = (0..n).map(|k| if k < 2 { WHOLE } else { 0 }).collect();
        let mut packed = network.blocks();
        contacts.add_blocks(&springs, &mut packed);
        let blocks = Blocks::new(&packed, &held);
        let touching = Touching { contacts: &contacts, springs: &springs };
        let coarse = Coarse::new(&Parts { ties: &[&network, &touching], grounds: &[] }, &blocks, Sizes::NEXT);
        let mut load = vec![[0.0; 6]; n];
        load[n - 1][1] = 1e-3;
        let moved = length(applied(&coarse, &blocks, &load)[n - 1][..3].try_into().unwrap());
        // The second rod is free where it does not touch the first: motions without resistance are unchanged.
        assert!(moved.is_finite() && moved > 0.0 && moved < 1.0, "{touches} {moved}");
        let mut all = vec![[0.0; 6]; n];
        (60..n).for_each(|k| all[k][1] = 1e-3);
        let pushed = applied(&coarse, &blocks, &all);
        let sum: f64 = (60..n).map(|k| pushed[k][1]).sum();
        assert_eq!(sum.abs() > 1e-9, touches, "{sum}");
    }
}

/// A periodic cell: the result contains no rigid motion.
#[test]
fn whole_motions_are_left_alone() {
    let network = lattice(&FCC.0, FCC.1, 6, true).network(|k, l| standard(l).times([1.0, 5.0][k % 3 / 2]));
    let n = network.particles;
    let blocks = Blocks::of_network(&network, &vec![0; n]);
    let coarse = Coarse::of_network(&network, &blocks);
    let mut load = vec![[0.0; 6]; n];
    network.product(&noise(n, 4), &mut load);
    let z = applied(&coarse, &blocks, &load);
    let most = z.iter().flat_map(|z| &z[..3]).fold(0.0, |most: f64, a| most.max(a.abs()));
    for c in 0..3 {
        let mean = z.iter().map(|z| z[c]).sum::<f64>() / n as f64;
        // Block Jacobi steps may bring back a little of it.
        assert!(mean.abs() < 0.1 * most, "{mean} {most}");
    }
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let network = random(9, 9000, 0.8).network(|_, l| standard(l));
    let n = network.particles;
    let held: Vec<u8> = (0..n).map(|k| if k % 100 == 0 { WHOLE } else { 0 }).collect();
    let solved = [1, 2, 7].map(|threads| {
        par::set_threads(threads);
        let blocks = Blocks::of_network(&network, &held);
        let make = || Coarse::of_network(&network, &blocks);
        let mut by = Preconditioner::deep(&blocks, &make);
        let mut u = vec![[0.0; 6]; n];
        let solved = solve(
            |u, o| network.product(u, o),
            &mut by,
            Some(&noise(n, 6)),
            &mut u,
            0.0,
            3 * PATIENCE,
            |_| false,
        );
        (solved.energy.to_bits(), u.iter().flatten().map(|a| a.to_bits()).collect::<Vec<_>>())
    });
    assert!(solved[0] == solved[1] && solved[0] == solved[2]);
}

/// A bond with negative stiffness: no solution reports convergence.
#[test]
fn negative_stiffnesses_are_reported() {
    let body = random(4, 2000, 0.8);
    let network = body.network(|k, l| standard(l).times(if k % 50 == 0 { -0.5 } else { 1.0 }));
    let n = network.particles;
    let held: Vec<u8> = (0..n).map(|k| if k % 400 == 0 { WHOLE } else { 0 }).collect();
    let blocks = Blocks::of_network(&network, &held);
    let make = || Coarse::of_network(&network, &blocks);
    for mut by in [Preconditioner::plain(&blocks), Preconditioner::deep(&blocks, &make)] {
        let (mut u, load) = (vec![[0.0; 6]; n], noise(n, 5));
        let solved =
            solve(|u, o| network.product(u, o), &mut by, Some(&load), &mut u, 0.0, 10_000, |_| false);
        assert!(!solved.done, "{solved:?}");
    }
}
