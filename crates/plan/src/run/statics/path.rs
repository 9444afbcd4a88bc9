//! The load of a load step: all of it, cut where no balance is found, or so much that a bond is at its limit.

use super::balance::Balance;
use super::{Breaking, Numbers};
use crate::Stage;
use crate::run::verlet::tick;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_world::{Clock, Columns, Named, World};

/// Load steps are cut down to this part.
const SHORTEST: f64 = 1.0 / 1024.0;
/// After so many cuts in a row a part is relaxed instead.
const PATIENCE: usize = 3;
/// How much longer parts become where the last one was balanced.
const LONGER: f64 = 1.5;
/// A bond breaks where its load ratio lies between 1 and this above it, and the middle is aimed at.
const ABOVE: f64 = 1e-3;
/// How often the load is sought at which a bond is at its limit.
const SOLUTIONS: usize = 8;
/// The springs of living bonds are found anew within a load step where one in so many has broken since.
const RENEWED: usize = 100;
/// By how many load steps damage control moves the load at once at most.
const FARTHEST: f64 = 4.0;

/// The scene at the beginning of a load step, from where its paths begin for any part of it.
#[derive(Debug)]
pub(in crate::run) struct Start {
    clock: Clock,
    memo: Named<Vec<f64>>,
    columns: Columns,
}

impl Start {
    /// The scene as it is.
    pub fn of(w: &World) -> Self {
        Self { clock: (*w.clock).clone(), memo: (*w.memo).clone(), columns: (*w.columns).clone() }
    }

    /// The time of one load step.
    pub fn dt(&self) -> f64 {
        self.clock.dt
    }
}

