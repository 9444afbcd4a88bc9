//! Oblique collisions: comparison with LAMMPS, mixing of types, conservation, exact action and reaction.

use super::*;
use perigrain_base::math::vec3::dot;

/// The spheres of the reference decks gr2_*: unequal, spinning, 5 mm and 4 mm.
fn spheres() -> [Ball; 2] {
    [
        Ball::new([-0.0052, 0.0, 0.0], [1.0, 0.25, 0.0], [20.0, -30.0, 40.0], 0.005, 2500.0),
        Ball::new([0.0052, 0.0025, 0.001], [-1.5, 0.0, -0.1], [0.0, 15.0, -25.0], 0.004, 4000.0),
    ]
}

/// A golden column by its name in the thermo table.
fn column(name: &str, [a, b]: &[Ball; 2]) -> f64 {
    let kinetic = |b: &Ball| 0.5 * b.mass * dot(b.motion.velocity, b.motion.velocity);
    let rotation = |b: &Ball| 0.5 * b.inertia() * dot(b.motion.spin, b.motion.spin);
    match name {
        "KinEng" => kinetic(a) + kinetic(b),
        "c_er" => rotation(a) + rotation(b),
        "v_x1" => a.x[0],
        "v_y1" => a.x[1],
        "v_vx1" => a.motion.velocity[0],
        "v_vy1" => a.motion.velocity[1],
        "v_vz1" => a.motion.velocity[2],
        "v_vx2" => b.motion.velocity[0],
        "v_fx1" => a.force[0],
        "v_fy1" => a.force[1],
        "v_wz1" => a.motion.spin[2],
        "v_wx2" => b.motion.spin[0],
        "v_wz2" => b.motion.spin[2],
        "v_tz1" => a.torque[2],
        _ => panic!("unknown column {name}"),
    }
}

/// The golden table of a reference deck, and the largest deviation of a duel with this law.
fn agrees(golden: &str, law: Granular) {
    let mut duel = Duel::new(spheres(), law, 1e-6);
    let mut lines = golden.lines().filter(|l| !l.starts_with('#'));
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> = lines.map(|l| l.split(',').map(|w| w.parse().unwrap()).collect()).collect();

    duel.forces(false);
    let mut made = 0;
    let mut worst = vec![0.0_f64; names.len()];
    for row in &rows {
        while made < row[1] as usize {
            duel.step();
            made += 1;
        }
        for c in 3..names.len() {
            worst[c] = worst[c].max((column(names[c], &duel.balls) - row[c]).abs());
        }
    }
    for c in 3..names.len() {
        let largest = rows.iter().map(|r| r[c].abs()).fold(0.0, f64::max);
        // tolerances.json requires 1e-10 of the column's largest value; the decks' noise is below 6e-13.
        let part = worst[c] / largest;
        assert!(worst[c] < 2e-12 * largest, "{:?}: {} deviates by {part:e}", law.spring.kind, names[c]);
    }
}

macro_rules! golden {
    ($name:literal) => {
        include_str!(concat!("../../../../tests/lammps/golden/gr2_", $name, ".csv"))
    };
}

const NU: f64 = 0.3;

fn rolls(stiffness: f64, damping: f64, mu: f64) -> Rolling {
    Rolling::Sds(Sds { stiffness, damping, mu })
}

