//! The longest stable step of particles that a bond style joins, as they stand.

use perigrain_base::diag::{Result, Span};
use perigrain_base::math::vec3::{Vec3, length};
use perigrain_statics::network::Network;
use perigrain_statics::stable_step::Swinging;
use perigrain_styles::bond::{BondForce, Standing, Swing};
use perigrain_styles::matter::Masses;
use perigrain_styles::pull::{apart, find, periods};
use perigrain_styles::words::Words;
use perigrain_world::World;

/// How the step of bonded particles is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Words)]
#[word(what = "estimate of the bonds' step")]
pub enum Estimate {
    /// A bound from the bonds of each particle, 70 to 100 % of the limit.
    #[default]
    Local,
    /// 2/ω of the whole network.
    Exact,
    /// Not at all.
    None,
}

impl Estimate {
    /// The longest step of bonded particles [time]; infinite without bonds.
    ///
    /// # Errors
    /// Ends that are gone.
    pub fn step(self, w: &World, style: Option<&dyn BondForce>, span: Span) -> Result<f64> {
        let Some(style) = style.filter(|_| self != Estimate::None && !w.bonds.is_empty()) else {
            return Ok(f64::INFINITY);
        };
        let Some(body) = swinging(w, style, |_| true, span)? else { return Ok(f64::INFINITY) };
        let step = if self == Estimate::Local { body.bound() } else { body.limit() };
        Ok(step.unwrap_or(f64::INFINITY))
    }
}

/// A bond with the style's numbers for it.
struct Known {
    ends: [usize; 2],
    /// From its first end to the second [length].
    d: Vec3,
    swing: Swing,
}

/// The bonded particles of a scene; `None` where no bond does anything. Those that do not pass `moves` stand still.
///
/// # Errors
/// Ends that are gone.
pub fn swinging(
    w: &World,
    style: &dyn BondForce,
    moves: impl Fn(usize) -> bool,
    span: Span,
) -> Result<Option<Swinging>> {
    let (period, p, masses) = (periods(w)?, &w.particles, Masses::of(w));
    let mass = |i: usize| masses.get(i) / w.settings.units.constants().ftm2v;
    let mut known = vec![];
    for (at, found) in find(w, |_| true, span)? {
        let d = apart(w, &period, found.ends).map(|a| -a);
        let (rest, now) = (w.bonds.list[at].length, length(d));
        let bond = Standing {
            kind: found.kind,
            length: if rest > 0.0 { rest } else { now },
            radii: found.ends.map(|i| p.radius.get(i).copied().unwrap_or(0.0)),
            masses: found.ends.map(mass),
        };
        // The bond style itself refuses ends at one place.
        if now > 0.0
            && let Some(swing) = style.swing(&bond)
        {
            known.push(Known { ends: found.ends, d, swing });
        }
    }
    if known.is_empty() {
        return Ok(None);
    }
    let mut members: Vec<usize> = known.iter().flat_map(|b| b.ends).collect();
    members.sort_unstable();
    members.dedup();
    let mut row = vec![0; w.n()];
    members.iter().zip(0u32..).for_each(|(i, k)| row[*i] = k);
    let ends: Vec<[u32; 2]> = known.iter().map(|b| b.ends.map(|i| row[i])).collect();
    let network = Network::new(members.len(), &ends, |k| (known[k].d, known[k].swing.stiffness));
    let damped = known.iter().any(|b| b.swing.dashpots != Default::default());
    let dashpots = damped.then(|| {
        network.with(network.pairs.origin.iter().map(|k| known[*k as usize].swing.dashpots).collect())
    });
    let inertia = |i: &usize| {
        let m = if moves(*i) { mass(*i) } else { f64::INFINITY };
        let turning = if p.style.oriented { 0.4 * m * p.radius[*i] * p.radius[*i] } else { f64::INFINITY };
        [m, turning]
    };
    let inertia = members.iter().map(inertia).collect();
    Ok(Some(Swinging { network, dashpots, inertia }))
}
