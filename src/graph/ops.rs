//! Ops every plan begins with: reneighbouring at LAMMPS' times, and clearing forces.

use super::spatial;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::{add, same, sub};
use perigrain_base::par;
use perigrain_plan::{About, BlockSums, Level, Needs, Op, Room, Span as Rows, Stage, Tick, Way};
use perigrain_styles::words::Words;
use perigrain_world::bonds::LostBond;
use perigrain_world::columns::HEATFLOW;
use perigrain_world::field::{COLUMNS, F, FACTS, FAMILIES, Fields, TAG, TALLY, TORQUE, TRAVEL, X, X0};
use perigrain_world::index::Index;
use perigrain_world::{Constant, Domain, Extent, Kept, NeighborSettings, Particles, Seen, World, extent};

/// Wraps, shrinks, checks for lost particles and marks lists for a rebuild, at LAMMPS' reneighbour times.
pub struct Reneighbor {
    /// What happens to lost particles.
    pub lost: Lost,
    /// Whether grains are put in the order of space.
    pub sort: bool,
}

/// What happens to particles beyond a fixed face (`thermo_modify lost`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Words)]
#[word(what = "value of lost")]
pub enum Lost {
    /// A particle beyond a fixed face ends the run; the default.
    #[default]
    Error,
    /// It is deleted, with its bonds and contacts, when neighbour lists are built; thermo output warns once.
    Warn,
    /// It is deleted likewise, without a warning.
    Ignore,
}

impl Op for Reneighbor {
    fn about(&self) -> About {
        // Grains are put in the order of space, with all that belongs to them.
        About::new(
            "reneighbor",
            Stage::Neighbor,
            Needs::new().read(X | TRAVEL | FAMILIES | TAG | X0).write(Fields::ALL),
        )
    }
    fn span(&mut self, _: &mut World, _: &Tick) -> Rows {
        Rows::Requested
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if t.setup {
            w.rebuild.builds = 0;
            w.rebuild.dangerous = 0;
            // A box that leans too far since the last step of a run is flipped in the first one of the next, as in LAMMPS.
            w.rebuild.due = w.domain.as_ref().is_some_and(|d| d.flip.is_some());
            w.rebuild.freed.clear();
            return rebuild(w, t, self, true);
        }
        w.rebuild.part();
        if std::mem::take(&mut w.rebuild.due) {
            w.rebuild.builds += 1;
            return rebuild(w, t, self, true);
        }
        let NeighborSettings { skin, delay, every, check, once, .. } = w.settings.neighbor;
        let ago = t.step - w.rebuild.step;
        if ago < delay || (every > 1 && ago % every != 0) || once {
            return Ok(());
        }
        if check {
            let half = 0.5 * (w.rebuild.room(skin) - corners_moved(w)).max(0.0);
            if w.rebuild.seen.within(*w.travel, half) {
                debug_assert!(farthest(w, t)? <= half * half, "particles have moved that no op has reported");
                return Ok(());
            }
            let moved = farthest(w, t)?;
            w.rebuild.seen = Seen::measured(*w.travel, moved.sqrt());
            if moved <= half * half {
                return Ok(());
            }
            let first_chance = ago == every.max(delay);
            // Where lists are looked at in every step none is late; LAMMPS counts these too.
            let late = w.settings.lammps() || delay.max(every) > 1;
            w.rebuild.dangerous += u64::from(first_chance && late);
        }
        w.rebuild.builds += 1;
        rebuild(w, t, self, false)
    }
}

/// How far the two corners of the box have moved since the last rebuild, together.
fn corners_moved(w: &World) -> f64 {
    let (Some(domain), Some([lo, hi])) = (&*w.domain, w.rebuild.corners) else { return 0.0 };
    let tilt = w.rebuild.tilt;
    if same(domain.lo, lo) && same(domain.hi, hi) && domain.tilt.is_none_or(|now| now == tilt) {
        return 0.0;
    }
    let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|d| (a[d] - b[d]) * (a[d] - b[d])).sum::<f64>().sqrt();
    if !domain.tilted() && tilt == [0.0; 3] {
        return apart(domain.lo, lo) + apart(domain.hi, hi);
    }
    // Of a leaning box all eight count, and the two that moved farthest.
    let before = Domain { lo, hi, tilt: Some(tilt), ..domain.clone() };
    let (mut ways, lammps) = ([0.0, 0.0], w.settings.lammps());
    // Corners that move alike do so up to rounding, which LAMMPS goes by.
    let more = if lammps { 1.0 } else { 1.0 + 1e-12 };
    for (a, b) in domain.corners().into_iter().zip(before.corners()) {
        let way = apart(a, b);
        if way > ways[0] * more {
            // LAMMPS drops the largest displacement so far, and rebuilds its lists at these times.
            ways = [way, if lammps { ways[1] } else { ways[0] }];
        } else if way > ways[1] {
            ways[1] = way;
        }
    }
    ways[0] + ways[1]
}

