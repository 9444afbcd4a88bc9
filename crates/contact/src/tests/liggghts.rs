//! Laws of LIGGGHTS: numbers of its version 3.8.0 (Debian), printed with 11 digits, and closed forms of its manual.

use super::*;
use crate::heat::Area;
use crate::{Cdt, Cohesion, Epsd, Epsd2, Grip, Pull, Slip};

/// Printed digits of the program's dumps.
const PRINTED: f64 = 2e-11;
const STEP: Advance = Advance { dt: 1e-5, history: true };
const STILL: Motion = Motion { velocity: [0.0; 3], spin: [0.0; 3] };
const DENSITY: f64 = 2500.0;

fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < PRINTED, "{found:e} {expected:e}");
}

fn mass(radius: f64) -> f64 {
    DENSITY * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
}

/// i lies on the side of negative x, as the first grain of the program's decks; a negative overlap is a gap.
fn pair(radii: [f64; 2], overlap: f64) -> Geometry {
    let d = [overlap - radii[0] - radii[1], 0.0, 0.0];
    Geometry::of_spheres(d, radii, radii.map(mass), f64::INFINITY).unwrap()
}

/// A grain on the wall on its side of negative x.
fn wall(radius: f64, overlap: f64) -> Geometry {
    let normal = [1.0, 0.0, 0.0];
    Geometry { normal, overlap, radii: [radius, 0.0], curvature: radius, mass: mass(radius) }
}

/// `tangential mindlin NULL NULL mu slip spring`.
fn sliding(mu: f64) -> Tangential {
    Tangential { drag: Drag::Matched, slip: Slip::Spring, ..mindlin(0.0, mu) }
}

fn hertz(e: f64, tangential: Tangential) -> Model {
    model(material(5e6, e, 0.45), Damping::CoeffRestitution, tangential)
}

fn spinning(spin: Vec3) -> Motion {
    Motion { velocity: [0.0; 3], spin }
}

#[test]
fn stiffness_and_damping_are_those_of_the_manual() {
    // Radius 5 mm, overlap 10 µm, e 0.7: k_n, gamma_n, k_t and gamma_t by the formulas of gran_model_hertz.
    let g = pair([0.005; 2], 1e-5);
    let law = hertz(0.7, sliding(0.5)).law(Compat::Perigrain);
    let [[_, across, ..], [along_damping, across_damping, ..]] = law.resistance(&g, &[0.0; 3]);
    let digits = 1e-9;
    for (found, expected) in [
        (along_damping, 0.165_897_554_2),
        (across, 703.510_046_8),
        (across_damping, 0.139_756_004_8),
        (law.normal.push(&g, law.normal.radius(&g), &mut []).secant, 660.873_074_2),
    ] {
        assert!((found / expected - 1.0).abs() < digits, "{found} {expected}");
    }
    // hooke with a characteristic velocity of 2 m/s and e 0.9: radius 40 mm, on a wall, and 15 mm with 25 mm.
    let hooke = Normal::new(&normal::HOOKE_VELOCITY, &[5e6, 0.9, 0.45, 2.0]);
    let linear = Tangential {
        of_normal: true,
        drag: Drag::Matched,
        slip: Slip::Spring,
        ..Tangential::new(Friction::LinearHistory, Some(1.0), 0.0, 0.5)
    };
    let law = model(hooke, Damping::CoeffRestitution, linear).law(Compat::Perigrain);
    for (g, k, gamma) in [
        (pair([0.04; 2], 1e-4), 36_749.391_15, 7.439_235_096),
        (wall(0.04, 1e-4), 55_701.660_97, 12.952_460_61),
        (pair([0.015, 0.025], 1e-4), 16_644.268_2, 1.474_452_119),
    ] {
        let [[along, across, ..], dampings] = law.resistance(&g, &[0.0; 3]);
        for (found, expected) in [(along, k), (across, k), (dampings[0], gamma), (dampings[1], gamma)] {
            assert!((found / expected - 1.0).abs() < digits, "{found} {expected}");
        }
    }
}

