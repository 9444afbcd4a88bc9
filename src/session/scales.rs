//! Notes on speeds and lengths that are in lattice units where the numbers look like those of the lines around them, which are not.

use super::Session;
use crate::graph::DumpNode;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Span};
use perigrain_base::math::cformat::general;
use perigrain_styles::common::about;
use perigrain_world::GroupId;

/// How much smaller than others of its kind a speed is that is likely to be meant otherwise.
const THOUSANDTH: f64 = 1.0 / 200.0;

/// A speed or length that a line names.
struct Quantity {
    /// As it is written, and what a lattice makes of it where it counts in lattice spacings.
    raw: f64,
    lattice: Option<f64>,
    span: Span,
}

impl Quantity {
    fn value(&self) -> f64 {
        self.raw * self.lattice.unwrap_or(1.0)
    }
}

impl Session {
    /// Notes on numbers in lattice units.
    pub(super) fn check_lattice_units(&self, found: &mut Diagnostics) {
        let spacing = self.world.lattice.spacing;
        let scale = spacing.iter().copied().fold(0.0, f64::max);
        if scale <= 0.0 || (0.1..=10.0).contains(&scale) {
            return;
        }
        let lines = || self.graph.lines.nodes().iter().map(|n| (n.text.as_str(), n.span));
        let speeds: Vec<Quantity> =
            lines().filter_map(|(text, span)| quantity(speed(text)?, text, span, scale)).collect();
        let fastest = speeds.iter().filter(|s| s.lattice.is_none()).map(|s| s.value()).fold(0.0, f64::max);
        for s in speeds.iter().filter(|s| s.lattice.is_some() && fastest > 0.0) {
            // Written as the others are, and a thousandth of them.
            if s.value() < THOUSANDTH * fastest && s.raw > THOUSANDTH * fastest {
                found.push(note(s, "speed", &format!("others of the deck are up to {fastest:e}"), scale));
            }
        }
        let Some(domain) = &*self.world.domain else { return };
        let widest = (0..3).map(|d| domain.hi[d] - domain.lo[d]).fold(0.0, f64::max);
        for s in lines().filter_map(|(text, span)| quantity(length(text)?, text, span, scale)) {
            if s.lattice.is_some()
                && s.raw < 0.5
                && s.value() < THOUSANDTH * widest
                && s.raw > THOUSANDTH * widest
            {
                found.push(note(&s, "length", &format!("the box is {widest:e} wide"), scale));
            }
        }
    }
}

impl Session {
    /// A warning where the whole box is a small part of one lattice spacing wide: its lengths were meant as they stand.
    pub(super) fn check_width_of_box(&self, found: &mut Diagnostics) {
        let (lattice, flat) = (&self.world.lattice, self.world.settings.two_dimensional);
        let Some(domain) = self.world.domain.as_ref().filter(|_| !lattice.basis.is_empty()) else { return };
        let axes = if flat { 0..2 } else { 0..3 };
        let spacings = |d: usize| domain.lengths()[d] / lattice.spacing[d];
        let widest = axes.map(spacings).fold(0.0, f64::max);
        if widest >= PART_OF_SPACING || self.world.unseen.space {
            return;
        }
        let words = |text: &str| text.split_whitespace().map(String::from).collect::<Vec<_>>();
        let lines = || self.graph.lines.nodes().iter().map(|n| (words(&n.text), n.span));
        let Some((made, _)) = lines().rfind(|(w, _)| w.first().is_some_and(|w| w == "create_box")) else {
            return;
        };
        let names = |w: &[String]| w.len() > 2 && w[0] == "region" && Some(&w[1]) == made.get(2);
        let Some((region, span)) = lines().rfind(|(w, _)| names(w)) else { return };
        if region.iter().any(|w| w == "units") {
            return;
        }
        let text = format!(
            "the box is {} lattice spacings wide: lengths of this region count in spacings of {}",
            about(widest),
            general(lattice.spacing[0], 4)
        );
        found.push(
            Diagnostic::warning(Code::SUSPICIOUS, span, text).help(
                "did you mean `units box`? write it at the end of this line, or `units lattice` if not",
            ),
        );
    }

    /// Warnings of fixes for groups without particles, where nothing will put any there.
    pub(super) fn check_empty_groups(&self, found: &mut Diagnostics) {
        let w = &self.world;
        if w.n() == 0 || w.unseen.particles {
            return;
        }
        let taken = w.particles.mask.iter().fold(0, |all, mask| all | mask);
        let sources = ["pour", "deposit", "insert"];
        let fills = |group| self.graph.fixes.iter().any(|f| sources.contains(&f.style) && f.group == group);
        for f in &self.graph.fixes {
            let acts = !sources.contains(&f.style) && !WITHOUT_GROUP.iter().any(|s| f.style.starts_with(s));
            let empty =
                f.group != GroupId::ALL && taken & f.group.bit() == 0 && w.groups.dynamic(f.group).is_none();
            if acts && empty && !fills(f.group) {
                let name = w.groups.name(f.group);
                let text = format!("there is no particle in group `{name}`: this fix does nothing");
                found.push(
                    Diagnostic::warning(Code::SUSPICIOUS, f.span, text)
                        .help("a group takes the particles that are there when it is defined: let `group` follow `create_atoms`"),
                );
            }
        }
    }

