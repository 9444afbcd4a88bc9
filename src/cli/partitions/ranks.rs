//! Partitions over ranks: each is a process that one of the ranks starts. Turns and ends go to the first rank by letters.

use super::{Options, Start, World, ended_in_words, own_log};
use crate::cli::{FAILED, OK, signals};
use crate::processes;
use crate::sweep::ranks::Ranks;
use perigrain_base::comm::Gone;
use std::io::{Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::Child;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Interval at which letters, processes and their requests are polled.
const PAUSE: Duration = Duration::from_millis(2);

/// Runs every partition; the exit code is that of the worst.
///
/// # Errors
/// Processes that cannot be started, files that cannot be written.
pub fn first(o: &Options, ranks: &Ranks) -> std::io::Result<u8> {
    let of = o.partition.len();
    let places = places(&o.partition, ranks.size());
    let mut log = own_log(o)?;
    let mut say = |text: String| {
        if o.shows_screen() {
            crate::cli::show(&text);
        }
        log.as_mut().map_or(Ok(()), |log| log.write_all(text.as_bytes()))
    };
    say(format!("Running on {of} partitions of processors, {}\n", ranks.describe()))?;
    let mut team = Team::new()?;
    for (number, rank) in places.iter().enumerate() {
        match rank {
            0 => team.start(number)?,
            _ => ranks.send(*rank, &["start".into(), number.to_string()]),
        }
    }
    let (mut codes, mut turns) = (vec![None; of], Turns { next: vec![], of });
    while codes.contains(&None) {
        for (desk, number, round) in team.waiting() {
            debug_assert!(number < of);
            answer(desk, turns.take(round));
        }
        team.ended().into_iter().for_each(|(number, code)| codes[number] = Some(code));
        for rank in 1..ranks.size() {
            match ranks.hear(rank) {
                Ok(None) => {}
                Ok(Some(words)) => match read(&words) {
                    Some(("turn", number, round)) => {
                        let turn = turns.take(round);
                        ranks.send(rank, &["turn".into(), number.to_string(), turn.to_string()]);
                    }
                    Some(("end", number, code)) if number < of => codes[number] = Some(code as u8),
                    _ => {}
                },
                Err(Gone) => {
                    let making = (0..of).filter(|n| places[*n] == rank && codes[*n].is_none());
                    let making: Vec<String> = making.map(|n| format!("partition {}", n + 1)).collect();
                    let what =
                        if making.is_empty() { "none was left to it".into() } else { making.join(", ") };
                    eprintln!("error: {} has ended without a message: {what}", ranks.name(rank));
                    return Ok(FAILED);
                }
            }
        }
        std::thread::sleep(PAUSE);
    }
    let mut worst = OK;
    for (number, code) in codes.into_iter().flatten().enumerate() {
        if let Some(how) = ended_in_words(code) {
            say(format!("partition {} {how}, {}\n", number + 1, ranks.name(places[number])))?;
        }
        worst = worst.max(code);
    }
    Ok(worst)
}

/// Runs partitions for the first rank until it sends this one home; the exit code.
pub fn serve(ranks: &Ranks) -> u8 {
    let mut team = match Team::new() {
        Ok(team) => team,
        Err(e) => {
            eprintln!("error: {}: {e}", ranks.name(ranks.own()));
            return FAILED;
        }
    };
    let mut desks: Vec<(usize, UnixStream)> = vec![];
    let say = |what: &str, number: usize, value: usize| {
        ranks.send(0, &[what.into(), number.to_string(), value.to_string()]);
    };
    loop {
        match ranks.hear(0) {
            Err(Gone) => return ranks.orphaned(),
            Ok(None) => std::thread::sleep(PAUSE),
            Ok(Some(words)) => match read(&words) {
                Some(("bye", code, _)) => {
                    ranks.leave();
                    return code as u8;
                }
                Some(("start", number, _)) => {
                    if let Err(e) = team.start(number) {
                        eprintln!("error: {}: partition {}: {e}", ranks.name(ranks.own()), number + 1);
                        say("end", number, FAILED.into());
                    }
                }
                Some(("turn", number, turn)) => {
                    if let Some(at) = desks.iter().position(|(waiting, _)| *waiting == number) {
                        answer(desks.remove(at).1, turn);
                    }
                }
                _ => {}
            },
        }
        for (desk, number, round) in team.waiting() {
            desks.push((number, desk));
            say("turn", number, round);
        }
        team.ended().into_iter().for_each(|(number, code)| say("end", number, code.into()));
    }
}

/// A word and two numbers.
fn read(words: &[String]) -> Option<(&str, usize, usize)> {
    let number = |k: usize| words.get(k).map_or(Some(0), |w| w.parse().ok());
    Some((words.first()?, number(1)?, number(2)?))
}

/// The rank of each partition: where threads of all partitions are as many as ranks, the rank at which its own begin, as under LAMMPS;
/// else one after the other.
fn places(threads: &[usize], ranks: usize) -> Vec<usize> {
    let fits = threads.iter().sum::<usize>() == ranks;
    let start = |number: usize| threads[..number].iter().sum::<usize>();
    (0..threads.len()).map(|number| if fits { start(number) } else { number % ranks }).collect()
}

/// Values of universe and uloop variables that no partition has taken yet.
struct Turns {
    /// The next one of each round.
    next: Vec<usize>,
    of: usize,
}

impl Turns {
    fn take(&mut self, round: usize) -> usize {
        // Those below `of` are where the partitions began.
        self.next.resize(self.next.len().max(round + 1), self.of);
        self.next[round] += 1;
        self.next[round] - 1
    }
}

/// The processes of this rank, and the socket where they request turns.
struct Team {
    path: PathBuf,
    listener: UnixListener,
    members: Vec<(usize, Child)>,
    /// For requests to end, which are passed on to them.
    known: Arc<Mutex<Vec<u32>>>,
}

impl Team {
    fn new() -> std::io::Result<Self> {
        let path = std::env::temp_dir().join(format!("perigrain.{}.turns", std::process::id()));
        // One that a killed process of this number has left.
        let _ = std::fs::remove_file(&path);
        let listener = UnixListener::bind(&path)?;
        listener.set_nonblocking(true)?;
        // Ctrl-C reaches the partitions too: they end at whole steps, and this process waits.
        let _ = ctrlc::set_handler(|| {});
        let known: Arc<Mutex<Vec<u32>>> = Arc::default();
        let all = known.clone();
        signals::listen(move || {
            processes::signal(&all.lock().unwrap_or_else(PoisonError::into_inner), "TERM")
        });
        Ok(Self { path, listener, members: vec![], known })
    }

    fn start(&mut self, number: usize) -> std::io::Result<()> {
        let child = Start { number, turns: &self.path }.spawn()?;
        self.known.lock().unwrap_or_else(PoisonError::into_inner).push(child.id());
        self.members.push((number, child));
        Ok(())
    }

    /// Partitions that wait for a turn, each with the round and the stream for the answer.
    fn waiting(&self) -> Vec<(UnixStream, usize, usize)> {
        let one = |mut desk: UnixStream| {
            let mut words = [0; 16];
            desk.set_nonblocking(false).and_then(|()| desk.read_exact(&mut words)).ok()?;
            let [number, round] = [0, 8]
                .map(|at| words[at..at + 8].iter().rev().fold(0, |n, byte| n << 8 | usize::from(*byte)));
            Some((desk, number, round))
        };
        std::iter::from_fn(|| self.listener.accept().ok()).filter_map(|(desk, _)| one(desk)).collect()
    }

    /// Those that have ended since the last look, with their exit codes.
    fn ended(&mut self) -> Vec<(usize, u8)> {
        let mut ended = vec![];
        self.members.retain_mut(|(number, child)| {
            let code = match child.try_wait() {
                Ok(None) => return true,
                Ok(Some(status)) => status.code().map_or(FAILED, |code| code.clamp(0, 255) as u8),
                Err(_) => FAILED,
            };
            ended.push((*number, code));
            false
        });
        ended
    }
}

impl Drop for Team {
    fn drop(&mut self) {
        for (_, child) in &mut self.members {
            // One that has ended by itself is no failure.
            let _ = child.kill().and_then(|()| child.wait());
        }
        let _ = std::fs::remove_file(&self.path);
    }
}

fn answer(mut desk: UnixStream, turn: usize) {
    // A partition that has ended meanwhile needs none.
    let _ = desk.write_all(&(turn as u64).to_le_bytes());
}

/// Requests the next turn of a round from this partition's rank.
pub fn request_turn(path: &Path, world: &World, round: u64) -> std::io::Result<usize> {
    let mut desk = UnixStream::connect(path)?;
    desk.write_all(&(world.number as u64).to_le_bytes())?;
    desk.write_all(&round.to_le_bytes())?;
    let mut turn = [0; 8];
    desk.read_exact(&mut turn)?;
    Ok(u64::from_le_bytes(turn) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn partitions_have_ranks() {
        assert_eq!(places(&[2, 2], 4), [0, 2], "as many threads as ranks");
        assert_eq!(places(&[1, 3, 1], 5), [0, 1, 4]);
        assert_eq!(places(&[1; 5], 2), [0, 1, 0, 1, 0]);
        assert_eq!(places(&[1, 1], 4), [0, 1], "more ranks than that");
    }

    #[test]
    fn each_turn_of_a_round_is_taken_once() {
        let mut turns = Turns { next: vec![], of: 3 };
        assert_eq!([1, 1, 0, 1, 0].map(|round| turns.take(round)), [3, 4, 3, 5, 4]);
    }
}
