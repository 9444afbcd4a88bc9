//! Half kicks and drifts of velocity Verlet in one pass over memory, fused with forces that act right before
//! and after.

mod pass;

use super::nve::half_step;
use pass::{Kick, Part};
use perigrain_base::diag::Result;
use perigrain_base::math::real::largest;
use perigrain_plan::{BlockSums, ParticleBlock, Room, Solids, Tick};
use perigrain_styles::matter::Masses;
use perigrain_styles::step_op::StepOp;
use perigrain_world::{GroupId, World};

/// Rotation of particles.
#[derive(Clone, Copy)]
pub struct Turning {
    /// I / (m R²).
    pub inertia: f64,
    /// Whether they have orientations.
    pub oriented: bool,
}

/// Lets the op that begins a step integrate whole blocks of particles: half kicks and drifts of a group; with
/// `turning` also spins, ω += Δt/2 · torque/I. The largest displacement is recorded in the world's `Travel`.
pub fn first<F>(op: StepOp<F>, group: GroupId, turning: Option<Turning>) -> StepOp<F>
where
    F: FnMut(&mut World, &Tick) -> Result<()> + Send + 'static,
{
    op.fusing(move |w, t, room| whole(w, (group, turning), t, Part::First, room), went).without_sums()
}

/// The same for the op that ends a step and may begin the next one.
pub fn second<F>(op: StepOp<F>, group: GroupId, turning: Option<Turning>) -> StepOp<F>
where
    F: FnMut(&mut World, &Tick) -> Result<()> + Send + 'static,
{
    let part = |t: &Tick| if t.on { Part::Both } else { Part::Second };
    op.fusing(move |w, t, room| whole(w, (group, turning), t, part(t), room), went).without_sums()
}

/// A part of a step, or of one time step level; only the shortest level drifts. For separate step lengths of
/// grains and solids see [`some`]. Always `true`: a part is always added to `room`.
fn whole(
    w: &World,
    (group, turning): (GroupId, Option<Turning>),
    t: &Tick,
    part: Part,
    room: &mut Room,
) -> bool {
    let (short, solids) = (t.phase.level == 0, t.phase.solids.clone());
    let part = if part == Part::First && !short && solids.is_none() { Part::Second } else { part };
    // Bonds of solids exert no torques, so that short steps skip rotation.
    let turning = turning.filter(|_| solids.is_none() || !short);
    let half = half_step(w, t.dt);
    let k = Kick {
        half,
        spin: turning.map_or(0.0, |turn| half / turn.inertia),
        dt: t.dt,
        bit: group.bit(),
        oriented: turning.is_some_and(|turn| turn.oriented),
    };
    let (spins, own) = (turning.is_some(), w.particles.style.own_mass());
    let Some(solids) = solids else {
        match own {
            true => room.moving(move |s, beside| k.together(s, spins, part, s.all.mass, beside)),
            false => room.act(move |s: &mut ParticleBlock<'_>| {
                let masses = Masses::new(s.all.style, s.all.mass, s.all.kind, s.all.type_mass);
                moved(k.part_of(s, 0..s.x.len(), spins, part, &masses))
            }),
        }
        return true;
    };
    room.act(move |s: &mut ParticleBlock<'_>| {
        let masses = Masses::new(s.all.style, s.all.mass, s.all.kind, s.all.type_mass);
        moved(some(&k, s, spins, part, &masses, (&solids, short)))
    });
    true
}

/// Result of a motion: the largest v².
fn moved(most: f64) -> BlockSums {
    BlockSums { most, ..BlockSums::default() }
}

/// A part of a step of two lengths: the long one kicks all particles and drifts all but the solids; the short
/// ones kick and drift the solids. The particles of a solid are contiguous: one decision serves the whole run
/// of particles.
fn some(
    k: &Kick,
    s: &mut ParticleBlock,
    spins: bool,
    part: Part,
    masses: &Masses,
    (solids, short): (&Solids, bool),
) -> f64 {
    let (mut from, mut most) = (0, 0.0);
    while from < s.x.len() {
        let (kind, mask) = (&s.all.kind[s.start + from..s.start + s.x.len()], &s.mask()[from..]);
        let own = from..from + alike(kind, mask);
        let solid = solids.has(kind[0]);
        let drifts = short || !solid || mask[0] & solids.twice != 0;
        let part = if drifts { part } else { Part::Second };
        if solid || !short {
            most = largest(most, k.part_of(s, own.clone(), spins, part, masses));
        }
        from = own.end;
    }
    most
}

/// The number of particles from the first on that share its type and groups.
fn alike(kind: &[u16], mask: &[u32]) -> usize {
    const EACH: usize = 16;
    let (first, bits) = (kind[0], mask[0]);
    let mut n = 0;
    // Whole chunks are compared without a branch per particle.
    for (kind, mask) in kind.chunks_exact(EACH).zip(mask.chunks_exact(EACH)) {
        let differ = kind.iter().fold(0, |d, k| d | (k ^ first)) != 0;
        if differ || mask.iter().fold(0, |d, m| d | (m ^ bits)) != 0 {
            break;
        }
        n += EACH;
    }
    n + kind[n..].iter().zip(&mask[n..]).take_while(|(k, m)| (**k, **m) == (first, bits)).count()
}

/// Records the displacement of a part in the world's `Travel`.
fn went(w: &mut World, t: &Tick, sums: BlockSums) {
    w.travel.went(t.dt.abs() * sums.most.sqrt());
}
