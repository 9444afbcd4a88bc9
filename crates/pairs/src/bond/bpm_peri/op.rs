//! The op of bond bpm/peri: families from the table at the first run, forces at every step, broken bonds taken away.

use super::Declared;
use super::table::{Links, links};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_peri::families::{Families, FamilyOptions, ForceUnit, PeriTally};
use perigrain_plan::{About, Needs, Op, Stage, Tick};
use perigrain_styles::peri_view::view;
use perigrain_world::columns::VOLUME_PROPERTY;
use perigrain_world::field::{BONDS, BOX, COLUMNS, F, FAMILIES, KIND, MASS, TAG, TALLY, V, X};
use perigrain_world::{Constant, Numbers, World};

// What the deck may have made properties for.
static DAMAGE: Constant<Vec<f64>> = Constant::new("d_damage");
static DILATATION: Constant<Vec<f64>> = Constant::new("d_theta");
static MULTIPLIER: Constant<Vec<f64>> = Constant::new("d_lambda");

/// Forces of all peridynamic bonds of the table.
pub struct Force {
    law: Declared,
    span: Span,
}

impl Force {
    /// The op of a style.
    pub fn new(law: Declared, span: Span) -> Self {
        Self { law, span }
    }
}

impl Op for Force {
    fn about(&self) -> About {
        About::new(
            "bond bpm/peri",
            Stage::Force,
            Needs::new()
                .read(MASS | X | V | KIND | BONDS | BOX | TAG)
                .add(F)
                .write(BONDS | FAMILIES | TALLY)
                .keep(COLUMNS)
                .only(&[DAMAGE.text(), DILATATION.text(), MULTIPLIER.text(), VOLUME_PROPERTY.text()]),
        )
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let changed = w.families.as_ref().is_none_or(|f| f.seen != w.bonds.changes);
        if t.setup || changed {
            self.prepare(w, t)?;
        }
        let Some(mut families) = w.families.take() else { return Ok(()) };
        families.law.dt = t.dt;
        self.pull(w, t, &mut families)?;
        if !t.setup && !t.trial && !families.broken().is_empty() {
            take_away(w, &mut families);
        }
        publish(w, &families);
        w.families = Some(families).into();
        Ok(())
    }
}

impl Force {
    /// Families at the first run; later, what the deck has changed since.
    fn prepare(&self, w: &mut World, t: &Tick) -> Result<()> {
        let Links { links, table, of_bonds, mut law } = links(w, &self.law, self.span)?;
        law.shared_or_apart(w.families.as_ref().map(|f| &f.law)).map_err(|e| e.at(self.span))?;
        let mut options = FamilyOptions::new(w.lattice.spacing[0]);
        options.unit = if self.law.newton { ForceUnit::Newton } else { ForceUnit::Density };
        (options.skip_rest, options.portable) = (!w.settings.no_skipping, w.settings.portable);
        options.no_repulsion = true;
        let mut families = match w.families.take() {
            Some(mut families) => {
                families.takes(&law, Some(of_bonds.len())).map_err(|e| e.at(self.span))?;
                let mut known: Vec<([u32; 2], u8)> = links;
                known.iter_mut().for_each(|l| l.0.sort_unstable());
                known.sort_unstable();
                let kind = |a: u32, b: u32| {
                    let ends = [a.min(b), a.max(b)];
                    known.binary_search_by_key(&ends, |l| l.0).ok().map(|k| known[k].1)
                };
                (families.options, families.of_bonds, families.law) = (options, of_bonds, law);
                families.follow(&view(w)?, kind, known.len()).map_err(|e| e.at(self.span))?;
                families.refresh(&view(w)?, &table);
                families
            }
            None if !t.setup => return fail(Code::LOST, self.span, "the peridynamic families are gone"),
            None => {
                self.touching(w, &links)?;
                let new = Families::build_from(&view(w)?, &links, (&table, of_bonds), options, law);
                let new = new.map_err(|e| e.at(self.span))?;
                self.warn_of_step(w, &new, t.dt)?;
                new
            }
        };
        families.seen = w.bonds.changes;
        w.families = Some(families).into();
        Ok(())
    }

