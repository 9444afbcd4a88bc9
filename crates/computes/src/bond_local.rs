//! compute bond/local: lengths, energies and forces of bonds.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::vec3::{Vec3, dot, sub};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::bond::BondForce;
use perigrain_styles::matter::Masses;
use perigrain_styles::near::bonds_within;
use perigrain_styles::pull::{Pull, Stretched, apart};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Alternative, Kind, Syntax, Value, Words, alternatives, one_in, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BONDS, BOX, Fields, KIND, MASK, MASS, MEMO, TAG, TYPE_MASS, V, X};
use perigrain_world::index::Index;
use perigrain_world::{GroupId, SlotId, World};

/// The style.
pub struct BondLocal;

impl Style for BondLocal {
    fn name(&self) -> &'static str {
        "bond/local"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Lengths, energies, forces and relative motion of bonds.",
            text: "Local vector for one value, array for several; a row for each bond with both ends in the group, in the order \
                   of compute property/local. There are no energies and forces of `bond_style bpm/peri`, whose bonds depend on more than their ends.",
            example: "units lj\natom_style bond\nregion b block 0 4 0 4 0 4\ncreate_box 1 b bond/types 1 extra/bond/per/atom 2\n\
                      create_atoms 1 single 1 1 1\ncreate_atoms 1 single 2.1 1 1\nmass 1 1.0\n\
                      create_bonds single/bond 1 1 2\nbond_style harmonic\nbond_coeff 1 50.0 1.0\nfix 1 all nve\n\
                      compute l all bond/local dist force\ncompute m all reduce max c_l[1] c_l[2] inputs local\n\
                      thermo_style custom step c_m[*]\nrun 10",
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Quantity {
    Dist,
    D(usize),
    EngPot,
    Force,
    F(usize),
    EngVib,
    EngRot,
    EngTrans,
    Omega,
    VelVib,
    /// A value that only some bond styles provide, by name.
    Extra(&'static str),
}

const QUANTITIES: [(&str, Quantity); 26] = [
    ("dist", Quantity::Dist),
    ("dx", Quantity::D(0)),
    ("dy", Quantity::D(1)),
    ("dz", Quantity::D(2)),
    ("engpot", Quantity::EngPot),
    ("force", Quantity::Force),
    ("fx", Quantity::F(0)),
    ("fy", Quantity::F(1)),
    ("fz", Quantity::F(2)),
    ("engvib", Quantity::EngVib),
    ("engrot", Quantity::EngRot),
    ("engtrans", Quantity::EngTrans),
    ("omega", Quantity::Omega),
    ("velvib", Quantity::VelVib),
    ("b1", Quantity::Extra("b1")),
    ("b2", Quantity::Extra("b2")),
    ("b3", Quantity::Extra("b3")),
    ("b4", Quantity::Extra("b4")),
    ("b5", Quantity::Extra("b5")),
    ("b6", Quantity::Extra("b6")),
    ("b7", Quantity::Extra("b7")),
    ("tension", Quantity::Extra("tension")),
    ("shear", Quantity::Extra("shear")),
    ("bend", Quantity::Extra("bend")),
    ("twist", Quantity::Extra("twist")),
    ("load", Quantity::Extra("load")),
];

const NAMES: &[Alternative] = &alternatives(&QUANTITIES);

impl Value for Quantity {
    const KIND: Kind = Kind::Choice(NAMES);
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        if let Some(word) = args.peek().filter(|w| w.text.starts_with("v_") || w.text == "set") {
            let text = format!("`{}`: variables of the length are not in perigrain", word.text);
            return fail(Code::NOT_SUPPORTED, word.span, text);
        }
        one_in("value of bonds", args, &QUANTITIES)
    }
}

#[derive(Words)]
struct Line {
    /// `dist`: length, `dx dy dz` its components from the second end to the first; `engpot force fx fy fz`: energy and force of the
    /// bond (0 while it is turned off; negative pulls the ends together); of the ends' motion against their centre of mass: `engvib`
    /// kinetic energy along the bond, `engrot` across it, `velvib` the speed of lengthening, `omega` angular velocity; `engtrans`:
    /// kinetic energy of the centre; `b1 b2 …` and other names: values of the bond style, listed on its page, 0 of bonds that are
    /// turned off.
    #[word(name = "value", least = 1)]
    values: Vec<Quantity>,
}

impl Quantity {
    /// Whether it needs a bond style.
    fn of_force(self) -> bool {
        matches!(self, Quantity::EngPot | Quantity::Force | Quantity::F(_) | Quantity::Extra(_))
    }
}

impl ComputeStyle for BondLocal {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        if !cx.world.particles.style.bonded {
            let d = Diagnostic::error(
                Code::INCOMPLETE,
                cx.span,
                "compute bond/local needs an atom style with bonds",
            );
            return Err(d.help("`atom_style bond`, alone or in a hybrid, has them").into());
        }
        let Line { values } = read(args, cx)?;
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, values }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    values: Vec<Quantity>,
}

