//! Grains of several spheres: templates, the fix that moves them, what computes and dumps read of them.

use crate::Translator;
use crate::mixtures::Template;
use crate::native::{Line, instead};
use crate::reading::{choice, number, rounded, unknown, value, without_counterpart};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Command, Word};

/// What of `fix multisphere` there is.
#[derive(Clone, Debug, Default)]
pub(crate) struct Movers {
    /// The line, until a template stands.
    waits: Option<Command>,
    /// The ID of the fix.
    id: Option<Word>,
    /// It has been written.
    written: bool,
    /// Particles have molecule IDs.
    molecules: bool,
    /// A template that was refused: what it would have been is not missed again.
    refused: Option<String>,
}

const KEYWORDS: &[&str] = &[
    "atom_type",
    "density",
    "volume_limit",
    "nspheres",
    "ntry",
    "spheres",
    "scale",
    "type",
    "mass",
    "inertia_tensor",
    "use_volume",
    "use_density",
    "fflag",
    "tflag",
];

/// Properties of bodies with the native attributes.
const PROPERTIES: &[(&str, &str)] = &[
    ("xcm", "x y z"),
    ("vcm", "vx vy vz"),
    ("fcm", "fx fy fz"),
    ("torque", "tqx tqy tqz"),
    ("quat", "quatw quati quatj quatk"),
    ("angmom", "angmomx angmomy angmomz"),
    ("omega", "omegax omegay omegaz"),
    ("masstotal", "mass"),
    ("inertia", "inertiax inertiay inertiaz"),
    ("id_multisphere", "mol"),
];

/// What a line of a template has set.
#[derive(Default)]
struct Parts {
    count: Option<Word>,
    source: Vec<Word>,
    scale: Option<Word>,
    mass: Option<Word>,
    /// Ixx Ixy Ixz Iyy Iyz Izz.
    inertia: Vec<Word>,
    by_volume: bool,
    kind: Option<Word>,
    density: Option<Word>,
}

impl Translator {
    /// `fix ID group particletemplate/multisphere SEED … nspheres n ntry N spheres … type T`: a native clump.
    pub(crate) fn clump(&mut self, cmd: &Command, args: &mut Args) -> Result<Vec<Command>> {
        let lines = self.template_of_spheres(cmd, args);
        if lines.is_err() {
            self.movers.refused = Some(cmd.args[0].text.clone());
        }
        lines
    }

    fn template_of_spheres(&mut self, cmd: &Command, args: &mut Args) -> Result<Vec<Command>> {
        if self.movers.written {
            let text = "a template below the fix multisphere that moves its grains";
            let d = Diagnostic::error(Code::WRONG_ORDER, cmd.args[2].span, text);
            return Err(d.help("put `fix multisphere` below all templates").into());
        }
        number(args, "the seed")?;
        let mut parts = Parts::default();
        while let Some(word) = args.next() {
            self.clump_keyword(word, args, &mut parts)?;
        }
        let at = cmd.args[2].span;
        let lacks = |what: &str| {
            let text = format!("`{}` lacks `{what}`", cmd.args[2].text);
            Err(Diagnostic::error(Code::MISSING_ARGUMENT, at, text).into())
        };
        let Some(count) = &parts.count else { return lacks("nspheres N") };
        if parts.source.is_empty() {
            return lacks("spheres file FILE");
        }
        if parts.mass.is_some() == parts.inertia.is_empty() {
            return lacks(if parts.mass.is_some() { "inertia_tensor" } else { "mass" });
        }
        let one = |text: &str| Word::new(text, at);
        let kind = parts.kind.unwrap_or_else(|| one("1"));
        let density = parts.density.unwrap_or_else(|| one("1"));
        let mut lines = self.molecule_ids(cmd);
        let mut line = Line::new(cmd, "clump");
        line.word(&cmd.args[0]).word(&kind).words(&parts.source);
        if let Some(scale) = &parts.scale {
            line.put("scale", scale.span).word(scale);
        }
        if parts.source[0].text == "file" {
            line.put("count", count.span).word(count);
        }
        if let (Some(mass), [xx, xy, xz, yy, yz, zz]) = (&parts.mass, parts.inertia.as_slice()) {
            // The places are those about the middle of the mass then (measured).
            line.put("mass", mass.span).word(mass).put("com 0 0 0 inertia", xx.span);
            [xx, yy, zz, xy, xz, yz].into_iter().for_each(|word| {
                line.word(word);
            });
        }
        lines.push(line.done());
        let given = if parts.by_volume { instead(&density, "NULL") } else { density };
        self.in_all(cmd);
        let id = cmd.args[0].text.clone();
        self.own.insert(id.clone());
        self.templates.insert(id, Template { kind, radius: one("0"), density: given, clump: true });
        Ok(lines)
    }

