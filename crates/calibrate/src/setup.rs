//! A body between its ends: what is held, what may touch, and what a load gives.

use super::scene::Scene;
use super::touch::{self, Hertz};
use super::words::{Method, Words};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::vec3::Vec3;
use perigrain_bonded::stiffness::Modes;
use perigrain_statics::contacts::Contacts;
use perigrain_statics::dsm::{Stop, relax};
use perigrain_statics::ends::{Ends, Held, Hold, affine, poisson};
use perigrain_statics::load_steps::{Carried, Load};
use perigrain_statics::newton::{Body, End, Found};
use perigrain_statics::periodic::mean_field;
use perigrain_statics::precond::Blocks;
use perigrain_statics::six::Six;
use perigrain_statics::tensor::Moduli;
use perigrain_statics::walls::Walls;
use perigrain_world::{GroupId, World};

/// A body between held ends.
pub struct Setup {
    /// The particles at the ends.
    pub ends: Ends,
    /// What is held.
    pub held: Held,
    /// By how much the high end moves [length].
    pub delta: f64,
    /// Length to which E belongs, and of the body [length].
    pub lengths: [f64; 2],
    /// Cross-section [length²].
    pub area: f64,
    /// Contacts between particles.
    pub contacts: Contacts,
    /// Contacts with walls.
    pub walls: Walls,
    /// Whether displacements are of any size.
    pub large: bool,
    /// Poisson's ratios of the mean field, in the three directions.
    nu: Vec3,
}

/// What a load gives.
#[derive(Clone, Debug, Default)]
pub struct Response {
    /// Displacements and rotations.
    pub field: Vec<Six>,
    /// Energies of stretch, shear, bend and twist of bonds.
    pub modes: Modes,
    /// Energies of contacts and of walls.
    pub energies: [f64; 2],
    /// How many pairs touch.
    pub touching: usize,
    /// How many of them slip.
    pub slipping: usize,
    /// How many touch the low wall and the high one.
    pub at_walls: [usize; 2],
    /// K [force/length].
    pub stiffness: f64,
    /// E [pressure].
    pub young: f64,
    /// ν, the mean of both directions across the load.
    pub poisson: f64,
    /// Steps of conjugate gradients.
    pub iterations: usize,
    /// Steps of Newton's method, where there are contacts.
    pub steps: Option<usize>,
    /// To which part K is known by how fast the energy fell, if it did.
    pub open: f64,
    /// The fraction to which K is certain, if requested.
    pub certain: Option<f64>,
    /// Particles with components that nothing resists.
    pub loose: usize,
    /// Whether the solution has converged.
    pub done: bool,
}

impl Response {
    /// The share of contacts and walls in the energy.
    pub fn share(&self) -> f64 {
        let touching: f64 = self.energies.iter().sum();
        if touching == 0.0 { 0.0 } else { touching / (self.modes.iter().sum::<f64>() + touching) }
    }
}

/// The ends of a body, with walls where the outermost surfaces are, and the lengths of E and of the body.
///
/// # Errors
/// A body without ends, or with both in one place.
pub fn ends(w: &World, scene: &Scene, words: &Words, span: Span) -> Result<(Ends, [f64; 2])> {
    scene.has_ends(w, words.axis, span)?;
    let sample = scene.sample(words.axis);
    let mut ends = Ends::new(&sample, words.thick.unwrap_or_else(|| sample.mean_radius()));
    let extent = sample.extent(words.axis);
    for end in (0..2).filter(|end| words.holds[*end] == Hold::Wall) {
        ends.members[end].clear();
        ends.planes[end] = extent[end];
    }
    let body = extent[1] - extent[0];
    if ends.overlap() || ends.free_length() <= 1e-9 * body {
        let text = "the body is too short: a particle belongs to both of its ends";
        let help = "use `thick T` with a smaller T, by default the mean radius, or choose another axis";
        return Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into());
    }
    let length = if words.body { body } else { ends.free_length() };
    Ok((ends, [length, body]))
}

