//! Writing a data file: numbers in the shortest form that is read back to the same bits.

use super::{Column, columns};
use perigrain_base::math::cformat::shortest;
use perigrain_world::index::Index;
use perigrain_world::{Angle, Angles, Particles, Properties, World};
use std::f64::consts::PI;
use std::io::{Result, Write};

/// What a data file gets besides particles.
#[derive(Clone, Copy, Debug)]
pub struct With {
    /// Coefficients of bonds and angles.
    pub coeffs: bool,
    /// Sections of fixes.
    pub fixes: bool,
}

/// Writes the whole scene as LAMMPS' write_data does.
pub fn write(out: &mut dyn Write, w: &World, with: With) -> Result<()> {
    let units = w.settings.units.name();
    writeln!(
        out,
        "LAMMPS data file via write_data, perigrain {}, timestep = {}, units = {units}\n",
        env!("CARGO_PKG_VERSION"),
        w.clock.step
    )?;
    writeln!(out, "{} atoms\n{} atom types", w.n(), w.types)?;
    if w.bonds.types > 0 || !w.bonds.is_empty() {
        writeln!(out, "{} bonds\n{} bond types", w.bonds.len(), w.bonds.types)?;
    }
    let angles = &w.bonds.angles;
    if angles.types > 0 || !angles.list.is_empty() {
        writeln!(out, "{} angles\n{} angle types", angles.list.len(), angles.types)?;
    }
    writeln!(out)?;
    if let Some(domain) = &*w.domain {
        for (d, axis) in ["x", "y", "z"].into_iter().enumerate() {
            writeln!(out, "{} {} {axis}lo {axis}hi", shortest(domain.lo[d]), shortest(domain.hi[d]))?;
        }
        if let Some([xy, xz, yz]) = domain.tilt.map(|tilt| tilt.map(shortest)) {
            writeln!(out, "{xy} {xz} {yz} xy xz yz")?;
        }
    }
    masses(out, w)?;
    if with.coeffs {
        bond_coeffs(out, w)?;
        angle_coeffs(out, &w.bonds.angles)?;
    }
    let p = &w.particles;
    if p.is_empty() {
        return Ok(());
    }
    atoms(out, p)?;
    velocities(out, p)?;
    bonds(out, w)?;
    section_angles(out, w)?;
    let written = w.properties.iter().filter(|p| with.fixes && p.written);
    written.into_iter().try_for_each(|own| properties(out, w, own))
}

