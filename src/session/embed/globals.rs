//! Numbers of the whole scene under the names that LAMMPS' `extract_global` has for them.

use crate::session::Session;
use perigrain_world::Domain;

/// A number of the scene, or several.
#[derive(Clone, Debug, PartialEq)]
pub enum Global {
    /// A whole number that LAMMPS keeps in 32 bits.
    Whole(i32),
    /// A whole number that LAMMPS keeps in 64 bits.
    Large(i64),
    /// Any number.
    Real(f64),
    /// Several whole numbers.
    Wholes(Vec<i32>),
    /// Several numbers.
    Reals(Vec<f64>),
    /// A text.
    Text(String),
}

impl Session {
    /// What stands under a name; `None` if there is no such name, or nothing yet.
    pub fn global(&self, name: &str) -> Option<Global> {
        use Global::{Large, Real, Reals, Text, Whole, Wholes};
        let (w, s) = (&self.world, &self.world.settings);
        let c = s.units.constants();
        let n = w.n();
        let flag = |yes: bool| Whole(i32::from(yes));
        Some(match name {
            "dt" => Real(w.clock.dt),
            "ntimestep" => Large(w.clock.step),
            "atime" => Real(w.clock.time()),
            "atimestep" => Large(w.clock.step),
            "units" => Text(s.units.name().into()),
            "natoms" => Large(n as i64),
            "nlocal" | "nmax" => Whole(n as i32),
            "nghost" => Whole(0),
            "ntypes" => Whole(w.types as i32),
            "nbonds" => Large(w.bonds.list.len() as i64),
            "nbondtypes" => Whole(w.bonds.types as i32),
            "map_tag_max" | "tag_max" => Large(i64::from(w.particles.last_tag())),
            "dimension" => Whole(if s.two_dimensional { 2 } else { 3 }),
            "triclinic" => flag(w.domain.as_ref().is_some_and(|d| d.tilt.is_some())),
            "nangles" => Large(w.bonds.angles.list.len() as i64),
            "q_flag" => flag(w.particles.style.charged),
            "ndihedrals" | "nimpropers" => Whole(0),
            "procgrid" => Wholes(vec![1; 3]),
            "special_lj" => {
                let [a, b, c] = w.bonds.weights.lj;
                Reals(vec![1.0, a, b, c])
            }
            "special_coul" => {
                let [a, b, c] = w.bonds.weights.coul;
                Reals(vec![1.0, a, b, c])
            }
            "newton_pair" => flag(s.newton.pair),
            "newton_bond" => flag(s.newton.bond),
            "boltz" => Real(c.boltz),
            "hplanck" => Real(c.hplanck),
            "mvv2e" => Real(c.mvv2e),
            "ftm2v" => Real(c.ftm2v),
            "mv2d" => Real(c.mv2d),
            "nktv2p" => Real(c.nktv2p),
            "xlattice" => Real(w.lattice.spacing[0]),
            "ylattice" => Real(w.lattice.spacing[1]),
            "zlattice" => Real(w.lattice.spacing[2]),
            _ => return of_box(w.domain.as_ref()?, name),
        })
    }
}

/// Numbers of the box.
fn of_box(d: &Domain, name: &str) -> Option<Global> {
    let corner = |letter: &str, of: [f64; 3]| {
        let k = ["x", "y", "z"].iter().position(|axis| *axis == letter)?;
        Some(Global::Real(of[k]))
    };
    match name {
        "boxlo" | "sublo" => Some(Global::Reals(d.lo.to_vec())),
        "boxhi" | "subhi" => Some(Global::Reals(d.hi.to_vec())),
        "periodicity" => Some(Global::Wholes((0..3).map(|k| i32::from(d.boundary.periodic(k))).collect())),
        "xy" => Some(Global::Real(d.edges().tilt[0])),
        "xz" => Some(Global::Real(d.edges().tilt[1])),
        "yz" => Some(Global::Real(d.edges().tilt[2])),
        _ => {
            let rest = name.strip_prefix("box")?;
            let low = rest.strip_suffix("lo").and_then(|axis| corner(axis, d.lo));
            low.or_else(|| rest.strip_suffix("hi").and_then(|axis| corner(axis, d.hi)))
        }
    }
}
