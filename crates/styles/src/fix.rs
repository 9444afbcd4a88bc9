//! What a fix is: a style that reads its line, and what it declares.

use super::pair::{Deck, ToCome};
use super::probe::WallProbe;
use super::words::{At, Words, inner};
use super::{BuildCx, Motion, Pull, SealCx, Shape, Style};
use dyn_clone::DynClone;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::Args;
use perigrain_plan::{Op, Rule};
use perigrain_world::World;
use std::path::PathBuf;

/// A fix style: one file, one line in `FIXES`.
pub trait FixStyle: Style {
    /// Reads the words after the style's name.
    ///
    /// # Errors
    /// Every mistake in the line.
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>>;
}

/// What becomes of a fix while `minimize` moves the particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Minimizing {
    /// Nothing: it integrates, averages or writes in runs.
    #[default]
    Idle,
    /// It changes forces in runs, but not here, which a warning states.
    Absent,
    /// It acts at every evaluation of forces.
    Acts,
}

/// What a fix does in load steps of `statics`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AtRest {
    /// It cannot act in them, so that it is refused.
    #[default]
    Refused,
    /// Its particles move freely, as forces require.
    Frees,
    /// It places these components of its particles on a path; the others move freely if another fix or `rest` says so.
    Leads {
        /// The components on the path.
        components: [bool; 3],
        /// Whether the others move freely.
        rest: bool,
    },
    /// It sets these components of the force to 0: they are held.
    Holds([bool; 3]),
    /// Its force depends on places and time alone.
    Acts,
    /// It does nothing there: its force depends on velocities.
    Idle,
}

/// How a fix moves particles, and what becomes of their orientations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Moves {
    /// It moves none.
    #[default]
    None,
    /// As forces require, with orientations that follow spins.
    Turns,
    /// As forces require, while orientations stay: not for ends of bonds that bend and twist.
    Freely,
    /// On a path of its own, without turning them.
    Prescribed,
}

/// What a fix declares about itself.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    /// How it moves the particles of its group (two fixes that move one particle draw a warning).
    pub moves: Moves,
    /// It relies on consecutive steps, so that `reset_timestep` is refused beside it, as in LAMMPS.
    pub counts_steps: bool,
    /// It works in orthogonal boxes alone.
    pub orthogonal: bool,
    /// Which lengths (x, y, z) and tilts (xy, xz, yz) of the box it changes during a run.
    pub deforms: [bool; 6],
    /// What becomes of it in a minimization; as in LAMMPS, only some that change forces act.
    pub minimizing: Minimizing,
    /// What it does in load steps of `statics`.
    pub at_rest: AtRest,
    /// `fix_modify respa` may choose the level of steps in which it adds its force.
    pub has_level: bool,
    /// Why it cannot act in steps of several lengths (`run_style respa`), if it cannot.
    pub needs_whole_steps: Option<&'static str>,
    /// Its scalar is an energy that `fix_modify energy yes` may add to the potential energy.
    pub has_energy: bool,
    /// It is added unless `fix_modify energy no` disables it.
    pub adds_energy: bool,
    /// It makes particles during a run.
    pub makes_particles: bool,
    /// Its ops stand behind those of all other fixes: it takes away forces that these have added.
    pub acts_last: bool,
    /// The molecule templates of which new copies become rigid bodies of this fix.
    pub adopts: Vec<String>,
    /// The file it writes during a run.
    pub file: Option<PathBuf>,
    /// How it watches the energy of a run.
    pub guard: Option<Rule>,
    /// The acceleration it gives to all particles.
    pub pull: Option<Pull>,
    /// It does not act by itself: its acceleration is there for others.
    pub disabled: bool,
}

impl Facts {
    /// Whether it moves particles.
    pub fn integrates(&self) -> bool {
        self.moves != Moves::None
    }
}

/// A declared fix. A failing `fix_modify` changes nothing: it works on a copy.
pub trait Fix: DynClone + Send {
    /// Its declaration, in the present scene.
    fn facts(&self, _w: &World) -> Facts {
        Facts::default()
    }

    /// Which values it offers.
    fn shape(&self) -> Shape {
        Shape::default()
    }

    /// Whether one of its global values (element k, row and column) grows with the scene, as `shape` says of all.
    fn extensive(&self, index: &[usize]) -> bool {
        self.shape().extensive(index)
    }

