//! Horizons that count in the spacing around each particle, and families made whole: which styles have them, what the log says of them.

use super::Solid;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_peri::families::{Families, FamilyOptions, VolumeRule, Weighed};
use perigrain_peri::law::style::Curve;
use perigrain_world::World;

/// So many factors at their bounds mean that families cannot be made whole.
const TOO_MANY: f64 = 0.1;

fn refused(style: &Solid, span: Span, why: &str, help: &str) -> Result<()> {
    let text = format!("pair_style {} cannot have `peri_modify horizon own`: {why}", style.name);
    Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into())
}

/// Refuses coefficients that are numbers beside horizons of particles' own, as soon as a deck has said both.
///
/// # Errors
/// Numbers stand for one horizon.
pub fn needs_materials(style: &Solid, span: Span) -> Result<()> {
    if !(style.weights.own_horizons && style.raw) {
        return Ok(());
    }
    let why = "its coefficients are numbers, which stand for one horizon";
    refused(style, span, why, "give every pair a `material`, whose horizon counts in spacings")
}

/// Refuses what else does not go together with horizons of particles' own, and with families made whole.
///
/// # Errors
/// A scene with one horizon for a type; a flat one, where no family is a ball.
pub fn allowed(style: &Solid, options: &FamilyOptions, flat: bool, span: Span) -> Result<()> {
    if style.weights.own_horizons && options.compat_lammps {
        return refused(style, span, "`compat lammps` has one horizon for a type", "leave one of both out");
    }
    if style.weights.whole_families && flat {
        let text = "`peri_modify surface tensor` makes families balls: it does not go with `dimension 2`";
        let help = "take layers of particles in a box that repeats along z, or leave it out";
        return Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into());
    }
    Ok(())
}

/// The least and the largest spacing of particles over that of the lattice, as far as it is known.
pub fn spacings(style: &Solid, w: &World) -> [f64; 2] {
    if !style.weights.own_horizons {
        return [1.0; 2];
    }
    let lattice = w.lattice.spacing[0];
    let all: Vec<f64> = match &*w.families {
        Some(families) => families.spacing.clone(),
        None => {
            let own = w.particles.kind.iter().zip(&w.particles.volume).filter(|(k, _)| style.is_of(**k));
            own.map(|(_, v)| v.cbrt() / lattice).collect()
        }
    };
    let [least, most] = extremes(all.iter().copied().filter(|a| *a > 0.0));
    if least.is_finite() { [least, most] } else { [1.0; 2] }
}

fn extremes(all: impl Iterator<Item = f64>) -> [f64; 2] {
    all.fold([f64::INFINITY, 0.0], |[least, most], a| [least.min(a), most.max(a)])
}

impl Solid {
    fn is_of(&self, kind: u16) -> bool {
        usize::from(kind) <= self.table.types() && self.table.get(kind, kind).is_some()
    }
}

/// The least stretch at which nothing is left of a softening bond, in peaks.
const LEAST_ROOM: f64 = 1.01;

/// A particle's factor on critical stretches that follow from fracture energies: √(δ/δ_i), as in a body of that horizon. Of bonds
/// that soften the curve has δ/δ_i times the area, and its peak stays.
pub fn strength(style: &Solid, families: &Families, kind: u16, i: usize) -> f64 {
    if let Some(Softening { curve, peak, last, .. }) = softening(style, kind) {
        return (curve.scaled)((peak, last), families.spacing_of(i).recip()) / last;
    }
    match style.materials.by_energy(kind) {
        true => families.spacing_of(i).recip().sqrt(),
        false => 1.0,
    }
}

/// How bonds of a type soften: their curve with its peak and end, and their horizon.
struct Softening {
    curve: Curve,
    peak: f64,
    last: f64,
    horizon: f64,
}

/// The same where they do.
fn softening(style: &Solid, kind: u16) -> Option<Softening> {
    let (curve, own) = (style.law.kind.curve?, style.table.get(kind, kind)?);
    Some(Softening { curve, peak: style.law.of(kind).peak, last: own.s00, horizon: own.horizon })
}

