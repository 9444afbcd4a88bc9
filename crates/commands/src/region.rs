//! `region`: a named volume.

mod mesh;
mod shapes;

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::vec3::length;
use perigrain_lang::{Args, Param, Word};
use perigrain_styles::common::{self, free_id, naming, setting};
use perigrain_styles::words::{At, Forms, Kind, Nullable, Syntax, Units, Value, Words};
use perigrain_styles::{BuildCx, Doc, Style, Use, UseKind};
use perigrain_world::region::{Motion, Shape, Turn, Variable};
use perigrain_world::{Key, Region, memory};

/// The command.
pub struct RegionCommand;

/// The shapes and what combines them, with the faces that `open` can name.
pub const SHAPES: [(&str, u8); 10] = [
    ("block", 6),
    ("cone", 3),
    ("cylinder", 3),
    ("ellipsoid", 0),
    ("mesh", 0),
    ("plane", 0),
    ("prism", 6),
    ("sphere", 0),
    ("union", 0),
    ("intersect", 0),
];

impl Style for RegionCommand {
    fn name(&self) -> &'static str {
        "region"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(Line::FORMS),
            summary: "Names a volume of space.",
            text: "Surfaces belong to the inside. `INF` is far away, `EDGE` the face of the box as it is now. A radius takes the \
                   lattice spacing of x (of y for a cylinder or cone along x).\n\n\
                   Every number of a shape but the ends of a cylinder may be an equal-style variable `v_name`. With these, with \
                   `move` and with `rotate` a region is where its variables say at each moment it is used: by a command, a formula, \
                   and in every step of a run by fixes, groups and dumps. It is first turned, then shifted.\n\n\
                   The file of `mesh` is STL (text or binary), OBJ (its name ends so), PLY (text or binary), VTP (VTK's XML of \
                   surfaces; text, base64 or appended, zlib or plain) or VTK's legacy text. Polygons are cut into fans around their \
                   first corner and should be convex; of tetrahedra (legacy VTK) the faces that belong to one of them alone make the \
                   surface. After `scale` and `shift` the numbers count in lattice spacings or box units as all distances \
                   do.\n\n\
                   The surface must be closed: each edge borders two triangles (corners are shared where their numbers are the \
                   same), and no two triangles cross or touch elsewhere; errors are reported with the number of edges and the place \
                   of the first one. Triangles in the wrong order of corners are turned, and the log says how many. A surface \
                   within another one is a hole.\n\n\
                   What is inside is exact for the numbers of the file, wherever edges and corners lie; binary STL has seven \
                   digits, so that sites meant to lie on a face may be on either side of it: shift the lattice by half a spacing \
                   (`origin`). `fix wall/mesh` and `peri_crack` read the same files, open or closed.\n\n\
                   `union` and `intersect` combine regions as they are declared now, their motions included, at most 10,000 of them \
                   in all and nested at most 100 deep; they cannot move by themselves. Every use that queries which particles are \
                   in a region takes it as if no face were open, as LAMMPS' manual says; LAMMPS 22Jul2025 takes all particles there \
                   are, and so does `compat lammps`.",
            example: "variable lift equal 0.001*step\n\
                      region disc cylinder z 0.0 0.0 0.037 EDGE EDGE units box move NULL NULL v_lift\n\
                      region gear mesh gear.obj scale 0.001 shift 0.0 0.0 0.002 units box",
        }
    }
}

#[derive(Words)]
#[word(forms = "region ID", what = "region style", style, refused = "grid tri")]
#[allow(clippy::large_enum_variant)] // there is one at a time, while a line is read
enum Line {
    /// A box along the axes.
    Block(shapes::Block),
    /// A cone or part of one along an axis through (C1, C2), from LO to HI.
    Cone(shapes::Cone),
    /// A cylinder along an axis through (C1, C2), from LO to HI.
    Cylinder(shapes::Cylinder),
    /// An ellipsoid about a place, with half axes A, B, C.
    Ellipsoid(shapes::Ellipsoid),
    /// The body within a surface of triangles from a file.
    Mesh(shapes::Mesh),
    /// The half of space on the side of the normal N of a plane through P.
    Plane(shapes::Plane),
    /// A body with the edges (XHI−XLO, 0, 0), (XY, YHI−YLO, 0) and (XZ, YZ, ZHI−ZLO).
    Prism(shapes::Prism),
    /// A sphere about a place.
    Sphere(shapes::Sphere),
    /// What is in one of N regions at least.
    Union(shapes::Combined),
    /// What is in all of N regions.
    Intersect(shapes::Combined),
    /// Forgets the region.
    Delete,
}

