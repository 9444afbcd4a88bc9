//! `set`: properties of particles that exist.

use super::common::{bad_keyword, id_range, masses_from_density, on_particles, seed, variable_param};
use super::{Act, CommandStyle};
use crate::diag::{Code, Result, Span, fail};
use crate::lang::{Args, Param, Word};
use crate::math::rng::ParkMiller;
use crate::styles::{ActCx, BuildCx, Doc, Style};
use crate::world::{AtomStyle, GroupId, Region, World};

/// The command.
pub struct Set;

const KEYWORDS: [&str; 13] = [
    "type",
    "type/fraction",
    "mass",
    "density",
    "diameter",
    "volume",
    "omega",
    "x",
    "y",
    "z",
    "vx",
    "vy",
    "vz",
];
const ELSEWHERE: [&str; 27] = [
    "type/ratio",
    "type/subset",
    "mol",
    "charge",
    "dipole",
    "dipole/random",
    "spin",
    "spin/atom",
    "quat",
    "quat/random",
    "shape",
    "length",
    "tri",
    "theta",
    "theta/random",
    "angmom",
    "density/disc",
    "image",
    "bond",
    "angle",
    "dihedral",
    "improper",
    "temperature",
    "epsilon",
    "rheo/rho",
    "rheo/status",
    "sph/rho",
];

impl Style for Set {
    fn name(&self) -> &'static str {
        "set"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "set atom A*B | type A*B | group ID | region ID  KEYWORD VALUE …",
            summary: "Sets properties of the particles chosen: type, mass, density, diameter, volume, spin, place, velocity.",
            text: "Keywords: `type T`, `type/fraction T P SEED`, `mass M`, `density ρ`, `diameter D`, `volume V`, \
                   `omega WX WY WZ`, `x y z`, `vx vy vz`. A value is a number or an atom-style variable `v_name`. \
                   Who is chosen is decided once for the whole line. \
                   `density` of a sphere sets its mass to 4/3 π r³ ρ with the radius it has now; of a peridynamic particle \
                   without radius it sets the mass to ρ itself (LAMMPS' convention). `diameter` leaves the mass alone: \
                   say it before `density`. `type/fraction` decides for each particle by a random number that belongs \
                   to its place, as LAMMPS does.",
            example: "set group plate density 2235.0 volume 1.25e-10",
        }
    }
}

/// Who is meant.
enum Choice {
    Tags(i64, i64),
    Kinds(u16, u16),
    Group(GroupId),
    Region(Region),
}

/// What a keyword sets.
enum Change {
    Kind(Param),
    Fraction { kind: u16, fraction: f64, seed: u32 },
    Mass(Param),
    Density(Param),
    Diameter(Param),
    Volume(Param),
    Omega([Param; 3]),
    Place(usize, Param),
    Velocity(usize, Param),
}

/// A keyword with its value and place.
struct Item {
    keyword: String,
    span: Span,
    change: Change,
}

impl Item {
    fn has_variable(&self) -> bool {
        let is = |p: &Param| matches!(p, Param::Ref(_));
        match &self.change {
            Change::Fraction { .. } => false,
            Change::Omega(p) => p.iter().any(is),
            Change::Kind(p)
            | Change::Mass(p)
            | Change::Density(p)
            | Change::Diameter(p)
            | Change::Volume(p)
            | Change::Place(_, p)
            | Change::Velocity(_, p) => is(p),
        }
    }
}

impl CommandStyle for Set {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        super::common::domain(cx)?;
        let choice = choice(a, cx)?;
        let mut items = vec![];
        let mut word = Some(a.expect("a keyword")?);
        while let Some(keyword) = word {
            let start = a.here();
            let change = change(keyword, a, cx)?;
            let span = keyword.span.to(start);
            items.push(Item { keyword: keyword.text.clone(), span, change });
            word = a.next();
        }
        let settles = items.iter().filter_map(|i| settles(&i.change)).collect();
        Ok(on_particles(settles, move |cx| apply(cx, &choice, &items)))
    }
}

fn settles(change: &Change) -> Option<&'static str> {
    match change {
        Change::Mass(_) => Some("mass"),
        Change::Density(_) => Some("density"),
        Change::Diameter(_) => Some("diameter"),
        Change::Volume(_) => Some("volume"),
        Change::Velocity(..) => Some("velocity"),
        _ => None,
    }
}

