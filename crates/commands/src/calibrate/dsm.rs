//! `calibrate dsm`: the stiffness of a body between its ends.

use super::found::Found;
use super::scene::Scene;
use super::words::{Method, Words};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_base::math::vec3::Vec3;
use perigrain_bonded::dsm::{Answer, Stop, relax};
use perigrain_bonded::ends::{Ends, Held, Hold, affine, poisson};
use perigrain_bonded::periodic::mean_field;
use perigrain_bonded::precond::Blocks;
use perigrain_bonded::six::Six;
use perigrain_bonded::tensor::Moduli;
use perigrain_styles::ActCx;
use perigrain_world::World;
use std::time::Instant;

/// A body between held ends.
pub struct Setup {
    /// Who is at the ends.
    pub ends: Ends,
    /// What is held.
    pub held: Held,
    /// By how much the high end moves [length].
    pub delta: f64,
    /// Length to which E belongs, and of the body [length].
    pub lengths: [f64; 2],
    /// Cross-section [length²].
    pub area: f64,
    /// Poisson's ratios of the mean field, in the three directions.
    nu: Vec3,
}

/// What a load gives.
#[derive(Clone, Debug)]
pub struct Response {
    /// Field, energies, how the solution went.
    pub answer: Answer,
    /// K [force/length].
    pub stiffness: f64,
    /// E [pressure].
    pub young: f64,
    /// ν, the mean of both directions across the load.
    pub poisson: f64,
}

impl Setup {
    /// Of a scene by the words of a line.
    ///
    /// # Errors
    /// Ends that hold nothing, or belong together.
    pub fn new(w: &World, scene: &Scene, words: &Words, span: Span) -> Result<Self> {
        if let Some(wall) = words.wall {
            let d = Diagnostic::error(Code::NOT_SUPPORTED, wall, "`wall` is not in perigrain yet");
            return Err(d.help("`plate` holds the particles at an end along the axis, `grip` wholly").into());
        }
        scene.has_ends(w, words.axis, span)?;
        let sample = scene.sample(words.axis);
        let ends = Ends::new(&sample, words.thick.unwrap_or_else(|| sample.mean_radius()));
        if ends.overlap() || ends.free_length() <= 0.0 {
            let text = "the body is too short: a particle belongs to both of its ends";
            let help = "say `thick T` with a smaller T, by default the mean radius, or choose another axis";
            return Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into());
        }
        let held = Held::new(&sample, &ends, words.holds, words.rotations, &scene.network.pieces());
        if !held.through {
            let text = "no chain of bonds leads from end to end: the stiffness is zero";
            let help =
                "look at the bonds (`compute bond/local`), or reach further into the body with `thick T`";
            return Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into());
        }
        let [lo, hi] = sample.extent(words.axis);
        let body = hi - lo;
        let free = ends.free_length();
        let area = scene.area(words);
        let length = if words.body { body } else { free };
        let moduli = Moduli::new(&mean_field(&scene.network, area * body));
        let nu = std::array::from_fn(|d| {
            let repeats = scene.period[d] > 0.0;
            moduli.filter(|_| !repeats && d != words.axis).map_or(0.0, |m| m.poisson[words.axis][d])
        });
        Ok(Self { delta: words.strain * free, ends, held, lengths: [length, body], area, nu })
    }

    /// Solves, from a field or from the affine one.
    pub fn solve(
        &self,
        scene: &Scene,
        words: &Words,
        tol: f64,
        from: Option<Vec<Six>>,
    ) -> (Response, Blocks) {
        let sample = scene.sample(words.axis);
        let blocks = Blocks::new(scene.network.blocks(), &self.held.mask);
        let mut start =
            from.unwrap_or_else(|| affine(&sample, &self.ends, words.holds, &self.held, self.delta, self.nu));
        let stop = match (words.method, words.bound) {
            (Method::Paper([linear, _]), _) => {
                for (row, held) in start.iter_mut().zip(&self.held.mask) {
                    *row = std::array::from_fn(|c| if held >> c & 1 == 1 { row[c] } else { 0.0 });
                }
                Stop::Residual(linear)
            }
            (Method::Pcg, Some(_)) => Stop::Certified(tol),
            (Method::Pcg, None) => Stop::Estimate(tol),
        };
        let answer = relax(&scene.network, &blocks, &self.held, start, words.rotations, stop);
        let stiffness = 2.0 * answer.energy() / self.delta.powi(2);
        let sides = poisson(&sample, &answer.field, &self.held.out, words.strain);
        // Where the box repeats a body keeps its width.
        let [a, b] = sample.across();
        let free: Vec<f64> = [(a, sides[0]), (b, sides[1])]
            .iter()
            .filter(|(d, _)| scene.period[*d] == 0.0)
            .map(|s| s.1)
            .collect();
        let poisson = if free.is_empty() { 0.0 } else { free.iter().sum::<f64>() / free.len() as f64 };
        let young = stiffness * self.lengths[0] / self.area;
        (Response { answer, stiffness, young, poisson }, blocks)
    }
}

