//! How this program is started again, for runs of sweeps and for partitions: by itself, or by the Python that it is a module of.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

/// A program and the words that make it this one, before those of a command line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Starter {
    program: PathBuf,
    words: Vec<OsString>,
}

/// The program that hosts this one, and the words of its command line.
static HOST: OnceLock<(Starter, Vec<OsString>)> = OnceLock::new();

/// Registers that another program has started this one with `words` behind its own; called once, before anything else.
pub fn started_by(program: PathBuf, own: Vec<OsString>, words: Vec<OsString>) {
    // A process has one command line: a second call has the same words.
    let _ = HOST.set((Starter { program, words: own }, words));
}

/// Whether this program is the Python module.
pub fn is_hosted() -> bool {
    HOST.get().is_some()
}

/// The words of the command line.
pub fn words() -> Vec<OsString> {
    HOST.get().map_or_else(|| std::env::args_os().skip(1).collect(), |host| host.1.clone())
}

impl Starter {
    /// What starts this program.
    ///
    /// # Errors
    /// The system does not report it.
    pub fn itself() -> std::io::Result<Self> {
        match HOST.get() {
            Some(host) => Ok(host.0.clone()),
            None => Ok(std::env::current_exe()?.into()),
        }
    }

    /// A command that starts it, without any words of a command line yet.
    pub fn command(&self) -> Command {
        let mut command = Command::new(&self.program);
        command.args(&self.words);
        command
    }

    /// Its path, for messages.
    pub fn display(&self) -> std::path::Display<'_> {
        self.program.display()
    }
}

impl<P: Into<PathBuf>> From<P> for Starter {
    fn from(program: P) -> Self {
        Self { program: program.into(), words: vec![] }
    }
}
