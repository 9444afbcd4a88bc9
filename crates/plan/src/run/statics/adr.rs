//! Adaptive dynamic relaxation: damped motion with masses that suit the stiffness, where no tangent serves.
//!
//! Unit time steps; v_½ = ½ f/m, then v ← [(2 − c) v + 2 f/m]/(2 + c), x ← x + v, with the damping c = 2 √q of the slowest mode that
//! moves, q = −v·(f − f_old)/(v·m v) (Underwood 1983; Kilic & Madenci 2010, with increments instead of totals).

use super::Numbers;
use super::balance::{Balance, norm};
use perigrain_base::diag::Result;
use perigrain_base::par;
use perigrain_statics::six::{Six, full};

/// Masses over those at which the stiffest mode of springs is at its limit.
const SAFE: f64 = 1.02;
/// Steps at most.
const STEPS: usize = 200_000;
/// Damping at most, of 2 where motion stops within a step.
const DAMPED: f64 = 1.9;
/// An unbalanced force that has grown by this factor is that of a motion which runs away: masses are doubled.
const RUNS_AWAY: f64 = 1e3;

impl Balance<'_> {
    /// Relaxes from where the particles are to balance. `false`: it was not found.
    pub fn relax(&mut self, made: &mut Numbers) -> Result<bool> {
        let (base, mut masses) = (self.w.particles.x.clone(), self.masses());
        for _ in 0..10 {
            match self.relax_with(&masses, made)? {
                Some(found) => return Ok(found),
                None => {
                    self.w.particles.x.copy_from_slice(&base);
                    masses.iter_mut().for_each(|m| *m *= 2.0);
                }
            }
        }
        Ok(false)
    }

    /// The same with these masses; `None` where the motion runs away.
    fn relax_with(&mut self, masses: &[f64], made: &mut Numbers) -> Result<Option<bool>> {
        self.residual(true)?;
        let mut f = self.unbalanced();
        let (first, n) = (norm(&f), f.len());
        let mut v = vec![[0.0; 3]; n];
        for step in 0..STEPS {
            let scale = self.ledger.scale(self.w, &self.body).max(f64::MIN_POSITIVE);
            made.force = norm(&f) / scale;
            if made.force <= self.goal.tol || norm(&f) == 0.0 {
                return Ok(Some(true));
            }
            if self.w.settings.stops() {
                return Ok(Some(false));
            }
            if !made.force.is_finite() || norm(&f) > RUNS_AWAY * first.max(scale) {
                return Ok(None);
            }
            self.move_on(masses, &f, &mut v, step == 0);
            made.products += 1;
            let before = std::mem::take(&mut f);
            self.residual(true)?;
            f = self.unbalanced();
            let [stiff, moved] = power(masses, &v, [&before, &f]);
            self.damping = if moved > 0.0 { 2.0 * (stiff / moved).max(0.0).sqrt() } else { 0.0 }.min(DAMPED);
        }
        Ok(Some(false))
    }

    /// One step of the damped motion.
    fn move_on(&mut self, masses: &[f64], f: &[Six], v: &mut [[f64; 3]], first: bool) {
        let c = self.damping;
        let columns = (&mut self.w.particles.x[..], v, f, masses);
        par::each(columns, |_, (x, v, f, m)| {
            for k in 0..x.len() {
                for d in 0..3 {
                    let pull = f[k][d] / m[k];
                    v[k][d] = if first { 0.5 * pull } else { ((2.0 - c) * v[k][d] + 2.0 * pull) / (2.0 + c) };
                    x[k][d] += v[k][d];
                }
            }
        });
    }

    /// Masses of unit steps: half of the largest eigenvalue of each particle's block, doubled as K is at most twice its diagonal
    /// blocks; the mean of the others where a particle has no bonds.
    fn masses(&self) -> Vec<f64> {
        let mut masses = vec![0.0; self.body.weight.len()];
        self.body.network.blocks_into(&mut masses, |_, block, m| {
            let block = full(block);
            // No eigenvalue is above the largest sum of a row.
            let row = |r: usize| (0..3).map(|c| block[r][c].abs()).sum::<f64>();
            *m = SAFE * 0.5 * row(0).max(row(1)).max(row(2));
        });
        let (sum, count) = masses.iter().filter(|m| **m > 0.0).fold((0.0, 0), |(s, n), m| (s + m, n + 1));
        let mean = if count > 0 { sum / f64::from(count) } else { 1.0 };
        masses.iter_mut().filter(|m| **m <= 0.0).for_each(|m| *m = mean);
        masses
    }
}

/// v·(f_old − f) and v·m v.
fn power(masses: &[f64], v: &[[f64; 3]], [before, now]: [&[Six]; 2]) -> [f64; 2] {
    let of = |k: usize| {
        (0..3).fold([0.0; 2], |[a, b], d| {
            [a + v[k][d] * (before[k][d] - now[k][d]), b + masses[k] * v[k][d] * v[k][d]]
        })
    };
    [par::sum(v.len(), |k| of(k)[0]), par::sum(v.len(), |k| of(k)[1])]
}
