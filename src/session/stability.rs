//! The longest time steps of peridynamic bodies, of bonded particles and of contacts, compared with the deck's; overlaps that are too deep.

use super::Session;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span};
use perigrain_computes::swing::swinging;
use perigrain_pairs::DEEP;
use perigrain_styles::Pair;
use perigrain_styles::pair::{Deck, Scales, ToCome};
use perigrain_world::RunStyle;

/// So many grains from which it matters how long lists are.
const MANY: usize = 100;

impl Session {
    /// A warning where the time step is beyond what the pair style can vouch for, or what bonds stand.
    pub(super) fn check_step(&self, span: Span, found: &mut Diagnostics) {
        // A fix that chooses the step by itself knows better, and so does a run of a step that is computed.
        if self.world.unseen.length || self.graph.fixes.iter().any(|f| f.style.starts_with("dt/")) {
            return;
        }
        let to_come = self.to_come();
        let deck = Deck { to_come: &to_come, ..self.deck_facts() };
        let pairs = self.graph.pair.iter().flat_map(|n| sub_styles(n.pair.as_ref()));
        let styles: Vec<&dyn Pair> = pairs.collect();
        let pairs: Vec<Scales> = styles.iter().map(|p| p.scales(&self.world, deck)).collect();
        let line = self.graph.lines.latest("timestep");
        let place = line.map_or(span, |n| n.span);
        self.check_contacts(place, &pairs, deck, found);
        self.check_bonds(span, place, found);
        let own = |(k, p): (usize, &Scales)| {
            let (sure, dt) = (p.sure_step?, self.step_of(k));
            if dt <= sure {
                return Some((sure, dt));
            }
            // The exact limit is computed where the estimate is exceeded. A deck that is only checked has no bodies: there the
            // limit of a whole lattice is used, so that no deck gets a warning that a run would not give.
            let limit = styles[k].limit(&self.world).or(p.stable_step);
            Some((limit.unwrap_or(sure), dt))
        };
        let steps = pairs.iter().enumerate().filter_map(own);
        let worst = steps.reduce(|a, b| if b.0 * a.1 < a.0 * b.1 { b } else { a });
        let Some((limit, dt)) = worst else { return };
        if dt <= limit {
            return;
        }
        let (whose, place, remedy) = self.step_remedy(limit, place);
        let text = format!("{whose} {dt:e} is longer than peridynamic bonds allow: about {limit:.2e}");
        found.push(
            Diagnostic::warning(Code::UNSTABLE, place, text)
                .help("beyond their limit (of bonds √(ρ/(π c δ²)) is a safe one: Silling & Askari 2005, section 6) the shortest waves grow from step to step")
                .help(remedy),
        );
    }

    /// How many times as long the time step could be by the estimates of pair styles and walls: `None` where bonds of a bond
    /// style, levels, short steps of solids or a fix decide.
    pub(super) fn room_for_step(&self) -> Option<f64> {
        let (w, g) = (&self.world, &self.graph);
        let decided = g.fixes.iter().any(|f| f.style.starts_with("dt/")) || !w.bonds.is_empty();
        if decided || !matches!(w.settings.run_style, RunStyle::Verlet) || w.clock.dt <= 0.0 {
            return None;
        }
        let to_come = self.to_come();
        let deck = Deck { to_come: &to_come, ..self.deck_facts() };
        let pairs = g.pair.iter().flat_map(|n| sub_styles(n.pair.as_ref())).map(|p| p.scales(w, deck));
        let own = pairs.flat_map(|p| [p.sure_step.map(|s| 0.8 * s), p.contact_time.map(|c| 0.05 * c)]);
        let walls = g.fixes.iter().map(|f| f.fix.wall()?.contact_time(w, deck).map(|c| 0.05 * c));
        own.chain(walls).flatten().reduce(f64::min).map(|longest| longest / w.clock.dt)
    }

