//! Pairs of particles within a distance of each other, and clusters of them.

use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::cformat::general;
use perigrain_base::math::forest::find;
use perigrain_base::math::periods::Periods;
use perigrain_base::memory::lacking;
use perigrain_neigh::list::{Forecast, Pair, Reach, View, Wanted, difference, forecast, pairs};
use perigrain_world::index::Index;
use perigrain_world::{Allowed, Bond, GroupId, World};

/// Every pair closer than `reach` that `keep` lets pass, once, in the order of their ids; pairs that
/// exclusions and bonds take away are none.
pub fn within(w: &World, reach: Reach, keep: &(impl Fn(usize, usize) -> bool + Sync)) -> Vec<Pair> {
    search(w, reach, 0.0, keep)
}

/// The same with pairs that exclusions and bonds keep apart.
pub fn all_within(w: &World, reach: Reach, keep: &(impl Fn(usize, usize) -> bool + Sync)) -> Vec<Pair> {
    let p = &w.particles;
    let view = View { x: &p.x, tag: &p.tag, kind: &p.kind, radius: &p.radius, period: w.periods() };
    pairs(&view, &every_type(w, reach), 0.0, keep)
}

/// Pairs of particles of two types closer than `reach` that `keep` lets pass, in the order of their ids, whatever keeps them apart: their
/// places, that of the lower id first, and the square of the distance of their nearest images.
pub fn of_types(
    w: &World,
    types: [u16; 2],
    reach: f64,
    keep: &(impl Fn(usize, usize) -> bool + Sync),
) -> Vec<([usize; 2], f64)> {
    let p = &w.particles;
    let mut wanted = Wanted::new(w.types);
    wanted.set(types[0], types[1], Reach::Fixed(reach));
    let view = View { x: &p.x, tag: &p.tag, kind: &p.kind, radius: &[], period: w.periods() };
    let mut list: Vec<([usize; 2], f64)> = vec![];
    for q in pairs(&view, &wanted, 0.0, keep).iter().filter(|q| q.i != q.j) {
        let (d, ends) = (view.difference(q), [q.i as usize, q.j as usize]);
        let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        match list.last_mut().filter(|last| last.0 == ends) {
            Some(last) => last.1 = last.1.min(square),
            None => list.push((ends, square)),
        }
    }
    list
}

/// Refuses a distance beyond which a particle would meet several images of another one: pairs are counted once.
///
/// # Errors
/// The distance is longer than half of a periodic length.
pub fn one_image(w: &World, cutoff: f64, at: Span) -> Result<()> {
    let shortest = w.periods().heights().into_iter().filter(|l| *l > 0.0).fold(f64::INFINITY, f64::min);
    if cutoff <= 0.5 * shortest {
        return Ok(());
    }
    let text = format!(
        "the cutoff {cutoff} is longer than half the periodic box, {}: several images of a particle would count as one",
        0.5 * shortest
    );
    Err(Diagnostic::error(Code::BAD_VALUE, at, text)
        .help("take a shorter cutoff, or `replicate` the scene")
        .into())
}

/// Refuses a search for pairs that do not fit into the memory, or that meet in more images of the box than are looked into.
///
/// # Errors
/// What is needed, and what is free.
pub fn room_for_pairs(w: &World, wanted: &Wanted, skin: f64) -> Result<()> {
    let p = &w.particles;
    let view = View { x: &p.x, tag: &p.tag, kind: &p.kind, radius: &p.radius, period: w.periods() };
    let found = forecast(&view, wanted, skin);
    let images = found.images.iter().any(|n| *n > 0.0);
    let into = match images {
        true => {
            format!(", which reaches into {} images of the periodic box,", general(found.all_images(), 3))
        }
        false => String::new(),
    };
    let within = format!("within {}{into}", general(found.reach, 4));
    let help = "take a shorter distance or a larger box, or let its faces not repeat (`boundary f f f`)";
    if found.images.iter().any(|n| *n > Forecast::MOST_IMAGES) {
        let text = format!("neighbours {within} would be too many to count");
        return Err(Diagnostic::error(Code::TOO_LARGE, None, text).help(help).into());
    }
    let what = format!("about {} pairs of neighbours {within}", general(found.pairs, 3));
    match lacking(found.pairs * BYTES_PER_PAIR, &what) {
        Some(d) => Err(d.help(help).into()),
        None => Ok(()),
    }
}

/// What a pair takes while it is searched and sorted.
const BYTES_PER_PAIR: f64 = 48.0;

/// Pairs of all types that reach so far.
pub fn every_type(w: &World, reach: Reach) -> Wanted {
    let mut wanted = Wanted::new(w.types);
    for a in 1..=w.types as u16 {
        (a..=w.types as u16).for_each(|b| wanted.set(a, b, reach));
    }
    wanted
}

fn search(w: &World, reach: Reach, skin: f64, keep: &(impl Fn(usize, usize) -> bool + Sync)) -> Vec<Pair> {
    let p = &w.particles;
    let wanted = every_type(w, reach);
    let view = View { x: &p.x, tag: &p.tag, kind: &p.kind, radius: &p.radius, period: w.periods() };
    let allowed = Allowed::new(w);
    pairs(&view, &wanted, skin, &|i, j| keep(i, j) && allowed.pair(i, j))
}

