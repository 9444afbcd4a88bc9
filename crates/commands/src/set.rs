//! `set`: properties of particles that exist.

mod change;
mod orientation;
mod scatter;

use super::create_atoms::subset::Amount;
use super::{Act, CommandStyle};
use change::{Change, Item, Limit};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Param, Word};
use perigrain_styles::common::{self, bad_keyword, id_range, on_particles, seed, variable_param};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::columns::{HEATFLOW, TEMPERATURE};
use perigrain_world::{AtomStyle, GroupId, Region};

/// The command.
pub struct Set;

const KEYWORDS: [&str; 27] = [
    "mol",
    "bond",
    "type",
    "type/fraction",
    "type/ratio",
    "type/subset",
    "image",
    "density/disc",
    "mass",
    "density",
    "diameter",
    "peri/radius",
    "peri/strength",
    "peri/stiffness",
    "volume",
    "omega",
    "quat",
    "quat/random",
    "charge",
    "dipole",
    "dipole/random",
    "x",
    "y",
    "z",
    "vx",
    "vy",
    "vz",
];
const ELSEWHERE: [&str; 15] = [
    "spin",
    "spin/atom",
    "shape",
    "length",
    "tri",
    "theta",
    "theta/random",
    "angmom",
    "angle",
    "dihedral",
    "improper",
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
            syntax: "set atom A*B | type A*B | mol A*B | group ID | region ID  KEYWORD VALUE …",
            summary: "Sets properties of the particles chosen: type, mass, density, diameter, volume, spin, place, velocity.",
            text: "Keywords: `type T`, `type/fraction T P SEED`, `type/ratio T P SEED`, `type/subset T N SEED`, `mass M`, \
                   `density ρ`, `density/disc ρ`, `diameter D`, `volume V`, `omega WX WY WZ`, `quat A B C THETA` (the orientation: turned by THETA degrees about an axis of any length; LAMMPS, and `-compat lammps`, turn farther about an axis that is not of unit length), `quat/random SEED`, `charge Q`, `dipole MUX MUY MUZ`, `dipole/random SEED MU` (moments of size MU in directions that LAMMPS draws too: corners of a cube are likelier), `image NX NY NZ` (`NULL` \
                   leaves one alone), `mol M`, `bond T` (the type of all bonds with both ends among the chosen), `x y z`, `vx vy vz`, `temperature T` (where `fix property/atom temperature` is), `peri/radius`, `peri/strength`, `peri/stiffness`. A value is a number or an atom-style variable `v_name`. \
                   Particles are chosen once for the whole line. \
                   `density` of a sphere sets its mass to 4/3 π r³ ρ with the radius it has now; of a peridynamic particle \
                   without radius it sets the mass to ρ itself (LAMMPS' convention). `diameter` leaves the mass alone: \
                   say it before `density`. `type/fraction` decides for each particle by a random number that belongs \
                   to its place, `type/ratio` and `type/subset` change exactly the part or number of them that LAMMPS \
                   changes. `peri/radius` gives peridynamic particles the sphere that meets others: `quasi` that of their \
                   volume, (3V/4π)^⅓ = 0.62 spacings of a lattice (Hartmann et al. 2022), `half` V^⅓/2, or R; it leaves mass \
                   and volume alone and comes after `volume`. `density/disc` is the mass per area of a disc, in flat scenes.\n\n\
                   `peri/strength F` and `peri/stiffness F` give peridynamic particles factors: a bond breaks at its critical stretch (s00) times the \
                   smaller strength of its ends, as a chain does at its weakest link, and has its micro-modulus times the mean of \
                   their stiffnesses (`pair_style peri/pmb` alone). In the place of F may stand `weibull M SEED`, a number of a Weibull \
                   distribution of modulus M, or `normal DEVIATION SEED` (below 1/3; what is farther off than three deviations is moved to there), \
                   both of mean 1; each belongs to the ID of its particle and the seed. With `correlated L` behind it the numbers form a field over the \
                   places that particles have now, with the correlation exp(−r²/2L²) of its underlying normal numbers: two keywords with one \
                   seed and L have the same field, and it repeats with the box. Neither depends on threads or on the order of particles. The scatter is that of a particle, whatever its size: with finer \
                   lattices a body has more weak places unless L holds them together. Particles not chosen keep theirs, 1 at first. \
                   Restart files keep factors, data files do not; `compute property/atom peri/strength` shows them. \
                   `peri/stiffness` comes before the first run; strengths may change between runs.",
            example: "set group plate density 2235.0 volume 1.25e-10",
        }
    }
}

