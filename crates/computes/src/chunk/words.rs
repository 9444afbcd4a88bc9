//! The words of compute chunk/atom.

use super::bins::{Axis, Origin, Shells};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::args::parse_number;
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_styles::{Bins, BuildCx, UseKind, Wants};
use perigrain_world::{Face, GroupId, Key, Region};

/// The property that determines a particle's chunk.
#[derive(Clone, Debug)]
pub enum What {
    /// Slabs, pencils or boxes.
    Bins(Vec<Axis>),
    /// Spherical shells.
    Sphere(Shells),
    /// Rings around an axis, in slabs along it.
    Cylinder(Axis, Shells),
    /// The type.
    Type,
    /// The molecule ID.
    Molecule,
    /// A value per particle.
    Value(ValueRef),
}

impl What {
    /// Whether chunks are spatial bins.
    pub fn binned(&self) -> bool {
        !matches!(self, What::Type | What::Molecule | What::Value(_))
    }
}

/// Treatment of particles outside all chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Discard {
    /// They belong to no chunk.
    Yes,
    /// They belong to the nearest or to the last chunk.
    No,
    /// To the nearest if bins end at the box, else to none.
    Mixed,
}

/// When particles are assigned to chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ids {
    /// At the first use.
    Once,
    /// At the first step of each window of `fix ave/chunk`.
    Window,
    /// At every use.
    Every,
}

/// Distance units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Units {
    /// Of the deck.
    Box,
    /// Lattice spacings.
    Lattice,
    /// Fractions of the box.
    Reduced,
}

/// `limit N max|exact`.
#[derive(Clone, Copy, Debug)]
pub struct Limit {
    /// N.
    pub n: usize,
    /// `exact`: pads with empty chunks if there are fewer.
    pub exact: bool,
    /// Given before `compress`.
    pub first: bool,
}

/// A whole line.
#[derive(Clone, Debug)]
pub struct Spec {
    /// The compute's ID.
    pub id: String,
    /// Group that is numbered.
    pub group: GroupId,
    /// The property that determines the chunk.
    pub what: What,
    /// Only inside this region.
    pub region: Option<Key<Region>>,
    /// Whether the number of chunks is determined only once.
    pub once: bool,
    /// See [`Limit`].
    pub limit: Option<Limit>,
    /// See [`Ids`].
    pub ids: Ids,
    /// Leave out chunks without particles.
    pub compress: bool,
    /// See [`Discard`].
    pub discard: Discard,
    /// Minimum image distances from sphere and cylinder.
    pub pbc: bool,
    /// Whether lengths are fractions of the box.
    pub reduced: bool,
}

const STYLES: &[&str] = &["bin/1d", "bin/2d", "bin/3d", "bin/sphere", "bin/cylinder", "type", "molecule"];
const KEYWORDS: &[&str] =
    &["region", "nchunk", "limit", "ids", "compress", "discard", "bound", "pbc", "units"];

/// Values of the keywords, before defaults.
struct Options {
    region: Option<Key<Region>>,
    once: Option<bool>,
    limit: Option<Limit>,
    ids: Ids,
    compress: bool,
    discard: Option<(Discard, Span)>,
    bound: [[Option<f64>; 2]; 3],
    pbc: bool,
    units: Units,
}

