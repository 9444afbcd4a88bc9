//! The words of compute chunk/atom.

use super::bins::{self, Origin, Shells};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_styles::words::{At, Axis, Grammar, Kind, Or, Part, Value, Words, read};
use perigrain_styles::{Bins, BuildCx, Wants};
use perigrain_world::{Face, GroupId, Key, Region};

/// The property that determines a particle's chunk.
#[derive(Clone, Debug)]
pub enum What {
    /// Slabs, pencils or boxes.
    Bins(Vec<bins::Axis>),
    /// Spherical shells.
    Sphere(Shells),
    /// Rings around an axis, in slabs along it.
    Cylinder(bins::Axis, Shells),
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Words)]
#[word(what = "value of discard")]
pub enum Discard {
    /// Those outside all chunks belong to none.
    Yes,
    /// They belong to the nearest or to the last chunk.
    No,
    /// To the nearest if bins end at the box, else to none.
    Mixed,
}

/// When particles are assigned to chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Words)]
#[word(what = "value of ids")]
pub enum Ids {
    /// Particles are numbered at the first use.
    Once,
    /// At the first step of each window of `fix ave/chunk`.
    #[word("nfreq")]
    Window,
    /// At every use.
    Every,
}

/// When chunks are counted.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "value of nchunk")]
enum Counted {
    /// Chunks are counted at the first use.
    Once,
    /// At every use.
    Every,
}

/// Distance units.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "units")]
enum Distances {
    /// Distances are those of the deck.
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

/// What a limit of the number of chunks does.
#[derive(PartialEq, Words)]
#[word(what = "kind of limit")]
enum Most {
    /// There may be fewer.
    Max,
    /// Chunks without particles are added if there are fewer.
    Exact,
}

/// A number of chunks, 0 for none, else with what it does.
impl Value for Limit {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[Part::bare("N", Kind::Whole), Part::Maybe(&[Part::bare("kind", Most::KIND)])],
        keywords: &[],
        refused: &[],
    });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let n = args.integer_from(0, "the limit")? as usize;
        let exact = n > 0 && Most::value("", args, cx)? == Most::Exact;
        Ok(Self { n, exact, first: false })
    }
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

#[derive(Words)]
pub struct Line {
    #[word(name = "value", what = "a style of chunks, as `bin/1d` or `type`")]
    what: At<Or<Cut, PerParticle>>,
    /// Particles outside this region belong to no chunk.
    #[word(keyword, name = "ID")]
    region: Option<Key<Region>>,
    /// Without it `once` for types and, without a region, molecules, and for bins where the box cannot change.
    #[word(keyword)]
    nchunk: Option<Counted>,
    /// The most chunks that there may be; 0 is no limit.
    #[word(keyword, name = "N", placed)]
    limit: Option<At<Limit>>,
    #[word(keyword, default = Ids::Every)]
    ids: Ids,
    /// Numbers without particles are left out.
    #[word(keyword, placed)]
    compress: Option<At<bool>>,
    /// Without it `mixed` for bins, `yes` for all others.
    #[word(keyword)]
    discard: Option<At<Discard>>,
    /// The bounds of layers along an axis.
    #[word(keyword, name = "bound")]
    bound: Vec<Bound>,
    /// Minimum image distances for spheres and cylinders.
    #[word(keyword, default = false)]
    pbc: bool,
    #[word(keyword, default = Distances::Lattice)]
    units: Distances,
}

