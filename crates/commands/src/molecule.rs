//! `molecule`: templates of molecules and clumps from files.

mod file;

use super::data::words::{Offset, Offsets};
use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, fail};
use perigrain_geometry::text::find;
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{self, not_here};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::Template;

/// The command.
pub struct Molecule;

impl Style for Molecule {
    fn name(&self) -> &'static str {
        "molecule"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Reads templates of molecules and clumps of spheres from files.",
            text: "Each file describes one molecule: a title line, then `N atoms`, `N bonds`, `N angles` and, if wanted, `M mass`, \
                   `X Y Z com`, `XX YY ZZ XY XZ YZ inertia`, then sections, each with a blank line after its name and one line per \
                   particle or bond: Coords (`number x y z`), Types (`number type`), Molecules (`number molecule`), Diameters, \
                   Masses, Bonds (`number type a b`), Angles (`number type a b c`). Files are looked for in the working folder, \
                   then beside the deck.\n\n\
                   Keywords belong to the file before them. Which pairs count as bonded follows from the bonds: Special Bond Counts \
                   and Special Bonds are read past, with a note. Charges, dipoles, dihedrals, bodies, fragments and SHAKE data are \
                   refused. A restart file does not hold templates, as in LAMMPS.",
            example: "print \"\"\"Two touching spheres\n\n2 atoms\n\nCoords\n\n1 0 0 0\n2 0.0009 0 0\n\nTypes\n\n1 2\n2 2\n\nDiameters\n\n\
                      1 0.001\n2 0.001\n\"\"\" file pair.txt screen no\nmolecule pair pair.txt\n\
                      create_atoms 0 single 0 0 0.006 mol pair 4928 units box",
        }
    }
}

/// A file and its keywords.
#[derive(Clone)]
struct FileWords {
    file: Word,
    kind: u16,
    bond: u16,
    angle: u16,
    scale: f64,
}

struct Reading {
    id: String,
    files: Vec<FileWords>,
}

#[derive(Words)]
struct Line {
    /// The template's ID.
    #[word(name = "ID", what = "the ID of a template")]
    id: Word,
    #[word(name = "file", least = 1)]
    files: Vec<Described>,
}

/// A file and its keywords.
#[derive(Words)]
struct Described {
    /// The file.
    #[word(name = "FILE", what = "a file name", kind = Kind::File)]
    file: Word,
    /// Added to the types of particles.
    #[word(keyword = "toff", name = "T", what = "the offset of types")]
    kind: Option<At<Offset>>,
    /// Added to the types of bonds.
    #[word(keyword = "boff", name = "B", what = "the offset of bond types")]
    bond: Option<At<Offset>>,
    /// Added to the types of angles.
    #[word(keyword = "aoff", name = "A", what = "the offset of angle types")]
    angle: Option<At<Offset>>,
    /// For dihedrals; without effect.
    #[word(keyword = "doff", name = "D", what = "the offset")]
    _dihedral: Option<Offset>,
    /// For impropers; without effect.
    #[word(keyword = "ioff", name = "I", what = "the offset")]
    _improper: Option<Offset>,
    /// All five.
    #[word(keyword, name = "types")]
    offset: Option<At<Offsets>>,
    /// The scale: coordinates, diameters and `com` are multiplied by it, masses by its third power, `inertia` by its fifth.
    #[word(keyword, name = "S", positive, default = 1.0)]
    scale: f64,
}

impl Described {
    /// What is added to types of particles, bonds and angles: of `offset` and the keyword of one the later one counts.
    fn offsets(&self) -> [u16; 3] {
        let own = [&self.kind, &self.bond, &self.angle];
        let all = self.offset.as_ref().map(|all| (all.span.start, all.value.used()));
        [0, 1, 2].map(|k| match (own[k], &all) {
            (Some(own), Some((at, _))) if own.span.start > *at => own.value.0,
            (_, Some((_, all))) => all[k],
            (Some(own), None) => own.value.0,
            (None, None) => 0,
        })
    }
}

impl CommandStyle for Molecule {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let line: Line = read(a, cx)?;
        let id = common::id(&line.id, "the template's ID")?;
        if cx.world.templates.contains_key(&id) {
            let text = format!("there is a molecule template `{id}` already");
            return fail(Code::DUPLICATE_NAME, line.id.span, text);
        }
        let mut files = vec![];
        for described in line.files {
            let [kind, bond, angle] = described.offsets();
            let Described { file, scale, .. } = described;
            if file.text.ends_with(".json") {
                return Err(not_here(&file, "a molecule file in JSON:"));
            }
            files.push(FileWords { file, kind, bond, angle, scale });
        }
        Ok(Box::new(Reading { id, files }))
    }
}

impl Act for Reading {
    fn apply(self: Box<Self>, cx: &mut ActCx) -> Result<()> {
        let mut list = vec![];
        for words in &self.files {
            let text = find(cx.world, &words.file, "molecule file")?;
            let mut notes = Diagnostics::default();
            let (mut t, skipped) = file::read(&text.text, &mut notes).map_err(|e| e.within(&text))?;
            notes.within(&text).0.into_iter().for_each(|note| cx.note(note));
            change(&mut t, words)?;
            if skipped {
                let note = "without effect: which pairs count as bonded follows from the bonds, not from Special Bonds";
                cx.note(Diagnostic::note(Code::NO_EFFECT, words.file.span, note));
            }
            log_summary(cx, &self.id, &t);
            list.push(t);
        }
        cx.world.templates.insert(self.id, list.into());
        Ok(())
    }

    fn needs_particles(&self) -> bool {
        false
    }
}

/// Offsets and scale.
fn change(t: &mut Template, words: &FileWords) -> Result<()> {
    let s = words.scale;
    for kind in &mut t.kinds {
        let Some(sum) = kind.checked_add(words.kind) else {
            return fail(Code::BAD_VALUE, words.file.span, "a type is beyond 65535 with its offset");
        };
        *kind = sum;
    }
    for (kind, _) in &mut t.bonds {
        *kind = kind.saturating_add(words.bond);
    }
    for (kind, _) in &mut t.angles {
        *kind = kind.saturating_add(words.angle);
    }
    t.places.iter_mut().chain(&mut t.com).flatten().for_each(|x| *x *= s);
    t.radii.iter_mut().for_each(|r| *r *= s);
    t.masses.iter_mut().chain(&mut t.mass).for_each(|m| *m *= s * s * s);
    t.inertia.iter_mut().flatten().for_each(|i| *i *= s * s * s * s * s);
    Ok(())
}

fn log_summary(cx: &mut ActCx, id: &str, t: &Template) {
    let kinds = t.kinds.iter().max().copied().unwrap_or(0);
    let bonds = t.bonds.iter().map(|b| b.0).max().unwrap_or(0);
    cx.print(format!("Read molecule template {id}:"));
    cx.print(t.title.clone());
    cx.print(format!("  {} molecules", t.last_molecule()));
    cx.print("  0 fragments");
    cx.print("  0 bodies");
    cx.print(format!("  {} atoms with max type {kinds}", t.count));
    cx.print(format!("  {} bonds with max type {bonds}", t.bonds.len()));
    let angles = t.angles.iter().map(|a| a.0).max().unwrap_or(0);
    cx.print(format!("  {} angles with max type {angles}", t.angles.len()));
    for what in ["dihedrals", "impropers"] {
        cx.print(format!("  0 {what} with max type 0"));
    }
}
