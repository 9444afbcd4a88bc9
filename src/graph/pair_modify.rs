//! `pair_modify`: options of LAMMPS' pair styles, of which some here know how types are mixed.

use super::declaration::{Context, Declared};
use super::node::Graph;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, fail};
use perigrain_lang::{Args, Word};
use perigrain_pairs::{Mix, PairOption};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{At, Each, Idle, Steps, Words, alternatives, read_or};
use perigrain_world::{GroupId, World};

/// The words of a `pair_modify` line.
#[derive(Words)]
#[word(least = 1, what = "a keyword such as shift or mix")]
pub struct PairModify {
    /// The sub-style of `hybrid` that the other words concern.
    #[word(keyword, name = "STYLE", what = "a sub-style")]
    pair: Option<Word>,
    #[word(flatten)]
    options: Each<Setting>,
}

/// A setting.
#[derive(Words)]
#[word(keywords, refused = "special")]
enum Setting {
    /// The rule by which `soft` and `bpm/spring` mix the cutoffs of two types without a line of their own; granular styles mix in one way.
    #[word(once)]
    Mix(#[word(name = "rule", with = rule, kind = Kind::Choice(&alternatives(&Mix::NAMES)))] Mix),
    /// Read for LAMMPS' decks, without effect: no pair style here has a shift.
    #[word(once)]
    Shift(#[word(what = "shift")] bool),
    /// Read for LAMMPS' decks, without effect: no pair style here has a tail.
    #[word(once)]
    Tail(#[word(what = "tail")] bool),
    /// Read for LAMMPS' decks, without effect: no pair style here has a table.
    #[word(once)]
    Table(#[word(name = "N", what = "the length of the table")] Idle<Steps>),
    /// Read for LAMMPS' decks, without effect: no pair style here has a table.
    #[word(word = "table/disp", once)]
    TableDisp(#[word(name = "N", what = "the length of the table")] Idle<Steps>),
    /// Read for LAMMPS' decks, without effect: no pair style here has a table.
    #[word(once)]
    Tabinner(#[word(name = "R", what = "where the table begins")] Idle<f64>),
    /// Read for LAMMPS' decks, without effect: no pair style here has a table.
    #[word(word = "tabinner/disp", once)]
    TabinnerDisp(#[word(name = "R", what = "where the table begins")] Idle<f64>),
    /// Read for LAMMPS' decks: `no` would change forces and is refused.
    #[word(once)]
    Compute(#[word(name = "yes|no", what = "compute")] At<bool>),
    /// Read for LAMMPS' decks, without effect.
    #[word(once)]
    Nofdotr,
    /// Read for LAMMPS' decks, without effect.
    #[word(word = "neigh/trim", once)]
    NeighTrim(#[word(name = "yes|no", what = "neigh/trim")] Idle<bool>),
    /// Read for LAMMPS' decks, without effect.
    #[word(word = "compute/tally", once)]
    ComputeTally(#[word(name = "yes|no", what = "compute/tally")] Idle<bool>),
}

fn rule(args: &mut Args, _: &BuildCx) -> Result<Mix> {
    Mix::read(args)
}

/// `pair_modify keyword value …`: read whole; keywords without effect here get a note.
pub fn pair_modify(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    let Some(node) = &graph.pair else {
        return fail(Code::WRONG_ORDER, args.name_span(), "pair_modify comes before any pair_style");
    };
    let (facts, mut pair) = (node.pair.facts(), node.pair.clone());
    let build = cx.build(graph, w, "", GroupId::ALL);
    let line: PairModify = read_or(args, &build, special)?;
    if let Some(word) = &line.pair {
        part(&node.pair.parts().iter().map(|p| p.facts().name).collect::<Vec<_>>(), word)?;
    }
    let (mut shift, mut tail, mut idle) = (false, false, false);
    for given in line.options.0 {
        match given.value {
            Setting::Mix(rule) if facts.mixes => pair.modify(PairOption::Mix(rule), &build)?,
            Setting::Shift(yes) => shift = yes,
            Setting::Tail(yes) => tail = yes,
            Setting::Compute(At { value: false, span, .. }) => {
                let d = Diagnostic::error(Code::NOT_SUPPORTED, span, "forces that are not computed");
                return Err(d.help("leave the style out, or write `pair_style none`").into());
            }
            _ => {}
        }
        idle |= given.word.text != "mix" || !facts.mixes;
        if tail && (shift || w.settings.two_dimensional) {
            let with = if shift { "`shift yes`" } else { "two dimensions" };
            return fail(Code::CONFLICT, args.span(), format!("`tail yes` does not go with {with}"));
        }
    }
    if idle {
        let text = match facts.mixes {
            true => "without effect but for `mix`: no pair style here has a shift, a tail or a table",
            false => {
                "without effect: no pair style here has a shift, a tail or a table, and this one has one mixing rule"
            }
        };
        build.note(Diagnostic::note(Code::NO_EFFECT, cx.span, text));
    }
    if let Some(node) = &mut graph.pair {
        node.pair = pair;
    }
    w.touch();
    Ok(Declared::default())
}

/// The refusal of `special`.
fn special(word: &Word) -> Option<Diagnostics> {
    let text = "weights for one sub-style alone";
    let d = Diagnostic::error(Code::NOT_SUPPORTED, word.span, text);
    (word.text == "special").then(|| d.help("`special_bonds` sets them for all").into())
}

/// The sub-style of a `hybrid` that the other words concern.
fn part(parts: &[&str], word: &Word) -> Result<()> {
    if !parts.contains(&word.text.as_str()) {
        let text = format!("`{}` is no sub-style of the pair style in force", word.text);
        let d = Diagnostic::error(Code::UNKNOWN_NAME, word.span, text);
        return Err(match parts {
            [] => d.help("`pair` goes with `pair_style hybrid` only"),
            _ => d.help(format!("there are {}", parts.join(" "))),
        }
        .into());
    }
    Ok(())
}
