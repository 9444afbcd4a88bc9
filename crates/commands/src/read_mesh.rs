//! `read_mesh`: a particle for each cell of a volume mesh, at its centroid, with its volume.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span};
use perigrain_base::math::cformat::general;
use perigrain_geometry::body::{Body, FromFile};
use perigrain_geometry::enter::{Newcomers, off_plane};
use perigrain_geometry::file::File;
use perigrain_geometry::mesh::cell::{Fault, Shape, measure};
use perigrain_geometry::mesh::types::{Source, Types};
use perigrain_geometry::mesh::{self, Mesh};
use perigrain_geometry::words::{self, Making, Options};
use perigrain_lang::{Args, Word};
use perigrain_styles::common;
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};

/// The command.
pub struct ReadMesh;

impl Style for ReadMesh {
    fn name(&self) -> &'static str {
        "read_mesh"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Makes a particle for each cell of a volume mesh, at its centroid, with its volume.",
            text: "Cells are tetrahedra, pyramids, wedges and hexahedra; with `thickness`, and always in a flat scene (`dimension \
                   2`), triangles and quads. What a file has besides (faces of a solid, lines, points) is left out, and the log \
                   counts it. The extension selects the format, `.gz` behind it a packed file:\n\n\
                   - `.msh`: Gmsh, versions 2.2 and 4.1 as text;\n\
                   - `.inp`: Abaqus: `*NODE`, `*ELEMENT`, `*ELSET` of one part that stands where it is;\n\
                   - `.vtk`: legacy VTK with an unstructured grid, text or binary;\n\
                   - `.vtu`: VTK's XML, as text, base64 or raw bytes, packed by zlib or not.\n\n\
                   Volume and centroid are exact for cells with straight edges and bilinear faces; nodes between the corners are \
                   left out, with a warning: such cells count as straight. Cells without volume, inside out, or made twice are \
                   refused by number (as the file counts; VTK's from 0). Wedges may have either triangle first.\n\n\
                   Cells in none of the groups of `types` get the `type`, and are refused where there is none. Only particles \
                   inside of the box are made; a warning counts the others. Peridynamic particles get the volume, spheres the \
                   diameter of a ball of the same volume. Ids continue behind the largest one.\n\n\
                   For peridynamics `lattice sc` is the mean spacing V^⅓ of its cells, which is what the partial volumes at the \
                   horizon and `horizon` of a material go by; where cells are not alike in size `peri_modify horizon own` lets them \
                   go by the spacing around each particle. With `peri_modify volume full surface tensor` bars of tetrahedra and \
                   hexahedra, nine and eight cells across, that are pulled have Young's modulus within 2 % of the material's, under \
                   `peri/pmb` and `peri/lps`.",
            example: "read_mesh body.msh types physical rock 1 binder 2 density 2235.0 scale 0.001 shift 0 0 0.006",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The file.
    #[word(name = "FILE", what = "the name of a mesh", kind = Kind::File)]
    file: Word,
    #[word(keyword, placed)]
    types: Option<At<Source>>,
    /// The thickness of triangles and quads, whose area times it is the volume [length].
    #[word(keyword, name = "H", positive)]
    thickness: Option<f64>,
    #[word(flatten)]
    options: Options,
}

/// A parsed line.
struct Reading {
    file: Word,
    making: Making,
    types: Option<Types>,
    thickness: Option<f64>,
    checking: bool,
}

impl CommandStyle for ReadMesh {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let Line { file, types, thickness, options } = read(a, cx)?;
        let (making, types) = (options.making(cx)?, types.map(Types::new).transpose()?);
        let mut r = Reading { file, making, types, thickness, checking: cx.checking };
        words::need_type(&mut r.making, r.types.is_some(), cx)?;
        if cx.world.settings.two_dimensional && r.thickness.is_none() {
            let d = Diagnostic::error(
                Code::INCOMPLETE,
                a.name_span(),
                "a flat scene needs the thickness of its cells",
            );
            return Err(d.help("add `thickness 1` for volumes that are areas").into());
        }
        Ok(Box::new(FromFile(r)))
    }
}

impl Body for Reading {
    fn making(&self) -> &Making {
        &self.making
    }

    fn make(&self, cx: &mut ActCx) -> Result<()> {
        let file = File::find(cx.world, &self.file, "mesh")?;
        cx.print("Reading mesh file ...");
        self.enter(cx, &file).map_err(|e| file.blame(e))
    }
}

