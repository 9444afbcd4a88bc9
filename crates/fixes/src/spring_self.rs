//! fix spring/self: ties every particle to its initial position by a spring.

use super::{AtRest, Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::{Args, Param};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::matter::{Chosen, change_forces, keep_places, publish, unwrapped};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, PerAtom, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, COLUMNS, F, IMAGE, MASK, SLOTS, X};
use perigrain_world::{GroupId, Registration, Under, Vectors, World};

/// Where the springs are fixed.
static ENDS: Registration = Registration::moved("spring/self/", "", Under::Anchor);

/// The style.
pub struct SpringSelf;

impl Style for SpringSelf {
    fn name(&self) -> &'static str {
        "spring/self"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Ties each particle of the group to the place where it was when the fix was declared.",
            text: "f ← f − K (x − x0), with unwrapped positions. Particles that join the group later are tied where \
                   they are then. Acts in the setup of a run too. Scalar (extensive): the energy Σ K (x − x0)²/2, which \
                   `fix_modify ID energy yes` adds to the potential energy.",
            example: "fix hold foot spring/self 10.0 xy",
        }
    }
    fn registrations(&self) -> &'static [&'static Registration] {
        const { &[&ENDS] }
    }
}

#[derive(Words)]
struct Line {
    /// The stiffness K [force/length]: a number above 0, or `v_name` of an equal- or atom-style variable, evaluated each step.
    #[word(name = "K", what = "the stiffness K")]
    stiffness: At<PerAtom>,
    /// The directions in which particles are tied; without them all three.
    #[word(name = "directions", with = along, kind = <Along as Value>::KIND)]
    along: Option<Along>,
}

/// The directions in which particles are tied.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "direction")]
enum Along {
    Xyz,
    Xy,
    Xz,
    Yz,
    X,
    Y,
    Z,
}

fn along(args: &mut Args, cx: &BuildCx) -> Result<Along> {
    Along::value("direction", args, cx)
}

impl Along {
    fn directions(self) -> [bool; 3] {
        [
            !matches!(self, Along::Yz | Along::Y | Along::Z),
            !matches!(self, Along::Xz | Along::X | Along::Z),
            !matches!(self, Along::Xy | Along::X | Along::Y),
        ]
    }
}

impl FixStyle for SpringSelf {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { stiffness: At { value: PerAtom(stiffness), span, .. }, along } = read(args, cx)?;
        if let Param::Number(k) = stiffness
            && k <= 0.0
        {
            let text = format!("the stiffness K must be greater than zero, not {k}");
            return fail(Code::BAD_VALUE, span, text);
        }
        let along = along.unwrap_or(Along::Xyz).directions();
        let key = ENDS.key(&format!("spring/self/{}", cx.id));
        Ok(Box::new(Declared { id: cx.id.to_string(), key, group: cx.group, stiffness, along }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    key: Vectors,
    group: GroupId,
    stiffness: Param,
    along: [bool; 3],
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        w.columns.remove(self.key);
        keep_places(w, self.key, self.group, unwrapped);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.columns.remove(self.key);
    }

    fn particles_joined(&self, w: &mut World) {
        keep_places(w, self.key, self.group, unwrapped);
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (span, key, along) = (cx.span(), self.key, self.along);
        let chosen = Chosen::new(cx.world(), self.group, None, span)?;
        keep_places(cx.world(), key, self.group, unwrapped);
        let stiffness = cx.param(&self.stiffness, Stage::PostForce, &When::Always)?;
        let slot = cx.slot(&format!("f_{}", self.id));
        let access =
            Needs::new().read(X | IMAGE | MASK | BOX | COLUMNS).add(F).write(SLOTS).only(&[key.text()]);
        let op =
            StepOp::new(format!("fix {} spring/self", self.id), Stage::PostForce, access, move |w, t| {
                if t.unchanged {
                    return Ok(());
                }
                let [energy] = change_forces(w, &chosen, |w, i, f| {
                    let Some(start) = w.columns.get_vector(key) else { return [0.0] };
                    let (x, k) = (unwrapped(w, i), stiffness.atom(w, i));
                    let mut square = 0.0;
                    for d in (0..3).filter(|&d| along[d]) {
                        let away = x[d] - start[i][d];
                        f[d] -= k * away;
                        square += away * away;
                    }
                    [0.5 * k * square]
                });
                publish(w, slot, t, energy, &[]);
                Ok(())
            });
        Ok(vec![op.one_by_one().with_sums().boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, ..Shape::default() }
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
    use perigrain_world::AtomStyle;

    #[test]
    fn springs_remember_the_declaration() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [1.0; 3]]);
        let fix = b.fix(&SpringSelf, "2 xz").unwrap();
        fix.declare(&mut b.world).unwrap();
        b.world.particles.x[0] = [1.0, 1.0, -2.0];
        b.world.particles.f = vec![[0.0; 3]; 2].into();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.world.particles.f, [[-2.0, 0.0, 4.0], [0.0; 3]]);
        assert_eq!(b.slot_of("f_f").scalar, 5.0);
        fix.remove(&mut b.world);
        assert!(b.world.columns.names().is_empty());
        for words in ["", "1 w", "1 x y", "v_no"] {
            let whole = b.fix(&SpringSelf, words);
            assert!(whole.is_err() || words == "1 x y", "{words}");
        }
    }
}
