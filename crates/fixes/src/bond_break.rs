//! fix bond/break: deletes bonds that have become too long.

use super::{Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::rng::Marsaglia;
use perigrain_base::math::vec3::{dot, sub};
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, Tick, When};
use perigrain_styles::bond::BondForce;
use perigrain_styles::matter::publish;
use perigrain_styles::pull::{Stretched, apart, find, periods};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{BondType, Fraction, MarsagliaSeed, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::bonds::ascending;
use perigrain_world::field::{BONDS, BOX, LISTS, MASK, MEMO, SLOTS, TAG, V, X};
use perigrain_world::{GroupId, Key, Numbers, World};

/// The style.
pub struct BondBreak;

impl Style for BondBreak {
    fn name(&self) -> &'static str {
        "bond/break"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Takes bonds of a type away that are longer than a limit.",
            text: "At multiples of N, after particles have moved and before forces act, each particle of the group \
                   looks for the longest of its bonds of the type to others of the group that is longer than R; a bond \
                   that is the longest of both its ends is gone, so that no particle loses more than one at a time. Of \
                   bonds of one length the first counts, by the lower ID.\n\n\
                   Pair forces act between the ends at once. `compute energy/ledger` counts the energy of such bonds \
                   among those that broke. Bond styles `bpm/*` break bonds by themselves; this breaks them all the \
                   same. It makes no difference to bonds that `delete_bonds` has turned off.\n\n\
                   Vector of 2 (intensive): how many it took away when it last looked, and in all; a second run, or one \
                   from a restart file, counts on.",
            example: "units lj\natom_style bond\nregion b block 0 6 0 4 0 4\ncreate_box 1 b bond/types 1 extra/bond/per/atom 2\n\
                      create_atoms 1 single 1 1 1\ncreate_atoms 1 single 2.1 1 1\nmass 1 1.0\n\
                      create_bonds single/bond 1 1 2\nbond_style harmonic\nbond_coeff 1 5.0 1.0\nvelocity all create 1.0 4928\nfix 1 all nve\n\
                      fix cut all bond/break 10 1 1.05 prob 0.5 85784\n\
                      thermo_style custom step bonds f_cut[2]\nrun 100",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Looks at multiples of N [steps].
    #[word(name = "N", what = "the number of steps N", from = 1)]
    every: i64,
    /// The type of the bonds.
    #[word(name = "T")]
    kind: BondType,
    /// The length R beyond which bonds break [length].
    #[word(name = "R", non_negative)]
    limit: f64,
    /// Only where a random number of the stream of this seed is below P: that of the end with the lower ID. The numbers are LAMMPS'
    /// where particles are created in the order of their IDs.
    #[word(keyword, name = "P SEED")]
    prob: Option<(Fraction, MarsagliaSeed)>,
}

impl FixStyle for BondBreak {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        if !cx.world.particles.style.bonded {
            let text = "fix bond/break needs particles with bonds";
            let d = Diagnostic::error(Code::WRONG_ORDER, cx.span, text);
            return Err(d.help("`atom_style bond`, alone or in a hybrid, has them").into());
        }
        let Line { every, kind: BondType(kind), limit, prob } = read(args, cx)?;
        let chance = prob.map(|(p, seed)| (p.0, seed.0));
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, every, kind, limit, chance }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    every: i64,
    /// Bond type.
    kind: u16,
    limit: f64,
    /// Probability and seed.
    chance: Option<(f64, u32)>,
}

/// A bond longer than the limit.
#[derive(Clone, Copy)]
struct Long {
    /// Index in the list of bonds.
    at: usize,
    /// Indices of the ends.
    ends: [usize; 2],
    /// Square of the length.
    square: f64,
}

impl Declared {
    /// Key of the number deleted at the last check and in total, and of the state of the random stream.
    fn key(&self) -> Numbers {
        Key::new(&format!("bond/break/{}", self.id))
    }

