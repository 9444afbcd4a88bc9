//! fix gravity: the same acceleration for all particles.

use super::{AtRest, Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::four::{Plain, has_avx2};
use perigrain_base::math::lanes::Lanes;
use perigrain_base::math::threes::{self, Threes};
use perigrain_base::math::vec3::Vec3;
use perigrain_lang::{Args, Param};
use perigrain_plan::{BlockSums, Needs, Op, ParticleBlock, Room, Stage, Tick, When};
use perigrain_styles::matter::{check_masses, publish};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Pull, Reading, SealCx, Shape, Style};
use perigrain_world::field::{F, MASK, MASS, SLOTS, X};
use perigrain_world::{GroupId, World};

/// The style.
pub struct Gravity;

impl Style for Gravity {
    fn name(&self) -> &'static str {
        "gravity"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Pulls every particle of the group with the same acceleration.",
            text: "f ← f + m g e, with e the unit vector of the direction. Each parameter is a number or `v_name` of an \
                   equal-style variable, evaluated each step. The particles' mass counts: for peridynamic particles in \
                   LAMMPS' convention that is the density, as f is a force density.\n\n\
                   Scalar (extensive): the potential energy −Σ m g e·x of the positions in the box; `fix_modify ID \
                   energy yes` adds it to the potential energy.",
            example: "fix g all gravity 9.81 vector 0 0 -1",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The acceleration [force/mass].
    g: Param,
    #[word(name = "direction")]
    direction: At<Direction>,
    /// It does not act by itself: other fixes use its acceleration (`fix pour`, `gravity ID` of `fix rigid`).
    #[word(flag)]
    disable: bool,
}

