//! `calibrate fit`: coefficients of bonds that give a body a stiffness.
//!
//! Gauss and Newton in logarithms, with the derivatives that energies are (K = 2U/Δ²: ∂ln K/∂ln k of a bond is its share of the
//! energy); of ν by the adjoint field.

use super::Line;
use super::messages::{count, warn_unfinished};
use super::model::Model;
use super::scene::{BondQuery, Scene};
use super::touch::Hertz;
use super::words::{Quantity, Target, Words};
use nalgebra::{DMatrix, DVector};
use perigrain_base::diag::{Code, Diagnostic, Result, Source, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_base::stop;
use perigrain_bonded::stiffness::Modes;
use perigrain_lang::{Command, Word};
use perigrain_styles::{ActCx, BondForce};
use std::sync::Arc;
use std::time::Instant;

/// The coefficient of bonds that break which multiplies all their strengths.
const STRENGTH: &str = "strength";
/// More solutions than this mean that the targets cannot be reached together.
const MOST: usize = 30;
/// No step changes a coefficient by more than this factor's logarithm.
const LONGEST: f64 = 4.0;
/// Half the step of differences of ln k over ln p; powers have none of another order.
const STEP: f64 = 1e-4;

/// `calibrate fit`.
///
/// # Errors
/// Coefficients that the bond style does not have or that change nothing, targets that cannot be reached.
pub fn run(
    cx: &mut ActCx,
    line: &Line,
    mut scene: Scene,
    hertz: Option<&Hertz>,
    style: &dyn BondForce,
) -> Result<()> {
    let (began, words) = (Instant::now(), &line.words);
    let mut model = Model::new(cx.world, line, &scene, hertz, cx.span)?;
    let mut params = vec![0.0; words.vary.len()];
    let (mut solves, mut breaks, mut best) = (0, 0, None::<(f64, Vec<f64>)>);
    cx.print(format!(
        "calibrate fit {}: {}, {}, {} particles, {} bonds",
        line.id,
        count(params.len(), "coefficient"),
        count(words.targets.len(), "target"),
        scene.places.len(),
        scene.network.bonds()
    ));
    loop {
        stop::check()?;
        let now = tuned(style, words, &params)?;
        scene.restyle(now.as_ref());
        model.solve(&scene, words, cx.span)?;
        solves += 1;
        let mut wrong = misses(words, &model);
        // The way to strength is long, and worth while only once the stiffnesses are right.
        if words.aims(Quantity::Strength) && largest(&wrong) <= words.tol {
            breaks += model.crumble(&scene, words, now.as_ref(), cx.span)?;
            wrong = misses(words, &model);
        }
        log_solve(cx, solves, words, &model, &values(style, words, &params)?);
        let worst = largest(&wrong);
        if worst <= words.tol {
            break;
        }
        if let Some(missing) = missing_strength(words, &wrong).filter(|_| proportional(style, &scene, words))
        {
            for (p, vary) in params.iter_mut().zip(&words.vary) {
                *p += if vary.name == STRENGTH { missing } else { 0.0 };
            }
            model.strengthen(missing.exp());
            break;
        }
        if solves == MOST || !worst.is_finite() {
            return Err(unreached(words, &model, cx.span));
        }
        // Too far: half the way back to where it was better.
        let (from, step) = match &best {
            Some((before, at)) if worst > *before => {
                let back = at.iter().zip(&params).map(|(a, p)| 0.5 * (p - a)).collect::<Vec<_>>();
                if back.iter().all(|a| a.abs() < 1e-9) {
                    return Err(unreached(words, &model, cx.span));
                }
                (at.clone(), back)
            }
            _ => {
                let changes = changes(now.as_ref(), &scene, words)?;
                let slopes = match slopes(&mut model, &mut scene, words, &changes, cx.span) {
                    // Not at the beginning: a coefficient has run away.
                    Err(_) if solves > 1 => return Err(unreached(words, &model, cx.span)),
                    slopes => slopes?,
                };
                // Too few targets leave a direction open: the step is the shortest one, and a note names the direction.
                let (step, open) = shortest(&slopes, &wrong);
                if solves == 1 {
                    log_open_directions(cx, words, &open);
                }
                if let (1, true, Some(power)) =
                    (words.vary.len(), model.linear(), uniform(&changes[0], &scene))
                {
                    // All stiffnesses change by one factor, and so does that of the body: nothing is left to solve.
                    params[0] += step[0];
                    model.scale((power * step[0]).exp());
                    if misses(words, &model).iter().all(|a| a.abs() <= words.tol) {
                        break;
                    }
                    return Err(unreached(words, &model, cx.span));
                }
                best = Some((worst, params.clone()));
                (params.clone(), step)
            }
        };
        params = from.iter().zip(&step).map(|(p, s)| p + s.clamp(-LONGEST, LONGEST)).collect();
    }
    warn_unfinished(cx, words, model.done);
    model.warn(cx, line, &scene, hertz);
    let now = tuned(style, words, &params)?;
    set(cx, words, now.as_ref(), &format!("calibrate fit {}", line.id))?;
    line.found.keep(cx.world, model.numbers(), &values(style, words, &params)?, model.tensor());
    let mut took = count(solves, "solve");
    if breaks > 0 {
        took += &format!(", {}", count(breaks, "broken bond"));
    }
    let seconds = began.elapsed().as_secs_f64();
    cx.print(format!("  {}   {took}, {seconds:.2} s", reached(words, &model)));
    Ok(())
}

/// How far each target is: logarithms, for a Poisson's ratio below zero the part that is missing; nothing for a strength that is not known.
fn misses(words: &Words, model: &Model) -> Vec<f64> {
    let miss = |t: &Target| match model.value(t.quantity) {
        now if now.is_nan() && t.quantity == Quantity::Strength => 0.0,
        now if now <= 0.0 && t.quantity == Quantity::Poisson => (t.value - now) / t.value,
        now => (t.value / now).ln(),
    };
    words.targets.iter().map(miss).collect()
}

fn largest(wrong: &[f64]) -> f64 {
    wrong.iter().fold(0.0, |most, a| most.max(a.abs()))
}

/// What the strength lacks where it is the only target that is still missed, and once at most.
fn missing_strength(words: &Words, wrong: &[f64]) -> Option<f64> {
    let mut missed = words.targets.iter().zip(wrong).filter(|(_, a)| a.abs() > words.tol);
    let (target, missing) = missed.next()?;
    (target.quantity == Quantity::Strength && missed.next().is_none()).then_some(*missing)
}

/// Whether the coefficients that vary multiply the strengths of all bonds that can break: then that of the body is proportional to them.
fn proportional(style: &dyn BondForce, scene: &Scene, words: &Words) -> bool {
    let factors =
        words.vary.iter().map(|vary| if vary.name == STRENGTH { std::f64::consts::LN_2 } else { 0.0 });
    let Ok(twice) = tuned(style, words, &factors.collect::<Vec<_>>()) else { return false };
    let used = |style: &dyn BondForce, query: &BondQuery| style.used(&query.bearing([1.0; 4]));
    scene.bonds.iter().all(|query| match (used(style, query), used(twice.as_ref(), query)) {
        (Some(once), Some(half)) => (once - 2.0 * half).abs() <= 1e-9 * once,
        (once, half) => once.is_none() && half.is_none(),
    })
}

/// The style with all coefficients multiplied by exp(params).
fn tuned(style: &dyn BondForce, words: &Words, params: &[f64]) -> Result<Box<dyn BondForce>> {
    let mut now: Option<Box<dyn BondForce>> = None;
    for (vary, p) in words.vary.iter().zip(params) {
        let Some((tuned, value)) = now.as_deref().unwrap_or(style).tuned(&vary.name, vary.kind, p.exp())
        else {
            return Err(not_tunable(style, vary.span, &vary.name, vary.kind));
        };
        if value == 0.0 {
            return fail(Code::CONFLICT, vary.span, "this coefficient is 0: there is nothing to begin from");
        }
        now = Some(tuned);
    }
    match now {
        Some(now) => Ok(now),
        None => fail(Code::INCOMPLETE, None, "a fit needs something to `vary`"),
    }
}

fn not_tunable(
    style: &dyn BondForce,
    span: Span,
    name: &str,
    kind: u16,
) -> perigrain_base::diag::Diagnostics {
    let text = format!("bond_style {} has no coefficient `{name}` of bond type {kind} to vary", style.name());
    let d = Diagnostic::error(Code::BAD_VALUE, span, text);
    match style.tunable() {
        [] => d,
        known => d.help(format!("known: {}", known.join(" "))),
    }
    .into()
}

/// The values of the varied coefficients.
fn values(style: &dyn BondForce, words: &Words, params: &[f64]) -> Result<Vec<f64>> {
    words
        .vary
        .iter()
        .zip(params)
        .map(|(vary, p)| match style.tuned(&vary.name, vary.kind, p.exp()) {
            Some((_, value)) => Ok(value),
            None => Err(not_tunable(style, vary.span, &vary.name, vary.kind)),
        })
        .collect()
}

/// ∂ln k/∂ln p of each bond, for each coefficient.
fn changes(style: &dyn BondForce, scene: &Scene, words: &Words) -> Result<Vec<Vec<Modes>>> {
    words
        .vary
        .iter()
        .map(|vary| {
            let at = |step: f64| match style.tuned(&vary.name, vary.kind, step.exp()) {
                Some((tuned, _)) => Ok(tuned),
                None => Err(not_tunable(style, vary.span, &vary.name, vary.kind)),
            };
            let (less, more) = (at(-STEP)?, at(STEP)?);
            let slope = |a: f64, b: f64| if a > 0.0 && b > 0.0 { (b / a).ln() / (2.0 * STEP) } else { 0.0 };
            Ok(scene
                .bonds
                .iter()
                .map(|query| {
                    if query.kind != vary.kind {
                        return [0.0; 4];
                    }
                    let of = |style: &dyn BondForce| {
                        style.stiffness(query.kind, query.length, query.radii).unwrap_or_default()
                    };
                    let (a, b) = (of(less.as_ref()), of(more.as_ref()));
                    [
                        slope(a.normal, b.normal),
                        slope(a.shear, b.shear),
                        slope(a.bend, b.bend),
                        slope(a.twist, b.twist),
                    ]
                })
                .collect())
        })
        .collect()
}

/// The power with which all stiffnesses of all bonds follow a coefficient, if it is the same: the body's stiffness follows it likewise,
/// and its Poisson's ratio not at all.
fn uniform(changes: &[Modes], scene: &Scene) -> Option<f64> {
    let first = changes.first()?[0];
    let alike = changes.iter().zip(&scene.network.k).all(|(change, k)| {
        let there = [k.normal, k.shear, k.bend, k.twist];
        // Differences of logarithms: rounding over the step.
        change.iter().zip(there).all(|(c, k)| k == 0.0 || (c - first).abs() < 1e-10)
    });
    alike.then(|| first.round()).filter(|power| (power - first).abs() < 1e-10 && *power != 0.0)
}

/// The slopes of all targets (as in [`misses`]) over the logarithms of all coefficients.
fn slopes(
    model: &mut Model,
    scene: &mut Scene,
    words: &Words,
    changes: &[Vec<Modes>],
    span: Span,
) -> Result<DMatrix<f64>> {
    let mut out = DMatrix::zeros(words.targets.len(), words.vary.len());
    for (row, target) in words.targets.iter().enumerate() {
        for (column, change) in changes.iter().enumerate() {
            let poisson = target.quantity == Quantity::Poisson;
            if target.quantity == Quantity::Strength {
                // Proportional to all strengths together; what else changes it is made up for in the next solve.
                let varied = words.vary.iter().filter(|v| v.name == STRENGTH).count();
                out[(row, column)] =
                    if words.vary[column].name == STRENGTH { 1.0 / varied as f64 } else { 0.0 };
                continue;
            }
            out[(row, column)] =
                match (uniform(change, scene).filter(|_| model.linear()), model.value(target.quantity)) {
                    (Some(_), _) if poisson => 0.0,
                    (Some(power), _) => power,
                    (None, now) => {
                        let slope = model.slope(scene, words, target.quantity, change, span)?;
                        if poisson { slope / if now > 0.0 { now } else { target.value } } else { slope }
                    }
                };
        }
    }
    for (column, vary) in words.vary.iter().enumerate() {
        if out.column(column).iter().all(|a| a.abs() < 1e-6) {
            let text = format!("`{}` of bond type {} changes none of the targets", vary.name, vary.kind);
            let help = "vary something that carries load, or give another target";
            return Err(Diagnostic::error(Code::CONFLICT, vary.span, text).help(help).into());
        }
    }
    Ok(out)
}

/// The shortest step that closes the misses by the slopes, and the directions that change nothing.
fn shortest(slopes: &DMatrix<f64>, wrong: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = slopes.ncols();
    // SVD of SᵀS's size shows all directions of the coefficients.
    let normal = (slopes.transpose() * slopes).symmetric_eigen();
    let largest = normal.eigenvalues.iter().fold(0.0f64, |most, a| most.max(*a));
    let right = slopes.transpose() * DVector::from_row_slice(wrong);
    let (mut step, mut open) = (DVector::zeros(n), vec![]);
    for (value, vector) in normal.eigenvalues.iter().zip(normal.eigenvectors.column_iter()) {
        if *value > 1e-10 * largest {
            step += vector * (vector.dot(&right) / value);
        } else {
            open.push(vector.iter().copied().collect());
        }
    }
    (step.iter().copied().collect(), open)
}

fn name(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Stiffness => "K",
        Quantity::Young => "E",
        Quantity::Poisson => "nu",
        Quantity::Strength => "strength",
    }
}

