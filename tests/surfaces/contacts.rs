//! Contacts with walls and surfaces: forces and torques to all printed digits.

use super::{DUMP, close, dumped, golden, grain, head, own_dump, ran, table};
use std::fs;

/// All digits that are printed, 11 of 12 counting.
const DIGITS: f64 = 2e-11;

/// Runs a deck and compares the grain with the golden dump at these steps.
fn compare(name: &str, deck: &str, steps: &[i64], part: f64) {
    let (_, place) = ran(deck);
    let own = own_dump(&fs::read_to_string(place.path().join("d.txt")).unwrap());
    let theirs = dumped(&golden(name));
    for step in steps {
        close(name, *step, &own[step], &theirs[step], part);
    }
}

#[test]
fn plane_and_cylinder_walls() {
    for (name, place, velocity, more, wall) in [
        ("wall_both_sides", "0.00499 0 0", "-0.1 0.02 0", "", "coeff 1 xplane 0 NULL"),
        (
            "wall_default_tangential",
            "0 0 -0.04501",
            "0 0.02 0",
            "",
            "coeff 1 only normal damping zplane -0.05 NULL",
        ),
        (
            "wall_ycylinder_c1_is_z",
            "0.001 0 0.02701",
            "0.01 0.02 0.1",
            "",
            "coeff 1 ycylinder 0.03 0.001 0.002",
        ),
        ("wall_zcylinder_outside", "0.03499 0 0", "-0.1 0.02 0.01", "", "coeff 1 zcylinder 0.03 0 0"),
        ("wall_zcylinder_shear_turns", "0.02501 0 0", "0 0 0", "", "coeff 1 zcylinder 0.03 0 0 shear x 0.02"),
    ] {
        let deck = format!(
            "{}{}{more}fix w all wall/gran {wall}\n{DUMP}run 0\nrun 1\n",
            head(0.06, 1e-5, 0.7),
            grain(place, velocity)
        );
        compare(name, &deck, &[0, 1], DIGITS);
    }
}

#[test]
fn corners_edges_and_velocities_of_surfaces() {
    for (name, place, line, steps) in [
        ("mesh_corner", "0.031 0.031 0.00479", "", &[0][..]),
        ("mesh_edge", "0.031 0 0.00489", "", &[0]),
        ("mesh_surface_ang_vel_slow", "0.004 0.007 0.00499", "spin 0 0 -0.1 0 1 0 0.05", &[0]),
    ] {
        let deck = format!(
            "{}{}fix cad all surface plate.stl type 1 {line}\nfix w all wall/mesh coeff 1 of cad\n{DUMP}run 0\n",
            head(0.06, 1e-5, 0.7),
            grain(place, "0 0 0")
        );
        compare(name, &deck, steps, DIGITS);
    }
}

#[test]
fn a_surface_feels_force_torque_and_where_its_point_is() {
    for (name, about, velocity, last) in
        [("mesh_moving_contact", "", "0.01", 2), ("mesh_reference_point", "about 0.01 0 0", "100", 20)]
    {
        let deck = format!(
            "{}{}fix cad all surface plate.stl type 1 {about}\nfix w all wall/mesh coeff 1 of cad\n\
             fix mv all move/mesh mesh cad linear {velocity} 0 0\n{DUMP}\
             thermo_style custom step f_cad[1] f_cad[2] f_cad[3] f_cad[4] f_cad[5] f_cad[6] f_cad[7] f_cad[8] f_cad[9]\n\
             thermo_modify format float %.12g\nthermo 1\nrun {last}\n",
            head(0.06, 1e-5, 0.7),
            grain("0.004 0.007 0.00499", "0 0 0")
        );
        let (text, _) = ran(&deck);
        let (own, theirs) = (table(&text, 9), table(&golden(name), 9));
        // The setup shows the forces that act there; LIGGGHTS prints zeros.
        for step in 1..=last {
            close(name, step, &own[&step], &theirs[&step], DIGITS);
        }
    }
}

// The part of the velocity in the plane, lengthened to the whole: 0.0065 m/s, too slow to slide.
#[test]
fn a_belt_pulls_with_its_whole_speed() {
    let deck = format!(
        "{}{}fix cad all surface big.stl type 1 speed 0.006 0 0.0025\nfix w all wall/mesh coeff 1 of cad\n{DUMP}run 2\n",
        head(0.2, 1e-5, 0.3),
        grain("0.01 0.003 0.00498764100789", "0 0 0"),
    );
    compare("mesh_surface_vel_slow", &deck, &[0, 1, 2], DIGITS);
}

