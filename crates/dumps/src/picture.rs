//! Options of `dump image`, and their translation into camera, colours and text.

use perigrain_base::diag::{Code, Result, fail, nearest};
use perigrain_base::gate;
use perigrain_base::math::cformat::general;
use perigrain_lang::args::{blame, parse_number};
use perigrain_lang::{Args, Word};
use perigrain_output::image::{Camera, Colour, Look, MAPS, Map, View, colour_by_name};
use perigrain_styles::BuildCx;
use perigrain_world::memory;
use perigrain_world::{Domain, World};

/// All keywords.
pub const KEYWORDS: &[&str] = &[
    "acolor",
    "adiam",
    "atom",
    "axes",
    "backcolor",
    "backcolor2",
    "box",
    "boxcolor",
    "center",
    "depthcue",
    "frame",
    "fsaa",
    "legend",
    "map",
    "perspective",
    "range",
    "scalebar",
    "shiny",
    "size",
    "ssao",
    "time",
    "title",
    "up",
    "view",
    "walls",
    "zoom",
];

/// Keywords that reset the framing of the picture.
pub const MOVES: &[&str] =
    &["view", "up", "zoom", "center", "perspective", "frame", "region", "thresh", "adiam", "size"];

/// LAMMPS' keywords that are refused by name.
const ELSEWHERE: &[&str] = &[
    "amap",
    "atrans",
    "autobond",
    "bdiam",
    "bcolor",
    "body",
    "bond",
    "color",
    "compute",
    "ellipsoid",
    "element",
    "fix",
    "gamma",
    "gmap",
    "grid",
    "lights",
    "line",
    "outline",
    "specular",
    "subbox",
    "tri",
];

/// What is framed if no centre is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Framing {
    First,
    Each,
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

/// Bytes per pixel until the picture is written: depths and colours of four samples, depths for the shading,
/// final colour, and compressed bytes.
const BYTES_PER_PIXEL: f64 = 46.0;

/// The longest side of a picture: viewers and memory set this limit.
const LONGEST: i64 = 16384;

fn pixels(args: &mut Args, what: &str) -> Result<usize> {
    let span = args.here();
    let n = args.integer_from(16, what)?;
    if n > LONGEST {
        return fail(Code::BAD_VALUE, span, format!("{what} is at most {LONGEST}, not {n}"));
    }
    Ok(n as usize)
}

impl Options {
    /// Reads one keyword with its values; `modify` distinguishes `dump_modify` from the dump line.
    pub fn read(&mut self, word: &Word, args: &mut Args, cx: &BuildCx, modify: bool) -> Result<bool> {
        match word.text.as_str() {
            "size" => {
                self.look.width = pixels(args, "the width in pixels")?;
                self.look.height = pixels(args, "the height in pixels")?;
                let all = self.look.width as f64 * self.look.height as f64;
                let allowed = gate::beyond(all, |l| l.pixels, "pixels", &format!("a picture of {all}"));
                let fits = || memory::lacking(BYTES_PER_PIXEL * all, "a picture of this size");
                if let Some(d) = allowed.or_else(fits) {
                    return Err(d.at(word.span).into());
                }
            }
            "view" => {
                self.camera.theta = args.number("the angle from the z axis")?;
                self.camera.phi = args.number("the angle around the z axis")?;
            }
            "up" => self.camera.up = up(args)?,
            "zoom" => self.camera.zoom = args.positive("zoom")?,
            "perspective" => self.camera.perspective = args.non_negative("the opening angle")?.min(150.0),
            "center" => {
                args.choice("center", &["s", "d"])?;
                self.centre = Some(three(args, "a fraction of the box")?);
            }
            "frame" => {
                self.framing = match args.choice("frame", &["first", "each", "box"])? {
                    "first" => Framing::First,
                    "each" => Framing::Each,
                    _ => Framing::Box,
                }
            }
            "map" => self.map = map(args)?,
            "range" => self.range = [end(args, "min")?, end(args, "max")?],
            "acolor" => {
                let (lo, hi) = args.type_range(cx.world.types)?;
                let colour = colour(args)?;
                self.colours.extend((lo..=hi).map(|k| (k, colour)));
            }
            "adiam" if modify => {
                let (lo, hi) = args.type_range(cx.world.types)?;
                let d = args.positive("the diameter")?;
                self.diameters.extend((lo..=hi).map(|k| (k, d)));
            }
            "adiam" => self.diameter = Some(args.positive("the diameter")?),
            _ => return self.dress(word, args),
        }
        Ok(true)
    }

