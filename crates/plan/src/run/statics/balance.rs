//! From a place out of balance to one in balance: Newton's method over the ops of a plan.

use super::ledger::Books;
use super::linear::SMALL;
use super::opening::Way;
use super::path::Start;
use super::{Body, Breaking, Goal, Numbers, Scene, Solver};
use crate::run::verlet::tick;
use crate::{Stage, StepPlan, Tick};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result};
use perigrain_base::par;
use perigrain_statics::coarse::Coarse;
use perigrain_statics::precond::Blocks;
use perigrain_statics::six::Six;
use perigrain_world::World;

/// Newton's steps in which a body has to be balanced.
const STEPS: usize = 40;
/// How often a step is halved where its end is farther from balance than its beginning.
const HALVINGS: usize = 30;
/// Where so little is left over reactions and loads and two steps in a row do not halve it, it is rounding: a stretch
/// below 4e-13 carries no force, beside those of 1e-7 and more that loads make.
const ROUNDING: f64 = 1e-6;
/// How far a step moves a particle at most, in distances of neighbours.
const FARTHEST: f64 = 0.5;
/// How exactly the first linear system of a load step is solved, over its load; later ones more so (Eisenstat and Walker).
const FORCING: f64 = 0.1;
/// The same of the way that the tangent predicts for a load step.
const AHEAD: f64 = 1e-3;
/// How exactly the linear system of a last step is solved, over the tolerance.
const EXACT: f64 = 0.3;
/// A step past the end of which the force along it points back by more than this part is too long.
const BACK: f64 = 0.5;

/// A body that is balanced load step by load step.
pub(in crate::run) struct Balance<'a> {
    pub plan: &'a mut StepPlan,
    pub w: &'a mut World,
    pub body: Body,
    pub goal: Goal,
    pub ledger: Books,
    pub blocks: Blocks,
    /// What is read from the scene.
    pub scene: Scene,
    /// The damping of relaxation, which lasts from one equilibrium to the next.
    pub damping: f64,
    pub(super) coarse: Option<Coarse>,
    /// How far led particles move from where they are.
    pub path: Vec<[f64; 3]>,
    /// How the free ones moved last: where the next solution begins, and for which part of a load step.
    pub last: (Vec<Six>, f64),
    /// The scene at the beginning of the load step.
    pub start: Start,
    /// The largest load ratio of bonds at the last equilibrium, and by how much it grows in one load step.
    pub ratio: (f64, f64),
    /// The part of the load step at the present place, and the one up to which bonds remember.
    pub part: [f64; 2],
    /// How the last load step went whose opening was given.
    pub(super) way: Option<Way>,
    /// Bonds that broke since their springs were found.
    pub stale: usize,
    /// Bonds still broke after as many equilibria of a load step as there may be.
    pub runs_away: bool,
    /// The first load step begins out of balance.
    pub unsettled: bool,
}

impl<'a> Balance<'a> {
    /// A body as it is.
    pub fn new(plan: &'a mut StepPlan, w: &'a mut World, body: Body, (scene, goal): (Scene, Goal)) -> Self {
        let blocks = Blocks::of_network(&body.network, &body.held);
        let (last, start) = ((vec![[0.0; 6]; w.n()], 1.0), Start::of(w));
        let ledger = Books::default();
        Self {
            plan,
            w,
            body,
            goal,
            ledger,
            blocks,
            scene,
            damping: 0.0,
            coarse: None,
            path: vec![],
            last,
            start,
            ratio: (0.0, 0.0),
            part: [0.0; 2],
            way: None,
            stale: 0,
            unsettled: false,
            runs_away: false,
        }
    }

    /// Takes note of the bonds that live now, where more than this have broken since it was done.
    pub fn renew(&mut self, unless: usize) {
        if self.stale > unless {
            self.body.network = (self.scene.springs)(self.w);
            self.blocks = Blocks::of_network(&self.body.network, &self.body.held);
            (self.stale, self.coarse) = (0, None);
        }
    }

    /// The time over which bonds flow and relax in an evaluation: what they have not yet seen of the load step.
    pub fn time_left(&self) -> f64 {
        (self.part[0] - self.part[1]) * self.start.dt()
    }

