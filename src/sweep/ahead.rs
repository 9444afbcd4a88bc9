//! What would go wrong in every run, seen before the first of them.

use super::{Job, Sweep};
use crate::session::{self, Mode, Session};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Sources, nearest};

/// The result of a check of the deck.
#[derive(Clone, Debug, Default)]
pub struct Ahead {
    /// Why no run should begin; empty if all is well.
    pub problems: Diagnostics,
    /// Variables that the deck never uses; each is a problem too.
    pub unused: Vec<String>,
    /// What was to be reported and is not there; each is a problem too.
    pub unknown: Vec<String>,
    /// The texts in which their places are.
    pub sources: Sources,
}

/// Checks the deck with the values of the first run, and with those of the last if that one is refused; and that it uses the variables
/// and has what is to be reported.
pub fn look_ahead(sweep: &Sweep) -> Ahead {
    let (Some(first), Some(last)) = (sweep.jobs.first(), sweep.jobs.last()) else { return Ahead::default() };
    let mut out = Ahead::default();
    let mut session = match checked(sweep, first) {
        Ok((session, Ok(()))) => session,
        Ok((session, Err(problems))) => {
            // A deck may be right for some of the values only: runs with the others continue.
            let other = if sweep.jobs.len() > 1 { checked(sweep, last) } else { Err(Diagnostics::default()) };
            match other {
                Ok((other, Ok(()))) => other,
                _ => return Ahead { problems, sources: session.sources, ..Ahead::default() },
            }
        }
        Err(problems) => return Ahead { problems, ..Ahead::default() },
    };
    if !session.has_seen_all() {
        return out;
    }
    for (name, _) in first.variables().filter(|(name, _)| !session.uses_variable(name)) {
        out.unused.push(name.clone());
        let text = format!("the deck never uses the variable `{name}`: all its values would give the same");
        let d = Diagnostic::error(Code::UNUSED, None, text);
        let known = session.known().variables;
        let others = known.iter().map(String::as_str).filter(|n| n != name);
        out.problems.push(match nearest(name, others) {
            Some(near) => d.help(format!("did you mean `{near}`?")),
            None => d.help(format!("write `${{{name}}}` or `v_{name}` where the value belongs")),
        });
    }
    for word in &sweep.report {
        if let Err(e) = session.knows_measure(word) {
            out.unknown.push(word.clone());
            out.problems.append(e);
        }
    }
    out.sources = session.sources;
    out
}

/// A session that has checked the deck with a run's values, and what it found.
fn checked(sweep: &Sweep, job: &Job) -> Result<(Session, Result<()>)> {
    let s = &sweep.settings;
    let mut vars = s.vars.clone();
    vars.extend(job.variables().map(|(n, v)| (n.clone(), vec![v.clone()])));
    let mut session = Session::new(session::Options {
        mode: Mode::Check,
        compat: s.compat,
        vars,
        folder: sweep.deck.folder.clone(),
        ..Default::default()
    })?;
    let outcome = session.run_text(&sweep.deck.name, &sweep.deck.text).map(drop);
    Ok((session, outcome))
}
