//! Group functions of formulas: `count(all)`, `vcm(ball,x)`, `bound(all,zmax,box)` and their kin.

use nalgebra::{Matrix3, Vector3};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use perigrain_base::par;
use perigrain_world::World;

/// The names of all group functions.
pub const NAMES: [&str; 13] = [
    "count", "mass", "charge", "xcm", "vcm", "fcm", "bound", "gyration", "ke", "angmom", "torque", "inertia",
    "omega",
];

/// Evaluates a group function; `args` are group, then what the function needs, then maybe a region.
///
/// # Errors
/// Unknown groups, regions, directions; `charge`, which no atom style here has.
pub fn group_function(w: &World, name: &str, args: &[String], span: Span) -> Result<f64> {
    let extra = match name {
        "count" | "mass" | "charge" | "gyration" | "ke" => 0,
        _ => 1,
    };
    let group = args.first().map(String::as_str).unwrap_or("");
    let Some(id) = w.groups.find(group) else {
        let mut d = Diagnostic::error(Code::UNKNOWN_GROUP, span, format!("there is no group `{group}`"));
        if let Some(n) = nearest(group, w.groups.names()) {
            d = d.help(format!("did you mean `{n}`?"));
        }
        return Err(d.into());
    };
    let region = match args.get(1 + extra) {
        None => None,
        Some(r) => match w.regions.get(r) {
            Some(region) => Some(region.clone()),
            None => return fail(Code::UNKNOWN_REGION, span, format!("there is no region `{r}`")),
        },
    };
    let p = &w.particles;
    let members: Vec<usize> = (0..p.len())
        .filter(|&i| p.mask[i] & id.bit() != 0)
        .filter(|&i| region.as_ref().is_none_or(|r| r.contains(p.x[i])))
        .collect();
    let direction = |word: Option<&String>| direction(word.map_or("", String::as_str), span);
    let m = Members { w, list: &members };
    Ok(match name {
        "count" => members.len() as f64,
        "mass" => m.mass(),
        "charge" => return fail(Code::NOT_SUPPORTED, span, "charge(): no atom style here has charges"),
        "xcm" => m.xcm()[direction(args.get(1))?],
        "vcm" => m.vcm()[direction(args.get(1))?],
        "fcm" => m.total(|i| p.f[i])[direction(args.get(1))?],
        "bound" => m.bound(args.get(1).map_or("", String::as_str), span)?,
        "gyration" => m.gyration(),
        "ke" => m.ke(),
        "angmom" => m.angmom()[direction(args.get(1))?],
        "torque" => m.torque()[direction(args.get(1))?],
        "omega" => m.omega()[direction(args.get(1))?],
        "inertia" => {
            let (a, b) = match args.get(1).map(String::as_str) {
                Some("xx") => (0, 0),
                Some("yy") => (1, 1),
                Some("zz") => (2, 2),
                Some("xy") => (0, 1),
                Some("yz") => (1, 2),
                Some("xz") => (0, 2),
                _ => return fail(Code::BAD_VALUE, span, "inertia() takes xx, yy, zz, xy, yz or xz"),
            };
            m.inertia()[(a, b)]
        }
        _ => return fail(Code::UNKNOWN_WORD, span, format!("there is no group function `{name}`")),
    })
}

fn direction(word: &str, span: Span) -> Result<usize> {
    match word {
        "x" => Ok(0),
        "y" => Ok(1),
        "z" => Ok(2),
        _ => fail(Code::BAD_VALUE, span, format!("a direction is x, y or z, not `{word}`")),
    }
}

/// Some particles of the world, for sums over them (fixed chunk order, same bits for any thread count).
pub struct Members<'a> {
    /// Where they live.
    pub w: &'a World,
    /// Their indices.
    pub list: &'a [usize],
}

