//! The plan as text, with and without measurements.

use super::{Stage, StepPlan};
use perigrain_world::share::Traffic;
use std::fmt::Write;

/// The sealed plan, one line per op, then what was left out.
pub fn text(plan: &StepPlan, measured: bool) -> String {
    let mut s = String::new();
    let total: f64 = plan.ops.iter().map(|p| p.meter.time.as_secs_f64()).sum();
    for stage in Stage::ALL {
        let ops: Vec<_> = plan.ops.iter().filter(|p| p.about.stage == stage).collect();
        if ops.is_empty() {
            continue;
        }
        let _ = writeln!(s, "{}", stage.name());
        for p in ops {
            let _ = write!(s, "  {:<34} {:<22}", p.about.name, p.about.when.to_string());
            if let Some(levels) = plan.levels.filter(|_| stage < Stage::EndOfStep) {
                let _ = write!(s, " {:<12}", p.about.level.describe(levels));
            }
            if measured {
                let secs = p.meter.time.as_secs_f64();
                let share = if total > 0.0 { 100.0 * secs / total } else { 0.0 };
                let _ = write!(s, " {:>9} calls {:>11.6} s {:>5.1} %", p.meter.calls, secs, share);
                if p.meter.bytes > 0 {
                    let _ = write!(
                        s,
                        " {:>9.2} MB/call",
                        p.meter.bytes as f64 / 1e6 / p.meter.looks.max(1) as f64
                    );
                }
                if let Some(rows) = p.meter.rows {
                    let Traffic { gathers, sent } = p.meter.traffic;
                    let each = sent as f64 / 1e6 / p.meter.exchanges.max(1) as f64;
                    let _ = write!(s, "   {rows} rows: {gathers} gathers, {each:.3} MB a call");
                }
            } else {
                let _ = write!(s, " {}", p.about.needs);
            }
            let _ = writeln!(s);
        }
    }
    if !plan.left_out.is_empty() {
        let _ = writeln!(s, "left out");
        for l in &plan.left_out {
            let _ = writeln!(s, "  {:<34} {}", l.what, l.why);
        }
    }
    s
}
