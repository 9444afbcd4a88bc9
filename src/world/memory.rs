//! How much memory a scene takes.

use super::World;

/// Bytes of all columns and of the state that belongs to forces.
pub fn bytes(w: &World) -> u64 {
    fn of<T>(v: &Vec<T>) -> u64 {
        (v.capacity() * size_of::<T>()) as u64
    }
    let p = &w.particles;
    let columns = of(&p.tag) + of(&p.kind) + of(&p.mask) + of(&p.image) + of(&p.x) + of(&p.v) + of(&p.f);
    let own = of(&p.mass)
        + of(&p.radius)
        + of(&p.omega)
        + of(&p.torque)
        + of(&p.volume)
        + of(&p.x0)
        + of(&p.density);
    columns + own + of(&w.rebuild.held)
}

/// Pairs in half neighbour lists, and entries of full lists (peridynamic families) if there are any.
pub fn neighbors(_w: &World) -> (u64, Option<u64>) {
    (0, None)
}
