//! The step that contacts stand as they are pressed now, with each other and with walls.

use crate::critical::{add_walls, solid, true_mass};
use crate::probe::Probe;
use nalgebra::{Matrix3, Matrix6, Vector3};
use perigrain_base::diag::Result;
use perigrain_base::math::lanczos::largest_eigenvalue;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, scale, sub};
use perigrain_base::par;
use perigrain_world::World;

/// Displacement and rotation, or force and torque.
type Six = [f64; 6];

/// How close the limit of damped motions is found, and in how many rounds at most.
const CLOSE: f64 = 1e-3;
const ROUNDS: usize = 12;

/// The fastest motion is looked for among so many particles around the one that lets it be expected: it is one of few of them, or in regular
/// packings of all alike, where so many show it to 1 % (20 in a row: cos² of π/42 is 0.994). The limit is too long by as much at most, not too short.
const MOST: usize = 8192;

/// The place of a particle that has no block.
const NO_BLOCK: u32 = u32::MAX;

/// A contact as a spring.
#[derive(Clone, Copy, Debug)]
struct Contact {
    first: usize,
    /// `None`: a wall.
    second: Option<usize>,
    normal: Vec3,
    /// Stiffness and damping along the normal, across it, against rolling and twisting.
    resistance: [[f64; 4]; 2],
    arms: [f64; 2],
}

impl Contact {
    /// What a step of this length makes of springs and dashpots together: Δt² k + 2 Δt c, since dashpots see velocities half a step
    /// before.
    fn over(&self, dt: f64) -> [f64; 4] {
        let [stiffness, damping] = &self.resistance;
        std::array::from_fn(|k| dt * (dt * stiffness[k] + 2.0 * damping[k]))
    }

    /// Its particles, with their arms, and with normals that lead from the other end.
    fn ends(&self) -> impl Iterator<Item = (usize, f64, Vec3)> {
        let [one, other] = self.arms;
        let second = self.second.map(|j| (j, other, scale(-1.0, self.normal)));
        [Some((self.first, one, self.normal)), second].into_iter().flatten()
    }

    /// By how much more an end can feel than if the other one stood still.
    fn shares(&self) -> f64 {
        if self.second.is_some() { 2.0 } else { 1.0 }
    }

    /// Adds what it does to the displacements and turns of a particle of these roots to the block of that.
    fn add_to(&self, block: &mut Matrix6<f64>, [arm, dt]: [f64; 2], n: Vec3, [straight, turning]: &[f64; 2]) {
        let [along, across, rolling, twisting] = self.over(dt).map(|over| self.shares() * over);
        let n = Vector3::from(n);
        let (central, aside) = (n * n.transpose(), Matrix3::identity() - n * n.transpose());
        // The slip of a turn θ is −a θ × n, of which n × is the transposed.
        let turned = n.cross_matrix() * arm;
        let mut add = |row: usize, column: usize, part: Matrix3<f64>| {
            let mut view = block.fixed_view_mut::<3, 3>(row, column);
            view += part;
        };
        add(0, 0, (central * along + aside * across) * (straight * straight));
        add(0, 3, turned * (across * straight * turning));
        add(3, 0, turned.transpose() * (across * straight * turning));
        let about = aside * (across * arm * arm + rolling) + central * twisting;
        add(3, 3, about * (turning * turning));
    }
}

/// 1/√m and 1/√I of each particle, zero of what does not move or turn.
type Roots = [[f64; 2]];

/// Calls a function with each contact there is.
type Each<'a> = dyn FnMut(&mut dyn FnMut(Contact)) -> Result<()> + 'a;

