//! `create_atoms`: particles on lattice sites, single ones, at random places, on a surface, or packed.

mod mesh;
pub(crate) mod molecules;
mod pack;
mod packing;
mod places;
pub(super) mod subset;
mod volumes;

use super::{Act, CommandStyle};
use molecules::Copies;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_styles::common::{
    self, bad_keyword, in_group, orthogonal, scales, seed, units_lattice, unknown_style,
};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::{Particles, World, memory};
use places::{Maker, New, Place, Test};
use subset::{Amount, Subset};

/// The command.
pub struct CreateAtoms;

const KEYWORDS: [&str; 18] = [
    "basis", "ratio", "subset", "units", "remap", "overlap", "maxtry", "var", "set", "group", "meshmode",
    "radscale", "mol", "rotate", "sizes", "rounds", "axis", "volumes",
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
                     [mol ID SEED] [rotate ANGLE X Y Z] [volumes cut]\n\
                     create_atoms TYPE pack REGION SHARE|number N SEED \
                     [sizes mono D|uniform D1 D2|lognormal D S|mix number|mass D1 P1 D2 P2 … [types T1 T2 …]] [overlap O] \
                     [rounds N] [group ID]\n\
                     create_atoms TYPE opal REGION PORE S SHARE|number N SEED [sizes mono D] [axis 111|100] [overlap O] [rounds N] \
                     [group ID]\n\
                     create_atoms TYPE aggregate REGION SHARE SEED POROSITY LAMBDA [sizes mono D] [overlap O] [rounds N] \
                     [group ID]",
            summary: "Creates particles on lattice sites, at one place, at random places, on a surface, or densely packed.",
            text: "Sites are taken in LAMMPS' order (third lattice edge slowest, basis points fastest) and must lie in \
                   lo ≤ x < hi of the box; along periodic dimensions both faces move down by about 1e-6 of the edge \
                   length, so that exactly one of two equivalent sites is taken. `region` also tests the region. `single` \
                   takes lattice spacings unless `units box` is given; `remap yes` wraps its place into a periodic box. \
                   `random` draws from LAMMPS' Park–Miller stream; `overlap D` keeps new particles D away from all \
                   others, in lattice spacings (along x) unless `units box` is given, within `maxtry` attempts each (default 1000). `basis M TYPE` gives the M-th point of the unit \
                   cell another type. `ratio` and `subset` take a random part of the sites, exact in number, the sites \
                   that LAMMPS takes.\n\n\
                   `var` names an equal-style variable that decides about each place of `box`, `region` and `random`: no \
                   particle where it is zero. `set x NAME` gives the internal-style variable NAME the coordinate before \
                   it is asked.\n\n\
                   `mesh` reads triangles from an STL, OBJ, PLY or VTP file (`region mesh` says what of them) in box units (`units box` must be said). \
                   `meshmode bisect R` (default, with R = 1) halves triangles at their longest side \
                   until their corners are on average no farther than R from the centre, and puts a particle there; \
                   `qrand D` puts D particles per area at places of a quasi-random sequence. Spheres take their radius \
                   from the triangle, times `radscale`.\n\n\
                   New ids follow the largest one in use; `group` puts the new particles into a group, made if it is not \
                   there. A sphere starts with diameter 1 and density 1, a peridynamic particle with volume 1 and mass \
                   1.\n\n\
                   `volumes cut` (not in LAMMPS; `region` and peridynamic particles alone) gives each particle the part of its \
                   lattice cell that lies inside region and box as its volume, so that they add up to the volume of the body, \
                   whatever its shape. The cell of a site is the unit cell around it or, on a lattice of several basis points, \
                   what is nearer to it than to other sites. Cells that the surface passes are cut exactly where the \
                   region is a mesh at rest and the lattice has one basis point, and by 1021 places in each \
                   of them otherwise: 0.2 % of a cell (root mean square), and of the sum 2·10⁻⁴ at worst for twenty bodies of 10 to 20 cells across. \
                   What lies in the cell of a site outside goes to the nearest particle, in equal parts where several are as \
                   near, so that volumes may be larger than a cell; how much that is stands in the log, and where more than a thousandth goes \
                   farther than 1.8 spacings (a body thinner than the lattice) a warning. Masses are densities for these particles and \
                   need no change. Not with `ratio`, `subset`, `var` and `mol`, which leave sites out.\n\n\
                   `mol ID SEED` puts a copy of a `molecule` template in each place, its centre there, turned at random or as \
                   `rotate ANGLE X Y Z` [degrees, axis] says; TYPE, which may be 0, is added to the types of the template. Copies \
                   get molecule IDs behind the largest one. LAMMPS' random turns; with `overlap` D all its particles keep D away from all others. Not with `basis`.\n\n\
                   `pack`, `opal` and `aggregate` are perigrain's own, and so are their random numbers. They need spheres, and take \
                   lengths in box units. `pack` fills a part SHARE of the volume of a region (what the box holds of it) with \
                   spheres at random places, which then push each other away until they overlap by less than a thousandth of \
                   their diameters on average, or by `overlap` O at most, a part of the distance of touching spheres; in at \
                   most `rounds` N (1000). Shares up to 0.6 come out easily, 0.63 nearly. `overlap 0` makes all diameters \
                   smaller in the end, by what is needed for no overlap at all. The log has the number, the share, the \
                   overlaps and the rounds; what was not reached is a warning. Same seed, same bits for any number of threads. \
                   Diameters are all alike (`mono`, 1 by default), uniform between two, `lognormal` with median D and \
                   standard deviation S of the logarithm (up to 0.5), cut at 2.5 deviations, or a `mix` of two and more with their parts \
                   of the number or of the mass, however these add up; behind `types` each of them has a type of its own. In the place of SHARE \
                   `number N` sets the number of spheres, of all sizes together. Boxes may lean: a region that is the whole box continues through \
                   faces that repeat, any other has walls all round there. Spheres keep inside of the region \
                   by their radius; along periodic edges that a region spans they lie across the face. The region may be \
                   any shape at rest, inside or outside, or an intersection. Density is 1, as for all spheres: `set` changes it. \
                   Particles that are there already are not seen.\n\n\
                   `opal` packs the walls of an inverse opal: pores of diameter PORE on a face-centred cubic lattice, beside \
                   each other S diameters apart (below 1 windows open between them), one in the lower corner of the region; \
                   SHARE is that of spheres in what is left between the pores. Along z lies the direction [111] of the lattice, x \
                   along a row of pores, or [100]. `aggregate` packs the region to SHARE and takes spheres away to POROSITY \
                   where a random field of wavelength LAMBDA (64 plane waves) is lowest; of what is left only the largest part \
                   stays that hangs together over gaps of up to 0.1 mean diameters and comes within a diameter of both ends \
                   of the region, along its longest edge. `create_bonds gap` bonds packings.",
            example: "create_atoms 1 region disc subset 20 4711",
        }
    }
}

