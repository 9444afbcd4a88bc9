//! Scenes of the reference decks set up by hand, and a velocity-Verlet loop to move them.

use perigrain_peri::families::*;
use perigrain_peri::law::{LAWS, Style};

/// The law of bonds with this name.
pub fn named(name: &str) -> &'static Style {
    LAWS.iter().map(|law| law.style()).find(|law| law.name == name).unwrap()
}

/// Particles, families and a step size.
#[derive(Clone)]
pub struct Scene {
    pub x: Vec<[f64; 3]>,
    pub x0: Vec<[f64; 3]>,
    pub v: Vec<[f64; 3]>,
    pub f: Vec<[f64; 3]>,
    pub kind: Vec<u16>,
    pub volume: Vec<f64>,
    pub density: Vec<f64>,
    pub dt: f64,
    pub bounds: Bounds,
    pub table: PmbTable,
    pub options: FamilyOptions,
    pub law: Law,
    pub families: Option<Families>,
    pub energy: f64,
    pub virial: [f64; 6],
}

impl Scene {
    /// An empty scene of one lattice spacing in an open box.
    pub fn new(dx: f64, dt: f64, types: usize) -> Self {
        Self {
            x: vec![],
            x0: vec![],
            v: vec![],
            f: vec![],
            kind: vec![],
            volume: vec![],
            density: vec![],
            dt,
            bounds: Bounds { lo: [-1.0; 3], hi: [1.0; 3], periodic: [false; 3], tilt: [0.0; 3] },
            table: PmbTable::new(types),
            options: FamilyOptions::new(dx),
            law: Law { dt, ..Law::default() },
            families: None,
            energy: 0.0,
            virial: [0.0; 6],
        }
    }

    /// Fills the sites (i, j, k) dx within index bounds that `inside` accepts: x fastest, as LAMMPS does.
    pub fn fill(
        &mut self,
        dx: f64,
        bounds: [[i32; 2]; 3],
        kind: u16,
        density: f64,
        inside: impl Fn([f64; 3]) -> bool,
    ) {
        for k in bounds[2][0]..=bounds[2][1] {
            for j in bounds[1][0]..=bounds[1][1] {
                for i in bounds[0][0]..=bounds[0][1] {
                    let x = [i, j, k].map(|i| f64::from(i) * dx);
                    if inside(x) {
                        self.x.push(x);
                        self.x0.push(x);
                        self.v.push([0.0; 3]);
                        self.f.push([0.0; 3]);
                        self.kind.push(kind);
                        self.volume.push(dx * dx * dx);
                        self.density.push(density);
                    }
                }
            }
        }
    }

    pub fn view(&self) -> PeriView<'_> {
        PeriView {
            x: &self.x,
            x0: &self.x0,
            kind: &self.kind,
            volume: &self.volume,
            bounds: self.bounds,
            excluded: None,
        }
    }

    /// Forces of the present positions.
    pub fn forces(&mut self, advance: bool) {
        self.f.iter_mut().for_each(|f| *f = [0.0; 3]);
        let mut families = self.families.take().unwrap();
        let mut f = std::mem::take(&mut self.f);
        let mut tally = PeriTally::default();
        families.force(&self.view(), &mut f, advance, Some(&mut tally));
        (self.energy, self.virial) = (tally.energy, tally.virial);
        self.f = f;
        self.families = Some(families);
    }

    /// Setup of the first run.
    pub fn setup(&mut self) {
        let families = Families::build_of(&self.view(), &self.table, self.options, self.law.clone()).unwrap();
        self.families = Some(families);
        self.forces(false);
    }

    /// One step of velocity Verlet.
    pub fn step(&mut self) {
        self.drift_and_kick(true);
        self.forces(true);
        self.drift_and_kick(false);
    }

    /// The first half of a step (half kick and drift), or the second (half kick).
    pub fn drift_and_kick(&mut self, first: bool) {
        for i in 0..self.x.len() {
            let half = 0.5 * self.dt / self.density[i];
            for k in 0..3 {
                self.v[i][k] += half * self.f[i][k];
                if first {
                    self.x[i][k] += self.dt * self.v[i][k];
                }
            }
        }
    }

    /// Removes all other particles from the columns.
    pub fn keep(&mut self, which: impl Fn(usize) -> bool) {
        fn pick<T>(column: &mut Vec<T>, which: &impl Fn(usize) -> bool) {
            let mut i = 0;
            column.retain(|_| {
                i += 1;
                which(i - 1)
            });
        }
        pick(&mut self.x, &which);
        pick(&mut self.x0, &which);
        pick(&mut self.v, &which);
        pick(&mut self.f, &which);
        pick(&mut self.kind, &which);
        pick(&mut self.volume, &which);
        pick(&mut self.density, &which);
    }

    /// Sum of 1/2 density v^2, LAMMPS' kinetic energy of peridynamic particles.
    pub fn kinetic(&self) -> f64 {
        (0..self.x.len()).map(|i| 0.5 * self.density[i] * self.v[i].iter().map(|v| v * v).sum::<f64>()).sum()
    }

    pub fn damage(&self) -> Vec<f64> {
        let mut out = vec![0.0; self.x.len()];
        self.families.as_ref().unwrap().damage_all(&self.volume, &mut out);
        out
    }

    /// Mean velocity of some particles, weighted by density (vcm of a group).
    pub fn drift(&self, which: impl Fn(usize) -> bool, k: usize) -> f64 {
        let (mut p, mut m) = (0.0, 0.0);
        for i in (0..self.x.len()).filter(|&i| which(i)) {
            p += self.density[i] * self.v[i][k];
            m += self.density[i];
        }
        p / m
    }
}

