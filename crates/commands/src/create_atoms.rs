//! `create_atoms`: particles on lattice sites, single ones, at random places, or on a surface.

pub mod mesh;
mod molecules;
mod places;
pub(super) mod subset;

use super::{Act, CommandStyle};
use molecules::Copies;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::cformat::general;
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_styles::common::{self, bad_keyword, in_group, scales, seed, units_lattice, unknown_style};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::{World, memory};
use places::{Maker, New, Place, Test};
use subset::{Amount, Subset};

/// The command.
pub struct CreateAtoms;

const KEYWORDS: [&str; 14] = [
    "basis", "ratio", "subset", "units", "remap", "overlap", "maxtry", "var", "set", "group", "meshmode",
    "radscale", "mol", "rotate",
];

impl Style for CreateAtoms {
    fn name(&self) -> &'static str {
        "create_atoms"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "create_atoms TYPE box | region ID | single X Y Z | random N SEED ID|NULL | mesh FILE  \
                     [basis M TYPE] [ratio P SEED] [subset N SEED] [var NAME] [set x|y|z NAME] … [group ID] \
                     [units lattice|box] [remap yes|no] [overlap D] [maxtry N] [meshmode bisect R|qrand D] [radscale S] \
                     [mol ID SEED] [rotate ANGLE X Y Z]",
            summary: "Creates particles on the sites of the lattice, at one place, at random places, or on a surface.",
            text: "Sites are taken in LAMMPS' order (third lattice edge slowest, basis points fastest) and must lie in \
                   lo ≤ x < hi of the box; along periodic dimensions both faces move down by about 1e-6 of the edge \
                   length, so that exactly one of two equivalent sites is taken. `region` also asks the region. `single` \
                   takes lattice spacings unless `units box` is said; `remap yes` wraps its place into a periodic box. \
                   `random` draws from LAMMPS' Park–Miller stream; `overlap D` keeps new particles D away from all \
                   others, within `maxtry` attempts each (default 1000). `basis M TYPE` gives the M-th point of the unit \
                   cell another type. `ratio` and `subset` take a random part of the sites, exact in number, the sites \
                   that LAMMPS takes.\n\n\
                   `var` names an equal-style variable that decides about each place of `box`, `region` and `random`: no \
                   particle where it is zero. `set x NAME` gives the internal-style variable NAME the coordinate before \
                   it is asked.\n\n\
                   `mesh` reads triangles from an STL file, ASCII or binary, in box units (`units box` must be said). \
                   `meshmode bisect R` (default, with R = 1) halves triangles at their longest side \
                   until their corners are on average no farther than R from the centre, and puts a particle there; \
                   `qrand D` puts D particles per area at places of a quasi-random sequence. Spheres take their radius \
                   from the triangle, times `radscale`.\n\n\
                   New ids follow the largest one in use; `group` puts the new particles into a group, made if it is not \
                   there. A sphere starts with diameter 1 and density 1, a peridynamic particle with volume 1 and mass \
                   1.\n\n\
                   `mol ID SEED` puts a copy of a `molecule` template in each place, its centre there, turned at random or as \
                   `rotate ANGLE X Y Z` [degrees, axis] says; TYPE, which may be 0, is added to the types of the template. Copies \
                   get molecule IDs behind the largest one. LAMMPS' random turns. Not with `overlap` and `basis`.",
            example: "create_atoms 1 region disc subset 20 4711",
        }
    }
}

/// What a line asks for.
struct Creation {
    kind: u16,
    place: Place,
    /// Type of each basis point.
    basis: Vec<u16>,
    lattice_units: bool,
    test: Option<Test>,
    mol: Option<Copies>,
    group: Option<String>,
    /// Said before the particles are made.
    note: Vec<String>,
}

