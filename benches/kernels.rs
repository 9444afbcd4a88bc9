//! Peridynamic forces on the scene of `bench/pd_elastic.in` (a glass disc of 102,034 particles): CPU time per
//! half bond and step for both layouts. Run `cargo bench --bench kernels`; `-- 30 1 lattice` for 30 steps on one
//! thread with the lattice layout alone; `-- 75 1 lattice break` with the velocities of `pd_impact.in`'s second
//! stage, under which bonds break from the first steps on (then the mean over all steps is what counts); `-- 30 1 lattice lps`
//! (`hencky`, `flow`) under a state-based law: `peri/lps`, or correspondence with an elastic material or one that flows.

use std::time::Instant;

use perigrain::par;
use perigrain::peri::families::*;
use perigrain::peri::law;
use perigrain_constitutive::{Elastic, Flow, Hardening, Law as Stress, Material};

struct Disc {
    x: Vec<[f64; 3]>,
    x0: Vec<[f64; 3]>,
    v: Vec<[f64; 3]>,
    f: Vec<[f64; 3]>,
    kind: Vec<u16>,
    volume: Vec<f64>,
    bounds: Bounds,
}

const DX: f64 = 5.0e-4;
const DT: f64 = 1.0e-8;
const DENSITY: f64 = 2230.0;

fn disc() -> Disc {
    let mut x = Vec::new();
    for k in -33..=0 {
        for j in -31..=31 {
            for i in -31..=31 {
                let p = [i, j, k].map(|c| f64::from(c) * DX);
                let inside = p[0] * p[0] + p[1] * p[1] <= 0.0155 * 0.0155;
                if inside && (-0.01651..=0.00001).contains(&p[2]) {
                    x.push(p);
                }
            }
        }
    }
    let n = x.len();
    let speed = |p: &[f64; 3]| {
        let r2 = (p[0] * p[0] + p[1] * p[1]) / (0.006 * 0.006);
        [0.0, 0.0, -0.3 * (-r2).exp() * (p[2] / 0.002).exp()]
    };
    Disc {
        v: x.iter().map(speed).collect(),
        f: vec![[0.0; 3]; n],
        kind: vec![1; n],
        volume: vec![1.25e-10; n],
        bounds: Bounds { lo: [-0.018; 3], hi: [0.018; 3], periodic: [false; 3], tilt: [0.0; 3] },
        x0: x.clone(),
        x,
    }
}

/// The law of a case: plain bonds unless it is one of the state-based ones.
fn law_of(case: &str) -> Law {
    let elastic = Elastic { bulk: 35.0e9, shear: 21.0e9 };
    let moduli = vec![Moduli { bulk: elastic.bulk, shear: elastic.shear, ..Moduli::default() }];
    let states = Law { moduli, dt: DT, ..Law::default() };
    // Every particle that moves at all flows.
    let flow = Flow::Mises(Hardening::Linear { yields: 1.0, modulus: 1.0e9 });
    let stress = match case {
        "lps" => return Law { kind: law::LPS, ..states },
        "hencky" => Stress::Hencky,
        "flow" => Stress::Plastic { flow, damage: None },
        _ => return Law::default(),
    };
    Law {
        kind: law::CAUCHY,
        materials: vec![Some(Material { elastic, law: stress })],
        control: 0.2,
        ..states
    }
}

/// Runs the scene; returns the fastest whole step, the fastest force evaluation, the mean step (seconds of process
/// time), and the kinetic energy at the end.
fn run(steps: usize, layout: Layout, case: &str) -> (f64, f64, f64, f64) {
    let breaks = case == "break";
    let delta = 3.0 * DX + 1.0e-8;
    let c = 18.0 * 35.0e9 / (std::f64::consts::PI * delta.powi(4));
    let mut table = PmbTable::new(1);
    if table.set(1, 1, PmbCoeff { c, horizon: delta, s00: 0.0007, alpha: 0.25 }).is_err() {
        return (0.0, 0.0, 0.0, 0.0);
    }
    let mut s = disc();
    if breaks {
        s.v.iter_mut().for_each(|v| v[2] *= -200.0);
    }
    let mut options = FamilyOptions::new(DX);
    options.layout = layout;
    options.skip_rest = std::env::var("NOSKIP").is_err();
    let view =
        PeriView { x: &s.x, x0: &s.x0, kind: &s.kind, volume: &s.volume, bounds: s.bounds, excluded: None };
    let Ok(mut families) = Families::build_of(&view, &table, options, law_of(case)) else {
        return (0.0, 0.0, 0.0, 0.0);
    };
    let mut whole = f64::INFINITY;
    let mut force = f64::INFINITY;
    let start = cpu_time();
    for _ in 0..steps {
        let cpu = cpu_time();
        let half = 0.5 * DT / DENSITY;
        par::each((&mut s.x[..], &mut s.v[..], &mut s.f[..]), |_, (x, v, f)| {
            for ((x, v), f) in x.iter_mut().zip(v).zip(f) {
                for k in 0..3 {
                    v[k] += half * f[k];
                    x[k] += DT * v[k];
                    f[k] = 0.0;
                }
            }
        });
        let before = cpu_time();
        let view = PeriView {
            x: &s.x,
            x0: &s.x0,
            kind: &s.kind,
            volume: &s.volume,
            bounds: s.bounds,
            excluded: None,
        };
        families.force(&view, &mut s.f, true, None);
        force = force.min(cpu_time() - before);
        par::each((&mut s.v[..], &s.f[..]), |_, (v, f)| {
            for (v, f) in v.iter_mut().zip(f) {
                for k in 0..3 {
                    v[k] += half * f[k];
                }
            }
        });
        whole = whole.min(cpu_time() - cpu);
    }
    let kinetic: f64 = s.v.iter().map(|v| 0.5 * DENSITY * v.iter().map(|v| v * v).sum::<f64>()).sum();
    (whole, force, (cpu_time() - start) / steps as f64, kinetic)
}

/// CPU time of this process in seconds, all threads together.
#[cfg(target_os = "linux")]
fn cpu_time() -> f64 {
    unsafe extern "C" {
        fn clock_gettime(clock: i32, time: *mut [i64; 2]) -> i32;
    }
    let mut time = [0; 2];
    // SAFETY: the system's clock 2 (process CPU time) writes two numbers (64-bit Linux).
    unsafe { clock_gettime(2, &raw mut time) };
    time[0] as f64 + 1e-9 * time[1] as f64
}

/// Wall time where CPU time is not at hand.
#[cfg(not(target_os = "linux"))]
fn cpu_time() -> f64 {
    use std::sync::OnceLock;
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|w| w != "--bench").collect();
    let steps = words.first().and_then(|w| w.parse().ok()).unwrap_or(30);
    let threads = words.get(1).and_then(|w| w.parse().ok()).unwrap_or(1);
    par::set_threads(threads);
    for (name, layout) in [("lattice", Layout::Auto), ("list", Layout::List)] {
        if words.get(2).is_some_and(|w| w != name) {
            continue;
        }
        let clock = Instant::now();
        let case = words.get(3).map_or("", String::as_str);
        let (whole, force, mean, kinetic) = run(steps, layout, case);
        let hb = 5_785_568.0;
        println!(
            "{name}: step {:.3} ms ({:.2} ns per half bond), force {:.3} ms ({:.2}), mean step {:.3} ms, kinetic {kinetic:.15e}, wall {:.2} s",
            whole * 1e3,
            whole * 1e9 / hb,
            force * 1e3,
            force * 1e9 / hb,
            mean * 1e3,
            clock.elapsed().as_secs_f64(),
        );
    }
}
