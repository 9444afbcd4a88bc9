//! Preconditioned minimal residuals: linear systems whose matrix is symmetric and need not be definite, as the tangent of a
//! body whose bonds soften.
//!
//! C. C. Paige, M. A. Saunders, SIAM J. Numer. Anal. 12, 617 (1975); with a preconditioner as in H. C. Elman, D. J. Silvester,
//! A. J. Wathen, Finite Elements and Fast Iterative Solvers (2005), algorithm 6.1.

use super::pcg::{Preconditioner, Solved, inner};
use super::six::Six;
use perigrain_base::par;

/// Solves K u = load for the free components of `field`, starting from zero, until the residual in the norm of M⁻¹ is `left` of the load's or
/// `most` steps are done. `product(u, out)` gives out = K u for a symmetric K.
pub fn solve(
    product: impl Fn(&[Six], &mut [Six]),
    by: &mut Preconditioner,
    load: &[Six],
    field: &mut [Six],
    (left, most): (f64, usize),
) -> Solved {
    let (n, blocks) = (field.len(), by.blocks);
    field.fill([0.0; 6]);
    by.make();
    let zeros = || vec![[0.0; 6]; n];
    // Vectors of Lanczos' process (v, z = M⁻¹ v) and directions (w), each with its predecessor.
    let (mut v_before, mut v, mut z) = (zeros(), zeros(), zeros());
    let (mut w_before, mut w, mut kz) = (zeros(), zeros(), zeros());
    par::each((&mut v[..], load), |start, (v, load): (&mut [Six], &[Six])| {
        v.iter_mut().zip(load).enumerate().for_each(|(k, (v, load))| *v = blocks.free(start + k, load));
    });
    by.apply(&v, &mut z);
    let mut gamma = sum(&v, &z).max(0.0).sqrt();
    let (first, mut eta, mut gamma_before) = (gamma, gamma, 1.0);
    // Rotations of the last two steps.
    let ([mut c_before, mut c], [mut s_before, mut s]) = ([1.0; 2], [0.0; 2]);
    let mut out = Solved { iterations: 0, energy: 0.0, open: f64::NAN, done: true };
    while eta.abs() > left * first && gamma > 0.0 {
        if out.iterations >= most || perigrain_base::stop::cuts() {
            out.done = false;
            break;
        }
        z.iter_mut().flatten().for_each(|a| *a /= gamma);
        product(&z, &mut kz);
        let delta = par::sum(n, |k| inner(&z[k], &blocks.free(k, &kz[k])));
        let (along, back) = (delta / gamma, if out.iterations == 0 { 0.0 } else { gamma / gamma_before });
        for k in 0..n {
            let row = blocks.free(k, &kz[k]);
            let next = std::array::from_fn(|c| row[c] - along * v[k][c] - back * v_before[k][c]);
            v_before[k] = std::mem::replace(&mut v[k], next);
        }
        let z_now = z.clone();
        by.apply(&v, &mut z);
        let gamma_next = sum(&v, &z).max(0.0).sqrt();
        let [a0, a2, a3] =
            [c * delta - c_before * s * gamma, s * delta + c_before * c * gamma, s_before * gamma];
        let a1 = a0.hypot(gamma_next);
        if a1 == 0.0 || !a1.is_finite() {
            // The matrix takes this direction to nothing.
            out.done = false;
            break;
        }
        (c_before, s_before) = (c, s);
        (c, s) = (a0 / a1, gamma_next / a1);
        for k in 0..n {
            let next = std::array::from_fn(|d| (z_now[k][d] - a3 * w_before[k][d] - a2 * w[k][d]) / a1);
            w_before[k] = std::mem::replace(&mut w[k], next);
            (0..6).for_each(|d| field[k][d] += c * eta * next[d]);
        }
        eta *= -s;
        (gamma_before, gamma) = (gamma, gamma_next);
        out.iterations += 1;
    }
    out
}

fn sum(a: &[Six], b: &[Six]) -> f64 {
    par::sum(a.len(), |k| inner(&a[k], &b[k]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::Network;
    use crate::precond::Blocks;
    use perigrain_bonded::stiffness::Stiffness;

    /// A row of springs between two held ends, one of which has a negative stiffness: by elimination u_2 is known. 1e-10 leaves some
    /// roundings of a matrix whose condition is some tens.
    #[test]
    fn a_spring_that_pushes_is_solved_with() {
        let (n, soft) = (12, 4);
        let ends: Vec<[u32; 2]> = (0..n as u32 - 1).map(|k| [k, k + 1]).collect();
        let of = |normal: f64| Stiffness { normal, ..Stiffness::default() };
        let network = Network::new(n, &ends, |_| ([1.0, 0.0, 0.0], of(1.0)));
        let stiffness = |k: usize| if k == soft { -0.7 } else { 1.0 };
        let held: Vec<u8> =
            (0..n).map(|i| if i == 0 || i == n - 1 { 0b111_111 } else { 0b111_110 }).collect();
        let blocks = Blocks::of_network(&network, &held);
        let product = |u: &[Six], out: &mut [Six]| {
            out.fill([0.0; 6]);
            for k in 0..n - 1 {
                let pull = stiffness(k) * (u[k + 1][0] - u[k][0]);
                out[k][0] -= pull;
                out[k + 1][0] += pull;
            }
        };
        let mut load = vec![[0.0; 6]; n];
        load[3][0] = 1.0;
        let mut field = vec![[0.0; 6]; n];
        let solved = solve(product, &mut Preconditioner::plain(&blocks), &load, &mut field, (1e-13, 100));
        assert!(solved.done && solved.iterations <= n, "{solved:?}");
        let mut back = vec![[0.0; 6]; n];
        product(&field, &mut back);
        for k in 1..n - 1 {
            assert!((back[k][0] - load[k][0]).abs() < 1e-10, "{k} {back:?}");
        }
        // Compliances add up: of the force 1, the left part (springs 0 to 2) bears R/(L + R) with L = 3 and R = 7 − 1/0.7.
        let (left, right) = (3.0, 7.0 - 1.0 / 0.7);
        let expected = right / (left + right) * left;
        assert!((field[3][0] - expected).abs() < 1e-10, "{} {expected}", field[3][0]);
    }
}
