//! The words of fix deposit.

use super::{Depositing, Height};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::common::domain;
use perigrain_styles::molecules::{Inserted, Offset, Orient};
use perigrain_styles::newcomers::Ids;
use perigrain_styles::words::{At, Axis, Kind, Seed, Units, Value, Words, read};
use perigrain_world::Region;

/// The words of the line.
#[derive(Words)]
pub struct Line {
    /// The number of particles N in all.
    #[word(name = "N", from = 0)]
    count: i64,
    /// The type of the particles; with `mol` 0 is one.
    #[word(name = "type")]
    kind: At<Offset>,
    /// Distance of the insertions [steps].
    #[word(name = "M", what = "the number of steps M", from = 1)]
    every: i64,
    /// The seed of the random numbers.
    seed: Seed,
    /// Where particles appear, inside the box.
    #[word(keyword, name = "ID")]
    region: Option<Bounded>,
    /// An equal-style variable that decides whether a place is taken.
    #[word(keyword, name = "NAME", placed)]
    var: Option<At<Named>>,
    /// An internal-style variable that gets a coordinate of the place.
    #[word(keyword, name = "x|y|z NAME", what = "the coordinate", placed)]
    set: Vec<At<(Axis, Named)>>,
    #[word(keyword, shown = "max")]
    id: Ids,
    /// The place is put this far above the highest particle [length].
    #[word(keyword, name = "lo hi", what = "the {} distance", placed)]
    global: Option<At<[f64; 2]>>,
    /// The place is put this far above the highest particle within delta of it sideways [length].
    #[word(keyword, name = "lo hi delta", what = "the {} distance", placed)]
    local: Option<At<(f64, f64, Width)>>,
    /// The distance to others that a place must have [length].
    #[word(keyword, name = "R", non_negative, default = 0.0)]
    near: f64,
    /// Places are drawn around a point with this width [length].
    #[word(keyword, name = "x y z sigma", what = "{}")]
    gaussian: Option<(f64, f64, f64, Width)>,
    /// The number of attempts for each particle.
    #[word(keyword, name = "Q", from = 1, default = 10)]
    attempt: i64,
    /// The velocity of the region, which moves up [velocity].
    #[word(keyword, name = "V", default = 0.0)]
    rate: f64,
    /// Velocities are uniform between these bounds [velocity].
    #[word(keyword, name = "lo hi", what = "the {} velocity", shown = "0 0")]
    vx: [f64; 2],
    /// Velocities are uniform between these bounds [velocity].
    #[word(keyword, name = "lo hi", what = "the {} velocity", shown = "0 0")]
    vy: [f64; 2],
    /// Velocities are uniform between these bounds [velocity].
    #[word(keyword, name = "lo hi", what = "the {} velocity", shown = "0 0")]
    vz: [f64; 2],
    /// Velocities point to this place [length].
    #[word(keyword, name = "x y z", what = "{}")]
    target: Option<[f64; 3]>,
    /// Distances and velocities are in these units.
    #[word(keyword, shown = "lattice")]
    units: Units,
    #[word(flatten)]
    molecules: Inserted,
    /// Molecules are turned about this axis.
    #[word(keyword, name = "axis", placed)]
    orient: Option<At<Orient>>,
}

/// A region and the corners of its bounding box.
struct Bounded(Region, ([f64; 3], [f64; 3]));

impl Value for Bounded {
    const KIND: Kind = Kind::Region;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        region(args.expect("the region's ID")?, cx)
    }
}

/// A variable by its name.
struct Named(ValueRef);

impl Value for Named {
    const KIND: Kind = Kind::Variable;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("the name of a variable")?;
        let r = ValueRef { kind: RefKind::Variable, name: word.text.clone(), index: vec![], span: word.span };
        cx.value(&r, false)?;
        Ok(Self(r))
    }
}

/// A width that is not negative.
struct Width(f64);

impl Value for Width {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.non_negative(what).map(Self)
    }
}

/// The fix of a line.
pub fn build(args: &mut Args, cx: &BuildCx) -> Result<Depositing> {
    let line: Line = read(args, cx)?;
    let kind = line.kind.value.0;
    let molecules = line.molecules.finish(line.kind, line.orient, cx)?;
    let Some(Bounded(region, corners)) = line.region else {
        let d = Diagnostic::error(Code::MISSING_ARGUMENT, args.here(), "fix deposit needs `region ID`");
        return Err(d.help("it is the region where particles may appear").into());
    };
    let mut fix = Depositing {
        id: cx.id.to_string(),
        group: cx.group,
        count: line.count as u64,
        kind,
        every: line.every,
        seed: line.seed.0,
        region,
        corners,
        ids: line.id,
        height: height(line.global, line.local),
        near: line.near,
        gaussian: line.gaussian.map(|(x, y, z, sigma)| ([x, y, z], sigma.0)),
        tries: line.attempt,
        rate: line.rate,
        velocity: [line.vx, line.vy, line.vz],
        target: line.target,
        molecules,
        test: test(line.var, line.set)?,
    };
    scale(&mut fix, line.units.scales(cx.world), cx.world.settings.two_dimensional);
    Ok(fix)
}

/// Of `global` and `local` the later one counts.
fn height(global: Option<At<[f64; 2]>>, local: Option<At<(f64, f64, Width)>>) -> Height {
    match (global, local) {
        (Some(global), Some(local)) if global.span.start > local.span.start => Height::Global(global.value),
        (_, Some(At { value: (lo, hi, delta), .. })) => Height::Local([lo, hi], delta.0),
        (Some(global), None) => Height::Global(global.value),
        (None, None) => Height::Drawn,
    }
}

/// The variable that decides, and those that get the coordinates.
type Test = (ValueRef, [Option<ValueRef>; 3]);

fn test(variable: Option<At<Named>>, sets: Vec<At<(Axis, Named)>>) -> Result<Option<Test>> {
    let alone = match (&variable, &sets[..]) {
        (None, []) => return Ok(None),
        (Some(variable), []) => Some(variable.span),
        (None, [set, ..]) => Some(set.span),
        _ => None,
    };
    if let Some(span) = alone {
        let d = Diagnostic::error(Code::INCOMPLETE, span, "`var` and `set` belong together");
        return Err(d.help("write for example `var test set x xx`").into());
    }
    let mut names = [const { None }; 3];
    for At { value: (Axis(d), Named(name)), .. } in sets {
        names[d] = Some(name);
    }
    Ok(variable.map(|variable| (variable.value.0, names)))
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
    Ok(Bounded(region, (lo, hi)))
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
