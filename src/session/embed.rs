//! The interface for a program that hosts a session, between lines: files to execute, values, names.

mod columns;
mod gather;
mod globals;
mod making;
mod outside;

use super::Session;
use super::flow::LIGHT;
use crate::graph::catalogue::Tables;
use crate::graph::env::DeckEnv;
use crate::graph::node::FixNode;
pub use columns::Column;
pub use gather::{Order, Rows};
pub use globals::Global;
pub use making::Newcomers;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, FileId, Result, Span, fail, nearest};
use perigrain_lang::{Expr, Kind, RefKind, Value, ValueRef, substitute};
use perigrain_output::rows::Table;
use perigrain_output::table_row::{LATEST_ROW, TableRow};
use perigrain_output::thermo;
use perigrain_styles::Names;
use perigrain_world::Slot;

/// The present value of a variable.
#[derive(Clone, Debug, PartialEq)]
pub enum VariableValue {
    /// One number.
    Number(f64),
    /// A global vector.
    Vector(Vec<f64>),
    /// A number per particle.
    Particles(Vec<f64>),
    /// A text.
    Text(String),
}

/// The columns of a step table.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    /// What stands above each.
    pub headings: Vec<String>,
    /// Which hold whole numbers.
    pub whole: Vec<bool>,
    /// Their values from the first row on.
    pub values: Vec<Vec<f64>>,
}

impl Session {
    /// The value of a word of thermo output or of a formula at the moment.
    ///
    /// # Errors
    /// Words that cannot be read, are no number, or have not been computed.
    pub fn number(&mut self, formula: &str) -> Result<f64> {
        self.thermo_computes();
        let span = self.request_span(formula);
        let expr = Expr::parse(formula, span)?;
        let mut env = DeckEnv { w: &mut self.world, graph: &self.graph };
        match expr.number(&self.vars, &mut env).map_err(|e| e.at(span))? {
            Some(number) => Ok(number),
            None => fail(Code::WRONG_KIND, span, format!("`{formula}` is no number")),
        }
    }

    /// A text with its `$x`, `${name}` and `$(formula)` replaced, as in a line of a deck.
    ///
    /// # Errors
    /// Unknown variables, formulas that cannot be evaluated.
    pub fn expand(&mut self, text: &str) -> Result<String> {
        self.thermo_computes();
        let span = self.request_span(text);
        let mut env = DeckEnv { w: &mut self.world, graph: &self.graph };
        substitute(text, span, &self.vars, &mut env)
    }

    /// The value of a variable; `None` if there is no such variable.
    ///
    /// # Errors
    /// A formula that cannot be evaluated.
    pub fn variable(&mut self, name: &str) -> Result<Option<VariableValue>> {
        let Some(kind) = self.vars.kind(name) else { return Ok(None) };
        self.thermo_computes();
        let holds_number = matches!(
            kind,
            Kind::Equal | Kind::Atom | Kind::Vector | Kind::Atomfile | Kind::Internal | Kind::Timer
        );
        if !holds_number {
            return self.expand(&format!("${{{name}}}")).map(|text| Some(VariableValue::Text(text)));
        }
        let span = self.request_span(&format!("v_{name}"));
        let mut env = DeckEnv { w: &mut self.world, graph: &self.graph };
        Ok(Some(match self.vars.value(name, span, &mut env)? {
            Value::Number(number) => VariableValue::Number(number),
            Value::Vector(list) => VariableValue::Vector(list),
            Value::Atom(list) => VariableValue::Particles(list),
            Value::Unknown => {
                return fail(Code::WRONG_KIND, span, format!("variable `{name}` has no value here"));
            }
        }))
    }

    /// Gives a variable another number: one of style `internal`.
    ///
    /// # Errors
    /// No such variable, or one of another style.
    pub fn set_number(&mut self, name: &str, value: f64) -> Result<()> {
        if self.vars.set_internal(name, value) {
            self.moved(name);
            return Ok(());
        }
        self.no_variable(name, "internal")
    }

    /// Gives a variable of style `string` another text.
    ///
    /// # Errors
    /// No such variable, or one of another style.
    pub fn set_text(&mut self, name: &str, text: &str) -> Result<()> {
        if self.vars.set_text(name, text) {
            self.moved(name);
            return Ok(());
        }
        self.no_variable(name, "string")
    }

    /// A variable has another value: forces may depend on it.
    fn moved(&mut self, name: &str) {
        if self.graph.lines.forces_use_variable(name) {
            self.world.touch();
        }
    }

    fn no_variable(&self, name: &str, style: &str) -> Result<()> {
        match self.vars.kind(name) {
            Some(kind) => {
                let text = format!("variable `{name}` is of style {}, not {style}", kind.name());
                fail(Code::WRONG_KIND, None, text)
            }
            None => Err(unknown("variable", name, self.vars.names())),
        }
    }

    /// All values of a compute at the moment.
    ///
    /// # Errors
    /// No such compute, or values that cannot be had now.
    pub fn compute_values(&mut self, id: &str) -> Result<&Slot> {
        self.thermo_computes();
        if self.graph.find_compute(id).is_none() {
            return Err(unknown("compute", id, self.graph.computes.iter().map(|c| c.id.as_str())));
        }
        self.slot(RefKind::Compute, id)
    }

