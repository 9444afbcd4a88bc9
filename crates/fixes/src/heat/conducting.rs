//! The action of fix heat/peri: when it comes, and what it does.

use super::boundary::{BOUNDARIES, Boundary, Does};
use super::peri::{Declared, Keys, NUMBERS};
use super::scene::{Edge, Scene};
use super::{MOVERS, Mover};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span};
use perigrain_base::par;
use perigrain_peri::conduction::Conduction;
use perigrain_peri::conduction::implicit::{EXACT, Step};
use perigrain_peri::families::Families;
use perigrain_plan::Tick;
use perigrain_styles::matter::publish;
use perigrain_world::columns::PLASTIC_HEAT;
use perigrain_world::{Key, Named, Numbers, SlotId, World};

/// The part of the longest stable step that explicit steps have.
const SAFE: f64 = 0.8;
/// It acts so often at least: explicit steps near the stable one are inaccurate, and one action takes about as long as one step.
const LONGEST: i64 = 100;
/// Products of one linear system at most.
const PRODUCTS: usize = 10_000;

/// Heat conduction during a run.
pub struct Conducting {
    line: Declared,
    keys: Keys,
    temperature: Numbers,
    flow: Numbers,
    slot: SlotId,
    span: Span,
    /// What is found when it first looks at the scene.
    body: Option<Body>,
}

/// What stays the same during a run.
struct Body {
    conduction: Conduction,
    /// The longest stable explicit step.
    limit: f64,
    /// Steps from one action to the next.
    every: i64,
    implicit: bool,
}

/// What an action has done.
struct Acted {
    /// Time integrals of the heat over bonds, and of the temperatures that films see.
    conducted: Vec<f64>,
    seen: Vec<f64>,
    products: usize,
}

impl Conducting {
    /// Before the first step.
    pub fn new(line: Declared, keys: Keys, [temperature, flow]: [Numbers; 2], at: (SlotId, Span)) -> Self {
        Self { line, keys, temperature, flow, slot: at.0, span: at.1, body: None }
    }

    /// A step: heat comes in, of flow in the step before too, and every so many steps is conducted.
    pub fn act(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let first = self.body.is_none();
        let body = match self.body.take() {
            Some(body) => body,
            None => self.look(w, t)?,
        };
        let mut memo = w.memo.remove(self.keys.memo).unwrap_or_else(|| vec![0.0; NUMBERS]);
        if first {
            memo[7] = self.heat(w);
        }
        let outcome = if t.setup { Ok(()) } else { self.step(w, t, &body, &mut memo) };
        let vector = [memo[2], memo[3], memo[4], memo[5], body.every as f64, memo[6]];
        publish(w, self.slot, t, memo[7], &vector);
        w.memo.insert(self.keys.memo, memo);
        self.body = Some(body);
        outcome
    }

    /// Σ C T.
    fn heat(&self, w: &World) -> f64 {
        let temperature = w.columns.get_scalar(self.temperature).unwrap_or(&[]);
        let Some(families) = w.families.as_ref() else { return 0.0 };
        let capacity = self.scene(w, families).capacity;
        par::sum(temperature.len(), |i| capacity[i] * temperature[i])
    }

    fn scene(&self, w: &World, families: &Families) -> Scene {
        let m = w.columns.get_scalar(self.keys.m).unwrap_or(&[]);
        Scene::of(w, families, self.line.group.bit(), m)
    }