/// The keywords behind all shapes.
#[derive(Words)]
struct Options {
    #[word(keyword, default = Side::In)]
    side: Side,
    /// The unit of distances.
    #[word(keyword, default = Units::Lattice)]
    units: Units,
    /// A face that walls made of the region leave open: for a block or prism 1 to 6 (xlo xhi ylo yhi zlo zhi), for a cylinder or cone 1 (lower
    /// end), 2 (upper end), 3 (mantle).
    #[word(keyword, name = "FACE", what = "the face")]
    open: Vec<At<i64>>,
    /// Shifts the region by equal-style variables, in box units.
    #[word(keyword = "move", name = "v_X v_Y v_Z", what = "the displacement", placed)]
    shift: Option<At<[Nullable<EqualVariable>; 3]>>,
    /// Turns the region by an equal-style variable's angle in radians about an axis through P along R.
    #[word(keyword = "rotate", name = "turn", placed)]
    turn: Option<At<Rotation>>,
}

/// Which side of the surface is meant.
#[derive(PartialEq, Words)]
#[word(what = "side")]
enum Side {
    /// The inside.
    In,
    /// Everything else.
    Out,
}

#[derive(Words)]
struct Rotation {
    #[word(name = "v_THETA", what = "the angle")]
    angle: EqualVariable,
    #[word(name = "PX PY PZ", what = "a point of the axis")]
    point: [f64; 3],
    #[word(name = "RX RY RZ", what = "the axis")]
    axis: [At<f64>; 3],
}

/// `v_name` of an equal-style variable.
struct EqualVariable(Variable);

impl Value for EqualVariable {
    const KIND: Kind = Kind::Reference;
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let span = args.here();
        match common::variable_param(args, what)? {
            Param::Ref(r) => {
                cx.value(&r, false)?;
                Ok(Self(Variable { name: r.name, span: r.span }))
            }
            Param::Number(x) => {
                let text = format!("{what} must be an equal-style variable `v_name`, not the number {x}");
                fail(Code::WRONG_KIND, span, text)
            }
        }
    }
}

impl CommandStyle for RegionCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let word = a.expect("the region's ID")?;
        let name = free_id(word, "the region's ID")?;
        let (style, span) = (a.peek_text(), a.here());
        let exists =
            cx.world.regions.find(&name).is_some() && !cx.world.restored.contains(&format!("region/{name}"));
        if exists && style != "delete" && !a.is_empty() {
            let text = format!("region `{name}` exists already");
            return fail(Code::DUPLICATE_NAME, word.span, text);
        }
        let mut log = vec![];
        let (shape, given, options) = match Line::form(a, cx)? {
            Line::Delete => return delete(cx, name, word),
            Line::Mesh(mesh) => {
                let (solid, lines) = mesh::read(&mesh, cx)?;
                log = lines;
                (Shape::Mesh(solid), vec![], mesh.options)
            }
            Line::Union(all) => (Shape::Union(all.parts.0), vec![], resting(all.options)?),
            Line::Intersect(all) => (Shape::Intersect(all.parts.0), vec![], resting(all.options)?),
            Line::Block(block) => block.made(cx)?,
            Line::Cone(cone) => cone.made(cx)?,
            Line::Cylinder(cylinder) => cylinder.made(cx)?,
            Line::Ellipsoid(ellipsoid) => ellipsoid.made(cx)?,
            Line::Plane(plane) => plane.made(cx)?,
            Line::Prism(prism) => prism.made(cx)?,
            Line::Sphere(sphere) => sphere.made(cx)?,
        };
        if let Some(fault) = shape.fault() {
            return fail(Code::BAD_VALUE, span, format!("this is no {style}: {fault}"));
        }
        let faces = SHAPES.iter().find(|(s, _)| *s == style).map_or(0, |(_, faces)| *faces);
        let open = open(&options.open, faces)?;
        let (outside, motion) = (options.side == Side::Out, motion(options, cx)?);
        let mut region = Region { outside, open, given, motion, ..Region::inside(shape) };
        region.open_holds_all(cx.world.settings.lammps());
        Ok(naming(move |cx| {
            log.iter().for_each(|line| cx.print(line));
            cx.world.restored.remove(&format!("region/{name}"));
            cx.world.regions.insert(Key::new(&name), region);
            Ok(())
        }))
    }
}

