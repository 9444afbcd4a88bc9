//! Dump `vtk`: `.vtu` or `.vtp` files with a `.pvd` time series, or legacy `.vtk` files, for ParaView and PyVista.

use super::attribute::{Attribute, Core, Source, expand};
use super::base::{Base, Common, Files, OfFile, OfParticles, Shot, column, foreign};
use super::columns::{Renamed, Usual};
use super::{Dump, DumpStyle, MODIFY, legacy};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::par;
use perigrain_lang::{Args, Word};
use perigrain_output::dump::Data;
use perigrain_output::formats::Kind;
use perigrain_output::vtu::{self, Array, Series, Storage, Values};
use perigrain_plan::Op;
use perigrain_styles::words::{self, At, Form, Or, Syntax, Value, Words, read, read_or};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};

/// The style.
pub struct Vtk;

impl Style for Vtk {
    fn name(&self) -> &'static str {
        "vtk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed(MODIFY, Own::GRAMMAR)] },
            ),
            summary: "Writes points with data for ParaView every N steps, compressed, with a time series.",
            text: "Positions are the points. Three \
                   neighbouring attributes that differ in x, y, z become one vector: `vx vy vz` is `v`, `fx fy fz` is \
                   `f`, `omegax …` is `omega`, `tqx …` is `tq`, `ix …` is `i`, `xu …` is `unwrapped`, and `c_ID[1] c_ID[2] \
                   c_ID[3]` is `c_ID`. Every point is a vertex cell; the field `TIME` holds the simulated time. Beside the \
                   snapshots stands a list `NAME.pvd` with their times, rewritten after each snapshot; open that one in \
                   ParaView.\n\n\
                   The name's ending chooses the format. `.vtu` (an unstructured grid) and `.vtp` (polygonal data) hold appended raw data \
                   in zlib blocks made on all threads. `.pvtu` and `.pvtp` are lists of pieces, as programs on several processes \
                   write them; there is one piece, `NAME_0.vtu` or `NAME_0.vtp`. `.vtk` makes legacy text files, without a list of \
                   times.",
            example: "dump v all vtk 500 plate_*.vtu id type vx vy vz c_damage",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(flatten)]
    target: OfFile,
    /// The attributes of `dump custom`; positions need not be named.
    #[word(name = "attribute", kind = Kind::Attribute)]
    attributes: Vec<Word>,
}

impl DumpStyle for Vtk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        let Line { target: OfFile { file }, attributes } = read(args, cx)?;
        let base = Base::new(
            Files { endings: &[".vtu", ".vtk", ".vtp", ".pvtu", ".pvtp"], ..Files::any("vtk") },
            &file,
            cx,
        )?;
        base.needs_star(attributes.first().map_or(file.span, |word| word.span), cx)?;
        let attributes = attributes.iter().map(|word| expand(word, cx)).collect::<Result<Vec<_>>>()?.concat();
        Ok(Box::new(Declared { base, attributes, names: vec![], storage: Storage::default(), single: false }))
    }
}

#[derive(Clone, Debug)]
struct Declared {
    base: Base,
    attributes: Vec<Attribute>,
    /// Names of arrays set by `colname`, by their first attribute.
    names: Vec<(usize, String)>,
    storage: Storage,
    single: bool,
}

impl Dump for Declared {
    fn op(&self, cx: &mut dyn SealCx, every: i64) -> Result<Box<dyn Op>> {
        let dump = self.clone();
        let mut columns = group(&self.attributes);
        for (first, name) in &self.names {
            let own = columns.iter_mut().filter(|column| column.first == *first);
            own.for_each(|column| column.name.clone_from(name));
        }
        self.base.seal(cx, every, &self.attributes, move |shot| dump.write(shot, &columns, every))
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let ((common, particles), own): ((Common, OfParticles), Own) = read_or(args, cx, foreign)?;
        if let Some(At { span, .. }) = own.binary.filter(|b| !b.value) {
            let text = "dump_modify binary no: .vtu and .vtp files are always binary";
            let d = Diagnostic::error(Code::NOT_SUPPORTED, span, text);
            return Err(d.help("use `dump custom` for text").into());
        }
        self.storage = own.compress.map_or(self.storage, |c| c.0);
        for name in own.colname {
            match name {
                Or::Word(Usual::Default) => self.names.clear(),
                Or::Else(Renamed { column: word, name }) => {
                    let k = column(&word, self.attributes.iter().map(|a| a.word.as_str()))?;
                    if !group(&self.attributes).iter().any(|column| column.first == k) {
                        let text = format!("`{}` is part of a vector", word.text);
                        let d = Diagnostic::error(Code::CONFLICT, word.span, text);
                        return Err(d.help("give the name to the first of the three").into());
                    }
                    self.names.push((k, name));
                }
            }
        }
        self.single = own.precision.map_or(self.single, |p| p == Precision::Single);
        self.base.modify(common, cx)?;
        self.base.select(particles, cx)
    }

