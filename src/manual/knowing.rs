//! What completion, hints, highlighting and editors know: the manual's syntax lines, and what their placeholders mean.

use super::syntax::{Form, Place, is_word};
use super::walk::{Declared, Offer};
use super::{Page, all};
use crate::session::{Known, THERMO};
use perigrain_styles::words::Kind;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// A form of a command with the page it stands on.
struct Entry {
    page: Page,
    form: Line,
}

/// A syntax line: declared, or written by hand.
#[derive(Debug)]
enum Line {
    Declared(Declared),
    Written(Form),
}

impl Line {
    fn first(&self) -> Option<&str> {
        match self {
            Self::Declared(line) => line.head().first().map(String::as_str),
            Self::Written(form) => form.first(),
        }
    }

    fn index_of(&self, name: &str) -> Option<usize> {
        match self {
            Self::Declared(line) => line.head().iter().position(|word| word == name),
            Self::Written(form) => form.index_of(name),
        }
    }

    /// How well the words typed fit: words that are written as they are count for it or against it.
    fn fit(&self, typed: &[&str]) -> i32 {
        match self {
            Self::Declared(line) => {
                let fixed = line.head().iter().zip(typed).filter(|(word, _)| is_word(word));
                fixed.map(|(word, typed)| if word == typed { 1 } else { -1 }).sum()
            }
            Self::Written(form) => form.fit(typed),
        }
    }

    fn place(&self, typed: &[&str]) -> Place {
        match self {
            Self::Declared(line) => line.place(typed),
            Self::Written(form) => form.place(typed),
        }
    }

    fn shown(&self, typed: &[&str]) -> (Vec<String>, Option<usize>) {
        match self {
            Self::Declared(line) => line.shown(typed),
            Self::Written(form) => form.shown(typed),
        }
    }
}

/// All forms by their commands, those of commands before those of their styles.
static FORMS: LazyLock<BTreeMap<String, Vec<Entry>>> = LazyLock::new(|| {
    let mut forms: BTreeMap<String, Vec<Entry>> = BTreeMap::new();
    for page in all().iter().filter(|p| p.kind != "topic") {
        let written = page.written().lines().filter(|l| !l.starts_with('#'));
        let written = written.map(|line| Line::Written(Form::read(line, page.name)));
        for form in page.declared().into_iter().map(Line::Declared).chain(written) {
            let Some(command) = form.first().map(String::from) else { continue };
            forms.entry(command).or_default().push(Entry { page: *page, form });
        }
    }
    forms
});

/// Commands that exist only at the prompt.
pub const COLON: [(&str, &str); 9] = [
    (":plan", "prints what each step of a run now would do"),
    (":graph", "[FILE.dot]  lists the lines so far and what uses what, or writes the graph for graphviz"),
    (":plot", "COLUMN …  draws thermo columns over the step"),
    (":slice", "FORMULA x|y|z AT [WIDTH]  draws a cut through the particles, coloured by a formula"),
    (":show", "FILE.png  shows a picture"),
    (":undo", "[N]  goes back to before the last line, or the last N"),
    (":save", "FILE  writes the lines that count as a deck"),
    (":help", "lists these commands"),
    (":quit", "leaves"),
];

/// What a name is the name of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Named {
    /// A group.
    Group,
    /// A region.
    Region,
    /// A fix.
    Fix,
    /// A compute.
    Compute,
    /// A dump.
    Dump,
    /// A variable.
    Variable,
    /// A material.
    Material,
    /// A molecule.
    Molecule,
    /// A label.
    Label,
    /// A file.
    File,
}

