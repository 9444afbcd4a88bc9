//! The words of `pair_coeff … granular`: models by name, each with its numbers; unknown models are refused by name.

use super::Coeff;
use super::models::{Dampings, Law};
use super::sliding::Sliding;
use super::sticking::{Cohesions, Heating};
use super::turning::{Rollings, Twistings};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_contact::driver::{Average, Curvature};
use perigrain_contact::{Arm, Cohesion, Damping, Friction, Heat, Model, Rolling, Twisting};
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{At, Kind, Value, Words, read};

/// The words of a contact model between particles.
#[derive(Words)]
pub struct Line {
    #[word(flatten)]
    models: Models,
    #[word(flatten)]
    meeting: Meeting,
}

/// Words about particles that meet, of which a wall has use for `arms middle` alone.
#[derive(Words)]
struct Meeting {
    /// The cutoff, which sets the reach of the neighbour list by hand [length].
    #[word(keyword, name = "C", positive)]
    cutoff: Option<f64>,
    #[word(keyword, like = Averages, default = Average::None)]
    average: Average,
    #[word(keyword, like = Curvatures, default = Curvature::Both)]
    curvature: Curvature,
    #[word(keyword, like = Ends, default = Arm::Middle)]
    arms: Arm,
    /// Elastic constants of the second type, for 1/E* and 1/G* of two unlike materials; not in LAMMPS.
    #[word(keyword, name = "E nu", placed)]
    material: Option<At<(Young, Poisson)>>,
}

/// Young's modulus of the second body.
pub struct Young(pub f64);

impl Value for Young {
    const KIND: Kind = Kind::Number;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.positive("Young's modulus of the second material").map(Self)
    }
}

/// Poisson's ratio of the second body.
pub struct Poisson(pub f64);

impl Value for Poisson {
    const KIND: Kind = Kind::Number;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let at = args.here();
        let poisson = args.number("Poisson's ratio of the second material")?;
        if (-1.0..=0.5).contains(&poisson) {
            return Ok(Self(poisson));
        }
        fail(Code::BAD_VALUE, at, format!("Poisson's ratio lies between -1 and 0.5, {poisson} does not"))
    }
}

/// The words of a contact model, of a wall too.
#[derive(Words)]
pub struct Models {
    #[word(name = "NORMAL")]
    normal: Law,
    /// The friction against sliding.
    #[word(keyword, name = "MODEL", shown = "required")]
    tangential: Option<Sliding>,
    /// The damping along the normal.
    #[word(keyword, name = "MODEL", like = Dampings, default = Damping::default(), shown = "viscoelastic")]
    damping: Damping,
    /// The resistance to rolling.
    #[word(keyword, name = "MODEL", like = Rollings, kind = ROLLING, default = Rolling::None, shown = "none")]
    rolling: Rolling,
    /// The resistance to twisting.
    #[word(keyword, name = "MODEL", like = Twistings, kind = TWISTING, default = Twisting::None, shown = "none")]
    twisting: Twisting,
    /// The pull of grains that touch.
    #[word(keyword, name = "MODEL", like = Cohesions, kind = COHESION, default = Cohesion::None, shown = "none")]
    cohesion: Cohesion,
    /// The heat that flows.
    #[word(keyword, name = "MODEL", like = Heating, kind = HEAT, default = Heat::None, shown = "none")]
    heat: Heat,
    /// Cuts the force along the normal off at zero, before cohesion.
    #[word(flag, placed)]
    limit_damping: Option<Span>,
    /// Springs turn with the normal of the middle of the step.
    #[word(flag, placed)]
    synchronized_verlet: Option<Span>,
}

const ROLLING: Kind = Kind::Models(Rollings::KIND.choices());
const TWISTING: Kind = Kind::Models(Twistings::KIND.choices());
const COHESION: Kind = Kind::Models(Cohesions::KIND.choices());
const HEAT: Kind = Kind::Models(Heating::KIND.choices());

/// By what the force of each contact is divided.
#[derive(Words)]
#[word(what = "way of averaging", of = Average)]
enum Averages {
    /// Forces are whole.
    None,
    /// The force of each contact is divided by the number of simultaneous ones of the two particles, the larger number; action and
    /// reaction stay equal.
    Particle,
    /// It is divided by that of the two bodies.
    Body,
}

