//! The op behind all peridynamic styles: families at the first run, forces at every step.

use super::scatter::Scatter;
use super::thermal::Thermal;
use super::{Pair, Solid, bond_weights, breaking, pulled, reunion};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result};
use perigrain_constitutive::Failure;
use perigrain_peri::families::{
    Criterion, Families, FamilyOptions, ForceUnit, PeriTally, PmbCoeff, PmbTable,
};
use perigrain_plan::{About, Level, Needs, Op, Span, Stage, Tick};
use perigrain_styles::peri_view::view;
use perigrain_styles::{BondFormula, FORMULAS};
use perigrain_world::adapted::Coefficient;
use perigrain_world::field::{
    BOX, COLUMNS, DENSITY, F, FACTS, FAMILIES, Fields, KIND, LISTS, MASK, MASS, MEMO, MOLECULE, RADIUS,
    SITES, TAG, TALLY, VOLUME, X, X0,
};
use perigrain_world::{Crack, Key, Numbers, World};

/// Bond and short-range forces of all peridynamic bodies.
pub struct Force {
    style: Solid,
    options: FamilyOptions,
    name: String,
    /// Bonds that differ from particle to particle.
    scatter: Scatter,
    /// Thermal strains, where there are some.
    thermal: Option<Thermal>,
    /// The coefficients of the deck's lines, before micro-moduli were calibrated.
    declared: PmbTable,
    /// Which changes by fixes have been seen.
    adapted: f64,
    /// Where they are, of c, s00 and alpha of each pair of types.
    keys: Vec<((u16, u16), [Numbers; 3])>,
    /// Where the energy goes.
    tally: Key<f64>,
    /// By what bonds break, where a formula decides.
    formula: Option<BondFormula>,
}

impl Force {
    /// The op of a style.
    pub fn new(
        style: Solid,
        declared: PmbTable,
        options: FamilyOptions,
        (scatter, thermal, formula): (Scatter, Option<Thermal>, Option<BondFormula>),
    ) -> Self {
        let name = format!("pair {}", style.name);
        let key = |types, name: &str| {
            let (style, name) = (style.name.to_string(), name.to_string());
            Coefficient { bond: false, style, name, types }.key()
        };
        let types = style.table.types() as u16;
        let pairs = (1..=types).flat_map(|i| (i..=types).map(move |j| (i, j)));
        let keys = pairs.map(|p| (p, ["c", "s00", "alpha"].map(|name| key(p, name)))).collect();
        let tally = Key::new(style.name);
        Self { style, options, name, scatter, thermal, declared, adapted: 0.0, keys, tally, formula }
    }
}

