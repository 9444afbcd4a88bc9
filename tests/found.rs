//! What a user at a terminal finds without knowing where to look: subcommands, pages, examples, words in the wrong place.
#![cfg(unix)]

use super::pty::{PLAIN, shown, too_wide, width};
use std::fs;
use std::path::Path;

/// The output of the program for these words on a terminal of 80 columns, pages shown as they are.
fn output_of(folder: &Path, args: &str) -> String {
    shown(folder, 80, "print a\n", args, &[("PAGER", "cat"), ("NO_COLOR", "1")]).replace('\r', "")
}

#[test]
fn a_mistyped_subcommand_is_taken_for_one() {
    let folder = tempfile::tempdir().unwrap();
    let meant = |deck: &str| format!("did you mean `perigrain check {deck}`?");
    assert!(output_of(folder.path(), "chekc in.fall").contains(&meant("in.fall")));
    // Also where there is such a deck, which is not run.
    let text = output_of(folder.path(), "chekc in.deck; ls");
    assert!(text.contains("`chekc` is no subcommand") && text.contains(&meant("in.deck")), "{text}");
    assert!(!text.contains("already") && !text.contains("log.lammps"), "{text}");
    // Whose file it is, is run.
    assert!(output_of(folder.path(), "--version; cp in.deck chekc; exec \"$0\" chekc").contains("\na\n"));
}

#[test]
fn what_is_missing_or_wrong_is_named() {
    let folder = tempfile::tempdir().unwrap();
    for (args, wanted) in [
        ("completions", "error: the following required arguments were not provided: <SHELL>\n"),
        ("completions", "  = help: write `perigrain completions <SHELL>`\n"),
        ("completions fsh", "[possible values: bash, elvish, fish, powershell, zsh]"),
        ("new", "write `perigrain new <FILE>`"),
        ("new in.x -kind pourr", "a similar value exists: 'pour'"),
        ("examples copy hoper", "did you mean `hopper`?"),
        ("help granualr", "did you mean `granular`?"),
    ] {
        let text = output_of(folder.path(), args);
        assert!(text.contains(wanted), "{args}: {text}");
    }
}

#[test]
fn help_goes_by_topics_through_a_pager() {
    let folder = tempfile::tempdir().unwrap();
    let text = output_of(folder.path(), "help");
    let heads: Vec<&str> = text.lines().filter(|l| !l.is_empty() && !l.starts_with(' ')).collect();
    for head in ["subcommands:", "topics", "commands", "pair_style", "fix", "compute", "dump", "how-tos"] {
        assert!(heads.contains(&head), "{head}: {heads:?}");
    }
    assert_eq!(too_wide(&text, 80), None);
    // Texts of all entries stand below each other.
    let columns = |line: &&str| {
        line.starts_with("  completions  Print completions") || line.starts_with("  run          Run a deck")
    };
    assert_eq!(text.lines().filter(columns).count(), 2, "{text}");
    // Pages go through the pager, and their lines break at words.
    for args in ["help fix", "help", "-help", "explain PG0102", "examples", "examples show hopper"] {
        let text = shown(folder.path(), 60, "", args, &[("PAGER", "sed s/^/@/")]);
        let long = text.lines().count() >= 50;
        assert!(
            text.lines().filter(|l| !l.trim().is_empty()).all(|l| l.starts_with('@') == long),
            "{args}: {text}"
        );
        assert!(!text.contains('\x1b'), "{text}");
        let whole = |l: &&str| l.contains('|') || l.contains("perigrain examples/");
        let lines = text.lines().map(|l| l.trim_start_matches('@')).filter(|l| !whole(l));
        assert_eq!(lines.into_iter().find(|l| width(l) > 60), None, "{args}: {text}");
    }
    let text = shown(folder.path(), 60, "", "help fix", &[("PAGER", "cat")]);
    assert!(text.lines().any(|l| l.trim_end().ends_with("Lets the diameter of spheres")), "{text}");
}

#[test]
fn help_searches_names_and_texts() {
    let folder = tempfile::tempdir().unwrap();
    for (args, wanted) in [
        ("help fix", "\n  fix nve/sphere "),
        ("help fix", "\n  fix wall/gran "),
        ("help wall", "# Pages named so: `wall`\n\n  fix wall/gran "),
        ("help wall", "# Pages that contain it: `wall`\n\n"),
        ("help hertz/material", "\n  pair_style granular "),
        ("help", "\n  notch "),
        ("help notch", "# A crack from a notch\n"),
        ("help howto", "\n  howto notch "),
        // Words that no page has beside each other.
        ("help crack speed", "\n  compute crack "),
    ] {
        let text = output_of(folder.path(), args);
        assert!(text.contains(wanted), "{args}: {text}");
    }
}

#[test]
fn a_word_that_is_known_elsewhere_is_named_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let deck = "units si\natom_style sphere\npair_style granular hertz/material 1e7 0.5 0.3\n";
    let text = shown(folder.path(), 100, deck, PLAIN, &[("NO_COLOR", "1")]);
    let hint = "`hertz/material` is a normal model of granular contacts: it stands in pair_coeff";
    assert!(text.contains(hint) && text.contains("in.deck:3:"), "{text}");
    let text = shown(
        folder.path(),
        100,
        "units si\nregion b block 0 1 0 1 0 1\ncreate_box 1 b\ncompute 1 all nve\n",
        PLAIN,
        &[("NO_COLOR", "1")],
    );
    assert!(text.contains("`nve` is a style of `fix`: write `fix ID group nve"), "{text}");
}

#[test]
fn examples_and_new_decks_are_written_here() {
    let folder = tempfile::tempdir().unwrap();
    let list = output_of(folder.path(), "examples list");
    assert!(list.contains("\n  hopper ") && list.contains("perigrain examples copy NAME"), "{list}");
    assert_eq!(too_wide(&list, 80), None);
    let text =
        output_of(folder.path(), "examples copy hopper && \"$0\" check hopper/in.hopper; echo code $?");
    assert!(text.contains("run it: perigrain hopper/in.hopper\n"), "{text}");
    assert!(text.ends_with("code 0\n"), "{text}");
    let text = output_of(folder.path(), "new in.mine && exec \"$0\" check in.mine");
    assert!(
        text.contains("run it: perigrain in.mine\n") && text.contains("in.mine: no problems found"),
        "{text}"
    );
    assert!(fs::read_to_string(folder.path().join("in.mine")).unwrap().contains("pair_style"));
}

#[test]
fn shells_and_man_get_their_pages() {
    let folder = tempfile::tempdir().unwrap();
    for (shell, wanted) in
        [("bash", "complete -F _perigrain"), ("zsh", "#compdef perigrain"), ("fish", "complete -c perigrain")]
    {
        let text = output_of(folder.path(), &format!("completions {shell}"));
        assert!(text.contains(wanted) && text.contains("sweep"), "{shell}");
    }
    assert!(output_of(folder.path(), "man").contains(".TH perigrain 1"));
    let text = output_of(folder.path(), "man pages && ls pages");
    assert!(text.contains("perigrain.1") && text.contains("perigrain-check.1"), "{text}");
}