    /// One keyword of a template with its values.
    fn clump_keyword(&mut self, word: &Word, args: &mut Args, parts: &mut Parts) -> Result<()> {
        match word.text.as_str() {
            "atom_type" => parts.kind = Some(self.whole(args, "the atom type")?),
            "density" => parts.density = Some(crate::mixtures::constant(args, "the density")?),
            "volume_limit" => {
                number(args, "the smallest volume")?;
                self.idle(word, "grains of any volume are made");
            }
            "nspheres" => parts.count = Some(self.whole(args, "the number of spheres")?),
            "ntry" => {
                number(args, "the number of random points")?;
                self.idle(word, "volume and inertia are computed without random points");
            }
            "spheres" if args.eat("file") => {
                parts.source = vec![instead(word, "file"), args.expect("a file name")?.clone()];
            }
            "spheres" => {
                let count = parts.count.as_ref().and_then(value).map_or(0, |n| 4 * n as usize);
                if count == 0 {
                    let text = "`spheres` needs the number of spheres before it";
                    let d = Diagnostic::error(Code::WRONG_ORDER, word.span, text);
                    return Err(d.help("write `nspheres N` before `spheres`").into());
                }
                parts.source = vec![word.clone()];
                for _ in 0..count {
                    parts.source.push(number(args, "x, y, z or r of a sphere")?);
                }
            }
            "scale" => parts.scale = Some(number(args, "the factor")?),
            "type" => {
                number(args, "the number of the kind")?;
                self.idle(word, "kinds of grains have names");
            }
            "mass" => parts.mass = Some(number(args, "the mass")?),
            "inertia_tensor" => {
                parts.inertia = (0..6).map(|_| number(args, "a moment of inertia")).collect::<Result<_>>()?;
            }
            "use_volume" => parts.by_volume = true,
            "use_density" => {}
            "fflag" | "tflag" => switches(word, args)?,
            _ => return Err(unknown(word, "keyword of particletemplate/multisphere", KEYWORDS).into()),
        }
        Ok(())
    }

    /// A whole number.
    fn whole(&mut self, args: &mut Args, what: &str) -> Result<Word> {
        let (word, note) = rounded(&number(args, what)?);
        self.notes.0.extend(note);
        Ok(word)
    }

    /// The line that gives particles molecule IDs, once.
    fn molecule_ids(&mut self, cmd: &Command) -> Vec<Command> {
        if std::mem::replace(&mut self.movers.molecules, true) {
            return vec![];
        }
        let mut line = Line::new(cmd, "fix");
        let id = format!("{}_mol", cmd.args[0].text);
        line.put(&id, cmd.args[0].span).put("all property/atom mol", cmd.args[2].span);
        vec![line.done()]
    }

