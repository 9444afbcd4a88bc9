//! Bonds that differ from particle to particle: the factors of `set … peri/strength` and `peri/stiffness`.

use super::Solid;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_peri::families::{Families, FamilyOptions};
use perigrain_styles::peri_view::BOND_FACTORS;
use perigrain_world::World;

/// Which factors the scene has.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scatter {
    /// Some bonds bear more or less than others.
    pub strength: bool,
    /// Some are stiffer than others.
    pub stiffness: bool,
}

/// Whether some factor that was said is not 1.
fn uneven(w: &World, which: usize) -> bool {
    factors(w, which).iter().any(|f| *f != 0.0 && *f != 1.0)
}

fn factors(w: &World, which: usize) -> &[f64] {
    w.columns.get_scalar(*BOND_FACTORS[which]).unwrap_or_default()
}

/// The largest factor on the stiffness of a type's particles.
pub fn stiffest(w: &World, kind: u16) -> f64 {
    let of_kind = w.particles.kind.iter().zip(factors(w, 1)).filter(|(k, f)| **k == kind && **f > 0.0);
    of_kind.map(|(_, f)| *f).reduce(f64::max).unwrap_or(1.0)
}

impl Scatter {
    /// What the scene of a style has.
    ///
    /// # Errors
    /// Factors that bonds of this style cannot have.
    pub fn of(style: &Solid, options: &FamilyOptions, w: &World) -> Result<Self> {
        let own = Self { strength: uneven(w, 0), stiffness: uneven(w, 1) };
        let kind = style.law.kind;
        if own.strength && kind.softens() {
            return refuse(0, "bonds that soften have a peak, which it does not move", "peri/pmb");
        }
        if own.strength && options.one_stretch() {
            let text = "under `compat lammps/2025` particles have one critical stretch, whatever bond has it";
            return refuse(0, text, "`compat lammps` or none");
        }
        if own.stiffness && !kind.plain() {
            return refuse(1, &format!("bonds of pair_style {} have no factors", style.name), "peri/pmb");
        }
        let shaped = w.families.as_ref().is_none_or(|f| f.law.kind.stiffened);
        if own.stiffness && !shaped {
            let text = "`set … peri/stiffness` comes too late: bonds were made alike at the first run";
            return Err(Diagnostic::error(Code::WRONG_ORDER, None, text)
                .help("say it before the first run; its numbers may change then")
                .into());
        }
        Ok(own)
    }

    /// Whether there are any.
    pub fn any(self) -> bool {
        self.strength || self.stiffness
    }

    /// Gives families the factors, those on strengths with what horizons of particles' own make of them, if anything.
    pub fn give(self, w: &World, families: &mut Families, mut by_horizon: Vec<f64>) {
        let column = |is: bool, which: usize| if is { factors(w, which) } else { &[] };
        let strength = column(self.strength, 0);
        if by_horizon.is_empty() {
            return families.scatter(strength, column(self.stiffness, 1));
        }
        by_horizon.iter_mut().zip(strength).filter(|(_, set)| **set > 0.0).for_each(|(own, set)| *own *= set);
        families.scatter(&by_horizon, column(self.stiffness, 1));
    }

    /// Notes how far they scatter.
    pub fn note(self, w: &mut World) {
        let one = |which: usize, of: &str| {
            let all = factors(w, which).iter().map(|f| if *f > 0.0 { *f } else { 1.0 });
            let (mut low, mut high, mut sum) = (f64::INFINITY, 0.0f64, 0.0);
            all.clone().for_each(|f| (low, high, sum) = (low.min(f), high.max(f), sum + f));
            let mean = sum / all.len() as f64;
            format!(
                "peridynamic bonds: {of} of particles scatters from {low:.4} to {high:.4} times, mean {mean:.4}"
            )
        };
        let strength = self.strength.then(|| one(0, "the critical stretch"));
        let stiffness = self.stiffness.then(|| one(1, "the micro-modulus"));
        let notes = strength.into_iter().chain(stiffness);
        notes.for_each(|text| w.notes.push(Diagnostic::note(Code::MATERIAL, None, text)));
    }
}

fn refuse(which: usize, why: &str, instead: &str) -> Result<Scatter> {
    let text = format!("`set … {}` does not concern this scene: {why}", BOND_FACTORS[which].text());
    let d = Diagnostic::error(Code::CONFLICT, None, text);
    Err(d.help(format!("use {instead}, or set all factors to 1")).into())
}