    fn every(&self) -> Option<i64> {
        self.base.every()
    }
}

/// The keywords of `dump_modify` that this dump has beside those of all.
#[derive(Words)]
struct Own {
    /// `yes` alone: files are always binary.
    #[word(keyword, what = "binary", placed)]
    binary: Option<At<bool>>,
    /// `yes`, `no`, or how tightly, from 1 to 9.
    #[word(keyword, name = "yes|no|1…9", shown = "3")]
    compress: Option<Compress>,
    #[word(keyword, shown = "double")]
    precision: Option<Precision>,
    /// The name of an array, by its attribute or the first of three; `default` gives all their own names again.
    #[word(keyword, name = "title", what = "an attribute or default")]
    colname: Vec<Or<Usual, Renamed>>,
}

/// How positions and numbers are written.
#[derive(PartialEq, Words)]
#[word(what = "precision")]
enum Precision {
    /// Positions and numbers have all their digits.
    Double,
    /// They have half of them.
    Single,
}

/// How arrays are stored.
struct Compress(Storage);

impl Value for Compress {
    const KIND: words::Kind = words::Kind::Text;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let word = args.expect("yes, no or a level from 1 to 9")?;
        let level = match word.text.as_str() {
            "yes" => 3,
            "no" => return Ok(Self(Storage { compress: false, ..Storage::default() })),
            text => text.parse().unwrap_or(0),
        };
        if !(1..=9).contains(&level) {
            return fail(Code::BAD_VALUE, word.span, "compress takes yes, no or a level from 1 to 9");
        }
        Ok(Self(Storage { compress: true, level }))
    }
}

/// An array of the file: its name and its attributes, one or three.
#[derive(Clone, Debug, PartialEq)]
struct Column {
    name: String,
    first: usize,
    vector: bool,
}

/// Name of the vector of `x y z`.
const POSITION: &str = "position";

/// Combines x, y, z components into vectors.
fn group(attributes: &[Attribute]) -> Vec<Column> {
    let mut columns = vec![];
    let mut k = 0;
    while k < attributes.len() {
        let vector = attributes.get(k..k + 3).and_then(vector_name);
        let name = vector.clone().unwrap_or_else(|| attributes[k].word.clone());
        // Positions are the points themselves.
        if name != POSITION {
            columns.push(Column { name, first: k, vector: vector.is_some() });
        }
        k += if vector.is_some() { 3 } else { 1 };
    }
    columns
}

/// The common name of three attributes that are the components of a vector.
fn vector_name(three: &[Attribute]) -> Option<String> {
    let axis = |a: &Attribute| match &a.source {
        Source::Core(Core::V(k)) => Some(("v".to_string(), *k)),
        Source::Core(Core::F(k)) => Some(("f".to_string(), *k)),
        Source::Core(Core::Omega(k)) => Some(("omega".to_string(), *k)),
        Source::Core(Core::Torque(k)) => Some(("tq".to_string(), *k)),
        Source::Core(Core::X(k)) => Some((POSITION.to_string(), *k)),
        Source::Core(Core::Unwrapped(k)) => Some(("unwrapped".to_string(), *k)),
        Source::Core(Core::Scaled(k)) => Some(("scaled".to_string(), *k)),
        Source::Core(Core::Image(k)) => Some(("i".to_string(), *k)),
        Source::Value(r) => match r.index[..] {
            [k @ 1..=3] => Some((a.word.split('[').next().unwrap_or_default().to_string(), k - 1)),
            _ => None,
        },
        Source::Core(_) | Source::Custom(..) => None,
    };
    let [x, y, z] = [axis(&three[0])?, axis(&three[1])?, axis(&three[2])?];
    (x.0 == y.0 && y.0 == z.0 && [x.1, y.1, z.1] == [0, 1, 2]).then_some(x.0)
}

