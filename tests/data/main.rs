//! Data files: mistakes are shown where they stand in the file, numbers survive the way through a file to the last bit.

use perigrain::diag::{Diagnostics, FileId};
use perigrain::session::{Mode, Options, Session};
use perigrain::world::World;
use proptest::prelude::*;
use std::fs;
use std::io::Write;
use std::path::Path;

/// A small file of three atoms, valid for `atom_style atomic`.
const GOOD: &str = "\
title

3 atoms
1 atom types

0 2 xlo xhi
0 2 ylo yhi
0 2 zlo zhi

Masses

1 1.5

Atoms # atomic

1 1 0 0 0
2 1 1 1 1 1 0 -2
3 1 1.5 1.5 7.5

Velocities

1 1 2 3
3 4 5 6
2 0 0 1e-3
";

/// The world after a deck, or what was refused; `DIR` stands for the folder.
fn outcome(folder: &Path, deck: &str, mode: Mode) -> (Session, Result<(), Diagnostics>) {
    let options = Options { folder: folder.to_path_buf(), mode, ..Options::default() };
    let mut session = Session::new(options).unwrap();
    let deck = deck.replace("DIR", folder.to_str().unwrap());
    let outcome = session.run_text("in.deck", &deck).map(drop);
    (session, outcome)
}

fn world(folder: &Path, deck: &str) -> World {
    let (session, outcome) = outcome(folder, deck, Mode::Run);
    outcome.unwrap_or_else(|e| panic!("{deck}: {e}"));
    session.world
}

/// Reads `text` as a data file of a deck and returns the refusal: line and column in the file, message.
fn refused(before: &str, text: &str, mode: Mode) -> (usize, usize, String) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("x.data"), text).unwrap();
    let deck = format!("units si\nboundary f s p\n{before}\nread_data x.data\n");
    let (session, outcome) = outcome(folder.path(), &deck, mode);
    let d = outcome.expect_err(text).0.remove(0);
    let span = d.span.unwrap();
    let (line, column) = session.sources.place(span);
    assert!(span.file != FileId::BROUGHT);
    let in_file = session.sources.get(span.file).unwrap().name.ends_with("x.data");
    (if in_file { line } else { 0 }, column, d.message)
}

