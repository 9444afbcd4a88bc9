//! A law as scenes and decks have it: properties, the numbers of its line, and its kernels.

use crate::law::formula::BondLaw;
use crate::law::kernels::{About, Loops, Of};
use crate::law::material::Moduli;
use crate::law::moment::Moment;

/// A law as scenes choose it: one of a [table](crate::law::table), or one of a program's own.
#[derive(Debug)]
pub struct Style {
    /// What messages and tests call it.
    pub name: &'static str,
    /// Its number in restart files, which no other law may have.
    pub number: u32,
    /// Whether a bond's force depends on nothing but the bond, not on the dilatations of its ends.
    pub bond_based: bool,
    /// Whether each end of a bond that is bond-based has a stiffness of its own, which sites have as column 1.
    pub stiffened: bool,
    /// Whether forces follow from deformation gradients of sites and the stress of their materials.
    pub correspondence: bool,
    /// What bonds lose for good while they live.
    pub losses: Losses,
    /// What a line of a deck has besides a stiffness and the words that all laws have.
    pub numbers: &'static [Number],
    /// The stretch at which bonds begin to flow or to soften, which stands in the place of ω.
    pub edge: Option<fn(&Moduli) -> f64>,
    /// The curve of bonds that soften.
    pub curve: Option<Curve>,
    /// The word for what bonds that flow in compression do on their way back.
    pub unloading: Option<&'static str>,
    /// The law that serves where types relax differently.
    pub apart: Option<&'static str>,
    /// Whether bonds of a table may have it (`bond_style bpm/peri`).
    pub of_bonds: bool,
    /// Its kernels.
    pub own: Kernels,
    /// Those with LAMMPS' numbers.
    pub lammps: Kernels,
    /// Both for moments that are [`Moment::steady`], where these need less.
    pub steady: Option<[Kernels; 2]>,
}

/// What bonds lose for good while they live.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Losses {
    /// Nothing.
    None,
    /// What flows becomes heat: the difference of energies before and after.
    Flow,
    /// Damage takes fracture energy.
    Damage,
    /// The materials of sites say what flow and damage take.
    Sites,
    /// Dashpots make heat, those of all bonds alike.
    Relaxation,
    /// The same where each end has its own.
    RelaxationApart,
}

/// A number of a line of a deck.
#[derive(Clone, Copy, Debug)]
pub struct Number {
    /// The keyword of a line with a material.
    pub keyword: &'static str,
    /// What messages call it, on lines of numbers and on lines with a material.
    pub what: [&'static str; 2],
    /// What it may be.
    pub bound: Bound,
    /// Where it goes.
    pub of: fn(&mut Moduli) -> &mut f64,
}

impl Number {
    /// The stretch at which bonds flow in compression.
    pub const SYC: Self = Self {
        keyword: "syc",
        what: ["the stretch syc at which bonds flow", "syc"],
        bound: Bound::Negative("syc is a stretch in compression, below zero"),
        of: |m| &mut m.syc,
    };
}

/// What a number may be, with what is wrong of others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// Above zero.
    Positive,
    /// From 0 to 1.
    Share(&'static str),
    /// Below zero.
    Negative(&'static str),
}

/// The curve of a bond that softens, from its peak to where nothing is left.
#[derive(Clone, Copy, Debug)]
pub struct Curve {
    /// How far beyond its peak a bond reaches whose curve has this area; not above zero where that is less than the area up to the peak.
    pub beyond: fn(f64, f64) -> f64,
    /// Twice the area below a curve with a peak here that ends there.
    pub twice_area: fn(f64, f64) -> f64,
    /// The end of a curve with the same peak and so many times the area.
    pub scaled: fn((f64, f64), f64) -> f64,
}

/// The kernels of a law, compiled for it alone.
#[derive(Clone, Copy)]
pub struct Kernels(&'static dyn Loops);

impl Kernels {
    /// Those of a formula.
    pub const fn of<W: BondLaw>() -> Self {
        Self(Of::<W>::LOOPS)
    }

    /// These loops.
    pub(crate) const fn with(loops: &'static dyn Loops) -> Self {
        Self(loops)
    }

    /// The loops.
    pub(crate) fn loops(self) -> &'static dyn Loops {
        self.0
    }
}

impl std::fmt::Debug for Kernels {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        self.0.about().fmt(f)
    }
}

impl Style {
    /// A law of state-based bonds that lose nothing and have no numbers of their own, with one formula.
    pub const fn of<W: BondLaw>(name: &'static str, number: u32) -> Self {
        Self {
            name,
            number,
            bond_based: false,
            stiffened: false,
            correspondence: false,
            losses: Losses::None,
            numbers: &[],
            edge: None,
            curve: None,
            unloading: None,
            apart: None,
            of_bonds: false,
            own: Kernels::of::<W>(),
            lammps: Kernels::of::<W>(),
            steady: None,
        }
    }

