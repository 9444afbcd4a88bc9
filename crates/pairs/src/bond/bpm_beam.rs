//! bond bpm/beam: cylindrical beams between spheres, with an energy.

mod words;

use super::driver::{Bonded, Driven, ends_of, pull_of};
use super::options::Options;
use super::store_local::Store;
use super::{BondForce, BondStyle, Pull, Stretched, needs_orientations};
use perigrain_base::diag::Result;
use perigrain_bonded::beam::{Coeffs, Potential};
use perigrain_bonded::stiffness::Stiffness;
use perigrain_bonded::weibull;
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::bond::{Loaded, Standing, Swing};
use perigrain_styles::matter::Masses;
use perigrain_styles::words::{Form, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Fix, SealCx, Style};
use perigrain_world::field::{Fields, KIND, MASS, OMEGA, QUAT, RADIUS, TYPE_MASS};
use perigrain_world::{Bond, World};
use std::collections::BTreeMap;
use words::{Line, Radius};

/// The style.
pub struct BpmBeam;

impl Style for BpmBeam {
    fn name(&self) -> &'static str {
        "bpm/beam"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(words::Style::GRAMMAR), Form::headed("bond_coeff T", words::Own::GRAMMAR)] },
            ),
            summary: "Cylindrical beams between spheres whose forces and torques derive from an energy.",
            text: with_store!("bpm_beam/page.md"),
            example: "units si\natom_style bpm/sphere\nlattice sc 0.001\nregion b block 0 3 0 3 0 3\n\
                      create_box 1 b bond/types 1 extra/bond/per/atom 6\ncreate_atoms 1 box\nset group all diameter 0.001 density 2000\n\
                      create_bonds many all all 1 0.0009 0.0011\nspecial_bonds lj 0 1 1 coul 1 1 1\nbond_style bpm/beam\n\
                      bond_coeff 1 1e9 0.2 ratio 0.8 strength 1e7 5e6 damping 0.05\nvelocity all create 1e15 4928\n\
                      fix 1 all nve/bpm/sphere\ntimestep 1e-7\nthermo_style custom step ke ebond bonds\nrun 10",
        }
    }
}

impl BondStyle for BpmBeam {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn BondForce>> {
        needs_orientations(self.name(), cx)?;
        let (options, law) = read::<words::Style>(args, cx)?.options()?;
        Ok(Box::new(Declared { options, law, types: BTreeMap::new() }))
    }
}

#[derive(Clone)]
struct Declared {
    options: Options,
    law: Potential,
    types: BTreeMap<u16, Line>,
}

impl Declared {
    fn any(&self, of: impl Fn(&Line) -> bool) -> bool {
        self.types.values().any(of)
    }
}

impl Driven<4> for Declared {
    type Law = Potential;
    const NAME: &'static str = "bpm/beam";

    fn law(&self) -> Potential {
        self.law
    }
    fn coeffs(&self, kind: u16) -> Option<Coeffs> {
        let unbroken = |line: &Line| Coeffs { strength: [f64::INFINITY; 2], ..line.coeffs };
        self.types.get(&kind).map(|line| if self.options.breaks { line.coeffs } else { unbroken(line) })
    }
    fn measures(&self) -> bool {
        true
    }
    fn damped(&self) -> bool {
        self.any(|line| line.coeffs.damping != [0.0; 4])
    }
    fn store(&self) -> Option<&Store> {
        self.options.store.as_ref()
    }
    fn breaks(&self) -> bool {
        self.options.breaks && self.any(|line| line.coeffs.strength != [f64::INFINITY; 2])
    }
    fn reads(&self) -> Fields {
        let mut fields = Fields::NONE;
        if self.damped() {
            fields = fields.and(RADIUS).and(MASS).and(KIND).and(TYPE_MASS);
        } else if self.any(|line| matches!(line.radius, Radius::Ratio(_))) {
            fields = fields.and(RADIUS);
        }
        fields
    }

    fn own(&self, w: &World, k: &Coeffs, bond: &Bond, ends: [usize; 2]) -> [f64; 4] {
        let Some(line) = self.types.get(&(bond.kind as u16)) else { return [1.0; 4] };
        let radius = match line.radius {
            Radius::Given(r) => r,
            Radius::Ratio(ratio) => ratio * w.particles.radius[ends[0]].min(w.particles.radius[ends[1]]),
        };
        let factor = line.weibull.map_or(1.0, |(m, seed)| weibull::strength(m, seed, bond.ends));
        let (mut mass, mut inertia) = (0.0, 0.0);
        if k.damping != [0.0; 4] {
            let masses = Masses::of(w);
            let ftm2v = w.settings.units.constants().ftm2v;
            let m = ends.map(|e| masses.get(e));
            let i: [f64; 2] = std::array::from_fn(|e| 0.4 * m[e] * w.particles.radius[ends[e]].powi(2));
            mass = m[0] * m[1] / (m[0] + m[1]) / ftm2v;
            inertia = if i[0] + i[1] > 0.0 { i[0] * i[1] / (i[0] + i[1]) / ftm2v } else { 0.0 };
        }
        [radius, factor, mass, inertia]
    }
}

