//! Tables of points: a line of names, then a line of numbers for each point.

use super::file::place;
use crate::text::{Line, Lines, number};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail, nearest};

/// A table, read whole.
#[derive(Debug)]
pub struct Table {
    /// The names of the columns.
    pub names: Vec<String>,
    /// The numbers of the requested columns, row by row.
    pub rows: Vec<f64>,
    /// The place of each row: its first byte.
    lines: Vec<u32>,
    /// The requested columns, in their order.
    wanted: Vec<usize>,
    separator: Separator,
}

/// What stands between the fields.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Separator {
    Character(char),
    Blanks,
}

impl Separator {
    fn of(head: &str) -> Self {
        match [',', ';', '\t'].into_iter().find(|c| head.contains(*c)) {
            Some(c) => Self::Character(c),
            None => Self::Blanks,
        }
    }

    /// The fields of a line, without blanks and quotes around them; a separator within quotes separates nothing.
    fn fields(self, line: &str) -> Vec<&str> {
        let mut quoted = false;
        let parts = line.split(|c: char| {
            quoted ^= c == '"';
            !quoted
                && match self {
                    Self::Character(s) => c == s,
                    Self::Blanks => c.is_ascii_whitespace(),
                }
        });
        let parts = parts.map(|f| f.trim().trim_matches('"').trim());
        parts.filter(|f| self != Self::Blanks || !f.is_empty()).collect()
    }
}

impl Table {
    /// Reads the names of the columns.
    ///
    /// # Errors
    /// A file without a first line, two columns of one name.
    pub fn head(text: &str) -> Result<(Vec<String>, Span)> {
        let Some(head) = Lines::new(text).take_filled() else {
            return fail(
                Code::INCOMPLETE,
                place(0, 0),
                "the file is empty: a line with names of columns must come first",
            );
        };
        let fields = Separator::of(head.text).fields(head.text);
        if let Some(number) = fields.iter().find(|f| f.parse::<f64>().is_ok()) {
            let d = Diagnostic::error(
                Code::SYNTAX,
                head.span_of(number),
                "names of columns must stand in the first line, not numbers",
            );
            return Err(d.help("write for example x,y,z,volume above them").into());
        }
        for (k, name) in fields.iter().enumerate() {
            if !name.is_empty() && fields[..k].contains(name) {
                return fail(Code::DUPLICATE_NAME, head.span_of(name), format!("a second column `{name}`"));
            }
        }
        Ok((fields.iter().map(|f| f.to_string()).collect(), head.span()))
    }

    /// Reads the numbers of some columns.
    ///
    /// # Errors
    /// Lines with too few or too many fields, fields that are no numbers.
    pub fn read(text: &str, wanted: Vec<usize>) -> Result<Self> {
        let (names, _) = Self::head(text)?;
        let mut lines = Lines::new(text);
        let head = lines.take_filled();
        let separator = Separator::of(head.map_or("", |h| h.text));
        let mut t = Self { names, rows: vec![], lines: vec![], wanted, separator };
        while let Some(line) = lines.take_filled() {
            let fields = separator.fields(line.text);
            if fields.len() != t.names.len() {
                let text =
                    format!("this line has {} columns, the first one names {}", fields.len(), t.names.len());
                return fail(Code::SYNTAX, line.span(), text);
            }
            for &k in &t.wanted {
                let field = if fields[k].is_empty() { line.word(usize::MAX) } else { fields[k] };
                t.rows.push(number(&line, field, &t.names[k])?);
            }
            t.lines.push(line.start as u32);
        }
        Ok(t)
    }

    /// The number of points.
    pub fn count(&self) -> usize {
        self.lines.len()
    }

    /// The numbers of a row, in the order in which columns were requested.
    pub fn row(&self, k: usize) -> &[f64] {
        let n = self.wanted.len();
        &self.rows[k * n..(k + 1) * n]
    }

    /// The place of a row's field, by the index of the requested column; of the whole row for `None`.
    pub fn place(&self, text: &str, k: usize, column: Option<usize>) -> Option<Span> {
        let line: Line = Lines::line_at(text, self.lines[k] as usize)?;
        let Some(column) = column.and_then(|c| self.wanted.get(c)) else { return Some(line.span()) };
        let fields = self.separator.fields(line.text);
        Some(line.span_of(fields.get(*column)?))
    }
}

/// The error of a column that is not there.
pub fn no_column(names: &[String], head: Span, property: &str, name: &str) -> Diagnostic {
    let what = if property == name {
        format!("there is no column `{name}`")
    } else {
        format!("there is no column `{name}` for {property}")
    };
    let d = Diagnostic::error(Code::INCOMPLETE, head, what);
    match nearest(name, names.iter().map(String::as_str)) {
        Some(n) => d.help(format!("`columns {property} {n}` takes the column `{n}`")),
        None => d.help(format!("`columns {property} NAME` takes one of another name")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_by_comma_semicolon_tab_or_blanks() {
        for (text, names) in [
            ("x,y,z\n1,2,3\n", 3),
            ("\"a, b\",\"Points:0\"\n4,5\n", 2),
            ("x;y\n1;2", 2),
            ("x\ty\n1\t2", 2),
            ("# a comment\n x  y \n\n 1   2\n", 2),
        ] {
            let (head, _) = Table::head(text).unwrap();
            assert_eq!(head.len(), names, "{text}");
            let t = Table::read(text, (0..names).collect()).unwrap();
            assert_eq!((t.count(), t.row(0).len()), (1, names), "{text}");
        }
        assert_eq!(Table::head("\"a, b\",c\n").unwrap().0, ["a, b", "c"]);
    }
}
