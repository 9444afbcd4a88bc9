//! Free memory as reported by the system: of the machine, within the process limits (`ulimit -v`, `prlimit`)
//! and of a container.

use std::fs::read_to_string;
use std::path::Path;

/// Bytes that can still be allocated, if the system reports them.
pub fn bytes() -> Option<f64> {
    [
        machine(),
        of_process("Max address space", "VmSize:"),
        of_process("Max data size", "VmData:"),
        container(),
    ]
    .into_iter()
    .flatten()
    .reduce(f64::min)
}

/// Bytes that all programs of the machine, or of this container, can still allocate together.
pub fn shared() -> Option<f64> {
    machine().into_iter().chain(container()).reduce(f64::min)
}

/// Bytes used by the program, if the system reports them.
pub fn resident() -> Option<f64> {
    kilobytes("/proc/self/status", "VmRSS:")
}

/// Free memory of the machine, including swap space.
fn machine() -> Option<f64> {
    let swap = kilobytes("/proc/meminfo", "SwapFree:").unwrap_or(0.0);
    Some(kilobytes("/proc/meminfo", "MemAvailable:")? + swap)
}

/// What a process limit leaves.
fn of_process(limit: &str, used: &str) -> Option<f64> {
    let text = read_to_string("/proc/self/limits").ok()?;
    let most =
        text.lines().find_map(|l| l.strip_prefix(limit))?.split_whitespace().next()?.parse::<f64>().ok()?;
    Some((most - kilobytes("/proc/self/status", used)?).max(0.0))
}

/// What the tightest control group around this process leaves (cgroups v2).
fn container() -> Option<f64> {
    let text = read_to_string("/proc/self/cgroup").ok()?;
    let own = text.lines().find_map(|l| l.strip_prefix("0::/"))?;
    let root = Path::new("/sys/fs/cgroup");
    let group = root.join(own);
    group.ancestors().take_while(|folder| folder.starts_with(root)).filter_map(left_in).reduce(f64::min)
}

/// What a control group may still allocate; cached files count as free.
fn left_in(folder: &Path) -> Option<f64> {
    let number = |file: &str| read_to_string(folder.join(file)).ok()?.trim().parse::<f64>().ok();
    let most = number("memory.max")?;
    let text = read_to_string(folder.join("memory.stat")).unwrap_or_default();
    let of = |name: &str| {
        text.lines().find_map(|l| l.strip_prefix(name)?.trim().parse::<f64>().ok()).unwrap_or(0.0)
    };
    let files = of("active_file ") + of("inactive_file ");
    Some((most - number("memory.current")? + files).max(0.0))
}

/// A number of kilobytes after a name, in bytes.
fn kilobytes(file: &str, name: &str) -> Option<f64> {
    let text = read_to_string(file).ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix(name))?;
    let kilobytes: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes * 1024.0)
}
