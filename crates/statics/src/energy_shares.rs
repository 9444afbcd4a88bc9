//! Distribution of the energy of a strained body over bonds and modes, and sensitivities: K = 2U/Δ² and U is
//! stationary in the field, so that ∂ln K/∂ln p = Σ_bonds Σ_modes U ∂ln k/∂ln p / U.

use super::network::{Moved, Network, plus};
use super::six::Six;
use perigrain_base::par;
use perigrain_bonded::stiffness::Modes;

/// Energies by kind of bond: `kind(bond)` is below `kinds`.
pub fn by_kind(
    network: &Network,
    u: &[Six],
    kinds: usize,
    kind: impl Fn(usize) -> usize + Sync,
) -> Vec<Modes> {
    let chunk = |range: std::ops::Range<usize>| {
        let mut sums = vec![[0.0; 4]; kinds];
        for bond in range {
            let moved = network.moved(bond, u, None);
            let sum = &mut sums[kind(bond)];
            *sum = plus(*sum, network.work(bond, &moved, &moved).map(|a| 0.5 * a));
        }
        sums
    };
    let join = |a: Vec<Modes>, b: Vec<Modes>| a.into_iter().zip(b).map(|(a, b)| plus(a, b)).collect();
    par::reduce(network.bonds(), chunk, join).unwrap_or_else(|| vec![[0.0; 4]; kinds])
}

/// Σ_bonds Σ_modes a K b ∂ln k/∂ln p for two fields (with uniform strains), where `change(bond)` returns ∂ln
/// k/∂ln p of stretch, shear, bend and twist.
pub fn change(
    network: &Network,
    moved: impl Fn(usize) -> [Moved; 2] + Sync,
    change: impl Fn(usize) -> Modes + Sync,
) -> f64 {
    let sum = network.sum(|bond| {
        let [a, b] = moved(bond);
        let (work, change) = (network.work(bond, &a, &b), change(bond));
        std::array::from_fn(|k| if change[k] == 0.0 { 0.0 } else { work[k] * change[k] })
    });
    sum.iter().sum()
}
