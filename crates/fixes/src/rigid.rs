//! fix rigid, rigid/small: groups of particles that move as rigid bodies.

mod bodies;
mod follow;
mod gravity;
mod infile;
mod ledger;
mod mold;
mod motion;
mod nve;
mod pass;
mod ranks;
mod words;

pub use nve::{RigidNve, RigidNveSmall};

use super::{Facts, Fix, FixStyle, MODIFY, Moves, Virial, options};
use bodies::Split;
use gravity::Weight;
use mold::Mold;
use motion::Crew;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, Word};
use perigrain_plan::{Needs, Op, Stage, Tick, When};
use perigrain_styles::ledger::BODY_ENERGY;
use perigrain_styles::matter::check_masses;
use perigrain_styles::rigid_bodies::{bodies_key, body_column};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Form, Syntax, Words, read_or};
use perigrain_styles::{BuildCx, Doc, Motion, SealCx, Shape, Style};
use perigrain_world::field::{
    self, BOX, F, IMAGE, KIND, LISTS, MASK, MASS, MEMO, MOLECULE, OMEGA, RADIUS, RIGID, SLOTS, TAG, TALLY,
    TORQUE, TRAVEL, TYPE_MASS, V, X,
};
use perigrain_world::share::Halo;
use perigrain_world::{
    CONTACT_MASS, Fields, Grip, GroupId, Key, Numbers, Registration, Under, Vectors, World,
};
use words::{Any, Chosen, Common, Groups, Large, Many, Property, Small, baths};

/// Columns of the array: centre, velocity, force, torque, image counts.
const COLUMNS: usize = 15;

/// The mass of each particle's body.
static MASS_OF_BODY: Registration = Registration::role("rigid", "/contact mass", &CONTACT_MASS);
/// Energy of bodies that is not in their particles.
static ENERGY: Registration = Registration::role("rigid", "/body energy", &BODY_ENERGY);
/// Positions of particles by the axes of their bodies.
static PLACE: Registration = Registration::moved("rigid", "/place", Under::Nothing);
/// Parts of the virial per particle.
static VIRIALS: [Registration; 2] = [
    Registration::moved("rigid", "/virial xx", Under::Anew),
    Registration::moved("rigid", "/virial xy", Under::Anew),
];

/// `fix rigid`.
pub struct Rigid;

/// `fix rigid/small`.
pub struct RigidSmall;

impl Style for Rigid {
    fn name(&self) -> &'static str {
        "rigid"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Large::GRAMMAR), Form::headed(MODIFY, Virial::GRAMMAR)] },
            ),
            summary: "Lets groups of particles move as rigid bodies.",
            text: "Each body needs two particles at least. Mass, centre and moments of inertia are those of the \
                   particles, spheres being solid; overlaps count twice. Forces and torques on a body are the sums of \
                   those on its particles. No other fix may move them, and contacts inside a body are left out with \
                   `neigh_modify exclude`.\n\n\
                   The centre moves by velocity Verlet, the orientation by Richardson's steps of the quaternion at \
                   constant angular momentum (bodies in space whose smallest moment is less than a thousandth of the \
                   largest by the exact rotations of `fix rigid/nve`: Richardson's steps let them tumble, as they do in \
                   LAMMPS); places, velocities, spins and orientations of the particles follow. Bodies are set up from \
                   their particles when a run begins after something has changed.\n\n\
                   Spheres that overlap weigh too much, and the middle of their masses is not that of the body: \
                   `infile` (or, with `rigid/small … mol`, a molecule template) gives the true mass, centre and \
                   inertia. `fix gravity` then acts on such a body by M g at its centre, if all its particles are in \
                   the group of that fix; LAMMPS pulls the particles, so that the body falls at another rate and turns \
                   about its centre. `gravity ID` here with `disable` at the end of that `fix gravity` gives the right \
                   motion in both.\n\n\
                   Computes of particles (`com`, `ke`, `vcm` …, the pressure) keep the particles' masses; `ke/rigid`, \
                   `erotate/rigid`, `rigid/local` and `energy/ledger` know the body's. Temperatures count the freedom \
                   of single particles; LAMMPS takes away what bodies have lost. The forces that hold bodies together \
                   count in pressures, unless `fix_modify ID virial no`.\n\n\
                   Scalar: temperature of the bodies, Σ (m v² + ω·I·ω) of components that are on, over as many degrees \
                   of freedom and Boltzmann's constant (torques by the body's own axes). Array, a row for each body: \
                   centre, velocity, force, torque, image counts (3 columns each).\n\n\
                   In the setup of a run LAMMPS leaves out the forces of fixes that stand below this one, so that its \
                   first half kick lacks them; perigrain does so under `compat lammps` only. `langevin`, thermostats \
                   and barostats are refused.",
            example: "unfix motion\nset group plate diameter 0.0\nfix body plate rigid single torque * off off on",
        }
    }
    fn registrations(&self) -> &'static [&'static Registration] {
        const { &[&MASS_OF_BODY, &ENERGY] }
    }
}

