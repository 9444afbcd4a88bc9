//! What LAMMPS has and perigrain does not: refused by name.

/// LAMMPS styles of our field that perigrain does not have yet, by kind; named so that nobody searches for a typo.
pub const STYLES: &[(&str, &str)] = &[
    ("pair", "lj/cut"),
    ("fix", "rigid/nvt"),
    ("fix", "rigid/npt"),
    ("fix", "rigid/nph"),
    ("fix", "rigid/nvt/small"),
    ("fix", "rigid/npt/small"),
    ("fix", "rigid/nph/small"),
    ("fix", "nvt"),
    ("fix", "npt"),
    ("fix", "langevin"),
    ("fix", "wall/reflect"),
    ("dump", "movie"),
];
