//! The state of a scene: everything that outlives a step, and nothing that decides.
//!
//! The types that matter most: [`World`]; [`Particles`], its core columns; [`Slots`], the values that computes, fixes and variables have
//! produced. It knows no policy, no style and no deck.

// Units stand in brackets in doc comments, as [length]; they are no links.
#![allow(rustdoc::broken_intra_doc_links)]

mod acting;
pub mod adapted;
pub mod allowed;
pub mod angles;
mod atom_style;
pub mod bonds;
pub mod clock;
pub mod columns;
pub mod contacts;
pub mod crack;
pub mod domain;
pub mod extent;
pub mod facts;
pub mod field;
pub mod groups;
pub mod images;
pub mod index;
pub mod lattice;
pub mod material;
pub mod memory;
pub mod minimizer;
mod mixture;
pub mod moving;
pub mod named;
pub mod order;
pub mod outline;
pub mod outside;
pub mod particles;
pub mod partners;
pub mod potentials;
pub mod promises;
pub mod properties;
pub mod reading;
pub mod rebuild;
pub mod region;
pub mod registration;
pub mod resume;
pub mod settings;
pub mod share;
pub mod slots;
pub mod surface;
pub mod tally;
pub mod template;
pub mod touched;
pub mod tracked;
pub mod travel;
pub mod unseen;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use perigrain_base::diag::Diagnostics;
use perigrain_base::math::periods::Periods;
use perigrain_peri::families::Families;

pub use allowed::{Allowed, excluded};
pub use angles::{Angle, Angles};
pub use atom_style::{AtomStyle, Own};
pub use bonds::{Bond, Bonds};
pub use clock::{Clock, Halt};
pub use columns::Columns;
pub use crack::Crack;
pub use domain::{Boundary, Domain, Face};
pub use extent::Extent;
pub use facts::Facts;
pub use field::Fields;
pub use groups::{Dynamic, GroupId, Groups};
pub use images::Images;
pub use lattice::Lattice;
pub use minimizer::Minimizer;
pub use mixture::{Clump, Ingredient, Mixture};
pub use moving::{Grip, Turn, Under};
pub use named::{Constant, Key, Named, Numbers, Vectors};
pub use outline::Outline;
pub use outside::Outside;
pub use particles::Particles;
pub use partners::Partners;
pub use promises::{Promise, Promises};
pub use properties::Properties;
pub use rebuild::{Kept, Rebuild};
pub use region::Region;
pub use registration::Registration;
pub use resume::{DeclaredLine, Resume};
pub use settings::{Compat, MOST_SHORT, NeighborSettings, Newton, Respa, RunStyle, Settings};
pub use share::{Dealings, Share};
pub use slots::{Offers, Slot, SlotId, Slots};
pub use tally::Tally;
pub use template::Template;
pub use touched::Touched;
pub use tracked::{Lent, Tracked};
pub use travel::{Seen, Travel};
pub use unseen::Unseen;

/// The role of columns that hold the mass of the rigid body a particle belongs to, 0 for none.
pub static CONTACT_MASS: Constant<Vec<f64>> = Constant::new("/contact mass");

