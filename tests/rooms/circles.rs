//! Circles of files: what imports each other, directly or by way of others, can only be read as a whole.

use super::{root, rust_files};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;

/// Where circles are looked for: the sources of a crate, and the module below which files count (the crate itself if empty).
const LOOKED_AT: &[(&str, &str)] = &[("crates/peri/src", ""), ("src", "graph")];

/// The most files that may import each other in one circle.
const MOST: usize = 3;

/// A path of names; of a module that of its file.
type Names = Vec<String>;

/// The files of a crate by modules: their code, and what they re-export by name.
struct Sources {
    code: BTreeMap<Names, String>,
    exports: BTreeMap<(Names, String), Names>,
}

#[test]
fn no_circle_of_files_is_larger_than_three() {
    let mut wrong = String::new();
    for (folder, below) in LOOKED_AT {
        let sources = Sources::read(folder);
        let below: Names = names(below);
        let edges: BTreeMap<&Names, BTreeSet<Names>> =
            sources.code.keys().map(|module| (module, sources.imports(module))).collect();
        let reached: BTreeMap<&Names, BTreeSet<&Names>> =
            edges.keys().map(|module| (*module, reach(module, &edges))).collect();
        let mut seen = BTreeSet::new();
        for (module, others) in reached.iter().filter(|(module, _)| module.starts_with(&below)) {
            let circle: Vec<&Names> = others
                .iter()
                .copied()
                .filter(|other| reached[other].contains(module) && other.starts_with(&below))
                .collect();
            if circle.len() > 1 && seen.insert(circle.clone()) {
                let files: Vec<String> = circle.iter().map(|module| module.join("/")).collect();
                println!("{folder}: {}", files.join(", "));
                if circle.len() > MOST {
                    writeln!(wrong, "{folder}: {} files import each other:", circle.len()).unwrap();
                }
                for module in circle.iter().filter(|_| circle.len() > MOST) {
                    let inside = edges[module].iter().filter(|other| circle.contains(other));
                    let inside: Vec<String> = inside.map(|other| other.join("/")).collect();
                    writeln!(wrong, "    {} imports {}", module.join("/"), inside.join(", ")).unwrap();
                }
            }
        }
    }
    assert!(wrong.is_empty(), "circles of more than {MOST} files:\n{wrong}");
}

/// All modules that a module leads to, itself if there is a way back.
fn reach<'a>(module: &'a Names, edges: &'a BTreeMap<&Names, BTreeSet<Names>>) -> BTreeSet<&'a Names> {
    let (mut found, mut open) = (BTreeSet::new(), vec![module]);
    while let Some(module) = open.pop() {
        open.extend(edges[module].iter().filter(|other| found.insert(*other)));
    }
    found
}

impl Sources {
    fn read(folder: &str) -> Self {
        let (mut code, mut exports) = (BTreeMap::new(), BTreeMap::new());
        let sources = root().join(folder);
        for file in rust_files(folder) {
            let text = fs::read_to_string(&file).unwrap();
            let text = &text[..text.find("#[cfg(test)]\nmod ").unwrap_or(text.len())];
            let text: String = text.lines().map(|line| line.split("//").next().unwrap_or("")).fold(
                String::new(),
                |mut text, line| {
                    text += line;
                    text.push('\n');
                    text
                },
            );
            let place = file.strip_prefix(&sources).unwrap().with_extension("");
            let mut module: Names = place.iter().map(|name| name.to_string_lossy().into_owned()).collect();
            if module.last().is_some_and(|name| ["mod", "lib", "main"].contains(&&**name)) {
                module.pop();
            }
            for (path, public) in uses(&text) {
                if let (true, Some(name)) = (public, path.last()) {
                    exports.insert((module.clone(), name.clone()), path.clone());
                }
            }
            code.insert(module, text);
        }
        Self { code, exports }
    }

    /// The files that a file imports something of.
    fn imports(&self, module: &Names) -> BTreeSet<Names> {
        let text = &self.code[module];
        let private = uses(text).into_iter().filter(|(_, public)| !public).map(|(path, _)| path);
        let found = private.chain(paths(text)).filter_map(|path| self.file(module, &path, 0));
        let mut found: BTreeSet<Names> = found.collect();
        found.remove(module);
        found
    }

