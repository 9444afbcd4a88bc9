//! `calibrate ste`: an estimate of the stiffness tensor, with contacts as springs, layers and walls in series.

use super::Line;
use super::cell::moduli;
use super::found::{NUMBERS, lines};
use super::messages;
use super::scene::Scene;
use super::setup::ends;
use super::softer::warn_softer;
use super::touch::{self, Hertz};
use super::words::{Map, Words};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_base::math::vec3::{Vec3, dot};
use perigrain_bonded::stiffness::Stiffness;
use perigrain_neigh::list::Reach;
use perigrain_statics::ends::Hold;
use perigrain_statics::network::Network;
use perigrain_statics::six::{Matrix6, Packed, full};
use perigrain_statics::ste::{Estimate, Layers};
use perigrain_statics::tensor::Moduli;
use perigrain_statics::walls::Walls;
use perigrain_styles::ActCx;
use perigrain_styles::near::{all_within, one_image};
use perigrain_world::{GroupId, World};
use std::borrow::Cow;
use std::time::Instant;

/// A body to be estimated, perhaps again and again.
pub struct Estimator {
    /// The length that counts for K = E A/l [length].
    length: f64,
    /// Its cross-section [length²].
    area: f64,
    /// By how much the load makes it longer, walls included [length].
    delta: f64,
    /// Contacts that touch under the load, as springs.
    springs: Vec<([u32; 2], Vec3, [f64; 2])>,
    walls: Walls,
}

/// What an estimate gives of a body.
pub struct Estimated {
    /// C.
    pub tensor: Matrix6,
    /// E A/l along the axis, or of slabs and walls in series [force/length].
    pub stiffness: f64,
    /// Young's modulus along the axis of what is between the walls [pressure].
    pub young: f64,
    /// Poisson's ratio, the mean of both directions across the load.
    pub poisson: f64,
    /// By how much the load makes it longer [length].
    pub delta: f64,
    /// E A/l of what is between the walls [force/length].
    pub body: f64,
    /// What its tensor is of [length³].
    pub volume: f64,
    /// Particles left out.
    pub without: usize,
    /// The share of contacts in Σ k_n L².
    pub share: f64,
    /// V C of each particle, for slabs and maps.
    local: Vec<Packed>,
}

impl Estimated {
    /// What `calibrate` leaves behind.
    pub fn numbers(&self, order: usize) -> [f64; NUMBERS] {
        let (k, nan) = (self.stiffness, f64::NAN);
        let without = self.without as f64;
        [k, self.young, self.poisson, nan, nan, k * self.delta, self.delta, order as f64, self.share, without]
    }
}

impl Estimator {
    /// Of a scene by the words of a line.
    ///
    /// # Errors
    /// A body without ends in a box that does not repeat along the axis.
    pub fn new(
        w: &World,
        scene: &Scene,
        group: GroupId,
        words: &Words,
        hertz: Option<&Hertz>,
        span: Span,
    ) -> Result<Self> {
        let area = scene.area(words);
        let mut out = Self { length: 0.0, area, delta: 0.0, springs: vec![], walls: Walls::default() };
        if scene.has_ends(w, words.axis, span).is_err() && words.wall.is_none() {
            out.length = scene.width(words.axis);
            out.delta = words.strain * out.length;
        } else {
            // Walls stand outside of what is estimated.
            let held = Words { holds: [Hold::Grip; 2], ..words.clone() };
            out.length = ends(w, scene, &held, span)?.1[0];
            out.delta = words.strain * ends(w, scene, words, span)?.0.free_length();
        }
        let Some(hertz) = hertz else { return Ok(out) };
        out.walls = touch::walls(w, scene, words, hertz, out.delta);
        if words.contacts.is_none_or(|(yes, _)| yes) {
            let gap = touch::reach(scene, out.delta, words.strain);
            let contacts = touch::contacts(w, scene, group, hertz, gap, true, span)?;
            let mut strain = [[0.0; 3]; 3];
            strain[words.axis][words.axis] = words.strain;
            out.springs = contacts.springs(&strain, words.friction.map(|f| f.0));
        }
        Ok(out)
    }

