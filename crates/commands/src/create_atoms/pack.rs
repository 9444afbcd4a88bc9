//! `create_atoms … pack`, `opal` and `aggregate`: their words, and the summary of the packing.

mod words;

use super::packing::aggregate::{LINK, thin};
use super::packing::pores::{Axis, Pores};
use super::packing::room::Room;
use super::packing::sizes::{Amount, Sizes};
use super::packing::{Goal, Packing, THROUGH, pack};
use super::places::New;
use super::words::Joined;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_base::math::rng::ParkMiller;
use perigrain_lang::Word;
use perigrain_styles::common::{self, orthogonal};
use perigrain_styles::words::{At, Or, Seed};
use perigrain_styles::{ActCx, BuildCx};
use perigrain_world::{Domain, Region};
use std::f64::consts::PI;
pub use words::{Aggregate, Opal, Plain};
use words::{Distribution, OneSize, Share};

/// Rounds by default.
const ROUNDS: usize = 1000;
/// No spheres of sizes that are at all alike are denser (equal ones reach 0.7405, on a lattice).
const DENSEST: f64 = 0.75;
/// A packing whose diameters must become smaller than so much of what they should be has failed.
const SMALLEST: f64 = 0.9;
/// Spheres that reach so far through walls are worth a line.
const REPORTED: f64 = 1e-3;

/// A parsed line.
pub struct Pack {
    form: Form,
    region: Region,
    name: Word,
    fill: Fill,
    share_span: Span,
    seed: u32,
    sizes: Sizes,
    /// The types of a mixture's sizes, where they have their own.
    types: Vec<u16>,
    sizes_span: Span,
    goal: Goal,
}

/// How full the region is to be.
#[derive(Clone, Copy)]
enum Fill {
    /// The part of the volume that spheres have.
    Share(f64),
    /// So many spheres.
    Number(usize),
}

/// What is made of the packing.
enum Form {
    /// Nothing else.
    Plain,
    /// Walls round pores.
    Opal {
        diameter: f64,
        /// In diameters.
        spacing: f64,
        axis: Axis,
        span: Span,
    },
    /// What is left of it.
    Aggregate { porosity: f64, wavelength: f64, spans: [Span; 2] },
}

/// The region of a packing, which spheres can be packed in.
fn region(name: &Word, style: &Word, cx: &BuildCx) -> Result<Region> {
    spheres(style, cx)?;
    let region = cx.region(name)?.clone();
    refuse_region(name, &region, common::domain(cx)?)?;
    if style.text != "pack" && common::domain(cx)?.tilted() {
        return Err(orthogonal(&format!("create_atoms {}", style.text)).at(name.span));
    }
    Ok(region)
}

/// Sizes of spheres with their types, and where they stand; `style` where nothing says them.
fn sizes(given: Option<At<Distribution>>, style: &Word) -> Result<(Sizes, Vec<u16>, Span)> {
    let Some(At { value, span, .. }) = given else { return Ok((Sizes::Mono(1.0), vec![], style.span)) };
    value.parts().map(|(sizes, types, last)| (sizes, types, span.to(last)))
}

/// The same of spheres that are all alike.
fn alike(given: Option<At<OneSize>>) -> Option<At<Distribution>> {
    given.map(|At { value: OneSize::Mono(d), span, unknown }| At {
        value: Distribution::Mono(d),
        span,
        unknown,
    })
}

impl Plain {
    /// The packing, and the group that spheres join.
    ///
    /// # Errors
    /// What does not go together, here and below.
    pub fn read(self, style: &Word, cx: &BuildCx) -> Result<(Pack, Joined)> {
        let Self { region: name, fill, seed: Seed(seed), sizes: given, effort, joined } = self;
        let region = region(&name, style, cx)?;
        let (sizes, types, sizes_span) = sizes(given, style)?;
        let (share_span, fill, form) = (fill.span, fill.value.into(), Form::Plain);
        let goal = Goal { overlap: effort.overlap, rounds: effort.rounds };
        Ok((Pack { form, region, name, fill, share_span, seed, sizes, types, sizes_span, goal }, joined))
    }
}

impl Opal {
    /// The packing, and the group that spheres join.
    pub fn read(self, style: &Word, cx: &BuildCx) -> Result<(Pack, Joined)> {
        let Self { region, diameter, spacing, fill, seed, sizes, axis, effort, joined } = self;
        let (span, diameter, spacing) = (diameter.span, diameter.value, spacing.value);
        let plain = Plain { region, fill, seed, sizes: alike(sizes), effort, joined };
        let (mut pack, joined) = plain.read(style, cx)?;
        pack.form = Form::Opal { diameter, spacing, axis, span };
        Ok((pack, joined))
    }
}

