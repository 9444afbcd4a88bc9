//! LAMMPS' command-line switches, parsed by own code because `-var name a b c` fits no option parser.

use super::partitions::{self, World};
use super::ranks;
use perigrain_base::diag::nearest;
use perigrain_base::gate::Limits;
use perigrain_world::Compat;
use std::path::PathBuf;
use std::time::Duration;

/// Where the deck comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Deck {
    /// Standard input.
    #[default]
    Stdin,
    /// A file.
    File(PathBuf),
}

/// Where a stream of text goes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Target {
    /// The default destination: `log.lammps`, the terminal.
    #[default]
    Usual,
    /// As usual, with every word also on a terminal.
    Full,
    /// Nowhere.
    None,
    /// A file.
    File(PathBuf),
}

/// All options for the execution of a deck, before any has been applied.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// `perigrain in.deck`, `-in in.deck`, else standard input.
    pub deck: Deck,
    /// `-log file|none`.
    pub log: Target,
    /// `-screen file|none|full`.
    pub screen: Target,
    /// `-echo none|screen|log|both`.
    pub echo: Option<String>,
    /// `-var name value …`: index variables, in the order given.
    pub vars: Vec<(String, Vec<String>)>,
    /// `-report FILE`: the run as a web page.
    pub report: Option<PathBuf>,
    /// `-view [PORT]`: the page during the run; 0 for any port.
    pub view: Option<u16>,
    /// `-timeout TIME`: how long runs may take in all.
    pub timeout: Option<Duration>,
    /// `-threads N`, `-pk omp N`.
    pub threads: Option<usize>,
    /// `-ranks N`: as many processes of this machine run the deck together.
    pub ranks: Option<usize>,
    /// `-compat lammps`: LAMMPS' numbers also where LAMMPS is wrong, and of which version.
    pub compat: Compat,
    /// `-partition 4x1 2x8`: the threads of each partition; empty where there is one.
    pub partition: Vec<usize>,
    /// `-plog file|none`.
    pub plog: Target,
    /// `-pscreen file|none`.
    pub pscreen: Target,
    /// Which of several partitions this process executes.
    pub world: Option<World>,
    /// `-layout list`: no lattice layout, for tests.
    pub list_layout: bool,
    /// `-rest full`: particles at rest are computed too, for tests.
    pub no_skipping: bool,
    /// `-portable`: no AVX2, for tests.
    pub portable: bool,
    /// `-safe`, `-limit NAME N`: the limits of an untrusted deck.
    pub safe: Option<Limits>,
    /// `-help`.
    pub help: bool,
    /// `-version`.
    pub version: bool,
}

/// What is wrong with a command line, and what to write instead.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Usage {
    /// One sentence, lower case, no full stop.
    pub message: String,
    /// Advice, if there is any.
    pub help: Option<String>,
}

impl Usage {
    pub(super) fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), help: None }
    }

    pub(super) fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }
}

type Set = fn(&mut Options, &mut Values) -> Result<(), Usage>;

/// One switch: its spellings, what follows it, what it is for, how it is read.
pub struct Switch {
    /// All spellings, the one for the help page first.
    pub names: &'static [&'static str],
    /// What follows it.
    pub values: &'static str,
    /// One line for the help page; an empty one hides the switch.
    pub about: &'static str,
    set: Set,
}

