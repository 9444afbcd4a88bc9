//! Tests of formulas; expected values come from LAMMPS 22Jul2025 (`print "$(…)"`) unless noted otherwise.

#![allow(clippy::approx_constant)] // LAMMPS' twenty digits as it printed them

use super::super::tests::{Run, World};
use super::super::{Clock, Value, Vars};
use super::*;
use perigrain_base::diag::FileId;

fn value(text: &str, world: &mut World) -> Value {
    Expr::parse(text, Span::default()).and_then(|e| e.eval(&Vars::new(), world)).unwrap()
}

fn number(text: &str) -> f64 {
    match value(text, &mut World::default()) {
        Value::Number(v) => v,
        other => panic!("{text}: {other:?}"),
    }
}

/// The refusal of a formula: its message, and the bytes it underlines.
fn refusal(text: &str) -> (String, String) {
    let at = Span::new(FileId(0), 0, text.len());
    let mut world = World::default();
    let e = Expr::parse(text, at).and_then(|e| e.number(&Vars::new(), &mut world)).unwrap_err();
    let span = e.0[0].span.unwrap();
    (e.0[0].message.clone(), text[span.start as usize..span.end as usize].to_owned())
}

#[test]
fn precedence_is_lammps() {
    for (text, expected) in [
        ("2^3^2", 64.0),
        ("-2^2", 4.0),
        ("2^-1", 0.5),
        ("2^-1^2", 0.25),
        ("-(2)^2", 4.0),
        ("2*3^2", 18.0),
        ("-7%4", -3.0),
        ("7%-4", 3.0),
        ("7.5%2", 1.5),
        ("5-3%2", 4.0),
        ("8/4/2", 1.0),
        ("7-2-1", 4.0),
        ("2--1", 3.0),
        ("1 - - 1", 2.0),
        ("2 -1", 1.0),
        ("--2", 2.0),
        ("!0^2", 1.0),
        ("!2", 0.0),
        ("!!2", 1.0),
        ("-!0", -1.0),
        ("!1+1", 1.0),
        ("!1==0", 1.0),
        ("1<2<3", 1.0),
        ("3>2>1", 0.0),
        ("1==1==1", 1.0),
        ("3<2==0", 1.0),
        ("1+1==2&&3>2", 1.0),
        ("1||0&&0", 1.0),
        ("0||1&&0", 0.0),
        ("1|^0|^1", 0.0),
        ("1||1|^1", 0.0),
        ("1|^1||1", 1.0),
        ("3|^2", 0.0),
        ("1+2 * 3", 7.0),
        ("(1+2)*3", 9.0),
        (".5+1.e3+1E+3", 2000.5),
        ("yes+on+true-no-off-false", 3.0),
        ("version", 20250722.0),
    ] {
        assert_eq!(number(text), expected, "{text}");
    }
}

#[test]
fn functions_are_lammps() {
    for (text, expected) in [
        ("2^0.5", 1.4142135623730951455),
        ("0.1^3", 0.0010000000000000002377),
        ("atan2(1,-2)", 2.677945044588986967),
        ("tan(1)", 1.5574077246549022924),
        ("sin(1)", 0.84147098480789650488),
        ("log(1000)", 3.0),
        ("round(2.5)", 3.0),
        ("round(-2.5)", -2.0),
        ("round(0.49999999999999994)", 0.0),
        ("ternary(0,2,3)", 3.0),
        ("ternary(1,2,3)", 2.0),
        ("sign(-2)", -1.0),
        ("sign(0)", 1.0),
        ("abs(-2)^2", 4.0),
        ("ceil(2.1)+floor(-2.1)", 0.0),
        ("vdisplace(1,2)", 1.0),
        ("PI", 3.141592653589793116),
    ] {
        assert_eq!(number(text), expected, "{text}");
    }
    // LAMMPS yields 1 here (0 when !2.25 is written 0): with five operators waiting its result changes
    assert_eq!(number("0||1&&0>-!2.25"), 0.0);
    // column v_g of reference/golden/misc_script.csv, printed with 15 digits
    let g = number("asin(0.3)+acos(0.3)+atan(0.3)+atan2(1.0,-2.0)");
    assert!((g - 4.54019816586175).abs() < 1e-14);
}

