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
    /// Temperatures of particles; empty where they have no effect.
    pub(crate) temperature: &'a [f64],
    /// Nothing flows.
    pub(crate) frozen: bool,
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
    let Continuum { memory, last, energy, stress, inverse, whole, flowed, .. } = continuum;
    let n = sites.count;
    flowed.resize(if rules.temperature.is_empty() { 0 } else { n }, 0.0);
    energy.resize(n, 0.0);
    stress.resize(n, [0.0; 6]);
    let remembers = !memory.is_empty();
    let (columns, memory, last) = (Shared::new(columns), Shared::new(memory), Shared::new(last));
    let (energy, stress, heated) = (Shared::new(energy), Shared::new(stress), !flowed.is_empty());
    let flowed = Shared::new(flowed);
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
                    let temperature = rules.temperature.get(p).copied();
                    // Materials flow in every evaluation; places that are tried leave no memory.
                    let moment = Moment { dt, temperature, spacing, advance: settling.keep };
                    let strain = sites.strain.get(site).copied().unwrap_or(0.0);
                    let how = How { moment, strain, frozen: rules.frozen };
                    let own = settled(material, &bonds, past.as_mut(), &how).unwrap_or_else(|why| {
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
            if heated {
                // SAFETY: each site is settled once.
                unsafe { flowed.get(site..site + 1)[0] = own.dissipated * rules.volume[p] };
            }
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
    /// E without thermal strain, P, W and the temperature of the last step.
    last: &'a mut [f64],
}

impl Past<'_> {
    fn remembered(&self) -> Memory {
        self.memory.first_chunk().map_or_else(Memory::default, |row| Memory::from_numbers(*row))
    }

    /// P and W of the last step, if E and the temperature were these.
    fn answered(&self, e: &Mat3, temperature: f64) -> Option<(Mat3, f64)> {
        let (known, rest) = self.last.split_at(9);
        let (p, w) = rest.split_at(9);
        let same = known == e.as_flattened() && w[1] == temperature;
        same.then(|| (std::array::from_fn(|a| std::array::from_fn(|c| p[3 * a + c])), w[0]))
    }

    /// Keeps what a step that advances has come to.
    fn keep(&mut self, e: &Mat3, temperature: f64, response: &Response) {
        self.memory.copy_from_slice(&response.memory.numbers());
        self.last[..9].copy_from_slice(e.as_flattened());
        self.last[9..18].copy_from_slice(response.piola.as_flattened());
        (self.last[18], self.last[19]) = (response.energy, temperature);
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
    /// A site with this deformation, stress and energy.
    fn new(bonds: &Bonds, strain: &Strain, piola: &Mat3, energy: f64) -> Self {
        let piola = &strain.whole(piola);
        let mut pull = times(piola, bonds.inverse);
        for (row, e) in pull.iter_mut().zip(&strain.e) {
            row.iter_mut().zip(e).for_each(|(m, e)| *m -= bonds.gamma * e);
        }
        let stress = kirchhoff(piola, &deformation(&strain.e));
        Self { pull, gamma: bonds.gamma, stress, energy, ..Self::default() }
    }
}

/// How a site is settled.
struct How {
    moment: Moment,
    /// Thermal strain.
    strain: f64,
    /// Nothing flows.
    frozen: bool,
}

/// The strain of a site.
struct Strain {
    /// E = F − 1.
    e: Mat3,
    /// The same without thermal strain: F/(1 + ε) − 1, what materials answer to.
    mechanical: Mat3,
    /// 1 + ε.
    thermal: f64,
}

impl Strain {
    fn new(e: Mat3, thermal: f64) -> Self {
        if thermal == 0.0 {
            // To the last bit.
            return Self { e, mechanical: e, thermal: 1.0 };
        }
        let mut mechanical = e;
        for (k, row) in mechanical.iter_mut().enumerate() {
            row[k] -= thermal;
            row.iter_mut().for_each(|x| *x /= 1.0 + thermal);
        }
        Self { e, mechanical, thermal: 1.0 + thermal }
    }

    /// ∂W/∂F from the derivative by F/(1 + ε).
    fn whole(&self, piola: &Mat3) -> Mat3 {
        if self.thermal == 1.0 { *piola } else { piola.map(|row| row.map(|p| p / self.thermal)) }
    }
}

/// Settles one site; what it remembers moves on where the moment advances.
#[inline]
fn settled(
    material: Option<&Material>,
    bonds: &Bonds,
    past: Option<&mut Past>,
    how: &How,
) -> Result<Settled, Failure> {
    let at_rest = Settled { gamma: bonds.gamma, ..Settled::default() };
    let Some(material) = material else { return Ok(at_rest) };
    let moment = &how.moment;
    let Some(past) = past else {
        if bonds.h == [[0.0; 3]; 3] && how.strain == 0.0 {
            // To the last bit.
            return Ok(at_rest);
        }
        let strain = Strain::new(gradient(&bonds.h, bonds.inverse), how.strain);
        let response = material.respond(&deformation(&strain.mechanical), &Memory::default(), moment)?;
        return Ok(Settled::new(bonds, &strain, &response.piola, response.energy));
    };
    let strain = Strain::new(gradient(&bonds.h, bonds.inverse), how.strain);
    let (e, memory) = (&strain.mechanical, past.remembered());
    if how.frozen {
        let response = material.frozen(&deformation(e), &memory)?;
        return Ok(Settled::new(bonds, &strain, &response.piola, response.energy));
    }
    let temperature = moment.temperature.unwrap_or(0.0);
    let known = past.answered(e, temperature).filter(|_| !moment.advance || *e == [[0.0; 3]; 3]);
    if let Some((piola, energy)) = known {
        return Ok(Settled::new(bonds, &strain, &piola, energy));
    }
    let response = material.respond(&deformation(e), &memory, moment)?;
    if moment.advance {
        past.keep(e, temperature, &response);
    }
    let Response { dissipated, released, .. } = response;
    Ok(Settled { dissipated, released, ..Settled::new(bonds, &strain, &response.piola, response.energy) })
}
