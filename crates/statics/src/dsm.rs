//! The direct stiffness method: a bonded body between two held ends, as one linear system.
//!
//! K. Jarolin, M. Dosta, Comput. Part. Mech. 8 (2021), section 2, with rotations; starts from the affine
//! field and stops by the energy.

use super::certificate::Certificate;
use super::coarse::Coarse;
use super::ends::{Held, WHOLE};
use super::network::Network;
use super::pcg::{MARGIN, Preconditioner, Solved, solve};
use super::precond::Blocks;
use super::six::Six;
use perigrain_bonded::stiffness::Modes;

/// Termination criterion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// Estimated relative error of the energy, and so of the stiffness, by its decrease.
    Estimate(f64),
    /// Guaranteed relative error of the energy.
    Certified(f64),
    /// Residual force |r|₂ [force].
    Residual(f64),
    /// Number of steps: the stiffness is an upper bound.
    Steps(usize),
}

/// A solution.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Displacements and rotations.
    pub field: Vec<Six>,
    /// Energies of stretch, shear, bend and twist.
    pub modes: Modes,
    /// Statistics of the solver.
    pub solved: Solved,
    /// Upper bound of the energy above the minimum, if requested [energy].
    pub gap: Option<f64>,
}

impl Answer {
    /// The energy of all bonds.
    pub fn energy(&self) -> f64 {
        self.modes.iter().sum()
    }
}

/// A larger number of steps means that the stiffnesses are invalid.
pub const MOST: usize = 200_000;

/// Steps between two evaluations of the certificate, each of which costs as much as a step.
const BETWEEN: usize = 5;

/// Minimizes the energy over all free displacements and rotations.
pub fn relax(
    network: &Network,
    blocks: &Blocks,
    held: &Held,
    start: Vec<Six>,
    rotations: bool,
    stop: Stop,
) -> Answer {
    let mut field = start;
    let energy: f64 = network.energy(&field).iter().sum();
    let certificate = match stop {
        Stop::Certified(_) => {
            Some(Certificate::new(network, |k| held.mask[k] == WHOLE, &held.out, rotations))
        }
        _ => None,
    };
    let mut gap = None;
    let make = || Coarse::of_network(network, blocks);
    let mut by = match stop {
        // As in the paper, and for runs that end before coarse levels pay off.
        Stop::Residual(_) | Stop::Steps(_) => Preconditioner::plain(blocks),
        _ => Preconditioner::deep(blocks, &make),
    };
    let solved = solve(
        |u, out| network.product(u, out),
        &mut by,
        None,
        &mut field,
        energy,
        MOST,
        |now| match stop {
            Stop::Estimate(tol) => now.fallen.is_some_and(|fallen| MARGIN * fallen <= tol * now.energy),
            Stop::Residual(least) => now.residual < least,
            Stop::Steps(most) => now.iterations >= most,
            Stop::Certified(tol) => {
                if now.iterations % BETWEEN == 0 {
                    gap = certificate.as_ref().map(|c| c.gap(network, now.r));
                }
                gap.is_some_and(|gap| gap <= tol * now.energy)
            }
        },
    );
    let modes = network.energy(&field);
    Answer { field, modes, solved, gap }
}