impl Style for RigidSmall {
    fn name(&self) -> &'static str {
        "rigid/small"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Small::GRAMMAR), Form::headed(MODIFY, Virial::GRAMMAR)] },
            ),
            summary: "Lets molecules move as rigid bodies, as many as there are.",
            text: "As `fix rigid`, without its array. Particles that join the group during a run become bodies of their \
                   own, molecule by molecule, with the next rebuild of neighbour lists. In `infile` the number of a \
                   body is its molecule ID.\n\n\
                   LAMMPS takes the mass, centre and inertia of a template for bodies that come during a run only, \
                   forgets them when the next run sets bodies up (unless `reinit no`), takes Ixy for Iyz and the other \
                   way round, and divides Σ m x by the mass that the file gives where it gives no `com`; `compat \
                   lammps` does so too.",
            example: "units si\natom_style sphere\nregion b block 0 0.1 0 0.1 0 0.1\ncreate_box 1 b\nfix m all property/atom mol\n\
                      create_atoms 1 single 0.05 0.05 0.05\ncreate_atoms 1 single 0.055 0.05 0.05\nset group all diameter 0.01 density 2500.0 \
                      mol 1\npair_style zero 0.01\npair_coeff * *\nneigh_modify exclude molecule/intra all\nvelocity all ramp vy 0 1 x 0.05 0.055\n\
                      fix 1 all rigid/small molecule\nthermo_style custom step f_1\nrun 10",
        }
    }
}

impl FixStyle for Rigid {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        large(self.name(), args, cx)
    }
}

impl FixStyle for RigidSmall {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        small(self.name(), args, cx)
    }
}

/// A style for few bodies of any kind.
fn large(style: &'static str, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
    let line: Large = read_or(args, cx, |word| baths(style, word))?;
    let split = match line.bodies {
        Any::Single => Split::Single,
        Any::Molecule => molecules(cx)?,
        Any::Group(Groups(list)) => Split::Groups(list),
        Any::Custom(Property(column)) => Split::Custom(column),
    };
    let switch = |torque: bool| {
        move |(at, x, y, z): (At<Chosen>, bool, bool, bool)| {
            let Chosen(first, last) = at.value;
            Switch { torque, bodies: (first, last), on: [x, y, z], span: at.span }
        }
    };
    let torques = line.torque.into_iter().map(switch(true));
    let switches = line.force.into_iter().map(switch(false)).chain(torques).collect();
    Ok(Box::new(Declared { switches, ..declared(style, true, split, line.common, cx) }))
}

/// A style for many bodies, one per molecule.
fn small(style: &'static str, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
    let line: Small = read_or(args, cx, |word| baths(style, word))?;
    let split = match line.bodies {
        Many::Molecule => molecules(cx)?,
        Many::Custom(Property(column)) => Split::Custom(column),
    };
    Ok(Box::new(Declared { molds: line.mol, ..declared(style, false, split, line.common, cx) }))
}

fn molecules(cx: &BuildCx) -> Result<Split> {
    if cx.world.particles.style.molecules {
        return Ok(Split::Molecule);
    }
    let d = Diagnostic::error(Code::CONFLICT, cx.span, "particles of this atom_style belong to no molecules");
    Err(d.help("`fix ID all property/atom mol` gives them molecule IDs").into())
}

/// Force or torque components that are switched off for some bodies.
#[derive(Clone)]
struct Switch {
    torque: bool,
    bodies: (i64, i64),
    on: [bool; 3],
    span: Span,
}

/// A fix without switches and template.
fn declared(style: &'static str, whole: bool, split: Split, common: Common, cx: &BuildCx) -> Declared {
    let Common { reinit, infile, gravity } = common;
    Declared {
        style,
        whole,
        id: cx.id.to_string(),
        keys: Keys::new(style, cx.id),
        group: cx.group,
        split,
        switches: vec![],
        reinit: reinit && infile.is_none(),
        infile,
        molds: vec![],
        gravity,
        virial: true,
    }
}

/// Keys of the state in the world.
#[derive(Clone, Copy)]
struct Keys {
    bodies: Numbers,
    /// Virial of the first half of a step.
    virial: Numbers,
    /// Per-particle part of it: xx yy zz and xy xz yz.
    virials: [Vectors; 2],
    /// Number of each particle's body.
    body: Numbers,
    /// Mass of each particle's body.
    mass: Numbers,
    /// Positions of particles in the frames of their bodies.
    place: Vectors,
    /// Body energy that is not in the particles: see [`BODY_ENERGY`].
    energy: Numbers,
    /// Orientations of particles in the frames of their bodies, if they have any.
    turn: Grip,
}

