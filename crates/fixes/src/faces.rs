//! Flat walls along the faces of the box, as the fixes wall/reflect and wall/harmonic take them.

use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Param, Word};
use perigrain_plan::{Stage, When};
use perigrain_styles::common::{orthogonal, variable_param};
use perigrain_styles::{BuildCx, Reading, SealCx};
use perigrain_world::World;

/// The words for faces, two for each direction: the lower one first.
pub const FACES: [&str; 6] = ["xlo", "xhi", "ylo", "yhi", "zlo", "zhi"];

/// One wall: on which side of whom it stands, and where.
#[derive(Clone)]
pub struct Face {
    /// Along which direction: 0, 1, 2.
    pub axis: usize,
    /// Whether particles are below it.
    pub high: bool,
    /// Its coordinate, times `units` unless it is the face of the box.
    place: Param,
    /// Whether it is where the face of the box was when it was declared.
    edge: bool,
}

/// Where a wall is read from during a run.
#[derive(Clone, Copy)]
pub struct Spot {
    place: Reading,
    scale: f64,
}

impl Spot {
    /// Its coordinate now.
    pub fn get(self, w: &World) -> f64 {
        self.scale * self.place.get(w)
    }
}

impl Face {
    /// Takes where the face named by `word` is; `None` if it names none.
    ///
    /// # Errors
    /// A face that is there already, and mistakes in the place.
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

    /// The word for it.
    pub fn name(&self) -> &'static str {
        FACES[2 * self.axis + usize::from(self.high)]
    }

    /// How deep inside of the box a coordinate is, seen from a wall at `at`.
    #[inline]
    pub fn depth(&self, x: [f64; 3], at: f64) -> f64 {
        if self.high { at - x[self.axis] } else { x[self.axis] - at }
    }

    /// Where it is read from during a run, at `stage`; `scales`: of numbers and variables.
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

/// The face of the box as it is now.
fn edge_of(w: &World, axis: usize, high: bool) -> f64 {
    w.domain.as_ref().map_or(0.0, |d| if high { d.hi[axis] } else { d.lo[axis] })
}

/// Checks that there are walls at all and, unless `through`, that none stands in a direction that repeats.
///
/// # Errors
/// No wall, or one that would be passed through.
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
