//! Grains of several spheres: how they are turned, what moves them, how they join, and how much of them is in a region.

use super::place::Bounded;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::body::{Quat, UNTURNED, apply, apply_transposed, axes, normalized};
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::{Vec3, add, cross, sub};
use perigrain_styles::pair::ToCome;
use perigrain_styles::rigid_bodies::{Body, WIDTH, bodies_key, body_column};
use perigrain_styles::words::Words;
use perigrain_styles::{BuildCx, SealCx};
use perigrain_world::template::Numbering;
use perigrain_world::{CONTACT_MASS, Clump, GroupId, Ingredient, Mixture, Numbers, World};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// How a new grain is turned.
#[derive(Clone, Copy, Debug, PartialEq, Words)]
#[word(what = "orientation")]
pub enum Orientation {
    /// As its template.
    Template,
    /// At random, each orientation as likely as any other.
    Random,
    /// By a quaternion, real part first.
    Constant(
        #[word(name = "Q0")] f64,
        #[word(name = "Q1")] f64,
        #[word(name = "Q2")] f64,
        #[word(name = "Q3")] f64,
    ),
}

impl Orientation {
    /// The orientation of the next grain.
    pub fn draw(self, stream: &mut ParkMiller) -> Quat {
        match self {
            Self::Template => UNTURNED,
            Self::Constant(w, x, y, z) => normalized([w, x, y, z]),
            // Of four normal numbers no direction is more likely than another.
            Self::Random => normalized([0; 4].map(|_| stream.gaussian())),
        }
    }
}

/// Whether the scene can have the grains of a mixture.
///
/// # Errors
/// Particles without molecule IDs, an orientation that is none.
pub fn check(mixture: &Mixture, cx: &BuildCx) -> Result<()> {
    if mixture.clumps().next().is_none() || cx.world.particles.style.molecules {
        return Ok(());
    }
    let text = "grains of several spheres need molecule IDs, and particles of this atom_style have none";
    let d = Diagnostic::error(Code::CONFLICT, cx.span, text);
    Err(d.help("write `fix ID all property/atom mol` above").into())
}

/// The fixes that move the grains of a mixture: keys of their bodies, and of the column with the number of each particle's body.
///
/// # Errors
/// Grains that no fix moves as bodies.
pub fn movers(mixture: &Mixture, cx: &mut dyn SealCx) -> Result<Vec<(Numbers, Numbers)>> {
    let mut found: Vec<(Numbers, Numbers)> = vec![];
    for clump in mixture.clumps().filter(|clump| clump.template.bonds.is_empty()) {
        let Some((id, style)) = cx.adopter(&clump.name) else {
            let text = format!("no fix moves the grains of template `{}` as rigid bodies", clump.name);
            let d = Diagnostic::error(Code::INCOMPLETE, cx.span(), text);
            let help = format!("write `fix ID GROUP rigid/small molecule mol {}` above the run", clump.name);
            return Err(d.help(help).into());
        };
        let keys = (bodies_key(style, &id), body_column(style, &id));
        if found.iter().all(|(bodies, _)| bodies.text() != keys.0.text()) {
            found.push(keys);
        }
    }
    let span = cx.span();
    let w = cx.world();
    if !found.is_empty() && w.settings.neighbor.exclude_molecules.is_empty() {
        let text = "spheres of the same grain that overlap push each other apart";
        let d = Diagnostic::warning(Code::SUSPICIOUS, span, text);
        w.notes.push(d.help("write `neigh_modify exclude molecule/intra all` above"));
    }
    Ok(found)
}

/// What contact laws need of a kind of grains: of several spheres, each of them, with their own masses.
pub fn to_come(kind: &Ingredient, mask: u32) -> Vec<ToCome> {
    let Some(clump) = &kind.clump else {
        return vec![ToCome { kind: kind.kind, mask, mass: kind.mass(), radius: kind.radius }];
    };
    let t = &clump.template;
    let each = t.kinds.iter().zip(&t.masses).zip(&t.radii);
    each.map(|((kind, mass), radius)| ToCome { kind: *kind, mask, mass: *mass, radius: *radius }).collect()
}

/// A grain where it is to appear.
pub struct Placed<'c> {
    /// Its spheres.
    pub clump: &'c Clump,
    /// Where they are.
    pub places: Vec<Vec3>,
    /// Its centre of mass.
    pub x: Vec3,
    /// How it is turned.
    pub turn: Quat,
    /// Its velocity.
    pub v: Vec3,
    /// Its angular velocity.
    pub omega: Vec3,
}