impl Named {
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Group => "group",
            Self::Region => "region",
            Self::Fix => "fix",
            Self::Compute => "compute",
            Self::Dump => "dump",
            Self::Variable => "variable",
            Self::Material => "material",
            Self::Molecule => "molecule",
            Self::Label => "label",
            Self::File => "file",
        }
    }

    /// The names that exist; files are not among them.
    pub fn list(self, known: &mut Known) -> Option<&mut Vec<String>> {
        Some(match self {
            Self::Group => &mut known.groups,
            Self::Region => &mut known.regions,
            Self::Fix => &mut known.fixes,
            Self::Compute => &mut known.computes,
            Self::Dump => &mut known.dumps,
            Self::Variable => &mut known.variables,
            Self::Material => &mut known.materials,
            Self::Label => &mut known.labels,
            Self::Molecule | Self::File => return None,
        })
    }

    /// What a declared word names.
    pub fn of_kind(kind: Kind) -> Option<Self> {
        Some(match kind {
            Kind::Group => Self::Group,
            Kind::Region => Self::Region,
            Kind::Compute => Self::Compute,
            Kind::Fix => Self::Fix,
            Kind::Dump => Self::Dump,
            Kind::Variable => Self::Variable,
            Kind::Molecule => Self::Molecule,
            Kind::Material => Self::Material,
            Kind::File => Self::File,
            _ => return None,
        })
    }

    /// What a placeholder of a syntax line names: `before` is the word of the line before it, `last` the word typed there.
    pub fn of(placeholder: &str, before: &str, last: &str, command: &str) -> Option<Self> {
        Some(match placeholder {
            "group" | "GROUP" | "group-ID" | "PARENT" | "GROUP1" | "GROUP2" => Self::Group,
            "REGION" | "region-ID" | "regionID" => Self::Region,
            "temp-ID" | "COMPUTE" | "chunkID" => Self::Compute,
            "FIX" | "fix-ID" | "fixID" => Self::Fix,
            "TEMPLATE" => Self::Molecule,
            "LABEL" => Self::Label,
            "NAME" if ["variable", "next"].contains(&command) => Self::Variable,
            "NAME" if ["variable", "var", "x|y|z"].contains(&before) => Self::Variable,
            "NAME" if command == "label" => Self::Label,
            "FILE" | "NAME" => Self::File,
            p if p.starts_with("file") => Self::File,
            "ID" => Self::of_id(last, command)
                .or_else(|| Self::of_id(before, command))
                .or_else(|| Self::of_id(command, command))?,
            _ => return None,
        })
    }

    /// Which IDs an `ID` behind a word means.
    fn of_id(word: &str, command: &str) -> Option<Self> {
        Some(match word {
            "region" | "union" | "intersect" if command == "region" => Self::Region,
            "region" => Self::Region,
            "group" | "union" | "intersect" | "subtract" => Self::Group,
            "material" => Self::Material,
            "molecule" => Self::Molecule,
            "fix" | "unfix" | "fix_modify" => Self::Fix,
            "compute" | "uncompute" | "compute_modify" => Self::Compute,
            "dump" | "undump" | "dump_modify" => Self::Dump,
            // Behind numbers, as in `create_atoms 1 random 10 4711 ID` and `delete_atoms overlap 1 ID ID`.
            "create_atoms" => Self::Region,
            "delete_atoms" | "delete_bonds" => Self::Group,
            _ => return None,
        })
    }
}

/// All commands a deck knows, sorted.
pub fn commands() -> &'static [&'static str] {
    static COMMANDS: LazyLock<Vec<&str>> = LazyLock::new(|| styles("command"));
    &COMMANDS
}

/// All styles that a command takes, sorted.
pub fn styles(command: &str) -> Vec<&'static str> {
    let mut all: Vec<&str> = all().iter().filter(|p| p.kind == command).map(|p| p.name).collect();
    all.sort_unstable();
    all
}

/// The page with a title, as `fix nve` or `run`.
pub fn page(title: &str) -> Option<Page> {
    static TITLES: LazyLock<BTreeMap<String, Page>> =
        LazyLock::new(|| all().iter().filter(|p| p.kind != "topic").map(|p| (p.title(), *p)).collect());
    TITLES.get(title).copied()
}

