//! The interaction of single pairs of particles at a moment, for any pair style.

use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{SIX, Vec3, dot, length, scale, sub};
use perigrain_world::World;
use perigrain_world::contacts::Rolls;

/// How many numbers of its own a pair style may give to each pair.
pub const OWN: usize = 14;

/// How many numbers that a contact remembers are shown.
pub const HISTORY: usize = 12;

/// Two particles and what they do to each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Interaction {
    /// The particle of smaller tag.
    pub i: u32,
    /// The other.
    pub j: u32,
    /// x_i − x_j, of the images that meet [length].
    pub d: Vec3,
    /// Force on i [force].
    pub force: Vec3,
    /// Energy of the pair [energy].
    pub energy: f64,
    /// What else a style says of the pair, where it is looked at closely. Apart, because sums over all pairs need none of it.
    pub close: Option<Box<Close>>,
}

/// What a pair style says of one pair beyond its force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Close {
    /// Additional numbers of the style (`p1`, `p2` … of compute pair/local).
    pub own: [f64; OWN],
    /// Torque on i [torque].
    pub torque: Vec3,
    /// The first numbers that a contact remembers.
    pub history: [f64; HISTORY],
}

impl Close {
    /// Adds what another style says of the same pair.
    fn add(&mut self, other: &Close) {
        let add = |to: &mut [f64], from: &[f64]| to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        add(&mut self.own, &other.own);
        add(&mut self.torque, &other.torque);
        add(&mut self.history, &other.history);
    }
}

impl Interaction {
    /// Distance of the two [length].
    pub fn distance(&self) -> f64 {
        length(self.d)
    }

    /// The part of the force along the line of centres, positive where it pushes apart [force].
    pub fn central(&self) -> f64 {
        dot(self.force, self.d) / self.distance()
    }

    /// The part of the force across the line of centres, on i [force].
    pub fn across(&self) -> Vec3 {
        sub(self.force, scale(self.central() / self.distance(), self.d))
    }

    /// d ⊗ F, the pair's virial: xx yy zz xy xz yz [energy].
    pub fn virial(&self) -> [f64; 6] {
        SIX.map(|(a, b)| self.d[a] * self.force[b])
    }
}

/// A request to a probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Every pair that acts, with the forces that the particles felt in the evaluation just made; `setup`: it was that
    /// of a run's setup.
    Felt {
        /// See above.
        setup: bool,
    },
    /// Every pair that acts, with the forces that another evaluation gives. They are the acting forces, except for springs that
    /// LAMMPS shortens wrongly: its pair styles give these numbers for single pairs.
    Acting,
    /// The same, and pairs that do not touch but are within the cutoff of their types.
    Idle,
}

impl Request {
    /// All pairs within the cutoff of their types, or only those that act.
    pub fn idle(idle: bool) -> Self {
        if idle { Request::Idle } else { Request::Acting }
    }
}

/// The springs of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Springs {
    /// The touching pair.
    pub ends: [u32; 2],
    /// Unit vector between the centres.
    pub normal: Vec3,
    /// Stiffness along it and across it [force/length], and against rolling and twisting [torque].
    pub stiffness: [f64; 4],
    /// Damping of the same.
    pub damping: [f64; 4],
    /// How far from each centre they touch [length].
    pub arms: [f64; 2],
}

/// A pair style's answer about single pairs. It reads the world as it is after forces are computed: contact history
/// has moved on already and is only looked at.
pub trait Probe: Send {
    /// The pair style.
    fn name(&self) -> &'static str;

    /// How many numbers of its own each pair has.
    fn own(&self) -> usize;

    /// The largest distance up to which pairs are looked at [length].
    fn cutoff(&self, _w: &World) -> Option<f64> {
        None
    }

    /// The pairs of its neighbour list, made when lists were last rebuilt, in the order of the two tags.
    ///
    /// # Errors
    /// What cannot be listed.
    fn listed(&self, w: &World) -> Result<Vec<[u32; 2]>>;

