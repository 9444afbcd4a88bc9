//! Between the sweeps of correspondence: from Σ ω w eta⊗xi V to what forces read at both ends of a bond.

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
    let n = sites.count;
    continuum.energy.resize(n, 0.0);
    continuum.stress.resize(n, [0.0; 6]);
    let mut faults: Vec<Option<(u32, Failure)>> = vec![None; n.div_ceil(CHUNK)];
    continuum.lost.clear();
    continuum.lost.resize(n.div_ceil(CHUNK), [0.0; 2]);
    let keep = settling.advance && !continuum.memory.is_empty();
    let (columns, memory) = (Shared::new(columns), Shared::new(&mut continuum.memory));
    let (energy, stress) = (Shared::new(&mut continuum.energy), Shared::new(&mut continuum.stress));
    let (lost, faults_of) = (Shared::new(&mut continuum.lost), Shared::new(&mut faults));
    let (weighted, sums, inverse): (&[f64], &[f64], &[[f64; 6]]) = (weighted, sums, &continuum.inverse);
    par::for_chunks(n, |range| {
        let chunk = range.start / CHUNK;
        // SAFETY: each chunk of sites is settled once, and has these entries to itself.
        let (energy, stress, lost, fault) = unsafe {
            (
                energy.get(range.clone()),
                stress.get(range.clone()),
                &mut lost.get(chunk..chunk + 1)[0],
                &mut faults_of.get(chunk..chunk + 1)[0],
            )
        };
        let mut size = Size::default();
        for (k, site) in range.enumerate() {
            let p = sites.particle[site] as usize;
            let shape = &inverse[site];
            let mut known = None;
            if let Some(kind) = sites.kind.get(p).filter(|_| shape[0] > 0.0) {
                let h: Mat3 = std::array::from_fn(|a| std::array::from_fn(|c| sums[places.at(site, a, c)]));
                let volume = rules.volume[p];
                let moment = Moment {
                    dt: rules.dt,
                    temperature: None,
                    spacing: size.of(volume),
                    advance: settling.advance,
                };
                let gamma = rules.control * settling.stiffness[usize::from(*kind) - 1].shear
                    / weighted[sites.pad + site];
                let row = match memory.is_empty() {
                    true => None,
                    // SAFETY: each site is settled once.
                    false => {
                        Some(unsafe { memory.get(site * Memory::NUMBERS..(site + 1) * Memory::NUMBERS) })
                    }
                };
                let before = row.as_deref().and_then(|row| row.first_chunk());
                let before = before.map_or_else(Memory::default, |row| Memory::from_numbers(*row));
                let material = rules.materials.get(usize::from(*kind) - 1).and_then(Option::as_ref);
                match settled(material, &h, (shape, gamma), &before, &moment) {
                    Ok(own) => {
                        if let Some(row) = row.filter(|_| keep) {
                            row.copy_from_slice(&own.response.memory.numbers());
                        }
                        lost[0] += own.response.dissipated * volume;
                        lost[1] += own.response.released * volume;
                        known = Some(own);
                    }
                    Err(why) => {
                        fault.get_or_insert((site as u32, why));
                    }
                }
            }
            let own = known.unwrap_or_default();
            (energy[k], stress[k]) = (own.response.energy, own.stress);
            // SAFETY: places differ from site to site, and lie in the columns.
            unsafe {
                for (a, c) in (0..9).map(|k| (k / 3, k % 3)) {
                    columns.get(places.at(site, a, c)..places.at(site, a, c) + 1)[0] = own.pull[a][c];
                }
                places.controls(site, |at| columns.get(at..at + 1)[0] = own.gamma);
            }
        }
    });
    continuum.fault = faults.into_iter().flatten().next();
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

/// A settled site.
struct Settled {
    /// M = P K⁻¹ − γ E.
    pull: Mat3,
    /// γ.
    gamma: f64,
    /// P Fᵀ.
    stress: [f64; 6],
    response: Response,
}

impl Default for Settled {
    fn default() -> Self {
        Self { pull: [[0.0; 3]; 3], gamma: 0.0, stress: [0.0; 6], response: rest(&Memory::default()) }
    }
}

/// The response of a site at which nothing has happened.
fn rest(memory: &Memory) -> Response {
    let zero = [[0.0; 3]; 3];
    Response { piola: zero, memory: *memory, energy: 0.0, dissipated: 0.0, released: 0.0, mises: 0.0 }
}

/// Settles one site from its sums H, its K⁻¹ and γ.
#[inline]
fn settled(
    material: Option<&Material>,
    h: &Mat3,
    (inverse, gamma): (&[f64; 6], f64),
    memory: &Memory,
    moment: &Moment,
) -> Result<Settled, Failure> {
    if *h == [[0.0; 3]; 3] && *memory == Memory::default() {
        // At rest, to the last bit.
        return Ok(Settled { gamma, ..Settled::default() });
    }
    let e = gradient(h, inverse);
    let f = deformation(&e);
    let response = match material {
        Some(material) => material.respond(&f, memory, moment)?,
        None => rest(memory),
    };
    let mut pull = times(&response.piola, inverse);
    for (row, e) in pull.iter_mut().zip(&e) {
        row.iter_mut().zip(e).for_each(|(m, e)| *m -= gamma * e);
    }
    Ok(Settled { pull, gamma, stress: kirchhoff(&response.piola, &f), response })
}
