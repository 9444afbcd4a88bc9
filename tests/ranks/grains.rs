//! Grains and bonded particles shared out to ranks.

use super::{
    LAUNCHERS, PERIGRAIN, exchanged, files, left_by, measured, output_of, perigrain, same, start, works,
};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Grains that fall into a bowl between planes, onto a triangle mesh, while others come and some are lost.
const BOWL: &str = "units lj\natom_style sphere\nboundary p f f\nnewton off\ncomm_modify vel yes\n\
    region box block 0 12 -1 11 -3 16 units box\ncreate_box 1 box\n\
    region fill block 0 12 0.4 9.6 0.2 7 units box\ncreate_atoms 1 random 900 4711 fill overlap 0.9 maxtry 900 units box\n\
    set group all diameter 1.0\nset group all mass 1.0\nvelocity all create 1.0 77\n\
    pair_style gran/hooke/history 5000 NULL 50 NULL 0.5 1\npair_coeff * *\n\
    neighbor 0.2 bin\nneigh_modify every 1 delay 0 check yes\ntimestep 0.001\n\
    fix move all nve/sphere\nfix g all gravity 1.0 vector 0.2 0 -1\n\
    fix sides all wall/gran hooke/history 5000 NULL 50 NULL 0.5 1 yplane 0 10 contacts\n\
    variable lift equal 0.2*step*dt\n\
    region floor cylinder x 5 6 7 INF INF side in units box move NULL NULL v_lift open 1 open 2\n\
    fix bowl all wall/gran/region hooke/history 5000 NULL 50 NULL 0.5 1 region floor\n\
    fix mesh all wall/mesh granular hooke 5000 50 damping mass_velocity tangential linear_history 2000 0 0.5 mesh floor.stl\n\
    region slot block 2 10 2 8 12 15 units box\nfix rain all deposit 12 1 20 4711 region slot near 1.1 vz -2 -2 units box\n\
    thermo_modify norm no lost ignore format float %.15g\n";

/// What is written of it: sums, dumps of particles, of walls' contacts and of the work on the mesh, restart files.
const BOWL_WRITES: &str = "compute s all stress/atom NULL\ncompute z all contact/atom\ncompute zs all reduce sum c_z\n\
    thermo_style custom step atoms ke press c_zs f_sides[2] f_sides[3] f_bowl[3] f_mesh[3]\nthermo 50\n\
    dump all all custom 100 d.*.txt id x y z vx omegay fx c_z c_s[1] f_sides[1] f_sides[4]\ndump_modify all format float %.17g\n\
    dump work all local 100 w.*.txt f_mesh[1] f_mesh[5]\nrestart 70 r.*.restart\n";

/// A plate under the bowl.
fn plate(folder: &Path) {
    let facet = |[a, b, c]: [&str; 3]| {
        format!("facet normal 0 0 1\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n")
    };
    let corners = ["-1 -2 1", "13 -2 1", "13 12 1.5", "-1 12 1.5"];
    let both = facet([corners[0], corners[1], corners[2]]) + &facet([corners[0], corners[2], corners[3]]);
    fs::write(folder.join("floor.stl"), format!("solid floor\n{both}endsolid floor\n")).unwrap();
}

/// What a deck of the bowl leaves behind.
fn left_by_bowl(deck: &str, words: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    plate(folder.path());
    fs::write(folder.path().join("in.deck"), deck).unwrap();
    let o = perigrain(folder.path(), &[&["-in", "in.deck", "-screen", "none"], words].concat());
    assert!(o.status.success(), "{words:?}: {}", output_of(&o));
    files(folder.path())
}

/// Forces of contacts with history, walls of three kinds, what walls feel and how often triangles are rubbed, pressures by contacts, and
/// the warning of the first that is too deep in a wall.
#[test]
fn grains_are_shared_out_with_the_bytes_of_one_process() {
    let deck = format!("{BOWL}{BOWL_WRITES}run 150\nwrite_restart end.restart\nrun 60\n");
    let alone = left_by_bowl(&deck, &["-threads", "1"]);
    let log = String::from_utf8_lossy(&alone["log.lammps"]).into_owned();
    assert!(log.contains("of its radius deep in the wall"), "{log}");
    for (ranks, threads) in [("2", "2"), ("3", "1"), ("5", "1")] {
        let several = left_by_bowl(&deck, &["-ranks", ranks, "-threads", threads]);
        same(&alone, &several, &format!("a bowl on {ranks} ranks"));
    }
}

