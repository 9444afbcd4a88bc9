//! A run whose energy has grown beyond reason ends: where time steps are too long, it is made from nothing.

use super::seal::Sealer;
use super::thermo::Runaway;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::vec3::{dot, length};
use perigrain_base::par;
use perigrain_output::log::Log;
use perigrain_plan::{About, Needs, Op, Stage, Tick, When};
use perigrain_styles::matter::Masses;
use perigrain_styles::pair::Deck;
use perigrain_styles::probe::Probe;
use perigrain_styles::{Pair, SealCx};
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MOLECULE, OMEGA, RADIUS, TAG,
    TALLY, TRAVEL, TYPE_MASS, V, X, X0,
};
use perigrain_world::{Constant, Fields, RunStyle, World};

/// The ratio to the energy at the beginning of the run from which on the energy is beyond reason: of a scene without external
/// work, or kinetic energy where speeds are beyond reason too.
const GROWN: f64 = 1e6;

/// The same for grains: their energy is known to the last contact, and nothing that a law of contacts makes comes near.
const GROWN_OF_GRAINS: f64 = 100.0;

/// Speeds over those of waves in solids and beds of grains: there neither bonds nor contacts mean anything any more.
const FASTER: f64 = 10.0;

/// The interval in steps at which a run is looked at besides the rows of the step table.
const INTERVAL: i64 = 1000;

/// All energy of a scene of grains as the run began, where nothing does work on it.
static BUDGET: Constant<f64> = Constant::new("energy watch/budget");

/// Fixes that do no work on particles, or take energy alone.
const IDLE: [&str; 22] = [
    "ave/atom",
    "ave/chunk",
    "ave/histo",
    "ave/histo/weight",
    "ave/time",
    "balance",
    "dt/critical",
    "dt/guard",
    "dt/reset",
    "extremes",
    "halt",
    "nve",
    "nve/limit",
    "nve/noforce",
    "nve/sphere",
    "print",
    "property/atom",
    "store/force",
    "store/state",
    "vector",
    "viscous",
    "viscous/sphere",
];

/// The scales of speed and time of the scene.
struct Scales {
    /// The speed of the fastest waves, roughly; across the box in one step where it is unknown.
    waves: f64,
    /// Whether it is that of waves.
    known: bool,
    /// The longest stable step of solids, where all steps are alike.
    step: Option<f64>,
}

/// Adds the op that checks speeds with each row of the step table.
///
/// # Errors
/// What the pair style lacks.
pub fn seal(s: &mut Sealer, rows: &When) -> Result<()> {
    let (graph, lammps) = (s.graph(), s.world().settings.lammps());
    let how = graph.thermo.runaway.unwrap_or(if lammps { Runaway::Warn } else { Runaway::Error });
    let Some(pair) = graph.pair.as_ref().filter(|_| how != Runaway::Ignore) else { return Ok(()) };
    let mut parts = pair.pair.parts();
    parts.push(pair.pair.as_ref());
    let scales = scales(s.world(), &parts);
    let timestep = graph.lines.latest("timestep").map(|n| n.span);
    let when = rows.clone().or(When::Every(INTERVAL));
    // The energies of solids are known, and those of touching grains that do not stick.
    let facts = parts.iter().filter(|p| p.parts().is_empty()).map(|p| p.facts());
    let of = facts.map(|f| (f.true_forces.is_some(), f.elastic_grains)).collect::<Vec<_>>();
    let known = of.iter().all(|(solid, grains)| *solid || *grains);
    let closed = known && graph.bond.is_none() && graph.fixes.iter().all(|f| IDLE.contains(&f.style));
    let (solids, grains) = (of.iter().any(|f| f.0), closed && of.iter().any(|f| f.1));
    let probes = if grains { s.probes()? } else { vec![] };
    if !grains {
        // What a run does that something drives is in no budget.
        s.world().facts.remove(*BUDGET);
    }
    let op = Look {
        how,
        scales,
        closed,
        solids,
        probes,
        timestep,
        when,
        log: s.log.clone(),
        begin: State::default(),
        budget: None,
        reported: false,
    };
    let span = s.span();
    s.add(vec![Box::new(op)], span);
    Ok(())
}

