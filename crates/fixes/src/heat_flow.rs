//! fix heat/flow: integrates temperatures from the heat that flows into particles.

use super::heat::{Mover, enter, leave};
use super::{Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::par;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::matter::{Masses, check_masses};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Grammar, Kind, Part, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::columns::{HEATFLOW, TEMPERATURE};
use perigrain_world::field::{COLUMNS, KIND, MASK, MASS, TYPE_MASS};
use perigrain_world::{GroupId, World};

/// The style.
pub struct HeatFlow;

impl Style for HeatFlow {
    fn name(&self) -> &'static str {
        "heat/flow"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Changes the temperature of particles by the heat that flows into them.",
            text: "T += Δt q/(m c_p) at the end of each step, with the heat flow q of contacts in energy/time units. \
                   Needs `fix ID all property/atom temperature heatflow`.",
            example: "fix warm all property/atom temperature heatflow\nset group ball temperature 300\n\
                      fix flow ball heat/flow constant 840",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "style")]
    capacity: Capacity,
}

/// The specific heat of the particles.
#[derive(Words)]
#[word(what = "style")]
enum Capacity {
    /// One specific heat for all [energy/(mass temperature)].
    Constant(
        /// The specific heat.
        #[word(name = "cp", positive)]
        f64,
    ),
    /// One specific heat for each type [energy/(mass temperature)].
    Type(#[word(name = "cp1…cpN")] Each),
}

/// A number for each type.
struct Each(Vec<f64>);

impl Value for Each {
    const KIND: Kind =
        Kind::Words(&Grammar { parts: &[Part::Many(&[Part::number("cp")], 1)], keywords: &[], refused: &[] });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let each = (1..=cx.world.types).map(|k| args.positive(&format!("the specific heat of type {k}")));
        each.collect::<Result<_>>().map(Self)
    }
}

impl FixStyle for HeatFlow {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        let capacity = match line.capacity {
            Capacity::Constant(cp) => vec![cp; cx.world.types],
            Capacity::Type(Each(each)) => each,
        };
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, capacity }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    /// Specific heat by type − 1.
    capacity: Vec<f64>,
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (capacity, bit, span) = (self.capacity.clone(), self.group.bit(), cx.span());
        check_masses(cx.world(), span)?;
        let columns = &cx.world().columns;
        let (Some(temperature), Some(heat)) = (columns.property(*TEMPERATURE), columns.property(*HEATFLOW))
        else {
            let text = "fix heat/flow needs particles with temperature and heat flow";
            return Err(Diagnostic::error(Code::INCOMPLETE, span, text)
                .help("write `fix ID all property/atom temperature heatflow` before the run")
                .into());
        };
        let access = Needs::new()
            .read(COLUMNS | MASS | KIND | MASK | TYPE_MASS)
            .keep(COLUMNS)
            .only(&[temperature.text(), heat.text()]);
        let op =
            StepOp::new(format!("fix {} heat/flow", self.id), Stage::FinalIntegrate, access, move |w, t| {
                let n = w.n();
                let mut warmth = std::mem::take(w.columns.scalar(temperature, n));
                warmth.resize(n, 0.0);
                let (p, masses) = (&w.particles, Masses::of(w));
                let flow = w.columns.get_scalar(heat).unwrap_or_default();
                par::each((&mut warmth[..], flow, &p.mask[..]), |start, (warmth, flow, mask)| {
                    for (k, ((warmth, flow), mask)) in warmth.iter_mut().zip(flow).zip(mask).enumerate() {
                        if mask & bit != 0 {
                            let i = start + k;
                            *warmth += t.dt * flow / (masses.get(i) * capacity[usize::from(p.kind[i]) - 1]);
                        }
                    }
                });
                *w.columns.scalar(temperature, n) = warmth;
                Ok(())
            });
        Ok(vec![op.in_every_level().boxed()])
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        enter(w, &self.id, Mover { bit: self.group.bit(), bonds: false });
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        leave(w, &self.id);
    }
}

#[cfg(test)]
mod tests {
    use super::super::property_atom::PropertyAtomFix;
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::{AtomStyle, Key};

    #[test]
    fn heat_warms() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 3]);
        b.world.clock.dt = 0.5;
        let flow = b.fix(&HeatFlow, "type 4").unwrap();
        assert!(b.seal(&*flow).is_err());
        let own = b.fix(&PropertyAtomFix, "temperature heatflow").unwrap();
        own.declare(&mut b.world).unwrap();
        *b.world.columns.scalar(Key::new("property/atom/f/temperature"), 3) = vec![300.0; 3];
        *b.world.columns.scalar(Key::new("property/atom/f/heatflow"), 3) = vec![16.0, -16.0, 16.0];
        b.world.particles.mask[2] = 0;
        let mut ops = b.seal(&*flow).unwrap();
        b.stage(&mut ops, Stage::FinalIntegrate).unwrap();
        // ΔT = 0.5 · 16/(2 · 4) by hand.
        let after = b.world.columns.get_scalar(Key::new("property/atom/f/temperature")).unwrap();
        assert_eq!(after, [301.0, 299.0, 300.0]);
        for words in ["", "constant", "constant 0", "constant -1", "type", "every 2"] {
            assert!(b.fix(&HeatFlow, words).is_err(), "{words}");
        }
    }
}