/// What reads a sum over particles within a step, now and then, reads that of the step before.
#[test]
fn sums_are_known_where_they_are_read_within_steps() {
    let deck = format!(
        "{BOWL}variable wide equal 1.0+1e-7*f_g\nfix grow all adapt 10 atom diameter v_wide\nrun 40\n\
         write_dump all custom last.txt id x y z radius modify format float %.17g\n"
    );
    let alone = left_by_bowl(&deck, &["-threads", "1"]);
    same(&alone, &left_by_bowl(&deck, &["-ranks", "3", "-threads", "1"]), "grains that grow");
}

/// A variable that is read in every step has the forces of that step on all ranks' grains.
#[test]
fn forces_on_walls_are_those_of_all_ranks_where_every_step_reads_them() {
    let reads = "variable push equal f_sides[3]\nfix most all extremes 1 v_push\n\
        thermo_style custom step ke f_sides[3] f_most[1] f_most[2]\nthermo 20\nrun 60\n";
    let deck = format!("{BOWL}{reads}");
    let alone = left_by_bowl(&deck, &["-threads", "1"]);
    for ranks in ["2", "3"] {
        same(
            &alone,
            &left_by_bowl(&deck, &["-threads", "1", "-ranks", ranks]),
            &format!("extremes on {ranks} ranks"),
        );
    }
}

#[test]
fn quiet_steps_of_grains_gather_nothing() {
    let folder = tempfile::tempdir().unwrap();
    plate(folder.path());
    fs::write(folder.path().join("in.deck"), format!("{BOWL}thermo 100\nrun 100\n")).unwrap();
    let o = perigrain(folder.path(), &["plan", "--measure", "-ranks", "3", "-threads", "1", "in.deck"]);
    assert!(output_of(&o).contains("ranks: 765 grains are few for 3 ranks"), "{}", output_of(&o));
    let ops = exchanged(&output_of(&o));
    // Places of all are known where grains come, and where lists are made anew.
    let looks = ["reneighbor", "pair gran/hooke/history", "fix rain deposit"];
    for (op, rows, gathers) in &ops {
        assert!(*gathers == 0 || looks.iter().any(|look| op.starts_with(look)), "`{op}` needs {rows} rows");
        assert!(*gathers < 30, "`{op}`: {gathers} gathers in 100 steps");
    }
    let own = |op: &str| ops.iter().any(|(name, rows, _)| name.starts_with(op) && rows == "own");
    assert!(["fix move", "fix g ", "fix sides", "fix bowl", "fix mesh"].into_iter().all(own), "{ops:?}");
}

/// A dense gas of grains in a box that is sheared and squeezed, read in every step: more grains than one leaf of a sum has.
const SHEARED: &str = "units lj\natom_style sphere\nboundary p p p\nnewton off\ncomm_modify vel yes\n\
    lattice sc 1.0\nregion box prism 0 17 0 15 0 17 0 0 0\ncreate_box 2 box\ncreate_atoms 1 box\n\
    set group all type/fraction 2 0.3 8123\nset group all diameter 0.99\nset group all density 1.0\n\
    group some type 2\nvelocity all create 1.0 77\n\
    pair_style gran/hooke/history 5000 NULL 50 NULL 0.5 1\npair_coeff * *\n\
    neighbor 0.2 bin\nneigh_modify every 1 delay 0 check yes\ntimestep 0.001\nfix move all nve/sphere\n\
    compute t all temp\ncompute d some temp/deform\ncompute s some temp/sphere\ncompute k all ke\ncompute r some erotate/sphere\n\
    compute c some com\ncompute g all gyration\ncompute m all msd com yes\ncompute v all vacf\ncompute l some momentum\n\
    compute p all pressure d\nthermo_modify norm no format float %.15g\nthermo_style custom step temp press c_p[4] lx xy\nthermo 10\n\
    fix all all ave/time 1 1 1 c_t c_t[1] c_d c_s c_s[4] c_k c_r c_c[1] c_g c_m[4] c_v[2] c_l[3] c_p c_p[4] file sums.txt format \" %.17g\"\n";

