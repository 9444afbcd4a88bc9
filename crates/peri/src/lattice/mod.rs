//! Bodies on lattices: sweeps over all bonds for what sites have, then for forces; what breaks.

pub mod bond_stretch;
pub mod breaking;
pub mod chunk;
pub mod constants;
pub mod energies;
pub mod forms;
pub mod gather;
pub mod kernels;
pub mod leads;
pub(crate) mod owed;
pub mod states;
pub mod sweep;
pub mod tables;
pub(crate) mod tiles;

use crate::cauchy;
use crate::families::lattice::{LatticeBody, PAD};
use crate::families::shares::{BodyShare, Shares};
use crate::families::tiles::Tiles;
use crate::families::{Cell, Families, FamilyOptions, ForceUnit, Law, PeriView};
use crate::lattice::sweep::{ChunkColumns, Mode, Sweep};
use crate::law::kernels::Loops;
use crate::law::moment::COLUMNS;
use crate::law::moment::Moment;
use crate::law::settle::{Settling, Sites, stiffen, with_thermal_strain, without_thermal_strain};
use crate::law::state::SiteState;
use crate::law::style::{Losses, Style};
use crate::law::terms::Sum;
use crate::shares::dues::share_sums;
use perigrain_base::par::Shared;
use states::{States, find_active};

impl Families {
    /// Weighs all families: at their building.
    pub(crate) fn weigh(&mut self, view: &PeriView, cell: &Cell) {
        for body in &mut self.lattices {
            constants::weigh_lattice(body, view, &self.options, &self.law);
        }
        constants::weigh_list(&mut self.list, cell, &self.law);
    }

    /// Adds the forces of all bonds of bodies on lattices; where work is shared out to ranks, to the particles of this one.
    pub(crate) fn sweep_lattices(
        &mut self,
        view: &PeriView,
        f: &mut [[f64; 3]],
        (advance, tallied): (bool, bool),
        shares: Option<&mut Shares>,
    ) {
        let form = self.form();
        let Self { lattices, options, law, table, breaking_enabled, counts_losses, implicit, .. } = self;
        let mode = Mode { advance, breaking_enabled: *breaking_enabled, skip: options.skip_rest, form };
        let settling =
            law.settling(table, options, (advance || *implicit, advance), (tallied, *counts_losses));
        let f = Shared::new(f);
        let mut shares = shares.into_iter().flat_map(|shares| &mut shares.bodies);
        for body in lattices {
            lattice_body(body, view, &f, (mode, options), (law, &settling, shares.next()));
        }
    }

    /// The dilatation of a particle at the last force evaluation.
    pub fn dilatation(&self, i: usize) -> f64 {
        self.of_site(i, |state| &state.theta)
    }

    /// The accumulated plastic multiplier of a particle; under correspondence its equivalent plastic strain.
    pub fn plastic_strain(&self, i: usize) -> f64 {
        if self.law.kind.correspondence {
            return self.state(i).map_or(0.0, |state| state.memory.strain);
        }
        self.of_site(i, |state| &state.plastic)
    }

    /// A number of a particle's site; its place among columns with unused entries is found.
    pub(crate) fn of_site(&self, i: usize, column: impl Fn(&SiteState) -> &Vec<f64>) -> f64 {
        let place = self.place.get(i).copied().unwrap_or(u32::MAX);
        if place == u32::MAX {
            return 0.0;
        }
        let body = self.lattices.partition_point(|b| b.first_place + b.particle.len() as u32 <= place);
        let (state, at) = match self.lattices.get(body) {
            Some(body) => (&body.state, PAD + (place - body.first_place) as usize),
            None => (&self.list.state, (place - self.list.first_place) as usize),
        };
        column(state).get(at).copied().unwrap_or(0.0)
    }
}

/// LAMMPS takes the energy of plastic bonds from what they remembered before they flowed; ours is compared with that one
/// where heat is counted.
pub fn keep_earlier(state: &mut SiteState, law: &Style, settling: &Settling) {
    let flows = law.flows();
    let asked = if settling.compat { settling.tallied } else { settling.counted };
    match flows && asked {
        true => state.earlier.clone_from(&state.memory),
        false => state.earlier.clear(),
    }
}

/// Notes the form in which viscous bonds remember from now on.
pub fn hold(state: &mut SiteState, law: &Style, settling: &Settling) {
    if settling.keep && law.losses == Losses::Relaxation {
        state.held = settling.moment.hold;
    }
}