impl Keys {
    fn new(style: &str, id: &str) -> Self {
        let bodies = bodies_key(style, id);
        let own = format!("{style}/{id}");
        let (virial, body) = (Key::new(&format!("{own}/virial")), body_column(style, id));
        let (mass, energy, place) = (MASS_OF_BODY.key(&own), ENERGY.key(&own), PLACE.key(&own));
        let turn = Grip::new(&format!("{own}/turn"));
        let virials = VIRIALS.each_ref().map(|part| part.key(&own));
        Self { bodies, virial, virials, body, mass, place, energy, turn }
    }

    fn names(&self) -> [&'static str; 10] {
        let ([xx, xy], [turn, moment]) = (self.virials.map(Key::text), self.turn.names());
        let numbers = [self.bodies, self.virial, self.body, self.mass, self.energy].map(Key::text);
        let [bodies, virial, body, mass, energy] = numbers;
        [bodies, virial, xx, xy, body, mass, self.place.text(), energy, turn, moment]
    }
}

#[derive(Clone)]
struct Declared {
    style: &'static str,
    /// `rigid` and `rigid/nve`: styles with a global array and switchable components.
    whole: bool,
    id: String,
    keys: Keys,
    group: GroupId,
    split: Split,
    switches: Vec<Switch>,
    reinit: bool,
    infile: Option<Word>,
    /// The templates of bodies.
    molds: Vec<Mold>,
    /// The fix gravity that pulls the bodies.
    gravity: Option<Word>,
    virial: bool,
}

impl Declared {
    /// Whether a file gives masses that differ from the sums over particles.
    fn gives(&self) -> bool {
        self.infile.is_some() || self.casts()
    }

    /// Whether a template gives such masses.
    fn casts(&self) -> bool {
        self.molds.iter().any(Mold::gives)
    }

    /// With its templates as they are now.
    fn now(&self, w: &World) -> Self {
        Self { molds: self.molds.iter().map(|mold| mold.now(w)).collect(), ..self.clone() }
    }

    /// Whether orientations are integrated by NO_SQUISH.
    fn exact(&self) -> bool {
        self.style.starts_with("rigid/nve")
    }

    /// Per component, whether forces and torques on body `k` (from 0) count.
    fn allowed(&self, k: usize, flat: bool) -> [[f64; 3]; 2] {
        let mut on = if flat { [[1.0, 1.0, 0.0], [0.0, 0.0, 1.0]] } else { [[1.0; 3]; 2] };
        let body = k as i64 + 1;
        for s in self.switches.iter().filter(|s| (s.bodies.0..=s.bodies.1).contains(&body)) {
            let own = &mut on[usize::from(s.torque)];
            for (a, yes) in own.iter_mut().zip(s.on) {
                *a *= f64::from(u8::from(yes));
            }
        }
        on
    }

    /// Sets the bodies up at the beginning of a run, if that is due.
    fn begin(&self, w: &mut World, span: Span) -> Result<()> {
        let there = w.memo.contains(self.keys.bodies);
        if there && !self.reinit {
            return Ok(());
        }
        self.set_up(w, span)?;
        if let Some(file) = &self.infile {
            infile::apply(self, w, file)?;
        }
        let count = self.load(w).len() as i64;
        match self
            .switches
            .iter()
            .find(|s| s.bodies.0 > count || (s.bodies.1 > count && s.bodies.1 != i64::MAX))
        {
            Some(s) => fail(Code::BAD_VALUE, s.span, format!("there are bodies 1 to {count}")),
            None => Ok(()),
        }
    }
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        let keys = self.keys;
        [keys.bodies, keys.virial, keys.energy].into_iter().for_each(|key| drop(w.memo.remove(key)));
        [keys.body, keys.mass].into_iter().for_each(|key| w.columns.remove(key));
        [keys.place, keys.virials[0], keys.virials[1]].into_iter().for_each(|key| w.columns.remove(key));
        keys.turn.drop(w);
    }

    fn shape(&self) -> Shape {
        let rows = match &self.split {
            Split::Single => 1,
            Split::Groups(list) => list.len(),
            _ => Shape::OPEN,
        };
        let shape = Shape { scalar: true, ..Shape::default() };
        if self.whole { Shape { array: COLUMNS, array_rows: rows, ..shape } } else { shape }
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        self.now(cx.world()).sealed(cx)
    }

    fn stop(&self, w: &mut World, what: Motion, span: Span) -> Result<()> {
        self.now(w).halt(w, what, span)
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        self.virial = options::<Virial>(args, cx)?.virial.unwrap_or(self.virial);
        Ok(())
    }

    fn facts(&self, _: &World) -> Facts {
        Facts {
            moves: Moves::Turns,
            needs_whole_steps: Some(
                "its bodies add up the forces of a step once, and LAMMPS' count those of one level twice and leave others out",
            ),
            adopts: self.molds.iter().map(|mold| mold.name.clone()).collect(),
            ..Facts::default()
        }
    }
}

