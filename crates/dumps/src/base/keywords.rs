//! The keywords of `dump_modify` shared by all dumps.

use super::{Base, Rhythm, Sort, Threshold};
use crate::attribute::attribute;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::args::{blame, parse_number};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_styles::{BuildCx, UseKind};
use perigrain_world::{Key, Region};

/// Keywords of `dump_modify` that every style accepts.
pub const KEYWORDS: &[&str] = &[
    "append",
    "balance",
    "buffer",
    "delay",
    "element",
    "every",
    "every/time",
    "fileper",
    "first",
    "flush",
    "maxfiles",
    "nfile",
    "pad",
    "pbc",
    "refresh",
    "region",
    "skip",
    "sort",
    "thresh",
    "types",
];

/// LAMMPS' keywords that no style here accepts, with the reason.
const ELSEWHERE: &[(&str, &str)] = &[
    ("at", "is for dump styles that perigrain does not have"),
    ("compression_level", "is for the styles atom/gz, custom/gz, cfg/gz, xyz/gz and local/gz"),
    ("sfactor", "is for dump xtc, which perigrain does not have"),
    ("tfactor", "is for dump xtc, which perigrain does not have"),
    ("precision", "is for dump xtc, which perigrain does not have"),
    ("unwrap", "is for dumps dcd and xtc, which perigrain does not have: dump xu yu zu"),
    ("thermo", "is for dump yaml"),
    ("triclinic/general", "is for general triclinic boxes, which perigrain does not have"),
    ("header", "is for text dumps"),
    ("label", "is for dump local"),
];

