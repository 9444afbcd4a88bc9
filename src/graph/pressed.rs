//! The step is compared with what contacts stand as they are pressed: before a run's first step, now and then, and at its end.

use super::seal::Sealer;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_plan::{About, Needs, Op, Stage, Tick, When};
use perigrain_styles::SealCx;
use perigrain_styles::critical::LOOK;
use perigrain_styles::pressed::exceeded;
use perigrain_styles::probe::Probe;
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MOLECULE, OMEGA, RADIUS, TAG,
    TRAVEL, V, VOLUME, X, X0,
};
use perigrain_world::{Constant, RunStyle, World};

/// Equations of motion, and whether they turn particles. Rigid bodies are heavier than their particles, and what is led does not swing.
const MOVING: [(&str, bool); 4] =
    [("nve", false), ("nve/limit", false), ("nve/sphere", true), ("nve/bpm/sphere", true)];

/// Fixes that keep the step within what contacts stand.
const KEEPING: [&str; 2] = ["dt/critical", "dt/guard"];

/// Adds the op that looks, where grains may touch each other or walls.
///
/// # Errors
/// What the pair style lacks.
pub fn seal(s: &mut Sealer) -> Result<()> {
    let graph = s.graph();
    let of = |known: &dyn Fn(&str) -> bool| {
        graph.fixes.iter().filter(|f| known(f.style)).fold(0, |bits, f| bits | f.group.bit())
    };
    let kept = graph.fixes.iter().any(|f| KEEPING.contains(&f.style));
    if kept || !s.world().particles.style.sphere {
        return Ok(());
    }
    let probes = s.probes()?;
    if probes.is_empty() && !graph.fixes.iter().any(|f| f.style.starts_with("wall/")) {
        return Ok(());
    }
    let movers = Movers {
        goes: of(&|style| MOVING.iter().any(|m| m.0 == style)),
        turns: of(&|style| MOVING.contains(&(style, true))),
        held: of(&|style| style == "setforce" || style == "freeze"),
    };
    let timestep = graph.lines.latest("timestep").map(|n| n.span);
    let span = s.span();
    let place = timestep.unwrap_or(span);
    s.add(vec![Box::new(Look { probes, movers, place })], span);
    Ok(())
}

/// The bits of groups.
struct Movers {
    goes: u32,
    turns: u32,
    held: u32,
}

impl Movers {
    /// Whether a particle moves and turns as forces require.
    fn of(&self, mask: u32) -> [bool; 2] {
        [self.goes, self.turns].map(|bits| mask & self.held == 0 && mask & bits != 0)
    }
}

/// Examines contacts.
struct Look {
    probes: Vec<Box<dyn Probe>>,
    movers: Movers,
    /// The line that set the step, or the run.
    place: Span,
}

/// The time between two looks of contacts at their grains.
fn step_of(w: &World, dt: f64) -> f64 {
    match &w.settings.run_style {
        RunStyle::Respa(r) => dt / r.steps(r.pair) as f64,
        _ => dt,
    }
}

impl Look {
    fn problem(&self, w: &World, t: &Tick, limit: f64) -> Diagnostic {
        let dt = step_of(w, t.dt);
        let text = format!(
            "the time step {dt:e} is longer than contacts stand as they are pressed at step {}: {limit:.3e}",
            t.step
        );
        let stable = 0.8 * limit * (t.dt / dt);
        Diagnostic::warning(Code::UNSTABLE, self.place, text)
            .help(
                "beyond 2/ω, ω the largest frequency of grains on their contacts with each other and with walls (less where dashpots \
                 act), they swing ever farther until contacts open: such a run may end well, and is wrong",
            )
            .help(format!("use `timestep {stable:.1e}` or less, or take softer grains"))
            .help("`fix ID all dt/critical 100 0.8` lets the step follow")
    }
}

/// The last examination of pressed contacts, and the step they allow.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pressed {
    /// When.
    step: i64,
    /// The time step then.
    dt: f64,
    /// Whether the warning that it is too long has been given.
    warned: bool,
}

static PRESSED: Constant<Pressed> = Constant::new("contact watch/pressed");

impl Op for Look {
    fn about(&self) -> About {
        let reads = X | V | OMEGA | RADIUS | MASS | KIND | MASK | TAG | VOLUME | X0;
        let lists = BONDS | BOX | COLUMNS | CONTACTS | FAMILIES | LISTS | MOLECULE | TRAVEL;
        let needs = Needs::new().read(reads | lists).write(FACTS);
        let when = When::Every(LOOK).or(When::First).or(When::Last);
        About { when, ..About::new("contact watch", Stage::Output, needs) }
    }

    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let same = w.facts.get(*PRESSED).copied().filter(|p| p.dt == t.dt);
        // An examination takes as long as some 15 steps: a continued run repeats it at its beginning and end only this long after
        // the last.
        let soon = same.is_some_and(|p| (0..LOOK).contains(&(t.step - p.step)));
        let continues = !t.setup || t.unchanged;
        if same.is_some_and(|p| p.warned) || (soon && continues) {
            return Ok(());
        }
        let Self { probes, movers, .. } = self;
        let limit = exceeded(w, probes, |i| movers.of(w.particles.mask[i]), step_of(w, t.dt))?;
        w.facts.insert(*PRESSED, Pressed { step: t.step, dt: t.dt, warned: limit.is_some() });
        if let Some(limit) = limit {
            let problem = self.problem(w, t, limit);
            w.notes.push(problem);
        }
        Ok(())
    }
}
