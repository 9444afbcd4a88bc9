//! A chart as SVG, without anything from elsewhere.

use super::{Chart, End, INK, Shape, WIDTH};
use std::fmt::Write;

impl Chart {
    /// The chart as SVG.
    pub fn svg(&self) -> String {
        let drawing = self.drawing();
        let height = drawing.height;
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" font-family=\"sans-serif\" \
             font-size=\"12\" fill=\"#{INK:06x}\">\n<title>{}</title>\n<rect width=\"{WIDTH}\" height=\"{height}\" fill=\"white\"/>\n",
            escaped(&drawing.title)
        );
        drawing.shapes.iter().for_each(|shape| shape.svg(&mut out));
        out + "</svg>\n"
    }
}

impl Shape {
    fn svg(&self, out: &mut String) {
        // Writing to a string does not fail.
        let _ = match self {
            Self::Path { points, width, colour } => {
                let places: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
                let path = places.join("L");
                writeln!(
                    out,
                    "<path fill=\"none\" stroke=\"#{colour:06x}\" stroke-width=\"{width}\" d=\"M{path}\"/>"
                )
            }
            Self::Dot { at: [x, y], radius, colour } => {
                writeln!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"#{colour:06x}\"/>")
            }
            Self::Words { at: [x, y], end, text } => {
                let anchor = match end {
                    End::Left => "",
                    End::Middle => " text-anchor=\"middle\"",
                    End::Right => " text-anchor=\"end\"",
                };
                writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\"{anchor}>{}</text>", escaped(text))
            }
            Self::Upright { at: [x, y], text } => writeln!(
                out,
                "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
                escaped(text)
            ),
        };
    }
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
    fn texts_are_escaped() {
        assert_eq!(escaped("a<b & \"c\"\u{1}"), "a&lt;b &amp; &quot;c&quot;\u{fffd}");
    }
}