    fn step(&self, w: &mut World, t: &Tick, body: &Body, memo: &mut [f64]) -> Result<()> {
        let n = w.n();
        let mut received = std::mem::take(w.columns.scalar(self.keys.received, n));
        let flow = w.columns.get_scalar(self.flow).unwrap_or(&[]);
        par::each((&mut received[..], flow), |_, (received, flow): (&mut [f64], &[f64])| {
            received.iter_mut().zip(flow).for_each(|(sum, flow)| *sum += t.dt * flow);
        });
        let plastic = w.columns.scalar(*PLASTIC_HEAT, n);
        par::each((&mut received[..], &mut plastic[..]), |_, (received, heat): (&mut [f64], &mut [f64])| {
            received.iter_mut().zip(heat).for_each(|(sum, heat)| *sum += std::mem::take(heat));
        });
        memo[0] += 1.0;
        memo[1] += t.dt;
        let mut outcome = Ok(());
        if memo[0] >= body.every as f64 {
            let mut temperature = std::mem::take(w.columns.scalar(self.temperature, n));
            outcome = self.conduct(w, body, (&mut temperature, &received), memo);
            *w.columns.scalar(self.temperature, n) = temperature;
            received.fill(0.0);
            (memo[0], memo[1], memo[7]) = (0.0, 0.0, self.heat(w));
        }
        *w.columns.scalar(self.keys.received, n) = received;
        outcome
    }

    /// Conducts heat for the time since the last action.
    fn conduct(
        &self,
        w: &mut World,
        body: &Body,
        (t, received): (&mut [f64], &[f64]),
        memo: &mut [f64],
    ) -> Result<()> {
        let (mut before, dt) = (t.to_vec(), memo[1]);
        let first = std::mem::replace(&mut memo[8], 1.0) == 0.0;
        let Some(families) = w.families.as_ref() else { return Ok(()) };
        let mut scene = self.scene(w, families);
        let edges = edges(w, &scene);
        for i in (0..t.len()).filter(|i| scene.capacity[*i] > 0.0) {
            scene.source[i] += received[i] / dt;
        }
        memo[5] += par::sum(t.len(), |i| if scene.capacity[i] > 0.0 { received[i] } else { 0.0 });
        edges.iter().for_each(|(_, edge)| scene.add(edge));
        let mut jumps = vec![0.0; edges.len()];
        for ((_, edge), jump) in
            edges.iter().zip(&mut jumps).filter(|((_, e), _)| e.boundary.does == Does::Holds)
        {
            for i in edge.members.iter().map(|i| *i as usize) {
                t[i] = edge.boundary.value;
                if first {
                    // What is held jumps there at once: the mean over the first step is that of the value, not half of the way.
                    *jump += scene.capacity[i] * (t[i] - before[i]);
                    before[i] = t[i];
                }
            }
        }
        let acted = match body.implicit {
            true => self.implicit(body, families, &scene, (&before, t), dt)?,
            false => explicit(body, families, &scene, t, dt),
        };
        memo[6] = acted.products as f64;
        for ((key, edge), jump) in edges.iter().zip(jumps) {
            let brought = jump + brought(edge, &scene, &acted, (&before, t), dt);
            memo[match edge.boundary.does {
                Does::Holds => 2,
                Does::Heats { .. } => 3,
                Does::Cools { .. } => 4,
            }] += brought;
            if let Some(boundary) = w.facts.get_mut(*BOUNDARIES).and_then(|all| all.get_mut(*key)) {
                boundary.brought += brought;
            }
        }
        Ok(())
    }

    fn implicit(
        &self,
        body: &Body,
        families: &Families,
        scene: &Scene,
        (before, t): (&[f64], &mut [f64]),
        dt: f64,
    ) -> Result<Acted> {
        let n = t.len();
        let (mut conductance, mut flow) = (vec![0.0; n], vec![0.0; n]);
        body.conduction.conductance(families, &scene.ends, &mut conductance);
        let theta = self.line.theta;
        let step = Step {
            capacity: &scene.capacity,
            conductance: &conductance,
            film: &scene.film,
            source: &scene.source,
            held: &scene.held,
            dt,
            theta,
        };
        let conduct = |t: &[f64], out: &mut [f64]| body.conduction.flow(families, &scene.ends, t, out);
        let solved = step.solve(conduct, before, t, &mut flow, PRODUCTS);
        if solved.left.is_nan() || solved.left > EXACT {
            let text = format!(
                "fix heat/peri: {PRODUCTS} products leave {:.1e} of the heat of an implicit step",
                solved.left
            );
            let d = Diagnostic::error(Code::HALTED, self.span, text);
            return Err(d.help("a shorter time step").into());
        }
        flow.iter_mut().for_each(|q| *q *= dt);
        let seen = (0..n).map(|i| dt * (theta * t[i] + (1.0 - theta) * before[i])).collect();
        Ok(Acted { conducted: flow, seen, products: solved.products })
    }

