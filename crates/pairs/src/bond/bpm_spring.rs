//! bond bpm/spring: damped springs that break, at rest as they are when a run first meets them.

use super::driver::{Bonded, Driven, pull_of};
use super::options::{Options, Springs};
use super::store_local::Store;
use super::{BondForce, BondStyle, Pull, Stretched};
use perigrain_base::diag::Result;
use perigrain_base::math::cformat::general;
use perigrain_bonded::columns::Columns;
use perigrain_bonded::spring::{self, Breaking};
use perigrain_bonded::sweep::Body;
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::bond::{Loaded, Standing, Stiffness, Swing};
use perigrain_styles::words::{At, Form, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Fix, SealCx, Style};
use perigrain_world::{Bond, World};
use std::collections::BTreeMap;

/// The style.
pub struct BpmSpring;

impl Style for BpmSpring {
    fn name(&self) -> &'static str {
        "bpm/spring"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(FORMS),
            summary: "Damped springs that break at a strain.",
            text: with_store!("bpm_spring.md"),
            example: "units lj\natom_style bond\nlattice sc 1.0\nregion b block 0 4 0 4 0 4\n\
                      create_box 1 b bond/types 1 extra/bond/per/atom 6\ncreate_atoms 1 box\nmass 1 1.0\n\
                      create_bonds many all all 1 0.9 1.1\nspecial_bonds lj 0 1 1 coul 1 1 1\nbond_style bpm/spring\n\
                      bond_coeff 1 5.0 0.1 0.4\nvelocity all create 0.1 4928\nfix 1 all nve\nthermo_style custom step ebond bonds\nrun 10",
        }
    }
}

const FORMS: &[Form] = &[
    Form::behind(Line::GRAMMAR),
    Form::headed("bond_coeff T", Spring::GRAMMAR),
    Form { about: "Under `volume/factor yes`.", ..Form::headed("bond_coeff T", Swelling::GRAMMAR) },
];

/// The words of the style.
#[derive(Words)]
struct Line {
    #[word(flatten)]
    springs: Springs,
    /// Whether forces feel the volume about the ends, which sets Poisson's ratio.
    #[word(keyword = "volume/factor", shown = "no")]
    volume: bool,
}

/// The words of `bond_coeff` for springs that break at a strain.
#[derive(Words)]
pub struct Spring {
    /// The stiffness k [force/length].
    #[word(non_negative)]
    k: f64,
    /// The breaking strain.
    #[word(name = "ec")]
    limit: At<f64>,
    /// The damping gamma [force/velocity].
    #[word(non_negative)]
    gamma: f64,
}

/// The words of `bond_coeff` with the volume.
#[derive(Words)]
struct Swelling {
    #[word(flatten)]
    spring: Spring,
    /// The stiffness av of the volume [force].
    #[word(name = "av")]
    volume: f64,
}

impl Spring {
    /// Stiffness, breaking strain and damping.
    ///
    /// # Errors
    /// A breaking strain that is none.
    pub fn numbers(self, options: &Options) -> Result<[f64; 3]> {
        Ok([self.k, options.limit(self.limit, "the breaking strain")?, self.gamma])
    }
}

impl BondStyle for BpmSpring {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn BondForce>> {
        let Line { springs, volume } = read(args, cx)?;
        Ok(Box::new(Declared { options: springs.options()?, volume, springs: BTreeMap::new() }))
    }
}

#[derive(Clone)]
struct Declared {
    options: Options,
    /// Whether forces feel the volume about the ends.
    volume: bool,
    /// Stiffness, breaking strain, damping and the stiffness of the volume by type.
    springs: BTreeMap<u16, ([f64; 3], f64)>,
}

/// Under `volume/factor yes`.
#[derive(Clone)]
struct Voluminous(Declared);

