//! Budgets over 10⁵ steps: energy of an elastic gas, momentum, angular momentum and loss of energy in a closed cloud.

use super::scene::Scene;
use perigrain::math::vec3::{add, cross, dot, length, scale, sub};
use std::f64::consts::PI;

const STEPS: usize = 100_000;

/// Energy, as a part of what it was, that velocity Verlet adds to an elastic impact with F = k δ^1.5 of a reduced mass at
/// relative velocity `v`: root of the mean square over phases after it, and the largest value within.
fn impact_error(k: f64, mass: f64, v: f64, dt: f64) -> [f64; 2] {
    let (mut after, mut within) = (0.0, 0.0_f64);
    let phases = 64;
    for phase in 0..phases {
        let energy = |d: f64, u: f64| 0.5 * mass * u * u + 0.4 * k * d.max(0.0).powf(2.5);
        let start = energy(0.0, v);
        let (mut d, mut u) = (-v * dt * (f64::from(phase) + 0.5) / f64::from(phases), v);
        let mut a = 0.0;
        loop {
            u += 0.5 * dt * a;
            d += dt * u;
            a = -k * d.max(0.0).powf(1.5) / mass;
            u += 0.5 * dt * a;
            if d <= 0.0 {
                break;
            }
            within = within.max((energy(d, u) / start - 1.0).abs());
        }
        after += (energy(d, u) / start - 1.0).powi(2) / f64::from(phases);
    }
    [after.sqrt(), within]
}

/// Mass times velocity and its moment about the origin, with the spins of solid spheres.
fn momenta(scene: &Scene) -> [[f64; 3]; 2] {
    let p = &scene.world().particles;
    let (mut linear, mut angular) = ([0.0; 3], [0.0; 3]);
    for i in 0..p.len() {
        let own = scale(p.mass[i], p.v[i]);
        linear = add(linear, own);
        let spin = scale(0.4 * p.mass[i] * p.radius[i] * p.radius[i], p.omega[i]);
        angular = add(angular, add(cross(p.x[i], own), spin));
    }
    [linear, angular]
}

/// Energy of motion and spin, and the overlaps of spheres of diameter 1 in a box that repeats after `edge`.
fn motion_and_overlaps(scene: &Scene, edge: f64) -> (f64, Vec<f64>) {
    let p = &scene.world().particles;
    let own = |i: usize| {
        let spin = 0.4 * p.radius[i] * p.radius[i] * dot(p.omega[i], p.omega[i]);
        0.5 * p.mass[i] * (dot(p.v[i], p.v[i]) + spin)
    };
    let mut overlaps = vec![];
    for i in 0..p.len() {
        for j in 0..i {
            let d = sub(p.x[i], p.x[j]).map(|d| d - edge * (d / edge).round());
            let near = dot(d, d);
            if near < 1.0 {
                overlaps.push(1.0 - near.sqrt());
            }
        }
    }
    ((0..p.len()).map(own).sum(), overlaps)
}

/// What a sum of momenta may wander by while speeds are about 1: each of the two kicks of a step rounds a velocity by
/// 0.3 ε (the deviation of a uniform error of ε/2 either way) in three directions, independently; five deviations.
fn wander(n: usize) -> f64 {
    5.0 * 0.3 * f64::EPSILON * (2.0 * 3.0 * (n * STEPS) as f64).sqrt()
}

#[test]
fn an_elastic_gas_keeps_energy_and_momentum() {
    // 125 smooth spheres of diameter and mass 1, temperature 1, in a periodic box of side 7; F = kn √(R̄ δ) δ, R̄ = 1/4.
    let (n, edge, kn, dt) = (125, 7.0, 2.0e5, 5.0e-4);
    let mut gas = Scene::new(&format!(
        "units lj\natom_style sphere\nboundary p p p\nregion box block 0 {edge} 0 {edge} 0 {edge} units box\n\
         create_box 1 box\ncreate_atoms 1 random {n} 4711 box overlap 1.0 maxtry 1000\n\
         set group all diameter 1.0\nset group all mass 1.0\nvelocity all create 1.0 4711\n\
         pair_style granular\npair_coeff * * hertz {kn} 0.0 damping velocity tangential linear_nohistory 0.0 0.0\n\
         neighbor 0.3 bin\nfix move all nve/sphere\ntimestep {dt}\nthermo_style custom step\nthermo 1000000\n"
    ));
    let k = 0.5 * kn;
    let energy = |gas: &Scene| {
        let (motion, overlaps) = motion_and_overlaps(gas, edge);
        (motion + overlaps.iter().map(|d| 0.4 * k * d.powf(2.5)).sum::<f64>(), overlaps.len())
    };
    let [start, _] = momenta(&gas);
    let (before, _) = energy(&gas);
    // Collisions by Enskog's rate per sphere, 4 n σ² χ √(π T/m). The mean energy of an impact along the normal is T, the
    // mean of its square 2 T². The scheme can be run backwards, so it gains as often as it loses, and its errors add up
    // as a random walk: five deviations are granted. What is just in contact adds its own error.
    let density = n as f64 / edge.powi(3);
    let filled = density * PI / 6.0;
    let rate = 4.0 * density * (1.0 - 0.5 * filled) / (1.0 - filled).powi(3) * PI.sqrt();
    let [after, within] = impact_error(k, 0.5, 2.0, dt);
    for tenth in 1..=10 {
        gas.step(STEPS / 10);
        let impacts = 0.5 * n as f64 * rate * dt * (STEPS / 10 * tenth) as f64;
        let (now, touching) = energy(&gas);
        // 0.02 of 186 without contacts after 10⁵ steps and 4,300 impacts; the run's largest change is 0.015.
        let granted = 5.0 * after * (2.0 * impacts).sqrt() + 4.0 * within * touching as f64;
        assert!((now - before).abs() < granted, "{tenth}: {before} {now}, granted {granted}");
    }
    let [end, _] = momenta(&gas);
    assert!(length(sub(end, start)) < wander(n), "{start:?} {end:?}");
}

