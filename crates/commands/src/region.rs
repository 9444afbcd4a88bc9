//! `region`: a named volume.

mod mesh;
mod shapes;

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::vec3::length;
use perigrain_lang::{Args, Param, Word};
use perigrain_styles::common::{self, free_id, scales, setting, units_lattice, unknown_style};
use perigrain_styles::triangles::Placing;
use perigrain_styles::{BuildCx, Doc, Style, Use, UseKind};
use perigrain_world::region::{Motion, Shape, Turn, Variable};
use perigrain_world::{Key, Region, memory};
use shapes::Reader;

/// The command.
pub struct RegionCommand;

/// Styles LAMMPS has besides.
const ELSEWHERE: [&str; 2] = ["grid", "tri"];

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
            syntax: "region ID block XLO XHI YLO YHI ZLO ZHI | cone x|y|z C1 C2 RLO RHI LO HI | \
                     cylinder x|y|z C1 C2 R LO HI | ellipsoid X Y Z A B C | mesh FILE [scale S] [shift X Y Z] | plane PX PY PZ NX NY NZ | \
                     prism XLO XHI YLO YHI ZLO ZHI XY XZ YZ | sphere X Y Z R | union N ID ID … | \
                     intersect N ID ID … | delete  [side in|out] [units lattice|box] [open FACE] … \
                     [move v_X|NULL v_Y|NULL v_Z|NULL] [rotate v_THETA PX PY PZ RX RY RZ]",
            summary: "Names a volume of space.",
            text: "Surfaces belong to the inside. `INF` is far away, `EDGE` the face of the box as it is now. Distances are \
                   in lattice spacings unless `units box` is given; a radius takes the spacing of x (of y for a cylinder or \
                   cone along x). `side out` is everything else; the inside of a plane is the side of its normal. A prism \
                   has the edges (XHI−XLO, 0, 0), (XY, YHI−YLO, 0) and (XZ, YZ, ZHI−ZLO).\n\n\
                   Every number of a shape but the ends of a cylinder may be an equal-style variable `v_name`. `move` \
                   shifts the region by variables and `rotate` turns it by a variable's angle in radians about an axis \
                   through P along R, first turned, then shifted. Such a region is where its variables say at each \
                   moment it is used: by a command, a formula, and in every step of a run by fixes, groups and dumps. \
                   The displacement is in box units.\n\n\
                   `mesh` is the body within a surface of triangles from a file: STL (text or binary), OBJ (its name ends so), \
                   PLY (text or binary) or VTP (VTK's XML of surfaces; text, base64 or appended, zlib or plain). Polygons are cut \
                   into fans around their first corner and should be convex. The file's numbers are multiplied by `scale`, \
                   `shift`ed, and then in lattice spacings or box units as all distances are; `move` and `rotate` follow \
                   variables as for other shapes. The surface must be closed: each edge borders two triangles (corners are \
                   shared where their numbers are the same), and no two triangles cross or touch elsewhere; errors are reported with \
                   the number of edges and the place of the first one. Triangles in the wrong order of corners are turned, and the \
                   log says how many. A surface within another one is a hole. What is inside is exact for the \
                   numbers of the file, wherever edges and corners lie; binary STL has seven digits, so that sites meant to lie on a \
                   face may be on either side of it: shift the lattice by half a spacing (`origin`). `fix wall/mesh` and `peri_crack` read the \
                   same files, open or closed.\n\n\
                   `union` and `intersect` combine regions as they are declared now, their motions included, at most 10,000 of them in all and nested at \
                   most 100 deep; they cannot \
                   move by themselves. `open` names faces that walls made of the region leave open: for a block or prism 1 \
                   to 6 (xlo xhi ylo yhi zlo zhi), for a cylinder or cone 1 (lower end) 2 (upper end) 3 (mantle). Every use that queries \
                   which particles are in a region takes it as if it were closed, as LAMMPS' manual says; LAMMPS 22Jul2025 takes \
                   all particles there are, and so does `compat lammps`.",
            example: "variable lift equal 0.001*step\n\
                      region disc cylinder z 0.0 0.0 0.037 EDGE EDGE units box move NULL NULL v_lift\n\
                      region gear mesh gear.obj scale 0.001 shift 0.0 0.0 0.002 units box",
        }
    }
}

/// The keywords after the shape.
struct Options {
    outside: bool,
    lattice: bool,
    open: u8,
    motion: Option<Motion>,
    placing: Placing,
}

