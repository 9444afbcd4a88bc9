//! Ops on ranks: what an op asks for before it acts, where rows are shared out, and what is up to date afterwards.

use super::{Needs, Stage, StepPlan, Tick, When};
use perigrain_world::World;
use perigrain_world::share::SHARED;

/// Of which rows an op has the values it reads, where particles are shared out to ranks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Span {
    /// Reads and changes rows of its own rank, each by itself.
    Own,
    /// Also reads those near them.
    Near,
    /// Asks for what it needs itself ([`World::whole`]), and changes all rows alike on all ranks.
    Asks,
    /// All ranks do the same to all rows.
    #[default]
    All,
}

/// Before ops act: rows of what they touch.
pub(super) fn before(w: &mut World, span: Span, needs: impl Iterator<Item = Needs>) {
    if w.share.is_none() {
        return;
    }
    match span {
        Span::All => needs.for_each(|needs| w.whole(needs.touched())),
        Span::Near => needs.for_each(|needs| w.halo(needs.read_alone())),
        Span::Own | Span::Asks => {}
    }
    if let Some(share) = &mut w.share {
        share.narrow = matches!(span, Span::Own | Span::Near);
    }
}

/// After they have acted.
pub(super) fn after(w: &mut World, span: Span, needs: impl Iterator<Item = Needs>) {
    let Some(share) = &mut w.share else { return };
    if std::mem::take(&mut share.narrow) {
        needs.for_each(|needs| w.strays(needs.changed()));
    } else if span == Span::Asks || span == Span::All {
        if w.is_misdealt() {
            w.deal();
        }
    }
}

impl StepPlan {
    /// Shares particles out to ranks, where that spares work: where what acts in every step does so on the rows of one rank.
    pub(super) fn deal(&mut self, w: &mut World, t: &Tick) {
        if self.guard.is_some() || self.levels.is_some() {
            return;
        }
        w.deal();
        let quiet = Tick { told: !self.watched.is_empty(), ..t.clone() };
        let mut everywhere = vec![];
        let mut strays = perigrain_world::Fields::NONE;
        for p in self.ops.iter_mut().filter(|p| p.about.when == When::Always) {
            if w.share.is_none() {
                return;
            }
            match p.span(w, &quiet) {
                Span::All if p.about.stage != Stage::Output => everywhere.push(p.about.needs.touched()),
                Span::Own | Span::Near => strays |= p.about.needs.changed().and_only(SHARED),
                _ => {}
            }
        }
        if everywhere.iter().any(|touched| touched.has(strays)) {
            w.undeal();
        }
    }
}