    /// Which step is too long for bonds, the place where it is set, and what to write instead.
    fn step_remedy(&self, limit: f64, place: Span) -> (&'static str, Span, String) {
        let whole = self.world.clock.dt;
        match &self.world.settings.run_style {
            RunStyle::Staggered { ratio: Some(m), rare, .. } if *m > 1 => {
                let rare = *rare;
                let remedy = match rare {
                    false => format!("use `m {}` or more", (whole / (0.8 * limit)).ceil()),
                    true => format!("use `m {}` or less", (0.8 * limit / whole).floor().max(1.0)),
                };
                (if rare { "the rare step" } else { "the short step" }, self.run_style_place(place), remedy)
            }
            RunStyle::Respa(_) => {
                let remedy = format!("let a step of their level be {:.1e} or less", 0.8 * limit);
                ("the step of their level", self.run_style_place(place), remedy)
            }
            _ => ("the time step", place, format!("use `timestep {:.1e}` or less", 0.8 * limit)),
        }
    }

    /// The time between two looks of sub-style `k` at its particles: solids may move in shorter steps than the deck's, or
    /// feel their bonds more rarely.
    fn step_of(&self, k: usize) -> f64 {
        let dt = self.world.clock.dt;
        match &self.world.settings.run_style {
            RunStyle::Verlet => dt,
            RunStyle::Staggered { ratio: Some(m), rare: true, .. } => dt * *m as f64,
            RunStyle::Staggered { ratio: Some(m), .. } => dt * (1.0 / *m as f64),
            RunStyle::Staggered { ratio: None, .. } => 0.0,
            RunStyle::Respa(r) => dt / r.steps(r.of_pair(k)) as f64,
        }
    }

    /// A warning where the step is too long for particles that a bond style joins. The cheap bound is computed first: a step
    /// within it needs no exact limit.
    fn check_bonds(&self, span: Span, place: Span, found: &mut Diagnostics) {
        let Some(bond) = self.graph.bond.as_ref().filter(|_| !self.world.bonds.is_empty()) else { return };
        let (w, whole) = (&self.world, self.world.clock.dt);
        // In a continued run the number of bonds can only have fallen.
        if self.ran && !*w.changed && self.checked_step == Some(whole) {
            return;
        }
        let integrated = self.graph.fixes.iter().filter(|f| f.fix.facts(w).integrates());
        let bits = integrated.fold(0, |bits, f| bits | f.group.bit());
        let moves = |i: usize| w.particles.mask[i] & bits != 0;
        // Errors of bonds are reported when the run is set up.
        let Ok(Some(body)) = swinging(w, bond.force.as_ref(), moves, span) else { return };
        let steps = match &w.settings.run_style {
            RunStyle::Respa(r) => r.steps(r.bond),
            _ => 1,
        };
        let dt = whole / steps as f64;
        if body.bound().is_none_or(|bound| dt <= bound) {
            return;
        }
        let Some(limit) = body.limit().filter(|limit| dt > *limit) else { return };
        let whose = if steps > 1 { "the time step of their level" } else { "the time step" };
        let text = format!("{whose} {dt:e} is longer than bonds allow: {limit:.3e}");
        let remedy = format!("use `timestep {:.1e}` or less", 0.8 * limit * steps as f64);
        found.push(
            Diagnostic::warning(Code::UNSTABLE, place, text)
                .help("beyond 2/ω, ω the largest frequency of the bonded particles as they stand, they fly apart within some tens of steps")
                .help(remedy)
                .help("`fix ID all dt/critical 100 0.8` lets the step follow"),
        );
    }

    /// A warning where contacts of grains, with each other or with walls, last less than ten steps.
    fn check_contacts(&self, place: Span, pairs: &[Scales], deck: Deck, found: &mut Diagnostics) {
        let whole = self.world.clock.dt;
        let pairs = pairs.iter().enumerate().filter_map(|(k, p)| {
            let dt =
                if let RunStyle::Respa(_) = self.world.settings.run_style { self.step_of(k) } else { whole };
            Some((p.contact_time?, dt, String::new()))
        });
        let walls = self.graph.fixes.iter();
        let walls = walls.filter_map(|f| {
            Some((
                f.fix.wall()?.contact_time(&self.world, deck)?,
                whole,
                format!(" with the wall of fix {}", f.id),
            ))
        });
        let worst = pairs.chain(walls).reduce(|a, b| if b.0 * a.1 < a.0 * b.1 { b } else { a });
        let Some((contact, dt, wall)) = worst.filter(|(contact, dt, _)| *dt > 0.1 * contact) else { return };
        let text = format!(
            "the time step {dt:e} is longer than a tenth of a contact{wall}, which lasts about {contact:.2e}"
        );
        found.push(
            Diagnostic::warning(Code::UNSTABLE, place, text)
                .help(format!("use `timestep {:.1e}` or less, or take softer grains", 0.05 * contact)),
        );
    }

