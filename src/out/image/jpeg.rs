//! Pictures as JPEG files: the baseline of ITU-T T.81 (JFIF), all colours at full resolution, at the quality of LAMMPS' pictures.

/// Quality on the usual scale to 100, as in LAMMPS 22Jul2025's files.
const QUALITY: u16 = 85;

/// Annex K of the standard: how coarsely brightness is kept, row by row.
const BRIGHTNESS: [u16; 64] = [
    16, 11, 10, 16, 24, 40, 51, 61, 12, 12, 14, 19, 26, 58, 60, 55, 14, 13, 16, 24, 40, 57, 69, 56, 14, 17,
    22, 29, 51, 87, 80, 62, 18, 22, 37, 56, 68, 109, 103, 77, 24, 35, 55, 64, 81, 104, 113, 92, 49, 64, 78,
    87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99,
];

/// Annex K: how coarsely colour is kept: these in the upper left corner, 99 elsewhere.
const COLOUR: [[u16; 4]; 4] = [[17, 18, 24, 47], [18, 21, 26, 66], [24, 26, 56, 99], [47, 66, 99, 99]];

/// The codes of Annex K for one kind of numbers.
struct Codes {
    /// Class and number, as the file says them.
    id: u8,
    /// How many codes there are of each length.
    counts: [u8; 16],
    /// What they stand for.
    values: &'static [u8],
}

/// Means of blocks, brightness.
const DC_BRIGHTNESS: Codes = Codes {
    id: 0x00,
    counts: [0, 1, 5, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0],
    values: b"\x00\x01\x02\x03\x04\x05\x06\x07\x08\x09\x0a\x0b",
};

/// All else, brightness.
const AC_BRIGHTNESS: Codes = Codes {
    id: 0x10,
    counts: [0, 2, 1, 3, 3, 2, 4, 3, 5, 5, 4, 4, 0, 0, 1, 125],
    values:
        b"\x01\x02\x03\x00\x04\x11\x05\x12\x21\x31\x41\x06\x13\x51\x61\x07\x22\x71\x14\x32\x81\x91\xa1\x08\
        \x23\x42\xb1\xc1\x15\x52\xd1\xf0\x24\x33\x62\x72\x82\x09\x0a\x16\x17\x18\x19\x1a\x25\x26\x27\x28\
        \x29\x2a\x34\x35\x36\x37\x38\x39\x3a\x43\x44\x45\x46\x47\x48\x49\x4a\x53\x54\x55\x56\x57\x58\x59\
        \x5a\x63\x64\x65\x66\x67\x68\x69\x6a\x73\x74\x75\x76\x77\x78\x79\x7a\x83\x84\x85\x86\x87\x88\x89\
        \x8a\x92\x93\x94\x95\x96\x97\x98\x99\x9a\xa2\xa3\xa4\xa5\xa6\xa7\xa8\xa9\xaa\xb2\xb3\xb4\xb5\xb6\
        \xb7\xb8\xb9\xba\xc2\xc3\xc4\xc5\xc6\xc7\xc8\xc9\xca\xd2\xd3\xd4\xd5\xd6\xd7\xd8\xd9\xda\xe1\xe2\
        \xe3\xe4\xe5\xe6\xe7\xe8\xe9\xea\xf1\xf2\xf3\xf4\xf5\xf6\xf7\xf8\xf9\xfa",
};

/// Means of blocks, colour.
const DC_COLOUR: Codes = Codes {
    id: 0x01,
    counts: [0, 3, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0],
    values: b"\x00\x01\x02\x03\x04\x05\x06\x07\x08\x09\x0a\x0b",
};

