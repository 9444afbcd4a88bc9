//! Whether images of grains are such that the fast loop can take them: each pair in one of them at most.

use super::super::shared::made_at;
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par;
use perigrain_contact::fast::{Fast, MOST_GRAINS};
use perigrain_neigh::tiles::{edges, shift_of};
use perigrain_world::World;

/// Whether the fast loop can take these particles.
pub fn suits(w: &World, period: Periods, fast: &Fast) -> bool {
    let p = &w.particles;
    let most = par::best(&p.radius, 0.0, f64::max);
    let more = w.rebuild.kept.reach(w.settings.neighbor.skin) + fast.span(most);
    let fits =
        period.repeats_where_it_leans() && w.families.is_none() && !p.is_empty() && p.len() <= MOST_GRAINS;
    fits && !meet_twice(w, period, most, more)
}

/// Most grains whose images are looked at one by one.
const FEW: usize = 64;

/// Whether two grains might meet in two images at once, with surfaces up to `more` apart, or one meets itself.
fn meet_twice(w: &World, period: Periods, most: f64, more: f64) -> bool {
    let (radius, x) = (&w.particles.radius, made_at(w));
    let shortest = period.heights().into_iter().filter(|l| *l > 0.0).fold(f64::INFINITY, f64::min);
    if 2.0 * (2.0 * most + more) <= shortest {
        return false;
    }
    // In two images the larger distance is half a height of the box at least.
    let large: Vec<usize> =
        (0..radius.len()).filter(|&i| 2.0 * (radius[i] + most + more) > shortest).collect();
    let [edge, reach] = edges(radius, more);
    if large.len() > FEW || edge == reach || reach > shortest {
        return true;
    }
    let twice = |i: usize, j: usize| {
        let reach = radius[i] + radius[j] + more;
        let near = |image: &u32| {
            let shift = shift_of(*image);
            let by = period.shift(shift);
            let d: Vec3 = std::array::from_fn(|d| x[i][d] - (x[j][d] + by[d]));
            let absent = (0..3).any(|d| period.length[d] == 0.0 && shift[d] != 0.0);
            !absent && d.iter().map(|d| d * d).sum::<f64>() < reach * reach
        };
        (0..27).filter(near).count() > 1
    };
    large.iter().enumerate().any(|(k, &i)| large[k + 1..].iter().any(|&j| twice(i, j)))
}
