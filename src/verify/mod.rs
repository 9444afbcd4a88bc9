//! Published cases and closed forms that the program carries with it: decks that state the expected results and their sources.

pub mod case;
pub mod report;
pub mod running;

macro_rules! decks {
    ($($name:literal,)*) => {
        &[$(($name, include_str!(concat!("cases/", $name, ".in")))),*]
    };
}

/// The name and text of every case, in the order of the report.
pub const DECKS: &[(&str, &str)] = decks![
    "grains/chung_ooi_1",
    "grains/chung_ooi_2",
    "grains/chung_ooi_3",
    "grains/chung_ooi_4",
    "grains/chung_ooi_5",
    "grains/chung_ooi_6",
    "grains/chung_ooi_7",
    "grains/chung_ooi_8",
    "grains/restitution_cut",
    "grains/restitution_regressions",
    "grains/pull_off",
    "grains/cattaneo_mindlin",
    "grains/sliding_to_rolling",
    "grains/rolling_and_twisting",
    "grains/bouncing",
    "grains/haff_cooling",
    "grains/order_in_time",
    "grains/staggered_friction",
    "grains/ledger_of_contacts",
    "peridynamics/lattice_moduli",
    "peridynamics/lattice_moduli_states",
    "peridynamics/dispersion",
    "peridynamics/wave_speed",
    "peridynamics/stable_step",
    "peridynamics/order_in_time",
    "peridynamics/elastic_wave",
    "peridynamics/bar_wave",
    "peridynamics/tension",
    "peridynamics/beam_frequency",
    "peridynamics/beam_deflection",
    "peridynamics/kirsch",
    "peridynamics/breaking_after_flow",
    "peridynamics/plate_impact",
    "peridynamics/kalthoff_winkler",
    "peridynamics/mode_one",
    "peridynamics/running_crack",
    "peridynamics/energy_plane",
    "peridynamics/tired_row",
    "peridynamics/heat_slab",
    "peridynamics/heat_film",
    "peridynamics/heat_flux",
    "peridynamics/thermal_stress",
    "peridynamics/bimetal",
    "bonded/one_bond",
    "bonded/one_state",
    "bonded/free_pair",
    "bonded/chain_waves",
    "bonded/cantilever",
    "bonded/stiffness",
    "bonded/pressed_pair",
];
