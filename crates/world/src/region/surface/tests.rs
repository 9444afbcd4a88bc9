//! Surfaces of regions against contact points of LAMMPS, and walls that move.

use super::*;
use crate::region::{Given, Motion, Turn, Variable};
use perigrain_base::diag::Span;
use perigrain_base::math::vec3::dot;

fn look(lammps: bool) -> Look<'static> {
    Look { before: None, lammps }
}

fn near(region: &Region, x: Vec3, reach: f64) -> Vec<Near> {
    let mut out = vec![];
    region.near(x, reach, &look(false), &mut out);
    out
}

/// Nearest points and radii of curvature.
fn points(region: &Region, x: Vec3) -> Vec<(Vec3, f64)> {
    let round = |a: f64| (a * 1e9).round() * 1e-9;
    near(region, x, 0.5)
        .iter()
        .map(|n| (sub(x, scale(n.distance, n.normal)).map(round), round(n.radius)))
        .collect()
}

fn inside(shape: Shape) -> Region {
    Region::inside(shape)
}

fn outside(shape: Shape) -> Region {
    Region { outside: true, ..Region::inside(shape) }
}

fn same(a: &[(Vec3, f64)], b: &[(Vec3, f64)]) -> bool {
    let close = |x: f64, y: f64| (x - y).abs() < 1e-4;
    a.len() == b.len()
        && a.iter().zip(b).all(|(a, b)| (0..3).all(|d| close(a.0[d], b.0[d])) && close(a.1, b.1))
}

// Contact points and curvatures as LAMMPS 22Jul2025 uses them for spheres of radius 0.5 (fix wall/gran/region …
// contacts; the curvature from a Hertz force), five digits.
#[test]
fn points_and_curvatures_are_those_of_lammps() {
    let tube = Shape::Cylinder { axis: 2, center: [0.0; 2], radius: 2.0, lo: -3.0, hi: 3.0 };
    let cone = Shape::Cone { axis: 2, center: [0.0; 2], radius: [2.0, 1.0], lo: -3.0, hi: 3.0 };
    let egg = Shape::Ellipsoid { center: [0.0; 3], half: [2.0, 1.5, 1.0] };
    let prism = Shape::Prism { lo: [-2.0; 3], hi: [2.0; 3], tilt: [1.0, 0.0, 0.0] };
    let cube = Shape::Block { lo: [-2.0; 3], hi: [2.0; 3] };
    let ball = Shape::Sphere { center: [0.0; 3], radius: 2.0 };
    let check = |region: Region, x: Vec3, wanted: &[(Vec3, f64)]| {
        let have = points(&region, x);
        assert!(same(&have, wanted), "{:?} at {x:?}: {have:?}, not {wanted:?}", region.shape);
    };
    check(inside(tube.clone()), [1.7, 0.0, 0.0], &[([2.0, 0.0, 0.0], -4.0)]);
    check(inside(tube.clone()), [2.3, 0.0, 0.0], &[]);
    check(inside(tube.clone()), [0.0, 0.0, 2.8], &[([0.0, 0.0, 3.0], 0.0)]);
    check(outside(tube.clone()), [2.3, 0.0, 0.0], &[([2.0, 0.0, 0.0], 4.0)]);
    check(outside(tube.clone()), [2.2, 0.0, 3.2], &[([2.0, 0.0, 3.0], 4.0)]);
    check(outside(tube), [0.0, 0.0, 3.2], &[([0.0, 0.0, 3.0], 0.0)]);
    check(inside(ball.clone()), [1.7, 0.0, 0.0], &[([2.0, 0.0, 0.0], -2.0)]);
    check(outside(ball), [2.3, 0.0, 0.0], &[([2.0, 0.0, 0.0], 2.0)]);
    check(inside(cone.clone()), [1.2, 0.0, 0.0], &[([1.4919, 0.0, 0.048649], -2.98378)]);
    check(outside(cone), [0.3, 0.0, 3.2], &[([0.3, 0.0, 3.0], 0.0)]);
    check(inside(cube.clone()), [1.7, 0.0, 0.0], &[([2.0, 0.0, 0.0], 0.0)]);
    check(outside(cube), [2.2, 2.2, 2.1], &[([2.0; 3], 0.0)]);
    check(inside(prism.clone()), [2.2, 0.0, 0.0], &[([2.482353, -0.070588, 0.0], 0.0)]);
    check(outside(prism), [3.2, 2.2, 2.1], &[([3.0, 2.0, 2.0], 0.0)]);
    check(inside(egg.clone()), [1.0, 1.0, 0.3], &[([1.0649, 1.12165, 0.39676], 0.0)]);
    check(inside(egg.clone()), [0.0, 0.0, 0.8], &[([0.0, 0.0, 1.0], 0.0)]);
    check(outside(egg), [1.3, 0.9, 0.6], &[([1.25911, 0.85084, 0.53097], 0.0)]);
}

#[test]
fn cones_are_bent_outwards_unless_lammps_is_meant() {
    let cone = outside(Shape::Cone { axis: 2, center: [0.0; 2], radius: [2.0, 1.0], lo: -3.0, hi: 3.0 });
    let bent = |lammps: bool| {
        let mut out = vec![];
        cone.near([1.8, 0.0, 0.0], 0.5, &look(lammps), &mut out);
        out[0].radius
    };
    // LAMMPS 22Jul2025 from its Hertz force: −3.01622.
    assert!((bent(true) + 3.01622).abs() < 1e-5 && bent(false) == -bent(true));
}

