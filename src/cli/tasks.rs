//! The tasks of the program: a subcommand, or a deck as on LAMMPS' command line.

use super::args::{self, Deck, Options, SWITCHES, Usage};
use super::sweeping::args::Request;
use super::{benching, checking, examples, formatting, reporting, starters, translating, verifying};
use clap::{CommandFactory, Parser, ValueHint};
use clap_complete::Shell;
use perigrain_base::diag::nearest;
use std::path::{Path, PathBuf};

/// One call of the program.
#[derive(Clone, Debug, PartialEq)]
pub enum Task {
    /// Run a deck.
    Run(Options),
    /// Show how ranks are connected.
    Ranks(Options),
    /// Execute lines as they are typed.
    Repl(Options),
    /// Report every problem of decks without acting.
    Check {
        /// The decks, each with the switches.
        decks: Vec<Options>,
        /// For editors.
        json: bool,
    },
    /// Lay decks out anew.
    Format(formatting::Wanted),
    /// Rewrite a deck of LIGGGHTS.
    Translate(translating::Wanted),
    /// Answer an editor.
    Lsp,
    /// Print a deck's step plan.
    Plan {
        /// The deck and its switches.
        options: Options,
        /// Run it and add time and bytes per op.
        measure: bool,
        /// Print the command graph for `dot` instead.
        dot: bool,
    },
    /// Make many runs of a deck.
    Sweep(Box<Request>),
    /// Run a deck over knobs, and weigh wall time against error.
    Bench(Box<benching::args::Request>),
    /// Run the benches that the program carries.
    Suite(benching::suite::Wanted),
    /// Measure what a step takes here, and forecast it on many machines.
    Scaling(benching::scaling::Wanted),
    /// Make one of the runs of a sweep or bench, described on standard input.
    Worker,
    /// Run the published cases that the program carries.
    Verify(verifying::Wanted),
    /// List, show or copy the examples that the program carries.
    Examples(examples::Wanted),
    /// Write a small deck to begin with.
    New {
        /// The file.
        file: PathBuf,
        /// What it computes.
        kind: starters::Kind,
    },
    /// Write a page about a run that is over.
    Report(reporting::reading::Wanted),
    /// Print what a shell needs to complete command lines.
    Completions(Shell),
    /// Write the pages for `man` into a folder, or print the program's.
    Man(Option<PathBuf>),
    /// Explain a diagnostic code.
    Explain(String),
    /// Print the manual page of a command or style, or the list of all.
    Doc(Option<String>),
    /// Print a page of the manual, or how the program is called and the list of pages.
    Help(Option<String>),
    /// Print this text.
    Text(String),
}

