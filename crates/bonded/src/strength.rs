//! How a body breaks under a load that grows, without a run: bond after bond, each time at rest.
//!
//! E. Schlangen, J. G. M. van Mier, Cem. Concr. Compos. 14, 105 (1992): under small displacements all that bonds bear is proportional to the
//! load, so that the one which comes nearest to its strength tells the load at which it breaks; without it the body is solved anew.

use super::coarse::Coarse;
use super::dsm::MOST;
use super::ends::Held;
use super::network::{Modes, Network};
use super::pairs::Lists;
use super::pcg::{MARGIN, Preconditioner, solve};
use super::precond::Blocks;
use super::six::Six;
use perigrain_base::par;

/// Bonds nearer than this to the one that breaks break with it: they are the same but for rounding.
const TOGETHER: f64 = 1e-9;
/// Of the energy of the whole body, less than this is nothing: it hangs together no more.
const TORN: f64 = 1e-9;
/// What a solution may be wrong by beside what a break has changed, as a part of the energy: rounding.
const ROUNDING: f64 = 1e-13;

/// Bonds that break at one load.
#[derive(Clone, Debug)]
pub struct Break {
    /// Which, by their places in the network.
    pub bonds: Vec<u32>,
    /// The load, in parts of the displacement that was given.
    pub load: f64,
    /// Energies of the body at the displacement given, before and after [energy].
    pub energy: [f64; 2],
}

impl Break {
    /// The force of the ends when it happens, where the displacement given is `delta` [force].
    pub fn force(&self, delta: f64) -> f64 {
        2.0 * self.energy[0] * self.load / delta
    }

    /// The energy that is set free while the ends stand still [energy].
    pub fn released(&self) -> f64 {
        (self.energy[0] - self.energy[1]) * self.load.powi(2)
    }
}

/// What breaks where more than one bond is beyond its strength once another one has gone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Avalanche {
    /// One at a time: the ends go back until only the one nearest to its strength breaks. The most that the body could bear.
    One,
    /// All of them, while the ends stand still, as in a test.
    #[default]
    All,
}

/// When to stop, and how well to solve.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// What breaks together.
    pub avalanche: Avalanche,
    /// Once the force is below this part of the largest one.
    pub until: f64,
    /// After so many breaks.
    pub most: usize,
    /// The part of what a break changes in the energy to which it is found.
    pub tol: f64,
    /// Bonds that lack less than this part of the load break with the one that breaks: the path is that of a body of which some
    /// strengths are up to this part smaller.
    pub together: f64,
}

/// What happened.
#[derive(Clone, Debug)]
pub struct Path {
    /// One after another.
    pub breaks: Vec<Break>,
    /// Which of them happened under the largest force; 0 where there are none.
    pub peak: usize,
    /// Displacements and rotations at that load, before the break.
    pub field: Vec<Six>,
    /// Steps of conjugate gradients.
    pub iterations: usize,
    /// Whether all solutions have converged.
    pub done: bool,
    /// Whether the ends hang together still.
    pub whole: bool,
}

/// Breaks a body between held ends, from the `field` that solves it. `share(bond, bears)` tells how much of its strength a bond
/// has used up that bears a tension, a shear force, moments of bending and twist; it must be proportional to these.
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
        // Nothing bears anything that breaks it.
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
