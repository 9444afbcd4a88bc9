//! The frame of the program's web pages: one file that needs nothing else, light or dark as the reader has it.

use super::escaped;

/// What all pages have in common.
const STYLE: &str = include_str!("web.css");

/// A whole page: its title, rules of its own beside the common ones, what stands in its head besides, and its body, which is HTML.
pub fn page(title: &str, style: &str, head: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n{head}<title>{}</title>\n\
         <style>{STYLE}{style}</style>\n</head>\n<body>\n{body}</body>\n</html>\n",
        escaped(title)
    )
}
