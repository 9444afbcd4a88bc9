//! What runs there are: lists of values, tied lists, tables, and all their combinations.

use perigrain_base::diag::{Code, Diagnostic, FileId, Result, Span, fail};
use perigrain_lang::number::{parse, parse_integer, value_text};

/// More runs than this are a slip of the finger.
const MOST: usize = 1_000_000;

/// Variables with one value each.
pub type Row = Vec<(String, String)>;

/// Variables that change together, and the values they take one after the other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Axis {
    /// The variables.
    pub names: Vec<String>,
    /// One set of values per turn.
    pub rows: Vec<Vec<String>>,
}

impl Axis {
    /// `each NAME VALUE …`, with ranges among the values.
    ///
    /// # Errors
    /// No name for a variable, no values, ranges without end.
    pub fn each(name: &str, words: &[String]) -> Result<Self> {
        check_name(name)?;
        let mut rows = vec![];
        for word in words {
            rows.extend(values(word)?.into_iter().map(|v| vec![v]));
        }
        if rows.is_empty() {
            return fail(Code::MISSING_ARGUMENT, None, format!("`{name}` needs at least one value"));
        }
        Ok(Self { names: vec![name.to_owned()], rows })
    }

    /// A table, the first line with the variables' names, then one line per run; columns between commas or blanks.
    ///
    /// # Errors
    /// Lines that do not fit the first one; their places are in `file`.
    pub fn table(text: &str, file: FileId) -> Result<Self> {
        let (axis, span) = Self::grid(text, file)?;
        axis.names.iter().try_for_each(|name| check_name(name)).map_err(|e| e.at(span))?;
        Ok(axis)
    }

    /// Whether these are values of a switch of the program, which begins with a dash, and not of variables.
    pub fn is_switch(&self) -> bool {
        self.names.first().is_some_and(|name| name.starts_with('-'))
    }

    /// As [`Axis::table`] with any names, and where their line is.
    ///
    /// # Errors
    /// Lines that do not fit the first one; their places are in `file`.
    pub fn grid(text: &str, file: FileId) -> Result<(Self, Span)> {
        let mut head = Span::new(file, 0, 0);
        let mut axis = Self::default();
        let mut commas = false;
        let mut at = 0;
        for line in text.split_inclusive('\n') {
            let start = at;
            at += line.len();
            let span = Span::new(file, start, start + line.trim_end().len());
            let content = line.trim();
            if content.is_empty() || content.starts_with('#') {
                continue;
            }
            if axis.names.is_empty() {
                commas = content.contains(',');
                axis.names = cells(content, commas);
                head = span;
                continue;
            }
            let row = cells(content, commas);
            if row.len() != axis.names.len() {
                let text = format!("{} values for {} variables", row.len(), axis.names.len());
                return fail(Code::BAD_VALUE, span, text);
            }
            axis.rows.push(row);
        }
        if axis.rows.is_empty() {
            let text = "the table needs a line with the variables' names and one line per run";
            return fail(Code::MISSING_ARGUMENT, Span::new(file, 0, 0), text);
        }
        Ok((axis, head))
    }
}

/// Letters, digits and underscores.
fn check_name(name: &str) -> Result<()> {
    if !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') {
        return Ok(());
    }
    fail(Code::BAD_VALUE, None, format!("`{name}` is no name for a variable: letters, digits and _ only"))
}

/// The cells of a line; between commas a cell may stand in double quotes.
fn cells(line: &str, commas: bool) -> Vec<String> {
    if !commas {
        return line.split_whitespace().map(String::from).collect();
    }
    let (mut out, mut cell, mut quoted) = (vec![], String::new(), false);
    let mut letters = line.chars().peekable();
    while let Some(c) = letters.next() {
        match c {
            '"' if quoted && letters.next_if_eq(&'"').is_some() => cell.push('"'),
            '"' => quoted = !quoted,
            ',' if !quoted => out.push(std::mem::take(&mut cell).trim().to_owned()),
            c => cell.push(c),
        }
    }
    out.push(cell.trim().to_owned());
    out
}

