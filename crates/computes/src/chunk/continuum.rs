//! compute continuum/chunk: continuum fields (density, velocity, stress …) by coarse graining of particles
//! and contacts.

use super::fields::{Columns, Field, Fields, Needed, Scope};
use super::grid::Grid;
use super::kernel::Kernel;
use super::{ChunkRef, Chunks};
use crate::pair_local::answering;
use crate::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::common::orthogonal;
use perigrain_styles::matter::check_masses;
use perigrain_styles::probe::{Request, look_all};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{Bins, BuildCx, Doc, Reading, SealCx, Shape, Style, Wants};
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MOLECULE, OMEGA, RADIUS, TAG,
    TRAVEL, TYPE_MASS, V, VOLUME, X, X0,
};
use perigrain_world::{Domain, GroupId, Key, SlotId};

/// The style.
pub struct ContinuumChunk;

impl Style for ContinuumChunk {
    fn name(&self) -> &'static str {
        "continuum/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Fields of density, velocity, stress and more, coarse-grained at the centres of bins.",
            text: "Global array (intensive): a row per bin of a `compute chunk/atom` (`bin/1d`, `bin/2d`, `bin/3d`, without `compress`), a column per field. \
                   Fields are those of Goldhirsch (2010) at the centres of the bins, with the kernel W(r) = a (exp(−r²/2w²) − exp(−c²/2w²)) of \
                   `width` w within the `cutoff` c, a such that ∫ W = 1 over the binned directions. c and w may be larger than a bin. Distances are \
                   those along binned directions, through periodic faces too; fields are divided by the lengths of the box along the others.\n\n\
                   With m, v, V mass, velocity and volume (in two dimensions area) of a particle, W of its place, and the velocity V_c of the bin that \
                   holds it:\n\n\
                   - `natoms`: particles within the cutoff;\n\
                   - `density` Σ m W, `volume/fraction` Σ V W, `momentum/a` Σ m v_a W; `velocity/a`: momentum over density, 0 where there is none;\n\
                   - `momentum/grad/ab`, `velocity/grad/ab`: ∂/∂b of component a, by centred differences between bins, one-sided at ends that are not periodic, \
                   0 along directions without bins; `strain/rate/ab`: the mean of the ab and the ba gradient of velocity;\n\
                   - `stress/ke/ab` −Σ m (v − V_c)_a (v − V_c)_b W; `temperature` ½ Σ m |v − V_c|² W, an energy density;\n\
                   - `stress/contacts/ab` −Σ over pairs F_a d_b ∫₀¹ W ds along the line between the centres, F the force on the one from the other and d its place less \
                   the other's; `stress/ab`: both;\n\
                   - `fabric/ab` ½ Σ over pairs (V_i + V_j) n_a n_b ∫₀¹ W ds, n = d/|d|;\n\
                   - `boundary/force/a` −Σ F_a W of the place of contact, over contacts with a boundary, F the force on the particle.\n\n\
                   a and b are x, y, z; `velocity/*` and `stress/*` stand for all components, in two dimensions without z. Stresses are in pressure units, tension \
                   positive, and need not be symmetric; volume, contacts, fabric and boundaries need spheres. Forces are those of pair styles that can be \
                   asked about single pairs (`compute pair/local`); bonds of a bond style do not count.\n\n\
                   Particles count that are in the group and in a chunk; of a pair both. With a boundary, density · acceleration = ∇·stress + density · g − `boundary/force`, up to the walls.\n\n\
                   The box must be orthogonal. LAMMPS (of 2026) has this style with differences where its page and its program disagree: its gradient `xy` is that \
                   of v_y along x; of contacts with `boundary/atom` it counts one half to the place of contact and one half along the whole line; \
                   contacts reach no bins that are out of the cutoff of both ends, where the line may pass; and bins must divide a periodic box.",
            example: "compute cc all chunk/atom bin/1d z lower 0.5 units box\n\
                      compute c all continuum/chunk cc 1.5 0.5 density velocity/* stress/zz",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The `compute chunk/atom` that makes the bins.
    #[word(name = "chunkID")]
    chunks: At<ChunkRef>,
    /// The cutoff of the kernel [distance].
    #[word(positive)]
    cutoff: f64,
    /// The width of the kernel [distance].
    #[word(positive)]
    width: At<f64>,
    /// A field, with its components.
    #[word(name = "field", what = "a field, as `density`", least = 1)]
    fields: Vec<At<Columns>>,
    /// Particles of this group are a boundary: they count in no sum, and their contacts with others count in `boundary/force`,
    /// and in the stress by the line from the centre to the place of contact (Weinhart et al. 2012).
    #[word(keyword = "boundary/atom", name = "group")]
    boundary: Option<GroupId>,
    /// So are all walls of `fix wall/gran`, `wall/gran/region` and `wall/mesh`, each with `contacts`.
    #[word(flag = "boundary/fix")]
    walls: bool,
}

