//! The fields of compute continuum/chunk: their names, and their sums at the centres of bins.

use super::Chunks;
use super::grid::Grid;
use super::kernel::Kernel;
use crate::pair_local::of_group;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::{SIX, Vec3, add, dot, scale, sub};
use perigrain_lang::{Args, Word};
use perigrain_styles::matter::Masses;
use perigrain_styles::probe::Interaction;
use perigrain_styles::words::{Alternative, Kind, Value, alternatives};
use perigrain_styles::{BuildCx, Reading};
use perigrain_world::{GroupId, World};
use std::f64::consts::PI;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Count,
    Density,
    Volume,
    Momentum,
    Velocity,
    MomentumGradient,
    VelocityGradient,
    StrainRate,
    Stress,
    Kinetic,
    Contacts,
    BoundaryForce,
    Fabric,
    Temperature,
}

/// Names, with the number of indices; `*` stands for all of them.
const QUANTITIES: [(&str, (usize, Quantity)); 14] = [
    ("natoms", (0, Quantity::Count)),
    ("density", (0, Quantity::Density)),
    ("volume/fraction", (0, Quantity::Volume)),
    ("momentum/*", (1, Quantity::Momentum)),
    ("velocity/*", (1, Quantity::Velocity)),
    ("momentum/grad/*", (2, Quantity::MomentumGradient)),
    ("velocity/grad/*", (2, Quantity::VelocityGradient)),
    ("strain/rate/*", (2, Quantity::StrainRate)),
    ("stress/*", (2, Quantity::Stress)),
    ("stress/ke/*", (2, Quantity::Kinetic)),
    ("stress/contacts/*", (2, Quantity::Contacts)),
    ("boundary/force/*", (1, Quantity::BoundaryForce)),
    ("fabric/*", (2, Quantity::Fabric)),
    ("temperature", (0, Quantity::Temperature)),
];

const AXES: [char; 3] = ['x', 'y', 'z'];

/// One column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    what: Quantity,
    a: usize,
    b: usize,
}

impl Field {
    /// The columns that a word stands for; `None` if it is not a field.
    ///
    /// # Errors
    /// A field with missing or wrong components.
    fn read(word: &Word, flat: bool) -> Result<Option<Vec<Self>>> {
        let dims = if flat { 2 } else { 3 };
        let mut bad = None;
        for (name, (rank, what)) in QUANTITIES {
            let name = plain(name);
            let Some(rest) = word.text.strip_prefix(name) else { continue };
            let component = rest.strip_prefix('/').unwrap_or(rest);
            let one = |letters: &str| -> Option<Vec<usize>> {
                letters.chars().map(|c| AXES[..dims].iter().position(|a| *a == c)).collect()
            };
            let field = |a, b| Self { what, a, b };
            let all = match (rank, component == "*") {
                (0, _) if rest.is_empty() => return Ok(Some(vec![field(0, 0)])),
                (1, true) => (0..dims).map(|a| field(a, 0)).collect(),
                (2, true) => (0..dims * dims).map(|k| field(k / dims, k % dims)).collect(),
                _ => match one(component).filter(|c| rank > 0 && c.len() == rank).as_deref() {
                    Some([a]) => vec![field(*a, 0)],
                    Some([a, b]) => vec![field(*a, *b)],
                    _ => {
                        bad = bad.or((rank > 0).then_some((name, rank)));
                        continue;
                    }
                },
            };
            if rest.starts_with('/') {
                return Ok(Some(all));
            }
        }
        let Some((name, rank)) = bad else { return Ok(None) };
        let (example, letters) = (&"xy"[..rank], if flat { "x and y" } else { "x, y and z" });
        let text = format!("`{}` is no component of the field `{name}`", word.text);
        let help =
            format!("write `{name}/{example}`, with letters {letters}, or `{name}/*` for all components");
        Err(Diagnostic::error(Code::BAD_VALUE, word.span, text).help(help).into())
    }

    /// Whether it is a component of `boundary/force`.
    pub fn is_boundary_force(&self) -> bool {
        self.what == Quantity::BoundaryForce
    }

    /// Whether it needs radii.
    pub fn needs_spheres(&self) -> bool {
        self.what == Quantity::Volume || Needed::of(&[*self]).pairs
    }
}

/// The name of a field without its indices.
fn plain(name: &str) -> &str {
    name.trim_end_matches("/*")
}

/// All columns that a word stands for.
pub struct Columns(pub Vec<Field>);

