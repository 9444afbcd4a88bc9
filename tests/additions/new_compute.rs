//! A compute: the momentum of a group.

use super::run;
use perigrain::diag::Result;
use perigrain::lang::Args;
use perigrain::plan::{Op, Stage, When};
use perigrain::styles::matter::{Masses, check_masses, sum};
use perigrain::styles::step_op::{Wanted, fill_sums};
use perigrain::styles::words::{Grammar, Syntax};
use perigrain::styles::{BuildCx, Compute, ComputeStyle, Doc, SealCx, Shape, Style};
use perigrain::world::field::{KIND, MASK, MASS, TYPE_MASS, V};
use perigrain::world::{GroupId, SlotId};

struct MomentumStyle;

impl Style for MomentumStyle {
    fn name(&self) -> &'static str {
        "momentum"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Momentum of a group.",
            text: "Vector (extensive) of three: Σ m v.",
            example: "compute p all momentum",
        }
    }
}

#[derive(Clone)]
struct Momentum {
    id: String,
    group: GroupId,
}

impl ComputeStyle for MomentumStyle {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        args.finish()?;
        Ok(Box::new(Momentum { id: cx.id.to_string(), group: cx.group }))
    }
}

impl Compute for Momentum {
    fn shape(&self) -> Shape {
        Shape { vector: 3, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, span) = (self.group, cx.span());
        check_masses(cx.world(), span)?;
        let (wanted, reads) = (Wanted { slot, stage, when }, V | MASS | MASK | KIND | TYPE_MASS);
        Ok(fill_sums(&self.id, &wanted, reads, move |w, _, out| {
            let (p, masses) = (&w.particles, Masses::of(w));
            out.vector = sum(w, group, |i| p.v[i].map(|v| masses.get(i) * v)).to_vec();
            Ok(())
        }))
    }
}

#[test]
fn a_compute_in_one_file_and_one_line_sees_what_gravity_gives_and_what_forces_keep() {
    let deck = "units lj\natom_style sphere\nregion b block 0 10 0 10 0 10\ncreate_box 1 b\n\
                create_atoms 1 single 4 5 5\ncreate_atoms 1 single 5.5 5.3 5\nset group all diameter 1.0\n\
                set atom 1 density 3.0\nset atom 2 density 6.0\nvelocity all set 0.5 0.25 0\ngroup first id 1\n\
                velocity first set 2.0 0 0\npair_style granular\npair_coeff * * hooke 1e4 0.0 tangential none\n\
                fix move all nve/sphere\nfix pull all gravity 2.0 vector 0 0 -1\ntimestep 1e-3\n\
                compute p all momentum\ncompute first first momentum\n\
                thermo_style custom step c_p[1] c_p[3]\nthermo 500\nrun 1000\n";
    let mut session = run(|tables| tables.computes.push(&MomentumStyle), deck);
    let mut number = |name: &str| session.number(name).unwrap();
    // m = π/6 ρ d³ = π/2 and π. Contacts keep the sum, gravity adds −M g t.
    let (a, b) = (std::f64::consts::FRAC_PI_2, std::f64::consts::PI);
    let expected = [2.0 * a + 0.5 * b, 0.25 * b, -2.0 * (a + b)];
    for (k, p) in expected.into_iter().enumerate() {
        let found = number(&format!("c_p[{}]", k + 1));
        assert!((found / p - 1.0).abs() < 1e-12, "{k}: {found} {p}");
    }
    // They have met: the first has given momentum to the second.
    assert!(number("c_first[1]") < 0.8 * 2.0 * a);
}