// A ball put on a belt of 0.45 m/s slides, then rolls at 2/7 of that speed, whatever the friction (LIGGGHTS: 0.1287987 m/s after the same
// time, its spring still swings).
#[test]
fn a_belt_drives_a_ball_until_it_rolls() {
    let deck = format!(
        "{}{}fix cad all surface big.stl type 1 speed 0.45 0 0\nfix w all wall/mesh coeff 1 of cad\n\
         fix g all gravity 9.81 vector 0 0 -1\n{}fix i all nve/sphere\nrun 4000\n",
        head(0.2, 1e-5, 0.3),
        grain("0.01 0.003 0.00498764100789", "0 0 0"),
        DUMP.replace("custom 1", "custom 200"),
    );
    let (_, place) = ran(&deck);
    let own = own_dump(&fs::read_to_string(place.path().join("d.txt")).unwrap());
    let speed = own[&4000][3];
    assert!((speed - 2.0 / 7.0 * 0.45).abs() < 0.005 * speed, "{speed}");
}

/// The numbers of a field in a legacy VTK file.
fn field(text: &str, name: &str) -> Vec<f64> {
    let mut lines = text.lines().skip_while(|line| !line.starts_with(&format!("{name} ")));
    let head: Vec<&str> = lines.next().unwrap().split(' ').collect();
    let wanted = head[1].parse::<usize>().unwrap() * head[2].parse::<usize>().unwrap();
    lines
        .flat_map(|line| line.split_whitespace().map(|w| w.parse().unwrap()).collect::<Vec<f64>>())
        .take(wanted)
        .collect()
}

#[test]
fn stresses_and_wear_of_triangles() {
    let wear = "wear finnie 1.0";
    for (name, velocity, omega, line, values) in [
        ("mesh_stress_vtk", "0.03 0.01 -0.1", "0 0 0", "", "stress stresscomponents area id"),
        ("mesh_wear_shallow", "0.003 0 -0.0002", "0 0 0", wear, "wear area"),
        ("mesh_wear_3", "0.01 0 -0.05", "0 0 0", wear, "wear area"),
    ] {
        let deck = format!(
            "{}{}set atom 1 omega {omega}\nfix cad all surface plate.stl type 1 {line}\nfix w all wall/mesh coeff 1 of cad\n\
             dump v all mesh/vtk 1 v_*.vtk {values} cad\nrun 2\n",
            head(0.06, 1e-5, 0.7),
            grain("0.004 -0.007 0.00499", velocity)
        );
        let (_, place) = ran(&deck);
        let theirs = golden(name);
        for step in [1, 2] {
            let own = fs::read_to_string(place.path().join(format!("v_{step}.vtk"))).unwrap();
            let part = theirs.split(&format!("{step}.vtk")).nth(1).unwrap();
            let names: &[&str] = match values {
                "wear area" => &["wear", "area"],
                _ => &["normal_stress_average", "shear_stress_average", "stress", "meshid", "area"],
            };
            // For steep impacts LIGGGHTS has 0.33333 in place of a third.
            let part_of = if name == "mesh_wear_3" { 1.1e-5 } else { DIGITS };
            for field_name in names {
                close(name, step, &field(&own, field_name), &field(part, field_name), part_of);
            }
        }
    }
}

// Types of grains with laws of their own on one wall: each of two grains is pushed as on a wall of its law alone.
#[test]
fn each_type_of_grains_has_its_law_on_a_wall() {
    let force = |types: &str, wall: &str| {
        let deck = format!(
            "units si\natom_style sphere\nboundary f f f\nregion r block -0.06 0.06 -0.06 0.06 -0.06 0.06 units box\ncreate_box 3 r\n\
             neighbor 0.002 bin\ntimestep 1e-5\npair_style granular\n\
             pair_coeff * * hertz/material 5e6 0.7 0.45 damping coeff_restitution tangential mindlin NULL 0.8 0.5\n\
             pair_coeff 2 3 hertz/material 2e7 0.5 0.3 damping coeff_restitution tangential mindlin NULL 0.8 0.1\n\
             create_atoms 1 single 0 0 0.00499 units box\ncreate_atoms 1 single 0.02 0 0.00499 units box\n\
             set group all diameter 0.01 density 2500\n{types}fix w all wall/gran {wall} zplane 0 NULL\n\
             compute p all reduce sum fz\nthermo_style custom step f_w[3] c_p\nthermo_modify format float %.12g\nrun 0\n"
        );
        table(&ran(&deck).0, 2)[&0].clone()
    };
    let both = force("set atom 2 type 2\n", "coeff 3");
    let soft = force("", "coeff 3");
    let hard = force("set group all type 2\n", "coeff 3");
    let mean = 0.5 * (soft[0] + hard[0]);
    assert!(
        (both[0] - mean).abs() < 1e-11 * mean.abs() && (both[1] + both[0]).abs() < 1e-11,
        "{both:?} {soft:?} {hard:?}"
    );
    // Twice the stiffness of LIGGGHTS' pair: 934.6156646 N/m at 10 µm (acceptance 3).
    assert!((soft[1] / (2.0 * 934.6156646e-5) - 1.0).abs() < 1e-9, "{soft:?}");
}
