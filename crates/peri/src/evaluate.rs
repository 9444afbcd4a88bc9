//! Peridynamic families at work: building them, the forces of a step, breaking, damage.

use perigrain_base::math::periods::Periods;

use crate::contact::{Repulsion, push_apart, repel};
use crate::energy::tally;
use crate::families::lattice::RowMotion;
use crate::families::shares::Shares;
use crate::families::{
    AlmostLattice, Bounds, Cell, Criterion, Edges, Families, FamilyOptions, Law, Layout, NearPairs,
    PeriTally, PeriView, PmbCoeff, PmbTable, Scratch,
};
use crate::lattice::gather::gather;
use crate::lattice::sweep::Mode;
use crate::lattice::tables;
use crate::list;
use crate::setup::sites::{Carrier, carrier};
use crate::setup::spacing::spacings;
use crate::setup::{detect, lattice as cells, list as records, weights};
use crate::shares::list::{forget_others, lowest_everywhere};
use crate::shares::{agree, forget_flags, squeezed_everywhere};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::form::Form;
use perigrain_base::par::Shared;
use perigrain_base::stop;

/// An evaluation of forces of which the first half is done.
#[derive(Debug)]
pub struct Begun {
    advance: bool,
    /// How work is shared out to ranks, where this evaluation is.
    shares: Option<Shares>,
    /// The ranges of displacement changes.
    changes: Option<(f64, f64)>,
    /// Whether the second half looks at the places of all particles.
    pub searches: bool,
}

impl Families {
    /// Finds all bonds: partners closer than the horizon of their types in the present positions. They are
    /// microelastic.
    ///
    /// # Errors
    /// A periodic box shorter than two horizons is refused: a bond would meet its own image.
    pub fn build(view: &PeriView, table: &PmbTable, options: FamilyOptions) -> Result<Self> {
        Self::build_of(view, table, options, Law::default())
    }

    /// The same for bonds of any law.
    ///
    /// # Errors
    /// As for [`Families::build`].
    pub fn build_of(view: &PeriView, table: &PmbTable, options: FamilyOptions, law: Law) -> Result<Self> {
        let mut families = Self::empty(view, table, options, law);
        if options.weights.own_horizons {
            families.spacing = spacings(view, table, options.lattice_spacing);
        }
        check_box(view, detect::reach(table, &options, &families.spacing))?;
        stop::check()?;
        families.lay_out(view);
        families.number_places();
        stop::check()?;
        families.refresh(view, table);
        if options.weights.any() {
            let Self { list, law, options, spacing, .. } = &mut families;
            families.weighed = Some(weights::weigh(list, view, (law, options), spacing));
        }
        if families.law.kind.has_states() {
            families.weigh(view, &families.cell_before());
        }
        if families.law.kind.correspondence {
            families.begin_correspondence(view);
        }
        stop::check()?;
        let reaches = table.iter().map(|c| options.volume.reach(c.horizon, options.lattice_spacing));
        let finest = families.spacing.iter().copied().reduce(f64::min).unwrap_or(1.0);
        families.start_near(finest * reaches.fold(f64::INFINITY, f64::min));
        if view.excluded.is_some() {
            // Close pairs without a bond may meet as soon as the rules are gone.
            families.forget_near();
        }
        families.find_loose(view);
        Ok(families)
    }

    /// The same of bonds that are known: ends and type − 1 of each, with coefficients by type. There is no short-range
    /// contact; `table` has what is said of pairs of types of particles.
    ///
    /// # Errors
    /// As for [`Families::build`].
    pub fn build_from(
        view: &PeriView,
        links: &[([u32; 2], u8)],
        (table, of_bonds): (&PmbTable, Vec<PmbCoeff>),
        options: FamilyOptions,
        law: Law,
    ) -> Result<Self> {
        let far = records::longest(view, links);
        check_box(view, far)?;
        let mut families = Self::empty(view, table, FamilyOptions { no_repulsion: true, ..options }, law);
        families.of_bonds = of_bonds;
        families.reference = Some(view.x.to_vec());
        let (volume, size) = (&mut families.family_volume, &mut families.family_size);
        families.list = records::lay_out_links(view, links, far, volume, size);
        families.number_places();
        families.refresh(view, table);
        if families.law.kind.has_states() {
            families.weigh(view, &families.cell_before());
        }
        families.start_near(far);
        Ok(families)
    }

