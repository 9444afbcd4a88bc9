//! Small scenes of grains, run step by step.

use perigrain::output::log::{Buffer, Log};
use perigrain::session::{Made, Options, Session, Watch};
use perigrain::world::World;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

/// A deck at work.
pub struct Scene {
    session: Session,
    screen: Buffer,
}

/// Reads the scene after each step.
struct Looks<T, L, E> {
    look: L,
    ends: E,
    seen: Arc<Mutex<Vec<T>>>,
    stop: Arc<AtomicBool>,
}

impl<T: Send, L: Fn(&World) -> T + Send, E: FnMut(&T) -> bool + Send> Watch for Looks<T, L, E> {
    fn step(&mut self, _made: &Made) {}

    fn looks(&mut self, _w: &World) -> bool {
        true
    }

    fn scene(&mut self, w: &World) {
        // The run makes one more step after a request to end.
        if self.stop.load(Ordering::Relaxed) {
            return;
        }
        let now = (self.look)(w);
        self.stop.store((self.ends)(&now), Ordering::Relaxed);
        self.seen.lock().unwrap().push(now);
    }
}

impl Scene {
    /// Executes the lines that make the scene.
    pub fn new(deck: &str) -> Self {
        let screen = Buffer::default();
        let options = Options { log: Log::new(Some(Box::new(screen.clone()))), ..Options::default() };
        let mut scene = Self { session: Session::new(options).unwrap(), screen };
        scene.say(deck);
        scene
    }

    /// More lines.
    pub fn say(&mut self, deck: &str) {
        let done = self.session.run_text("in.deck", deck);
        done.unwrap_or_else(|e| panic!("{deck}\n{e}\n{}", self.screen.text()));
    }

    /// Some steps.
    pub fn step(&mut self, steps: usize) {
        self.say(&format!("run {steps} post no"));
    }

    /// The results of `look` after each step of one run, which ends with the first result that `ends` accepts or after `most`
    /// steps. Such a run is fifty times as quick as one for each step; the scene is over then.
    pub fn watched<T: Send + 'static>(
        &mut self,
        most: usize,
        look: impl Fn(&World) -> T + Send + 'static,
        ends: impl FnMut(&T) -> bool + Send + 'static,
    ) -> Vec<T> {
        let seen = Arc::<Mutex<Vec<T>>>::default();
        let watch = Looks { look, ends, seen: seen.clone(), stop: self.session.stop_flag() };
        self.session.set_watch(Box::new(watch));
        self.step(most);
        std::mem::take(&mut *seen.lock().unwrap())
    }

    /// The value of one formula in `$(…)`.
    pub fn number(&mut self, formula: &str) -> f64 {
        self.say(&format!("print \"value {formula}\""));
        let printed = self.screen.text();
        let line = printed.lines().rev().find_map(|l| l.strip_prefix("value "));
        line.and_then(|n| n.trim().parse().ok()).unwrap_or_else(|| panic!("{printed}"))
    }

    /// The particles.
    pub fn world(&self) -> &World {
        &self.session.world
    }
}

/// Deck lines: an empty box from −`half` to `half`, with `types` types of spheres.
pub fn empty(half: f64, types: usize) -> String {
    format!(
        "units si\natom_style sphere\nboundary f f f\nnewton off\ncomm_modify vel yes\n\
         region world block {0} {half} {0} {half} {0} {half} units box\ncreate_box {types} world\n",
        -half
    )
}

/// Deck lines: a sphere of this type at a place, moving and spinning; its number, counted from 1, is `id`.
pub fn sphere(
    [id, kind]: [usize; 2],
    x: [f64; 3],
    [radius, density]: [f64; 2],
    v: [f64; 3],
    omega: [f64; 3],
) -> String {
    format!(
        "create_atoms {kind} single {} {} {} units box\ngroup g{id} id {id}\n\
         set atom {id} diameter {}\nset atom {id} density {density}\n\
         velocity g{id} set {} {} {} units box\nset atom {id} omega {} {} {}\n",
        x[0],
        x[1],
        x[2],
        2.0 * radius,
        v[0],
        v[1],
        v[2],
        omega[0],
        omega[1],
        omega[2]
    )
}

/// Deck lines: one granular model for all, free spheres, a time step.
pub fn law(model: &str, dt: f64) -> String {
    format!(
        "pair_style granular\npair_coeff * * {model}\nfix move all nve/sphere\ntimestep {dt}\n\
         thermo_style custom step\nthermo 1000000\nneigh_modify delay 0 every 1 check yes\n"
    )
}

/// Mass of a sphere.
pub fn mass(radius: f64, density: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3) * density
}

/// Hertz' closed form of a central impact at relative velocity `v`: stiffness k of F = k δ^1.5, effective mass;
/// largest overlap (5 m v²/(4 k))^(2/5), largest force, duration 2.943275 δ/v.
pub fn hertz(k: f64, mass: f64, v: f64) -> [f64; 3] {
    let overlap = (5.0 * mass * v * v / (4.0 * k)).powf(0.4);
    [overlap, k * overlap.powf(1.5), 2.943_275 * overlap / v]
}

/// `a` within a part `tolerance` of `b`.
#[track_caller]
pub fn close(what: &str, a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{what}: {a:.6e} instead of {b:.6e}");
}