/// `calibrate dsm`.
///
/// # Errors
/// See [`Setup::new`]; `bound yes` where there is no bound.
pub fn run(cx: &mut ActCx, id: &str, scene: &Scene, words: &Words, found: &Found) -> Result<()> {
    let began = Instant::now();
    refuse_bound(words)?;
    let setup = Setup::new(cx.world, scene, words, cx.span)?;
    let (response, blocks) = setup.solve(scene, words, words.tol, None);
    let (k, answer) = (response.stiffness, &response.answer);
    let lower = answer.gap.map_or(f64::NAN, |gap| k - 2.0 * gap / setup.delta.powi(2));
    if answer.gap.is_some_and(|gap| !gap.is_finite()) {
        let text =
            "there is no lower bound: some bond on the way to the ends resists no shear, bend or twist";
        cx.note(Diagnostic::warning(Code::NO_EFFECT, words.bound, text).help("leave `bound yes` out"));
    }
    warn_unfinished(cx, answer.solved.done);
    warn_loose(cx, blocks.loose);
    let out = setup.held.left_out;
    found.keep(
        cx.world,
        [
            k,
            response.young,
            response.poisson,
            lower,
            k,
            k * setup.delta,
            setup.delta,
            answer.solved.iterations as f64,
            0.0,
            out[0] as f64,
        ],
        None,
    );
    if words.fields {
        found.keep_motion(cx.world, &scene.places, &answer.field);
    }
    let [low, high] = [0, 1].map(|end| setup.ends.members[end].len());
    let without = match out {
        [0, _] => String::new(),
        [n, pieces] => format!("; {pieces} pieces ({n} particles) without support left out"),
    };
    cx.say(format!(
        "calibrate dsm {id}: {} particles, {} bonds; ends held: {low} + {high}{without}",
        scene.places.len(),
        scene.network.bonds()
    ));
    let within = match (answer.gap, words.method) {
        (Some(gap), _) => format!("within {} % (certified)", percent(gap / answer.energy())),
        (None, Method::Paper(_)) => "by the residual".to_string(),
        (None, _) => format!("within {} % (estimate)", percent(answer.solved.open / answer.energy())),
    };
    cx.say(format!(
        "  K {}   {within}   E {}   nu {}   length {} (body {}), area {}",
        general(k, 5),
        general(response.young, 5),
        general(response.poisson, 3),
        general(setup.ends.free_length(), 5),
        general(setup.lengths[1], 5),
        general(setup.area, 5)
    ));
    cx.say(format!(
        "  energy: {}   {} iterations, {:.2} s",
        shares(&answer.modes),
        answer.solved.iterations,
        began.elapsed().as_secs_f64()
    ));
    Ok(())
}

/// A bound needs ends that take up every force and torque.
///
/// # Errors
/// Other ends.
fn refuse_bound(words: &Words) -> Result<()> {
    match words.bound {
        Some(at) if words.holds != [Hold::Grip; 2] => {
            let text = "`bound yes` needs both ends held wholly: forces must find their way to what is held";
            let help = "say `low grip high grip`, or leave it out: the estimate stands without it";
            Err(Diagnostic::error(Code::NOT_SUPPORTED, at, text).help(help).into())
        }
        Some(at) if words.method != Method::Pcg => {
            fail(Code::CONFLICT, at, "`bound yes` goes with `method pcg` only")
        }
        _ => Ok(()),
    }
}

/// Warns of a solution that has not come to an end.
pub fn warn_unfinished(cx: &ActCx, done: bool) {
    if !done {
        let text = "the solution has not converged: the stiffness is an upper bound and may be far off";
        let help =
            "the stiffnesses of bonds differ by too many orders of magnitude, or `tol` is below rounding";
        cx.note(Diagnostic::warning(Code::UNSTABLE, cx.span, text).help(help));
    }
}

/// Tells of particles that can move without resistance.
pub fn warn_loose(cx: &ActCx, loose: usize) {
    if loose > 0 {
        let text = format!(
            "{loose} particles can move or turn without any resistance of their bonds; they are held in these directions"
        );
        cx.note(Diagnostic::note(Code::NO_EFFECT, cx.span, text));
    }
}

/// A part in percent with two digits.
pub fn percent(part: f64) -> String {
    general(100.0 * part, 2)
}

/// The shares of stretch, shear, bend and twist.
pub fn shares(modes: &[f64; 4]) -> String {
    let total: f64 = modes.iter().sum();
    ["stretch", "shear", "bend", "twist"]
        .iter()
        .zip(modes)
        .map(|(name, a)| format!("{name} {:.0} %", 100.0 * a / total))
        .collect::<Vec<_>>()
        .join("  ")
}
