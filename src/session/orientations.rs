//! Whether the ends of bonds that bend and twist turn as they spin.

use super::Session;
use crate::graph::FixNode;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics};
use perigrain_styles::fix::Moves;
use perigrain_world::index::Index;

impl Session {
    /// Warns where a fix moves ends of bonds that bend and twist by forces and leaves their orientations as they are: such a body
    /// bends as it turns. A check, which has no bonds, warns where nothing turns orientations at all.
    pub(super) fn check_orientations(&self, found: &mut Diagnostics) {
        let Some(bond) = &self.graph.bond else { return };
        let turns = |kind: i32| u16::try_from(kind).is_ok_and(|kind| bond.force.turns(kind));
        let moved: Vec<(&FixNode, Moves)> =
            self.graph.fixes.iter().map(|f| (f, f.fix.facts(&self.world).moves)).collect();
        let with = |how: Moves| moved.iter().filter(move |(_, moves)| *moves == how).map(|(f, _)| *f);
        let turned = with(Moves::Turns).fold(0, |bits, f| bits | f.group.bit());
        if self.checking() {
            if turned == 0 && (1..=self.world.bonds.types as i32).any(turns) {
                found.0.extend(with(Moves::Freely).map(|f| unturned(f, "its particles", bond.force.name())));
            }
            return;
        }
        let (p, index) = (&self.world.particles, Index::new(&self.world.particles.tag));
        for f in with(Moves::Freely) {
            let left = |tag: &u32| {
                let mask = index.find(*tag, &p.tag).map_or(0, |i| p.mask[i]);
                mask & f.group.bit() != 0 && mask & turned == 0
            };
            let mut ends = self.world.bonds.list.iter().filter(|b| turns(b.kind)).flat_map(|b| b.ends);
            if let Some(tag) = ends.find(left) {
                found.push(unturned(f, &format!("particle {tag}"), bond.force.name()));
            }
        }
    }
}

fn unturned(f: &FixNode, ends: &str, bonds: &str) -> Diagnostic {
    let text = format!(
        "fix {} does not turn {ends}, and bonds of `{bonds}` bend and twist with the orientations of their ends",
        f.style
    );
    Diagnostic::warning(Code::SUSPICIOUS, f.span, text)
        .help(format!("write `fix {} … nve/bpm/sphere`, with which orientations follow spins", f.id))
        .help("without it a body that turns as a whole bends itself")
}
