//! A curve as a picture: ours as dots on the line of what was expected, in SVG.

use super::case::Curve;
use super::running::Point;
use std::fmt::Write;

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 320.0;
/// Left, right, top, bottom of the field.
const FIELD: [f64; 4] = [72.0, 548.0, 34.0, 272.0];

/// The range of an axis and where its marks are.
struct Axis {
    from: f64,
    to: f64,
    step: f64,
}

impl Axis {
    /// An axis over these values, with marks at round numbers.
    fn over(values: impl Iterator<Item = f64>) -> Self {
        let finite = values.filter(|v| v.is_finite());
        let (mut from, mut to) =
            finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if from > to {
            (from, to) = (0.0, 1.0);
        }
        if to - from <= 1e-9 * to.abs().max(from.abs()) {
            let half = if to == 0.0 { 1.0 } else { 0.1 * to.abs() };
            (from, to) = (from - half, to + half);
        }
        let rough = (to - from) / 5.0;
        let power = 10_f64.powf(rough.log10().floor());
        let step =
            [1.0, 2.0, 5.0, 10.0].map(|k| k * power).into_iter().find(|s| *s >= rough).unwrap_or(rough);
        // What is past a mark by a fiftieth needs no further one.
        Self { from: (from / step + 0.02).floor() * step, to: (to / step - 0.02).ceil() * step, step }
    }

    fn marks(&self) -> impl Iterator<Item = f64> {
        let count = ((self.to - self.from) / self.step).round() as i32;
        (0..=count).map(|k| self.from + f64::from(k) * self.step)
    }

    /// Where a value lies between the two ends of the field.
    fn place(&self, value: f64, [low, high]: [f64; 2]) -> f64 {
        low + (value - self.from) / (self.to - self.from) * (high - low)
    }

    /// A mark's text: no more digits than the marks need.
    fn text(&self, value: f64) -> String {
        let value = if value.abs() < 1e-9 * self.step { 0.0 } else { value };
        if self.to.abs().max(self.from.abs()) >= 1e5 || self.step < 1e-4 {
            return format!("{value:.1e}");
        }
        let digits = (-self.step.log10().floor()).max(0.0) as usize;
        format!("{value:.digits$}")
    }
}

/// The picture of a curve.
pub fn svg(curve: &Curve, points: &[Point]) -> String {
    let x = Axis::over(points.iter().map(|p| p.0));
    let y = Axis::over(points.iter().flat_map(|p| [Some(p.1), p.2]).flatten());
    let [left, right, top, bottom] = FIELD;
    let at = |a: f64, b: f64| (x.place(a, [left, right]), y.place(b, [bottom, top]));
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <title>{0}</title>\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n",
        escaped(&curve.title)
    );
    for mark in x.marks() {
        let (px, text) = (x.place(mark, [left, right]), x.text(mark));
        let _ = writeln!(
            out,
            "<path d=\"M{px:.1} {bottom}V{top}\" stroke=\"#e4e4e4\"/><text x=\"{px:.1}\" y=\"{}\" text-anchor=\"middle\">{text}</text>",
            bottom + 17.0
        );
    }
    for mark in y.marks() {
        let (py, text) = (y.place(mark, [bottom, top]), y.text(mark));
        let _ = writeln!(
            out,
            "<path d=\"M{left} {py:.1}H{right}\" stroke=\"#e4e4e4\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
            left - 6.0,
            py + 4.0
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n\
         <text transform=\"translate(15 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        0.5 * (left + right),
        HEIGHT - 12.0,
        escaped(&curve.x),
        0.5 * (top + bottom),
        escaped(&curve.y)
    );
    let places: Vec<(f64, f64)> =
        points.iter().filter_map(|p| Some((p.0, p.2?))).map(|(a, b)| at(a, b)).collect();
    if !places.is_empty() {
        out += &expected(curve, &places);
    }
    for &(a, b, _) in points {
        let (px, py) = at(a, b);
        let _ = write!(out, "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"2.8\" fill=\"#1f6fb4\"/>");
    }
    let legend = right - 66.0;
    let _ = writeln!(
        out,
        "\n<circle cx=\"{legend}\" cy=\"17\" r=\"2.8\" fill=\"#1f6fb4\"/><text x=\"{}\" y=\"21\">perigrain</text>\n</svg>",
        legend + 8.0
    );
    out
}

/// What was expected: a line, or marks, and its line in the legend.
fn expected(curve: &Curve, places: &[(f64, f64)]) -> String {
    let left = FIELD[0];
    let mark = |(x, y): (f64, f64)| format!("M{:.1} {y:.1}h10m-5 -5v10", x - 5.0);
    let (drawn, legend) = match curve.marks {
        true => (places.iter().map(|p| mark(*p)).collect::<String>(), mark((left + 12.0, 17.0))),
        false => {
            let line: Vec<String> = places.iter().map(|(x, y)| format!("{x:.1} {y:.1}")).collect();
            (format!("M{}", line.join("L")), format!("M{left} 17h24"))
        }
    };
    format!(
        "<path fill=\"none\" stroke=\"#555\" stroke-width=\"1.6\" d=\"{drawn}{legend}\"/><text x=\"{}\" y=\"21\">{}</text>\n",
        left + 30.0,
        escaped(&curve.expected)
    )
}

/// A text inside HTML or XML.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // XML has no other characters below a blank than these.
            c if c < ' ' && !matches!(c, '\n' | '\t') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_round_marks() {
        let axis = Axis::over([0.03, 0.97].into_iter());
        let marks: Vec<String> = axis.marks().map(|m| axis.text(m)).collect();
        assert_eq!(marks, ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        let axis = Axis::over([-12.0, 13.0].into_iter());
        assert_eq!(
            axis.marks().map(|m| axis.text(m)).collect::<Vec<_>>(),
            ["-15", "-10", "-5", "0", "5", "10", "15"]
        );
        // One value, and none.
        assert!(Axis::over([5.0].into_iter()).from < 5.0);
        assert_eq!(Axis::over(std::iter::empty()).to, 1.0);
    }

    #[test]
    fn texts_are_escaped() {
        assert_eq!(escaped("a<b & \"c\"\u{1}"), "a&lt;b &amp; &quot;c&quot;\u{fffd}");
    }
}
