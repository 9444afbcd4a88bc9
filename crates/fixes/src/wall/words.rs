//! Words that all walls share: the force style with its parameters, and keywords.

use super::Common;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail};
use perigrain_contact::driver::{Average, Curvature};
use perigrain_contact::{Arm, Damping, Drag, Granular, Heat, Model, normal};
use perigrain_lang::{Args, Word};
use perigrain_pairs::contact::{classic, words};
use perigrain_styles::BuildCx;
use perigrain_styles::common::variable_param;
use perigrain_world::Compat;

/// Force styles of walls.
const STYLES: [&str; 4] = ["granular", "hooke", "hooke/history", "hertz/history"];

/// Keywords of every wall.
pub const KEYWORDS: [&str; 4] = ["contacts", "temperature", "material", "about"];

/// Materials of a wall and of the grains on it.
#[derive(Clone, Copy)]
pub struct Material {
    /// Contact model.
    pub model: Model,
    /// The wall's own material, if given by `material`.
    pub own: Option<Model>,
    /// Span of the model.
    pub span: Span,
}

impl Material {
    /// The law of the wall's contacts.
    pub fn law(&self, compat: Compat) -> Granular {
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
    let classic = |hertz: bool, history: bool, args: &mut Args| {
        let numbers = classic::numbers(args, hertz, cx.world.settings.units)?;
        let mut model = Model::classic(hertz, history, &numbers);
        let [gamma_n, gamma_t] = numbers.gamma;
        if gamma_n > 0.0 {
            // To LAMMPS, walls use the granular model, including its errors in springs.
            model.tangential.drag = Drag::Times(gamma_t / gamma_n);
        }
        Ok::<_, Diagnostics>(model)
    };
    let model = match word.text.as_str() {
        "granular" => granular(args, ends)?,
        "hooke" => classic(false, false, args)?,
        "hooke/history" => classic(false, true, args)?,
        "hertz/history" => classic(true, true, args)?,
        _ => {
            return Err(unknown_force(word, ends).into());
        }
    };
    // As in LAMMPS, friction acts on a grain at its full radius, whatever the overlap.
    Ok(Material { model: Model { arm: Arm::Radius, ..model }, own: None, span })
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
    let about_the_wall = |text: &str| ends.contains(&text) || KEYWORDS.contains(&text) || text == "file";
    if about_the_wall(&word.text) || word.text.contains('.') {
        let example = "granular hertz/material E e nu tangential mindlin NULL x_gamma mu";
        return d.help(format!("write the force first: `{example} {} …`", ends[0]));
    }
    match perigrain_base::diag::nearest(&word.text, STYLES) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help(format!("known here: {}", STYLES.join(" "))),
    }
}

fn granular(args: &mut Args, ends: &[&str]) -> Result<Model> {
    let c = words::coeff(args, ends)?;
    let wrong = if c.average != Average::None {
        "`average` is for contacts of particles with each other"
    } else if c.curvature != Curvature::Both {
        "`curvature` is for contacts of particles with each other"
    } else if c.model.arm == Arm::Point {
        "`arms` is for contacts of particles with each other"
    } else if c.cutoff.is_some() {
        "`cutoff` is for contacts of particles with each other"
    } else {
        return Ok(c.model);
    };
    fail(Code::CONFLICT, c.span, format!("{wrong}: a wall has no use for it"))
}

/// Reads one of the keywords of all walls; returns whether the word is one.
///
/// # Errors
/// Mistakes in its arguments.
pub fn keyword(word: &Word, args: &mut Args, cx: &BuildCx, common: &mut Common) -> Result<bool> {
    match word.text.as_str() {
        "contacts" => common.contacts = true,
        "material" => common.material.own = Some(own_material(word, args, &common.material.model)?),
        "about" => {
            common.center = [args.number("x")?, args.number("y")?, args.number("z")?];
        }
        "temperature" => {
            let warmth = variable_param(args, "the temperature of the wall")?;
            cx.param(&warmth, false)?;
            common.temperature = Some((warmth, word.span));
        }
        _ => return Ok(false),
    }
    Ok(true)
}

/// Refuses heat without a wall temperature, and the reverse.
pub fn check_heat(common: &Common) -> Result<()> {
    let conducts = common.material.model.heat != Heat::None;
    let (span, text, help) = match &common.temperature {
        Some((_, span)) if !conducts => {
            let text = "a wall has a temperature, but its contacts conduct no heat";
            (*span, text, "add `heat area H` or `heat radius K` to the model of the wall")
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
fn own_material(word: &Word, args: &mut Args, model: &Model) -> Result<Model> {
    let young = args.positive("Young's modulus of the wall")?;
    let at = args.here();
    let poisson = args.number("Poisson's ratio of the wall")?;
    if !(-1.0..=0.5).contains(&poisson) {
        let text = format!("Poisson's ratio lies between -1 and 0.5, {poisson} does not");
        return fail(Code::BAD_VALUE, at, text);
    }
    let Some(normal) = model.normal.with_material(young, poisson) else {
        let name = model.normal.name();
        let text = format!("a wall of another material needs a normal model with one, not {name}");
        let d = Diagnostic::error(Code::CONFLICT, word.span, text);
        return Err(d.help("take `granular hertz/material E eta nu …`").into());
    };
    Ok(Model { normal, ..*model })
}

/// The common data of a wall before its keywords are read.
pub fn common(cx: &BuildCx, material: Material) -> Common {
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
