//! Whether living bonds join pairs of particles, asked for many at a time.

use crate::families::Families;
use crate::families::lattice::LatticeBody;
use perigrain_base::par;

/// Where a particle is in its body.
#[derive(Clone, Copy)]
struct Site {
    /// As [`Families::body_of`].
    body: u32,
    /// The cell of a lattice, and its place along rows, across them and across planes.
    cell: u32,
    at: [i32; 3],
}

/// The stencil vector of each step from one cell to another.
struct Steps {
    reach: [i32; 3],
    bond: Vec<u16>,
}

/// Not a step of the stencil.
const NONE: u16 = u16::MAX;

impl Steps {
    fn of(body: &LatticeBody) -> Self {
        let reach: [i32; 3] =
            std::array::from_fn(|k| body.stencil.iter().map(|s| s[k].abs()).max().unwrap_or(0));
        let mut steps =
            Self { reach, bond: vec![NONE; reach.iter().map(|r| (2 * r + 1) as usize).product()] };
        for (e, step) in body.stencil.iter().enumerate() {
            let place = steps.place(*step);
            steps.bond[place] = e as u16;
        }
        steps
    }

    fn place(&self, step: [i32; 3]) -> usize {
        let [x, y, z] = [0, 1, 2].map(|k| (step[k] + self.reach[k]) as usize);
        let [wide, deep, _] = self.reach.map(|r| (2 * r + 1) as usize);
        x + wide * (y + deep * z)
    }

    /// The stencil vector from one cell to another, if the first of them keeps the bond.
    fn bond(&self, step: [i32; 3]) -> Option<usize> {
        let within = (0..3).all(|k| step[k].abs() <= self.reach[k]);
        within.then(|| self.bond[self.place(step)]).filter(|e| *e != NONE).map(usize::from)
    }
}

/// All particles, as a search for pairs needs them.
pub(super) struct Joined<'a> {
    families: &'a Families,
    sites: Vec<Site>,
    steps: Vec<Steps>,
}

impl<'a> Joined<'a> {
    /// Of the present bonds.
    pub(super) fn of(families: &'a Families) -> Self {
        let mut sites = vec![Site { body: u32::MAX, cell: 0, at: [0; 3] }; families.place.len()];
        par::each(&mut sites[..], |first, sites| {
            for (k, site) in sites.iter_mut().enumerate() {
                site.body = families.body_of((first + k) as u32);
                if let Some(body) = families.lattices.get(site.body as usize) {
                    let cell = (families.place[first + k] - body.first_place) as usize;
                    (site.cell, site.at) = (cell as u32, body.site(cell));
                }
            }
        });
        Self { families, sites, steps: families.lattices.iter().map(Steps::of).collect() }
    }

    /// Whether a living bond joins two particles; `None` if they are not of one body.
    pub(super) fn bond(&self, i: u32, j: u32) -> Option<bool> {
        let (a, b) = (&self.sites[i as usize], &self.sites[j as usize]);
        if a.body != b.body || a.body == u32::MAX {
            return None;
        }
        let Some(body) = self.families.lattices.get(a.body as usize) else {
            return Some(self.families.bonded(i, j));
        };
        let (steps, step) = (&self.steps[a.body as usize], [0, 1, 2].map(|k| b.at[k] - a.at[k]));
        let ahead = steps.bond(step).map(|e| body.lives(a.cell as usize, e));
        Some(
            ahead
                .or_else(|| Some(body.lives(b.cell as usize, steps.bond(step.map(|s| -s))?)))
                .unwrap_or(false),
        )
    }
}
