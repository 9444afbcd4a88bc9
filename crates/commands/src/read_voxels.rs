//! `read_voxels`: particles from an image of grey values, by material.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::cformat::general;
use perigrain_geometry::body::{Body, FromFile};
use perigrain_geometry::enter::{Newcomers, off_plane};
use perigrain_geometry::voxels::blocks::{Blocks, Counter};
use perigrain_geometry::voxels::ranges::{List, Ranges};
use perigrain_geometry::voxels::{self, Image};
use perigrain_geometry::words::{Making, Options};
use perigrain_lang::{Args, Word};
use perigrain_styles::common;
use perigrain_styles::words::{At, Kind, Syntax, Value, Words, read};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};

/// The command.
pub struct ReadVoxels;

/// How far the volume of a material may be from that in the image without a warning.
const NEAR: f64 = 0.01;

impl Style for ReadVoxels {
    fn name(&self) -> &'static str {
        "read_voxels"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Makes particles of the voxels of an image, as a tomograph gives it: ranges of grey values become types.",
            text: "The extension selects the format:\n\n\
                   - `.nrrd`, `.nhdr`: NRRD of two or three axes along x, y, z, raw or packed by gzip, of either byte order, whole numbers of 8 to 64 bits and fractions;\n\
                   - `.png`: grey values of 1 to 16 bits; a `*` in the name stands for the numbers of slices (`ct_*.png`), in whose order they lie along z;\n\
                   - `.tif`, `.tiff`: grey values of 8 to 32 bits and fractions, in strips and not packed, one page a file with a `*` or several in one;\n\
                   - `.vti`: VTK's XML images in one piece.\n\n\
                   Packed TIFF is refused by name. Images are read slice by slice, twice: memory is needed for the particles and \
                   one slice. A `.vti` is so where its arrays are appended raw, packed by zlib or not, as ParaView writes them; one \
                   whose arrays are text or base64 is read whole.\n\n\
                   Edges of voxels are the file's, or `spacing`'s, which a file without them needs (PNG, TIFF). The image begins \
                   where the file says, else with its lower corner at the origin; columns lie along x, rows along y with the first \
                   one lowest. Images in flat scenes have one slice, which lies at z = 0; its depth counts in the volume.\n\n\
                   Each voxel with a type is a particle, in its middle with its volume. With `resample` each block is, of the \
                   material that fills most of it. What materials gain and lose by that is kept account of and decides where two \
                   fill about the same: of the whole image each material keeps its volume to within about ten blocks, and the log \
                   compares. More than 1 % draws a warning, as in images of a few hundred blocks.\n\n\
                   Masses and diameters are those of `read_mesh`. The particles lie on a lattice: `lattice sc` with the edge of \
                   voxels or blocks, for peridynamics, makes partial volumes and horizons of materials right.",
            example: "read_voxels stack.nrrd types 100:199 1 200:255 2 resample 0.001 density 2235.0 scale 0.001 shift -0.004 -0.004 0.0045",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The file.
    #[word(name = "FILE", what = "the name of an image", kind = Kind::File)]
    file: Word,
    #[word(keyword, name = "ranges", placed)]
    types: Option<At<List>>,
    /// The edge of voxels for all axes, or one for each [length].
    #[word(keyword, name = "edges")]
    spacing: Option<Spacing>,
    /// The edge of blocks, about: a whole number of them along each edge of the image [length].
    #[word(keyword, name = "H", positive)]
    resample: Option<f64>,
    /// The name of an array, of cells or of points, of a `.vti` with several.
    #[word(keyword, name = "NAME", what = "the name of an array")]
    array: Option<Word>,
    #[word(flatten)]
    options: Options,
}

/// Edges of voxels.
#[derive(Words)]
struct Spacing {
    #[word(name = "S", what = "the edge of voxels", positive)]
    x: f64,
    #[word(name = "SY SZ", what = "the edge of voxels along {}")]
    others: Option<(Edge, Edge)>,
}

/// The edge of voxels along another axis.
struct Edge(f64);

