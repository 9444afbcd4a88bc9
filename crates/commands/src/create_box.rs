//! `create_box`: the simulation box and the number of types.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::{self, bad_keyword, setting};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::region::{INFINITE, Shape};
use perigrain_world::{Domain, Region, memory};

/// The command.
pub struct CreateBox;

const KEYWORDS: [&str; 5] =
    ["bond/types", "angle/types", "extra/bond/per/atom", "extra/angle/per/atom", "extra/special/per/atom"];

/// Keywords LAMMPS has: room for dihedrals and the like.
const ELSEWHERE: [&str; 4] =
    ["dihedral/types", "improper/types", "extra/dihedral/per/atom", "extra/improper/per/atom"];

impl Style for CreateBox {
    fn name(&self) -> &'static str {
        "create_box"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "create_box N REGION [bond/types N] [angle/types N] [extra/bond/per/atom N] [extra/angle/per/atom N] [extra/special/per/atom N]",
            summary: "Creates the simulation box from a bounded region, for N particle types.",
            text: "The box is the smallest one along the axes that holds the region, which must have finite bounds and \
                   `side in`. A prism becomes a triclinic box: its edges lean as those of the prism (tilts xy, xz and yz), and may lean \
                   otherwise later (`change_box`, `fix deform`). Where a tilt is more than half of the length along which it leads, a \
                   warning says so. General triclinic boxes (`NULL`) are refused. Shrink-wrapped faces start 1e-4 of the edge length outside it, as in LAMMPS. `bond/types` \
                   gives the number of bond types, for atom styles with bonds, `angle/types` that of angle types; room for bonds per particle is not limited, \
                   `extra/…` only has to be said for LAMMPS.",
            example: "create_box 3 world",
        }
    }
}

impl CommandStyle for CreateBox {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        if cx.world.domain.is_some() {
            return fail(Code::WRONG_ORDER, a.name_span(), "the simulation box is defined already");
        }
        let span = a.here();
        let types = a.integer_from(1, "the number of types")?;
        if types > i64::from(u16::MAX) {
            return fail(Code::BAD_VALUE, span, format!("at most {} types are possible", u16::MAX));
        }
        if let Some(d) = memory::lacking_for_types(types as usize) {
            return Err(d.help("forces have a table of all pairs of types").at(span).into());
        }
        let word = a.expect("a region")?;
        if word.text == "NULL" {
            return Err(common::not_here(word, "a general triclinic box: create_box"));
        }
        let region = cx.region(word)?;
        if cx.checking && region.motion.is_none() && region.follows() && !region.outside {
            return Ok(guessed_box(region, types as usize, topology(a, cx)?));
        }
        if region.motion.is_some() || region.outside {
            return fail(
                Code::WRONG_KIND,
                word.span,
                "the box must be a bounded region at rest with `side in`",
            );
        }
        // Of a prism the corners count and how it leans, not what is around it.
        let (bounds, tilt) = match &region.shape {
            Shape::Prism { lo, hi, tilt } => (Some((*lo, *hi)), Some(*tilt)),
            shape => (shape.bounds(), None),
        };
        let Some((lo, hi)) = bounds else {
            return fail(Code::WRONG_KIND, word.span, "the box must be a bounded region with `side in`");
        };
        if (0..3).any(|d| {
            hi[d].partial_cmp(&lo[d]) != Some(std::cmp::Ordering::Greater)
                || lo[d].abs() >= INFINITE
                || hi[d].abs() >= INFINITE
        }) {
            return fail(Code::BAD_VALUE, word.span, "the box must have finite edges longer than zero");
        }
        let [bond_types, angle_types] = topology(a, cx)?;
        let flat = cx.world.settings.two_dimensional;
        common::check_flat(cx.world.settings.boundary, (lo[2], hi[2]), flat).map_err(|d| d.at(word.span))?;
        common::check_volume([0, 1, 2].map(|d| hi[d] - lo[d])).map_err(|e| e.at(word.span))?;
        Ok(setting(move |cx| {
            let mut domain = Domain { flat, tilt, ..Domain::new(lo, hi, cx.world.settings.boundary) };
            cx.print(format!("Created {}", domain.describe(lo, hi)));
            common::warn_of_skew(cx, &domain);
            cx.print("  1 by 1 by 1 MPI processor grid");
            domain.open_shrinking_faces();
            cx.world.domain = Some(domain).into();
            cx.world.types = types as usize;
            (cx.world.bonds.types, cx.world.bonds.angles.types) = (bond_types, angle_types);
            cx.world.type_mass = vec![None; types as usize].into();
            Ok(())
        }))
    }
}

