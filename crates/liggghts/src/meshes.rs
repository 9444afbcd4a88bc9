//! Surfaces of triangles and what moves them.

use crate::Translator;
use crate::native::Line;
use crate::reading::{choice, number, rounded, unknown, vector, without_counterpart};
use perigrain_base::diag::{Code, Diagnostic, Result, nearest};
use perigrain_lang::{Args, Command, Word};

/// A surface of the deck.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    /// Its atom type.
    pub kind: Word,
    /// It has a temperature.
    pub warm: bool,
}

const KEYWORDS: &[&str] = &[
    "file",
    "type",
    "scale",
    "move",
    "rotate",
    "temperature",
    "surface_vel",
    "surface_ang_vel",
    "reference_point",
    "wear",
    "com",
    "ctrlPV",
    "axis",
    "dim",
    "target_val",
    "vel_max",
    "kp",
    "ki",
    "kd",
    "mode",
    "ratio",
    "stress",
    "heal",
    "precision",
    "curvature",
    "curvature_tolerant",
    "min_feature_length",
    "element_exclusion_list",
    "verbose",
];

/// Keywords of the controller of a servo surface, each with its number of values.
const SERVO: &[(&str, usize)] = &[
    ("com", 3),
    ("ctrlPV", 1),
    ("axis", 3),
    ("target_val", 1),
    ("vel_max", 1),
    ("kp", 1),
    ("ki", 1),
    ("kd", 1),
    ("mode", 1),
    ("ratio", 1),
];

/// Keywords about how a file is read, each with its number of values.
const READING: &[(&str, usize)] = &[
    ("heal", 1),
    ("precision", 1),
    ("curvature", 1),
    ("curvature_tolerant", 1),
    ("min_feature_length", 1),
    ("element_exclusion_list", 2),
    ("verbose", 1),
    ("stress", 1),
];

/// Keywords that make a surface from something else than a file.
const MADE: &[&str] = &["generate", "extrude_planar", "region"];

impl Translator {
    /// `fix ID group mesh/surface… file F type T …`.
    pub(crate) fn surface(&mut self, cmd: &Command, args: &mut Args) -> Result<Option<Vec<Command>>> {
        let (mut file, mut kind, mut wear) = (None, None, None);
        let (mut first, mut then, mut servo) = (vec![], vec![], vec![]);
        while let Some(word) = args.next() {
            let put = |text: &str, list: &mut Vec<Word>| list.push(Word::new(text, word.span));
            match word.text.as_str() {
                "file" => file = Some(args.expect("a file name")?.clone()),
                "type" => {
                    let (word, note) = rounded(&number(args, "the atom type of the surface")?);
                    self.notes.0.extend(note);
                    kind = Some(word);
                }
                "scale" => {
                    put("scale", &mut first);
                    first.push(number(args, "the factor")?);
                }
                "move" => {
                    put("shift", &mut first);
                    first.extend(vector(args, "a component of the shift")?);
                }
                "rotate" => {
                    put("turn", &mut first);
                    choice(args, "word of `rotate`", &["axis"])?;
                    first.extend(vector(args, "a component of the axis")?);
                    choice(args, "word of `rotate`", &["angle"])?;
                    first.push(number(args, "the angle")?);
                }
                "surface_vel" => {
                    put("speed", &mut then);
                    then.extend(vector(args, "a component of the velocity")?);
                }
                "surface_ang_vel" => {
                    put("spin", &mut then);
                    choice(args, "word of `surface_ang_vel`", &["origin"])?;
                    then.extend(vector(args, "a component of the origin")?);
                    choice(args, "word of `surface_ang_vel`", &["axis"])?;
                    then.extend(vector(args, "a component of the axis")?);
                    choice(args, "word of `surface_ang_vel`", &["omega"])?;
                    then.push(number(args, "the angular velocity")?);
                }
                "temperature" => {
                    put("temperature", &mut then);
                    then.push(number(args, "the temperature")?);
                }
                "reference_point" => {
                    put("about", &mut then);
                    then.extend(vector(args, "a component of the point")?);
                }
                "wear" if choice(args, "model of wear", &["finnie", "off"])? == "finnie" => {
                    wear = Some(word.clone());
                }
                "wear" => {}
                "dim" => {
                    put("axis", &mut servo);
                    let axis = choice(args, "direction", &["x", "y", "z"])?;
                    for along in ["x", "y", "z"] {
                        put(if axis == along { "1" } else { "0" }, &mut servo);
                    }
                }
                other => {
                    if let Some((_, count)) = SERVO.iter().find(|(name, _)| *name == other) {
                        servo.push(word.clone());
                        for _ in 0..*count {
                            servo.push(args.expect("a value")?.clone());
                        }
                    } else if let Some((_, count)) = READING.iter().find(|(name, _)| *name == other) {
                        for _ in 0..*count {
                            args.expect("a value")?;
                        }
                        self.idle(word, "triangles are read as they are in the file");
                    } else if MADE.contains(&other) {
                        let help = "write the surface into an STL file, and name it with `file`";
                        return Err(without_counterpart(word, "a surface that is made", help).into());
                    } else {
                        return Err(unknown(word, "keyword of mesh/surface", KEYWORDS).into());
                    }
                }
            }
        }
        let lacks = |what: &str| {
            let text = format!("`{}` lacks `{what}`", cmd.args[2].text);
            Err(Diagnostic::error(Code::MISSING_ARGUMENT, cmd.args[2].span, text).into())
        };
        let Some(file) = file else { return lacks("file FILE") };
        let Some(kind) = kind else { return lacks("type T") };
        let mut line = Line::styled(cmd, "surface");
        line.word(&file).put("type", kind.span).word(&kind).words(&first).words(&then);
        if cmd.args[2].text == "mesh/surface/planar" {
            line.put("planar", cmd.args[2].span);
        }
        if let Some(word) = &wear {
            line.put("wear finnie", word.span).words(&self.wear(word, &kind)?);
        }
        if !servo.is_empty() {
            line.put("servo", servo[0].span).words(&servo);
        }
        let warm = then.iter().any(|word| word.text == "temperature");
        self.surfaces.insert(cmd.args[0].text.clone(), Surface { kind, warm });
        Ok(Some(vec![line.done()]))
    }

