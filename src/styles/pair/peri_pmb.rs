//! `pair_style peri/pmb`: bond-based peridynamics with the prototype microelastic brittle model.

use super::horizon;
use super::materials::Materials;
use super::{Pair, PairStyle, TypePairs};
use crate::diag::{Code, Diagnostic, Result, fail};
use crate::lang::Args;
use crate::plan::{Access, Op, Stage, Tick};
use crate::styles::{BuildCx, Doc, SealCx, Style};
use crate::world::families::{
    Bounds, Families, FamilyOptions, ForceUnit, Layout, PeriTally, PeriView, PmbCoeff, PmbTable, VolumeRule,
};
use crate::world::{Domain, World};

/// The style.
pub struct PeriPmb;

impl Style for PeriPmb {
    fn name(&self) -> &'static str {
        "peri/pmb"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "pair_style peri/pmb\n\
                     pair_coeff i j c horizon s00 alpha\n\
                     pair_coeff i j material ID horizon H [form bulk|shear|young] [s00 value] [alpha value]\n\
                     pair_coeff i j mix arithmetic|harmonic|geometric\n\
                     peri_modify [force density|newton] [volume lammps|none|full]",
            summary: "Bond-based peridynamics: elastic bonds that break when stretched too far.",
            text: "Every particle has bonds to all others within the `horizon` δ at the first run. A bond of reference \
                length |ξ| and stretch s = (r − |ξ|)/|ξ| pulls with the force density `c` s w V_j; w is the partial \
                volume weight. It breaks for good when s > `s00` − `alpha` max(s_min,i, s_min,j), with s_min the smallest \
                stretch of each particle's live bonds in the step before; nothing breaks in the first step. Particles \
                closer than min(0.9 of their distance at creation, 1.35 lattice spacings) repel each other with \
                15 c/δ, bonded or not (Silling & Askari 2005; Parks et al. 2008).\n\n\
                Units: c energy/length⁷ (force per volume²), horizon length, s00 and alpha without dimension. \
                With numbers as coefficients forces are force densities and `mass` is the density, as in LAMMPS. \
                A `material` turns engineering data into c and s00, its horizon counted in lattice spacings, and makes \
                forces true forces and masses ρV (`peri_modify force newton`). `form` says which modulus the bonds keep, as they fix \
                ν = 1/4: c = 18K/(πδ⁴) (`bulk`, the default), 30G/(πδ⁴) (`shear`, Walayat et al. 2023) or 12E/(πδ⁴) (`young`); \
                s00 = √(10 G_c/(π c δ⁵)), or what is said here or by the material. `mix`, for two types that both have a \
                material (no ranges), takes means of their data. Materials and plain numbers do not go together in one body.\n\n\
                `peri_modify volume`: `lammps` weighs bonds within half a spacing of the horizon by \
                (δ + dx/2 − |ξ|)/dx, `none` not at all, `full` extends the family to δ + dx/2, where that weight \
                vanishes.",
            example: "pair_style peri/pmb\npair_coeff * * 1.6863e22 0.0015001 5.0e-4 0.25",
        }
    }
}

impl PairStyle for PeriPmb {
    fn build(&self, _args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        if !cx.world.particles.style.peri {
            return Err(Diagnostic::error(
                Code::WRONG_ORDER,
                cx.span,
                "pair_style peri/pmb needs particles with a volume",
            )
            .help("put `atom_style peri` (or `hybrid sphere peri`) at the top of the deck")
            .into());
        }
        Ok(Box::new(Pmb {
            table: PmbTable::new(cx.world.types),
            materials: Materials::default(),
            raw: false,
            unit: None,
            volume: VolumeRule::Lammps,
        }))
    }
}

/// The style with its coefficients.
#[derive(Clone)]
struct Pmb {
    table: PmbTable,
    materials: Materials,
    /// Some pair was given as numbers.
    raw: bool,
    /// `peri_modify force`, if it was said.
    unit: Option<ForceUnit>,
    volume: VolumeRule,
}

