//! What file- and atomfile-style variables have read.

use crate::number;
use crate::value::{Env, Value};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A position in a file that copies of a variable table share.
#[derive(Clone, Debug, Default)]
struct Cursor(Arc<AtomicUsize>);

impl Cursor {
    fn detached(&self) -> Self {
        Self(Arc::new(AtomicUsize::new(self.at())))
    }

    fn at(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }

    /// Moves on; whether there is something among `len` values.
    fn advance(&self, len: usize) -> bool {
        self.0.fetch_add(1, Ordering::Relaxed) + 1 < len
    }
}

/// The texts of a file, one per line that is not blank.
#[derive(Clone, Debug)]
pub(super) struct Lines {
    path: String,
    lines: Arc<[String]>,
    cursor: Cursor,
}

/// A line without its comment and the blanks around it.
fn bare(line: &str) -> &str {
    line.split('#').next().unwrap_or("").trim()
}

impl Lines {
    /// Takes the content of the file `path` apart.
    ///
    /// # Errors
    /// Nothing but blank lines and comments.
    pub fn read(path: &str, text: &str, span: Span) -> Result<Self> {
        let lines: Vec<String> = text.lines().map(bare).filter(|l| !l.is_empty()).map(String::from).collect();
        if lines.is_empty() {
            return fail(Code::BAD_VALUE, span, format!("the file `{path}` holds no value"));
        }
        Ok(Self { path: path.to_owned(), lines: lines.into(), cursor: Cursor::default() })
    }

    pub fn path(&self) -> &str {
        &self.path
    }

    pub fn detach(&mut self) {
        self.cursor = self.cursor.detached();
    }

    pub fn current(&self) -> &str {
        self.lines.get(self.cursor.at()).map_or("", String::as_str)
    }

    pub fn is_over(&self) -> bool {
        self.cursor.at() >= self.lines.len()
    }

    pub fn advance(&self) -> bool {
        self.cursor.advance(self.lines.len())
    }
}

/// One set of values: particle id and value.
type Set = Vec<(usize, f64)>;

/// Sets of values per particle.
#[derive(Clone, Debug)]
pub(super) struct AtomFile {
    path: String,
    sets: Arc<[Set]>,
    cursor: Cursor,
}

impl AtomFile {
    /// Takes the content of the file `path` apart: a number N, then N lines `id value`, and so on.
    ///
    /// # Errors
    /// Lines that are neither, sets that break off.
    pub fn read(path: &str, text: &str, span: Span) -> Result<Self> {
        let bad = |line: usize, what: String| {
            fail(Code::BAD_VALUE, span, format!("the file `{path}`, line {line}: {what}"))
        };
        let mut rows = text.lines().enumerate().map(|(k, l)| (k + 1, bare(l))).filter(|(_, l)| !l.is_empty());
        let mut sets: Vec<Set> = vec![];
        while let Some((line, head)) = rows.next() {
            let Some(count) = head.parse::<usize>().ok().filter(|n| *n > 0) else {
                return bad(line, format!("`{head}` is not the number of particles of a set"));
            };
            let mut set = Set::new();
            for _ in 0..count {
                let Some((line, row)) = rows.next() else {
                    return bad(line, format!("this set of {count} breaks off after {}", set.len()));
                };
                let words: Vec<&str> = row.split_whitespace().collect();
                let pair = match words[..] {
                    [id, value] => id.parse().ok().filter(|id| *id > 0).zip(number::parse(value)),
                    _ => None,
                };
                let Some(pair) = pair else {
                    return bad(line, format!("`{row}` is not a particle's id and a value"));
                };
                set.push(pair);
            }
            sets.push(set);
        }
        if sets.is_empty() {
            return fail(Code::BAD_VALUE, span, format!("the file `{path}` holds no set of values"));
        }
        Ok(Self { path: path.to_owned(), sets: sets.into(), cursor: Cursor::default() })
    }

    pub fn path(&self) -> &str {
        &self.path
    }

    pub fn detach(&mut self) {
        self.cursor = self.cursor.detached();
    }

    pub fn is_over(&self) -> bool {
        self.cursor.at() >= self.sets.len()
    }

    pub fn advance(&self) -> bool {
        self.cursor.advance(self.sets.len())
    }

    /// The present set as one value per particle, 0 for those it does not name.
    pub fn values(&self, span: Span, env: &mut dyn Env) -> Result<Value> {
        let Some(ids) = env.column("id") else {
            return fail(Code::WRONG_KIND, span, "the particles have no numbers");
        };
        let ids = ids?;
        if !env.sees_particles() {
            return Ok(Value::Unknown);
        }
        let mut place = std::collections::BTreeMap::new();
        ids.iter().enumerate().for_each(|(k, id)| {
            place.insert(*id as usize, k);
        });
        let largest = place.last_key_value().map_or(0, |(id, _)| *id);
        let mut out = vec![0.0; ids.len()];
        for (id, value) in self.sets.get(self.cursor.at()).into_iter().flatten() {
            match place.get(id) {
                Some(k) => out[*k] = *value,
                None if *id <= largest || ids.is_empty() => {}
                None => {
                    let message = format!("the file `{}` has a value for particle {id}", self.path);
                    let d = Diagnostic::error(Code::BAD_VALUE, span, message);
                    return Err(d.help(format!("the largest id in this scene is {largest}")).into());
                }
            }
        }
        Ok(Value::Atom(out))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_as_lammps_reads_them() {
        // `variable f file F; print "<$f>"; next f …` in LAMMPS 22Jul2025
        let text = "# c\n  1.5 two\n\n hello # x\n\"q r\" s\n7";
        let lines = Lines::read("f", text, Span::default()).unwrap();
        assert_eq!(&lines.lines[..], ["1.5 two", "hello", "\"q r\" s", "7"]);
        assert!(lines.advance() && lines.advance() && lines.advance());
        assert_eq!(lines.current(), "7");
        assert!(!lines.advance() && lines.is_over());
        assert!(Lines::read("f", "# only this\n\n", Span::default()).is_err());
    }

    #[test]
    fn sets_of_values_are_checked() {
        let read = |t: &str| AtomFile::read("a", t, Span::default());
        let a = read("2\n1 1.5\n3 -2\n\n# set\n1\n2 9\n").unwrap();
        assert_eq!(&a.sets[..], [vec![(1, 1.5), (3, -2.0)], vec![(2, 9.0)]]);
        for bad in ["", "0\n", "x\n", "2\n1 1\n", "1\n0 1\n", "1\n1\n", "1\n1 x\n", "1\n1 2 3\n"] {
            assert!(read(bad).is_err(), "{bad:?}");
        }
    }
}
