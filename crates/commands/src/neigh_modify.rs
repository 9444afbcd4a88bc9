//! `neigh_modify`: when neighbour lists are rebuilt and which pairs they leave out.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, Command, Word};
use perigrain_styles::common::{not_here, setting};
use perigrain_styles::words::{At, Grammar, Kind, OneType, Part, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::{GroupId, NeighborSettings};

/// The command.
pub struct NeighModify;

impl Style for NeighModify {
    fn name(&self) -> &'static str {
        "neigh_modify"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Says when neighbour lists are rebuilt and which pairs they leave out.",
            text: "A rebuild is considered every N steps, not before `delay` steps after the last one; the delay must be a multiple \
                   of N. Wrapping into the box, shrink-wrapping and the test for lost particles happen then too. Lists of grains \
                   that flow side by side outlast rebuilds, which the log counts all the same.\n\n\
                   Peridynamic particles excluded from each other get no bonds if the rule stands when families are found, at the \
                   first run; later it takes short-range contact away and leaves bonds. `collection/…` belong to `neighbor … \
                   multi`; types and sizes are searched class by class here in any case.",
            example: "neigh_modify every 5 delay 0 check yes exclude group wall wall",
        }
    }
}

/// The words; those that are not there stay as they are.
#[derive(Words)]
#[word(least = 1)]
struct Line {
    /// The interval of rebuilds [steps].
    #[word(keyword, name = "N", from = 1, default = cx.world.settings.neighbor.every, shown = "1")]
    every: i64,
    /// The delay after the last rebuild [steps].
    #[word(keyword, name = "N", from = 0, default = cx.world.settings.neighbor.delay, shown = "0")]
    delay: i64,
    /// Whether lists are rebuilt only if some particle has moved half the skin.
    #[word(keyword, default = cx.world.settings.neighbor.check, shown = "yes")]
    check: bool,
    /// Whether lists are never rebuilt.
    #[word(keyword, default = cx.world.settings.neighbor.once, shown = "no")]
    once: bool,
    #[word(keyword)]
    exclude: Vec<At<Exclude>>,
    /// LAMMPS' restriction to a group, which may be `all` only.
    #[word(keyword, name = "ID", what = "a group", kind = Kind::Group)]
    include: Option<Word>,
    /// Accepted without effect.
    #[word(keyword)]
    cluster: Option<bool>,
    /// Accepted without effect.
    #[word(keyword, name = "N", what = "the size", from = 1, placed)]
    page: Option<At<i64>>,
    /// Accepted without effect.
    #[word(keyword, name = "N", what = "the size", from = 1, placed)]
    one: Option<At<i64>>,
    /// Accepted without effect.
    #[word(keyword, name = "SIZE", what = "the bin size", non_negative, placed)]
    binsize: Option<At<f64>>,
    /// Each type in one of N lists such as `1*2,5`; without effect.
    #[word(keyword = "collection/type", name = "lists", placed)]
    by_type: Option<At<TypeLists>>,
    /// The upper cutoffs of N collections; without effect.
    #[word(keyword = "collection/interval", name = "cutoffs", placed)]
    by_size: Option<At<Cutoffs>>,
}

