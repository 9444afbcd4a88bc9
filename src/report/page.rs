//! The page itself: every text from a deck escaped, nothing fetched from anywhere.

use super::curves::{Column, Curves};
use super::film::{Packed, packed};
use super::{Ended, Report, Weight, short};
use crate::json::quoted;
use crate::plot::{escaped, page};
use crate::session::Part;
use perigrain_output::thermo::KEYWORDS;
use std::borrow::Cow;
use std::fmt::Write;

const STYLE: &str = concat!(include_str!("web/uplot/uPlot.min.css"), include_str!("web/page.css"));
/// Charts: uPlot 1.6.32, MIT; its licence lies beside it.
const UPLOT: &str = include_str!("web/uplot/uPlot.iife.min.js");
const CURVES: &str = include_str!("web/curves.js");
const VIEW: &str = include_str!("web/view.js");
/// What the view of particles is made of.
const STAGE: &str = include_str!("web/stage.html");
/// What a page has in addition during its run.
const LIVE: [&str; 2] = [include_str!("web/live.html"), include_str!("web/live.js")];
/// Over what curves are drawn.
const CHARTS: &str = "<div class=\"bar\"><label>over <select id=\"axis\"></select></label>\
     <span class=\"small\">Drag across a chart to look closer, click twice to go back.</span></div>\n<div id=\"charts\"></div>\n";

/// No script but those of the page itself, no style, nothing from elsewhere.
const POLICY: &str = "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; \
                    style-src 'unsafe-inline'; img-src data: blob:";
/// The page of a present run connects to the program that it comes from.
const CONNECTS_TO_PROGRAM: &str = "; connect-src 'self'";

/// So many messages a page shows.
const WARNINGS: usize = 200;
/// A longer text is folded.
const OPEN: usize = 12_000;
/// And of a very long one so much of either end is shown.
const HALF: usize = 200_000;

/// The page.
pub fn html(report: &Report) -> String {
    let curves = Curves::of(&report.tables);
    let film = packed(&report.film);
    let sections: Vec<(&str, &str, String)> = [
        ("scene", "Particles", scene(&film, report.live)),
        ("curves", "Step table", curves_section(report, &curves)),
        ("pictures", "Pictures", pictures(report)),
        ("time", "Where the time went", time(report)),
        ("said", "Warnings and notes", messages(report)),
        ("deck", report.deck.as_ref().map_or("", |deck| deck.what), deck(report)),
    ]
    .into_iter()
    .filter(|(.., text)| !text.is_empty())
    .collect();
    let mut body = head(report, &sections);
    body += "<main>\n";
    for (id, title, text) in &sections {
        let _ = write!(
            body,
            "<section id=\"{id}\" aria-labelledby=\"{id}-title\">\n<h2 id=\"{id}-title\">{title}</h2>\n{text}</section>\n"
        );
    }
    body += "</main>\n";
    let remarks = report.remarks.iter().cloned().chain(curves.thinned()).chain(film.thinned());
    let remarks: Vec<String> = remarks.map(|r| format!("<li>{}</li>\n", escaped(&r))).collect();
    if !remarks.is_empty() {
        let _ =
            write!(body, "<footer>\n<h2>About this page</h2>\n<ul>\n{}</ul>\n</footer>\n", remarks.concat());
    }
    let _ = writeln!(
        body,
        "<script type=\"application/json\" id=\"data\">{}</script>",
        data(&curves, &film, report.live)
    );
    for (k, frame) in film.frames.iter().enumerate() {
        let _ = writeln!(body, "<script type=\"application/octet-stream\" id=\"frame-{k}\">{frame}</script>");
    }
    for script in [UPLOT, CURVES, VIEW].into_iter().chain(report.live.then_some(LIVE[1])) {
        let _ = writeln!(body, "<script>{script}</script>");
    }
    let head = format!("{POLICY}{}\">\n", if report.live { CONNECTS_TO_PROGRAM } else { "" });
    page(&report.title, STYLE, &head, &body)
}

/// What scripts read; a `<` that could end it is none.
fn data(curves: &Curves, film: &Packed, live: bool) -> String {
    let kinds: Vec<String> = KEYWORDS.iter().filter(|k| k.extensive).map(|k| quoted(k.name)).collect();
    let film = if film.frames.is_empty() { "null" } else { &film.json };
    format!(
        "{{\"curves\":{},\"energies\":[{}],\"film\":{film},\"live\":{live}}}",
        curves.json(),
        kinds.join(",")
    )
    .replace('<', "\\u003c")
}

fn head(report: &Report, sections: &[(&str, &str, String)]) -> String {
    let mut out = format!("<header>\n<h1>{}</h1>\n", escaped(&report.title));
    let (class, verdict) = match &report.ended {
        Ended::Well => ("passed", "finished"),
        Ended::Interrupted => ("known", "interrupted at a whole step"),
        Ended::Failed(_) => ("failed", "ended with an error"),
        Ended::Unknown => ("", ""),
    };
    if !verdict.is_empty() {
        let _ = writeln!(out, "<p class=\"verdict {class}\">{verdict}</p>");
    }
    if !report.origin.is_empty() {
        let _ = writeln!(out, "<p class=\"small\">{}</p>", escaped(&report.origin));
    }
    if let Ended::Failed(why) = &report.ended {
        let _ = writeln!(out, "<pre class=\"why\" tabindex=\"0\">{}</pre>", escaped(why.trim_end()));
    }
    let tile = |(name, value): &(String, String)| {
        format!("<div><dt>{}</dt><dd>{}</dd></div>\n", escaped(name), escaped(value))
    };
    let tiles: Vec<String> = report.figures.iter().map(tile).collect();
    let _ = write!(out, "<dl class=\"tiles\">\n{}</dl>\n", tiles.concat());
    let facts: Vec<String> = report.facts.iter().map(tile).collect();
    if !facts.is_empty() {
        let _ = write!(out, "<dl class=\"facts\">\n{}</dl>\n", facts.concat());
    }
    let links: Vec<String> =
        sections.iter().map(|(id, title, _)| format!("<a href=\"#{id}\">{title}</a>")).collect();
    let _ = write!(out, "<nav aria-label=\"Parts of this page\">{}</nav>\n</header>\n", links.join("\n"));
    out
}

