//! How long tiles take, and by how much threads can be faster at most.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fmt::Write;
use std::sync::atomic::Ordering;

use crate::families::Families;
use crate::families::tiles::TileGraph;
use crate::lattice::tiles::lay_tiles;
use crate::list::tiles::lay_slabs;

/// Threads for which bounds are given.
const THREADS: [usize; 3] = [8, 16, 64];

impl Families {
    /// From now on the time is kept that each tile of bodies takes.
    pub fn time_tiles(&mut self) {
        for body in &mut self.lattices {
            lay_tiles(body);
            body.tiles.graph.keep_times();
        }
        lay_slabs(&mut self.list);
        self.list.tiles.graph.keep_times();
    }

    /// The tiles of each body on a lattice and of the list, one line each: how many and how large, the time of a sweep over all of them,
    /// and by how much some numbers of threads can be faster at most, from the times of tiles alone. Nothing where no time has been kept.
    pub fn describe_tiles(&self) -> String {
        let mut text = String::new();
        for (k, body) in self.lattices.iter().enumerate() {
            let tiles = &body.tiles;
            let rows = tiles.all.iter().map(|tile| tile.rows.len()).max().unwrap_or(0);
            let planes = tiles.all.iter().map(|tile| tile.planes.len()).max().unwrap_or(0);
            let size = format!("{rows} x {planes} rows and planes");
            describe(&mut text, &format!("lattice body {}", k + 1), &size, &tiles.graph);
        }
        let slabs = self.list.slab.windows(2).map(|ends| ends[1] - ends[0]);
        let size = format!("{} particles", slabs.max().unwrap_or(0));
        describe(&mut text, "bodies on no lattice", &size, &self.list.tiles.graph);
        text
    }
}

/// The line of some tiles, of this size at most.
fn describe(text: &mut String, name: &str, size: &str, tiles: &TileGraph) {
    let times = tiles.times.iter().map(|time| time.each_ref().map(|time| time.load(Ordering::Relaxed)));
    let (sweeps, settles): (Vec<u64>, Vec<u64>) = times.map(|[sweep, settle]| (sweep, settle)).unzip();
    if sweeps.is_empty() || sweeps.contains(&u64::MAX) || settles.contains(&u64::MAX) {
        return;
    }
    let alone = makespan(tiles, (&sweeps, &settles), 1);
    let bound = |threads| {
        let time = makespan(tiles, (&sweeps, &settles), threads);
        format!("{:.1} for {threads} threads", alone as f64 / time.max(1) as f64)
    };
    let _ = writeln!(
        text,
        "{name}: {} tile(s) of {size} at most, {:.3} ms for forces; bound: {}",
        sweeps.len(),
        alone as f64 * 1e-6,
        THREADS.map(bound).join(", ")
    );
}

/// When all tiles have been swept and have settled, if threads take them in their order and nothing else takes time.
fn makespan(tiles: &TileGraph, (sweeps, settles): (&[u64], &[u64]), threads: usize) -> u64 {
    let mut unswept: Vec<usize> = (0..tiles.tiles()).map(|k| tiles.givers(k).len() + 1).collect();
    let mut idle: BinaryHeap<Reverse<(u64, Option<usize>)>> =
        (0..threads).map(|_| Reverse((0, None))).collect();
    let (mut next, mut end) = (0, 0);
    while let Some(Reverse((mut now, swept))) = idle.pop() {
        for &taker in swept.map_or(&[][..], |swept| tiles.takers(swept)) {
            let left = &mut unswept[taker as usize];
            *left -= 1;
            now += if *left == 0 { settles[taker as usize] } else { 0 };
        }
        end = end.max(now);
        if let Some(sweep) = sweeps.get(next) {
            idle.push(Reverse((now + sweep, Some(next))));
            next += 1;
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four tiles of which each reaches into the next, swept in 10 and settled in 1.
    #[test]
    fn threads_wait_for_the_longest_chain() {
        let tiles = TileGraph::of(&[vec![], vec![0], vec![1], vec![2]]);
        let times = (&[10; 4][..], &[1; 4][..]);
        assert_eq!(makespan(&tiles, times, 1), 44);
        // The worker that ends the second tile has settled one before, and so on: two sweeps each, and two or three settle at the end.
        assert!((22..=24).contains(&makespan(&tiles, times, 2)), "{}", makespan(&tiles, times, 2));
        assert!((11..=14).contains(&makespan(&tiles, times, 4)), "{}", makespan(&tiles, times, 4));
    }
}
