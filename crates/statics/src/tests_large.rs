//! Displacements of any size and slipping surfaces, compared with closed forms.

use super::contact::Contact;
use super::contacts::Contacts;
use super::lattices::{FCC, lattice};
use super::load_steps::Load;
use super::network::Network;
use super::newton::{Body, End};
use super::six::Six;
use super::walls::Walls;
use perigrain_base::math::body::{after, turn_by, turned};
use perigrain_base::math::vec3::{Vec3, add, dot, length, scale, sub};
use perigrain_base::par;
use perigrain_bonded::stiffness::Stiffness;

fn near(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{a} {b}");
}

fn standard(d: Vec3) -> (Vec3, Stiffness) {
    (d, super::lattices::standard(length(d)))
}

/// Points in rigid motion: rotated by a vector and shifted.
fn rigid(places: &[Vec3], by: Vec3, shift: Vec3) -> Vec<Six> {
    let q = turn_by(by);
    let row = |x: &Vec3| {
        let u = add(sub(turned(q, *x), *x), shift);
        [u[0], u[1], u[2], by[0], by[1], by[2]]
    };
    places.iter().map(row).collect()
}

#[test]
fn a_rigid_motion_costs_nothing() {
    let places = [[0.0; 3], [1e-3, 0.0, 0.0], [0.3e-3, 0.9e-3, 0.2e-3]];
    let ends = [[0, 1], [1, 2], [0, 2]];
    let network =
        Network::new(3, &ends, |k| standard(sub(places[ends[k][1] as usize], places[ends[k][0] as usize])));
    let u = rigid(&places, [0.9, -1.3, 0.4], [5e-3, -2e-3, 0.0]);
    let mut f = vec![[0.0; 6]; 3];
    network.forces(&u, &mut f);
    // Springs of 1e5 N/m over 1e-3 m: rounding of 1e2 N and 1e-1 N m.
    assert!(f.iter().flatten().all(|f| f.abs() < 1e-12), "{f:?}");
    assert!(network.energy_of_large(&u, |_, _| 1.0).iter().all(|e| e.abs() < 1e-15));
    // The small-displacement model does not allow such a rotation.
    network.product(&u, &mut f);
    assert!(f.iter().flatten().any(|f| f.abs() > 1.0));
}

#[test]
fn forces_are_slopes_of_the_energy() {
    let network = Network::new(2, &[[0, 1]], |_| standard([0.6e-3, 0.0, 0.8e-3]));
    let at: Vec<Six> = vec![[1e-5, -2e-5, 4e-5, 0.3, -0.2, 0.5], [-3e-5, 9e-5, 2e-5, 0.1, 0.4, -0.3]];
    let energy = |u: &[Six]| network.energy_of_large(u, |_, _| 1.0).iter().sum::<f64>();
    let mut f = vec![[0.0; 6]; 2];
    network.forces(&at, &mut f);
    for c in 0..12 {
        let moved = |h: f64| {
            let mut u = at.clone();
            let row = &mut u[c / 6];
            if c % 6 < 3 {
                row[c % 6] += 1e-3 * h;
            } else {
                // A rotation after the earlier ones: its vector by the quaternion.
                let mut by = [0.0; 3];
                by[c % 6 - 3] = h;
                let q = after(turn_by(by), turn_by([row[3], row[4], row[5]]));
                let half = length([q[1], q[2], q[3]]);
                let by = scale(2.0 * half.atan2(q[0]) / half, [q[1], q[2], q[3]]);
                (row[3], row[4], row[5]) = (by[0], by[1], by[2]);
            }
            energy(&u)
        };
        let h = 1e-5;
        let slope = (moved(h) - moved(-h)) / (2.0 * h) / if c % 6 < 3 { 1e-3 } else { 1.0 };
        // Central differences: h² times the third derivative, and rounding over h.
        near(f[c / 6][c % 6], slope, 1e-7);
    }
    // Modes add up to the whole.
    let u = vec![[0.0; 6], [0.06e-3, 0.0, 0.08e-3, 0.0, 0.0, 0.0]];
    let [stretch, shear, bend, twist] = network.energy_of_large(&u, |_, _| 1.0);
    near(stretch, 0.5 * network.k[0].normal * 1e-8, 1e-12);
    assert!([shear, bend, twist].iter().all(|e| e.abs() < 1e-12 * stretch));
}