impl Value for Edge {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.positive(what).map(Self)
    }
    fn begins(word: &Word) -> bool {
        word.unknown || word.text.parse::<f64>().is_ok()
    }
}

impl Spacing {
    fn edges(self) -> [f64; 3] {
        match self.others {
            Some((y, z)) => [self.x, y.0, z.0],
            None => [self.x; 3],
        }
    }
}

/// A parsed line.
struct Reading {
    file: Word,
    making: Making,
    ranges: Ranges,
    spacing: Option<[f64; 3]>,
    resample: Option<f64>,
    array: Option<Word>,
    checking: bool,
}

impl CommandStyle for ReadVoxels {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let Line { file, types, spacing, resample, array, options } = read(a, cx)?;
        if let Some(kind) = &options.kind {
            let text = "voxels get their types by grey values: `types`";
            let d = Diagnostic::error(Code::CONFLICT, kind.span, text);
            return Err(d.help("`types 1:255 1` makes all from 1 to 255 type 1").into());
        }
        let Some(types) = types else {
            let d = Diagnostic::error(
                Code::INCOMPLETE,
                a.name_span(),
                "which grey values are which types is missing",
            );
            return Err(d.help("write for example `types 40:120 1 121:255 2`").into());
        };
        let (making, ranges) = (options.making(cx)?, Ranges::new(&types)?);
        let (spacing, checking) = (spacing.map(Spacing::edges), cx.checking);
        let r = Reading { file, making, ranges, spacing, resample, array, checking };
        Ok(Box::new(FromFile(r)))
    }
}

impl Body for Reading {
    fn making(&self) -> &Making {
        &self.making
    }

    fn make(&self, cx: &mut ActCx) -> Result<()> {
        let mut image = voxels::open(cx.world, &self.file, self.array.as_ref())?;
        cx.print("Reading image ...");
        self.enter(cx, &mut *image)
    }
}

/// An image with the edges of its voxels and the grid of blocks over it.
struct Grid {
    corner: [f64; 3],
    /// Edges of a block.
    edges: [f64; 3],
    blocks: Blocks,
    /// Types of the materials, from material 1 on.
    types: Vec<u16>,
}

impl Grid {
    /// The middle of block `k` of a slab.
    fn place(&self, k: usize, slab: usize) -> [f64; 3] {
        let at = [k % self.blocks.count[0], k / self.blocks.count[0], slab];
        [0, 1, 2].map(|d| self.corner[d] + (at[d] as f64 + 0.5) * self.edges[d])
    }
}

impl Reading {
    fn enter(&self, cx: &mut ActCx, image: &mut dyn Image) -> Result<()> {
        let info = image.info().clone();
        let Some(spacing) = self.spacing.or(info.spacing) else {
            let text = format!("the image `{}` does not state the size of its voxels", self.file.text);
            let d = Diagnostic::error(Code::INCOMPLETE, self.file.span, text);
            return Err(d.help("add `spacing S`, the edge of a voxel").into());
        };
        let mut corner = info.corner(spacing);
        if cx.world.settings.two_dimensional {
            if info.size[2] != 1 {
                let text = format!("a flat scene takes one slice; the image has {}", info.size[2]);
                return Err(Diagnostic::error(Code::CONFLICT, self.file.span, text).into());
            }
            corner[2] = -0.5 * spacing[2];
        }
        // What is resampled is the image at its size in the box.
        let wanted = self.resample.map(|h| h / self.making.placement.scale);
        let blocks = Blocks::new(info.size, spacing, wanted);
        let edges = [0, 1, 2].map(|d| spacing[d] * info.size[d] as f64 / blocks.count[d] as f64);
        let grid = Grid { corner, edges, blocks, types: self.ranges.types() };
        self.log_summary(cx, info.size, spacing, &grid);
        let mut voxels = vec![0u64; grid.types.len() + 1];
        let mut counts = vec![0usize; grid.types.len() + 1];
        self.each_block(image, &grid, Some(&mut voxels), |_, m| {
            counts[m] += 1;
            Ok(())
        })?;
        let count = counts[1..].iter().sum();
        if count == 0 {
            let text = format!("no voxel of `{}` has a grey value in these ranges", self.file.text);
            return Err(Diagnostic::error(Code::BAD_VALUE, self.file.span, text).into());
        }
        let scale = self.making.placement.scale.powi(3);
        let volume = scale * edges.iter().product::<f64>();
        let mut new = Newcomers::new(cx, &self.making, count)?;
        image.rewind()?;
        self.each_block(image, &grid, None, |x, m| match m {
            0 => Ok(()),
            _ => match new.push(x, grid.types[m - 1], volume) {
                Ok(_) => Ok(()),
                Err(z) => Err(off_plane("the image", z, Some(self.file.span)).into()),
            },
        })?;
        new.enter(cx, "voxels", self.checking)?;
        if !grid.blocks.single() {
            let voxel = scale * spacing.iter().product::<f64>();
            self.compare(
                cx,
                &grid,
                [
                    &voxels.iter().map(|n| *n as f64 * voxel).collect::<Vec<_>>(),
                    &counts.iter().map(|n| *n as f64 * volume).collect::<Vec<_>>(),
                ],
            );
        }
        Ok(())
    }

