//! Operations over sockets.

use super::*;
use crate::{broadcast, is_first, present, run_as, several};
use std::sync::Arc;

/// Runs `body` on this many ranks, each a thread.
fn ranks<T: Send>(size: usize, body: impl Fn() -> T + Sync) -> Vec<T> {
    let seats = Local::threads(size).unwrap();
    std::thread::scope(|s| {
        let body = &body;
        let all: Vec<_> =
            seats.into_iter().map(|seat| s.spawn(move || run_as(Arc::new(seat), body))).collect();
        all.into_iter().map(|t| t.join().unwrap()).collect()
    })
}

/// Ranks reach different points at different times.
fn dawdle(turn: usize) {
    let rank = present().rank();
    for _ in 0..(rank * 7 + turn * 3) % 5 {
        std::thread::yield_now();
    }
}

#[test]
fn all_ranks_have_the_same_sums_and_largest_values() {
    for size in [1, 2, 3, 5, 7] {
        ranks(size, || {
            let comm = present();
            for turn in 0..20 {
                dawdle(turn);
                let mut numbers = [comm.rank() as i64, 1, -3];
                comm.sum(&mut numbers);
                assert_eq!(numbers, [(size * (size - 1) / 2) as i64, size as i64, -3 * size as i64]);
                let mut values = [comm.rank() as f64, -(comm.rank() as f64)];
                comm.most(&mut values);
                assert_eq!(values, [(size - 1) as f64, 0.0]);
            }
        });
    }
}

#[test]
fn pieces_of_any_length_reach_all_ranks() {
    for size in [1, 2, 3, 5] {
        for length in [0, 1, 100, 300_000] {
            ranks(size, || {
                let comm = present();
                let counts: Vec<usize> = (0..size).map(|r| length * (r + 1)).collect();
                let start: usize = counts[..comm.rank()].iter().sum();
                let mut all = vec![0u8; counts.iter().sum()];
                all[start..start + counts[comm.rank()]].fill(comm.rank() as u8 + 1);
                comm.gather_all(&mut all, &counts);
                let wanted: Vec<u8> = (0..size).flat_map(|r| vec![r as u8 + 1; counts[r]]).collect();
                assert!(all == wanted);
            });
        }
    }
}

#[test]
fn ranks_send_to_each_other_at_once_even_what_no_socket_holds() {
    for size in [2, 3, 5] {
        for length in [8, 1_000_000] {
            ranks(size, || {
                let comm = present();
                let me = comm.rank();
                let out: Vec<(usize, Vec<u8>)> =
                    (0..size).map(|to| (to, vec![(10 * me + to) as u8; length])).collect();
                let out: Vec<(usize, &[u8])> = out.iter().map(|(to, b)| (*to, &b[..])).collect();
                let mut came = vec![vec![0u8; length]; size];
                let mut into: Vec<(usize, &mut [u8])> =
                    came.iter_mut().enumerate().map(|(r, b)| (r, &mut b[..])).collect();
                comm.swap(&out, &mut into);
                assert!(
                    came.iter().enumerate().all(|(from, b)| b.iter().all(|x| *x == (10 * from + me) as u8))
                );
            });
        }
    }
}

#[test]
fn what_is_sent_need_not_be_known_before() {
    ranks(4, || {
        let comm = present();
        let me = comm.rank();
        // To all higher ranks, one byte more each time.
        let out = (me + 1..4).map(|to| (to, vec![me as u8; to])).collect();
        let came = comm.exchange(out);
        assert_eq!(came, (0..me).map(|from| (from, vec![from as u8; me])).collect::<Vec<_>>());
    });
}

#[test]
fn the_first_rank_finds_out_and_all_know() {
    let texts = ranks(3, || {
        assert!(several());
        // Only the first one is asked.
        let number = broadcast::number(|| if is_first() { 2.5 } else { panic!("not needed") });
        let flag = broadcast::truth(is_first);
        let none = broadcast::text(|| None);
        (
            number,
            flag,
            none,
            broadcast::text(|| Some("a b".into())),
            broadcast::bytes(|| vec![0; 100_000]).len(),
        )
    });
    assert!(texts.iter().all(|t| *t == (2.5, true, None, Some("a b".into()), 100_000)));
    assert!(!several() && is_first() && broadcast::number(|| 1.0) == 1.0);
}

#[test]
fn ranks_that_end_meet_before() {
    let met = ranks(3, || {
        dawdle(1);
        present().meet(Duration::from_secs(5))
    });
    assert_eq!(met, [true; 3]);
    // One rank does not call it.
    let met = ranks(3, || present().rank() == 2 || present().meet(Duration::from_millis(60)));
    assert_eq!(met, [false, false, true]);
}

#[test]
fn machines_are_named() {
    let names = ranks(2, || crate::nodes(&*present()));
    assert_eq!(names[0], vec![crate::host(); 2]);
    assert_eq!(crate::describe(&names[0]), "2 ranks on 1 host");
}

#[test]
fn letters_are_taken_when_a_rank_looks_for_them() {
    // The longest ones exceed the buffer of a socket, and both sides send them before either polls.
    let lengths = [0, 5, 900_000, 1, 300_000];
    ranks(3, || {
        let comm = present();
        let me = comm.rank();
        let others = || (0..3).filter(|r| *r != me);
        for length in lengths {
            others().for_each(|to| comm.post(to, &vec![me as u8 + 1; length]));
        }
        let mut came = vec![vec![]; 3];
        while others().any(|r| came[r].len() < lengths.len()) {
            dawdle(came[0].len());
            for from in others().filter(|r| came[*r].len() < lengths.len()).collect::<Vec<_>>() {
                let letter = comm.letter(from).unwrap();
                assert!(letter.iter().flatten().all(|b| *b == from as u8 + 1));
                came[from].extend(letter.map(|l| l.len()));
            }
        }
        assert!(others().all(|r| came[r] == lengths));
        while !comm.posted() {
            std::thread::yield_now();
        }
        // Afterwards other operations work again.
        assert!(comm.meet(Duration::from_secs(5)));
    });
}

#[test]
fn letters_in_a_ring_arrive() {
    // Each rank polls only the one before it, while its data for the next one exceeds the buffer of a socket.
    ranks(3, || {
        let comm = present();
        let me = comm.rank();
        comm.post((me + 1) % 3, &vec![me as u8; 900_000]);
        let end = Instant::now() + Duration::from_secs(60);
        let came = loop {
            match comm.letter((me + 2) % 3).unwrap() {
                Some(letter) => break letter,
                None => assert!(Instant::now() < end, "no letter comes"),
            }
            std::thread::yield_now();
        };
        assert!(came == vec![((me + 2) % 3) as u8; 900_000]);
        while !comm.posted() {
            std::thread::yield_now();
        }
    });
}

#[test]
fn a_rank_that_ends_is_missed_by_those_that_look_for_its_letters() {
    ranks(2, || {
        let comm = present();
        if comm.rank() == 1 {
            return comm.post(0, b"the last one");
        }
        let mut last = comm.letter(1);
        while last != Err(Gone) {
            assert!(matches!(&last, Ok(None)) || last.as_ref().unwrap().as_deref() == Some(b"the last one"));
            last = comm.letter(1);
        }
        comm.post(1, b"not read");
        while !comm.posted() {}
    });
}