    /// Finnie's coefficient of grains of each type on the surface; one number where all have the same.
    fn wear(&mut self, reader: &Word, kind: &Word) -> Result<Vec<Word>> {
        let on = kind.text.parse::<usize>().unwrap_or(1).max(1) - 1;
        let each = (0..self.types().max(1)).map(|i| self.of("k_finnie", reader, i, on));
        let mut each: Vec<Word> = each.collect::<Result<_>>()?;
        if each.iter().all(|word| word.text == each[0].text) {
            each.truncate(1);
        }
        Ok(each)
    }

    /// The surface with this name.
    pub(crate) fn surface_of(&self, word: &Word) -> Result<&Surface> {
        self.surfaces.get(&word.text).ok_or_else(|| {
            let d = Diagnostic::error(
                Code::UNKNOWN_FIX,
                word.span,
                format!("there is no fix mesh/surface `{}`", word.text),
            );
            let near = nearest(&word.text, self.surfaces.keys().map(String::as_str));
            near.into_iter().fold(d, |d, near| d.help(format!("did you mean `{near}`?"))).into()
        })
    }

    /// `fix ID group move/mesh mesh MESH …`: the native words are the same.
    pub(crate) fn mover(&mut self, _: &Command, args: &mut Args) -> Result<Option<Vec<Command>>> {
        self.named_mesh(args)
    }

    /// `fix ID group massflow/mesh mesh MESH …`: the native words are the same, but for the screen, and `writeTime` without a file.
    pub(crate) fn mass_flow(&mut self, cmd: &Command, args: &mut Args) -> Result<Option<Vec<Command>>> {
        let lines = self.named_mesh(args)?;
        args.rest();
        let has = |name: &str| cmd.args.iter().any(|word| word.text == name);
        let idle_time = has("writeTime") && !has("file") && !has("append");
        if !has("screen") && !idle_time {
            return Ok(lines);
        }
        let mut line = Line::new(cmd, &cmd.name.text);
        let mut words = cmd.args.iter();
        while let Some(word) = words.next() {
            match word.text.as_str() {
                // LIGGGHTS prints nothing about grains that pass either (measured).
                "screen" => {
                    words.next();
                    self.idle(word, "grains that pass are no lines of the log");
                }
                "writeTime" if idle_time => self.idle(word, "there is no file of the grains that pass"),
                _ => drop(line.word(word)),
            }
        }
        Ok(Some(vec![line.done()]))
    }

    /// Looks at the mesh that a line names.
    fn named_mesh(&self, args: &mut Args) -> Result<Option<Vec<Command>>> {
        choice(args, "word", &["mesh"])?;
        let word = args.expect("the ID of a fix mesh/surface")?;
        if !word.unknown {
            self.surface_of(word)?;
        }
        Ok(None)
    }
}
