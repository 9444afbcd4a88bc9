//! Central impacts: Chung & Ooi (2011), doi 10.1007/s10035-011-0277-0, tests 1 to 3, and what holds grains together.

use super::scene::{Scene, close, empty, hertz, law, mass, sphere};
use perigrain::world::World;
use std::f64::consts::PI;

/// Largest overlap and force, duration and velocity ratio of an impact along x or onto the plane z = 0.
struct Impact {
    overlap: f64,
    force: f64,
    time: f64,
    restitution: f64,
}

/// Steps through one impact; `state` gives overlap, force on the particle and its velocity away from the other.
fn watch(scene: &mut Scene, dt: f64, state: impl Fn(&World) -> [f64; 3] + Send + 'static) -> Impact {
    let [mut before, _, v] = state(scene.world());
    let mut seen = Impact { overlap: 0.0, force: 0.0, time: 0.0, restitution: 0.0 };
    let (mut step, mut start) = (0.0, None);
    let mut met = false;
    let parts = move |[overlap, ..]: &[f64; 3]| {
        met |= *overlap > 0.0;
        met && *overlap <= 0.0
    };
    for [now, force, out] in scene.watched(100_000, state, parts) {
        step += 1.0;
        // When the surfaces meet and part, between two steps.
        let crossing = (step - 1.0 + before / (before - now)) * dt;
        match start {
            None if now > 0.0 => start = Some(crossing),
            Some(start) if now <= 0.0 => {
                return Impact { time: crossing - start, restitution: out / -v, ..seen };
            }
            _ => {}
        }
        seen = Impact { overlap: seen.overlap.max(now), force: seen.force.max(force), ..seen };
        before = now;
    }
    panic!("no rebound")
}

/// Two equal spheres that meet along x at ±`v`.
fn head_on([radius, density]: [f64; 2], v: f64, model: &str, dt: f64) -> Impact {
    let x = radius + 0.5 * v * dt;
    let deck = empty(4.0 * radius, 1)
        + &sphere([1, 1], [-x, 0.0, 0.0], [radius, density], [v, 0.0, 0.0], [0.0; 3])
        + &sphere([2, 1], [x, 0.0, 0.0], [radius, density], [-v, 0.0, 0.0], [0.0; 3])
        + &law(model, dt);
    watch(&mut Scene::new(&deck), dt, move |w| {
        let p = &w.particles;
        [2.0 * radius - (p.x[1][0] - p.x[0][0]), p.f[1][0], p.v[1][0]]
    })
}

/// A sphere that falls on the plane z = 0.
pub fn on_plane([radius, density]: [f64; 2], v: f64, model: &str, dt: f64) -> [f64; 4] {
    let deck = empty(4.0 * radius, 1)
        + &sphere([1, 1], [0.0, 0.0, radius + 0.5 * v * dt], [radius, density], [0.0, 0.0, -v], [0.0; 3])
        + &law(model, dt)
        + &format!("fix wall all wall/gran granular {model} zplane 0.0 NULL\n");
    let i = watch(&mut Scene::new(&deck), dt, move |w| {
        let p = &w.particles;
        [radius - p.x[0][2], p.f[0][2], p.v[0][2]]
    });
    [i.overlap, i.force, i.time, i.restitution]
}

#[test]
fn test_1_two_spheres_in_elastic_impact() {
    // Radius 10 mm, ±10 m/s; E, ν, density; overlap, force, duration from Hertz' closed form (test-cases.md, T1; the
    // overlap of glass is also LAMMPS' stored reference).
    let cases = [
        ("glass", 48e9, 0.20, 2800.0, [274.113e-6, 10_696.9, 40.340e-6]),
        ("limestone", 20e9, 0.25, 2500.0, [368.304e-6, 7108.24, 54.201e-6]),
    ];
    for (name, young, nu, density, expected) in cases {
        let k = 4.0 / 3.0 * young / (2.0 * (1.0 - nu * nu)) * 0.005_f64.sqrt();
        let exact = hertz(k, 0.5 * mass(0.01, density), 20.0);
        exact.iter().zip(expected).for_each(|(a, b)| close(name, *a, b, 2e-5));
        let model =
            format!("hertz/material {young} 0 {nu} tangential mindlin NULL 1.0 0.35 damping velocity");
        let i = head_on([0.01, density], 10.0, &model, exact[2] / 400.0);
        // The target is 0.1 %; a step of 1/400 of the contact time leaves about 1e-5.
        for (what, got, exact) in
            [("overlap", i.overlap, exact[0]), ("force", i.force, exact[1]), ("time", i.time, exact[2])]
        {
            close(&format!("{name}: {what}"), got, exact, 1e-4);
        }
        close(name, i.restitution, 1.0, 1e-5);
    }
}

