//! fix pour: pours spheres into the scene.

mod rain;
mod sizes;
mod volume;

use super::{Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::molecules::{Inserted, Molecules, Offset};
use perigrain_styles::newcomers::{Account, Ids};
use perigrain_styles::pair::ToCome;
use perigrain_styles::words::{At, Grammar, Kind, Part, Seed, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, Pull, SealCx, Shape, Style};
use perigrain_world::{GroupId, Key, Numbers, World};
use rain::Rain;
use sizes::{Diameters, Sizes};
use std::f64::consts::PI;
use volume::Volume;

/// The style.
pub struct Pour;

impl Style for Pour {
    fn name(&self) -> &'static str {
        "pour"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Pours N spheres into the scene, batch by batch, under gravity.",
            text: "The region is filled to the volume fraction with spheres that touch no other one, and again when \
                   these have fallen out of it, until there are N new ones in `all` and the fix's group. How many and \
                   how often is said when a run begins. Heights are chosen and vertical velocities set as if the \
                   spheres fell in a steady stream from the region's top. Spheres that find no place are made up for \
                   later and warned about at the end of the run. Distances are in box units.\n\n\
                   Molecules each count with the sphere that holds them towards the volume fraction, and `diam` and \
                   `dens` concern them not. LAMMPS counts all as the largest one of a template, so that a later run \
                   pours more than N. `shake` is refused.\n\n\
                   Random numbers and their order are LAMMPS', so that places agree. There must be exactly one `fix \
                   gravity`, constant and along −z (flat: −y). A second run continues where the first one ended, also \
                   after a restart; LAMMPS pours a batch at the first step of every run, and so does perigrain under \
                   `-compat lammps`. Scalar (intensive): how many there are so far.",
            example: "region slot block -0.002 0.002 -0.002 0.002 0.005 0.008 units box\nfix g all gravity 9.81 vector 0 0 -1\n\
                      fix rain grains pour 20 2 4711 region slot diam range 0.0004 0.0006 dens 2500 2500 vol 0.2 50",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The number of spheres.
    #[word(name = "N", from = 0)]
    count: i64,
    /// The type of the spheres; with `mol` 0 is one.
    #[word(name = "type")]
    kind: At<Offset>,
    /// The seed of the random numbers.
    seed: Seed,
    /// Where spheres appear: a block or a cylinder along z, in flat scenes a block.
    #[word(keyword, name = "ID")]
    region: Option<Volume>,
    #[word(keyword, name = "distribution", shown = "one 1")]
    diam: Option<Diameters>,
    #[word(keyword, shown = "max")]
    id: Ids,
    /// The volume fraction to which the region is filled, and how many attempts a batch makes for each of its spheres.
    #[word(keyword, name = "fraction tries", shown = "0.25 50")]
    vol: Option<(At<Filled>, Tries)>,
    /// The velocity of the region, which may rise [velocity].
    #[word(keyword, name = "V", default = 0.0)]
    rate: f64,
    /// Densities are uniform between these bounds [density].
    #[word(keyword, name = "lo hi", what = "the {} density", positive, shown = "1 1")]
    dens: Option<(f64, At<f64>)>,
    /// Velocities across are uniform between these bounds, and vz is that at the region's top [velocity]; in flat scenes
    /// `vel vxlo vxhi vy`.
    #[word(keyword, name = "velocities", shown = "0 0 0 0 0")]
    vel: Option<Drift>,
    /// For particles of other shapes: without effect.
    #[word(flag, placed)]
    ignore: Option<Span>,
    #[word(flatten)]
    molecules: Inserted,
}

/// A volume fraction.
struct Filled(f64);

impl Value for Filled {
    const KIND: Kind = Kind::Number;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let (span, fraction) = (args.here(), args.positive("the volume fraction")?);
        match fraction > 1.0 {
            true => fail(Code::BAD_VALUE, span, format!("a volume fraction is at most 1: {fraction}")),
            false => Ok(Self(fraction)),
        }
    }
}

/// A number of attempts.
struct Tries(u64);

impl Value for Tries {
    const KIND: Kind = Kind::Whole;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.integer_from(1, "the number of attempts").map(|tries| Self(tries as u64))
    }
}

/// Bounds of the velocities across, and the vertical velocity with its place.
struct Drift([[f64; 2]; 2], f64, Span);

impl Value for Drift {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[
            Part::number("vxlo"),
            Part::number("vxhi"),
            Part::number("vylo"),
            Part::number("vyhi"),
            Part::number("vz"),
        ],
        keywords: &[],
        refused: &[],
    });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let flat = cx.world.settings.two_dimensional;
        let x = rising(args, "x velocity")?;
        let y = if flat { [0.0; 2] } else { rising(args, "y velocity")? };
        let span = args.here();
        let fall = args.number(if flat { "the y velocity" } else { "the z velocity" })?;
        Ok(Self([x, y], fall, span))
    }
}

