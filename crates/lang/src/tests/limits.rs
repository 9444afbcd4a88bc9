//! What would never end or take all memory is refused, and long lines are read in the time of their length.

use super::output_of;
use std::time::Instant;

#[test]
fn a_tree_of_variables_is_not_evaluated_without_end() {
    let tree = |kind: &str, last: &str| {
        let lines: String = (1..=40)
            .map(|k| {
                let before = k - 1;
                format!(
                    "variable v{k} {kind} v_{last}{before}+v_{last}{before}\nvariable s{k} format v{k} %g\n"
                )
            })
            .collect();
        output_of(&format!("variable v0 equal 1\nvariable s0 format v0 %g\n{lines}print ${{v40}}\n"))
    };
    for last in ["v", "s"] {
        let printed = tree("equal", last);
        assert!(
            printed.starts_with("error[PG0203]: more than 1000000 variables would be evaluated"),
            "{printed}"
        );
        assert!(printed.lines().count() < 40, "{printed}");
    }
}

#[test]
fn a_circle_through_a_format_is_one() {
    let printed = output_of("variable a equal 1\nvariable b format a %g\nvariable a equal v_b\nprint ${a}\n");
    assert!(printed.contains("variable `a` depends on itself"), "{printed}");
}

#[test]
fn a_text_that_doubles_comes_to_an_end() {
    let printed = output_of(
        "variable s string x\nvariable i loop 60\nlabel a\nvariable s string ${s}${s}\nnext i\njump SELF a\nprint end\n",
    );
    assert!(printed.contains("the line would be longer than 16777216 characters"), "{}", printed.len());
}

/// Seconds that a line of `parts` joined pieces takes, the less of two.
fn seconds(parts: usize) -> f64 {
    let line = format!("variable x index a &\n{}z\nprint done\n", "$(1) bcd &\n".repeat(parts));
    let once = || {
        let begin = Instant::now();
        assert_eq!(output_of(&line), "done\n");
        begin.elapsed().as_secs_f64()
    };
    (0..2).map(|_| once()).fold(f64::INFINITY, f64::min)
}

#[test]
fn joined_lines_take_the_time_of_their_length() {
    // 8 times as many take 8 times as long, 64 times if each word looked at all pieces before.
    let (few, many) = (seconds(4_000), seconds(32_000));
    assert!(many < 30.0 * few + 0.05, "{few} s and {many} s");
}
