//! Energy and virial under state-based laws.

use super::super::single::Single;
use super::law::{
    BondLaw, Elastic, Ends, Flattened, Plastic, PlasticLammps, Stretch, Viscous, ViscousLammps, Yielding,
    closed,
};
use super::list::{Weighing, bond};
use super::settle::{columns_of, moment};
use crate::world::families::lattice::{LANES, LatticeBody, PAD};
use crate::world::families::law::{COLUMNS, SiteState};
use crate::world::families::list::ListBody;
use crate::world::families::{Families, ForceUnit, LawKind, PeriTally, PeriView};

/// One bond with all that its energy depends on.
struct Bond<'a> {
    /// Particles.
    ends: [usize; 2],
    /// Places in columns.
    at: [usize; 2],
    volume: [f64; 2],
    y: [f64; 3],
    length: f64,
    omega: f64,
    /// ω w.
    share: f64,
    stretch: Stretch<Single>,
    memory: [f64; 2],
    state: &'a SiteState,
    stride: usize,
}

/// Adds energy and virial of all bonds as they were during the force evaluation. The energy density of a particle is
/// ½Kθ² + ½ 15G/m Σ ω w |xi|² ε² V; LAMMPS counts half of the second term.
pub fn tally(families: &Families, view: &PeriView, t: &mut PeriTally, period: [f64; 3]) {
    let newton = families.options.unit == ForceUnit::Newton;
    let scale = |p: usize| if newton { view.volume[p] } else { 1.0 };
    for body in &families.lattices {
        for (cell, &p) in body.particle.iter().enumerate().filter(|(_, p)| **p != u32::MAX) {
            let p = p as usize;
            own(families, view, p, body.state.theta[PAD + cell], scale(p), t);
        }
        lattice(families, view, body, t);
    }
    let list = &families.list;
    for (record, &p) in list.particle.iter().enumerate().filter(|(_, p)| **p != u32::MAX) {
        own(families, view, p as usize, list.state.theta[record], scale(p as usize), t);
    }
    listed(families, view, list, period, t);
}

/// The energy of a particle's dilatation.
fn own(families: &Families, view: &PeriView, p: usize, theta: f64, scale: f64, t: &mut PeriTally) {
    let energy = 0.5 * families.law.of(view.kind[p]).bulk * theta * theta * scale;
    t.energy += energy;
    if let Some(atoms) = t.per_atom_energy.as_deref_mut() {
        atoms[p] += energy;
    }
}

fn lattice(families: &Families, view: &PeriView, body: &LatticeBody, t: &mut PeriTally) {
    let (entries, options, law) = (body.stencil.len(), &families.options, &families.law);
    let numbers = law.kind.memory();
    for slot in (0..body.rows.len()).filter(|&slot| body.rows[slot].len > 0) {
        let row = body.rows[slot];
        for e in 0..entries {
            let xi = body.xi(e);
            let length = xi.iter().map(|x| x * x).sum::<f64>().sqrt();
            let weight = options.volume.weight(length, body.horizon, options.lattice_spacing);
            for cell in row.start as usize..(row.start + row.len) as usize {
                if !body.lives(cell, e) {
                    continue;
                }
                let Some(to) = body.ahead(slot, cell, e) else { continue };
                let u = |k: usize, c: usize| body.u[1][k * body.stride + PAD + c];
                let z = body.z(1, cell, to, e);
                let first = (cell / LANES * entries + e) * numbers * LANES + cell % LANES;
                let ends = [body.particle[cell] as usize, body.particle[to] as usize];
                let (a, b) = (view.kind[ends[0]], view.kind[ends[1]]);
                let c = families.table.get(a, b).map_or(0.0, |k| k.c);
                let (omega, share) =
                    Weighing::of(law).weigh(length, weight, (c, body.horizon, law.yields(a, b)));
                add(
                    families,
                    view,
                    &Bond {
                        ends,
                        at: [PAD + cell, PAD + to],
                        volume: ends.map(|p| view.volume[p]),
                        y: [0, 1, 2].map(|k| xi[k] + u(k, to) - u(k, cell)),
                        length,
                        omega,
                        share,
                        stretch: if z.abs() < options.dead_band(length) {
                            unstretched()
                        } else {
                            // SAFETY: plain arithmetic.
                            unsafe { closed(Single(z)) }
                        },
                        memory: std::array::from_fn(|k| {
                            if k < numbers { body.state.remembered()[first + k * LANES] } else { 0.0 }
                        }),
                        state: &body.state,
                        stride: body.stride,
                    },
                    t,
                );
            }
        }
    }
}

fn unstretched() -> Stretch<Single> {
    Stretch { s: Single(0.0), share: Single(0.0), inverse: Single(1.0) }
}

