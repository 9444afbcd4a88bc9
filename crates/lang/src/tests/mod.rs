//! Tests of the room as a whole: decks are pulled through cursor, variables and flow.

mod limits;
mod properties;
mod refusals;

use super::*;
use perigrain_base::diag::{Result, Sources, Span, render};
use std::collections::BTreeMap;

/// A world with three particles for tests.
#[derive(Default)]
pub(super) struct World {
    pub clock: Clock,
    pub check: bool,
}

impl Env for World {
    fn keyword(&mut self, name: &str, _: Span, _: &Vars) -> Option<Result<Value>> {
        let v = match name {
            "step" => self.clock.step as f64,
            "vol" => 8.0,
            _ => return None,
        };
        Some(Ok(if self.check { Value::Unknown } else { Value::Number(v) }))
    }
    fn reference(&mut self, r: &ValueRef, _: &Vars) -> Result<Value> {
        match (r.kind, r.name.as_str(), r.index.as_slice()) {
            (RefKind::Compute, "sum", []) => Ok(Value::Number(42.0)),
            (RefKind::Compute, "sum", [k]) => Ok(Value::Number(10.0 * *k as f64)),
            (RefKind::Compute, "dmg", []) => Ok(Value::Atom(vec![0.0, 0.5, 1.0])),
            (RefKind::ComputeAtom, "om", [i, j]) => Ok(Value::Number((10 * i + j) as f64)),
            (RefKind::Fix, "v", []) => Ok(Value::Vector(vec![1.0, 2.0])),
            _ => perigrain_base::diag::fail(
                perigrain_base::diag::Code::UNKNOWN_NAME,
                r.span,
                format!("no {r}"),
            ),
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
    fn group_function(&mut self, name: &str, args: &[Word], _: Span, _: &Vars) -> Result<Value> {
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
        self.echo.push(line.raw.to_string());
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

fn output_of(deck: &str) -> String {
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
    assert_eq!(output_of(deck), expected);
}

#[test]
fn variables_as_lammps_has_them() {
    // each pair: a deck and what LAMMPS prints for it
    for (deck, expected) in [
        ("variable p loop 2 12 pad\nprint $p\nnext p\nprint $p\n", "02\n03\n"),
        ("variable x loop -3 2\nprint $x\nnext x\nprint $x\n", "-3\n-2\n"),
        (
            "variable x equal 1/3\nprint $x\nprint \"$x $(v_x)\"\n",
            "0.333333333333333\n0.333333333333333 0.33333333333333298176\n",
        ),
        ("variable x equal -0.0\nprint \"$x $(v_x) $(0.0*-1) $(-0.0:%.3f)\"\n", "0 0 0 0.000\n"),
        ("variable x equal 1 + 2\nprint $x\n", "3\n"),
        ("variable x equal \"1 + 2\"\nprint $x\n", "3\n"),
        ("variable x string b\nvariable x index 1\nprint $x\n", "b\n"),
        ("variable x loop 3\nvariable x loop 5\nnext x\nnext x\nprint $x\n", "3\n"),
        ("variable x string a\nvariable x string b\nprint $x\n", "b\n"),
        ("variable n loop 3\nvariable n delete\nvariable n equal 4\nprint $n\n", "4\n"),
        ("variable x delete\nprint a\n", "a\n"),
        ("variable a string 2\nvariable b string \"v $a\"\nvariable a string 3\nprint \"$b\"\n", "v 2\n"),
        ("variable x index a\nprint \"${x}${x}$x\"\n", "aaa\n"),
        ("variable x index \"\"\nprint \"[$x]\"\n", "[]\n"),
        ("variable e getenv PERIGRAIN_NOT_SET\nprint \"[$e]\"\n", "[]\n"),
        (
            "variable y equal 2/3\nvariable f format y %.3g\nvariable z equal v_f*3\nprint \"$f $z\"\n",
            "0.667 2.001\n",
        ),
        (
            "variable y equal 2\nvariable x format y %8.3f\nvariable x format y %5.1f\nprint \"[$x]\"\n",
            "[  2.0]\n",
        ),
        ("variable x string 5\nvariable y equal v_x*2\nprint $y\n", "10\n"),
        ("variable a equal v_b*2\nvariable b equal v_c+1\nvariable c index 3\nprint $a\n", "8\n"),
        ("variable y index 7\nvariable x index $y \"\\$y\" z\nnext x\nprint $x\n", "\\7\n"),
        ("variable y index 7\nprint \"val '$y' x\"\n", "val '$y' x\n"),
        ("variable q loop 9 11\nvariable p loop 2 12 pad\nnext p q\nprint $p$q\n", "0310\n"),
        ("print $((1+2)*3)\nprint $(1+2:%.3f)z\n", "9\n3.000z\n"),
        ("variable a atom x*2\nprint $(v_a[2]+v_a[3])\n", "8\n"),
    ] {
        assert_eq!(output_of(deck), expected, "{deck}");
    }
}

#[test]
fn command_line_values_win() {
    let mut run = Run::new();
    run.vars.set_index("x", &["9".into(), "8".into()]).unwrap();
    run.vars.set_index("x", &["7".into()]).unwrap();
    assert_eq!(run.deck("variable x index 5\nprint $x\nnext x\nprint $x\n"), "9\n8\n");
    assert!(run.vars.set_index("a.b", &["1".into()]).is_err());
    assert!(run.vars.set_index("y", &[]).is_err());
}

#[test]
fn files_nest_as_lammps_nests_them() {
    let mut run = Run::new();
    let inc1 = "print \"in inc1\"\njump SELF e\nprint no\nlabel e\nprint \"end inc1\"\n";
    run.shelf.0.insert("inc1".into(), inc1.into());
    run.shelf.0.insert("inc2".into(), "print \"in inc2\"\njump inc1\nprint never\n".into());
    run.shelf.0.insert("loop".into(), "include loop\n".into());
    // as LAMMPS prints them
    assert_eq!(run.deck("include inc2\nprint back\n"), "in inc2\nin inc1\nend inc1\nback\n");
    let nested = "if 1 then \"include inc1\" \"print b\"\nprint back\n";
    assert_eq!(run.deck(nested), "in inc1\nend inc1\nb\nback\n");
    assert_eq!(run.deck("if 1 then \"jump inc1\" \"print b\"\nprint back\n"), "b\nin inc1\nend inc1\n");
    let skipped = "if 1 then \"jump SELF e\" \"print a\"\nprint b\nlabel e\nprint c\n";
    assert_eq!(run.deck(skipped), "c\n");
    assert!(run.deck("include loop\n").contains("nest deeper"));
    assert!(run.deck("include inc3\n").contains("the file `inc3` does not exist"));
    assert!(run.deck("jump SELF nowhere\n").contains("there is no `label nowhere`"));
}

#[test]
fn quit_ends_with_its_status() {
    let mut run = Run::new();
    assert_eq!(run.deck("print a\nif \"2 > 1\" then \"quit 3\"\nprint b\n"), "a\n");
    assert_eq!(run.status, Some(3));
}

#[test]
fn messages_show_use_and_definition() {
    let out = output_of("variable radius index 0.5x\nvariable r2 equal v_radius*2\nprint ${r2}\n");
    assert!(out.contains("variable `radius` holds `0.5x`"), "{out}");
    // the word in the formula, the definition, and the place that refers to it
    assert!(
        out.contains("deck:2:19") && out.contains("defined here") && out.contains("evaluated here"),
        "{out}"
    );
    let out = output_of("variable alpha equal 2\nprint $alpha\n");
    assert!(out.contains("names of more than one letter need braces: ${alpha}"), "{out}");
    let out = output_of("variable a equal 1\nprint a &\n  ${b}\n");
    assert!(out.contains("deck:3:3"), "{out}");
}

#[test]
fn a_line_at_fault_does_not_stop_the_reading() {
    let mut sources = Sources::default();
    let id = sources.add("deck", "print \"a\nprint $zz\nprint c\n");
    let mut script = Script::new(id);
    let (vars, mut world) = (Vars::new(), World::default());
    assert!(script.next(&mut sources, &vars, &mut world).is_err());
    assert_eq!(script.raw(), "print \"a");
    assert!(script.next(&mut sources, &vars, &mut world).is_err());
    assert_eq!(script.raw(), "print $zz");
    let line = script.next(&mut sources, &vars, &mut world).unwrap().unwrap();
    assert_eq!(&*line.raw, "print c");
    assert_eq!(script.next(&mut sources, &vars, &mut world), Ok(None));
}

#[test]
fn unknown_values_lead_into_both_branches() {
    let mut run = Run::new();
    run.world.check = true;
    let deck = "variable n equal count(all)\nif \"$n > 5\" then \"print a\" \"quit\" else \"print b\"\nprint \"$n\"\n\
        variable k loop $n\nlabel top\nprint turn\nif \"${n} > 3\" then \"jump SELF out\"\nnext k\njump SELF top\n\
        label out\nprint out\nlabel again\nif \"$n == 0\" then quit\njump SELF again\nprint end\n";
    // one turn of the unknown loop, and the endless one is left after one more turn
    assert_eq!(run.deck(deck), "a\nb\n1\nturn\nout\nend\n");
    let line = "variable m equal vol\nvariable j equal v_m+1\nprint ${j}\n";
    let mut sources = Sources::default();
    let id = sources.add("deck", line);
    let mut script = Script::new(id);
    let mut words = vec![];
    while let Some(l) = script.next(&mut sources, &run.vars, &mut run.world).unwrap() {
        let c = l.command.unwrap();
        script.flow(&c, &mut sources, &mut run.vars, &mut run.world, &run.shelf).unwrap();
        words.extend(c.args.clone());
    }
    assert!(words.last().unwrap().unknown);
}

#[test]
fn conditions_are_settled_by_what_is_known() {
    for (condition, branches) in [
        ("0 && $n", "b"),
        ("$n && 1 < 0", "b"),
        ("1 || $n", "a"),
        ("!$n || 2 > 1", "a"),
        ("$n || 0", "ab"),
        ("!($n && 1)", "ab"),
        ("$n == a", "ab"),
    ] {
        let mut run = Run::new();
        run.world.check = true;
        let deck = format!("variable n equal vol\nif \"{condition}\" then \"print a\" else \"print b\"\n");
        assert_eq!(run.deck(&deck).replace('\n', ""), branches, "{condition}");
    }
}

#[test]
fn what_a_run_may_leave_out_is_unknown_behind_it() {
    let mut run = Run::new();
    run.world.check = true;
    // the loop is left after one turn, `a` may have been set again; `b` may have been passed over
    let deck = "variable n equal vol\nvariable a equal 0\nvariable b equal 1\nlabel top\nvariable a equal 2\n\
        if \"$n > 1\" then \"jump SELF top\"\nif \"$n > 1\" then \"jump SELF down\"\nvariable b equal 5\n\
        if \"$b != 5\" then \"print never\"\nlabel down\n\
        if \"$a == 2\" then \"print yes\" else \"print no\"\nif \"$b == 5\" then \"print yes\" else \"print no\"\n\
        variable i loop 4\nlabel turn\nif \"$n > 1\" then \"jump SELF out\"\nprint $i\nnext i\njump SELF turn\n\
        label out\nprint \"end $i\"\n";
    // a loop that `next` ends is followed to its end; its variable may still be there
    assert_eq!(run.deck(deck), "yes\nno\nyes\nno\n1\n2\n3\n4\nend 1\n");
}
