//! The command line: parses the request, performs it, and returns an exit code.

pub mod args;
mod benching;
mod cases;
pub mod checking;
pub mod deck;
mod examples;
mod formatting;
pub mod grammar;
mod live;
pub mod manual;
mod pager;
pub mod partitions;
pub mod progress;
mod ranks;
pub mod repl;
mod reporting;
mod shells;
mod signals;
mod starters;
mod sweeping;
pub mod tasks;
mod translating;
pub mod verifying;
mod version;
mod viewing;

use crate::session::Mode;
use args::Usage;
use perigrain_base::diag::{CODES, Kind, nearest};
use std::process::ExitCode;
use tasks::Task;

/// Everything went well.
const OK: u8 = 0;
/// The deck was refused, or its run failed.
const FAILED: u8 = 1;
/// The command line itself is wrong.
const USAGE: u8 = 2;
/// Ended from outside (Ctrl-C) at a whole step.
const INTERRUPTED: u8 = 130;

/// Runs the program with the words of the command line.
pub fn main() -> ExitCode {
    signals::outlive_large_files();
    ExitCode::from(work())
}

/// The same for a program that hosts this one and has registered itself: the exit code.
pub fn work() -> u8 {
    let words =
        crate::sweep::starter::words().into_iter().map(|w| w.to_string_lossy().into_owned()).collect();
    match tasks::parse(words).and_then(perform) {
        Ok(code) => code,
        Err(usage) => {
            if ranks::speaks() {
                complain(&usage);
            }
            USAGE
        }
    }
}

fn perform(task: Task) -> Result<u8, Usage> {
    task.alone().map_or(Ok(()), ranks::refuse)?;
    match task {
        Task::Text(text) => pager::page(&text),
        Task::Explain(code) => pager::page(&explain(&code)?),
        Task::Examples(wanted) => examples::perform(&wanted)?,
        Task::New { file, kind } => starters::write(&file, kind)?,
        Task::Completions(shell) => shells::completions(shell),
        Task::Man(folder) => shells::man(folder.as_deref())?,
        Task::Doc(None) => pager::page(&manual::list()),
        Task::Help(None) => pager::page(&(tasks::help() + "\n" + &manual::list())),
        Task::Doc(Some(name)) | Task::Help(Some(name)) => pager::page(&manual::page(&name)?),
        Task::Run(o) => {
            return match &o.world {
                Some(world) => {
                    partitions::settle(world);
                    Ok(deck::execute(&partitions::own(&o, world), Mode::Run))
                }
                None if !o.partition.is_empty() => partitions::execute(&o),
                None => ranks::execute(&o, Mode::Run),
            };
        }
        Task::Ranks(o) => return ranks::show(&o),
        Task::Repl(o) => return Ok(repl::run(&o)),
        Task::Sweep(request) => return sweeping::perform(&request),
        Task::Bench(request) => return benching::perform(&request),
        Task::Scaling(wanted) => return benching::scaling::perform(&wanted),
        Task::Suite(wanted) => return benching::suite::perform(&wanted),
        Task::Worker => return Ok(if crate::sweep::worker::main() { OK } else { FAILED }),
        Task::Report(wanted) => return reporting::reading::report(&wanted),
        Task::Verify(wanted) => return verifying::verify(&wanted),
        Task::Lsp => return Ok(serve()),
        Task::Format(wanted) => return formatting::perform(&wanted),
        Task::Translate(wanted) => return translating::perform(&wanted),
        Task::Check { decks, json } => return Ok(checking::check(&decks, json)),
        Task::Plan { options, dot: true, .. } => return Ok(deck::draw(&options)),
        Task::Plan { options, measure: true, .. } => return ranks::execute(&options, Mode::Measure),
        Task::Plan { options, .. } if options.ranks.is_some() => {
            let usage = Usage::new("what ranks exchange follows from bodies, which are built in a run");
            return Err(usage.help("`perigrain plan --measure DECK -ranks N` runs the deck and prints it"));
        }
        Task::Plan { options, .. } => return Ok(deck::execute(&options, Mode::Plan)),
    }
    Ok(OK)
}

/// Answers an editor over the standard streams.
fn serve() -> u8 {
    // Decks are only read here: a thread of its own for each core would be idle.
    crate::session::set_threads(1);
    if crate::lsp::serve(std::io::stdin(), std::io::stdout()) { OK } else { FAILED }
}

/// Prints to standard output; a reader that closes early, as `| head`, is no failure.
fn show(text: &str) {
    use std::io::Write;
    let _ = std::io::stdout().write_all(text.as_bytes());
}

fn complain(usage: &Usage) {
    eprintln!("error: {}", usage.message);
    if let Some(help) = &usage.help {
        eprintln!("  = help: {help}");
    }
}

/// The explanation of one diagnostic code, or the list of all for `all`.
fn explain(word: &str) -> Result<String, Usage> {
    if word == "all" {
        return Ok(CODES.iter().map(explained).collect::<Vec<_>>().join("\n"));
    }
    let wanted = word.to_uppercase();
    if let Some(kind) = CODES.iter().find(|k| k.code.to_string() == wanted) {
        return Ok(explained(kind));
    }
    let known: Vec<String> = CODES.iter().map(|k| k.code.to_string()).collect();
    let help = match nearest(&wanted, known.iter().map(String::as_str)) {
        Some(code) => format!("did you mean {code}? `perigrain explain all` lists them"),
        None => "`perigrain explain all` lists them".into(),
    };
    Err(Usage { message: format!("no diagnostic has the code `{word}`"), help: Some(help) })
}

/// Code, title, paragraph, and the pair of lines.
fn explained(k: &Kind) -> String {
    let mut text = format!("{}: {}\n\n{}\n", k.code, k.title, k.text);
    for (what, lines) in [("wrong", k.wrong), ("right", k.right)] {
        for (n, line) in lines.lines().enumerate() {
            text += &format!(
                "{}    {:<7} {line}\n",
                if n == 0 { "\n" } else { "" },
                if n == 0 { what } else { "" }
            );
        }
    }
    text
}

/// The list of codes as a page of the manual.
pub fn errors_page() -> String {
    let mut text = String::from(
        "# Error codes\n\nEvery message carries a code for its kind of mistake; `perigrain explain PG0102` prints what stands \
         here. Errors refuse a line, warnings and notes let it pass. The lines are checked by the tests, in a small scene that \
         has a block of particles, a pair style and an integrator.\n",
    );
    for k in CODES {
        text += &format!("\n## {}: {}\n\n{}\n", k.code, k.title, k.text);
        for (what, lines) in
            [("Wrong", k.wrong), ("Right", k.right)].iter().filter(|(_, lines)| !lines.is_empty())
        {
            text += &format!("\n{what}:\n\n```perigrain\n{lines}\n```\n");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_explained_and_the_nearest_is_offered() {
        assert!(explain("pg0102").unwrap().starts_with("PG0102: unknown command\n\nThe first word"));
        assert!(explain("PG01O2").unwrap_err().help.unwrap().contains("PG0102"));
        assert_eq!(explain("all").unwrap().matches("\nPG0").count(), CODES.len() - 1);
        let text = explain("PG0110").unwrap();
        assert!(
            text.contains("\n    wrong   compute d all damage/atom\n            compute d all ke\n"),
            "{text}"
        );
    }
}
