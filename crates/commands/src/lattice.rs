//! `lattice`: the points particles are created on, and the unit of length of `units lattice`.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{setting, unknown_style};
use perigrain_styles::words::{
    Alternative, At, Axis, Kind, Positive, Syntax, Value, Words, alternatives, read,
};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::Lattice;
use perigrain_world::lattice::{Cell, Placing, is_frame};

/// The command.
pub struct LatticeCommand;

impl Style for LatticeCommand {
    fn name(&self) -> &'static str {
        "lattice"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Defines the points particles are created on, and the unit of length of `units lattice`.",
            text: "`sq sq2 hex` are for `dimension 2`, `sc bcc fcc hcp diamond` for three dimensions; `none` gives a unit of length \
                   and no points. The three directions of `orient` must be orthogonal and right-handed. The latest `lattice` also \
                   sets the partial-volume rule of the peridynamic styles.",
            example: "lattice custom 0.5 a1 1.0 0.0 0.0 basis 0.5 0.5 0.5",
        }
    }
}

#[derive(Words)]
#[word(refused = "triclinic/general")]
struct Line {
    #[word(flatten)]
    kind: Named,
    /// The origin, shifted by fractions (0 ≤ x < 1) of the spacings.
    #[word(keyword, name = "X Y Z", what = "the origin", shown = "0 0 0")]
    origin: Option<[Within; 3]>,
    /// A lattice direction: `orient x 1 1 0` puts [110] along x.
    #[word(keyword, name = "direction")]
    orient: Vec<At<Orient>>,
    /// The unit of length, times the scale, where the extent of the turned cell is not wanted.
    #[word(keyword, name = "DX DY DZ", what = "a spacing")]
    spacing: Option<[Positive; 3]>,
    /// The first edge of the cell, of `custom`.
    #[word(keyword, name = "X Y Z", placed, shown = "1 0 0")]
    a1: Option<At<[f64; 3]>>,
    /// The second edge of the cell, of `custom`.
    #[word(keyword, name = "X Y Z", placed, shown = "0 1 0")]
    a2: Option<At<[f64; 3]>>,
    /// The third edge of the cell, of `custom`.
    #[word(keyword, name = "X Y Z", placed, shown = "0 0 1")]
    a3: Option<At<[f64; 3]>>,
    /// A point of the cell of `custom`, in fractions of its edges.
    #[word(keyword, name = "X Y Z", what = "a point of the cell", placed)]
    basis: Vec<At<[Within; 3]>>,
}

/// A lattice and its size.
#[derive(Words)]
struct Named {
    #[word(name = "style", what = "a lattice style", kind = Kind::Choice(&STYLES))]
    style: Word,
    /// The lattice constant; in units lj the reduced density ρ*, and the constant is (N/V/ρ*)^(1/3) for N points in a cell of volume V (in
    /// flat scenes (N/A/ρ*)^(1/2)) [length].
    #[word(name = "SCALE", positive)]
    scale: f64,
}

/// The lattices.
const KNOWN: [(&str, ()); 10] = [
    ("none", ()),
    ("sc", ()),
    ("bcc", ()),
    ("fcc", ()),
    ("hcp", ()),
    ("diamond", ()),
    ("sq", ()),
    ("sq2", ()),
    ("hex", ()),
    ("custom", ()),
];

const STYLES: [Alternative; 10] = alternatives(&KNOWN);

/// A direction of the lattice along an axis.
#[derive(Words)]
struct Orient {
    #[word(name = "x|y|z", what = "axis of orient")]
    axis: Axis,
    #[word(name = "I J K", what = "a lattice direction")]
    direction: [Direction; 3],
}

/// A number of a lattice direction.
#[derive(Clone, Copy)]
struct Direction(i32);

impl Value for Direction {
    const KIND: Kind = Kind::Whole;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let span = args.here();
        let n = args.integer(what)?;
        match i32::try_from(n) {
            Ok(n) if n.abs() < 10_000 => Ok(Self(n)),
            _ => fail(Code::BAD_VALUE, span, format!("{n} is no sensible lattice direction")),
        }
    }
}

/// A number from 0 on and below 1.
#[derive(Clone, Copy)]
struct Within(f64);

impl Value for Within {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let span = args.here();
        let x = args.number(what)?;
        match (0.0..1.0).contains(&x) {
            true => Ok(Self(x)),
            false => fail(Code::BAD_VALUE, span, format!("{what} must lie in 0 ≤ x < 1, not at {x}")),
        }
    }
}

impl CommandStyle for LatticeCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let flat = cx.world.settings.two_dimensional;
        let mut cell = Cell::orthogonal([1.0; 3], &[]);
        if let Some(style) = a.peek() {
            match cell_of(style, flat)? {
                Some(named) => cell = named,
                None => return read(a, cx).map(|Named { scale, .. }| set(Lattice::none(scale))),
            }
        }
        let line: Line = read(a, cx)?;
        let Named { style, scale } = &line.kind;
        line.refuse_cell(style)?;
        let reduced = cx.world.settings.units.is_reduced();
        let mut placing = Placing { flat, ..Placing::plain(*scale, reduced) };
        if let Some(origin) = line.origin {
            placing.origin = origin.map(|x| x.0);
        }
        let mut turned = style.span;
        for At { value: Orient { axis, direction }, span, .. } in &line.orient {
            placing.orient[axis.0] = direction.map(|n| n.0);
            turned = *span;
        }
        placing.spacing = line.spacing.map(|spacing| spacing.map(|x| x.0));
        for (edge, given) in cell.edges.iter_mut().zip([line.a1, line.a2, line.a3]) {
            *edge = given.map_or(*edge, |given| given.value);
        }
        cell.basis.extend(line.basis.iter().map(|point| point.value.map(|x| x.0)));
        check(&cell, &placing, turned, style.span)?;
        if flat {
            check_flat(&cell, &placing, turned, style.span)?;
        }
        Ok(set(Lattice::new(&cell, &placing)))
    }
}

