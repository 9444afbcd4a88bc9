//! Per-particle attributes for dumps: `id`, `x`, `vx`, `radius`, `c_ID[2]`, `v_name` ….

use perigrain_base::diag::{Code, Result};
use perigrain_base::math::vec3;
use perigrain_computes::property_atom::gone;
use perigrain_lang::args::blame;
use perigrain_lang::{ValueRef, Word};
use perigrain_output::dump::Data;
use perigrain_output::formats::Kind;
use perigrain_plan::{Stage, When};
use perigrain_styles::{BuildCx, Reading, SealCx, Wants};
use perigrain_world::{Domain, Numbers, World};

/// An attribute named in a deck.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// The word in the deck.
    pub word: String,
    /// Its source.
    pub source: Source,
}

/// Source of an attribute's values.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A core property of particles.
    Core(Core),
    /// A compute, fix or atom-style variable.
    Value(ValueRef),
    /// A column of fix property/atom; `true` for integers.
    Custom(Numbers, bool),
}

/// Core properties; numbers are axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Core {
    /// Particle id.
    Id,
    /// Type.
    Kind,
    /// Process that owns it: 0, because there is only one.
    Process(i64),
    /// Mass, as in LAMMPS' `rmass`.
    Mass,
    /// Position.
    X(usize),
    /// Position in fractions of the box.
    Scaled(usize),
    /// Unwrapped position.
    Unwrapped(usize),
    /// Unwrapped position in fractions of the box.
    ScaledUnwrapped(usize),
    /// Position in fractions of a cell ten times as large with the same centre (dump cfg).
    Tenth(usize),
    /// Image counts.
    Image(usize),
    /// Velocity.
    V(usize),
    /// Force.
    F(usize),
    /// Radius.
    Radius,
    /// Diameter.
    Diameter,
    /// Angular velocity.
    Omega(usize),
    /// Torque.
    Torque(usize),
    /// Volume of a peridynamic particle.
    Volume,
    /// Molecule ID.
    Molecule,
    /// Charge.
    Charge,
    /// A component of the dipole moment, or its magnitude.
    Moment(Option<usize>),
    /// Name of the type (`dump_modify element`).
    Element,
}

/// All core attributes by name.
pub const CORE: &[(&str, Core)] = &[
    ("id", Core::Id),
    ("type", Core::Kind),
    ("proc", Core::Process(0)),
    ("procp1", Core::Process(1)),
    ("mol", Core::Molecule),
    ("mass", Core::Mass),
    ("x", Core::X(0)),
    ("y", Core::X(1)),
    ("z", Core::X(2)),
    ("xs", Core::Scaled(0)),
    ("ys", Core::Scaled(1)),
    ("zs", Core::Scaled(2)),
    ("xu", Core::Unwrapped(0)),
    ("yu", Core::Unwrapped(1)),
    ("zu", Core::Unwrapped(2)),
    ("xsu", Core::ScaledUnwrapped(0)),
    ("ysu", Core::ScaledUnwrapped(1)),
    ("zsu", Core::ScaledUnwrapped(2)),
    ("ix", Core::Image(0)),
    ("iy", Core::Image(1)),
    ("iz", Core::Image(2)),
    ("vx", Core::V(0)),
    ("vy", Core::V(1)),
    ("vz", Core::V(2)),
    ("fx", Core::F(0)),
    ("fy", Core::F(1)),
    ("fz", Core::F(2)),
    ("radius", Core::Radius),
    ("diameter", Core::Diameter),
    ("omegax", Core::Omega(0)),
    ("omegay", Core::Omega(1)),
    ("omegaz", Core::Omega(2)),
    ("tqx", Core::Torque(0)),
    ("tqy", Core::Torque(1)),
    ("tqz", Core::Torque(2)),
    ("volume", Core::Volume),
    ("q", Core::Charge),
    ("mux", Core::Moment(Some(0))),
    ("muy", Core::Moment(Some(1))),
    ("muz", Core::Moment(Some(2))),
    ("mu", Core::Moment(None)),
    ("element", Core::Element),
];

/// LAMMPS' attributes of properties that perigrain's particles do not have.
const ELSEWHERE: &[&str] = &["angmomx", "angmomy", "angmomz"];

/// Expands `c_ID[*]`: one attribute per column.
pub fn expand(word: &Word, cx: &BuildCx) -> Result<Vec<Attribute>> {
    cx.expand(word, Wants::PerAtom)?.iter().map(|word| attribute(word, cx)).collect()
}