    fn empty(view: &PeriView, table: &PmbTable, options: FamilyOptions, law: Law) -> Self {
        let n = view.x.len();
        Self {
            table: table.clone(),
            options,
            law,
            of_bonds: vec![],
            work_limits: vec![],
            seen: 0,
            breaking_enabled: false,
            lattices: vec![],
            list: Default::default(),
            reference: (view.x != view.x0).then(|| view.x.to_vec()),
            birth: periods(&view.bounds).into(),
            before: periods(&view.bounds).into(),
            place: vec![u32::MAX; n],
            family_volume: vec![0.0; n],
            family_size: vec![0; n],
            spacing: vec![],
            lasting: vec![],
            damaged: vec![false; n],
            near: NearPairs::default(),
            released: 0.0,
            trailing: 0.0,
            late: 0.0,
            heat: 0.0,
            lost: [0.0; 2],
            warmed: 0.0,
            relaxing: None,
            counts_losses: false,
            taken: 0.0,
            counts_warming: false,
            breaking_share: None,
            implicit: false,
            ratios: vec![],
            unjudged: false,
            four_lanes: false,
            almost: vec![],
            weighed: None,
            shares: None,
            scratch: Scratch::default(),
        }
    }

    /// Gives each body its layout.
    fn lay_out(&mut self, view: &PeriView) {
        let bodies = detect::bodies(view, &self.table, &self.options, &self.spacing);
        let mut listed = Vec::new();
        let mut wraps = false;
        for (k, members) in bodies.members.iter().enumerate() {
            let free = self.options.layout == Layout::Auto
                && !self.options.weights.any()
                && !bodies.wraps[k]
                && self.suits_lattice(view, members);
            let carrier = if free { carrier(view, members, bodies.nearest[k]) } else { Carrier::Nothing };
            let (volume, size) = (&mut self.family_volume, &mut self.family_size);
            let body = match carrier {
                Carrier::Lattice(sites) => {
                    cells::lay_out(view, members, &sites, &self.table, &self.options, volume, size)
                }
                Carrier::Almost(off) => {
                    self.almost.push(AlmostLattice { first: members[0], count: members.len(), off });
                    None
                }
                Carrier::Nothing => None,
            };
            match body {
                Some(body) => self.lattices.push(body),
                None => {
                    listed.extend_from_slice(members);
                    wraps |= bodies.wraps[k];
                }
            }
        }
        listed.sort_unstable();
        let (volume, size) = (&mut self.family_volume, &mut self.family_size);
        let rules = (&self.table, &self.options, &self.spacing[..]);
        self.list = records::lay_out(view, &listed, wraps, rules, volume, size);
    }

    /// Lattice kernels of bonds with memory know one pair of types and one volume.
    fn suits_lattice(&self, view: &PeriView, members: &[u32]) -> bool {
        let of = |p: u32| (view.kind[p as usize], view.volume[p as usize].to_bits());
        let kind = self.law.kind;
        kind.plain()
            || !kind.bond_based
            || members.first().is_none_or(|first| members.iter().all(|p| of(*p) == of(*first)))
    }

    /// Numbers cells and records through all bodies.
    fn number_places(&mut self) {
        let mut first = 0;
        self.place.fill(u32::MAX);
        for body in &mut self.lattices {
            body.first_place = first;
            for (cell, &p) in body.particle.iter().enumerate() {
                if p != u32::MAX {
                    self.place[p as usize] = first + cell as u32;
                }
            }
            first += body.particle.len() as u32;
        }
        self.list.first_place = first;
        for (r, &p) in self.list.particle.iter().enumerate() {
            if p != u32::MAX {
                self.place[p as usize] = first + r as u32;
            }
        }
    }

    fn find_loose(&mut self, view: &PeriView) {
        let types = self.table.types() as u16;
        let touches = |kind: u16| (1..=types).any(|other| self.table.get(kind, other).is_some());
        let loose = (0..self.place.len()).filter(|&p| self.place[p] == u32::MAX && touches(view.kind[p]));
        self.near.loose = loose.map(|p| (p as u32, view.x[p])).collect();
    }

    /// Whether bonds may break, flow or remember anything else.
    pub fn change(&self) -> bool {
        let breaks = |c: &PmbCoeff| c.s00.is_finite();
        self.options.criterion.by_itself()
            || self.remembers()
            || self.table.iter().any(breaks)
            || self.of_bonds.iter().any(breaks)
    }

