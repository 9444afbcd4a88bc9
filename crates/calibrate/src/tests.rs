//! Lines of `calibrate` on small scenes.

use super::testing::{Beams, Law, act, act_with, scene as world_of};
use perigrain_world::{Key, World};
use std::collections::BTreeMap;

pub fn near(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{a} {b}");
}

const A: f64 = 1.414_213_562_373_095_1e-3;

/// Cells of a lattice of nearest distance 1 mm, bonded to nearest neighbours by bonds of type 1 of two.
fn cells(lattice: &str, edge: f64, [x, y, z]: [i32; 3], boundary: &str) -> World {
    let ends = |n: i32| format!("{} {}", -0.125, f64::from(n) - 0.125);
    let mut w = world_of(&format!(
        "units si\nboundary {boundary}\natom_style hybrid sphere bond\nlattice {lattice} {edge}\n\
         region b block {} {} {}\ncreate_box 1 b bond/types 2 extra/bond/per/atom 12\ncreate_atoms 1 box\n\
         set group all diameter 1e-3\nspecial_bonds lj/coul 0 1 1\ncreate_bonds many all all 1 0.9e-3 1.1e-3",
        ends(x),
        ends(y),
        ends(z)
    ));
    w.bonds.coeffs = Some(("beams".into(), BTreeMap::new()));
    w
}

pub fn fcc() -> World {
    cells("fcc", A, [4; 3], "f f f")
}

// Section 10.4 of the page on bonded particles, printed with 12 digits.
#[test]
fn blocks_of_a_lattice_between_ends() {
    let mut w = fcc();
    assert_eq!((w.n(), w.bonds.len()), (256, 1176));
    for (words, k) in [
        ("low grip high grip", 5430321.8781),
        ("low plate high plate", 5269009.41211),
        ("low grip high grip rotations no", 5466126.86364),
        ("low plate high plate rotations no", 5290542.81508),
    ] {
        let did = act(
            &mut w,
            &format!("calibrate dsm a all axis z strain -0.01 tol 1e-12 {words}"),
            Beams::standard(2),
        );
        let did = did.unwrap();
        near(did.numbers[0], k, 3e-12);
        let free = 3.5 * A;
        near(did.numbers[6], -0.01 * free, 1e-12);
        near(did.numbers[5], k * -0.01 * free, 1e-11);
        let area = (3.5 * A + 1e-3).powi(2);
        near(did.numbers[1], k * free / area, 1e-11);
        assert!(did.numbers[3].is_nan() && did.numbers[8..] == [0.0, 0.0] && did.notes.is_empty(), "{did:?}");
    }
    // A cylinder, a given area, the length of the body; the same along x by symmetry.
    let did =
        act(&mut w, "calibrate dsm a all axis x tol 1e-12 shape cylinder length body", Beams::standard(2))
            .unwrap();
    near(did.numbers[0], 5430321.8781, 3e-12);
    near(did.numbers[1], 5430321.8781 / 0.25 / std::f64::consts::PI / (3.5 * A + 1e-3), 1e-11);
    let did = act(&mut w, "calibrate dsm a all tol 1e-12 shape area 2e-5", Beams::standard(2)).unwrap();
    near(did.numbers[1], 5430321.8781 * 3.5 * A / 2e-5, 1e-11);
    // As in the paper, and with a bound.
    let did = act(&mut w, "calibrate dsm a all method paper 1e-9 rotations no", Beams::standard(2)).unwrap();
    near(did.numbers[0], 5466126.86364, 3e-12);
    let did = act(&mut w, "calibrate dsm a all tol 0.01 bound yes fields yes", Beams::standard(2)).unwrap();
    let [k, lower] = [did.numbers[0], did.numbers[3]];
    assert!(lower <= 5430321.8781 && k >= 5430321.8781 && k - lower <= 0.01 * k, "{did:?}");
    assert!(did.lines[0].contains("256 particles, 1176 bonds; ends held: 32 + 32"), "{did:?}");
    let u = w.columns.get_vector(Key::new("calibrate a/0")).unwrap();
    let top = |i: &usize| w.particles.x[*i][2] > 3.4 * A;
    assert!(
        (0..256)
            .filter(top)
            .all(|i| u[i] == [0.0, 0.0, -0.01 * 3.5 * A] || (u[i][2] + 0.035 * A).abs() < 1e-12)
    );
}

