//! fix wall/harmonic, wall/lj93 and the like: flat walls with normal forces and no friction.

use super::faces::{Face, Spot, Walls, check};
use super::wall_law::{LAWS, Law, numbers};
use super::{AtRest, Facts, Fix, FixStyle, MODIFY, Minimizing, Virial, needs_spheres, options};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, Param};
use perigrain_plan::{Needs, Op, Stage, Tick, When};
use perigrain_styles::matter::{Chosen, add_virial, change_forces, publish};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Alternative, At, Form, Syntax, Units, Words, read};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Shape, Style};
use perigrain_world::field::{F, Fields, MASK, RADIUS, SLOTS, TALLY, X};
use perigrain_world::{GroupId, World};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// The style `wall/` with the law of this number.
pub struct FlatWall(usize);

/// A half-space of points with a 12-6 law.
pub static LJ93: FlatWall = FlatWall(0);
/// Points with a 12-6 law.
pub static LJ126: FlatWall = FlatWall(1);
/// Layers of a lattice.
pub static LJ1043: FlatWall = FlatWall(2);
/// A half-space acting on spheres.
pub static COLLOID: FlatWall = FlatWall(3);
/// Springs.
pub static HARMONIC: FlatWall = FlatWall(4);
/// Morse potential.
pub static MORSE: FlatWall = FlatWall(5);

/// Names of the styles.
const STYLES: [&str; 6] =
    ["wall/lj93", "wall/lj126", "wall/lj1043", "wall/colloid", "wall/harmonic", "wall/morse"];

/// Text and example of each style.
static PAGES: LazyLock<Vec<[String; 2]>> =
    LazyLock::new(|| STYLES.iter().map(|style| page(law_of(style))).collect());

/// The law of a style.
fn law_of(style: &str) -> &'static Alternative {
    let known = LAWS.iter().find(|law| style.strip_prefix("wall/") == Some(law.word));
    known.unwrap_or(&LAWS[0])
}

fn page(law: &Alternative) -> [String; 2] {
    let text = format!(
        "A particle of the group whose centre is at a distance r < cutoff from a wall feels the force −dE/dr away from it; the energy is \
         shifted to 0 at the cutoff. {} {} A particle at the wall or behind it ends the run.\n\n\
         Up to six walls. The place is `EDGE` (the face of the box when the fix is declared: it does not move with the box), a number, or \
         `v_name` of an equal-style variable; so are the numbers of the law (from a variable not negative); variables are evaluated each \
         step.\n\n\
         Scalar (extensive): the energy of all walls; `fix_modify ID energy yes` adds it to the potential energy. Vector (extensive): the \
         force on each wall in the order in which they were named, negative where it is pushed downwards. `fix_modify ID virial yes` adds \
         Σ F r to the virial of pressures across each wall. `fix wall/region` has the same laws for regions.",
        law.about,
        if law.word == "colloid" {
            "A sphere that touches the wall ends the run."
        } else {
            "Sizes of spheres do not count."
        },
    );
    let numbers = match law.word {
        "morse" => "1.0e-6 2000.0 0.001",
        "harmonic" => "1.0e6 0.0",
        _ => "1.0e-6 0.001",
    };
    [text, format!("fix soft grains wall/{} zlo -0.004 {numbers} 0.003 units box", law.word)]
}

impl Style for FlatWall {
    fn name(&self) -> &'static str {
        STYLES[self.0]
    }
    fn doc(&self) -> Doc {
        let [text, example] = &PAGES[self.0];
        Doc {
            syntax: match self.is_morse() {
                true => Syntax::Forms(
                    const { &[Form::behind(Morses::GRAMMAR), Form::headed(MODIFY, Virial::GRAMMAR)] },
                ),
                false => Syntax::Forms(
                    const { &[Form::behind(Wells::GRAMMAR), Form::headed(MODIFY, Virial::GRAMMAR)] },
                ),
            },
            summary: "Flat walls that push and pull particles without friction.",
            text,
            example,
        }
    }
}

#[derive(Words)]
struct Wells {
    #[word(flatten)]
    walls: Walls<Well>,
    #[word(flatten)]
    common: Common,
}

#[derive(Words)]
struct Morses {
    #[word(flatten)]
    walls: Walls<Morse>,
    #[word(flatten)]
    common: Common,
}

/// The numbers of laws with a length and an energy.
#[derive(Words)]
struct Well {
    #[word(what = "epsilon")]
    epsilon: Param,
    #[word(what = "sigma")]
    sigma: Param,
    #[word(positive, what = "the cutoff")]
    cutoff: f64,
}

/// The numbers of the Morse law.
#[derive(Words)]
struct Morse {
    #[word(name = "D0", what = "D0")]
    depth: Param,
    #[word(what = "alpha")]
    alpha: Param,
    #[word(what = "r0")]
    r0: Param,
    #[word(positive, what = "the cutoff")]
    cutoff: f64,
}

