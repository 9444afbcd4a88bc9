//! What the families at both ends of a bond bear along it, from their deformation gradients.

use crate::families::{Criterion, Families, PeriView};
use crate::kinematics::{Tensor, determinant, green_lagrange, neo_hooke, von_mises};
use perigrain_base::math::vec3::{Vec3, sub};
use perigrain_base::par;

/// Families of which more than this share is broken are torn, as those of `compute peri/stress/atom` by default.
const TORN: f64 = 0.7;

/// Stress or strain of each particle: xx yy zz xy xz yz, or Mises' stress in the first place; `None` of torn families and of those
/// without a gradient.
pub(super) struct Ends(Vec<Option<[f64; 6]>>);

impl Ends {
    /// Of all particles as they are.
    pub(super) fn of(families: &Families, view: &PeriView) -> Self {
        let mut all = vec![None; view.x.len()];
        par::each(&mut all[..], |start, all: &mut [Option<[f64; 6]>]| {
            for (i, own) in (start..).zip(all) {
                let size = families.family_size.get(i).copied().unwrap_or(0);
                if size > 0 && !families.torn(view, i, TORN) {
                    *own = families.gradient(view, i).and_then(|f| families.borne(i, view.kind[i], &f));
                }
            }
        });
        Self(all)
    }

    /// The mean over the ends of a bond that are not torn; 0 where both are.
    pub(super) fn measure(&self, families: &Families, view: &PeriView, ends: [usize; 2]) -> f64 {
        let [i, j] = ends;
        let along = match families.options.criterion {
            Criterion::Shear(_) => None,
            // A strain is one of the undeformed body, a Cauchy stress one of the body as it is.
            Criterion::Strain(_) => Some(families.first_bond(view, i, j)),
            _ => Some(view.bounds.nearest(sub(view.x[j], view.x[i]))),
        };
        let (mut sum, mut count) = (0.0, 0.0);
        for own in ends.iter().filter_map(|p| self.0[*p].as_ref()) {
            sum += along.map_or(own[0], |n| normal(own, n));
            count += 1.0;
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }
}

/// n·t·n for a direction of any length.
fn normal(t: &[f64; 6], n: Vec3) -> f64 {
    let [x, y, z] = n;
    let sum = t[0] * x * x + t[1] * y * y + t[2] * z * z + 2.0 * (t[3] * x * y + t[4] * x * z + t[5] * y * z);
    sum / (x * x + y * y + z * z)
}

impl Families {
    /// What a particle's family, of a type, bears under a deformation gradient, as the criterion has it.
    fn borne(&self, i: usize, kind: u16, f: &Tensor) -> Option<[f64; 6]> {
        if let Criterion::Strain(_) = self.options.criterion {
            return Some(green_lagrange(f));
        }
        let own = self.law.of(kind);
        let stress = match self.law.kind.correspondence {
            // That of its material, in the last evaluation.
            true => self.state(i)?.stress.map(|tau| tau / determinant(f)),
            false => neo_hooke(f, own.bulk, own.shear)?,
        };
        match self.options.criterion {
            Criterion::Shear(_) => Some([von_mises(&stress), 0.0, 0.0, 0.0, 0.0, 0.0]),
            _ => Some(stress),
        }
    }
}
