//! Ranks as workers: the first one hands runs out, the others have them made on their machines, and both write each other letters.

use super::PAUSE;
use super::hands::{Hands, Order};
use super::outcome::Outcome;
use super::record::{join, split};
use super::starter::Starter;
use super::worker::Task;
use perigrain_base::comm::{self, Comm, Gone};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How often a rank reports its state.
const BEAT: Duration = Duration::from_secs(1);
/// How long a file that the first rank has written may take to be seen on another machine.
const SEEN: Duration = Duration::from_secs(10);
/// How long ranks wait for the others' last letters.
const FAREWELL: Duration = Duration::from_secs(60);

/// Ranks that share out work which needs no messages while it is under way.
#[derive(Clone)]
pub struct Ranks {
    comm: Arc<dyn Comm>,
    hosts: Arc<[String]>,
    cores: Arc<[usize]>,
}

impl std::fmt::Debug for Ranks {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "rank {} of {}", self.comm.rank(), self.describe())
    }
}

impl Ranks {
    /// Ranks with the machine of each and its share of the machine's cores.
    pub fn new(comm: Arc<dyn Comm>, hosts: Vec<String>, cores: Vec<usize>) -> Self {
        Self { comm, hosts: hosts.into(), cores: cores.into() }
    }

    /// This rank.
    pub fn own(&self) -> usize {
        self.comm.rank()
    }

    /// How many there are.
    pub fn size(&self) -> usize {
        self.hosts.len()
    }

    /// A rank's share of the cores of its machine.
    pub fn cores(&self, rank: usize) -> usize {
        self.cores[rank].max(1)
    }

    /// `4 ranks on 2 hosts`.
    pub fn describe(&self) -> String {
        comm::describe(&self.hosts)
    }

    /// `rank 2 on node7`.
    pub fn name(&self, rank: usize) -> String {
        format!("rank {rank} on {}", self.hosts[rank])
    }

    /// Writes to another rank.
    pub fn send(&self, to: usize, words: &[String]) {
        self.comm.post(to, join(words).as_bytes());
    }

    /// What another rank has written, if anything has come.
    ///
    /// # Errors
    /// It has ended.
    pub fn hear(&self, from: usize) -> Result<Option<Vec<String>>, Gone> {
        let letter = self.comm.letter(from)?;
        Ok(letter.map(|bytes| split(&String::from_utf8_lossy(&bytes))))
    }

    /// The first rank sends the others home with the program's exit code; whether all were there to hear it.
    pub fn dismiss(&self, code: u8) -> bool {
        (1..self.size()).for_each(|to| self.send(to, &["bye".into(), code.to_string()]));
        let mut there: Vec<usize> = (1..self.size()).collect();
        let (end, mut all) = (Instant::now() + FAREWELL, true);
        while !there.is_empty() && Instant::now() < end {
            there.retain(|from| match self.hear(*from) {
                // Other messages come too late.
                Ok(letter) => letter.is_none_or(|letter| letter[0] != "bye"),
                Err(Gone) => {
                    all = false;
                    false
                }
            });
            std::thread::sleep(PAUSE);
        }
        all && there.is_empty()
    }

    /// A dismissed rank says good-bye, and waits until that has been sent.
    pub fn leave(&self) {
        self.send(0, &["bye".into()]);
        let end = Instant::now() + FAREWELL;
        while !self.comm.posted() && Instant::now() < end {
            std::thread::sleep(PAUSE);
        }
    }

    /// What follows on any other rank from the end of the first one.
    pub fn orphaned(&self) -> u8 {
        eprintln!(
            "error: {}: rank 0 on {} has ended without a message",
            self.name(self.own()),
            self.hosts[0]
        );
        1
    }
}

/// What the first rank and the others write each other about runs.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Letter {
    /// To others: make this run.
    Begin(Box<Order>),
    /// To others: end all runs.
    Stop,
    /// To the first: all runs are ended.
    Stopped,
    /// To the first: what became of a run.
    End(usize, Box<Outcome>),
    /// To the first: what is under way, each with steps made and steps of its present `run`.
    At(Vec<(usize, i64, i64)>),
    /// To the first: a request from outside to end the sweep.
    EndRequested,
    /// To the first: the sweep's folder is not there on this machine.
    Blind,
}

impl Letter {
    pub fn words(&self) -> Vec<String> {
        let word = |w: &str| vec![w.to_owned()];
        match self {
            Self::Begin(order) => vec![
                "begin".into(),
                order.job.to_string(),
                order.home.display().to_string(),
                order.task.settings.lammps.as_ref().map_or(String::new(), |l| l.display().to_string()),
                order.task.text(),
            ],
            Self::End(job, outcome) => vec!["end".into(), job.to_string(), join(&outcome.fields())],
            Self::At(all) => {
                let numbers = all.iter().flat_map(|(job, done, of)| [*job as i64, *done, *of]);
                word("at").into_iter().chain(numbers.map(|n| n.to_string())).collect()
            }
            Self::Stop => word("stop"),
            Self::Stopped => word("stopped"),
            Self::EndRequested => word("asked"),
            Self::Blind => word("blind"),
        }
    }

