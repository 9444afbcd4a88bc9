//! A load applied in parts, for displacements of any size and slipping surfaces: tangential contact forces
//! depend on the path.
//!
//! Each part is balanced by Newton's method, starting from an extrapolation of the last one.

use super::contacts::Past;
use super::newton::{Body, End, Found};
use super::six::Six;
use super::walls::Walls;

/// A load and the number of its parts.
pub struct Load<'a> {
    /// The body without a history, with walls in their final position.
    pub body: Body<'a>,
    /// A field under the whole load: held components end there, free ones start along it.
    pub whole: &'a [Six],
    /// Number of parts.
    pub parts: usize,
    /// Friction coefficient between particles, infinite if nothing slips.
    pub friction: f64,
    /// Whether forces act before the load, so that they are balanced first.
    pub pressed: bool,
    /// Termination criterion of a part.
    pub end: End,
}

/// A body under the whole load.
pub struct Carried {
    /// The equilibrium of the last part; its steps of conjugate gradients are summed over all parts.
    pub found: Found,
    /// Contact history before the last part.
    pub past: Past,
    /// The walls in their current position.
    pub walls: Walls,
    /// Steps of Newton's method.
    pub steps: usize,
}

impl Load<'_> {
    /// Applies the load.
    pub fn carry(&self) -> Carried {
        let still = vec![[0.0; 6]; self.whole.len()];
        let past = self.body.contacts.unsheared(self.friction, still.clone());
        let mut out = self.part(&still, 0.0, past);
        let mut before = still;
        for part in 1..=self.parts {
            let start = self.towards(part, &out.found.field, &before);
            let mut past = out.past;
            self.body.contacts.pass(&out.found.field, &mut past);
            let mut next = self.part(&start, part as f64 / self.parts as f64, past);
            next.found.iterations += out.found.iterations;
            next.found.done &= out.found.done;
            next.steps += out.steps;
            before = out.found.field;
            out = next;
        }
        out
    }

    /// Balances a part of the load, starting from a field.
    fn part(&self, start: &[Six], on: f64, past: Past) -> Carried {
        let walls = Walls { delta: on * self.body.walls.delta, ..self.body.walls.clone() };
        let body = Body { walls: &walls, past: Some(&past), ..self.body };
        // Without load there are no forces, unless contacts are under pressure.
        let found =
            if on == 0.0 && !self.pressed { body.still() } else { body.relax(start.to_vec(), self.end) };
        Carried { steps: found.residuals.len() - 1, found, walls, past }
    }

    /// Extrapolates from the previous fields; the first part follows the field of the whole load.
    fn towards(&self, part: usize, field: &[Six], before: &[Six]) -> Vec<Six> {
        let one = 1.0 / self.parts as f64;
        let rows = field.iter().zip(before).zip(self.whole).zip(self.body.held);
        rows.map(|(((u, b), whole), held)| {
            std::array::from_fn(|c| match held >> c & 1 {
                1 => part as f64 * one * whole[c],
                _ if part == 1 => u[c] + one * whole[c],
                _ => 2.0 * u[c] - b[c],
            })
        })
        .collect()
    }
}
