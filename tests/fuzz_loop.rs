//! The bodies of the fuzz targets on stable: a corpus, mutated at random for a while. Nothing may panic.
//!
//! `PERIGRAIN_FUZZ_SECONDS=300 cargo test --release --test suite fuzz_loop::` takes that long for each target; by itself one second.
//! What panics is left in the system's folder for temporary files, named in the report.

#[path = "../fuzz/src/lib.rs"]
pub mod bodies;

use crate::random::Random;
use std::fs;
use std::panic::catch_unwind;
use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

/// Pieces that readers stumble over sooner than over random bytes.
const PIECES: [&str; 40] = [
    "0",
    "-1",
    "1e308",
    "-1e-320",
    "nan",
    "inf",
    "4294967296",
    "9223372036854775807",
    "1*",
    "*",
    "NULL",
    "${",
    "$(",
    "v_x",
    "c_1[2]",
    "f_1",
    "\"",
    "\"\"\"",
    "&\n",
    "#",
    "\n",
    "\n\n",
    " ",
    "\t",
    "[",
    "]",
    "(",
    ")",
    "^",
    "%",
    "/",
    "units lattice",
    "all",
    "Atoms",
    "ITEM: ",
    "yes",
    "\u{fc}",
    "\0",
    "..",
    "--",
];

/// A neighbour of a case: some pieces inserted, cut, doubled, exchanged with another case, some bits turned.
fn mutate(case: &[u8], other: &[u8], r: &mut Random) -> Vec<u8> {
    let mut new = case.to_vec();
    for _ in 0..=r.below(4) {
        let at = r.below(new.len() + 1);
        let end = (at + r.below(20)).min(new.len());
        match r.below(7) {
            0 => drop(new.splice(at..at, PIECES[r.below(PIECES.len())].bytes())),
            1 => drop(new.splice(at..end, PIECES[r.below(PIECES.len())].bytes())),
            2 => drop(new.drain(at..end)),
            3 => {
                let piece = new[at..end].to_vec();
                drop(new.splice(at..at, piece));
            }
            4 if at < new.len() => new[at] ^= 1 << r.below(8),
            5 if !other.is_empty() => {
                let from = r.below(other.len());
                let to = (from + r.below(60)).min(other.len());
                drop(new.splice(at..end, other[from..to].iter().copied()));
            }
            _ => new.truncate(new.len() - r.below(new.len().min(30) + 1)),
        }
    }
    new
}

/// Runs mutated cases until the time is over.
fn hunt(name: &str, corpus: &[Vec<u8>], body: fn(&[u8])) {
    let seconds: f64 =
        std::env::var("PERIGRAIN_FUZZ_SECONDS").ok().and_then(|s| s.parse().ok()).unwrap_or(1.0);
    let seed = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap().as_nanos() as u64;
    let (mut r, begin, mut count, mut slowest) = (Random(seed), Instant::now(), 0_u64, Duration::ZERO);
    assert!(!corpus.is_empty(), "{name}: no corpus");
    while begin.elapsed().as_secs_f64() < seconds {
        let (a, b) = (r.below(corpus.len()), r.below(corpus.len()));
        let case = mutate(&corpus[a], &corpus[b], &mut r);
        let start = Instant::now();
        let outcome = catch_unwind(|| body(&case));
        slowest = slowest.max(start.elapsed());
        count += 1;
        if outcome.is_err() {
            let path = std::env::temp_dir().join(format!("perigrain_fuzz_{name}_{seed}"));
            fs::write(&path, &case).unwrap();
            panic!("{name}: case {count} of seed {seed} panics: {}", path.display());
        }
    }
    println!("{name}: {count} cases without a panic, the slowest {slowest:?} (seed {seed})");
}