#[derive(Parser)]
#[command(name = "perigrain", disable_version_flag = true)]
enum Sub {
    /// Run a deck, like `perigrain DECK`
    Run {
        /// The deck and LAMMPS' switches
        #[arg(value_name = "DECK [SWITCH]", value_hint = ValueHint::FilePath, trailing_var_arg = true, allow_hyphen_values = true)]
        rest: Vec<String>,
    },
    /// Execute lines as they are typed, after a deck if one is given; `perigrain` on a terminal does the same
    Repl {
        /// A deck to begin with, and LAMMPS' switches
        #[arg(value_name = "DECK [SWITCH]", value_hint = ValueHint::FilePath, trailing_var_arg = true, allow_hyphen_values = true)]
        rest: Vec<String>,
    },
    /// Report every problem of decks at once, without acting
    Check {
        /// Print them as JSON, for editors
        #[arg(long)]
        json: bool,
        /// The decks and LAMMPS' switches
        #[arg(value_name = "DECK… [SWITCH]", value_hint = ValueHint::FilePath, trailing_var_arg = true, allow_hyphen_values = true)]
        rest: Vec<String>,
    },
    /// Lay decks out anew: blanks, columns, comments and empty lines, never words
    Fmt(formatting::Wanted),
    /// Write a deck of LIGGGHTS as a native one
    Translate(translating::Wanted),
    /// Answer an editor about decks, as a language server over standard input and output
    Lsp {
        /// The streams, in the words of some editors; there are no others
        #[arg(long, hide = true)]
        stdio: bool,
    },
    /// Print what each step of a deck's runs will do, in which order, and what was left out and why
    Plan {
        /// Run it too, and print time, calls and bytes of each part
        #[arg(long)]
        measure: bool,
        /// Print the command graph for graphviz' `dot` instead
        #[arg(long, conflicts_with = "measure")]
        dot: bool,
        /// The deck and LAMMPS' switches
        #[arg(value_name = "DECK [SWITCH]", value_hint = ValueHint::FilePath, trailing_var_arg = true, allow_hyphen_values = true)]
        rest: Vec<String>,
    },
    /// Show which MPI library connects the ranks of `mpirun -n N perigrain ranks`, and how fast
    Ranks {
        /// `-ranks N`: as many processes of this machine
        #[arg(value_name = "SWITCH", trailing_var_arg = true, allow_hyphen_values = true)]
        rest: Vec<String>,
    },
    /// Make many runs of a deck side by side, each with other values of variables, and one table of what they give
    Sweep {
        /// The deck, lists of values, and LAMMPS' switches
        #[arg(
            value_name = "DECK -each NAME VALUE… [SWITCH]",
            trailing_var_arg = true,
            allow_hyphen_values = true
        )]
        rest: Vec<String>,
    },
    /// Run a deck over knobs such as time step and spacing, and weigh wall time against error
    Bench {
        /// The deck, lists of values, what is measured, and LAMMPS' switches
        #[arg(
            value_name = "DECK -each NAME VALUE… -measure WORD… [SWITCH]",
            trailing_var_arg = true,
            allow_hyphen_values = true
        )]
        rest: Vec<String>,
    },
    /// Run published cases and check whether this build on this machine gives their numbers
    Verify(verifying::Wanted),
    /// Write a web page about a run that is over, from its log and dumps; `-report FILE` does so while a run is made
    Report(reporting::reading::Wanted),
    /// List the examples that the program carries, show one, or copy it here
    Examples(examples::Wanted),
    /// Write a small deck to begin with
    New {
        /// What it computes
        #[arg(long, value_enum, default_value_t)]
        kind: starters::Kind,
        /// The deck's name, as in.mine
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
    },
    /// Print completions for a shell, for `source <(perigrain completions bash)`
    Completions {
        /// The shell
        shell: Shell,
    },
    /// Print the page for `man`, or write it and those of the subcommands into a folder
    Man {
        /// The folder
        #[arg(value_hint = ValueHint::DirPath)]
        folder: Option<PathBuf>,
    },
    /// Explain the code of a message, as PG0102
    Explain {
        /// The code
        code: String,
    },
    /// The same as `help`, without this page
    Doc {
        /// `pair_style peri/pmb`, `run`, …
        name: Vec<String>,
    },
}

/// Subcommands that take a deck and LAMMPS' switches, which are not clap's to read.
const WITH_DECKS: [&str; 7] = ["run", "repl", "check", "plan", "ranks", "sweep", "bench"];

/// Reads the command line without the program's name.
///
/// # Errors
/// What is not understood about it.
pub fn parse(words: Vec<String>) -> Result<Task, Usage> {
    let first = words.first().map(String::as_str);
    let is_sub = Sub::command().get_subcommands().any(|c| Some(c.get_name()) == first);
    let task = if words.len() == 1 && first == Some(crate::sweep::worker::WORD) {
        return Ok(Task::Worker);
    } else if first == Some("help") {
        help_on(&words[1..])
    } else if is_sub {
        subcommand(words)?
    } else if let Some(usage) = mistyped(&words) {
        return Err(usage);
    } else {
        Task::Run(args::parse(words)?)
    };
    let Some(o) = task.options() else { return Ok(task) };
    if o.help {
        return Ok(Task::Text(help()));
    }
    if o.version {
        return Ok(Task::Text(version()));
    }
    let task = at_terminal(task)?;
    let page = |o: &Options| match (&o.report, o.view) {
        (Some(_), _) => Some(("-report", " FILE")),
        (None, Some(_)) => Some(("-view", "")),
        (None, None) => None,
    };
    if let (Some((switch, file)), Some(what)) = (task.options().and_then(page), task.shows_no_run()) {
        let usage = Usage::new(format!("`{switch}` shows a run, and {what}"));
        return Err(usage.help(format!("write `perigrain -in DECK {switch}{file}`")));
    }
    Ok(task)
}

