//! fix spring: a spring between the centre of mass of a group and a point, or another group's centre.

use super::{AtRest, Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::vec3::length;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::matter::{Chosen, Masses, Whole, change_forces, check_masses, publish};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Nullable, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, F, IMAGE, KIND, MASK, MASS, SLOTS, TYPE_MASS, X};
use perigrain_world::{GroupId, World};

/// The style.
pub struct Spring;

impl Style for Spring {
    fn name(&self) -> &'static str {
        "spring"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Pulls the centre of mass of a group to a point, or two groups together.",
            text: "A coordinate that is `NULL` does not count. The force is shared out by mass, so that the group is \
                   not turned or strained; centres are taken unwrapped. Acts in the setup of a run too. Under `-compat \
                   lammps` masses are those of the run's beginning, also once particles have been lost or have come.\n\n\
                   Scalar (extensive): the energy K (|r| − R0)²/2, which `fix_modify ID energy yes` adds to the \
                   potential energy. Vector of 4 (extensive): the force on the group and its strength, negative where \
                   the spring is shorter than R0.",
            example: "fix pull ball spring tether 50.0 0.0 0.0 NULL 0.0",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "kind")]
    kind: Tie,
    /// The stiffness K [force/length].
    #[word(name = "K", what = "the stiffness K")]
    stiffness: f64,
    /// The point, or the distance of the two centres at which the spring has no length [length].
    #[word(name = "x y z", what = "{}")]
    at: [Nullable<f64>; 3],
    /// The length R0 at rest [length].
    #[word(name = "R0", non_negative)]
    rest: f64,
}

/// What the spring ties the group to.
#[derive(Words)]
#[word(what = "kind of spring")]
enum Tie {
    /// To a point: with r from the centre of mass to (x, y, z), the group feels the force K (|r| − R0) along r.
    Tether,
    /// To another group: r is the vector from this group's centre to that of group2, less (x, y, z); the two groups feel
    /// opposite forces.
    Couple(#[word(name = "group2")] At<GroupId>),
}

impl FixStyle for Spring {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { kind, stiffness, at, rest } = read(args, cx)?;
        let other = match kind {
            Tie::Tether => None,
            Tie::Couple(other) if other.value == cx.group => {
                return fail(Code::CONFLICT, other.span, "a spring couples two groups, not one with itself");
            }
            Tie::Couple(other) => Some(other.value),
        };
        let at = at.map(|c| c.0);
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, other, stiffness, at, rest }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    other: Option<GroupId>,
    stiffness: f64,
    at: [Option<f64>; 3],
    rest: f64,
}

/// Shorter springs have no direction.
const SMALL: f64 = 1e-10;

impl Declared {
    /// The force on the group, its magnitude and the energy for the two centres (towards the target).
    fn pull(&self, from: [f64; 3], to: [f64; 3]) -> ([f64; 3], f64, f64) {
        let tether = self.other.is_none();
        let way: [f64; 3] = std::array::from_fn(|d| match self.at[d] {
            None => 0.0,
            Some(c) if tether => c - from[d],
            Some(c) => to[d] - from[d] - c,
        });
        let r = length(way).max(SMALL);
        let stretch = r - self.rest;
        let force = way.map(|a| self.stiffness * a * stretch / r);
        let strength = if stretch < 0.0 { -length(force) } else { length(force) };
        (force, strength, 0.5 * self.stiffness * stretch * stretch)
    }
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        check_masses(cx.world(), span)?;
        let mine = Chosen::new(cx.world(), self.group, None, span)?;
        let others = match self.other {
            Some(group) => Some((group, Chosen::new(cx.world(), group, None, span)?)),
            None => None,
        };
        let slot = cx.slot(&format!("f_{}", self.id));
        let whole = Whole::mass(cx.world(), self.group);
        let other_whole = Whole::mass(cx.world(), self.other.unwrap_or(self.group));
        let (me, access) = (
            self.clone(),
            Needs::new().read(X | IMAGE | MASS | MASK | BOX | TYPE_MASS | KIND).add(F).write(SLOTS),
        );
        let op = StepOp::new(format!("fix {} spring", self.id), Stage::PostForce, access, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            let (mass, from) = whole.centre(w, me.group);
            let (other_mass, to) =
                others.as_ref().map_or((0.0, [0.0; 3]), |(group, _)| other_whole.centre(w, *group));
            let (force, strength, energy) = me.pull(from, to);
            share(w, &mine, mass, force);
            if let Some((_, chosen)) = &others {
                share(w, chosen, other_mass, force.map(|f| -f));
            }
            publish(w, slot, t, energy, &[force[0], force[1], force[2], strength]);
            Ok(())
        });
        Ok(vec![op.boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, vector: 4, scalar_extensive: true, vector_extensive: true, ..Shape::default() }
    }

    fn facts(&self, _: &World) -> Facts {
        Facts {
            minimizing: Minimizing::Acts,
            at_rest: AtRest::Acts,
            has_level: true,
            has_energy: true,
            ..Facts::default()
        }
    }
}

/// Distributes a force by mass.
fn share(w: &mut perigrain_world::World, chosen: &Chosen, mass: f64, force: [f64; 3]) {
    // With zero total mass no particle feels it, and LAMMPS does not divide.
    let over = if mass > 0.0 { mass } else { 1.0 };
    let each = force.map(|f| f / over);
    change_forces::<0>(w, chosen, |w, i, f| {
        let m = Masses::of(w).get(i);
        (0..3).for_each(|d| f[d] += each[d] * m);
        []
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    // By hand: the centre of the two is (1, 0, 0), 5 away from (4, 4, any z); K = 2, R0 = 1 gives 8.
    #[test]
    fn a_tether_is_shared_out_by_mass() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0, 0.0, 3.0], [2.0, 0.0, 3.0]]);
        let fix = b.fix(&Spring, "tether 2 4 4 NULL 1").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.world.particles.f = vec![[0.0; 3]; 2].into();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        let close = |a: f64, b: f64| (a - b).abs() < 1e-14;
        for f in &b.world.particles.f {
            assert!(close(f[0], 2.4) && close(f[1], 3.2) && f[2] == 0.0, "{f:?}");
        }
        let s = b.slot_of("f_f");
        assert_eq!(s.scalar, 16.0);
        assert!(close(s.vector[0], 4.8) && close(s.vector[1], 6.4) && close(s.vector[3], 8.0));
    }

    #[test]
    fn a_couple_keeps_momentum() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [0.0, 0.0, 3.0]]);
        let g = b.world.groups.find_or_add("g").unwrap();
        let h = b.world.groups.find_or_add("h").unwrap();
        (b.world.particles.mask[0], b.world.particles.mask[1]) = (1 | g.bit(), 1 | h.bit());
        let fix = b.fix(&Spring, "couple h 2 0 0 1 4").unwrap();
        b.world.particles.f = vec![[0.0; 3]; 2].into();
        let mut ops = b.seal(&*fix).unwrap();
        // The group here is `all`, whose centre is (0, 0, 1.5): 1.5 − 1 − 4 shorter than at rest.
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.slot_of("f_f").vector, [0.0, 0.0, -7.0, -7.0]);
        assert_eq!(b.world.particles.f, [[0.0, 0.0, -3.5], [0.0, 0.0, 3.5]]);
        for words in ["tether 1 0 0 0", "couple no 1 0 0 0 1", "couple all 1 0 0 0 1", "tie 1 0 0 0 1"] {
            assert!(b.fix(&Spring, words).is_err(), "{words}");
        }
    }
}