/// Everything that outlives a step. It decides nothing: commands change it, ops advance it.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct World {
    /// Time, step and step size.
    pub clock: Tracked<Clock>,
    /// Global choices of the deck: units, skin, compatibility.
    pub settings: Settings,
    /// The box; `None` before `create_box` or `read_data`.
    pub domain: Tracked<Option<Domain>>,
    /// The particles' core columns.
    pub particles: Particles,
    /// Further columns, owned by fixes and computes.
    pub columns: Tracked<Columns>,
    /// Groups of particles.
    pub groups: Groups,
    /// The latest `lattice`.
    pub lattice: Lattice,
    /// Named volumes.
    pub regions: Tracked<Named<Region>>,
    /// Number of particle types, from `create_box`.
    pub types: usize,
    /// Mass of each type (index type − 1) where `mass` set one.
    pub type_mass: Tracked<Vec<Option<f64>>>,
    /// Values that computes, fixes and variables have produced.
    pub slots: Tracked<Slots>,
    /// Energy and virial of the present step.
    pub tally: Tracked<Tally>,
    /// Small state of fixes that outlives a run, by `kind/ID`.
    pub memo: Tracked<Named<Vec<f64>>>,
    /// What fixes have set internal-style variables to in the present run.
    #[serde(skip)]
    pub controls: Tracked<Named<f64>>,
    /// When neighbour lists were last rebuilt.
    pub rebuild: Tracked<Rebuild>,
    /// How far particles may have gone in this run.
    #[serde(skip)]
    pub travel: Tracked<Travel>,
    /// Bonds between particles by their ids.
    pub bonds: Tracked<Bonds>,
    /// Molecule templates by ID, one for each file; a restart file does not hold them, as in LAMMPS.
    #[serde(skip)]
    pub templates: BTreeMap<String, Arc<[Template]>>,
    /// Mixtures of grains by ID; a restart file does not hold them: the deck declares them again.
    #[serde(skip)]
    pub mixtures: BTreeMap<String, Arc<Mixture>>,
    /// Peridynamic bonds, from the first run on.
    pub families: Tracked<Option<Families>>,
    /// Cracks that wait for bonds to be there.
    pub cracks: Vec<Crack>,
    /// Contact history between grains, by pair style.
    pub contacts: Tracked<Named<contacts::Contacts>>,
    /// Contact history with walls, by the wall's fix.
    pub wall_contacts: Tracked<Named<contacts::Contacts>>,
    /// Materials by ID.
    pub materials: BTreeMap<String, material::Material>,
    /// The columns of fixes property/atom, in the order in which data files name them; after a restart the deck declares them
    /// again.
    #[serde(skip)]
    pub properties: Vec<Properties>,
    /// What the deck's folder is, for files beside it.
    #[serde(skip)]
    pub folder: PathBuf,
    /// The files read so far.
    #[serde(skip)]
    pub read_files: reading::ReadFiles,
    /// How rows are shared out to ranks, during a run of several.
    #[serde(skip)]
    pub share: Option<Share>,
    /// Whether they are to be, and how often they have been.
    #[serde(skip)]
    pub dealings: Dealings,
    /// What styles and the program keep by typed keys.
    #[serde(skip)]
    pub facts: Tracked<Facts>,
    /// Whether the scene has changed so that forces must be computed anew at the next run.
    #[serde(skip)]
    pub changed: Tracked<bool>,
    /// Remarks of ops about the deck; printed when the run is over.
    #[serde(skip)]
    pub notes: Tracked<Diagnostics>,
    /// What walls look like, by the fix's ID.
    #[serde(skip)]
    pub outlines: Tracked<Named<Outline>>,
    /// While a deck is only checked: files that its lines so far would have written.
    #[serde(skip)]
    pub promised: Tracked<Promises>,
    /// What only a run determines, while a deck is only checked.
    #[serde(skip)]
    pub unseen: Tracked<Unseen>,
    /// What came from a restart file and the deck may declare again: `region/ID`, `material/ID`, and state of fixes and computes as
    /// `STYLE/ID`.
    #[serde(skip)]
    pub restored: Tracked<BTreeSet<String>>,
    /// The scene as a restart file describes it, until the first run after it.
    #[serde(skip)]
    pub resume: Option<Arc<Resume>>,
}

impl World {
    /// The box, for code that runs only when one exists.
    ///
    /// # Errors
    /// When no box has been defined yet.
    pub fn domain(&self) -> perigrain_base::diag::Result<&Domain> {
        match &*self.domain {
            Some(d) => Ok(d),
            None => perigrain_base::diag::fail(
                perigrain_base::diag::Code::WRONG_ORDER,
                None,
                "the simulation box is not defined yet: a create_box must come first",
            ),
        }
    }

    /// Edges of the box, zero where particles do not see images of each other: where it does not repeat, and along z in a flat
    /// scene.
    pub fn periods(&self) -> Periods {
        self.domain.as_ref().map_or_else(Periods::default, Domain::periods)
    }

