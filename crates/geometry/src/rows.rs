//! The columns of a table, and particles from its rows.

use super::enter::{Newcomers, off_plane};
use super::points::Table;
use super::words::Making;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_styles::ActCx;
use perigrain_world::columns::TEMPERATURE;
use perigrain_world::{AtomStyle, Columns, Numbers};
use std::f64::consts::PI;

/// The property that a column gives a particle.
#[derive(Clone, Debug, PartialEq)]
pub enum Property {
    /// A coordinate.
    X(usize),
    /// The id.
    Id,
    /// The type.
    Type,
    /// The volume.
    Volume,
    /// The density.
    Density,
    /// The diameter.
    Diameter,
    /// The radius.
    Radius,
    /// A component of the velocity.
    Velocity(usize),
    /// A component of the angular velocity.
    Spin(usize),
    /// The molecule.
    Molecule,
    /// A property of fix property/atom, and whether it holds whole numbers.
    Custom(Numbers, bool),
}

/// The property of a name, if particles have it.
pub fn property(name: &str, style: AtomStyle, columns: &Columns) -> Option<Property> {
    use Property::{Custom, Density, Diameter, Id, Molecule, Radius, Spin, Type, Velocity, Volume, X};
    Some(match name {
        "x" => X(0),
        "y" => X(1),
        "z" => X(2),
        "id" => Id,
        "type" => Type,
        "volume" => Volume,
        "density" if style.own_mass() => Density,
        "diameter" if style.sphere => Diameter,
        "radius" if style.sphere => Radius,
        "vx" => Velocity(0),
        "vy" => Velocity(1),
        "vz" => Velocity(2),
        "wx" if style.sphere => Spin(0),
        "wy" if style.sphere => Spin(1),
        "wz" if style.sphere => Spin(2),
        "mol" if style.molecules => Molecule,
        custom if is_custom(custom) => Custom(columns.custom(custom)?, custom.starts_with('i')),
        _ => return None,
    })
}

/// Whether a name is that of a property of fix property/atom.
fn is_custom(name: &str) -> bool {
    name == "temperature" || ["i_", "d_", "i2_", "d2_"].iter().any(|begin| name.starts_with(begin))
}

/// Whether a word looks like the name of a property that the scene does not have.
pub fn is_elsewhere(word: &str) -> bool {
    is_custom(word) || ["radius", "mol", "wx", "wy", "wz"].contains(&word)
}

/// The rows of a table with what their numbers mean.
pub struct Rows<'a> {
    /// The rows.
    pub table: &'a Table,
    /// The text of the file.
    pub text: &'a str,
    /// The properties of the columns.
    pub properties: &'a [Property],
    /// The line's options for all particles.
    pub making: &'a Making,
    /// The volume of those that have none of their own.
    pub volume: Option<f64>,
    /// The diameter of those that have none of their own.
    pub diameter: Option<f64>,
    /// A check keeps no particles.
    pub checking: bool,
}

/// The content of a row.
struct Point {
    x: [f64; 3],
    v: [f64; 3],
    spin: [f64; 3],
    tag: Option<u32>,
    kind: u16,
    volume: Option<f64>,
    diameter: Option<f64>,
    density: Option<f64>,
    molecule: u32,
}