    pub fn read(words: &[String]) -> Option<Self> {
        let (first, rest) = words.split_first()?;
        let number = |k: usize| rest.get(k)?.parse::<i64>().ok();
        Some(match (first.as_str(), rest) {
            ("begin", [_, home, lammps, task]) => {
                let mut task = Task::read(task)?;
                task.settings.lammps = (!lammps.is_empty()).then(|| lammps.into());
                Self::Begin(Box::new(Order { job: number(0)? as usize, home: home.into(), task }))
            }
            ("end", [_, outcome]) => {
                Self::End(number(0)? as usize, Box::new(Outcome::read(&split(outcome))?))
            }
            ("at", _) => {
                let three =
                    |k: usize| Some((number(3 * k)? as usize, number(3 * k + 1)?, number(3 * k + 2)?));
                Self::At((0..rest.len() / 3).map_while(three).collect())
            }
            ("stop", _) => Self::Stop,
            ("stopped", _) => Self::Stopped,
            ("asked", _) => Self::EndRequested,
            ("blind", _) => Self::Blind,
            _ => return None,
        })
    }
}

/// Makes the first rank's runs until it dismisses this one; the program's exit code.
pub fn serve(ranks: &Ranks, stop: &AtomicBool) -> u8 {
    let program = match Starter::itself() {
        Ok(program) => program,
        Err(e) => {
            eprintln!("error: {}: the program does not find itself: {e}", ranks.name(ranks.own()));
            Starter::default()
        }
    };
    let (mut hands, mut beat) = (Hands::default(), Instant::now());
    let say = |letter: Letter| ranks.send(0, &letter.words());
    loop {
        let words = match ranks.hear(0) {
            Ok(words) => words,
            Err(Gone) => {
                hands.stop();
                return ranks.orphaned();
            }
        };
        if let Some(["bye", code]) = words.as_deref().map(|w| [0, 1].map(|k| w.get(k).map_or("", |w| w))) {
            hands.stop();
            ranks.leave();
            return code.parse().unwrap_or(1);
        }
        let idle = words.is_none();
        match words.as_deref().and_then(Letter::read) {
            Some(Letter::Begin(order)) if is_there(&order.task.deck) => begin(&mut hands, &program, *order),
            Some(Letter::Begin(_)) => say(Letter::Blind),
            Some(Letter::Stop) => {
                hands.stop();
                say(Letter::Stopped);
            }
            _ => {}
        }
        for (job, outcome) in hands.ended() {
            say(Letter::End(job, Box::new(outcome)));
        }
        if stop.swap(false, Ordering::Relaxed) {
            say(Letter::EndRequested);
        }
        if beat.elapsed() > BEAT && hands.count() > 0 {
            let at = |r: super::Running| r.steps.map_or((r.job, 0, 0), |(done, of)| (r.job, done, of));
            say(Letter::At(hands.running().into_iter().map(at).collect()));
            beat = Instant::now();
        }
        if idle {
            std::thread::sleep(PAUSE);
        }
    }
}

/// The run ends with this process, which waits for it.
fn begin(hands: &mut Hands, program: &Starter, mut order: Order) {
    order.task.parent = std::process::id();
    hands.begin(program, order);
}

/// Whether a file of the first rank's is seen here too, at once or after a while.
fn is_there(file: &Path) -> bool {
    let begin = Instant::now();
    while !file.exists() {
        if begin.elapsed() > SEEN {
            return false;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    true
}

#[cfg(test)]
mod tests {
    use super::super::Settings;
    use super::*;

    #[test]
    fn letters_come_as_they_were_written() {
        let settings = Settings { lammps: Some("/opt/a b/lmp".into()), ..Settings::default() };
        let task = Task {
            print: "p-1".into(),
            name: "in.x".into(),
            deck: "/d/deck".into(),
            folder: "/e".into(),
            settings,
            report: vec!["c_1".into(), "a\tb".into()],
            threads: 3,
            parent: 7,
            lock: "/d/.workers".into(),
            reports_progress: false,
        };
        let outcome = Outcome { problem: Some("in.x:3: no\ttab\n".into()), steps: 7, ..Outcome::default() };
        for letter in [
            Letter::Begin(Box::new(Order { job: 4, home: "/d/0005-v=1".into(), task })),
            Letter::End(2, Box::new(outcome)),
            Letter::At(vec![(3, 10, 100), (8, 0, 0)]),
            Letter::At(vec![]),
            Letter::Stop,
            Letter::Stopped,
            Letter::EndRequested,
            Letter::Blind,
        ] {
            assert_eq!(Letter::read(&split(&join(&letter.words()))), Some(letter));
        }
        assert_eq!(Letter::read(&["bye".into(), "0".into()]), None);
        assert_eq!(Letter::read(&[]), None);
    }
}