/// The longest stable step of the contacts as they are pressed now, if `dt` is longer: 2/ω with the largest ω of all motions,
/// less where dashpots resist them. Walls are those whose contacts were booked at this step; `moves` returns whether a particle
/// moves and turns as forces require. Contacts are not kept where each particle's neighbourhood shows that the step is short
/// enough.
///
/// # Errors
/// What is missing in the scene.
pub fn exceeded(
    w: &World,
    probes: &mut [Box<dyn Probe>],
    moves: impl Fn(usize) -> [bool; 2],
    dt: f64,
) -> Result<Option<f64>> {
    let (masses, ftm2v, radius) =
        (w.contact_masses(), w.settings.units.constants().ftm2v, &w.particles.radius);
    let root = |free: bool, inertia: f64| if free { (ftm2v / inertia).sqrt() } else { 0.0 };
    let roots = |i: usize| {
        let ([goes, turns], mass) = (moves(i), true_mass(w, &masses, i));
        // Particles of solids do not turn.
        let turns = turns && solid(w, i).is_none();
        [root(goes, mass), root(turns, 0.4 * mass * radius[i] * radius[i])]
    };
    let roots: Vec<[f64; 2]> = (0..w.n()).map(roots).collect();
    let now = w.clock.step;
    let mut each = |take: &mut dyn FnMut(Contact)| {
        for probe in &mut *probes {
            probe.springs(w, &mut |s| {
                take(Contact {
                    first: s.ends[0] as usize,
                    second: Some(s.ends[1] as usize),
                    normal: s.normal,
                    resistance: [s.stiffness, s.damping],
                    arms: s.arms,
                });
            })?;
        }
        add_walls(
            w,
            |step| step == now,
            |i, s| {
                let (normal, resistance, arms) = (s.normal, [s.stiffness, s.damping], [s.arm, 0.0]);
                take(Contact { first: i, second: None, normal, resistance, arms });
            },
        );
        Ok(())
    };
    let Some(worst) = perhaps_unstable(&roots, dt, &mut each)? else { return Ok(None) };
    let some = nearest(w, worst, MOST);
    Ok(Pressed::among(&some, &roots, &mut each)?.exceeded_by(dt))
}

/// Up to so many particles around one, ascending.
fn nearest(w: &World, centre: usize, most: usize) -> Vec<u32> {
    let mut all: Vec<u32> = (0..w.n() as u32).collect();
    if all.len() <= most {
        return all;
    }
    let (x, periods) = (&w.particles.x, w.periods());
    let away = |i: &u32| {
        let d = periods.nearest(sub(x[*i as usize], x[centre]));
        dot(d, d)
    };
    all.select_nth_unstable_by(most, |a, b| away(a).total_cmp(&away(b)).then(a.cmp(b)));
    all.truncate(most);
    all.sort_unstable();
    all
}

/// The particle whose neighbourhood suggests the fastest motion, if some motion may have a Δt² ω² + 4 ζ ω Δt beyond 4 by the
/// neighbourhood estimate: a contact's energy is the square of a sum over its two ends, so that K ≤ 2 diag(K_ii), where walls do
/// not move.
fn perhaps_unstable(roots: &Roots, dt: f64, each: &mut Each) -> Result<Option<usize>> {
    let sums = sums(roots, dt, each)?;
    let mut places = vec![NO_BLOCK; sums.len()];
    let mut count = 0;
    for (place, _) in places.iter_mut().zip(&sums).filter(|(_, sum)| **sum > 4.0) {
        *place = count;
        count += 1;
    }
    if count == 0 {
        return Ok(None);
    }
    let mut blocks = vec![Matrix6::zeros(); count as usize];
    each(&mut |c| {
        for (i, arm, normal) in c.ends() {
            if let Some(block) = blocks.get_mut(places[i] as usize) {
                c.add_to(block, [arm, dt], normal, &roots[i]);
            }
        }
    })?;
    let mut tops = vec![0.0; blocks.len()];
    par::each((&mut tops[..], &blocks[..]), |_, (tops, blocks)| {
        tops.iter_mut().zip(blocks).for_each(|(top, block)| *top = block.symmetric_eigenvalues().max());
    });
    let particles = places.iter().enumerate().filter(|(_, place)| **place != NO_BLOCK);
    let tops = particles.map(|(i, place)| (i, tops[*place as usize]));
    Ok(tops.filter(|(_, top)| *top > 4.0).max_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(i, _)| i))
}

/// Of each particle no less than the largest eigenvalue of its block: sums over its contacts.
fn sums(roots: &Roots, dt: f64, each: &mut Each) -> Result<Vec<f64>> {
    let mut sums = vec![0.0; roots.len()];
    each(&mut |c| {
        let ends = c.shares();
        let [along, across, rolling, twisting] = c.over(dt);
        for (i, arm, _) in c.ends() {
            let [straight, turning] = roots[i].map(|r| r * r);
            let sliding = across * (straight + arm * arm * turning);
            sums[i] += ends * ((along * straight).max(sliding) + rolling.max(twisting) * turning);
        }
    })?;
    Ok(sums)
}

