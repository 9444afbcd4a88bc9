//! References to values: `v_name`, `c_ID`, `c_ID[2]`, `C_ID[7][1]`, `f_ID`.

use perigrain_base::diag::{Code, Result, Span, fail};

/// What kind of producer is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RefKind {
    /// `v_`
    Variable,
    /// `c_`
    Compute,
    /// `f_`
    Fix,
    /// `C_`: per-particle values of a compute, indexed by particle id.
    ComputeAtom,
    /// `F_`: per-particle values of a fix, indexed by particle id.
    FixAtom,
}

/// A reference to a value of a compute, fix or variable, with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct ValueRef {
    /// Whose.
    pub kind: RefKind,
    /// The variable's name or the compute's or fix's ID.
    pub name: String,
    /// Indices as written, from 1.
    pub index: Vec<usize>,
    /// Where.
    pub span: Span,
}

impl RefKind {
    /// The letter before the underscore.
    pub fn letter(self) -> char {
        match self {
            RefKind::Variable => 'v',
            RefKind::Compute => 'c',
            RefKind::Fix => 'f',
            RefKind::ComputeAtom => 'C',
            RefKind::FixAtom => 'F',
        }
    }

    /// The kind a letter stands for.
    pub fn from_letter(letter: char) -> Option<Self> {
        [Self::Variable, Self::Compute, Self::Fix, Self::ComputeAtom, Self::FixAtom]
            .into_iter()
            .find(|k| k.letter() == letter)
    }
}

impl ValueRef {
    /// Reads `v_name`, `c_ID[2]` …; `None` if the text does not begin like a reference.
    ///
    /// # Errors
    /// A reference that begins well and ends badly.
    pub fn parse(text: &str, span: Span) -> Result<Option<ValueRef>> {
        let kind = match text.as_bytes() {
            [b'v', b'_', ..] => RefKind::Variable,
            [b'c', b'_', ..] => RefKind::Compute,
            [b'f', b'_', ..] => RefKind::Fix,
            [b'C', b'_', ..] => RefKind::ComputeAtom,
            [b'F', b'_', ..] => RefKind::FixAtom,
            _ => return Ok(None),
        };
        let rest = &text[2..];
        let (name, mut tail) = rest.split_at(rest.find('[').unwrap_or(rest.len()));
        let bad = |why: &str| fail(Code::SYNTAX, span, format!("`{text}` is no reference: {why}"));
        if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
            return bad("the name must consist of letters, digits and underscores");
        }
        let mut index = vec![];
        while !tail.is_empty() {
            let Some((number, after)) = tail.strip_prefix('[').and_then(|t| t.split_once(']')) else {
                return bad("a bracket is not closed");
            };
            match number.parse::<usize>() {
                Ok(k) if k >= 1 => index.push(k),
                _ => return bad("an index must be a number from 1"),
            }
            tail = after;
        }
        Ok(Some(ValueRef { kind, name: name.to_string(), index, span }))
    }
}

impl std::fmt::Display for ValueRef {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}_{}", self.kind.letter(), self.name)?;
        self.index.iter().try_for_each(|k| write!(f, "[{k}]"))
    }
}

/// A parameter that may be a number or a reference.
#[derive(Clone, Debug, PartialEq)]
pub enum Param {
    /// A constant.
    Number(f64),
    /// A reference.
    Ref(ValueRef),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_and_prints_references() {
        let span = Span::default();
        for text in ["v_zc", "c_om[1]", "C_om[7][3]", "f_3[3]"] {
            let r = ValueRef::parse(text, span).unwrap().unwrap();
            assert_eq!(r.to_string(), text);
        }
        assert!(ValueRef::parse("vx", span).unwrap().is_none());
        assert!(ValueRef::parse("c_a[0]", span).is_err());
        assert!(ValueRef::parse("c_a[1", span).is_err());
        assert!(ValueRef::parse("v_", span).is_err());
    }
}