impl Aggregate {
    /// The packing, and the group that spheres join.
    pub fn read(self, style: &Word, cx: &BuildCx) -> Result<(Pack, Joined)> {
        let Self { region, share, seed, porosity, wavelength, sizes, effort, joined } = self;
        if porosity.value <= 1.0 - share.value && !porosity.unknown {
            let own = general(1.0 - share.value, 6);
            let text = format!("a packing of share {} has porosity {own} by itself", share.value);
            let d = Diagnostic::error(Code::BAD_VALUE, porosity.span, text);
            return Err(d.help("write a larger porosity, or `pack`").into());
        }
        let fill = At { value: Or::Else(Share(share.value)), span: share.span, unknown: share.unknown };
        let plain = Plain { region, fill, seed, sizes: alike(sizes), effort, joined };
        let (mut pack, joined) = plain.read(style, cx)?;
        let (spans, porosity) = ([porosity.span, wavelength.span], porosity.value);
        pack.form = Form::Aggregate { porosity, wavelength: wavelength.value, spans };
        Ok((pack, joined))
    }
}

/// Refuses scenes without spheres in space.
fn spheres(style: &Word, cx: &BuildCx) -> Result<()> {
    if !cx.world.particles.style.sphere {
        let text = format!("particles of atom_style {} have no radius", cx.world.particles.style.name());
        let d = Diagnostic::error(Code::CONFLICT, style.span, text);
        return Err(d
            .help("write `atom_style sphere`, or `bpm/sphere` for bonds, before the box is made")
            .into());
    }
    if cx.world.settings.two_dimensional {
        let text = format!("create_atoms {} packs spheres in space, not in a plane", style.text);
        let d = Diagnostic::error(Code::NOT_SUPPORTED, style.span, text);
        return Err(d.help("take `dimension 2` out, or use `create_atoms random` with `overlap`").into());
    }
    Ok(())
}

/// Refuses regions that no distance is known to.
fn refuse_region(name: &Word, region: &Region, domain: &Domain) -> Result<()> {
    let Err(what) = Room::new(domain, region) else { return Ok(()) };
    let text = format!("spheres cannot be packed in region `{}`, which {what}", name.text);
    let d = Diagnostic::error(Code::NOT_SUPPORTED, name.span, text);
    Err(d.help("a single shape at rest with closed faces, `side in` or `side out`, or an intersection of such ones, will do").into())
}

impl Pack {
    /// About how many spheres there will be.
    pub fn expected(&self, domain: &Domain) -> f64 {
        let volume = Room::new(domain, &self.region).map_or(0.0, |room| self.with_pores(room).volume());
        self.share(volume) * volume / self.sizes.mean_volume()
    }

    /// The part of this volume that spheres are to have.
    fn share(&self, volume: f64) -> f64 {
        match self.fill {
            Fill::Share(share) => share,
            Fill::Number(n) => n as f64 * self.sizes.mean_volume() / volume,
        }
    }

    /// Refuses more spheres than a volume has room for.
    fn fits(&self, volume: f64) -> Result<()> {
        let share = self.share(volume);
        if share <= DENSEST {
            return Ok(());
        }
        let text =
            format!("these spheres would be a share {} of region `{}`", general(share, 4), self.name.text);
        let d = Diagnostic::error(Code::BAD_VALUE, self.share_span, text);
        let most = (0.6 * volume / self.sizes.mean_volume()).floor();
        Err(d.help(format!("about {most} fit, a share of 0.6: write fewer, or smaller diameters")).into())
    }

    fn with_pores(&self, room: Room) -> Room {
        match self.form {
            Form::Opal { diameter, spacing, axis, .. } => {
                let pores = Pores::new(room.lo, diameter, spacing, axis);
                room.with_pores(pores)
            }
            _ => room,
        }
    }