/// Which particles are set.
enum Choice {
    Tags(i64, i64),
    Kinds(u16, u16),
    Molecules(i64, i64),
    Group(GroupId),
    Region(Box<Region>),
}

impl CommandStyle for Set {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
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
        let settles = items.iter().filter_map(|i| i.change.settles()).collect();
        let at = cx.span;
        Ok(on_particles(settles, move |cx| {
            common::populated(cx.world, "set", at)?;
            change::apply(cx, &choice, &items)
        }))
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
        "mol" if cx.world.particles.style.molecules => {
            let (lo, hi) = common::range_from(a.expect("a molecule")?, 0, i64::MAX)?;
            Ok(Choice::Molecules(lo, hi))
        }
        "mol" => fail(Code::CONFLICT, style.span, "particles of this atom_style belong to no molecules"),
        "group" => cx.group(a.expect("a group")?).map(Choice::Group),
        "region" => Ok(Choice::Region(Box::new(cx.region(a.expect("a region")?)?.clone()))),
        _ => Err(bad_keyword(a, style, &["atom", "type", "mol", "group", "region"], &[])),
    }
}

fn change(keyword: &Word, a: &mut Args, cx: &BuildCx) -> Result<Change> {
    let AtomStyle { sphere, oriented, peri, charged, dipole, .. } = cx.world.particles.style;
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
        "type/ratio" => some(a, cx, true),
        "type/subset" => some(a, cx, false),
        "image" => image(a, cx),
        "mass" => {
            needs(sphere || peri)?;
            value(a, cx, "the mass", Some(Limit::Positive)).map(Change::Mass)
        }
        "density" => {
            needs(sphere || peri)?;
            value(a, cx, "the density", Some(Limit::Positive)).map(Change::Density)
        }
        "density/disc" => {
            needs(sphere)?;
            if !cx.world.settings.two_dimensional {
                let text = "`density/disc` belongs to flat scenes (`dimension 2`)";
                return fail(Code::CONFLICT, keyword.span, text);
            }
            value(a, cx, "the density", Some(Limit::Positive)).map(Change::Disc)
        }
        "diameter" => {
            needs(sphere)?;
            value(a, cx, "the diameter", Some(Limit::NotNegative)).map(Change::Diameter)
        }
        "peri/radius" => {
            needs(sphere && peri)?;
            if a.eat("quasi") {
                // The sphere of the same volume (Hartmann et al. 2022, section 3.1).
                return Ok(Change::OfVolume(0.75 / std::f64::consts::PI));
            }
            if a.eat("half") {
                return Ok(Change::OfVolume(0.125));
            }
            let radius = value(a, cx, "the radius (quasi, half or a number)", Some(Limit::Positive))?;
            Ok(Change::Radius(radius))
        }
        "peri/strength" | "peri/stiffness" => {
            needs(peri)?;
            scatter::read(keyword, a, cx)
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
        "quat" => {
            needs(oriented)?;
            let (start, mut end) = (a.here(), a.here());
            let axis: [Param; 3] = {
                let mut next = || {
                    end = a.here();
                    value(a, cx, "the axis", None)
                };
                [next()?, next()?, next()?]
            };
            let span = start.to(end);
            let angle = value(a, cx, "the angle [degrees]", None)?;
            let constants: Option<Vec<f64>> =
                axis.iter().map(|p| if let Param::Number(x) = p { Some(*x) } else { None }).collect();
            if let Some([x, y, z]) = constants.as_deref() {
                orientation::check_axis([*x, *y, *z], cx.world).map_err(|e| e.at(span))?;
            }
            Ok(Change::Quat { axis, angle })
        }
        "quat/random" => {
            needs(oriented)?;
            seed(a).map(Change::AnyQuat)
        }
        "charge" => {
            needs(charged)?;
            value(a, cx, "the charge", None).map(Change::Charge)
        }
        "dipole" => {
            needs(dipole)?;
            let mut next = || value(a, cx, "the dipole moment", None);
            Ok(Change::Moment([next()?, next()?, next()?]))
        }
        "dipole/random" => {
            needs(dipole)?;
            Ok(Change::AnyMoment(seed(a)?, a.positive("the dipole moment")?))
        }
        "mol" => {
            needs(cx.world.particles.style.molecules)?;
            value(a, cx, "the molecule", Some(Limit::NotNegative)).map(Change::Molecule)
        }
        "bond" => {
            needs(cx.world.particles.style.bonded)?;
            common::bond_type(a, cx.world.bonds.types).map(Change::Bond)
        }
        "x" | "y" | "z" => {
            let d = usize::from(keyword.text.as_bytes()[0] - b'x');
            value(a, cx, "the coordinate", None).map(|p| Change::Place(d, p))
        }
        "vx" | "vy" | "vz" => {
            let d = usize::from(keyword.text.as_bytes()[1] - b'x');
            value(a, cx, "the velocity", None).map(|p| Change::Velocity(d, p))
        }
        custom if custom == HEATFLOW.text() => {
            let text = "the heat flow is computed anew in each step: it cannot be set";
            fail(Code::CONFLICT, keyword.span, text)
        }
        custom if custom == TEMPERATURE.text() && cx.world.columns.property(*TEMPERATURE).is_none() => {
            let d = Diagnostic::error(Code::INCOMPLETE, keyword.span, "these particles have no temperature");
            Err(d.help("`fix ID all property/atom temperature` gives them one").into())
        }
        custom => match cx.world.columns.custom(custom) {
            Some(column) => {
                let limit = (custom == TEMPERATURE.text()).then_some(Limit::NotNegative);
                let (at, known) = (a.here(), a.peek().is_some_and(|w| !w.unknown));
                let p = value(a, cx, if limit.is_some() { "the temperature" } else { "the value" }, limit)?;
                let whole = custom.starts_with('i');
                if let (true, true, &Param::Number(x)) = (whole, known, &p)
                    && x.fract() != 0.0
                {
                    let d = Diagnostic::error(
                        Code::BAD_VALUE,
                        at,
                        format!("`{custom}` holds whole numbers, not {x}"),
                    );
                    return Err(d.help("a property `d_NAME` holds any number").into());
                }
                Ok(Change::Custom { column, whole, value: p })
            }
            None => Err(bad_keyword(a, keyword, &KEYWORDS, &ELSEWHERE)),
        },
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
    let kind = one_type(a, cx)?;
    Ok(Change::Fraction { kind, fraction: common::fraction(a)?, seed: seed(a)? })
}

/// `type/ratio` and `type/subset`: an exact number of the chosen ones.
fn some(a: &mut Args, cx: &BuildCx, ratio: bool) -> Result<Change> {
    let kind = one_type(a, cx)?;
    let amount = match ratio {
        true => Amount::Ratio(common::fraction(a)?),
        false => Amount::Count(a.integer_from(0, "the number of particles")?),
    };
    Ok(Change::Some { kind, amount, seed: common::marsaglia_seed(a)? })
}

fn one_type(a: &mut Args, cx: &BuildCx) -> Result<u16> {
    let (kind, _) = a.clone().type_range(cx.world.types)?;
    a.integer("the type")?;
    Ok(kind)
}

/// `image`: counts along periodic dimensions, `NULL` for those that stay.
fn image(a: &mut Args, cx: &BuildCx) -> Result<Change> {
    let domain = common::domain(cx)?;
    let mut counts = [None, None, None];
    for (d, count) in counts.iter_mut().enumerate() {
        let span = a.here();
        let value = common::param_or_null(a, "the image count")?;
        let Some(param) = value else { continue };
        cx.param(&param, true)?;
        if !domain.boundary.periodic(d) && !matches!(param, Param::Number(0.0)) {
            let text = format!("the box does not repeat along {}: write 0 or NULL", ["x", "y", "z"][d]);
            return fail(Code::CONFLICT, span, text);
        }
        if matches!(param, Param::Number(x) if x.fract() != 0.0) {
            return fail(Code::BAD_NUMBER, span, "an image count must be a whole number");
        }
        *count = Some(param);
    }
    Ok(Change::Image(counts))
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
