//! The longest stable time step of peridynamic bodies, compared with the deck's.

use super::Session;
use crate::diag::{Code, Diagnostic, Diagnostics, Span};
use crate::world::RunStyle;

impl Session {
    /// A warning where the time step is beyond what the pair style can vouch for.
    pub(super) fn check_step(&self, span: Span, found: &mut Diagnostics) {
        let Some(node) = &self.graph.pair else { return };
        // A fix that chooses the step by itself knows better.
        if self.graph.fixes.iter().any(|f| f.style == "dt/reset") {
            return;
        }
        let density = self.density();
        let parts = node.pair.parts();
        let all = parts.into_iter().chain([node.pair.as_ref()]);
        let limit = all.filter_map(|p| p.stable_step(&self.world, density)).fold(f64::INFINITY, f64::min);
        // Solids may move in shorter steps than the deck's, or feel their bonds more rarely.
        let dt = self.world.clock.dt
            * match self.world.settings.run_style {
                RunStyle::Verlet => 1.0,
                RunStyle::Staggered { ratio: Some(m), rare: true, .. } => m as f64,
                RunStyle::Staggered { ratio: Some(m), .. } => 1.0 / m as f64,
                RunStyle::Staggered { ratio: None, .. } => 0.0,
            };
        if dt <= limit {
            return;
        }
        let line = self.graph.nodes.iter().rev().find(|n| n.text.starts_with("timestep"));
        let place = line.map_or(span, |n| n.span);
        let text = format!("the time step {dt:e} is longer than peridynamic bonds allow: about {limit:.2e}");
        found.push(
            Diagnostic::warning(Code::UNSTABLE, place, text)
                .help("beyond √(ρ/(π c δ²)) the shortest waves grow from step to step (Silling & Askari 2005, section 6)")
                .help(format!("say `timestep {:.1e}` or less", 0.8 * limit)),
        );
    }

    /// The largest density that the deck has set, for a check that has no particles: no other particles' density
    /// shall draw a warning.
    fn density(&self) -> Option<f64> {
        let sets = self.graph.nodes.iter().filter(|n| n.settles.contains(&"density"));
        let said = sets.filter_map(|n| {
            let mut words = n.text.split_whitespace().skip_while(|w| *w != "density");
            words.nth(1)?.parse::<f64>().ok()
        });
        said.filter(|d| *d > 0.0).reduce(f64::max)
    }
}
