//! Surfaces of solids that commands have made.

use super::testing::{more, scene};
use perigrain_styles::surface::members;
use perigrain_world::World;
use perigrain_world::surface::{Rule, Surface};

/// A cube of 5³ particles.
fn cube() -> World {
    let mut w = scene(
        "units si\natom_style hybrid sphere peri\nboundary s s s\nlattice sc 0.5\nregion b block 0 2 0 2 0 2 units box",
    );
    more(&mut w, "create_box 1 b\ncreate_atoms 1 box\nset type 1 volume 0.125");
    w
}

fn count(w: &World, rule: Rule, shells: usize) -> usize {
    let s = Surface { parent: perigrain_world::GroupId::ALL, rule, shells, every: None };
    members(w, &s).iter().filter(|m| **m).count()
}

#[test]
fn faces_edges_and_corners_of_a_cube() {
    let w = cube();
    assert_eq!(w.n(), 125);
    // 5³ − 3³; with the next layer all but the innermost one; edges and corners; corners.
    assert_eq!(count(&w, Rule::Neighbours(6), 1), 98);
    assert_eq!(count(&w, Rule::Neighbours(6), 2), 124);
    assert_eq!(count(&w, Rule::Neighbours(5), 1), 44);
    assert_eq!(count(&w, Rule::Neighbours(4), 1), 8);
    // The middle particle alone has the whole family within 2 spacings on all sides.
    assert_eq!(count(&w, Rule::Weight(1.0), 1), 124);
    assert_eq!(count(&w, Rule::Weight(0.0), 1), 0);
}
