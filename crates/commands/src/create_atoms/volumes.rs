//! `volumes cut`: each particle gets the part of its lattice cell that lies inside the region.

use super::places::New;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, sub};
use perigrain_base::par;
use perigrain_mesh::Columns;
use perigrain_world::region::Shape;
use perigrain_world::{Domain, Lattice, Region};

/// Places in a unit cell that are looked at where a surface passes: a Korobov lattice, whose shadows on the axes are equally
/// spaced. The generator is the best of all in the mean square error of smooth functions (P₂), found by trying them; the part of
/// a cell on one side of a plane comes out within 0.002 of the cell (root mean square of 60 planes).
const SAMPLES: u32 = 1021;
const GENERATOR: u32 = 94;
/// Cells of several sites whose shares differ by less are taken for equal.
const ALIKE: f64 = 0.03;
/// Parts that are given farther than so many spacings are reported, if they are more than so much of the whole.
const FAR: f64 = 1.8;
const REPORTED: f64 = 1e-3;

/// The volumes of new particles.
pub struct Shares {
    /// Of each of them [length³].
    pub each: Vec<f64>,
    /// The log line about them.
    pub line: String,
    /// What is odd about them.
    pub warning: Option<Diagnostic>,
}

/// The cell of one point of the basis.
struct Cell {
    /// Places in it, from the site.
    samples: Vec<Vec3>,
    /// What each of them stands for [length³].
    weight: f64,
    /// How far from the site the cell reaches at most.
    reach: f64,
}

/// The sites of unit cells from `first` on, in the order of the lattice.
struct Sites<'a> {
    lattice: &'a Lattice,
    first: [i64; 3],
    count: [usize; 3],
}

impl Sites<'_> {
    fn len(&self) -> usize {
        self.count.iter().product::<usize>() * self.lattice.basis.len()
    }

    /// Lattice coordinates of a site, and its point of the basis.
    fn at(&self, k: usize) -> (Vec3, usize) {
        let (m, cell) = (k % self.lattice.basis.len(), k / self.lattice.basis.len());
        let [a, b, _] = self.count;
        let (index, basis) = ([cell % a, cell / a % b, cell / a / b], self.lattice.basis[m]);
        ([0, 1, 2].map(|d| (self.first[d] + index[d] as i64) as f64 + basis[d]), m)
    }

    /// The number of the site at a place.
    fn number(&self, x: Vec3) -> Option<usize> {
        let q = self.lattice.from_box(x);
        let off = |m: &usize| {
            let from = [0, 1, 2].map(|d| q[d] - self.lattice.basis[*m][d]);
            from.iter().map(|f| (f - f.round()).abs()).sum::<f64>()
        };
        let m = (0..self.lattice.basis.len()).min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let cell = [0, 1, 2].map(|d| (q[d] - self.lattice.basis[m][d]).round() as i64);
        Some(self.row(cell)? * self.lattice.basis.len() + m)
    }

    fn row(&self, cell: [i64; 3]) -> Option<usize> {
        let mut index = [0; 3];
        for d in 0..3 {
            index[d] = usize::try_from(cell[d] - self.first[d]).ok().filter(|i| *i < self.count[d])?;
        }
        Some((index[2] * self.count[1] + index[1]) * self.count[0] + index[0])
    }
}

/// The part of each particle's cell that lies inside region and box; the cells of sites without a particle give theirs to the
/// nearest particles.
///
/// # Errors
/// A region that holds no site.
pub fn cut(lattice: &Lattice, domain: &Domain, region: &Region, new: &[New], span: Span) -> Result<Shares> {
    if new.is_empty() {
        let d = Diagnostic::error(Code::BAD_VALUE, span, "no lattice site lies inside the region");
        return Err(d.help("shift the lattice by `origin`, or make it finer").into());
    }
    let region = shut(region.clone());
    let (lo, hi) = super::places::bounds(domain, Some(&region));
    let (first, last) = lattice.cells(lo, hi);
    // One more on either side: the cells of sites reach beyond their unit cell.
    let first = first.map(|a| a - 1);
    let sites = Sites { lattice, first, count: [0, 1, 2].map(|d| (last[d] + 2 - first[d]).max(1) as usize) };
    let volumes = measured(&sites, domain, &region);
    let mut owner = vec![u32::MAX; sites.len()];
    for (n, new) in new.iter().enumerate() {
        match sites.number(new.x) {
            Some(k) => owner[k] = n as u32,
            None => return fail(Code::BAD_VALUE, span, "a site lies outside the lattice"),
        }
    }
    let mut shares = Given { each: vec![0.0; new.len()], moved: 0.0, far: 0.0, parts: 0 };
    let spacing = (volume(lattice) / lattice.basis.len() as f64).cbrt();
    for (k, volume) in volumes.iter().enumerate().filter(|(_, v)| **v > 0.0) {
        match owner[k] {
            u32::MAX => {
                let away = shares.give(*volume, &sites, k, &owner, new, domain);
                shares.far += if away > FAR * spacing { *volume } else { 0.0 };
            }
            n => shares.each[n as usize] += volume,
        }
    }
    Ok(shares.share(lattice, span))
}

