//! The manual as the program has it: a page per command and style from the tables they are registered in, the syntax lines to walk
//! along, and what may stand where. The prompt and the language server both draw on it.

pub mod completing;
pub mod howtos;
pub mod knowing;
mod pages;
pub mod syntax;
pub mod walk;

use crate::graph::catalogue::Tables;
use crate::graph::heads::FIX_MODIFY;
use perigrain_styles::words::{Form, Syntax};
use perigrain_styles::{Doc, Style};
use std::fmt::Write;
use std::sync::LazyLock;

/// One page: what it is about and where it belongs.
#[derive(Clone, Copy)]
pub struct Page {
    /// `topic`, `command`, or the command that takes the style: `pair_style`, `fix`, `compute`, `dump`.
    pub kind: &'static str,
    /// The word in the deck.
    pub name: &'static str,
    /// Its text.
    pub doc: Doc,
}

impl Page {
    /// Its name in requests and its heading: `fix nve`, `run`.
    pub fn title(&self) -> String {
        match self.kind {
            "topic" | "command" => self.name.to_string(),
            kind => format!("{kind} {}", self.name),
        }
    }

    /// The page's file below `docs/styles`.
    pub fn file(&self) -> String {
        format!("{}.md", self.title().replace([' ', '/'], "_"))
    }

    /// The forms of its lines, where their words are declared.
    fn forms(&self) -> Vec<Form> {
        match self.doc.syntax {
            Syntax::Behind(grammar) => vec![Form::behind(grammar)],
            Syntax::Forms(forms) => forms.to_vec(),
            Syntax::Written(_) => vec![],
        }
    }

    /// Its lines, where their words are declared.
    pub fn declared(&self) -> Vec<walk::Declared> {
        let head = match self.kind {
            "fix" | "compute" => format!("{} ID group {}", self.kind, self.name),
            "dump" => format!("dump ID group {} N", self.name),
            "command" => self.name.to_string(),
            kind => format!("{kind} {}", self.name),
        };
        self.forms().iter().map(|form| walk::Declared::new(form, &head)).collect()
    }

    /// Its syntax lines.
    pub fn syntax(&self) -> String {
        match self.doc.syntax {
            Syntax::Written(lines) => lines.to_string(),
            _ => self.declared().iter().map(walk::Declared::line).collect::<Vec<_>>().join("\n"),
        }
    }

    /// Its lines that are written by hand.
    pub fn written(&self) -> &'static str {
        match self.doc.syntax {
            Syntax::Written(lines) => lines,
            _ => "",
        }
    }

    /// The table of its declared words as Markdown, behind an empty line.
    pub fn table(&self) -> String {
        let table = Form::table(&self.forms());
        if table.is_empty() { table } else { format!("\n{table}") }
    }

    /// The page as Markdown.
    pub fn markdown(&self) -> String {
        let Doc { summary, text, example, .. } = self.doc;
        let mut page = format!("# {}\n\n{summary}\n\n```text\n{}\n```\n", self.title(), self.syntax());
        page.push_str(&self.table());
        if !text.is_empty() {
            let _ = write!(page, "\n{}\n", text.trim());
        }
        if !example.is_empty() {
            let _ = write!(page, "\n## Example\n\n```text\n{}\n```\n", example.trim());
        }
        page
    }
}

/// Every page, by kind and then in the order of the tables.
pub fn pages() -> Vec<Page> {
    all().to_vec()
}

/// The same, for readers that only borrow.
pub fn all() -> &'static [Page] {
    static ALL: LazyLock<Vec<Page>> = LazyLock::new(gathered);
    &ALL
}

fn gathered() -> Vec<Page> {
    fn of<S: Style + ?Sized>(kind: &'static str, table: &[&S]) -> Vec<Page> {
        table.iter().map(|s| Page { kind, name: s.name(), doc: s.doc() }).collect()
    }
    let tables = Tables::default();
    let own = |kind: &'static str, table: &[pages::Entry]| -> Vec<Page> {
        table.iter().map(|&(name, doc)| Page { kind, name, doc: with_options(name, doc, &tables) }).collect()
    };
    [
        own("topic", pages::TOPICS),
        of("command", &tables.commands),
        own("command", pages::COMMANDS),
        of("pair_style", &tables.pairs),
        of("bond_style", &tables.bonds),
        of("fix", &tables.fixes),
        of("compute", &tables.computes),
        of("dump", &tables.dumps),
    ]
    .concat()
}

/// The pages of `dump_modify`, `peri_modify` and `fix_modify` with all their lines: what all dumps, solids or fixes have, and what each style adds. Other
/// pages stay as they are.
fn with_options(name: &'static str, doc: Doc, tables: &Tables) -> Doc {
    match name {
        "dump_modify" => with_forms(name, perigrain_dumps::MODIFIED.to_vec(), &tables.dumps, doc),
        "peri_modify" => with_forms(name, vec![], &tables.pairs, doc),
        "fix_modify" => with_forms(name, vec![Form::headed(name, &FIX_MODIFY)], &tables.fixes, doc),
        _ => doc,
    }
}

/// The page of a command with its lines that stand on the pages of styles.
fn with_forms<S: Style + ?Sized>(name: &str, mut all: Vec<Form>, styles: &[&S], doc: Doc) -> Doc {
    for style in styles {
        let Syntax::Forms(forms) = style.doc().syntax else { continue };
        for form in forms.iter().filter(|form| form.head.split(' ').next() == Some(name)) {
            if !all.contains(form) {
                all.push(*form);
            }
        }
    }
    Doc { syntax: Syntax::Forms(all.leak()), ..doc }
}

/// What a kind of page is called in a list.
pub fn heading(kind: &str) -> &str {
    match kind {
        "topic" => "topics",
        "command" => "commands",
        _ => kind,
    }
}
