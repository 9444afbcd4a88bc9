//! `:slice FORMULA x|y|z AT [WIDTH]`: a cut through the particles, coloured by a formula.

use super::picture::{Ink, Picture, Pixel, legend};
use crate::cli::progress::short;
use crate::session::Session;
use perigrain_output::image::Map;

/// Pixels (half characters) down at most.
const HEIGHT: f64 = 56.0;

/// A particle in the cut: its place there, its width, its value.
type Dot = ([f64; 2], f64, f64);

/// The cut as text of so many characters across at most, or what is wrong with the words.
///
/// # Errors
/// Words that make no cut; the formula's own mistakes come as a rendered text.
pub fn slice(words: &[&str], session: &mut Session, ink: Ink, width: usize) -> Result<String, String> {
    let usage = || "write `:slice FORMULA x|y|z AT [WIDTH]`, as `:slice c_damage z 0`".to_string();
    let (formula, axis, rest) = match words {
        [formula, axis, rest @ ..] if (1..=2).contains(&rest.len()) => (formula, axis, rest),
        _ => return Err(usage()),
    };
    let Some(axis) = ["x", "y", "z"].iter().position(|a| a == axis) else { return Err(usage()) };
    let number = |w: &&str| w.parse::<f64>().ok().filter(|a| a.is_finite());
    let numbers: Vec<f64> = rest.iter().filter_map(number).collect();
    let (Some(&at), true) = (numbers.first(), numbers.len() == rest.len()) else { return Err(usage()) };
    let values = session
        .per_particle(formula)
        .map_err(|e| perigrain_base::diag::render::plain(&e, &session.sources))?;
    let widths = session.widths();
    let places = &session.world.particles.x;
    let (u, v) = [(1, 2), (0, 2), (0, 1)][axis];
    let near = |i: &usize| (places[*i][axis] - at).abs() <= numbers.get(1).map_or(widths[*i], |w| *w) / 2.0;
    let dots: Vec<Dot> = (0..places.len())
        .filter(near)
        .map(|i| ([places[i][u], places[i][v]], widths[i], values[i]))
        .collect();
    let names = ["x", "y", "z"];
    if dots.is_empty() {
        let over = places
            .iter()
            .map(|x| x[axis])
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
        let name = names[axis];
        return Err(match places.is_empty() {
            true => "there are no particles".into(),
            false => format!(
                "no particle at {name} = {}: they lie from {} to {}",
                short(at),
                short(over[0]),
                short(over[1])
            ),
        });
    }
    let finite = dots.iter().map(|d| d.2).filter(|a| a.is_finite());
    let range = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
    let map = Map::by_name("viridis").ok_or("there is no colour map")?;
    let title = format!("{formula} at {} = {}, {} across, {} up", names[axis], short(at), names[u], names[v]);
    Ok(format!("{title}\n{}{}", draw(&dots, map, range, width as f64).text(ink), legend(map, range, ink)))
}

/// The particles as squares of their width.
fn draw(dots: &[Dot], map: &Map, range: [f64; 2], across: f64) -> Picture {
    let mut lo = [f64::INFINITY; 2];
    let mut hi = [f64::NEG_INFINITY; 2];
    for (p, width, _) in dots {
        for d in 0..2 {
            lo[d] = lo[d].min(p[d] - width / 2.0);
            hi[d] = hi[d].max(p[d] + width / 2.0);
        }
    }
    let scale = (across / (hi[0] - lo[0])).min(HEIGHT / (hi[1] - lo[1]));
    let size = |d: usize| (((hi[d] - lo[d]) * scale).round() as usize).max(1);
    let mut picture = Picture::new(size(0), size(1).next_multiple_of(2));
    let height = size(1);
    for (p, width, value) in dots {
        let from = |d: usize| ((p[d] - width / 2.0 - lo[d]) * scale).round() as usize;
        let to = |d: usize| (((p[d] + width / 2.0 - lo[d]) * scale).round() as usize).max(from(d) + 1);
        for y in from(1)..to(1).min(height) {
            (from(0)..to(0)).for_each(|x| picture.set(x, height - 1 - y, Pixel::of(map, *value, range)));
        }
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::Options;

    fn scene() -> Session {
        let mut session = Session::new(Options::default()).unwrap();
        let deck = "units si\natom_style sphere\nlattice sc 1.0\nregion b block -0.5 3.5 -0.5 1.5 -0.5 0.5\n\
                    create_box 1 b\ncreate_atoms 1 box\nset group all diameter 1\n";
        session.eval("scene", deck).unwrap();
        session
    }

    #[test]
    fn a_cut_shows_values_from_left_to_right() {
        let text = slice(&["x", "z", "0"], &mut scene(), Ink::None, 72).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "x at z = 0, x across, y up");
        // Four particles side by side, each 18 characters of 72.
        let row = format!("{}{}{}{}", ".".repeat(18), "=".repeat(18), "o".repeat(18), "@".repeat(18));
        assert_eq!(lines[1], row);
        assert_eq!(lines.len(), 1 + 18 + 1);
        assert!(lines[19].starts_with("0 ...") && lines[19].ends_with(" 3"), "{}", lines[19]);
    }

    #[test]
    fn what_makes_no_cut_is_refused() {
        let mut s = scene();
        assert!(slice(&["x", "z"], &mut s, Ink::None, 72).unwrap_err().contains(":slice FORMULA"));
        assert!(slice(&["x", "w", "0"], &mut s, Ink::None, 72).is_err());
        assert!(slice(&["x", "z", "9"], &mut s, Ink::None, 72).unwrap_err().contains("from 0 to 0"));
        assert!(slice(&["c_no", "z", "0"], &mut s, Ink::None, 72).unwrap_err().contains("c_no"));
        assert!(
            slice(&["c_no", "z", "0"], &mut Session::new(Options::default()).unwrap(), Ink::None, 72)
                .is_err()
        );
    }
}
