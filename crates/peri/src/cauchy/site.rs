//! Between the sweeps of correspondence: from Σ ω w eta⊗xi V to what forces read at both ends of a bond.

use crate::cauchy::{Continuum, LAST};
use crate::families::lattice::PAD;
use crate::law::settle::{Settling, Sites};
use crate::law::state::SiteState;
use perigrain_base::math::vec3::SIX;
use perigrain_base::par::{self, CHUNK, Shared};
use perigrain_constitutive::{Failure, Mat3, Material, Memory, Moment, Response};

/// Where the sums and the numbers of sites are in their tables.
#[derive(Clone, Copy)]
pub(crate) struct Places {
    /// Unused entries.
    first: usize,
    /// How far sites are apart.
    site: usize,
    /// How far the numbers of a site are apart.
    entry: usize,
    /// How many numbers a row of its matrix has.
    row: usize,
}

/// Numbers of each record of a list: rows of M, each with γ behind it.
pub(crate) const ROW: usize = 12;

impl Places {
    /// Of a list: the numbers of a record beside each other.
    pub(crate) const RECORDS: Self = Self { first: 0, site: ROW, entry: 1, row: 4 };

    /// Of a lattice: columns of cells, so far apart.
    pub(crate) fn columns(stride: usize) -> Self {
        Self { first: PAD, site: 1, entry: stride, row: 3 }
    }

    /// The place of an entry of a site's matrix.
    #[inline(always)]
    pub(crate) fn at(&self, site: usize, a: usize, c: usize) -> usize {
        self.first + site * self.site + (self.row * a + c) * self.entry
    }

    /// Calls `put` with the places of γ.
    #[inline(always)]
    fn controls(&self, site: usize, mut put: impl FnMut(usize)) {
        match self.row {
            3 => put(self.at(site, 3, 0)),
            _ => (0..3).for_each(|a| put(self.at(site, a, 3))),
        }
    }
}

/// What settles sites besides their sums.
pub(crate) struct Rules<'a> {
    /// By type − 1.
    pub(crate) materials: &'a [Option<Material>],
    /// g of node control.
    pub(crate) control: f64,
    /// The step.
    pub(crate) dt: f64,
    /// Volumes of particles.
    pub(crate) volume: &'a [f64],
}

/// E = H K⁻¹ of a site with these sums H.
#[inline(always)]
pub(crate) fn gradient(h: &Mat3, inverse: &[f64; 6]) -> Mat3 {
    times(h, inverse)
}

/// A matrix times a symmetric one: xx yy zz xy xz yz.
#[inline(always)]
fn times(m: &Mat3, [xx, yy, zz, xy, xz, yz]: &[f64; 6]) -> Mat3 {
    m.map(|[x, y, z]| [x * xx + y * xy + z * xz, x * xy + y * yy + z * yz, x * xz + y * yz + z * zz])
}

/// 1 + E.
#[inline(always)]
pub(crate) fn deformation(e: &Mat3) -> Mat3 {
    let mut f = *e;
    (0..3).for_each(|k| f[k][k] += 1.0);
    f
}

/// P Fᵀ: xx yy zz xy xz yz.
#[inline(always)]
fn kirchhoff(p: &Mat3, f: &Mat3) -> [f64; 6] {
    SIX.map(|(a, b)| p[a][0] * f[b][0] + p[a][1] * f[b][1] + p[a][2] * f[b][2])
}

/// What the sites of a chunk bring about.
#[derive(Clone, Default)]
struct Made {
    /// Heat, and fracture energy of damage: over volumes.
    lost: [f64; 2],
    /// Sites that bear nothing any more.
    spent: Vec<u32>,
    /// The first site without a stress.
    fault: Option<(u32, Failure)>,
}

/// Settles all sites of a body; those without bonds, or with torn families, exert nothing. What materials remember moves on in an evaluation
/// that advances.
pub(crate) fn settle(
    settling: &Settling,
    state: &mut SiteState,
    sites: &Sites,
    places: Places,
    rules: &Rules,
) {
    let SiteState { weighted, columns, sums, continuum, .. } = state;
    let Continuum { memory, last, energy, stress, inverse, whole, .. } = continuum;
    let n = sites.count;
    energy.resize(n, 0.0);
    stress.resize(n, [0.0; 6]);
    let remembers = !memory.is_empty();
    let (columns, memory, last) = (Shared::new(columns), Shared::new(memory), Shared::new(last));
    let (energy, stress) = (Shared::new(energy), Shared::new(stress));
    let mut made = vec![Made::default(); n.div_ceil(CHUNK)];
    let all = Shared::new(&mut made);
    par::for_chunks(n, |range| {
        let chunk = range.start / CHUNK;
        // SAFETY: each chunk of sites is settled once, and has these entries to itself.
        let (energy, stress, made) = unsafe {
            (energy.get(range.clone()), stress.get(range.clone()), &mut all.get(chunk..chunk + 1)[0])
        };
        let mut size = Size::default();
        for (k, site) in range.enumerate() {
            let p = sites.particle[site] as usize;
            // SAFETY: each site is settled once, and its rows are there where materials remember.
            let mut past = remembers.then(|| unsafe {
                let row = |numbers: usize| site * numbers..(site + 1) * numbers;
                Past { memory: memory.get(row(Memory::NUMBERS)), last: last.get(row(LAST)) }
            });
            let own = match sites.kind.get(p).filter(|_| inverse[site][0] > 0.0) {
                Some(kind) => {
                    let kind = usize::from(*kind) - 1;
                    let bonds = Bonds {
                        h: std::array::from_fn(|a| std::array::from_fn(|c| sums[places.at(site, a, c)])),
                        inverse: &inverse[site],
                        gamma: rules.control * settling.stiffness[kind].shear / weighted[sites.pad + site],
                    };
                    let material = rules.materials.get(kind).and_then(Option::as_ref);
                    let volume = rules.volume[p];
                    let (dt, spacing) = (rules.dt, size.of(volume));
                    let moment = Moment { dt, temperature: None, spacing, advance: settling.advance };
                    let own = settled(material, &bonds, past.as_mut(), &moment).unwrap_or_else(|why| {
                        made.fault.get_or_insert((site as u32, why));
                        Settled::default()
                    });
                    made.lost[0] += own.dissipated * volume;
                    made.lost[1] += own.released * volume;
                    own
                }
                None => Settled::default(),
            };
            let torn = inverse[site][0] <= 0.0 && whole[site] > 0.0;
            if torn || past.is_some_and(|past| past.remembered().damage >= 1.0) {
                made.spent.push(site as u32);
            }
            (energy[k], stress[k]) = (own.energy, own.stress);
            // SAFETY: places differ from site to site, and lie in the columns.
            unsafe {
                for (a, c) in (0..9).map(|k| (k / 3, k % 3)) {
                    columns.get(places.at(site, a, c)..places.at(site, a, c) + 1)[0] = own.pull[a][c];
                }
                places.controls(site, |at| columns.get(at..at + 1)[0] = own.gamma);
            }
        }
    });
    continuum.lost = made.iter().map(|made| made.lost).collect();
    continuum.spent = made.iter().flat_map(|made| &made.spent).copied().collect();
    continuum.fault = made.iter().find_map(|made| made.fault);
}