#[test]
fn sums_and_boxes_that_move_request_no_rows_of_other_ranks() {
    let runs = "fix shear all deform/pressure 1 xy erate 0.5 y pressure 1.0 0.01 max/rate 0.05 remap v\nrun 40\nunfix shear\n\
        fix squeeze all deform 1 x scale 0.99 xz erate 0.1 remap x\nrun 20\nwrite_restart end.restart\n\
        dump last all custom 1 d.*.txt id x y z vx omegay\ndump_modify last format float %.17g\nrun 0\n";
    let deck = format!("{SHEARED}{runs}");
    let alone = left_by(&deck, &["-threads", "1"]);
    for (ranks, threads) in [("2", "2"), ("3", "1"), ("5", "1")] {
        same(
            &alone,
            &left_by(&deck, &["-ranks", ranks, "-threads", threads]),
            &format!("sums on {ranks} ranks"),
        );
    }
    // The sums are read in every tenth step, the box moves in all.
    let deck =
        deck.replace("ave/time 1 1 1", "ave/time 10 1 10").replace("deform/pressure 1", "deform/pressure 10");
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.deck"), deck).unwrap();
    for (op, rows, gathers) in measured(folder.path(), &["in.deck"]) {
        let looks = ["reneighbor", "pair "].iter().any(|look| op.starts_with(look));
        assert!(looks || gathers == 0, "`{op}` needs {rows} rows, {gathers} gathers");
    }
}

/// Contacts of three laws, one of which sticks, in tiles that have all of them.
#[test]
fn several_laws_are_shared_out() {
    let law = |words: &str| format!("{words} 0.5 0.3 tangential mindlin NULL 1.0 0.5 damping tsuji");
    let laws = format!(
        "pair_style granular\npair_coeff 1 1 {}\npair_coeff 2 2 {}\npair_coeff 1 2 jkr 5000 0.5 0.3 2.0 tangential linear_nohistory 1.0 0.5 damping viscoelastic\n",
        law("hertz/material 5000"),
        law("hertz/material 20000"),
    );
    let wet = "pair_style granular\n\
        pair_coeff 1 1 hertz/material 5000 0.5 0.3 damping coeff_restitution tangential mindlin NULL NULL 0.5 slip spring rolling epsd 0.1 0.3 full cohesion capillary 1e-4 0.5 20\n\
        pair_coeff 2 2 hooke/hysteresis 5000 0.5 0.3 1 2 0.2 0.05 damping coeff_restitution tangential linear_history NULL NULL 0.5 slip spring rolling epsd2 0.1\n\
        pair_coeff 1 2 hertz/material 5000 0.5 0.3 damping coeff_restitution tangential mindlin NULL NULL 0.5 slip spring rolling cdt 0.1 cohesion sjkr 20 material 20000 0.3\n";
    let deck = |laws: &str| {
        SHEARED.replace("pair_style gran/hooke/history 5000 NULL 50 NULL 0.5 1\npair_coeff * *\n", laws)
            + "dump all all custom 20 d.*.txt id x y z omegay fx\ndump_modify all format float %.17g\nrun 40\nwrite_restart end.restart\n"
    };
    for deck in [&laws[..], wet].map(deck) {
        let alone = left_by(&deck, &["-threads", "1"]);
        for (ranks, threads) in [("2", "1"), ("3", "2"), ("5", "1")] {
            same(
                &alone,
                &left_by(&deck, &["-ranks", ranks, "-threads", threads]),
                &format!("laws on {ranks} ranks"),
            );
        }
    }
    let deck = deck(&laws);
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.deck"), deck.replace("ave/time 1 1 1", "ave/time 10 1 10")).unwrap();
    let ops = measured(folder.path(), &["in.deck"]);
    assert!(ops.iter().any(|(op, rows, _)| op == "pair granular" && rows == "asked"), "{ops:?}");
}

/// Grains by each MPI library: with messages of nothing where no contact is too deep and no bond breaks.
#[test]
fn grains_have_the_same_bytes_by_real_launchers() {
    let deck = format!(
        "{SHEARED}fix squeeze all deform 1 x scale 0.99 remap x\nrun 20\nwrite_restart end.restart\n"
    );
    let alone = left_by(&deck, &["-threads", "1"]);
    for launcher in LAUNCHERS.into_iter().filter(works) {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("in.deck"), &deck).unwrap();
        let (program, own, library) = launcher;
        let words = ["-n", "3", PERIGRAIN, "-in", "in.deck", "-screen", "none", "-threads", "1"];
        let o = start(folder.path(), program, &[own, &words].concat()).wait_with_output().unwrap();
        assert!(o.status.success(), "{library}: {}", output_of(&o));
        same(&alone, &files(folder.path()), &format!("grains by {library}"));
    }
}

