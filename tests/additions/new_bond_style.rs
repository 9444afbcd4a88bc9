//! A bond style: springs that are soft at rest and harden with the cube of their stretch.

use super::{refused, run};
use perigrain::diag::Result;
use perigrain::lang::Args;
use perigrain::plan::Op;
use perigrain::styles::bond::driver::{Bonded, Driven, pull_of};
use perigrain::styles::pull::{Pull, Stretched};
use perigrain::styles::words::{Syntax, Words, read};
use perigrain::styles::{BondForce, BondStyle, BuildCx, Doc, SealCx, Style};
use perigrain::world::{Bond, World};
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{length, scale};
use perigrain_bonded::law::{Acts, BondLaw, Ends, Motion};
use perigrain_bonded::sweep::{Out, Sweep, all};
use std::collections::BTreeMap;

struct HardeningStyle;

impl Style for HardeningStyle {
    fn name(&self) -> &'static str {
        "hardening"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Written("bond_style hardening\nbond_coeff T K r0"),
            summary: "Springs that harden.",
            text: "E = K (r − r0)⁴.",
            example: "bond_style hardening",
        }
    }
}

impl BondStyle for HardeningStyle {
    fn build(&self, _args: &mut Args, _cx: &BuildCx) -> Result<Box<dyn BondForce>> {
        Ok(Box::<Springs>::default())
    }
}

/// E = K (r − r0)⁴ with K and r0.
struct Hardening;

impl BondLaw<0> for Hardening {
    type Coeffs = [f64; 2];
    const TURNS: bool = false;

    #[inline(always)]
    fn act<R: Real>(&self, k: &[f64; 2], _: &[R; 0], b: &Ends<R>, _: Option<&Motion<R>>) -> Acts<R> {
        let r = length(b.r);
        let longer = r - k[1];
        let square = longer * longer;
        let per_length = longer * square * (-4.0 * k[0]) / r;
        Acts { force: scale(per_length, b.r), energy: square * square * k[0], ..Acts::none(r.like(0.0)) }
    }

    fn sweep(&self, pass: &Sweep<'_, 0, [f64; 2]>, out: &mut Out) {
        all(self, pass, out);
    }
}

/// The coefficients of each type.
#[derive(Clone, Default)]
struct Springs(BTreeMap<u16, [f64; 2]>);

#[derive(Words)]
struct Coeffs {
    /// K [energy/length⁴].
    #[word(name = "K")]
    k: f64,
    /// The length at rest [length].
    #[word(what = "the length r0")]
    r0: f64,
}

impl Driven<0> for Springs {
    type Law = Hardening;
    const NAME: &'static str = "hardening";

    fn law(&self) -> Hardening {
        Hardening
    }
    fn coeffs(&self, kind: u16) -> Option<[f64; 2]> {
        self.0.get(&kind).copied()
    }
    fn own(&self, _w: &World, _k: &[f64; 2], _bond: &Bond, _ends: [usize; 2]) -> [f64; 0] {
        []
    }
}

impl BondForce for Springs {
    fn name(&self) -> &'static str {
        Self::NAME
    }
    fn coeff(&mut self, kinds: &[u16], args: &mut Args, cx: &BuildCx) -> Result<()> {
        let Coeffs { k, r0 } = read(args, cx)?;
        self.0.extend(kinds.iter().map(|kind| (*kind, [k, r0])));
        Ok(())
    }
    fn covers(&self, kind: u16) -> bool {
        self.0.contains_key(&kind)
    }
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        Ok(vec![Box::new(Bonded::new(self.clone(), cx.span()))])
    }
    fn single(&self, w: &World, bond: &Stretched) -> Option<Pull> {
        pull_of(self, w, bond)
    }
    fn written(&self, kind: u16) -> Option<String> {
        self.0.get(&kind).map(|[k, r0]| format!("{k} {r0}"))
    }
}

#[test]
fn a_bond_style_in_one_file_and_one_line_swings_with_its_period() {
    // μ q̈ = −4 K q³ with μ = ½, from q = A at rest: T = (4/A) √(μ/(2 K)) ∫₀¹ du/√(1 − u⁴).
    let (k, a) = (5.0_f64, 0.3);
    let period = 4.0 / a * (0.25 / k).sqrt() * 1.311_028_777_146_06;
    let deck = format!(
        "units lj\natom_style bond\nregion b block 0 10 0 10 0 10\ncreate_box 1 b bond/types 1 extra/bond/per/atom 2\n\
         create_atoms 1 single 4 5 5\ncreate_atoms 1 single 5.3 5 5\nmass 1 1.0\ncreate_bonds single/bond 1 1 2\n\
         bond_style hardening\nbond_coeff 1 {k} 1.0\nfix move all nve\ntimestep {}\n\
         compute each all bond/local force engpot\ncompute most all reduce max c_each[1] c_each[2] inputs local\n\
         variable q equal x[2]-x[1]-1.0\nthermo_style custom step ebond ke c_most[1] c_most[2]\nrun 1000\n",
        period / 4000.0
    );
    let mut session = run(|tables| tables.bonds.push(&HardeningStyle), &deck);
    // After a quarter of it the bond is at rest length: all energy is that of motion. Steps of T/4000, second order.
    assert!(session.number("v_q").unwrap().abs() < 1e-5 * a);
    session.run_text("on", "run 3000\n").unwrap();
    let q = session.number("v_q").unwrap();
    assert!((q / a - 1.0).abs() < 1e-5, "{q}");
    // One bond alone, at the end: −4 K q³ pulls, K q⁴.
    let [force, energy] = ["c_most[1]", "c_most[2]"].map(|name| session.number(name).unwrap());
    assert!((force / (-4.0 * k * q.powi(3)) - 1.0).abs() < 1e-9, "{force}");
    assert!((energy / (k * q.powi(4)) - 1.0).abs() < 1e-9, "{energy}");
    assert!(refused(&mut session, "bond_coeff 1 5.0\n").contains("r0"));
}
