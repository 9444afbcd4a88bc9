//! fix indent: a sphere, cylinder, cone or plane that repels particles.

mod form;
mod words;

use super::{AtRest, Facts, Fix, FixStyle, Minimizing};
use form::Form;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Param};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::matter::{Chosen, change_forces, publish};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Units, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, F, MASK, SLOTS, X};
use perigrain_world::{GroupId, World};
use words::Indenter;

/// The style.
pub struct Indent;

impl Style for Indent {
    fn name(&self) -> &'static str {
        "indent"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Pushes particles out of a sphere, cylinder, cone or half-space.",
            text: "Across periodic faces the nearest image counts. Variables are evaluated each step. LAMMPS \
                   22Jul2025's forces of a cone go away from its middle and its energies are negative: so it is under \
                   `-compat lammps`; with `side in` and a point its forces are wrong or no numbers, which is not \
                   reproduced.\n\n\
                   Scalar (extensive): the energy Σ K/3 |r − R|³; `fix_modify ID energy yes` adds it to the potential \
                   energy. Vector of 3 (extensive): the force on the indenter.",
            example: "fix ball all indent 4.0e20 sphere 0.0 0.0 v_z 0.003 units box",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The force constant K [force/length²]: a particle deeper than the surface by d feels the force K d² out of it;
    /// peridynamic particles in LAMMPS' convention take it as a force density.
    #[word(name = "K", non_negative)]
    stiffness: f64,
    #[word(flatten)]
    indenter: Indenter,
    #[word(keyword, shown = "out")]
    side: Side,
    /// Places and radii, but for variables, are in these units: the radius in spacings of x, a cone's in those of its axis.
    #[word(keyword)]
    units: Units,
}

/// On which side of the surface particles are kept.
#[derive(Clone, Copy, Default, PartialEq, Words)]
#[word(what = "side")]
enum Side {
    /// Particles are kept inside.
    In,
    /// Particles are kept outside.
    #[default]
    Out,
}

impl FixStyle for Indent {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { stiffness, indenter: Indenter(form), side, units } = read(args, cx)?;
        let Some(form) = form else {
            return Err(Diagnostic::error(Code::MISSING_ARGUMENT, args.here(), "the indenter has no shape")
                .help(
                    "write `sphere x y z R`, `cylinder dim c1 c2 R`, `cone dim c1 c2 radlo radhi lo hi` or `plane dim pos \
                     lo|hi`",
                )
                .into());
        };
        if let Form::Cone { .. } = &form {
            cx.fault(cx.span, "a cone pushes away from its middle, with negative energies", false);
        }
        let (form, inside) = (scaled(&form, units.scales(cx.world))?, side == Side::In);
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, stiffness, form, inside }))
    }
}

