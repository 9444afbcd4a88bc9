//! `write_data`: the scene as a LAMMPS data file.

use super::data::write;
use super::{Act, CommandStyle};
use perigrain_base::diag::{Result, Span};
use perigrain_lang::{Args, Word};
use perigrain_output::file::{Pattern, replace, trouble};
use perigrain_styles::common::{domain, settle};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::Promise;
use std::sync::Arc;

/// The command.
pub struct WriteData;

impl Style for WriteData {
    fn name(&self) -> &'static str {
        "write_data"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Writes box, particles, velocities and masses as a LAMMPS data file.",
            text: "The file has LAMMPS' sections and columns (see read_data), names the styles of a hybrid, as OVITO wants it, and \
                   appears whole or not at all. Numbers are written in the shortest form that is read back to the same bits. \
                   Positions are wrapped and shrink-wrapped faces follow the particles first, as in LAMMPS.\n\n\
                   No pair style writes coefficients into data files (of those that are here LAMMPS writes those of `zero` alone). \
                   Each fix property/atom has a section of its own unless its line has `writedata no`. Peridynamic bonds, damage, \
                   contact history, forces and the clock are not in a data file: write_restart has them. `types labels` and \
                   `triclinic/general` are refused.",
            example: "write_data plate.*.data nocoeff",
        }
    }
}

#[derive(Words)]
#[word(refused = "triclinic/general")]
struct Line {
    /// The file; a `*` in its name becomes the step.
    #[word(name = "FILE", what = "a file name", kind = Kind::File)]
    file: Word,
    /// LAMMPS' form of coefficients; without effect.
    #[word(keyword)]
    pair: Option<Pair>,
    /// Coefficients of bonds and angles are left out.
    #[word(flag)]
    nocoeff: bool,
    /// Fixes have no sections.
    #[word(flag)]
    nofix: bool,
    /// Without effect, as types have no labels.
    #[word(flag)]
    nolabelmap: bool,
    #[word(keyword)]
    types: Option<Types>,
}

/// LAMMPS' forms of coefficients.
#[derive(Words)]
#[word(what = "value of pair")]
enum Pair {
    Ii,
    Ij,
}

/// How types are written.
#[derive(Words)]
#[word(what = "write_data types", refused = "labels")]
enum Types {
    /// Types are numbers.
    Numeric,
}

struct Writing {
    file: Pattern,
    span: Span,
    with: write::With,
    checking: bool,
}

impl CommandStyle for WriteData {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        domain(cx)?;
        let Line { file: word, nocoeff, nofix, .. } = read(a, cx)?;
        let file = Pattern::new(&word.text).map_err(|e| e.at(word.span))?;
        let with = write::With { coeffs: !nocoeff, fixes: !nofix };
        Ok(Box::new(Writing { file, span: word.span, with, checking: cx.checking }))
    }
}

impl Act for Writing {
    fn apply(self: Box<Self>, cx: &mut ActCx) -> Result<()> {
        let w = &mut *cx.world;
        // A deck that is checked has no particles to write.
        if self.checking {
            let scene = Promise::Scene(Arc::new(w.clone()), vec![]);
            w.promised.keep(self.file.text(), scene);
            return Ok(());
        }
        w.spread_type_masses();
        settle(w);
        let path = self.file.at(w.clock.step);
        if w.promised.instead {
            let mut text = vec![];
            write::write(&mut text, w, self.with).map_err(|e| trouble("write", &path, &e).at(self.span))?;
            let text = String::from_utf8_lossy(&text).into_owned();
            w.promised.keep(&path.display().to_string(), Promise::Text(text));
            return Ok(());
        }
        replace(&path, |out| write::write(out, w, self.with)).map_err(|e| e.at(self.span))
    }

    fn needs_particles(&self) -> bool {
        false
    }
}
