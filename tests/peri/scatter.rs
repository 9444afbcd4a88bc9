//! Scatter of strength and stiffness in whole scenes: Weibull's size effect, the same bits for any number of threads.

use crate::threads::alone;
use perigrain::output::log::{Buffer, Log};
use perigrain::par::set_threads;
use perigrain::session::{Options, Session};
use perigrain::world::World;

/// Executes a deck; the world at its end and its output.
fn run(deck: &str, force_list: bool) -> (World, String) {
    let screen = Buffer::default();
    let log = Log::new(Some(Box::new(screen.clone())));
    let mut session = Session::new(Options { log, force_list, ..Options::default() }).unwrap();
    if let Err(e) = session.run_text("scatter.in", deck) {
        panic!("{e}\n{}", screen.text());
    }
    (session.world, screen.text())
}

/// 400 chains of n particles, far from each other, drawn to a stretch within the second of two steps.
fn chains(n: u32, stretch: f64) -> String {
    let last = f64::from(n) - 0.5;
    format!(
        "units si\natom_style peri\nboundary s s s\nlattice sc 1.0\nregion b block -0.1 {last} -0.1 19.9 -0.1 19.9\n\
         create_box 1 b\ncreate_atoms 1 region b\nvariable y atom 3*y\nvariable z atom 3*z\nset group all y v_y z v_z\n\
         set group all density 1 volume 1\nset group all peri/strength weibull 6 4711\npair_style peri/pmb\n\
         pair_coeff * * 1e-9 1.4 0.01 0\nvariable u atom {stretch}*x\nvelocity all set v_u 0 0\nfix 1 all nve\n\
         timestep 0.5\nrun 3\n"
    )
}

/// The weakest of n particles bears s with the probability exp(−n (Γ(1 + 1/m) s/s00)^m): the stretch that half of the chains bear
/// falls as n^(−1/m) with their length. 400 chains: a standard error of 0.025; three of them.
#[test]
fn chains_are_the_weaker_the_longer_they_are() {
    // Γ(7/6).
    let gamma = 0.927_719_333_629_003_9;
    for n in [2, 8, 32u32] {
        let half = 0.01 / gamma * (2f64.ln() / f64::from(n)).powf(1.0 / 6.0);
        // The last step that is judged is that of the places after three steps.
        let (w, _) = run(&chains(n, half / 1.5), false);
        let families = w.families.as_ref().unwrap();
        let mut whole = std::collections::BTreeMap::new();
        for i in 0..w.n() {
            let chain = [w.particles.x[i][1], w.particles.x[i][2]].map(|a| a.round() as i64);
            let size = usize::from(families.family_size[i]);
            let intact = families.neighbours(i).iter().filter(|b| b.alive).count() == size;
            *whole.entry(chain).or_insert(true) &= intact;
        }
        assert_eq!(whole.len(), 400);
        let share = whole.values().filter(|w| **w).count() as f64 / 400.0;
        assert!((share - 0.5).abs() < 0.075, "{n}: {share}");
    }
}

/// A block that bursts, of unlike bonds.
fn block(set: &str) -> String {
    format!(
        "units si\natom_style peri\nboundary s s s\nlattice sc 0.001\nregion blk block 0 9 0 7 0 7\n\
         create_box 1 blk\ncreate_atoms 1 region blk\nset group all density 2400\nset group all volume 1e-9\n{set}\n\
         variable u atom 4000.0*(x-0.0045)\nvelocity all set v_u 0 0 units box\npair_style peri/pmb\n\
         pair_coeff * * 1.6e21 0.0030001 0.0015 0.25\nfix 1 all nve\ntimestep 5.0e-8\n"
    )
}

const UNLIKE: &str =
    "set group all peri/strength weibull 5 4711 correlated 0.002\nset group all peri/stiffness normal 0.1 9";

fn bits(w: &World) -> Vec<u64> {
    w.particles.x.iter().chain(&*w.particles.v).flatten().map(|a| a.to_bits()).collect()
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let _alone = alone();
    for force_list in [false, true] {
        let all = [1, 2, 7].map(|threads| {
            set_threads(threads);
            let (w, _) = run(&format!("{}run 60", block(UNLIKE)), force_list);
            let families = w.families.as_ref().unwrap();
            assert!(families.live_bonds() < families.bonds() - 200, "some break");
            bits(&w)
        });
        assert!(all[0] == all[1] && all[0] == all[2]);
    }
    set_threads(1);
}

#[test]
fn factors_of_one_change_no_bit() {
    let even = "set group all peri/strength 1 peri/stiffness 1";
    let [plain, ones] = ["", even].map(|set| run(&format!("{}run 60", block(set)), false).0);
    assert!(bits(&plain) == bits(&ones));
}

/// Runs a deck that must be refused; the message.
fn refused(deck: &str) -> String {
    let mut session = Session::new(Options::default()).unwrap();
    session.run_text("scatter.in", deck).map(drop).unwrap_err().to_string()
}

#[test]
fn what_factors_do_not_concern_is_refused() {
    let strong = "set group all peri/strength 1.5";
    let printed = refused(&format!("compat lammps/2025\n{}run 0", block(strong)));
    assert!(printed.contains("peri/strength") && printed.contains("one critical stretch"), "{printed}");
    run(&format!("compat lammps\n{}run 0", block(strong)), false);
    let late = format!("{}run 0\nset group all peri/stiffness 1.5\nrun 0", block(""));
    assert!(refused(&late).contains("comes too late"));
    let solid = block("set group all peri/stiffness 1.5")
        .replace("peri/pmb", "peri/lps")
        .replace("1.6e21 0.0030001", "1e10 6e9 0.0030001");
    assert!(refused(&format!("{solid}run 0")).contains("peri/stiffness"));
}

#[test]
fn the_log_has_the_scatter_of_factors() {
    let (_, printed) = run(&format!("{}run 0", block(UNLIKE)), false);
    assert!(printed.contains("the critical stretch of particles scatters from"), "{printed}");
    assert!(printed.contains("the micro-modulus of particles scatters from"), "{printed}");
}
