//! Selects the pairs of particles that fix bond/create bonds.

use super::{Molecules, Rule};
use perigrain_base::math::rng::Marsaglia;
use perigrain_styles::near::of_types;
use perigrain_world::index::Index;
use perigrain_world::{Allowed, Partners, World};

/// How many bonds of the fix's type each particle has.
pub struct Count(pub Vec<usize>);

impl Count {
    /// The current counts.
    pub fn of(w: &World, kind: u16) -> Self {
        let (mut count, index) = (vec![0; w.n()], Index::new(&w.particles.tag));
        for bond in w.bonds.list.iter().filter(|b| b.kind == i32::from(kind)) {
            for i in bond.ends.into_iter().filter_map(|id| index.find(id, &w.particles.tag)) {
                count[i] += 1;
            }
        }
        Self(count)
    }
}

/// Two particles that may be bonded: their indices, the lower ID first, and the square of their distance.
struct Candidate {
    ends: [usize; 2],
    square: f64,
}

/// The pairs to bond, each particle in at most one, in the order of their IDs.
pub fn chosen(
    w: &World,
    rule: &Rule,
    count: &Count,
    chance: Option<&mut (f64, Marsaglia)>,
) -> Vec<[usize; 2]> {
    let list = candidates(w, rule, count);
    if list.is_empty() {
        return vec![];
    }
    // For each particle, the index of its nearest candidate.
    let mut nearest = vec![usize::MAX; w.n()];
    for (k, pair) in list.iter().enumerate() {
        for i in pair.ends {
            if nearest[i] == usize::MAX || pair.square < list[nearest[i]].square {
                nearest[i] = k;
            }
        }
    }
    let both = |(k, pair): &(usize, &Candidate)| pair.ends.iter().all(|i| nearest[*i] == *k);
    let eligible = list.iter().enumerate().filter(both).map(|(_, pair)| pair.ends);
    let Some((p, stream)) = chance.filter(|(p, _)| *p < 1.0) else { return eligible.collect() };
    let drawn = draw(w, &nearest, stream);
    eligible.filter(|[lower, _]| drawn[*lower] < *p).collect()
}

/// A random number for each particle that has a candidate, in the order of their IDs.
fn draw(w: &World, nearest: &[usize], stream: &mut Marsaglia) -> Vec<f64> {
    let mut order: Vec<usize> = (0..w.n()).filter(|i| nearest[*i] != usize::MAX).collect();
    order.sort_unstable_by_key(|i| w.particles.tag[*i]);
    let mut drawn = vec![0.0; w.n()];
    order.into_iter().for_each(|i| drawn[i] = stream.uniform());
    drawn
}

/// Pairs close enough, of the right types, with room for another bond and not bonded to each other, by their
/// IDs.
fn candidates(w: &World, rule: &Rule, count: &Count) -> Vec<Candidate> {
    let p = &w.particles;
    let [a, b] = rule.types;
    let allowed = Allowed::excluded(w);
    let room = |i: usize, k: usize| rule.limits[k].most == 0 || count.0[i] < rule.limits[k].most;
    let keep = |i: usize, j: usize| {
        // As in LAMMPS, the first particle is tested against itype first.
        let sides = if (p.kind[i], p.kind[j]) == (a, b) { [0, 1] } else { [1, 0] };
        let members = p.mask[i] & p.mask[j] & rule.group.bit() != 0;
        members && room(i, sides[0]) && room(j, sides[1]) && suits(w, rule, [i, j]) && allowed.pair(i, j)
    };
    let found = of_types(w, rule.types, rule.range, &keep).into_iter();
    let mut list: Vec<Candidate> = found.map(|(ends, square)| Candidate { ends, square }).collect();
    leave_bonded(w, &mut list);
    list
}

/// Whether their molecules allow the bond.
fn suits(w: &World, rule: &Rule, [i, j]: [usize; 2]) -> bool {
    let of = |i: usize| w.particles.molecule.get(i).copied().unwrap_or_default();
    match rule.molecules {
        Molecules::Off => true,
        Molecules::Between => of(i) != of(j),
        Molecules::Within => of(i) == of(j),
    }
}

/// Removes bonded pairs, and pairs two or three bonds apart that special weights keep out of neighbour lists.
fn leave_bonded(w: &World, list: &mut Vec<Candidate>) {
    if list.is_empty() || w.bonds.special.is_empty() {
        return;
    }
    let partners = Partners::new(w);
    list.retain(|pair| partners.apart(pair.ends) != Some(1) && partners.unlisted(pair.ends).is_none());
}
