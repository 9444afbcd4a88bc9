//! Checks across nodes before a run: errors where LAMMPS refuses, warnings where it would run all the same.

use super::Session;
use crate::graph::declaration::Context;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Label, Result, Span};
use perigrain_lang::{Command, Script, Word};
use perigrain_styles::common::orthogonal;
use perigrain_styles::{Pair, Use, UseKind};
use perigrain_world::GroupId;
use std::cell::RefCell;

/// Adds to problems with words from a variable where that variable was defined.
pub(super) fn with_origins(mut problems: Diagnostics, cmd: &Command) -> Diagnostics {
    for d in &mut problems.0 {
        let at_fault = |w: &&Word| Some(w.span) == d.span && w.origin.is_some();
        let Some(word) = cmd.args.iter().chain([&cmd.name]).find(at_fault) else { continue };
        if let Some(origin) = word.origin.filter(|o| d.labels.iter().all(|l| l.span != *o)) {
            d.labels.push(Label { span: origin, text: format!("`{}` comes from here", word.text) });
        }
    }
    problems
}

impl Session {
    /// Checks all declarations together; warnings are noted, errors returned. A run that `moves` nothing, of no steps, needs no
    /// integrator.
    ///
    /// # Errors
    /// What LAMMPS would refuse too: missing coefficients, masses.
    pub(super) fn check_run(&mut self, span: Span, moves: bool) -> Result<()> {
        let mut found = Diagnostics::default();
        self.check_pair(span, &mut found);
        crate::graph::bonds::check(&self.graph, &self.world, span, &mut found);
        crate::graph::bonds::check_angles(&self.world, span, &mut found);
        self.check_masses(span, &mut found);
        if moves {
            self.check_integrators(span, &mut found);
            self.check_orientations(&mut found);
            self.check_step(span, &mut found);
            self.checked_step = Some(self.world.clock.dt);
            self.check_overlaps(span, &mut found);
            self.check_skin(span, &mut found);
        }
        self.check_levels(span, &mut found);
        self.check_surfaces(&mut found);
        self.check_breaking(&mut found);
        self.check_box(&mut found);
        self.check_orthogonal(&mut found);
        self.check_variables(&mut found);
        self.check_lattice_units(&mut found);
        self.check_width_of_box(&mut found);
        self.check_empty_groups(&mut found);
        self.check_pictures(&mut found);
        found.0.extend(self.graph.thermo.forgotten());
        crate::graph::dynamic::check(&self.graph, &self.world, &mut found);
        let (errors, notes) =
            found.0.into_iter().partition(|d| d.severity == perigrain_base::diag::Severity::Error);
        for note in Vec::into_iter(notes) {
            self.note_once(note);
        }
        let errors: Vec<Diagnostic> = errors;
        if errors.is_empty() { Ok(()) } else { Err(Diagnostics(errors)) }
    }

    /// Warns where commands stand behind a `quit` that is always reached.
    pub(super) fn check_rest(&mut self, script: &Script) {
        let Some((file, at)) = script.unread().filter(|_| self.checking()) else { return };
        let Some(text) = self.sources.get(file).map(|s| s.text.as_str()) else { return };
        let (mut start, mut first) = (at, None);
        for line in text[at..].split_inclusive('\n') {
            let code = line.trim();
            if code.starts_with("label") {
                // Some jump may lead there.
                return;
            }
            if first.is_none() && !code.is_empty() && !code.starts_with('#') {
                let begin = start + line.len() - line.trim_start().len();
                first = Some(Span::new(file, begin, begin + code.len()));
            }
            start += line.len();
        }
        if let Some(span) = first {
            let text = "this line is never reached: `quit` comes before it";
            let help = "leave out what follows `quit`, or put the `quit` behind an `if`";
            self.notes.push(Diagnostic::warning(Code::UNREACHABLE, span, text).help(help));
        }
    }

    /// Adds a note once, even for a deck with a loop around `run`.
    pub(super) fn note_once(&mut self, note: Diagnostic) {
        if !self.notes.0.contains(&note) {
            self.notes.push(note);
        }
    }

