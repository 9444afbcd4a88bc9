//! compute pair/local: distance, energy and forces of every interacting pair of particles.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::probe::{Close, HISTORY, Interaction, OWN, Probe, Request, look_closely};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Alternative, Kind, Syntax, Value, Words, alternatives, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MEMO, MOLECULE, OMEGA, RADIUS,
    TAG, TRAVEL, V, VOLUME, X, X0,
};
use perigrain_world::{GroupId, SlotId, World};
use std::f64::consts::PI;

/// The style.
pub struct PairLocal;

impl Style for PairLocal {
    fn name(&self) -> &'static str {
        "pair/local"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Distance, force and more of every pair of particles.",
            text: "Local vector for one value, array for several; a row for each pair with both ends in the group, in the order of \
                   compute property/local: the particle of smaller id is the first.\n\n\
                   Of values of its own `granular` has 12: the tangential force on the first (1–3) and its size (4), \
                   the rolling force (5–7) and its size (8), the twisting torque (9), x_1 − x_2 (10–12); with `normal mdr` a 13th, the mean of the areas of contact of both sides, and with a model of `heat` one more, the heat that flows into the first [energy/time]. `gran/…` have 10: the \
                   tangential force (1–3) and its size (4), the relative velocity along the line of centres (5–7) and across \
                   it (8–10). Forces are those at the present positions and velocities; history is what the contact remembers of \
                   the last step.\n\n\
                   LAMMPS' first particle of a pair is that of its neighbour list, and its granular style shortens the \
                   springs of contacts that slide when this compute (or fabric) looks at them, which changes the run; \
                   perigrain's computes change nothing.\n\n\
                   Of peridynamic styles `peri/pmb` alone can be asked, as in LAMMPS, by itself and without `peri_modify broken compress`, `surface`, `influence` and `horizon own`: \
                   pairs within the horizon, with the force on the first and the energy that its bond, if it lives, and short-range repulsion \
                   have with the volume of the second (force and energy densities in LAMMPS' convention); under `-compat lammps` without bonds across \
                   periodic faces, which LAMMPS forgets here. In a `hybrid` pairs of \
                   peridynamic sub-styles are no rows.",
            example: "compute c all pair/local dist force p4 cutoff radius",
        }
    }
}

/// Value of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Distance,
    Along(usize),
    Energy,
    Force,
    ForceAlong(usize),
    Own(usize),
    /// Component k of a place or velocity of the first or second.
    Place(usize, usize),
    Velocity(usize, usize),
    Id(usize),
    Crosses,
    WholeForce(usize),
    Torque(usize),
    Overlap,
    Area,
    Point(usize),
    History(usize),
}

impl Quantity {
    fn of(self, w: &World, p: &Interaction) -> f64 {
        let particles = &w.particles;
        let end = |which: usize| [p.i, p.j][which] as usize;
        let radius = |which: usize| particles.radius.get(end(which)).copied().unwrap_or(0.0);
        let overlap = || radius(0) + radius(1) - p.distance();
        // Pairs that do not touch, and styles with nothing else to say, have zeros.
        let close = |number: &dyn Fn(&Close) -> f64| p.close.as_deref().map_or(0.0, number);
        match self {
            Quantity::Distance => p.distance(),
            Quantity::Along(k) => p.d[k],
            Quantity::Energy => p.energy,
            // Pairs that do not touch have force 0, not −0.
            Quantity::Force => p.central() + 0.0,
            Quantity::ForceAlong(k) => p.central() * p.d[k] / p.distance() + 0.0,
            Quantity::Own(k) => close(&|c| c.own[k]),
            Quantity::Place(0, k) => particles.x[end(0)][k],
            // Of the image that the first one meets.
            Quantity::Place(_, k) => particles.x[end(0)][k] - p.d[k],
            Quantity::Velocity(which, k) => particles.v[end(which)][k],
            Quantity::Id(which) => f64::from(particles.tag[end(which)]),
            Quantity::Crosses => {
                let [a, b] = [0, 1].map(|which| particles.x[end(which)]);
                let across = |k: usize| (a[k] - b[k] - p.d[k]).abs() > 0.5 * p.distance();
                f64::from(u8::from((0..3).any(across)))
            }
            Quantity::WholeForce(k) => p.force[k],
            Quantity::Torque(k) => close(&|c| c.torque[k]),
            Quantity::Overlap => overlap(),
            Quantity::Area => circle(p.distance(), radius(0), radius(1)),
            Quantity::Point(k) => particles.x[end(0)][k] - p.d[k] * radius(0) / (radius(0) + radius(1)),
            Quantity::History(k) => close(&|c| c.history[k]),
        }
    }
}

