//! Dumps `mesh/stl` and `mesh/vtk`: the surfaces of `fix surface` where they are, with what grains do to them.

use super::base::{Base, Common, Files, OfFile, OfParticles, foreign};
use super::{Dump, DumpStyle, MODIFY};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, fail, nearest};
use perigrain_base::math::cformat::general;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};
use perigrain_lang::{Args, Word};
use perigrain_plan::Op;
use perigrain_styles::mesh_surface::{MeshSurface, SURFACES};
use perigrain_styles::words::{Form, Syntax, Words, read, read_or};
use perigrain_styles::{BuildCx, Doc, SealCx, Style, UseKind};
use perigrain_world::field::MEMO;
use perigrain_world::outline::Triangle;
use perigrain_world::{Key, World};
use std::fmt::Write;

/// Digits of numbers in files, enough for doubles.
const DIGITS: usize = 15;

/// `dump … mesh/stl`.
pub struct MeshStl;

/// `dump … mesh/vtk`.
pub struct MeshVtk;

impl Style for MeshStl {
    fn name(&self) -> &'static str {
        "mesh/stl"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Stl::GRAMMAR), Form::headed(MODIFY, Common::GRAMMAR)] },
            ),
            summary: "Writes surfaces of `fix surface` every N steps as STL text, where they are then.",
            text: "All surfaces of a file are one solid, in the order of the line; without IDs all surfaces are written, in \
                   the order of their names. A `*` in the file's name becomes the step. Not in LAMMPS. The group means \
                   nothing.",
            example: "fix gear all surface blade.stl type 1 scale 0.001\ndump look all mesh/stl 100 gear_*.stl gear",
        }
    }
}

impl Style for MeshVtk {
    fn name(&self) -> &'static str {
        "mesh/vtk"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Vtk::GRAMMAR), Form::headed(MODIFY, Common::GRAMMAR)] },
            ),
            summary: "Writes surfaces of `fix surface` with stress and wear every N steps as VTK text.",
            text: "A legacy VTK file of polygons for ParaView. The values of each triangle, in this order: `stress` writes \
                   the fields `normal_stress_average` and `shear_stress_average`, the parts of the force of grains on the \
                   triangle along its normal and in its plane over its area; `stresscomponents` writes `stress`, that \
                   force over the area; `id` the number from 0 in the surface as `meshid`; `wear` the wear of `fix surface \
                   … wear`; `owner` the rank, 0; `area`; `vel` the velocity `v` that contacts feel at the middle.\n\n\
                   Forces are those of the step that is written. Without IDs all surfaces are written, in the order of \
                   their names. Not in LAMMPS. The group means nothing.",
            example: "fix chute all surface blade.stl type 1 scale 0.001 wear finnie 1.0e-6\n\
                      dump look all mesh/vtk 100 chute_*.vtk stress wear area chute",
        }
    }
}

/// The line of a dump of places.
#[derive(Words)]
struct Stl {
    #[word(flatten)]
    target: OfFile,
    /// Surfaces by the IDs of their fixes; without any all surfaces.
    #[word(name = "surfaceID", kind = Kind::Fix)]
    ids: Vec<Word>,
}

/// The line of a dump with values.
#[derive(Words)]
struct Vtk {
    #[word(flatten)]
    target: OfFile,
    /// What is written of each triangle.
    #[word(name = "value")]
    values: Vec<Field>,
    /// Surfaces by the IDs of their fixes; without any all surfaces.
    #[word(name = "surfaceID", kind = Kind::Fix)]
    ids: Vec<Word>,
}

/// What is written of each triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Words)]
#[word(what = "value of triangles")]
enum Field {
    /// Force over area along the normal and in the plane.
    Stress,
    /// Force over area.
    StressComponents,
    /// The number in the surface, from 0.
    Id,
    /// The wear.
    Wear,
    /// The rank, 0.
    Owner,
    /// The area [length²].
    Area,
    /// The velocity that contacts feel in the middle [length/time].
    Vel,
}

impl DumpStyle for MeshStl {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        let Stl { target: OfFile { file }, ids } = read(args, cx)?;
        let base = Base::new(Files { endings: &[".stl"], ..Files::any("mesh/stl") }, &file, cx)?;
        declared(base, &file, None, ids, cx)
    }
}

