//! Whether families that were read from a file fit together: what every kernel relies on, and trusts without looking.
//!
//! Kernels reach cells, records, bonds and constants by pointers. What makes that safe is true of families by the way they are built
//! and changed; of families from a file it is true because of what is looked at here: every length, every place that leads
//! somewhere, every bit that says there is a bond.

mod lattice;
mod list;

use crate::cauchy::{Continuum, LAST};
use crate::families::lattice::{LANES, PAD};
use crate::families::law::Law;
use crate::families::{Criterion, Families};
use crate::law::state::SiteState;
use crate::law::style::Style;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::{Vec3, length, sub};
use perigrain_constitutive::Memory;

/// What does not fit.
pub(super) type Fault = std::result::Result<(), String>;

/// Reference positions of particles may differ from where their cells lie by this part of the distance of neighbours: far more
/// than rounding, far less than what would be another bond.
const OFF: f64 = 1e-6;

/// A fault if `actual` is not what it must be.
fn equal<T: PartialEq + std::fmt::Display>(what: &str, actual: T, expected: T) -> Fault {
    if actual == expected { Ok(()) } else { Err(format!("{what} {actual}, not {expected}")) }
}

/// A fault unless all is well.
fn must(well: bool, what: &str) -> Fault {
    if well { Ok(()) } else { Err(what.to_string()) }
}

impl Families {
    /// Whether everything leads where there is something, for so many types of particles that were at `x0` when they were created.
    ///
    /// # Errors
    /// What does not fit, as the end of a sentence.
    pub fn sound(&self, types: usize, x0: &[Vec3]) -> std::result::Result<(), String> {
        let n = self.place.len();
        equal("the number of types of its coefficients is", self.table.types, types)?;
        equal("the number of pairs of types is", self.table.pairs.len(), types * types)?;
        for (what, len) in [
            ("volumes", self.family_volume.len()),
            ("sizes", self.family_size.len()),
            ("damages", self.damaged.len()),
            ("reference positions", self.reference.as_ref().map_or(x0.len(), Vec::len)),
            ("spacings", if self.spacing.is_empty() { n } else { self.spacing.len() }),
            ("lasting particles", if self.lasting.is_empty() { n } else { self.lasting.len() }),
        ] {
            equal(&format!("the number of {what} is"), len, n)?;
        }
        numbers("volumes of families", &self.family_volume)?;
        let limits = self.work_limits.len();
        let known = limits == types * types || limits == 0 && self.options.criterion != Criterion::Work;
        must(known, "its limits of work are not those of its pairs of types")?;
        must(self.spacing.iter().all(|h| h.is_finite() && *h > 0.0), "a particle has no spacing")?;
        let reference = self.reference.as_deref().unwrap_or(x0);
        for (k, body) in self.lattices.iter().enumerate() {
            body.sound((&self.law, types), reference)
                .map_err(|what| format!("body {} of lattices: {what}", k + 1))?;
        }
        self.list
            .sound((&self.law, types, self.of_bonds.len()), reference)
            .map_err(|what| format!("list of bonds: {what}"))?;
        self.places_are_sound()?;
        let near = self.near.pairs.iter().flatten();
        must(
            near.clone().all(|p| p.ends[0] < p.ends[1] && (p.ends[1] as usize) < n),
            "a near pair has no two particles",
        )?;
        let looked = &self.near.looked;
        must(looked.is_empty() || looked.len() == n, "near pairs were searched among other particles")?;
        must(looked.as_flattened().iter().all(|x| x.is_finite()), "near pairs were searched nowhere")?;
        must(self.near.loose.iter().all(|l| (l.0 as usize) < n), "a loose particle is none of the scene")
    }

    /// Cells and records are counted through all bodies, and each particle has one of them at most.
    fn places_are_sound(&self) -> Fault {
        let mut place = vec![u32::MAX; self.place.len()];
        let mut first = 0u32;
        let lattices = self.lattices.iter().map(|b| (b.first_place, &b.particle));
        for (own, particle) in lattices.chain([(self.list.first_place, &self.list.particle)]) {
            equal("the first place of a body is", own, first)?;
            for (k, &p) in particle.iter().enumerate().filter(|(_, p)| **p != u32::MAX) {
                let Some(place) = place.get_mut(p as usize) else {
                    return Err(format!("particle number {p} is none of the scene"));
                };
                must(*place == u32::MAX, "a particle has two places")?;
                *place = first + k as u32;
            }
            let next = u32::try_from(particle.len()).ok().and_then(|len| first.checked_add(len));
            first = next.filter(|n| *n < u32::MAX).ok_or("there are more places than can be counted")?;
        }
        must(place == self.place, "a particle is not at its place")
    }

