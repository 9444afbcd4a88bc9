//! Linear systems with the tangent stiffness of a plan: a product is the difference of forces a little further along.

use super::Numbers;
use super::balance::{Balance, norm};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{Vec3, dot, sub};
use perigrain_base::par;
use perigrain_statics::coarse::Coarse;
use perigrain_statics::precond::Blocks;
use perigrain_statics::six::Six;
use perigrain_statics::{minres, pcg};
use std::cell::RefCell;

/// Displacements that forces are differentiated with, in distances of neighbours: stretches of 1e-6 are far above
/// rounding and far below where bonds bend the force.
pub(super) const SMALL: f64 = 1e-6;
/// Products of one linear system at most.
const PRODUCTS: usize = 2000;

/// A spring between two particles beside the bonds: β n nᵀ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring {
    pub ends: [usize; 2],
    /// From the first to the second, of length 1.
    pub n: Vec3,
    /// β [force/length].
    pub stiffness: f64,
}

impl Spring {
    /// How far the ends move apart.
    pub fn opens(&self, field: &[Six]) -> f64 {
        let of = |end: usize| [field[end][0], field[end][1], field[end][2]];
        dot(self.n, sub(of(self.ends[1]), of(self.ends[0])))
    }

    /// Adds a pull that moves the ends apart.
    pub fn pull(&self, pull: f64, rows: &mut [Six]) {
        for d in 0..3 {
            rows[self.ends[0]][d] -= pull * self.n[d];
            rows[self.ends[1]][d] += pull * self.n[d];
        }
    }
}

impl Balance<'_> {
    /// Solves K u = load with the tangent stiffness at `base`, where the forces are `here`, from `field` on, until `forcing` of the
    /// load is left. With a spring beside the bonds K need not be definite (minimal residuals, from zero on).
    pub(super) fn solve(
        &mut self,
        at: (&[[f64; 3]], &[[f64; 3]]),
        load: &[Six],
        field: &mut [Six],
        (forcing, beside): (f64, Option<&Spring>),
        made: &mut Numbers,
    ) -> Result<()> {
        let goal = forcing * norm(load);
        let (blocks, network) = (std::mem::take(&mut self.blocks), std::mem::take(&mut self.body.network));
        let parts_of = |blocks: &Blocks| Coarse::of_families(&network, blocks);
        // Clusters from the first step on: load steps after load steps use them.
        let coarse = self.coarse.take().or_else(|| (network.bonds() > 0).then(|| parts_of(&blocks)));
        let me = RefCell::new(&mut *self);
        let (failed, products) = (RefCell::new(None), RefCell::new(0));
        let product = |p: &[Six], out: &mut [Six]| {
            out.fill([0.0; 6]);
            if failed.borrow().is_some() {
                return;
            }
            match me.borrow_mut().differences(at, p, out) {
                Ok(made) => *products.borrow_mut() += usize::from(made),
                Err(e) => *failed.borrow_mut() = Some(e),
            }
            if let Some(spring) = beside {
                spring.pull(spring.stiffness * spring.opens(p), out);
            }
        };
        let make = || parts_of(&blocks);
        let mut by = match network.bonds() {
            0 => pcg::Preconditioner::plain(&blocks),
            _ => pcg::Preconditioner::again(&blocks, &make, coarse),
        };
        let solved = match beside {
            None => pcg::solve(product, &mut by, Some(load), field, 0.0, PRODUCTS, |progress| {
                progress.residual <= goal
            }),
            Some(_) => minres::solve(product, &mut by, load, field, (forcing, PRODUCTS)),
        };
        let coarse = by.kept(&solved);
        let (failed, products) = (failed.into_inner(), products.into_inner());
        (self.coarse, self.blocks, self.body.network) = (coarse, blocks, network);
        made.products += products;
        self.w.particles.x.copy_from_slice(at.0);
        match failed {
            Some(e) => Err(e),
            None => Ok(()),
        }
    }

    /// K p at `base`, where the forces are `here`. `false`: p moves nothing.
    fn differences(
        &mut self,
        (base, here): (&[[f64; 3]], &[[f64; 3]]),
        p: &[Six],
        out: &mut [Six],
    ) -> Result<bool> {
        let most = p.iter().flat_map(|u| &u[..3]).fold(0.0, |m: f64, a| m.max(a.abs()));
        if most == 0.0 {
            return Ok(false);
        }
        let step = SMALL * self.body.size / most;
        for ((x, from), u) in self.w.particles.x.iter_mut().zip(base).zip(p) {
            *x = std::array::from_fn(|d| from[d] + step * u[d]);
        }
        self.residual(false)?;
        let columns = (&mut *out, here, &self.w.particles.f[..], &self.body.weight[..]);
        par::each(columns, |_, (out, here, there, weight)| {
            for (k, out) in out.iter_mut().enumerate() {
                let of = |d: usize| (here[k][d] - there[k][d]) * weight[k] / step;
                *out = [of(0), of(1), of(2), 0.0, 0.0, 0.0];
            }
        });
        Ok(true)
    }
}
