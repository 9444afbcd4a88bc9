//! The sections of a data file: Masses, Atoms.

use super::header::{self, Header};
use super::more::molecule_id;
use super::properties::{Filled, Section};
use super::{Column, columns};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail, nearest};
use perigrain_geometry::text::{Line, Lines, not_here, number, under_heading, whole};
use perigrain_lang::Command;
use perigrain_world::index::twice;
use perigrain_world::{Angle, AtomStyle, Bond, Particles};

/// The deck's options for reading.
#[derive(Clone, Copy, Debug)]
pub struct How<'a> {
    /// Which columns there are.
    pub style: AtomStyle,
    /// The number of types there will be.
    pub types: Option<usize>,
    /// Added to every type.
    pub type_offset: u16,
    /// Types beyond those of the file.
    pub extra_types: usize,
    /// Skip coefficients.
    pub no_coeff: bool,
    /// The number of bond types there will be.
    pub bond_types: Option<usize>,
    /// Added to every bond type.
    pub bond_offset: u16,
    /// Bond types beyond those of the file.
    pub extra_bond_types: usize,
    /// The number of angle types there will be.
    pub angle_types: Option<usize>,
    /// Added to every angle type.
    pub angle_offset: u16,
    /// Angle types beyond those of the file.
    pub extra_angle_types: usize,
    /// Sections of fixes.
    pub sections: &'a [Section],
}

/// A data file that has been read.
#[derive(Debug, Default)]
pub struct DataFile {
    /// Its header.
    pub header: Header,
    /// The number of types, extra ones included.
    pub types: usize,
    /// Type and mass.
    pub masses: Vec<(u16, f64)>,
    /// Whether there were masses of types that have no effect.
    pub idle_masses: bool,
    /// The particles with ids, types, places and images as in the file; no density has become a mass yet.
    pub particles: Particles,
    /// Whether there were velocities.
    pub velocities: bool,
    /// The line on which each particle stands.
    pub lines: Vec<u32>,
    /// `pair_coeff`, `bond_coeff` and `angle_coeff` lines.
    pub coeffs: Vec<Command>,
    /// The number of bond types, extra ones included.
    pub bond_types: usize,
    /// Bonds with ids as in the file, and the lines on which they stand.
    pub bonds: Vec<(Bond, u32)>,
    /// The number of angle types, extra ones included.
    pub angle_types: usize,
    /// Angles with ids as in the file.
    pub angles: Vec<Angle>,
    /// The sections that belong to fixes.
    pub filled: Vec<Filled>,
    /// What is worth knowing of the file.
    pub notes: Diagnostics,
}

impl DataFile {
    /// The place of a particle's column in the text that was read.
    pub fn span(&self, text: &str, k: usize, column: Column) -> Option<Span> {
        let line = Lines::line_at(text, self.lines[k] as usize)?;
        let word = columns(self.particles.style).iter().position(|c| *c == column)?;
        line.words().nth(word).map(|w| line.span_of(w))
    }
}

/// Sections LAMMPS has besides.
pub(super) const ELSEWHERE: [&str; 18] = [
    "Dihedrals",
    "Impropers",
    "Dihedral Coeffs",
    "Improper Coeffs",
    "Ellipsoids",
    "Lines",
    "Triangles",
    "Bodies",
    "Atom Type Labels",
    "Bond Type Labels",
    "Angle Type Labels",
    "Dihedral Type Labels",
    "Improper Type Labels",
    "BondBond Coeffs",
    "BondAngle Coeffs",
    "MiddleBondTorsion Coeffs",
    "EndBondTorsion Coeffs",
    "AngleTorsion Coeffs",
];

pub(super) const SECTIONS: [&str; 9] = [
    "Masses",
    "Atoms",
    "Velocities",
    "Bonds",
    "Angles",
    "Pair Coeffs",
    "PairIJ Coeffs",
    "Bond Coeffs",
    "Angle Coeffs",
];

