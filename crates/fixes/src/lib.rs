//! Fixes: operations on particles during the steps, apart from their mutual forces; one file each, one line
//! each in [`FIXES`].

// Units stand in brackets in doc comments, as [length]; they are not links.
#![allow(rustdoc::broken_intra_doc_links)]

mod adapt;
mod addforce;
mod addtorque;
mod addtorque_atom;
mod ave_atom;
mod ave_chunk;
mod ave_histo;
mod ave_time;
mod aveforce;
mod balance;
mod bins;
mod bond_break;
mod bond_create;
mod components;
mod controller;
mod crowd;
mod damping_cundall;
pub mod deform;
mod deposit;
mod dipoles;
mod drag;
mod dt_critical;
mod dt_grain;
mod dt_guard;
mod dt_reset;
mod efield;
mod enforce2d;
mod evaporate;
pub mod external;
mod extremes;
mod faces;
mod freeze;
mod gravity;
mod halt;
mod heat;
mod heat_flow;
mod indent;
mod insert;
mod kick;
mod langevin;
mod lineforce;
mod momentum;
mod move_fix;
mod nve;
mod nve_bpm_sphere;
mod nve_limit;
mod nve_noforce;
mod nve_sphere;
mod path;
mod peri_strength;
mod planeforce;
mod pour;
mod print;
mod property_atom;
pub mod python_invoke;
mod recenter;
mod resistance;
pub mod rigid;
mod setforce;
mod settorque_atom;
mod spring;
mod spring_self;
mod store_force;
mod store_state;
mod time_step;
mod vector;
mod viscous;
mod viscous_nonlinear;
mod viscous_sphere;
mod wall_flat;
mod wall_law;
mod wall_reflect;
mod wall_region;
mod window;

use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, RefKind, ValueRef};
pub use perigrain_styles::fix::{
    AtRest, Counted, Facts, Fix, FixStyle, MODIFY, Minimizing, Moves, Virial, no_option, options,
};
use perigrain_styles::words::{Kind, Value};
use perigrain_styles::{BuildCx, Shape};
use perigrain_walls::elapsed;
use perigrain_walls::shared::{RegionId, needs_spheres};
use perigrain_world::World;
use perigrain_world::field::{Fields, MU, QUAT};

/// Every fix style.
#[rustfmt::skip]
pub const FIXES: &[&dyn FixStyle] = &[
    &adapt::Adapt,
    &addforce::AddForce,
    &addtorque::AddTorque,
    &addtorque_atom::AddTorqueAtom,
    &ave_atom::AveAtom,
    &ave_chunk::AveChunk,
    &ave_histo::AveHisto,
    &ave_histo::AveHistoWeight,
    &ave_time::AveTime,
    &aveforce::AveForce,
    &balance::Balance,
    &bond_break::BondBreak,
    &bond_create::BondCreate,
    &controller::Controller,
    &damping_cundall::DampingCundall,
    &deform::Deform,
    &deform::DeformPressure,
    &deposit::Deposit,
    &drag::Drag,
    &dt_critical::DtCritical,
    &dt_grain::DtGrain,
    &dt_guard::DtGuard,
    &dt_reset::DtReset,
    &efield::Efield,
    &enforce2d::Enforce2d,
    &evaporate::Evaporate,
    &external::External,
    &extremes::ExtremesStyle,
    &freeze::Freeze,
    &gravity::Gravity,
    &halt::HaltFix,
    &heat_flow::HeatFlow,
    &heat::HeatPeri,
    &heat::HeldAt,
    &heat::Flux,
    &heat::Convect,
    &indent::Indent,
    &insert::Insert,
    &langevin::Langevin,
    &lineforce::LineForce,
    &perigrain_walls::massflow_mesh::MassflowMesh,
    &momentum::Momentum,
    &move_fix::Move,
    &perigrain_walls::move_mesh::MoveMesh,
    &nve::Nve,
    &nve_limit::NveLimit,
    &nve_noforce::NveNoForce,
    &nve_bpm_sphere::NveBpmSphere,
    &nve_sphere::NveSphere,
    &peri_strength::PeriStrength,
    &planeforce::PlaneForce,
    &pour::Pour,
    &print::Print,
    &property_atom::PropertyAtomFix,
    &python_invoke::PythonInvoke,
    &recenter::Recenter,
    &rigid::Rigid,
    &rigid::RigidNve,
    &rigid::RigidNveSmall,
    &rigid::RigidSmall,
    &setforce::SetForce,
    &settorque_atom::SetTorqueAtom,
    &spring::Spring,
    &spring_self::SpringSelf,
    &store_force::StoreForce,
    &store_state::StoreState,
    &perigrain_walls::surface::Surface,
    &vector::VectorFix,
    &viscous::Viscous,
    &viscous_nonlinear::ViscousNonlinear,
    &viscous_sphere::ViscousSphere,
    &perigrain_walls::wall::gran::WallGran,
    &perigrain_walls::wall::region::WallGranRegion,
    &perigrain_walls::wall::mesh::WallMesh,
    &wall_flat::COLLOID,
    &wall_flat::HARMONIC,
    &wall_flat::LJ1043,
    &wall_flat::LJ126,
    &wall_flat::LJ93,
    &wall_flat::MORSE,
    &wall_reflect::WallReflect,
    &wall_region::WallRegion,
];

/// The fields that describe how particles of this system are oriented: quaternions and dipole moments.
fn lying(w: &World) -> Fields {
    let style = w.particles.style;
    let of = |there: bool, field: Fields| if there { field } else { Fields::NONE };
    of(style.oriented, QUAT) | of(style.dipole, MU)
}

/// Refuses particles that torques cannot rotate.
fn needs_torques(name: &str, cx: &BuildCx) -> Result<()> {
    if cx.world.particles.style.sphere {
        return Ok(());
    }
    let text = format!("fix {name} needs spheres, which have torques");
    Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, text)
        .help("put `atom_style sphere`, alone or in a hybrid, at the top of the deck")
        .into())
}

/// An atom-style variable with its `v_`.
struct AtomReference(ValueRef);

impl Value for AtomReference {
    const KIND: Kind = Kind::Reference;
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect(&format!("the variable after {what}"))?;
        match ValueRef::parse(&word.text, word.span)? {
            Some(r) if r.kind == RefKind::Variable => {
                cx.value(&r, true)?;
                Ok(Self(r))
            }
            _ => {
                let text = format!("{what} takes v_name of an atom-style variable, not `{}`", word.text);
                fail(Code::WRONG_KIND, word.span, text)
            }
        }
    }
}

/// Refuses a fix whose values are not updated at all the steps needed: multiples of `every`.
fn compatible(r: &ValueRef, shape: &Shape, every: i64, what: &str) -> Result<()> {
    if shape.every <= 1 || every % shape.every == 0 {
        return Ok(());
    }
    let text = format!("`{r}` is new every {} steps only, and {what} is {every}", shape.every);
    Err(Diagnostic::error(Code::CONFLICT, r.span, text)
        .help(format!("let {what} be a multiple of {}", shape.every))
        .into())
}