impl CommandStyle for CreateAtoms {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let types = cx.world.types;
        let first = a.here();
        let kind = type_or_zero(a, types)?;
        let style = a.expect("box, region, single, random or mesh")?;
        let (place, note) = place(style, a, cx)?;
        let basis = vec![kind; cx.world.lattice.basis.len()];
        let mut c =
            Creation { kind, place, basis, lattice_units: true, test: None, mol: None, group: None, note };
        keywords(a, cx, style, &mut c)?;
        match &c.mol {
            Some(mol) => mol.check_types(kind, types)?,
            None if kind == 0 => {
                return fail(Code::BAD_VALUE, first, format!("there are types 1 to {types}, not 0"));
            }
            None => {}
        }
        if let Place::Single { x, .. } = &mut c.place {
            let scale = scales(cx.world, c.lattice_units);
            *x = [0, 1, 2].map(|d| x[d] * scale[d]);
        }
        if matches!(c.place, Place::Mesh(_)) && c.lattice_units {
            let d = Diagnostic::error(Code::INCOMPLETE, style.span, "triangles are in box units: say so");
            return Err(d.help("add `units box` to this line").into());
        }
        Ok(in_group(vec!["particles"], c.group.clone(), move |cx| create(cx, &c)))
    }
}

/// Where particles are made, and what is said about it.
fn place(style: &Word, a: &mut Args, cx: &BuildCx) -> Result<(Place, Vec<String>)> {
    let place = match style.text.as_str() {
        "box" => Place::Lattice { region: None, subset: None },
        "region" => {
            let region = Some(cx.region(a.expect("a region")?)?.clone());
            Place::Lattice { region, subset: None }
        }
        "single" => Place::Single { x: [a.number("x")?, a.number("y")?, a.number("z")?], remap: false },
        "random" => random(a, cx)?,
        "mesh" => return mesh::parse(a, cx).map(|(mesh, note)| (Place::Mesh(mesh), note)),
        _ => {
            const KNOWN: [&str; 5] = ["box", "region", "single", "random", "mesh"];
            return Err(unknown_style(style, "style of create_atoms", &KNOWN));
        }
    };
    if matches!(place, Place::Lattice { .. }) && cx.world.lattice.basis.is_empty() {
        let text = "there is no lattice to create particles on";
        let d = Diagnostic::error(Code::WRONG_ORDER, style.span, text);
        return Err(d.help("write for example `lattice sc 0.5` before this line").into());
    }
    Ok((place, vec![]))
}

fn keywords(a: &mut Args, cx: &BuildCx, style: &Word, c: &mut Creation) -> Result<()> {
    let (mut variable, mut sets) = (None, [None, None, None]);
    let mut start = style.span;
    let mut rotate = None;
    while let Some(word) = a.next() {
        match (word.text.as_str(), &mut c.place) {
            ("basis", Place::Lattice { .. }) => basis_type(a, &mut c.basis, cx.world.types)?,
            ("ratio" | "subset", Place::Lattice { subset, .. }) => *subset = Some(some_sites(word, a)?),
            ("units", _) => c.lattice_units = units_lattice(a)?,
            ("remap", Place::Single { remap, .. }) => *remap = a.flag("remap")?,
            ("overlap", Place::Random { overlap, .. }) => *overlap = a.positive("the distance")?,
            ("maxtry", Place::Random { tries, .. }) => *tries = a.integer_from(1, "maxtry")?,
            ("meshmode", Place::Mesh(mesh)) => mesh.mode = mesh::mode(a)?,
            ("radscale", Place::Mesh(mesh)) => mesh.radius_scale = a.positive("the factor of radii")?,
            ("var", Place::Lattice { .. } | Place::Random { .. }) => {
                start = word.span;
                variable = Some(deciding(a, cx, "an equal-style variable")?);
            }
            ("set", Place::Lattice { .. } | Place::Random { .. }) => {
                start = word.span;
                let d = common::axis(a, "the coordinate")?;
                sets[d] = Some(deciding(a, cx, "an internal-style variable")?);
            }
            ("group", _) => c.group = Some(group(a, cx)?),
            ("mol", Place::Lattice { .. } | Place::Single { .. } | Place::Random { .. }) => {
                c.mol = Some(molecules::copies(a, cx)?);
            }
            ("rotate", _) => rotate = Some((word, molecules::rotate(a)?)),
            (name, _) if KEYWORDS.contains(&name) => {
                let text = format!("`{name}` does not go with create_atoms {}", style.text);
                return fail(Code::CONFLICT, word.span, text);
            }
            _ => return Err(bad_keyword(a, word, &KEYWORDS, &[])),
        }
    }
    match (&mut c.mol, rotate) {
        (Some(mol), Some((_, q))) => mol.turned = Some(q),
        (None, Some((word, _))) => {
            return fail(Code::CONFLICT, word.span, "`rotate` turns molecules: `mol` is missing");
        }
        _ => {}
    }
    if c.mol.is_some() {
        if let Place::Random { overlap, .. } = &c.place
            && *overlap > 0.0
        {
            return fail(
                Code::NOT_SUPPORTED,
                style.span,
                "create_atoms random: `overlap` does not go with `mol` in perigrain",
            );
        }
        if c.basis.iter().any(|k| *k != c.kind) {
            return fail(Code::CONFLICT, style.span, "`basis` gives types to particles, not to molecules");
        }
    }
    c.test = match (variable, sets.iter().any(Option::is_some)) {
        (None, false) => None,
        (Some(variable), true) => Some(Test { variable, sets }),
        _ => {
            let d = Diagnostic::error(Code::INCOMPLETE, start, "`var` and `set` belong together");
            return Err(d.help("write for example `var test set x xx`").into());
        }
    };
    Ok(())
}