    /// Looks at the scene of a run: what conducts, and how long steps may be.
    fn look(&self, w: &mut World, t: &Tick) -> Result<Body> {
        self.alone(w)?;
        let n = w.n();
        let mut m = w.columns.scalar(self.keys.m, n).clone();
        let Some(families) = w.families.as_ref() else {
            let d = self.refusal("fix heat/peri conducts heat over peridynamic bonds, and there are none");
            return Err(d.help("`fix heat/flow` integrates the temperatures of other particles").into());
        };
        if m.iter().all(|m| *m == 0.0) {
            m = families.conducting_volumes(&w.particles.kind, w.volumes());
        }
        self.materials(w, families, &m)?;
        let mut scene = Scene::of(w, families, self.line.group.bit(), &m);
        if !scene.capacity.iter().any(|c| *c > 0.0) {
            return Err(self.refusal("no particle of the group has peridynamic bonds").into());
        }
        let edges = edges(w, &scene);
        self.whole(w, &edges)?;
        self.apart(w, &edges)?;
        edges.iter().for_each(|(_, edge)| scene.add(edge));
        let conduction = Conduction::new(families, self.line.cracks);
        let mut conductance = vec![0.0; n];
        conduction.conductance(families, &scene.ends, &mut conductance);
        *w.columns.scalar(self.keys.m, n) = m;
        let limit = scene.limit(&conductance);
        let implicit = self.line.implicit.unwrap_or(t.dt > SAFE * limit);
        let most = (SAFE * limit / t.dt).min(LONGEST as f64).floor() as i64;
        let every = self.line.every.unwrap_or(if implicit { 1 } else { most.max(1) });
        Ok(Body { conduction, limit, every, implicit })
    }

    fn refusal(&self, text: &str) -> Diagnostic {
        Diagnostic::error(Code::INCOMPLETE, self.span, text)
    }

    /// Refuses particles whose temperature another fix changes too.
    fn alone(&self, w: &World) -> Result<()> {
        let bit = self.line.group.bit();
        let others = w.facts.get(*MOVERS).into_iter().flat_map(Named::iter);
        for (id, Mover { bit: other, bonds }) in others.filter(|(id, _)| id.text() != self.line.id) {
            let both =
                w.particles.mask.iter().filter(|mask| **mask & bit != 0 && **mask & other != 0).count();
            if both > 0 {
                let style = if *bonds { "heat/peri" } else { "heat/flow" };
                let text = format!(
                    "fix {} {style} changes the temperature of {both} of the particles too",
                    id.text()
                );
                let d = Diagnostic::error(Code::CONFLICT, self.span, text);
                return Err(d.help("give the two fixes groups that share no particle").into());
            }
        }
        Ok(())
    }

    /// Refuses types that conduct without numbers for it.
    fn materials(&self, w: &World, families: &Families, m: &[f64]) -> Result<()> {
        let (p, bit) = (&w.particles, self.line.group.bit());
        for i in (0..p.len()).filter(|i| p.mask[*i] & bit != 0 && m[*i] > 0.0) {
            let own = families.law.of(p.kind[i]);
            let lacks = match (own.conductivity > 0.0, own.heat_capacity > 0.0) {
                (true, true) => continue,
                (false, _) => "conductivity",
                (true, false) => "heat_capacity",
            };
            let d = self.refusal(&format!("type {} has no {lacks}", p.kind[i]));
            return Err(d
                .help(format!(
                    "give it with `material ID … {lacks} VALUE` and `pair_coeff … material ID horizon H`"
                ))
                .into());
        }
        Ok(())
    }