impl Op for Force {
    fn about(&self) -> About {
        let factors = if self.scatter.any() || self.thermal.is_some() { COLUMNS } else { Fields::NONE };
        let formula = if self.formula.is_some() { FORMULAS } else { Fields::NONE };
        let warms = self.thermal.as_ref().is_some_and(Thermal::warms);
        About {
            level: Level::At(0),
            ..About::new(
                &self.name,
                Stage::Force,
                Needs::new()
                    .read(
                        TAG | MASK
                            | MOLECULE
                            | X
                            | X0
                            | KIND
                            | VOLUME
                            | BOX
                            | MEMO
                            | DENSITY
                            | RADIUS
                            | factors
                            | formula,
                    )
                    .add(F)
                    .write(LISTS | FAMILIES | SITES | TALLY | FACTS)
                    .keep(if warms { MASS | COLUMNS } else { MASS }),
            )
        }
    }

    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let first = w.families.is_none();
        if t.setup {
            self.prepare(w)?;
        } else if self.adapted != w.adaptations() {
            self.adapt(w)?;
        }
        let due = t.step % self.style.breaking.every == 0;
        let ratios = match &mut self.formula {
            Some(formula) if due && !t.setup && !t.trial => formula(w)?,
            _ => vec![],
        };
        let Some(mut families) = w.families.take() else { return Ok(()) };
        families.law.dt = t.dt;
        families.implicit &= !t.setup;
        (families.unjudged, families.ratios) = (!due, ratios);
        let mut sums = PeriTally::default();
        let mut atoms = std::mem::take(&mut w.tally.atom);
        if t.atom_energy {
            sums.per_atom_energy = Some(&mut atoms);
        }
        let mut virials = std::mem::take(&mut w.tally.atom_virial);
        if t.atom_virial {
            sums.per_atom_virial = Some(&mut virials);
        }
        let advance = match t.setup {
            // LAMMPS advances bonds in the setup of every run but the first, be that one of no steps.
            true => w.settings.lammps() && !first && !t.unchanged,
            false => !t.trial,
        };
        let tally = (t.energy || t.virial || t.atom_energy).then_some(&mut sums);
        if tally.is_some() {
            // On ranks: squeezed bonds are few, and each rank adds up all of them.
            w.whole(X);
        }
        if let Some(thermal) = &mut self.thermal {
            thermal.begin(&mut families, w)?;
        }
        let begun = families.begin(&view(w)?, advance, w.is_narrow());
        if let Some(thermal) = self.thermal.as_mut().filter(|_| advance) {
            thermal.end(&mut families, w)?;
        }
        let searches = begun.searches;
        if searches {
            // On ranks: those that come near may be anywhere.
            w.whole(X);
        }
        let mut f = std::mem::take(&mut w.particles.f);
        families.finish(&view(w)?, &mut f, begun, tally);
        if let Some(thermal) = self.thermal.as_ref().filter(|_| advance) {
            thermal.warm(&families, w);
        }
        if advance && families.options.reunite && families.parted(|i| reunion::outside(w, i)) {
            // Contacts are looked for anew in the next step.
            w.rebuild.due = true;
        }
        w.particles.f = f;
        let (mut energy, virial) = (sums.energy, sums.virial);
        if let Some((p, why)) = families.fault() {
            if !t.trial {
                return Err(self.without_stress(w, p as usize, why));
            }
            // A place that is tried in vain: whatever tries it goes less far.
            w.particles.f[p as usize] = [f64::NAN; 3];
            energy = f64::INFINITY;
        }
        (w.tally.atom, w.tally.atom_virial) = (atoms, virials);
        w.tally.add_pair(self.tally, energy);
        for (total, part) in w.tally.virial.iter_mut().zip(virial) {
            *total += part;
        }
        w.families = Some(families).into();
        if searches {
            w.link();
        }
        Ok(())
    }

    fn span(&mut self, w: &mut World, t: &Tick) -> Span {
        let tallied = t.energy || t.virial;
        let shared = w.families.past().as_ref().is_some_and(|families| families.is_shared(!t.trial, tallied));
        let same = self.adapted == w.adaptations() && !t.atom_energy && !t.atom_virial;
        if shared && same && !t.setup && self.thermal.is_none() { Span::Near } else { Span::All }
    }
}

impl Force {
    /// The error of a particle whose material has no stress for how it is deformed.
    fn without_stress(&self, w: &World, p: usize, why: Failure) -> Diagnostics {
        let (tag, kind) = (w.particles.tag[p], w.particles.kind[p]);
        let text =
            format!("pair_style {} has no stress for particle {tag} (type {kind}): {why}", self.style.name);
        Diagnostic::error(Code::HALTED, None, text)
            .help("a shorter timestep, or bonds that break before (`s00`): a particle has been squeezed or torn too far in one step")
            .into()
    }

    /// Refuses families whose bonds lie in a plane, under correspondence.
    fn check_flat(&self, w: &World, families: &Families) -> Result<()> {
        let Some(p) = families.flat(&view(w)?) else { return Ok(()) };
        let (tag, kind) = (w.particles.tag[p], w.particles.kind[p]);
        let text = format!(
            "the bonds of particle {tag} (type {kind}) lie in a plane: it has no deformation gradient"
        );
        Err(Diagnostic::error(Code::CONFLICT, None, text)
            .help(format!(
                "pair_style {} needs bonds in three independent directions: two layers of particles or more; peri/lps needs fewer",
                self.style.name
            ))
            .into())
    }

    /// Takes the coefficients that a fix has changed.
    fn adapt(&mut self, w: &mut World) -> Result<()> {
        self.adapted = w.adaptations();
        let Some(mut families) = w.families.take() else { return Ok(()) };
        let table = self.table(w)?;
        families.refresh(&view(w)?, &table);
        families.work_limits = breaking::work_limits(&self.style, &self.broken_at(&table), w);
        w.families = Some(families).into();
        Ok(())
    }

