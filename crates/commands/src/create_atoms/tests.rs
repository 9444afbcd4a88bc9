//! Tests of `create_atoms`.

use crate::testing::{act, more, refused, scene};

fn periodic(shift: f64) -> usize {
    let basis = if shift < 0.0 { shift + 1.0 } else { shift };
    let w = scene(&format!(
        "units si\nlattice custom 1.0 basis {basis:.17} 0.5 0.5\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\n\
         create_atoms 1 box"
    ));
    w.n()
}

// Oracle: the same deck with sites shifted by a little; LAMMPS takes 27 except within 3e-6 … 6e-6 below a face.
#[test]
fn one_site_of_two_at_a_periodic_face() {
    for (shift, count) in [(0.0, 27), (3e-6, 27), (-2.7e-6, 27), (-3.3e-6, 18), (-5.7e-6, 18), (-6.3e-6, 27)]
    {
        assert_eq!(periodic(shift), count, "{shift}");
    }
}

// Oracle: 27, 27, 64, 27 particles on a unit lattice in a box 0 … 3 with these faces.
#[test]
fn faces_decide_about_sites_on_them() {
    for (faces, count) in [("p p p", 27), ("f f f", 27), ("s s s", 64), ("m m m", 27)] {
        let mut w = scene(&format!("units si\nboundary {faces}\nlattice sc 1\nregion b block 0 3 0 3 0 3"));
        more(&mut w, "create_box 1 b\ncreate_atoms 1 region b");
        assert_eq!(w.n(), count, "{faces}");
    }
}

// Oracle: `create_atoms 1 random 4 9281 NULL` in a box 0 … 3, then `random 4 77 s` in a sphere.
#[test]
fn random_places_are_lammps_places() {
    let mut w = scene("region b block 0 3 0 3 0 3\ncreate_box 1 b\nlattice sc 1");
    more(&mut w, "create_atoms 1 random 4 9281 NULL\nregion s sphere 1.5 1.5 1.5 1.2 units box");
    more(&mut w, "create_atoms 1 random 4 77 s");
    assert_eq!(w.particles.x[0], [2.0628833235534296, 2.8800189624913122, 2.4787025914893963]);
    assert_eq!(w.particles.x[3], [2.1246090136117344, 2.3036917724198158, 0.14761905984376511]);
    assert_eq!(w.particles.x[4], [1.8714421331749496, 1.9279322713743583, 0.95768498883474873]);
    assert_eq!(w.particles.x[7], [2.1848301728651069, 1.0407153438500667, 0.70278408806900694]);
    assert_eq!(w.particles.tag, [1, 2, 3, 4, 5, 6, 7, 8]);
}

// Oracle: two small balls far apart (most attempts miss), then 200 particles that keep 0.3 apart.
#[test]
fn attempts_are_counted_as_in_lammps() {
    let mut w = scene("units si\nregion b block 0 4 0 3 0 3 units box\ncreate_box 2 b");
    more(
        &mut w,
        "region tiny sphere 0.5 0.5 0.5 0.001 units box\nregion tiny2 sphere 3.5 2.5 2.5 0.3 units box",
    );
    more(&mut w, "region u union 2 tiny tiny2\ncreate_atoms 1 random 40 123 u");
    more(&mut w, "create_atoms 1 random 200 124 NULL overlap 0.3");
    assert_eq!(w.n(), 240);
    assert_eq!(w.particles.x[2], [3.7333863149561854, 2.4255354054144278, 2.4085588002961864]);
    assert_eq!(w.particles.x[239], [1.1922303890773236, 1.3621119169341922, 0.014987912967329806]);
}

#[test]
fn single_counts_in_lattice_spacings() {
    let mut w = scene("units si\nlattice sc 0.5\nregion b block 0 4 0 4 0 4\ncreate_box 2 b");
    let printed = act(&mut w, "create_atoms 2 single 1 2 3", &[]).unwrap();
    assert_eq!(w.particles.x[0], [0.5, 1.0, 1.5]);
    assert_eq!(printed[0], "Created 1 atoms");
    assert_eq!(printed[1], "  using lattice units in orthogonal box = (0 0 0) to (2 2 2)");
    more(&mut w, "create_atoms 1 single 2 2 2 units box\ncreate_atoms 1 single 2.5 2 2 units box remap yes");
    assert_eq!((w.n(), w.particles.x[1]), (2, [0.5, 0.0, 0.0]));
}

#[test]
fn basis_points_take_types() {
    let mut w =
        scene("units si\nlattice bcc 1\nregion b block 0 2 0 2 0 2\ncreate_box 2 b\nmass 1 3\nmass 2 5");
    more(&mut w, "create_atoms 1 box basis 2 2");
    assert_eq!(w.n(), 16);
    assert!((0..16).all(|i| w.particles.kind[i] as usize == 1 + i % 2));
    assert_eq!(&w.particles.mass[..2], [3.0, 5.0]);
}

#[test]
fn blames_the_right_word() {
    let w = scene("region b block 0 3 0 3 0 3\ncreate_box 1 b");
    assert_eq!(refused(&w, "create_atoms 1 box").0, "box");
    assert_eq!(refused(&w, "create_atoms 2 single 0 0 0").0, "2");
    assert_eq!(refused(&w, "create_atoms 1 region c").0, "c");
    assert_eq!(refused(&w, "create_atoms 1 single 0 0 0 mol a 3").0, "a");
    assert_eq!(refused(&w, "create_atoms 1 single 0 0 0 overlap 3").0, "overlap");
    assert_eq!(refused(&Default::default(), "create_atoms 1 single 0 0 0").0, "create_atoms 1 single 0 0 0");
}
