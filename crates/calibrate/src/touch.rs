//! Contacts of a body's particles with each other and with walls at its ends, by the pair style's law.

use super::scene::Scene;
use super::words::Words;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::length;
use perigrain_neigh::list::{Reach, difference};
use perigrain_statics::contact::Contact;
use perigrain_statics::contacts::Contacts;
use perigrain_statics::ends::Hold;
use perigrain_statics::walls::Walls;
use perigrain_styles::ActCx;
use perigrain_styles::near::within;
use perigrain_styles::probe::Probe;
use perigrain_world::{GroupId, World};

/// Coefficients of Hertz' law by pair of types.
pub struct Hertz {
    types: usize,
    /// 4/3 E* and 8 G* [pressure].
    table: Vec<[f64; 2]>,
}

/// How many times closer contacts come than the strain of the whole suggests, at most.
const CLOSER: f64 = 5.0;
/// Relative difference of powers of two between overlaps where a law is not Hertz'.
const ALIKE: f64 = 1e-6;

impl Hertz {
    /// For the pair style in force and particles of this size; `None` where contacts do not count: the line excludes them, or the
    /// pair style has no contacts and the line does not require them.
    ///
    /// # Errors
    /// Required contacts that the pair style lacks, or of another law.
    pub fn new(cx: &ActCx, words: &Words, radius: f64) -> Result<Option<Self>> {
        let asked = match (words.contacts, words.wall) {
            (Some((false, _)), None) => return Ok(None),
            (Some((true, at)), _) => Some(at),
            (_, wall) => wall.or(words.friction.map(|(_, at)| at)),
        };
        let probes = cx.values.probes(cx.world)?;
        let types = cx.world.types;
        let mut table = vec![[0.0; 2]; types * types];
        for (k, entry) in table.iter_mut().enumerate() {
            let pair = [(k / types) as u16 + 1, (k % types) as u16 + 1];
            match law(&probes, pair, radius) {
                Some(found) => *entry = found,
                None if asked.is_none() => {
                    let text =
                        "contacts are left out: their force does not grow as overlap^3/2, as Hertz' does";
                    cx.note(
                        Diagnostic::warning(Code::NO_EFFECT, cx.span, text)
                            .help("`contacts no` states that this is meant"),
                    );
                    return Ok(None);
                }
                None => {
                    let text = format!("contacts of types {} and {} are not Hertz'", pair[0], pair[1]);
                    return Err(Diagnostic::error(Code::NOT_SUPPORTED, asked, text)
                        .help("`pair_coeff … hertz/material E eta nu tangential mindlin NULL …` has such contacts")
                        .into());
                }
            }
        }
        if table.iter().any(|c| c[0] > 0.0) {
            return Ok(Some(Self { types, table }));
        }
        let Some(at) = asked else { return Ok(None) };
        let what = if words.wall.is_some() { "walls need" } else { "contacts need" };
        let text = format!("{what} the coefficients of Hertz contacts, and the pair style has none");
        Err(Diagnostic::error(Code::INCOMPLETE, at, text)
            .help("declare `pair_style granular` with `pair_coeff * * hertz/material E eta nu tangential mindlin NULL …` before this line")
            .into())
    }

    fn get(&self, a: u16, b: u16) -> [f64; 2] {
        self.table[(usize::from(a) - 1) * self.types + usize::from(b) - 1]
    }
}

/// F/(√R* δ^3/2) and k_t/√(R* δ) of two types; `None` where these are not the same at two overlaps.
fn law(probes: &[Box<dyn Probe>], types: [u16; 2], radius: f64) -> Option<[f64; 2]> {
    let curvature = 0.5 * radius;
    let at = |overlap: f64| {
        let mut sum = [0.0; 2];
        for [push, across, _] in probes.iter().filter_map(|p| p.pressed(types, overlap, curvature)) {
            let root = (curvature * overlap).sqrt();
            sum = [sum[0] + push / (root * overlap), sum[1] + across / root];
        }
        sum
    };
    let (near, far) = (at(1e-4 * radius), at(1e-2 * radius));
    let alike = (0..2).all(|k| (near[k] - far[k]).abs() <= ALIKE * far[k].abs());
    (alike && far[0] >= 0.0 && far[1] >= 0.0).then_some(far)
}

/// How far apart surfaces are that may come to touch under a load [length].
pub fn reach(scene: &Scene, delta: f64, strain: f64) -> f64 {
    let largest = scene.radius.iter().fold(0.0, |most: f64, r| most.max(*r));
    delta.abs().min(CLOSER * strain.abs() * 2.0 * largest)
}

/// All contacts between particles of a body whose surfaces are closer than `gap`.
///
/// # Errors
/// Particles in one place.
pub fn contacts(
    w: &World,
    scene: &Scene,
    group: GroupId,
    hertz: &Hertz,
    gap: f64,
    relaxed: bool,
    span: Span,
) -> Result<Contacts> {
    let p = &w.particles;
    let member = |i: usize| p.mask[i] & group.bit() != 0;
    let found = within(w, Reach::Beyond(gap), &|i, j| member(i) && member(j));
    let found: Vec<_> = found
        .into_iter()
        .filter(|c| hertz.get(p.kind[c.i as usize], p.kind[c.j as usize])[0] > 0.0)
        .collect();
    let mut row = vec![0; w.n()];
    scene.places.iter().enumerate().for_each(|(k, place)| row[*place] = k as u32);
    let ends: Vec<[u32; 2]> = found.iter().map(|c| [row[c.i as usize], row[c.j as usize]]).collect();
    if let Some(c) =
        found.iter().find(|c| length(difference(&p.x, &Periods::upright(scene.period), c)) == 0.0)
    {
        let [a, b] = [c.i, c.j].map(|i| p.tag[i as usize]);
        let text = format!("particles {a} and {b} are in one place");
        return Err(Diagnostic::error(Code::CONFLICT, span, text).into());
    }
    Ok(Contacts::new(scene.places.len(), &ends, |k| {
        let [i, j] = [found[k].i as usize, found[k].j as usize];
        // From j to i.
        let d = difference(&p.x, &Periods::upright(scene.period), &found[k]);
        let l = length(d);
        let arms = [p.radius[i], p.radius[j]];
        let root = (arms[0] * arms[1] / (arms[0] + arms[1])).sqrt();
        let [normal, tangential] = hertz.get(p.kind[i], p.kind[j]).map(|c| c * root);
        Contact { n: d.map(|d| -d / l), overlap: arms[0] + arms[1] - l, normal, tangential, arms, relaxed }
    }))
}

/// The contacts with walls at the ends of a body.
///
/// The planes are rigid: such a contact is twice as stiff as one of two particles of the same kind, and its radius is that of the
/// particle.
pub fn walls(w: &World, scene: &Scene, words: &Words, hertz: &Hertz, delta: f64) -> Walls {
    let sample = scene.sample(words.axis);
    let [lo, hi] = sample.extent(words.axis);
    let mut out = Walls { axis: words.axis, delta, near: [vec![], vec![]] };
    for (k, (x, r)) in scene.x.iter().zip(&scene.radius).enumerate() {
        let kind = w.particles.kind[scene.places[k]];
        let normal = 2.0 * hertz.get(kind, kind)[0] * r.sqrt();
        let x = x[words.axis];
        for (end, gap) in [(0, x - r - lo), (1, hi - x - r)] {
            if words.holds[end] == Hold::Wall && gap <= delta.abs() && normal > 0.0 {
                out.near[end].push((k as u32, -gap.max(0.0), normal));
            }
        }
    }
    out
}
