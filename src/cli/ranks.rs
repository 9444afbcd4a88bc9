//! Several ranks: how they are joined, agree that they run the same, and end together.

use super::args::{Options, Target, Usage};
use super::{FAILED, OK, USAGE, deck};
use crate::session::Mode;
use crate::sweep::ranks::Ranks;
use crate::sweep::starter::{self, Starter};
use perigrain_base::comm::{self, Comm, Launched, launched};
use perigrain_base::math::form::Form;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How long a rank that has failed waits for the others to come to the same end.
const FAILING: Duration = Duration::from_secs(8);

/// The same for one that has not: the others' work is as much, on processors that may be slower.
const DONE: Duration = Duration::from_secs(600);

/// More ranks than this on one machine are a slip of the finger.
pub(super) const MOST: usize = 256;

/// The output that a rank other than the first would have printed, shown if it ends alone.
static KEPT: Mutex<String> = Mutex::new(String::new());

/// Runs a deck, as one of several ranks where there are several.
///
/// # Errors
/// Ranks that cannot be joined.
pub(super) fn execute(o: &Options, mode: Mode) -> Result<u8, Usage> {
    match join(o)? {
        None => Ok(deck::execute(o, mode)),
        Some(ranks) => comm::run_as(ranks.clone(), || together(&*ranks, o, mode)),
    }
}

/// Does the first rank's work, which gives parts of it to the others, and theirs, which is to wait for that; the exit code. Where there is
/// one process, it does all of it.
///
/// # Errors
/// Ranks that cannot be joined, and what the first rank's work ends with.
pub(super) fn shared_out(
    o: &Options,
    first: impl FnOnce(Option<Ranks>) -> Result<u8, Usage>,
    others: impl FnOnce(&Ranks) -> u8,
) -> Result<u8, Usage> {
    let Some(comm) = join(o)? else { return first(None) };
    let nodes = comm::nodes(&*comm);
    if let Some(usage) = comm::run_as(comm.clone(), || differs(&*comm, &nodes)) {
        return Ok(unlike(&*comm, &usage));
    }
    let me = comm.rank();
    let mut cores = vec![0i64; nodes.len()];
    cores[me] = share_of_cores(&nodes, me) as i64;
    comm.sum(&mut cores);
    let cores = cores.into_iter().map(|n| n as usize).collect();
    let ranks = Ranks::new(comm.clone(), nodes.clone(), cores);
    if me > 0 {
        let code = others(&ranks);
        // All ranks have the first one's code, and end with it.
        if comm.meet(DONE) {
            comm.close();
        }
        return Ok(code);
    }
    let outcome = first(Some(ranks.clone()));
    let code = *outcome.as_ref().unwrap_or(&USAGE);
    if !ranks.dismiss(code) || !comm.meet(DONE) {
        // One that is not there has been named.
        comm.abort(i32::from(if code == OK { FAILED } else { code }));
    }
    comm.close();
    outcome
}

/// What a launcher has started and only one process can do.
///
/// # Errors
/// There is such a launcher.
pub(super) fn refuse(what: &str) -> Result<(), Usage> {
    let Some(by) = launched() else { return Ok(()) };
    let usage = Usage::new(format!("{} has started {} processes, and {what}", by.by, by.size));
    Err(usage.help(
        "decks, sweeps and benches run on several ranks: `mpirun -n 4 perigrain -in DECK`; all else runs without mpirun, or \
         each by itself with `PERIGRAIN_MPI=none`",
    ))
}

/// Whether this process prints what is wrong with a command line: one of several is enough.
pub(super) fn speaks() -> bool {
    launched().is_none_or(|by| by.rank == 0) && !is_seated()
}

/// Whether another process of this program has started this one as a rank.
#[cfg(unix)]
fn is_seated() -> bool {
    comm::Seat::given().is_some()
}

/// Ranks of one machine need sockets of Unix.
#[cfg(not(unix))]
fn is_seated() -> bool {
    false
}

/// The ranks that this process is one of, if there are several.
///
/// # Errors
/// Ranks that cannot be started or joined.
fn join(o: &Options) -> Result<Option<Arc<dyn Comm>>, Usage> {
    if let Some(ranks) = local(o)? {
        return Ok(Some(ranks));
    }
    let Some(by) = launched() else { return Ok(None) };
    comm::open(&by).map(Some).map_err(|why| unjoined(&by, &why))
}

