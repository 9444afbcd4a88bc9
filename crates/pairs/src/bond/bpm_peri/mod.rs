//! bond bpm/peri: peridynamic families that are the bonds of the bond table.

mod op;
mod table;

use super::{BondForce, BondStyle, Pull, Stretched, breaking_weights};
use crate::peri::{beyond_elastic, lasting, of_bonds, stiffness, written};
use op::Force;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_lang::{Args, Word};
use perigrain_peri::families::{Moduli, PmbCoeff};
use perigrain_peri::law::{LAWS, PMB, Style as BondLaw};
use perigrain_plan::Op;
use perigrain_styles::words::{Form, Syntax, Words, read_or};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::World;
use perigrain_world::columns::VOLUME_PROPERTY;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// The style.
pub struct BpmPeri;

impl Style for BpmPeri {
    fn name(&self) -> &'static str {
        "bpm/peri"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(*FORMS),
            summary: "Peridynamic bonds, of laws pmb, lps, ves and eps, that are made and taken away like any others.",
            text: include_str!("page.md"),
            example: "units si\natom_style bond\nlattice sc 5.0e-4\nregion b block -0.004 0.004 -0.002 0.002 -0.002 0.002 units box\n\
                      region bar block -0.00201 0.00201 -0.00051 0.00051 -0.00051 0.00051 units box\n\
                      create_box 1 b bond/types 1 extra/bond/per/atom 130\ncreate_atoms 1 region bar\n\
                      fix vol all property/atom d_vfrac d_damage d_theta ghost yes\nset group all d_vfrac 1.25e-10\nmass * 2200.0\n\
                      special_bonds lj 0.0 1.0 1.0 coul 0.0 1.0 1.0\npair_style bpm/peri\npair_coeff * * 1.6863e22 0.0015001\n\
                      create_bonds many all all 1 0.0 0.0015001\nspecial_bonds lj 0.0 1.0 1.0 coul 1.0 1.0 1.0\n\
                      bond_style bpm/peri\nbond_coeff 1 lps 14.9e9 14.9e9 0.0015001 0.0005 0.25\n\
                      variable pull atom 2000.0*x\nvelocity all set v_pull NULL NULL units box\nfix 1 all nve\n\
                      compute broken all property/atom d_damage\ncompute mean all reduce ave c_broken\n\
                      timestep 1.0e-7\nthermo_style custom step ebond bonds c_mean\nrun 20",
        }
    }
}

static FORMS: LazyLock<&[Form]> = LazyLock::new(|| of_bonds(laws(), Line::GRAMMAR));

impl BondStyle for BpmPeri {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn BondForce>> {
        let style = cx.world.particles.style;
        if style.peri {
            let text = "particles of atom_style peri have families of their own, by distance";
            let d = Diagnostic::error(Code::CONFLICT, args.name_span(), text);
            return Err(d
                .help("`atom_style bond` or `hybrid sphere bond` goes with bond_style bpm/peri")
                .into());
        }
        if cx.world.columns.property(*VOLUME_PROPERTY).is_none() {
            let text = "bond_style bpm/peri needs the volumes of particles, the property d_vfrac";
            let d = Diagnostic::error(Code::WRONG_ORDER, args.name_span(), text);
            return Err(d
                .help("put `fix vol all property/atom d_vfrac ghost yes` and `set group all d_vfrac …` before it")
                .into());
        }
        let Line { force } = read_or(args, cx, foreign)?;
        let newton = force == Unit::Newton;
        Ok(Box::new(Declared { newton, coeffs: BTreeMap::new() }))
    }
}

/// The words of the style.
#[derive(Words)]
struct Line {
    #[word(keyword, default = Unit::Density)]
    force: Unit,
}

/// What forces are.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "unit of forces")]
enum Unit {
    /// Forces per volume of the particle that they act on, as in LAMMPS.
    Density,
    /// True forces: multiplied by the particle's own volume.
    Newton,
}

/// The refusal of a keyword that LAMMPS has here.
fn foreign(word: &Word) -> Option<Diagnostics> {
    let (why, instead) = match word.text.as_str() {
        "store/local" => (
            "broken bonds are no table here",
            "`d_damage`, `compute damage/atom` and thermo's `bonds` count them",
        ),
        "write/history" | "write/reference" | "read/history" | "read/reference" => (
            "the undeformed state is kept with the particles",
            "`write_restart` and `read_restart` carry it over",
        ),
        _ => return None,
    };
    let text = format!("this keyword of bond_style bpm/peri is not in perigrain: {why}");
    Some(Diagnostic::error(Code::NOT_SUPPORTED, word.span, text).help(instead).into())
}

