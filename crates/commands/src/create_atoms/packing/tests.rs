//! Tests of packings without a deck.

use super::aggregate::{LINK, thin};
use super::pores::{Axis, Pores};
use super::sizes::{Amount, Sizes};
use super::*;
use perigrain_base::math::vec3::length;
use perigrain_world::region::Shape;
use perigrain_world::{Boundary, Domain, Face, Region};
use std::f64::consts::PI;

const PLAIN: Goal = Goal { overlap: None, rounds: 1000 };

fn domain(size: Vec3, faces: [Face; 3]) -> Domain {
    Domain::new([0.0; 3], size, Boundary(faces.map(|f| [f; 2])))
}

/// A cube of the box itself.
fn cube(edge: f64, face: Face) -> Room {
    let block = Region::inside(Shape::Block { lo: [0.0; 3], hi: [edge; 3] });
    Room::new(&domain([edge; 3], [face; 3]), &block).unwrap()
}

fn packed(room: &Room, share: f64, sizes: Sizes, seed: u32, goal: &Goal) -> Packing {
    let mut stream = ParkMiller::new(seed);
    let radii = sizes.radii(Amount::Volume(share * room.volume()), &mut stream);
    pack(room, radii, &mut stream, goal).unwrap()
}

/// Gaps of all pairs as parts of the distance of touching spheres, by testing each pair.
fn gaps(room: &Room, p: &Packing) -> Vec<f64> {
    let n = p.x.len();
    let mut list = vec![];
    for i in 0..n {
        for j in 0..i {
            let touch = p.radius[i] + p.radius[j];
            list.push(length(room.nearest(sub(p.x[i], p.x[j]))) / touch - 1.0);
        }
    }
    list
}

fn share(room: &Room, p: &Packing) -> f64 {
    p.radius.iter().map(|r| 4.0 / 3.0 * PI * r.powi(3)).sum::<f64>() / room.volume()
}

/// Whether the largest and the mean overlap match the outcome, to rounding.
fn matches_outcome(room: &Room, p: &Packing) {
    let over: Vec<f64> = gaps(room, p).into_iter().filter(|g| *g < 0.0).map(|g| -g).collect();
    let largest = over.iter().copied().fold(0.0, f64::max);
    let mean = over.iter().sum::<f64>() / over.len().max(1) as f64;
    // Positions were wrapped after measuring: a few roundings of numbers of the box's size.
    assert!((largest - p.came.largest).abs() < 1e-12, "{largest} {:?}", p.came);
    // Pairs that only just touch may count once and not the other time.
    assert!((mean - p.came.mean).abs() < 1e-6, "{mean} {:?}", p.came);
    let mut spare = vec![];
    for (x, r) in p.x.iter().zip(&p.radius) {
        assert!(room.contains(*x) && room.beyond(*x, *r, &mut spare) <= p.came.beyond + 1e-12);
    }
}

#[test]
fn the_share_is_reached_with_overlaps_below_a_thousandth() {
    for face in [Face::Periodic, Face::Fixed] {
        let room = cube(12.0, face);
        let p = packed(&room, 0.58, Sizes::Mono(1.0), 4711, &PLAIN);
        // Whole spheres: to half of one.
        assert!((share(&room, &p) - 0.58).abs() < 0.5 * PI / 6.0 / 12f64.powi(3));
        assert!(p.came.reached && p.came.mean < 1e-3 && p.came.largest < 0.02, "{:?}", p.came);
        matches_outcome(&room, &p);
    }
}

#[test]
fn a_box_of_two_diameters_repeats_rightly() {
    let room = cube(2.01, Face::Periodic);
    let p = packed(&room, 0.4, Sizes::Mono(1.0), 6, &Goal { overlap: Some(1e-6), rounds: 3000 });
    assert!(p.x.len() == 6 && p.came.reached, "{:?}", p.came);
    matches_outcome(&room, &p);
}

