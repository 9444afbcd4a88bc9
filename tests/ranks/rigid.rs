//! Rigid bodies among free grains, shared out to ranks.

use super::{exchanged, files, made, output_of, perigrain, same};
use crate::restart::scenes::SCENES;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Clumps of three, four and five spheres, 243 of each, over free grains, between walls and a floor.
const CLUMPS: &str = "units lj\natom_style sphere\nboundary p f f\nnewton off\ncomm_modify vel yes cutoff 4.0\n\
    fix prop all property/atom mol ghost yes\nregion box block 0 16.2 -1 17.2 -1 26 units box\ncreate_box 1 box\n\
    molecule three 3.mol\nmolecule four 4.mol\nmolecule five 5.mol\n\
    lattice sc 0.171 origin 0.5 0.5 0.5\n\
    region low block INF INF 0 16.2 3.6 8.9 units box\nregion middle block INF INF 0 16.2 9.0 14.3 units box\n\
    region high block INF INF 0 16.2 14.4 19.7 units box\nregion floor block INF INF 0 16.2 0 3.5 units box\n\
    create_atoms 0 region low mol three 77\ncreate_atoms 0 region middle mol four 78\ncreate_atoms 0 region high mol five 79\n\
    group clumps union all\ncreate_atoms 1 region floor\ngroup free subtract all clumps\nset group free diameter 1.4\n\
    set group all density 0.7\nvelocity all create 0.5 77\nvelocity all set NULL NULL -1.0 sum yes units box\n\
    pair_style gran/hooke/history 1000 NULL 10 NULL 0.5 1\npair_coeff * *\n\
    neighbor 0.25 bin\nneigh_modify every 1 delay 0 check yes exclude molecule/intra clumps\ntimestep 0.002\n\
    fix sides all wall/gran hooke/history 1000 NULL 10 NULL 0.5 1 yplane 0 16.2\n\
    fix floor all wall/gran hooke/history 1000 NULL 10 NULL 0.5 1 zplane 0 NULL contacts\n";

/// What moves them.
const MOVES: &str =
    "fix g all gravity 1.0 vector 0.1 0 -1\nfix 1 free nve/sphere\nfix r clumps rigid/small molecule\n";

/// Everything written about them: sums, properties of bodies and the fix's values, dumps of particles and bodies, restart files.
const WRITES: &str = "compute s all stress/atom NULL\ncompute b clumps rigid/local r mass x vy fz tqx omegaz quatw\n\
    compute ke all ke/rigid r\ncompute er all erotate/rigid r\ncompute z all reduce sum c_s[1] c_s[5]\n\
    compute_modify thermo_temp extra/dof -100000\n\
    thermo_style custom step atoms ke press c_ke c_er f_r c_z[*] f_floor[3] f_sides[2]\n\
    thermo_modify norm no lost ignore format float %.15g\nthermo 40\n\
    dump all all custom 50 d.*.txt id x y z vx omegay fx tqz ix c_s[2] f_floor[1]\ndump_modify all format float %.17g\n\
    dump bodies all local 50 b.*.txt c_b[*]\nrestart 70 r.*.restart\n";

/// Molecule files of three, four and five spheres that overlap.
fn molecules(folder: &Path) {
    let places = [[0.0, 0.0, 0.0], [0.4, 0.0, 0.05], [-0.3, 0.3, 0.0], [0.0, -0.35, 0.2], [0.1, 0.2, -0.3]];
    for many in 3..=5 {
        let mut file = format!("# overlapping spheres\n\n{many} atoms\n\nCoords\n\n");
        let lines = |file: &mut String, line: &dyn Fn(usize) -> String| {
            (0..many).for_each(|k| writeln!(file, "{} {}", k + 1, line(k)).unwrap());
        };
        lines(&mut file, &|k| places[k].map(|x| x.to_string()).join(" "));
        file += "\nTypes\n\n";
        lines(&mut file, &|_| "1".to_string());
        file += "\nDiameters\n\n";
        lines(&mut file, &|k| format!("{}", 0.7 + 0.1 * k as f64));
        fs::write(folder.join(format!("{many}.mol")), file).unwrap();
    }
}

/// What a deck of clumps leaves behind.
fn left_by_clumps(deck: &str, words: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    molecules(folder.path());
    fs::write(folder.path().join("in.deck"), deck).unwrap();
    let o = perigrain(folder.path(), &[&["-in", "in.deck", "-screen", "none"], words].concat());
    assert!(o.status.success(), "{words:?}: {}", output_of(&o));
    files(folder.path())
}

/// What quiet steps of a deck of clumps exchange on so many ranks: op, of which rows, how often all rows were handed to all.
fn exchanged_by_clumps(deck: &str, ranks: &str) -> Vec<(String, String, u64)> {
    let folder = tempfile::tempdir().unwrap();
    molecules(folder.path());
    fs::write(folder.path().join("in.deck"), deck).unwrap();
    let o = perigrain(folder.path(), &["plan", "--measure", "-ranks", ranks, "-threads", "1", "in.deck"]);
    assert!(o.status.success(), "{}", output_of(&o));
    exchanged(&output_of(&o))
}

fn same_on_ranks(deck: &str, what: &str, numbers: &[(&str, &str)]) {
    let alone = left_by_clumps(deck, &["-threads", "1"]);
    for (ranks, threads) in numbers {
        let several = left_by_clumps(deck, &["-ranks", ranks, "-threads", threads]);
        same(&alone, &several, &format!("{what} on {ranks} ranks"));
    }
}

