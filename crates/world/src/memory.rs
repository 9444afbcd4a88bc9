//! How much memory a scene takes.

use super::World;
use perigrain_base::diag::{Diagnostic, Result};
pub use perigrain_base::memory::lacking;
use perigrain_base::memory::lacking_on_ranks;

/// Bytes of all columns and of the state that belongs to forces.
pub fn bytes(w: &World) -> u64 {
    fn of<T>(v: &Vec<T>) -> u64 {
        (v.capacity() * size_of::<T>()) as u64
    }
    let p = &w.particles;
    let columns = of(p.tag.past())
        + of(p.kind.past())
        + of(p.mask.past())
        + p.image.past().bytes() as u64
        + of(p.x.past())
        + of(p.v.past())
        + of(p.f.past());
    let own = of(p.mass.past())
        + of(p.radius.past())
        + of(p.omega.past())
        + of(p.torque.past())
        + of(p.quat.past())
        + of(p.mu.past())
        + of(p.charge.past())
        + of(p.volume.past())
        + of(p.x0.past())
        + of(p.density.past())
        + of(p.molecule.past())
        + of(&w.bonds.past().list)
        + of(&w.bonds.past().special);
    let families = w.families.past().as_ref().map_or(0, |f| f.bytes() as u64);
    columns
        + own
        + of(&w.rebuild.past().held)
        + of(&w.rebuild.past().kept.x)
        + of(&w.rebuild.past().kept.turns)
        + families
}

/// Bytes a particle of a solid needs besides its columns once forces act: rows of the lattice layout.
const FORCES_PER_PARTICLE: f64 = 110.0;
/// The same for a grain in a dense bed: lists of pairs, contact history, and both once more while lists are rebuilt
/// (`benches/decks/dem_bed.in` with 10⁶ grains, alone and on three ranks).
const FORCES_PER_GRAIN: f64 = 560.0;
/// Particles from which a forecast is worth a line.
const LARGE: f64 = 200_000.0;
/// Time of one step per particle of a peridynamic body with 122 bonds, one thread [s] (benches/versus_lammps).
const SECONDS_PER_PARTICLE: f64 = 1.5e-7;

/// Bytes that the present scene is likely to take once forces act.
pub fn expected(w: &World) -> f64 {
    let before = w.families.is_none() && w.rebuild.held.is_empty();
    let forces = if before { w.n() as f64 * forces_per_particle(w) } else { 0.0 };
    bytes(w) as f64 + forces
}

/// Bytes a particle needs besides its columns, by what it is.
fn forces_per_particle(w: &World) -> f64 {
    let style = w.particles.style;
    if style.sphere && !style.peri { FORCES_PER_GRAIN } else { FORCES_PER_PARTICLE }
}

/// What `more` particles on top of the present ones would take: a line for the log when that is much, a refusal
/// when it cannot fit, for all ranks of a machine together.
///
/// # Errors
/// The forecast exceeds the memory that is free now.
pub fn forecast(w: &World, more: f64) -> Result<Option<String>> {
    let style = w.particles.style;
    let sphere = if style.sphere { 8 + 24 + 24 } else { 0 };
    let peri = if style.peri { 8 + 24 } else { 0 };
    let oriented = if style.oriented { 32 } else { 0 };
    let columns = 4 + 2 + 4 + 3 * 24 + 8 + 24 + 8 + sphere + peri + oriented;
    let n = w.n() as f64 + more;
    let bytes = n * (f64::from(columns) + forces_per_particle(w));
    if let Some(d) = lacking_on_ranks(bytes, &format!("about {n:.3e} particles")) {
        return Err(d.help("use a coarser lattice or a smaller region").into());
    }
    let text = || {
        let step = n * SECONDS_PER_PARTICLE / perigrain_base::par::threads() as f64;
        format!(
            "  forecast: about {n:.3e} particles, {:.0} MB, {step:.2} s per step if all of them interact",
            bytes / 1e6
        )
    };
    Ok((n >= LARGE).then(text))
}

/// What a pair style keeps for two types: laws of contacts are the largest of its entries [bytes].
const BYTES_PER_PAIR: f64 = 256.0;

/// The error of tables of all pairs of so many types that do not fit.
pub fn lacking_for_types(types: usize) -> Option<Diagnostic> {
    lacking((types as f64).powi(2) * BYTES_PER_PAIR, &format!("tables of {types} types"))
}

/// Entries of full neighbour lists (peridynamic families) if there are any. The lists of grains are not counted.
pub fn neighbors(w: &World) -> Option<u64> {
    w.families.as_ref().map(|f| f.bonds() as u64)
}