/// A variable with one number, by its name.
fn deciding(a: &mut Args, cx: &BuildCx, what: &str) -> Result<ValueRef> {
    let word = a.expect(what)?;
    let r = ValueRef { kind: RefKind::Variable, name: word.text.clone(), index: vec![], span: word.span };
    cx.value(&r, false)?;
    Ok(r)
}

/// A group that is there or can be made.
fn group(a: &mut Args, cx: &BuildCx) -> Result<String> {
    let word = a.expect("a group")?;
    let name = common::free_id(word, "the group's ID")?;
    match cx.world.groups.find(&name) {
        Some(g) if cx.world.groups.dynamic(g).is_some() => {
            let text = format!("the dynamic group `{name}` chooses its particles itself");
            fail(Code::CONFLICT, word.span, text)
        }
        None if cx.world.groups.names().count() == 32 => {
            fail(Code::TOO_LARGE, word.span, "there are 32 groups already; delete one first")
        }
        _ => Ok(name),
    }
}

/// A type, or 0 where that of a molecule template counts.
fn type_or_zero(a: &mut Args, types: usize) -> Result<u16> {
    if a.peek_text() != "0" {
        return one_type(a, types);
    }
    a.next();
    Ok(0)
}

fn one_type(a: &mut Args, types: usize) -> Result<u16> {
    let span = a.here();
    let k = a.integer("the type")?;
    match u16::try_from(k) {
        Ok(t) if k >= 1 && k as usize <= types => Ok(t),
        _ => fail(Code::BAD_VALUE, span, format!("there are types 1 to {types}, not {k}")),
    }
}

fn basis_type(a: &mut Args, basis: &mut [u16], types: usize) -> Result<()> {
    let span = a.here();
    let m = a.integer("the basis point")?;
    let kind = one_type(a, types)?;
    match usize::try_from(m - 1).ok().and_then(|k| basis.get_mut(k)) {
        Some(slot) => *slot = kind,
        None => {
            let text = format!("the lattice has basis points 1 to {}, not {m}", basis.len());
            return fail(Code::BAD_VALUE, span, text);
        }
    }
    Ok(())
}

fn some_sites(word: &Word, a: &mut Args) -> Result<Subset> {
    let amount = match word.text.as_str() {
        "ratio" => Amount::Ratio(common::fraction(a)?),
        _ => Amount::Count(a.integer_from(1, "the number of sites")?),
    };
    Ok(Subset { amount, seed: common::marsaglia_seed(a)?, span: word.span })
}

fn random(a: &mut Args, cx: &BuildCx) -> Result<Place> {
    let count = a.integer_from(0, "the number of particles")?;
    let seed = seed(a)?;
    let word = a.expect("a region or NULL")?;
    let region = match word.text.as_str() {
        "NULL" => None,
        _ => Some(cx.region(word)?.clone()),
    };
    Ok(Place::Random { count, seed, region, overlap: 0.0, tries: 1000 })
}

