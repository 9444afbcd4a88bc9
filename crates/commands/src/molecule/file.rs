//! A molecule file: header and sections.

use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, fail, nearest};
use perigrain_geometry::text::{Line, Lines, not_here, number, under_heading, whole};
use perigrain_world::Template;

const SECTIONS: [&str; 9] = [
    "Coords",
    "Types",
    "Molecules",
    "Diameters",
    "Masses",
    "Bonds",
    "Angles",
    "Special Bond Counts",
    "Special Bonds",
];

/// Sections LAMMPS has besides.
const ELSEWHERE: [&str; 11] = [
    "Charges",
    "Dipoles",
    "Fragments",
    "Dihedrals",
    "Impropers",
    "Shake Flags",
    "Shake Atoms",
    "Shake Bond Types",
    "Body Integers",
    "Body Doubles",
    "Bodies",
];

/// Header words with a count that must be zero here.
const COUNTS: [&str; 4] = ["dihedrals", "impropers", "fragments", "body"];

/// Reads a file and leaves notes about it; whether lists of special bonds were read past.
///
/// # Errors
/// The first thing that is wrong, with its place in the text.
pub fn read(text: &str, notes: &mut Diagnostics) -> Result<(Template, bool)> {
    let mut lines = Lines::new(text);
    let mut f = File {
        t: Template::default(),
        bonds: 0,
        angles: 0,
        skipped: false,
        seen: vec![],
        notes: Diagnostics::default(),
    };
    f.t.title = lines.take().map_or(String::new(), |l| l.text.trim().to_string());
    while let Some(line) = lines.take_filled() {
        if line.text.trim_start().starts_with(|c: char| c.is_ascii_alphabetic()) {
            f.section(&line, &mut lines)?;
        } else if f.seen.is_empty() {
            f.header(&line)?;
        } else {
            return fail(Code::EXTRA_ARGUMENT, line.span(), "this line belongs to no section");
        }
    }
    if f.t.count == 0 {
        return fail(Code::INCOMPLETE, lines.end(), "the header must have the number of atoms: `N atoms`");
    }
    for (promised, have, what, section) in
        [(f.bonds, f.t.bonds.len(), "bonds", "Bonds"), (f.angles, f.t.angles.len(), "angles", "Angles")]
    {
        if have < promised {
            let text = format!("the header promises {promised} {what}, but there is no section {section}");
            return fail(Code::INCOMPLETE, lines.end(), text);
        }
    }
    notes.append(f.notes);
    Ok((f.t, f.skipped))
}

struct File {
    t: Template,
    /// Number of bonds the header promises.
    bonds: usize,
    /// And of angles.
    angles: usize,
    skipped: bool,
    seen: Vec<String>,
    notes: Diagnostics,
}

impl File {
    fn header(&mut self, line: &Line) -> Result<()> {
        let mut words: Vec<&str> = line.words().collect();
        let first = words
            .iter()
            .position(|w| w.starts_with(|c: char| c.is_ascii_alphabetic()))
            .unwrap_or(words.len());
        let name = words.split_off(first).join(" ");
        let numbers = |n: usize| -> Result<Vec<f64>> {
            if words.len() != n {
                return fail(Code::SYNTAX, line.span(), format!("`{name}` takes {n} numbers before it"));
            }
            words.iter().map(|w| number(line, w, &name)).collect()
        };
        let count = || -> Result<usize> {
            let &[word] = words.as_slice() else {
                return fail(Code::SYNTAX, line.span(), format!("`{name}` takes one number before it"));
            };
            let k = whole(line, word, &name)?;
            match u16::try_from(k) {
                Ok(k) => Ok(usize::from(k)),
                Err(_) => fail(Code::BAD_VALUE, line.span_of(word), format!("there cannot be {k} {name}")),
            }
        };
        match name.as_str() {
            "atoms" => self.t.count = count()?,
            "bonds" => self.bonds = count()?,
            "angles" => self.angles = count()?,
            "mass" => {
                let m = numbers(1)?[0];
                if m <= 0.0 {
                    return fail(Code::BAD_VALUE, line.span(), "the mass must be greater than zero");
                }
                self.t.mass = Some(m);
            }
            "com" => self.t.com = numbers(3)?.first_chunk().copied(),
            "inertia" => self.t.inertia = numbers(6)?.first_chunk().copied(),
            other if COUNTS.contains(&other) => {
                if count()? > 0 {
                    return Err(not_here(line.span(), &format!("`{other}` in a molecule file")).into());
                }
            }
            other => {
                let known = ["atoms", "bonds", "angles", "mass", "com", "inertia"];
                let d = Diagnostic::error(
                    Code::UNKNOWN_KEYWORD,
                    line.span(),
                    format!("`{other}` is no header line of a molecule file"),
                );
                return Err(match nearest(other, known) {
                    Some(n) => d.help(format!("did you mean `{n}`?")),
                    None => d.help(format!("known: {}", known.join(", "))),
                }
                .into());
            }
        }
        Ok(())
    }