impl Value for Columns {
    const KIND: Kind = Kind::Or(&Kind::Choice(NAMES), &Kind::Text);
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect(what)?;
        let known = QUANTITIES.iter().map(|q| plain(q.0)).chain(["boundary/atom", "boundary/fix"]);
        let columns = Field::read(word, cx.world.settings.two_dimensional)?;
        columns.map(Self).ok_or_else(|| args.unknown(word, &known.collect::<Vec<_>>()))
    }
}

const NAMES: &[Alternative] = &alternatives(&QUANTITIES);

/// The sums that the columns need.
#[derive(Clone, Copy, Debug, Default)]
pub struct Needed {
    motion: bool,
    thermal: bool,
    contacts: bool,
    fabric: bool,
    force: bool,
    /// Whether pairs must be evaluated.
    pub pairs: bool,
}

impl Needed {
    /// The sums for these columns.
    pub fn of(fields: &[Field]) -> Self {
        use Quantity::{BoundaryForce, Contacts, Fabric, Kinetic, Stress, Temperature};
        let any = |list: &[Quantity]| fields.iter().any(|f| list.contains(&f.what));
        let (contacts, fabric, force) = (any(&[Stress, Contacts]), any(&[Fabric]), any(&[BoundaryForce]));
        let thermal = any(&[Stress, Kinetic, Temperature]);
        let of_contacts = |f: &Field| [Contacts, Fabric, BoundaryForce].contains(&f.what);
        let motion = thermal || fields.iter().any(|f| !of_contacts(f));
        Self { motion, thermal, contacts, fabric, force, pairs: contacts || fabric || force }
    }
}

/// The selection of particles, and the grid.
pub struct Scope<'a> {
    /// The world.
    pub w: &'a World,
    /// Group of the particles that count.
    pub group: GroupId,
    /// Group of the boundary particles.
    pub boundary: Option<GroupId>,
    /// The chunks.
    pub chunks: &'a Chunks<'a>,
    /// Their centres.
    pub grid: &'a Grid,
    /// The kernel.
    pub kernel: &'a Kernel,
}

/// A contact as the line from a particle's centre to its end.
struct Branch {
    /// The centre, in coordinates along the axes of the bins.
    start: Vec3,
    /// The vector from there to the other centre or to the contact point, likewise.
    along: Vec3,
    /// Force on the particle.
    force: Vec3,
    /// Centre minus end.
    arm: Vec3,
    /// Mean of the two volumes; 0 for a boundary.
    volume: f64,
    /// Whether it ends at a boundary.
    ends: bool,
}