/// Which pairs lists leave out.
#[derive(Words)]
#[word(what = "kind of exclusion")]
enum Exclude {
    /// Pairs of two types.
    Type(#[word(name = "I", what = "the type")] OneType, #[word(name = "J", what = "the type")] OneType),
    /// Pairs of particles of two groups.
    Group(#[word(name = "A")] GroupId, #[word(name = "B")] GroupId),
    /// Those within a molecule of the group.
    #[word("molecule/intra")]
    Intra(#[word(name = "G")] GroupId),
    /// Those across molecules of the group.
    #[word("molecule/inter")]
    Inter(#[word(name = "G")] GroupId),
    /// As `molecule/intra`.
    Molecule(#[word(name = "G")] GroupId),
    /// Forgets all such rules.
    None,
}

/// How many lists or numbers, and these.
const fn counted(name: &'static str, kind: Kind) -> [Part; 2] {
    [Part::bare("N", Kind::Whole), Part::bare(name, kind)]
}

/// Lists of types.
struct TypeLists;

impl Value for TypeLists {
    const KIND: Kind = Kind::Words(&Grammar { parts: &counted("LIST", Kind::Text), ..*Grammar::NONE });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let count = args.integer_from(1, "the number of collections N")?;
        collections_of_types(count, args, cx).map(|()| Self)
    }
}

/// Cutoffs, from the smallest on.
struct Cutoffs;

impl Value for Cutoffs {
    const KIND: Kind = Kind::Words(&Grammar { parts: &counted("CUTOFF", Kind::Number), ..*Grammar::NONE });
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let count = args.integer_from(1, "the number of collections N")?;
        let mut last = f64::NEG_INFINITY;
        for _ in 0..count {
            let span = args.here();
            let cutoff = args.number("the upper cutoff of a collection")?;
            if cutoff <= last {
                let text = format!("cutoffs of collections must grow: {cutoff} follows {last}");
                return fail(Code::BAD_VALUE, span, text);
            }
            last = cutoff;
        }
        Ok(Self)
    }
}

impl CommandStyle for NeighModify {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let line: Line = read(a, cx)?;
        let mut set = cx.world.settings.neighbor.clone();
        (set.every, set.delay, set.check, set.once) = (line.every, line.delay, line.check, line.once);
        line.exclude.into_iter().try_for_each(|rule| exclude(&mut set, rule, cx))?;
        if let Some(group) = &line.include {
            cx.group(group)?;
            if group.text != "all" {
                return Err(not_here(group, "neigh_modify include of a group other than all:"));
            }
        }
        let collections = [
            ("collection/type", line.by_type.map(|lists| lists.span)),
            ("collection/interval", line.by_size.map(|cutoffs| cutoffs.span)),
        ];
        if let Some((name, Some(span))) = collections.iter().find(|c| c.1.is_some()).filter(|_| !set.multi) {
            let text = format!("{name} belongs to neighbour lists of the kind `multi`");
            let d = Diagnostic::error(Code::CONFLICT, *span, text);
            return Err(d.help("write `neighbor SKIN multi` before this line").into());
        }
        let sizes = [
            ("page", line.page.map(|page| page.span)),
            ("one", line.one.map(|one| one.span)),
            ("binsize", line.binsize.map(|size| size.span)),
        ];
        for (name, span) in sizes.into_iter().chain(collections) {
            without_effect(name, span, cx);
        }
        if set.delay % set.every != 0 {
            let text = format!("delay ({}) must be a multiple of every ({})", set.delay, set.every);
            return fail(Code::CONFLICT, a.span(), text);
        }
        Ok(setting(move |cx| {
            cx.world.settings.neighbor = set;
            cx.world.touch();
            Ok(())
        }))
    }
}

/// Notes a keyword that has no effect, where it stands in the line.
fn without_effect(name: &str, span: Option<Span>, cx: &BuildCx) {
    let Some(span) = span else { return };
    let what = if name.starts_with("collection") { "classes" } else { "size" };
    let text = format!("neigh_modify {name} has no effect here: lists find their own {what}");
    cx.note(Diagnostic::note(Code::NO_EFFECT, span, text));
}

/// Reads `count` lists such as `1*2,5` in which each type stands once.
fn collections_of_types(count: i64, a: &mut Args, cx: &BuildCx) -> Result<()> {
    let mut seen = vec![false; cx.world.types];
    for _ in 0..count {
        let list = a.expect("a list of types such as `1*2,5`")?;
        for range in list.text.split(',') {
            let one = Command {
                name: list.clone(),
                args: vec![Word::new(range, list.span)],
                span: list.span,
                text: range.into(),
            };
            let (from, to) = Args::new(&one).type_range(cx.world.types)?;
            for t in from..=to {
                if std::mem::replace(&mut seen[usize::from(t) - 1], true) {
                    return fail(Code::BAD_VALUE, list.span, format!("type {t} stands in two collections"));
                }
            }
        }
    }
    match seen.iter().position(|seen| !seen) {
        None => Ok(()),
        Some(k) => {
            let d =
                Diagnostic::error(Code::INCOMPLETE, a.span(), format!("type {} is in no collection", k + 1));
            Err(d.help("each type must stand in one of the lists").into())
        }
    }
}

fn exclude(set: &mut NeighborSettings, rule: At<Exclude>, cx: &BuildCx) -> Result<()> {
    let molecules = matches!(rule.value, Exclude::Molecule(_) | Exclude::Intra(_) | Exclude::Inter(_));
    if molecules && !cx.world.particles.style.molecules {
        return fail(Code::CONFLICT, rule.span, "particles of this atom_style belong to no molecules");
    }
    match rule.value {
        Exclude::Molecule(g) | Exclude::Intra(g) => add(&mut set.exclude_molecules, (g.bit(), true)),
        Exclude::Inter(g) => add(&mut set.exclude_molecules, (g.bit(), false)),
        Exclude::Type(OneType(i), OneType(j)) => add(&mut set.exclude_types, (i.min(j), i.max(j))),
        Exclude::Group(a, b) => add(&mut set.exclude_groups, (a.bit(), b.bit())),
        Exclude::None => {
            set.exclude_types.clear();
            set.exclude_groups.clear();
            set.exclude_molecules.clear();
        }
    }
    Ok(())
}

/// Adds a rule unless it exists: decks repeat rules behind `read_restart`, which brings them along.
fn add<T: PartialEq>(rules: &mut Vec<T>, rule: T) {
    if !rules.contains(&rule) {
        rules.push(rule);
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{refused, scene};

    #[test]
    fn keeps_settings_that_are_not_named() {
        let w = scene(
            "region b block 0 1 0 1 0 1\ncreate_box 2 b\ngroup g type 1\nneigh_modify every 5 delay 10\nneighbor 0.2 bin\n\
             neigh_modify check no exclude type 2 1 exclude group g all",
        );
        let n = &w.settings.neighbor;
        assert_eq!((n.every, n.delay, n.check, n.skin), (5, 10, false, 0.2));
        assert_eq!((n.exclude_types.as_slice(), n.exclude_groups.as_slice()), (&[(1, 2)][..], &[(2, 1)][..]));
        assert_eq!(refused(&w, "neigh_modify delay 7").0, "neigh_modify delay 7");
        assert_eq!(refused(&w, "neigh_modify exclude type 1 3").0, "3");
        assert_eq!(refused(&w, "neigh_modify exclude molecule all").0, "molecule");
        assert_eq!(refused(&w, "neigh_modify evry 2").0, "evry");
        assert_eq!(refused(&w, "neigh_modify collection/type 1 1*2").0, "collection/type");
        let mut w = w;
        w.settings.neighbor.multi = true;
        for (words, at) in [
            ("collection/type 2 1 1", "1"),
            ("collection/type 1 1", "neigh_modify collection/type 1 1"),
            ("collection/interval 2 1.0 1.0", "1.0"),
            ("collection/type 0", "0"),
        ] {
            assert_eq!(refused(&w, &format!("neigh_modify {words}")).0, at);
        }
        assert_eq!(refused(&w, "neighbor 0.2 multi/old").0, "multi/old");
    }
}
