//! Templates of molecules: the content of one file of the `molecule` command.

use super::{Angle, Bond, World};
use perigrain_base::math::body::{Quat, apply, matrix};
use std::f64::consts::PI;

/// A group of particles to be put into a scene as a whole: a molecule or a clump.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Template {
    /// The first line of the file.
    pub title: String,
    /// Number of particles.
    pub count: usize,
    /// Where they are [length]; empty if the file lacks them.
    pub places: Vec<[f64; 3]>,
    /// Their types, from 1, offsets added; empty if the file lacks them.
    pub kinds: Vec<u16>,
    /// Their radii [length]; empty if the file lacks them.
    pub radii: Vec<f64>,
    /// Their masses; empty if the file lacks them.
    pub masses: Vec<f64>,
    /// Numbers from 1 of the molecules they belong to; empty if the file lacks them.
    pub molecules: Vec<u32>,
    /// Bonds: type and the numbers of both ends, from 1.
    pub bonds: Vec<(u16, [u32; 2])>,
    /// Angles: type and the numbers of their particles, from 1, the one at the corner in the middle.
    #[serde(default)]
    pub angles: Vec<(u16, [u32; 3])>,
    /// Mass of all, if the file has it.
    pub mass: Option<f64>,
    /// Centre of mass, if the file has it [length].
    pub com: Option<[f64; 3]>,
    /// Moments of inertia about the centre of mass xx yy zz xy xz yz, if the file has them.
    pub inertia: Option<[f64; 6]>,
    /// The density by which a mixture gave it mass, centre and moments of inertia.
    #[serde(default)]
    pub density: Option<f64>,
}

impl Template {
    /// The mean of all places.
    pub fn centre(&self) -> [f64; 3] {
        let n = self.places.len().max(1) as f64;
        [0, 1, 2].map(|d| self.places.iter().map(|x| x[d]).sum::<f64>() / n)
    }

    /// Places of its particles when its centre lies at `at` and it is turned.
    pub fn turned(&self, at: [f64; 3], q: Quat) -> Vec<[f64; 3]> {
        let (centre, m) = (self.centre(), matrix(q));
        let place = |x: &[f64; 3]| {
            let d = apply(&m, [x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]]);
            [0, 1, 2].map(|k| d[k] + at[k])
        };
        self.places.iter().map(place).collect()
    }

    /// The radius of the sphere about the centre that holds all, radii included.
    pub fn extent(&self) -> f64 {
        let centre = self.centre();
        let reach = |(k, x): (usize, &[f64; 3])| {
            let d2: f64 = (0..3).map(|d| (x[d] - centre[d]) * (x[d] - centre[d])).sum();
            d2.sqrt() + self.radii.get(k).copied().unwrap_or(0.0)
        };
        self.places.iter().enumerate().map(reach).fold(0.0, f64::max)
    }

    /// The mass of each sphere: from the file, or of density 1; `None` where masses go by type.
    pub fn sphere_masses(&self) -> Option<Vec<f64>> {
        if !self.masses.is_empty() {
            return Some(self.masses.clone());
        }
        let volume = |r: &f64| 4.0 * PI / 3.0 * r * r * r;
        (!self.radii.is_empty()).then(|| self.radii.iter().map(volume).collect())
    }

    /// The largest molecule number in it; 1 where the file has none.
    pub fn last_molecule(&self) -> u32 {
        self.molecules.iter().copied().max().unwrap_or(1)
    }
}

/// How copies of a template are numbered.
#[derive(Clone, Copy, Debug)]
pub struct Numbering {
    /// The id before the first new one.
    pub tag: u32,
    /// The molecule ID before the first new one.
    pub molecule: u32,
    /// Added to the types of the template.
    pub kind: u16,
}

impl Numbering {
    /// Behind all that is there.
    pub fn behind(w: &World, kind: u16) -> Self {
        Self { tag: w.particles.last_tag(), molecule: w.particles.last_molecule(), kind }
    }
}

impl World {
    /// Puts a copy of a template with its bonds and angles at these places, which are wrapped into the box and turned by `q` as its matter is, and
    /// counts on. Which pairs count as bonded (`bonds.find_special`) and the length of other columns are for the caller to settle after the
    /// last copy.
    pub fn insert_molecule(&mut self, t: &Template, at: &[[f64; 3]], q: Quat, numbers: &mut Numbering) {
        let start = self.n();
        let masses = if self.particles.style.own_mass() { t.sphere_masses() } else { None };
        let first = numbers.tag;
        for (k, x) in at.iter().enumerate() {
            let (mut x, mut image) = (*x, [0; 3]);
            if let Some(domain) = &*self.domain {
                domain.wrap(&mut x, &mut image);
            }
            numbers.tag += 1;
            let p = &mut self.particles;
            p.push(numbers.tag, t.kinds.get(k).copied().unwrap_or(1) + numbers.kind, x);
            let i = p.x.len() - 1;
            p.image.set(i, image);
            if let (Some(r), Some(slot)) = (t.radii.get(k), p.radius.get_mut(i)) {
                *slot = *r;
            }
            if let Some(m) = masses.as_ref().and_then(|m| m.get(k)) {
                p.mass[i] = *m;
            }
            if let Some(slot) = p.molecule.get_mut(i) {
                *slot = numbers.molecule + t.molecules.get(k).copied().unwrap_or(1);
            }
        }
        self.lay(start, q);
        for (kind, ends) in &t.bonds {
            self.bonds.push(Bond::new(i32::from(*kind), ends.map(|k| first + k)));
        }
        let angles = t.angles.iter().map(|(kind, ends)| Angle { kind: *kind, ends: ends.map(|k| first + k) });
        self.bonds.angles.list.extend(angles);
        numbers.molecule += t.last_molecule();
    }
}