/// Particles about to be wrapped into a growing box get the velocity of the image they become.
fn carry(domain: &Domain, p: &mut Particles) {
    let Some(flow) = domain.flow else { return };
    for i in (0..p.x.len()).filter(|&i| p.mask[i] & flow.group.bit() != 0) {
        let at = domain.upright(&p.x[i]);
        for d in (0..3).filter(|&d| domain.boundary.periodic(d)) {
            let mut edge = [0.0; 3];
            edge[d] = 1.0;
            if at[d] < domain.lo[d] {
                p.v[i] = add(p.v[i], flow.velocity(edge));
            } else if at[d] >= domain.hi[d] {
                p.v[i] = sub(p.v[i], flow.velocity(edge));
            }
        }
    }
}

/// Largest squared displacement since the last rebuild, on all ranks.
fn farthest(w: &mut World, t: &Tick) -> Result<f64> {
    let (x, held) = (&w.particles.x, w.held());
    let most = match &w.share {
        None => extent::farthest(x, held),
        Some(share) => {
            let own = share.own.iter().map(|rows| extent::farthest(&x[rows.clone()], &held[rows.clone()]));
            let mut most = own.fold(0.0, f64::max);
            share.agree(std::iter::once(&mut most));
            most
        }
    };
    if most.is_finite() {
        return Ok(most);
    }
    w.whole(Fields::ALL);
    let (x, held) = (&w.particles.x, w.held());
    let lost = |i: &usize| !extent::farthest(&x[*i..=*i], &held[*i..=*i]).is_finite();
    Err(not_finite(w, (0..x.len()).find(lost).unwrap_or(0), t))
}

fn not_finite(w: &World, i: usize, t: &Tick) -> perigrain_base::diag::Diagnostics {
    let (p, held) = (&w.particles, w.held());
    // Two that were in one place have no direction in which to push each other.
    let same = |x: &[f64; 3]| (0..p.len().min(held.len())).find(|&j| j != i && held[j] == *x);
    if let Some(j) = held.get(i).and_then(same) {
        let tags = [p.tag[i].min(p.tag[j]), p.tag[i].max(p.tag[j])];
        let text = format!(
            "particles {} and {} were in the same place, {:?}: the force between them had no direction (step {})",
            tags[0], tags[1], held[i], t.step
        );
        let d = Diagnostic::error(Code::NOT_FINITE, None, text);
        return d.help("create particles where no other one is, or `delete_atoms overlap` beforehand").into();
    }
    Diagnostic::error(
        Code::NOT_FINITE,
        None,
        format!(
            "particle {} (type {}) has no finite position any more at step {}: x = {:?}, v = {:?}",
            p.tag[i], p.kind[i], t.step, p.x[i], p.v[i]
        ),
    )
    .help("the time step is too long for the stiffness, or particles overlapped heavily: shorten `timestep`")
    .into()
}

/// Puts the box of the same lattice in the place of one that leans too far. Places stay where they are, in other images.
fn flip(w: &mut World) {
    let lammps = w.settings.lammps();
    let Some(domain) = &mut *w.domain else { return };
    let Some(flip) = domain.flip.take() else { return };
    let p = &mut w.particles;
    if !lammps {
        // In LAMMPS particles that have crossed a face since the last rebuild keep their velocities here.
        carry(domain, p);
        let all: Vec<usize> = (0..p.x.len()).collect();
        p.image.wrap(domain, &mut p.x, &all);
    }
    domain.tilt = Some(flip.tilt);
    for i in 0..p.x.len() {
        let mut image = flip.recount(p.image[i]);
        domain.wrap(&mut p.x[i], &mut image);
        p.image.set(i, image);
    }
}

/// `anew`: the scene may have changed, so that no list can stay.
fn rebuild(w: &mut World, t: &Tick, how: &Reneighbor, anew: bool) -> Result<()> {
    w.whole(Fields::ALL);
    let n = w.n();
    let before = w.rebuild.generation;
    if !t.setup {
        flip(w);
    }
    let Some(domain) = &mut *w.domain else { return Ok(()) };
    let p = &mut w.particles;
    let extent = Extent::of(&p.x, domain);
    if let Some(bad) = extent.as_ref().and_then(|e| e.bad) {
        return Err(not_finite(w, bad, t));
    }
    carry(domain, p);
    let inside = extent.is_none_or(|extent| {
        p.image.wrap(domain, &mut p.x, &extent.out);
        domain.shrink(extent.corners);
        if domain.tilted() && domain.shrinks() {
            // A box that leans stands elsewhere when its lower face has moved.
            carry(domain, p);
            p.image.wrap(domain, &mut p.x, &(0..n).collect::<Vec<_>>());
        }
        // Across fixed faces no particle has been wrapped: there the corners still are those of all.
        extent.corners.iter().all(|corner| domain.keeps_upright(corner))
    });
    let domain = &*domain;
    if !inside {
        let lost: Vec<usize> = (0..n).filter(|&i| !domain.keeps(&p.x[i])).collect();
        if how.lost == Lost::Error {
            return Err(too_far(w, &lost, t));
        }
        w.rebuild.lost += lost.len() as u64;
        lose(w);
        warn_of_bonds(w, t);
    }
    let same = how.sort && !anew && w.n() == n;
    if !same {
        w.rebuild.kept = Kept::default();
    }
    let stays = same && spatial::stays(w);
    if how.sort && !stays {
        spatial::line_up(w);
    }
    w.rebuild.generation += 1;
    if stays {
        w.rebuild.kept.last = [before, w.rebuild.generation];
    }
    w.rebuild.step = t.step;
    // Ops that make radii grow report so anew in each run.
    w.rebuild.grown = w.rebuild.grown.map(|_| 0.0).filter(|_| !t.setup);
    hold(w);
    Ok(())
}

