//! Peridynamic pair styles: what they share. A style is its law, the words of its coefficients and its page.

mod bond_probe;
mod bond_weights;
mod breaking;
mod cauchy;
mod eps;
mod force;
mod horizon;
mod lines;
mod lps;
pub mod materials;
mod numbers;
mod options;
mod plastic;
mod pmb;
mod pulled;
mod reunion;
mod scatter;
mod softening;
mod thermal;
mod ves;

use super::{ByPart, Deck, Facts, Pair, PairOption, Scales, TypePairs};
use bond_probe::BondProbe;
use breaking::Breaking;
pub use cauchy::PeriCauchy;
pub use eps::PeriEps;
use force::Force;
pub use lines::of_bonds;
pub use lps::PeriLps;
use materials::Materials;
pub use numbers::{beyond_elastic, lasting, stiffness, written};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::Args;
use perigrain_peri::calibration::constants;
use perigrain_peri::families::{
    BondWeights, Families, FamilyOptions, ForceUnit, Influence, Law, Layout, Moduli, PmbCoeff, PmbTable,
    VolumeRule,
};
use perigrain_peri::law::{LawKind, Style};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::peri_view::view;
use perigrain_styles::probe::Probe;
use perigrain_styles::words::Words;
use perigrain_styles::{BuildCx, SealCx};
use perigrain_world::{Region, World};
pub use plastic::PeriPmbPlastic;
pub use pmb::PeriPmb;
use scatter::Scatter;
pub use softening::PeriPmbSoftening;
use thermal::Thermal;
pub use ves::PeriVes;

/// A peridynamic style with its coefficients.
#[derive(Clone)]
struct Solid {
    name: &'static str,
    table: PmbTable,
    law: Law,
    materials: Materials,
    /// Some pair was given as numbers.
    raw: bool,
    /// `peri_modify force`, if it was said.
    unit: Option<ForceUnit>,
    volume: VolumeRule,
    calibrate: Calibrate,
    /// What bonds are weighed by one at a time.
    weights: BondWeights,
    /// By what bonds break.
    breaking: Breaking,
    /// Broken bonds still push.
    compress: bool,
    /// The rule of unloading that a line has said.
    unloading: Option<LawKind>,
    /// Regions whose particles' bonds never break.
    lasting: Vec<Region>,
    /// `peri_modify repulsion no`.
    no_repulsion: bool,
    /// `peri_modify family`, and where that was said: broken bonds let their ends touch.
    reunite: Option<(bool, Span)>,
}

/// Which constant of a simple cubic lattice of the present spacing the micro-modulus makes right.
#[derive(Clone, Copy, PartialEq, Eq, Words)]
#[word(what = "what to calibrate")]
enum Calibrate {
    /// The micro-modulus of a bond-based law is that of a whole ball.
    No,
    /// It is divided by what makes the bulk modulus right on a simple cubic lattice of the present spacing; s00 stays.
    Bulk,
    /// The same for Young's modulus along an axis, at ν = 1/4.
    Young,
}

/// Up to so many particles the exact limit of a step is looked for where the estimate is exceeded: it takes as long as some 60 steps.
const MOST_LOOKED_AT: usize = 2_000_000;

/// The law of bonds that a word of the line chooses by how they unload.
fn unloading(word: &str) -> Option<LawKind> {
    LawKind::unloading_as(word)
}

/// Starts a style: particles must have volumes.
fn start(name: &'static str, kind: LawKind, cx: &BuildCx) -> Result<Box<dyn Pair>> {
    Ok(Box::new(solid(name, kind, cx)?))
}

