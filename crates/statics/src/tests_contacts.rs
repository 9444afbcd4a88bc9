//! Contacts and walls: numbers of section 10.5 of the documentation of bonded particles.

use super::contact::Contact;
use super::contacts::Contacts;
use super::lattices::{Body as Lattice, SC, lattice, standard};
use super::network::Network;
use super::newton::{Body, End};
use super::six::Six;
use super::walls::Walls;
use perigrain_base::math::rng::ParkMiller;

fn near(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{a} {b}");
}

/// 4/3 E*, 8 G* for E = 1 GPa, ν = 0.2 against itself.
const PAIR: [f64; 2] = [4.0 / 3.0 * 5.208333333333333e8, 8.0 * 1.1574074074074074e8];
const RADIUS: f64 = 0.5e-3;

fn contact(n: [f64; 3], overlap: f64) -> Contact {
    let root = (0.5 * RADIUS).sqrt();
    let [normal, tangential] = PAIR.map(|c| c * root);
    Contact { n, overlap, normal, tangential, arms: [RADIUS; 2], relaxed: false }
}

#[test]
fn two_spheres_touch() {
    // Printed with ten digits.
    let c = contact([1.0, 0.0, 0.0], 1e-6);
    near(c.normal, 10980130.76, 5e-10);
    let contacts = Contacts::new(2, &[[1, 0]], |_| Contact { n: [-1.0, 0.0, 0.0], ..c });
    let mut f = vec![[0.0; 6]; 2];
    let still = vec![[0.0; 6]; 2];
    contacts.add_forces(&still, None, &mut f);
    // They repel: the force that resists a motion of the second along x is negative.
    near(f[0][0], 0.01098013076, 5e-10);
    near(f[1][0], -0.01098013076, 5e-10);
    let [k] = contacts.tangent(&still, None)[..] else { panic!() };
    near(k.k[0], 16470.19615, 5e-10);
    near(k.k[1], 14640.17435, 5e-10);
    // The initial force is subtracted.
    let relaxed = Contacts::new(2, &[[0, 1]], |_| Contact { relaxed: true, ..c });
    let mut f = vec![[0.0; 6]; 2];
    relaxed.add_forces(&still, None, &mut f);
    assert_eq!(f, still);
    assert_eq!((relaxed.touching(&still, None), relaxed.energy(&still, None)), ([1, 0], 0.0));
}

#[test]
fn forces_are_slopes_of_the_energy_where_overlaps_stay() {
    let contacts = Contacts::new(2, &[[0, 1]], |_| contact([0.6, 0.0, 0.8], 2e-6));
    // Displaced tangentially and rotated: the overlap stays, and with it k_t.
    let at = |s: f64| -> Vec<Six> {
        vec![[0.0, 1e-7, 0.0, 0.0, 1e-4, 2e-5], [0.8 * s, 3e-8, -0.6 * s, 1e-4, -2e-5 + s, 0.0]]
    };
    let mut f = vec![[0.0; 6]; 2];
    contacts.add_forces(&at(2e-8), None, &mut f);
    let h = 1e-9;
    let slope = (contacts.energy(&at(2e-8 + h), None) - contacts.energy(&at(2e-8 - h), None)) / (2.0 * h);
    // Central differences of a parabola: rounding divided by the step.
    near(f[1][0] * 0.8 - f[1][2] * 0.6 + f[1][4], slope, 1e-5);
    // Without previous slip the tangent is the full derivative of the forces.
    let still = vec![[0.0; 6]; 2];
    let k = contacts.tangent(&still, None);
    let p: Vec<Six> = vec![[1.0, -2.0, 0.5, 300.0, 100.0, -70.0], [0.2, 1.0, -1.5, -20.0, 400.0, 10.0]];
    let mut product = vec![[0.0; 6]; 2];
    contacts.add_product(&k, &p, &mut product);
    let mut slope = vec![[0.0; 6]; 2];
    for sign in [1.0, -1.0] {
        let u: Vec<Six> = p.iter().map(|p| p.map(|a| sign * 1e-11 * a)).collect();
        let mut f = vec![[0.0; 6]; 2];
        contacts.add_forces(&u, None, &mut f);
        (0..12).for_each(|c| slope[c / 6][c % 6] += sign * f[c / 6][c % 6] / 2e-11);
    }
    for c in 0..12 {
        assert!(
            (product[c / 6][c % 6] - slope[c / 6][c % 6]).abs() < 1e-4 * product[1][0].abs(),
            "{product:?} {slope:?}"
        );
    }
}

