//! Flat walls parallel to the faces of the box, for fix wall/reflect and wall/harmonic.

use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Param, Word};
use perigrain_plan::{Stage, When};
use perigrain_styles::common::{orthogonal, variable_param};
use perigrain_styles::{BuildCx, Reading, SealCx};
use perigrain_world::World;

/// The words for faces, two per direction, the lower one first.
pub const FACES: [&str; 6] = ["xlo", "xhi", "ylo", "yhi", "zlo", "zhi"];

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
    /// Parses the position of the face named by `word`; `None` if it names none.
    ///
    /// # Errors
    /// A repeated face, and mistakes in the position.
    pub fn read(word: &Word, before: &[Face], args: &mut Args, cx: &BuildCx) -> Result<Option<Self>> {
        let Some(k) = FACES.iter().position(|f| *f == word.text) else { return Ok(None) };
        let (axis, high) = (k / 2, k % 2 == 1);
        if before.iter().any(|f| (f.axis, f.high) == (axis, high)) {
            let text = format!("the wall `{}` is there already; use a second fix", word.text);
            return fail(Code::CONFLICT, word.span, text);
        }
        let edge = args.eat("EDGE");
        let place = match edge {
            true => Param::Number(edge_of(cx.world, axis, high)),
            false => variable_param(args, "the wall's place")?,
        };
        cx.param(&place, false)?;
        Ok(Some(Self { axis, high, place, edge }))
    }

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

/// The current face of the box.
fn edge_of(w: &World, axis: usize, high: bool) -> f64 {
    w.domain.as_ref().map_or(0.0, |d| if high { d.hi[axis] } else { d.lo[axis] })
}

/// Checks that there is a wall and, unless `through`, that none stands across a periodic direction.
///
/// # Errors
/// No wall, or a wall across a periodic direction.
pub fn check(faces: &[Face], through: bool, args: &Args, cx: &BuildCx) -> Result<()> {
    if faces.is_empty() {
        let text = "there is no wall: name at least one of xlo xhi ylo yhi zlo zhi";
        return fail(Code::MISSING_ARGUMENT, args.here(), text);
    }
    let Some(domain) = &*cx.world.domain else { return Ok(()) };
    let round = faces.iter().find(|f| domain.periodic()[f.axis]).filter(|_| !through);
    let Some(face) = round else { return Ok(()) };
    let axis = ["x", "y", "z"][face.axis];
    let text = format!("the wall `{}` stands in a direction that repeats: {axis} is periodic", face.name());
    Err(Diagnostic::error(Code::CONFLICT, cx.span, text)
        .help(format!("give {axis} faces that do not repeat (`boundary … f …`)"))
        .into())
}