#[test]
fn the_spring_slides_alone() {
    // slip_rule: k_t 1000, gamma_t 2, mu F_n 0.5, steps of 1 ms; force on i against 0.2 m/s, then -0.2.
    let linear =
        Tangential { slip: Slip::Spring, ..Tangential::new(Friction::LinearHistory, Some(1000.0), 2.0, 0.5) };
    let law = model(Normal::new(&normal::HOOKE, &[2000.0, 1.0]), Damping::Velocity, linear);
    let law = law.law(Compat::Perigrain);
    let g = pair([0.005; 2], 5e-4);
    let mut history = [0.0; 3];
    let step = |history| Advance { dt: 1e-3, history };
    for (v, force, spring) in
        [(0.2, -0.6, 2e-4), (0.2, -0.8, 4e-4), (0.2, -0.5, 5e-4), (0.2, -0.5, 5e-4), (-0.2, 0.1, 3e-4)]
    {
        let i = Motion { velocity: [0.0, v, 0.0], spin: [0.0; 3] };
        let w = law.contact(&g, &i, &STILL, &mut history, step(true));
        assert!(
            (w.force[1] - force).abs() < 1e-14 && (history[1] - spring).abs() < 1e-17,
            "{w:?} {history:?}"
        );
        // The arm ends in the middle of the overlap.
        assert!((w.torque_i[2] - w.force[1] * 0.004_75).abs() < 1e-16 && w.torque_i == w.torque_j);
        // A second evaluation gives the same force, sliding or not.
        let again = law.contact(&g, &i, &STILL, &mut history.clone(), step(false));
        assert!((again.force[1] - w.force[1]).abs() < 1e-12);
    }
}

#[test]
fn springs_are_projected_and_arms_end_at_the_contact() {
    // spring_turn_y: a normal that turns by 30 degrees at once shortens the spring.
    let linear =
        Tangential { slip: Slip::Spring, ..Tangential::new(Friction::LinearHistory, Some(1000.0), 0.0, 0.5) };
    let law = model(Normal::new(&normal::HOOKE, &[2000.0, 0.0]), Damping::MassVelocity, linear);
    let law = law.law(Compat::Perigrain);
    let (sin, cos) = (0.5, 0.75_f64.sqrt());
    let g = Geometry { normal: [-cos, 0.0, -sin], ..pair([0.005; 2], 5e-4) };
    let mut history = [0.0, -2e-4, -1e-4];
    let w = law.contact(&g, &STILL, &STILL, &mut history, Advance { dt: 1e-3, history: true });
    for (found, expected) in w.force.iter().zip([-0.909_326_673_977, 0.2, -0.425_000_000_002]) {
        // The deck's place of the second grain has 12 digits.
        assert!((found - expected).abs() < 1e-11, "{w:?}");
    }
    // wall_spin_arms: a grain of 5 mm that turns on a wall below it, in the second evaluation of its first step.
    let law = hertz(0.7, sliding(0.5)).law(Compat::Perigrain).on_wall();
    let g = Geometry { normal: [0.0, 0.0, 1.0], ..wall(0.005, 0.005 - (0.05 - 0.045_01)) };
    let w = law.contact(&g, &spinning([1.0, 2.0, 3.0]), &STILL, &mut [0.0; 3], STEP);
    for (found, expected) in [
        (w.force[0], 0.002_447_447_915_82),
        (w.force[1], -0.001_223_723_957_91),
        (w.torque_i[0], -6.112_501_169_77e-6),
        (w.torque_i[1], -1.222_500_233_95e-5),
    ] {
        near(found, expected);
    }
}

#[test]
fn constant_torques_have_the_direction_of_the_spin() {
    let law = |full| {
        let rolling = Rolling::Cdt(Cdt { mu: 0.1, full });
        Model { rolling, ..hertz(0.7, Tangential::SMOOTH) }.law(Compat::Perigrain)
    };
    let g = pair([0.005; 2], 1e-5);
    // An approach changes F_n, not the torque.
    let other = |spin| Motion { velocity: [-0.1, 0.0, 0.0], spin };
    let torque = |full, spin| law(full).contact(&g, &STILL, &other(spin), &mut [], STEP).torque_i;
    near(torque(false, [0.0, 0.0, 20.0])[2], 1.652_182_685_56e-6);
    near(torque(false, [30.0, 0.0, 20.0])[2], 9.164_660_598_82e-7);
    assert_eq!(torque(false, [30.0, 0.0, 20.0])[0], 0.0);
    near(torque(true, [30.0, 0.0, 20.0])[0], 1.374_699_089_82e-6);
    assert_eq!(torque(true, [0.0; 3]), [0.0; 3]);
    let g = wall(0.005, 0.05 - 0.045_01 - 0.004_98);
    let on_wall = law(false).on_wall().contact(&g, &spinning([30.0, 0.0, 20.0]), &STILL, &mut [], STEP);
    // The deck's overlap is 10 µm to 1e-13.
    assert!((on_wall.torque_i[2] / -2.592_157_462_68e-6 - 1.0).abs() < 1e-9);
}