impl ComputeStyle for ContinuumChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { chunks: At { value: chunks, span: at, .. }, cutoff, width, fields, boundary, walls } =
            read(args, cx)?;
        let bins = bins_of(&chunks, cx.world.settings.two_dimensional, at)?;
        let Some(kernel) = Kernel::new(chunks.kind.coordinates, cutoff, width.value) else {
            let text = format!(
                "a kernel of cutoff {cutoff} and width {} does not fit double precision",
                width.value
            );
            return Err(Diagnostic::error(Code::BAD_VALUE, width.span, text)
                .help("about a grain's diameter is a width that serves, and three times as much a cutoff")
                .into());
        };
        let force = fields.iter().find(|f| f.value.0.iter().any(Field::is_boundary_force));
        if let Some(At { span, .. }) = force.filter(|_| boundary.is_none() && !walls) {
            let text = "`boundary/force` needs a boundary";
            return Err(Diagnostic::error(Code::CONFLICT, *span, text)
                .help("add `boundary/atom GROUP` or `boundary/fix` at the end of the line")
                .into());
        }
        let fields = fields.into_iter().flat_map(|f| f.value.0).collect();
        let (id, group) = (cx.id.to_string(), cx.group);
        let c = Declared { id, group, chunks, bins, kernel, fields, boundary, walls };
        if c.fields.iter().any(|f| f.needs_spheres()) {
            crate::need_spheres("a field of volumes or contacts", cx)?;
        }
        if let Some(d) = &*cx.world.domain {
            upright(d, cx.span)?;
        }
        Ok(Box::new(c))
    }
}

/// The axes of the chunks, which must be bins.
fn bins_of(chunks: &ChunkRef, flat: bool, span: Span) -> Result<Bins> {
    let id = &chunks.id;
    let refused = |text: String, help: &str| -> Result<Bins> {
        Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into())
    };
    match chunks.kind.bins {
        None => refused(
            format!("the chunks of compute {id} are no bins along axes"),
            "name a compute chunk/atom with `bin/1d`, `bin/2d` or `bin/3d`",
        ),
        Some(_) if chunks.kind.compressed => refused(
            format!("compute {id} leaves out bins without particles"),
            "give it no `compress yes`: fields are there between particles, too",
        ),
        Some(bins) if flat && bins.axes.contains(&Some(2)) => {
            refused(format!("compute {id} has bins along z, where two dimensions end"), "bin along x and y")
        }
        Some(bins) => Ok(bins),
    }
}

