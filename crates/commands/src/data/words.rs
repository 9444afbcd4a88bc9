//! Words of `read_data`, and its refusal of particles outside the box.

use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_lang::Args;
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

/// Takes what follows `add`.
pub fn ids(a: &mut Args) -> Result<Ids> {
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
pub fn offsets(a: &mut Args) -> Result<[u16; 3]> {
    let mut offset = |what: &str| {
        let span = a.here();
        let types = a.integer_from(0, &format!("the offset of {what}"))?;
        u16::try_from(types).or_else(|_| fail(Code::BAD_VALUE, span, format!("there are no {types} types")))
    };
    let used = [offset("types")?, offset("bond types")?, offset("angle types")?];
    for what in ["dihedral types", "improper types"] {
        offset(what)?;
    }
    Ok(used)
}

/// Takes a number of extra types.
pub fn extra_types(a: &mut Args) -> Result<usize> {
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
