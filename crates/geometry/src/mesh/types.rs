//! Which type each cell of a mesh gives its particle: by physical group, element set, or a number of the cell.

use super::{Mesh, Set};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_lang::Word;
use perigrain_lang::args::parse_number;
use perigrain_styles::words::{At, Nullable, OneType, Words};

/// What decides.
#[derive(Clone, Debug)]
enum By {
    /// Physical groups of Gmsh, by name or number.
    Physical,
    /// Element sets of Abaqus, by name.
    Set,
    /// An array of cells.
    Cell(Word),
}

/// The words for it.
#[derive(Words)]
#[word(what = "source of types")]
pub enum Source {
    /// Gmsh's physical groups: their names or numbers, each with a type, or without any the number itself; NULL leaves a group out.
    Physical(#[word(name = "NAME T", what = "the type")] Vec<(Word, Nullable<OneType>)>),
    /// Abaqus' element sets by their names.
    Set(#[word(name = "NAME T", what = "the type")] Vec<(Word, Nullable<OneType>)>),
    /// An array of the cells, whose values are types or stand before them.
    Cell(
        #[word(name = "ARRAY", what = "the name of an array of cells")] Word,
        #[word(name = "VALUE T", what = "the type")] Vec<(Word, Nullable<OneType>)>,
    ),
}

/// Which types cells give.
#[derive(Clone, Debug)]
pub struct Types {
    by: By,
    at: Span,
    /// Name or number of a group, and its type; `None` leaves its cells out.
    map: Vec<(Word, Option<u16>)>,
}

impl Types {
    /// What the words ask for.
    ///
    /// # Errors
    /// Values that are no numbers, sets without names.
    pub fn new(given: At<Source>) -> Result<Self> {
        let (by, map) = match given.value {
            Source::Physical(map) => (By::Physical, map),
            Source::Set(map) => (By::Set, map),
            Source::Cell(array, map) => (By::Cell(array), map),
        };
        if matches!(by, By::Cell(_)) {
            map.iter().try_for_each(|(value, _)| parse_number(value, "a value of the array").map(drop))?;
        }
        if matches!(by, By::Set) && map.is_empty() {
            return fail(
                Code::MISSING_ARGUMENT,
                given.span,
                "`types set` needs names of element sets and their types",
            );
        }
        let map = map.into_iter().map(|(name, to)| (name, to.0.map(|kind| kind.0))).collect();
        Ok(Self { by, at: given.span, map })
    }

    /// The type of each cell; 0 for those that are left out.
    ///
    /// # Errors
    /// Groups that the file has not, cells in two groups of different types, cells in none.
    pub fn of(&self, mesh: &Mesh, used: &[bool], default: Option<u16>, types: usize) -> Result<Vec<u16>> {
        let mut kinds: Vec<Option<u16>> = vec![None; mesh.count()];
        match &self.by {
            By::Cell(word) => self.by_array(mesh, used, word, types, &mut kinds)?,
            _ if self.map.is_empty() => self.by_number(mesh, used, types, &mut kinds)?,
            _ => self.by_name(mesh, used, &mut kinds)?,
        }
        let without = || (0..mesh.count()).filter(|&k| used[k] && kinds[k].is_none());
        let (count, first) = (without().count(), without().next());
        match (first, default) {
            (None, _) | (_, Some(_)) => {}
            (Some(k), None) => {
                let number = mesh.numbers[k];
                let text = format!("nothing here gives cell {number} a type, nor {} others", count - 1);
                let d = Diagnostic::error(Code::INCOMPLETE, self.at, text);
                return Err(d
                    .help("`type T` is for all that are in no group; a group with NULL is left out")
                    .into());
            }
        }
        Ok(kinds.into_iter().map(|k| k.or(default).unwrap_or(0)).collect())
    }

    fn by_name(&self, mesh: &Mesh, used: &[bool], kinds: &mut [Option<u16>]) -> Result<()> {
        for (word, to) in &self.map {
            let fits = |name: &str, number: Option<i64>| match self.by {
                By::Set => name.eq_ignore_ascii_case(&word.text),
                _ => name == word.text || number.is_some_and(|n| n.to_string() == word.text),
            };
            let mut found = false;
            for set in mesh.sets.iter().filter(|s| fits(&s.name, s.number)) {
                for cell in used_of(set, used) {
                    found = true;
                    self.give(mesh, kinds, cell, to.unwrap_or(0))?;
                }
            }
            if !found && !word.unknown {
                let known: Vec<String> =
                    mesh.sets.iter().filter(|s| used_of(s, used).next().is_some()).map(called).collect();
                let d = Diagnostic::error(
                    Code::UNKNOWN_NAME,
                    word.span,
                    format!("the file has no `{}` with cells", word.text),
                );
                return Err(match known.is_empty() {
                    true => d.help("it names no cells at all; `type T` gives all of them one type"),
                    false => d.help(format!("it has: {}", known.join(", "))),
                }
                .into());
            }
        }
        Ok(())
    }

    /// The number of a physical group is the type.
    fn by_number(&self, mesh: &Mesh, used: &[bool], types: usize, kinds: &mut [Option<u16>]) -> Result<()> {
        for set in mesh.sets.iter().filter(|s| used_of(s, used).next().is_some()) {
            let number = set.number.unwrap_or(0);
            let to = match u16::try_from(number) {
                Ok(t) if t >= 1 && usize::from(t) <= types => t,
                _ => {
                    let text = format!(
                        "physical group {} would be type {number}; there are types 1 to {types}",
                        called(set)
                    );
                    let d = Diagnostic::error(Code::BAD_VALUE, self.at, text);
                    return Err(d.help(format!("name the type: `types physical {} 1`", called(set))).into());
                }
            };
            for cell in used_of(set, used) {
                self.give(mesh, kinds, cell, to)?;
            }
        }
        Ok(())
    }

    fn by_array(
        &self,
        mesh: &Mesh,
        used: &[bool],
        word: &Word,
        types: usize,
        kinds: &mut [Option<u16>],
    ) -> Result<()> {
        let Some((name, values)) = mesh.arrays.iter().find(|(n, _)| *n == word.text) else {
            let known: Vec<&str> = mesh.arrays.iter().map(|(n, _)| n.as_str()).collect();
            let d = Diagnostic::error(
                Code::UNKNOWN_NAME,
                word.span,
                format!("the cells of the file have no array `{}`", word.text),
            );
            return Err(match known.is_empty() {
                true => d.help("they have no arrays of single numbers"),
                false => d.help(format!("they have: {}", known.join(", "))),
            }
            .into());
        };
        let map: Vec<(f64, u16)> =
            self.map.iter().map(|(w, to)| (w.text.parse().unwrap_or(f64::NAN), to.unwrap_or(0))).collect();
        for (k, &value) in values.iter().enumerate().filter(|(k, _)| used[*k]) {
            if !map.is_empty() {
                kinds[k] = map.iter().find(|(v, _)| *v == value).map(|(_, to)| *to);
                continue;
            }
            if value.fract() != 0.0 || !(value >= 1.0 && value <= types as f64) {
                let number = mesh.numbers[k];
                let text =
                    format!("cell {number} has {name} = {}; there are types 1 to {types}", general(value, 6));
                let d = Diagnostic::error(Code::BAD_VALUE, word.span, text);
                return Err(d
                    .help(format!("name the types: `types cell {name} {} 1`", general(value, 6)))
                    .into());
            }
            kinds[k] = Some(value as u16);
        }
        Ok(())
    }

    fn give(&self, mesh: &Mesh, kinds: &mut [Option<u16>], cell: usize, to: u16) -> Result<()> {
        match kinds.get_mut(cell) {
            Some(kind) if kind.is_none_or(|k| k == to) => *kind = Some(to),
            _ => {
                let text =
                    format!("cell {} is in two groups that have different types here", mesh.numbers[cell]);
                return fail(Code::CONFLICT, self.at, text);
            }
        }
        Ok(())
    }
}

/// The cells of a group that become particles.
fn used_of(set: &Set, used: &[bool]) -> impl Iterator<Item = usize> {
    set.cells.iter().map(|c| *c as usize).filter(|c| used.get(*c).copied().unwrap_or(false))
}

/// What messages call a group.
fn called(set: &Set) -> String {
    match (set.name.is_empty(), set.number) {
        (true, Some(number)) => number.to_string(),
        _ => set.name.clone(),
    }
}
