//! Reading the scene never changes results: steps that run into each other have the bits of steps made one by one.

use super::scene::Scene;

const STEPS: i64 = 400;

/// Grains that fall on a frozen layer and slide, in one run of which `look` is part; places, velocities and spins after it.
fn end(look: &str, steps: i64) -> String {
    let mut scene = Scene::new(&format!(
        "units lj\natom_style sphere\nboundary p p f\nnewton off\ncomm_modify vel yes\n\
         region world block 0 6 0 6 0 9 units box\ncreate_box 1 world\nlattice sc 1.0\n\
         region layer block 0 5.5 0 5.5 0 0.5\nregion cloud block 0 5.5 0 5.5 1 4\n\
         create_atoms 1 region layer\ncreate_atoms 1 region cloud\n\
         variable d atom 0.9+0.05*sin(7*x+3*y+z)\nset group all diameter v_d\nset group all density 1\n\
         group base region layer\ngroup flow subtract all base\n\
         pair_style gran/hertz/history 2000 NULL 5 NULL 0.5 1\npair_coeff * *\n\
         velocity flow set 0.5 0.2 -1\nfix 1 flow nve/sphere\nfix 2 all gravity 2 chute 26\nfix 3 base freeze\n\
         neighbor 0.1 bin\nneigh_modify every 1 delay 0 check yes\ntimestep 0.002\nthermo 10000\n{look}\n"
    ));
    scene.say(&format!("run {steps} post no"));
    let p = &scene.world().particles;
    assert!(p.omega.iter().any(|w| w[0].abs() > 1e-3), "nothing rolls");
    format!("{:?} {:?} {:?} {:?}", p.tag, p.x, p.v, p.omega)
}

#[test]
fn looking_at_some_steps_or_all_changes_no_bit() {
    let alone = end("", STEPS);
    for look in [
        "thermo 1",
        "thermo 7",
        "fix look all ave/time 3 2 30 c_thermo_temp",
        // Particles that a second fix moves are no matter of the first one, and ways are no longer accounted for.
        "group none empty\nfix other none nve",
        "fix other base move linear 0 0 0",
        // Steps of the guard may be taken back.
        "fix g all dt/guard 50 1e9",
    ] {
        if end(look, STEPS) != alone {
            panic!("`{look}` changes the motion");
        }
    }
    let halted = "variable now equal step\nfix h all halt 1 v_now >= 233 error continue";
    assert!(end(halted, STEPS) == end("", 233), "a halt leaves half a step");
}