impl DumpStyle for MeshVtk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        let Vtk { target: OfFile { file }, values, ids } = read(args, cx)?;
        let base = Base::new(Files { endings: &[".vtk"], ..Files::any("mesh/vtk") }, &file, cx)?;
        declared(base, &file, Some(values), ids, cx)
    }
}

/// The dump of these surfaces.
fn declared(
    base: Base,
    file: &Word,
    fields: Option<Vec<Field>>,
    ids: Vec<Word>,
    cx: &BuildCx,
) -> Result<Box<dyn Dump>> {
    base.needs_star(file.span, cx)?;
    let all = cx.world.facts.get(*SURFACES);
    for word in &ids {
        if all.is_some_and(|all| all.look_up(&word.text).is_some()) {
            cx.uses(UseKind::Fix, &word.text);
            continue;
        }
        let names: Vec<&str> = all.map_or(vec![], |all| all.keys().map(Key::text).collect());
        let d =
            Diagnostic::error(Code::UNKNOWN_NAME, word.span, format!("there is no surface `{}`", word.text));
        return Err(match nearest(&word.text, names) {
            Some(name) => d.help(format!("did you mean `{name}`?")),
            None => d.help("declare it above this line with `fix ID all surface FILE type T`"),
        }
        .into());
    }
    let ids = ids.into_iter().map(|word| Key::new(&word.text)).collect();
    Ok(Box::new(Declared { base, fields, ids }))
}

#[derive(Clone, Debug)]
struct Declared {
    base: Base,
    /// Values of triangles; none in STL files.
    fields: Option<Vec<Field>>,
    ids: Vec<Key<MeshSurface>>,
}

/// Refuses keywords that other dumps have.
fn foreign_here(word: &Word) -> Option<Diagnostics> {
    if !OfParticles::GRAMMAR.has(&word.text) {
        return foreign(word);
    }
    let text = format!("dump_modify {} concerns particles, and this dump writes none", word.text);
    Some(Diagnostic::error(Code::CONFLICT, word.span, text).into())
}

impl Dump for Declared {
    fn op(&self, cx: &mut dyn SealCx, every: i64) -> Result<Box<dyn Op>> {
        let dump = self.clone();
        self.base.seal_reading(cx, every, &[], MEMO, move |shot| {
            let shown = dump.shown(shot.world)?;
            let text = match &dump.fields {
                None => stl(&shown),
                Some(fields) => vtk(&shown, fields),
            };
            shot.state.target.write(shot.step, |to| to.write_all(text.as_bytes()))
        })
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let common: Common = read_or(args, cx, foreign_here)?;
        self.base.modify(common, cx)
    }

    fn every(&self) -> Option<i64> {
        self.base.every()
    }

    fn growing(&self) -> bool {
        self.base.growing()
    }
}

/// A triangle where it is, with what is written of it.
struct Face {
    corners: Triangle,
    normal: Vec3,
    /// Number in its surface, from 0.
    number: usize,
    area: f64,
    force: Vec3,
    wear: f64,
    velocity: Vec3,
}

impl Declared {
    /// The faces of all surfaces of the line.
    fn shown(&self, w: &World) -> Result<Vec<Face>> {
        let mut faces = vec![];
        let Some(all) = w.facts.get(*SURFACES) else { return Ok(faces) };
        if self.ids.is_empty() {
            let mut named: Vec<_> = all.iter().collect();
            named.sort_by_key(|(key, _)| key.text());
            named.into_iter().for_each(|(_, surface)| add_faces(w, surface, &mut faces));
        }
        for id in &self.ids {
            let Some(surface) = all.get(*id) else {
                return fail(Code::UNKNOWN_NAME, None, format!("surface `{id}` is gone"));
            };
            add_faces(w, surface, &mut faces);
        }
        Ok(faces)
    }
}

