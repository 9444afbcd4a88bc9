//! `statics`: the declarations sealed for load steps, what may move in them, and the text of their log.

use super::running::Pass;
use super::{Mode, Session};
use crate::graph::Role;
use crate::graph::node::FixNode;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::cformat::general;
use perigrain_base::math::vec3::sub;
use perigrain_bonded::stiffness::Stiffness;
use perigrain_fixes::AtRest;
use perigrain_lang::Command;
use perigrain_peri::families::{Criterion, ForceUnit};
use perigrain_plan::explain;
use perigrain_plan::run::statics::{self, Body, Breaking, Control, Goal, Ledger, Numbers, Scene, Solver};
use perigrain_statics::network::Network;
use perigrain_styles::peri_view::view;
use perigrain_styles::words::{Fraction, Words};
use perigrain_world::{Halt, World};
use std::time::Instant;

/// The words of a `statics` line.
#[derive(Words)]
pub struct Statics {
    /// The number of load steps, over which the clock moves: what depends on time is the load.
    #[word(name = "N", what = "the number of load steps", from = 1)]
    steps: i64,
    /// How far the clock moves in all of them [time]; fix move, walls and variables of `time` follow it.
    #[word(keyword, name = "T", what = "the time of all load steps", positive, shown = "N time steps")]
    time: Option<f64>,
    /// The unbalanced force at the end of a load step, over the larger one of reactions and loads.
    #[word(keyword, name = "E", what = "the tolerance", positive, default = 1e-6)]
    tol: f64,
    /// Which of the bonds stretched beyond their limit break at an equilibrium, before the body is balanced again.
    #[word(keyword, default = Break::One)]
    r#break: Break,
    /// How often the body is balanced in one load step at most, each time with other bonds; where bonds still break then, the line ends out of
    /// balance, with a warning.
    #[word(keyword, name = "M", what = "the most equilibria of a load step", from = 1, default = 10_000)]
    most: i64,
    /// How the load of a load step is found.
    #[word(keyword, default = Controls::Load)]
    control: Controls,
    /// Load steps end where the load (the larger one of the two-norms of reactions and loads) has fallen to this share of its peak.
    #[word(keyword, name = "P", what = "the share of the peak load")]
    until: Option<Fraction>,
    /// Whether a load step in which no balance is found is cut into parts, down to 1/1024.
    #[word(keyword, default = true)]
    adapt: bool,
    /// How equilibria are found.
    #[word(keyword, default = Solvers::Newton)]
    solver: Solvers,
}

/// How the load is found.
#[derive(Words)]
#[word(what = "control of the load")]
enum Controls {
    /// Time moves by T/N in each load step.
    Load,
    /// Time moves, forwards or back, to where the bond stretched most over its limit is at it, and that bond breaks: one load step
    /// for each break, so that loads that fall while a crack grows are followed (snap-back). Paths and loads should be linear in time.
    Damage,
    /// Time moves, forwards or back, to where the bond that opens fastest has opened by S more, so that a body whose bonds soften is followed past
    /// its peak and along a snap-back. Paths and loads should be linear in time.
    Opening {
        /// By how much of its length.
        #[word(name = "S", what = "the opening of a load step", positive)]
        stretch: f64,
    },
}

/// How equilibria are found.
#[derive(Words)]
#[word(what = "solver of equilibria")]
enum Solvers {
    /// Newton's method, its linear systems by conjugate gradients.
    Newton,
    /// Adaptive dynamic relaxation: damped motion, slower, for bodies that give way at once and pieces that nothing holds.
    Adr,
}

/// What breaks at an equilibrium.
#[derive(Words)]
#[word(what = "way of breaking")]
enum Break {
    /// The bond stretched most over its critical stretch, with those that are stretched as much.
    One,
    /// That one and a share of the others, the most stretched first.
    Batch {
        /// The share.
        #[word(name = "F", what = "the share of the others")]
        share: Fraction,
    },
    /// All of them.
    All,
    /// None.
    No,
}