#[test]
fn random_streams_are_lammps() {
    // one stream for all formulas, seeded by the first use: print "$(random(0,1,123)) $(normal(0,1,5)) $(random(2,4,9))"
    let mut run = Run::new();
    let out = run.deck("print \"$(random(0,1,123)) $(normal(0,1,5)) $(random(2,4,9))\"\n");
    assert_eq!(out, "0.13116937875747680664 0.077770928472550848731 2.7855100631713867188\n");
    assert_eq!(Run::new().deck("print $(normal(0,1,123))\n"), "-1.817735582812947559\n");
    assert!(refusal("random(0,1,0)").0.contains("seed"));
}

#[test]
fn time_functions_are_lammps() {
    // step, stagger(10,3), logfreq(2,3,10), logfreq2(3,4,6), logfreq3(3,6,40), stride(3,40,7),
    // stride2(3,50,10,13,23,4), logfreq2(10,4,3), stride2(2,37,10,7,19,4), logfreq3(2,9,20), by LAMMPS
    let table: &[[i64; 10]] = &[
        [0, 3, 2, 3, 3, 3, 3, 10, 2, 2],
        [2, 3, 4, 3, 3, 3, 3, 10, 7, 3],
        [3, 10, 4, 7, 6, 10, 13, 10, 7, 4],
        [5, 10, 6, 7, 6, 10, 13, 10, 7, 7],
        [6, 10, 20, 7, 9, 10, 13, 10, 7, 7],
        [7, 10, 20, 11, 9, 10, 13, 10, 11, 9],
        [9, 10, 20, 11, 15, 10, 13, 10, 11, 12],
        [10, 13, 20, 11, 15, 17, 13, 15, 11, 12],
        [11, 13, 20, 15, 15, 17, 13, 15, 15, 12],
        [13, 20, 20, 15, 15, 17, 17, 15, 15, 15],
        [15, 20, 20, 18, 24, 17, 17, 20, 19, 20],
        [17, 20, 20, 18, 24, 24, 21, 20, 19, 20],
        [18, 20, 20, 41, 24, 24, 21, 20, 19, 20],
        [19, 20, 20, 41, 24, 24, 21, 20, 22, 20],
    ];
    let formulas = [
        "stagger(10,3)",
        "logfreq(2,3,10)",
        "logfreq2(3,4,6)",
        "logfreq3(3,6,40)",
        "stride(3,40,7)",
        "stride2(3,50,10,13,23,4)",
        "logfreq2(10,4,3)",
        "stride2(2,37,10,7,19,4)",
        "logfreq3(2,9,20)",
    ];
    for row in table {
        let mut world = World { clock: Clock { step: row[0], ..Clock::default() }, check: false };
        for (f, expected) in formulas.iter().zip(&row[1..]) {
            assert_eq!(value(f, &mut world), Value::Number(*expected as f64), "{f} at step {}", row[0]);
        }
    }
    for (step, f, expected) in [
        (21, "stride2(3,50,10,13,23,4)", 33.0),
        (23, "stride2(3,50,10,13,23,4)", 33.0),
        (43, "stride2(3,50,10,13,23,4)", 53.0),
        (108, "logfreq2(3,4,6)", 243.0),
        (999, "logfreq3(10,25,1000)", 1000.0),
        (38, "stride(3,40,7)", 9223372036854774784.0),
        (50, "stride2(3,50,10,13,23,4)", 9223372036854774784.0),
    ] {
        let mut world = World { clock: Clock { step, ..Clock::default() }, check: false };
        assert_eq!(value(f, &mut world), Value::Number(expected), "{f} at step {step}");
    }
    for bad in ["stagger(1,3)", "stagger(3,3)", "logfreq(1,3,2)", "stride(5,4,1)", "logfreq3(10,1,100)"] {
        assert!(refusal(bad).0.contains("required"), "{bad}");
    }
}

