//! The processes that make the runs: those of this machine, and those of other ranks on theirs.

use super::hands::{Hands, Order};
use super::ranks::{Letter, Ranks};
use super::{Outcome, PAUSE, Running, Sweep};
use perigrain_base::comm::Gone;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result};
use std::time::{Duration, Instant};

/// How long a rank may be silent while it makes runs before that is reported.
const SILENCE: Duration = Duration::from_secs(60);
/// How long other ranks may take to end their runs.
const ENDING: Duration = Duration::from_secs(10);

/// Those at work. Without ranks there is one post, this process.
pub(super) struct Crew {
    ranks: Option<Ranks>,
    own: Hands,
    /// By rank.
    posts: Vec<Post>,
    /// Another rank has received a request to end.
    pub end_requested: bool,
}

/// What a rank has under way.
struct Post {
    /// How many runs at once, and threads of each.
    places: usize,
    threads: usize,
    /// Runs that another rank makes.
    jobs: Vec<Away>,
    /// When it was heard last, and whether its silence has been reported.
    heard: Instant,
    missed: bool,
}

struct Away {
    job: usize,
    since: Instant,
    steps: Option<(i64, i64)>,
}

impl Crew {
    /// For so many runs.
    pub fn new(sweep: &Sweep, runs: usize) -> Self {
        let post = |cores: usize, runs: usize| {
            let at_once = if sweep.at_once == 0 { cores } else { sweep.at_once }.min(runs).max(1);
            let threads = if sweep.threads == 0 { (cores / at_once).max(1) } else { sweep.threads };
            Post { places: at_once, threads, jobs: vec![], heard: Instant::now(), missed: false }
        };
        let ranks = sweep.ranks.clone();
        let posts = match &ranks {
            None => {
                vec![post(std::thread::available_parallelism().map_or(1, usize::from), runs)]
            }
            Some(ranks) => {
                let each = runs.div_ceil(ranks.size());
                (0..ranks.size()).map(|rank| post(ranks.cores(rank), each)).collect()
            }
        };
        Self { ranks, own: Hands::default(), posts, end_requested: false }
    }

    /// How many runs are made at once.
    pub fn places(&self) -> usize {
        self.posts.iter().map(|post| post.places).sum()
    }

    fn free(&self, rank: usize) -> usize {
        let post = &self.posts[rank];
        post.places.saturating_sub(if rank == 0 { self.own.count() } else { post.jobs.len() })
    }

    /// The rank with most room for a run, if any has some.
    pub fn room(&self) -> Option<usize> {
        let rank = (0..self.posts.len()).rev().max_by_key(|rank| self.free(*rank))?;
        (self.free(rank) > 0).then_some(rank)
    }

    pub fn is_idle(&self) -> bool {
        self.own.count() == 0 && self.posts.iter().all(|post| post.jobs.is_empty())
    }

    /// Threads of a run at a rank.
    pub fn threads(&self, rank: usize) -> usize {
        self.posts[rank].threads
    }

    /// The journal's name for the place where a run is made, unless it is obvious.
    pub fn name(&self, rank: usize) -> Option<String> {
        self.ranks.as_ref().map(|ranks| ranks.name(rank))
    }

    /// A run cannot be begun.
    pub fn failed(&mut self, job: usize, why: String) {
        self.own.failed(job, why);
    }

    /// Has a run made at a rank that has room for it.
    pub fn begin(&mut self, rank: usize, sweep: &Sweep, order: Order) {
        match &self.ranks {
            Some(ranks) if rank > 0 => {
                self.posts[rank].jobs.push(Away { job: order.job, since: Instant::now(), steps: None });
                self.posts[rank].heard = Instant::now();
                ranks.send(rank, &Letter::Begin(Box::new(order)).words());
            }
            _ => self.own.begin(&sweep.program, order),
        }
    }

