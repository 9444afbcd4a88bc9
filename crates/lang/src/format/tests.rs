//! Layout by example, and that no text gets another meaning by it: decks of this repository, LAMMPS' own, random ones.

use super::*;
use proptest::prelude::*;
use std::path::{Path, PathBuf};

fn formatted(text: &str) -> String {
    format(text, FileId(0)).unwrap()
}

#[track_caller]
fn check(text: &str, wanted: &str) {
    assert_eq!(formatted(text), wanted, "from {text:?}");
    assert_eq!(formatted(wanted), wanted, "again");
}

/// Same words and comments, and a second time changes nothing.
#[track_caller]
fn means_the_same(text: &str, name: &str) {
    let Ok(before) = lines(text, FileId(0)) else {
        assert!(format(text, FileId(0)).is_err(), "{name}");
        return;
    };
    let new = format(text, FileId(0)).unwrap_or_else(|e| panic!("{name}: {e}\n{text:?}"));
    let after = lines(&new, FileId(0)).unwrap();
    assert_eq!(before.len(), after.len(), "{name}: {text:?} became {new:?}");
    for (a, b) in before.iter().zip(&after) {
        assert_eq!(meaning(text, a), meaning(&new, b), "{name}: {text:?} became {new:?}");
    }
    assert_eq!(format(&new, FileId(0)).unwrap(), new, "{name}: {text:?} became {new:?}, and then");
}

#[test]
fn blanks_between_words_and_at_ends() {
    check("units\t lj  \nrun   100", "units lj\nrun 100\n");
    check("  fix  1 all   nve\n", "  fix 1 all nve\n");
    check("units lj\r\nrun  1 \r\n", "units lj\r\nrun 1\r\n");
    check("run 1\n\n\n\nrun 2\n\n", "run 1\n\nrun 2\n");
    check("\n \n", "");
    check("", "");
}

#[test]
fn quotes_and_formulas_stay_as_they_are() {
    check("print  \"a   b\"   end", "print \"a   b\" end\n");
    check("print  \"\"\"a  \n  b\t \n\"\"\"   x", "print \"\"\"a  \n  b\t \n\"\"\" x\n");
    check("region  r sphere $( 1  + v_x )  ${ a  b }", "region r sphere $( 1  + v_x ) ${ a  b }\n");
    check("print 'a  &\n   b'  c", "print 'a  &\n   b' c\n");
}

#[test]
fn continuations_stand_four_columns_in() {
    check("fix 1 all   &\n\t\tnve\n", "fix 1 all &\n    nve\n");
    check("  fix 1&\n  all nve\n", "  fix 1 &\n      all nve\n");
    check("print ab&\ncd  &\n   e  # f\n", "print ab&\ncd &\n    e # f\n");
    check("print a&\n&\nb  c\n", "print a&\n&\nb c\n");
    check("fix  1 all &\n     nve &\n     x\n", "fix 1 all &\n    nve &\n    x\n");
    check("run     1 &\n        post no\nunits   lj\n", "run     1 &\n        post no\nunits   lj\n");
    check("if      \"a &\n  b\"   c\nunits   lj\n", "if      \"a &\n  b\" c\nunits   lj\n");
    check("run 1 &\n\n\n\nrun 2\n", "run 1 &\n\n\nrun 2\n");
    check("run 1 &", "run 1 &\n");
}

#[test]
fn columns_that_were_there_stay() {
    let deck = "variable        D       index 5\nvariable        R       index 10\n\nunits           lj\n";
    check(deck, deck);
    check(
        "fix 1 all    nve\nfix long all  nve/sphere\nunfix 1\n",
        "fix 1 all    nve\nfix long all nve/sphere\nunfix 1\n",
    );
    check("dimension\t2\nboundary\tp p p\n", "dimension       2\nboundary        p p p\n");
    check("run  1\nrun 22   post no\n", "run 1\nrun 22 post no\n");
}

#[test]
fn comments_stand_in_columns() {
    check("run 1 # a\nrun 1000   # b\n", "run 1     # a\nrun 1000  # b\n");
    check(
        "run 1     # a\n          # more\nrun 10    # b\n",
        "run 1     # a\n          # more\nrun 10    # b\n",
    );
    check("#a \n   # b\nrun 1#c\n", "#a\n   # b\nrun 1  #c\n");
    check("run 1 # go &\n  on  \n", "run 1 # go &\n  on\n");
}

#[test]
fn what_cannot_be_read_is_refused_with_its_places() {
    let problems = format("print \"a\nrun 1\nprint 'b\n", FileId(0)).unwrap_err();
    let starts: Vec<u32> = problems.0.iter().map(|d| d.span.unwrap().start).collect();
    assert_eq!(starts, [6, 21]);
}

/// All decks below a folder.
fn decks(folder: &Path) -> Vec<PathBuf> {
    let (mut found, mut folders) = (vec![], vec![folder.to_path_buf()]);
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).into_iter().flatten().map(|e| e.unwrap().path()) {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                folders.push(path);
            } else if name.starts_with("in.") || name.ends_with(".in") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

#[test]
fn decks_keep_their_meaning() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let ours: Vec<PathBuf> =
        ["examples", "tests", "src"].iter().flat_map(|folder| decks(&root.join(folder))).collect();
    assert!(ours.len() > 200, "{}", ours.len());
    for path in ours.into_iter().chain(decks(Path::new("/usr/share/lammps/examples"))) {
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        means_the_same(&text, &path.display().to_string());
    }
}

const PIECES: &[&str] = &[
    "fix", "run", "a", "bc", " ", "  ", "\t", " ", "\n", "\n", "\r\n", "\r", "&", "&\n", " &\n", " & \n",
    "#", "# x", "\"", "'", "\"\"\"", "$(", "(", ")", "${", "}", "$x", "\u{a0}", "\u{b}", "ä", "𝕏", "\n\n\n",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_texts_keep_their_meaning(pieces in prop::collection::vec(prop::sample::select(PIECES), 0..40)) {
        means_the_same(&pieces.concat(), "random");
    }

    #[test]
    fn random_lines_keep_their_meaning(
        lines in prop::collection::vec(("[ \t]{0,3}", "[ab]{1,6}", "[ \t]{1,5}", "[ab]{1,9}", " {1,9}", "[ab]{1,9}", "( {1,9}# ?c| &|)"), 0..12)
    ) {
        let text: String =
            lines.into_iter().map(|l| [l.0, l.1, l.2, l.3, l.4, l.5, l.6].concat() + "\n").collect();
        means_the_same(&text, "random");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Requests of an editor work for any text as it is typed, with places that can be shown.
    #[test]
    fn any_text_has_lines_for_editors(pieces in prop::collection::vec(prop::sample::select(PIECES), 0..40)) {
        let text = pieces.concat();
        for line in crate::raw_lines(&text, FileId(0)) {
            let nested = line.words.iter().flat_map(crate::raw_words);
            for span in nested.chain(line.words.clone()).map(|w| w.span).chain(line.comment) {
                prop_assert!(text.get(span.start as usize..span.end as usize).is_some(), "{text:?}");
            }
        }
    }
}
