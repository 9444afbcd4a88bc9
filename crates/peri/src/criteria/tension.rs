//! The tension t_i + t_j of single bonds, without the weight of partial volumes, whatever their law.

use crate::families::lattice::{LANES, LatticeBody, PAD};
use crate::families::list::{GROUP, ListBody};
use crate::families::{Cell, FamilyOptions, Law, PeriView, PmbTable};
use crate::law::kernels::{Alone, Loops};
use crate::law::moment::{COLUMNS, Moment};
use crate::law::state::SiteState;
use crate::law::weighing::{Weighing, banded};

/// What the tension of bonds depends on besides bodies.
pub(super) struct Rules<'a> {
    pub(super) law: &'a Law,
    pub(super) options: &'a FamilyOptions,
    pub(super) table: &'a PmbTable,
}

/// A bond at one moment.
struct Moved {
    z: f64,
    length: f64,
    /// ω, or what stands for it.
    omega: f64,
    /// ω or c/|xi|, what turns a pull into a force density.
    scale: f64,
    /// The critical stretch of its pair.
    limit: f64,
}

impl Rules<'_> {
    fn loops(&self) -> &'static dyn Loops {
        self.law.kind.loops(self.options.compat_lammps)
    }

    /// The tension of a bond [force/volume²] and its length now, from what its ends have in columns and what it remembers once
    /// forces are known: a look lets nothing flow.
    fn tension(
        &self,
        bond: &Moved,
        state: &SiteState,
        columns: [[f64; COLUMNS]; 2],
        memory: [f64; 2],
    ) -> [f64; 2] {
        let mut stretch = banded(bond.z, bond.length, self.options);
        stretch.limit = bond.limit;
        let moment = Moment { held: state.held, ..self.law.moment(false) };
        let alone = Alone { stretch, omega: bond.omega, ends: columns, memory, angles: None };
        let [_, [near, far]] = self.loops().alone(&alone, &moment);
        let length = bond.length * (1.0 + stretch.s);
        [0.5 * (near + far) * bond.scale * length, length]
    }
}

/// The bonds of a body on a lattice.
pub(super) struct OnLattice<'a> {
    rules: &'a Rules<'a>,
    body: &'a LatticeBody,
    view: &'a PeriView<'a>,
    /// Length, ω and scale of each stencil vector, of each pair of types.
    constants: Vec<[f64; 3]>,
}

impl<'a> OnLattice<'a> {
    pub(super) fn new(rules: &'a Rules, body: &'a LatticeBody, view: &'a PeriView) -> Self {
        let (types, weighing) = (rules.table.types() as u16, Weighing::of(rules.law));
        let mut constants = vec![];
        for (a, b) in (1..=types).flat_map(|a| (1..=types).map(move |b| (a, b))) {
            let c = rules.table.get(a, b).map_or(0.0, |k| k.c);
            let yields = rules.law.yields(a, b);
            for e in 0..body.stencil.len() {
                let length = body.xi(e).iter().map(|x| x * x).sum::<f64>().sqrt();
                let (omega, scale) = weighing.weigh(length, 1.0, (c, body.horizon, yields));
                constants.push([length, omega, scale]);
            }
        }
        Self { rules, body, view, constants }
    }

    /// See [`Rules::tension`].
    pub(super) fn tension(&self, cell: usize, to: usize, e: usize) -> [f64; 2] {
        let (body, rules, entries) = (self.body, self.rules, self.body.stencil.len());
        let [a, b] = [cell, to].map(|c| self.view.kind[body.particle[c] as usize]);
        let pair = (usize::from(a) - 1) * rules.table.types() + usize::from(b) - 1;
        let [length, omega, scale] = self.constants[pair * entries + e];
        let limit = rules.table.get(a, b).map_or(0.0, |k| k.s00);
        let moved = Moved { z: body.z(1, cell, to, e), length, omega, scale, limit };
        let about = rules.loops().about();
        let first = (cell / LANES * entries + e) * about.memory * LANES + cell % LANES;
        let memory =
            std::array::from_fn(
                |k| if k < about.memory { body.state.memory[first + k * LANES] } else { 0.0 },
            );
        let columns = [cell, to].map(|c| {
            std::array::from_fn(|k| {
                if k < about.columns { body.state.columns[k * body.stride + PAD + c] } else { 0.0 }
            })
        });
        rules.tension(&moved, &body.state, columns, memory)
    }

    /// How long a bond was in the last step that advanced.
    pub(super) fn length_before(&self, cell: usize, to: usize, e: usize) -> f64 {
        let length = self.constants[e][0];
        length * (1.0 + banded(self.body.z(0, cell, to, e), length, self.rules.options).s)
    }
}

/// The bonds of the list.
pub(super) struct InList<'a> {
    pub(super) rules: &'a Rules<'a>,
    pub(super) list: &'a ListBody,
    pub(super) cell: &'a Cell,
}

impl InList<'_> {
    /// See [`Rules::tension`].
    pub(super) fn tension(&self, b: usize) -> [f64; 2] {
        let (list, rules) = (self.list, self.rules);
        let n = list.record.len();
        let [i, j] = [list.owner[b / GROUP], list.partner[b]].map(|r| r as usize);
        let (z, length) = list.z(false, i, j, self.cell);
        let own = list.constants(b);
        let (omega, scale) = Weighing::of(rules.law).weigh(length, 1.0, (own.c, own.horizon, own.yields));
        let moved = Moved { z, length, omega, scale, limit: own.s00 };
        let about = rules.loops().about();
        let first = ListBody::memory(b, about.memory);
        let memory =
            std::array::from_fn(
                |k| if k < about.memory { list.state.memory[first + k * GROUP] } else { 0.0 },
            );
        let columns = [i, j].map(|r| {
            std::array::from_fn(|k| if k < about.columns { list.state.columns[k * n + r] } else { 0.0 })
        });
        rules.tension(&moved, &list.state, columns, memory)
    }

    /// How long a bond was in the last step that advanced.
    pub(super) fn length_before(&self, b: usize) -> f64 {
        let [i, j] = [self.list.owner[b / GROUP], self.list.partner[b]].map(|r| r as usize);
        let (z, length) = self.list.z(true, i, j, self.cell);
        length * (1.0 + banded(z, length, self.rules.options).s)
    }
}