impl Pmb {
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
    }

    fn numbers(args: &mut Args, cx: &BuildCx) -> Result<PmbCoeff> {
        let c = args.non_negative("the micro-modulus c")?;
        let span = args.here();
        let horizon = args.positive("the horizon")?;
        let s00 = args.non_negative("the critical stretch s00")?;
        let alpha = args.non_negative("alpha")?;
        let lc = cx.world.lattice.spacing[0];
        if horizon < lc && lc > 0.0 {
            cx.note(
                Diagnostic::warning(
                    Code::SUSPICIOUS,
                    span,
                    format!("the horizon {horizon} is shorter than the lattice spacing {lc}: no bonds"),
                )
                .help("a horizon of about 3 spacings is usual"),
            );
        }
        if !cx.world.lattice.basis.is_empty() && lc > 0.0 {
            horizon::warn(horizon / lc, lc, span, cx);
        }
        Ok(PmbCoeff { c, horizon, s00, alpha })
    }
}

impl Pmb {
    /// The smallest density of a type's particles; in LAMMPS' convention their mass holds it.
    fn lightest(&self, w: &World, kind: u16) -> Option<f64> {
        let p = &w.particles;
        let column = if self.unit() == ForceUnit::Newton { &p.density } else { &p.mass };
        let of_kind = p.kind.iter().zip(column).filter(|(k, d)| **k == kind && **d > 0.0);
        of_kind.map(|(_, d)| *d).reduce(f64::min)
    }

    /// Whether `neigh_modify exclude` concerns pairs that this style acts on.
    fn loses_pairs(&self, w: &World) -> bool {
        let (rules, p) = (&w.settings.neighbor, &w.particles);
        let has = |bit: u32| (0..w.n()).any(|i| p.mask[i] & bit != 0 && self.covers(p.kind[i], p.kind[i]));
        rules.exclude_types.iter().any(|&(a, b)| self.covers(a, b))
            || rules.exclude_groups.iter().any(|&(a, b)| has(a) && has(b))
    }
}

impl Pair for Pmb {
    fn name(&self) -> &'static str {
        "peri/pmb"
    }

    fn coeff(&mut self, pairs: &TypePairs, args: &mut Args, cx: &BuildCx) -> Result<()> {
        self.grow(cx.world.types);
        args.eat("peri/pmb");
        let span = args.here();
        let coeff = match self.materials.coeff(pairs, args, cx)? {
            Some(coeff) => coeff,
            None => {
                self.raw = true;
                Self::numbers(args, cx)?
            }
        };
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

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        let w = cx.world();
        let [a, b, c] = w.lattice.spacing;
        if !(a == b && b == c) {
            return fail(Code::CONFLICT, span, "peri/pmb needs a lattice that is the same in x, y and z");
        }
        if self.loses_pairs(w) {
            let text = "neigh_modify exclude takes pairs away from peri/pmb: perigrain cannot do that yet";
            return fail(Code::NOT_SUPPORTED, span, text);
        }
        let s = &w.settings;
        let options = FamilyOptions {
            volume: self.volume,
            unit: self.unit(),
            lattice_spacing: a,
            compat_lammps: s.lammps(),
            layout: if s.force_list { Layout::List } else { Layout::Auto },
            skip_rest: !s.no_skipping,
            portable: s.portable,
        };
        cx.leave_out(
            "neighbour list of peri/pmb",
            "bonds never change partners; close pairs are found by their stretch",
        );
        Ok(vec![Box::new(Force { style: self.clone(), options })])
    }

    fn modify(&mut self, command: &str, args: &mut Args, cx: &BuildCx) -> Result<()> {
        const KNOWN: [&str; 2] = ["force", "volume"];
        if command != "peri_modify" {
            return fail(
                Code::CONFLICT,
                cx.span,
                format!("`{command}` does not concern pair_style peri/pmb"),
            );
        }
        if args.is_empty() {
            return fail(Code::MISSING_ARGUMENT, args.here(), "peri_modify needs an option: force or volume");
        }
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "force" => {
                    self.unit = Some(match args.choice("unit of forces", &["density", "newton"])? {
                        "newton" => ForceUnit::Newton,
                        _ => ForceUnit::Density,
                    });
                }
                "volume" => {
                    self.volume = match args.choice("volume rule", &["lammps", "none", "full"])? {
                        "none" => VolumeRule::None,
                        "full" => VolumeRule::Full,
                        _ => VolumeRule::Lammps,
                    };
                }
                "calibrate" | "broken" | "family" | "nofail" => {
                    return fail(
                        Code::NOT_SUPPORTED,
                        word.span,
                        format!("peri_modify {} is not there yet", word.text),
                    );
                }
                _ => return Err(args.unknown(word, &KNOWN)),
            }
        }
        Ok(())
    }

    fn needs(&self) -> &'static [&'static str] {
        if self.materials.is_empty() { &["volume", "density"] } else { &["volume"] }
    }

    fn stable_step(&self, w: &World, said: Option<f64>) -> Option<f64> {
        let types = self.table.types() as u16;
        let stiffest = |i: u16| {
            let all = (1..=types).filter_map(|j| self.table.get(i, j));
            all.map(|p| p.c * p.horizon * p.horizon).reduce(f64::max)
        };
        // Bonds sum up to 2π c δ² over a whole ball (Silling & Askari 2005, equation 34).
        let ftm2v = w.settings.units.constants().ftm2v;
        let step = |i: u16| {
            let own = self.materials.density(i);
            let rho = own.or_else(|| if w.n() > 0 { self.lightest(w, i) } else { said })?;
            Some((rho / (ftm2v * std::f64::consts::PI * stiffest(i)?)).sqrt())
        };
        (1..=types).filter_map(step).reduce(f64::min)
    }

    fn true_forces(&self) -> Option<bool> {
        Some(self.unit() == ForceUnit::Newton)
    }

    fn check(&self, cx: &BuildCx) {
        let w = cx.world;
        if w.families.is_some() || !w.settings.lammps() {
            return;
        }
        let alphas = self.table.iter().any(|c| c.alpha != 0.0);
        if w.types > 1 && alphas {
            cx.note(Diagnostic::note(
                Code::COMPAT,
                cx.span,
                "compat lammps: one critical stretch per particle also across mixed types",
            ));
        }
    }

    fn boxed(&self) -> Box<dyn Pair> {
        Box::new(self.clone())
    }
}

