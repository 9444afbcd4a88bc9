//! The load at which the bond that opens fastest has opened by a given amount: equilibria of bodies whose bonds soften, past the
//! peak of the load and where it falls with its paths going back (snap-back).
//!
//! Unknown are the free places u and the time t, with r(u, t) = 0 and the length l of one bond given (indirect displacement control:
//! R. de Borst, Comput. Struct. 25, 211 (1987); two solutions for each step: J.-L. Batoz, G. Dhatt, Int. J. Numer. Meth. Eng. 14, 1262
//! (1979)). With p = ∂r/∂t, c = ∂l/∂u, c_t = ∂l/∂t and what is missing of the length, h,
//!
//! ```text
//! K̃ a = r + β c h,   K̃ b = p − β c c_t,   K̃ = K + β c cᵀ
//! Δt = (h − c·a)/(c·b + c_t),   Δu = a + b Δt
//! ```
//!
//! which is the solution of K Δu = r + p Δt with c·Δu + c_t Δt = h for any β; β keeps K̃ away from singular where the bond softens.

use super::Numbers;
use super::balance::{Balance, norm};
use super::linear::{SMALL, Spring};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{dot, length, scale, sub};
use perigrain_statics::six::Six;

/// Newton's steps in which such an equilibrium has to be found.
const STEPS: usize = 25;
/// β over the stiffness of the bond.
const STIFFER: f64 = 4.0;
/// How exactly the first linear systems of a load step are solved, over their loads; later ones more so, as balance comes near.
const FORCING: f64 = 1e-3;
/// The finest that linear systems are solved.
const FINEST: f64 = 1e-9;
/// How often the opening of a load step is halved at most where no balance is found.
const HALVINGS: usize = 10;
/// By how many load steps the load moves at once at most.
const FARTHEST: f64 = 4.0;
/// How far a step moves a particle at most, in distances of neighbours.
const FAR: f64 = 0.5;

/// The bond whose length is given.
#[derive(Clone, Copy, Debug)]
struct Led {
    /// Its place in the network.
    bond: usize,
    ends: [usize; 2],
}

/// A step of places and time.
#[derive(Clone, Debug, Default)]
pub(super) struct Way {
    /// Motions of particles [length].
    field: Vec<Six>,
    /// The part of a load step.
    part: f64,
    /// By how much of its length the bond opened.
    opening: f64,
}

