//! The lines that count, and the deck they make.

use super::alone::Alone;
use std::fmt::Write;

/// A line that was executed and not taken back.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// As it was typed.
    pub text: String,
    /// It was ended from outside.
    pub stopped: Option<Stopped>,
}

/// Where a line was stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopped {
    /// The step before it.
    pub first: i64,
    /// The step it came to.
    pub step: i64,
}

/// A deck that does what the session did. `switches` are its first lines; the number is that of lines that a deck
/// cannot repeat, because something other than a run was stopped in them.
pub fn deck(lines: &[Line], switches: &[String], alone: &Alone) -> (String, usize) {
    let mut out = format!("# Saved by perigrain {}.\n", env!("CARGO_PKG_VERSION"));
    let mut odd = 0;
    for line in switches {
        let _ = writeln!(out, "{line}");
    }
    for line in lines {
        match line.stopped {
            None => {}
            Some(s) => match shorter(&line.text, s) {
                Some(run) => {
                    let _ = writeln!(
                        out,
                        "# stopped at step {}: {}\n{run}",
                        s.step,
                        line.text.replace('\n', " ")
                    );
                    continue;
                }
                None => {
                    odd += 1;
                    let _ = writeln!(
                        out,
                        "# the next line was stopped at step {}; here it goes to its end",
                        s.step
                    );
                }
            },
        }
        let _ = writeln!(out, "{}", alone.line(&line.text));
    }
    (out, odd)
}

/// A stopped `run` as one that ends where it was stopped, with ramps as they were; `None` for any other line.
fn shorter(text: &str, s: Stopped) -> Option<String> {
    let code = text.split('#').next().unwrap_or("");
    let mut words = code.split_whitespace();
    if words.next() != Some("run") || code.contains(['$', '"', '\'', '&']) {
        return None;
    }
    let n: i64 = words.next()?.parse().ok()?;
    let rest: Vec<&str> = words.collect();
    let upto = rest.contains(&"upto");
    let mut out = format!("run {}", s.step - s.first);
    for word in rest.iter().filter(|w| **w != "upto") {
        let _ = write!(out, " {word}");
    }
    let last = if upto { n } else { s.first + n };
    for (key, step) in [("start", s.first), ("stop", last)] {
        if !rest.contains(&key) {
            let _ = write!(out, " {key} {step}");
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_base::diag::Sources;
    use std::path::Path;

    fn deck(lines: &[Line], switches: &[String]) -> (String, usize) {
        let (sources, here) = (Sources::default(), Path::new(""));
        super::deck(lines, switches, &Alone::new(&sources, here, here))
    }

    fn line(text: &str, stopped: Option<Stopped>) -> Line {
        Line { text: text.into(), stopped }
    }

    #[test]
    fn a_stopped_run_ends_where_it_was_stopped() {
        let s = Some(Stopped { first: 100, step: 130 });
        let lines = [line("units si", None), line("run 1000 post no", s), line("run 1000 upto stop 2000", s)];
        let (text, odd) = deck(&lines, &["variable v index 70".into()]);
        let wanted = "variable v index 70\nunits si\n# stopped at step 130: run 1000 post no\nrun 30 post no start 100 stop 1100\n\
                      # stopped at step 130: run 1000 upto stop 2000\nrun 30 stop 2000 start 100\n";
        assert_eq!((text.split_once('\n').unwrap().1, odd), (wanted, 0));
    }

    #[test]
    fn what_a_deck_cannot_repeat_is_counted() {
        let s = Some(Stopped { first: 0, step: 30 });
        let (text, odd) = deck(&[line("include in.loop", s), line("run 10 every 2 \"print a\"", s)], &[]);
        assert_eq!((odd, text.matches("goes to its end").count()), (2, 2));
    }
}
