//! The fields of a scene by name: what ops state that they read and write, as sets.

use super::moving::Under;
use std::fmt;

/// A set of fields of a [`World`](super::World); each constant of this module is a set of one.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Fields(u64);

/// The fields in the order in which sets name them, each with what becomes of it where particles are moved as one piece.
macro_rules! fields {
    ($($(#[$doc:meta])* $name:ident $word:literal $under:ident;)*) => {
        #[allow(non_camel_case_types, clippy::upper_case_acronyms)]
        enum Place { $($name),* }
        $($(#[$doc])* pub const $name: Fields = Fields(1 << Place::$name as u64);)*
        /// All fields with their names.
        pub const FIELDS: &[(Fields, &str)] = &[$(($name, $word)),*];
        /// All fields with what becomes of each where particles are moved as one piece.
        pub const UNDER: &[(Fields, Under)] = &[$(($name, Under::$under)),*];
    };
}

fields! {
    /// Positions [length]; owned by the particles, as all down to [`DENSITY`].
    X "x" Place;
    /// Velocities [length/time].
    V "v" Motion;
    /// Forces (force densities of peridynamic particles in LAMMPS' convention).
    F "f" Anew;
    /// Angular velocities [1/time].
    OMEGA "omega" Motion;
    /// Torques [force·length].
    TORQUE "torque" Anew;
    /// Orientations, unit quaternions.
    QUAT "quat" Orientation;
    /// Dipole moments [charge·length].
    MU "mu" Orientation;
    /// Charges.
    CHARGE "charge" Nothing;
    /// Radii [length].
    RADIUS "radius" Nothing;
    /// Masses of particles, or densities of peridynamic ones.
    MASS "mass" Nothing;
    /// Types, from 1.
    KIND "type" Nothing;
    /// Group bits.
    MASK "mask" Nothing;
    /// How often each particle has crossed periodic faces.
    IMAGE "image" Place;
    /// Volumes of peridynamic particles [length³].
    VOLUME "volume" Nothing;
    /// Positions at creation [length].
    X0 "x0" Anchor;
    /// Identities, from 1.
    TAG "id" Nothing;
    /// Molecule IDs.
    MOLECULE "molecule" Nothing;
    /// Densities as the deck set them [mass/length³].
    DENSITY "density" Nothing;
    /// The order of creation while particles stand in the order of space.
    RANK "rank" Nothing;
    /// Masses of types; owned by `mass`.
    TYPE_MASS "type_mass" Nothing;
    /// Columns of fixes and computes, each owned by the one that made it.
    COLUMNS "columns" Columns;
    /// Small state of fixes, by `kind/ID`.
    MEMO "memo" Nothing;
    /// What fixes set internal variables to.
    CONTROLS "controls" Nothing;
    /// Values of computes, fixes and variables.
    SLOTS "slots" Anew;
    /// The box.
    BOX "box" Nothing;
    /// Named volumes and how they move.
    REGIONS "regions" Nothing;
    /// Bonds between particles by their ids; owned by `bond_style`.
    BONDS "bonds" Nothing;
    /// Peridynamic bonds; owned by the pair style of solids.
    FAMILIES "families" Nothing;
    /// What the last evaluation has left at the sites of peridynamic bodies: displacements, dilatations. An op that
    /// reads it reads `FAMILIES` too.
    SITES "sites" Nothing;
    /// How rigid bodies stand and move, as their fixes keep it in the memo. An op that reads it reads `MEMO` too.
    RIGID "rigid" Nothing;
    /// The history of contacts between grains; owned by the pair style of grains.
    CONTACTS "contacts" Springs;
    /// The history of contacts with walls; owned by the walls.
    WALL_CONTACTS "wall_contacts" Anchor;
    /// Energy and virial of the present step.
    TALLY "tally" Anew;
    /// When neighbour lists were last rebuilt, and the positions then.
    LISTS "lists" Anew;
    /// How far particles may have gone in this run [length].
    TRAVEL "travel" Nothing;
    /// Step, time and step size; any op may read it.
    CLOCK "clock" Nothing;
    /// Facts that styles leave for each other and for the log.
    FACTS "facts" Nothing;
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

    /// Those that are in both.
    pub const fn and_only(self, these: Fields) -> Fields {
        Fields(self.0 & these.0)
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
