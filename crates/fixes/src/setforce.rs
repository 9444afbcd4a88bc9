//! fix setforce: sets forces to given values.

use super::components::Components;
use super::{AtRest, Facts, Fix, FixStyle, Minimizing, RegionId};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{BlockSums, Needs, Op, ParticleBlock, Room, Stage, Tick};
use perigrain_styles::matter::{change_forces, publish_levels};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Nullable, PerAtom, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Shape, Style};
use perigrain_world::World;
use perigrain_world::field::{F, MASK, REGIONS, SLOTS, X};

/// The style.
pub struct SetForce;

impl Style for SetForce {
    fn name(&self) -> &'static str {
        "setforce"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Replaces components of the force on each particle of the group.",
            text: "Only forces computed before count: those of pair styles and of fixes declared earlier. Acts in the \
                   setup of a run too. Vector of 3 (extensive): the total force before the change.",
            example: "fix clamp foot setforce 0.0 0.0 0.0",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The force of a particle [force], for peridynamic particles in LAMMPS' convention a force density: numbers, or `v_name` of
    /// equal- or atom-style variables, evaluated each step; a component that is `NULL` stays.
    #[word(name = "fx fy fz", what = "{}")]
    components: [Nullable<PerAtom>; 3],
    /// Only particles inside it at that moment.
    #[word(keyword, name = "ID")]
    region: Option<RegionId>,
}

impl FixStyle for SetForce {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        let components = Components::new(line.components, line.region, cx.group);
        Ok(Box::new(Declared { id: cx.id.to_string(), components }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    components: Components,
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (chosen, force) = self.components.seal(cx)?;
        let level = cx.level();
        let slot = cx.slot(&format!("f_{}", self.id));
        let access = Needs::new().read(X | MASK | REGIONS).write(F | SLOTS);
        let numbers = chosen.bit_alone().zip(numbers(&force));
        let hold = move |_: &World, t: &Tick, room: &mut Room| {
            let Some((bit, values)) = numbers.filter(|_| !t.unchanged) else { return false };
            let here = level.acts(&t.phase);
            let values = values.map(|v: Option<f64>| v.map(|a| if here { a } else { 0.0 }));
            room.act(move |s: &mut ParticleBlock<'_>| replace(s, bit, &values));
            true
        };
        let took = move |w: &mut World, t: &Tick, sums: BlockSums| publish_levels(w, slot, t, &sums.sums);
        let op = StepOp::new(format!("fix {} setforce", self.id), Stage::PostForce, access, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            // With several time step levels, the value belongs to one of them.
            let here = level.acts(&t.phase);
            let before = change_forces(w, &chosen, |w, i, f| {
                let before = *f;
                for d in 0..3 {
                    if let Some(reading) = force[d] {
                        f[d] = if here { reading.atom(w, i) } else { 0.0 };
                    }
                }
                before
            });
            publish_levels(w, slot, t, &before);
            Ok(())
        });
        Ok(vec![op.fusing(hold, took).one_by_one().with_sums().in_every_level().boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { vector: 3, vector_extensive: true, ..Shape::default() }
    }

    fn facts(&self, _: &World) -> Facts {
        let at_rest = self.components.zeros().map_or(AtRest::Refused, AtRest::Holds);
        Facts { minimizing: Minimizing::Acts, at_rest, has_level: true, ..Facts::default() }
    }
}

/// The components, if all given ones are plain numbers.
fn numbers(force: &[Option<Reading>; 3]) -> Option<[Option<f64>; 3]> {
    let mut values = [None; 3];
    for (value, reading) in values.iter_mut().zip(force) {
        *value = match reading {
            None => None,
            Some(Reading::Const(a)) => Some(*a),
            Some(_) => return None,
        };
    }
    Some(values)
}

/// Replaces force components of a group's particles; returns the sum of the replaced forces.
fn replace(s: &mut ParticleBlock, bit: u32, values: &[Option<f64>; 3]) -> BlockSums {
    let mut sums = BlockSums::default();
    // Held particles are contiguous in memory: most groups of eight have none.
    for (k, eight) in s.mask().chunks(8).enumerate() {
        if eight.iter().fold(0, |all, m| all | m) & bit == 0 {
            continue;
        }
        for (f, _) in s.f[8 * k..].iter_mut().zip(eight).filter(|(_, m)| **m & bit != 0) {
            for d in 0..3 {
                sums.sums[d] += f[d];
                f[d] = values[d].unwrap_or(f[d]);
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::region::{Region, Shape};
    use perigrain_world::{AtomStyle, Key};

    fn scene() -> Bench {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [5.0, 0.0, 0.0]]);
        b.world.particles.f = vec![[1.0, 2.0, 3.0], [10.0, 20.0, 30.0]].into();
        b.atom.insert("a".into(), vec![-1.0, -2.0]);
        b.equal.insert("e".into(), 7.0);
        b.world
            .regions
            .insert(Key::new("r"), Region::inside(Shape::Sphere { center: [0.0; 3], radius: 1.0 }));
        b
    }

    #[test]
    fn components_are_replaced_and_the_total_is_kept() {
        let mut b = scene();
        let fix = b.fix(&SetForce, "NULL v_e v_a").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.world.particles.f, [[1.0, 7.0, -1.0], [10.0, 7.0, -2.0]]);
        assert_eq!(b.slot_of("f_f").vector, [11.0, 22.0, 33.0]);
    }

    #[test]
    fn only_inside_the_region() {
        let mut b = scene();
        let fix = b.fix(&SetForce, "0 0 0 region r").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.world.particles.f, [[0.0; 3], [10.0, 20.0, 30.0]]);
        assert_eq!(b.slot_of("f_f").vector, [1.0, 2.0, 3.0]);
        b.world.regions.clear();
        assert!(b.seal(&*fix).is_err());
    }

    #[test]
    fn mistakes_are_named() {
        let b = scene();
        for words in ["0 0", "0 0 v_no", "0 0 zero", "0 0 c_a", "0 0 0 regoin r", "0 0 0 region q"] {
            assert!(b.fix(&SetForce, words).is_err(), "{words}");
        }
    }
}