impl Base {
    /// Reads one keyword of `dump_modify` if it is shared by all dumps.
    pub fn modify(&mut self, word: &Word, args: &mut Args, cx: &BuildCx) -> Result<bool> {
        match word.text.as_str() {
            "append" => self.append = args.flag("append")?,
            "every" => self.read_every(args, cx)?,
            "every/time" if args.peek_text().starts_with("v_") => {
                self.rhythm = Rhythm::NamedTime(number_variable(args, cx)?);
            }
            "every/time" => self.rhythm = Rhythm::Time(args.positive("the time between snapshots")?),
            "delay" => self.delay = args.integer("the first step to write")?,
            "element" => self.elements = names(args, cx)?,
            "maxfiles" => {
                self.maxfiles = maxfiles(args)?;
                if self.maxfiles.is_some() && !self.state().target.pattern.many() {
                    let text = "maxfiles counts files of single snapshots, and this dump writes all into one";
                    let d = Diagnostic::error(Code::CONFLICT, word.span, text);
                    return Err(d.help("put a `*` into the dump's file name: it becomes the step").into());
                }
            }
            "triclinic/general" if args.peek_text() == "no" => drop(args.next()),
            "refresh" => self.refresh = Some(refresh(args, cx)?),
            "skip" => self.skip = Some(number_variable(args, cx)?),
            "compression_level" if self.level.is_some() => {
                let span = args.here();
                let level = args.integer("how tightly to pack")?;
                if !(-1..=9).contains(&level) {
                    return fail(Code::BAD_VALUE, span, format!("the level goes from -1 to 9, not {level}"));
                }
                self.level = Some(level);
            }
            "balance" => {
                args.flag("balance")?;
                let text = "without effect: one process writes the file";
                cx.note(Diagnostic::note(Code::NO_EFFECT, word.span, text));
            }
            "types" => {
                let kind = args.expect("`numeric`")?;
                if kind.text != "numeric" {
                    let d = blame(kind, Code::NOT_SUPPORTED, "types have no labels in perigrain");
                    return Err(d.help("write `types numeric`, or name types with `element`").into());
                }
            }
            "fileper" | "nfile" => self.share(word, args, cx)?,
            "first" => self.first = args.flag("first")?,
            "pad" => self.pad = args.integer_from(0, "the number of digits")?.min(40) as usize,
            "region" => self.region = region(args, cx)?,
            "sort" => self.sort = sort(args)?,
            "thresh" => self.thresh(args, cx)?,
            // Snapshots are always flushed whole, which is what these keywords request.
            "flush" | "buffer" => {
                args.flag(&word.text)?;
            }
            "pbc" => self.pbc = args.flag("pbc")?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// `nfile N` or `fileper N`: one process has one file, for any N.
    fn share(&self, word: &Word, args: &mut Args, cx: &BuildCx) -> Result<()> {
        if !self.shared {
            let text = format!("dump_modify {} needs a `%` in the dump's file name", word.text);
            return fail(Code::CONFLICT, word.span, text);
        }
        args.integer_from(1, "the number of files or processes")?;
        let text = "without effect: one process writes one file";
        cx.note(Diagnostic::note(Code::NO_EFFECT, word.span, text));
        Ok(())
    }

    fn thresh(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        if args.eat("none") {
            self.thresholds.clear();
            return Ok(());
        }
        let attribute = attribute(args.expect("a particle attribute or `none`")?, cx)?;
        let word = args.expect("an operator: < <= > >= == !=")?;
        let compare: fn(f64, f64) -> bool = match word.text.as_str() {
            "<" => |a, b| a < b,
            "<=" => |a, b| a <= b,
            ">" => |a, b| a > b,
            ">=" => |a, b| a >= b,
            "==" => |a, b| a == b,
            "!=" => |a, b| a != b,
            "|^" => |a, b| (a != 0.0) != (b != 0.0),
            _ => {
                let d = blame(word, Code::BAD_VALUE, format!("`{}` compares nothing", word.text));
                return Err(d.help("use one of < <= > >= == !=").into());
            }
        };
        let word = args.expect("a number to compare with")?;
        let value = if word.text == "LAST" { None } else { Some(parse_number(word, "the threshold")?) };
        self.thresholds.push(Threshold { attribute, compare, value });
        Ok(())
    }

    /// `every N` or `every v_name`.
    fn read_every(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        if args.peek().is_some_and(|w| w.text.starts_with("v_")) {
            self.rhythm = Rhythm::Named(number_variable(args, cx)?);
            return Ok(());
        }
        self.every = Some(args.integer_from(1, "the dump's interval")?);
        self.rhythm = Rhythm::Steps;
        Ok(())
    }
}

/// A column by number from 1, by number from -1 backwards, or by name; returned as an index from 0.
///
/// # Errors
/// Unknown names and numbers.
pub fn column<'a>(word: &Word, mut names: impl ExactSizeIterator<Item = &'a str>) -> Result<usize> {
    let n = names.len();
    if let Some(k) = names.position(|name| name == word.text) {
        return Ok(k);
    }
    let Ok(k) = word.text.parse::<i64>() else {
        return fail(Code::UNKNOWN_NAME, word.span, format!("this dump has no column `{}`", word.text));
    };
    match usize::try_from(if k < 0 { n as i64 + k } else { k - 1 }) {
        Ok(index) if index < n => Ok(index),
        _ => fail(Code::BAD_VALUE, word.span, format!("this dump has columns 1 to {n}")),
    }
}

/// Refuses a keyword that neither the style nor all dumps have.
pub fn unknown(word: &Word, args: &Args, own: &[&'static str]) -> perigrain_base::diag::Diagnostics {
    if let Some((name, why)) = ELSEWHERE.iter().find(|(name, _)| *name == word.text) {
        return blame(word, Code::NOT_SUPPORTED, format!("dump_modify {name} {why}")).into();
    }
    let known: Vec<&'static str> = KEYWORDS.iter().chain(own).copied().collect();
    args.unknown(word, &known)
}

/// `v_name` of a variable with a numeric value.
fn number_variable(args: &mut Args, cx: &BuildCx) -> Result<ValueRef> {
    let word = args.expect("an equal-style variable, as `v_name`")?;
    match ValueRef::parse(&word.text, word.span)?.filter(|r| r.kind == RefKind::Variable) {
        Some(r) => cx.value(&r, false).map(|()| r),
        None => Err(blame(word, Code::BAD_VALUE, "this must be an equal-style variable, as `v_name`").into()),
    }
}

/// One name for each type.
fn names(args: &mut Args, cx: &BuildCx) -> Result<Vec<String>> {
    (0..cx.world.types)
        .map(|k| Ok(args.expect(&format!("the name of type {}", k + 1))?.text.clone()))
        .collect()
}

/// `maxfiles N`; -1 keeps all.
fn maxfiles(args: &mut Args) -> Result<Option<usize>> {
    let span = args.here();
    match args.integer("the number of files")? {
        -1 => Ok(None),
        n if n >= 1 => Ok(Some(n as usize)),
        n => fail(Code::BAD_VALUE, span, format!("maxfiles must be at least 1, or -1 for all, not {n}")),
    }
}

/// `refresh c_ID`.
fn refresh(args: &mut Args, cx: &BuildCx) -> Result<String> {
    let word = args.expect("a compute, as `c_ID`")?;
    match ValueRef::parse(&word.text, word.span)? {
        Some(r) if r.kind == RefKind::Compute && r.index.is_empty() => {
            if cx.shape(&r).is_none() {
                cx.value(&r, true)?;
            }
            cx.uses(UseKind::Compute, &r.name);
            Ok(r.name)
        }
        _ => Err(blame(word, Code::BAD_VALUE, "refresh takes a compute, as `c_ID`").into()),
    }
}

fn region(args: &mut Args, cx: &BuildCx) -> Result<Option<Key<Region>>> {
    if args.eat("none") {
        return Ok(None);
    }
    let word = args.expect("a region or `none`")?;
    cx.region(word)?;
    cx.uses(UseKind::Region, &word.text);
    Ok(Some(Key::new(&word.text)))
}

fn sort(args: &mut Args) -> Result<Sort> {
    if args.eat("off") {
        return Ok(Sort::Off);
    }
    if args.eat("id") {
        return Ok(Sort::Id);
    }
    let span = args.here();
    match args.integer("`off`, `id` or a column")? {
        0 => fail(Code::BAD_VALUE, span, "columns are counted from 1"),
        n => Ok(Sort::Column(n.unsigned_abs() as usize - 1, n < 0)),
    }
}