#[test]
fn open_faces_are_seen_from_both_sides() {
    let cube = Region { open: 1, ..inside(Shape::Block { lo: [-2.0; 3], hi: [2.0; 3] }) };
    // As LAMMPS: through the open face nothing, past it the rim of the others.
    assert!(points(&cube, [-1.7, 0.0, 0.0]).is_empty() && points(&cube, [-2.1, 0.0, 0.0]).is_empty());
    assert!(same(&points(&cube, [2.2, 0.0, 0.0]), &[([2.0, 0.0, 0.0], 0.0)]));
    assert!(same(&points(&cube, [-2.1, 1.8, 0.0]), &[([-2.0, 2.0, 0.0], 0.0)]));
    let tube = Shape::Cylinder { axis: 2, center: [0.0; 2], radius: 2.0, lo: -3.0, hi: 3.0 };
    let shell = Region { open: 4, ..inside(tube) };
    assert!(same(&points(&shell, [1.9, 0.0, 3.1]), &[([1.9, 0.0, 3.0], 0.0)]));
    assert!(points(&shell, [1.7, 0.0, 0.0]).is_empty());
}

#[test]
fn unions_and_intersections_hide_what_lies_within_the_others() {
    let a = inside(Shape::Block { lo: [-2.0; 3], hi: [2.0; 3] });
    let b = inside(Shape::Block { lo: [1.0, -1.0, -1.0], hi: [5.0, 1.0, 1.0] });
    let both = inside(Shape::Union(vec![a.clone(), b.clone()]));
    assert!(points(&both, [1.8, 0.0, 0.0]).is_empty() && points(&both, [0.9, 0.0, 0.0]).is_empty());
    assert!(same(&points(&both, [1.8, 1.7, 0.0]), &[([2.0, 1.7, 0.0], 0.0), ([1.8, 2.0, 0.0], 0.0)]));
    assert_eq!(points(&both, [4.8, 0.8, 0.8]).len(), 3);
    // From outside: the free part of the first cube's face.
    let out = outside(Shape::Union(vec![a.clone(), b]));
    assert!(same(&points(&out, [2.2, 1.9, 0.0]), &[([2.0, 1.9, 0.0], 0.0)]));
    let mut none = vec![];
    out.near([2.2, 1.9, 0.0], 0.5, &look(true), &mut none);
    assert!(none.is_empty(), "LAMMPS 22Jul2025 feels nothing there");
    let hole = outside(Shape::Sphere { center: [2.0, 0.0, 0.0], radius: 1.5 });
    let rest = inside(Shape::Intersect(vec![a, hole]));
    assert!(same(&points(&rest, [0.3, 0.0, 0.0]), &[([0.5, 0.0, 0.0], 1.5)]));
    assert!(points(&rest, [1.8, 1.2, 0.0]).is_empty());
    // The cube's face, then the ball's.
    assert!(same(
        &points(&rest, [1.8, 1.7, 0.0]),
        &[([2.0, 1.7, 0.0], 0.0), ([1.8, 2.0, 0.0], 0.0), ([1.82474, 1.48973, 0.0], 1.5)]
    ));
}

fn variable() -> Variable {
    Variable { name: "a".into(), span: Span::default() }
}

#[test]
fn moving_walls_carry_and_growing_ones_push() {
    let axis = [0.0, 0.0, 1.0];
    let turn = |angle: f64| Turn {
        variable: variable(),
        point: [1.0, 0.0, 0.0],
        axis,
        given: 2.0,
        angle: angle.into(),
    };
    let motion = |z: f64, angle: f64| {
        Some(Motion { turn: Some(turn(angle)), now: [0.0, 0.0, z], ..Motion::default() })
    };
    let cube = inside(Shape::Block { lo: [-2.0, -3.0, -3.0], hi: [4.0, 3.0, 3.0] });
    let now = Region { motion: motion(0.5, 0.2), ..cube.clone() };
    let was = Region { motion: motion(0.4, 0.1), ..cube };
    let mut out = vec![];
    // The face x = 4, three from the axis, seen from a point that was turned with it.
    let (sin, cos) = 0.2f64.sin_cos();
    let x = [1.0 + 2.8 * cos, 2.8 * sin, 0.5];
    now.near(x, 0.5, &Look { before: Some((&was, 0.01)), lammps: false }, &mut out);
    assert_eq!(out.len(), 1);
    let n = out[0];
    assert!((n.normal[0] + cos).abs() < 1e-12 && (n.distance - 0.2).abs() < 1e-12);
    // 10 rad per time at arm 3, 10 along z.
    let wanted = [-30.0 * sin, 30.0 * cos, 10.0];
    assert!((0..3).all(|d| (n.velocity[d] - wanted[d]).abs() < 1e-9), "{:?}", n.velocity);
    assert!((now.travel(&was, &[[4.0, 0.0, 0.5]]) - (0.1 + 0.3)).abs() < 1e-12);

    let grows = |radius: f64| Region {
        given: vec![Given { number: 2, variable: variable(), scale: 1.0 }],
        ..inside(Shape::Cylinder { axis: 2, center: [0.0; 2], radius, lo: -3.0, hi: 3.0 })
    };
    let (now, was) = (grows(2.0), grows(2.01));
    let mut out = vec![];
    now.near([1.8, 0.0, 0.0], 0.5, &Look { before: Some((&was, 0.1)), lammps: true }, &mut out);
    // It shrinks by 0.01 in 0.1: inwards at 0.1.
    assert!((dot(out[0].velocity, [1.0, 0.0, 0.0]) + 0.1).abs() < 1e-12);
    assert_eq!(now.travel(&was, &[]), f64::INFINITY);
    let mut pose = vec![];
    now.pose(&mut pose);
    let mut again = was.clone();
    again.set_pose(&mut pose.into_iter());
    assert_eq!(again, now);
}
