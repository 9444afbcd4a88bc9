//! `units`: which unit system the deck's numbers are in.

use super::{Act, CommandStyle};
use perigrain_base::diag::Result;
use perigrain_base::units::UnitSystem;
use perigrain_lang::Args;
use perigrain_styles::common::{before_box, setting};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The command.
pub struct Units;

impl Style for Units {
    fn name(&self) -> &'static str {
        "units"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Says in which units all numbers of the deck are.",
            text: "Sets the constants of LAMMPS' unit system (Boltzmann's constant, conversion factors) and with them \
                   the default time step and neighbour skin. Must come before the box. Default: `lj`.",
            example: "units si",
        }
    }
}

#[derive(Words)]
struct Line {
    system: System,
}

/// The unit systems.
#[derive(Words)]
#[word(what = "unit system", of = UnitSystem)]
enum System {
    Lj,
    Real,
    Metal,
    Si,
    Cgs,
    Electron,
    Micro,
    Nano,
}

impl CommandStyle for Units {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        before_box(cx, "units")?;
        let Line { system } = read(a, cx)?;
        let system = UnitSystem::from(system);
        Ok(setting(move |cx| {
            let constants = system.constants();
            cx.world.settings.units = system;
            cx.world.settings.neighbor.skin = constants.skin;
            cx.world.clock.set_dt(constants.dt);
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{refused, scene};

    // Oracle: defaults of `units si` (extract_global dt; ghost cutoff of a pair style with cutoff 1 is 1.001).
    #[test]
    fn sets_time_step_and_skin() {
        let w = scene("units si");
        assert_eq!((w.clock.dt, w.settings.neighbor.skin), (1e-8, 0.001));
    }

    #[test]
    fn refuses_unknown_systems_and_late_changes() {
        let w = scene("region b block 0 1 0 1 0 1\ncreate_box 1 b");
        assert_eq!(refused(&Default::default(), "units sii").0, "sii");
        assert!(refused(&w, "units si").1.contains("before the simulation box"));
    }
}