    /// Runs that have ended since the last look, and notes of what is amiss.
    ///
    /// # Errors
    /// A rank that has ended, one that does not see the sweep's folder.
    pub fn ended(&mut self, sweep: &Sweep, notes: &mut Diagnostics) -> Result<Vec<(usize, Outcome)>> {
        let mut ended = self.own.ended();
        let Some(ranks) = self.ranks.clone() else { return Ok(ended) };
        for rank in 1..self.posts.len() {
            while let Some(words) = ranks.hear(rank).map_err(|Gone| self.lost(&ranks, rank, sweep))? {
                let post = &mut self.posts[rank];
                (post.heard, post.missed) = (Instant::now(), false);
                match Letter::read(&words) {
                    Some(Letter::End(job, outcome)) => {
                        let known = post.jobs.len();
                        post.jobs.retain(|away| away.job != job);
                        // Of an earlier sweep that was stopped there may be a last word.
                        ended.extend((post.jobs.len() < known).then_some((job, *outcome)));
                    }
                    Some(Letter::At(all)) => {
                        for (job, done, of) in all.into_iter().filter(|(_, _, of)| *of > 0) {
                            let away = post.jobs.iter_mut().filter(|away| away.job == job);
                            away.for_each(|away| away.steps = Some((done, of)));
                        }
                    }
                    Some(Letter::EndRequested) => self.end_requested = true,
                    Some(Letter::Blind) => return Err(blind(&ranks, rank, sweep)),
                    _ => {}
                }
            }
            let post = &mut self.posts[rank];
            if !post.jobs.is_empty() && !post.missed && post.heard.elapsed() > SILENCE {
                post.missed = true;
                notes.push(self.silent(&ranks, rank, sweep));
            }
        }
        Ok(ended)
    }

    /// The runs that a rank makes, in words.
    fn making(&self, rank: usize, sweep: &Sweep) -> String {
        let one = |away: &Away| match sweep.jobs[away.job].title() {
            title if title.is_empty() => format!("run {}", away.job + 1),
            title => format!("run {} ({title})", away.job + 1),
        };
        let all: Vec<String> = self.posts[rank].jobs.iter().map(one).collect();
        if all.is_empty() { "no run".into() } else { all.join(", ") }
    }

    fn lost(&self, ranks: &Ranks, rank: usize, sweep: &Sweep) -> Diagnostics {
        let making = self.making(rank, sweep);
        let text = format!("{} has ended without a message; it was making {making}", ranks.name(rank));
        let d = Diagnostic::error(Code::OTHER_SWEEP, None, text);
        d.help("what is done is kept: run the same command again, on any number of ranks, to make the rest")
            .into()
    }

    fn silent(&self, ranks: &Ranks, rank: usize, sweep: &Sweep) -> Diagnostic {
        let (seconds, making) = (SILENCE.as_secs(), self.making(rank, sweep));
        let text = format!("{} has not reported for {seconds} s; it is making {making}", ranks.name(rank));
        let d = Diagnostic::warning(Code::SUSPICIOUS, None, text);
        d.help(
            "where its machine is gone, end the sweep and run the same command again: it makes what is left",
        )
    }

    /// The runs under way.
    pub fn running(&self) -> Vec<Running> {
        let look = |away: &Away| Running { job: away.job, since: away.since.elapsed(), steps: away.steps };
        let away = self.posts.iter().flat_map(|post| post.jobs.iter().map(look));
        self.own.running().into_iter().chain(away).collect()
    }

    /// Ends all of them at once, and waits until they have ended.
    pub fn stop(&mut self) {
        self.own.stop();
        let Some(ranks) = &self.ranks else { return };
        let mut busy: Vec<usize> =
            (1..self.posts.len()).filter(|rank| !self.posts[*rank].jobs.is_empty()).collect();
        busy.iter().for_each(|rank| ranks.send(*rank, &Letter::Stop.words()));
        let begin = Instant::now();
        while !busy.is_empty() && begin.elapsed() < ENDING {
            busy.retain(|rank| match ranks.hear(*rank) {
                Ok(words) => words.is_none_or(|words| Letter::read(&words) != Some(Letter::Stopped)),
                Err(Gone) => false,
            });
            std::thread::sleep(PAUSE);
        }
        self.posts.iter_mut().for_each(|post| post.jobs.clear());
    }
}

impl Drop for Crew {
    fn drop(&mut self) {
        self.stop();
    }
}

fn blind(ranks: &Ranks, rank: usize, sweep: &Sweep) -> Diagnostics {
    let text = format!("{} does not see the sweep's folder `{}`", ranks.name(rank), sweep.folder.display());
    let d = Diagnostic::error(Code::NO_FILE, None, text);
    d.help("all hosts need it: begin in a folder that they share, or put it on one with `-out DIR`").into()
}