/// A style without coefficients yet.
fn solid(name: &'static str, kind: LawKind, cx: &BuildCx) -> Result<Solid> {
    if !cx.world.particles.style.peri {
        return Err(Diagnostic::error(
            Code::WRONG_ORDER,
            cx.span,
            format!("pair_style {name} needs particles with a volume"),
        )
        .help("put `atom_style peri` (or `hybrid sphere peri`) at the top of the deck")
        .into());
    }
    let influence = if kind.bond_based { Influence::One } else { Influence::default() };
    let law = Law { kind, influence, moduli: vec![Moduli::default(); cx.world.types], ..Law::default() };
    Ok(Solid {
        name,
        table: PmbTable::new(cx.world.types),
        law,
        materials: Materials::default(),
        raw: false,
        unit: None,
        volume: VolumeRule::Lammps,
        calibrate: Calibrate::No,
        weights: BondWeights::default(),
        breaking: Breaking::default(),
        compress: false,
        unloading: None,
        lasting: vec![],
        no_repulsion: false,
        reunite: None,
    })
}

/// Coefficients of one line: of the bonds, and of the ends where the law is state-based.
type Coeff = (PmbCoeff, Moduli);

/// Reads the coefficients of a law as LAMMPS writes them.
fn numbers(law: &Style, args: &mut Args, cx: &BuildCx) -> Result<Coeff> {
    let (mut c, mut moduli) = stiffness(law, args, cx)?;
    let span = args.here();
    let (horizon, s00, alpha) = match &law.curve {
        Some(curve) => {
            let horizon = numbers::reach(args, cx)?;
            beyond_elastic(law, args, &mut moduli)?;
            let energy = numbers::area(args, cx)?;
            let s00 = softening::last_stretch(curve, (moduli.peak, energy.value), (c, horizon), energy.span)?;
            (horizon, s00, 0.0)
        }
        None => {
            let lasting = lasting(args, cx)?;
            beyond_elastic(law, args, &mut moduli)?;
            lasting
        }
    };
    if !law.bond_based {
        c = short_range(moduli.bulk, horizon);
    }
    let lc = cx.world.lattice.spacing[0];
    if !cx.world.lattice.basis.is_empty() && lc > 0.0 {
        horizon::range(horizon / lc, span, cx);
        horizon::warn(horizon / lc, lc, span, cx);
    }
    Ok((PmbCoeff { c, horizon, s00, alpha }, moduli))
}

/// The micro-modulus whose short-range forces a state-based solid has: 18K/(πδ⁴).
fn short_range(bulk: f64, horizon: f64) -> f64 {
    18.0 * bulk / (std::f64::consts::PI * horizon.powi(4))
}

impl Solid {
    fn unit(&self) -> ForceUnit {
        let implied = if self.materials.is_empty() { ForceUnit::Density } else { ForceUnit::Newton };
        self.unit.unwrap_or(implied)
    }

    /// The table with room for all types (`pair_style` may come before `create_box`).
    fn grow(&mut self, types: usize) {
        if self.table.types() == types {
            return;
        }
        self.table = PmbTable::new(types);
        self.law.moduli = vec![Moduli::default(); types];
    }

    /// The smallest density of a type's particles; in LAMMPS' convention their mass holds it.
    fn lightest(&self, w: &World, kind: u16) -> Option<f64> {
        let p = &w.particles;
        let column = if self.unit() == ForceUnit::Newton { &p.density } else { &p.mass };
        let of_kind = p.kind.iter().zip(column).filter(|(k, d)| **k == kind && **d > 0.0);
        of_kind.map(|(_, d)| *d).reduce(f64::min)
    }

    /// The rule for yielding bonds on their way back, at the end of a line.
    fn unloading(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        if self.law.kind.unloading.is_none() {
            return Ok(());
        }
        let at = args.here();
        let (word, first) = (unloading(args.peek_text()), unloading("plastic"));
        let Some(chosen) = word.or(first.filter(|_| self.unloading.is_none())) else { return Ok(()) };
        if self.unloading.is_some_and(|known| known != chosen) {
            let text = "another pair has the other rule of unloading: one rule holds for all";
            return fail(Code::CONFLICT, at, text);
        }
        if word.is_some() {
            args.next();
            self.unloading = Some(chosen);
        }
        // Of a restart file the style is new and the families are not.
        if cx.world.families.as_ref().is_some_and(|f| f.law.kind != chosen) {
            return fail(Code::WRONG_ORDER, at, "the rule of unloading cannot change after the first run");
        }
        self.law.kind = chosen;
        Ok(())
    }

