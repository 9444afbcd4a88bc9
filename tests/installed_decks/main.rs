//! LAMMPS' own decks of peridynamics and of grains, from where Debian's package `lammps-examples` puts them; skipped where it is not installed.

mod grains;

use crate::compare::{Rule, compare, read};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const FOLDER: &str = "/usr/share/lammps/examples";

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

/// The first rows of `in.peri.lps`, `ves` and `eps`, likewise.
const STATE_BASED: [(&str, &str); 3] = [
    (
        "peri/in.peri.lps",
        "\
Step,Temp,E_pair,E_mol,TotEng,Press,Volume
0,0,0,0,0,0,5.0030006e-07
100,1.684629e+24,133446.65,0,255067.11,1.6206343e+11,5.0030006e-07
200,1.1380148e+27,684478.05,0,82842557,9.9178307e+13,5.5225839e-07
300,2.5659218e+27,5944645.9,0,1.9118934e+08,1.6231114e+14,7.6086254e-07
400,2.9916164e+27,13677434,0,2.2965481e+08,1.4081705e+14,1.0224963e-06
500,3.3570343e+27,11130894,0,2.5348933e+08,1.2577633e+14,1.2846002e-06
",
    ),
    (
        "peri/in.peri.ves",
        "\
Step,Temp,E_pair,E_mol,TotEng,Press,Volume
0,0,0,0,0,0,5.0030006e-07
100,8.3392177e+24,247040.57,0,849083.8,8.0224286e+11,5.0030006e-07
200,1.1849022e+27,1158030.5,0,86701105,1.0301578e+14,5.5359205e-07
300,2.6287222e+27,4389155.1,0,1.9416767e+08,1.6636212e+14,7.6050375e-07
400,3.2718778e+27,7458219,0,2.4366885e+08,1.5439709e+14,1.0199269e-06
500,3.8413187e+27,6151611.4,0,2.8347258e+08,1.5008974e+14,1.2318007e-06
",
    ),
    (
        "peri/in.peri.eps",
        "\
Step,Temp,E_pair,E_mol,TotEng,Press,Volume
0,0,0,0,0,0,5.0030006e-07
100,8.3466308e+24,247103.03,0,849681.45,8.0295601e+11,5.0030006e-07
200,1.1784921e+27,1098605.6,0,86178912,1.0246967e+14,5.5353162e-07
300,2.6263212e+27,4118581.6,0,1.9372377e+08,1.662415e+14,7.6036043e-07
400,3.3085888e+27,9397203.3,0,2.4825816e+08,1.561692e+14,1.0196674e-06
500,3.9151799e+27,18408722,0,3.0106204e+08,1.5298661e+14,1.2317127e-06
",
    ),
];

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

/// Runs a deck from its installed place and compares its first rows; eight digits are printed.
fn first_rows(deck: &str, golden: &str) {
    let golden = read(golden);
    let rule = Rule { rtol: 1e-7, ..Rule::default() };
    let Some(path) = installed(deck) else { return };
    let folder = tempfile::tempdir().unwrap();
    let switches = ["-log", "log.deck", "-screen", "none", "-compat", "lammps/2025"];
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

#[test]
fn pmb_decks_give_lammps_first_rows() {
    // The cylinder flies apart; from row 800 on LAMMPS' own sums depend on their order.
    ["peri/in.peri.pmb", "peri/in.peri-pmb"].into_iter().for_each(|deck| first_rows(deck, ROWS));
}

#[test]
fn state_based_decks_give_lammps_first_rows() {
    // Likewise from row 600 on.
    STATE_BASED.into_iter().for_each(|(deck, golden)| first_rows(deck, golden));
}
