//! Computes: quantities that are read from the world without changing it; one file each, one line each in
//! [`COMPUTES`].
//!
//! This crate does not depend on `fixes`: data of fixes is read from the world.

// Units stand in brackets in doc comments, as [length]; they are not links.
#![allow(rustdoc::broken_intra_doc_links)]

mod bond_local;
mod centro_atom;
pub mod chunk;
mod cluster_atom;
mod com;
mod contact_atom;
mod coord_atom;
mod count_type;
mod crack;
mod damage_atom;
mod dilatation_atom;
mod displace_atom;
mod dt_critical;
mod energy_ledger;
mod erotate_sphere;
mod erotate_sphere_atom;
mod fabric;
mod family_values;
mod fragments;
mod global_atom;
mod group_group;
mod gyration;
mod ke;
mod ke_atom;
mod momentum;
mod msd;
mod nbond_atom;
mod origin;
mod pair;
mod pair_local;
mod pe;
mod pe_atom;
mod peri_energy_atom;
mod peri_measures;
mod peri_state_atom;
mod plasticity_atom;
mod pressure;
pub mod property_atom;
mod property_local;
mod rdf;
pub mod reduce;
mod rigid_energy;
mod rigid_local;
mod slice;
mod statics;
mod stress_atom;
pub mod swing;
mod temp;
mod temp_deform;
pub mod temp_flow;
mod temp_profile;
mod temp_region;
mod temp_sphere;
mod thermal;
mod vacf;
mod wall_local;

use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::BuildCx;
pub use perigrain_styles::compute::{Compute, ComputeStyle};
use perigrain_styles::words::{Kind, Value, Words};
use perigrain_world::columns::VOLUME_PROPERTY;

/// Every compute style.
#[rustfmt::skip]
pub const COMPUTES: &[&dyn ComputeStyle] = &[
    &bond_local::BondLocal,
    &centro_atom::CentroAtom,
    &chunk::angmom::AngmomChunk,
    &chunk::atom::ChunkAtom,
    &chunk::com::ComChunk,
    &chunk::continuum::ContinuumChunk,
    &chunk::first::MsdChunk,
    &chunk::first::VacfChunk,
    &chunk::gyration::GyrationChunk,
    &chunk::inertia::InertiaChunk,
    &chunk::omega::OmegaChunk,
    &chunk::property::PropertyChunk,
    &chunk::reduce::ReduceChunk,
    &chunk::spread::SpreadAtom,
    &chunk::temp::TempChunk,
    &chunk::torque::TorqueChunk,
    &chunk::vcm::VcmChunk,
    &cluster_atom::AggregateAtom,
    &cluster_atom::ClusterAtom,
    &cluster_atom::FragmentAtom,
    &com::Com,
    &contact_atom::ContactAtom,
    &coord_atom::CoordAtom,
    &count_type::CountType,
    &crack::CrackTip,
    &damage_atom::DamageAtom,
    &dilatation_atom::DilatationAtom,
    &displace_atom::DisplaceAtom,
    &dt_critical::DtCritical,
    &energy_ledger::EnergyLedger,
    &erotate_sphere::ErotateSphere,
    &erotate_sphere_atom::ErotateSphereAtom,
    &fabric::Fabric,
    &fragments::Fragments,
    &global_atom::GlobalAtom,
    &group_group::GroupGroup,
    &gyration::Gyration,
    &ke::Ke,
    &ke_atom::KeAtom,
    &momentum::Momentum,
    &msd::Msd,
    &nbond_atom::NbondAtom,
    &pair::PairEnergy,
    &pair_local::PairLocal,
    &pe::Pe,
    &pe_atom::PeAtom,
    &peri_energy_atom::PeriEnergyAtom,
    &peri_measures::CauchyAtom,
    &peri_measures::DefgradAtom,
    &peri_measures::StrainAtom,
    &peri_state_atom::PeriStateAtom,
    &plasticity_atom::PlasticityAtom,
    &pressure::Pressure,
    &property_atom::PropertyAtom,
    &property_local::PropertyLocal,
    &rdf::Rdf,
    &reduce::Reduce,
    &reduce::ReduceRegion,
    &rigid_energy::ErotateRigid,
    &rigid_energy::KeRigid,
    &rigid_local::RigidLocal,
    &slice::Slice,
    &statics::Statics,
    &stress_atom::StressAtom,
    &temp::Temp,
    &temp_deform::TempDeform,
    &temp_flow::TempCom,
    &temp_flow::TempPartial,
    &temp_flow::TempRamp,
    &temp_profile::TempProfile,
    &temp_region::TempRegion,
    &temp_sphere::TempSphere,
    &vacf::Vacf,
    &wall_local::WallLocal,
];

/// Selected terms of the potential energy.
#[derive(Clone, Copy)]
struct Terms {
    pair: bool,
    bond: bool,
    fix: bool,
}

/// Refuses computes that need radii for particles without any.
fn need_spheres(what: &str, cx: &BuildCx) -> Result<()> {
    if cx.world.particles.style.sphere {
        return Ok(());
    }
    Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, format!("{what} needs spheres"))
        .help("put `atom_style sphere` (or `hybrid sphere peri`) at the top of the deck")
        .into())
}

/// Refuses computes that need families for particles that cannot have any.
fn need_bonds(what: &str, cx: &BuildCx) -> Result<()> {
    let w = cx.world;
    if w.particles.style.peri || (w.particles.style.bonded && w.columns.property(*VOLUME_PROPERTY).is_some())
    {
        return Ok(());
    }
    Err(Diagnostic::error(
        Code::WRONG_ORDER,
        cx.span,
        format!("{what} needs particles with peridynamic bonds"),
    )
    .help("put `atom_style peri` (or `hybrid sphere peri`) at the top of the deck")
    .into())
}

/// A share of a family of bonds: above 0, at most 1.
struct Share(f64);

impl Value for Share {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let (at, share) = (args.here(), args.positive(what)?);
        match share > 1.0 {
            true => fail(Code::BAD_VALUE, at, "damage is a share: above 0, at most 1"),
            false => Ok(Self(share)),
        }
    }
}

/// The line of a potential energy.
#[derive(Words)]
struct EnergyTerms {
    #[word(name = "term")]
    terms: Vec<Term>,
}

/// A term of the potential energy.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "term of the potential energy")]
enum Term {
    /// What pair styles have tallied.
    Pair,
    /// The energies of bonds.
    Bond,
    /// The energies of fixes with `fix_modify ID energy yes`; per particle, what the host of `fix external` has set.
    Fix,
    /// Nothing, as no style has it.
    Angle,
    /// Nothing, as no style has it.
    Dihedral,
    /// Nothing, as no style has it.
    Improper,
    /// Nothing, as no style has it.
    Kspace,
}

impl EnergyTerms {
    /// The terms that are named, or all if none is.
    fn chosen(&self) -> Terms {
        let has = |term| self.terms.is_empty() || self.terms.contains(&term);
        Terms { pair: has(Term::Pair), bond: has(Term::Bond), fix: has(Term::Fix) }
    }
}
