//! Spheres on a plane: from sliding to rolling, down an incline, and rolling and twisting to rest.

use super::scene::{Scene, close, empty, law, sphere};

const R: f64 = 0.01;
const G: f64 = 9.81;

/// A sphere that lies on z = 0 with its own weight's overlap, moving along x and spinning; gravity leans by `slope`.
fn on_plane(model: &str, v: f64, omega: [f64; 3], slope: f64) -> Scene {
    // Weight m g = kn δ with kn = 1e5 N/m.
    let weight = super::scene::mass(R, 2500.0) * G * slope.cos();
    let z = R - weight / 1e5;
    let deck = empty(2.0, 1)
        + &sphere([1, 1], [-1.9, 0.0, z], [R, 2500.0], [v, 0.0, 0.0], omega)
        + &law(model, 1e-5)
        + &format!("fix down all gravity {G} vector {} 0 {}\n", slope.sin(), -slope.cos())
        + &format!("fix wall all wall/gran granular {model} zplane 0.0 NULL\n");
    Scene::new(&deck)
}

fn model(mu: f64, more: &str) -> String {
    format!("hooke 1e5 10 damping velocity tangential linear_history 8e4 1.0 {mu} {more}")
}

fn motion(scene: &Scene) -> ([f64; 3], [f64; 3], f64) {
    let p = &scene.world().particles;
    (p.v[0], p.omega[0], p.x[0][0])
}

#[test]
fn sliding_turns_into_rolling() {
    // v₀ = 1 m/s, μ = 0.3: rolls at 5/7 v₀ after t = 2 v₀/(7 μ g) = 97.1 ms and 12 v₀²/(49 μ g) = 83.2 mm
    // (physics.md 4.4).
    let mut scene = on_plane(&model(0.3, ""), 1.0, [0.0; 3], 0.0);
    scene.step(5000);
    let (v, omega, _) = motion(&scene);
    // Halfway: v₀ − μ g t and 5/2 μ g t/R.
    close("v", v[0], 1.0 - 0.3 * G * 0.05, 2e-3);
    close("ω", omega[1], 2.5 * 0.3 * G * 0.05 / R, 2e-3);
    scene.step(15_000);
    let (v, omega, x) = motion(&scene);
    close("v", v[0], 5.0 / 7.0, 2e-3);
    close("ω R", omega[1] * R, 5.0 / 7.0, 2e-3);
    let slid = 12.0 / 49.0 / (0.3 * G);
    let rolled = 5.0 / 7.0 * (0.2 - 2.0 / (7.0 * 0.3 * G));
    close("x", x + 1.9, slid + rolled, 3e-3);
}

#[test]
fn rolling_down_an_incline() {
    // a = 5/7 g sin β while tan β < 7/2 μ; with rolling friction 5/7 g (sin β − μ_r cos β).
    let slope = 0.2_f64;
    for (more, mu_r) in [("", 0.0), ("rolling sds 2e4 5.0 0.05", 0.05)] {
        let mut scene = on_plane(&model(0.5, more), 0.0, [0.0; 3], slope);
        scene.step(5000);
        let early = motion(&scene).0[0];
        scene.step(20_000);
        let late = motion(&scene).0[0];
        let a = 5.0 / 7.0 * G * (slope.sin() - mu_r * slope.cos());
        close(&format!("acceleration {more}"), (late - early) / 0.2, a, 1e-2);
    }
}

#[test]
fn rolling_and_twisting_come_to_rest() {
    // Rolling friction slows rolling at 5/7 μ_r g; a twist loses 5 μ_t g/(2 R²) (sds, μ_t a length) and
    // 5/3 μ a g/R² (marshall) of its spin (unittest/granular of LAMMPS has the same forms).
    let v = 0.5;
    let mut scene = on_plane(&model(0.5, "rolling sds 2e4 5.0 0.05"), v, [0.0, v / R, 0.0], 0.0);
    scene.step(5000);
    let early = motion(&scene).0[0];
    scene.step(20_000);
    close("rolling", early - motion(&scene).0[0], 5.0 / 7.0 * 0.05 * G * 0.2, 1e-2);

    let weight = super::scene::mass(R, 2500.0) * G;
    let a = (R * weight / 1e5).sqrt();
    let cases = [
        ("twisting sds 1.0 1e-4 1e-4", 2.5 * 1e-4 * G / (R * R)),
        ("twisting marshall", 5.0 / 3.0 * 0.5 * a * G / (R * R)),
    ];
    for (more, rate) in cases {
        let mut scene = on_plane(&model(0.5, more), 0.0, [0.0, 0.0, 100.0], 0.0);
        scene.step(2000);
        let early = motion(&scene).1[2];
        scene.step(5000);
        close(more, early - motion(&scene).1[2], rate * 0.05, 1e-2);
    }
}