    fn options(&self, w: &World) -> FamilyOptions {
        let s = &w.settings;
        FamilyOptions {
            volume: self.volume,
            unit: self.unit(),
            lattice_spacing: w.lattice.spacing[0],
            compat_lammps: s.lammps(),
            mended: s.lammps_of_2026(),
            compress: self.compress,
            layout: if s.force_list { Layout::List } else { Layout::Auto },
            skip_rest: !s.no_skipping,
            portable: s.portable,
            no_repulsion: self.no_repulsion,
            reunite: self.reunite.is_some_and(|r| r.0),
            weights: self.weights,
            criterion: self.breaking.criterion,
        }
    }

    /// The coefficients with micro-moduli that are right on a simple cubic lattice of this spacing.
    fn calibrated(&self, spacing: f64, span: Span) -> Result<PmbTable> {
        let mut table = self.table.clone();
        if self.calibrate == Calibrate::No || !self.law.kind.bond_based {
            return Ok(table);
        }
        if self.law.surface || self.weights.any() {
            self.cannot(
                span,
                "cannot be calibrated and have its surfaces corrected or horizons of its own: the one makes K right by itself, the other knows no lattice",
            )?;
        }
        let types = table.types() as u16;
        for (i, j) in (1..=types).flat_map(|i| (i..=types).map(move |j| (i, j))) {
            let Some(own) = self.table.get(i, j).copied() else { continue };
            let lattice = constants(own.horizon / spacing, self.volume, self.law.influence);
            let ratio = if self.calibrate == Calibrate::Bulk { lattice.bulk } else { lattice.young };
            if lattice.neighbours == 0 {
                self.cannot(span, "cannot be calibrated: its horizon reaches no neighbour")?;
            }
            table.set(i, j, PmbCoeff { c: own.c / ratio, ..own })?;
        }
        Ok(table)
    }

    fn cannot(&self, span: Span, why: &str) -> Result<()> {
        fail(Code::CONFLICT, span, format!("{} {why}", self.name))
    }
}

impl Pair for Solid {
    fn facts(&self) -> Facts {
        let types = || 1..=self.table.types() as u16;
        let endless = |i: &u16| self.table.get(*i, *i).is_some_and(|c| c.s00.is_infinite());
        Facts {
            name: self.name,
            needs: if self.materials.is_empty() { &["volume", "density"] } else { &["volume"] },
            true_forces: Some(self.unit() == ForceUnit::Newton),
            elastic_grains: false,
            mixes: false,
            balances: true,
            solids: types().filter(|&i| self.covers(i, i)).collect(),
            unbreakable: types()
                .find(endless)
                .filter(|_| !self.materials.is_empty() && !self.breaking.criterion.by_itself()),
            coefficients: match self.law.kind {
                // Peak, last stretch and energy belong together.
                kind if kind.softens() => &[],
                kind if kind.bond_based => &["c", "s00", "alpha"],
                _ => &["s00", "alpha"],
            },
        }
    }

    fn coeff(&mut self, pairs: &TypePairs, args: &mut Args, cx: &BuildCx) -> Result<()> {
        self.grow(cx.world.types);
        args.eat(self.name);
        let span = args.here();
        let (coeff, moduli) = match self.materials.coeff(self.law.kind.style(), pairs, args, cx)? {
            Some(coeff) => coeff,
            None if self.law.kind.correspondence => {
                let text = format!("{} takes its coefficients from materials", self.name);
                return Err(Diagnostic::error(Code::BAD_VALUE, span, text)
                    .help("pair_coeff I J material ID horizon H, after `material ID …`")
                    .into());
            }
            None => {
                self.raw = true;
                bond_weights::needs_materials(self, span)?;
                numbers(&self.law.kind, args, cx)?
            }
        };
        self.unloading(args, cx)?;
        if self.raw && !self.materials.is_empty() {
            return Err(Diagnostic::error(
                Code::CONFLICT,
                span,
                "materials and plain numbers cannot be mixed in one peridynamic body: the one means forces, the other force densities",
            )
            .help("give every pair a `material` or `mix`, or every pair numbers")
            .into());
        }
        for &(i, j) in pairs {
            self.table.set(i, j, coeff).map_err(|e| e.at(span))?;
            if i == j {
                self.law.moduli[usize::from(i) - 1] = moduli;
                self.law.materials.resize(self.table.types(), None);
                self.law.materials[usize::from(i) - 1] = self.materials.stress(i);
            }
            let types = self.table.types();
            let Some(edge) = self.law.kind.edge.map(|edge| edge(&moduli)) else { continue };
            self.law.yields.resize(types * types, f64::NEG_INFINITY);
            let (a, b) = (usize::from(i) - 1, usize::from(j) - 1);
            self.law.yields[a * types + b] = edge;
            self.law.yields[b * types + a] = edge;
        }
        Ok(())
    }

