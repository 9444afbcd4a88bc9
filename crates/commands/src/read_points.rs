//! `read_points`: particles from a table of points, its columns by name.

use super::geometry::enter::{Newcomers, off_plane};
use super::geometry::file::File;
use super::geometry::points::{Table, no_column};
use super::geometry::words::Making;
use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{self, bad_keyword};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::{AtomStyle, Numbers};
use std::f64::consts::PI;

/// The command.
pub struct ReadPoints;

const KEYWORDS: [&str; 10] =
    ["columns", "volume", "diameter", "type", "density", "group", "scale", "rotate", "shift", "move"];

impl Style for ReadPoints {
    fn name(&self) -> &'static str {
        "read_points"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "read_points FILE [columns PROPERTY COLUMN …] [type T] [volume V] [diameter D] [density ρ] [group ID] \
                     [scale S] [rotate THETA RX RY RZ] [shift X Y Z]",
            summary: "Makes particles from a table of points, as spreadsheets and scripts write them.",
            text: "The first line names the columns, each further line is a point; fields stand between commas, semicolons, tabs or blanks, \
                   names may have quotes, `#` opens a comment, and a name that ends in `.gz` a packed file. Columns are known by the names of \
                   properties: `x`, `y`, `z` (needed; `z` not in a flat scene), `id`, `type`, `volume`, `density`, `diameter`, `radius`, `vx`, `vy`, `vz`, \
                   `wx`, `wy`, `wz` (angular velocity), `mol`, and what a `fix property/atom` has made, `i_NAME`, `d_NAME`, `temperature`. \
                   `columns` takes a column of another name for a property: `columns x X_mm volume \"cell volume\"`, and then it must be there. Columns of \
                   other names are left out, and the log names them.\n\n\
                   What has no column comes from the line: `type`, `volume`, `diameter`, `density`, alike for all. Peridynamic particles need a volume, \
                   spheres a diameter, a radius or a volume (that of the ball); mass follows from the density as with `set`. Without `id` ids go on \
                   behind the largest one.\n\n\
                   Lengths are multiplied by `scale`, volumes by its third power, then places, velocities and angular velocities are turned, then places shifted; \
                   speeds stay. Only particles inside of the box are made; a warning counts the others. Refused with line and column: two \
                   points at one place, fields that are no numbers, types that there are not, volumes and sizes that are not above zero.",
            example: "print \"\"\"x,y,z,Vol\n0,0,5,1\n0,1.5,5,2\"\"\" file points.csv screen no\n\
                      read_points points.csv columns volume Vol type 2 scale 0.001 density 2235.0",
        }
    }
}

/// What a column says of a particle.
#[derive(Clone, Debug, PartialEq)]
enum Property {
    X(usize),
    Id,
    Type,
    Volume,
    Density,
    Diameter,
    Radius,
    Velocity(usize),
    Spin(usize),
    Molecule,
    Custom(Numbers, bool),
}

/// Columns to be read with what they say, and the names of others.
type Found = (Vec<(usize, Property)>, Vec<String>);

/// What a line asks for.
struct Reading {
    file: Word,
    making: Making,
    /// Property and column, as said.
    columns: Vec<(Word, Word, Property)>,
    volume: Option<f64>,
    diameter: Option<f64>,
    checking: bool,
}

/// The property of a name, if particles have it.
fn property(name: &str, style: AtomStyle, cx_columns: &perigrain_world::Columns) -> Option<Property> {
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
        custom if custom.starts_with("i_") || custom.starts_with("d_") || custom == "temperature" => {
            Custom(cx_columns.custom(custom)?, custom.starts_with('i'))
        }
        _ => return None,
    })
}

impl CommandStyle for ReadPoints {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let file = a.expect("the name of a table")?.clone();
        let making = Making::default();
        let mut r =
            Reading { file, making, columns: vec![], volume: None, diameter: None, checking: cx.checking };
        while let Some(word) = a.next() {
            match word.text.as_str() {
                "columns" => r.columns(word, a, cx)?,
                "volume" => r.volume = Some(a.positive("the volume")?),
                "diameter" => r.diameter = Some(a.positive("the diameter")?),
                _ if r.making.keyword(word, a, cx)? => {}
                _ => return Err(bad_keyword(a, word, &KEYWORDS, &[])),
            }
        }
        Ok(Box::new(r))
    }
}

impl Reading {
    /// Takes pairs of property and column, up to the next keyword that is no property in front of a column.
    fn columns(&mut self, word: &Word, a: &mut Args, cx: &BuildCx) -> Result<()> {
        let style = cx.world.particles.style;
        let before = self.columns.len();
        let is_next = |a: &Args| {
            a.peek().is_some_and(|w| {
                let known = property(&w.text, style, &cx.world.columns).is_some();
                // `type 1` and the like may be either: a number is no column's name.
                let number = a.peek_at(1).is_none_or(|v| v.text.parse::<f64>().is_ok());
                if KEYWORDS.contains(&w.text.as_str()) {
                    known && !number
                } else {
                    known || self_named(&w.text)
                }
            })
        };
        while is_next(a) {
            let name = a.expect("a property")?;
            let column = a.expect("the name of a column")?;
            let Some(p) = property(&name.text, style, &cx.world.columns) else {
                let text = format!("particles of this scene have no `{}`", name.text);
                return fail(Code::CONFLICT, name.span, text);
            };
            self.columns.push((name.clone(), column.clone(), p));
        }
        if self.columns.len() == before {
            let d = Diagnostic::error(
                Code::MISSING_ARGUMENT,
                word.span,
                "`columns` needs a property and the name of its column",
            );
            return Err(d.help("write for example `columns x X_mm`").into());
        }
        Ok(())
    }