fn delete(cx: &BuildCx, name: String, word: &Word) -> Result<Box<dyn Act>> {
    if cx.world.regions.find(&name).is_none() {
        return fail(Code::UNKNOWN_REGION, word.span, format!("there is no region `{name}`"));
    }
    // Walls look their region up at every run: it may be made anew until then.
    let wall = |user: &String| {
        let style = user.strip_prefix("fix ").and_then(|id| cx.names.fix_style(id));
        style == Some("wall/gran/region")
    };
    if !cx.names.users(&Use { kind: UseKind::Region, name: name.clone() }).iter().all(wall) {
        cx.unused(UseKind::Region, word)?;
    }
    if let Some(group) = cx.world.groups.follower(&name) {
        let text = format!("region `{name}` is still used by the dynamic group `{group}`");
        return fail(Code::CONFLICT, word.span, text);
    }
    Ok(setting(move |cx| {
        cx.world.regions.remove(Key::new(&name));
        Ok(())
    }))
}

/// The options of a union or intersection, which cannot move by itself.
fn resting(options: Options) -> Result<Options> {
    let moves = options.shift.as_ref().map(|s| s.span).or(options.turn.as_ref().map(|t| t.span));
    let Some(span) = moves else { return Ok(options) };
    let text = "a union or intersection cannot move by itself";
    let d = Diagnostic::error(Code::CONFLICT, span, text);
    Err(d.help("give `move` or `rotate` to the regions it is made of").into())
}

/// The faces that are open, a bit each.
fn open(named: &[At<i64>], faces: u8) -> Result<u8> {
    let mut open = 0;
    for At { value: k, span, .. } in named {
        open |= match u8::try_from(*k) {
            Ok(f) if f >= 1 && f <= faces => 1 << (f - 1),
            _ if faces == 0 => return fail(Code::BAD_VALUE, *span, "this shape has no faces to open"),
            _ => return fail(Code::BAD_VALUE, *span, format!("the shape has faces 1 to {faces}, not {k}")),
        };
    }
    Ok(open)
}

/// The motion that `move` and `rotate` say.
fn motion(options: Options, cx: &BuildCx) -> Result<Option<Motion>> {
    let Options { units, shift, turn, .. } = options;
    let mut motion: Option<Motion> = None;
    if let Some(shift) = shift {
        motion.get_or_insert_default().shift = shift.value.map(|n| n.0.map(|EqualVariable(v)| v));
    }
    if let Some(At { value: Rotation { angle: EqualVariable(variable), point, axis }, .. }) = turn {
        let (span, axis, spacing) = (axis[0].span, axis.map(|x| x.value), units.scales(cx.world));
        let given = length(axis);
        if given == 0.0 {
            return fail(Code::BAD_VALUE, span, "the axis of rotation has no direction");
        }
        let point = [0, 1, 2].map(|d| spacing[d] * point[d]);
        let turn = Turn { variable, point, axis: axis.map(|x| x / given), given, angle: 0.0.into() };
        motion.get_or_insert_default().turn = Some(turn);
    }
    Ok(motion)
}

/// How many regions one may be made of, and how deep they may be nested: each holds its parts.
const MOST_PARTS: usize = 10_000;

