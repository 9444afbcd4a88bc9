//! Ctrl-C on a terminal, once and twice, in a run and while a scene is built.
#![cfg(unix)]

use super::pty::{GRAINS, start};
use std::thread::sleep;
use std::time::Duration;

/// The deck, and behind it the exit code.
const WITH_CODE: &str = "in.deck -threads 1; echo code $?";

/// Many particles are placed one by one, which takes a while.
fn slow(particles: usize) -> String {
    format!("{GRAINS}create_atoms 1 random {particles} 4711 NULL overlap 0.001 maxtry 1000\n")
}

/// One step of a million short ones, which is given two seconds to end.
fn stubborn() -> String {
    format!("{GRAINS}timestep 1e-12\nrun_style respa 2 1000000\nrun 1\n")
}

#[test]
fn the_first_ends_a_run_at_a_whole_step_and_the_deck() {
    let folder = tempfile::tempdir().unwrap();
    let deck = format!("{GRAINS}thermo 0\nrun 1000000000\nprint \"then $(step)\"\nrun 10\n");
    let mut p = start(folder.path(), 100, &deck, WITH_CODE, &[]);
    p.exp_string(" left  step ").unwrap();
    p.send_control('c').unwrap();
    let text = p.exp_eof().unwrap();
    // What the terminal shows of the key does not stay behind the live line.
    let (_, behind) = text.split_once("^C").unwrap_or_else(|| panic!("{text}"));
    assert!(behind.starts_with("\r\x1b[2K"), "{text}");
    let lines: Vec<&str> = text.lines().map(|l| l.rsplit("\x1b[2K").next().unwrap_or(l)).collect();
    let notice = lines.iter().position(|l| l.starts_with("Interrupted at step ")).unwrap();
    assert!(lines[..notice].iter().any(|l| l.contains(" steps in ") && l.contains(" steps/s, ")), "{text}");
    assert!(!text.contains("\nthen ") && text.ends_with("code 130\r\n"), "{text}");
}

#[test]
fn one_while_a_scene_is_built_is_confirmed() {
    let folder = tempfile::tempdir().unwrap();
    let mut p = start(folder.path(), 100, &(slow(8000) + "print \"then\"\n"), WITH_CODE, &[]);
    p.exp_string("Setting atom values").unwrap();
    sleep(Duration::from_millis(50));
    p.send_control('c').unwrap();
    let text = p.exp_eof().unwrap();
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    assert!(lines.contains(&"Interrupted in in.deck:16: this line is not done, and none follows"), "{text}");
    assert!(!text.contains("Created 8000 atoms"), "{text}");
    assert!(!text.contains("then") && text.ends_with("code 130\r\n"), "{text}");
}

#[test]
fn the_second_ends_the_program_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let mut p = start(folder.path(), 100, &stubborn(), WITH_CODE, &[]);
    p.exp_string("of memory").unwrap();
    for _ in 0..2 {
        sleep(Duration::from_millis(50));
        p.send_control('c').unwrap();
    }
    let text = p.exp_eof().unwrap();
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    assert!(lines.contains(&"ended at once: the last lines of files may be missing"), "{text}");
    assert_eq!(lines.last(), Some(&"code 130"), "{text}");
}

#[test]
fn at_the_prompt_the_second_is_confirmed_on_a_line_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let mut p = start(folder.path(), 200, &stubborn(), "repl in.deck -threads 1", &[("NO_COLOR", "1")]);
    p.exp_string("of memory").unwrap();
    for _ in 0..2 {
        sleep(Duration::from_millis(50));
        p.send_control('c').unwrap();
    }
    let text = p.exp_string("perigrain> ").unwrap();
    let notice = "stopping at the end of this step; Ctrl-\\ ends at once";
    assert!(text.contains(&format!("\n{notice}\r\n")), "{text:?}");
    // And the session continues.
    p.send_line("print \"atoms $(atoms)\"").unwrap();
    p.exp_string("\natoms 27\r\n").unwrap();
    p.send_control('d').unwrap();
    p.exp_eof().unwrap();
}
