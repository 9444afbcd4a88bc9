//! Completion: what may stand at the cursor, from the syntax line and the names of the session.

use super::knowing::{self, COLON};
use crate::cli::manual::pages;
use crate::cli::syntax::is_word;
use crate::session::Known;
use std::path::Path;

/// The byte at which the word before the cursor begins, and what it may become, sorted.
pub fn complete(line: &str, known: &Known, folder: &Path) -> (usize, Vec<String>) {
    let start = line.rfind(|c: char| c.is_whitespace() || c == '"' || c == '\'').map_or(0, |k| k + 1);
    let (before, word) = (last_line(&line[..start]), &line[start..]);
    let typed: Vec<&str> = before.split_whitespace().filter(|w| *w != "&").collect();
    let (skip, mut all) = candidates(&typed, word, known, folder);
    let part = &word[skip..];
    all.retain(|c| c.starts_with(part) && c != part);
    all.sort();
    all.dedup();
    (start + skip, all)
}

/// The last logical line: behind the last line break that no `&` joins.
fn last_line(text: &str) -> &str {
    let end = text.match_indices('\n').rfind(|(k, _)| !text[..*k].trim_end().ends_with('&'));
    &text[end.map_or(0, |(k, _)| k + 1)..]
}

/// How much of the word stays as it is, and what the rest of it may become.
fn candidates(typed: &[&str], word: &str, known: &Known, folder: &Path) -> (usize, Vec<String>) {
    if let Some((skip, names)) = references(word, known) {
        return (skip, names);
    }
    let Some(&command) = typed.first() else {
        let own = COLON.iter().map(|c| c.0).chain(["help"]);
        return (0, knowing::commands().into_iter().chain(own).map(String::from).collect());
    };
    if word.contains('/') && Path::new(word).parent().is_some_and(|p| folder.join(p).is_dir()) {
        return files(word, folder);
    }
    match (command, typed.len()) {
        ("help", _) => return (0, help_names(&typed[1..])),
        (":show" | ":save" | ":graph" | "include" | "jump", 1) => return files(word, folder),
        (":plot", _) => return (0, [owned(knowing::thermo()), values(known)].concat()),
        (":slice", 1) => return (0, [owned(ATTRIBUTES.to_vec()), values(known)].concat()),
        (":slice", 2) => return (0, owned(vec!["x", "y", "z"])),
        ("thermo_style", k) if k > 1 && typed[1] == "custom" => {
            return (0, [owned(knowing::thermo()), values(known)].concat());
        }
        _ => {}
    }
    let Some((place, page)) = knowing::place(typed, known) else { return (0, vec![]) };
    let slot = Slot { command, typed, text: page.doc.text, known, folder, word };
    let mut out = vec![];
    let mut skip = 0;
    for here in &place.here {
        for one in here.trim_end_matches('…').split('|') {
            let (s, mut names) = slot.names(one, &place.before);
            skip = skip.max(s);
            out.append(&mut names);
        }
    }
    (skip, out)
}

/// Attributes of particles that formulas know.
const ATTRIBUTES: [&str; 16] = [
    "id", "type", "mass", "radius", "x", "y", "z", "vx", "vy", "vz", "fx", "fy", "fz", "omegax", "omegay",
    "omegaz",
];

/// Where a word stands and what it may draw on.
struct Slot<'a> {
    command: &'a str,
    typed: &'a [&'a str],
    text: &'a str,
    known: &'a Known,
    folder: &'a Path,
    word: &'a str,
}

impl Slot<'_> {
    /// What a placeholder may become, `before` being the word of the syntax line before it.
    fn names(&self, placeholder: &str, before: &str) -> (usize, Vec<String>) {
        let known = self.known;
        let here = |names: &[String]| (0, names.to_vec());
        match placeholder {
            "group" | "GROUP" | "group-ID" => here(&known.groups),
            "REGION" | "region-ID" => here(&known.regions),
            "temp-ID" => here(&known.computes),
            "STYLE" | "style" => (0, owned(knowing::styles(self.command))),
            "attribute" => (0, [owned(ATTRIBUTES.to_vec()), values(known)].concat()),
            "input" | "value" => (0, values(known)),
            "KEYWORD" | "keyword" => (0, owned(knowing::keywords_in(self.text))),
            "NAME" if ["variable", "next"].contains(&self.command) || before == "variable" => {
                here(&known.variables)
            }
            "FILE" | "NAME" => files(self.word, self.folder),
            p if p.starts_with("file") => files(self.word, self.folder),
            "ID" => here(self.ids(before)),
            p if is_word(p) => (0, vec![p.to_string()]),
            _ => (0, vec![]),
        }
    }

    /// Which IDs an `ID` means: by the word before it, else by the command.
    fn ids(&self, before: &str) -> &[String] {
        let known = self.known;
        let by = |word: &str| match word {
            "region" | "union" | "intersect" if self.command == "region" => Some(&known.regions),
            "region" => Some(&known.regions),
            "group" | "union" | "intersect" | "subtract" => Some(&known.groups),
            "material" => Some(&known.materials),
            "fix" | "unfix" | "fix_modify" => Some(&known.fixes),
            "compute" | "uncompute" | "compute_modify" => Some(&known.computes),
            "dump" | "undump" | "dump_modify" => Some(&known.dumps),
            _ => None,
        };
        let last = self.typed.last().copied().unwrap_or_default();
        by(last).or_else(|| by(before)).or_else(|| by(self.command)).map_or(&[], Vec::as_slice)
    }
}

