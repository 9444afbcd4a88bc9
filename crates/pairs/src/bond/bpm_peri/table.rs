//! Converts bonds and their types to the input of families: links between places, coefficients, moduli of types.

use super::{Coeff, Declared};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_peri::families::{Influence, Law, Moduli, PmbCoeff, PmbTable};
use perigrain_peri::law::PMB;
use perigrain_styles::pull::find;
use perigrain_world::World;

/// A scene's peridynamic bonds as input of families.
pub struct Links {
    /// Places of the ends, and the type − 1.
    pub links: Vec<([u32; 2], u8)>,
    /// What pairs of types of particles have: the stiffest and longest of their bonds.
    pub table: PmbTable,
    /// Coefficients by type of bond − 1.
    pub of_bonds: Vec<PmbCoeff>,
    /// The law with the moduli of types of particles.
    pub law: Law,
}

/// Reads the bond table.
///
/// # Errors
/// Lost ends, particles that coincide, moduli that differ around a particle, volumes that are not there.
pub fn links(w: &World, law: &Declared, span: Span) -> Result<Links> {
    let found = find(w, |b| law.coeffs.contains_key(&(b.kind as u16)), span)?;
    let style = law.coeffs.values().next().map_or(PMB.style(), |c| c.law);
    let mut table = PmbTable::new(w.types);
    let mut moduli = vec![None; w.types];
    let mut links = Vec::with_capacity(found.len());
    let volumes = w.volumes();
    for (_, bond) in found {
        let Some(coeff) = law.coeffs.get(&bond.kind) else { continue };
        let kinds = bond.ends.map(|i| w.particles.kind[i]);
        for (end, kind) in bond.ends.into_iter().zip(kinds) {
            positive(w, volumes, end, span)?;
            agree(&mut moduli[usize::from(kind) - 1], (coeff, bond.kind), kind, span)?;
        }
        table.set(kinds[0], kinds[1], widest(table.get(kinds[0], kinds[1]), coeff))?;
        links.push((bond.ends.map(|i| i as u32), (bond.kind - 1) as u8));
    }
    let none = PmbCoeff { c: 0.0, horizon: 1.0, s00: f64::INFINITY, alpha: 0.0 };
    let types = w.bonds.types as u16;
    let of_bonds = (1..=types).map(|k| law.coeffs.get(&k).map_or(none, |c| c.bond)).collect();
    let influence = if style.bond_based { Influence::One } else { Influence::default() };
    let moduli = moduli.into_iter().map(|m| m.map_or(Moduli::default(), |m: (Moduli, u16)| m.0)).collect();
    Ok(Links { links, table, of_bonds, law: Law { kind: style.into(), influence, moduli, ..Law::default() } })
}

/// What two types have with one more type of bonds between them.
fn widest(before: Option<&PmbCoeff>, coeff: &Coeff) -> PmbCoeff {
    let Coeff { bond, moduli, law } = *coeff;
    let c = match law.bond_based {
        true => bond.c,
        false => 18.0 * moduli.bulk / (std::f64::consts::PI * bond.horizon.powi(4)),
    };
    let own = PmbCoeff { c, ..bond };
    before.map_or(own, |b| PmbCoeff {
        c: b.c.max(own.c),
        horizon: b.horizon.max(own.horizon),
        s00: b.s00.min(own.s00),
        alpha: b.alpha.max(own.alpha),
    })
}

/// All bonds of the particles of a type have the same moduli.
fn agree(
    known: &mut Option<(Moduli, u16)>,
    (coeff, bond): (&Coeff, u16),
    kind: u16,
    span: Span,
) -> Result<()> {
    let (moduli, first) = *known.get_or_insert((coeff.moduli, bond));
    if moduli == coeff.moduli {
        return Ok(());
    }
    let text =
        format!("particles of type {kind} have bonds of types {first} and {bond}, whose moduli differ");
    Err(Diagnostic::error(Code::NOT_SUPPORTED, span, text)
        .help("moduli belong to particles here: give each solid particles of a type of its own, and both bond types the same moduli")
        .into())
}

fn positive(w: &World, volumes: &[f64], i: usize, span: Span) -> Result<()> {
    let volume = volumes.get(i).copied().unwrap_or(0.0);
    if volume > 0.0 && volume.is_finite() {
        return Ok(());
    }
    let text = format!("particle {} has peridynamic bonds and the volume {volume}", w.particles.tag[i]);
    Err(Diagnostic::error(Code::INCOMPLETE, span, text)
        .help("`set group all d_vfrac VOLUME` gives it one")
        .into())
}
