//! Other processes: those that one has started, and signals to them.

use std::process::Command;

/// The processes that a process has started, and those that these have, where the system lists them: a shell that ends leaves its commands
/// running.
pub fn descendants(process: u32) -> Vec<u32> {
    let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    let known = entries.filter_map(|entry| {
        let own: u32 = entry.file_name().to_str()?.parse().ok()?;
        let text = std::fs::read_to_string(entry.path().join("stat")).ok()?;
        // Behind the name, which stands in brackets and may have blanks: the state, and the parent.
        let parent = text.rsplit_once(')')?.1.split_whitespace().nth(1)?.parse().ok()?;
        Some((own, parent))
    });
    let known: Vec<(u32, u32)> = known.collect();
    let (mut found, mut looked) = (vec![process], 0);
    while let Some(parent) = found.get(looked).copied() {
        found.extend(known.iter().filter(|(_, of)| *of == parent).map(|(own, _)| *own));
        looked += 1;
    }
    found.split_off(1)
}

/// Sends a signal, by its name without `SIG`, to processes; those that are gone need none. Where there are no signals nothing is done.
pub fn signal(processes: &[u32], name: &str) {
    if cfg!(unix) && !processes.is_empty() {
        let words: Vec<String> = processes.iter().map(u32::to_string).collect();
        let line = format!("kill -{name} {} 2>/dev/null", words.join(" "));
        let _ = Command::new("sh").args(["-c", &line]).status();
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn what_a_shell_has_started_is_found_and_ends() {
        let mut shell = Command::new("sh").args(["-c", "(sleep 86414; true); true"]).spawn().unwrap();
        let end = std::time::Instant::now() + std::time::Duration::from_secs(20);
        // The shell, a shell within it, and the command that this one runs.
        let below = loop {
            let below = descendants(shell.id());
            if below.len() == 2 || std::time::Instant::now() > end {
                break below;
            }
            std::thread::yield_now();
        };
        assert_eq!(below.len(), 2);
        signal(&below, "KILL");
        assert!(shell.wait().unwrap().success());
        assert!(descendants(shell.id()).is_empty());
    }
}
