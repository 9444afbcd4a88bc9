//! Variables with several values: `next`, and `next()` in formulas.

use super::{Data, Kind, Variable, Vars};
use crate::args::blame;
use crate::command::Word;
use crate::expr::Trail;
use crate::reference::{RefKind, ValueRef};
use crate::value::{Env, Value};
use perigrain_base::diag::{Code, Result, Span, fail};
use std::sync::Arc;

impl Variable {
    /// Its list or file has come to an end (by `next()` inside a formula).
    pub fn exhausted(&self) -> bool {
        match &self.data {
            Data::Lines(l) => l.is_over(),
            Data::Atoms(a) => a.is_over(),
            _ => false,
        }
    }

    /// Whether it is known how often it can still move on: the values of a list may be unknown, not their number.
    pub fn turns_known(&self) -> bool {
        !self.adrift && (!self.unknown || matches!(self.data, Data::List { .. }))
    }

    /// Gives up the shared position in a file and continues with one of its own.
    pub fn detach(&mut self) {
        match &mut self.data {
            Data::Lines(l) => l.detach(),
            Data::Atoms(a) => a.detach(),
            _ => {}
        }
    }

    /// Goes to a turn, from 0; false if there are not so many.
    fn go_to(&mut self, turn: usize) -> bool {
        match &mut self.data {
            Data::List { values, at } => {
                *at = turn;
                turn < values.len()
            }
            Data::Range { now, last, .. } => {
                *now = turn as i64 + 1;
                *now <= *last
            }
            _ => false,
        }
    }

    /// Moves on; false if there is nothing further.
    pub fn advance(&mut self) -> bool {
        match &mut self.data {
            Data::List { values, at } => {
                *at += 1;
                *at < values.len()
            }
            Data::Range { now, last, .. } => {
                *now += 1;
                *now <= *last
            }
            Data::Lines(l) => l.advance(),
            Data::Atoms(a) => a.advance(),
            _ => false,
        }
    }
}

/// What became of the variables that `next` has moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// All have a further value.
    More,
    /// One has none.
    Over,
    /// Known only in a run; they are taken to have none.
    Unknown,
}

impl Vars {
    /// `next`: advances all of `names`; returns whether one of them has no further value (it is then deleted).
    ///
    /// With `maybe` only a run determines whether the line is reached: nothing advances, and positions are unknown. With `keep`
    /// only a run determines whether variables reach their last value: none is deleted, for lines that read them. Nor are those whose
    /// values only a run determines.
    pub fn next(&mut self, names: &[Word], maybe: bool, keep: bool) -> Result<Next> {
        let family = |k: Kind| if k == Kind::Uloop { Kind::Universe } else { k };
        let mut first = None;
        for name in names {
            let Some(kind) = self.kind(&name.text) else {
                return Err(self.unknown(&name.text, name.span).into());
            };
            if !kind.moves() {
                let message = format!(
                    "`{}` is of style {}; next moves index, loop, file, atomfile, universe and uloop variables",
                    name.text,
                    kind.name()
                );
                return Err(blame(name, Code::WRONG_KIND, message).into());
            }
            if *first.get_or_insert(family(kind)) != family(kind) {
                return fail(Code::CONFLICT, name.span, "all variables of one next must have the same style");
            }
        }
        if maybe {
            names.iter().for_each(|n| self.set_adrift(&n.text));
            return Ok(Next::More);
        }
        self.sets += 1;
        let known = names.iter().all(|n| self.find(&n.text).is_some_and(Variable::turns_known));
        let mut exhausted = false;
        let turn = if first == Some(Kind::Universe) { self.take_turn(names)? } else { None };
        for name in names {
            let Some(v) = Arc::make_mut(&mut self.table).get_mut(&name.text) else { continue };
            self.state = self.state.wrapping_sub(v.state());
            v.set = self.sets;
            let sure = v.turns_known();
            let more = match turn {
                Some(turn) => v.go_to(turn),
                None => v.turns_known() && v.advance(),
            };
            let in_file = matches!(v.data, Data::Lines(_) | Data::Atoms(_));
            self.state = self.state.wrapping_add(v.state());
            if in_file {
                self.event();
            }
            if more {
                continue;
            }
            exhausted = true;
            match keep || !sure {
                true => self.set_adrift(&name.text),
                false => self.remove(&name.text),
            }
        }
        // all partitions of a universe end together
        if exhausted && !keep && first == Some(Kind::Universe) {
            names.iter().for_each(|n| self.remove(&n.text));
        }
        Ok(match (known, exhausted) {
            (false, _) => Next::Unknown,
            (true, true) => Next::Over,
            (true, false) => Next::More,
        })
    }

    /// A variable whose values partitions take in turn begins with this partition's own; the first of several begins a round.
    pub(super) fn begin_round(&mut self, variable: &mut Variable) {
        let shared = self.table.values().any(|v| v.kind.is_shared());
        let Some(partition) = &mut self.partition else { return };
        if !shared {
            partition.rounds += 1;
        }
        variable.go_to(partition.number);
    }

    /// The next turn that no partition has had; `None` where there is one partition.
    fn take_turn(&self, names: &[Word]) -> Result<Option<usize>> {
        let Some(partition) = &self.partition else { return Ok(None) };
        match (partition.turn)(partition.rounds.saturating_sub(1)) {
            Ok(turn) => Ok(Some(turn)),
            Err(e) => {
                let text = format!("the partitions cannot agree on the next one: {e}");
                fail(Code::NO_FILE, names.first().map(|n| n.span), text)
            }
        }
    }

    /// `next(name)` in a formula: the present value of a file- or atomfile-style variable, which then moves on.
    pub(crate) fn take_next(&self, name: &str, span: Span, env: &mut dyn Env) -> Result<Value> {
        let r = ValueRef { kind: RefKind::Variable, name: name.to_owned(), index: vec![], span };
        let Some(variable) = self.find(name) else { return Err(self.unknown(name, span).into()) };
        if variable.unknown {
            return Ok(Value::Unknown);
        }
        if !matches!(variable.kind, Kind::File | Kind::Atomfile) {
            let style = variable.kind.name();
            let message = format!("next() moves file and atomfile variables; `{name}` is of style {style}");
            return fail(Code::WRONG_KIND, span, message);
        }
        let value = self.reference(&r, env, &mut Trail::default())?;
        self.event();
        match &variable.data {
            Data::Lines(l) => l.advance(),
            Data::Atoms(a) => a.advance(),
            _ => false,
        };
        Ok(value)
    }
}
