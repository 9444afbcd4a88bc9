//! fix ave/chunk: values per particle, summed by chunk and averaged over time.

use super::ave_atom::{Input, Source};
use super::ave_time::{Output, number_format};
use super::window::{Ave, Averager, Due, Kept, Samples, Schedule, forget};
use super::{AtRest, Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::cformat::{Format, Value, general, shortest};
use perigrain_base::math::vec3::sub;
use perigrain_computes::chunk::{ChunkRef, Chunks, hold, let_go};
use perigrain_computes::temp_flow;
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_plan::{Needs, Op, Stage, Tick};
use perigrain_styles::matter::{Masses, check_masses};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Flow, SealCx, Shape, Style, Wants};
use perigrain_world::field::{BOX, F, KIND, MASK, MASS, MEMO, REGIONS, SLOTS, TYPE_MASS, V, X};
use perigrain_world::{GroupId, Key, Numbers, SlotId, World};
use std::fmt::Write;

/// The style.
pub struct AveChunk;

impl Style for AveChunk {
    fn name(&self) -> &'static str {
        "ave/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Averages values per particle by chunk and over time and writes them to a file.",
            text: "At every multiple of Nfreq the average is offered and written. Only particles of the group count.\n\n\
                   During the samples of an average the number of chunks stays as it is; with `ave running` and `window` for \
                   good. Global array (intensive): a row per chunk with its original number where the compute compresses, \
                   the coordinates of its bin, the number of particles and the values; 0 before the first average.",
            example: "compute layers all chunk/atom bin/1d z lower 0.001 units box\n\
                      fix profile all ave/chunk 1 5 10 layers vz density/number file profile.txt",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(flatten)]
    samples: Samples,
    /// A `compute chunk/atom`.
    #[word(name = "chunkID")]
    chunks: ChunkRef,
    /// What is averaged: `vx vy vz fx fy fz`, `density/number`, `density/mass` (per volume of the bin, or of the box), `temp`,
    /// `c_ID`, `c_ID[k]`, `f_ID`, `f_ID[k]` with ranges such as `[*]`, and `v_name`.
    #[word(name = "value", what = "a value such as vx or c_ID", kind = Kind::Attribute, least = 1)]
    values: Vec<Word>,
    #[word(keyword)]
    norm: Norm,
    #[word(keyword, shown = "one")]
    ave: Ave,
    /// Degrees of freedom per particle, for `temp`: 3 without it, 2 in flat scenes.
    #[word(keyword, name = "N", what = "degrees of freedom per particle")]
    adof: Option<f64>,
    /// Degrees of freedom per chunk, for `temp`.
    #[word(keyword, name = "N", what = "degrees of freedom per chunk", default = 0.0)]
    cdof: f64,
    /// The flow that this temperature takes away (compute temp/com, temp/partial, temp/ramp) does not count in `temp`.
    #[word(keyword, name = "ID", with = temp_flow::named, kind = Kind::Compute)]
    bias: Option<ValueRef>,
    /// How each number is written.
    #[word(keyword, name = "%g", with = number_format, kind = Kind::Text, default = Format::parse(" %g").unwrap_or_default(), shown = " %g")]
    format: Format,
    #[word(flatten)]
    output: Output,
}

/// The quantity summed over the particles of a chunk.
#[derive(Clone)]
enum What {
    Input(Input),
    /// Number density, or mass density.
    Density(bool),
    Temperature,
}

#[derive(Clone, Copy, Default, PartialEq, Words)]
#[word(what = "kind of norm")]
enum Norm {
    /// The sum over all samples, by the number of all particles in them.
    #[default]
    All,
    /// The mean of the samples' own means.
    Sample,
    /// The mean of the samples' sums.
    None,
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    group_name: String,
    schedule: Schedule,
    chunks: ChunkRef,
    values: Vec<What>,
    names: Vec<String>,
    norm: Norm,
    ave: Ave,
    adof: Option<f64>,
    cdof: f64,
    /// The temperature compute whose velocity bias is subtracted.
    bias: Option<ValueRef>,
    output: Output,
    format: Format,
}

