//! Dump `image`: pictures of the particles.

use super::attribute::{Attribute, Core, Source, attribute};
use super::base::{self, Base, Common, Files, OfFile, OfParticles, Shot};
use super::movie::Paces;
use super::picture::{self, Here, Later, Options, foreign};
use super::{Dump, DumpStyle, MODIFY};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::cformat::general;
use perigrain_lang::args::{blame, parse_number};
use perigrain_lang::{Args, Word};
use perigrain_output::dump::Data;
use perigrain_output::image::{self, Colour, Legend, ScaleBar, Scene, by_kind, edges, render};
use perigrain_output::movie::{Movie, Pace};
use perigrain_plan::Op;
use perigrain_styles::common::about;
use perigrain_styles::words::{Form, Syntax, Words, read_or};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::{World, outline};

/// The style.
pub struct Image;

impl Style for Image {
    fn name(&self) -> &'static str {
        "image"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed(MODIFY, Later::GRAMMAR)] },
            ),
            summary: "Draws the group's particles as shaded spheres every N steps.",
            text: PAGE,
            example: "dump cut all image 200 cut_*.png c_damage auto view 70 -60 map damage range 0 1\n\
                      dump_modify cut region half title \"brittle plate\"",
        }
    }
}

/// The page text.
const PAGE: &str = "The keywords stand here or in `dump_modify`. `dump_modify … region ID` cuts, `thresh` hides, as for \
    `dump custom`. If the box is drawn, it is framed.\n\n\
    The ending of the name says what is written: `.png`, `.jpg` or `.jpeg` (quality 85, as LAMMPS' pictures; there is nothing to \
    choose there either), or `.ppm`; LAMMPS writes PPM under any other name, too.";

/// What the names of pictures end in.
const ENDINGS: [&str; image::ENDINGS.len()] = {
    let (mut all, mut k) = ([""; image::ENDINGS.len()], 0);
    while k < all.len() {
        all[k] = image::ENDINGS[k].0;
        k += 1;
    }
    all
};

/// The line of a dump of pictures.
#[derive(Words)]
pub struct Line {
    #[word(flatten)]
    pub target: OfFile,
    /// `type` or any attribute of `dump custom`.
    #[word(name = "colour", what = "the colour: `type` or an attribute", kind = Kind::Attribute)]
    colour: Word,
    /// A number [length], `type`, an attribute, or `auto`: the diameter of spheres, the edge of a peridynamic particle's cube of volume
    /// times √2 (so that no light falls through a body), else 1.
    #[word(name = "diameter", what = "the diameter: a number, `auto`, `type` or an attribute", kind = Kind::Attribute)]
    diameter: Word,
    #[word(flatten)]
    settings: Here,
}

impl DumpStyle for Image {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        let line: Line = read_or(args, cx, foreign)?;
        let base = Base::new(Files { endings: &ENDINGS, ..Files::any("image") }, &line.target.file, cx)?;
        base.needs_star(line.colour.span, cx)?;
        Ok(Box::new(Declared::new(base, None, line, cx)?))
    }
}

impl Declared {
    /// A dump of what its line says.
    ///
    /// # Errors
    /// Unknown attributes and colours.
    pub fn new(base: Base, pace: Option<Pace>, line: Line, cx: &BuildCx) -> Result<Self> {
        let word = &line.colour;
        let colour = match word.text.as_str() {
            "element" => return Err(blame(word, Code::NOT_SUPPORTED, "colours by element").into()),
            _ => attribute(word, cx)?,
        };
        let word = &line.diameter;
        let size = match word.text.as_str() {
            "element" => return Err(blame(word, Code::NOT_SUPPORTED, "diameters by element").into()),
            "auto" => Size::Auto,
            "type" => Size::ByType,
            text if text.starts_with(|c: char| c.is_ascii_digit() || c == '.') => {
                Size::Number(positive(parse_number(word, "the diameter")?, word)?)
            }
            _ => Size::Attribute(attribute(word, cx)?),
        };
        let mut options = Options::default();
        options.begin(line.settings)?;
        Ok(Declared { base, colour, size, options, pace })
    }
}

