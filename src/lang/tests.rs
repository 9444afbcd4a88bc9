//! Tests of the room as a whole: decks are pulled through cursor, variables and flow.

use super::*;
use crate::diag::{Result, Sources, Span, render};
use std::collections::BTreeMap;

/// A world with three particles for tests.
#[derive(Default)]
pub(super) struct World {
    pub clock: Clock,
    pub check: bool,
}

impl Env for World {
    fn keyword(&mut self, name: &str) -> Option<Result<Value>> {
        let v = match name {
            "step" => self.clock.step as f64,
            "vol" => 8.0,
            _ => return None,
        };
        Some(Ok(if self.check { Value::Unknown } else { Value::Number(v) }))
    }
    fn reference(&mut self, r: &ValueRef) -> Result<Value> {
        match (r.kind, r.name.as_str(), r.index.as_slice()) {
            (RefKind::Compute, "sum", []) => Ok(Value::Number(42.0)),
            (RefKind::Compute, "sum", [k]) => Ok(Value::Number(10.0 * *k as f64)),
            (RefKind::Compute, "dmg", []) => Ok(Value::Atom(vec![0.0, 0.5, 1.0])),
            (RefKind::ComputeAtom, "om", [i, j]) => Ok(Value::Number((10 * i + j) as f64)),
            (RefKind::Fix, "v", []) => Ok(Value::Vector(vec![1.0, 2.0])),
            _ => crate::diag::fail(crate::diag::Code::UNKNOWN_NAME, r.span, format!("no {r}")),
        }
    }
    fn particle(&mut self, attribute: &str, tag: usize, _: Span) -> Result<Value> {
        let column = self.column(attribute).transpose()?.unwrap_or_default();
        Ok(Value::Number(column.get(tag - 1).copied().unwrap_or(0.0)))
    }
    fn column(&mut self, attribute: &str) -> Option<Result<Vec<f64>>> {
        Some(Ok(match attribute {
            "id" => vec![1.0, 2.0, 3.0],
            "x" => vec![0.5, 1.5, 2.5],
            "vx" => vec![-1.0, 0.0, 1.0],
            _ => return None,
        }))
    }
    fn group_function(&mut self, name: &str, args: &[String], _: Span) -> Result<Value> {
        if self.check {
            return Ok(Value::Unknown);
        }
        Ok(Value::Number((name.len() * 100 + args.len()) as f64))
    }
    fn clock(&self) -> Clock {
        self.clock
    }
    fn natoms(&self) -> usize {
        3
    }
    fn keywords(&self) -> Vec<&str> {
        vec!["step", "vol"]
    }
}

/// Files by name.
#[derive(Default)]
pub(super) struct Shelf(BTreeMap<String, String>);

impl Files for Shelf {
    fn read(&self, path: &str) -> std::io::Result<String> {
        self.0.get(path).cloned().ok_or_else(|| std::io::ErrorKind::NotFound.into())
    }
}

/// Runs a deck; `print` lines go to the result, errors as rendered text behind them.
pub(super) struct Run {
    pub shelf: Shelf,
    pub vars: Vars,
    pub world: World,
    pub echo: Vec<String>,
    pub status: Option<i32>,
}

impl Run {
    pub fn new() -> Self {
        Run {
            shelf: Shelf::default(),
            vars: Vars::new(),
            world: World::default(),
            echo: vec![],
            status: None,
        }
    }

    pub fn deck(&mut self, text: &str) -> String {
        let mut sources = Sources::default();
        let id = sources.add("deck", text);
        let mut script = Script::new(id);
        let mut out = String::new();
        for _ in 0..10_000 {
            match self.one(&mut script, &mut sources, &mut out) {
                Ok(true) => {}
                Ok(false) => return out,
                Err(d) => {
                    out.push_str(&render::plain(&d, &sources));
                    return out;
                }
            }
        }
        out + "endless"
    }

    fn one(&mut self, script: &mut Script, sources: &mut Sources, out: &mut String) -> Result<bool> {
        let Some(line) = script.next(sources, &self.vars, &mut self.world)? else { return Ok(false) };
        self.echo.push(line.raw.clone());
        self.echo.extend(line.echoes.iter().cloned());
        let Some(command) = line.command else { return Ok(true) };
        match script.flow(&command, sources, &mut self.vars, &mut self.world, &self.shelf)? {
            Flow::Quit(status) => {
                self.status = Some(status);
                return Ok(false);
            }
            Flow::Done => return Ok(true),
            Flow::NotMine => {}
        }
        let mut args = Args::new(&command);
        let word = args.expect("a text")?;
        args.finish()?;
        out.push_str(&substitute(&word.text, word.span, &self.vars, &mut self.world)?);
        out.push('\n');
        Ok(true)
    }
}

fn says(deck: &str) -> String {
    Run::new().deck(deck)
}

#[test]
fn reads_lines_as_lammps_does() {
    let mut run = Run::new();
    // every line and result as printed by LAMMPS 22Jul2025
    let deck = "variable x index 3 4\nvariable y equal 1.5\nprint a$x${y}b #comment\n\
        print \"quoted $x ${y} $(v_y*2) $(v_y*2:%.2f) # not comment\"\nprint 'He said \"hi\" $x'\n\
        print \"joined &\n   line\"\nprint joined$(1+2)&\nx\n# comment &\nprint no\nprint \"\"\"a\n $x 'q'\"\"\"\n";
    let out = run.deck(deck);
    assert_eq!(
        out,
        "a31.5b\nquoted 3 1.5 3 3.00 # not comment\nHe said \"hi\" 3\njoined    line\njoined3x\na\n 3 'q'\n"
    );
    assert_eq!(&run.echo[2..5], ["print a$x${y}b #comment", "print a3${y}b ", "print a31.5b "]);
    assert!(run.echo.contains(&"# comment print no".to_owned()));
}

#[test]
fn loops_and_branches_as_lammps_does() {
    let deck = "variable n loop 3\nvariable s string hello\nlabel top\nprint \"pass $n $s $(v_n*2:%.3f)\"\n\
        if \"$n == 2\" then \"print two\" 'print \"$n again\"' elif \"$n == 3\" \"print three\" else \"print first\"\n\
        next n\njump SELF top\nprint end\n";
    // as LAMMPS prints it
    let expected =
        "pass 1 hello 2.000\nfirst\npass 2 hello 4.000\ntwo\n2 again\npass 3 hello 6.000\nthree\nend\n";
    assert_eq!(says(deck), expected);
}
