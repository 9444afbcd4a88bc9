//! Property tests: no text, however odd, makes the reader panic.

use super::*;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever the bytes, a deck is read or refused.
    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        output_of(&String::from_utf8_lossy(&bytes));
    }

    /// The same for texts made of the language's own pieces.
    #[test]
    fn any_pieces(pieces in prop::collection::vec(prop::sample::select(PIECES), 0..40)) {
        let text = pieces.concat();
        output_of(&text);
        let mut world = World { check: text.len() % 2 == 0, ..World::default() };
        if let Ok(e) = Expr::parse(&text, Span::default()) {
            let _ = e.eval(&Vars::new(), &mut world);
            let _ = e.per_particle(&Vars::new(), &mut world);
        }
        let _ = printf(&text, 1.5);
        let _ = ValueRef::parse(&text, Span::default());
    }

    /// The same for formulas alone, so that more of them are well formed.
    #[test]
    fn any_formula(pieces in prop::collection::vec(prop::sample::select(FORMULA), 1..25)) {
        let text = pieces.concat();
        let mut run = Run::new();
        run.shelf.0.insert("f".into(), "1\n2\n".into());
        run.shelf.0.insert("a".into(), "1\n1 2\n1\n2 3\n".into());
        let out = run.deck(&format!(
            "variable l vector [1,2,3]\nvariable f file f\nvariable a atomfile a\nvariable e equal {text}\n\
             variable v vector {text}\nvariable p atom {text}\nvariable q equal v_p[1]\nprint $e\nprint $v\nprint $q\n"
        ));
        prop_assert!(!out.contains("endless"));
    }

    /// Loops made of any lines end or are refused; a deck that runs for long changes something in each turn.
    #[test]
    fn any_loop(body in prop::collection::vec(prop::sample::select(LOOP), 0..8)) {
        let out = output_of(&format!("variable i loop 5\nlabel top\n{}jump SELF top\n", body.concat()));
        let grows = body.iter().any(|l| l.contains("$n") || l.contains("random") || l.contains("delete"));
        prop_assert!(grows || !out.contains("endless"), "{out}");
    }

    /// A number printed with 17 digits is read back to the bit.
    #[test]
    fn numbers_survive(v in any::<f64>().prop_filter("finite", |v| v.is_finite())) {
        let text = perigrain_base::math::cformat::general(v, 17);
        prop_assert_eq!(number::parse(&text), Some(v));
    }
}

const FORMULA: &[&str] = &[
    "1",
    "2.5",
    "-",
    "+",
    "*",
    "/",
    "^",
    "%",
    "!",
    "==",
    "<",
    "&&",
    "||",
    "|^",
    "(",
    ")",
    "[1,2,3]",
    "[",
    "]",
    ",",
    "v_l",
    "v_l[2]",
    "v_a[1]",
    "v_f",
    "v_a",
    "next(f)",
    "next(a)",
    "sum(v_l)",
    "sort(v_l)",
    "slope(f_v)",
    "min(c_sum)",
    "gmask(all)",
    "is_os(^L.*x)",
    "is_file(f)",
    "is_defined(variable,l)",
    "is_active(pair,single)",
    "sqrt(",
    "ternary(",
    "random(0,1,7)",
    "x",
    "id[2]",
    "x[v_l]",
    "PI",
    "step",
    "count(all)",
    "extract_setting(dimension)",
];

const LOOP: &[&str] = &[
    "next i\n",
    "variable j loop 3\n",
    "next j\n",
    "variable j delete\n",
    "variable n equal 1\n",
    "variable n equal $n+1\n",
    "variable n equal random(0,1,5)\nprint $n\n",
    "if \"$i > 3\" then \"jump SELF out\"\n",
    "if \"$i == 2\" then \"next i\" else \"print no\"\n",
    "print \"$i\"\n",
    "label out\n",
    "variable u universe a b\n",
    "next u\n",
    "quit\n",
];

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
    "vector",
    "[1,2]",
    "file",
    "atomfile",
    "timer",
    "internal",
    "world",
    "universe",
    "uloop",
    "sum(",
    "next(",
    "is_os(",
    "gmask(",
    "variable x vector ",
    "variable x universe ",
];
