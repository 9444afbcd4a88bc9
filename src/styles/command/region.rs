//! `region`: a named volume.

use super::common::{self, constant, id, not_here, scales, setting, units_lattice, unknown_style};
use super::{Act, CommandStyle};
use crate::diag::{Code, Result, fail};
use crate::lang::{Args, Word};
use crate::styles::{BuildCx, Doc, Style, UseKind};
use crate::world::Region;
use crate::world::region::{INFINITE, Shape, across};

/// The command.
pub struct RegionCommand;

/// Shapes LAMMPS has besides.
const ELSEWHERE: [&str; 6] = ["cone", "ellipsoid", "plane", "prism", "mesh", "tri"];

impl Style for RegionCommand {
    fn name(&self) -> &'static str {
        "region"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "region ID block XLO XHI YLO YHI ZLO ZHI | cylinder x|y|z C1 C2 R LO HI | sphere X Y Z R | \
                     union N ID ID … | intersect N ID ID … | delete  [side in|out] [units lattice|box] [open FACE] …",
            summary: "Names a volume of space.",
            text: "Surfaces belong to the inside. `INF` is far away, `EDGE` the face of the box. Distances are in lattice \
                   spacings unless `units box` is said; a radius takes the spacing of x (of y for a cylinder along x). \
                   `side out` is everything else. `union` and `intersect` combine regions as they are now. `open` names \
                   faces that walls made of the region leave open: for a block 1 to 6 (xlo xhi ylo yhi zlo zhi), for a \
                   cylinder 1 (lower end) 2 (upper end) 3 (mantle). Moving and rotating regions, and variables as \
                   parameters, are refused.",
            example: "region disc cylinder z 0.0 0.0 0.037 EDGE EDGE units box",
        }
    }
}

/// What the keywords after the shape say.
struct Options {
    outside: bool,
    lattice: bool,
    open: u8,
}

impl CommandStyle for RegionCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let word = a.expect("the region's ID")?;
        let name = id(word, "the region's ID")?;
        let style = a.expect("a shape")?;
        if style.text == "delete" {
            return delete(cx, name, word);
        }
        if cx.world.regions.contains_key(&name) {
            let text = format!("region `{name}` exists already");
            return fail(Code::DUPLICATE_NAME, word.span, text);
        }
        if ELSEWHERE.contains(&style.text.as_str()) {
            return Err(not_here(style, "region"));
        }
        let options = options(a.clone(), faces_of(&style.text))?;
        let scale = scales(cx.world, options.lattice);
        let shape = match style.text.as_str() {
            "block" => block(a, cx, scale)?,
            "cylinder" => cylinder(a, cx, scale)?,
            "sphere" => sphere(a, scale)?,
            "union" => Shape::Union(parts(a, cx)?),
            "intersect" => Shape::Intersect(parts(a, cx)?),
            _ => {
                return Err(unknown_style(
                    style,
                    "region style",
                    &["block", "cylinder", "sphere", "union", "intersect"],
                ));
            }
        };
        a.rest();
        let region = Region { shape, outside: options.outside, open: options.open };
        Ok(setting(move |cx| {
            cx.world.regions.insert(name, region);
            Ok(())
        }))
    }
}

fn delete(cx: &BuildCx, name: String, word: &Word) -> Result<Box<dyn Act>> {
    if !cx.world.regions.contains_key(&name) {
        return fail(Code::UNKNOWN_NAME, word.span, format!("there is no region `{name}`"));
    }
    cx.unused(UseKind::Region, word)?;
    Ok(setting(move |cx| {
        cx.world.regions.remove(&name);
        Ok(())
    }))
}

fn faces_of(style: &str) -> u8 {
    match style {
        "block" => 6,
        "cylinder" => 3,
        _ => 0,
    }
}

/// Reads the keywords, which stand behind the shape's own words; every word after the first keyword must fit.
fn options(mut a: Args, faces: u8) -> Result<Options> {
    let mut options = Options { outside: false, lattice: true, open: 0 };
    while !a.is_empty() && !KEYWORDS.contains(&a.peek_text()) {
        a.next();
    }
    while let Some(word) = a.next() {
        match word.text.as_str() {
            "side" => options.outside = a.choice("side", &["in", "out"])? == "out",
            "units" => options.lattice = units_lattice(&mut a)?,
            "open" => options.open |= 1 << (face(&mut a, faces)? - 1),
            "move" | "rotate" => return Err(not_here(word, "keyword of region")),
            _ => return Err(a.unknown(word, &KEYWORDS)),
        }
    }
    Ok(options)
}

const KEYWORDS: [&str; 5] = ["side", "units", "open", "move", "rotate"];

