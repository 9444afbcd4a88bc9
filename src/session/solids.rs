//! Checks of peridynamic solids against the rest of a deck: damage of what cannot break, rotation of what cannot turn.

use super::Session;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics};

impl Session {
    /// Warns of damage that is requested where no bond can break.
    pub(super) fn check_breaking(&self, found: &mut Diagnostics) {
        let Some(node) = &self.graph.pair else { return };
        let needs = |style: &str| style == "damage/atom" || style == "fragment/atom";
        let Some(compute) = self.graph.computes.iter().find(|c| needs(c.style)) else { return };
        let mut parts = node.pair.parts();
        parts.push(node.pair.as_ref());
        // Cracks that are cut need no strength.
        let cut = self.graph.lines.latest("peri_crack").is_some();
        let Some(kind) = parts.into_iter().find_map(|p| p.facts().unbreakable).filter(|_| !cut) else {
            return;
        };
        let text = format!("bonds of type {kind} never break: its material has neither Gc nor s00");
        found.push(
            Diagnostic::warning(Code::SUSPICIOUS, compute.span, text)
                .label(node.span, "its pair style")
                .help("add `Gc` (or `s00`) to the `material` line, or leave this compute out"),
        );
    }

    /// Warns of fixes that would turn hybrid particles.
    pub(super) fn check_surfaces(&self, found: &mut Diagnostics) {
        let (groups, mask) = (&self.world.groups, &self.world.particles.mask);
        for (_, surface) in groups.surfaces() {
            let bit = surface.parent.bit();
            let turns = |f: &&crate::graph::FixNode| {
                ["nve/sphere", "nve/bpm/sphere"].contains(&f.style)
                    && mask.iter().any(|m| m & bit != 0 && m & f.group.bit() != 0)
            };
            if let Some(f) = self.graph.fixes.iter().find(turns) {
                let text = format!(
                    "fix {} turns particles of `{}`, whose surface has no rotation of its own",
                    f.style,
                    groups.name(surface.parent)
                );
                found.push(
                    Diagnostic::warning(Code::SUSPICIOUS, f.span, text)
                        .help(format!("move solids by `fix {} … nve`, grains alone by nve/sphere", f.id)),
                );
            }
        }
    }
}
