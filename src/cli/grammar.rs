//! Grammars for editors, TextMate's and Vim's, written from the tables of commands and styles.

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

/// The syntax file for Vim and Neovim.
pub fn vim() -> String {
    let mut all = pages();
    all.sort_by_key(|p| (p.kind, p.name));
    let mut out = String::from(VIM_HEAD);
    for page in all.iter().filter(|p| p.kind == "command") {
        let group = if Script::FLOW.contains(&page.name) { "Flow" } else { "Command" };
        let _ = writeln!(out, "syntax match perigrain{group} /\\v^\\s*\\zs{}\\S@!/", page.name);
    }
    // The style of a line stands behind its command, or behind an ID and a group.
    for (kind, words) in [("pair_style", 0), ("bond_style", 0), ("fix", 2), ("compute", 2), ("dump", 2)] {
        let word = |k: usize| format!("perigrain_{kind}_{k}");
        let next = |k: usize| if k < words { word(k + 1) } else { format!("perigrain_{kind}_style") };
        let _ = writeln!(
            out,
            "syntax match perigrainCommand /\\v^\\s*\\zs{kind}\\S@!/ nextgroup={} skipwhite",
            next(0)
        );
        for k in 1..=words {
            let _ =
                writeln!(out, "syntax match {} /\\S\\+/ contained nextgroup={} skipwhite", word(k), next(k));
        }
        for page in all.iter().filter(|p| p.kind == kind) {
            let name = page.name.replace('/', "\\/");
            let _ = writeln!(out, "syntax match perigrain_{kind}_style /\\v{name}\\S@!/ contained");
        }
        let _ = writeln!(out, "highlight default link perigrain_{kind}_style Type");
    }
    out + VIM_LINKS
}

const VIM_HEAD: &str = r#"" Colours of decks. Written from the program's tables: PERIGRAIN_BLESS=1 cargo test --test folders docs::
if exists('b:current_syntax')
  finish
endif
syntax case match
syntax match perigrainNumber /\v[[:alnum:]_.]@<![-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?[[:alnum:]_.]@!/
syntax match perigrainConstant /\v\S@<!(INF|EDGE|NULL|SELF|yes|no|on|off)\S@!/
syntax match perigrainReference /\v[[:alnum:]_.]@<![vcfCF]_\w+/
syntax match perigrainValue /\v\$\{[^}]*\}|\$\w|\$\([^)]*\)/
syntax match perigrainContinuation /&\s*$/
syntax match perigrainComment /#.*$/ contains=@Spell
syntax region perigrainString start=/"/ end=/"/ oneline contains=perigrainValue
syntax region perigrainString start=/'/ end=/'/ oneline contains=perigrainValue
syntax region perigrainString start=/"""/ end=/"""/ contains=perigrainValue
"#;

const VIM_LINKS: &str = r"highlight default link perigrainCommand Function
highlight default link perigrainFlow Keyword
highlight default link perigrainNumber Number
highlight default link perigrainConstant Constant
highlight default link perigrainReference Identifier
highlight default link perigrainValue Identifier
highlight default link perigrainContinuation Special
highlight default link perigrainComment Comment
highlight default link perigrainString String
let b:current_syntax = 'perigrain'
";