impl BondForce for Declared {
    fn name(&self) -> &'static str {
        "bpm/beam"
    }

    fn coeff(&mut self, kinds: &[u16], args: &mut Args, cx: &BuildCx) -> Result<()> {
        let line = read::<words::Own>(args, cx)?.line(args.name_span())?;
        self.types.extend(kinds.iter().map(|&k| (k, line)));
        Ok(())
    }

    fn covers(&self, kind: u16) -> bool {
        self.types.contains_key(&kind)
    }

    fn restrict(&mut self, kinds: &[u16]) {
        self.types.retain(|k, _| kinds.contains(k));
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        if self.breaks() {
            self.options.check(cx.world(), span)?;
        }
        Ok(vec![Box::new(Bonded::new(self.clone(), span))])
    }

    fn fixes(&self) -> Vec<(String, Box<dyn Fix>)> {
        self.options.fixes()
    }

    fn single(&self, w: &World, bond: &Stretched) -> Option<Pull> {
        pull_of(self, w, bond)
    }

    fn extras(&self) -> &'static [&'static str] {
        &["tension", "shear", "bend", "twist", "load"]
    }

    fn looks_at(&self) -> Fields {
        QUAT | OMEGA | RADIUS
    }

    fn extra(&self, w: &World, bond: &Stretched) -> Vec<f64> {
        let Some(k) = self.coeffs(bond.kind) else { return vec![0.0; 5] };
        let (ends, _) = ends_of(w, bond, true);
        let own = self.own(w, &k, &bond.bond, bond.ends);
        self.law.bears(&k, &own, &ends).to_vec()
    }

    fn stiffness(&self, kind: u16, length: f64, radii: [f64; 2]) -> Option<Stiffness> {
        let line = self.types.get(&kind)?;
        Some(self.law.stiffness(&line.coeffs, line.radius.of(radii), length))
    }

    fn turns(&self, kind: u16) -> bool {
        self.types.contains_key(&kind)
    }

    fn may_break(&self, kind: u16) -> bool {
        self.coeffs(kind).is_some_and(|k| k.strength != [f64::INFINITY; 2])
    }

    fn used(&self, bond: &Loaded) -> Option<f64> {
        let k = self.coeffs(bond.kind).filter(|k| k.strength != [f64::INFINITY; 2])?;
        let line = self.types.get(&bond.kind)?;
        let factor = line.weibull.map_or(1.0, |(m, seed)| weibull::strength(m, seed, bond.ids));
        Some(self.law.share(&k, [line.radius.of(bond.radii), factor], bond.bears))
    }

    fn swing(&self, bond: &Standing) -> Option<Swing> {
        let line = self.types.get(&bond.kind)?;
        let stiffness = self.stiffness(bond.kind, bond.length, bond.radii)?;
        let [m, other] = bond.masses;
        let inertia: [f64; 2] = std::array::from_fn(|e| 0.4 * bond.masses[e] * bond.radii[e].powi(2));
        let reduced = |a: f64, b: f64| if a + b > 0.0 { a * b / (a + b) } else { 0.0 };
        let (mass, inertia) = (reduced(m, other), reduced(inertia[0], inertia[1]));
        let zeta = line.coeffs.damping;
        let critical = |share: f64, k: f64, m: f64| 2.0 * share * (k * m).sqrt();
        let dashpots = Stiffness {
            normal: critical(zeta[0], stiffness.normal, mass),
            shear: critical(zeta[1], stiffness.shear, mass),
            twist: critical(zeta[2], stiffness.twist, inertia),
            bend: critical(zeta[3], stiffness.bend, inertia),
        };
        Some(Swing { stiffness, dashpots })
    }

    fn tunable(&self) -> &'static [&'static str] {
        &["E", "nu", "radius", "strength"]
    }

    fn tuned(&self, name: &str, kind: u16, factor: f64) -> Option<(Box<dyn BondForce>, f64)> {
        let mut tuned = self.clone();
        let line = tuned.types.get_mut(&kind)?;
        let value = match name {
            "E" => &mut line.coeffs.elastic[0],
            "nu" => &mut line.coeffs.elastic[1],
            "radius" => line.radius.number(),
            "strength" => {
                // Both, so that they stay in proportion; what does not break has none to vary.
                line.coeffs.strength[1] *= factor;
                Some(&mut line.coeffs.strength[0]).filter(|s| s.is_finite())?
            }
            _ => return None,
        };
        *value *= factor;
        let value = *value;
        let possible = name != "nu" || (value > -1.0 && value <= 0.5);
        possible.then(|| (Box::new(tuned) as _, value))
    }

    fn written(&self, kind: u16) -> Option<String> {
        self.types.get(&kind).map(Line::written)
    }
}