#[derive(Words)]
struct Common {
    /// Places, numbers and variables, are in these units; other distances are in those of the box.
    #[word(keyword)]
    units: Units,
    /// Whether faces of a wall's direction may be periodic; distances are not taken across them.
    #[word(keyword, what = "pbc", default = false)]
    pbc: bool,
    /// For LAMMPS' lubrication styles: `yes` is refused.
    #[word(keyword, what = "fld", shown = "no")]
    fld: Option<At<bool>>,
}

impl FlatWall {
    fn is_morse(&self) -> bool {
        self.name() == "wall/morse"
    }
}

impl FixStyle for FlatWall {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let law = law_of(self.name()).word;
        if law == "colloid" {
            needs_spheres(cx, self.name())?;
        }
        let (walls, common): (Vec<_>, _) = if self.is_morse() {
            let line: Morses = read(args, cx)?;
            (line.walls.0.into_iter().map(|(face, push)| (face, push.into())).collect(), line.common)
        } else {
            let line: Wells = read(args, cx)?;
            (line.walls.0.into_iter().map(|(face, push)| (face, push.into())).collect(), line.common)
        };
        no_lubrication(common.fld)?;
        check(&walls, common.pbc, args, cx)?;
        Ok(Box::new(Declared {
            id: cx.id.to_string(),
            group: cx.group,
            law,
            walls,
            scale: common.units.scales(cx.world),
            virial: false,
        }))
    }
}

/// Refuses `fld yes`: no pair style here uses the walls' forces.
fn no_lubrication(fld: Option<At<bool>>) -> Result<()> {
    let Some(fld) = fld.filter(|fld| fld.value) else { return Ok(()) };
    let text = "`fld yes` gives the walls' forces to lubrication styles (pair_style lubricateU), of which there are none here";
    Err(Diagnostic::error(Code::NOT_SUPPORTED, fld.span, text).help("leave it out").into())
}

/// Parameters of the law.
#[derive(Clone)]
struct Push {
    numbers: Vec<Param>,
    cutoff: f64,
}

impl From<Well> for Push {
    fn from(law: Well) -> Self {
        Self { numbers: vec![law.epsilon, law.sigma], cutoff: law.cutoff }
    }
}

impl From<Morse> for Push {
    fn from(law: Morse) -> Self {
        Self { numbers: vec![law.depth, law.alpha, law.r0], cutoff: law.cutoff }
    }
}

/// One wall during a run.
struct Sealed {
    face: Face,
    spot: Spot,
    law: &'static str,
    /// Parameters of the law; `true` marks variables, which must not be negative.
    numbers: Vec<(Reading, bool)>,
    cutoff: f64,
}

/// One wall in this step.
struct PresentWall<'a> {
    face: &'a Face,
    at: f64,
    law: Law,
}

impl Sealed {
    fn present(&self, w: &World, span: Span) -> Result<PresentWall<'_>> {
        let mut given = [0.0; 3];
        for ((to, (from, varies)), what) in given.iter_mut().zip(&self.numbers).zip(numbers(self.law)) {
            *to = from.get(w);
            if *to < 0.0 && *varies {
                let face = self.face.name();
                let text = format!("{what} of the wall `{face}` has become {to}: it must not be negative");
                return fail(Code::BAD_VALUE, span, text);
            }
        }
        Ok(PresentWall {
            face: &self.face,
            at: self.spot.get(w),
            law: Law::new(self.law, given, self.cutoff),
        })
    }
}

impl PresentWall<'_> {
    /// Distance, force away from the wall and energy of a particle.
    #[inline]
    fn push(&self, x: [f64; 3], radius: f64) -> Option<(f64, [f64; 2])> {
        let r = self.face.depth(x, self.at);
        (r < self.law.cutoff).then(|| (r, self.law.at(r, radius)))
    }

    /// Whether a particle has reached the wall or gone through it.
    fn reached(&self, x: [f64; 3], radius: f64) -> bool {
        self.face.depth(x, self.at) <= self.law.least(radius)
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    /// Name of the law.
    law: &'static str,
    walls: Vec<(Face, Push)>,
    /// Scale of positions along each direction.
    scale: [f64; 3],
    /// `fix_modify virial yes`.
    virial: bool,
}

impl Declared {
    fn seal(&self, cx: &mut dyn SealCx) -> Result<Vec<Sealed>> {
        let mut walls = vec![];
        for (face, words) in &self.walls {
            let mut read = |p: &Param| {
                let varies = !matches!(p, Param::Number(_));
                cx.param(p, Stage::PostForce, &When::Always).map(|reading| (reading, varies))
            };
            let numbers = words.numbers.iter().map(&mut read).collect::<Result<Vec<_>>>()?;
            let spot = face.seal(cx, Stage::PostForce, self.scale)?;
            walls.push(Sealed { face: face.clone(), spot, law: self.law, numbers, cutoff: words.cutoff });
        }
        Ok(walls)
    }

