//! The interface to a program that hosts the session and acts while steps are made (`fix external`, `fix python/invoke`).

use super::World;
use perigrain_base::math::vec3::Vec3;
use std::fmt::Debug;

/// What the program is shown when it is called, and the forces it may change.
pub struct HostCall<'a> {
    /// The present step.
    pub step: i64,
    /// Identities of all particles, in the order in which they stand.
    pub ids: &'a [u32],
    /// Their places [length].
    pub x: &'a [Vec3],
    /// Their forces as the program left them last [force]; what stands here afterwards is added.
    pub f: &'a mut [Vec3],
}

/// Values the program sets besides forces; they hold until it sets others.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HostValues {
    /// The potential energy of its forces [energy].
    pub energy: f64,
    /// Their virial [energy]: xx yy zz xy xz yz.
    pub virial: [f64; 6],
    /// Values of its own.
    pub vector: Vec<f64>,
}

/// Values the program sets for each particle, in the order of the particles; values not set stay as they were.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Each {
    /// Potential energies [energy].
    pub energy: Option<Vec<f64>>,
    /// Virials [energy]: xx yy zz xy xz yz.
    pub virial: Option<Vec<[f64; 6]>>,
}

/// A program that hosts the session, as one fix sees it.
///
/// It is no state of the scene: copies of a scene talk to the same program, and no file holds it.
pub trait Outside: Debug + Send + Sync {
    /// Calls the program's function; `None` where it has given none.
    ///
    /// # Errors
    /// The program's own words on why it failed.
    fn call(&self, call: HostCall<'_>) -> Option<Result<(), String>>;

    /// The present values.
    fn values(&self) -> HostValues;

    /// The per-particle values set since the last call.
    fn each(&self) -> Each {
        Each::default()
    }
}

/// When a function of the program is called within a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Invoked {
    /// After forces have been computed: the virials that are read, in LAMMPS' numbers (1 of all, 4 of each particle).
    PostForce(i32),
    /// After the step.
    EndOfStep,
}

/// A program that hosts the session and has functions that are called by name.
///
/// As [`Outside`] it is no state of the scene.
pub trait Host: Debug + Send + Sync {
    /// Whether there is a function of this name.
    fn has(&self, function: &str) -> bool;

    /// Calls a function, which may change what particles have.
    ///
    /// # Errors
    /// The program's own words on why it failed.
    fn invoke(&self, function: &str, when: Invoked, w: &mut World) -> Result<(), String>;
}
