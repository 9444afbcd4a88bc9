//! `bond_style` and `bond_coeff`: lines that declare forces along bonds.

use super::declaration::{Context, Declared, needs_box, style};
use super::heads;
use super::node::{BondNode, FixNode, Graph};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span};
use perigrain_lang::Args;
use perigrain_pairs::bond::{BROUGHT, BondForce};
use perigrain_styles::Fix;
use perigrain_styles::words::{Or, Types, inner};
use perigrain_world::{GroupId, World};
use std::collections::BTreeMap;

/// `bond_style STYLE …`, `bond_style none`.
pub fn bond_style(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    let head: heads::BondStyle = inner(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let Or::Else(word) = head.style else {
        args.finish()?;
        graph.bond = None;
        w.bonds.coeffs = None;
        bring_along(graph, w, vec![], cx.span)?;
        w.touch();
        return Ok(Declared::default());
    };
    if !w.particles.style.bonded {
        let text = format!("particles of atom_style {} have no bonds", w.particles.style.name());
        let d = Diagnostic::error(Code::CONFLICT, args.name_span(), text);
        return Err(d.help("`atom_style bond`, alone or in a hybrid, has them").into());
    }
    let style = style(&graph.tables.bonds, "bond", &word)?;
    let force = style.build(args, &cx.build(graph, w, "", GroupId::ALL))?;
    args.finish()?;
    bring_along(graph, w, force.fixes(), cx.span)?;
    enter(graph, w, force, cx.span, false);
    w.set_anew(true, None);
    Ok(Declared::default())
}

/// The fixes that a bond style brings along, in place of those of the one before.
fn bring_along(
    graph: &mut Graph,
    w: &mut World,
    fixes: Vec<(String, Box<dyn Fix>)>,
    span: Span,
) -> Result<()> {
    for (id, _) in &fixes {
        if let Some(old) = graph.fixes.iter().find(|f| f.id == *id && f.style != BROUGHT) {
            let text = format!("fix `{id}` exists already, with another style");
            let d = Diagnostic::error(Code::DUPLICATE_NAME, span, text).label(old.span, "defined here");
            return Err(d.help("choose another ID for `store/local`").into());
        }
    }
    let old: Vec<FixNode> = graph.fixes.extract_if(.., |f| f.style == BROUGHT).collect();
    // A restart file repeats the line, and so does the deck: state kept then is valid.
    let again = |id: &str, fix: &dyn Fix| {
        let (restored, shape) = (w.resume.is_some(), fix.shape());
        restored
            && old.iter().any(|o| {
                o.id == id && (o.fix.shape().local, o.fix.shape().every) == (shape.local, shape.every)
            })
    };
    let fixes: Vec<_> = fixes.into_iter().map(|(id, fix)| (again(&id, &*fix), id, fix)).collect();
    for node in &old {
        if !fixes.iter().any(|(again, id, _)| *again && *id == node.id) {
            node.fix.remove(w);
        }
    }
    for (again, id, fix) in fixes {
        if !again {
            w.inherit(&format!("{BROUGHT}/{id}"), |w| fix.declare(w))?;
        }
        let group = GroupId::ALL;
        graph.fixes.push(FixNode {
            id,
            style: BROUGHT,
            group,
            fix,
            energy: false,
            level: None,
            span,
            lines: vec![],
        });
    }
    Ok(())
}

/// `bond_coeff TYPES …`.
pub fn bond_coeff(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    needs_box(w, args)?;
    let Some(node) = &graph.bond else {
        let d =
            Diagnostic::error(Code::WRONG_ORDER, args.name_span(), "bond_coeff comes before any bond_style");
        return Err(d.help("put a `bond_style` line first").into());
    };
    if w.bonds.types == 0 {
        let d = Diagnostic::error(Code::CONFLICT, args.here(), "there are no bond types");
        return Err(d.help("set the number: `create_box … bond/types N`").into());
    }
    let heads::BondCoeff { types: Types(first, last) } = inner(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let kinds: Vec<u16> = (first..=last).collect();
    let mut force = node.force.clone();
    force.coeff(&kinds, args, &cx.build(graph, w, "", GroupId::ALL))?;
    args.finish()?;
    let span = node.span;
    enter(graph, w, force, span, true);
    let own: Vec<(u16, u16)> = kinds.iter().map(|k| (*k, *k)).collect();
    w.set_anew(true, Some(&own));
    Ok(Declared::default())
}

/// Puts a style in force, with the lines of the former one where it only gained coefficients.
fn enter(graph: &mut Graph, w: &mut World, force: Box<dyn BondForce>, span: Span, same: bool) {
    let texts = (1..=w.bonds.types).filter_map(|k| Some((k, force.written(k as u16)?)));
    w.bonds.coeffs = Some((force.name().to_string(), texts.collect::<BTreeMap<_, _>>()));
    let lines = graph.bond.take().filter(|_| same).map_or(vec![], |node| node.lines);
    graph.bond = Some(BondNode { force, span, lines });
    w.touch();
}

/// Bonds without a style, types without coefficients.
pub fn check(graph: &Graph, w: &World, span: Span, found: &mut Diagnostics) {
    let Some(node) = &graph.bond else {
        if !w.bonds.is_empty() {
            let text = "there are bonds but no bond_style: they exert no forces";
            found.push(
                Diagnostic::warning(Code::NO_FORCES, span, text)
                    .help("`bond_style zero` states that this is meant"),
            );
        }
        return;
    };
    companion(graph, node, span, found);
    let missing: Vec<String> =
        (1..=w.bonds.types).filter(|&k| !node.force.covers(k as u16)).map(|k| k.to_string()).collect();
    if !missing.is_empty() {
        let text = format!(
            "bond_style {} has no coefficients for bond types {}",
            node.force.name(),
            missing.join(", ")
        );
        let d = Diagnostic::error(Code::INCOMPLETE, span, text).label(node.span, "bond_style given here");
        found.push(d.help(format!("add `bond_coeff {} …`", missing[0])));
    }
}

/// Angles without a style, types without coefficients.
pub fn check_angles(w: &World, span: Span, found: &mut Diagnostics) {
    let angles = &w.bonds.angles;
    if angles.style.is_none() && !angles.list.is_empty() {
        let text = "there are angles but no angle_style: they exert no forces";
        let d = Diagnostic::warning(Code::NO_FORCES, span, text);
        found.push(d.help("`angle_style zero` states that this is meant"));
    }
    if let Some(first) = angles.missing().first() {
        let text = format!("angle_style zero has no coefficients for angle type {first}");
        let d = Diagnostic::error(Code::INCOMPLETE, span, text);
        found.push(d.help(format!("add `angle_coeff {first}`")));
    }
}

/// A bond style that leaves some forces to a pair style needs that one.
fn companion(graph: &Graph, node: &BondNode, span: Span, found: &mut Diagnostics) {
    let wanted = node.force.companions();
    let pair = graph.pair.iter().flat_map(|p| std::iter::once(p.pair.as_ref()).chain(p.pair.parts()));
    if wanted.is_empty() || pair.into_iter().any(|p| wanted.contains(&p.facts().name)) {
        return;
    }
    let text = format!("bond_style {} needs pair_style {}", node.force.name(), wanted.join(" or "));
    let d = Diagnostic::error(Code::INCOMPLETE, span, text).label(node.span, "bond_style given here");
    found.push(d.help(format!("put `pair_style {}` before the run", wanted[0])));
}
