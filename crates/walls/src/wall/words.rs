//! Words that all walls share: the force style with its parameters, and keywords.

use super::Common;
pub use super::lent::Lent;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail};
use perigrain_contact::driver::{Average, Curvature};
use perigrain_contact::{Arm, Damping, Drag, Granular, Heat, Model, normal};
use perigrain_lang::{Args, Param, Word};
use perigrain_pairs::contact::{classic, words};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{Alternative, At, Kind, Part, Placeholder, Value, Words, inner};
use perigrain_world::{Compat, World};

/// Force styles of walls.
const STYLES: [&str; 5] = ["coeff", "granular", "hooke", "hooke/history", "hertz/history"];

/// The words of a classic force.
const CLASSIC: &[Part] = &[
    Part::All(classic::Numbers::GRAMMAR),
    Part::Maybe(&[Part::Word(Placeholder {
        name: "limit_damping",
        kind: Kind::Choice(&[Alternative { word: "limit_damping", about: "", parts: &[] }]),
        about: "",
        unit: "",
    })]),
];

const fn style(word: &'static str, about: &'static str, parts: &'static [Part]) -> Alternative {
    Alternative { word, about, parts }
}

/// The force style of a wall with its parameters.
pub const FORCE: Kind = Kind::Choice(&[
    style(
        "granular",
        "Models of `pair_coeff … granular`, which describe a grain on this wall (for `hertz/material` two bodies of that material); arms of friction are R, with `arms middle` R − δ/2.",
        &[Part::bare("MODELS", Kind::Words(words::Models::GRAMMAR))],
    ),
    style(
        "coeff",
        "The laws of `pair_coeff` between each type of grains and type T, in `pair_style granular`; arms of friction are R − δ/2. Without \
         `temperature` no heat flows through the wall.",
        &[Part::All(Lent::GRAMMAR)],
    ),
    style("hooke", "The force of `pair_style gran/hooke`.", CLASSIC),
    style("hooke/history", "The force of `pair_style gran/hooke/history`.", CLASSIC),
    style("hertz/history", "The force of `pair_style gran/hertz/history`.", CLASSIC),
]);

/// Keywords of every wall.
#[derive(Words)]
pub struct Rest {
    /// Offers 8 columns per particle: 1 where it touches, the force on it, the wall's nearest point, its radius, and with a model
    /// of heat the heat that flows into the particle as a ninth.
    #[word(flag)]
    contacts: bool,
    /// The temperature of the wall [temperature], a number or an equal-style variable, for a model of heat: h π a² (T_wall − T)
    /// flows into a grain (`heat area h`), 2 k a (T_wall − T), or 2 k √A (T_wall − T).
    #[word(keyword, name = "T", placed)]
    temperature: Option<At<Param>>,
    /// Elastic constants of the wall's own, for 1/E* and 1/G* of two unlike bodies; not in LAMMPS.
    #[word(keyword, name = "E nu", placed)]
    material: Option<At<(Young, Poisson)>>,
    /// The point about which the torque on the wall is taken [length].
    #[word(keyword, name = "x y z", what = "{}")]
    about: Option<[f64; 3]>,
}

/// Young's modulus of a wall.
struct Young(f64);

impl Value for Young {
    const KIND: Kind = Kind::Number;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.positive("Young's modulus of the wall").map(Self)
    }
}

/// Poisson's ratio of a wall.
struct Poisson(f64);

impl Value for Poisson {
    const KIND: Kind = Kind::Number;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let at = args.here();
        let poisson = args.number("Poisson's ratio of the wall")?;
        if (-1.0..=0.5).contains(&poisson) {
            return Ok(Self(poisson));
        }
        fail(Code::BAD_VALUE, at, format!("Poisson's ratio lies between -1 and 0.5, {poisson} does not"))
    }
}

impl Rest {
    /// With the temperature of the surfaces that the wall consists of.
    ///
    /// # Errors
    /// Another temperature in the line.
    pub fn with_temperature(mut self, own: Option<Param>, span: Span) -> Result<Self> {
        match (&self.temperature, own) {
            (Some(at), Some(_)) => {
                return fail(Code::CONFLICT, at.span, "its surfaces have a temperature by their own lines");
            }
            (None, Some(value)) => self.temperature = Some(At { value, span, unknown: false }),
            (_, None) => {}
        }
        Ok(self)
    }

