//! `create_box`: the simulation box and the number of types.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{self, setting};
use perigrain_styles::words::{At, Kind, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::region::{INFINITE, Shape};
use perigrain_world::{Domain, Region, memory};

/// The command.
pub struct CreateBox;

impl Style for CreateBox {
    fn name(&self) -> &'static str {
        "create_box"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Creates the simulation box from a bounded region, for N particle types.",
            text: "The box is the smallest one along the axes that holds the region, which must have finite bounds and `side in`. A \
                   prism becomes a triclinic box: its edges lean as those of the prism (tilts xy, xz and yz), and may lean \
                   otherwise later (`change_box`, `fix deform`). Where a tilt is more than half of the length along which it leads, \
                   a warning says so. General triclinic boxes (`NULL`) are refused. Shrink-wrapped faces start 1e-4 of the edge \
                   length outside it, as in LAMMPS.\n\n\
                   Room for bonds per particle is not limited.",
            example: "create_box 3 world",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The number of types.
    #[word(name = "N", from = 1)]
    types: At<i64>,
    #[word(name = "REGION", what = "a region", kind = Kind::Region)]
    region: Word,
    #[word(flatten)]
    topology: Topology,
}

/// Room for bonds and angles: their types count, lists grow as they must.
#[derive(Words)]
#[word(refused = "dihedral/types improper/types extra/dihedral/per/atom extra/improper/per/atom")]
struct Topology {
    /// The number of bond types, for atom styles with bonds.
    #[word(keyword = "bond/types", name = "N", placed)]
    bonds: Option<At<Number>>,
    /// The number of angle types, for atom styles with angles.
    #[word(keyword = "angle/types", name = "N", placed)]
    angles: Option<At<Number>>,
    /// LAMMPS' room for bonds; without effect.
    #[word(keyword = "extra/bond/per/atom", name = "N", what = "the number", from = 0, placed)]
    more_bonds: Option<At<i64>>,
    /// LAMMPS' room for angles; without effect.
    #[word(keyword = "extra/angle/per/atom", name = "N", what = "the number", from = 0, placed)]
    more_angles: Option<At<i64>>,
    /// LAMMPS' room for what is bonded; without effect.
    #[word(keyword = "extra/special/per/atom", name = "N", what = "the number", from = 0, placed)]
    more_special: Option<At<i64>>,
}

/// A number of types of bonds or angles.
#[derive(Clone, Copy)]
struct Number(usize);

impl Value for Number {
    const KIND: Kind = Kind::Whole;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let span = args.here();
        let number = args.integer_from(0, "the number")?;
        match u16::try_from(number) {
            Ok(number) => Ok(Self(usize::from(number))),
            Err(_) => {
                let text = format!("at most {} types of bonds or angles are possible", u16::MAX);
                fail(Code::BAD_VALUE, span, text)
            }
        }
    }
}

impl CommandStyle for CreateBox {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        if cx.world.domain.is_some() {
            return fail(Code::WRONG_ORDER, a.name_span(), "the simulation box is defined already");
        }
        let Line { types: At { value: types, span, .. }, region: word, topology } = read(a, cx)?;
        if types > i64::from(u16::MAX) {
            return fail(Code::BAD_VALUE, span, format!("at most {} types are possible", u16::MAX));
        }
        if let Some(d) = memory::lacking_for_types(types as usize) {
            return Err(d.help("forces have a table of all pairs of types").at(span).into());
        }
        if word.text == "NULL" {
            return Err(common::not_here(&word, "a general triclinic box: create_box"));
        }
        let region = cx.region(&word)?;
        if cx.checking && region.motion.is_none() && region.follows() && !region.outside {
            return Ok(guessed_box(region, types as usize, topology.types(cx)?));
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
        let [bond_types, angle_types] = topology.types(cx)?;
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

impl Topology {
    /// The numbers of types of bonds and angles.
    fn types(&self, cx: &BuildCx) -> Result<[usize; 2]> {
        let style = cx.world.particles.style;
        let of_bonds =
            [self.bonds.map(|n| n.span), self.more_bonds.map(|n| n.span), self.more_special.map(|n| n.span)];
        let of_angles = [self.angles.map(|n| n.span), self.more_angles.map(|n| n.span)];
        let missing = |spans: &[Option<Span>], there: bool| spans.iter().flatten().copied().find(|_| !there);
        let refused = [
            (missing(&of_bonds, style.bonded), "bonds", "bond"),
            (missing(&of_angles, style.bonded && style.angled), "angles", "angle"),
        ];
        for (span, what, other) in refused {
            let Some(span) = span else { continue };
            let text = format!("particles of atom_style {} have no {what}", style.name());
            let d = Diagnostic::error(Code::CONFLICT, span, text);
            return Err(d.help(format!("`atom_style {other}`, alone or in a hybrid, has them")).into());
        }
        Ok([self.bonds, self.angles].map(|n| n.map_or(0, |n| n.value.0)))
    }
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