/// Four bars as a rhombus with a spring across it, compressed along its height by a tenth: bars rotate, and
/// the load falls below that for small displacements.
#[test]
fn a_rhombus_of_bars() {
    let (bar, across) = (1e5, 3e4);
    let places = [[0.0; 3], [0.4, 0.0, 0.3], [-0.4, 0.0, 0.3], [0.0, 0.0, 0.6]];
    let ends = [[0, 1], [0, 2], [1, 3], [2, 3], [1, 2]];
    let network = Network::new(4, &ends, |k| {
        let normal = if k < 4 { bar } else { across };
        let [a, b] = ends[k].map(|i: u32| places[i as usize]);
        (sub(b, a), Stiffness { normal, ..Stiffness::default() })
    });
    let delta = -0.06;
    let whole: Vec<Six> = places.iter().map(|x| [0.0, 0.0, delta * x[2] / 0.6, 0.0, 0.0, 0.0]).collect();
    let walls = Walls::default();
    let body = Body {
        network: &network,
        contacts: &Contacts::default(),
        walls: &walls,
        past: None,
        held: &[63, 0, 0, 63],
        arm: 0.5,
    };
    // Half width b at half height h: the outward force of the bars balances the spring.
    let h = 0.3 + 0.5 * delta;
    let force = |b: f64| {
        let l = b.hypot(h);
        let push = bar * (0.5 - l);
        (2.0 * push * b / l - across * 2.0 * (b - 0.4), 2.0 * push * h / l)
    };
    let (mut low, mut high) = (0.4, 0.5);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if force(middle).0 > 0.0 { low = middle } else { high = middle }
    }
    for parts in [1, 3] {
        let load = Load {
            body,
            whole: &whole,
            parts,
            friction: f64::INFINITY,
            pressed: false,
            end: End::Part(1e-9),
        };
        let found = load.carry().found;
        assert!(found.done);
        // The energy is accurate to 1e-18 or to rounding; forces are its derivatives.
        near(found.forces[0][2], force(low).1, 1e-8);
        near(found.forces[3][2], -force(low).1, 1e-8);
        near(found.field[1][0], low - 0.4, 1e-8);
    }
    let small = body.relax(whole.clone(), End::Part(1e-9));
    assert!(
        (small.forces[0][2] / force(low).1 - 1.0).abs() > 0.05,
        "{} {}",
        small.forces[0][2],
        force(low).1
    );
}