/// 120 spheres of diameter and mass 1 that fall together in empty space, turning, each with a spin.
fn cloud(law: &str, dt: f64) -> Scene {
    Scene::new(&format!(
        "units lj\natom_style sphere\nboundary f f f\nregion box block -500 500 -500 500 -500 500 units box\n\
         region ball sphere 0 0 0 4.5 units box\ncreate_box 1 box\n\
         create_atoms 1 random 120 4711 ball overlap 1.0 maxtry 1000\n\
         set group all diameter 1.0\nset group all mass 1.0\n\
         variable vx atom -0.3*x-0.2*y+0.005\nvariable vy atom -0.3*y+0.2*x-0.002\nvariable vz atom -0.3*z+0.003\n\
         velocity all set v_vx v_vy v_vz\nset group all omega 1.0 -2.0 0.5\n\
         pair_style granular\npair_coeff * * {law}\nneighbor 0.3 bin\nfix move all nve/sphere\ntimestep {dt}\n\
         compute slip all pair/local p4 cutoff radius\ncompute squares all reduce sumsq c_slip inputs local\n\
         thermo_style custom step c_squares\nthermo 1000000\n"
    ))
}

#[test]
fn a_closed_cloud_keeps_momentum_and_angular_momentum() {
    // Sticky grains with all that contacts can do; they stay together as a spinning heap of a radius of 7.
    let mut cloud = cloud(
        "jkr 2.0e4 30.0 0.3 20.0 damping mass_velocity tangential mindlin_rescale NULL 1.0 0.5 \
         rolling sds 2.0e3 5.0 0.1 twisting marshall",
        1.0e-3,
    );
    let start = momenta(&cloud);
    cloud.step(STEPS);
    let end = momenta(&cloud);
    let far = cloud.world().particles.x.iter().map(|x| length(*x)).fold(0.0, f64::max);
    let off = [0, 1].map(|k| length(sub(end[k], start[k])));
    assert!(far < 20.0 && length(start[0]) > 1.0 && length(start[1]) > 100.0, "{far} {start:?}");
    // 2e-13 of 4.8 and 1.1e-12 of 211 where this was written.
    assert!(off[0] < wander(120) && off[1] < far * wander(120), "{off:?}");
}

#[test]
fn a_closed_cloud_only_loses_energy() {
    // Linear springs, whose energy is known at every moment, kn δ²/2 and F_t²/(2 kt), and a spring for each grain to the
    // origin instead of walls.
    let (kn, bowl, dt) = (2.0e4, 0.1, 1.0e-3);
    let kt = 2.0 / 7.0 * kn;
    let law = format!("hooke {kn} 30.0 damping mass_velocity tangential linear_history {kt} 0.0 0.5");
    let mut cloud = cloud(&law, dt);
    cloud.say(&format!(
        "variable fx atom -{bowl}*x\nvariable fy atom -{bowl}*y\nvariable fz atom -{bowl}*z\n\
         fix bowl all addforce v_fx v_fy v_fz\nrun 0\n"
    ));
    let energy = |cloud: &mut Scene| {
        let slips = cloud.number("$(c_squares:%.17g)");
        let (motion, overlaps) = motion_and_overlaps(cloud, 1e9);
        let springs: f64 = overlaps.iter().map(|d| 0.5 * kn * d * d).sum::<f64>() + slips / (2.0 * kt);
        let lifted: f64 = cloud.world().particles.x.iter().map(|x| 0.5 * bowl * dot(*x, *x)).sum();
        [motion + springs + lifted, springs]
    };
    let first = energy(&mut cloud);
    let mut before = first;
    // Verlet's energy of an oscillator swings by (ω dt)²/8 of it to both sides: ω² = kn/m̄ = 2 kn for what is in
    // contacts, ω² = bowl for the rest.
    let swing = |omega_sq: f64, energy: f64| 2.0 * omega_sq * dt * dt / 8.0 * energy;
    for _ in 0..100 {
        cloud.step(STEPS / 250);
        let now = energy(&mut cloud);
        let granted = swing(2.0 * kn, before[1] + now[1]) + swing(bowl, before[0]);
        assert!(now[0] < before[0] + granted, "{before:?} {now:?}");
        before = now;
    }
    // What is left is the common turning that no contact can take away, and the bowl.
    assert!(before[0] < 0.4 * first[0], "{first:?} {before:?}");
}