/// Bond and short-range forces of all peridynamic bodies.
struct Force {
    style: Pmb,
    options: FamilyOptions,
}

impl Op for Force {
    fn name(&self) -> &str {
        "pair peri/pmb"
    }

    fn stage(&self) -> Stage {
        Stage::Force
    }

    fn access(&self) -> Access {
        Access::new("x x0 type volume families", "f families tally")
    }

    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if t.setup {
            self.prepare(w)?;
        }
        let Some(mut families) = w.families.take() else { return Ok(()) };
        let first = !families.armed;
        let mut sums = PeriTally::default();
        let mut atoms = std::mem::take(&mut w.tally.atom);
        if t.atom_energy {
            sums.per_atom_energy = Some(&mut atoms);
        }
        let advance = match t.setup {
            // LAMMPS advances bonds in the setup of every run but the first.
            true => w.settings.lammps() && !first && !t.unchanged,
            false => true,
        };
        let mut f = std::mem::take(&mut w.particles.f);
        let tally = (t.energy || t.virial || t.atom_energy).then_some(&mut sums);
        families.force(&view(w)?, &mut f, advance, tally);
        w.particles.f = f;
        let (energy, virial) = (sums.energy, sums.virial);
        w.tally.atom = atoms;
        w.tally.pair += energy;
        for (total, part) in w.tally.virial.iter_mut().zip(virial) {
            *total += part;
        }
        w.families = Some(families);
        Ok(())
    }
}

impl Force {
    /// Families at the first run, masses of true-force bodies at every run.
    fn prepare(&self, w: &mut World) -> Result<()> {
        if self.options.unit == ForceUnit::Newton {
            self.true_masses(w)?;
        }
        let families = match w.families.take() {
            Some(mut families) => {
                families.options = self.options;
                families.refresh(&view(w)?, &self.style.table);
                families
            }
            None => Families::build(&view(w)?, &self.style.table, self.options)?,
        };
        w.families = Some(families);
        Ok(())
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

fn view(w: &World) -> Result<PeriView<'_>> {
    let Domain { lo, hi, .. } = *w.domain()?;
    let p = &w.particles;
    let bounds = Bounds { lo, hi, periodic: w.domain()?.periodic() };
    Ok(PeriView { x: &p.x, x0: &p.x0, kind: &p.kind, volume: &p.volume, bounds })
}
