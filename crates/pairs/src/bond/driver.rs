//! The op of bonds as columns: finds their ends, evaluates a law for all of them, lets them break.

use super::store_local::Store;
use perigrain_base::comm::rows;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::body::{Quat, UNTURNED, after, back, turned};
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::{Vec3, dot, length, scale, sub};
use perigrain_base::par;
use perigrain_bonded::columns::{Columns, GROUP, Key, Member};
use perigrain_bonded::law::{BondLaw, Ends, Motion};
use perigrain_bonded::sweep::{Body, Out, Sweep, add_up, nearest};
use perigrain_plan::{About, Needs, Op, Span as Rows, Stage, Tick};
use perigrain_styles::pull::{Found, Pull, Stretched, apart, find, periods};
use perigrain_world::bonds::ascending;
use perigrain_world::field::{BONDS, BOX, F, Fields, LISTS, MEMO, OMEGA, QUAT, TAG, TALLY, TORQUE, V, X};
use perigrain_world::index::Index;
use perigrain_world::share::{Halo, Listed};
use perigrain_world::tally::add_share;
use perigrain_world::{Bond, Key as ListKey, World};

/// A law with the coefficients of the deck's lines.
pub trait Driven<const C: usize>: Clone + Send + Sync + 'static {
    /// What one bond does.
    type Law: BondLaw<C>;
    /// The style's name.
    const NAME: &'static str;

    /// The law, as the style's line sets it.
    fn law(&self) -> Self::Law;

    /// The coefficients of a type, if the style has some for it.
    fn coeffs(&self, kind: u16) -> Option<Coeffs<C, Self>>;

    /// Whether the length at rest is that at which a run first meets the bond.
    fn measures(&self) -> bool {
        false
    }

    /// Whether some bond is damped.
    fn damped(&self) -> bool {
        false
    }

    /// Whether bonds break.
    fn breaks(&self) -> bool {
        false
    }

    /// What changes in the columns before forces are evaluated. Bonds whose memory has changed, with what it is now.
    fn prepare(&self, _columns: &mut Columns<C>, _body: &Body, _dimension: i32) -> Vec<(usize, f64)> {
        vec![]
    }

    /// Whether the preparation covers all bonds.
    fn prepares(&self) -> bool {
        false
    }

    /// What is kept of bonds that break.
    fn store(&self) -> Option<&Store> {
        None
    }

    /// Whether axes at rest are vectors of space, as if no particle had turned when its bond was made.
    fn axes_in_space(&self) -> bool {
        false
    }

    /// What belongs to a bond alone.
    fn own(&self, w: &World, k: &Coeffs<C, Self>, bond: &Bond, ends: [usize; 2]) -> [f64; C];

    /// What `own` reads of the world.
    fn reads(&self) -> Fields {
        Fields::NONE
    }

    /// Whether fixes may change coefficients.
    fn adapts(&self) -> bool {
        false
    }

    /// Takes the coefficients that fixes have changed.
    fn adapt(&mut self, _w: &World) {}
}

/// The coefficients of a bond type.
pub type Coeffs<const C: usize, L> = <<L as Driven<C>>::Law as BondLaw<C>>::Coeffs;

/// A bond that a style now sees for the first time gets its length and axis at rest.
///
/// # Errors
/// Ends at one place.
fn first_sight<const C: usize, L: Driven<C>>(
    law: &L,
    w: &mut World,
    list: &[(usize, Found)],
    span: Span,
) -> Result<()> {
    let lengths = periods(w)?;
    for (at, found) in list {
        let bond = w.bonds.list[*at];
        let known = bond.length != 0.0 || !law.measures();
        if known && (bond.axis != [0.0; 3] || !L::Law::TURNS) {
            continue;
        }
        let [a, b] = lower_first(bond.ends, found.ends);
        let r = apart(w, &lengths, [a, b]);
        let distance = length(r);
        if !known {
            w.bonds.list[*at].length = distance;
        }
        if distance == 0.0 && (law.measures() || L::Law::TURNS) {
            let [a, b] = bond.ends;
            let d = Diagnostic::error(
                Code::BAD_VALUE,
                span,
                format!("particles {a} and {b} are joined and at one place"),
            );
            return Err(d.help("`delete_bonds` takes their bond away").into());
        }
        if !L::Law::TURNS {
            continue;
        }
        let mut axis = scale(1.0 / distance, r);
        if !law.axes_in_space() {
            let q = [w.particles.quat[a], w.particles.quat[b]];
            axis = turned(back(q[1]), axis);
            let turn = after(back(q[0]), q[1]);
            if q[0] != q[1] {
                w.bonds.turned.insert(ascending(bond.ends), turn);
            }
        }
        w.bonds.list[*at].axis = axis;
    }
    Ok(())
}