/// Parses one attribute.
pub fn attribute(word: &Word, cx: &BuildCx) -> Result<Attribute> {
    let text = word.text.as_str();
    if let Some((_, core)) = CORE.iter().find(|(name, _)| *name == text) {
        requires(*core, word, cx)?;
        return Ok(Attribute { word: text.into(), source: Source::Core(*core) });
    }
    if let Some(r) = ValueRef::parse(text, word.span)? {
        cx.value(&r, true)?;
        return Ok(Attribute { word: text.into(), source: Source::Value(r) });
    }
    if let Some(column) = cx.world.columns.custom(text) {
        return Ok(Attribute { word: text.into(), source: Source::Custom(column, text.starts_with('i')) });
    }
    if ELSEWHERE.contains(&text) || ["i_", "d_", "i2_", "d2_"].iter().any(|p| text.starts_with(p)) {
        let message = format!("particles have no attribute `{text}` in perigrain");
        return Err(blame(word, Code::NOT_SUPPORTED, message).into());
    }
    let d = blame(word, Code::UNKNOWN_NAME, format!("there is no particle attribute `{text}`"));
    Err(match perigrain_base::diag::nearest(text, CORE.iter().map(|(name, _)| *name)) {
        Some(near) => d.help(format!("did you mean `{near}`?")).into(),
        None => d.help("attributes are id type x vx fx radius …, c_ID, f_ID or v_name").into(),
    })
}

/// Refuses attributes that the atom style does not have.
fn requires(core: Core, word: &Word, cx: &BuildCx) -> Result<()> {
    let style = cx.world.particles.style;
    let (there, need) = match core {
        Core::Radius | Core::Diameter | Core::Omega(_) | Core::Torque(_) => (style.sphere, "sphere"),
        Core::Volume => (style.peri, "peri"),
        Core::Molecule => (style.molecules, "bond"),
        Core::Charge => (style.charged, "charge"),
        Core::Moment(_) => (style.dipole, "dipole"),
        _ => return Ok(()),
    };
    if there {
        return Ok(());
    }
    let message = format!("particles of this atom style have no `{}`", word.text);
    Err(blame(word, Code::INCOMPLETE, message).help(format!("that needs `atom_style {need}`")).into())
}

impl Attribute {
    /// A core attribute, without a word in a deck.
    pub fn core(word: &str, core: Core) -> Self {
        Self { word: word.into(), source: Source::Core(core) }
    }

    /// Whether its values are integers.
    pub fn kind(&self) -> Kind {
        match self.source {
            Source::Core(Core::Id | Core::Kind | Core::Molecule | Core::Process(_) | Core::Image(_)) => {
                Kind::Int
            }
            Source::Core(Core::Element) => Kind::Text,
            Source::Custom(_, true) => Kind::Int,
            _ => Kind::Float,
        }
    }

    /// Binds it to the location of its values when `when` fires.
    pub fn bind(&self, cx: &mut dyn SealCx, when: &When) -> Result<Bound> {
        match &self.source {
            Source::Core(core) => Ok(Bound::Core(*core)),
            Source::Value(r) => {
                // If a fix offers both kinds, such as a wall with `contacts`, particles use their own column.
                let own = cx.reading(r, Wants::PerAtom, Stage::Output, when);
                Ok(Bound::Value(own.or_else(|_| cx.value(r, Stage::Output, when))?))
            }
            Source::Custom(full, int) => match cx.world().columns.present(*full) {
                Some(column) => Ok(Bound::Custom(column, *int)),
                None => Err(gone(full.text(), cx.span()).into()),
            },
        }
    }
}

/// Data of a snapshot.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    /// The world.
    pub world: &'a World,
    /// Its box.
    pub domain: &'a Domain,
    /// Positions and image counts wrapped into the current box, for `dump_modify pbc yes`.
    pub wrapped: Option<&'a [([f64; 3], [i32; 3])]>,
    /// The name of each type.
    pub elements: &'a [String],
}

impl<'a> Frame<'a> {
    fn x(&self, i: usize) -> [f64; 3] {
        self.wrapped.map_or_else(|| self.world.particles.x[i], |w| w[i].0)
    }

    fn image(&self, i: usize) -> [i32; 3] {
        self.wrapped.map_or_else(|| self.world.particles.image[i], |w| w[i].1)
    }
}

