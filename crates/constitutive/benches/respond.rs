//! CPU time of one call of each law, the least of ten rounds: `cargo bench -p perigrain-constitutive`.

use perigrain_base::math::scatter::uniform;
use perigrain_constitutive::{
    Elastic, Flow, Hardening, JohnsonCook, Law, Mat3, Material, Memory, Moment, Reference,
};
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

/// Nanoseconds for a call that takes sites from strains of one size to strains of another, the least of ten rounds, and the
/// fraction of sites that flow in it.
fn measured(material: &Material, [from, to]: [f64; 2]) -> (f64, f64) {
    let moment = Moment { dt: 1e-6, temperature: Some(350.0), spacing: 1e-3, advance: true };
    let respond =
        |site: usize, size: f64, memory: &Memory| material.respond(&deformed(site, size), memory, &moment);
    let birth = Memory::default();
    let remembered = |site| respond(site, from, &birth).map_or(birth, |response| response.memory);
    let sites: Vec<_> = (0..SITES).map(|site| (deformed(site, to), remembered(site))).collect();
    let (mut least, mut flowed) = (f64::INFINITY, 0);
    for _ in 0..10 {
        let start = Instant::now();
        flowed = 0;
        for (f, memory) in &sites {
            if let Ok(response) = black_box(material.respond(black_box(f), memory, &moment)) {
                flowed += usize::from(response.memory.strain > memory.strain);
            }
        }
        least = least.min(start.elapsed().as_secs_f64());
    }
    (1e9 * least / SITES as f64, flowed as f64 / SITES as f64)
}

/// Copper of Johnson and Cook (1983), Pa and K.
const COPPER: JohnsonCook = JohnsonCook {
    yields: 90e6,
    modulus: 292e6,
    exponent: 0.31,
    rate: 0.025,
    thermal: 1.09,
    reference: Reference { rate: 1.0, temperature: 298.0, melting: 1356.0 },
};

/// Mises flow without damage.
fn flowing(hardening: Hardening) -> Law {
    Law::Plastic { flow: Flow::Mises(hardening), damage: None }
}

fn main() {
    let elastic = Elastic::from_young(117e9, 0.35);
    let linear = Hardening::Linear { yields: 400e6, modulus: 100e6 };
    let laws = [
        ("linear", Law::Linear),
        ("neo-Hooke", Law::NeoHooke),
        ("Hencky", Law::Hencky),
        ("Mises, linear hardening", flowing(linear)),
        ("Johnson-Cook", flowing(Hardening::JohnsonCook(COPPER))),
    ];
    for (name, law) in laws {
        let material = Material { elastic, law };
        for (what, sizes) in
            [("small strain", [0.0, 1e-4]), ("first flow", [0.0, 1e-2]), ("further flow", [1e-2, 1.01e-2])]
        {
            let (time, flowed) = measured(&material, sizes);
            println!("{name:26} {what:13} {time:6.1} ns, {:3.0} % flow", 100.0 * flowed);
        }
    }
}
