//! `fix wall/gran` with a model, on planes, cylinders and surfaces.

use crate::Translator;
use crate::model::{Cohesion, Given, Model, PARTS, Rolling, Tangential, parts, switch, switches};
use crate::native::Line;
use crate::reading::{choice, number, rounded, unknown};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Command, Word, blame};

/// The places of walls without a file.
pub(crate) const PRIMITIVES: &[&str] = &["xplane", "yplane", "zplane", "xcylinder", "ycylinder", "zcylinder"];
const KEYWORDS: &[&str] =
    &["primitive", "mesh", "shear", "temperature", "store_force", "store_force_contact"];

/// Where a wall is, or the part of it on surfaces of one type.
struct Place {
    /// The atom type of the wall.
    kind: Word,
    /// Native words.
    words: Vec<Word>,
    on_mesh: bool,
    /// It has a temperature.
    warm: bool,
}

/// Whether a `fix wall/gran` line has LIGGGHTS' words.
pub(crate) fn is_dialect(cmd: &Command) -> bool {
    cmd.args
        .get(3)
        .is_some_and(|w| PARTS.contains(&w.text.as_str()) || w.text == "primitive" || w.text == "mesh")
}

impl Translator {
    /// `fix ID group wall/gran model …`, or an old wall.
    pub(crate) fn wall(&mut self, cmd: &Command, args: &mut Args) -> Result<Option<Vec<Command>>> {
        if !is_dialect(cmd) {
            return Ok(self.old_wall(cmd));
        }
        let mut given = parts(args, &cmd.args[2])?;
        let head = args.expect("`primitive` or `mesh`")?.clone();
        let mut place = match head.text.as_str() {
            "primitive" => self.primitive(args)?,
            "mesh" => self.on_meshes(args)?,
            _ => return Err(unknown(&head, "word of a wall", KEYWORDS).into()),
        };
        let mut more: Vec<Word> = vec![];
        while let Some(word) = args.peek().cloned() {
            if let Some(note) = switch(args, &mut given.model)? {
                self.notes.0.extend(note);
                continue;
            }
            args.next();
            place.warm |= word.text == "temperature";
            more.extend(self.more(&word, args)?);
        }
        if place.on_mesh {
            self.mesh_wall = Some(cmd.args[0].clone());
        }
        let style = if place.on_mesh { "wall/mesh" } else { "wall/gran" };
        let mut line = Line::styled(cmd, style);
        self.law_of_wall(&mut line, &given, &place)?;
        line.words(&place.words).words(&more);
        Ok(Some(vec![line.done()]))
    }

    /// `primitive type T zplane Z`.
    fn primitive(&mut self, args: &mut Args) -> Result<Place> {
        choice(args, "word of a primitive wall", &["type"])?;
        let (kind, note) = rounded(&number(args, "the atom type of the wall")?);
        self.notes.0.extend(note);
        let word = args.expect("the kind of wall")?.clone();
        let Some(name) = PRIMITIVES.iter().find(|name| **name == word.text) else {
            return Err(unknown(&word, "primitive wall", PRIMITIVES).into());
        };
        let mut words = vec![word.clone(), number(args, "where the wall is")?];
        match name.ends_with("plane") {
            true => words.push(Word::new("NULL", word.span)),
            false => words.extend([
                number(args, "the centre of the cylinder")?,
                number(args, "the centre of the cylinder")?,
            ]),
        }
        Ok(Place { kind, words, on_mesh: false, warm: false })
    }

    /// `mesh n_meshes N meshes ID …`.
    fn on_meshes(&mut self, args: &mut Args) -> Result<Place> {
        choice(args, "word of a wall on meshes", &["n_meshes"])?;
        let count = args.integer_from(1, "the number of meshes")?;
        let head = args.peek().map_or(args.here(), |w| w.span);
        choice(args, "word of a wall on meshes", &["meshes"])?;
        let mut words = vec![Word::new("of", head)];
        let mut kinds: Vec<Word> = vec![];
        let mut warm = false;
        for _ in 0..count {
            let word = args.expect("the ID of a fix mesh/surface")?.clone();
            let surface = self.surface_of(&word)?;
            warm |= surface.warm;
            kinds.push(surface.kind.clone());
            words.push(word);
        }
        let mut kind = kinds.swap_remove(0);
        if kinds.iter().any(|other| other.text != kind.text) {
            // Each surface has its own.
            kind = Word::new("NULL", head);
        }
        Ok(Place { kind, words, on_mesh: true, warm })
    }

