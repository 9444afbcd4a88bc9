//! Words of a `calibrate` line that do not go together.

use super::words::{Solver, Words};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};

/// Refuses them.
///
/// # Errors
/// Walls that would have to pull, friction without contacts, what the method of a fit does not have, what goes with small displacements
/// only, and `steps` where displacements are small.
pub fn refuse(words: &Words, kind: &str) -> Result<()> {
    if let Some(wall) = words.wall.filter(|_| words.strain > 0.0) {
        let text = "a wall pushes only: it does not follow a strain above 0";
        return conflict(wall, text, "write a negative strain, or hold the ends with `grip` or `plate`");
    }
    if let (Some((_, at)), Some((false, _))) = (words.friction, words.contacts) {
        let text = "`mu` is about contacts, and `contacts no` leaves them out";
        return conflict(at, text, "leave one of the two out");
    }
    if kind == "ste" {
        return Ok(());
    }
    if words.solver != Solver::Dsm {
        // An estimate knows slip, a cell none of these.
        let slip = words.friction.filter(|_| words.solver == Solver::Periodic);
        let stray = [slip.map(|f| f.1), words.large, words.parts.map(|p| p.1)].into_iter().flatten().next();
        let Some(at) = stray else { return Ok(()) };
        let text = "this method of a fit has small displacements, and a periodic cell no contacts";
        return conflict(at, text, "leave the word out, or take `method dsm`");
    }
    if !words.by_parts() {
        let Some((_, at)) = words.parts else { return Ok(()) };
        let text = "`steps` is for displacements of any size: small ones are found at once";
        return conflict(at, text, "use `large yes`, or `mu M` for contacts that slip");
    }
    if let Some(at) = words.bound {
        let text = "`bound yes` is for small displacements of bonds alone";
        return conflict(at, text, "leave it out, or leave `large` and `mu` out");
    }
    let Some(at) = words.paper else { return Ok(()) };
    let text = "`method paper` has small displacements and contacts that stick";
    conflict(at, text, "leave it out, or leave `large` and `mu` out")
}

fn conflict(at: Span, text: &str, help: &str) -> Result<()> {
    Err(Diagnostic::error(Code::CONFLICT, at, text).help(help).into())
}