/// Deletes the particles beyond fixed faces in LAMMPS' order, one axis after the other: later random numbers depend on it.
fn lose(w: &mut World) {
    w.fall_back();
    for d in 0..3 {
        let Some(domain) = &*w.domain else { return };
        let marked: Vec<bool> = w.particles.x.iter().map(|x| !domain.keeps_along(d, x)).collect();
        if marked.contains(&true) {
            w.delete(&marked, false);
        }
    }
}

/// `thermo_modify lost/bond warn`: warns of bonds that have lost one of their ends.
fn warn_of_bonds(w: &mut World, t: &Tick) {
    if w.bonds.lost != LostBond::Warn || w.bonds.is_empty() {
        return;
    }
    let (index, tags) = (Index::new(&w.particles.tag), &w.particles.tag);
    let torn = w.bonds.list.iter().filter(|b| b.ends.iter().any(|t| index.find(*t, tags).is_none())).count();
    if torn > 0 {
        let text =
            format!("{torn} bonds have lost one of their ends, at step {}: they exert no force", t.step);
        w.notes.push(Diagnostic::warning(Code::LOST, None, text));
    }
}

fn too_far(w: &World, lost: &[usize], t: &Tick) -> perigrain_base::diag::Diagnostics {
    let p = &w.particles;
    let tags: Vec<String> = lost.iter().take(5).map(|&i| p.tag[i].to_string()).collect();
    let i = lost[0];
    Diagnostic::error(
        Code::LOST,
        None,
        format!(
            "particles lost through a fixed face at step {}: {}{} (the first is at {:?}, v = {:?})",
            t.step,
            tags.join(" "),
            if lost.len() > 5 { " …" } else { "" },
            p.x[i],
            p.v[i]
        ),
    )
    .help("enlarge the box, or let it follow the particles with `boundary s s s` or `m`")
    .help("`thermo_modify lost warn` or `ignore` deletes such particles and continues")
    .into()
}

/// Keeps the present positions; those of creation are kept already.
fn hold(w: &mut World) {
    let (p, rebuild) = (&w.particles, &mut *w.rebuild);
    rebuild.seen = Seen::measured(*w.travel, 0.0);
    rebuild.corners = w.domain.as_ref().map(|d| [d.lo, d.hi]);
    rebuild.tilt = w.domain.as_ref().and_then(|d| d.tilt).unwrap_or_default();
    // A scene without particles does not count as unmoved.
    rebuild.unmoved = !p.x0.is_empty() && p.x == p.x0;
    if rebuild.unmoved {
        rebuild.held = Vec::new();
    } else {
        rebuild.held.reserve_exact(p.x.len().saturating_sub(rebuild.held.len()));
        rebuild.held.resize(p.x.len(), [0.0; 3]);
        par::each((&mut rebuild.held[..], &p.x[..]), |_, (held, x)| held.copy_from_slice(x));
    }
}

/// Forces and torques of the coming step have been set to zero already.
static CLEARED: Constant<()> = Constant::new("clear forces/done");

/// Forces and torques to zero; the tally starts.
pub struct ClearForces;

impl Op for ClearForces {
    fn about(&self) -> About {
        About {
            level: Level::Every,
            fuses: true,
            ..About::new(
                "clear forces",
                Stage::PreForce,
                Needs::new().write(F | TORQUE | COLUMNS | TALLY | FACTS).only(&[HEATFLOW.text()]),
            )
        }
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let cleared = w.facts.remove(*CLEARED).is_some();
        if t.setup || !cleared {
            w.particles.f.fill([0.0; 3]);
            w.particles.torque.fill([0.0; 3]);
        }
        if let Some(heat) = w.columns.property(*HEATFLOW) {
            let n = w.particles.len();
            w.columns.scalar(heat, n).fill(0.0);
        }
        // Of several levels of steps the shorter ones have tallied by now.
        if (t.energy || t.virial) && t.phase.level == 0 {
            w.tally.clear(t.step, t.virial, t.atom_energy, w.particles.len());
            w.tally.clear_atom_virial(t.atom_virial, w.particles.len());
        }
        Ok(())
    }
    fn span(&mut self, w: &mut World, _: &Tick) -> Rows {
        if w.columns.past().property(*HEATFLOW).is_some() { Rows::All } else { Rows::Own }
    }
    fn way(&mut self, _: &mut World, t: &Tick, room: &mut Room) -> Way {
        if t.on {
            room.clear();
            return Way::Blocks;
        }
        Way::Alone
    }
    fn fused(&mut self, w: &mut World, _: &Tick, _: BlockSums) {
        w.facts.insert(*CLEARED, ());
    }
}
