//! What families need to know about particles and the box, and what an evaluation adds up.

use crate::families::excluded::Excluded;
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::SIX;

/// A box, whose edges may lean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Low corner.
    pub lo: [f64; 3],
    /// High corner.
    pub hi: [f64; 3],
    /// Which directions repeat.
    pub periodic: [bool; 3],
    /// How it leans: xy, xz, yz.
    pub tilt: [f64; 3],
}

impl Bounds {
    /// Whether some edge leans.
    #[inline]
    pub fn tilted(&self) -> bool {
        self.tilt != [0.0; 3]
    }

    /// The edges along which it repeats, zero elsewhere.
    pub fn periods(&self) -> Periods {
        let of = |k: usize, a: f64| if self.periodic[k] { a } else { 0.0 };
        let [xy, xz, yz] = self.tilt;
        Periods {
            length: std::array::from_fn(|k| of(k, self.hi[k] - self.lo[k])),
            tilt: [of(1, xy), of(2, xz), of(2, yz)],
        }
    }

    /// All edges.
    pub fn edges(&self) -> Periods {
        Periods { length: std::array::from_fn(|k| self.hi[k] - self.lo[k]), tilt: self.tilt }
    }

    /// Where a place would be were the box upright.
    pub fn upright(&self, x: [f64; 3]) -> [f64; 3] {
        self.edges().straightened(x, self.lo)
    }

    /// By how much upright places along an axis are farther apart at most than the places themselves.
    pub fn wider(&self) -> [f64; 3] {
        let edges = self.edges();
        let heights = edges.heights();
        std::array::from_fn(|k| if self.tilted() { edges.length[k] / heights[k] } else { 1.0 })
    }

    /// The shortest of `d` and its images.
    #[inline]
    pub fn nearest(&self, mut d: [f64; 3]) -> [f64; 3] {
        if self.tilted() {
            return self.periods().nearest(d);
        }
        for k in 0..3 {
            let length = self.hi[k] - self.lo[k];
            if self.periodic[k] && d[k].abs() > 0.5 * length {
                d[k] -= length * (d[k] / length).round();
            }
        }
        d
    }
}

/// Energy and virial of one force evaluation; the caller zeroes them.
#[derive(Debug, Default)]
pub struct PeriTally<'a> {
    /// Sum over particles: energy densities, or energies under [`ForceUnit::Newton`](crate::families::ForceUnit::Newton).
    pub energy: f64,
    /// Virial xx, yy, zz, xy, xz, yz: with one volume factor, as LAMMPS.
    pub virial: [f64; 6],
    /// Energy (density) of each particle, added to.
    pub per_atom_energy: Option<&'a mut [f64]>,
    /// Virial of each particle, half of a bond's for each end, added to.
    pub per_atom_virial: Option<&'a mut [[f64; 6]]>,
}

/// Energy and the six components of the virial of one row of cells, one record or one particle.
pub(crate) type Sums = [f64; 7];

impl PeriTally<'_> {
    /// Adds up rows in their order.
    pub(crate) fn collect(&mut self, rows: &[Sums]) {
        for row in rows {
            self.energy += row[0];
            self.virial.iter_mut().zip(&row[1..]).for_each(|(v, own)| *v += own);
        }
    }

    /// Whether something is wanted of each particle.
    pub fn per_atom(&self) -> bool {
        self.per_atom_energy.is_some() || self.per_atom_virial.is_some()
    }

    /// Adds the virial of the force `pull` times `d` on `i` from `j`.
    pub fn add_virial(&mut self, i: usize, j: usize, pull: f64, d: [f64; 3]) {
        self.add_virials([i, j], [pull; 2], d);
    }

    /// Adds the virial of a bond along `d` that pulls at each of its ends as that end feels it.
    pub fn add_virials(&mut self, ends: [usize; 2], pulls: [f64; 2], d: [f64; 3]) {
        let both = 0.5 * (pulls[0] + pulls[1]);
        let product = |pull: f64| SIX.map(|(a, b)| pull * d[a] * d[b]);
        self.virial.iter_mut().zip(product(both)).for_each(|(v, p)| *v += p);
        if let Some(atoms) = self.per_atom_virial.as_deref_mut() {
            for (end, pull) in ends.into_iter().zip(pulls) {
                atoms[end].iter_mut().zip(product(pull)).for_each(|(v, p)| *v += 0.5 * p);
            }
        }
    }
}

/// What families need to know about particles: columns of equal length, and the box.
#[derive(Clone, Copy, Debug)]
pub struct PeriView<'a> {
    /// Positions.
    pub x: &'a [[f64; 3]],
    /// Positions at creation.
    pub x0: &'a [[f64; 3]],
    /// Types, from 1.
    pub kind: &'a [u16],
    /// Volumes.
    pub volume: &'a [f64],
    /// The box.
    pub bounds: Bounds,
    /// Pairs that `neigh_modify exclude` takes away: no bonds when families are found, no short-range contact.
    pub excluded: Option<Excluded<'a>>,
}

impl PeriView<'_> {
    /// Whether a rule takes this pair away.
    #[inline]
    pub fn excludes(&self, i: u32, j: u32) -> bool {
        self.excluded.is_some_and(|rules| rules.pair(i as usize, j as usize))
    }
}