fn positive(d: f64, word: &Word) -> Result<f64> {
    if d > 0.0 { Ok(d) } else { fail(Code::BAD_VALUE, word.span, "a diameter must be greater than zero") }
}

/// The diameter of a sphere in pictures. Cells of a body, and spheres as wide as their cell, are drawn with
/// the diameter of the cell's diagonal, so that the body has no gaps.
pub fn auto_diameter(w: &World, i: usize) -> f64 {
    const OVERLAP: f64 = std::f64::consts::SQRT_2;
    let p = &w.particles;
    let edge = if p.style.peri { p.volume[i].cbrt() } else { 0.0 };
    match (p.style.sphere, p.style.peri) {
        (true, _) if (2.0 * p.radius[i] - edge).abs() <= 0.01 * edge => OVERLAP * edge,
        (true, _) => 2.0 * p.radius[i],
        (false, true) => OVERLAP * edge,
        (false, false) => 1.0,
    }
}

/// Source of sphere diameters.
#[derive(Clone, Debug)]
enum Size {
    Auto,
    ByType,
    Number(f64),
    Attribute(Attribute),
}

/// A dump of pictures, as separate files or as a movie.
#[derive(Clone, Debug)]
pub struct Declared {
    base: Base,
    colour: Attribute,
    size: Size,
    options: Options,
    /// Frame rate of a movie; `None` for separate pictures.
    pace: Option<Pace>,
}

impl Dump for Declared {
    fn op(&self, cx: &mut dyn SealCx, every: i64) -> Result<Box<dyn Op>> {
        let mut attributes = vec![self.colour.clone()];
        if let Size::Attribute(a) = &self.size {
            attributes.push(a.clone());
        }
        let dump = self.clone();
        self.base.seal(cx, every, &attributes, move |shot| dump.draw(shot))
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        type Shared = (Common, OfParticles);
        let other = |word: &Word| picture::foreign(word).or_else(|| base::foreign(word));
        let ((common, particles), later) = match &mut self.pace {
            Some(pace) => {
                let (shared, (later, own)): (Shared, (Later, Paces)) = read_or(args, cx, other)?;
                *pace = own.of(*pace);
                (shared, later)
            }
            None => read_or::<(Shared, Later)>(args, cx, other)?,
        };
        let moves = particles.region.is_some() || !particles.thresh.is_empty();
        self.base.modify(common, cx)?;
        self.base.select(particles, cx)?;
        if self.options.modify(later)? || moves {
            self.base.state().view = None;
        }
        Ok(())
    }

    fn doubts(&self, w: &World) -> Option<Diagnostic> {
        let domain = w.domain.as_ref()?;
        let widest = domain.lengths().into_iter().fold(0.0, f64::max);
        let by_type =
            |kind: u16| self.options.diameters.iter().rev().find(|(k, _)| *k == kind).map(|(_, d)| *d);
        let own = || self.options.diameter.or(matches!(self.size, Size::ByType).then_some(1.0));
        let most = (1..=w.types as u16).filter_map(|k| by_type(k).or_else(own)).fold(0.0, f64::max);
        if !matches!(self.size, Size::ByType) || most <= widest || w.unseen.space {
            return None;
        }
        let text = format!(
            "spheres of diameter {}, as `type` draws them, are {} times as wide as the box",
            general(most, 4),
            about(most / widest)
        );
        let d = Diagnostic::warning(Code::SUSPICIOUS, None, text);
        Some(d.help("write `auto` in place of the second `type`: spheres as large as the particles are"))
    }

    fn every(&self) -> Option<i64> {
        self.base.every()
    }

    fn growing(&self) -> bool {
        self.pace.is_some() && self.base.growing()
    }
}

