//! What two particles of a bond-based solid do to each other: their bond, and short-range repulsion.

use crate::shared::built_at;
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{Vec3, length, scale};
use perigrain_neigh::list::{Pair, Reach, View, Wanted, difference, pairs};
use perigrain_peri::families::{Families, ForceUnit, PeriView};
use perigrain_styles::near::bonds;
use perigrain_styles::peri_view::view;
use perigrain_styles::probe::{Interaction, Probe, Request};
use perigrain_world::World;

/// Evaluates the pairs of `peri/pmb` one by one.
pub struct BondProbe;

/// The pairs of particles within their horizon and a skin, where some types have coefficients.
fn near(w: &World, x: &[Vec3], families: &Families, view: &PeriView, skin: f64) -> Vec<Pair> {
    let (p, mut wanted) = (&w.particles, Wanted::new(w.types));
    for (a, b) in (1..=w.types as u16).flat_map(|a| (a..=w.types as u16).map(move |b| (a, b))) {
        if let Some(coeff) = families.table.get(a, b) {
            wanted.set(a, b, Reach::Fixed(coeff.horizon));
        }
    }
    let places = View { x, tag: &p.tag, kind: &p.kind, radius: &p.radius, period: w.periods() };
    pairs(&places, &wanted, skin, &|i, j| !view.excludes(i as u32, j as u32))
}

/// Force on the first, positive where it pushes apart, and energy of a pair at the distance `r`.
fn law(families: &Families, view: &PeriView, [i, j]: [usize; 2], r: f64, bonded: bool) -> [f64; 2] {
    let Some(coeff) = families.table.get(view.kind[i], view.kind[j]) else { return [0.0; 2] };
    let options = &families.options;
    let volume = match options.unit {
        ForceUnit::Density => view.volume[j],
        ForceUnit::Newton => view.volume[i] * view.volume[j],
    };
    let (mut force, mut energy) = (0.0, 0.0);
    let contact = options.contact_range(view, i as u32, j as u32);
    if !options.no_repulsion && r < contact {
        let k = 15.0 * coeff.c * volume * (r - contact) / coeff.horizon;
        force -= k;
        energy += 0.5 * k * (r - contact);
    }
    if bonded {
        let r0 = length(families.first_bond(view, i, j));
        let [pull, own] = families.bond_alone([view.kind[i], view.kind[j]], r0, r);
        force -= pull * volume;
        energy += own * volume;
    }
    [force, energy]
}

impl Probe for BondProbe {
    fn name(&self) -> &'static str {
        "peri/pmb"
    }

    fn own(&self) -> usize {
        0
    }

    fn listed(&self, w: &World) -> Result<Vec<[u32; 2]>> {
        let Some((families, view)) = w.families.as_ref().zip(view(w).ok()) else { return Ok(vec![]) };
        let near = near(w, built_at(w), families, &view, w.settings.neighbor.skin);
        Ok(near.iter().map(|p| [p.i, p.j]).collect())
    }

    fn look(&mut self, w: &World, request: Request, _closely: bool) -> Result<Vec<Interaction>> {
        let Some(families) = &*w.families else { return Ok(vec![]) };
        let view = view(w)?;
        let mut living = vec![];
        bonds(w, |i, j| living.push([i, j]));
        living.sort_unstable();
        let mut all = vec![];
        for pair in near(w, &w.particles.x, families, &view, 0.0) {
            let d: Vec3 = difference(&w.particles.x, &w.periods(), &pair);
            // LAMMPS does not recognise the images of bonded particles here.
            let known = !w.settings.lammps() || pair.shift == [0; 3];
            let bonded = known && living.binary_search(&[pair.i.min(pair.j), pair.i.max(pair.j)]).is_ok();
            let r = length(d);
            let [force, energy] = law(families, &view, [pair.i as usize, pair.j as usize], r, bonded);
            if request == Request::Idle || bonded || force != 0.0 {
                let force = scale(if r > 0.0 { force / r } else { 0.0 }, d);
                all.push(Interaction { i: pair.i, j: pair.j, d, force, energy, ..Interaction::default() });
            }
        }
        Ok(all)
    }
}
