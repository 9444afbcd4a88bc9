//! The sections of a data file beside Atoms: Velocities, Bonds, Angles and their coefficients.

use super::body::{Reader, id};
use super::velocity_columns;
use perigrain_base::diag::{Code, Result, fail};
use perigrain_geometry::text::{Line, not_here, number, whole};
use perigrain_lang::{Command, Word};
use perigrain_world::index::Index;
use perigrain_world::{Angle, Bond};

/// A molecule ID.
pub(super) fn molecule_id(line: &Line, word: &str) -> Result<u32> {
    let k = whole(line, word, "the molecule")?;
    match u32::try_from(k) {
        Ok(id) => Ok(id),
        _ => {
            fail(Code::BAD_VALUE, line.span_of(word), format!("molecules go from 0 to {}, not {k}", u32::MAX))
        }
    }
}

impl<'a> Reader<'a> {
    /// The section Velocities.
    pub(super) fn velocities(&mut self, title: &Line) -> Result<()> {
        let p = &self.data.particles;
        if p.is_empty() && self.data.header.atoms > 0 {
            return fail(Code::WRONG_ORDER, title.span(), "the section Velocities must follow Atoms");
        }
        let index = Index::new(&p.tag);
        let wanted = velocity_columns(self.how.style);
        let count = self.data.header.atoms;
        self.data.velocities = true;
        self.rows("Velocities", title, count, |r, line| {
            let (mut values, mut n) = ([0.0; 6], 0);
            let mut words = line.words();
            let first = words.next().unwrap_or("");
            for word in words {
                if n < wanted {
                    values[n] = number(line, word, "a velocity")?;
                }
                n += 1;
            }
            if n != wanted {
                let text = format!("an id and {wanted} numbers are needed here, not an id and {n}");
                return fail(Code::SYNTAX, line.span(), text);
            }
            let p = &mut r.data.particles;
            let Some(i) = index.find(id(line, first)?, &p.tag) else {
                let text = format!("the section Atoms has no particle {first}");
                return fail(Code::UNKNOWN_NAME, line.span_of(first), text);
            };
            p.v[i] = [values[0], values[1], values[2]];
            if let Some(omega) = p.omega.get_mut(i) {
                *omega = [values[3], values[4], values[5]];
            }
            Ok(())
        })
    }

    /// A `pair_coeff` line from the words behind `types` types.
    pub(super) fn coeff(&mut self, line: &Line, types: usize) -> Result<()> {
        let words: Vec<&str> = line.words().collect();
        if words.len() < types {
            return fail(Code::SYNTAX, line.span(), "two types are needed here");
        }
        let mut args = vec![];
        for word in [words[0], words[types - 1]] {
            args.push(Word::new(self.kind(line, word)?.to_string(), line.span_of(word)));
        }
        args.extend(words[types..].iter().map(|w| Word::new(*w, line.span_of(w))));
        if !self.how.no_coeff {
            let (name, span) = (Word::new("pair_coeff", line.span()), line.span());
            self.data.coeffs.push(Command { name, args, span, text: line.text.trim().to_string() });
        }
        Ok(())
    }

    /// A `bond_coeff` line.
    pub(super) fn bond_coeff(&mut self, line: &Line) -> Result<()> {
        let kind = self.bond_kind(line, line.words().next().unwrap_or(""))?;
        self.coeff_of("bond_coeff", kind, line)
    }

    /// An `angle_coeff` line.
    pub(super) fn angle_coeff(&mut self, line: &Line) -> Result<()> {
        let kind = self.angle_kind(line, line.words().next().unwrap_or(""))?;
        self.coeff_of("angle_coeff", kind.into(), line)
    }

    /// The line of a command that gives coefficients to a type of bonds or angles.
    fn coeff_of(&mut self, command: &str, kind: i32, line: &Line) -> Result<()> {
        let words = line.words().skip(1);
        let mut args = vec![Word::new(kind.to_string(), line.span())];
        args.extend(words.map(|w| Word::new(w, line.span_of(w))));
        if !self.how.no_coeff {
            let (name, span) = (Word::new(command, line.span()), line.span());
            self.data.coeffs.push(Command { name, args, span, text: line.text.trim().to_string() });
        }
        Ok(())
    }

