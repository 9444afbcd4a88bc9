//! LAMMPS' own peridynamics decks, from where Debian's package `lammps-examples` puts them; skipped where it is not installed.
#![allow(clippy::unwrap_used)] // a test fails by panicking

#[path = "common/compare.rs"]
mod compare;

use compare::{Rule, compare, read};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const FOLDER: &str = "/usr/share/lammps/examples/peri";

/// The first rows of `in.peri.pmb` as LAMMPS 22Jul2025 (update 4) prints them.
const ROWS: &str = "\
Step,Temp,E_pair,E_mol,TotEng,Press,Volume
0,0,0,0,0,0,5.0030006e-07
100,1.7890585e+24,552721.8,0,681881.47,1.7210968e+11,5.0030006e-07
200,1.3549879e+27,3097027.6,0,1.0091931e+08,1.1829272e+14,5.5130066e-07
300,3.3009625e+27,6331254.8,0,2.4464163e+08,1.9647265e+14,8.0862953e-07
400,3.815184e+27,6225081.7,0,2.8165928e+08,1.8189267e+14,1.0095118e-06
500,4.2580877e+27,20212686,0,3.2762196e+08,1.6249923e+14,1.2611723e-06
600,5.5126512e+27,30861342,0,4.2884284e+08,1.7320038e+14,1.531873e-06
700,1.1807414e+28,23119941,0,8.7554687e+08,2.9477434e+14,1.9278632e-06
";

fn installed(deck: &str) -> Option<PathBuf> {
    let path = Path::new(FOLDER).join(deck);
    if !path.is_file() {
        println!("skipped: {} is not there (Debian's package lammps-examples)", path.display());
        return None;
    }
    Some(path)
}

fn perigrain(args: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_perigrain")).current_dir(folder).args(args).output().unwrap()
}

#[test]
fn pmb_decks_give_lammps_first_rows() {
    let golden = read(ROWS);
    // Eight digits are printed. The cylinder flies apart; from row 800 on LAMMPS' own sums depend on their order.
    let rule = Rule { rtol: 1e-7, ..Rule::default() };
    for deck in ["in.peri.pmb", "in.peri-pmb"] {
        let Some(path) = installed(deck) else { continue };
        let folder = tempfile::tempdir().unwrap();
        let switches = ["-log", "log.deck", "-screen", "none", "-compat", "lammps"];
        let done = perigrain(&[&["-in", path.to_str().unwrap()], &switches[..]].concat(), folder.path());
        assert!(done.status.success(), "{deck}: {}", String::from_utf8_lossy(&done.stderr));
        let mut rows = read(&fs::read_to_string(folder.path().join("log.deck")).unwrap());
        assert_eq!(rows.len(), 11, "{deck}");
        rows.truncate(golden.len());
        for row in &mut rows {
            row.remove("run");
        }
        compare(&rows, &golden, &rule).unwrap_or_else(|report| panic!("{deck}:\n{report}"));
    }
}

#[test]
fn state_based_decks_are_refused_by_the_name_of_their_style() {
    for style in ["lps", "ves", "eps"] {
        let Some(path) = installed(&format!("in.peri.{style}")) else { continue };
        let folder = tempfile::tempdir().unwrap();
        let done = perigrain(&["check", path.to_str().unwrap()], folder.path());
        let said = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(1), "{said}");
        assert_eq!(said.matches("error[").count(), 1, "{said}");
        assert!(said.contains(&format!("pair style `peri/{style}` is LAMMPS'")), "{said}");
    }
}
