//! Lines that declare become nodes: fixes, computes, thermo, and what stands in files of its own.

use super::declaration::{Context, Declared, deletes, find, keep_line, needs_box, provides, style};
use super::heads::{self, FixOptions, OfCompute, OfFix};
use super::node::{ComputeNode, FixNode, Graph};
use super::pair_modify::pair_modify;
use super::{bonds, dumps, pairs};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, Command, Word};
use perigrain_styles::UseKind;
use perigrain_styles::compute::modify;
use perigrain_styles::words::{At, Words, inner, read};
use perigrain_world::{GroupId, World};
use std::cell::RefCell;

/// Handles one declaring line. The caller has a copy of nothing: every change happens last, after all checks.
///
/// # Errors
/// Every mistake in the line; then nothing has changed.
pub fn declare(graph: &mut Graph, w: &mut World, cmd: &Command, cx: &Context) -> Result<Declared> {
    let mut args = Args::new(cmd);
    let declared = match cmd.name.text.as_str() {
        "bond_style" => bonds::bond_style(graph, w, &mut args, cx),
        "bond_coeff" => bonds::bond_coeff(graph, w, &mut args, cx),
        "pair_style" => return pairs::pair_style(graph, w, cmd, cx),
        "pair_coeff" => pairs::pair_coeff(graph, w, &mut args, cx),
        "pair_modify" => pair_modify(graph, w, &mut args, cx),
        "peri_modify" => pairs::peri_modify(graph, w, &mut args, cx),
        "fix" => fix(graph, w, &mut args, cx),
        "unfix" => unfix(graph, w, &mut args, cx),
        "fix_modify" => fix_modify(graph, w, &mut args, cx),
        "compute" => compute(graph, w, &mut args, cx),
        "uncompute" => uncompute(graph, w, &mut args, cx),
        "compute_modify" => compute_modify(graph, w, &mut args, cx),
        "dump" => dumps::dump(graph, w, &mut args, cx),
        "undump" => dumps::undump(graph, w, &mut args, cx),
        "dump_modify" => dumps::dump_modify(graph, w, &mut args, cx),
        "thermo" | "thermo_style" | "thermo_modify" => {
            let mut thermo = graph.thermo.clone();
            let build = cx.build(graph, w, "", GroupId::ALL);
            match cmd.name.text.as_str() {
                "thermo" => thermo.interval(&mut args, &build)?,
                "thermo_style" => thermo.style(&mut args, &build)?,
                _ => thermo.modify(&mut args, &build)?,
            }
            if let Some(temperature) = thermo.new_temperature.take()
                && let Some(press) = graph.computes.iter_mut().find(|c| c.id == thermo.press)
            {
                press.compute.take_temperature(&temperature);
            }
            graph.thermo = thermo;
            Ok(Declared::default())
        }
        "restart" => {
            let mut restarts = graph.restarts.clone();
            restarts.declare(&mut args, &cx.build(graph, w, "", GroupId::ALL))?;
            args.finish()?;
            graph.restarts = restarts;
            Ok(Declared::default())
        }
        other => fail(Code::UNKNOWN_COMMAND, cmd.name.span, format!("`{other}` declares nothing")),
    }?;
    keep_line(graph, w, cmd);
    Ok(declared)
}