/// The options of a line for bonds.
#[derive(Clone, Copy)]
struct Coeff {
    law: &'static BondLaw,
    bond: PmbCoeff,
    moduli: Moduli,
}

/// The style with its coefficients.
#[derive(Clone)]
struct Declared {
    /// Forces are true ones.
    newton: bool,
    coeffs: BTreeMap<u16, Coeff>,
}

/// The laws that bonds of a table may have.
fn laws() -> impl Iterator<Item = &'static BondLaw> {
    LAWS.iter().map(|law| law.style()).filter(|law| law.of_bonds)
}

/// The words of a law, in LAMMPS' order for bonds.
fn coefficients(args: &mut Args, cx: &BuildCx) -> Result<Coeff> {
    let span = args.here();
    let name = args.choice("law of the bonds", &laws().map(|law| law.name).collect::<Vec<_>>())?;
    let law = laws().find(|law| law.name == name).unwrap_or(PMB.style());
    let (c, mut moduli) = stiffness(law, args, cx)?;
    beyond_elastic(law, args, &mut moduli)?;
    let (horizon, s00, alpha) = lasting(args, cx)?;
    if !args.is_empty() {
        let text = format!("too many numbers for bonds of law {name}");
        return fail(Code::EXTRA_ARGUMENT, span.to(args.here()), text);
    }
    Ok(Coeff { law, bond: PmbCoeff { c, horizon, s00, alpha }, moduli })
}

impl BondForce for Declared {
    fn name(&self) -> &'static str {
        "bpm/peri"
    }

    fn coeff(&mut self, kinds: &[u16], args: &mut Args, cx: &BuildCx) -> Result<()> {
        let span = args.here();
        let coeff = coefficients(args, cx)?;
        if let Some(&most) = kinds.iter().find(|k| **k > 255) {
            return fail(Code::NOT_SUPPORTED, cx.span, format!("bond type {most}: bpm/peri knows 255"));
        }
        let other = self.coeffs.iter().find(|(k, c)| !kinds.contains(k) && c.law.name != coeff.law.name);
        if let Some((k, c)) = other {
            let (own, one) = (coeff.law.name, c.law.name);
            let text = format!("{own} beside {one} of bond type {k}: the bonds of a scene have one law here");
            return Err(Diagnostic::error(Code::NOT_SUPPORTED, span, text)
                .help("coefficients may differ from type to type, the law may not")
                .into());
        }
        self.coeffs.extend(kinds.iter().map(|&k| (k, coeff)));
        Ok(())
    }

    fn covers(&self, kind: u16) -> bool {
        self.coeffs.contains_key(&kind)
    }

    fn restrict(&mut self, kinds: &[u16]) {
        self.coeffs.retain(|k, _| kinds.contains(k));
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        let w = cx.world();
        breaking_weights(w, false, span)?;
        cubic(w, "bond_style bpm/peri", span)?;
        if w.families.as_ref().is_some_and(|f| f.of_bonds.is_empty()) {
            return fail(Code::CONFLICT, span, "the scene has peridynamic families by distance already");
        }
        w.bonds.newton = self.newton;
        cx.leave_out("lattice layout of bpm/peri", "bonds come from a table, so they are kept as a list");
        Ok(vec![Box::new(Force::new(self.clone(), span))])
    }

    fn single(&self, _w: &World, _bond: &Stretched) -> Option<Pull> {
        None
    }

    fn companions(&self) -> &'static [&'static str] {
        &["bpm/peri", "zero"]
    }

    fn written(&self, kind: u16) -> Option<String> {
        let Coeff { law, bond, moduli } = self.coeffs.get(&kind)?;
        let stiff = if law.bond_based { vec![bond.c] } else { vec![moduli.bulk, moduli.shear] };
        let own = stiff.into_iter().chain(written(law, moduli));
        let all = own.chain([bond.horizon, bond.s00, bond.alpha]);
        let words: Vec<String> = all.map(|a| general(a, 16)).collect();
        Some(format!("{} {}", law.name, words.join(" ")))
    }
}

/// Partial volumes and contact go by one lattice spacing.
///
/// # Errors
/// Without a lattice, or with one that is not cubic.
pub fn cubic(w: &World, what: &str, span: Span) -> Result<()> {
    let [a, b, c] = w.lattice.spacing;
    if !w.lattice.basis.is_empty() && a == b && b == c && a > 0.0 {
        return Ok(());
    }
    let text = format!("{what} needs a lattice that is the same in x, y and z");
    Err(Diagnostic::error(Code::CONFLICT, span, text)
        .help("`lattice sc SPACING` before the run sets the distance of the particles of the solid")
        .into())
}