/// A sphere pushed down between two others; none of them rotates.
#[test]
fn surfaces_slip() {
    let radius = 0.5e-3;
    let [normal, tangential] = [4.0 / 3.0 * 5.2e8, 8.0 * 1.15e8].map(|c| c * f64::sqrt(0.5 * radius));
    let half = 0.6e-3;
    for (gap, parts) in [(0.0, 1), (0.0, 4), (2e-6, 1)] {
        let rest = 2.0 * radius + gap;
        let height = (rest * rest - half * half).sqrt();
        let places = [[-half, 0.0, 0.0], [half, 0.0, 0.0], [0.0, 0.0, height]];
        let ends = [[0, 2], [1, 2]];
        let contacts = Contacts::new(3, &ends, |k| {
            let d = sub(places[2], places[k]);
            let n = scale(1.0 / rest, d);
            Contact { n, overlap: -gap, normal, tangential, arms: [radius; 2], relaxed: false }
        });
        let down = -1e-5;
        let whole = vec![[0.0; 6], [0.0; 6], [0.0, 0.0, down, 0.0, 0.0, 0.0]];
        let network = Network::new(3, &[], |_| ([0.0; 3], Stiffness::default()));
        let walls = Walls::default();
        let held = [63; 3];
        let body = Body {
            network: &network,
            contacts: &contacts,
            walls: &walls,
            past: None,
            held: &held,
            arm: radius,
        };
        // Distance of the centres, and direction from the lower one.
        let at = |z: f64| {
            let d = [half, 0.0, height + z];
            (length(d), scale(1.0 / length(d), d))
        };
        let (l, n) = at(down);
        let overlap = 2.0 * radius - l;
        let push = normal * overlap.powf(1.5);
        for friction in [0.0, 0.05, f64::INFINITY] {
            let load = Load { body, whole: &whole, parts, friction, pressed: false, end: End::Part(1e-6) };
            let carried = load.carry();
            // Displacement along each other, in the plane of the last contact; in parts, the sum over the
            // contact planes, and only while they touched.
            let mut slid = 0.0;
            for part in 1..=parts {
                let [to, from] = [part, part - 1].map(|p| down * p as f64 / parts as f64);
                let (_, n) = at(to);
                let by = [0.0, 0.0, to - from];
                slid += length(sub(by, scale(dot(n, by), n)));
            }
            if gap > 0.0 {
                slid *= overlap / (overlap + gap);
            }
            let across =
                (tangential * overlap.sqrt() * slid).min(if friction > 0.0 { friction * push } else { 0.0 });
            // Friction holds the sphere back: upwards, in the plane.
            let up = 2.0 * (push * n[2] + across * (1.0 - n[2] * n[2]).sqrt());
            near(-carried.found.forces[2][2], up, 1e-9);
            let slips = if friction < 1.0 { 2 } else { 0 };
            assert_eq!(contacts.touching(&carried.found.field, Some(&carried.past)), [2, slips]);
        }
    }
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let body = lattice(&FCC.0, FCC.1, 12, false);
    assert!(body.x.len() > 3 * par::CHUNK);
    let ends: Vec<[u32; 2]> = body.bonds.iter().map(|b| b.0).collect();
    let height = body.x.iter().fold(0.0f64, |h, x| h.max(x[2]));
    let held: Vec<u8> =
        body.x.iter().map(|x| if x[2] < 1e-9 || x[2] > height - 1e-9 { 63 } else { 0 }).collect();
    let whole: Vec<Six> = body.x.iter().map(|x| [0.0, 0.0, -0.01 * x[2], 0.0, 0.0, 0.0]).collect();
    let walls = Walls::default();
    let one = |threads: usize| {
        par::set_threads(threads);
        let soft = |k: usize| if k.is_multiple_of(7) { 0.01 } else { 0.1 };
        let network = body.network(|k, length| super::lattices::standard(length).times(soft(k)));
        let contacts = Contacts::new(body.x.len(), &ends, |k| {
            let d = body.bonds[k].1;
            Contact {
                n: scale(1.0 / length(d), d),
                overlap: 1e-6,
                normal: 1e7,
                tangential: 1.3e7,
                arms: [0.5e-3; 2],
                relaxed: k.is_multiple_of(2),
            }
        });
        let body = Body {
            network: &network,
            contacts: &contacts,
            walls: &walls,
            past: None,
            held: &held,
            arm: 5e-4,
        };
        let load = Load { body, whole: &whole, parts: 1, friction: 0.2, pressed: true, end: End::Part(0.1) };
        let carried = load.carry();
        let touching = contacts.touching(&carried.found.field, Some(&carried.past));
        par::set_threads(1);
        (carried.found.field, carried.found.iterations, touching)
    };
    let first = one(1);
    assert!(first.1 > 3 && first.2[1] > 100 && first.2[0] > first.2[1], "{:?}", first.2);
    assert!(one(3) == first);
}

#[test]
fn contacts_as_springs_of_the_whole_way() {
    let c = Contact {
        n: [0.0, 0.0, 1.0],
        overlap: 1e-6,
        normal: 1e7,
        tangential: 2e7,
        arms: [0.5e-3; 2],
        relaxed: false,
    };
    let hertz = |overlap: f64| 1e7 * overlap.powf(1.5);
    let apart = [4e-6, 0.0, -3e-6];
    let [along, across] = c.strained(apart, Some(0.1));
    near(along, (hertz(4e-6) - hertz(1e-6)) / 3e-6, 1e-12);
    near(across, 0.1 * hertz(4e-6) / 4e-6, 1e-12);
    // Sticking contacts have Mindlin's stiffness, and without friction only small motions count.
    near(c.strained(apart, Some(10.0))[1], 2e7 * 4e-6f64.sqrt(), 1e-12);
    near(c.strained(apart, None)[0], 1.5e7 * 4e-6f64.sqrt(), 1e-12);
    assert_eq!(c.strained([0.0, 0.0, 2e-6], Some(0.1)), [0.0; 2]);
}
