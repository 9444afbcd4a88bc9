//! fix wall/harmonic: flat walls that push with a spring.

use super::faces::{Face, Spot, check};
use super::{Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, Param};
use perigrain_plan::{Needs, Op, Stage, Tick, When};
use perigrain_styles::common::{scales, units_lattice, variable_param};
use perigrain_styles::matter::{Chosen, change_forces, publish, sum};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Shape, Style};
use perigrain_world::field::{F, MASK, SLOTS, TALLY, X};
use perigrain_world::{GroupId, World};

/// The style.
pub struct WallHarmonic;

impl Style for WallHarmonic {
    fn name(&self) -> &'static str {
        "wall/harmonic"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "fix ID group wall/harmonic xlo|xhi|ylo|yhi|zlo|zhi EDGE|place epsilon sigma cutoff … \
                     [units lattice|box] [pbc yes|no]",
            summary: "Flat walls that push particles away like a spring.",
            text: "A particle of the group whose centre is at a distance r < cutoff from a wall has the energy ε (r − cutoff)² \
                   and feels the force 2 ε (cutoff − r) away from it; sizes of spheres do not count. Up to six walls, each named by the face on \
                   whose side it stands: `zlo` pushes upwards, `zhi` downwards. The place is `EDGE` (the face of the box \
                   when the fix is declared: it does not move with the box), a number, or `v_name` of an equal-style variable; so is ε [energy/distance², not negative from a variable]; \
                   variables are evaluated each step. Places, numbers or variables, are in lattice spacings unless `units box`; the \
                   cutoff [distance] is not. Sigma has no meaning here and may be any number or variable not below zero. Who is at \
                   the wall or behind it ends the run. Faces of a wall's direction must not be periodic unless `pbc yes`; distances \
                   are not taken across them. Scalar (extensive): the energy of all walls; `fix_modify ID energy yes` adds \
                   it to the potential energy. Vector (extensive): the force on each wall in the order in which they were named, \
                   negative where it is pushed downwards. `fix_modify ID virial yes` adds Σ 2 ε (cutoff − r) r to the virial \
                   of pressures across each wall. \
                   `fld yes` is for LAMMPS' lubrication styles and refused.",
            example: "fix soft grains wall/harmonic zlo -0.004 1.0e6 0.0 0.002 units box",
        }
    }
}

const KEYWORDS: &[&str] = &["xlo", "xhi", "ylo", "yhi", "zlo", "zhi", "units", "fld", "pbc"];

impl FixStyle for WallHarmonic {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let (mut faces, mut springs, mut lattice, mut through) = (vec![], vec![], true, false);
        while let Some(word) = args.next() {
            if let Some(face) = Face::read(word, &faces, args, cx)? {
                faces.push(face);
                springs.push(Spring::read(args, cx)?);
                continue;
            }
            match word.text.as_str() {
                "units" => lattice = units_lattice(args)?,
                "pbc" => through = args.flag("pbc")?,
                "fld" => no_lubrication(args)?,
                _ => return Err(args.unknown(word, KEYWORDS)),
            }
        }
        check(&faces, through, args, cx)?;
        Ok(Box::new(Declared {
            id: cx.id.to_string(),
            group: cx.group,
            walls: faces.into_iter().zip(springs).collect(),
            scale: scales(cx.world, lattice),
            virial: false,
        }))
    }
}

/// `fld yes` makes no sense without a pair style that asks for the walls' forces.
fn no_lubrication(args: &mut Args) -> Result<()> {
    let span = args.here();
    if args.flag("fld")? {
        let text = "`fld yes` gives the walls' forces to lubrication styles (pair_style lubricateU), of which there are none here";
        return Err(Diagnostic::error(Code::NOT_SUPPORTED, span, text).help("leave it out").into());
    }
    Ok(())
}

/// What pushes.
#[derive(Clone)]
struct Spring {
    stiffness: Param,
    /// Without meaning, but a variable's value is looked at.
    size: Param,
    cutoff: f64,
}

impl Spring {
    fn read(args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let stiffness = variable_param(args, "epsilon")?;
        let size = variable_param(args, "sigma")?;
        cx.param(&stiffness, false)?;
        cx.param(&size, false)?;
        Ok(Self { stiffness, size, cutoff: args.positive("the cutoff")? })
    }
}

/// One wall as it is read during a run.
struct Sealed {
    face: Face,
    spot: Spot,
    stiffness: Reading,
    size: Reading,
    cutoff: f64,
    /// Whether ε and sigma are variables, which must not be negative.
    varies: [bool; 2],
}