    fn section<'a>(&mut self, title: &Line<'a>, lines: &mut Lines<'a>) -> Result<()> {
        let name = title.words().collect::<Vec<_>>().join(" ");
        if ELSEWHERE.contains(&name.as_str()) {
            return Err(not_here(title.span(), &format!("the section {name} of a molecule file")).into());
        }
        if !SECTIONS.contains(&name.as_str()) {
            let d = Diagnostic::error(
                Code::UNKNOWN_KEYWORD,
                title.span(),
                format!("`{name}` is no section of a molecule file"),
            );
            return Err(match nearest(&name, SECTIONS) {
                Some(n) => d.help(format!("did you mean `{n}`?")),
                None => d.help(format!("known: {}", SECTIONS.join(", "))),
            }
            .into());
        }
        if self.seen.contains(&name) {
            return fail(Code::DUPLICATE_NAME, title.span(), format!("a second section {name}"));
        }
        self.notes.0.extend(under_heading(lines, &name)?);
        let count = match name.as_str() {
            "Bonds" => self.bonds,
            "Angles" => self.angles,
            _ => self.t.count,
        };
        // Before room is made for them: a header may promise more than the file holds.
        let mut ahead = *lines;
        let have = (0..count).take_while(|_| ahead.take().is_some_and(|l| !l.is_blank())).count();
        if have < count {
            let text = format!("the section {name} has {have} lines, the header promises {count}");
            return fail(Code::INCOMPLETE, title.span(), text);
        }
        self.make_room(&name);
        let mut there = vec![false; count];
        for _ in 0..count {
            let Some(line) = lines.take() else { break };
            self.row(&name, &line, &mut there)?;
        }
        self.seen.push(name);
        Ok(())
    }

    fn make_room(&mut self, name: &str) {
        let n = self.t.count;
        let t = &mut self.t;
        match name {
            "Coords" => t.places = vec![[0.0; 3]; n],
            "Types" => t.kinds = vec![1; n],
            "Molecules" => t.molecules = vec![1; n],
            "Diameters" => t.radii = vec![0.5; n],
            "Masses" => t.masses = vec![1.0; n],
            _ => {}
        }
    }

    fn row(&mut self, name: &str, line: &Line, there: &mut [bool]) -> Result<()> {
        let words: Vec<&str> = line.words().collect();
        if name.starts_with("Special") {
            self.skipped = true;
            return Ok(());
        }
        let wanted = match name {
            "Coords" | "Bonds" => 4,
            "Angles" => 5,
            _ => 2,
        };
        if words.len() != wanted {
            let text = format!("{wanted} words are needed here, not {}", words.len());
            return fail(Code::SYNTAX, line.span(), text);
        }
        let k = within(line, words[0], there.len(), "the number")?;
        if std::mem::replace(&mut there[k], true) {
            return fail(Code::DUPLICATE_NAME, line.span_of(words[0]), format!("{} a second time", words[0]));
        }
        let least = |word: &str, what: &str| -> Result<f64> {
            let a = number(line, word, what)?;
            if a > 0.0 {
                return Ok(a);
            }
            fail(Code::BAD_VALUE, line.span_of(word), format!("{what} must be greater than zero: {word}"))
        };
        let t = &mut self.t;
        match name {
            "Coords" => {
                for (x, word) in t.places[k].iter_mut().zip(&words[1..]) {
                    *x = number(line, word, "a coordinate")?;
                }
            }
            "Types" => t.kinds[k] = kind(line, words[1], "the type")?,
            "Molecules" => t.molecules[k] = u32::from(kind(line, words[1], "the molecule")?),
            "Diameters" => t.radii[k] = 0.5 * least(words[1], "the diameter")?,
            "Masses" => t.masses[k] = least(words[1], "the mass")?,
            "Angles" => {
                let end = |word| within(line, word, t.count, "an end of an angle");
                let ends @ [a, b, c] = [end(words[2])?, end(words[3])?, end(words[4])?];
                if a == b || b == c || a == c {
                    let text = "an angle needs three different particles";
                    return fail(Code::BAD_VALUE, line.span(), text);
                }
                t.angles.push((kind(line, words[1], "the angle type")?, ends.map(|k| k as u32 + 1)));
            }
            _ => {
                let (a, b) = (
                    within(line, words[2], t.count, "an end of a bond")?,
                    within(line, words[3], t.count, "an end of a bond")?,
                );
                if a == b {
                    return fail(
                        Code::BAD_VALUE,
                        line.span_of(words[3]),
                        "a bond needs two different particles",
                    );
                }
                t.bonds.push((kind(line, words[1], "the bond type")?, [a as u32 + 1, b as u32 + 1]));
            }
        }
        Ok(())
    }
}

/// A number from 1 to `last`, as an index from 0.
fn within(line: &Line, word: &str, last: usize, what: &str) -> Result<usize> {
    let k = whole(line, word, what)?;
    match usize::try_from(k) {
        Ok(n) if n >= 1 && n <= last => Ok(n - 1),
        _ => fail(
            Code::BAD_VALUE,
            line.span_of(word),
            format!("{what} must lie between 1 and {last}, not {k}"),
        ),
    }
}

fn kind(line: &Line, word: &str, what: &str) -> Result<u16> {
    let k = whole(line, word, what)?;
    match u16::try_from(k) {
        Ok(n) if n >= 1 => Ok(n),
        _ => fail(Code::BAD_VALUE, line.span_of(word), format!("{what} must be from 1 to 65535, not {k}")),
    }
}
