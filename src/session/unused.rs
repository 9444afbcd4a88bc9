//! Variables and groups that a deck defines and never uses, found in its text.

use perigrain_base::diag::{Code, Diagnostic, Diagnostics, FileId, Sources, Span, nearest};
use std::collections::{BTreeMap, BTreeSet};

/// A word of letters, digits and underscores.
struct Token<'a> {
    text: &'a str,
    at: usize,
    /// It stands at the beginning of a line or of a quoted text.
    opens: bool,
    /// `$` follows at once: only a part of a name.
    part: bool,
}

/// A warning for each name that all texts together only define. `given` are variables from the command line.
pub(super) fn unused(sources: &Sources, given: &[String]) -> Diagnostics {
    let mut defined: BTreeMap<(&str, &str), Span> = BTreeMap::new();
    let (mut used, mut parts) = (BTreeSet::new(), vec![]);
    for (file, text) in (0..).map_while(|k| Some((FileId(k), sources.get(FileId(k))?.text.as_str()))) {
        let mut kind = None;
        // The token before named what its line defines, and where.
        let (mut fresh, mut last) = (false, 0);
        for t in tokens(text) {
            let defines = kind.take();
            if std::mem::take(&mut fresh) && matches!(t.text, "delete" | "surface") {
                // `variable x delete` defines nothing, and `group s surface` acts by being there.
                defined.retain(|_, span: &mut Span| span.file != file || span.start as usize != last);
            }
            if t.opens && (t.text == "variable" || t.text == "group") {
                kind = Some(t.text);
            } else if let Some(kind) = defines.filter(|_| !t.part) {
                defined.entry((kind, t.text)).or_insert(Span::new(file, t.at, t.at + t.text.len()));
                (fresh, last) = (true, t.at);
            } else if t.part {
                parts.push(t.text);
            } else {
                used.insert(t.text);
            }
        }
    }
    let is_used = |name: &str| {
        let referred = |u: &&str| u.strip_prefix("v_").is_some_and(|u| u == name);
        used.contains(name) || used.iter().any(referred)
    };
    let mut found = Diagnostics::default();
    for (&(kind, name), &span) in &defined {
        let built = parts.iter().any(|p| name.starts_with(p.strip_prefix("v_").unwrap_or(p)));
        if is_used(name) || built || given.iter().any(|g| g == name) || name == "all" {
            continue;
        }
        let d = Diagnostic::warning(Code::UNUSED, span, format!("{kind} `{name}` is never used"));
        // Something that is used and never defined is probably what was meant.
        let undefined =
            used.iter().filter_map(|u| u.strip_prefix("v_")).filter(|u| !defined.contains_key(&(kind, u)));
        found.push(match nearest(name, undefined) {
            Some(near) if kind == "variable" => {
                d.help(format!("the deck uses `{near}`, which it does not define"))
            }
            _ => d.help("leave the line out, or use the name where it was meant"),
        });
    }
    found.0.sort_by_key(|d| d.span.map(|s| (s.file, s.start)));
    found
}

/// Whether the texts use a variable, as `$v`, `${v}`, `v_v`, or perhaps by a name that is put together.
pub(super) fn uses(sources: &Sources, name: &str) -> bool {
    sources.texts().any(|text| {
        let (mut defines, mut lists) = (false, false);
        tokens(text).iter().any(|t| {
            // A `sweep` line names variables, and uses none.
            lists = if t.opens { t.text == "sweep" } else { lists };
            let defined = std::mem::replace(&mut defines, t.opens && t.text == "variable");
            let bare = t.text.strip_prefix("v_").unwrap_or(t.text);
            // `$vm` is the value of `v` and an m.
            let single = name.len() == 1 && text[..t.at].ends_with('$') && t.text.starts_with(name);
            !defined
                && !lists
                && (single || bare == name || t.text == name || (t.part && name.starts_with(bare)))
        })
    })
}

/// The words of a deck outside comments.
fn tokens(text: &str) -> Vec<Token<'_>> {
    let bytes = text.as_bytes();
    let mut out = vec![];
    let (mut k, mut opens, mut quote) = (0, true, None);
    while k < bytes.len() {
        let c = bytes[k];
        if c.is_ascii_alphanumeric() || c == b'_' {
            let end = k + bytes[k..].iter().take_while(|b| b.is_ascii_alphanumeric() || **b == b'_').count();
            // `${name}`: the braces are no part of it; `name$x` and `name${x}` continue.
            out.push(Token { text: &text[k..end], at: k, opens, part: bytes.get(end) == Some(&b'$') });
            (k, opens) = (end, false);
            continue;
        }
        match c {
            b'#' if quote.is_none() => k += bytes[k..].iter().take_while(|b| **b != b'\n').count(),
            b'"' | b'\'' => {
                if quote == Some(c) {
                    quote = None;
                } else if quote.is_none() {
                    quote = Some(c);
                }
                opens = true;
                k += 1;
            }
            b'\n' => {
                // A quote that is still open there is a mistake of its own.
                quote = None;
                opens = !text[..k].trim_end().ends_with('&');
                k += 1;
            }
            _ => {
                opens &= c.is_ascii_whitespace();
                k += 1;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(deck: &str, wanted: &[&str]) {
        let mut sources = Sources::default();
        sources.add("in.deck", deck);
        let found = unused(&sources, &["given".into()]);
        let found: Vec<String> =
            found.0.iter().map(|d| format!("{} {}", d.span.unwrap().start, d.message)).collect();
        assert_eq!(found, wanted, "{deck}");
    }

    #[test]
    fn names_that_are_only_defined() {
        check("variable a equal 1\nprint a # ${b}\nvariable b equal 2\n", &["43 variable `b` is never used"]);
        check("group g type 1\ngroup g region r\n", &["6 group `g` is never used"]);
        check("group s surface all\n", &[]);
        check("variable given index 1\n", &[]);
        check("variable gone delete\n", &[]);
    }

    #[test]
    fn every_way_to_use_a_name() {
        for usage in [
            "print \"${long}\"",
            "fix 1 all move v_long",
            "variable b equal v_long\nprint $b",
            "next long",
            "print ${x}long",
        ] {
            check(&format!("variable long equal 1\n{usage}\n"), &[]);
        }
        check("variable x equal 1\nprint $x", &[]);
        check("group g type 1\nfix 1 g nve", &[]);
        check("group g1 type 1\nfix 1 g$n nve", &[]);
        check("if \"1 > 0\" then \"variable k equal 1\"\nprint $k", &[]);
        check("group g union a b\nset group g density 1", &[]);
    }

    #[test]
    fn uses_of_a_given_variable_are_found() {
        for (deck, name, wanted) in [
            ("variable v index 1\nprint \"$v\"", "v", true),
            ("velocity all set $vm 0 0", "v", true),
            ("fix 1 all move v_speed", "speed", true),
            ("print ${v$k}", "v12", true),
            ("next seed", "seed", true),
            ("variable v index 1\nprint w # $v", "v", false),
            ("print ${speed}", "v", false),
            ("sweep each v 1 2", "v", false),
            ("sweep each v 1 2\nprint $v", "v", true),
        ] {
            let mut sources = Sources::default();
            sources.add("in.deck", deck);
            assert_eq!(uses(&sources, name), wanted, "{deck}");
        }
    }

    #[test]
    fn a_misspelt_use_is_named() {
        let mut sources = Sources::default();
        sources.add("in.deck", "variable depth equal 1\nfix 1 all setforce v_dept 0 0\n");
        assert!(unused(&sources, &[]).0[0].help[0].contains("`dept`"));
    }
}