    /// Edges of the box, whether it repeats or not; zero without one.
    pub fn edges(&self) -> Periods {
        self.domain.as_ref().map_or_else(Periods::default, Domain::edges)
    }

    /// Whether the box leans now.
    pub fn tilted(&self) -> bool {
        self.domain.as_ref().is_some_and(Domain::tilted)
    }

    /// Number of particles.
    pub fn n(&self) -> usize {
        self.particles.len()
    }

    /// Volumes of the particles of peridynamic solids: their own, or the property `d_vfrac`; empty where there are none.
    pub fn volumes(&self) -> &[f64] {
        if self.particles.style.peri {
            return &self.particles.volume;
        }
        self.columns.playing(*columns::VOLUME_PROPERTY).next().map_or(&[], |(_, column)| column)
    }

    /// Positions at the last rebuild of neighbour lists; none before the first.
    pub fn held(&self) -> &[[f64; 3]] {
        if self.rebuild.unmoved { &self.particles.x0 } else { &self.rebuild.held }
    }

    /// The positions that lists of grains are made from: perhaps those of an earlier rebuild.
    pub fn made(&self) -> &[[f64; 3]] {
        let kept = &self.rebuild.kept.x;
        if !kept.is_empty() && kept.len() == self.n() { kept } else { self.held() }
    }

    /// The box that those positions were in: its lower corner, and its edges as [`World::periods`] returns them.
    pub fn made_in(&self) -> ([f64; 3], Periods) {
        let Some(now) = &*self.domain else { return Default::default() };
        let kept = &self.rebuild.kept;
        let then = match self.rebuild.corners {
            _ if !kept.x.is_empty() && kept.x.len() == self.n() => Some((kept.corners, kept.tilt)),
            Some(corners) if self.held().len() == self.n() => Some((corners, self.rebuild.tilt)),
            _ => None,
        };
        match then {
            Some(([lo, hi], tilt)) => {
                let tilt = now.tilt.map(|_| tilt);
                (lo, Domain { lo, hi, tilt, ..now.clone() }.periods())
            }
            None => (now.lo, now.periods()),
        }
    }

    /// Keeps the particle `old[k]` at each new index `k`, with all that belongs to it; bonds of those
    /// left out are gone.
    pub fn gather(&mut self, old: &[usize]) {
        let n = self.n();
        self.particles.gather(old);
        self.columns.gather(old);
        if let Some(families) = &mut *self.families {
            let mut to = vec![None; n];
            for (new, &k) in old.iter().enumerate() {
                to[k] = Some(new as u32);
            }
            families.remap(&to);
        }
        if old.len() < n && !self.bonds.list.is_empty() {
            self.bonds.forget_lone(&self.particles.tag);
        }
        self.slots.gather(old, n);
        self.slots.invalidate();
        self.rebuild.roster += 1;
        self.touch();
    }

    /// Masses as contacts see them: particles of rigid bodies have that of the body.
    pub fn contact_masses(&self) -> std::borrow::Cow<'_, [f64]> {
        let own = &self.particles.mass;
        let bodies: Vec<&[f64]> = self.columns.playing(*CONTACT_MASS).map(|(_, c)| c.as_slice()).collect();
        if bodies.is_empty() {
            return own.as_slice().into();
        }
        let mut masses = own.to_vec();
        // The first one counts.
        for body in bodies.iter().rev() {
            for (mass, body) in masses.iter_mut().zip(*body) {
                *mass = if *body > 0.0 { *body } else { *mass };
            }
        }
        masses.into()
    }

    /// Copies the masses of types into the per-particle column where particles have none of their own.
    pub fn spread_type_masses(&mut self) {
        if self.particles.style.own_mass() {
            return;
        }
        for (m, &kind) in self.particles.mass.iter_mut().zip(&self.particles.kind) {
            if let Some(Some(mass)) = self.type_mass.get(kind as usize - 1) {
                *m = *mass;
            }
        }
    }

    /// Marks that forces of the last run no longer belong to this scene.
    pub fn touch(&mut self) {
        *self.changed = true;
    }
}
