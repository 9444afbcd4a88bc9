//! `material`: engineering data under a name, for pair_coeff.

mod flow;

use flow::Flow;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, FileId, Result, Span, fail};
use perigrain_constitutive::sheet::{Fault, Sheet};
use perigrain_lang::{Args, Word};
use perigrain_styles::words::{At, Each, Form, Given, Syntax, Words, read_or};
use perigrain_styles::{Act, ActCx, BuildCx, CommandStyle, Doc, Style};
use perigrain_world::material::{Material, Strength, Thermal};
use perigrain_world::potentials;

/// The style.
pub struct MaterialStyle;

impl Style for MaterialStyle {
    fn name(&self) -> &'static str {
        "material"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const {
                    &[
                        Form { head: "material ID", about: "Values of the line.", grammar: InLine::GRAMMAR },
                        Form {
                            head: "material ID file",
                            about: "Values of a file, which those of the line replace.",
                            grammar: FromFile::GRAMMAR,
                        },
                    ]
                },
            ),
            summary: "Gives engineering data a name, so that pair_coeff can turn them into coefficients.",
            text: "`E`, `nu` and `rho` are needed, in the line or in the file; without `Gc` or `s00` bonds never break.\n\n\
                   Other words are of laws of stress and strain, which `pair_style peri/cauchy` takes. `yield` alone flows without \
                   hardening. `hardening linear` needs H, `voce` sigma_inf and b (and may have H), `swift` eps0 and n, `table` a file, \
                   `johnson-cook` B, n, C, m, rate0, Tr and Tm. `cohesion`, `phi` and `psi` (and H) make flow of Drucker and Prager in \
                   place of that of Mises. Damage begins at `eps_f`, where wear by D1 to D5 is complete (with rate0, Tr and Tm), or at a tension of \
                   `ft`, also without flow, and softens until `Gf` is spent. A number without a use in the law is refused.\n\n\
                   `conductivity`, `heat_capacity`, `expansion`, `stress_free` and `taylor_quinney` are for solids whose particles have \
                   temperatures (`fix property/atom temperature heatflow`).\n\n\
                   Numbers in the line are in the deck's units. A file carries its own units and is converted (`units si cgs micro \
                   nano`). It is looked for beside the deck, in the working folder, then among the files built into perigrain: \
                   alumina.toml, brittle-plate.toml, impactor-steel.toml, laminate-impactor.toml, laminate-ply-1.toml to \
                   laminate-ply-4.toml, ofhc-copper.toml, soda-lime-glass.toml, steel-4340.toml, steel.toml.",
            example: "material plate file brittle-plate.toml Gc 50",
        }
    }
}

#[derive(Words)]
struct InLine {
    #[word(flatten)]
    properties: Each<Property>,
    #[word(flatten)]
    flow: Each<Flow>,
}

#[derive(Words)]
struct FromFile {
    /// The file's name.
    #[word(name = "NAME", kind = Kind::File)]
    file: Word,
    #[word(flatten)]
    properties: Each<Property>,
    #[word(flatten)]
    flow: Each<Flow>,
}

