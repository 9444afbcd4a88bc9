//! Tensors of periodic cells, solved and estimated: lattices in closed form, random packings.

use super::ends::ROTATIONS;
use super::lattices::{BCC, Body, FCC, SC, lattice, standard};
use super::network::Network;
use super::periodic::{Cell, mean_field};
use super::precond::Blocks;
use super::six::Matrix6;
use super::ste::{Estimate, Layers};
use super::tensor::Moduli;
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::{Vec3, length};
use perigrain_bonded::stiffness::{Beam, Shear};

fn near(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{a} {b}");
}

fn blocks(network: &Network, rotations: bool) -> Blocks {
    let held = if rotations { 0 } else { ROTATIONS };
    Blocks::of_network(network, &vec![held; network.particles])
}

/// All 36 components are those of a cubic tensor.
fn cubic(c: &Matrix6, [c11, c12, c44]: [f64; 3], tolerance: f64) {
    for (a, b) in (0..36).map(|k| (k / 6, k % 6)) {
        let wanted = match (a, b) {
            (0..3, 0..3) if a == b => c11,
            (0..3, 0..3) => c12,
            _ if a == b => c44,
            _ => 0.0,
        };
        assert!((c[a][b] - wanted).abs() <= tolerance * c11, "{a} {b}: {} {wanted}", c[a][b]);
    }
}

/// Closed forms of section 10.4 of the documentation, times k_n/L.
#[test]
fn lattices_have_their_tensors() {
    let beam = standard(1e-3);
    let xi = beam.shear / beam.normal;
    let (root2, root3) = (2f64.sqrt(), 3f64.sqrt());
    let sc = (lattice(&SC.0, SC.1, 4, true), [1.0, 0.0, 0.5 * xi]);
    let bcc = (
        lattice(&BCC.0, BCC.1, 3, true),
        [1.0 + 2.0 * xi, 1.0 - xi, 1.0 + 0.5 * xi].map(|a| a * root3 / 3.0),
    );
    let fcc = (
        lattice(&FCC.0, FCC.1, 3, true),
        [root2 * (1.0 + xi), root2 / 2.0 * (1.0 - xi), root2 / 2.0 * (1.0 + xi)],
    );
    for ((body, c), edge, partners) in [(sc, 4.0 * SC.1, 6), (bcc, 3.0 * BCC.1, 8), (fcc, 3.0 * FCC.1, 12)] {
        assert_eq!(2 * body.bonds.len(), partners * body.x.len());
        let c = c.map(|c| c * beam.normal / 1e-3);
        // Bond lengths come from sums of coordinates: rounding of 1e-16 of 5 mm.
        let network = body.network(|_, _| beam);
        for rotations in [true, false] {
            let cell = Cell::new(&network, &blocks(&network, rotations), 1e-10, None);
            assert!(cell.done && cell.iterations.iter().all(|n| *n < 3), "{:?}", cell.iterations);
            cubic(&cell.tensor(&network, edge.powi(3)), c, 1e-12);
        }
        cubic(&mean_field(&network, edge.powi(3)), c, 1e-12);
        for order in [0, 1, 2, 3, 7] {
            let found = Estimate::new(&network, order);
            assert_eq!(found.without(), 0);
            cubic(&found.whole(edge.powi(3)), c, 1e-12);
        }
    }
}

#[test]
fn moduli_of_the_standard_lattice() {
    let body = lattice(&FCC.0, FCC.1, 3, true);
    let network = body.network(|_, l| standard(l));
    let c = Estimate::new(&network, 2).whole((3.0 * FCC.1).powi(3));
    // Printed with ten digits.
    cubic(&c, [1007053466.0, 207334537.1, 503526733.0], 5e-10);
    let m = Moduli::new(&c).unwrap();
    for a in 0..3 {
        near(m.young[a], 936256307.0, 1e-9);
        near(m.poisson[a][(a + 1) % 3], 7.0 / 41.0, 1e-11);
    }
    near(m.mean_young(), m.young[0], 1e-12);
    near(m.mean_poisson(), 7.0 / 41.0, 1e-11);
    near(m.bulk, (1007053466.0 + 2.0 * 207334537.1) / 3.0, 1e-9);
    // Uniform strain: (C11 − C12 + 3 C44)/5; uniform stress: 5/(2/(C11 − C12)·2 + 3/C44).
    let (a, b) = (1007053466.0 - 207334537.1, 503526733.0);
    near(m.shear, 0.5 * ((a + 3.0 * b) / 5.0 + 5.0 / (4.0 / a + 3.0 / b)), 1e-9);
    // No resistance to shear between the axes.
    let c = Estimate::new(
        &lattice(&SC.0, SC.1, 4, true).network(|_, length| {
            Beam { young: 1e9, poisson: 0.2, radius: 0.4e-3, length }.stiffness(Shear::None)
        }),
        2,
    );
    let m = Moduli::new(&c.whole(64e-9)).unwrap();
    near(m.young[2], 502654.824574367 / 1e-3, 1e-11);
    assert_eq!(m.poisson, [[0.0; 3]; 3]);
    assert!(Moduli::new(&[[f64::NAN; 6]; 6]).is_none() && Moduli::new(&[[-1.0; 6]; 6]).is_none());
}

