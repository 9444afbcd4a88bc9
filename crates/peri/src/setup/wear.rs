//! How much closer particles of a body may have come since near pairs were searched, place by place.
//!
//! Two particles in the same cell or in touching ones have come closer by no more than the range of the displacements of both cells.
//! Any others had a whole cell between them, which they must use up first: they are asked for in the same way among cells twice
//! as wide, and so on. So the ends of a body that flies apart may move far while neighbours hardly do.

use crate::families::cells::touching;
use crate::families::{Cells, Families, PeriView};

/// Width of the smallest cells, in ranges within which pairs are kept: narrow ones have smaller ranges of displacements, wide ones more
/// room for what lies beyond.
const WIDTH: f64 = 2.0;

/// The range of displacements of some particles since the search: least and largest [length].
type Moved = [[f64; 3]; 2];

/// Of no particles.
const NONE: Moved = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

fn with(a: &Moved, b: &Moved) -> Moved {
    [[0, 1, 2].map(|k| f64::min(a[0][k], b[0][k])), [0, 1, 2].map(|k| f64::max(a[1][k], b[1][k]))]
}

impl Families {
    /// Remembers where particles are at a search within bodies. In boxes that repeat they are not needed.
    pub(super) fn looked_at(&mut self, view: &PeriView) {
        self.near.looked.clear();
        self.scratch.looked.clear();
        if view.bounds.periodic == [false; 3] {
            self.near.looked.extend_from_slice(view.x);
        }
    }

    /// How much closer [length] two particles of a body may still come before some that were farther apart than `contact` and `skin` touch; no
    /// more than `skin`, negative where that is not known.
    pub(super) fn wear(&mut self, view: &PeriView, contact: f64, skin: f64) -> f64 {
        if self.near.looked.len() != view.x.len() || view.bounds.periodic != [false; 3] {
            return f64::NEG_INFINITY;
        }
        let (before, width) = (&self.near.looked, WIDTH * (contact + skin));
        let mut looked = std::mem::take(&mut self.scratch.looked);
        if looked.is_empty() {
            let lattices = self.lattices.iter().map(|body| &body.particle);
            looked.extend(lattices.chain([&self.list.particle]).map(|members| {
                let mut cells = Cells::default();
                let members = members.iter().copied().filter(|p| *p != u32::MAX);
                cells.fill(before, members, &view.bounds, width);
                cells
            }));
        }
        let left = looked.iter().map(|cells| {
            let moved = |p: &u32| {
                let (x, before) = (view.x[*p as usize], before[*p as usize]);
                [x[0] - before[0], x[1] - before[1], x[2] - before[2]]
            };
            left(cells, moved, (contact, skin, width))
        });
        let least = left.fold(skin, f64::min);
        self.scratch.looked = looked;
        least
    }
}

/// The same for one body in cells of a width, whose particles have moved.
fn left(cells: &Cells, moved: impl Fn(&u32) -> [f64; 3], (contact, skin, width): (f64, f64, f64)) -> f64 {
    let mut counts = cells.counts();
    let mut ranges: Vec<Moved> = (0..counts.iter().product())
        .map(|cell| cells.members(cell).iter().map(&moved).fold(NONE, |all, u| with(&all, &[u; 2])))
        .collect();
    let (mut room, mut beyond, mut left) = (skin, width, skin);
    loop {
        left = left.min(room - widest(&ranges, counts));
        if counts == [1; 3] {
            return left;
        }
        (ranges, counts) = wider(&ranges, counts);
        // Particles of cells that did not touch were as far apart as these were wide.
        room = beyond - contact;
        beyond *= 2.0;
    }
}

/// The largest range of displacements [length] in a cell and those that touch it, taken two by two.
fn widest(ranges: &[Moved], counts: [usize; 3]) -> f64 {
    let [nx, ny, _] = counts;
    let filled = |k: usize| ranges[k][0][0] <= ranges[k][1][0];
    let mut most = 0.0f64;
    for own in (0..ranges.len()).filter(|k| filled(*k)) {
        touching(counts, [own % nx, own / nx % ny, own / (nx * ny)], |run| {
            for other in run.filter(|k| filled(*k)) {
                let [least, largest] = with(&ranges[own], &ranges[other]);
                most = most.max((0..3).map(|k| (largest[k] - least[k]).powi(2)).sum());
            }
        });
    }
    most.sqrt()
}

/// The ranges of cells twice as wide.
fn wider(ranges: &[Moved], [nx, ny, nz]: [usize; 3]) -> (Vec<Moved>, [usize; 3]) {
    let counts = [nx, ny, nz].map(|n| n.div_ceil(2));
    let mut next = vec![NONE; counts.iter().product()];
    for (k, range) in ranges.iter().enumerate() {
        let [x, y, z] = [k % nx, k / nx % ny, k / (nx * ny)].map(|c| c / 2);
        let to = &mut next[x + counts[0] * (y + counts[1] * z)];
        *to = with(to, range);
    }
    (next, counts)
}