/// The area of the circle in which two spheres whose centres are `d` apart meet: π/(4 D²) δ (D + R₁ − R₂)(D − R₁ + R₂)(D + R₁ + R₂).
fn circle(d: f64, a: f64, b: f64) -> f64 {
    let heron = (a + b - d).max(0.0) * (d + a - b) * (d - a + b) * (d + a + b);
    0.25 * PI * heron / (d * d)
}

const QUANTITIES: [(&str, Quantity); 35] = [
    ("dist", Quantity::Distance),
    ("dx", Quantity::Along(0)),
    ("dy", Quantity::Along(1)),
    ("dz", Quantity::Along(2)),
    ("eng", Quantity::Energy),
    ("force", Quantity::Force),
    ("fx", Quantity::ForceAlong(0)),
    ("fy", Quantity::ForceAlong(1)),
    ("fz", Quantity::ForceAlong(2)),
    ("x1", Quantity::Place(0, 0)),
    ("y1", Quantity::Place(0, 1)),
    ("z1", Quantity::Place(0, 2)),
    ("x2", Quantity::Place(1, 0)),
    ("y2", Quantity::Place(1, 1)),
    ("z2", Quantity::Place(1, 2)),
    ("vx1", Quantity::Velocity(0, 0)),
    ("vy1", Quantity::Velocity(0, 1)),
    ("vz1", Quantity::Velocity(0, 2)),
    ("vx2", Quantity::Velocity(1, 0)),
    ("vy2", Quantity::Velocity(1, 1)),
    ("vz2", Quantity::Velocity(1, 2)),
    ("id1", Quantity::Id(0)),
    ("id2", Quantity::Id(1)),
    ("crosses", Quantity::Crosses),
    ("forcex", Quantity::WholeForce(0)),
    ("forcey", Quantity::WholeForce(1)),
    ("forcez", Quantity::WholeForce(2)),
    ("torquex", Quantity::Torque(0)),
    ("torquey", Quantity::Torque(1)),
    ("torquez", Quantity::Torque(2)),
    ("delta", Quantity::Overlap),
    ("area", Quantity::Area),
    ("cx", Quantity::Point(0)),
    ("cy", Quantity::Point(1)),
    ("cz", Quantity::Point(2)),
];

const NAMES: &[Alternative] = &alternatives(&QUANTITIES);

impl Value for Quantity {
    const KIND: Kind = Kind::Or(&Kind::Choice(NAMES), &Kind::Text);
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let word = args.expect(what)?;
        if let Some((_, v)) = QUANTITIES.iter().find(|v| v.0 == word.text) {
            return Ok(*v);
        }
        if let Some(n) = word.text.strip_prefix('h').and_then(|n| n.parse::<usize>().ok())
            && (1..=HISTORY).contains(&n)
        {
            return Ok(Quantity::History(n - 1));
        }
        match word.text.strip_prefix('p').and_then(|n| n.parse::<usize>().ok()) {
            Some(n) if (1..=OWN).contains(&n) => Ok(Quantity::Own(n - 1)),
            Some(n) => {
                let text = format!("no pair style has a value `p{n}`: they end at p{OWN}");
                fail(Code::BAD_VALUE, word.span, text)
            }
            None => {
                let known = QUANTITIES.iter().map(|v| v.0).chain(["p1", "cutoff"]);
                Err(args.unknown(word, &known.collect::<Vec<_>>()))
            }
        }
    }
}

#[derive(Words)]
struct Line {
    /// `dist`: distance; `dx dy dz`: x_1 − x_2; `force`: force along the line of centres, positive where it pushes apart; `fx fy
    /// fz`: that force on the first; `eng`: energy of the pair, 0 for granular styles as in LAMMPS; `p1` …: the pair style's own.
    /// Not in LAMMPS: `x1 y1 z1 x2 y2 z2`, `vx1 vy1 vz1 vx2 vy2 vz2`, `id1 id2`: places (of the second the image that meets the first),
    /// velocities and ids; `crosses`: 1 where they meet across a periodic face; `forcex forcey forcez`, `torquex torquey torquez`: the whole
    /// force and torque on the first; `delta`: overlap; `area`: of the circle in which the spheres meet; `cx cy cz`: the point that divides the
    /// line of centres as the radii; `h1` … `h12`: what the contact remembers, the tangential spring first.
    #[word(name = "pN", what = "a value, as `dist`", least = 1)]
    values: Vec<Quantity>,
    #[word(keyword)]
    cutoff: Cutoff,
}

