//! Where a deck's text defines, uses and deletes names: groups, fixes, variables and their like.

use crate::manual::knowing;
use perigrain_base::diag::FileId;
use perigrain_lang::{RawLine, Word, raw_lines, raw_words};
use std::ops::Range;

pub use crate::manual::knowing::Named as Kind;

/// What a line does with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Brings it into being.
    Defines,
    /// Means what has it.
    Uses,
    /// Takes it away.
    Deletes,
}

/// A name in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mention {
    /// What has the name.
    pub kind: Kind,
    /// The name.
    pub name: String,
    /// Where it stands, without `v_` and the like.
    pub bytes: Range<usize>,
    /// What becomes of it.
    pub role: Role,
}

/// The lines of a text and the names that stand where names always stand.
#[derive(Clone, Debug, Default)]
pub struct Index {
    /// All lines with something in them.
    pub lines: Vec<RawLine>,
    /// By place.
    pub mentions: Vec<Mention>,
}

/// Functions of formulas whose first argument is a group, and which argument may be a region.
const OF_GROUPS: [(&str, usize); 15] = [
    ("count", 1),
    ("mass", 1),
    ("charge", 1),
    ("xcm", 2),
    ("vcm", 2),
    ("fcm", 2),
    ("bound", 2),
    ("gyration", 1),
    ("ke", 1),
    ("angmom", 2),
    ("torque", 2),
    ("inertia", 2),
    ("omega", 2),
    ("gmask", 9),
    ("grmask", 1),
];

/// Commands whose quoted words are texts to be shown: `v_x` means nothing there outside of `$(…)`.
const SHOWS: [&str; 4] = ["print", "echo", "shell", "label"];

/// Formulas within formulas are followed so far.
const DEEPEST: usize = 20;

fn shows(words: &[Word]) -> bool {
    let is = |k: usize, texts: &[&str]| words.get(k).is_some_and(|w| texts.contains(&w.text.as_str()));
    is(0, &SHOWS) || (is(0, &["fix"]) && is(3, &["print"]))
}

/// The byte range of a word, if it stands in the text as it is.
pub fn bytes(word: &Word) -> Option<Range<usize>> {
    let range = word.span.start as usize..word.span.end as usize;
    (range.len() == word.text.len()).then_some(range)
}

/// The commands of a line: its own, then those in quotes behind `then`, `else` and `every`.
pub fn commands(line: &RawLine) -> Vec<Vec<Word>> {
    let mut all = vec![line.words.clone()];
    let carries = match line.words.first().map(|w| w.text.as_str()) {
        Some("if") => ["then", "else"].as_slice(),
        Some("run") => ["every"].as_slice(),
        _ => return all,
    };
    let begins = line.words.iter().position(|w| carries.contains(&w.text.as_str()));
    let words = begins.map_or(&[][..], |k| &line.words[k + 1..]);
    all.extend(words.iter().filter(|w| w.quoted).map(raw_words).filter(|words| !words.is_empty()));
    all
}

impl Index {
    /// Looks a text through.
    pub fn of(text: &str) -> Self {
        let lines = raw_lines(text, FileId(0));
        let mut mentions = vec![];
        for line in &lines {
            for words in commands(line) {
                named_by_place(&words, &mut mentions);
            }
            let shows = shows(&line.words);
            for word in &line.words {
                let range = word.span.start as usize..word.span.end as usize;
                let shows = shows || (word.quoted && self::shows(&raw_words(word)));
                references(&text[range.clone()], range.start, (!shows, 0), &mut mentions);
            }
        }
        mentions.sort_by_key(|m| (m.bytes.start, m.bytes.end));
        mentions.dedup_by_key(|m| m.bytes.clone());
        Self { lines, mentions }
    }

    /// The line at a byte.
    pub fn line_at(&self, byte: usize) -> Option<&RawLine> {
        let k = self.lines.partition_point(|line| line.span.start as usize <= byte);
        self.lines[..k].last().filter(|line| byte <= line.span.end as usize)
    }

    /// The words of the innermost command at a byte, and the number of the word there.
    pub fn word_at(&self, byte: usize) -> Option<(Vec<Word>, usize)> {
        let holds = |w: &Word| (w.span.start as usize..=w.span.end as usize).contains(&byte);
        let line = self.line_at(byte)?;
        commands(line).into_iter().rev().find_map(|words| {
            let k = words.iter().position(holds)?;
            Some((words, k))
        })
    }

    /// The name at a byte, where names always stand or where the manual has one.
    pub fn at(&self, byte: usize) -> Option<Mention> {
        let here = self.mentions.iter().find(|m| (m.bytes.start..=m.bytes.end).contains(&byte));
        if let Some(mention) = here {
            return Some(mention.clone());
        }
        let (words, k) = self.word_at(byte)?;
        in_slot(&words, k)
    }

