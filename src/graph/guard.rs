//! The guard over a run's energy: put into the plan with the steps it must check.

use super::seal::Sealer;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_plan::{Energy, Guard, Stage, When};
use perigrain_styles::{SealCx, ledger};

/// Puts the guard of `fix dt/guard` into the plan. It looks before anything is put out, so that nothing bad is.
///
/// # Errors
/// Two guards.
pub fn seal(s: &mut Sealer) -> Result<()> {
    let all: Vec<_> = s.facts().filter_map(|(f, facts)| Some((f, facts.guard?))).collect();
    let [(node, rule), others @ ..] = &all[..] else { return Ok(()) };
    if let Some((other, _)) = others.first() {
        return Err(Diagnostic::error(
            Code::CONFLICT,
            other.span,
            "one fix dt/guard watches the whole scene",
        )
        .label(node.span, "the other one")
        .help(format!("use `unfix {}` first", other.id))
        .into());
    }
    let late = |stage: Stage| matches!(stage, Stage::EndOfStep | Stage::Output);
    let outputs = s.plan.ops.iter().filter(|p| late(p.about.stage)).map(|p| p.about.when.clone());
    let blocks = When::Every(rule.every).or(When::First).or(When::Last);
    let when = outputs.fold(blocks, When::or);
    s.request_energy(&when);
    s.request_atom_energy(&when);
    let mut probes = s.probes()?;
    let log = s.log();
    let name = format!("fix {} dt/guard", node.id);
    let look = Box::new(move |w: &perigrain_world::World| {
        let sheet = ledger::sheet(w, &mut probes)?;
        Ok(Energy {
            residual: sheet.residual(),
            held: sheet.held() - sheet.walls,
            turnover: sheet.turnover(),
        })
    });
    s.plan.guard =
        Some(Guard { name, rule: *rule, when, look, write_line: Box::new(move |line| log.line(line)) });
    Ok(())
}