const PI: f64 = std::f64::consts::PI;

/// Micromodulus of bulk modulus `k` and horizon `delta` (LAMMPS manual).
fn micromodulus(k: f64, delta: f64) -> f64 {
    18.0 * k / (PI * delta.powi(4))
}

/// reference/decks/pd_pmb_wave.in
pub fn wave() -> Scene {
    let dx = 4.0e-4;
    let delta = 3.01 * dx;
    let mut s = Scene::new(dx, 2.0e-8, 1);
    s.fill(dx, [[0, 39], [0, 4], [0, 4]], 1, 2500.0, |_| true);
    let c = micromodulus(40.0e9, delta);
    s.table.set(1, 1, PmbCoeff { c, horizon: delta, s00: 1.0e3, alpha: 0.0 }).unwrap();
    for i in 0..s.x.len() {
        if s.x[i][0] <= 2.5 * dx {
            s.v[i] = [5.0, 0.0, 0.0];
        }
    }
    s
}

/// reference/decks/pd_pmb_collide.in
pub fn collide() -> Scene {
    let mut s = Scene::new(0.001, 5.0e-8, 1);
    s.fill(0.001, [[0, 6], [0, 6], [0, 6]], 1, 2200.0, |_| true);
    let first = s.x.len();
    s.fill(0.001, [[9, 18], [-1, 8], [-1, 8]], 1, 2200.0, |x| {
        (x[0] - 0.0135).powi(2) + (x[1] - 0.0035).powi(2) + (x[2] - 0.003).powi(2) <= 0.00305f64.powi(2)
    });
    let c = micromodulus(14.9e9, 0.0030001);
    s.table.set(1, 1, PmbCoeff { c, horizon: 0.0030001, s00: 0.010, alpha: 0.0 }).unwrap();
    for i in 0..s.x.len() {
        s.v[i][0] = if i < first { 40.0 } else { -160.0 };
    }
    s
}

/// reference/decks/pd_pmb_alpha.in
pub fn alpha() -> Scene {
    let mut s = Scene::new(0.002, 1.0e-7, 1);
    s.fill(0.002, [[-6, 6]; 3], 1, 2000.0, |x| x.iter().map(|x| x * x).sum::<f64>() <= 0.0111 * 0.0111);
    s.table.set(1, 1, PmbCoeff { c: 9.0e20, horizon: 0.0050001, s00: 0.002, alpha: 0.4 }).unwrap();
    for i in 0..s.x.len() {
        let x = s.x[i];
        s.v[i] = [4000.0 * x[0], 3500.0 * x[1], 4500.0 * x[2]];
    }
    s
}

/// reference/decks/pd_pmb_laminate.in
pub fn laminate() -> Scene {
    let mut s = Scene::new(0.001, 5.0e-8, 2);
    s.fill(0.001, [[0, 30], [0, 6], [0, 3]], 1, 2700.0, |_| true);
    s.fill(0.001, [[0, 30], [0, 6], [4, 7]], 2, 1400.0, |_| true);
    let h = 0.0030001;
    let coeff = |k: f64, s00, alpha| PmbCoeff { c: micromodulus(k, h), horizon: h, s00, alpha };
    s.table.set(1, 1, coeff(70.0e9, 0.004, 0.25)).unwrap();
    s.table.set(2, 2, coeff(10.0e9, 0.010, 0.10)).unwrap();
    s.table.set(1, 2, coeff(17.0e9, 0.0008, 0.0)).unwrap();
    for i in 0..s.x.len() {
        // The region ends at 0.018, and 18 times 0.001 lies a rounding beyond it.
        if s.kind[i] == 2 && (0.0119..0.0175).contains(&s.x[i][0]) {
            s.v[i] = [0.0, 0.0, -40.0];
        }
    }
    s
}