    /// `fix ID group multisphere`: the native fix of all templates above, or before the run if none is there yet.
    pub(crate) fn multisphere(&mut self, cmd: &Command, args: &mut Args) -> Result<Vec<Command>> {
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "allow_group_and_set" | "allow_heatsource" => {
                    choice(args, "state", &["yes", "no"])?;
                    self.idle(word, "groups, `set` and sources of heat are always allowed");
                }
                "CAddRhoFluid" => {
                    return Err(
                        without_counterpart(word, "the mass of a fluid", "grains alone move here").into()
                    );
                }
                _ => {
                    let known = ["allow_group_and_set", "allow_heatsource", "CAddRhoFluid"];
                    return Err(unknown(word, "keyword of fix multisphere", &known).into());
                }
            }
        }
        self.movers.id = Some(cmd.args[0].clone());
        self.movers.waits = Some(cmd.clone());
        if self.has_clumps() || self.movers.refused.is_some() { self.bodies() } else { Ok(vec![]) }
    }

    /// The native fix that moves grains of several spheres, if it is still to be written.
    pub(crate) fn bodies(&mut self) -> Result<Vec<Command>> {
        let Some(cmd) = self.movers.waits.take() else { return Ok(vec![]) };
        let at = cmd.args[2].span;
        let mut line = Line::styled(&cmd, "rigid/small");
        line.put("molecule", at);
        let names: Vec<&String> = self.templates.iter().filter(|(_, t)| t.clump).map(|(id, _)| id).collect();
        if let (true, Some(id)) = (names.is_empty(), &self.movers.refused) {
            let text = format!("there is no particletemplate `{id}`");
            return Err(Diagnostic::error(Code::UNKNOWN_FIX, at, text).into());
        }
        if names.is_empty() {
            let text = "fix multisphere moves grains of `particletemplate/multisphere`, and there is none";
            return Err(Diagnostic::error(Code::INCOMPLETE, at, text).into());
        }
        for name in names {
            line.put(&format!("mol {name}"), at);
        }
        let mut own = Line::new(&cmd, "neigh_modify");
        own.put("exclude molecule/intra all", at);
        self.movers.written = true;
        Ok(vec![line.done(), own.done()])
    }

    /// Whether the deck has grains of several spheres.
    pub(crate) fn has_clumps(&self) -> bool {
        self.templates.values().any(|template| template.clump)
    }

    /// `fix_modify` of the fix multisphere: switches of its bodies.
    pub(crate) fn switched(&self, cmd: &Command) -> Result<()> {
        let own = |id: &Word| self.movers.id.as_ref().is_some_and(|own| own.text == id.text);
        if !cmd.args.first().is_some_and(own) {
            return Ok(());
        }
        match cmd.args.iter().position(|word| ["fflag", "tflag"].contains(&word.text.as_str())) {
            Some(k) => {
                let mut args = Args::new(cmd);
                (0..=k).for_each(|_| {
                    args.next();
                });
                switches(&cmd.args[k], &mut args)
            }
            None => Ok(()),
        }
    }

    /// `compute ID group ke/multisphere|erotate/multisphere`: of the bodies of the fix.
    pub(crate) fn energy(&self, cmd: &Command, style: &str) -> Result<Vec<Command>> {
        let mut line = Line::styled(cmd, style);
        line.word(&self.body_fix(cmd)?);
        Ok(vec![line.done()])
    }

    /// `compute ID group rigid|multisphere property NAME`: attributes of each body.
    pub(crate) fn body_property(&self, cmd: &Command, args: &mut Args) -> Result<Vec<Command>> {
        choice(args, "word", &["property"])?;
        let word = args.expect("a property of bodies")?;
        let Some((_, names)) = PROPERTIES.iter().find(|(name, _)| *name == word.text) else {
            let known: Vec<&str> = PROPERTIES.iter().map(|(name, _)| *name).collect();
            return Err(unknown(word, "property of bodies", &known).into());
        };
        let mut line = Line::styled(cmd, "rigid/local");
        line.word(&self.body_fix(cmd)?).put(names, word.span);
        Ok(vec![line.done()])
    }

    /// The ID of the fix multisphere.
    fn mover_id(&self) -> Option<Word> {
        self.movers.id.clone().filter(|_| self.movers.written)
    }

    fn body_fix(&self, cmd: &Command) -> Result<Word> {
        let at = cmd.args[2].span;
        if let (Some(id), Some(_)) = (&self.movers.id, &self.movers.refused) {
            let text = format!("there is no fix `{}`", id.text);
            return Err(Diagnostic::error(Code::UNKNOWN_FIX, at, text).into());
        }
        self.mover_id().map(|id| Word::new(&id.text, at)).ok_or_else(|| {
            let text = format!(
                "`{}` reads the bodies of a fix multisphere, and none stands above",
                cmd.args[2].text
            );
            let d = Diagnostic::error(Code::WRONG_ORDER, at, text);
            d.help("put templates and `fix multisphere` above this line").into()
        })
    }
}

/// `on on on`: motions that are switched off cannot be had.
fn switches(word: &Word, args: &mut Args) -> Result<()> {
    for _ in 0..3 {
        if choice(args, "switch", &["on", "off"])? == "off" {
            let help = "`fix rigid … force|torque` switches components of single bodies";
            return Err(without_counterpart(word, "a motion that is switched off", help).into());
        }
    }
    Ok(())
}

/// `dump … custom` with `id_multisphere`, the molecule ID.
pub(crate) fn dump(cmd: &Command) -> Option<Vec<Command>> {
    cmd.args.iter().any(|word| word.text == "id_multisphere").then(|| {
        let mut line = Line::new(cmd, &cmd.name.text);
        let words: Vec<Word> = cmd.args.iter().map(named).collect();
        line.words(&words);
        vec![line.done()]
    })
}

/// The native name of an attribute of particles.
pub(crate) fn named(word: &Word) -> Word {
    if word.text == "id_multisphere" { instead(word, "mol") } else { word.clone() }
}
