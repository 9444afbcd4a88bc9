//! The words of fix deposit.

use super::{Depositing, Height};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::common::{axis, bad_keyword, domain, scales, seed, units_lattice};
use perigrain_styles::molecules;
use perigrain_styles::newcomers::Ids;
use perigrain_world::Region;

const KEYWORDS: [&str; 20] = [
    "region", "var", "set", "id", "global", "local", "near", "gaussian", "attempt", "rate", "vx", "vy", "vz",
    "target", "units", "mol", "molfrac", "rigid", "shake", "orient",
];

/// A region and the corners of its bounding box.
type Bounded = (Region, ([f64; 3], [f64; 3]));

/// Values of the keywords, in the units of the line.
struct Keywords {
    region: Option<Bounded>,
    variable: Option<ValueRef>,
    sets: [Option<ValueRef>; 3],
    lattice: bool,
    molecules: molecules::Words,
}

/// Reads the words after `deposit`.
pub fn read(args: &mut Args, cx: &BuildCx) -> Result<Depositing> {
    let count = args.integer_from(0, "the number of particles N")? as u64;
    let (kind, at) = one_type(args, cx)?;
    let every = args.integer_from(1, "the number of steps M")?;
    let mut fix = Depositing {
        id: cx.id.to_string(),
        group: cx.group,
        count,
        kind,
        every,
        seed: seed(args)?,
        region: Region::inside(perigrain_world::region::Shape::Sphere { center: [0.0; 3], radius: 0.0 }),
        corners: Default::default(),
        ids: Ids::Max,
        height: Height::Drawn,
        near: 0.0,
        gaussian: None,
        tries: 10,
        rate: 0.0,
        velocity: [[0.0; 2]; 3],
        target: None,
        molecules: None,
        test: None,
    };
    let (sets, molecules) = ([None, None, None], molecules::Words::default());
    let mut keywords = Keywords { region: None, variable: None, sets, lattice: true, molecules };
    let start = args.here();
    while let Some(word) = args.next() {
        keyword(word, args, cx, &mut fix, &mut keywords)?;
    }
    fix.molecules = keywords.molecules.finish(kind, at, cx)?;
    let Some((region, corners)) = keywords.region else {
        let d = Diagnostic::error(Code::MISSING_ARGUMENT, args.here(), "fix deposit needs `region ID`");
        return Err(d.help("it is the region where particles may appear").into());
    };
    (fix.region, fix.corners) = (region, corners);
    fix.test = match (keywords.variable, keywords.sets.iter().any(Option::is_some)) {
        (None, false) => None,
        (Some(variable), true) => Some((variable, keywords.sets)),
        _ => {
            let text = "`var` and `set` belong together";
            let d = Diagnostic::error(Code::INCOMPLETE, start.to(args.here()), text);
            return Err(d.help("write for example `var test set x xx`").into());
        }
    };
    scale(&mut fix, scales(cx.world, keywords.lattice), cx.world.settings.two_dimensional);
    Ok(fix)
}

fn keyword(
    word: &Word,
    args: &mut Args,
    cx: &BuildCx,
    fix: &mut Depositing,
    keywords: &mut Keywords,
) -> Result<()> {
    match word.text.as_str() {
        "region" => keywords.region = Some(region(args.expect("the region's ID")?, cx)?),
        "var" => keywords.variable = Some(variable(args, cx, true)?),
        "set" => {
            let d = axis(args, "the coordinate")?;
            keywords.sets[d] = Some(variable(args, cx, false)?);
        }
        "id" => fix.ids = Ids::take(args)?,
        "global" => fix.height = Height::Global(pair(args, "distance")?),
        "local" => {
            fix.height = Height::Local(pair(args, "distance")?, args.non_negative("the distance sideways")?);
        }
        "near" => fix.near = args.non_negative("the distance to others")?,
        "gaussian" => {
            let middle = [args.number("x")?, args.number("y")?, args.number("z")?];
            fix.gaussian = Some((middle, args.non_negative("the width")?));
        }
        "attempt" => fix.tries = args.integer_from(1, "the number of attempts")?,
        "rate" => fix.rate = args.number("the velocity of the region")?,
        "vx" => fix.velocity[0] = pair(args, "velocity")?,
        "vy" => fix.velocity[1] = pair(args, "velocity")?,
        "vz" => fix.velocity[2] = pair(args, "velocity")?,
        "target" => fix.target = Some([args.number("x")?, args.number("y")?, args.number("z")?]),
        "units" => keywords.lattice = units_lattice(args)?,
        "mol" | "molfrac" | "rigid" | "shake" | "orient" => keywords.molecules.take(word, args, cx)?,
        _ => return Err(bad_keyword(args, word, &KEYWORDS, &[])),
    }
    Ok(())
}

