//! fix python/invoke: calls functions of the host program during steps.

use super::{Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, Tick, When};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::outside::{Host, Invoked};
use perigrain_world::{Constant, World};
use std::sync::Arc;

/// The program that hosts the session, in the facts of a scene, if it has functions that can be called within steps.
pub static HOST: Constant<Arc<dyn Host>> = Constant::new("python/invoke host");

/// The style.
pub struct PythonInvoke;

impl Style for PythonInvoke {
    fn name(&self) -> &'static str {
        "python/invoke"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Calls a function in Python at every step that N divides, where Python hosts the run.",
            text: "It is called neither in the setup of a run, as in LAMMPS, nor in minimizations. The \
                   group decides nothing.\n\n\
                   `lammps(ptr=ptr)` gives the scene as it is in that moment: columns of particles (`extract_atom`, \
                   `numpy.extract_atom`, `gather…`, `scatter…`), the box, settings (`extract_global`), ids; what is \
                   written into columns counts when the function returns. Commands, computes, fixes and variables are \
                   refused there (LAMMPS: undefined), and so is all of it after the function has returned. An exception \
                   ends the run in that step and is raised by the command that ran; nothing is written then. In a \
                   terminal there is no Python: the fix is refused.",
            example: "fix watch all python/invoke 10 end_of_step watch",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Called at multiples of N [steps].
    #[word(name = "N", what = "how many steps lie between two calls of the function", from = 1)]
    every: i64,
    #[word(name = "when")]
    moment: Moment,
    /// The function's name: one of the program's `__main__`, defined by the script or by the command `python`.
    function: At<String>,
}

/// When in a step the function is called.
#[derive(PartialEq, Words)]
#[word(what = "when it is called")]
enum Moment {
    /// After forces have been computed, as `function(ptr, vflag)`, where vflag is 1 in steps whose pressure is read, 4 more where
    /// virials of particles are read; in the order of fixes, so that a `setforce` behind it has the last word.
    #[word("post_force")]
    Forces,
    /// After the step, as `function(ptr)`.
    #[word("end_of_step")]
    End,
}

impl FixStyle for PythonInvoke {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { every, moment, function } = read(args, cx)?;
        let Some(host) = cx.world.facts.get(*HOST).cloned() else {
            let text = "perigrain has no Python inside: `fix python/invoke` works where Python hosts the run";
            let d = Diagnostic::error(Code::NOT_SUPPORTED, cx.span, text);
            return Err(d.help("run the deck from Python, with `perigrain.lammps().file(…)`").into());
        };
        if !cx.checking && !host.has(&function.value) {
            let text = format!("the program has no function `{}`", function.value);
            let d = Diagnostic::error(Code::UNKNOWN_NAME, function.span, text);
            return Err(d.help("define it before, in the script or with `python source here`").into());
        }
        let forces = moment == Moment::Forces;
        Ok(Box::new(Declared { id: cx.id.to_string(), every, forces, function: function.value, host }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    /// Steps between calls.
    every: i64,
    /// Called after the forces, else at the end of the step.
    forces: bool,
    function: String,
    host: Arc<dyn Host>,
}

impl Declared {
    fn call(&self, w: &mut World, t: &Tick) -> Result<()> {
        let flag = i32::from(t.virial) + 4 * i32::from(t.atom_virial);
        let when = if self.forces { Invoked::PostForce(flag) } else { Invoked::EndOfStep };
        self.host.invoke(&self.function, when, w).or_else(|words| {
            let what = format!("the function `{}` of fix python/invoke `{}`", self.function, self.id);
            fail(Code::OUTSIDE, None, format!("{what} failed in step {}: {words}", t.step))
        })
    }
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (own, span) = (self.clone(), cx.span());
        let stage = if self.forces { Stage::PostForce } else { Stage::EndOfStep };
        let name = format!("fix {} python/invoke", self.id);
        let op = StepOp::new(name, stage, Needs::all(), move |w, t| own.call(w, t).map_err(|e| e.at(span)));
        Ok(vec![op.when(When::Every(self.every)).in_setup(false).boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { needs_whole_steps: Some("functions in Python are called in whole steps"), ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    /// Has `push`, which displaces the first particle by the step and fails in step 4.
    #[derive(Debug)]
    struct Program;

    impl Host for Program {
        fn has(&self, function: &str) -> bool {
            function == "push"
        }
        fn invoke(&self, _: &str, when: Invoked, w: &mut World) -> std::result::Result<(), String> {
            w.particles.x[0][0] += w.clock.step as f64;
            w.particles.x[0][1] = if when == Invoked::EndOfStep { 1.0 } else { 2.0 };
            if w.clock.step == 4 { Err("four".into()) } else { Ok(()) }
        }
    }

    #[test]
    fn functions_are_called_where_and_when_they_are_wanted() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        let alone = b.fix(&PythonInvoke, "2 end_of_step push").err().unwrap();
        assert!(alone.to_string().contains("no Python inside"), "{alone}");
        b.world.facts.insert::<Arc<dyn Host>>(*HOST, Arc::new(Program));
        for (words, place) in [("2 end_of_step push", 1.0), ("2 post_force push", 2.0)] {
            let stage = if place == 1.0 { Stage::EndOfStep } else { Stage::PostForce };
            let fix = b.fix(&PythonInvoke, words).unwrap();
            let mut ops = b.seal(&*fix).unwrap();
            assert_eq!(ops[0].about().when, When::Every(2));
            b.world.clock.step = 2;
            b.stage(&mut ops, stage).unwrap();
            assert_eq!(b.world.particles.x[0][1], place);
            b.world.clock.step = 4;
            let failed = b.stage(&mut ops, stage).unwrap_err();
            assert!(failed.to_string().contains("failed in step 4: four"), "{failed}");
        }
        for words in ["", "0 end_of_step push", "1 pre_force push", "1 end_of_step", "1 end_of_step nosuch"] {
            assert!(b.fix(&PythonInvoke, words).is_err(), "{words}");
        }
    }
}
