//! Levels of nested steps: the level of the present step, and the level in which an op acts.

use perigrain_world::{Vectors, World};
use std::sync::Arc;

/// The level of a step among several (`run_style respa`, `run_style staggered`): each step of a level holds some of the level
/// below.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// The level, from 0: the one of the shortest steps.
    pub level: usize,
    /// How many levels there are; 1: the step has one length.
    pub levels: usize,
    /// Of two levels: the particles that move in the short steps, and only there; `None`: all particles move in the shortest
    /// steps.
    pub solids: Option<Arc<Solids>>,
    /// The columns of the step's paths and mean spins, each over its length, if it holds shorter steps and an op keeps contact
    /// history.
    pub path: [Option<Vectors>; 2],
}

impl Default for Phase {
    fn default() -> Self {
        Self { level: 0, levels: 1, solids: None, path: [None; 2] }
    }
}

impl Phase {
    /// Whether this is the level of the longest steps.
    pub fn outermost(&self) -> bool {
        self.level + 1 == self.levels
    }

    /// Whether all particles move in the shortest of several levels.
    pub fn nested(&self) -> bool {
        self.levels > 1 && self.solids.is_none()
    }

    /// Velocities and spins as contacts see them. Springs grow by the displacement since they were evaluated last: in a step that
    /// holds shorter ones that is the path of the step, not its length times the velocity at its end.
    pub fn motion<'a>(&self, w: &'a World) -> [&'a [[f64; 3]]; 2] {
        let (p, n) = (&w.particles, w.n());
        let mean = |key: Option<Vectors>| w.columns.get_vector(key?).filter(|c| c.len() == n);
        let [path, spin] = self.path;
        [mean(path).unwrap_or(&p.v), mean(spin).unwrap_or(&p.omega)]
    }
}

/// The particles that move in short steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solids {
    /// Whether particles of a type (from 1) belong to peridynamic solids.
    pub kinds: Vec<bool>,
    /// Group bits of particles that drift in the long step as well (the scheme printed by Hartmann et al.).
    pub twice: u32,
}

impl Solids {
    /// Whether a type is a solid's.
    #[inline]
    pub fn has(&self, kind: u16) -> bool {
        self.kinds.get(usize::from(kind).wrapping_sub(1)).copied().unwrap_or(false)
    }
}

/// The level in which an op acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// In the longest ones.
    Outermost,
    /// In this one, from 0, or in the outermost if there are fewer.
    At(usize),
    /// In all: ops that move particles, and ops that take components of forces away.
    Every,
}

impl Level {
    /// The level in a user's words, of `levels`.
    pub fn describe(self, levels: usize) -> String {
        match self {
            Level::Outermost => format!("level {levels}"),
            Level::At(k) => format!("level {}", (k + 1).min(levels)),
            Level::Every => "every level".to_string(),
        }
    }

    /// Whether an op of this level acts in that phase.
    pub fn acts(self, phase: &Phase) -> bool {
        match self {
            Level::Outermost => phase.outermost(),
            Level::At(k) => k.min(phase.levels - 1) == phase.level,
            Level::Every => true,
        }
    }
}