impl Line {
    /// Refuses a cell of its own for a lattice that has one.
    fn refuse_cell(&self, style: &Word) -> Result<()> {
        let spans = [
            ("a1", self.a1.map(|a| a.span)),
            ("a2", self.a2.map(|a| a.span)),
            ("a3", self.a3.map(|a| a.span)),
            ("basis", self.basis.first().map(|b| b.span)),
        ];
        let given = spans.into_iter().filter_map(|(name, span)| Some((name, span?)));
        match given.min_by_key(|(_, span)| span.start).filter(|_| style.text != "custom") {
            Some((name, span)) => {
                let text = format!("`{name}` belongs to `lattice custom`, not to `{}`", style.text);
                fail(Code::CONFLICT, span, text)
            }
            None => Ok(()),
        }
    }
}

fn set(lattice: Lattice) -> Box<dyn Act> {
    setting(move |cx| {
        let [x, y, z] = lattice.spacing.map(|s| general(s, 8));
        cx.print(format!("Lattice spacing in x,y,z = {x} {y} {z}"));
        cx.world.lattice = lattice;
        Ok(())
    })
}

/// The unit cell of a style; `None` for `lattice none`.
fn cell_of(style: &Word, flat: bool) -> Result<Option<Cell>> {
    const SOLID: [&str; 5] = ["sc", "bcc", "fcc", "hcp", "diamond"];
    const FLAT: [&str; 3] = ["sq", "sq2", "hex"];
    let name = style.text.as_str();
    let (here, dimension) =
        if flat { (SOLID.contains(&name), "two") } else { (FLAT.contains(&name), "three") };
    if here {
        let d = Diagnostic::error(
            Code::CONFLICT,
            style.span,
            format!("lattice {name} does not go with {dimension} dimensions"),
        );
        let known = if flat { FLAT.join(" ") } else { SOLID.join(" ") };
        return Err(d.help(format!("write one of {known} none custom")).into());
    }
    match name {
        "none" => Ok(None),
        "custom" => Ok(Some(Cell::orthogonal([1.0; 3], &[]))),
        _ => match Cell::named(name) {
            Some(cell) => Ok(Some(cell)),
            None => Err(unknown_style(style, "lattice", &KNOWN.map(|(name, ())| name))),
        },
    }
}

/// In a flat scene nothing of the lattice may leave the plane.
fn check_flat(cell: &Cell, placing: &Placing, orient: Span, style: Span) -> Result<()> {
    let [x, y, z] = placing.orient;
    if x[2] != 0 || y[2] != 0 || z[0] != 0 || z[1] != 0 {
        return fail(Code::BAD_VALUE, orient, "the lattice directions of a flat scene must keep z along z");
    }
    let [a1, a2, a3] = cell.edges;
    let leaves = a1[2] != 0.0 || a2[2] != 0.0 || a3[0] != 0.0 || a3[1] != 0.0 || placing.origin[2] != 0.0;
    if leaves || cell.basis.iter().any(|b| b[2] != 0.0) {
        let text = "edges, points and origin of a flat scene's lattice must lie in the plane z = 0";
        return fail(Code::BAD_VALUE, style, text);
    }
    Ok(())
}

fn check(cell: &Cell, placing: &Placing, orient: Span, style: Span) -> Result<()> {
    if !is_frame(placing.orient) {
        let text = "the three lattice directions must be orthogonal and right-handed";
        return fail(Code::BAD_VALUE, orient, text);
    }
    if cell.basis.is_empty() {
        return fail(Code::INCOMPLETE, style, "lattice custom needs at least one `basis` point");
    }
    if cell.volume() <= 0.0 || !cell.volume().is_finite() {
        return fail(Code::BAD_VALUE, style, "the edges a1, a2, a3 span no volume");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::testing::{act, refused, scene};
    use perigrain_world::World;

    #[test]
    fn prints_its_spacings() {
        let mut w = scene("units si");
        let lines =
            act(&mut w, "lattice bcc 2.0 orient x 1 1 0 orient y -1 1 0 orient z 0 0 1", &[]).unwrap();
        // Oracle: the same line in LAMMPS.
        assert_eq!(lines, ["Lattice spacing in x,y,z = 2.8284271 2.8284271 2"]);
        assert_eq!(w.lattice.basis.len(), 2);
    }

    #[test]
    fn reduced_density_in_lj_units_only() {
        assert_eq!(scene("units si\nlattice sc 8.0").lattice.spacing, [8.0; 3]);
        assert_eq!(scene("lattice sc 8.0").lattice.spacing, [0.5; 3]);
        assert_eq!(scene("lattice none 8.0").lattice.spacing, [8.0; 3]);
    }

    #[test]
    fn blames_the_right_word() {
        let w = World::default();
        assert_eq!(refused(&w, "lattice scc 1.0").0, "scc");
        assert_eq!(refused(&w, "lattice sc -1.0").0, "-1.0");
        assert_eq!(refused(&w, "lattice sc 1.0 basis 0 0 0").0, "basis");
        assert_eq!(refused(&w, "lattice sc 1.0 origin 0 1.0 0").0, "1.0");
        assert_eq!(refused(&w, "lattice sc 1.0 orient x 1 1 0").0, "x");
        assert_eq!(refused(&w, "lattice custom 1.0").0, "custom");
        assert_eq!(refused(&w, "lattice hex 1.0").0, "hex");
        assert_eq!(refused(&w, "lattice none 1.0 origin 0 0 0").0, "origin");
    }
}