    /// All places of a name.
    pub fn places(&self, kind: Kind, name: &str) -> Vec<Mention> {
        let mut all: Vec<Mention> =
            self.mentions.iter().filter(|m| m.kind == kind && m.name == name).cloned().collect();
        for words in self.lines.iter().flat_map(commands) {
            for k in 1..words.len() {
                let Some(range) = bytes(&words[k]).filter(|_| words[k].text == name) else { continue };
                let known = self.mentions.iter().any(|m| m.bytes == range);
                all.extend(in_slot(&words, k).filter(|m| !known && m.kind == kind));
            }
        }
        all.sort_by_key(|m| m.bytes.start);
        all.dedup();
        all
    }
}

/// The name that the manual's syntax has at a word.
fn in_slot(words: &[Word], k: usize) -> Option<Mention> {
    let word = words.get(k).filter(|w| k > 0 && !w.text.contains('$'))?;
    let typed: Vec<&str> = words.iter().map(|w| w.text.as_str()).collect();
    let kind = knowing::named(&typed, k)?;
    Some(Mention { kind, name: word.text.clone(), bytes: bytes(word)?, role: Role::Uses })
}

/// Names that a command has at fixed places.
fn named_by_place(words: &[Word], out: &mut Vec<Mention>) {
    let text = |k: usize| words.get(k).map_or("", |w| w.text.as_str());
    let mut add = |k: usize, kind: Kind, role: Role| {
        let Some(word) = words.get(k).filter(|w| !w.text.contains('$') && !w.text.is_empty()) else { return };
        let Some(bytes) = bytes(word) else { return };
        out.push(Mention { kind, name: word.text.clone(), bytes, role });
    };
    let third = text(2);
    let unless_deleted = if third == "delete" { Role::Deletes } else { Role::Defines };
    let of_style = |kind| match kind {
        "fix" => Kind::Fix,
        "compute" => Kind::Compute,
        _ => Kind::Dump,
    };
    match text(0) {
        kind @ ("fix" | "compute" | "dump") => {
            add(1, of_style(kind), Role::Defines);
            add(2, Kind::Group, Role::Uses);
        }
        "unfix" => add(1, Kind::Fix, Role::Deletes),
        "uncompute" => add(1, Kind::Compute, Role::Deletes),
        "undump" => add(1, Kind::Dump, Role::Deletes),
        "fix_modify" => add(1, Kind::Fix, Role::Uses),
        "compute_modify" => add(1, Kind::Compute, Role::Uses),
        "dump_modify" => add(1, Kind::Dump, Role::Uses),
        "group" => add(1, Kind::Group, if third == "clear" { Role::Uses } else { unless_deleted }),
        "region" => add(1, Kind::Region, unless_deleted),
        "variable" => add(1, Kind::Variable, unless_deleted),
        "next" => (1..words.len()).for_each(|k| add(k, Kind::Variable, Role::Uses)),
        "sweep" => {
            for k in 2..words.len() {
                match text(k - 1) {
                    "each" => add(k, Kind::Variable, Role::Defines),
                    "zip" => add(k, Kind::Variable, Role::Uses),
                    _ => {}
                }
            }
        }
        "material" => add(1, Kind::Material, Role::Defines),
        "molecule" | "clump" => add(1, Kind::Molecule, Role::Defines),
        "label" => add(1, Kind::Label, Role::Defines),
        "include" => add(1, Kind::File, Role::Uses),
        "jump" => {
            if text(1) != "SELF" {
                add(1, Kind::File, Role::Uses);
            }
            add(2, Kind::Label, Role::Uses);
        }
        "velocity" | "displace_atoms" => add(1, Kind::Group, Role::Uses),
        _ => {}
    }
}

fn is_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// `${name}`, `$x`, and in formulas `v_name`, `c_ID`, `f_ID` and groups of functions; `base` is the byte at which the text begins.
fn references(text: &str, base: usize, (formula, depth): (bool, usize), out: &mut Vec<Mention>) {
    let mut add = |kind, range: Range<usize>| {
        let name = text[range.clone()].to_string();
        out.push(Mention { kind, name, bytes: base + range.start..base + range.end, role: Role::Uses });
    };
    let mut inner: Vec<Range<usize>> = vec![];
    let mut functions = vec![];
    let mut k = 0;
    while let Some(c) = text[k..].chars().next() {
        let rest = &text[k + c.len_utf8()..];
        if c == '$' {
            if let Some(name) = rest.strip_prefix('{').and_then(|r| r.split_once('}')).map(|r| r.0) {
                if !name.is_empty() && name.chars().all(is_name) {
                    add(Kind::Variable, k + 2..k + 2 + name.len());
                }
                k += 3 + name.len();
            } else if let Some(formula) = rest.strip_prefix('(') {
                let end = k + 2 + closing(formula);
                inner.push(k + 2..end);
                k = end;
            } else {
                let name = rest.chars().next().filter(|c| is_name(*c));
                name.iter().for_each(|_| add(Kind::Variable, k + 1..k + 2));
                k += 1 + rest.chars().next().filter(|c| *c != '$').map_or(0, char::len_utf8);
            }
            continue;
        }
        if !is_name(c) {
            k += c.len_utf8();
            continue;
        }
        let end = k + text[k..].find(|c| !is_name(c)).unwrap_or(text.len() - k);
        let (word, behind) = (&text[k..end], text[end..].chars().next());
        let kind = match word.get(..2) {
            Some("v_") => Some(Kind::Variable),
            Some("c_" | "C_") => Some(Kind::Compute),
            Some("f_" | "F_") => Some(Kind::Fix),
            _ => None,
        };
        if let Some(kind) = kind.filter(|_| formula && word.len() > 2 && behind != Some('$')) {
            add(kind, k + 2..end);
        } else if formula && behind == Some('(') {
            functions.extend(arguments(&text[end + 1..]).map(|n| (word, end + 1..end + 1 + n)));
        }
        k = end;
    }
    for (function, arguments) in functions {
        for (kind, range) in named_arguments(function, &text[arguments.clone()]) {
            add(kind, arguments.start + range.start..arguments.start + range.end);
        }
    }
    for range in inner.into_iter().filter(|_| depth < DEEPEST) {
        references(&text[range.clone()], base + range.start, (true, depth + 1), out);
    }
}

