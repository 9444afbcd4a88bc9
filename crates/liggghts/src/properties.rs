//! `fix … property/global`: the table of materials that contact models read.

use crate::Translator;
use crate::reading::{choice, is_open, number, rounded, value, without_counterpart};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, nearest};
use perigrain_lang::{Args, Command, Word};

/// How many values a property has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// One.
    Scalar,
    /// One for each atom type.
    Types,
    /// One for each pair of atom types.
    Pairs,
}

impl Shape {
    /// The word of a line that defines it.
    fn word(self) -> &'static str {
        match self {
            Shape::Scalar => "scalar",
            Shape::Types => "peratomtype",
            Shape::Pairs => "peratomtypepair",
        }
    }
}

/// The properties of LIGGGHTS, each with its shape; other names may be defined, but no model reads them.
pub(crate) const PROPERTIES: &[(&str, Shape)] = &[
    ("youngsModulus", Shape::Types),
    ("poissonsRatio", Shape::Types),
    ("coefficientRestitution", Shape::Pairs),
    ("coefficientFriction", Shape::Pairs),
    ("characteristicVelocity", Shape::Scalar),
    ("coefficientRollingFriction", Shape::Pairs),
    ("coefficientRollingViscousDamping", Shape::Pairs),
    ("rollingStiffness", Shape::Scalar),
    ("coeffRollingStiffness", Shape::Scalar),
    ("cohesionEnergyDensity", Shape::Pairs),
    ("kn", Shape::Pairs),
    ("kt", Shape::Pairs),
    ("gamman", Shape::Pairs),
    ("gammat", Shape::Pairs),
    ("gamman_abs", Shape::Pairs),
    ("gammat_abs", Shape::Pairs),
    ("ktToKnUser", Shape::Scalar),
    ("k_finnie", Shape::Pairs),
    ("coefficientMaxElasticStiffness", Shape::Pairs),
    ("coefficientAdhesionStiffness", Shape::Pairs),
    ("coefficientPlasticityDepth", Shape::Pairs),
    ("thermalConductivity", Shape::Types),
    ("thermalCapacity", Shape::Types),
    ("youngsModulusOriginal", Shape::Types),
];

/// Whether models read a property of this name.
pub(crate) fn is_known(name: &str) -> bool {
    PROPERTIES.iter().any(|(known, _)| *known == name)
}

/// One property of the deck.
#[derive(Clone, Debug)]
pub(crate) struct Property {
    /// The fix that defines it.
    pub id: String,
    shape: Shape,
    /// The number of atom types of a matrix.
    types: usize,
    values: Vec<Word>,
    span: Span,
    /// A model of the deck reads it.
    pub read: bool,
}

impl Translator {
    /// `fix ID group property/global NAME scalar|vector|peratomtype|matrix|peratomtypepair …`.
    pub(crate) fn property(&mut self, cmd: &Command, args: &mut Args) -> Result<()> {
        let name = args.peek_text().to_string();
        let read = self.new_property(cmd, args);
        // What a refused line would have defined is not missed again.
        if read.is_err() {
            self.refused.insert(name);
        }
        read
    }

    fn new_property(&mut self, cmd: &Command, args: &mut Args) -> Result<()> {
        let name = args.expect("the name of a property")?.clone();
        let known =
            ["scalar", "vector", "peratomtype", "atomtype", "matrix", "peratomtypepair", "atomtypepair"];
        let shape = match choice(args, "shape of a property", &known)? {
            "scalar" => Shape::Scalar,
            "vector" | "peratomtype" | "atomtype" => Shape::Types,
            _ => Shape::Pairs,
        };
        if let Some((_, wanted)) = PROPERTIES.iter().find(|(known, _)| *known == name.text)
            && *wanted != shape
        {
            let text = format!("property `{}` is given as {}", name.text, wanted.word());
            return Err(Diagnostic::error(Code::BAD_VALUE, name.span, text).into());
        }
        let mut types: usize = 1;
        if shape == Shape::Pairs {
            let (word, note) = rounded(&number(args, "the number of atom types")?);
            self.notes.0.extend(note);
            types = word.text.parse().unwrap_or(0);
        }
        let mut values = vec![];
        while !args.is_empty() {
            values.push(number(args, "a value of the property")?);
        }
        let wanted = if shape == Shape::Pairs { types.saturating_mul(types) } else { values.len().max(1) };
        let wanted = if shape == Shape::Scalar { 1 } else { wanted };
        if values.len() != wanted {
            let text = format!("`{}` wants {wanted} values and has {}", name.text, values.len());
            let help = match shape {
                Shape::Pairs => "the number of atom types comes first, then its square of values, row by row",
                _ => "write the value behind the shape",
            };
            return Err(Diagnostic::error(Code::MISSING_ARGUMENT, cmd.span, text).help(help).into());
        }
        if shape == Shape::Pairs {
            symmetric(&name, &values, types)?;
        }
        let id = cmd.args[0].text.clone();
        if let Some(other) = self.properties.get(&name.text).filter(|p| p.id != id) {
            let text = format!("fix `{}` defines property `{}` already", other.id, name.text);
            let d = Diagnostic::error(Code::DUPLICATE_NAME, name.span, text).label(other.span, "here");
            return Err(d.help(format!("write `fix {} …`, which replaces its values", other.id)).into());
        }
        self.properties.retain(|_, p| p.id != id);
        let property = Property { id: id.clone(), shape, types, values, span: name.span, read: false };
        self.properties.insert(name.text.clone(), property);
        self.own.insert(id);
        self.version += 1;
        Ok(())
    }

