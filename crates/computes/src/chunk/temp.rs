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
            syntax: "compute ID group temp/chunk chunkID [temp|kecom|internal …] [com yes|no] [bias ID] [adof n] [cdof n]",
            summary: "Temperature of particles in chunks, and of each chunk.",
            text: "Scalar (intensive): T = Σ m v²/(dof k_B) over the particles of the group that are in chunks, dof = N `adof` + Nchunk \
                   `cdof`; 0 where dof is not positive. Vector of 6 (extensive): Σ m v_a v_b for xx yy zz xy xz yz, in energy units. With \
                   values a global array (intensive), a row per chunk: `temp`, its temperature, of N `adof` + `cdof` degrees of freedom; `kecom`, ½ M v² \
                   of its centre of mass; `internal`, Σ ½ m v² of what is left without the motion of its centre. Chunks without particles have zeros.\n\n\
                   `com yes` takes the motion of each chunk's centre away before temperatures are taken; `bias ID` the flow that compute \
                   temp/com, temp/partial, temp/ramp … ID takes away, from all values. Not both. `adof` is 3 (in two dimensions 2) unless it is given, \
                   `cdof` 0; nothing is taken off for the bias, and `compute_modify` has no effect. Under `-compat lammps` `ke` of thermo output and pressures ignore the \
                   motion if this is their temperature, as in LAMMPS. chunkID names a `compute \
                   chunk/atom`. With `com yes` it cannot be the bias of other commands, unlike in LAMMPS.",
            example: "compute cc all chunk/atom type\ncompute t all temp/chunk cc temp internal com yes",
        }
    }
}

#[derive(Clone, Copy)]
enum Value {
    Temperature,
    OfCentre,
    Internal,
}

impl ComputeStyle for TempChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let chunks = ChunkRef::read(args, cx)?;
        let adof = if cx.world.settings.two_dimensional { 2.0 } else { 3.0 };
        let (id, group) = (cx.id.to_string(), cx.group);
        let mut c = Declared { id, group, chunks, values: vec![], com: false, bias: None, adof, cdof: 0.0 };
        let words = ["temp", "kecom", "internal", "com", "bias", "adof", "cdof"];
        let mut options = false;
        while let Some(word) = args.next() {
            let value = match word.text.as_str() {
                "temp" => Some(Value::Temperature),
                "kecom" => Some(Value::OfCentre),
                "internal" => Some(Value::Internal),
                _ => None,
            };
            match (value, word.text.as_str()) {
                (Some(value), _) if !options => c.values.push(value),
                (Some(_), text) => {
                    let text = format!("the value `{text}` must stand before the keywords");
                    return Err(Diagnostic::error(Code::BAD_VALUE, word.span, text).into());
                }
                (_, "com") => c.com = args.flag("com")?,
                (_, "bias") => c.bias = Some(temp_flow::named(args, cx)?),
                (_, "adof") => c.adof = args.number("degrees of freedom per particle")?,
                (_, "cdof") => c.cdof = args.number("degrees of freedom per chunk")?,
                _ => return Err(args.unknown(word, &words)),
            }
            options |= value.is_none();
        }
        if let Some(bias) = c.bias.as_ref().filter(|_| c.com) {
            let text = "`com yes` and `bias` cannot be used together";
            return Err(Diagnostic::error(Code::CONFLICT, bias.span, text).into());
        }
        Ok(Box::new(c))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    chunks: ChunkRef,
    values: Vec<Value>,
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
                Value::Temperature if *n > 0.0 => counting * (c.mvv2e / (dof * c.boltz)),
                Value::Temperature => 0.0,
                Value::OfCentre => 0.5 * c.mvv2e * centre[3] * dot(of_centre, of_centre),
                Value::Internal => 0.5 * c.mvv2e * thermal,
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