fn scene(film: &Packed, live: bool) -> String {
    match film.frames.is_empty() && !live {
        true => String::new(),
        false => [if live { LIVE[0] } else { "" }, STAGE].concat(),
    }
}

fn curves_section(report: &Report, curves: &Curves) -> String {
    if report.live {
        return CHARTS.into();
    }
    if curves.columns.is_empty() {
        return String::from("<p>There is no step table: nothing was run, or the log has none.</p>\n");
    }
    let mut out = String::from(CHARTS)
        + "<h3>Figures</h3>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Figures of the step table\">\n\
         <table>\n<thead><tr><th scope=\"col\">column</th><th scope=\"col\">first</th><th scope=\"col\">last</th>\
         <th scope=\"col\">least</th><th scope=\"col\">greatest</th><th scope=\"col\">what it is</th></tr></thead>\n<tbody>\n";
    curves.columns.iter().for_each(|c| out += &row(report, c));
    out + "</tbody>\n</table>\n</div>\n"
}

fn row(report: &Report, column: &Column) -> String {
    let what = report.columns.iter().find(|(name, _)| *name == column.name).map(|(_, what)| what.as_str());
    let header = || KEYWORDS.iter().find(|k| k.name == column.name).map(|k| k.header);
    let cells: Vec<String> =
        column.ends.iter().map(|v| format!("<td class=\"n\">{}</td>", short(*v))).collect();
    format!(
        "<tr><th scope=\"row\"><code>{}</code></th>{}<td>{}</td></tr>\n",
        escaped(&column.name),
        cells.concat(),
        escaped(what.or_else(header).unwrap_or_default())
    )
}

fn pictures(report: &Report) -> String {
    let gallery = &report.gallery;
    let mut out = String::new();
    if !gallery.pictures.is_empty() {
        let all: Vec<String> = gallery.pictures.iter().map(super::Picture::html).collect();
        let _ = write!(out, "<div class=\"gallery\">\n{}</div>\n", all.concat());
    }
    if !gallery.left_out.is_empty() {
        let left: Vec<String> =
            gallery.left_out.iter().map(|l| format!("<li>{}</li>\n", escaped(l))).collect();
        let _ =
            write!(out, "<p class=\"small\">Left out:</p>\n<ul class=\"small\">\n{}</ul>\n", left.concat());
    }
    out
}

fn time(report: &Report) -> String {
    let all: f64 = report.parts.iter().map(|p| p.time.as_secs_f64()).sum();
    let mut out = String::new();
    if all > 0.0 {
        let mut parts: Vec<&Part> =
            report.parts.iter().filter(|p| p.time.as_secs_f64() > 0.0005 * all).collect();
        parts.sort_by_key(|p| std::cmp::Reverse(p.time));
        out += "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Time by part\">\n<table class=\"parts\">\n\
                <thead><tr><th scope=\"col\">part</th><th scope=\"col\">stage</th><th scope=\"col\">calls</th>\
                <th scope=\"col\">time</th><th scope=\"col\" class=\"share\">share</th></tr></thead>\n<tbody>\n";
        parts.iter().for_each(|p| out += &part(p, all));
        out += "</tbody>\n</table>\n</div>\n";
    }
    if let Some(plan) = &report.plan {
        let _ = writeln!(
            out,
            "<details><summary>The plan of the last run</summary><pre tabindex=\"0\">{}</pre></details>",
            escaped(plan.trim_end())
        );
    }
    out
}

fn part(p: &Part, all: f64) -> String {
    let share = 100.0 * p.time.as_secs_f64() / all;
    format!(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{:.3} s</td>\
         <td class=\"n share\"><span style=\"width:{share:.1}%\"></span>{share:.1} %</td></tr>\n",
        escaped(&p.name),
        p.stage.name(),
        p.calls,
        p.time.as_secs_f64()
    )
}

fn messages(report: &Report) -> String {
    let mut out = String::new();
    for (weight, text) in report.messages.iter().take(WARNINGS) {
        let class = if *weight == Weight::Warning { "warning" } else { "note" };
        let _ = writeln!(out, "<pre class=\"{class}\" tabindex=\"0\">{}</pre>", escaped(text.trim_end()));
    }
    if report.messages.len() > WARNINGS {
        let _ = writeln!(
            out,
            "<p class=\"small\">{} more stand in the log.</p>",
            report.messages.len() - WARNINGS
        );
    }
    out
}

/// A text whose middle is left out where it is very long.
fn shortened(text: &str) -> Cow<'_, str> {
    if text.len() <= 2 * HALF {
        return text.into();
    }
    let (head, tail) = (text.floor_char_boundary(HALF), text.ceil_char_boundary(text.len() - HALF));
    format!("{}\n\n… {} bytes are left out here …\n\n{}", &text[..head], tail - head, &text[tail..]).into()
}

fn deck(report: &Report) -> String {
    report.deck.as_ref().map_or(String::new(), |deck| {
        format!(
            "<details{}><summary>{}</summary><pre tabindex=\"0\">{}</pre></details>\n",
            if deck.text.len() < OPEN { " open" } else { "" },
            escaped(&deck.name),
            escaped(&shortened(&deck.text))
        )
    })
}