/// Runs with everything that is written, and one that continues from a restart file.
#[test]
fn bodies_are_shared_out_with_the_bytes_of_one_process() {
    let again = "clear\nread_restart end.restart\nneigh_modify every 1 delay 0 check yes exclude molecule/intra clumps\n\
        fix prop all property/atom mol ghost yes\n\
        fix sides all wall/gran hooke/history 1000 NULL 10 NULL 0.5 1 yplane 0 16.2\n\
        fix floor all wall/gran hooke/history 1000 NULL 10 NULL 0.5 1 zplane 0 NULL contacts\n";
    let deck = format!(
        "{CLUMPS}{MOVES}{WRITES}run 150\nwrite_restart end.restart\nrun 30\n{again}{MOVES}thermo 25\nrun 40\n\
         write_dump all custom last.txt id x y z vx vy omegaz modify format float %.17g\n"
    );
    same_on_ranks(&deck, "clumps", &[("2", "2"), ("3", "1"), ("5", "1")]);
}

/// Bodies with an array of values, components that are turned off, and gravity at their centres; the largest have particles on all ranks.
#[test]
fn large_bodies_and_small_ones_are_summed_up_in_one_order() {
    let moves = "fix g all gravity 1.0 vector 0.1 0 -1 disable\nfix g2 free gravity 1.0 vector 0.1 0 -1\nfix 1 free nve/sphere\n\
        group lid id 1:2187:9\ngroup rest subtract clumps lid\n\
        fix r rest rigid/nve molecule torque 3*40 off on on force 7 on on off gravity g\nfix l lid rigid group 1 lid gravity g\n";
    let writes = "thermo_style custom step ke press f_r f_r[3][5] f_r[7][7] f_r[40][10] f_l f_l[1][6] f_l[1][12]\n\
        thermo_modify norm no lost ignore format float %.15g\nthermo 30\n\
        dump all all custom 60 d.*.txt id x y z vx omegay fx tqz\ndump_modify all format float %.17g\n";
    let deck = format!("{CLUMPS}{moves}{writes}run 120\nwrite_restart end.restart\n");
    same_on_ranks(&deck, "a lid and clumps", &[("2", "1"), ("3", "2")]);
    is_shared(&exchanged_by_clumps(&format!("{CLUMPS}{moves}thermo 100\nrun 100\n"), "3"));
}

/// Molecules that come during a run become bodies.
#[test]
fn bodies_come_during_a_run() {
    let moves = "fix g all gravity 1.0 vector 0.1 0 -1\nfix 1 free nve/sphere\nfix r clumps rigid/small molecule mol four\n\
        region slot block 2 14 2 14 21 25 units box\n\
        fix rain clumps deposit 5 0 25 4711 region slot near 1.0 mol four rigid r vz -2 -2 units box id next\n";
    let deck = format!("{CLUMPS}{moves}{WRITES}run 140\nwrite_restart end.restart\n");
    same_on_ranks(&deck, "clumps that come", &[("3", "1")]);
}

/// A clump that hits a peridynamic plate is moved by all ranks, which have shares of the plate.
#[test]
fn a_rigid_clump_hits_a_plate_that_is_shared_out() {
    let scene = SCENES.iter().find(|scene| scene.name == "impact").unwrap();
    let few = "set group plate diameter";
    let more =
        "create_atoms 2 single 0.0012 -0.0003 0.0031 units box\ngroup ball type 2\nset group plate diameter";
    let make = made(scene)
        .replace(few, more)
        .replace("set group ball diameter 0.003", "set group ball diameter 0.0027");
    let again = scene
        .again
        .replace("fix 2 ball nve/sphere", "neigh_modify exclude group ball ball\nfix 2 ball rigid single");
    let deck = format!("{make}{again}");
    let writes = "thermo_style custom step time dt ke c_dsum f_2 f_2[1][3] f_2[1][9] f_2[1][12]\n\
        dump all all custom 7 dump.*.txt id type x y z vx vy vz fz\ndump_modify all format float %.17g\n";
    let whole = format!("{deck}{writes}run 60\nwrite_restart end.restart\n");
    let alone = left_by_clumps(&whole, &["-threads", "1"]);
    for (ranks, threads) in [("2", "2"), ("3", "1")] {
        same(&alone, &left_by_clumps(&whole, &["-ranks", ranks, "-threads", threads]), "a clump and a plate");
    }
    let ops = exchanged_by_clumps(&format!("{deck}thermo 30\nrun 60\n"), "3");
    let own = |part: &str| {
        ops.iter().any(|(op, rows, gathers)| op.starts_with(part) && rows != "all" && *gathers == 0)
    };
    assert!(["fix 1 nve", "fix 2 rigid"].into_iter().all(own), "{ops:?}");
}

/// No op but those that search pairs needs rows of all ranks, and bodies are moved by the ranks of their particles.
fn is_shared(ops: &[(String, String, u64)]) {
    let looks = ["reneighbor", "pair gran/hooke/history"];
    for (op, rows, gathers) in ops {
        assert!(*gathers == 0 || looks.iter().any(|look| op.starts_with(look)), "`{op}` needs {rows} rows");
        assert!(*gathers < 30, "`{op}`: {gathers} gathers in 100 steps");
    }
    let bodies = ops.iter().filter(|(op, rows, _)| op.starts_with("fix r rigid") && rows == "asked");
    assert_eq!(bodies.count(), 3, "{ops:?}");
}

#[test]
fn quiet_steps_of_bodies_gather_nothing() {
    // Virials of particles cost nothing in steps that do not print.
    let prints = "compute s all stress/atom NULL\ncompute z all reduce sum c_s[1]\n\
        thermo_style custom step f_r c_z\nthermo 50\nrun 100\n";
    is_shared(&exchanged_by_clumps(&format!("{CLUMPS}{MOVES}{prints}"), "3"));
}
