//! compute temp: temperature and the kinetic energy tensor.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, Tick, When};
use perigrain_styles::compute::TemperatureOption;
use perigrain_styles::matter::{Masses, check_masses, count, sum};
use perigrain_styles::step_op::{Wanted, fill_sums};
use perigrain_styles::words::{Given, Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{KIND, MASK, MASS, TYPE_MASS, V};
use perigrain_world::{GroupId, Slot, SlotId, World};

/// The style.
pub struct Temp;

impl Style for Temp {
    fn name(&self) -> &'static str {
        "temp"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Temperature of the group's translation.",
            text: "Scalar (intensive): T = Σ m v² / (dof k_B) with dof = d N − `extra/dof`, where d is the dimension and \
                   `extra/dof` is d unless `compute_modify ID extra/dof n` says otherwise; 0 where dof is not \
                   positive. Vector of 6 (extensive): Σ m v_a v_b for xx yy zz xy xz yz, in energy units. N is counted \
                   anew at each use; only under `-compat lammps` at the beginning of a run unless `compute_modify ID dynamic/dof yes` says \
                   otherwise.",
            example: "compute t all temp",
        }
    }
}

impl ComputeStyle for Temp {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        args.finish()?;
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, rules: Rules::default() }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    rules: Rules,
}

/// How a temperature counts degrees of freedom (`compute_modify`) and stores its results.
#[derive(Clone, Default)]
pub(super) struct Rules {
    /// Degrees of freedom subtracted, if set by the deck.
    pub extra: Option<f64>,
    /// With `-compat lammps`: counted at each use, not at the beginning of a run.
    dynamic: bool,
}

impl Rules {
    /// Takes an option of `compute_modify`.
    pub fn modify(&mut self, option: TemperatureOption) {
        match option {
            TemperatureOption::ExtraDof(count) | TemperatureOption::Extra(count) => self.extra = Some(count),
            TemperatureOption::DynamicDof(yes) | TemperatureOption::Dynamic(yes) => self.dynamic = yes,
        }
    }

    /// The counter for one run.
    pub fn freedom(&self) -> Freedom {
        Freedom { dynamic: self.dynamic, begun: None }
    }
}

/// Stores in the slot the temperature from twice the kinetic energy, its tensor (xx yy zz xy xz yz), both in
/// units of mass × velocity², and the degrees of freedom, which the pressure reads.
pub(super) fn offer(w: &World, out: &mut Slot, twice: f64, tensor: [f64; 6], dof: f64) {
    let units = w.settings.units.constants();
    out.scalar = if dof > 0.0 { twice * (units.mvv2e / (dof * units.boltz)) } else { 0.0 };
    out.vector.clear();
    out.vector.extend(tensor.map(|k| k * units.mvv2e));
    out.inner.clear();
    out.inner.push(dof);
}

/// Degrees of freedom; LAMMPS counts them at the beginning of a run unless `dynamic/dof yes` is set.
pub(super) struct Freedom {
    /// Whether they are counted at each use.
    dynamic: bool,
    /// The count at the beginning of the run.
    begun: Option<f64>,
}

impl Freedom {
    /// The count to use, given the `present` one; `before` is the last output.
    pub fn count(&mut self, w: &World, t: &Tick, present: f64, before: &Slot) -> f64 {
        if !w.settings.lammps() || self.dynamic {
            return present;
        }
        if w.clock.onward {
            return *self.begun.get_or_insert(before.inner.first().copied().unwrap_or(present));
        }
        if t.setup || self.begun.is_none() {
            self.begun = Some(present);
        }
        self.begun.unwrap_or(present)
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { scalar: true, vector: 6, vector_extensive: true, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, extra, span) = (self.group, self.rules.extra, cx.span());
        check_masses(cx.world(), span)?;
        let mut freedom = self.rules.freedom();
        Ok(fill_sums(
            &self.id,
            &Wanted { slot, stage, when },
            V | MASS | MASK | KIND | TYPE_MASS,
            move |w, t, out| {
                let (p, masses) = (&w.particles, Masses::of(w));
                let [mv2, tensor @ ..] = sum::<7>(w, group, |i| {
                    let ([x, y, z], m) = (p.v[i], masses.get(i));
                    let mv2 = (x * x + y * y + z * z) * m;
                    [mv2, m * x * x, m * y * y, m * z * z, m * x * y, m * x * z, m * y * z]
                });
                let dimension = if w.settings.two_dimensional { 2.0 } else { 3.0 };
                let dof =
                    freedom.count(w, t, dimension * count(w, group) as f64 - extra.unwrap_or(dimension), out);
                offer(w, out, mv2, tensor, dof);
                Ok(())
            },
        ))
    }

    fn modify(&mut self, option: &Given<TemperatureOption>, _cx: &BuildCx) {
        self.rules.modify(option.value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::compute::modify;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn temperature_tensor_and_freedom() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 3]);
        b.world.particles.v = vec![[1.0, 2.0, 0.0], [0.0, 0.0, 4.0], [0.0, 0.0, 1.0]].into();
        let mut c = b.compute(&Temp, "").unwrap();
        let slot = b.evaluate(&*c).unwrap();
        // By hand, m = 2: Σ m v² = 44 over 3 · 3 − 3 degrees of freedom.
        assert_eq!((&slot.vector[..], slot.inner[0]), (&[2.0, 8.0, 34.0, 4.0, 0.0, 0.0][..], 6.0));
        assert!((slot.scalar - 44.0 / 6.0).abs() < 1e-14);
        b.modify("extra/dof 1 dynamic/dof yes", |a, cx| modify(&mut *c, a, cx)).unwrap();
        assert!((b.evaluate(&*c).unwrap().scalar - 44.0 / 8.0).abs() < 1e-14);
        b.modify("extra/dof 9", |a, cx| modify(&mut *c, a, cx)).unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().scalar, 0.0);
        assert!(b.modify("thermo no", |a, cx| modify(&mut *c, a, cx)).is_err());
    }
}