/// Every switch, in the order of the help page.
pub const SWITCHES: &[Switch] = &[
    switch(&["-in", "-i"], "FILE", "read the deck from FILE (`none` or nothing: standard input)", |o, v| {
        let file = v.one("a deck")?;
        o.deck = if file == "none" { Deck::Stdin } else { Deck::File(file.into()) };
        Ok(())
    }),
    switch(&["-log", "-l"], "FILE|none", "where the log goes (log.lammps)", |o, v| {
        o.log = target(v.one("a file or `none`")?);
        Ok(())
    }),
    switch(
        &["-screen", "-sc"],
        "FILE|none|full",
        "where the screen output goes (the terminal, where `full` shows all that the log has)",
        |o, v| {
            let word = v.one("a file, `none` or `full`")?;
            o.screen = if word == "full" { Target::Full } else { target(word) };
            Ok(())
        },
    ),
    switch(&["-echo", "-e"], "none|screen|log|both", "repeat each line of the deck there (log)", |o, v| {
        const KNOWN: [&str; 4] = ["none", "screen", "log", "both"];
        let word = v.one("none, screen, log or both")?;
        if !KNOWN.contains(&word.as_str()) {
            let usage = Usage::new(format!("`-echo {word}` is neither none, screen, log nor both"));
            return Err(match nearest(&word, KNOWN) {
                Some(known) => usage.help(format!("did you mean `-echo {known}`?")),
                None => usage,
            });
        }
        o.echo = Some(word);
        Ok(())
    }),
    switch(
        &["-var", "-v"],
        "NAME VALUE…",
        "define an index variable; the deck's own line then has no effect",
        |o, v| {
            let name = v.one("a name and a value")?;
            if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
                let message = format!("`{name}` is no name for a variable: letters, digits and _ only");
                return Err(Usage::new(message));
            }
            let mut values = vec![v.one("at least one value")?];
            values.extend(v.rest());
            o.vars.push((name, values));
            Ok(())
        },
    ),
    switch(
        &["-threads"],
        "N",
        "use at most N threads; results are the same bits for any N (OMP_NUM_THREADS, else all cores)",
        |o, v| {
            o.threads = Some(v.count("a number of threads")?);
            Ok(())
        },
    ),
    switch(
        &["-ranks"],
        "N",
        "run the deck on N processes of this machine together, as `mpirun -n N` does; results are the same bits for any N",
        |o, v| {
            let n = v.count("a number of ranks")?;
            if n > ranks::MOST {
                let usage =
                    Usage::new(format!("`-ranks {n}`: at most {} processes are started here", ranks::MOST));
                return Err(usage.help("`mpirun -n N perigrain …` runs more, on several machines"));
            }
            o.ranks = Some(n);
            Ok(())
        },
    ),
    switch(
        &["-timeout"],
        "TIME",
        "end runs after TIME (seconds, MM:SS or H:MM:SS) in all, at a whole step, with a last restart file",
        |o, v| {
            let word = v.one("a time")?;
            let Some(time) = crate::session::time(&word) else {
                let usage = Usage::new(format!("`-timeout {word}`: `{word}` is no time"));
                return Err(usage.help("write seconds, MM:SS or H:MM:SS, as `-timeout 23:30:00`"));
            };
            o.timeout = Some(time);
            Ok(())
        },
    ),
    switch(&["-report"], "FILE", "write what the run was as one web page", |o, v| {
        o.report = Some(v.one("a file")?.into());
        Ok(())
    }),
    switch(&["-view"], "[PORT]", "show the run in a browser on this machine while it runs", |o, v| {
        o.view = Some(v.port()?);
        Ok(())
    }),
    switch(
        &["-compat"],
        "lammps|liggghts",
        "LAMMPS' numbers also where LAMMPS is wrong, or the words of LIGGGHTS",
        |o, v| {
            let word = v.one("lammps or liggghts")?;
            let Some(compat) = Compat::from_name(&word).filter(|compat| compat.is_chosen()) else {
                let message = format!("perigrain cannot imitate `{word}`");
                let help = "write `-compat lammps/2025` for LAMMPS 22Jul2025, or `-compat lammps` (`lammps/2026`) with what has been mended since; `-compat liggghts` reads the words of LIGGGHTS";
                return Err(Usage::new(message).help(help));
            };
            o.compat = compat;
            Ok(())
        },
    ),
    switch(&["-suffix", "-sf"], "omp", "for LAMMPS' command lines: every style has threads here", |_, v| {
        match v.one("omp")?.as_str() {
            "omp" | "off" => Ok(()),
            other => Err(Usage::new(format!("perigrain has no styles with suffix `{other}`"))
                .help("leave it out, or write `-sf omp`")),
        }
    }),
    switch(&["-package", "-pk"], "omp N", "for LAMMPS' command lines: the same as -threads N", |o, v| {
        let package = v.one("omp N")?;
        if package != "omp" {
            let message = format!("perigrain has no package `{package}`");
            return Err(Usage::new(message).help("leave it out, or write `-pk omp N`"));
        }
        // LAMMPS reads 0 as "from the environment"; further keywords tune what does not exist here.
        let n = v.number("a number of threads")?;
        o.threads = (n > 0).then_some(n);
        v.rest();
        Ok(())
    }),
    switch(
        &["-partition", "-p"],
        "MxN|N…",
        "run the deck M times beside each other, each with N threads",
        |o, v| {
            o.partition = partitions::threads(&v.rest())?;
            Ok(())
        },
    ),
    switch(
        &["-plog", "-pl"],
        "FILE|none",
        "the partitions' logs FILE.0, FILE.1 … (log.lammps.0 …)",
        |o, v| {
            o.plog = target(v.one("a file or `none`")?);
            Ok(())
        },
    ),
    switch(
        &["-pscreen", "-ps"],
        "FILE|none",
        "the partitions' screens FILE.0, FILE.1 … (screen.0 …)",
        |o, v| {
            o.pscreen = target(v.one("a file or `none`")?);
            Ok(())
        },
    ),
    switch(&["-nocite", "-nc"], "", "for LAMMPS' command lines: there is no citation file anyway", |_, _| {
        Ok(())
    }),
    switch(
        &["-safe"],
        "",
        "keep the deck in its folder: no shell, no environment, limits to all it uses",
        |o, _| {
            o.safe.get_or_insert_default();
            Ok(())
        },
    ),
    switch(
        &["-limit"],
        "NAME N",
        "as -safe, with at most N of memory (MB), steps, lines, files or pixels",
        |o, v| {
            let name = v.one("memory, steps, lines, files or pixels")?;
            let n = v.whole("a whole number")?;
            let mut limits = o.safe.unwrap_or_default();
            let Some((_, limit)) = limits.named().into_iter().find(|(known, _)| *known == name) else {
                let usage = Usage::new(format!("there is no limit of `{name}`"));
                return Err(usage.help("limits are memory, steps, lines, files and pixels"));
            };
            *limit = n;
            o.safe = Some(limits);
            Ok(())
        },
    ),
    switch(&["-help", "-h", "--help"], "", "this page", |o, _| {
        o.help = true;
        Ok(())
    }),
    switch(
        &["-version", "--version", "-V"],
        "",
        "version, commit, target and vector instructions in use",
        |o, _| {
            o.version = true;
            Ok(())
        },
    ),
    switch(&["-world"], "", "", |o, v| {
        let number = v.number("a partition")?;
        let parent = v.number("a process")? as u32;
        o.world = Some(World { number, parent, turns: v.one("a file")?.into() });
        Ok(())
    }),
    switch(&["-layout"], "list|auto", "", |o, v| {
        o.list_layout = either(v, "list", "auto")?;
        Ok(())
    }),
    switch(&["-rest"], "full|skip", "", |o, v| {
        o.no_skipping = either(v, "full", "skip")?;
        Ok(())
    }),
    switch(&["-portable"], "", "", |o, _| {
        o.portable = true;
        Ok(())
    }),
];

