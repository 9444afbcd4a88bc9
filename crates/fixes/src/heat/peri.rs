//! fix heat/peri: heat conduction over the bonds of solids.

use super::conducting::Conducting;
use super::{Mover, enter, leave};
use crate::{AtRest, Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Kind, Syntax, Value, Words, alternatives, one_in, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::columns::{HEATFLOW, PLASTIC_HEAT, TEMPERATURE};
use perigrain_world::field::{COLUMNS, FACTS, FAMILIES, KIND, MASK, MASS, MEMO, SLOTS, VOLUME};
use perigrain_world::{GroupId, Key, Numbers, World};

/// The style.
pub struct HeatPeri;

impl Style for HeatPeri {
    fn name(&self) -> &'static str {
        "heat/peri"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Conducts heat over the bonds of peridynamic solids.",
            text: "ρ c dT/dt = Σ 3 (k/m + k'/m') ω w (T' − T) V' + q over the bonds of a particle, with the conductivity k and the specific \
                   heat c of its `material`, the weighted volume m = Σ ω w |ξ|² V' of its family at birth, and ω of the law (1/|ξ| for \
                   bond-based ones). An even gradient conducts exactly k inside a body; heat is kept to rounding. q is what `heatflow` \
                   says, of contacts between grains for instance, what `fix heat/held`, `heat/flux` and `heat/convect` bring, and \
                   under `pair_style peri/cauchy` the fraction `taylor_quinney` of plastic work. Particles of \
                   the group without bonds do not conduct: `fix heat/flow` serves those.\n\n\
                   Needs `fix ID all property/atom temperature heatflow`, materials with `conductivity` and `heat_capacity`. The stable step of \
                   explicit conduction is mostly far longer than that of motion: it acts every n steps, n being 0.8 of it over the time \
                   step, but at most 100. Where the time step is longer than that, as in `statics`, each step is one of backward \
                   Euler, its linear system solved by conjugate gradients to 1e-10. Temperatures that materials turn into strain are under \
                   [material](material.md).\n\n\
                   Scalar (extensive): the heat of all particles, Σ ρ c V T. Vector of 6: heat that has come from held particles, fluxes, \
                   fluids and, in one number, `heatflow` and flow since the fix was declared (extensive), steps from one action to the next, products of the last \
                   linear system.",
            example: "material glass E 72e9 nu 0.25 rho 2440 conductivity 1 heat_capacity 800\n\
                      pair_coeff * * material glass horizon 3.0001\n\
                      fix prop all property/atom temperature heatflow\nfix warm plate heat/peri",
        }
    }
}

#[derive(Words)]
struct Line {
    /// How many steps it waits from one action to the next; explicit steps longer than 0.8 of the stable one are divided. [steps]
    #[word(keyword, name = "auto|N", default = Every(None), shown = "auto")]
    every: Every,
    /// Backward Euler at each action, explicit steps, or what the time step requires.
    #[word(keyword, name = "yes|no|auto", default = Implicit(None), shown = "auto")]
    implicit: Implicit,
    /// The weight of the end of an implicit step: 1 is backward Euler, 0.5 the rule of Crank and Nicolson, which is of second order and lets
    /// sharp edges ring.
    #[word(keyword, name = "X", what = "theta", default = 1.0)]
    theta: f64,
    /// What a broken bond conducts, over a living one: 0 for a crack that insulates, up to 1.
    #[word(keyword, name = "F", what = "cracks", default = 0.0)]
    cracks: f64,
}

/// Steps from one action to the next; `None`: what is stable.
#[derive(Clone, Copy)]
struct Every(Option<i64>);

impl Value for Every {
    const KIND: Kind = Kind::Text;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        if args.eat("auto") {
            return Ok(Self(None));
        }
        let at = args.here();
        match args.integer(what)? {
            n if n >= 1 => Ok(Self(Some(n))),
            _ => fail(
                Code::BAD_VALUE,
                at,
                "it acts every step at the most: write `every auto`, or N from 1 on",
            ),
        }
    }
}

/// Whether steps are implicit; `None`: where they have to be.
#[derive(Clone, Copy)]
struct Implicit(Option<bool>);

const IMPLICIT: [(&str, Option<bool>); 3] = [("auto", None), ("yes", Some(true)), ("no", Some(false))];