fn listed(families: &Families, view: &PeriView, list: &ListBody, period: [f64; 3], t: &mut PeriTally) {
    let (options, law) = (&families.options, &families.law);
    let numbers = law.kind.memory();
    for i in 0..list.record.len() {
        for k in list.own(i).filter(|&k| list.lives(k)) {
            let j = list.partner[k] as usize;
            let b = bond(list, (i, j), period, Weighing::of(law), options);
            let ends = [i, j].map(|r| list.particle[r] as usize);
            add(
                families,
                view,
                &Bond {
                    ends,
                    at: [i, j],
                    volume: [i, j].map(|r| list.record[r].volume),
                    y: b.y,
                    length: b.length,
                    omega: b.omega,
                    share: b.share,
                    stretch: b.stretch,
                    memory: std::array::from_fn(|n| {
                        if n < numbers { list.state.remembered()[k * numbers + n] } else { 0.0 }
                    }),
                    state: &list.state,
                    stride: list.record.len(),
                },
                t,
            );
        }
    }
}

/// Adds an energy density of a particle, or with its volume an energy.
fn share_out(t: &mut PeriTally, p: usize, density: f64, volume: Option<f64>) {
    let energy = density * volume.unwrap_or(1.0);
    t.energy += energy;
    if let Some(atoms) = t.per_atom_energy.as_deref_mut() {
        atoms[p] += energy;
    }
}

/// Adds one bond's energies and virial.
fn add(families: &Families, view: &PeriView, b: &Bond, t: &mut PeriTally) {
    let (law, options) = (&families.law, &families.options);
    let compat = options.compat_lammps;
    let newton = options.unit == ForceUnit::Newton;
    let now = moment(law, false);
    let s = b.stretch.s.0;
    for end in 0..2 {
        let (p, at) = (b.ends[end], b.at[end]);
        let m = b.state.weighted[at];
        if law.kind.bond_based() {
            // Each end has half of the bond's energy.
            let square = match law.kind {
                LawKind::Flat if s < b.omega => b.omega * (2.0 * s - b.omega),
                _ => (s - b.memory[0]).powi(2),
            };
            share_out(
                t,
                p,
                0.25 * b.share * b.length * b.length * square * b.volume[1 - end],
                newton.then_some(b.volume[end]),
            );
            continue;
        }
        if m <= 0.0 {
            continue;
        }
        let third = b.state.theta[at] / 3.0;
        let square = match law.kind {
            LawKind::Ves => {
                let element = b.memory[1] - b.state.unrelaxed[at] / 3.0;
                (1.0 - now.lambda) * (s - third).powi(2) + now.lambda * element * element
            }
            LawKind::Eps => (s - third - b.memory[end]).powi(2),
            _ => (s - third).powi(2),
        };
        let partner = b.volume[1 - end];
        let shear = 15.0 * law.of(view.kind[p]).shear / m;
        let half = if compat { 0.25 } else { 0.5 };
        let energy = half * shear * b.share * b.length * b.length * square * partner;
        share_out(t, p, energy, newton.then_some(b.volume[end]));
    }
    let columns = |at: usize| -> [Single; COLUMNS] {
        let count = columns_of(law.kind, compat);
        std::array::from_fn(|k| Single(if k < count { b.state.columns[k * b.stride + at] } else { 0.0 }))
    };
    let ends: Ends<Single> = b.at.map(columns);
    let mut memory = b.memory.map(Single);
    let omega = Single(b.omega);
    // SAFETY: plain arithmetic.
    let (near, far) = unsafe {
        match (law.kind, compat) {
            (LawKind::Pmb | LawKind::Lps, _) => Elastic::pull(&b.stretch, omega, &ends, &mut memory, &now),
            (LawKind::Yield, _) => Yielding::pull(&b.stretch, omega, &ends, &mut memory, &now),
            (LawKind::Flat, _) => Flattened::pull(&b.stretch, omega, &ends, &mut memory, &now),
            (LawKind::Ves, false) => Viscous::pull(&b.stretch, omega, &ends, &mut memory, &now),
            (LawKind::Ves, true) => ViscousLammps::pull(&b.stretch, omega, &ends, &mut memory, &now),
            (LawKind::Eps, false) => Plastic::pull(&b.stretch, omega, &ends, &mut memory, &now),
            (LawKind::Eps, true) => PlasticLammps::pull(&b.stretch, omega, &ends, &mut memory, &now),
        }
    };
    // Force density times the one volume of the virial, or the force itself: V_i V_j either way.
    let pull = -0.5 * (near.0 + far.0) * b.share * b.volume[0] * b.volume[1];
    t.add_virial(b.ends[0], b.ends[1], pull, b.y);
}
