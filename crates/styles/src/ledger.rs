//! The ledger of energy: what a scene holds, and what has gone through each channel since the ledger was opened.

mod powers;

use crate::probe::Probe;
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::vec3::{Vec3, add, dot, sub};
use perigrain_base::par;
use perigrain_peri::families::ForceUnit;
use perigrain_plan::Tick;
use perigrain_world::contacts::{PairWork, WallTouch};
use perigrain_world::{Constant, Named, Under, World};
use powers::Powers;

/// What does work on particles besides their mutual forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Walls.
    Walls,
    /// Gravity.
    Gravity,
    /// All other fixes.
    Imposed,
}

/// Columns of the forces of each channel at the present step.
static FORCES: [Constant<Vec<Vec3>>; 3] =
    [forces("ledger/walls"), forces("ledger/gravity"), forces("ledger/imposed")];
/// And of their torques.
static TORQUES: [Constant<Vec<Vec3>>; 3] =
    [forces("ledger/walls torque"), forces("ledger/gravity torque"), forces("ledger/imposed torque")];
/// Forces and torques as they were before the next fix.
static BEFORE: [Constant<Vec<Vec3>>; 2] = [forces("ledger/force"), forces("ledger/torque")];

const fn forces(name: &'static str) -> Constant<Vec<Vec3>> {
    Constant::moved(name, Under::Anew)
}

/// The role of what rigid bodies with masses of their own have beyond their particles: twice their kinetic energies of translation and of
/// rotation [mass velocity²], and the power of gravity on them.
pub static BODY_ENERGY: Constant<Vec<f64>> = Constant::new("/body energy");

/// The role in `memo` of the energy which a fix has taken from particles for a reservoir so far (`ecouple`).
pub static COUPLED: Constant<Vec<f64>> = Constant::new("/coupled");

/// Contacts with each wall at the last step, by the fix's ID; only while there is a ledger.
pub static WALL_TOUCHES: Constant<Named<Vec<WallTouch>>> = Constant::new("ledger/wall touches");

/// What the contacts of each pair style did at the last step; only while there is a ledger.
pub static PAIR_WORK: Constant<Named<PairWork>> = Constant::new("ledger/pair work");

/// The name of the book in the world's memory.
static BOOK: Constant<Vec<f64>> = Constant::new("energy/ledger");

/// How many powers the ledger follows.
const POWERS: usize = 7;
/// How many numbers the book has.
const NUMBERS: usize = 2 * POWERS + 17;
/// How many numbers older restart files hold: before the ledger kept what was missing at the end of a run, and before it booked
/// the work of contacts between particles.
const FORMER_NUMBERS: [usize; 2] = [NUMBERS - 1, NUMBERS - 5];

/// The channels' sums.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Book {
    /// Power of walls, gravity and what else is imposed, of dashpots, of everything across the normal, of all forces on driven
    /// particles, and against the elastic forces of laws that flow, at the last step.
    power: [f64; POWERS],
    /// Work of the same since the ledger was opened.
    work: [f64; POWERS],
    /// Kinetic energy of driven particles at the last step, and what has come in besides forces.
    driven: [f64; 2],
    /// The wanted residual minus the sums, when the last run began.
    base: f64,
    /// What flow has taken so far, and what laws that flow held at the last opening less what had gone into them.
    flow: [f64; 2],
    /// What walls do and hold.
    walls: Walls,
    /// What contacts of particles do.
    pairs: Pairs,
    /// The residual at the end of the last run, from which the next one continues.
    left: f64,
}

/// What contacts of particles with each other do at a step: the forces that acted, at the velocities of the step's end. Their
/// trapezoidal sums are of second order, since kinetic energy grows by just these forces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Pairs {
    /// Power of dashpots, across the normal, and against the elastic forces of laws that flow.
    damping: f64,
    across: f64,
    pressing: f64,
    /// What overlaps of laws that flow hold.
    held: f64,
}