impl Session {
    pub(super) fn statics(&mut self, cmd: &Command) -> Result<()> {
        let line: Statics = self.read_line(cmd)?;
        let breaking = match line.r#break {
            Break::One => Breaking::One,
            Break::Batch { share } => Breaking::Batch(share.0),
            Break::All => Breaking::All,
            Break::No => Breaking::No,
        };
        let control = match line.control {
            Controls::Load => Control::Load,
            Controls::Damage => Control::Damage,
            Controls::Opening { stretch } => Control::Opening(stretch),
        };
        if control == Control::Damage && breaking != Breaking::One {
            let text = "`control damage` breaks one bond after another";
            let d = Diagnostic::error(Code::BAD_VALUE, cmd.span, text);
            return Err(d.help("remove `break`, or write `break one`").into());
        }
        let solver = match line.solver {
            Solvers::Newton => Solver::Newton,
            Solvers::Adr => Solver::Adr,
        };
        if matches!(control, Control::Opening(_)) && solver == Solver::Adr {
            let text = "`control opening` finds time and places together, which relaxation cannot";
            let d = Diagnostic::error(Code::CONFLICT, cmd.span, text);
            return Err(d.help("remove `solver adr`").into());
        }
        let goal = Goal {
            steps: line.steps,
            tol: line.tol,
            breaking,
            most: line.most as usize,
            control,
            until: line.until.map(|share| share.0),
            adapt: line.adapt,
            solver,
        };
        self.steps_left(goal.steps, 1, cmd.span)?;
        self.made = self.made.saturating_add(goal.steps);
        self.thermo_computes();
        self.record(cmd, Role::Run, None, vec![], vec![]);
        self.ready(cmd.span)?;
        self.check_run(cmd.span, false)?;
        self.check_statics(cmd.span)?;
        if self.checking() {
            self.promise_outputs();
            self.unsee(true);
            return Ok(());
        }
        self.print_notes()?;
        if self.world.clock.halt == Halt::All || self.world.settings.timed_out() {
            return Ok(());
        }
        let dt = self.world.clock.dt;
        if let Some(time) = line.time {
            self.world.clock.set_dt(time / goal.steps as f64);
        }
        let outcome = self.load(goal, cmd.span);
        self.world.clock.set_dt(dt);
        outcome
    }

    /// Refuses what load steps cannot be made with, and notes what does nothing in them.
    pub(super) fn check_statics(&mut self, span: Span) -> Result<()> {
        let laws = self.graph.pair.as_ref().map(|node| (node.pair.facts(), node.span));
        if let Some((facts, at)) = laws.filter(|(facts, _)| !facts.balances) {
            let text = format!("`statics` does not find equilibria under pair_style {}", facts.name);
            let d = Diagnostic::error(Code::NOT_SUPPORTED, span, text).label(at, "declared here");
            return Err(d
                .help("it does under the peridynamic styles; `minimize` moves other particles to rest")
                .into());
        }
        if let Some(node) = &self.graph.bond {
            let text = "`statics` does not find equilibria of bonds of a bond_style";
            let d = Diagnostic::error(Code::NOT_SUPPORTED, span, text).label(node.span, "declared here");
            return Err(d
                .help("`calibrate` presses such bodies, `minimize` moves their particles to rest")
                .into());
        }
        let (mut refused, mut idle) = (None, vec![]);
        for f in &self.graph.fixes {
            match f.fix.facts(&self.world).at_rest {
                AtRest::Refused if refused.is_none() => refused = Some((f.style.to_string(), f.span)),
                AtRest::Idle => idle.push((f.style.to_string(), f.span)),
                _ => {}
            }
        }
        if let Some((style, at)) = refused {
            let text = format!("fix {style} cannot act in the load steps of `statics`");
            let d = Diagnostic::error(Code::NOT_SUPPORTED, span, text).label(at, "declared here");
            return Err(d.help("remove it with `unfix` before, and declare it again behind").into());
        }
        for (style, at) in idle {
            let text = format!("fix {style} does nothing in load steps: nothing has a velocity there");
            self.note_once(Diagnostic::note(Code::NO_EFFECT, at, text));
        }
        Ok(())
    }

    fn load(&mut self, goal: Goal, span: Span) -> Result<()> {
        let c = &mut self.world.clock;
        (c.first, c.last, c.halt) = (c.step, c.step.saturating_add(goal.steps), Halt::No);
        (c.start, c.stop) = (c.first, c.last);
        c.began = Some(Instant::now());
        c.begin_moving();
        self.settle_resume(span)?;
        if self.planning() {
            self.plan_of(span, Pass::Statics)?;
            self.world.clock.step += goal.steps;
            self.promise_outputs();
            self.unsee(true);
            return Ok(());
        }
        let mut plan = self.sealed(span, Pass::Statics)?.0;
        self.world.slots.invalidate();
        let (held, led) = self.held();
        (self.world.clock.running, self.world.clock.named_dt) = (true, Some(self.world.clock.dt));
        // Behind the step table, which programs read.
        let mut table = HEAD.to_string();
        let mut note = |made: &Numbers| {
            table.push('\n');
            table += &row(made);
        };
        let (w, watch) = (&mut self.world, self.watch.as_mut());
        let pieces_stand = goal.solver == Solver::Newton;
        let follows = goal.control == Control::Damage;
        let body = move |w: &World| {
            if follows {
                known_limits(w, span)?;
            }
            body(w, (held, led), pieces_stand, span)
        };
        let scene = Scene { springs, ratio };
        let outcome = statics::statics(&mut plan, w, watch, (body, scene), goal, &mut note);
        (self.world.clock.running, self.world.clock.named_dt) = (false, None);
        *self.world.changed &= outcome.is_err();
        self.ran = false;
        let early = outcome.as_ref().is_ok_and(|(o, _)| o.interrupted);
        let saved = if early { self.save_early(&mut plan) } else { Ok(()) };
        let finished = plan.finish(&mut self.world);
        self.notes.append(std::mem::take(&mut self.world.notes));
        let (outcome, all) = outcome.map_err(|e| e.at(span))?;
        saved.and(finished)?;
        self.interrupted |= outcome.interrupted;
        self.print_notes()?;
        self.log_end(&plan, &outcome, Some(&format!("{table}\n{}", block(&all))), self.timer.tables())?;
        if self.options.mode == Mode::Measure {
            self.options.log.line(explain::text(&plan, true).trim_end())?;
        }
        self.plan = Some(plan);
        Ok(())
    }

    /// The components of each particle that do not move freely, and those of them that stand on a path, one bit each.
    pub(super) fn held(&self) -> (Vec<u8>, Vec<u8>) {
        let w = &self.world;
        let (mut free, mut held, mut led) = (vec![0u8; w.n()], vec![0u8; w.n()], vec![0u8; w.n()]);
        let bits = |components: [bool; 3]| (0..3).map(|d| u8::from(components[d]) << d).sum::<u8>();
        for f in &self.graph.fixes {
            let FixNode { group, .. } = f;
            let (frees, holds, leads) = match f.fix.facts(w).at_rest {
                AtRest::Frees => (0b111, 0, 0),
                AtRest::Leads { components, rest } => (if rest { 0b111 } else { 0 }, 0, bits(components)),
                AtRest::Holds(components) => (0, bits(components), 0),
                _ => continue,
            };
            for (i, mask) in w.particles.mask.iter().enumerate() {
                if mask & group.bit() != 0 {
                    free[i] |= frees;
                    held[i] |= holds;
                    led[i] |= leads;
                }
            }
        }
        let all = free.iter().zip(&held).zip(&led).map(|((free, held), led)| !free & 0b111 | held | led);
        (all.collect(), led)
    }
}

