//! `create_bonds gap`: bonds between spheres by the gap of their surfaces, of one type or of two that are mixed.

use super::{Choice, Special, needs_zero_weights, within};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_base::math::rng::ParkMiller;
use perigrain_lang::Args;
use perigrain_neigh::list::{Pair, Reach};
use perigrain_styles::words::{At, BondType, Fraction, Seed, Words};
use perigrain_styles::{ActCx, BuildCx};
use perigrain_world::{Bond, GroupId};

/// The words of a line.
#[derive(Words)]
pub struct Line {
    #[word(name = "GROUP1 GROUP2")]
    groups: [GroupId; 2],
    #[word(name = "TYPE")]
    kind: BondType,
    /// The smallest gap [length].
    #[word(name = "GMIN")]
    least: At<f64>,
    /// The largest gap [length].
    #[word(name = "GMAX")]
    most: At<f64>,
    /// A part of the bonds gets another type, drawn from the two ids and the seed alone: the same pairs whatever the order, and whichever other
    /// bonds there are.
    #[word(keyword, name = "TYPE2 SHARE SEED")]
    mix: Option<(BondType, Fraction, Seed)>,
    #[word(flatten)]
    special: Special,
}

/// A parsed line.
pub struct Gap {
    groups: [GroupId; 2],
    range: [f64; 2],
    spans: [Span; 2],
    mix: Option<Mix>,
}

/// Another type for some of the bonds.
struct Mix {
    kind: i32,
    share: f64,
    seed: u32,
}

impl Mix {
    /// Whether the bond between two ids is one of them, whichever comes first.
    fn takes(&self, ends: [u32; 2]) -> bool {
        let mut stream = ParkMiller::new(1);
        stream.reset_at(self.seed, [f64::from(ends[0].min(ends[1])), f64::from(ends[0].max(ends[1])), 0.0]);
        stream.uniform() < self.share
    }
}

impl Line {
    /// The action of a line whose style stands at `style`.
    ///
    /// # Errors
    /// Particles without surfaces, an empty range.
    pub(super) fn read(self, style: Span, a: &Args, cx: &BuildCx) -> Result<(BondType, Choice, Special)> {
        if !cx.world.particles.style.sphere {
            let name = cx.world.particles.style.name();
            let text = format!("particles of atom_style {name} have no surfaces");
            let d = Diagnostic::error(Code::CONFLICT, style, text);
            return Err(d
                .help("write `create_bonds many` with distances, or `atom_style bpm/sphere`")
                .into());
        }
        let (spans, range) = ([self.least.span, self.most.span], [self.least.value, self.most.value]);
        if range[1] < range[0] {
            let text = format!("the largest gap {} is below the smallest, {}", range[1], range[0]);
            return fail(Code::BAD_VALUE, spans[1], text);
        }
        needs_zero_weights("gap", a, cx)?;
        let mix =
            self.mix.map(|(kind, share, seed)| Mix { kind: i32::from(kind.0), share: share.0, seed: seed.0 });
        Ok((self.kind, Choice::Gap(Gap { groups: self.groups, range, spans, mix }), self.special))
    }
}

impl Gap {
    /// The bonds, by ascending ids.
    pub fn find(&self, cx: &ActCx, kind: i32) -> Result<Vec<Bond>> {
        let w = &*cx.world;
        let radius = &w.particles.radius;
        let largest = radius.iter().copied().fold(0.0, f64::max);
        let [least, most] = self.range;
        for (d, period) in w.periods().heights().into_iter().enumerate().filter(|(_, l)| *l > 0.0) {
            // A bond knows its ends, not which image of them is meant.
            if 2.0 * largest + most > 0.5 * period {
                let axis = ["x", "y", "z"][d];
                let text = format!(
                    "along {axis} the box repeats after {period}: spheres of diameter {} that are {most} apart would \
                     meet farther images than the nearest",
                    general(2.0 * largest, 6)
                );
                let d = Diagnostic::error(Code::BAD_VALUE, self.spans[1], text);
                return Err(d.help("write a smaller gap, or make the box larger").into());
            }
        }
        let mut deeper = 0;
        // Both ends of the range count, whatever rounding does to the list's own test.
        let reach = Reach::Beyond(most + 1e-9 * (largest + most.abs()));
        let found = within(w, self.groups, reach, |q: &Pair, square: f64| {
            let gap = square.sqrt() - (radius[q.i as usize] + radius[q.j as usize]);
            deeper += usize::from(gap < least && gap < 0.0);
            gap >= least && gap <= most
        });
        if deeper > 0 {
            let text =
                format!("{deeper} pairs of spheres overlap too far for a bond: their gaps are below {least}");
            let help = format!("a smaller GMIN, as -{}, takes them in", general(0.1 * largest, 1));
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, self.spans[0], text).help(help));
        }
        found.note_left_out(cx);
        let kind = |ends: [u32; 2]| match &self.mix {
            Some(mix) if mix.takes(ends) => mix.kind,
            _ => kind,
        };
        Ok(found.ends.into_iter().map(|ends| Bond::new(kind(ends), ends)).collect())
    }
}

#[cfg(test)]
mod tests;