/// The task that replaces one without a deck on a terminal.
fn at_terminal(task: Task) -> Result<Task, Usage> {
    if task.options().is_none_or(|o| o.deck != Deck::Stdin) || !is_terminal() {
        return Ok(task);
    }
    match &task {
        Task::Check { .. } | Task::Plan { .. } | Task::Sweep(_) | Task::Bench(_) => {
            Err(Usage { message: "no deck".into(), help: Some("name one: `perigrain check in.deck`".into()) })
        }
        Task::Run(o) if o.partition.is_empty() => swallowed(o).map_or(Ok(Task::Repl(o.clone())), Err),
        _ => Ok(task),
    }
}

impl Task {
    /// Why a page about a run cannot be had of this.
    fn shows_no_run(&self) -> Option<&'static str> {
        match self {
            Task::Check { .. } => Some("`check` makes none"),
            Task::Plan { measure: false, .. } => Some("`plan` makes none; `plan --measure` does"),
            Task::Sweep(_) | Task::Bench(_) => Some("a sweep makes many"),
            Task::Repl(_) => Some("what is typed has no end"),
            Task::Run(o) if !o.partition.is_empty() => Some("there is one for each partition"),
            _ => None,
        }
    }

    /// What only one process can do of this; nothing where several ranks can.
    pub(super) fn alone(&self) -> Option<&'static str> {
        match self {
            Task::Plan { measure: true, .. } => None,
            Task::Run(_) | Task::Ranks(_) | Task::Text(_) | Task::Explain(_) | Task::Worker => None,
            Task::Sweep(_) | Task::Bench(_) | Task::Suite(_) => None,
            Task::Doc(_) | Task::Help(_) => None,
            Task::Repl(_) => Some("lines are typed into one"),
            _ => Some("this is work for one"),
        }
    }

    /// The switches, those of the first deck if there are several.
    fn options(&self) -> Option<&Options> {
        match self {
            Task::Run(o) | Task::Ranks(o) | Task::Repl(o) | Task::Plan { options: o, .. } => Some(o),
            Task::Check { decks, .. } => decks.first(),
            Task::Sweep(request) => Some(&request.options),
            Task::Bench(request) => Some(&request.sweep.options),
            _ => None,
        }
    }
}

/// The words of the command line with two dashes where LAMMPS' switches have one.
fn with_two_dashes(words: &mut [String]) {
    for word in words {
        if word.strip_prefix('-').is_some_and(|name| name.starts_with(|c: char| c.is_ascii_alphabetic())) {
            word.insert(0, '-');
        }
    }
}

/// A first word that is no deck and nearly a subcommand.
fn mistyped(words: &[String]) -> Option<Usage> {
    let first = words.first().filter(|word| !args::is_switch(word) && !Path::new(word).exists())?;
    let command = Sub::command();
    let names = command.get_subcommands().map(clap::Command::get_name).chain(["help"]);
    let meant = nearest(first, names)?;
    let line = words[1..].iter().fold(format!("perigrain {meant}"), |line, word| line + " " + word);
    let usage = Usage::new(format!("`{first}` is no subcommand, and there is no such deck"));
    Some(usage.help(format!("did you mean `{line}`?")))
}

/// The program's subcommands as clap knows them.
pub fn command() -> clap::Command {
    Sub::command()
}

/// `help`, `help fix nve`, `help PG0102`.
fn help_on(words: &[String]) -> Task {
    match words {
        [] => Task::Help(None),
        [code] if code.to_uppercase().starts_with("PG0") => Task::Explain(code.clone()),
        _ => Task::Help(Some(words.join(" "))),
    }
}

