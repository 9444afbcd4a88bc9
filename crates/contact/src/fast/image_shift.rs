//! Lists that stay valid after grains have been wrapped around the box.

use super::lists::List;
use super::{FAR, Fast, NOWHERE};
use perigrain_base::math::lanes::{PLACE_BITS, place};
use perigrain_base::math::periods::Periods;
use perigrain_base::par;
use perigrain_neigh::tiles::shift_of;

impl Fast {
    /// Records the periodic images of the box for which the lists were made.
    pub(super) fn see_images(&mut self, period: Periods) {
        self.period = period;
        for (image, shift) in self.shifts.iter_mut().take(27).enumerate() {
            let [x, y, z] = period.shift(shift_of(image as u32));
            *shift = [x, y, z, 0.0];
        }
        self.shifts[NOWHERE as usize][0] = FAR;
    }

    /// Updates the images after a change of the box: grains far from an image may now be near it.
    pub(super) fn follow(&mut self, period: &Periods) {
        if *period != self.period {
            self.validity.follow(&self.period, period);
            self.see_images(*period);
        }
    }

    /// Adapts the lists to grains that have been wrapped: `turns` counts the edges of the box that each has
    /// moved since the lists were made; empty if none has.
    pub fn turn(&mut self, turns: &[[i8; 3]], period: &Periods) {
        self.follow(period);
        if turns == self.turns {
            return;
        }
        let code = |n: &[i16; 3]| i32::from(n[0]) + 3 * i32::from(n[1]) + 9 * i32::from(n[2]);
        let of = |list: &[[i8; 3]], i: usize| list.get(i).copied().unwrap_or_default().map(i16::from);
        let more: Vec<[i16; 3]> = (0..self.tag.len())
            .map(|i| std::array::from_fn(|d| of(turns, i)[d] - of(&self.turns, i)[d]))
            .collect();
        // The code of an image is a sum over axes: each wrap of a grain adds to it.
        let codes: Vec<i32> = more.iter().map(code).collect();
        let follow = |i: &u32, w: &mut u32| {
            let image = *w >> PLACE_BITS;
            if image != NOWHERE {
                let turned = image as i32 + codes[*i as usize] - codes[place(*w)];
                debug_assert!((0..27).contains(&turned), "neighbours are in the next image at most");
                *w = place(*w) as u32 | (turned as u32) << PLACE_BITS;
            }
        };
        let lists = par::Shared::new(&mut self.lists);
        par::for_rows(lists.len(), |k| {
            // SAFETY: each part writes its own list.
            let List { long, short, .. } = unsafe { &mut lists.get(k..k + 1)[0] };
            for (i, w) in [(&long.i, &mut long.w), (&short.i, &mut short.w)] {
                i.iter().zip(w).for_each(|(i, w)| follow(i, w));
            }
        });
        self.validity.turn(&self.lists, turns, &more, period);
        self.turns = turns.to_vec();
    }
}
