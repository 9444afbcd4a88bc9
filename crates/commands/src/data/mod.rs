//! LAMMPS data files: which columns particles have in them, how they are read and written.

pub mod body;
pub mod dump;
pub mod header;
mod more;
pub mod properties;
pub mod words;
pub mod write;

use perigrain_world::{AtomStyle, Own};

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
    /// Molecule ID.
    Molecule,
    /// Charge.
    Charge,
    /// A component of the dipole moment.
    Moment(usize),
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
            Column::Molecule => "the molecule",
            Column::Charge => "the charge",
            Column::Moment(0) => "mux",
            Column::Moment(1) => "muy",
            Column::Moment(_) => "muz",
        }
    }
}

/// The columns of the section Atoms, image flags apart.
pub fn columns(style: AtomStyle) -> Vec<Column> {
    use Column::{Charge, Density, Diameter, Id, Molecule, Moment, Type, Volume, X};
    static MOMENT: [Column; 3] = [Moment(0), Moment(1), Moment(2)];
    let place = [X(0), X(1), X(2)];
    if style.hybrid {
        let own = style.own.iter().flatten().flat_map(|own| {
            let columns: &'static [Column] = match own {
                Own::Molecule => &[Molecule],
                Own::Diameter => &[Diameter],
                Own::Density => &[Density],
                Own::Volume => &[Volume],
                Own::Charge => &[Charge],
                Own::Moment => &MOMENT,
            };
            columns.iter().copied()
        });
        return [Id, Type].into_iter().chain(place).chain(own).collect();
    }
    let molecule: &[Column] = if style.bonded { &[Molecule] } else { &[] };
    let own: &[Column] = match (style.sphere, style.peri) {
        (true, _) => &[Diameter, Density],
        (false, true) => &[Volume, Density],
        (false, false) => &[],
    };
    let charge: &[Column] = if style.charged { &[Charge] } else { &[] };
    let moment: &[Column] = if style.dipole { &MOMENT } else { &[] };
    [&[Id], molecule, &[Type], own, charge, &place, moment].concat()
}

/// Numbers after the id in the section Velocities.
pub fn velocity_columns(style: AtomStyle) -> usize {
    if style.sphere { 6 } else { 3 }
}