    /// The ops it contributes to a step. Values it offers go to the slot `f_ID`.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>>;

    /// Captures what it needs from the scene when it is declared (positions, the present step).
    ///
    /// # Errors
    /// What is missing in the scene.
    fn declare(&self, _w: &mut World) -> Result<()> {
        Ok(())
    }

    /// The computes that come and go with it: ID, style, words behind the style.
    fn computes(&self) -> Vec<(String, &'static str, String)> {
        vec![]
    }

    /// Discards what `declare` captured.
    fn remove(&self, _w: &mut World) {}

    /// Takes note of particles that another fix has made during a run.
    fn particles_joined(&self, _w: &mut World) {}

    /// Stops its rigid bodies, each by itself (`velocity … zero … rigid ID`).
    ///
    /// # Errors
    /// A fix without bodies, or bodies that cannot be.
    fn stop(&self, _w: &mut World, _what: Motion, span: Span) -> Result<()> {
        fail(Code::WRONG_KIND, span, "this fix has no rigid bodies")
    }

    /// As a wall for grains, if it is one.
    fn wall(&self) -> Option<&dyn GrainWall> {
        None
    }

    /// The grains it makes during a run, so that the step is known to suit them before they come.
    fn to_come(&self, _w: &World) -> Vec<ToCome> {
        vec![]
    }

    /// Options of `fix_modify ID …` other than `energy`, which the graph keeps.
    ///
    /// # Errors
    /// Unknown keywords; by default there are none.
    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let Counted { dynamic_dof } = options(args, cx)?;
        if let Some(At { span, .. }) = dynamic_dof {
            let text = "without effect: degrees of freedom are counted anew each time";
            cx.note(Diagnostic::note(Code::NO_EFFECT, span, text));
        }
        Ok(())
    }
}

/// A fix that is a wall for grains.
pub trait GrainWall {
    /// The duration of the shortest contacts with it; `deck`: what the deck states about particles that do not exist yet.
    fn contact_time(&self, w: &World, deck: Deck) -> Option<f64>;

    /// A probe of the contacts with it, if it leans on surfaces. The caller's op reads `wall_contacts`.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn probe(&self, cx: &mut dyn SealCx) -> Result<Option<Box<dyn WallProbe>>>;
}

/// What stands before the options of `fix_modify` that belong to a style.
pub const MODIFY: &str = "fix_modify ID";

/// The option of fixes that have no others.
#[derive(perigrain_words::Words)]
pub struct Counted {
    /// Read for LAMMPS' decks, without effect: degrees of freedom are counted anew each time; refused by fixes with options of their
    /// own.
    #[word(keyword = "dynamic/dof", name = "yes|no", what = "dynamic/dof", placed)]
    dynamic_dof: Option<At<bool>>,
}

/// Whether a fix counts in pressures, for fixes that can.
#[derive(perigrain_words::Words)]
pub struct Virial {
    /// Whether what the fix does counts in pressures.
    #[word(keyword, name = "yes|no", what = "virial")]
    pub virial: Option<bool>,
}

/// Reads options of `fix_modify` that a fix has.
///
/// # Errors
/// Options that it does not have.
pub fn options<T: Words>(args: &mut Args, cx: &BuildCx) -> Result<T> {
    if args.peek().is_some_and(|word| !T::GRAMMAR.has(&word.text)) {
        no_option(args)?;
    }
    inner(args, cx)
}

dyn_clone::clone_trait_object!(Fix);

/// The refusal of an option that a fix does not have, with what it would mean.
///
/// # Errors
/// Any word that is left.
pub fn no_option(args: &mut Args) -> Result<()> {
    let Some(w) = args.next() else { return Ok(()) };
    let why = match w.text.as_str() {
        "virial" => "this fix has no virial to add",
        "temp" => "this fix uses no temperature",
        "press" => "this fix uses no pressure",
        "bodyforces" => "this fix moves no rigid bodies",
        "respa" => {
            "this fix has no level of steps to choose: its page and that of run_style state in which it acts"
        }
        _ => {
            let text = format!("this fix has no option `{}`", w.text);
            let d = Diagnostic::error(Code::UNKNOWN_KEYWORD, w.span, text);
            return Err(d.help("fix_modify knows `energy yes|no` and `virial yes|no`").into());
        }
    };
    fail(Code::CONFLICT, w.span, why)
}
