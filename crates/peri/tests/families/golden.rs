//! LAMMPS' numbers (22Jul2025) for four decks, with its artefacts switched on.

use super::scene::Scene;
use perigrain_peri::families::Layout;

/// A golden table: column names and rows.
struct Table {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

fn table(name: &str) -> Table {
    let text =
        std::fs::read_to_string(format!("{}/../../tests/lammps/golden/{name}", env!("CARGO_MANIFEST_DIR")))
            .unwrap();
    let mut lines = text.lines();
    let names = lines.next().unwrap().split(',').map(str::to_owned).collect();
    let rows = lines.map(|l| l.split(',').map(|w| w.parse().unwrap()).collect()).collect();
    Table { names, rows }
}

impl Table {
    /// Largest deviation relative to the column's largest magnitude, over the columns given in `ours`.
    fn deviation(&self, columns: &[&str], ours: &[Vec<f64>]) -> f64 {
        assert_eq!(self.rows.len(), ours.len());
        let mut worst: f64 = 0.0;
        for (k, name) in columns.iter().enumerate() {
            let at = self.names.iter().position(|n| n == name).unwrap();
            let scale = self.rows.iter().map(|r| r[at].abs()).fold(1e-300, f64::max);
            for (row, our) in self.rows.iter().zip(ours) {
                let off = (row[at] - our[k]).abs() / scale;
                assert!(off.is_finite());
                if off > worst {
                    worst = off;
                }
            }
        }
        worst
    }
}

/// Runs a deck's scene under compat and compares thermo rows and final state with the oracle's.
fn check(
    deck: &str,
    scene: Scene,
    length: (usize, usize),
    columns: &[&str],
    rtol: f64,
    row: impl Fn(&Scene) -> Vec<f64>,
) {
    for (layout, portable) in
        [(Layout::Auto, false), (Layout::List, false), (Layout::Auto, true), (Layout::List, true)]
    {
        let mut s = scene.clone();
        (s.options.layout, s.options.portable) = (layout, portable);
        s.options.compat_lammps = true;
        check_one(&format!("{layout:?} portable {portable}"), deck, s, length, columns, rtol, &row);
    }
}

fn check_one(
    how: &str,
    deck: &str,
    mut s: Scene,
    (steps, every): (usize, usize),
    columns: &[&str],
    rtol: f64,
    row: impl Fn(&Scene) -> Vec<f64>,
) {
    s.setup();
    let mut rows = vec![row(&s)];
    for step in 1..=steps {
        s.step();
        if step % every == 0 {
            rows.push(row(&s));
        }
    }
    let thermo = table(&format!("pd_pmb_{deck}.csv")).deviation(columns, &rows);
    let damage = s.damage();
    let state: Vec<Vec<f64>> =
        (0..s.x.len()).map(|i| [&s.x[i][..], &s.v[i][..], &[damage[i]]].concat()).collect();
    let names = ["x", "y", "z", "vx", "vy", "vz", "c_dmg"];
    let last = table(&format!("pd_pmb_{deck}.final.csv")).deviation(&names, &state);
    println!("{deck} {how}: thermo {thermo:e}, final {last:e}");
    // Tolerances of reference/tolerances.json: 30 times what LAMMPS differs from itself under reordering.
    assert!(thermo < rtol && last < 1e-8);
}

#[test]
fn wave() {
    let dx = 4.0e-4;
    // Shrink-wrapped faces lie 1e-4 of the first box beyond the outermost particles.
    let volume = [39.0, 4.0, 4.0].iter().map(|l| l * dx * (1.0 + 2e-4)).product::<f64>();
    let columns = ["PotEng", "KinEng", "TotEng", "c_dsum", "c_vmax", "c_xmom[1]", "Press"];
    check("wave", super::scene::wave(), (200, 5), &columns, 2e-10, |s| {
        let (pe, ke) = (s.energy, s.kinetic());
        let vmax = s.v.iter().map(|v| v[0]).fold(f64::MIN, f64::max);
        let momentum = (0..s.x.len()).map(|i| s.density[i] * s.v[i][0]).sum();
        let press = (2.0 * ke + s.virial[0] + s.virial[1] + s.virial[2]) / (3.0 * volume);
        vec![pe, ke, pe + ke, s.damage().iter().sum(), vmax, momentum, press]
    });
}

#[test]
fn collide() {
    let columns = ["PotEng", "KinEng", "TotEng", "c_dsum", "v_va", "v_vb", "v_vby"];
    check("collide", super::scene::collide(), (700, 10), &columns, 1e-10, |s| {
        let (pe, ke) = (s.energy, s.kinetic());
        let drift = |b: bool, k| s.drift(|i| (i >= 343) == b, k);
        vec![pe, ke, pe + ke, s.damage().iter().sum(), drift(false, 0), drift(true, 0), drift(true, 1)]
    });
}

#[test]
fn alpha() {
    let columns = ["PotEng", "KinEng", "c_dsum", "c_dave", "c_rmax"];
    check("alpha", super::scene::alpha(), (200, 5), &columns, 1e-10, |s| {
        let sum: f64 = s.damage().iter().sum();
        let far = s.x.iter().map(|x| x.iter().map(|x| x * x).sum::<f64>().sqrt()).fold(0.0, f64::max);
        vec![s.energy, s.kinetic(), sum, sum / s.x.len() as f64, far]
    });
}

#[test]
fn laminate() {
    let columns = ["PotEng", "KinEng", "c_d1", "c_d2", "v_z1", "v_z2"];
    check("laminate", super::scene::laminate(), (300, 10), &columns, 1e-10, |s| {
        let damage = s.damage();
        let sum = |t| (0..s.x.len()).filter(|&i| s.kind[i] == t).map(|i| damage[i]).sum();
        let drift = |t| s.drift(|i| s.kind[i] == t, 2);
        vec![s.energy, s.kinetic(), sum(1), sum(2), drift(1), drift(2)]
    });
}