/// Reads a whole file.
///
/// # Errors
/// The first thing that is wrong, with its place in the text.
pub fn read<'a>(text: &'a str, how: &How<'a>) -> Result<DataFile> {
    let mut lines = Lines::new(text);
    let header = header::read(&mut lines)?;
    let types = how.types.unwrap_or(header.types + how.extra_types);
    if types > usize::from(u16::MAX) {
        let text = format!("at most {} types are possible, not {types}", u16::MAX);
        return fail(Code::BAD_VALUE, lines.end(), text);
    }
    let bond_types = how.bond_types.unwrap_or(header.bond_types + how.extra_bond_types);
    let angle_types = how.angle_types.unwrap_or(header.angle_types + how.extra_angle_types);
    let (bonds, angles) = (header.bonds_at, header.angles_at);
    for (at, there, what, of) in
        [(bonds, how.style.bonded, "bonds", "bond"), (angles, how.style.angled, "angles", "angle")]
    {
        if let Some(at) = at.filter(|_| !there) {
            let text = format!("particles of atom_style {} have no {what}", how.style.name());
            let d = Diagnostic::error(Code::CONFLICT, at, text);
            return Err(d.help(format!("`atom_style {of}`, alone or in a hybrid, has them")).into());
        }
    }
    let data = DataFile { header, types, bond_types, angle_types, ..DataFile::default() };
    let mut reader = Reader { lines, how: *how, data };
    let mut seen: Vec<String> = vec![];
    while let Some(title) = reader.lines.take_filled() {
        let name = title.words().collect::<Vec<_>>().join(" ");
        if seen.contains(&name) {
            return fail(Code::DUPLICATE_NAME, title.span(), format!("a second section {name}"));
        }
        reader.section(&name, &title)?;
        seen.push(name);
    }
    let promised = reader.data.header.atoms;
    if promised > 0 && reader.data.particles.is_empty() {
        let text = format!("the header promises {promised} atoms, but there is no section Atoms");
        return fail(Code::INCOMPLETE, reader.data.header.atoms_at.unwrap_or(reader.lines.end()), text);
    }
    let (header, data) = (&reader.data.header, &reader.data);
    for (promised, have, at, what, section) in [
        (header.bonds, data.bonds.len(), header.bonds_at, "bonds", "Bonds"),
        (header.angles, data.angles.len(), header.angles_at, "angles", "Angles"),
    ] {
        if promised > have {
            let text = format!("the header promises {promised} {what}, but there is no section {section}");
            return fail(Code::INCOMPLETE, at.unwrap_or(reader.lines.end()), text);
        }
    }
    Ok(reader.data)
}

/// A file being read.
pub(super) struct Reader<'a> {
    lines: Lines<'a>,
    pub(super) how: How<'a>,
    pub(super) data: DataFile,
}

impl<'a> Reader<'a> {
    fn section(&mut self, name: &str, title: &Line<'a>) -> Result<()> {
        let refuse = |what: &str| Err(not_here(title.span(), what).into());
        match name {
            _ if self.how.sections.iter().any(|s| s.name == name) => {}
            _ if !title.text.starts_with(|c: char| c.is_ascii_alphabetic()) => {
                let text = "this line belongs to no section: there are more lines than the header promises";
                return fail(Code::EXTRA_ARGUMENT, title.span(), text);
            }
            _ if ELSEWHERE.contains(&name) => return refuse(&format!("the section {name} of a data file")),
            _ if !SECTIONS.contains(&name) => {
                let text = format!("`{name}` is no section of a data file");
                let d = Diagnostic::error(Code::UNKNOWN_KEYWORD, title.span(), text);
                return Err(match nearest(name, SECTIONS) {
                    Some(n) => d.help(format!("did you mean `{n}`?")),
                    None => d.help(format!("known: {}", SECTIONS.join(", "))),
                }
                .into());
            }
            _ => {}
        }
        self.data.notes.0.extend(under_heading(&mut self.lines, name)?);
        let types = self.data.header.types;
        match name {
            "Masses" => self.rows(name, title, types, Self::mass),
            "Atoms" => self.atoms(title),
            "Velocities" => self.velocities(title),
            "Bonds" => self.bonds(title),
            "Angles" => self.angles(title),
            _ if let Some(k) = self.how.sections.iter().position(|s| s.name == name) => {
                self.properties(k, title)
            }
            "Bond Coeffs" => self.rows(name, title, self.data.header.bond_types, Self::bond_coeff),
            "Angle Coeffs" => self.rows(name, title, self.data.header.angle_types, Self::angle_coeff),
            "Pair Coeffs" => self.rows(name, title, types, |r, line| r.coeff(line, 1)),
            _ => self.rows(name, title, types * (types + 1) / 2, |r, line| r.coeff(line, 2)),
        }
    }

