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
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_base::units::UnitSystem;
    use perigrain_constitutive::Law;
    use perigrain_constitutive::sheet::Key;
    use perigrain_lang::Command;
    use perigrain_styles::{Names, Shape, UseKind};
    use perigrain_world::World;
    use std::cell::RefCell;

    struct Nothing;

    impl Names for Nothing {
        fn compute(&self, _: &str) -> Option<Shape> {
            None
        }
        fn fix(&self, _: &str) -> Option<Shape> {
            None
        }
        fn variable_shape(&self, _: &str) -> Option<perigrain_styles::Shape> {
            None
        }
        fn all(&self, _: UseKind) -> Vec<String> {
            vec![]
        }
    }

    /// Reads `material` with these words in this world.
    fn parse(world: &World, line: &str) -> Result<Material> {
        let mut at = 0;
        let mut words = line.split(' ').map(|w| {
            at += w.len() + 1;
            Word::new(w, Span::new(FileId(0), at - 1 - w.len(), at - 1))
        });
        let name = words.next().unwrap();
        let span = Span::new(FileId(0), 0, line.len());
        let command = Command { name, args: words.collect(), span, text: line.to_owned() };
        let (notes, uses) = (RefCell::default(), RefCell::default());
        let cx = BuildCx {
            world,
            names: &Nothing,
            id: "",
            group: perigrain_world::GroupId(0),
            span,
            checking: false,
            notes: &notes,
            uses: &uses,
        };
        let mut args = Args::new(&command);
        args.next();
        super::read("m", &mut args, &cx)
    }

    fn si() -> World {
        let mut w = World::default();
        w.settings.units = UnitSystem::Si;
        w
    }

    #[test]
    fn numbers_in_the_line() {
        let m = parse(&si(), "material m E 7e10 nu 0.25 rho 2500 Gc 8 alpha 0.25").unwrap();
        assert_eq!((m.young, m.nu, m.density, m.alpha), (7e10, 0.25, 2500.0, 0.25));
        assert_eq!(m.strength, Some(Strength::FractureEnergy(8.0)));
    }

    #[test]
    fn heat_in_the_line() {
        let line = "material m E 1 nu 0.25 rho 1 conductivity 401 heat_capacity 385 expansion 1.7e-5 stress_free 293";
        let heat =
            Thermal { conductivity: 401.0, heat_capacity: 385.0, expansion: 1.7e-5, stress_free: 293.0 };
        assert_eq!(parse(&si(), line).unwrap().thermal, heat);
        assert!(parse(&si(), "material m E 1 nu 0.25 rho 1 conductivity -1").is_err());
    }

    #[test]
    fn values_replace_those_of_the_file() {
        let m = parse(&si(), "material m file brittle-plate.toml Gc 50").unwrap();
        assert_eq!((m.young, m.strength), (22.35e9, Some(Strength::FractureEnergy(50.0))));
        let m = parse(&si(), "material m file brittle-plate.toml s00 0.001").unwrap();
        assert_eq!(m.strength, Some(Strength::Stretch(0.001)));
    }

    #[test]
    fn files_speak_the_units_of_the_deck() {
        let mut w = si();
        w.settings.units = UnitSystem::Cgs;
        let m = parse(&w, "material m file steel.toml").unwrap();
        // 206 GPa = 2.06e12 dyn/cm², 7833 kg/m³ = 7.833 g/cm³.
        assert!((m.young / 2.06e12 - 1.0).abs() < 1e-14 && (m.density / 7.833 - 1.0).abs() < 1e-14);
        w.settings.units = UnitSystem::Lj;
        assert!(parse(&w, "material m file steel.toml").is_err());
    }

    #[test]
    fn mistakes_are_underlined() {
        let wrong = |line: &str| {
            let d = parse(&si(), line).unwrap_err().0.remove(0);
            let s = d.span.unwrap();
            (line[s.start as usize..s.end as usize].to_owned(), d.code)
        };
        let full = "material m E 1 nu 0.25 rho 1";
        assert_eq!(wrong("material m E 1 nu 0.25 roh 1"), ("roh".into(), Code::UNKNOWN_KEYWORD));
        assert_eq!(wrong("material m E 1 nu 0.7 rho 1"), ("0.7".into(), Code::BAD_VALUE));
        assert_eq!(wrong("material m E 1 nu 0.2").1, Code::MISSING_ARGUMENT);
        assert_eq!(wrong(&format!("{full} Gc 1 s00 1")), ("s00".into(), Code::CONFLICT));
        assert_eq!(wrong(&format!("{full} E 2")), ("E".into(), Code::CONFLICT));
        assert_eq!(wrong(&format!("{full} syc -1")), ("syc".into(), Code::NOT_SUPPORTED));
        assert_eq!(wrong("material m file stel.toml"), ("stel.toml".into(), Code::NO_FILE));
    }

    #[test]
    fn flow_in_the_line_and_over_a_file() {
        let full = "material m E 117e9 nu 0.35 rho 8930";
        let m =
            parse(&si(), &format!("{full} yield 400e6 hardening linear H 100e6 eps_f 0.3 Gf 2e4")).unwrap();
        assert!(matches!(m.constitutive().unwrap().law, Law::Plastic { damage: Some(_), .. }));
        let m = parse(&si(), &format!("{full} elastic neohooke")).unwrap();
        assert_eq!(m.constitutive().unwrap().law, Law::NeoHooke);
        let m = parse(&si(), "material m file ofhc-copper.toml yield 120e6").unwrap();
        assert_eq!((m.sheet.get(Key::Yield), m.sheet.get(Key::B)), (Some(120e6), Some(292e6)));
    }

    #[test]
    fn mistakes_of_flow_name_the_key_the_law_and_an_example() {
        let wrong = |line: &str| {
            let d = parse(&si(), line).unwrap_err().0.remove(0);
            let s = d.span.unwrap();
            (line[s.start as usize..s.end as usize].to_owned(), d.code, d.message, d.help.join(" "))
        };
        let full = "material m E 117e9 nu 0.35 rho 8930";
        let line = format!("{full} yield 400e6 hardening linear");
        let (place, code, message, help) = wrong(&line);
        assert_eq!((place, code), (line.clone(), Code::MISSING_ARGUMENT));
        assert_eq!(message, "material `m` has no H, which hardening linear needs");
        assert!(help.contains("`H = \"100 MPa\"`"), "{help}");
        let line = "material m file steel.toml yield 400e6 hardening voce";
        let (place, _, message, help) = wrong(line);
        assert_eq!(place, "steel.toml");
        assert_eq!(message, "material `m` (steel.toml) has no sigma_inf, which hardening voce needs");
        assert!(help.contains("in steel.toml"), "{help}");
        let (place, code, message, _) = wrong(&format!("{full} yield 400e6 H 1e8"));
        assert_eq!((place.as_str(), code), ("1e8", Code::BAD_VALUE));
        assert!(message.contains("does not use `H`"), "{message}");
        assert_eq!(wrong(&format!("{full} yield 1 yield 2")).1, Code::CONFLICT);
        assert_eq!(wrong(&format!("{full} yield -1")).0, "-1");
        assert_eq!(wrong(&format!("{full} hardening vice")).0, "vice");
        assert_eq!(wrong(&format!("{full} yield 1 elastic linear")).0, "elastic");
    }

    #[test]
    fn a_wrong_file_is_reported_by_its_line() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("mine.toml"), "name = 'x'\nsource = 'y'\nG_c = 3\n").unwrap();
        let mut w = si();
        w.folder = folder.path().to_owned();
        let d = parse(&w, "material m file mine.toml").unwrap_err().0.remove(0);
        assert!(d.message.contains("mine.toml:3: "), "{}", d.message);
    }
}
