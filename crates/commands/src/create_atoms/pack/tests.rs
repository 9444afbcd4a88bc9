//! Tests of packings as decks request them.

use crate::testing::{act, more, refused, scene};
use perigrain_world::World;
use std::f64::consts::PI;

fn box_of(edge: f64) -> World {
    scene(&format!(
        "units si\natom_style sphere\nregion b block 0 {edge} 0 {edge} 0 {edge} units box\ncreate_box 2 b"
    ))
}

#[test]
fn a_packing_is_logged() {
    let mut w = box_of(8.0);
    more(&mut w, "create_atoms 1 single 100 100 100 units box");
    let printed = act(&mut w, "create_atoms 2 pack b 0.55 4711 sizes mono 0.8 group g", &[]).unwrap();
    // 0.55 · 8³ / (π/6 · 0.8³) = 1050.4.
    assert!(
        printed[0].starts_with("Packed 1050 spheres in ")
            && printed[0].contains(": share 0.54978 of a volume of 512")
    );
    assert!(printed[1].starts_with("  overlap of spheres that touch 0.0"), "{}", printed[1]);
    assert_eq!(
        printed[2..],
        ["Created 1050 atoms", "  using box units in orthogonal box = (0 0 0) to (8 8 8)"]
    );
    let p = &w.particles;
    assert!(p.radius.iter().all(|r| *r == 0.4) && p.kind.iter().all(|k| *k == 2));
    // Density 1, as for spheres that `create_atoms` makes in other ways.
    assert!(p.mass.iter().all(|m| (m - PI / 6.0 * 0.8f64.powi(3)).abs() < 1e-15));
    let g = w.groups.find("g").unwrap();
    assert!(p.mask.iter().all(|m| m & g.bit() != 0) && p.tag[1049] == 1050);
    assert!(p.x.iter().all(|x| x.iter().all(|a| (0.0..8.0).contains(a))));
}

#[test]
fn opals_and_aggregates_are_logged() {
    let mut w = scene(
        "units si\natom_style sphere\nboundary p p f\nregion b block 0 6 0 10.392304845413264 0 10 units box",
    );
    more(&mut w, "create_box 1 b");
    let printed = act(&mut w, "create_atoms 1 opal b 6 1 0.4 11 sizes mono 0.5", &[]).unwrap();
    assert!(printed[0].starts_with("Packed ") && printed[0].contains("share 0.39996"), "{printed:?}");
    let mut w = box_of(9.0);
    let printed = act(&mut w, "create_atoms 1 aggregate b 0.6 11 0.7 4 sizes mono 0.7", &[]).unwrap();
    assert!(
        printed[2].starts_with(&format!("  left an aggregate of {} spheres, porosity 0.", w.n())),
        "{printed:?}"
    );
    assert_eq!(printed[3], "  one part from end to end along z, over gaps of up to 0.1 diameters");
    assert_eq!(printed[4], format!("Created {} atoms", w.n()));
}

