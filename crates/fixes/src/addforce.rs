//! fix addforce: a force added to each particle.

use super::{AtRest, AtomReference, Facts, Fix, FixStyle, MODIFY, Minimizing, RegionId, Virial, options};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Param, ValueRef};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::matter::{Chosen, add_virial, change_forces, publish, unwrapped};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Form, PerAtom, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Shape, Style};
use perigrain_world::field::{BOX, F, IMAGE, MASK, REGIONS, SLOTS, TALLY, X};
use perigrain_world::{GroupId, World};

/// The style.
pub struct AddForce;

impl Style for AddForce {
    fn name(&self) -> &'static str {
        "addforce"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed(MODIFY, Virial::GRAMMAR)] },
            ),
            summary: "Adds a force to each particle of the group.",
            text: "Acts in the setup of a run too. `fix_modify ID virial yes` adds Σ f x (unwrapped) to the virial of \
                   pressures.\n\n\
                   Scalar (extensive): the potential energy, −Σ f·x with unwrapped positions, or Σ of the variable \
                   behind `energy`; `fix_modify ID energy yes` adds it to the potential energy. Vector of 3 \
                   (extensive): the total force before the change.",
            example: "fix push grains addforce 0.0 0.0 -1.0e-3",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The force on a particle [force], for peridynamic particles in LAMMPS' convention a force density: numbers, or `v_name` of
    /// equal- or atom-style variables, evaluated each step.
    #[word(name = "fx fy fz", what = "{}")]
    force: [PerAtom; 3],
    /// Only at multiples of N.
    #[word(keyword, name = "N", what = "the number of steps between two pushes", from = 1, default = 1)]
    every: i64,
    /// Only particles inside it at that moment.
    #[word(keyword, name = "ID")]
    region: Option<RegionId>,
    /// An atom-style variable with the energy of each particle; refused for constant forces, as in LAMMPS.
    #[word(keyword, name = "v_name", what = "`energy`")]
    energy: Option<At<AtomReference>>,
}

impl FixStyle for AddForce {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        let force = line.force.map(|p| p.0);
        if let Some(energy) =
            line.energy.as_ref().filter(|_| force.iter().all(|p| matches!(p, Param::Number(_))))
        {
            return Err(Diagnostic::error(
                Code::CONFLICT,
                energy.span,
                "the energy of a constant force is known already",
            )
            .help("leave `energy …` out: the scalar is then −Σ f·x")
            .into());
        }
        let (region, energy) = (line.region.map(|r| r.0), line.energy.map(|e| e.value.0));
        let (id, group, every) = (cx.id.to_string(), cx.group, line.every);
        Ok(Box::new(Declared { id, group, force, every, region, energy, virial: false }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    force: [Param; 3],
    every: i64,
    region: Option<String>,
    energy: Option<ValueRef>,
    /// `fix_modify virial yes`.
    virial: bool,
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        let chosen = Chosen::new(cx.world(), self.group, self.region.as_deref(), span)?;
        let when = if self.every == 1 { When::Always } else { When::Every(self.every) };
        let [x, y, z] = &self.force;
        let force = [
            cx.param(x, Stage::PostForce, &when)?,
            cx.param(y, Stage::PostForce, &when)?,
            cx.param(z, Stage::PostForce, &when)?,
        ];
        let energy = match &self.energy {
            Some(r) => Some(cx.value(r, Stage::PostForce, &when)?),
            None => None,
        };
        let (slot, virial) = (cx.slot(&format!("f_{}", self.id)), self.virial);
        let access = Needs::new().read(X | IMAGE | MASK | BOX | REGIONS).add(F | TALLY).write(SLOTS);
        let op = StepOp::new(format!("fix {} addforce", self.id), Stage::PostForce, access, move |w, t| {
            if virial {
                add_virial(w, t, &chosen, |w, i| virial_of(w, &force, i));
            }
            if t.unchanged {
                return Ok(());
            }
            let [e, before @ ..] = change_forces::<4>(w, &chosen, |w, i, f| {
                let before = *f;
                let added = force.map(|r| r.atom(w, i));
                (0..3).for_each(|d| f[d] += added[d]);
                let energy = match energy {
                    Some(r) => r.atom(w, i),
                    None => {
                        let x = unwrapped(w, i);
                        -(added[0] * x[0] + added[1] * x[1] + added[2] * x[2])
                    }
                };
                [energy, before[0], before[1], before[2]]
            });
            publish(w, slot, t, e, &before);
            Ok(())
        });
        Ok(vec![op.one_by_one().with_sums().when(when).boxed()])
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        self.virial = options::<Virial>(args, cx)?.virial.unwrap_or(self.virial);
        Ok(())
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, vector: 3, scalar_extensive: true, vector_extensive: true, ..Shape::default() }
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

/// Virial f x of the added force at the unwrapped position of particle `i`: xx yy zz xy xz yz.
fn virial_of(w: &World, force: &[Reading; 3], i: usize) -> [f64; 6] {
    let (x, [fx, fy, fz]) = (unwrapped(w, i), force.map(|r| r.atom(w, i)));
    [fx * x[0], fy * x[1], fz * x[2], fx * x[1], fx * x[2], fy * x[2]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    fn scene() -> Bench {
        let mut b = Bench::new(AtomStyle::default(), &[[1.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
        b.world.particles.f = vec![[1.0, 2.0, 3.0], [10.0, 20.0, 30.0]].into();
        b.atom.insert("a".into(), vec![-1.0, -2.0]);
        b.equal.insert("e".into(), 7.0);
        b
    }

    #[test]
    fn forces_energy_and_total_before() {
        let mut b = scene();
        b.world.particles.image[1] = [0, 1, 0]; // The box is 20 wide: y = 21 unwrapped.
        let fix = b.fix(&AddForce, "2 v_e v_a").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.world.particles.f, [[3.0, 9.0, 2.0], [12.0, 27.0, 28.0]]);
        let slot = b.slot_of("f_f");
        assert_eq!((slot.scalar, slot.vector.as_slice()), (-159.0, [11.0, 22.0, 33.0].as_slice()));
        let fix = b.fix(&AddForce, "2 v_e v_a energy v_a").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.slot_of("f_f").scalar, -3.0);
    }

    #[test]
    fn mistakes_are_named() {
        let b = scene();
        for words in [
            "0 0",
            "0 NULL 0",
            "1 0 0 energy v_a",
            "v_e 0 0 energy v_e",
            "v_e 0 0 energy 2",
            "1 0 0 every 0",
            "1 0 0 evry 2",
        ] {
            assert!(b.fix(&AddForce, words).is_err(), "{words}");
        }
        let fix = b.fix(&AddForce, "1 0 0 every 5").unwrap();
        assert!(fix.facts(&b.world).has_energy);
    }
}
