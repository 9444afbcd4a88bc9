//! `calibrate dsm`: the stiffness of a body between its ends.

use super::Line;
use super::found::NUMBERS;
use super::messages::{self, count, percent, warn_loose, warn_sticking, warn_unfinished};
use super::scene::Scene;
use super::setup::{Response, Setup};
use super::touch::Hertz;
use super::words::{Method, Words};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::cformat::general;
use perigrain_statics::ends::Hold;
use perigrain_styles::ActCx;
use std::time::Instant;

/// `calibrate dsm`.
///
/// # Errors
/// See [`Setup::new`]; `bound yes` where there is no bound.
pub fn run(cx: &mut ActCx, line: &Line, scene: &Scene, hertz: Option<&Hertz>) -> Result<()> {
    let (began, words) = (Instant::now(), &line.words);
    let setup = Setup::new(cx.world, scene, line.group, words, hertz, cx.span)?;
    refuse_bound(words, &setup)?;
    let r = setup.solve(scene, words, words.tol, None);
    if !r.stiffness.is_finite() {
        let text = "no stiffness has been found: forces are beyond all numbers";
        let help = "check the coefficients of bonds and contacts, and the strain";
        return Err(Diagnostic::error(Code::UNSTABLE, cx.span, text).help(help).into());
    }
    if r.certain.is_some_and(|part| !part.is_finite()) {
        let text =
            "there is no lower bound: some bond on the way to the ends resists no shear, bend or twist";
        cx.note(Diagnostic::warning(Code::NO_EFFECT, words.bound, text).help("leave `bound yes` out"));
    }
    warn_unfinished(cx, words, r.done);
    warn_loose(cx, r.loose);
    warn_untouched(cx, words, &r);
    warn_sticking(cx, words, &setup, &r);
    line.found.keep(cx.world, numbers(&setup, &r), &[], None);
    if words.fields {
        line.found.keep_motion(cx.world, &scene.places, &r.field);
    }
    log_summary(cx, line, scene, &setup, &r);
    cx.print(format!(
        "  energy: {}   {}{} iterations, {:.2} s",
        shares(&r),
        r.steps.map_or(String::new(), |n| format!("{n} steps of Newton, ")),
        r.iterations,
        began.elapsed().as_secs_f64()
    ));
    Ok(())
}

/// What `calibrate dsm` leaves behind.
pub fn numbers(setup: &Setup, r: &Response) -> [f64; NUMBERS] {
    let k = r.stiffness;
    let lower = r.certain.map_or(f64::NAN, |part| k * (1.0 - part));
    let upper = if setup.linear() { k } else { f64::NAN };
    let share = r.share();
    let out = setup.held.left_out[0] as f64;
    [k, r.young, r.poisson, lower, upper, k * setup.delta, setup.delta, r.iterations as f64, share, out]
}

fn log_summary(cx: &mut ActCx, line: &Line, scene: &Scene, setup: &Setup, r: &Response) {
    let words = &line.words;
    let end = |end: usize| match words.holds[end] {
        Hold::Wall => format!("{} at a wall", r.at_walls[end]),
        _ => setup.ends.members[end].len().to_string(),
    };
    let contacts = match setup.contacts.is_empty() {
        true => String::new(),
        false if words.friction.is_some() => {
            format!(", {} ({} slip)", count(r.touching, "contact"), r.slipping)
        }
        false => format!(", {}", count(r.touching, "contact")),
    };
    let without = match setup.held.left_out {
        [0, _] => String::new(),
        [n, pieces] => {
            format!("; {} ({}) without support left out", count(pieces, "piece"), count(n, "particle"))
        }
    };
    cx.print(format!(
        "{}{contacts}; ends held: {} + {}{without}",
        messages::head("dsm", line, scene),
        end(0),
        end(1)
    ));
    let within = match (r.certain, words.method) {
        _ if !r.done => "not converged".to_string(),
        (Some(part), _) => format!("within {} % (certified)", percent(part)),
        (None, Method::Paper(_)) => "by the residual".to_string(),
        (None, _) => format!("within {} % (estimate)", percent(r.open)),
    };
    cx.print(format!(
        "  K {}   {within}   {}   length {} (body {}), area {}",
        general(r.stiffness, 5),
        messages::moduli(r.young, r.poisson),
        general(setup.ends.free_length(), 5),
        general(setup.lengths[1], 5),
        general(setup.area, 5)
    ));
}

/// Warns of walls that nothing touches.
fn warn_untouched(cx: &ActCx, words: &Words, r: &Response) {
    if let Some(end) = (0..2).find(|end| words.holds[*end] == Hold::Wall && r.at_walls[*end] == 0) {
        let text = format!("nothing touches the {} wall: the stiffness is zero", ["low", "high"][end]);
        cx.note(
            Diagnostic::warning(Code::NO_FORCES, words.wall, text)
                .help("check the bonds, or take a larger strain"),
        );
    }
}

/// A bound needs ends that take up every force and torque.
///
/// # Errors
/// Other ends.
fn refuse_bound(words: &Words, setup: &Setup) -> Result<()> {
    match words.bound {
        Some(at) if !setup.linear() => {
            let d = Diagnostic::error(
                Code::NOT_SUPPORTED,
                at,
                "`bound yes` is for bonds alone, and contacts act here",
            );
            Err(d.help("use `contacts no`, or leave it out").into())
        }
        Some(at) if words.holds != [Hold::Grip; 2] => {
            let text = "`bound yes` needs both ends held wholly: forces must find their way to what is held";
            let help = "use `low grip high grip`, or leave it out: the estimate stands without it";
            Err(Diagnostic::error(Code::NOT_SUPPORTED, at, text).help(help).into())
        }
        Some(at) if words.method != Method::Pcg => {
            fail(Code::CONFLICT, at, "`bound yes` goes with `method pcg` only")
        }
        _ => Ok(()),
    }
}

/// The shares of stretch, shear, bend and twist, of contacts and of walls.
fn shares(r: &Response) -> String {
    let all: Vec<f64> = r.modes.iter().chain(&r.energies).copied().collect();
    let total: f64 = all.iter().sum();
    ["stretch", "shear", "bend", "twist", "contacts", "walls"]
        .iter()
        .zip(all)
        .enumerate()
        .filter(|(k, (_, a))| *k < 4 || *a != 0.0)
        .map(|(_, (name, a))| format!("{name} {:.0} %", if total > 0.0 { 100.0 * a / total } else { 0.0 }))
        .collect::<Vec<_>>()
        .join("  ")
}