/// Places of ends, that of the lower ID first.
fn lower_first(ids: [u32; 2], places: [usize; 2]) -> [usize; 2] {
    if ids[0] < ids[1] { places } else { [places[1], places[0]] }
}

/// The input of a law for one bond in its present state: its ends, and how they move, and with `turns` how they have turned. The
/// first end is that with the lower ID.
pub fn ends_of(w: &World, bond: &Stretched, turns: bool) -> (Ends<f64>, Motion<f64>) {
    let p = &w.particles;
    let [a, b] = lower_first(bond.bond.ends, bond.ends);
    let sign = if a == bond.ends[0] { 1.0 } else { -1.0 };
    let r = scale(sign, bond.d);
    let turn = w.bonds.turned.get(&ascending(bond.bond.ends)).copied().unwrap_or(UNTURNED);
    let (mut quat, mut omega) = ([UNTURNED; 2], [[0.0; 3]; 2]);
    if turns {
        quat = [after(p.quat[a], turn), p.quat[b]];
        omega = [p.omega[a], p.omega[b]];
    }
    let axis = if bond.bond.axis == [0.0; 3] { scale(1.0 / length(r), r) } else { bond.bond.axis };
    let at_rest = if bond.rest == 0.0 { bond.length() } else { bond.rest };
    (Ends { r, length: at_rest, axis, quat }, Motion { v: scale(sign, bond.v), omega })
}

/// What a bond of a style does now, along its line.
pub fn pull_of<const C: usize, L: Driven<C>>(law: &L, w: &World, bond: &Stretched) -> Option<Pull> {
    let k = law.coeffs(bond.kind)?;
    let (ends, motion) = ends_of(w, bond, L::Law::TURNS);
    let own = law.own(w, &k, &bond.bond, lower_first(bond.bond.ends, bond.ends));
    let acts = law.law().act(&k, &own, &ends, Some(&motion));
    let r2 = dot(ends.r, ends.r);
    let force_per_length = if r2 > 0.0 { dot(acts.force, ends.r) / r2 } else { 0.0 };
    Some(Pull { energy: acts.energy, force_per_length })
}

/// Counts what makes columns void: places that change, particles that come or go, bonds.
fn stand(w: &World) -> [u64; 3] {
    [w.rebuild.places, w.rebuild.roster, w.bonds.changes]
}

/// Which bonds this rank evaluates, where grains are shared out to ranks: the groups that hold a bond of one of its grains. A bond across
/// a border is evaluated by both ranks.
#[derive(Default)]
struct Part {
    /// The deal, and how the rows of the columns were arranged.
    of: Option<[u64; 2]>,
    groups: Vec<bool>,
}

/// Forces of all bonds of one law, and their breaking.
pub struct Bonded<const C: usize, L: Driven<C>> {
    law: L,
    span: Span,
    /// Which changes of coefficients have been seen.
    adapted: f64,
    /// At which places of particles and which bonds the columns were made.
    made: Option<[u64; 3]>,
    /// The particles as they stood then.
    tags: Vec<u32>,
    columns: Columns<C>,
    coeffs: Vec<Option<Coeffs<C, L>>>,
    out: Out,
    /// How often the rows of the columns have been arranged otherwise.
    arranged: u64,
    part: Part,
    /// Under which name it has rows of other ranks.
    listing: ListKey<Listed>,
}