/// k of F = k δ^1.5/√R for a sphere on a rigid plane: 4/3 E/(1 − ν²).
fn rigid(young: f64, nu: f64) -> f64 {
    4.0 / 3.0 * young / (1.0 - nu * nu)
}

#[test]
fn test_2_a_sphere_on_a_rigid_plane() {
    // Radius 0.1 m, 0.2 m/s (test-cases.md, T2).
    let cases = [
        ("aluminium", 70e9, 0.30, 2699.0, [49.717e-6, 11_369.9, 731.66e-6]),
        ("magnesium", 40e9, 0.35, 1800.0, [52.123e-6, 7232.68, 767.07e-6]),
    ];
    for (name, young, nu, density, expected) in cases {
        let k = rigid(young, nu);
        let model = format!("hertz {k} 0 tangential linear_nohistory 0 0 damping velocity");
        let got = on_plane([0.1, density], 0.2, &model, expected[2] / 400.0);
        for (k, what) in ["overlap", "force", "time"].iter().enumerate() {
            close(&format!("{name}: {what}"), got[k], expected[k], 1e-4);
        }
    }
}

#[test]
fn test_3_restitution_on_a_plane() {
    // Radius 2.5 mm, 3.9 m/s (test-cases.md, T3): the wanted restitution comes out, whatever the velocity.
    let cases = [
        ("alumina", 380e9, 0.23, 4000.0, [8.0888e-6, 615.35, 6.1045e-6]),
        ("cast iron", 100e9, 0.25, 7000.0, [17.189e-6, 506.76, 12.972e-6]),
    ];
    for (name, young, nu, density, expected) in cases {
        for e in [0.2, 0.4, 0.6, 0.8, 1.0] {
            let k = rigid(young, nu);
            let model = format!("hertz {k} {e} tangential linear_nohistory 0 0 damping coeff_restitution");
            let got = on_plane([0.0025, density], 3.9, &model, expected[2] / 400.0);
            close(name, got[3], e, 5e-3);
            if e == 1.0 {
                (0..3).for_each(|k| close(name, got[k], expected[k], 1e-4));
            }
        }
    }
    // Constants of a material mean a wall of the same material, as in LAMMPS: softer than a rigid one.
    let model = "hertz/material 1e11 1 0.25 tangential linear_nohistory 0 0 damping coeff_restitution";
    let got = on_plane([0.0025, 7000.0], 3.9, model, 12.972e-6 / 400.0);
    close("cast iron on cast iron", got[0], 22.681e-6, 1e-4);
}

#[test]
fn pull_off_forces() {
    // Two spheres drawn apart slowly let go at 4π γ R̄ (DMT) and 3π γ R̄ (JKR), R̄ = R/2: Derjaguin, Muller & Toporov
    // (1975), Johnson, Kendall & Roberts (1971), γ as LAMMPS counts it.
    let (radius, gamma, v) = (0.001, 0.5, 0.001);
    for (name, factor, spans) in [("dmt", 4.0, false), ("jkr", 3.0, true)] {
        let deck = empty(0.01, 1)
            + &sphere([1, 1], [-0.000_999_9, 0.0, 0.0], [radius, 2000.0], [0.0; 3], [0.0; 3])
            + &sphere([2, 1], [0.000_999_9, 0.0, 0.0], [radius, 2000.0], [0.0; 3], [0.0; 3])
            + &law(
                &format!("{name} 1e7 0 0.3 {gamma} damping velocity tangential linear_nohistory 0 0"),
                1e-6,
            )
            + &format!(
                "unfix move\nvelocity g2 set {v} 0 0 units box\nfix pull g2 move linear {v} 0 0 units box\nfix hold g1 setforce 0 0 0\n"
            );
        let mut scene = Scene::new(&deck);
        let mut most = 0.0_f64;
        let mut last = 0.0;
        loop {
            scene.step(20);
            let p = &scene.world().particles;
            let gap = p.x[1][0] - p.x[0][0] - 2.0 * radius;
            let pull = -p.f[1][0];
            if pull == 0.0 && gap > 0.0 {
                break;
            }
            (most, last) = (most.max(pull), gap);
            assert!(gap < 1e-4, "{name} never lets go");
        }
        // 20 steps of 1 nm each between two looks.
        close(name, most, factor * PI * gamma * radius / 2.0, 1e-3);
        // JKR holds beyond touch: −δ = (3/4)^(1/3)… of its own scale; DMT lets go where it touches.
        let e = 1e7 / (2.0 * (1.0 - 0.09));
        let a = (9.0 * PI * gamma * radius * radius / 4.0 / (4.0 * e)).cbrt();
        let tear = 2.0 * (PI * gamma * a / e).sqrt() - a * a / (radius / 2.0);
        close(name, last, if spans { tear } else { 0.0 }, 5e-2);
    }
}
