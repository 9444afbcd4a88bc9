//! Fracture of a body under increasing load, without a run: bond after bond, each time in equilibrium.
//!
//! E. Schlangen, J. G. M. van Mier, Cem. Concr. Compos. 14, 105 (1992): for small displacements the loads of
//! all bonds are proportional to the applied load, so that the bond closest to its strength determines the
//! load at which it breaks; the body is then solved again without it.

use super::coarse::Coarse;
use super::dsm::MOST;
use super::ends::Held;
use super::network::Network;
use super::pairs::Lists;
use super::pcg::{MARGIN, Preconditioner, solve};
use super::precond::Blocks;
use super::six::Six;
use perigrain_base::par;
use perigrain_bonded::stiffness::Modes;

/// Relative distance within which bonds break together: equal up to rounding.
const TOGETHER: f64 = 1e-9;
/// Fraction of the body's energy below which it counts as separated.
const TORN: f64 = 1e-9;
/// Error of a solution apart from the change by a break, relative to the energy: rounding.
const ROUNDING: f64 = 1e-13;

/// Bonds that break at one load.
#[derive(Clone, Debug)]
pub struct Break {
    /// Their indices in the network.
    pub bonds: Vec<u32>,
    /// The load, as a fraction of the given displacement.
    pub load: f64,
    /// Energies of the body at the given displacement, before and after [energy].
    pub energy: [f64; 2],
}

impl Break {
    /// The force between the ends at the break, for the given displacement `delta` [force].
    pub fn force(&self, delta: f64) -> f64 {
        2.0 * self.energy[0] * self.load / delta
    }

    /// The energy released at fixed ends [energy].
    pub fn released(&self) -> f64 {
        (self.energy[0] - self.energy[1]) * self.load.powi(2)
    }
}

/// Treatment of several bonds beyond their strength after a break.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Avalanche {
    /// One at a time: the load is reduced until only the bond nearest to its strength breaks. The upper bound
    /// of the body's strength.
    One,
    /// All of them at fixed ends, as in a displacement-controlled test.
    #[default]
    All,
}

/// Termination and accuracy.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// What breaks together.
    pub avalanche: Avalanche,
    /// Ends when the force is below this fraction of the largest one.
    pub until: f64,
    /// Ends after this number of breaks.
    pub most: usize,
    /// Accuracy of the energy, relative to its change by a break.
    pub tol: f64,
    /// Bonds within this fraction of the breaking load break together: the path is that of a body with some
    /// strengths reduced by up to this fraction.
    pub together: f64,
}

/// The path of fracture.
#[derive(Clone, Debug)]
pub struct Path {
    /// The breaks in order.
    pub breaks: Vec<Break>,
    /// Index of the break with the largest force; 0 if there are none.
    pub peak: usize,
    /// Displacements and rotations at that load, before the break.
    pub field: Vec<Six>,
    /// Steps of conjugate gradients.
    pub iterations: usize,
    /// Whether all solutions have converged.
    pub done: bool,
    /// Whether the ends are still connected.
    pub whole: bool,
}

/// Breaks a body between held ends, starting from the `field` that solves it. `share(bond, bears)` returns
/// the fraction of a bond's strength used by a tension, a shear force, bending and twisting moments; it must
/// be proportional to these.
pub fn crumble(
    mut network: Network,
    held: &Held,
    mut field: Vec<Six>,
    limits: &Limits,
    share: impl Fn(usize, &Modes) -> f64 + Sync,
) -> Path {
    let ends = network.pairs.ends.iter().enumerate();
    let rows = Lists::new(network.particles, ends.flat_map(|(k, ends)| ends.map(|place| (place, k as u32))));
    let mut blocks = Blocks::of_network(&network, &held.mask);
    let mut energy: f64 = network.energy(&field).iter().sum();
    let first = energy;
    let mut out =
        Path { breaks: vec![], peak: 0, field: field.clone(), iterations: 0, done: true, whole: true };
    let mut coarse = None;
    let (mut alive, mut highest, mut reached) = (vec![true; network.bonds()], 0.0, 0.0f64);
    let mut shares = vec![0.0; network.bonds()];
    while out.breaks.len() < limits.most && !perigrain_base::stop::cuts() {
        par::each((&mut shares[..], &alive[..]), |first, (shares, alive)| {
            for (k, (out, alive)) in shares.iter_mut().zip(alive).enumerate() {
                *out = if *alive { share(first + k, &network.borne(first + k, &field)) } else { 0.0 };
            }
        });
        let most = par::max(network.bonds(), |k| shares[k]);
        // No bond has a load that could break it.
        if most.is_nan() || most <= 0.0 {
            break;
        }
        let load = match limits.avalanche {
            Avalanche::One => 1.0 / most,
            Avalanche::All => reached.max(1.0 / most),
        };
        reached = load;
        let force = energy * load;
        if force > highest {
            (highest, out.peak) = (force, out.breaks.len());
            scale(&mut out.field, &field, load);
        } else if force < limits.until * highest {
            break;
        }
        let least = (1.0 / load).min(most) * (1.0 - limits.together.max(TOGETHER));
        let bonds: Vec<u32> =
            (0..network.bonds()).filter(|k| shares[*k] >= least).map(|k| k as u32).collect();
        for k in bonds.iter().map(|k| *k as usize) {
            (alive[k], network.k[k]) = (false, Default::default());
        }
        for place in bonds.iter().flat_map(|k| network.pairs.ends[*k as usize]) {
            let block = network.block(place, rows.of(place as usize));
            blocks.renew(place as usize, &block, held.mask[place as usize]);
        }
        let before = std::mem::replace(&mut energy, network.energy(&field).iter().sum());
        let start = energy;
        let make = || Coarse::of_network(&network, &blocks);
        let mut by = Preconditioner::again(&blocks, &make, coarse.take());
        let solved = solve(
            |u, out| network.product(u, out),
            &mut by,
            None,
            &mut field,
            start,
            MOST,
            |now| {
                let changed = (start - now.energy).max(ROUNDING * first);
                now.fallen.is_some_and(|fallen| MARGIN * fallen <= limits.tol * changed)
            },
        );
        energy = solved.energy.max(0.0);
        coarse = by.kept(&solved);
        out.iterations += solved.iterations;
        out.done &= solved.done;
        out.breaks.push(Break { bonds, load, energy: [before, energy] });
        if energy <= TORN * first {
            out.whole = false;
            break;
        }
    }
    out
}

fn scale(out: &mut [Six], field: &[Six], load: f64) {
    par::each((out, field), |_, (out, field)| {
        for (out, row) in out.iter_mut().zip(field) {
            *out = row.map(|a| load * a);
        }
    });
}
