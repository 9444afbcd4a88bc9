//! fix efield: an electric field that acts on charges and dipole moments.

use super::{AtomReference, Facts, Fix, FixStyle, Minimizing, RegionId};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::{add, cross, dot, scale};
use perigrain_lang::{Args, Param, ValueRef};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::common::variable_param;
use perigrain_styles::matter::{Chosen, change_forces, change_torques, publish, unwrapped};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Shape, Style};
use perigrain_world::field::{BOX, CHARGE, F, Fields, IMAGE, MASK, MU, REGIONS, SLOTS, TORQUE, X};
use perigrain_world::{AtomStyle, World};

/// The style.
pub struct Efield;

impl Style for Efield {
    fn name(&self) -> &'static str {
        "efield"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Pulls charges and turns dipole moments by an electric field.",
            text: "Charges feel q E; dipole moments of spheres (`atom_style hybrid sphere dipole`) the torque μ × E, \
                   which turns them where `fix nve/sphere … update dipole` moves the spheres. Acts in the setup of a \
                   run too. Particles feel the field alone: there are no forces between charges or dipoles here.\n\n\
                   Scalar (extensive): the energy −Σ q E·x (unwrapped) − Σ μ·E of a constant field. With variables it \
                   is what `energy` or `potential` gives, or without either, as LAMMPS has it, 0. `fix_modify ID energy \
                   yes` adds it to the potential energy. Vector of 3 (extensive): the total force on charges.",
            example: "units lj\natom_style hybrid sphere dipole\nregion b block 0 4 0 4 0 4\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\nmass 1 1.0\n\
                      set group all diameter 1.0 density 1.0\nset group all dipole 0.0 0.0 0.5\nfix 1 all nve/sphere update dipole\nfix field all efield 1.0 0.0 0.0\nrun 10",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The field [electric field]: numbers, or `v_name` of equal-style variables, for charges alone also of atom-style ones,
    /// evaluated each step.
    #[word(name = "ex ey ez", with = components, kind = Kind::Param)]
    field: [Param; 3],
    /// Only particles inside it.
    #[word(keyword, name = "ID")]
    region: Option<RegionId>,
    /// An atom-style variable with the energy of each particle, where the field has variables.
    #[word(keyword, name = "v_name", what = "`energy`", placed)]
    energy: Option<At<AtomReference>>,
    /// An atom-style variable with the potential at each charge, where the field has variables; it counts before `energy`.
    #[word(keyword, name = "v_name", what = "`potential`", placed)]
    potential: Option<At<AtomReference>>,
}

/// Reads the components of the field.
fn components(args: &mut Args, cx: &BuildCx) -> Result<[Param; 3]> {
    let field = [variable_param(args, "ex")?, variable_param(args, "ey")?, variable_param(args, "ez")?];
    field.iter().try_for_each(|p| cx.param(p, !turns(cx.world.particles.style)))?;
    Ok(field)
}

impl FixStyle for Efield {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let style = cx.world.particles.style;
        if !style.charged && !turns(style) {
            let d =
                Diagnostic::error(Code::WRONG_ORDER, cx.span, "fix efield needs charges or dipole moments");
            return Err(d
                .help("put `atom_style charge` or `atom_style hybrid sphere dipole` at the top of the deck")
                .into());
        }
        let Line { field, region, energy, potential } = read(args, cx)?;
        let constant = field.iter().all(|p| matches!(p, Param::Number(_)));
        let given = [("energy", &energy), ("potential", &potential)];
        if let Some((word, Some(given))) = given.into_iter().find(|(_, given)| constant && given.is_some()) {
            let d = Diagnostic::error(
                Code::CONFLICT,
                given.span,
                format!("the {word} of a constant field is known already"),
            );
            return Err(d.help("leave the word and its value out").into());
        }
        // As in LAMMPS the potential overrides the energy.
        let energy = match (potential, energy) {
            (Some(of), _) => Energy::Given { of: of.value.0, potential: true },
            (None, Some(of)) => Energy::Given { of: of.value.0, potential: false },
            _ if constant => Energy::Own,
            _ => Energy::None,
        };
        let (id, group, region) = (cx.id.to_string(), cx.group, region.map(|r| r.0));
        Ok(Box::new(Declared { id, group, field, region, energy }))
    }
}

/// Whether the field exerts torques.
fn turns(style: AtomStyle) -> bool {
    style.dipole && style.sphere
}