impl Pairs {
    /// At the present velocities.
    fn measure(w: &World, step: i64) -> Self {
        let work =
            w.facts.get(*PAIR_WORK).into_iter().flat_map(Named::values).filter(|work| work.step == step);
        work.fold(Self::default(), |sum, work| sum.plus(Self::of_style(w, work)))
    }

    fn of_style(w: &World, work: &PairWork) -> Self {
        let p = &w.particles;
        let chunk = |range: std::ops::Range<usize>| {
            let mut sum = Self::default();
            for i in range {
                sum.damping -= dot(work.damping[i], p.v[i]);
                sum.across -= dot(work.across[i], p.v[i]) + dot(work.torque[i], p.omega[i]);
                sum.pressing -= work.pressing.get(i).map_or(0.0, |f| dot(*f, p.v[i]));
            }
            sum
        };
        let sum = par::reduce(p.len().min(work.damping.len()), chunk, Self::plus).unwrap_or_default();
        Self { held: work.held, ..sum }
    }

    fn plus(self, more: Self) -> Self {
        Self {
            damping: self.damping + more.damping,
            across: self.across + more.across,
            pressing: self.pressing + more.pressing,
            held: self.held + more.held,
        }
    }

    fn numbers(&self) -> [f64; 4] {
        [self.damping, self.across, self.pressing, self.held]
    }

    fn of([damping, across, pressing, held]: [f64; 4]) -> Self {
        Self { damping, across, pressing, held }
    }
}

/// What contacts with granular walls hold and do at a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Walls {
    /// Energy of overlaps and of tangential springs [energy].
    stored: [f64; 2],
    /// The part of that which is of laws that flow.
    held: f64,
    /// Power on particles as the wall sees them move, which is what contacts take and give back.
    taken: f64,
    /// Power of dashpots, across the normal, and against the elastic forces of laws that flow.
    damping: f64,
    across: f64,
    pressing: f64,
}

impl Walls {
    /// At the present velocities.
    fn measure(w: &World) -> Self {
        let (p, mut sum) = (&w.particles, Self::default());
        for c in w.facts.get(*WALL_TOUCHES).into_iter().flat_map(Named::values).flatten() {
            let i = c.grain as usize;
            let (true_one, v) = (scale(w, i), sub(p.v[i], c.velocity));
            let (along, central) = (dot(v, c.normal), dot(c.force, c.normal));
            let turning = p.omega.get(i).map_or(0.0, |o| dot(c.torque, *o));
            (0..2).for_each(|k| sum.stored[k] += true_one * c.stored[k]);
            sum.taken += true_one * dot(c.force, v) + turning;
            sum.damping -= true_one * (central - c.push) * along;
            sum.across -= true_one * (dot(c.force, v) - central * along) + turning;
            if c.flows {
                sum.held += true_one * c.stored[0];
                sum.pressing -= true_one * c.push * along;
            }
        }
        sum
    }

    fn numbers(&self) -> [f64; 7] {
        let [normal, springs] = self.stored;
        [normal, springs, self.held, self.taken, self.damping, self.across, self.pressing]
    }

    fn of([normal, springs, held, taken, damping, across, pressing]: [f64; 7]) -> Self {
        Self { stored: [normal, springs], held, taken, damping, across, pressing }
    }
}

impl Book {
    fn read(w: &World) -> Option<Self> {
        let m = w.memo.get(*BOOK).filter(|m| m.len() == NUMBERS || FORMER_NUMBERS.contains(&m.len()))?;
        let powers = |k: usize| std::array::from_fn(|i| m[k + i]);
        let rest = &m[2 * POWERS..];
        Some(Self {
            power: powers(0),
            work: powers(POWERS),
            driven: [rest[0], rest[1]],
            base: rest[2],
            flow: [rest[3], rest[4]],
            walls: Walls::of(std::array::from_fn(|i| rest[5 + i])),
            pairs: Pairs::of(std::array::from_fn(|i| rest.get(12 + i).copied().unwrap_or(0.0))),
            left: rest.get(16).copied().unwrap_or(0.0),
        })
    }