#[test]
fn ramps_follow_the_run() {
    // thermo columns of LAMMPS: run 4 from step 0, dt 0.1: ramp, vdisplace, swiggle, cwiggle at step 2
    let clock = Clock { step: 2, begin: 0, end: 4, dt: 0.1, running: true };
    let mut world = World { clock, check: false };
    for (f, expected) in [
        ("ramp(1,2)", 1.5),
        ("vdisplace(1,2)", 1.4),
        ("swiggle(1,2,3)", 1.8134733),
        ("cwiggle(1,2,3)", 1.1729091),
    ] {
        let Value::Number(v) = value(f, &mut world) else { panic!() };
        // eight digits were printed
        assert!((v - expected).abs() < 1e-7, "{f} {v}");
    }
    world.clock.running = false;
    assert_eq!(value("ramp(1,2)", &mut world), Value::Number(1.0));
    assert!(refusal("swiggle(1,2,0)").0.contains("period"));
}

#[test]
fn values_from_outside() {
    let mut world = World::default();
    assert_eq!(value("vol*2+c_sum", &mut world), Value::Number(58.0));
    assert_eq!(value("c_sum[2]-C_om[7][3]", &mut world), Value::Number(20.0 - 73.0));
    assert_eq!(value("x[2]+vx[1]", &mut world), Value::Number(0.5));
    assert_eq!(value("count(all)+xcm(all, x,box)", &mut world), Value::Number(501.0 + 303.0));
    assert_eq!(value("x*2-vx", &mut world), Value::Atom(vec![2.0, 3.0, 4.0]));
    assert_eq!(value("(c_dmg>0.4)*x", &mut world), Value::Atom(vec![0.0, 1.5, 2.5]));
    assert_eq!(value("sqrt(f_v*4)", &mut world), Value::Vector(vec![2.0, 8f64.sqrt()]));
    world.check = true;
    assert_eq!(value("count(all)*2+1", &mut world), Value::Unknown);
    assert_eq!(value("2+1", &mut world), Value::Number(3.0));
}

#[test]
fn functions_of_vectors_and_names() {
    // vectors: LAMMPS 22Jul2025, `variable a vector [1,3,7]`, print "$(sum(v_a)) $(trap(v_a)) $(slope(v_a))"
    let mut run = Run::new();
    let out = run.deck(
        "variable a vector [1,3,7]\nprint \"$(sum(v_a)) $(min(v_a)) $(max(v_a)) $(ave(v_a)) $(trap(v_a)) $(slope(v_a))\"\n\
         variable b vector rsort(v_a)*2\nprint $b\nprint $(v_b[1])\n",
    );
    assert_eq!(out, "11 1 7 3.6666666666666665186 7 3\n[14,6,2]\n14\n");
    assert_eq!(number("sum(f_v)+slope(f_v)"), 4.0);
    assert_eq!(number("is_file(/nowhere/at/all)+is_timeout()"), 0.0);
    assert_eq!(number("is_os(.)"), 1.0);
}

