//! The whole check of a deck: its lines, and the other runs of its `sweep` line.

use super::axes::{Axis, combined};
use super::{Mode, Options, Session};
use perigrain_base::diag::{Diagnostics, Sources};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// So many combinations of a `sweep` line are checked each, of more only the first and the last.
const MOST_CHECKED: usize = 64;

/// What a check has found.
#[derive(Clone, Debug, Default)]
pub struct Checked {
    /// All texts that were read.
    pub sources: Sources,
    /// All problems of the deck, in the order of its lines.
    pub problems: Diagnostics,
}

/// Checks a deck without acting. It ends between two lines when `stop` is set, and what it has found then is not all.
pub fn check(options: &Options, name: &str, text: &str, stop: &Arc<AtomicBool>) -> Checked {
    let mut session = match begin(options, stop) {
        Ok(session) => session,
        Err(problems) => return Checked { sources: Sources::default(), problems },
    };
    let outcome = session.run_text(name, text);
    let mut all = session.notes.clone();
    if let Err(problems) = outcome {
        all.append(problems);
    }
    if let Some(swept) = session.swept() {
        combinations(options, &swept.axes, (name, text), stop, &mut all);
    }
    let mut all = all.together();
    all.0.sort_by_key(|d| d.span.map(|s| (s.file, s.start)));
    Checked { sources: session.sources, problems: all }
}

/// A session that only reads, and gives up when `stop` is set.
pub(super) fn begin(options: &Options, stop: &Arc<AtomicBool>) -> Result<Session, Diagnostics> {
    let mut session = Session::new(Options { mode: Mode::Check, ..options.clone() })?;
    session.world.settings.stop = stop.clone();
    Ok(session)
}

/// Adds what is wrong with the other runs of a deck's `sweep` line; of very many only with the last.
fn combinations(
    options: &Options,
    axes: &[Axis],
    (name, text): (&str, &str),
    stop: &Arc<AtomicBool>,
    all: &mut Diagnostics,
) {
    let rows = combined(axes).unwrap_or_default();
    let skipped = if rows.len() > MOST_CHECKED { rows.len() - 1 } else { 1 };
    for row in rows.iter().skip(skipped) {
        if stop.load(Ordering::Relaxed) {
            return;
        }
        let mut with = options.clone();
        let given = |n: &str| options.vars.iter().any(|(given, _)| given == n);
        with.vars.extend(row.iter().filter(|(n, _)| !given(n)).map(|(n, v)| (n.clone(), vec![v.clone()])));
        let Ok(mut session) = begin(&with, stop) else { continue };
        let refused = session.run_text(name, text).err().unwrap_or_default();
        let title = row.iter().map(|(n, v)| format!("{n}={v}")).collect::<Vec<_>>().join(" ");
        for d in refused.0 {
            if !all.0.iter().any(|known| known.code == d.code && known.span == d.span) {
                all.push(d.help(format!("this is so with {title}, as the deck's `sweep` line gives it")));
            }
        }
    }
}
