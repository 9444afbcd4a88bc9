//! Overlaps of bonded particles that contacts will push apart once a bond breaks.

use super::Session;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Span};
use perigrain_base::math::vec3::length;
use perigrain_styles::probe::Probe;
use perigrain_styles::pull::{apart, find, periods};

/// Overlaps below this part of the smaller radius are rounding.
const NOTHING: f64 = 1e-6;

/// What is found in the bonds of a scene.
#[derive(Default)]
struct Pressed {
    count: usize,
    /// The deepest overlap as a part of the smaller radius.
    deepest: f64,
    /// What contacts would give back [energy].
    energy: f64,
}

impl Session {
    /// A warning where bonds that may break join particles that overlap, and the pair style does not act between them yet: such
    /// an overlap is a loaded spring without a cause. Bonds that a run has already used are as it made them.
    pub(super) fn check_overlaps(&self, span: Span, found: &mut Diagnostics) {
        let (w, Some(bond), Some(pair)) = (&self.world, &self.graph.bond, &self.graph.pair) else { return };
        let new = w.bonds.list.iter().any(|b| b.is_on() && b.length == 0.0);
        if !new || w.bonds.weights.lj[0] != 0.0 || w.particles.radius.is_empty() {
            return;
        }
        let Ok(probes) = pair.pair.probes(w, false) else { return };
        let probes: Vec<Box<dyn Probe>> = probes.into_iter().map(|(_, probe)| probe).collect();
        let Some(pressed) = self.pressed(&probes, span).filter(|p| p.count > 0) else { return };
        let Pressed { count, deepest, energy } = pressed;
        let pairs = if count == 1 { "pair overlaps" } else { "pairs overlap" };
        let text = format!(
            "{count} bonded {pairs}, by {:.2} % of the smaller radius at most: where a bond breaks, contacts push its ends apart, and \
             {energy:.3e} of energy in all would come from nowhere",
            100.0 * deepest
        );
        found.push(
            Diagnostic::warning(Code::SUSPICIOUS, bond.span, text)
                .help("pack with `create_atoms … pack … overlap 0`, or take smaller diameters")
                .help("with `overlay/pair yes` and `special_bonds lj/coul 1 1 1` contacts push from the beginning"),
        );
    }

    /// The overlaps of bonds that may break.
    fn pressed(&self, probes: &[Box<dyn Probe>], span: Span) -> Option<Pressed> {
        let (w, style) = (&self.world, &self.graph.bond.as_ref()?.force);
        let (p, period) = (&w.particles, periods(w).ok()?);
        let mut sum = Pressed::default();
        for (_, found) in find(w, |b| style.may_break(b.kind as u16), span).ok()? {
            let [r, other] = found.ends.map(|i| p.radius[i]);
            let overlap = r + other - length(apart(w, &period, found.ends));
            if overlap <= NOTHING * r.min(other) {
                continue;
            }
            let types = found.ends.map(|i| p.kind[i]);
            let answers = probes.iter().filter_map(|p| p.pressed(types, overlap, r * other / (r + other)));
            let [push, energy] =
                answers.fold([0.0; 2], |sum, [push, _, energy]| [sum[0] + push, sum[1] + energy]);
            if push > 0.0 {
                sum.count += 1;
                sum.deepest = sum.deepest.max(overlap / r.min(other));
                sum.energy += energy;
            }
        }
        Some(sum)
    }
}
