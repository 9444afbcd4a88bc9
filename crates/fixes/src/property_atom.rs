//! fix property/atom: user-named per-particle properties.

use super::{AtRest, Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Word};
use perigrain_plan::Op;
use perigrain_styles::words::{At, Grammar, Kind, Part, Placeholder, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::columns::{HEATFLOW, TEMPERATURE};
use perigrain_world::properties::MOLECULE;
use perigrain_world::{Numbers, Properties, Registration, World};

/// How the names of columns begin, before the fix's ID; all others find them by the property.
const BEGIN: &str = "property/atom/";
static PROPERTIES: Registration = Registration::roles(BEGIN);

/// The style.
pub struct PropertyAtomFix;

impl Style for PropertyAtomFix {
    fn name(&self) -> &'static str {
        "property/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Gives all particles properties of the deck's own.",
            text: "Properties are 0 or `initial` at first, belong to all particles whatever the group, and are set by `set … d_NAME \
                   value` (or `d2_NAME[k]`). Read them with `compute property/atom`, in `dump custom`, `fix \
                   store/state` and in formulas (`d_NAME`, `d_NAME[7]`; without columns). `temperature` and `heatflow` \
                   are what granular contacts that conduct heat read and write, and `fix heat/flow` integrates.\n\n\
                   `write_data` writes them all into a section of the fix's name, and `read_data … fix ID NULL SECTION` \
                   reads it. LAMMPS' `q` and `rmass` are refused: atom styles say what particles have.",
            example: "fix mine all property/atom i_flag d_heat\nset group ball d_heat 3.5 i_flag 2\nvariable heat atom d_heat+1",
        }
    }
    fn registrations(&self) -> &'static [&'static Registration] {
        const { &[&PROPERTIES] }
    }
}

#[derive(Words)]
struct Line {
    #[word(flatten)]
    names: Names,
    /// There are no ghosts: without effect.
    #[word(keyword, what = "ghost", placed)]
    ghost: Option<At<bool>>,
    /// Whether `write_data` writes them.
    #[word(keyword, what = "writedata", default = true)]
    writedata: bool,
    /// What all of them are at first, and for particles that join later, from `create_atoms`, `fix pour`, `fix insert` and all others;
    /// not the heat flow, and not molecule IDs. Properties that `read_restart` has brought stay. Not in LAMMPS.
    #[word(keyword, name = "V", what = "the initial value", once, placed, shown = "0")]
    initial: Option<At<f64>>,
}

/// The columns of the names of a line, which may stand behind keywords as well.
struct Names(Vec<String>);

impl Words for Names {
    const GRAMMAR: &'static Grammar = &Grammar {
        parts: &[Part::Many(
            &[Part::Word(Placeholder {
                name: "name",
                kind: Kind::Text,
                about: "`i_NAME` (whole numbers), `d_NAME` (numbers), `i2_NAME N` or `d2_NAME N` for N columns, `temperature`, \
                        `heatflow`, or `mol`: molecule IDs for particles whose style has none.",
                unit: "",
            })],
            1,
        )],
        keywords: &[],
        refused: &[],
    };

    fn begin(args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let mut names = Self(vec![]);
        while let Some(word) = args.peek().filter(|_| !args.at_keyword()) {
            args.next();
            names.keyword(word, args, cx)?;
        }
        Ok(names)
    }

    fn keyword(&mut self, word: &Word, args: &mut Args, cx: &BuildCx) -> Result<bool> {
        let Self(names) = self;
        match word.text.as_str() {
            "mol" => {
                no_molecules(word, cx, names.iter().any(|name| name == MOLECULE))?;
                names.push(MOLECULE.to_string());
            }
            "q" | "rmass" => {
                let text = format!("`{}` cannot be added: atom styles define what particles have", word.text);
                return fail(Code::NOT_SUPPORTED, word.span, text);
            }
            _ => names.extend(columns(word, args, cx, names)?),
        }
        Ok(true)
    }
}

impl FixStyle for PropertyAtomFix {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { names: Names(names), ghost, writedata: written, initial } = read(args, cx)?;
        if let Some(ghost) = ghost {
            cx.note(Diagnostic::note(Code::NO_EFFECT, ghost.span, "without effect: there are no ghosts"));
        }
        if names.is_empty() {
            args.expect("a name such as i_flag or d_heat")?;
        }
        let column =
            |name: &String| (name != MOLECULE).then(|| PROPERTIES.key(&format!("{BEGIN}{}/{name}", cx.id)));
        let columns = names.iter().map(column).collect();
        let initial = initial.map(|at| begins(&names, &at)).transpose()?;
        let properties = Properties { fix: cx.id.to_string(), names, columns, written };
        Ok(Box::new(Declared { properties, initial }))
    }
}

