//! Dust in short-range contact, against a plain loop over all pairs.

use perigrain_base::par;
use perigrain_peri::families::*;

const SIDE: usize = 11;

/// What is compared: forces, energy, virial, energies and virials of particles.
type Found = (Vec<[f64; 3]>, f64, [f64; 6], Vec<f64>, Vec<[f64; 6]>);

/// Particles of two types that were a block on a lattice of spacing 1, of which no bond lives, stirred and pressed into a box of this side.
struct Dust {
    x: Vec<[f64; 3]>,
    x0: Vec<[f64; 3]>,
    kind: Vec<u16>,
    volume: Vec<f64>,
    bounds: Bounds,
    table: PmbTable,
    options: FamilyOptions,
}

impl Dust {
    fn new(side: f64, periodic: [bool; 3], tilt: [f64; 3], unit: ForceUnit) -> Self {
        let mut seed = 4711u64;
        let mut next = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        let n = SIDE * SIDE * SIDE;
        let x0: Vec<[f64; 3]> =
            (0..n).map(|i| [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE].map(|k| k as f64 + 0.5)).collect();
        // Neighbours stay so, roughly: some are in contact by what they were apart at the start, others by the largest distance of contact.
        let place = |x: &[f64; 3]| x.map(|x| side / SIDE as f64 * (x + 0.9 * (next() - 0.5)));
        let x = x0.iter().map(place).collect();
        let mut table = PmbTable::new(2);
        table.set(1, 1, PmbCoeff { c: 2.0, horizon: 3.01, s00: 0.1, alpha: 0.0 }).unwrap();
        table.set(1, 2, PmbCoeff { c: 3.0, horizon: 2.01, s00: 0.1, alpha: 0.0 }).unwrap();
        let options = FamilyOptions { unit, ..FamilyOptions::new(1.0) };
        Self {
            x,
            x0,
            kind: (0..n).map(|i| if i % 3 == 0 { 2 } else { 1 }).collect(),
            volume: (0..n).map(|i| 1.0 + 0.1 * (i % 7) as f64).collect(),
            bounds: Bounds { lo: [0.0; 3], hi: [side.max(SIDE as f64); 3], periodic, tilt },
            table,
            options,
        }
    }

    fn view<'a>(&'a self, x: &'a [[f64; 3]]) -> PeriView<'a> {
        let Self { x0, kind, volume, bounds, .. } = self;
        PeriView { x, x0, kind, volume, bounds: *bounds, excluded: None }
    }

    /// By the program.
    fn found(&self, layout: Layout, change: impl Fn(&mut Families)) -> Found {
        let options = FamilyOptions { layout, ..self.options };
        let mut families = Families::build(&self.view(&self.x0), &self.table, options).unwrap();
        families.cut(&self.view(&self.x0), |_, _| true);
        assert_eq!(families.live_bonds(), 0);
        change(&mut families);
        self.forces(&mut families)
    }

    fn forces(&self, families: &mut Families) -> Found {
        let n = self.x.len();
        let (mut f, mut energies, mut virials) = (vec![[0.0; 3]; n], vec![0.0; n], vec![[0.0; 6]; n]);
        let mut tally = PeriTally {
            per_atom_energy: Some(&mut energies),
            per_atom_virial: Some(&mut virials),
            ..PeriTally::default()
        };
        families.force(&self.view(&self.x), &mut f, false, Some(&mut tally));
        let (energy, virial) = (tally.energy, tally.virial);
        (f, energy, virial, energies, virials)
    }

