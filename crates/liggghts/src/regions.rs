//! Regions that LIGGGHTS alone has: bodies of tetrahedra, wedges of a cylinder.

use crate::Translator;
use crate::native::{Line, instead};
use crate::reading::{choice, inside, number, unknown, value, vector};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Command, Word};

/// Keywords behind every region.
const OPTIONS: &[(&str, usize)] = &[("side", 1), ("units", 1), ("move", 3), ("rotate", 7)];
const TETRA: &[&str] = &["file", "scale", "move", "rotate", "side", "units"];
const WEDGE: &[&str] =
    &["axis", "center", "radius", "bounds", "angle0", "angle", "side", "units", "move", "rotate"];

impl Translator {
    /// `region ID mesh/tet file F scale s move x y z rotate a b c …`: shifted, then scaled, then turned about x, y and z (LIGGGHTS manual,
    /// region).
    pub(crate) fn tetrahedra(&mut self, cmd: &Command, args: &mut Args) -> Result<Vec<Command>> {
        let at = cmd.args[1].span;
        let (mut file, mut scale) = (None, Word::new("1", at));
        let (mut shift, mut angles) = (vec![], vec![]);
        let mut rest: Vec<Word> = vec![];
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "file" => file = Some(args.expect("a file name")?.clone()),
                "scale" => scale = number(args, "the factor")?,
                "move" => shift = vector(args, "a component of the shift")?,
                "rotate" => angles = vector(args, "an angle")?,
                "side" | "units" => {
                    rest.push(word.clone());
                    rest.push(args.expect("a word")?.clone());
                }
                _ => return Err(unknown(word, "keyword of region mesh/tet", TETRA).into()),
            }
        }
        let Some(file) = file else { return lacks(cmd, "file FILE") };
        let mut line = Line::new(cmd, "region");
        line.word(&cmd.args[0]).put("mesh", at).word(&file).put("scale", at).word(&scale);
        if shift.iter().any(|x| value(x) != Some(0.0)) {
            let scaled: Vec<Word> = shift.iter().map(|x| product(x, &scale)).collect();
            line.put("shift", at).words(&scaled);
        }
        for (angle, axis) in angles.iter().zip(["1 0 0", "0 1 0", "0 0 1"]) {
            if value(angle) != Some(0.0) {
                line.put("turn", at).put(axis, at).word(angle);
            }
        }
        line.words(&rest);
        Ok(vec![line.done()])
    }
}

/// The numbers of a wedge.
#[derive(Default)]
struct Wedge {
    axis: Option<usize>,
    centre: Vec<Word>,
    radius: Option<Word>,
    bounds: Vec<Word>,
    /// Where it begins and how wide it is [degrees].
    angles: [Option<Word>; 2],
    side: Vec<Word>,
    /// Units and motion, which the parts have.
    rest: Vec<Word>,
}

/// `region ID wedge axis d center c1 c2 radius r bounds lo hi angle0 a angle b …`: a cylinder and one or two half-spaces. Coordinates and
/// angles run from y to z, z to x or x to y (LIGGGHTS manual, region).
pub(crate) fn wedge(cmd: &Command, args: &mut Args) -> Result<Vec<Command>> {
    let mut given = Wedge::default();
    while let Some(word) = args.next() {
        match word.text.as_str() {
            "axis" => {
                let axis = choice(args, "axis", &["x", "y", "z"])?;
                given.axis = ["x", "y", "z"].iter().position(|name| *name == axis);
            }
            "center" => given.centre = vec![number(args, "the centre")?, number(args, "the centre")?],
            "radius" => given.radius = Some(number(args, "the radius")?),
            "bounds" => given.bounds = vec![args.expect("a bound")?.clone(), args.expect("a bound")?.clone()],
            "angle0" => given.angles[0] = Some(number(args, "the first angle")?),
            "angle" => given.angles[1] = Some(number(args, "the angle of the wedge")?),
            name => {
                let Some((_, count)) = OPTIONS.iter().find(|(option, _)| *option == name) else {
                    return Err(unknown(word, "keyword of region wedge", WEDGE).into());
                };
                let list = if name == "side" { &mut given.side } else { &mut given.rest };
                list.push(word.clone());
                for _ in 0..*count {
                    list.push(args.expect("a value")?.clone());
                }
            }
        }
    }
    parts(cmd, &given)
}

