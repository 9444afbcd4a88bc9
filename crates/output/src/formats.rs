//! Which `printf` format a column gets: its own, the one for its kind, the one of the line, or the default.

use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::cformat::{Format, Spec};

/// Whether a column holds whole numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Counts, steps, ids.
    Int,
    /// Everything else that is a number.
    Float,
    /// Words, as the names of elements.
    Text,
}

/// The `format` settings of `thermo_modify` and `dump_modify`, in LAMMPS' order of precedence.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Formats {
    int: Option<Format>,
    float: Option<Format>,
    line: Vec<Format>,
    own: Vec<Option<Format>>,
}

impl Formats {
    /// `format line "…"`: one conversion per column, separated by blanks.
    pub fn set_line(&mut self, text: &str, kinds: &[Kind]) -> Result<()> {
        let words: Vec<&str> = text.split_whitespace().collect();
        if words.len() != kinds.len() {
            let message = format!("{} formats for {} columns", words.len(), kinds.len());
            let d = Diagnostic::error(Code::BAD_VALUE, None, message);
            return Err(d.help("give one conversion per column, separated by blanks").into());
        }
        self.line = words.iter().zip(kinds).map(|(w, &k)| conversion(w, k)).collect::<Result<_>>()?;
        Ok(())
    }

    /// `format int %…`.
    pub fn set_int(&mut self, text: &str) -> Result<()> {
        self.int = Some(conversion(text, Kind::Int)?);
        Ok(())
    }

    /// `format float %…`.
    pub fn set_float(&mut self, text: &str) -> Result<()> {
        self.float = Some(conversion(text, Kind::Float)?);
        Ok(())
    }

    /// `format N %…`, columns counted from 0 here.
    pub fn set_column(&mut self, column: usize, kind: Kind, text: &str) -> Result<()> {
        let format = conversion(text, kind)?;
        if self.own.len() <= column {
            self.own.resize(column + 1, None);
        }
        self.own[column] = Some(format);
        Ok(())
    }

    /// `format none`.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// The format of a column, if one was set.
    pub fn of(&self, column: usize, kind: Kind) -> Option<&Format> {
        let own = self.own.get(column).and_then(Option::as_ref);
        let general = match kind {
            Kind::Int => self.int.as_ref(),
            Kind::Float => self.float.as_ref(),
            Kind::Text => None,
        };
        own.or(general).or(self.line.get(column))
    }
}

/// A format with exactly one conversion that suits the column.
fn conversion(text: &str, kind: Kind) -> Result<Format> {
    let format = match Format::parse(text) {
        Ok(format) => format,
        Err(e) => return fail(Code::BAD_VALUE, None, format!("format `{text}`: {e}")),
    };
    let specs: Vec<Spec> = format.specs().copied().collect();
    let [spec] = specs[..] else {
        return fail(Code::BAD_VALUE, None, format!("format `{text}` should hold exactly one conversion"));
    };
    let (fits, wanted) = match kind {
        Kind::Int => (spec.is_integer(), "a whole number: use %d, as in `%10d`"),
        Kind::Text => (!spec.is_integer() && !spec.is_float(), "a word: use %s"),
        Kind::Float => (spec.is_float(), "a number with a point: use %g, %f or %e, as in `%15.8g`"),
    };
    if !fits {
        let d =
            Diagnostic::error(Code::BAD_VALUE, None, format!("format `{text}` does not suit this column"));
        return Err(d.help(format!("it shows {wanted}")).into());
    }
    Ok(format)
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_base::math::cformat::Value;

    #[test]
    fn precedence() {
        let kinds = [Kind::Int, Kind::Float, Kind::Float];
        let mut f = Formats::default();
        let show = |f: &Formats, k: usize| f.of(k, kinds[k]).map(|f| f.text(&[Value::Float(2.5)]));
        assert_eq!(show(&f, 1), None);
        f.set_line("%d %.2f %.3f", &kinds).unwrap();
        f.set_column(2, Kind::Float, "<%g>").unwrap();
        assert_eq!([0, 1, 2].map(|k| show(&f, k).unwrap()), ["2", "2.50", "<2.5>"]);
        f.set_float("%.1e").unwrap();
        f.set_int("%03d").unwrap();
        assert_eq!([0, 1, 2].map(|k| show(&f, k).unwrap()), ["002", "2.5e+00", "<2.5>"]);
        f.clear();
        assert_eq!(show(&f, 2), None);
    }

    #[test]
    fn nonsense_is_refused() {
        let mut f = Formats::default();
        let kinds = [Kind::Int, Kind::Float];
        for bad in ["%d", "%g %g", "%d a", "%d %d", "%d %y", "%d %g%g"] {
            assert!(f.set_line(bad, &kinds).is_err(), "{bad}");
        }
        assert!(f.set_int("%g").is_err());
        assert!(f.set_float("%d").is_err());
        assert!(f.set_float("%g %g").is_err());
    }
}