impl<const C: usize, L: Driven<C>> Bonded<C, L> {
    /// With a law; types without coefficients are none of its business.
    pub fn new(law: L, span: Span) -> Self {
        Self {
            law,
            span,
            adapted: 0.0,
            made: None,
            tags: vec![],
            columns: Columns::default(),
            coeffs: vec![],
            out: Out::default(),
            arranged: 0,
            part: Part::default(),
            listing: ListKey::new(&format!("bond {}", L::NAME)),
        }
    }

    /// Finds bonds and their ends anew.
    fn lay_out(&mut self, w: &mut World) -> Result<()> {
        let list = find(w, |b| self.law.coeffs(b.kind as u16).is_some(), self.span)?;
        first_sight(&self.law, w, &list, self.span)?;
        self.coeffs = (0..=w.bonds.types).map(|k| self.law.coeffs(k as u16)).collect();
        let ends = |k: usize| {
            let (at, found) = &list[k];
            lower_first(w.bonds.list[*at].ends, found.ends).map(|e| e as u32)
        };
        let keys: Vec<Key> = (0..list.len()).map(|k| Key { kind: list[k].1.kind, ends: ends(k) }).collect();
        let (law, coeffs) = (&self.law, &self.coeffs);
        self.columns.fill(&keys, w.n(), |k| {
            let (bond, Key { kind, ends }) = (&w.bonds.list[list[k].0], keys[k]);
            let turned = if w.bonds.turned.is_empty() {
                UNTURNED
            } else {
                w.bonds.turned.get(&ascending(bond.ends)).copied().unwrap_or(UNTURNED)
            };
            let own = match &coeffs[usize::from(kind)] {
                Some(k) => law.own(w, k, bond, ends.map(|e| e as usize)),
                None => [0.0; C],
            };
            Member { kind, ends, length: bond.length, axis: bond.axis, turned, own }
        });
        self.tags.clone_from(&w.particles.tag);
        self.made = Some(stand(w));
        self.arranged += 1;
        Ok(())
    }

    /// Follows particles that have only changed places since the columns were made; false if more than that has happened.
    fn follow(&mut self, w: &World) -> bool {
        let now = stand(w);
        // What belongs to a bond may have changed with what it is reckoned from.
        let same = self.law.reads().is_empty() && self.made.is_some_and(|made| made[1..] == now[1..]);
        if !same || self.tags.len() != w.n() {
            return false;
        }
        let (index, tags) = (Index::new(&w.particles.tag), &w.particles.tag);
        let mut moved = vec![u32::MAX; tags.len()];
        par::each((&mut moved[..], &self.tags[..]), |_, (moved, ids)| {
            for (to, place) in moved.iter_mut().zip(ids.iter().map(|id| index.find(*id, tags))) {
                *to = place.map_or(u32::MAX, |place| place as u32);
            }
        });
        if moved.contains(&u32::MAX) {
            return false;
        }
        self.columns.follow(&moved);
        self.tags.clone_from(tags);
        self.made = Some(now);
        self.arranged += 1;
        true
    }

    /// The present deal of grains to ranks, where this rank evaluates the bonds of its own: not where sums over bonds are
    /// requested.
    fn deal(&self, w: &World, t: &Tick) -> Option<u64> {
        let sums = t.energy || t.atom_energy || t.virial || w.bonds.past().counts_losses;
        w.grains_dealt().filter(|_| !sums && !t.setup && !self.law.prepares())
    }