fn fix(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    // As in LAMMPS: additional properties of particles may be declared before there is a box.
    if args.peek_at(2).is_none_or(|style| style.text != "property/atom") {
        needs_box(w, args)?;
    }
    let head: heads::Fix = inner(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let (id, id_span) = (head.id.text.as_str(), head.id.span);
    let At { value: group, span: group_span, .. } = head.group;
    let style = style(&graph.tables.fixes, "fix", &head.style)?;
    let fix = style.build(args, &cx.build(graph, w, id, group))?;
    args.finish()?;
    let node = FixNode {
        id: id.to_string(),
        style: style.name(),
        group,
        energy: fix.facts(w).adds_energy,
        fix,
        level: None,
        span: cx.span,
        lines: vec![],
    };
    // LAMMPS lets a fix of the same ID and style replace the old one in its place.
    let old = graph.fixes.iter().position(|f| f.id == id);
    if let Some(k) = old
        && graph.fixes[k].style != node.style
    {
        return Err(Diagnostic::error(
            Code::DUPLICATE_NAME,
            id_span,
            format!("fix `{id}` exists already, with another style"),
        )
        .label(graph.fixes[k].span, "defined here")
        .help(format!("put `unfix {id}` before this line, or choose another ID"))
        .into());
    }
    if let Some(k) = old {
        if graph.fixes[k].group != group {
            let text = format!("fix `{id}` concerns another group than before");
            let d = Diagnostic::warning(Code::SUSPICIOUS, group_span, text);
            let d = d.label(graph.fixes[k].span, "replaces this one");
            cx.build(graph, w, id, group).note(d.help("choose another ID if both are meant"));
        }
        let old = &graph.fixes[k].fix;
        let brought = old.computes();
        old.remove(w);
        brought.iter().for_each(|(id, ..)| take_away(graph, w, id));
    }
    w.inherit(&format!("{}/{id}", node.style), |w| node.fix.declare(w))?;
    let brings = node.fix.computes();
    match old {
        Some(k) => graph.fixes[k] = node,
        None => graph.fixes.push(node),
    }
    for (id, style, words) in &brings {
        if let Some(old) = graph.find_compute(id) {
            let text = format!("this fix brings a compute `{id}`, and there is one already");
            let d = Diagnostic::error(Code::DUPLICATE_NAME, id_span, text).label(old.span, "defined here");
            return Err(d.help("choose another ID for the fix").into());
        }
        let group = if *style == "pressure" { GroupId::ALL } else { group };
        bring(graph, w, (id, style, words), group, cx.span)?;
    }
    w.touch();
    Ok(provides(UseKind::Fix, id))
}

fn find_fix(graph: &Graph, id: &str, span: Span) -> Result<usize> {
    let known = graph.fixes.iter().map(|f| f.id.as_str()).collect();
    find(graph.fixes.iter().position(|f| f.id == id), known, "fix", id, span)
}

fn find_compute(graph: &Graph, id: &str, span: Span) -> Result<usize> {
    let known = graph.computes.iter().map(|f| f.id.as_str()).collect();
    find(graph.computes.iter().position(|f| f.id == id), known, "compute", id, span)
}

fn unfix(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    let OfFix { id } = read(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let k = find_fix(graph, &id.text, id.span)?;
    let id = &id.text;
    let fix = graph.fixes.remove(k).fix;
    fix.remove(w);
    fix.computes().iter().for_each(|(id, ..)| take_away(graph, w, id));
    w.slots.forget(&format!("f_{id}"));
    w.touch();
    Ok(deletes(UseKind::Fix, id))
}

fn fix_modify(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    let OfFix { id } = inner(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let k = find_fix(graph, &id.text, id.span)?;
    if args.is_empty() {
        return fail(Code::MISSING_ARGUMENT, args.here(), "fix_modify needs an option");
    }
    let mut fix = graph.fixes[k].fix.clone();
    let build = cx.build(graph, w, &id.text, graph.fixes[k].group);
    let mut options = FixOptions::begin(args, &build)?;
    while let Some(word) = args.peek() {
        let leveled = word.text != "respa" || fix.facts(w).has_level;
        match FixOptions::GRAMMAR.has(&word.text) && leveled {
            true => drop(args.next().map(|word| options.keyword(word, args, &build)).transpose()?),
            false => fix.modify(args, &build)?,
        }
    }
    let node = &mut graph.fixes[k];
    if let Some(At { value: yes, span, .. }) = options.energy {
        if yes && !fix.facts(w).has_energy {
            return fail(Code::CONFLICT, span, format!("fix {} has no energy to add", node.style));
        }
        node.energy = yes;
    }
    if let Some(from_one) = options.respa {
        node.level = usize::try_from(from_one - 1).ok();
    }
    node.fix = fix;
    w.touch();
    Ok(Declared::default())
}

fn compute(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    needs_box(w, args)?;
    let head: heads::Compute = inner(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let (id, id_span, group) = (head.id.text.as_str(), head.id.span, head.group.value);
    if let Some(old) = graph.find_compute(id) {
        return Err(Diagnostic::error(
            Code::DUPLICATE_NAME,
            id_span,
            format!("compute `{id}` exists already"),
        )
        .label(old.span, "defined here")
        .help(format!("put `uncompute {id}` before this line, or choose another ID"))
        .into());
    }
    let style = style(&graph.tables.computes, "compute", &head.style)?;
    let compute = style.build(args, &cx.build(graph, w, id, group))?;
    args.finish()?;
    w.inherit(&format!("compute {id}"), |w| compute.declare(w))?;
    graph.computes.push(ComputeNode { id: id.to_string(), style: style.name(), compute, span: cx.span });
    forget_values(w, &format!("c_{id}"));
    Ok(provides(UseKind::Compute, id))
}

/// Declares a compute that no line of the deck names: ID, style, and the words behind the style.
///
/// # Errors
/// What the style refuses.
pub fn bring(
    graph: &mut Graph,
    w: &mut World,
    (id, style, words): (&str, &str, &str),
    group: GroupId,
    span: Span,
) -> Result<()> {
    let Some(style) = graph.tables.computes.iter().copied().find(|c| c.name() == style) else {
        return Ok(());
    };
    let args: Vec<Word> = words.split_whitespace().map(|word| Word::new(word, span)).collect();
    let cmd = Command { name: Word::new("compute", span), args, span, text: String::new() };
    let (notes, uses) = (RefCell::default(), RefCell::default());
    let cx = Context { span, checking: false, notes: &notes, uses: &uses };
    let compute = style.build(&mut Args::new(&cmd), &cx.build(graph, w, id, group))?;
    w.inherit(&format!("compute {id}"), |w| compute.declare(w))?;
    graph.computes.push(ComputeNode { id: id.into(), style: style.name(), compute, span });
    forget_values(w, &format!("c_{id}"));
    Ok(())
}

/// Removes a compute that a fix has brought.
fn take_away(graph: &mut Graph, w: &mut World, id: &str) {
    for node in graph.computes.extract_if(.., |c| c.id == id) {
        node.compute.remove(w);
        w.slots.forget(&format!("c_{id}"));
    }
}

/// A slot of an earlier producer with this name must not be read as this one's.
fn forget_values(w: &mut World, name: &str) {
    let slot = w.slots.id(name);
    *w.slots.get_mut(slot) = perigrain_world::Slot { name: name.to_string(), ..Default::default() };
}

fn uncompute(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    let OfCompute { id } = read(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let k = find_compute(graph, &id.text, id.span)?;
    let id = &id.text;
    graph.computes.remove(k).compute.remove(w);
    w.slots.forget(&format!("c_{id}"));
    Ok(deletes(UseKind::Compute, id))
}

fn compute_modify(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    let OfCompute { id } = inner(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let k = find_compute(graph, &id.text, id.span)?;
    let id = &id.text;
    if args.is_empty() {
        return fail(Code::MISSING_ARGUMENT, args.here(), "compute_modify needs an option");
    }
    let mut compute = graph.computes[k].compute.clone();
    modify(&mut *compute, args, &cx.build(graph, w, id, GroupId::ALL))?;
    graph.computes[k].compute = compute;
    forget_values(w, &format!("c_{id}"));
    Ok(Declared::default())
}