/// The region with all its faces closed: what is open concerns walls.
fn shut(mut region: Region) -> Region {
    region.open = 0;
    region.everywhere = false;
    if let Shape::Union(parts) | Shape::Intersect(parts) = &mut region.shape {
        *parts = std::mem::take(parts).into_iter().map(shut).collect();
    }
    region
}

/// How much of each site's cell lies inside.
fn measured(sites: &Sites, domain: &Domain, region: &Region) -> Vec<f64> {
    let lattice = sites.lattice;
    let cells = cells(lattice);
    let unit = volume(lattice);
    let exact = Exact::new(lattice, domain, region);
    let in_box = |x: Vec3| (0..3).all(|d| x[d] >= domain.lo[d] && x[d] < domain.hi[d]);
    let one = |k: usize| {
        let (q, m) = sites.at(k);
        let (x, cell) = (lattice.to_box(q), &cells[m]);
        let from_face = (0..3).map(|d| (x[d] - domain.lo[d]).min(domain.hi[d] - x[d]));
        let depth = from_face.fold(f64::INFINITY, f64::min);
        if depth < -cell.reach {
            return 0.0;
        }
        let whole = depth > cell.reach;
        if !region.close(x, cell.reach, &mut vec![]) && (whole || !region.contains(x)) {
            return if region.contains(x) { cell.weight * cell.samples.len() as f64 } else { 0.0 };
        }
        if let Some(exact) = exact.as_ref().filter(|e| e.aligned || whole) {
            return unit * exact.part(q);
        }
        let held = |s: &&Vec3| {
            let place = add(x, **s);
            in_box(place) && region.contains(place)
        };
        cell.weight * cell.samples.iter().filter(held).count() as f64
    };
    let mut volumes = vec![0.0; sites.len()];
    par::each(&mut volumes[..], |start, chunk| {
        chunk.iter_mut().enumerate().for_each(|(k, v)| *v = one(start + k));
    });
    volumes
}

/// A mesh in the coordinates of a lattice with one site, whose cells are boxes there: what it leaves of them is found exactly.
struct Exact {
    columns: Columns,
    /// Whether the simulation box is a box there too.
    aligned: bool,
    lo: Vec3,
    hi: Vec3,
}

impl Exact {
    fn new(lattice: &Lattice, domain: &Domain, region: &Region) -> Option<Self> {
        let Shape::Mesh(solid) = &region.shape else { return None };
        if lattice.basis.len() != 1 || region.outside || region.motion.is_some() {
            return None;
        }
        let (from, to) = (lattice.from_box(domain.lo), lattice.from_box(domain.hi));
        let along = |d: usize| {
            let mut end = domain.lo;
            end[d] = domain.hi[d];
            let edge = sub(lattice.from_box(end), from);
            edge.iter().filter(|a| a.abs() > 1e-9 * length(edge)).count() == 1
        };
        Some(Self {
            columns: solid.columns(|x| lattice.from_box(x)),
            aligned: (0..3).all(along),
            lo: [0, 1, 2].map(|d| from[d].min(to[d])),
            hi: [0, 1, 2].map(|d| from[d].max(to[d])),
        })
    }

    /// The part of the cell around a site that lies in mesh and box, in unit cells.
    fn part(&self, q: Vec3) -> f64 {
        let (mut lo, mut hi) = (q.map(|a| a - 0.5), q.map(|a| a + 0.5));
        if self.aligned {
            (lo, hi) = ([0, 1, 2].map(|d| lo[d].max(self.lo[d])), [0, 1, 2].map(|d| hi[d].min(self.hi[d])));
        }
        if (0..3).any(|d| lo[d] >= hi[d]) { 0.0 } else { self.columns.volume(lo, hi) }
    }
}

/// The volume of the unit cell in the box.
fn volume(lattice: &Lattice) -> f64 {
    let corner = lattice.to_box([0.0; 3]);
    let edge = |d: usize| sub(lattice.to_box([0, 1, 2].map(|k| f64::from(u8::from(k == d)))), corner);
    dot(edge(0), cross(edge(1), edge(2))).abs()
}

/// The cells of the sites of the basis: what is nearer to each of them than to all others. Of one site alone the cell is the
/// unit cell around it.
fn cells(lattice: &Lattice) -> Vec<Cell> {
    let n = lattice.basis.len();
    let mut cells: Vec<Cell> = (0..n).map(|_| Cell { samples: vec![], weight: 0.0, reach: 0.0 }).collect();
    let corner = lattice.to_box([0.0; 3]);
    for s in 0..SAMPLES {
        let mut step = 1;
        let u = [0, 1, 2].map(|_| {
            let place = f64::from(s * step % SAMPLES) + 0.5;
            step = step * GENERATOR % SAMPLES;
            place / f64::from(SAMPLES)
        });
        let (m, from) = if n == 1 { (0, u.map(|a| a - 0.5)) } else { nearest(lattice, u) };
        cells[m].samples.push(sub(lattice.to_box(from), corner));
    }
    let unit = volume(lattice);
    let share = |c: &Cell| c.samples.len() as f64 / f64::from(SAMPLES);
    let alike = cells.iter().all(|c| (share(c) * n as f64 - 1.0).abs() < ALIKE);
    for cell in &mut cells {
        let whole = if alike { 1.0 / n as f64 } else { share(cell) };
        cell.weight = unit * whole / (cell.samples.len() as f64).max(1.0);
        // Samples leave some room to the cell's corners: half the spacing of as many places on a grid.
        let room = 0.1 * unit.cbrt();
        cell.reach = cell.samples.iter().map(|s| length(*s)).fold(0.0, f64::max) + room;
    }
    cells
}