impl Spec {
    /// Reads the words after `chunk/atom`.
    pub fn read(args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let mut what = read_what(args, cx)?;
        let o = Options::read(args, cx)?;
        let scale = match o.units {
            Units::Lattice => cx.world.lattice.spacing,
            _ => [1.0; 3],
        };
        let binned = what.binned();
        match &mut what {
            What::Bins(axes) => axes.iter_mut().for_each(|a| a.scale(scale, o.bound)),
            What::Sphere(shells) => shells.scale(scale),
            What::Cylinder(axis, shells) => {
                axis.scale(scale, o.bound);
                shells.scale(scale);
            }
            _ => {}
        }
        let discard = match (binned, o.discard) {
            (false, Some((Discard::Mixed, span))) => {
                return fail(
                    Code::CONFLICT,
                    span,
                    "`discard mixed` is for bins: write `discard yes` or `no`",
                );
            }
            (_, Some((d, _))) => d,
            (true, None) => Discard::Mixed,
            (false, None) => Discard::Yes,
        };
        let follows = |f: &Face| matches!(f, Face::Shrink | Face::ShrinkMin);
        let fixed = cx.world.domain.as_ref().is_none_or(|d| !d.boundary.0.iter().flatten().any(follows));
        let once = o.once.unwrap_or(match what {
            _ if o.compress => false,
            What::Type => true,
            What::Molecule => o.region.is_none(),
            What::Value(_) => false,
            _ => fixed || o.units == Units::Reduced,
        });
        Ok(Self {
            id: cx.id.to_string(),
            group: cx.group,
            what,
            region: o.region,
            once,
            limit: o.limit.filter(|_| !binned),
            ids: o.ids,
            compress: o.compress,
            discard,
            pbc: o.pbc,
            reduced: o.units == Units::Reduced,
        })
    }

    /// Whether LAMMPS 22Jul2025 drops positions above the last layer although the layers end at the box.
    pub fn drops_above(&self) -> bool {
        let open = |a: &Axis| a.bound[1].is_none();
        self.discard == Discard::Mixed
            && match &self.what {
                What::Bins(axes) => axes.iter().any(open),
                What::Cylinder(axis, _) => open(axis),
                _ => false,
            }
    }

    /// The axes of layers; `None` for other chunks.
    pub fn bins(&self) -> Option<Bins> {
        let What::Bins(axes) = &self.what else { return None };
        let axis = |k: usize| axes.get(k).map(|a| a.dim);
        Some(Bins { axes: std::array::from_fn(axis), reduced: self.reduced })
    }

    /// Coordinates of each chunk.
    pub fn coordinates(&self) -> usize {
        match &self.what {
            What::Bins(axes) => axes.len(),
            What::Sphere(_) => 1,
            What::Cylinder(..) => 2,
            _ => 0,
        }
    }
}

fn read_what(args: &mut Args, cx: &BuildCx) -> Result<What> {
    let word = args.expect("a style of chunks, as `bin/1d` or `type`")?;
    if let Some(r) = ValueRef::parse(&word.text, word.span)?
        && matches!(r.kind, RefKind::Compute | RefKind::Fix | RefKind::Variable)
    {
        cx.reading(&r, Wants::PerAtom)?;
        return Ok(What::Value(r));
    }
    match word.text.as_str() {
        "bin/1d" | "bin/2d" | "bin/3d" => {
            let n = usize::from(word.text.as_bytes()[4] - b'0');
            let axes = (0..n).map(|_| read_axis(args)).collect::<Result<Vec<_>>>()?;
            for (k, a) in axes.iter().enumerate() {
                if axes[..k].iter().any(|b| b.dim == a.dim) {
                    return fail(Code::CONFLICT, word.span, format!("`{}` names an axis twice", word.text));
                }
            }
            Ok(What::Bins(axes))
        }
        "bin/sphere" => {
            let mut center = [0.0; 3];
            for c in &mut center {
                *c = args.number("a coordinate of the centre")?;
            }
            Ok(What::Sphere(read_shells(args, center, [0, 1, 2])?))
        }
        "bin/cylinder" => {
            let axis = read_axis(args)?;
            let across = perigrain_world::region::across(axis.dim);
            let mut center = [0.0; 3];
            for d in across {
                center[d] = args.number("a coordinate of the cylinder's axis")?;
            }
            let shells = read_shells(args, center, [across[0], across[1], axis.dim])?;
            Ok(What::Cylinder(axis, Shells { flat: true, ..shells }))
        }
        "type" => Ok(What::Type),
        "molecule" if cx.world.particles.style.molecules => Ok(What::Molecule),
        "molecule" => {
            let text = "particles of this atom_style belong to no molecules";
            Err(Diagnostic::error(Code::CONFLICT, word.span, text)
                .help("`fix ID all property/atom mol` gives them molecule IDs; bodies of bonds are numbered by `compute fragment/atom`, whose c_ID may stand here with `compress yes`")
                .into())
        }
        _ => Err(args.unknown(word, STYLES)),
    }
}

