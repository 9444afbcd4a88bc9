//! `bond_style hybrid`: several bond styles, each for its own bond types.

use super::{BONDS, BondForce, BondStyle, Pull, Stretched};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::bond::{Loaded, Standing, Stiffness, Swing};
use perigrain_styles::words::Syntax;
use perigrain_styles::{BuildCx, Doc, Fix, SealCx, Style};
use perigrain_world::World;
use perigrain_world::field::Fields;
use std::collections::BTreeMap;

/// The style.
pub struct Hybrid;

impl Style for Hybrid {
    fn name(&self) -> &'static str {
        "hybrid"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Written(
                "bond_style hybrid STYLE args STYLE args …\nbond_coeff T STYLE|none args",
            ),
            summary: "Different bond styles for different bond types.",
            text: "`bond_coeff T none` leaves the bonds of a type without forces. A later line for the same type replaces the \
                   earlier one. Each sub-style can be named once.",
            example: "units lj\natom_style bond\nregion b block 0 4 0 4 0 4\ncreate_box 1 b bond/types 2 extra/bond/per/atom 2\n\
                      create_atoms 1 single 1 1 1\ncreate_atoms 1 single 2 1 1\nmass 1 1.0\n\
                      create_bonds single/bond 2 1 2\nbond_style hybrid harmonic zero\nbond_coeff 1 zero\n\
                      bond_coeff 2 harmonic 50.0 1.0\nfix 1 all nve\nrun 10",
        }
    }
}

impl BondStyle for Hybrid {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn BondForce>> {
        let known: Vec<&'static str> = BONDS.iter().map(|s| s.name()).filter(|n| *n != "hybrid").collect();
        let mut subs: Vec<Box<dyn BondForce>> = vec![];
        while subs.is_empty() || !args.is_empty() {
            let span = args.here();
            let name = args.choice("sub-style", &known)?;
            if subs.iter().any(|s| s.name() == name) {
                return fail(Code::DUPLICATE_NAME, span, format!("`{name}` is named twice"));
            }
            let Some(style) = BONDS.iter().find(|s| s.name() == name) else { continue };
            let mut own = args.until(|word| known.contains(&word));
            subs.push(style.build(&mut own, cx)?);
            own.finish()?;
        }
        Ok(Box::new(Declared { subs, users: BTreeMap::new() }))
    }
}

#[derive(Clone)]
struct Declared {
    subs: Vec<Box<dyn BondForce>>,
    /// The sub-style of each type; `None` for `none`.
    users: BTreeMap<u16, Option<usize>>,
}

impl Declared {
    fn user(&self, kind: u16) -> Option<&dyn BondForce> {
        self.users.get(&kind).copied().flatten().map(|k| self.subs[k].as_ref())
    }
}

impl BondForce for Declared {
    fn name(&self) -> &'static str {
        "hybrid"
    }

    fn coeff(&mut self, kinds: &[u16], args: &mut Args, cx: &BuildCx) -> Result<()> {
        if args.eat("none") {
            self.users.extend(kinds.iter().map(|&k| (k, None)));
            return Ok(());
        }
        let names: Vec<&'static str> = self.subs.iter().map(|s| s.name()).collect();
        let name = args.choice("sub-style of this hybrid", &names)?;
        let k = names.iter().position(|n| *n == name).unwrap_or(0);
        self.subs[k].coeff(kinds, args, cx)?;
        self.users.extend(kinds.iter().map(|&kind| (kind, Some(k))));
        Ok(())
    }

    fn covers(&self, kind: u16) -> bool {
        self.users.contains_key(&kind)
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let mut ops = vec![];
        for (k, sub) in self.subs.iter().enumerate() {
            let own: Vec<u16> =
                self.users.iter().filter(|(_, u)| **u == Some(k)).map(|(kind, _)| *kind).collect();
            let mut sub = sub.clone();
            sub.restrict(&own);
            ops.append(&mut sub.ops(cx)?);
        }
        Ok(ops)
    }

    fn fixes(&self) -> Vec<(String, Box<dyn Fix>)> {
        self.subs.iter().flat_map(|s| s.fixes()).collect()
    }

    fn looks_at(&self) -> Fields {
        self.subs.iter().fold(Fields::NONE, |all, s| all.and(s.looks_at()))
    }

    fn single(&self, w: &World, bond: &Stretched) -> Option<Pull> {
        match self.users.get(&bond.kind)? {
            None => Some(Pull::default()),
            Some(k) => self.subs[*k].single(w, bond),
        }
    }

    fn stiffness(&self, kind: u16, length: f64, radii: [f64; 2]) -> Option<Stiffness> {
        match self.users.get(&kind)? {
            None => Some(Stiffness::default()),
            Some(k) => self.subs[*k].stiffness(kind, length, radii),
        }
    }

    fn turns(&self, kind: u16) -> bool {
        self.user(kind).is_some_and(|sub| sub.turns(kind))
    }

    fn may_break(&self, kind: u16) -> bool {
        self.user(kind).is_some_and(|sub| sub.may_break(kind))
    }

    fn used(&self, bond: &Loaded) -> Option<f64> {
        self.user(bond.kind)?.used(bond)
    }

    fn swing(&self, bond: &Standing) -> Option<Swing> {
        self.user(bond.kind)?.swing(bond)
    }

    fn tuned(&self, name: &str, kind: u16, factor: f64) -> Option<(Box<dyn BondForce>, f64)> {
        let k = self.users.get(&kind).copied().flatten()?;
        let mut tuned = self.clone();
        let (sub, value) = self.subs[k].tuned(name, kind, factor)?;
        tuned.subs[k] = sub;
        Some((Box::new(tuned), value))
    }

    fn written(&self, kind: u16) -> Option<String> {
        match self.user(kind) {
            Some(sub) => sub.written(kind).map(|text| format!("{} {text}", sub.name())),
            None => self.users.contains_key(&kind).then(|| "none".to_string()),
        }
    }
}
