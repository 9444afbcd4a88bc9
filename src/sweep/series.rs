//! What a run reports, over its time: a table of the rows that its step table had.

use perigrain_base::diag::{Code, Result, fail};
use perigrain_output::file::replace;
use perigrain_output::rows::Tables;
use std::path::Path;

/// The file in the folder of a run.
pub const FILE: &str = "series.csv";

/// A quantity over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Times, each later than the one before.
    pub times: Vec<f64>,
    /// The value at each.
    pub values: Vec<f64>,
}

impl Series {
    /// The rows of a column in which time increases; `None` where no table has the column, or time goes back.
    pub fn of(tables: &Tables, word: &str) -> Option<Self> {
        let mut out = Self::default();
        for (_, time, value) in tables.column(word) {
            match out.times.last() {
                // The first row of a further run is the last one of the run before.
                Some(last) if time == *last => drop(out.values.pop().map(|_| out.values.push(value))),
                Some(last) if time < *last => return None,
                _ if time.is_nan() => return None,
                _ => {
                    out.times.push(time);
                    out.values.push(value);
                }
            }
        }
        (!out.times.is_empty()).then_some(out)
    }
}

/// Writes the series of these words as one table, per row a line with the number of its word, time and value.
///
/// # Errors
/// A file that cannot be written.
pub fn write(path: &Path, tables: &Tables, words: &[String]) -> Result<()> {
    replace(path, |w| {
        w.write_all(b"word,time,value\n")?;
        for (k, word) in words.iter().enumerate() {
            let series = Series::of(tables, word).unwrap_or_default();
            for (time, value) in series.times.iter().zip(&series.values) {
                writeln!(w, "{k},{time:?},{value:?}")?;
            }
        }
        Ok(())
    })
}

/// What [`write`] wrote, in the order of its words; empty series for those that were no columns.
///
/// # Errors
/// A file that is gone or was changed.
pub fn read(path: &Path, words: usize) -> Result<Vec<Series>> {
    let broken = |what: &str| fail(Code::BAD_FILE, None, format!("`{}` {what}", path.display()));
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(e) => return broken(&format!("cannot be read: {e}")),
    };
    let mut out = vec![Series::default(); words];
    for line in text.lines().skip(1) {
        let mut cells = line.split(',');
        let word = cells.next().and_then(|c| c.parse::<usize>().ok());
        let series = word.and_then(|k| out.get_mut(k));
        let mut number = || cells.next().and_then(|c| c.parse::<f64>().ok());
        let (Some(series), Some(time), Some(value)) = (series, number(), number()) else {
            return broken("has been changed since the run wrote it");
        };
        series.times.push(time);
        series.values.push(value);
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_output::rows::Row;

    #[test]
    fn rows_of_several_runs_are_one_series_and_come_back() {
        let mut tables = Tables::default();
        let columns = || vec!["step".to_string(), "c_k[1,2]".into()];
        for (step, value) in [(0, 1.0), (5, 0.1 + 0.2), (5, 4.0), (9, 1e-300)] {
            tables.push(columns(), Row { step, time: 0.5 * step as f64, values: vec![step as f64, value] });
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(FILE);
        write(&path, &tables, &["c_k[1,2]".into(), "pe/2".into()]).unwrap();
        let back = read(&path, 2).unwrap();
        assert_eq!(back[0], Series { times: vec![0.0, 2.5, 4.5], values: vec![1.0, 4.0, 1e-300] });
        assert_eq!(back[1], Series::default());
        tables.push(columns(), Row { step: 9, time: 0.0, values: vec![9.0, 1.0] });
        assert_eq!(Series::of(&tables, "c_k[1,2]"), None, "which of the two ways is meant?");
        std::fs::write(&path, "word,time,value\nx\n").unwrap();
        assert!(read(&path, 2).is_err());
    }
}
