//! A gas of grains cools by Haff's law.

use super::scene::Scene;

const N: usize = 343;

/// Kinetic energy per grain of mass 1, times 2/3: the granular temperature.
fn temperature(scene: &Scene) -> f64 {
    let p = &scene.world().particles;
    p.v.iter().zip(&p.mass).map(|(v, m)| m * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2])).sum::<f64>()
        / (3.0 * N as f64)
}

#[test]
fn a_smooth_gas_cools_by_haffs_law() {
    // 343 smooth spheres of diameter and mass 1 in a box of side 14: a fraction 0.0655 of the volume. With constant e the
    // temperature falls as T₀/(1 + t/τ)² (Haff 1983), 1/τ = (1 − e²)/6 f, f = 4 n σ² χ √(π T₀/m) collisions of a
    // grain per time (Enskog; χ = (1 − φ/2)/(1 − φ)³ of Carnahan & Starling).
    let e = 0.85_f64;
    let deck = format!(
        "units lj\natom_style sphere\nboundary p p p\nnewton off\ncomm_modify vel yes\nlattice sc 0.125\n\
         region world block 0 7 0 7 0 7\ncreate_box 1 world\ncreate_atoms 1 box\n\
         set group all diameter 1.0\nset group all density 1.909859317102744\n\
         velocity all create 1.0 87287 dist gaussian mom yes\n\
         pair_style granular\npair_coeff * * hooke 2e4 {e} damping coeff_restitution tangential none\n\
         fix 1 all nve/sphere\nneighbor 0.5 bin\nneigh_modify delay 0 every 1 check yes\ntimestep 0.0015\n\
         thermo_style custom step\nthermo 1000000\n"
    );
    let mut scene = Scene::new(&deck);
    // The lattice melts first.
    scene.step(1500);
    let start = temperature(&scene);
    let mut line = vec![];
    for k in 0..=8 {
        line.push((f64::from(k) * 1000.0 * 0.0015, (start / temperature(&scene)).sqrt()));
        if k < 8 {
            scene.step(1000);
        }
    }
    let volume = 14.0_f64.powi(3);
    let phi = N as f64 * std::f64::consts::PI / 6.0 / volume;
    let chi = (1.0 - phi / 2.0) / (1.0 - phi).powi(3);
    let rate = 4.0 * N as f64 / volume * chi * (std::f64::consts::PI * start).sqrt();
    let slope = (1.0 - e * e) / 6.0 * rate;
    // √(T₀/T) = 1 + t/τ. About 6 collisions per grain at the start: a few per cent of chance.
    let (t, last) = line[8];
    assert!(last > 1.3, "hardly cooled: {line:?}");
    assert!(
        ((last - 1.0) / t / slope - 1.0).abs() < 0.1,
        "{} instead of {slope}: {line:?}",
        (last - 1.0) / t
    );
    for (t, y) in &line {
        assert!((y - 1.0 - slope * t).abs() < 0.1 * last, "not a line: {line:?}");
    }
}
