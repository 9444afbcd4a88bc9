//! Words of `read_data`, and its refusal of particles outside the box.

use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_lang::Args;
use perigrain_styles::BuildCx;
use perigrain_styles::words::{Kind, Or, Value, Words};
use perigrain_world::Domain;

/// What becomes of the ids.
#[derive(Clone, Copy)]
pub enum Ids {
    /// There is no box yet.
    First,
    /// Behind the largest one.
    Append,
    /// As they are.
    Merge,
    /// This is added.
    Offset(u32),
}

/// The words that stand behind `add`.
#[derive(Words)]
#[word(what = "value of add")]
pub enum Place {
    /// Ids follow behind the largest one.
    Append,
    /// Ids stay as they are.
    Merge,
}

/// What stands behind `add`: a word, or a number that is added to each id.
pub type Adding = Or<Place, u32>;

/// Takes what follows `add`.
pub fn ids(a: &mut Args, _: &BuildCx) -> Result<Ids> {
    let word = a.expect("append, merge or an offset of ids")?;
    match word.text.as_str() {
        "append" => Ok(Ids::Append),
        "merge" => Ok(Ids::Merge),
        text => match text.parse::<u32>() {
            Ok(k) => Ok(Ids::Offset(k)),
            Err(_) => {
                let text = format!("`add` takes append, merge or an offset of ids, not `{text}`");
                fail(Code::BAD_VALUE, word.span, text)
            }
        },
    }
}

/// The five offsets, of types, bond types and angle types; the last two have nothing to act on.
#[derive(Words)]
pub struct Offsets {
    #[word(name = "TYPE", what = "the offset of types")]
    types: Offset,
    #[word(name = "BOND", what = "the offset of bond types")]
    bonds: Offset,
    #[word(name = "ANGLE", what = "the offset of angle types")]
    angles: Offset,
    #[word(name = "DIHEDRAL", what = "the offset of dihedral types")]
    _dihedrals: Offset,
    #[word(name = "IMPROPER", what = "the offset of improper types")]
    _impropers: Offset,
}

impl Offsets {
    /// Those of types, bond types and angle types.
    pub fn used(&self) -> [u16; 3] {
        [self.types.0, self.bonds.0, self.angles.0]
    }
}

/// What is added to types.
#[derive(Clone, Copy)]
pub struct Offset(pub u16);

impl Value for Offset {
    const KIND: Kind = Kind::Whole;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let span = args.here();
        let k = args.integer_from(0, what)?;
        match u16::try_from(k) {
            Ok(k) => Ok(Self(k)),
            Err(_) => fail(Code::BAD_VALUE, span, format!("there are no {k} types")),
        }
    }
}

/// Takes a number of extra types.
pub fn extra_types(a: &mut Args, _: &BuildCx) -> Result<usize> {
    let span = a.here();
    let n = a.integer_from(0, "the number of extra types")?;
    match u16::try_from(n) {
        Ok(n) => Ok(usize::from(n)),
        Err(_) => fail(Code::BAD_VALUE, span, "too many extra types"),
    }
}

/// The refusal of a particle outside the box.
pub fn outside(
    domain: &Domain,
    d: usize,
    x: &[f64; 3],
    span: Option<Span>,
    tag: u32,
) -> perigrain_base::diag::Diagnostics {
    let axis = ["x", "y", "z"][d];
    let text = format!(
        "particle {tag} lies outside the box: {axis} = {} is not within {} ≤ {axis} < {}",
        general(x[d], 8),
        general(domain.lo[d], 8),
        general(domain.hi[d], 8)
    );
    Diagnostic::error(Code::LOST, span, text)
        .help(format!("enlarge `{axis}lo {axis}hi` in the file, or make the dimension periodic"))
        .into()
}
