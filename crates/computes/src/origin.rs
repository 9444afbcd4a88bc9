//! Where particles were when a compute was declared: a column that follows them.

use perigrain_styles::matter::unwrapped;
use perigrain_world::World;

/// The column with the places, and the one that tells whose place is known.
fn keys(id: &str) -> (String, String) {
    (format!("compute {id} origin"), format!("compute {id} known"))
}

/// Captures the present unwrapped place of every particle, less `shift`.
pub fn capture(w: &mut World, id: &str, shift: [f64; 3]) {
    forget(w, id);
    welcome(w, id, shift);
}

/// Captures the place of every particle that has none yet.
pub fn welcome(w: &mut World, id: &str, shift: [f64; 3]) {
    let (place, known) = keys(id);
    let n = w.n();
    w.columns.resize(n);
    w.columns.vector(&place, n);
    let new: Vec<usize> = {
        let known = w.columns.scalar(&known, n);
        let new = (0..n).filter(|&i| known[i] == 0.0).collect();
        known.fill(1.0);
        new
    };
    for i in new {
        let x = unwrapped(w, i);
        w.columns.vector(&place, n)[i] = std::array::from_fn(|d| x[d] - shift[d]);
    }
}

/// The captured places.
pub fn places<'a>(w: &'a World, id: &str) -> &'a [[f64; 3]] {
    w.columns.get_vector(&keys(id).0).unwrap_or(&[])
}

/// The captured places, to move them.
pub fn places_mut<'a>(w: &'a mut World, id: &str) -> &'a mut Vec<[f64; 3]> {
    let n = w.n();
    w.columns.vector(&keys(id).0, n)
}

/// Gives the columns up.
pub fn forget(w: &mut World, id: &str) {
    let (place, known) = keys(id);
    w.columns.remove(&place);
    w.columns.remove(&known);
}