/// Ranks that the first one starts by itself (`-ranks N`).
#[cfg(unix)]
fn local(o: &Options) -> Result<Option<Arc<dyn Comm>>, Usage> {
    if let Some(seat) = comm::Seat::given() {
        return seat
            .take()
            .map(|ranks| Some(Arc::new(ranks) as Arc<dyn Comm>))
            .map_err(|why| Usage::new(why.to_string()));
    }
    let Some(size) = o.ranks.filter(|n| *n > 1) else { return Ok(None) };
    refuse("`-ranks` would start more of them")?;
    let failed = |e: std::io::Error| Usage::new(format!("{size} ranks cannot be started: {e}"));
    let program = Starter::itself().map_err(failed)?;
    let ranks = comm::Local::start(size, || {
        let mut command = program.command();
        command.args(starter::words());
        command
    });
    Ok(Some(Arc::new(ranks.map_err(failed)?)))
}

#[cfg(not(unix))]
fn local(o: &Options) -> Result<Option<Arc<dyn Comm>>, Usage> {
    match o.ranks.filter(|n| *n > 1) {
        None => Ok(None),
        Some(_) => {
            Err(Usage::new("`-ranks` starts processes on Unix alone").help("`-threads N` uses more cores"))
        }
    }
}

/// The launcher's processes find no way to each other.
fn unjoined(by: &Launched, why: &comm::Error) -> Usage {
    let (host, rank, size) = (comm::host(), by.rank, by.size);
    if rank > 0 {
        // The first rank prints it for all; if only that rank has a library, this one does.
        std::thread::sleep(Duration::from_secs(1));
        eprintln!("error: rank {rank} of {size} on {host} cannot join the others: {why}");
    }
    let usage =
        Usage::new(format!("{} has started {size} processes, which cannot join on {host}: {why}", by.by));
    usage.help(
        "install the MPI library of this launcher there, or name it: `PERIGRAIN_MPI=/path/to/libmpi.so`; with \
         `PERIGRAIN_MPI=none` each process runs the whole deck by itself",
    )
}

/// Runs the deck together with the others; the exit code.
fn together(ranks: &dyn Comm, o: &Options, mode: Mode) -> Result<u8, Usage> {
    let mut o = o.clone();
    let nodes = comm::nodes(ranks);
    if let Some(usage) = differs(ranks, &nodes) {
        return Ok(unlike(ranks, &usage));
    }
    let mut plain = [f64::from(u8::from(o.portable || Form::here() == Form::Plain))];
    ranks.most(&mut plain);
    o.portable |= plain[0] > 0.0 && Form::here() != Form::Plain;
    o.threads = o.threads.or_else(deck::openmp_threads_allowed);
    o.threads = o.threads.or_else(|| Some(share_of_cores(&nodes, ranks.rank())));
    if ranks.rank() > 0 {
        // The first rank shows everything.
        (o.screen, o.report, o.view) = (Target::None, None, None);
    }
    let code = deck::execute(&o, mode);
    end(ranks, &nodes, code);
    Ok(code)
}

/// Ends ranks that are not alike; the exit code. The first one prints the reason before any of them ends: launchers then end all
/// others, and their last output is lost.
fn unlike(ranks: &dyn Comm, usage: &Usage) -> u8 {
    if ranks.rank() == 0 {
        super::complain(usage);
    }
    ranks.meet(FAILING);
    ranks.close();
    USAGE
}

/// All ranks end at the same place, or are ended.
fn end(ranks: &dyn Comm, nodes: &[String], code: u8) {
    let failed = code != OK;
    if ranks.meet(if failed { FAILING } else { DONE }) {
        return ranks.close();
    }
    let kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    let me = ranks.rank();
    let waited =
        if failed { "has failed, and the others have not" } else { "is done, and the others are not" };
    eprintln!("error: rank {me} on {} {waited}: all ranks end\n{kept}", nodes[me]);
    ranks.abort(i32::from(if code == OK { FAILED } else { code }))
}

/// Keeps what would be printed by the first rank.
pub(super) fn keep(text: &str) {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner).push_str(text);
}

