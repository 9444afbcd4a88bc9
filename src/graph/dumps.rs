//! `dump`, `undump`, `dump_modify`, `write_dump`: lines that declare snapshots.

use super::declaration::{Context, Declared, deletes, find, needs_box, provides, style};
use super::heads::{self, OfDump};
use super::node::{DumpNode, Graph};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::Args;
use perigrain_styles::UseKind;
use perigrain_styles::words::{inner, read};
use perigrain_world::{GroupId, World};

fn find_dump(graph: &Graph, id: &str, span: Span) -> Result<usize> {
    let known = graph.dumps.iter().map(|f| f.id.as_str()).collect();
    find(graph.dumps.iter().position(|f| f.id == id), known, "dump", id, span)
}

/// `dump ID GROUP STYLE N FILE …`.
pub fn dump(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    needs_box(w, args)?;
    let head: heads::Dump = inner(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let (id, id_span, group, every) = (head.id.text.as_str(), head.id.span, head.group.value, head.every);
    if let Some(old) = graph.dumps.iter().find(|d| d.id == id) {
        return Err(Diagnostic::error(Code::DUPLICATE_NAME, id_span, format!("dump `{id}` exists already"))
            .label(old.span, "defined here")
            .help(format!("put `undump {id}` before this line, or choose another ID"))
            .into());
    }
    let style = style(&graph.tables.dumps, "dump", &head.style)?;
    let file = args.peek().map_or(String::new(), |word| word.text.clone());
    let dump = style.build(args, &cx.build(graph, w, id, group))?;
    args.finish()?;
    graph.dumps.push(DumpNode { id: id.to_string(), style: style.name(), every, file, dump, span: cx.span });
    Ok(provides(UseKind::Dump, id))
}

/// `undump ID`.
pub fn undump(graph: &mut Graph, w: &World, args: &mut Args, cx: &Context) -> Result<Declared> {
    let OfDump { id } = read(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let k = find_dump(graph, &id.text, id.span)?;
    graph.dumps.remove(k);
    Ok(deletes(UseKind::Dump, &id.text))
}

/// `dump_modify ID …`.
pub fn dump_modify(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    let OfDump { id } = inner(args, &cx.build(graph, w, "", GroupId::ALL))?;
    let k = find_dump(graph, &id.text, id.span)?;
    let id = &id.text;
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
    let head: heads::WriteDump = inner(args, &cx.build(graph, w, "WRITE_DUMP", GroupId::ALL))?;
    let style = style(&graph.tables.dumps, "dump", &head.style)?;
    let build = cx.build(graph, w, "WRITE_DUMP", head.group.value);
    let mut line = args.until(|word| heads::WRITE_DUMP.has(word));
    let mut dump = style.build(&mut line, &build)?;
    line.finish()?;
    if args.next().is_some() {
        dump.modify(args, &build)?;
    }
    args.finish()?;
    Ok(dump)
}