#[test]
fn mistakes_are_shown_in_the_file() {
    let with = |from: &str, to: &str| {
        assert!(GOOD.contains(from), "{from}");
        GOOD.replacen(from, to, 1)
    };
    let atom = "\n1 1 0 0 0\n";
    let cases: Vec<(String, usize, usize, &str)> = vec![
        (with("# atomic", "# sphere"), 14, 1, "of atom_style sphere"),
        (with("3 atoms", "4 atoms"), 14, 1, "has 3 lines, the header promises 4"),
        (with("3 atoms", "2 atoms"), 18, 1, "more lines than the header promises"),
        (with("3 atoms", "three atoms"), 3, 1, "no section"),
        (with("3 atoms", "3 atomz"), 3, 1, "`atomz` is no header line"),
        (with("3 atoms", "-3 atoms"), 3, 1, "there cannot be -3 atoms"),
        (with("1 atom types", "1 atom types\n1 bonds"), 5, 1, "particles of atom_style atomic have no bonds"),
        (with("0 2 zlo zhi", "0 2 zlo zhi\n0 0 xy xz yz"), 9, 1, "takes three tilts"),
        (with("0 2 zlo zhi", "0 2 zlo zhi\n0 0 0 avec"), 9, 1, "a general triclinic box"),
        (with("0 2 xlo xhi", "2 2 xlo xhi"), 6, 1, "must lie above"),
        (with("0 2 xlo xhi", "0 two xlo xhi"), 6, 1, "no header line"),
        (with("0 2 xlo xhi", "2 xlo xhi"), 6, 1, "two numbers"),
        (with("1 1.5", "1 0.0"), 12, 3, "must be greater than zero"),
        (with("1 1.5", "2 1.5"), 12, 1, "there are types 1 to 1"),
        (with("1 1.5\n\n", ""), 10, 1, "the section Masses has 0 lines"),
        (with(atom, "\n1 1 0 0\n"), 16, 1, "this line has 4 columns"),
        (with(atom, "\n1 1 0 0 0 0\n"), 16, 1, "this line has 6 columns"),
        (with(atom, "\n1 2 0 0 0\n"), 16, 3, "there are types 1 to 1, not 2"),
        (with(atom, "\n1 Si 0 0 0\n"), 16, 3, "the type label `Si` is not in perigrain"),
        (with(atom, "\n0 1 0 0 0\n"), 16, 1, "ids go from 1"),
        (with(atom, "\n1 1 0 0.0.1 0\n"), 16, 7, "y must be a number, not `0.0.1`"),
        (with(atom, "\n1 1 nan 0 0\n"), 16, 5, "x must be a number, not `nan`"),
        (with(atom, "\n1 1 2 0 0\n"), 16, 5, "particle 1 lies outside the box: x = 2"),
        (with(atom, "\n1 1 0 2.1 0\n"), 16, 7, "particle 1 lies outside the box: y = 2.1"),
        (with(atom, "\n1 1 0 0 0 0 0 1000\n"), 16, 15, "the image flag 1000"),
        (with(atom, "\n2 1 0 0 0\n"), 17, 1, "a second particle 2"),
        (with("1 1 2 3", "1 1 2"), 22, 1, "an id and 3 numbers are needed here, not an id and 2"),
        (with("1 1 2 3", "7 1 2 3"), 22, 1, "the section Atoms has no particle 7"),
        (with("1 1 2 3\n", ""), 20, 1, "the section Velocities has 2 lines"),
        (format!("{GOOD}\nFoo Bars\n\n1\n"), 26, 1, "`Foo Bars` is no section"),
        (format!("{GOOD}\nBonds\n\n1 1 1 2\n"), 28, 1, "more lines than the header promises"),
        (format!("{GOOD}\nAtoms\n\n1 1 0 0 0\n"), 26, 1, "a second section Atoms"),
        (format!("{GOOD}\nPair Coeffs\n\n1 1 2\n"), 28, 1, "before any pair_style"),
        (GOOD.split("Atoms").next().unwrap().into(), 3, 1, "there is no section Atoms"),
        (with("Atoms # atomic\n\n", "Atoms # atomic\n"), 15, 1, "must be blank"),
        (with("Velocities", "Velocites"), 20, 1, "`Velocites` is no section"),
    ];
    for (text, line, column, message) in cases {
        for mode in [Mode::Run, Mode::Check] {
            let (l, c, m) = refused("", &text, mode);
            assert!(m.contains(message), "wanted {message:?}, got {m:?}");
            assert_eq!((l, c), (line, column), "{m} ({mode:?})");
        }
    }
}

/// The columns of a hybrid stand in the order of its styles: read in another, a radius would be a molecule's number.
#[test]
fn the_styles_of_a_hybrid_are_named_in_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let made = "region b block 0 1 0 1 0 1\ncreate_box 1 b\ncreate_atoms 1 single 0.5 0.5 0.5\n";
    let head = "units si\nboundary f s p\n";
    world(folder.path(), &format!("{head}atom_style hybrid sphere bond\n{made}write_data DIR/x.data"));
    let text = fs::read_to_string(folder.path().join("x.data")).unwrap();
    assert!(text.contains("\nAtoms # hybrid sphere bond\n"), "{text}");
    let (line, _, message) = refused("atom_style hybrid bond sphere", &text, Mode::Run);
    assert!(
        line > 0 && message.contains("of atom_style hybrid sphere bond, those of the deck of"),
        "{message}"
    );
    // as LAMMPS writes it
    fs::write(folder.path().join("x.data"), text.replace("# hybrid sphere bond", "# hybrid")).unwrap();
    world(folder.path(), &format!("{head}atom_style hybrid sphere bond\nread_data DIR/x.data"));
}

