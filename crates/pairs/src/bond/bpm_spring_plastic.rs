//! bond bpm/spring/plastic: such springs that yield.

use super::bpm_spring::Spring;
use super::driver::{Bonded, Driven, pull_of};
use super::options::{Options, Springs};
use super::store_local::Store;
use super::{BondForce, BondStyle, Pull, Stretched};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::cformat::general;
use perigrain_bonded::columns::Columns;
use perigrain_bonded::spring::{Breaking, Yielding, give_way};
use perigrain_bonded::sweep::Body;
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::bond::{Standing, Stiffness, Swing};
use perigrain_styles::words::{Form, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Fix, SealCx, Style};
use perigrain_world::bonds::ascending;
use perigrain_world::{Bond, World};
use std::collections::BTreeMap;

/// The style.
pub struct BpmSpringPlastic;

impl Style for BpmSpringPlastic {
    fn name(&self) -> &'static str {
        "bpm/spring/plastic"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Springs::GRAMMAR), Form::headed("bond_coeff T", Line::GRAMMAR)] },
            ),
            summary: "Damped springs that yield at one strain and break at another.",
            text: with_store!("bpm_spring_plastic.md"),
            example: "units lj\natom_style bond\nlattice sc 1.0\nregion b block 0 4 0 4 0 4\n\
                      create_box 1 b bond/types 1 extra/bond/per/atom 6\ncreate_atoms 1 box\nmass 1 1.0\n\
                      create_bonds many all all 1 0.9 1.1\nspecial_bonds lj 0 1 1 coul 1 1 1\nbond_style bpm/spring/plastic\n\
                      bond_coeff 1 5.0 0.2 0.4 0.02\nvelocity all create 0.1 4928\nfix 1 all nve\nthermo_style custom step ebond bonds\nrun 10",
        }
    }
}

/// The words of `bond_coeff`.
#[derive(Words)]
struct Line {
    #[word(flatten)]
    spring: Spring,
    /// The strain ep at which it yields, from 0 to 1.
    #[word(name = "ep", with = share, kind = Kind::Number)]
    limit: f64,
}

/// A strain at which bonds yield.
fn share(args: &mut Args, _: &BuildCx) -> Result<f64> {
    let span = args.here();
    let limit = args.non_negative("the strain ep at which it yields")?;
    if limit > 1.0 {
        return fail(Code::BAD_VALUE, span, "a bond yields at a strain between 0 and 1");
    }
    Ok(limit)
}

impl BondStyle for BpmSpringPlastic {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn BondForce>> {
        let options = read::<Springs>(args, cx)?.options()?;
        Ok(Box::new(Declared { options, springs: BTreeMap::new() }))
    }
}

#[derive(Clone)]
struct Declared {
    options: Options,
    /// Stiffness, breaking strain, damping and the strain at which they yield by type.
    springs: BTreeMap<u16, ([f64; 3], f64)>,
}

impl BondForce for Declared {
    fn name(&self) -> &'static str {
        "bpm/spring/plastic"
    }

    fn coeff(&mut self, kinds: &[u16], args: &mut Args, cx: &BuildCx) -> Result<()> {
        let Line { spring, limit } = read(args, cx)?;
        let spring = spring.numbers(&self.options)?;
        self.springs.extend(kinds.iter().map(|&k| (k, (spring, limit))));
        Ok(())
    }

    fn covers(&self, kind: u16) -> bool {
        self.springs.contains_key(&kind)
    }

    fn restrict(&mut self, kinds: &[u16]) {
        self.springs.retain(|k, _| kinds.contains(k));
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        self.options.check(cx.world(), span)?;
        Ok(vec![Box::new(Bonded::new(self.clone(), span))])
    }

    fn fixes(&self) -> Vec<(String, Box<dyn Fix>)> {
        self.options.fixes()
    }

    fn single(&self, w: &World, bond: &Stretched) -> Option<Pull> {
        pull_of(self, w, bond)
    }

    fn extras(&self) -> &'static [&'static str] {
        &["b1", "b2"]
    }

    fn extra(&self, w: &World, bond: &Stretched) -> Vec<f64> {
        vec![bond.rest, at_rest(w, &bond.bond)]
    }

    fn may_break(&self, kind: u16) -> bool {
        self.options.breaks && self.springs.contains_key(&kind)
    }

    fn swing(&self, bond: &Standing) -> Option<Swing> {
        let ([k, _, gamma], _) = *self.springs.get(&bond.kind)?;
        let along = |normal: f64| Stiffness { normal, ..Stiffness::default() };
        let stiffness = along(if self.options.normalize { k / bond.length } else { k });
        Some(Swing { stiffness, dashpots: along(gamma) })
    }

    fn written(&self, kind: u16) -> Option<String> {
        let (spring, limit) = self.springs.get(&kind)?;
        let all = [&spring[..], &[*limit]].concat();
        Some(all.iter().map(|a| general(*a, 16)).collect::<Vec<_>>().join(" "))
    }
}

/// The length at rest of a bond now [length].
fn at_rest(w: &World, bond: &Bond) -> f64 {
    w.bonds.memory.get(&ascending(bond.ends)).copied().unwrap_or(bond.length)
}

impl Driven<2> for Declared {
    type Law = Yielding;
    const NAME: &'static str = "bpm/spring/plastic";

    fn law(&self) -> Yielding {
        Yielding(Breaking { smooth: self.options.smooth, normalize: self.options.normalize })
    }
    fn coeffs(&self, kind: u16) -> Option<([f64; 3], f64)> {
        self.springs.get(&kind).copied()
    }
    fn measures(&self) -> bool {
        true
    }
    fn damped(&self) -> bool {
        self.springs.values().any(|([_, _, gamma], _)| *gamma != 0.0)
    }
    fn store(&self) -> Option<&Store> {
        self.options.store.as_ref()
    }
    fn breaks(&self) -> bool {
        self.options.breaks
    }
    fn own(&self, w: &World, _k: &([f64; 3], f64), bond: &Bond, _ends: [usize; 2]) -> [f64; 2] {
        [1.0 / bond.length, at_rest(w, bond)]
    }
    fn prepares(&self) -> bool {
        true
    }
    fn prepare(&self, columns: &mut Columns<2>, body: &Body, _dimension: i32) -> Vec<(usize, f64)> {
        let limit = |kind| self.springs.get(&kind).map_or(f64::INFINITY, |(_, limit)| *limit);
        give_way(columns, body, limit)
    }
}
