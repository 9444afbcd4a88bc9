//! `calibrate periodic`: the stiffness tensor of a cell without ends.

use super::Line;
use super::found::lines;
use super::messages::{percent, warn_loose, warn_unfinished};
use super::scene::Scene;
use super::words::Words;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::cformat::general;
use perigrain_statics::ends::ROTATIONS;
use perigrain_statics::periodic::{Cell, mean_field};
use perigrain_statics::precond::Blocks;
use perigrain_statics::six::Matrix6;
use perigrain_statics::tensor::Moduli;
use perigrain_styles::ActCx;
use perigrain_world::World;
use std::time::Instant;

/// The volume of a periodic box.
///
/// # Errors
/// A box that does not repeat in all directions.
pub fn cell(w: &World, scene: &Scene, span: Span) -> Result<f64> {
    if scene.period.iter().all(|l| *l > 0.0) {
        return Ok(scene.period.iter().product());
    }
    let letters = w.domain()?.boundary.letters();
    let text =
        format!("`calibrate periodic` needs a box that repeats in all directions, not `boundary {letters}`");
    let help = "use `boundary p p p` before `create_box`, or take `calibrate dsm` for a body with ends";
    Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into())
}

/// Solves the six load cases of a cell.
pub fn solve_cell(scene: &Scene, words: &Words, tol: f64, from: Option<Cell>) -> (Cell, usize) {
    let held = if words.rotations { 0 } else { ROTATIONS };
    let blocks = Blocks::of_network(&scene.network, &vec![held; scene.places.len()]);
    (Cell::new(&scene.network, &blocks, tol, from), blocks.loose)
}

/// The moduli of a tensor.
///
/// # Errors
/// A tensor that is none of a body.
pub fn moduli(c: &Matrix6, span: Span) -> Result<Moduli> {
    let Some(moduli) = Moduli::new(c) else {
        let text = "the tensor found resists some strain with a negative stiffness: it has no moduli";
        let help = "take a lower `order`, or `calibrate periodic` or `dsm`";
        return Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into());
    };
    Ok(moduli)
}

/// `calibrate periodic`.
///
/// # Errors
/// See [`cell`].
pub fn periodic(cx: &mut ActCx, line: &Line, scene: &Scene) -> Result<()> {
    let (began, words) = (Instant::now(), &line.words);
    let volume = cell(cx.world, scene, cx.span)?;
    let (cell, loose) = solve_cell(scene, words, words.tol, None);
    warn_unfinished(cx, words, cell.done);
    warn_loose(cx, loose);
    let c = cell.tensor(&scene.network, volume);
    let m = moduli(&c, cx.span)?;
    let upper = Moduli::new(&mean_field(&scene.network, volume)).map_or(f64::NAN, |m| m.bulk);
    let iterations: usize = cell.iterations.iter().sum();
    let numbers = [
        m.bulk,
        m.mean_young(),
        m.mean_poisson(),
        f64::NAN,
        upper,
        m.shear,
        volume,
        iterations as f64,
        0.0,
        0.0,
    ];
    line.found.keep(cx.world, numbers, &[], Some(&c));
    cx.print(format!(
        "calibrate periodic {}: {} particles, {} bonds in a cell of volume {}",
        line.id,
        scene.places.len(),
        scene.network.bonds(),
        general(volume, 5)
    ));
    lines(&c).for_each(|line| cx.print(line));
    cx.print(format!(
        "  E {}   nu {}   K {} (mean field {})   G {}   within {} % (estimate)   {iterations} iterations, {:.2} s",
        general(m.mean_young(), 5),
        general(m.mean_poisson(), 3),
        general(m.bulk, 5),
        general(upper, 5),
        general(m.shear, 5),
        percent(cell.open),
        began.elapsed().as_secs_f64()
    ));
    Ok(())
}