/// Switches of LAMMPS that mean nothing to one process without accelerators.
const LAMMPS_ONLY: &[&str] = &[
    "-cite",
    "-kokkos",
    "-k",
    "-mdi",
    "-mpicolor",
    "-m",
    "-reorder",
    "-ro",
    "-r",
    "-restart",
    "-restart2data",
    "-r2data",
    "-restart2dump",
    "-r2dump",
    "-restart2info",
    "-r2info",
    "-skiprun",
    "-sr",
];

const fn switch(
    names: &'static [&'static str],
    values: &'static str,
    about: &'static str,
    set: Set,
) -> Switch {
    Switch { names, values, about, set }
}

fn target(word: String) -> Target {
    if word == "none" { Target::None } else { Target::File(word.into()) }
}

fn either(v: &mut Values, yes: &str, no: &str) -> Result<bool, Usage> {
    match v.one(&format!("{yes} or {no}"))? {
        word if word == yes => Ok(true),
        word if word == no => Ok(false),
        word => Err(Usage::new(format!("`{} {word}` is neither {yes} nor {no}", v.switch))),
    }
}

/// What follows a switch.
struct Values<'a> {
    switch: String,
    words: &'a mut std::iter::Peekable<std::vec::IntoIter<String>>,
}

impl Values<'_> {
    fn one(&mut self, what: &str) -> Result<String, Usage> {
        match self.words.next_if(|w| !is_switch(w)) {
            Some(word) => Ok(word),
            None => Err(Usage::new(format!("`{}` needs {what}", self.switch))),
        }
    }

    fn number(&mut self, what: &str) -> Result<usize, Usage> {
        let word = self.one(what)?;
        word.parse().map_err(|_| Usage::new(format!("`{} {word}`: `{word}` is not {what}", self.switch)))
    }

    /// A number that follows if one does; else 0.
    fn port(&mut self) -> Result<u16, Usage> {
        let all_digits = |w: &String| !w.is_empty() && w.chars().all(|c| c.is_ascii_digit());
        let Some(word) = self.words.next_if(all_digits) else { return Ok(0) };
        word.parse().map_err(|_| Usage::new(format!("`{} {word}`: ports are 1 to 65535", self.switch)))
    }

    /// A whole number from 1, as `5000` or `5e3`.
    fn whole(&mut self, what: &str) -> Result<u64, Usage> {
        let word = self.one(what)?;
        match word.parse::<f64>() {
            Ok(n) if (1.0..1e18).contains(&n) && n.fract() == 0.0 => Ok(n as u64),
            _ => Err(Usage::new(format!("`{}`: `{word}` is not {what} from 1", self.switch))),
        }
    }

    fn count(&mut self, what: &str) -> Result<usize, Usage> {
        match self.number(what)? {
            0 => Err(Usage::new(format!("`{} 0`: at least 1 is needed", self.switch))),
            n => Ok(n),
        }
    }

    fn rest(&mut self) -> Vec<String> {
        std::iter::from_fn(|| self.words.next_if(|w| !is_switch(w))).collect()
    }
}