    fn write(&self, w: &mut World) {
        let mut m = [self.power, self.work].concat();
        m.extend(self.driven);
        m.push(self.base);
        m.extend(self.flow);
        m.extend(self.walls.numbers());
        m.extend(self.pairs.numbers());
        m.push(self.left);
        w.memo.insert(*BOOK, m);
    }
}

/// The next run's setup opens the ledger, or continues the one that came with a restart file.
///
/// # Errors
/// None of its own.
pub fn open(w: &mut World) -> Result<()> {
    w.inherit(BOOK.text(), |w| {
        w.inherit("ledger", |w| {
            w.touch();
            Ok(())
        })
    })?;
    // Its first step counts as well.
    if let (true, Some(families)) = (w.memo.contains(*BOOK), &mut *w.families) {
        families.counts_losses = true;
    }
    w.bonds.counts_losses |= w.memo.contains(*BOOK);
    w.facts.get_or_default(*WALL_TOUCHES);
    w.facts.get_or_default(*PAIR_WORK);
    Ok(())
}

/// Whether there is a ledger.
pub fn is_open(w: &World) -> bool {
    w.memo.contains(*BOOK)
}

/// What rigid bodies have beyond their particles: twice their kinetic energies, and the power of gravity.
fn of_bodies(w: &World) -> [f64; 3] {
    let all = w.memo.playing(*BODY_ENERGY).filter_map(|(_, own)| own.first_chunk::<3>());
    all.fold([0.0; 3], |sum, own| par::add(sum, *own))
}

/// Discards the ledger: the next run opens a new one.
pub fn forget(w: &mut World) {
    w.memo.remove(*BOOK);
    w.facts.remove(*WALL_TOUCHES);
    w.facts.remove(*PAIR_WORK);
    FORCES.iter().chain(&TORQUES).chain(&BEFORE).for_each(|c| w.columns.remove(**c));
}

/// The names of the columns of forces and torques.
pub fn columns() -> Vec<&'static str> {
    FORCES.iter().chain(&TORQUES).chain(&BEFORE).map(|key| key.text()).collect()
}

/// Before the fixes of a step change forces.
pub fn begin(w: &mut World, t: &Tick) {
    if t.unchanged {
        return;
    }
    if let Some(families) = &mut *w.families {
        families.counts_losses = true;
    }
    if !w.bonds.counts_losses {
        w.bonds.counts_losses = true;
    }
    // Of channels that nothing adds to in this step there are none.
    FORCES.iter().chain(&TORQUES).for_each(|key| w.columns.remove(**key));
    let n = w.n();
    for (key, now) in BEFORE.iter().zip([&w.particles.f, &w.particles.torque]) {
        let column = w.columns.vector(**key, n);
        column.clone_from(now);
        // Nothing turns in solids; a restart file holds a column for all particles or none.
        column.resize(n, [0.0; 3]);
    }
}

/// After a fix has changed forces, torques or both.
pub fn mark(w: &mut World, t: &Tick, channel: Channel, changed: [bool; 2]) {
    if t.unchanged {
        return;
    }
    let n = w.n();
    for (keys, k) in [(&FORCES, 0), (&TORQUES, 1)] {
        let now = if k == 0 { &w.particles.f } else { &w.particles.torque };
        // Torques may have no rows.
        if !changed[k] || now.len() != n {
            continue;
        }
        let key = *keys[channel as usize];
        let known = w.columns.get_vector(key).is_some();
        let mut sum = if known { std::mem::take(w.columns.vector(key, n)) } else { Vec::with_capacity(n) };
        let before = w.columns.vector(*BEFORE[k], n);
        let changes = now.iter().zip(&*before).map(|(now, before)| sub(*now, *before));
        if known {
            sum.iter_mut().zip(changes).for_each(|(sum, change)| *sum = add(*sum, change));
        } else {
            sum.extend(changes);
        }
        before.clone_from(now);
        *w.columns.vector(key, n) = sum;
    }
}

