//! The program on a pseudo-terminal of so many columns: what it shows, byte by byte.
//!
//! (The bytes come one by one as characters: only ASCII can be looked for.)

use rexpect::session::{PtySession, spawn_command};
use std::fs;
use std::path::Path;
use std::process::Command;

const PATIENCE: u64 = 60_000;

/// Grains that fall without touching.
pub const GRAINS: &str = "units si\natom_style sphere\nboundary f f f\nregion box block 0 0.1 0 0.1 0 0.1 units box\ncreate_box 1 box\n\
                          lattice sc 0.025\nregion r block 0.5 3.5 0.5 3.5 0.5 3.5\ncreate_atoms 1 region r\n\
                          set group all diameter 0.004 density 2500\npair_style granular\npair_coeff * * hooke 1e3 0.1 tangential none\n\
                          fix 1 all nve/sphere\nfix 2 all gravity 9.81 vector 0 0 -1\ntimestep 1e-9\nneighbor 0.001 bin\n";

/// A deck by its name with one thread.
pub const PLAIN: &str = "in.deck -threads 1";

/// The program in a folder with this deck; `args` end in shell code that follows the program's words. The shell that starts it
/// survives a Ctrl-C.
pub fn start(folder: &Path, columns: u16, deck: &str, args: &str, env: &[(&str, &str)]) -> PtySession {
    fs::write(folder.join("in.deck"), deck).unwrap();
    let line = format!("stty cols {columns} rows 50 echo; trap : INT; \"$0\" {args}");
    let mut command = Command::new("sh");
    command.args(["-c", &line, env!("CARGO_BIN_EXE_perigrain")]).current_dir(folder);
    command.env("TERM", "xterm").env("XDG_STATE_HOME", folder.join("state"));
    command.env_remove("NO_COLOR").envs(env.iter().copied());
    spawn_command(command, Some(PATIENCE)).unwrap()
}

/// All that it shows.
pub fn shown(folder: &Path, columns: u16, deck: &str, args: &str, env: &[(&str, &str)]) -> String {
    start(folder, columns, deck, args, env).exp_eof().unwrap()
}

/// The columns that a line takes: what is no ASCII has several bytes, the first of which is no continuation.
pub fn width(line: &str) -> usize {
    line.trim_end().chars().filter(|c| !('\u{80}'..'\u{c0}').contains(c)).count()
}

/// The first line that is wider than so many columns, lines that were taken back left out.
pub fn too_wide(text: &str, columns: usize) -> Option<&str> {
    text.lines().filter(|l| !l.contains('\x1b')).find(|l| width(l) > columns)
}