/// Torques on i in some steps, in which j has these spins about z.
fn torques(law: &Granular, g: &Geometry, spins: &[f64]) -> Vec<f64> {
    let mut history = vec![0.0; law.memory()];
    let turn = |w: &f64| {
        let (i, j) = if g.radii[1] > 0.0 { (0.0, *w) } else { (*w, 0.0) };
        let (i, j) = (spinning([0.0, 0.0, i]), spinning([0.0, 0.0, j]));
        let torque = law.contact(g, &i, &j, &mut history, STEP).torque_i[2];
        let again = law.contact(g, &i, &j, &mut history.clone(), Advance { history: false, ..STEP });
        assert!((again.torque_i[2] - torque).abs() < 1e-12 * torque.abs(), "{w}");
        torque
    };
    spins.iter().map(turn).collect()
}

#[test]
fn springs_against_rolling_slide_without_their_dashpots() {
    let law = |rolling| Model { rolling, ..hertz(0.7, Tangential::SMOOTH) }.law(Compat::Perigrain);
    let epsd = |factor| Rolling::Epsd(Epsd { mu: 0.1, eta: 0.3, factor, full: false });
    let epsd2 = Rolling::Epsd2(Epsd2 { mu: 0.1, full: false, grip: Grip::Is(0.0) });
    let spins = [20.0, 20.0, 400.0, 2000.0, -20.0];
    let (g, flat) = (pair([0.005; 2], 1e-5), wall(0.005, 0.005 - (0.05 - 0.045_01)));
    // epsd_pair, epsd3_pair, epsd2_pair, epsd_wall, epsd2_wall.
    let cases = [
        (
            law(epsd(2.25)),
            g,
            [
                1.752_752_818_73e-5,
                1.754_611_524_25e-5,
                3.505_877_378_56e-4,
                1.652_182_685_56e-6,
                -1.587_534_550_17e-5,
            ],
        ),
        (
            law(epsd(1.3)),
            g,
            [
                1.331_958_211_96e-5,
                1.333_032_130_71e-5,
                2.664_131_207_68e-4,
                1.332_194_474_09e-3,
                -1.200_940_125e-5,
            ],
        ),
        (
            law(epsd2),
            g,
            [
                8.793_875_584_45e-7,
                1.652_182_685_56e-6,
                1.652_182_685_56e-6,
                1.652_182_685_56e-6,
                7.727_951_271_18e-7,
            ],
        ),
        (
            law(epsd(2.25)).on_wall(),
            flat,
            [
                -5.905_708_379_36e-5,
                -5.916_233_341_08e-5,
                -1.181_352_175_11e-3,
                -4.673_078_322_88e-6,
                5.438_400_547_07e-5,
            ],
        ),
        (
            law(epsd2).on_wall(),
            flat,
            [
                -4.673_078_322_88e-6,
                -4.673_078_322_88e-6,
                -4.673_078_322_88e-6,
                -4.673_078_322_88e-6,
                3.064_734_603_77e-7,
            ],
        ),
    ];
    for (law, g, expected) in cases {
        for (found, expected) in torques(&law, &g, &spins).into_iter().zip(expected) {
            // The deck's distances have 4 digits, overlaps of them ten.
            assert!((found / expected - 1.0).abs() < 1e-9, "{found:e} {expected:e}");
        }
    }
}