/// From the sums of dilatations to what sites have, with their thermal strains where there are some.
pub fn dilate(loops: &dyn Loops, settling: &Settling, state: &mut SiteState, sites: &Sites) {
    if sites.strain.is_empty() {
        return loops.dilatations(settling, state, sites);
    }
    without_thermal_strain(state, sites);
    loops.dilatations(settling, state, sites);
    with_thermal_strain(state, sites);
}

/// The sweeps over one body on a lattice.
fn lattice_body(
    body: &mut LatticeBody,
    view: &PeriView,
    f: &Shared<[f64; 3]>,
    (mode, options): (Mode, &FamilyOptions),
    (law, settling, mut share): (&Law, &Settling, Option<&mut BodyShare>),
) {
    let known = law;
    let (law, loops) = (law.kind.style(), law.kind.loops(settling.compat));
    let spreads = law.spreads();
    if spreads {
        find_active(body, law.memory() > 0 || law.correspondence, share.as_deref());
    }
    if loops.about().columns > 0 {
        body.state.columns.resize(COLUMNS.max(loops.about().columns) * body.stride, 0.0);
    }
    let mut columns = ChunkColumns::take(body);
    let mut windows = std::mem::take(&mut body.tiles.windows);
    let tiles = std::mem::take(&mut body.tiles);
    keep_earlier(&mut body.state, law, settling);
    let mut memory = std::mem::take(&mut body.state.memory);
    let mut touched = std::mem::take(&mut body.state.touched);
    let newton = options.unit == ForceUnit::Newton;
    let particle = std::mem::take(&mut body.particle);
    let (memory_of, touched_of) = (Shared::new(&mut memory), Shared::new(&mut touched));
    let states = States {
        form: mode.form,
        law,
        compat: settling.compat,
        moment: Moment { held: body.state.held, ..settling.moment },
        keep: mode.advance,
        memory: &memory_of,
        touched: &touched_of,
        spread: false,
    };
    let spread = States { spread: spreads, ..states };
    let count = particle.len();
    let only = if let [only] = body.kinds[..] { Some(only) } else { None };
    let stiffness = std::mem::take(&mut body.scatter.stiffness);
    let strain = body.scatter.strains().to_vec();
    let (stride, kinds) = (body.stride, view.kind);
    let sites = Sites {
        count,
        pad: PAD,
        stride,
        particle: &particle,
        kind: kinds,
        only,
        stiffness: &stiffness,
        strain: &strain,
    };
    if law.correspondence {
        let mut sums = std::mem::take(&mut body.state.sums);
        sums.clear();
        sums.resize(9 * body.stride, 0.0);
        let sweep = Sweep::new(body, &mut columns, mode, newton, states);
        cauchy::lattice::add_gradients(&sweep, (&tiles, &mut windows), &mut sums);
        body.state.sums = sums;
        let places = cauchy::site::Places::columns(body.stride);
        cauchy::site::settle(settling, &mut body.state, &sites, places, &known.rules(view));
    }
    let mut add_up = |body: &mut LatticeBody, sum, states, mut share: Option<&mut BodyShare>| {
        let mut sums = std::mem::take(&mut body.state.sums);
        sums.clear();
        sums.resize(body.stride, 0.0);
        let shared = Shared::new(&mut sums);
        let sweep = Sweep::new(body, &mut columns, mode, newton, states);
        states::all(&sweep, sum, (&tiles, &mut windows), share.as_deref_mut(), &shared);
        if let Some(share) = share {
            let places = |slot: usize| {
                let cells = body.rows[slot].cells();
                PAD + cells.start..PAD + cells.end
            };
            share_sums(places, &mut share.rows, &mut sums);
        }
        body.state.sums = sums;
    };
    if !law.bond_based && !law.correspondence {
        add_up(body, Sum::Dilatation, states, share.as_deref_mut());
        dilate(loops, settling, &mut body.state, &sites);
    }
    if law.stiffened {
        stiffen(settling, &mut body.state, &sites);
    }
    if let Some(norm) = loops.about().norm {
        add_up(body, norm, spread, None);
        loops.flow(settling, &mut body.state, &sites);
    }
    (body.particle, body.scatter.stiffness) = (particle, stiffness);
    let sweep = Sweep::new(body, &mut columns, mode, newton, spread);
    sweep.all((&tiles, &mut windows), share, f);
    columns.give(body);
    body.tiles = Tiles { windows, ..tiles };
    (body.state.memory, body.state.touched) = (memory, touched);
    hold(&mut body.state, law, settling);
}
