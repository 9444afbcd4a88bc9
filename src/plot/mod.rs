//! Charts: curves over two axes, laid out once, drawn as SVG, as PNG and in the terminal; the frame of web pages.

mod axis;
mod png;
mod svg;
pub mod terminal;
mod web;

use axis::Axis;
pub use svg::escaped;
pub use web::page;

/// Width of a chart; its height grows with its legend.
const WIDTH: f64 = 560.0;
/// Left and right end of the field, and its height.
const FIELD: [f64; 2] = [72.0, 540.0];
const HEIGHT: f64 = 238.0;
/// Room above the field for each line of the legend.
const LINE: f64 = 17.0;
/// About the width of a character of a legend.
const LETTER: f64 = 6.6;

const GRID: u32 = 0xe4_e4e4;
const INK: u32 = 0x22_2222;
/// What is measured.
pub const BLUE: u32 = 0x1f_6fb4;
/// What is expected.
pub const GREY: u32 = 0x55_5555;
/// Colours of the first, second … curve.
pub const COLOURS: [u32; 6] = [BLUE, 0xc4_5a1b, 0x2e_8b57, 0x8e_44ad, 0xb0_8a00, 0x00_8b9a];

/// Curves over one pair of axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// Label of the horizontal axis.
    pub x: String,
    /// Label of the vertical axis.
    pub y: String,
    /// Both axes are logarithmic, and all coordinates above zero.
    pub logarithmic: bool,
    /// What is drawn, the first below the others.
    pub curves: Vec<Curve>,
}

/// One of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Its line of the legend.
    pub name: String,
    /// x and y of each point.
    pub points: Vec<[f64; 2]>,
    /// How it is drawn.
    pub look: Look,
    /// As 0xrrggbb.
    pub colour: u32,
}

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// A line through its points.
    Line,
    /// A dot at each.
    Dots,
    /// A cross at each.
    Crosses,
    /// A line and dots.
    Chain,
    /// A ring round each.
    Rings,
}

/// What a drawing is made of; places from the upper left.
enum Shape {
    Path {
        points: Vec<[f64; 2]>,
        width: f64,
        colour: u32,
    },
    Dot {
        at: [f64; 2],
        radius: f64,
        colour: u32,
    },
    Words {
        at: [f64; 2],
        end: End,
        text: String,
    },
    /// Upwards, the middle at the place.
    Upright {
        at: [f64; 2],
        text: String,
    },
}

/// Which part of a text is at its place.
#[derive(Clone, Copy)]
enum End {
    Left,
    Middle,
    Right,
}

/// A laid out chart.
struct Drawing {
    title: String,
    height: f64,
    shapes: Vec<Shape>,
}

impl Chart {
    fn drawing(&self) -> Drawing {
        let (mut shapes, top) = self.legend();
        let bottom = top + HEIGHT;
        let all = || self.curves.iter().flat_map(|c| &c.points);
        let axis = |d: usize| {
            let values = all().map(|p| p[d]);
            if self.logarithmic { Axis::logarithmic(values) } else { Axis::over(values) }
        };
        let (x, y) = (axis(0), axis(1));
        let path = |points: Vec<[f64; 2]>, colour| Shape::Path { points, width: 1.0, colour };
        for (mark, text) in &x.marks {
            let across = x.place(*mark, FIELD);
            shapes.push(path(vec![[across, bottom], [across, top]], GRID));
            shapes.push(Shape::Words { at: [across, bottom + 17.0], end: End::Middle, text: text.clone() });
        }
        for (mark, text) in &y.marks {
            let up = y.place(*mark, [bottom, top]);
            shapes.push(path(vec![[FIELD[0], up], [FIELD[1], up]], GRID));
            shapes.push(Shape::Words { at: [FIELD[0] - 6.0, up + 4.0], end: End::Right, text: text.clone() });
        }
        let middle = 0.5 * (FIELD[0] + FIELD[1]);
        shapes.push(Shape::Words { at: [middle, bottom + 36.0], end: End::Middle, text: self.x.clone() });
        shapes.push(Shape::Upright { at: [15.0, 0.5 * (top + bottom)], text: self.y.clone() });
        for curve in &self.curves {
            let finite = curve.points.iter().filter(|p| p.iter().all(|a| a.is_finite()));
            let places = finite.map(|p| [x.place_of(p[0], FIELD), y.place_of(p[1], [bottom, top])]);
            curve.draw(&places.collect::<Vec<_>>(), &mut shapes);
        }
        Drawing { title: self.title.clone(), height: bottom + 48.0, shapes }
    }