    /// A note where no line sets the skin, and the default of the units has lists of grains hold many times the pairs that can
    /// touch.
    pub(super) fn check_skin(&self, span: Span, found: &mut Diagnostics) {
        let (near, p) = (&self.world.settings.neighbor, &self.world.particles);
        if near.skin_set || !p.style.sphere || p.style.peri || p.len() < MANY || self.all_excluded() {
            return;
        }
        let widest = 2.0 * p.radius.iter().copied().fold(0.0, f64::max);
        if widest == 0.0 || near.skin <= widest {
            return;
        }
        let text = format!(
            "neighbour lists reach {:e} farther than touching, {:.1} times the largest grain: no `neighbor` line sets the skin, and that is the default of units {}",
            near.skin,
            near.skin / widest,
            self.world.settings.units.name()
        );
        let remedy = format!(
            "use `neighbor {:.1e} bin`: lists hold the pairs that may touch soon, and steps are many times as fast",
            0.25 * widest
        );
        found.push(Diagnostic::note(Code::SUSPICIOUS, span, text).help(remedy));
    }

    /// Whether `neigh_modify exclude type` leaves no pair that could touch.
    fn all_excluded(&self) -> bool {
        let (types, excluded) = (1..=self.world.types as u16, &self.world.settings.neighbor.exclude_types);
        let out = |a: u16, b: u16| excluded.contains(&(a, b)) || excluded.contains(&(b, a));
        types.clone().all(|a| types.clone().all(|b| out(a, b)))
    }

    /// The largest density and the smallest diameter that the deck has set, for a check that has no particles: no other
    /// particles' numbers shall draw a warning.
    fn deck_facts(&self) -> Deck<'static> {
        let given = |fact| self.graph.lines.given(fact);
        let (density, diameter) = (given("density").map(|d| d.most), given("diameter").map(|d| d.least));
        Deck { density, diameter, to_come: &[] }
    }

    /// Grains that fixes make during the run.
    fn to_come(&self) -> Vec<ToCome> {
        self.graph.fixes.iter().flat_map(|f| f.fix.to_come(&self.world)).collect()
    }

    /// What to do about grains far in each other: where the step is longer than a tenth of a contact, stiffer grains make it worse.
    fn deep_remedy(&self) -> String {
        let room = self.room_for_step().filter(|room| *room < 0.5);
        match room.map(|room| room * self.world.clock.dt) {
            Some(step) => format!(
                "use `timestep {step:.1e}` or less first: the step is longer than a tenth of a contact, and grains go that deep before it \
                 pushes them back"
            ),
            None => "look for particles that were created inside each other, or take stiffer grains and a shorter step: contacts last as \
                     1/√k"
                .to_string(),
        }
    }

    /// Warns once of grains that a run has pushed far into each other.
    pub(super) fn warn_of_overlap(&mut self, span: Span) -> Result<()> {
        let Some(deep) = self.world.facts.get_mut(*DEEP).filter(|d| !d.warned) else { return Ok(()) };
        deep.warned = true;
        let ([i, j], part) = (deep.ids, 100.0 * deep.part);
        let text = format!(
            "particles {i} and {j} overlap by {part:.0} % of the smaller radius at step {}: contact laws hold below 10 %",
            deep.step
        );
        let remedy = self.deep_remedy();
        self.note_once(
            Diagnostic::warning(Code::SUSPICIOUS, span, text)
                .help(remedy)
                .help("only the first such pair is reported"),
        );
        self.print_notes()
    }
}

/// The sub-styles of a pair style, or itself.
fn sub_styles(pair: &dyn Pair) -> Vec<&dyn Pair> {
    let parts = pair.parts();
    if parts.is_empty() { vec![pair] } else { parts }
}
