//! fix addtorque: forces that turn a group as one body.

use super::{Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, scale, sub};
use perigrain_commands::momentum::rotation;
use perigrain_lang::{Args, Param};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::matter::{
    Chosen, Masses, centre, change_forces, check_masses, publish, sum, unwrapped,
};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, F, IMAGE, KIND, MASK, MASS, SLOTS, TYPE_MASS, V, X};
use perigrain_world::{GroupId, World};

/// The style.
pub struct AddTorque;

impl Style for AddTorque {
    fn name(&self) -> &'static str {
        "addtorque"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Adds forces that turn the group about its centre of mass as one body.",
            text: "With the angular velocity ω and the moments of inertia I of the group about its centre of mass, α = \
                   I⁻¹ (T − ω × I ω) and each particle at distance r from the centre gets the force m (α × r + ω × (ω × \
                   r)): the forces' torque is T, and free particles would move as a rigid body. It adds no torque to \
                   single spheres.\n\n\
                   Scalar (extensive): −Σ f·x of the added forces with unwrapped positions; `fix_modify ID energy yes` \
                   adds it to the potential energy. Vector of 3 (extensive): the group's torque before the change.",
            example: "fix spin plate addtorque 0 0 1.0e-6",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The torque on the group [torque]: numbers, or `v_name` of equal-style variables, evaluated each step.
    #[word(name = "Tx Ty Tz", what = "{}")]
    torque: [Param; 3],
}

impl FixStyle for AddTorque {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, torque: line.torque }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    torque: [Param; 3],
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (group, span) = (self.group, cx.span());
        check_masses(cx.world(), span)?;
        let chosen = Chosen::new(cx.world(), group, None, span)?;
        let [x, y, z] = &self.torque;
        let mut read = |p: &Param| cx.param(p, Stage::PostForce, &When::Always);
        let torque = [read(x)?, read(y)?, read(z)?];
        let slot = cx.slot(&format!("f_{}", self.id));
        let access =
            Needs::new().read(X | V | IMAGE | MASS | MASK | BOX | TYPE_MASS | KIND).add(F).write(SLOTS);
        let op = StepOp::new(format!("fix {} addtorque", self.id), Stage::PostForce, access, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            let turn = Turn::of(w, group, torque.map(|r| r.get(w)));
            let [energy, before @ ..] = change_forces::<4>(w, &chosen, |w, i, f| {
                let x = unwrapped(w, i);
                let r = sub(x, turn.centre);
                let before = cross(r, *f);
                let pull = add(cross(turn.alpha, r), cross(turn.omega, cross(turn.omega, r)));
                let added = scale(Masses::of(w).get(i), pull);
                *f = add(*f, added);
                [-dot(added, x), before[0], before[1], before[2]]
            });
            publish(w, slot, t, energy, &before);
            Ok(())
        });
        Ok(vec![op.boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, has_level: true, has_energy: true, ..Facts::default() }
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, vector: 3, scalar_extensive: true, vector_extensive: true, ..Shape::default() }
    }
}

/// How a group rotates, and the angular acceleration it gets.
struct Turn {
    centre: Vec3,
    omega: Vec3,
    alpha: Vec3,
}

impl Turn {
    fn of(w: &World, group: GroupId, torque: Vec3) -> Self {
        let (_, centre) = centre(w, group);
        let masses = Masses::of(w);
        let [l @ .., xx, yy, zz, xy, yz, xz] = sum::<9>(w, group, |i| {
            let (r, m) = (sub(unwrapped(w, i), centre), masses.get(i));
            let l = scale(m, cross(r, w.particles.v[i]));
            let [x, y, z] = r;
            let (xx, yy, zz) = (m * (y * y + z * z), m * (x * x + z * z), m * (x * x + y * y));
            [l[0], l[1], l[2], xx, yy, zz, -m * x * y, -m * y * z, -m * x * z]
        });
        let inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        let lammps = w.settings.lammps();
        let omega = rotation(inertia, l, lammps);
        let spin = inertia.map(|row| dot(row, omega));
        Self { centre, omega, alpha: rotation(inertia, sub(torque, cross(omega, spin)), lammps) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    // The forces give the requested torque and no net force; the spin adds its inward pull.
    #[test]
    fn forces_sum_to_the_torque() {
        let places = [[1.0, 0.0, 0.0], [-1.0, 0.5, 0.0], [0.0, 1.0, 0.5], [0.0, -1.5, -0.5]];
        let mut b = Bench::new(AtomStyle::default(), &places);
        b.equal.insert("t".into(), 3.0);
        b.world.particles.v = places.iter().map(|r| cross([0.1, 0.2, -0.4], *r)).collect();
        let fix = b.fix(&AddTorque, "1 -2 v_t").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        let f = &b.world.particles.f;
        let (force, torque) = places
            .iter()
            .zip(f)
            .fold(([0.0; 3], [0.0; 3]), |(a, b), (x, f)| (add(a, *f), add(b, cross(*x, *f))));
        let near = |a: Vec3, b: Vec3| dot(sub(a, b), sub(a, b)) < 1e-24; // a few ulp of forces of order 1
        assert!(near(force, [0.0; 3]) && near(torque, [1.0, -2.0, 3.0]), "{force:?} {torque:?}");
        assert_eq!(b.slot_of("f_f").vector, [0.0; 3]);
        for words in ["", "1 2", "1 2 x", "1 2 v_no", "1 2 3 4"] {
            let whole = b.fix(&AddTorque, words);
            assert!(whole.is_err() || words == "1 2 3 4", "{words}");
        }
    }
}
