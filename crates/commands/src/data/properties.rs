//! Sections of a data file for a fix property/atom: its properties, particle by particle.

use super::body::{ELSEWHERE, Reader, SECTIONS, id};
use super::more::molecule_id;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_geometry::text::{Line, number, whole};
use perigrain_lang::Args;
use perigrain_styles::words::{Grammar, Kind, Part, Value};
use perigrain_styles::{BuildCx, Use, UseKind};
use perigrain_world::index::Index;
use perigrain_world::properties::MOLECULE;
use perigrain_world::{Properties, World};

/// A section that a deck's line requests.
#[derive(Clone, Debug)]
pub struct Section {
    /// Its heading.
    pub name: String,
    /// What it holds.
    pub properties: Properties,
    /// The place of the request.
    pub span: Span,
}

/// What stands in a section: a column of values for each property but molecules, by particle.
#[derive(Debug, Default)]
pub struct Filled {
    /// Which of the requested sections.
    pub section: usize,
    /// A value for each particle, property by property; empty for molecules.
    pub columns: Vec<Vec<f64>>,
}

impl Value for Section {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[
            Part::bare("ID", Kind::Fix),
            Part::bare("HEADER", Kind::Text),
            Part::bare("SECTION", Kind::Text),
        ],
        ..*Grammar::NONE
    });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("the ID of a fix property/atom")?;
        match cx.names.fix_style(&word.text) {
            Some("property/atom") => {}
            Some(style) => {
                let text = format!("fix {} is of style {style} and takes nothing from data files", word.text);
                return fail(Code::WRONG_KIND, word.span, text);
            }
            None => {
                let text = format!("there is no fix `{}`", word.text);
                let d = Diagnostic::error(Code::UNKNOWN_FIX, word.span, text);
                return Err(d.help("`fix … property/atom` may stand before the box").into());
            }
        }
        cx.uses.borrow_mut().push(Use { kind: UseKind::Fix, name: word.text.clone() });
        let header = args.expect("the word of the header, `NULL` for none")?;
        if header.text != "NULL" {
            let text = "without effect: properties of particles have no line in the header";
            cx.note(Diagnostic::note(Code::NO_EFFECT, header.span, text));
        }
        let heading = args.expect("the heading of the section, `NULL` for the fix's ID")?;
        let name = if heading.text == "NULL" { &word.text } else { &heading.text };
        if SECTIONS.iter().chain(&ELSEWHERE).any(|s| s == name) {
            let text = format!("`{name}` is a section of data files by itself");
            return fail(Code::CONFLICT, heading.span, text);
        }
        let properties = cx.world.properties.iter().find(|p| p.fix == word.text).cloned();
        Ok(Self {
            name: name.split_whitespace().collect::<Vec<_>>().join(" "),
            properties: properties.unwrap_or_default(),
            span: word.span,
        })
    }
}

impl<'a> Reader<'a> {
    /// Requested section `k`.
    pub(super) fn properties(&mut self, k: usize, title: &Line<'a>) -> Result<()> {
        let section = &self.how.sections[k];
        let (name, wanted) = (&section.name, &section.properties);
        if self.data.particles.is_empty() && self.data.header.atoms > 0 {
            let text = format!("the section {name} must follow Atoms");
            return fail(Code::WRONG_ORDER, title.span(), text);
        }
        let (n, count) = (self.data.header.atoms, wanted.names.len());
        let index = Index::new(&self.data.particles.tag);
        let empty = |what: &String| if what == MOLECULE { vec![] } else { vec![0.0; n] };
        let mut columns: Vec<Vec<f64>> = wanted.names.iter().map(empty).collect();
        self.rows(name, title, n, |r, line| {
            let mut words = line.words();
            let first = words.next().unwrap_or("");
            let values: Vec<&str> = words.collect();
            if values.len() != count {
                let text = format!(
                    "an id and {count} values are needed here ({}), not an id and {}",
                    wanted.names.join(" "),
                    values.len()
                );
                return fail(Code::SYNTAX, line.span(), text);
            }
            let p = &mut r.data.particles;
            let Some(i) = index.find(id(line, first)?, &p.tag) else {
                let text = format!("the section Atoms has no particle {first}");
                return fail(Code::UNKNOWN_NAME, line.span_of(first), text);
            };
            for (c, (word, column)) in values.into_iter().zip(&mut columns).enumerate() {
                let what = &wanted.names[c];
                match column.get_mut(i) {
                    None => Properties::set_molecule(p, i, molecule_id(line, word)?),
                    Some(value) if wanted.whole(c) => *value = whole(line, word, what)? as f64,
                    Some(value) => *value = number(line, word, what)?,
                }
            }
            Ok(())
        })?;
        self.data.filled.push(Filled { section: k, columns });
        Ok(())
    }
}

/// Gives the particles from `first` on what stands in the sections.
pub fn fill(w: &mut World, sections: &[Section], filled: &[Filled], first: usize) {
    let n = w.n();
    for filled in filled {
        let properties = &sections[filled.section].properties;
        for (k, values) in filled.columns.iter().enumerate() {
            let Some(key) = properties.column(k) else { continue };
            let column = w.columns.scalar(key, n);
            column.iter_mut().skip(first).zip(values).for_each(|(to, value)| *to = *value);
        }
    }
}