fn scales(w: &World, parts: &[&dyn Pair]) -> Scales {
    let widest = |list: &[f64]| list.iter().copied().fold(0.0, f64::max);
    let (grain, site) = (2.0 * widest(&w.particles.radius), widest(w.volumes()).cbrt());
    let (mut waves, mut step) = (0.0, f64::INFINITY);
    for s in parts.iter().map(|p| p.scales(w, Deck::default())) {
        let solid = s.stable_step.map_or(0.0, |t| site / t);
        let bed = s.contact_time.map_or(0.0, |t| grain / t);
        waves = f64::max(waves, f64::max(solid, bed));
        step = s.stable_step.map_or(step, |t| step.min(t));
    }
    let known = waves > 0.0 && waves.is_finite();
    let across = || w.domain.as_ref().map_or(f64::INFINITY, |d| length(d.lengths()) / w.clock.dt);
    let even = matches!(w.settings.run_style, RunStyle::Verlet);
    Scales {
        waves: if known { FASTER * waves } else { across() },
        known,
        step: Some(step).filter(|t| even && t.is_finite()),
    }
}

/// How particles move.
#[derive(Clone, Copy, Default)]
struct State {
    /// The mean square speed.
    square: f64,
    /// The kinetic energy; not known where it is not needed.
    kinetic: f64,
}

/// Checks speeds.
struct Look {
    how: Runaway,
    scales: Scales,
    /// Whether no external work is done on particles and all energies are known.
    closed: bool,
    /// Whether there are solids: their energy is tallied.
    solids: bool,
    /// Pair styles of grains where the scene is closed.
    probes: Vec<Box<dyn Probe>>,
    /// The line that set the step.
    timestep: Option<Span>,
    when: When,
    log: Log,
    /// As the run began.
    begin: State,
    /// All energy of that time, if it is known.
    budget: Option<f64>,
    reported: bool,
}

impl Look {
    /// How particles move now.
    fn state(&self, w: &World) -> State {
        let (n, v) = (w.n(), &w.particles.v);
        let square = par::sum(n, |i| dot(v[i], v[i])) / n.max(1) as f64;
        if !self.closed {
            return State { square, kinetic: 0.0 };
        }
        let masses = Masses::of(w);
        let half = 0.5 * w.settings.units.constants().mvv2e;
        let straight = par::sum(n, |i| masses.get(i) * dot(v[i], v[i]));
        let turning = if self.probes.is_empty() {
            0.0
        } else {
            let (omega, radius) = (&w.particles.omega, &w.particles.radius);
            par::sum(n, |i| 0.4 * masses.get(i) * radius[i] * radius[i] * dot(omega[i], omega[i]))
        };
        State { square, kinetic: half * (straight + turning) }
    }

    /// All energy at the beginning of a run, if it is known. A closed scene that a run continues unchanged has no more than it
    /// had.
    fn budget(&mut self, w: &mut World, t: &Tick, kinetic: f64) -> Result<Option<f64>> {
        let tallied = !self.solids || w.tally.step == Some(t.step);
        let strain = if self.solids { w.tally.pair.abs() } else { 0.0 };
        if self.probes.is_empty() {
            return Ok(tallied.then_some(kinetic + strain));
        }
        if t.unchanged
            && let Some(budget) = w.facts.get(*BUDGET)
        {
            return Ok(Some(*budget));
        }
        let mut held = 0.0;
        for probe in &mut self.probes {
            held += probe.held(w)?.iter().sum::<f64>();
        }
        if !tallied {
            w.facts.remove(*BUDGET);
            return Ok(None);
        }
        let budget = kinetic + strain + held;
        w.facts.insert(*BUDGET, budget);
        Ok(Some(budget))
    }

