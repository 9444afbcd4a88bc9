//! Curves in the terminal: a canvas of braille characters, two dots wide and four high each.

use super::short;
use std::fmt::Write;

/// Characters of a plot, and of what stands left of it.
const WIDTH: usize = 64;
const LEFT: usize = 13;
/// A plot has no fewer, however narrow the screen is.
const NARROWEST: usize = 16;
const HEIGHT: usize = 12;

/// The bits of a braille character by column and row of its dots.
const DOTS: [[u8; 4]; 2] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];

/// A curve with its name.
pub struct Curve<'a> {
    /// Shown in the legend.
    pub name: &'a str,
    /// x and y of each point.
    pub points: Vec<[f64; 2]>,
}

/// Colours of the first, second … curve.
const COLOURS: [&str; 4] = ["\x1b[36m", "\x1b[33m", "\x1b[35m", "\x1b[32m"];

/// Curves over one pair of axes if their ranges are comparable, else one plot for each; on a screen of so many columns.
pub fn plot(curves: &[Curve], across: &str, colours: bool, columns: usize) -> String {
    let width = WIDTH.min(columns.saturating_sub(LEFT)).max(NARROWEST);
    let size = |c: &Curve| range(c, 1).map_or(0.0, |[lo, hi]| hi.abs().max(lo.abs()));
    let (least, most) =
        curves.iter().map(size).fold((f64::INFINITY, 0.0f64), |(a, b), s| (a.min(s), b.max(s)));
    let linear = Marks { logarithmic: false, places: &[], width };
    if curves.len() > 1 && least * 50.0 < most {
        let each = |(k, c)| canvas(std::slice::from_ref(c), k, across, colours, &linear);
        return curves.iter().enumerate().map(each).collect::<Vec<_>>().join("\n");
    }
    canvas(curves, 0, across, colours, &linear)
}

/// Curves over logarithmic axes, with characters that mark places on them. Coordinates are above zero.
pub fn logarithmic(curves: &[Curve], places: &[([f64; 2], char)], across: &str, colours: bool) -> String {
    let log = |p: &[f64; 2]| p.map(f64::log10);
    let curves: Vec<Curve> =
        curves.iter().map(|c| Curve { name: c.name, points: c.points.iter().map(log).collect() }).collect();
    let places: Vec<_> = places.iter().map(|(p, c)| (log(p), *c)).collect();
    canvas(&curves, 0, across, colours, &Marks { logarithmic: true, places: &places, width: WIDTH })
}

/// What stands over the curves, how wide they are, and whether coordinates are logarithms.
struct Marks<'a> {
    logarithmic: bool,
    width: usize,
    places: &'a [([f64; 2], char)],
}

fn canvas(curves: &[Curve], first: usize, across: &str, colours: bool, marks: &Marks) -> String {
    let over = |d| {
        curves.iter().filter_map(|c| range(c, d)).reduce(|a: [f64; 2], b| [a[0].min(b[0]), a[1].max(b[1])])
    };
    let width = marks.width;
    let (Some(x), Some(y)) = (over(0), over(1)) else { return "nothing to draw: no finite numbers\n".into() };
    // The character's dots, and which curve was drawn there last.
    let mut cells = vec![(0u8, 0usize); width * HEIGHT];
    for (k, curve) in curves.iter().enumerate() {
        let finite: Vec<&[f64; 2]> =
            curve.points.iter().filter(|p| p.iter().all(|a| a.is_finite())).collect();
        for pair in finite.windows(2).chain(finite.chunks(1).take(1)) {
            let from = dot(*pair[0], x, y, width);
            let to = pair.get(1).map_or(from, |p| dot(**p, x, y, width));
            line(from, to, |[u, v]| {
                let cell = &mut cells[v / 4 * width + u / 2];
                *cell = (cell.0 | DOTS[u % 2][v % 4], first + k);
            });
        }
    }
    let over = |row: usize| {
        let on = marks.places.iter().filter(|(p, _)| p.iter().all(|a| a.is_finite()));
        let cell = on.map(|(p, c)| (dot(*p, x, y, width), *c));
        cell.filter(|([_, v], _)| v / 4 == row).map(|([u, _], c)| (u / 2, c)).collect::<Vec<_>>()
    };
    let number = |a: f64| if marks.logarithmic { short(10f64.powf(a)) } else { label_of(a, y) };
    let mut out = String::new();
    for (k, row) in cells.chunks(width).enumerate() {
        let label = match k {
            0 => number(y[1]),
            _ if k == HEIGHT - 1 => number(y[0]),
            _ => String::new(),
        };
        let _ = writeln!(out, "{label:>11} ┤{}", characters(row, &over(k), colours));
    }
    let end = |a: f64| short(if marks.logarithmic { 10f64.powf(a) } else { a });
    let (left, right) = (end(x[0]), end(x[1]));
    let gap = width.saturating_sub(left.len() + right.len());
    let _ = writeln!(out, "{:>11} └{}", "", "─".repeat(width));
    let _ = writeln!(out, "{:>12} {left}{across:^gap$}{right}", "");
    let names: Vec<String> = curves
        .iter()
        .enumerate()
        .map(|(k, c)| {
            if colours {
                format!("{}── {}\x1b[0m", colour(first + k), c.name)
            } else {
                c.name.to_string()
            }
        })
        .collect();
    let _ = writeln!(out, "{:>12} {}", "", names.join("   "));
    out
}

/// A number with digits enough to distinguish the ends of its range.
fn label_of(a: f64, [lo, hi]: [f64; 2]) -> String {
    let size = hi.abs().max(lo.abs());
    let (text, width) = (short(a), hi - lo);
    if width <= 0.0 || width * 200.0 > size || size.log10().abs() > 4.0 {
        return text;
    }
    let digits = (2.0 - width.log10()).ceil().clamp(0.0, 9.0) as usize;
    format!("{a:.digits$}")
}

