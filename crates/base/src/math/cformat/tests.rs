//! The conversions compared with glibc's `printf`.

use super::*;

/// Bits of a double, format, and the output of glibc 2.36's `printf`, one per line.
const GOLDEN: &str = include_str!("golden.tsv");

#[test]
fn floats_are_glibcs() {
    for line in GOLDEN.lines() {
        let mut columns = line.split('\t');
        let bits = u64::from_str_radix(columns.next().unwrap(), 16).unwrap();
        let format = columns.next().unwrap();
        let x = f64::from_bits(bits);
        let ours = Format::parse(format).unwrap().text(&[Value::Float(x)]);
        assert_eq!(ours, columns.next().unwrap(), "{format} of {x:e}");
    }
}

/// Format, value and glibc's output.
const INTEGERS: &[(&str, i64, &str)] = &[
    ("%d", 0, "0"),
    ("%i", -7, "-7"),
    ("%5d|", 42, "   42|"),
    ("%-5d|", -42, "-42  |"),
    ("%05d", -42, "-0042"),
    ("%+d", 42, "+42"),
    ("% d", 42, " 42"),
    ("%.3d", 7, "007"),
    ("%06.3d", 7, "   007"),
    ("%.0d|", 0, "|"),
    ("%x", 255, "ff"),
    ("%#X", 255, "0XFF"),
    ("%08x", -1, "ffffffff"),
    ("%lx", -1, "ffffffffffffffff"),
    ("%#o", 8, "010"),
    ("%u", -1, "4294967295"),
    ("%lld", 9_007_199_254_740_993, "9007199254740993"),
    ("%10ld|", 123_456_789_012, "123456789012|"),
    ("%#010x", 255, "0x000000ff"),
];

#[test]
fn integers_are_glibcs() {
    for &(format, value, expected) in INTEGERS {
        assert_eq!(Format::parse(format).unwrap().text(&[Value::Int(value)]), expected, "{format}");
    }
}

#[test]
fn text_and_mixtures() {
    // As printed by C.
    let f = Format::parse("100%% %s: %-6s|%.2s|%3d %g").unwrap();
    let values =
        [Value::Text("a"), Value::Text("bcd"), Value::Text("efgh"), Value::Int(5), Value::Float(0.5)];
    assert_eq!(f.text(&values), "100% a: bcd   |ef|  5 0.5");
    assert_eq!(f.specs().count(), 5);
    // An extension: a value of another type is converted instead of misread.
    assert_eq!(Format::parse("%d %g").unwrap().text(&[Value::Float(2.9), Value::Int(3)]), "2 3");
}

#[test]
fn nonsense_is_refused() {
    for bad in ["%", "%5", "%y", "%*d", "%.*f", "%99999d", "%n", "abc %-"] {
        assert!(Format::parse(bad).is_err(), "{bad}");
    }
    assert_eq!(Format::parse("ab %y").unwrap_err().at, 3);
    assert!(Spec::parse("%d ").is_err());
    assert!(Spec::parse("%-12.4e").is_ok());
}

// As written by LAMMPS 22Jul2025 into a data file.
#[test]
fn shortest_form_is_read_back() {
    let oracle = [
        (-5.500000000000001e-05, "-5.500000000000001e-05"),
        (0.500055, "0.500055"),
        (1e-9, "1e-09"),
        (2400.0, "2400"),
        (0.0, "0"),
        (1.2599210498948732, "1.2599210498948732"),
        (1.6e21, "1.6e+21"),
        (f64::NEG_INFINITY, "-inf"),
    ];
    for (x, text) in oracle {
        assert_eq!(shortest(x).to_string(), text);
    }
    for x in [f64::MIN_POSITIVE, f64::MAX, 1.0 / 3.0, -1e-5, 123456789012345678.0] {
        assert_eq!(shortest(x).to_string().parse::<f64>(), Ok(x));
    }
}
