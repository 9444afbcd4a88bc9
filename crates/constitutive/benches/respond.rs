//! CPU time of one call of each law, the least of ten rounds: `cargo bench -p perigrain-constitutive`.

use perigrain_base::math::scatter::uniform;
use perigrain_constitutive::{Elastic, Flow, Hardening, Law, Mat3, Material, Memory, Moment};
use std::hint::black_box;
use std::time::Instant;

/// Sites of a round.
const SITES: usize = 20_000;

/// 1 + size · random, of one site.
fn deformed(site: usize, size: f64) -> Mat3 {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let unit = if i == j { 1.0 } else { 0.0 };
            unit + size * (2.0 * uniform(site as u64, (3 * i + j) as u64) - 1.0)
        })
    })
}

/// Nanoseconds for a call at strains of this size, the least of ten rounds, and how many of the sites flowed.
fn measured(material: &Material, size: f64) -> (f64, f64) {
    let sites: Vec<Mat3> = (0..SITES).map(|site| deformed(site, size)).collect();
    let memory = Memory::default();
    let moment = Moment { dt: 1e-6, temperature: Some(350.0), spacing: 1e-3, advance: true };
    let (mut least, mut flowed) = (f64::INFINITY, 0);
    for _ in 0..10 {
        let start = Instant::now();
        flowed = 0;
        for f in &sites {
            if let Ok(response) = black_box(material.respond(black_box(f), &memory, &moment)) {
                flowed += usize::from(response.memory.strain > 0.0);
            }
        }
        least = least.min(start.elapsed().as_secs_f64());
    }
    (1e9 * least / SITES as f64, flowed as f64 / SITES as f64)
}

fn main() {
    let elastic = Elastic::from_young(117e9, 0.35);
    let linear = Hardening::Linear { yields: 400e6, modulus: 100e6 };
    let laws = [
        ("linear", Law::Linear),
        ("neo-Hooke", Law::NeoHooke),
        ("Hencky", Law::Hencky),
        ("Mises, linear hardening", Law::Plastic(Flow::Mises(linear))),
    ];
    for (name, law) in laws {
        let material = Material { elastic, law };
        for size in [1e-4, 1e-2] {
            let (time, flowed) = measured(&material, size);
            println!("{name:26} strains {size:.0e}: {time:6.1} ns, {:3.0} % flow", 100.0 * flowed);
        }
    }
}
