//! What snapshots keep of a scene, and how many there are.

use super::*;

fn frame(step: i64, n: usize) -> Frame {
    let grid = Grid::over([[0.0; 3], [1.0; 3]], None);
    let x = std::array::from_fn(|_| vec![7; n]);
    Frame {
        step,
        time: Some(0.0),
        cell: Cell::default(),
        units: [""; 3],
        walls: [].into(),
        span: [[0.0; 3]; 2],
        grid,
        x,
        columns: vec![],
    }
}

/// Runs of so many steps one after the other, as the loop over steps goes about it.
fn filmed(runs: &[i64], n: usize) -> Vec<i64> {
    let mut film = Film::default();
    let (mut at, mut begun) = (0u64, false);
    for steps in runs {
        film.expect(*steps);
        if !begun {
            film.take(0, frame(0, n));
            begun = true;
        }
        for _ in 0..*steps {
            at += 1;
            if at.is_multiple_of(film.every()) {
                film.take(at, frame(at as i64, n));
            }
        }
    }
    film.finish(frame(at as i64, n)).iter().map(|f| f.step).collect()
}

#[test]
fn snapshots_are_even_and_few_however_long_the_run_is() {
    assert_eq!(filmed(&[4], 1), [0, 1, 2, 3, 4]);
    let steps = filmed(&[600], 1);
    assert_eq!((steps.len(), steps[1], steps[60]), (61, 10, 600));
    for runs in [&[0, 100_000][..], &[10, 100_000], &[100; 1000], &[99_999]] {
        let steps = filmed(runs, 1);
        let end: i64 = runs.iter().sum();
        assert!((32..=66).contains(&steps.len()), "{}", steps.len());
        assert_eq!((steps[0], *steps.last().unwrap()), (0, end));
        let gaps: Vec<i64> = steps.windows(2).map(|w| w[1] - w[0]).collect();
        assert!(gaps[..gaps.len() - 1].iter().all(|gap| *gap == gaps[0]), "{gaps:?}");
    }
}

#[test]
fn the_interval_doubles_where_snapshots_take_too_long() {
    let mut film = Film::default();
    let ms = Duration::from_millis;
    for at in 0..4 {
        film.take(at, frame(at as i64, 1));
        film.spend(ms(25), ms(0));
    }
    assert_eq!(film.every(), 1, "so much is free");
    film.take(4, frame(4, 1));
    film.spend(ms(25), ms(1600));
    assert_eq!(film.every(), 2);
    film.spend(ms(0), ms(2000));
    assert_eq!(film.every(), 2, "they are a small part by now");
    assert_eq!(film.into_frames().iter().map(|f| f.step).collect::<Vec<_>>(), [0, 2, 4]);
}

#[test]
fn memory_is_bounded() {
    // Two such frames and a third are too much.
    let steps = filmed(&[100], MEMORY / 6 / 2 - 1);
    assert!((2..=4).contains(&steps.len()), "{steps:?}");
}

#[test]
fn positions_keep_a_part_in_sixty_thousand() {
    let span = [[-1.0, 0.0, 5.0], [3.0, 0.0, 5.1]];
    let grid = Grid::over(span, None);
    for x in [[-1.0, 0.0, 5.0], [0.123, 0.0, 5.05], [3.0, 0.0, 5.1]] {
        for d in 0..3 {
            let back = grid.place(d, grid.count(d, x[d]));
            assert!((back - x[d]).abs() <= 0.51 * grid.cell[d], "{x:?} {d}: {back}");
        }
    }
    assert_eq!(Grid::over([[-1.5, 0.0, 5.0], [3.5, 0.0, 5.1]], Some(grid)), grid, "it has room");
    assert_ne!(Grid::over([[-9.0, 0.0, 5.0], [3.0, 0.0, 5.1]], Some(grid)), grid);
    assert_ne!(Grid::over([[0.0; 3], [0.1, 0.0, 0.1]], Some(grid)), grid, "it is too coarse");
    assert_eq!((grid.count(0, f64::NAN), grid.count(0, f64::INFINITY)), (0, 65_535));
}

#[test]
fn columns_keep_whole_numbers_and_the_ends_of_others() {
    let of = |values: &[f64]| {
        let c = Column::of("c", values);
        let (list, most): (Vec<f64>, f64) = match &c.values {
            Values::Same => return vec![c.ends[0]; values.len()],
            Values::Bytes(list) => (list.iter().map(|v| f64::from(*v)).collect(), 255.0),
            Values::Words(list) => (list.iter().map(|v| f64::from(*v)).collect(), 65_535.0),
        };
        list.iter().map(|q| c.ends[0] + (c.ends[1] - c.ends[0]) * q / most).collect::<Vec<_>>()
    };
    for whole in [&[1.0, 2.0, 7.0][..], &[5.0, 5.0], &[-3.0, 60_000.0], &[]] {
        assert_eq!(of(whole), whole);
    }
    let back = of(&[0.0, 0.123, 1e-3, f64::NAN]);
    assert!((back[1] - 0.123).abs() < 1e-6 && back[3] == 0.0, "{back:?}");
    let shares = Column::of_shares("damage", &[0.0, 0.5]);
    assert_eq!((shares.ends, shares.span), ([0.0, 1.0], [0.0, 0.5]));
}

#[test]
fn particles_are_put_in_the_order_of_their_ids() {
    assert_eq!(taken::order(&[1, 2, 9]), None);
    assert_eq!(taken::order(&[3, 1, 2]), Some(vec![1, 2, 0]));
    assert_eq!(taken::order(&[4_000_000_000, 1, 2]), Some(vec![1, 2, 0]));
}
