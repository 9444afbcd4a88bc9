//! Whether a body on a lattice fits together: rows, stencil, bits of bonds, columns.

use super::{Fault, at_home, equal, must, numbers, states, states_are_numbers, works};
use crate::families::Law;
use crate::families::lattice::{CONSTANTS, LANES, LatticeBody, MIXED, PAD, RowMotion, staggered};
use crate::setup::lattice::{Pruned, half_stencil, prune, reach};
use perigrain_base::math::cell::{point, reciprocal};
use perigrain_base::math::vec3::{Vec3, add, dot, sub};

/// So many lattice vectors are looked at for a stencil: of a stencil that can be numbered, in the most oblique cell.
const MOST_VECTORS: i64 = 1 << 24;

impl LatticeBody {
    /// See `Families::sound`.
    pub(super) fn sound(&self, (law, types): (&Law, usize), reference: &[Vec3]) -> Fault {
        self.rows_are_sound()?;
        self.stencil_is_sound()?;
        self.columns_are_sound(types)?;
        self.sites_are_sound(reference)?;
        self.bonds_are_sound()?;
        let (cells, chunks) = (self.particle.len(), self.intact.len());
        states(&self.state, &law.kind, (cells, PAD, self.alive.len() * LANES))?;
        states_are_numbers(&self.state)?;
        works((&self.work, &self.life), self.alive.len() * LANES)?;
        numbers("displacements", self.u.iter().flatten())?;
        numbers("constants", self.tables.iter().chain(self.pairs.as_flattened()))?;
        numbers("volumes of cells", &self.cell_volume)?;
        let touched = if law.kind.has_states() { chunks } else { 0 };
        equal("the number of its touched chunks is", self.state.touched.len(), touched)?;
        let awake = self.state.awake.len();
        must(awake == 0 || awake == self.rows.len(), "its rows and those that ever woke differ in number")
    }

    /// Rows follow each other without gaps, between as many empty ones as bonds reach.
    fn rows_are_sound(&self) -> Fault {
        let [_, beside, above] = self.reach;
        must(self.reach.iter().all(|r| *r >= 0), "its stencil reaches backwards")?;
        let (beside, above) = (beside as usize, above as usize);
        must(self.planes > 0 && self.width > 2 * beside, "it has no rows")?;
        let slots = self.planes.checked_add(above + 1).and_then(|planes| planes.checked_mul(self.width));
        equal("the number of its rows is", self.rows.len(), slots.unwrap_or(usize::MAX))?;
        let mut next = 0u32;
        for (slot, row) in self.rows.iter().enumerate() {
            let (plane, across) = (slot / self.width, slot % self.width);
            let inside = plane < self.planes && across >= beside && across < self.width - beside;
            must(row.len == 0 || inside, "a row lies in its margin")?;
            equal("the first cell of a row is", row.start, next)?;
            must(row.len.is_multiple_of(LANES as u32), "a row has no whole chunks of cells")?;
            must(row.len < 1 << 30 && row.lo.unsigned_abs() < 1 << 30, "a row is longer than it can be")?;
            next = next.checked_add(row.len).ok_or("its rows are longer than they can be")?;
        }
        // Places in tables and cells are numbers of 31 bits.
        must(next <= i32::MAX as u32, "it has more cells than can be numbered")?;
        equal("the number of its cells is", self.particle.len(), next as usize)
    }

    /// The stencil is that of its lattice: half of all vectors up to its longest one, as far as they lead from row to row.
    fn stencil_is_sound(&self) -> Fault {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        must(positive(self.spacing) && positive(self.horizon), "its spacing or horizon is no length")?;
        must(
            reciprocal(&self.basis).is_some_and(|r| r.as_flattened().iter().all(|x| x.is_finite())),
            "its lattice is none",
        )?;
        let square = |v: &[i32; 3]| {
            let xi = point(&self.basis, *v);
            dot(xi, xi)
        };
        for v in &self.stencil {
            let within = (0..3).all(|k| v[k].unsigned_abs() <= self.reach[k].unsigned_abs());
            must(
                within && (v[2], v[1], v[0]) > (0, 0, 0),
                "a vector of its stencil leads too far or backwards",
            )?;
        }
        let longest = self.stencil.iter().map(square).fold(0.0, f64::max);
        let reached = reach(&self.basis, longest.sqrt()).ok_or("its lattice is none")?;
        must((0..3).all(|k| reached[k] <= self.reach[k]), "its stencil reaches farther than it says")?;
        let vectors = reached.iter().fold(1i64, |product, r| product.saturating_mul(2 * i64::from(*r) + 1));
        must(vectors <= MOST_VECTORS, "its stencil reaches too far")?;
        let all = if self.stencil.is_empty() { vec![] } else { half_stencil(&self.basis, reached, longest) };
        let Pruned { stencil, steps, step_of } = prune(self, all);
        must(
            self.stencil.len() < usize::from(u16::MAX) && stencil == self.stencil,
            "its stencil is not that of its lattice",
        )?;
        must(steps == self.steps && step_of == self.step_of, "the row steps of its stencil do not fit")
    }

