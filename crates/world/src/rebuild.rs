//! When neighbour lists were last rebuilt, and the positions then.

use super::share::Tiling;
use super::travel::Seen;

/// The state behind LAMMPS' reneighbouring rule.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Rebuild {
    /// Counts rebuilds since the program began, and what else lists are made anew for (growing radii, broken bonds); they compare
    /// it with the one they were made at.
    pub generation: u64,
    /// Step of the last rebuild.
    pub step: i64,
    /// Positions at the last rebuild [length]; read them by [`World::held`](super::World::held).
    pub held: Vec<[f64; 3]>,
    /// Corners of the box at the last rebuild: lists lose their reach when it changes.
    #[serde(default)]
    pub corners: Option<[[f64; 3]; 2]>,
    /// How it leaned then.
    #[serde(default)]
    pub tilt: [f64; 3],
    /// Particles were where they were created, and `held` is empty.
    pub unmoved: bool,
    /// Rebuilds in the present run, setup not counted.
    pub builds: u64,
    /// Rebuilds in the present run that came at the first step allowed, so perhaps too late.
    pub dangerous: u64,
    /// By how much radii have grown at most since lists were made for them, where something makes them grow [length].
    #[serde(default)]
    pub grown: Option<f64>,
    /// Particles deleted beyond fixed faces that thermo output has not reported.
    #[serde(default)]
    pub lost: u64,
    /// Particles have come or gone in this step: everything is rebuilt.
    pub due: bool,
    /// Pairs, by their ids, that have lost in this step what kept them from touching: in the next one lists are made anew, from the
    /// positions held.
    #[serde(skip)]
    pub freed: Vec<[u32; 2]>,
    /// The generation that differs from the one before in such pairs alone, and these.
    #[serde(skip)]
    pub parted: (u64, Vec<[u32; 2]>),
    /// Counts how often particles have come or gone since the program began.
    pub roster: u64,
    /// Counts how often particles have changed places in storage since the program began.
    #[serde(default)]
    pub places: u64,
    /// What lists of grains are made from.
    #[serde(default)]
    pub kept: Kept,
    /// The tiles that grains stand in.
    #[serde(skip)]
    pub tiling: Tiling,
    /// How far they were from where they were at the last rebuild.
    #[serde(skip)]
    pub seen: Seen,
}

/// Lists of grains outlast rebuilds where all neighbours have gone nearly the same way since they were made.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Kept {
    /// Positions that lists are made from, if not those of the last rebuild; read them by [`World::made`](super::World::made).
    pub x: Vec<[f64; 3]>,
    /// The box that those positions were in: its corners, and how it leaned.
    #[serde(default)]
    pub corners: [[f64; 3]; 2],
    /// See `corners`.
    #[serde(default)]
    pub tilt: [f64; 3],
    /// How many periods each particle has been moved since then to be in the box; empty where none was.
    pub turns: Vec<[i8; 3]>,
    /// Whether lists reach twice as far as one rebuild needs.
    pub ample: bool,
    /// How many rebuilds they have outlasted.
    pub outlasted: u32,
    /// The generations before and after the last rebuild that they outlasted.
    pub last: [u64; 2],
}

impl Kept {
    /// How far lists of grains reach beyond touching [length].
    pub fn reach(&self, skin: f64) -> f64 {
        if self.ample { 2.0 * skin } else { skin }
    }
}

/// The part of the skin that growing particles may use up before lists are made anew for their size.
const GROWTH: f64 = 0.25;

impl Rebuild {
    /// Pairs that were freed in the last step begin a generation of lists.
    pub fn part(&mut self) {
        if !self.freed.is_empty() {
            self.generation += 1;
            self.parted = (self.generation, std::mem::take(&mut self.freed));
        }
    }

    /// If the present lists differ from those of a generation in freed pairs alone: these, by their ids.
    pub fn only_parted(&self, since: u64) -> Option<&[[u32; 2]]> {
        let (generation, pairs) = &self.parted;
        (self.generation == since + 1 && *generation == self.generation).then_some(pairs)
    }

    /// Some radius has grown by this much: lists are made anew, from the positions that are held, before growth has used up
    /// its part of the skin.
    pub fn grow(&mut self, by: f64, skin: f64) {
        let grown = self.grown.unwrap_or(0.0) + by;
        // Both grains of a pair have grown.
        let spent = 2.0 * grown > GROWTH * skin;
        self.generation += u64::from(spent);
        self.grown = Some(if spent { 0.0 } else { grown });
    }

    /// What is left of the skin for displacements.
    pub fn room(&self, skin: f64) -> f64 {
        if self.grown.is_some() { (1.0 - GROWTH) * skin } else { skin }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // A skin of 0.4: lists are made anew when two grains have grown by more than 0.1 together.
    #[test]
    fn growth_uses_up_its_part_of_the_skin() {
        let mut r = Rebuild::default();
        assert_eq!(r.room(0.4), 0.4);
        r.grow(0.0, 0.4);
        assert!((r.room(0.4) - 0.3).abs() < 1e-15);
        r.grow(0.03, 0.4);
        assert_eq!((r.generation, r.grown), (0, Some(0.03)));
        r.grow(0.03, 0.4);
        assert_eq!((r.generation, r.grown), (1, Some(0.0)));
    }
}