/// A parsed line.
struct Creation {
    kind: u16,
    place: Place,
    /// Type of each basis point.
    basis: Vec<u16>,
    lattice_units: bool,
    test: Option<Test>,
    mol: Option<Copies>,
    group: Option<String>,
    /// The place of `volumes cut`.
    cut: Option<Span>,
    /// Lines for the log before the particles are made.
    note: Vec<String>,
}

impl CommandStyle for CreateAtoms {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let types = cx.world.types;
        let first = a.here();
        let kind = type_or_zero(a, types)?;
        let style = a.expect("box, region, single, random, mesh, pack, opal or aggregate")?;
        let (place, note) = place(style, a, cx)?;
        let basis = vec![kind; cx.world.lattice.basis.len()];
        let mut c = Creation {
            kind,
            place,
            basis,
            lattice_units: true,
            test: None,
            mol: None,
            group: None,
            cut: None,
            note,
        };
        keywords(a, cx, style, &mut c)?;
        match &c.mol {
            Some(mol) => mol.check_types(kind, types)?,
            None if kind == 0 => {
                return fail(Code::BAD_VALUE, first, format!("there are types 1 to {types}, not 0"));
            }
            None => {}
        }
        let scale = scales(cx.world, c.lattice_units);
        match &mut c.place {
            Place::Single { x, .. } => *x = [0, 1, 2].map(|d| x[d] * scale[d]),
            // A distance has no direction; LAMMPS takes the spacing along x.
            Place::Random { overlap, .. } => *overlap *= scale[0],
            _ => {}
        }
        if matches!(c.place, Place::Mesh(_)) && c.lattice_units {
            let d = Diagnostic::error(
                Code::INCOMPLETE,
                style.span,
                "triangles are in box units: write `units box`",
            );
            return Err(d.help("add `units box` to this line").into());
        }
        let packed = matches!(c.place, Place::Pack(_));
        let mut settles = if packed { vec!["particles", "diameter"] } else { vec!["particles"] };
        settles.extend(c.cut.map(|_| "volume"));
        c.lattice_units &= !packed;
        Ok(in_group(settles, c.group.clone(), move |cx| create(cx, &c)))
    }
}

