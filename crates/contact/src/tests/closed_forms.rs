//! Head-on and oblique impacts compared with Hertz' closed form, restitution tables and rigid-sphere sliding.

use super::*;

/// A wall at x < 0 for a sphere from the right: radius 0, and so heavy that it does not move.
fn wall() -> Ball {
    Ball { mass: 1e30, ..Ball::new([0.0; 3], [0.0; 3], [0.0; 3], 0.0, 0.0) }
}

/// A sphere of radius R that just touches the plane x = 0, with sphere-plane curvature (`curvature` = R). The
/// plane is a point of radius 0 kept under the sphere: valid as long as the contact normal is x.
fn against_wall(velocity: Vec3, law: Granular, radius: f64, mass: f64, dt: f64) -> Duel {
    let ball = Ball { mass, ..Ball::new([radius, 0.0, 0.0], velocity, [0.0; 3], radius, 1.0) };
    let mut duel = Duel::new([ball, wall()], law, dt);
    duel.curvature = Some(radius);
    duel
}

/// Steps until the spheres separate; returns largest force, largest overlap, duration and exit velocity.
fn rebound(duel: &mut Duel) -> [f64; 4] {
    let (mut force, mut overlap, mut steps) = (0.0_f64, 0.0_f64, 0);
    loop {
        duel.step();
        duel.balls[1].x = [0.0, duel.balls[0].x[1], duel.balls[0].x[2]];
        duel.balls[1].motion = Motion::default();
        steps += 1;
        if duel.overlap() <= 0.0 {
            return [force, overlap, f64::from(steps) * duel.dt, duel.balls[0].motion.velocity[0]];
        }
        force = force.max(duel.balls[0].force[0]);
        overlap = overlap.max(duel.overlap());
    }
}

/// The steel sphere of Walayat et al. 4.1: R = 10 mm, m = 32.811 g.
const STEEL: (f64, f64) = (0.01, 0.032811);

#[test]
fn hertz_impact_on_a_half_space() {
    // physics.md 4.3: E* = 1.11762e11 Pa (E = 206 GPa, ν = 0.28, twice), v = 1 m/s:
    // overlap 0.023762 mm, force 1726.0 N, duration 69.94 µs.
    let law = model(material(206e9, 0.0, 0.28), Damping::Velocity, mindlin(0.0, 0.0)).law(Compat::Perigrain);
    let (r, m) = STEEL;
    assert!((law.normal.power_law(1.0, 1.0).unwrap()[0] * 0.75 / 1.11762e11 - 1.0).abs() < 1e-5);
    let mut duel = against_wall([-1.0, 0.0, 0.0], law, r, m, 1e-8);
    let [force, overlap, time, v] = rebound(&mut duel);
    // Printed figures: 5 digits; duration in whole steps of 1e-8 s.
    assert!((overlap / 2.3762e-5 - 1.0).abs() < 3e-5 && (force / 1726.0 - 1.0).abs() < 5e-5);
    assert!((time / 69.94e-6 - 1.0).abs() < 3e-4);
    assert!((v - 1.0).abs() < 1e-6);
}

#[test]
fn the_largest_overlap_converges_with_the_square_of_the_step() {
    let law = model(material(206e9, 0.0, 0.28), Damping::Velocity, mindlin(0.0, 0.0)).law(Compat::Perigrain);
    let (r, m) = STEEL;
    // δ_max = (5 m v² / 4 k)^(2/5), k = (4/3) E* √R; error of Verlet at the turning point.
    let exact = (5.0 * m / (4.0 * law.normal.power_law(r, 1.0).unwrap()[0])).powf(0.4);
    let errors = [4e-7, 1e-7].map(|dt| {
        // Overlap at the turning point from energy: 2/5 k δ^(5/2) = ½ m v², so δ is read where v changes
        // sign.
        let mut duel = against_wall([-1.0, 0.0, 0.0], law, r, m, dt);
        let mut last = (duel.overlap(), -1.0);
        loop {
            duel.step();
            let now = (duel.overlap(), duel.balls[0].motion.velocity[0]);
            if now.1 > 0.0 {
                let s = -last.1 / (now.1 - last.1);
                // Cubic Hermite interpolation of the overlap, dδ/dt = −v.
                let (h00, h10) = (2.0 * s.powi(3) - 3.0 * s * s + 1.0, s.powi(3) - 2.0 * s * s + s);
                let (h01, h11) = (3.0 * s * s - 2.0 * s.powi(3), s.powi(3) - s * s);
                let d = h00 * last.0 - h10 * dt * last.1 + h01 * now.0 - h11 * dt * now.1;
                return (d / exact - 1.0).abs();
            }
            last = now;
        }
    });
    let order = (errors[0] / errors[1]).log2() / 2.0;
    assert!((1.8..2.3).contains(&order), "order {order}, errors {errors:?}");
}