impl Placed<'_> {
    /// The velocity of a sphere of it.
    pub fn velocity(&self, k: usize) -> Vec3 {
        add(self.v, cross(self.omega, sub(self.places[k], self.x)))
    }

    /// Puts it behind the present particles, in `all` and a group. Lists are for the caller to settle.
    ///
    /// # Errors
    /// More particles than there are ids.
    pub fn admit(&self, w: &mut World, group: GroupId, numbers: &mut Numbering) -> Result<()> {
        let (t, start) = (&self.clump.template, w.n());
        if u32::try_from(t.count).ok().and_then(|n| numbers.tag.checked_add(n)).is_none() {
            return fail(Code::TOO_LARGE, None, "more particles than there are ids");
        }
        w.insert_molecule(t, &self.places, self.turn, numbers);
        let p = &mut w.particles;
        for k in 0..t.count {
            p.v[start + k] = self.velocity(k);
        }
        p.omega[start..].fill(self.omega);
        p.density[start..].fill(self.clump.density());
        p.mask[start..].iter_mut().for_each(|m| *m |= group.bit());
        Ok(())
    }
}

/// How many grains there are in a region, their mass and their volume.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inside {
    /// Single spheres and bodies, bodies by the part of their spheres.
    pub number: f64,
    /// [mass]
    pub mass: f64,
    /// [volume]
    pub volume: f64,
}

impl Inside {
    /// What is in a region; the volume of grains of several spheres is that of a kind of the mixture with their mass.
    pub fn of(place: &Bounded, mixture: &Mixture, w: &World) -> Self {
        let p = &w.particles;
        let in_body = |i: usize| {
            p.molecule.get(i).is_some_and(|m| *m > 0)
                && w.columns.playing(*CONTACT_MASS).any(|(_, mass)| mass.get(i).is_some_and(|m| *m > 0.0))
        };
        let ball = |i: usize| 4.0 / 3.0 * PI * p.radius[i].powi(3);
        let (mut sum, mut bodies) = (Self::default(), BTreeMap::new());
        for i in (0..p.len()).filter(|&i| place.contains(p.x[i])) {
            if in_body(i) {
                // Spheres inside, their volume.
                let (count, volume) = bodies.entry(p.molecule[i]).or_insert((0.0, 0.0));
                (*count, *volume) = (*count + 1.0, *volume + ball(i));
                continue;
            }
            sum.number += 1.0;
            sum.mass += p.mass[i];
            sum.volume += ball(i);
        }
        if bodies.is_empty() {
            return sum;
        }
        let mut whole: BTreeMap<u32, (f64, f64)> = bodies.keys().map(|k| (*k, (0.0, 0.0))).collect();
        for i in 0..p.len() {
            if let Some((count, mass)) = p.molecule.get(i).and_then(|m| whole.get_mut(m)) {
                (*count, *mass) = (*count + 1.0, *mass + p.mass[i]);
            }
        }
        for (name, (inside, balls)) in bodies {
            let (count, mass) = whole[&name];
            let part = inside / count;
            let like = mixture.clumps().find(|clump| {
                clump.template.count as f64 == count && (clump.mass - mass).abs() < 1e-9 * mass
            });
            sum.number += part;
            sum.mass += part * mass;
            sum.volume += like.map_or(balls, |clump| part * clump.volume);
        }
        sum
    }
}

/// Gives the body of a particle a new motion: `place` and `v` are those of the particle.
pub fn launch(w: &mut World, movers: &[(Numbers, Numbers)], i: usize, place: Vec3, v: Vec3, omega: Vec3) {
    for (bodies, column) in movers {
        let number = w.columns.get_scalar(*column).and_then(|c| c.get(i)).copied().unwrap_or(0.0) as usize;
        let Some(k) = number.checked_sub(1) else { continue };
        let Some(row) = w.memo.get_mut(*bodies).and_then(|all| all.chunks_exact_mut(WIDTH).nth(k)) else {
            continue;
        };
        let mut body = Body::of(row);
        body.v = sub(v, cross(omega, sub(place, body.x)));
        let frame = axes(body.q);
        let own = apply(&frame, omega);
        body.momentum = apply_transposed(&frame, [0, 1, 2].map(|d| body.moments[d] * own[d]));
        body.omega = omega;
        body.write(row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Means of the squares of the four parts: 1/4 each, with a standard error of 0.0035.
    #[test]
    fn random_orientations_favour_none() {
        let mut stream = ParkMiller::new(4711);
        let mut sum = [0.0; 4];
        for _ in 0..5000 {
            let q = Orientation::Random.draw(&mut stream);
            assert!((q.iter().map(|a| a * a).sum::<f64>() - 1.0).abs() < 1e-14);
            (0..4).for_each(|k| sum[k] += q[k] * q[k] / 5000.0);
        }
        assert!(sum.iter().all(|a| (a - 0.25).abs() < 0.015), "{sum:?}");
    }
}