/// Every pair of spheres no further apart than the sum of their radii that `keep` lets pass, as `within`.
pub fn touching(w: &World, keep: &(impl Fn(usize, usize) -> bool + Sync)) -> Vec<Pair> {
    let p = &w.particles;
    // What touches in one point is no closer than the sum of the radii: search a little further, then look.
    let margin = 1e-9 * p.radius.iter().fold(0.0, |most: f64, r| most.max(*r));
    let mut found = search(w, Reach::Touch, margin, keep);
    let period = w.periods();
    found.retain(|pair| {
        let d = difference(&p.x, &period, pair);
        let sum = p.radius[pair.i as usize] + p.radius[pair.j as usize];
        d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= sum * sum
    });
    found
}

/// Sets that grow together: each has the smallest id of its members as its name.
pub struct Clusters<'a> {
    parent: Vec<u32>,
    tag: &'a [u32],
}

impl<'a> Clusters<'a> {
    /// Every particle by itself.
    pub fn new(tag: &'a [u32]) -> Self {
        Self { parent: (0..tag.len() as u32).collect(), tag }
    }

    /// Joins the sets of two particles.
    pub fn join(&mut self, i: u32, j: u32) {
        if self.parent[i as usize] == self.parent[j as usize] {
            return;
        }
        let (a, b) = (find(&mut self.parent, i), find(&mut self.parent, j));
        let (low, high) = if self.tag[a as usize] <= self.tag[b as usize] { (a, b) } else { (b, a) };
        self.parent[high as usize] = low;
    }

    /// The smallest id in the set of a particle.
    pub fn name(&mut self, i: usize) -> f64 {
        f64::from(self.tag[find(&mut self.parent, i as u32) as usize])
    }
}

/// The bonds with both ends in a group, in the order of LAMMPS' lists.
pub fn bonds_within(w: &World, group: GroupId) -> Vec<Bond> {
    let p = &w.particles;
    let index = Index::new(&p.tag);
    let has = |tag: u32| index.find(tag, &p.tag).is_some_and(|i| p.mask[i] & group.bit() != 0);
    let mut list = w.bonds.by_owner(&p.tag);
    list.retain(|b| b.kind != 0 && b.ends.iter().all(|t| has(*t)));
    list
}

/// Calls `f(i, j)` for every unbroken peridynamic bond, `i` < `j`.
pub fn bonds(w: &World, mut f: impl FnMut(u32, u32)) {
    let Some(families) = &*w.families else { return };
    for i in 0..w.n() {
        for n in families.neighbours(i) {
            if n.alive && n.partner > i as u32 {
                f(i as u32, n.partner);
            }
        }
    }
}

/// Calls `f(i, j)` for everything that holds two particles together: unbroken peridynamic bonds, and listed bonds that are
/// not broken. In no order that means anything.
pub fn held_together(w: &World, mut f: impl FnMut(u32, u32)) {
    if let Some(families) = &*w.families {
        families.bonds_as_kept(false, &mut f);
    }
    let tags = &w.particles.tag;
    let index = Index::new(tags);
    for bond in w.bonds.list.iter().filter(|b| b.kind != 0) {
        if let [Some(i), Some(j)] = bond.ends.map(|t| index.find(t, tags)) {
            f(i as u32, j as u32);
        }
    }
}

/// The share of each height of a box that repeats beyond which bonds may not reach where it is strained.
const LONGEST: f64 = 0.4;

/// The ids of two particles whose bond crosses a periodic face along an edge that changes, if there are such.
///
/// # Errors
/// Where particles do not move along with the box: their bonds would be pulled at the faces alone.
pub fn bonds_across(w: &World, changes: [bool; 3], along: bool) -> Result<Option<[u32; 2]>> {
    let (period, p) = (w.periods(), &w.particles);
    let dims: Vec<usize> = (0..3).filter(|&d| changes[d] && period.length[d] > 0.0).collect();
    let mut crossing = None;
    if !dims.is_empty() {
        bonds(w, |i, j| {
            let (a, b) = (p.x[i as usize], p.x[j as usize]);
            let turns = period.turns(std::array::from_fn(|d| a[d] - b[d]));
            if dims.iter().any(|&d| turns[d] != 0.0) {
                crossing = Some([p.tag[i as usize], p.tag[j as usize]]);
            }
        });
    }
    let Some([a, b]) = crossing.filter(|_| !along) else { return Ok(crossing) };
    let text = format!(
        "peridynamic bonds cross this periodic face (of particles {a} and {b}): particles must move along where its length changes"
    );
    Err(Diagnostic::error(Code::NOT_SUPPORTED, None, text)
        .help("use `remap` (`change_box`) or `remap x` (`fix deform`), which strains the body evenly with the box")
        .into())
}

/// Refuses a box in which bonds that cross its faces could meet their own images.
///
/// # Errors
/// A height less than two and a half times what bonds reach.
pub fn bonds_fit(w: &World, edges: &Periods) -> Result<()> {
    let reach = w.families.as_ref().map_or(0.0, |f| f.reach());
    let heights = edges.heights();
    let Some(d) = (0..3).find(|&d| edges.length[d] > 0.0 && reach > LONGEST * heights[d]) else {
        return Ok(());
    };
    let text = format!(
        "the box is only {:.4e} across along {}, and peridynamic bonds that cross its faces reach {reach:.4e}: more than {LONGEST} of it",
        heights[d],
        ["x", "y", "z"][d]
    );
    let help = "take a longer box or a shorter horizon: a bond must not meet its own image";
    Err(Diagnostic::error(Code::BAD_VALUE, None, text).help(help).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clusters_are_named_by_their_smallest_id() {
        let tag = [5, 3, 9, 1];
        let mut c = Clusters::new(&tag);
        c.join(0, 2);
        c.join(2, 1);
        assert_eq!([0, 1, 2, 3].map(|i| c.name(i)), [3.0, 3.0, 3.0, 1.0]);
    }
}