#[test]
fn tensors_of_a_lattice() {
    for line in [
        "calibrate periodic p all tol 1e-10",
        "calibrate ste p all",
        "calibrate ste p all order 0 axis x slabs auto",
    ] {
        let mut w = cells("fcc", A, [3; 3], "p p p");
        let did = act(&mut w, line, Beams::standard(2)).unwrap();
        let c = &did.numbers[10..];
        // Printed with ten digits.
        for (at, wanted) in
            [(0, 1007053466.0), (1, 207334537.1), (14, 1007053466.0), (21, 503526733.0), (35, 503526733.0)]
        {
            near(c[at], wanted, 5e-10);
        }
        assert!(c.len() == 36 && c[3].abs() < 1e-3);
        near(did.numbers[1], 936256307.0, 1e-9);
        near(did.numbers[2], 7.0 / 41.0, 1e-10);
        let k = if line.contains("ste") {
            936256307.0 * 3.0 * A
        } else {
            (1007053466.0 + 2.0 * 207334537.1) / 3.0
        };
        near(did.numbers[0], k, 1e-9);
    }
}

#[test]
fn maps_show_where_a_body_is_soft() {
    let mut w = cells("fcc", A, [4; 3], "p p p");
    let beams = Beams::standard(2);
    let map = |w: &mut World, line: &str| {
        act(w, line, beams.clone()).unwrap();
        w.columns.get_vector(Key::new("calibrate m/0")).unwrap().to_vec()
    };
    // All are alike: K of the whole cell, and no deviation. Printed with ten digits.
    for k in map(&mut w, "calibrate ste m all map stiffness 1.5e-3") {
        k.iter().for_each(|k| near(*k, 936256307.0 * 4.0 * A, 1e-9));
    }
    assert!(map(&mut w, "calibrate ste m all map deviation 1.5e-3").iter().flatten().all(|d| d.abs() < 1e-9));
    // Without the bonds of one particle its surroundings are the softest.
    w.bonds.retain(|b| !b.ends.contains(&77));
    let found = map(&mut w, "calibrate ste m all map deviation 1.5e-3 order 0");
    let softest = (0..256).max_by(|a, b| found[*a][0].total_cmp(&found[*b][0])).unwrap();
    assert_eq!(w.particles.tag[softest], 77);
    let mean: f64 = found.iter().map(|d| d[2]).sum();
    assert!(mean.abs() < 1e-9 && found[softest][2] > 0.05);
}

#[test]
fn one_type_is_fitted_by_one_solve() {
    let mut w = fcc();
    for (line, power, k) in [
        ("calibrate fit f all target K 2.0e4 vary bond 1 E tol 1e-10", 1.0, 5430321.8781),
        (
            "calibrate fit f all target K 2.0e4 vary bond 1 E tol 1e-10 low plate high plate",
            1.0,
            5269009.41211,
        ),
    ] {
        let did = act(&mut w, line, Beams::standard(2)).unwrap();
        let found: Vec<f64> = did.then[0].split(' ').skip(2).map(|a| a.parse().unwrap()).collect();
        assert!(
            did.then.len() == 1 && did.then[0].starts_with("bond_coeff 1 ") && found[1..] == [0.2, 0.4e-3]
        );
        near(found[0], 1e9 * (2.0e4f64 / k).powf(1.0 / power), 2e-10);
        near(did.numbers[0], 2.0e4, 1e-12);
        near(did.numbers[10], found[0], 1e-12);
        assert!(did.lines.iter().filter(|l| l.contains("solve ")).count() == 1, "{did:?}");
        // The other way round.
        let mut beams = Beams::standard(2);
        beams.0.insert(1, [found[0], 0.2, 0.4e-3]);
        let ends = if line.contains("plate") { "low plate high plate" } else { "" };
        let did = act(&mut w, &format!("calibrate dsm d all tol 1e-12 {ends}"), beams).unwrap();
        near(did.numbers[0], 2.0e4, 1e-9);
    }
    // The radius bends with another power than it stretches.
    let did =
        act(&mut w, "calibrate fit f all target E 2.0e9 vary bond 1 radius tol 1e-8", Beams::standard(2))
            .unwrap();
    near(did.numbers[1], 2.0e9, 1e-8);
    assert!(did.lines.iter().filter(|l| l.contains("solve ")).count() <= 5, "{did:?}");
    for method in ["ste", "periodic"] {
        let mut w = cells("fcc", A, [3; 3], "p p p");
        let line = format!("calibrate fit f all target E 936256.307 vary bond 1 E method {method} tol 1e-8");
        let did = act(&mut w, &line, Beams::standard(2)).unwrap();
        near(did.then[0].split(' ').nth(2).unwrap().parse().unwrap(), 1e6, 1e-8);
    }
}