/// `v_…`, `c_…`, `f_…` and `${…` inside a word: where the name begins, and the names.
fn references(word: &str, known: &Known) -> Option<(usize, Vec<String>)> {
    if let Some(k) = word.rfind("${").filter(|k| !word[*k..].contains('}')) {
        return Some((k, known.variables.iter().map(|v| format!("${{{v}}}")).collect()));
    }
    let start = word.rfind(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).map_or(0, |k| k + 1);
    let names = match word.get(start..start + 2)? {
        "v_" => &known.variables,
        "c_" | "C_" => &known.computes,
        "f_" | "F_" => &known.fixes,
        _ => return None,
    };
    let letter = &word[start..start + 2];
    Some((start, names.iter().map(|n| format!("{letter}{n}")).collect()))
}

/// All values that have a name: `c_ID f_ID v_name`.
fn values(known: &Known) -> Vec<String> {
    let of =
        |letter: &str, names: &[String]| names.iter().map(|n| format!("{letter}_{n}")).collect::<Vec<_>>();
    [of("c", &known.computes), of("f", &known.fixes), of("v", &known.variables)].concat()
}

/// Pages of the manual: titles' first or second words.
fn help_names(words: &[&str]) -> Vec<String> {
    match words {
        [] => pages()
            .iter()
            .map(|p| if p.kind == "topic" || p.kind == "command" { p.name } else { p.kind }.into())
            .collect(),
        [kind] => owned(knowing::styles(kind)),
        _ => vec![],
    }
}

/// Files below the folder that a word begins to name; folders end with `/`.
fn files(word: &str, folder: &Path) -> (usize, Vec<String>) {
    let cut = word.rfind('/').map_or(0, |k| k + 1);
    let entries = std::fs::read_dir(folder.join(&word[..cut])).into_iter().flatten().flatten();
    let name = |e: std::fs::DirEntry| {
        let name = e.file_name().to_string_lossy().into_owned();
        if e.path().is_dir() { name + "/" } else { name }
    };
    let shown = |n: &String| !n.starts_with('.') && !n.contains(char::is_whitespace);
    (cut, entries.map(name).filter(shown).collect())
}

fn owned(names: Vec<&str>) -> Vec<String> {
    names.into_iter().map(String::from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(names: &[&str]) -> Vec<String> {
        names.iter().map(|n| (*n).to_string()).collect()
    }

    fn known() -> Known {
        Known {
            groups: list(&["all", "ball", "bullet"]),
            regions: list(&["block", "notch"]),
            fixes: list(&["motion"]),
            computes: list(&["dmg", "worst"]),
            dumps: list(&["pictures"]),
            variables: list(&["speed", "spacing"]),
            materials: list(&["glass"]),
            pair: Some("peri/pmb".into()),
        }
    }

    #[track_caller]
    fn check(line: &str, wanted: &[&str]) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("in.plate"), "").unwrap();
        std::fs::create_dir(folder.path().join("runs")).unwrap();
        std::fs::write(folder.path().join("runs/a.png"), "").unwrap();
        let (start, found) = complete(line, &known(), folder.path());
        let found: Vec<String> = found.iter().map(|c| format!("{}{c}", &line[..start])).collect();
        assert_eq!(found, wanted, "{line}");
    }

    #[test]
    fn commands_and_styles() {
        check("pair_sty", &["pair_style"]);
        check(":pl", &[":plan", ":plot"]);
        let solids = ["peri/pmb", "peri/pmb/plastic", "peri/pmb/softening"];
        check(
            "pair_style peri/pm",
            &solids.map(|style| format!("pair_style {style}")).each_ref().map(|s| &**s),
        );
        check("fix 1 all nve/sph", &["fix 1 all nve/sphere"]);
        check("compute d all dam", &["compute d all damage/atom"]);
        check("dump d all im", &["dump d all image"]);
        check("atom_style hyb", &["atom_style hybrid"]);
    }

    #[test]
    fn names_of_the_session() {
        check("fix 1 b", &["fix 1 ball", "fix 1 bullet"]);
        check("unfix m", &["unfix motion"]);
        check("uncompute ", &["uncompute dmg", "uncompute worst"]);
        check("create_atoms 1 region n", &["create_atoms 1 region notch"]);
        check("delete_atoms group bu", &["delete_atoms group bullet"]);
        check("thermo_style custom step c_d", &["thermo_style custom step c_dmg"]);
        check("print \"v = ${spe", &["print \"v = ${speed}"]);
        check(
            "variable e equal 0.5*v_sp",
            &["variable e equal 0.5*v_spacing", "variable e equal 0.5*v_speed"],
        );
        check("velocity ball se", &["velocity ball set"]);
    }

    #[test]
    fn keywords_and_alternatives() {
        check("region a block 0 1 0 1 0 1 si", &["region a block 0 1 0 1 0 1 side"]);
        check(
            "region a block 0 1 0 1 0 1 units ",
            &["region a block 0 1 0 1 0 1 units box", "region a block 0 1 0 1 0 1 units lattice"],
        );
        check("set group all diam", &["set group all diameter"]);
        check("run 100 pos", &["run 100 post"]);
        check("run 100 &\n  upt", &["run 100 &\n  upto"]);
        check("thermo_style custom st", &["thermo_style custom step"]);
    }

    #[test]
    fn files_and_pages() {
        check("include in", &["include in.plate"]);
        check(":show runs/", &[":show runs/a.png"]);
        check(":show r", &[":show runs/"]);
        check("help pair_style granu", &["help pair_style granular"]);
        check("no_such_command x", &[]);
    }
}