fn create(cx: &mut ActCx, c: &Creation) -> Result<()> {
    let domain = cx.world.domain()?.clone();
    if let Some(line) = memory::forecast(cx.world, c.place.expected(cx.world, &domain))? {
        cx.say(line);
    }
    let maker = Maker { domain: &domain, kind: c.kind, basis: &c.basis, test: c.test.as_ref() };
    let places = c.place.find(cx, &maker)?;
    if let Place::Random { count, .. } = c.place
        && (places.len() as i64) < count
    {
        let text = format!("only {} of {count} particles found a place", places.len());
        cx.note(Diagnostic::warning(Code::SUSPICIOUS, None, text));
    }
    let first = cx.world.n();
    let count = match &c.mol {
        Some(mol) => mol.put(cx.world, &places, c.kind)?,
        None => add(cx.world, &places)?,
    };
    let n = cx.world.n();
    cx.world.columns.resize(n);
    cx.world.spread_type_masses();
    cx.world.touch();
    if let Some(name) = &c.group
        && let Some(group) = cx.world.groups.find_or_add(name)
    {
        cx.world.particles.mask[first..].iter_mut().for_each(|m| *m |= group.bit());
    }
    c.note.iter().for_each(|line| cx.say(line));
    if let Place::Mesh(mesh) = &c.place {
        let (each, mode) = (places.len() as f64 / mesh.triangles.len().max(1) as f64, mesh.mode.name());
        let count = mesh.triangles.len();
        cx.say(format!("  read {count} triangles with {each:.2} atoms per triangle added in {mode} mode"));
    }
    let text = |x: [f64; 3]| x.map(|x| general(x, 8)).join(" ");
    let units = if c.lattice_units { "lattice" } else { "box" };
    cx.say(format!("Created {count} atoms"));
    let (lo, hi) = (text(domain.lo), text(domain.hi));
    cx.say(format!("  using {units} units in orthogonal box = ({lo}) to ({hi})"));
    Ok(())
}

/// Puts the new particles behind the present ones, with the ids that follow.
fn add(world: &mut World, places: &[New]) -> Result<usize> {
    let last = world.particles.last_tag();
    if u32::try_from(places.len()).ok().and_then(|n| last.checked_add(n)).is_none() {
        return fail(Code::TOO_LARGE, None, "more particles than there are ids");
    }
    if places.len() > world.n() / 4 {
        world.particles.reserve(places.len());
    }
    for (tag, new) in (last + 1..).zip(places) {
        world.particles.push(tag, new.kind, new.x);
        if let (Some(radius), Some(slot)) = (new.radius, world.particles.radius.last_mut()) {
            *slot = radius;
        }
    }
    Ok(places.len())
}

#[cfg(test)]
mod tests {
    use super::super::testing::{act, more, refused, scene};

    fn periodic(shift: f64) -> usize {
        let basis = if shift < 0.0 { shift + 1.0 } else { shift };
        let w = scene(&format!(
            "units si\nlattice custom 1.0 basis {basis:.17} 0.5 0.5\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\n\
             create_atoms 1 box"
        ));
        w.n()
    }

    // Oracle: the same deck with sites shifted by a little; LAMMPS takes 27 except within 3e-6 … 6e-6 below a face.
    #[test]
    fn one_site_of_two_at_a_periodic_face() {
        for (shift, count) in
            [(0.0, 27), (3e-6, 27), (-2.7e-6, 27), (-3.3e-6, 18), (-5.7e-6, 18), (-6.3e-6, 27)]
        {
            assert_eq!(periodic(shift), count, "{shift}");
        }
    }

    // Oracle: 27, 27, 64, 27 particles on a unit lattice in a box 0 … 3 with these faces.
    #[test]
    fn faces_decide_about_sites_on_them() {
        for (faces, count) in [("p p p", 27), ("f f f", 27), ("s s s", 64), ("m m m", 27)] {
            let mut w =
                scene(&format!("units si\nboundary {faces}\nlattice sc 1\nregion b block 0 3 0 3 0 3"));
            more(&mut w, "create_box 1 b\ncreate_atoms 1 region b");
            assert_eq!(w.n(), count, "{faces}");
        }
    }

