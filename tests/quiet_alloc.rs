//! A quiet step allocates no memory: a run of many steps allocates as much as one of few.
#![allow(clippy::unwrap_used)] // a test fails by panicking

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use perigrain::session::{Options, Session};
use perigrain_output::log::Log;

/// Counts allocations.
struct Counting;

static COUNT: AtomicUsize = AtomicUsize::new(0);

// SAFETY: passes everything on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, p: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(p, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Grains between walls: one leans on the floor, two touch each other, two are alone.
const GRAINS: &str = "
atom_style sphere
boundary f f f
region world block 0 0.1 0 0.1 0 0.1 units box
create_box 1 world
create_atoms 1 single 0.03 0.03 0.00499 units box
create_atoms 1 single 0.05 0.03 0.02 units box
create_atoms 1 single 0.07 0.03 0.03 units box
create_atoms 1 single 0.03 0.06 0.04 units box
create_atoms 1 single 0.0399 0.06 0.04 units box
set group all diameter 0.01
set group all density 2500
pair_style gran/hertz/history 1e7 NULL 50 0 0.3 1
pair_coeff * *
neighbor 0.005 bin
fix 1 all nve/sphere
fix g all gravity 9.81 vector 0 0 -1
fix wx all wall/gran hertz/history 1e7 NULL 50 0 0.3 1 xplane 0 0.1
fix wy all wall/gran hertz/history 1e7 NULL 50 0 0.3 1 yplane 0 0.1
fix wz all wall/gran hertz/history 1e7 NULL 50 0 0.3 1 zplane 0 0.1
timestep 1e-6
thermo 1000000
";

/// The same without walls: everything after the forces goes in one pass.
const FREE: &str = "
atom_style sphere
boundary f f f
region world block 0 0.1 0 0.1 0 0.1 units box
create_box 1 world
create_atoms 1 single 0.03 0.03 0.02 units box
create_atoms 1 single 0.05 0.03 0.02 units box
create_atoms 1 single 0.0399 0.03 0.02 units box
set group all diameter 0.01
set group all density 2500
group one id 1
pair_style gran/hooke/history 1e4 NULL 50 0 0.3 1
pair_coeff * *
fix 1 all nve/sphere
fix g all gravity 9.81 vector 0 0 -1
fix h one freeze
timestep 1e-6
thermo 1000000
";

/// A block of peridynamic particles.
const SOLID: &str = "
atom_style peri
boundary f f f
atom_modify map array
lattice sc 0.0005
region world block 0 0.004 0 0.004 0 0.004 units box
create_box 1 world
create_atoms 1 region world
pair_style peri/pmb
pair_coeff * * 1.6863e22 0.0015001 0.0005 0.25
set group all density 2200
set group all volume 1.25e-10
velocity all ramp vx 0 1 x 0 0.004 units box
fix 1 all nve
timestep 1e-8
thermo 1000000
";

/// Allocations of a run of so many steps.
fn asked(session: &mut Session, steps: usize) -> usize {
    let before = COUNT.load(Ordering::Relaxed);
    session.run_text("run", &format!("run {steps}")).unwrap();
    COUNT.load(Ordering::Relaxed) - before
}

#[cfg_attr(
    debug_assertions,
    ignore = "checks of debug builds allocate memory: cargo test --release --test quiet_alloc"
)]
#[test]
fn a_quiet_step_allocates_no_memory() {
    for (name, deck) in [("grains", GRAINS), ("free", FREE), ("solid", SOLID)] {
        let mut session = Session::new(Options { log: Log::silent(), ..Options::default() }).unwrap();
        session.run_text(name, deck).unwrap();
        // Fewer than a thousand in all: then the watch over the energy looks.
        asked(&mut session, 100);
        let [few, many] = [100, 600].map(|steps| asked(&mut session, steps));
        // The last lines of a run have numbers of other lengths.
        assert!(many < few + 20, "{name}: 500 steps more ask {many} times instead of {few}");
    }
}
