//! Verdicts on small decks: what passes, what fails, what is known, and decks that do not come to their end.

use super::*;
use crate::heads::{self, Headed};

/// A case of these lines, with a deck that knows seven.
fn case(head: &str, deck: &str) -> Case {
    let head = format!("title = \"t\"\nabout = \"a\"\nsource = \"s\"\n{head}");
    let head: String = head.lines().map(|line| format!("#| {line}\n")).collect();
    Case::read("tests/planted", &format!("{head}variable seven equal 7\n{deck}\n")).unwrap()
}

const SEVEN: &str = "[[check]]\nwhat = \"seven\"\nmeasure = \"v_seven\"\ntolerance = 1e-6\nwhy = \"w\"\n";

fn verdicts(head: &str, deck: &str) -> Vec<Verdict> {
    run(&case(head, deck)).rows.iter().map(|row| row.verdict).collect()
}

#[test]
fn numbers_and_formulas_are_met_or_not() {
    assert_eq!(verdicts(&format!("{SEVEN}expected = 7.0"), ""), [Verdict::Passed]);
    assert_eq!(verdicts(&format!("{SEVEN}expected = \"v_seven+1e-5\""), ""), [Verdict::Failed]);
    assert_eq!(verdicts(&format!("{SEVEN}expected = 7.00001"), ""), [Verdict::Failed]);
    let [row] = &run(&case(&format!("{SEVEN}expected = 8.0"), "")).rows[..] else { panic!() };
    assert_eq!((row.ours, row.expected, row.deviation), (7.0, 8.0, -0.125));
}

#[test]
fn a_known_deviation_is_neither_passed_nor_any_other_one() {
    let known = |ours: f64| {
        format!("{SEVEN}expected = 8.0\nknown = {{ ours = {ours:?}, within = 1e-6, reason = \"r\" }}")
    };
    assert_eq!(verdicts(&known(7.0), ""), [Verdict::Known]);
    assert_eq!(verdicts(&known(7.1), ""), [Verdict::Failed]);
}

#[test]
fn the_worst_point_of_a_curve_counts() {
    let head = "[[curve]]\nname = \"c\"\ntitle = \"t\"\nx = \"x, m\"\ny = \"y\"\n\
                [[check]]\nwhat = \"c\"\ncurve = \"c\"\ntolerance = 0.2\nwhy = \"w\"";
    let points = "print \"curve c 1 10 10\"\nprint \"curve c 2 1 2\"\nprint \"curve c 3 5\"";
    let outcome = run(&case(head, points));
    assert_eq!(outcome.points, [vec![(1.0, 10.0, Some(10.0)), (2.0, 1.0, Some(2.0)), (3.0, 5.0, None)]]);
    assert_eq!((outcome.rows[0].at, outcome.rows[0].verdict), (Some(2.0), Verdict::Failed));
    // A tenth of the largest.
    let largest = format!("{head}\nof = \"largest\"");
    assert_eq!(verdicts(&largest, points), [Verdict::Passed]);
    assert_eq!(verdicts(head, "print \"curve c 1 nan 1\""), [Verdict::Failed]);
    assert_eq!(verdicts(head, ""), [Verdict::Failed], "no points");
}

#[test]
fn a_deck_that_fails_fails_its_checks() {
    for (head, deck) in [
        (format!("{SEVEN}expected = 7.0"), "unita si"),
        (format!("{SEVEN}expected = \"v_eight\""), ""),
        (format!("{SEVEN}expected = 7.0"), "print \"curve unknown 1 2 3\""),
    ] {
        let outcome = run(&case(&head, deck));
        assert_eq!(outcome.count(Verdict::Failed), 1, "{deck}");
        assert!(outcome.failure.is_some(), "{deck}");
    }
}

#[test]
fn outcomes_come_in_the_order_of_their_cases() {
    let cases: Vec<Case> = (0..7).map(|k| case(&format!("{SEVEN}expected = {k}.0"), "")).collect();
    let outcomes = run_all(cases, 3, |_| ());
    let expected: Vec<f64> = outcomes.iter().map(|o| o.rows[0].expected).collect();
    assert_eq!(expected, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
}

#[test]
fn heads_that_make_no_sense_are_refused() {
    let read = |head: &str| {
        let head = format!("title = \"t\"\nabout = \"a\"\nsource = \"s\"\n{head}");
        let head: String = head.lines().map(|line| format!("#| {line}\n")).collect();
        Case::read("tests/planted", &head)
    };
    assert!(read("").unwrap_err().contains("nothing is checked"));
    assert!(read(SEVEN).unwrap_err().contains("needs"));
    assert!(read(&format!("{SEVEN}curve = \"c\"")).unwrap_err().contains("needs"));
    assert!(
        read(&format!("{SEVEN}expected = 7.0").replace("\"w\"", "\" \"")).unwrap_err().contains("reason")
    );
    assert!(read(&format!("{SEVEN}expected = 7.0\ntolerence = 1")).is_err());
}

#[test]
fn every_case_of_the_program_can_be_read() {
    let chosen = |text: &str| heads::chosen::<Case>(crate::verify::DECKS, text).unwrap();
    let cases = chosen("");
    assert_eq!(cases.len(), crate::verify::DECKS.len());
    for case in &cases {
        assert!(
            !case.about.is_empty() && !case.source.is_empty() && !case.lines().contains("#|"),
            "{}",
            case.name
        );
    }
    assert!((1..cases.len()).contains(&chosen("CHUNG").len()));
}
