//! A step of heat conduction that is stable for any length: backward Euler (θ = 1) or Crank and Nicolson's rule (θ = ½).

use perigrain_base::par;

/// How exactly the linear system is solved, over its right side.
pub const EXACT: f64 = 1e-10;

/// A step of C dT/dt = flow(T) − G T + q for the particles that conduct.
#[derive(Debug)]
pub struct Step<'a> {
    /// Heat capacities C [energy/temperature]; 0 where a particle does not conduct.
    pub capacity: &'a [f64],
    /// Σ_j g_ij of each particle.
    pub conductance: &'a [f64],
    /// G: what a film conducts to a fluid around [energy/(time temperature)].
    pub film: &'a [f64],
    /// q: heat from elsewhere, and G times the temperature of the fluid [energy/time].
    pub source: &'a [f64],
    /// Particles whose temperature is given: `t` has the new one already.
    pub held: &'a [bool],
    /// The length of the step.
    pub dt: f64,
    /// θ.
    pub theta: f64,
}

/// How a step went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Solved {
    /// Products with the matrix.
    pub products: usize,
    /// What is left of the right side.
    pub left: f64,
}

impl Step<'_> {
    /// Brings `t` from its values at the step's beginning, `before`, to those at the end; in the end `flow` holds Σ g (T_j − T_i) of the
    /// mean temperatures θ T + (1 − θ) T_before. Preconditioned conjugate gradients (Jacobi) on the rise of the free particles.
    pub fn solve(
        &self,
        conduct: impl Fn(&[f64], &mut [f64]),
        before: &[f64],
        t: &mut [f64],
        flow: &mut [f64],
        most: usize,
    ) -> Solved {
        let n = t.len();
        let free = |i: usize| self.capacity[i] > 0.0 && !self.held[i];
        let rate = |i: usize| self.capacity[i] / self.dt;
        let diagonal = |i: usize| rate(i) + self.theta * (self.conductance[i] + self.film[i]);
        // The rise of free particles begins at 0, that of held ones is known.
        for i in (0..n).filter(|i| free(*i)) {
            t[i] = before[i];
        }
        let mean = |t: &[f64], out: &mut Vec<f64>| {
            out.clear();
            out.extend(t.iter().zip(before).map(|(t, before)| self.theta * t + (1.0 - self.theta) * before));
        };
        let mut temperature = Vec::with_capacity(n);
        mean(t, &mut temperature);
        conduct(&temperature, flow);
        let right = |i: usize, flow: &[f64], mean: &[f64]| flow[i] + self.source[i] - self.film[i] * mean[i];
        let mut r: Vec<f64> =
            (0..n).map(|i| if free(i) { right(i, flow, &temperature) } else { 0.0 }).collect();
        let mut p: Vec<f64> = (0..n).map(|i| if free(i) { r[i] / diagonal(i) } else { 0.0 }).collect();
        let mut product = vec![0.0; n];
        let size = par::sum(n, |i| r[i] * r[i]).sqrt();
        let mut rz = par::sum(n, |i| r[i] * p[i]);
        let mut solved = Solved { products: 1, left: if size > 0.0 { 1.0 } else { 0.0 } };
        while solved.left > EXACT && solved.products < most {
            conduct(&p, &mut product);
            solved.products += 1;
            for i in 0..n {
                product[i] = match free(i) {
                    true => rate(i) * p[i] + self.theta * (self.film[i] * p[i] - product[i]),
                    false => 0.0,
                };
            }
            let step = rz / par::sum(n, |i| p[i] * product[i]);
            for i in 0..n {
                t[i] += step * p[i];
                r[i] -= step * product[i];
            }
            solved.left = par::sum(n, |i| r[i] * r[i]).sqrt() / size;
            let next = par::sum(n, |i| if free(i) { r[i] * r[i] / diagonal(i) } else { 0.0 });
            let (by, old) = (next / rz, &p);
            p = (0..n).map(|i| if free(i) { r[i] / diagonal(i) + by * old[i] } else { 0.0 }).collect();
            rz = next;
        }
        self.balance(before, t);
        mean(t, &mut temperature);
        conduct(&temperature, flow);
        solved.products += 1;
        solved
    }

    /// Gives all the same small rise that makes the heat of the body right to rounding, where nothing but sources brings any.
    fn balance(&self, before: &[f64], t: &mut [f64]) {
        let n = t.len();
        let conducts = |i: &usize| self.capacity[*i] > 0.0;
        if (0..n).any(|i| conducts(&i) && (self.held[i] || self.film[i] > 0.0)) {
            return;
        }
        let brought = par::sum(n, |i| if conducts(&i) { self.dt * self.source[i] } else { 0.0 });
        let taken = par::sum(n, |i| self.capacity[i] * (t[i] - before[i]));
        let whole = par::sum(n, |i| self.capacity[i]);
        if whole > 0.0 {
            let rise = (brought - taken) / whole;
            (0..n).filter(conducts).for_each(|i| t[i] += rise);
        }
    }
}
