//! `set`: properties of particles that exist.

mod change;
mod orientation;
mod scatter;

use super::{Act, CommandStyle};
use change::{Change, Limit};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Param, Word};
use perigrain_styles::common::{self, bad_keyword, id_range, on_particles, variable_param};
use perigrain_styles::words::{
    At, Each, Given, Grammar, Keyword, Keywords, Kind, Part, Syntax, Types, Value, Words,
};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::columns::{HEATFLOW, TEMPERATURE};
use perigrain_world::{GroupId, Region};

/// The command.
pub struct Set;

impl Style for Set {
    fn name(&self) -> &'static str {
        "set"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(WHOLE),
            summary: "Sets properties of the particles chosen: type, mass, density, diameter, volume, spin, place, velocity.",
            text: "Particles are chosen once for the whole line. A value is a number or an atom-style variable `v_name`. Of a `fix \
                   property/atom` any property can be set by its name (`i_NAME`, `d_NAME`, `temperature`).\n\n\
                   `density` comes after `diameter`, `peri/radius` after `volume`. `peri/stiffness` comes before the first run; \
                   strengths may change between runs. Restart files keep the factors of `peri/strength` and `peri/stiffness`, data \
                   files do not; `compute property/atom peri/strength` shows them. Particles not chosen keep theirs, 1 at first.\n\n\
                   Each random factor belongs to the ID of its particle and the seed. With `correlated L` the numbers form a field \
                   over the places that particles have now, with the correlation exp(−r²/2L²) of its underlying normal numbers: two \
                   keywords with one seed and L have the same field, and it repeats with the box. Neither depends on threads or on \
                   the order of particles. The scatter is that of a particle, whatever its size: with finer lattices a body has \
                   more weak places unless L holds them together.",
            example: "set group plate density 2235.0 volume 1.25e-10",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "particles")]
    choice: At<Choice>,
    #[word(flatten)]
    _changes: Each<Change>,
}

/// A whole line: properties of `fix property/atom` may be set, too.
const WHOLE: &Grammar = &Grammar {
    parts: &[Part::All(Line::GRAMMAR)],
    keywords: &[Keyword {
        word: "temperature",
        values: &[Part::bare("T|v_name", Kind::Param)],
        about: "The temperature, where `fix property/atom` gives particles one.",
        default: "",
        repeats: true,
    }],
    refused: &[],
};

