//! `dump`, `undump`, `dump_modify`, `write_dump`: lines that declare snapshots.

use super::declaration::{Context, Declared, deletes, find, needs_box, provides, style};
use super::node::{DumpNode, Graph};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::Args;
use perigrain_styles::UseKind;
use perigrain_world::{GroupId, World};

/// The ID of a dump: any word, for nothing but its own commands names it.
fn id_of<'a>(args: &mut Args<'a>) -> Result<(&'a str, Span)> {
    args.expect("the dump's ID").map(|word| (word.text.as_str(), word.span))
}

fn find_dump(graph: &Graph, id: &str, span: Span) -> Result<usize> {
    let known = graph.dumps.iter().map(|f| f.id.as_str()).collect();
    find(graph.dumps.iter().position(|f| f.id == id), known, "dump", id, span)
}

/// `dump ID GROUP STYLE N FILE …`.
pub fn dump(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    needs_box(w, args)?;
    let (id, id_span) = id_of(args)?;
    if let Some(old) = graph.dumps.iter().find(|d| d.id == id) {
        return Err(Diagnostic::error(Code::DUPLICATE_NAME, id_span, format!("dump `{id}` exists already"))
            .label(old.span, "defined here")
            .help(format!("put `undump {id}` before this line, or choose another ID"))
            .into());
    }
    let group_word = args.expect("the dump's group")?;
    let group = cx.build(graph, w, id, GroupId::ALL).group(group_word)?;
    let style = style(&graph.tables.dumps, "dump", args)?;
    let every = args.integer_from(1, "the dump's interval")?;
    let file = args.peek().map_or(String::new(), |word| word.text.clone());
    let dump = style.build(args, &cx.build(graph, w, id, group))?;
    args.finish()?;
    graph.dumps.push(DumpNode { id: id.to_string(), style: style.name(), every, file, dump, span: cx.span });
    Ok(provides(UseKind::Dump, id))
}

/// `undump ID`.
pub fn undump(graph: &mut Graph, args: &mut Args) -> Result<Declared> {
    let (id, span) = id_of(args)?;
    let k = find_dump(graph, id, span)?;
    args.finish()?;
    graph.dumps.remove(k);
    Ok(deletes(UseKind::Dump, id))
}

/// `dump_modify ID …`.
pub fn dump_modify(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    let (id, span) = id_of(args)?;
    let k = find_dump(graph, id, span)?;
    if args.is_empty() {
        return fail(Code::MISSING_ARGUMENT, args.here(), "dump_modify needs an option");
    }
    let mut dump = graph.dumps[k].dump.clone();
    dump.modify(args, &cx.build(graph, w, id, GroupId::ALL))?;
    args.finish()?;
    if let Some(every) = dump.every() {
        graph.dumps[k].every = every;
    }
    graph.dumps[k].dump = dump;
    Ok(Declared::default())
}

/// A dump built for `write_dump group style file … [modify …]`, not kept.
///
/// # Errors
/// As `dump` and `dump_modify`.
pub fn once_dump(
    graph: &Graph,
    w: &World,
    args: &mut Args,
    cx: &Context,
) -> Result<Box<dyn perigrain_styles::Dump>> {
    needs_box(w, args)?;
    let group_word = args.expect("the group to write")?;
    let group = cx.build(graph, w, "WRITE_DUMP", GroupId::ALL).group(group_word)?;
    let style = style(&graph.tables.dumps, "dump", args)?;
    let build = cx.build(graph, w, "WRITE_DUMP", group);
    let mut line = args.until(|word| word == "modify");
    let mut dump = style.build(&mut line, &build)?;
    line.finish()?;
    if args.eat("modify") {
        dump.modify(args, &build)?;
    }
    args.finish()?;
    Ok(dump)
}
