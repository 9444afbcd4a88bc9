//! What all lines that declare need: the context they are read in, the style they name, what they leave in the record.

use super::node::{Graph, PairNode};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use perigrain_lang::{Args, Command, Word};
use perigrain_styles::{BuildCx, Style, Use, UseKind, lammps};
use perigrain_world::{DeclaredLine, GroupId, World};

/// Finds a style in its table.
///
/// # Errors
/// An unknown style, with the nearest known one; one of LAMMPS with what does the same here.
pub fn style<'t, S: Style + ?Sized>(table: &[&'t S], kind: &str, word: &Word) -> Result<&'t S> {
    let name = lammps::plain(kind, &word.text);
    if let Some(s) = table.iter().find(|s| s.name() == name) {
        return Ok(s);
    }
    let known: Vec<&str> = table.iter().map(|s| s.name()).collect();
    Err(lammps::unknown(kind, &format!("{kind} style"), word, &known))
}

/// What a declaration has done, for the node's record.
#[derive(Default)]
pub struct Declared {
    /// What the line provides now.
    pub provides: Option<Use>,
    /// What it has deleted.
    pub deletes: Option<Use>,
}

/// What the session lends while a line is read.
pub struct Context<'a> {
    /// The whole line.
    pub span: Span,
    /// `perigrain check`.
    pub checking: bool,
    /// Warnings and notes.
    pub notes: &'a std::cell::RefCell<perigrain_base::diag::Diagnostics>,
    /// Names used.
    pub uses: &'a std::cell::RefCell<Vec<Use>>,
}

impl<'a> Context<'a> {
    /// The context a style sees.
    pub fn build<'b>(&'b self, graph: &'b Graph, world: &'b World, id: &'b str, group: GroupId) -> BuildCx<'b>
    where
        'a: 'b,
    {
        BuildCx {
            world,
            names: graph,
            id,
            group,
            span: self.span,
            checking: self.checking,
            notes: self.notes,
            uses: self.uses,
        }
    }
}

pub(super) fn provides(kind: UseKind, id: &str) -> Declared {
    Declared { provides: Some(Use { kind, name: id.to_string() }), deletes: None }
}

pub(super) fn deletes(kind: UseKind, id: &str) -> Declared {
    Declared { provides: None, deletes: Some(Use { kind, name: id.to_string() }) }
}

/// Refuses a line that needs a box before there is one.
///
/// # Errors
/// There is no box.
pub fn needs_box(w: &World, args: &Args) -> Result<()> {
    if w.domain.is_some() {
        return Ok(());
    }
    Err(Diagnostic::error(
        Code::WRONG_ORDER,
        args.name_span(),
        format!("`{}` needs the simulation box, which is not defined yet", args.command()),
    )
    .help("put a `create_box` before this line")
    .into())
}

/// The ID that a line gives to what it declares.
pub(super) fn id_of<'a>(args: &mut Args<'a>, what: &str) -> Result<&'a Word> {
    let word = args.expect(&format!("the {what}'s ID"))?;
    if word.unknown || word.text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Ok(word);
    }
    let text = format!("the ID `{}` may only have letters, digits and underscores", word.text);
    fail(Code::BAD_VALUE, word.span, text)
}

pub(super) fn find(list: Option<usize>, known: Vec<&str>, what: &str, id: &str, span: Span) -> Result<usize> {
    if let Some(k) = list {
        return Ok(k);
    }
    let d = Diagnostic::error(Code::unknown(what), span, format!("there is no {what} `{id}`"));
    Err(match nearest(id, known) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d,
    }
    .into())
}

/// Keeps the lines of the pair style and of fixes for restart files.
pub(super) fn keep_line(graph: &mut Graph, w: &World, cmd: &Command) {
    let words: Vec<String> = std::iter::once(&cmd.name).chain(&cmd.args).map(|w| w.text.clone()).collect();
    let id = cmd.args.first().map_or("", |w| &w.text);
    match cmd.name.text.as_str() {
        name @ ("pair_style" | "pair_coeff" | "pair_modify" | "peri_modify") => {
            let counts = |node: &PairNode| name != "pair_modify" || node.pair.facts().mixes;
            if let Some(node) = graph.pair.as_mut().filter(|node| counts(node)) {
                replace_line(&mut node.lines, DeclaredLine { words, lattice: w.lattice.clone() }, |a, b| {
                    a.words == b.words
                });
            }
        }
        "bond_style" | "bond_coeff" => {
            if let Some(node) = &mut graph.bond {
                replace_line(&mut node.lines, DeclaredLine { words, lattice: w.lattice.clone() }, |a, b| {
                    a.words == b.words
                });
            }
        }
        "fix" | "fix_modify" => {
            if let Some(node) = graph.fixes.iter_mut().find(|f| f.id == id) {
                replace_line(&mut node.lines, words.join(" "), |a, b| a == b);
            }
        }
        _ => {}
    }
}

/// A repeated line counts where it appeared last.
fn replace_line<T>(lines: &mut Vec<T>, line: T, same: impl Fn(&T, &T) -> bool) {
    lines.retain(|old| !same(old, &line));
    lines.push(line);
}