    /// Whether forces are proportional to the load and to the stiffness of bonds.
    pub fn linear(&self) -> bool {
        self.springs.is_empty() && self.walls.is_empty()
    }

    /// Bonds, and contacts as springs besides.
    fn with_contacts(&self, network: &Network) -> Network {
        let bonds = network.bonds();
        let mut all = network.pairs.ends.clone();
        all.extend(self.springs.iter().map(|s| s.0));
        Network::new(network.particles, &all, |k| match k.checked_sub(bonds) {
            None => (network.d(k), network.k[k]),
            Some(at) => {
                let (_, d, [normal, shear]) = self.springs[at];
                (d, Stiffness { normal, shear, ..Stiffness::default() })
            }
        })
    }

    /// Estimates at the present stiffnesses of the bonds.
    ///
    /// # Errors
    /// A tensor that is none of a body; slabs that are too thin.
    pub fn estimate(&self, scene: &Scene, words: &Words, span: Span) -> Result<Estimated> {
        let network = match self.springs.is_empty() {
            true => Cow::Borrowed(&scene.network),
            false => Cow::Owned(self.with_contacts(&scene.network)),
        };
        let estimate = Estimate::new(&network, words.order);
        let tensor = estimate.whole(self.length * self.area);
        let moduli = moduli(&tensor, span)?;
        let wanted = words.slabs.is_some() || words.map.is_some();
        let local = if wanted { estimate.local(&network) } else { vec![] };
        let mut body = moduli.young[words.axis] * self.area / self.length;
        if let Some(height) = words.slabs {
            body = self.in_layers(scene, words, &local, height, span)?;
        }
        let [a, b] = scene.sample(words.axis).across().map(|d| moduli.poisson[words.axis][d]);
        let contacts: f64 = self.springs.iter().map(|(_, d, k)| k[0] * dot(*d, *d)).sum();
        let network = &scene.network;
        let bonds: f64 = (0..network.bonds()).map(|k| network.k[k].normal * network.length(k).powi(2)).sum();
        Ok(Estimated {
            tensor,
            stiffness: if self.walls.is_empty() { body } else { self.between_walls(body) },
            young: body * self.length / self.area,
            body,
            volume: self.length * self.area,
            poisson: 0.5 * (a + b),
            delta: self.delta,
            without: estimate.without(),
            share: if contacts == 0.0 { 0.0 } else { contacts / (contacts + bonds) },
            local,
        })
    }

