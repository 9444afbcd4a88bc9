//! The particles' core columns as plain fields.

use super::{AtomStyle, Images, Tracked};
use perigrain_base::math::body::{Quat, UNTURNED};
use perigrain_base::par;

/// Structure of arrays; every non-empty column has one entry per particle.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Particles {
    /// Which columns exist.
    pub style: AtomStyle,
    /// Identity, from 1.
    pub tag: Tracked<Vec<u32>>,
    /// Type, from 1.
    pub kind: Tracked<Vec<u16>>,
    /// Group bits.
    pub mask: Tracked<Vec<u32>>,
    /// Periodic image counts.
    pub image: Tracked<Images>,
    /// Position [length].
    pub x: Tracked<Vec<[f64; 3]>>,
    /// Velocity [length/time].
    pub v: Tracked<Vec<[f64; 3]>>,
    /// Force (force density for peridynamic particles in LAMMPS' convention).
    pub f: Tracked<Vec<[f64; 3]>>,
    /// Mass (LAMMPS' rmass: density for peridynamic particles in its convention).
    pub mass: Tracked<Vec<f64>>,
    /// Sphere: radius [length].
    pub radius: Tracked<Vec<f64>>,
    /// Sphere: angular velocity [1/time].
    pub omega: Tracked<Vec<[f64; 3]>>,
    /// Sphere: torque.
    pub torque: Tracked<Vec<[f64; 3]>>,
    /// Orientation: a unit quaternion, the real part first, that turns vectors of the body into space (`bpm/sphere`).
    pub quat: Tracked<Vec<Quat>>,
    /// Dipole moment [charge length] (`dipole`).
    pub mu: Tracked<Vec<[f64; 3]>>,
    /// Charge (`charge`, `dipole`, `full`).
    pub charge: Tracked<Vec<f64>>,
    /// Peridynamics: volume of the node [length³].
    pub volume: Tracked<Vec<f64>>,
    /// Peridynamics: position at creation [length].
    pub x0: Tracked<Vec<[f64; 3]>>,
    /// Density as the deck set it, NaN where it did not (peri and sphere styles).
    pub density: Tracked<Vec<f64>>,
    /// Molecule ID, 0 for none (styles with bonds, `fix property/atom mol`).
    pub molecule: Tracked<Vec<u32>>,
    /// The place in the order of creation, while particles stand in the order of space ([`World::line_up`]); else empty.
    ///
    /// [`World::line_up`]: super::World::line_up
    pub rank: Tracked<Vec<u32>>,
}

impl Particles {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Makes room for exactly `more` further particles.
    pub fn reserve(&mut self, more: usize) {
        self.tag.reserve_exact(more);
        self.kind.reserve_exact(more);
        self.mask.reserve_exact(more);
        self.image.reserve_exact(more);
        for column in [&mut self.x, &mut self.v, &mut self.f] {
            column.reserve_exact(more);
        }
        self.mass.reserve_exact(more);
        if self.style.sphere {
            self.radius.reserve_exact(more);
            self.omega.reserve_exact(more);
            self.torque.reserve_exact(more);
        }
        if self.style.oriented {
            self.quat.reserve_exact(more);
        }
        if self.style.dipole {
            self.mu.reserve_exact(more);
        }
        if self.style.charged {
            self.charge.reserve_exact(more);
        }
        if self.style.peri {
            self.volume.reserve_exact(more);
            self.x0.reserve_exact(more);
        }
        if self.style.own_mass() {
            self.density.reserve_exact(more);
        }
        if self.style.molecules {
            self.molecule.reserve_exact(more);
        }
    }