#[test]
fn styles_of_their_own_masses() {
    let sphere = GOOD.replace("# atomic", "# sphere");
    assert_eq!(refused("atom_style sphere", &sphere, Mode::Run).0, 12);
    let sphere = sphere.replace("Masses\n\n1 1.5\n\n", "");
    let (line, _, message) = refused("atom_style sphere", &sphere, Mode::Run);
    assert_eq!(line, 12);
    assert!(
        message.contains("this line has 5 columns; atom_style sphere has 7 (id type diameter density x y z)")
    );
    let sphere = sphere.replace("1 1 0 0 0\n", "1 1 0.5 0 0 0 0\n");
    assert_eq!(refused("atom_style sphere", &sphere, Mode::Run).1, 9);
}

#[test]
fn a_file_that_is_not_there_or_no_text() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bytes"), [0xff, 0xfe, 0x00]).unwrap();
    fs::write(folder.path().join("x.gz"), "no gzip").unwrap();
    for name in ["none.data", "bytes", "x.gz"] {
        let (_, outcome) = outcome(folder.path(), &format!("read_data {name}"), Mode::Run);
        assert!(outcome.unwrap_err().0[0].message.contains("cannot be read"), "{name}");
    }
}

#[test]
fn a_packed_file_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("x.data"), GOOD).unwrap();
    let file = fs::File::create(folder.path().join("x.data.gz")).unwrap();
    let mut packed = flate2::write::GzEncoder::new(file, flate2::Compression::default());
    packed.write_all(GOOD.as_bytes()).unwrap();
    packed.finish().unwrap();
    let plain = world(folder.path(), "boundary p s p\nread_data x.data");
    let packed = world(folder.path(), "boundary p s p\nread_data x.data.gz");
    assert_eq!(plain.particles.x, packed.particles.x);
    // Calculated by hand: 7.5 in a periodic edge 0 … 2 is 1.5 three boxes further.
    assert_eq!(plain.particles.x[2], [1.5, 1.5, 1.5]);
    assert_eq!([0, 1, 2].map(|i| plain.particles.image[i]), [[0; 3], [1, 0, -2], [0, 0, 3]]);
    assert_eq!(plain.particles.v, [[1.0, 2.0, 3.0], [0.0, 0.0, 1e-3], [4.0, 5.0, 6.0]]);
    assert_eq!(plain.type_mass, [Some(1.5)]);
    // As in LAMMPS: 1e-4 of the edge beyond the outermost particles.
    let domain = plain.domain.into_inner().unwrap();
    assert_eq!((domain.lo[1], domain.hi[1]), (-0.0002, 1.5002));
}

#[test]
fn more_particles_into_a_box() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("x.data"), GOOD).unwrap();
    // Oracle: LAMMPS makes of the same lines ids 1 2 3 4 5 6 101 102 103 in a box to 5.
    let w = world(
        folder.path(),
        "boundary f p p\nread_data x.data extra/atom/types 2\nread_data x.data add append shift 3 0 0 group new offset 1 0 0 0 0\n\
         read_data x.data add 100",
    );
    assert_eq!(w.particles.tag, [1, 2, 3, 4, 5, 6, 101, 102, 103]);
    assert_eq!(w.particles.kind[3..6], [2, 2, 2]);
    assert_eq!(w.particles.x[3], [3.0, 0.0, 0.0]);
    assert_eq!((w.types, w.type_mass.to_vec()), (3, vec![Some(1.5), Some(1.5), None]));
    let domain = w.domain.as_ref().unwrap();
    assert_eq!((domain.lo[0], domain.hi[0]), (0.0, 5.0));
    let bit = w.groups.find("new").unwrap().bit();
    assert_eq!(w.particles.mask.iter().filter(|m| **m & bit != 0).count(), 3);
    let (session, outcome) =
        outcome(folder.path(), "read_data x.data\nread_data x.data add merge", Mode::Run);
    let d = outcome.unwrap_err().0.remove(0);
    assert!(d.message.contains("a particle 1 already"), "{}", d.message);
    assert_eq!(session.world.n(), 3);
}

