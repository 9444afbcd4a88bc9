//! A TextMate grammar for editors, written from the tables of commands and styles.

use super::manual::{Page, pages};
use perigrain_lang::Script;
use std::fmt::Write;

/// The grammar as JSON, as VS Code and others read it.
pub fn textmate() -> String {
    let mut all = pages();
    all.sort_by_key(|p| (p.kind, p.name));
    let mut patterns = vec![
        rule("comment.line.number-sign.perigrain", "#.*$"),
        text("string.quoted.triple.perigrain", "\\\"\\\"\\\""),
        text("string.quoted.double.perigrain", "\\\""),
        text("string.quoted.single.perigrain", "'"),
        "{ \"include\": \"#value\" }".to_string(),
        rule("punctuation.separator.continuation.perigrain", "&\\\\s*$"),
    ];
    // One pattern per style and command: a line each, so that two new styles do not meet in one.
    patterns.extend(all.iter().filter_map(style));
    patterns.extend(all.iter().filter(|p| p.kind == "command").map(|p| {
        let flow = Script::FLOW.contains(&p.name);
        let class = if flow { "keyword.control.perigrain" } else { "support.function.perigrain" };
        rule(class, &format!("^\\\\s*{}(?!\\\\S)", p.name))
    }));
    patterns.push(rule(
        "constant.numeric.perigrain",
        "(?<![\\\\w.])[-+]?(\\\\d+\\\\.?\\\\d*|\\\\.\\\\d+)([eE][-+]?\\\\d+)?(?![\\\\w.])",
    ));
    patterns
        .push(rule("constant.language.perigrain", "(?<!\\\\S)(INF|EDGE|NULL|SELF|yes|no|on|off)(?!\\\\S)"));
    let mut out = String::from("{\n  \"name\": \"perigrain\",\n  \"scopeName\": \"source.perigrain\",\n");
    out += "  \"comment\": \"Written from the program's tables: PERIGRAIN_BLESS=1 cargo test --test folders docs::\",\n";
    out += "  \"fileTypes\": [\"perigrain\", \"lmp\", \"lammps\"],\n";
    let _ = write!(out, "  \"patterns\": [\n    {}\n  ],\n", patterns.join(",\n    "));
    let values = [
        rule("variable.other.perigrain", "\\\\$\\\\{[^}]*\\\\}|\\\\$\\\\w"),
        "{ \"name\": \"meta.embedded.perigrain\", \"begin\": \"\\\\$\\\\(\", \"end\": \"\\\\)\" }"
            .to_string(),
        rule("variable.other.perigrain", "(?<![\\\\w.])[vcfCF]_\\\\w+(\\\\[[^\\\\]]*\\\\])*"),
    ];
    let _ = write!(
        out,
        "  \"repository\": {{\n    \"value\": {{\n      \"patterns\": [\n        {}\n      ]\n    }}\n  }}\n}}\n",
        values.join(",\n        ")
    );
    out
}

fn rule(name: &str, pattern: &str) -> String {
    format!("{{ \"name\": \"{name}\", \"match\": \"{pattern}\" }}")
}

/// A text between two marks, with values put in.
fn text(name: &str, mark: &str) -> String {
    format!(
        "{{ \"name\": \"{name}\", \"begin\": \"{mark}\", \"end\": \"{mark}\", \"patterns\": [{{ \"include\": \"#value\" }}] }}"
    )
}

/// A command with the style that follows it, perhaps behind an ID and a group.
fn style(page: &Page) -> Option<String> {
    let between = match page.kind {
        "pair_style" => "\\\\s+",
        "fix" | "compute" | "dump" => "\\\\s+\\\\S+\\\\s+\\\\S+\\\\s+",
        _ => return None,
    };
    Some(format!(
        "{{ \"match\": \"^\\\\s*({}){between}({})(?!\\\\S)\", \"captures\": {{ \"1\": {{ \"name\": \
         \"support.function.perigrain\" }}, \"2\": {{ \"name\": \"entity.name.type.perigrain\" }} }} }}",
        page.kind, page.name
    ))
}