/// The form that fits the words typed best.
fn best(typed: &[&str], known: &Known) -> Option<&'static Entry> {
    let mut best: Option<(i32, &Entry)> = None;
    for entry in FORMS.get(*typed.first()?)? {
        let name = entry.page.name;
        let mut fit = entry.form.fit(typed);
        // A style's own page counts once the style is typed, and then more than that of its command.
        if let Some(k) = entry.form.index_of(name).filter(|_| entry.page.kind == typed[0]) {
            if typed.get(k) != Some(&name) {
                continue;
            }
            fit += typed.len() as i32;
        }
        let pair = entry.page.kind == "pair_style" && typed[0] != "pair_style";
        // Of a hybrid the line names the style.
        let mut styles = [typed.get(3).copied(), known.pair.as_deref()].into_iter().flatten();
        if pair && styles.any(|style| style == entry.page.name) {
            fit += 3;
        }
        if best.is_none_or(|(most, _)| fit > most) {
            best = Some((fit, entry));
        }
    }
    best.map(|(_, entry)| entry)
}

/// The words that may follow the typed ones in those forms of the same page that fit as well as the best one.
pub fn places(typed: &[&str], known: &Known) -> Option<Vec<Place>> {
    let entry = best(typed, known)?;
    let fit = entry.form.fit(typed);
    let same = |e: &&Entry| e.page.title() == entry.page.title() && e.form.fit(typed) == fit;
    let all = FORMS.get(*typed.first()?)?;
    Some(all.iter().filter(same).map(|e| e.form.place(typed)).collect())
}

/// Which of the words of a line are none that is declared for their places, in any form that fits the line as well as the best one;
/// `None` for lines whose words are not declared.
pub fn strays(words: &[&str], known: &Known) -> Option<(Vec<usize>, Page)> {
    let entry = best(words, known)?;
    let fit = entry.form.fit(words);
    let same = |e: &&Entry| e.page.title() == entry.page.title() && e.form.fit(words) == fit;
    let forms = FORMS.get(*words.first()?)?.iter().filter(same).map(|e| match &e.form {
        Line::Declared(line) => Some(line.strays(words)),
        Line::Written(_) => None,
    });
    let forms: Vec<Vec<usize>> = forms.collect::<Option<_>>()?;
    let (first, others) = forms.split_first()?;
    let everywhere = |k: &&usize| others.iter().all(|form| form.contains(k));
    Some((first.iter().filter(everywhere).copied().collect(), entry.page))
}

/// What stands behind the words typed, from the form that fits them best, and that form's page.
pub fn place(typed: &[&str], known: &Known) -> Option<(Place, Page)> {
    let entry = best(typed, known)?;
    Some((entry.form.place(typed), entry.page))
}

/// The words of the form that fits the words typed best, which of them is the next one to type, and the form's page.
pub fn synopsis(typed: &[&str], known: &Known) -> Option<(Vec<String>, Option<usize>, Page)> {
    let entry = best(typed, known)?;
    let (words, next) = entry.form.shown(typed);
    Some((words, next, entry.page))
}

/// The name that word number `k` of a line stands for, in the form that fits the line best.
pub fn named(words: &[&str], k: usize) -> Option<Named> {
    let command = *words.first()?;
    let (word, last) = (*words.get(k)?, *words.get(k.checked_sub(1)?)?);
    let place = best(words, &Known::default())?.form.place(&words[..k]);
    if !place.offers.is_empty() {
        let typed = |offer: &Offer| matches!(offer, Offer::Word(known, _) if *known == word);
        let names = |offer: &Offer| match offer {
            Offer::Place(p) if p.kind == Kind::Text => Named::of(p.name, &place.before, last, command),
            Offer::Place(p) => Named::of_kind(p.kind),
            Offer::Word(..) => None,
        };
        return if place.offers.iter().any(typed) { None } else { place.offers.iter().find_map(names) };
    }
    let each = || place.here.iter().flat_map(|here| here.trim_end_matches('…').split('|'));
    if each().any(|one| one == word && is_word(one)) {
        return None;
    }
    each().find_map(|one| Named::of(one, &place.before, last, command))
}

