//! Short-range repulsion: unbonded pairs that are near, and bonded ones that are squeezed.

pub mod hits;
mod meet;
pub mod memory;
pub mod near;
pub mod pressed;

use std::sync::Mutex;

use crate::families::shares::Shares;
use crate::families::view::Sums;
use crate::families::{Families, FamilyOptions, ForceUnit, Influence, PeriTally, PeriView, PmbTable};
use hits::Rules;
use memory::Memory;
use perigrain_base::math::vec3::length;
use perigrain_base::par;

/// Everything a pair's repulsion depends on, and where it goes.
pub struct Repulsion<'a, 'b, 't> {
    /// Particles.
    pub view: &'a PeriView<'a>,
    /// Coefficients.
    pub table: &'a PmbTable,
    /// Rules.
    pub options: &'a FamilyOptions,
    /// Forces, added to.
    pub f: &'b mut [[f64; 3]],
    /// Energy and virial, added to.
    pub tally: Option<&'b mut PeriTally<'t>>,
}

impl Repulsion<'_, '_, '_> {
    /// The push of a broken bond of this shape that is shorter than at the start: c w s as before it broke.
    fn broken(&mut self, i: usize, j: usize, length: f64, (shape, weight): (Influence, f64)) {
        let view = self.view;
        let Some(coeff) = self.table.get(view.kind[i], view.kind[j]) else { return };
        let d = view.bounds.nearest([0, 1, 2].map(|k| view.x[i][k] - view.x[j][k]));
        let r = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let s = r / length - 1.0;
        if s >= 0.0 || r == 0.0 {
            return;
        }
        let c = coeff.c * shape.shape(length, coeff.horizon) * weight;
        let pull = -c * s / r;
        let ((vi, vj), newton) = ((view.volume[i], view.volume[j]), self.options.unit == ForceUnit::Newton);
        let (own, far) = if newton { (vi * vj, vi * vj) } else { (vj, vi) };
        for k in 0..3 {
            self.f[i][k] += d[k] * pull * own;
            self.f[j][k] -= d[k] * pull * far;
        }
        if let Some(t) = self.tally.as_deref_mut() {
            let e = 0.25 * c * s * s * length;
            add(t, (i, e * own), (j, e * far), pull * vi * vj, d);
        }
    }
}

/// The pushes of all broken bonds under `peri_modify broken compress yes`, in the order of particles.
pub fn push_apart(families: &Families, repulsion: &mut Repulsion) {
    if !families.options.compress {
        return;
    }
    let view = repulsion.view;
    // State-based solids push with their short-range modulus, which has no shape.
    let states = !families.law.kind.bond_based;
    let shape = if states { Influence::One } else { families.law.influence };
    for i in (0..families.damaged.len()).filter(|&i| families.damaged[i]) {
        families.each(i, |n| {
            let j = n.partner as usize;
            if n.alive || j < i {
                return;
            }
            let Some(coeff) = families.table.get(view.kind[i], view.kind[j]) else { return };
            let length = length(families.first_bond(view, i, j));
            let weight = families.share_of(i, &n, length, coeff.horizon);
            repulsion.broken(i, j, length, (shape, weight));
        });
    }
}

/// Adds energies of both ends and the virial of the force `pull` times `d` on the first.
pub fn add(t: &mut PeriTally, (i, e_i): (usize, f64), (j, e_j): (usize, f64), pull: f64, d: [f64; 3]) {
    t.energy += e_i + e_j;
    t.add_virial(i, j, pull, d);
    if let Some(atoms) = t.per_atom_energy.as_deref_mut() {
        atoms[i] += e_i;
        atoms[j] += e_j;
    }
}

/// All repulsion of one step: near pairs that may be `closer` by now than their gap was, then squeezed bonds; of several ranks each evaluates
/// pairs of its own particles where `shares` are given. `rows` is scratch.
pub fn repel(
    families: &Families,
    (closer, shares): ([f64; 2], Option<&Shares>),
    repulsion: &mut Repulsion,
    (memory, rows): (&mut Memory, &mut Vec<Sums>),
) {
    let Memory { near, hits, close, pressed, stiff } = memory;
    let rules = Rules::new(repulsion.view, &families.table, &families.options, stiff);
    hits.resize_with(par::most_threads().max(hits.len()), Mutex::default);
    let found = &families.near;
    for (part, near) in near.iter_mut().enumerate() {
        let closer = closer[part];
        let scene = (repulsion.view, &families.options);
        near.follow(&found.pairs[part], (closer, found.allowed[part]), scene, shares);
        let to = (&mut *repulsion.f, repulsion.tally.as_deref_mut());
        near.push(families.form(), &rules, (closer, shares), to, (hits, rows));
    }
    pressed::squeezed(families, &rules, (close, pressed), repulsion);
}