fn colour(k: usize) -> &'static str {
    COLOURS[k % COLOURS.len()]
}

fn characters(row: &[(u8, usize)], over: &[(usize, char)], colours: bool) -> String {
    let one = |(at, &(dots, k)): (usize, &(u8, usize))| {
        if let Some((_, mark)) = over.iter().find(|(cell, _)| *cell == at) {
            return mark.to_string();
        }
        let c = char::from_u32(0x2800 + u32::from(dots)).unwrap_or(' ');
        match dots {
            0 => " ".to_string(),
            _ if colours => format!("{}{c}\x1b[0m", colour(k)),
            _ => c.to_string(),
        }
    };
    row.iter().enumerate().map(one).collect::<String>().trim_end().to_string()
}

/// Smallest and largest finite value in a direction.
fn range(c: &Curve, d: usize) -> Option<[f64; 2]> {
    let finite = c.points.iter().filter(|p| p.iter().all(|a| a.is_finite())).map(|p| p[d]);
    finite.map(|a| [a, a]).reduce(|r, a| [r[0].min(a[0]), r[1].max(a[1])])
}

/// The dot a point falls on, from the top left.
fn dot(p: [f64; 2], x: [f64; 2], y: [f64; 2], across: usize) -> [usize; 2] {
    let along = |a: f64, r: [f64; 2], n: usize| {
        let width = r[1] - r[0];
        let t = if width > 0.0 { (a - r[0]) / width } else { 0.5 };
        (t * (n - 1) as f64).round() as usize
    };
    [along(p[0], x, 2 * across), 4 * HEIGHT - 1 - along(p[1], y, 4 * HEIGHT)]
}

/// All dots of a straight line.
fn line(from: [usize; 2], to: [usize; 2], mut set: impl FnMut([usize; 2])) {
    let steps = from[0].abs_diff(to[0]).max(from[1].abs_diff(to[1])).max(1);
    for k in 0..=steps {
        let t = k as f64 / steps as f64;
        let at = |d: usize| (from[d] as f64 + t * (to[d] as f64 - from[d] as f64)).round() as usize;
        set([at(0), at(1)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rising_line_goes_from_bottom_left_to_top_right() {
        let text = plot(&[Curve { name: "pe", points: vec![[0.0, 0.0], [10.0, 2.5]] }], "step", false, 80);
        let lines: Vec<&str> = text.lines().collect();
        assert!(
            lines[0].trim_start().starts_with("2.5 ┤") && lines[0].ends_with('⠉')
                || lines[0].ends_with('⠁')
                || lines[0].ends_with('⠈'),
            "{text}"
        );
        assert!(lines[HEIGHT - 1].trim_start().starts_with("0 ┤"), "{text}");
        assert!(lines[HEIGHT + 1].contains("step") && lines[HEIGHT + 1].trim_end().ends_with("10"), "{text}");
        assert!(text.trim_end().ends_with("pe"));
    }

    #[test]
    fn a_narrow_screen_has_a_narrow_plot() {
        let curve = || Curve { name: "pe", points: vec![[0.0, 0.0], [10.0, 2.5]] };
        let widest = |columns| {
            plot(&[curve()], "step", false, columns).lines().map(|l| l.trim_end().chars().count()).max()
        };
        assert_eq!([80, 60, 5].map(widest), [Some(77), Some(60), Some(29)]);
    }

    #[test]
    fn curves_of_other_size_get_their_own_axes() {
        let curves = |big: f64| {
            [
                Curve { name: "a", points: vec![[0.0, 1.0], [1.0, 2.0]] },
                Curve { name: "b", points: vec![[0.0, 1.0], [1.0, big]] },
            ]
        };
        assert_eq!(plot(&curves(3.0), "step", false, 80).matches('└').count(), 1);
        assert_eq!(plot(&curves(300.0), "step", false, 80).matches('└').count(), 2);
    }

    #[test]
    fn a_power_is_a_straight_line_over_logarithms() {
        let points: Vec<[f64; 2]> = [1.0, 10.0, 100.0].map(|x| [x, 1e-2 / x]).to_vec();
        let places: Vec<_> = points.iter().zip(['a', 'a', 'A']).map(|(p, c)| (*p, c)).collect();
        let text = logarithmic(&[Curve { name: "e", points }], &places, "seconds", false);
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].starts_with("       0.01 ┤a") && lines[HEIGHT - 1].ends_with('A'), "{text}");
        let middle = lines.iter().position(|l| l.contains('a') && !l.contains("┤a")).unwrap();
        assert!((HEIGHT / 2 - 1..=HEIGHT / 2).contains(&middle), "{text}");
    }

    #[test]
    fn labels_distinguish_the_ends() {
        let text = plot(&[Curve { name: "z", points: vec![[0.0, 0.9], [1.0, 0.89998]] }], "step", false, 80);
        assert!(text.contains("0.9000000 ┤") && text.contains("0.8999800 ┤"), "{text}");
    }

    #[test]
    fn odd_numbers_do_no_harm() {
        let points = vec![[0.0, f64::NAN], [1.0, 5.0]];
        assert!(plot(&[Curve { name: "a", points }], "step", true, 80).contains('┤'));
        assert!(plot(&[Curve { name: "a", points: vec![] }], "step", false, 80).contains("nothing"));
        assert!(
            plot(&[Curve { name: "a", points: vec![[1.0, f64::INFINITY]] }], "step", false, 80)
                .contains("nothing")
        );
    }
}