fn reached(words: &Words, model: &Model) -> String {
    let one = |t: &Target| {
        let value = model.value(t.quantity);
        (!value.is_nan()).then(|| format!("{} {}", name(t.quantity), general(value, 6)))
    };
    words.targets.iter().filter_map(one).collect::<Vec<_>>().join("   ")
}

fn log_solve(cx: &mut ActCx, solve: usize, words: &Words, model: &Model, values: &[f64]) {
    let given: Vec<String> = (words.vary.iter().zip(values))
        .map(|(v, value)| format!("{} of type {} {}", v.name, v.kind, general(*value, 6)))
        .collect();
    cx.print(format!("  solve {solve}: {}   gives {}", given.join("   "), reached(words, model)));
}

fn log_open_directions(cx: &mut ActCx, words: &Words, open: &[Vec<f64>]) {
    for direction in open {
        let powers: Vec<String> = (words.vary.iter().zip(direction))
            .map(|(v, a)| format!("{} of type {} ^ {}", v.name, v.kind, general(*a, 3)))
            .collect();
        cx.print(format!("  the targets leave open: {}", powers.join(" · ")));
    }
}

fn unreached(words: &Words, model: &Model, span: Span) -> perigrain_base::diag::Diagnostics {
    let wanted: Vec<String> =
        words.targets.iter().map(|t| format!("{} {}", name(t.quantity), general(t.value, 6))).collect();
    let text = format!("the targets {} are not reached: {}", wanted.join(", "), reached(words, model));
    Diagnostic::error(Code::UNSTABLE, span, text)
        .help("vary more coefficients, or give fewer targets; nothing has been changed")
        .into()
}

/// Declares the coefficients found, as lines of a deck would.
fn set(cx: &mut ActCx, words: &Words, style: &dyn BondForce, source: &str) -> Result<()> {
    let mut kinds: Vec<u16> = words.vary.iter().map(|v| v.kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    for kind in kinds {
        let Some(written) = style.written(kind) else {
            let text = format!("bond_style {} cannot write its coefficients", style.name());
            return fail(Code::CONFLICT, cx.span, text);
        };
        let text = format!("bond_coeff {kind} {written}");
        let mut at = 0;
        let mut all: Vec<Word> = text
            .split_whitespace()
            .map(|word| {
                let start = at + text[at..].find(word).unwrap_or(0);
                at = start + word.len();
                Word::new(word, Span::new(perigrain_base::diag::FileId::BROUGHT, start, at))
            })
            .collect();
        let span = all[0].span.to(all[all.len() - 1].span);
        cx.print(format!("  {text}"));
        let from = Arc::new(Source { name: source.to_string(), text: text.clone() });
        cx.then.push((Command { name: all.remove(0), args: all, span, text }, from));
    }
    Ok(())
}
