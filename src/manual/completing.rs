//! Completion at the prompt and in editors: what may stand at the cursor, from the syntax line and the names that exist.

use super::knowing::{self, COLON, Named};
use super::pages;
use super::syntax::is_word;
use super::walk::Offer;
use crate::graph::measure;
use crate::session::Known;
use perigrain_base::gate;
use perigrain_output::image::{MAPS, colour_names};
use perigrain_styles::words::Kind;
use std::path::Path;

/// What a candidate is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum What {
    /// A command of decks.
    Command,
    /// A command of the prompt.
    Prompt,
    /// A style of the line's command.
    Style,
    /// A word of the syntax line.
    Keyword,
    /// A name.
    Named(Named),
    /// A column of a step table.
    Column,
    /// An attribute of particles.
    Attribute,
    /// A file or folder.
    File,
    /// A colour or a map of colours.
    Colour,
    /// A page of the manual.
    Page,
}

/// What a word may become.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Candidate {
    /// The word, or what is left of it behind the part that stays.
    pub text: String,
    /// What it is.
    pub what: What,
}

/// The byte at which the word before the cursor begins, and what it may become, sorted.
pub fn complete(line: &str, known: &Known, folder: &Path) -> (usize, Vec<String>) {
    for (habit, means) in HABITS {
        if let Some(rest) = line.strip_prefix(habit) {
            let (start, all) = complete(&(means.to_string() + rest), known, folder);
            return (start + habit.len() - means.len(), all);
        }
    }
    let (start, all) = candidates(line, known, folder);
    let mut all: Vec<String> = all.into_iter().map(|c| c.text).collect();
    all.dedup();
    (start, all)
}

/// What stands before a line at the prompt, and what is completed in its place.
const HABITS: [(&str, &str); 2] = [("%time ", ""), ("?", "help ")];

/// As [`complete`], with the kind of each candidate.
pub fn candidates(line: &str, known: &Known, folder: &Path) -> (usize, Vec<Candidate>) {
    let start = line
        .rfind(|c: char| c.is_whitespace() || c == '"' || c == '\'')
        .map_or(0, |k| k + line[k..].chars().next().map_or(1, char::len_utf8));
    let (before, word) = (last_line(&line[..start]), &line[start..]);
    let typed: Vec<&str> = before.split_whitespace().filter(|w| *w != "&").collect();
    let (skip, mut all) = possible(&typed, word, known, folder);
    let part = &word[skip..];
    all.retain(|c| c.text.starts_with(part) && c.text != part);
    all.sort();
    all.dedup_by(|a, b| a.text == b.text);
    all.sort_by(|a, b| a.text.cmp(&b.text));
    (start + skip, all)
}

/// The last logical line: behind the last line break that no `&` joins.
fn last_line(text: &str) -> &str {
    let end = text.match_indices('\n').rfind(|(k, _)| !text[..*k].trim_end().ends_with('&'));
    &text[end.map_or(0, |(k, _)| k + 1)..]
}