/// Every model of the reference decks gr2_g_*, with the parameters of these decks.
#[test]
fn every_granular_model_agrees_with_lammps() {
    let spring = |kind, k, x_gamma, mu| Tangential::new(kind, k, x_gamma, mu);
    let hooke = |stiffness, eta| Normal::new(&normal::HOOKE, &[stiffness, eta]);
    let hertz = |stiffness, eta| Normal::new(&normal::HERTZ, &[stiffness, eta]);
    let of = |m: Model| m.law(Compat::Lammps2025);

    let m = model(material(5.0e7, 3.0e5, NU), Damping::Viscoelastic, mindlin(0.5, 0.4));
    agrees(golden!("g_mindlin"), of(m));
    let t = spring(Friction::LinearHistory, Some(1.2e5), 0.8, 0.4);
    let m = model(hooke(2.0e5, 200.0), Damping::MassVelocity, t);
    agrees(
        golden!("g_hooke"),
        of(Model { rolling: rolls(5.0e4, 20.0, 0.2), twisting: Twisting::Marshall, ..m }),
    );
    let t = spring(Friction::LinearHistory, Some(1.0e5), 1.0, 0.3);
    agrees(golden!("g_coeffrest"), of(model(hooke(2.0e5, 0.55), Damping::CoeffRestitution, t)));
    let t = spring(Friction::LinearNohistory, Some(0.0), 0.7, 0.35);
    agrees(golden!("g_hertz_nohist"), of(model(hertz(2.0e8, 0.2), Damping::Velocity, t)));
    let t = spring(Friction::MindlinForce, None, 1.0, 0.15);
    agrees(golden!("g_mindlin_force"), of(model(material(5.0e7, 0.7, NU), Damping::Tsuji, t)));
    let t = spring(Friction::MindlinRescale, None, 0.6, 0.5);
    agrees(golden!("g_rescale"), of(model(material(5.0e7, 0.6, 0.25), Damping::Tsuji, t)));
    let t = spring(Friction::MindlinRescaleForce, Some(6.0e7), 0.6, 0.5);
    let m = model(hertz(8.0e7, 2.0e5), Damping::Viscoelastic, t);
    let twisting = Twisting::Sds(Sds { stiffness: 1.0, damping: 1.0e-4, mu: 0.3 });
    agrees(golden!("g_rescale_force"), of(Model { twisting, ..m }));
}

#[test]
fn sticky_models_agree_with_lammps() {
    let turning = |m| Model { rolling: rolls(3.0e4, 10.0, 0.3), twisting: Twisting::Marshall, ..m };
    let dmt = Normal::new(&normal::DMT, &[5.0e7, 3.0e5, NU, 2.0]);
    let m = model(dmt, Damping::Viscoelastic, mindlin(1.0, 0.4));
    agrees(golden!("g_dmt"), turning(m).law(Compat::Lammps2025));
    let jkr = Normal::new(&normal::JKR, &[5.0e7, 100.0, NU, 5.0]);
    let m = model(jkr, Damping::MassVelocity, mindlin(1.0, 0.4));
    agrees(golden!("g_jkr"), turning(m).law(Compat::Lammps2025));
}

#[test]
fn mixed_models_agree_with_lammps() {
    let one = model(material(8.0e7, 3.0e5, 0.25), Damping::Viscoelastic, mindlin(0.5, 0.5));
    let two = model(material(3.0e7, 1.0e5, 0.40), Damping::Viscoelastic, mindlin(1.0, 0.2));
    let one = Model { rolling: rolls(5.0e4, 5.0, 0.2), twisting: Twisting::Marshall, ..one };
    let two = Model { rolling: rolls(2.0e4, 2.0, 0.1), twisting: Twisting::Marshall, ..two };
    agrees(golden!("g_mixed"), one.mixed(&two, Compat::Lammps2025).unwrap());
}

#[test]
fn older_styles_agree_with_lammps() {
    let classic = |hertz, history, stiffness, gamma, mu, limit_damping| {
        Model::classic(hertz, history, &Classic { stiffness, gamma, mu, limit_damping, arm: Arm::Radius })
            .law(Compat::Lammps2025)
    };
    let sevenths = |k: f64| [k, k * 2.0 / 7.0];
    agrees(golden!("hooke"), classic(false, false, sevenths(2.0e5), [150.0, 75.0], 0.5, false));
    agrees(golden!("hooke_hist"), classic(false, true, [2.0e5, 1.2e5], [150.0, 60.0], 0.3, false));
    agrees(golden!("hertz_hist"), classic(true, true, sevenths(2.0e8), [8.0e5, 4.0e5], 0.4, false));
    agrees(golden!("hertz_hist_lim"), classic(true, true, [2.0e8, 1.0e8], [8.0e6, 0.0], 0.4, true));
}

