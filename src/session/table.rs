//! The session's own commands: each once, with what carries it out.

use super::commands::{Compatibility, Echoing};
use super::inert::{CommStyle, Package, Suffix};
use super::{Session, inert};
use crate::graph::Role;
use perigrain_base::diag::Result;
use perigrain_lang::{Args, Command, Script};

/// Carries out a line; `Some(status)` where the deck is over.
pub(super) type Carry = fn(&mut Session, &mut Script, &Command) -> Result<Option<i32>>;

/// By name. Those of the cursor through the deck (`if`, `jump` …) are the language's.
const OWN: &[(&str, Carry)] = &[
    // Runs, and what goes with them.
    ("run", |s, script, cmd| {
        s.doubt(script);
        done(s.run_command(cmd))
    }),
    ("minimize", |s, _, cmd| done(s.minimize(cmd))),
    ("statics", |s, _, cmd| done(s.statics(cmd))),
    ("fatigue", |s, _, cmd| done(s.fatigue(cmd))),
    ("rerun", |s, _, cmd| done(s.rerun(cmd))),
    ("write_dump", |s, _, cmd| done(s.write_dump(cmd))),
    ("write_restart", |s, _, cmd| done(s.write_restart(cmd))),
    ("read_restart", |s, _, cmd| done(s.read_restart(cmd))),
    // What a deck prints and where, and how it is read.
    ("print", |s, _, cmd| s.noting(cmd, |s| s.print(s.read_line(cmd)?))),
    ("log", |s, _, cmd| s.noting(cmd, |s| s.log(s.read_line(cmd)?))),
    ("echo", |s, _, cmd| {
        s.noting(cmd, |s| s.read_line::<Echoing>(cmd).map(|line| s.options.log.set_echo(line.echo)))
    }),
    ("info", |s, _, cmd| s.noting(cmd, |s| s.info(s.read_line(cmd)?))),
    ("timer", |s, _, cmd| s.noting(cmd, |s| s.timer(s.read_line(cmd)?))),
    ("compat", |s, _, cmd| {
        s.noting(cmd, |s| s.read_line::<Compatibility>(cmd).map(|line| s.set_compat(line.mode)))
    }),
    ("clear", |s, _, cmd| s.noting(cmd, |s| Args::new(cmd).finish().map(|()| s.clear()))),
    ("sweep", |s, _, cmd| s.noting(cmd, |s| s.sweep(s.read_line(cmd)?, cmd.span))),
    ("shell", |s, _, cmd| s.noting(cmd, |s| s.shell(cmd))),
    ("python", |s, _, cmd| s.noting(cmd, |s| s.python(&mut Args::new(cmd), cmd.span))),
    ("partition", |s, script, cmd| s.partition(script, cmd)),
    // Without effect here.
    ("suffix", |s, _, cmd| {
        s.noting(cmd, |s| s.read_line::<Suffix>(cmd).map(|_| s.is_idle(cmd, inert::KERNELS)))
    }),
    ("package", |s, _, cmd| {
        s.noting(cmd, |s| {
            s.before_box(cmd)?;
            s.read_line::<Package>(cmd).map(|_| s.is_idle(cmd, inert::THREADS))
        })
    }),
    ("comm_style", |s, _, cmd| {
        s.noting(cmd, |s| {
            s.world.settings.tiled = s.read_line::<CommStyle>(cmd)?.is_tiled();
            s.is_idle(cmd, inert::WHOLE);
            Ok(())
        })
    }),
    ("balance", |s, _, cmd| {
        s.noting(cmd, |s| inert::balance(&mut Args::new(cmd)).map(|()| s.is_idle(cmd, inert::SHARED)))
    }),
];

/// What carries out a command of the session.
pub(super) fn own(name: &str) -> Option<Carry> {
    OWN.iter().find(|(own, _)| *own == name).map(|(_, carry)| *carry)
}

fn done(outcome: Result<()>) -> Result<Option<i32>> {
    outcome.map(|()| None)
}

impl Session {
    /// Carries out a line about the session, and records it: once, however often a loop repeats it.
    fn noting(&mut self, cmd: &Command, act: impl FnOnce(&mut Self) -> Result<()>) -> Result<Option<i32>> {
        act(self)?;
        self.record_once(cmd, Role::Act, None);
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::catalogue::{DECLARATIONS, SESSION_COMMANDS};

    #[test]
    fn lists_of_commands_name_them_all() {
        let of_the_cursor = ["variable", "if", "jump", "label", "next", "include", "quit"];
        for (name, _) in OWN {
            let hosted = *name == "python";
            assert!(hosted || SESSION_COMMANDS.contains(name) || DECLARATIONS.contains(name), "{name}");
        }
        for name in SESSION_COMMANDS {
            assert!(own(name).is_some() || of_the_cursor.contains(&name), "{name}");
        }
    }
}