    // Oracle: `create_atoms 1 random 4 9281 NULL` in a box 0 … 3, then `random 4 77 s` in a sphere.
    #[test]
    fn random_places_are_lammps_places() {
        let mut w = scene("region b block 0 3 0 3 0 3\ncreate_box 1 b\nlattice sc 1");
        more(&mut w, "create_atoms 1 random 4 9281 NULL\nregion s sphere 1.5 1.5 1.5 1.2 units box");
        more(&mut w, "create_atoms 1 random 4 77 s");
        assert_eq!(w.particles.x[0], [2.0628833235534296, 2.8800189624913122, 2.4787025914893963]);
        assert_eq!(w.particles.x[3], [2.1246090136117344, 2.3036917724198158, 0.14761905984376511]);
        assert_eq!(w.particles.x[4], [1.8714421331749496, 1.9279322713743583, 0.95768498883474873]);
        assert_eq!(w.particles.x[7], [2.1848301728651069, 1.0407153438500667, 0.70278408806900694]);
        assert_eq!(w.particles.tag, [1, 2, 3, 4, 5, 6, 7, 8]);
    }

    // Oracle: two small balls far apart (most attempts miss), then 200 particles that keep 0.3 apart.
    #[test]
    fn attempts_are_counted_as_in_lammps() {
        let mut w = scene("units si\nregion b block 0 4 0 3 0 3 units box\ncreate_box 2 b");
        more(
            &mut w,
            "region tiny sphere 0.5 0.5 0.5 0.001 units box\nregion tiny2 sphere 3.5 2.5 2.5 0.3 units box",
        );
        more(&mut w, "region u union 2 tiny tiny2\ncreate_atoms 1 random 40 123 u");
        more(&mut w, "create_atoms 1 random 200 124 NULL overlap 0.3");
        assert_eq!(w.n(), 240);
        assert_eq!(w.particles.x[2], [3.7333863149561854, 2.4255354054144278, 2.4085588002961864]);
        assert_eq!(w.particles.x[239], [1.1922303890773236, 1.3621119169341922, 0.014987912967329806]);
    }

    #[test]
    fn single_counts_in_lattice_spacings() {
        let mut w = scene("units si\nlattice sc 0.5\nregion b block 0 4 0 4 0 4\ncreate_box 2 b");
        let said = act(&mut w, "create_atoms 2 single 1 2 3", &[]).unwrap();
        assert_eq!(w.particles.x[0], [0.5, 1.0, 1.5]);
        assert_eq!(said[0], "Created 1 atoms");
        assert_eq!(said[1], "  using lattice units in orthogonal box = (0 0 0) to (2 2 2)");
        more(
            &mut w,
            "create_atoms 1 single 2 2 2 units box\ncreate_atoms 1 single 2.5 2 2 units box remap yes",
        );
        assert_eq!((w.n(), w.particles.x[1]), (2, [0.5, 0.0, 0.0]));
    }

    #[test]
    fn basis_points_take_types() {
        let mut w =
            scene("units si\nlattice bcc 1\nregion b block 0 2 0 2 0 2\ncreate_box 2 b\nmass 1 3\nmass 2 5");
        more(&mut w, "create_atoms 1 box basis 2 2");
        assert_eq!(w.n(), 16);
        assert!((0..16).all(|i| w.particles.kind[i] as usize == 1 + i % 2));
        assert_eq!(&w.particles.mass[..2], [3.0, 5.0]);
    }

    #[test]
    fn blames_the_right_word() {
        let w = scene("region b block 0 3 0 3 0 3\ncreate_box 1 b");
        assert_eq!(refused(&w, "create_atoms 1 box").0, "box");
        assert_eq!(refused(&w, "create_atoms 2 single 0 0 0").0, "2");
        assert_eq!(refused(&w, "create_atoms 1 region c").0, "c");
        assert_eq!(refused(&w, "create_atoms 1 single 0 0 0 mol a 3").0, "a");
        assert_eq!(refused(&w, "create_atoms 1 single 0 0 0 overlap 3").0, "overlap");
        assert_eq!(
            refused(&Default::default(), "create_atoms 1 single 0 0 0").0,
            "create_atoms 1 single 0 0 0"
        );
    }
}