    /// Whether a pull is c s and nothing else.
    pub fn plain(&self) -> bool {
        self.own.loops().about().plain
    }

    /// Whether there are columns of sites or memory of bonds.
    pub fn has_states(&self) -> bool {
        !self.plain()
    }

    /// Whether sites have forces beyond the reach of displacements: where dilatations are, and where bonds remember.
    pub fn spreads(&self) -> bool {
        !self.bond_based || self.memory() > 0
    }

    /// Whether a share of the shear modulus relaxes.
    pub fn relaxes(&self) -> bool {
        matches!(self.losses, Losses::Relaxation | Losses::RelaxationApart)
    }

    /// Whether the extension of a broken bond is set free, under LAMMPS' laws (`compat`) or not.
    pub fn frees(&self, compat: bool) -> bool {
        !self.bond_based && !self.correspondence && !compat
    }

    /// Whether bonds lose energy for good at once, not in the course of time.
    pub fn flows(&self) -> bool {
        matches!(self.losses, Losses::Flow | Losses::Damage)
    }

    /// Whether bonds soften beyond a peak.
    pub fn softens(&self) -> bool {
        self.curve.is_some()
    }

    /// Whether sites take up thermal strains: under correspondence, and where it is linear in a bond's stretch with columns A and B of
    /// both ends.
    pub fn strains_thermally(&self) -> bool {
        let linear = (self.stiffened || !self.bond_based)
            && self.losses == Losses::None
            && self.own.loops().about().memory == 0;
        self.correspondence || linear
    }

    /// Whether sites have a yield surface.
    pub fn yields(&self) -> bool {
        self.own.loops().about().norm.is_some()
    }

    /// Numbers that each bond remembers.
    pub fn memory(&self) -> usize {
        self.own.loops().about().memory
    }

    /// The kernels, with LAMMPS' numbers (`compat`) or without.
    pub(crate) fn loops(&self, compat: bool) -> &'static dyn Loops {
        if compat { self.lammps.loops() } else { self.own.loops() }
    }

    /// Those that are enough for a moment.
    pub(crate) fn loops_at(&self, compat: bool, moment: &Moment) -> &'static dyn Loops {
        match self.steady {
            Some([own, lammps]) if moment.steady() => if compat { lammps } else { own }.loops(),
            _ => self.loops(compat),
        }
    }

    /// What its kernels need, with LAMMPS' numbers or without.
    pub(crate) fn about(&self, compat: bool) -> About {
        self.loops(compat).about()
    }

    /// Whether the ends of bonds have a stiffness of their own, column 1; and the share of the squares that counts for each end.
    /// LAMMPS counts half of the shear energies.
    pub(crate) fn shares(&self, compat: bool) -> (bool, f64) {
        match (self.bond_based, self.stiffened) {
            (true, true) => (true, 0.5),
            (true, false) => (false, 0.25),
            (false, _) => (true, if compat { 0.25 } else { 0.5 }),
        }
    }
}