/// Whether a property may have a value at first.
fn can_begin(name: &str) -> bool {
    name != MOLECULE && name != HEATFLOW.text()
}

/// The value that the properties of a line have at first.
fn begins(names: &[String], At { value, span, .. }: &At<f64>) -> Result<f64> {
    let wrong = |text: String| fail(Code::BAD_VALUE, *span, text);
    if !names.iter().any(|name| can_begin(name)) {
        return wrong("no property of this line has an initial value".into());
    }
    if names.iter().any(|name| name == TEMPERATURE.text()) && *value < 0.0 {
        return wrong(format!("a temperature is not negative, {value} is"));
    }
    match names.iter().find(|name| name.starts_with('i')) {
        Some(name) if value.fract() != 0.0 => wrong(format!("`{name}` holds whole numbers, not {value}")),
        _ => Ok(*value),
    }
}

/// Checks that molecule IDs are not yet defined by the atom style, by this line or by another fix.
fn no_molecules(word: &Word, cx: &BuildCx, before: bool) -> Result<()> {
    let style = &cx.world.particles.style;
    if style.bonded {
        let text = format!("particles of atom_style {} have molecules by themselves", style.name());
        return fail(Code::CONFLICT, word.span, text);
    }
    // A fix with this ID may be declared again. After `read_restart` the particles have molecule IDs that no
    // fix has declared yet.
    let other = |p: &Properties| p.fix != cx.id && p.names.iter().any(|name| name == MOLECULE);
    if before || cx.world.properties.iter().any(other) {
        return fail(Code::DUPLICATE_NAME, word.span, "`mol` exists already");
    }
    Ok(())
}

/// Bytes of a column apart from its numbers: its name, in the declaration and in the store of columns.
const BYTES_PER_NAME: f64 = 200.0;