/// Two spheres with the standard bond between planes.
#[test]
fn a_pair_between_planes() {
    let network = Network::new(2, &[[0, 1]], |_| ([0.0, 0.0, 1e-3], standard(1e-3)));
    let none = Contacts::default();
    for (delta, force, k) in [
        (1e-5, 0.315090744409, 31509.07444),
        (2e-5, 0.858953424153, 42947.67121),
        (4e-5, 2.31258968887, 57814.74222),
    ] {
        // Rigid planes: twice the modulus, the full radius.
        let normal = 2.0 * PAIR[0] * RADIUS.sqrt();
        near(normal, 31056499.69, 5e-10);
        let walls = Walls { axis: 2, delta: -delta, near: [vec![(0, 0.0, normal)], vec![(1, 0.0, normal)]] };
        let body = Body {
            network: &network,
            contacts: &none,
            walls: &walls,
            past: None,
            held: &[0; 2],
            arm: RADIUS,
        };
        let follows = |z: f64| [0.0, 0.0, -delta * z / 2e-3, 0.0, 0.0, 0.0];
        let found = body.relax(vec![follows(0.5e-3), follows(1.5e-3)], End::Part(1e-10));
        assert!(found.done && found.residuals.len() <= 7, "{found:?}");
        // Printed with twelve and ten digits.
        for push in walls.push(&found.field) {
            near(push, force, 5e-12);
            near(push / delta, k, 1e-10);
        }
        assert_eq!(walls.touching(&found.field), [1, 1]);
        // All energy is in the bond and the planes.
        let bond: f64 = network.energy(&found.field).iter().sum();
        near(bond, 0.5 * force * force / 502654.824574, 1e-10);
        near(walls.energy(&found.field), 2.0 * 0.4 * force * (force / normal).powf(2.0 / 3.0), 1e-10);
    }
}

/// 5 × 5 × 8 spheres, 15 % of the bonds missing, and contacts of all neighbours.
#[test]
fn newton_converges_with_the_square() {
    let whole = lattice(&SC.0, SC.1, 8, false);
    let stays = |x: &&[f64; 3]| x[0] < 4.5e-3 && x[1] < 4.5e-3;
    let mut body = Lattice::new(whole.x.iter().filter(stays).copied().collect(), 1.05e-3, [0.0; 3]);
    let neighbours = body.clone();
    let mut rng = ParkMiller::new(88);
    body.bonds.retain(|_| rng.uniform() > 0.15);
    let network = body.network(|_, l| standard(l));
    let ends: Vec<[u32; 2]> = neighbours.bonds.iter().map(|b| b.0).collect();
    let contacts = Contacts::new(200, &ends, |k| Contact {
        tangential: 0.0,
        ..contact(neighbours.bonds[k].1.map(|d| d / 1e-3), 0.0)
    });
    let held: Vec<u8> = body.x.iter().map(|x| if x[2] < 1e-9 || x[2] > 6.9e-3 { 63 } else { 0 }).collect();
    let walls = Walls::default();
    let start: Vec<Six> = body.x.iter().map(|x| [0.0, 0.0, -0.02 * x[2], 0.0, 0.0, 0.0]).collect();
    let solved =
        Body { network: &network, contacts: &contacts, walls: &walls, past: None, held: &held, arm: RADIUS };
    let found = solved.relax(start.clone(), End::Part(1e-10));
    println!("{:?}", found.residuals);
    assert!(found.done && found.residuals.len() <= 9);
    // The forces of the held ends balance.
    let force = |top: bool| -> f64 {
        (0..200).filter(|k| held[*k] == 63 && (body.x[*k][2] > 1e-3) == top).map(|k| found.forces[k][2]).sum()
    };
    near(force(true), -force(false), 1e-9);
    // Stiffer than bonds alone, and the same from another start.
    let bare = Contacts::default();
    let alone = Body { contacts: &bare, ..solved }.relax(start.clone(), End::Part(1e-10));
    let other: f64 =
        (0..200).filter(|k| held[*k] == 63 && body.x[*k][2] > 1e-3).map(|k| alone.forces[k][2]).sum();
    assert!(force(true) < other && other < 0.0);
    let solved =
        Body { network: &network, contacts: &contacts, walls: &walls, past: None, held: &held, arm: RADIUS };
    let ends: Vec<Six> =
        start.iter().zip(&held).map(|(u, held)| if *held == 63 { *u } else { [0.0; 6] }).collect();
    let paper = solved.relax(ends, End::Residuals([1e-10, 1e-8]));
    assert!(paper.done && paper.residuals.last().is_some_and(|r| *r < 1e-8));
    for k in 0..200 {
        (0..3).for_each(|c| assert!((paper.field[k][c] - found.field[k][c]).abs() < 1e-11));
    }
}
