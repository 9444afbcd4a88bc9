//! Finds the surface particles of peridynamic solids: from bonds where there are some, else from places.

use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_neigh::list::{Reach, View, Wanted, pairs};
use perigrain_peri::families::Families;
use perigrain_world::World;
use perigrain_world::surface::{Rule, Surface};

/// Nearest neighbours on a cubic lattice are one size V^⅓ away, the next ones 1.41.
const NEAREST: f64 = 1.25;
/// How far families reach where no bonds exist yet, in sizes.
const USUAL: f64 = 3.015;

/// What a particle has around it.
#[derive(Clone, Default)]
struct Around {
    nearest: Vec<u32>,
    weight: f64,
}

/// Refuses particles whose volume is not set: it is 1 then, far from that of a cell of the lattice.
///
/// # Errors
/// The first such particle.
pub fn check_volumes(w: &World, chosen: &[usize], span: Span) -> Result<()> {
    let [a, b, c] = w.lattice.spacing;
    let p = &w.particles;
    let unset = |i: &&usize| p.volume[**i] == 1.0 && !(0.01..=100.0).contains(&(a * b * c));
    let Some(&i) = chosen.iter().find(unset) else { return Ok(()) };
    let text = format!(
        "particle {} (type {}) has no volume yet, which its sphere is made from",
        p.tag[i], p.kind[i]
    );
    Err(Diagnostic::error(Code::INCOMPLETE, span, text)
        .help(format!("write `set type {} volume …` before this line", p.kind[i]))
        .into())
}

/// Whether each particle lies at the surface.
pub fn members(w: &World, s: &Surface) -> Vec<bool> {
    let parent = s.parent.bit();
    let of_solid: Vec<bool> = w.particles.mask.iter().map(|m| m & parent != 0).collect();
    let weigh = matches!(s.rule, Rule::Weight(_));
    let around = match w.families.as_ref().filter(|f| f.place.len() == w.n()) {
        Some(families) => bonded(w, families, &of_solid),
        None => placed(w, &of_solid, weigh),
    };
    let full = around.iter().map(|a| a.weight).fold(0.0, f64::max);
    let open = |a: &Around| match s.rule {
        Rule::Neighbours(n) => a.nearest.len() < n,
        Rule::Weight(part) => a.weight < part * full,
    };
    let mut chosen: Vec<bool> = around.iter().zip(&of_solid).map(|(a, there)| *there && open(a)).collect();
    for _ in 1..s.shells {
        let next = |i: usize| of_solid[i] && around[i].nearest.iter().any(|&j| chosen[j as usize]);
        let wider: Vec<bool> = (0..w.n()).map(|i| chosen[i] || next(i)).collect();
        chosen = wider;
    }
    chosen
}

/// By the bonds that live.
fn bonded(w: &World, families: &Families, of_solid: &[bool]) -> Vec<Around> {
    let volume = &w.particles.volume;
    let of = |i: usize| {
        let mut a = Around::default();
        for (b, length) in families.neighbours_apart(i).into_iter().filter(|(b, _)| b.alive) {
            let j = b.partner as usize;
            a.weight += length * length * volume[j];
            if length < NEAREST * volume[i].cbrt() {
                a.nearest.push(b.partner);
            }
        }
        a
    };
    (0..w.n()).map(|i| if of_solid[i] { of(i) } else { Around::default() }).collect()
}

/// By the present places, before bonds exist.
fn placed(w: &World, of_solid: &[bool], weigh: bool) -> Vec<Around> {
    let p = &w.particles;
    let mut around = vec![Around::default(); w.n()];
    let sizes = (0..w.n()).filter(|&i| of_solid[i]).map(|i| p.volume[i].cbrt());
    let Some(most) = sizes.reduce(f64::max) else { return around };
    let reach = if weigh { USUAL } else { NEAREST };
    let mut wanted = Wanted::new(w.types);
    let kinds = 1..=w.types as u16;
    for (a, b) in kinds.clone().flat_map(|a| kinds.clone().map(move |b| (a, b))) {
        wanted.set(a, b, Reach::Fixed(reach * most));
    }
    let view = View { x: &p.x, tag: &p.tag, kind: &p.kind, radius: &[], period: w.periods() };
    for pair in pairs(&view, &wanted, 0.0, &|i, j| of_solid[i] && of_solid[j]) {
        let d = view.difference(&pair);
        let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        for (i, j) in [(pair.i, pair.j), (pair.j, pair.i)] {
            let (own, size) = (&mut around[i as usize], p.volume[i as usize].cbrt());
            if square < (NEAREST * size) * (NEAREST * size) {
                own.nearest.push(j);
            }
            if square < (reach * size) * (reach * size) {
                own.weight += square * p.volume[j as usize];
            }
        }
    }
    around
}

/// Gives the group its present members; whether that changed any.
pub fn choose(w: &mut World, bit: u32, s: &Surface) -> bool {
    let members = members(w, s);
    let mut changed = false;
    for (mask, member) in w.particles.mask.iter_mut().zip(members) {
        let new = if member { *mask | bit } else { *mask & !bit };
        changed |= new != *mask;
        *mask = new;
    }
    changed
}
