//! LAMMPS data files: which columns particles have in them, how they are read and written.

pub mod body;
pub mod dump;
pub mod header;
pub mod index;
pub mod text;
pub mod write;

use crate::world::AtomStyle;

/// A column of the section Atoms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Identity.
    Id,
    /// Type.
    Type,
    /// A coordinate.
    X(usize),
    /// Twice the radius.
    Diameter,
    /// Mass over the volume of the sphere; the mass itself where there is no radius.
    Density,
    /// Volume of a peridynamic particle.
    Volume,
}

impl Column {
    /// What messages call it.
    pub fn name(self) -> &'static str {
        match self {
            Column::Id => "the id",
            Column::Type => "the type",
            Column::X(0) => "x",
            Column::X(1) => "y",
            Column::X(_) => "z",
            Column::Diameter => "the diameter",
            Column::Density => "the density",
            Column::Volume => "the volume",
        }
    }
}

/// The columns of the section Atoms, image flags apart.
pub fn columns(style: AtomStyle) -> Vec<Column> {
    use Column::{Density, Diameter, Id, Type, Volume, X};
    let own: &[Column] = match (style.sphere, style.peri) {
        (false, false) => &[],
        (true, false) => &[Diameter, Density],
        (false, true) => &[Volume, Density],
        // The order in which `hybrid` names them; what both have stands once.
        (true, true) if style.sphere_mass => &[Volume, Density, Diameter],
        (true, true) => &[Diameter, Density, Volume],
    };
    let place = [X(0), X(1), X(2)];
    let (first, last) = if style.hybrid { (&place[..], own) } else { (own, &place[..]) };
    [&[Id, Type], first, last].concat()
}

/// Numbers after the id in the section Velocities.
pub fn velocity_columns(style: AtomStyle) -> usize {
    if style.sphere { 6 } else { 3 }
}
