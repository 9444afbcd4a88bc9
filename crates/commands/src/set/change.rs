//! What `set` changes, and how it is done.

use super::scatter::{self, Factors};
use super::{Choice, Ids, Kinds, Molecules, limited, orientation, value};
use crate::create_atoms::subset::{Amount, Subset};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_base::math::rng::ParkMiller;
use perigrain_lang::{Args, Param, Word};
use perigrain_styles::common::{self, masses_from_density};
use perigrain_styles::peri_view::BOND_FACTORS;
use perigrain_styles::words::{
    At, Fraction, Given, Kind, MarsagliaSeed, Nullable, Or, PerAtom, Seed, Types, Value, Words,
};
use perigrain_styles::{ActCx, BuildCx};
use perigrain_world::columns::TEMPERATURE;
use perigrain_world::{Numbers, World};
use std::collections::BTreeSet;

/// What a keyword sets.
#[derive(Words)]
#[word(
    keywords,
    refused = "spin spin/atom shape length tri theta theta/random angmom angle dihedral improper epsilon rheo/rho rheo/status sph/rho"
)]
pub enum Change {
    /// The molecule ID.
    Mol(
        #[word(name = "M", with = limited("the molecule", Some(Limit::NotNegative)), kind = Kind::Param)]
        Param,
    ),
    /// The type of all bonds with both ends among the chosen.
    Bond(#[word(name = "T", with = bond, kind = Kind::Whole)] u16),
    /// The type.
    #[word("type")]
    Kind(#[word(name = "T", with = limited("the type", Some(Limit::Kind)), kind = Kind::Param)] Param),
    /// The type of about a part P of the particles, decided for each by a random number that belongs to its place.
    #[word("type/fraction")]
    Fraction(#[word(name = "T")] Kinds, #[word(name = "P")] Fraction, #[word(name = "SEED")] Seed),
    /// The type of exactly a part P of the particles, of those that LAMMPS changes.
    #[word("type/ratio")]
    Ratio(#[word(name = "T")] Kinds, #[word(name = "P")] Fraction, #[word(name = "SEED")] MarsagliaSeed),
    /// The type of exactly N particles, of those that LAMMPS changes.
    #[word("type/subset")]
    Subset(
        #[word(name = "T")] Kinds,
        #[word(name = "N", what = "the number of particles", from = 0)] i64,
        #[word(name = "SEED")] MarsagliaSeed,
    ),
    /// The image counts along each dimension; `NULL` leaves one alone.
    Image(#[word(name = "NX NY NZ", what = "the image count")] [At<Nullable<PerAtom>>; 3]),
    /// The mass per area of a disc, in flat scenes.
    #[word("density/disc")]
    Disc(#[word(name = "ρ", with = limited("the density", Some(Limit::Positive)), kind = Kind::Param)] Param),
    /// The mass.
    Mass(#[word(name = "M", with = limited("the mass", Some(Limit::Positive)), kind = Kind::Param)] Param),
    /// Of a sphere it sets the mass to 4/3 π r³ ρ with the radius it has now; of a peridynamic particle without radius the mass to ρ itself
    /// (LAMMPS' convention).
    Density(
        #[word(name = "ρ", with = limited("the density", Some(Limit::Positive)), kind = Kind::Param)] Param,
    ),
    /// Twice the radius; the mass stays.
    Diameter(
        #[word(name = "D", with = limited("the diameter", Some(Limit::NotNegative)), kind = Kind::Param)]
        Param,
    ),
    /// The sphere of a peridynamic particle that meets others; mass and volume stay.
    #[word("peri/radius")]
    Radius(#[word(name = "R")] Radius),
    /// A factor on the stretch at which bonds of a peridynamic particle break: of both ends the smaller one counts, as a chain breaks at its
    /// weakest link.
    #[word("peri/strength")]
    Strength(#[word(name = "F")] Factors),
    /// A factor on the micro-modulus of bonds of a peridynamic particle: the mean of both ends counts (`pair_style peri/pmb` alone).
    #[word("peri/stiffness")]
    Stiffness(#[word(name = "F")] Factors),
    /// The volume of a peridynamic particle.
    Volume(
        #[word(name = "V", with = limited("the volume", Some(Limit::Positive)), kind = Kind::Param)] Param,
    ),
    /// The angular velocity.
    Omega(#[word(name = "WX WY WZ", what = "the angular velocity")] [PerAtom; 3]),
    /// A component of the angular velocity; not in LAMMPS.
    Omegax(#[word(name = "W", what = "the angular velocity")] PerAtom),
    /// A component of the angular velocity; not in LAMMPS.
    Omegay(#[word(name = "W", what = "the angular velocity")] PerAtom),
    /// A component of the angular velocity; not in LAMMPS.
    Omegaz(#[word(name = "W", what = "the angular velocity")] PerAtom),
    /// The orientation: turned by THETA degrees about an axis of any length; LAMMPS, and `-compat lammps`, turn farther about an axis that
    /// is not of unit length.
    Quat {
        /// The axis.
        #[word(name = "A B C", what = "the axis")]
        axis: [At<PerAtom>; 3],
        /// The angle.
        #[word(name = "THETA", what = "the angle [degrees]")]
        angle: PerAtom,
    },
    /// Random orientations.
    #[word("quat/random")]
    AnyQuat(#[word(name = "SEED")] Seed),
    /// The charge.
    Charge(#[word(name = "Q", what = "the charge")] PerAtom),
    /// The dipole moment.
    #[word("dipole")]
    Moment(#[word(name = "MUX MUY MUZ", what = "the dipole moment")] [PerAtom; 3]),
    /// Moments of size MU in directions that LAMMPS draws too: corners of a cube are likelier.
    #[word("dipole/random")]
    AnyMoment(#[word(name = "SEED")] Seed, #[word(name = "MU", what = "the dipole moment", positive)] f64),
    /// A coordinate.
    X(#[word(name = "X", what = "the coordinate")] PerAtom),
    /// A coordinate.
    Y(#[word(name = "X", what = "the coordinate")] PerAtom),
    /// A coordinate.
    Z(#[word(name = "X", what = "the coordinate")] PerAtom),
    /// A component of the velocity.
    Vx(#[word(name = "V", what = "the velocity")] PerAtom),
    /// A component of the velocity.
    Vy(#[word(name = "V", what = "the velocity")] PerAtom),
    /// A component of the velocity.
    Vz(#[word(name = "V", what = "the velocity")] PerAtom),
    /// A property of fix property/atom.
    #[word(skip)]
    Custom {
        /// Its column.
        column: Numbers,
        /// Whole numbers only: fractions are cut off.
        whole: bool,
        /// The value.
        value: Param,
    },
}

/// The radius of a peridynamic particle.
pub type Radius = Or<OfVolume, RadiusValue>;

/// A radius, or a variable that gives it.
pub struct RadiusValue(pub Param);

impl Value for RadiusValue {
    const KIND: Kind = Kind::Param;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let what = "the radius (quasi, half or a number)";
        value(args, cx, what, Some(Limit::Positive)).map(Self)
    }
}

/// A radius that follows from the volume V.
#[derive(Clone, Copy, Words)]
#[word(what = "radius")]
pub enum OfVolume {
    /// The radius of the sphere of this volume, (3V/4π)^⅓ = 0.62 spacings of a lattice (Hartmann et al. 2022).
    Quasi,
    /// The radius V^⅓/2.
    Half,
}

impl OfVolume {
    /// The third power of the radius over the volume.
    fn part(self) -> f64 {
        match self {
            // Section 3.1 of Hartmann et al. 2022.
            Self::Quasi => 0.75 / std::f64::consts::PI,
            Self::Half => 0.125,
        }
    }
}

/// Takes a bond type.
fn bond(a: &mut Args, cx: &BuildCx) -> Result<u16> {
    // Particles without bonds are refused at the keyword, whatever the type.
    if !cx.world.particles.style.bonded {
        return a.integer("the bond type").map(|_| 1);
    }
    common::bond_type(a, cx.world.bonds.types)
}

/// Whether a value comes from a variable.
fn varies(p: &Param) -> bool {
    matches!(p, Param::Ref(_))
}

impl Change {
    /// Whether it takes values from a variable, which may turn out wrong.
    fn has_variable(&self) -> bool {
        match self {
            Change::Fraction(..)
            | Change::Ratio(..)
            | Change::Subset(..)
            | Change::Bond(_)
            | Change::Radius(Or::Word(_))
            | Change::AnyQuat(_)
            | Change::AnyMoment(..)
            | Change::Strength(Or::Word(_))
            | Change::Stiffness(Or::Word(_)) => false,
            Change::Image(p) => p.iter().filter_map(|p| p.value.0.as_ref()).any(|p| varies(&p.0)),
            Change::Omega(p) | Change::Moment(p) => p.iter().any(|p| varies(&p.0)),
            Change::Quat { axis, angle } => {
                axis.iter().map(|p| &p.value).chain([angle]).any(|p| varies(&p.0))
            }
            Change::Kind(p)
            | Change::Mass(p)
            | Change::Density(p)
            | Change::Disc(p)
            | Change::Diameter(p)
            | Change::Radius(Or::Else(RadiusValue(p)))
            | Change::Volume(p)
            | Change::Mol(p)
            | Change::Custom { value: p, .. } => varies(p),
            Change::Charge(p)
            | Change::X(p)
            | Change::Y(p)
            | Change::Z(p)
            | Change::Vx(p)
            | Change::Vy(p)
            | Change::Vz(p)
            | Change::Omegax(p)
            | Change::Omegay(p)
            | Change::Omegaz(p) => varies(&p.0),
            Change::Strength(Or::Else(p)) | Change::Stiffness(Or::Else(p)) => varies(&p.0),
        }
    }

    /// Refuses what particles of this scene do not have, and values that do not go with it.
    pub fn check(&self, keyword: &Word, cx: &BuildCx) -> Result<()> {
        let style = cx.world.particles.style;
        let there = match self {
            Change::Mass(_) | Change::Density(_) => style.sphere || style.peri,
            Change::Disc(_) | Change::Diameter(_) | Change::Omega(_) => style.sphere,
            Change::Omegax(_) | Change::Omegay(_) | Change::Omegaz(_) => style.sphere,
            Change::Radius(_) => style.sphere && style.peri,
            Change::Strength(_) | Change::Stiffness(_) | Change::Volume(_) => style.peri,
            Change::Quat { .. } | Change::AnyQuat(_) => style.oriented,
            Change::Charge(_) => style.charged,
            Change::Moment(_) | Change::AnyMoment(..) => style.dipole,
            Change::Mol(_) => style.molecules,
            Change::Bond(_) => style.bonded,
            _ => true,
        };
        if !there {
            let text = format!("particles of this atom_style have no {}", keyword.text);
            return fail(Code::CONFLICT, keyword.span, text);
        }
        match self {
            Change::Disc(_) if !cx.world.settings.two_dimensional => {
                let text = "`density/disc` belongs to flat scenes (`dimension 2`)";
                fail(Code::CONFLICT, keyword.span, text)
            }
            Change::Image(counts) => check_images(counts, cx),
            Change::Quat { axis, .. } => check_axis(axis, cx.world),
            Change::Strength(f) | Change::Stiffness(f) => scatter::check(f, cx),
            _ => Ok(()),
        }
    }

    /// Which fact of the scene it settles.
    pub fn settles(&self) -> Option<&'static str> {
        match self {
            Change::Mass(_) => Some("mass"),
            Change::Density(_) | Change::Disc(_) => Some("density"),
            Change::Diameter(_) | Change::Radius(_) => Some("diameter"),
            Change::Volume(_) => Some("volume"),
            Change::Vx(_) | Change::Vy(_) | Change::Vz(_) => Some("velocity"),
            _ => None,
        }
    }
}

/// Refuses image counts that are not whole, or along dimensions that do not repeat.
fn check_images(counts: &[At<Nullable<PerAtom>>; 3], cx: &BuildCx) -> Result<()> {
    let domain = common::domain(cx)?;
    for (d, At { value, span, .. }) in counts.iter().enumerate() {
        let Nullable(Some(PerAtom(param))) = value else { continue };
        if !domain.boundary.periodic(d) && !matches!(param, Param::Number(0.0)) {
            let text = format!("the box does not repeat along {}: write 0 or NULL", ["x", "y", "z"][d]);
            return fail(Code::CONFLICT, *span, text);
        }
        if matches!(param, Param::Number(x) if x.fract() != 0.0) {
            return fail(Code::BAD_NUMBER, *span, "an image count must be a whole number");
        }
    }
    Ok(())
}

/// Refuses an axis of numbers that is none.
fn check_axis(axis: &[At<PerAtom>; 3], w: &World) -> Result<()> {
    let [Param::Number(x), Param::Number(y), Param::Number(z)] = axis.each_ref().map(|p| &p.value.0) else {
        return Ok(());
    };
    orientation::check_axis([*x, *y, *z], w).map_err(|e| e.at(axis[0].span.to(axis[2].span)))
}

/// What a value must keep to.
#[derive(Clone, Copy)]
pub enum Limit {
    /// Greater than zero.
    Positive,
    /// Zero or greater.
    NotNegative,
    /// A type.
    Kind,
}

impl Limit {
    /// Refuses a value that does not keep to it.
    pub fn check(self, x: f64, types: usize, what: &str, span: Span) -> Result<()> {
        let (ok, want) = match self {
            Limit::Positive => (x > 0.0, "greater than zero".to_string()),
            Limit::NotNegative => (x >= 0.0, "not negative".to_string()),
            Limit::Kind => (x >= 1.0 && x < types as f64 + 1.0, format!("a type from 1 to {types}")),
        };
        if ok { Ok(()) } else { fail(Code::BAD_VALUE, span, format!("{what} must be {want}: {x}")) }
    }
}

/// Changes the chosen particles, item by item; all or nothing.
pub fn apply(cx: &mut ActCx, choice: &Choice, items: &[Given<Change>]) -> Result<()> {
    let chosen = chosen(choice, cx.world);
    // Constants were checked when the line was read: only variables can still turn out wrong.
    let before = items.iter().any(|item| item.value.has_variable()).then(|| cx.world.particles.clone());
    cx.print("Setting atom values ...");
    for item in items {
        let done = change_particles(cx, item, &chosen);
        match done {
            Ok(count) => cx.print(format!("  {count} settings made for {}", item.word.text)),
            Err(d) => {
                if let Some(before) = before {
                    cx.world.particles = before;
                }
                return Err(d.at(item.span));
            }
        }
    }
    cx.world.touch();
    Ok(())
}

/// Indices of the particles that are meant.
fn chosen(choice: &Choice, w: &World) -> Vec<usize> {
    let p = &w.particles;
    let meant = |i: usize| match choice {
        Choice::Atom(Ids(lo, hi)) => (*lo..=*hi).contains(&i64::from(p.tag[i])),
        Choice::Mol(Molecules(lo, hi)) => (*lo..=*hi).contains(&i64::from(p.molecule[i])),
        Choice::Type(Types(lo, hi)) => (*lo..=*hi).contains(&p.kind[i]),
        Choice::Group(g) => p.mask[i] & g.bit() != 0,
        Choice::Region(r) => r.contains(p.x[i]),
    };
    (0..p.len()).filter(|&i| meant(i)).collect()
}

fn change_particles(cx: &mut ActCx, item: &Given<Change>, chosen: &[usize]) -> Result<usize> {
    let types = cx.world.types;
    let mut checked = |p: &Param, what: &str, limit: Option<Limit>| -> Result<Vec<f64>> {
        let values = cx.per_atom_of(p, chosen)?;
        if let Some(limit) = limit {
            chosen.iter().try_for_each(|&i| limit.check(values[i], types, what, item.span))?;
        }
        Ok(values)
    };
    match &item.value {
        Change::Kind(p) => {
            let v = checked(p, "the type", Some(Limit::Kind))?;
            chosen.iter().for_each(|&i| cx.world.particles.kind[i] = v[i] as u16);
            cx.world.spread_type_masses();
        }
        Change::Ratio(kind, part, seed) => {
            return set_some(cx.world, chosen, kind.0, Amount::Ratio(part.0), seed.0, item.span);
        }
        Change::Subset(kind, number, seed) => {
            return set_some(cx.world, chosen, kind.0, Amount::Count(*number), seed.0, item.span);
        }
        Change::Image(counts) => {
            let mut values = [None, None, None];
            for (v, count) in values.iter_mut().zip(counts) {
                *v = count.value.0.as_ref().map(|p| checked(&p.0, "", None)).transpose()?;
            }
            for &i in chosen {
                let mut image = cx.world.particles.image[i];
                for (n, v) in image.iter_mut().zip(&values) {
                    *n = v.as_ref().map_or(*n, |v| v[i] as i32);
                }
                cx.world.particles.image.set(i, image);
            }
        }
        Change::Fraction(kind, part, seed) => {
            return Ok(set_fraction(cx.world, chosen, kind.0, part.0, seed.0));
        }
        Change::Custom { column, whole, value } => {
            let limit = column.plays(*TEMPERATURE).then_some(Limit::NotNegative);
            let (v, n) = (checked(value, "the value", limit)?, cx.world.n());
            let values = cx.world.columns.scalar(*column, n);
            values.resize(n, 0.0);
            chosen.iter().for_each(|&i| values[i] = if *whole { v[i].trunc() } else { v[i] });
        }
        Change::Mass(p) => {
            let v = checked(p, "the mass", Some(Limit::Positive))?;
            chosen.iter().for_each(|&i| cx.world.particles.mass[i] = v[i]);
        }
        Change::Density(p) => {
            let v = checked(p, "the density", Some(Limit::Positive))?;
            masses_from_density(&mut cx.world.particles, chosen, &v);
        }
        Change::Disc(p) => {
            let v = checked(p, "the density", Some(Limit::Positive))?;
            let particles = &mut cx.world.particles;
            for &i in chosen {
                let r = particles.radius[i];
                particles.density[i] = v[i];
                particles.mass[i] = if r > 0.0 { std::f64::consts::PI * r * r * v[i] } else { v[i] };
            }
        }
        Change::Diameter(p) => {
            let v = checked(p, "the diameter", Some(Limit::NotNegative))?;
            chosen.iter().for_each(|&i| cx.world.particles.radius[i] = 0.5 * v[i]);
        }
        Change::Radius(Or::Else(RadiusValue(p))) => {
            let v = checked(p, "the radius", Some(Limit::Positive))?;
            chosen.iter().for_each(|&i| cx.world.particles.radius[i] = v[i]);
        }
        Change::Radius(Or::Word(rule)) => {
            perigrain_styles::surface::check_volumes(cx.world, chosen, item.span)?;
            let p = &mut cx.world.particles;
            chosen.iter().for_each(|&i| p.radius[i] = (rule.part() * p.volume[i]).cbrt());
        }
        Change::Strength(factors) | Change::Stiffness(factors) => {
            let [strength, stiffness] = &BOND_FACTORS;
            let column = if matches!(item.value, Change::Strength(_)) { **strength } else { **stiffness };
            let given = match factors {
                Or::Else(p) => {
                    let v = checked(&p.0, "the factor", Some(Limit::Positive))?;
                    chosen.iter().map(|&i| v[i]).collect()
                }
                Or::Word(drawn) => drawn.of(cx.world, chosen),
            };
            scatter::set(cx.world, chosen, column, &given);
        }
        Change::Volume(p) => {
            let v = checked(p, "the volume", Some(Limit::Positive))?;
            chosen.iter().for_each(|&i| cx.world.particles.volume[i] = v[i]);
        }
        Change::Omega(p) => {
            let v = [checked(&p[0].0, "", None)?, checked(&p[1].0, "", None)?, checked(&p[2].0, "", None)?];
            chosen.iter().for_each(|&i| cx.world.particles.omega[i] = [v[0][i], v[1][i], v[2][i]]);
        }
        Change::Quat { axis: [x, y, z], angle } => {
            let mut along = |p: &At<PerAtom>| checked(&p.value.0, "", None);
            let [x, y, z] = [along(x)?, along(y)?, along(z)?];
            let angle = checked(&angle.0, "", None)?;
            for &i in chosen {
                let axis = [x[i], y[i], z[i]];
                orientation::check_axis(axis, cx.world)?;
                let lammps = cx.world.settings.lammps();
                cx.world.particles.quat[i] = orientation::about(axis, angle[i], lammps);
            }
        }
        Change::AnyQuat(seed) => orientation::any(cx.world, chosen, seed.0),
        Change::Charge(p) => {
            let v = checked(&p.0, "", None)?;
            chosen.iter().for_each(|&i| cx.world.particles.charge[i] = v[i]);
        }
        Change::Moment(p) => {
            let v = [checked(&p[0].0, "", None)?, checked(&p[1].0, "", None)?, checked(&p[2].0, "", None)?];
            chosen.iter().for_each(|&i| cx.world.particles.mu[i] = [v[0][i], v[1][i], v[2][i]]);
        }
        Change::AnyMoment(seed, size) => orientation::any_moment(cx.world, chosen, seed.0, *size),
        Change::Mol(p) => {
            let v = checked(p, "the molecule", Some(Limit::NotNegative))?;
            chosen.iter().for_each(|&i| cx.world.particles.molecule[i] = v[i] as u32);
        }
        Change::Bond(kind) => return Ok(set_bonds(cx.world, chosen, *kind)),
        Change::X(p) | Change::Y(p) | Change::Z(p) => {
            let (d, v) = (usize::from(item.word.text.as_bytes()[0] - b'x'), checked(&p.0, "", None)?);
            chosen.iter().for_each(|&i| cx.world.particles.x[i][d] = v[i]);
        }
        Change::Vx(p) | Change::Vy(p) | Change::Vz(p) => {
            let (d, v) = (usize::from(item.word.text.as_bytes()[1] - b'x'), checked(&p.0, "", None)?);
            chosen.iter().for_each(|&i| cx.world.particles.v[i][d] = v[i]);
        }
        Change::Omegax(p) | Change::Omegay(p) | Change::Omegaz(p) => {
            let (d, v) = (usize::from(item.word.text.as_bytes()[5] - b'x'), checked(&p.0, "", None)?);
            chosen.iter().for_each(|&i| cx.world.particles.omega[i][d] = v[i]);
        }
    }
    Ok(chosen.len())
}

/// Counts bonds, as LAMMPS does, not particles.
fn set_bonds(w: &mut World, chosen: &[usize], kind: u16) -> usize {
    let tags: BTreeSet<u32> = chosen.iter().map(|&i| w.particles.tag[i]).collect();
    let mut count = 0;
    for bond in w.bonds.list.iter_mut().filter(|b| b.ends.iter().all(|t| tags.contains(t))) {
        bond.kind = i32::from(kind);
        count += 1;
    }
    w.bonds.changes += 1;
    count
}

fn set_fraction(w: &mut World, chosen: &[usize], kind: u16, fraction: f64, seed: u32) -> usize {
    let mut stream = ParkMiller::new(seed);
    let mut count = 0;
    for &i in chosen {
        stream.reset_at(seed, w.particles.x[i]);
        if stream.uniform() <= fraction {
            w.particles.kind[i] = kind;
            count += 1;
        }
    }
    w.spread_type_masses();
    count
}

fn set_some(
    w: &mut World,
    chosen: &[usize],
    kind: u16,
    amount: Amount,
    seed: u32,
    span: Span,
) -> Result<usize> {
    let list = Subset { amount, seed, span }.of(chosen.to_vec())?;
    for &i in &list {
        w.particles.kind[i] = kind;
    }
    w.spread_type_masses();
    Ok(list.len())
}