/// Restitution of two equal spheres in head-on impact at relative velocity 2 v.
fn restitution(law: Granular, v: f64) -> f64 {
    let ball = |x: f64, v: f64| Ball::new([x, 0.0, 0.0], [v, 0.0, 0.0], [0.0; 3], 0.005, 2500.0);
    // Gap 0.1 µm; the step is about 1/2000 of the contact time at 1 m/s, E = 50 MPa.
    let dt = 2e-7 / v.powf(0.2);
    let mut duel = Duel::new([ball(-0.005_000_05, v), ball(0.005_000_05, -v)], law, dt);
    let mut touched = false;
    loop {
        duel.step();
        touched |= duel.overlap() > 0.0;
        if touched && duel.overlap() <= 0.0 {
            return duel.balls[1].motion.velocity[0] / v;
        }
    }
}

#[test]
fn restitution_is_the_requested_one() {
    // physics.md 4.3: requested and actual e; LAMMPS' tsuji lacks a √2; limit_damping raises e.
    let cases = [
        (
            Damping::CoeffRestitution,
            Compat::Perigrain,
            false,
            [(0.9, 0.9), (0.7, 0.7), (0.5, 0.5), (0.3, 0.3)],
        ),
        (
            Damping::CoeffRestitution,
            Compat::Perigrain,
            true,
            [(0.9, 0.902), (0.7, 0.718), (0.5, 0.550), (0.3, 0.397)],
        ),
        (Damping::Tsuji, Compat::Perigrain, false, [(0.9, 0.900), (0.7, 0.700), (0.5, 0.500), (0.9, 0.900)]),
        (
            Damping::Tsuji,
            Compat::Lammps2025,
            false,
            [(0.9, 0.9284), (0.7, 0.7777), (0.5, 0.6161), (0.9, 0.9284)],
        ),
    ];
    for (damping, compat, limit, pairs) in cases {
        for (asked, expected) in pairs {
            let m = model(material(5e7, asked, 0.3), damping, mindlin(0.0, 0.0));
            let law = Model { limit_damping: limit, ..m }.law(compat);
            let got = restitution(law, 1.0);
            // Three digits in the table; the step adds a few 1e-4.
            assert!((got - expected).abs() < 1.5e-3, "{damping:?} {limit}: {asked} gives {got}");
            // Independent of the velocity.
            assert!((restitution(law, 0.1) - got).abs() < 1e-3);
        }
    }
}

#[test]
fn gross_sliding_of_an_oblique_impact() {
    // physics.md 4.4, Walayat 4.2: R = 5 mm, E* = 6.2952e10, κ = 0.8587; gross sliding beyond 28.2° for μ =
    // 0.092, at 3.9 m/s and 45°, e = 1: v_t' = v_t − μ (1+e) v_n = 2.2503 m/s, ω' = 253.71 rad/s.
    let (mu, r, v) = (0.092, 0.005_f64, 3.9 * std::f64::consts::FRAC_1_SQRT_2);
    let (e_star, g_star) = (6.2952e10, 1.35147e10);
    // Moduli of a like pair with these E* and G*: κ = 4 G*/E* = 2 (1−ν)/(2−ν).
    let kappa: f64 = 4.0 * g_star / e_star;
    let nu = (2.0 - 2.0 * kappa) / (2.0 - kappa);
    let law = model(material(2.0 * e_star * (1.0 - nu * nu), 0.0, nu), Damping::Velocity, mindlin(0.0, mu))
        .law(Compat::Perigrain);
    assert!((law.spring.stiffness / (8.0 * g_star) - 1.0).abs() < 1e-12);
    let mass = 4.0 / 3.0 * std::f64::consts::PI * r.powi(3) * 3850.0;
    let mut duel = against_wall([-v, v, 0.0], law, r, mass, 2e-9);
    let [.., out] = rebound(&mut duel);
    let after = duel.balls[0].motion;
    let v_t = v - 2.0 * mu * v;
    let spin = 2.5 * 2.0 * mu * v / r;
    assert!((out / v - 1.0).abs() < 1e-4);
    // The lever arm R − δ/2 makes ω' smaller than the rigid value by about δ_max/2R ≈ 3e-3.
    assert!((after.velocity[1] / v_t - 1.0).abs() < 1e-4, "{after:?}");
    assert!((after.spin[2].abs() / spin - 1.0).abs() < 5e-3, "{after:?} {spin}");
}