impl Scope<'_> {
    /// One over the product of the box lengths along directions without bins.
    fn unbinned(&self) -> f64 {
        let Some(d) = &*self.w.domain else { return 1.0 };
        let (lengths, dims) = (d.lengths(), if self.w.settings.two_dimensional { 2 } else { 3 });
        let missing = (0..dims).filter(|k| !self.grid.has(*k));
        1.0 / missing.map(|k| lengths[k]).product::<f64>()
    }

    fn is_boundary(&self, i: usize) -> bool {
        self.boundary.is_some_and(|g| self.w.particles.mask[i] & g.bit() != 0)
    }

    /// The chunk of a particle that counts.
    fn chunk(&self, i: usize) -> Option<usize> {
        let counts = self.w.particles.mask[i] & self.group.bit() != 0 && !self.is_boundary(i);
        self.chunks.chunk(i).filter(|_| counts)
    }

    /// Volume of a sphere, in two dimensions the area of a disc; 0 for points.
    fn volume(&self, i: usize) -> f64 {
        let r = self.w.particles.radius.get(i).copied().unwrap_or(0.0);
        let area = PI * r * r;
        if self.w.settings.two_dimensional { area } else { 4.0 / 3.0 * area * r }
    }

    /// The corners of the region within the cutoff of a line.
    fn corners(&self, start: Vec3, along: Vec3) -> [Vec3; 2] {
        let (end, c) = (add(start, along), self.kernel.cutoff);
        let corner = |pick: fn(f64, f64) -> f64, c: f64| std::array::from_fn(|k| pick(start[k], end[k]) + c);
        [corner(f64::min, -c), corner(f64::max, c)]
    }

    /// Σ term(i) W over the selected particles; if `counting`, the last sum counts 1 within the cutoff.
    fn points<const N: usize>(
        &self,
        counting: bool,
        term: impl Fn(usize) -> [f64; N] + Sync,
    ) -> Vec<[f64; N]> {
        let (p, c2) = (&self.w.particles, self.kernel.cutoff * self.kernel.cutoff);
        let place = |i: usize| self.grid.along_axes(p.x[i]);
        self.grid.spread(
            self.w.n(),
            |i| self.chunk(i).map(|_| self.corners(place(i), [0.0; 3])),
            |i, shift| {
                let r = add(place(i), shift);
                let r2 = dot(r, r);
                let kernel = self.kernel.at(r2);
                let mut t = term(i).map(|a| a * kernel);
                if counting {
                    t[N - 1] = f64::from(u8::from(r2 < c2));
                }
                t
            },
        )
    }

    /// All contacts of the selected particles.
    fn branches(&self, pairs: &[Interaction], walls: &[[Reading; 7]]) -> Vec<Branch> {
        let p = &self.w.particles;
        let member = |i: u32| self.chunks.chunk(i as usize).is_some();
        let counts = |q: &&Interaction| {
            of_group(self.w, self.group, q) && member(q.i) && member(q.j) && q.force != [0.0; 3]
        };
        let mut all: Vec<Branch> = vec![];
        for q in pairs.iter().filter(counts) {
            let [i, j] = [q.i, q.j].map(|i| i as usize);
            let end = |i: usize, other: usize, sign: f64| {
                // The contact point is in the middle of the overlap.
                let r = q.distance();
                let from_centre = 0.5 * (r + p.radius[i] - p.radius[other]);
                self.to_boundary(i, scale(sign, q.force), scale(sign * from_centre / r, q.d))
            };
            match (self.is_boundary(i), self.is_boundary(j)) {
                (true, true) => {}
                (false, true) => all.push(end(i, j, 1.0)),
                (true, false) => all.push(end(j, i, -1.0)),
                (false, false) => all.push(Branch {
                    start: self.grid.along_axes(p.x[i]),
                    along: self.grid.along_axes(scale(-1.0, q.d)),
                    force: q.force,
                    arm: q.d,
                    volume: 0.5 * (self.volume(i) + self.volume(j)),
                    ends: false,
                }),
            }
        }
        for wall in walls {
            for i in (0..self.w.n()).filter(|&i| self.chunk(i).is_some()) {
                let value = |k: usize| wall[k].atom(self.w, i);
                if value(0) > 0.5 {
                    let (force, point) = ([1, 2, 3].map(value), [4, 5, 6].map(value));
                    all.push(self.to_boundary(i, force, sub(p.x[i], point)));
                }
            }
        }
        all
    }

    fn to_boundary(&self, i: usize, force: Vec3, arm: Vec3) -> Branch {
        let start = self.grid.along_axes(self.w.particles.x[i]);
        let along = self.grid.along_axes(scale(-1.0, arm));
        Branch { start, along, force, arm, volume: 0.0, ends: true }
    }

    /// Σ term ∫ W along contacts.
    fn lines<const N: usize>(
        &self,
        branches: &[Branch],
        term: impl Fn(&Branch) -> [f64; N] + Sync,
    ) -> Vec<[f64; N]> {
        self.grid.spread(
            branches.len(),
            |k| Some(self.corners(branches[k].start, branches[k].along)),
            |k, shift| {
                let b = &branches[k];
                let kernel = self.kernel.along(add(b.start, shift), b.along);
                term(b).map(|a| a * kernel)
            },
        )
    }

    /// −Σ F W at the contact points with a boundary.
    fn ends(&self, branches: &[Branch]) -> Vec<[f64; 3]> {
        let ends: Vec<(Vec3, Vec3)> =
            branches.iter().filter(|b| b.ends).map(|b| (add(b.start, b.along), b.force)).collect();
        self.grid.spread(
            ends.len(),
            |k| Some(self.corners(ends[k].0, [0.0; 3])),
            |k, shift| {
                let r = add(ends[k].0, shift);
                scale(-self.kernel.at(dot(r, r)), ends[k].1)
            },
        )
    }
}

/// −F d, component by component: row a, column b.
fn stress(b: &Branch) -> [f64; 9] {
    std::array::from_fn(|k| -(b.force[k / 3] * b.arm[k % 3]))
}

/// V n n, likewise.
fn fabric(b: &Branch) -> [f64; 9] {
    let d2 = dot(b.arm, b.arm);
    std::array::from_fn(|k| b.volume * b.arm[k / 3] * b.arm[k % 3] / d2)
}