fn subcommand(mut words: Vec<String>) -> Result<Task, Usage> {
    // `plan deck --measure` reads as well as `plan --measure deck`.
    if ["plan", "check"].contains(&words[0].as_str()) {
        words[1..].sort_by_key(|w| !matches!(w.as_str(), "--measure" | "--dot" | "--json"));
    }
    let is_bench = |of: &str| words[0] == "bench" && words.iter().any(|w| w.trim_start_matches('-') == of);
    let (suite, scaling) = (is_bench("suite"), is_bench("scaling"));
    if suite || scaling || !WITH_DECKS.contains(&words[0].as_str()) {
        with_two_dashes(&mut words);
    }
    if suite {
        return benching::suite::Wanted::try_parse_from(words).map(Task::Suite).or_else(|e| unread(&e));
    }
    if scaling {
        return benching::scaling::Wanted::try_parse_from(words).map(Task::Scaling).or_else(|e| unread(&e));
    }
    let sub = match Sub::try_parse_from(std::iter::once("perigrain".to_string()).chain(words)) {
        Ok(sub) => sub,
        Err(e) => return unread(&e),
    };
    Ok(match sub {
        Sub::Run { rest } => Task::Run(args::parse(rest)?),
        Sub::Repl { rest } => Task::Repl(args::parse(rest)?),
        Sub::Check { json, rest } => {
            let (options, decks) = args::parse_many(rest)?;
            Task::Check { decks: checking::each(&options, decks), json }
        }
        Sub::Fmt(wanted) => Task::Format(wanted),
        Sub::Translate(wanted) => Task::Translate(wanted),
        Sub::Lsp { stdio: _ } => Task::Lsp,
        Sub::Plan { measure, dot, rest } => Task::Plan { options: args::parse(rest)?, measure, dot },
        Sub::Ranks { rest } => Task::Ranks(args::parse(rest)?),
        Sub::Sweep { rest } => Task::Sweep(Box::new(Request::parse(rest)?)),
        Sub::Bench { rest } => Task::Bench(Box::new(benching::args::Request::parse(rest)?)),
        Sub::Report(wanted) => Task::Report(wanted),
        Sub::Verify(wanted) => Task::Verify(wanted),
        Sub::Examples(wanted) => Task::Examples(wanted),
        Sub::New { file, kind } => Task::New { file, kind },
        Sub::Completions { shell } => Task::Completions(shell),
        Sub::Man { folder } => Task::Man(folder),
        Sub::Explain { code } => Task::Explain(code),
        Sub::Doc { name } => Task::Doc((!name.is_empty()).then(|| name.join(" "))),
    })
}

/// A requested help page, or an error.
fn unread(e: &clap::Error) -> Result<Task, Usage> {
    let text = e.to_string();
    if !e.use_stderr() {
        return Ok(Task::Text(text));
    }
    let mut parts = text.split("\n\n");
    // What is missing or possible stands in lines of its own.
    let first: Vec<&str> = parts.next().unwrap_or_default().lines().map(str::trim).collect();
    let message = first.join(" ").trim_start_matches("error: ").to_string();
    let (mut tip, mut usage) = (None, None);
    for line in parts.flat_map(str::lines).map(str::trim) {
        tip = tip.or_else(|| line.strip_prefix("tip: ").map(|tip| tip.trim().to_string()));
        usage = usage.or_else(|| line.strip_prefix("Usage: ").map(|line| format!("write `{line}`")));
    }
    let help = tip.or(usage);
    Err(Usage { message, help })
}

fn is_terminal() -> bool {
    std::io::IsTerminal::is_terminal(&std::io::stdin())
}

/// A deck that `-var` has taken for a value.
fn swallowed(options: &Options) -> Option<Usage> {
    let (name, values) = options.vars.last().filter(|(_, values)| values.len() > 1)?;
    let last = values.last().filter(|last| std::path::Path::new(last).is_file())?;
    let help = format!(
        "`{last}` was read as a value of variable `{name}`: put the deck first, or write `-in {last}`"
    );
    Some(Usage { message: "no deck".into(), help: Some(help) })
}

/// Version, commit, target and lanes, as a line.
pub fn version() -> String {
    super::version::line() + "\n"
}

