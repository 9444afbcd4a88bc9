//! fix recenter: holds the centre of mass of a group at a position.

use super::{Fix, FixStyle};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::length;
use perigrain_base::par;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::common::scales;
use perigrain_styles::matter::{Whole, centre, check_masses, publish};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Alternative, Kind, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, IMAGE, KIND, MASK, MASS, MEMO, SLOTS, TYPE_MASS, X};
use perigrain_world::{GroupId, Key, Numbers, World};

/// The style.
pub struct Recenter;

impl Style for Recenter {
    fn name(&self) -> &'static str {
        "recenter"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Shifts particles every step so that the centre of mass of the group stays at a place.",
            text: "Velocities stay. Acts after the time integration of fixes declared before: declare it after them. \
                   Under `-compat lammps` the group's mass is that of the run's beginning, also once particles have \
                   been lost or have come. Scalar (extensive): the length of the last shift; vector of 3 (extensive): \
                   the shift.",
            example: "fix still plate recenter INIT INIT NULL",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The place of the centre: numbers, `NULL` (not held) or `INIT` (where the centre was when the fix was declared).
    #[word(name = "x y z", what = "{} of the centre")]
    hold: [Hold; 3],
    /// The group to shift; without it the group itself.
    #[word(keyword, name = "group2")]
    shift: Option<GroupId>,
    #[word(keyword, shown = "lattice")]
    units: Scale,
}

/// In which units the place is.
#[derive(Clone, Copy, Default, PartialEq, Words)]
#[word(what = "value of units")]
enum Scale {
    /// In those of the box.
    Box,
    /// In spacings of the `lattice`.
    #[default]
    Lattice,
    /// In parts of the box.
    Fraction,
}

impl Value for Hold {
    const KIND: Kind = Kind::Or(
        &Kind::Choice(&[
            Alternative { word: "NULL", about: "", parts: &[] },
            Alternative { word: "INIT", about: "", parts: &[] },
        ]),
        &Kind::Number,
    );
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        if args.eat("NULL") {
            return Ok(Hold::Free);
        }
        if args.eat("INIT") {
            return Ok(Hold::Initial);
        }
        args.number(what).map(Hold::At)
    }
}

/// How one coordinate of the centre is held.
#[derive(Clone, Copy)]
enum Hold {
    Free,
    Initial,
    At(f64),
}

impl FixStyle for Recenter {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { hold, shift, units } = read(args, cx)?;
        let scale = scales(cx.world, units == Scale::Lattice);
        let hold = std::array::from_fn(|d| match hold[d] {
            Hold::At(c) => Hold::At(c * scale[d]),
            other => other,
        });
        let (shifted, fraction) = (shift.unwrap_or(cx.group), units == Scale::Fraction);
        let (id, key) = (cx.id.to_string(), Key::new(&format!("recenter/{}", cx.id)));
        Ok(Box::new(Declared { id, key, group: cx.group, shifted, hold, fraction }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    key: Numbers,
    group: GroupId,
    shifted: GroupId,
    hold: [Hold; 3],
    fraction: bool,
}

impl Declared {
    /// The displacement to add to the positions in this step.
    fn shift(&self, w: &World, whole: Whole) -> [f64; 3] {
        let (_, now) = whole.centre(w, self.group);
        let lo = w.domain.as_ref().map_or([0.0; 3], |d| d.lo);
        let edges = w.edges();
        // A free direction is ignored.
        let held = self.hold.map(|hold| if let Hold::At(c) = hold { c } else { 0.0 });
        let inside = edges.shift(held);
        let initial = w.memo.get(self.key);
        std::array::from_fn(|d| match self.hold[d] {
            Hold::Free => 0.0,
            Hold::Initial => initial.and_then(|x| x.get(d)).map_or(0.0, |x| x - now[d]),
            Hold::At(_) if self.fraction => lo[d] + inside[d] - now[d],
            Hold::At(c) => c - now[d],
        })
    }
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        w.spread_type_masses();
        let (_, at) = centre(w, self.group);
        w.memo.insert(self.key, at.to_vec());
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key);
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        check_masses(cx.world(), span)?;
        let slot = cx.slot(&format!("f_{}", self.id));
        let whole = Whole::mass(cx.world(), self.group);
        let (me, access) = (
            self.clone(),
            Needs::new()
                .read(IMAGE | MASS | MASK | BOX | TYPE_MASS | MEMO | KIND)
                .write(X | SLOTS)
                .only(&[self.key.text()]),
        );
        let op =
            StepOp::new(format!("fix {} recenter", self.id), Stage::InitialIntegrate, access, move |w, t| {
                let shift = me.shift(w, whole);
                let (bit, p) = (me.shifted.bit(), &mut w.particles);
                par::each((&mut p.x[..], &p.mask[..]), |_, (x, mask)| {
                    for (x, _) in x.iter_mut().zip(mask).filter(|(_, m)| **m & bit != 0) {
                        (0..3).for_each(|d| x[d] += shift[d]);
                    }
                });
                publish(w, slot, t, length(shift), &shift);
                Ok(())
            });
        Ok(vec![op.boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, vector: 3, scalar_extensive: true, vector_extensive: true, ..Shape::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn the_centre_stays() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [2.0, 4.0, 6.0]]);
        let fix = b.fix(&Recenter, "INIT 0.25 NULL units fraction").unwrap();
        fix.declare(&mut b.world).unwrap();
        b.world.particles.x[0] = [-2.0, 0.0, 2.0];
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::InitialIntegrate).unwrap();
        // Centre now (0, 2, 4); held at (1, -10 + 20/4, any).
        assert_eq!(b.world.particles.x, [[-1.0, -7.0, 2.0], [3.0, -3.0, 6.0]]);
        assert_eq!(b.slot_of("f_f").vector, [1.0, -7.0, 0.0]);
        for words in ["0 0", "0 0 INITIAL", "0 0 0 shift q", "0 0 0 units boxes", "0 0 0 shit all"] {
            assert!(b.fix(&Recenter, words).is_err(), "{words}");
        }
    }
}