    /// The coefficients in force with micro-moduli as lines say them, which fracture energies go with.
    fn broken_at(&self, table: &PmbTable) -> PmbTable {
        let (mut broken, types) = (table.clone(), table.types() as u16);
        for (i, j) in (1..=types).flat_map(|i| (i..=types).map(move |j| (i, j))) {
            let (Some(own), Some(declared)) = (table.get(i, j), self.declared.get(i, j)) else { continue };
            // Both were accepted before.
            let _ = broken.set(i, j, PmbCoeff { c: declared.c, ..*own });
        }
        broken
    }

    /// Gives bonds their factors, which refreshed families may have of an earlier run.
    fn scatter(&self, w: &World, families: &mut Families) {
        let own = |i: usize| bond_weights::strength(&self.style, families, w.particles.kind[i], i);
        let by_stretch = self.options.criterion == Criterion::Stretch;
        let by_horizon: Vec<f64> = match families.spacing.is_empty() || !by_stretch {
            true => vec![],
            false => (0..w.n()).map(own).collect(),
        };
        self.scatter.give(w, families, by_horizon);
    }

    /// The coefficients in force.
    fn table(&self, w: &World) -> Result<PmbTable> {
        let mut table = self.style.table.clone();
        if w.adaptations() == 0.0 {
            return Ok(table);
        }
        for &((i, j), keys) in &self.keys {
            let (Some(own), Some(declared)) = (self.style.table.get(i, j), self.declared.get(i, j)) else {
                continue;
            };
            let [c, s00, alpha] = keys.map(|key| w.adapted(key));
            // A calibrated micro-modulus keeps its ratio to what the line says.
            let ratio = if declared.c > 0.0 { own.c / declared.c } else { 1.0 };
            let new = PmbCoeff {
                c: c.map_or(own.c, |c| c * ratio),
                s00: s00.unwrap_or(own.s00),
                alpha: alpha.unwrap_or(own.alpha),
                ..*own
            };
            table.set(i, j, new)?;
        }
        Ok(table)
    }

    /// Families at the first run, masses of true-force bodies at every run.
    fn prepare(&mut self, w: &mut World) -> Result<()> {
        self.adapted = w.adaptations();
        let table = self.table(w)?;
        if self.options.unit == ForceUnit::Newton {
            self.true_masses(w)?;
        }
        let mut families = match w.families.take() {
            Some(mut families) => {
                families.takes(&self.style.law, None)?;
                families.options = self.options;
                families.law = self.style.law.clone();
                families.refresh(&view(w)?, &table);
                families
            }
            None => {
                let law = self.style.law.clone();
                let families = Families::build_of(&view(w)?, &table, self.options, law)?;
                self.check_flat(w, &families)?;
                bond_weights::leave_room(&self.style, &families, w)?;
                self.note_lone(w, &families);
                self.note_doubles(w, &families);
                note_almost(w, &families);
                self.scatter.note(w);
                bond_weights::note(&self.style, &families, w);
                let notes = pulled::notes(&self.style, &families, &view(w)?);
                notes.into_iter().for_each(|note| w.notes.push(note));
                families
            }
        };
        self.scatter(w, &mut families);
        families.work_limits = breaking::work_limits(&self.style, &self.broken_at(&table), w);
        w.families = Some(families).into();
        self.mark(w)?;
        reunion::check_spheres(&self.style, w)
    }

    /// Cracks that have waited for families, and particles whose bonds never break.
    fn mark(&self, w: &mut World) -> Result<()> {
        let Some(mut families) = w.families.take() else { return Ok(()) };
        for crack in std::mem::take(&mut w.cracks) {
            if families.cut(&view(w)?, |a, b| crack.cuts(a, b)) == 0 {
                return Err(Crack::missed(&crack).into());
            }
        }
        families.lasting.clear();
        if !self.style.lasting.is_empty() {
            let start = families.reference.as_deref().unwrap_or(&w.particles.x0);
            let lasts = |x: &[f64; 3]| self.style.lasting.iter().any(|r| r.contains(*x));
            families.lasting = start.iter().map(lasts).collect();
        }
        w.families = Some(families).into();
        Ok(())
    }