/// The help page: forms, subcommands, switches.
pub fn help() -> String {
    let mut text = String::from(
        "perigrain: LAMMPS-style decks for fracture, erosion, grains and agglomerates\n\n\
         usage: perigrain DECK [SWITCH…]\n       perigrain [SWITCH…]            (interactive, on a terminal)\n       perigrain SUBCOMMAND …\n       perigrain [SWITCH…] < DECK\n\nsubcommands:\n",
    );
    for sub in Sub::command().get_subcommands() {
        let about = sub.get_about().map(ToString::to_string).unwrap_or_default();
        text += &format!("  {:<12} {about}\n", sub.get_name());
    }
    text += &format!(
        "  {:<12} {}\n",
        "help", "Print the manual page of a command or style, or this page and the list of all"
    );
    text += "\nswitches (what holds without them in brackets):\n";
    for s in SWITCHES.iter().filter(|s| !s.about.is_empty()) {
        let names = s.names[..s.names.len().min(2)].join(", ");
        text += &format!("  {:<36} {}\n", format!("{names} {}", s.values), s.about);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_world::Compat;

    fn read(line: &str) -> Result<Task, Usage> {
        parse(line.split_whitespace().map(String::from).collect())
    }

    fn deck(name: &str) -> Options {
        Options { deck: Deck::File(name.into()), ..Options::default() }
    }

    #[test]
    fn a_bare_deck_and_run_are_the_same() {
        assert_eq!(read("in.plate").unwrap(), Task::Run(deck("in.plate")));
        assert_eq!(read("run in.plate").unwrap(), Task::Run(deck("in.plate")));
        let vars = vec![("v".to_string(), vec!["35".to_string()])];
        assert_eq!(
            read("check in.plate -var v 35").unwrap(),
            Task::Check { decks: vec![Options { vars, ..deck("in.plate") }], json: false }
        );
    }

    #[test]
    fn several_decks_are_checked_with_the_same_switches() {
        let with = |name: &str| Options { compat: Compat::Lammps2026, ..deck(name) };
        let task = Task::Check { decks: vec![with("a"), with("b")], json: true };
        assert_eq!(read("check a b --json -compat lammps").unwrap(), task);
        assert!(read("run a b").is_err());
    }

    #[test]
    fn plan_takes_its_options_on_either_side_of_the_deck() {
        let task = Task::Plan { options: deck("in.plate"), measure: true, dot: false };
        assert_eq!(read("plan --measure in.plate").unwrap(), task);
        assert_eq!(read("plan in.plate --measure").unwrap(), task);
        assert!(read("plan --measure --dot in.plate").is_err());
    }

    #[test]
    fn texts_and_errors_come_from_every_form() {
        assert_eq!(read("explain PG0101").unwrap(), Task::Explain("PG0101".into()));
        assert_eq!(read("doc pair_style peri/pmb").unwrap(), Task::Doc(Some("pair_style peri/pmb".into())));
        assert_eq!(read("-version").unwrap(), Task::Text(version()));
        assert_eq!(read("check -help").unwrap(), Task::Text(help()));
        assert_eq!(read("help").unwrap(), Task::Help(None));
        assert_eq!(read("help pair_style peri/pmb").unwrap(), Task::Help(Some("pair_style peri/pmb".into())));
        assert_eq!(read("help pg0101").unwrap(), Task::Explain("pg0101".into()));
        assert!(read("check in.plate -logg x").unwrap_err().help.unwrap().contains("`-log`"));
        assert!(read("explain").is_err());
        assert!(read("check a -view").unwrap_err().message.starts_with("`-view` shows a run"));
        assert_eq!(read("-view 8080 a").unwrap(), Task::Run(Options { view: Some(8080), ..deck("a") }));
        assert_eq!(read("-view a").unwrap(), Task::Run(Options { view: Some(0), ..deck("a") }));
        assert!(read("a -view 99999").unwrap_err().message.contains("ports are 1 to 65535"));
        for line in
            ["check a -report r.html", "plan a -report r.html", "repl a -report r", "a -p 2 -report r"]
        {
            assert!(read(line).unwrap_err().message.starts_with("`-report` shows a run"), "{line}");
        }
        assert_eq!(
            read("a -report r").unwrap(),
            Task::Run(Options { report: Some("r".into()), ..deck("a") })
        );
        let usage = read("chekc in.fall -threads 2").unwrap_err();
        assert_eq!(usage.help.as_deref(), Some("did you mean `perigrain check in.fall -threads 2`?"));
        // A file of that name is a deck.
        assert_eq!(read("tests").unwrap(), Task::Run(deck("tests")));
        let wanted = verifying::Wanted {
            only: Some("chung".into()),
            json: Some("a.json".into()),
            threads: Some(2),
            ..Default::default()
        };
        assert_eq!(read("verify -only chung -json a.json --threads 2").unwrap(), Task::Verify(wanted));
        assert!(read("verify -onyl chung").unwrap_err().help.unwrap().contains("--only"));
        for hidden in ["-layout", "-rest", "-portable"] {
            assert!(!help().contains(hidden));
        }
    }
}