/// What forces and masses of a particle are to be multiplied with to be true ones.
fn scale(w: &World, i: usize) -> f64 {
    let dense = w.families.as_ref().is_some_and(|f| {
        f.options.unit == ForceUnit::Density && f.place.get(i).is_some_and(|p| *p != u32::MAX)
    });
    if dense { w.volumes()[i] } else { 1.0 }
}

/// Twice the kinetic energies of a particle, straight and turning [mass velocity²].
fn twice_kinetic(w: &World, masses: &super::matter::Masses, i: usize) -> [f64; 2] {
    let p = &w.particles;
    let m = scale(w, i) * masses.get(i);
    let inertia = match p.omega.get(i) {
        Some(o) => 0.4 * m * p.radius[i] * p.radius[i] * dot(*o, *o),
        None => 0.0,
    };
    [m * dot(p.v[i], p.v[i]), inertia]
}

/// The kinetic energies of a scene [energy].
fn kinetic(w: &World) -> [f64; 2] {
    let masses = super::matter::Masses::of(w);
    let half = 0.5 * w.settings.units.constants().mvv2e;
    let chunk = |range: std::ops::Range<usize>| {
        range.fold([0.0; 2], |[straight, turning], i| {
            let [along, around] = twice_kinetic(w, &masses, i);
            [straight + along, turning + around]
        })
    };
    par::reduce(w.n(), chunk, |a, b| [a[0] + b[0], a[1] + b[1]]).unwrap_or_default().map(|e| half * e)
}

/// What contacts of all pair styles hold.
fn held(w: &World, probes: &mut [Box<dyn Probe>]) -> Result<[f64; 2]> {
    let mut sum = [0.0; 2];
    for probe in probes {
        let own = probe.held(w)?;
        (0..2).for_each(|k| sum[k] += own[k]);
    }
    Ok(sum)
}

/// At the end of a step: work by the trapezoidal rule over the powers of two steps. `free` are the bits of groups that
/// equations of motion move; all others are driven. The first step opens the book, as does every step before which a
/// deck has changed the scene.
pub fn account(w: &mut World, t: &Tick, free: u32) {
    let powers = Powers::measure(w, free);
    let [own, spin, weight] = of_bodies(w);
    // Rigid bodies are driven: what moves them besides forces is nothing, whatever their masses are.
    let driven = powers.driven + weight;
    let known = Book::read(w);
    let mut book = known.unwrap_or_default();
    // Where nothing has changed since the last run contacts have nothing new to report.
    if !t.unchanged || known.is_none() {
        (book.walls, book.pairs) = (Walls::measure(w), Pairs::measure(w, t.step));
    }
    let (walls, pairs) = (book.walls, book.pairs);
    let pressing = pairs.pressing + walls.pressing;
    let damping = pairs.damping + walls.damping + w.bonds.power.iter().sum::<f64>();
    let across = pairs.across + walls.across;
    let [by_walls, by_gravity, imposed] = powers.channels;
    // What contacts with walls take they hold or turn into heat: work is what walls do by moving.
    let now = [by_walls - walls.taken, by_gravity + weight, imposed, damping, across, driven, pressing];
    let half = 0.5 * w.settings.units.constants().mvv2e;
    let moving = powers.moving.map(|e| half * e).iter().sum::<f64>() + half * (own + spin);
    let springs = pairs.held + walls.held;
    if t.setup || known.is_none() {
        (book.power, book.driven[0]) = (now, moving);
        book.flow[1] = book.flow[0] + springs - book.work[6];
        book.write(w);
        return;
    }
    let half = 0.5 * t.dt;
    let done: [f64; POWERS] = std::array::from_fn(|k| half * (book.power[k] + now[k]));
    (0..POWERS).for_each(|k| book.work[k] += done[k]);
    // Flow never gives back: what seems so was made from nothing, and stays in the residual.
    book.flow[0] = book.flow[0].max(book.work[6] - springs + book.flow[1]);
    // What moves driven particles against the forces on them.
    book.driven[1] += moving - book.driven[0] - done[5];
    (book.power, book.driven[0]) = (now, moving);
    book.write(w);
}