/// The section of a fix property/atom.
fn properties(out: &mut dyn Write, w: &World, own: &Properties) -> Result<()> {
    writeln!(out, "\n{} # {}\n", own.fix, own.heading())?;
    let columns: Vec<_> =
        (0..own.names.len()).map(|k| own.column(k).map(|key| w.columns.get_scalar(key))).collect();
    for (i, tag) in w.particles.tag.iter().enumerate() {
        write!(out, "{tag}")?;
        for column in &columns {
            match column {
                None => write!(out, " {}", w.particles.molecule.get(i).unwrap_or(&0))?,
                Some(values) => write!(out, " {}", shortest(values.map_or(0.0, |v| v[i])))?,
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

fn bonds(out: &mut dyn Write, w: &World) -> Result<()> {
    if w.bonds.is_empty() {
        return Ok(());
    }
    writeln!(out, "\nBonds\n")?;
    for (k, bond) in (1..).zip(w.bonds.by_owner(&w.particles.tag)) {
        writeln!(out, "{k} {} {} {}", bond.kind, bond.ends[0], bond.ends[1])?;
    }
    Ok(())
}

/// The section Masses, where types have masses; as LAMMPS does, only when all are set.
fn masses(out: &mut dyn Write, w: &World) -> Result<()> {
    let all: Option<Vec<f64>> = w.type_mass.iter().copied().collect();
    let Some(all) = all.filter(|m| !m.is_empty() && !w.particles.style.own_mass()) else { return Ok(()) };
    writeln!(out, "\nMasses\n")?;
    for (k, mass) in all.into_iter().enumerate() {
        writeln!(out, "{} {}", k + 1, shortest(mass))?;
    }
    Ok(())
}

/// The section Bond Coeffs, where a bond style has coefficients for all types.
fn bond_coeffs(out: &mut dyn Write, w: &World) -> Result<()> {
    let Some((style, texts)) = w.bonds.coeffs.as_ref().filter(|(_, t)| t.len() == w.bonds.types) else {
        return Ok(());
    };
    writeln!(out, "\nBond Coeffs # {style}\n")?;
    for (kind, text) in texts {
        writeln!(out, "{kind} {text}")?;
    }
    Ok(())
}

/// The section Angle Coeffs, where all types have coefficients.
fn angle_coeffs(out: &mut dyn Write, angles: &Angles) -> Result<()> {
    let Some(style) = angles.style.as_ref().filter(|s| s.given.len() == angles.types && angles.types > 0)
    else {
        return Ok(());
    };
    writeln!(out, "\nAngle Coeffs # zero\n")?;
    style.given.iter().try_for_each(|(kind, angle)| writeln!(out, "{kind} {}", shortest(*angle)))
}

/// The section Angles, in the order of the particles at the corners, which LAMMPS lists them with.
fn section_angles(out: &mut dyn Write, w: &World) -> Result<()> {
    let index = Index::new(&w.particles.tag);
    let mut list = w.bonds.angles.list.clone();
    if list.is_empty() {
        return Ok(());
    }
    list.sort_by_key(|angle| index.find(angle.ends[1], &w.particles.tag));
    writeln!(out, "\nAngles\n")?;
    (1..)
        .zip(list)
        .try_for_each(|(k, Angle { kind, ends: [a, b, c] })| writeln!(out, "{k} {kind} {a} {b} {c}"))
}

fn atoms(out: &mut dyn Write, p: &Particles) -> Result<()> {
    writeln!(out, "\nAtoms # {}\n", p.style.words())?;
    let layout = columns(p.style);
    for i in 0..p.len() {
        for column in &layout {
            match column {
                Column::Id => write!(out, "{}", p.tag[i])?,
                Column::Type => write!(out, " {}", p.kind[i])?,
                Column::X(d) => write!(out, " {}", shortest(p.x[i][*d]))?,
                Column::Diameter => write!(out, " {}", shortest(2.0 * p.radius[i]))?,
                Column::Density => write!(out, " {}", shortest(density(p, i)))?,
                Column::Volume => write!(out, " {}", shortest(p.volume[i]))?,
                Column::Molecule => write!(out, " {}", p.molecule[i])?,
                Column::Charge => write!(out, " {}", shortest(p.charge[i]))?,
                Column::Moment(d) => write!(out, " {}", shortest(p.mu[i][*d]))?,
            }
        }
        let [a, b, c] = p.image[i];
        writeln!(out, " {a} {b} {c}")?;
    }
    Ok(())
}

fn velocities(out: &mut dyn Write, p: &Particles) -> Result<()> {
    writeln!(out, "\nVelocities\n")?;
    for i in 0..p.len() {
        write!(out, "{}", p.tag[i])?;
        for v in p.v[i].iter().chain(p.omega.get(i).into_iter().flatten()) {
            write!(out, " {}", shortest(*v))?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// The density that gives a particle's mass when the file is read: one of the numbers next to m / (4/3 π r³) does so
/// to the last bit in nearly all cases.
fn density(p: &Particles, i: usize) -> f64 {
    let (mass, r) = (p.mass[i], p.radius.get(i).copied().unwrap_or(0.0));
    if r <= 0.0 {
        return mass;
    }
    let volume = 4.0 * PI / 3.0 * r * r * r;
    let near = mass / volume;
    let candidates = [p.density[i], near, near.next_up(), near.next_down()];
    candidates.into_iter().find(|d| volume * d == mass).unwrap_or(near)
}