/// One wall now.
struct Now<'a> {
    face: &'a Face,
    at: f64,
    stiffness: f64,
    cutoff: f64,
}

impl Sealed {
    fn now(&self, w: &World, span: Span) -> Result<Now<'_>> {
        let stiffness = self.stiffness.get(w);
        let values = [("epsilon", stiffness), ("sigma", self.size.get(w))];
        let mut varying = values.iter().zip(self.varies).filter(|(_, varies)| *varies);
        if let Some(((what, value), _)) = varying.find(|((_, value), _)| *value < 0.0) {
            let face = self.face.name();
            let text = format!("{what} of the wall `{face}` has become {value}: it must not be negative");
            return fail(Code::BAD_VALUE, span, text);
        }
        Ok(Now { face: &self.face, at: self.spot.get(w), stiffness, cutoff: self.cutoff })
    }
}

impl Now<'_> {
    /// Distance and push (a size) of a particle there.
    #[inline]
    fn push(&self, x: [f64; 3]) -> Option<(f64, f64)> {
        let r = self.face.depth(x, self.at);
        (r < self.cutoff).then_some((r, 2.0 * self.stiffness * (self.cutoff - r)))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    walls: Vec<(Face, Spring)>,
    /// Of places along each direction.
    scale: [f64; 3],
    /// `fix_modify virial yes`.
    virial: bool,
}

impl Declared {
    fn seal(&self, cx: &mut dyn SealCx) -> Result<Vec<Sealed>> {
        let mut walls = vec![];
        for (face, spring) in &self.walls {
            let mut read = |p: &Param| cx.param(p, Stage::PostForce, &When::Always);
            let [stiffness, size] = [read(&spring.stiffness)?, read(&spring.size)?];
            let spot = face.seal(cx, Stage::PostForce, self.scale)?;
            let varies = [&spring.stiffness, &spring.size].map(|p| matches!(p, Param::Ref(_)));
            walls.push(Sealed { face: face.clone(), spot, stiffness, size, cutoff: spring.cutoff, varies });
        }
        Ok(walls)
    }
}

/// What one particle gets of all walls: energy, the forces on up to six walls, whether it is behind one.
type Got = [f64; 8];

fn push_all(walls: &[Now], x: [f64; 3], f: &mut [f64; 3]) -> Got {
    let mut got = [0.0; 8];
    for (k, wall) in walls.iter().enumerate() {
        let Some((r, push)) = wall.push(x) else { continue };
        let along = if wall.face.high { -push } else { push };
        f[wall.face.axis] += along;
        got[0] += 0.5 * push * (wall.cutoff - r);
        got[1 + k] -= along;
        got[7] += f64::from(u8::from(r <= 0.0));
    }
    got
}

/// The virial that a particle gets of all walls: xx yy zz.
fn virial_of(walls: &[Now], x: [f64; 3]) -> [f64; 3] {
    let mut virial = [0.0; 3];
    for (wall, (r, push)) in walls.iter().filter_map(|wall| Some((wall, wall.push(x)?))) {
        virial[wall.face.axis] += push * r;
    }
    virial
}

/// Adds the walls' virial to the sums that are wanted.
fn tally(w: &mut World, chosen: &Chosen, walls: &[Now], t: &Tick) {
    let p = &w.particles;
    let now = chosen.now(w);
    let one = |i: usize| if now.has(p.mask[i], p.x[i]) { virial_of(walls, p.x[i]) } else { [0.0; 3] };
    if t.virial {
        let total = sum::<3>(&p.mask, GroupId::ALL, one);
        (0..3).for_each(|d| w.tally.fixes[d] += total[d]);
    }
    if t.atom_virial {
        let mut atoms = std::mem::take(&mut w.tally.atom_fixes);
        let (p, now) = (&w.particles, chosen.now(w));
        for (i, own) in atoms.iter_mut().enumerate().filter(|(i, _)| now.has(p.mask[*i], p.x[*i])) {
            let added = virial_of(walls, p.x[i]);
            (0..3).for_each(|d| own[d] += added[d]);
        }
        w.tally.atom_fixes = atoms;
    }
}