/// What is wrong where ranks are not alike: another program, other words.
fn differs(ranks: &dyn Comm, nodes: &[String]) -> Option<Usage> {
    let words: Vec<String> = starter::words().iter().map(|w| w.to_string_lossy().into_owned()).collect();
    let own = [build(), words.join(" ")];
    let mut odd = vec![0i64; 2 * ranks.size()];
    for (k, text) in own.iter().enumerate() {
        let first = comm::broadcast::bytes(|| text.clone().into_bytes());
        odd[2 * ranks.rank() + k] = i64::from(first != text.as_bytes());
    }
    ranks.sum(&mut odd);
    let (rank, what) = odd.iter().position(|o| *o != 0).map(|at| (at / 2, at % 2))?;
    let what = ["is another build of perigrain", "was started with other words"][what];
    let usage = Usage::new(format!("rank {rank} on {} {what} than rank 0 on {}", nodes[rank], nodes[0]));
    Some(
        usage.help(
            "all ranks run one program with one command line; its file has to be the same on all hosts",
        ),
    )
}

/// Version and digest of this program.
fn build() -> String {
    let digest = std::env::current_exe().and_then(std::fs::read).map(|bytes| crc32fast::hash(&bytes));
    format!("{} {:08x}", env!("CARGO_PKG_VERSION"), digest.unwrap_or(0))
}

/// A rank's share of the cores of its machine, as far as the launcher has not dealt them out.
fn share_of_cores(nodes: &[String], rank: usize) -> usize {
    let granted = std::thread::available_parallelism().map_or(1, usize::from);
    let all = cores().max(granted);
    let beside = nodes.iter().filter(|n| **n == nodes[rank]).count();
    if granted < all { granted } else { (all / beside).max(1) }
}

/// Cores of this machine, also those that this process may not use; 0 where the system does not list them.
fn cores() -> usize {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    text.lines().filter(|line| line.starts_with("processor")).count()
}

/// The ranks in the log's first line: nothing where there is one process.
pub(super) fn describe() -> String {
    if !comm::several() {
        return String::new();
    }
    format!("{} of ", comm::describe(&comm::nodes(&*comm::present())))
}

/// `perigrain ranks`: what the ranks are connected by, and how fast.
///
/// # Errors
/// Ranks that cannot be joined.
pub(super) fn show(o: &Options) -> Result<u8, Usage> {
    let Some(ranks) = join(o)? else {
        super::show(
            "one process: start it by `mpirun -n 2 perigrain ranks`, or `perigrain ranks -ranks 2`\n",
        );
        return Ok(OK);
    };
    comm::run_as(ranks.clone(), || {
        let nodes = comm::nodes(&*ranks);
        let mut text = format!("library    {}\nranks      {}\n", ranks.library(), comm::describe(&nodes));
        text += &format!("threads    {} of each rank\n", share_of_cores(&nodes, ranks.rank()));
        text += &format!("sum        {:.1} us for 8 numbers\n", 1e6 * timed(500, || ranks.sum(&mut [1; 8])));
        for (bytes, turns) in [(8, 1000), (64 << 10, 200), (1 << 20, 40)] {
            let seconds = exchange(&*ranks, bytes, turns);
            let speed = bytes as f64 / seconds / 1e9;
            text += &format!(
                "exchange   {:.1} us for {bytes} bytes there and back at once, {speed:.2} GB/s\n",
                1e6 * seconds
            );
        }
        if ranks.rank() == 0 {
            super::show(&text);
        }
        end(&*ranks, &nodes, OK);
        Ok(OK)
    })
}

/// Seconds that one of many turns takes.
fn timed(turns: u32, mut act: impl FnMut()) -> f64 {
    act();
    let begin = Instant::now();
    (0..turns).for_each(|_| act());
    begin.elapsed().as_secs_f64() / f64::from(turns)
}

/// Each rank sends so many bytes to the next one and gets as many from the one before: seconds.
fn exchange(ranks: &dyn Comm, bytes: usize, turns: u32) -> f64 {
    let (me, n) = (ranks.rank(), ranks.size());
    let (out, mut came) = (vec![me as u8; bytes], vec![0; bytes]);
    timed(turns, || ranks.swap(&[((me + 1) % n, &out)], &mut [((me + n - 1) % n, &mut came)]))
}
