//! A peridynamic force evaluation allocates nothing once warmed up.

use std::alloc::{GlobalAlloc, Layout as Request, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use perigrain::peri::families::*;

/// Counts allocations.
struct Counting;

static COUNT: AtomicUsize = AtomicUsize::new(0);

// SAFETY: passes everything on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, request: Request) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.alloc(request) }
    }
    unsafe fn dealloc(&self, p: *mut u8, request: Request) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(p, request) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn steps_do_not_allocate() {
    let dx = 1e-3;
    let mut x = Vec::new();
    for k in 0..12 {
        for j in 0..12 {
            for i in 0..12 {
                x.push([i, j, k].map(|c| f64::from(c) * dx));
            }
        }
    }
    let (x0, n) = (x.clone(), x.len());
    let (kind, volume, mut f) = (vec![1; n], vec![dx * dx * dx; n], vec![[0.0; 3]; n]);
    let mut table = PmbTable::new(1);
    table.set(1, 1, PmbCoeff { c: 1e21, horizon: 3.015 * dx, s00: 0.01, alpha: 0.25 }).unwrap();
    let bounds = Bounds { lo: [-1.0; 3], hi: [1.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
    for layout in [Layout::Auto, Layout::List] {
        let options = FamilyOptions { layout, ..FamilyOptions::new(dx) };
        let view = PeriView { x: &x0, x0: &x0, kind: &kind, volume: &volume, bounds, excluded: None };
        let mut families = Families::build(&view, &table, options).unwrap();
        x.clone_from(&x0);
        let mut before = 0;
        for step in 0..8 {
            if step == 3 {
                before = COUNT.load(Ordering::Relaxed);
            }
            for (i, x) in x.iter_mut().enumerate() {
                x[0] += 1e-5 * dx * (i as f64).sin();
            }
            f.fill([0.0; 3]);
            let view = PeriView { x: &x, x0: &x0, kind: &kind, volume: &volume, bounds, excluded: None };
            families.force(&view, &mut f, true, None);
        }
        assert_eq!(COUNT.load(Ordering::Relaxed), before, "{layout:?}");
    }
}