/// The edge of a cube of the last volume that was asked for.
#[derive(Default)]
struct Size {
    volume: f64,
    edge: f64,
}

impl Size {
    fn of(&mut self, volume: f64) -> f64 {
        if volume != self.volume {
            *self = Self { volume, edge: volume.cbrt() };
        }
        self.edge
    }
}

/// What the bonds of a site come to.
struct Bonds<'a> {
    /// H = Σ ω w eta⊗xi V.
    h: Mat3,
    /// K⁻¹.
    inverse: &'a [f64; 6],
    /// γ.
    gamma: f64,
}

/// What a site remembers of its material, and of the last step that advanced.
struct Past<'a> {
    /// Of its material.
    memory: &'a mut [f64],
    /// E, P and W of the last step.
    last: &'a mut [f64],
}

impl Past<'_> {
    fn remembered(&self) -> Memory {
        self.memory.first_chunk().map_or_else(Memory::default, |row| Memory::from_numbers(*row))
    }

    /// P and W of the last step, if E was this.
    fn answered(&self, e: &Mat3) -> Option<(Mat3, f64)> {
        let (known, rest) = self.last.split_at(9);
        let (p, w) = rest.split_at(9);
        let same = known == e.as_flattened();
        same.then(|| (std::array::from_fn(|a| std::array::from_fn(|c| p[3 * a + c])), w[0]))
    }

    /// Keeps what a step that advances has come to.
    fn keep(&mut self, e: &Mat3, response: &Response) {
        self.memory.copy_from_slice(&response.memory.numbers());
        self.last[..9].copy_from_slice(e.as_flattened());
        self.last[9..18].copy_from_slice(response.piola.as_flattened());
        self.last[18] = response.energy;
    }
}

/// A settled site; by itself one that exerts nothing.
#[derive(Default)]
struct Settled {
    /// M = P K⁻¹ − γ E.
    pull: Mat3,
    /// γ.
    gamma: f64,
    /// P Fᵀ.
    stress: [f64; 6],
    /// W.
    energy: f64,
    /// Plastic work of the step.
    dissipated: f64,
    /// What damage has set free in the step.
    released: f64,
}

impl Settled {
    /// A site with this gradient, stress and energy.
    fn new(bonds: &Bonds, e: &Mat3, piola: &Mat3, energy: f64) -> Self {
        let mut pull = times(piola, bonds.inverse);
        for (row, e) in pull.iter_mut().zip(e) {
            row.iter_mut().zip(e).for_each(|(m, e)| *m -= bonds.gamma * e);
        }
        let stress = kirchhoff(piola, &deformation(e));
        Self { pull, gamma: bonds.gamma, stress, energy, ..Self::default() }
    }
}

/// Settles one site; what it remembers moves on where the moment advances.
#[inline]
fn settled(
    material: Option<&Material>,
    bonds: &Bonds,
    past: Option<&mut Past>,
    moment: &Moment,
) -> Result<Settled, Failure> {
    let at_rest = Settled { gamma: bonds.gamma, ..Settled::default() };
    let Some(material) = material else { return Ok(at_rest) };
    let Some(past) = past else {
        if bonds.h == [[0.0; 3]; 3] {
            // To the last bit.
            return Ok(at_rest);
        }
        let e = gradient(&bonds.h, bonds.inverse);
        let response = material.respond(&deformation(&e), &Memory::default(), moment)?;
        return Ok(Settled::new(bonds, &e, &response.piola, response.energy));
    };
    let e = gradient(&bonds.h, bonds.inverse);
    let memory = past.remembered();
    if let Some((piola, energy)) = past.answered(&e).filter(|_| !moment.advance || e == [[0.0; 3]; 3]) {
        return Ok(Settled::new(bonds, &e, &piola, energy));
    }
    let response = material.respond(&deformation(&e), &memory, moment)?;
    if moment.advance {
        past.keep(&e, &response);
    }
    let Response { dissipated, released, .. } = response;
    Ok(Settled { dissipated, released, ..Settled::new(bonds, &e, &response.piola, response.energy) })
}
