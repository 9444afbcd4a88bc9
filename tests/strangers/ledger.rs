//! K4, the ledger of energy: the same sums however a run is cut, and nothing counts twice.

use super::{numbers, run, text};

/// What a deck prints behind a name; it must end well.
fn output_of(deck: &str, name: &str, variables: &[&str]) -> Vec<f64> {
    let variables: Vec<&str> = variables.chunks(2).flat_map(|pair| ["-var", pair[0], pair[1]]).collect();
    let output = run(deck, &variables);
    let text = text(&output);
    assert!(output.status.success(), "{text}");
    numbers(&text, name)
}

#[test]
fn a_torn_plate_has_the_same_sums_in_one_run_in_two_and_in_a_loop() {
    let of = |cut| output_of("ledger_notch.in", "SUMS", &["cut", cut]);
    let one = of("one");
    assert!(one[2] > 5e-5, "nothing broke: {one:?}");
    assert_eq!(of("two"), one);
    // A variable that only `if` reads is no force: with a setup before each run the sums differed, and energies of the last run's
    // end were unknown behind it.
    assert_eq!(of("loop"), one);
}

#[test]
fn a_heap_has_the_same_sums_in_one_run_and_in_two() {
    let of = |first| output_of("ledger_heap.in", "SUMS", &["end", "0.05", "first", first]);
    assert_eq!(of("217"), of("0"));
}

#[test]
fn what_is_missing_stays_missing_in_the_next_run() {
    let output = run("ledger_notch.in", &["-var", "cut", "changed"]);
    let text = text(&output);
    let [ends, begins] = ["ENDS", "BEGINS"].map(|name| numbers(&text, name)[0]);
    // It began at 0 again. Sums of some 1e-4 J leave rounding of parts of 1e-16.
    assert!(ends < -1e-8 && (begins - ends).abs() < 1e-18, "{ends} {begins}");
}

#[test]
fn the_ledger_of_breaking_bonds_closes_in_second_order() {
    // The largest residual of all rows over what bonds have set free. Their last forces act for half a step after they broke: where that
    // was no part of what they set free it was 6e-2. And where bonds of a row's own step counted as strain and as cracks, rows at which
    // many broke were off by up to 4e-2 the other way.
    let worst = |step: &str| {
        let text = text(&run("ledger_notch.in", &["-var", "part", step]));
        let rows = text.lines().map(|l| l.split_whitespace().map_while(|w| w.parse().ok()).collect());
        let rows: Vec<Vec<f64>> = rows.filter(|row: &Vec<f64>| row.len() == 5).collect();
        assert!(rows.len() > 100);
        let most = rows.iter().map(|row| row[3].abs()).fold(0.0, f64::max);
        most / rows.iter().map(|row| row[2]).fold(0.0, f64::max)
    };
    // 1.1e-3 and less; which bonds break depends on the step, so that errors fall with its square on average alone.
    let [whole, half] = ["0.5", "0.25"].map(worst);
    assert!(whole < 3e-3 && half < 0.5 * whole, "{whole} {half}");
}