impl Rows<'_> {
    fn bad<T>(&self, k: usize, c: usize, message: String) -> Result<T> {
        fail(Code::BAD_VALUE, self.table.place(self.text, k, Some(c)), message)
    }

    /// Refuses two points at one place.
    ///
    /// # Errors
    /// The second one.
    pub fn twice(&self) -> Result<()> {
        let at = |k: usize| {
            let mut x = [0.0; 3];
            for (value, p) in self.table.row(k).iter().zip(self.properties) {
                if let Property::X(d) = p {
                    // Both zeros are the same place.
                    x[*d] = value + 0.0;
                }
            }
            x.map(f64::to_bits)
        };
        let mut order: Vec<usize> = (0..self.table.count()).collect();
        order.sort_unstable_by_key(|&k| (at(k), k));
        let pairs = order.windows(2).filter(|w| at(w[0]) == at(w[1]));
        let Some((second, first)) = pairs.map(|w| (w[1], w[0])).min() else { return Ok(()) };
        let place = |k| self.table.place(self.text, k, None);
        let d = Diagnostic::error(Code::DUPLICATE_NAME, place(second), "a second point at the same place");
        Err(match place(first) {
            Some(at) => d.label(at, "the first one"),
            None => d,
        }
        .into())
    }

    fn point(&self, k: usize, types: usize) -> Result<Point> {
        let scale = self.making.placement.scale;
        let mut p = Point {
            x: [0.0; 3],
            v: [0.0; 3],
            spin: [0.0; 3],
            tag: None,
            kind: self.making.kind.unwrap_or(1),
            volume: self.volume,
            diameter: self.diameter,
            density: self.making.density,
            molecule: 0,
        };
        for (c, (&value, property)) in self.table.row(k).iter().zip(self.properties).enumerate() {
            let above = |what: &str| match value > 0.0 {
                true => Ok(value),
                false => self.bad(k, c, format!("{what} must be greater than zero, not {value}")),
            };
            match property {
                Property::X(d) => p.x[*d] = value,
                Property::Velocity(d) => p.v[*d] = value,
                Property::Spin(d) => p.spin[*d] = value,
                Property::Id if value >= 1.0 && value < f64::from(u32::MAX) && value.fract() == 0.0 => {
                    p.tag = Some(value as u32);
                }
                Property::Id => {
                    return self.bad(k, c, format!("an id is a whole number from 1, not {value}"));
                }
                Property::Type if value >= 1.0 && value <= types as f64 && value.fract() == 0.0 => {
                    p.kind = value as u16
                }
                Property::Type => {
                    return self.bad(k, c, format!("there are types 1 to {types}, not {value}"));
                }
                Property::Volume => p.volume = Some(above("the volume")? * scale.powi(3)),
                Property::Density => p.density = Some(above("the density")?),
                Property::Diameter => p.diameter = Some(above("the diameter")? * scale),
                Property::Radius => p.diameter = Some(2.0 * above("the radius")? * scale),
                Property::Molecule if value >= 0.0 && value < f64::from(u32::MAX) && value.fract() == 0.0 => {
                    p.molecule = value as u32;
                }
                Property::Molecule => {
                    return self.bad(k, c, format!("a molecule is a whole number from 0, not {value}"));
                }
                Property::Custom(_, true) if value.fract() != 0.0 => {
                    return self.bad(k, c, format!("this property holds whole numbers, not {value}"));
                }
                Property::Custom(key, _) if key.plays(*TEMPERATURE) && value < 0.0 => {
                    return self.bad(k, c, format!("the temperature must not be negative: {value}"));
                }
                Property::Custom(..) => {}
            }
        }
        Ok(p)
    }

    /// Makes the particles.
    ///
    /// # Errors
    /// Numbers that cannot be, more particles than fit.
    pub fn enter(&self, cx: &mut ActCx) -> Result<()> {
        let types = cx.world.types;
        let style = cx.world.particles.style;
        let placement = self.making.placement;
        let mut new = Newcomers::new(cx, self.making, self.table.count())?;
        let mut kept = vec![];
        for k in 0..self.table.count() {
            let p = self.point(k, types)?;
            let ball = p.diameter.map(|d| PI / 6.0 * d * d * d);
            let volume = p.volume.or(ball).unwrap_or(1.0);
            let at = || self.table.place(self.text, k, None);
            if !new.push(p.x, p.kind, volume).map_err(|z| off_plane("the point", z, at()))? {
                continue;
            }
            kept.push(k);
            let last = new.particles.len() - 1;
            let columns = &mut new.particles;
            columns.v[last] = placement.direction(p.v);
            if style.sphere {
                columns.omega[last] = placement.direction(p.spin);
                new.radii.push(p.diameter.map_or((0.75 / PI * volume).cbrt(), |d| 0.5 * d));
            }
            if let Some(molecule) = columns.molecule.get_mut(last) {
                *molecule = p.molecule;
            }
            new.densities.extend(p.density);
            if let Some(tag) = p.tag {
                new.particles.tag[last] = tag;
            }
        }
        self.check_ids(cx, &new, &kept)?;
        let first = new.enter(cx, "points", self.checking)?;
        if !self.checking {
            self.fill(cx, first, &kept);
        }
        Ok(())
    }

    /// Refuses ids that are taken.
    fn check_ids(&self, cx: &ActCx, new: &Newcomers, kept: &[usize]) -> Result<()> {
        let Some(c) = self.properties.iter().position(|p| *p == Property::Id) else { return Ok(()) };
        let tags = &new.particles.tag;
        let mut all: Vec<(u32, usize)> = tags.iter().copied().zip(kept.iter().copied()).collect();
        all.sort_unstable();
        let twice = all.windows(2).find(|w| w[0].0 == w[1].0).map(|w| w[1]);
        let index = perigrain_world::index::Index::new(&cx.world.particles.tag);
        let taken = all.iter().find(|(tag, _)| index.find(*tag, &cx.world.particles.tag).is_some()).copied();
        match twice.or(taken) {
            None => Ok(()),
            Some((tag, k)) => {
                let at = self.table.place(self.text, k, Some(c));
                fail(Code::DUPLICATE_NAME, at, format!("there is a particle {tag} already"))
            }
        }
    }

    /// Gives the new particles the file's values of their properties.
    fn fill(&self, cx: &mut ActCx, first: usize, kept: &[usize]) {
        let n = cx.world.n();
        for (c, p) in self.properties.iter().enumerate() {
            let Property::Custom(key, _) = p else { continue };
            let column = cx.world.columns.scalar(*key, n);
            column.resize(n, 0.0);
            for (slot, &k) in column[first..].iter_mut().zip(kept) {
                *slot = self.table.row(k)[c];
            }
        }
    }
}
