//! A compute: the power of the forces on a group.

use super::run;
use perigrain::diag::Result;
use perigrain::lang::Args;
use perigrain::plan::{Op, Stage, When};
use perigrain::styles::matter::sum;
use perigrain::styles::step_op::{Wanted, fill_sums};
use perigrain::styles::words::{Grammar, Syntax};
use perigrain::styles::{BuildCx, Compute, ComputeStyle, Doc, SealCx, Shape, Style};
use perigrain::world::field::{F, MASK, V};
use perigrain::world::{GroupId, SlotId};
use perigrain_base::math::vec3::dot;

struct PowerStyle;

impl Style for PowerStyle {
    fn name(&self) -> &'static str {
        "power"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Power of the forces on a group.",
            text: "Scalar (extensive): Σ f · v [force velocity].",
            example: "compute p all power",
        }
    }
}

#[derive(Clone)]
struct Power {
    id: String,
    group: GroupId,
}

impl ComputeStyle for PowerStyle {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        args.finish()?;
        Ok(Box::new(Power { id: cx.id.to_string(), group: cx.group }))
    }
}

impl Compute for Power {
    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, ..Shape::default() }
    }

    fn op(&self, _: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let group = self.group;
        Ok(fill_sums(&self.id, &Wanted { slot, stage, when }, F | V | MASK, move |w, _, out| {
            let p = &w.particles;
            [out.scalar] = sum(w, group, |i| [dot(p.f[i], p.v[i])]);
            Ok(())
        }))
    }
}

#[test]
fn a_compute_in_one_file_and_one_line_gives_the_power_of_gravity() {
    let deck = "units lj\natom_style sphere\nregion b block 0 10 0 10 0 100\ncreate_box 1 b\n\
                create_atoms 1 single 3 5 90\ncreate_atoms 1 single 6 5 90\nset group all diameter 1.0\n\
                set atom 1 density 3.0\nset atom 2 density 6.0\ngroup first id 1\nvelocity first set 2.0 0 1.5\n\
                fix move all nve/sphere\nfix pull all gravity 2.0 vector 0 0 -1\ntimestep 1e-2\n\
                compute all all power\ncompute first first power\n\
                thermo_style custom step c_all c_first\nthermo 100\nrun 300\n";
    let mut session = run(|tables| tables.computes.push(&PowerStyle), deck);
    let [all, first] = ["c_all", "c_first"].map(|name| session.number(name).unwrap());
    // P = m g (g t − v₀) with m = π/6 ρ d³, g = 2, t = 3: m (12 − 3) and m 12.
    let [a, b] = [3.0, 6.0].map(|density| std::f64::consts::PI / 6.0 * density);
    assert!((first / (9.0 * a) - 1.0).abs() < 1e-12, "{first}");
    assert!((all / (9.0 * a + 12.0 * b) - 1.0).abs() < 1e-12, "{all}");
}
