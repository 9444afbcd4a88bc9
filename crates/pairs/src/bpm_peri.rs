//! `pair_style bpm/peri`: short-range repulsion of peridynamic particles that no bond joins.

use super::shared::{built_at, near, push};
use super::{ByPart, Deck, Facts, Pair, PairStyle, Scales, TypePairs};
use crate::bond::bpm_peri::cubic;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::vec3::dot;
use perigrain_lang::Args;
use perigrain_neigh::list::{Pair as Near, Reach, Wanted, difference};
use perigrain_plan::{About, Needs, Op, Stage, Tick};
use perigrain_styles::near::room_for_pairs;
use perigrain_styles::words::{Form, Grammar, Syntax, Words, inner};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::columns::VOLUME_PROPERTY;
use perigrain_world::field::{BONDS, BOX, COLUMNS, F, KIND, LISTS, MASK, MOLECULE, RADIUS, TAG, TALLY, X};
use perigrain_world::{Allowed, Constant, World};
use std::collections::BTreeMap;

/// Contact begins at this many lattice spacings.
const CONTACT: f64 = 1.35;

/// The style.
pub struct BpmPeriStyle;

impl Style for BpmPeriStyle {
    fn name(&self) -> &'static str {
        "bpm/peri"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Grammar::NONE), Form::headed("pair_coeff I J", Own::GRAMMAR)] },
            ),
            summary: "Short-range repulsion of particles whose peridynamic bond is broken or never was.",
            text: "F = 15 k V̄ (d − r)/δ pushes particles apart while r < d = 1.35 lattice spacings (`lattice`), V̄ being the mean of \
                   both volumes `d_vfrac`, δ the horizon, and the energy ½ F (d − r). With `bond_style bpm/peri force newton` it is \
                   15 k V_i V_j (d − r)/δ. Joined particles are left out: `special_bonds lj 0 1 1 coul 1 1 1`. Every pair of types \
                   needs coefficients of its own. Whose bond breaks at less than 1.35 spacings pushes at once: the energy \
                   of the contact comes with the break, as the law has it. As LAMMPS' development version 2Sep2026 states it.",
            example: "units si\natom_style bond\nlattice sc 5.0e-4\nregion b block -0.004 0.004 -0.002 0.002 -0.002 0.002 units box\n\
                      create_box 1 b bond/types 1 extra/bond/per/atom 2\ncreate_atoms 1 single 0.0 0.0 0.0 units box\n\
                      create_atoms 1 single 6.0e-4 0.0 0.0 units box\nfix vol all property/atom d_vfrac ghost yes\n\
                      set group all d_vfrac 1.25e-10\nmass * 2200.0\nspecial_bonds lj 0.0 1.0 1.0 coul 1.0 1.0 1.0\n\
                      neighbor 2.0e-4 bin\npair_style bpm/peri\npair_coeff * * 1.6863e22 0.0015001\nbond_style bpm/peri\n\
                      bond_coeff 1 pmb 1.6863e22 0.0015001 0.0005 0.25\nfix 1 all nve\ntimestep 1.0e-8\nrun 10",
        }
    }
}

impl PairStyle for BpmPeriStyle {
    fn build(&self, _args: &mut Args, _cx: &BuildCx) -> Result<Box<dyn Pair>> {
        Ok(Box::<Contact>::default())
    }
}

/// The words of `pair_coeff`.
#[derive(Words)]
struct Own {
    /// The contact stiffness k, usually the micro-modulus 18K/(πδ⁴) [energy/length⁷].
    #[word(non_negative)]
    k: f64,
    /// The horizon δ [length].
    #[word(what = "the horizon", positive)]
    horizon: f64,
}

/// Stiffness and horizon by pair of types.
#[derive(Clone, Default)]
struct Contact {
    table: BTreeMap<(u16, u16), [f64; 2]>,
}

impl Pair for Contact {
    fn facts(&self) -> Facts {
        Facts { name: "bpm/peri", ..Facts::default() }
    }

    fn coeff(&mut self, pairs: &TypePairs, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let Own { k, horizon } = inner(args, cx)?;
        self.table.extend(pairs.iter().map(|p| (*p, [k, horizon])));
        Ok(())
    }

    fn covers(&self, i: u16, j: u16) -> bool {
        self.table.contains_key(&(i.min(j), i.max(j)))
    }