/// The columns of one name, such as `d_heat` or `d2_heat/1`.
fn columns(word: &Word, args: &mut Args, cx: &BuildCx, before: &[String]) -> Result<Vec<String>> {
    if [TEMPERATURE.text(), HEATFLOW.text()].contains(&word.text.as_str()) {
        return free(word, cx, before, &word.text).map(|()| vec![word.text.clone()]);
    }
    let prefix = ["i_", "d_", "i2_", "d2_"].into_iter().find(|p| word.text.starts_with(p));
    let tail = prefix.map_or("", |p| &word.text[p.len()..]);
    let (Some(prefix), true) =
        (prefix, !tail.is_empty() && tail.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'))
    else {
        let d = Diagnostic::error(
            Code::BAD_VALUE,
            word.span,
            format!("`{}` is no name of a property", word.text),
        );
        return Err(d.help("write i_NAME, d_NAME, i2_NAME N, d2_NAME N, temperature or heatflow").into());
    };
    let several = prefix.contains('2');
    let each = BYTES_PER_NAME + size_of::<f64>() as f64 * cx.world.n() as f64;
    let count = if several { args.count("the number of columns", each)? } else { 1 };
    let key = |k: usize| if several { format!("{}/{k}", word.text) } else { word.text.clone() };
    free(word, cx, before, &key(1))?;
    Ok((1..=count).map(key).collect())
}

/// The bare name of `i_heat`, `d_heat` or `d2_heat/1`; `None` for `temperature` and `heatflow`.
fn stem(key: &str) -> Option<&str> {
    let head = key.split_once('/').map_or(key, |(head, _)| head);
    head.split_once('_').map(|(_, stem)| stem)
}

/// Checks that no property has this name yet, of any kind. A fix with this ID may be declared again.
fn free(word: &Word, cx: &BuildCx, before: &[String], key: &str) -> Result<()> {
    let own = format!("{BEGIN}{}/", cx.id);
    let columns = cx.world.columns.names();
    let others = columns.iter().filter(|full| !full.starts_with(&own));
    let others = others.filter_map(|full| full.strip_prefix(BEGIN)?.split_once('/'));
    let mut taken = others.map(|(_, key)| key).chain(before.iter().map(String::as_str));
    match taken.find(|other| *other == key || (stem(other).is_some() && stem(other) == stem(key))) {
        None => Ok(()),
        Some(other) if other == key => {
            fail(Code::DUPLICATE_NAME, word.span, format!("`{}` exists already", word.text))
        }
        Some(other) => {
            let shown = other.split('/').next().unwrap_or(other);
            let text = format!("`{}` and `{shown}` differ in nothing but their kind", word.text);
            let d = Diagnostic::error(Code::DUPLICATE_NAME, word.span, text);
            Err(d.help("names must differ behind the first underscore").into())
        }
    }
}

#[derive(Clone)]
struct Declared {
    properties: Properties,
    /// What they are at first, where that is not 0.
    initial: Option<f64>,
}

impl Declared {
    fn molecules(&self) -> bool {
        self.properties.names.iter().any(|name| name == MOLECULE)
    }

    fn columns(&self) -> impl Iterator<Item = Numbers> {
        self.properties.columns.iter().flatten().copied()
    }
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        let n = w.n();
        for (name, column) in self.properties.names.iter().zip(&self.properties.columns) {
            match (column, self.initial) {
                (Some(column), Some(value)) if can_begin(name) => w.columns.start(*column, n, value),
                (Some(column), _) => _ = w.columns.scalar(*column, n),
                (None, _) => {}
            }
        }
        w.properties.push(self.properties.clone());
        if self.molecules() {
            w.particles.style.molecules = true;
            w.particles.molecule.resize(n, 0);
        }
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        if self.molecules() {
            w.particles.style.molecules = w.particles.style.bonded;
            w.particles.molecule.clear();
        }
        w.properties.retain(|p| p.fix != self.properties.fix);
        self.columns().for_each(|column| w.columns.remove(column));
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { at_rest: AtRest::Acts, ..Facts::default() }
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let n = cx.world().n();
        cx.world().columns.resize(n);
        Ok(vec![])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::{AtomStyle, Key};

    #[test]
    fn columns_come_and_go() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        let fix = b.fix(&PropertyAtomFix, "i_a d_b d2_c 2 ghost yes").unwrap();
        fix.declare(&mut b.world).unwrap();
        let columns = &b.world.columns;
        assert_eq!(columns.custom("d_b"), Some(Key::new("property/atom/f/d_b")));
        assert_eq!(columns.custom("d2_c[2]"), Some(Key::new("property/atom/f/d2_c/2")));
        assert_eq!((columns.custom("d2_c[3]"), columns.custom("b")), (None, None));
        fix.remove(&mut b.world);
        assert!(b.world.columns.names().is_empty());
        b.world.columns.scalar(PROPERTIES.key("property/atom/other/d_b"), 2);
        for words in ["", "d_b", "x_b", "d_", "d_a d_a", "d2_c", "d2_c 0", "q", "ghost maybe", "d_a-b"] {
            assert!(b.fix(&PropertyAtomFix, words).is_err(), "{words}");
        }
        for words in [
            "i_a initial 0.5",
            "temperature initial -1",
            "heatflow initial 3",
            "d_c initial",
            "d_c initial 1 initial 2",
        ] {
            assert!(b.fix(&PropertyAtomFix, words).is_err(), "{words}");
        }
    }

    #[test]
    fn particles_that_join_begin_with_the_initial_value() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        let fix = b.fix(&PropertyAtomFix, "temperature heatflow i_a initial 300").unwrap();
        fix.declare(&mut b.world).unwrap();
        let keys =
            ["temperature", "heatflow", "i_a"].map(|name| Key::new(&format!("property/atom/f/{name}")));
        let now = |b: &Bench| keys.map(|key| b.world.columns.get_scalar(key).unwrap().to_vec());
        assert_eq!(now(&b), [[300.0; 2], [0.0; 2], [300.0; 2]]);
        b.world.columns.scalar(keys[0], 2)[1] = 800.0;
        b.world.columns.resize(3);
        assert_eq!(now(&b)[..2], [[300.0, 800.0, 300.0], [0.0; 3]]);
        // What a restart file has brought stays.
        fix.declare(&mut b.world).unwrap();
        assert_eq!(now(&b)[0], [300.0, 800.0, 300.0]);
        fix.remove(&mut b.world);
        b.world.columns.scalar(keys[0], 3);
        b.world.columns.resize(4);
        assert_eq!(b.world.columns.get_scalar(keys[0]).unwrap(), [0.0; 4]);
    }
}