impl FixStyle for AveChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        line.output.check(line.ave, cx)?;
        let mut fix = Declared {
            id: cx.id.to_string(),
            group: cx.group,
            group_name: cx.world.groups.name(cx.group).to_string(),
            schedule: Schedule::new(&line.samples, 0)?,
            chunks: line.chunks,
            values: vec![],
            names: vec![],
            norm: line.norm,
            ave: line.ave,
            adof: line.adof,
            cdof: line.cdof,
            bias: line.bias,
            output: line.output,
            format: line.format,
        };
        for word in &line.values {
            fix.take(word, args, cx)?;
        }
        Ok(Box::new(fix))
    }
}

/// Sums of one step: per chunk the number of particles and the sums of the values.
struct Sample {
    rows: Vec<f64>,
    volumes: Vec<f64>,
}

impl Declared {
    fn kept(&self) -> Kept {
        Kept::below(Key::new(&format!("ave/chunk/{}", self.id)))
    }

    /// Parses and adds one value.
    fn take(&mut self, word: &Word, args: &Args, cx: &BuildCx) -> Result<()> {
        let plain = match word.text.as_str() {
            "density/number" => Some(What::Density(false)),
            "density/mass" => Some(What::Density(true)),
            "temp" => Some(What::Temperature),
            text if !text.starts_with(['x', 'y', 'z']) => Input::attribute(text).map(What::Input),
            _ => None,
        };
        if let Some(what) = plain {
            self.values.push(what);
            self.names.push(word.text.clone());
            return Ok(());
        }
        for word in cx.expand(word, Wants::PerAtom)? {
            let known = |r: &ValueRef| !matches!(r.kind, RefKind::ComputeAtom | RefKind::FixAtom);
            let Some(r) = ValueRef::parse(&word.text, word.span)?.filter(known) else {
                let keywords = Line::GRAMMAR.keywords();
                if perigrain_base::diag::nearest(&word.text, keywords.iter().copied()).is_some() {
                    return Err(args.unknown(&word, &keywords));
                }
                let text = format!("`{}` is no value of fix ave/chunk", word.text);
                return Err(Diagnostic::error(Code::UNKNOWN_KEYWORD, word.span, text)
                    .help("values are vx vy vz fx fy fz density/number density/mass temp, c_ID, f_ID and v_name")
                    .into());
            };
            cx.reading(&r, Wants::PerAtom)?;
            super::compatible(&r, &cx.shape(&r).unwrap_or_default(), self.schedule.every, "Nevery")?;
            self.names.push(word.text.clone());
            self.values.push(What::Input(Input::Value(r)));
        }
        Ok(())
    }

    fn weighs(&self) -> bool {
        self.values.iter().any(|v| matches!(v, What::Temperature | What::Density(true)))
    }

    fn titles(&self) -> Vec<String> {
        let mut third = "# Chunk".to_string();
        if self.chunks.kind.compressed {
            third.push_str(" OrigID");
        }
        (1..=self.chunks.kind.coordinates).for_each(|k| third.push_str(&format!(" Coord{k}")));
        third.push_str(" Ncount");
        self.names.iter().for_each(|n| third.push_str(&format!(" {n}")));
        vec![
            format!("# Chunk-averaged data for fix {} and group {}", self.id, self.group_name),
            "# Timestep Number-of-chunks Total-count".into(),
            third,
        ]
    }

