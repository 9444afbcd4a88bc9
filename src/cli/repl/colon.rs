//! Commands of the prompt: `:plan :graph :plot :slice :show :undo :save :help`.

use super::alone::Alone;
use super::picture::{self, Ink};
use super::{Repl, colours, saving, slicing};
use crate::cli::pager;
use crate::manual::knowing::COLON;
use crate::plot::terminal::{Curve, plot};
use perigrain_base::diag::{nearest, render};
use std::fmt::Write;
use std::path::Path;

/// Characters across and pixels down of a picture.
const PICTURE: (usize, usize) = (80, 80);

/// Characters across of a cut.
const SLICE: usize = 72;

/// What a command prints, or what is wrong with it.
type Outcome = Result<String, String>;

/// The commands with a line each.
pub fn list() -> String {
    COLON.iter().fold(String::from("at the prompt\n"), |text, (name, about)| {
        let (words, about) = about.split_once("  ").unwrap_or(("", about));
        format!("{text}  {:<36} {about}\n", format!("{name} {words}"))
    })
}

impl Repl {
    pub(super) fn colon(&mut self, words: &[&str]) -> Outcome {
        let rest = &words[1..];
        match (words[0], rest) {
            (":plan", []) => {
                let outcome = self.session.plan_text();
                outcome.map(|text| pager::fitted(&text)).map_err(|e| render::plain(&e, &self.session.sources))
            }
            (":graph", []) => Ok(pager::fitted(&self.graph())),
            (":graph", [file]) => write(file, &self.session.dot()),
            (":plot", columns) => self.plot(columns),
            (":slice", rest) => {
                slicing::slice(rest, &mut self.session, Ink::of_stdout(), pager::width(SLICE))
            }
            (":show", [file]) => show(file),
            (":undo", []) => self.go_back(1),
            (":undo", [n]) => match n.parse() {
                Ok(n) if n > 0 => self.go_back(n),
                _ => Err(format!("`{n}` is no number of lines")),
            },
            (":save", [file]) => self.save(file),
            (":help", []) => Ok(pager::fitted(&list())),
            (":help", words) => self.help(&words.iter().map(|w| (*w).to_string()).collect::<Vec<_>>()),
            (name, _) => Err(wrong(name)),
        }
    }

    fn graph(&self) -> String {
        let mut out = String::new();
        for (number, kind, text, from) in self.session.lines() {
            let uses: Vec<String> = from.iter().map(usize::to_string).collect();
            let uses = if uses.is_empty() { String::new() } else { format!("  <- {}", uses.join(", ")) };
            let _ = writeln!(
                out,
                "{number:>4} {kind:<8} {}{uses}",
                text.split_whitespace().collect::<Vec<_>>().join(" ")
            );
        }
        out
    }

    fn plot(&self, columns: &[&str]) -> Outcome {
        let shown = self.log.tables(|t| t.last().map(|(c, _)| c.to_vec())).unwrap_or_default();
        if shown.is_empty() {
            return Err("nothing to plot yet: a `run` prints thermo rows".into());
        }
        if columns.is_empty() {
            return Err(format!("name columns of the step table: {}", shown.join(" ")));
        }
        let mut curves = vec![];
        for name in columns {
            let points: Vec<[f64; 2]> = self
                .log
                .tables(|t| t.column(name))
                .into_iter()
                .map(|(step, _, value)| [step as f64, value])
                .collect();
            if points.is_empty() {
                let near = nearest(name, shown.iter().map(String::as_str));
                let help = near.map_or_else(|| shown.join(" "), |n| format!("did you mean `{n}`?"));
                return Err(format!("no table has had a column `{name}`\n  = help: {help}"));
            }
            curves.push(Curve { name, points });
        }
        Ok(plot(&curves, "step", colours(), pager::width(usize::MAX)))
    }

    fn go_back(&mut self, n: usize) -> Outcome {
        let Some((gone, mark)) = self.undo.back(n, &mut self.session) else {
            return Err("there is no line to take back".into());
        };
        self.log.tables(|t| t.back_to(mark));
        self.lines.truncate(self.lines.len().saturating_sub(gone.len()));
        *self.known.borrow_mut() = self.session.known();
        let mut out = String::new();
        for line in gone {
            let _ = writeln!(out, "taken back: {line}");
        }
        Ok(out)
    }

    fn save(&self, file: &str) -> Outcome {
        let folder = self.session.folder();
        let alone = Alone::new(&self.session.sources, &folder, Path::new(file));
        let (text, odd) = saving::deck(&self.lines, &self.switches, &alone);
        let written = write(file, &text)?;
        Ok(match odd {
            0 => written,
            _ => format!(
                "{written}{odd} line(s) were stopped by Ctrl-C and will go to their end in the deck: see its comments\n"
            ),
        })
    }
}

fn wrong(name: &str) -> String {
    match COLON.iter().find(|c| c.0 == name) {
        Some((name, about)) => {
            let words = about.split_once("  ").map_or("", |p| p.0);
            format!("write `{}`", format!("{name} {words}").trim_end())
        }
        None => match nearest(name, COLON.iter().map(|c| c.0)) {
            Some(near) => format!("the prompt has no `{name}`\n  = help: did you mean `{near}`?"),
            None => format!("the prompt has no `{name}`\n  = help: `:help` lists what it has"),
        },
    }
}

fn write(file: &str, text: &str) -> Outcome {
    std::fs::write(file, text).map_err(|e| format!("cannot write `{file}`: {e}"))?;
    Ok(format!("wrote {file}\n"))
}

fn show(file: &str) -> Outcome {
    let bytes = std::fs::read(file).map_err(|e| format!("cannot read `{file}`: {e}"))?;
    let picture = picture::png(&bytes, pager::width(PICTURE.0), PICTURE.1)
        .map_err(|e| format!("`{file}` is no picture: {e}"))?;
    Ok(picture.text(Ink::of_stdout()))
}