/// Where particles are made, and the lines for the log about it.
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
        "pack" | "opal" | "aggregate" => Place::Pack(Box::new(pack::parse(style, a, cx)?)),
        _ => {
            const KNOWN: [&str; 8] =
                ["box", "region", "single", "random", "mesh", "pack", "opal", "aggregate"];
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
            ("sizes" | "rounds" | "axis" | "overlap", Place::Pack(pack)) => {
                if !pack.keyword(word, a, cx.world.types)? {
                    return Err(does_not_go(word, style));
                }
            }
            ("units", place) if !matches!(place, Place::Pack(_)) => c.lattice_units = units_lattice(a)?,
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
            ("volumes", Place::Lattice { region: Some(_), .. }) => {
                a.choice("volumes", &["cut"])?;
                c.cut = Some(word.span);
            }
            ("group", _) => c.group = Some(group(a, cx)?),
            ("mol", Place::Lattice { .. } | Place::Single { .. } | Place::Random { .. }) => {
                c.mol = Some(molecules::copies(a, cx)?);
            }
            ("rotate", _) => rotate = Some((word, molecules::rotate(a)?)),
            (name, _) if KEYWORDS.contains(&name) => return Err(does_not_go(word, style)),
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
    if c.mol.is_some() && c.basis.iter().any(|k| *k != c.kind) {
        return fail(Code::CONFLICT, style.span, "`basis` gives types to particles, not to molecules");
    }
    if let Some(span) = c.cut {
        let some = matches!(c.place, Place::Lattice { subset: Some(_), .. }) || variable.is_some();
        refuse_cut(cx, span, some || c.mol.is_some())?;
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

/// Refuses `volumes cut` where particles have no volume, or where sites are left out.
fn refuse_cut(cx: &BuildCx, span: Span, some: bool) -> Result<()> {
    let style = &cx.world.particles.style;
    if !style.peri {
        let text = format!("particles of atom_style {} have no volume of their own", style.name());
        let d = Diagnostic::error(Code::CONFLICT, span, text);
        return Err(d.help("`volumes cut` is for `atom_style peri`").into());
    }
    if some {
        let text =
            "volumes are cut for all sites of a region: `ratio`, `subset`, `var` and `mol` leave some out";
        return fail(Code::CONFLICT, span, text);
    }
    if cx.world.settings.two_dimensional {
        let d = Diagnostic::error(Code::NOT_SUPPORTED, span, "volumes are cut in space, not in a plane");
        return Err(d.help("take `dimension 2` out, or give volumes by `set … volume`").into());
    }
    Ok(())
}

/// The refusal of a keyword of other forms.
fn does_not_go(word: &Word, style: &Word) -> Diagnostics {
    let text = format!("`{}` does not go with create_atoms {}", word.text, style.text);
    Diagnostic::error(Code::CONFLICT, word.span, text).into()
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
        cx.print(line);
    }
    let maker =
        Maker { domain: &domain, kind: c.kind, basis: &c.basis, test: c.test.as_ref(), mol: c.mol.as_ref() };
    let places = c.place.find(cx, &maker)?;
    if let Place::Random { count, .. } = c.place
        && (places.len() as i64) < count
    {
        let text = format!("only {} of {count} particles found a place", places.len());
        cx.note(Diagnostic::warning(Code::SUSPICIOUS, None, text));
    }
    let shares = match (&c.place, c.cut) {
        (Place::Lattice { region: Some(region), .. }, Some(span)) => {
            if domain.tilted() {
                return Err(orthogonal("`volume cut`").at(span));
            }
            Some(volumes::cut(&cx.world.lattice, &domain, region, &places, span)?)
        }
        _ => None,
    };
    let first = cx.world.n();
    let count = match &c.mol {
        Some(mol) => mol.put(cx.world, &places, c.kind)?,
        None => add(cx.world, &places)?,
    };
    let n = cx.world.n();
    if matches!(c.place, Place::Pack(_)) {
        weigh(&mut cx.world.particles, first);
    }
    if let Some(shares) = &shares {
        cx.world.particles.volume[first..].copy_from_slice(&shares.each);
    }
    cx.world.columns.resize(n);
    cx.world.spread_type_masses();
    cx.world.touch();
    if let Some(name) = &c.group
        && let Some(group) = cx.world.groups.find_or_add(name)
    {
        cx.world.particles.mask[first..].iter_mut().for_each(|m| *m |= group.bit());
    }
    c.note.iter().for_each(|line| cx.print(line));
    if let Place::Mesh(mesh) = &c.place {
        let (each, mode) = (places.len() as f64 / mesh.triangles.len().max(1) as f64, mesh.mode.name());
        let count = mesh.triangles.len();
        cx.print(format!("  read {count} triangles with {each:.2} atoms per triangle added in {mode} mode"));
    }
    let units = if c.lattice_units { "lattice" } else { "box" };
    cx.print(format!("Created {count} atoms"));
    cx.print(format!("  using {units} units in {}", domain.describe(domain.lo, domain.hi)));
    if let Some(shares) = shares {
        cx.print(shares.line);
        shares.warning.into_iter().for_each(|d| cx.note(d));
    }
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

/// Gives the spheres from `first` on the mass of their size at density 1, which all spheres start with.
fn weigh(p: &mut Particles, first: usize) {
    if p.style.sphere_mass {
        for i in first..p.len() {
            p.mass[i] = 4.0 * std::f64::consts::PI / 3.0 * p.radius[i].powi(3);
        }
    }
}

#[cfg(test)]
mod tests;
