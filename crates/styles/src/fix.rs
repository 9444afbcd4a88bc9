//! What a fix is: a style that reads its line, and what it declares.

use super::{BuildCx, Motion, Pull, SealCx, Shape, Style};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::Args;
use perigrain_plan::{Op, Rule};
use perigrain_world::World;
use std::path::Path;

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
    /// Nothing: it integrates, averages or speaks in runs.
    #[default]
    Idle,
    /// It changes forces in runs, but not here, which the user is told.
    Absent,
    /// It acts at every evaluation of forces.
    Acts,
}

/// A declared fix.
pub trait Fix: Send {
    /// The ops it contributes to a step. Values it offers go to the slot `f_ID`.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>>;

    /// Captures what it must know of the moment it is declared (positions, the present step).
    ///
    /// # Errors
    /// What is missing in the scene.
    fn declare(&self, _w: &mut World) -> Result<()> {
        Ok(())
    }

    /// Forgets what `declare` captured.
    fn remove(&self, _w: &mut World) {}

    /// Which values it offers.
    fn shape(&self) -> Shape {
        Shape::default()
    }

    /// Whether one of its global values (element k, row and column) grows with the scene, as `shape` says of all.
    fn extensive(&self, index: &[usize]) -> bool {
        let shape = self.shape();
        match index.len() {
            0 => shape.scalar_extensive,
            1 => shape.vector_extensive,
            _ => shape.array_extensive,
        }
    }

    /// Whether it moves the particles of its group (two such fixes on one particle draw a warning).
    fn integrates(&self) -> bool {
        false
    }

    /// Whether it counts on the steps going on one by one, so that `reset_timestep` is refused beside it, as in LAMMPS.
    fn counts_steps(&self) -> bool {
        false
    }

    /// Which lengths of the box it changes during a run.
    fn deforms(&self) -> [bool; 3] {
        [false; 3]
    }

    /// What becomes of it in a minimization; as in LAMMPS, only some that change forces act.
    fn minimizing(&self) -> Minimizing {
        Minimizing::Idle
    }

    /// Whether `fix_modify respa` may choose the level of steps in which it adds its force.
    fn has_level(&self) -> bool {
        false
    }

    /// Why it cannot act in steps of several lengths (`run_style respa`), if it cannot.
    fn needs_whole_steps(&self, _w: &World) -> Option<&'static str> {
        None
    }

    /// Whether its scalar is an energy that `fix_modify energy yes` may add to the potential energy.
    fn has_energy(&self) -> bool {
        false
    }

    /// Whether it makes particles during a run.
    fn makes_particles(&self) -> bool {
        false
    }

    /// Stops its rigid bodies, each by itself (`velocity … zero … rigid ID`).
    ///
    /// # Errors
    /// A fix without bodies, or bodies that cannot be.
    fn stop(&self, _w: &mut World, _what: Motion, span: Span) -> Result<()> {
        fail(Code::WRONG_KIND, span, "this fix has no rigid bodies")
    }

    /// The molecule template of which new copies become rigid bodies of this fix.
    fn adopts(&self) -> Option<&str> {
        None
    }

    /// Takes note of particles that another fix has made during a run.
    fn welcome(&self, _w: &mut World) {}

    /// How long the shortest contacts with it last, if it is a wall for grains; `said`: density and diameter in the
    /// deck, for a check that has no particles.
    fn contact_time(&self, _w: &World, _said: Option<(f64, f64)>) -> Option<f64> {
        None
    }

    /// The file it writes during a run.
    fn file(&self) -> Option<&Path> {
        None
    }

    /// How it watches the energy of a run.
    fn guard(&self) -> Option<Rule> {
        None
    }

    /// The acceleration it gives to everyone, in a flat scene or another.
    fn pull(&self, _flat: bool) -> Option<Pull> {
        None
    }

    /// Options of `fix_modify ID …` other than `energy`, which the graph keeps.
    ///
    /// # Errors
    /// Unknown keywords; by default there are none.
    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let span = args.here();
        if args.eat("dynamic/dof") {
            args.flag("dynamic/dof")?;
            let text = "without effect: degrees of freedom are counted anew each time";
            cx.note(Diagnostic::note(Code::NO_EFFECT, span, text));
            return Ok(());
        }
        no_option(args)
    }

    /// A copy, so that a failing `fix_modify` changes nothing.
    fn boxed(&self) -> Box<dyn Fix>;
}

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
            "this fix has no level of steps to choose: its page and that of run_style tell in which it acts"
        }
        _ => {
            let text = format!("this fix has no option `{}`", w.text);
            let d = Diagnostic::error(Code::UNKNOWN_KEYWORD, w.span, text);
            return Err(d.help("fix_modify knows `energy yes|no` and `virial yes|no`").into());
        }
    };
    fail(Code::CONFLICT, w.span, why)
}