/// All else, colour.
const AC_COLOUR: Codes = Codes {
    id: 0x11,
    counts: [0, 2, 1, 2, 4, 4, 3, 4, 7, 5, 4, 4, 0, 1, 2, 119],
    values:
        b"\x00\x01\x02\x03\x11\x04\x05\x21\x31\x06\x12\x41\x51\x07\x61\x71\x13\x22\x32\x81\x08\x14\x42\x91\
        \xa1\xb1\xc1\x09\x23\x33\x52\xf0\x15\x62\x72\xd1\x0a\x16\x24\x34\xe1\x25\xf1\x17\x18\x19\x1a\x26\
        \x27\x28\x29\x2a\x35\x36\x37\x38\x39\x3a\x43\x44\x45\x46\x47\x48\x49\x4a\x53\x54\x55\x56\x57\x58\
        \x59\x5a\x63\x64\x65\x66\x67\x68\x69\x6a\x73\x74\x75\x76\x77\x78\x79\x7a\x82\x83\x84\x85\x86\x87\
        \x88\x89\x8a\x92\x93\x94\x95\x96\x97\x98\x99\x9a\xa2\xa3\xa4\xa5\xa6\xa7\xa8\xa9\xaa\xb2\xb3\xb4\
        \xb5\xb6\xb7\xb8\xb9\xba\xc2\xc3\xc4\xc5\xc6\xc7\xc8\xc9\xca\xd2\xd3\xd4\xd5\xd6\xd7\xd8\xd9\xda\
        \xe2\xe3\xe4\xe5\xe6\xe7\xe8\xe9\xea\xf2\xf3\xf4\xf5\xf6\xf7\xf8\xf9\xfa",
};

impl Codes {
    /// Code and length of each value: codes of one length follow each other.
    fn table(&self) -> [(u16, u8); 256] {
        let mut table = [(0, 0); 256];
        let (mut code, mut values) = (0u16, self.values.iter());
        for (length, count) in (1..).zip(self.counts) {
            for value in values.by_ref().take(usize::from(count)) {
                table[usize::from(*value)] = (code, length);
                code += 1;
            }
            code <<= 1;
        }
        table
    }
}

/// Bits on their way into bytes.
#[derive(Default)]
struct Bits {
    out: Vec<u8>,
    held: u32,
    count: u32,
}

impl Bits {
    fn put(&mut self, bits: u16, length: u8) {
        self.held = self.held << length | u32::from(bits);
        self.count += u32::from(length);
        while self.count >= 8 {
            self.count -= 8;
            let byte = (self.held >> self.count) as u8;
            self.out.push(byte);
            // A byte of ones would be a marker.
            if byte == 0xff {
                self.out.push(0);
            }
        }
        self.held &= (1 << self.count) - 1;
    }

    /// Fills the last byte with ones.
    fn close(mut self) -> Vec<u8> {
        self.put(0x7f, 7);
        self.out
    }
}

/// The places of a block in the order in which they are written: diagonal by diagonal, to and fro.
fn zigzag() -> [usize; 64] {
    let mut order: Vec<usize> = (0..64).collect();
    order.sort_by_key(|k| {
        let (row, column) = (k / 8, k % 8);
        let diagonal = row + column;
        (diagonal, if diagonal % 2 == 0 { column } else { row })
    });
    std::array::from_fn(|k| order[k])
}

/// A table of Annex K at [`QUALITY`].
fn scaled(table: [u16; 64]) -> [u16; 64] {
    table.map(|q| ((q * (200 - 2 * QUALITY) + 50) / 100).clamp(1, 255))
}

/// Brightness and two differences of colour, each around 0.
fn components([r, g, b]: [u8; 3]) -> [f32; 3] {
    let (r, g, b) = (f32::from(r), f32::from(g), f32::from(b));
    let y = 0.299 * r + 0.587 * g + 0.114 * b;
    [y - 128.0, (b - y) / 1.772, (r - y) / 1.402]
}

/// The cosine transform of eight numbers, times the factors that make it orthogonal.
struct Cosines([[f32; 8]; 8]);

