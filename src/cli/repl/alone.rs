//! Lines of a session as a deck that stands alone: what was included is put in place of the line, and files are named from where the
//! deck lies.

use perigrain_base::diag::{FileId, Sources};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Commands that steer within their own file: a file that has them stays one by itself.
const STEERS: [&str; 5] = ["jump", "label", "include", "next", "quit"];

/// Where a session's files are looked for, and where its deck will lie.
pub struct Alone<'a> {
    sources: &'a Sources,
    /// The folder that the session names files in, beside the working folder.
    from: &'a Path,
    /// The folder of the deck.
    to: PathBuf,
}

impl<'a> Alone<'a> {
    /// For a session with these texts and folder, to be saved in `file`.
    pub fn new(sources: &'a Sources, from: &'a Path, file: &Path) -> Self {
        Self { sources, from, to: file.parent().map(Path::to_path_buf).unwrap_or_default() }
    }

    /// The line, or what it includes, so that it means the same in the deck.
    pub fn line(&self, line: &str) -> String {
        match self.included(line) {
            Some((name, text)) => {
                let mut out = format!("# from {name}:\n");
                for line in text.lines() {
                    let _ = writeln!(out, "{}", self.with_files(line));
                }
                out + &format!("# (end of {name})")
            }
            None => self.with_files(line),
        }
    }

    /// The file that a line includes, as the session has read it, if it can stand in place of the line.
    fn included(&self, line: &str) -> Option<(&str, &str)> {
        let words: Vec<&str> = line.split('#').next()?.split_whitespace().collect();
        let ["include", file] = words[..] else { return None };
        let file = file.trim_matches(['"', '\'']);
        let source = (0..).map_while(|k| self.sources.get(FileId(k))).filter(|s| s.name == file).last()?;
        let steers =
            |line: &str| line.split(|c: char| !c.is_ascii_alphanumeric()).any(|w| STEERS.contains(&w));
        let code = |line: &str| line.split('#').next().unwrap_or_default().to_string();
        (!source.text.lines().any(|line| steers(&code(line)))).then_some((&source.name, &source.text))
    }

    /// The line with its files named from the deck's folder, where they would not be found by the names that it has.
    fn with_files(&self, line: &str) -> String {
        let mut out = String::with_capacity(line.len());
        let mut rest = line;
        while let Some(at) = rest.find(|c: char| !(c.is_whitespace() || c == '"' || c == '\'')) {
            out += &rest[..at];
            rest = &rest[at..];
            let end = rest.find(|c: char| c.is_whitespace() || c == '"' || c == '\'').unwrap_or(rest.len());
            let word = &rest[..end];
            match self.moved(word) {
                Some(path) => out += &path,
                None => out += word,
            }
            rest = &rest[end..];
        }
        out + rest
    }

    /// The name of the file `word` as the deck has to have it; nothing where the word is no file, or found by its name.
    fn moved(&self, word: &str) -> Option<String> {
        let plain = Path::new(word);
        if word.starts_with('#') || plain.is_absolute() || plain.is_file() {
            return None;
        }
        let path = self.from.join(word);
        if !path.is_file() || self.to.join(word).is_file() {
            return None;
        }
        let path = match self.to.as_os_str().is_empty() {
            true => path,
            false => std::path::absolute(&path).ok()?,
        };
        let path = path.to_str()?;
        Some(if path.contains(char::is_whitespace) { format!("\"{path}\"") } else { path.into() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn included_lines_and_files_go_along() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("own.toml"), "").unwrap();
        let own = folder.path().join("own.toml").display().to_string();
        let mut sources = Sources::default();
        sources.add("decks/in.first", "units si\nmaterial m file own.toml # own\n");
        sources.add("in.loop", "label a # none\nnext k\njump SELF a\n");
        let alone = Alone::new(&sources, folder.path(), Path::new("s.in"));
        let wanted = format!(
            "# from decks/in.first:\nunits si\nmaterial m file {own} # own\n# (end of decks/in.first)"
        );
        assert_eq!(alone.line("include \"decks/in.first\""), wanted);
        assert_eq!(alone.line("include in.loop"), "include in.loop");
        assert_eq!(alone.line("material  m file 'own.toml'"), format!("material  m file '{own}'"));
        assert_eq!(alone.line("run 10"), "run 10");
    }
}
