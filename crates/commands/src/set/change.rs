//! What `set` changes, and how it is done.

use super::scatter::{self, Factors};
use super::{Choice, orientation};
use crate::create_atoms::subset::{Amount, Subset};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_base::math::rng::ParkMiller;
use perigrain_lang::Param;
use perigrain_styles::ActCx;
use perigrain_styles::common::masses_from_density;
use perigrain_world::columns::TEMPERATURE;
use perigrain_world::{Numbers, World};
use std::collections::BTreeSet;

/// What a keyword sets.
pub enum Change {
    /// The type.
    Kind(Param),
    /// The type of about a fraction of the particles.
    Fraction {
        /// The new type.
        kind: u16,
        /// The fraction.
        fraction: f64,
        /// Of the random stream.
        seed: u32,
    },
    /// The type of an exact part of the particles.
    Some {
        /// The new type.
        kind: u16,
        /// How many.
        amount: Amount,
        /// Of the random stream.
        seed: u32,
    },
    /// Image counts along each dimension.
    Image([Option<Param>; 3]),
    /// The mass.
    Mass(Param),
    /// The density.
    Density(Param),
    /// The density of a disc.
    Disc(Param),
    /// Twice the radius.
    Diameter(Param),
    /// The radius of a peridynamic particle.
    Radius(Param),
    /// The radius of a peridynamic particle as the cube root of this part of its volume.
    OfVolume(f64),
    /// A factor on what the bonds of a peridynamic particle bear or on how stiff they are.
    Factors {
        /// Its column.
        column: Numbers,
        /// The factors.
        factors: Factors,
    },
    /// The volume of a peridynamic particle.
    Volume(Param),
    /// The angular velocity.
    Omega([Param; 3]),
    /// The orientation.
    Quat {
        /// The axis.
        axis: [Param; 3],
        /// The angle [degrees].
        angle: Param,
    },
    /// Random orientations from a seed.
    AnyQuat(u32),
    /// The charge.
    Charge(Param),
    /// The dipole moment.
    Moment([Param; 3]),
    /// Dipole moments of a size in random directions from a seed.
    AnyMoment(u32, f64),
    /// The molecule ID.
    Molecule(Param),
    /// The type of bonds with both ends among the chosen.
    Bond(u16),
    /// A coordinate.
    Place(usize, Param),
    /// A component of the velocity.
    Velocity(usize, Param),
    /// A property of fix property/atom.
    Custom {
        /// Its column.
        column: Numbers,
        /// Whole numbers only: fractions are cut off.
        whole: bool,
        /// The value.
        value: Param,
    },
}

/// A keyword with its value and place.
pub struct Item {
    /// As written.
    pub keyword: String,
    /// Keyword and value.
    pub span: Span,
    /// What it sets.
    pub change: Change,
}

impl Item {
    fn has_variable(&self) -> bool {
        let is = |p: &Param| matches!(p, Param::Ref(_));
        match &self.change {
            Change::Fraction { .. }
            | Change::Some { .. }
            | Change::Bond(_)
            | Change::OfVolume(_)
            | Change::AnyQuat(_)
            | Change::AnyMoment(..)
            | Change::Factors { factors: Factors::Drawn(_), .. } => false,
            Change::Image(p) => p.iter().flatten().any(is),
            Change::Omega(p) | Change::Moment(p) => p.iter().any(is),
            Change::Quat { axis, angle } => axis.iter().chain([angle]).any(is),
            Change::Kind(p)
            | Change::Mass(p)
            | Change::Density(p)
            | Change::Disc(p)
            | Change::Diameter(p)
            | Change::Radius(p)
            | Change::Volume(p)
            | Change::Molecule(p)
            | Change::Charge(p)
            | Change::Place(_, p)
            | Change::Velocity(_, p)
            | Change::Factors { factors: Factors::Given(p), .. }
            | Change::Custom { value: p, .. } => is(p),
        }
    }
}

