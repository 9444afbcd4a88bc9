//! Colours, named colours and colour maps.

use std::sync::OnceLock;

/// A colour in linear light, so that shading and averaging are right; shown as sRGB.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Colour(pub [f32; 3]);

impl Colour {
    /// From `0xrrggbb` in sRGB.
    pub fn hex(rgb: u32) -> Self {
        Self::from_bytes([(rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8])
    }

    /// From sRGB bytes.
    pub fn from_bytes(bytes: [u8; 3]) -> Self {
        let linear = &tables().0;
        Self(bytes.map(|b| linear[usize::from(b)]))
    }

    /// From sRGB fractions.
    pub fn from_fractions(rgb: [f64; 3]) -> Self {
        Self(rgb.map(|c| to_linear(c.clamp(0.0, 1.0) as f32)))
    }

    /// As sRGB bytes.
    pub fn bytes(self) -> [u8; 3] {
        let bytes = &tables().1;
        self.0.map(|c| bytes[(c.clamp(0.0, 1.0) * FINE + 0.5) as usize])
    }

    /// A mixture: 0 is this colour, 1 the other.
    pub fn mix(self, other: Self, t: f32) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + t * (other.0[k] - self.0[k])))
    }
}

fn to_linear(c: f32) -> f32 {
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

fn to_srgb(c: f32) -> f32 {
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

/// Steps of linear light that have a byte each: twenty for the darkest byte.
const FINE: f32 = 65_535.0;

/// Linear light of each byte, and the byte of each step of linear light: powers took a third of a picture's time.
fn tables() -> &'static ([f32; 256], Vec<u8>) {
    static TABLES: OnceLock<([f32; 256], Vec<u8>)> = OnceLock::new();
    TABLES.get_or_init(|| {
        let linear = std::array::from_fn(|b| to_linear(b as f32 / 255.0));
        let byte = |step: u16| (to_srgb(f32::from(step) / FINE) * 255.0 + 0.5) as u8;
        (linear, (0..=u16::MAX).map(byte).collect())
    })
}

/// A colour map: equally spaced colours, interpolated in sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Map {
    /// As written in a deck.
    pub name: &'static str,
    stops: &'static [u32],
}

/// All colour maps. `viridis`, `plasma`, `inferno` are matplotlib's (CC0), `coolwarm` is K. Moreland's
/// (doi 10.1007/978-3-642-10520-3_9); `damage` and `grey` are perigrain's: `damage` leaves sound material
/// pale, so that cracks are what one sees.
pub const MAPS: &[Map] = &[
    Map {
        name: "damage",
        stops: &[0xd3e0e8, 0xe9e3cf, 0xf8cf86, 0xf5a04a, 0xe5652e, 0xc22f27, 0x8f1526, 0x5c0a24, 0x2e0719],
    },
    Map {
        name: "viridis",
        stops: &[
            0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26828e, 0x21918c,
            0x1fa088, 0x28ae80, 0x3fbc73, 0x5ec962, 0x84d44b, 0xaddc30, 0xd8e219, 0xfde725,
        ],
    },
    Map {
        name: "plasma",
        stops: &[
            0x0d0887, 0x310597, 0x4c02a1, 0x6600a7, 0x7e03a8, 0x9511a1, 0xaa2395, 0xbc3587, 0xcc4778,
            0xda5a6a, 0xe66c5c, 0xf0804e, 0xf89540, 0xfdac33, 0xfdc527, 0xf8df25, 0xf0f921,
        ],
    },
    Map {
        name: "inferno",
        stops: &[
            0x000004, 0x0b0724, 0x210c4a, 0x3d0965, 0x57106e, 0x71196e, 0x8a226a, 0xa32c61, 0xbc3754,
            0xd24644, 0xe45a31, 0xf1731d, 0xf98e09, 0xfcac11, 0xf9cb35, 0xf2ea69, 0xfcffa4,
        ],
    },
    Map {
        name: "coolwarm",
        stops: &[
            0x3b4cc0, 0x4e68d8, 0x6282ea, 0x779af7, 0x8db0fe, 0xa3c2fe, 0xb9d0f9, 0xccd9ed, 0xdddcdc,
            0xecd3c5, 0xf5c4ac, 0xf7b093, 0xf4987a, 0xeb7d62, 0xdd5f4b, 0xca3b37, 0xb40426,
        ],
    },
    Map { name: "grey", stops: &[0x202020, 0xf0f0f0] },
];

impl Map {
    /// Looks a map up; `gray` is `grey`.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        let name = if name == "gray" { "grey" } else { name };
        MAPS.iter().find(|m| m.name == name)
    }

    /// The colour at a fraction from 0 to 1; beyond, the end colours apply. Not a number is magenta.
    pub fn at(&self, t: f64) -> Colour {
        if t.is_nan() {
            return Colour::hex(0xff00ff);
        }
        let last = self.stops.len() - 1;
        let s = t.clamp(0.0, 1.0) * last as f64;
        let k = (s as usize).min(last.saturating_sub(1));
        let w = s - k as f64;
        let channel = |shift: u32| {
            let [a, b] = [self.stops[k], self.stops[(k + 1).min(last)]].map(|c| f64::from(c >> shift & 0xff));
            (a + w * (b - a)) / 255.0
        };
        Colour::from_fractions([channel(16), channel(8), channel(0)])
    }

    /// The colour of a value within a range.
    pub fn of(&self, value: f64, range: [f64; 2]) -> Colour {
        let width = range[1] - range[0];
        if width == 0.0 && !value.is_nan() {
            return self.at(0.5);
        }
        self.at((value - range[0]) / width)
    }
}

/// Distinct colours for types 1, 2, …, repeating; Okabe and Ito's set, softened, glass first.
pub fn by_kind(kind: usize) -> Colour {
    const COLOURS: [u32; 8] =
        [0xa9c4d6, 0xe08e45, 0x3f9e7c, 0xd1b54a, 0x4a7fb5, 0xc65f5a, 0xb584b5, 0x7d8790];
    Colour::hex(COLOURS[kind.saturating_sub(1) % COLOURS.len()])
}

/// Colours that have names: `0xrrggbb`.
const NAMES: &[(&str, u32)] = &[
    ("white", 0xffffff),
    ("black", 0x000000),
    ("grey", 0x808080),
    ("gray", 0x808080),
    ("silver", 0xc0c0c0),
    ("steel", 0x8795a1),
    ("glass", 0xa9c4d6),
    ("red", 0xd62728),
    ("green", 0x2ca02c),
    ("blue", 0x1f77b4),
    ("orange", 0xff7f0e),
    ("yellow", 0xf2d024),
    ("purple", 0x9467bd),
    ("brown", 0x8c564b),
    ("pink", 0xe377c2),
    ("cyan", 0x17becf),
    ("gold", 0xd4a017),
    ("navy", 0x1b2a49),
];

/// The names of colours.
pub fn colour_names() -> impl Iterator<Item = &'static str> {
    NAMES.iter().map(|(name, _)| *name)
}

/// A colour by a plain English name or as `#rrggbb` or `0xrrggbb`.
pub fn colour_by_name(name: &str) -> Option<Colour> {
    let hex = name.strip_prefix('#').or_else(|| name.strip_prefix("0x"));
    if let Some(digits) = hex.filter(|d| d.len() == 6) {
        return u32::from_str_radix(digits, 16).ok().map(Colour::hex);
    }
    NAMES.iter().find(|n| n.0 == name).map(|n| Colour::hex(n.1))
}
