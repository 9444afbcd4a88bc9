//! `create_atoms`: particles on lattice sites, single ones, at random places, on a surface, or packed.

mod mesh;
pub(crate) mod molecules;
mod pack;
mod packing;
mod places;
pub(super) mod subset;
mod volumes;
mod words;

use super::{Act, CommandStyle};
use molecules::Copies;
use pack::Pack;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{self, in_group, orthogonal, scales};
use perigrain_styles::words::{At, Forms, OneType, Syntax, Units, Value};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::{Particles, Region, World, memory};
use places::{Maker, New, Place, Test};
use subset::{Amount, Subset};
use words::{
    Also, Basis, Copied, Decision, InRegion, Joined, Named, Number, Random, Shared, Single, Sites, Way,
};

/// The command.
pub struct CreateAtoms;

impl Style for CreateAtoms {
    fn name(&self) -> &'static str {
        "create_atoms"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(Way::FORMS),
            summary: "Creates particles on lattice sites, at one place, at random places, on a surface, or densely packed.",
            text: "Sites are taken in LAMMPS' order (third lattice edge slowest, basis points fastest) and must lie in lo ≤ x < hi \
                   of the box; along periodic dimensions both faces move down by about 1e-6 of the edge length, so that exactly one \
                   of two equivalent sites is taken. New ids follow the largest one in use. A sphere starts with diameter 1 and \
                   density 1, a peridynamic particle with volume 1 and mass 1.\n\n\
                   Molecules: copies get molecule IDs behind the largest one, LAMMPS' random turns, and with `overlap` D all their \
                   particles keep D away from all others. Not with `basis`.\n\n\
                   `volumes cut` (not in LAMMPS; peridynamic particles alone) makes volumes add up to the volume of the body, \
                   whatever its shape. The cell of a site is the unit cell around it or, on a lattice of several basis points, what \
                   is nearer to it than to other sites. Cells that the surface passes are cut exactly where the region is a mesh at \
                   rest and the lattice has one basis point, and by 1021 places in each of them otherwise: 0.2 % of a cell (root \
                   mean square), and of the sum 2·10⁻⁴ at worst for twenty bodies of 10 to 20 cells across.\n\n\
                   What lies in the cell of a site outside goes to the nearest particle, in equal parts where several are as near, \
                   so that volumes may be larger than a cell; how much that is stands in the log, and where more than a thousandth \
                   goes farther than 1.8 spacings (a body thinner than the lattice) a warning. Masses are densities for these \
                   particles and need no change. Not with `ratio`, `subset`, `var` and `mol`, which leave sites out.\n\n\
                   `pack`, `opal` and `aggregate` are perigrain's own, and so are their random numbers. They need spheres, and take \
                   lengths in box units. Shares up to 0.6 come out easily, 0.63 nearly. The log has the number, the share, the \
                   overlaps and the rounds; what was not reached is a warning. Same seed, same bits for any number of threads. \
                   Density is 1, as for all spheres: `set` changes it. Particles that are there already are not seen.\n\n\
                   Boxes may lean: a region that is the whole box continues through faces that repeat, any other has walls all \
                   round there. Spheres keep inside of the region by their radius; along periodic edges that a region spans they \
                   lie across the face. The region may be any shape at rest, inside or outside, or an intersection. `create_bonds \
                   gap` bonds packings.",
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
        let kind = type_or_zero(a, cx)?;
        let style = a.clone().expect("a style of create_atoms")?.clone();
        let mut c = creation(Way::form(a, cx)?, kind, &style, cx)?;
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

/// What a line creates.
fn creation(way: Way, kind: u16, style: &Word, cx: &BuildCx) -> Result<Creation> {
    let mut note = vec![];
    let (place, also) = match way {
        Way::Box(sites) => on_sites(sites, None),
        Way::Region(InRegion { region, sites, volumes }) => {
            let (place, also) = on_sites(sites, Some(region));
            (place, Also { cut: volumes.map(|v| v.span), ..also })
        }
        Way::Single(Single { x, remap, shared, copied }) => {
            (Place::Single { x, remap }, Also { shared, copied, ..Also::default() })
        }
        Way::Random(Random { count, seed, region, overlap, maxtry, decision, shared, copied }) => {
            let place = Place::Random { count, seed: seed.0, region: region.0, overlap, tries: maxtry };
            (place, Also { decision, shared, copied, ..Also::default() })
        }
        Way::Mesh(line) => {
            let (mesh, lines) = mesh::read(&line, cx)?;
            note = lines;
            (Place::Mesh(mesh), Also { shared: line.shared, ..Also::default() })
        }
        Way::Pack(line) => packed(line.read(style, cx)?),
        Way::Opal(line) => packed(line.read(style, cx)?),
        Way::Aggregate(line) => packed(line.read(style, cx)?),
    };
    if matches!(place, Place::Lattice { .. }) && cx.world.lattice.basis.is_empty() {
        let text = "there is no lattice to create particles on";
        let d = Diagnostic::error(Code::WRONG_ORDER, style.span, text);
        return Err(d.help("write for example `lattice sc 0.5` before this line").into());
    }
    let mol = turned(also.copied)?;
    let basis = basis_types(&also.basis, kind, cx)?;
    if mol.is_some() && !also.basis.is_empty() && basis.iter().any(|k| *k != kind) {
        return fail(Code::CONFLICT, style.span, "`basis` gives types to particles, not to molecules");
    }
    if let Some(span) = also.cut {
        let some = matches!(place, Place::Lattice { subset: Some(_), .. }) || also.decision.var.is_some();
        refuse_cut(cx, span, some || mol.is_some())?;
    }
    let (test, group) = (test(also.decision)?, also.shared.joined.group);
    let lattice_units = also.shared.units == Units::Lattice;
    Ok(Creation { kind, place, basis, lattice_units, test, mol, group, cut: also.cut, note })
}

/// Lattice sites: of `ratio` and `subset` the later one counts.
fn on_sites(sites: Sites, region: Option<Region>) -> (Place, Also) {
    let Sites { basis, ratio, subset, decision, shared, copied } = sites;
    let part = ratio.map(|At { value: (part, seed), span, .. }| Subset {
        amount: Amount::Ratio(part.0),
        seed: seed.0,
        span,
    });
    let number = subset.map(|At { value: Number { count, seed }, span, .. }| Subset {
        amount: Amount::Count(count),
        seed: seed.0,
        span,
    });
    let subset = [part, number].into_iter().flatten().max_by_key(|s| s.span.start);
    (Place::Lattice { region, subset }, Also { basis, decision, shared, copied, cut: None })
}

/// A packing.
fn packed((pack, joined): (Pack, Joined)) -> (Place, Also) {
    let shared = Shared { joined, ..Shared::default() };
    (Place::Pack(Box::new(pack)), Also { shared, ..Also::default() })
}

/// The molecule of which copies are made, turned as `rotate` says.
fn turned(Copied { mol, rotate }: Copied) -> Result<Option<Copies>> {
    let turned = rotate.as_ref().map(|turn| turn.value.quat()).transpose()?;
    match (mol, rotate) {
        (None, Some(turn)) => fail(Code::CONFLICT, turn.span, "`rotate` turns molecules: `mol` is missing"),
        (mol, _) => Ok(mol.map(|mol| mol.turned(turned))),
    }
}

/// The type of each point of the unit cell.
fn basis_types(points: &[Basis], kind: u16, cx: &BuildCx) -> Result<Vec<u16>> {
    let mut basis = vec![kind; cx.world.lattice.basis.len()];
    for Basis { point: At { value: m, span, .. }, kind } in points {
        match usize::try_from(m - 1).ok().and_then(|k| basis.get_mut(k)) {
            Some(slot) => *slot = kind.0,
            None => {
                let text = format!("the lattice has basis points 1 to {}, not {m}", basis.len());
                return fail(Code::BAD_VALUE, *span, text);
            }
        }
    }
    Ok(basis)
}

/// What decides about each place.
fn test(Decision { var, set }: Decision) -> Result<Option<Test>> {
    let mut sets = [None, None, None];
    let mut start = var.as_ref().map(|v| v.span);
    for At { value: (axis, Named(variable)), span, .. } in set {
        start = start.or(Some(span));
        sets[axis.0] = Some(variable);
    }
    match (var, sets.iter().any(Option::is_some)) {
        (None, false) => Ok(None),
        (Some(At { value: Named(variable), .. }), true) => Ok(Some(Test { variable, sets })),
        _ => {
            let d = Diagnostic::error(Code::INCOMPLETE, start, "`var` and `set` belong together");
            Err(d.help("write for example `var test set x xx`").into())
        }
    }
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
fn type_or_zero(a: &mut Args, cx: &BuildCx) -> Result<u16> {
    if a.eat("0") { Ok(0) } else { OneType::value("the type", a, cx).map(|kind| kind.0) }
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