/// Whose curvature counts.
#[derive(Words)]
#[word(what = "curvature", of = Curvature)]
enum Curvatures {
    /// Both radii count.
    Both,
    /// R̄ = R of the grain where it meets a peridynamic solid, whose surface counts as flat (Walayat et al., table 1).
    Impactor,
}

/// Where the arms of friction end.
#[derive(Words)]
#[word(what = "end of the arms", of = Arm)]
enum Ends {
    /// Friction takes hold in the middle of the overlap.
    Middle,
    /// On a point of a peridynamic solid it takes hold at the point itself.
    Point,
}

/// Reads a granular model: to the end of the line, or to one of the words `ends` (what follows the model of a wall).
///
/// # Errors
/// Every mistake in the line.
pub fn coeff(args: &mut Args, cx: &BuildCx, ends: &[&str]) -> Result<Coeff> {
    let mut own = args.until(|word| ends.contains(&word));
    let Line { models, meeting } = read(&mut own, cx)?;
    let Meeting { cutoff, average, curvature, arms, material } = meeting;
    let Law { model: normal, word: first } = models.normal;
    let Some(sliding) = models.tangential else {
        return Err(Diagnostic::error(
            Code::MISSING_ARGUMENT,
            args.here(),
            "a granular contact needs a tangential model",
        )
        .help("add `tangential mindlin NULL 1.0 0.5`; `tangential none` makes spheres smooth")
        .into());
    };
    let model = Model {
        rolling: models.rolling,
        twisting: models.twisting,
        cohesion: models.cohesion,
        heat: models.heat,
        limit_damping: models.limit_damping.is_some(),
        arm: arms,
        synchronized: models.synchronized_verlet.is_some(),
        ..Model::new(normal, models.damping, sliding.tangential(&normal)?)
    };
    let other = match material {
        Some(At { value: (Young(young), Poisson(poisson)), span, .. }) => {
            Some((second(span, [young, poisson], &model)?, span))
        }
        None => None,
    };
    let c = Coeff { model, other, average, curvature, cutoff, span: first.span };
    check_synchrony(&c.model, models.synchronized_verlet)?;
    check_slip(&c.model, &sliding)?;
    check_turning(&first, &c.model)?;
    check_mdr(&first, &c)?;
    check_restitution(&first, &c.model)?;
    check_cohesion(&first, &c.model, models.limit_damping)?;
    Ok(c)
}

/// `material E nu`: the elastic constants of the second body; the other parameters are those of the model.
fn second(span: Span, [young, poisson]: [f64; 2], model: &Model) -> Result<Model> {
    let Some(normal) = model.normal.with_material(young, poisson) else {
        let text = format!("`material` needs a normal model with a material, not {}", model.normal.name());
        let d = Diagnostic::error(Code::CONFLICT, span, text);
        return Err(d.help("use `hertz/material E eta nu …` or `hooke/velocity E eta nu V …`").into());
    };
    Ok(Model { normal, ..*model })
}

/// `slip spring` has the spring and the arms of grains that touch, at the end of the step.
fn check_slip(model: &Model, sliding: &Sliding) -> Result<()> {
    let Some(span) = sliding.slips_by_spring() else { return Ok(()) };
    let text = if model.synchronized {
        "`slip spring` projects springs onto the plane at the end of the step, `synchronized_verlet` turns them"
    } else if model.normal.in_grains() {
        "`slip spring` does not go with the normal model mdr"
    } else {
        return Ok(());
    };
    Err(Diagnostic::error(Code::CONFLICT, span, text).help("leave one of the two out").into())
}