/// A block in which bonds along the axis are of type 2.
fn of_two_types() -> World {
    let mut w = fcc();
    let x = w.particles.x.to_vec();
    for bond in &mut w.bonds.list {
        let [a, b] = bond.ends.map(|id| x[id as usize - 1]);
        // Lines of the lattice lie in planes across the axes: type 2 has no part along z.
        bond.kind = if (a[2] - b[2]).abs() < 1e-6 { 2 } else { 1 };
    }
    w
}

#[test]
fn two_types_meet_two_targets() {
    let mut w = of_two_types();
    let mut wanted = Beams::standard(2);
    wanted.0.insert(2, [3e9, 0.2, 0.4e-3]);
    for (method, ends) in [("dsm", "low plate high plate"), ("dsm", ""), ("ste", "")] {
        let line = if method == "dsm" {
            format!("calibrate dsm d all {ends} tol 1e-10")
        } else {
            "calibrate ste d all".into()
        };
        let did = act(&mut w, &line, wanted.clone()).unwrap();
        let (k, nu) = (did.numbers[0], did.numbers[2]);
        // From a factor of ten off, in either direction.
        let mut start = Beams::standard(2);
        start.0.insert(1, [1e10, 0.2, 0.4e-3]);
        start.0.insert(2, [0.3e9, 0.2, 0.4e-3]);
        let line = format!(
            "calibrate fit f all target K {k} target nu {nu} vary bond 1 E vary bond 2 E method {method} tol 1e-4 {ends}"
        );
        let did = act(&mut w, &line, start).unwrap();
        println!("{}", did.lines.join("\n"));
        near(did.numbers[0], k, 1.1e-4);
        near(did.numbers[2], nu, 1.1e-4);
        let solves = did.lines.iter().filter(|l| l.contains("solve ")).count();
        assert!(solves <= 6, "{did:?}");
        for (k, (line, e)) in did.then.iter().zip([1e9, 3e9]).enumerate() {
            let set = line.split(' ').nth(2).unwrap().parse().unwrap();
            near(set, e, 2e-3);
            near(did.numbers[10 + k], set, 1e-12);
        }
    }
    // One target leaves a direction open; a note names it.
    let did = act(
        &mut w,
        "calibrate fit f all target K 1e6 vary bond 1 E vary bond 2 E tol 1e-6",
        Beams::standard(2),
    );
    assert!(did.unwrap().lines.iter().any(|l| l.contains("leave open: E of type 1 ^")));
}

/// Two spheres of 1 mm with a bond along z.
pub fn two_spheres() -> World {
    let mut w = world_of(
        "units si\nboundary f f f\natom_style hybrid sphere bond\nregion b block 0 1 0 1 0 1\n\
         create_box 1 b bond/types 1 extra/bond/per/atom 2\ncreate_atoms 1 single 0.5 0.5 0.5 units box\n\
         create_atoms 1 single 0.5 0.5 0.501 units box\nset group all diameter 1e-3\n\
         special_bonds lj 0 1 1 coul 1 1 1\ncreate_bonds single/bond 1 1 2",
    );
    w.bonds.coeffs = Some(("beams".into(), BTreeMap::new()));
    w
}

// Section 10.5 of the page: two spheres with the standard bond between rigid planes.
#[test]
fn a_pair_between_walls() {
    let mut w = two_spheres();
    for (strain, f, k) in [
        (-0.005, 0.315090744409, 31509.07444),
        (-0.01, 0.858953424153, 42947.67121),
        (-0.02, 2.31258968887, 57814.74222),
    ] {
        for line in [
            format!("calibrate dsm a all strain {strain} low wall high wall tol 1e-10"),
            format!("calibrate dsm a all strain {strain} low wall high wall method paper 1e-12 1e-12"),
            format!("calibrate ste a all strain {strain} low wall high wall order 0"),
        ] {
            let did = act_with(&mut w, &line, Beams::standard(1), Law::Hertz).unwrap();
            // Coordinates of half a metre: the length of the bond is 1 mm to 1e-13. Printed with ten digits.
            near(did.numbers[0], k, 2e-10);
            near(did.numbers[5], -f, 2e-10);
            near(did.numbers[6], 2e-3 * strain, 1e-10);
            if line.contains("tol") {
                let steps =
                    did.lines[2].split(" steps of Newton").next().unwrap().rsplit(' ').next().unwrap();
                assert!(steps.parse::<usize>().unwrap() <= 6 && did.notes.is_empty(), "{did:?}");
                // Hertz' springs hold 2/5 F δ each, the bond ½ F²/k.
                let walls = 0.8 * f * (f / 31056499.69f64).powf(2.0 / 3.0);
                let bond = 0.5 * f * f / 502654.824574;
                near(did.numbers[8], walls / (walls + bond), 1e-8);
                assert!(
                    did.lines[0].contains("ends held: 1 at a wall + 1 at a wall")
                        && did.lines[2].contains("walls ")
                );
            }
        }
    }
    // A softer bond of which the whole has the stiffness of the first case: fitted though it is one of many springs.
    let line =
        "calibrate fit f all target K 31509.07444 vary bond 1 E strain -0.005 low wall high wall tol 1e-9";
    let mut start = Beams::standard(1);
    start.0.insert(1, [0.1e9, 0.2, 0.4e-3]);
    let did = act_with(&mut w, line, start, Law::Hertz).unwrap();
    near(did.then[0].split(' ').nth(2).unwrap().parse().unwrap(), 1e9, 1e-6);
}

