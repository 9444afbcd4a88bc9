//! compute temp/chunk: temperature of all chunks together, and temperature and kinetic energies of each.

use super::moments::mean;
use super::{ChunkRef, Chunks, sums};
use crate::temp::offer;
use crate::{Compute, ComputeStyle, temp_flow};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::{SIX, Vec3, dot, sub};
use perigrain_lang::{Args, ValueRef};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::matter::{Masses, check_masses};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, KIND, MASK, MASS, MEMO, REGIONS, TYPE_MASS, V, X};
use perigrain_world::{GroupId, SlotId, World};

/// The style.
pub struct TempChunk;

impl Style for TempChunk {
    fn name(&self) -> &'static str {
        "temp/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Temperature of particles in chunks, and of each chunk.",
            text: "Scalar (intensive): T = Σ m v²/(dof k_B) over the particles of the group that are in chunks, dof = N `adof` + Nchunk \
                   `cdof`; 0 where dof is not positive. Vector of 6 (extensive): Σ m v_a v_b for xx yy zz xy xz yz, in energy units. With \
                   values a global array (intensive), a row per chunk and a column per value. Chunks without particles have zeros.\n\n\
                   `com yes` and `bias` exclude each other. Nothing is taken off the degrees of freedom for the bias, and `compute_modify` \
                   has no effect. Under `-compat lammps` `ke` of thermo output and pressures ignore the \
                   motion if this is their temperature, as in LAMMPS. With `com yes` it cannot be the bias of other commands, unlike in LAMMPS.",
            example: "compute cc all chunk/atom type\ncompute t all temp/chunk cc temp internal com yes",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The `compute chunk/atom` that makes the chunks.
    #[word(name = "chunkID")]
    chunks: ChunkRef,
    #[word(name = "value")]
    values: Vec<Column>,
    /// Takes the motion of each chunk's centre away before temperatures are taken.
    #[word(keyword, default = false)]
    com: bool,
    /// The temperature compute (temp/com, temp/partial, temp/ramp …) whose flow is taken away from all values.
    #[word(keyword, name = "ID", with = temp_flow::named, kind = Kind::Compute)]
    bias: Option<ValueRef>,
    /// Degrees of freedom per particle: 3 without it, 2 in flat scenes.
    #[word(keyword, name = "n", what = "degrees of freedom per particle")]
    adof: Option<f64>,
    /// Degrees of freedom per chunk.
    #[word(keyword, name = "n", what = "degrees of freedom per chunk", default = 0.0)]
    cdof: f64,
}

/// What a column of the array holds.
#[derive(Clone, Copy, Words)]
enum Column {
    /// The temperature of the chunk, of N `adof` + `cdof` degrees of freedom.
    #[word("temp")]
    Temperature,
    /// ½ M v² of its centre of mass.
    #[word("kecom")]
    OfCentre,
    /// Σ ½ m v² of what is left without the motion of its centre.
    Internal,
}

impl ComputeStyle for TempChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { chunks, values, com, bias, adof, cdof } = read(args, cx)?;
        if let Some(bias) = bias.as_ref().filter(|_| com) {
            let text = "`com yes` and `bias` cannot be used together";
            return Err(Diagnostic::error(Code::CONFLICT, bias.span, text).into());
        }
        let adof = adof.unwrap_or(if cx.world.settings.two_dimensional { 2.0 } else { 3.0 });
        let (id, group) = (cx.id.to_string(), cx.group);
        Ok(Box::new(Declared { id, group, chunks, values, com, bias, adof, cdof }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    chunks: ChunkRef,
    values: Vec<Column>,
    com: bool,
    bias: Option<ValueRef>,
    adof: f64,
    cdof: f64,
}

impl Declared {
    /// The values of each chunk, row by row; `v` gives velocities without the bias.
    fn rows(&self, w: &World, chunks: &Chunks, v: &dyn Fn(usize) -> Vec3, centre: &[[f64; 4]]) -> Vec<f64> {
        let (masses, c) = (Masses::of(w), w.settings.units.constants());
        let inner = |i: usize| sub(v(i), chunks.chunk(i).map_or([0.0; 3], |k| mean(centre[k])));
        let twice = sums(w, self.group, chunks, |i| {
            let (m, thermal) = (masses.get(i), inner(i));
            let counting = if self.com { thermal } else { v(i) };
            [1.0, m * dot(counting, counting), m * dot(thermal, thermal)]
        });
        let row = twice.iter().zip(centre).flat_map(|([n, counting, thermal], centre)| {
            let dof = self.adof * n + self.cdof;
            let of_centre = mean(*centre);
            self.values.iter().map(move |value| match value {
                Column::Temperature if *n > 0.0 => counting * (c.mvv2e / (dof * c.boltz)),
                Column::Temperature => 0.0,
                Column::OfCentre => 0.5 * c.mvv2e * centre[3] * dot(of_centre, of_centre),
                Column::Internal => 0.5 * c.mvv2e * thermal,
            })
        });
        row.collect()
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        let array = self.values.len();
        let array_rows = if array > 0 { Shape::OPEN } else { 0 };
        Shape { scalar: true, vector: 6, vector_extensive: true, array, array_rows, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (me, span) = (self.clone(), cx.span());
        check_masses(cx.world(), span)?;
        let bias = self.bias.as_ref().map(|r| temp_flow::known(r, cx)).transpose()?;
        let (slot_of_chunks, kind) = (self.chunks.seal(cx, stage, when)?, self.chunks.kind);
        let reads = X | V | MASS | MASK | BOX | MEMO | REGIONS | KIND | TYPE_MASS;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, reads, move |w, _, out| {
            let (p, masses, chunks) = (&w.particles, Masses::of(w), Chunks::of(w, slot_of_chunks, kind));
            let flow = bias.as_ref().and_then(|b| b.flow(w));
            let v = |i: usize| flow.as_ref().map_or(p.v[i], |f| sub(p.v[i], f.taken[i]));
            let centre = super::moments::weighted(w, me.group, &chunks, |_, i| v(i));
            let tensors = sums(w, me.group, &chunks, |i| {
                let drift = chunks.chunk(i).filter(|_| me.com).map_or([0.0; 3], |k| mean(centre[k]));
                let (u, m) = (sub(v(i), drift), masses.get(i));
                let [xx, yy, zz, xy, xz, yz] = SIX.map(|(a, b)| m * u[a] * u[b]);
                [xx, yy, zz, xy, xz, yz, 1.0]
            });
            let mut all = [0.0; 7];
            tensors.iter().for_each(|t| (0..7).for_each(|k| all[k] += t[k]));
            let [xx, yy, zz, xy, xz, yz, n] = all;
            let dof = n * me.adof + chunks.count() as f64 * me.cdof;
            offer(w, out, xx + yy + zz, [xx, yy, zz, xy, xz, yz], dof);
            if w.settings.lammps() {
                // It publishes no degrees of freedom: energies and pressures derived from it exclude motion.
                out.inner = vec![0.0];
            }
            (out.array, out.array_cols) = (me.rows(w, &chunks, &v, &centre), me.values.len());
            out.chunks = me.chunks.varying();
            Ok(())
        }))
    }
}
