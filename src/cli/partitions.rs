//! `-partition`: the same deck run several times side by side, each a process with its own log and screen.

#[cfg(unix)]
mod ranks;

use super::args::{Deck, Options, Target, Usage};
use super::{FAILED, INTERRUPTED, OK, signals};
use crate::processes;
use crate::sweep::starter::{self, Starter};
use crate::sweep::worker::live_with;
use perigrain_base::comm;
use perigrain_lang::{Partition, Turn};
use std::fs::File;
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The role of one of several processes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct World {
    /// Its number, from 0.
    pub number: usize,
    /// The process that waits for it.
    pub parent: u32,
    /// Where the processes share out turns.
    pub turns: PathBuf,
}

/// `8x2 4 5`: partitions, each with the number of its threads.
///
/// # Errors
/// A word that is neither `N` nor `MxN`.
pub fn threads(words: &[String]) -> Result<Vec<usize>, Usage> {
    let mut all = vec![];
    for word in words {
        let (count, each) = word.split_once('x').unwrap_or(("1", word));
        match (count.parse::<usize>(), each.parse::<usize>()) {
            (Ok(count @ 1..=10_000), Ok(each @ 1..)) => all.extend(std::iter::repeat_n(each, count)),
            _ => {
                let usage = Usage::new(format!("`-partition {word}` is neither N nor MxN"));
                return Err(
                    usage.help("`-partition 4x1 2x8` makes four runs with a thread each and two with eight")
                );
            }
        }
    }
    if all.is_empty() {
        return Err(Usage::new("`-partition` needs the threads of each partition, as 4x1"));
    }
    Ok(all)
}

/// The options of the process that is one of several: its threads, log and screen.
pub fn own(o: &Options, world: &World) -> Options {
    let mut own = o.clone();
    own.threads = o.partition.get(world.number).copied();
    own.log = file(&o.plog, &o.log, "log.lammps", world.number);
    own.screen = file(&o.pscreen, &o.screen, "screen", world.number);
    own
}

/// `FILE.N` by the switch for partitions, else by the one for all, else by the usual name.
fn file(own: &Target, all: &Target, usual: &str, number: usize) -> Target {
    let base = match (own, all) {
        (Target::None, _) | (Target::Usual | Target::Full, Target::None) => return Target::None,
        (Target::File(path), _) | (Target::Usual | Target::Full, Target::File(path)) => {
            path.display().to_string()
        }
        _ => usual.to_owned(),
    };
    Target::File(format!("{base}.{number}").into())
}

/// The partition that a session belongs to, if there are several; a deck that is only looked at is seen by the first.
pub fn of(o: &Options) -> Option<Partition> {
    let of = o.partition.len();
    let Some(world) = &o.world else {
        let next = AtomicUsize::new(of);
        let turn: Turn = Arc::new(move |_| Ok(next.fetch_add(1, Ordering::Relaxed)));
        return (of > 0).then(|| Partition::new(0, of, turn));
    };
    let world = world.clone();
    let number = world.number;
    Some(Partition::new(number, of, Arc::new(move |round| world.take(round, of))))
}

impl World {
    /// Takes the next turn of a round: from the file that all processes share, or on ranks by a request to the rank's socket.
    fn take(&self, round: u64, of: usize) -> std::io::Result<usize> {
        #[cfg(unix)]
        if std::os::unix::fs::FileTypeExt::is_socket(&std::fs::metadata(&self.turns)?.file_type()) {
            return ranks::request_turn(&self.turns, self, round);
        }
        take(&self.turns, round as usize, of)
    }
}

/// Takes the next turn of a round from the file that all processes share; those below `of` are where they began.
fn take(path: &Path, round: usize, of: usize) -> std::io::Result<usize> {
    let mut file = File::options().read(true).write(true).open(path)?;
    file.lock()?;
    let mut text = String::new();
    file.read_to_string(&mut text)?;
    let mut next: Vec<usize> = text.split_whitespace().filter_map(|w| w.parse().ok()).collect();
    next.resize(next.len().max(round + 1), of);
    let turn = next[round];
    next[round] += 1;
    let text: Vec<String> = next.iter().map(usize::to_string).collect();
    file.set_len(0)?;
    file.rewind()?;
    file.write_all(text.join(" ").as_bytes())?;
    file.unlock()?;
    Ok(turn)
}