    /// Adds a particle with LAMMPS' defaults (radius 0.5, density 1 → mass, volume 1).
    pub fn push(&mut self, tag: u32, kind: u16, x: [f64; 3]) {
        self.tag.push(tag);
        self.kind.push(kind);
        self.mask.push(1);
        self.image.push([0; 3]);
        self.x.push(x);
        self.v.push([0.0; 3]);
        self.f.push([0.0; 3]);
        let AtomStyle { sphere, oriented, peri, sphere_mass, .. } = self.style;
        self.mass.push(if sphere_mass { 4.0 * std::f64::consts::PI / 3.0 * 0.5 * 0.5 * 0.5 } else { 1.0 });
        if sphere {
            self.radius.push(0.5);
            self.omega.push([0.0; 3]);
            self.torque.push([0.0; 3]);
        }
        if oriented {
            self.quat.push(UNTURNED);
        }
        if self.style.dipole {
            self.mu.push([0.0; 3]);
        }
        if self.style.charged {
            self.charge.push(0.0);
        }
        if peri {
            self.volume.push(1.0);
            self.x0.push(x);
        }
        if sphere || peri {
            self.density.push(f64::NAN);
        }
        if self.style.molecules {
            self.molecule.push(0);
        }
        // A particle that joins while the others are lined up was created last.
        if let Some(last) = self.rank.iter().max().copied() {
            self.rank.push(last + 1);
        }
    }

    /// Puts particles with the same columns behind the present ones.
    pub fn append(&mut self, mut more: Particles) {
        self.tag.append(&mut more.tag);
        self.kind.append(&mut more.kind);
        self.molecule.append(&mut more.molecule);
        self.mask.append(&mut more.mask);
        self.image.append(&mut more.image);
        self.quat.append(&mut more.quat);
        for (own, new) in [
            (&mut self.x, &mut more.x),
            (&mut self.v, &mut more.v),
            (&mut self.f, &mut more.f),
            (&mut self.omega, &mut more.omega),
            (&mut self.torque, &mut more.torque),
            (&mut self.x0, &mut more.x0),
            (&mut self.mu, &mut more.mu),
        ] {
            own.append(new);
        }
        for (own, new) in [
            (&mut self.mass, &mut more.mass),
            (&mut self.radius, &mut more.radius),
            (&mut self.volume, &mut more.volume),
            (&mut self.density, &mut more.density),
            (&mut self.charge, &mut more.charge),
        ] {
            own.append(new);
        }
    }

    /// Keeps the particle `old[k]` at each new index `k`.
    pub fn gather(&mut self, old: &[usize]) {
        // Columns of one type take turns in one place more: memory that comes and goes costs more than the copies.
        fn pick<T: Copy + Send + Sync>(columns: &mut [&mut Vec<T>], old: &[usize]) {
            let mut spare = Vec::new();
            for column in columns.iter_mut().filter(|c| !c.is_empty()) {
                spare.resize(old.len(), column[0]);
                let from = &column[..];
                par::each((&mut spare[..], old), |_, (spare, old)| {
                    spare.iter_mut().zip(old).for_each(|(to, &k)| *to = from[k]);
                });
                std::mem::swap(*column, &mut spare);
            }
        }
        self.image.gather(old);
        pick(&mut [&mut self.kind], old);
        pick(&mut [&mut self.tag, &mut self.mask, &mut self.molecule, &mut self.rank], old);
        let numbers = &mut [
            &mut *self.mass,
            &mut *self.radius,
            &mut *self.volume,
            &mut *self.density,
            &mut *self.charge,
        ];
        pick(numbers, old);
        pick(&mut [&mut self.quat], old);
        let mut vectors: [&mut Vec<_>; 7] = [
            &mut self.x,
            &mut self.v,
            &mut self.f,
            &mut self.omega,
            &mut self.torque,
            &mut self.x0,
            &mut self.mu,
        ];
        pick(&mut vectors, old);
    }

    /// The index of the particle with this tag.
    pub fn index_of(&self, tag: u32) -> Option<usize> {
        let guess = (tag as usize).wrapping_sub(1);
        if self.tag.get(guess) == Some(&tag) {
            return Some(guess);
        }
        self.tag.iter().position(|&t| t == tag)
    }

    /// Largest molecule ID in use (0 when there are none).
    pub fn last_molecule(&self) -> u32 {
        self.molecule.iter().copied().max().unwrap_or(0)
    }

    /// Largest tag in use (0 when empty).
    pub fn last_tag(&self) -> u32 {
        self.tag.iter().copied().max().unwrap_or(0)
    }
}