    /// Warns of particles of solids that no bond reaches.
    fn note_lone(&self, w: &mut World, families: &Families) {
        let p = &w.particles;
        let lone = |i: &usize| self.style.covers(p.kind[*i], p.kind[*i]) && families.family_size[*i] == 0;
        let mut all = (0..p.len()).filter(lone);
        let Some(first) = all.next().filter(|_| !self.options.compat_lammps) else { return };
        let (tag, kind, others) = (p.tag[first], p.kind[first], all.count());
        let more = if others > 0 { format!(" and {others} more have") } else { " has".to_string() };
        let text =
            format!("particle {tag} (type {kind}){more} no partner within the horizon: no bond holds it");
        let horizon = self.style.table.get(kind, kind).map_or(0.0, |c| c.horizon);
        w.notes.push(
            Diagnostic::warning(Code::SUSPICIOUS, None, text)
                .help(format!("the horizon is {horizon}: compare it with the distance of particles"))
                .help("particles that shall only touch others need no peridynamic coefficients of their own"),
        );
    }

    /// Warns of particles of solids that stand at the place of another one: bodies with such are on no lattice.
    fn note_doubles(&self, w: &mut World, families: &Families) {
        let p = &w.particles;
        let mut order: Vec<usize> =
            families.list.particle.iter().filter(|p| **p != u32::MAX).map(|p| *p as usize).collect();
        order.sort_unstable_by(|&a, &b| p.x[a].partial_cmp(&p.x[b]).unwrap_or(std::cmp::Ordering::Equal));
        let double = |pair: &&[usize]| {
            let (a, b) = (pair[0], pair[1]);
            p.x[a] == p.x[b] && self.style.covers(p.kind[a], p.kind[b])
        };
        let mut all = order.windows(2).filter(double);
        let Some(first) = all.next() else { return };
        let (a, b, others) = (p.tag[first[0]], p.tag[first[1]], all.count());
        let more = if others > 0 { format!(", and {others} more pairs,") } else { String::new() };
        let text = format!(
            "particles {} and {}{more} are at the same place: no bond joins them",
            a.min(b),
            a.max(b)
        );
        w.notes.push(
            Diagnostic::warning(Code::SUSPICIOUS, None, text)
                .help("`delete_atoms overlap` takes away one of two such particles before the run"),
        );
    }

    /// m = ρV for every particle of a peridynamic type.
    fn true_masses(&self, w: &mut World) -> Result<()> {
        let p = &mut w.particles;
        for i in 0..p.len() {
            let kind = p.kind[i];
            if !self.style.covers(kind, kind) {
                continue;
            }
            let density = self.style.materials.density(kind).unwrap_or(p.density[i]);
            if density.is_nan() || density <= 0.0 {
                return Err(Diagnostic::error(
                    Code::INCOMPLETE,
                    None,
                    format!(
                        "particle {} (type {kind}) has no density, which `peri_modify force newton` needs",
                        p.tag[i]
                    ),
                )
                .help(format!("add `set type {kind} density …`"))
                .into());
            }
            p.mass[i] = density * p.volume[i];
        }
        Ok(())
    }
}

/// Warns once of bodies that were meant to be on a lattice and are a little off it.
fn note_almost(w: &mut World, families: &Families) {
    let count: usize = families.almost.iter().map(|body| body.count).sum();
    let Some(worst) = families.almost.iter().max_by(|a, b| a.off.total_cmp(&b.off)) else { return };
    let bodies = match families.almost.len() {
        1 => "a body".to_string(),
        n => format!("{n} bodies"),
    };
    let tag = w.particles.tag[worst.first as usize];
    let text = format!(
        "{bodies} of {count} particles (the one with particle {tag}) would be on a lattice, but for particles up to {:.1e} of the \
         distance of neighbours off their sites: bonds are computed one by one, as a list",
        worst.off
    );
    w.notes.push(
        Diagnostic::warning(Code::SUSPICIOUS, None, text)
            .help("results are as good; on a lattice (sites hit to 1e-10 of that distance) steps take a fraction of the time")
            .help("places with more digits, or particles made by `create_atoms`, are on their lattice"),
    );
}