impl Declared {
    /// The ops of a run.
    fn sealed(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        check_masses(cx.world(), span)?;
        let slot = cx.slot(&format!("f_{}", self.id));
        let name = format!("fix {} {}", self.id, self.style);
        // Orientations, for particles that have them.
        let lie = super::lying(cx.world());
        let (me, mut seen) = (self.clone(), None);
        let bodies = StepOp::new(
            name.clone(),
            Stage::Neighbor,
            Needs::new()
                .read(if self.casts() { TAG } else { Fields::NONE })
                .read(
                    X | V
                        | OMEGA
                        | MASS
                        | LISTS
                        | MASK
                        | KIND
                        | RADIUS
                        | BOX
                        | MOLECULE
                        | IMAGE
                        | TYPE_MASS
                        | lie,
                )
                .keep(MEMO | RIGID | field::COLUMNS)
                .only(&self.keys.names())
                .only(self.split.column().as_slice()),
            move |w, t| {
                if t.setup && !t.unchanged {
                    me.begin(w, span)?;
                }
                let now = Some((w.rebuild.generation, w.n()));
                if seen != now {
                    seen = now;
                    w.whole(X | V | OMEGA | RIGID | lie);
                    me.adopt(w, span)?;
                    me.wrap(w);
                }
                Ok(())
            },
        );
        let weight = Weight::find(self, cx)?;
        let pulled = if weight.is_none() { Fields::NONE } else { MASK | SLOTS };
        let (me, mut crew) = (self.clone(), Crew::of(self));
        let names = self.keys.names();
        let access = || {
            Needs::new()
                .read(pulled)
                .add(TRAVEL | TALLY)
                .read(
                    F | TORQUE
                        | MASS
                        | MEMO
                        | BOX
                        | field::COLUMNS
                        | LISTS
                        | RADIUS
                        | TYPE_MASS
                        | IMAGE
                        | KIND,
                )
                .write(X | V | OMEGA | SLOTS | lie)
                .keep(MEMO | RIGID | field::COLUMNS)
                .only(&names)
        };
        let first = StepOp::new(name.clone(), Stage::InitialIntegrate, access(), move |w, t| {
            if me.shares(w, t) {
                me.take_part(w, &mut crew);
            }
            me.advance(w, t, &mut crew);
            Ok(())
        });
        let spans = |me: Declared| move |w: &mut World, t: &Tick| me.span(w, t);
        let second = |me: Declared| {
            let mut crew = Crew::of(&me);
            crew.weight = weight.clone();
            move |w: &mut World, t: &Tick| {
                // Values that decks can read need all bodies.
                if !t.collective && me.shares(w, t) {
                    me.take_part(w, &mut crew);
                    w.halo(X | F | TORQUE, Halo::Members);
                }
                if t.on {
                    me.begin_next(w, t, slot, &mut crew);
                } else if !t.unchanged {
                    me.finish_step(w, t, slot, &mut crew);
                }
                Ok(())
            }
        };
        let last = StepOp::new(name.clone(), Stage::FinalIntegrate, access(), second(self.clone()));
        let first = first.reporting().spanning(spans(self.clone()));
        let last = last.reporting().beginning_next().with_sums().spanning(spans(self.clone()));
        let mut ops = vec![bodies.requesting_rows().boxed(), first.boxed()];
        if cx.world().settings.lammps() {
            // Its setup sums the forces at its place among the fixes: those of fixes declared later are
            // missing.
            let setup = StepOp::new(name, Stage::PostForce, access(), second(self.clone())).reporting();
            ops.extend([setup.when(When::First).boxed(), last.in_setup(false).boxed()]);
        } else {
            ops.push(last.in_setup(true).boxed());
        }
        Ok(ops)
    }

    /// Takes linear or angular motion from all bodies.
    fn halt(&self, w: &mut World, what: Motion, span: Span) -> Result<()> {
        self.begin(w, span)?;
        self.adopt(w, span)?;
        let mut bodies = self.load(w);
        for body in &mut bodies {
            match what {
                Motion::Linear => body.v = [0.0; 3],
                Motion::Angular => (body.momentum, body.omega) = ([0.0; 3], [0.0; 3]),
            }
        }
        self.store(w, &bodies);
        self.carry(w);
        Ok(())
    }
}