    /// How long the longest bond at the start may be.
    pub fn reach(&self) -> f64 {
        match self.of_bonds.is_empty() {
            true => detect::reach(&self.table, &self.options, &self.spacing),
            false => self.of_bonds.iter().map(|c| c.horizon).fold(0.0, f64::max),
        }
    }

    /// Takes over coefficients, types and volumes that a deck has changed since families were built. Families
    /// themselves stay.
    pub fn refresh(&mut self, view: &PeriView, table: &PmbTable) {
        self.table = table.clone();
        let cell = self.cell_before();
        for body in &mut self.lattices {
            tables::refresh(body, view, table, &self.options, &self.law);
        }
        list::refresh(&mut self.list, view, table, &self.options, (&self.law, &self.of_bonds), &cell);
        self.continua().for_each(|(own, _)| own.inverse.clear());
    }

    /// Takes in particles created since: they have no family, but short-range contact.
    fn particles_joined(&mut self, view: &PeriView) {
        let n = view.x.len();
        if self.place.len() == n {
            return;
        }
        self.place.resize(n, u32::MAX);
        self.family_volume.resize(n, 0.0);
        self.family_size.resize(n, 0);
        self.damaged.resize(n, false);
        if let Some(reference) = &mut self.reference {
            reference.extend_from_slice(&view.x[reference.len()..]);
        }
        self.find_loose(view);
        self.forget_near();
    }

    /// Adds the forces of all bonds and of short-range contact to `f`. With `advance`, overstretched bonds
    /// then break and the families' smallest stretches are those of this step.
    pub fn force(
        &mut self,
        view: &PeriView,
        f: &mut [[f64; 3]],
        advance: bool,
        tally: Option<&mut PeriTally>,
    ) {
        let begun = self.begin(view, advance, false);
        self.finish(view, f, begun, tally);
    }

    /// Whether an evaluation that advances or not, is tallied or not, is shared out to ranks: each computes the forces on its own particles,
    /// which takes the places of those that bonds and near pairs join to them.
    pub fn is_shared(&self, advance: bool, tallied: bool) -> bool {
        // The energies of dilatations are added up one site after the other.
        let rows = !tallied || self.law.kind.bond_based;
        let by_stretch = self.options.criterion == Criterion::Stretch;
        let (shared, correspondence) = (self.shares.is_some(), self.law.kind.correspondence);
        shared && !correspondence && advance && rows && by_stretch && !self.counts_losses
    }

    /// Which kernels serve on this processor.
    pub(crate) fn form(&self) -> Form {
        match Form::here() {
            _ if self.options.portable => Form::Plain,
            form if self.four_lanes => form.in_fours(),
            form => form,
        }
    }

    /// The first half of [`Families::force`]: what has moved, and by how much. `shared` says that work is shared out to ranks, where it can be
    /// ([`Families::is_shared`]) and nothing is added up by particle; elsewhere everything has to be up to date.
    pub fn begin(&mut self, view: &PeriView, advance: bool, shared: bool) -> Begun {
        self.particles_joined(view);
        let shares = self.shares.take_if(|_| shared);
        self.late = 0.0;
        if self.law.kind.correspondence {
            self.find_shapes(view);
        }
        if self.before != Edges::from(periods(&view.bounds)) {
            // Images have come nearer to each other.
            self.forget_near();
        }
        let moved = self.gather(view, shares.as_ref());
        let repels = !self.options.no_repulsion;
        let changes = repels.then(|| self.ranges(view, &moved, (advance, shares.as_ref())));
        let searches = changes.is_some_and(|changes| self.searches(changes));
        Begun { advance, shares, changes, searches }
    }

    /// Puts all bonds at the places of `view`; those of an evaluation that has begun have to come last.
    pub fn put(&mut self, view: &PeriView) {
        self.gather(view, None);
    }

    /// Takes the places of particles to their bonds.
    fn gather(&mut self, view: &PeriView, shares: Option<&Shares>) -> RowMotion {
        let form = self.form();
        let reference = self.reference.as_deref().unwrap_or(view.x0);
        // Bonded particles that were put close to each other before families were built push each other from the start.
        let repels = !self.options.no_repulsion;
        for (k, body) in self.lattices.iter_mut().enumerate() {
            let short_range = repels && body.contact >= 0.0;
            let follows = shares.map(|shares| &shares.bodies[k].follows[..]);
            // SAFETY: the processor has what the form needs.
            unsafe { gather(form, body, view, reference, short_range, follows) };
        }
        let short_range = repels && self.list.contact >= 0.0;
        list::gather(&mut self.list, view, short_range, shares.and_then(|shares| shares.list.as_ref()))
    }

