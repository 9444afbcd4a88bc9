//! `fix wall/gran` with a model, on planes, cylinders and surfaces.

use crate::Translator;
use crate::model::{Cohesion, Given, Model, PARTS, Rolling, Tangential, parts, switch, switches};
use crate::native::{Line, instead};
use crate::reading::{choice, number, rounded, unknown};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Command, Word, blame};

const PRIMITIVES: &[&str] = &["xplane", "yplane", "zplane", "xcylinder", "ycylinder", "zcylinder"];
const KEYWORDS: &[&str] =
    &["primitive", "mesh", "shear", "temperature", "store_force", "store_force_contact"];

/// Where a wall is, or the part of it on surfaces of one type.
struct Place {
    /// The atom type of the wall.
    kind: Word,
    /// Native words.
    words: Vec<Word>,
    on_mesh: bool,
}

/// The ID of the part of a wall that leans on surfaces of another type than its first one.
fn part_of(id: &str, kind: &Word) -> String {
    format!("{id}_type{}", kind.text)
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
        let places = match head.text.as_str() {
            "primitive" => vec![self.primitive(args)?],
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
            more.extend(self.more(&word, args)?);
        }
        let (mut lines, mut parts) = (vec![], vec![]);
        for (k, place) in places.iter().enumerate() {
            let style = if place.on_mesh { "wall/mesh" } else { "wall/gran" };
            let mut line = Line::styled(cmd, style);
            if k > 0 {
                let id = part_of(&cmd.args[0].text, &place.kind);
                line.renamed(&id);
                parts.push(id);
            }
            self.law_of_wall(&mut line, &given, place)?;
            line.words(&place.words).words(&more);
            lines.push(line.done());
        }
        // The same ID again takes the place of all parts.
        let id = &cmd.args[0];
        let before = self.parts.insert(id.text.clone(), parts.clone()).unwrap_or_default();
        for part in before.iter().filter(|part| !parts.contains(part)) {
            let mut line = Line::new(cmd, "unfix");
            line.word(&instead(id, part.as_str()));
            lines.push(line.done());
        }
        Ok(Some(lines))
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
        Ok(Place { kind, words, on_mesh: false })
    }

    /// `mesh n_meshes N meshes ID …`: one part for each type of surfaces.
    fn on_meshes(&mut self, args: &mut Args) -> Result<Vec<Place>> {
        choice(args, "word of a wall on meshes", &["n_meshes"])?;
        let count = args.integer_from(1, "the number of meshes")?;
        let head = args.peek().map_or(args.here(), |w| w.span);
        choice(args, "word of a wall on meshes", &["meshes"])?;
        let mut places: Vec<Place> = vec![];
        for _ in 0..count {
            let word = args.expect("the ID of a fix mesh/surface")?.clone();
            let kind = self.surface_of(&word)?.kind.clone();
            match places.iter_mut().find(|place| place.kind.text == kind.text) {
                Some(place) => place.words.push(word),
                None => places.push(Place { kind, words: vec![Word::new("of", head), word], on_mesh: true }),
            }
        }
        Ok(places)
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
        let narrower = of_pair.as_ref().is_none_or(|pair| fits(&given.model, pair));
        if !narrower {
            return self.own_law(line, given, place);
        }
        line.put("coeff", at).word(&place.kind);
        if of_pair.as_ref() != Some(&given.model) {
            line.put("only normal damping", at);
            let model = &given.model;
            for (has, name, at) in [
                (model.tangential != Tangential::Off, "tangential", given.tangential),
                (model.rolling != Rolling::Off, "rolling", given.rolling),
                (model.cohesion != Cohesion::Off, "cohesion", given.cohesion),
            ] {
                line.put(if has { name } else { "" }, at);
            }
        }
        Ok(())
    }

    /// A wall with a law of its own, in a deck of one atom type.
    fn own_law(&mut self, line: &mut Line, given: &Given, place: &Place) -> Result<()> {
        let alone = self.types() == 1 && place.kind.text == "1";
        let round = place.words[0].text.ends_with("cylinder");
        if !alone || round {
            let reader = &given.reader;
            let text = "the model of this wall has what the model of `pair_style` does not have";
            let d = blame(reader, Code::NO_COUNTERPART, text);
            return Err(d
                .help("a wall may leave parts of that model out: write the larger one there")
                .into());
        }
        line.put("granular", given.normal);
        self.law(line, given, 0, 0)
    }
}

/// Whether a wall's model is that of the grains, or leaves parts of it out.
fn fits(wall: &Model, pair: &Model) -> bool {
    let tangential = wall.tangential == Tangential::Off
        || (wall.tangential == pair.tangential
            && wall.undamped == pair.undamped
            && wall.softer == pair.softer);
    let rolling =
        wall.rolling == Rolling::Off || (wall.rolling == pair.rolling && wall.torsion == pair.torsion);
    let cohesion =
        wall.cohesion == Cohesion::Off || (wall.cohesion == pair.cohesion && wall.reduce == pair.reduce);
    let normal = wall.normal == pair.normal && wall.limit == pair.limit && wall.absolute == pair.absolute;
    normal && tangential && rolling && cohesion
}

#[cfg(test)]
mod tests {
    use crate::tests::behind;

    #[test]
    fn surfaces_of_several_types_are_parts_of_one_wall() {
        let surfaces = "pair_style gran model hertz\nfix a all mesh/surface file a.stl type 1\nfix b all mesh/surface file b.stl type 2\n\
                        fix c all mesh/surface file c.stl type 1\n";
        let wall = "fix w all wall/gran model hertz mesh n_meshes 3 meshes a b c";
        let found = behind(&format!("{surfaces}{wall}\nunfix w\n"));
        let parts = ["fix w all wall/mesh coeff 1 of a c", "fix w_type2 all wall/mesh coeff 2 of b"];
        assert_eq!(found[4..6], parts);
        assert_eq!(found[6..], ["unfix w", "unfix w_type2"]);
        let again = wall.replace("3 meshes a b c", "2 meshes a c");
        let found = behind(&format!("{surfaces}{wall}\n{again}\nunfix w\n"));
        assert_eq!(found[6..], [parts[0], "unfix w_type2", "unfix w"]);
    }
}
