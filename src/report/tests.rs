//! What pages must hold and must never let out.

use super::*;
use perigrain_output::rows::Row;

/// A report with a text that would be a script of its own in every place that a deck can fill.
fn hostile() -> (String, Report) {
    let evil = "</script><script>alert(1)</script><img src=x onerror=\"alert(2)\">";
    let mut r = Report::new(evil);
    let row = |step: i64| Row { step, time: 0.1 * step as f64, values: vec![step as f64, 2.0] };
    (0..3).for_each(|k| r.tables.push(vec!["step".into(), evil.into()], row(k)));
    r.ended = Ended::Failed(evil.into());
    r.origin = evil.into();
    r.figures = vec![(evil.into(), evil.into())];
    r.facts = r.figures.clone();
    r.deck = Some(Text { what: "Deck", name: evil.into(), text: evil.into() });
    r.columns = vec![(evil.into(), evil.into())];
    r.messages = vec![(Weight::Warning, evil.into())];
    r.plan = Some(evil.into());
    r.gallery.left_out = vec![evil.into()];
    r.gallery.pictures = vec![Picture { name: evil.into(), kind: "image/png", bytes: vec![1, 2] }];
    r.remarks = vec![evil.into()];
    (evil.into(), r)
}

#[test]
fn no_text_of_a_deck_becomes_a_script() {
    let (evil, report) = hostile();
    let page = html(&report);
    assert!(!page.contains("<script>alert") && !page.contains("<img src=x"), "unescaped");
    assert!(!page.contains(&evil));
    let scripts = page.matches("<script").count();
    assert_eq!(scripts, page.matches("</script>").count());
    assert_eq!(scripts, html(&Report::new("t")).matches("<script").count(), "a page of its own scripts only");
}

#[test]
fn a_page_needs_nothing_else() {
    let page = html(&hostile().1);
    for word in ["src=\"http", "href=\"http", "@import", "fetch(\"http", "eval(", "new Function", "url("] {
        assert!(!page.contains(word), "{word}");
    }
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    assert!(page.contains("default-src 'none'") && page.contains("uPlot (v1.6.32)"));
}

#[test]
fn an_empty_report_names_what_is_missing() {
    let page = html(&Report::new("nothing"));
    assert!(page.contains("There is no step table"), "{page}");
    assert!(!page.contains("id=\"pictures\"") && !page.contains("id=\"deck\""));
}