#[test]
fn torques_are_the_same_from_both_sides() {
    let rolling = Rolling::Epsd(Epsd { mu: 0.1, eta: 0.3, factor: 2.25, full: true });
    let law = Model { rolling, ..hertz(0.7, sliding(0.5)) }.law(Compat::Perigrain);
    let (g, radii) = (pair([0.005, 0.008], 1e-5), [0.005, 0.008]);
    let back = Geometry { normal: scale(-1.0, g.normal), radii: [radii[1], radii[0]], ..g };
    let (i, j) = (spinning([1.0, 2.0, 3.0]), spinning([-3.0, 1.0, 0.5]));
    let ends = Ends::of_spheres(radii, radii.map(mass));
    let turned =
        Ends { side: -1.0, ..Ends::of_spheres([radii[1], radii[0]], [radii[1], radii[0]].map(mass)) };
    let (mut one, mut other) = (vec![0.0; 6], vec![0.0; 6]);
    for _ in 0..3 {
        let w = law.contact_of(&g, [&i, &j], ends, &mut one, STEP);
        let v = law.contact_of(&back, [&j, &i], turned, &mut other, STEP);
        assert_eq!((w.force, w.torque_i, w.torque_j), (scale(-1.0, v.force), v.torque_j, v.torque_i));
    }
    perigrain_world::contacts::mirror(&mut other);
    assert_eq!(one, other);
    // Equal densities: the geometry alone gives the same inertia.
    assert!((Ends::of(&g).inertia / ends.inertia - 1.0).abs() < 1e-14);
}

#[test]
fn cohesion_pulls_by_the_area_of_contact() {
    let (g, flat) = (pair([0.0015; 2], 3e-6), wall(0.0015, 3e-6));
    let pull = |reduces| Pull { density: 3e5, reduces };
    let law = |cohesion, limit_damping| {
        Model { cohesion, limit_damping, ..hertz(0.9, sliding(0.05)) }.law(Compat::Perigrain)
    };
    // Hertz 5.947_857_668e-4 against the pulls of the manual's areas; that of sjkr2 on walls is measured.
    let cases = [
        (Cohesion::Sjkr(pull(false)), 4.239_029_507e-3, 8.473_817_865e-3),
        (Cohesion::Sjkr2(pull(false)), 8.482_300_165e-3, 8.482_300_165e-3),
    ];
    for (cohesion, between, on_wall) in cases {
        for (law, g, expected) in
            [(law(cohesion, false), &g, between), (law(cohesion, false).on_wall(), &flat, on_wall)]
        {
            let bare = hertz(0.9, sliding(0.05)).law(Compat::Perigrain).contact(
                g,
                &STILL,
                &STILL,
                &mut [0.0; 3],
                STEP,
            );
            let w = law.contact(g, &STILL, &STILL, &mut [0.0; 3], STEP);
            let pulled = (bare.force[0] - w.force[0]) * g.normal[0];
            assert!((pulled / expected - 1.0).abs() < 1e-9, "{pulled:e} {expected:e}");
            // The ledger has the same force, and −∫ k A dδ.
            assert_eq!(law.stored(g, &[0.0; 3]).push, w.force[0] * g.normal[0]);
            let energy = |overlap: f64| law.stored(&Geometry { overlap, ..*g }, &[0.0; 3]).normal;
            let slope = (energy(3.001e-6) - energy(2.999e-6)) / 2e-9;
            assert!((slope / (w.force[0] * g.normal[0]) - 1.0).abs() < 1e-6, "{slope}");
        }
    }
    // The limit of friction counts from the force without the pull, with `reduce` from that with it.
    let slide = Motion { velocity: [0.0, -1.0, 0.0], spin: [0.0; 3] };
    let friction = |law: Granular| law.contact(&g, &slide, &STILL, &mut [0.0, -1.0, 0.0], STEP).force[1];
    assert!((friction(law(Cohesion::Sjkr(pull(false)), false)) / 2.973_928_834e-5 - 1.0).abs() < 1e-9);
    assert!((friction(law(Cohesion::Sjkr(pull(true)), false)) / 1.822_121_870e-4 - 1.0).abs() < 1e-9);
    // limit_damping takes the pull of the dashpot, not that of cohesion.
    let leave = Motion { velocity: [-3.0, 0.0, 0.0], spin: [0.0; 3] };
    let w = law(Cohesion::Sjkr(pull(false)), true).contact(&g, &leave, &STILL, &mut [0.0; 3], STEP);
    assert!((w.force[0] / 4.239_029_507_3e-3 - 1.0).abs() < 1e-9, "{w:?}");
    // Unequal spheres: the circle in which they intersect has the radius of a triangle with sides R_i, R_j, D.
    let g = pair([0.001, 0.003], 1e-4);
    let (ri, rj, d) = (0.001_f64, 0.003_f64, 0.0039_f64);
    let along = (d * d + ri * ri - rj * rj) / (2.0 * d);
    let area = std::f64::consts::PI * (ri * ri - along * along);
    let found = Cohesion::Sjkr(Pull { density: 1.0, reduces: false }).pull(&g, false);
    assert!((found / area - 1.0).abs() < 1e-12, "{found} {area}");
}

