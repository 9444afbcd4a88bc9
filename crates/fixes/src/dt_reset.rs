//! fix dt/reset: adapts the time step to the fastest particle.

use super::time_step::Follower;
use super::{Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::par;
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::matter::{Masses, check_masses};
use perigrain_styles::words::{At, Kind, Nullable, Syntax, Units, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{F, MASK, MASS, V};
use perigrain_world::{GroupId, RunStyle, World};

/// The style.
pub struct DtReset;

impl Style for DtReset {
    fn name(&self) -> &'static str {
        "dt/reset"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Chooses the time step so that no particle moves further than Xmax in one step.",
            text: "In the setup of a run and every N steps, for each particle: Δt = min(Xmax/|v|, √(2 Xmax m/|f|)), \
                   made smaller by Xmax/|v Δt + ½ f/m Δt²| where that is less than 1. The smallest over the group, \
                   bounded by Tmin and Tmax, is the new step. Elapsed time is the sum of the steps as they were. Scalar \
                   (intensive): the last step at which Δt changed. Where nothing moves and Tmax is `NULL`, Δt stays as \
                   it is (LAMMPS makes it 1e20).\n\n\
                   Under `run_style staggered m N` the step is the long one. Particles of solids make N short ones in \
                   it, and their limit is meant for these: it counts N times. `m auto` chooses the short step by what \
                   bonds stand, so that there it counts once.",
            example: "fix step all dt/reset 10 1.0e-10 1.0e-8 1.0e-6 units box",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The number of steps between two looks [steps].
    #[word(name = "N", from = 1)]
    every: i64,
    /// The shortest step [time]; `NULL`: no bound.
    #[word(name = "Tmin", what = "Tmin")]
    shortest: Nullable<Step>,
    /// The longest step [time]; `NULL`: no bound.
    #[word(name = "Tmax", what = "Tmax")]
    longest: At<Nullable<Step>>,
    /// The way Xmax that no particle exceeds in a step [length]; lattice spacings are those of x.
    #[word(name = "Xmax", what = "Xmax", positive)]
    reach: f64,
    /// The largest change of kinetic energy in a step [energy]: also Δt ≤ E/(|f| |v|).
    #[word(keyword, name = "E", positive)]
    emax: Option<f64>,
    #[word(keyword)]
    units: Units,
}

/// A time step.
struct Step(f64);

impl Value for Step {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.non_negative(what).map(Self)
    }
}

impl FixStyle for DtReset {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { every, shortest, longest, reach, emax: energy, units } = read(args, cx)?;
        let (span, shortest, longest) = (longest.span, shortest.0.map(|t| t.0), longest.value.0.map(|t| t.0));
        if let (Some(a), Some(b)) = (shortest, longest)
            && a >= b
        {
            return fail(Code::BAD_VALUE, span, format!("Tmin must be less than Tmax: {a} is not below {b}"));
        }
        let reach = reach * units.scales(cx.world)[0];
        let rule = Rule { group: cx.group, shortest, longest, reach, energy };
        Ok(Box::new(Declared { follower: Follower::new("dt/reset", cx.id, every), rule }))
    }
}

/// How the step follows from velocities and forces.
#[derive(Clone, Copy, Debug)]
struct Rule {
    group: GroupId,
    shortest: Option<f64>,
    longest: Option<f64>,
    /// Largest displacement in one step [length].
    reach: f64,
    /// Largest change of kinetic energy in one step.
    energy: Option<f64>,
}