fn read_axis(args: &mut Args) -> Result<Axis> {
    let dim = match args.choice("axis", &["x", "y", "z"])? {
        "x" => 0,
        "y" => 1,
        _ => 2,
    };
    let origin = match args.peek_text() {
        "lower" => Origin::Lower,
        "center" => Origin::Center,
        "upper" => Origin::Upper,
        _ => Origin::At(args.number("the origin of the bins: lower, center, upper or a coordinate,")?),
    };
    if !matches!(origin, Origin::At(_)) {
        args.next();
    }
    Ok(Axis { dim, origin, delta: args.positive("the thickness of the bins")?, bound: [None; 2] })
}

fn read_shells(args: &mut Args, center: [f64; 3], dims: [usize; 3]) -> Result<Shells> {
    let span = args.here();
    let (lo, hi) = (args.non_negative("the inner radius")?, args.positive("the outer radius")?);
    if lo >= hi {
        return fail(Code::BAD_VALUE, span, "the inner radius must be smaller than the outer one");
    }
    let count = args.integer_from(1, "the number of shells")? as usize;
    Ok(Shells { center, lo, hi, count, flat: false, dims })
}

impl Options {
    fn read(args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let mut o = Options {
            region: None,
            once: None,
            limit: None,
            ids: Ids::Every,
            compress: false,
            discard: None,
            bound: [[None; 2]; 3],
            pbc: false,
            units: Units::Lattice,
        };
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "region" => {
                    let name = args.expect("a region")?;
                    cx.region(name)?;
                    cx.uses(UseKind::Region, &name.text);
                    o.region = Some(Key::new(&name.text));
                }
                "nchunk" => o.once = Some(args.choice("value of nchunk", &["once", "every"])? == "once"),
                "limit" => o.limit = read_limit(args, !o.compress)?,
                "ids" => {
                    o.ids = match args.choice("value of ids", &["once", "nfreq", "every"])? {
                        "once" => Ids::Once,
                        "nfreq" => Ids::Window,
                        _ => Ids::Every,
                    }
                }
                "compress" => o.compress = args.flag("compress")?,
                "discard" => {
                    let span = args.here();
                    let how = match args.choice("value of discard", &["yes", "no", "mixed"])? {
                        "yes" => Discard::Yes,
                        "no" => Discard::No,
                        _ => Discard::Mixed,
                    };
                    o.discard = Some((how, span));
                }
                "bound" => o.read_bound(args)?,
                "pbc" => o.pbc = args.flag("pbc")?,
                "units" => {
                    o.units = match args.choice("units", &["box", "lattice", "reduced"])? {
                        "box" => Units::Box,
                        "reduced" => Units::Reduced,
                        _ => Units::Lattice,
                    }
                }
                _ => return Err(args.unknown(word, KEYWORDS)),
            }
        }
        // The order of the line decides, even if `limit` was read before `compress`.
        if let Some(l) = &mut o.limit {
            l.first &= o.compress;
        }
        Ok(o)
    }

    fn read_bound(&mut self, args: &mut Args) -> Result<()> {
        let dim = match args.choice("axis", &["x", "y", "z"])? {
            "x" => 0,
            "y" => 1,
            _ => 2,
        };
        for (k, end) in ["lower", "upper"].iter().enumerate() {
            let word = args.expect("a bound")?;
            let what = format!("a bound that is not `{end}`");
            self.bound[dim][k] = if word.text == *end { None } else { Some(parse_number(word, &what)?) };
            if let [Some(lo), Some(hi)] = self.bound[dim]
                && k == 1
                && lo > hi
            {
                let text = format!("the lower bound {lo} lies above the upper bound {hi}");
                return fail(Code::BAD_VALUE, word.span, text);
            }
        }
        Ok(())
    }
}

fn read_limit(args: &mut Args, first: bool) -> Result<Option<Limit>> {
    let n = args.integer_from(0, "the limit")? as usize;
    if n == 0 {
        return Ok(None);
    }
    let exact = args.choice("kind of limit", &["max", "exact"])? == "exact";
    Ok(Some(Limit { n, exact, first }))
}
