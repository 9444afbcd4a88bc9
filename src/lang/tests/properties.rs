//! Property tests: no text, however odd, makes the reader panic.

use super::*;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever the bytes, a deck is read or refused.
    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        says(&String::from_utf8_lossy(&bytes));
    }

    /// The same for texts made of the language's own pieces.
    #[test]
    fn any_pieces(pieces in prop::collection::vec(prop::sample::select(PIECES), 0..40)) {
        let text = pieces.concat();
        says(&text);
        let mut world = World { check: text.len() % 2 == 0, ..World::default() };
        if let Ok(e) = Expr::parse(&text, Span::default()) {
            let _ = e.eval(&Vars::new(), &mut world);
            let _ = e.per_particle(&Vars::new(), &mut world);
        }
        let _ = printf(&text, 1.5);
        let _ = ValueRef::parse(&text, Span::default());
    }

    /// A number printed with 17 digits is read back to the bit.
    #[test]
    fn numbers_survive(v in any::<f64>().prop_filter("finite", |v| v.is_finite())) {
        let text = crate::math::cformat::general(v, 17);
        prop_assert_eq!(number::parse(&text), Some(v));
    }
}

const PIECES: &[&str] = &[
    " ",
    "\n",
    "\t",
    "&\n",
    "\"",
    "'",
    "\"\"\"",
    "#",
    "$",
    "${",
    "}",
    "$(",
    ")",
    "(",
    "x",
    "v_x",
    "c_sum",
    "[",
    "]",
    "1",
    "2.5",
    "e",
    ".",
    "-",
    "+",
    "*",
    "/",
    "%",
    "^",
    "!",
    "<",
    "=",
    "==",
    "&&",
    "||",
    "|^",
    ",",
    ":%g",
    "é",
    "variable",
    "equal",
    "index",
    "loop",
    "atom",
    "string",
    "format",
    "if",
    "then",
    "elif",
    "else",
    "next",
    "jump",
    "SELF",
    "label",
    "include",
    "print",
    "quit",
    "sqrt(",
    "random(",
    "count(",
    "stride2(",
    "variable x equal ",
    "variable x index ",
    "\nprint ",
    "\nif \"",
    "\" then \"",
    "jump SELF x\n",
    "label x\n",
];
