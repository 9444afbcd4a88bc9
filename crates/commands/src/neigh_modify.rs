//! `neigh_modify`: when neighbour lists are rebuilt and which pairs they leave out.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Command, Word};
use perigrain_styles::common::{not_here, setting};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::NeighborSettings;

/// The command.
pub struct NeighModify;

const KEYWORDS: [&str; 12] = [
    "delay",
    "every",
    "check",
    "once",
    "exclude",
    "include",
    "cluster",
    "page",
    "one",
    "binsize",
    "collection/type",
    "collection/interval",
];

impl Style for NeighModify {
    fn name(&self) -> &'static str {
        "neigh_modify"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "neigh_modify [every N] [delay N] [check yes|no] [once yes|no] [exclude type I J | group A B | molecule/intra G | molecule/inter G | none] [collection/type N LIST …] [collection/interval N CUTOFF …] …",
            summary: "Says when neighbour lists are rebuilt and which pairs they leave out.",
            text: "A rebuild is considered every N steps, not before `delay` steps after the last one, and with `check yes` \
                   only if some particle has moved half the skin; the delay must be a multiple of N. Wrapping into the box, shrink-wrapping and the test for \
                   lost particles happen then too. Lists of grains that flow side by side outlast rebuilds, which the log counts all \
                   the same. `exclude type I J` and `exclude group A B` leave pairs out, `exclude molecule/intra G` (or `molecule G`) those within a molecule of the group, `molecule/inter G` \
                   those across molecules, `exclude \
                   none` forgets all such rules. Peridynamic particles excluded from each other get no bonds if the rule stands when families are found, at the first \
                   run; later it takes short-range contact away and leaves bonds. `page`, `one`, `binsize` and `cluster` are accepted without effect, and so are \
                   `collection/type N TYPES …` (each type in one of N lists such as `1*2,5`) and `collection/interval N CUTOFF …` of `neighbor … multi`: types and sizes are searched \
                   class by class here in any case. \
                   Defaults: every 1 delay 0 check yes once no.",
            example: "neigh_modify every 5 delay 0 check yes exclude group wall wall",
        }
    }
}

impl CommandStyle for NeighModify {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let mut set = cx.world.settings.neighbor.clone();
        let first = a.expect("a keyword")?;
        let mut word = Some(first);
        while let Some(keyword) = word {
            option(&mut set, keyword, a, cx)?;
            word = a.next();
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

fn option(set: &mut NeighborSettings, keyword: &Word, a: &mut Args, cx: &BuildCx) -> Result<()> {
    match keyword.text.as_str() {
        "delay" => set.delay = a.integer_from(0, "the delay")?,
        "every" => set.every = a.integer_from(1, "the interval")?,
        "check" => set.check = a.flag("check")?,
        "once" => set.once = a.flag("once")?,
        "exclude" => exclude(set, a, cx)?,
        "include" => {
            let group = a.expect("a group")?;
            cx.group(group)?;
            if group.text != "all" {
                return Err(not_here(group, "neigh_modify include of a group other than all:"));
            }
        }
        "cluster" => {
            a.flag("cluster")?;
        }
        "page" | "one" => {
            a.integer_from(1, "the size")?;
            without_effect(keyword, cx);
        }
        "binsize" => {
            a.non_negative("the bin size")?;
            without_effect(keyword, cx);
        }
        "collection/type" | "collection/interval" => collections(set, keyword, a, cx)?,
        _ => return Err(a.unknown(keyword, &KEYWORDS)),
    }
    Ok(())
}

fn without_effect(keyword: &Word, cx: &BuildCx) {
    let what = if keyword.text.starts_with("collection") { "classes" } else { "size" };
    let text = format!("neigh_modify {} has no effect here: lists find their own {what}", keyword.text);
    cx.note(Diagnostic::note(Code::NO_EFFECT, keyword.span, text));
}

/// `collection/type N LIST …` and `collection/interval N CUTOFF …`: how LAMMPS' `multi` gathers particles of like reach.
fn collections(set: &NeighborSettings, keyword: &Word, a: &mut Args, cx: &BuildCx) -> Result<()> {
    if !set.multi {
        let text = format!("{} belongs to neighbour lists of the kind `multi`", keyword.text);
        let d = Diagnostic::error(Code::CONFLICT, keyword.span, text);
        return Err(d.help("write `neighbor SKIN multi` before this line").into());
    }
    let count = a.integer_from(1, "the number of collections N")?;
    match keyword.text.as_str() {
        "collection/type" => collections_of_types(count, a, cx)?,
        _ => {
            let mut last = f64::NEG_INFINITY;
            for _ in 0..count {
                let span = a.here();
                let cutoff = a.number("the upper cutoff of a collection")?;
                if cutoff <= last {
                    let text = format!("cutoffs of collections must grow: {cutoff} follows {last}");
                    return fail(Code::BAD_VALUE, span, text);
                }
                last = cutoff;
            }
        }
    }
    without_effect(keyword, cx);
    Ok(())
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

fn exclude(set: &mut NeighborSettings, a: &mut Args, cx: &BuildCx) -> Result<()> {
    let kinds = ["type", "group", "molecule/intra", "molecule/inter", "molecule", "none"];
    let span = a.here();
    let kind = a.choice("kind of exclusion", &kinds)?;
    if kind.starts_with("molecule") && !cx.world.particles.style.molecules {
        return fail(Code::CONFLICT, span, "particles of this atom_style belong to no molecules");
    }
    match kind {
        "molecule" | "molecule/intra" | "molecule/inter" => {
            let group = cx.group(a.expect("a group")?)?.bit();
            add(&mut set.exclude_molecules, (group, kind != "molecule/inter"));
        }
        "type" => {
            let types = cx.world.types;
            let (i, j) = (one_type(a, types)?, one_type(a, types)?);
            add(&mut set.exclude_types, (i.min(j), i.max(j)));
        }
        "group" => {
            let mut bit =
                || Ok::<u32, perigrain_base::diag::Diagnostics>(cx.group(a.expect("a group")?)?.bit());
            add(&mut set.exclude_groups, (bit()?, bit()?));
        }
        _ => {
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

fn one_type(a: &mut Args, types: usize) -> Result<u16> {
    let span = a.here();
    let k = a.integer_from(1, "the type")?;
    match u16::try_from(k) {
        Ok(t) if k as usize <= types => Ok(t),
        _ => fail(Code::BAD_VALUE, span, format!("there are types 1 to {types}, not {k}")),
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
