//! `pair_style`, `pair_coeff`, `peri_modify`: lines that declare forces between pairs of particles.

use super::build::declare;
use super::declaration::{Context, Declared, keep_line, needs_box, style};
use super::heads;
use super::node::{Graph, PairNode};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Command, Word};
use perigrain_styles::pair::PairOption;
use perigrain_styles::words::{Or, Types, inner};
use perigrain_world::{GroupId, World};

/// `pair_style STYLE …`, `pair_style none`. The same style again keeps its coefficients, as in LAMMPS; a `hybrid` does not.
pub fn pair_style(graph: &mut Graph, w: &mut World, cmd: &Command, cx: &Context) -> Result<Declared> {
    let before = graph.pair.clone();
    choose(graph, w, &mut Args::new(cmd), cx)?;
    keep_line(graph, w, cmd);
    let same = |old: &PairNode| {
        let now = graph.pair.as_ref().map(|p| p.pair.facts().name);
        now == Some(old.pair.facts().name) && old.pair.parts().is_empty()
    };
    if let Some(old) = before.filter(same)
        && let Err(e) = restate(graph, w, &old, cx)
    {
        graph.pair = Some(old);
        return Err(e);
    }
    Ok(Declared::default())
}

/// Repeats the lines behind an earlier `pair_style`, each with the lattice that was in force.
fn restate(graph: &mut Graph, w: &mut World, old: &PairNode, cx: &Context) -> Result<()> {
    let lattice = w.lattice.clone();
    // What there is to note has been noted.
    let (notes, uses) = Default::default();
    let cx = &Context { notes: &notes, uses: &uses, ..*cx };
    let outcome =
        old.lines.iter().filter(|declared| declared.words[0] != "pair_style").try_for_each(|declared| {
            w.lattice = declared.lattice.clone();
            let mut words = declared.words.iter().map(|text| Word::new(text.as_str(), cx.span));
            let Some(name) = words.next() else { return Ok(()) };
            let cmd = Command { name, args: words.collect(), span: cx.span, text: declared.words.join(" ") };
            declare(graph, w, &cmd, cx).map(drop)
        });
    w.lattice = lattice;
    outcome
}

fn choose(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<()> {
    let head: heads::PairStyle = inner(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let Or::Else(word) = head.style else {
        args.finish()?;
        graph.pair = None;
        w.touch();
        return Ok(());
    };
    let style = style(&graph.tables.pairs, "pair", &word)?;
    let pair = style.build(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let options = style.options();
    match args.peek() {
        Some(word) if !options.is_empty() => return Err(args.unknown(word, &options)),
        _ => args.finish()?,
    }
    graph.pair = Some(PairNode { pair, span: cx.span, lines: vec![] });
    w.set_anew(false, None);
    w.touch();
    Ok(())
}

/// `pair_coeff I J …`.
pub fn pair_coeff(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    needs_box(w, args)?;
    let Some(node) = &graph.pair else {
        return Err(Diagnostic::error(
            Code::WRONG_ORDER,
            args.name_span(),
            "pair_coeff comes before any pair_style",
        )
        .help("put a `pair_style` line first")
        .into());
    };
    let heads::PairCoeff { first: Types(i0, i1), second: Types(j0, j1) } =
        inner(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let pairs: Vec<(u16, u16)> = (i0..=i1).flat_map(|i| (j0.max(i)..=j1).map(move |j| (i, j))).collect();
    if pairs.is_empty() {
        return Err(Diagnostic::error(Code::BAD_VALUE, cx.span, "these types name no pair i ≤ j")
            .help("write the smaller type first, as `pair_coeff 1 2 …`")
            .into());
    }
    let mut pair = node.pair.clone();
    pair.coeff(&pairs, args, &cx.build(graph, w, "", GroupId::ALL))?;
    args.finish()?;
    pair.declare(w);
    if let Some(node) = &mut graph.pair {
        node.pair = pair;
    }
    w.set_anew(false, Some(&pairs));
    w.touch();
    Ok(Declared::default())
}

/// `peri_modify`.
pub fn peri_modify(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    let Some(node) = &graph.pair else {
        let text = format!("`{}` comes before any pair_style", args.command());
        return fail(Code::WRONG_ORDER, args.name_span(), text);
    };
    let mut pair = node.pair.clone();
    pair.modify(PairOption::Peri(args), &cx.build(graph, w, "", GroupId::ALL))?;
    args.finish()?;
    if let Some(node) = &mut graph.pair {
        node.pair = pair;
    }
    w.touch();
    Ok(Declared::default())
}