    /// The data of a wall with this force, whose torque is taken about `center` unless the line says another point.
    ///
    /// # Errors
    /// A material that the force cannot have, and heat without a temperature, or the reverse.
    pub fn common(self, material: Material, center: [f64; 3], cx: &BuildCx) -> Result<Common> {
        let own = match self.material {
            Some(At { span, .. }) if material.lent.is_some() => {
                let text = "a wall has constants of its own or those of a type, not both";
                let d = Diagnostic::error(Code::CONFLICT, span, text);
                return Err(d.help("give them to the type: `pair_coeff I T …`").into());
            }
            Some(At { value: (Young(young), Poisson(poisson)), span, .. }) => {
                Some(own_material(span, [young, poisson], &material.model)?)
            }
            None => None,
        };
        let common = Common {
            contacts: self.contacts,
            temperature: self.temperature.map(|at| (at.value, at.span)),
            center: self.about.unwrap_or(center),
            ..common(cx, Material { own, ..material })
        };
        check_heat(&common)?;
        Ok(common)
    }
}

/// A law and where it holds.
pub struct Ruled {
    /// The law.
    pub law: Granular,
    /// Whether each type of grains (from 1) has it; all have where nothing stands.
    pub kinds: Option<Vec<bool>>,
    /// The type of the surfaces that have it; all have where nothing stands.
    pub surface: Option<u16>,
}

/// Materials of a wall and of the grains on it.
#[derive(Clone)]
pub struct Material {
    /// Contact model.
    pub model: Model,
    /// The wall's own material, if given by `material`.
    pub own: Option<Model>,
    /// Whose laws it has in place of the model's, after `coeff`.
    pub lent: Option<Lent>,
    /// Span of the model.
    pub span: Span,
}

impl Material {
    /// The laws of the contacts of a wall, which has surfaces of these types.
    ///
    /// # Errors
    /// Coefficients that are missing.
    pub fn laws(&self, w: &World, surfaces: &[u16]) -> Result<Vec<Ruled>> {
        match &self.lent {
            Some(lent) => lent.laws(w, surfaces),
            None => Ok(vec![Ruled { law: self.law(w.settings.compat), kinds: None, surface: None }]),
        }
    }

    fn law(&self, compat: Compat) -> Granular {
        match &self.own {
            None => self.model.law(compat),
            Some(wall) => self.model.mixed(wall, compat).unwrap_or_else(|_| self.model.law(compat)),
        }
    }
}

/// Reads the force style and its parameters, up to one of the words that name the wall.
///
/// # Errors
/// Every mistake in them.
pub fn force(args: &mut Args, cx: &BuildCx, ends: &[&str]) -> Result<Material> {
    let word = args.expect("the force style")?;
    let span = word.span;
    if word.text == "coeff" {
        return Ok(Material { model: Model::none(), own: None, lent: Some(inner(args, cx)?), span });
    }
    let classic = |hertz: bool, history: bool, args: &mut Args| {
        let numbers = classic::numbers(args, hertz, cx)?;
        let mut model = Model::classic(hertz, history, &numbers);
        let [gamma_n, gamma_t] = numbers.gamma;
        if gamma_n > 0.0 {
            // To LAMMPS, walls use the granular model, including its errors in springs.
            model.tangential.drag = Drag::Times(gamma_t / gamma_n);
        }
        Ok::<_, Diagnostics>(model)
    };
    let model = match word.text.as_str() {
        // As in LAMMPS, friction acts on a grain at its full radius, whatever the overlap, unless the line says `arms middle`.
        "granular" => {
            let arms = names_arms(args, ends);
            let model = granular(args, cx, ends)?;
            let arm = if arms { model.arm } else { Arm::Radius };
            return Ok(Material { model: Model { arm, ..model }, own: None, lent: None, span });
        }
        "hooke" => classic(false, false, args)?,
        "hooke/history" => classic(false, true, args)?,
        "hertz/history" => classic(true, true, args)?,
        _ => {
            return Err(unknown_force(word, ends).into());
        }
    };
    Ok(Material { model: Model { arm: Arm::Radius, ..model }, own: None, lent: None, span })
}