fn here(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn as_text(body: fn(&str), bytes: &[u8]) {
    if let Ok(text) = std::str::from_utf8(bytes) {
        body(text);
    }
}

/// The blocks of all small decks.
fn decks() -> Vec<String> {
    let scene = fs::read_to_string(here("tests/scripts/scene.in")).unwrap();
    let mut all = vec![];
    for folder in ["tests/scripts/good", "tests/scripts/bad"] {
        let mut files: Vec<_> = fs::read_dir(here(folder)).unwrap().map(|e| e.unwrap().path()).collect();
        files.sort();
        for file in files {
            let text = fs::read_to_string(file).unwrap();
            all.extend(text.split("\n--- ").map(|block| block.replace("@scene", &scene)));
        }
    }
    all
}

#[test]
fn lexer() {
    let corpus: Vec<Vec<u8>> = decks().into_iter().map(String::into_bytes).collect();
    hunt("lexer", &corpus, |b| as_text(bodies::lexer, b));
}

#[test]
fn expression() {
    let formula =
        |line: &str| line.split_once(" equal ").map(|(_, f)| f.trim().trim_matches('"').as_bytes().to_vec());
    let corpus: Vec<Vec<u8>> =
        decks().iter().flat_map(|d| d.lines().filter_map(formula).collect::<Vec<_>>()).collect();
    hunt("expression", &corpus, |b| as_text(bodies::expression, b));
}

#[test]
fn read_data() {
    let names = ["data.peri", "data.sphere", "data.hybrid"];
    let mut corpus = vec![];
    for (k, style) in [(2_u8, names[0]), (1, names[1]), (3, names[2])] {
        let text = fs::read_to_string(here("tests/lammps/decks").join(style)).unwrap();
        // Short files: each case costs what it takes to read.
        let short: Vec<&str> = text.lines().take(60).collect();
        corpus.push([&[k][..], short.join("\n").as_bytes()].concat());
    }
    for style in 0..4_u8 {
        let text = "a file\n\n2 atoms\n1 atom types\n0 2 xlo xhi\n0 2 ylo yhi\n0 2 zlo zhi\n\nMasses\n\n1 1.5\n\nAtoms\n\n\
                    1 1 0.5 0.5 0.5\n2 1 1.5 0.5 0.5 0 0 1\n\nVelocities\n\n1 0 0 1\n2 0 1 0\n";
        corpus.push([&[style][..], text.as_bytes()].concat());
    }
    hunt("read_data", &corpus, bodies::read_data);
}

#[test]
fn read_dump() {
    let text = "ITEM: TIMESTEP\n5\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 2\n0 2\n0 2\n\
                ITEM: ATOMS id type x y z vx ix\n1 1 0.5 0.5 0.5 1 0\n2 1 1.5 0.5 0.5 1 -1\n";
    let twice = format!("{text}{}", text.replacen('5', "7", 1));
    let corpus = [0_u8, 1].map(|k| [&[k][..], twice.as_bytes()].concat());
    hunt("read_dump", &corpus, bodies::read_dump);
}

#[test]
fn read_surface() {
    let mut corpus = vec![];
    for file in fs::read_dir(here("tests/meshes")).unwrap().map(|e| e.unwrap().path()) {
        let obj = u8::from(file.extension().is_some_and(|e| e == "obj"));
        corpus.push([&[obj][..], &fs::read(file).unwrap()].concat());
    }
    corpus.sort();
    hunt("read_surface", &corpus, bodies::read_surface);
}

#[test]
fn read_body() {
    let image = "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 2 0 2 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\
                 <Piece Extent=\"0 2 0 2 0 1\"><CellData><DataArray type=\"UInt8\" Name=\"g\" format=\"ascii\">5 6 7 8</DataArray>\
                 </CellData></Piece></ImageData></VTKFile>";
    let mut corpus = vec![
        [&[4][..], b"x,y,z,Vol,type,diameter\n0,0,0,1,1,1\n1,0,0.5,2,2,0.5\n"].concat(),
        [&[6][..], image.as_bytes()].concat(),
    ];
    for (kind, name) in [
        (0_u8, "tets.vtk"),
        (0, "hexes.vtk"),
        (0, "hexes_text.vtk"),
        (1, "hexes.vtu"),
        (1, "hexes_text.vtu"),
        (2, "hexes_22.msh"),
        (2, "gmsh_41.msh"),
        (3, "hexes.inp"),
        (5, "raw8.nrrd"),
        (5, "big16.nrrd"),
        (7, "ct_5.png"),
        (7, "bits.png"),
        (8, "big.tiff"),
    ] {
        let bytes = fs::read(here("tests/geometry/files").join(name)).unwrap();
        corpus.push([&[kind][..], &bytes].concat());
    }
    hunt("read_body", &corpus, bodies::read_body);
}

#[test]
fn read_restart() {
    let folder = tempfile::tempdir().unwrap();
    let mut corpus = vec![];
    for (k, scene) in [
        "atom_style sphere\nregion b block 0 2 0 2 0 2\ncreate_box 1 b\ncreate_atoms 1 single 0.5 0.5 0.5\nset group all diameter 0.5 density 1",
        "units si\nboundary f f f\natom_style peri\nlattice sc 0.001\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\ncreate_atoms 1 box\n\
         set group all density 2500 volume 1e-9\npair_style peri/pmb\npair_coeff * * 2e21 0.0015001 0.004 0\nfix 1 all nve\nrun 1",
    ]
    .iter()
    .enumerate()
    {
        let path = folder.path().join(format!("{k}.restart"));
        let deck = format!("{scene}\nwrite_restart {}\n", path.display());
        bodies::execute(&deck, perigrain::session::Mode::Run, folder.path());
        corpus.push(fs::read(&path).unwrap());
    }
    hunt("read_restart", &corpus, bodies::read_restart);
}

/// Forged restart files of all scenes: a few of each from one fixed seed, and more for `PERIGRAIN_FUZZ_SECONDS`.
#[test]
fn forged_restart() {
    let seconds: Option<f64> = std::env::var("PERIGRAIN_FUZZ_SECONDS").ok().and_then(|s| s.parse().ok());
    let seed = std::env::var("PERIGRAIN_FUZZ_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(4711);
    let (mut r, begin, mut count, mut slowest) = (Random(seed), Instant::now(), 0_u64, (Duration::ZERO, 0));
    while seconds.map_or(count < FORGED, |s| begin.elapsed().as_secs_f64() < s) {
        let recipe: Vec<u8> = (0..1 + 6 * (1 + r.below(3))).map(|_| r.next() as u8).collect();
        let start = Instant::now();
        let outcome = catch_unwind(|| bodies::forged_restart(&recipe));
        let took = start.elapsed();
        if count > 8 && took > slowest.0 {
            slowest = (took, count);
        }
        if took > SLOW {
            eprintln!("case {count} of seed {seed} takes {took:?}: recipe {recipe:?}");
        }
        if outcome.is_err() {
            panic!("case {count} of seed {seed} panics: recipe {recipe:?}");
        }
        count += 1;
    }
    println!("forged_restart: {count} cases without a panic, the slowest {slowest:?} (seed {seed})");
}

/// So many in the ordinary tests.
const FORGED: u64 = 2000;

/// Slower cases are reported: cases take less than a thousandth of that.
const SLOW: Duration = Duration::from_secs(1);