/// Which pairs there are.
#[derive(Clone, Copy, Default, PartialEq, Words)]
#[word(what = "cutoff")]
pub(super) enum Cutoff {
    /// Pairs within the cutoff of their types, for granular styles the largest radii of the two types together: those that do not
    /// touch have forces of 0.
    #[default]
    Type,
    /// Pairs of spheres closer than the sum of their radii.
    Radius,
}

impl ComputeStyle for PairLocal {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { values, cutoff } = read(args, cx)?;
        let touching = cutoff == Cutoff::Radius;
        if touching {
            super::need_spheres("`cutoff radius`", cx)?;
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, values, touching }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    values: Vec<Quantity>,
    /// `cutoff radius`.
    touching: bool,
}

impl Declared {
    /// Checks that some style provides as many values of its own as are requested.
    fn check(&self, probes: &[Box<dyn Probe>], cx: &dyn SealCx) -> Result<()> {
        let most = probes.iter().map(|p| p.own()).max().unwrap_or(0);
        let asked =
            self.values.iter().filter_map(|v| if let Quantity::Own(k) = v { Some(k + 1) } else { None });
        match asked.max() {
            Some(p) if p > most => {
                let names: Vec<&str> = probes.iter().map(|p| p.name()).collect();
                let text = format!("compute {}: pair style {} ends at p{most}", self.id, names.join(", "));
                fail(Code::BAD_VALUE, cx.span(), text)
            }
            _ => Ok(()),
        }
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { local: self.values.len(), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let mut probes = answering(&self.id, cx)?;
        self.check(&probes, cx)?;
        let me = self.clone();
        let reads = X
            | V
            | OMEGA
            | RADIUS
            | MASS
            | KIND
            | MASK
            | CONTACTS
            | BONDS
            | BOX
            | COLUMNS
            | FACTS
            | FAMILIES
            | TAG
            | LISTS
            | MEMO
            | MOLECULE
            | TRAVEL
            | VOLUME
            | X0;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, reads, move |w, _, out| {
            let pairs = look_closely(&mut probes, w, Request::idle(!me.touching))?;
            out.local_cols = me.values.len();
            out.local.clear();
            for p in pairs.iter().filter(|p| of_group(w, me.group, p) && (!me.touching || touches(w, p))) {
                out.local.extend(me.values.iter().map(|v| v.of(w, p)));
            }
            Ok(())
        }))
    }
}

/// The pair styles that can evaluate single pairs.
///
/// # Errors
/// There is none.
pub(super) fn answering(id: &str, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Probe>>> {
    let probes = cx.singles()?;
    if !probes.is_empty() {
        return Ok(probes);
    }
    let text = format!("compute {id}: no pair style of this scene can compute single pairs");
    Err(Diagnostic::error(Code::INCOMPLETE, cx.span(), text)
        .help("granular pair styles can, and `peri/pmb`: `pair_style granular`, `gran/hooke/history` …")
        .into())
}

/// Whether both ends belong to the group.
pub(super) fn of_group(w: &World, group: GroupId, p: &Interaction) -> bool {
    [p.i, p.j].iter().all(|&i| w.particles.mask[i as usize] & group.bit() != 0)
}

/// Whether two spheres touch; cohesion may also act across a gap.
pub(super) fn touches(w: &World, p: &Interaction) -> bool {
    let radius = |i: u32| w.particles.radius[i as usize];
    let sum = radius(p.i) + radius(p.j);
    p.d.iter().map(|x| x * x).sum::<f64>() < sum * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn words() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        for words in [
            "",
            "cutoff type",
            "dist p0",
            "dist p15",
            "distance",
            "dist cutoff radius",
            "dist cutoff",
            "dist cutoff type 3",
        ] {
            assert!(b.compute(&PairLocal, words).is_err(), "{words}");
        }
        let c = b.compute(&PairLocal, "dist dx fy p12 cutoff type").unwrap();
        assert_eq!(c.shape().local, 4);
        // No pair style.
        assert!(b.evaluate(&*c).is_err());
    }
}
