//! Functions whose arguments are names: of vectors, groups, regions, files, settings and features.

use super::super::command::Word;
use super::super::reference::{RefKind, ValueRef};
use super::super::value::{Env, Question, Value};
use super::super::vars::Vars;
use super::pattern;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::gate;

/// What is done with a vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reduction {
    Sum,
    Min,
    Max,
    Average,
    Trapezoid,
    Slope,
    Ascending,
    Descending,
}

/// The quantity a function computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Special {
    Reduce(Reduction),
    GroupMask,
    RegionMask,
    BothMask,
    Next,
    IsFile,
    IsOs,
    Setting,
    TypeLabel,
    Timeout,
    Query(Question),
}

/// A function with its name and what it reads.
#[derive(Debug)]
pub(super) struct Row {
    /// As written.
    pub name: &'static str,
    /// What it is.
    pub what: Special,
    /// Its arguments, as shown to the user.
    pub usage: &'static [&'static str],
}

const VECTOR: &[&str] = &["c_ID|f_ID|v_name"];

const fn row(name: &'static str, what: Special, usage: &'static [&'static str]) -> Row {
    Row { name, what, usage }
}

/// All of them.
pub(super) static SPECIALS: &[Row] = &[
    row("sum", Special::Reduce(Reduction::Sum), VECTOR),
    row("min", Special::Reduce(Reduction::Min), VECTOR),
    row("max", Special::Reduce(Reduction::Max), VECTOR),
    row("ave", Special::Reduce(Reduction::Average), VECTOR),
    row("trap", Special::Reduce(Reduction::Trapezoid), VECTOR),
    row("slope", Special::Reduce(Reduction::Slope), VECTOR),
    row("sort", Special::Reduce(Reduction::Ascending), VECTOR),
    row("rsort", Special::Reduce(Reduction::Descending), VECTOR),
    row("gmask", Special::GroupMask, &["group"]),
    row("rmask", Special::RegionMask, &["region"]),
    row("grmask", Special::BothMask, &["group", "region"]),
    row("next", Special::Next, &["variable"]),
    row("is_file", Special::IsFile, &["file"]),
    row("is_os", Special::IsOs, &["pattern"]),
    row("extract_setting", Special::Setting, &["setting"]),
    row("label2type", Special::TypeLabel, &["kind", "label"]),
    row("is_typelabel", Special::TypeLabel, &["kind", "label"]),
    row("is_timeout", Special::Timeout, &[]),
    row("is_active", Special::Query(Question::Active), &["category", "feature"]),
    row("is_available", Special::Query(Question::Available), &["category", "feature"]),
    row("is_defined", Special::Query(Question::Defined), &["category", "name"]),
];

/// The function of this name.
pub(super) fn find(name: &str) -> Option<&'static Row> {
    SPECIALS.iter().find(|r| r.name == name)
}

/// The vector that `sum(c_ID[2])` and its kin name.
pub(super) fn vector_of(args: &[Word], span: Span) -> Option<ValueRef> {
    let r = ValueRef::parse(&args.first()?.text, span).ok().flatten()?;
    let wanted = matches!(r.kind, RefKind::Compute | RefKind::Fix) && r.index.len() <= 1;
    (wanted || (r.kind == RefKind::Variable && r.index.is_empty())).then_some(r)
}