impl Rule {
    /// The step for the current velocities and forces.
    fn step(&self, w: &World) -> f64 {
        let (p, masses, bit) = (&w.particles, Masses::of(w), self.group.bit());
        let units = w.settings.units.constants();
        let root = (units.ftm2v * units.mvv2e).sqrt();
        let short = match w.settings.run_style {
            RunStyle::Staggered { ratio: Some(m), rare: false, .. } => m as f64,
            _ => 1.0,
        };
        let solid = |i: usize| {
            w.families.as_ref().is_some_and(|f| f.place.get(i).is_some_and(|place| *place != u32::MAX))
        };
        let chunk = |range: std::ops::Range<usize>| {
            // Limits longer than the longest step, or than the shortest limit so far, have no effect.
            let mut least = self.longest.unwrap_or(f64::INFINITY);
            let mut bounds = self.bounds(least, units.ftm2v, root);
            for i in w.moved_in(range).flatten().filter(|&i| p.mask[i] & bit != 0) {
                let (v, f, mass) = (p.v[i], p.f[i], masses.get(i));
                if longer(square(v), square(f), mass, bounds) {
                    continue;
                }
                let own = self.limit(v, f, units.ftm2v * (1.0 / mass), root);
                let own = if short > 1.0 && solid(i) { short * own } else { own };
                if own < least {
                    (least, bounds) = (own, self.bounds(own, units.ftm2v, root));
                }
            }
            least
        };
        let mut limit = par::reduce(p.len(), chunk, f64::min).unwrap_or(f64::INFINITY);
        w.agree_on_least(&mut limit);
        let mut dt = if limit.is_infinite() && self.longest.is_none() { w.clock.dt } else { limit };
        if let Some(t) = self.shortest {
            dt = dt.max(t);
        }
        if let Some(t) = self.longest {
            dt = dt.min(t);
        }
        dt
    }

    /// Bounds for the squares of velocity, of force over mass, and of velocity times force, below which a
    /// particle's step is longer than `least`: in half the step that each bound alone allows, no particle
    /// moves farther than `reach`. `unit` turns force over mass into acceleration.
    fn bounds(&self, least: f64, unit: f64, root: f64) -> [f64; 3] {
        let half = 2.0 * least;
        let energy = self.energy.map_or(f64::INFINITY, |e| e / (half * root));
        // Far above the rounding error of these operations.
        [self.reach / half, self.reach / (half * least * unit), energy].map(|b| b * b * (1.0 - 1e-9))
    }

    /// The longest step for a particle with velocity `v`, force `f` and inverse mass `a` (times the unit of
    /// force).
    fn limit(&self, v: [f64; 3], f: [f64; 3], a: f64, root: f64) -> f64 {
        let (vsq, fsq) = (square(v), square(f));
        let mut dt = f64::INFINITY;
        if vsq > 0.0 {
            dt = dt.min(self.reach / vsq.sqrt());
        }
        if fsq > 0.0 {
            dt = dt.min((2.0 * self.reach / (a * fsq.sqrt())).sqrt());
        }
        if let Some(energy) = self.energy
            && fsq * vsq > 0.0
        {
            dt = dt.min(energy / (fsq * vsq).sqrt() / root);
        }
        if dt.is_infinite() {
            return dt;
        }
        let way = square(std::array::from_fn(|d| dt * v[d] + 0.5 * dt * dt * a * f[d])).sqrt();
        if way > self.reach { dt * (self.reach / way) } else { dt }
    }
}

/// Whether a particle's step is certainly longer than the one these [`Rule::bounds`] stand for.
#[inline]
fn longer(vsq: f64, fsq: f64, mass: f64, [v, f, both]: [f64; 3]) -> bool {
    vsq < v && fsq < f * (mass * mass) && fsq * vsq < both
}

fn square(u: [f64; 3]) -> f64 {
    u[0] * u[0] + u[1] * u[1] + u[2] * u[2]
}

#[derive(Clone)]
struct Declared {
    follower: Follower,
    rule: Rule,
}