/// While a deck is only checked: a box of some size where variables determine how large it is.
fn guessed_box(region: &Region, types: usize, [bond_types, angle_types]: [usize; 2]) -> Box<dyn Act> {
    let (mut lo, mut hi) = match &region.shape {
        Shape::Block { lo, hi } | Shape::Prism { lo, hi, .. } => (*lo, *hi),
        _ => ([f64::NAN; 3], [f64::NAN; 3]),
    };
    let tilt = match &region.shape {
        Shape::Prism { tilt, .. } => Some(tilt.map(|t| if t.is_nan() { 0.0 } else { t })),
        _ => None,
    };
    for d in 0..3 {
        if lo[d].is_nan() {
            lo[d] = if hi[d].is_nan() { -0.5 } else { hi[d] - 1.0 };
        }
        hi[d] = if hi[d] > lo[d] { hi[d] } else { lo[d] + 1.0 };
    }
    setting(move |cx| {
        let flat = cx.world.settings.two_dimensional;
        let domain = Domain { flat, tilt, ..Domain::new(lo, hi, cx.world.settings.boundary) };
        cx.world.domain = Some(domain).into();
        (cx.world.types, cx.world.bonds.types) = (types, bond_types);
        cx.world.bonds.angles.types = angle_types;
        cx.world.type_mass = vec![None; types].into();
        Ok(())
    })
}

/// Room for bonds and angles: their types count, lists grow as they must.
fn topology(a: &mut Args, cx: &BuildCx) -> Result<[usize; 2]> {
    let (mut types, style) = ([0; 2], cx.world.particles.style);
    while let Some(word) = a.next() {
        let (span, name) = (a.here(), word.text.as_str());
        if !KEYWORDS.contains(&name) {
            return Err(bad_keyword(a, word, &KEYWORDS, &ELSEWHERE));
        }
        let angles = name.contains("angle");
        if !style.bonded || (angles && !style.angled) {
            let (what, other) = if angles { ("angles", "angle") } else { ("bonds", "bond") };
            let text = format!("particles of atom_style {} have no {what}", style.name());
            let d = Diagnostic::error(Code::CONFLICT, word.span, text);
            return Err(d.help(format!("`atom_style {other}`, alone or in a hybrid, has them")).into());
        }
        let number = a.integer_from(0, "the number")?;
        if name.ends_with("/types") {
            let Ok(number) = u16::try_from(number) else {
                let text = format!("at most {} types of bonds or angles are possible", u16::MAX);
                return fail(Code::BAD_VALUE, span, text);
            };
            types[usize::from(angles)] = usize::from(number);
        }
    }
    Ok(types)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{act, refused, scene};

    #[test]
    fn box_is_lammps_box() {
        let mut w = scene("units si\nlattice sc 0.5\nboundary s p f\nregion b block 0 4 0 3 0 3 units box");
        let lines = act(&mut w, "create_box 2 b", &[]).unwrap();
        // Oracle: the same deck prints this, and shows xlo = -0.0004 and xhi = 4.0004 afterwards.
        assert_eq!(lines[0], "Created orthogonal box = (0 0 0) to (4 3 3)");
        let domain = w.domain.as_ref().unwrap();
        assert_eq!((domain.lo, domain.hi), ([-0.0004, 0.0, 0.0], [4.0004, 3.0, 3.0]));
        assert_eq!(w.type_mass.len(), 2);
        assert_eq!(refused(&w, "create_box 2 b").0, "create_box");
    }

    #[test]
    fn refuses_what_is_no_box() {
        let w = scene(
            "region s sphere 0 0 0 1 side out\nregion o block 0 1 0 1 0 1 side out\nregion f block 0 0 0 1 0 1",
        );
        for (region, blamed) in [("s", "s"), ("o", "o"), ("f", "f"), ("q", "q")] {
            assert_eq!(refused(&w, &format!("create_box 1 {region}")).0, blamed);
        }
        assert_eq!(refused(&w, "create_box 0 f").0, "0");
    }
}