/// Where the acceleration points.
#[derive(Clone, Words)]
#[word(what = "direction", refused = "gradient")]
enum Direction {
    /// Tilted by an angle, in degrees, from −z (in two dimensions −y) towards +x.
    Chute(
        /// The chute's angle.
        #[word(name = "angle")]
        Param,
    ),
    /// Along a direction in spherical angles, in degrees: phi from +x around z, theta from +z (in two dimensions theta from +y; phi
    /// means nothing).
    Spherical(#[word(name = "phi")] Param, #[word(name = "theta")] Param),
    /// Along a vector of any length.
    Vector(#[word(name = "x")] Param, #[word(name = "y")] Param, #[word(name = "z")] Param),
}

impl FixStyle for Gravity {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { g: magnitude, direction: At { value: direction, span, .. }, disable } = read(args, cx)?;
        if let Direction::Vector(Param::Number(x), Param::Number(y), Param::Number(z)) = direction
            && x * x + y * y + z * z == 0.0
        {
            return fail(Code::BAD_VALUE, span, "`vector 0 0 0` has no direction");
        }
        let (id, group) = (cx.id.to_string(), cx.group);
        Ok(Box::new(Declared { id, group, magnitude, direction, disabled: disable }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    magnitude: Param,
    direction: Direction,
    /// Without effect of its own.
    disabled: bool,
}

/// A direction during a run.
#[derive(Clone, Copy)]
enum Pointer {
    Angles { phi: Reading, theta: Reading },
    Chute(Reading),
    Vector([Reading; 3]),
}

impl Pointer {
    /// Whether it is constant.
    fn is_const(self) -> bool {
        match self {
            Pointer::Chute(angle) => angle.is_const(),
            Pointer::Angles { phi, theta } => phi.is_const() && theta.is_const(),
            Pointer::Vector(v) => v.iter().all(Reading::is_const),
        }
    }

    /// The current unit vector.
    fn unit(self, w: &World, flat: bool) -> [f64; 3] {
        match self {
            Pointer::Chute(angle) => turned(0.0, 180.0 - angle.get(w), flat),
            Pointer::Angles { phi, theta } => turned(phi.get(w), theta.get(w), flat),
            Pointer::Vector(v) => {
                let [x, y, z] = v.map(|r| r.get(w));
                let z = if flat { 0.0 } else { z };
                let length = (x * x + y * y + z * z).sqrt();
                [x / length, y / length, z / length]
            }
        }
    }
}

/// The unit vector for spherical angles in degrees.
fn turned(phi: f64, theta: f64, flat: bool) -> [f64; 3] {
    let radian = std::f64::consts::PI / 180.0;
    let (phi, theta) = (radian * phi, radian * theta);
    if flat {
        return [theta.sin(), theta.cos(), 0.0];
    }
    [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
}

/// f ← f + m a for particles whose mask has the bit; returns Σ −m a·x.
fn pulled(f: &mut [Vec3], x: &[Vec3], mass: &[f64], mask: &[u32], bit: u32, a: Vec3) -> f64 {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        // SAFETY: the processor has AVX2.
        return unsafe { pulled_avx2(f, x, mass, mask, bit, a) };
    }
    // SAFETY: the portable form has no requirements.
    unsafe { pulled_in::<Plain>(f, x, mass, mask, bit, a) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn pulled_avx2(f: &mut [Vec3], x: &[Vec3], mass: &[f64], mask: &[u32], bit: u32, a: Vec3) -> f64 {
    // SAFETY: the processor has AVX2.
    unsafe { pulled_in::<perigrain_base::math::four::Avx2>(f, x, mass, mask, bit, a) }
}

/// Four particles at a time; groups of four that are not all in the group one by one.
///
/// # Safety
/// The processor must support the form.
#[inline(always)]
unsafe fn pulled_in<F: Threes>(
    f: &mut [Vec3],
    x: &[Vec3],
    mass: &[f64],
    mask: &[u32],
    bit: u32,
    a: Vec3,
) -> f64 {
    let (mass4, mass1) = mass.as_chunks::<4>();
    let (mask4, mask1) = mask.as_chunks::<4>();
    let (f4, f1) = f.as_chunks_mut::<4>();
    let (x4, x1) = x.as_chunks::<4>();
    let mut energy = pulled_each(f1, x1, mass1, mask1, bit, a);
    // SAFETY (all below): the caller's guarantee; arrays of twelve and of four numbers.
    let (along, mut sum) = unsafe { (threes::repeated::<F>(a), F::splat(0.0)) };
    for (((f, x), m), mask) in f4.iter_mut().zip(x4).zip(mass4).zip(mask4) {
        if mask[0] & mask[1] & mask[2] & mask[3] & bit == 0 {
            energy += pulled_each(f, x, m, mask, bit, a);
            continue;
        }
        unsafe {
            let (m, p) = (F::load(m.as_ptr()), f.as_flattened_mut().as_mut_ptr());
            let (f, depth) =
                pulled_four(threes::load::<F>(p), threes::load(x.as_flattened().as_ptr()), m, along, a);
            threes::store(f, p);
            sum = sum - depth;
        }
    }
    energy + sum.numbers().iter().sum::<f64>()
}

/// f + m a of four particles, and m a·x; `along` repeats a four times.
#[inline(always)]
pub(super) fn pulled_four<F: Threes>(
    [fa, fb, fc]: [F; 3],
    x: [F; 3],
    m: F,
    along: [F; 3],
    a: Vec3,
) -> ([F; 3], F) {
    let ([ma, mb, mc], [x, y, z]) = (m.spread(), F::parted(x));
    let f = [fa + ma * along[0], fb + mb * along[1], fc + mc * along[2]];
    (f, m * (x * a[0] + y * a[1] + z * a[2]))
}

/// [`pulled`], one particle at a time.
#[inline(always)]
pub(super) fn pulled_each(f: &mut [Vec3], x: &[Vec3], mass: &[f64], mask: &[u32], bit: u32, a: Vec3) -> f64 {
    let mut energy = 0.0;
    for (((f, x), m), _) in f.iter_mut().zip(x).zip(mass).zip(mask).filter(|(_, mask)| **mask & bit != 0) {
        for d in 0..3 {
            f[d] += m * a[d];
        }
        energy -= m * (a[0] * x[0] + a[1] * x[1] + a[2] * x[2]);
    }
    energy
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        check_masses(cx.world(), span)?;
        let bit = self.group.bit();
        let mut read = |p: &Param| cx.param(p, Stage::PostForce, &When::Always);
        let magnitude = read(&self.magnitude)?;
        let pointer = match &self.direction {
            Direction::Chute(angle) => Pointer::Chute(read(angle)?),
            Direction::Spherical(phi, theta) => Pointer::Angles { phi: read(phi)?, theta: read(theta)? },
            Direction::Vector(x, y, z) => Pointer::Vector([read(x)?, read(y)?, read(z)?]),
        };
        let acceleration = move |w: &World| -> Vec3 {
            let (g, unit) = (magnitude.get(w), pointer.unit(w, w.settings.two_dimensional));
            unit.map(|e| g * e)
        };
        let steady = (magnitude.is_const() && pointer.is_const()).then(|| acceleration(cx.world()));
        let (slot, disabled) = (cx.slot(&format!("f_{}", self.id)), self.disabled);
        let access = Needs::new().read(X | MASS | MASK).add(F).write(SLOTS);
        if let Some(a) = steady {
            cx.world().slots.get_mut(slot).vector = a.to_vec();
        }
        let pull = move |w: &World, t: &Tick, room: &mut Room| {
            if t.unchanged || disabled {
                return false;
            }
            let a = steady.unwrap_or_else(|| acceleration(w));
            room.pull(perigrain_plan::Pull { bit, a }, move |s: &mut ParticleBlock<'_>| {
                let (mass, mask) = (&s.all.mass[s.start..][..s.x.len()], s.mask());
                let energy = pulled(&mut s.f, &s.x, mass, mask, bit, a);
                BlockSums { sums: [energy, 0.0, 0.0], most: 0.0 }
            });
            true
        };
        // Other styles read the acceleration from the slot (`SealCx::gravities`); decks cannot see it.
        let took = move |w: &mut World, t: &Tick, sums: BlockSums| {
            let a = steady.unwrap_or_else(|| acceleration(w));
            publish(w, slot, t, sums.sums[0], &a);
        };
        let name = format!("fix {} gravity", self.id);
        let idle = move |w: &mut World, t: &Tick| {
            if disabled && !t.unchanged && steady.is_none() {
                publish(w, slot, t, 0.0, &acceleration(w));
            }
            Ok(())
        };
        // An idle gravity needs no rows.
        let op = StepOp::new(name, Stage::PostForce, access, idle).fusing(pull, took).requesting_rows();
        Ok(vec![op.boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, ..Shape::default() }
    }

    fn facts(&self, w: &World) -> Facts {
        let number = |p: &Param| match p {
            Param::Number(a) => Some(Reading::Const(*a)),
            Param::Ref(_) => None,
        };
        let pointer = match &self.direction {
            Direction::Chute(angle) => number(angle).map(Pointer::Chute),
            Direction::Spherical(phi, theta) => {
                number(phi).zip(number(theta)).map(|(phi, theta)| Pointer::Angles { phi, theta })
            }
            Direction::Vector(x, y, z) => {
                number(x).zip(number(y)).zip(number(z)).map(|((x, y), z)| Pointer::Vector([x, y, z]))
            }
        };
        let pull = match (&self.magnitude, pointer) {
            (Param::Number(g), Some(pointer)) => {
                Pull::Constant(pointer.unit(w, w.settings.two_dimensional).map(|e| g * e))
            }
            _ => Pull::Varying,
        };
        let (minimizing, pull) = (Minimizing::Absent, Some(pull));
        let disabled = self.disabled;
        Facts {
            minimizing,
            at_rest: AtRest::Acts,
            pull,
            disabled,
            has_level: true,
            has_energy: true,
            ..Facts::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    fn force(b: &mut Bench, words: &str) -> [f64; 3] {
        b.world.particles.f = vec![[0.0; 3]; 2].into();
        let fix = b.fix(&Gravity, words).unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        b.world.particles.f[0]
    }

    #[test]
    fn directions() {
        let mut b = Bench::new(AtomStyle::default(), &[[1.0, 0.0, 3.0], [0.0, 0.0, -4.0]]);
        b.equal.insert("g".into(), 5.0);
        let near = |a: [f64; 3], e: [f64; 3]| {
            // Angles go through sin and cos: a few ulp of a force of 10.
            assert!((0..3).all(|d| (a[d] - e[d]).abs() < 1e-14), "{a:?} {e:?}")
        };
        // m = 2, g = 5.
        assert_eq!(force(&mut b, "v_g vector 0 0 -3"), [0.0, 0.0, -10.0]);
        assert_eq!(b.slot_of("f_f").scalar, -10.0);
        near(force(&mut b, "5 chute 30"), [5.0, 0.0, -75f64.sqrt()]);
        near(force(&mut b, "5 spherical 90 90"), [0.0, 10.0, 0.0]);
        near(force(&mut b, "5 spherical 12 180"), [0.0, 0.0, -10.0]);
        b.world.settings.two_dimensional = true;
        near(force(&mut b, "5 chute 0"), [0.0, -10.0, 0.0]);
        near(force(&mut b, "5 vector 3 4 100"), [6.0, 8.0, 0.0]);
    }

    #[test]
    fn every_form_pulls_those_of_the_group_alike() {
        let some = |k: usize| -> Vec<Vec3> {
            (0..11).map(|i| [0, 1, 2].map(|d| ((i * 7 + d * 5 + k) % 13) as f64 / 3.0)).collect()
        };
        let (x, mass, a) = (some(1), some(2).iter().map(|m| m[0]).collect::<Vec<_>>(), [0.3, -0.7, 1.1]);
        for mask in [[1; 11], std::array::from_fn(|k| (k % 5) as u32 & 1)] {
            let (mut one, mut each) = (some(3), some(3));
            // SAFETY: the portable form has no requirements.
            let energy = unsafe { pulled_in::<Plain>(&mut one, &x, &mass, &mask, 1, a) };
            let expected = pulled_each(&mut each, &x, &mass, &mask, 1, a);
            assert_eq!(one, each);
            // Eleven terms of about 10, summed in a different order.
            assert!((energy - expected).abs() < 1e-13, "{energy} {expected}");
            let mut wide = some(3);
            assert_eq!(pulled(&mut wide, &x, &mass, &mask, 1, a).to_bits(), energy.to_bits());
            assert_eq!(wide, each);
        }
    }

    #[test]
    fn mistakes_are_named() {
        let b = Bench::new(AtomStyle::default(), &[]);
        for words in
            ["", "1", "1 vector 0 0", "1 vector 0 0 0", "1 gradient 1 1 1 1", "1 chute 2 3", "1 down"]
        {
            assert!(b.fix(&Gravity, words).is_err(), "{words}");
        }
    }
}