    /// The bonds to delete: each is the longest bond of both its ends.
    fn chosen(&self, w: &World, stream: Option<&mut Marsaglia>, span: Span) -> Result<Vec<Long>> {
        let (period, p) = (periods(w)?, &w.particles);
        let member = |i: &usize| p.mask[*i] & self.group.bit() != 0;
        let mut long: Vec<Long> = find(w, |b| b.kind == i32::from(self.kind), span)?
            .into_iter()
            .filter(|(_, found)| found.ends.iter().all(member))
            .map(|(at, found)| {
                let d = apart(w, &period, found.ends);
                Long { at, ends: found.ends, square: dot(d, d) }
            })
            .filter(|bond| bond.square > self.limit * self.limit)
            .collect();
        if long.is_empty() {
            return Ok(vec![]);
        }
        long.sort_by_key(|bond| ascending(bond.ends.map(|i| p.tag[i])));
        // For each particle, the index of its longest bond.
        let mut longest = vec![usize::MAX; w.n()];
        for (k, bond) in long.iter().enumerate() {
            for i in bond.ends {
                if longest[i] == usize::MAX || long[longest[i]].square < bond.square {
                    longest[i] = k;
                }
            }
        }
        let chances = self.chances(w, stream, &longest);
        let passes =
            |i: usize| chances.get(i).is_none_or(|drawn| self.chance.is_none_or(|(p, _)| *drawn < p));
        let both = |(k, bond): (usize, &Long)| bond.ends.iter().all(|i| longest[*i] == k);
        let lower = |[a, b]: [usize; 2]| if p.tag[a] < p.tag[b] { a } else { b };
        let list = long.iter().enumerate().filter(|bond| both(*bond)).map(|(_, bond)| *bond);
        Ok(list.filter(|bond| passes(lower(bond.ends))).collect())
    }

    /// A random number for each particle with a bond that is too long, in the order of IDs; empty without
    /// `prob`.
    fn chances(&self, w: &World, stream: Option<&mut Marsaglia>, longest: &[usize]) -> Vec<f64> {
        let Some(stream) = stream else { return vec![] };
        let mut order: Vec<usize> = (0..w.n()).filter(|i| longest[*i] != usize::MAX).collect();
        order.sort_unstable_by_key(|i| w.particles.tag[*i]);
        let mut drawn = vec![0.0; w.n()];
        order.into_iter().for_each(|i| drawn[i] = stream.uniform());
        drawn
    }

    /// Deletes bonds.
    fn part(&self, w: &mut World, bonds: &[Long], style: Option<&dyn BondForce>) -> Result<()> {
        if w.bonds.counts_losses
            && let Some(style) = style
        {
            w.bonds.released += self.energy(w, bonds, style)?;
        }
        let tags = &w.particles.tag;
        let mut ends: Vec<[u32; 2]> =
            bonds.iter().map(|bond| ascending(bond.ends.map(|i| tags[i]))).collect();
        ends.sort_unstable();
        let broken: Vec<([u32; 2], i32)> = ends.iter().map(|e| (*e, i32::from(self.kind))).collect();
        w.bonds.lose(&broken);
        w.rebuild.freed.extend(ends);
        // The special weights of pairs two or three bonds apart change as well.
        w.rebuild.due = true;
        Ok(())
    }

