//! Momentum, rotation and temperature of a group for `velocity`, summed one by one in LAMMPS' order.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use perigrain_base::math::vec3::{Vec3, cross, dot, sub};
use perigrain_styles::matter::unwrapped;
use perigrain_world::{GroupId, World};

/// The particles of a group in storage order.
pub struct Members {
    /// Their indices.
    pub list: Vec<usize>,
}

impl Members {
    /// Those of a group.
    pub fn new(w: &World, group: GroupId) -> Self {
        let list = (0..w.n()).filter(|&i| w.particles.mask[i] & group.bit() != 0).collect();
        Self { list }
    }

    /// Their velocities.
    pub fn velocities(&self, w: &World) -> Vec<Vec3> {
        self.list.iter().map(|&i| w.particles.v[i]).collect()
    }

    /// Gives them velocities, on top of the present ones with `sum`.
    pub fn write(&self, w: &mut World, v: &[Vec3], sum: bool) {
        for (&i, v) in self.list.iter().zip(v) {
            let old = if sum { w.particles.v[i] } else { [0.0; 3] };
            w.particles.v[i] = [0, 1, 2].map(|d| v[d] + old[d]);
        }
    }

    /// Takes the velocity of the centre of mass away.
    pub fn stop_drift(&self, w: &World, v: &mut [Vec3]) {
        let Some(drift) = self.mean(w, |k, _| v[k]) else { return };
        v.iter_mut().for_each(|v| *v = sub(*v, drift));
    }

    /// Takes the rotation about the centre of mass away.
    pub fn stop_rotation(&self, w: &World, v: &mut [Vec3]) {
        let Some(center) = self.mean(w, |_, i| unwrapped(w, i)) else { return };
        let arms: Vec<Vec3> = self.list.iter().map(|&i| sub(unwrapped(w, i), center)).collect();
        let (mut l, mut inertia) = ([0.0; 3], [[0.0; 3]; 3]);
        for ((&i, r), v) in self.list.iter().zip(&arms).zip(v.iter()) {
            let m = w.particles.mass[i];
            let spin = cross(*r, *v);
            for a in 0..3 {
                l[a] += m * spin[a];
                let (b, c) = ((a + 1) % 3, (a + 2) % 3);
                inertia[a][a] += m * (r[b] * r[b] + r[c] * r[c]);
                inertia[a][b] -= m * r[a] * r[b];
            }
        }
        for a in 0..3 {
            inertia[(a + 1) % 3][a] = inertia[a][(a + 1) % 3];
        }
        let omega = rotation(inertia, l, w.settings.lammps());
        for (v, r) in v.iter_mut().zip(&arms) {
            *v = sub(*v, cross(omega, *r));
        }
    }

    /// Mass-weighted mean over members (number in the list, index in the world).
    fn mean(&self, w: &World, of: impl Fn(usize, usize) -> Vec3) -> Option<Vec3> {
        let mass: f64 = self.list.iter().map(|&i| w.particles.mass[i]).sum();
        if mass <= 0.0 {
            return None;
        }
        let mut sum = [0.0; 3];
        for (k, &i) in self.list.iter().enumerate() {
            let (a, m) = (of(k, i), w.particles.mass[i]);
            sum = [0, 1, 2].map(|d| sum[d] + a[d] * m);
        }
        Some(sum.map(|s| s / mass))
    }
}

/// Temperature of these velocities: Σ m v² / ((3N − 3) k), in flat scenes (2N − 2); 0 for a single particle.
pub fn temperature(w: &World, members: &Members, v: &[Vec3]) -> f64 {
    let dimension = if w.settings.two_dimensional { 2.0 } else { 3.0 };
    let freedom = dimension * members.list.len() as f64 - dimension;
    if freedom <= 0.0 {
        return 0.0;
    }
    let mut sum = 0.0;
    for (&i, v) in members.list.iter().zip(v) {
        sum += dot(*v, *v) * w.particles.mass[i];
    }
    let c = w.settings.units.constants();
    sum * (c.mvv2e / (freedom * c.boltz))
}

/// Angular velocity ω with I ω = L. A body on a line has no rotation about it: moments below a millionth of the largest are left
/// out.
///
/// LAMMPS (`lammps`) does so only where the determinant is below 1e-6, whatever the unit, and inverts what rounding leaves of it
/// for heavy bodies on a line.
pub fn rotation(inertia: [[f64; 3]; 3], l: Vec3, lammps: bool) -> Vec3 {
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = inertia;
    let determinant = xx * yy * zz + xy * yz * xz + xz * xy * yz - xx * yz * yz - xy * xy * zz - xz * yy * xz;
    let largest = xx.max(yy).max(zz);
    let least = if lammps { 1e-6 } else { f64::max(1e-6, 1e-6 * largest * largest * largest) };
    if determinant > least {
        let rows = [
            [yy * zz - yz * yz, -(xy * zz - xz * yz), xy * yz - xz * yy],
            [-(xy * zz - yz * xz), xx * zz - xz * xz, -(xx * yz - xz * xy)],
            [xy * yz - yy * xz, -(xx * yz - xy * xz), xx * yy - xy * xy],
        ];
        return rows.map(|r| dot(r.map(|a| a / determinant), l));
    }
    let tensor = Matrix3::from_fn(|r, c| inertia[r][c]);
    let principal = SymmetricEigen::new(tensor);
    let largest = principal.eigenvalues.max();
    let along = principal.eigenvectors.transpose() * Vector3::from(l);
    let turned = along.zip_map(&principal.eigenvalues, |l, i| if i > 1e-6 * largest { l / i } else { 0.0 });
    (principal.eigenvectors * turned).into()
}
