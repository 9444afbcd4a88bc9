//! Which pairs of a list touch: distances of several partners at a time.

use std::ops::Range;
use std::ptr::null;

use crate::contact::hits::{Hits, Rules};
use crate::contact::near::{BLOCK, Near};
use crate::families::Bounds;
use crate::lanes::Lanes;
use crate::lanes::isa::{Isa, Kernel};
use crate::lanes::rows::{MOST, Rows};
use crate::list::kernel::{nearest, partners};

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

impl Kernel for Meet<'_> {
    type Out = ();
    #[inline(always)]
    unsafe fn run<L: Isa>(self) {
        let bounds = self.rules.view.bounds;
        // SAFETY: the caller's promise.
        unsafe {
            match bounds.periodic {
                [false, false, false] => meet::<L, NONE>(self),
                _ if bounds.tilted() => meet::<L, LEANING>(self),
                _ => meet::<L, UPRIGHT>(self),
            }
        }
    }
}

#[inline(always)]
unsafe fn meet<L: Rows, const IMAGES: u8>(task: Meet) {
    let Meet { near, members, closer, rules, hits, ends } = task;
    let bounds = rules.view.bounds;
    let edges = bounds.periods().length.map(|l| if l > 0.0 { l } else { f64::INFINITY });
    for (own, end) in members.zip(ends) {
        let row = near.row[own];
        if f64::from(near.after[own]) <= closer {
            hits.room(row.all().len());
            let own_place = &near.place[own];
            // SAFETY: rows and members are those of the list; there is room for all pairs of the row.
            unsafe {
                let x = [L::splat(own_place[0]), L::splat(own_place[1]), L::splat(own_place[2])];
                for first in row.all().step_by(L::WIDTH) {
                    let partner = near.partner.as_ptr().add(first);
                    let rows = partners!(L, null(), |k| near
                        .place
                        .as_ptr()
                        .add(*partner.add(k) as usize)
                        .cast::<f64>());
                    let [xj, yj, zj, volume] = L::quads(&rows);
                    let mut d = [x[0].sub(xj), x[1].sub(yj), x[2].sub(zj)];
                    if IMAGES == UPRIGHT {
                        d = [nearest(d[0], edges[0]), nearest(d[1], edges[1]), nearest(d[2], edges[2])];
                    }
                    if IMAGES == LEANING {
                        d = leaning(d, &bounds);
                    }
                    let square = d[0].fma(d[0], d[1].fma(d[1], d[2].mul(d[2])));
                    let contact = L::load(near.contact.as_ptr().add(first));
                    let mut touching = !square.ge(contact.mul(contact)).bits() & all::<L>();
                    if touching == 0 {
                        continue;
                    }
                    let mut columns = [[0.0; MOST]; 6];
                    d[0].store(columns[0].as_mut_ptr());
                    d[1].store(columns[1].as_mut_ptr());
                    d[2].store(columns[2].as_mut_ptr());
                    square.store(columns[3].as_mut_ptr());
                    contact.store(columns[4].as_mut_ptr());
                    volume.store(columns[5].as_mut_ptr());
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

/// Takes a pair that touches in hand, of two members, unless it may not.
///
/// # Safety
/// There must be room for it.
#[inline(always)]
unsafe fn note(
    near: &Near,
    rules: &Rules,
    hits: &mut Hits,
    [own, other]: [usize; 2],
    [x, y, z, square, contact, far]: [f64; 6],
) {
    let [p, q] = [near.particle[own], near.particle[other]];
    let Some(stiff) = rules.stiff(p, q) else { return };
    let (at, volume) = (hits.count, rules.volume(near.place[own][3], far, p < q));
    // SAFETY: by the caller's promise.
    unsafe {
        *hits.d[0].get_unchecked_mut(at) = x;
        *hits.d[1].get_unchecked_mut(at) = y;
        *hits.d[2].get_unchecked_mut(at) = z;
        *hits.square.get_unchecked_mut(at) = square;
        *hits.contact.get_unchecked_mut(at) = contact;
        *hits.stiff.get_unchecked_mut(at) = stiff;
        *hits.volume[0].get_unchecked_mut(at) = volume;
        *hits.volume[1].get_unchecked_mut(at) = far;
    }
    hits.count = at + 1;
}

/// The bits of all lanes.
fn all<L: Lanes>() -> u8 {
    (u16::MAX >> (16 - L::WIDTH)) as u8
}

/// Shortest images in a box that leans, one by one.
#[inline(always)]
unsafe fn leaning<L: Lanes>(d: [L; 3], bounds: &Bounds) -> [L; 3] {
    let mut lanes = [[0.0; MOST]; 3];
    // SAFETY: arrays of as many lanes as there are at most.
    unsafe {
        d[0].store(lanes[0].as_mut_ptr());
        d[1].store(lanes[1].as_mut_ptr());
        d[2].store(lanes[2].as_mut_ptr());
        for k in 0..L::WIDTH {
            let near = bounds.nearest([lanes[0][k], lanes[1][k], lanes[2][k]]);
            (0..3).for_each(|axis| lanes[axis][k] = near[axis]);
        }
        [L::load(lanes[0].as_ptr()), L::load(lanes[1].as_ptr()), L::load(lanes[2].as_ptr())]
    }
}