    /// The file in which what a module calls so is defined, re-exports followed.
    fn file(&self, module: &Names, path: &[String], depth: usize) -> Option<Names> {
        let full = self.absolute(module, path)?;
        let known = (0..=full.len()).rev().find(|end| self.code.contains_key(&full[..*end]))?;
        let (home, rest) = full.split_at(known);
        match rest.first().and_then(|name| self.exports.get(&(home.to_vec(), name.clone()))) {
            Some(export) if depth < 8 => {
                let export = [export, &rest[1..]].concat();
                self.file(&home.to_vec(), &export, depth + 1)
            }
            _ => Some(home.to_vec()),
        }
    }

    /// A path from the crate on; nothing of other crates.
    fn absolute(&self, module: &Names, path: &[String]) -> Option<Names> {
        let mut path = path;
        if path.first()? == "crate" {
            return Some(path[1..].to_vec());
        }
        let mut base = &module[..];
        while let Some((first, rest)) = path.split_first().filter(|(first, _)| *first == "super") {
            let _ = first;
            (base, path) = (base.split_last()?.1, rest);
        }
        if path.first().is_some_and(|first| first == "self") {
            path = &path[1..];
        }
        let full = [base, path].concat();
        let child = [module, &path[..path.len().min(1)]].concat();
        (base.len() < module.len() || self.code.contains_key(&child)).then_some(full)
    }
}

/// What `use` statements name, and whether they re-export it.
fn uses(text: &str) -> Vec<(Names, bool)> {
    let mut found = vec![];
    for (at, _) in text.match_indices("use ") {
        let before = text[..at].trim_end();
        let own_line = text[..at].ends_with(['\n', ' ', ')']) || at == 0;
        let Some((tree, _)) = text[at + 4..].split_once(';').filter(|_| own_line) else { continue };
        let public = before.ends_with("pub")
            || before.ends_with(')')
                && before.rfind("pub(").is_some_and(|pub_at| !before[pub_at..].contains(['\n', ';']));
        found.extend(expanded(tree).into_iter().map(|path| (names(&path), public)));
    }
    found
}

/// The paths of a tree such as `a::{b, c::{d, e}}`.
fn expanded(tree: &str) -> Vec<String> {
    let Some((root, rest)) = tree.split_once('{') else {
        return vec![tree.split(" as ").next().unwrap_or(tree).trim().to_string()];
    };
    let inside = rest.trim_end().strip_suffix('}').unwrap_or(rest);
    let (mut depth, mut part, mut parts) = (0, String::new(), vec![]);
    for c in inside.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if c == ',' && depth == 0 {
            parts.push(std::mem::take(&mut part));
        } else {
            part.push(c);
        }
    }
    parts.push(part);
    let all = parts.iter().filter(|part| !part.trim().is_empty()).flat_map(|part| expanded(part));
    all.map(|part| format!("{}{part}", root.trim())).collect()
}

/// Paths in code that begin with `crate` or `super`; not those of visibilities.
fn paths(text: &str) -> impl Iterator<Item = Names> + '_ {
    let starts = ["crate::", "super::"].into_iter().flat_map(|start| text.match_indices(start));
    starts.filter_map(|(at, _)| {
        let before = &text[..at];
        if before.ends_with("in ") || before.ends_with("use ") || before.ends_with([':', '$', '_']) {
            return None;
        }
        let end = text[at..].find(|c: char| !c.is_alphanumeric() && c != '_' && c != ':');
        Some(names(&text[at..at + end.unwrap_or(text.len() - at)]))
    })
}

/// The names of a path.
fn names(path: &str) -> Names {
    path.split("::").map(str::trim).filter(|name| !name.is_empty()).map(String::from).collect()
}

#[test]
fn paths_lead_to_files() {
    assert_eq!(expanded("a::{b, c::{d, e as f}}"), ["a::b", "a::c::d", "a::c::e"]);
    let text = "use crate::a::B;\npub use c::{D, E};\npub(crate) use f::G;\nfn h(_: super::i::J) {}\n";
    let public: Vec<bool> = uses(text).into_iter().map(|(_, public)| public).collect();
    assert_eq!(public, [false, true, true, true]);
    assert_eq!(paths(text).collect::<Vec<_>>(), [["super", "i", "J"]]);
    let code = [("", ""), ("a", "pub use b::B;\n"), ("a::b", ""), ("c", "use crate::a::B;\nuse super::a;\n")];
    let code: BTreeMap<Names, String> = code.map(|(module, text)| (names(module), text.to_string())).into();
    let exports = [((names("a"), "B".to_string()), names("b::B"))].into();
    let sources = Sources { code, exports };
    assert_eq!(sources.imports(&names("c")), [names("a"), names("a::b")].into());
}
