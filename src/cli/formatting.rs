//! The subcommand `fmt`: decks laid out anew, their words never.

use super::args::{Deck, Usage};
use super::{FAILED, OK, deck, show};
use perigrain_base::diag::{Code, Diagnostics, Result, Sources, fail};
use perigrain_lang::format::format;
use perigrain_output::file::{replace_durably, trouble};
use std::fmt::Write;
use std::io::Read;
use std::path::{Path, PathBuf};

/// What is laid out, and what becomes of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, clap::Args)]
pub struct Wanted {
    /// Write nothing, name the decks that are laid out otherwise, and fail if there are any
    #[arg(long)]
    check: bool,
    /// Write nothing, and print the lines that would change
    #[arg(long)]
    diff: bool,
    /// The decks; `-` is standard input, and then the text goes to standard output
    #[arg(value_name = "FILE", required = true, value_hint = clap::ValueHint::FilePath)]
    files: Vec<PathBuf>,
}

/// Formats each file by itself; the exit code shows whether one was refused or, with `--check`, would change.
pub fn perform(wanted: &Wanted) -> std::result::Result<u8, Usage> {
    if wanted.files.iter().filter(|path| is_input(path)).count() > 1 {
        return Err(Usage::new("`-` can be read once only"));
    }
    let mut code = OK;
    for path in &wanted.files {
        let mut sources = Sources::default();
        match one(path, wanted, &mut sources) {
            Ok(changes) if changes && wanted.check => code = FAILED,
            Ok(_) => {}
            Err(problems) => {
                deck::print(&problems, &sources);
                code = FAILED;
            }
        }
    }
    Ok(code)
}

fn is_input(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Whether the file's layout changes.
fn one(path: &Path, wanted: &Wanted, sources: &mut Sources) -> Result<bool> {
    let from = if is_input(path) { Deck::Stdin } else { Deck::File(path.into()) };
    let name = deck::name(&from);
    let old = read(path, &name)?;
    let file = sources.add(name.clone(), old.clone());
    let new = format(&old, file)?;
    let changes = new != old;
    if wanted.diff {
        show(&diff(&name, &old, &new));
    }
    match (wanted.check || wanted.diff, is_input(path)) {
        (true, _) if wanted.check && changes && !wanted.diff => show(&format!("{name}\n")),
        (true, _) => {}
        (false, true) => show(&new),
        (false, false) if changes => {
            write(path, &new)?;
            show(&format!("{name}: laid out anew\n"));
        }
        (false, false) => {}
    }
    Ok(changes)
}

fn read(path: &Path, name: &str) -> Result<String> {
    let mut bytes = vec![];
    let outcome = match is_input(path) {
        true => std::io::stdin().read_to_end(&mut bytes).map(drop),
        false => std::fs::read(path).map(|all| bytes = all),
    };
    outcome.map_err(|e| trouble("read the deck", Path::new(name), &e))?;
    // Unlike a deck that is run: what would be written back could be no more than a guess.
    String::from_utf8(bytes).or_else(|_| fail(Code::BAD_FILE, None, format!("`{name}` is no text in UTF-8")))
}

/// Puts the text into the file that a name leads to, and leaves its permissions.
fn write(path: &Path, text: &str) -> Result<()> {
    let failed = |e: std::io::Error| Diagnostics::from(trouble("write", path, &e));
    let target = path.canonicalize().map_err(failed)?;
    let permissions = std::fs::metadata(&target).map_err(failed)?.permissions();
    if permissions.readonly() {
        return Err(failed(std::io::ErrorKind::PermissionDenied.into()));
    }
    replace_durably(&target, |out| out.write_all(text.as_bytes()))?;
    std::fs::set_permissions(&target, permissions).map_err(failed)
}

/// The lines that change, each old one before its new one. Layout changes lines one for one; empty ones alone come and go.
fn diff(name: &str, old: &str, new: &str) -> String {
    let mut out = String::new();
    let mut new = new.split_inclusive('\n').peekable();
    let bare = |line: &str| line.split_whitespace().collect::<String>();
    for (k, line) in old.split_inclusive('\n').enumerate() {
        let becomes = new.next_if(|other| bare(other) == bare(line));
        if becomes == Some(line) {
            continue;
        }
        if out.is_empty() {
            let _ = writeln!(out, "--- {name}");
        }
        let _ = writeln!(out, "@@ {}", k + 1);
        for (sign, text) in [("-", Some(line)), ("+", becomes)] {
            let _ = text.map(|text| writeln!(out, "{sign}{}", text.trim_end_matches(['\n', '\r'])));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diff_has_each_line_that_changes() {
        let old = "units  lj\n\n\n\nrun 1\nrun 2 ";
        let new = format(old, perigrain_base::diag::FileId(0)).unwrap();
        let wanted = "--- a\n@@ 1\n-units  lj\n+units lj\n@@ 3\n-\n@@ 4\n-\n@@ 6\n-run 2 \n+run 2\n";
        assert_eq!(diff("a", old, &new), wanted);
        assert_eq!(diff("a", &new, &new), "");
    }
}
