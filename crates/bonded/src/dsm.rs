//! The direct stiffness method: a bonded body between two held ends, by one linear system.
//!
//! K. Jarolin, M. Dosta, Comput. Part. Mech. 8 (2021), section 2, with rotations; begun from the affine field and stopped by the energy.

use super::certificate::Certificate;
use super::coarse::Coarse;
use super::ends::{Held, WHOLE};
use super::network::{Modes, Network};
use super::pcg::{MARGIN, Preconditioner, Solved, solve};
use super::precond::Blocks;
use super::six::Six;

/// When a solution is good enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// The energy, and with it the stiffness, is known to this part of it by how fast it falls.
    Estimate(f64),
    /// It is known to this part of it for certain.
    Certified(f64),
    /// The forces that are left, |r|₂, are below this [force].
    Residual(f64),
    /// So many steps are done: the stiffness is a bound from above.
    Steps(usize),
}

/// A solution.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Displacements and rotations.
    pub field: Vec<Six>,
    /// Energies of stretch, shear, bend and twist.
    pub modes: Modes,
    /// How it went.
    pub solved: Solved,
    /// By how much at most the energy is above the least one, if that was asked for [energy].
    pub gap: Option<f64>,
}

impl Answer {
    /// The energy of all bonds.
    pub fn energy(&self) -> f64 {
        self.modes.iter().sum()
    }
}

/// More steps than this mean that something is wrong with the stiffnesses.
pub const MOST: usize = 200_000;

/// How many steps pass between two looks at the certificate, which takes as long as one.
const BETWEEN: usize = 5;

/// Moves and turns what is not held until the energy is least.
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
        // What the paper does, and what is over before coarse levels pay.
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