impl Setup {
    /// Of a scene by the words of a line.
    ///
    /// # Errors
    /// Ends that hold nothing, or belong together.
    pub fn new(
        w: &World,
        scene: &Scene,
        group: GroupId,
        words: &Words,
        hertz: Option<&Hertz>,
        span: Span,
    ) -> Result<Self> {
        let (ends, lengths) = ends(w, scene, words, span)?;
        let sample = scene.sample(words.axis);
        let delta = words.strain * ends.free_length();
        let area = scene.area(words);
        let (mut contacts, mut walls) = (Contacts::default(), Walls::default());
        if let Some(hertz) = hertz {
            walls = touch::walls(w, scene, words, hertz, delta);
            if words.contacts.is_none_or(|(yes, _)| yes) {
                let gap = touch::reach(scene, delta, words.strain);
                contacts = touch::contacts(w, scene, group, hertz, gap, words.relaxed, span)?;
            }
        }
        let held = Held::new(&sample, &ends, words.holds, words.rotations, &tied(scene, &contacts));
        if !held.through && words.wall.is_none() {
            let text = "no chain of bonds leads from end to end: the stiffness is zero";
            let help =
                "check the bonds (`compute bond/local`), or reach further into the body with `thick T`";
            return Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into());
        }
        let moduli = Moduli::new(&mean_field(&scene.network, area * lengths[1]));
        let nu = std::array::from_fn(|d| {
            let repeats = scene.period[d] > 0.0;
            moduli.filter(|_| !repeats && d != words.axis).map_or(0.0, |m| m.poisson[words.axis][d])
        });
        Ok(Self { ends, held, delta, lengths, area, contacts, walls, large: words.by_parts(), nu })
    }

    /// Whether forces are proportional to the load: nothing but bonds, and small displacements.
    pub fn linear(&self) -> bool {
        !self.large && self.contacts.is_empty() && self.walls.is_empty()
    }

    /// Solves to a part of the stiffness, from a field or from the affine one.
    pub fn solve(&self, scene: &Scene, words: &Words, tol: f64, from: Option<Vec<Six>>) -> Response {
        let sample = scene.sample(words.axis);
        let mut start = from.unwrap_or_else(|| self.affine(scene, words));
        if matches!(words.method, Method::Paper(_)) {
            for (row, held) in start.iter_mut().zip(&self.held.mask) {
                *row = std::array::from_fn(|c| if held >> c & 1 == 1 { row[c] } else { 0.0 });
            }
        }
        let mut out = if words.by_parts() {
            self.by_parts(scene, words, tol, &start)
        } else if self.linear() {
            let stop = match (words.method, words.bound) {
                (Method::Paper([linear, _]), _) => Stop::Residual(linear),
                (Method::Pcg, Some(_)) => Stop::Certified(tol),
                (Method::Pcg, None) => Stop::Estimate(tol),
            };
            self.by_bonds(scene, words, stop, start)
        } else {
            self.by_newton(scene, words, tol, start)
        };
        let sides = poisson(&sample, &out.field, &self.held.out, self.delta / self.ends.free_length());
        // Where the box repeats a body keeps its width.
        let across = sample.across();
        let free: Vec<f64> = (0..2).filter(|s| scene.period[across[*s]] == 0.0).map(|s| sides[s]).collect();
        out.poisson = if free.is_empty() { 0.0 } else { free.iter().sum::<f64>() / free.len() as f64 };
        out.young = out.stiffness * self.lengths[0] / self.area;
        out
    }

    /// What the stiffness of bonds alone is at most, by so many steps from the affine field [force/length].
    pub fn at_most(&self, scene: &Scene, words: &Words, steps: usize) -> f64 {
        self.by_bonds(scene, words, Stop::Steps(steps), self.affine(scene, words)).stiffness
    }

    /// The field of a body that follows its ends evenly.
    fn affine(&self, scene: &Scene, words: &Words) -> Vec<Six> {
        affine(&scene.sample(words.axis), &self.ends, words.holds, &self.held, self.delta, self.nu)
    }

    fn by_bonds(&self, scene: &Scene, words: &Words, stop: Stop, start: Vec<Six>) -> Response {
        let blocks = self.blocks(scene);
        let answer = relax(&scene.network, &blocks, &self.held, start, words.rotations, stop);
        let energy = answer.energy();
        Response {
            stiffness: 2.0 * energy / self.delta.powi(2),
            modes: answer.modes,
            iterations: answer.solved.iterations,
            open: answer.solved.open / energy,
            certain: answer.gap.map(|gap| gap / energy),
            loose: blocks.loose,
            done: answer.solved.done,
            field: answer.field,
            ..Response::default()
        }
    }

    /// The preconditioner of the bonds.
    pub fn blocks(&self, scene: &Scene) -> Blocks {
        Blocks::of_network(&scene.network, &self.held.mask)
    }

    fn body<'a>(&'a self, scene: &'a Scene, words: &Words) -> Body<'a> {
        Body {
            network: &scene.network,
            contacts: &self.contacts,
            walls: &self.walls,
            past: None,
            held: &self.held.mask,
            arm: scene.sample(words.axis).mean_radius(),
        }
    }

    /// The force between the ends, which agree but for the residual.
    fn force(&self, words: &Words, walls: &Walls, found: &Found) -> f64 {
        let pull = |end: usize| -> f64 {
            match words.holds[end] {
                Hold::Wall => walls.push(&found.field)[end] * if end == 0 { 1.0 } else { -1.0 },
                _ => self.ends.members[end].iter().map(|k| found.forces[*k as usize][words.axis]).sum(),
            }
        };
        0.5 * (pull(1) - pull(0))
    }

    /// Displacements of any size, surfaces that slip.
    fn by_parts(&self, scene: &Scene, words: &Words, tol: f64, whole: &[Six]) -> Response {
        let load = Load {
            body: self.body(scene, words),
            whole,
            parts: words.parts.map_or(1, |(parts, _)| parts),
            friction: words.friction.map_or(f64::INFINITY, |(mu, _)| mu),
            pressed: !words.relaxed,
            end: End::Part(tol),
        };
        let Carried { found, past, walls, steps, .. } = load.carry();
        let [touching, slipping] = self.contacts.touching(&found.field, Some(&past));
        Response {
            stiffness: self.force(words, &walls, &found) / self.delta,
            modes: scene.network.energy_of_large(&found.field, |_, _| 1.0),
            energies: [self.contacts.energy(&found.field, Some(&past)), walls.energy(&found.field)],
            touching,
            slipping,
            at_walls: walls.touching(&found.field),
            steps: Some(steps),
            open: tol,
            iterations: found.iterations,
            loose: found.loose,
            done: found.done,
            field: found.field,
            ..Response::default()
        }
    }

    fn by_newton(&self, scene: &Scene, words: &Words, tol: f64, start: Vec<Six>) -> Response {
        let end = match words.method {
            Method::Paper(limits) => End::Residuals(limits),
            Method::Pcg => End::Part(tol),
        };
        let found = self.body(scene, words).relax(start, end);
        Response {
            stiffness: self.force(words, &self.walls, &found) / self.delta,
            modes: scene.network.energy(&found.field),
            energies: [self.contacts.energy(&found.field, None), self.walls.energy(&found.field)],
            touching: self.contacts.touching(&found.field, None)[0],
            at_walls: self.walls.touching(&found.field),
            steps: Some(found.residuals.len() - 1),
            open: tol,
            iterations: found.iterations,
            loose: found.loose,
            done: found.done,
            field: found.field,
            ..Response::default()
        }
    }
}

/// For each particle the smallest place in the piece that bonds and touching contacts tie it to.
fn tied(scene: &Scene, contacts: &Contacts) -> Vec<u32> {
    let still = vec![[0.0; 6]; scene.places.len()];
    scene.network.pieces_with(contacts.touching_pairs(&still))
}
