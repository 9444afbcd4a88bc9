//! What a program that hosts the session does and says while steps are made (`fix external`, `fix python/invoke`).

use super::World;
use perigrain_base::math::vec3::Vec3;
use std::fmt::Debug;

/// What the program is shown when it is called, and the forces it may change.
pub struct Asked<'a> {
    /// The present step.
    pub step: i64,
    /// Identities of all particles, in the order in which they stand.
    pub ids: &'a [u32],
    /// Their places [length].
    pub x: &'a [Vec3],
    /// Their forces as the program left them last [force]; what stands here afterwards is added.
    pub f: &'a mut [Vec3],
}

/// What the program says besides forces; it holds until it says otherwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Told {
    /// The potential energy of its forces [energy].
    pub energy: f64,
    /// Their virial [energy]: xx yy zz xy xz yz.
    pub virial: [f64; 6],
    /// Values of its own.
    pub vector: Vec<f64>,
}

/// What the program says of each particle, in the order in which they stand; what stays unsaid stays as it was.
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
    /// Asks for forces; `None` where the program has given no function that could be called.
    ///
    /// # Errors
    /// The program's own words on why it failed.
    fn call(&self, asked: Asked<'_>) -> Option<Result<(), String>>;

    /// What it says at the moment.
    fn told(&self) -> Told;

    /// What it has said of each particle since this was asked last.
    fn each(&self) -> Each {
        Each::default()
    }
}

/// When a function of the program is called within a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Invoked {
    /// After forces have been computed: which virials somebody reads, in LAMMPS' numbers (1 of all, 4 of each particle).
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
