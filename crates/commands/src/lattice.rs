//! `lattice`: the points particles are created on, and the unit of length of `units lattice`.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{not_here, setting, unknown_style};
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
            syntax: "lattice none|sc|bcc|fcc|hcp|diamond|sq|sq2|hex|custom SCALE [origin X Y Z] [orient x|y|z I J K] \
                     [spacing DX DY DZ] [a1|a2|a3 X Y Z] [basis X Y Z] …",
            summary: "Defines the points particles are created on, and the unit of length of `units lattice`.",
            text: "SCALE is the lattice constant [length]; in units lj it is the reduced density ρ*, and the constant is \
                   (N/V/ρ*)^(1/3) for N points in a cell of volume V (in flat scenes (N/A/ρ*)^(1/2)). `sq sq2 hex` are for \
                   `dimension 2`, `sc bcc fcc hcp diamond` for three dimensions. `origin` shifts by fractions (0 ≤ x < 1) of the \
                   spacings. `orient x 1 1 0` puts the lattice direction [110] along x; the three directions must be \
                   orthogonal and right-handed. `spacing` sets the unit of length (times the scale) where the extent of \
                   the turned cell is not wanted. `a1 a2 a3 basis` belong to `custom`. `none` gives a unit of length \
                   and no points. The latest `lattice` also sets the partial-volume rule of the peridynamic styles.",
            example: "lattice custom 0.5 a1 1.0 0.0 0.0 basis 0.5 0.5 0.5",
        }
    }
}

const KEYWORDS: [&str; 7] = ["origin", "orient", "spacing", "a1", "a2", "a3", "basis"];

impl CommandStyle for LatticeCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let style = a.expect("a lattice style")?;
        let flat = cx.world.settings.two_dimensional;
        let cell = cell_of(style, flat)?;
        let custom = style.text == "custom";
        let scale = a.positive("the lattice constant")?;
        let Some(mut cell) = cell else {
            return Ok(set(Lattice::none(scale)));
        };
        let reduced = cx.world.settings.units.is_reduced();
        let mut placing = Placing { flat, ..Placing::plain(scale, reduced) };
        let mut orient_span = None;
        while let Some(word) = a.next() {
            match word.text.as_str() {
                "origin" => placing.origin = fractions(a, "the origin")?,
                "orient" => orient_span = Some(orient(a, &mut placing)?),
                "spacing" => placing.spacing = Some(spacings(a)?),
                "a1" | "a2" | "a3" | "basis" if !custom => {
                    let text =
                        format!("`{}` belongs to `lattice custom`, not to `{}`", word.text, style.text);
                    return fail(Code::CONFLICT, word.span, text);
                }
                "a1" => cell.edges[0] = triple(a, "the first edge")?,
                "a2" => cell.edges[1] = triple(a, "the second edge")?,
                "a3" => cell.edges[2] = triple(a, "the third edge")?,
                "basis" => cell.basis.push(fractions(a, "a point of the cell")?),
                _ => return Err(refuse_or_unknown(a, word)),
            }
        }
        check(&cell, &placing, orient_span.unwrap_or(style.span), style.span)?;
        if flat {
            check_flat(&cell, &placing, orient_span.unwrap_or(style.span), style.span)?;
        }
        Ok(set(Lattice::new(&cell, &placing)))
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
            None => {
                const KNOWN: [&str; 10] =
                    ["none", "sc", "bcc", "fcc", "hcp", "diamond", "sq", "sq2", "hex", "custom"];
                Err(unknown_style(style, "lattice", &KNOWN))
            }
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

fn refuse_or_unknown(a: &Args, word: &Word) -> perigrain_base::diag::Diagnostics {
    match word.text.as_str() {
        "triclinic/general" => not_here(word, "keyword of lattice"),
        _ => a.unknown(word, &KEYWORDS),
    }
}

fn triple(a: &mut Args, what: &str) -> Result<[f64; 3]> {
    Ok([a.number(what)?, a.number(what)?, a.number(what)?])
}

fn fractions(a: &mut Args, what: &str) -> Result<[f64; 3]> {
    let mut out = [0.0; 3];
    for x in &mut out {
        let span = a.here();
        *x = a.number(what)?;
        if !(0.0..1.0).contains(x) {
            return fail(Code::BAD_VALUE, span, format!("{what} must lie in 0 ≤ x < 1, not at {x}"));
        }
    }
    Ok(out)
}

fn spacings(a: &mut Args) -> Result<[f64; 3]> {
    Ok([a.positive("a spacing")?, a.positive("a spacing")?, a.positive("a spacing")?])
}

fn orient(a: &mut Args, placing: &mut Placing) -> Result<Span> {
    let start = a.here();
    let axis = perigrain_styles::common::axis(a, "axis of orient")?;
    for k in &mut placing.orient[axis] {
        let span = a.here();
        let n = a.integer("a lattice direction")?;
        *k = match i32::try_from(n) {
            Ok(n) if n.abs() < 10_000 => n,
            _ => return fail(Code::BAD_VALUE, span, format!("{n} is no sensible lattice direction")),
        };
    }
    Ok(start)
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