impl FixStyle for Pour {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        if !cx.world.particles.style.sphere {
            return Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, "fix pour needs spheres")
                .help("put `atom_style sphere` (or `hybrid sphere peri`) at the top of the deck")
                .into());
        }
        let line: Line = read(args, cx)?;
        if line.ignore.is_some() {
            let text = "without effect: all particles are spheres or points";
            cx.note(Diagnostic::note(Code::NO_EFFECT, line.ignore, text));
        }
        let Some(volume) = line.region else {
            let d = Diagnostic::error(Code::MISSING_ARGUMENT, args.here(), "fix pour needs `region ID`");
            return Err(d.help("the region where spheres appear: a block or a cylinder along z").into());
        };
        let density = match line.dens {
            Some((lo, hi)) => ordered([lo, hi.value], hi.span, "density")?,
            None => [1.0; 2],
        };
        let (fraction, tries) = line.vol.map_or((0.25, 50), |(filled, tries)| {
            doubt(&filled, cx);
            (filled.value.0, tries.0)
        });
        let Drift(drift, fall, span) = line.vel.unwrap_or(Drift([[0.0; 2]; 2], 0.0, cx.span));
        if fall > 0.0 {
            let text = "a vertical velocity upwards: spheres are let go downwards with it all the same, as in LAMMPS";
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, span, text).help("say it with a minus"));
        }
        Ok(Box::new(Pouring {
            id: cx.id.to_string(),
            group: cx.group,
            count: line.count as u64,
            kind: line.kind.value.0,
            seed: line.seed.0,
            volume,
            sizes: line.diam.map_or(Ok(Sizes::One(0.5)), Sizes::new)?,
            density,
            fraction,
            tries,
            drift,
            fall,
            rate: line.rate,
            ids: line.id,
            molecules: line.molecules.finish(line.kind, None, cx)?,
        }))
    }
}

/// Warns of a volume fraction that spheres at random places do not reach.
fn doubt(filled: &At<Filled>, cx: &BuildCx) {
    if filled.value.0 > 0.6 {
        let text = format!("spheres at random places cannot fill {} of a volume", filled.value.0);
        cx.note(Diagnostic::warning(Code::SUSPICIOUS, filled.span, text).help("0.2 to 0.4 is usual"));
    }
}

/// Two numbers, the second not below the first.
fn rising(args: &mut Args, what: &str) -> Result<[f64; 2]> {
    let lo = args.number(&format!("the smallest {what}"))?;
    let span = args.here();
    ordered([lo, args.number(&format!("the largest {what}"))?], span, what)
}

/// Refuses two numbers of which the second is below the first.
fn ordered([lo, hi]: [f64; 2], span: Span, what: &str) -> Result<[f64; 2]> {
    if lo > hi {
        return fail(Code::BAD_VALUE, span, format!("{what}: {lo} is above {hi}"));
    }
    Ok([lo, hi])
}

/// A declared fix pour.
#[derive(Clone, Debug)]
struct Pouring {
    id: String,
    group: GroupId,
    count: u64,
    kind: u16,
    seed: u32,
    volume: Volume,
    sizes: Sizes,
    density: [f64; 2],
    /// Volume fraction of a batch.
    fraction: f64,
    /// Attempts per sphere.
    tries: u64,
    /// Bounds of the horizontal velocities.
    drift: [[f64; 2]; 2],
    /// Vertical velocity at the top.
    fall: f64,
    /// Vertical velocity of the region.
    rate: f64,
    ids: Ids,
    /// Molecules inserted instead of spheres.
    molecules: Option<Molecules>,
}

impl Pouring {
    fn key(&self) -> Numbers {
        Key::new(&format!("pour/{}", self.id))
    }

    /// The downward acceleration, times LAMMPS' factor from force/mass to acceleration.
    fn gravity(&self, cx: &mut dyn SealCx, span: Span) -> Result<f64> {
        let flat = cx.world().settings.two_dimensional;
        let down = if flat { 1 } else { 2 };
        let pulls = cx.pulls();
        let wrong =
            |text: String, help: &str| Err(Diagnostic::error(Code::INCOMPLETE, span, text).help(help).into());
        let example = if flat {
            "fix g all gravity 9.81 vector 0 -1 0"
        } else {
            "fix g all gravity 9.81 vector 0 0 -1"
        };
        let [pull] = pulls.as_slice() else {
            let text = format!("fix pour needs exactly one fix gravity, and there are {}", pulls.len());
            return wrong(
                text,
                &format!("write for example `{example}`; `disable` after it keeps it from acting"),
            );
        };
        let Pull::Constant(g) = *pull else {
            return wrong(
                "fix pour needs a gravity without variables".into(),
                &format!("write for example `{example}`"),
            );
        };
        let size = (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]).sqrt();
        // LAMMPS' tolerance of the direction.
        if g[down] >= 0.0 || (0..3).any(|d| d != down && g[d].abs() > 1e-3 * size) {
            let axis = if flat { "-y" } else { "-z" };
            return wrong(
                format!("fix pour needs a gravity along {axis}"),
                &format!("write for example `{example}`"),
            );
        }
        Ok(-g[down] * cx.world().settings.units.constants().ftm2v)
    }
}

impl Fix for Pouring {
    fn facts(&self, _: &World) -> Facts {
        Facts { counts_steps: true, makes_particles: true, orthogonal: true, ..Facts::default() }
    }

    fn to_come(&self, w: &World) -> Vec<ToCome> {
        let mask = GroupId::ALL.bit() | self.group.bit();
        if let Some(molecules) = &self.molecules {
            return molecules.to_come(w, mask);
        }
        let radius = self.sizes.smallest();
        let mass = 4.0 / 3.0 * PI * radius.powi(3) * self.density[0];
        vec![ToCome { kind: self.kind, mask, mass, radius }]
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        Account::maker(w, self.seed).store(w, self.key());
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key());
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        let gravity = self.gravity(cx, span)?;
        if let Some(molecules) = &self.molecules {
            molecules.check_rigid(cx)?;
        }
        let log = cx.log();
        let slot = cx.slot(&format!("f_{}", self.id));
        Ok(vec![Box::new(Rain::new(self, cx.world(), gravity, span, slot, &log)?)])
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, ..Shape::default() }
    }
}

#[cfg(test)]
mod tests;
