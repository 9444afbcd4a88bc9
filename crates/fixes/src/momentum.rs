//! fix momentum: removes drift and rotation of a group every N steps.

use super::{Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::{Vec3, add, cross, dot, sub};
use perigrain_base::par;
use perigrain_commands::momentum::rotation;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::matter::{Masses, Whole, check_masses, sum, unwrapped};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::field::{BOX, IMAGE, KIND, MASK, MASS, TYPE_MASS, V, X};
use perigrain_world::{GroupId, World};

/// The style.
pub struct Momentum;

impl Style for Momentum {
    fn name(&self) -> &'static str {
        "momentum"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Takes the drift of a group, its rotation, or both away every N steps.",
            text: "At least one of `linear` and `angular` must be there. Under `-compat lammps` the group's mass is \
                   that of the run's beginning, also once particles have been lost or have come: some of the drift \
                   stays.",
            example: "fix calm plate momentum 10 linear 1 1 0 angular",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Acts at multiples of N [steps].
    #[word(name = "N", what = "the number of steps N", from = 1)]
    every: i64,
    /// The velocity of the centre of mass is taken away along the directions with a 1.
    #[word(keyword, name = "x y z", shown = "0 0 0")]
    linear: [Taken; 3],
    /// The rotation about the centre of mass is taken away, as if the group were rigid.
    #[word(flag)]
    angular: bool,
    /// Velocities are scaled so that the group's kinetic energy of translation stays what it was.
    #[word(flag)]
    rescale: bool,
}

/// Whether something is taken away.
#[derive(Clone, Copy, Default, PartialEq, Words)]
#[word(what = "switch of linear")]
enum Taken {
    #[default]
    #[word("0")]
    No,
    #[word("1")]
    Yes,
}

impl FixStyle for Momentum {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { every, linear, angular, rescale } = read(args, cx)?;
        let linear = linear.map(|taken| taken == Taken::Yes);
        if !linear.contains(&true) && !angular {
            return Err(Diagnostic::error(
                Code::MISSING_ARGUMENT,
                args.here(),
                "nothing would be taken away",
            )
            .help("use `linear 1 1 1`, `angular` or both")
            .into());
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, every, linear, angular, rescale }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    every: i64,
    linear: [bool; 3],
    angular: bool,
    rescale: bool,
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        check_masses(cx.world(), span)?;
        let whole = Whole::mass(cx.world(), self.group);
        let (me, access) =
            (self.clone(), Needs::new().read(X | IMAGE | MASS | MASK | BOX | TYPE_MASS | KIND).write(V));
        let op = StepOp::new(format!("fix {} momentum", self.id), Stage::EndOfStep, access, move |w, _| {
            let before = if me.rescale { energy(w, me.group) } else { 0.0 };
            if me.linear.contains(&true) {
                me.stop_drift(w, whole);
            }
            if me.angular {
                me.stop_rotation(w, whole);
            }
            let after = if me.rescale { energy(w, me.group) } else { 0.0 };
            if after != 0.0 {
                let factor = (before / after).sqrt();
                change(w, me.group, |_, v| v.map(|a| a * factor));
            }
            Ok(())
        });
        Ok(vec![op.when(When::Every(self.every)).boxed()])
    }
}

impl Declared {
    fn stop_drift(&self, w: &mut World, whole: Whole) {
        let masses = Masses::of(w);
        let [mass, momentum @ ..] = sum::<4>(w, self.group, |i| {
            let (v, m) = (w.particles.v[i], masses.get(i));
            [m, m * v[0], m * v[1], m * v[2]]
        });
        let mass = whole.of(mass);
        if mass > 0.0 {
            let drift: Vec3 = std::array::from_fn(|d| if self.linear[d] { momentum[d] / mass } else { 0.0 });
            change(w, self.group, |_, v| sub(v, drift));
        }
    }

    fn stop_rotation(&self, w: &mut World, whole: Whole) {
        let (mass, center) = whole.centre(w, self.group);
        if mass <= 0.0 {
            return;
        }
        let masses = Masses::of(w);
        let [lx, ly, lz, xx, yy, zz, xy, yz, xz] = sum::<9>(w, self.group, |i| {
            let (r, m) = (sub(unwrapped(w, i), center), masses.get(i));
            let l = cross(r, w.particles.v[i]);
            let [x, y, z] = r;
            let diagonal = [m * (y * y + z * z), m * (x * x + z * z), m * (x * x + y * y)];
            [
                m * l[0],
                m * l[1],
                m * l[2],
                diagonal[0],
                diagonal[1],
                diagonal[2],
                -m * x * y,
                -m * y * z,
                -m * x * z,
            ]
        });
        let lammps = w.settings.lammps();
        let omega = rotation([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], [lx, ly, lz], lammps);
        let edges = w.edges();
        let (x, image) = (std::mem::take(&mut w.particles.x), std::mem::take(&mut w.particles.image));
        change(w, self.group, |i, v| {
            let place = add(x[i], edges.shift(image[i].map(f64::from)));
            sub(v, cross(omega, sub(place, center)))
        });
        (w.particles.x, w.particles.image) = (x, image);
    }
}

/// Σ m v² of a group.
fn energy(w: &World, group: GroupId) -> f64 {
    let masses = Masses::of(w);
    let [twice] = sum(w, group, |i| {
        let v = w.particles.v[i];
        [masses.get(i) * dot(v, v)]
    });
    twice
}

/// Gives each particle of a group a new velocity.
fn change(w: &mut World, group: GroupId, new: impl Fn(usize, Vec3) -> Vec3 + Sync) {
    let bit = group.bit();
    let p = &mut w.particles;
    par::each((&mut p.v[..], &p.mask[..]), |start, (v, mask)| {
        for (k, (v, _)) in v.iter_mut().zip(mask).enumerate().filter(|(_, (_, m))| **m & bit != 0) {
            *v = new(start + k, *v);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    /// Four particles of mass 2 that rotate about (0, 0, 0) with ω = (0, 0, 3) and drift along x and y.
    fn scene() -> Bench {
        let places = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.5], [0.0, -1.0, -0.5]];
        let mut b = Bench::new(AtomStyle::default(), &places);
        b.world.particles.v = places
            .iter()
            .map(|r| perigrain_base::math::vec3::add(cross([0.0, 0.0, 3.0], *r), [1.0, 2.0, 0.0]))
            .collect();
        b
    }

    #[test]
    fn drift_and_rotation_go() {
        let mut b = scene();
        let fix = b.fix(&Momentum, "1 linear 1 0 1 angular").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::EndOfStep).unwrap();
        for v in &b.world.particles.v {
            let off = sub(*v, [0.0, 2.0, 0.0]);
            assert!(dot(off, off) < 1e-24, "{v:?}");
        }
    }

    #[test]
    fn rescaling_keeps_the_energy() {
        let mut b = scene();
        let before = energy(&b.world, GroupId::ALL);
        let fix = b.fix(&Momentum, "1 linear 1 1 1 rescale").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::EndOfStep).unwrap();
        let after = energy(&b.world, GroupId::ALL);
        assert!((before / after - 1.0).abs() < 1e-14);
        for words in ["", "0 angular", "1", "1 rescale", "1 linear 1 1", "1 linear 2 1 1", "1 linear 0 0 0"] {
            assert!(b.fix(&Momentum, words).is_err(), "{words}");
        }
    }
}