fn face(a: &mut Args, faces: u8) -> Result<u8> {
    let span = a.here();
    let k = a.integer("the face")?;
    match u8::try_from(k) {
        Ok(f) if f >= 1 && f <= faces => Ok(f),
        _ if faces == 0 => fail(Code::BAD_VALUE, span, "this shape has no faces to open"),
        _ => fail(Code::BAD_VALUE, span, format!("the shape has faces 1 to {faces}, not {k}")),
    }
}

/// A bound along axis `d`: a number, `INF` or `EDGE`.
fn bound(a: &mut Args, cx: &BuildCx, d: usize, upper: bool, scale: f64) -> Result<f64> {
    let what = if upper { "the upper bound" } else { "the lower bound" };
    match a.peek() {
        Some(word) if word.text == "INF" || word.text == "EDGE" => {
            let Some(domain) = &cx.world.domain else {
                let text = format!("`{}` means nothing before the simulation box is defined", word.text);
                return fail(Code::WRONG_ORDER, word.span, text);
            };
            a.next();
            Ok(match (word.text == "INF", upper) {
                (true, true) => INFINITE,
                (true, false) => -INFINITE,
                (false, true) => domain.hi[d],
                (false, false) => domain.lo[d],
            })
        }
        _ => Ok(scale * constant(a, what)?),
    }
}

fn range(a: &mut Args, cx: &BuildCx, d: usize, scale: f64) -> Result<(f64, f64)> {
    let span = a.here();
    let lo = bound(a, cx, d, false, scale)?;
    let span = span.to(a.here());
    let hi = bound(a, cx, d, true, scale)?;
    if lo > hi {
        return fail(Code::BAD_VALUE, span, format!("the lower bound {lo} lies above the upper bound {hi}"));
    }
    Ok((lo, hi))
}

fn block(a: &mut Args, cx: &BuildCx, scale: [f64; 3]) -> Result<Shape> {
    let (mut lo, mut hi) = ([0.0; 3], [0.0; 3]);
    for d in 0..3 {
        (lo[d], hi[d]) = range(a, cx, d, scale[d])?;
    }
    no_more(a)?;
    Ok(Shape::Block { lo, hi })
}

fn cylinder(a: &mut Args, cx: &BuildCx, scale: [f64; 3]) -> Result<Shape> {
    let axis = common::axis(a, "axis of the cylinder")?;
    let [c, d] = across(axis);
    let center = [scale[c] * constant(a, "the axis")?, scale[d] * constant(a, "the axis")?];
    let radius = scale[if axis == 0 { 1 } else { 0 }] * radius(a)?;
    let (lo, hi) = range(a, cx, axis, scale[axis])?;
    no_more(a)?;
    Ok(Shape::Cylinder { axis, center, radius, lo, hi })
}

fn sphere(a: &mut Args, scale: [f64; 3]) -> Result<Shape> {
    let mut center = [0.0; 3];
    for (c, s) in center.iter_mut().zip(scale) {
        *c = s * constant(a, "the centre")?;
    }
    let radius = scale[0] * radius(a)?;
    no_more(a)?;
    Ok(Shape::Sphere { center, radius })
}

fn radius(a: &mut Args) -> Result<f64> {
    match a.peek() {
        Some(w) if w.text.starts_with("v_") => Err(not_here(w, "a variable as radius:")),
        _ => a.non_negative("the radius"),
    }
}

fn parts(a: &mut Args, cx: &BuildCx) -> Result<Vec<Region>> {
    let n = a.integer_from(2, "the number of regions")?;
    let mut parts = vec![];
    for _ in 0..n {
        let word = a.expect("a region")?;
        parts.push(cx.region(word)?.clone());
    }
    no_more(a)?;
    Ok(parts)
}

/// The shape's words must end here: a keyword or the end of the line.
fn no_more(a: &mut Args) -> Result<()> {
    match a.peek() {
        Some(w) if !KEYWORDS.contains(&w.text.as_str()) => Err(a.unknown(w, &KEYWORDS)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{more, refused, scene};
    use crate::world::World;

    #[test]
    fn distances_are_in_lattice_spacings_unless_said() {
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
        assert!(!w.regions.contains_key("e"));
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
        assert_eq!(refused(&w, "region a sphere 0 0 0 1 rotate v_a 0 0 0 0 0 1").0, "rotate");
        assert_eq!(refused(&w, "region a sphere 0 0 0 1 side inn").0, "inn");
        assert_eq!(refused(&w, "region a sphere 0 0 0 1 sidee in").0, "sidee");
        assert_eq!(refused(&w, "region a cone x 0 0 1 1 0 1").0, "cone");
        assert_eq!(refused(&w, "region a union 2 b c").0, "b");
        more(&mut w, "region a sphere 0 0 0 1");
        assert!(refused(&w, "region a sphere 0 0 0 1").1.contains("exists already"));
        assert_eq!(refused(&w, "region c block 0 1 0 1 0 1 open 7").0, "7");
    }
}
