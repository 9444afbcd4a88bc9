//! Energy and virial of the present step, as force ops add them up.

use perigrain_base::math::vec3::{SIX, Vec3};

use super::named::{Key, Named};

/// What the force ops of a step have tallied.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Tally {
    /// The step the sums belong to; `None` when they were not requested.
    pub step: Option<i64>,
    /// Whether the virial was requested at that step.
    pub with_virial: bool,
    /// Whether per-particle energies were requested.
    pub with_atoms: bool,
    /// Energy of all pairs (LAMMPS' evdwl).
    pub pair: f64,
    /// Virial of all pairs: xx yy zz xy xz yz.
    pub virial: [f64; 6],
    /// Virial of fixes that add theirs (`fix_modify ID virial yes`).
    #[serde(default)]
    pub fixes: [f64; 6],
    /// Energy per particle of all pairs; empty when not requested.
    pub atom: Vec<f64>,
    /// Energy of all bonds (LAMMPS' ebond).
    pub bond: f64,
    /// Virial of all bonds: xx yy zz xy xz yz.
    pub bond_virial: [f64; 6],
    /// Energy per particle of its bonds; empty when not requested or where there are none.
    pub bond_atom: Vec<f64>,
    /// Energy of each pair style that has one, by its name.
    #[serde(default)]
    pub styles: Named<f64>,
    /// Whether per-particle virials were requested.
    #[serde(default)]
    pub with_atom_virial: bool,
    /// Virial of all pairs per particle, half of a pair's for each end; empty when not requested.
    #[serde(default)]
    pub atom_virial: Vec<[f64; 6]>,
    /// The same of all bonds.
    #[serde(default)]
    pub atom_bonds: Vec<[f64; 6]>,
    /// Of fixes that add theirs.
    #[serde(default)]
    pub atom_fixes: Vec<[f64; 6]>,
    /// Energy per particle of fixes that have one; empty when not requested.
    #[serde(default)]
    pub fix_atom: Vec<f64>,
}

/// Adds the virial of two `ends`, `d` apart, with the force `f` on the first of them: d ⊗ f, and half of it to each of both where
/// virials of particles are requested.
pub fn add_share(total: &mut [f64; 6], atoms: Option<&mut [[f64; 6]]>, ends: [usize; 2], d: Vec3, f: Vec3) {
    let product = SIX.map(|(a, b)| d[a] * f[b]);
    (0..6).for_each(|k| total[k] += product[k]);
    if let Some(atoms) = atoms {
        for i in ends {
            (0..6).for_each(|k| atoms[i][k] += 0.5 * product[k]);
        }
    }
}

impl Tally {
    /// Starts a step's sums at zero.
    pub fn clear(&mut self, step: i64, virial: bool, atoms: bool, n: usize) {
        self.step = Some(step);
        self.with_virial = virial;
        self.with_atoms = atoms;
        self.pair = 0.0;
        self.virial = [0.0; 6];
        self.fixes = [0.0; 6];
        (self.bond, self.bond_virial) = (0.0, [0.0; 6]);
        self.bond_atom.clear();
        self.styles.clear();
        self.atom.clear();
        self.fix_atom.clear();
        if atoms {
            self.atom.resize(n, 0.0);
            self.fix_atom.resize(n, 0.0);
        }
        self.clear_atom_virial(false, n);
    }

    /// Starts a step's per-particle virials at zero, where they are requested.
    pub fn clear_atom_virial(&mut self, asked: bool, n: usize) {
        self.with_atom_virial = asked;
        for list in [&mut self.atom_virial, &mut self.atom_bonds, &mut self.atom_fixes] {
            list.clear();
            if asked {
                list.resize(n, [0.0; 6]);
            }
        }
    }

    /// Keeps what belongs to particle `old[k]` at each new index `k`.
    pub fn gather(&mut self, old: &[usize]) {
        for list in [&mut self.atom, &mut self.bond_atom, &mut self.fix_atom] {
            pick(list, old);
        }
        for list in [&mut self.atom_virial, &mut self.atom_bonds, &mut self.atom_fixes] {
            pick(list, old);
        }
    }

    /// Adds the energy of a pair style.
    pub fn add_pair(&mut self, style: Key<f64>, energy: f64) {
        self.pair += energy;
        *self.styles.get_or(style, || 0.0) += energy;
    }
}

fn pick<T: Copy>(list: &mut Vec<T>, old: &[usize]) {
    if list.len() == old.len() {
        *list = old.iter().map(|&k| list[k]).collect();
    }
}