/// The sums of all bins.
pub struct Fields {
    /// Density, volume fraction, momentum, number.
    motion: Vec<[f64; 6]>,
    velocity: Vec<Vec3>,
    /// Kinetic stress: xx yy zz xy xz yz.
    kinetic: Vec<[f64; 6]>,
    contacts: Vec<[f64; 9]>,
    fabric: Vec<[f64; 9]>,
    force: Vec<[f64; 3]>,
    /// Factors from m v² and F d over volumes to pressure units, and from m v² to energies.
    units: [f64; 3],
}

/// Divides by the box lengths along directions without bins.
fn thin<const N: usize>(mut rows: Vec<[f64; N]>, first: usize, over: f64) -> Vec<[f64; N]> {
    rows.iter_mut().flat_map(|r| &mut r[..first]).for_each(|a| *a *= over);
    rows
}

impl Fields {
    /// Computes the sums that are `needed`; the others stay empty.
    pub fn new(s: &Scope, needed: Needed, pairs: &[Interaction], walls: &[[Reading; 7]]) -> Self {
        let (p, masses, c) = (&s.w.particles, Masses::of(s.w), s.w.settings.units.constants());
        let over = s.unbinned();
        let mut all = Self {
            motion: vec![],
            velocity: vec![],
            kinetic: vec![],
            contacts: vec![],
            fabric: vec![],
            force: vec![],
            units: [c.mvv2e * c.nktv2p, c.nktv2p, c.mvv2e],
        };
        if needed.motion {
            let motion = s.points(true, |i| {
                let (m, [x, y, z]) = (masses.get(i), p.v[i]);
                [m, s.volume(i), m * x, m * y, m * z, 0.0]
            });
            all.motion = thin(motion, 5, over);
            let velocity = |[density, _, x, y, z, _]: &[f64; 6]| {
                [*x, *y, *z].map(|q| if *density > 0.0 { q / density } else { 0.0 })
            };
            all.velocity = all.motion.iter().map(velocity).collect();
        }
        if needed.thermal {
            let kinetic = s.points(false, |i| {
                let flow = s.chunk(i).map_or([0.0; 3], |k| all.velocity[k]);
                let (m, u) = (masses.get(i), sub(p.v[i], flow));
                SIX.map(|(a, b)| -(m * u[a] * u[b]))
            });
            all.kinetic = thin(kinetic, 6, over);
        }
        if needed.pairs {
            let branches = s.branches(pairs, walls);
            if needed.contacts {
                all.contacts = thin(s.lines(&branches, stress), 9, over);
            }
            if needed.fabric {
                all.fabric = thin(s.lines(&branches, fabric), 9, over);
            }
            if needed.force {
                all.force = thin(s.ends(&branches), 3, over);
            }
        }
        all
    }

    /// The output columns, bin by bin.
    pub fn rows(&self, fields: &[Field], grid: &Grid) -> Vec<f64> {
        let bins = grid.bins();
        (0..bins).flat_map(|k| fields.iter().map(move |f| self.value(*f, k, grid))).collect()
    }

    fn value(&self, f: Field, k: usize, grid: &Grid) -> f64 {
        let Field { what, a, b } = f;
        let gradient = |a: usize, b: usize| grid.derivative(k, b, |bin| self.velocity[bin][a]);
        let [kinetic, contact, energy] = self.units;
        let thermal = || {
            let of = |pair: &(usize, usize)| *pair == (a.min(b), a.max(b));
            SIX.iter().position(of).map_or(0.0, |six| kinetic * self.kinetic[k][six])
        };
        let contacts = || contact * self.contacts[k][3 * a + b];
        let value = match what {
            Quantity::Count => self.motion[k][5],
            Quantity::Density => self.motion[k][0],
            Quantity::Volume => self.motion[k][1],
            Quantity::Momentum => self.motion[k][2 + a],
            Quantity::Velocity => self.velocity[k][a],
            Quantity::MomentumGradient => grid.derivative(k, b, |bin| self.motion[bin][2 + a]),
            Quantity::VelocityGradient => gradient(a, b),
            Quantity::StrainRate => 0.5 * (gradient(a, b) + gradient(b, a)),
            Quantity::Stress => thermal() + contacts(),
            Quantity::Kinetic => thermal(),
            Quantity::Contacts => contacts(),
            Quantity::BoundaryForce => self.force[k][a],
            Quantity::Fabric => self.fabric[k][3 * a + b],
            Quantity::Temperature => {
                let [xx, yy, zz, ..] = self.kinetic[k];
                -0.5 * energy * (xx + yy + zz)
            }
        };
        // Avoids −0 for empty bins.
        value + 0.0
    }
}
