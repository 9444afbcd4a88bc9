//! What pair styles share: neighbours at the last rebuild, particles held by fix freeze, a pair's part of sums.

use perigrain_base::math::vec3::{Vec3, add, sub};
use perigrain_neigh::list::{Pair, View, Wanted, insert, pairs};
use perigrain_plan::Tick;
use perigrain_world::index::Index;
use perigrain_world::tally::add_share;
use perigrain_world::{Allowed, Constant, GroupId, World};

/// The positions that lists are made from: those of the last rebuild, of which later ones are within half a skin [length].
pub fn built_at(w: &World) -> &[Vec3] {
    known_or_present(w, w.held())
}

/// The positions that lists are made from which outlast rebuilds: perhaps those of an earlier one [length].
pub fn made_at(w: &World) -> &[Vec3] {
    known_or_present(w, w.made())
}

fn known_or_present<'a>(w: &'a World, known: &'a [Vec3]) -> &'a [Vec3] {
    if known.len() == w.n() { known } else { &w.particles.x }
}

/// Particles as neighbour lists see them, at the positions `x`.
pub fn view<'a>(w: &'a World, x: &'a [Vec3]) -> View<'a> {
    let p = &w.particles;
    View { x, tag: &p.tag, kind: &p.kind, radius: &p.radius, period: w.periods() }
}

/// Pairs within reach plus `skin` at the positions `x` that `allowed` lets meet, sorted by their tags.
pub fn near(w: &World, x: &[Vec3], wanted: &Wanted, skin: f64, allowed: &Allowed) -> Vec<Pair> {
    pairs(&view(w, x), wanted, skin, &|i, j| allowed.pair(i, j))
}

/// Takes pairs of particles, by their ids, into a list of [`near`] as of the last rebuild, where they are near enough and `allowed` lets
/// them meet.
pub fn admit(w: &World, pairs: &[[u32; 2]], wanted: &Wanted, allowed: &Allowed, list: &mut Vec<Pair>) {
    let (tags, index) = (&w.particles.tag, Index::new(&w.particles.tag));
    let places = |[a, b]: &[u32; 2]| Some([index.find(*a, tags)?, index.find(*b, tags)?]);
    let ends: Vec<_> = pairs.iter().filter_map(places).filter(|[i, j]| allowed.pair(*i, *j)).collect();
    insert(&view(w, built_at(w)), wanted, w.settings.neighbor.skin, &ends, list);
}

/// Every fix that freezes grains, by its ID, and its group: contact laws take these grains for infinitely heavy.
pub static FROZEN: Constant<Vec<(String, GroupId)>> = Constant::new("frozen grains");

/// Which particles fix freeze holds; empty without one.
pub fn find_frozen(w: &World, out: &mut Vec<bool>) {
    out.clear();
    let bits = w.facts.get(*FROZEN).into_iter().flatten().fold(0, |bits, (_, group)| bits | group.bit());
    if bits != 0 {
        out.extend(w.particles.mask.iter().map(|m| m & bits != 0));
    }
}

/// Gives the force `f` to the first of `ends` and its opposite to the other, `d` = x_i − x_j apart, and single particles
/// and the virial their shares.
pub fn push(w: &mut World, t: &Tick, ends: [usize; 2], d: Vec3, f: Vec3, energy: f64) {
    let [i, j] = ends;
    let forces = &mut w.particles.f;
    forces[i] = add(forces[i], f);
    forces[j] = sub(forces[j], f);
    if t.atom_energy {
        ends.iter().for_each(|&i| w.tally.atom[i] += 0.5 * energy);
    }
    if t.virial {
        let tally = &mut *w.tally;
        let atoms = t.atom_virial.then_some(&mut tally.atom_virial[..]);
        add_share(&mut tally.virial, atoms, ends, d, f);
    }
}

/// Adds a style's part of the virial: xx yy zz xy xz yz.
pub fn add_virial(w: &mut World, part: [f64; 6]) {
    w.tally.virial.iter_mut().zip(part).for_each(|(total, part)| *total += part);
}