impl Declared {
    fn draw(&self, shot: Shot<'_>) -> Result<()> {
        let w = shot.world;
        let domain = w.domain()?;
        let rows: Vec<usize> = shot.rows.iter().map(|&i| i as usize).collect();
        let positions: Vec<[f64; 3]> = rows.iter().map(|&i| w.particles.x[i]).collect();
        let radii: Vec<f64> = rows.iter().map(|&i| 0.5 * self.diameter(w, &shot.data, i)).collect();
        let (colours, legend) = self.paint(w, &rows, &shot.data[0]);
        let spheres = || positions.iter().copied().zip(radii.iter().copied());
        let view = self.options.view(domain, spheres, &mut shot.state.view);
        let mut lines = if self.options.box_edges { picture::edges(domain) } else { vec![] };
        let walls = if self.options.walls { outline::walls(w) } else { vec![] };
        lines.extend(edges(&walls));
        let bar = self.options.scale_bar.then(|| ScaleBar { units: w.settings.units.lengths() });
        let caption = if self.options.time { picture::time_line(w) } else { String::new() };
        let scene = Scene {
            positions: &positions,
            radii: &radii,
            colours: &colours,
            lines: &lines,
            walls: &walls,
            scale: bar.as_ref(),
            legend: legend.as_ref(),
            title: &self.options.title,
            caption: &caption,
        };
        let path = shot.state.target.pattern.at(shot.step);
        let image = render(&scene, &view, &self.options.look);
        if image.pixels.is_empty() {
            // Interrupted: the run ends, and its files are closed.
            return Ok(());
        }
        if let Some(pace) = self.pace {
            return shot.state.movie.get_or_insert_with(|| Movie::new(path, pace)).add(&image);
        }
        let file = image.file(&path.to_string_lossy());
        perigrain_output::file::replace(&path, |to| to.write_all(&file?))
    }

    fn diameter(&self, w: &World, data: &[Data<'_>], i: usize) -> f64 {
        let p = &w.particles;
        let kind = p.kind[i];
        if let Some((_, d)) = self.options.diameters.iter().rev().find(|(k, _)| *k == kind) {
            return *d;
        }
        if let Some(d) = self.options.diameter {
            return d;
        }
        match &self.size {
            Size::Number(d) => *d,
            Size::ByType => 1.0,
            Size::Attribute(_) => data[1].number(i),
            Size::Auto => auto_diameter(w, i),
        }
    }

    /// Colours of the rows, and their legend.
    fn paint(&self, w: &World, rows: &[usize], data: &Data<'_>) -> (Vec<Colour>, Option<Legend>) {
        let o = &self.options;
        let fixed = |i: usize| {
            let kind = w.particles.kind[i];
            o.colours.iter().rev().find(|(k, _)| *k == kind).map(|(_, c)| *c)
        };
        if self.colour.source == Source::Core(Core::Kind) {
            let of = |i: usize| fixed(i).unwrap_or_else(|| by_kind(w.particles.kind[i] as usize));
            let colours = rows.iter().map(|&i| of(i)).collect();
            let first = |k: u16| rows.iter().find(|&&i| w.particles.kind[i] == k);
            let named = |k: u16| first(k).map(|&i| (of(i), format!("type {k}")));
            let entries: Vec<_> = (1..=w.types as u16).filter_map(named).collect();
            let title = o.legend_title(&self.colour.word);
            let shown = o.legend && (entries.len() > 1 || o.legend_text.is_some());
            return (colours, shown.then_some(Legend::Names { title, entries }));
        }
        let shown = rows.iter().filter(|&&i| fixed(i).is_none()).map(|&i| data.number(i));
        let range = o.range_of(shown);
        let colours =
            rows.iter().map(|&i| fixed(i).unwrap_or_else(|| o.map.of(data.number(i), range))).collect();
        let title = o.legend_title(&self.colour.word);
        (colours, o.legend.then_some(Legend::Scale { title, map: o.map, range }))
    }
}