/// Which particles are set.
#[derive(Words)]
#[word(what = "keyword of set")]
#[allow(clippy::large_enum_variant)] // there is one at a time, while a line is read
enum Choice {
    /// Those with these ids.
    Atom(#[word(name = "A*B")] Ids),
    /// Those of these types.
    Type(#[word(name = "A*B")] Types),
    /// Those of these molecules.
    Mol(#[word(name = "A*B")] Molecules),
    /// Those of a group.
    Group(#[word(name = "ID")] GroupId),
    /// Those inside a region.
    Region(#[word(name = "ID")] Region),
}

/// A range of ids.
struct Ids(i64, i64);

impl Value for Ids {
    const KIND: Kind = Kind::Text;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        id_range(args.expect("an id")?, i64::MAX).map(|(lo, hi)| Self(lo, hi))
    }
}

/// A range of molecules.
struct Molecules(i64, i64);

impl Value for Molecules {
    const KIND: Kind = Kind::Text;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        common::range_from(args.expect("a molecule")?, 0, i64::MAX).map(|(lo, hi)| Self(lo, hi))
    }
}

impl CommandStyle for Set {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let choice = Line::begin(a, cx)?.choice;
        if matches!(choice.value, Choice::Mol(_)) && !cx.world.particles.style.molecules {
            return fail(Code::CONFLICT, choice.span, "particles of this atom_style belong to no molecules");
        }
        let (choice, mut items) = (choice.value, vec![]);
        let mut word = Some(a.expect("a keyword")?);
        while let Some(keyword) = word {
            let span = keyword.span.to(a.here());
            let change = match Change::keyword(keyword, a, cx)? {
                Some(change) => change,
                None => custom(keyword, a, cx)?,
            };
            change.check(keyword, cx)?;
            items.push(Given { word: keyword.clone(), span, value: change });
            word = a.next();
        }
        let settles = items.iter().filter_map(|i| i.value.settles()).collect();
        let at = cx.span;
        Ok(on_particles(settles, move |cx| {
            common::populated(cx.world, "set", at)?;
            change::apply(cx, &choice, &items)
        }))
    }
}

/// A property of fix property/atom.
fn custom(keyword: &Word, a: &mut Args, cx: &BuildCx) -> Result<Change> {
    let name = keyword.text.as_str();
    if name == HEATFLOW.text() {
        let text = "the heat flow is computed anew in each step: it cannot be set";
        return fail(Code::CONFLICT, keyword.span, text);
    }
    if name == TEMPERATURE.text() && cx.world.columns.property(*TEMPERATURE).is_none() {
        let d = Diagnostic::error(Code::INCOMPLETE, keyword.span, "these particles have no temperature");
        return Err(d.help("`fix ID all property/atom temperature` gives them one").into());
    }
    let Some(column) = cx.world.columns.custom(name) else {
        let known = Line::GRAMMAR.keywords();
        return Err(bad_keyword(a, keyword, &known, Change::GRAMMAR.refused));
    };
    let limit = (name == TEMPERATURE.text()).then_some(Limit::NotNegative);
    let (at, known) = (a.here(), a.peek().is_some_and(|w| !w.unknown));
    let value = value(a, cx, if limit.is_some() { "the temperature" } else { "the value" }, limit)?;
    let whole = name.starts_with('i');
    if let (true, true, &Param::Number(x)) = (whole, known, &value)
        && x.fract() != 0.0
    {
        let d = Diagnostic::error(Code::BAD_VALUE, at, format!("`{name}` holds whole numbers, not {x}"));
        return Err(d.help("a property `d_NAME` holds any number").into());
    }
    Ok(Change::Custom { column, whole, value })
}

fn value(a: &mut Args, cx: &BuildCx, what: &str, limit: Option<Limit>) -> Result<Param> {
    let (span, unknown) = (a.here(), a.peek().is_some_and(|w| w.unknown));
    let p = variable_param(a, what)?;
    cx.param(&p, true)?;
    if let (Param::Number(x), Some(limit), false) = (&p, limit, unknown) {
        limit.check(*x, cx.world.types, what, span)?;
    }
    Ok(p)
}

/// Reads a value that keeps to a limit.
fn limited(what: &'static str, limit: Option<Limit>) -> impl Fn(&mut Args, &BuildCx) -> Result<Param> {
    move |a, cx| value(a, cx, what, limit)
}

/// A type that there is, as a number.
struct Kinds(u16);

impl Value for Kinds {
    const KIND: Kind = Kind::Types;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let (kind, _) = args.clone().type_range(cx.world.types)?;
        args.integer("the type")?;
        Ok(Self(kind))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{act, more, refused, scene};
    use perigrain_world::{Compat, World};

    fn balls() -> World {
        let mut w =
            scene("units si\natom_style sphere\nregion b block 0 4 0 3 0 3 units box\ncreate_box 3 b");
        more(&mut w, "lattice sc 1\ncreate_atoms 1 box");
        w
    }

    // Oracle: the same lines in LAMMPS: 10 of 36 particles become type 3, these, and these masses.
    #[test]
    fn fraction_and_density_are_lammps() {
        let mut w = balls();
        let lines = act(&mut w, "set type 1 type 2 density 5", &[]).unwrap();
        assert_eq!(
            lines,
            ["Setting atom values ...", "  36 settings made for type", "  36 settings made for density"]
        );
        more(&mut w, "set group all type/fraction 3 0.25 99 vx 2.5");
        let third: Vec<u32> = (0..36).filter(|&i| w.particles.kind[i] == 3).map(|i| i as u32 + 1).collect();
        assert_eq!(third, [1, 6, 10, 13, 15, 20, 22, 23, 27, 33]);
        let tenth: fn(&World, usize) -> f64 = |w, i| 0.1 * f64::from(w.particles.tag[i]);
        act(&mut w, "set atom 3*6 diameter v_d", &[("d", tenth)]).unwrap();
        act(&mut w, "set atom * density v_d", &[("d", tenth)]).unwrap();
        let oracle = [0.0523599, 0.10472, 0.00424115, 0.0134041, 0.0327249, 0.0678584, 0.366519, 0.418879];
        for (m, oracle) in w.particles.mass.iter().zip(oracle) {
            assert!((m / oracle - 1.0).abs() < 5e-6, "{m} {oracle}"); // printed with 6 digits
        }
        assert_eq!(w.particles.v[7], [2.5, 0.0, 0.0]);
    }

    #[test]
    fn peridynamic_mass_is_density_without_radius() {
        let mut w =
            scene("units si\natom_style hybrid sphere peri\nregion b block 0 4 0 3 0 3\ncreate_box 2 b");
        more(
            &mut w,
            "create_atoms 1 single 1 1 1\ncreate_atoms 2 single 2 1 1\nset type 1 diameter 0 density 2235 volume 8",
        );
        more(&mut w, "set type 2 diameter 2 density 1000 omega 1 2 3");
        let p = &w.particles;
        // 4/3 π 1³ · 1000, in LAMMPS' order of products.
        assert_eq!(p.mass, [2235.0, 4.0 * std::f64::consts::PI / 3.0 * 1000.0]);
        assert_eq!((p.volume[0], p.density[0], p.omega[1]), (8.0, 2235.0, [1.0, 2.0, 3.0]));
        more(&mut w, "set type 2 omegay 7");
        assert_eq!(w.particles.omega[1], [1.0, 7.0, 3.0]);
    }

    #[test]
    fn blames_the_right_word_and_changes_nothing() {
        let mut w = balls();
        for (line, word) in [
            ("set type 4 mass 1", "4"),
            ("set group q mass 1", "q"),
            ("set atom 1 mass 0", "0"),
            ("set atom 1 volume 1", "volume"),
            ("set atom 1 charge 1", "charge"),
            ("set atom 1 type 4", "4"),
            ("set atom 1 type/fraction 1 1.5 3", "1.5"),
            ("set mol 1 mass 3", "mol"),
            ("set atom 1 mol 3", "mol"),
            ("set atom 1 bond 1", "bond"),
            ("set atom 7*3 mass 3.0", "7*3"),
            ("set atom 1 mass v_q", "v_q"),
        ] {
            assert_eq!(refused(&w, line).0, word, "{line}");
        }
        let minus: fn(&World, usize) -> f64 = |_, _| -1.0;
        assert!(act(&mut w, "set atom * type 2 mass v_m", &[("m", minus)]).is_err());
        assert_eq!(w.particles.kind[0], 1);
    }

    // Oracle: the same lines in LAMMPS, printed with 15 digits. Without its numbers an axis of any length turns by the angle.
    #[test]
    fn orientations_are_lammps() {
        let mut w = scene(
            "units lj\natom_style bpm/sphere\nregion b block 0 3 0 3 0 3 units box\ncreate_box 1 b bond/types 1",
        );
        more(&mut w, "lattice sc 1\ncreate_atoms 1 box\nset atom 1 quat 1 2 2 30");
        let angle = 15f64.to_radians();
        let near = |a: [f64; 4], b: [f64; 4]| (0..4).all(|k| (a[k] - b[k]).abs() < 2e-15); // digits printed
        let third = angle.sin() / 3.0;
        assert!(near(w.particles.quat[0], [angle.cos(), third, 2.0 * third, 2.0 * third]));
        w.settings.compat = Compat::Lammps2025;
        more(
            &mut w,
            "set atom 1*9 quat 1 2 2 30\nset atom 10*18 quat 0 0 1 200\nset atom 19*27 quat/random 4711",
        );
        for (i, oracle) in [
            (0, [0.779403831193579, 0.208840627146043, 0.417681254292085, 0.417681254292085]),
            (9, [-0.17364817766693, 0.0, 0.0, 0.984807753012208]),
            (18, [-0.0901235132510864, 0.76327186834414, 0.633046611149085, -0.0924434717348213]),
            (26, [0.693429769730391, -0.0649375495220329, -0.00912362530219658, -0.717533991233221]),
        ] {
            assert!(near(w.particles.quat[i], oracle), "{i} {:?}", w.particles.quat[i]);
        }
        assert_eq!(refused(&w, "set atom 1 quat 0 0 0 30").0, "0 0 0");
    }
}
