//! The list that a pair belongs to.

use super::*;
use crate::{Damping, Friction, Model, Normal, Tangential, normal};
use perigrain_base::math::lanes::place;
use perigrain_base::math::vec3::{length, sub};
use perigrain_world::Compat;

#[test]
fn pairs_with_large_grains_have_lists_of_their_own() {
    // A lattice of overlapping grains, with room for four that are five times as large.
    let large = (0..4).map(|k| [2.0 + 4.0 * f64::from(k), 4.5, 5.0]);
    let site = |k: u32| [k % 16, k / 16 % 10, k / 160].map(|c| 0.95 * f64::from(c));
    let apart = |x: &Vec3| large.clone().all(|l| length(sub(*x, l)) > 2.9);
    let mut x: Vec<Vec3> = (0..16 * 10 * 12).map(site).filter(apart).collect();
    let mut radius = vec![0.5; x.len()];
    x.extend(large.clone());
    radius.resize(x.len(), 2.5);
    let (n, still, spring) = (x.len(), vec![[0.0; 3]; x.len()], Normal::new(&normal::HERTZ, &[1e3, 3.0]));
    let friction = Tangential::new(Friction::Mindlin, Some(300.0), 0.4, 0.2);
    let law = Model::new(spring, Damping::Viscoelastic, friction).law(Compat::Perigrain);
    let grains = Grains {
        x: &x,
        v: &still,
        omega: &still,
        radius: &radius,
        mass: &radius,
        kind: &vec![1; n],
        tag: &(1..=n as u32).collect::<Vec<_>>(),
        period: Periods::default(),
        flow: None,
        body: &[],
        frozen: &[],
        travel: Default::default(),
    };

    let mut fast = Fast::new(Laws::new(1, |_, _| Some(law)).unwrap());
    let frame = Frame { lo: [0.0; 3], period: Periods::default(), reach: 0.2, skin: 0.2 };
    fast.rebuild(&grains, &frame, |_, _| None, None, &|_, _| true);
    fast.weigh(&grains);
    fast.begin(&grains);

    let tiles = fast.tiles();
    assert!(tiles > 4 && fast.large() > 0);
    let limit = small(&radius);
    for (k, list) in fast.lists.iter().enumerate() {
        let real = list.short.i.iter().zip(&list.short.w).filter(|(_, w)| **w >> PLACE_BITS != NOWHERE);
        let any_large = |i: &u32, w: &u32| radius[*i as usize].max(radius[place(*w)]) >= limit;
        assert!(real.clone().all(|(i, w)| any_large(i, w) == (k >= tiles)), "list {k}");
    }
}
