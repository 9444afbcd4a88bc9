//! Which pairs of a list touch: distances of several partners at a time.

use std::ops::Range;
use std::ptr::null_mut;

use crate::contact::hits::{Hits, Rules};
use crate::contact::near::{BLOCK, Near};
use crate::families::Bounds;
use crate::list::kernel::{nearest, partners};
use perigrain_base::math::form::InLanes;
use perigrain_base::math::lanes::{Lanes, load_rows};

/// How images are sought: not at all, along the axes, along edges that lean.
const NONE: u8 = 0;
const UPRIGHT: u8 = 1;
const LEANING: u8 = 2;

/// Finds which pairs of some members touch.
pub struct Meet<'a> {
    /// The list.
    pub near: &'a Near,
    /// Which members, [`BLOCK`] at most.
    pub members: Range<usize>,
    /// How much closer particles may be by now than at the search.
    pub closer: f64,
    /// What pushes depend on.
    pub rules: &'a Rules<'a>,
    /// What is found.
    pub hits: &'a mut Hits,
    /// Where the pairs of each member end.
    pub ends: &'a mut [usize; BLOCK],
}

impl InLanes for Meet<'_> {
    type Out = ();
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let bounds = self.rules.view.bounds;
        // SAFETY: the caller's promise.
        unsafe {
            match bounds.periodic {
                [false, false, false] => meet::<N, V, NONE>(self),
                _ if bounds.tilted() => meet::<N, V, LEANING>(self),
                _ => meet::<N, V, UPRIGHT>(self),
            }
        }
    }
}

#[inline(always)]
unsafe fn meet<const N: usize, V: Lanes<N>, const IMAGES: u8>(task: Meet) {
    let Meet { near, members, closer, rules, hits, ends } = task;
    let bounds = rules.view.bounds;
    let edges = bounds.periods().length.map(|l| if l > 0.0 { l } else { f64::INFINITY });
    for (own, end) in members.zip(ends) {
        let row = near.row[own];
        if f64::from(near.after[own]) <= closer {
            hits.room(row.all().len());
            let x = &near.place[own];
            // SAFETY: rows and members are those of the list.
            unsafe {
                for first in row.all().step_by(N) {
                    let partner = near.partner.as_ptr().add(first);
                    let place = near.place.as_ptr().cast_mut();
                    let rows =
                        partners!(N, null_mut(), |k| place.add(*partner.add(k) as usize).cast::<f64>());
                    let [xj, yj, zj, volume]: [V; 4] = load_rows(&rows, 0);
                    let mut d = [xj.like(x[0]) - xj, xj.like(x[1]) - yj, xj.like(x[2]) - zj];
                    if IMAGES == UPRIGHT {
                        d = [nearest(d[0], edges[0]), nearest(d[1], edges[1]), nearest(d[2], edges[2])];
                    }
                    if IMAGES == LEANING {
                        d = leaning(d, &bounds);
                    }
                    let square = d[0].fma(d[0], d[1].fma(d[1], d[2] * d[2]));
                    let contact = V::read(near.contact.as_ptr().add(first));
                    let mut touching = !V::mask_bits(square.at_least(contact * contact)) & all(N);
                    if touching == 0 {
                        continue;
                    }
                    let columns = [
                        d[0].numbers(),
                        d[1].numbers(),
                        d[2].numbers(),
                        square.numbers(),
                        contact.numbers(),
                        volume.numbers(),
                    ];
                    while touching != 0 {
                        let lane = touching.trailing_zeros() as usize;
                        touching &= touching - 1;
                        let other = *partner.add(lane) as usize;
                        note(near, rules, hits, [own, other], columns.map(|column| column[lane]));
                    }
                }
            }
        }
        *end = hits.count;
    }
}

/// Takes a pair that touches in hand, of two members, unless it may not. There must be room for it.
#[inline(always)]
fn note(
    near: &Near,
    rules: &Rules,
    hits: &mut Hits,
    [own, other]: [usize; 2],
    [x, y, z, square, contact, far]: [f64; 6],
) {
    let [p, q] = [near.particle[own], near.particle[other]];
    let Some(stiff) = rules.stiff(p, q) else { return };
    let (at, volume) = (hits.count, rules.volume(near.place[own][3], far, p < q));
    let numbers = [x, y, z, square, contact, stiff, volume, far];
    let Hits { d: [a, b, c], square, contact, stiff, volume: [own, far], .. } = hits;
    for (column, number) in [a, b, c, square, contact, stiff, own, far].into_iter().zip(numbers) {
        column[at] = number;
    }
    hits.count = at + 1;
}

/// The bits of so many lanes.
const fn all(lanes: usize) -> u8 {
    (u16::MAX >> (16 - lanes)) as u8
}

/// Shortest images in a box that leans, one by one.
#[inline(always)]
fn leaning<const N: usize, V: Lanes<N>>(d: [V; 3], bounds: &Bounds) -> [V; 3] {
    let mut lanes = [d[0].numbers(), d[1].numbers(), d[2].numbers()];
    for k in 0..N {
        let near = bounds.nearest([lanes[0][k], lanes[1][k], lanes[2][k]]);
        (0..3).for_each(|axis| lanes[axis][k] = near[axis]);
    }
    [d[0].like_column(&lanes[0], 0), d[1].like_column(&lanes[1], 0), d[2].like_column(&lanes[2], 0)]
}