    /// Packs the spheres and logs a summary.
    pub fn places(&self, cx: &mut ActCx, domain: &Domain, kind: u16) -> Result<Vec<New>> {
        refuse_region(&self.name, &self.region, domain)?;
        let Ok(room) = Room::new(domain, &self.region) else { return Ok(vec![]) };
        let room = self.with_pores(room);
        self.check_room(&room)?;
        let volume = room.volume();
        if volume <= 0.0 {
            let text = format!("region `{}` leaves no place in the box", self.name.text);
            return fail(Code::BAD_VALUE, self.name.span, text);
        }
        self.fits(volume)?;
        let number = self.share(volume) * volume / self.sizes.mean_volume();
        if number > f64::from(u32::MAX) {
            let text = format!("{number:.3e} spheres are more than there are ids");
            return fail(Code::TOO_LARGE, self.sizes_span, text);
        }
        let mut stream = ParkMiller::new(self.seed);
        stream.skip(30);
        let amount = match self.fill {
            Fill::Share(share) => Amount::Volume(share * volume),
            Fill::Number(n) => Amount::Number(n),
        };
        let radii = self.sizes.radii(amount, &mut stream);
        if radii.is_empty() {
            let text = format!(
                "not even one sphere makes a share {} of region `{}`",
                self.share(volume),
                self.name.text
            );
            let d = Diagnostic::error(Code::BAD_VALUE, self.sizes_span, text);
            return Err(d
                .help(format!("its volume is {}: write a smaller diameter", general(volume, 6)))
                .into());
        }
        self.warn_of_others(cx, &room);
        let Some(packing) = pack(&room, radii, &mut stream, &self.goal) else {
            let text =
                format!("region `{}` is so thin that places in it are not found at random", self.name.text);
            return fail(Code::BAD_VALUE, self.name.span, text);
        };
        self.log_summary(cx, &packing, volume)?;
        let kept = self.kept(cx, &room, &packing, volume, &mut stream)?;
        let shrunk = packing.came.shrunk;
        let own = |radius: f64| self.types.get(self.sizes.kind_of(2.0 * radius / shrunk)).copied();
        let new = |k: usize| {
            let radius = packing.radius[k];
            New::at(packing.x[k], own(radius).unwrap_or(kind), Some(radius))
        };
        Ok(kept.into_iter().map(new).collect())
    }

    /// Whether what repeats does so after two diameters at least, and after whole cells of pores; whether waves fit.
    fn check_room(&self, room: &Room) -> Result<()> {
        let edge = (0..3).map(|d| room.hi[d] - room.lo[d]).fold(f64::INFINITY, f64::min);
        if let Form::Aggregate { wavelength, spans, .. } = self.form
            && wavelength > edge
            && edge > 0.0
        {
            let text =
                format!("the wavelength {wavelength} is longer than the shortest edge of the region, {edge}");
            let d = Diagnostic::error(Code::BAD_VALUE, spans[1], text);
            return Err(d.help("write about the size that holes are to have, twice").into());
        }
        let repeats = room.repeats();
        for d in (0..3).filter(|&d| repeats[d] > 0.0) {
            let (period, axis) = (repeats[d], ["x", "y", "z"][d]);
            if period < 2.0 * self.sizes.largest() {
                let text = format!(
                    "along {axis} the box repeats after {period}, less than two of the largest diameters, {}",
                    general(self.sizes.largest(), 6)
                );
                let d = Diagnostic::error(Code::BAD_VALUE, self.sizes_span, text);
                return Err(d.help("write a smaller diameter, or make the box larger").into());
            }
            if let Form::Opal { diameter, spacing, axis: turn, span } = self.form {
                let cell = Pores::new([0.0; 3], diameter, spacing, turn).cell()[d];
                let cells = (period / cell).round().max(1.0);
                // What a deck's digits leave over is no fault of the lattice.
                if (period - cells * cell).abs() > 1e-4 * period {
                    let text = format!(
                        "along {axis} the box repeats after {period}, the lattice of pores after {}",
                        general(cell, 12)
                    );
                    let d = Diagnostic::error(Code::CONFLICT, span, text);
                    let help =
                        format!("make the box {} long, or the face not periodic", general(cells * cell, 12));
                    return Err(d.help(help).into());
                }
            }
        }
        Ok(())
    }

