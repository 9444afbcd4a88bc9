//! Lists of granular contacts: when they are rebuilt, on one rank or several, and contact history meanwhile.

use super::{Force, grains};
use crate::granular::heating::conducts;
use crate::granular::images::suits;
use crate::granular::ranks::{contacts_of_all, contacts_of_others};
use crate::granular::reach::{reaching, refuse_giants};
use crate::shared::{built_at, made_at, near};
use perigrain_base::comm::{self, rows};
use perigrain_base::diag::Result;
use perigrain_contact::driver::Grains;
use perigrain_contact::fast::{Dealt, Fast, Frame, Own};
use perigrain_styles::ledger::PAIR_WORK;
use perigrain_world::field::{F, OMEGA, TORQUE, V, X};
use perigrain_world::index::Index;
use perigrain_world::share::Halo;
use perigrain_world::{Allowed, Share, World};

impl Force {
    /// The present deal of grains to ranks, where contacts can be shared out with it.
    pub(super) fn wanted_deal(&self, w: &World) -> Option<u64> {
        let plain = self.fast.is_some() && self.press.is_none() && !conducts(&self.rules);
        w.grains_dealt().filter(|_| plain && !w.facts.past().has(*PAIR_WORK))
    }

    /// Whether the lists are those of one of several ranks.
    pub(super) fn is_part(&self) -> bool {
        self.is_fast && self.fast.as_ref().is_some_and(Fast::is_part)
    }

    /// Where grains are distributed over ranks: how much work this one's were; the next deal is balanced by it.
    pub(super) fn note_work(&self, w: &mut World) {
        if self.is_part()
            && let (Some(fast), Some(share)) = (&self.fast, &w.share)
        {
            w.dealings.work = fast.work(share.own.iter().map(|rows| rows.len()).sum());
        }
    }

    /// Where grains are shared out to ranks: has the rows that contacts read, those of all ranks where lists are due.
    pub(super) fn bring_up_to_date(&mut self, w: &mut World) {
        let Some(deal) = self.wanted_deal(w) else { return };
        let generation = w.rebuild.generation;
        if self.is_part() && (self.deal, self.generation) == (Some(deal), Some(generation)) {
            w.list_rows((self.key.of(), generation), || self.rows());
            return w.halo(X | V | OMEGA, Halo::Listed);
        }
        w.whole(X | V | OMEGA);
        if self.deal == Some(deal) && !self.is_part() {
            // All ranks evaluate all contacts.
            w.whole(F | TORQUE);
        }
    }

    /// Lists for the present rebuild: those there are, if they outlast it; else new ones from the positions that the world keeps
    /// for that, from which all lists reach far enough until the next rebuild.
    pub(super) fn renew(&mut self, w: &mut World) -> Result<()> {
        let before = self.generation.replace(w.rebuild.generation);
        let deal = self.wanted_deal(w);
        let before = before.filter(|_| self.deal == deal);
        self.deal = deal;
        let ((lo, period), now, kept) = (w.made_in(), w.periods(), &w.rebuild.kept);
        if let Some(fast) = self.fast.as_mut().filter(|fast| self.is_fast && fast.len() == w.n())
            && kept.outlasted > 0
            && before == Some(kept.last[0])
            && w.rebuild.generation == kept.last[1]
        {
            fast.turn(&kept.turns, &now);
            return Ok(());
        }
        let skin = w.settings.neighbor.skin;
        if let Some(pairs) = before.and_then(|g| w.rebuild.only_parted(g))
            && let Some(fast) = self.fast.as_mut().filter(|_| self.is_fast)
        {
            let index = Index::new(&w.particles.tag);
            let ends: Vec<usize> =
                pairs.iter().flatten().filter_map(|id| index.find(*id, &w.particles.tag)).collect();
            let frame = Frame { lo, period, reach: kept.reach(skin), skin };
            let allowed = Allowed::new(w);
            let grains = Grains { x: made_at(w), ..grains(w, period, &[], &[])? };
            let ready = if fast.is_part() { rows::all_agree(fast.can_admit()) } else { fast.can_admit() };
            if ready && fast.admit(&grains, &frame, &ends, &|i, j| allowed.pair(i, j)) {
                return Ok(());
            }
        }
        if self.fast.as_ref().is_some_and(|fast| suits(w, period, fast)) {
            let kept_by_world = if self.is_fast { None } else { w.contacts.remove(self.key) };
            let Some(fast) = &mut self.fast else { return Ok(()) };
            let kept = &w.rebuild.kept;
            let frame = Frame { lo, period, reach: kept.reach(skin), skin };
            let allowed = Allowed::new(w);
            let grains = Grains { x: made_at(w), ..grains(w, period, &[], &[])? };
            let rows = deal.and(w.share.as_ref()).map(Share::rows_of_ranks);
            let dealt = rows.as_ref().map(|rows| Dealt { rows, me: comm::present().rank() });
            let known = |fast: &Fast, own: Option<&Own>| match (own, dealt) {
                _ if !fast.is_part() || w.dealings.apart => kept_by_world,
                (Some(own), Some(dealt)) => Some(contacts_of_others(w, fast, dealt, own)),
                _ => Some(contacts_of_all(fast)),
            };
            fast.rebuild(&grains, &frame, known, dealt, &|i, j| allowed.pair(i, j));
            fast.turn(&kept.turns, &now);
            self.is_fast = true;
            self.was_part |= fast.is_part();
            return Ok(());
        }
        self.hand_over(w);
        let wanted = reaching(&self.rules, &self.wanted, w);
        refuse_giants(w, &wanted, skin)?;
        self.plain.list = near(w, built_at(w), &wanted, skin, &Allowed::new(w));
        Ok(())
    }

    /// All particles that stand in some list, ascending.
    pub(super) fn rows(&self) -> Vec<u32> {
        if let Some(fast) = self.fast.as_ref().filter(|_| self.is_fast) {
            return fast.listed();
        }
        let mut rows: Vec<u32> = self.plain.list.iter().flat_map(|pair| [pair.i, pair.j]).collect();
        rows.sort_unstable();
        rows.dedup();
        rows
    }

    /// The fast loop gives its contacts back to the world.
    pub(super) fn hand_over(&mut self, w: &mut World) {
        if let Some(fast) = self.fast.as_mut().filter(|_| std::mem::take(&mut self.is_fast)) {
            fast.keep_contacts();
            let shared = fast.is_part() && !w.dealings.apart;
            w.contacts.insert(self.key, if shared { contacts_of_all(fast) } else { fast.contacts() });
            fast.clear();
        }
    }
}
