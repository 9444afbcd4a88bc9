//! Energy and virial of all bonds: asked for at some steps only, so a pass of its own.

use crate::cauchy;
use crate::families::lattice::{LANES, LatticeBody, PAD};
use crate::families::shares::Shares;
use crate::families::view::Sums;
use crate::families::{Cell, Families, ForceUnit, PeriTally, PeriView};
use crate::lattice::chunk::{CELLS, Chunk, SUMS};
use crate::lattice::states::States;
use crate::law::kernels::Alone;
use crate::law::moment::COLUMNS;
use crate::law::moment::Moment;
use crate::law::state::SiteState;
use crate::law::stretch::Stretch;
use crate::law::weighing::{Weighing, banded};
use crate::list;
use crate::shares::rows_everywhere;
use perigrain_base::par::{self, Shared};

/// Rows per part when rows are summed.
const ROWS: usize = 16;

/// Adds energy and virial of all bonds as they were during the force evaluation, which has `advanced` bonds or not. Under
/// bond-based laws LAMMPS gives each end half of ½ c w V s² |xi|, and the virial one factor V. Under state-based ones the energy
/// density of a particle is ½Kθ² + ½ 15G/m Σ ω w |xi|² ε² V; LAMMPS counts half of the second term.
pub fn tally(
    families: &mut Families,
    view: &PeriView,
    t: &mut PeriTally,
    (advanced, cell, shares): (bool, &Cell, Option<&Shares>),
) {
    if families.law.kind.correspondence {
        return cauchy::energy::tally(families, view, cell, t);
    }
    let newton = families.options.unit == ForceUnit::Newton;
    let scale = |p: usize| if newton { view.volume[p] } else { 1.0 };
    let dilated = !families.law.kind.bond_based;
    let mut rows = std::mem::take(&mut families.scratch.rows);
    for k in 0..families.lattices.len() {
        let body = &families.lattices[k];
        for (cell, &p) in body.particle.iter().enumerate().filter(|(_, p)| dilated && **p != u32::MAX) {
            let p = p as usize;
            own(families, view, p, (&body.state, PAD + cell, body.scatter.strain(cell)), scale(p), t);
        }
        let one = |slot: usize, t: &mut PeriTally| one_by_one(families, view, (body, slot), (advanced, t));
        let share = shares.map(|shares| &shares.bodies[k]);
        let own = share.map(|share| &share.own[..]);
        if t.per_atom() {
            (0..body.rows.len()).for_each(|slot| one(slot, t));
            continue;
        }
        match body.cell_kind.is_empty() {
            false => apart(body.rows.len(), &mut rows, |slot, t| {
                if own.is_none_or(|own| own[slot]) {
                    one(slot, t);
                }
            }),
            true => in_lanes(families, k, view, (advanced, own), &mut rows),
        }
        if let Some((share, shares)) = share.zip(shares).filter(|_| !rows.is_empty()) {
            rows_everywhere(&families.lattices[k], (share, shares.me), &mut rows);
        }
        t.collect(&rows);
    }
    families.scratch.rows = rows;
    let list = &families.list;
    for (record, &p) in list.particle.iter().enumerate().filter(|(_, p)| dilated && **p != u32::MAX) {
        let at = (&list.state, record, list.scatter.strain(record));
        own(families, view, p as usize, at, scale(p as usize), t);
    }
    list::energy::tally(families, t, (advanced, cell, shares));
}

/// Sums of `row(k, sum)` for `k` below `n`, each row by itself.
fn apart(n: usize, rows: &mut Vec<Sums>, row: impl Fn(usize, &mut PeriTally) + Sync) {
    rows.clear();
    rows.resize(n, [0.0; 7]);
    let shared = Shared::new(rows);
    par::for_rows(n.div_ceil(ROWS), |part| {
        for k in part * ROWS..n.min((part + 1) * ROWS) {
            let mut own = PeriTally::default();
            row(k, &mut own);
            let v = own.virial;
            // SAFETY: each row belongs to one part.
            unsafe { shared.get(k..k + 1)[0] = [own.energy, v[0], v[1], v[2], v[3], v[4], v[5]] };
        }
    });
}