/// The lines of a wedge.
fn parts(cmd: &Command, given: &Wedge) -> Result<Vec<Command>> {
    let Some(axis) = given.axis else { return lacks(cmd, "axis x|y|z") };
    let [c1, c2] = given.centre.as_slice() else { return lacks(cmd, "center c1 c2") };
    let Some(radius) = &given.radius else { return lacks(cmd, "radius r") };
    let [lo, hi] = given.bounds.as_slice() else { return lacks(cmd, "bounds lo hi") };
    let [Some(first), Some(width)] = &given.angles else { return lacks(cmd, "angle0 a angle b") };
    let (at, id) = (cmd.args[1].span, &cmd.args[0]);
    let wide = match value(width) {
        Some(w) if !(w > 0.0 && w <= 360.0) => {
            let text = format!("the angle of a wedge is above 0 and at most 360 degrees, not {w}");
            return Err(Diagnostic::error(Code::BAD_VALUE, width.span, text).into());
        }
        Some(w) => w,
        // One that a variable gives: as most wedges are.
        None => 90.0,
    };
    let whole = wide == 360.0;
    let part = |name: &str| if whole { id.clone() } else { instead(id, format!("{}_{name}", id.text)) };
    let region = |name: &Word| {
        let mut line = Line::new(cmd, "region");
        line.word(name);
        line
    };
    let mut body = region(&part("cylinder"));
    // Native cylinders along y have their centre at x z.
    let centre = if axis == 1 { [c2, c1] } else { [c1, c2] };
    body.put(["cylinder x", "cylinder y", "cylinder z"][axis], at);
    body.word(centre[0]).word(centre[1]).word(radius).word(lo).word(hi).words(&given.rest);
    if whole {
        body.words(&given.side);
        return Ok(vec![body.done()]);
    }
    // The directions from which and towards which angles are counted.
    let [from, to] = [(axis + 1) % 3, (axis + 2) % 3];
    let half = |name: &Word, angle: [Word; 2]| {
        let mut line = region(name);
        line.put("plane", at);
        let zero = Word::new("0", at);
        let mut point = [zero.clone(), zero.clone(), zero.clone()];
        (point[from], point[to]) = (c1.clone(), c2.clone());
        let mut normal = [zero.clone(), zero.clone(), zero];
        let [along, across] = angle;
        (normal[from], normal[to]) = (along, across);
        line.words(&point).words(&normal).words(&given.rest);
        line.done()
    };
    let (begins, ends) = (part("begin"), part("end"));
    let last = sum(first, width);
    let mut lines = vec![body.done()];
    lines.push(half(&begins, [trigonometric("-sin", first), trigonometric("cos", first)]));
    lines.push(half(&ends, [trigonometric("sin", &last), trigonometric("-cos", &last)]));
    let mut sides = vec![begins, ends];
    if wide > 180.0 {
        let both = part("sides");
        let mut line = region(&both);
        line.put("union 2", at).words(&sides);
        lines.push(line.done());
        sides = vec![both];
    }
    let mut line = region(id);
    line.put(&format!("intersect {}", sides.len() + 1), at).word(&part("cylinder")).words(&sides);
    line.words(&given.side);
    lines.push(line.done());
    Ok(lines)
}

/// The product of two numbers.
fn product(a: &Word, b: &Word) -> Word {
    match (value(a), value(b)) {
        (Some(x), Some(1.0)) => instead(a, format!("{x}")),
        (Some(x), Some(y)) => instead(a, format!("{}", x * y)),
        _ => instead(a, format!("$({}*{})", inside(a), inside(b))),
    }
}

/// The sum of two numbers.
fn sum(a: &Word, b: &Word) -> Word {
    match (value(a), value(b)) {
        (Some(x), Some(y)) => instead(a, format!("{}", x + y)),
        _ => instead(a, format!("$({}+{})", inside(a), inside(b))),
    }
}

/// A sine or cosine of an angle in degrees, with its sign.
fn trigonometric(name: &str, angle: &Word) -> Word {
    let Some(x) = value(angle) else {
        return instead(angle, format!("$({name}({}*PI/180))", inside(angle)));
    };
    let x = x.to_radians();
    let y = match name {
        "sin" => x.sin(),
        "-sin" => -x.sin(),
        "cos" => x.cos(),
        _ => -x.cos(),
    };
    // Without the sign of a zero.
    instead(angle, format!("{}", y + 0.0))
}

/// The error for a line that lacks something.
fn lacks<T>(cmd: &Command, what: &str) -> Result<T> {
    let text = format!("region `{}` lacks `{what}`", cmd.args[1].text);
    Err(Diagnostic::error(Code::MISSING_ARGUMENT, cmd.args[1].span, text).into())
}
