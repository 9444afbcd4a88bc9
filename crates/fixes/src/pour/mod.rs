//! fix pour: pours spheres into the scene.

mod rain;
mod sizes;
mod volume;

use super::{Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::common::{bad_keyword, seed};
use perigrain_styles::molecules::{self, Molecules};
use perigrain_styles::newcomers::{Account, Ids};
use perigrain_styles::pair::ToCome;
use perigrain_styles::{BuildCx, Doc, Pull, SealCx, Shape, Style};
use perigrain_world::{GroupId, Key, Numbers, World};
use rain::Rain;
use sizes::Sizes;
use std::f64::consts::PI;
use volume::Volume;

/// The style.
pub struct Pour;

const KEYWORDS: [&str; 12] =
    ["region", "diam", "id", "vol", "rate", "dens", "vel", "ignore", "mol", "molfrac", "rigid", "shake"];

impl Style for Pour {
    fn name(&self) -> &'static str {
        "pour"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "fix ID group pour N type seed region ID [diam one D | range Dlo Dhi | poly n D1 P1 …] [vol fraction tries] \
                     [dens lo hi] [vel vxlo vxhi vylo vyhi vz] [rate V] [id max|next] [ignore] [mol TEMPLATE [molfrac f1 f2 …] [rigid fixID]]",
            summary: "Pours N spheres into the scene, batch by batch, under gravity.",
            text: "The region is a block or a cylinder along z, in flat scenes a block; it is filled to the volume fraction \
                   `vol` (0.25) with spheres that touch no other one, and again when these have fallen out of it, until there \
                   are N new ones in `all` and the fix's group. How many and how often is said when a run begins. Heights are chosen and vertical velocities set as \
                   if the spheres fell in a steady stream from the region's top, where they have the velocity vz (0; in flat scenes `vel vxlo vxhi vy`); \
                   vx, vy and densities (1) are uniform between bounds. `diam range` is uniform, `poly` gives n diameters by shares of \
                   the number that sum to 1 (default `one 1.0`). A batch makes at most its number times `tries` (50) attempts; spheres that find \
                   no place are made up for later and warned about at the end of the run. `rate` lets the region rise. `id max` continues from the largest id in use, `next` \
                   from the last one given (under `compat lammps` some twice where `create_atoms` makes particles in between, as in LAMMPS). Distances are in box units.\n\n\
                   `mol` pours copies of a molecule template with their bonds in the place of spheres, turned at random; `type` is added to \
                   their types (so 0 is one), each counts with the sphere that holds it towards the volume fraction, and `diam` and \
                   `dens` concern it not. `molfrac`: the shares of the several molecules of a template, equal without (LAMMPS counts all as the largest one, so that a later run \
                   pours more than N). `rigid` names \
                   the fix rigid/small with the same `mol` that moves them as bodies. `shake` is refused.\n\n\
                   Random numbers and their order are LAMMPS', so that places agree. There must be exactly one `fix gravity`, \
                   constant and along −z (flat: −y). A second run continues where the first one ended, also after a \
                   restart; LAMMPS pours a batch at the first step of every run, and so does perigrain under `-compat lammps`. \
                   `ignore` concerns particles of other shapes and \
                   has no effect. Scalar (intensive): how many there are so far.",
            example: "region slot block -0.002 0.002 -0.002 0.002 0.005 0.008 units box\nfix g all gravity 9.81 vector 0 0 -1\n\
                      fix rain grains pour 20 2 4711 region slot diam range 0.0004 0.0006 dens 2500 2500 vol 0.2 50",
        }
    }
}