impl Reading {
    fn enter(&self, cx: &mut ActCx, file: &File) -> Result<()> {
        let mesh = mesh::read(file, &self.file.text)?;
        let used = self.used(cx, &mesh)?;
        if let Some((k, first)) = mesh.twice() {
            let text = format!("cell {} has the corners of cell {}", mesh.numbers[k], mesh.numbers[first]);
            let d = Diagnostic::error(Code::DUPLICATE_NAME, mesh.place(k), text);
            return Err(d.label(mesh.place(first), "the first one").into());
        }
        let types = cx.world.types;
        let kinds = match &self.types {
            Some(by) => by.of(&mesh, &used, self.making.kind, types)?,
            None => vec![self.making.kind.unwrap_or(1); mesh.count()],
        };
        self.log_summary(cx, &mesh, &used);
        let chosen: Vec<usize> = (0..mesh.count()).filter(|&k| used[k] && kinds[k] != 0).collect();
        let mut new = Newcomers::new(cx, &self.making, chosen.len())?;
        let mut corners: Vec<[f64; 3]> = vec![];
        for k in chosen {
            corners.clear();
            corners.extend(mesh.corners(k).iter().map(|&p| mesh.points[p as usize]));
            let shape = mesh.shapes[k];
            let (size, x) = measure(shape, &corners).map_err(|fault| bad_cell(&mesh, k, fault))?;
            let what = || format!("cell {}", mesh.numbers[k]);
            new.push(x, kinds[k], self.volume(shape, size))
                .map_err(|z| off_plane(&what(), z, Some(mesh.place(k))))?;
        }
        new.enter(cx, "cells", self.checking).map(drop)
    }

    /// The volume in the box of what has this volume or area in the file.
    fn volume(&self, shape: Shape, size: f64) -> f64 {
        let scale = self.making.placement.scale;
        match (shape.solid(), self.thickness) {
            (false, Some(h)) => size * scale * scale * h,
            _ => size * scale.powi(3),
        }
    }

    /// Which cells become particles: solid ones, or with a thickness the others.
    fn used(&self, cx: &ActCx, mesh: &Mesh) -> Result<Vec<bool>> {
        let solid = self.thickness.is_none();
        let used: Vec<bool> = mesh.shapes.iter().map(|s| s.solid() == solid).collect();
        if used.contains(&true) {
            return Ok(used);
        }
        let (wanted, help) = match (solid, mesh.count()) {
            (true, 1..) => ("solid cells", "`thickness H` makes particles of triangles and quads"),
            (true, 0) => ("cells", "Gmsh writes only what belongs to a physical group, where there is one"),
            (false, _) if cx.world.settings.two_dimensional => {
                ("triangles or quads", "a flat scene needs a flat mesh")
            }
            (false, _) => ("triangles or quads", "leave `thickness` out for a mesh of solid cells"),
        };
        let d = Diagnostic::error(
            Code::BAD_FILE,
            self.file.span,
            format!("`{}` has no {wanted}", self.file.text),
        );
        Err(d.help(help).into())
    }

    fn log_summary(&self, cx: &mut ActCx, mesh: &Mesh, used: &[bool]) {
        let count = |shape: Shape, yes: bool| {
            mesh.shapes.iter().zip(used).filter(|(s, u)| **s == shape && **u == yes).count()
        };
        let list = |yes: bool| {
            let cells = Shape::ALL.iter().map(|s| (s.name(), count(*s, yes)));
            let others = mesh.skipped.iter().map(|(n, k)| (*n, *k)).filter(|_| !yes);
            let all: Vec<(&str, usize)> = cells.chain(others).filter(|(_, n)| *n > 0).collect();
            all.iter().map(|(name, n)| format!("{n} {name}")).collect::<Vec<_>>().join(", ")
        };
        cx.print(format!("  {} points, {}", mesh.points.len(), list(true)));
        let left = list(false);
        if !left.is_empty() {
            cx.print(format!("  left out: {left}"));
        }
        if mesh.curved > 0 {
            let text = format!(
                "{} cells have nodes between corners, which are left out: edges count as straight",
                mesh.curved
            );
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, self.file.span, text));
        }
    }
}

/// The refusal of a cell that is none.
fn bad_cell(mesh: &Mesh, k: usize, fault: Fault) -> Diagnostics {
    let (number, at): (u64, Span) = (mesh.numbers[k], mesh.place(k));
    let text = match fault {
        Fault::Flat if mesh.shapes[k].solid() => format!("cell {number} has no volume"),
        Fault::Flat => format!("cell {number} has no area"),
        Fault::Negative(v) => format!("cell {number} is inside out: its volume is {}", general(v, 6)),
        Fault::Crossed => format!("the edges of cell {number} cross each other"),
    };
    Diagnostic::error(Code::BAD_VALUE, at, text).into()
}