/// Energy and virial of each row (of the `own` ones, where others have the rest) of a body whose constants are per row, several cells at a time. Constants hold the volumes of
/// forces, and one of those of energies; `newton` says that forces are true.
fn whole_rows(
    body: &LatticeBody,
    view: &PeriView,
    rows: &mut Vec<Sums>,
    (newton, own): (bool, Option<&[bool]>),
    of_chunk: impl Fn(usize, &Chunk) -> [[f64; CELLS]; SUMS] + Sync,
) {
    rows.clear();
    let Some(&first) = body.particle.iter().find(|&&p| p != u32::MAX) else { return };
    let volume = view.volume[first as usize];
    let scale = if newton { [volume, 1.0] } else { [1.0, volume] };
    let n = body.rows.len();
    rows.resize(n, [0.0; 7]);
    let shared = Shared::new(rows);
    par::for_rows(n.div_ceil(ROWS), |part| {
        for slot in part * ROWS..n.min((part + 1) * ROWS) {
            if body.rows[slot].len == 0 || own.is_some_and(|own| !own[slot]) {
                continue;
            }
            let mut row = whole_row(body, slot, &of_chunk);
            row[0] *= scale[0];
            row[1..].iter_mut().for_each(|v| *v *= scale[1]);
            // SAFETY: each row belongs to one part.
            unsafe { shared.get(slot..slot + 1)[0] = row };
        }
    });
}

fn whole_row(
    body: &LatticeBody,
    slot: usize,
    of_chunk: impl Fn(usize, &Chunk) -> [[f64; CELLS]; SUMS],
) -> Sums {
    let (row, entries) = (&body.rows[slot], body.stencil.len());
    let u = body.u[1].as_ptr();
    let mut lanes = [[0.0; CELLS]; SUMS];
    for chunk in row.start as usize / LANES..(row.start + row.len) as usize / LANES {
        let u = [0, 1, 2].map(|k| u.wrapping_add(k * body.stride + PAD + chunk * LANES));
        let alive = &body.alive[chunk * entries..][..entries];
        // SAFETY: `u` has a place for each cell and PAD more around, and live bonds lead to cells of the body; energies touch no forces.
        let data = unsafe {
            Chunk::new((u, [std::ptr::null_mut(); 3]), (alive, body.leads_of(slot), &body.tables), None)
        };
        let part = of_chunk(chunk, &data);
        for (sum, part) in lanes.iter_mut().flatten().zip(part.iter().flatten()) {
            *sum += part;
        }
    }
    lanes.map(|l| l.iter().sum())
}

/// Energy and virial of each row of a body of one volume, several cells at a time.
fn in_lanes(
    families: &mut Families,
    body: usize,
    view: &PeriView,
    (advanced, own): (bool, Option<&[bool]>),
    rows: &mut Vec<Sums>,
) {
    let form = families.form();
    let state = &mut families.lattices[body].state;
    let mut memory = if state.earlier.is_empty() { std::mem::take(&mut state.memory) } else { vec![] };
    let mut earlier = std::mem::take(&mut state.earlier);
    let mut touched = std::mem::take(&mut state.touched);
    {
        let kept = if earlier.is_empty() { &mut memory } else { &mut earlier };
        let (memory, touched) = (Shared::new(kept), Shared::new(&mut touched));
        let states = States {
            form,
            law: families.law.kind.style(),
            compat: families.options.compat_lammps,
            moment: Moment { held: state.held, ..families.law.moment(false) },
            keep: false,
            memory: &memory,
            touched: &touched,
            spread: false,
        };
        let body: &LatticeBody = &families.lattices[body];
        let of_chunk = |chunk: usize, data: &Chunk| states.sums(body, chunk, data, advanced);
        let newton = families.options.unit == ForceUnit::Newton;
        whole_rows(body, view, rows, (newton, own), of_chunk);
    }
    let state = &mut families.lattices[body].state;
    if earlier.is_empty() {
        state.memory = memory;
    }
    (state.earlier, state.touched) = (earlier, touched);
}