    /// The value of a property for a pair of atom types, counted from 0.
    ///
    /// # Errors
    /// A property that is not there, with the line to write; too few values. `reader` is the word that needs it.
    pub(crate) fn of(&mut self, name: &str, reader: &Word, i: usize, j: usize) -> Result<Word> {
        let types = self.types();
        let Some(property) = self.properties.get_mut(name) else {
            if self.refused.contains(name) {
                return Ok(Word::new("1", reader.span));
            }
            return Err(missing(name, reader, types.max(1)));
        };
        property.read = true;
        let k = match property.shape {
            Shape::Scalar => 0,
            Shape::Types => i,
            Shape::Pairs if i.max(j) >= property.types => usize::MAX,
            Shape::Pairs => i * property.types + j,
        };
        match property.values.get(k) {
            Some(word) => Ok(word.clone()),
            None => {
                let text = format!("property `{name}` has no value for atom type {}", i.max(j) + 1);
                let d = Diagnostic::error(Code::INCOMPLETE, property.span, text);
                Err(d.label(reader.span, "read here").into())
            }
        }
    }

    /// How many atom types the deck has: of the box, else as many as properties have values.
    pub(crate) fn types(&self) -> usize {
        let given = |p: &Property| match p.shape {
            Shape::Scalar => 0,
            Shape::Types => p.values.len(),
            Shape::Pairs => p.types,
        };
        let most = self.properties.values().map(given).max().unwrap_or(0);
        self.box_types.unwrap_or(most)
    }

    /// Properties that no model reads: those that LIGGGHTS does not have either may be misspelt.
    pub(crate) fn note_unread(&mut self) {
        let mut found = vec![];
        for (name, property) in self.properties.iter_mut().filter(|(_, p)| !p.read) {
            property.read = true;
            let text = format!("property `{name}` is read by no model of this deck");
            let mut note = Diagnostic::note(Code::DIALECT, property.span, text);
            let names = PROPERTIES.iter().map(|(name, _)| *name);
            if let Some(near) = nearest(name, names).filter(|near| *near != name.as_str()) {
                note = note.help(format!("did you mean `{near}`?"));
            }
            found.push(note);
        }
        self.notes.0.extend(found);
    }
}

/// The error for a property that a model wants, with the line that defines it.
fn missing(name: &str, reader: &Word, types: usize) -> perigrain_base::diag::Diagnostics {
    let shape = PROPERTIES.iter().find(|(known, _)| *known == name).map_or(Shape::Scalar, |(_, s)| *s);
    // A line that can be read.
    let types = types.min(4);
    let values = match shape {
        Shape::Scalar => " X".to_string(),
        Shape::Types => " X".repeat(types),
        Shape::Pairs => format!(" {types}{}", " X".repeat(types * types)),
    };
    let text = format!("`{}` needs property `{name}`, which no line above defines", reader.text);
    Diagnostic::error(Code::INCOMPLETE, reader.span, text)
        .help(format!("write `fix ID all property/global {name} {}{values}`", shape.word()))
        .into()
}

/// A matrix of pairs must be symmetric.
fn symmetric(name: &Word, values: &[Word], types: usize) -> Result<()> {
    for i in 0..types {
        for j in 0..i {
            let (a, b) = (&values[i * types + j], &values[j * types + i]);
            let differ = match (value(a), value(b)) {
                (Some(x), Some(y)) => x != y && !a.unknown && !b.unknown,
                _ => !is_open(a) && !is_open(b),
            };
            if differ {
                let text = format!(
                    "property `{}` differs for pair {} {} and pair {} {}: {} and {}",
                    name.text,
                    j + 1,
                    i + 1,
                    i + 1,
                    j + 1,
                    b.text,
                    a.text
                );
                let d = Diagnostic::error(Code::CONFLICT, a.span, text).label(b.span, "the other one");
                return Err(d.help("a pair has one value: write the same number at both places").into());
            }
        }
    }
    Ok(())
}

impl Translator {
    /// `property/atom NAME scalar …`: a native property of the same name, and a compute that shows it as `f_ID`. Of the words behind
    /// `scalar` the last one may be the value at first.
    pub(crate) fn atom_property(&mut self, cmd: &Command, args: &mut Args) -> Result<Option<Vec<Command>>> {
        let Some(shape) = args.peek_at(1).filter(|w| w.text == "scalar" || w.text == "vector") else {
            return Ok(None);
        };
        let name = args.expect("the name of a property")?.clone();
        if shape.text == "vector" {
            let help = "write one scalar property for each component";
            return Err(without_counterpart(&name, "a property with several values", help).into());
        }
        let mut line = crate::native::Line::styled(cmd, "property/atom");
        line.put(&format!("d_{}", name.text), name.span);
        let first = args.rest().last().filter(|w| is_open(w) || value(w).is_some_and(|x| x != 0.0));
        if let Some(first) = first {
            line.put("initial", first.span).word(first);
        }
        let id = &cmd.args[0].text;
        let mut compute = crate::native::Line::new(cmd, "compute");
        compute.put(&format!("f_{id} all property/atom d_{}", name.text), name.span);
        self.shown.insert(format!("f_{id}"));
        Ok(Some(vec![line.done(), compute.done()]))
    }
}