impl Cosines {
    fn new() -> Self {
        Self(std::array::from_fn(|u| {
            let norm = if u == 0 { 0.125f64.sqrt() } else { 0.5 };
            std::array::from_fn(|x| {
                (norm * ((2 * x + 1) as f64 * u as f64 * std::f64::consts::PI / 16.0).cos()) as f32
            })
        }))
    }

    /// The transform of a block.
    fn of(&self, block: &[f32; 64]) -> [f32; 64] {
        let mut rows = [0.0; 64];
        for (k, out) in rows.iter_mut().enumerate() {
            let (y, u) = (k / 8, k % 8);
            *out = (0..8).map(|x| self.0[u][x] * block[8 * y + x]).sum();
        }
        std::array::from_fn(|k| {
            let (v, u) = (k / 8, k % 8);
            (0..8).map(|y| self.0[v][y] * rows[8 * y + u]).sum()
        })
    }
}

/// How one of the three components is coded.
struct Channel {
    divisors: [u16; 64],
    means: [(u16, u8); 256],
    rest: [(u16, u8); 256],
    /// The mean of the block before.
    before: i32,
}

impl Channel {
    fn new(divisors: [u16; 64], means: &Codes, rest: &Codes) -> Self {
        Self { divisors, means: means.table(), rest: rest.table(), before: 0 }
    }

    /// Writes a block: the difference of its mean to the last one, then numbers with the zeros before them.
    fn block(&mut self, block: &[f32; 64], order: &[usize; 64], bits: &mut Bits) {
        let number = |k: usize| (block[k] / f32::from(self.divisors[k])).round() as i32;
        let mean = number(0);
        let difference = mean - self.before;
        let (size, tail) = parts(difference);
        let (code, length) = self.means[usize::from(size)];
        bits.put(code, length);
        bits.put(tail, size);
        let mut zeros = 0u8;
        for &k in &order[1..] {
            let a = number(k);
            if a == 0 {
                zeros += 1;
                continue;
            }
            while zeros > 15 {
                let (code, length) = self.rest[0xf0];
                bits.put(code, length);
                zeros -= 16;
            }
            let (size, tail) = parts(a);
            let (code, length) = self.rest[usize::from(zeros << 4 | size)];
            bits.put(code, length);
            bits.put(tail, size);
            zeros = 0;
        }
        if zeros > 0 {
            let (code, length) = self.rest[0];
            bits.put(code, length);
        }
        self.before = mean;
    }
}

/// How many bits a number has, and these bits; of a negative one those of the number below.
fn parts(a: i32) -> (u8, u16) {
    let size = (32 - a.unsigned_abs().leading_zeros()) as u8;
    let tail = if a < 0 { a - 1 } else { a };
    (size, (tail & ((1 << size) - 1)) as u16)
}

/// A picture of so many pixels from left to right and from top to bottom as a file. Neither may be beyond 65535.
pub fn encode(width: usize, height: usize, pixels: &[[u8; 3]]) -> Vec<u8> {
    let wide: [u16; 64] = std::array::from_fn(|k| match (k / 8, k % 8) {
        (row @ 0..4, column @ 0..4) => COLOUR[row][column],
        _ => 99,
    });
    let (order, tables) = (zigzag(), [scaled(BRIGHTNESS), scaled(wide)]);
    let mut out = head(width, height, &order, &tables);
    let mut channels = [
        Channel::new(tables[0], &DC_BRIGHTNESS, &AC_BRIGHTNESS),
        Channel::new(tables[1], &DC_COLOUR, &AC_COLOUR),
        Channel::new(tables[1], &DC_COLOUR, &AC_COLOUR),
    ];
    let (cosines, mut bits) = (Cosines::new(), Bits::default());
    for top in (0..height).step_by(8) {
        for left in (0..width).step_by(8) {
            // Blocks over the edge repeat the last pixels.
            let at = |k: usize| ((top + k / 8).min(height - 1), (left + k % 8).min(width - 1));
            let block: [[f32; 3]; 64] = std::array::from_fn(|k| {
                let (y, x) = at(k);
                components(pixels[y * width + x])
            });
            for (c, channel) in channels.iter_mut().enumerate() {
                let own = std::array::from_fn(|k| block[k][c]);
                channel.block(&cosines.of(&own), &order, &mut bits);
            }
        }
    }
    out.extend(bits.close());
    out.extend([0xff, 0xd9]);
    out
}