#[test]
fn coordination_numbers_of_a_dense_packing() {
    let room = cube(19.0, Face::Fixed);
    let p = packed(&room, 0.60, Sizes::Mono(1.0), 12, &PLAIN);
    let near = Nearby::find(&room, &p.x, &p.radius, 0.75);
    let inner: Vec<usize> =
        (0..p.x.len()).filter(|&i| p.x[i].iter().all(|a| (2.5..16.5).contains(a))).collect();
    // The table of bonded particles' page, 8.1, for packings with walls and without memory at this share. Interior spheres lie
    // denser than the share, depending on how many there are at walls, so that sizes differ by a percent or two; the statistical
    // error of some 3000 spheres is half a percent. Gap 0 is left out: whether two only just touch depends on when rounds end.
    let table = [
        (0.05, 7.6),
        (0.1, 8.5),
        (0.15, 9.2),
        (0.2, 10.0),
        (0.3, 11.3),
        (0.4, 12.8),
        (0.6, 17.4),
        (0.7, 21.7),
    ];
    for (gap, wanted) in table {
        let within = |i: usize, j: u32| length(sub(p.x[i], p.x[j as usize])) - 1.0 <= gap;
        let count: usize = inner.iter().map(|&i| near.row(i).iter().filter(|&&j| within(i, j)).count()).sum();
        let z = count as f64 / inner.len() as f64;
        assert!((z / wanted - 1.0).abs() < 0.04, "gap {gap}: {z}, not {wanted}");
    }
}

#[test]
fn same_seed_same_bits_for_any_number_of_threads() {
    // More than one chunk of spheres.
    let room = cube(17.0, Face::Periodic);
    let of = |threads: usize, seed: u32| {
        par::set_threads(threads);
        let p = packed(&room, 0.55, Sizes::Lognormal(1.0, 0.1), seed, &PLAIN);
        par::set_threads(1);
        assert!(p.x.len() > par::CHUNK);
        (p.x, p.radius, p.came)
    };
    let one = of(1, 3);
    assert!(one == of(1, 3) && one == of(3, 3));
    assert!(one.0 != of(1, 4).0);
}

#[test]
fn two_sizes_lie_between_each_other() {
    let room = cube(10.0, Face::Periodic);
    let mut stream = ParkMiller::new(99);
    // 150 spheres of diameter 1.6 and 1000 of diameter 0.8: share 0.59.
    let radius: Vec<f64> = (0..1150).map(|k| if k % 23 < 3 { 0.8 } else { 0.4 }).collect();
    let p = pack(&room, radius, &mut stream, &PLAIN).unwrap();
    assert!(p.came.reached, "{:?}", p.came);
    matches_outcome(&room, &p);
    assert_eq!(p.radius.iter().filter(|r| **r == 0.8).count(), 150);
}

#[test]
fn sizes_have_their_volume_and_range() {
    let mut stream = ParkMiller::new(5);
    for (sizes, low) in [(Sizes::Uniform(0.5, 1.5), 0.5), (Sizes::Lognormal(1.0, 0.2), (-0.5f64).exp())] {
        let radii = sizes.radii(Amount::Volume(5000.0), &mut stream);
        let volume: f64 = radii.iter().map(|r| 4.0 / 3.0 * PI * r.powi(3)).sum();
        assert!((volume - 5000.0).abs() < sizes.mean_volume() * 2.0);
        assert!(radii.iter().all(|r| 2.0 * r >= low && 2.0 * r <= sizes.largest()));
        // Standard error of the mean of some 10⁴ volumes that scatter as much as they are large: 1 %; the cut tail 1 %.
        let number = 5000.0 / sizes.mean_volume();
        assert!((radii.len() as f64 / number - 1.0).abs() < 0.04, "{sizes:?} {}", radii.len());
    }
}

#[test]
fn no_overlap_where_none_is_allowed() {
    for face in [Face::Periodic, Face::Fixed] {
        let room = cube(8.0, face);
        let p = packed(&room, 0.57, Sizes::Mono(1.0), 8, &Goal { overlap: Some(0.0), rounds: 300 });
        assert!(gaps(&room, &p).into_iter().all(|gap| gap >= 0.0));
        assert!(p.came.beyond <= 0.0 && p.came.shrunk > 0.97 && p.came.shrunk < 1.0, "{:?}", p.came);
        assert_eq!(p.radius[0], 0.5 * p.came.shrunk);
    }
}