/// The body of a scene, of which the components `held` do not move freely and `led` stand on a path.
///
/// # Errors
/// Nothing that moves; pieces that nothing holds, unless they need not stand.
pub(super) fn body(
    w: &World,
    (held, led): (Vec<u8>, Vec<u8>),
    pieces_stand: bool,
    span: Span,
) -> Result<Body> {
    if held.iter().all(|held| held & 0b111 == 0b111) {
        let text = "no particle moves freely in these load steps";
        let d = Diagnostic::error(Code::INCOMPLETE, span, text);
        return Err(d.help("`fix ID GROUP nve` frees the particles of a group, as in a run").into());
    }
    let (network, weight) = (springs(w), weights(w));
    let pieces = network.pieces();
    for d in (0..3).filter(|_| pieces_stand) {
        let mut stands = vec![false; w.n() + 1];
        for (i, piece) in pieces.iter().enumerate() {
            stands[(*piece as usize).min(w.n())] |= held[i] >> d & 1 == 1;
        }
        if let Some(i) = (0..w.n()).find(|i| !stands[(pieces[*i] as usize).min(w.n())]) {
            let members = pieces.iter().filter(|piece| **piece == pieces[i]).count();
            let axis = ["x", "y", "z"][d];
            let text = format!(
                "nothing holds the piece of {members} particles to which particle {} belongs along {axis}",
                w.particles.tag[i]
            );
            let d = Diagnostic::error(Code::INCOMPLETE, span, text);
            return Err(d
                .help("hold some of its particles, as by `fix ID GROUP setforce 0 NULL NULL` or `fix move`, or write `solver adr`")
                .into());
        }
    }
    let size = (0..network.bonds()).map(|k| network.length(k)).filter(|l| *l > 0.0).reduce(f64::min);
    let site = w.particles.volume.iter().copied().filter(|v| *v > 0.0).reduce(f64::min).map(f64::cbrt);
    let size = size.or(site).unwrap_or(1.0);
    // Points do not turn.
    let held = held.iter().map(|held| held | 0b111_000).collect();
    Ok(Body { held, led, weight, network, size })
}

