//! The bonded particles of a group as a body: in the order of space, with the stiffnesses of the bond style.

use super::words::{Shape, Words};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::vec3::{Vec3, length};
use perigrain_bonded::stiffness::Modes;
use perigrain_statics::ends::Sample;
use perigrain_statics::network::Network;
use perigrain_styles::BondForce;
use perigrain_styles::bond::Loaded;
use perigrain_styles::pull::{apart, find, periods};
use perigrain_world::{GroupId, World};
use std::f64::consts::PI;

/// A body.
pub struct Scene {
    /// Where its particles are in the world.
    pub places: Vec<usize>,
    /// Centres [length].
    pub x: Vec<Vec3>,
    /// Radii [length].
    pub radius: Vec<f64>,
    /// Its bonds.
    pub network: Network,
    /// Queries to the bond style, one per bond, in the order of the network; only where bonds are to be varied or to break.
    pub bonds: Vec<BondQuery>,
    /// Edges of the box, zero where it does not repeat.
    pub period: Vec3,
}

/// A query to a bond style about one bond.
#[derive(Clone, Copy, Debug)]
pub struct BondQuery {
    /// Type.
    pub kind: u16,
    /// Length at rest [length].
    pub length: f64,
    /// Radii of the ends [length].
    pub radii: [f64; 2],
    /// Their IDs.
    pub ids: [u32; 2],
}

impl BondQuery {
    /// The bond, as it bears this.
    pub fn bearing(&self, bears: Modes) -> Loaded {
        let Self { kind, length, radii, ids } = *self;
        Loaded { kind, length, radii, ids, bears }
    }
}

impl Scene {
    /// Of the particles of a group and the bonds that act between them, which may be going to be `varied` or to break.
    ///
    /// # Errors
    /// No bonds, bonds without a stiffness, lost ends.
    pub fn new(w: &World, group: GroupId, style: &dyn BondForce, varied: bool, span: Span) -> Result<Self> {
        let period = periods(w)?;
        let p = &w.particles;
        let member = |i: usize| p.mask[i] & group.bit() != 0;
        let places = in_space((0..w.n()).filter(|i| member(*i)).collect(), &p.x);
        let mut row = vec![u32::MAX; w.n()];
        places.iter().enumerate().for_each(|(k, place)| row[*place] = k as u32);
        // Of millions of bonds no more is kept than where they stand in the list, and the rows of their ends.
        let (mut listed, mut ends) = (vec![], vec![]);
        for (at, bond) in find(w, |_| true, span)? {
            if bond.ends.iter().all(|i| member(*i)) {
                listed.push(at as u32);
                ends.push(bond.ends.map(|i| row[i]));
            }
        }
        if listed.is_empty() {
            let text = format!("there are no bonds between particles of group `{}`", w.groups.name(group));
            let help =
                "make some with `create_bonds` or `read_data`, and check which particles the group holds";
            return Err(Diagnostic::error(Code::WRONG_ORDER, span, text).help(help).into());
        }
        let joined = |k: usize| ends[k].map(|row| places[row as usize]);
        // `apart` is first less second.
        let vector = |k: usize| apart(w, &period, joined(k)).map(|a| -a);
        let query = |k: usize| {
            let bond = &w.bonds.list[listed[k] as usize];
            BondQuery {
                kind: bond.kind as u16,
                length: if bond.length > 0.0 { bond.length } else { length(vector(k)) },
                radii: joined(k).map(|i| p.radius.get(i).copied().unwrap_or(0.0)),
                ids: bond.ends,
            }
        };
        for k in 0..ends.len() {
            check(w, &query(k), length(vector(k)), joined(k), style, span)?;
        }
        let mut network = Network::new(places.len(), &ends, |k| (vector(k), stiffness(style, &query(k))));
        // The origin of bonds no longer matters once the style has been queried.
        let origin = std::mem::take(&mut network.pairs.origin);
        let bonds = origin.into_iter().filter(|_| varied).map(|k| query(k as usize)).collect();
        let x = places.iter().map(|i| p.x[*i]).collect();
        // Particles without a radius reach half way to their partners.
        let half =
            0.5 * (0..network.bonds()).map(|k| network.length(k)).sum::<f64>() / network.bonds() as f64;
        let radius =
            places.iter().map(|i| p.radius.get(*i).copied().filter(|r| *r > 0.0).unwrap_or(half)).collect();
        Ok(Self { places, x, radius, network, bonds, period: period.length })
    }

