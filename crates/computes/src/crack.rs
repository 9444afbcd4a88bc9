//! compute crack: position of a crack tip, length, speed and direction of the crack, and its number of arms.

use super::{Compute, ComputeStyle, Share};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::vec3::{dot, length, scale, sub};
use perigrain_lang::Args;
use perigrain_peri::families::{Cells, Families, PeriView};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::near::Clusters;
use perigrain_styles::peri_view::view;
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, FAMILIES, KIND, MASK, TAG, VOLUME, X, X0};
use perigrain_world::{GroupId, SlotId, World};

/// The style.
pub struct CrackTip;

/// Damage of a particle beside a crack through its plane of bonds is one half less the share of its own
/// layer: 0.4 for a horizon of three spacings (with or without LAMMPS' weights). The smeared-out zone has
/// half of that, so the default lies between.
const DAMAGE: f64 = 0.35;

/// Cracked particles belong to one arm if they are at most this many spacings apart.
const ARM: f64 = 2.1;

impl Style for CrackTip {
    fn name(&self) -> &'static str {
        "crack"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "A crack that runs in a direction: its tip, length, speed, angle and number of arms.",
            text: "Global vector of 8: 1–3 the tip, 4 the length, 5 the speed, 6 the angle in degrees, 7 the number of arms, 8 the \
                   number of cracked particles; all 0 while nothing is cracked. The tip is the cracked particle that lies farthest in \
                   the direction, at its place before the first run.\n\n\
                   Length is the straight distance to the tip from where the crack \
                   begins, angle that between this line and the direction. Speed is the change of length since the evaluation before, \
                   over the time between; 0 at the first. Arms are the groups of cracked particles no further than 2.1 lattice spacings \
                   from each other, among those in a slab behind the tip. The group chooses what to look at: leave out edges that \
                   shatter.",
            example: "compute tip all crack 0 1 0 from 0 -0.004 0",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The direction in which the crack runs.
    #[word(name = "dx dy dz", what = "a component of the crack's direction")]
    along: At<[f64; 3]>,
    /// The share of its family from which on a particle is cracked (compute damage/atom).
    #[word(keyword, name = "phi", what = "the damage of a cracked particle", default = Share(DAMAGE), shown = "0.35")]
    damage: Share,
    /// Where the crack begins, in units of the box; without it where the tip is at the first evaluation.
    #[word(keyword, name = "x y z", what = "a coordinate of the crack's beginning")]
    from: Option<[f64; 3]>,
    /// The width of the slab behind the tip [distance]: 4 lattice spacings without it.
    #[word(keyword, name = "w", positive)]
    width: Option<f64>,
}