    /// By a loop over all pairs.
    fn expected(&self) -> Found {
        let n = self.x.len();
        let (mut f, mut energies, mut virials) = (vec![[0.0; 3]; n], vec![0.0; n], vec![[0.0; 6]; n]);
        let difference =
            |x: &[[f64; 3]], i: usize, j: usize| self.bounds.nearest([0, 1, 2].map(|k| x[i][k] - x[j][k]));
        let length = |d: [f64; 3]| (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let mut pairs = 0;
        for i in 0..n {
            for j in i + 1..n {
                let Some(coeff) = self.table.get(self.kind[i], self.kind[j]) else { continue };
                let d = difference(&self.x, i, j);
                let (r, contact) = (length(d), (0.9 * length(difference(&self.x0, i, j))).min(1.35));
                if r >= contact {
                    continue;
                }
                pairs += 1;
                let (vi, vj) = (self.volume[i], self.volume[j]);
                // What each end's force takes of the volumes: its partner's, both, or under LAMMPS the second particle's.
                let (of_i, of_j) = match self.options.unit {
                    ForceUnit::Newton => (vi * vj, vi * vj),
                    ForceUnit::Density if self.options.compat_lammps => (vj, vj),
                    ForceUnit::Density => (vj, vi),
                };
                let push = 15.0 * coeff.c / coeff.horizon * (contact - r);
                for k in 0..3 {
                    f[i][k] += push * of_i * d[k] / r;
                    f[j][k] -= push * of_j * d[k] / r;
                }
                energies[i] += 0.25 * push * (contact - r) * of_i;
                energies[j] += 0.25 * push * (contact - r) * of_j;
                for (m, (a, b)) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
                    let both = push * vi * vj * d[a] * d[b] / r;
                    virials[i][m] += 0.5 * both;
                    virials[j][m] += 0.5 * both;
                }
            }
        }
        assert!(pairs > 3 * n / 2, "{pairs} pairs touch");
        let virial = [0, 1, 2, 3, 4, 5].map(|m| virials.iter().map(|v| v[m]).sum());
        (f, energies.iter().sum(), virial, energies, virials)
    }
}

/// Whether both are the same but for rounding: sums of a few dozen numbers of this size at most, each to a few roundings of 1e-16.
fn agree(a: &Found, b: &Found) -> bool {
    let close = |a: &[f64], b: &[f64]| {
        let most = b.iter().fold(0.0f64, |most, b| most.max(b.abs()));
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-13 * most)
    };
    let totals = |a: &Found| [a.1, a.2[0], a.2[1], a.2[2], a.2[3], a.2[4], a.2[5]];
    close(a.0.as_flattened(), b.0.as_flattened())
        && close(&totals(a), &totals(b))
        && close(&a.3, &b.3)
        && close(a.4.as_flattened(), b.4.as_flattened())
}

#[test]
fn dust_is_pushed_as_by_a_plain_loop() {
    for (unit, compat) in
        [(ForceUnit::Density, false), (ForceUnit::Density, true), (ForceUnit::Newton, false)]
    {
        for (side, periodic, tilt) in [
            (8.5, [false; 3], [0.0; 3]),
            (SIDE as f64, [true, false, true], [0.0; 3]),
            (SIDE as f64, [true; 3], [2.0, -1.0, 1.5]),
        ] {
            let mut dust = Dust::new(side, periodic, tilt, unit);
            dust.options.compat_lammps = compat;
            let expected = dust.expected();
            for layout in [Layout::Auto, Layout::List] {
                let found = dust.found(layout, |_| ());
                assert!(agree(&found, &expected), "{unit:?} {compat} {periodic:?} {tilt:?} {layout:?}");
                let four = dust.found(layout, |families| families.four_lanes = true);
                assert!(found == four, "four lanes give the bits of eight");
                assert!(agree(&dust.found(layout, |families| families.options.portable = true), &expected));
            }
        }
    }
}

#[test]
fn dust_has_the_same_bits_on_any_number_of_threads() {
    let _alone = super::threads::alone();
    let dust = Dust::new(8.5, [false; 3], [0.0; 3], ForceUnit::Density);
    let one = dust.found(Layout::Auto, |_| ());
    for threads in [2, 3] {
        par::set_threads(threads);
        assert!(dust.found(Layout::Auto, |_| ()) == one, "{threads} threads");
    }
    par::set_threads(1);
}

/// A scene that was put aside and taken up again has the same bits: what is kept of pairs is made anew.
#[test]
fn a_copy_pushes_with_the_same_bits() {
    let dust = Dust::new(8.5, [false; 3], [0.0; 3], ForceUnit::Density);
    let mut families = Families::build(&dust.view(&dust.x0), &dust.table, dust.options).unwrap();
    families.cut(&dust.view(&dust.x0), |_, _| true);
    let found = dust.forces(&mut families);
    assert!(dust.forces(&mut families.clone()) == found && dust.forces(&mut families) == found);
}
