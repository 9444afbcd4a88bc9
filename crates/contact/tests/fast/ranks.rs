//! Lists of several ranks compared with those of one process.

use super::*;
use perigrain_contact::fast::{Dealt, Own};
use perigrain_neigh::tiles::{Tiles, edges};
use std::ops::Range;

/// The system in tile order, and the rows of three ranks, whose shares change.
fn lined_up(s: &Scene, law: Table, turn: usize) -> (Scene, Vec<Range<usize>>) {
    let largest = s.radius.iter().copied().fold(0.0, f64::max);
    let span = Laws::new(2, |a, b| Some(law(a, b))).unwrap().span(largest);
    let mut tiles = Tiles::default();
    tiles.sort(&s.x, &s.tag, edges(&s.radius, SKIN + span), &[0.0; 3], &s.period);
    let order = || tiles.order.iter().map(|i| *i as usize);
    let of = |column: &Vec<Vec3>| order().map(|i| column[i]).collect();
    let numbers = |column: &Vec<f64>| order().map(|i| column[i]).collect();
    // Not always at a tile boundary.
    let end = |k: usize| tiles.members(k * tiles.count() / 6).start + 3 * (turn % 3);
    let (first, second) = (end(1 + turn % 2), end(3 + turn % 3));
    let scene = Scene {
        x: of(&s.x),
        v: of(&s.v),
        omega: of(&s.omega),
        radius: numbers(&s.radius),
        mass: numbers(&s.mass),
        kind: order().map(|i| s.kind[i]).collect(),
        tag: order().map(|i| s.tag[i]).collect(),
        frozen: order().map(|i| s.frozen[i]).collect(),
        mask: order().map(|i| s.mask[i]).collect(),
        ..s.clone()
    };
    (scene, vec![0..first, first..second, second..s.x.len()])
}

/// Three ranks, each with the lists for the forces on its own grains; the distribution changes whenever lists
/// are remade.
#[test]
fn lists_of_ranks_give_the_bits_of_one_process() {
    let mindlin: Table = |_, _| between(1, 1);
    for (period, law) in [(PERIODS[0], mindlin), (PERIODS[2], mindlin), (PERIODS[1], |_, _| sticky(1, 1))] {
        let (mut s, mut alone) = (scene(period), FastLoop::new(false, law));
        let mut ranks: Vec<FastLoop> = (0..3).map(|_| FastLoop::new(false, law)).collect();
        let step = Advance { dt: DT, history: true };
        let (mut rows, mut fewer) = (vec![], 0);
        for k in 0..30 {
            if k % 7 == 0 {
                s.wrap();
                (s, rows) = lined_up(&s, law, k / 7);
                let dealt = |me: usize| Dealt { rows: &rows, me };
                let frame = Frame { lo: [0.0; 3], period: s.period, reach: SKIN, skin: SKIN };
                let before: Vec<Fast> = ranks.iter().map(|part| part.fast.clone()).collect();
                for (me, part) in ranks.iter_mut().enumerate() {
                    let handed = |from: usize| {
                        // The new lists of the other ranks determine where contacts are sent.
                        let (mut other, mut out) = (before[from].clone(), vec![]);
                        let note = |fast: &Fast, own: Option<&Own>| {
                            out = fast.handed_over(&s.tag, dealt(from), own.unwrap());
                            None
                        };
                        other.rebuild(&s.grains(), &frame, note, Some(dealt(from)), &|i, j| s.keep(i, j));
                        out.swap_remove(me)
                    };
                    let known =
                        Contacts::joined(&(0..3).filter(|from| *from != me).map(handed).collect::<Vec<_>>());
                    part.fast.rebuild(&s.grains(), &frame, |_, _| Some(known), Some(dealt(me)), &|i, j| {
                        s.keep(i, j)
                    });
                    part.fast.weigh(&s.grains());
                    assert!(part.fast.is_part());
                }
            }
            let whole = alone.step(&s, k);
            let (mut virials, mut contacts) = (vec![], vec![]);
            for (part, own) in ranks.iter_mut().zip(&rows) {
                // Grains in no list have unknown state.
                let mut seen = s.clone();
                let listed = part.fast.listed();
                (0..s.x.len()).filter(|row| listed.binary_search(&(*row as u32)).is_err()).for_each(|row| {
                    (seen.x[row], seen.v[row]) = ([f64::NAN; 3], [f64::NAN; 3]);
                });
                let (mut f, mut torque) = (s.zeros(), s.zeros());
                let sums = Sums { force: &mut f, torque: &mut torque, heat: None, deeds: None };
                part.fast.run(&seen.grains(), sums, step, true, true);
                assert_eq!(
                    (&f[own.clone()], &torque[own.clone()]),
                    (&whole.f[own.clone()], &whole.torque[own.clone()])
                );
                virials.extend(part.fast.virials());
                contacts.push(part.fast.contacts());
                fewer += part.fast.pairs()[0];
            }
            virials.sort_by_key(|(list, _)| *list);
            let sum = |sum: [f64; 6], (_, v): &(u32, [f64; 6])| std::array::from_fn(|d| sum[d] + v[d]);
            assert_eq!(virials.iter().fold([0.0; 6], sum), whole.virial, "step {k}");
            assert_eq!(Contacts::joined(&contacts), whole.contacts, "step {k}");
            s.advance(&whole.f, &whole.torque);
        }
        assert!(fewer < 3 * 30 * alone.fast.pairs()[0], "{fewer}");
    }
}