pub fn parts(a: &mut Args, cx: &BuildCx) -> Result<Vec<Region>> {
    let n = a.integer_from(2, "the number of regions")?;
    let (mut parts, mut count) = (vec![], 1);
    for _ in 0..n {
        let word = a.expect("a region")?;
        let part = cx.region(word)?;
        let (more, depth) = part.extent();
        count += more;
        if count > MOST_PARTS || depth >= Region::DEEPEST {
            let text = if depth >= Region::DEEPEST {
                format!("regions would be nested more than {} deep", Region::DEEPEST)
            } else {
                format!(
                    "this region would be made of more than {MOST_PARTS} others, those of its parts included"
                )
            };
            let d = Diagnostic::error(Code::TOO_LARGE, word.span, text);
            return Err(d.help("write one union or intersection of all its parts, each of them once").into());
        }
        parts.push(part.clone());
    }
    let bytes = (count * size_of::<Region>()) as f64;
    match memory::lacking(bytes, "this region") {
        Some(d) => Err(d.at(cx.span).into()),
        None => Ok(parts),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{more, refused, scene};
    use perigrain_world::World;

    #[test]
    fn distances_are_in_lattice_spacings_by_default() {
        let w = scene(
            "units si\nlattice custom 0.5 a2 0 2 0 a3 0 0 3 basis 0 0 0\nregion a sphere 1 1 1 2\n\
             region b sphere 1 1 1 2 units box\nregion c cylinder x 1 1 2 0 4",
        );
        assert!(w.regions["a"].contains([1.5, 1.0, 1.5]) && !w.regions["a"].contains([1.51, 1.0, 1.5]));
        assert!(w.regions["b"].contains([3.0, 1.0, 1.0]));
        // Centre y = 1·1.0, z = 1·1.5; radius 2·1.0 (spacing of y, as in LAMMPS); x from 0 to 2.
        assert_eq!(w.regions["c"].bounds(), Some(([0.0, -1.0, -0.5], [2.0, 3.0, 3.5])));
    }

    #[test]
    fn edges_follow_the_box() {
        let mut w = scene("units si\nregion b block 0 2 -1 1 0 3\ncreate_box 1 b");
        more(&mut w, "region e block EDGE 1 INF 0 1 EDGE\nregion o union 2 b e side out");
        assert_eq!(w.regions["e"].bounds(), Some(([0.0, -1e20, 1.0], [1.0, 0.0, 3.0])));
        assert!(!w.regions["o"].contains([0.5, -5.0, 2.0]) && w.regions["o"].contains([5.0, 5.0, 5.0]));
        more(&mut w, "region w cylinder z 0 0 1 0 2 open 3 side out\nregion e delete");
        assert_eq!(w.regions["w"].open, 4);
        assert!(w.regions.find("e").is_none());
    }

    #[test]
    fn blames_the_right_word() {
        let mut w = World::default();
        assert_eq!(
            refused(&w, "region a block 0 1 0 1 0").1,
            "`region` ends too early: the upper bound is missing"
        );
        assert_eq!(refused(&w, "region a block 0 1 EDGE 1 0 1").0, "EDGE");
        assert_eq!(refused(&w, "region a block 1 0 0 1 0 1").0, "1 0");
        assert_eq!(refused(&w, "region a sphere 0 0 0 v_r").0, "v_r");
        assert_eq!(refused(&w, "region a sphere 0 0 0 1 rotate v_a 0 0 0 0 0 1").0, "v_a");
        assert_eq!(refused(&w, "region a sphere 0 0 0 1 rotate 0.1 0 0 0 0 0 1").0, "0.1");
        assert_eq!(refused(&w, "region a grid c_x:grid:data gt 0.5").0, "grid");
        assert_eq!(refused(&w, "region a sphere 0 0 0 1 side inn").0, "inn");
        assert_eq!(refused(&w, "region a sphere 0 0 0 1 sidee in").0, "sidee");
        assert_eq!(refused(&w, "region a cone x 0 0 0 0 0 1").0, "cone");
        assert_eq!(refused(&w, "region a plane 0 0 0 0 0 0").0, "plane");
        assert_eq!(refused(&w, "region a prism 0 1 0 1 1 1 0 0 0").0, "prism");
        assert_eq!(refused(&w, "region a union 2 b c").0, "b");
        more(&mut w, "region a sphere 0 0 0 1");
        assert!(refused(&w, "region a sphere 0 0 0 1").1.contains("exists already"));
        assert_eq!(refused(&w, "region c block 0 1 0 1 0 1 open 7").0, "7");
        more(&mut w, "region b sphere 0 0 0 1");
        assert_eq!(refused(&w, "region c union 2 a b move NULL NULL NULL").0, "move");
    }
}
