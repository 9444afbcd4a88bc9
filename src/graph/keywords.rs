//! Thermo keywords: what each is computed from, and its value.

use perigrain_base::comm;
use perigrain_styles::ledger::COUPLED;
use perigrain_world::{Clock, Slot, SlotId, World};

/// What a keyword's value is computed from besides the world itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// The thermo output's temperature compute.
    Temp,
    /// Its pressure compute (scalar and tensor).
    Press,
    /// Its potential-energy compute.
    Pe,
    /// The pair energy of the step.
    Pair,
}

/// Slots of what a keyword needs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sources {
    /// Temperature compute.
    pub temp: Option<SlotId>,
    /// Pressure compute.
    pub press: Option<SlotId>,
    /// Potential-energy compute.
    pub pe: Option<SlotId>,
    /// Energies per particle (`thermo_modify norm`).
    pub norm: bool,
}

/// Name, whether it is a whole number, and what it needs.
type Row = (&'static str, bool, &'static [Need]);

use Need::{Pair, Pe, Press, Temp};

/// Every keyword.
pub const KEYWORDS: &[Row] = &[
    ("step", true, &[]),
    ("elapsed", true, &[]),
    ("elaplong", true, &[]),
    ("dt", false, &[]),
    ("time", false, &[]),
    ("cpu", false, &[]),
    ("tpcpu", false, &[]),
    ("spcpu", false, &[]),
    ("cpuremain", false, &[]),
    ("part", true, &[]),
    ("atoms", true, &[]),
    ("temp", false, &[Temp]),
    ("press", false, &[Press]),
    ("pe", false, &[Pe]),
    ("ke", false, &[Temp]),
    ("etotal", false, &[Pe, Temp]),
    ("evdwl", false, &[Pair]),
    ("ecoul", false, &[]),
    ("epair", false, &[Pair]),
    ("ebond", false, &[Pair]),
    ("eangle", false, &[]),
    ("edihed", false, &[]),
    ("eimp", false, &[]),
    ("emol", false, &[Pair]),
    ("elong", false, &[]),
    ("etail", false, &[]),
    ("enthalpy", false, &[Pe, Temp, Press]),
    ("ecouple", false, &[]),
    ("econserve", false, &[Pe, Temp]),
    ("vol", false, &[]),
    ("density", false, &[]),
    ("lx", false, &[]),
    ("ly", false, &[]),
    ("lz", false, &[]),
    ("xlo", false, &[]),
    ("xhi", false, &[]),
    ("ylo", false, &[]),
    ("yhi", false, &[]),
    ("zlo", false, &[]),
    ("zhi", false, &[]),
    ("xy", false, &[]),
    ("xz", false, &[]),
    ("yz", false, &[]),
    ("cella", false, &[]),
    ("cellb", false, &[]),
    ("cellc", false, &[]),
    ("cellalpha", false, &[]),
    ("cellbeta", false, &[]),
    ("cellgamma", false, &[]),
    ("xlat", false, &[]),
    ("ylat", false, &[]),
    ("zlat", false, &[]),
    ("avecx", false, &[]),
    ("avecy", false, &[]),
    ("avecz", false, &[]),
    ("bvecx", false, &[]),
    ("bvecy", false, &[]),
    ("bvecz", false, &[]),
    ("cvecx", false, &[]),
    ("cvecy", false, &[]),
    ("cvecz", false, &[]),
    ("timeremain", false, &[]),
    ("bonds", true, &[]),
    ("angles", true, &[]),
    ("dihedrals", true, &[]),
    ("impropers", true, &[]),
    ("pxx", false, &[Press]),
    ("pyy", false, &[Press]),
    ("pzz", false, &[Press]),
    ("pxy", false, &[Press]),
    ("pxz", false, &[Press]),
    ("pyz", false, &[Press]),
    ("fmax", false, &[]),
    ("fnorm", false, &[]),
    ("nbuild", true, &[]),
    ("ndanger", true, &[]),
];

/// The row of a keyword.
pub fn find(name: &str) -> Option<&'static Row> {
    KEYWORDS.iter().find(|(n, ..)| *n == name)
}

/// Kinetic energy from a temperature's values. LAMMPS takes it from the temperature itself, and so has none where no
/// degree of freedom is left.
fn kinetic(w: &World, temp: &Slot) -> f64 {
    let still = w.settings.lammps() && temp.inner.first().is_some_and(|dof| *dof <= 0.0);
    if still { 0.0 } else { temp.vector.iter().take(3).sum::<f64>() * 0.5 }
}

