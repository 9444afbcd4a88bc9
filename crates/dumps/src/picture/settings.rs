//! The keywords of pictures, in the line of a dump and in `dump_modify`.

use super::{End, Framing, Options};
use perigrain_base::diag::{Code, Diagnostics, Result, fail, nearest};
use perigrain_base::gate;
use perigrain_lang::args::blame;
use perigrain_lang::{Args, Word};
use perigrain_output::image::{Colour, MAPS, Map, colour_by_name};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{At, Kind, Or, Types, Value, Words};
use perigrain_world::memory;

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

/// Bytes per pixel until the picture is written: depths and colours of four samples, depths for the shading,
/// final colour, and compressed bytes.
const BYTES_PER_PIXEL: f64 = 46.0;

/// The longest side of a picture: viewers and memory set this limit.
const LONGEST: i64 = 16384;

/// A side of a picture.
#[derive(Clone, Copy)]
struct Pixels(usize);

impl Value for Pixels {
    const KIND: Kind = Kind::Whole;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let (span, n) = (args.here(), args.integer_from(16, what)?);
        match n > LONGEST {
            true => fail(Code::BAD_VALUE, span, format!("{what} is at most {LONGEST}, not {n}")),
            false => Ok(Self(n as usize)),
        }
    }
}

/// The keywords of pictures, here and in `dump_modify`.
#[derive(Words)]
pub struct Settings {
    /// A fixed colour for a type, also beside values.
    #[word(keyword, name = "TYPE COLOUR")]
    acolor: Vec<(Types, Tint)>,
    /// `yes` alone: there is nothing else to draw.
    #[word(keyword, what = "atom", placed)]
    atom: Option<At<bool>>,
    /// `no` alone.
    #[word(keyword, name = "no", placed)]
    axes: Option<At<Axes>>,
    /// The background, by name or as `"#rrggbb"` in quotes.
    #[word(keyword, name = "C")]
    backcolor: Option<At<Tint>>,
    /// The lower end of a background that changes from top to bottom.
    #[word(keyword, name = "C")]
    backcolor2: Option<At<Tint>>,
    /// Whether the box is drawn; the width of its lines has no effect.
    #[word(keyword = "box", name = "yes|no d", what = "box")]
    box_edges: Option<(bool, Breadth)>,
    /// Lines and text.
    #[word(keyword, name = "C")]
    boxcolor: Option<Tint>,
    /// The centre of the picture in fractions of the box.
    #[word(keyword)]
    center: Option<Anchor>,
    /// How much fades with distance, from 0 to 1.
    #[word(keyword, name = "yes|no strength", what = "the switch")]
    depthcue: Option<(bool, Strength)>,
    #[word(keyword, shown = "first")]
    frame: Option<Framing>,
    /// Edges are smoothed.
    #[word(keyword, what = "fsaa")]
    fsaa: Option<bool>,
    /// Whether there is a legend, or its text.
    #[word(keyword, name = "text", what = "yes, no or a text", shown = "yes")]
    legend: Option<Or<YesNo, Spoken>>,
    /// The colours of values: damage viridis plasma inferno coolwarm grey.
    #[word(keyword, name = "NAME", with = map, kind = Kind::Text, shown = "viridis")]
    map: Option<&'static Map>,
    /// The opening angle, 0 for parallel rays [degrees].
    #[word(keyword, name = "angle", what = "the opening angle", non_negative)]
    perspective: Option<f64>,
    /// The ends of the colours.
    #[word(keyword, name = "lo hi", what = "an end of the range", shown = "min max")]
    range: Option<(Or<Min, f64>, Or<Max, f64>)>,
    /// Whether a scale bar is shown below the picture.
    #[word(keyword, what = "scalebar", shown = "yes")]
    scalebar: Option<bool>,
    /// How much spheres shine, from 0 to 1.
    #[word(keyword, name = "strength", what = "shiny", non_negative)]
    shiny: Option<f64>,
    /// Width and height [pixels].
    #[word(keyword, name = "width height", what = "the {} in pixels", placed, shown = "1280 960")]
    size: Option<At<[Pixels; 2]>>,
    /// Shade in gaps, from 0 to 1; the seed has no effect.
    #[word(keyword, name = "yes|no seed strength", what = "the {}")]
    ssao: Option<(Switch, i64, Strength)>,
    /// Whether the time stands below the picture.
    #[word(keyword, what = "time", shown = "yes")]
    time: Option<bool>,
    /// Text at the top, in quotes, or with `_` for blanks where variables are to be put in.
    #[word(keyword, name = "text", what = "the title")]
    title: Option<Spoken>,
    /// The upward direction.
    #[word(keyword, name = "x y z", what = "a component of the upward direction")]
    up: Option<At<[f64; 3]>>,
    /// Angles from the z axis and around it [degrees].
    #[word(keyword, name = "theta phi", what = "the angle {}", shown = "60 30")]
    view: Option<[f64; 2]>,
    /// Whether walls of grains are drawn, through which one sees.
    #[word(keyword, what = "walls", shown = "yes")]
    walls: Option<bool>,
    #[word(keyword, name = "f", what = "zoom", positive)]
    zoom: Option<f64>,
}