    fn angle_kind(&self, line: &Line, word: &str) -> Result<u16> {
        if word.starts_with(|c: char| c.is_ascii_alphabetic()) {
            return Err(not_here(line.span_of(word), &format!("the type label `{word}`")).into());
        }
        let shifted = whole(line, word, "the angle type")?.saturating_add(i64::from(self.how.angle_offset));
        match u16::try_from(shifted) {
            Ok(k) if k >= 1 && usize::from(k) <= self.data.angle_types => Ok(k),
            _ => {
                let text = format!("there are angle types 1 to {}, not {shifted}", self.data.angle_types);
                fail(Code::BAD_VALUE, line.span_of(word), text)
            }
        }
    }

    /// The id of a particle of this file.
    fn member(&self, index: &Index, line: &Line, word: &str) -> Result<u32> {
        let tag = id(line, word)?;
        match index.find(tag, &self.data.particles.tag) {
            Some(_) => Ok(tag),
            None => {
                let text = format!("the section Atoms has no particle {word}");
                fail(Code::UNKNOWN_NAME, line.span_of(word), text)
            }
        }
    }

    /// The section Angles.
    pub(super) fn angles(&mut self, title: &Line<'a>) -> Result<()> {
        if self.data.particles.is_empty() && self.data.header.atoms > 0 {
            return fail(Code::WRONG_ORDER, title.span(), "the section Angles must follow Atoms");
        }
        let index = Index::new(&self.data.particles.tag);
        let count = self.data.header.angles;
        self.rows("Angles", title, count, |r, line| {
            let words: Vec<&str> = line.words().collect();
            let &[_, kind, a, b, c] = words.as_slice() else {
                let text = "a number, an angle type and three ids are needed here";
                return fail(Code::SYNTAX, line.span(), text);
            };
            let kind = r.angle_kind(line, kind)?;
            let end = |word| r.member(&index, line, word);
            let ends @ [one, corner, other] = [end(a)?, end(b)?, end(c)?];
            if one == corner || corner == other || one == other {
                return fail(Code::BAD_VALUE, line.span(), "an angle needs three different particles");
            }
            r.data.angles.push(Angle { kind, ends });
            Ok(())
        })
    }

    fn bond_kind(&self, line: &Line, word: &str) -> Result<i32> {
        if word.starts_with(|c: char| c.is_ascii_alphabetic()) {
            return Err(not_here(line.span_of(word), &format!("the type label `{word}`")).into());
        }
        let shifted = whole(line, word, "the bond type")?.saturating_add(i64::from(self.how.bond_offset));
        match i32::try_from(shifted) {
            Ok(k) if k >= 1 && shifted <= self.data.bond_types as i64 => Ok(k),
            _ => {
                let text = format!("there are bond types 1 to {}, not {shifted}", self.data.bond_types);
                fail(Code::BAD_VALUE, line.span_of(word), text)
            }
        }
    }

    /// The section Bonds.
    pub(super) fn bonds(&mut self, title: &Line<'a>) -> Result<()> {
        if self.data.particles.is_empty() && self.data.header.atoms > 0 {
            return fail(Code::WRONG_ORDER, title.span(), "the section Bonds must follow Atoms");
        }
        let index = Index::new(&self.data.particles.tag);
        let count = self.data.header.bonds;
        self.rows("Bonds", title, count, |r, line| {
            let words: Vec<&str> = line.words().collect();
            let &[_, kind, a, b] = words.as_slice() else {
                let text = "a number, a bond type and two ids are needed here";
                return fail(Code::SYNTAX, line.span(), text);
            };
            let kind = r.bond_kind(line, kind)?;
            let end = |word| r.member(&index, line, word);
            let ends = [end(a)?, end(b)?];
            if ends[0] == ends[1] {
                return fail(Code::BAD_VALUE, line.span_of(b), "a bond needs two different particles");
            }
            r.data.bonds.push((Bond::new(kind, ends), line.start as u32));
            Ok(())
        })
    }
}
