//! Lines of a deck acted on a bare world, for tests of commands.

use crate::{ActCx, BuildCx, CommandStyle, Flow, Motion, Names, Shape, UseKind, Values};
use perigrain_base::diag::{Diagnostics, FileId, Result, Span, fail};
use perigrain_lang::{Args, Command, ValueRef, Word};
use perigrain_world::{GroupId, World};
use std::cell::RefCell;

/// Variables `a NAME = formula of a particle` that the lines may use.
pub type AtomVariable = (&'static str, fn(&World, usize) -> f64);

/// The commands that lines may name.
pub type Commands<'a> = &'a [&'a dyn CommandStyle];

struct Variables<'a>(&'a [AtomVariable]);

impl Names for Variables<'_> {
    fn compute(&self, _id: &str) -> Option<Shape> {
        None
    }
    fn fix(&self, _id: &str) -> Option<Shape> {
        None
    }
    fn variable_shape(&self, name: &str) -> Option<Shape> {
        let shape = Shape { atom: Some(1), ..Shape::default() };
        self.0.iter().any(|(n, _)| *n == name).then_some(shape)
    }
    fn all(&self, _kind: UseKind) -> Vec<String> {
        self.0.iter().map(|(n, _)| n.to_string()).collect()
    }
}

impl Values for Variables<'_> {
    fn with_internal(&mut self, w: &mut World, r: &ValueRef, _set: &[(&ValueRef, f64)]) -> Result<f64> {
        self.scalar(w, r)
    }
    fn scalar(&mut self, _w: &mut World, r: &ValueRef) -> Result<f64> {
        fail(perigrain_base::diag::Code::WRONG_KIND, r.span, "no single number")
    }
    fn per_atom(&mut self, w: &mut World, r: &ValueRef) -> Result<Vec<f64>> {
        let Some((_, f)) = self.0.iter().find(|(n, _)| *n == r.name) else {
            return fail(perigrain_base::diag::Code::UNKNOWN_NAME, r.span, "no such variable");
        };
        Ok((0..w.n()).map(|i| f(w, i)).collect())
    }
    fn flow(&mut self, w: &mut World, _compute: &ValueRef) -> Result<Flow> {
        Ok(Flow { taken: vec![[0.0; 3]; w.n()], group: GroupId::ALL, whole: [false; 3], apart: vec![] })
    }
    fn stop(&mut self, _w: &mut World, fix: &Word, _what: Motion) -> Result<()> {
        fail(perigrain_base::diag::Code::UNKNOWN_NAME, fix.span, "no such fix")
    }
}

/// A line cut at blanks, with places.
pub fn command(line: &str) -> Command {
    let mut words = vec![];
    let mut at = 0;
    for text in line.split_whitespace() {
        let start = at + line[at..].find(text).expect("a word of the line");
        at = start + text.len();
        words.push(Word::new(text, Span::new(FileId(0), start, at)));
    }
    let span = words[0].span.to(words[words.len() - 1].span);
    Command { name: words.remove(0), args: words, span, text: line.to_string() }
}

/// Executes one line on the world; returns its log lines.
///
/// # Errors
/// What the command refuses.
pub fn act(
    commands: Commands,
    world: &mut World,
    line: &str,
    variables: &[AtomVariable],
) -> Result<Vec<String>> {
    let command = command(line);
    let Some(style) = commands.iter().find(|c| c.name() == command.name.text) else {
        return fail(perigrain_base::diag::Code::UNKNOWN_COMMAND, command.span, "no such command");
    };
    let notes = RefCell::new(Diagnostics::default());
    let uses = RefCell::new(vec![]);
    let mut args = Args::new(&command);
    let mut table = Variables(variables);
    let cx = BuildCx {
        world,
        names: &table,
        id: "",
        group: GroupId::ALL,
        span: command.span,
        checking: false,
        notes: &notes,
        uses: &uses,
    };
    let parsed = style.parse(&mut args, &cx)?;
    args.finish()?;
    let (mut lines, mut then) = (vec![], vec![]);
    let mut cx = ActCx {
        world,
        values: &mut table,
        span: command.span,
        lines: &mut lines,
        then: &mut then,
        notes: &notes,
    };
    parsed.apply(&mut cx)?;
    Ok(lines)
}

/// The world after these lines, each of which must work.
pub fn scene(commands: Commands, lines: &str) -> World {
    let mut world = World::default();
    more(commands, &mut world, lines);
    world
}

/// Acts further lines, each of which must work.
pub fn more(commands: Commands, world: &mut World, lines: &str) {
    for line in lines.lines().filter(|l| !l.trim().is_empty()) {
        act(commands, world, line, &[]).unwrap_or_else(|d| panic!("{line}: {d}"));
    }
}

/// The word that is to blame in a line that must fail, and the message.
pub fn refused(commands: Commands, world: &World, line: &str) -> (String, String) {
    let mut copy = world.clone();
    let d = act(commands, &mut copy, line, &[]).expect_err(line).0.remove(0);
    let span = d.span.unwrap_or_default();
    (line[span.start as usize..span.end as usize].to_string(), d.message)
}