/// All before the pixels.
fn head(width: usize, height: usize, order: &[usize; 64], tables: &[[u16; 64]; 2]) -> Vec<u8> {
    let mut out = vec![0xff, 0xd8];
    let mut segment = |marker: u8, body: &[u8]| {
        out.extend([0xff, marker]);
        out.extend((body.len() as u16 + 2).to_be_bytes());
        out.extend_from_slice(body);
    };
    segment(0xe0, b"JFIF\0\x01\x01\0\0\x01\0\x01\0\0");
    for (id, table) in (0u8..).zip(tables) {
        let body: Vec<u8> = std::iter::once(id).chain(order.iter().map(|&k| table[k] as u8)).collect();
        segment(0xdb, &body);
    }
    let [[h, l], [w, m]] = [height, width].map(|n| (n as u16).to_be_bytes());
    segment(0xc0, &[8, h, l, w, m, 3, 1, 0x11, 0, 2, 0x11, 1, 3, 0x11, 1]);
    for codes in [&DC_BRIGHTNESS, &AC_BRIGHTNESS, &DC_COLOUR, &AC_COLOUR] {
        segment(0xc4, &[&[codes.id], &codes.counts[..], codes.values].concat());
    }
    segment(0xda, &[3, 1, 0, 2, 0x11, 3, 0x11, 0, 63, 0]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture with slopes, edges and noise; neither side a multiple of eight.
    fn picture(width: usize, height: usize) -> Vec<[u8; 3]> {
        let pixel = |k: usize| {
            let (x, y) = (k % width, k / width);
            let disc = (x as f64 - 20.0).hypot(y as f64 - 15.0) < 11.0;
            let shade = (200.0 * x as f64 / width as f64) as u8;
            match disc {
                true => [220, 40 + shade / 2, (k * 37 % 23) as u8],
                false => [250 - shade, 240, 255 - (y * 3) as u8],
            }
        };
        (0..width * height).map(pixel).collect()
    }

    // Read back by a decoder that others have written.
    #[test]
    fn others_read_the_picture() {
        for (width, height) in [(53, 37), (8, 8), (1, 1), (64, 16)] {
            let pixels = picture(width, height);
            let file = encode(width, height, &pixels);
            let mut reader = zune_jpeg::JpegDecoder::new(std::io::Cursor::new(&file));
            let read = reader.decode().unwrap();
            assert_eq!(reader.dimensions(), Some((width, height)));
            let differences = read.iter().zip(pixels.as_flattened()).map(|(a, b)| f64::from(a.abs_diff(*b)));
            let (sum, most) =
                differences.fold((0.0, 0.0), |(sum, most): (f64, f64), d| (sum + d, most.max(d)));
            // Steps of the coarsest terms are 30: edges and noise are off by some of them, all else by one or two.
            let mean = sum / read.len() as f64;
            assert!(mean < 3.5 && most < 64.0, "{width} {height}: {mean} {most}");
        }
    }

    #[test]
    fn the_order_is_that_of_the_standard() {
        assert_eq!(zigzag()[..10], [0, 1, 8, 16, 9, 2, 3, 10, 17, 24]);
        assert_eq!(zigzag()[58..63], [61, 54, 47, 55, 62]);
        // As in LAMMPS 22Jul2025's files.
        assert_eq!(zigzag().map(|k| scaled(BRIGHTNESS)[k])[..8], [5, 3, 4, 4, 4, 3, 5, 4]);
    }
}
