//! fix evaporate: deletes particles at random.

use super::{Fix, FixStyle, RegionId};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, Tick};
use perigrain_styles::matter::{Chosen, publish};
use perigrain_styles::newcomers::Account;
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Seed, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::Fields;
use perigrain_world::field::{MASK, X};
use perigrain_world::{GroupId, Key, Numbers, World};

/// The style.
pub struct Evaporate;

impl Style for Evaporate {
    fn name(&self) -> &'static str {
        "evaporate"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Deletes M particles of a region every N steps, chosen at random.",
            text: "At multiples of N, M particles of the group inside the region at that moment are deleted, or all of \
                   them where there are fewer. Random numbers are LAMMPS'; the same particles go as long as both \
                   programs keep particles in the same order (`atom_modify sort 0 0` there). Ids of the others stay. A \
                   second run continues where the first one ended, also after a restart. Scalar (intensive): how many \
                   are gone so far.",
            example: "fix dry grains evaporate 5 1 ball 4711",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Acts at multiples of N [steps].
    #[word(name = "N", what = "the number of steps N", from = 1)]
    every: i64,
    /// The number of particles M.
    #[word(name = "M", from = 1)]
    count: i64,
    /// Where particles go.
    #[word(name = "region-ID")]
    region: RegionId,
    /// The seed of the random numbers.
    seed: Seed,
    /// Whether whole molecules go: `yes` is refused.
    #[word(keyword, what = "molecule", placed, shown = "no")]
    molecule: Option<At<bool>>,
}

impl FixStyle for Evaporate {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { every, count, region: RegionId(region), seed: Seed(seed), molecule } = read(args, cx)?;
        if let Some(molecule) = molecule.filter(|molecule| molecule.value) {
            let text = match cx.world.particles.style.molecules {
                true => "whole molecules do not go in perigrain, only their particles",
                false => "the particles of this scene belong to no molecules",
            };
            return fail(Code::CONFLICT, molecule.span, text);
        }
        let (id, group, count) = (cx.id.to_string(), cx.group, count as u64);
        Ok(Box::new(Declared { id, group, every, count, region, seed }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    every: i64,
    count: u64,
    region: String,
    seed: u32,
}

impl Declared {
    fn key(&self) -> Numbers {
        Key::new(&format!("evaporate/{}", self.id))
    }

    /// Deletes the particles of this step.
    fn act(&self, w: &mut World, chosen: &Chosen, account: &mut Account) {
        // The choice depends on the order of creation.
        w.fall_back();
        let p = &w.particles;
        let here = chosen.resolve(w);
        let mut list: Vec<usize> = (0..p.len()).filter(|&i| here.has(p.mask[i], p.x[i])).collect();
        let mut gone = vec![false; p.len()];
        for _ in 0..self.count.min(list.len() as u64) {
            let which = (list.len() as f64 * account.stream.uniform()) as usize;
            gone[list.swap_remove(which)] = true;
            account.done += 1;
        }
        if !gone.contains(&true) {
            return;
        }
        // From the end, so that a particle moved into a gap is never one of them.
        let mut order: Vec<usize> = (0..p.len()).collect();
        for k in (0..p.len()).rev().filter(|&k| gone[k]) {
            order.swap_remove(k);
        }
        w.gather(&order);
    }
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        Account::maker(w, self.seed).store(w, self.key());
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key());
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        let chosen = Chosen::new(cx.world(), self.group, Some(&self.region), span)?;
        let slot = cx.slot(&format!("f_{}", self.id));
        let w = cx.world();
        w.slots.get_mut(slot).scalar = Account::load(w, self.key()).map_or(0.0, |a| a.done as f64);
        let (me, key) = (self.clone(), self.key());
        let access = Needs::new().read(X | MASK).write(Fields::ALL);
        let act = move |w: &mut World, t: &Tick| {
            let Some(mut account) = Account::load(w, key).filter(|_| t.step % me.every == 0) else {
                return Ok(());
            };
            w.whole(Fields::ALL);
            me.act(w, &chosen, &mut account);
            account.store(w, key);
            w.rebuild.due = true;
            publish(w, slot, t, account.done as f64, &[]);
            Ok(())
        };
        let op = StepOp::new(format!("fix {} evaporate", self.id), Stage::Exchange, access, act);
        Ok(vec![op.requesting_rows().boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, ..Shape::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;
    use perigrain_world::region::{Region, Shape};

    #[test]
    fn only_inside_and_no_more_than_there_are() {
        let places: Vec<[f64; 3]> = (0..8).map(|k| [f64::from(k), 0.0, 0.0]).collect();
        let mut b = Bench::new(AtomStyle::default(), &places);
        let near = Shape::Sphere { center: [0.0; 3], radius: 4.5 };
        b.world.regions.insert(Key::new("near"), Region::inside(near));
        let fix = b.fix(&Evaporate, "2 3 near 44").unwrap();
        fix.declare(&mut b.world).unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        for (step, left) in [(1, 8), (2, 5), (3, 5), (4, 3), (6, 3)] {
            b.world.clock.step = step;
            b.stage(&mut ops, Stage::Exchange).unwrap();
            assert_eq!(b.world.n(), left, "step {step}");
        }
        assert_eq!(b.slot_of("f_f").scalar, 5.0);
        let mut tags = b.world.particles.tag.clone();
        tags.sort_unstable();
        assert_eq!(tags, [6, 7, 8]);
        for words in [
            "",
            "0 1 near 4",
            "1 0 near 4",
            "1 1 far 4",
            "1 1 near 0",
            "1 1 near 4 molecule yes",
            "1 1 near 4 no",
        ] {
            assert!(b.fix(&Evaporate, words).is_err(), "{words}");
        }
    }
}
