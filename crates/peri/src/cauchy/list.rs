//! Correspondence over the bonds of a list that are in hand: Σ ω w eta⊗xi V at both ends, and forces.

use crate::cauchy::site::ROW;
use crate::list::kernel::{partners, scatter, steps};
use crate::list::laws::{Hand, Sum};
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::four::Four;
use perigrain_base::math::lanes::{Lanes, load_rows};
use std::ptr::null_mut;

/// Adds eta⊗xi of the bonds in hand, times ω w V of the other end, to the windows' rows of [`ROW`] numbers: three rows of four, the
/// fourth number of each unused.
pub(crate) fn add_gradients(form: Form, hand: Hand) {
    // SAFETY: the bonds in hand answer for memory.
    unsafe { form.run(AddGradients(hand)) }
}

/// Adds the forces of the bonds in hand times the volumes of both ends.
pub(crate) fn pull(form: Form, hand: Hand) {
    // SAFETY: the bonds in hand answer for memory.
    unsafe { form.run(Pull(hand)) }
}

/// See [`add_gradients`].
struct AddGradients<'a, 'b, 'c>(Hand<'a, 'b, 'c>);

impl InLanes for AddGradients<'_, '_, '_> {
    type Out = ();
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let Self(Hand { row, block: b, window, .. }) = self;
        // SAFETY: the processor has what the lanes need; partners of living bonds are records that the window covers, and differ.
        unsafe {
            let zero = V::all(0.0);
            let volume = zero.like(row.body.record[row.i].volume);
            let own = window.wrapping_add(ROW * row.i);
            let mut a = 0;
            while a < 3 {
                let mut sum = [Sum([zero; 2]); 3];
                for at in steps::<N>(b.count) {
                    let eta = zero.like_column(&b.eta[a], at) * zero.like_column(&b.weight, at);
                    let far = zero.like_column(&b.volume, at);
                    let mut out = [zero; 4];
                    let mut c = 0;
                    while c < 3 {
                        let xi = zero.like_column(&b.y[c], at) - zero.like_column(&b.eta[c], at);
                        let term = eta * xi;
                        sum[c].add(at, far, term);
                        out[c] = volume * term;
                        c += 1;
                    }
                    let rows = V::to_rows(out);
                    let mut lane = 0;
                    while lane < N {
                        let to = window.wrapping_add(ROW * b.target[at + lane] as usize + 4 * a);
                        (V::Row::load(to) + rows[lane]).store(to);
                        lane += 1;
                    }
                }
                let mut c = 0;
                while c < 3 {
                    *own.add(4 * a + c) += sum[c].total();
                    c += 1;
                }
                a += 1;
            }
        }
    }
}

/// See [`pull`].
struct Pull<'a, 'b, 'c>(Hand<'a, 'b, 'c>);

impl InLanes for Pull<'_, '_, '_> {
    type Out = ();
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let Self(Hand { row, acting, block: b, window: force }) = self;
        // SAFETY: the processor has what the lanes need; partners are records, each with a row of `ends`, and the bonds in hand answer
        // for the window.
        unsafe {
            let zero = V::all(0.0);
            let partner = row.body.partner.as_ptr();
            let volume = zero.like(row.body.record[row.i].volume);
            let ends = acting.ends.as_ptr().cast_mut();
            let mut total = [0.0; 3];
            let mut a = 0;
            while a < 3 {
                let own = ends.add(ROW * row.i + 4 * a);
                let own =
                    [zero.like(*own), zero.like(*own.add(1)), zero.like(*own.add(2)), zero.like(*own.add(3))];
                let mut sum = Sum([zero; 2]);
                for at in steps::<N>(b.count) {
                    let target = partner.add(b.place(at));
                    let rows = partners!(N, null_mut(), |k| ends.add(ROW * *target.add(k) as usize));
                    let far: [V; 4] = load_rows(&rows, 4 * a);
                    let eta = [
                        zero.like_column(&b.eta[0], at),
                        zero.like_column(&b.eta[1], at),
                        zero.like_column(&b.eta[2], at),
                    ];
                    let mut pull = (own[3] + far[3]) * eta[a];
                    let mut c = 0;
                    while c < 3 {
                        let xi = zero.like_column(&b.y[c], at) - eta[c];
                        pull = (own[c] + far[c]).fma(xi, pull);
                        c += 1;
                    }
                    let factor = zero.like_column(&b.weight, at) * (volume * zero.like_column(&b.volume, at));
                    sum.add(at, factor, pull);
                    (factor * pull).to_column(&mut b.out[a], at);
                }
                total[a] = sum.total();
                a += 1;
            }
            let own = force.wrapping_add(4 * row.i);
            if acting.least {
                let least = scatter::<N, V, true>(b, force);
                *own.add(3) = least.min(*own.add(3));
            } else {
                scatter::<N, V, false>(b, force);
            }
            *own += total[0];
            *own.add(1) += total[1];
            *own.add(2) += total[2];
        }
    }
}