    /// The second half. Where it searches for pairs the places of all particles have to be known.
    pub fn finish(
        &mut self,
        view: &PeriView,
        f: &mut [[f64; 3]],
        begun: Begun,
        mut tallied: Option<&mut PeriTally>,
    ) {
        let Begun { advance, mut shares, changes, .. } = begun;
        if let Some(shares) = &shares {
            forget_flags(&mut self.lattices, shares);
            shares.list.iter().for_each(|share| forget_others(&mut self.list, share));
        }
        let cell = &self.cell(view);
        self.sweep_lattices(view, f, (advance, tallied.is_some()), shares.as_mut());
        self.sweep_list(view, f, (advance, tallied.is_some()), (cell, shares.as_mut()));
        if advance {
            self.add_lost();
        }
        if advance && self.counts_losses {
            self.count_heat(view, cell);
        }
        let agreed = shares.as_ref().map(|_| agree(&self.lattices, &self.list));
        if let Some((shares, agreed)) = shares.as_ref().zip(agreed) {
            if agreed.squeezed {
                squeezed_everywhere(&mut self.lattices, shares, tallied.is_some());
            }
            if let Some(share) = shares.list.as_ref().filter(|_| self.list.may_touch(agreed.lowest)) {
                lowest_everywhere(&mut self.list, share, tallied.is_some());
            }
        }
        self.contact(view, f, (changes, advance, shares.as_ref()), tallied.as_deref_mut());
        if let Some(t) = tallied {
            tally(self, view, t, (advance, cell, shares.as_ref()));
        }
        if advance {
            let shared = agreed.zip(shares.as_mut().map(|shares| shares.list.as_mut()));
            self.advance(view, cell, shared);
        }
        if let Some(shares) = &mut shares {
            shares.sent += shares.dues() as u64;
        }
        self.shares = self.shares.take().or(shares);
    }

    /// Adds the forces of all bonds that are kept as a list.
    pub(super) fn sweep_list(
        &mut self,
        view: &PeriView,
        f: &mut [[f64; 3]],
        (advance, tallied): (bool, bool),
        (cell, shares): (&Cell, Option<&mut Shares>),
    ) {
        let form = self.form();
        let Self { list, options, law, table, breaking_enabled, counts_losses, implicit, .. } = self;
        let mode = Mode {
            advance,
            breaking_enabled: *breaking_enabled,
            skip: options.skip_rest && !list.scatter.heated(),
            form,
        };
        let settling =
            law.settling(table, options, (advance || *implicit, advance), (tallied, *counts_losses));
        if list.inverse.len() != list.partner.len() {
            // Read from a restart file.
            list::measure(list, law, cell);
        }
        let share = shares.and_then(|shares| shares.list.as_mut());
        let f = Shared::new(f);
        list::sweep::forces(list, view, &f, (mode, options), (law, &settling, share), cell);
    }

    fn contact(
        &mut self,
        view: &PeriView,
        f: &mut [[f64; 3]],
        (changes, advance, shares): (Option<(f64, f64)>, bool, Option<&Shares>),
        tally: Option<&mut PeriTally>,
    ) {
        let closer = changes.map(|changes| self.update_near(view, changes, (advance, shares)));
        let (mut memory, mut rows) =
            (std::mem::take(&mut self.scratch.contact), std::mem::take(&mut self.scratch.rows));
        let mut repulsion = Repulsion { view, table: &self.table, options: &self.options, f, tally };
        if let Some(closer) = closer {
            repel(self, (closer, shares), &mut repulsion, (&mut memory, &mut rows));
        }
        push_apart(self, &mut repulsion);
        (self.scratch.contact, self.scratch.rows) = (memory, rows);
    }
}

/// The edges along which the box repeats.
pub(super) fn periods(bounds: &Bounds) -> Periods {
    bounds.periods()
}

fn check_box(view: &PeriView, reach: f64) -> Result<()> {
    let bounds = &view.bounds;
    let heights = bounds.edges().heights();
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        let length = heights[k];
        if bounds.periodic[k] && length < 2.0 * reach {
            let message = format!(
                "the periodic box is {length} long in {name}, less than twice the horizon {reach}: \
                 bonds would meet their own images"
            );
            let help = "make the box longer, the horizon shorter, or this boundary f, s or m";
            return Err(Diagnostic::error(Code::CONFLICT, None, message).help(help).into());
        }
    }
    Ok(())
}
