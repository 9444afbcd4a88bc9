//! Shape tensors of families, K = Σ ω w xi⊗xi V over living bonds, and their inverses.

use crate::cauchy::LAST;
use crate::families::{Families, PeriView};
use crate::kinematics::{HINGE, Shapes, Tensor, inverse, least_eigenvalue};
use perigrain_base::par;
use perigrain_constitutive::Memory;

/// Whole families whose least eigenvalue of K is below this share of the sum of all three lie in a plane or on a line, up to rounding: an arc
/// cosine near 1 keeps half of the digits.
const FLAT: f64 = 1e-7;

impl Families {
    /// Gets sites ready for correspondence, when families are found: what they remember, and the shape tensors of whole families.
    pub(crate) fn begin_correspondence(&mut self, view: &PeriView) {
        let shapes = self.all_shapes(view);
        let remembers = self.law.materials.iter().flatten().any(|material| material.remembers());
        let least = |p: &u32| shapes.get(*p as usize).map_or(0.0, |shapes| least(&shapes.whole));
        for (own, particle) in self.continua() {
            own.whole = particle.iter().map(least).collect();
            (own.memory, own.last) = (vec![], vec![]);
            if remembers {
                own.last = vec![0.0; LAST * particle.len()];
                own.memory = particle.iter().flat_map(|_| Memory::default().numbers()).collect();
            }
            own.inverse.clear();
        }
        self.put_shapes(&shapes);
    }

    /// Finds K⁻¹ where it is not known: of families from restart files, and where volumes or coefficients have changed.
    pub(crate) fn find_shapes(&mut self, view: &PeriView) {
        if self.continua().all(|(own, particle)| own.inverse.len() == particle.len()) {
            return;
        }
        let shapes = self.all_shapes(view);
        self.put_shapes(&shapes);
    }

    fn put_shapes(&mut self, shapes: &[Shapes]) {
        for (own, particle) in self.continua() {
            let one = |(p, whole): (&u32, &f64)| {
                shapes.get(*p as usize).map_or([0.0; 6], |shapes| shapes.inverse(*whole))
            };
            own.inverse = particle.iter().zip(&own.whole).map(one).collect();
        }
    }

    /// Finds K⁻¹ of some particles anew, whose bonds have broken.
    pub(crate) fn reshape(&mut self, view: &PeriView, ends: &[[u32; 2]]) {
        for &p in ends.as_flattened() {
            let shapes = self.shapes(view, p as usize);
            if let Some((own, site)) = self.continuum_of(p as usize)
                && let (Some(whole), Some(inverse)) = (own.whole.get(site), own.inverse.get_mut(site))
            {
                *inverse = shapes.inverse(*whole);
            }
        }
    }

    fn all_shapes(&self, view: &PeriView) -> Vec<Shapes> {
        let mut shapes = vec![Shapes::default(); self.place.len()];
        par::each(&mut shapes[..], |start, shapes| {
            for (k, own) in shapes.iter_mut().enumerate() {
                *own = self.shapes(view, start + k);
            }
        });
        shapes
    }
}

/// The least eigenvalue of the K of a whole family; 0 of a flat one.
fn least(k: &Tensor) -> f64 {
    let least = least_eigenvalue(k);
    if least > FLAT * (k[0][0] + k[1][1] + k[2][2]) { least } else { 0.0 }
}

impl Shapes {
    /// K⁻¹ of the living bonds: xx yy zz xy xz yz; zeros of a torn family, whose least eigenvalue is below [`HINGE`] of that of the
    /// `whole` one.
    fn inverse(&self, whole: f64) -> [f64; 6] {
        if whole <= 0.0 || least_eigenvalue(&self.left) < HINGE * whole {
            return [0.0; 6];
        }
        inverse(&self.left).map_or([0.0; 6], |k| [k[0][0], k[1][1], k[2][2], k[0][1], k[0][2], k[1][2]])
    }
}