    /// The requested pairs, in the order of the two tags; `closely`: with [`Interaction::close`], if the style has more to say.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn look(&mut self, w: &World, request: Request, closely: bool) -> Result<Vec<Interaction>>;

    /// Calls `take` with the springs of each contact.
    ///
    /// # Errors
    /// As `look`.
    fn springs(&mut self, _w: &World, _take: &mut dyn FnMut(Springs)) -> Result<()> {
        Ok(())
    }

    /// The elastic force of a new contact between grains of two types at an overlap, its stiffness across the normal, and the
    /// work that the force can give back; `None` where the style does not define them.
    fn pressed(&self, _types: [u16; 2], _overlap: f64, _curvature: f64) -> Option<[f64; 3]> {
        None
    }

    /// Where contacts keep their rolling history.
    fn rolls(&self) -> Vec<Rolls> {
        vec![]
    }

    /// What all contacts hold: energy of overlaps and of tangential springs [energy].
    ///
    /// # Errors
    /// As `look`.
    fn held(&mut self, _w: &World) -> Result<[f64; 2]> {
        Ok([0.0; 2])
    }
}

/// A grain on a wall of surfaces, and what the wall does to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnWall {
    /// The number of the surface in the line of the wall, from 0.
    pub surface: u32,
    /// The number of the triangle in the surface's file, from 0.
    pub triangle: u32,
    /// The grain.
    pub grain: u32,
    /// The point of the wall that is nearest to its centre [length].
    pub foot: Vec3,
    /// Unit vector from there to the centre.
    pub normal: Vec3,
    /// The distance of both [length].
    pub distance: f64,
    /// Velocity of the wall there [length/time].
    pub velocity: Vec3,
    /// Force on the grain [force].
    pub force: Vec3,
    /// Torque on the grain about its centre [torque].
    pub torque: Vec3,
    /// Heat that flows into the grain [energy/time].
    pub heat: f64,
    /// The first numbers that the contact remembers.
    pub history: [f64; HISTORY],
}

/// The contacts of a wall after a step, with forces at the present positions and velocities; contact history has moved on
/// already and is only looked at.
pub trait WallProbe: Send {
    /// All contacts, by surface, triangle and tag; `dt`: the step [time].
    fn look(&mut self, w: &World, dt: f64) -> Vec<OnWall>;
}

/// The interactions of several styles, pair by pair: forces and energies of a pair add up.
///
/// # Errors
/// As [`Probe::look`].
pub fn look_all(probes: &mut [Box<dyn Probe>], w: &World, request: Request) -> Result<Vec<Interaction>> {
    looked(probes, w, request, false)
}

/// [`look_all`] with what each style says of a pair beyond its force, which adds up as well.
///
/// # Errors
/// As [`Probe::look`].
pub fn look_closely(probes: &mut [Box<dyn Probe>], w: &World, request: Request) -> Result<Vec<Interaction>> {
    looked(probes, w, request, true)
}

fn looked(
    probes: &mut [Box<dyn Probe>],
    w: &World,
    request: Request,
    closely: bool,
) -> Result<Vec<Interaction>> {
    let mut all: Vec<Interaction> = vec![];
    for p in probes.iter_mut() {
        all.append(&mut p.look(w, request, closely)?);
    }
    if probes.len() < 2 {
        return Ok(all);
    }
    let tag = |i: u32| w.particles.tag[i as usize];
    all.sort_by_key(|p| (tag(p.i), tag(p.j)));
    all.dedup_by(|later, first| {
        let same = (later.i, later.j) == (first.i, first.j) && later.d == first.d;
        if same {
            (0..3).for_each(|k| first.force[k] += later.force[k]);
            first.energy += later.energy;
            match (&mut first.close, &later.close) {
                (Some(close), Some(more)) => close.add(more),
                (close @ None, more) => close.clone_from(more),
                (Some(_), None) => {}
            }
        }
        same
    });
    Ok(all)
}