/// The refusal of a particle that has come to a wall or gone through.
fn reached(w: &World, chosen: &Chosen, walls: &[Now], t: &Tick, span: Span) -> Result<()> {
    let (p, now) = (&w.particles, chosen.now(w));
    let behind = |x: [f64; 3]| walls.iter().find(|wall| wall.face.depth(x, wall.at) <= 0.0);
    let first = (0..w.n())
        .filter(|&i| now.has(p.mask[i], p.x[i]))
        .filter_map(|i| behind(p.x[i]).map(|wall| (p.tag[i], i, wall)))
        .min_by_key(|(id, ..)| *id);
    let Some((id, i, wall)) = first else { return Ok(()) };
    let [x, y, z] = p.x[i];
    let text = format!(
        "particle {id} at ({x}, {y}, {z}) has reached the wall `{}` at {} in step {}",
        wall.face.name(),
        wall.at,
        t.step
    );
    Err(Diagnostic::error(Code::BAD_VALUE, span, text)
        .help("a greater epsilon or cutoff holds it back")
        .into())
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        let chosen = Chosen::new(cx.world(), self.group, None, span)?;
        let walls = self.seal(cx)?;
        let (slot, virial) = (cx.slot(&format!("f_{}", self.id)), self.virial);
        let access = Needs::new().read(X | MASK).add(F | TALLY).write(SLOTS);
        let op =
            StepOp::new(format!("fix {} wall/harmonic", self.id), Stage::PostForce, access, move |w, t| {
                let mut now = vec![];
                for wall in &walls {
                    now.push(wall.now(w, span)?);
                }
                if virial {
                    tally(w, &chosen, &now, t);
                }
                if t.unchanged {
                    return Ok(());
                }
                let got: Got = change_forces(w, &chosen, |w, i, f| push_all(&now, w.particles.x[i], f));
                if got[7] != 0.0 {
                    reached(w, &chosen, &now, t, span)?;
                }
                publish(w, slot, t, got[0], &got[1..=now.len()]);
                Ok(())
            });
        Ok(vec![op.boxed()])
    }

    fn modify(&mut self, args: &mut Args, _cx: &BuildCx) -> Result<()> {
        match args.eat("virial") {
            true => args.flag("virial").map(|yes| self.virial = yes),
            false => super::no_option(args),
        }
    }

    fn shape(&self) -> Shape {
        Shape {
            scalar: true,
            vector: self.walls.len(),
            scalar_extensive: true,
            vector_extensive: true,
            ..Shape::default()
        }
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, has_level: true, has_energy: true, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    fn scene() -> Bench {
        let mut b = Bench::new(AtomStyle::default(), &[[3.0, 0.0, 1.0], [5.0, 0.0, 1.0]]);
        b.world.particles.f = vec![[0.0; 3]; 2].into();
        b.equal.insert("n".into(), -1.0);
        b.equal.insert("e".into(), 6.0);
        b
    }

    // At 1 and 3 from the lower wall, which reaches 4, and at 1 from the upper one: pushes 36, 12 and 4, by hand.
    #[test]
    fn pushes_energies_and_forces_on_walls() {
        let mut b = scene();
        let fix =
            b.fix(&WallHarmonic, "xlo 2 v_e 1 4 xhi 6 2 v_e 2 zhi EDGE 1 1 1 units box pbc yes").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.world.particles.f, [[36.0, 0.0, 0.0], [8.0, 0.0, 0.0]]);
        let slot = b.slot_of("f_f");
        // 6 (3² + 1²) + 2 · 1².
        assert_eq!((slot.scalar, slot.vector.as_slice()), (62.0, [-48.0, 4.0, 0.0].as_slice()));
    }

    #[test]
    fn mistakes_are_named() {
        let mut b = scene();
        for words in [
            "",
            "units box",
            "xlo 1 1 1 1",
            "xlo 1 1 1 pbc yes",
            "xlo 1 1 1 0 pbc yes",
            "xlo 1 1 1 v_e pbc yes",
            "xlo 1 1 1 1 xlo 2 1 1 1 pbc yes",
            "xlo 1 v_q 1 1 pbc yes",
            "xlo 1 1 1 1 pbc yes fld yes",
            "xlo 1 1 1 1 pbc yes side in",
        ] {
            assert!(b.fix(&WallHarmonic, words).is_err(), "{words}");
        }
        for words in ["xlo 3 1 1 1", "xhi 5 1 1 1", "xlo 0 v_n 1 1", "xlo 0 1 v_n 1"] {
            let fix = b.fix(&WallHarmonic, &format!("{words} units box pbc yes")).unwrap();
            let mut ops = b.seal(&*fix).unwrap();
            assert!(b.stage(&mut ops, Stage::PostForce).is_err(), "{words}");
        }
        assert!(b.fix(&WallHarmonic, "xlo 0 -1 -1 1 units box pbc yes fld no").is_ok());
    }
}
