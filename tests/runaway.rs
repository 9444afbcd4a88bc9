//! Runs whose energy grows beyond reason, where the deck or LAMMPS lets them continue (`tests/scripts/bad/runaway.in`: they end).

use std::process::Command;

/// A block that breaks into dust in steps three times the longest.
const DECK: &str = "units si\natom_style peri\natom_modify map array\nboundary s s s\nlattice sc 0.001\n\
                    region block block 0 5 0 5 0 5\ncreate_box 1 block\ncreate_atoms 1 region block\n\
                    set group all density 2500\nset group all volume 1e-9\npair_style peri/pmb\n\
                    pair_coeff * * 2e21 0.0030001 0.01 0.0\nvelocity all ramp vx -1 1 x 0 5\n\
                    velocity all ramp vy -1 1 x 0 2\nfix 1 all nve\ntimestep 6e-7\nthermo 50\n";

/// The exit code of the deck with more lines and switches, and the number of warnings that energy has grown.
fn outcome(lines: &str, switches: &[&str]) -> (Option<i32>, usize) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("in.deck"), format!("{DECK}{lines}run 200\n")).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(["-in", "in.deck", "-log", "none", "-threads", "1"])
        .args(switches)
        .current_dir(folder.path())
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
    (output.status.code(), printed.matches("energy has grown beyond reason").count())
}

#[test]
fn decks_choose_what_becomes_of_energy_from_nothing() {
    assert_eq!(outcome("", &[]), (Some(1), 1));
    assert_eq!(outcome("thermo_modify energy warn\n", &[]), (Some(0), 1));
    assert_eq!(outcome("thermo_modify energy ignore\n", &[]), (Some(0), 0));
    assert_eq!(outcome("", &["-compat", "lammps/2025"]), (Some(0), 1));
    assert_eq!(outcome("thermo_modify energy error\n", &["-compat", "lammps/2025"]), (Some(1), 1));
    // With a right step there is no warning.
    assert_eq!(outcome("timestep 1.7e-7\n", &[]), (Some(0), 0));
}