/// Where a run begins and ends: the residual at the end of the last one is what the next begins with, for what a deck has changed
/// in between is nothing that is missing.
///
/// # Errors
/// What is missing in the scene.
pub fn balance(w: &mut World, t: &Tick, probes: &mut [Box<dyn Probe>]) -> Result<()> {
    let Some(mut book) = Book::read(w).filter(|_| w.tally.step == Some(t.step)) else { return Ok(()) };
    if t.setup {
        let now = sheet(w, probes)?.residual();
        book.base += book.left - now;
    } else {
        book.left = sheet(w, probes)?.residual();
    }
    book.write(w);
    Ok(())
}

/// A balance sheet [energy].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sheet {
    /// Kinetic, rotational, strain, contact; damping, friction, fracture; walls, gravity, imposed.
    pub channels: [f64; 10],
    /// Heat of bonds that relax or flow.
    pub heat: f64,
    /// Strain energy by type.
    pub strain: Vec<f64>,
    /// The part of the contact energy that contacts with walls hold.
    pub walls: f64,
    base: f64,
}

impl Sheet {
    /// What the scene holds.
    pub fn held(&self) -> f64 {
        self.channels[..4].iter().sum()
    }

    /// Held, plus what was turned into heat and cracks, less what came in, since the ledger was opened.
    pub fn residual(&self) -> f64 {
        let sum = |range: std::ops::Range<usize>| self.channels[range].iter().sum::<f64>();
        self.held() + sum(4..7) + self.heat - sum(7..10) + self.base
    }

    /// What has gone in and out, walls' contacts too: the measure of errors where nothing is held. What walls press particles with is no
    /// measure: it may be a million times what these move with.
    pub fn turnover(&self) -> f64 {
        self.channels[4..10].iter().map(|e| e.abs()).sum::<f64>() + self.heat.abs() + self.walls.abs()
    }
}

/// The sheet at the present step, whose energies have been tallied per particle.
///
/// # Errors
/// Energies of another step.
pub fn sheet(w: &World, probes: &mut [Box<dyn Probe>]) -> Result<Sheet> {
    if w.tally.step.is_some_and(|step| step != w.clock.step) {
        let text = format!("the energy is known for step {:?}, not for step {}", w.tally.step, w.clock.step);
        return fail(Code::WRONG_ORDER, None, text);
    }
    let book = Book::read(w).unwrap_or_default();
    let [straight, turning] = kinetic(w);
    let [own, spin, _] = of_bodies(w).map(|e| 0.5 * w.settings.units.constants().mvv2e * e);
    let mut strain = vec![0.0; w.types];
    for (i, energy) in w.tally.atom.iter().enumerate().take(w.n()) {
        strain[usize::from(w.particles.kind[i]) - 1] += scale(w, i) * energy;
    }
    let contacts = held(w, probes)?;
    let bonds = strain.iter().sum::<f64>() + w.tally.bond;
    // Solids break after their energies have been tallied: what broke in this very step is strain still.
    let released = w.bonds.released + w.families.as_ref().map_or(0.0, |f| f.released + f.trailing - f.late);
    let [walls, gravity, imposed, damping, across, ..] = book.work;
    let [normal, springs] = [0, 1].map(|k| contacts[k] + book.walls.stored[k]);
    let channels = [
        straight + own,
        turning + spin,
        bonds,
        normal + springs,
        damping + book.flow[0],
        across - springs,
        released,
        walls,
        gravity,
        imposed + book.driven[1],
    ];
    let heat = w.families.as_ref().map_or(0.0, |f| f.heat);
    let walls = book.walls.stored.iter().sum();
    Ok(Sheet { channels, heat, strain, walls, base: book.base })
}