/// A cell of random points that repel each other for a while, bonded to a dozen partners.
fn pack(seed: u32, n: usize) -> (Body, f64) {
    let mut rng = ParkMiller::new(seed);
    let edge = 1e-3 * (n as f64 * std::f64::consts::PI / 6.0 / 0.55).cbrt();
    let mut x: Vec<Vec3> = (0..n).map(|_| [0, 1, 2].map(|_| edge * rng.uniform())).collect();
    for _ in 0..60 {
        let near = Body::new(x.clone(), 1e-3, [edge; 3]);
        for ([i, j], d) in near.bonds {
            let push = 0.27 * (1e-3 - length(d)) / length(d);
            for k in 0..3 {
                x[i as usize][k] -= push * d[k];
                x[j as usize][k] += push * d[k];
            }
        }
        x.iter_mut().flatten().for_each(|a| *a = a.rem_euclid(edge));
    }
    (Body::new(x, 1.2e-3, [edge; 3]), edge)
}

#[test]
fn sweeps_of_a_periodic_pack_converge_to_its_tensor() {
    let (body, edge) = pack(3, 200);
    let volume = edge.powi(3);
    let network = body.network(|_, l| standard(l));
    let with = Cell::new(&network, &blocks(&network, true), 1e-12, None);
    let fixed = Cell::new(&network, &blocks(&network, false), 1e-12, None);
    assert!(with.done && fixed.done && with.open <= 1e-12);
    let e = |c: &Matrix6| Moduli::new(c).unwrap().mean_young();
    let [with, fixed] = [with, fixed].map(|cell| e(&cell.tensor(&network, volume)));
    let orders = [0, 1, 2, 300].map(|order| {
        let found = Estimate::new(&network, order);
        let c = found.whole(volume);
        // The contributions of all particles, by the formula as printed in the paper.
        let local = found.local(&network);
        for (at, a) in (0..36).map(|k| (k / 6, k % 6)).zip(c.iter().flatten()) {
            let sum: f64 = local.iter().map(|c| c[super::six::at(at.0, at.1)]).sum();
            assert!((sum / volume - a).abs() < 1e-12 * c[0][0]);
        }
        e(&c)
    });
    println!("z {}: {orders:?}, without rotations {fixed}, with {with}", 2 * body.bonds.len() / body.x.len());
    near(orders[3], fixed, 1e-6);
    // All estimates are below the mean field; with rotations a body is softer still.
    assert!(orders[..3].iter().all(|a| *a <= orders[0] && *a > fixed) && with < fixed);
    near(e(&mean_field(&network, volume)), orders[0], 1e-12);
    // In closed form, for isotropic bond directions: E = s (2 + 3ξ)/(3 (4 + ξ)), ν = (1 − ξ)/(4 + ξ), s = Σ
    // k_n L²/V.
    let s: f64 =
        (0..network.bonds()).map(|k| network.k[k].normal * network.length(k).powi(2)).sum::<f64>() / volume;
    let xi = network.k[0].shear / network.k[0].normal;
    // 1 %: the directions of 950 bonds.
    near(orders[0], s * (2.0 + 3.0 * xi) / (3.0 * (4.0 + xi)), 0.01);
    // The same from other initial fields, in fewer steps.
    let first = Cell::new(&network, &blocks(&network, true), 1e-6, None);
    let again = Cell::new(&network, &blocks(&network, true), 1e-6, Some(first.clone()));
    assert!(again.iterations.iter().sum::<usize>() < first.iterations.iter().sum());
}

#[test]
fn particles_without_support_are_left_out_of_the_estimate() {
    let mut body = lattice(&SC.0, SC.1, 4, true);
    // One extra particle on a single spring.
    let n = body.x.len() as u32;
    body.x.push([0.4e-3, 0.4e-3, 0.4e-3]);
    body.bonds.push(([0, n], [0.4e-3; 3]));
    let network = body.network(|_, length| {
        Beam { young: 1e9, poisson: 0.2, radius: 0.4e-3, length }.stiffness(Shear::None)
    });
    for (order, without) in [(0, 0), (1, 1), (2, 1), (4, 1)] {
        let found = Estimate::new(&network, order);
        assert_eq!(found.without(), without);
        assert!(found.local(&network).iter().flatten().all(|a| a.is_finite()));
    }
}

#[test]
fn layers_stand_one_behind_the_other() {
    // Half of a periodic block is twice as stiff; bonds across the boundary belong to both halves equally.
    let body = lattice(&SC.0, SC.1, 4, true);
    let network = body.network(|k, _| {
        let z = |end: usize| body.x[body.bonds[k].0[end] as usize][2];
        let young = if 0.5 * (z(0) + z(1)) > 1.9e-3 { 2e9 } else { 1e9 };
        Beam { young, poisson: 0.2, radius: 0.4e-3, length: 1e-3 }.stiffness(Shear::Paper)
    });
    let z: Vec<f64> = body.x.iter().map(|x| x[2]).collect();
    let found = Estimate::new(&network, 0);
    let layers = Layers::new(&found.local(&network), &z, &vec![1e-9; 64], [-0.5e-3, 3.5e-3], 2, 2);
    // By hand: of the four gaps along z those at 0.5 mm and across the face (mean 1.5 mm) are soft, 1.5 mm is
    // soft, 2.5 mm stiff. The lower slab has one and two halves of soft ones, the upper one has one and two
    // halves of which one is stiff: 16 k_n/2 and 16 k_n 1.5/2.
    let k = 502654.824574367 * 16.0;
    assert_eq!(layers.slabs.len(), 2);
    near(layers.slabs[0], k * 1e-3, 1e-12);
    near(layers.slabs[1], 1.5 * k * 1e-3, 1e-12);
    near(layers.stiffness, 1.0 / (2.0 / k + 2.0 / (1.5 * k)), 1e-12);
}