/// The point of the basis nearest to lattice coordinates, and these from there.
fn nearest(lattice: &Lattice, u: Vec3) -> (usize, Vec3) {
    let corner = lattice.to_box([0.0; 3]);
    let mut best = (f64::INFINITY, 0, u);
    for (m, b) in lattice.basis.iter().enumerate() {
        for k in 0..27 {
            let shift = [k % 3, k / 3 % 3, k / 9].map(|s| f64::from(s) - 1.0);
            let from = [0, 1, 2].map(|d| u[d] - b[d] - shift[d]);
            let far = length(sub(lattice.to_box(from), corner));
            if far < best.0 {
                best = (far, m, from);
            }
        }
    }
    (best.1, best.2)
}

/// The volumes while they are given.
struct Given {
    each: Vec<f64>,
    moved: f64,
    far: f64,
    parts: usize,
}

impl Given {
    /// Gives the volume of a site without a particle to the nearest ones, in equal parts; returns how far that is.
    fn give(
        &mut self,
        volume: f64,
        sites: &Sites,
        k: usize,
        owner: &[u32],
        new: &[New],
        domain: &Domain,
    ) -> f64 {
        let x = sites.lattice.to_box(sites.at(k).0);
        let largest = sites.count.into_iter().max().unwrap_or(1) as i64;
        let mut reach = 2;
        let mut near = vec![];
        while near.is_empty() && reach <= 2 * largest {
            near = neighbours(x, reach, sites, owner, new, domain);
            reach *= 2;
        }
        let far = near.iter().map(|n| n.0).fold(f64::INFINITY, f64::min);
        near.retain(|n| n.0 <= far * (1.0 + 1e-6));
        near.sort_unstable_by_key(|n| n.1);
        near.dedup_by_key(|n| n.1);
        let part = volume / near.len() as f64;
        near.iter().for_each(|n| self.each[n.1] += part);
        (self.moved, self.parts) = (self.moved + volume, self.parts + 1);
        far
    }

    fn share(self, lattice: &Lattice, span: Span) -> Shares {
        let sum: f64 = self.each.iter().sum();
        let whole = volume(lattice) / lattice.basis.len() as f64;
        let line = format!(
            "  volumes from {} to {} of a cell, {} in all; {} of it from {} cells whose site has no particle",
            general(self.each.iter().copied().fold(f64::INFINITY, f64::min) / whole, 4),
            general(self.each.iter().copied().fold(0.0, f64::max) / whole, 4),
            general(sum, 8),
            general(self.moved, 4),
            self.parts
        );
        let warning = (self.far > REPORTED * sum).then(|| {
            let text = format!(
                "{} of the volume {} went to particles farther than {FAR} spacings away",
                general(self.far, 4),
                general(sum, 8)
            );
            let d = Diagnostic::warning(Code::SUSPICIOUS, span, text);
            d.help("the region has parts thinner than the lattice: make that finer, or shift it by `origin`")
        });
        Shares { each: self.each, line, warning }
    }
}

/// Particles of cells within so many of a place, with their distances, across periodic faces too.
fn neighbours(
    x: Vec3,
    reach: i64,
    sites: &Sites,
    owner: &[u32],
    new: &[New],
    domain: &Domain,
) -> Vec<(f64, usize)> {
    let mut found = vec![];
    let n = sites.lattice.basis.len();
    for image in 0..27 {
        let image = [image % 3, image / 3 % 3, image / 9].map(|s| f64::from(s) - 1.0);
        if (0..3).any(|d| image[d] != 0.0 && !domain.boundary.periodic(d)) {
            continue;
        }
        let there = [0, 1, 2].map(|d| x[d] + image[d] * (domain.hi[d] - domain.lo[d]));
        let middle = sites.lattice.from_box(there).map(|a| a.floor() as i64);
        let span = |d: usize| {
            let end = sites.first[d] + sites.count[d] as i64 - 1;
            (middle[d] - reach).max(sites.first[d])..=(middle[d] + reach).min(end)
        };
        for i in span(0) {
            for j in span(1) {
                for k in span(2) {
                    let Some(row) = sites.row([i, j, k]) else { continue };
                    let owners = owner[row * n..(row + 1) * n].iter().filter(|o| **o != u32::MAX);
                    found.extend(owners.map(|o| (length(sub(new[*o as usize].x, there)), *o as usize)));
                }
            }
        }
    }
    found
}
