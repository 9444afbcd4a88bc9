//! The loops over bonds and sites for one law each: compiled with its formula, called whichever it is.

use std::marker::PhantomData;

use crate::lattice::chunk::{CELLS, Chunk, SUMS};
use crate::lattice::energies;
use crate::lattice::forms;
use crate::lattice::kernels::Cells;
use crate::law::formula::{Angles, BondLaw};
use crate::law::moment::{Held, Moment};
use crate::law::settle::{self, Settling, Sites};
use crate::law::site::Unrelaxed;
use crate::law::state::SiteState;
use crate::law::stretch::{Ends, Stretch};
use crate::law::terms::Sum;
use crate::list::laws::{self, Hand};
use perigrain_base::math::form::Form;

/// What loops over bonds need, as the constants of [`BondLaw`] say.
#[derive(Clone, Copy, Debug)]
pub(crate) struct About {
    pub(crate) columns: usize,
    pub(crate) memory: usize,
    pub(crate) plain: bool,
    /// Displacements are needed apart from reference bonds.
    pub(crate) apart: bool,
    pub(crate) back: bool,
    pub(crate) limited: bool,
    pub(crate) lazy: bool,
    pub(crate) norm: Option<Sum>,
}

/// A bond by itself.
pub(crate) struct Alone {
    /// Its stretch.
    pub(crate) stretch: Stretch<f64>,
    /// ω, or what stands for it.
    pub(crate) omega: f64,
    /// What its ends have in columns.
    pub(crate) ends: Ends<f64>,
    /// What it remembers.
    pub(crate) memory: [f64; 2],
    /// θ of both ends and its unrelaxed part, where there are dilatations.
    pub(crate) angles: Option<[[f64; 2]; 2]>,
}

/// The loops of a law.
pub(crate) trait Loops: Sync {
    /// What they need.
    fn about(&self) -> About;

    /// Adds the forces of the bonds of a chunk of lattice cells: see [`forms::run`].
    fn chunk(&self, form: Form, at: (&Chunk, &Cells), degree: usize, masked: bool, track: bool)
    -> (f64, f64);

    /// Energies and virials of those bonds: see [`energies::sums`].
    fn chunk_sums(&self, form: Form, at: (&Chunk, &Cells), look: &energies::Looking) -> [[f64; CELLS]; SUMS];

    /// Adds the forces of a record's bonds in hand to its window: see [`laws::pull`].
    fn in_hand(&self, form: Form, hand: Hand) -> bool;

    /// Energies and virials of those bonds: see [`laws::energies`].
    fn in_hand_sums(&self, form: Form, hand: Hand, look: &laws::Looking) -> [f64; SUMS];

    /// The squares of both ends of a bond by itself, and the pulls on them.
    fn alone(&self, bond: &Alone, moment: &Moment) -> [[f64; 2]; 2];

    /// See [`BondLaw::slips`].
    fn slips(&self, s: f64, memory: [f64; 2], held: Held, ends: [Unrelaxed; 2]) -> [f64; 2];

    /// From the sums of dilatations to columns of sites.
    fn dilatations(&self, settling: &Settling, state: &mut SiteState, sites: &Sites);

    /// From the sums of norms to how much of each site's trial state flows.
    fn flow(&self, settling: &Settling, state: &mut SiteState, sites: &Sites);
}

/// Loops with the formula of a law.
pub(crate) struct Of<W>(PhantomData<fn() -> W>);

impl<W: BondLaw> Of<W> {
    /// The loops.
    pub(crate) const LOOPS: &'static dyn Loops = &Self(PhantomData);
}

impl<W: BondLaw> Loops for Of<W> {
    fn about(&self) -> About {
        About {
            columns: W::COLUMNS,
            memory: W::MEMORY,
            plain: W::PLAIN,
            apart: false,
            back: W::BACK,
            limited: W::LIMITED,
            lazy: W::LAZY,
            norm: W::NORM,
        }
    }

    fn chunk(
        &self,
        form: Form,
        at: (&Chunk, &Cells),
        degree: usize,
        masked: bool,
        track: bool,
    ) -> (f64, f64) {
        forms::run::<W>(form, at, degree, masked, track)
    }

    fn chunk_sums(&self, form: Form, at: (&Chunk, &Cells), look: &energies::Looking) -> [[f64; CELLS]; SUMS] {
        forms::run_sums::<W>(form, at, look)
    }

    fn in_hand(&self, form: Form, hand: Hand) -> bool {
        laws::pull::<W>(form, hand)
    }

    fn in_hand_sums(&self, form: Form, hand: Hand, look: &laws::Looking) -> [f64; SUMS] {
        laws::energies::<W>(form, hand, look)
    }

    fn alone(&self, bond: &Alone, moment: &Moment) -> [[f64; 2]; 2] {
        let angles = std::array::from_fn(|end| match bond.angles {
            Some(angles) if W::DILATED => Angles {
                now: angles[end][0],
                unrelaxed: angles[end][1],
                relaxing: W::relaxing(&bond.ends[end], moment),
            },
            _ => Angles::none(0.0),
        });
        let mut memory = bond.memory;
        let squares = W::squares(&bond.stretch, bond.omega, &angles, &memory, moment);
        let pulls = W::pull(&bond.stretch, bond.omega, &bond.ends, &mut memory, moment);
        [squares.into(), pulls.into()]
    }

    fn slips(&self, s: f64, memory: [f64; 2], held: Held, ends: [Unrelaxed; 2]) -> [f64; 2] {
        W::slips(s, memory, held, ends)
    }

    fn dilatations(&self, settling: &Settling, state: &mut SiteState, sites: &Sites) {
        settle::dilatations::<W>(settling, state, sites);
    }

    fn flow(&self, settling: &Settling, state: &mut SiteState, sites: &Sites) {
        settle::flow::<W>(settling, state, sites);
    }
}