/// The energy of a particle's dilatation, and what its broken bonds have of the rest.
fn own(
    families: &Families,
    view: &PeriView,
    p: usize,
    (state, at, strain): (&SiteState, usize, f64),
    scale: f64,
    t: &mut PeriTally,
) {
    // The dilatation kept has thermal strain in it.
    let (moduli, theta) = (families.law.of(view.kind[p]), state.theta[at] - 3.0 * strain);
    let free = state.freed.of(at, state.weighted[at], (3.0 * moduli.bulk, 15.0 * moduli.shear));
    let density = 0.5 * moduli.bulk * theta * theta + free.map_or(0.0, |free| free.energy(theta));
    let energy = density * scale;
    t.energy += energy;
    if let Some(atoms) = t.per_atom_energy.as_deref_mut() {
        atoms[p] += energy;
    }
}

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
    stretch: Stretch<f64>,
    memory: [f64; 2],
    state: &'a SiteState,
    stride: usize,
}

/// Energies and virials of the bonds of a row's cells, one by one.
fn one_by_one(
    families: &Families,
    view: &PeriView,
    (body, slot): (&LatticeBody, usize),
    (advanced, t): (bool, &mut PeriTally),
) {
    let (entries, options, law) = (body.stencil.len(), &families.options, &families.law);
    let numbers = law.kind.memory();
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
            let mut stretch = banded(body.z(1, cell, to, e), length, options);
            if !advanced {
                stretch.before = banded(body.z(0, cell, to, e), length, options).s;
            }
            let first = (cell / LANES * entries + e) * numbers * LANES + cell % LANES;
            let ends = [body.particle[cell] as usize, body.particle[to] as usize];
            let (a, b) = (view.kind[ends[0]], view.kind[ends[1]]);
            let (c, limit) = families.table.get(a, b).map_or((0.0, 0.0), |k| (k.c, k.s00));
            stretch.limit = limit;
            let (omega, share) = Weighing::of(law).weigh(length, weight, (c, body.horizon, law.yields(a, b)));
            add(
                families,
                &Bond {
                    ends,
                    at: [PAD + cell, PAD + to],
                    volume: ends.map(|p| view.volume[p]),
                    y: [0, 1, 2].map(|k| xi[k] + u(k, to) - u(k, cell)),
                    length,
                    omega,
                    share,
                    stretch,
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

/// Adds an energy density of a particle, or with its volume an energy.
fn share_out(t: &mut PeriTally, p: usize, density: f64, volume: Option<f64>) {
    let energy = density * volume.unwrap_or(1.0);
    t.energy += energy;
    if let Some(atoms) = t.per_atom_energy.as_deref_mut() {
        atoms[p] += energy;
    }
}

/// Adds one bond's energies and virial.
fn add(families: &Families, b: &Bond, t: &mut PeriTally) {
    let (law, options) = (&families.law, &families.options);
    let (compat, newton) = (options.compat_lammps, options.unit == ForceUnit::Newton);
    let loops = law.kind.loops(compat);
    let now = Moment { held: b.state.held, ..law.moment(false) };
    let (own, half) = law.kind.shares(compat);
    let columns = |at: usize| -> [f64; COLUMNS] {
        let count = loops.about().columns;
        std::array::from_fn(|k| if k < count { b.state.columns[k * b.stride + at] } else { 0.0 })
    };
    let angles = |at: usize| {
        let theta = b.state.theta[at];
        [theta, b.state.unrelaxed[at] + (theta - b.state.before[at])]
    };
    let alone = Alone {
        stretch: b.stretch,
        omega: b.omega,
        ends: b.at.map(columns),
        memory: b.memory,
        angles: (!b.state.is_empty()).then(|| b.at.map(angles)),
    };
    let [squares, pulls] = loops.alone(&alone, &now);
    for (end, square) in squares.into_iter().enumerate() {
        let p = b.ends[end];
        let shear = if own { alone.ends[end][1] } else { 1.0 };
        let energy = half * shear * b.share * b.length * b.length * square * b.volume[1 - end];
        share_out(t, p, energy, newton.then_some(b.volume[end]));
    }
    // Force density times the one volume of the virial, or the force itself: V_i V_j either way.
    let pulls = pulls.map(|pull| -pull * b.share * b.volume[0] * b.volume[1]);
    t.add_virials(b.ends, pulls, b.y);
}