/// Scenes of every atom style with awkward numbers.
fn scenes() -> Vec<(&'static str, String)> {
    let fill = "lattice sc 0.5\nregion b block 0 2 0 1.1 0 1.1\ncreate_box 2 b\ncreate_atoms 1 region b\n\
                variable u atom 0.1*sin(7*x+3*y+z)\nvelocity all set v_u v_u 0.3 units box\n\
                displace_atoms all random 0.01 0.01 0 77 units box\n";
    let own = "variable d atom 0.3+0.01*sin(9*x+y)\nset group all density v_d\n";
    let wide =
        "set group all diameter v_d\nset group all density v_d\nset atom 1*3 omega 1 2 3.3333333333333333\n";
    vec![
        ("atomic", format!("{fill}mass * 1.1\n")),
        ("peri", format!("{fill}{own}set group all volume v_d\n")),
        ("sphere", format!("{fill}{own}{wide}")),
        ("hybrid sphere peri", format!("{fill}{own}{wide}set group all volume v_d\nset atom 4 diameter 0\n")),
        ("hybrid peri sphere", format!("{fill}{own}{wide}")),
        ("hybrid sphere", format!("{fill}{own}{wide}")),
    ]
}

#[test]
fn numbers_survive_a_file_to_the_last_bit() {
    for (style, scene) in scenes() {
        let folder = tempfile::tempdir().unwrap();
        let head = format!("units si\nboundary p p f\natom_style {style}\n");
        let before = world(folder.path(), &format!("{head}{scene}write_data DIR/x.data"));
        let after = world(folder.path(), &format!("{head}read_data DIR/x.data\nwrite_data DIR/y.data"));
        let (a, b) = (&before.particles, &after.particles);
        assert_eq!((&*a.tag, &*a.kind, &*a.image), (&*b.tag, &*b.kind, &*b.image), "{style}");
        assert_eq!((&a.x, &a.v, &a.omega), (&b.x, &b.v, &b.omega), "{style}");
        assert_eq!((&a.mass, &a.radius, &a.volume), (&b.mass, &b.radius, &b.volume), "{style}");
        assert_eq!(before.domain.as_ref().unwrap().hi, after.domain.as_ref().unwrap().hi);
        let text = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
        assert_eq!(text("x.data"), text("y.data"), "{style}");
    }
}

/// What LAMMPS 22Jul2025 writes of three spheres with the properties of `OWN`, velocities left out.
const WITH_PROPERTIES: &str = "\
LAMMPS data file via write_data, version 22 Jul 2025, timestep = 0, units = si

3 atoms
1 atom types

0 4 xlo xhi
0 4 ylo yhi
0 4 zlo zhi

Atoms # sphere

1 1 0.1 100 1 1 1 0 0 0
2 1 0.1 100 3 1 1 0 0 0
3 1 0.1 100 3 2 1 0 0 0

p # i_a d_b i_c d_d mol

1 0 333333.3333333334 0 0 -2.5 0 0 0
2 3 0.1 0 7 0 0 1e-300 5
3 0 0 0 0 0 0 0 0

q # temperature heatflow

1 0 0
2 300.125 0
3 0 0
";

const OWN: &str = "atom_style sphere\nfix p all property/atom i_a d_b i2_c 2 d2_d 3 mol\n\
    fix q all property/atom temperature heatflow\nfix r all property/atom d_z writedata no\n";

/// The property of the particles by id, as the deck's `words`.
fn property(w: &World, words: &str) -> Vec<f64> {
    let column = w.columns.get_scalar(w.columns.custom(words).unwrap()).unwrap();
    let mut rows: Vec<(u32, f64)> = w.particles.tag.iter().copied().zip(column.iter().copied()).collect();
    rows.sort_by_key(|r| r.0);
    rows.into_iter().map(|r| r.1).collect()
}

