//! Every form of the report has the same content, with all signs escaped.

use super::*;
use crate::heads::Headed;
use crate::verify::case::Case;
use crate::verify::running::run;

/// A case with one check of each verdict, and a curve.
fn report() -> Report {
    let head = "title = \"A <title> & \\\"more\\\"\"\nabout = \"a|b\"\nsource = \"s\"\n\
        [[check]]\nwhat = \"good\"\nmeasure = \"v_seven\"\nexpected = 7.0\nunit = \"m\"\ntolerance = 0.1\nwhy = \"w\"\n\
        [[check]]\nwhat = \"known\"\nmeasure = \"v_seven\"\nexpected = 8.0\ntolerance = 0.1\nwhy = \"w\"\n\
        known = { ours = 7.0, within = 0.1, reason = \"because <it>\" }\n\
        [[check]]\nwhat = \"bad\"\ncurve = \"c\"\ntolerance = 0.1\nwhy = \"w\"\nsource = \"another\"\n\
        [[curve]]\nname = \"c\"\ntitle = \"C & D\"\nx = \"x, m\"\ny = \"y\"\n";
    let head: String = head.lines().map(|line| format!("#| {line}\n")).collect();
    let deck = format!("{head}variable seven equal 7\nprint \"curve c 1 2 4\"\n");
    let outcomes = vec![run(&Case::read("tests/report", &deck).unwrap())];
    Report { outcomes, machine: "a machine".into(), workers: 2, seconds: 1.5 }
}

#[test]
fn texts_name_verdict_numbers_and_reason() {
    let report = report();
    let text = of_case(&report.outcomes[0]);
    for line in [
        "  passed          good: 7 for 7 m, off by 0.0e0, allowed 1.0e-1\n",
        "  known deviation known: 7 for 8, off by -1.2e-1, allowed 1.0e-1\n                  because <it>\n",
        "  FAILED          bad (worst of 1 points, at x = 1): 2 for 4, off by -5.0e-1, allowed 1.0e-1\n",
    ] {
        assert!(text.contains(line), "{text}");
    }
    assert!(!report.is_well());
    assert!(summary(&report).contains("3 checks of 1 cases: 1 passed, 1 known deviations, 1 failed"));
    let page = markdown(&report);
    assert!(
        page.contains(
            "| bad (worst of 1 points, at x = 1) | 4 (another) | 2 | -5.0e-1 | 1.0e-1: w | FAILED |"
        ),
        "{page}"
    );
}

#[test]
fn numbers_have_the_digits_that_matter() {
    let all = [0.0, 7.0, 274.113e-6, 10696.9, 0.5503, 1.25e9, f64::NAN].map(number);
    assert_eq!(all, ["0", "7", "2.74113e-4", "10696.9", "0.5503", "1.25e9", "NaN"]);
}

#[test]
fn json_has_all_numbers() {
    let text = json(&report());
    assert!(text.contains("\"ours\": 7e0, \"unit\": \"m\", \"at\": null"), "{text}");
    assert!(text.contains("\"title\": \"A <title> & \\\"more\\\"\""), "{text}");
    assert!(text.contains("\"points\": [[1e0, 2e0, 4e0]]"), "{text}");
    assert!(text.contains("\"passed\": 1, \"known\": 1, \"failed\": 1"), "{text}");
}

/// The names of elements that are open or closed where they should not be.
fn unbalanced(xml: &str) -> Vec<String> {
    let (mut open, mut wrong) = (vec![], vec![]);
    for tag in xml.split('<').skip(1).filter_map(|rest| rest.split('>').next()) {
        let name = tag.split_whitespace().next().unwrap_or_default().trim_end_matches('/');
        let alone = tag.ends_with('/') || ["!DOCTYPE", "meta", "br", "?xml"].contains(&name);
        match name.strip_prefix('/') {
            Some(name) if open.pop() != Some(name) => wrong.push(name.to_string()),
            None if !alone => open.push(name),
            _ => {}
        }
    }
    wrong.extend(open.into_iter().map(String::from));
    wrong
}

#[test]
fn junit_and_the_page_are_well_formed() {
    let report = report();
    let xml = junit(&report);
    assert_eq!(unbalanced(&xml), [""; 0], "{xml}");
    assert!(xml.contains("tests=\"3\" failures=\"1\" skipped=\"1\""), "{xml}");
    assert!(xml.contains("<skipped message=\"known deviation: 7 instead of 8"), "{xml}");
    let page = html(&report);
    assert_eq!(unbalanced(&page), [""; 0], "{page}");
    assert!(page.contains("A &lt;title&gt; &amp; &quot;more&quot;") && page.contains("M72.0 "), "{page}");
    // Nothing is fetched from elsewhere.
    let fetched = page.replace("http://www.w3.org/2000/svg", "");
    assert!(!fetched.contains("http"), "{fetched}");
}
