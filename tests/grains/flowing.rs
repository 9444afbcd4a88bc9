//! A flow in which neighbours stay neighbours: lists of grains outlast rebuilds, which shows in no result.

use super::scene::Scene;
use perigrain::par;

/// How fast the flow is: in 400 steps every grain goes once around the box.
const FAST: f64 = 20.0;
const EDGE: f64 = 8.0;

/// 384 grains that jostle each other in a box that repeats along x and y, and all flow along x with this velocity.
fn scene(flow: f64, more: &str) -> Scene {
    Scene::new(&format!(
        "units lj\natom_style sphere\nboundary p p f\nnewton off\ncomm_modify vel yes\n\
         region world block 0 {EDGE} 0 {EDGE} 0 6 units box\ncreate_box 1 world\nlattice sc 1.0\n\
         region all block INF INF INF INF 0.1 5.9\nlattice sc 1.0 origin 0.5 0.5 0.5\ncreate_atoms 1 region all\n\
         variable d atom 0.99+0.02*sin(7*x+3*y+z)\nset group all diameter v_d\nset group all density 1\n\
         pair_style gran/hertz/history 20000 NULL 50 NULL 0.5 1\npair_coeff * *\n\
         variable u atom {flow}+0.4*sin(31*x+17*y+5*z)\nvariable v atom 0.4*sin(11*x+27*y+15*z)\n\
         variable w atom 0.4*sin(23*x+7*y+9*z)\nvelocity all set v_u v_v v_w\n\
         fix 1 all nve/sphere\nneighbor 0.1 bin\nneigh_modify every 1 delay 0 check yes\ntimestep 0.001\n\
         thermo 10000\n{more}\n"
    ))
}

/// Places, velocities and spins, by tag.
fn state(scene: &Scene) -> Vec<[[f64; 3]; 3]> {
    let p = &scene.world().particles;
    let mut by_tag: Vec<usize> = (0..p.tag.len()).collect();
    by_tag.sort_unstable_by_key(|&i| p.tag[i]);
    by_tag.into_iter().map(|i| [p.x[i], p.v[i], p.omega[i]]).collect()
}

#[test]
fn a_flow_is_the_same_scene_at_rest() {
    let [mut rest, mut flow] = [0.0, FAST].map(|u| scene(u, ""));
    for steps in [200, 300] {
        [&mut rest, &mut flow].into_iter().for_each(|s| s.say(&format!("run {steps}")));
        let kept = &flow.world().rebuild.kept;
        assert!(kept.ample && flow.world().rebuild.builds > 15, "{}", flow.world().rebuild.builds);
    }
    let gone = FAST * 0.5;
    let spins = |s: &[[[f64; 3]; 3]]| s.iter().map(|[_, _, w]| w[0].abs()).fold(0.0, f64::max);
    let (rest, flow) = (state(&rest), state(&flow));
    assert!(spins(&rest) > 0.01, "nothing rolls: {}", spins(&rest));
    for ([x, v, w], [x2, v2, w2]) in rest.iter().zip(&flow) {
        let apart = x2[0] - x[0] - gone;
        // Velocities of 20 are rounded to 4e-15; some dozen collisions make a hundred thousand times as much of it.
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        assert!(
            near(apart, EDGE * (apart / EDGE).round()) && near(x2[1], x[1]) && near(x2[2], x[2]),
            "{x:?} {x2:?}"
        );
        assert!(near(v2[0] - FAST, v[0]) && near(v2[1], v[1]) && near(v2[2], v[2]), "{v:?} {v2:?}");
        assert!((0..3).all(|d| near(w[d], w2[d])), "{w:?} {w2:?}");
    }
}

#[test]
fn the_same_bits_in_pieces_with_a_guard_and_for_any_number_of_threads() {
    let _alone = super::super::threads::alone();
    let run = |more: &str, runs: &[i64], threads: usize| {
        par::set_threads(threads);
        let mut scene = scene(FAST, more);
        runs.iter().for_each(|steps| scene.say(&format!("run {steps} post no")));
        assert!(scene.world().rebuild.kept.ample, "lists are to outlast rebuilds");
        format!("{:?}", state(&scene))
    };
    let one = run("", &[437], 1);
    assert!(run("", &[437], 2) == one, "threads");
    assert!(run("", &[1, 23, 100, 13, 300], 1) == one, "runs");
    assert!(run("fix g all dt/guard 50 1e9", &[437], 1) == one, "a guard");
    assert!(run("thermo 1", &[437], 1) == one, "looks");
}