/// A keyword's present value; zero for what no scene here has (Coulomb, angles).
pub fn value(name: &str, w: &World, s: &Sources) -> f64 {
    let n = w.n() as f64;
    let per_atom = if s.norm && n > 0.0 { 1.0 / n } else { 1.0 };
    let scalar = |id: Option<SlotId>| id.map_or(0.0, |id| w.slots.get(id).scalar);
    let press = |k: usize| s.press.and_then(|id| w.slots.get(id).vector.get(k).copied()).unwrap_or(0.0);
    let pe = || scalar(s.pe) * per_atom;
    // The tensor of the temperature compute holds Σ m v v in energy units: half its trace is the energy.
    let ke = || s.temp.map_or(0.0, |id| kinetic(w, w.slots.get(id))) * per_atom;
    let taken = || w.memo.playing(*COUPLED).filter_map(|(_, e)| e.first());
    let coupled = || taken().sum::<f64>();
    let edges = |k: usize| w.domain.as_ref().map_or(0.0, |d| d.lengths()[k]);
    let tilt = |k: usize| w.edges().tilt[k];
    let vectors = || w.edges().vectors();
    let angle = |a: usize, b: usize| if w.tilted() { angle(vectors()[a], vectors()[b]) } else { 90.0 };
    let lo = |k: usize| w.domain.as_ref().map_or(0.0, |d| d.lo[k]);
    let hi = |k: usize| w.domain.as_ref().map_or(0.0, |d| d.hi[k]);
    match name {
        "temp" => scalar(s.temp),
        "press" => scalar(s.press),
        "pe" => pe(),
        "ke" => ke(),
        "etotal" => pe() + ke(),
        "ecouple" => coupled() * per_atom,
        "econserve" => pe() + ke() + coupled() * per_atom,
        "evdwl" | "epair" => w.tally.pair * per_atom,
        "ebond" | "emol" => w.tally.bond * per_atom,
        "bonds" => (w.bonds.len() + if w.settings.lammps() { w.bonds.left } else { 0 }) as f64,
        "angles" => w.bonds.angles.list.len() as f64,
        "enthalpy" => {
            pe() + ke() + scalar(s.press) * volume(w) / w.settings.units.constants().nktv2p * per_atom
        }
        "atoms" => n,
        "vol" => volume(w),
        "density" => density(w),
        "lx" | "cella" | "avecx" => edges(0),
        "ly" | "bvecy" => edges(1),
        "lz" | "cvecz" => edges(2),
        "cellb" => perigrain_base::math::vec3::length(vectors()[1]),
        "cellc" => perigrain_base::math::vec3::length(vectors()[2]),
        "timeremain" => w.settings.time_left(),
        "xlat" => w.lattice.spacing[0],
        "ylat" => w.lattice.spacing[1],
        "zlat" => w.lattice.spacing[2],
        "xlo" => lo(0),
        "ylo" => lo(1),
        "zlo" => lo(2),
        "xhi" => hi(0),
        "yhi" => hi(1),
        "zhi" => hi(2),
        "xy" => tilt(0),
        "xz" | "cvecx" => tilt(1),
        "yz" | "cvecy" => tilt(2),
        "bvecx" => tilt(0),
        "cellalpha" => angle(1, 2),
        "cellbeta" => angle(0, 2),
        "cellgamma" => angle(0, 1),
        "pxx" => press(0),
        "pyy" => press(1),
        "pzz" => press(2),
        "pxy" => press(3),
        "pxz" => press(4),
        "pyz" => press(5),
        "fmax" => {
            perigrain_base::par::max(w.n(), |i| w.particles.f[i].iter().fold(0.0, |m: f64, a| m.max(a.abs())))
                .max(0.0)
        }
        "fnorm" => perigrain_base::par::sum(w.n(), |i| w.particles.f[i].iter().map(|a| a * a).sum()).sqrt(),
        "nbuild" => w.rebuild.builds as f64,
        "ndanger" => w.rebuild.dangerous as f64,
        _ => time_value(name, &w.clock),
    }
}

fn time_value(name: &str, c: &Clock) -> f64 {
    let cpu = || comm::broadcast::number(|| c.began.map_or(0.0, |b| b.elapsed().as_secs_f64()));
    let done = (c.step - c.first) as f64;
    match name {
        "step" => c.step as f64,
        "elapsed" => done,
        "elaplong" => (c.step - c.start) as f64,
        "dt" => c.dt,
        "time" => c.time(),
        "cpu" => cpu(),
        "tpcpu" if cpu() > 0.0 => done * c.dt / cpu(),
        "spcpu" if cpu() > 0.0 => done / cpu(),
        "cpuremain" if done > 0.0 => cpu() * (c.last - c.step) as f64 / done,
        _ => 0.0,
    }
}

/// Between two edges, in degrees.
fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    use perigrain_base::math::vec3::{dot, length};
    (dot(a, b) / (length(a) * length(b))).acos().to_degrees()
}

fn volume(w: &World) -> f64 {
    let Some(d) = &*w.domain else { return 0.0 };
    if w.settings.two_dimensional { d.lengths()[0] * d.lengths()[1] } else { d.volume() }
}

fn density(w: &World) -> f64 {
    let mass = perigrain_base::par::sum(w.n(), |i| w.particles.mass[i]);
    w.settings.units.constants().mv2d * mass / volume(w)
}