#[test]
fn refusals_underline_the_word() {
    for (text, part, underlined) in [
        ("1+", "a number, a name or (", "+"),
        ("*2", "a number, a name or (", "*"),
        ("1 2", "an operator or the end", "2"),
        ("1)", "an operator or the end", ")"),
        ("(1", "never closed", "("),
        ("2*(1+3", "never closed", "("),
        ("1.2.3", "not a number", "1.2.3"),
        ("1e", "not a number", "1e"),
        ("2x+1", "not a number", "2x"),
        ("1e400", "too large", "1e400"),
        ("+2", "a number, a name or (", "+"),
        ("1=2", "an operator or the end", "="),
        ("(1)(2)", "an operator or the end", "("),
        ("1,2", "an operator or the end", ","),
        ("()", "a number, a name or (", ")"),
        ("1+foo(2)", "no function foo()", "foo"),
        ("2*sum(c_dmg)", "needs a global vector; `c_dmg` is one value per particle", "sum(c_dmg)"),
        ("1+sum(3)", "reads c_ID, c_ID[i], f_ID, f_ID[i] or v_name, not `3`", "sum(3)"),
        ("sum()", "sum() reads sum(c_ID|f_ID|v_name)", "sum()"),
        ("1+is_active(pair)", "reads is_active(category,feature)", "is_active(pair)"),
        ("1+py_f(2)", "no Python inside", "py_f"),
        ("1+[1,x]", "`x` is not a number", "x"),
        ("1+[1,]", "is not a number", "[1,]"),
        ("1+[1", "this bracket is never closed", "["),
        ("1+[1,2]", "one number is needed", "1+[1,2]"),
        ("is_typelabel(atom,C)", "needs a labelmap", "is_typelabel(atom,C)"),
        ("extract_setting(foo)", "knows no `foo`", "foo"),
        ("is_os([a)", "never closed", "[a"),
        ("sqrt(1,2)", "takes 1 argument, not 2", "sqrt(1,2)"),
        ("1+atan2(1)", "takes 2 arguments, not 1", "atan2(1)"),
        ("1+volume", "nothing a formula knows", "volume"),
        ("v_foo*2", "variable `foo` is not defined", "v_foo"),
        ("1+c_sum[0]", "an index is", "[0]"),
        ("step[1]", "cannot have an index", "step[1]"),
        ("2+C_om", "needs the particle's number", "C_om"),
        ("xcm(all,q)", "no component", "q"),
        ("count()", "count(group)", "count()"),
        ("1+4/0", "division by zero", "/"),
        ("5%0", "division by zero", "%"),
        ("0^-1", "zero to a negative power", "^"),
        ("1+sqrt(-1)", "root of a negative", "sqrt(-1)"),
        ("ln(0)", "not positive", "ln(0)"),
        ("asin(2)", "beyond 1", "asin(2)"),
        ("x+1", "one number is needed", "x+1"),
        ("f_v*c_dmg", "cannot be combined", "*"),
        ("1+é", "a number, a name or (", "é"),
    ] {
        let (message, word) = refusal(text);
        assert!(message.contains(part), "{text}: {message}");
        assert_eq!(word, underlined, "{text}: {message}");
    }
}

#[test]
fn deep_nesting_is_refused() {
    let deep = format!("{}1{}", "(".repeat(5000), ")".repeat(5000));
    assert!(refusal(&deep).0.contains("deeper"));
    let calls = format!("{}1{}", "abs(".repeat(5000), ")".repeat(5000));
    assert!(refusal(&calls).0.contains("deeper"));
    assert_eq!(number(&format!("{}1", "-".repeat(5000))), 1.0);
    assert_eq!(number(&vec!["1"; 5000].join("+")), 5000.0);
    assert_eq!(number(&format!("{}1{}", "(".repeat(90), ")".repeat(90))), 1.0);
}

#[test]
fn dependencies_go_through_variables() {
    let mut run = Run::new();
    run.deck("variable a equal v_b+pe\nvariable b equal c_sum[2]*vol+v_a+x[v_i]\nvariable i equal f_z\n");
    let e = Expr::parse("2*v_a+pe+c_sum[1]", Span::default()).unwrap();
    let names: Vec<String> = e
        .depends(&run.vars)
        .iter()
        .map(|d| match d {
            Dep::Keyword(k) => k.clone(),
            Dep::Ref(r) => r.to_string(),
        })
        .collect();
    assert_eq!(names, ["pe", "c_sum[1]", "c_sum[2]", "vol", "f_z"]);
}
