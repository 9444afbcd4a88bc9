//! Bodies that are copies of a molecule template with its own total mass, centre or inertia.

use super::bodies::{orient, tensor};
use perigrain_base::math::body::{
    Quat, UNTURNED, after, apply, apply_transposed, back, matrix, normalized, spin, turn, turned,
};
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};
use perigrain_styles::matter::{Masses, unwrapped};
use perigrain_styles::rigid_bodies::Body;
use perigrain_world::{Template, World};
use std::sync::Arc;

/// Positions may differ from those of the template by this fraction of its size.
const FIT: f64 = 1e-6;

/// The template named by `mol`.
#[derive(Clone)]
pub struct Mold {
    /// Its name.
    pub name: String,
    /// Its molecules.
    pub set: Arc<[Template]>,
}

impl Mold {
    /// As the template is now: a mixture may have given it a mass since.
    pub fn now(&self, w: &World) -> Self {
        let set = w.templates.get(&self.name).unwrap_or(&self.set).clone();
        Self { name: self.name.clone(), set }
    }

    /// Whether it gives a value that is not the sum over particles.
    pub fn gives(&self) -> bool {
        self.set.iter().any(gives)
    }

    /// Whether a file gives such a value, and not a mixture by its density.
    pub fn reads(&self) -> bool {
        self.set.iter().any(|t| gives(t) && t.density.is_none())
    }

    /// The body of these particles if they are a copy of such a template; `sum` is the body summed from the
    /// particles. If all lie on a line, only `before`, the previous orientation of the body, fixes the
    /// rotation about it.
    pub fn cast(&self, w: &World, members: &[usize], sum: &Body, before: Option<Quat>) -> Option<Body> {
        let mut members = members.to_vec();
        members.sort_by_key(|&i| w.particles.tag[i]);
        let fits = |t: &&Template| {
            let radius =
                |k: usize, i: usize| t.radii.get(k).is_none_or(|r| w.particles.radius.get(i) == Some(r));
            t.count == members.len() && members.iter().enumerate().all(|(k, &i)| radius(k, i))
        };
        let there: Vec<Vec3> = members.iter().map(|&i| unwrapped(w, i)).collect();
        self.set.iter().filter(fits).find_map(|t| copy(t, w, &members, &there, sum, before)).flatten()
    }
}

fn gives(t: &Template) -> bool {
    t.mass.is_some() || t.com.is_some() || t.inertia.is_some()
}

/// The copy of a template at these positions: `None` if the template gives no values, or if this is no copy.
fn copy(
    t: &Template,
    w: &World,
    members: &[usize],
    there: &[Vec3],
    sum: &Body,
    before: Option<Quat>,
) -> Option<Option<Body>> {
    let whole = whole(t, w, members);
    let guess = before.map_or(UNTURNED, |q| after(q, back(whole.q)));
    let (middle, found) = (t.centre(), mean(there));
    let own: Vec<Vec3> = t.places.iter().map(|x| sub(*x, middle)).collect();
    let seen: Vec<Vec3> = there.iter().map(|x| sub(*x, found)).collect();
    let q = fit(&own, &seen, guess)?;
    if !gives(t) {
        return Some(None);
    }
    let (mass, q, moments) = (whole.mass, after(q, whole.q), (q, whole.moments));
    let (turn, moments) = moments;
    let x = add(found, turned(turn, sub(whole.x, middle)));
    // The particles move as a rigid body, whatever centre is given.
    let omega = spin(sum.momentum, sum.q, sum.moments);
    let v = add(sum.v, cross(omega, sub(x, sum.x)));
    let m = matrix(q);
    let inner = apply_transposed(&m, omega);
    let momentum = apply(&m, std::array::from_fn(|k| moments[k] * inner[k]));
    Some(Some(Body { mass, x, v, momentum, q, moments, ..*sum }))
}

