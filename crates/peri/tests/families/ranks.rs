//! Families whose work is shared out to ranks, threads here, against those of one process.

use super::scene::named;
use perigrain_base::comm::{self, Local};
use perigrain_peri::families::*;
use std::sync::Arc;

/// Two blocks on lattices that meet, and a heap of particles on none, which are shaken more and more until bonds break.
struct Shaken {
    x0: Vec<[f64; 3]>,
    v: Vec<[f64; 3]>,
    kind: Vec<u16>,
    volume: Vec<f64>,
    table: PmbTable,
}

const STEPS: usize = 30;

/// Kinds of steps: those that are tallied, those that ask for sums by particle, those in which nothing advances.
fn is_tallied(step: usize) -> bool {
    step % 3 == 2
}
fn is_by_particle(step: usize) -> bool {
    step % 9 == 8
}
fn is_trial(step: usize) -> bool {
    step % 10 == 4
}
/// Before these steps shares are taken back, and dealt anew.
fn is_undealt(step: usize) -> bool {
    step % 16 == 12
}
fn is_dealt(step: usize) -> bool {
    step % 16 == 14
}

/// What one evaluation leaves.
#[derive(PartialEq)]
struct Left {
    f: Vec<[f64; 3]>,
    sums: [f64; 7],
    by_particle: Vec<f64>,
    pairs: [Vec<NearPair>; 2],
}

impl Shaken {
    fn new() -> Self {
        let mut seed = 4711u64;
        let mut next = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let block = |far: [usize; 3], at: [f64; 3]| {
            let n = far[0] * far[1] * far[2];
            let place = |i: usize| [i % far[0], i / far[0] % far[1], i / far[0] / far[1]];
            (0..n).map(move |i| [0, 1, 2].map(|k| place(i)[k] as f64 + at[k])).collect::<Vec<_>>()
        };
        let bodies = [
            block([8, 5, 23], [0.0; 3]),
            block([8, 4, 19], [10.6, 0.3, 0.2]),
            block([3, 3, 3], [1.5, 8.4, 4.0]),
        ];
        let (mut x0, mut v) = (vec![], vec![]);
        for (k, body) in bodies.into_iter().enumerate() {
            // One to the other, and the heap onto the first block.
            let towards = [[0.05, 0.0, 0.0], [-0.1, 0.0, 0.0], [0.0, -0.12, 0.0]][k];
            for x in body {
                v.push([0, 1, 2].map(|k| towards[k] - 0.004 * (x[k] - 5.0) + 0.08 * next()));
                x0.push(if k == 2 { x.map(|x| x + 0.2 * next()) } else { x });
            }
        }
        let n = x0.len();
        let mut table = PmbTable::new(2);
        table.set(1, 1, PmbCoeff { c: 2.0, horizon: 2.01, s00: 0.15, alpha: 0.25 }).unwrap();
        table.set(1, 2, PmbCoeff { c: 3.0, horizon: 2.01, s00: 0.1, alpha: 0.0 }).unwrap();
        let kind = (0..n).map(|i| if i % 5 == 0 { 2 } else { 1 }).collect();
        table.set(2, 2, PmbCoeff { c: 1.0, horizon: 2.01, s00: 0.2, alpha: 0.0 }).unwrap();
        Self { v, kind, volume: (0..n).map(|i| 1.0 + 0.1 * (i % 7) as f64).collect(), x0, table }
    }

    /// Where particles are: back and forth, and farther each time.
    fn places(&self, step: usize) -> Vec<[f64; 3]> {
        let t = step as f64 * (1.0 + 0.3 * (step as f64).sin());
        self.x0.iter().zip(&self.v).map(|(x, v)| [0, 1, 2].map(|k| x[k] + t * v[k])).collect()
    }

