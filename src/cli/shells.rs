//! Interfaces of the command line for other programs: completions for shells and pages for `man`.

use super::args::{SWITCHES, Usage};
use super::{show, tasks};
use clap::{Arg, ArgAction, Command, ValueHint};
use clap_complete::{Shell, generate};
use std::path::Path;

/// Prints the completions of a shell.
pub fn completions(shell: Shell) {
    let mut text = vec![];
    generate(shell, &mut whole(), "perigrain", &mut text);
    show(&String::from_utf8_lossy(&text));
}

/// Writes a page for `man` of the program and of each subcommand into a folder, or prints that of the program.
///
/// # Errors
/// A folder that cannot be written.
pub fn man(folder: Option<&Path>) -> Result<(), Usage> {
    let command = whole();
    let Some(folder) = folder else {
        let mut text = vec![];
        clap_mangen::Man::new(command).render(&mut text).map_err(|e| Usage::new(e.to_string()))?;
        show(&String::from_utf8_lossy(&text));
        return Ok(());
    };
    let trouble = |e: std::io::Error| Usage::new(format!("cannot write into `{}`: {e}", folder.display()));
    std::fs::create_dir_all(folder).map_err(trouble)?;
    clap_mangen::generate_to(command, folder).map_err(trouble)
}

/// The whole command line: subcommands, the deck, and LAMMPS' switches, which have one dash or two.
fn whole() -> Command {
    let deck = Arg::new("DECK").value_hint(ValueHint::FilePath).help("The deck (standard input)");
    let about = "LAMMPS-style decks for fracture, erosion, grains and agglomerates";
    SWITCHES.iter().filter(|switch| !switch.about.is_empty()).fold(
        tasks::command().about(about).disable_help_flag(true).arg(deck),
        |command, switch| {
            let name = switch.names[0].trim_start_matches('-');
            let arg = Arg::new(name).long(name).help(switch.about);
            command.arg(match switch.values {
                "" => arg.action(ArgAction::SetTrue),
                values => arg.value_name(values).value_hint(hint(values)),
            })
        },
    )
}

/// What a shell offers behind a switch.
fn hint(values: &str) -> ValueHint {
    if values.starts_with("FILE") { ValueHint::FilePath } else { ValueHint::Other }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn completions_and_pages_know_subcommands_and_switches() {
        whole().debug_assert();
        for shell in [Shell::Bash, Shell::Zsh, Shell::Fish] {
            let mut text = vec![];
            generate(shell, &mut whole(), "perigrain", &mut text);
            let text = String::from_utf8_lossy(&text);
            for word in ["sweep", "examples", "threads", "compat"] {
                assert!(text.contains(word), "{shell}: {word}");
            }
        }
        let folder = tempfile::tempdir().unwrap();
        man(Some(folder.path())).unwrap();
        let page = std::fs::read_to_string(folder.path().join("perigrain.1")).unwrap();
        assert!(page.contains("threads") && page.starts_with(".ie"), "{}", &page[..200]);
        assert!(folder.path().join("perigrain-sweep.1").is_file());
    }
}