/// Force on sphere 1 of 10 mm touching one of 8 mm with 20 µm overlap, sliding at 0.25 m/s, after one step of 1 ns.
fn first_step(law: Granular, v: Vec3) -> Vec3 {
    let g = Geometry::of_spheres(
        [-0.00898, 0.0, 0.0],
        [0.005, 0.004],
        [
            2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.005_f64.powi(3),
            4000.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.004_f64.powi(3),
        ],
        0.0,
    );
    let step = Advance { dt: 1e-9, history: true };
    let i = Motion { velocity: v, spin: [0.0; 3] };
    law.contact(&g.unwrap(), &i, &Motion::default(), &mut [0.0; 3], step).force
}

#[test]
fn unlike_types_mix_as_in_the_manual_and_with_compat_as_in_lammps() {
    let a = model(material(5.0e7, 0.0, 0.3), Damping::Viscoelastic, mindlin(0.0, 4e3));
    let b = model(material(8.0e8, 0.0, 0.1), Damping::Viscoelastic, mindlin(0.0, 1e3));
    let slip = [0.0, 0.25, 0.0];
    let ours = first_step(a.mixed(&b, Compat::Perigrain).unwrap(), slip);
    let lammps = first_step(a.mixed(&b, Compat::Lammps2025).unwrap(), slip);
    // LAMMPS 22Jul2025, thermo of step 0: v_fx1 −0.289225823866833. The overlap has a rounding error of
    // 1e-13.
    assert!((ours[0] + 0.289225823866833).abs() < 1e-12 && ours[0] == lammps[0]);
    // LAMMPS' tz1 / (R − δ/2) of step 1 = 1.26262723937792e-8 / 0.00499.
    assert!((lammps[1] + 2.530315108973788e-6).abs() < 1e-16);
    // 8 G* a v dt with G* = 1.068090788e7 Pa from the manual's rule.
    assert!((ours[1] + 4.503466182705602e-6).abs() < 1e-16);

    // Damping and explicit stiffnesses are mixed geometrically: LAMMPS' v_fx1 of step 0 at v_n = 1 m/s.
    let a = model(material(5.0e7, 1.0e5, 0.3), Damping::Viscoelastic, mindlin(0.5, 4e3));
    let b = model(material(8.0e8, 4.0e6, 0.1), Damping::Viscoelastic, mindlin(0.25, 4e3));
    let f = first_step(a.mixed(&b, Compat::Lammps2025).unwrap(), [1.0, 0.0, 0.0]);
    assert!((f[0] + 0.367819366260954).abs() < 1e-12);

    let c = Model { damping: Damping::Tsuji, ..a };
    assert_eq!(a.mixed(&c, Compat::Lammps2025), Err(Unmixable("viscoelastic", "tsuji")));
}

#[test]
fn momentum_and_angular_momentum_stay() {
    for damping in Damping::ALL {
        let law = model(material(5.0e7, 0.6, 0.3), damping, mindlin(0.5, 0.4)).law(Compat::Perigrain);
        let mut duel = Duel::new(spheres(), law, 1e-6);
        let (p, l) = (duel.momentum(), duel.angular_momentum());
        // The largest terms of the sums, before cancellation: m v and m v x.
        let m = duel.balls[0].mass;
        for _ in 0..3000 {
            duel.step();
        }
        assert!(duel.overlap() < 0.0);
        // 3000 additions with relative rounding errors of 1e-16, as a random walk: 1e-14.
        let drift = |a: Vec3, b: Vec3| length(sub(a, b));
        assert!(drift(duel.momentum(), p) < 1e-14 * m * 1.5);
        assert!(drift(duel.angular_momentum(), l) < 1e-13 * m * 1.5 * 0.005);
    }
}