/// Mass, centre, moments and axes of a template as in its file: the given values, or else the sums over these
/// particles, which are those of the file.
fn whole(t: &Template, w: &World, members: &[usize]) -> Body {
    let (masses, lammps) = (Masses::of(w), w.settings.lammps());
    let weighed = |k: usize| masses.get(members[k]);
    let sum: f64 = (0..t.count).map(weighed).sum();
    let mass = t.mass.unwrap_or(sum);
    let moment = (0..t.count).fold([0.0; 3], |a, k| add(a, scale(weighed(k), t.places[k])));
    // LAMMPS divides the sum over particles by the mass given in the file.
    let over = if lammps { mass } else { sum };
    let x = t.com.unwrap_or(scale(1.0 / over, moment));
    let spheres = (0..t.count).map(|k| {
        let radius = w.particles.radius.get(members[k]).copied().unwrap_or(0.0);
        (weighed(k), sub(t.places[k], x), radius)
    });
    let inertia = match t.inertia {
        // LAMMPS swaps Ixy and Iyz.
        Some([xx, yy, zz, xy, xz, yz]) if lammps => [xx, yy, zz, yz, xz, xy],
        Some(given) => given,
        None => tensor(spheres),
    };
    let mut body = Body { mass, x, ..Body::default() };
    orient(&mut body, inertia, w.settings.two_dimensional);
    body
}

fn mean(list: &[Vec3]) -> Vec3 {
    scale(1.0 / list.len() as f64, list.iter().fold([0.0; 3], |a, x| add(a, *x)))
}

/// The rotation that maps positions to others, both relative to their means, as near to `guess` as they
/// allow; `None` if there is none.
fn fit(from: &[Vec3], to: &[Vec3], guess: Quat) -> Option<Quat> {
    let near: Vec<Vec3> = from.iter().map(|x| turned(guess, *x)).collect();
    let farthest =
        |list: &[Vec3]| (0..list.len()).max_by(|&a, &b| length(list[a]).total_cmp(&length(list[b])));
    let far = farthest(&near)?;
    let size = length(near[far]);
    let goal = length(to[far]);
    if (size - goal).abs() > FIT * size {
        return None;
    }
    if size == 0.0 {
        return Some(guess);
    }
    let (u, v) = (scale(1.0 / size, near[far]), scale(1.0 / goal, to[far]));
    let first = between(u, v);
    // The remaining freedom is a rotation about that direction.
    let across = |x: Vec3| sub(x, scale(dot(x, v), v));
    let beside: Vec<Vec3> = near.iter().map(|x| across(turned(first, *x))).collect();
    let side = farthest(&beside)?;
    let (a, b) = (beside[side], across(to[side]));
    let second =
        if length(a) > FIT * size { turn(v, dot(cross(a, b), v).atan2(dot(a, b))) } else { UNTURNED };
    let q = normalized(after(second, after(first, guess)));
    let fits = |(x, y): (&Vec3, &Vec3)| length(sub(turned(q, *x), *y)) <= FIT * size;
    from.iter().zip(to).all(fits).then_some(q)
}

/// The shortest rotation from one unit vector to another.
fn between(u: Vec3, v: Vec3) -> Quat {
    let (w, axis) = (1.0 + dot(u, v), cross(u, v));
    if w > 1e-15 {
        return normalized([w, axis[0], axis[1], axis[2]]);
    }
    // Half a turn about any perpendicular axis.
    let least = (0..3).min_by(|&a, &b| u[a].abs().total_cmp(&u[b].abs())).unwrap_or(0);
    let mut unit = [0.0; 3];
    unit[least] = 1.0;
    let [x, y, z] = cross(u, unit);
    normalized([0.0, x, y, z])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_of_copies_are_found() {
        let body = [[1.0, 0.0, 0.0], [-0.5, 0.7, 0.0], [-0.5, -0.7, 0.3], [0.0, 0.0, -0.3]];
        let moved = |q: Quat, body: &[Vec3]| body.iter().map(|x| turned(q, *x)).collect::<Vec<_>>();
        let half = turn([0.0, 1.0, 0.0], std::f64::consts::PI);
        for q in [UNTURNED, turn([0.6, 0.0, 0.8], 2.5), half] {
            let found = fit(&body, &moved(q, &body), UNTURNED).unwrap();
            let same = (0..4).map(|k| q[k] * found[k]).sum::<f64>();
            assert!((same.abs() - 1.0).abs() < 1e-14, "{q:?} {found:?}"); // a few roundings
            // Particles on a line keep their previous rotation about it.
            let line = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]];
            let guess = turn([1.0, 0.0, 0.0], 0.4);
            assert_eq!(
                fit(&line, &line, guess).map(|q| q.map(|a| (a * 1e12).round())),
                Some(guess.map(|a| (a * 1e12).round()))
            );
        }
        let mut other = moved(half, &body);
        other[2][0] += 1e-3;
        assert_eq!(fit(&body, &other, UNTURNED), None);
        // The mirror image is a different body.
        assert_eq!(fit(&body, &body.map(|[x, y, z]| [x, y, -z]), UNTURNED), None);
    }
}
