//! Unit systems and their constants.

/// LAMMPS' eight unit systems.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum UnitSystem {
    /// Lennard-Jones: all quantities reduced.
    #[default]
    Lj,
    /// Grams per mole, ångström, femtoseconds, kcal per mole.
    Real,
    /// Grams per mole, ångström, picoseconds, electron volts.
    Metal,
    /// Kilograms, metres, seconds.
    Si,
    /// Grams, centimetres, seconds.
    Cgs,
    /// Atomic mass units, Bohr, femtoseconds, Hartree.
    Electron,
    /// Picograms, micrometres, microseconds.
    Micro,
    /// Attograms, nanometres, nanoseconds.
    Nano,
}

/// Names a deck can give, in LAMMPS' order.
pub const NAMES: [&str; 8] = ["lj", "real", "metal", "si", "cgs", "electron", "micro", "nano"];

/// Constants of a unit system. The values are LAMMPS' own (22 Jul 2025), so that temperatures and pressures
/// agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constants {
    /// Boltzmann's constant, energy per temperature.
    pub boltz: f64,
    /// Planck's constant, energy times time.
    pub hplanck: f64,
    /// Mass · velocity² to energy.
    pub mvv2e: f64,
    /// Force · time to mass · velocity.
    pub ftm2v: f64,
    /// Mass per volume to density.
    pub mv2d: f64,
    /// Number · temperature per volume to pressure.
    pub nktv2p: f64,
    /// Viscosity · velocity to force.
    pub vxmu2f: f64,
    /// Length² per time to kinematic viscosity.
    pub xxt2kmu: f64,
    /// Default time step.
    pub dt: f64,
    /// Default neighbour skin.
    pub skin: f64,
}