/// The value of the function `row` with these arguments.
pub(super) fn value(
    row: &Row,
    args: &[Word],
    span: Span,
    vars: &Vars,
    env: &mut dyn Env,
    trail: &mut super::Trail,
) -> Result<Value> {
    // The grammar has counted them.
    let none = Word::new("", span);
    let name = |k: usize| args.get(k).unwrap_or(&none);
    let word = |k: usize| name(k).text.as_str();
    match row.what {
        Special::Reduce(how) => reduce(row, how, args, span, vars, env, trail),
        Special::GroupMask => env.mask(Some(name(0)), None, vars),
        Special::RegionMask => env.mask(None, Some(name(0)), vars),
        Special::BothMask => env.mask(Some(name(0)), Some(name(1)), vars),
        Special::Next => vars.take_next(word(0), span, env),
        Special::IsFile => {
            vars.event();
            if env.may_be_written(word(0)) {
                return Ok(Value::Unknown);
            }
            match gate::open(word(0)) {
                Err(e) if gate::code(&e) == Code::NOT_ALLOWED => {
                    fail(Code::NOT_ALLOWED, name(0).span, format!("is_file({}): {e}", word(0)))
                }
                file => Ok(truth(file.is_ok_and(|f| f.metadata().is_ok_and(|m| m.is_file())))),
            }
        }
        Special::IsOs => match pattern::matches(word(0), &pattern::os_info()) {
            Ok(found) => Ok(truth(found)),
            Err(why) => fail(Code::SYNTAX, name(0).span, format!("is_os(): {why}")),
        },
        Special::Setting => match env.setting(word(0)) {
            Some(v) => Ok(v),
            None => {
                fail(Code::UNKNOWN_NAME, name(0).span, format!("extract_setting() knows no `{}`", word(0)))
            }
        },
        Special::TypeLabel => {
            let message = format!("{}() needs a labelmap, which perigrain does not have", row.name);
            fail(Code::NOT_SUPPORTED, span, message)
        }
        Special::Timeout => {
            vars.event();
            Ok(truth(env.timed_out()))
        }
        Special::Query(Question::Defined) if word(0) == "variable" && vars.is_adrift(word(1)) => {
            Ok(Value::Unknown)
        }
        Special::Query(Question::Defined) if word(0) == "variable" => Ok(truth(vars.kind(word(1)).is_some())),
        Special::Query(q) => env.answer(q, name(0), name(1)).map(truth),
    }
}

fn truth(b: bool) -> Value {
    Value::Number(f64::from(u8::from(b)))
}

fn reduce(
    row: &Row,
    how: Reduction,
    args: &[Word],
    span: Span,
    vars: &Vars,
    env: &mut dyn Env,
    trail: &mut super::Trail,
) -> Result<Value> {
    let Some(r) = vector_of(args, span) else {
        let given = args.first().map_or("", |w| w.text.as_str());
        let message = format!("{}() reads c_ID, c_ID[i], f_ID, f_ID[i] or v_name, not `{given}`", row.name);
        return fail(Code::SYNTAX, span, message);
    };
    let value = match r.kind {
        RefKind::Variable => vars.reference(&r, env, trail)?,
        _ => env.vector(&r, vars)?,
    };
    match value {
        Value::Unknown => Ok(Value::Unknown),
        Value::Vector(list) if list.is_empty() => {
            fail(Code::BAD_VALUE, span, format!("{}(): the vector `{r}` is empty", row.name))
        }
        Value::Vector(list) => Ok(how.apply(list)),
        other => {
            let message = format!("{}() needs a global vector; `{r}` is {}", row.name, other.kind());
            let d = Diagnostic::error(Code::WRONG_KIND, span, message);
            Err(d.help("values per particle are summed by `compute reduce`").into())
        }
    }
}

impl Reduction {
    fn apply(self, mut list: Vec<f64>) -> Value {
        let n = list.len() as f64;
        let sum = |l: &[f64]| l.iter().sum::<f64>();
        Value::Number(match self {
            Reduction::Sum => sum(&list),
            Reduction::Average => sum(&list) / n,
            Reduction::Min => list.iter().copied().fold(f64::INFINITY, f64::min),
            Reduction::Max => list.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            Reduction::Trapezoid => {
                let ends = list.first().copied().unwrap_or(0.0) + list.last().copied().unwrap_or(0.0);
                sum(&list) - 0.5 * ends
            }
            Reduction::Slope => slope(&list),
            Reduction::Ascending => {
                list.sort_by(f64::total_cmp);
                return Value::Vector(list);
            }
            Reduction::Descending => {
                list.sort_by(|a, b| b.total_cmp(a));
                return Value::Vector(list);
            }
        })
    }
}

/// The slope of the line of least squares through (1, list[0]), (2, list[1]) …; 10²⁰ for a single point, as in LAMMPS.
fn slope(list: &[f64]) -> f64 {
    const VERTICAL: f64 = 1.0e20;
    let (mut sx, mut sy, mut sxx, mut sxy) = (0.0, 0.0, 0.0, 0.0);
    for (k, y) in list.iter().enumerate() {
        let x = (k + 1) as f64;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    let n = list.len() as f64;
    let below = n * sxx - sx * sx;
    if below == 0.0 { VERTICAL } else { (n * sxy - sx * sy) / below }
}