    /// Whether these families can run under a law, and with coefficients by types of bonds where there are any.
    ///
    /// # Errors
    /// Where bonds do not remember what the law needs.
    pub fn takes(&self, law: &Law, of_bonds: Option<usize>) -> Result<()> {
        let lattice = |b: &super::lattice::LatticeBody| {
            states(&b.state, &law.kind, (b.particle.len(), PAD, b.alive.len() * LANES))
        };
        let list =
            || states(&self.list.state, &law.kind, (self.list.record.len(), 0, self.list.partner.len()));
        let remembers = law.kind.correspondence && law.materials.iter().flatten().any(|m| m.remembers());
        let forgets =
            |state: &SiteState, sites: usize| remembers && sites > 0 && state.continuum.memory.is_empty();
        let forgetful = self.lattices.iter().any(|b| forgets(&b.state, b.particle.len()))
            || forgets(&self.list.state, self.list.record.len());
        let by_bonds = match of_bonds {
            _ if self.list.record.is_empty() => true,
            None => true,
            Some(types) => {
                !self.of_bonds.is_empty() && self.list.group_kind.iter().all(|k| usize::from(*k) < types)
            }
        };
        if by_bonds && !forgetful && self.lattices.iter().all(|b| lattice(b).is_ok()) && list().is_ok() {
            return Ok(());
        }
        let text = "the peridynamic bonds of this scene were made under another style: they do not remember what this one needs";
        let help =
            "declare the style that was in force at the first run, or `clear` the scene and make it anew";
        Err(Diagnostic::error(Code::CONFLICT, None, text).help(help).into())
    }
}

/// A fault if one of some numbers is none (NaN): it would go into every sum.
fn numbers<'a>(what: &str, all: impl IntoIterator<Item = &'a f64>) -> Fault {
    must(!all.into_iter().any(|x| x.is_nan()), &format!("one of the {what} is no number"))
}

/// A fault unless there are works and lives for each of so many bonds, or for none.
fn works((work, life): (&[[f64; 2]], &[f64]), bonds: usize) -> Fault {
    must(work.is_empty() || work.len() == bonds, "its works and bonds differ in number")?;
    must(life.is_empty() || life.len() == bonds, "its lives and bonds differ in number")?;
    numbers("works of bonds", work.as_flattened())?;
    numbers("lives of bonds", life)
}

/// Whether what sites and bonds remember are numbers.
fn states_are_numbers(state: &SiteState) -> Fault {
    for (what, column) in [
        ("weighted volumes", &state.weighted),
        ("spreads", &state.spread),
        ("dilatations", &state.theta),
        ("former dilatations", &state.before),
        ("unrelaxed dilatations", &state.unrelaxed),
        ("plastic multipliers", &state.plastic),
        ("numbers that bonds remember", &state.memory),
        ("constants of dilatations", &state.tables),
    ] {
        numbers(what, column)?;
    }
    Ok(())
}

/// Whether columns of sites and memory of bonds are as long as a law needs: `count` entries with `pad`
/// unused ones around them, and numbers for `bonds` bonds.
fn states(state: &SiteState, law: &Style, (count, pad, bonds): (usize, usize, usize)) -> Fault {
    continuum(&state.continuum, if law.correspondence { count } else { 0 })?;
    let sites = count + 2 * pad;
    let (sites, numbers) = if law.has_states() { (sites, bonds * law.memory()) } else { (0, 0) };
    for (what, column) in [
        ("weighted volumes", &state.weighted),
        ("spreads", &state.spread),
        ("dilatations", &state.theta),
        ("former dilatations", &state.before),
        ("unrelaxed dilatations", &state.unrelaxed),
        ("plastic multipliers", &state.plastic),
    ] {
        equal(&format!("the number of {what} is"), column.len(), sites)?;
    }
    let freed = &state.freed;
    for (what, column) in [
        ("broken weights", &freed.gone),
        ("broken slips", &freed.slip),
        ("broken norms", &freed.spread),
        ("sums over living bonds", &freed.sum),
    ] {
        let expected = if column.is_empty() && freed.is_empty() { 0 } else { sites };
        equal(&format!("the number of {what} is"), column.len(), expected)?;
    }
    equal("the number of numbers that bonds remember is", state.memory.len(), numbers)
}

/// Whether what so many sites have under correspondence is there for each.
fn continuum(own: &Continuum, count: usize) -> Fault {
    let Continuum { memory, last, whole, energy, stress, .. } = own;
    equal("the number of shape tensors is", whole.len(), count)?;
    let all_or_none = |len: usize, all: usize| len == 0 || len == all;
    must(
        all_or_none(memory.len(), Memory::NUMBERS * count),
        "not every site has what its material remembers",
    )?;
    equal(
        "the number of stresses that are remembered is",
        last.len(),
        memory.len() / Memory::NUMBERS * LAST,
    )?;
    must(
        all_or_none(energy.len(), count) && stress.len() == energy.len(),
        "not every site has a stress and an energy",
    )?;
    numbers("shape tensors", whole)?;
    numbers("numbers that materials remember", memory)?;
    numbers("stresses that are remembered", last)?;
    numbers("energies of sites", energy)?;
    numbers("stresses of sites", stress.as_flattened())
}

/// A fault if a particle's reference position is off.
fn at_home(own: Vec3, home: Vec3, spacing: f64) -> Fault {
    let off = length(sub(own, home));
    must(
        off <= OFF * spacing || !own.iter().all(|x| x.is_finite()),
        "a particle's cell is not where the particle was",
    )
}
