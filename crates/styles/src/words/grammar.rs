//! Declared words as data, and as the line and the table that the manual shows.

use std::fmt::Write;

/// What a word is, as far as readers of the manual and editors care.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number.
    Number,
    /// A whole number.
    Whole,
    /// A number or a variable.
    Param,
    /// `yes` or `no`.
    Switch,
    /// Any word.
    Text,
    /// A type or a range of types.
    Types,
    /// The ID of a group.
    Group,
    /// The ID of a region.
    Region,
    /// The ID of a compute.
    Compute,
    /// The ID of a fix.
    Fix,
    /// The ID of a dump.
    Dump,
    /// The name of a variable.
    Variable,
    /// The ID of a molecule.
    Molecule,
    /// The name of a material.
    Material,
    /// A file.
    File,
    /// A value of a compute, fix or variable: `c_ID`, `f_ID`, `v_name`.
    Value,
    /// An attribute of particles, or a value.
    Attribute,
    /// A variable with its `v_`.
    Reference,
    /// A column of the step table: a keyword or a value.
    Column,
    /// A style that this command takes.
    Style(&'static str),
    /// One of several words, each with words of its own behind it.
    Choice(&'static [Alternative]),
    /// The same, of which syntax lines show the name of the place.
    Models(&'static [Alternative]),
    /// Words in order and keywords.
    Words(&'static Grammar),
    /// This, or `NULL` for nothing.
    OrNull(&'static Kind),
    /// One of some words, or else something of the second kind.
    Or(&'static Kind, &'static Kind),
}

impl Kind {
    /// The words that may stand there.
    pub const fn choices(&self) -> &'static [Alternative] {
        match self {
            Self::Choice(all) | Self::Models(all) => all,
            Self::Or(words, _) => words.choices(),
            _ => &[],
        }
    }

    /// Whether a word is one of them.
    pub fn has(&self, text: &str) -> bool {
        self.choices().iter().any(|a| a.word == text)
    }
}

/// Syntax lines show the name of a place in which one of more words may stand, not these words.
const MANY: usize = 16;

/// The words of a table as choices, described by what the place says.
pub const fn alternatives<T, const N: usize>(rows: &[(&'static str, T); N]) -> [Alternative; N] {
    let mut all = [Alternative { word: "", about: "", parts: &[] }; N];
    let mut k = 0;
    while k < N {
        all[k].word = rows[k].0;
        k += 1;
    }
    all
}

/// A place for a word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placeholder {
    /// What stands for it in syntax lines.
    pub name: &'static str,
    /// What may stand there.
    pub kind: Kind,
    /// A sentence about it.
    pub about: &'static str,
    /// Its unit; empty without one.
    pub unit: &'static str,
}

/// One of several words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alternative {
    /// The word.
    pub word: &'static str,
    /// A sentence about it.
    pub about: &'static str,
    /// What stands behind it.
    pub parts: &'static [Part],
}

/// Something that stands in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    /// A word.
    Word(Placeholder),
    /// Words that may be left out.
    Maybe(&'static [Part]),
    /// Words of which there may be several, at least so many.
    Many(&'static [Part], usize),
    /// The words and keywords of another declaration.
    All(&'static Grammar),
}

/// A keyword.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyword {
    /// The word.
    pub word: &'static str,
    /// What stands behind it.
    pub values: &'static [Part],
    /// A sentence about it.
    pub about: &'static str,
    /// What holds without it; empty if its sentence says so, [`Keyword::NEEDED`] if it must stand there.
    pub default: &'static str,
    /// Each time that it stands there counts.
    pub repeats: bool,
}

/// The words of a line: parts in order, then keywords in any order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grammar {
    /// What stands in order.
    pub parts: &'static [Part],
    /// Keywords.
    pub keywords: &'static [Keyword],
    /// Keywords of LAMMPS that are refused by name.
    pub refused: &'static [&'static str],
}

/// A grammar with what stands before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form {
    /// What stands before, as `pair_coeff I J`; empty for what always stands before a style of this kind.
    pub head: &'static str,
    /// A sentence about this form of the line; empty if there is no other.
    pub about: &'static str,
    /// What stands behind.
    pub grammar: &'static Grammar,
}

/// The lines of a style.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Syntax {
    /// One line: words behind what always stands before a style of its kind, as `fix ID group viscous`.
    Behind(&'static Grammar),
    /// Several forms of the line, or lines of several commands.
    Forms(&'static [Form]),
    /// Lines written by hand, as `run N [upto] [pre no]`; irregular ones alone.
    Written(&'static str),
}

impl Syntax {
    /// The words behind a style's name, as far as they are declared.
    pub fn behind(&self) -> &'static Grammar {
        match self {
            Self::Behind(grammar) => grammar,
            Self::Forms(forms) => {
                forms.iter().find(|form| form.head.is_empty()).map_or(Grammar::NONE, |form| form.grammar)
            }
            Self::Written(_) => Grammar::NONE,
        }
    }
}

impl Form {
    /// Words behind what always stands before a style of its kind.
    pub const fn behind(grammar: &'static Grammar) -> Self {
        Self::headed("", grammar)
    }

    /// Words behind these.
    pub const fn headed(head: &'static str, grammar: &'static Grammar) -> Self {
        Self { head, about: "", grammar }
    }
}

impl Grammar {
    /// A line without words.
    pub const NONE: &'static Self = &Self { parts: &[], keywords: &[], refused: &[] };

    /// The declarations whose words stand here, this one first.
    fn nested(&'static self) -> Vec<&'static Self> {
        let mut all = vec![self];
        for part in self.parts {
            if let Part::All(grammar) = part {
                all.extend(grammar.nested());
            }
        }
        all
    }

    /// All keywords, those of nested declarations included.
    pub fn every(&'static self) -> Vec<&'static Keyword> {
        self.nested().iter().flat_map(|g| g.keywords).collect()
    }

    /// The same as words.
    pub fn keywords(&'static self) -> Vec<&'static str> {
        self.every().iter().map(|k| k.word).collect()
    }

    /// The words that may stand where those in order end: what may be left out there, more of a list, and keywords.
    pub fn known(&'static self) -> Vec<&'static str> {
        let mut known = self.keywords();
        for part in self.in_order().into_iter().rev() {
            let (Part::Maybe([Part::Word(word), ..]) | Part::Many([Part::Word(word), ..], _)) = part else {
                break;
            };
            known.splice(0..0, word.kind.choices().iter().map(|a| a.word));
        }
        known
    }

    /// Whether a word is a keyword of the line.
    pub fn has(&'static self, text: &str) -> bool {
        self.nested().iter().any(|g| g.keywords.iter().any(|k| k.word == text))
    }

    /// Whether a word is one of LAMMPS' keywords that are refused by name.
    pub fn refuses(&'static self, text: &str) -> bool {
        self.nested().iter().any(|g| g.refused.contains(&text))
    }

    /// What stands in order, nested declarations opened.
    pub fn in_order(&'static self) -> Vec<&'static Part> {
        let mut all = vec![];
        for part in self.parts {
            match part {
                Part::All(grammar) => all.extend(grammar.in_order()),
                _ => all.push(part),
            }
        }
        all
    }

    /// All keywords; neighbours that differ in their words alone together.
    fn together(&'static self) -> Vec<(String, &'static Keyword)> {
        let mut all: Vec<(String, &Keyword)> = vec![];
        for keyword in self.every() {
            let same = |other: &Keyword| {
                let described = !(other.values.is_empty() && other.about.is_empty());
                described && Keyword { word: keyword.word, ..*other } == *keyword
            };
            match all.last_mut() {
                Some((names, last)) if same(last) => *names = format!("{names}|{}", keyword.word),
                _ => all.push((keyword.word.to_string(), keyword)),
            }
        }
        all
    }

    /// The syntax line, without its head.
    pub fn line(&'static self) -> String {
        let mut words: Vec<String> = self.in_order().into_iter().map(|part| part.shown()).collect();
        for (names, keyword) in self.together() {
            let again = if keyword.repeats { "…" } else { "" };
            let shown = keyword.shown_as(&names);
            words.push(if keyword.needed() { shown } else { format!("[{shown}]{again}") });
        }
        words.join(" ")
    }

    /// The rows of the table: word, meaning, unit, default.
    fn rows(&'static self) -> Vec<[String; 4]> {
        let mut rows = vec![];
        for part in self.in_order() {
            part.rows(&mut rows);
        }
        for (names, keyword) in self.together() {
            let start = rows.len();
            rows.push([
                keyword.shown_as(&names),
                keyword.about.into(),
                keyword.unit().into(),
                keyword.default.into(),
            ]);
            keyword.values.iter().for_each(|part| part.choices(&names, &mut rows));
            // What each choice means says what the keyword is about.
            if keyword.about.is_empty() && rows.len() > start + 1 {
                rows.remove(start);
                rows[start][3] = keyword.default.into();
            }
        }
        rows
    }
}

impl Form {
    /// The table of the words of all forms of a line as Markdown; empty where no word has a sentence.
    pub fn table(forms: &[Self]) -> String {
        let mut rows: Vec<[String; 4]> = vec![];
        for form in forms {
            let own = [form.short(), form.about.into(), String::new(), String::new()];
            for row in std::iter::once(own).chain(form.grammar.rows()) {
                join(&mut rows, row);
            }
        }
        rows.retain(|[_, about, ..]| !about.is_empty());
        if rows.is_empty() {
            return String::new();
        }
        let used = |column: usize| rows.iter().any(|row| !row[column].is_empty());
        let columns: Vec<usize> = (0..4).filter(|&c| c < 2 || used(c)).collect();
        let heads = ["word", "meaning", "unit", "default"];
        let mut table = String::new();
        let mut line = |cells: Vec<String>| {
            let _ = writeln!(table, "| {} |", cells.join(" | "));
        };
        line(columns.iter().map(|&c| heads[c].to_string()).collect());
        line(columns.iter().map(|_| "---".to_string()).collect());
        for row in &rows {
            let cell = |&c: &usize| match c {
                0 => format!("`{}`", row[0].replace('|', "\\|")),
                _ => row[c].replace('|', "\\|"),
            };
            line(columns.iter().map(cell).collect());
        }
        table
    }

    /// The word that chooses this form, and what stands in order behind it.
    fn short(&self) -> String {
        let word = self.head.split(' ').next_back().unwrap_or_default();
        let parts = self.grammar.in_order().into_iter().map(Part::shown);
        std::iter::once(word.to_string()).chain(parts).collect::<Vec<_>>().join(" ")
    }
}

impl Keyword {
    /// The default of a keyword that must stand there.
    pub const NEEDED: &'static str = "required";

    /// Whether it must stand there.
    pub fn needed(&self) -> bool {
        self.default == Self::NEEDED
    }

    /// The keyword with what stands behind it.
    pub fn shown(&self) -> String {
        self.shown_as(self.word)
    }

    /// The same in brackets, unless it must stand there.
    pub fn bracketed(&self) -> String {
        if self.needed() { self.shown() } else { format!("[{}]", self.shown()) }
    }

    /// The same by another name.
    fn shown_as(&self, name: &str) -> String {
        let values = self.values.iter().map(Part::shown).filter(|shown| !shown.is_empty());
        std::iter::once(name.to_string()).chain(values).collect::<Vec<_>>().join(" ")
    }

    fn unit(&self) -> &'static str {
        self.values.iter().map(Part::unit).find(|unit| !unit.is_empty()).unwrap_or_default()
    }
}

impl Part {
    /// A word without a sentence about it.
    pub const fn bare(name: &'static str, kind: Kind) -> Self {
        Self::Word(Placeholder { name, kind, about: "", unit: "" })
    }

    /// A number without a sentence about it.
    pub const fn number(name: &'static str) -> Self {
        Self::bare(name, Kind::Number)
    }

    /// As it stands in a syntax line.
    pub fn shown(&self) -> String {
        let all = |parts: &[Part]| parts.iter().map(Part::shown).collect::<Vec<_>>().join(" ");
        match self {
            Part::Word(word) => word.shown(),
            Part::Maybe(parts) => format!("[{}]", all(parts)),
            Part::Many(parts @ [_], _) => format!("{} …", all(parts)),
            Part::Many(parts, _) => format!("{0} [{0}]…", all(parts)),
            Part::All(grammar) => grammar.line(),
        }
    }

    fn unit(&self) -> &'static str {
        match self {
            Part::Word(word) => word.unit,
            Part::Maybe(parts) | Part::Many(parts, _) => {
                parts.iter().map(Part::unit).find(|unit| !unit.is_empty()).unwrap_or_default()
            }
            Part::All(_) => "",
        }
    }

    /// Its rows of the table: word, meaning, unit, default. Words that share a sentence share a row.
    fn rows(&self, rows: &mut Vec<[String; 4]>) {
        match self {
            Part::Word(word) => {
                let choices = word.kind.choices().iter().any(|a| !a.about.is_empty());
                match rows.last_mut() {
                    Some(last) if !word.about.is_empty() && last[1] == word.about => {
                        last[0] = format!("{} {}", last[0], word.name);
                    }
                    _ if choices && word.about.is_empty() => {}
                    _ => rows.push([word.short(), word.about.into(), word.unit.into(), String::new()]),
                }
                self.choices("", rows);
            }
            Part::Maybe(parts) | Part::Many(parts, _) => parts.iter().for_each(|part| part.rows(rows)),
            Part::All(_) => {}
        }
    }

    /// The rows of the words that may stand here, behind a keyword or in order.
    fn choices(&self, keyword: &str, rows: &mut Vec<[String; 4]>) {
        let parts = match self {
            Part::Word(word) => {
                if let Kind::Words(grammar) = word.kind {
                    grammar.in_order().iter().for_each(|part| part.choices(keyword, rows));
                }
                for one in word.kind.choices() {
                    let shown = format!("{keyword} {}", one.shown());
                    rows.push([shown.trim().to_string(), one.about.into(), String::new(), String::new()]);
                }
                if let Kind::Or(_, Kind::Words(grammar)) = word.kind {
                    let about = grammar.in_order().into_iter().find_map(|part| match part {
                        Part::Word(first) if !first.about.is_empty() => Some(first.about),
                        _ => None,
                    });
                    let shown = format!("{keyword} {}", grammar.line());
                    rows.extend(about.map(|about| [shown, about.into(), String::new(), String::new()]));
                }
                return;
            }
            Part::Maybe(parts) | Part::Many(parts, _) => *parts,
            Part::All(grammar) => grammar.parts,
        };
        parts.iter().for_each(|part| part.choices(keyword, rows));
    }
}

impl Alternative {
    /// The word with what stands behind it.
    pub fn shown(&self) -> String {
        let parts = self.parts.iter().map(Part::shown);
        std::iter::once(self.word.to_string()).chain(parts).collect::<Vec<_>>().join(" ")
    }
}

impl Placeholder {
    /// As it stands in a syntax line: choices by their words.
    pub fn shown(&self) -> String {
        match self.kind {
            Kind::Switch => "yes|no".into(),
            Kind::Words(grammar) => grammar.line(),
            Kind::Choice(all) if all.len() > MANY => self.name.into(),
            Kind::Choice(all) if all.iter().all(|a| a.parts.is_empty()) => {
                all.iter().map(|a| a.word).collect::<Vec<_>>().join("|")
            }
            Kind::Choice(all) => all.iter().map(Alternative::shown).collect::<Vec<_>>().join(" | "),
            Kind::OrNull(_) => format!("{}|NULL", self.name),
            // A variable in place of a number: `N|v_name`.
            Kind::Or(Kind::Reference, second) => {
                format!("{}|v_name", Self { kind: *second, ..*self }.shown())
            }
            Kind::Or(first, second) => {
                let shown = [first, second].map(|kind| Self { kind: *kind, ..*self }.shown());
                shown.join(if shown.iter().any(|s| s.contains(' ')) { " | " } else { "|" })
            }
            _ => self.name.into(),
        }
    }

    /// The same without the words behind choices.
    fn short(&self) -> String {
        match self.kind {
            Kind::Choice(all) if all.len() <= MANY => {
                all.iter().map(|a| a.word).collect::<Vec<_>>().join("|")
            }
            _ => self.shown(),
        }
    }
}

/// Adds a row of a table, unless it is there; one that differs in its first word alone shares a row: `x|y|z final LO HI`.
fn join(rows: &mut Vec<[String; 4]>, row: [String; 4]) {
    if rows.contains(&row) {
        return;
    }
    let rest = |words: &str| words.split_once(' ').map(|(_, rest)| rest.to_string());
    let alike = |other: &&mut [String; 4]| {
        !row[1].is_empty()
            && other[1..] == row[1..]
            && rest(&other[0]).is_some()
            && rest(&other[0]) == rest(&row[0])
    };
    match (rows.iter_mut().find(alike), row[0].split_once(' ')) {
        (Some(other), Some((word, rest))) => {
            let first = other[0].split(' ').next().unwrap_or_default();
            other[0] = format!("{first}|{word} {rest}");
        }
        _ => rows.push(row),
    }
}
