//! Rigid bodies as the world keeps them: what fixes rigid move and computes read.

use perigrain_base::math::body::Quat;
use perigrain_base::math::vec3::Vec3;
use perigrain_world::{Key, Numbers, World};

/// A rigid body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body {
    /// What its particles have in common (molecule ID …).
    pub name: f64,
    /// Mass.
    pub mass: f64,
    /// Centre of mass, never wrapped.
    pub x: Vec3,
    /// Its velocity.
    pub v: Vec3,
    /// Angular momentum.
    pub momentum: Vec3,
    /// Orientation of the principal axes.
    pub q: Quat,
    /// Principal moments.
    pub moments: Vec3,
    /// Force.
    pub force: Vec3,
    /// Torque about the centre.
    pub torque: Vec3,
    /// Angular velocity.
    pub omega: Vec3,
    /// Image counts at the last rebuild of lists.
    pub image: Vec3,
}

/// Numbers a body is kept in.
pub const WIDTH: usize = 30;

impl Body {
    /// Puts it into its row of numbers.
    pub fn write(&self, row: &mut [f64]) {
        row[..2].copy_from_slice(&[self.name, self.mass]);
        row[11..15].copy_from_slice(&self.q);
        let vectors = [(2, self.x), (5, self.v), (8, self.momentum), (15, self.moments), (18, self.force)];
        let last = [(21, self.torque), (24, self.omega), (27, self.image)];
        vectors.into_iter().chain(last).for_each(|(k, a)| row[k..k + 3].copy_from_slice(&a));
    }

    /// The body of a row of numbers.
    pub fn of(row: &[f64]) -> Self {
        let three = |k: usize| [row[k], row[k + 1], row[k + 2]];
        Self {
            name: row[0],
            mass: row[1],
            x: three(2),
            v: three(5),
            momentum: three(8),
            q: [row[11], row[12], row[13], row[14]],
            moments: three(15),
            force: three(18),
            torque: three(21),
            omega: three(24),
            image: three(27),
        }
    }
}

/// The handle of the bodies of the fix of this style and ID.
pub fn bodies_key(style: &str, id: &str) -> Numbers {
    Key::new(&format!("{style}/{id}/bodies"))
}

/// The bodies of a fix, as the world keeps them.
pub fn bodies(w: &World, key: Numbers) -> Vec<Body> {
    let kept = w.memo.get(key);
    kept.map_or(vec![], |m| m.chunks_exact(WIDTH).map(Body::of).collect())
}

/// Discards all bodies: the next run builds them from the particles that exist then.
pub fn forget(w: &mut World) {
    let own = |name: &str| name.starts_with("rigid");
    w.memo.retain(|key| !own(key.text()));
    drop(w.columns.split_off(|name| !own(name)));
}

/// The column with the number of each particle's body, from 1; 0 for none.
pub fn body_column(style: &str, id: &str) -> Numbers {
    Key::new(&format!("{style}/{id}/body"))
}