#[test]
fn properties_of_fixes_come_from_lammps_files_and_survive_ours() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("x.data"), WITH_PROPERTIES).unwrap();
    let read = "read_data DIR/x.data fix p NULL NULL fix q NULL q";
    let again = "read_data DIR/y.data add append fix q NULL q fix p NULL p";
    let deck = format!(
        "units si\nboundary f f f\n{OWN}{read}\nwrite_data DIR/y.data\n{again}\nset atom 5 d_b 7.5\n\
                        write_data DIR/z.data nofix\n"
    );
    let w = world(folder.path(), &deck);
    assert_eq!(property(&w, "i_a"), [0.0, 3.0, 0.0, 0.0, 3.0, 0.0]);
    assert_eq!(property(&w, "d_b"), [333333.3333333334, 0.1, 0.0, 333333.3333333334, 7.5, 0.0]);
    assert_eq!(property(&w, "i2_c[2]"), [0.0, 7.0, 0.0, 0.0, 7.0, 0.0]);
    assert_eq!(property(&w, "d2_d[1]"), [-2.5, 0.0, 0.0, -2.5, 0.0, 0.0]);
    assert_eq!(property(&w, "d2_d[3]"), [0.0, 1e-300, 0.0, 0.0, 1e-300, 0.0]);
    assert_eq!(property(&w, "temperature"), [0.0, 300.125, 0.0, 0.0, 300.125, 0.0]);
    assert_eq!(w.particles.molecule, [0, 5, 0, 0, 5, 0]);
    let sections = |text: &str| text.split_once("\np #").map(|(_, rest)| rest.to_string());
    let text = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    // Headings, order and, but for the last digit of a number, bytes as LAMMPS writes them.
    assert_eq!(sections(&text("y.data")), sections(WITH_PROPERTIES));
    assert_eq!(sections(&text("z.data")), None);
}

#[test]
fn mistakes_in_sections_of_fixes_are_shown_in_the_file() {
    let with = |from: &str, to: &str| WITH_PROPERTIES.replacen(from, to, 1);
    let cases = [
        (with("3 0 0\n", "7 0 0\n"), 26, 1, "the section Atoms has no particle 7"),
        (
            with("3 0 0\n", "3 0\n"),
            26,
            1,
            "an id and 2 values are needed here (temperature heatflow), not an id and 1",
        ),
        (with("3 0 0\n", ""), 22, 1, "the section q has 2 lines, the header promises 3"),
        (with("2 3 0.1", "2 3.5 0.1"), 19, 3, "i_a must be a whole number"),
        (with("-2.5 0 0 0", "-2.5 0 0 -1"), 18, 36, "molecules go from 0"),
        (with("q #", "r #"), 22, 1, "`r` is no section"),
    ];
    for (text, line, column, message) in cases {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("x.data"), &text).unwrap();
        let deck = format!("units si\nboundary f f f\n{OWN}read_data DIR/x.data fix p NULL p fix q NULL q\n");
        let (session, outcome) = outcome(folder.path(), &deck, Mode::Run);
        let d = outcome.expect_err(message).0.remove(0);
        assert!(d.message.contains(message), "wanted {message:?}, got {:?}", d.message);
        assert_eq!(session.sources.place(d.span.unwrap()), (line, column), "{message}");
    }
    for (line, message) in [
        ("fix z NULL p", "there is no fix `z`"),
        ("fix p NULL Velocities", "a section of data files by itself"),
        ("fix p NULL", "is missing"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("x.data"), WITH_PROPERTIES).unwrap();
        let deck = format!("boundary f f f\n{OWN}read_data DIR/x.data {line}\n");
        let (_, outcome) = outcome(folder.path(), &deck, Mode::Run);
        let d = outcome.expect_err(message).0.remove(0);
        assert!(d.message.contains(message), "wanted {message:?}, got {:?}", d.message);
    }
}