#[test]
fn the_largest_overlap_can_be_requested() {
    let room = cube(8.0, Face::Periodic);
    let p = packed(&room, 0.55, Sizes::Mono(1.0), 8, &Goal { overlap: Some(1e-3), rounds: 1000 });
    assert!(p.came.reached && p.came.largest <= 1e-3 && p.came.largest > 0.0);
    let p = packed(&room, 0.68, Sizes::Mono(1.0), 8, &Goal { overlap: Some(1e-3), rounds: 50 });
    assert!(!p.came.reached && p.came.rounds == 50 && p.came.mean > 0.01, "{:?}", p.came);
}

#[test]
fn spheres_keep_inside_of_regions() {
    let tube = Region::inside(Shape::Cylinder { axis: 2, center: [5.0; 2], radius: 4.0, lo: 0.0, hi: 10.0 });
    let ball = Region::inside(Shape::Sphere { center: [5.0; 3], radius: 4.5 });
    let core = Region::inside(Shape::Sphere { center: [5.0, 5.0, 1.0], radius: 2.0 });
    let hole = Region { outside: true, ..core };
    let block = Region::inside(Shape::Block { lo: [3.0, -1.0, 2.0], hi: [6.0, 20.0, 7.0] });
    let gap = Region { outside: true, ..block };
    let egg = Region::inside(Shape::Ellipsoid { center: [5.0; 3], half: [5.0, 4.0, 3.0] });
    let cone =
        Region::inside(Shape::Cone { axis: 0, center: [5.0; 2], radius: [2.0, 5.0], lo: 0.0, hi: 10.0 });
    let slope = Region::inside(Shape::Plane { point: [5.0; 3], normal: [1.0, 1.0, 0.0] });
    let both = Region::inside(Shape::Intersect(vec![tube.clone(), slope]));
    let fixed = [Face::Fixed; 3];
    for (region, faces) in [
        (&tube, fixed),
        (&tube, [Face::Fixed, Face::Fixed, Face::Periodic]),
        (&ball, fixed),
        (&hole, fixed),
        (&hole, [Face::Periodic, Face::Periodic, Face::Fixed]),
        (&gap, [Face::Periodic; 3]),
        (&gap, fixed),
        (&egg, fixed),
        (&cone, fixed),
        (&both, fixed),
    ] {
        let room = Room::new(&domain([10.0; 3], faces), region).unwrap();
        let p = packed(&room, 0.5, Sizes::Mono(0.8), 21, &PLAIN);
        assert!(p.came.reached && p.came.beyond < 1e-3, "{region:?} {:?}", p.came);
        matches_outcome(&room, &p);
        assert!(p.x.iter().all(|x| region.contains(*x)));
    }
    // Open along z: the tube has no ends there, and spheres lie across the face.
    let room = Room::new(&domain([10.0; 3], [Face::Fixed, Face::Fixed, Face::Periodic]), &tube).unwrap();
    let p = packed(&room, 0.5, Sizes::Mono(0.8), 21, &PLAIN);
    assert!(p.x.iter().any(|x| x[2] < 0.3) && p.x.iter().any(|x| x[2] > 9.7));
    // A hole that crosses the face is met from its other side.
    let room = Room::new(&domain([10.0; 3], [Face::Periodic; 3]), &hole).unwrap();
    assert_eq!(room.period, [10.0, 10.0, 0.0]);
}