/// `a..b` and `a..b:step` are whole numbers, `a:b:n` are n numbers evenly from a to b, anything else is itself.
fn values(word: &str) -> Result<Vec<String>> {
    if let Some((from, to)) = word.split_once("..") {
        let (to, step) = to.split_once(':').unwrap_or((to, "1"));
        if let (Some(a), Some(b)) = (parse_integer(from), parse_integer(to)) {
            return match parse_integer(step).filter(|s| *s > 0) {
                Some(step) => whole(word, a, b, step),
                None => fail(
                    Code::BAD_VALUE,
                    None,
                    format!("`{word}`: the step `{step}` is no whole number above 0"),
                ),
            };
        }
    }
    let parts: Vec<&str> = word.split(':').collect();
    let [from, to, count] = parts[..] else { return Ok(vec![word.to_owned()]) };
    let (Some(a), Some(b), Some(n)) = (parse(from), parse(to), parse(count)) else {
        return Ok(vec![word.to_owned()]);
    };
    if n.fract() != 0.0 || n < 1.0 || n > MOST as f64 {
        return fail(Code::BAD_VALUE, None, format!("`{word}`: `{count}` is no number of values"));
    }
    let last = (n - 1.0).max(1.0);
    Ok((0..n as usize).map(|k| value_text(a + (b - a) * k as f64 / last)).collect())
}

fn whole(word: &str, a: i64, b: i64, step: i64) -> Result<Vec<String>> {
    let turns = a.abs_diff(b) / step.unsigned_abs();
    if turns >= MOST as u64 {
        return fail(Code::TOO_LARGE, None, format!("`{word}` means more than {MOST} values"));
    }
    let step = if b < a { -step } else { step };
    Ok((0..=turns as i64).map(|k| (a + k * step).to_string()).collect())
}

/// Ties the axes of the named variables together: they take their values in step, where the first of them stands.
///
/// # Errors
/// Names that no axis has, lists of different lengths.
pub fn zip(axes: &mut Vec<Axis>, names: &[String]) -> Result<()> {
    let mut tied: Option<(usize, Axis)> = None;
    for name in names {
        let Some(at) = axes.iter().position(|axis| axis.names.contains(name)) else {
            if tied.as_ref().is_some_and(|(_, axis)| axis.names.contains(name)) {
                continue;
            }
            let text = format!("`{name}` has no list of values that could be tied to others");
            return fail(Code::UNKNOWN_NAME, None, text);
        };
        let axis = axes.remove(at);
        let Some((_, first)) = &mut tied else {
            tied = Some((at, axis));
            continue;
        };
        if first.rows.len() != axis.rows.len() {
            let text = format!(
                "`{}` has {} values and `{name}` {}: tied lists are equally long",
                first.names[0],
                first.rows.len(),
                axis.rows.len()
            );
            return fail(Code::CONFLICT, None, text);
        }
        first.names.extend(axis.names);
        first.rows.iter_mut().zip(axis.rows).for_each(|(row, more)| row.extend(more));
    }
    if let Some((at, axis)) = tied {
        axes.insert(at.min(axes.len()), axis);
    }
    Ok(())
}