    fn settled(&self, fact: &str) -> bool {
        self.graph.lines.settled(fact)
    }

    fn check_pair(&self, span: Span, found: &mut Diagnostics) {
        let Some(node) = &self.graph.pair else {
            if self.checking() && self.pairless {
                return;
            }
            found.push(
                Diagnostic::warning(Code::NO_FORCES, span, "no pair_style: particles do not feel each other")
                    .help("this is right for free flight only"),
            );
            return;
        };
        let types = self.world.types as u16;
        let noted = self.checking() && self.dialect.lawless;
        let types = if noted { 0 } else { types };
        let missing: Vec<String> = (1..=types)
            .flat_map(|i| (i..=types).map(move |j| (i, j)))
            .filter(|&(i, j)| !node.pair.covers(i, j))
            .map(|(i, j)| format!("{i}-{j}"))
            .collect();
        if !missing.is_empty() {
            let text = format!(
                "pair_style {} has no coefficients for types {}",
                node.pair.facts().name,
                missing.join(", ")
            );
            found.push(
                Diagnostic::error(Code::INCOMPLETE, span, text)
                    .label(node.span, "pair_style given here")
                    .help(format!("add `pair_coeff {} …`", missing[0].replace('-', " "))),
            );
        }
        self.check_facts(node.pair.as_ref(), span, found);
        node.pair.parts().into_iter().for_each(|part| self.check_facts(part, span, found));
        self.check_units_of_force(node.pair.as_ref(), node.span, found);
        let (notes, uses) = (RefCell::default(), RefCell::default());
        let cx = Context { span: node.span, checking: self.checking(), notes: &notes, uses: &uses };
        node.pair.check(&cx.build(&self.graph, &self.world, "", GroupId::ALL));
        found.append(notes.into_inner());
    }

    /// Facts of the scene that a pair style uses and that are not set.
    fn check_facts(&self, pair: &dyn Pair, span: Span, found: &mut Diagnostics) {
        for fact in pair.facts().needs {
            // LAMMPS' default, spheres of diameter and density 1, is what reduced units are for.
            if self.world.settings.units.name() == "lj" && ["diameter", "density"].contains(fact) {
                continue;
            }
            if ["diameter", "density"].contains(fact) && self.all_are_poured() {
                continue;
            }
            // `set … mass` is as good as a density.
            if self.settled(fact) || (*fact == "density" && self.settled("mass")) {
                continue;
            }
            let text = format!(
                "the {fact} of particles was never set, and pair_style {} uses it",
                pair.facts().name
            );
            let warning = Diagnostic::warning(Code::NEVER_SET, span, text);
            found.push(warning.help(format!("add `set group all {fact} …`")));
        }
    }

    /// Whether every particle there is comes from a fix pour or insert, which gives it a diameter and a density; none comes where the
    /// line of that fix was refused.
    fn all_are_poured(&self) -> bool {
        let pours = |text: &str| {
            let mut words = text.split_whitespace();
            words.next() == Some("fix") && matches!(words.nth(2), Some("pour" | "insert"))
        };
        let makes = |f: &crate::graph::FixNode| f.fix.facts(&self.world).makes_particles;
        !self.settled("particles")
            && (self.graph.lines.nodes().iter().any(|n| pours(&n.text))
                || !self.graph.fixes.iter().any(makes))
    }

    /// Force densities and forces added up in one column.
    fn check_units_of_force(&self, pair: &dyn Pair, span: Span, found: &mut Diagnostics) {
        let parts = pair.parts();
        let densities = parts.iter().any(|p| p.facts().true_forces == Some(false));
        let forces = parts.iter().any(|p| p.facts().true_forces != Some(false));
        if densities && forces && !self.settled("mass") {
            let text = "peridynamic force densities (with the density as mass) and granular forces meet in one scene: \
                        momentum is not conserved, and grains meet bodies that hardly move";
            found.push(
                Diagnostic::warning(Code::UNITS_OF_FORCE, span, text)
                    .help("use `peri_modify force newton` (implied by `material` coefficients): forces become newtons, masses ρV")
                    .help("or scale the numbers as in LAMMPS: multiply c by the particle volume V and `set … mass` to ρV"),
            );
        }
    }

