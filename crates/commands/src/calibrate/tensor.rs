//! `calibrate periodic` and `calibrate ste`: stiffness tensors.

use super::dsm::{percent, warn_loose, warn_unfinished};
use super::found::{Found, lines};
use super::scene::Scene;
use super::words::Words;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_bonded::ends::ROTATIONS;
use perigrain_bonded::periodic::{Cell, mean_field};
use perigrain_bonded::precond::Blocks;
use perigrain_bonded::six::Matrix6;
use perigrain_bonded::ste::{Estimate, Layers};
use perigrain_bonded::tensor::Moduli;
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
    let help = "say `boundary p p p` before `create_box`, or take `calibrate dsm` for a body with ends";
    Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into())
}

/// Solves the six load cases of a cell.
pub fn solve_cell(scene: &Scene, words: &Words, tol: f64, from: Option<Cell>) -> (Cell, usize) {
    let held = if words.rotations { 0 } else { ROTATIONS };
    let blocks = Blocks::new(scene.network.blocks(), &vec![held; scene.places.len()]);
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
pub fn periodic(cx: &mut ActCx, id: &str, scene: &Scene, words: &Words, found: &Found) -> Result<()> {
    let began = Instant::now();
    let volume = cell(cx.world, scene, cx.span)?;
    let (cell, loose) = solve_cell(scene, words, words.tol, None);
    warn_unfinished(cx, cell.done);
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
    found.keep(cx.world, numbers, Some(&c));
    cx.say(format!(
        "calibrate periodic {id}: {} particles, {} bonds in a cell of volume {}",
        scene.places.len(),
        scene.network.bonds(),
        general(volume, 5)
    ));
    lines(&c).for_each(|line| cx.say(line));
    cx.say(format!(
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

/// What an estimate gives of a body.
pub struct Estimated {
    /// C.
    pub tensor: Matrix6,
    /// E A/l along the axis, or of slabs in series [force/length].
    pub stiffness: f64,
    /// Poisson's ratio, the mean of both directions across the load.
    pub poisson: f64,
    /// By how much the strain of the load makes it longer [length].
    pub delta: f64,
    /// Particles left out.
    pub without: usize,
    /// Length of the body [length].
    pub length: f64,
    /// Its cross-section [length²].
    pub area: f64,
}

impl Estimated {
    /// K, E and ν along the axis.
    pub fn axial(&self) -> [f64; 3] {
        [self.stiffness, self.stiffness * self.length / self.area, self.poisson]
    }
}

/// Estimates a body.
///
/// # Errors
/// A tensor that is none of a body; slabs that are too high.
pub fn estimate(scene: &Scene, words: &Words, span: Span) -> Result<Estimated> {
    let sample = scene.sample(words.axis);
    let (length, area) = (scene.width(words.axis), scene.area(words));
    let volume = length * area;
    let estimate = Estimate::new(&scene.network, words.order);
    let tensor = estimate.whole(volume);
    let moduli = moduli(&tensor, span)?;
    let mut stiffness = moduli.young[words.axis] * area / length;
    if let Some(height) = words.slabs {
        let height = height.unwrap_or(4.0 * sample.mean_radius());
        let count = (length / height).round().max(1.0);
        if count > 1e6 {
            return fail(
                Code::BAD_VALUE,
                span,
                "slabs are so thin that there are more than a million of them",
            );
        }
        let lo = if scene.period[words.axis] > 0.0 {
            scene.x.iter().fold(f64::INFINITY, |lo, x| lo.min(x[words.axis])) - sample.mean_radius()
        } else {
            sample.extent(words.axis)[0]
        };
        let total: f64 = scene.radius.iter().map(|r| r.powi(3)).sum();
        let shares: Vec<f64> = scene.radius.iter().map(|r| volume * r.powi(3) / total).collect();
        let along: Vec<f64> = scene.x.iter().map(|x| x[words.axis]).collect();
        stiffness =
            Layers::new(&estimate, &along, &shares, [lo, lo + length], count as usize, words.axis).stiffness;
        if stiffness.is_nan() {
            let text = "a slab resists some strain with a negative stiffness";
            let d = Diagnostic::error(Code::CONFLICT, span, text);
            return Err(d.help("take higher slabs, a lower `order`, or `calibrate dsm`").into());
        }
    }
    let [a, b] = sample.across().map(|d| moduli.poisson[words.axis][d]);
    let (poisson, delta) = (0.5 * (a + b), words.strain * length);
    Ok(Estimated { tensor, stiffness, poisson, delta, without: estimate.without, length, area })
}

/// `calibrate ste`.
///
/// # Errors
/// See [`estimate`].
pub fn ste(cx: &mut ActCx, id: &str, scene: &Scene, words: &Words, found: &Found) -> Result<()> {
    let began = Instant::now();
    let e = estimate(scene, words, cx.span)?;
    let ([k, young, nu], nan) = (e.axial(), f64::NAN);
    let numbers = [k, young, nu, nan, nan, k * e.delta, e.delta, words.order as f64, 0.0, e.without as f64];
    found.keep(cx.world, numbers, Some(&e.tensor));
    let without = match e.without {
        0 => String::new(),
        n => format!("; {n} particles with fewer than three independent bonds left out"),
    };
    cx.say(format!(
        "calibrate ste {id}: {} particles, {} bonds{without}",
        scene.places.len(),
        scene.network.bonds()
    ));
    lines(&e.tensor).for_each(|line| cx.say(line));
    cx.say(format!(
        "  K {}   E {}   nu {}   length {}, area {}   order {}, {:.2} s",
        general(k, 5),
        general(young, 5),
        general(nu, 3),
        general(e.length, 5),
        general(e.area, 5),
        words.order,
        began.elapsed().as_secs_f64()
    ));
    Ok(())
}
