//! How the steps of a run are made; steps of two lengths: which particles move in which, and whether the scene suits them.

use super::{Session, refuse};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_plan::Solids;
use perigrain_plan::run::Pace;
use perigrain_plan::run::levels::Levels;
use perigrain_plan::run::staggered::{Ratio, Staggered};
use perigrain_styles::pair::Deck;
use perigrain_world::{GroupId, RunStyle};
use std::sync::Arc;

/// What part of the longest stable step `m auto` uses.
const SAFETY: f64 = 0.8;

impl Session {
    /// How the steps of a run are made.
    ///
    /// # Errors
    /// A scene that does not suit them.
    pub(super) fn pace(&self, span: Span) -> Result<Pace> {
        Ok(match &self.world.settings.run_style {
            RunStyle::Verlet => Pace::Even,
            RunStyle::Respa(r) => Pace::Levels(Levels::new(r.loops.clone(), None)),
            RunStyle::Staggered { ratio, rare, twice } => {
                Pace::Staggered(self.staggered(span, *ratio, *rare, *twice)?)
            }
        })
    }

    /// How steps of two lengths are made.
    ///
    /// # Errors
    /// A scene without both kinds of particle, fixes that cannot take part, and no estimate for `m auto`.
    fn staggered(
        &self,
        span: Span,
        ratio: Option<i64>,
        rare: bool,
        twice: Option<GroupId>,
    ) -> Result<Staggered> {
        let place = self.run_style_place(span);
        let solids = Arc::new(self.solids(twice.map_or(0, |g| g.bit())));
        let p = &self.world.particles;
        let solid = |i: usize| solids.has(p.kind[i]);
        let (some, all) = ((0..p.len()).any(solid), (0..p.len()).all(solid));
        if !some || all {
            let text = if some { "every particle is peridynamic" } else { "no particle is peridynamic" };
            return Err(Diagnostic::error(
                Code::CONFLICT,
                place,
                format!("steps of two lengths need grains and peridynamic solids, and here {text}"),
            )
            .help("use `run_style verlet`")
            .into());
        }
        self.refuse_movers(&solid)?;
        let ratio = match (ratio, rare) {
            (Some(m), true) => Ratio::Rare(m),
            (Some(m), false) => Ratio::Short(m),
            (None, _) => match self.solid_step() {
                Some(limit) => Ratio::Within(SAFETY * limit),
                None => {
                    return refuse(
                        Code::INCOMPLETE,
                        place,
                        "`m auto` finds no stable step of the peridynamic solids: use `m N`",
                    );
                }
            },
        };
        Ok(Staggered::new(solids, ratio))
    }

    /// The line that chose steps of two lengths.
    pub(super) fn run_style_place(&self, span: Span) -> Span {
        self.graph.lines.latest("run_style").map_or(span, |n| n.span)
    }

    /// The particles that move in short steps.
    fn solids(&self, twice: u32) -> Solids {
        let solids = self.graph.pair.as_ref().map_or(vec![], |node| node.pair.facts().solids);
        Solids { kinds: (1..=self.world.types as u16).map(|k| solids.contains(&k)).collect(), twice }
    }

    /// The longest stable step of the solids.
    fn solid_step(&self) -> Option<f64> {
        let node = self.graph.pair.as_ref()?;
        let mut parts = node.pair.parts();
        parts.push(node.pair.as_ref());
        let own = |p: &dyn perigrain_styles::Pair| {
            let known = || p.scales(&self.world, Deck::default()).sure_step;
            p.limit(&self.world).or_else(known)
        };
        parts.into_iter().filter_map(own).reduce(f64::min)
    }

    /// Refuses fixes that move solids in a way that knows no short steps.
    fn refuse_movers(&self, solid: &impl Fn(usize) -> bool) -> Result<()> {
        const KNOWN: [&str; 2] = ["nve", "nve/sphere"];
        let p = &self.world.particles;
        let moves = |f: &&crate::graph::FixNode| {
            let takes_over =
                (f.fix.facts(&self.world).integrates() && !KNOWN.contains(&f.style)) || f.style == "aveforce";
            takes_over && (0..p.len()).any(|i| p.mask[i] & f.group.bit() != 0 && solid(i))
        };
        match self.graph.fixes.iter().find(moves) {
            None => Ok(()),
            Some(f) => {
                let text =
                    format!("fix {} cannot act on peridynamic particles in steps of two lengths", f.style);
                Err(Diagnostic::error(Code::CONFLICT, f.span, text)
                    .help("move them by `fix nve` and hold parts of them with `fix setforce`, or use `run_style verlet`")
                    .into())
            }
        }
    }
}