impl Members<'_> {
    fn sum(&self, term: impl Fn(usize) -> f64 + Sync) -> f64 {
        par::sum(self.list.len(), |k| term(self.list[k]))
    }

    fn total(&self, term: impl Fn(usize) -> [f64; 3] + Sync) -> [f64; 3] {
        [0, 1, 2].map(|d| self.sum(|i| term(i)[d]))
    }

    fn m(&self, i: usize) -> f64 {
        self.w.particles.mass[i]
    }

    /// Position with periodic images unfolded.
    fn unfolded(&self, i: usize) -> [f64; 3] {
        let p = &self.w.particles;
        let Some(domain) = &*self.w.domain else { return p.x[i] };
        let l = domain.lengths();
        [0, 1, 2].map(|d| p.x[i][d] + p.image[i][d] as f64 * l[d])
    }

    /// Total mass.
    pub fn mass(&self) -> f64 {
        self.sum(|i| self.m(i))
    }

    /// Centre of mass, unfolded.
    pub fn xcm(&self) -> [f64; 3] {
        self.mean(|i| self.unfolded(i))
    }

    /// Velocity of the centre of mass.
    pub fn vcm(&self) -> [f64; 3] {
        self.mean(|i| self.w.particles.v[i])
    }

    fn mean(&self, of: impl Fn(usize) -> [f64; 3] + Sync) -> [f64; 3] {
        let mass = self.mass();
        if mass <= 0.0 {
            return [0.0; 3];
        }
        self.total(|i| of(i).map(|a| a * self.m(i))).map(|a| a / mass)
    }

    /// Kinetic energy of translation, in energy units.
    pub fn ke(&self) -> f64 {
        let v = &self.w.particles.v;
        let mvv2e = self.w.settings.units.constants().mvv2e;
        0.5 * mvv2e * self.sum(|i| self.m(i) * (v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]))
    }

    fn bound(&self, which: &str, span: Span) -> Result<f64> {
        let axis = match which.as_bytes() {
            [a @ b'x'..=b'z', b'm', b'i' | b'a', b'n' | b'x'] => (a - b'x') as usize,
            _ => return fail(Code::BAD_VALUE, span, "bound() takes xmin, xmax, ymin, ymax, zmin or zmax"),
        };
        let x = self.list.iter().map(|&i| self.w.particles.x[i][axis]);
        // LAMMPS' value for a bound of nothing.
        const BIG: f64 = 1e20;
        Ok(if which.ends_with("min") { x.fold(BIG, f64::min) } else { x.fold(-BIG, f64::max) })
    }

    fn gyration(&self) -> f64 {
        let (c, mass) = (self.xcm(), self.mass());
        if mass <= 0.0 {
            return 0.0;
        }
        let square = self.sum(|i| {
            let x = self.unfolded(i);
            self.m(i) * (0..3).map(|d| (x[d] - c[d]) * (x[d] - c[d])).sum::<f64>()
        });
        (square / mass).sqrt()
    }

    /// Angular momentum about the centre of mass.
    pub fn angmom(&self) -> [f64; 3] {
        let c = self.xcm();
        self.total(|i| {
            let (x, v) = (self.unfolded(i), self.w.particles.v[i]);
            cross(sub(x, c), v).map(|a| a * self.m(i))
        })
    }

    fn torque(&self) -> [f64; 3] {
        let c = self.xcm();
        self.total(|i| cross(sub(self.unfolded(i), c), self.w.particles.f[i]))
    }

    /// Inertia tensor of the point masses about the centre of mass.
    pub fn inertia(&self) -> Matrix3<f64> {
        let c = self.xcm();
        let entry = |a: usize, b: usize| {
            self.sum(|i| {
                let d = sub(self.unfolded(i), c);
                let square = if a == b { d[0] * d[0] + d[1] * d[1] + d[2] * d[2] } else { 0.0 };
                self.m(i) * (square - d[a] * d[b])
            })
        };
        let (xx, yy, zz) = (entry(0, 0), entry(1, 1), entry(2, 2));
        let (xy, yz, xz) = (entry(0, 1), entry(1, 2), entry(0, 2));
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// Angular velocity of the rigid body with the same angular momentum.
    pub fn omega(&self) -> [f64; 3] {
        let l = Vector3::from(self.angmom());
        self.inertia().try_inverse().map_or([0.0; 3], |inverse| (inverse * l).into())
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
