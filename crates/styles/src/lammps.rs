//! Names of LAMMPS: what it has and perigrain lacks is refused by name, with what to write in its place.

use perigrain_base::diag::{Code, Diagnostics, nearest};
use perigrain_lang::Word;
use perigrain_lang::args::blame;

/// The commands and styles of LAMMPS in 2026 by kind, from the lists of its manual and of its program: `kind: name name …`.
const NAMES: &str = include_str!("lammps/names.txt");

/// What to write in the place of LAMMPS' styles and commands: `kind name name …: words`; `part*` stands for all names that begin so.
const INSTEAD: &str = include_str!("lammps/instead.txt");

/// The same for words that LIGGGHTS has besides.
const LIGGGHTS: &str = include_str!("lammps/liggghts.txt");

/// Endings of styles that run on other hardware or by other loops, with the same result.
const ACCELERATED: [&str; 5] = ["/omp", "/kk", "/opt", "/intel", "/gpu"];

/// Styles that LAMMPS has under a second name.
const RENAMED: [(&str, &str, &str); 1] = [("fix", "addtorque/group", "addtorque")];

/// The name of a style without the ending of an accelerated one, which gives the same numbers; renamed ones by their old name.
pub fn plain<'n>(kind: &str, name: &'n str) -> &'n str {
    let name = ACCELERATED.iter().find_map(|ending| name.strip_suffix(ending)).unwrap_or(name);
    RENAMED.iter().find(|(of, new, _)| *of == kind && *new == name).map_or(name, |(.., old)| old)
}

/// Whether LAMMPS has a style or command of this name; kinds are `command`, `fix`, `pair` and so on.
pub fn has(kind: &str, name: &str) -> bool {
    of_kind(NAMES, kind).any(|(_, names)| names.split_whitespace().any(|n| n == name))
}

/// What does here what LAMMPS' style or command does, or what to do without it.
pub fn instead(kind: &str, name: &str) -> Option<&'static str> {
    words_for(INSTEAD, kind, name)
}

/// The table's text for a name.
fn words_for(table: &'static str, kind: &str, name: &str) -> Option<&'static str> {
    let meant = |n: &str| n.strip_suffix('*').map_or(n == name, |begin| name.starts_with(begin));
    of_kind(table, kind)
        .find_map(|(names, words)| names.split_whitespace().any(meant).then_some(words.trim()))
}

/// The lines about a kind: the names that stand behind it before a colon, and what stands behind that.
fn of_kind<'t>(text: &'t str, kind: &str) -> impl Iterator<Item = (&'t str, &'t str)> {
    text.lines().filter_map(move |line| {
        let (head, rest) = line.split_once(':')?;
        let (of, names) = head.split_once(' ').unwrap_or((head, ""));
        (of == kind).then_some((names, rest))
    })
}

/// The refusal of a word that LAMMPS (or LIGGGHTS) has and perigrain lacks, called a `what`; `None` where it has none such.
pub fn refusal(kind: &str, what: &str, word: &Word) -> Option<Diagnostics> {
    let name = plain(kind, &word.text);
    let (owner, words) = match words_for(LIGGGHTS, kind, name) {
        _ if has(kind, name) => ("LAMMPS", instead(kind, name)),
        Some(words) => ("LIGGGHTS", Some(words)),
        None => return None,
    };
    let d = blame(word, Code::NOT_SUPPORTED, format!("{owner}' {what} `{}` is not in perigrain", word.text));
    Some(words.map_or(d.clone(), |words| d.help(words)).into())
}

/// The refusal of a word that names no style, called a `what`: by name where LAMMPS has it, else with the nearest of those `known`.
pub fn unknown(kind: &str, what: &str, word: &Word, known: &[&str]) -> Diagnostics {
    if let Some(refusal) = refusal(kind, what, word) {
        return refusal;
    }
    let d = blame(word, Code::UNKNOWN_STYLE, format!("unknown {what} `{}`", word.text));
    match nearest(&word.text, known.iter().copied()) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help(format!("known: {}", known.join(" "))),
    }
    .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lammps_names_are_known_and_lead_on() {
        assert!(
            has("fix", "nph/sphere") && has("command", "dihedral_style") && has("compute", "continuum/chunk")
        );
        assert!(!has("fix", "nve/spher") && !has("pair", "nve") && !has("fix", ""));
        assert_eq!(plain("fix", "nve/sphere/omp"), "nve/sphere");
        assert_eq!(plain("fix", "addtorque/group"), "addtorque");
        assert!(instead("fix", "nph/sphere").unwrap().contains("deform/pressure"));
        assert_eq!(instead("fix", "nve"), None);
    }

    #[test]
    fn words_of_liggghts_lead_on() {
        let word = |text: &str| Word::new(text, Default::default());
        let refused = |kind, text| refusal(kind, "style", &word(text)).unwrap().0.remove(0);
        assert_eq!(refused("pair", "gran").message, "LIGGGHTS' style `gran` is not in perigrain");
        assert!(refused("fix", "mesh/surface").help[0].contains("fix wall/mesh"));
        assert!(refusal("fix", "style", &word("mesh/surfac")).is_none());
    }

    #[test]
    fn all_that_is_led_on_is_lammps() {
        for line in INSTEAD.lines() {
            let (head, words) = line.split_once(": ").unwrap_or_else(|| panic!("{line}"));
            assert!(!words.trim().is_empty(), "{line}");
            let mut names = head.split(' ');
            let kind = names.next().unwrap();
            for name in names {
                let known = match name.strip_suffix('*') {
                    Some(begin) => NAMES.split_whitespace().any(|n| n.starts_with(begin)),
                    None => has(kind, name),
                };
                assert!(known, "{kind} {name}");
            }
        }
    }
}