    fn view<'a>(&'a self, x: &'a [[f64; 3]]) -> PeriView<'a> {
        let bounds = Bounds { lo: [-20.0; 3], hi: [40.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
        PeriView { x, x0: &self.x0, kind: &self.kind, volume: &self.volume, bounds, excluded: None }
    }

    /// One evaluation, shared out or not, of which the second half finds all places where it needs them; whether it does.
    fn step(&self, families: &mut Families, step: usize, shared: bool, seen: &[[f64; 3]]) -> (Left, bool) {
        let (x, n) = (self.places(step), self.x0.len());
        let (mut f, mut by_particle) = (vec![[0.0; 3]; n], vec![0.0; n]);
        let mut tally = PeriTally::default();
        if is_by_particle(step) {
            tally.per_atom_energy = Some(&mut by_particle);
        }
        let tallied = is_tallied(step);
        let begun = families.begin(&self.view(seen), !is_trial(step), shared);
        let searches = begun.searches;
        let seen = if searches { &x } else { seen };
        families.finish(&self.view(seen), &mut f, begun, tallied.then_some(&mut tally));
        let (energy, [a, b, c, d, e, g]) = (tally.energy, tally.virial);
        let pairs = families.near.pairs.clone();
        (Left { f, sums: [energy, a, b, c, d, e, g], by_particle, pairs }, searches)
    }

    /// Steps of one process.
    fn alone(&self, families: &Families) -> Vec<Left> {
        let mut families = families.clone();
        let bonds = families.live_bonds();
        let mut searches = 0;
        let all = (0..STEPS).map(|step| {
            // A copy builds rows of pairs anew, to which breaking bonds add otherwise.
            let (anew, _) = self.step(&mut families.clone(), step, false, &self.places(step));
            let (left, searched) = self.step(&mut families, step, false, &self.places(step));
            assert!(left == anew, "step {step} of a copy");
            searches += usize::from(searched);
            left
        });
        let all: Vec<Left> = all.collect();
        let apart = !families.lattices.is_empty();
        let touch = all.iter().any(|left| left.pairs[0].len() > 100 && (!apart || left.pairs[1].len() > 100));
        assert!(touch && searches > 3, "{searches} searches");
        assert!(families.live_bonds() < bonds - 1000, "{} of {bonds} bonds", families.live_bonds());
        all
    }

    /// The same steps on one of several ranks, which sees particles where it follows them alone.
    fn shared_out(&self, families: &Families, expected: &[Left]) {
        let (comm, n) = (comm::present(), self.x0.len());
        let (me, ranks) = (comm.rank(), comm.size());
        let mut families = families.clone();
        assert!(families.deal(me, ranks), "bodies on lattices are dealt out");
        let mut follows = followed(&families, n);
        for (step, expected) in expected.iter().enumerate() {
            let shared = families.is_shared(!is_trial(step), is_tallied(step)) && !is_by_particle(step);
            if families.shares.is_some() && (!shared || is_undealt(step)) {
                hand_to_all(&mut families);
            }
            if is_undealt(step) {
                families.undeal();
            }
            if is_dealt(step) {
                assert!(families.deal(me, ranks));
                follows = followed(&families, n);
            }
            let shared = shared && families.shares.is_some();
            let mut seen = self.places(step);
            // Squeezed bonds of all particles are added up where energies are.
            if shared && !is_tallied(step) {
                let strange = seen.iter_mut().zip(&follows).filter(|(_, follows)| !**follows);
                strange.for_each(|(x, _)| *x = [f64::NAN; 3]);
            }
            let (left, searched) = self.step(&mut families, step, shared, &seen);
            if searched && families.shares.is_some() {
                follows = followed(&families, n);
            }
            let what = format!("step {step}, rank {me} of {ranks}");
            let own = |p: usize| !shared || families.shares.as_ref().is_some_and(|shares| shares.moves(p));
            assert!((0..n).all(|p| !own(p) || left.f[p] == expected.f[p]), "{what}: forces");
            assert!(left.pairs == expected.pairs, "{what}: pairs");
            assert!(left.sums == expected.sums, "{what}: {:?} for {:?}", left.sums, expected.sums);
            assert!(left.by_particle == expected.by_particle, "{what}: energies of particles");
        }
    }
}

/// Which particles' places are up to date on this rank.
fn followed(families: &Families, n: usize) -> Vec<bool> {
    let shares = families.shares.as_ref().unwrap();
    let mut follows: Vec<bool> = (0..n).map(|p| shares.moves(p)).collect();
    for p in families.needed()[shares.me].iter().flatten() {
        follows[*p as usize] = true;
    }
    follows
}

/// Brings what each rank has of its own tiles up to date on all.
fn hand_to_all(families: &mut Families) {
    let comm = comm::present();
    let mut own = vec![];
    families.write_piece(comm.rank(), &mut own);
    let others = (0..comm.size()).filter(|rank| *rank != comm.rank());
    for (rank, piece) in comm.exchange(others.map(|rank| (rank, own.clone())).collect()) {
        families.read_piece(rank, &piece);
    }
}

#[test]
fn what_ranks_share_out_has_the_bits_of_one_process() {
    let shaken = Shaken::new();
    for (layout, kind, compat_lammps) in [
        (Layout::Auto, "pmb", false),
        (Layout::Auto, "lps", false),
        (Layout::List, "pmb", true),
        (Layout::List, "lps", false),
    ] {
        let options = FamilyOptions { layout, compat_lammps, ..FamilyOptions::new(1.0) };
        let moduli = Moduli { bulk: 2.0, shear: 1.0, ..Moduli::default() };
        let law = Law { kind: named(kind).into(), moduli: vec![moduli; 2], ..Law::default() };
        let families = Families::build_of(&shaken.view(&shaken.x0), &shaken.table, options, law).unwrap();
        assert!(families.lattices.len() == if layout == Layout::Auto { 2 } else { 0 });
        assert!(families.list.slabs() > 0);
        shaken.compare(&families);
    }
}

impl Shaken {
    fn compare(&self, families: &Families) {
        let expected = self.alone(families);
        for ranks in [2, 5] {
            let seats = Local::threads(ranks).unwrap();
            std::thread::scope(|s| {
                for seat in seats {
                    let run = || self.shared_out(families, &expected);
                    s.spawn(move || comm::run_as(Arc::new(seat), run));
                }
            });
        }
    }
}