impl CommandStyle for RegionCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let word = a.expect("the region's ID")?;
        let name = free_id(word, "the region's ID")?;
        let style = a.expect("a shape")?;
        if style.text == "delete" {
            return delete(cx, name, word);
        }
        if cx.world.regions.find(&name).is_some()
            && !cx.world.parts.restored.contains(&format!("region/{name}"))
        {
            let text = format!("region `{name}` exists already");
            return fail(Code::DUPLICATE_NAME, word.span, text);
        }
        if ELSEWHERE.contains(&style.text.as_str()) {
            return Err(common::not_here(style, "region"));
        }
        let Some((_, faces)) = SHAPES.iter().find(|(s, _)| *s == style.text) else {
            return Err(unknown_style(style, "region style", &SHAPES.map(|(s, _)| s)));
        };
        let options = options(a.clone(), cx, *faces, style)?;
        let unit = scales(cx.world, options.lattice);
        let mut reader = Reader::new(a, cx, unit);
        let mut log = vec![];
        let shape = match style.text.as_str() {
            "union" => Shape::Union(parts(reader.a, cx)?),
            "intersect" => Shape::Intersect(parts(reader.a, cx)?),
            "mesh" => {
                let (solid, lines) = mesh::read(reader.a, cx, options.placing, unit)?;
                log = lines;
                Shape::Mesh(solid)
            }
            name => reader.shape(name)?,
        };
        let given = reader.given;
        no_more(a, keywords(style))?;
        a.rest();
        if let Some(fault) = shape.fault() {
            return fail(Code::BAD_VALUE, style.span, format!("this is no {}: {fault}", style.text));
        }
        let Options { outside, open, motion, .. } = options;
        let mut region = Region { outside, open, given, motion, ..Region::inside(shape) };
        region.open_holds_all(cx.world.settings.lammps());
        Ok(setting(move |cx| {
            log.iter().for_each(|line| cx.print(line));
            cx.world.parts.restored.remove(&format!("region/{name}"));
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

/// Reads the keywords, which stand behind the shape's own words; every word after the first keyword must fit.
fn options(mut a: Args, cx: &BuildCx, faces: u8, style: &Word) -> Result<Options> {
    let (combined, known) = (matches!(style.text.as_str(), "union" | "intersect"), keywords(style));
    let placing = Placing::default();
    let mut options = Options { outside: false, lattice: true, open: 0, motion: None, placing };
    while !a.is_empty() && !known.contains(&a.peek_text()) {
        a.next();
    }
    let lattice = units_of(a.clone())?;
    while let Some(word) = a.next() {
        match word.text.as_str() {
            "side" => options.outside = a.choice("side", &["in", "out"])? == "out",
            "units" => options.lattice = units_lattice(&mut a)?,
            "open" => options.open |= 1 << (face(&mut a, faces)? - 1),
            "move" | "rotate" if combined => {
                let text = "a union or intersection cannot move by itself";
                let d = Diagnostic::error(Code::CONFLICT, word.span, text);
                return Err(d.help("give `move` or `rotate` to the regions it is made of").into());
            }
            "move" => options.motion.get_or_insert_default().shift = shift(&mut a, cx)?,
            "rotate" => {
                let turn = turn(&mut a, cx, scales(cx.world, lattice))?;
                options.motion.get_or_insert_default().turn = Some(turn);
            }
            _ if known == MESH_KEYWORDS && options.placing.keyword(word, &mut a)? => {}
            _ => return Err(a.unknown(word, known)),
        }
    }
    Ok(options)
}

const KEYWORDS: [&str; 5] = ["side", "units", "open", "move", "rotate"];
const MESH_KEYWORDS: [&str; 7] =
    ["side", "units", "open", "move", "rotate", Placing::KEYWORDS[0], Placing::KEYWORDS[1]];

fn keywords(style: &Word) -> &'static [&'static str] {
    if style.text == "mesh" { &MESH_KEYWORDS } else { &KEYWORDS }
}

/// The value of a later `units`: it counts for a `rotate` before it too.
fn units_of(mut a: Args) -> Result<bool> {
    while let Some(word) = a.next() {
        if word.text == "units" {
            return units_lattice(&mut a);
        }
    }
    Ok(true)
}

fn face(a: &mut Args, faces: u8) -> Result<u8> {
    let span = a.here();
    let k = a.integer("the face")?;
    match u8::try_from(k) {
        Ok(f) if f >= 1 && f <= faces => Ok(f),
        _ if faces == 0 => fail(Code::BAD_VALUE, span, "this shape has no faces to open"),
        _ => fail(Code::BAD_VALUE, span, format!("the shape has faces 1 to {faces}, not {k}")),
    }
}

fn shift(a: &mut Args, cx: &BuildCx) -> Result<[Option<Variable>; 3]> {
    let mut next = || {
        if a.eat("NULL") { Ok(None) } else { equal_variable(a, cx, "the displacement").map(Some) }
    };
    Ok([next()?, next()?, next()?])
}

fn turn(a: &mut Args, cx: &BuildCx, spacing: [f64; 3]) -> Result<Turn> {
    let variable = equal_variable(a, cx, "the angle")?;
    let mut point = [0.0; 3];
    for (x, s) in point.iter_mut().zip(spacing) {
        *x = s * a.number("a point of the axis")?;
    }
    let span = a.here();
    let along = [a.number("the axis")?, a.number("the axis")?, a.number("the axis")?];
    if length(along) == 0.0 {
        return fail(Code::BAD_VALUE, span, "the axis of rotation has no direction");
    }
    let given = length(along);
    Ok(Turn { variable, point, axis: along.map(|x| x / given), given, angle: 0.0.into() })
}

/// Takes `v_name` of an equal-style variable.
fn equal_variable(a: &mut Args, cx: &BuildCx, what: &str) -> Result<Variable> {
    let span = a.here();
    match common::variable_param(a, what)? {
        Param::Ref(r) => {
            cx.value(&r, false)?;
            Ok(Variable { name: r.name, span: r.span })
        }
        Param::Number(x) => {
            let text = format!("{what} must be an equal-style variable `v_name`, not the number {x}");
            fail(Code::WRONG_KIND, span, text)
        }
    }
}

/// How many regions one may be made of, and how deep they may be nested: each holds its parts.
const MOST_PARTS: usize = 10_000;

fn parts(a: &mut Args, cx: &BuildCx) -> Result<Vec<Region>> {
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

/// The shape's words must end here: a keyword or the end of the line.
fn no_more(a: &mut Args, known: &'static [&'static str]) -> Result<()> {
    match a.peek() {
        Some(w) if !known.contains(&w.text.as_str()) => Err(a.unknown(w, known)),
        _ => Ok(()),
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