/// All combinations, the last axis fastest.
///
/// # Errors
/// A variable on two axes, an implausible number of runs.
pub fn combined(axes: &[Axis]) -> Result<Vec<Row>> {
    let names: Vec<&String> = axes.iter().flat_map(|axis| &axis.names).collect();
    if let Some(twice) = names.iter().enumerate().find(|(k, n)| names[..*k].contains(n)) {
        return fail(Code::DUPLICATE_NAME, None, format!("`{}` has two lists of values", twice.1));
    }
    let count = axes.iter().try_fold(1usize, |n, axis| n.checked_mul(axis.rows.len()));
    if count.is_none_or(|n| n > MOST) {
        let d = Diagnostic::error(Code::TOO_LARGE, None, format!("these are more than {MOST} runs"));
        return Err(d
            .help("every list multiplies their number: tie lists with `zip`, or write a table")
            .into());
    }
    let mut all = vec![Row::new()];
    for axis in axes {
        let longer = |before: &Row, values: &Vec<String>| {
            let more = axis.names.iter().cloned().zip(values.iter().cloned());
            before.iter().cloned().chain(more).collect::<Row>()
        };
        all = all
            .iter()
            .flat_map(|before| axis.rows.iter().map(|row| longer(before, row)).collect::<Vec<_>>())
            .collect();
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn each(name: &str, words: &str) -> Axis {
        Axis::each(name, &words.split(' ').map(String::from).collect::<Vec<_>>()).unwrap()
    }

    fn list(words: &str) -> Vec<String> {
        each("v", words).rows.concat()
    }

    #[test]
    fn ranges_are_whole_numbers_or_evenly_spread() {
        assert_eq!(list("10 20 x"), ["10", "20", "x"]);
        assert_eq!(list("1..4 9"), ["1", "2", "3", "4", "9"]);
        assert_eq!(list("0..10:5"), ["0", "5", "10"]);
        assert_eq!(list("3..-1:2"), ["3", "1", "-1"]);
        assert_eq!(list("0.1:0.5:5"), ["0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(list("2:7:1"), ["2"]);
        assert_eq!(list("a:b:c a..b ../x 12:30"), ["a:b:c", "a..b", "../x", "12:30"]);
        for bad in ["1..5:0", "1..5:x", "0:1:2.5", "0:1:0", "1..99999999", "0:1:1e9"] {
            assert!(Axis::each("v", &[bad.into()]).is_err(), "{bad}");
        }
        assert!(Axis::each("a b", &["1".into()]).is_err());
    }

    #[test]
    fn combinations_go_with_the_last_list_fastest() {
        let mut axes = vec![each("a", "1 2"), each("b", "x y"), each("c", "7 8")];
        let title = |row: &Row| row.iter().map(|(n, v)| format!("{n}={v}")).collect::<Vec<_>>().join(" ");
        let say = |rows: Vec<Row>| rows.iter().map(title).collect::<Vec<_>>().join(", ");
        let some = combined(&axes[..2]).unwrap();
        assert_eq!(say(some), "a=1 b=x, a=1 b=y, a=2 b=x, a=2 b=y");
        zip(&mut axes, &["a".into(), "c".into()]).unwrap();
        assert_eq!(say(combined(&axes).unwrap()), "a=1 c=7 b=x, a=1 c=7 b=y, a=2 c=8 b=x, a=2 c=8 b=y");
        assert!(combined(&[each("a", "1"), each("a", "2")]).is_err());
        assert!(zip(&mut vec![each("a", "1 2"), each("b", "1")], &["a".into(), "b".into()]).is_err());
        assert!(zip(&mut axes, &["missing".into()]).is_err());
        assert!(combined(&[each("a", "1..2000"), each("b", "1..2000")]).is_err());
    }

    #[test]
    fn tables_have_a_line_of_names_and_a_line_per_run() {
        let blanks = Axis::table("# c\n v  seed\n10 1\n\n20 2\n", FileId(0)).unwrap();
        assert_eq!(blanks.names, ["v", "seed"]);
        assert_eq!(blanks.rows, [["10", "1"], ["20", "2"]]);
        let commas = Axis::table("v, text\n1,\"a, \"\"b\"\"\"\n2,\n", FileId(0)).unwrap();
        assert_eq!(commas.rows, [["1", "a, \"b\""], ["2", ""]]);
        for bad in ["", "v\n", "v w\n1\n", "v-w\n1\n"] {
            assert!(Axis::table(bad, FileId(0)).is_err(), "{bad:?}");
        }
    }
}