    /// Sums over the particles of each chunk in this step, in storage order.
    fn sample(&self, w: &World, sources: &[Option<Source>], flow: Option<&Flow>, chunks: &Chunks) -> Sample {
        let width = 1 + self.values.len();
        let mut rows = vec![0.0; width * chunks.count()];
        let (masses, p) = (Masses::of(w), &w.particles);
        for i in (0..w.n()).filter(|&i| p.mask[i] & self.group.bit() != 0) {
            let Some(k) = chunks.chunk(i) else { continue };
            let row = &mut rows[k * width..(k + 1) * width];
            row[0] += 1.0;
            for ((what, source), sum) in self.values.iter().zip(sources).zip(&mut row[1..]) {
                *sum += match what {
                    What::Input(_) => source.map_or(0.0, |s| s.atom(w, i)),
                    What::Density(false) => 1.0,
                    What::Density(true) => masses.get(i),
                    What::Temperature => {
                        let [x, y, z] = flow.map_or(p.v[i], |f| sub(p.v[i], f.taken[i]));
                        (x * x + y * y + z * z) * masses.get(i)
                    }
                };
            }
        }
        Sample { rows, volumes: (0..chunks.count()).map(|k| chunks.volume(k)).collect() }
    }

    /// Converts a sum over `samples` samples into the output value.
    fn value(&self, w: &World, what: &What, sum: f64, count: f64, volume: f64, samples: f64) -> f64 {
        let units = w.settings.units.constants();
        let adof = self.adof.unwrap_or(if w.settings.two_dimensional { 2.0 } else { 3.0 });
        match what {
            What::Temperature => units.mvv2e * sum / ((samples * self.cdof + adof * count) * units.boltz),
            What::Density(mass) => {
                let per_volume = sum / samples / volume;
                if *mass { per_volume * units.mv2d } else { per_volume }
            }
            What::Input(_) if self.norm == Norm::None => sum,
            What::Input(_) => sum / count,
        }
    }

    /// Converts the sums of each row into output values; rows of empty chunks stay unchanged.
    fn settle(&self, w: &World, rows: &mut [f64], volumes: &[f64], samples: f64) {
        let width = 1 + self.values.len();
        for (row, volume) in rows.chunks_exact_mut(width).zip(volumes) {
            let count = row[0];
            if count > 0.0 {
                for (what, sum) in self.values.iter().zip(&mut row[1..]) {
                    *sum = self.value(w, what, *sum, count, *volume, samples);
                }
            }
        }
    }

    /// Adds a sample; returns the averaged rows after the last sample of an average.
    fn add(&self, w: &mut World, key: Numbers, sample: Sample, due: Due) -> Option<Vec<f64>> {
        let mut many = w.memo.remove(key).unwrap_or_default();
        let Sample { mut rows, volumes } = sample;
        if due.first || many.len() != rows.len() {
            many = vec![0.0; rows.len()];
        }
        if self.norm != Norm::All {
            self.settle(w, &mut rows, &volumes, 1.0);
        }
        many.iter_mut().zip(&rows).for_each(|(sum, a)| *sum += a);
        if !due.last {
            w.memo.insert(key, many);
            return None;
        }
        let (width, repeat) = (1 + self.values.len(), self.schedule.repeat as f64);
        match self.norm {
            Norm::All => {
                self.settle(w, &mut many, &volumes, repeat);
                many.iter_mut().step_by(width).for_each(|count| *count /= repeat);
            }
            _ => many.iter_mut().for_each(|a| *a /= repeat),
        }
        Some(many)
    }

    /// The columns before the particle count of a row.
    fn lead(&self, chunks: &Chunks, k: usize) -> Vec<f64> {
        let kind = self.chunks.kind;
        let mut lead = vec![];
        if kind.compressed {
            lead.push(chunks.original(k));
        }
        lead.extend((0..kind.coordinates).map(|d| chunks.coordinate(k, d)));
        lead
    }