/// What a force column of 1 means for each particle: its volume where forces are densities.
fn weights(w: &World) -> Vec<f64> {
    let densities = w.families.as_ref().is_some_and(|f| f.options.unit == ForceUnit::Density);
    let volume = |i: usize| w.particles.volume.get(i).copied().filter(|v| densities && *v > 0.0);
    (0..w.n()).map(|i| volume(i).unwrap_or(1.0)).collect()
}

/// Refuses criteria whose ratio is known only where bonds may break: damage control follows it.
///
/// # Errors
/// A formula.
fn known_limits(w: &World, span: Span) -> Result<()> {
    let criterion = w.families.as_ref().map(|families| families.options.criterion);
    if criterion != Some(Criterion::Formula) {
        return Ok(());
    }
    let text = "`control damage` does not go with `peri_modify break formula`: a formula is evaluated only where bonds may break";
    let d = Diagnostic::error(Code::CONFLICT, span, text);
    Err(d.help("remove `control damage`, or choose another criterion of `peri_modify break`").into())
}

/// The largest load ratio of bonds.
pub(super) fn ratio(w: &World) -> f64 {
    let Some(families) = w.families.as_ref() else { return 0.0 };
    view(w).map_or(0.0, |view| families.load_ratio(&view))
}

/// The living bonds of families with their stiffnesses as bonds by themselves.
pub(super) fn springs(w: &World) -> Network {
    let (mut ends, mut normal) = (vec![], vec![]);
    if let Some(families) = &*w.families {
        families.each_spring(&w.particles.kind, &w.particles.volume, |pair, k| {
            ends.push(pair);
            normal.push(k);
        });
    }
    let (periods, x) = (w.periods(), &w.particles.x);
    let vector = |[i, j]: [u32; 2]| periods.nearest(sub(x[j as usize], x[i as usize]));
    Network::new(w.n(), &ends, |k| (vector(ends[k]), Stiffness { normal: normal[k], ..Stiffness::default() }))
}

/// The head of the table of load steps.
const HEAD: &str =
    "load step   time          Newton  products  unbalanced  broken  work          released      seconds";

fn row(made: &Numbers) -> String {
    format!(
        "{:<11} {:<13} {:<7} {:<9} {:<11} {:<7} {:<13} {:<13} {}",
        made.step,
        general(made.time, 6),
        made.newton,
        made.products,
        general(made.force, 3),
        made.broken,
        general(made.ledger.work, 6),
        general(made.ledger.released, 6),
        general(made.seconds, 3)
    )
}

/// The results of all load steps.
fn block(all: &Numbers) -> String {
    let Ledger { work, energy, released, relaxed, lost, error } = all.ledger;
    let short = |x: f64| general(x, 8);
    // Laws without memory lose nothing.
    let (rest, lost) = match lost == 0.0 {
        true => ("error", String::new()),
        false => ("lost + error", format!("{} + ", short(lost))),
    };
    format!(
        "Statics:\n  Newton's steps, products with the stiffness = {} {}\n  Bonds broken = {}\n  \
         Work = change of energy + released by bonds + relaxed + {rest} = {} = {} + {} + {} + {lost}{}",
        all.newton,
        all.products,
        all.broken,
        short(work),
        short(energy),
        short(released),
        short(relaxed),
        general(error, 2)
    )
}