/// A block of spheres held together by bonds that break where it is torn: forces, breaking, and what is written of it.
#[test]
fn bonds_are_evaluated_by_the_ranks_of_their_particles() {
    let deck = "units lj\natom_style bpm/sphere\nboundary f f f\nnewton on off\n\
        special_bonds lj 0.0 1.0 1.0 coul 0.0 1.0 1.0\ncomm_modify vel yes cutoff 3.0\nlattice fcc 1.0\n\
        region world block -3 16 -3 9 -3 9\nregion block block 0 9.1 0 4.1 0 4.1\n\
        create_box 1 world bond/types 1 extra/bond/per/atom 20 extra/special/per/atom 60\ncreate_atoms 1 region block\n\
        set group all diameter 1.1\nset group all density 1.0\nneighbor 0.3 bin\n\
        pair_style gran/hooke/history 1.0 NULL 0.5 NULL 0.1 1\npair_coeff 1 1\nbond_style zero\nbond_coeff *\n\
        create_bonds many all all 1 0.0 1.2\nspecial_bonds lj 0.0 1.0 1.0 coul 1.0 1.0 1.0\n\
        bond_style bpm/rotational break yes store/local record 5 time id1 id2 x\n\
        bond_coeff 1 0.7 0.28 0.035 0.044 0.2 0.2 0.02 0.02 0.01 0.01 0 0\n\
        fix 1 all nve/bpm/sphere\nvelocity all create 0.02 4534 loop geom\nvelocity all ramp vx -0.3 0.3 x 0 9 sum yes\n\
        timestep 0.05\nthermo_style custom step ke bonds pe\nthermo_modify format float %.15g\nthermo 20\n\
        dump all all custom 40 d.*.txt id x y z omegax fz\ndump_modify all format float %.17g\n\
        dump local all local 20 broken.*.txt f_record[1] f_record[2] f_record[3] f_record[4]\nrun 80\nwrite_restart end.restart\n";
    let alone = left_by(deck, &["-threads", "1"]);
    let bonds = |step: &str| {
        let log = String::from_utf8_lossy(&alone["log.lammps"]).into_owned();
        let row = log.lines().find(|line| line.trim_start().starts_with(step)).map(str::to_string);
        row.and_then(|row| row.split_whitespace().nth(2)?.parse::<f64>().ok()).unwrap()
    };
    assert!(bonds("80 ") < 0.95 * bonds("0 "), "some break");
    for (ranks, threads) in [("2", "1"), ("3", "2"), ("5", "1")] {
        same(
            &alone,
            &left_by(deck, &["-ranks", ranks, "-threads", threads]),
            &format!("bonds on {ranks} ranks"),
        );
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.deck"), deck).unwrap();
    let ops = measured(folder.path(), &["in.deck"]);
    assert!(
        ops.iter().any(|(op, rows, _)| op.starts_with("bond bpm/rotational") && rows == "asked"),
        "{ops:?}"
    );
}

/// Examples of grains, with enough of them for three ranks and few steps.
const EXAMPLES: [(&str, &str); 5] = [
    ("chute", "-var side 8 -var H 8 -var tsettle 0.5 -var tstart 0.4 -var tmean 0.4 -var picture no"),
    ("hopper", "-var R 6 -var H 8 -var D 5 -var tsettle 1 -var tstart 1 -var tmean 1"),
    ("rotating_drum", "-var R 8 -var L 4 -var tsettle 0.5 -var turn 0.001 -var tmean 1 -var picture no"),
    ("angle_of_repose", "-var R 6 -var tsettle 0.5 -var tmax 1 -var speed 4 -var picture no"),
    ("shear_cell", "-var n 8 -var I 0.1 -var start 0.02 -var strain 0.02"),
];

#[test]
#[ignore = "takes minutes: `./check --ranks`"]
fn examples_of_grains_are_shared_out() {
    for (name, args) in EXAMPLES {
        let deck = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/{name}/in.{name}"));
        let words: Vec<&str> = [deck.to_str().unwrap()].into_iter().chain(args.split_whitespace()).collect();
        let left = |more: &[&str]| {
            let folder = tempfile::tempdir().unwrap();
            let o = perigrain(folder.path(), &[&["-in"], &words[..], &["-screen", "none"], more].concat());
            assert!(o.status.success(), "{name}: {}", output_of(&o));
            files(folder.path())
        };
        let alone = left(&["-threads", "1"]);
        for ranks in ["2", "3", "5"] {
            same(&alone, &left(&["-threads", "1", "-ranks", ranks]), &format!("{name} on {ranks} ranks"));
        }
        let folder = tempfile::tempdir().unwrap();
        let ops = measured(folder.path(), &words);
        assert!(!ops.is_empty(), "{name}: nothing is shared out");
        for (op, rows, gathers) in ops {
            let looks = ["reneighbor", "pair "].iter().any(|look| op.starts_with(look));
            assert!(looks || gathers == 0, "{name}: `{op}` needs {rows} rows, {gathers} gathers");
        }
    }
}