/// Whether the words of a force choose the arms of friction.
fn names_arms(args: &Args, ends: &[&str]) -> bool {
    let words = (0..).map_while(|k| args.peek_at(k)).take_while(|word| !ends.contains(&word.text.as_str()));
    words.into_iter().any(|word| word.text == "arms")
}

/// The error for a word that is not a force style of walls: a normal model lacks `granular` before it; a word
/// about the wall stands before its force.
fn unknown_force(word: &Word, ends: &[&str]) -> Diagnostic {
    let d = Diagnostic::error(
        Code::UNKNOWN_STYLE,
        word.span,
        format!("unknown force style of a wall: `{}`", word.text),
    );
    if normal::STYLES.iter().any(|model| model.name == word.text) {
        return d.help(format!(
            "write `granular {} …`: normal models of walls stand behind `granular`",
            word.text
        ));
    }
    let about_the_wall = |text: &str| ends.contains(&text) || Rest::GRAMMAR.has(text) || text == "file";
    if about_the_wall(&word.text) || word.text.contains('.') {
        let example = "granular hertz/material E e nu tangential mindlin NULL x_gamma mu";
        return d.help(format!("write the force first: `{example} {} …`", ends[0]));
    }
    match perigrain_base::diag::nearest(&word.text, STYLES) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help(format!("known here: {}", STYLES.join(" "))),
    }
}

fn granular(args: &mut Args, cx: &BuildCx, ends: &[&str]) -> Result<Model> {
    let c = words::coeff(args, cx, ends)?;
    let wrong = if c.average != Average::None {
        "`average` is for contacts of particles with each other"
    } else if c.curvature != Curvature::Both {
        "`curvature` is for contacts of particles with each other"
    } else if c.model.arm == Arm::Point {
        "`arms` is for contacts of particles with each other"
    } else if let Some((_, span)) = c.other {
        let d = Diagnostic::error(Code::CONFLICT, span, "`material` of a wall stands behind the wall");
        return Err(d.help("write `fix … wall/gran granular … zplane 0 NULL material E nu`").into());
    } else if c.cutoff.is_some() {
        "`cutoff` is for contacts of particles with each other"
    } else {
        return Ok(c.model);
    };
    fail(Code::CONFLICT, c.span, format!("{wrong}: a wall has no use for it"))
}

/// Refuses heat without a wall temperature, and the reverse.
fn check_heat(common: &Common) -> Result<()> {
    if common.material.lent.is_some() {
        // What coefficients conduct is seen when a run is sealed.
        return Ok(());
    }
    let conducts = common.material.model.heat != Heat::None;
    let (span, text, help) = match &common.temperature {
        Some((_, span)) if !conducts => {
            let text = "a wall has a temperature, but its contacts conduct no heat";
            (*span, text, "add `heat area H`, `heat radius K` or `heat contact K` to the model of the wall")
        }
        None if conducts => {
            let text = "contacts conduct heat, but the wall has no temperature";
            (common.material.span, text, "add `temperature T` behind the place of the wall")
        }
        _ => return Ok(()),
    };
    Err(Diagnostic::error(Code::CONFLICT, span, text).help(help).into())
}

/// `material E nu`: the wall's own elastic constants; the other parameters are those of the model.
fn own_material(span: Span, [young, poisson]: [f64; 2], model: &Model) -> Result<Model> {
    let Some(normal) = model.normal.with_material(young, poisson) else {
        let name = model.normal.name();
        let text = format!("a wall of another material needs a normal model with one, not {name}");
        let d = Diagnostic::error(Code::CONFLICT, span, text);
        return Err(d.help("take `granular hertz/material E eta nu …`").into());
    };
    Ok(Model { normal, ..*model })
}

/// The common data of a wall before its keywords are read.
fn common(cx: &BuildCx, material: Material) -> Common {
    if material.model.damping == Damping::Tsuji {
        cx.fault(material.span, "damping tsuji without its factor √2", true);
    }
    if material.model.synchronized {
        let fault = "synchronized_verlet whose forces act along the normal of the middle of the step";
        cx.fault(material.span, fault, false);
    }
    if material.model.slides_loosely() {
        let fault =
            "springs of walls with history that depend on the contact radius, and lose it when they slide";
        cx.fault(material.span, fault, true);
    }
    Common {
        id: cx.id.to_string(),
        group: cx.group,
        material,
        contacts: false,
        temperature: None,
        center: [0.0; 3],
    }
}