    /// Warns of particles that are there already, which a packing does not see.
    fn warn_of_others(&self, cx: &ActCx, room: &Room) {
        let count = cx.world.particles.x.iter().filter(|x| room.contains(**x)).count();
        if count > 0 {
            let text = format!(
                "{count} particles are in region `{}` already; spheres are packed over them",
                self.name.text
            );
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, self.name.span, text));
        }
    }

    /// Logs a summary of the packing.
    fn log_summary(&self, cx: &mut ActCx, p: &Packing, volume: f64) -> Result<()> {
        let came = &p.came;
        let mean = 2.0 * p.radius.iter().sum::<f64>() / p.radius.len() as f64;
        if came.beyond > THROUGH * mean {
            let text = format!(
                "spheres do not fit into region `{}`: they reach {} through its walls",
                self.name.text,
                general(came.beyond, 3)
            );
            let d = Diagnostic::error(Code::BAD_VALUE, self.sizes_span, text);
            return Err(d
                .help("write a smaller diameter, or a region without places narrower than one")
                .into());
        }
        if came.shrunk < SMALLEST {
            let text = format!(
                "spheres of share {} overlap so far that diameters would have to be {} of what they should be",
                general(self.share(volume), 4),
                general(came.shrunk, 3)
            );
            let d = Diagnostic::error(Code::BAD_VALUE, self.share_span, text);
            return Err(d.help("write a smaller share or more `rounds`").into());
        }
        let percent = |part: f64| format!("{} %", general(100.0 * part, 3));
        let n = p.x.len();
        cx.print(format!(
            "Packed {n} spheres in {} rounds: share {} of a volume of {}",
            came.rounds,
            general(solid(&p.radius) / volume, 5),
            general(volume, 6)
        ));
        let (average, most) = (percent(came.mean), percent(came.largest));
        self.log_sizes(cx, p);
        cx.print(format!("  overlap of spheres that touch {average} on average, {most} at most"));
        let less = percent(1.0 - came.shrunk);
        if came.shrunk < 1.0 {
            cx.print(format!("  diameters are {less} smaller than requested, so that nothing overlaps"));
        }
        if came.beyond > REPORTED * mean {
            cx.print(format!("  spheres reach {} through walls at most", general(came.beyond, 3)));
        }
        if !came.reached {
            let (rounds, share) = (self.goal.rounds, general(self.share(volume), 4));
            let (text, help) = match self.goal.overlap {
                Some(0.0) => (
                    format!(
                        "after {rounds} rounds spheres of share {share} still overlapped: `overlap 0` has made their diameters {less} \
                         smaller, and the share is {}",
                        general(solid(&p.radius) / volume, 3)
                    ),
                    "a smaller share, or more `rounds`, would leave the diameters nearer to what they should be",
                ),
                _ => (
                    format!(
                        "after {rounds} rounds spheres of share {share} still overlap, {average} on average and {most} at most"
                    ),
                    "write a smaller share or more `rounds`, or `overlap 0` for smaller diameters",
                ),
            };
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, self.share_span, text).help(help));
        }
        Ok(())
    }

    /// Logs how many spheres of each size a mixture has, and their parts of the mass.
    fn log_sizes(&self, cx: &mut ActCx, p: &Packing) {
        let Sizes::Mix(parts) = &self.sizes else { return };
        let all = solid(&p.radius);
        for (k, (diameter, _)) in parts.iter().enumerate() {
            let of_size = |r: &&f64| self.sizes.kind_of(2.0 * **r / p.came.shrunk) == k;
            let radii: Vec<f64> = p.radius.iter().filter(of_size).copied().collect();
            let part = general(100.0 * solid(&radii) / all, 3);
            cx.print(format!(
                "  {} of diameter {}, {part} % of the mass",
                radii.len(),
                general(*diameter, 6)
            ));
        }
    }

    /// The spheres that stay.
    fn kept(
        &self,
        cx: &mut ActCx,
        room: &Room,
        p: &Packing,
        volume: f64,
        stream: &mut ParkMiller,
    ) -> Result<Vec<usize>> {
        let Form::Aggregate { porosity, wavelength, spans } = self.form else {
            return Ok((0..p.x.len()).collect());
        };
        let Some(left) = thin(room, p, (1.0 - porosity) * volume, wavelength, stream) else {
            let text =
                format!("at porosity {porosity} no connected part reaches from end to end of the region");
            let d = Diagnostic::error(Code::BAD_VALUE, spans[0], text);
            return Err(d.help("write a smaller porosity, another seed, or a shorter wavelength").into());
        };
        let radii: Vec<f64> = left.kept.iter().map(|&k| p.radius[k]).collect();
        cx.print(format!(
            "  left an aggregate of {} spheres, porosity {}; {} more were lost as not connected",
            left.kept.len(),
            general(1.0 - solid(&radii) / volume, 5),
            left.lost
        ));
        cx.print(format!(
            "  one part from end to end along {}, over gaps of up to {LINK} diameters",
            ["x", "y", "z"][left.axis]
        ));
        Ok(left.kept)
    }
}

/// The volume of spheres.
fn solid(radius: &[f64]) -> f64 {
    radius.iter().map(|r| 4.0 / 3.0 * PI * r.powi(3)).sum()
}

#[cfg(test)]
mod tests;