    /// Takes exactly `count` lines of a section.
    pub(super) fn rows(
        &mut self,
        name: &str,
        title: &Line,
        count: usize,
        mut take: impl FnMut(&mut Self, &Line<'a>) -> Result<()>,
    ) -> Result<()> {
        for have in 0..count {
            let of_fix = |l: &Line| self.how.sections.iter().any(|s| l.text.trim() == s.name);
            match self.lines.peek().filter(|l| !l.is_blank() && !begins_section(l) && !of_fix(l)) {
                Some(line) => take(self, &line)?,
                None => {
                    let text = format!("the section {name} has {have} lines, the header promises {count}");
                    let d = Diagnostic::error(Code::INCOMPLETE, title.span(), text);
                    let header = &self.data.header;
                    let at = match name {
                        "Atoms" | "Velocities" => header.atoms_at,
                        "Bonds" => header.bonds_at,
                        "Angles" => header.angles_at,
                        _ if self.how.sections.iter().any(|s| s.name == name) => header.atoms_at,
                        _ => None,
                    };
                    return Err(match at {
                        Some(at) => d.label(at, "promised here"),
                        None => d,
                    }
                    .into());
                }
            }
            self.lines.take();
        }
        Ok(())
    }

    /// A type, its offset added.
    pub(super) fn kind(&self, line: &Line, word: &str) -> Result<u16> {
        if word.starts_with(|c: char| c.is_ascii_alphabetic()) {
            return Err(not_here(line.span_of(word), &format!("the type label `{word}`")).into());
        }
        let k = whole(line, word, "the type")?;
        let shifted = k.saturating_add(i64::from(self.how.type_offset));
        match u16::try_from(shifted) {
            Ok(t) if k >= 1 && usize::from(t) <= self.data.types => Ok(t),
            _ => {
                let text = format!("there are types 1 to {}, not {shifted}", self.data.types);
                fail(Code::BAD_VALUE, line.span_of(word), text)
            }
        }
    }

    fn mass(&mut self, line: &Line) -> Result<()> {
        let idle = self.how.style.idle_type_mass();
        if self.how.style.own_mass() && !idle {
            let text = format!("particles of atom_style {} have masses of their own", self.how.style.name());
            return fail(Code::CONFLICT, line.span(), text);
        }
        let words: Vec<&str> = line.words().collect();
        let &[kind, mass] = words.as_slice() else {
            return fail(Code::SYNTAX, line.span(), "a type and its mass are needed here");
        };
        let kind = self.kind(line, kind)?;
        let m = number(line, mass, "the mass")?;
        if idle {
            self.data.idle_masses = true;
            return Ok(());
        }
        if m <= 0.0 {
            let text = format!("the mass must be greater than zero, not {mass}");
            return fail(Code::BAD_VALUE, line.span_of(mass), text);
        }
        self.data.masses.push((kind, m));
        Ok(())
    }

    fn atoms(&mut self, title: &Line) -> Result<()> {
        let style = self.how.style;
        if !title.comment.is_empty() && !style.is_laid_out_as(title.comment) {
            let at = title.span();
            let comment = Span { end: at.end + title.comment.len() as u32 + 3, ..at };
            let text = format!(
                "the particles of this file are of atom_style {}, those of the deck of atom_style {}",
                title.comment,
                style.words()
            );
            let d = Diagnostic::error(Code::CONFLICT, comment, text);
            return Err(d.help(format!("write `atom_style {}` before read_data", title.comment)).into());
        }
        let count = self.data.header.atoms;
        let layout = columns(style);
        self.data.particles.style = style;
        // A row has two bytes for each column at least: a header may promise more than the file can hold.
        let rest = self.lines.text().len() - self.lines.position().min(self.lines.text().len());
        let room = count.min(rest / (2 * layout.len()).max(1) + 1);
        self.data.particles.reserve(room);
        self.data.lines.reserve_exact(room);
        self.rows("Atoms", title, count, |r, line| r.atom(line, &layout))?;
        let tags = &self.data.particles.tag;
        match twice(tags) {
            Some((a, b)) => Err(self.twice(a, b)),
            None => Ok(()),
        }
    }

    /// Two particles with the same id.
    fn twice(&self, a: usize, b: usize) -> perigrain_base::diag::Diagnostics {
        let text = format!("a second particle {}", self.data.particles.tag[b]);
        let place = |k: usize| self.data.span(self.lines.text(), k, Column::Id);
        let d = Diagnostic::error(Code::DUPLICATE_NAME, place(b), text);
        match place(a) {
            Some(first) => d.label(first, "the first one"),
            None => d,
        }
        .into()
    }

    fn atom(&mut self, line: &Line, layout: &[Column]) -> Result<()> {
        let mut words = [""; 20];
        let mut n = 0;
        for word in line.words() {
            let Some(slot) = words.get_mut(n) else { return Err(self.misfit(line, layout, n + 1)) };
            *slot = word;
            n += 1;
        }
        if n != layout.len() && n != layout.len() + 3 {
            return Err(self.misfit(line, layout, n));
        }
        let (mut tag, mut kind, mut x) = (0, 0, [0.0; 3]);
        let (mut diameter, mut density, mut volume, mut molecule) = (0.0, 0.0, 0.0, 0);
        let (mut charge, mut moment) = (0.0, [0.0; 3]);
        for (column, word) in layout.iter().zip(words) {
            let least = |least: f64, open: bool| -> Result<f64> {
                let a = number(line, word, column.name())?;
                if a > least || (a == least && !open) {
                    return Ok(a);
                }
                let bound = if open { "greater than zero" } else { "not negative" };
                let text = format!("{} must be {bound}: {word}", column.name());
                fail(Code::BAD_VALUE, line.span_of(word), text)
            };
            match column {
                Column::Id => tag = id(line, word)?,
                Column::Type => kind = self.kind(line, word)?,
                Column::X(d) => x[*d] = number(line, word, column.name())?,
                Column::Diameter => diameter = least(0.0, false)?,
                Column::Density => density = least(0.0, true)?,
                Column::Volume => volume = least(0.0, true)?,
                Column::Molecule => molecule = molecule_id(line, word)?,
                Column::Charge => charge = number(line, word, column.name())?,
                Column::Moment(d) => moment[*d] = number(line, word, column.name())?,
            }
        }
        let mut image = [0; 3];
        if n > layout.len() {
            for (k, flag) in image.iter_mut().enumerate() {
                let word = words[layout.len() + k];
                let value = whole(line, word, "an image flag")?;
                // LAMMPS' image flags have ten bits; anything larger is a misplaced column.
                if value.abs() > 511 {
                    let text = format!("the image flag {word} is beyond -511 to 511");
                    return fail(Code::BAD_VALUE, line.span_of(word), text);
                }
                *flag = value as i32;
            }
        }
        self.data.lines.push(line.start as u32);
        let p = &mut self.data.particles;
        p.push(tag, kind, x);
        let last = p.x.len() - 1;
        p.image.set(last, image);
        if p.style.sphere {
            p.radius[last] = 0.5 * diameter;
        }
        if p.style.peri {
            p.volume[last] = volume;
        }
        if p.style.own_mass() {
            p.density[last] = density;
        }
        if p.style.molecules {
            p.molecule[last] = molecule;
        }
        if p.style.charged {
            p.charge[last] = charge;
        }
        if p.style.dipole {
            p.mu[last] = moment;
        }
        Ok(())
    }

    /// A line with too few or too many words.
    fn misfit(&self, line: &Line, layout: &[Column], have: usize) -> perigrain_base::diag::Diagnostics {
        let names: Vec<&str> = layout.iter().map(|c| c.name().trim_start_matches("the ")).collect();
        let text = format!(
            "this line has {have} columns; atom_style {} has {} ({}), or 3 more with image flags",
            self.how.style.name(),
            layout.len(),
            names.join(" ")
        );
        Diagnostic::error(Code::SYNTAX, line.span(), text)
            .help("the deck's `atom_style` must be the one the file was written for")
            .into()
    }
}

/// Data lines begin with a number; type labels, which could stand there too, are refused elsewhere.
fn begins_section(line: &Line) -> bool {
    let text = line.text.trim_start();
    SECTIONS.iter().chain(&ELSEWHERE).any(|s| text.starts_with(s))
}

pub(super) fn id(line: &Line, word: &str) -> Result<u32> {
    let k = whole(line, word, "the id")?;
    match u32::try_from(k) {
        Ok(tag) if tag >= 1 => Ok(tag),
        _ => fail(Code::BAD_VALUE, line.span_of(word), format!("ids go from 1 to {}, not {k}", u32::MAX)),
    }
}