/// Owned values of one array.
enum Owned {
    I32(Vec<i32>),
    F32(Vec<f32>),
    F64(Vec<f64>),
    Vectors(Vec<[f64; 3]>),
}

impl Owned {
    fn values(&self, single: bool) -> Values<'_> {
        match self {
            Self::I32(v) => Values::I32(v),
            Self::F32(v) => Values::F32(v),
            Self::F64(v) => Values::F64(v),
            Self::Vectors(v) if single => Values::Vectors32(v),
            Self::Vectors(v) => Values::Vectors(v),
        }
    }
}

impl Declared {
    /// Writes one file and, unless this is a `write_dump`, its entry in the series.
    fn write(&self, shot: Shot<'_>, columns: &[Column], every: i64) -> Result<()> {
        let rows = &shot.rows[..];
        let x = &shot.world.particles.x;
        let points = Owned::Vectors(fill(rows, |i| x[i]));
        let owned: Vec<Owned> = columns.iter().map(|c| self.gather(c, rows, &shot.data)).collect();
        let named = columns.iter().zip(&owned);
        let arrays: Vec<Array<'_>> =
            named.map(|(c, o)| Array { name: &c.name, values: o.values(self.single) }).collect();
        let (time, state) = (shot.world.clock.time(), shot.state);
        let path = state.target.pattern.at(shot.step);
        if path.extension().is_some_and(|end| end == "vtk") {
            let text = legacy::text(time, &fill(rows, |i| x[i]), &arrays);
            return state.target.write(shot.step, |to| to.write_all(text.as_bytes()));
        }
        let points = points.values(self.single);
        let piece = vtu::piece(&path);
        vtu::write(piece.as_ref().unwrap_or(&path), time, points, &arrays, self.storage)?;
        if let Some(piece) = &piece {
            vtu::write_list(&path, piece, points, &arrays)?;
        }
        if every == 0 {
            return Ok(());
        }
        let list = state.target.pattern.stem().with_extension("pvd");
        state.series.get_or_insert_with(|| Series::new(list)).add(time, &path)
    }

    /// The values of one array in the order of the rows.
    fn gather(&self, column: &Column, rows: &[u32], data: &[Data<'_>]) -> Owned {
        let one = &data[column.first];
        if column.vector {
            let three = &data[column.first..column.first + 3];
            return Owned::Vectors(fill(rows, |i| {
                [three[0].number(i), three[1].number(i), three[2].number(i)]
            }));
        }
        match (one.kind(), self.single) {
            (Kind::Int | Kind::Text, _) => Owned::I32(fill(rows, |i| one.number(i) as i32)),
            (Kind::Float, true) => Owned::F32(fill(rows, |i| one.number(i) as f32)),
            (Kind::Float, false) => Owned::F64(fill(rows, |i| one.number(i))),
        }
    }
}

/// One value per row.
fn fill<T: Copy + Default + Send>(rows: &[u32], value: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let mut out = vec![T::default(); rows.len()];
    par::each((&mut out[..], rows), |_, (out, rows)| {
        for (o, &i) in out.iter_mut().zip(rows) {
            *o = value(i as usize);
        }
    });
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_base::diag::{FileId, Span};
    use perigrain_lang::ValueRef;

    fn attribute(word: &str) -> Attribute {
        let span = Span::new(FileId::default(), 0, 0);
        let core = super::super::attribute::CORE.iter().find(|(name, _)| *name == word);
        let source = match core {
            Some((_, core)) => Source::Core(*core),
            None => Source::Value(ValueRef::parse(word, span).unwrap().unwrap()),
        };
        Attribute { word: word.into(), source }
    }

    #[test]
    fn neighbours_become_vectors() {
        let words = "id vx vy vz c_s[1] c_s[2] c_s[3] c_s[4] vy vz vx fx fy";
        let list: Vec<Attribute> = words.split(' ').map(attribute).collect();
        let names: Vec<String> =
            group(&list).iter().map(|c| format!("{}{}", c.name, if c.vector { "*" } else { "" })).collect();
        assert_eq!(names, ["id", "v*", "c_s*", "c_s[4]", "vy", "vz", "vx", "fx", "fy"]);
    }
}
