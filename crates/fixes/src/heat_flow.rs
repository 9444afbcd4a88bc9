//! fix heat/flow: integrates temperatures from the heat that flows into particles.

use super::heat::{Mover, enter, leave};
use super::{Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::par;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::matter::{Masses, check_masses, publish, sum};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Grammar, Kind, Part, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::columns::{HEATFLOW, TEMPERATURE};
use perigrain_world::field::{COLUMNS, KIND, MASK, MASS, SLOTS, TYPE_MASS};
use perigrain_world::{GroupId, Numbers, World};

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
            text: "T += Δt (q + s)/(m c_p) at the end of each step, with the heat flow q of contacts in energy/time units and the \
                   `source` s of the particle, if there is one. \
                   Needs `fix ID all property/atom temperature heatflow`. Particles outside the group keep their temperatures, and \
                   conduct heat.\n\n\
                   Scalar (extensive): Σ m c_p T of the group; not in LAMMPS.",
            example: "fix warm all property/atom temperature initial 300\nfix more all property/atom heatflow d_power\n\
                      set group ball d_power 1.5\nfix flow ball heat/flow constant 840 source d_power",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "style")]
    capacity: Capacity,
    /// A property of `fix property/atom`: the heat that comes to each particle besides, negative where it leaves [energy/time]; not in
    /// LAMMPS.
    #[word(keyword, name = "d_NAME", once)]
    source: Option<Power>,
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

/// The heat that comes to each particle besides, and where the line names it.
#[derive(Clone, Copy)]
struct Power(Numbers, Span);

impl Value for Power {
    const KIND: Kind = Kind::Text;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("a property d_NAME")?;
        if let Some(column) = cx.world.columns.custom(&word.text).filter(|_| word.text.starts_with("d_")) {
            return Ok(Self(column, word.span));
        }
        let text = format!("particles have no property `{}`", word.text);
        let d = Diagnostic::error(Code::UNKNOWN_NAME, word.span, text);
        Err(d.help("`fix ID all property/atom d_NAME` gives them one").into())
    }
}

impl FixStyle for HeatFlow {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        let capacity = match line.capacity {
            Capacity::Constant(cp) => vec![cp; cx.world.types],
            Capacity::Type(Each(each)) => each,
        };
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, capacity, source: line.source }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    /// Specific heat by type − 1.
    capacity: Vec<f64>,
    source: Option<Power>,
}

impl Declared {
    /// The columns of temperature and heat flow.
    fn columns(&self, w: &World, span: Span) -> Result<[Numbers; 2]> {
        let columns = &w.columns;
        let (Some(temperature), Some(heat)) = (columns.property(*TEMPERATURE), columns.property(*HEATFLOW))
        else {
            let text = "fix heat/flow needs particles with temperature and heat flow";
            return Err(Diagnostic::error(Code::INCOMPLETE, span, text)
                .help("write `fix ID all property/atom temperature heatflow` before the run")
                .into());
        };
        Ok([temperature, heat])
    }

    /// The column of the source.
    fn source(&self, w: &World) -> Result<Option<Numbers>> {
        let Some(Power(full, span)) = self.source else { return Ok(None) };
        match w.columns.present(full) {
            Some(column) => Ok(Some(column)),
            None => {
                let text = "the property of the source has been removed";
                Err(Diagnostic::error(Code::INCOMPLETE, span, text).into())
            }
        }
    }
}

/// Changes temperatures by the heat of a step.
fn integrate(
    w: &mut World,
    dt: f64,
    bit: u32,
    [temperature, heat]: [Numbers; 2],
    power: Option<Numbers>,
    capacity: &[f64],
) {
    let n = w.n();
    let mut warmth = std::mem::take(w.columns.scalar(temperature, n));
    let (p, masses) = (&w.particles, Masses::of(w));
    let flow = w.columns.get_scalar(heat).unwrap_or_default();
    let power = power.and_then(|key| w.columns.get_scalar(key));
    par::each((&mut warmth[..], flow, &p.mask[..]), |start, (warmth, flow, mask)| {
        for (k, ((warmth, flow), mask)) in warmth.iter_mut().zip(flow).zip(mask).enumerate() {
            if mask & bit != 0 {
                let i = start + k;
                let flow = power.map_or(*flow, |power| flow + power[i]);
                *warmth += dt * flow / (masses.get(i) * capacity[usize::from(p.kind[i]) - 1]);
            }
        }
    });
    *w.columns.scalar(temperature, n) = warmth;
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (capacity, group, span) = (self.capacity.clone(), self.group, cx.span());
        check_masses(cx.world(), span)?;
        let keys = self.columns(cx.world(), span)?;
        let power = self.source(cx.world())?;
        let slot = cx.slot(&format!("f_{}", self.id));
        let mut names = keys.map(|key| key.text()).to_vec();
        names.extend(power.map(|key| key.text()));
        let access = Needs::new()
            .read(COLUMNS | MASS | KIND | MASK | TYPE_MASS)
            .keep(COLUMNS)
            .write(SLOTS)
            .only(&names);
        let op =
            StepOp::new(format!("fix {} heat/flow", self.id), Stage::FinalIntegrate, access, move |w, t| {
                if !t.setup {
                    integrate(w, t.dt, group.bit(), keys, power, &capacity);
                }
                if t.collective {
                    let (p, masses) = (&w.particles, Masses::of(w));
                    let warmth = w.columns.get_scalar(keys[0]).unwrap_or_default();
                    let heat = |i: usize| masses.get(i) * capacity[usize::from(p.kind[i]) - 1] * warmth[i];
                    let [sum] = sum(w, group, |i| [heat(i)]);
                    publish(w, slot, t, sum, &[]);
                }
                Ok(())
            });
        Ok(vec![op.in_setup(true).with_sums().in_every_level().boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, ..Shape::default() }
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
        // Σ m c T of the group: 2 · 4 · 600.
        assert_eq!(b.slot_of("f_f").scalar, 4800.0);
        for words in ["", "constant", "constant 0", "constant -1", "type", "every 2"] {
            assert!(b.fix(&HeatFlow, words).is_err(), "{words}");
        }
        for words in ["constant 4 source d_none", "constant 4 source heatflow", "constant 4 source"] {
            assert!(b.fix(&HeatFlow, words).is_err(), "{words}");
        }
    }

    #[test]
    fn sources_warm() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        b.world.clock.dt = 0.5;
        let own = b.fix(&PropertyAtomFix, "temperature heatflow d_power initial 3").unwrap();
        own.declare(&mut b.world).unwrap();
        b.world.columns.scalar(Key::new("property/atom/f/d_power"), 2)[1] = -32.0;
        let flow = b.fix(&HeatFlow, "constant 4 source d_power").unwrap();
        let mut ops = b.seal(&*flow).unwrap();
        b.stage(&mut ops, Stage::FinalIntegrate).unwrap();
        // ΔT = 0.5 s/(2 · 4) by hand.
        let after = b.world.columns.get_scalar(Key::new("property/atom/f/temperature")).unwrap();
        assert_eq!(after, [3.1875, 1.0]);
        own.remove(&mut b.world);
        assert!(b.seal(&*flow).is_err());
    }
}
