//! What read_restart, write_restart and restart refuse, with the word to blame.

use perigrain::session::{Mode, Options, Session};
use std::fs;

fn refused(deck: &str, mode: Mode) -> String {
    let mut session = Session::new(Options { mode, ..Options::default() }).unwrap();
    let problems = session.run_text("in.deck", deck).expect_err(deck);
    let d = &problems.0[0];
    let (line, column) = session.sources.place(d.span.unwrap());
    format!("{line}:{column} {}", d.message)
}

#[test]
fn files_that_are_no_restart_files_are_refused_at_their_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    for (bytes, message) in [
        (&b"LammpS RestartT\0\x01\0\0\0\x03\0\0\0"[..], "is one of LAMMPS"),
        (b"# a deck\nunits si\n", "is none of perigrain"),
        (b"PERIGRN\x1a\x02\0\0\0", "is of format 2; this perigrain reads formats up to 1"),
        (b"PERIGRN\x1a\x01\0\0\0\0\0", "is cut off after 14 bytes"),
    ] {
        fs::write(&path, bytes).unwrap();
        for mode in [Mode::Run, Mode::Check] {
            let printed = refused(&format!("read_restart {}", path.display()), mode);
            assert!(printed.starts_with("1:14 ") && printed.contains(message), "{printed}");
        }
    }
}

#[test]
fn a_checked_deck_continues_from_files_it_would_write() {
    let deck = "atom_style peri\nregion b block 0 2 0 2 0 2\ncreate_box 2 b\npair_style peri/pmb\n\
                pair_coeff * * 1.6e21 3.01 0.0015 0.25\nfix 1 all nve\nset group all volume 1\nset group all density 1\n\
                restart 10 a.*.restart\nrun 40\nwrite_restart b.restart\nclear\nread_restart b.restart\nmass 1 1.0\nclear\n\
                read_restart a.20.restart\npair_coeff 3 3 1 1 1 1\nfix 1 all nve\nrun 1\nclear\nread_restart a.*.restart\nrun 1\n\
                clear\nread_restart c.restart";
    let mut session = Session::new(Options { mode: Mode::Check, ..Options::default() }).unwrap();
    let problems = session.run_text("in.deck", deck).unwrap_err();
    let printed: Vec<&str> = problems.0.iter().map(|d| d.message.as_str()).collect();
    assert_eq!(printed.len(), 3, "{printed:?}");
    assert!(
        printed[0].contains("own mass")
            && printed[1].contains("from 1 to 2")
            && printed[2].contains("no restart file")
    );
}
