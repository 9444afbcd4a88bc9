//! The op of bonds whose force depends on their length alone.

use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::vec3::{Vec3, add, dot, sub};
use perigrain_base::par;
use perigrain_plan::{About, Needs, Op, Stage, Tick};
use perigrain_world::bonds::LostBond;
use perigrain_world::field::{BONDS, BOX, F, LISTS, MEMO, TAG, TALLY, X};
use perigrain_world::index::Index;
use perigrain_world::tally::add_share;
use perigrain_world::{Bond, World};

/// What a bond does at some length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pull {
    /// Energy.
    pub energy: f64,
    /// Force over length: positive pushes the ends apart.
    pub force_per_length: f64,
}

/// A bond as its ends are and move.
#[derive(Clone, Copy, Debug)]
pub struct Stretched {
    /// Type.
    pub kind: u16,
    /// From the second end to the first [length].
    pub d: Vec3,
    /// Velocity of the first end less that of the second.
    pub v: Vec3,
    /// Its own rest length, or 0 where it has none yet.
    pub rest: f64,
}

impl Stretched {
    /// Its length.
    pub fn length(&self) -> f64 {
        dot(self.d, self.d).sqrt()
    }

    /// By which part it is longer than at rest.
    pub fn strain(&self) -> f64 {
        if self.rest == 0.0 { 0.0 } else { (self.length() - self.rest) / self.rest }
    }
}

/// A bond whose ends have been found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Found {
    /// Type.
    pub kind: u16,
    /// Places of the ends in storage.
    pub ends: [usize; 2],
}

/// All bonds that act and that `wants` wants, with the places of their ends; without those that have lost one where the
/// deck allows it.
///
/// # Errors
/// An end that is gone.
pub fn find(w: &World, wants: impl Fn(&Bond) -> bool, span: Span) -> Result<Vec<(usize, Found)>> {
    let tags = &w.particles.tag;
    let index = Index::new(tags);
    let mut list = vec![];
    for (k, bond) in w.bonds.list.iter().enumerate().filter(|(_, b)| b.is_on() && wants(b)) {
        let [Some(a), Some(b)] = bond.ends.map(|t| index.find(t, tags)) else {
            if w.bonds.lost != LostBond::Error {
                continue;
            }
            let text =
                format!("an end of the bond between particles {} and {} is gone", bond.ends[0], bond.ends[1]);
            return Err(Diagnostic::error(Code::LOST, span, text)
                .help("`delete_atoms … bond yes` takes bonds of deleted particles along; `thermo_modify lost/bond ignore` goes on without their forces")
                .into());
        };
        list.push((k, Found { kind: bond.kind as u16, ends: [a, b] }));
    }
    Ok(list)
}

/// x_a − x_b across the nearest periodic faces.
pub fn apart(w: &World, lengths: &Vec3, ends: [usize; 2]) -> Vec3 {
    let x = &w.particles.x;
    let d = sub(x[ends[0]], x[ends[1]]);
    std::array::from_fn(
        |k| if lengths[k] > 0.0 { d[k] - lengths[k] * (d[k] / lengths[k]).round() } else { d[k] },
    )
}

/// Edge lengths of the box, zero where it does not repeat.
pub fn periods(w: &World) -> Result<Vec3> {
    let domain = w.domain()?;
    let (lengths, periodic) = (domain.lengths(), domain.periodic());
    Ok(std::array::from_fn(|d| if periodic[d] { lengths[d] } else { 0.0 }))
}

/// What a bond of some type does at some length.
pub trait Law: Send + Sync {
    /// `None` for types that are none of its business.
    fn pull(&self, kind: u16, r: f64) -> Option<Pull>;

    /// Takes the coefficients that fixes have changed.
    fn adapt(&mut self, _w: &World) {}
}

/// Forces along the bonds of one style.
pub struct Along<F> {
    name: String,
    span: Span,
    law: F,
    /// Which changes of coefficients have been seen.
    adapted: f64,
    /// Rebuild and change of bonds at which `list` was made.
    made: Option<(u64, u64)>,
    list: Vec<(usize, Found)>,
    pulls: Vec<(Vec3, Pull)>,
}

impl<F: Law> Along<F> {
    /// With a law of type and length; types without one are none of its business.
    pub fn new(name: impl Into<String>, span: Span, law: F) -> Self {
        Self { name: name.into(), span, law, adapted: 0.0, made: None, list: vec![], pulls: vec![] }
    }
}

impl<F: Law> Op for Along<F> {
    fn about(&self) -> About {
        About::new(
            &self.name,
            Stage::Force,
            Needs::new().read(X | BONDS | BOX | MEMO | LISTS | TAG).add(F).write(TALLY),
        )
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if self.adapted != w.adaptations() {
            self.adapted = w.adaptations();
            self.law.adapt(w);
        }
        let now = (w.rebuild.generation, w.bonds.changes);
        if t.setup || self.made != Some(now) {
            self.list = find(w, |b| self.law.pull(b.kind as u16, 1.0).is_some(), self.span)?;
            self.made = Some(now);
        }
        let lengths = periods(w)?;
        self.pulls.clear();
        self.pulls.resize(self.list.len(), Default::default());
        let (law, world) = (&self.law, &*w);
        par::each((&mut self.pulls[..], &self.list[..]), |_, (pulls, list)| {
            for (out, (_, found)) in pulls.iter_mut().zip(list) {
                let d = apart(world, &lengths, found.ends);
                let r = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
                *out = (d, law.pull(found.kind, r).unwrap_or_default());
            }
        });
        for ((_, found), (d, pull)) in self.list.iter().zip(&self.pulls) {
            let force = d.map(|d| d * pull.force_per_length);
            tally(w, t, found.ends, d, &force, pull.energy);
        }
        Ok(())
    }
}

/// Adds a force to one end of a bond and its opposite to the other, with energy and virial.
pub fn tally(w: &mut World, t: &Tick, ends: [usize; 2], d: &Vec3, force: &Vec3, energy: f64) {
    let f = &mut w.particles.f;
    f[ends[0]] = add(f[ends[0]], *force);
    f[ends[1]] = sub(f[ends[1]], *force);
    if t.energy {
        w.tally.bond += energy;
    }
    if t.atom_energy {
        w.tally.bond_atom.resize(w.particles.x.len(), 0.0);
        ends.iter().for_each(|&i| w.tally.bond_atom[i] += 0.5 * energy);
    }
    if t.virial {
        let tally = &mut *w.tally;
        let atoms = t.atom_virial.then_some(&mut tally.atom_bonds[..]);
        add_share(&mut tally.bond_virial, atoms, ends, *d, *force);
    }
}
