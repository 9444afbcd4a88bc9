//! Ops on ranks: which rows are brought up to date before an op acts, where rows are shared out, and which are up to date afterwards.

use super::{Needs, StepPlan, Tick};
use perigrain_world::field::{FAMILIES, SITES, TAG};
use perigrain_world::share::{Halo, Traffic};
use perigrain_world::{Fields, World};

/// Of which rows an op has the values it reads, where particles are shared out to ranks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Span {
    /// Reads and changes rows of its own rank, each by itself.
    Own,
    /// Also reads those near them.
    Near,
    /// Also reads those that its lists name ([`World::list_rows`]): all ranks evaluate them alike.
    Listed,
    /// Calls [`World::whole`] for what it needs, and changes all rows alike on all ranks.
    Requested,
    /// All ranks do the same to all rows.
    #[default]
    All,
}

impl std::fmt::Display for Span {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Span::Own => "own",
            Span::Near => "near",
            Span::Listed => "listed",
            Span::Requested => "asked",
            Span::All => "all",
        })
    }
}

/// The fields of which an op of all rows has all of them up to date: those it touches, or all where particles come, go or change places.
fn current_fields(needs: &Needs) -> Fields {
    match needs.changes(TAG) {
        true => Fields::ALL,
        false if needs.changes(FAMILIES) => needs.touched() | SITES,
        false => needs.touched(),
    }
}

/// Before ops act: rows of what they touch.
pub(super) fn before(w: &mut World, span: Span, needs: impl Iterator<Item = Needs>) {
    if w.share.is_none() {
        return;
    }
    match span {
        Span::All => needs.for_each(|needs| w.whole(current_fields(&needs))),
        Span::Near => needs.for_each(|needs| w.halo(needs.read_alone(), Halo::Near)),
        Span::Listed => needs.for_each(|needs| w.halo(needs.read_alone(), Halo::Listed)),
        Span::Own | Span::Requested => {}
    }
    if let Some(share) = &mut w.share {
        share.narrow = matches!(span, Span::Own | Span::Near | Span::Listed);
    }
}

/// After they have acted.
pub(super) fn after(w: &mut World, needs: impl Iterator<Item = Needs>) {
    let Some(share) = &mut w.share else { return w.deal_if_possible() };
    if std::mem::take(&mut share.narrow) {
        needs.for_each(|needs| w.strays(needs.changed()));
    } else if w.is_misdealt() {
        w.deal();
    }
}

/// Runs of fewer steps are not worth dealing.
const FEW: i64 = 8;

/// Shares are taken back once so many more quiet steps of a run have gathered rows than have not: every search for near pairs does, and what
/// looks whether one is due may do so several times in a row.
const ENOUGH: u32 = 8;

impl StepPlan {
    /// Shares particles out to ranks, where there are several and a run of so many steps begins.
    pub(super) fn deal(&mut self, w: &mut World, steps: i64) {
        self.gathering = 0;
        if self.guard.is_none() && self.levels.is_none() && steps >= FEW {
            w.begin_shares();
        }
    }

    /// Takes shares back where what acts in every step has rows gathered again and again: `before` is what ranks had exchanged before this
    /// step.
    pub(super) fn judge_shares(&mut self, w: &mut World, t: &Tick, before: Traffic) {
        if w.share.is_none() || !t.quiet {
            return;
        }
        let gathers = w.traffic().since(before).gathers > 0;
        self.gathering = if gathers { self.gathering + 1 } else { self.gathering.saturating_sub(1) };
        if self.gathering >= ENOUGH {
            w.undeal();
        }
    }
}
