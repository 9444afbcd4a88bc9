//! Unknown words of a line: similar words, and the place where the word belongs if it is known elsewhere.

use crate::graph::catalogue::Tables;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, nearest};
use perigrain_contact::{Damping, Friction, normal};
use perigrain_lang::{Command, Word};
use perigrain_styles::lammps;

/// Categories of styles, the command that takes them, and what stands before the style's name.
const LINES: [(&str, &str, &str); 6] = [
    ("fix", "fix", "fix ID group "),
    ("compute", "compute", "compute ID group "),
    ("pair", "pair_style", "pair_style "),
    ("bond", "bond_style", "bond_style "),
    ("dump", "dump", "dump ID group "),
    ("region", "region", "region ID "),
];

/// Adds to each problem with a word of the line where that word belongs.
///
/// Words behind an unexpected one are its own numbers and not reported.
pub(super) fn add_places(problems: Diagnostics, cmd: &Command, tables: &Tables) -> Diagnostics {
    let mut explained = false;
    let mut kept = vec![];
    for d in problems.0 {
        if explained && d.code == Code::EXTRA_ARGUMENT {
            continue;
        }
        // The line itself may know better what to write.
        let led = d.help.iter().any(|help| help.starts_with("write "));
        let home =
            at_fault(&d, cmd).filter(|_| !led).and_then(|word| home(&word.text, &cmd.name.text, tables));
        explained |= home.is_some();
        kept.push(match home {
            Some(home) => instead(d, home),
            None => d,
        });
    }
    Diagnostics(kept)
}

/// The word of the line that a problem is about, if it is an unknown word.
fn at_fault<'c>(d: &Diagnostic, cmd: &'c Command) -> Option<&'c Word> {
    let unknown = [Code::UNKNOWN_COMMAND, Code::UNKNOWN_STYLE, Code::EXTRA_ARGUMENT].contains(&d.code);
    let span = d.span.filter(|_| unknown)?;
    std::iter::once(&cmd.name).chain(&cmd.args).find(|word| word.span == span && !word.quoted)
}

/// The problem with the home of its word in the place of the words that are nearly like it.
fn instead(mut d: Diagnostic, home: String) -> Diagnostic {
    d.help.retain(|help| !help.starts_with("known") && !help.starts_with("did you mean"));
    d.help(home)
}

/// The refusal of a line whose first word is no command.
pub(super) fn unknown_command(cmd: &Command, tables: &Tables) -> Diagnostics {
    let name = cmd.name.text.as_str();
    if let Some(refusal) = lammps::refusal("command", "command", &cmd.name) {
        return refusal;
    }
    let known = tables.names("command").unwrap_or_default();
    let d = Diagnostic::error(Code::UNKNOWN_COMMAND, cmd.name.span, format!("unknown command `{name}`"));
    match nearest(name, known) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d,
    }
    .into()
}

/// Where a word belongs that `command` does not know.
fn home(word: &str, command: &str, tables: &Tables) -> Option<String> {
    // These give no hint of what was meant.
    if word == "none" || word == "zero" {
        return None;
    }
    let model = |what, behind: &str| {
        Some(format!("`{word}` is a {what}: it stands in pair_coeff, as `pair_coeff * * {behind}{word} …`"))
    };
    if normal::STYLES.iter().any(|style| style.name == word) {
        return model("normal model of granular contacts", "");
    }
    if Friction::ALL.into_iter().any(|friction| friction.name() == word) {
        return model("tangential model of granular contacts", "MODEL … tangential ");
    }
    if Damping::ALL.into_iter().any(|damping| damping.name() == word) {
        return model("damping model of granular contacts", "MODEL … damping ");
    }
    let known = |category| tables.names(category).is_some_and(|names| names.contains(&word));
    if let Some((_, kind, line)) = LINES.into_iter().find(|(of, kind, _)| *kind != command && known(of)) {
        return Some(format!("`{word}` is a style of `{kind}`: write `{line}{word} …`"));
    }
    let begins = word != command && known("command");
    begins.then(|| format!("`{word}` is a command, it begins a line of its own"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_know_where_they_belong() {
        let tables = Tables::default();
        for (word, command, part) in [
            ("hertz/material", "pair_style", "a normal model of granular contacts: it stands in pair_coeff"),
            ("mindlin", "fix", "`pair_coeff * * MODEL … tangential mindlin …`"),
            ("tsuji", "pair_style", "damping tsuji"),
            ("nve", "compute", "write `fix ID group nve …`"),
            ("damage/atom", "fix", "write `compute ID group damage/atom …`"),
            ("peri/pmb", "fix", "write `pair_style peri/pmb …`"),
            ("bpm/beam", "pair_style", "write `bond_style bpm/beam …`"),
            ("block", "fix", "write `region ID block …`"),
            ("run", "thermo", "`run` is a command"),
        ] {
            let home = home(word, command, &tables).unwrap_or_default();
            assert!(home.contains(part), "{word}: {home}");
        }
        for (word, command) in [("none", "fix"), ("blokc", "fix"), ("run", "run")] {
            assert_eq!(home(word, command, &tables), None);
        }
    }
}
