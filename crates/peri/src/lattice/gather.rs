//! Displacements of a body on a lattice: gathered from positions into rows, with what moved.

use crate::families::PeriView;
use crate::families::lattice::{LANES, LatticeBody, PAD, RowMotion, greater, lesser};
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::lanes::Lanes;
use perigrain_base::par::{self, Shared};

/// Gathers displacements from positions into `u[1]`, and what moved since `u[0]`. Where contact is `short_range` even
/// between undisplaced particles, nothing is at rest. Row slots that are not among those that a rank `follows` are left out.
///
/// # Safety
/// The processor must have what the form needs.
pub unsafe fn gather(
    form: Form,
    body: &mut LatticeBody,
    view: &PeriView,
    reference: &[[f64; 3]],
    short_range: bool,
    follows: Option<&[bool]>,
) {
    let [old, new] = &mut body.u;
    let (new, motion) = (Shared::new(new), Shared::new(&mut body.motion));
    let (rows, particle, stride, width) = (&body.rows, &body.particle, body.stride, body.width);
    par::for_rows(body.planes, |plane| {
        for slot in plane * width..(plane + 1) * width {
            if follows.is_some_and(|follows| !follows[slot]) {
                continue;
            }
            let row = rows[slot];
            let cells = row.start as usize..(row.start + row.len) as usize;
            // SAFETY: rows do not share cells, and each row belongs to one plane.
            let u = unsafe {
                [0, 1, 2].map(|k| new.get(k * stride + PAD + cells.start..k * stride + PAD + cells.end))
            };
            let last = [0, 1, 2].map(|k| &old[k * stride + PAD + cells.start..k * stride + PAD + cells.end]);
            // SAFETY: as above, one entry per row.
            let motion = &mut unsafe { motion.get(slot..slot + 1) }[0];
            let task = Row { particle: &particle[cells], view, reference, u, last, lo: row.lo };
            // SAFETY: the caller's promise.
            *motion = unsafe { form.run(task) };
            if short_range {
                (motion.lo, motion.hi) = (row.lo, row.lo + row.len as i32 - 1);
            }
        }
    });
}

/// One row of cells.
pub struct Row<'a> {
    particle: &'a [u32],
    view: &'a PeriView<'a>,
    reference: &'a [[f64; 3]],
    u: [&'a mut [f64]; 3],
    last: [&'a [f64]; 3],
    lo: i32,
}

impl InLanes for Row<'_> {
    type Out = RowMotion;
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) -> RowMotion {
        gather_row(self)
    }
}

#[inline(always)]
fn gather_row(row: Row) -> RowMotion {
    let Row { particle, view, reference, u: [ux, uy, uz], last, lo } = row;
    let n = particle.len();
    let (ux, uy, uz) = (&mut ux[..n], &mut uy[..n], &mut uz[..n]);
    if view.bounds.periodic != [false; 3] {
        for c in 0..n {
            let p = particle[c] as usize;
            let (Some(x), Some(x0)) = (view.x.get(p), reference.get(p)) else { continue };
            let before = [last[0][c], last[1][c], last[2][c]];
            let now = unwrap([x[0] - x0[0], x[1] - x0[1], x[2] - x0[2]], before, view);
            (ux[c], uy[c], uz[c]) = (now[0], now[1], now[2]);
        }
    } else {
        for start in (0..n).step_by(LANES) {
            let some: &[u32; LANES] = match particle[start..].first_chunk() {
                Some(some) => some,
                None => break,
            };
            let first = some[0] as usize;
            // Rows mostly follow the order of creation: then no particle need be looked up.
            let follow = (0..LANES).fold(true, |yes, k| yes & (some[k] == some[0].wrapping_add(k as u32)));
            let run = first..first.saturating_add(LANES);
            if follow && let (Some(x), Some(x0)) = (view.x.get(run.clone()), reference.get(run)) {
                for k in 0..LANES {
                    ux[start + k] = x[k][0] - x0[k][0];
                    uy[start + k] = x[k][1] - x0[k][1];
                    uz[start + k] = x[k][2] - x0[k][2];
                }
                continue;
            }
            for (c, &p) in (start..).zip(some) {
                let (Some(x), Some(x0)) = (view.x.get(p as usize), reference.get(p as usize)) else {
                    continue;
                };
                (ux[c], uy[c], uz[c]) = (x[0] - x0[0], x[1] - x0[1], x[2] - x0[2]);
            }
        }
    }
    // Vacant cells stay at zero: they widen the ranges at most.
    let mut motion = RowMotion::NONE;
    for (k, (now, last)) in [&*ux, &*uy, &*uz].into_iter().zip(last).enumerate() {
        (motion.least[k], motion.most[k]) = range_of_change(now, last);
        if let Some(first) = now.iter().position(|&u| u != 0.0) {
            motion.lo = motion.lo.min(lo + first as i32);
            let last = now.iter().rposition(|&u| u != 0.0).unwrap_or(first);
            motion.hi = motion.hi.max(lo + last as i32);
        }
    }
    motion
}

/// The smallest and the largest difference of two columns whose length is a multiple of [`LANES`].
#[inline(always)]
fn range_of_change(now: &[f64], last: &[f64]) -> (f64, f64) {
    let (mut least, mut most) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    for (now, last) in now.chunks_exact(LANES).zip(last.chunks_exact(LANES)) {
        for k in 0..LANES {
            let change = now[k] - last[k];
            least[k] = lesser(change, least[k]);
            most[k] = greater(change, most[k]);
        }
    }
    // Halves at a time: one after the other each would wait for the one before.
    let mut half = LANES / 2;
    while half > 0 {
        for k in 0..half {
            least[k] = lesser(least[k], least[k + half]);
            most[k] = greater(most[k], most[k + half]);
        }
        half /= 2;
    }
    (least[0], most[0])
}

/// The displacement among its periodic images that is nearest to the one before.
#[inline(always)]
fn unwrap(now: [f64; 3], before: [f64; 3], view: &PeriView) -> [f64; 3] {
    if view.bounds.tilted() {
        let edges = view.bounds.periods();
        let by = edges.shift(edges.turns([0, 1, 2].map(|k| now[k] - before[k])));
        return [0, 1, 2].map(|k| now[k] - by[k]);
    }
    [0, 1, 2].map(|k| {
        if !view.bounds.periodic[k] {
            return now[k];
        }
        let length = view.bounds.hi[k] - view.bounds.lo[k];
        now[k] - length * ((now[k] - before[k]) / length).round()
    })
}