    /// Warnings of pictures that would show nothing but one sphere.
    pub(super) fn check_pictures(&self, found: &mut Diagnostics) {
        let doubts = |d: &DumpNode| d.dump.doubts(&self.world).map(|doubt| doubt.at(d.span));
        found.0.extend(self.graph.dumps.iter().filter_map(doubts));
    }
}

/// A box that is no wider than this part of a lattice spacing was hardly meant so.
const PART_OF_SPACING: f64 = 0.5;

/// Beginnings of the names of fixes for which their group means nothing, or that only look.
const WITHOUT_GROUP: [&str; 12] = [
    "ave/",
    "balance",
    "dt/",
    "external",
    "extremes",
    "halt",
    "print",
    "property/atom",
    "python",
    "store/",
    "vector",
    "deform",
];

fn quantity(raw: f64, text: &str, span: Span, scale: f64) -> Option<Quantity> {
    let boxed = text.split_whitespace().collect::<Vec<_>>().windows(2).any(|w| w == ["units", "box"]);
    (raw > 0.0).then_some(Quantity { raw, lattice: (!boxed).then_some(scale), span })
}

fn note(s: &Quantity, what: &str, others: &str, scale: f64) -> Diagnostic {
    let text =
        format!("this {what} counts in lattice spacings of {scale:e}: it is {:e}, while {others}", s.value());
    Diagnostic::note(Code::SUSPICIOUS, s.span, text).help(
        "end the line with `units box` if the number is meant as it stands, or with `units lattice` if not",
    )
}

/// The largest of the numbers at some places of a line.
fn largest(words: &[&str], places: impl IntoIterator<Item = usize>) -> Option<f64> {
    let numbers = places.into_iter().filter_map(|k| words.get(k)?.parse::<f64>().ok()).map(f64::abs);
    numbers.filter(|a| a.is_finite()).reduce(f64::max)
}

/// The speed that a line gives particles or something that moves them.
fn speed(text: &str) -> Option<f64> {
    let words: Vec<&str> = text.split_whitespace().collect();
    if words.windows(2).any(|w| w == ["units", "lattice"]) {
        return None;
    }
    match words[..] {
        ["velocity", _, "set", ..] => largest(&words, 3..6),
        ["velocity", _, "ramp", ..] => largest(&words, 4..6),
        ["fix", _, _, "move", "linear", ..] => largest(&words, 5..8),
        _ => None,
    }
}

/// The longest edge of what a line defines, or how far it moves particles.
fn length(text: &str) -> Option<f64> {
    let words: Vec<&str> = text.split_whitespace().collect();
    if words.windows(2).any(|w| w == ["units", "lattice"]) {
        return None;
    }
    match words[..] {
        ["region", _, "sphere", ..] => largest(&words, [6]),
        ["region", _, "cylinder", ..] => largest(&words, [6]),
        ["region", _, "block", ..] => {
            let number = |k: usize| words.get(k)?.parse::<f64>().ok();
            let edges: Option<Vec<f64>> =
                (0..3).map(|d| Some(number(4 + 2 * d)? - number(3 + 2 * d)?)).collect();
            edges?.into_iter().reduce(f64::max)
        }
        ["displace_atoms", _, "move", ..] => largest(&words, 3..6),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::session::{Mode, Options, Session};

    fn notes(lines: &str) -> Vec<String> {
        let mut s = Session::new(Options { mode: Mode::Check, ..Options::default() }).unwrap();
        let deck = format!(
            "units si\natom_style sphere\nlattice sc 0.001\nregion b block 0 0.05 0 0.05 0 0.05 units box\ncreate_box 1 b\n\
             region r block 0 5 0 5 0 5\ncreate_atoms 1 region r\nset group all diameter 0.001 density 2500\npair_style none\n\
             velocity all set 0 0 -2 units box\n{lines}fix n all nve/sphere\nrun 1\n"
        );
        s.run_text("in.deck", &deck).unwrap();
        let ours = |m: &&String| m.contains("lattice spacings");
        s.notes.0.iter().map(|d| d.message.clone()).collect::<Vec<_>>().iter().filter(ours).cloned().collect()
    }

    #[test]
    fn a_thousandth_of_its_neighbours_is_noted() {
        let moved = notes("fix m all move linear 0 0 -0.5\n");
        assert!(moved.len() == 1 && moved[0].contains("5e-4") && moved[0].contains("2e0"), "{moved:?}");
        assert_eq!(notes("fix m all move linear 0 0 -0.5 units box\n").len(), 0);
        assert_eq!(notes("fix m all move linear 0 0 -0.5 units lattice\n").len(), 0);
        assert_eq!(notes("fix m all move linear 0 0 -2000\n").len(), 0);
        assert_eq!(notes("region s sphere 0 0 0 0.02\n").len(), 1);
        assert_eq!(notes("region s sphere 0 0 0 0.02 units box\nregion t sphere 9 9 9 4\n").len(), 0);
    }
}
