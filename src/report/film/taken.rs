//! A snapshot of the scene as it is: read only, so that the run does not notice.

use super::{Cell, Column, Frame, Grid, Triangle};
use perigrain_dumps::auto_diameter;
use perigrain_world::index::Index;
use perigrain_world::{World, outline};
use std::sync::Arc;

/// Walls of more triangles are left out.
const WALLS: usize = 20_000;

/// The scene now, in the order of ids. It keeps to the grid of the snapshot before if that serves, and shares its walls if they rest.
pub fn taken(w: &World, before: Option<&Frame>) -> Frame {
    let p = &w.particles;
    let order = order(&p.tag);
    let place = |k: usize| order.as_ref().map_or(k, |order| order[k] as usize);
    let n = p.len();
    let span = span((0..n).map(|k| p.x[k]));
    let grid = Grid::over(span, before.map(|b| b.grid));
    let mut x: [Vec<u16>; 3] = std::array::from_fn(|_| Vec::with_capacity(n));
    for k in 0..n {
        let at = p.x[place(k)];
        for d in 0..3 {
            x[d].push(grid.count(d, at[d]));
        }
    }
    let columns = columns(w, |value| (0..n).map(|k| value(place(k))).collect());
    let cell = w.domain.as_ref().map_or(Cell::upright(span), Cell::of);
    let (units, walls) = (w.settings.units.symbols(), walls(w, before));
    Frame { step: w.clock.step, time: Some(w.clock.time()), cell, units, walls, span, grid, x, columns }
}

/// The walls now.
fn walls(w: &World, before: Option<&Frame>) -> Arc<[Triangle]> {
    let now = outline::walls(w);
    let shown = if now.len() > WALLS { &[] } else { &now[..] };
    match before {
        Some(b) if *b.walls == *shown => b.walls.clone(),
        _ => shown.into(),
    }
}

/// The values of each particle besides its place.
fn columns(w: &World, list: impl Fn(&dyn Fn(usize) -> f64) -> Vec<f64>) -> Vec<Column> {
    let p = &w.particles;
    let mut out = vec![Column::of("type", &list(&|i| f64::from(p.kind[i])))];
    let volumes = w.volumes();
    if p.style.sphere || p.style.peri {
        // As in pictures: no light falls through a body.
        out.push(Column::of("radius", &list(&|i| 0.5 * auto_diameter(w, i))));
    }
    out.push(Column::of("speed", &list(&|i| p.v[i].iter().map(|v| v * v).sum::<f64>().sqrt())));
    if let Some(families) = w.families.as_ref().filter(|_| volumes.len() == p.len()) {
        let damages = families.damages(volumes);
        out.push(Column::of_shares("damage", &list(&|i| damages.of(i))));
    }
    if p.style.bonded && !w.bonds.is_empty() {
        let index = Index::new(&p.tag);
        let mut bonds = vec![0.0; p.len()];
        for bond in w.bonds.list.iter().filter(|b| b.is_on()) {
            bond.ends.iter().filter_map(|tag| index.find(*tag, &p.tag)).for_each(|i| bonds[i] += 1.0);
        }
        out.push(Column::of("bonds", &list(&|i| bonds[i])));
    }
    if p.style.molecules && p.molecule.iter().any(|m| *m != 0) {
        out.push(Column::of("molecule", &list(&|i| f64::from(p.molecule[i]))));
    }
    out
}

/// Lower and upper corner of these places; a point where there are none.
pub fn span(places: impl Iterator<Item = [f64; 3]>) -> [[f64; 3]; 2] {
    let mut out = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for x in places.filter(|x| x.iter().all(|x| x.is_finite())) {
        for d in 0..3 {
            out[0][d] = out[0][d].min(x[d]);
            out[1][d] = out[1][d].max(x[d]);
        }
    }
    if out[0][0] > out[1][0] { [[0.0; 3]; 2] } else { out }
}

/// Particles in the order of their ids; nothing where they stand so already.
pub fn order(tags: &[u32]) -> Option<Vec<u32>> {
    if tags.is_sorted() {
        return None;
    }
    let most = tags.iter().copied().max().unwrap_or(0) as usize;
    if most > 4 * tags.len() + 1024 {
        let mut order: Vec<u32> = (0..tags.len() as u32).collect();
        order.sort_by_key(|i| tags[*i as usize]);
        return Some(order);
    }
    // How many have a lower id, id by id: one way through, where sorting takes many.
    let mut first = vec![0u32; most + 2];
    tags.iter().for_each(|tag| first[*tag as usize + 1] += 1);
    (0..=most).for_each(|tag| first[tag + 1] += first[tag]);
    let mut order = vec![0; tags.len()];
    for (i, tag) in tags.iter().enumerate() {
        let at = &mut first[*tag as usize];
        order[*at as usize] = i as u32;
        *at += 1;
    }
    Some(order)
}