    /// Energy stored in the bonds.
    fn energy(&self, w: &World, bonds: &[Long], style: &dyn BondForce) -> Result<f64> {
        let (period, v) = (periods(w)?, &w.particles.v);
        let of = |long: &Long| {
            let (bond, ends @ [a, b]) = (w.bonds.list[long.at], long.ends);
            let (d, v) = (apart(w, &period, ends), sub(v[a], v[b]));
            style.single(w, &Stretched { kind: self.kind, bond, ends, d, v, rest: bond.length })
        };
        Ok(bonds.iter().filter_map(of).map(|pull| pull.energy).sum())
    }
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        let mut memory = vec![0.0, 0.0];
        memory.extend(self.chance.iter().flat_map(|(_, seed)| Marsaglia::new(*seed).stand()));
        w.memo.insert(self.key(), memory);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key());
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (span, style, me, key) = (cx.span(), cx.bonds(), self.clone(), self.key());
        let slot = cx.slot(&format!("f_{}", self.id));
        let known = move |w: &World| -> [f64; 2] {
            w.memo.get(key).and_then(|m| m.first_chunk().copied()).unwrap_or_default()
        };
        let counts = known(cx.world()).to_vec();
        cx.world().slots.get_mut(slot).vector = counts;
        let looks = style.as_ref().map_or(X, |s| s.looks_at());
        let access =
            Needs::new().read(X | BOX | TAG | MASK | V | looks).write(BONDS | LISTS | SLOTS).keep(MEMO);
        let act = move |w: &mut World, t: &Tick| {
            let [_, all] = known(w);
            let stand = w.memo.get(key).and_then(|m| m.get(2..)).unwrap_or_default().to_vec();
            let mut stream = me.chance.and_then(|_| Marsaglia::resumed(&stand));
            let bonds = me.chosen(w, stream.as_mut(), span)?;
            if !bonds.is_empty() {
                me.part(w, &bonds, style.as_deref())?;
            }
            let counts = [bonds.len() as f64, all + bonds.len() as f64];
            let rest = stream.iter().flat_map(Marsaglia::stand);
            w.memo.insert(key, counts.into_iter().chain(rest).collect());
            publish(w, slot, t, 0.0, &counts);
            Ok(())
        };
        let op = StepOp::new(format!("fix {} bond/break", self.id), Stage::PostIntegrate, access, act);
        Ok(vec![op.when(When::Every(self.every)).boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { vector: 2, ..Shape::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::{AtomStyle, Bond};

    /// Five in a row with bonds between neighbours; the outer bonds are longer than the inner ones.
    fn row() -> Bench {
        let places: Vec<[f64; 3]> = [-3.0, -1.0, 0.5, 2.0, 4.2].map(|x| [x, 0.0, 0.0]).into();
        let mut b = Bench::new(AtomStyle { bonded: true, ..AtomStyle::default() }, &places);
        b.world.bonds.types = 1;
        for ends in [[2, 1], [2, 3], [3, 4], [5, 4]] {
            b.world.bonds.push(Bond::new(1, ends));
        }
        b.world.bonds.find_special();
        b
    }

    #[test]
    fn each_particle_loses_its_longest_bond_and_no_other() {
        let mut b = row();
        let fix = b.fix(&BondBreak, "2 1 1.4").unwrap();
        fix.declare(&mut b.world).unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        // Lengths 2, 1.5, 1.5, 2.2: the outer bonds go first, then the first of the two equal ones, then the
        // last.
        for (left, counts) in [(2, [2.0, 2.0]), (1, [1.0, 3.0]), (0, [1.0, 4.0]), (0, [0.0, 4.0])] {
            b.world.clock.step += 2;
            b.stage(&mut ops, Stage::PostIntegrate).unwrap();
            assert_eq!((b.world.bonds.len(), &b.slot_of("f_f").vector[..]), (left, &counts[..]));
        }
        assert!(b.world.bonds.special.is_empty() && b.world.rebuild.due);
    }

    #[test]
    fn mistakes_are_named() {
        let b = row();
        for words in
            ["", "0 1 1.4", "1 2 1.4", "1 1 -1", "1 1 1.4 prob 2 7", "1 1 1.4 prob 0.5 0", "1 1 1.4 odds 1"]
        {
            assert!(b.fix(&BondBreak, words).is_err(), "{words}");
        }
        let atoms = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        assert!(atoms.fix(&BondBreak, "1 1 1.4").is_err());
    }
}
