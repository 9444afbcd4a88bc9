//! Steps of several lengths (`run_style respa`): ops that cannot act in them are refused, and levels without forces get a note.

use super::Session;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Span};
use perigrain_world::{Respa, RunStyle};

impl Session {
    /// The levels of steps that the deck has chosen.
    pub(super) fn respa(&self) -> Option<&Respa> {
        match &self.world.settings.run_style {
            RunStyle::Respa(r) => Some(r),
            _ => None,
        }
    }

    /// Refuses declarations that do not suit levels of steps; warns of levels that have nothing to do.
    pub(super) fn check_levels(&self, span: Span, found: &mut Diagnostics) {
        let Some(r) = self.respa() else { return };
        let place = self.run_style_place(span);
        self.check_sub_styles(r, place, found);
        for f in &self.graph.fixes {
            let Some(why) = f.fix.facts(&self.world).needs_whole_steps else { continue };
            let text = format!("fix {} has no part in steps of several lengths: {why}", f.style);
            found.push(
                Diagnostic::error(Code::NOT_SUPPORTED, f.span, text)
                    .label(place, "steps of several lengths are chosen here")
                    .help("use `run_style verlet`"),
            );
        }
        if let Some(c) = self.graph.computes.iter().find(|c| c.style == "energy/ledger") {
            let text =
                "compute energy/ledger counts the work of whole steps, and here they have several lengths";
            found.push(
                Diagnostic::error(Code::NOT_SUPPORTED, c.span, text)
                    .label(place, "steps of several lengths are chosen here")
                    .help("leave it out, or use `run_style verlet`"),
            );
        }
        self.note_idle_levels(r, place, found);
    }

    /// Refuses a `hybrid` that does not fit the pair style.
    fn check_sub_styles(&self, r: &Respa, place: Span, found: &mut Diagnostics) {
        let Some(subs) = &r.subs else { return };
        let Some(node) = &self.graph.pair else { return };
        let (parts, name) = (node.pair.parts(), node.pair.facts().name);
        let d = match parts.len() {
            n if n == subs.len() => return,
            0 => {
                let text = format!("`hybrid` gives levels to sub-styles, and pair_style {name} has none");
                Diagnostic::error(Code::CONFLICT, place, text).help("write `pair M`")
            }
            n => {
                let text =
                    format!("`hybrid` gives {} levels, and pair_style {name} has {n} sub-styles", subs.len());
                let names: Vec<&str> = parts.iter().map(|p| p.facts().name).collect();
                Diagnostic::error(Code::CONFLICT, place, text)
                    .help(format!("one level for each, in this order: {}", names.join(", ")))
            }
        };
        found.push(d.label(node.span, "pair_style given here"));
    }

    /// Warns of levels without forces.
    fn note_idle_levels(&self, r: &Respa, place: Span, found: &mut Diagnostics) {
        let outermost = r.loops.len();
        let mut busy = vec![false; outermost + 1];
        if let Some(node) = &self.graph.pair {
            (0..node.pair.parts().len().max(1)).for_each(|k| busy[r.of_pair(k)] = true);
        }
        if self.graph.bond.is_some() {
            busy[r.bond] = true;
        }
        for f in &self.graph.fixes {
            if f.fix.facts(&self.world).has_level {
                busy[f.level.unwrap_or(outermost).min(outermost)] = true;
            }
            busy[outermost] |= f.style.starts_with("wall/");
        }
        let idle: Vec<String> =
            (1..).zip(&busy).filter(|(_, b)| !**b).map(|(k, _): (usize, _)| k.to_string()).collect();
        if idle.is_empty() {
            return;
        }
        let text = format!("no force acts at level {} of the steps", idle.join(", "));
        found.push(Diagnostic::warning(Code::SUSPICIOUS, place, text).help(
            "bonds act at level 1 and pairs at the last one unless `bond`, `pair` or `hybrid` set another",
        ));
    }
}