/// How much of the word stays as it is, and what the rest of it may become.
fn possible(typed: &[&str], word: &str, known: &Known, folder: &Path) -> (usize, Vec<Candidate>) {
    if let Some((skip, names)) = references(word, known) {
        return (skip, names);
    }
    let Some(&command) = typed.first() else {
        let own = COLON.iter().map(|c| c.0).chain(["help"]);
        let commands = knowing::commands().iter().copied();
        return (0, [of(What::Command, commands), of(What::Prompt, own)].concat());
    };
    if word.contains('/') && Path::new(word).parent().is_some_and(|p| folder.join(p).is_dir()) {
        return files(word, folder);
    }
    match (command, typed.len()) {
        ("help", _) => return (0, help_names(&typed[1..])),
        (":show" | ":save" | ":graph" | "include" | "jump", 1) => {
            let (skip, mut all) = files(word, folder);
            all.extend(of(What::Keyword, (command == "jump").then_some("SELF")));
            return (skip, all);
        }
        (":plot", _) => return (0, [of(What::Column, knowing::thermo()), values(known)].concat()),
        (":slice", 1) => return (0, [of(What::Attribute, ATTRIBUTES), values(known)].concat()),
        (":slice", 2) => return (0, of(What::Keyword, ["x", "y", "z"])),
        ("dump" | "dump_modify" | "write_dump", k) if k > 2 => match typed[k - 2..] {
            [_, "backcolor" | "backcolor2" | "boxcolor"] | ["acolor", _] => {
                return (0, of(What::Colour, colour_names()));
            }
            [_, "map"] => return (0, of(What::Colour, MAPS.iter().map(|map| map.name))),
            _ => {}
        },
        _ => {}
    }
    let Some(places) = knowing::places(typed, known) else { return (0, vec![]) };
    let slot = Slot { command, typed, known, folder, word };
    let (mut out, mut skip) = (vec![], 0);
    for offer in places.iter().flat_map(|place| &place.offers) {
        let (s, mut names) = slot.offered(offer);
        skip = skip.max(s);
        out.append(&mut names);
    }
    for place in places.iter().filter(|place| place.offers.is_empty()) {
        for here in &place.here {
            for one in here.trim_end_matches('…').split('|') {
                let (s, mut names) = slot.names(one, &place.before);
                skip = skip.max(s);
                out.append(&mut names);
            }
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
    known: &'a Known,
    folder: &'a Path,
    word: &'a str,
}

impl Slot<'_> {
    /// What a declared word may become.
    fn offered(&self, offer: &Offer) -> (usize, Vec<Candidate>) {
        let place = match offer {
            Offer::Word(word, _) => return (0, of(What::Keyword, [*word])),
            Offer::Place(place) => place,
        };
        let named = |kind: Named| {
            let mut known = self.known.clone();
            let names = kind.list(&mut known).map(std::mem::take).unwrap_or_default();
            (0, names.into_iter().map(|text| Candidate { text, what: What::Named(kind) }).collect())
        };
        match place.kind {
            Kind::File => self.files(),
            Kind::Value => (0, values(self.known)),
            Kind::Column => (0, [of(What::Column, knowing::thermo()), values(self.known)].concat()),
            Kind::Style(command) => (0, of(What::Style, knowing::styles(command))),
            Kind::Attribute => (0, [of(What::Attribute, ATTRIBUTES), values(self.known)].concat()),
            Kind::Param | Kind::Reference => {
                (0, values(self.known).into_iter().filter(|c| c.text.starts_with('v')).collect())
            }
            kind => Named::of_kind(kind).map_or((0, vec![]), named),
        }
    }

    /// The files there are, and for a material those built in.
    fn files(&self) -> (usize, Vec<Candidate>) {
        let (skip, mut all) = files(self.word, self.folder);
        if self.command == "material" {
            all.extend(of(What::File, perigrain_world::potentials::EMBEDDED.iter().map(|(name, _)| *name)));
        }
        (skip, all)
    }

    /// What a placeholder may become, `before` being the word of the syntax line before it.
    fn names(&self, placeholder: &str, before: &str) -> (usize, Vec<Candidate>) {
        let last = self.typed.last().copied().unwrap_or_default();
        match (Named::of(placeholder, before, last, self.command), placeholder) {
            (_, "file") if self.command == "material" => (0, of(What::Keyword, ["file"])),
            (Some(Named::File), _) => self.files(),
            (Some(kind), _) => {
                let mut known = self.known.clone();
                let names = kind.list(&mut known).map(std::mem::take).unwrap_or_default();
                (0, names.into_iter().map(|text| Candidate { text, what: What::Named(kind) }).collect())
            }
            (_, "STYLE" | "style") => (0, of(What::Style, knowing::styles(self.command))),
            (_, "attribute") => (0, [of(What::Attribute, ATTRIBUTES), values(self.known)].concat()),
            (_, "input" | "value") => (0, values(self.known)),
            (_, "NULL") => (0, of(What::Keyword, ["NULL"])),
            (_, "c_ID") => (0, values(self.known).into_iter().filter(|c| c.text.starts_with('c')).collect()),
            (_, "f_ID") => (0, values(self.known).into_iter().filter(|c| c.text.starts_with('f')).collect()),
            (_, p) if p.starts_with("v_") => {
                (0, values(self.known).into_iter().filter(|c| c.text.starts_with('v')).collect())
            }
            (_, p) if is_word(p) => (0, of(What::Keyword, [p])),
            _ => (0, vec![]),
        }
    }
}

/// `v_…`, `c_…`, `f_…` and `${…` inside a word: where the name begins, and the names.
fn references(word: &str, known: &Known) -> Option<(usize, Vec<Candidate>)> {
    let named = |kind, text| Candidate { text, what: What::Named(kind) };
    if let Some(k) = word.rfind("${").filter(|k| !word[*k..].contains('}')) {
        let names = known.variables.iter().map(|v| named(Named::Variable, format!("${{{v}}}")));
        return Some((k, names.collect()));
    }
    if let Some((function, group)) =
        word.rsplit_once('(').filter(|(_, group)| group.chars().all(part_of_name))
        && measure::NAMES.contains(&function.rsplit(|c| !part_of_name(c)).next().unwrap_or_default())
        && !["c_", "f_", "v_"].iter().any(|letter| group.starts_with(letter))
    {
        let names = known.groups.iter().map(|name| named(Named::Group, name.clone()));
        return Some((function.len() + 1, names.collect()));
    }
    let begins = |k: usize| k + word[k..].chars().next().map_or(1, char::len_utf8);
    let start = word.rfind(|c| !part_of_name(c)).map_or(0, begins);
    let (kind, names) = match word.get(start..start + 2)? {
        "v_" => (Named::Variable, &known.variables),
        "c_" | "C_" => (Named::Compute, &known.computes),
        "f_" | "F_" => (Named::Fix, &known.fixes),
        _ => return None,
    };
    let letter = &word[start..start + 2];
    Some((start, names.iter().map(|n| named(kind, format!("{letter}{n}"))).collect()))
}

fn part_of_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// All values that have a name: `c_ID f_ID v_name`.
fn values(known: &Known) -> Vec<Candidate> {
    let of = |letter: &str, kind, names: &[String]| {
        let named = |n: &String| Candidate { text: format!("{letter}_{n}"), what: What::Named(kind) };
        names.iter().map(named).collect::<Vec<_>>()
    };
    [
        of("c", Named::Compute, &known.computes),
        of("f", Named::Fix, &known.fixes),
        of("v", Named::Variable, &known.variables),
    ]
    .concat()
}

/// Pages of the manual: titles' first or second words.
fn help_names(words: &[&str]) -> Vec<Candidate> {
    match words {
        [] => {
            let first =
                |p: &super::Page| if p.kind == "topic" || p.kind == "command" { p.name } else { p.kind };
            of(What::Page, pages().iter().map(first))
        }
        [kind] => of(What::Page, knowing::styles(kind)),
        _ => vec![],
    }
}

/// Files below the folder that a word begins to name; folders end with `/`.
fn files(word: &str, folder: &Path) -> (usize, Vec<Candidate>) {
    let cut = word.rfind('/').map_or(0, |k| k + 1);
    let folder = folder.join(&word[..cut]);
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
    let entries = gate::list(folder).into_iter().flatten().flatten();
    let name = |e: std::fs::DirEntry| {
        let name = e.file_name().to_string_lossy().into_owned();
        if e.path().is_dir() { name + "/" } else { name }
    };
    let shown = |n: &String| !n.starts_with('.') && !n.contains(char::is_whitespace);
    let names = entries.map(name).filter(shown);
    (cut, names.map(|text| Candidate { text, what: What::File }).collect())
}

fn of<'a>(what: What, names: impl IntoIterator<Item = &'a str>) -> Vec<Candidate> {
    names.into_iter().map(|name| Candidate { text: name.to_string(), what }).collect()
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
            labels: list(&["loop"]),
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
        check("variable e equal 2*vcm(bu", &["variable e equal 2*vcm(bullet"]);
        check("variable e equal vcm(ball,c_d", &["variable e equal vcm(ball,c_dmg"]);
        check("%time unfix m", &["%time unfix motion"]);
        check("?pair_style granu", &["?pair_style granular"]);
        check("?pair_sty", &["?pair_style"]);
        check(
            "variable e equal 0.5*v_sp",
            &["variable e equal 0.5*v_spacing", "variable e equal 0.5*v_speed"],
        );
        check("velocity ball se", &["velocity ball set"]);
        check("jump SELF l", &["jump SELF loop"]);
        check("dump_modify pictures acolor 1 gol", &["dump_modify pictures acolor 1 gold"]);
        check(
            "dump d all image 1 a.png type auto map vir",
            &["dump d all image 1 a.png type auto map viridis"],
        );
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
    fn what_the_syntax_wants_is_offered_wherever_it_stands() {
        check("material m f", &["material m file", "material m ft"]);
        check("material m file alu", &["material m file alumina.toml"]);
        check("region r block I", &["region r block INF"]);
        check("region r block INF E", &["region r block INF EDGE"]);
        check("region r cylinder z 0 0 1 E", &["region r cylinder z 0 0 1 EDGE"]);
        check(
            "fix w all wall/gran/region granular hooke 1 0.5 region n",
            &["fix w all wall/gran/region granular hooke 1 0.5 region notch"],
        );
        check("fix w all wall/gran hooke 1 NULL 1 NULL 0.5 0 zplane h", &[]);
        check("compute c all erotate/rigid m", &["compute c all erotate/rigid motion"]);
        check("compute c all com/chunk d", &["compute c all com/chunk dmg"]);
        check(
            "dump d all image 1 a.png type type backcolor",
            &["dump d all image 1 a.png type type backcolor2"],
        );
        check("group g region b", &["group g region block"]);
        check("create_atoms 1 random 10 4711 NU", &["create_atoms 1 random 10 4711 NULL"]);
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