#[test]
fn mixtures_and_numbers_come_out() {
    let mut w = box_of(8.0);
    let line = "create_atoms 1 pack b number 600 4711 sizes mix number 0.6 2 0.9 1 types 2 1 overlap 0";
    let printed = act(&mut w, line, &[]).unwrap();
    assert!(printed[0].starts_with("Packed 600 spheres in "), "{printed:?}");
    // Of diameters 0.6 and 0.9 two to one: 0.432 of 1.161 parts of the volume.
    assert_eq!(
        printed[1..3],
        ["  400 of diameter 0.6, 37.2 % of the mass", "  200 of diameter 0.9, 62.8 % of the mass"]
    );
    let of = |kind: u16| w.particles.kind.iter().filter(|k| **k == kind).count();
    assert_eq!([of(1), of(2)], [200, 400]);
    let small = w.particles.radius.iter().zip(&w.particles.kind).all(|(r, k)| (*r < 0.31) == (*k == 2));
    assert!(small, "a type each");
    let mut w = box_of(8.0);
    let printed = act(&mut w, "create_atoms 1 pack b 0.5 3 sizes mix mass 0.6 1 0.9 1 1.2 2", &[]).unwrap();
    // 64, 64 and 128 units of volume in whole spheres.
    for (line, part) in printed[1..4].iter().zip([25.0, 25.0, 50.0]) {
        let reported: f64 =
            line.split(", ").nth(1).and_then(|s| s.split(' ').next()).unwrap().parse().unwrap();
        assert!((reported - part).abs() < 0.2, "{printed:?}");
    }
    let w = box_of(8.0);
    let (word, text) = refused(&w, "create_atoms 1 pack b number 2000 1 sizes mono 1");
    assert!(word == "number" && text.contains("a share 2.045"), "{word} {text}");
    for (line, word) in [
        ("create_atoms 1 pack b 0.5 1 sizes mix mass 1 1", ""),
        ("create_atoms 1 pack b 0.5 1 sizes mix volume 1 1 2 1", "volume"),
        ("create_atoms 1 pack b 0.5 1 sizes mix mass 1 1 2 1 types 1 3", "3"),
        ("create_atoms 1 pack b number 0 1", "0"),
        ("create_atoms 1 opal b 6 1 0.4 11 sizes mix mass 1 1 2 1", "mix"),
    ] {
        let found = refused(&w, line).0;
        assert!(word.is_empty() || found == word, "{line}: {found}");
    }
}

#[test]
fn leaning_boxes_are_packed() {
    let mut w =
        scene("units si\natom_style sphere\nregion b prism 0 8 0 8 0 8 2 1 -1 units box\ncreate_box 1 b");
    let printed = act(&mut w, "create_atoms 1 pack b 0.55 4711 sizes mono 0.8", &[]).unwrap();
    assert!(
        printed[0].starts_with("Packed 1050 spheres in ") && printed[0].contains("a volume of 512"),
        "{printed:?}"
    );
    let domain = w.domain().unwrap();
    assert!(
        w.particles.x.iter().all(|x| domain.fractions(x).iter().all(|f| (-1e-9..1.0 + 1e-9).contains(f)))
    );
    let mut w =
        scene("units si\natom_style sphere\nregion b prism 0 8 0 8 0 8 2 1 -1 units box\ncreate_box 1 b");
    more(&mut w, "region c sphere 4 4 4 3 units box");
    act(&mut w, "create_atoms 1 pack c 0.5 4711 sizes mono 0.8", &[]).unwrap();
    assert!(refused(&w, "create_atoms 1 opal b 6 1 0.4 11").1.contains("opal"));
}

#[test]
fn zero_overlap_shrinks_diameters() {
    let mut w = box_of(6.0);
    let printed = act(&mut w, "create_atoms 1 pack b 0.6 5 overlap 0 sizes uniform 0.7 1.1", &[]).unwrap();
    assert_eq!(printed[1], "  overlap of spheres that touch 0 % on average, 0 % at most");
    assert!(printed[2].contains("smaller than requested"), "{printed:?}");
    let r: f64 = w.particles.radius.iter().copied().fold(0.0, f64::max);
    assert!(r < 0.55 && r > 0.52);
}

