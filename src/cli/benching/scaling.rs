//! `perigrain bench -scaling`: what this machine takes for a solid and a bed, and what many would.

use crate::bench::scaling::{KINDS, Kind, Machine, Measured, step, table};
use crate::cli::args::Usage;
use crate::cli::{OK, show};
use crate::sweep::starter::Starter;
use perigrain_base::{comm, memory};
use std::io::Write;
use std::process::Stdio;
use std::time::Duration;

/// The words of the forecast.
#[derive(Clone, Debug, PartialEq, clap::Parser)]
#[command(name = "perigrain bench")]
pub struct Wanted {
    /// Measure a solid and a bed here, and forecast them on many machines
    #[arg(long)]
    pub scaling: bool,
    /// Cores of each machine of the forecast
    #[arg(long, value_name = "N", default_value_t = 64)]
    pub cores: usize,
    /// Memory of each [GB] (what this machine has free)
    #[arg(long, value_name = "GB")]
    pub memory: Option<f64>,
    /// What each sends in a second [GB], as `mpirun perigrain ranks` measures it
    #[arg(long, value_name = "GB", default_value_t = 20.0)]
    pub bandwidth: f64,
    /// Time of a short message between them [us]
    #[arg(long, value_name = "US", default_value_t = 2.0)]
    pub latency: f64,
    /// Measure each N times, the least time counts
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub repeat: usize,
}

/// How often a run's memory is looked at.
const LOOK: Duration = Duration::from_millis(4);

/// Particles and machines of the forecast.
const SIZES: [f64; 4] = [1e6, 1e7, 1e8, 1e9];
const NODES: [usize; 5] = [1, 4, 16, 64, 1000];

/// Measures and forecasts; the exit code.
///
/// # Errors
/// Runs that fail, numbers that make no sense.
pub fn perform(wanted: &Wanted) -> Result<u8, Usage> {
    if wanted.cores == 0 || wanted.bandwidth <= 0.0 || wanted.latency < 0.0 || wanted.repeat == 0 {
        return Err(Usage::new("machines need cores and a bandwidth, and a time is at least 0"));
    }
    let own = std::thread::available_parallelism().map_or(1, usize::from);
    let (wires, (_, alone)) = (wires()?, output_of(&[], Some("units si\n"))?);
    show(&format!(
        "measured on {} with {own} core(s), the least of {}; forecast in brackets\n\n",
        comm::host(),
        wanted.repeat
    ));
    let heads = ["particles", "processor, ns", "2 threads", "2 ranks", "bytes"];
    show(&format!("{:<20}", "a step's particle"));
    show(&(heads.map(|h| format!("{h:>16}")).concat() + "\n"));
    let mut all = vec![];
    for kind in &KINDS {
        let one = run(kind, wanted.repeat, &["-threads", "1"])?;
        // Beside other programs a thread waits; its work takes as long.
        let work = one.processor;
        let threads = run(kind, wanted.repeat, &["-threads", "2"])?;
        let ranks = run(kind, wanted.repeat, &["-threads", "1", "-ranks", "2"])?;
        let [variable, value] = kind.large;
        let words = ["-threads", "1", "-var", variable, value, "-var", "warm", "0", "-var", "steps", "2"];
        let large = run(kind, 1, &words)?;
        // What the program needs without particles is not theirs.
        let bytes = (large.memory - alone).max(0.0) / large.particles;
        let measured = Measured { seconds: work, bytes };
        let times = |of: &Run, nodes: usize, machine: &Machine| {
            let forecast = step(kind, measured, one.particles, nodes, machine).unwrap_or(f64::NAN);
            let forecast = measured.seconds * one.particles / forecast;
            format!("{:.2} x ({forecast:.2})", one.seconds / of.seconds)
        };
        let here = |cores| Machine { cores, memory: f64::INFINITY, ..wires };
        let words = [
            format!("{:.0}", one.particles),
            format!("{:.1}", 1e9 * work),
            times(&threads, 1, &here(2)),
            times(&ranks, 2, &here(1)),
            format!("{bytes:.0}"),
        ];
        show(&format!("{:<20}{}\n", kind.name, words.map(|w| format!("{w:>16}")).concat()));
        all.push(measured);
    }
    let machine = Machine {
        cores: wanted.cores,
        bandwidth: 1e9 * wanted.bandwidth,
        latency: 1e-6 * wanted.latency,
        memory: wanted.memory.map_or_else(|| memory::room().unwrap_or(f64::INFINITY), |gb| 1e9 * gb),
    };
    show(&format!(
        "\nforecast: ms of a step (times as fast as one core here) on machines of {} cores and {:.0} GB, which\nsend {} GB/s \
         and a short message in {} us; one rank on each, whose memory holds all particles\n",
        machine.cores,
        machine.memory / 1e9,
        wanted.bandwidth,
        wanted.latency
    ));
    for (kind, measured) in KINDS.iter().zip(all) {
        show(&format!("\n{}\n{}", kind.name, table(kind, measured, &SIZES, &NODES, &machine)));
    }
    Ok(OK)
}