#[test]
fn contacts_carry_load_beside_bonds() {
    let mut w = fcc();
    let bare = act_with(&mut w, "calibrate dsm a all strain -0.02 tol 1e-6", Beams::standard(2), Law::Hertz)
        .unwrap();
    // Bonded pairs have no contacts.
    near(bare.numbers[0], 5430321.8781, 1e-6);
    w.bonds.weights.lj = [1.0; 3];
    let did = act_with(&mut w, "calibrate dsm a all strain -0.02 tol 1e-6", Beams::standard(2), Law::Hertz)
        .unwrap();
    assert!(
        did.numbers[0] > 1.001 * bare.numbers[0] && did.numbers[8] > 0.0 && did.numbers[4].is_nan(),
        "{did:?}"
    );
    assert!(did.lines[0].contains(" contacts;") && did.notes.is_empty());
    // Pulled, most contacts open; neighbours in planes across come closer.
    let pulled =
        act_with(&mut w, "calibrate dsm a all strain 0.02 tol 1e-6", Beams::standard(2), Law::Hertz).unwrap();
    assert!(pulled.numbers[0] < did.numbers[0]);
    let without = act_with(
        &mut w,
        "calibrate dsm a all strain -0.02 tol 1e-6 contacts no",
        Beams::standard(2),
        Law::Hertz,
    );
    near(without.unwrap().numbers[0], bare.numbers[0], 1e-12);
    // Contacts of another law are left out, with a note.
    let hooke = act_with(&mut w, "calibrate dsm a all strain -0.02 tol 1e-6", Beams::standard(2), Law::Hooke)
        .unwrap();
    near(hooke.numbers[0], bare.numbers[0], 1e-12);
    assert!(hooke.notes[0].starts_with("contacts are left out"));
    let e = |w: &mut World, law: Law| {
        act_with(w, "calibrate ste a all strain -0.02", Beams::standard(2), law).unwrap()
    };
    let (with, bonds) = (e(&mut w, Law::Hertz), e(&mut w, Law::None));
    assert!(with.numbers[1] > bonds.numbers[1] && with.numbers[8] > 0.0 && bonds.numbers[8] == 0.0);
}

/// The word that is to blame, the message, and the help.
pub fn refused(w: &World, line: &str, beams: Beams) -> String {
    let d = act(&mut w.clone(), line, beams).expect_err(line).0.remove(0);
    let span = d.span.unwrap_or_default();
    format!("[{}] {} | {}", &line[span.start as usize..span.end as usize], d.message, d.help.join(" "))
}

