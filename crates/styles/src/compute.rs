//! What a compute is: a style that reads its line, and what it declares.

use super::words::{Each, Given, read};
use super::{BuildCx, Flow, SealCx, Shape, Style};
use dyn_clone::DynClone;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_world::{SlotId, World};

/// A compute style: one file, one line in `COMPUTES`.
pub trait ComputeStyle: Style {
    /// Reads the words after the style's name.
    ///
    /// # Errors
    /// Every mistake in the line.
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>>;
}

/// A declared compute.
pub trait Compute: DynClone + Send {
    /// Which values it offers.
    fn shape(&self) -> Shape;

    /// What the elements of its vector are, in their order, where that has names: files of averages show them.
    fn elements(&self) -> Vec<String> {
        vec![]
    }

    /// The op that fills `slot`; it is run at most once per step, at `stage`, whenever `when` fires.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>>;

    /// Captures what it needs from the scene when it is declared (positions).
    ///
    /// # Errors
    /// What is missing in the scene.
    fn declare(&self, _w: &mut World) -> Result<()> {
        Ok(())
    }

    /// Captures the same for particles made since, when a run begins.
    fn particles_joined(&self, _w: &mut World) {}

    /// Discards what `declare` captured.
    fn remove(&self, _w: &mut World) {}

    /// Whether it captures how the first run begins, even if no output reads it then.
    fn begins(&self) -> bool {
        false
    }

    /// Whether it reads sums that forces add up only in steps where they are requested: energies, stresses. They are requested in
    /// the last step of every run, so that the compute has values until the scene changes.
    fn tallied(&self) -> bool {
        false
    }

    /// The op that takes the present state as a new beginning after a snapshot of a dump (`dump_modify refresh`), for
    /// computes that have one.
    ///
    /// # Errors
    /// As `op`.
    fn refresh(&self, _cx: &mut dyn SealCx, _stage: Stage, _when: &When) -> Result<Option<Box<dyn Op>>> {
        Ok(None)
    }

    /// An option of `compute_modify ID …`. Those of temperatures concern no other compute.
    fn modify(&mut self, option: &Given<TemperatureOption>, cx: &BuildCx) {
        let text = "without effect: only temperatures have degrees of freedom";
        cx.note(Diagnostic::note(Code::NO_EFFECT, option.word.span, text));
    }

    /// What a temperature subtracts from velocities before it uses them, if anything (`Shape::flow`).
    fn flow(&self, _w: &World) -> Option<Flow> {
        None
    }

    /// The temperature whose flow it takes away, where that is not its own.
    fn bias(&self) -> Option<&perigrain_lang::ValueRef> {
        None
    }

    /// Uses another temperature, if it uses one (`thermo_modify temp`).
    fn take_temperature(&mut self, _temperature: &perigrain_lang::ValueRef) {}
}

/// An option of `compute_modify`.
#[derive(Clone, Copy, Debug, perigrain_words::Words)]
#[word(keywords)]
pub enum TemperatureOption {
    /// The number of degrees of freedom that are taken off, for `compute temp` and its like; 3 without it.
    #[word(word = "extra/dof", once)]
    ExtraDof(#[word(name = "N", what = "the number of degrees of freedom")] f64),
    /// The number of degrees of freedom that are taken off, for `compute temp` and its like; 3 without it.
    #[word(once)]
    Extra(#[word(name = "N", what = "the number of degrees of freedom")] f64),
    /// Whether degrees of freedom are counted at each use; they are anyway, but under `-compat lammps`.
    #[word(word = "dynamic/dof", once)]
    DynamicDof(#[word(name = "yes|no", what = "dynamic/dof")] bool),
    /// Whether degrees of freedom are counted at each use; they are anyway, but under `-compat lammps`.
    #[word(once)]
    Dynamic(#[word(name = "yes|no", what = "dynamic/dof")] bool),
}

/// Reads options of `compute_modify` and sets them.
///
/// # Errors
/// Unknown options and values that are none.
pub fn modify(compute: &mut dyn Compute, args: &mut Args, cx: &BuildCx) -> Result<()> {
    let Each(options) = read::<Each<TemperatureOption>>(args, cx)?;
    options.iter().for_each(|option| compute.modify(option, cx));
    Ok(())
}

dyn_clone::clone_trait_object!(Compute);