    fn restrict(&mut self, pairs: &TypePairs) {
        self.table.retain(|p, _| pairs.contains(p));
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<ByPart<dyn Op>> {
        let span = cx.span();
        cubic(cx.world(), "pair_style bpm/peri", span)?;
        if cx.world().columns.property(*VOLUME_PROPERTY).is_none() {
            let text = "pair_style bpm/peri needs the volumes of particles, the property d_vfrac";
            return Err(Diagnostic::error(Code::INCOMPLETE, span, text)
                .help("put `fix vol all property/atom d_vfrac ghost yes` and `set group all d_vfrac …` before the run")
                .into());
        }
        let op = Repulsion { law: self.clone(), span, held: None, joined: None, near: vec![], list: vec![] };
        Ok(vec![(0, Box::new(op))])
    }

    fn scales(&self, _w: &World, _deck: Deck) -> Scales {
        Scales { cutoff: self.table.values().map(|c| c[1]).reduce(f64::max), ..Scales::default() }
    }
}

static NAME: Constant<f64> = Constant::new("bpm/peri");

/// The op.
struct Repulsion {
    law: Contact,
    span: Span,
    /// Rebuild at which `near` was made.
    held: Option<u64>,
    /// Change of bonds at which `list` was made.
    joined: Option<u64>,
    /// All that may come into contact, joined or not.
    near: Vec<Near>,
    /// Those that no bond joins.
    list: Vec<Near>,
}

impl Repulsion {
    /// Looks for pairs after a rebuild, and leaves out bonded pairs whenever bonds have changed.
    fn update(&mut self, w: &World, t: &Tick, range: f64) -> Result<()> {
        if t.setup || self.held != Some(w.rebuild.generation) {
            let mut wanted = Wanted::new(w.types);
            self.law.table.keys().for_each(|(a, b)| wanted.set(*a, *b, Reach::Fixed(range)));
            room_for_pairs(w, &wanted, w.settings.neighbor.skin)?;
            self.near = near(w, built_at(w), &wanted, w.settings.neighbor.skin, &Allowed::excluded(w));
            (self.held, self.joined) = (Some(w.rebuild.generation), None);
        }
        if self.joined != Some(w.bonds.changes) {
            let (tag, exempt) = (&w.particles.tag, w.bonds.weights.lj[0] == 0.0);
            let joined = |q: &Near| exempt && w.bonds.joined(tag[q.i as usize], tag[q.j as usize]);
            self.list = self.near.iter().filter(|q| !joined(q)).copied().collect();
            self.joined = Some(w.bonds.changes);
        }
        Ok(())
    }
}

impl Op for Repulsion {
    fn about(&self) -> About {
        About::new(
            "pair bpm/peri",
            Stage::Force,
            Needs::new()
                .read(X | KIND | BONDS | BOX | TAG | LISTS | RADIUS | MASK | MOLECULE)
                .add(F)
                .write(TALLY)
                .keep(COLUMNS)
                .only(&[VOLUME_PROPERTY.text()]),
        )
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let range = CONTACT * w.lattice.spacing[0];
        self.update(w, t, range)?;
        let n = w.n();
        let Some(key) = w.columns.property(*VOLUME_PROPERTY) else {
            return fail(Code::LOST, self.span, "the property d_vfrac is gone");
        };
        let volumes = std::mem::take(w.columns.scalar(key, n));
        let (period, newton) = (w.periods(), w.bonds.newton);
        let mut energy = 0.0;
        for q in &self.list {
            let p = &w.particles;
            let (i, j) = (q.i as usize, q.j as usize);
            let kinds = (p.kind[i].min(p.kind[j]), p.kind[i].max(p.kind[j]));
            let Some([k, horizon]) = self.law.table.get(&kinds).copied() else { continue };
            let d = difference(&p.x, &period, q);
            let square = dot(d, d);
            if square >= range * range || square == 0.0 {
                continue;
            }
            let (a, b, r) = (volumes[i], volumes[j], square.sqrt());
            let volume = if newton { a * b } else { 0.5 * (a + b) };
            let size = 15.0 * k * volume * (range - r) / horizon;
            let f = d.map(|d| d * size / r);
            let own = 0.5 * size * (range - r);
            energy += own;
            push(w, t, [i, j], d, f, own);
        }
        if t.energy {
            w.tally.add_pair(*NAME, energy);
        }
        *w.columns.scalar(key, n) = volumes;
        Ok(())
    }
}
