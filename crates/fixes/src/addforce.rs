//! fix addforce: a force added to each particle.

use super::{Facts, Fix, FixStyle, Minimizing, region_keyword};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Param, RefKind, ValueRef};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::common::variable_param;
use perigrain_styles::matter::{Chosen, add_virial, change_forces, publish, unwrapped};
use perigrain_styles::step_op::StepOp;
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
            syntax: "fix ID group addforce fx fy fz [every N] [region ID] [energy v_name]",
            summary: "Adds a force to each particle of the group.",
            text: "Each of fx fy fz is a number or `v_name` of an equal- or atom-style variable, evaluated each step; in \
                   force units, for peridynamic particles in LAMMPS' convention force densities. `every N`: only at \
                   multiples of N. `region ID`: only inside. Acts in the setup of a run too. Scalar (extensive): the \
                   potential energy, −Σ f·x with unwrapped positions, or Σ of the atom-style variable after `energy`, \
                   which is refused for constant forces as in LAMMPS; `fix_modify ID energy yes` adds it to the \
                   potential energy. `fix_modify ID virial yes` adds Σ f x (unwrapped) to the virial of pressures. Vector of 3 (extensive): the total force before the change.",
            example: "fix push grains addforce 0.0 0.0 -1.0e-3",
        }
    }
}

impl FixStyle for AddForce {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let force = [variable_param(args, "fx")?, variable_param(args, "fy")?, variable_param(args, "fz")?];
        force.iter().try_for_each(|p| cx.param(p, true))?;
        let mut fix = Declared {
            id: cx.id.to_string(),
            group: cx.group,
            force,
            every: 1,
            region: None,
            energy: None,
            virial: false,
        };
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "every" => fix.every = args.integer_from(1, "the number of steps between two pushes")?,
                "region" => fix.region = Some(region_keyword(args, cx)?),
                "energy" => fix.energy = Some(energy(args, cx, &fix.force)?),
                _ => return Err(args.unknown(word, &["every", "region", "energy"])),
            }
        }
        Ok(Box::new(fix))
    }
}

fn energy(args: &mut Args, cx: &BuildCx, force: &[Param; 3]) -> Result<ValueRef> {
    let word = args.expect("the variable after `energy`")?;
    if force.iter().all(|p| matches!(p, Param::Number(_))) {
        return Err(Diagnostic::error(
            Code::CONFLICT,
            word.span,
            "the energy of a constant force is known already",
        )
        .help("leave `energy …` out: the scalar is then −Σ f·x")
        .into());
    }
    match ValueRef::parse(&word.text, word.span)? {
        Some(r) if r.kind == RefKind::Variable => {
            cx.value(&r, true)?;
            Ok(r)
        }
        _ => fail(
            Code::WRONG_KIND,
            word.span,
            format!("`energy` takes v_name of an atom-style variable, not `{}`", word.text),
        ),
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

    fn modify(&mut self, args: &mut Args, _cx: &BuildCx) -> Result<()> {
        match args.eat("virial") {
            true => args.flag("virial").map(|yes| self.virial = yes),
            false => super::no_option(args),
        }
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, vector: 3, scalar_extensive: true, vector_extensive: true, ..Shape::default() }
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, has_level: true, has_energy: true, ..Facts::default() }
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