/// The same as they stand in a line that declares a dump.
#[derive(Words)]
pub struct Here {
    #[word(flatten)]
    settings: Settings,
    /// The diameter of all spheres [length].
    #[word(keyword, name = "d", what = "the diameter", positive)]
    adiam: Option<f64>,
}

/// The same as they stand in `dump_modify`.
#[derive(Words)]
pub struct Later {
    #[word(flatten)]
    settings: Settings,
    /// The diameter of a type [length].
    #[word(keyword, name = "TYPE d", what = "the diameter")]
    adiam: Vec<(Types, Diameter)>,
}

/// Where the centre is: LAMMPS' two words for a fixed and a moving one do the same here.
#[derive(Words)]
#[word(what = "center")]
enum Anchor {
    S(#[word(name = "x y z", what = "a fraction of the box")] [f64; 3]),
    D(#[word(name = "x y z", what = "a fraction of the box")] [f64; 3]),
}

/// `yes` or `no`.
#[derive(Words)]
enum YesNo {
    Yes,
    No,
}

/// The smallest value.
#[derive(Words)]
enum Min {
    Min,
}

/// The largest value.
#[derive(Words)]
enum Max {
    Max,
}

macro_rules! words {
    ($($(#[$about:meta])* $name:ident($ty:ty), $kind:expr, $read:expr;)*) => {$(
        $(#[$about])*
        struct $name($ty);

        impl Value for $name {
            const KIND: Kind = $kind;
            fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
                let read: fn(&str, &mut Args) -> Result<$ty> = $read;
                read(what, args).map(Self)
            }
        }
    )*};
}
words! {
    /// Text for the picture.
    Spoken(String), Kind::Text, |what, args| args.expect(what).map(spoken);
    /// A colour.
    Tint(Colour), Kind::Text, |_, args| colour(args);
    /// A share of the most that there can be.
    Strength(f64), Kind::Number, |_, args| args.non_negative("the strength");
    /// A diameter.
    Diameter(f64), Kind::Number, |what, args| args.positive(what);
    /// `yes` or `no`.
    Switch(bool), Kind::Switch, |_, args| args.flag("the switch");
    /// Whether there are axes; numbers behind it have no effect.
    Axes(bool), Kind::Switch, |_, args| {
        let axes = args.flag("axes")?;
        while args.peek().is_some_and(|w| w.text.parse::<f64>().is_ok()) {
            args.next();
        }
        Ok(axes)
    };
}

/// A width without effect.
struct Breadth;

impl Value for Breadth {
    const KIND: Kind = Kind::Number;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.non_negative("the width of the box lines").map(|_| Self)
    }
}

impl Settings {
    /// Whether a picture that keeps its view is framed anew.
    fn moves(&self) -> bool {
        self.view.is_some()
            || self.up.is_some()
            || self.zoom.is_some()
            || self.center.is_some()
            || self.perspective.is_some()
            || self.frame.is_some()
            || self.size.is_some()
    }
}

/// Refuses LAMMPS' keywords of pictures by name.
pub fn foreign(word: &Word) -> Option<Diagnostics> {
    ELSEWHERE.contains(&word.text.as_str()).then(|| {
        let d = blame(word, Code::NOT_SUPPORTED, format!("dump image keyword `{}`", word.text));
        d.help("colours by value: `map NAME` and `range lo hi`").into()
    })
}

impl Options {
    /// Takes the keywords of the line that declares a dump.
    ///
    /// # Errors
    /// What there is not.
    pub fn begin(&mut self, here: Here) -> Result<()> {
        self.diameter = here.adiam.or(self.diameter);
        self.set(here.settings)
    }

    /// Takes the keywords of `dump_modify`; whether the picture is framed anew.
    ///
    /// # Errors
    /// What there is not.
    pub fn modify(&mut self, later: Later) -> Result<bool> {
        let moves = later.settings.moves() || !later.adiam.is_empty();
        for (Types(lo, hi), Diameter(d)) in later.adiam {
            self.diameters.extend((lo..=hi).map(|k| (k, d)));
        }
        self.set(later.settings)?;
        Ok(moves)
    }

    fn set(&mut self, given: Settings) -> Result<()> {
        if let Some(At { span, .. }) = given.atom.filter(|a| !a.value) {
            return fail(Code::NOT_SUPPORTED, span, "dump image atom no: there is nothing else to draw");
        }
        if let Some(At { span, .. }) = given.axes.as_ref().filter(|a| a.value.0) {
            return fail(Code::NOT_SUPPORTED, *span, "dump image axes yes");
        }
        self.place(&given)?;
        self.dress(&given);
        for (Types(lo, hi), Tint(colour)) in given.acolor {
            self.colours.extend((lo..=hi).map(|k| (k, colour)));
        }
        match given.legend {
            Some(Or::Word(YesNo::Yes)) => self.legend = true,
            Some(Or::Word(YesNo::No)) => self.legend = false,
            Some(Or::Else(Spoken(text))) => (self.legend, self.legend_text) = (true, Some(text)),
            None => {}
        }
        self.title = given.title.map_or_else(|| std::mem::take(&mut self.title), |t| t.0);
        if let Some((lo, hi)) = given.range {
            self.range = [
                if let Or::Else(lo) = lo { End::Number(lo) } else { End::Extreme },
                if let Or::Else(hi) = hi { End::Number(hi) } else { End::Extreme },
            ];
        }
        Ok(())
    }

    /// Takes what decides where the camera stands, and how large pictures are.
    fn place(&mut self, given: &Settings) -> Result<()> {
        if let Some(At { value: [Pixels(width), Pixels(height)], span, .. }) = given.size {
            let all = width as f64 * height as f64;
            let allowed = gate::beyond(all, |l| l.pixels, "pixels", &format!("a picture of {all}"));
            let fits = || memory::lacking(BYTES_PER_PIXEL * all, "a picture of this size");
            if let Some(d) = allowed.or_else(fits) {
                return Err(d.at(span).into());
            }
            (self.look.width, self.look.height) = (width, height);
        }
        if let Some(At { value: up, span, unknown }) = given.up {
            if up == [0.0; 3] && !unknown {
                return fail(Code::BAD_VALUE, span, "0 0 0 is no direction");
            }
            self.camera.up = up;
        }
        if let Some([theta, phi]) = given.view {
            (self.camera.theta, self.camera.phi) = (theta, phi);
        }
        self.camera.zoom = given.zoom.unwrap_or(self.camera.zoom);
        self.camera.perspective = given.perspective.map_or(self.camera.perspective, |angle| angle.min(150.0));
        if let Some(Anchor::S(centre) | Anchor::D(centre)) = given.center {
            self.centre = Some(centre);
        }
        self.framing = given.frame.unwrap_or(self.framing);
        Ok(())
    }

    /// Takes what decides about appearance, not content.
    fn dress(&mut self, given: &Settings) {
        let look = &mut self.look;
        if let Some(At { value: Tint(colour), .. }) = given.backcolor {
            look.background = [colour; 2];
        }
        let later = |b: &&At<Tint>| given.backcolor.as_ref().is_none_or(|a| a.span.start < b.span.start);
        if let Some(At { value: Tint(colour), .. }) = given.backcolor2.as_ref().filter(later) {
            look.background[1] = *colour;
        }
        look.ink = given.boxcolor.as_ref().map_or(look.ink, |c| c.0);
        look.shiny = given.shiny.map_or(look.shiny, share);
        look.samples = given.fsaa.map_or(look.samples, |smooth| if smooth { 2 } else { 1 });
        let part = |on: bool, strength: f64| if on { share(strength) } else { 0.0 };
        look.haze = given.depthcue.as_ref().map_or(look.haze, |(on, s)| part(*on, s.0));
        look.occlusion = given.ssao.as_ref().map_or(look.occlusion, |(on, _, s)| part(on.0, s.0));
        self.map = given.map.unwrap_or(self.map);
        self.time = given.time.unwrap_or(self.time);
        self.walls = given.walls.unwrap_or(self.walls);
        self.scale_bar = given.scalebar.unwrap_or(self.scale_bar);
        self.box_edges = given.box_edges.as_ref().map_or(self.box_edges, |b| b.0);
    }
}

/// Text for the picture. LAMMPS does not substitute variables within quotes, so outside of quotes `_` stands
/// for a blank.
fn spoken(word: &Word) -> String {
    if word.quoted { word.text.clone() } else { word.text.replace('_', " ") }
}

/// A number as a share of the most that there can be.
fn share(strength: f64) -> f32 {
    strength.min(1.0) as f32
}

fn map(args: &mut Args, _: &BuildCx) -> Result<&'static Map> {
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