    /// What is beyond reason, if something is.
    fn beyond(&self, now: State) -> Option<String> {
        let grown = if self.solids { GROWN } else { GROWN_OF_GRAINS };
        if let Some(budget) = self.budget.filter(|b| *b > 0.0 && now.kinetic > grown * b) {
            let (kinetic, times) = (now.kinetic, now.kinetic / budget);
            return Some(format!(
                "kinetic energy is {kinetic:.3e}, {times:.1e} times all there was when the run began, and nothing does work on \
                 the scene"
            ));
        }
        let fastest = self.scales.waves * self.scales.waves;
        if now.square <= GROWN * self.begin.square || now.square <= fastest {
            return None;
        }
        let (speed, before) = (now.square.sqrt(), self.begin.square.sqrt());
        let times = match self.scales.known {
            true => format!("{:.1e} times as fast as waves", FASTER * speed / self.scales.waves),
            false => format!("{:.1e} times across the box in a step", speed / self.scales.waves),
        };
        Some(format!(
            "particles move at {speed:.1e} in the mean, {times}, and at {before:.1e} when the run began"
        ))
    }

    /// Reports a problem once, as an error where that is wanted.
    fn report(&mut self, problem: Diagnostic) -> Result<()> {
        self.reported = true;
        match self.how {
            Runaway::Error => Err(problem.into()),
            _ => self.log.line(&format!("WARNING: {}", problem.message)),
        }
    }

    fn problem(&self, t: &Tick, why: &str) -> Diagnostic {
        let dt = t.dt;
        let text = format!("energy has grown beyond reason at step {}: {why}", t.step);
        let d = Diagnostic::error(Code::RUNAWAY, None, text);
        let d = match self.timestep {
            Some(span) => d.label(span, "the time step"),
            None => d,
        };
        let d = match self.scales.step {
            Some(limit) if dt > limit => d.help(format!(
                "the time step {dt:.3e} is {:.2} times the longest that is stable, about {limit:.2e}: use `timestep {:.1e}` or \
                 less",
                dt / limit,
                0.8 * limit
            )),
            _ => d
                .help(format!("take a shorter time step than {dt:.3e}: `compute dt/critical` computes the longest stable one"))
                .help("`fix dt/guard` goes back where energy was made, and on in shorter steps"),
        };
        d.help("`thermo_modify energy ignore` lets such runs continue")
    }
}

impl Op for Look {
    fn about(&self) -> About {
        let when = self.when.clone();
        if self.probes.is_empty() {
            let reads = if self.closed { V | MASS | KIND | TYPE_MASS | TALLY } else { V };
            return About { when, ..About::new("energy watch", Stage::Output, Needs::new().read(reads)) };
        }
        // The check that energies are numbers covers every scene that is left to itself.
        let tally = if self.solids || self.closed { TALLY } else { Fields::NONE };
        let reads = X | V | OMEGA | RADIUS | MASS | KIND | TYPE_MASS | MASK | TAG | X0 | tally;
        let lists = BONDS | BOX | COLUMNS | CONTACTS | FAMILIES | LISTS | MOLECULE | TRAVEL;
        let needs = Needs::new().read(reads | lists).write(FACTS);
        About { when, ..About::new("energy watch", Stage::Output, needs) }
    }

    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if self.reported {
            return Ok(());
        }
        // Compared with anything, what is no number is never more: it is looked for by itself.
        if self.closed && w.tally.step == Some(t.step) && (w.tally.pair + w.tally.bond).is_nan() {
            return self.report(no_number(t));
        }
        let now = self.state(w);
        if t.setup {
            self.begin = now;
            if self.closed {
                self.budget = self.budget(w, t, now.kinetic)?;
            }
            return Ok(());
        }
        match self.beyond(now) {
            Some(why) => self.report(self.problem(t, &why)),
            None => Ok(()),
        }
    }
}

/// The error of a potential energy that is none.
fn no_number(t: &Tick) -> Diagnostic {
    let text = format!("the potential energy at step {} is no number", t.step);
    let d = Diagnostic::error(Code::NOT_FINITE, None, text);
    d.help("a coefficient, or a number of the file that the scene was read from, is beyond reason")
}
