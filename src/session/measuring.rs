//! Results of an executed deck in numbers: the cost of its runs, and values by their words.

use super::Session;
use crate::graph::declaration::Context;
use crate::graph::env::DeckEnv;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, nearest};
use perigrain_lang::{Expr, Kind, RefKind, ValueRef, Word, substitute};
use perigrain_output::rows::Row;
use perigrain_plan::run::verlet;
use perigrain_world::GroupId;
use std::cell::RefCell;

/// What all runs of a session together have made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Worked {
    /// Steps.
    pub steps: i64,
    /// Wall time of the steps, setups not included [s].
    pub seconds: f64,
}

impl Worked {
    pub(super) fn add(&mut self, run: &verlet::Outcome) {
        self.steps += run.steps;
        self.seconds += run.time.as_secs_f64();
    }
}

impl Session {
    /// What all runs so far have made.
    pub fn worked(&self) -> Worked {
        self.worked
    }

    /// The last row of the step table with its columns, if the log keeps rows.
    pub fn last_row(&self) -> Option<(Vec<String>, Row)> {
        self.options.log.tables(|t| t.last().map(|(columns, row)| (columns.to_vec(), row.clone())))
    }

    /// From now on step tables show these words too, as far as the deck has them when a run begins.
    pub fn add_columns(&mut self, words: Vec<String>) {
        self.columns = words;
    }

    /// Adds the requested columns that it lacks to the step table of the run that begins.
    pub(super) fn complete_table(&mut self) {
        for word in self.columns.clone() {
            if self.graph.thermo.layout.columns.iter().any(|c| c.name == word) {
                continue;
            }
            let span = Span::new(self.sources.add("report", word.as_str()), 0, word.len());
            let (notes, uses) = (RefCell::default(), RefCell::default());
            let cx = Context { span, checking: false, notes: &notes, uses: &uses };
            let cx = cx.build(&self.graph, &self.world, "", GroupId::ALL);
            let mut thermo = self.graph.thermo.clone();
            // Formulas are no columns, and of names a later run may know more.
            if thermo.add_column(&Word::new(&word, span), &cx).is_ok() {
                self.graph.thermo = thermo;
            }
        }
    }

    /// The present value of `word`, as text: a word of thermo output, `v_name`, `c_ID[2]`, `f_ID`, or a formula of them.
    /// Variables that hold text give their text. Words that the last row of the step table has are taken from there.
    ///
    /// # Errors
    /// Words that mean nothing here, values that do not exist or are not computed.
    pub fn measure(&mut self, word: &str) -> Result<String> {
        let row = self.last_row().filter(|(_, row)| row.step == self.world.clock.step);
        if let Some(at) = row.as_ref().and_then(|(columns, _)| columns.iter().position(|c| c == word)) {
            return Ok(row.map_or(String::new(), |(_, row)| number(row.values[at])));
        }
        let file = self.sources.add("report", word);
        let span = Span::new(file, 0, word.len());
        let text = word.strip_prefix("v_").filter(|name| self.vars.kind(name).is_some_and(holds_text));
        let mut env = DeckEnv { w: &mut self.world, graph: &self.graph };
        if let Some(name) = text {
            return substitute(&format!("${{{name}}}"), span, &self.vars, &mut env);
        }
        let value = Expr::parse(word, span)?.number(&self.vars, &mut env)?;
        Ok(value.map_or(String::new(), number))
    }

    /// Whether the texts read so far use a variable.
    pub fn uses_variable(&self, name: &str) -> bool {
        super::unused::uses(&self.sources, name)
    }

    /// Whether a check has seen all of the deck: none of its files comes from a run only.
    pub fn has_seen_all(&self) -> bool {
        !self.blind
    }

    /// Whether [`Session::measure`] could evaluate `word`, as far as this can be found in a check.
    ///
    /// # Errors
    /// An unknown name.
    pub fn knows_measure(&mut self, word: &str) -> Result<()> {
        let file = self.sources.add("report", word);
        let span = Span::new(file, 0, word.len());
        Expr::parse(word, span)?;
        let Ok(Some(r)) = ValueRef::parse(word, span) else { return Ok(()) };
        let known = self.known();
        let (names, kind) = match r.kind {
            RefKind::Variable => (known.variables, "variable"),
            RefKind::Compute | RefKind::ComputeAtom => (known.computes, "compute"),
            RefKind::Fix | RefKind::FixAtom => (known.fixes, "fix"),
        };
        if names.contains(&r.name) {
            return Ok(());
        }
        let text = format!("at its end the deck has no {kind} `{}`, which is to be reported", r.name);
        let d = Diagnostic::error(Code::unknown(kind), span, text);
        Err(match nearest(&r.name, names.iter().map(String::as_str)) {
            Some(near) => d.help(format!("did you mean `{}{near}`?", &word[..2])),
            None => d,
        }
        .into())
    }
}

/// Whether a variable's value is text, which may be no number.
fn holds_text(kind: Kind) -> bool {
    !matches!(kind, Kind::Equal | Kind::Atom | Kind::Vector | Kind::Atomfile | Kind::Internal | Kind::Timer)
}

/// A number with as few digits as mean it and no other.
fn number(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or(text.clone(), String::from)
}
