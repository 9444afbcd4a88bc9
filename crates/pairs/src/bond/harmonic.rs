//! bond harmonic: springs along bonds.

use super::driver::{Bonded, Driven, pull_of};
use super::{BondForce, BondStyle, Pull, Stretched};
use perigrain_base::diag::Result;
use perigrain_base::math::cformat::general;
use perigrain_bonded::spring::Harmonic;
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::bond::Stiffness;
use perigrain_styles::words::{Form, Grammar, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::adapted::Coefficient;
use perigrain_world::field::{Fields, MEMO};
use perigrain_world::{Bond, Numbers, World};
use std::collections::BTreeMap;

/// The style.
pub struct HarmonicStyle;

impl Style for HarmonicStyle {
    fn name(&self) -> &'static str {
        "harmonic"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Grammar::NONE), Form::headed("bond_coeff T", Line::GRAMMAR)] },
            ),
            summary: "Springs along bonds.",
            text: "E = K (r − r0)²: the usual ½ is in K. The force at length r is 2 K (r − r0).",
            example: "units lj\natom_style bond\nregion b block 0 4 0 4 0 4\ncreate_box 1 b bond/types 1 extra/bond/per/atom 2\n\
                      create_atoms 1 single 1 1 1\ncreate_atoms 1 single 2.1 1 1\nmass 1 1.0\n\
                      create_bonds single/bond 1 1 2\nbond_style harmonic\nbond_coeff 1 50.0 1.0\nfix 1 all nve\n\
                      thermo_style custom step ebond\nrun 10",
        }
    }
}

impl BondStyle for HarmonicStyle {
    fn build(&self, _args: &mut Args, _cx: &BuildCx) -> Result<Box<dyn BondForce>> {
        Ok(Box::<Declared>::default())
    }
}

/// The words of `bond_coeff`.
#[derive(Words)]
struct Line {
    /// The stiffness K [energy/length²].
    #[word(name = "K")]
    stiffness: f64,
    /// The length r0 at rest [length].
    #[word(name = "r0", what = "the length r0")]
    rest: f64,
}

/// Stiffness and length at rest by type.
#[derive(Clone, Default)]
struct Declared {
    springs: BTreeMap<u16, Spring>,
}

/// A spring as the deck's line set it.
#[derive(Clone, Copy)]
struct Spring {
    declared: [f64; 2],
    /// Where fixes leave what they have changed.
    keys: [Numbers; 2],
}

impl Spring {
    fn new(kind: u16, declared: [f64; 2]) -> Self {
        let keys = ["k", "r0"].map(|name| {
            let (style, name, types) = ("harmonic".to_string(), name.to_string(), (kind, kind));
            Coefficient { bond: true, style, name, types }.key()
        });
        Self { declared, keys }
    }

    /// As fixes have changed it.
    fn adapted(&self, w: &World) -> [f64; 2] {
        std::array::from_fn(|k| w.adapted(self.keys[k]).unwrap_or(self.declared[k]))
    }
}

/// The springs of a run.
#[derive(Clone)]
struct Adapting {
    /// As the deck's lines set them.
    declared: Declared,
    /// As fixes have changed them.
    adapted: BTreeMap<u16, [f64; 2]>,
}

impl Driven<0> for Adapting {
    type Law = Harmonic;
    const NAME: &'static str = "harmonic";

    fn law(&self) -> Harmonic {
        Harmonic
    }
    fn coeffs(&self, kind: u16) -> Option<[f64; 2]> {
        self.adapted.get(&kind).copied()
    }
    fn own(&self, _w: &World, _k: &[f64; 2], _bond: &Bond, _ends: [usize; 2]) -> [f64; 0] {
        []
    }
    fn reads(&self) -> Fields {
        MEMO
    }
    fn adapts(&self) -> bool {
        true
    }
    fn adapt(&mut self, w: &World) {
        for (now, spring) in self.adapted.values_mut().zip(self.declared.springs.values()) {
            *now = spring.adapted(w);
        }
    }
}

impl BondForce for Declared {
    fn name(&self) -> &'static str {
        "harmonic"
    }

    fn coeff(&mut self, kinds: &[u16], args: &mut Args, cx: &BuildCx) -> Result<()> {
        let Line { stiffness, rest } = read(args, cx)?;
        self.springs.extend(kinds.iter().map(|&k| (k, Spring::new(k, [stiffness, rest]))));
        Ok(())
    }

    fn covers(&self, kind: u16) -> bool {
        self.springs.contains_key(&kind)
    }

    fn restrict(&mut self, kinds: &[u16]) {
        self.springs.retain(|k, _| kinds.contains(k));
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let adapted = self.springs.iter().map(|(kind, s)| (*kind, s.declared)).collect();
        let law = Adapting { declared: self.clone(), adapted };
        Ok(vec![Box::new(Bonded::new(law, cx.span()))])
    }

    fn coefficients(&self) -> &'static [&'static str] {
        &["k", "r0"]
    }

    fn coefficient(&self, name: &str, kind: u16) -> Option<f64> {
        let [k, r0] = self.springs.get(&kind)?.declared;
        Some(if name == "k" { k } else { r0 })
    }

    fn single(&self, w: &World, bond: &Stretched) -> Option<Pull> {
        let now = self.springs.get(&bond.kind)?.adapted(w);
        pull_of(&Adapting { declared: self.clone(), adapted: [(bond.kind, now)].into() }, w, bond)
    }

    fn stiffness(&self, kind: u16, _length: f64, _radii: [f64; 2]) -> Option<Stiffness> {
        let [k, _] = self.springs.get(&kind)?.declared;
        Some(Stiffness { normal: 2.0 * k, ..Stiffness::default() })
    }

    fn tunable(&self) -> &'static [&'static str] {
        &["k"]
    }

    fn tuned(&self, name: &str, kind: u16, factor: f64) -> Option<(Box<dyn BondForce>, f64)> {
        let mut tuned = self.clone();
        let k = tuned.springs.get_mut(&kind).filter(|_| name == "k").map(|s| &mut s.declared[0])?;
        *k *= factor;
        let k = *k;
        Some((Box::new(tuned), k))
    }

    fn written(&self, kind: u16) -> Option<String> {
        self.springs.get(&kind).map(|s| s.declared.map(|a| general(a, 16)).join(" "))
    }
}
