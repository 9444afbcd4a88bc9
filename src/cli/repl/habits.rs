//! Habits from other prompts: what `?`, `exit`, `%time …` and their like mean here, or what to write instead.

use crate::manual::knowing::{self, COLON};

/// What a line means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Meant {
    /// A line of a deck.
    Deck,
    /// The manual, at these words.
    Help(Vec<String>),
    /// To leave.
    Leave,
    /// This line, and how long it takes.
    Timed(String),
    /// Nothing here: what to write instead.
    Hint(String),
}

/// Programs that a user types from habit of the shell.
const PROGRAMS: [&str; 9] = ["ls", "cd", "pwd", "cat", "less", "head", "tail", "mkdir", "grep"];

/// What a typed line means that begins with no command of the prompt.
pub fn meant(line: &str) -> Meant {
    let line = line.trim();
    let words: Vec<&str> = line.split_whitespace().collect();
    let Some((first, rest)) = words.split_first() else { return Meant::Deck };
    let owned = |words: &[&str]| words.iter().map(|w| (*w).to_string()).collect::<Vec<_>>();
    if knowing::commands().contains(first) {
        return Meant::Deck;
    }
    match *first {
        "help" => Meant::Help(owned(rest)),
        "help()" => Meant::Help(vec![]),
        "exit" | "exit()" | "quit()" | "bye" | "logout" | ":q" | ":q!" | ":exit" | ":wq" => Meant::Leave,
        "%time" | "%timeit" | "time" if !rest.is_empty() => {
            Meant::Timed(line[first.len()..].trim_start().into())
        }
        "history" => Meant::Hint("arrow up goes through earlier lines, and Ctrl-R searches them".into()),
        _ if PROGRAMS.contains(first) => Meant::Hint(format!("write `shell {line}`")),
        word => match word.chars().next() {
            Some('?') => Meant::Help(
                owned(&words)
                    .join(" ")
                    .trim_start_matches('?')
                    .split_whitespace()
                    .map(String::from)
                    .collect(),
            ),
            Some('!') => Meant::Hint(format!("write `shell {}`", line[1..].trim_start())),
            Some('%') => Meant::Hint("of such words the prompt has `%time LINE` alone".into()),
            _ if line.ends_with('?') && words.len() <= 2 => {
                Meant::Help(line.trim_end_matches('?').split_whitespace().map(String::from).collect())
            }
            _ if COLON.iter().any(|(name, _)| name[1..] == *word) => {
                Meant::Hint(format!("commands of the prompt begin with a colon: write `:{line}`"))
            }
            _ => Meant::Deck,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn habits_work_or_get_a_hint() {
        let help = |words: &[&str]| Meant::Help(words.iter().map(|w| (*w).to_string()).collect());
        let hint = |line: &str| match meant(line) {
            Meant::Hint(text) => text,
            other => format!("{other:?}"),
        };
        assert_eq!([meant("?"), meant("help"), meant("? ")], [help(&[]), help(&[]), help(&[])]);
        let fix = help(&["fix", "nve"]);
        assert_eq!(
            [meant("?fix nve"), meant("? fix nve"), meant("fix nve?")].map(|m| m == fix),
            [true, true, false]
        );
        assert_eq!(meant("granular?"), help(&["granular"]));
        assert_eq!(["exit", "exit()", ":q"].map(meant), [Meant::Leave, Meant::Leave, Meant::Leave]);
        assert_eq!(meant("%time run 10"), Meant::Timed("run 10".into()));
        assert_eq!(
            [meant("run 10"), meant("print a?"), meant("clear")],
            [Meant::Deck, Meant::Deck, Meant::Deck]
        );
        assert_eq!(hint("!ls -l"), "write `shell ls -l`");
        assert_eq!(hint("ls -l"), "write `shell ls -l`");
        assert!(hint("plot pe").contains("`:plot pe`") && hint("%magic").contains("%time LINE"));
    }
}
