//! Flat walls parallel to the faces of the box, for fix wall/reflect and wall/harmonic.

use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Param, Word};
use perigrain_plan::{Stage, When};
use perigrain_styles::common::orthogonal;
use perigrain_styles::words::{Grammar, Keyword, Kind, Part, Placeholder, Value, Words};
use perigrain_styles::{BuildCx, Reading, SealCx};
use perigrain_world::World;

/// The words for faces, two per direction, the lower one first.
const FACES: [&str; 6] = ["xlo", "xhi", "ylo", "yhi", "zlo", "zhi"];

/// One wall: its axis, its side and its position.
#[derive(Clone)]
pub struct Face {
    /// Its axis: 0, 1 or 2.
    pub axis: usize,
    /// Whether the particles are below it.
    pub high: bool,
    /// Its coordinate, times `units` unless it is the face of the box.
    place: Param,
    /// Whether it stands at the face of the box at the time of declaration.
    edge: bool,
}

/// Source of a wall's position during a run.
#[derive(Clone, Copy)]
pub struct Spot {
    place: Reading,
    scale: f64,
}

impl Spot {
    /// The current coordinate.
    pub fn get(self, w: &World) -> f64 {
        self.scale * self.place.get(w)
    }
}

impl Face {
    /// Its word.
    pub fn name(&self) -> &'static str {
        FACES[2 * self.axis + usize::from(self.high)]
    }

    /// Distance of a coordinate from a wall at `at`, positive on the inside.
    #[inline]
    pub fn depth(&self, x: [f64; 3], at: f64) -> f64 {
        if self.high { at - x[self.axis] } else { x[self.axis] - at }
    }

    /// The source of the position during a run, at `stage`; `scales` apply to numbers and variables.
    ///
    /// # Errors
    /// A variable that is gone.
    pub fn seal(&self, cx: &mut dyn SealCx, stage: Stage, scales: [f64; 3]) -> Result<Spot> {
        let [xy, xz, yz] = cx.world().edges().tilt;
        if self.edge && [xy != 0.0 || xz != 0.0, yz != 0.0, false][self.axis] {
            return Err(orthogonal("a wall at EDGE, which here leans,").at(cx.span()));
        }
        let scale = if self.edge { 1.0 } else { scales[self.axis] };
        cx.param(&self.place, stage, &When::Always).map(|place| Spot { place, scale })
    }
}

/// Walls in the order in which they are named, each with what stands behind its place.
pub struct Walls<T>(pub Vec<(Face, T)>);

/// The place of a wall.
const PLACE: Part = Part::Word(Placeholder {
    name: "place",
    kind: Kind::Param,
    about: "The place of a wall: `EDGE` (the face of the box when the fix is declared: it does not move with the box), a number, \
            or `v_name` of an equal-style variable, evaluated each step.",
    unit: "length",
});

/// A keyword that names a wall by the face on whose side it stands.
const fn wall(word: &'static str, values: &'static [Part]) -> Keyword {
    let about = "A wall at this place: `lo` has the particles above it, `hi` below.";
    Keyword { word, values, about, default: "", repeats: false }
}

impl<T: Words> Walls<T> {
    const VALUES: &'static [Part] = &[PLACE, Part::All(T::GRAMMAR)];
}

impl<T: Words> Words for Walls<T> {
    const GRAMMAR: &'static Grammar = &Grammar {
        parts: &[],
        keywords: &[
            wall("xlo", Self::VALUES),
            wall("xhi", Self::VALUES),
            wall("ylo", Self::VALUES),
            wall("yhi", Self::VALUES),
            wall("zlo", Self::VALUES),
            wall("zhi", Self::VALUES),
        ],
        refused: &[],
    };

    fn begin(_: &mut Args, _: &BuildCx) -> Result<Self> {
        Ok(Self(vec![]))
    }

    fn keyword(&mut self, word: &Word, args: &mut Args, cx: &BuildCx) -> Result<bool> {
        let Some(k) = FACES.iter().position(|f| *f == word.text) else { return Ok(false) };
        let (axis, high) = (k / 2, k % 2 == 1);
        if self.0.iter().any(|(f, _)| (f.axis, f.high) == (axis, high)) {
            let text = format!("the wall `{}` is there already; use a second fix", word.text);
            return fail(Code::CONFLICT, word.span, text);
        }
        let edge = args.eat("EDGE");
        let place = match edge {
            true => Param::Number(edge_of(cx.world, axis, high)),
            false => Param::value("the wall's place", args, cx)?,
        };
        self.0.push((Face { axis, high, place, edge }, T::begin(args, cx)?));
        Ok(true)
    }
}

/// The current face of the box.
fn edge_of(w: &World, axis: usize, high: bool) -> f64 {
    w.domain.as_ref().map_or(0.0, |d| if high { d.hi[axis] } else { d.lo[axis] })
}

/// Checks that there is a wall and, unless `through`, that none stands across a periodic direction.
///
/// # Errors
/// No wall, or a wall across a periodic direction.
pub fn check<T>(walls: &[(Face, T)], through: bool, args: &Args, cx: &BuildCx) -> Result<()> {
    if walls.is_empty() {
        let text = "there is no wall: name at least one of xlo xhi ylo yhi zlo zhi";
        return fail(Code::MISSING_ARGUMENT, args.here(), text);
    }
    let Some(domain) = &*cx.world.domain else { return Ok(()) };
    let round = walls.iter().map(|(face, _)| face).find(|f| domain.periodic()[f.axis]).filter(|_| !through);
    let Some(face) = round else { return Ok(()) };
    let axis = ["x", "y", "z"][face.axis];
    let text = format!("the wall `{}` stands in a direction that repeats: {axis} is periodic", face.name());
    Err(Diagnostic::error(Code::CONFLICT, cx.span, text)
        .help(format!("give {axis} faces that do not repeat (`boundary … f …`)"))
        .into())
}