    fn check_masses(&self, span: Span, found: &mut Diagnostics) {
        if self.world.particles.style.own_mass() {
            return;
        }
        for (k, m) in self.world.type_mass.iter().enumerate() {
            if m.is_none() {
                found.push(
                    Diagnostic::error(Code::INCOMPLETE, span, format!("type {} has no mass", k + 1))
                        .help(format!("add `mass {} …`", k + 1)),
                );
            }
        }
    }

    /// Variables that fixes wait for have been defined by now.
    fn check_variables(&self, found: &mut Diagnostics) {
        for f in &self.graph.fixes {
            let wanted = Use { kind: UseKind::Fix, name: f.id.clone() };
            let Some(node) = self.graph.lines.provider(&wanted) else { continue };
            for u in node.uses.iter().filter(|u| u.kind == UseKind::Variable) {
                if !self.graph.variables.contains_key(&u.name) {
                    let text =
                        format!("fix `{}` needs variable `{}`, which is not defined yet", f.id, u.name);
                    found.push(
                        Diagnostic::error(Code::UNKNOWN_VARIABLE, f.span, text)
                            .help("put its `variable` line before this run"),
                    );
                }
            }
        }
    }

    /// A length or tilt of the box obeys one fix.
    fn check_box(&self, found: &mut Diagnostics) {
        let fixes = &self.graph.fixes;
        let deforms = |f: &crate::graph::FixNode| f.fix.facts(&self.world).deforms;
        for (k, a) in fixes.iter().enumerate() {
            let same = |b: &&crate::graph::FixNode| (0..6).any(|d| deforms(a)[d] && deforms(b)[d]);
            if let Some(b) = fixes[k + 1..].iter().find(same) {
                let text =
                    format!("fixes `{}` and `{}` both change the same length or tilt of the box", a.id, b.id);
                found.push(Diagnostic::error(Code::CONFLICT, b.span, text).label(a.span, "the other one"));
            }
        }
    }

    /// What does not know that boxes may lean is not let into one that may.
    fn check_orthogonal(&self, found: &mut Diagnostics) {
        if self.world.domain.as_ref().is_none_or(|d| d.tilt.is_none()) {
            return;
        }
        let upright = |f: &&crate::graph::FixNode| f.fix.facts(&self.world).orthogonal;
        for f in self.graph.fixes.iter().filter(upright) {
            found.append(orthogonal(&format!("fix {}", f.style)).at(f.span));
        }
        let leans = |f: &&crate::graph::FixNode| f.fix.facts(&self.world).deforms[3..].contains(&true);
        if let Some(deform) = self.graph.fixes.iter().find(leans) {
            let rigid = |f: &&crate::graph::FixNode| f.style.starts_with("rigid");
            for f in self.graph.fixes.iter().filter(rigid) {
                let text = format!("fix {} does not go with a box whose tilts change", f.style);
                found.push(
                    Diagnostic::error(Code::NOT_SUPPORTED, f.span, text).label(deform.span, "changed here"),
                );
            }
        }
    }

    /// No integrator at all, and two on one particle.
    fn check_integrators(&self, span: Span, found: &mut Diagnostics) {
        let moving: Vec<_> =
            self.graph.fixes.iter().filter(|f| f.fix.facts(&self.world).integrates()).collect();
        if moving.is_empty() && !(self.checking() && self.fixless) {
            found.push(
                Diagnostic::warning(Code::NO_MOTION, span, "no fix moves any particle")
                    .help("add a time integrator, as `fix 1 all nve`"),
            );
        }
        for (k, a) in moving.iter().enumerate() {
            for b in &moving[k + 1..] {
                let both = a.group.bit() | b.group.bit();
                let shared = self.world.particles.mask.iter().any(|m| m & both == both);
                if shared || (self.checking() && a.group == b.group) {
                    found.push(
                        Diagnostic::warning(
                            Code::MOVED_TWICE,
                            b.span,
                            format!("fixes `{}` and `{}` both move some particles", a.id, b.id),
                        )
                        .label(a.span, "the other one"),
                    );
                }
            }
        }
    }
}
