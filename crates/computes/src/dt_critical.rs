//! compute dt/critical: the longest stable steps of solids, of grains and of bonded particles.

use super::{Compute, ComputeStyle, swing};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::critical::{self, Estimate};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MOLECULE, OMEGA, RADIUS, TAG,
    TRAVEL, TYPE_MASS, V, VOLUME, X, X0,
};
use perigrain_world::{GroupId, SlotId, World};

/// The style.
pub struct DtCritical;

impl Style for DtCritical {
    fn name(&self) -> &'static str {
        "dt/critical"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "The longest stable time steps of peridynamic solids, of grains in contact and of bonded particles.",
            text: "Global vector of four: 1 the step of the solids, 2 that of the grains, 3 m, the whole number of times the \
                   shorter of the solids' and of grains' and bonds' fits into the longer (at least 1), 4 that of the bonds; scalar: the shortest. \
                   A side that the scene does not have, and grains while nothing touches, have the step `inf`.\n\n\
                   `exact` is the limit of the scene as it is: K is the derivative of the forces at the present positions, with the bonds that \
                   still live, any material, volumes and layout. It is found by Lanczos' method (power iteration that keeps its vectors) and \
                   costs some 50 to 200 force evaluations each time it is read. What holds particles fast makes the true limit longer \
                   still; dashpots make it shorter.\n\n\
                   The grains' step is the least √(m/k) and √(I/k_r) over all that touch, k from the normal and tangential \
                   stiffness of its contacts with others as they are now (Hartmann et al., equation 43). Two free grains \
                   would stand 1.4 times, a held one 2 times that; contacts askew to the axes, strong dashpots and springs of rolling and \
                   twisting may stand less, and the step is never longer than these allow. Contacts with walls count too; those of hybrid \
                   particles count here, with their mass.\n\n\
                   Bonds are those of `bond_style harmonic` and `bpm/*` (but `bpm/peri`: `pd`), with displacements and rotations, \
                   with the stiffnesses that the deck's lines say and directions as they are. `local` bounds ω² by twice the largest eigenvalue \
                   of what holds one particle among its partners; `exact` takes the whole network by Lanczos' method (right to 3·10⁻⁴, some 20 \
                   to 100 products). Dashpots of bonds count: the limit is that of dt² K + 2 dt C ≤ 4 M. Where particles are bonded and touch \
                   others too, both act together: a `safety` of 0.8 and `dem` leave room for that.",
            example: "compute dtc all dt/critical pd silling safety 1.0",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(keyword, default = Estimate::Cfl)]
    pd: Estimate,
    #[word(keyword, default = Grains::Particle)]
    dem: Grains,
    #[word(keyword, default = swing::Estimate::Local)]
    bonds: swing::Estimate,
    /// The part of the limit that all steps are.
    #[word(keyword, name = "S", positive, default = 0.8)]
    safety: f64,
}

/// How the step of the grains is found.
#[derive(PartialEq, Words)]
#[word(what = "estimate of the grains' step")]
enum Grains {
    /// From the contacts of each particle.
    Particle,
    /// Not at all.
    None,
}

impl ComputeStyle for DtCritical {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        if cx.group != GroupId::ALL {
            return fail(Code::BAD_VALUE, cx.span, "compute dt/critical must use the group `all`");
        }
        let Line { pd, dem, bonds, safety } = read(args, cx)?;
        let (id, grains) = (cx.id.to_string(), dem == Grains::Particle);
        Ok(Box::new(Declared { id, how: pd, grains, bonds, safety }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    how: Estimate,
    grains: bool,
    bonds: swing::Estimate,
    safety: f64,
}

impl Compute for Declared {
    fn elements(&self) -> Vec<String> {
        ["solids", "grains", "times", "bonds"].map(String::from).to_vec()
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, vector: 4, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let mut probes = if self.grains { cx.probes()? } else { vec![] };
        let (how, safety, counts, estimate) = (self.how, self.safety, self.grains, self.bonds);
        let (style, span) = (cx.bonds(), cx.span());
        let reads = X
            | V
            | RADIUS
            | MASS
            | TYPE_MASS
            | KIND
            | VOLUME
            | FAMILIES
            | CONTACTS
            | BONDS
            | BOX
            | COLUMNS
            | FACTS
            | TAG
            | LISTS
            | MASK
            | MOLECULE
            | OMEGA
            | TRAVEL
            | X0;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, reads, move |w, _, out| {
            let solids = safety * critical::solids(w, how)?;
            let grains = if counts { safety * critical::grains(w, &mut probes)? } else { f64::INFINITY };
            let bonds = safety * estimate.step(w, style.as_deref(), span)?;
            let others = grains.min(bonds);
            let (short, long) = (solids.min(others), solids.max(others));
            let fits = if long.is_finite() { (long / short).floor().max(1.0) } else { 1.0 };
            out.scalar = short;
            out.vector = vec![solids, grains, fits, bonds];
            Ok(())
        }))
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        if self.grains {
            critical::request_wall_springs(w);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_peri::families::{
        Bounds, Families, FamilyOptions, ForceUnit, PeriView, PmbCoeff, PmbTable,
    };
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn two_bonded_particles() {
        let places = [[0.0; 3], [1.0, 0.0, 0.0]];
        let mut b = Bench::new(AtomStyle { peri: true, ..AtomStyle::default() }, &places);
        b.world.particles.volume = vec![1.0, 3.0].into();
        b.world.particles.mass = vec![2.0, 6.0].into();
        let mut table = PmbTable::new(1);
        table.set(1, 1, PmbCoeff { c: 5.0, horizon: 1.2, s00: 1.0, alpha: 0.0 }).unwrap();
        let p = &b.world.particles;
        let bounds = Bounds { lo: [-10.0; 3], hi: [10.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
        let view = PeriView { x: &p.x, x0: &p.x0, kind: &p.kind, volume: &p.volume, bounds, excluded: None };
        let options = FamilyOptions { unit: ForceUnit::Newton, ..FamilyOptions::new(1.0) };
        // |ξ| = 1 is within half a spacing of the horizon: weight (1.2 + 0.5 − 1)/1 = 0.7.
        b.world.families = Some(Families::build(&view, &table, options).unwrap()).into();
        let value = |b: &mut Bench, words: &str| {
            let c = b.compute(&DtCritical, words).unwrap();
            b.evaluate(&*c).unwrap().vector.clone()
        };
        // k = c w V_i V_j/|ξ| = 10.5; ω² = k (1/2 + 1/6) = 7.
        let exact = value(&mut b, "pd exact safety 1");
        assert!((exact[0] - 2.0 / 7f64.sqrt()).abs() < 1e-6, "{exact:?}"); // differences: 1e-6
        assert_eq!(exact[1..], [f64::INFINITY, 1.0, f64::INFINITY]);
        // ρ = 2; the first particle's sum is 5 · 0.7 · 3 = 10.5.
        let silling = value(&mut b, "pd silling safety 0.5")[0];
        assert!((silling - 0.5 * (4.0 / 10.5f64).sqrt()).abs() < 1e-15, "{silling}");
        // K = π c δ⁴/18, h = 1.
        let bulk = std::f64::consts::PI * 5.0 * 1.2f64.powi(4) / 18.0;
        assert!((value(&mut b, "safety 1")[0] - (2.0 / bulk).sqrt()).abs() < 1e-15);
        for words in ["pd best", "bonds musen", "safety 0", "dem", "n 3"] {
            assert!(b.compute(&DtCritical, words).is_err(), "{words}");
        }
    }
}
