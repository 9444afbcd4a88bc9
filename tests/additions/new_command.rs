//! A command: turns all velocities of a group round, so that a run goes back the way it came.

use super::{refused, run};
use perigrain::diag::Result;
use perigrain::lang::Args;
use perigrain::styles::common::{self, on_particles};
use perigrain::styles::words::{Syntax, Words, read};
use perigrain::styles::{Act, BuildCx, CommandStyle, Doc, Style};
use perigrain::world::GroupId;

struct Reverse;

impl Style for Reverse {
    fn name(&self) -> &'static str {
        "reverse"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Turns the velocities of a group round.",
            text: "v ← −v: without friction a run behind it passes the same states in reverse.",
            example: "reverse all",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "GROUP")]
    group: GroupId,
}

impl CommandStyle for Reverse {
    fn parse(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let Line { group } = read(args, cx)?;
        Ok(on_particles(vec!["velocity"], move |cx| {
            let (p, bit) = (&mut cx.world.particles, group.bit());
            for (v, _) in p.v.iter_mut().zip(p.mask.iter()).filter(|(_, mask)| *mask & bit != 0) {
                *v = v.map(|v| -v);
            }
            cx.world.touch();
            Ok(())
        }))
    }
}

#[test]
fn a_command_in_one_file_and_one_line_takes_a_run_back_to_its_beginning() {
    let deck = "units lj\natom_style bond\nregion b block 0 10 0 10 0 10\ncreate_box 1 b bond/types 1 extra/bond/per/atom 2\n\
                create_atoms 1 single 4 5 5\ncreate_atoms 1 single 5.3 5.5 5\nmass 1 1.0\ncreate_bonds single/bond 1 1 2\n\
                bond_style harmonic\nbond_coeff 1 50.0 1.0\nvelocity all set 0.5 0.25 0\nfix move all nve\ntimestep 1e-3\n\
                variable away equal (x[2]-5.3)^2+(y[2]-5.5)^2\nrun 500\n";
    let mut session = run(|tables| tables.commands.push(&Reverse), deck);
    assert!(session.number("v_away").unwrap() > 0.01);
    session.run_text("back", "reverse all\nrun 500\n").unwrap();
    // Velocity Verlet runs back to rounding: 500 steps of 1e-16 times places of 5.
    let away = session.number("v_away").unwrap().sqrt();
    assert!(away < 1e-12, "{away}");
    assert!(refused(&mut session, "reverse nosuch\n").contains("nosuch"));
}