fn choice(a: &mut Args, cx: &BuildCx) -> Result<Choice> {
    let style = a.expect("atom, type, group or region")?;
    match style.text.as_str() {
        "atom" => {
            let (lo, hi) = id_range(a.expect("an id")?, i64::MAX)?;
            Ok(Choice::Tags(lo, hi))
        }
        "type" => a.type_range(cx.world.types).map(|(lo, hi)| Choice::Kinds(lo, hi)),
        "group" => cx.group(a.expect("a group")?).map(Choice::Group),
        "region" => Ok(Choice::Region(cx.region(a.expect("a region")?)?.clone())),
        _ => Err(bad_keyword(a, style, &["atom", "type", "group", "region"], &["mol"])),
    }
}

fn change(keyword: &Word, a: &mut Args, cx: &BuildCx) -> Result<Change> {
    let AtomStyle { sphere, peri, .. } = cx.world.particles.style;
    let needs = |there: bool| match there {
        true => Ok(()),
        false => {
            let text = format!("particles of this atom_style have no {}", keyword.text);
            fail(Code::CONFLICT, keyword.span, text)
        }
    };
    match keyword.text.as_str() {
        "type" => value(a, cx, "the type", Some(Limit::Kind)).map(Change::Kind),
        "type/fraction" => fraction(a, cx),
        "mass" => {
            needs(sphere || peri)?;
            value(a, cx, "the mass", Some(Limit::Positive)).map(Change::Mass)
        }
        "density" => {
            needs(sphere || peri)?;
            value(a, cx, "the density", Some(Limit::Positive)).map(Change::Density)
        }
        "diameter" => {
            needs(sphere)?;
            value(a, cx, "the diameter", Some(Limit::NotNegative)).map(Change::Diameter)
        }
        "volume" => {
            needs(peri)?;
            value(a, cx, "the volume", Some(Limit::Positive)).map(Change::Volume)
        }
        "omega" => {
            needs(sphere)?;
            let mut next = || value(a, cx, "the angular velocity", None);
            Ok(Change::Omega([next()?, next()?, next()?]))
        }
        "x" | "y" | "z" => {
            let d = usize::from(keyword.text.as_bytes()[0] - b'x');
            value(a, cx, "the coordinate", None).map(|p| Change::Place(d, p))
        }
        "vx" | "vy" | "vz" => {
            let d = usize::from(keyword.text.as_bytes()[1] - b'x');
            value(a, cx, "the velocity", None).map(|p| Change::Velocity(d, p))
        }
        _ => Err(bad_keyword(a, keyword, &KEYWORDS, &ELSEWHERE)),
    }
}

/// What a value must keep to.
#[derive(Clone, Copy)]
enum Limit {
    Positive,
    NotNegative,
    Kind,
}