#[test]
fn heat_flows_through_the_area_of_contact() {
    let conductance = |heat, g: &Geometry, on_wall: bool| {
        let law = Model { heat, ..hertz(0.7, sliding(0.5)) }.law(Compat::Perigrain);
        if on_wall { law.on_wall().conductance(g) } else { law.conductance(g) }
    };
    let contact = |area| Heat::Contact { conductivity: 100.0, area };
    let g = pair([0.004; 2], 1e-5);
    let circle = Area::Overlap(1.0);
    // heat_pair, heat_wall, heat_projection, heat_area_correction_hertz: 500 K.
    let softened = Area::Overlap(0.01_f64.powf(2.0 / 3.0));
    for (found, expected) in [
        (conductance(contact(circle), &g, false), 0.070_875_994_9),
        (conductance(contact(circle), &wall(0.004, 1e-5), true), 0.100_202_445_7),
        (conductance(contact(softened), &g, false), 7.637_161_346_58 / 500.0),
        (
            conductance(contact(Area::Projection), &pair([0.004, 0.006], 1e-5), false),
            1_063.472_310_54 / 500.0,
        ),
        // 2 k √A; walls have the circle with `constant` and `projection` (3.8.0: 50.1012228415 W in both).
        (conductance(contact(Area::Constant(1e-6)), &g, false), 0.2),
        (conductance(contact(Area::Constant(1e-6)), &wall(0.004, 1e-5), true), 50.101_222_841_5 / 500.0),
        (conductance(contact(Area::Projection), &wall(0.004, 1e-5), true), 50.101_222_841_5 / 500.0),
    ] {
        assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
    }
    // Unlike materials: 4 k_i k_j/(k_i + k_j) √A.
    let mixed = contact(circle).mixed(&Heat::Contact { conductivity: 300.0, area: circle });
    assert_eq!(mixed, Heat::Contact { conductivity: 150.0, area: circle });
}

#[test]
fn yielding_contacts_follow_their_branches() {
    // k_1 = 1000 N/m at V: hooke/velocity's k_n is proportional to V^(2/5). Ratios 2 and 0.2, phi 0.05, radius 1.5 mm.
    let g = |overlap| pair([0.0015; 2], overlap);
    let of = |v: f64| Normal::new(&normal::HOOKE_HYSTERESIS, &[5e6, 0.9, 0.45, v, 2.0, 0.2, 0.05]);
    let plain = |v: f64| Normal::new(&normal::HOOKE_VELOCITY, &[5e6, 0.9, 0.45, v]);
    let stiffness = plain(2.0).force(&plain(2.0)).tangent(&g(1e-6));
    let v = 2.0 * (1000.0 / stiffness).powf(2.5);
    let force = of(v).force(&of(v));
    let mut memory = [0.0];
    let path = [
        (2e-5, 0.02),
        (6e-5, 0.06),
        (5e-5, 0.046),
        (1.6e-5, 1400.0 * (1.6e-5 - 6e-5 * 0.4 / 1.4)),
        (1e-5, -2e-3),
        (2e-6, -4e-4),
        (1e-5, 8.666_667e-3),
        (1.6e-4, 0.17),
        (3e-4, 0.45),
        (2.5e-4, 0.35),
    ];
    for (overlap, expected) in path {
        let found = force.push(&g(overlap), 0.0, &mut memory).force;
        // Seven digits of the closed numbers.
        assert!((found - expected).abs() < 1e-7 * expected.abs(), "{overlap} {found} {expected}");
        // The stored energy is that of the line on which the contact unloads.
        let step = 1e-10;
        let (at, below) = (force.energy(&g(overlap), &memory), force.energy(&g(overlap - step), &memory));
        let slope = (at - below) / step;
        assert!((slope - found).abs() < 1e-3 * found.abs(), "{overlap} {slope} {found}");
    }
    assert_eq!(force.push(&g(1e-9), 0.0, &mut [0.0]).secant, force.push(&g(1e-5), 0.0, &mut [1e-5]).secant);
}