    /// Bonds have a length.
    fn touching(&self, w: &World, links: &[([u32; 2], u8)]) -> Result<()> {
        let p = &w.particles;
        let Some((ends, _)) = links.iter().find(|(e, _)| p.x[e[0] as usize] == p.x[e[1] as usize]) else {
            return Ok(());
        };
        let [a, b] = ends.map(|i| p.tag[i as usize]);
        fail(Code::BAD_VALUE, self.span, format!("particles {a} and {b} are joined and at one place"))
    }

    /// Masses that are density times volume do not go with forces per volume.
    fn warn_of_step(&self, w: &mut World, families: &Families, dt: f64) -> Result<()> {
        let ftm2v = w.settings.units.constants().ftm2v;
        let stable = families.silling_step(&view(w)?, &w.particles.mass, ftm2v);
        // The estimate is about half the true limit, so ten times it is far beyond.
        let Some(stable) = stable.filter(|s| !self.law.newton && dt > 10.0 * s) else { return Ok(()) };
        let text = format!(
            "the time step {dt} is far beyond the stable {stable:.3e}: bond_style bpm/peri has forces per volume, as LAMMPS' manual states them"
        );
        w.notes.push(
            Diagnostic::warning(Code::SUSPICIOUS, self.span, text)
                .help("where masses are density times volume write `bond_style bpm/peri force newton`"),
        );
        Ok(())
    }

    /// Adds the forces of this step.
    fn pull(&self, w: &mut World, t: &Tick, families: &mut Families) -> Result<()> {
        let mut sums = PeriTally::default();
        let mut energies = std::mem::take(&mut w.tally.bond_atom);
        if t.atom_energy {
            energies.resize(w.n(), 0.0);
            sums.per_atom_energy = Some(&mut energies);
        }
        let mut virials = std::mem::take(&mut w.tally.atom_bonds);
        if t.atom_virial {
            sums.per_atom_virial = Some(&mut virials);
        }
        let mut f = std::mem::take(&mut w.particles.f);
        let tally = (t.energy || t.virial || t.atom_energy).then_some(&mut sums);
        families.force(&view(w)?, &mut f, !t.setup && !t.trial, tally);
        w.particles.f = f;
        let (energy, virial) = (sums.energy, sums.virial);
        (w.tally.bond_atom, w.tally.atom_bonds) = (energies, virials);
        w.tally.bond += energy;
        w.tally.bond_virial.iter_mut().zip(virial).for_each(|(total, part)| *total += part);
        Ok(())
    }
}

/// Takes the bonds that broke in this step out of the table.
fn take_away(w: &mut World, families: &mut Families) {
    let tag = |i: u32| w.particles.tag[i as usize];
    let mut pairs: Vec<[u32; 2]> = families.broken().iter().map(|ends| ends.map(tag)).collect();
    pairs.iter_mut().for_each(|p| p.sort_unstable());
    pairs.sort_unstable();
    w.bonds.part(&pairs);
    families.seen = w.bonds.changes;
}

/// Writes what the deck has made properties for.
fn publish(w: &mut World, families: &Families) {
    let n = w.n();
    if let Some(key) = w.columns.property(*DAMAGE) {
        let mut column = std::mem::take(w.columns.scalar(key, n));
        families.damage_all(w.volumes(), &mut column);
        *w.columns.scalar(key, n) = column;
    }
    fill(w, *DILATATION, |i| families.dilatation(i));
    fill(w, *MULTIPLIER, |i| families.plastic_strain(i));
}

/// Fills a column of the deck's, where it has one of this name.
fn fill(w: &mut World, role: Numbers, value: impl Fn(usize) -> f64) {
    let n = w.n();
    if let Some(key) = w.columns.property(role) {
        w.columns.scalar(key, n).iter_mut().enumerate().for_each(|(i, v)| *v = value(i));
    }
}