    /// The spheres, along the axis of a load.
    pub fn sample(&self, axis: usize) -> Sample<'_> {
        Sample { x: &self.x, radius: &self.radius, axis }
    }

    /// How wide the body is in a direction: the box where it repeats [length].
    pub fn width(&self, d: usize) -> f64 {
        if self.period[d] > 0.0 {
            return self.period[d];
        }
        let [lo, hi] = self.sample(0).extent(d);
        hi - lo
    }

    /// Its cross-section [length²].
    pub fn area(&self, words: &Words) -> f64 {
        let [a, b] = self.sample(words.axis).across().map(|d| self.width(d));
        match words.shape {
            Shape::Block => a * b,
            Shape::Cylinder => 0.25 * PI * (0.5 * (a + b)).powi(2),
            Shape::Area(area) => area,
        }
    }

    /// Refuses a load along an axis in which bonds cross the face of a periodic box.
    ///
    /// # Errors
    /// The ids of two particles so bonded.
    pub fn has_ends(&self, w: &World, axis: usize, span: Span) -> Result<()> {
        if self.period[axis] == 0.0 {
            return Ok(());
        }
        for (bond, [i, j]) in self.network.pairs.ends.iter().map(|e| e.map(|i| i as usize)).enumerate() {
            if (self.x[j][axis] - self.x[i][axis] - self.network.d(bond)[axis]).abs()
                > 0.5 * self.period[axis]
            {
                let name = ["x", "y", "z"][axis];
                let [a, b] = [i, j].map(|k| w.particles.tag[self.places[k]]);
                let text = format!(
                    "the body has no ends along {name}: a bond between particles {a} and {b} crosses the periodic face"
                );
                let help = "`calibrate periodic` is for cells without ends; else leave such bonds out, or make the boundary f";
                return Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into());
            }
        }
        Ok(())
    }

    /// Gives the bonds the stiffnesses of a style.
    pub fn restyle(&mut self, style: &dyn BondForce) {
        for (k, query) in self.network.k.iter_mut().zip(&self.bonds) {
            *k = stiffness(style, query);
        }
    }
}

fn stiffness(style: &dyn BondForce, query: &BondQuery) -> perigrain_bonded::stiffness::Stiffness {
    style.stiffness(query.kind, query.length, query.radii).unwrap_or_default()
}

/// Refuses bonds without a stiffness, and ends on top of each other.
fn check(
    w: &World,
    query: &BondQuery,
    apart: f64,
    ends: [usize; 2],
    style: &dyn BondForce,
    span: Span,
) -> Result<()> {
    let [a, b] = ends.map(|i| w.particles.tag[i]);
    let (name, kind) = (style.name(), query.kind);
    if apart.is_nan() || apart <= 0.0 {
        return fail(Code::CONFLICT, span, format!("the bonded particles {a} and {b} are in one place"));
    }
    if !style.covers(kind) {
        let text = format!("bond_style {name} has no coefficients for bond type {kind}");
        return Err(Diagnostic::error(Code::INCOMPLETE, span, text)
            .help(format!("add `bond_coeff {kind} …` before this line"))
            .into());
    }
    let Some(k) = style.stiffness(kind, query.length, query.radii) else {
        let text = format!("bonds of bond_style {name} have no stiffness for small displacements");
        return Err(Diagnostic::error(Code::CONFLICT, span, text)
            .help("bond_style bpm/beam, bpm/rotational, bpm/spring and harmonic have one")
            .into());
    };
    let all = [k.normal, k.shear, k.twist, k.bend];
    if all.iter().any(|k| !k.is_finite() || *k < 0.0) {
        let text = format!("the bond between particles {a} and {b} has a negative or infinite stiffness");
        return Err(Diagnostic::error(Code::BAD_VALUE, span, text)
            .help(format!("check `bond_coeff {kind}` and the radii of the particles"))
            .into());
    }
    Ok(())
}

/// Particles along a curve that fills space, so that neighbours stand near each other: by the interleaved digits of their
/// coordinates.
fn in_space(mut places: Vec<usize>, x: &[Vec3]) -> Vec<usize> {
    let mut low = [f64::INFINITY; 3];
    let mut span = 0.0f64;
    for d in 0..3 {
        low[d] = places.iter().fold(f64::INFINITY, |low, i| low.min(x[*i][d]));
        let high = places.iter().fold(f64::NEG_INFINITY, |high, i| high.max(x[*i][d]));
        span = span.max(high - low[d]);
    }
    let scale = if span > 0.0 { f64::from((1 << 21) - 1) / span } else { 0.0 };
    // Two free places behind each of 21 digits.
    let spread = |a: f64| (0..21).fold(0u64, |key, bit| key | ((a as u64) >> bit & 1) << (3 * bit));
    places.sort_by_cached_key(|i| {
        let digits: [u64; 3] = std::array::from_fn(|d| spread((x[*i][d] - low[d]) * scale));
        (digits[2] << 2 | digits[1] << 1 | digits[0], *i)
    });
    places
}
