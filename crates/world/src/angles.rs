//! Angles between two bonds, by the ids of three particles: they are kept, counted and written, and exert nothing.

use std::collections::BTreeMap;

/// An angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Angle {
    /// Type from 1.
    pub kind: u16,
    /// The ids of its particles, the one at the corner in the middle.
    pub ends: [u32; 3],
}

/// `angle_style zero` and the values of `angle_coeff`.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct AngleZero {
    /// Whatever stands in `angle_coeff` is taken.
    pub any: bool,
    /// The angle of each type that has one [degrees]; it means nothing.
    pub given: BTreeMap<usize, f64>,
}

/// All angles of a scene.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Angles {
    /// Number of angle types.
    pub types: usize,
    /// The angles, in the order in which they were made.
    pub list: Vec<Angle>,
    /// The style in force.
    pub style: Option<AngleZero>,
}

impl Angles {
    /// Keeps the angles of which all particles are there.
    pub(super) fn keep(&mut self, there: impl Fn(u32) -> bool) {
        self.list.retain(|angle| angle.ends.iter().all(|t| there(*t)));
    }

    /// Bonds between some pairs of ids are gone, and the angles they made.
    pub(super) fn part(&mut self, parted: impl Fn([u32; 2]) -> bool) {
        self.list.retain(|angle| {
            let [a, b, c] = angle.ends;
            !parted([a, b]) && !parted([b, c])
        });
    }

    /// Renames particles; angles of those without a new id are gone.
    pub(super) fn rename(&mut self, new: impl Fn(u32) -> Option<u32>) {
        let renamed = |angle: &Angle| {
            let [a, b, c] = angle.ends.map(&new);
            Some(Angle { ends: [a?, b?, c?], ..*angle })
        };
        self.list = self.list.iter().filter_map(renamed).collect();
    }

    /// The types that have no coefficients although a style is in force.
    pub fn missing(&self) -> Vec<usize> {
        let Some(style) = &self.style else { return vec![] };
        (1..=self.types).filter(|k| !style.given.contains_key(k)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_go_with_their_particles_and_bonds() {
        let list = vec![Angle { kind: 1, ends: [1, 2, 3] }, Angle { kind: 2, ends: [2, 3, 4] }];
        let all = Angles { types: 2, list, ..Angles::default() };
        let mut some = all.clone();
        some.rename(|t| Some(t + 10).filter(|t| *t != 14));
        assert_eq!(some.list, [Angle { kind: 1, ends: [11, 12, 13] }]);
        let mut some = all.clone();
        some.keep(|t| t != 1);
        assert_eq!(some.list, [all.list[1]]);
        let mut some = all.clone();
        // 1 and 3 are no side of the first one.
        some.part(|[a, b]| [a.min(b), a.max(b)] == [1, 3]);
        assert_eq!(some.list.len(), 2);
        some.part(|[a, b]| [a.min(b), a.max(b)] == [2, 3]);
        assert!(some.list.is_empty() && all.missing().is_empty());
        some.style = Some(AngleZero { given: [(2, 90.0)].into(), ..AngleZero::default() });
        assert_eq!(some.missing(), [1]);
    }
}