impl FixStyle for Pour {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        if !cx.world.particles.style.sphere {
            return Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, "fix pour needs spheres")
                .help("put `atom_style sphere` (or `hybrid sphere peri`) at the top of the deck")
                .into());
        }
        let count = args.integer_from(0, "the number of spheres")? as u64;
        let span = args.here();
        let kind = args.integer_from(0, "the type")?;
        let Some(kind) = u16::try_from(kind).ok().filter(|k| usize::from(*k) <= cx.world.types) else {
            let text = format!("there are types 1 to {}, not {kind}", cx.world.types);
            return fail(Code::BAD_VALUE, span, text);
        };
        let seed = seed(args)?;
        let mut pouring = Pouring {
            id: cx.id.to_string(),
            group: cx.group,
            count,
            kind,
            seed,
            volume: Volume::Block([0.0; 3], [0.0; 3]),
            sizes: Sizes::One(0.5),
            density: [1.0; 2],
            fraction: 0.25,
            tries: 50,
            drift: [[0.0; 2]; 2],
            fall: 0.0,
            rate: 0.0,
            ids: Ids::Max,
            molecules: None,
        };
        if !keywords(&mut pouring, args, cx, span)? {
            let d = Diagnostic::error(Code::MISSING_ARGUMENT, args.here(), "fix pour needs `region ID`");
            return Err(d.help("the region where spheres appear: a block or a cylinder along z").into());
        }
        Ok(Box::new(pouring))
    }
}

/// Reads the keywords; returns whether there was a region.
fn keywords(p: &mut Pouring, args: &mut Args, cx: &BuildCx, kind: Span) -> Result<bool> {
    let (mut region, mut molecules) = (false, molecules::Words::default());
    while let Some(word) = args.next() {
        match word.text.as_str() {
            "region" => {
                p.volume = Volume::of(args.expect("the region's ID")?, cx)?;
                region = true;
            }
            "diam" => p.sizes = Sizes::read(args)?,
            "id" => p.ids = Ids::take(args)?,
            "vol" => {
                let span = args.here();
                p.fraction = args.positive("the volume fraction")?;
                if p.fraction > 1.0 {
                    return fail(
                        Code::BAD_VALUE,
                        span,
                        format!("a volume fraction is at most 1: {}", p.fraction),
                    );
                }
                if p.fraction > 0.6 {
                    let text = format!("spheres at random places cannot fill {} of a volume", p.fraction);
                    cx.note(Diagnostic::warning(Code::SUSPICIOUS, span, text).help("0.2 to 0.4 is usual"));
                }
                p.tries = args.integer_from(1, "the number of attempts")? as u64;
            }
            "rate" => p.rate = args.number("the velocity of the region")?,
            "dens" => p.density = rising(args, "density", Args::positive)?,
            "vel" => velocity(p, args, cx)?,
            "ignore" => cx.note(Diagnostic::note(
                Code::NO_EFFECT,
                word.span,
                "without effect: all particles are spheres or points",
            )),
            key if molecules::KEYWORDS.contains(&key) => molecules.take(word, args, cx)?,
            _ => return Err(bad_keyword(args, word, &KEYWORDS, &[])),
        }
    }
    p.molecules = molecules.finish(p.kind, kind, cx)?;
    Ok(region)
}

fn velocity(p: &mut Pouring, args: &mut Args, cx: &BuildCx) -> Result<()> {
    p.drift[0] = rising(args, "x velocity", Args::number)?;
    let flat = cx.world.settings.two_dimensional;
    if !flat {
        p.drift[1] = rising(args, "y velocity", Args::number)?;
    }
    let span = args.here();
    p.fall = args.number(if flat { "the y velocity" } else { "the z velocity" })?;
    if p.fall > 0.0 {
        let text =
            "a vertical velocity upwards: spheres are let go downwards with it all the same, as in LAMMPS";
        cx.note(Diagnostic::warning(Code::SUSPICIOUS, span, text).help("say it with a minus"));
    }
    Ok(())
}

/// Two numbers, the second not below the first.
fn rising<'a>(
    args: &mut Args<'a>,
    what: &str,
    read: fn(&mut Args<'a>, &str) -> Result<f64>,
) -> Result<[f64; 2]> {
    let lo = read(args, &format!("the smallest {what}"))?;
    let span = args.here();
    let hi = read(args, &format!("the largest {what}"))?;
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
