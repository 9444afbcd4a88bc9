//! Options of `dump image`, and their translation into camera, colours and text.

mod settings;

use perigrain_base::math::cformat::general;
use perigrain_output::image::{Camera, Colour, Look, MAPS, Map, View};
use perigrain_styles::words::Words;
use perigrain_world::{Domain, World};

pub use settings::{Here, Later, foreign};

/// What is framed if no centre is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Words)]
#[word(what = "frame")]
enum Framing {
    /// Without a centre the picture shows what was drawn first, the box if that was nothing.
    First,
    /// It shows what is drawn each time.
    Each,
    /// It shows the box.
    Box,
}

/// An end of the colour range.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    Extreme,
    Number(f64),
}

/// All options of a picture.
#[derive(Clone, Debug)]
pub struct Options {
    /// Size, background, light.
    pub look: Look,
    /// Colours by value.
    pub map: &'static Map,
    /// Fixed colours of types.
    pub colours: Vec<(u16, Colour)>,
    /// Diameters of types.
    pub diameters: Vec<(u16, f64)>,
    /// One diameter for all.
    pub diameter: Option<f64>,
    /// Whether there is a legend.
    pub legend: bool,
    /// Title of the legend, if not the attribute's name.
    pub legend_text: Option<String>,
    /// Text at the top.
    pub title: String,
    /// Whether the time is shown at the bottom.
    pub time: bool,
    /// Whether the box is drawn.
    pub box_edges: bool,
    /// Whether walls are drawn.
    pub walls: bool,
    /// Whether a scale bar is shown at the bottom.
    pub scale_bar: bool,
    camera: Camera,
    /// Centre in fractions of the box; fixed or moving with it.
    centre: Option<[f64; 3]>,
    framing: Framing,
    range: [End; 2],
}

impl Default for Options {
    fn default() -> Self {
        Self {
            look: Look::default(),
            map: MAPS.iter().find(|m| m.name == "viridis").unwrap_or(&MAPS[0]),
            colours: vec![],
            diameters: vec![],
            diameter: None,
            legend: true,
            legend_text: None,
            title: String::new(),
            time: true,
            box_edges: false,
            walls: true,
            scale_bar: true,
            camera: Camera::default(),
            centre: None,
            framing: Framing::First,
            range: [End::Extreme; 2],
        }
    }
}

impl Options {
    /// The title of the legend.
    pub fn legend_title(&self, word: &str) -> String {
        let plain = word.strip_prefix("c_").or(word.strip_prefix("f_")).or(word.strip_prefix("v_"));
        self.legend_text.clone().unwrap_or_else(|| plain.unwrap_or(word).to_string())
    }

    /// The range of the colour map for these values.
    pub fn range_of(&self, values: impl Iterator<Item = f64>) -> [f64; 2] {
        let mut range = self.range.map(|e| match e {
            End::Number(a) => a,
            End::Extreme => f64::NAN,
        });
        if self.range.contains(&End::Extreme) {
            let mut seen = [f64::INFINITY, f64::NEG_INFINITY];
            for v in values.filter(|v| v.is_finite()) {
                seen = [seen[0].min(v), seen[1].max(v)];
            }
            if seen[0] > seen[1] {
                seen = [0.0, 1.0];
            }
            for k in 0..2 {
                if range[k].is_nan() {
                    range[k] = seen[k];
                }
            }
        }
        // A single value everywhere is drawn as the low end.
        if range[0] == range[1] { [range[0], range[0] + 1.0] } else { range }
    }

    /// The view of this snapshot; `kept` stores the first one, which shows the box if there are no particles
    /// yet.
    pub fn view<I>(&self, domain: &Domain, spheres: impl Fn() -> I, kept: &mut Option<View>) -> View
    where
        I: Iterator<Item = ([f64; 3], f64)>,
    {
        let bounds = domain.bounds();
        let at = |f: [f64; 3]| [0, 1, 2].map(|k| bounds[k][0] + f[k] * (bounds[k][1] - bounds[k][0]));
        let camera = Camera { centre: self.centre.map(at), ..self.camera.clone() };
        // If the box is drawn, it is framed.
        let framing = if self.box_edges { Framing::Box } else { self.framing };
        match framing {
            Framing::Each => camera.frame(spheres()),
            Framing::Box => camera.frame_box(bounds),
            Framing::First => *kept.get_or_insert_with(|| match spheres().next() {
                Some(_) => camera.frame(spheres()),
                None => camera.frame_box(bounds),
            }),
        }
    }
}

/// The twelve edges of the box.
pub fn edges(d: &Domain) -> Vec<[[f64; 3]; 2]> {
    let corners = d.corners();
    let corner = |k: usize| match d.tilted() {
        true => corners[k],
        false => [0, 1, 2].map(|a| if k >> a & 1 == 0 { d.lo[a] } else { d.hi[a] }),
    };
    let mut lines = vec![];
    for k in 0..8usize {
        lines.extend((0..3).filter(|a| k >> a & 1 == 0).map(|a| [corner(k), corner(k | 1 << a)]));
    }
    lines
}

/// The line at the bottom of a picture: the time with a suitable SI prefix.
pub fn time_line(w: &World) -> String {
    let (time, units) = (w.clock.time(), w.settings.units);
    match units.name() {
        "si" | "cgs" => {
            let (value, unit) = match time.abs() {
                0.0 => (0.0, "s"),
                t if t < 0.9995e-6 => (time * 1e9, "ns"),
                t if t < 0.9995e-3 => (time * 1e6, "µs"),
                t if t < 0.9995 => (time * 1e3, "ms"),
                _ => (time, "s"),
            };
            format!("t = {} {unit}", general(value, 4))
        }
        _ => format!("t = {} {}", general(time, 4), units.symbols()[1]).trim_end().to_string(),
    }
}
