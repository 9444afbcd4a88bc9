//! Lists that go on after grains have been moved around the box.

use super::lists::List;
use super::{FAR, Fast, NOWHERE};
use perigrain_base::math::lanes::{PLACE_BITS, place};
use perigrain_base::math::periods::Periods;
use perigrain_base::par;
use perigrain_neigh::tiles::shift_of;

impl Fast {
    /// Images of a box that repeats after these periods, in which lists were made.
    pub(super) fn see_images(&mut self, period: Periods) {
        self.period = period;
        for (image, shift) in self.shifts.iter_mut().take(27).enumerate() {
            let [x, y, z] = period.shift(shift_of(image as u32));
            *shift = [x, y, z, 0.0];
        }
        self.shifts[NOWHERE as usize][0] = FAR;
    }

    /// The box has changed since: images stand elsewhere, and who was far from one may be near.
    pub(super) fn follow(&mut self, period: &Periods) {
        if *period != self.period {
            self.validity.follow(&self.period, period);
            self.see_images(*period);
        }
    }

    /// Lists see grains where they are after as many `turns` of each since the lists were made, that is after they were moved by
    /// so many edges of the box; empty where nobody was.
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
        // The code of an image is a sum over axes: what its grains are moved by adds to it.
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
