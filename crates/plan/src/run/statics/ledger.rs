//! The energies of a statics run: work = change of the energy + energy of broken bonds + energy given up in between.

use super::Body;
use perigrain_base::par;
use perigrain_world::World;

/// Energies since the first load step, in the unit of energy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Work of what stands on paths, of loads on free particles, and of heat that strains bonds.
    pub work: f64,
    /// Change of the potential energy.
    pub energy: f64,
    /// Energy of bonds where they broke.
    pub released: f64,
    /// Energy given up on the way from a break to the next equilibrium, which motion would have carried away.
    pub relaxed: f64,
    /// Energy that bonds and materials lose which soften, flow or relax; of bonds that flow or relax with the error of load steps.
    pub lost: f64,
    /// What work is beyond all these: the error of the mean of forces in load steps, and of equilibria.
    pub error: f64,
}

/// What it is booked from.
#[derive(Debug, Default)]
pub(in crate::run) struct Books {
    numbers: Ledger,
    /// Bonds remember, and what they lose is known as the rest alone: they flow or relax.
    pub remembers: bool,
    first: f64,
    /// The energy at the last equilibrium, or behind the last break.
    last: f64,
    /// What heat had added to that of bonds by then.
    warmed: f64,
    /// Forces of bonds and contacts, without those of fixes, as they are now and were at the last equilibrium.
    inner: Vec<[f64; 3]>,
    before: Vec<[f64; 3]>,
    /// Loads on free particles, likewise.
    loads: [Vec<[f64; 3]>; 2],
    places: Vec<[f64; 3]>,
}

impl Books {
    pub fn numbers(&self) -> Ledger {
        self.numbers
    }

    /// Takes note of the forces before fixes act.
    pub fn inner(&mut self, w: &World, body: &Body) {
        self.inner.clear();
        self.inner.extend(w.particles.f.iter().zip(&body.weight).map(|(f, m)| f.map(|a| a * m)));
    }

    fn load(&mut self, w: &World, body: &Body) {
        let now = &mut self.loads[1];
        now.clear();
        let all = w.particles.f.iter().zip(&body.weight).zip(&self.inner);
        now.extend(all.map(|((f, m), inner)| std::array::from_fn(|d| f[d] * m - inner[d])));
    }

    pub fn begin(&mut self, w: &World, body: &Body) {
        let energy = energy(w, body);
        (self.first, self.last) = (energy, energy);
        self.warmed = warmed(w);
        self.load(w, body);
        self.keep(w);
    }

    fn keep(&mut self, w: &World) {
        self.before.clone_from(&self.inner);
        let [before, now] = &mut self.loads;
        before.clone_from(now);
        self.places.clone_from(&w.particles.x);
    }

    /// The reactions of what is held and the loads on what is free, as the two-norms of both [force].
    pub fn scale(&mut self, w: &World, body: &Body) -> f64 {
        self.load(w, body);
        let (inner, loads) = (&self.inner, &self.loads[1]);
        let [reaction, load] = sums(w.n(), |i, d| match body.frees(i, d) {
            false => [inner[i][d] * inner[i][d], 0.0],
            true => [0.0, loads[i][d] * loads[i][d]],
        });
        reaction.sqrt().max(load.sqrt())
    }

    /// An equilibrium: what has been worked since the last one, by the mean of forces there and here. `torn`: bonds broke there.
    pub fn balanced(&mut self, w: &World, body: &Body, torn: bool) {
        let energy = energy(w, body);
        self.load(w, body);
        let (x, from) = (&w.particles.x, &self.places);
        let periods = w.periods();
        let path = |i: usize, d: usize| {
            let moved = x[i][d] - from[i][d];
            let length = periods.length[d];
            if length > 0.0 { moved - length * (moved / length).round() } else { moved }
        };
        let (inner, before, [old, new]) = (&self.inner, &self.before, &self.loads);
        let [work, _] = sums(w.n(), |i, d| match body.frees(i, d) {
            false => [-0.5 * (inner[i][d] + before[i][d]) * path(i, d), 0.0],
            true => [0.5 * (old[i][d] + new[i][d]) * path(i, d), 0.0],
        });
        let heat = warmed(w) - self.warmed;
        self.warmed += heat;
        let work = work + heat;
        self.numbers.work += work;
        self.numbers.energy = energy - self.first;
        let taken = w.families.as_ref().filter(|families| families.knows_what_it_takes());
        let taken = taken.map_or(0.0, |families| families.taken);
        self.numbers.lost += taken;
        let given_up = self.last + work - energy - taken;
        let numbers = &mut self.numbers;
        *match (torn, self.remembers) {
            (true, _) => &mut numbers.relaxed,
            (false, true) => &mut numbers.lost,
            (false, false) => &mut numbers.error,
        } += given_up;
        self.last = energy;
        self.keep(w);
    }

    /// Bonds have broken, and nothing has moved since.
    pub fn broken(&mut self, w: &World, body: &Body) {
        let energy = energy(w, body);
        self.numbers.released += self.last - energy;
        self.numbers.energy = energy - self.first;
        self.last = energy;
    }
}

/// The energy of bonds and contacts, without that of fixes, whose loads are booked as work.
fn energy(w: &World, body: &Body) -> f64 {
    let of = |list: &[f64], i: usize| list.get(i).copied().unwrap_or(0.0);
    par::sum(w.n(), |i| (of(&w.tally.atom, i) + of(&w.tally.bond_atom, i)) * body.weight[i])
}

/// What heat has added to the energy of bonds so far.
fn warmed(w: &World) -> f64 {
    w.families.as_ref().map_or(0.0, |families| families.warmed)
}

/// Two sums over the components of particles, in an order that no number of threads changes.
fn sums(n: usize, of: impl Fn(usize, usize) -> [f64; 2] + Sync) -> [f64; 2] {
    let chunk = |rows: std::ops::Range<usize>| {
        let mut sums = [0.0; 2];
        for (i, d) in rows.flat_map(|i| (0..3).map(move |d| (i, d))) {
            let [a, b] = of(i, d);
            sums = [sums[0] + a, sums[1] + b];
        }
        sums
    };
    par::reduce(n, chunk, |a, b| [a[0] + b[0], a[1] + b[1]]).unwrap_or_default()
}
