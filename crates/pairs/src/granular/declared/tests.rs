//! The words of granular coefficients and what is refused.

use super::*;
use perigrain_contact::driver::{Average, Curvature};
use perigrain_styles::testing::Bench;

fn read(words: &str) -> Result<Coeff> {
    let mut coeff = None;
    Bench::default().modify(words, |args, cx| {
        coeff = Some(words::coeff(args, cx, &[])?);
        args.finish()
    })?;
    Ok(coeff.unwrap())
}

fn refused(words: &str) -> (Code, String) {
    let d = read(words).err().unwrap().0.remove(0);
    let span = d.span.unwrap();
    (d.code, words[span.start as usize..span.end as usize].to_string())
}

#[test]
fn every_model_is_read() {
    let c = read("hertz/material 5e7 0.7 0.3 damping tsuji tangential mindlin NULL 1.0 0.4 limit_damping")
        .unwrap();
    assert_eq!(c.model.normal.material(), Some((5e7, 0.3)));
    assert_eq!((c.model.damping, c.model.limit_damping), (Damping::Tsuji, true));
    let c = read(
        "hertz 1e6 10 tangential mindlin 2e6 0 0.5 rolling none twisting none average body curvature impactor cutoff 0.1",
    )
    .unwrap();
    assert_eq!((c.average, c.curvature, c.cutoff), (Average::Body, Curvature::Impactor, Some(0.1)));
    assert_eq!(c.model.damping, Damping::Viscoelastic);
}

#[test]
fn what_is_not_there_is_refused_by_name_at_its_place() {
    let h = "hertz 1e6 0.5 tangential";
    let cases = [
        ("jkr 1e6 0.5 0.3 10 tangential mindlin NULL 1 0.5 damping tsuji".to_string(), Code::CONFLICT, "jkr"),
        ("dmt 1e6 0.5 0.3 10 limit_damping tangential none".to_string(), Code::CONFLICT, "limit_damping"),
        ("dmt 1e6 0.5 0.3 -1 tangential none".to_string(), Code::BAD_VALUE, "-1"),
        ("eepa 1e6 0.5 0.3 -0.1 0 1 1.5 1.5 tangential none".to_string(), Code::BAD_VALUE, "-0.1"),
        ("eepa 1e6 0.5 0.3 1.0 0 1 1.5 1.5 tangential none".to_string(), Code::BAD_VALUE, "1.0"),
        ("eepa 1e6 0.5 0.3 0.5 0 -1 1.5 1.5 tangential none".to_string(), Code::BAD_VALUE, "-1"),
        ("eepa 1e6 0.5 0.3 0.5 -2 1 1.5 1.5 tangential none".to_string(), Code::BAD_VALUE, "-2"),
        ("eepa 1e6 0.5 0.3 0.5 0 1 0.5 1.5 tangential none".to_string(), Code::BAD_VALUE, "0.5"),
        ("eepa 1e6 0.5 0.3 0.5 0 1 1.5 tangential none".to_string(), Code::BAD_NUMBER, "tangential"),
        ("epa 1e6 0.5 0.3 0.5 0 1 1.5 1.5 tangential none".to_string(), Code::UNKNOWN_STYLE, "epa"),
        (
            "eepa 1e6 0.5 0.3 0.5 0 1 1.5 1.5 limit_damping tangential none".to_string(),
            Code::CONFLICT,
            "limit_damping",
        ),
        ("mdr 1e6 0.3 1e5 0 0.5 0.5 tangential none".to_string(), Code::CONFLICT, "mdr"),
        ("mdr 1e6 0.5 1e5 0 0.5 0.5 tangential none damping mdr 1".to_string(), Code::BAD_VALUE, "0.5"),
        (format!("{h} mindlin 1 1 0.5 damping mdr 1"), Code::CONFLICT, "hertz"),
        ("herz 1e6 0.5".to_string(), Code::UNKNOWN_STYLE, "herz"),
        ("hooke -1 0.5".to_string(), Code::BAD_VALUE, "-1"),
        ("hooke nan 0.5".to_string(), Code::BAD_NUMBER, "nan"),
        (format!("{h} mindlin NULL 1 0.5"), Code::CONFLICT, "NULL"),
        (format!("{h} linear_history NULL 1 0.5"), Code::CONFLICT, "NULL"),
        (format!("{h} mindlin_scale 1 1 0.5"), Code::UNKNOWN_STYLE, "mindlin_scale"),
        (format!("{h} mindlin 1 1 0.5 rolling sds 1 1"), Code::MISSING_ARGUMENT, "1"),
        (format!("{h} mindlin 1 1 0.5 twisting sds 1 -1 1"), Code::BAD_VALUE, "-1"),
        (format!("{h} mindlin 1 1 0.5 twisting marshal"), Code::UNKNOWN_STYLE, "marshal"),
        (format!("{h} mindlin 1 1 0.5 heat area -2"), Code::BAD_VALUE, "-2"),
        (format!("{h} mindlin 1 1 0.5 dampng tsuji"), Code::UNKNOWN_KEYWORD, "dampng"),
        (format!("{h} mindlin 1 1 -0.5"), Code::BAD_VALUE, "-0.5"),
        ("hertz 1e6 1.5 tangential mindlin 1 1 0.5 damping tsuji".to_string(), Code::BAD_VALUE, "hertz"),
        (
            "hertz 1e6 0 tangential mindlin 1 1 0.5 damping coeff_restitution".to_string(),
            Code::BAD_VALUE,
            "hertz",
        ),
        ("hertz/material 1e6 0 0.6 tangential mindlin 1 1 0.5".to_string(), Code::BAD_VALUE, "0.6"),
        ("hertz 1e6 0".to_string(), Code::MISSING_ARGUMENT, "0"),
    ];
    for (words, code, place) in cases {
        assert_eq!(refused(&words), (code, place.to_string()), "{words}");
    }
}

#[test]
fn unlike_models_need_a_line_of_their_own() {
    let tail = "tangential mindlin 1e6 1.0 0.5";
    let mut d = Declared::new("granular", None);
    d.given.insert((1, 1), read(&format!("hertz 1e6 0.5 {tail}")).unwrap());
    d.given.insert((2, 2), read(&format!("hertz 4e6 0.5 {tail} damping tsuji")).unwrap());
    assert!(d.covers(1, 2) && d.covers(2, 1));
    assert_eq!(d.rule(1, 2, Compat::Perigrain).err().unwrap().0[0].code, Code::CONFLICT);
    d.given.insert((2, 2), read(&format!("hertz 4e6 0.5 {tail}")).unwrap());
    let (rule, reach) = d.rule(1, 2, Compat::Perigrain).unwrap().unwrap();
    // √(1e6 · 4e6).
    assert_eq!((rule.law.normal.power_law(1.0, 1.0), reach), (Some([2e6, 1.5]), Reach::Touch));
    d.restrict(&[(1, 2)]);
    let (rules, _) = d.tables(2, Compat::Perigrain).unwrap();
    assert!(rules.get(1, 1).is_none() && rules.get(2, 1).is_some());
}
