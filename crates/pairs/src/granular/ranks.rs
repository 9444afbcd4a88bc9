//! Granular contacts where grains are shared out to ranks: what is handed over when lists are made anew, and what all have to know.

use perigrain_base::comm::{self, rows};
use perigrain_contact::fast::{Dealt, Fast, Own};
use perigrain_world::contacts::Contacts;
use perigrain_world::share::joined_of_all;
use perigrain_world::{Constant, World};

/// Grains that overlap so far that contact laws mean little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deep {
    /// When it was first seen.
    pub step: i64,
    /// The two grains.
    pub ids: [u32; 2],
    /// Overlap over the smaller radius.
    pub part: f64,
    /// Whether the warning has been given.
    pub warned: bool,
}

/// The first grains seen to overlap by more than a tenth of a radius during a run.
pub static DEEP: Constant<Deep> = Constant::new("granular/deep");

/// Contact history of all ranks.
pub fn contacts_of_all(fast: &Fast) -> Contacts {
    joined_of_all(&*comm::present(), &fast.contacts())
}

/// The other ranks' history of contacts that this rank lists, as grains are dealt and listed now; they get this rank's in
/// exchange.
pub fn contacts_of_others(w: &World, fast: &Fast, dealt: Dealt, own: &Own) -> Contacts {
    let comm = comm::present();
    let all = fast.handed_over(&w.particles.tag, dealt, own);
    let some = all.iter().enumerate().filter(|(_, contacts)| !contacts.is_empty());
    let out = some.map(|(rank, contacts)| (rank, contacts.letter())).collect();
    let came: Vec<Contacts> =
        comm.exchange(out).iter().filter_map(|(_, bytes)| Contacts::read(&mut &bytes[..])).collect();
    Contacts::joined(&came)
}

/// Σ d ⊗ F of the last evaluation, added up list by list as one process does [energy].
pub fn virial_of_all(fast: &Fast) -> [f64; 6] {
    let all = rows::of_all(fast.virials().map(|(list, virial)| ([list], virial)));
    all.iter().fold([0.0; 6], |sum, (_, virial)| std::array::from_fn(|k| sum[k] + virial[k]))
}

/// Lets all ranks know which grains overlapped too far first: those of smallest ids in the first step in which some did on any rank.
pub fn agree_on_deep(w: &mut World) {
    let own = w.facts.get(*DEEP).copied();
    if own.is_some_and(|deep| deep.warned) {
        return;
    }
    let all = rows::of_all(own.map(|deep| (deep.ids, [deep.step as f64, deep.part])));
    let deep = |(ids, [step, part]): rows::Row<2, 2>| Deep { step: step as i64, ids, part, warned: false };
    if let Some(first) = all.into_iter().map(deep).min_by_key(|deep| (deep.step, deep.ids)) {
        w.facts.insert(*DEEP, first);
    }
}