impl BondForce for Declared {
    fn name(&self) -> &'static str {
        "bpm/spring"
    }

    fn coeff(&mut self, kinds: &[u16], args: &mut Args, cx: &BuildCx) -> Result<()> {
        let (spring, volume) = if self.volume {
            let Swelling { spring, volume } = read(args, cx)?;
            (spring, volume)
        } else {
            (read(args, cx)?, 0.0)
        };
        let spring = spring.numbers(&self.options)?;
        self.springs.extend(kinds.iter().map(|&k| (k, (spring, volume))));
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
        Ok(vec![match self.volume {
            true => Box::new(Bonded::new(Voluminous(self.clone()), span)),
            false => Box::new(Bonded::new(self.clone(), span)),
        }])
    }

    fn fixes(&self) -> Vec<(String, Box<dyn Fix>)> {
        self.options.fixes()
    }

    fn single(&self, w: &World, bond: &Stretched) -> Option<Pull> {
        pull_of(self, w, bond)
    }

    fn extras(&self) -> &'static [&'static str] {
        &["b1"]
    }

    fn extra(&self, _w: &World, bond: &Stretched) -> Vec<f64> {
        vec![bond.rest]
    }

    fn stiffness(&self, kind: u16, length: f64, _radii: [f64; 2]) -> Option<Stiffness> {
        let ([k, ..], _) = *self.springs.get(&kind)?;
        let normal = if self.options.normalize { k / length } else { k };
        Some(Stiffness { normal, ..Stiffness::default() })
    }

    fn may_break(&self, kind: u16) -> bool {
        self.options.breaks && self.springs.contains_key(&kind)
    }

    fn used(&self, bond: &Loaded) -> Option<f64> {
        let ([_, limit, _], _) = *self.springs.get(&bond.kind).filter(|_| self.options.breaks)?;
        let stiffness = self.stiffness(bond.kind, bond.length, bond.radii)?.normal;
        Some(bond.bears[0].abs() / (stiffness * bond.length * limit))
    }

    fn swing(&self, bond: &Standing) -> Option<Swing> {
        let ([_, _, gamma], volume) = *self.springs.get(&bond.kind)?;
        let mut stiffness = self.stiffness(bond.kind, bond.length, bond.radii)?;
        // What the volume adds where the length changes and the volume does not; what the volume does is of the other sign.
        stiffness.normal += volume.max(0.0) / bond.length;
        let dashpots = Stiffness { normal: gamma, ..Stiffness::default() };
        Some(Swing { stiffness, dashpots })
    }

    fn tunable(&self) -> &'static [&'static str] {
        &["k"]
    }

    fn tuned(&self, name: &str, kind: u16, factor: f64) -> Option<(Box<dyn BondForce>, f64)> {
        let mut tuned = self.clone();
        let k = tuned.springs.get_mut(&kind).filter(|_| name == "k").map(|(s, _)| &mut s[0])?;
        *k *= factor;
        let k = *k;
        Some((Box::new(tuned), k))
    }

    fn written(&self, kind: u16) -> Option<String> {
        let (spring, volume) = self.springs.get(&kind)?;
        let all = if self.volume { [&spring[..], &[*volume]].concat() } else { spring.to_vec() };
        Some(all.iter().map(|a| general(*a, 16)).collect::<Vec<_>>().join(" "))
    }
}

impl Driven<1> for Declared {
    type Law = Breaking;
    const NAME: &'static str = "bpm/spring";

    fn law(&self) -> Breaking {
        Breaking { smooth: self.options.smooth, normalize: self.options.normalize }
    }
    fn coeffs(&self, kind: u16) -> Option<[f64; 3]> {
        self.springs.get(&kind).map(|(spring, _)| *spring)
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
    fn own(&self, _w: &World, _k: &[f64; 3], bond: &Bond, _ends: [usize; 2]) -> [f64; 1] {
        [1.0 / bond.length]
    }
}

impl Driven<2> for Voluminous {
    type Law = spring::Voluminous;
    const NAME: &'static str = "bpm/spring";

    fn law(&self) -> spring::Voluminous {
        spring::Voluminous(self.0.law())
    }
    fn coeffs(&self, kind: u16) -> Option<([f64; 3], f64)> {
        self.0.springs.get(&kind).copied()
    }
    fn measures(&self) -> bool {
        true
    }
    fn damped(&self) -> bool {
        self.0.damped()
    }
    fn store(&self) -> Option<&Store> {
        self.0.store()
    }
    fn breaks(&self) -> bool {
        self.0.breaks()
    }
    fn own(&self, _w: &World, _k: &([f64; 3], f64), bond: &Bond, _ends: [usize; 2]) -> [f64; 2] {
        [1.0 / bond.length, 1.0]
    }
    fn prepares(&self) -> bool {
        true
    }
    fn prepare(&self, columns: &mut Columns<2>, body: &Body, dimension: i32) -> Vec<(usize, f64)> {
        spring::swell(columns, body, dimension);
        vec![]
    }
}