/// Torques and cohesion that need two spheres, or a stiffness that the other models do not have.
fn check_turning(normal: &Word, model: &Model) -> Result<()> {
    let conflict = |text: String, help: &str| {
        Err(Diagnostic::error(Code::CONFLICT, normal.span, text).help(help.to_string()).into())
    };
    let torque = model.rolling.is_torque();
    if (torque || model.cohesion != Cohesion::None) && (model.arm == Arm::Point || model.normal.in_grains()) {
        let name = if torque { model.rolling.name() } else { model.cohesion.name() };
        let other = if model.normal.in_grains() { "the normal model mdr" } else { "`arms point`" };
        return conflict(format!("{name} does not go with {other}"), "leave one of the two out");
    }
    let own = matches!(model.tangential.kind, Friction::None | Friction::LinearNohistory);
    if model.cohesion.spans() && (model.synchronized || !model.normal.takes_restitution()) {
        let other = if model.synchronized { "`synchronized_verlet`" } else { model.normal.name() };
        let text = format!("`cohesion capillary` does not go with {other}");
        return conflict(
            text,
            "a bridge takes the place of other cohesion and acts along the line of centres",
        );
    }
    if matches!(model.rolling, Rolling::Epsd2(_)) && own {
        let known = model.normal.exponent() == 1.0 || model.normal.material().is_some();
        if !known {
            let text = format!(
                "`rolling epsd2` takes k_t from a spring or a material, {} has none",
                model.normal.name()
            );
            return conflict(text, "use a tangential model with a spring, hertz/material, or `rolling epsd`");
        }
    }
    if model.tangential.of_normal && model.twisting == Twisting::Marshall {
        let text = "`twisting marshall` needs k_t as a number".to_string();
        return conflict(text, "write the stiffness kt, or use `twisting sds`");
    }
    Ok(())
}

/// `mdr` goes with its own damping or none, that damping with nothing else.
fn check_mdr(normal: &Word, c: &Coeff) -> Result<()> {
    let own = matches!(c.model.damping, Damping::Mdr | Damping::MdrConstant);
    let suits = own || c.model.damping == Damping::None;
    let text = match (c.model.normal.in_grains(), own) {
        (true, _) if !suits => "the normal model mdr goes with `damping mdr` or `none`",
        (true, _)
            if c.average != Average::None || c.curvature != Curvature::Both || c.model.arm == Arm::Point =>
        {
            "the normal model mdr knows no `average`, no `curvature` and no `arms point`"
        }
        (true, _) | (false, false) => return Ok(()),
        (false, true) => "damping mdr goes with the normal model mdr alone",
    };
    Err(Diagnostic::error(Code::CONFLICT, normal.span, text)
        .help("write `mdr E nu Y gamma psi_b e … damping mdr 1`, or `damping none`")
        .into())
}

/// `synchronized_verlet` is about springs across the normal, as in LAMMPS.
fn check_synchrony(model: &Model, synchronized: Option<Span>) -> Result<()> {
    let Some(span) = synchronized.filter(|_| model.tangential.kind == Friction::LinearNohistory) else {
        return Ok(());
    };
    let text = "synchronized_verlet turns springs, and `tangential linear_nohistory` has none";
    let d = Diagnostic::error(Code::CONFLICT, span, text);
    Err(d.help("leave the word out, or take `linear_history` or one of the `mindlin` models").into())
}

/// Where the damping model reads `eta` as a coefficient of restitution, it must be one.
fn check_restitution(normal: &Word, model: &Model) -> Result<()> {
    let e = model.normal.eta();
    let least_is_open = model.damping == Damping::CoeffRestitution;
    if !model.damping.wants_restitution() || (e <= 1.0 && (e > 0.0 || !least_is_open)) {
        return Ok(());
    }
    let text = format!(
        "damping {} takes the second number of {} as coefficient of restitution, between 0 and 1: {e} is none",
        model.damping.name(),
        model.normal.name()
    );
    Err(Diagnostic::error(Code::BAD_VALUE, normal.span, text).into())
}

/// What does not go with grains that stick together.
fn check_cohesion(normal: &Word, model: &Model, limit: Option<Span>) -> Result<()> {
    let name = model.normal.name();
    if model.damping.wants_restitution() && !model.normal.takes_restitution() {
        let text =
            format!("damping {} is made for grains that only push, {name} pulls", model.damping.name());
        return Err(Diagnostic::error(Code::CONFLICT, normal.span, text)
            .help("use damping velocity, mass_velocity or viscoelastic")
            .into());
    }
    if let Some(span) = limit.filter(|_| model.normal.pulls()) {
        let text = format!("limit_damping would cut off the attraction of {name}");
        return Err(Diagnostic::error(Code::CONFLICT, span, text).help("leave the word out").into());
    }
    Ok(())
}