impl Limit {
    fn check(self, x: f64, types: usize, what: &str, span: Span) -> Result<()> {
        let (ok, want) = match self {
            Limit::Positive => (x > 0.0, "greater than zero".to_string()),
            Limit::NotNegative => (x >= 0.0, "not negative".to_string()),
            Limit::Kind => (x >= 1.0 && x < types as f64 + 1.0, format!("a type from 1 to {types}")),
        };
        if ok { Ok(()) } else { fail(Code::BAD_VALUE, span, format!("{what} must be {want}: {x}")) }
    }
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

fn fraction(a: &mut Args, cx: &BuildCx) -> Result<Change> {
    let (kind, _) = a.clone().type_range(cx.world.types)?;
    a.integer("the type")?;
    let span = a.here();
    let fraction = a.number("the fraction")?;
    if !(0.0..=1.0).contains(&fraction) {
        return fail(Code::BAD_VALUE, span, format!("the fraction must lie between 0 and 1: {fraction}"));
    }
    Ok(Change::Fraction { kind, fraction, seed: seed(a)? })
}

fn apply(cx: &mut ActCx, choice: &Choice, items: &[Item]) -> Result<()> {
    let chosen = chosen(choice, cx.world);
    // Constants were checked when the line was read: only variables can still turn out wrong.
    let before = items.iter().any(Item::has_variable).then(|| cx.world.particles.clone());
    cx.say("Setting atom values ...");
    for item in items {
        let done = change_particles(cx, item, &chosen);
        match done {
            Ok(count) => cx.say(format!("  {count} settings made for {}", item.keyword)),
            Err(d) => {
                if let Some(before) = before {
                    cx.world.particles = before;
                }
                return Err(d.at(item.span));
            }
        }
    }
    cx.world.touch();
    Ok(())
}

/// Indices of the particles that are meant.
fn chosen(choice: &Choice, w: &World) -> Vec<usize> {
    let p = &w.particles;
    let meant = |i: usize| match choice {
        Choice::Tags(lo, hi) => (*lo..=*hi).contains(&i64::from(p.tag[i])),
        Choice::Kinds(lo, hi) => (*lo..=*hi).contains(&p.kind[i]),
        Choice::Group(g) => p.mask[i] & g.bit() != 0,
        Choice::Region(r) => r.contains(p.x[i]),
    };
    (0..p.len()).filter(|&i| meant(i)).collect()
}

fn change_particles(cx: &mut ActCx, item: &Item, chosen: &[usize]) -> Result<usize> {
    let types = cx.world.types;
    let mut checked = |p: &Param, what: &str, limit: Option<Limit>| -> Result<Vec<f64>> {
        let values = cx.per_atom(p)?;
        if let Some(limit) = limit {
            chosen.iter().try_for_each(|&i| limit.check(values[i], types, what, item.span))?;
        }
        Ok(values)
    };
    match &item.change {
        Change::Kind(p) => {
            let v = checked(p, "the type", Some(Limit::Kind))?;
            chosen.iter().for_each(|&i| cx.world.particles.kind[i] = v[i] as u16);
            cx.world.spread_type_masses();
        }
        Change::Fraction { kind, fraction, seed } => {
            return Ok(set_fraction(cx.world, chosen, *kind, *fraction, *seed));
        }
        Change::Mass(p) => {
            let v = checked(p, "the mass", Some(Limit::Positive))?;
            chosen.iter().for_each(|&i| cx.world.particles.mass[i] = v[i]);
        }
        Change::Density(p) => {
            let v = checked(p, "the density", Some(Limit::Positive))?;
            masses_from_density(&mut cx.world.particles, chosen, &v);
        }
        Change::Diameter(p) => {
            let v = checked(p, "the diameter", Some(Limit::NotNegative))?;
            chosen.iter().for_each(|&i| cx.world.particles.radius[i] = 0.5 * v[i]);
        }
        Change::Volume(p) => {
            let v = checked(p, "the volume", Some(Limit::Positive))?;
            chosen.iter().for_each(|&i| cx.world.particles.volume[i] = v[i]);
        }
        Change::Omega(p) => {
            let v = [checked(&p[0], "", None)?, checked(&p[1], "", None)?, checked(&p[2], "", None)?];
            chosen.iter().for_each(|&i| cx.world.particles.omega[i] = [v[0][i], v[1][i], v[2][i]]);
        }
        Change::Place(d, p) => {
            let v = checked(p, "", None)?;
            chosen.iter().for_each(|&i| cx.world.particles.x[i][*d] = v[i]);
        }
        Change::Velocity(d, p) => {
            let v = checked(p, "", None)?;
            chosen.iter().for_each(|&i| cx.world.particles.v[i][*d] = v[i]);
        }
    }
    Ok(chosen.len())
}

fn set_fraction(w: &mut World, chosen: &[usize], kind: u16, fraction: f64, seed: u32) -> usize {
    let mut stream = ParkMiller::new(seed);
    let mut count = 0;
    for &i in chosen {
        stream.reset_at(seed, w.particles.x[i]);
        if stream.uniform() <= fraction {
            w.particles.kind[i] = kind;
            count += 1;
        }
    }
    w.spread_type_masses();
    count
}

#[cfg(test)]
mod tests {
    use super::super::testing::{act, more, refused, scene};
    use crate::world::World;

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
        let said = act(&mut w, "set type 1 type 2 density 5", &[]).unwrap();
        assert_eq!(
            said,
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
            ("set atom 7*3 mass 3.0", "7*3"),
            ("set atom 1 mass v_q", "v_q"),
        ] {
            assert_eq!(refused(&w, line).0, word, "{line}");
        }
        let minus: fn(&World, usize) -> f64 = |_, _| -1.0;
        assert!(act(&mut w, "set atom * type 2 mass v_m", &[("m", minus)]).is_err());
        assert_eq!(w.particles.kind[0], 1);
    }
}