/// Source of the energy.
#[derive(Clone)]
enum Energy {
    /// The energy of a constant field.
    Own,
    /// None: a variable field without an energy variable.
    None,
    /// An atom-style variable: the energy itself, or the potential at the charge.
    Given { of: ValueRef, potential: bool },
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: perigrain_world::GroupId,
    field: [Param; 3],
    region: Option<String>,
    energy: Energy,
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (span, style) = (cx.span(), cx.world().particles.style);
        let chosen = Chosen::new(cx.world(), self.group, self.region.as_deref(), span)?;
        let [x, y, z] = &self.field;
        let mut read = |p: &Param| cx.param(p, Stage::PostForce, &When::Always);
        let field = [read(x)?, read(y)?, read(z)?];
        let given: Option<(Reading, bool)> = match &self.energy {
            Energy::Given { of, potential } => {
                Some((cx.value(of, Stage::PostForce, &When::Always)?, *potential))
            }
            Energy::Own | Energy::None => None,
        };
        let own = matches!(self.energy, Energy::Own);
        let slot = cx.slot(&format!("f_{}", self.id));
        let of = |there: bool, fields: Fields| if there { fields } else { Fields::NONE };
        let reads = X | MASK | REGIONS | of(style.charged, CHARGE | IMAGE | BOX) | of(turns(style), MU);
        let needs =
            Needs::new().read(reads).add(of(style.charged, F)).write(SLOTS | of(turns(style), TORQUE));
        let op = StepOp::new(format!("fix {} efield", self.id), Stage::PostForce, needs, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            // Fields may have other units than force over charge.
            let unit = w.settings.units.field_to_force();
            let at = |w: &World, i: usize| scale(unit, field.map(|r| r.atom(w, i)));
            let mut energy = 0.0;
            let mut total = [0.0; 3];
            if style.charged {
                let [e, force @ ..] = change_forces::<4>(w, &chosen, |w, i, f| {
                    let (q, x) = (w.particles.charge[i], unwrapped(w, i));
                    let force = scale(q, at(w, i));
                    *f = add(*f, force);
                    let energy = match given {
                        _ if own => -dot(force, x),
                        Some((of, potential)) => of.atom(w, i) * if potential { unit * q } else { 1.0 },
                        None => 0.0,
                    };
                    [energy, force[0], force[1], force[2]]
                });
                (energy, total) = (energy + e, force);
            }
            if turns(style) {
                let [e] = change_torques::<1>(w, &chosen, |w, i, torque| {
                    let (mu, field) = (w.particles.mu[i], at(w, i));
                    *torque = add(*torque, cross(mu, field));
                    [-dot(mu, field)]
                });
                energy += if own { e } else { 0.0 };
            }
            publish(w, slot, t, energy, &total);
            Ok(())
        });
        Ok(vec![op.boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, vector: 3, scalar_extensive: true, vector_extensive: true, ..Shape::default() }
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, has_level: true, has_energy: true, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;

    fn scene(style: AtomStyle) -> Bench {
        let mut b = Bench::new(style, &[[1.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
        b.atom.insert("a".into(), vec![-1.0, -2.0]);
        b.equal.insert("e".into(), 2.0);
        b
    }

    #[test]
    fn charges_are_pulled_and_moments_turned() {
        let mut b = scene(AtomStyle { sphere: true, charged: true, dipole: true, ..AtomStyle::default() });
        b.world.particles.charge = vec![0.0, 3.0].into();
        b.world.particles.mu = vec![[0.0, 0.0, 0.5], [0.0; 3]].into();
        let fix = b.fix(&Efield, "2 0 0").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        let p = &b.world.particles;
        // z × x = y.
        assert_eq!((p.f[1], p.torque[0]), ([6.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
        let slot = b.slot_of("f_f");
        assert_eq!((slot.scalar, slot.vector.as_slice()), (-30.0, [6.0, 0.0, 0.0].as_slice()));
        assert!(b.fix(&Efield, "v_a 0 0").is_err() && b.fix(&Efield, "v_e 0 0").is_ok());
    }

    #[test]
    fn what_it_needs_and_mistakes_are_named() {
        let b = scene(AtomStyle { charged: true, ..AtomStyle::default() });
        assert!(
            b.fix(&Efield, "v_a 0 0 energy v_a").is_ok() && b.fix(&Efield, "v_e 0 0 potential v_a").is_ok()
        );
        for words in ["0 0", "1 0 0 energy v_a", "v_e 0 0 energy 2", "1 0 0 regoin r", "NULL 0 0"] {
            assert!(b.fix(&Efield, words).is_err(), "{words}");
        }
        assert!(scene(AtomStyle::default()).fix(&Efield, "1 0 0").is_err());
    }
}