    /// Refuses edges with particles of the group that have no bonds to conduct over: they would share the area.
    fn whole(&self, w: &World, edges: &[(Key<Boundary>, Edge)]) -> Result<()> {
        let bit = self.line.group.bit();
        for (id, edge) in edges {
            let both =
                w.particles.mask.iter().filter(|mask| **mask & bit != 0 && **mask & edge.boundary.bit != 0);
            let idle = both.count() - edge.members.len();
            if idle > 0 {
                let text =
                    format!("{idle} particles of fix {id} have no peridynamic bonds to conduct heat over");
                return Err(conflict(self.span, &text));
            }
        }
        Ok(())
    }

    /// Refuses particles of a given temperature that something else heats or holds as well.
    fn apart(&self, w: &World, edges: &[(Key<Boundary>, Edge)]) -> Result<()> {
        let mut by: Vec<Option<usize>> = vec![None; w.n()];
        let holds = |edge: &Edge| edge.boundary.does == Does::Holds;
        for (k, (id, edge)) in edges.iter().enumerate() {
            for &i in &edge.members {
                let i = i as usize;
                if let Some(other) = by[i].filter(|other| holds(edge) || holds(&edges[*other].1)) {
                    let text = format!(
                        "fixes {} and {} both act on particle {}, and one of them holds its temperature",
                        edges[other].0, id, w.particles.tag[i]
                    );
                    return Err(conflict(self.span, &text));
                }
                by[i] = Some(k);
            }
        }
        Ok(())
    }
}

/// What happens at the edges of the particles that conduct.
fn edges(w: &World, scene: &Scene) -> Vec<(Key<Boundary>, Edge)> {
    let all = w.facts.get(*BOUNDARIES).into_iter().flat_map(Named::iter);
    all.map(|(key, boundary)| (key, Edge::of(w, *boundary, |i| scene.capacity[i] > 0.0))).collect()
}

fn conflict(span: Span, text: &str) -> Diagnostics {
    let d = Diagnostic::error(Code::CONFLICT, span, text);
    d.help("give that fix, or both, a smaller group").into()
}

/// Explicit steps of equal length, none longer than the safe part of the stable one.
fn explicit(body: &Body, families: &Families, scene: &Scene, t: &mut [f64], dt: f64) -> Acted {
    let n = t.len();
    // A part of a step beyond what rounding can have made.
    let count = (dt / (SAFE * body.limit) - 1e-9).ceil().max(1.0);
    let step = dt / count;
    let mut acted = Acted { conducted: vec![0.0; n], seen: vec![0.0; n], products: 0 };
    let mut flow = vec![0.0; n];
    for _ in 0..count as usize {
        body.conduction.flow(families, &scene.ends, t, &mut flow);
        let columns = (&mut *t, &mut acted.conducted[..], &mut acted.seen[..], &flow[..]);
        par::each(
            columns,
            |start, (t, conducted, seen, flow): (&mut [f64], &mut [f64], &mut [f64], &[f64])| {
                for k in 0..t.len() {
                    let i = start + k;
                    conducted[k] += step * flow[k];
                    seen[k] += step * t[k];
                    if scene.capacity[i] > 0.0 && !scene.held[i] {
                        t[k] += step * (flow[k] + scene.source[i] - scene.film[i] * t[k]) / scene.capacity[i];
                    }
                }
            },
        );
    }
    acted
}

/// The heat that has come at an edge.
fn brought(edge: &Edge, scene: &Scene, acted: &Acted, (before, t): (&[f64], &[f64]), dt: f64) -> f64 {
    let [source, film] = edge.each();
    let members = &edge.members;
    par::sum(members.len(), |k| {
        let i = members[k] as usize;
        match edge.boundary.does {
            Does::Holds => scene.capacity[i] * (t[i] - before[i]) - acted.conducted[i] - dt * scene.source[i],
            _ => dt * source - film * acted.seen[i],
        }
    })
}