/// What a line says of a material.
#[derive(Clone, Words)]
#[word(keywords)]
enum Property {
    /// Young's modulus [pressure].
    #[word("E")]
    Young(#[word(name = "value", what = "E")] At<f64>),
    /// Poisson's ratio.
    #[word("nu")]
    Poisson(#[word(name = "value", what = "nu")] At<f64>),
    /// The density [mass/volume].
    #[word("rho")]
    Density(#[word(name = "value", what = "rho")] At<f64>),
    /// The fracture energy, which says when bonds break [energy/area].
    #[word("Gc")]
    Energy(#[word(name = "value", what = "Gc")] At<f64>),
    /// The critical stretch, in place of the fracture energy.
    #[word("s00")]
    Stretch(#[word(name = "value", what = "s00")] At<f64>),
    /// How much compression strengthens bonds; 0 by default.
    Alpha(#[word(name = "value", what = "alpha")] At<f64>),
    /// The tensile strength, where bonds of `peri/pmb/softening` have their peak and with `Gf` damage begins [pressure].
    #[word("ft")]
    Tensile(#[word(name = "value", what = "ft")] At<f64>),
    /// The conductivity k of `fix heat/peri` [energy/(time length temperature)].
    Conductivity(#[word(name = "value", what = "conductivity")] At<f64>),
    /// The specific heat c_p of `fix heat/peri` [energy/(mass temperature)].
    #[word("heat_capacity")]
    HeatCapacity(#[word(name = "value", what = "heat_capacity")] At<f64>),
    /// The thermal expansion α_T: particles with a temperature T strain by α_T (T − T0); 0 by default [1/temperature].
    Expansion(#[word(name = "value", what = "expansion")] At<f64>),
    /// T0, at which the material is free of stress; 0 by default [temperature].
    #[word("stress_free")]
    StressFree(#[word(name = "value", what = "stress_free")] At<f64>),
    /// The fraction of plastic work that becomes heat under `fix heat/peri`; 0.9 by default.
    #[word("taylor_quinney")]
    TaylorQuinney(#[word(name = "value", what = "taylor_quinney")] At<f64>),
}

impl CommandStyle for MaterialStyle {
    fn parse(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let id = args.expect("the material's ID")?;
        let again = cx.world.restored.contains(&format!("material/{}", id.text));
        if cx.world.materials.contains_key(&id.text) && !again {
            return fail(Code::DUPLICATE_NAME, id.span, format!("there already is a material `{}`", id.text));
        }
        let material = read(&id.text, args, cx)?;
        Ok(Box::new(Define { id: id.text.clone(), material }))
    }
}

/// Reads the words behind the material's ID.
fn read(id: &str, args: &mut Args, cx: &BuildCx) -> Result<Material> {
    let (base, properties, flow) = match args.eat("file") {
        true => {
            let line: FromFile = read_or(args, cx, no_yield)?;
            (Some((from_file(&line.file, cx)?, line.file)), line.properties, line.flow)
        }
        false => {
            let line: InLine = read_or(args, cx, no_yield)?;
            (None, line.properties, line.flow)
        }
    };
    let (base, file) = base.unzip();
    let material = material(properties, base, id, args.span())?;
    flowing(flow, material, (id, file.as_ref()), args.span())
}

/// The refusal of a property that belongs to pair_coeff.
fn no_yield(word: &Word) -> Option<Diagnostics> {
    let d = Diagnostic::error(
        Code::NOT_SUPPORTED,
        word.span,
        "a material has no syc: the stretch at which bonds flow is set in pair_coeff",
    );
    let help = "write `pair_style peri/pmb/plastic` and `pair_coeff … material ID horizon H syc V`";
    (word.text == "syc").then(|| d.help(help).into())
}

/// The values of a line over those of a file.
fn material(given: Each<Property>, base: Option<Material>, id: &str, line: Span) -> Result<Material> {
    let mut missing = if base.is_some() { vec![] } else { vec!["E", "nu", "rho"] };
    let mut m = base.unwrap_or_else(|| blank(id));
    let mut seen: Vec<String> = vec![];
    for Given { word, value, .. } in given.0 {
        let key = word.text;
        if seen.contains(&key) {
            return fail(Code::CONFLICT, word.span, format!("`{key}` is given twice"));
        }
        let rival = if key == "Gc" { "s00" } else { "Gc" };
        if matches!(key.as_str(), "Gc" | "s00") && seen.iter().any(|k| k == rival) {
            let text = "Gc and s00 both set when a bond breaks: give one";
            return fail(Code::CONFLICT, word.span, text);
        }
        missing.retain(|k| *k != key);
        let given = value.put(&mut m);
        if let Some((_, why)) = m.implausible().filter(|(bad, _)| *bad == key && !given.unknown) {
            return fail(Code::BAD_VALUE, given.span, why);
        }
        seen.push(key);
    }
    match missing.as_slice() {
        [] => Ok(m),
        keys => fail(
            Code::MISSING_ARGUMENT,
            line,
            format!("material `{id}` has no {}: E, nu and rho are needed", keys.join(", ")),
        ),
    }
}

/// A material with what its line says of elastic laws, flow and damage over what its file says.
fn flowing(
    given: Each<Flow>,
    mut m: Material,
    (id, file): (&str, Option<&Word>),
    line: Span,
) -> Result<Material> {
    let mut places: Vec<(String, Span)> = vec![];
    let mut unknown = false;
    for Given { word, value, .. } in given.0 {
        if places.iter().any(|(key, _)| *key == word.text) {
            return fail(Code::CONFLICT, word.span, format!("`{}` is given twice", word.text));
        }
        let (at, open) = value.put(&mut m.sheet, word.span);
        unknown |= open;
        places.push((word.text, at));
    }
    match m.constitutive() {
        Err(Fault::Refused { .. }) if unknown => Ok(m),
        Err(fault) => {
            let (Fault::Missing { key, .. } | Fault::Refused { key, .. }) = &fault;
            let place = places.iter().find(|(known, _)| known == key).map(|(_, at)| *at);
            let place = place.or(file.map(|file| file.span)).unwrap_or(line);
            Err(flow::fault(fault, id, file.map(|file| file.text.as_str()), place))
        }
        Ok(_) => Ok(m),
    }
}

impl Property {
    /// Puts the value into a material, and returns it with its place.
    fn put(self, m: &mut Material) -> At<f64> {
        match self {
            Self::Young(at) => (m.young = at.value, at).1,
            Self::Poisson(at) => (m.nu = at.value, at).1,
            Self::Density(at) => (m.density = at.value, at).1,
            Self::Energy(at) => (m.strength = Some(Strength::FractureEnergy(at.value)), at).1,
            Self::Stretch(at) => (m.strength = Some(Strength::Stretch(at.value)), at).1,
            Self::Alpha(at) => (m.alpha = at.value, at).1,
            Self::Tensile(at) => (m.tensile = Some(at.value), at).1,
            Self::Conductivity(at) => (m.thermal.conductivity = at.value, at).1,
            Self::HeatCapacity(at) => (m.thermal.heat_capacity = at.value, at).1,
            Self::Expansion(at) => (m.thermal.expansion = at.value, at).1,
            Self::StressFree(at) => (m.thermal.stress_free = at.value, at).1,
            Self::TaylorQuinney(at) => (m.thermal.taylor_quinney = at.value, at).1,
        }
    }
}

/// A material without given properties; its numbers are harmless.
fn blank(id: &str) -> Material {
    Material {
        name: id.to_owned(),
        young: 1.0,
        nu: 0.25,
        density: 1.0,
        strength: None,
        alpha: 0.0,
        tensile: None,
        sheet: Sheet::default(),
        thermal: Thermal::default(),
        source: String::new(),
        date: String::new(),
    }
}

/// The material of a file, in the deck's units.
fn from_file(name: &Word, cx: &BuildCx) -> Result<Material> {
    let units = cx.world.settings.units;
    let Some(scale) = units.mechanical() else {
        let text = format!("material files carry SI units, which `units {}` cannot express", units.name());
        return Err(Diagnostic::error(Code::CONFLICT, name.span, text)
            .help("use `units si`, `cgs`, `micro` or `nano`, or give the numbers in the line")
            .into());
    };
    let mut found = potentials::find(&name.text, Some(&cx.world.folder)).map_err(|e| {
        let d = Diagnostic::error(
            perigrain_base::gate::code(&e),
            name.span,
            format!("material file `{}` cannot be read: {e}", name.text),
        );
        match perigrain_base::diag::nearest(&name.text, potentials::EMBEDDED.iter().map(|f| f.0)) {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => {
                d.help("it is looked for beside the deck, in the working folder and among the built-in files")
            }
        }
    })?;
    if !found.embedded() {
        cx.world.read_files.note(std::path::Path::new(&found.place));
        found.text = cx.world.read_files.plain(&found.place, found.text);
    }
    let material =
        Material::parse(&found.text, FileId::default()).map_err(|d| retell(d, &found, name.span))?;
    Ok(material.in_units(scale))
}

/// Problems of a material file as problems of the word that named it: place and line go into the text.
fn retell(problems: Diagnostics, file: &potentials::Found, word: Span) -> Diagnostics {
    let located = |mut d: Diagnostic| {
        if let Some(s) = d.span {
            let before = file.text.get(..s.start as usize).unwrap_or("");
            let line = before.matches('\n').count();
            let text = file.text.lines().nth(line).unwrap_or("").trim();
            d.message = format!("{}:{}: {}", file.place, line + 1, d.message);
            d.help.insert(0, format!("the line reads: {text}"));
        }
        d.span = Some(word);
        d
    };
    Diagnostics(problems.0.into_iter().map(located).collect())
}

/// A material about to enter the world.
struct Define {
    id: String,
    material: Material,
}

impl Act for Define {
    fn apply(self: Box<Self>, cx: &mut ActCx) -> Result<()> {
        cx.world.restored.remove(&format!("material/{}", self.id));
        cx.world.materials.insert(self.id, self.material);
        Ok(())
    }

    fn needs_particles(&self) -> bool {
        false
    }

    fn leaves_forces(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests;