    /// Keywords for appearance, not content.
    fn dress(&mut self, word: &Word, args: &mut Args) -> Result<bool> {
        match word.text.as_str() {
            "legend" => match args.expect("yes, no or a text")? {
                w if w.text == "yes" => self.legend = true,
                w if w.text == "no" => self.legend = false,
                w => (self.legend, self.legend_text) = (true, Some(spoken(w))),
            },
            "title" => self.title = spoken(args.expect("the title")?),
            "time" => self.time = args.flag("time")?,
            "walls" => self.walls = args.flag("walls")?,
            "scalebar" => self.scale_bar = args.flag("scalebar")?,
            "box" => {
                self.box_edges = args.flag("box")?;
                args.non_negative("the width of the box lines")?;
            }
            "backcolor" => self.look.background = [colour(args)?; 2],
            "backcolor2" => self.look.background[1] = colour(args)?,
            "boxcolor" => self.look.ink = colour(args)?,
            "shiny" => self.look.shiny = fraction(args, "shiny")?,
            "depthcue" => self.look.haze = switched(args, false)?,
            "ssao" => self.look.occlusion = switched(args, true)?,
            "fsaa" => self.look.samples = if args.flag("fsaa")? { 2 } else { 1 },
            "atom" => {
                if !args.flag("atom")? {
                    return fail(
                        Code::NOT_SUPPORTED,
                        word.span,
                        "dump image atom no: there is nothing else to draw",
                    );
                }
            }
            "axes" => {
                if args.flag("axes")? {
                    return fail(Code::NOT_SUPPORTED, word.span, "dump image axes yes");
                }
                while args.peek().is_some_and(|w| w.text.parse::<f64>().is_ok()) {
                    args.next();
                }
            }
            text if ELSEWHERE.contains(&text) => {
                let d = blame(word, Code::NOT_SUPPORTED, format!("dump image keyword `{text}`"));
                return Err(d.help("colours by value: `map NAME` and `range lo hi`").into());
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

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

/// Text for the picture. LAMMPS does not substitute variables within quotes, so outside of quotes `_` stands
/// for a blank.
fn spoken(word: &Word) -> String {
    if word.quoted { word.text.clone() } else { word.text.replace('_', " ") }
}

fn three(args: &mut Args, what: &str) -> Result<[f64; 3]> {
    Ok([args.number(what)?, args.number(what)?, args.number(what)?])
}

fn up(args: &mut Args) -> Result<[f64; 3]> {
    let span = args.here();
    let up = three(args, "a component of the upward direction")?;
    if up == [0.0; 3] {
        return fail(Code::BAD_VALUE, span, "0 0 0 is no direction");
    }
    Ok(up)
}

fn fraction(args: &mut Args, what: &str) -> Result<f32> {
    Ok(args.non_negative(what)?.min(1.0) as f32)
}

/// `yes|no [seed] strength` of LAMMPS' `ssao` and `depthcue`; only the strength has an effect here.
fn switched(args: &mut Args, seed: bool) -> Result<f32> {
    let on = args.flag("the switch")?;
    if seed {
        args.integer("the seed")?;
    }
    let strength = fraction(args, "the strength")?;
    Ok(if on { strength } else { 0.0 })
}

fn end(args: &mut Args, extreme: &str) -> Result<End> {
    if args.eat(extreme) {
        return Ok(End::Extreme);
    }
    let word = args.expect("an end of the range")?;
    parse_number(word, &format!("an end of the range (or `{extreme}`)")).map(End::Number)
}

fn map(args: &mut Args) -> Result<&'static Map> {
    let word = args.expect("a colour map")?;
    if let Some(map) = Map::by_name(&word.text) {
        return Ok(map);
    }
    let d = blame(word, Code::UNKNOWN_NAME, format!("there is no colour map `{}`", word.text));
    Err(match nearest(&word.text, MAPS.iter().map(|m| m.name)) {
        Some(near) => d.help(format!("did you mean `{near}`?")).into(),
        None => {
            let names: Vec<&str> = MAPS.iter().map(|m| m.name).collect();
            d.help(format!("known: {}", names.join(" "))).into()
        }
    })
}

fn colour(args: &mut Args) -> Result<Colour> {
    let word = args.expect("a colour")?;
    match colour_by_name(&word.text) {
        Some(colour) => Ok(colour),
        None => {
            let d = blame(word, Code::UNKNOWN_NAME, format!("there is no colour `{}`", word.text));
            Err(d.help("use a plain name such as red, steel, white, or #rrggbb in quotes").into())
        }
    }
}