/// The type (0 is allowed as an offset for molecules) and its span.
fn one_type(args: &mut Args, cx: &BuildCx) -> Result<(u16, Span)> {
    let span = args.here();
    let kind = args.integer("the type")?;
    match u16::try_from(kind).ok().filter(|k| usize::from(*k) <= cx.world.types) {
        Some(kind) => Ok((kind, span)),
        None => fail(Code::BAD_VALUE, span, format!("there are types 1 to {}, not {kind}", cx.world.types)),
    }
}

/// Two numbers, in any order, as in LAMMPS.
fn pair(args: &mut Args, what: &str) -> Result<[f64; 2]> {
    Ok([args.number(&format!("the smallest {what}"))?, args.number(&format!("the largest {what}"))?])
}

fn region(word: &Word, cx: &BuildCx) -> Result<Bounded> {
    let region = cx.region(word)?.clone();
    let Some((lo, hi)) = region.bounds() else {
        let text = format!("region `{}` has no box around it, or moves", word.text);
        return Err(Diagnostic::error(Code::WRONG_KIND, word.span, text)
            .help("particles are put into a bounded region that stays: let it rise with `rate`")
            .into());
    };
    let domain = domain(cx)?;
    // For a tilted box, its bounding box: positions beyond periodic faces are those of images.
    let faces = domain.bounds();
    if !cx.checking && (0..3).any(|d| lo[d] < faces[d][0] || hi[d] > faces[d][1]) {
        let text = format!(
            "region `{}` from {lo:?} to {hi:?} leaves the box from {:?} to {:?}",
            word.text,
            faces.map(|f| f[0]),
            faces.map(|f| f[1])
        );
        let d = Diagnostic::error(Code::BAD_VALUE, word.span, text);
        return Err(d.help("let the region lie inside the box").into());
    }
    Ok((region, (lo, hi)))
}

fn variable(args: &mut Args, cx: &BuildCx, decides: bool) -> Result<ValueRef> {
    let word = args.expect(if decides { "an equal-style variable" } else { "an internal-style variable" })?;
    let r = ValueRef { kind: RefKind::Variable, name: word.text.clone(), index: vec![], span: word.span };
    cx.value(&r, false)?;
    Ok(r)
}

/// Converts from the units of the line to box units.
fn scale(fix: &mut Depositing, by: [f64; 3], flat: bool) {
    let up = if flat { by[1] } else { by[2] };
    match &mut fix.height {
        Height::Drawn => {}
        Height::Global(range) => range.iter_mut().for_each(|a| *a *= up),
        Height::Local(range, delta) => {
            range.iter_mut().for_each(|a| *a *= up);
            *delta *= by[0];
        }
    }
    fix.near *= by[0];
    fix.rate *= up;
    if let Some((middle, sigma)) = &mut fix.gaussian {
        (0..3).for_each(|d| middle[d] *= by[d]);
        *sigma *= by[0];
    }
    for (d, range) in fix.velocity.iter_mut().enumerate() {
        range.iter_mut().for_each(|a| *a *= by[d]);
    }
    if let Some(target) = &mut fix.target {
        (0..3).for_each(|d| target[d] *= by[d]);
    }
}
