//! `create_atoms`: particles on lattice sites, single ones, or at random places.

use super::common::{self, bad_keyword, not_here, on_particles, scales, seed, units_lattice, unknown_style};
use super::places::{New, Place};
use super::{Act, CommandStyle};
use crate::diag::{Code, Diagnostic, Result, fail};
use crate::lang::Args;
use crate::math::cformat::general;
use crate::styles::{ActCx, BuildCx, Doc, Style};
use crate::world::{World, memory};

/// The command.
pub struct CreateAtoms;

const KEYWORDS: [&str; 5] = ["basis", "units", "remap", "overlap", "maxtry"];
const ELSEWHERE: [&str; 10] =
    ["mol", "ratio", "subset", "var", "set", "rotate", "group", "radscale", "meshmode", "radthresh"];

impl Style for CreateAtoms {
    fn name(&self) -> &'static str {
        "create_atoms"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "create_atoms TYPE box | region ID | single X Y Z | random N SEED ID|NULL  [basis M TYPE] \
                     [units lattice|box] [remap yes|no] [overlap D] [maxtry N]",
            summary: "Creates particles on the sites of the lattice, at one place, or at random places.",
            text: "Sites are taken in LAMMPS' order (third lattice edge slowest, basis points fastest) and must lie in \
                   lo ≤ x < hi of the box; along periodic dimensions both faces move down by about 1e-6 of the edge \
                   length, so that exactly one of two equivalent sites is taken. `region` also asks the region. `single` \
                   takes lattice spacings unless `units box` is said; `remap yes` wraps its place into a periodic box. \
                   `random` draws from LAMMPS' Park–Miller stream; `overlap D` keeps new particles D away from all \
                   others, within `maxtry` attempts each (default 1000). `basis M TYPE` gives the M-th point of the unit \
                   cell another type. New ids follow the largest one in use. A sphere starts with diameter 1 and \
                   density 1, a peridynamic particle with volume 1 and mass 1.",
            example: "create_atoms 1 region disc",
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
}

impl CommandStyle for CreateAtoms {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let types = cx.world.types;
        let kind = one_type(a, types)?;
        let style = a.expect("box, region, single or random")?;
        let mut place = match style.text.as_str() {
            "box" => Place::Lattice(None),
            "region" => Place::Lattice(Some(cx.region(a.expect("a region")?)?.clone())),
            "single" => {
                let x = [a.number("x")?, a.number("y")?, a.number("z")?];
                Place::Single { x, remap: false }
            }
            "random" => random(a, cx)?,
            "mesh" => return Err(not_here(style, "create_atoms")),
            _ => {
                const KNOWN: [&str; 4] = ["box", "region", "single", "random"];
                return Err(unknown_style(style, "style of create_atoms", &KNOWN));
            }
        };
        let on_sites = matches!(place, Place::Lattice(_));
        if on_sites && cx.world.lattice.basis.is_empty() {
            let d = Diagnostic::error(
                Code::WRONG_ORDER,
                style.span,
                "there is no lattice to create particles on",
            );
            return Err(d.help("write for example `lattice sc 0.5` before this line").into());
        }
        let mut basis = vec![kind; cx.world.lattice.basis.len()];
        let mut lattice_units = true;
        while let Some(word) = a.next() {
            match (word.text.as_str(), &mut place) {
                ("basis", _) => basis_type(a, &mut basis, types)?,
                ("units", _) => lattice_units = units_lattice(a)?,
                ("remap", Place::Single { remap, .. }) => *remap = a.flag("remap")?,
                ("overlap", Place::Random { overlap, .. }) => *overlap = a.positive("the distance")?,
                ("maxtry", Place::Random { tries, .. }) => *tries = a.integer_from(1, "maxtry")?,
                ("remap" | "overlap" | "maxtry", _) => {
                    let text = format!("`{}` does not go with create_atoms {}", word.text, style.text);
                    return fail(Code::CONFLICT, word.span, text);
                }
                _ => return Err(bad_keyword(a, word, &KEYWORDS, &ELSEWHERE)),
            }
        }
        if let Place::Single { x, .. } = &mut place {
            let scale = scales(cx.world, lattice_units);
            *x = [0, 1, 2].map(|d| x[d] * scale[d]);
        }
        let creation = Creation { kind, place, basis, lattice_units };
        Ok(on_particles(vec!["particles"], move |cx| create(cx, &creation)))
    }
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
    let places = c.place.find(cx.world, &domain, c.kind, &c.basis);
    if let Place::Random { count, .. } = c.place
        && (places.len() as i64) < count
    {
        let text = format!("only {} of {count} particles found a place", places.len());
        cx.note(Diagnostic::warning(Code::SUSPICIOUS, None, text));
    }
    add(cx.world, &places)?;
    let text = |x: [f64; 3]| x.map(|x| general(x, 8)).join(" ");
    let units = if c.lattice_units { "lattice" } else { "box" };
    cx.say(format!("Created {} atoms", places.len()));
    cx.say(format!(
        "  using {units} units in orthogonal box = ({}) to ({})",
        text(domain.lo),
        text(domain.hi)
    ));
    Ok(())
}

/// Puts the new particles behind the present ones, with the ids that follow.
fn add(world: &mut World, places: &[New]) -> Result<()> {
    let last = world.particles.last_tag();
    if u32::try_from(places.len()).ok().and_then(|n| last.checked_add(n)).is_none() {
        return fail(Code::TOO_LARGE, None, "more particles than there are ids");
    }
    if places.len() > world.n() / 4 {
        world.particles.reserve(places.len());
    }
    for (tag, &(kind, x)) in (last + 1..).zip(places) {
        world.particles.push(tag, kind, x);
    }
    let n = world.n();
    world.columns.resize(n);
    world.spread_type_masses();
    world.touch();
    Ok(())
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
        assert_eq!(refused(&w, "create_atoms 1 single 0 0 0 mol a 3").0, "mol");
        assert_eq!(refused(&w, "create_atoms 1 single 0 0 0 overlap 3").0, "overlap");
        assert_eq!(
            refused(&Default::default(), "create_atoms 1 single 0 0 0").0,
            "create_atoms 1 single 0 0 0"
        );
    }
}