    /// Finds the bonds that this rank evaluates, and has what they read of other ranks' particles.
    fn take_part(&mut self, w: &mut World, deal: u64) {
        w.act_narrowly();
        let of = Some([deal, self.arranged]);
        if self.part.of != of {
            let mut is_own = vec![false; w.n()];
            let share = w.narrow_share();
            share.iter().flat_map(|share| &share.own).for_each(|rows| is_own[rows.clone()].fill(true));
            let ends =
                |group: usize| (group * GROUP..(group + 1) * GROUP).flat_map(|bond| self.columns.pair(bond));
            let groups = 0..self.columns.rows() / GROUP;
            self.part.groups = groups.map(|group| ends(group).any(|end| is_own[end])).collect();
            self.part.of = of;
        }
        let columns = &self.columns;
        w.list_rows((self.listing, self.arranged), || {
            let mut is_listed = vec![false; columns.particles()];
            let groups = self.part.groups.iter().enumerate().filter(|(_, evaluated)| **evaluated);
            let bonds = groups.flat_map(|(group, _)| group * GROUP..(group + 1) * GROUP);
            bonds.flat_map(|bond| columns.pair(bond)).for_each(|end| is_listed[end] = true);
            (0..is_listed.len() as u32).filter(|row| is_listed[*row as usize]).collect()
        });
        let turns = if L::Law::TURNS { QUAT | OMEGA } else { Fields::NONE };
        let moves = if self.law.damped() { V } else { Fields::NONE };
        w.halo(X | turns | moves, Halo::Listed);
    }

    /// Energies and virials, if requested.
    fn tally(&self, w: &mut World, t: &Tick, periods: &Periods) {
        if t.energy {
            let energy = par::sum(self.columns.rows(), |k| self.out.force[k].0[3]);
            w.tally.bond += energy;
        }
        if t.atom_energy {
            let energies = &mut w.tally.bond_atom;
            energies.resize(w.particles.x.len(), 0.0);
            for k in self.columns.living() {
                self.columns.pair(k).iter().for_each(|&i| energies[i] += 0.5 * self.out.force[k].0[3]);
            }
        }
        if t.virial {
            let (tally, x) = (&mut *w.tally, &w.particles.x);
            for k in self.columns.living() {
                let ends @ [a, b] = self.columns.pair(k);
                let d = nearest(sub(x[a], x[b]), periods);
                let f = &self.out.force[k].0;
                let atoms = t.atom_virial.then_some(&mut tally.atom_bonds[..]);
                add_share(&mut tally.bond_virial, atoms, ends, d, [f[0], f[1], f[2]]);
            }
        }
    }

    /// Books the work of the dashpots of this style's types in the ledger.
    fn account(&self, w: &mut World) {
        let power = &mut w.bonds.power;
        power.resize(self.coeffs.len(), 0.0);
        let mine = self.coeffs.iter().enumerate().filter(|(_, k)| k.is_some());
        mine.for_each(|(kind, _)| power[kind] = 0.0);
        for (bond, heat) in self.out.power.iter().enumerate() {
            power[usize::from(self.columns.kind(bond))] += heat;
        }
    }

    /// Takes away the bonds that broke in this step; pair forces act between their ends from the next step on.
    fn break_off(&mut self, w: &mut World, step: i64) {
        let over = self.columns.living().filter(|&k| self.out.load[k] >= 1.0);
        let mut over: Vec<usize> = over.collect();
        if w.is_narrow() {
            // A bond across a border has broken on both sides of it.
            let all = rows::of_all(over.iter().map(|bond| ([*bond as u32], [])));
            over = all.into_iter().map(|([bond], [])| bond as usize).collect();
            over.dedup();
            if let Some(store) = self.law.store() {
                w.whole(X | store.reads());
            }
        }
        let tags = &w.particles.tag;
        let ends =
            |k: &usize| (ascending(self.columns.pair(*k).map(|i| tags[i])), i32::from(self.columns.kind(*k)));
        let mut broken: Vec<([u32; 2], i32)> = over.iter().map(ends).collect();
        broken.sort_unstable();
        if let Some(store) = self.law.store() {
            let mut places: Vec<[usize; 2]> = over.iter().map(|k| self.columns.pair(*k)).collect();
            places.sort_unstable_by_key(|ends| ends.map(|e| w.particles.tag[e]));
            store.keep(w, step, &places);
        }
        let mine = self.made == Some(stand(w));
        w.bonds.lose(&broken);
        // Lists of contacts leave bonded pairs out.
        w.rebuild.freed.extend(broken.iter().map(|(ends, _)| *ends));
        let energies = over.iter().map(|&k| std::mem::take(&mut self.out.force[k].0[3]));
        let energy: f64 = energies.sum();
        if w.bonds.counts_losses {
            w.bonds.released += energy;
        }
        for &k in &over {
            self.columns.lose(k);
            self.out.load[k] = 0.0;
        }
        self.made = mine.then_some(stand(w));
    }
}