/// What touches, as springs between bodies.
struct Pressed {
    contacts: Vec<Contact>,
    /// See [`Roots`].
    roots: Vec<[f64; 2]>,
}

impl Pressed {
    /// The contacts between some of the particles, and those of walls with them. Others only make motions faster.
    fn among(some: &[u32], roots: &Roots, each: &mut Each) -> Result<Self> {
        let mut places = vec![NO_BLOCK; roots.len()];
        some.iter().zip(0..).for_each(|(i, place)| places[*i as usize] = place);
        let place = |i: usize| Some(places[i]).filter(|place| *place != NO_BLOCK).map(|place| place as usize);
        let mut contacts = vec![];
        each(&mut |c| {
            let second = c.second.map(place);
            if let (Some(first), Some(second)) = (place(c.first), second.map_or(Some(None), |j| j.map(Some)))
            {
                contacts.push(Contact { first, second, ..c });
            }
        })?;
        Ok(Self { contacts, roots: some.iter().map(|i| roots[*i as usize]).collect() })
    }

    /// The longest stable step, if `dt` is longer.
    fn exceeded_by(&self, dt: f64) -> Option<f64> {
        let most = |dt: f64| largest_eigenvalue(self.roots.len(), 1e-12, |q| self.product(q, dt));
        let (mut limit, mut now) = (dt, most(dt).filter(|now| *now > 4.0)?);
        // Exact at once without dashpots; with them half of the error at least goes in each round.
        for _ in 0..ROUNDS {
            let before = limit;
            limit *= 2.0 / now.sqrt();
            if !self.contacts.iter().any(|c| c.resistance[1].iter().any(|c| *c > 0.0)) {
                break;
            }
            now = most(limit).filter(|now| *now > 0.0)?;
            if (limit / before - 1.0).abs() < CLOSE {
                break;
            }
        }
        Some(limit)
    }

