//! The fields of a scene by name: what ops state that they read and write, as sets.

use std::fmt;

/// A set of fields of a [`World`](super::World); each constant of this module is a set of one.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Fields(u64);

/// The fields in the order in which sets name them.
macro_rules! fields {
    ($($(#[$doc:meta])* $name:ident $word:literal;)*) => {
        #[allow(non_camel_case_types, clippy::upper_case_acronyms)]
        enum Place { $($name),* }
        $($(#[$doc])* pub const $name: Fields = Fields(1 << Place::$name as u64);)*
        /// All fields with their names.
        pub const FIELDS: &[(Fields, &str)] = &[$(($name, $word)),*];
    };
}

fields! {
    /// Positions [length]; owned by the particles, as all down to [`DENSITY`].
    X "x";
    /// Velocities [length/time].
    V "v";
    /// Forces (force densities of peridynamic particles in LAMMPS' convention).
    F "f";
    /// Angular velocities [1/time].
    OMEGA "omega";
    /// Torques [force·length].
    TORQUE "torque";
    /// Orientations, unit quaternions.
    QUAT "quat";
    /// Radii [length].
    RADIUS "radius";
    /// Masses of particles, or densities of peridynamic ones.
    MASS "mass";
    /// Types, from 1.
    KIND "type";
    /// Group bits.
    MASK "mask";
    /// How often each particle has crossed periodic faces.
    IMAGE "image";
    /// Volumes of peridynamic particles [length³].
    VOLUME "volume";
    /// Positions at creation [length].
    X0 "x0";
    /// Identities, from 1.
    TAG "id";
    /// Molecule IDs.
    MOLECULE "molecule";
    /// Densities as the deck set them [mass/length³].
    DENSITY "density";
    /// The order of creation while particles stand in the order of space.
    RANK "rank";
    /// Masses of types; owned by `mass`.
    TYPE_MASS "type_mass";
    /// Columns of fixes and computes, each owned by the one that made it.
    COLUMNS "columns";
    /// Small state of fixes, by `kind/ID`.
    MEMO "memo";
    /// What fixes set internal variables to.
    CONTROLS "controls";
    /// Values of computes, fixes and variables.
    SLOTS "slots";
    /// The box.
    BOX "box";
    /// Named volumes and how they move.
    REGIONS "regions";
    /// Bonds between particles by their ids; owned by `bond_style`.
    BONDS "bonds";
    /// Peridynamic bonds; owned by the pair style of solids.
    FAMILIES "families";
    /// What touching grains remember; owned by the pair style of grains.
    CONTACTS "contacts";
    /// What grains touching walls remember; owned by the walls.
    WALL_CONTACTS "wall_contacts";
    /// Energy and virial of the present step.
    TALLY "tally";
    /// When neighbour lists were made anew, and where everybody was then.
    LISTS "lists";
    /// How far particles may have gone in this run [length].
    TRAVEL "travel";
    /// Step, time and step size; whoever acts may read it.
    CLOCK "clock";
    /// Facts that styles leave for each other and for the log.
    FACTS "facts";
}

impl Fields {
    /// No field.
    pub const NONE: Fields = Fields(0);
    /// Every field.
    pub const ALL: Fields = Fields((1 << FIELDS.len()) - 1);

    /// Whether one of these is in it.
    pub const fn has(self, any: Fields) -> bool {
        self.0 & any.0 != 0
    }

    /// Those of both, for constants.
    pub const fn and(self, more: Fields) -> Fields {
        Fields(self.0 | more.0)
    }

    /// What is left without these.
    pub const fn without(self, less: Fields) -> Fields {
        Fields(self.0 & !less.0)
    }

    /// Whether there is none in it.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }
}

impl std::ops::BitOr for Fields {
    type Output = Fields;
    fn bitor(self, more: Fields) -> Fields {
        self.and(more)
    }
}

impl std::ops::BitOrAssign for Fields {
    fn bitor_assign(&mut self, more: Fields) {
        *self = *self | more;
    }
}

impl fmt::Display for Fields {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> =
            FIELDS.iter().filter(|(field, _)| self.has(*field)).map(|(_, name)| *name).collect();
        f.write_str(&names.join(" "))
    }
}

impl fmt::Debug for Fields {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{{{self}}}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_name_their_fields_in_one_order() {
        assert_eq!((F | X | TALLY).to_string(), "x f tally");
        assert!((F | X).has(X | V) && !(F | X).has(V) && (F | X).without(F | X).is_empty());
        assert!(FIELDS.iter().all(|(field, _)| Fields::ALL.has(*field)) && !Fields::NONE.has(Fields::ALL));
    }
}