impl Fix for Declared {
    fn facts(&self, _: &World) -> Facts {
        Facts { counts_steps: true, ..Facts::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.follower.declare(w);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        self.follower.remove(w);
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (rule, span) = (self.rule, cx.span());
        check_masses(cx.world(), span)?;
        Ok(self.follower.ops(cx, (V | F | MASS | MASK, true), move |w| Ok(rule.step(w))))
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, ..Shape::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_plan::Stage;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    fn step(b: &mut Bench, words: &str) -> f64 {
        let fix = b.fix(&DtReset, words).unwrap();
        fix.declare(&mut b.world).unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::EndOfStep).unwrap();
        b.world.clock.dt
    }

    fn scene() -> Bench {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        b.world.lattice = perigrain_world::Lattice::none(0.5);
        b
    }

    // m = 2 throughout; limits by hand.
    #[test]
    fn the_fastest_decides() {
        let mut b = scene();
        b.world.particles.v = vec![[3.0, 0.0, 4.0], [0.0; 3]].into();
        assert_eq!(step(&mut b, "1 NULL NULL 0.5 units box"), 0.1);
        assert_eq!(step(&mut b, "1 NULL NULL 1"), 0.1); // lattice spacings of 0.5
        assert_eq!(step(&mut b, "1 NULL 0.05 0.5 units box"), 0.05);
        assert_eq!(step(&mut b, "1 0.2 NULL 0.5 units box"), 0.2);
        b.world.particles.f[1] = [0.0, 100.0, 0.0]; // √(2 · 0.25 · 2 / 100) = 0.1
        b.world.particles.v[0] = [0.0; 3];
        assert!((step(&mut b, "1 NULL NULL 0.25 units box") - 0.1).abs() < 1e-16);
        // v and f parallel: either alone gives 0.1; the displacement 0.75 gives 0.1/3.
        b.world.particles.v[1] = [0.0, 2.5, 0.0];
        assert!((step(&mut b, "1 NULL NULL 0.25 units box") - 0.05).abs() < 1e-16);
        assert!((step(&mut b, "1 NULL NULL 0.25 emax 5 units box") - 0.02).abs() < 1e-16);
    }

    // Many random particles with steps of all sizes: a skipped particle must never be the limiting one.
    #[test]
    fn no_deciding_particle_is_skipped() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 5000]);
        let mut seed = 4711u64;
        let mut number = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        for scale in [1e-3, 1.0, 1e4] {
            for k in 0..5000 {
                b.world.particles.v[k] = [number(), number(), number()];
                b.world.particles.f[k] = [scale * number(), scale * number(), scale * number()];
            }
            for energy in [None, Some(1e-3)] {
                for longest in [None, Some(1e-3), Some(1e3)] {
                    let rule = Rule { group: GroupId::ALL, shortest: None, longest, reach: 0.01, energy };
                    let (masses, p) = (Masses::of(&b.world), &b.world.particles);
                    let own = |i: usize| rule.limit(p.v[i], p.f[i], 1.0 / masses.get(i), 1.0);
                    let all = (0..5000).map(own).fold(f64::INFINITY, f64::min);
                    assert_eq!(rule.step(&b.world), all.min(longest.unwrap_or(f64::INFINITY)), "{rule:?}");
                }
            }
        }
    }

    #[test]
    fn the_last_change_is_remembered() {
        let mut b = scene();
        b.world.clock.step = 7;
        b.world.particles.v[0] = [1.0, 0.0, 0.0];
        step(&mut b, "5 NULL NULL 0.5 units box");
        assert_eq!(b.slot_of("f_f").scalar, 7.0);
        assert_eq!(b.world.memo["dt/reset/f"], [7.0]);
        b.world.particles.v[0] = [0.0; 3];
        assert_eq!(step(&mut b, "5 NULL NULL 0.5"), 0.5); // nothing moves: unchanged
    }

    #[test]
    fn mistakes_are_named() {
        let b = scene();
        for words in [
            "",
            "0 NULL NULL 1",
            "1 2 1 1",
            "1 -1 1 1",
            "1 NULL NULL 0",
            "1 NULL NULL 1 emx 2",
            "1 NULL NULL",
        ] {
            assert!(b.fix(&DtReset, words).is_err(), "{words}");
        }
    }
}
