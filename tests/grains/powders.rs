//! Powders that flow and stick (`eepa`) as decks: the branches on pairs, planes, regions and meshes; threads.

use super::scene::{Scene, empty, law, sphere};
use perigrain_base::par;
use perigrain_contact::{Advance, Damping, Geometry, Granular, Model, Motion, Normal, Tangential, normal};
use perigrain_world::{Compat, World};

const R: f64 = 0.005;
const NUMBERS: [f64; 8] = [5.0e6, 0.0, 0.3, 0.6, 2.0e-3, 8.0, 1.5, 1.5];

fn words() -> String {
    let numbers: Vec<String> = NUMBERS.iter().map(f64::to_string).collect();
    format!("eepa {} damping none tangential none", numbers.join(" "))
}

/// Two triangles at z = 0 whose common edge runs through the origin.
fn floor(folder: &std::path::Path) -> String {
    let corners = [[[-1, -1], [1, -1], [1, 1]], [[-1, -1], [1, 1], [-1, 1]]];
    let facet = |t: &[[i32; 2]; 3]| {
        let vertex =
            |c: &[i32; 2]| format!("vertex {} {} 0\n", f64::from(c[0]) * 0.02, f64::from(c[1]) * 0.02);
        let all: String = t.iter().map(vertex).collect();
        format!("facet normal 0 0 1\nouter loop\n{all}endloop\nendfacet\n")
    };
    let file = folder.join("floor.stl");
    let text: String = corners.iter().map(facet).collect();
    std::fs::write(&file, format!("solid floor\n{text}endsolid floor\n")).unwrap();
    file.to_str().unwrap().to_string()
}

#[test]
fn a_scripted_contact_follows_the_law_on_pairs_planes_regions_and_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let model = Model::new(Normal::new(&normal::EEPA, &NUMBERS), Damping::None, Tangential::SMOOTH);
    let law_of = model.law(Compat::Perigrain);
    let words = words();
    let walls = [
        ("pair", String::new(), 0.5 * R),
        ("plane", format!("fix low all wall/gran granular {words} zplane 0.0 NULL\n"), R),
        (
            "region",
            format!(
                "region floor plane 0 0 0 0 0 1 units box\nfix low all wall/gran/region granular {words} region floor\n"
            ),
            R,
        ),
        ("mesh", format!("fix low all wall/mesh granular {words} mesh {}\n", floor(folder.path())), R),
    ];
    for (name, wall, curvature) in walls {
        // Overlaps between 0.1 % and 1.9 % of the radius, there and back two and a half times, over the edge of the mesh.
        let height = 0.99 * R;
        let mut deck =
            empty(4.0 * R, 1) + &sphere([1, 1], [0.0, 0.0, height], [R, 2000.0], [0.0; 3], [0.0; 3]);
        if name == "pair" {
            deck += &sphere([2, 1], [0.0, 0.0, -R], [R, 2000.0], [0.0; 3], [0.0; 3]);
        }
        deck += &law(&words, 1e-5)
            .replace("fix move all nve/sphere", "fix move g1 move wiggle AX 0 AZ 0.004 units box");
        let aside = if name == "mesh" { 0.3 * R } else { 0.0 };
        let deck = deck.replace("AX", &aside.to_string()).replace("AZ", &(-0.009 * R).to_string()) + &wall;
        let mut scene = Scene::new(&deck);
        let mut history = vec![0.0; law_of.memory()];
        let (mut largest, mut pulled) = (0.0_f64, 0.0_f64);
        let heights = |w: &World| {
            let p = &w.particles;
            // Particle 2 does not move, but feels the reaction.
            let other = (p.len() > 1).then(|| (p.x[1][2], p.f[1][2]));
            (p.x[0][2], p.f[0][2], other)
        };
        for (height, got, other) in scene.watched(1000, heights, |_| false) {
            let overlap = if let Some((below, _)) = other { 2.0 * R - (height - below) } else { R - height };
            let exact = force(&law_of, overlap, curvature, &mut history);
            largest = largest.max(exact.abs());
            pulled = pulled.min(exact);
            // Overlaps come from heights a thousand times as large.
            assert!((got - exact).abs() <= 1e-12 * largest, "{name}: {got} instead of {exact}");
            assert!(other.is_none_or(|(_, reaction)| reaction == -got));
        }
        assert!(pulled < -0.002, "{name}: never torn, {pulled}");
    }
}

/// The law's force for an overlap.
fn force(law: &Granular, overlap: f64, curvature: f64, history: &mut [f64]) -> f64 {
    let g = Geometry { normal: [0.0, 0.0, 1.0], overlap, radii: [R; 2], curvature, mass: 1.0 };
    let step = Advance { dt: 1e-5, history: true };
    law.contact(&g, &Motion::default(), &Motion::default(), history, step).force[2]
}

#[test]
fn a_pile_has_the_same_bits_for_any_number_of_threads() {
    let _alone = super::super::threads::alone();
    let words = "eepa 2e4 0.5 0.3 0.6 1e-3 0.05 1.5 1.5 damping coeff_restitution \
                 tangential mindlin NULL 0.7 0.5 rolling sds 2000.0 5.0 0.2 twisting marshall";
    let deck = format!(
        "units lj\natom_style sphere\nboundary p p s\nlattice sc 1.0\nregion world block 0 9 0 9 0 9 units box\n\
         create_box 1 world\nregion fill block 0.3 8.9 0.3 8.9 0.6 6.5 units box\nlattice sc 1.2\ncreate_atoms 1 region fill\n\
         variable d atom 0.93+0.06*sin(5.0*x+2.0*y+9.0*z)\nset group all diameter v_d\nset group all density 1.2\n\
         variable u0 atom 0.9*sin(2.0*y+z)\nvelocity all set v_u0 0.2 -0.5\npair_style granular\npair_coeff * * {words}\n\
         neighbor 0.1 bin\nneigh_modify every 1 delay 0 check yes\nfix 1 all nve/sphere\nfix 2 all gravity 1.0 vector 0.2 0 -1\n\
         fix 3 all wall/gran granular {words} zplane 0.5 NULL\ntimestep 0.001\nrun 300 post no\n"
    );
    let run = |threads: usize| {
        par::set_threads(threads);
        let scene = Scene::new(&deck);
        par::set_threads(1);
        let (w, p) = (scene.world(), &scene.world().particles);
        assert!(w.contacts["granular"].len() > 200, "{}", w.contacts["granular"].len());
        (p.x.clone(), p.omega.clone(), p.f.clone(), format!("{:?} {:?}", w.contacts, w.wall_contacts))
    };
    let one = run(1);
    assert!(one == run(2) && one == run(7));
}
