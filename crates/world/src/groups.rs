//! Named sets of particles, one bit each, and how dynamic ones choose theirs.

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;

use super::region::Variable;
use super::surface::Surface;

/// How many there may be (as LAMMPS): a bit each.
const MOST: usize = 32;

/// Index of a group; its bit in every particle's mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
pub struct GroupId(pub u8);

impl GroupId {
    /// All particles.
    pub const ALL: GroupId = GroupId(0);

    /// The mask bit.
    pub fn bit(self) -> u32 {
        1 << self.0
    }
}

/// The members of a dynamic group, selected again and again during runs.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Dynamic {
    /// Only members of this group.
    pub parent: GroupId,
    /// Only inside this region.
    pub region: Option<String>,
    /// Only where this atom-style variable is not zero.
    pub variable: Option<Variable>,
    /// At steps that are multiples of this, and at the start of a run.
    pub every: i64,
}

/// The names of the groups in use (at most 32, as LAMMPS).
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Groups {
    #[serde(deserialize_with = "one_after_another")]
    names: [Option<String>; MOST],
    #[serde(deserialize_with = "one_after_another")]
    dynamic: [Option<Dynamic>; MOST],
    /// Groups of hybrid particles.
    #[serde(default)]
    surfaces: Vec<(GroupId, Surface)>,
}

/// An array as it is written, read in a loop: serde spells out all 32, once more for each kind of file, which was a tenth of what the
/// compiler made of `out`.
fn one_after_another<'de, T: Deserialize<'de>, D: Deserializer<'de>>(from: D) -> Result<[T; MOST], D::Error> {
    struct Each<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for Each<T> {
        type Value = [T; MOST];

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            write!(f, "an array of length {MOST}")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
            let mut all = Vec::with_capacity(MOST);
            while all.len() < MOST
                && let Some(one) = seq.next_element()?
            {
                all.push(one);
            }
            all.try_into().map_err(|all: Vec<T>| A::Error::invalid_length(all.len(), &self))
        }
    }
    from.deserialize_tuple(MOST, Each(PhantomData))
}

impl Default for Groups {
    fn default() -> Self {
        let mut names = [const { None }; MOST];
        names[0] = Some("all".to_string());
        Self { names, dynamic: [const { None }; MOST], surfaces: vec![] }
    }
}

impl Groups {
    /// Whether `all` is the first one, and groups are made of others that are there.
    pub fn are_sound(&self) -> bool {
        let there = |g: GroupId| self.names.get(usize::from(g.0)).is_some_and(Option::is_some);
        let dynamic = self.dynamic.iter().zip(&self.names).all(|(rule, name)| {
            rule.as_ref().is_none_or(|d| name.is_some() && there(d.parent) && d.every >= 1)
        });
        // The group that a surface was chosen from may be gone.
        let surface =
            |(own, s): &(GroupId, Surface)| there(*own) && s.parent.0 < 32 && s.every.is_none_or(|n| n >= 1);
        self.names[0].as_deref() == Some("all") && dynamic && self.surfaces.iter().all(surface)
    }

    /// The group of this name.
    pub fn find(&self, name: &str) -> Option<GroupId> {
        self.names.iter().position(|n| n.as_deref() == Some(name)).map(|k| GroupId(k as u8))
    }

    /// The group of this name, new if there is none; `None` when all 32 are taken.
    pub fn find_or_add(&mut self, name: &str) -> Option<GroupId> {
        if let Some(g) = self.find(name) {
            return Some(g);
        }
        let k = self.names.iter().position(Option::is_none)?;
        self.names[k] = Some(name.to_string());
        Some(GroupId(k as u8))
    }

    /// Removes a group (its bit must be cleared in the masks by the caller).
    pub fn remove(&mut self, id: GroupId) {
        self.names[id.0 as usize] = None;
        self.dynamic[id.0 as usize] = None;
        self.set_surface(id, None);
    }

    /// Whether particles neither join nor leave the group within a run.
    pub fn is_fixed(&self, id: GroupId) -> bool {
        let again = |(own, surface): &(GroupId, Surface)| *own == id && surface.every.is_some();
        self.dynamic(id).is_none() && !self.surfaces.iter().any(again)
    }

    /// How a dynamic group chooses; nothing for static groups.
    pub fn dynamic(&self, id: GroupId) -> Option<&Dynamic> {
        self.dynamic[id.0 as usize].as_ref()
    }

    /// Makes a group dynamic, or static with `None`.
    pub fn set_dynamic(&mut self, id: GroupId, rule: Option<Dynamic>) {
        self.dynamic[id.0 as usize] = rule;
    }

    /// The groups of hybrid particles in order of definition.
    pub fn surfaces(&self) -> &[(GroupId, Surface)] {
        &self.surfaces
    }

    /// Makes a group one of hybrid particles, or no longer with `None`.
    pub fn set_surface(&mut self, id: GroupId, surface: Option<Surface>) {
        self.surfaces.retain(|(own, _)| *own != id);
        self.surfaces.extend(surface.map(|s| (id, s)));
    }

    /// The dynamic groups in order of definition.
    pub fn dynamics(&self) -> impl Iterator<Item = (GroupId, &Dynamic)> {
        (0..32).zip(&self.dynamic).filter_map(|(k, d)| d.as_ref().map(|d| (GroupId(k), d)))
    }

    /// The name of a dynamic group that uses this region.
    pub fn follower(&self, region: &str) -> Option<&str> {
        let (id, _) = self.dynamics().find(|(_, d)| d.region.as_deref() == Some(region))?;
        Some(self.name(id))
    }

    /// The name of a dynamic group that chooses from the one of this name.
    pub fn child_of(&self, parent: &str) -> Option<&str> {
        let parent = self.find(parent)?;
        let (id, _) = self.dynamics().find(|(_, d)| d.parent == parent)?;
        Some(self.name(id))
    }

    /// The group's name.
    pub fn name(&self, id: GroupId) -> &str {
        self.names[id.0 as usize].as_deref().unwrap_or("?")
    }

    /// All names in use, in order of definition.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().flatten().map(String::as_str)
    }
}
