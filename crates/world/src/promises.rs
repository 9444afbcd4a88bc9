//! Files that a checked deck would have written: a check writes nothing.

use super::{DeclaredLine, World};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a checked deck would have written into a file.
#[derive(Clone, Debug)]
pub enum Promise {
    /// This text.
    Text(String),
    /// This scene, which holds no particles, and the lines of its pair style.
    Scene(Arc<World>, Vec<DeclaredLine>),
    /// Known only in a run.
    Unseen,
}

/// All that the lines so far would have written, by name; empty unless a deck is only looked at. A copy is cheap.
#[derive(Clone, Debug, Default)]
pub struct Promises {
    files: Arc<BTreeMap<String, Promise>>,
    /// Files are promised instead of written: a deck is looked at, which leaves nothing behind and overwrites nothing.
    pub instead: bool,
    /// A shell command was passed over, which may have written any file that is not there.
    pub anything: bool,
}

/// A name without the `./` before it.
fn bare(name: &str) -> &str {
    name.strip_prefix("./").map_or(name, |rest| bare(rest.trim_start_matches('/')))
}

impl Promises {
    /// Takes note of a file that would be there now.
    pub fn keep(&mut self, name: &str, content: Promise) {
        Arc::make_mut(&mut self.files).insert(bare(name).to_owned(), content);
    }

    /// Takes note of a text that a line would have printed, behind what is there already or in its place.
    pub fn print(&mut self, name: &str, text: Option<String>, append: bool) {
        let before = Arc::make_mut(&mut self.files).remove(bare(name)).filter(|_| append);
        let content = match (text, before) {
            (Some(text), None) => Promise::Text(format!("{text}\n")),
            (Some(text), Some(Promise::Text(before))) => Promise::Text(format!("{before}{text}\n")),
            _ => Promise::Unseen,
        };
        self.keep(name, content);
    }

    /// The file of this name that the deck would have written; one written as `plate.*.data` may be any step's.
    pub fn get(&self, name: &str) -> Option<&Promise> {
        let name = bare(name);
        let fits = |file: &str| {
            file.split_once('*').is_some_and(|(a, b)| {
                name.len() > a.len() + b.len() && name.starts_with(a) && name.ends_with(b)
            })
        };
        self.files.get(name).or_else(|| self.files.iter().find(|(file, _)| fits(file)).map(|p| p.1))
    }

    /// Whether a file that is not there may be there in a run.
    pub fn may_come(&self, name: &str) -> bool {
        self.anything || self.get(name).is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_with_stars_and_dots() {
        let mut p = Promises::default();
        p.keep("./plate.*.data", Promise::Unseen);
        p.keep("a", Promise::Unseen);
        for there in ["plate.100.data", ".//plate.0.data", "./a", "a"] {
            assert!(p.may_come(there), "{there}");
        }
        for missing in ["plate..data", "plate.1.dat", "b", "../a"] {
            assert!(!p.may_come(missing), "{missing}");
        }
        p.anything = true;
        assert!(p.may_come("b") && p.get("b").is_none());
    }

    #[test]
    fn printed_lines_add_up_as_long_as_all_are_known() {
        let mut p = Promises::default();
        let text = |p: &Promises| match p.get("f") {
            Some(Promise::Text(text)) => Some(text.clone()),
            _ => None,
        };
        p.print("f", Some("one".into()), true);
        p.print("f", Some("two".into()), true);
        assert_eq!(text(&p).as_deref(), Some("one\ntwo\n"));
        p.print("f", None, true);
        p.print("f", Some("three".into()), true);
        assert_eq!(text(&p), None);
        p.print("f", Some("four".into()), false);
        assert_eq!(text(&p).as_deref(), Some("four\n"));
    }
}