    /// Columns have an entry for each cell, chunk or row; what is looked up is there.
    fn columns_are_sound(&self, types: usize) -> Fault {
        let (cells, entries) = (self.particle.len(), self.stencil.len());
        let (chunks, rows, kinds) = (cells / LANES, self.rows.len(), self.kinds.len());
        equal("the stride of its displacements is", self.stride, staggered(cells))?;
        let various = !self.cell_kind.is_empty();
        let by_cells = if various { cells + 2 * PAD } else { 0 };
        for (what, len, expected) in [
            ("present displacements", self.u[1].len(), 3 * self.stride),
            ("former displacements", self.u[0].len(), 3 * self.stride),
            ("bits of bonds", self.alive.len(), chunks * entries),
            ("intact chunks", self.intact.len(), chunks),
            ("bounds of tension", self.tension.len(), chunks),
            ("bounds of compression", self.compression.len(), chunks),
            ("bounds to measure at", self.measure.len(), chunks),
            ("bounds of breaking", self.floor.len(), chunks),
            ("flags", self.flagged.len(), chunks),
            ("motions of rows", self.motion.len(), rows),
            ("constants", self.tables.len(), kinds * kinds * entries * CONSTANTS),
            ("constants of dilatations", self.state.tables.len(), kinds * kinds * entries * CONSTANTS),
            ("pairs of types", self.pairs.len(), kinds * kinds),
            ("types of cells", self.cell_kind.len(), by_cells),
            ("volumes of cells", self.cell_volume.len(), by_cells),
        ] {
            equal(&format!("the number of its {what} is"), len, expected)?;
        }
        must(self.scatter.fits(cells), "it has factors of more or fewer cells")?;
        must((1..=u16::MAX as usize).contains(&kinds), "it has no types")?;
        must(
            self.kinds.iter().all(|k| (1..=types).contains(&usize::from(*k))),
            "a type of it is none of the scene",
        )?;
        let known = |kind: u16| usize::from(kind) < kinds || (kind == MIXED && various);
        must(
            self.rows.iter().all(|r| r.len == 0 || known(r.kind)),
            "the type of a row is none of its types",
        )?;
        must(
            self.cell_kind.iter().all(|k| usize::from(*k) < kinds),
            "the type of a cell is none of its types",
        )?;
        let margin = &self.motion[self.planes * self.width..];
        must(margin.iter().all(|m| *m == RowMotion::NONE), "a row in its margin moves")?;
        let broken = |&(cell, e): &(u32, u16)| (cell as usize) < cells && usize::from(e) < entries;
        must(self.broken.iter().all(broken), "a bond that broke was none")
    }

    /// Particles have been where their cells are.
    fn sites_are_sound(&self, reference: &[Vec3]) -> Fault {
        let mut origin = None;
        for (slot, row) in self.rows.iter().enumerate().filter(|(_, row)| row.len > 0) {
            let (across, up) = ((slot % self.width) as i32, (slot / self.width) as i32);
            for (k, &p) in self.particle[row.start as usize..][..row.len as usize].iter().enumerate() {
                if p == u32::MAX {
                    continue;
                }
                let Some(&x) = reference.get(p as usize) else {
                    return Err(format!("particle number {p} is none of the scene"));
                };
                let site = point(&self.basis, [row.lo + k as i32, across, up]);
                let origin = *origin.get_or_insert(sub(x, site));
                at_home(x, add(origin, site), self.spacing)?;
            }
        }
        Ok(())
    }

    /// Living bonds lead from particle to particle; where all are said to live, they do.
    fn bonds_are_sound(&self) -> Fault {
        let entries = self.stencil.len();
        let there =
            |cells: &[u32]| cells.iter().rev().fold(0u8, |bits, p| bits << 1 | u8::from(*p != u32::MAX));
        let there: Vec<u8> = self.particle.chunks(LANES).map(there).collect();
        for (slot, row) in self.rows.iter().enumerate().filter(|(_, row)| row.len > 0) {
            let chunks = row.start as usize / LANES..(row.start + row.len) as usize / LANES;
            for (e, &[along, across, up]) in self.stencil.iter().enumerate() {
                let other =
                    &self.rows[(slot + up as usize * self.width).wrapping_add_signed(across as isize)];
                let others = &there[other.start as usize / LANES..][..other.len as usize / LANES];
                let shift = along + row.lo - other.lo;
                let (first, by) = (shift.div_euclid(LANES as i32), shift.rem_euclid(LANES as i32));
                let byte =
                    |k: i32| usize::try_from(k).ok().and_then(|k| others.get(k)).map_or(0, |b| u16::from(*b));
                for (k, chunk) in chunks.clone().enumerate() {
                    let bits = self.alive[chunk * entries + e];
                    let at = first.saturating_add(k as i32);
                    let far = ((byte(at) | byte(at.saturating_add(1)) << 8) >> by) as u8;
                    must(bits & !(far & there[chunk]) == 0, "a living bond leads to no particle")?;
                    let whole = bits == u8::MAX || other.len == 0 || !self.intact[chunk];
                    must(whole, "a chunk that is said to be intact has lost a bond")?;
                }
            }
        }
        Ok(())
    }
}
