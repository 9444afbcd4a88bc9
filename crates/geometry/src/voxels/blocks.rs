//! An image seen in coarser blocks: which material each block is, so that the volume of every material stays.

/// How much what is owed to a material counts, against the part of the block that it fills.
///
/// Blocks go to the material that fills most of them. What this takes from or gives to a material is kept account of, and
/// counts a tenth: an account of a few blocks decides between two that fill about the same, one of ten blocks always. So interfaces stay where
/// they are to within a block, and no material gains or loses more than about ten blocks of the whole image.
const OWED: f64 = 0.1;

/// The grid of blocks over an image.
#[derive(Clone, Debug)]
pub struct Blocks {
    /// Blocks along x, y, z.
    pub count: [usize; 3],
    /// The block of each voxel along an axis.
    of: [Vec<u32>; 3],
    /// Voxels that a block holds on average.
    voxels: f64,
}

impl Blocks {
    /// Blocks of about this edge over so many voxels; voxels themselves where none is wanted.
    pub fn new(size: [usize; 3], spacing: [f64; 3], wanted: Option<f64>) -> Self {
        let count = [0, 1, 2].map(|d| match wanted {
            None => size[d],
            Some(h) => ((size[d] as f64 * spacing[d] / h).round() as usize).clamp(1, size[d]),
        });
        let of = [0, 1, 2].map(|d| {
            // The block in which the middle of a voxel lies.
            (0..size[d]).map(|i| ((2 * i + 1) * count[d] / (2 * size[d])) as u32).collect()
        });
        let voxels = (0..3).map(|d| size[d] as f64 / count[d] as f64).product();
        Self { count, of, voxels }
    }

    /// Whether every voxel is a block.
    pub fn single(&self) -> bool {
        self.voxels == 1.0
    }

    /// The slab of blocks that a slice belongs to.
    pub fn slab(&self, slice: usize) -> usize {
        self.of[2][slice] as usize
    }
}

/// Counts of materials in the blocks of a slab, and what is owed to each.
pub struct Counter<'a> {
    blocks: &'a Blocks,
    materials: usize,
    counts: Vec<u32>,
    owed: Vec<f64>,
}

impl<'a> Counter<'a> {
    /// For so many materials besides nothing, which is material 0.
    pub fn new(blocks: &'a Blocks, materials: usize) -> Self {
        let materials = materials + 1;
        let counts = vec![0; blocks.count[0] * blocks.count[1] * materials];
        Self { blocks, materials, counts, owed: vec![0.0; materials] }
    }

    /// Adds a slice: the material of each voxel, x fastest.
    pub fn add(&mut self, slice: impl Iterator<Item = usize>) {
        let [xs, ys, _] = &self.blocks.of;
        let mut slice = slice;
        for y in ys {
            let row = *y as usize * self.blocks.count[0];
            for (x, material) in xs.iter().zip(slice.by_ref()) {
                self.counts[(row + *x as usize) * self.materials + material] += 1;
            }
        }
    }

    /// The material of each block of the slab, x fastest; counts begin anew.
    pub fn settle(&mut self, mut block: impl FnMut(usize, usize)) {
        for (k, counts) in self.counts.chunks_exact_mut(self.materials).enumerate() {
            let mut best = (f64::NEG_INFINITY, 0);
            for (m, (count, owed)) in counts.iter().zip(&mut self.owed).enumerate() {
                let part = f64::from(*count) / self.blocks.voxels;
                let weight = part + OWED * *owed;
                if weight > best.0 {
                    best = (weight, m);
                }
                *owed += part;
            }
            self.owed[best.1] -= 1.0;
            counts.fill(0);
            block(k, best.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Materials of all blocks of an image whose voxels `of` returns.
    fn coarse(size: [usize; 3], h: f64, materials: usize, of: impl Fn([usize; 3]) -> usize) -> Vec<usize> {
        let blocks = Blocks::new(size, [1.0; 3], Some(h));
        let mut counter = Counter::new(&blocks, materials);
        let mut all = vec![];
        for z in 0..size[2] {
            counter.add((0..size[0] * size[1]).map(|k| of([k % size[0], k / size[0], z])));
            if z + 1 == size[2] || blocks.slab(z + 1) != blocks.slab(z) {
                counter.settle(|_, m| all.push(m));
            }
        }
        all
    }

    #[test]
    fn blocks_cover_the_image() {
        let b = Blocks::new([7, 4, 1], [1.0, 0.5, 2.0], Some(2.0));
        assert_eq!((b.count, b.single()), ([4, 1, 1], false));
        assert_eq!(b.of[0], [0, 0, 1, 2, 2, 3, 3]);
        assert!(Blocks::new([7, 4, 1], [1.0; 3], None).single());
    }

    /// An interface between blocks stays, and of materials at random each keeps its volume to within ten blocks.
    #[test]
    fn every_material_keeps_its_volume() {
        let halves = coarse([16, 8, 8], 2.0, 2, |x| 1 + usize::from(x[0] >= 6));
        assert!(halves.chunks(8).all(|row| row == [1, 1, 1, 2, 2, 2, 2, 2]));
        // A plane a third into a block: a third of the layer is filled.
        let size = [60, 60, 12];
        for (h, seed) in [(3.0, 1u64), (4.0, 2), (5.0, 3), (2.0, 4)] {
            let noise = |x: [usize; 3]| {
                let mut s =
                    seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (x[0] + 61 * x[1] + 3721 * x[2]) as u64;
                s = (s ^ s >> 31).wrapping_mul(0xBF58_476D_1CE4_E5B9);
                (s >> 40) as f64 / f64::from(1 << 24)
            };
            let of = |x: [usize; 3]| match noise(x) + 0.01 * x[0] as f64 {
                a if a < 0.35 => 0,
                a if a < 0.9 => 1,
                a if a < 0.95 => 2,
                _ => 3,
            };
            let blocks = coarse(size, h, 3, of);
            let each = size.iter().product::<usize>() as f64 / blocks.len() as f64;
            for m in 0..4 {
                let voxels = (0..43_200).filter(|k| of([k % 60, k / 60 % 60, k / 3600]) == m).count() as f64;
                let have = blocks.iter().filter(|b| **b == m).count() as f64;
                assert!((voxels / each - have).abs() < 10.5, "{h} {m}: {voxels} {have}");
            }
        }
    }
}
