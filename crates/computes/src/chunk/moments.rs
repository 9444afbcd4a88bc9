//! Shared by chunk computes: centres, inertia and momenta of chunks, and an array with a row per chunk.

use super::{ChunkRef, Chunks, sums};
use crate::Compute;
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{Vec3, add, cross, scale, sub};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::matter::{Masses, check_masses, own_inertia, solid, unwrapped};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::{SealCx, Shape};
use perigrain_world::field::{BOX, F, Fields, IMAGE, KIND, MASK, MASS, OMEGA, RADIUS, TYPE_MASS, V, X};
use perigrain_world::{GroupId, SlotId, World};

/// The particles of a group by chunk.
pub struct Members<'w> {
    w: &'w World,
    group: GroupId,
    chunks: Chunks<'w>,
    masses: Masses<'w>,
    /// Mass of each chunk [mass].
    pub mass: Vec<f64>,
    /// Centre of mass of each, unwrapped; the origin for zero mass [distance].
    pub centre: Vec<Vec3>,
}

impl<'w> Members<'w> {
    /// The particles of a group.
    pub fn new(w: &'w World, group: GroupId, chunks: Chunks<'w>) -> Self {
        let masses = Masses::of(w);
        let rows = weighted(w, group, &chunks, unwrapped);
        let mass = rows.iter().map(|r| r[3]).collect();
        Self { w, group, chunks, masses, mass, centre: rows.into_iter().map(mean).collect() }
    }

    /// Sums `term(i, mass, x − centre)` by chunk.
    pub fn sums<const N: usize>(&self, term: impl Fn(usize, f64, Vec3) -> [f64; N]) -> Vec<[f64; N]> {
        sums(self.w, self.group, &self.chunks, |i| {
            // Every particle in the sum has a chunk.
            let centre = self.chunks.chunk(i).map_or([0.0; 3], |k| self.centre[k]);
            term(i, self.masses.get(i), sub(unwrapped(self.w, i), centre))
        })
    }

    /// The inertia tensor of each chunk about its centre, xx yy zz xy yz xz [mass distance²], of points or of
    /// `solid` spheres.
    pub fn inertia(&self, solid: bool) -> Vec<[f64; 6]> {
        self.sums(|i, m, [x, y, z]| {
            let own = if solid { own_inertia(self.w, i, m) } else { 0.0 };
            [
                m * (y * y + z * z) + own,
                m * (x * x + z * z) + own,
                m * (x * x + y * y) + own,
                -(m * x * y),
                -(m * y * z),
                -(m * x * z),
            ]
        })
    }

    /// The angular momentum of each chunk about its centre [mass distance velocity], of points or of `solid`
    /// spheres with their spin.
    pub fn angular_momentum(&self, solid: bool) -> Vec<Vec3> {
        self.sums(|i, m, d| {
            let way = cross(d, self.w.particles.v[i].map(|v| v * m));
            if !solid {
                return way;
            }
            add(way, scale(own_inertia(self.w, i, m), self.w.particles.omega[i]))
        })
    }
}

/// Σ m a and Σ m of each chunk.
pub fn weighted(
    w: &World,
    group: GroupId,
    chunks: &Chunks,
    of: impl Fn(&World, usize) -> Vec3,
) -> Vec<[f64; 4]> {
    let masses = Masses::of(w);
    sums(w, group, chunks, |i| {
        let (m, [x, y, z]) = (masses.get(i), of(w, i));
        [x * m, y * m, z * m, m]
    })
}

/// The mean from such a sum, 0 for zero mass.
pub fn mean([x, y, z, m]: [f64; 4]) -> Vec3 {
    [x, y, z].map(|a| if m > 0.0 { a / m } else { 0.0 })
}

/// A compute with a row of numbers per chunk, or a single number each if `columns` is 1.
#[derive(Clone)]
pub struct Rows {
    /// Its ID.
    pub id: String,
    /// Group of the particles that count.
    pub group: GroupId,
    /// The chunks.
    pub chunks: ChunkRef,
    /// Numbers per chunk.
    pub columns: usize,
    /// Computes the numbers, row by row.
    pub of: fn(&World, &Members) -> Vec<f64>,
}

impl Compute for Rows {
    fn shape(&self) -> Shape {
        match self.columns {
            1 => Shape { vector: Shape::OPEN, ..Shape::default() },
            n => Shape { array: n, array_rows: Shape::OPEN, ..Shape::default() },
        }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (me, span) = (self.clone(), cx.span());
        check_masses(cx.world(), span)?;
        let (chunks, kind) = (self.chunks.seal(cx, stage, when)?, self.chunks.kind);
        let spheres = if solid(cx.world()) { OMEGA | RADIUS } else { Fields::NONE };
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            X | V | F | IMAGE | MASS | MASK | BOX | KIND | TYPE_MASS | spheres,
            move |w, _, out| {
                let rows = (me.of)(w, &Members::new(w, me.group, Chunks::of(w, chunks, kind)));
                out.chunks = me.chunks.varying();
                match me.columns {
                    1 => out.vector = rows,
                    n => (out.array, out.array_cols) = (rows, n),
                }
                Ok(())
            },
        ))
    }
}