/// An attribute bound to the location of its values.
#[derive(Clone, Debug, PartialEq)]
pub enum Bound {
    /// Core columns.
    Core(Core),
    /// A slot.
    Value(Reading),
    /// A column of fix property/atom; `true` for integers.
    Custom(Numbers, bool),
}

impl Bound {
    /// The values by particle index.
    pub fn data<'a>(&self, frame: &Frame<'a>) -> Data<'a> {
        let w = frame.world;
        let core = match self {
            Bound::Core(core) => *core,
            Bound::Value(reading) => {
                let reading = *reading;
                return Data::float(move |i| reading.atom(w, i));
            }
            Bound::Custom(column, int) => {
                let column = w.columns.get_scalar(*column).unwrap_or_default();
                let at = move |i: usize| column.get(i).copied().unwrap_or(0.0);
                return if *int { Data::int(move |i| at(i) as i64) } else { Data::float(at) };
            }
        };
        let (p, d, f) = (&frame.world.particles, frame.domain, *frame);
        // As in LAMMPS: multiplied by the inverse length instead of divided by the length.
        let inverse = |k: usize| 1.0 / (d.hi[k] - d.lo[k]);
        let length = |k: usize| d.hi[k] - d.lo[k];
        match core {
            Core::Id => Data::int(|i| i64::from(p.tag[i])),
            Core::Kind => Data::int(|i| i64::from(p.kind[i])),
            Core::Element => Data::Text(f.elements, Box::new(|i| usize::from(p.kind[i]) - 1)),
            Core::Process(rank) => Data::int(move |_| rank),
            Core::Mass => Data::slice(&p.mass),
            Core::X(k) => Data::float(move |i| f.x(i)[k]),
            Core::Scaled(k) if d.tilted() => Data::float(move |i| d.fractions(&f.x(i))[k]),
            Core::Unwrapped(k) if d.tilted() => Data::float(move |i| d.unwrapped(&f.x(i), &f.image(i))[k]),
            Core::ScaledUnwrapped(k) if d.tilted() => {
                Data::float(move |i| d.fractions(&f.x(i))[k] + f64::from(f.image(i)[k]))
            }
            Core::Tenth(k) if d.tilted() => Data::float(move |i| {
                let scaled = d.fractions(&f.x(i))[k] + f64::from(f.image(i)[k]);
                (scaled - 0.5) / 10.0 + 0.5
            }),
            Core::Scaled(k) => {
                let (lo, inverse) = (d.lo[k], inverse(k));
                Data::float(move |i| (f.x(i)[k] - lo) * inverse)
            }
            Core::Unwrapped(k) => {
                let length = length(k);
                Data::float(move |i| f.x(i)[k] + f64::from(f.image(i)[k]) * length)
            }
            Core::ScaledUnwrapped(k) => {
                let (lo, inverse) = (d.lo[k], inverse(k));
                // LAMMPS adds its image offset of 512 and subtracts it again, which costs three digits.
                let offset = if frame.world.settings.lammps() { 512.0 } else { 0.0 };
                Data::float(move |i| {
                    (f.x(i)[k] - lo) * inverse + (f64::from(f.image(i)[k]) + offset) - offset
                })
            }
            Core::Tenth(k) => {
                let (lo, inverse) = (d.lo[k], inverse(k));
                Data::float(move |i| {
                    let scaled = (f.x(i)[k] - lo) * inverse + f64::from(f.image(i)[k]);
                    (scaled - 0.5) / 10.0 + 0.5
                })
            }
            Core::Image(k) => Data::int(move |i| i64::from(f.image(i)[k])),
            Core::V(k) => Data::component(&p.v, k),
            Core::F(k) => Data::component(&p.f, k),
            Core::Radius => Data::slice(&p.radius),
            Core::Diameter => Data::float(|i| 2.0 * p.radius[i]),
            Core::Omega(k) => Data::component(&p.omega, k),
            Core::Torque(k) => Data::component(&p.torque, k),
            Core::Volume => Data::slice(&p.volume),
            Core::Molecule => Data::int(|i| i64::from(p.molecule[i])),
            Core::Charge => Data::slice(&p.charge),
            Core::Moment(Some(k)) => Data::component(&p.mu, k),
            Core::Moment(None) => Data::float(|i| vec3::length(p.mu[i])),
        }
    }
}