/// A bond with the positions and velocities of its ends.
struct Row {
    d: Vec3,
    pull: Pull,
    mass: [f64; 2],
    v: [Vec3; 2],
    /// Energy units per mass × velocity².
    mvv2e: f64,
}

impl Row {
    fn get(&self, value: Quantity) -> f64 {
        let [a, b] = self.mass;
        let total = a + b;
        let r = norm(self.d);
        let relative = sub(self.v[0], self.v[1]);
        let along = dot(relative, self.d) / r;
        let reduced = a * b / total;
        let across2 = (dot(relative, relative) - along * along).max(0.0);
        match value {
            Quantity::Dist => r,
            Quantity::D(k) => self.d[k],
            Quantity::EngPot => self.pull.energy,
            Quantity::Force => r * self.pull.force_per_length,
            Quantity::F(k) => self.d[k] * self.pull.force_per_length,
            Quantity::EngVib => 0.5 * self.mvv2e * reduced * along * along,
            Quantity::EngRot => 0.5 * self.mvv2e * reduced * across2,
            Quantity::EngTrans => {
                let c: Vec3 = std::array::from_fn(|k| (a * self.v[0][k] + b * self.v[1][k]) / total);
                0.5 * self.mvv2e * total * dot(c, c)
            }
            Quantity::Omega => across2.sqrt() / r,
            Quantity::VelVib => along,
            Quantity::Extra(_) => 0.0,
        }
    }
}

fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

impl Declared {
    /// Indices of the style's own values among those that only some styles provide.
    fn places(&self, style: Option<&dyn BondForce>, span: Span) -> Result<Vec<usize>> {
        let (known, name) = style.map_or((&[][..], ""), |s| (s.extras(), s.name()));
        let mut places = vec![];
        for value in &self.values {
            let Quantity::Extra(wanted) = value else { continue };
            let Some(place) = known.iter().position(|t| t == wanted) else {
                let text = format!("bond_style {name} has no `{wanted}` of its bonds");
                let d = Diagnostic::error(Code::WRONG_KIND, span, text);
                let known = known.iter().map(|t| format!("`{t}`")).collect::<Vec<_>>().join(", ");
                return Err(if known.is_empty() { d } else { d.help(format!("it has {known}")) }.into());
            };
            places.push(place);
        }
        Ok(places)
    }
}

/// The style's values for a bond.
fn pull_of(style: &dyn BondForce, w: &World, bond: &Stretched, span: Span) -> Result<Pull> {
    match style.single(w, bond) {
        Some(pull) => Ok(pull),
        None => {
            let text = format!("the force of bond_style {} is not of its two ends alone", style.name());
            fail(Code::CONFLICT, span, text)
        }
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { local: self.values.len(), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let me = self.clone();
        let style = cx.bonds();
        let span = cx.span();
        let needed = self.values.iter().any(|v| v.of_force());
        if needed && style.is_none() {
            return fail(Code::INCOMPLETE, span, "energies and forces of bonds need a bond_style");
        }
        let places = self.places(style.as_deref(), span)?;
        let reads = style.as_ref().filter(|_| needed).map_or(Fields::NONE, |s| s.looks_at());
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            X | V | BONDS | MASK | BOX | TAG | MASS | MEMO | KIND | TYPE_MASS | reads,
            move |w, _, out| {
                let p = &w.particles;
                let (index, lengths, masses) = (Index::new(&p.tag), w.periods(), Masses::of(w));
                let mvv2e = w.settings.units.constants().mvv2e;
                out.local_cols = me.values.len();
                out.local.clear();
                for bond in bonds_within(w, me.group) {
                    let [Some(a), Some(b)] = bond.ends.map(|t| index.find(t, &p.tag)) else { continue };
                    let d = apart(w, &lengths, [a, b]);
                    let v = sub(p.v[a], p.v[b]);
                    let now =
                        Stretched { kind: bond.kind as u16, bond, ends: [a, b], d, v, rest: bond.length };
                    let acts = style.as_ref().filter(|_| needed && bond.is_on());
                    let pull = match acts {
                        None => Pull::default(),
                        Some(style) => pull_of(style.as_ref(), w, &now, span)?,
                    };
                    let extra = match acts {
                        Some(style) if !places.is_empty() => style.extra(w, &now),
                        _ => vec![],
                    };
                    let mut extra = places.iter().map(|&k| extra.get(k).copied().unwrap_or(0.0));
                    let row =
                        Row { d, pull, mass: [masses.get(a), masses.get(b)], v: [p.v[a], p.v[b]], mvv2e };
                    out.local.extend(me.values.iter().map(|v| match v {
                        Quantity::Extra(_) => extra.next().unwrap_or(0.0),
                        v => row.get(*v),
                    }));
                }
                Ok(())
            },
        ))
    }
}
