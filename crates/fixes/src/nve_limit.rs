//! fix nve/limit: velocity Verlet with a limit on the displacement per step.

use super::nve::half_step;
use super::{AtRest, Facts, Fix, FixStyle, Moves, needs_spheres};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::dot;
use perigrain_base::par::{self, add};
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, Tick};
use perigrain_styles::matter::{Masses, check_masses, publish};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Or, Positive, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{F, KIND, MASK, MASS, MEMO, RADIUS, SLOTS, TYPE_MASS, V, X};
use perigrain_world::{GroupId, Key, Numbers, World};

/// The style.
pub struct NveLimit;

impl Style for NveLimit {
    fn name(&self) -> &'static str {
        "nve/limit"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Moves the particles of the group by velocity Verlet, none farther than xmax in a step.",
            text: "Meant for scenes that start with heavy overlaps; energy is not kept. Scalar (extensive): how often a \
                   velocity has been shortened since the fix was declared.",
            example: "fix 1 all nve/limit 1.0e-5",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The longest way xmax of a particle in a step [length]: after each half kick a velocity above xmax/Δt is shortened to that.
    #[word(name = "xmax", what = "the longest way xmax")]
    most: Or<OfRadius, Positive>,
}

/// The way as a part of the particle's size.
#[derive(Clone, Copy, Words)]
#[word(what = "longest way")]
enum OfRadius {
    /// So many times its radius, for each particle (not in LAMMPS).
    Radius(#[word(name = "F", what = "the part of the radius", positive)] f64),
}

/// The longest way in a step.
#[derive(Clone, Copy)]
enum Most {
    /// The same for all [length].
    Way(f64),
    /// So many radii.
    Radii(f64),
}

impl FixStyle for NveLimit {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let most = match read::<Line>(args, cx)?.most {
            Or::Else(Positive(way)) => Most::Way(way),
            Or::Word(OfRadius::Radius(part)) => {
                needs_spheres(cx, "nve/limit with `radius`")?;
                Most::Radii(part)
            }
        };
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, most }))
    }
}

/// Positions, velocities, forces and group bits of a chunk.
type Parts<'a> = (&'a mut [[f64; 3]], &'a mut [[f64; 3]], &'a [[f64; 3]], &'a [u32]);

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    most: Most,
}

impl Declared {
    fn key(&self) -> Numbers {
        Key::new(&format!("nve/limit/{}", self.id))
    }

    /// A half kick with the limit; returns the number of velocities that were shortened.
    fn kick(&self, w: &mut World, t: &Tick, drift: bool) -> f64 {
        let (half, bit) = (half_step(w, t.dt), self.group.bit());
        // The limit is per step of the deck, even when that is divided into shorter ones.
        let step = w.clock.dt;
        let p = &mut w.particles;
        let most = self.most;
        let radius = if let Most::Radii(_) = most { &p.radius[..] } else { &[] };
        let fastest = |i: usize| match most {
            Most::Way(way) => way / step,
            Most::Radii(part) => part * radius[i] / step,
        };
        let masses = Masses::new(p.style, &p.mass, &p.kind, &w.type_mass);
        let columns = (&mut p.x[..], &mut p.v[..], &p.f[..], &p.mask[..]);
        let chunk = |start: usize, (x, v, f, mask): Parts<'_>| {
            let mut shortened = 0.0;
            for (k, (((x, v), f), mask)) in x.iter_mut().zip(v).zip(f).zip(mask).enumerate() {
                if mask & bit == 0 {
                    continue;
                }
                let by = half / masses.get(start + k);
                (0..3).for_each(|d| v[d] += by * f[d]);
                let (speed, fastest) = (dot(*v, *v), fastest(start + k));
                let square = fastest * fastest;
                if speed > square {
                    shortened += 1.0;
                    let scale = (square / speed).sqrt();
                    *v = v.map(|a| a * scale);
                }
                if drift {
                    (0..3).for_each(|d| x[d] += t.dt * v[d]);
                }
            }
            [shortened]
        };
        par::reduce_each(columns, chunk, add).map_or(0.0, |[n]| n)
    }
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        w.memo.insert(self.key(), vec![0.0]);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key());
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        check_masses(cx.world(), span)?;
        let slot = cx.slot(&format!("f_{}", self.id));
        let half = |stage, drift, me: Self| {
            let (name, key) = (format!("fix {} nve/limit", me.id), me.key());
            let access = match me.most {
                Most::Way(_) => Needs::new(),
                Most::Radii(_) => Needs::new().read(RADIUS),
            };
            let access = access
                .read(F | MASS | MASK | TYPE_MASS | KIND)
                .write(X | V | SLOTS)
                .keep(MEMO)
                .only(&[key.text()]);
            StepOp::new(name, stage, access, move |w: &mut World, t: &Tick| {
                // With two step lengths only solids move in the short steps, and this fix moves none of them.
                let short = t.phase.solids.is_some() && !t.phase.outermost();
                let drift = drift && (t.phase.level == 0 || t.phase.solids.is_some());
                let shortened = if t.setup || short { 0.0 } else { me.kick(w, t, drift) };
                let total = w.memo.get_mut(key).and_then(|m| m.first_mut()).map_or(shortened, |n| {
                    *n += shortened;
                    *n
                });
                publish(w, slot, t, total, &[]);
                Ok(())
            })
            .in_setup(drift)
            .in_every_level()
            .boxed()
        };
        Ok(vec![
            half(Stage::InitialIntegrate, true, self.clone()),
            half(Stage::FinalIntegrate, false, self.clone()),
        ])
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, ..Shape::default() }
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { moves: Moves::Freely, at_rest: AtRest::Frees, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    // m = 2, dt = 0.5: the first feels f = 40 and would reach a speed of 5; the limit of 1 per step is a
    // speed of 2.
    #[test]
    fn fast_ones_are_slowed_and_counted() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        b.world.clock.dt = 0.5;
        b.world.particles.f = vec![[40.0, 0.0, 0.0], [8.0, 0.0, 0.0]].into();
        b.world.particles.v = vec![[0.0; 3]; 2].into();
        let fix = b.fix(&NveLimit, "1").unwrap();
        fix.declare(&mut b.world).unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::InitialIntegrate).unwrap();
        assert_eq!(b.world.particles.x, [[1.0, 0.0, 0.0], [0.5, 0.0, 0.0]]);
        b.stage(&mut ops, Stage::FinalIntegrate).unwrap();
        assert_eq!(b.world.particles.v, [[2.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        assert_eq!(b.slot_of("f_f").scalar, 2.0);
        // Radii of 1 and 0.25: ways of 2 and 0.5 in a step at most.
        let style = AtomStyle { sphere: true, sphere_mass: true, ..AtomStyle::default() };
        let mut b = Bench::new(style, &[[0.0; 3]; 2]);
        b.world.clock.dt = 0.5;
        b.world.particles.radius = vec![1.0, 0.25].into();
        b.world.particles.v = vec![[3.0, 0.0, 0.0]; 2].into();
        let fix = b.fix(&NveLimit, "radius 2").unwrap();
        fix.declare(&mut b.world).unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::InitialIntegrate).unwrap();
        assert_eq!(b.world.particles.x, [[1.5, 0.0, 0.0], [0.5, 0.0, 0.0]]);
        for words in ["", "0", "-1", "x", "radius", "radius 0"] {
            assert!(b.fix(&NveLimit, words).is_err(), "{words}");
        }
    }
}