    fn needs_radii(&self) -> bool {
        self.law == "colloid"
    }
}

/// The radius of a particle if the law needs it, else 0.
fn radius(w: &World, i: usize, asked: bool) -> f64 {
    if asked { w.particles.radius[i] } else { 0.0 }
}

/// What one particle gets from all walls: energy, the forces on up to six walls, whether it is behind one.
type Got = [f64; 8];

fn push_all(walls: &[PresentWall], x: [f64; 3], radius: f64, f: &mut [f64; 3]) -> Got {
    let mut got = [0.0; 8];
    for (k, wall) in walls.iter().enumerate() {
        let Some((_, [push, energy])) = wall.push(x, radius) else { continue };
        let along = if wall.face.high { -push } else { push };
        f[wall.face.axis] += along;
        got[0] += energy;
        got[1 + k] -= along;
        got[7] += f64::from(u8::from(wall.reached(x, radius)));
    }
    got
}

/// Virial of a particle from all walls: xx yy zz xy xz yz.
fn virial_of(walls: &[PresentWall], x: [f64; 3], radius: f64) -> [f64; 6] {
    let mut virial = [0.0; 6];
    for (wall, (r, [push, _])) in walls.iter().filter_map(|wall| Some((wall, wall.push(x, radius)?))) {
        virial[wall.face.axis] += push * r;
    }
    virial
}

/// The error for a particle that has reached a wall or gone through it.
fn reached(
    w: &World,
    chosen: &Chosen,
    (walls, sized): (&[PresentWall], bool),
    t: &Tick,
    span: Span,
) -> Result<()> {
    let (p, now) = (&w.particles, chosen.resolve(w));
    let behind = |i: usize| walls.iter().find(|wall| wall.reached(p.x[i], radius(w, i, sized)));
    let first = (0..w.n())
        .filter(|&i| now.has(p.mask[i], p.x[i]))
        .filter_map(|i| behind(i).map(|wall| (p.tag[i], i, wall)))
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
        let sized = self.needs_radii();
        let access = Needs::new()
            .read(X | MASK | if sized { RADIUS } else { Fields::NONE })
            .add(F | TALLY)
            .write(SLOTS);
        let op = StepOp::new(
            format!("fix {} wall/{}", self.id, self.law),
            Stage::PostForce,
            access,
            move |w, t| {
                let mut now = vec![];
                for wall in &walls {
                    now.push(wall.present(w, span)?);
                }
                if virial {
                    let of = |w: &World, i: usize| virial_of(&now, w.particles.x[i], radius(w, i, sized));
                    add_virial(w, t, &chosen, of);
                }
                if t.unchanged {
                    return Ok(());
                }
                let behind = AtomicBool::new(false);
                let got: Got = change_forces(w, &chosen, |w, i, f| {
                    let got = push_all(&now, w.particles.x[i], radius(w, i, sized), f);
                    if got[7] != 0.0 {
                        behind.store(true, Ordering::Relaxed);
                    }
                    got
                });
                if w.anywhere(behind.into_inner()) {
                    w.whole(X);
                    reached(w, &chosen, (&now, sized), t, span)?;
                }
                publish(w, slot, t, got[0], &got[1..=now.len()]);
                Ok(())
            },
        );
        Ok(vec![op.one_by_one().with_sums().boxed()])
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        self.virial = options::<Virial>(args, cx)?.virial.unwrap_or(self.virial);
        Ok(())
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

    fn scene() -> Bench {
        let mut b = Bench::new(AtomStyle::default(), &[[3.0, 0.0, 1.0], [5.0, 0.0, 1.0]]);
        b.world.particles.f = vec![[0.0; 3]; 2].into();
        b.equal.insert("n".into(), -1.0);
        b.equal.insert("e".into(), 6.0);
        b
    }

    // At 1 and 3 from the lower wall, which reaches to 4, and at 1 from the upper one: forces 36, 12 and 4,
    // by hand.
    #[test]
    fn pushes_energies_and_forces_on_walls() {
        let mut b = scene();
        let fix = b.fix(&HARMONIC, "xlo 2 v_e 1 4 xhi 6 2 v_e 2 zhi EDGE 1 1 1 units box pbc yes").unwrap();
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
            assert!(b.fix(&HARMONIC, words).is_err(), "{words}");
        }
        for words in ["xlo 3 1 1 1", "xhi 5 1 1 1", "xlo 0 v_n 1 1", "xlo 0 1 v_n 1"] {
            let fix = b.fix(&HARMONIC, &format!("{words} units box pbc yes")).unwrap();
            let mut ops = b.seal(&*fix).unwrap();
            assert!(b.stage(&mut ops, Stage::PostForce).is_err(), "{words}");
        }
        assert!(b.fix(&HARMONIC, "xlo 0 -1 -1 1 units box pbc yes fld no").is_ok());
    }
}