impl Value for Implicit {
    const KIND: Kind = Kind::Choice(&alternatives(&IMPLICIT));
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        one_in("kind of steps", args, &IMPLICIT).map(Self)
    }
}

impl FixStyle for HeatPeri {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let span = args.here();
        let Line { every: Every(every), implicit: Implicit(implicit), theta, cracks } = read(args, cx)?;
        if !(0.5..=1.0).contains(&theta) {
            return fail(
                Code::BAD_VALUE,
                span,
                "theta lies between 0.5 and 1: below, long steps are unstable",
            );
        }
        if !(0.0..=1.0).contains(&cracks) {
            return fail(Code::BAD_VALUE, span, "cracks lies between 0 and 1");
        }
        let (id, group) = (cx.id.to_string(), cx.group);
        Ok(Box::new(Declared { id, group, every, implicit, theta, cracks }))
    }
}

/// A declared fix.
#[derive(Clone)]
pub struct Declared {
    pub id: String,
    pub group: GroupId,
    pub every: Option<i64>,
    pub implicit: Option<bool>,
    pub theta: f64,
    pub cracks: f64,
}

/// Where the fix keeps its state.
#[derive(Clone, Copy)]
pub struct Keys {
    /// Steps and time since it acted last, heat from held particles, fluxes, fluids and `heatflow`, products, and
    /// the heat of all particles, and whether it has acted.
    pub memo: Numbers,
    /// The weighted volume m of each family at birth.
    pub m: Numbers,
    /// What `heatflow` has brought since it acted last.
    pub received: Numbers,
}

/// Numbers of [`Keys::memo`].
pub const NUMBERS: usize = 9;

impl Declared {
    fn keys(&self) -> Keys {
        let key = |end: &str| Key::new(&format!("heat/peri/{}{end}", self.id));
        Keys { memo: key(""), m: key("/m"), received: key("/received") }
    }
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (span, slot, keys) = (cx.span(), cx.slot(&format!("f_{}", self.id)), self.keys());
        let columns = &cx.world().columns;
        let (Some(temperature), Some(flow)) = (columns.property(*TEMPERATURE), columns.property(*HEATFLOW))
        else {
            let text = "fix heat/peri needs particles with temperature and heat flow";
            return Err(Diagnostic::error(Code::INCOMPLETE, span, text)
                .help("write `fix ID all property/atom temperature heatflow` before the run")
                .into());
        };
        let names = [temperature, flow, keys.memo, keys.m, keys.received, *PLASTIC_HEAT].map(Key::text);
        let needs = Needs::new()
            .read(COLUMNS | MASS | KIND | MASK | VOLUME | FAMILIES | FACTS)
            .keep(COLUMNS | MEMO)
            .write(SLOTS | FACTS)
            .only(&names);
        let mut line = self.clone();
        if cx.at_rest() {
            // The temperatures of an equilibrium are those of its load.
            line.every = Some(1);
        }
        let mut conducting = Conducting::new(line, keys, [temperature, flow], (slot, span));
        let name = format!("fix {} heat/peri", self.id);
        let op = StepOp::new(name, Stage::PostIntegrate, needs, move |w, t| conducting.act(w, t));
        Ok(vec![op.in_setup(true).boxed()])
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        let (keys, n) = (self.keys(), w.n());
        w.memo.insert(keys.memo, vec![0.0; NUMBERS]);
        for column in [keys.m, keys.received] {
            w.columns.scalar(column, n).fill(0.0);
        }
        enter(w, &self.id, Mover { bit: self.group.bit(), bonds: true });
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        let keys = self.keys();
        w.memo.remove(keys.memo);
        [keys.m, keys.received].into_iter().for_each(|column| w.columns.remove(column));
        leave(w, &self.id);
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, vector: 6, vector_extensive: true, ..Shape::default() }
    }

    fn extensive(&self, index: &[usize]) -> bool {
        // Steps and products count, whatever the size of the scene.
        index.first().is_none_or(|k| *k <= 4)
    }

    fn facts(&self, _: &World) -> Facts {
        Facts {
            at_rest: AtRest::Acts,
            needs_whole_steps: Some("heat flows in steps of one length"),
            ..Facts::default()
        }
    }
}
