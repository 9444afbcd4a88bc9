//! Uniform strain: the energy of a bond lattice against its closed sum and the table of its bulk moduli.

use perigrain_peri::families::*;

use super::scene::Scene;

const DX: f64 = 1e-3;
const K: f64 = 14.9e9;

/// Bulk modulus over K of the simple cubic bond lattice: Σ c w |xi| V/18/K with c = 18 K/(π δ⁴), by plain sum.
fn lattice_sum(m: f64, rule: VolumeRule) -> f64 {
    let delta = m * DX;
    let reach = (m + 1.0) as i32;
    let mut sum = 0.0;
    for x in -reach..=reach {
        for y in -reach..=reach {
            for z in -reach..=reach {
                let length = f64::from(x * x + y * y + z * z).sqrt() * DX;
                if length > 0.0 && length <= rule.reach(delta, DX) {
                    sum += rule.weight(length, delta, DX) * length * DX.powi(3);
                }
            }
        }
    }
    sum / (std::f64::consts::PI * delta.powi(4))
}

/// The same from the energy density of the particle in the middle of a block under uniform dilation.
fn from_energy(m: f64, rule: VolumeRule, layout: Layout, portable: bool) -> f64 {
    let delta = m * DX;
    let mut s = Scene::new(DX, 1e-8, 1);
    let n = 2 * (m + 1.0) as i32;
    s.fill(DX, [[0, n]; 3], 1, 2200.0, |_| true);
    let c = 18.0 * K / (std::f64::consts::PI * delta.powi(4));
    s.table.set(1, 1, PmbCoeff { c, horizon: delta, s00: 1.0, alpha: 0.0 }).unwrap();
    (s.options.volume, s.options.layout, s.options.portable) = (rule, layout, portable);
    let mut families = Families::build(&s.view(), &s.table, s.options).unwrap();
    let strain = 1e-3;
    s.x.iter_mut().flatten().for_each(|x| *x *= 1.0 + strain);
    let mut f = vec![[0.0; 3]; s.x.len()];
    let mut energy = vec![0.0; s.x.len()];
    let mut tally = PeriTally { per_atom_energy: Some(&mut energy), ..Default::default() };
    families.force(&s.view(), &mut f, false, Some(&mut tally));
    let middle = s.x.len() / 2;
    // Inside, all forces cancel; a single bond pulls with c V s.
    let one = c * DX.powi(3) * strain;
    assert!(f[middle].iter().all(|f| f.abs() < 1e-11 * one), "{:?} {one}", f[middle]);
    energy[middle] / (4.5 * K * strain * strain)
}

#[test]
fn uniform_dilation_returns_the_lattice_moduli() {
    // K/K0 for volume none, lammps, full: test-cases.md 3a, physics.md 4.1.
    let table = [(3.0001, [1.121, 0.900, 1.062]), (3.015, [1.0987, 0.8896, 1.0590])];
    for (m, expected) in table {
        let rules = [VolumeRule::None, VolumeRule::Lammps, VolumeRule::Full];
        for (rule, expected) in rules.into_iter().zip(expected) {
            let sum = lattice_sum(m, rule);
            // The table's digits; its first line is for 3.0 exactly.
            assert!((sum - expected).abs() < 6e-4, "{m} {rule:?} {sum}");
            for layout in [Layout::Auto, Layout::List] {
                for portable in [false, true] {
                    let ratio = from_energy(m, rule, layout, portable) / sum;
                    // Positions of 1e-2 m rounded to 1e-18 m, strains of 1e-3 over 1e-3 m.
                    assert!((ratio - 1.0).abs() < 1e-11, "{m} {rule:?} {layout:?} {ratio}");
                }
            }
        }
    }
}