#[test]
fn leaning_boxes_are_packed_through_their_faces() {
    let tilt = [2.0, -1.5, 1.0];
    let whole = Region::inside(Shape::Prism { lo: [0.0; 3], hi: [8.0; 3], tilt });
    let ball = Region::inside(Shape::Sphere { center: [4.0, 4.5, 4.0], radius: 3.0 });
    let (periodic, fixed) = ([Face::Periodic; 3], [Face::Periodic, Face::Periodic, Face::Fixed]);
    for (faces, region, volume) in
        [(periodic, &whole, 512.0), (fixed, &whole, 512.0), (periodic, &ball, 36.0 * PI)]
    {
        let leaning = Domain { tilt: Some(tilt), ..domain([8.0; 3], faces) };
        let room = Room::new(&leaning, region).unwrap();
        let p = packed(&room, 0.55, Sizes::Mono(0.9), 31, &PLAIN);
        // Sample points of the ball's box: a hundred along each edge.
        assert!((room.volume() / volume - 1.0).abs() < 2e-3, "{} {volume}", room.volume());
        assert!(p.came.reached, "{:?}", p.came);
        matches_outcome(&room, &p);
        assert!(p.x.iter().all(|x| leaning.holds(x) || region == &ball), "{faces:?}");
        assert!(p.x.iter().all(|x| region.contains(*x)));
        // Where the box repeats spheres lie across its faces.
        let near = |d: usize| p.x.iter().any(|x| leaning.fractions(x)[d] < 0.02);
        assert_eq!(
            [0, 1, 2].map(near),
            if region == &ball { [false; 3] } else { [true, true, faces == periodic] }
        );
    }
}

#[test]
fn mixtures_have_their_parts() {
    let mut stream = ParkMiller::new(7);
    let count = |radii: &[f64], d: f64| radii.iter().filter(|r| **r == 0.5 * d).count();
    let two = Sizes::by_number(&[(1.0, 3.0), (2.0, 1.0)]);
    let radii = two.radii(Amount::Number(1001), &mut stream);
    assert_eq!([count(&radii, 1.0), count(&radii, 2.0)], [751, 250]);
    // 70 parts of the mass in large ones, 30 in those of half the diameter: 24 small ones to 7 large ones.
    let two = Sizes::by_mass(&[(2.0, 70.0), (1.0, 30.0)]);
    let radii = two.radii(Amount::Number(310), &mut stream);
    assert_eq!([count(&radii, 2.0), count(&radii, 1.0)], [70, 240]);
    let radii = two.radii(Amount::Volume(1000.0), &mut stream);
    let volume = |d: f64| count(&radii, d) as f64 * PI / 6.0 * d.powi(3);
    // A whole number of spheres of each size.
    assert!((volume(2.0) - 700.0).abs() < 2.1 && (volume(1.0) - 300.0).abs() < 0.3);
    assert_eq!([two.kind_of(1.02), two.kind_of(1.9), two.largest() as usize], [1, 0, 2]);
    assert_eq!(Sizes::Mono(1.0).radii(Amount::Number(5), &mut stream), [0.5; 5]);
    assert_eq!(Sizes::Uniform(1.0, 2.0).radii(Amount::Number(50), &mut stream).len(), 50);
}

#[test]
fn volumes_of_rooms() {
    let b = domain([4.0; 3], [Face::Fixed; 3]);
    let volume = |shape: Shape| Room::new(&b, &Region::inside(shape)).unwrap().volume();
    let tube = |radius: f64| Shape::Cylinder { axis: 1, center: [2.0; 2], radius, lo: -1e20, hi: 3.0 };
    assert!((volume(tube(1.0)) - 3.0 * PI).abs() < 1e-12);
    assert!((volume(Shape::Sphere { center: [2.0; 3], radius: 1.0 }) - 4.0 / 3.0 * PI).abs() < 1e-12);
    // By points: 10⁶ of them, of which those near the surface, a hundredth, are right or wrong by chance.
    let egg = volume(Shape::Ellipsoid { center: [2.0; 3], half: [2.0, 1.5, 1.0] });
    assert!((egg / (4.0 * PI) - 1.0).abs() < 1e-3, "{egg}");
    let cut = volume(Shape::Sphere { center: [0.0; 3], radius: 2.0 });
    assert!((cut / (4.0 / 3.0 * PI) - 1.0).abs() < 2e-3, "{cut}");
    assert_eq!(volume(Shape::Sphere { center: [9.0; 3], radius: 2.0 }), 0.0);
}