    /// M^−½ (Δt² K + 2 Δt C) M^−½ q.
    fn product(&self, q: &[Six], dt: f64) -> Vec<Six> {
        let mut out = vec![[0.0; 6]; q.len()];
        let halves = |q: &Six| ([q[0], q[1], q[2]], [q[3], q[4], q[5]]);
        // How an end moves, and by how much it turns.
        let motion = |i: usize| {
            let ((u, theta), [straight, turning]) = (halves(&q[i]), self.roots[i]);
            (scale(straight, u), scale(turning, theta))
        };
        for c in &self.contacts {
            let ((ui, ti), (uj, tj)) = (motion(c.first), c.second.map_or_else(Default::default, motion));
            let [stiff, slides, rolling, twisting] = c.over(dt);
            let (n, apart) = (c.normal, sub(ui, uj));
            let along = dot(apart, n);
            // As laws have it: v_t − (R_i ω_i + R_j ω_j) × n.
            let spin = add(scale(c.arms[0], ti), scale(c.arms[1], tj));
            let slip = sub(sub(apart, scale(along, n)), cross(spin, n));
            let across = scale(slides, slip);
            let force = add(scale(stiff * along, n), across);
            let lever = cross(n, across);
            // What resists the difference of spins.
            let apart = sub(ti, tj);
            let about = dot(apart, n);
            let couple = add(scale(rolling, sub(apart, scale(about, n))), scale(twisting * about, n));
            let mut give = |i: usize, arm: f64, sign: f64| {
                let [straight, turning] = self.roots[i];
                for d in 0..3 {
                    out[i][d] += sign * straight * force[d];
                    out[i][3 + d] += turning * (sign * couple[d] - arm * lever[d]);
                }
            };
            give(c.first, c.arms[0], 1.0);
            if let Some(j) = c.second {
                give(j, c.arms[1], -1.0);
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Pressed {
        fn each(&self, take: &mut dyn FnMut(Contact)) -> Result<()> {
            self.contacts.iter().for_each(|c| take(*c));
            Ok(())
        }
        fn is_stable(&self, dt: f64) -> bool {
            perhaps_unstable(&self.roots, dt, &mut |take| self.each(take)).unwrap().is_none()
        }
        fn all_sums(&self, dt: f64) -> Vec<f64> {
            sums(&self.roots, dt, &mut |take| self.each(take)).unwrap()
        }
    }

    /// Two grains of mass 1 and radius ½ (1/I = 10), or one on a wall.
    fn pressed(second: Option<usize>, [along, across]: [f64; 2]) -> Pressed {
        let (normal, arms) = ([0.6, 0.0, 0.8], [0.5, if second.is_some() { 0.5 } else { 0.0 }]);
        let resistance = [[along, across, 0.0, 0.0], [0.0; 4]];
        let contact = Contact { first: 0, second, normal, resistance, arms };
        Pressed { contacts: vec![contact], roots: vec![[1.0, 10f64.sqrt()]; 2] }
    }

    /// ω² of the fastest motion, from the limit.
    fn square(p: &Pressed) -> f64 {
        (2.0 / p.exceeded_by(1e9).unwrap()).powi(2)
    }

    #[test]
    fn frequencies_of_closed_forms() {
        let near = |found: f64, square: f64| assert!((found / square - 1.0).abs() < 1e-9, "{found} {square}");
        // k/m̄ of a free pair, k/m on a wall.
        near(square(&pressed(Some(1), [3.0, 0.0])), 6.0);
        near(square(&pressed(None, [3.0, 0.0])), 3.0);
        // Sliding while turning: k_t (1/m + R²/I) of each end, 7/2 k_t/m for a sphere.
        near(square(&pressed(None, [0.0, 3.0])), 10.5);
        near(square(&pressed(Some(1), [0.0, 3.0])), 21.0);
        // No particle moves.
        let still = Pressed { roots: vec![[0.0; 2]; 2], ..pressed(Some(1), [3.0, 1.0]) };
        assert_eq!(still.exceeded_by(1e9), None);
        // Exact on both sides: ω = √6.
        let pair = pressed(Some(1), [3.0, 0.0]);
        let limit = 2.0 / 6f64.sqrt();
        assert_eq!(pair.exceeded_by(0.999 * limit), None);
        assert!((pair.exceeded_by(1.001 * limit).unwrap() / limit - 1.0).abs() < 1e-9);
    }

    #[test]
    fn dashpots_and_rolling_shorten_the_step() {
        // Δt² ω² + 4 ζ ω Δt = 4, ω² = 6 and 2 ζ ω = 2 c of a free pair.
        for c in [0.1, 1.0, 10.0] {
            let mut pair = pressed(Some(1), [3.0, 0.0]);
            pair.contacts[0].resistance[1][0] = c;
            let limit = 4.0 / (2.0 * c + (4.0 * c * c + 24.0_f64).sqrt());
            assert_eq!(pair.exceeded_by(0.999 * limit), None);
            let found = pair.exceeded_by(3.0 * limit).unwrap();
            assert!((found / limit - 1.0).abs() < CLOSE, "{c}: {found} {limit}");
        }
        // Rolling and twisting of two free grains: ω² = 2 k/I, 1/I = 10.
        for part in [2, 3] {
            let mut pair = pressed(Some(1), [0.0; 2]);
            pair.contacts[0].resistance[0][part] = 3.0;
            let limit = 2.0 / 60f64.sqrt();
            assert!((pair.exceeded_by(1.0).unwrap() / limit - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn what_is_no_number_ends_the_look() {
        for (stiffness, root) in [(f64::NAN, 1.0), (f64::INFINITY, 1.0), (3.0, f64::INFINITY)] {
            let mut pair = pressed(Some(1), [stiffness, 2.0]);
            pair.roots = vec![[root; 2]; 2];
            // No answer is right: that there is one is all.
            pair.is_stable(1.0);
            pair.exceeded_by(1.0);
        }
    }

    #[test]
    fn some_of_a_long_chain_give_its_limit() {
        // Springs in a row of which those in the middle are twice as stiff as the others.
        let n = 3000;
        let stiffness = |i: usize| if (1000..2000).contains(&i) { 2.0 } else { 1.0 };
        let link = |i: usize| Contact {
            first: i,
            second: Some(i + 1),
            normal: [-1.0, 0.0, 0.0],
            resistance: [[stiffness(i), 0.0, 0.0, 0.0], [0.0; 4]],
            arms: [0.5; 2],
        };
        let chain = Pressed { contacts: (0..n - 1).map(link).collect(), roots: vec![[1.0, 0.0]; n] };
        let worst = perhaps_unstable(&chain.roots, 1.0, &mut |take| chain.each(take)).unwrap().unwrap();
        assert!((1000..=2000).contains(&worst));
        let some: Vec<u32> = (1400..1600).collect();
        let part = Pressed::among(&some, &chain.roots, &mut |take| chain.each(take)).unwrap();
        assert_eq!((part.contacts.len(), part.roots.len()), (199, 200));
        // ω² → 4 k/m.
        let found = part.exceeded_by(1.0).unwrap() / (2.0 / 8f64.sqrt());
        assert!((1.0..1.005).contains(&found), "{found}");
    }

    #[test]
    fn the_bound_is_above_a_chain_between_walls() {
        // n equal springs in a row between two walls: ω² = 4 k/m sin²(n π/(2 (n + 1))).
        let n = 9;
        let one = |first, second: Option<usize>, sign: f64| Contact {
            first,
            second,
            normal: [sign, 0.0, 0.0],
            resistance: [[1.0, 0.0, 0.0, 0.0], [0.0; 4]],
            arms: [0.5; 2],
        };
        let mut contacts: Vec<_> = (1..n).map(|i| one(i - 1, Some(i), -1.0)).collect();
        contacts.extend([one(0, None, 1.0), one(n - 1, None, -1.0)]);
        let chain = Pressed { contacts, roots: vec![[1.0, 0.0]; n] };
        let exact = 4.0 * (n as f64 * std::f64::consts::FRAC_PI_2 / (n as f64 + 1.0)).sin().powi(2);
        assert!((square(&chain) / exact - 1.0).abs() < 1e-9, "{} {exact}", square(&chain));
        let most = chain.all_sums(1.0).into_iter().fold(0.0, f64::max);
        assert!(most >= exact, "{most}");
    }

    /// Grains at rest between six walls, or six grains of the same kind around one, each with springs and dashpots of all kinds.
    #[test]
    fn blocks_are_those_of_the_product() {
        let resistance = [[3.0, 2.0, 0.3, 0.2], [0.1, 0.2, 0.03, 0.01]];
        let normals = [[0.6, 0.0, 0.8], [0.0, -1.0, 0.0], [-0.36, 0.48, 0.8]];
        let contact =
            |k: usize, second| Contact { first: 0, second, normal: normals[k], resistance, arms: [0.5, 0.4] };
        for seconds in [[None; 3], [Some(1), Some(2), Some(3)]] {
            let contacts: Vec<Contact> = (0..3).map(|k| contact(k, seconds[k])).collect();
            let p = Pressed { contacts, roots: vec![[1.0, 10f64.sqrt()]; 4] };
            // The first particle alone moves: half of its block where others stand still, which count twice.
            let mut block = Matrix6::zeros();
            for c in &p.contacts {
                let (i, arm, n) = c.ends().next().unwrap();
                c.add_to(&mut block, [arm, 0.7], n, &p.roots[i]);
            }
            let share = if seconds[0].is_some() { 2.0 } else { 1.0 };
            for column in 0..6 {
                let mut q = vec![[0.0; 6]; 4];
                q[0][column] = 1.0;
                let wanted = p.product(&q, 0.7)[0];
                for row in 0..6 {
                    let found = block[(row, column)] / share;
                    assert!((found - wanted[row]).abs() < 1e-12, "{row} {column}: {found} {}", wanted[row]);
                }
            }
            // No eigenvalue is above the bound, and blocks give a sharper bound than sums.
            let dt = |factor: f64| factor * p.exceeded_by(1e9).unwrap();
            assert!(!p.is_stable(dt(1.001)));
            let sums_limit = (1..1000)
                .map(|k| 1e-3 * f64::from(k))
                .rfind(|part| p.all_sums(dt(*part)).iter().all(|s| *s <= 4.0));
            let blocks_limit = (1..1000).map(|k| 1e-3 * f64::from(k)).rfind(|part| p.is_stable(dt(*part)));
            assert!(blocks_limit > sums_limit, "{blocks_limit:?} {sums_limit:?}");
        }
    }
}
