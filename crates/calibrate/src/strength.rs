//! `calibrate strength`: the largest force that a body of bonds bears, break by break and without a run.

use super::Line;
use super::found::NUMBERS;
use super::messages::{self, count, warn_loose, warn_unfinished};
use super::scene::{BondQuery, Scene};
use super::setup::Setup;
use super::words::{BREAKING_IN_FITS, Words};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::cformat::general;
use perigrain_bonded::stiffness::Modes;
use perigrain_output::file;
use perigrain_statics::ends::Hold;
use perigrain_statics::six::Six;
use perigrain_statics::strength::{Break, Limits, Path, crumble};
use perigrain_styles::{ActCx, BondForce};
use std::path::Path as FilePath;
use std::time::Instant;

/// The part of the energy to which the unbroken body is solved, over that of what a break changes: an error of the field is the root.
const FIRST: f64 = 1e-2;

/// `calibrate strength`.
///
/// # Errors
/// See [`Setup::new`]; walls, bonds that nothing breaks, a curve that cannot be written.
pub fn run(cx: &mut ActCx, line: &Line, scene: &Scene, style: &dyn BondForce) -> Result<()> {
    let (began, words) = (Instant::now(), &line.words);
    refuse_walls(words)?;
    let setup = Setup::new(cx.world, scene, line.group, words, None, cx.span)?;
    let whole = setup.solve(scene, words, FIRST * words.tol, None);
    let path = broken(&setup, scene, words, style, whole.field.clone(), cx.span)?;
    warn_unfinished(cx, words, whole.done && path.done);
    warn_loose(cx, whole.loose);
    let tested = Tested::new(&setup, &path);
    let numbers = tested.numbers([whole.stiffness, whole.young, whole.poisson]);
    line.found.keep(cx.world, numbers, &[], None);
    if words.fields {
        line.found.keep_motion(cx.world, &scene.places, &path.field);
    }
    cx.print(format!(
        "{}; ends held: {} + {}",
        messages::head("strength", line, scene),
        setup.ends.members[0].len(),
        setup.ends.members[1].len()
    ));
    cx.print(format!(
        "  largest force {}   stress {}   at strain {}   after {}; the first at force {}",
        general(numbers[0], 5),
        general(numbers[1], 5),
        general(numbers[2], 5),
        count(tested.before, "broken bond"),
        general(numbers[9], 5)
    ));
    cx.print(format!(
        "  K {}   {}   length {}, area {}",
        general(whole.stiffness, 5),
        messages::moduli(whole.young, whole.poisson),
        general(setup.ends.free_length(), 5),
        general(setup.area, 5)
    ));
    cx.print(format!(
        "  {} of {} until {}   energy set free {}   {} iterations, {:.2} s",
        count(tested.all, "broken bond"),
        scene.network.bonds(),
        ended(words, &path),
        general(tested.released, 5),
        whole.iterations + path.iterations,
        began.elapsed().as_secs_f64()
    ));
    match &words.curve {
        Some((name, at)) => write(FilePath::new(name), scene, &tested, &path).map_err(|e| e.at(*at)),
        None => Ok(()),
    }
}

/// How the path of breaks ended.
fn ended(words: &Words, path: &Path) -> String {
    if !path.whole {
        return "the body was in two".into();
    }
    if path.breaks.len() >= words.most {
        return "there were as many as `most` allows".into();
    }
    format!("the force was below {} of it", general(words.until, 3))
}

/// A wall's force is not proportional to the load.
///
/// # Errors
/// Ends that are walls.
pub fn refuse_walls(words: &Words) -> Result<()> {
    let Some(at) = words.wall.filter(|_| words.holds.contains(&Hold::Wall)) else { return Ok(()) };
    let text =
        "the strength is found for ends that are held: what a wall does is not proportional to the load";
    let d = Diagnostic::error(Code::NOT_SUPPORTED, at, text);
    Err(d.help("use `grip`, or `plate` for an end that may slide across the load").into())
}

/// Breaks the bonds of a scene one after another, from the field of the unbroken body.
///
/// # Errors
/// Bonds of which none can break.
pub fn broken(
    setup: &Setup,
    scene: &Scene,
    words: &Words,
    style: &dyn BondForce,
    field: Vec<Six>,
    span: Span,
) -> Result<Path> {
    let used = |query: &BondQuery, bears: &Modes| style.used(&query.bearing(*bears));
    if !scene.bonds.iter().any(|query| used(query, &[1.0; 4]).is_some()) {
        let text = format!("bonds of bond_style {} break under no load", style.name());
        let help =
            "give them a strength: `strength S1 S2` behind the coefficients of bpm/beam, with `break yes`";
        return Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into());
    }
    let tol = if words.targets.is_empty() { words.tol } else { BREAKING_IN_FITS };
    let Words { avalanche, until, most, together, .. } = *words;
    let limits = Limits { avalanche, until, most, tol, together };
    let share = |k: usize, bears: &Modes| used(&scene.bonds[k], bears).unwrap_or(0.0);
    let path = crumble(scene.network.clone(), &setup.held, field, &limits, share);
    if path.breaks.is_empty() {
        let text = "no bond bears anything that could break it";
        let help = "check the sign of the strain (below 0 presses), and which bonds have a strength";
        return Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into());
    }
    Ok(path)
}

/// What a path of breaks comes to.
pub struct Tested {
    delta: f64,
    area: f64,
    length: f64,
    peak: Break,
    first: f64,
    /// Bonds broken before the largest force, and in all.
    before: usize,
    all: usize,
    released: f64,
}

impl Tested {
    /// Of a path that has breaks.
    pub fn new(setup: &Setup, path: &Path) -> Self {
        let number = |breaks: &[Break]| breaks.iter().map(|b| b.bonds.len()).sum();
        Self {
            delta: setup.delta.abs(),
            area: setup.area,
            length: setup.lengths[0],
            peak: path.breaks[path.peak].clone(),
            first: path.breaks[0].force(setup.delta.abs()),
            before: number(&path.breaks[..path.peak]),
            all: number(&path.breaks),
            released: path.breaks.iter().map(Break::released).sum(),
        }
    }

    /// The largest force over the section [pressure].
    pub fn stress(&self) -> f64 {
        self.peak.force(self.delta) / self.area
    }

    fn numbers(&self, [stiffness, young, poisson]: [f64; 3]) -> [f64; NUMBERS] {
        let strain = self.peak.load * self.delta / self.length;
        let force = self.peak.force(self.delta);
        let (before, all) = (self.before as f64, self.all as f64);
        [force, self.stress(), strain, stiffness, young, poisson, before, all, self.released, self.first]
    }
}

/// Writes the breaks, a row for each bond.
fn write(name: &FilePath, scene: &Scene, tested: &Tested, path: &Path) -> Result<()> {
    file::replace(name, |out| {
        writeln!(out, "# break strain force stress released id1 id2")?;
        for (k, it) in path.breaks.iter().enumerate() {
            let force = it.force(tested.delta);
            let strain = it.load * tested.delta / tested.length;
            // The energy released by bonds that break together is booked for the first one.
            let mut released = it.released();
            for bond in &it.bonds {
                let [a, b] = scene.bonds[*bond as usize].ids;
                let stress = force / tested.area;
                writeln!(out, "{} {strain:.8e} {force:.8e} {stress:.8e} {released:.8e} {a} {b}", k + 1)?;
                released = 0.0;
            }
        }
        Ok(())
    })
}