/// The faces of a surface.
fn add_faces(w: &World, surface: &MeshSurface, faces: &mut Vec<Face>) {
    let (pose, first) = (surface.pose(w), faces.len());
    let wear = w.memo.get(surface.keys.wear);
    for (number, own) in surface.mesh.triangles().iter().enumerate() {
        let corners @ [a, b, c] = own.map(|p| pose.at(p));
        let normal = cross(sub(b, a), sub(c, a));
        let third = 1.0 / 3.0;
        let middle = scale(third, add(own[0], add(own[1], own[2])));
        let sliding = pose.direction(surface.sliding(number, middle));
        faces.push(Face {
            corners,
            normal: scale(1.0 / length(normal), normal),
            number,
            area: 0.5 * length(normal),
            force: [0.0; 3],
            wear: wear.and_then(|wear| wear.get(number)).copied().unwrap_or(0.0),
            velocity: add(pose.velocity_at(pose.at(middle)), sliding),
        });
    }
    for touched in w.memo.get(surface.keys.touched).into_iter().flat_map(|all| all.chunks_exact(4)) {
        if let Some(face) = faces.get_mut(first + touched[0] as usize) {
            face.force = add(face.force, [touched[1], touched[2], touched[3]]);
        }
    }
}

/// Numbers with blanks between them.
fn put(text: &mut String, numbers: &[f64]) {
    for (k, x) in numbers.iter().enumerate() {
        let _ = write!(text, "{}{}", if k > 0 { " " } else { "" }, general(*x, DIGITS));
    }
}

/// An STL text.
fn stl(faces: &[Face]) -> String {
    let mut text = String::from("solid surfaces\n");
    for face in faces {
        text.push_str("  facet normal ");
        put(&mut text, &face.normal);
        text.push_str("\n    outer loop\n");
        for corner in &face.corners {
            text.push_str("      vertex ");
            put(&mut text, corner);
            text.push('\n');
        }
        text.push_str("    endloop\n  endfacet\n");
    }
    text.push_str("endsolid surfaces\n");
    text
}

/// The fields in the order of LIGGGHTS: word, name, components, values.
type Written = (Field, &'static str, usize, fn(&Face) -> Vec3);

const WRITTEN: [Written; 8] = [
    (Field::Stress, "normal_stress_average", 1, |f| [dot(f.force, f.normal).abs() / f.area, 0.0, 0.0]),
    (Field::Stress, "shear_stress_average", 1, |f| {
        [length(sub(f.force, scale(dot(f.force, f.normal), f.normal))) / f.area, 0.0, 0.0]
    }),
    (Field::StressComponents, "stress", 3, |f| scale(1.0 / f.area, f.force)),
    (Field::Id, "meshid", 1, |f| [f.number as f64, 0.0, 0.0]),
    (Field::Wear, "wear", 1, |f| [f.wear, 0.0, 0.0]),
    (Field::Owner, "owner", 1, |_| [0.0; 3]),
    (Field::Area, "area", 1, |f| [f.area, 0.0, 0.0]),
    (Field::Vel, "v", 3, |f| f.velocity),
];

/// A legacy VTK text.
fn vtk(faces: &[Face], fields: &[Field]) -> String {
    let (n, mut text) = (faces.len(), String::new());
    let _ = write!(
        text,
        "# vtk DataFile Version 3.0\nsurfaces\nASCII\nDATASET POLYDATA\nPOINTS {} double\n",
        3 * n
    );
    for corner in faces.iter().flat_map(|face| &face.corners) {
        put(&mut text, corner);
        text.push('\n');
    }
    let _ = writeln!(text, "POLYGONS {n} {}", 4 * n);
    for k in 0..n {
        let _ = writeln!(text, "3 {} {} {}", 3 * k, 3 * k + 1, 3 * k + 2);
    }
    let written: Vec<&Written> = WRITTEN.iter().filter(|one| fields.contains(&one.0)).collect();
    if written.is_empty() {
        return text;
    }
    let _ = writeln!(text, "CELL_DATA {n}\nFIELD FieldData {}", written.len());
    for (field, name, width, value) in written {
        let kind = if [Field::Id, Field::Owner].contains(field) { "int" } else { "double" };
        let _ = writeln!(text, "{name} {width} {n} {kind}");
        for face in faces {
            put(&mut text, &value(face)[..*width]);
            text.push('\n');
        }
    }
    text
}