/// How long the arguments of a function are, if they are names: no parenthesis stands in them.
fn arguments(text: &str) -> Option<usize> {
    text.find(['(', ')', '\n']).filter(|k| text[*k..].starts_with(')'))
}

/// The byte of the parenthesis that closes, or the end.
fn closing(text: &str) -> usize {
    let mut depth = 0_usize;
    for (k, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' if depth == 0 => return k,
            ')' => depth -= 1,
            _ => {}
        }
    }
    text.len()
}

/// Groups, regions and variables among a function's arguments.
fn named_arguments(function: &str, arguments: &str) -> Vec<(Kind, Range<usize>)> {
    let kind = |k: usize| match function {
        "rmask" => (k == 0).then_some(Kind::Region),
        "next" => (k == 0).then_some(Kind::Variable),
        _ => {
            let (_, region) = OF_GROUPS.iter().find(|(name, _)| *name == function)?;
            match k {
                0 => Some(Kind::Group),
                k if k == *region => Some(Kind::Region),
                _ => None,
            }
        }
    };
    let (mut at, mut out) = (0, vec![]);
    for (k, argument) in arguments.split(',').enumerate() {
        let name = argument.trim();
        let start = at + argument.len() - argument.trim_start().len();
        if let Some(kind) = kind(k).filter(|_| !name.is_empty() && name.chars().all(is_name)) {
            out.push((kind, start..start + name.len()));
        }
        at += argument.len() + 1;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Vec<String> {
        let index = Index::of(text);
        let show = |m: &Mention| {
            assert_eq!(&text[m.bytes.clone()], m.name);
            let sign = match m.role {
                Role::Defines => "=",
                Role::Uses => "",
                Role::Deletes => "-",
            };
            format!("{sign}{} {}", m.kind.word(), m.name)
        };
        index.mentions.iter().map(show).collect()
    }

    #[test]
    fn names_at_their_places() {
        assert_eq!(found("fix a all nve\nunfix a"), ["=fix a", "group all", "-fix a"]);
        assert_eq!(
            found("variable v equal c_k[1]+$x*${long}"),
            ["=variable v", "compute k", "variable x", "variable long"]
        );
        assert_eq!(
            found("variable m equal mass(all,r)+xcm(g,z)"),
            ["=variable m", "group all", "region r", "group g"]
        );
        assert_eq!(
            found("print \"v_a $(v_b) ${c}\""),
            ["variable c", "variable b"].map(String::from).into_iter().rev().collect::<Vec<_>>()
        );
        assert_eq!(
            found("if \"$i > 1\" then \"unfix a\" 'jump SELF x'"),
            ["variable i", "-fix a", "label x"]
        );
        assert_eq!(found("sweep each v 1 2 zip w"), ["=variable v", "variable w"]);
        assert_eq!(found("fix p all print 1 \"v_x ${y}\""), ["=fix p", "group all", "variable y"]);
        assert_eq!(found("fix f$i all nve # v_x"), ["variable i", "group all"]);
        assert_eq!(found("jump in.b x\ninclude c"), ["file in.b", "label x", "file c"]);
    }

    #[test]
    fn names_that_the_manual_knows() {
        let text = "region r block 0 1 0 1 0 1\ncreate_atoms 1 region r\nset group all type 1\n";
        let index = Index::of(text);
        let places = index.places(Kind::Region, "r");
        assert_eq!(
            places.iter().map(|m| m.bytes.start).collect::<Vec<_>>(),
            [7, text.find("r\nset").unwrap()]
        );
        let at = text.find("all").unwrap() + 1;
        assert_eq!(index.at(at).unwrap().kind, Kind::Group);
        assert_eq!(index.at(0), None);
    }
}