/// The measurements of a run of a kind's deck.
struct Run {
    particles: f64,
    /// Time of a step for each particle [s], on the wall and of the processor.
    seconds: f64,
    processor: f64,
    /// The most memory that the process had [byte].
    memory: f64,
}

/// The fastest of several runs under these switches.
fn run(kind: &Kind, repeat: usize, switches: &[&str]) -> Result<Run, Usage> {
    let once = || {
        let (text, memory) = output_of(switches, Some(kind.deck))?;
        read(&text, memory)
            .ok_or_else(|| Usage::new(format!("a run of `{}` does not report its time", kind.name)))
    };
    let runs: Result<Vec<Run>, Usage> = (0..repeat).map(|_| once()).collect();
    let fastest = runs?.into_iter().min_by(|a, b| a.seconds.total_cmp(&b.seconds));
    fastest.ok_or_else(|| Usage::new("nothing was measured"))
}

/// What this program prints under these words, with a deck on standard input if there is one, and the most memory that it had [byte].
fn output_of(words: &[&str], deck: Option<&str>) -> Result<(String, f64), Usage> {
    let failed = |e: &dyn std::fmt::Display| Usage::new(format!("a run cannot be made: {e}"));
    let mut command = Starter::itself().map_err(|e| failed(&e))?.command();
    comm::set_apart(&mut command);
    command.args(words).args(deck.map_or(&[][..], |_| &["-log", "none"]));
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().map_err(|e| failed(&e))?;
    if let (Some(mut pipe), Some(deck)) = (child.stdin.take(), deck) {
        // A process that does not read has failed, and prints why.
        let _ = pipe.write_all(deck.as_bytes());
    }
    let mut memory = 0.0;
    while child.try_wait().map_err(|e| failed(&e))?.is_none() {
        memory = f64::max(memory, most(child.id()).unwrap_or(0.0));
        std::thread::sleep(LOOK);
    }
    let o = child.wait_with_output().map_err(|e| failed(&e))?;
    match o.status.success() {
        true => Ok((String::from_utf8_lossy(&o.stdout).into_owned(), memory)),
        false => Err(failed(&String::from_utf8_lossy(&o.stderr).trim())),
    }
}

/// The peak memory of a process, where the system reports it [byte].
fn most(process: u32) -> Option<f64> {
    let text = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024.0 * line.split_whitespace().next()?.parse::<f64>().ok()?)
}

/// The last loop of a run with so much memory.
fn read(text: &str, memory: f64) -> Option<Run> {
    let last = text.lines().rfind(|line| line.starts_with("Loop time of "))?;
    let words: Vec<f64> = last.split_whitespace().map(|w| w.parse().unwrap_or(f64::NAN)).collect();
    let (time, steps, particles) = (*words.get(3)?, *words.get(8)?, *words.get(11)?);
    // The line behind it begins with the part of a processor that the process had.
    let used = text.lines().rev().find_map(|line| line.split_once("% CPU use"))?.0.trim();
    let seconds = time / (steps * particles);
    let run = Run { particles, seconds, processor: seconds * used.parse::<f64>().ok()? / 100.0, memory };
    run.seconds.is_finite().then_some(run)
}

/// What two ranks of this machine need for a message.
fn wires() -> Result<Machine, Usage> {
    let (text, _) = output_of(&["ranks", "-ranks", "2"], None)?;
    let microseconds = |of: &str| {
        let line = text.lines().find(|line| line.starts_with("exchange") && line.contains(of))?;
        line.split_whitespace().nth(1)?.parse::<f64>().ok()
    };
    let (Some(short), Some(long)) = (microseconds(" for 8 bytes"), microseconds(" for 1048576 bytes")) else {
        return Err(Usage::new("two ranks of this machine do not report their times"));
    };
    let bandwidth = f64::from(1 << 20) / (1e-6 * (long - short).max(1.0));
    Ok(Machine { cores: 1, bandwidth, latency: 1e-6 * short, memory: f64::INFINITY })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_has_times() {
        let log = "Loop time of 9 on 1 procs for 10 steps with 1000 atoms\n\
                   Loop time of 0.5 on 1 procs for 100 steps with 2000 atoms\n\n50.0% CPU use with 1 threads\n";
        let run = read(log, 7.0).unwrap();
        assert_eq!((run.particles, run.seconds, run.processor, run.memory), (2000.0, 2.5e-6, 1.25e-6, 7.0));
        assert!(read("Loop time\n", 0.0).is_none());
    }
}
