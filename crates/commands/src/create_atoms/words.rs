//! The words of `create_atoms`.

use super::mesh::Mode;
use super::molecules::Copies;
use super::{group, pack};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{
    At, Axis, Forms, Fraction, Kind, MarsagliaSeed, Nullable, OneType, Seed, Turned, Units, Value, Words,
};
use perigrain_world::Region;

#[derive(Words)]
#[word(forms = "create_atoms TYPE", what = "style of create_atoms", style, foreign = foreign)]
pub enum Way {
    /// On the lattice sites in the box.
    Box(Sites),
    /// On the lattice sites in a region.
    Region(InRegion),
    /// At one place.
    Single(Single),
    /// At N random places, in a region if one is given, from LAMMPS' Park–Miller stream.
    Random(Random),
    /// On the triangles of a file (`region mesh` says what of them), in box units: `units box` must be there. Spheres take their radius from
    /// the triangle.
    Mesh(OnMesh),
    /// Spheres at random places fill a part of the volume of a region (what the box holds of it); then they push each other away until they
    /// overlap by less than a thousandth of their diameters on average.
    Pack(pack::Plain),
    /// The walls of an inverse opal: pores on a face-centred cubic lattice, one in the lower corner of the region, and spheres in what is left
    /// between them.
    Opal(pack::Opal),
    /// Packs the region and takes spheres away where a random field of 64 plane waves is lowest; of what is left only the largest part stays
    /// that hangs together over gaps of up to 0.1 mean diameters and comes within a diameter of both ends of the region, along its longest
    /// edge.
    Aggregate(pack::Aggregate),
}

/// The refusal of a keyword of other forms.
fn foreign(form: &str, word: &Word) -> Option<Diagnostics> {
    let elsewhere = Way::FORMS.iter().any(|f| f.grammar.has(&word.text));
    let text = format!("`{}` does not go with create_atoms {form}", word.text);
    elsewhere.then(|| Diagnostic::error(Code::CONFLICT, word.span, text).into())
}

#[derive(Words)]
pub struct Sites {
    /// The M-th point of the unit cell gets another type.
    #[word(keyword, name = "point")]
    pub basis: Vec<Basis>,
    /// A random part of the sites, exact in number, the sites that LAMMPS takes.
    #[word(keyword, name = "P SEED", placed)]
    pub ratio: Option<At<(Fraction, MarsagliaSeed)>>,
    /// N random sites, the sites that LAMMPS takes.
    #[word(keyword, name = "amount", placed)]
    pub subset: Option<At<Number>>,
    #[word(flatten)]
    pub decision: Decision,
    #[word(flatten)]
    pub shared: Shared,
    #[word(flatten)]
    pub copied: Copied,
}

#[derive(Words)]
pub struct Basis {
    #[word(name = "M", what = "the basis point")]
    pub point: At<i64>,
    #[word(name = "TYPE", what = "the type")]
    pub kind: OneType,
}

#[derive(Words)]
pub struct Number {
    #[word(name = "N", what = "the number of sites", from = 1)]
    pub count: i64,
    #[word(name = "SEED")]
    pub seed: MarsagliaSeed,
}

#[derive(Words)]
pub struct InRegion {
    #[word(name = "ID")]
    pub region: Region,
    #[word(flatten)]
    pub sites: Sites,
    /// Each peridynamic particle gets the part of its lattice cell that lies inside region and box as its volume.
    #[word(keyword, placed)]
    pub volumes: Option<At<Volumes>>,
}

#[derive(Words)]
#[word(what = "volumes")]
pub enum Volumes {
    Cut,
}

#[derive(Words)]
pub struct Single {
    /// The place [length].
    #[word(name = "X Y Z", what = "{}")]
    pub x: [f64; 3],
    /// The place is wrapped into a periodic box.
    #[word(keyword, default = false)]
    pub remap: bool,
    #[word(flatten)]
    pub shared: Shared,
    #[word(flatten)]
    pub copied: Copied,
}

#[derive(Words)]
pub struct Random {
    /// The number of particles.
    #[word(name = "N", from = 0)]
    pub count: i64,
    #[word(name = "SEED")]
    pub seed: Seed,
    #[word(name = "ID")]
    pub region: Nullable<Region>,
    /// The distance that new particles keep from all others; in lattice spacings it is in those along x [length].
    #[word(keyword, name = "D", what = "the distance", positive, default = 0.0)]
    pub overlap: f64,
    /// Attempts for each particle.
    #[word(keyword, name = "N", what = "maxtry", from = 1, default = 1000)]
    pub maxtry: i64,
    #[word(flatten)]
    pub decision: Decision,
    #[word(flatten)]
    pub shared: Shared,
    #[word(flatten)]
    pub copied: Copied,
}

#[derive(Words)]
pub struct OnMesh {
    /// The file.
    #[word(name = "FILE", what = "the name of a file of triangles", kind = Kind::File)]
    pub file: Word,
    #[word(keyword, default = Mode::Bisect(1.0), shown = "bisect 1")]
    pub meshmode: Mode,
    /// The factor of radii.
    #[word(keyword, name = "S", positive, default = 1.0)]
    pub radscale: f64,
    #[word(flatten)]
    pub shared: Shared,
}

/// A variable that decides about each place.
#[derive(Default, Words)]
pub struct Decision {
    /// An equal-style variable that decides about each place: no particle where it is zero. Needs `set`.
    #[word(keyword, name = "NAME", what = "an equal-style variable", placed)]
    pub var: Option<At<Named>>,
    /// An internal-style variable that gets the coordinate before.
    #[word(keyword, name = "x|y|z NAME", what = "the coordinate", placed)]
    pub set: Vec<At<(Axis, Named)>>,
}

/// A variable with one number, by its name.
#[derive(Clone)]
pub struct Named(pub ValueRef);

impl Value for Named {
    const KIND: Kind = Kind::Variable;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("a variable")?;
        let r = ValueRef { kind: RefKind::Variable, name: word.text.clone(), index: vec![], span: word.span };
        cx.value(&r, false).map(|()| Self(r))
    }
}

/// What most forms have.
#[derive(Default, Words)]
pub struct Shared {
    /// The unit of distances.
    #[word(keyword, default = Units::Lattice)]
    pub units: Units,
    #[word(flatten)]
    pub joined: Joined,
}

/// A group for the new particles.
#[derive(Default, Words)]
pub struct Joined {
    /// The new particles join this group, made if it is not there.
    #[word(keyword, name = "ID", with = group, kind = Kind::Group)]
    pub group: Option<String>,
}

/// Copies of a molecule in place of single particles.
#[derive(Default, Words)]
pub struct Copied {
    /// A copy of a `molecule` template in each place, its centre there, turned at random; TYPE, which may be 0, is added to the types of the
    /// template.
    #[word(keyword, name = "copies")]
    pub mol: Option<Copies>,
    /// Copies are turned by an angle in degrees about an axis.
    #[word(keyword, name = "turn", placed)]
    pub rotate: Option<At<Turned>>,
}

/// What a line says besides where particles are made.
#[derive(Default)]
pub struct Also {
    pub basis: Vec<Basis>,
    pub decision: Decision,
    pub copied: Copied,
    pub shared: Shared,
    /// The place of `volumes cut`.
    pub cut: Option<Span>,
}