#[test]
fn liquid_bridges_pull_across_a_gap() {
    use crate::{Bridge, Profile};
    let [radius, volume, tension, angle] = [0.001, 1e-11, 0.072, 0.3_f64];
    let near = |found: f64, expected: f64| {
        assert!((found / expected - 1.0).abs() < 1e-11, "{found:e} {expected:e}");
    };
    // Equal spheres: R = R̄ + R̄. Rabinovich et al. 2005 with 2 d = H (√(1 + 2 V/(π R H²)) − 1), Willett et al. 2000.
    let rabinovich = |r: f64, h: f64| {
        let twice = h * ((1.0 + 2.0 * volume / (std::f64::consts::PI * r * h * h)).sqrt() - 1.0);
        2.0 * std::f64::consts::PI * r * tension * angle.cos() / (1.0 + h / twice)
    };
    let willett = |r: f64, h: f64| {
        let s = h * (r / volume).sqrt();
        2.0 * std::f64::consts::PI * r * tension * angle.cos() / (1.0 + 1.05 * s + 2.5 * s * s)
    };
    let published: [(_, &dyn Fn(f64, f64) -> f64); 2] =
        [(Profile::Rabinovich, &rabinovich), (Profile::Willett, &willett)];
    for (profile, force) in published {
        let bridge = Bridge::new(profile, volume, tension, angle);
        // Lian et al. 1993: (1 + θ/2) V^(1/3).
        near(bridge.rupture, 1.15 * volume.cbrt());
        let cohesion = Cohesion::Capillary(bridge);
        let law = Model { cohesion, ..hertz(0.9, sliding(0.5)) }.law(Compat::Perigrain);
        assert_eq!(law.gap(0.5 * radius), bridge.rupture);
        for h in [1e-6, 1e-5, 1e-4, 0.99 * bridge.rupture] {
            let moving = Motion { velocity: [0.3, 0.2, 0.1], spin: [5.0, 6.0, 7.0] };
            for (law, g, r) in
                [(law, pair([radius; 2], -h), radius), (law.on_wall(), wall(radius, -h), 2.0 * radius)]
            {
                let mut history = [1e-6, 2e-6, 3e-6];
                let w = law.contact(&g, &moving, &STILL, &mut history, STEP);
                // Against the normal, which points to i; nothing rubs, turns or is remembered across a gap.
                near(-w.force[0] * g.normal[0], force(r, h));
                assert_eq!((w.force[1], w.torque_i, history), (0.0, [0.0; 3], [0.0; 3]));
                let stored = |overlap: f64| law.stored(&Geometry { overlap, ..g }, &history);
                near(stored(-h).push, -force(r, h));
                // Energy returned by the force: dE/dδ = F.
                let slope = (stored(-h + 1e-10).normal - stored(-h - 1e-10).normal) / 2e-10;
                assert!((slope / -force(r, h) - 1.0).abs() < 1e-5, "{slope}");
                assert_eq!((law.resistance(&g, &history), law.conductance(&g)), ([[0.0; 4]; 2], 0.0));
            }
        }
        // In contact the pull is that at touch, beside Hertz' push.
        let bare = hertz(0.9, sliding(0.5)).law(Compat::Perigrain);
        let g = pair([radius; 2], 1e-6);
        let [with, without] =
            [law, bare].map(|law| law.contact(&g, &STILL, &STILL, &mut [0.0; 3], STEP).force[0]);
        assert!(
            ((with - without) / (2.0 * std::f64::consts::PI * radius * tension * angle.cos()) - 1.0).abs()
                < 1e-11
        );
    }
}
