//! Group functions of formulas: `count(all)`, `vcm(ball,x)`, `bound(all,zmax,box)` and their kin.

use nalgebra::Matrix3;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use perigrain_base::par;
use perigrain_commands::momentum::rotation;
use perigrain_lang::Word;
use perigrain_styles::matter::{own_inertia, solid};
use perigrain_world::{GroupId, Key, Region, World};

/// The names of all group functions.
pub const NAMES: [&str; 13] = [
    "count", "mass", "charge", "xcm", "vcm", "fcm", "bound", "gyration", "ke", "angmom", "torque", "inertia",
    "omega",
];

/// Evaluates a group function; `args` are group, then what the function needs, then maybe a region.
///
/// # Errors
/// Unknown groups, regions, directions; `charge`, which no atom style here has.
pub fn group_function(w: &World, name: &str, args: &[Word], span: Span) -> Result<f64> {
    let extra = match name {
        "count" | "mass" | "charge" | "gyration" | "ke" => 0,
        _ => 1,
    };
    // The formula's grammar has counted the words.
    let none = Word::new("", span);
    let word = |k: usize| args.get(k).unwrap_or(&none);
    let id = group(w, word(0))?;
    let region = args.get(1 + extra).map(|r| region(w, r)).transpose()?;
    let p = &w.particles;
    let members: Vec<usize> = (0..p.len())
        .filter(|&i| p.mask[i] & id.bit() != 0)
        .filter(|&i| region.is_none_or(|r| r.contains(p.x[i])))
        .collect();
    let direction = |k: usize| direction(word(k));
    let m = Members { w, list: &members };
    Ok(match name {
        "count" => members.len() as f64,
        "mass" => m.mass(),
        "charge" => return fail(Code::NOT_SUPPORTED, span, "charge(): no atom style here has charges"),
        "xcm" => m.xcm()[direction(1)?],
        "vcm" => m.vcm()[direction(1)?],
        "fcm" => m.total(|i| p.f[i])[direction(1)?],
        "bound" => m.bound(word(1))?,
        "gyration" => m.gyration(),
        "ke" => m.ke(),
        "angmom" => m.angmom()[direction(1)?],
        "torque" => m.torque()[direction(1)?],
        "omega" => m.omega()[direction(1)?],
        "inertia" => {
            let (a, b) = match word(1).text.as_str() {
                "xx" => (0, 0),
                "yy" => (1, 1),
                "zz" => (2, 2),
                "xy" => (0, 1),
                "yz" => (1, 2),
                "xz" => (0, 2),
                _ => {
                    return fail(Code::BAD_VALUE, word(1).span, "inertia() takes xx, yy, zz, xy, yz or xz");
                }
            };
            m.inertia()[(a, b)]
        }
        _ => return fail(Code::UNKNOWN_WORD, span, format!("there is no group function `{name}`")),
    })
}

/// The group of this name.
///
/// # Errors
/// There is none.
pub fn group(w: &World, name: &Word) -> Result<GroupId> {
    if let Some(id) = w.groups.find(&name.text) {
        return Ok(id);
    }
    let text = format!("there is no group `{}`", name.text);
    missing(Code::UNKNOWN_GROUP, name, text, nearest(&name.text, w.groups.names()))
}

/// The region of this name.
///
/// # Errors
/// There is none.
pub fn region<'a>(w: &'a World, name: &Word) -> Result<&'a Region> {
    if let Some(region) = w.regions.look_up(&name.text) {
        return Ok(region);
    }
    let known = nearest(&name.text, w.regions.keys().map(Key::text));
    missing(Code::UNKNOWN_REGION, name, format!("there is no region `{}`", name.text), known)
}

fn missing<T>(code: Code, name: &Word, text: String, known: Option<&str>) -> Result<T> {
    let mut d = Diagnostic::error(code, name.span, text);
    if let Some(n) = known {
        d = d.help(format!("did you mean `{n}`?"));
    }
    Err(d.into())
}

fn direction(word: &Word) -> Result<usize> {
    match word.text.as_str() {
        "x" => Ok(0),
        "y" => Ok(1),
        "z" => Ok(2),
        other => fail(Code::BAD_VALUE, word.span, format!("a direction is x, y or z, not `{other}`")),
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
        domain.unwrapped(&p.x[i], &p.image[i])
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

    fn bound(&self, which: &Word) -> Result<f64> {
        let axis = match which.text.as_bytes() {
            [a @ b'x'..=b'z', b'm', b'i' | b'a', b'n' | b'x'] => (a - b'x') as usize,
            _ => {
                let text = "bound() takes xmin, xmax, ymin, ymax, zmin or zmax";
                return fail(Code::BAD_VALUE, which.span, text);
            }
        };
        let x = self.list.iter().map(|&i| self.w.particles.x[i][axis]);
        // LAMMPS' value for a bound of nothing.
        const BIG: f64 = 1e20;
        Ok(if which.text.ends_with("min") { x.fold(BIG, f64::min) } else { x.fold(-BIG, f64::max) })
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

    /// Angular momentum about the centre of mass, spins of spheres included.
    pub fn angmom(&self) -> [f64; 3] {
        let c = self.xcm();
        self.total(|i| {
            let (x, v) = (self.unfolded(i), self.w.particles.v[i]);
            let way = cross(sub(x, c), v).map(|a| a * self.m(i));
            if !solid(self.w) {
                return way;
            }
            let (own, omega) = (own_inertia(self.w, i, self.m(i)), self.w.particles.omega[i]);
            [0, 1, 2].map(|d| way[d] + own * omega[d])
        })
    }

    fn torque(&self) -> [f64; 3] {
        let c = self.xcm();
        self.total(|i| cross(sub(self.unfolded(i), c), self.w.particles.f[i]))
    }

    /// Inertia tensor about the centre of mass, of points or of solid spheres.
    pub fn inertia(&self) -> Matrix3<f64> {
        let c = self.xcm();
        let entry = |a: usize, b: usize| {
            self.sum(|i| {
                let d = sub(self.unfolded(i), c);
                let square = if a == b { d[0] * d[0] + d[1] * d[1] + d[2] * d[2] } else { 0.0 };
                let own = if a == b && solid(self.w) { own_inertia(self.w, i, self.m(i)) } else { 0.0 };
                self.m(i) * (square - d[a] * d[b]) + own
            })
        };
        let (xx, yy, zz) = (entry(0, 0), entry(1, 1), entry(2, 2));
        let (xy, yz, xz) = (entry(0, 1), entry(1, 2), entry(0, 2));
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// Angular velocity of the rigid body with the same angular momentum.
    pub fn omega(&self) -> [f64; 3] {
        let i = self.inertia();
        let rows = [0, 1, 2].map(|a| [i[(a, 0)], i[(a, 1)], i[(a, 2)]]);
        rotation(rows, self.angmom(), self.w.settings.lammps())
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