/// Runs each partition in a process of its own and waits for all; the exit code is that of the worst. Of several ranks each one has its own
/// partitions.
///
/// # Errors
/// A deck from standard input, which several cannot read, ranks that cannot be joined.
pub fn execute(o: &Options) -> Result<u8, Usage> {
    if o.deck == Deck::Stdin {
        return Err(Usage::new("several partitions cannot all read the deck from standard input")
            .help("write `-in FILE`"));
    }
    let exit_code = |outcome: std::io::Result<u8>| {
        outcome.unwrap_or_else(|e| {
            eprintln!("error: the partitions cannot be started: {e}");
            FAILED
        })
    };
    let here = || {
        let turns = std::env::temp_dir().join(format!("perigrain.{}.turns", std::process::id()));
        let outcome = all(o, &turns);
        // It is no longer needed.
        let _ = std::fs::remove_file(&turns);
        Ok(exit_code(outcome))
    };
    #[cfg(unix)]
    return super::ranks::shared_out(
        o,
        |ranks| ranks.map_or_else(here, |ranks| Ok(exit_code(ranks::first(o, &ranks)))),
        ranks::serve,
    );
    #[cfg(not(unix))]
    super::ranks::shared_out(o, |_| here(), |_| FAILED)
}

impl Options {
    /// Whether the partitions' common lines are for the screen.
    fn shows_screen(&self) -> bool {
        matches!(self.screen, Target::Usual | Target::Full)
    }
}

/// The file for what concerns all partitions.
fn own_log(o: &Options) -> std::io::Result<Option<File>> {
    match &o.log {
        Target::None => Ok(None),
        Target::Usual | Target::Full => File::create("log.lammps").map(Some),
        Target::File(path) => File::create(path).map(Some),
    }
}

/// How a partition ended that did not end well.
fn ended_in_words(code: u8) -> Option<String> {
    match code {
        OK => None,
        INTERRUPTED => Some(format!("was interrupted (exit code {code})")),
        _ => Some(format!("failed (exit code {code})")),
    }
}

fn all(o: &Options, turns: &Path) -> std::io::Result<u8> {
    // Ctrl-C reaches the partitions too, and requests to end are passed on: they end at whole steps, and this process waits.
    let _ = ctrlc::set_handler(|| {});
    let started: Arc<Mutex<Vec<u32>>> = Arc::default();
    let known = started.clone();
    signals::listen(move || processes::signal(&known.lock().unwrap_or_else(PoisonError::into_inner), "TERM"));
    File::create(turns)?;
    let mut log = own_log(o)?;
    let mut say = |text: String| {
        if o.shows_screen() {
            super::show(&text);
        }
        log.as_mut().map_or(Ok(()), |log| log.write_all(text.as_bytes()))
    };
    say(format!("Running on {} partitions of processors\n", o.partition.len()))?;
    let children = (0..o.partition.len()).map(|number| Start { number, turns }.spawn());
    let children = children.collect::<std::io::Result<Vec<_>>>()?;
    *started.lock().unwrap_or_else(PoisonError::into_inner) = children.iter().map(Child::id).collect();
    let mut worst = OK;
    for (number, mut child) in children.into_iter().enumerate() {
        let code = child.wait()?.code().map_or(FAILED, |code| code.clamp(0, 255) as u8);
        if let Some(how) = ended_in_words(code) {
            say(format!("partition {} {how}\n", number + 1))?;
        }
        worst = worst.max(code);
    }
    Ok(worst)
}

/// This program again, with the same words and its place among the partitions.
struct Start<'a> {
    number: usize,
    turns: &'a Path,
}

impl Start<'_> {
    fn spawn(self) -> std::io::Result<Child> {
        let mut command = Starter::itself()?.command();
        command.args(starter::words()).arg("-world").arg(self.number.to_string());
        command.arg(std::process::id().to_string()).arg(self.turns);
        comm::set_apart(&mut command);
        command.stdin(Stdio::null()).spawn()
    }
}

/// One of several processes ends when the one that waits for it is gone.
pub fn settle(world: &World) {
    live_with(world.parent);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn partitions_have_threads_and_files() {
        let words = |text: &str| text.split(' ').map(String::from).collect::<Vec<_>>();
        assert_eq!(threads(&words("2x1 8 1x3")).unwrap(), [1, 1, 8, 3]);
        for bad in ["0x1", "x", "2x0", "two", "1x2x3", "99999x1"] {
            assert!(threads(&words(bad)).is_err(), "{bad}");
        }
        assert_eq!(file(&Target::Usual, &Target::Usual, "screen", 1), Target::File("screen.1".into()));
        assert_eq!(file(&Target::File("p".into()), &Target::None, "screen", 0), Target::File("p.0".into()));
        assert_eq!(file(&Target::Usual, &Target::None, "screen", 0), Target::None);
    }

    #[test]
    fn every_turn_is_taken_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("turns");
        File::create(&path).unwrap();
        let mut taken: Vec<usize> = std::thread::scope(|s| {
            let threads: Vec<_> = (0..4)
                .map(|_| s.spawn(|| (0..25).map(|_| take(&path, 1, 4).unwrap()).collect::<Vec<_>>()))
                .collect();
            threads.into_iter().flat_map(|t| t.join().unwrap()).collect()
        });
        taken.sort_unstable();
        assert_eq!(taken, (4..104).collect::<Vec<_>>());
        assert_eq!(take(&path, 0, 4).unwrap(), 4, "another round");
    }
}