/// Properties that are no value of another style.
#[derive(Words)]
enum Cut {
    /// Layers of thickness `delta` along an axis, in both directions from the origin: a coordinate, or `lower center upper` of what
    /// they cover.
    #[word("bin/1d")]
    Slabs(#[word(name = "layer")] Layer),
    /// The same along two axes; the last one varies fastest.
    #[word("bin/2d")]
    Pencils(#[word(name = "layer")] Layer, #[word(name = "layer")] Layer),
    /// The same along three axes.
    #[word("bin/3d")]
    Boxes(#[word(name = "layer")] Layer, #[word(name = "layer")] Layer, #[word(name = "layer")] Layer),
    /// n shells around a point.
    #[word("bin/sphere")]
    Sphere(
        #[word(name = "x y z", what = "a coordinate of the centre")] [f64; 3],
        #[word(name = "shells")] Radii,
    ),
    /// Layers along an axis, varying fastest, times n rings.
    #[word("bin/cylinder")]
    Cylinder(
        #[word(name = "layer")] Layer,
        #[word(name = "c1 c2", what = "a coordinate of the cylinder's axis")] [f64; 2],
        #[word(name = "rings")] Radii,
    ),
    /// The type.
    Type,
    /// The molecule ID.
    Molecule,
}

/// A value per particle, rounded towards zero.
struct PerParticle(ValueRef);

impl Value for PerParticle {
    const KIND: Kind = Kind::Value;
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect(what)?;
        match ValueRef::parse(&word.text, word.span)? {
            Some(r) if matches!(r.kind, RefKind::Compute | RefKind::Fix | RefKind::Variable) => {
                cx.reading(&r, Wants::PerAtom)?;
                Ok(Self(r))
            }
            _ => {
                let known: Vec<&'static str> = Cut::KIND.choices().iter().map(|a| a.word).collect();
                Err(args.unknown(word, &known))
            }
        }
    }
}

/// Layers along an axis.
#[derive(Words)]
struct Layer {
    #[word(name = "dim", what = "axis")]
    dim: Axis,
    #[word(what = "the origin of the bins: lower, center, upper or a coordinate,")]
    origin: Or<Place, f64>,
    #[word(what = "the thickness of the bins", positive)]
    delta: f64,
}

/// A place within what layers cover.
#[derive(Words)]
enum Place {
    Lower,
    Center,
    Upper,
}

impl From<Layer> for bins::Axis {
    fn from(Layer { dim, origin, delta }: Layer) -> Self {
        let origin = match origin {
            Or::Word(Place::Lower) => Origin::Lower,
            Or::Word(Place::Center) => Origin::Center,
            Or::Word(Place::Upper) => Origin::Upper,
            Or::Else(x) => Origin::At(x),
        };
        Self { dim: dim.0, origin, delta, bound: [None; 2] }
    }
}

/// Shells or rings.
#[derive(Words)]
struct Radii {
    #[word(name = "rmin", what = "the inner radius", non_negative)]
    lo: At<f64>,
    #[word(name = "rmax", what = "the outer radius", positive)]
    hi: At<f64>,
    #[word(name = "n", what = "the number of shells", from = 1)]
    count: usize,
}

impl Radii {
    fn shells(self, center: [f64; 3], dims: [usize; 3], flat: bool) -> Result<Shells> {
        let Self { lo, hi, count } = self;
        if lo.value >= hi.value && !lo.unknown && !hi.unknown {
            return fail(Code::BAD_VALUE, lo.span, "the inner radius must be smaller than the outer one");
        }
        Ok(Shells { center, lo: lo.value, hi: hi.value, count, flat, dims })
    }
}

/// The bounds of layers along an axis.
#[derive(Words)]
struct Bound {
    #[word(name = "dim", what = "axis")]
    dim: Axis,
    #[word(name = "lo", what = "a bound that is not `lower`")]
    lo: At<Or<Lower, f64>>,
    #[word(name = "hi", what = "a bound that is not `upper`")]
    hi: At<Or<Upper, f64>>,
}

/// Layers reach the lower face of the box.
#[derive(Words)]
enum Lower {
    Lower,
}

/// Layers reach the upper face of the box.
#[derive(Words)]
enum Upper {
    Upper,
}

impl Line {
    /// The bounds of layers along each axis.
    fn bounds(&self) -> Result<[[Option<f64>; 2]; 3]> {
        let mut bounds = [[None; 2]; 3];
        for Bound { dim, lo, hi } in &self.bound {
            let ends = [
                if let Or::Else(lo) = lo.value { Some(lo) } else { None },
                if let Or::Else(hi) = hi.value { Some(hi) } else { None },
            ];
            if let [Some(low), Some(high)] = ends
                && low > high
                && !lo.unknown
                && !hi.unknown
            {
                let text = format!("the lower bound {low} lies above the upper bound {high}");
                return fail(Code::BAD_VALUE, hi.span, text);
            }
            bounds[dim.0] = ends;
        }
        Ok(bounds)
    }
}

impl Spec {
    /// Reads the words after `chunk/atom`.
    pub fn read(args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let o: Line = read(args, cx)?;
        let bound = o.bounds()?;
        let mut what = cut(o.what, cx)?;
        let scale = match o.units {
            Distances::Lattice => cx.world.lattice.spacing,
            _ => [1.0; 3],
        };
        let compress = o.compress.is_some_and(|c| c.value);
        // The order of the line decides.
        let first = |l: &At<Limit>| o.compress.is_some_and(|c| c.value && l.span.start < c.span.start);
        let limit = o.limit.as_ref().map(|l| Limit { first: first(l), ..l.value }).filter(|l| l.n > 0);
        let binned = what.binned();
        match &mut what {
            What::Bins(axes) => axes.iter_mut().for_each(|a| a.scale(scale, bound)),
            What::Sphere(shells) => shells.scale(scale),
            What::Cylinder(axis, shells) => {
                axis.scale(scale, bound);
                shells.scale(scale);
            }
            _ => {}
        }
        let discard = match (binned, o.discard) {
            (false, Some(At { value: Discard::Mixed, span, .. })) => {
                return fail(
                    Code::CONFLICT,
                    span,
                    "`discard mixed` is for bins: write `discard yes` or `no`",
                );
            }
            (_, Some(d)) => d.value,
            (true, None) => Discard::Mixed,
            (false, None) => Discard::Yes,
        };
        let follows = |f: &Face| matches!(f, Face::Shrink | Face::ShrinkMin);
        let fixed = cx.world.domain.as_ref().is_none_or(|d| !d.boundary.0.iter().flatten().any(follows));
        let once = o.nchunk.map(|n| n == Counted::Once).unwrap_or(match what {
            _ if compress => false,
            What::Type => true,
            What::Molecule => o.region.is_none(),
            What::Value(_) => false,
            _ => fixed || o.units == Distances::Reduced,
        });
        Ok(Self {
            id: cx.id.to_string(),
            group: cx.group,
            what,
            region: o.region,
            once,
            limit: limit.filter(|_| !binned),
            ids: o.ids,
            compress,
            discard,
            pbc: o.pbc,
            reduced: o.units == Distances::Reduced,
        })
    }

    /// Whether LAMMPS 22Jul2025 drops positions above the last layer although the layers end at the box.
    pub fn drops_above(&self) -> bool {
        let open = |a: &bins::Axis| a.bound[1].is_none();
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

/// What the line's first words cut the scene into.
fn cut(At { value, span, .. }: At<Or<Cut, PerParticle>>, cx: &BuildCx) -> Result<What> {
    let cut = match value {
        Or::Word(cut) => cut,
        Or::Else(PerParticle(r)) => return Ok(What::Value(r)),
    };
    let layers: Vec<Layer> = match cut {
        Cut::Slabs(a) => vec![a],
        Cut::Pencils(a, b) => vec![a, b],
        Cut::Boxes(a, b, c) => vec![a, b, c],
        Cut::Sphere(center, radii) => return radii.shells(center, [0, 1, 2], false).map(What::Sphere),
        Cut::Cylinder(layer, [c1, c2], radii) => {
            let (dim, mut center) = (layer.dim.0, [0.0; 3]);
            let [first, second] = perigrain_world::region::across(dim);
            (center[first], center[second]) = (c1, c2);
            let shells = radii.shells(center, [first, second, dim], true)?;
            return Ok(What::Cylinder(layer.into(), shells));
        }
        Cut::Type => return Ok(What::Type),
        Cut::Molecule if cx.world.particles.style.molecules => return Ok(What::Molecule),
        Cut::Molecule => {
            let text = "particles of this atom_style belong to no molecules";
            return Err(Diagnostic::error(Code::CONFLICT, span, text)
                .help("`fix ID all property/atom mol` gives them molecule IDs; bodies of bonds are numbered by `compute fragment/atom`, whose c_ID may stand here with `compress yes`")
                .into());
        }
    };
    if (1..layers.len()).any(|k| layers[..k].iter().any(|l| l.dim == layers[k].dim)) {
        return fail(Code::CONFLICT, span, format!("`bin/{}d` names an axis twice", layers.len()));
    }
    Ok(What::Bins(layers.into_iter().map(Into::into).collect()))
}