    /// Follows what stands on paths, by the tangent, and balances. `share`: which part of a load step the paths are. `false`: no
    /// balance was found.
    pub fn follow(&mut self, share: f64, made: &mut Numbers) -> Result<bool> {
        if self.goal.solver == Solver::Adr {
            self.step_along();
            return self.relax(made);
        }
        self.residual(true)?;
        let (n, base, here) = (self.w.n(), self.w.particles.x.clone(), self.w.particles.f.clone());
        let mut load = self.unbalanced();
        let most = self.path.iter().flatten().fold(0.0, |m: f64, a| m.max(a.abs()));
        if most > 0.0 {
            // What the paths pull, by a small part of them: K of the free particles beside the led ones.
            let part = (SMALL * self.body.size / most).min(1.0);
            for ((x, from), path) in self.w.particles.x.iter_mut().zip(&base).zip(&self.path) {
                *x = std::array::from_fn(|d| from[d] + part * path[d]);
            }
            self.residual(false)?;
            let ahead = self.unbalanced();
            for i in 0..n {
                let before = load[i];
                for d in 0..3 {
                    load[i][d] += (ahead[i][d] - before[d]) / part;
                }
                load[i] = self.blocks.free(i, &load[i]);
            }
        }
        let (mut field, of) = std::mem::take(&mut self.last);
        field.resize(n, [0.0; 6]);
        let scale = if of == 0.0 { 0.0 } else { share / of };
        field.iter_mut().flatten().for_each(|u| *u *= scale);
        self.solve((&base, &here), &load, &mut field, (AHEAD, None), made)?;
        self.w.particles.x = base;
        for i in 0..n {
            for d in 0..3 {
                let moved = if self.body.leads(i, d) { self.path[i][d] } else { field[i][d] };
                self.w.particles.x[i][d] += moved;
            }
        }
        // The next load step begins with this one's motion.
        self.last = (field, share);
        self.balance_from(FORCING, made)
    }

    /// Puts what stands on paths at their ends.
    pub fn step_along(&mut self) {
        for (x, path) in self.w.particles.x.iter_mut().zip(&self.path) {
            *x = std::array::from_fn(|d| x[d] + path[d]);
        }
    }

    /// From where the particles are to balance, by Newton's steps or by relaxation. `false`: it was not found.
    pub fn balance(&mut self, made: &mut Numbers) -> Result<bool> {
        if self.goal.solver == Solver::Adr {
            return self.relax(made);
        }
        // Bodies that one bond less has brought out of balance are almost linear from here to balance.
        self.balance_from(0.0, made)
    }

    /// The same by Newton's steps, of which the first linear system is solved up to this part of its load or the tolerance.
    fn balance_from(&mut self, forcing: f64, made: &mut Numbers) -> Result<bool> {
        self.residual(true)?;
        let mut r = self.unbalanced();
        let mut size = norm(&r);
        let (mut forcing, mut idle) = (forcing, 0);
        for _ in 0..STEPS {
            let scale = self.ledger.scale(self.w, &self.body).max(f64::MIN_POSITIVE);
            made.force = size / scale;
            if size == 0.0 || made.force <= self.goal.tol || (idle > 1 && made.force <= ROUNDING) {
                return Ok(true);
            }
            forcing = forcing.max(EXACT * self.goal.tol * scale / size).min(FORCING);
            let (base, here) = (self.w.particles.x.clone(), self.w.particles.f.clone());
            let mut field = vec![[0.0; 6]; r.len()];
            self.solve((&base, &here), &r, &mut field, (forcing, None), made)?;
            made.newton += 1;
            let mut along = inner(&r, &field);
            if along <= 0.0 {
                // The body gives way at once: down the force, as bonds by themselves resist.
                par::each(&mut field[..], |start, rows: &mut [Six]| {
                    for (k, row) in (start..).zip(rows) {
                        *row = self.blocks.apply(k, &r[k]);
                    }
                });
                along = inner(&r, &field);
            }
            let most = field.iter().flat_map(|u| &u[..3]).fold(0.0, |m: f64, a| m.max(a.abs()));
            let mut part =
                if most > FARTHEST * self.body.size { FARTHEST * self.body.size / most } else { 1.0 };
            let before = size;
            for halving in 0.. {
                self.place(&base, &field, part);
                self.residual(true)?;
                r = self.unbalanced();
                size = norm(&r);
                let not_past = inner(&r, &field) >= -BACK * along && halving < HALVINGS / 2;
                if size < before || (size.is_finite() && not_past) {
                    break;
                }
                if halving == HALVINGS {
                    return Ok(false);
                }
                part *= 0.5;
            }
            // The error of the energy norm falls with the force: e² = r·K⁻¹r, of which r·u was the value before the step.
            made.error = along.max(0.0).sqrt() * size / before;
            forcing = (size / before).powi(2).clamp(1e-4, FORCING);
            idle = if size > 0.5 * before { idle + 1 } else { 0 };
        }
        Ok(false)
    }

