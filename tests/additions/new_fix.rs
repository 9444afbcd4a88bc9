//! A fix: drag that grows with the square of the velocity.

use super::{refused, run};
use perigrain::diag::Result;
use perigrain::lang::Args;
use perigrain::plan::{Needs, Op, Stage};
use perigrain::styles::step_op::StepOp;
use perigrain::styles::words::{Syntax, Words, read};
use perigrain::styles::{BuildCx, Doc, Fix, FixStyle, SealCx, Style};
use perigrain::world::GroupId;
use perigrain::world::field::{F, MASK, V};
use perigrain_base::math::vec3::{length, scale, sub};

struct QuadraticDrag;

impl Style for QuadraticDrag {
    fn name(&self) -> &'static str {
        "drag/quadratic"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Slows particles down by a drag proportional to the square of their velocity.",
            text: "f ← f − b |v| v.",
            example: "fix air all drag/quadratic 0.5",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The drag coefficient [force/velocity²].
    #[word(non_negative)]
    b: f64,
}

#[derive(Clone)]
struct Drag {
    name: String,
    group: GroupId,
    b: f64,
}

impl FixStyle for QuadraticDrag {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { b } = read(args, cx)?;
        Ok(Box::new(Drag { name: format!("fix {} {}", cx.id, self.name()), group: cx.group, b }))
    }
}

impl Fix for Drag {
    fn ops(&self, _cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (b, bit) = (self.b, self.group.bit());
        let needs = Needs::new().read(V | MASK).add(F);
        let op = StepOp::new(self.name.clone(), Stage::PostForce, needs, move |w, _| {
            let mut f = std::mem::take(&mut w.particles.f);
            for i in w.moved_in(0..f.len()).flatten().filter(|&i| w.particles.mask[i] & bit != 0) {
                let v = w.particles.v[i];
                f[i] = sub(f[i], scale(b * length(v), v));
            }
            w.particles.f = f;
            Ok(())
        });
        Ok(vec![op.one_by_one().boxed()])
    }
}

#[test]
fn a_fix_in_one_file_and_one_line_slows_down_as_its_closed_form() {
    let deck = "units lj\nregion b block 0 100 0 1 0 1\ncreate_box 1 b\ncreate_atoms 1 single 1 0.5 0.5\nmass 1 2.0\n\
                velocity all set 3.0 0 0\ntimestep 1e-3\nfix move all nve\nfix air all drag/quadratic 0.5\n\
                variable v equal vx[1]\nvariable x equal x[1]\nrun 4000\n";
    let mut session = run(|tables| tables.fixes.push(&QuadraticDrag), deck);
    // dv/dt = −(b/m) v²: v = v₀/(1 + v₀ b t/m), x = x₀ + (m/b) ln(1 + v₀ b t/m); here 1 + v₀ b t/m = 4.
    let [v, x] = ["v_v", "v_x"].map(|name| session.number(name).unwrap());
    // Forces of velocities half a step earlier: first order, of v₀ b dt/m = 7.5e-4.
    assert!((v / 0.75 - 1.0).abs() < 7.5e-4, "{v}");
    assert!((x / (1.0 + 4.0 * 4.0_f64.ln()) - 1.0).abs() < 7.5e-4, "{x}");
    // The line has places and limits as every other has.
    let message = refused(&mut session, "fix other all drag/quadratic -1.0\n");
    assert!(message.contains("-1"), "{message}");
    assert!(refused(&mut session, "fix other all drag/quadratic 1.0 2.0\n").contains("2.0"));
}