fn upright(d: &Domain, span: Span) -> Result<()> {
    match d.tilt {
        Some(_) => Err(orthogonal("compute continuum/chunk").at(span)),
        None => Ok(()),
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    chunks: ChunkRef,
    bins: Bins,
    kernel: Kernel,
    fields: Vec<Field>,
    /// `boundary/atom`.
    boundary: Option<GroupId>,
    /// `boundary/fix`.
    walls: bool,
}

impl Declared {
    /// Readings of the walls' contacts, seven columns per wall.
    fn walls(&self, cx: &mut dyn SealCx, stage: Stage, when: &When) -> Result<Vec<[Reading; 7]>> {
        if !self.walls {
            return Ok(vec![]);
        }
        let span = cx.span();
        let ids: Vec<String> = cx.world().outlines.keys().map(|k| Key::text(k).to_string()).collect();
        if ids.is_empty() {
            let text = "`boundary/fix` needs a wall, and there is none";
            return Err(Diagnostic::error(Code::INCOMPLETE, span, text)
                .help("add `fix ID group wall/gran … contacts` before the run")
                .into());
        }
        let mut walls = vec![];
        for id in ids {
            let mut column = |k: usize| {
                let r = ValueRef { kind: RefKind::Fix, name: id.clone(), index: vec![k], span };
                cx.reading(&r, Wants::PerAtom, stage, when).map_err(|_| {
                    let text = format!("`boundary/fix` needs the contacts of fix {id}, which offers none");
                    Diagnostic::error(Code::INCOMPLETE, span, text)
                        .help(format!("write `contacts` at the end of the line of fix {id}"))
                })
            };
            walls.push([column(1)?, column(2)?, column(3)?, column(4)?, column(5)?, column(6)?, column(7)?]);
        }
        Ok(walls)
    }
}

/// Largest reach of the kernel in box lengths.
const MOST_IMAGES: f64 = 30.0;

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { array: self.fields.len(), array_rows: Shape::OPEN, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (me, span) = (self.clone(), cx.span());
        check_masses(cx.world(), span)?;
        let (chunks, kind) = (self.chunks.seal(cx, stage, when)?, self.chunks.kind);
        let needed = Needed::of(&self.fields);
        let mut probes = if needed.pairs { answering(&self.id, cx)? } else { vec![] };
        let walls = self.walls(cx, stage, when)?;
        let mut reads = X | V | MASS | MASK | BOX | KIND | TYPE_MASS;
        if cx.world().particles.style.sphere {
            reads |= RADIUS;
        }
        if needed.pairs {
            reads = reads
                | OMEGA
                | CONTACTS
                | BONDS
                | COLUMNS
                | FACTS
                | FAMILIES
                | TAG
                | LISTS
                | MOLECULE
                | TRAVEL;
        }
        if needed.pairs && cx.world().particles.style.peri {
            reads = reads | VOLUME | X0;
        }
        Ok(fill(&self.id, &Wanted { slot, stage, when }, reads, move |w, _, out| {
            let d = w.domain()?;
            upright(d, span)?;
            let chunks = Chunks::of(w, chunks, kind);
            (out.array_cols, out.chunks) = (me.fields.len(), me.chunks.varying());
            let Some(grid) = Grid::of(&chunks, me.bins, d) else {
                out.array.clear();
                return Ok(());
            };
            if grid.shortest_period().is_some_and(|l| me.kernel.cutoff > MOST_IMAGES * l) {
                let text = format!(
                    "the kernel of compute {} reaches over more than {MOST_IMAGES} periodic boxes",
                    me.id
                );
                return fail(Code::BAD_VALUE, span, text);
            }
            let pairs = look_all(&mut probes, w, Request::Acting)?;
            let scope = Scope {
                w,
                group: me.group,
                boundary: me.boundary,
                chunks: &chunks,
                grid: &grid,
                kernel: &me.kernel,
            };
            let fields = Fields::new(&scope, needed, &pairs, &walls);
            out.array = fields.rows(&me.fields, &grid);
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::Chunking;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    fn bench(style: AtomStyle) -> Bench {
        let mut b = Bench::new(style, &[[0.0; 3]; 2]);
        let bins = Some(Bins { axes: [Some(0), Some(1), None], reduced: false });
        let of = |kind| Shape { atom: Some(1), chunks: Some(kind), ..Shape::default() };
        let kind = Chunking { coordinates: 2, bins, ..Chunking::default() };
        b.computes.insert("cc".into(), of(kind));
        b.computes.insert("few".into(), of(Chunking { compressed: true, ..kind }));
        b.computes.insert("type".into(), of(Chunking::default()));
        b
    }

    fn columns(b: &Bench, words: &str) -> usize {
        b.compute(&ContinuumChunk, words).unwrap_or_else(|e| panic!("{words}: {e:?}")).shape().array
    }

    #[test]
    fn wildcards_stand_for_all_components() {
        let spheres = AtomStyle { sphere: true, ..AtomStyle::default() };
        let mut b = bench(spheres);
        assert_eq!(columns(&b, "cc 1 0.3 density velocity/* stress/*"), 13);
        assert_eq!(columns(&b, "cc 1 0.3 stress/ke/xy momentum/grad/* temperature natoms"), 12);
        assert_eq!(columns(&b, "cc 1 0.3 boundary/force/* boundary/atom all boundary/fix"), 3);
        b.world.settings.two_dimensional = true;
        assert_eq!(columns(&b, "cc 1 0.3 velocity/* stress/* volume/fraction strain/rate/yx"), 8);
        for words in ["velocity/z", "stress/xz", "fabric/zz"] {
            assert!(b.compute(&ContinuumChunk, &format!("cc 1 0.3 {words}")).is_err(), "{words}");
        }
    }

    #[test]
    fn mistakes_are_named() {
        let b = bench(AtomStyle { sphere: true, ..AtomStyle::default() });
        let bad = "|cc|cc 1|cc 0 1 density|cc 1 0 density|cc -1 1 density|cc 1e-200 1 density|cc 1 0.3|cc 1 0.3 dense|cc 1 0.3 velocity|\
                   cc 1 0.3 velocity/w|cc 1 0.3 stress/x|cc 1 0.3 stress/kx/xx|cc 1 0.3 boundary/force/x|cc 1 0.3 density boundary/atom|\
                   cc 1 0.3 density boundary/atom no|few 1 0.3 density|type 1 0.3 density|cc 1 0.3 boundary/fix";
        for words in bad.split('|') {
            assert!(b.compute(&ContinuumChunk, words).is_err(), "{words}");
        }
        let points = bench(AtomStyle::default());
        assert_eq!(columns(&points, "cc 1 0.3 density velocity/grad/*"), 10);
        assert!(points.compute(&ContinuumChunk, "cc 1 0.3 stress/xx").is_err());
        // Walls are looked up when a run begins.
        let mut b = b;
        let c = b.compute(&ContinuumChunk, "cc 1 0.3 density boundary/fix").unwrap();
        assert!(b.evaluate(&*c).is_err());
    }
}