    /// Why a load step ends the line.
    pub fn stuck(&self, made: &Numbers) -> Diagnostics {
        let text = format!(
            "load step {} cannot be balanced: after {} of Newton's steps {:.1e} of the reactions are left",
            self.w.clock.step - self.w.clock.first,
            made.newton,
            made.force
        );
        let d = Diagnostic::error(Code::HALTED, None, text);
        d.help("more load steps, fewer loads at a time, or a `run` where the body gives way").into()
    }

    /// Looks at an equilibrium, behind a break or not: what is remembered is remembered, and if `breaks`, bonds beyond their limits
    /// break. The number of bonds that broke.
    pub fn settle(&mut self, torn: bool, breaks: bool) -> Result<usize> {
        let t = Tick { dt: self.time_left(), ..self.tick_of_sums(false) };
        let bonds = self.w.bonds.list.len();
        let mut counted = false;
        if let Some(families) = &mut *self.w.families {
            families.breaking_share = self.goal.breaking.share();
            families.breaking_enabled &= breaks && self.goal.breaking != Breaking::No;
            counted = std::mem::replace(&mut families.counts_losses, true);
        }
        self.w.slots.invalidate();
        self.plan.run(self.w, &t, &[Stage::PreForce, Stage::Force])?;
        self.ledger.inner(self.w, &self.body);
        self.plan.run(self.w, &t, &[Stage::PostForce])?;
        if let Some(families) = &mut *self.w.families {
            families.breaking_share = None;
            families.counts_losses = counted;
        }
        self.part[1] = self.part[0];
        let torn = torn || std::mem::take(&mut self.unsettled);
        self.ledger.balanced(self.w, &self.body, torn);
        let of_families = self.w.families.as_ref().map_or(0, |families| families.broken().len());
        let broken = of_families + bonds.saturating_sub(self.w.bonds.list.len());
        if broken > 0 {
            self.stale += broken;
            self.look_at_energy()?;
            self.ledger.broken(self.w, &self.body);
        }
        Ok(broken)
    }

    /// What belongs to the end of a step: averages, rows, dumps.
    pub fn output(&mut self) -> Result<()> {
        let t = self.tick_of_sums(false);
        self.plan.run(self.w, &t, &[Stage::EndOfStep, Stage::Output])
    }

    /// The tick of an evaluation in which energies are added up.
    pub fn tick_of_sums(&mut self, setup: bool) -> Tick {
        let mut t = tick(self.w, setup);
        self.plan.request_sums(&mut t);
        (t.energy, t.atom_energy) = (true, true);
        t
    }

    /// Forces and energies here; nothing breaks or is remembered.
    pub fn look_at_energy(&mut self) -> Result<()> {
        self.w.slots.invalidate();
        let t = Tick { trial: true, dt: self.time_left(), ..self.tick_of_sums(false) };
        self.plan.run(self.w, &t, &[Stage::PreForce, Stage::Force, Stage::PostForce])
    }

    /// Forces where the particles are. With `lists`, lists of neighbours are made anew where they have to be.
    pub fn residual(&mut self, lists: bool) -> Result<()> {
        let t = Tick { trial: true, dt: self.time_left(), ..tick(self.w, false) };
        let before: &[Stage] = if lists {
            &[Stage::Neighbor, Stage::PreForce, Stage::Force]
        } else {
            &[Stage::PreForce, Stage::Force]
        };
        self.plan.run(self.w, &t, before)?;
        if lists {
            self.ledger.inner(self.w, &self.body);
        }
        self.plan.run(self.w, &t, &[Stage::PostForce])
    }

    /// The forces on free components [force].
    pub fn unbalanced(&self) -> Vec<Six> {
        let (f, body, blocks) = (&self.w.particles.f, &self.body, &self.blocks);
        let mut out = vec![[0.0; 6]; f.len()];
        par::each((&mut out[..], &f[..], &body.weight[..]), |start, (out, f, weight)| {
            for (k, out) in out.iter_mut().enumerate() {
                let [x, y, z] = f[k].map(|a| a * weight[k]);
                *out = blocks.free(start + k, &[x, y, z, 0.0, 0.0, 0.0]);
            }
        });
        out
    }

    pub(super) fn place(&mut self, base: &[[f64; 3]], field: &[Six], part: f64) {
        for ((x, from), u) in self.w.particles.x.iter_mut().zip(base).zip(field) {
            *x = std::array::from_fn(|d| from[d] + part * u[d]);
        }
    }
}

pub(super) fn norm(r: &[Six]) -> f64 {
    inner(r, r).sqrt()
}

pub(super) fn inner(a: &[Six], b: &[Six]) -> f64 {
    par::sum(a.len(), |k| a[k][0] * b[k][0] + a[k][1] * b[k][1] + a[k][2] * b[k][2])
}
