//! `read_points`: particles from a table of points, its columns by name.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_geometry::body::{Body, FromFile};
use perigrain_geometry::file::File;
use perigrain_geometry::points::{Table, no_column};
use perigrain_geometry::rows::{Property, Rows, is_elsewhere, property};
use perigrain_geometry::words::{Making, Options};
use perigrain_lang::{Args, Word};
use perigrain_styles::common;
use perigrain_styles::words::{At, Grammar, Kind, Part, Syntax, Value, Words, read};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};

/// The command.
pub struct ReadPoints;

impl Style for ReadPoints {
    fn name(&self) -> &'static str {
        "read_points"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Makes particles from a table of points, as spreadsheets and scripts write them.",
            text: "The first line names the columns, each further line is a point; fields stand between commas, semicolons, tabs or blanks, \
                   names may have quotes, `#` opens a comment, and a name that ends in `.gz` a packed file. Columns are known by the names of \
                   properties: `x`, `y`, `z` (needed; `z` not in a flat scene), `id`, `type`, `volume`, `density`, `diameter`, `radius`, `vx`, `vy`, `vz`, \
                   `wx`, `wy`, `wz` (angular velocity), `mol`, and what a `fix property/atom` has made, `i_NAME`, `d_NAME`, `temperature`. \
                   `columns` takes a column of another name for a property: `columns x X_mm volume \"cell volume\"`, and then it must be there. Columns of \
                   other names are left out, and the log names them.\n\n\
                   What has no column comes from the line: `type`, `volume`, `diameter`, `density`, alike for all. Peridynamic particles need a volume, \
                   spheres a diameter, a radius or a volume (that of the ball); mass follows from the density as with `set`. Without `id` ids continue \
                   behind the largest one.\n\n\
                   Lengths are multiplied by `scale`, volumes by its third power, then places, velocities and angular velocities are turned, then places shifted; \
                   speeds stay. Only particles inside of the box are made; a warning counts the others. Refused with line and column: two \
                   points at one place, fields that are no numbers, types that there are not, volumes and sizes that are not above zero.",
            example: "print \"\"\"x,y,z,Vol\n0,0,5,1\n0,1.5,5,2\"\"\" file points.csv screen no\n\
                      read_points points.csv columns volume Vol type 2 scale 0.001 density 2235.0",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The file.
    #[word(name = "FILE", what = "the name of a table", kind = Kind::File)]
    file: Word,
    /// Columns of other names for properties, which must be there.
    #[word(keyword, name = "pairs", placed)]
    columns: Vec<At<Columns>>,
    /// The volume, alike for all [volume].
    #[word(keyword, name = "V", positive)]
    volume: Option<f64>,
    /// The diameter, alike for all [length].
    #[word(keyword, name = "D", positive)]
    diameter: Option<f64>,
    #[word(flatten)]
    options: Options,
}

/// Properties with the names of their columns.
struct Columns(Vec<(Word, Word, Property)>);

impl Value for Columns {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[Part::Many(&[Part::bare("PROPERTY", Kind::Text), Part::bare("COLUMN", Kind::Text)], 1)],
        ..*Grammar::NONE
    });
    /// Takes pairs up to the next keyword that is no property in front of a column.
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let style = cx.world.particles.style;
        let mut pairs = vec![];
        let is_next = |a: &Args| {
            a.peek().is_some_and(|w| {
                let known = property(&w.text, style, &cx.world.columns).is_some();
                // `type 1` and the like may be either: a number is no column's name.
                let number = a.peek_at(1).is_none_or(|v| v.text.parse::<f64>().is_ok());
                if a.at_keyword() { known && !number } else { known || is_elsewhere(&w.text) }
            })
        };
        while is_next(args) {
            let name = args.expect("a property")?;
            let column = args.expect("the name of a column")?;
            let Some(p) = property(&name.text, style, &cx.world.columns) else {
                let text = format!("particles of this scene have no `{}`", name.text);
                return fail(Code::CONFLICT, name.span, text);
            };
            pairs.push((name.clone(), column.clone(), p));
        }
        if pairs.is_empty() {
            let text = "`columns` needs a property and the name of its column";
            let d = Diagnostic::error(Code::MISSING_ARGUMENT, args.here(), text);
            return Err(d.help("write for example `columns x X_mm`").into());
        }
        Ok(Self(pairs))
    }
}

/// Columns to be read with their properties, and the names of others.
type Found = (Vec<(usize, Property)>, Vec<String>);

/// A parsed line.
struct Reading {
    file: Word,
    making: Making,
    /// Property and column, as given.
    columns: Vec<(Word, Word, Property)>,
    volume: Option<f64>,
    diameter: Option<f64>,
    checking: bool,
}

impl CommandStyle for ReadPoints {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let Line { file, columns: given, volume, diameter, options } = read(a, cx)?;
        let mut columns = vec![];
        for At { value: Columns(mut pairs), span, .. } in given {
            if pairs.is_empty() {
                let text = "`columns` needs a property and the name of its column";
                let d = Diagnostic::error(Code::MISSING_ARGUMENT, span, text);
                return Err(d.help("write for example `columns x X_mm`").into());
            }
            columns.append(&mut pairs);
        }
        let r =
            Reading { file, making: options.making(cx)?, columns, volume, diameter, checking: cx.checking };
        Ok(Box::new(FromFile(r)))
    }
}

impl Reading {
    /// The columns to be read with their properties, and the names of others.
    fn wanted(&self, cx: &ActCx, names: &[String], head: Span) -> Result<Found> {
        let (mut wanted, mut others): (Vec<(usize, Property)>, Vec<String>) = (vec![], vec![]);
        for (name, column, p) in &self.columns {
            let Some(k) = names.iter().position(|n| *n == column.text) else {
                let d = no_column(names, head, &name.text, &column.text);
                return Err(d.label(column.span, "requested here").into());
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

    fn enter(&self, cx: &mut ActCx, file: &File) -> Result<()> {
        let text = file.text()?;
        let (names, head) = Table::head(text)?;
        let (wanted, others) = self.wanted(cx, &names, head)?;
        let table = Table::read(text, wanted.iter().map(|(k, _)| *k).collect())?;
        cx.print(format!("  {} points", table.count()));
        if !others.is_empty() {
            cx.print(format!("  columns left out: {}", others.join(", ")));
        }
        let properties: Vec<Property> = wanted.into_iter().map(|(_, p)| p).collect();
        let (volume, diameter, checking) = (self.volume, self.diameter, self.checking);
        let making = &self.making;
        let source =
            Rows { table: &table, text, properties: &properties, making, volume, diameter, checking };
        source.twice()?;
        source.enter(cx)
    }
}

impl Body for Reading {
    fn making(&self) -> &Making {
        &self.making
    }

    fn make(&self, cx: &mut ActCx) -> Result<()> {
        let file = File::find(cx.world, &self.file, "table")?;
        cx.print("Reading points file ...");
        self.enter(cx, &file).map_err(|e| file.blame(e))
    }

    fn settles(&self) -> Vec<&'static str> {
        let mut settles = self.making.settles();
        // A column may hold it; this is known once the file is read.
        settles.extend(["density", "mass"]);
        settles
    }
}