    /// What may follow the place of a wall.
    fn more(&mut self, word: &Word, args: &mut Args) -> Result<Vec<Word>> {
        let mut out = vec![];
        match word.text.as_str() {
            "shear" => {
                out.push(word.clone());
                let at = args.expect("the direction of the shear")?.clone();
                if !["x", "y", "z"].contains(&at.text.as_str()) {
                    return Err(unknown(&at, "direction", &["x", "y", "z"]).into());
                }
                out.push(at);
                out.push(number(args, "the speed of the wall")?);
            }
            "temperature" => {
                out.push(word.clone());
                out.push(number(args, "the temperature")?);
            }
            "store_force" | "store_force_contact" => {
                if choice(args, "state", &["yes", "no"])? == "yes" {
                    out.push(Word::new("contacts", word.span));
                    let text =
                        format!("`{}` is read as `contacts`: the fix has 8 columns per grain", word.text);
                    self.notes.push(Diagnostic::note(Code::DIALECT, word.span, text));
                }
            }
            _ if PARTS.contains(&word.text.as_str()) => {
                let text = format!("`{}` stands behind the place of the wall", word.text);
                let d = Diagnostic::error(Code::WRONG_ORDER, word.span, text);
                return Err(d.help("the model comes first, then the place, then switches").into());
            }
            _ => {
                let known: Vec<&str> = KEYWORDS.iter().chain(switches()).copied().collect();
                return Err(unknown(word, "word of a wall", &known).into());
            }
        }
        Ok(out)
    }

    /// The law of the grains with the wall's type; the parts of it that the wall has.
    fn law_of_wall(&mut self, line: &mut Line, given: &Given, place: &Place) -> Result<()> {
        let at = given.normal;
        let of_pair = self.pair.as_ref().map(|(_, pair)| pair.model.clone());
        if of_pair.is_none() {
            self.early.push(given.clone());
        }
        let narrower = of_pair.as_ref().is_none_or(|pair| fits(&given.model, pair));
        if !narrower {
            return self.own_law(line, given, place);
        }
        line.put("coeff", at).word(&place.kind);
        if of_pair.as_ref() != Some(&given.model) {
            line.put("only normal damping", at);
            let model = &given.model;
            line.put(if model.limit { "limit" } else { "" }, at);
            for (has, name, at) in [
                (model.tangential == Tangential::History, "tangential", given.tangential),
                (model.tangential == Tangential::NoHistory, "no_history", given.tangential),
                (model.rolling != Rolling::Off, "rolling", given.rolling),
                (model.cohesion != Cohesion::Off, "cohesion", given.cohesion),
                (place.warm, "heat", at),
            ] {
                line.put(if has { name } else { "" }, at);
            }
        }
        Ok(())
    }

    /// Walls above the `pair_style` line, whose models must be that of the grains or leave parts of it out.
    pub(crate) fn early_walls(&mut self, pair: &Model) -> Result<()> {
        let Some(wall) = std::mem::take(&mut self.early).into_iter().find(|w| !fits(&w.model, pair)) else {
            return Ok(());
        };
        let text = "the model of this wall has what the model of `pair_style`, below it, does not have";
        let d = blame(&wall.reader, Code::NO_COUNTERPART, text);
        Err(d.help("write `pair_style` and `pair_coeff` above the walls").into())
    }

    /// A wall with a law of its own, in a deck of one atom type.
    fn own_law(&mut self, line: &mut Line, given: &Given, place: &Place) -> Result<()> {
        let alone = self.types() == 1 && place.kind.text == "1";
        if !alone {
            let reader = &given.reader;
            let text = "the model of this wall has what the model of `pair_style` does not have";
            let d = blame(reader, Code::NO_COUNTERPART, text);
            return Err(d
                .help("a wall may leave parts of that model out: write the larger one there")
                .into());
        }
        if place.warm && self.heat.is_none() {
            let text = "a wall with a temperature and a model of its own stands above `fix heat/gran`";
            let d = Diagnostic::error(Code::WRONG_ORDER, given.reader.span, text);
            return Err(d.help("write `fix heat/gran` first").into());
        }
        line.put("granular", given.normal);
        self.law(line, given, (0, 0), place.warm)?;
        line.put("arms middle", given.normal);
        Ok(())
    }
}

/// Whether a wall's model is that of the grains, or leaves parts of it out.
fn fits(wall: &Model, pair: &Model) -> bool {
    let tangential = wall.tangential == Tangential::Off
        || ((wall.tangential == pair.tangential || pair.tangential == Tangential::History)
            && wall.undamped == pair.undamped
            && wall.softer == pair.softer);
    let rolling =
        wall.rolling == Rolling::Off || (wall.rolling == pair.rolling && wall.torsion == pair.torsion);
    let cohesion =
        wall.cohesion == Cohesion::Off || (wall.cohesion == pair.cohesion && wall.reduce == pair.reduce);
    let normal = wall.normal == pair.normal && wall.limit <= pair.limit && wall.absolute == pair.absolute;
    normal && tangential && rolling && cohesion
}