#[test]
fn what_makes_no_sense_is_refused() {
    let w = fcc();
    for (line, wanted) in [
        ("calibrate dms a all", "[dms] "),
        ("calibrate dsm a-b all", "[a-b] `a-b` is no ID"),
        ("calibrate dsm taken all", "[taken] there is a compute ke of the ID `taken`"),
        ("calibrate dsm a nogroup", "[nogroup] there is no group"),
        ("calibrate dsm a all strain -1", "[-1] a strain of -1 turns bonds inside out"),
        ("calibrate dsm a all strain 0", "[0] without a strain"),
        (
            "calibrate dsm a all order 2",
            "[order] `order` does not concern `calibrate dsm` | `calibrate ste` has it",
        ),
        ("calibrate dsm a all tolerance 2", "[tolerance] "),
        ("calibrate dsm a all tol 2", "[2] the tolerance"),
        ("calibrate dsm a all low plate bound yes", "[yes] `bound yes` needs both ends held wholly"),
        ("calibrate dsm a all thick 0.004", "[calibrate dsm a all thick 0.004] the body is too short"),
        (
            "calibrate periodic a all",
            "[calibrate periodic a all] `calibrate periodic` needs a box that repeats in all directions, not `boundary ff ff ff`",
        ),
        ("calibrate fit a all target K 1", "[calibrate] a fit needs a `target` and something to `vary`"),
        ("calibrate fit a all vary bond 3 E target K 1", "[3] there are bond types 1 to 2"),
        (
            "calibrate fit a all vary bond 1 k target K 1",
            "[k] bond_style beams has no coefficient `k` of bond type 1 to vary | known: E nu radius",
        ),
        (
            "calibrate fit a all vary bond 2 E target K 1",
            "[E] `E` of bond type 2 changes none of the targets",
        ),
        (
            "calibrate fit a all vary bond 1 E target nu 0.3",
            "[E] `E` of bond type 1 changes none of the targets",
        ),
        ("calibrate fit a all vary bond 1 nu target K 1e3", "the targets K 1000 are not reached"),
    ] {
        let refusal = refused(&w, line, Beams::standard(2));
        assert!(refusal.contains(wanted), "{line}: {refusal}");
    }
    let mut none = Beams::standard(2);
    none.0.clear();
    assert!(
        refused(&w, "calibrate dsm a all", none)
            .contains("has no coefficients for bond type 1 | add `bond_coeff 1")
    );
    let mut soft = Beams::standard(2);
    soft.0.insert(1, [7.0, 0.2, 1.0]);
    assert!(refused(&w, "calibrate dsm a all", soft).contains("no stiffness for small displacements"));
    let mut odd = Beams::standard(2);
    odd.0.insert(1, [-1e9, 0.2, 0.4e-3]);
    assert!(refused(&w, "calibrate ste a all", odd).contains("negative or infinite stiffness"));
    let mut bare = fcc();
    bare.bonds.list.clear();
    assert!(
        refused(&bare, "calibrate dsm a all", Beams::standard(2))
            .contains("no bonds between particles of group `all`")
    );
    // Cut through the middle.
    let mut cut = fcc();
    let x = cut.particles.x.to_vec();
    cut.bonds.retain(|b| {
        let [a, b] = b.ends.map(|id| x[id as usize - 1][2] < 1.9 * A);
        a == b
    });
    assert!(
        refused(&cut, "calibrate dsm a all", Beams::standard(2))
            .contains("no chain of bonds leads from end to end")
    );
    let periodic = cells("fcc", A, [3; 3], "p p p");
    assert!(
        refused(&periodic, "calibrate dsm a all axis y", Beams::standard(2))
            .contains("has no ends along y: a bond between")
    );
}

#[test]
fn pieces_and_loose_particles_are_reported() {
    let mut w = fcc();
    // Two particles torn off, bonded to each other.
    let x = w.particles.x.to_vec();
    let pair: Vec<u32> = (1..=256)
        .filter(|id| {
            let x = x[*id as usize - 1].map(|a| (2.0 * a / A).round());
            x == [3.0, 3.0, 2.0] || x == [3.0, 4.0, 3.0]
        })
        .collect();
    w.bonds.retain(|b| b.ends.iter().filter(|e| pair.contains(e)).count() != 1);
    let did = act(&mut w, "calibrate dsm a all", Beams::standard(2)).unwrap();
    assert_eq!((pair.len(), did.numbers[9]), (2, 2.0));
    assert!(did.lines[0].contains("1 piece (2 particles) without support left out"), "{did:?}");
    // Springs alone: a corner with two of its three bonds left moves across both.
    let mut beams = Beams::standard(2);
    beams.0.insert(1, [1e9, f64::INFINITY, 0.4e-3]);
    let mut w = fcc();
    let did = act(&mut w, "calibrate dsm a all low plate high plate", beams.clone()).unwrap();
    assert!(did.notes.is_empty());
    let middle = (1..=256).find(|id| w.particles.x[*id as usize - 1][2] > 1.2 * A).unwrap();
    let first = w.bonds.list.iter().filter(|b| b.ends.contains(&middle)).copied().collect::<Vec<_>>();
    w.bonds.retain(|b| !b.ends.contains(&middle) || first[..2].contains(b));
    let did = act(&mut w, "calibrate dsm a all low plate high plate", beams).unwrap();
    assert!(did.notes[0].starts_with("1 particles can move in some direction"), "{did:?}");
}