impl ComputeStyle for CrackTip {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        super::need_bonds("crack", cx)?;
        let Line { along: At { value: along, span: at, .. }, damage, from, width } = read(args, cx)?;
        let size = length(along);
        if size == 0.0 {
            return fail(Code::BAD_VALUE, at, "the direction of a crack must not be zero");
        }
        let spacing = cx.world.lattice.spacing[0];
        Ok(Box::new(Declared {
            id: cx.id.to_string(),
            group: cx.group,
            along: scale(1.0 / size, along),
            damage: damage.0,
            from,
            width: width.unwrap_or(4.0 * spacing),
            arm: ARM * spacing,
        }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    /// Unit vector.
    along: [f64; 3],
    damage: f64,
    from: Option<[f64; 3]>,
    width: f64,
    arm: f64,
}

impl Declared {
    /// The cracked particles of the group.
    fn cracked(&self, w: &World, families: &Families) -> Vec<u32> {
        let p = &w.particles;
        let mut damage = vec![0.0; w.n()];
        families.damage_all(w.volumes(), &mut damage);
        let is = |i: &usize| damage[*i] >= self.damage && p.mask[*i] & self.group.bit() != 0;
        (0..w.n()).filter(is).map(|i| i as u32).collect()
    }

    /// The number of separate groups among the cracked particles close behind the tip.
    fn arms(&self, w: &World, at: &[[f64; 3]], view: &PeriView, cracked: &[u32], tip: f64) -> usize {
        let near = |i: &&u32| dot(at[**i as usize], self.along) >= tip - self.width;
        let slab: Vec<u32> = cracked.iter().filter(near).copied().collect();
        let mut clusters = Clusters::new(&w.particles.tag);
        let mut cells = Cells::default();
        cells.fill(at, slab.iter().copied(), &view.bounds, self.arm);
        cells.within(&view.bounds, self.arm, |i, j, _, _| clusters.join(i, j));
        let mut names: Vec<u32> = slab.iter().map(|&i| clusters.name(i as usize) as u32).collect();
        names.sort_unstable();
        names.dedup();
        names.len()
    }

    /// The vector; `kept` is the state between evaluations: time, length, speed, starting point of the crack.
    fn measure(&self, w: &World, kept: &mut Vec<f64>) -> Result<Vec<f64>> {
        let Some(families) = &*w.families else { return Ok(vec![0.0; 8]) };
        let view = view(w)?;
        let at = families.reference.as_deref().unwrap_or(view.x0);
        let cracked = self.cracked(w, families);
        let ahead = |i: u32| dot(at[i as usize], self.along);
        // Among equally far particles, which are in memory order, the lowest id is chosen.
        let tag = &w.particles.tag;
        let farther =
            |a: &u32, b: &u32| ahead(*a).total_cmp(&ahead(*b)).then(tag[*b as usize].cmp(&tag[*a as usize]));
        let Some(&tip) = cracked.iter().max_by(|a, b| farther(a, b)) else { return Ok(vec![0.0; 8]) };
        let place = at[tip as usize];
        let first = kept.len() != KEPT;
        let from = match (self.from, first) {
            (Some(from), _) => from,
            (None, true) => place,
            (None, false) => [kept[3], kept[4], kept[5]],
        };
        let line = sub(place, from);
        let (long, now) = (length(line), w.clock.time());
        let speed = match first {
            true => 0.0,
            false if now > kept[0] => (long - kept[1]) / (now - kept[0]),
            false => kept[2],
        };
        *kept = vec![now, long, speed, from[0], from[1], from[2]];
        let straight = dot(line, self.along);
        let angle = length(sub(line, scale(straight, self.along))).atan2(straight).to_degrees();
        let arms = self.arms(w, at, &view, &cracked, ahead(tip));
        Ok(vec![place[0], place[1], place[2], long, speed, angle, arms as f64, cracked.len() as f64])
    }
}

/// Numbers stored between evaluations.
const KEPT: usize = 6;

impl Compute for Declared {
    fn elements(&self) -> Vec<String> {
        ["tip_x", "tip_y", "tip_z", "length", "speed", "angle", "arms", "cracked"].map(String::from).to_vec()
    }

    fn shape(&self) -> Shape {
        Shape { vector: 8, ..Shape::default() }
    }

    fn op(&self, _cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let me = self.clone();
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            X | FAMILIES | VOLUME | MASK | BOX | TAG | KIND | X0,
            move |w, _, out| {
                out.vector = me.measure(w, &mut out.inner)?;
                Ok(())
            },
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_peri::families::{FamilyOptions, PmbCoeff, PmbTable};
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    /// A plate of 20 by 20 points with spacing 1, bonds across y = 9.5 cut where x < `to`.
    fn cut(to: f64) -> Bench {
        let places: Vec<[f64; 3]> =
            (0..400).map(|i| [f64::from(i % 20) - 9.5, f64::from(i / 20) - 9.5, 0.0]).collect();
        let mut b = Bench::new(AtomStyle { peri: true, ..AtomStyle::default() }, &places);
        b.world.particles.volume = vec![1.0; 400].into();
        b.world.lattice.spacing = [1.0; 3];
        b.world.domain = Some(perigrain_world::Domain::new([-99.0; 3], [99.0; 3], Default::default())).into();
        let mut table = PmbTable::new(1);
        table.set(1, 1, PmbCoeff { c: 1.0, horizon: 3.015, s00: 1.0, alpha: 0.0 }).unwrap();
        let families = Families::build(&view(&b.world).unwrap(), &table, FamilyOptions::new(1.0)).unwrap();
        b.world.families = Some(families).into();
        grow(&mut b, to);
        b
    }

    fn grow(b: &mut Bench, to: f64) {
        let mut families = b.world.families.take().unwrap();
        families.cut(&view(&b.world).unwrap(), |p, q| p[1] * q[1] < 0.0 && 0.5 * (p[0] + q[0]) < to);
        b.world.families = Some(families).into();
    }

    #[test]
    fn a_straight_cut_is_followed() {
        let mut b = cut(-5.0);
        let c = b.compute(&CrackTip, "1 0 0 from -9.5 0 0").unwrap();
        let first = b.evaluate(&*c).unwrap().vector.clone();
        // Particles beside the cut have lost 12 of 28 partners; at its end about half as many.
        assert!((first[0] + 5.5).abs() <= 1.0 && first[1].abs() == 0.5 && first[6] == 1.0, "{first:?}");
        assert_eq!(first[4], 0.0);
        grow(&mut b, 3.0);
        b.world.clock.step += 4;
        b.world.clock.dt = 0.5;
        let before = b.world.clock.time();
        let then = b.evaluate(&*c).unwrap().vector.clone();
        assert!((then[0] - first[0] - 8.0).abs() < 1e-12 && then[7] > first[7]);
        // The straight distances from the same point, divided by the time between.
        assert!((then[4] - (then[3] - first[3]) / before).abs() < 1e-12 && then[5] < 5.0, "{then:?}");
        // A second evaluation at the same time keeps the speed.
        assert_eq!(b.evaluate(&*c).unwrap().vector, then);
    }

    #[test]
    fn arms_are_counted() {
        let mut b = cut(-12.0);
        let mut families = b.world.families.take().unwrap();
        let crosses =
            |p: [f64; 3], q: [f64; 3], y: f64| (p[1] - y) * (q[1] - y) < 0.0 && 0.5 * (p[0] + q[0]) < 2.0;
        families.cut(&view(&b.world).unwrap(), |p, q| crosses(p, q, 6.0) || crosses(p, q, -6.0));
        b.world.families = Some(families).into();
        let c = b.compute(&CrackTip, "1 0 0").unwrap();
        let found = b.evaluate(&*c).unwrap().vector.clone();
        assert_eq!((found[6], found[3], found[5]), (2.0, 0.0, 0.0));
        b.world.particles.mask.iter_mut().enumerate().filter(|(i, _)| *i < 200).for_each(|(_, m)| *m = 0);
        assert_eq!(b.evaluate(&*c).unwrap().vector[6], 1.0);
    }

    #[test]
    fn mistakes_and_nothing() {
        let b = cut(-12.0);
        for words in
            ["", "0 0 0", "1 0 0 damage 2", "1 0 0 damage 0", "1 0 0 from 1 2", "1 0 0 width -1", "x 0 0"]
        {
            assert!(b.compute(&CrackTip, words).is_err(), "{words}");
        }
        let mut b = cut(-12.0);
        let c = b.compute(&CrackTip, "0 1 0").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().vector, [0.0; 8]);
    }
}
