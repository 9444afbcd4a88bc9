//! What a step takes on many cores and machines: a forecast from times that are measured here.
//!
//! A step's work is shared by cores; ranks exchange what lies at the seams of their parts; of grains the places of all are gathered where
//! neighbours are looked for anew. Nothing is taken to be done meanwhile. Each rank has the rows of all particles, so a machine needs memory for all.

/// Properties of a kind of scene besides its measured time.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// What it is.
    pub name: &'static str,
    /// The deck that measures it.
    pub deck: &'static str,
    /// The variable that makes its scene larger, and a value by which memory is measured in a few steps.
    pub large: [&'static str; 2],
    /// Part of a core's time that is used where a machine has many: what tiles of unequal work, and waiting, leave.
    many: f64,
    /// The same up to [`FEW`] cores.
    few: f64,
    /// Layers of particles along a seam that a rank follows, and bytes for each.
    layers: f64,
    sent: f64,
    /// Bytes that come back for each of those that push.
    back: f64,
    /// Steps from one look for neighbours to the next; 0 where none is needed.
    looks: f64,
}

/// Cores of a machine up to which the better share holds.
const FEW: usize = 16;
/// Particles of a surface more than of a flat one: parts are no cubes.
const ROUGH: f64 = 1.3;
/// Time of filing a particle where neighbours are looked for anew [s], half of whose work is shared by cores.
const FILING: f64 = 12e-9;
/// What a step takes that nothing shortens [s].
const LEAST: f64 = 5e-6;

/// Solids and beds of grains. Bounds of shared work are those of measured tiles (docs/decisions/ranks.md): 13.5 of 16.
pub const KINDS: [Kind; 2] = [
    Kind {
        name: "solid, peri/pmb",
        deck: include_str!("scaling/solid.in"),
        large: ["wide", "0.0599"],
        many: 0.85,
        few: 0.92,
        // Two reaches of places, one of forces.
        layers: 6.0,
        sent: 24.0,
        back: 12.0,
        looks: 0.0,
    },
    Kind {
        name: "bed, hertz/history",
        deck: include_str!("scaling/bed.in"),
        large: ["side", "60"],
        many: 0.75,
        few: 0.82,
        layers: 1.26,
        // Place, velocity, spin; half of them push back with force and torque.
        sent: 72.0,
        back: 24.0,
        looks: 40.0,
    },
];

/// Machines and what connects them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    /// Cores of each.
    pub cores: usize,
    /// Bytes that each sends in a second.
    pub bandwidth: f64,
    /// Time of a short message [s].
    pub latency: f64,
    /// Memory of each [byte].
    pub memory: f64,
}

/// What was measured of a kind on one thread.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// Time of a step for each particle [s].
    pub seconds: f64,
    /// Memory for each particle [byte].
    pub bytes: f64,
}

/// Time of a step on so many machines [s]; none where a machine's memory does not hold all particles.
pub fn step(kind: &Kind, m: Measured, particles: f64, nodes: usize, machine: &Machine) -> Option<f64> {
    if particles * m.bytes > machine.memory {
        return None;
    }
    let cores = machine.cores as f64;
    let used = match machine.cores {
        1 if nodes == 1 => 1.0,
        n if n <= FEW => kind.few,
        _ => kind.many,
    };
    let work = m.seconds * particles / (nodes as f64 * cores * used);
    if nodes == 1 {
        return Some(work + LEAST);
    }
    let messages = machine.latency * 2.0;
    let seam = 6.0 * (particles / nodes as f64).powf(2.0 / 3.0) * kind.layers * ROUGH;
    let exchange = seam * (kind.sent + kind.back) / machine.bandwidth + 2.0 * messages;
    let looking = if kind.looks > 0.0 {
        let agreed = messages * (nodes as f64).log2();
        let gathered = 24.0 * particles / machine.bandwidth + FILING * particles / (0.5 * cores);
        agreed + gathered / kind.looks
    } else {
        0.0
    };
    Some(work + exchange + looking + LEAST)
}

/// The forecast of a kind: particles downwards, machines to the right; milliseconds, and how many times as fast as one core.
pub fn table(kind: &Kind, m: Measured, sizes: &[f64], nodes: &[usize], machine: &Machine) -> String {
    let mut text = format!("{:>10}", "particles");
    nodes.iter().for_each(|n| text += &format!("{n:>18}"));
    text.push('\n');
    for particles in sizes {
        text += &format!("{particles:>10.0e}");
        for n in nodes {
            text += &match step(kind, m, *particles, *n, machine) {
                Some(seconds) => {
                    let times = format!("({:.0})", m.seconds * particles / seconds);
                    format!("{:>9} {times:>8}", digits(1e3 * seconds))
                }
                None => format!("{:>18}", "no memory"),
            };
        }
        text.push('\n');
    }
    text
}

/// Three digits.
fn digits(value: f64) -> String {
    match value {
        v if v < 1.0 => format!("{v:.3}"),
        v if v < 10.0 => format!("{v:.2}"),
        v if v < 100.0 => format!("{v:.1}"),
        v => format!("{v:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODE: Machine = Machine { cores: 64, bandwidth: 20e9, latency: 2e-6, memory: 1e15 };
    const SOLID: Measured = Measured { seconds: 68e-9, bytes: 350.0 };
    const GRAINS: Measured = Measured { seconds: 57e-9, bytes: 580.0 };

    /// Calculated by hand, except for the solid's seams, which are twice as wide as once thought: 10^8 particles on 64 machines
    /// of 64 cores.
    #[test]
    fn work_and_seams_add_up() {
        let solid = step(&KINDS[0], SOLID, 1e8, 64, &NODE).unwrap();
        let work = 68e-9 * 1e8 / (64.0 * 64.0 * 0.85);
        let seam = 6.0 * (1e8f64 / 64.0).powf(2.0 / 3.0) * 6.0 * 1.3 * 36.0 / 20e9;
        assert!((solid - (work + seam + 8e-6 + 5e-6)).abs() < 1e-9, "{solid}");
        let grains = step(&KINDS[1], GRAINS, 1e8, 64, &NODE).unwrap();
        // Gathering and filing of all grains, each fortieth step.
        let filing = (24e8 / 20e9 + 12e-9 * 1e8 / 32.0) / 40.0;
        assert!(grains > 57e-9 * 1e8 / (4096.0 * 0.75) + filing && grains < 8e-3, "{grains}");
    }

    #[test]
    fn one_core_is_what_was_measured_and_memory_ends_it() {
        let one = Machine { cores: 1, ..NODE };
        let step_of = |machine: &Machine, particles| step(&KINDS[0], SOLID, particles, 1, machine);
        assert!((step_of(&one, 1e6).unwrap() - 0.068).abs() < 1e-5);
        let small = Machine { memory: 128e9, ..NODE };
        assert!(step_of(&small, 3e8).is_some() && step_of(&small, 4e8).is_none());
        let text = table(&KINDS[0], SOLID, &[1e6, 1e9], &[1, 1000], &small);
        assert!(text.contains("no memory") && text.lines().count() == 3, "{text}");
    }
}