impl<const C: usize, L: Driven<C>> Op for Bonded<C, L> {
    fn about(&self) -> About {
        let mut needs = Needs::new().read(X | BONDS | BOX | LISTS | TAG | self.law.reads()).add(F);
        // Lengths at rest, bonds that break, and the work of dashpots, which a ledger books also where there are none.
        let mut writes = TALLY.and(BONDS);
        if self.law.breaks() {
            writes = writes.and(LISTS);
        }
        if self.law.damped() {
            needs = needs.read(V);
        }
        if let Some(store) = self.law.store() {
            needs = needs.read(store.reads()).keep(MEMO);
        }
        if L::Law::TURNS {
            needs = needs.read(QUAT | OMEGA).add(TORQUE);
        }
        About::new(format!("bond {}", L::NAME), Stage::Force, needs.write(writes))
    }

    fn span(&mut self, w: &mut World, t: &Tick) -> Rows {
        if self.deal(w, t).is_some() { Rows::Requested } else { Rows::All }
    }

    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let deal = self.deal(w, t);
        let mut anew = t.setup;
        if self.law.adapts() && self.adapted != w.adaptations() {
            self.adapted = w.adaptations();
            self.law.adapt(w);
            anew = true;
        }
        if anew || (self.made != Some(stand(w)) && !self.follow(w)) {
            if deal.is_some() {
                w.whole(X | QUAT | self.law.reads());
            }
            self.lay_out(w)?;
        }
        // Sums over bonds are made in the order of space, whatever the order before.
        let sums = t.energy || t.atom_energy || t.virial || w.bonds.counts_losses;
        if sums && !self.columns.in_order() {
            self.columns.put_in_order();
            self.arranged += 1;
        }
        if let Some(deal) = deal {
            self.take_part(w, deal);
        }
        let groups = deal.map(|_| &self.part.groups[..]);
        let all = 0..w.n();
        let own = w.share.as_ref().filter(|share| share.narrow).map(|share| &share.own[..]);
        let rows = own.unwrap_or(std::slice::from_ref(&all));
        let periods = periods(w)?;
        let p = &mut w.particles;
        let none: (&[Vec3], &[Quat]) = (&[], &[]);
        let (omega, quat) = if L::Law::TURNS { (&p.omega[..], &p.quat[..]) } else { none };
        let v = if self.law.damped() { &p.v[..] } else { &[] };
        // In the setup of a run LAMMPS lets no bond break: one beyond its limit pulls, with a factor of fading below zero.
        let holds = t.setup && w.settings.lammps();
        let dimension = if w.settings.two_dimensional { 2 } else { 3 };
        let body = Body { x: &p.x, v, omega, quat, periods };
        for (bond, memory) in self.law.prepare(&mut self.columns, &body, dimension) {
            let ends = ascending(self.columns.pair(bond).map(|i| p.tag[i]));
            w.bonds.memory.insert(ends, memory);
        }
        let breaks = self.law.breaks() && !holds && !t.trial;
        let pass = Sweep {
            columns: &self.columns,
            coeffs: &self.coeffs,
            body,
            damped: self.law.damped(),
            // Nothing breaks where a line search tries.
            breaks,
            counts: w.bonds.counts_losses && self.law.damped(),
            groups,
        };
        self.law.law().sweep(&pass, &mut self.out);
        let torque = if L::Law::TURNS { Some(&mut p.torque[..]) } else { None };
        add_up(&self.columns, &self.out, rows, &mut p.f, torque);
        if breaks && w.anywhere(self.out.broken) {
            self.break_off(w, t.step);
        }
        if w.bonds.counts_losses {
            self.account(w);
        }
        self.tally(w, t, &periods);
        Ok(())
    }
}