/// Refuses families whose longest horizons leave no room for bonds to soften in.
///
/// # Errors
/// Bonds that would snap back, with the longest horizon that there can be.
pub fn leave_room(style: &Solid, families: &Families, w: &World) -> Result<()> {
    if !style.weights.own_horizons {
        return Ok(());
    }
    for kind in 1..=style.table.types() as u16 {
        let Some(Softening { curve, peak, last, horizon }) = softening(style, kind) else { continue };
        let own = (0..w.n()).filter(|i| w.particles.kind[*i] == kind).map(|i| families.spacing_of(i));
        let [_, widest] = extremes(own);
        if widest == 0.0 || (curve.scaled)((peak, last), widest.recip()) >= LEAST_ROOM * peak {
            continue;
        }
        // The area goes as 1/δ, and that of a triangle with no room beside its peak is ½ peak².
        let area = (curve.twice_area)(peak, last);
        let text = format!(
            "bonds of type {kind} with a peak at {peak:.4e} would snap back: with `peri_modify horizon own` horizons reach {:.4e}",
            widest * horizon
        );
        let most = area * horizon / (LEAST_ROOM * peak * peak);
        let help =
            format!("let no horizon be longer than {most:.4e}, 10 Gc/(18 K peak²), or take a lower peak");
        return Err(Diagnostic::error(Code::BAD_VALUE, None, text).help(help).into());
    }
    Ok(())
}

/// Notes what families have been weighed by, when they are found.
pub fn note(style: &Solid, families: &Families, w: &mut World) {
    if style.weights.own_horizons {
        horizons(style, families, w);
    }
    let Some(weighed) = families.weighed else { return };
    partial(families.options.volume, weighed, w);
    if let Some(factors) = weighed.factors {
        let text = format!(
            "peridynamic bonds: families made whole {}: factors {:.3} to {:.3}, mean {:.4}",
            if style.weights.whole_families {
                "in each direction (`surface tensor`)"
            } else {
                "at an even growth (`surface energy`)"
            },
            factors.least,
            factors.most,
            factors.mean
        );
        w.notes.push(Diagnostic::note(Code::MATERIAL, None, text));
        if factors.cut > TOO_MANY {
            let text = format!(
                "{:.0} % of the bonds would need factors beyond {:.1} to {:.0} for whole families, as in bodies of one or two layers",
                100.0 * factors.cut,
                factors.least,
                factors.most
            );
            let d = Diagnostic::warning(Code::SUSPICIOUS, None, text);
            w.notes.push(d.help("take three particles or more across the body, or a smaller horizon"));
        }
    }
}

fn horizons(style: &Solid, families: &Families, w: &mut World) {
    let lattice = w.lattice.spacing[0];
    let own = (0..w.n()).filter(|i| style.is_of(w.particles.kind[*i]));
    let spacing: Vec<f64> = own.map(|i| families.spacing_of(i) * lattice).collect();
    let [least, most] = extremes(spacing.iter().copied());
    let mean = spacing.iter().sum::<f64>() / spacing.len().max(1) as f64;
    let sizes = (0..w.n()).filter(|i| style.is_of(w.particles.kind[*i])).map(|i| families.family_size[i]);
    let fewest = sizes.min().unwrap_or(0);
    let text = format!(
        "peridynamic bonds: horizons count in the spacing around each particle (`horizon own`): {least:.4e} to {most:.4e}, mean \
         {mean:.4e}; the smallest family has {fewest} partners"
    );
    w.notes.push(Diagnostic::note(Code::MATERIAL, None, text));
}

/// What partial volumes take from families.
fn partial(rule: VolumeRule, weighed: Weighed, w: &mut World) {
    let name = match rule {
        VolumeRule::Lammps => "lammps",
        VolumeRule::None => "none",
        VolumeRule::Full => "full",
    };
    let text = format!(
        "peridynamic bonds: partial volumes (`volume {name}`) make {:.1} % of the bonds count in part, all of them {:.4} in the mean",
        100.0 * weighed.in_part,
        weighed.mean
    );
    w.notes.push(Diagnostic::note(Code::MATERIAL, None, text));
}