fn opal(spacing: f64, axis: Axis, faces: Face, diameter: f64) -> (Room, Pores) {
    let pores = Pores::new([0.0; 3], diameter, spacing, axis);
    let size = pores.cell();
    let block = Region::inside(Shape::Block { lo: [0.0; 3], hi: size });
    (Room::new(&domain(size, [faces; 3]), &block).unwrap().with_pores(pores.clone()), pores)
}

#[test]
fn walls_of_an_opal_have_their_share_of_the_cell() {
    for axis in [Axis::Cube, Axis::Layers] {
        // 1 − π/(3√2) for pores that touch; with windows, lens by lens: each pore loses twelve caps of height h = (1 − s)/2
        // diameters, so 1 − π√2/(6 s³) + √2·12·π h² (3/2 − h)/3/s³ in units of the diameter: 0.195 at s = 0.97.
        for spacing in [1.0, 0.97] {
            let h = 0.5 * (1.0 - spacing);
            let caps = 12.0 * PI * h * h * (1.5 - h) / 3.0;
            let wanted = 1.0 - 2f64.sqrt() * (PI / 6.0 - caps) / f64::powi(spacing, 3);
            let (room, pores) = opal(spacing, axis, Face::Periodic, 3.0);
            let share = room.volume() / pores.cell().iter().product::<f64>();
            // 10⁶ points.
            assert!((share - wanted).abs() < 2e-3, "{share} {wanted}");
        }
    }
}

#[test]
fn spheres_of_an_opal_lie_between_the_pores() {
    for (axis, face) in [(Axis::Cube, Face::Periodic), (Axis::Layers, Face::Fixed)] {
        let (room, pores) = opal(0.97, axis, face, 10.0);
        let p = packed(&room, 0.5, Sizes::Mono(0.5), 77, &PLAIN);
        assert!(p.x.len() > 1000);
        matches_outcome(&room, &p);
        // In wedges between pores and faces spheres are pushed to and fro: a little of that is left.
        assert!(p.came.beyond < 0.01, "{:?}", p.came);
        assert!(p.x.iter().all(|x| pores.distance(*x) > 0.24));
    }
}

/// Whether spheres are connected over gaps up to [`LINK`], by testing each pair.
fn connected(room: &Room, x: &[Vec3], radius: f64) -> bool {
    let mut reached = vec![false; x.len()];
    let mut todo = vec![0];
    reached[0] = true;
    while let Some(i) = todo.pop() {
        for j in 0..x.len() {
            let gap = length(room.nearest(sub(x[i], x[j]))) - 2.0 * radius;
            if !reached[j] && gap <= LINK * 2.0 * radius * (1.0 + 1e-9) {
                reached[j] = true;
                todo.push(j);
            }
        }
    }
    reached.into_iter().all(|r| r)
}

#[test]
fn an_aggregate_is_one_part_from_end_to_end() {
    let block = Region::inside(Shape::Block { lo: [0.0; 3], hi: [12.0, 12.0, 16.0] });
    for faces in [[Face::Fixed; 3], [Face::Periodic, Face::Periodic, Face::Fixed]] {
        let room = Room::new(&domain([12.0, 12.0, 16.0], faces), &block).unwrap();
        let p = packed(&room, 0.6, Sizes::Mono(1.0), 3, &PLAIN);
        let left = thin(&room, &p, 0.3 * room.volume(), 6.0, &mut ParkMiller::new(17)).unwrap();
        let number = left.kept.len() + left.lost;
        assert!((number as f64 - 0.3 * room.volume() / (PI / 6.0)).abs() <= 0.5);
        assert!(left.lost < number / 5, "{} of {number}", left.lost);
        let x: Vec<Vec3> = left.kept.iter().map(|&k| p.x[k]).collect();
        assert!(connected(&room, &x, 0.5) && left.axis == 2);
        assert!(x.iter().any(|x| x[2] < 1.5) && x.iter().any(|x| x[2] > 14.5));
        // Far too little to reach from end to end.
        assert!(thin(&room, &p, 0.02 * room.volume(), 6.0, &mut ParkMiller::new(17)).is_none());
    }
}