#[test]
fn the_word_to_blame() {
    let w = box_of(8.0);
    let blamed = |line: &str| refused(&w, line).0;
    for (line, word) in [
        ("pack c 0.5 1", "c"),
        ("pack b 0 1", "0"),
        ("pack b -0.5 1", "-0.5"),
        ("pack b 0.8 1", "0.8"),
        ("pack b nan 1", "nan"),
        ("pack b 0.5 0", "0"),
        ("pack b 0.5", "0.5"),
        ("pack b 0.5 1 sizes mono 0", "0"),
        ("pack b 0.5 1 sizes mono -1", "-1"),
        ("pack b 0.5 1 sizes bimodal 1 2", "bimodal"),
        ("pack b 0.5 1 sizes uniform 2 1", "1"),
        ("pack b 0.5 1 sizes lognormal 1 3", "3"),
        ("pack b 0.5 1 overlap 0.7", "0.7"),
        ("pack b 0.5 1 rounds 0", "0"),
        ("pack b 0.5 1 axis 100", "axis"),
        ("pack b 0.7 1 overlap 0 rounds 1", "0.7"),
        ("pack b 0.5 1 units box", "units"),
        ("pack b 0.5 1 mol m 3", "mol"),
        ("random 5 1 b sizes mono 1", "sizes"),
        // Two diameters must fit between a face and its image.
        ("pack b 0.5 1 sizes mono 4.5", "sizes mono 4.5"),
        ("opal b 0 1 0.5 1", "0"),
        ("opal b 4 1.2 0.5 1", "1.2"),
        ("opal b 4 0.5 0.5 1", "0.5"),
        ("opal b 4 1 0.5 1 axis 110", "110"),
        ("opal b 4 1 0.5 1 sizes uniform 0.2 0.3", "uniform"),
        // The lattice of pores does not fit the box.
        ("opal b 4 1 0.5 1 sizes mono 0.3", "4"),
        ("aggregate b 0.6 1 0.3 2", "0.3"),
        ("aggregate b 0.6 1 1.3 2", "1.3"),
        ("aggregate b 0.6 1 0.7 0", "0"),
        ("aggregate b 0.6 1 0.7 20", "20"),
        ("aggregate b 0.6 1 0.99 2", "0.99"),
    ] {
        assert_eq!(blamed(&format!("create_atoms 1 {line}")), word, "{line}");
    }
    let points = scene("units si\nregion b block 0 1 0 1 0 1\ncreate_box 1 b");
    assert_eq!(refused(&points, "create_atoms 1 pack b 0.5 1").0, "pack");
    let flat = scene(
        "units si\natom_style sphere\ndimension 2\nregion b block 0 9 0 9 -1 1 units box\ncreate_box 1 b",
    );
    assert_eq!(refused(&flat, "create_atoms 1 pack b 0.5 1").0, "pack");
}

#[test]
fn regions_that_will_not_do() {
    let mut w = scene(
        "units si\natom_style sphere\nboundary f f f\nregion b block 0 8 0 8 0 8 units box\ncreate_box 1 b",
    );
    more(&mut w, "region far sphere 20 0 0 1 units box\nregion s sphere 4 4 4 1 units box");
    more(&mut w, "region slit block 1 1.7 0 8 0 8 units box\nregion none block 2 2 0 8 0 8 units box");
    more(&mut w, "region open block 1 4 1 4 1 4 units box open 1\nregion u union 2 s slit");
    more(&mut w, "region i intersect 2 s slit side out");
    let why = |name: &str| refused(&w, &format!("create_atoms 1 pack {name} 0.5 1")).1;
    for (name, part) in [
        ("far", "no place"),
        ("none", "no place"),
        ("open", "open faces"),
        ("u", "is a union"),
        ("i", "outside of an intersection"),
        ("slit", "do not fit"),
    ] {
        assert!(why(name).contains(part), "{name}: {}", why(name));
    }
    assert!(refused(&w, "create_atoms 1 pack slit 0.5 1 overlap 0").1.contains("do not fit"));
    let d = refused(&w, "create_atoms 1 pack s 0.05 1");
    assert!(d.1.contains("not even one"), "{}", d.1);
    // Larger than the box: the part inside counts.
    more(&mut w, "region large block -5 50 -5 50 -5 4 units box");
    let printed = act(&mut w, "create_atoms 1 pack large 0.5 1 sizes mono 0.7", &[]).unwrap();
    assert!(printed[0].contains("of a volume of 256"), "{printed:?}");
    assert!(w.particles.x.iter().all(|x| x[2] < 4.0 - 0.34));
}
