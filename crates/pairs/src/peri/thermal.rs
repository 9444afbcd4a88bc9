//! Thermal strain of solids: from the temperatures of particles to what their bonds take as unstretched.

use super::Solid;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::par;
use perigrain_peri::families::{Criterion, Families, FamilyOptions, PeriView};
use perigrain_styles::peri_view::view;
use perigrain_world::columns::{PLASTIC_HEAT, TEMPERATURE};
use perigrain_world::{Numbers, World};

/// Thermal strains ε = α_T (T − T0) of particles.
pub struct Thermal {
    temperature: Numbers,
    /// Flow of materials depends on temperatures, and warms.
    softens: bool,
    /// α_T and T0 by type − 1.
    by_type: Vec<[f64; 2]>,
    /// Those of the last evaluation; empty before the first.
    last: Vec<f64>,
    /// Those of the last evaluation that advanced.
    kept: Vec<f64>,
    /// Where particles were then, for load steps that are tried more than once.
    places: Vec<[f64; 3]>,
    /// What the strains of now have added to the energy at those places, where the evaluation before was that one.
    added: Option<f64>,
}

impl Solid {
    /// Whether some type expands.
    pub(super) fn expands(&self) -> bool {
        self.law.moduli.iter().any(|m| m.expansion != 0.0)
    }
}

impl Thermal {
    /// That of a style, where a type expands and particles have temperatures.
    ///
    /// # Errors
    /// Laws whose bonds do not strain thermally, and what changes limits in another way.
    pub fn of(style: &Solid, options: &FamilyOptions, w: &World, span: Span) -> Result<Option<Self>> {
        let softens =
            style.law.kind.correspondence && style.law.materials.iter().flatten().any(|m| m.remembers());
        let expands = style.expands();
        let Some(temperature) = w.columns.property(*TEMPERATURE).filter(|_| expands || softens) else {
            return Ok(None);
        };
        let by_type = style.law.moduli.iter().map(|m| [m.expansion, m.stress_free]).collect();
        let own =
            Self { temperature, softens, by_type, last: vec![], kept: vec![], places: vec![], added: None };
        if !expands {
            return Ok(Some(own));
        }
        let (kind, refuse) = (style.law.kind, |text: String, help: &str| {
            let d = Diagnostic::error(Code::NOT_SUPPORTED, span, text);
            Err(d
                .help(help.to_string())
                .help("without `expansion` in the material temperatures strain nothing")
                .into())
        });
        if !(kind.plain() || kind.strains_thermally()) {
            let text = format!("bonds of pair_style {} have no thermal strain", style.name);
            return refuse(text, "peri/pmb, peri/lps and peri/cauchy have it");
        }
        if options.criterion != Criterion::Stretch {
            let text =
                "of the criteria of breaking only the stretch takes thermal strain into account".to_string();
            return refuse(text, "leave out the line `peri_modify break`");
        }
        if options.compat_lammps {
            let text = "bonds have no thermal strain under `-compat lammps`".to_string();
            return refuse(text, "LAMMPS knows none");
        }
        if style.table.iter().any(|c| c.alpha != 0.0) {
            let text = "limits that rise under compression (alpha) do not go with thermal strain".to_string();
            return refuse(text, "take `alpha 0`");
        }
        if w.families.as_ref().is_some_and(|f| f.law.kind.bond_based && !f.law.kind.stiffened) {
            let text = "temperatures come too late: bonds were made without thermal strain at the first run";
            let d = Diagnostic::error(Code::WRONG_ORDER, span, text);
            return Err(d
                .help("declare `fix property/atom temperature heatflow` before the first run")
                .into());
        }
        Ok(Some(own))
    }

    /// Gives families the strains at the present temperatures.
    ///
    /// # Errors
    /// As `view` of a world.
    pub fn begin(&mut self, families: &mut Families, w: &World) -> Result<()> {
        families.law.temperature.clear();
        if self.softens {
            families.law.temperature.extend_from_slice(w.columns.get_scalar(self.temperature).unwrap_or(&[]));
        }
        if !self.expands() {
            return Ok(());
        }
        let now = self.strains(w);
        if self.kept.is_empty() {
            // Those of an earlier run.
            let earlier = |i: usize| families.thermal_strain(i);
            self.kept = if families.heated() { (0..w.n()).map(earlier).collect() } else { now.clone() };
            self.last.clone_from(&self.kept);
            self.places.clone_from(&w.particles.x);
        }
        if families.counts_losses
            && !families.counts_warming
            && self.last.len() == now.len()
            && self.last != now
        {
            self.added = Some(families.warming(&view(w)?, [&self.last, &now]));
        }
        families.warm(&now);
        self.last = now;
        Ok(())
    }

    /// In an evaluation that advances, once bonds have their new places: books what temperatures that have changed since the last one
    /// have added to the energy of bonds, ∫ ∂U/∂T dT by the trapezoidal rule: half of it at the places of then, half at those of now.
    ///
    /// # Errors
    /// As `view` of a world.
    pub fn end(&mut self, families: &mut Families, w: &World) -> Result<()> {
        if !self.expands() {
            return Ok(());
        }
        let counted = families.counts_losses || families.counts_warming;
        if counted && self.kept.len() == self.last.len() && self.kept != self.last {
            let (here, change) = (view(w)?, [&self.kept[..], &self.last[..]]);
            let then = match self.added.take() {
                Some(added) => added,
                None => {
                    families.put(&PeriView { x: &self.places, ..here });
                    let added = families.warming(&here, change);
                    families.put(&here);
                    added
                }
            };
            let now = families.warming(&here, change);
            families.book_warming(0.5 * (then + now));
        }
        self.kept.clone_from(&self.last);
        if families.counts_warming {
            self.places.clone_from(&w.particles.x);
        }
        Ok(())
    }

    fn expands(&self) -> bool {
        self.by_type.iter().any(|[expansion, _]| *expansion != 0.0)
    }

    /// Whether flow warms particles.
    pub fn warms(&self) -> bool {
        self.softens
    }

    /// Gives `fix heat/peri` what flow has turned into heat in the evaluation that has ended.
    pub fn warm(&self, families: &Families, w: &mut World) {
        let n = w.n();
        if self.softens && w.columns.get_scalar(*PLASTIC_HEAT).is_some() {
            let mut heat = std::mem::take(w.columns.scalar(*PLASTIC_HEAT, n));
            families.add_plastic_heat(&w.particles.kind, &mut heat);
            *w.columns.scalar(*PLASTIC_HEAT, n) = heat;
        }
    }

    fn strains(&self, w: &World) -> Vec<f64> {
        let temperature = w.columns.get_scalar(self.temperature).unwrap_or(&[]);
        let mut strains = vec![0.0; w.n()];
        let columns = (&mut strains[..], temperature, &w.particles.kind[..]);
        par::each(columns, |_, (strains, temperature, kind): (&mut [f64], &[f64], &[u16])| {
            for ((strain, t), kind) in strains.iter_mut().zip(temperature).zip(kind) {
                let [expansion, stress_free] = self.by_type[usize::from(*kind) - 1];
                *strain = expansion * (t - stress_free);
            }
        });
        strains
    }
}
