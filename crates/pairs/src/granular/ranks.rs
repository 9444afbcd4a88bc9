//! Granular contacts where grains are shared out to ranks: what is handed over when lists are made anew, and what all have to know.

use perigrain_base::comm;
use perigrain_base::comm::numbers::{next, put};
use perigrain_contact::fast::{Dealt, Fast, Own};
use perigrain_world::World;
use perigrain_world::contacts::{Contacts, Deep};
use perigrain_world::share::joined_of_all;

/// What contacts of all ranks remember.
pub fn contacts_of_all(fast: &Fast) -> Contacts {
    joined_of_all(&*comm::present(), &fast.contacts())
}

/// What other ranks remember of contacts that this one lists, as grains are dealt and listed now; they have this rank's in exchange.
pub fn contacts_of_others(w: &World, fast: &Fast, dealt: Dealt, own: &Own) -> Contacts {
    let comm = comm::present();
    let all = fast.handed_over(&w.particles.tag, dealt, own);
    let letter = |contacts: &Contacts| {
        let mut bytes = vec![];
        contacts.write(&mut bytes);
        bytes
    };
    let some = all.iter().enumerate().filter(|(_, contacts)| !contacts.is_empty());
    let out = some.map(|(rank, contacts)| (rank, letter(contacts))).collect();
    let came: Vec<Contacts> =
        comm.exchange(out).iter().filter_map(|(_, bytes)| Contacts::read(&mut &bytes[..])).collect();
    Contacts::joined(&came)
}

/// Σ d ⊗ F of the last evaluation, added up list by list as one process does [energy].
pub fn virial_of_all(fast: &Fast) -> [f64; 6] {
    let write = |bytes: &mut Vec<u8>| {
        fast.virials().for_each(|(list, virial)| {
            put(bytes, &[list]);
            put(bytes, &virial);
        });
    };
    let mut all: Vec<(u32, [f64; 6])> = vec![];
    for piece in comm::present().pieces(&write) {
        let mut rest = &piece[..];
        while let Some(([list], virial)) = next(&mut rest).zip(next(&mut rest)) {
            all.push((list, virial));
        }
    }
    all.sort_unstable_by_key(|(list, _)| *list);
    all.iter().fold([0.0; 6], |sum, (_, virial)| std::array::from_fn(|k| sum[k] + virial[k]))
}

/// Whether this holds on all ranks.
pub fn all_agree(here: bool) -> bool {
    let mut against = [if here { 0.0 } else { 1.0 }];
    comm::present().most(&mut against);
    against == [0.0]
}

/// Lets all ranks know which grains overlapped too far first: those of smallest ids in the first step in which some did on any rank.
pub fn agree_on_deep(w: &mut World) {
    let own = w.parts.deep;
    if own.is_some_and(|deep| deep.told) {
        return;
    }
    let write = |bytes: &mut Vec<u8>| {
        if let Some(deep) = own {
            put(bytes, &[deep.step as f64, deep.part]);
            put(bytes, &deep.ids);
        }
    };
    let read = |mut piece: &[u8]| {
        let ([step, part], ids) = next(&mut piece).zip(next(&mut piece))?;
        Some(Deep { step: step as i64, ids, part, told: false })
    };
    let all = comm::present().pieces(&write);
    w.parts.deep = all.iter().filter_map(|piece| read(piece)).min_by_key(|deep| (deep.step, deep.ids));
}