impl Change {
    /// Which fact of the scene it settles.
    pub fn settles(&self) -> Option<&'static str> {
        match self {
            Change::Mass(_) => Some("mass"),
            Change::Density(_) | Change::Disc(_) => Some("density"),
            Change::Diameter(_) | Change::Radius(_) | Change::OfVolume(_) => Some("diameter"),
            Change::Volume(_) => Some("volume"),
            Change::Velocity(..) => Some("velocity"),
            _ => None,
        }
    }
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
pub fn apply(cx: &mut ActCx, choice: &Choice, items: &[Item]) -> Result<()> {
    let chosen = chosen(choice, cx.world);
    // Constants were checked when the line was read: only variables can still turn out wrong.
    let before = items.iter().any(Item::has_variable).then(|| cx.world.particles.clone());
    cx.print("Setting atom values ...");
    for item in items {
        let done = change_particles(cx, item, &chosen);
        match done {
            Ok(count) => cx.print(format!("  {count} settings made for {}", item.keyword)),
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
        Choice::Tags(lo, hi) => (*lo..=*hi).contains(&i64::from(p.tag[i])),
        Choice::Molecules(lo, hi) => (*lo..=*hi).contains(&i64::from(p.molecule[i])),
        Choice::Kinds(lo, hi) => (*lo..=*hi).contains(&p.kind[i]),
        Choice::Group(g) => p.mask[i] & g.bit() != 0,
        Choice::Region(r) => r.contains(p.x[i]),
    };
    (0..p.len()).filter(|&i| meant(i)).collect()
}

fn change_particles(cx: &mut ActCx, item: &Item, chosen: &[usize]) -> Result<usize> {
    let types = cx.world.types;
    let mut checked = |p: &Param, what: &str, limit: Option<Limit>| -> Result<Vec<f64>> {
        let values = cx.per_atom_of(p, chosen)?;
        if let Some(limit) = limit {
            chosen.iter().try_for_each(|&i| limit.check(values[i], types, what, item.span))?;
        }
        Ok(values)
    };
    match &item.change {
        Change::Kind(p) => {
            let v = checked(p, "the type", Some(Limit::Kind))?;
            chosen.iter().for_each(|&i| cx.world.particles.kind[i] = v[i] as u16);
            cx.world.spread_type_masses();
        }
        Change::Some { kind, amount, seed } => {
            return set_some(cx.world, chosen, *kind, *amount, *seed, item.span);
        }
        Change::Image(counts) => {
            let mut values = [None, None, None];
            for (v, count) in values.iter_mut().zip(counts) {
                *v = count.as_ref().map(|p| checked(p, "", None)).transpose()?;
            }
            for &i in chosen {
                let mut image = cx.world.particles.image[i];
                for (n, v) in image.iter_mut().zip(&values) {
                    *n = v.as_ref().map_or(*n, |v| v[i] as i32);
                }
                cx.world.particles.image.set(i, image);
            }
        }
        Change::Fraction { kind, fraction, seed } => {
            return Ok(set_fraction(cx.world, chosen, *kind, *fraction, *seed));
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
        Change::Radius(p) => {
            let v = checked(p, "the radius", Some(Limit::Positive))?;
            chosen.iter().for_each(|&i| cx.world.particles.radius[i] = v[i]);
        }
        Change::OfVolume(part) => {
            perigrain_styles::surface::check_volumes(cx.world, chosen, item.span)?;
            let p = &mut cx.world.particles;
            chosen.iter().for_each(|&i| p.radius[i] = (part * p.volume[i]).cbrt());
        }
        Change::Factors { column, factors: Factors::Given(p) } => {
            let v = checked(p, "the factor", Some(Limit::Positive))?;
            scatter::set(cx.world, chosen, *column, |k| v[chosen[k]]);
        }
        Change::Factors { column, factors: Factors::Drawn(drawn) } => {
            let v = drawn.of(cx.world, chosen);
            scatter::set(cx.world, chosen, *column, |k| v[k]);
        }
        Change::Volume(p) => {
            let v = checked(p, "the volume", Some(Limit::Positive))?;
            chosen.iter().for_each(|&i| cx.world.particles.volume[i] = v[i]);
        }
        Change::Omega(p) => {
            let v = [checked(&p[0], "", None)?, checked(&p[1], "", None)?, checked(&p[2], "", None)?];
            chosen.iter().for_each(|&i| cx.world.particles.omega[i] = [v[0][i], v[1][i], v[2][i]]);
        }
        Change::Quat { axis: [x, y, z], angle } => {
            let [x, y, z] = [checked(x, "", None)?, checked(y, "", None)?, checked(z, "", None)?];
            let angle = checked(angle, "", None)?;
            for &i in chosen {
                let axis = [x[i], y[i], z[i]];
                orientation::check_axis(axis, cx.world)?;
                let lammps = cx.world.settings.lammps();
                cx.world.particles.quat[i] = orientation::about(axis, angle[i], lammps);
            }
        }
        Change::AnyQuat(seed) => orientation::any(cx.world, chosen, *seed),
        Change::Charge(p) => {
            let v = checked(p, "", None)?;
            chosen.iter().for_each(|&i| cx.world.particles.charge[i] = v[i]);
        }
        Change::Moment(p) => {
            let v = [checked(&p[0], "", None)?, checked(&p[1], "", None)?, checked(&p[2], "", None)?];
            chosen.iter().for_each(|&i| cx.world.particles.mu[i] = [v[0][i], v[1][i], v[2][i]]);
        }
        Change::AnyMoment(seed, size) => orientation::any_moment(cx.world, chosen, *seed, *size),
        Change::Molecule(p) => {
            let v = checked(p, "the molecule", Some(Limit::NotNegative))?;
            chosen.iter().for_each(|&i| cx.world.particles.molecule[i] = v[i] as u32);
        }
        Change::Bond(kind) => return Ok(set_bonds(cx.world, chosen, *kind)),
        Change::Place(d, p) => {
            let v = checked(p, "", None)?;
            chosen.iter().for_each(|&i| cx.world.particles.x[i][*d] = v[i]);
        }
        Change::Velocity(d, p) => {
            let v = checked(p, "", None)?;
            chosen.iter().for_each(|&i| cx.world.particles.v[i][*d] = v[i]);
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