    /// Hands over the middle and material of each block, slab by slab, and counts the voxels of each material.
    fn each_block(
        &self,
        image: &mut dyn Image,
        grid: &Grid,
        mut voxels: Option<&mut Vec<u64>>,
        mut block: impl FnMut([f64; 3], usize) -> Result<()>,
    ) -> Result<()> {
        let slices = image.info().size[2];
        let mut counter = Counter::new(&grid.blocks, grid.types.len());
        let mut values = vec![];
        let mut materials: Vec<usize> = vec![];
        let mut outcome = Ok(());
        for z in 0..slices {
            image.slice(&mut values)?;
            materials.clear();
            materials.extend(values.iter().map(|v| {
                let kind = self.ranges.of(*v);
                if kind == 0 { 0 } else { grid.types.binary_search(&kind).map_or(0, |k| k + 1) }
            }));
            if let Some(voxels) = &mut voxels {
                materials.iter().for_each(|m| voxels[*m] += 1);
            }
            counter.add(materials.iter().copied());
            let slab = grid.blocks.slab(z);
            if z + 1 == slices || grid.blocks.slab(z + 1) != slab {
                counter.settle(|k, m| {
                    if outcome.is_ok() {
                        outcome = block(grid.place(k, slab), m);
                    }
                });
                std::mem::replace(&mut outcome, Ok(()))?;
            }
        }
        Ok(())
    }

    fn log_summary(&self, cx: &mut ActCx, size: [usize; 3], spacing: [f64; 3], grid: &Grid) {
        let text = |x: [f64; 3]| x.map(|x| general(x, 8)).join(" x ");
        let whole = |n: [usize; 3]| n.map(|n| n.to_string()).join(" x ");
        cx.print(format!("  {} voxels of {}", whole(size), text(spacing)));
        if !grid.blocks.single() {
            let scale = self.making.placement.scale;
            cx.print(format!(
                "  {} blocks of {}",
                whole(grid.blocks.count),
                text(grid.edges.map(|e| e * scale))
            ));
        }
    }

    /// Logs the volume of each material in the image and in the particles made.
    fn compare(&self, cx: &mut ActCx, grid: &Grid, [image, made]: [&[f64]; 2]) {
        for (k, kind) in grid.types.iter().enumerate() {
            let (before, after) = (image[k + 1], made[k + 1]);
            if before == 0.0 {
                continue;
            }
            let off = after / before - 1.0;
            cx.print(format!(
                "  type {kind}: {} in the image, {:+.2} % in blocks",
                general(before, 10),
                100.0 * off
            ));
            if off.abs() > NEAR {
                let text =
                    format!("blocks of this size change the volume of type {kind} by {:+.1} %", 100.0 * off);
                cx.note(
                    Diagnostic::warning(Code::SUSPICIOUS, None, text)
                        .help("smaller blocks keep it better: `resample`"),
                );
            }
        }
    }
}