impl Balance<'_> {
    /// Makes a load step in which the bond that opens fastest does so by `opening` of its length. Bonds at their end break there.
    pub fn open(&mut self, opening: f64, made: &mut Numbers) -> Result<()> {
        self.renew(0);
        let way = match std::mem::take(&mut self.way) {
            Some(way) => way,
            None => self.first_way(made)?,
        };
        let lead = self.fastest(&way.field);
        let grows = lead.map_or(0.0, |lead| self.opens(lead, &way.field));
        let parts = way.part * opening / grows;
        let Some(lead) = lead.filter(|_| grows > 0.0 && parts.abs() <= FARTHEST) else {
            // Nothing opens, or too slowly: the load moves as it would without.
            self.reach_end(made)?;
            return self.finish(made);
        };
        let (places, length) = (self.w.particles.x.clone(), self.length_of(lead));
        let (mut size, mut found) = (opening, false);
        for _ in 0..if self.goal.adapt { HALVINGS } else { 1 } {
            let part = size / grows;
            self.lead(part * way.part)?;
            self.step_along();
            for (i, x) in self.w.particles.x.iter_mut().enumerate() {
                for d in (0..3).filter(|d| self.body.frees(i, *d)) {
                    x[d] += part * way.field[i][d];
                }
            }
            found = self.balance_at(lead, ((1.0 + size) * length, size * length), made)?;
            if found {
                break;
            }
            self.w.particles.x.copy_from_slice(&places);
            size *= 0.5;
        }
        if !found {
            return Err(self.stuck(made));
        }
        let x = &self.w.particles.x;
        let moved = |i: usize| sub(x[i], places[i]);
        let field = (0..x.len()).map(|i| {
            let [a, b, c] = moved(i);
            [a, b, c, 0.0, 0.0, 0.0]
        });
        let field = field.collect();
        self.way = Some(Way { field, part: self.part[0], opening: size });
        made.broken = self.settle_open(lead, made)?;
        self.finish(made)
    }

    /// Breaks what is beyond its end, with the load moving so that the fastest bond that is left keeps its length.
    fn settle_open(&mut self, lead: Led, made: &mut Numbers) -> Result<usize> {
        let (mut all, mut lead) = (0, Some(lead));
        for round in 0..self.goal.most {
            let broken = self.settle(round > 0, true)?;
            all += broken;
            if broken == 0 || self.w.settings.stops() {
                break;
            }
            self.renew(0);
            let field = self.way.as_ref().map_or(vec![], |way| way.field.clone());
            lead = self.fastest(&field).or(lead);
            let places = self.w.particles.x.clone();
            let held = match lead {
                Some(lead) => {
                    let length = self.length_of(lead);
                    self.balance_at(
                        lead,
                        (length, length * self.way.as_ref().map_or(1.0, |way| way.opening)),
                        made,
                    )?
                }
                None => false,
            };
            if !held {
                self.w.particles.x = places;
                self.rebalance(made)?;
            }
        }
        Ok(all)
    }

    /// The elastic motion under a whole load step.
    fn first_way(&mut self, made: &mut Numbers) -> Result<Way> {
        self.residual(true)?;
        let r = self.unbalanced();
        let (base, here) = (self.w.particles.x.clone(), self.w.particles.f.clone());
        let load = self.forces_of_time(0.0, &r)?;
        let mut field = vec![[0.0; 6]; r.len()];
        self.solve((&base, &here), &load, &mut field, (FORCING, None), made)?;
        self.along(&mut field);
        Ok(Way { field, part: 1.0, opening: 0.0 })
    }

    /// Adds the path of what is led.
    fn along(&self, field: &mut [Six]) {
        for (i, row) in field.iter_mut().enumerate() {
            for d in (0..3).filter(|d| self.body.leads(i, *d)) {
                row[d] = self.path[i][d];
            }
        }
    }

    /// p = ∂r/∂t for a whole load step, at a part of it where the unbalanced forces are r; the path of the led particles is left in `path`, and the
    /// clock at the next load step's place.
    fn forces_of_time(&mut self, part: f64, r: &[Six]) -> Result<Vec<Six>> {
        self.lead(part + 1.0)?;
        let base = self.w.particles.x.clone();
        self.residual(false)?;
        let later = self.unbalanced();
        let most = self.path.iter().flatten().fold(0.0, |m: f64, a| m.max(a.abs()));
        let mut ahead = later.clone();
        let share = if most > 0.0 { (SMALL * self.body.size / most).min(1.0) } else { 1.0 };
        if most > 0.0 {
            for ((x, from), path) in self.w.particles.x.iter_mut().zip(&base).zip(&self.path) {
                *x = std::array::from_fn(|d| from[d] + share * path[d]);
            }
            self.residual(false)?;
            ahead = self.unbalanced();
        }
        self.w.particles.x.copy_from_slice(&base);
        let of =
            |k: usize| std::array::from_fn(|c| later[k][c] - r[k][c] + (ahead[k][c] - later[k][c]) / share);
        Ok((0..r.len()).map(|k| self.blocks.free(k, &of(k))).collect())
    }

    /// The bond that opens fastest in a motion.
    fn fastest(&self, field: &[Six]) -> Option<Led> {
        let network = &self.body.network;
        let mut best: Option<(f64, Led)> = None;
        for bond in 0..network.bonds() {
            let led = Led { bond, ends: network.pairs.ends[bond].map(|end| end as usize) };
            let opens = self.opens(led, field);
            if best.is_none_or(|(most, _)| opens > most) {
                best = Some((opens, led));
            }
        }
        best.map(|(_, led)| led)
    }

    /// By how much of its length a bond opens in a motion.
    fn opens(&self, led: Led, field: &[Six]) -> f64 {
        let (network, [a, b]) = (&self.body.network, led.ends);
        let of = |end: usize| field.get(end).map_or([0.0; 3], |u| [u[0], u[1], u[2]]);
        let d = network.d(led.bond);
        dot(d, sub(of(b), of(a))) / dot(d, d)
    }

    fn vector_of(&self, led: Led) -> [f64; 3] {
        let x = &self.w.particles.x;
        self.w.periods().nearest(sub(x[led.ends[1]], x[led.ends[0]]))
    }

    fn length_of(&self, led: Led) -> f64 {
        length(self.vector_of(led))
    }

    /// Balances where this bond has the length `goal`, from the present places and time on; its length changes by `range` in this load step.
    /// `false`: no balance was found.
    fn balance_at(&mut self, led: Led, (goal, range): (f64, f64), made: &mut Numbers) -> Result<bool> {
        let (mut forcing, mut worst) = (FORCING, f64::INFINITY);
        for _ in 0..STEPS {
            self.residual(true)?;
            let mut r = self.unbalanced();
            let (size, d) = (norm(&r), self.vector_of(led));
            let (scale_of, missing) =
                (self.ledger.scale(self.w, &self.body).max(f64::MIN_POSITIVE), goal - length(d));
            made.force = size / scale_of;
            let off = made.force.max(missing.abs() / range.abs());
            if off <= self.goal.tol {
                return Ok(true);
            }
            if !off.is_finite() || off > 1e3 * worst.max(1.0) {
                return Ok(false);
            }
            forcing = if worst.is_finite() { (off / worst).powi(2).clamp(FINEST, forcing) } else { forcing };
            worst = worst.min(off);
            let (base, here) = (self.w.particles.x.clone(), self.w.particles.f.clone());
            let part = self.part[0];
            let mut p = self.forces_of_time(part, &r)?;
            let path = std::mem::take(&mut self.path);
            self.lead(part)?;
            let spring = Spring {
                ends: led.ends,
                n: scale(1.0 / length(d), d),
                stiffness: STIFFER * self.body.network.k[led.bond].normal.abs(),
            };
            let led_by = |i: usize, d: usize| if self.body.leads(i, d) { path[i][d] } else { 0.0 };
            let motion: Vec<Six> =
                (0..path.len()).map(|i| [led_by(i, 0), led_by(i, 1), led_by(i, 2), 0.0, 0.0, 0.0]).collect();
            let with_time = spring.opens(&motion);
            spring.pull(spring.stiffness * missing, &mut r);
            spring.pull(-spring.stiffness * with_time, &mut p);
            for rows in [&mut r, &mut p] {
                for end in led.ends {
                    rows[end] = self.blocks.free(end, &rows[end]);
                }
            }
            let (mut a, mut b) = (vec![[0.0; 6]; r.len()], vec![[0.0; 6]; r.len()]);
            self.solve((&base, &here), &r, &mut a, (forcing, Some(&spring)), made)?;
            self.solve((&base, &here), &p, &mut b, (forcing, Some(&spring)), made)?;
            made.newton += 1;
            let step = (missing - spring.opens(&a)) / (spring.opens(&b) + with_time);
            if !step.is_finite() {
                return Ok(false);
            }
            let field: Vec<Six> =
                a.iter().zip(&b).map(|(a, b)| std::array::from_fn(|c| a[c] + step * b[c])).collect();
            let most = field.iter().flat_map(|u| &u[..3]).fold(0.0, |m: f64, a| m.max(a.abs()));
            let share = (FAR * self.body.size / most).min(1.0);
            self.lead(part + share * step)?;
            self.place(&base, &field, share);
            self.step_along();
        }
        Ok(false)
    }
}