    /// Slabs across the axis, one behind the other.
    fn in_layers(
        &self,
        scene: &Scene,
        words: &Words,
        local: &[Packed],
        height: Option<f64>,
        span: Span,
    ) -> Result<f64> {
        let sample = scene.sample(words.axis);
        let height = height.unwrap_or(4.0 * sample.mean_radius());
        let count = (self.length / height).round().max(1.0);
        if count > 1e6 {
            return fail(
                Code::BAD_VALUE,
                span,
                "slabs are so thin that there are more than a million of them",
            );
        }
        let [lo, hi] = scene.x.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| {
            [lo.min(x[words.axis]), hi.max(x[words.axis])]
        });
        // Planes of a lattice must not lie on a border of slabs.
        let lo = 0.5 * (lo + hi - self.length) - 1e-3 * sample.mean_radius();
        let shares = self.volumes(scene);
        let along: Vec<f64> = scene.x.iter().map(|x| x[words.axis]).collect();
        let layers = Layers::new(local, &along, &shares, [lo, lo + self.length], count as usize, words.axis);
        if layers.stiffness.is_nan() {
            let text = "a slab resists some strain with a negative stiffness";
            let d = Diagnostic::error(Code::CONFLICT, span, text);
            return Err(d.help("take higher slabs, a lower `order`, or `calibrate dsm`").into());
        }
        Ok(layers.stiffness)
    }

    /// The shares of all particles in the volume, as their own volumes are.
    fn volumes(&self, scene: &Scene) -> Vec<f64> {
        let total: f64 = scene.radius.iter().map(|r| r.powi(3)).sum();
        scene.radius.iter().map(|r| self.length * self.area * r.powi(3) / total).collect()
    }

    /// K along x, y, z of each particle's surroundings, or by which part these are below their mean; zero where a tensor is none of a
    /// body.
    fn map(
        &self,
        w: &World,
        scene: &Scene,
        line: &Line,
        local: &[Packed],
        (map, radius): (Map, f64),
    ) -> Vec<Vec3> {
        let volumes = self.volumes(scene);
        let mut sums: Vec<(f64, Packed)> = volumes.iter().copied().zip(local.iter().copied()).collect();
        let mut row = vec![0; w.n()];
        scene.places.iter().enumerate().for_each(|(k, place)| row[*place] = k);
        let member = |i: usize| w.particles.mask[i] & line.group.bit() != 0;
        for pair in all_within(w, Reach::Fixed(radius), &|i, j| member(i) && member(j)) {
            let ends = [pair.i, pair.j].map(|i| row[i as usize]);
            for [at, from] in [ends, [ends[1], ends[0]]] {
                sums[at].0 += volumes[from];
                (0..21).for_each(|k| sums[at].1[k] += local[from][k]);
            }
        }
        // As if all of the body were so: E A/l along its axis, and its widths along the others.
        let scale = [0, 1, 2].map(|d| match d == line.words.axis {
            true => self.area / self.length,
            false => self.length * self.area / scene.width(d).powi(2),
        });
        let of = |(volume, sum): &(f64, Packed)| {
            let moduli = Moduli::new(&full(&sum.map(|a| a / volume)));
            moduli.map_or([0.0; 3], |m| std::array::from_fn(|d| m.young[d] * scale[d]))
        };
        let all: Vec<Vec3> = sums.iter().map(of).collect();
        if map == Map::Stiffness {
            return all;
        }
        let mean: Vec3 = std::array::from_fn(|d| all.iter().map(|k| k[d]).sum::<f64>() / all.len() as f64);
        let part = |k: f64, mean: f64| if mean > 0.0 { (mean - k) / mean } else { 0.0 };
        all.iter().map(|k| std::array::from_fn(|d| part(k[d], mean[d]))).collect()
    }

    /// F/Δ where F/K of the body and what both walls yield make Δ: halving what brackets F.
    fn between_walls(&self, body: f64) -> f64 {
        let delta = self.delta.abs();
        let yields = |force: f64| force / body + self.walls.yielding(force);
        let (mut low, mut high) = (0.0, body * delta);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if yields(middle) < delta { low = middle } else { high = middle }
        }
        0.5 * (low + high) / delta
    }
}

/// `calibrate ste`.
///
/// # Errors
/// See [`Estimator`].
pub fn run(cx: &mut ActCx, line: &Line, scene: &Scene, hertz: Option<&Hertz>) -> Result<()> {
    let (began, words) = (Instant::now(), &line.words);
    let body = Estimator::new(cx.world, scene, line.group, words, hertz, cx.span)?;
    let e = body.estimate(scene, words, cx.span)?;
    warn_softer(cx, line, scene, hertz, &e);
    line.found.keep(cx.world, e.numbers(words.order), &[], Some(&e.tensor));
    if let Some(map) = words.map {
        one_image(cx.world, map.1, cx.span)?;
        let map = body.map(cx.world, scene, line, &e.local, map);
        line.found.keep_field(cx.world, 0, &scene.places, |k| map[k]);
    }
    let contacts = match body.springs.len() {
        0 => String::new(),
        n => format!(", {n} contacts"),
    };
    let without = match e.without {
        0 => String::new(),
        n => format!("; {n} particles with fewer than three independent bonds left out"),
    };
    cx.print(format!("{}{contacts}{without}", messages::head("ste", line, scene)));
    lines(&e.tensor).for_each(|line| cx.print(line));
    cx.print(format!(
        "  K {}   {}   length {}, area {}   order {}, {:.2} s",
        general(e.stiffness, 5),
        messages::moduli(e.young, e.poisson),
        general(body.length, 5),
        general(body.area, 5),
        words.order,
        began.elapsed().as_secs_f64()
    ));
    Ok(())
}