/// A page's text on a word: from the word in backticks to the end of that sentence or item.
pub fn sentence_on(text: &str, word: &str) -> Option<String> {
    const LONGEST: usize = 500;
    let opening = format!("`{word}");
    let begins = |(k, _): &(usize, &str)| text[k + opening.len()..].starts_with(['`', ' ']);
    // Text in parentheses is about something else.
    let outside = |(k, _): &(usize, &str)| text[..*k].matches('(').count() == text[..*k].matches(')').count();
    let all = || text.match_indices(&opening).filter(begins);
    let (start, _) = all().find(outside).or_else(|| all().next())?;
    let rest = &text[start..];
    let ends = [". ", ".\n", ";\n", "; `", "), `", "\n\n", "\n*", "\n-"];
    let mut end = ends.iter().filter_map(|end| rest.find(end)).min().unwrap_or(rest.len()).min(LONGEST);
    while !rest.is_char_boundary(end) {
        end -= 1;
    }
    let closed = if rest[end..].starts_with(')') { ")" } else { "" };
    Some(rest[..end].to_string() + closed)
}

/// The columns a step table can show by keyword.
pub fn thermo() -> Vec<&'static str> {
    THERMO.iter().map(|k| k.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rest(line: &str, pair: Option<&str>) -> String {
        let known = Known { pair: pair.map(String::from), ..Known::default() };
        place(&line.split_whitespace().collect::<Vec<_>>(), &known).map_or(String::new(), |(p, _)| p.rest)
    }

    #[test]
    fn the_style_typed_chooses_the_page() {
        assert_eq!(rest("fix 1 all", None), "STYLE word …");
        assert_eq!(rest("fix 1 all viscous", None), "gamma [scale type ratio]");
        assert!(rest("region a sphere 0 0", None).starts_with("Z R"));
        assert!(rest("pair_coeff 1 1", Some("peri/pmb")).starts_with("c horizon"));
        assert!(rest("pair_coeff 1 1 material glass", Some("peri/pmb")).starts_with("horizon H"));
        assert!(rest("no_such", None).is_empty());
    }

    #[test]
    fn every_form_begins_with_its_command() {
        for e in FORMS.values().flatten() {
            let command = if e.page.kind == "command" { e.page.name } else { e.page.kind };
            let own = e.form.index_of(command) == Some(0);
            assert!(
                own || ["pair_style", "bond_style", "fix", "dump", "command"].contains(&e.page.kind),
                "{}: {:?}",
                e.page.title(),
                e.form
            );
        }
    }

    #[test]
    fn placeholders_give_the_kind_of_a_word() {
        let of = |line: &str, k: usize| named(&line.split_whitespace().collect::<Vec<_>>(), k);
        assert_eq!(of("create_atoms 1 region r", 3), Some(Named::Region));
        assert_eq!(of("velocity ball set 0 0 0", 1), Some(Named::Group));
        assert_eq!(of("group g union a b", 3), Some(Named::Group));
        assert_eq!(of("unfix 1", 1), Some(Named::Fix));
        assert_eq!((of("run 100", 1), of("create_atoms 1 region r", 2), of("run", 4)), (None, None, None));
    }

    #[test]
    fn a_synopsis_knows_its_next_word() {
        let of = |line: &str| {
            let (words, next, _) =
                synopsis(&line.split_whitespace().collect::<Vec<_>>(), &Known::default()).unwrap();
            next.map(|k| words[k].clone())
        };
        assert_eq!(of("fix 1 all viscous").as_deref(), Some("gamma"));
        assert_eq!(of("fix 1 all viscous 1.0 scale").as_deref(), Some("[scale type ratio]"));
        assert_eq!(of("region a sphere 0").as_deref(), Some("Y"));
        assert_eq!(of("region").as_deref(), Some("ID"));
    }

    #[test]
    fn pages_describe_their_keywords() {
        let text =
            "Keywords:\n\n* `size W H` pixels (1280 960), `up x`; `legend yes|no` what.\n* `map NAME` all.";
        assert_eq!(sentence_on(text, "size").as_deref(), Some("`size W H` pixels (1280 960)"));
        assert_eq!(sentence_on(text, "map").as_deref(), Some("`map NAME` all."));
        assert_eq!(sentence_on(text, "nothing"), None);
    }
}