impl UnitSystem {
    /// The system of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        use UnitSystem::*;
        let all = [Lj, Real, Metal, Si, Cgs, Electron, Micro, Nano];
        NAMES.iter().position(|&n| n == name).map(|k| all[k])
    }

    /// The name a deck gives.
    pub fn name(self) -> &'static str {
        NAMES[self as usize]
    }

    /// Names of the units of length, time and velocity, as in LAMMPS' manual; empty for reduced units.
    pub fn symbols(self) -> [&'static str; 3] {
        match self {
            Self::Lj => ["", "", ""],
            Self::Real => ["Å", "fs", "Å/fs"],
            Self::Metal => ["Å", "ps", "Å/ps"],
            Self::Si => ["m", "s", "m/s"],
            Self::Cgs => ["cm", "s", "cm/s"],
            Self::Electron => ["Bohr", "fs", "Bohr/atu"],
            Self::Micro => ["µm", "µs", "µm/µs"],
            Self::Nano => ["nm", "ns", "nm/ns"],
        }
    }

    /// Names of lengths from small to large, each as a power of ten of the unit.
    pub fn lengths(self) -> &'static [(i32, &'static str)] {
        match self {
            Self::Lj => &[],
            Self::Real | Self::Metal => &[(0, "Å"), (1, "nm"), (4, "µm"), (7, "mm")],
            Self::Si => &[(-9, "nm"), (-6, "µm"), (-3, "mm"), (0, "m"), (3, "km")],
            Self::Cgs => &[(-7, "nm"), (-4, "µm"), (-1, "mm"), (0, "cm"), (2, "m")],
            Self::Electron => &[(0, "Bohr")],
            Self::Micro => &[(-3, "nm"), (0, "µm"), (3, "mm"), (6, "m")],
            Self::Nano => &[(0, "nm"), (3, "µm"), (6, "mm"), (9, "m")],
        }
    }

    /// Whether `lattice` uses a reduced density, and energies are printed per particle.
    pub fn is_reduced(self) -> bool {
        self == Self::Lj
    }

    /// The units of length, mass and time in metres, kilograms and seconds; `None` for reduced and molecular
    /// units.
    pub fn mechanical(self) -> Option<[f64; 3]> {
        match self {
            Self::Si => Some([1.0, 1.0, 1.0]),
            Self::Cgs => Some([1e-2, 1e-3, 1.0]),
            Self::Micro => Some([1e-6, 1e-15, 1e-6]),
            Self::Nano => Some([1e-9, 1e-21, 1e-9]),
            Self::Lj | Self::Real | Self::Metal | Self::Electron => None,
        }
    }

    /// Factor from charge times electric field to force [force/(charge field)].
    pub fn field_to_force(self) -> f64 {
        match self {
            Self::Real => 23.060549,
            Self::Electron => 1.94469051e-10,
            _ => 1.0,
        }
    }

    /// The constants of the system.
    pub fn constants(self) -> Constants {
        const ONE: Constants = Constants {
            boltz: 1.0,
            hplanck: 1.0,
            mvv2e: 1.0,
            ftm2v: 1.0,
            mv2d: 1.0,
            nktv2p: 1.0,
            vxmu2f: 1.0,
            xxt2kmu: 1.0,
            dt: 0.005,
            skin: 0.3,
        };
        match self {
            Self::Lj => ONE,
            Self::Real => Constants {
                boltz: 0.0019872067,
                hplanck: 95.306976368,
                mvv2e: 48.88821291 * 48.88821291,
                ftm2v: 1.0 / 48.88821291 / 48.88821291,
                mv2d: 1.0 / 0.602214129,
                nktv2p: 68568.415,
                vxmu2f: 14393.264316,
                xxt2kmu: 0.1,
                dt: 1.0,
                skin: 2.0,
            },
            Self::Metal => Constants {
                boltz: 8.617343e-5,
                hplanck: 4.135667403e-3,
                mvv2e: 1.0364269e-4,
                ftm2v: 1.0 / 1.0364269e-4,
                mv2d: 1.0 / 0.602214129,
                nktv2p: 1.6021765e6,
                vxmu2f: 0.6241509647,
                xxt2kmu: 1e-4,
                dt: 0.001,
                skin: 2.0,
            },
            Self::Si => {
                Constants { boltz: 1.3806504e-23, hplanck: 6.62606896e-34, dt: 1e-8, skin: 0.001, ..ONE }
            }
            Self::Cgs => {
                Constants { boltz: 1.3806504e-16, hplanck: 6.62606896e-27, dt: 1e-8, skin: 0.1, ..ONE }
            }
            Self::Electron => Constants {
                boltz: 3.16681534e-6,
                hplanck: 0.1519829846,
                mvv2e: 1.06657236,
                ftm2v: 0.937582899,
                nktv2p: 2.94210108e13,
                vxmu2f: 33.9893149,
                xxt2kmu: 0.0313796367,
                dt: 0.001,
                skin: 2.0,
                ..ONE
            },
            Self::Micro => {
                Constants { boltz: 1.3806504e-8, hplanck: 6.62606896e-13, dt: 2.0, skin: 0.1, ..ONE }
            }
            Self::Nano => {
                Constants { boltz: 0.013806504, hplanck: 6.62606896e-4, dt: 0.00045, skin: 0.1, ..ONE }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Oracle: lammps.extract_global of boltz, mvv2e, ftm2v, nktv2p, dt after each `units` command.
    #[test]
    fn constants_are_lammps_own() {
        let oracle = [
            ("lj", [1.0, 1.0, 1.0, 1.0, 0.005]),
            ("real", [0.0019872067, 2390.0573615334906, 0.00041839999997254776, 68568.415, 1.0]),
            ("metal", [8.617343e-05, 0.00010364269, 9648.533823273016, 1602176.5, 0.001]),
            ("si", [1.3806504e-23, 1.0, 1.0, 1.0, 1e-08]),
            ("cgs", [1.3806504e-16, 1.0, 1.0, 1.0, 1e-08]),
            ("electron", [3.16681534e-06, 1.06657236, 0.937582899, 29421010800000.0, 0.001]),
            ("micro", [1.3806504e-08, 1.0, 1.0, 1.0, 2.0]),
            ("nano", [0.013806504, 1.0, 1.0, 1.0, 0.00045]),
        ];
        for (name, values) in oracle {
            let system = UnitSystem::from_name(name).unwrap();
            let c = system.constants();
            assert_eq!([c.boltz, c.mvv2e, c.ftm2v, c.nktv2p, c.dt], values, "{name}");
            assert_eq!(system.name(), name);
        }
        assert_eq!(UnitSystem::from_name("SI"), None);
    }
}
