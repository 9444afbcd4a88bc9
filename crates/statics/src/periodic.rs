//! The stiffness of a periodic body: six strains of the cell, each with the fluctuation of minimal energy.

use super::coarse::Coarse;
use super::dsm::MOST;
use super::network::{Moved, Network};
use super::pcg::{MARGIN, Preconditioner, solve};
use super::precond::Blocks;
use super::six::{Matrix6, Six};
use super::ste::Estimate;
use super::tensor::strain;
use perigrain_base::par;

/// The solutions of the six load cases.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Fluctuations, in addition to the strain.
    pub fields: Vec<Vec<Six>>,
    /// Number of steps of each.
    pub iterations: [usize; 6],
    /// Estimated relative excess of the energies, from their decrease.
    pub open: f64,
    /// Whether all of them have converged.
    pub done: bool,
}

impl Cell {
    /// Solves them to a relative energy tolerance `tol`, starting from the fluctuations `from`, if given.
    pub fn new(network: &Network, blocks: &Blocks, tol: f64, from: Option<Self>) -> Self {
        let mut out = Self { fields: vec![], iterations: [0; 6], open: 0.0, done: true };
        let mut before = from.map_or(vec![], |cell| cell.fields);
        before.resize(6, vec![]);
        let make = || Coarse::of_network(network, blocks);
        let mut by = Preconditioner::deep(blocks, &make);
        for (case, field) in before.into_iter().enumerate() {
            let mut field =
                if field.len() == network.particles { field } else { vec![[0.0; 6]; network.particles] };
            let strain = strain(case);
            let mut load = vec![[0.0; 6]; network.particles];
            network.product_of_strain(&strain, &mut load);
            par::each(&mut load[..], |_, rows| rows.iter_mut().for_each(|f| *f = f.map(|a| -a)));
            let energy = network.sum(|bond| {
                let moved = network.moved(bond, &field, Some(&strain));
                network.work(bond, &moved, &moved).map(|a| 0.5 * a)
            });
            let solved = solve(
                |u, o| network.product(u, o),
                &mut by,
                Some(&load),
                &mut field,
                energy.iter().sum(),
                MOST,
                |now| now.fallen.is_some_and(|fallen| MARGIN * fallen <= tol * now.energy),
            );
            out.iterations[case] = solved.iterations;
            out.open = out.open.max(solved.open / solved.energy);
            out.done &= solved.done;
            out.fields.push(field);
        }
        out
    }

    /// Relative motions of the ends of a bond in two load cases.
    pub fn moved(&self, network: &Network, bond: usize, [a, b]: [usize; 2]) -> [Moved; 2] {
        [a, b].map(|case| network.moved(bond, &self.fields[case], Some(&strain(case))))
    }

    /// C_ab: the work of the stresses of one case on the strain of another, per volume. Its error is second
    /// order in that of the fields.
    pub fn tensor(&self, network: &Network, volume: f64) -> Matrix6 {
        let mut c = [[0.0; 6]; 6];
        for (a, b) in (0..6).flat_map(|a| (a..6).map(move |b| (a, b))) {
            let work = network.sum(|bond| {
                let [one, other] = self.moved(network, bond, [a, b]);
                network.work(bond, &one, &other)
            });
            c[a][b] = work.iter().sum::<f64>() / volume;
            c[b][a] = c[a][b];
        }
        c
    }
}

/// The tensor for affine motion of all particles: an upper bound, and an estimate of order 0.
pub fn mean_field(network: &Network, volume: f64) -> Matrix6 {
    Estimate::new(network, 0).whole(volume)
}