    /// The legend's lines, and where the field below them begins.
    fn legend(&self) -> (Vec<Shape>, f64) {
        let mut shapes = vec![];
        let (mut at, mut line) = ([FIELD[0], LINE], 0);
        for curve in &self.curves {
            let width = 44.0 + LETTER * curve.name.chars().count() as f64;
            if at[0] + width > FIELD[1] + 24.0 && at[0] > FIELD[0] {
                line += 1;
                at = [FIELD[0], LINE * f64::from(1 + line)];
            }
            let middle = [at[0] + 12.0, at[1]];
            match curve.look {
                Look::Line | Look::Chain => curve.draw(&[at, [at[0] + 24.0, at[1]]], &mut shapes),
                _ => curve.draw(&[middle], &mut shapes),
            }
            let place = [at[0] + 31.0, at[1] + 4.0];
            shapes.push(Shape::Words { at: place, end: End::Left, text: curve.name.clone() });
            at[0] += width;
        }
        (shapes, LINE * f64::from(2 + line))
    }
}

impl Curve {
    /// Draws it through these places.
    fn draw(&self, places: &[[f64; 2]], shapes: &mut Vec<Shape>) {
        let (colour, width) = (self.colour, 1.6);
        if matches!(self.look, Look::Line | Look::Chain) {
            shapes.push(Shape::Path { points: places.to_vec(), width, colour });
        }
        for &[x, y] in places {
            match self.look {
                Look::Line => {}
                Look::Dots | Look::Chain => shapes.push(Shape::Dot { at: [x, y], radius: 2.8, colour }),
                Look::Crosses => {
                    shapes.push(Shape::Path { points: vec![[x - 5.0, y], [x + 5.0, y]], width, colour });
                    shapes.push(Shape::Path { points: vec![[x, y - 5.0], [x, y + 5.0]], width, colour });
                }
                Look::Rings => {
                    let corner = |k: i32| {
                        let (sin, cos) = (f64::from(k) * std::f64::consts::PI / 12.0).sin_cos();
                        [x + 5.5 * cos, y + 5.5 * sin]
                    };
                    shapes.push(Shape::Path { points: (0..=24).map(corner).collect(), width, colour });
                }
            }
        }
    }
}

/// A number in at most some nine characters.
pub fn short(a: f64) -> String {
    let plain = a == 0.0 || (1e-3..1e5).contains(&a.abs());
    if plain { format!("{}", (a * 1e4).round() / 1e4) } else { format!("{a:.3e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        let points = [1.0, 10.0, 100.0].map(|x| [x, 1e-2 / x]).to_vec();
        let curve =
            |name: &str, look| Curve { name: name.into(), points: points.clone(), look, colour: BLUE };
        let curves = vec![
            curve("a & b", Look::Chain),
            curve("front", Look::Rings),
            curve("a name that takes a line of its own, as long as it is", Look::Crosses),
        ];
        Chart { title: "t".into(), x: "x".into(), y: "y".into(), logarithmic: true, curves }
    }

    #[test]
    fn a_chart_is_drawn_as_svg_and_png() {
        let svg = chart().svg();
        assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"), "{svg}");
        assert!(svg.contains("a &amp; b") && svg.contains(">1e-3<") && svg.contains(">100<"), "{svg}");
        // A power is a straight line: the middle point is half way.
        assert!(svg.contains("M72.0 51.0L306.0 170.0L540.0 289.0"), "{svg}");
        let png = chart().png().unwrap();
        assert_eq!(&png[1..4], b"PNG");
        assert_eq!(Chart::default().svg().matches("<text").count(), 14, "an empty one has axes");
    }
}
