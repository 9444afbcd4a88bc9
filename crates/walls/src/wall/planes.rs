//! Planes of fix wall/gran: their positions, fixed or given by variables.

use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::Param;
use perigrain_plan::{Stage, Tick, When};
use perigrain_styles::words::{At, Nullable};
use perigrain_styles::{Reading, SealCx};
use perigrain_world::region::{Region, Shape};
use perigrain_world::{Numbers, Outline, World};

/// A lower and an upper plane normal to one axis, as declared.
#[derive(Clone)]
pub struct Pair {
    /// Normal axis.
    pub axis: usize,
    /// Positions; `None` (NULL) for a missing plane.
    places: [Option<Param>; 2],
    span: Span,
}

/// Their names in messages.
const NAMES: [&str; 2] = ["lower", "upper"];

impl Pair {
    /// Planes at two places, of which one may be missing.
    ///
    /// # Errors
    /// No place, and planes in the wrong order.
    pub fn new(axis: usize, At { value: places, span, .. }: At<[Nullable<Param>; 2]>) -> Result<Self> {
        let pair = Self { axis, places: places.map(|place| place.0), span };
        match (&pair.places, pair.fixed()) {
            ([None, None], _) => fail(Code::BAD_VALUE, span, "one of the two planes must have a place"),
            (_, [Some(a), Some(b)]) if a >= b => fail(Code::BAD_VALUE, span, disordered(a, b)),
            _ => Ok(pair),
        }
    }

    /// The positions that are numbers.
    pub fn fixed(&self) -> [Option<f64>; 2] {
        [0, 1].map(|k| match self.places[k] {
            Some(Param::Number(at)) => Some(at),
            _ => None,
        })
    }

    /// Whether one of them follows a variable.
    pub fn follows(&self) -> bool {
        self.places.iter().any(|place| matches!(place, Some(Param::Ref(_))))
    }

    /// The planes of a run, with variables evaluated at `stage`; `key` stores their last positions.
    ///
    /// # Errors
    /// A missing variable.
    pub fn seal(&self, cx: &mut dyn SealCx, stage: Stage, key: Numbers) -> Result<Followed> {
        let mut places = [None; 2];
        for (reading, place) in places.iter_mut().zip(&self.places) {
            *reading = place.as_ref().map(|p| cx.param(p, stage, &When::Always)).transpose()?;
        }
        let (axis, span, follows) = (self.axis, self.span, self.follows());
        Ok(Followed { axis, places, follows, key, span, at: self.fixed(), velocity: [0.0; 2] })
    }

    /// Outline of the planes at fixed positions.
    pub fn outline(&self) -> Outline {
        drawn(self.axis, self.fixed())
    }
}

/// The message for a lower plane that is not below the upper one.
fn disordered(lo: f64, hi: f64) -> String {
    format!("the lower plane {lo} lies not below the upper one {hi}")
}

/// Outline of planes at these positions, for pictures.
fn drawn(axis: usize, places: [Option<f64>; 2]) -> Outline {
    Outline::new(move |w| {
        let Some(bounds) = w.domain.as_ref().map(perigrain_world::Domain::bounds) else { return vec![] };
        let mut normal = [0.0; 3];
        normal[axis] = 1.0;
        let plane = |at: f64| Region::inside(Shape::Plane { point: normal.map(|n| n * at), normal });
        places.into_iter().flatten().flat_map(|at| plane(at).outline(bounds)).collect()
    })
}

/// The planes during a run.
pub struct Followed {
    /// Normal axis.
    pub axis: usize,
    places: [Option<Reading>; 2],
    follows: bool,
    /// Key of step, positions and velocities at the last call, for planes that follow variables.
    key: Numbers,
    span: Span,
    /// Current positions.
    pub at: [Option<f64>; 2],
    /// Velocities along the normal.
    pub velocity: [f64; 2],
}

/// Numbers stored: the step, two positions, two velocities.
const KEPT: usize = 5;

impl Followed {
    /// Whether they are at rest for the whole run.
    pub fn stand(&self) -> bool {
        !self.follows
    }

    /// Moves the planes to the positions of their variables; their velocity is the displacement since the
    /// previous step over the time step (as in LAMMPS, zero in the first step). Returns the larger
    /// displacement since the last call, and the outline if they have moved.
    ///
    /// # Errors
    /// Variables that are not finite, or planes in the wrong order.
    pub fn follow(&mut self, w: &mut World, t: &Tick) -> Result<(f64, Option<Outline>)> {
        if !self.follows {
            return Ok((0.0, None));
        }
        let now = self.places.map(|place| place.map(|p| p.get(w)));
        self.check(now, t)?;
        let kept = w.memo.get(self.key).and_then(|m| <[f64; KEPT]>::try_from(&m[..]).ok());
        let step = t.step as f64;
        self.velocity = match kept {
            // The setup of a run uses the positions of the last step.
            Some([last, .., lower, upper]) if last == step => [lower, upper],
            Some([last, lo, hi, ..]) if last + 1.0 == step => {
                [(now[0], lo), (now[1], hi)].map(|(now, was)| now.map_or(0.0, |now| (now - was) / t.dt))
            }
            _ => [0.0; 2],
        };
        let [lo, hi] = now.map(Option::unwrap_or_default);
        w.memo.insert(self.key, vec![step, lo, hi, self.velocity[0], self.velocity[1]]);
        let before = std::mem::replace(&mut self.at, now);
        // A plane that had no position before counts as moved from far away.
        let way = |k: usize| match (now[k], before[k]) {
            (Some(now), Some(before)) => (now - before).abs(),
            (Some(_), None) => f64::INFINITY,
            (None, _) => 0.0,
        };
        let moved = now != before;
        Ok((way(0).max(way(1)), moved.then(|| drawn(self.axis, now))))
    }

    /// Refuses positions that are not finite, and planes that have passed each other.
    fn check(&self, now: [Option<f64>; 2], t: &Tick) -> Result<()> {
        let step = t.step;
        for (at, name) in now.into_iter().zip(NAMES) {
            if at.is_some_and(|at| !at.is_finite()) {
                let text = format!(
                    "the place of the {name} plane has become {} in step {step}",
                    at.unwrap_or(f64::NAN)
                );
                return fail(Code::BAD_VALUE, self.span, text);
            }
        }
        let [Some(lo), Some(hi)] = now else { return Ok(()) };
        if lo < hi {
            return Ok(());
        }
        let text = format!("{} in step {step}", disordered(lo, hi));
        Err(Diagnostic::error(Code::BAD_VALUE, self.span, text)
            .help("the variables let the planes pass through each other: two fixes may do so")
            .into())
    }
}