    fn covers(&self, i: u16, j: u16) -> bool {
        (i.max(j) as usize) <= self.table.types() && self.table.get(i, j).is_some()
    }

    fn restrict(&mut self, pairs: &TypePairs) {
        let mut table = PmbTable::new(self.table.types());
        for &(i, j) in pairs {
            // These coefficients were accepted before.
            if let Some(Err(_)) = self.table.get(i, j).map(|c| table.set(i, j, *c)) {
                return;
            }
        }
        self.table = table;
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<ByPart<dyn Op>> {
        let span = cx.span();
        let w = cx.world();
        let [a, b, c] = w.lattice.spacing;
        if !(a == b && b == c) {
            self.cannot(span, "needs a lattice that is the same in x, y and z")?;
        }
        let options = self.options(w);
        bond_weights::allowed(self, &options, w.settings.two_dimensional, span)?;
        breaking::allowed(self, span)?;
        let scatter = Scatter::of(self, &options, w).map_err(|e| e.at(span))?;
        let mut style = self.clone();
        style.table = self.calibrated(a, span)?;
        let thermal = Thermal::of(self, &options, w, span)?;
        let unlike = self.law.surface || self.law.influence != Influence::One || scatter.stiffness;
        if unlike || thermal.is_some() {
            style.law.shape_bonds();
        }
        style.law.shared_or_apart(w.families.as_ref().map(|f| &f.law)).map_err(|e| e.at(span))?;
        breaking::moduli(&mut style, &self.table);
        cx.leave_out(
            &format!("neighbour list of {}", self.name),
            "bonds never change partners; close pairs are found by their stretch",
        );
        let breaking = &style.breaking;
        let when = if breaking.every == 1 { When::Always } else { When::Every(breaking.every) };
        let formula = match &breaking.formula {
            Some(r) => Some(cx.bond_formula(r, Stage::PreForce, &when)?),
            None => None,
        };
        Ok(vec![(0, Box::new(Force::new(style, self.table.clone(), options, (scatter, thermal, formula))))])
    }

    fn modify(&mut self, option: PairOption, cx: &BuildCx) -> Result<()> {
        match option {
            PairOption::Mix(_) => Ok(()),
            PairOption::Peri(args) => options::read(self, args, cx),
        }
    }

    fn coefficient(&self, name: &str, (i, j): (u16, u16)) -> Option<f64> {
        let own = self.table.get(i, j)?;
        match name {
            "c" => Some(own.c),
            "s00" => Some(own.s00),
            "alpha" => Some(own.alpha),
            _ => None,
        }
    }

    fn scales(&self, w: &World, deck: Deck) -> Scales {
        let types = self.table.types() as u16;
        let stiffest = |i: u16| {
            let all = (1..=types).filter_map(|j| self.table.get(i, j));
            if self.law.kind.bond_based {
                // Bonds sum up to 2π c δ² over a whole ball (Silling & Askari 2005, equation 34).
                return all.map(|p| std::f64::consts::PI * p.c * p.horizon * p.horizon).reduce(f64::max);
            }
            if self.law.kind.correspondence {
                let shortest = all.map(|p| p.horizon).reduce(f64::min)?;
                return Some(self.law.of(i).thick_step(shortest).powi(-2));
            }
            // Fitted to the exact limits of the cubic lattice, 1.48 dx/√(K/ρ) at nu = 0.25 and 3.39 at 0.48 for a
            // horizon of 3.015 dx (Bloch waves, weights of LAMMPS), less five per cent.
            let m = self.law.of(i);
            let shortest = all.map(|p| p.horizon).reduce(f64::min)?;
            Some((0.61 * m.bulk + 6.6 * m.shear) / (shortest * shortest))
        };
        let ftm2v = w.settings.units.constants().ftm2v;
        let surely = |i: u16| match self.law.kind.bond_based {
            true => stiffest(i),
            false if self.law.kind.correspondence => {
                Some(self.law.of(i).thin_step(w.lattice.spacing[0]).powi(-2))
            }
            false => {
                let horizons = (1..=types).filter_map(|j| self.table.get(i, j)).map(|p| p.horizon);
                Some(self.law.of(i).fastest(horizons.reduce(f64::min)?))
            }
        };
        let step = |i: u16, stiffest: &dyn Fn(u16) -> Option<f64>| {
            let own = self.materials.density(i);
            let stiffer = scatter::stiffest(w, i);
            let rho = own.or_else(|| if w.n() > 0 { self.lightest(w, i) } else { deck.density })?;
            Some((rho / (ftm2v * stiffer * stiffest(i)?)).sqrt())
        };
        let cutoff = self.table.iter().map(|c| c.horizon).reduce(f64::max);
        let [finest, widest] = bond_weights::spacings(self, w);
        let least = |stiffest: &dyn Fn(u16) -> Option<f64>| {
            (1..=types).filter_map(|i| step(i, stiffest)).reduce(f64::min).map(|t| finest * t)
        };
        let (stable_step, sure_step) = (least(&stiffest), least(&surely));
        Scales { cutoff: cutoff.map(|c| widest * c), stable_step, sure_step, contact_time: None }
    }

    fn limit(&self, w: &World) -> Option<f64> {
        if self.law.kind.bond_based || w.n() == 0 || w.n() > MOST_LOOKED_AT {
            return None;
        }
        let (view, p) = (view(w).ok()?, &w.particles);
        let mut law = self.law.clone();
        law.shared_or_apart(None).ok()?;
        let built = match &*w.families {
            Some(_) => None,
            None => Some(Families::build_of(&view, &self.table, self.options(w), law).ok()?),
        };
        let families = built.as_ref().or(w.families.as_ref())?;
        let density =
            |i: usize| self.materials.density(p.kind[i]).or(p.density.get(i).copied()).unwrap_or(0.0);
        let mass: Vec<f64> = match self.unit() {
            ForceUnit::Newton => (0..p.len()).map(|i| density(i) * p.volume[i]).collect(),
            ForceUnit::Density => p.mass.to_vec(),
        };
        let square = families.largest_eigenvalue(&view, &mass, w.settings.units.constants().ftm2v)?;
        Some(2.0 / square.sqrt())
    }

    fn check(&self, cx: &BuildCx) {
        let w = cx.world;
        reunion::check(self, cx);
        if w.families.is_some() {
            return;
        }
        if w.types > 1 && self.table.iter().any(|c| c.alpha != 0.0) {
            cx.fault(cx.span, "one critical stretch per particle also across mixed types", true);
        }
        if self.law.kind.yields() {
            cx.fault(cx.span, "the dilatation in the norm of the yield criterion", true);
        }
    }

    fn probes(&self, _w: &World, bonds: bool) -> Result<ByPart<dyn Probe>> {
        // Such a probe has one number for a pair of types.
        let even = !self.law.surface && !self.expands();
        let alike = even && self.law.influence == Influence::One && !self.weights.any();
        let plain = self.law.kind.plain() && !self.compress && alike;
        Ok(if bonds && plain { vec![(0, Box::new(BondProbe))] } else { vec![] })
    }
}