/// Begins like a switch: a dash that starts no number.
pub(super) fn is_switch(word: &str) -> bool {
    word.strip_prefix('-').is_some_and(|w| w.starts_with(|c: char| c.is_ascii_alphabetic() || c == '-'))
}

/// Reads a command line without the program's name.
///
/// # Errors
/// A word that is not understood, with the nearest known one.
pub fn parse(words: Vec<String>) -> Result<Options, Usage> {
    let (mut options, mut decks) = parse_many(words)?;
    if let Some(second) = decks.get(1) {
        let Deck::File(path) = second else { return Err(Usage::new("one deck at a time")) };
        let message = format!("`{}`: there is a deck already", path.display());
        return Err(Usage::new(message).help("one deck at a time; quote a name with spaces"));
    }
    options.deck = decks.pop().unwrap_or_default();
    Ok(options)
}

/// Reads a command line that may name several decks; they come beside the options.
///
/// # Errors
/// A word that is not understood, with the nearest known one.
pub fn parse_many(words: Vec<String>) -> Result<(Options, Vec<Deck>), Usage> {
    let mut options = Options::default();
    let mut decks = vec![];
    let mut words = words.into_iter().peekable();
    while let Some(word) = words.next() {
        if !is_switch(&word) {
            decks.push(Deck::File(word.into()));
            continue;
        }
        // Two dashes are as good as one: other programs require them, and completions of shells write them.
        let one = if word.starts_with("--") { &word[1..] } else { &word };
        let Some(switch) = SWITCHES.iter().find(|s| s.names.iter().any(|name| [one, &word].contains(name)))
        else {
            return Err(unknown(&word));
        };
        (switch.set)(&mut options, &mut Values { switch: word, words: &mut words })?;
        if switch.names[0] == "-in" {
            decks.push(std::mem::take(&mut options.deck));
        }
    }
    Ok((options, decks))
}

fn unknown(word: &str) -> Usage {
    if LAMMPS_ONLY.contains(&word) {
        let message = format!("LAMMPS' switch `{word}` is not in perigrain");
        if word == "-r" || word.starts_with("-r2") || word.starts_with("-restart") {
            return Usage::new(message)
                .help("in a deck, `read_restart` and then `write_data` or `write_dump` do this");
        }
        return Usage::new(message).help("leave it out: processors without accelerators do the work");
    }
    let names = SWITCHES.iter().filter(|s| !s.about.is_empty()).flat_map(|s| s.names.iter().copied());
    let usage = Usage::new(format!("unknown switch `{word}`"));
    match nearest(word, names) {
        Some(known) => usage.help(format!("did you mean `{known}`?")),
        None => usage.help("`perigrain -help` lists them"),
    }
}

#[cfg(test)]
mod tests;