impl Balance<'_> {
    /// Moves the clock by a part of the load step from its beginning, and finds how far what stands on paths moves from where it is;
    /// it stays there.
    pub(super) fn lead(&mut self, part: f64) -> Result<()> {
        if self.w.clock.step > self.start.clock.step {
            // Not the first attempt of this load step.
            *self.w.memo = self.start.memo.clone();
            *self.w.columns = self.start.columns.clone();
        }
        *self.w.clock = self.start.clock.clone();
        self.w.clock.set_dt(part * self.start.clock.dt);
        self.part[0] = part;
        self.w.clock.step += 1;
        let t = tick(self.w, false);
        let from = self.w.particles.x.clone();
        self.plan.run(self.w, &t, &[Stage::InitialIntegrate, Stage::PostIntegrate])?;
        self.w.particles.v.fill([0.0; 3]);
        let (x, body) = (&mut self.w.particles.x, &self.body);
        self.path = vec![[0.0; 3]; x.len()];
        for i in 0..x.len() {
            for d in (0..3).filter(|d| body.leads(i, *d)) {
                self.path[i][d] = x[i][d] - from[i][d];
            }
        }
        x.copy_from_slice(&from);
        Ok(())
    }

    /// Balances at a part of the load step, coming from another. `false`: it is not found, and the particles are where they were.
    fn reach(&mut self, (from, part): (f64, f64), made: &mut Numbers) -> Result<bool> {
        let before = self.w.particles.x.clone();
        self.lead(part)?;
        let found = self.follow(part - from, made)?;
        if !found {
            self.w.particles.x = before;
            self.last.0.fill([0.0; 6]);
        }
        Ok(found)
    }

    /// The same by relaxation.
    fn reach_relaxed(&mut self, part: f64, made: &mut Numbers) -> Result<bool> {
        let before = self.w.particles.x.clone();
        self.lead(part)?;
        self.step_along();
        let found = self.relax(made)?;
        if !found {
            self.w.particles.x = before;
        }
        Ok(found)
    }

    /// The whole load step, in as many parts as it takes; the first bond of it that breaks alone does so where it is at its limit.
    pub fn reach_end(&mut self, made: &mut Numbers) -> Result<()> {
        let (mut done, mut size, mut failed) = (0.0, 1.0f64, 0);
        let mut seeks = self.goal.breaking == Breaking::One && self.w.families.is_some();
        while done < 1.0 {
            let part = if done + size > 1.0 - SHORTEST { 1.0 } else { done + size };
            if !self.reach((done, part), made)? {
                size *= 0.5;
                failed += 1;
                if !self.goal.adapt || size < SHORTEST {
                    return Err(self.stuck(made));
                }
                if failed < PATIENCE || !self.reach_relaxed(part, made)? {
                    continue;
                }
            }
            (done, failed) = (part, 0);
            if seeks {
                let ratio = self.load_ratio()?;
                if ratio > 1.0 + ABOVE {
                    seeks = false;
                    let before = self.ratio.0;
                    done = self.onset([(done - size.min(done), before), (part, ratio)], made)?;
                } else {
                    self.ratio.0 = ratio;
                }
            }
            made.broken += self.cascade(false, made)?;
            if self.runs_away || self.w.settings.stops() {
                return Ok(());
            }
            size = (LONGER * size).min(1.0);
        }
        Ok(())
    }

    /// Between a load at which all bonds are below their limits and one at which some are beyond, the one at which the first is at
    /// its limit (regula falsi by Illinois).
    fn onset(&mut self, [mut low, mut high]: [(f64, f64); 2], made: &mut Numbers) -> Result<f64> {
        let goal = 1.0 + 0.5 * ABOVE;
        let mut at = high.0;
        if low.1 >= 1.0 {
            return Ok(at);
        }
        let (mut values, mut side) = ([low.1 - goal, high.1 - goal], 0);
        let mut lost = false;
        for _ in 0..SOLUTIONS {
            let part = (low.0 * values[1] - high.0 * values[0]) / (values[1] - values[0]);
            if !self.reach((at, part), made)? {
                lost = true;
                break;
            }
            at = part;
            let ratio = self.load_ratio()?;
            if (ratio - goal).abs() <= 0.5 * ABOVE {
                return Ok(at);
            }
            let above = ratio > goal;
            let (end, value, other) = if above { (&mut high, 1, 0) } else { (&mut low, 0, 1) };
            *end = (part, ratio);
            values[value] = ratio - goal;
            if side == if above { 1 } else { -1 } {
                values[other] *= 0.5;
            }
            side = if above { 1 } else { -1 };
        }
        // The last place may be one at which nothing breaks, and the clock may stand where no balance was found.
        if (at != high.0 || lost) && !self.reach((at, high.0), made)? {
            return Err(self.stuck(made));
        }
        Ok(high.0)
    }

    /// Breaks bonds at this load until none is beyond its limit, and balances after each; `torn`: some have broken before. How many broke.
    pub fn cascade(&mut self, torn: bool, made: &mut Numbers) -> Result<usize> {
        let mut all = 0;
        for round in 0.. {
            let broken = self.settle(torn || round > 0, true)?;
            all += broken;
            if broken == 0 {
                break;
            }
            if round == self.goal.most {
                self.runs_away = true;
                let step = self.w.clock.step - self.w.clock.first;
                let text = format!(
                    "bonds still break after {round} equilibria of load step {step}: the line ends there, out of balance"
                );
                let d = Diagnostic::warning(Code::HALTED, None, text);
                self.w.notes.0.push(d.help("a `run` behind it lets the crack run; more load steps or a larger `most` follow it longer"));
                return Ok(all);
            }
            self.renew(self.body.network.bonds() / RENEWED);
            self.rebalance(made)?;
            if self.w.settings.stops() {
                self.settle(true, false)?;
                break;
            }
        }
        if self.goal.breaking == Breaking::One && self.w.families.is_some() {
            self.ratio.0 = self.load_ratio()?;
        }
        Ok(all)
    }

    /// Balances behind a break: where Newton's method does not find it, by relaxation.
    pub fn rebalance(&mut self, made: &mut Numbers) -> Result<()> {
        let from = self.w.particles.x.clone();
        if self.balance(made)? {
            return Ok(());
        }
        self.w.particles.x = from;
        if self.relax(made)? { Ok(()) } else { Err(self.stuck(made)) }
    }

    /// Moves the load, forwards or back, to where the bond with the largest load ratio is at its limit, and breaks it. How many broke:
    /// none if no load within reach of this load step does it.
    pub fn reach_limit(&mut self, made: &mut Numbers) -> Result<usize> {
        let goal = 1.0 + 0.5 * ABOVE;
        let (mut at, mut ratio) = (0.0, self.ratio.0);
        let mut next = match self.ratio.1 > 0.0 {
            true => ((goal - ratio) / self.ratio.1).clamp(-FARTHEST, FARTHEST),
            false => 1.0,
        };
        let mut cuts = 0;
        for _ in 0..4 * SOLUTIONS {
            if !self.reach((at, next), made)? {
                cuts += 1;
                if !self.goal.adapt || cuts > 10 {
                    return Err(self.stuck(made));
                }
                next = at + 0.5 * (next - at);
                continue;
            }
            let now = self.load_ratio()?;
            if next != at && (now - ratio) / (next - at) > 0.0 {
                self.ratio.1 = (now - ratio) / (next - at);
            }
            (at, ratio) = (next, now);
            if (ratio - goal).abs() <= 0.5 * ABOVE {
                self.ratio.0 = ratio;
                return self.settle(false, true);
            }
            if self.ratio.1 <= 0.0 || (ratio < goal && at >= FARTHEST) {
                break;
            }
            next = (at + (goal - ratio) / self.ratio.1).clamp(at - FARTHEST, at + FARTHEST);
        }
        self.ratio.0 = ratio;
        self.settle(false, false)?;
        Ok(0)
    }

    /// The largest load ratio of bonds where the particles are, and forces have been computed.
    pub fn load_ratio(&mut self) -> Result<f64> {
        self.residual(false)?;
        Ok((self.scene.ratio)(self.w))
    }
}
