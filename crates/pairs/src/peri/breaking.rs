//! By what bonds break (`peri_modify break`): what goes together, and the work that a bond bears.

use super::Solid;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::vec3::{Vec3, length, sub};
use perigrain_lang::ValueRef;
use perigrain_peri::calibration::crossing;
use perigrain_peri::families::{Criterion, PmbCoeff, PmbTable};
use perigrain_peri::law::LawKind;
use perigrain_peri::moduli::{self, BOND_NU, Elastic};
use perigrain_styles::BuildCx;
use perigrain_world::{Lattice, World};
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// By what bonds break, and how often they are judged.
#[derive(Clone)]
pub struct Breaking {
    /// By what.
    pub criterion: Criterion,
    /// The formula that decides, if one does.
    pub formula: Option<ValueRef>,
    /// At multiples of so many steps.
    pub every: i64,
}

impl Default for Breaking {
    fn default() -> Self {
        Self { criterion: Criterion::default(), formula: None, every: 1 }
    }
}

/// Takes the criterion of a line.
///
/// # Errors
/// Work that would be counted from the middle of a scene on.
pub fn choose(style: &mut Solid, chosen: Criterion, at: Span, cx: &BuildCx) -> Result<()> {
    let late = |criterion: Criterion| criterion != Criterion::Work && chosen == Criterion::Work;
    if cx.world.families.as_ref().is_some_and(|f| late(f.options.criterion)) {
        let text = "peri_modify break energy comes too late: the work on bonds counts from the first run on";
        return fail(Code::WRONG_ORDER, at, text);
    }
    style.breaking.criterion = chosen;
    Ok(())
}

/// Refuses criteria that do not fit the bonds, as soon as all that a deck says of them is known.
///
/// # Errors
/// Bonds whose work or stress is another than the criterion takes it for.
pub fn allowed(style: &Solid, span: Span) -> Result<()> {
    let (law, criterion) = (style.law.kind, style.breaking.criterion);
    let refuse = |word: &str, why: &str, help: &str| {
        let text = format!("pair_style {} cannot have `peri_modify break {word}`: {why}", style.name);
        Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into())
    };
    if criterion == Criterion::Work && law.softens() {
        let why = "bonds that soften have their fracture energy in their curve";
        return refuse("energy", why, "leave `break` out, or use peri/pmb");
    }
    if criterion == Criterion::Work && law.correspondence {
        let why = "energies belong to particles there, not to bonds";
        return refuse("energy", why, "use `break stress`, `break strain` or `break shear`, or s00");
    }
    if criterion == Criterion::Work && style.weights.own_horizons {
        let why = "it counts the bonds across a plane of the lattice, which `peri_modify horizon own` does not go by";
        return refuse("energy", why, "leave one of both out");
    }
    if criterion.of_stress() && law.memory() > 0 {
        let word = if let Criterion::Shear(_) = criterion { "shear" } else { "stress" };
        let why = "the stress is that of an elastic solid, and its bonds flow, relax or soften";
        return refuse(word, why, "use `break strain` or `break energy`");
    }
    Ok(())
}

/// Gives types of a bond-based law the moduli that stresses are computed with, where no material has given them.
pub fn moduli(style: &mut Solid, declared: &PmbTable) {
    if !(style.breaking.criterion.of_stress() && style.law.kind.bond_based) {
        return;
    }
    for kind in 1..=declared.types() as u16 {
        let (Some(own), Some(moduli)) =
            (declared.get(kind, kind), style.law.moduli.get_mut(usize::from(kind) - 1))
        else {
            continue;
        };
        if moduli.bulk == 0.0 {
            let solid = solid_of_bonds(own);
            (moduli.bulk, moduli.shear) = (solid.bulk(), solid.shear());
        }
    }
}

/// The solid of whole balls of bonds: K = πcδ⁴/18, ν = 1/4.
fn solid_of_bonds(own: &PmbCoeff) -> Elastic {
    let bulk = PI * own.c * own.horizon.powi(4) / 18.0;
    Elastic { young: 3.0 * (1.0 - 2.0 * BOND_NU) * bulk, nu: BOND_NU }
}

/// The work that breaks a bond by pair of types, row by row [energy/volume²]: as a plane of the lattice costs the fracture
/// energy G of its s00, w = G/(V ½ Σ w |ξ_n|); 4G/(πδ⁴), that of whole balls, without a lattice (Foster, Silling & Chen 2011).
/// Empty where bonds break by something else.
pub fn work_limits(style: &Solid, table: &PmbTable, w: &World) -> Vec<f64> {
    if style.breaking.criterion != Criterion::Work {
        return vec![];
    }
    let types = table.types() as u16;
    let pairs = (1..=types).flat_map(|a| (1..=types).map(move |b| (a, b)));
    pairs.map(|(a, b)| table.get(a, b).map_or(f64::INFINITY, |own| limit(style, own, (a, b), w))).collect()
}

fn limit(style: &Solid, own: &PmbCoeff, (a, b): (u16, u16), w: &World) -> f64 {
    let energy = fracture_energy(style.law.kind, own, [a, b].map(|kind| style.law.of(kind)));
    let dx = w.lattice.spacing[0];
    let vectors = vectors(&w.lattice, style.volume.reach(own.horizon, dx));
    let volume = |kind: u16| {
        let p = &w.particles;
        p.kind.iter().zip(&p.volume).find(|(k, v)| **k == kind && **v > 0.0).map(|(_, v)| *v)
    };
    match volume(a).zip(volume(b)) {
        Some((one, other)) if !vectors.is_empty() => {
            let starts = w.lattice.basis.len() as f64;
            let across = crossing(vectors.into_iter(), own.horizon, (style.volume, dx)) / starts;
            energy / ((one * other).sqrt() * across)
        }
        _ => 4.0 * energy / (PI * own.horizon.powi(4)),
    }
}

/// The fracture energy that the critical stretch of a pair stands for [energy/area].
fn fracture_energy(law: LawKind, own: &PmbCoeff, moduli: [perigrain_peri::families::Moduli; 2]) -> f64 {
    if law.bond_based {
        return moduli::fracture_energy(own.s00, own.c, own.horizon);
    }
    // K of the pair from its c = 18K/(πδ⁴), with the mean ratio of the moduli of its types.
    let bulk = PI * own.c * own.horizon.powi(4) / 18.0;
    let ratio = 0.5 * moduli.iter().map(|m| m.shear / m.bulk).sum::<f64>();
    moduli::fracture_energy_of_states(own.s00, Elastic::from_bulk_shear(bulk, ratio * bulk), own.horizon)
}

/// The vectors from the sites of a unit cell to all sites within reach, one cell's after the other.
fn vectors(lattice: &Lattice, reach: f64) -> Vec<Vec3> {
    let mut all = vec![];
    for own in &lattice.basis {
        let from = lattice.to_box(*own);
        // Rounding must not leave out sites at the very end.
        let most = reach * (1.0 + 1e-9);
        let note = |_: usize, site: Vec3| -> ControlFlow<()> {
            let xi = sub(site, from);
            let long = length(xi);
            if long > 1e-9 * reach && long <= most {
                all.push(xi);
            }
            ControlFlow::Continue(())
        };
        let _ = lattice.sites(from.map(|x| x - most), from.map(|x| x + most), note);
    }
    all
}