    /// All values of a fix, as of the last step in which it made them.
    ///
    /// # Errors
    /// No such fix.
    pub fn fix_values(&mut self, id: &str) -> Result<&Slot> {
        self.known_fix(id)?;
        self.slot(RefKind::Fix, id)
    }

    fn known_fix(&self, id: &str) -> Result<&FixNode> {
        let ids = || self.graph.fixes.iter().map(|f| f.id.as_str());
        self.graph.find_fix(id).ok_or_else(|| unknown("fix", id, ids()))
    }

    fn slot(&mut self, kind: RefKind, id: &str) -> Result<&Slot> {
        let span = self.request_span(&format!("{}_{id}", kind.letter()));
        let r = ValueRef { kind, name: id.to_string(), index: vec![], span };
        let mut env = DeckEnv { w: &mut self.world, graph: &self.graph };
        let slot = env.slot(&r, &self.vars)?;
        let of = match kind {
            RefKind::Fix => self.graph.fix(id),
            _ => self.graph.compute(id),
        };
        self.world.slots.get_mut(slot).offers = of.unwrap_or_default().offers();
        Ok(self.world.slots.get(slot))
    }

    /// The latest row of the step table.
    pub fn table_row(&self) -> Option<&TableRow> {
        self.world.facts.get(*LATEST_ROW).map(|row| &**row)
    }

    /// From now on all rows of step tables are kept for [`Session::table_rows`].
    pub fn keep_table_rows(&self) {
        self.options.log.keep_rows();
    }

    /// The rows of step tables so far, tables of other columns apart: a row that repeats the one before it, as that of a second run
    /// does, counts once.
    pub fn table_rows(&self) -> Vec<Columns> {
        let tables = self.options.log.tables(|tables| tables.0.clone());
        let columns = |table: Table| {
            let Table { columns, mut rows } = table;
            rows.dedup();
            let known = |name: &String| thermo::Column::keyword(name);
            let heading = |name: &String| known(name).map_or_else(|| name.clone(), |column| column.header);
            let whole = |name: &String| known(name).is_some_and(|column| column.kind == thermo::Kind::Int);
            Columns {
                headings: columns.iter().map(heading).collect(),
                whole: columns.iter().map(whole).collect(),
                values: (0..columns.len()).map(|k| rows.iter().map(|row| row.values[k]).collect()).collect(),
            }
        };
        tables.into_iter().map(columns).collect()
    }

    /// Changes whenever particles come, go or change places, and when another scene begins.
    pub fn roster(&self) -> [u64; 3] {
        [self.scenes, self.world.rebuild.roster, self.world.n() as u64]
    }

    /// Particles were changed from outside: nothing that was computed of them stands.
    pub fn changed_from_outside(&mut self) {
        self.world.touch();
        self.world.slots.invalidate();
    }

    /// The program's own styles of a category, under LAMMPS' names for these; `None` if there is no such category.
    pub fn styles(category: &str) -> Option<Vec<&'static str>> {
        Tables::default().names(category)
    }

    /// The ids of a category: compute, dump, fix, group, molecule, region, variable; `None` if there is no such category.
    pub fn ids(&mut self, category: &str) -> Option<Vec<String>> {
        self.thermo_computes();
        let known = self.known();
        Some(match category {
            "compute" => known.computes,
            "dump" => known.dumps,
            "fix" => known.fixes,
            "group" => known.groups,
            "region" => known.regions,
            "variable" => known.variables,
            "molecule" => self.world.templates.keys().cloned().collect(),
            _ => return None,
        })
    }

    /// Whether lines leave particles and all that goes with them as they are, whatever stands in them.
    pub fn is_light(text: &str) -> bool {
        let first = |line: &str| line.split_whitespace().next().is_none_or(|word| LIGHT.contains(&word));
        text.lines().all(first)
    }

    /// One for each particle in a group, 0 for the others.
    ///
    /// # Errors
    /// No such group.
    pub fn members(&self, group: &str) -> Result<Vec<i32>> {
        let Some(id) = self.world.groups.find(group) else {
            return Err(unknown("group", group, self.world.groups.names()));
        };
        Ok(self.world.particles.mask.iter().map(|mask| i32::from(mask & id.bit() != 0)).collect())
    }

    /// Hands all output to the system.
    ///
    /// # Errors
    /// A log file that cannot be written.
    pub fn flush(&self) -> Result<()> {
        self.options.log.flush()
    }

    /// The place of a request from outside; the same words are kept once.
    fn request_span(&mut self, words: &str) -> Span {
        let file = match self.requests.get(words) {
            Some(file) => *file,
            None => {
                let file: FileId = self.sources.add("asked", words);
                self.requests.insert(words.to_string(), file);
                file
            }
        };
        Span::new(file, 0, words.len())
    }
}

/// "There is no …", with the nearest there is.
fn unknown<'a>(what: &str, name: &str, known: impl Iterator<Item = &'a str>) -> Diagnostics {
    let d = Diagnostic::error(Code::unknown(what), None, format!("there is no {what} `{name}`"));
    match nearest(name, known) {
        Some(near) => d.help(format!("did you mean `{near}`?")),
        None => d,
    }
    .into()
}

#[cfg(test)]
mod tests;