#[test]
fn action_and_reaction_are_equal_to_the_bit() {
    let law = model(material(5.0e7, 0.6, 0.3), Damping::Tsuji, mindlin(0.5, 0.4)).law(Compat::Perigrain);
    let [a, b] = spheres();
    let d = [-0.0085, 0.0011, 0.0007];
    let step = Advance { dt: 1e-6, history: true };
    let (mut h, mut k) = ([1e-7, -2e-7, 3e-7], [-1e-7, 2e-7, -3e-7]);
    let (radii, masses) = ([a.radius, b.radius], [a.mass, b.mass]);
    let g = Geometry::of_spheres(d, radii, masses, 0.0).unwrap();
    let back =
        Geometry::of_spheres(scale(-1.0, d), [radii[1], radii[0]], [masses[1], masses[0]], 0.0).unwrap();
    let w = law.contact(&g, &a.motion, &b.motion, &mut h, step);
    let r = law.contact(&back, &b.motion, &a.motion, &mut k, step);
    assert_eq!(w.force, scale(-1.0, r.force));
    assert_eq!((w.torque_i, w.torque_j), (r.torque_j, r.torque_i));
    assert_eq!(h, scale(-1.0, k));
}

#[test]
fn nothing_moves_on_in_the_setup_of_a_run() {
    let law =
        model(material(5.0e7, 0.0, 0.3), Damping::Viscoelastic, mindlin(0.0, 0.4)).law(Compat::Lammps2025);
    let mut h = [0.0, 1e-9, 0.0];
    let g = Geometry::of_spheres([-0.00898, 0.0, 0.0], [0.005, 0.004], [1.0, 1.0], 0.0).unwrap();
    let i = Motion { velocity: [0.0, 1.0, 0.0], spin: [0.0; 3] };
    law.contact(&g, &i, &Motion::default(), &mut h, Advance { dt: 1e-6, history: false });
    assert_eq!(h, [0.0, 1e-9, 0.0]);
}

/// The spin that an impact leaves on the first of two equal spheres, initially 10 µm apart: fault B4, 1 m/s
/// against 0.7 m/s, so that they slide while the contact is young and its dashpot resists more than the
/// friction limit.
fn spin_of_a_glancing_impact(law: Granular, dt: f64) -> f64 {
    let along = scale(0.01001, [-0.91655, -0.39992, 0.0]);
    let balls = [
        Ball::new(along, [1.0, 0.0, 0.0], [0.0; 3], 0.005, 2500.0),
        Ball::new([0.0; 3], [-0.7, 0.0, 0.0], [0.0; 3], 0.005, 2500.0),
    ];
    let mut duel = Duel::new(balls, law, dt);
    while duel.overlap() <= 0.0 {
        duel.step();
    }
    while duel.overlap() > 0.0 {
        duel.step();
    }
    duel.balls[0].motion.spin[2]
}

#[test]
fn short_steps_through_a_young_contact_end_where_long_ones_do() {
    let dampings = [
        (Damping::Tsuji, 0.5),
        (Damping::CoeffRestitution, 0.5),
        (Damping::MassVelocity, 2e4),
        (Damping::Velocity, 10.0),
    ];
    for (damping, eta) in dampings {
        for kind in [Friction::Mindlin, Friction::MindlinClassic, Friction::MindlinRescale] {
            let friction = Tangential::new(kind, Some(2.5e8), 1.0, 0.3);
            let m = model(material(1.0e8, eta, NU), damping, friction);
            let [long, middle, short] =
                [5e-7, 1e-7, 1e-8].map(|dt| spin_of_a_glancing_impact(m.law(Compat::Perigrain), dt));
            // First order in time, most with tsuji: 1.03e-3 and 1.8e-4, as with `limit_damping` to the last
            // bit. Half of that where friction acts while damping is attractive, as in LAMMPS. Less with the
            // others.
            let off = [long, middle].map(|spin| (spin / short - 1.0).abs());
            assert!(off[0] < 1.1e-3 && off[1] < 2e-4, "{damping:?} {kind:?}: {off:?}");
        }
    }
    // LAMMPS' rule makes the test meaningful: 2.5 % to 5 % with e from Tsuji or as requested, a factor of
    // five here.
    let friction = Tangential::new(Friction::Mindlin, Some(2.5e8), 1.0, 0.3);
    let m = model(material(1.0e8, 10.0, NU), Damping::Velocity, friction).law(Compat::Lammps2025);
    assert!(spin_of_a_glancing_impact(m, 5e-7) > 5.0 * spin_of_a_glancing_impact(m, 1e-8));
}
