//! The answers: each from a file, a place in it and what the server knows.

pub mod completion;
pub mod finding;
pub mod fixes;
pub mod hover;
pub mod outline;

use crate::manual::Page;

/// A page as editors show it beside the cursor: syntax first.
pub fn page_markdown(page: &Page) -> String {
    let doc = page.doc;
    let mut text = format!("```perigrain\n{}\n```\n\n{}\n{}", page.syntax(), doc.summary, page.table());
    if !doc.text.is_empty() {
        text += &format!("\n{}\n", doc.text.trim());
    }
    if !doc.example.is_empty() {
        text += &format!("\n```perigrain\n{}\n```\n", doc.example.trim());
    }
    text
}
