//! Bodies that fly apart and come together again: near pairs last longer than the ends of a body say, and none is missed.

use perigrain_peri::families::*;

use super::scene::Scene;

const DX: f64 = 1e-3;
const SIDE: i32 = 12;

/// A block of weak bonds.
fn block(layout: Layout) -> Scene {
    let mut s = Scene::new(DX, 1e-7, 1);
    s.options.layout = layout;
    s.fill(DX, [[0, SIDE - 1], [0, SIDE - 1], [0, SIDE / 2 - 1]], 1, 2200.0, |_| true);
    s.table.set(1, 1, PmbCoeff { c: 1e21, horizon: 2.015 * DX, s00: 0.01, alpha: 0.0 }).unwrap();
    s.setup();
    s
}

/// Where a particle is: the body swells to three times its size and shrinks to half of it, and each particle swings on a way of its own.
fn place(i: usize, x0: [f64; 3], t: f64) -> [f64; 3] {
    let swell = 1.0 + t.sin() * if t.sin() > 0.0 { 2.0 } else { 0.5 };
    let phase = |k: usize| ((i * (7 + 4 * k)) % 101) as f64 * 0.0622;
    std::array::from_fn(|k| swell * x0[k] + DX * ((2.0 * t + phase(k)).sin() - phase(k).sin()))
}

#[test]
fn no_contact_is_missed_while_pairs_last() {
    for layout in [Layout::Auto, Layout::List] {
        let mut s = block(layout);
        let (mut longest, mut pushed) = (0.0f64, 0);
        for step in 1..=1500 {
            for i in 0..s.x.len() {
                s.x[i] = place(i, s.x0[i], 0.005 * f64::from(step));
            }
            let mut anew = s.families.clone().unwrap();
            anew.forget_near();
            let mut f = vec![[0.0; 3]; s.x.len()];
            anew.force(&s.view(), &mut f, true, None);
            s.forces(true);
            let most = f.iter().flatten().fold(0.0f64, |m, f| m.max(f.abs()));
            // The same pushes in the same order.
            assert!(s.f == f, "{layout:?} step {step}");
            let near = &s.families.as_ref().unwrap().near;
            longest = longest.max(near.spent[0] / near.skin);
            pushed += usize::from(most > 0.0);
        }
        assert!(longest > 1.2, "{layout:?}: pairs lasted {longest} skins");
        assert!(pushed > 500, "{layout:?}: forces in {pushed} steps");
        let damage = s.damage();
        assert!(damage.iter().all(|d| *d == 1.0), "all bonds are broken");
    }
}