    /// Stores an average in the slots and returns its block for the file.
    fn publish(&self, w: &mut World, t: &Tick, at: [SlotId; 2], total: &[f64], times: f64) -> String {
        let [slot, chunk_slot] = at;
        let width = 1 + self.values.len();
        let mut array = vec![];
        let rows = total.len() / width;
        let count: f64 = total.iter().step_by(width).sum();
        let mut text = format!("{} {rows} {}\n", t.step, shortest(count));
        let chunks = Chunks::of(w, chunk_slot, self.chunks.kind);
        for (k, row) in total.chunks_exact(width).enumerate() {
            let lead = self.lead(&chunks, k);
            let _ = write!(text, "  {}", k + 1);
            for a in lead.iter().chain([&(row[0] / times)]) {
                let _ = write!(text, " {}", general(*a, 6));
            }
            row[1..].iter().for_each(|a| text.push_str(&self.format.text(&[Value::Float(a / times)])));
            text.push('\n');
            array.extend(lead);
            array.extend(row.iter().map(|a| a / times));
        }
        let out = w.slots.get_mut(slot);
        out.step = Some(t.step);
        (out.array, out.array_cols) = (array, self.columns());
        text
    }

    fn columns(&self) -> usize {
        usize::from(self.chunks.kind.compressed) + self.chunks.kind.coordinates + 1 + self.values.len()
    }
}

impl Fix for Declared {
    fn facts(&self, _: &World) -> Facts {
        Facts { at_rest: AtRest::Acts, counts_steps: true, file: self.output.path(), ..Facts::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.schedule.declare(w, &self.kept());
        let name = format!("f_{}", self.id);
        let slot = w.slots.id(&name);
        *w.slots.get_mut(slot) =
            perigrain_world::Slot { name, array_cols: self.columns(), ..perigrain_world::Slot::default() };
        self.output.begin(w, self.kept().key, &self.titles())
    }

    fn remove(&self, w: &mut World) {
        forget(w, self.kept().key);
        let_go(w, self.chunks.window);
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (when, span) = (self.schedule.when(), cx.span());
        if self.weighs() {
            check_masses(cx.world(), span)?;
        }
        let mut sources = vec![];
        for what in &self.values {
            sources.push(match what {
                What::Input(input) => Some(input.source(cx, Wants::PerAtom, Stage::EndOfStep, &when)?),
                _ => None,
            });
        }
        let bias = self.bias.as_ref().map(|r| temp_flow::known(r, cx)).transpose()?;
        let chunk_slot = self.chunks.seal(cx, Stage::EndOfStep, &when)?;
        let (me, kept, slot) = (self.clone(), self.kept(), cx.slot(&format!("f_{}", self.id)));
        let mut sheet = self.output.sheet(cx.world(), kept.key);
        let many = kept.key.with("/many");
        // The averages arrive complete: each is combined with the earlier ones.
        let averager = Averager { kept, repeat: 1, ave: self.ave, off: vec![] };
        let access = Needs::new()
            .read(X | V | F | MASS | MASK | SLOTS | BOX | REGIONS | TYPE_MASS | KIND)
            .write(SLOTS)
            .keep(MEMO);
        let op = StepOp::new(
            format!("fix {} ave/chunk", self.id),
            Stage::EndOfStep,
            access,
            move |w: &mut World, t| {
                let Some(due) = me.schedule.due(w, &kept, t.step) else { return Ok(()) };
                let chunks = Chunks::of(w, chunk_slot, me.chunks.kind);
                let flow = bias.as_ref().and_then(|b| b.flow(w));
                let sample = me.sample(w, &sources, flow.as_ref(), &chunks);
                if due.first {
                    let last = (me.ave == Ave::One).then(|| me.schedule.last(t.step));
                    hold(w, me.chunks.window, t.step, last, span)?;
                }
                let Some(rows) = me.add(w, many, sample, due) else { return Ok(()) };
                let whole = Due { first: true, last: true };
                let Some((total, times)) = averager.add(w, &rows, whole) else { return Ok(()) };
                let block = me.publish(w, t, [slot, chunk_slot], &total, times);
                sheet.as_mut().map_or(Ok(()), |s| s.block(&block))
            },
        );
        Ok(vec![op.when(when).in_setup(true).boxed()])
    }

    fn shape(&self) -> Shape {
        Shape {
            array: self.columns(),
            array_rows: Shape::OPEN,
            every: self.schedule.freq,
            ..Shape::default()
        }
    }
}