#[test]
fn a_checked_deck_knows_files_it_would_write() {
    let folder = tempfile::tempdir().unwrap();
    let deck = "atom_style peri\nregion b block 0 2 0 2 0 2\ncreate_box 2 b\nwrite_data x.data\nclear\n\
                atom_style peri\nread_data x.data\nset type 2 volume 1.0\n\
                print \"\"\"t\n\n0 atoms\n1 atom types\"\"\" file y.data\nclear\nread_data y.data\nmass 2 1.0\n";
    let (_, outcome) = outcome(folder.path(), deck, Mode::Check);
    let problems = outcome.unwrap_err();
    assert_eq!(problems.0.len(), 1, "{problems}");
    assert!(problems.0[0].message.contains("from 1 to 1"), "{problems}");
}

#[test]
fn a_dump_that_ends_within_a_face_of_the_box_is_refused_there() {
    let folder = tempfile::tempdir().unwrap();
    let text = "ITEM: TIMESTEP\n3\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp ff pp\n0 1\n0 1\n0\n";
    fs::write(folder.path().join("d.txt"), text).unwrap();
    let deck = "region b block 0 2 0 2 0 2\ncreate_box 1 b\nmass 1 1\nread_dump DIR/d.txt 3 x y z add yes\n";
    let problems = outcome(folder.path(), deck, Mode::Run).1.unwrap_err();
    assert!(problems.0[0].message.contains("the upper face must be a number"), "{problems}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Whatever stands in the file: an answer, never a panic; what is refused leaves no particles behind.
    #[test]
    fn no_file_makes_it_panic(
        cut in 0usize..400, at in 0usize..300, bytes in "\\PC{0,20}", lines in proptest::collection::vec("[ -~]{0,30}", 0..6),
        style in 0usize..4,
    ) {
        let mut text = GOOD.to_string();
        text.truncate(cut.max(at).min(text.len()));
        if text.is_char_boundary(at.min(text.len())) {
            text.insert_str(at.min(text.len()), &bytes);
        }
        let text = format!("{text}\n{}", lines.join("\n"));
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("x.data"), text).unwrap();
        let style = ["atomic", "sphere", "peri", "hybrid sphere peri"][style];
        let (session, outcome) = outcome(folder.path(), &format!("atom_style {style}\nread_data x.data\n"), Mode::Run);
        prop_assert!(outcome.is_ok() || session.world.n() == 0);
    }

    /// Dumps cut, joined and changed anywhere: an answer, never a panic.
    #[test]
    fn no_dump_makes_it_panic(cut in 0usize..400, at in 0usize..400, bytes in "\\PC{0,12}", rerun in any::<bool>()) {
        const DUMP: &str = "ITEM: TIMESTEP\n5\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp ff pp\n0 1\n0 1\n0 1\n\
            ITEM: ATOMS id type xs y zu vx ix\n1 1 0.5 0.5 3.5 1 0\n2 1 0.1 0.2 0.3 0 1\n";
        let mut text = DUMP.repeat(2).replacen("TIMESTEP\n5", "TIMESTEP\n3", 1);
        text.truncate(cut.max(at).min(text.len()));
        text.insert_str(at.min(text.len()), &bytes);
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("d.txt"), text).unwrap();
        let fields = "x y z vx ix";
        let line = match rerun {
            true => format!("rerun DIR/d.txt dump {fields} trim yes add keep"),
            false => format!("read_dump DIR/d.txt 5 {fields} add yes"),
        };
        let deck = format!("region b block 0 2 0 2 0 2\ncreate_box 1 b\ncreate_atoms 1 single 0.5 0.5 0.5\nmass 1 1\n{line}\n");
        let _ = outcome(folder.path(), &deck, Mode::Run);
    }
}