    /// The columns to be read with what they say, and the names of others.
    fn wanted(&self, cx: &ActCx, names: &[String], head: Span) -> Result<Found> {
        let (mut wanted, mut others): (Vec<(usize, Property)>, Vec<String>) = (vec![], vec![]);
        for (name, column, p) in &self.columns {
            let Some(k) = names.iter().position(|n| *n == column.text) else {
                let d = no_column(names, head, &name.text, &column.text);
                return Err(d.label(column.span, "asked for here").into());
            };
            wanted.push((k, p.clone()));
        }
        let style = cx.world.particles.style;
        for (k, name) in names.iter().enumerate().filter(|(_, n)| !n.is_empty()) {
            match property(name, style, &cx.world.columns) {
                Some(p) if !wanted.iter().any(|(_, q)| *q == p) => wanted.push((k, p)),
                _ if wanted.iter().any(|(c, _)| *c == k) => {}
                _ => others.push(name.clone()),
            }
        }
        let flat = cx.world.settings.two_dimensional;
        for (d, name) in ["x", "y", "z"].into_iter().enumerate().take(if flat { 2 } else { 3 }) {
            if !wanted.iter().any(|(_, p)| *p == Property::X(d)) {
                return Err(no_column(names, head, name, name).into());
            }
        }
        let has = |p: Property| wanted.iter().any(|(_, q)| *q == p);
        let sized = has(Property::Volume) || self.volume.is_some();
        let round = has(Property::Diameter) || has(Property::Radius) || self.diameter.is_some();
        if style.peri && !sized {
            let d = no_column(names, head, "volume", "volume");
            return Err(d.help("`volume V` gives all points one").into());
        }
        if style.sphere && !sized && !round {
            let d = no_column(names, head, "diameter", "diameter");
            return Err(d.help("`diameter D` gives all points one").into());
        }
        if !has(Property::Type) && self.making.kind.is_none() && cx.world.types > 1 {
            let d = no_column(names, head, "type", "type");
            return Err(d.help("`type T` gives all points one").into());
        }
        Ok((wanted, others))
    }

    fn make(&self, cx: &mut ActCx, file: &File) -> Result<()> {
        let text = file.text()?;
        let (names, head) = Table::head(text)?;
        let (wanted, others) = self.wanted(cx, &names, head)?;
        let table = Table::read(text, wanted.iter().map(|(k, _)| *k).collect())?;
        cx.say(format!("  {} points", table.len()));
        if !others.is_empty() {
            cx.say(format!("  columns left out: {}", others.join(", ")));
        }
        let properties: Vec<Property> = wanted.into_iter().map(|(_, p)| p).collect();
        let source = Rows { table: &table, text, properties: &properties, line: self };
        source.twice()?;
        source.enter(cx)
    }
}

/// Whether a word looks like the name of a property that the scene does not have.
fn self_named(word: &str) -> bool {
    word.starts_with("i_")
        || word.starts_with("d_")
        || ["radius", "mol", "temperature", "wx", "wy", "wz"].contains(&word)
}

impl Act for Reading {
    fn apply(self: Box<Self>, cx: &mut ActCx) -> Result<()> {
        let file = File::find(cx.world, &self.file, "table")?;
        cx.say("Reading points file ...");
        self.make(cx, &file).map_err(|e| file.blame(e))
    }

    /// `perigrain check` reads the file, too, but keeps no particles.
    fn needs_particles(&self) -> bool {
        false
    }

    fn makes_group(&self) -> Option<&str> {
        self.making.group.as_ref().map(|w| w.text.as_str())
    }

    fn settles(&self) -> Vec<&'static str> {
        let mut settles = self.making.settles();
        // A column may hold it: who reads the file knows.
        settles.extend(["density", "mass"]);
        settles
    }
}

/// The rows of a table with what their numbers mean.
struct Rows<'a> {
    table: &'a Table,
    text: &'a str,
    properties: &'a [Property],
    line: &'a Reading,
}

/// What a row says.
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
    fn twice(&self) -> Result<()> {
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
        let mut order: Vec<usize> = (0..self.table.len()).collect();
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
        let line = self.line;
        let scale = line.making.placement.scale;
        let mut p = Point {
            x: [0.0; 3],
            v: [0.0; 3],
            spin: [0.0; 3],
            tag: None,
            kind: line.making.kind.unwrap_or(1),
            volume: line.volume,
            diameter: line.diameter,
            density: line.making.density,
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
                Property::Custom(..) => {}
            }
        }
        Ok(p)
    }

    fn enter(&self, cx: &mut ActCx) -> Result<()> {
        let types = cx.world.types;
        let style = cx.world.particles.style;
        let placement = self.line.making.placement;
        let mut new = Newcomers::new(cx, &self.line.making, self.table.len())?;
        let mut kept = vec![];
        for k in 0..self.table.len() {
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
        let first = new.enter(cx, "points", self.line.checking)?;
        if !self.line.checking {
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

    /// Gives the new particles what the file says of their properties.
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
