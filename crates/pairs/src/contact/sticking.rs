//! The models of cohesion and of heat conduction as words with their numbers.

use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_contact::{Area, Bridge, Cohesion, Heat, Profile, Pull};
use perigrain_lang::Args;
use perigrain_styles::BuildCx;
use perigrain_styles::words::Words;

/// A model of cohesion.
#[derive(Words)]
#[word(style, what = "cohesion model")]
pub enum Cohesions {
    /// No cohesion.
    None,
    /// A pull k A while the two touch, A the circle in which the spheres intersect.
    Sjkr(Pulling),
    /// The same with A = 4 π δ R̄, on walls 2 π δ R.
    Sjkr2(Pulling),
    /// A liquid bridge, which forms where the two touch and pulls until it ruptures.
    Capillary(Ring),
}

/// Words of a liquid bridge.
#[derive(Words)]
pub struct Ring {
    /// The volume V of each bridge [volume].
    #[word(name = "V", what = "the volume of a bridge", positive)]
    volume: f64,
    /// The surface tension sigma [force/length].
    #[word(name = "sigma", what = "the surface tension", non_negative)]
    tension: f64,
    /// The contact angle theta [degrees].
    #[word(name = "theta", with = contact_angle, kind = Kind::Number)]
    angle: f64,
    #[word(keyword, name = "rabinovich|willett", like = Profiles, default = Profile::Rabinovich)]
    force: Profile,
    /// The distance of surfaces at which it ruptures, (1 + θ/2) V^(1/3) without the word, θ in radians [length].
    #[word(keyword, name = "S", what = "the distance of rupture", positive)]
    rupture: Option<f64>,
}

/// The force of a liquid bridge.
#[derive(Words)]
#[word(what = "force of a bridge", of = Profile)]
enum Profiles {
    /// 2 π R σ cos θ (1 − H/√(H² + 2 V/(π R))), R = 2 R̄, at the distance H (Rabinovich et al. 2005).
    Rabinovich,
    /// 2 π R σ cos θ/(1 + 1.05 s + 2.5 s²), s = H √(R/V) (Willett et al. 2000).
    Willett,
}

/// A contact angle in degrees.
fn contact_angle(args: &mut Args, _: &BuildCx) -> Result<f64> {
    let at = args.here();
    let angle = args.number("the contact angle")?;
    if (0.0..90.0).contains(&angle) {
        return Ok(angle);
    }
    let text = format!(
        "the contact angle of a liquid that pulls is at least 0 and below 90 degrees, {angle} is not"
    );
    Err(Diagnostic::error(Code::BAD_VALUE, at, text).into())
}

/// Words of a pull.
#[derive(Words)]
pub struct Pulling {
    /// The energy density k [energy/volume].
    #[word(what = "the energy density k", non_negative)]
    k: f64,
    /// The limit of friction counts from the force with the pull.
    #[word(flag)]
    reduce: bool,
}

/// A model of heat conduction between particles of temperatures T.
#[derive(Words)]
#[word(style, what = "heat model")]
pub enum Heating {
    /// No heat flows.
    None,
    /// h π a² (T_j − T_i) flows, see fix heat/flow.
    Area(#[word(name = "h", what = "the heat transfer coefficient", non_negative)] f64),
    /// 2 k a (T_j − T_i) flows.
    Radius(#[word(name = "k", what = "the conductivity", non_negative)] f64),
    /// 2 k √A (T_j − T_i) flows, A the area of contact; unlike types have k = 2 k_i k_j/(k_i + k_j).
    Contact(Through),
}

/// Words of the heat through the area of contact.
#[derive(Words)]
pub struct Through {
    /// The conductivity k [energy/(time length temperature)].
    #[word(what = "the conductivity", non_negative)]
    k: f64,
    #[word(keyword, name = "AREA", default = Areas::Overlap, shown = "overlap")]
    area: Areas,
    /// The factor of δ in A, for grains softer than their material.
    #[word(keyword, name = "f", what = "the factor of the overlap", positive)]
    scaled: Option<f64>,
}

/// What A is.
#[derive(Clone, Copy, Words)]
#[word(what = "area of contact")]
enum Areas {
    /// The circle in which the spheres intersect.
    Overlap,
    /// π times the square of the larger radius; on walls the circle.
    Projection,
    /// A itself; on walls the circle.
    Constant(#[word(name = "A", what = "the area", positive)] f64),
}

impl From<Cohesions> for Cohesion {
    fn from(cohesion: Cohesions) -> Self {
        let pull = |words: Pulling| Pull { density: words.k, reduces: words.reduce };
        match cohesion {
            Cohesions::None => Self::None,
            Cohesions::Sjkr(words) => Self::Sjkr(pull(words)),
            Cohesions::Sjkr2(words) => Self::Sjkr2(pull(words)),
            Cohesions::Capillary(Ring { volume, tension, angle, force, rupture }) => {
                let bridge = Bridge::new(force, volume, tension, angle.to_radians());
                Self::Capillary(Bridge { rupture: rupture.unwrap_or(bridge.rupture), ..bridge })
            }
        }
    }
}

impl From<Heating> for Heat {
    fn from(heat: Heating) -> Self {
        match heat {
            Heating::None => Self::None,
            Heating::Area(h) => Self::Area(h),
            Heating::Radius(k) => Self::Radius(k),
            Heating::Contact(Through { k, area, scaled }) => {
                let area = match area {
                    Areas::Overlap => Area::Overlap(scaled.unwrap_or(1.0)),
                    Areas::Projection => Area::Projection,
                    Areas::Constant(area) => Area::Constant(area),
                };
                Self::Contact { conductivity: k, area }
            }
        }
    }
}
