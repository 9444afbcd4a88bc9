//! Energy and virial of the list's bonds under any law: asked for at some steps only, so a pass of its own.

use crate::families::list::{ListBody, PART};
use crate::families::shares::{BodyShare, Shares};
use crate::families::view::Sums;
use crate::families::{Cell, Families, ForceUnit, PeriTally};
use crate::lattice::chunk::SUMS;
use crate::law::kernels::Loops;
use crate::law::moment::Moment;
use crate::list::kernel::{Block, FULL, LAST, Row, Rules};
use crate::list::laws::{self, Acting, Hand};
use crate::list::sweep::in_rows;
use crate::shares::list::parts_everywhere;
use perigrain_base::math::form::Form;
use perigrain_base::math::vec3::SIX;
use perigrain_base::par::{self, Shared};

/// What energies need besides a record.
struct Energies<'a> {
    form: Form,
    law: &'a dyn Loops,
    list: &'a ListBody,
    rules: &'a Rules,
    acting: &'a Acting<'a>,
    look: &'a laws::Looking<'a>,
    /// Forces are at the places of the last step that advanced as well.
    advanced: bool,
}

/// Adds energy and virial of the list's bonds as they were during the force evaluation, which has `advanced` bonds or not.
pub fn tally(
    families: &mut Families,
    t: &mut PeriTally,
    (advanced, cell, dealt): (bool, &Cell, Option<&Shares>),
) {
    let (law, options, n) = (&families.law, &families.options, families.list.record.len());
    let (kind, loops) = (law.kind.style(), law.kind.loops(options.compat_lammps));
    let rules = Rules::new(cell, options, law.counting());
    let list = &families.list;
    let ends = in_rows(&list.state.columns, n, loops.about().columns);
    let angles = if kind.bond_based && !list.scatter.heated() { vec![] } else { angles(list) };
    let now = Moment { held: list.state.held, ..law.moment(false) };
    // Nothing is written: `keep` is not set.
    let memory = list.state.remembered().as_ptr().cast_mut();
    let acting =
        Acting { ends: &ends, memory, known: kind.memory() > 0, keep: false, least: false, moment: now };
    let (own, half) = kind.shares(options.compat_lammps);
    let newton = options.unit == ForceUnit::Newton;
    let look = laws::Looking { angles: &angles, states: own, half, newton };
    let e = Energies {
        form: families.form(),
        law: loops,
        list,
        rules: &rules,
        acting: &acting,
        look: &look,
        advanced,
    };
    let rows = &mut families.scratch.rows;
    let share = dealt.and_then(|shares| Some((shares.list.as_ref()?, shares.me)));
    e.tally(rows, share, t);
}

/// θ of each record and its unrelaxed part, in rows of four.
fn angles(list: &ListBody) -> Vec<f64> {
    let state = &list.state;
    let both = state.theta.iter().zip(&state.unrelaxed).zip(&state.before);
    both.flat_map(|((theta, unrelaxed), before)| [*theta, unrelaxed + (theta - before), 0.0, 0.0]).collect()
}

impl Energies<'_> {
    fn tally(&self, rows: &mut Vec<Sums>, share: Option<(&BodyShare, usize)>, t: &mut PeriTally) {
        let n = self.list.record.len();
        if t.per_atom() {
            let b = &mut Block::new();
            (0..n).for_each(|i| self.record(i, b, t));
            return;
        }
        rows.clear();
        rows.resize(n.div_ceil(PART), [0.0; 7]);
        let own = share.map_or(0..rows.len(), |(share, _)| self.list.parts_of(&share.mine));
        let shared = Shared::new(rows);
        par::for_rows(own.len(), |k| {
            let part = own.start + k;
            let (b, mut sum) = (&mut Block::new(), PeriTally::default());
            for i in part * PART..n.min((part + 1) * PART) {
                self.record(i, b, &mut sum);
            }
            let v = sum.virial;
            // SAFETY: each part has its own sum.
            unsafe { shared.get(part..part + 1)[0] = [sum.energy, v[0], v[1], v[2], v[3], v[4], v[5]] };
        });
        if let Some(share) = share {
            parts_everywhere(self.list, share, rows);
        }
        t.collect(rows);
    }

    /// Adds a record's own bonds.
    fn record(&self, i: usize, b: &mut Block, t: &mut PeriTally) {
        let list = self.list;
        if list.particle[i] == u32::MAX {
            // Nothing is bonded to where a particle was.
            return;
        }
        let back = self.law.about().back;
        let row = Row { body: list, i, first: 0, rules: self.rules };
        let (mut sums, mut own_energy) = ([0.0; SUMS], 0.0);
        let mut next = row.start();
        while row.fill(&mut next, b) {
            if back && !self.advanced {
                row.shape::<LAST>(self.form, b);
            }
            row.shape::<FULL>(self.form, b);
            if back && self.advanced {
                b.before = b.z;
            }
            // SAFETY: energies touch no window, and nothing is written to what bonds remember.
            let hand = unsafe { Hand::new((&row, self.acting), b, std::ptr::null_mut()) };
            let more = self.law.in_hand_sums(self.form, hand, self.look);
            sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
            if !t.per_atom() {
                continue;
            }
            for at in (0..b.count).filter(|&at| b.weight[at] != 0.0) {
                let ends = [i, list.partner[b.place(at)] as usize].map(|r| list.particle[r] as usize);
                own_energy += b.out[0][at];
                if let Some(atoms) = t.per_atom_energy.as_deref_mut() {
                    atoms[ends[1]] += b.out[1][at];
                }
                if let Some(atoms) = t.per_atom_virial.as_deref_mut() {
                    let y = [b.y[0][at], b.y[1][at], b.y[2][at]];
                    for (end, pull) in ends.into_iter().zip([b.out[2][at], b.out[3][at]]) {
                        let products = SIX.map(|(c, d)| pull * y[c] * y[d]);
                        atoms[end].iter_mut().zip(products).for_each(|(v, p)| *v += 0.5 * p);
                    }
                }
            }
        }
        t.energy += sums[0];
        t.virial.iter_mut().zip(&sums[1..]).for_each(|(v, own)| *v += own);
        if let Some(atoms) = t.per_atom_energy.as_deref_mut() {
            atoms[list.particle[i] as usize] += own_energy;
        }
    }
}