/// Scales numbers to box units; variables stay.
fn scaled(form: &Form<Param>, scale: [f64; 3]) -> Result<Form<Param>> {
    form.map(|p, axis| {
        Ok(match p {
            Param::Number(a) => Param::Number(a * scale[axis]),
            p => p.clone(),
        })
    })
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    stiffness: f64,
    form: Form<Param>,
    inside: bool,
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        let chosen = Chosen::new(cx.world(), self.group, None, span)?;
        let form = self.form.map(|p, _| cx.param(p, Stage::PostForce, &When::Always))?;
        let (k, inside) = (self.stiffness, self.inside);
        let slot = cx.slot(&format!("f_{}", self.id));
        let access = Needs::new().read(X | MASK | BOX).add(F).write(SLOTS);
        let op = StepOp::new(format!("fix {} indent", self.id), Stage::PostForce, access, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            let body = form.present(w)?;
            let lammps = w.settings.lammps();
            let domain = w.domain.clone();
            let repeats = domain.as_ref().filter(|b| (0..3).any(|k| b.boundary.periodic(k)));
            let [energy, reaction @ ..] = change_forces::<4>(w, &chosen, |w, i, f| {
                let Some((push, energy)) = body.push(repeats, w.particles.x[i], k, inside, lammps) else {
                    return [0.0; 4];
                };
                (0..3).for_each(|d| f[d] += push[d]);
                [energy, -push[0], -push[1], -push[2]]
            });
            publish(w, slot, t, energy, &reaction);
            Ok(())
        });
        Ok(vec![op.one_by_one().with_sums().boxed()])
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

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::{AtomStyle, Lattice};

    /// The force on a particle at (3, 0, 1), and the indenter's energy and force.
    fn force(b: &mut Bench, words: &str) -> ([f64; 3], f64, Vec<f64>) {
        b.world.particles.f = vec![[0.0; 3]].into();
        let fix = b.fix(&Indent, words).unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        let slot = b.slot_of("f_f");
        (b.world.particles.f[0], slot.scalar, slot.vector.clone())
    }

    fn scene() -> Bench {
        let mut b = Bench::new(AtomStyle::default(), &[[3.0, 0.0, 1.0]]);
        b.equal.insert("z".into(), 1.0);
        b.equal.insert("n".into(), -1.0);
        b.world.lattice = Lattice::none(0.5);
        b
    }

    // Depth 2 (unless noted), K = 6: force 24, energy 6/3 · 8 = 16, by hand.
    #[test]
    fn shapes_and_sides() {
        let mut b = scene();
        let (out, energy, reaction) = force(&mut b, "6 sphere 0 0 v_z 5 units box");
        assert_eq!((out, energy, reaction), ([24.0, 0.0, 0.0], 16.0, vec![-24.0, 0.0, 0.0]));
        assert_eq!(force(&mut b, "6 sphere 0 0 v_z 1 side in units box").0, [-24.0, 0.0, 0.0]);
        assert_eq!(force(&mut b, "6 sphere 0 0 v_z 1 units box").0, [0.0; 3]);
        assert_eq!(force(&mut b, "6 cylinder y 0 v_z 5 units box").0, [24.0, 0.0, 0.0]);
        assert_eq!(force(&mut b, "6 cylinder z 0 0 5 units box").0, [24.0, 0.0, 0.0]);
        assert_eq!(force(&mut b, "6 plane z 3 lo units box").0, [0.0, 0.0, 24.0]);
        assert_eq!(force(&mut b, "6 plane z -1 hi units box").0, [0.0, 0.0, -24.0]);
        assert_eq!(force(&mut b, "6 plane z 3 hi units box").0, [0.0; 3]);
        assert_eq!(force(&mut b, "6 sphere 3 0 v_z 5 units box").0, [0.0; 3]);
        // Cones of constant radius: cylinders with ends.
        assert_eq!(force(&mut b, "6 cone z 0 0 5 5 -9 9 units box").0, [24.0, 0.0, 0.0]);
        assert_eq!(force(&mut b, "6 cone z 0 0 1 1 -9 9 side in units box").0, [-24.0, 0.0, 0.0]);
        assert_eq!(force(&mut b, "6 cone z 0 0 5 5 -3 9 units box").0, [24.0, 0.0, 0.0]);
        assert_eq!(force(&mut b, "6 cone z 0 0 9 9 -1 9 units box").0, [0.0, 0.0, -24.0]);
        // In lattice spacings of 0.5.
        assert_eq!(force(&mut b, "6 sphere 0 0 2 10").0, [24.0, 0.0, 0.0]);
        // The box repeats after 20: the sphere's image at -18 is 5 from x = -13 and overlaps x = 3 by 2.
        assert_eq!(force(&mut b, "6 sphere 20 0 v_z 5 units box").0, [24.0, 0.0, 0.0]);
    }

    #[test]
    fn mistakes_are_named() {
        let mut b = scene();
        for words in [
            "",
            "-1 sphere 0 0 0 1",
            "1",
            "1 sphere 0 0 0",
            "1 sphere 0 0 0 -1",
            "1 cone x 0 0 1 2 3 3",
            "1 cone x 0 0 1 -2 3 4",
            "1 cone x 0 0 1 2 3",
            "1 plane w 0 lo",
            "1 plane x 0 up",
            "1 sphere 0 0 0 1 plane x 0 lo",
            "1 sphere 0 0 0 1 unit box",
            "1 sphere 0 0 v_q 1",
        ] {
            assert!(b.fix(&Indent, words).is_err(), "{words}");
        }
        let fix = b.fix(&Indent, "1 sphere 0 0 0 v_n").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        assert!(b.stage(&mut ops, Stage::PostForce).is_err());
    }
}
