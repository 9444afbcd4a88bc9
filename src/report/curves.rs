//! The step tables as the page's curves have them: one list of rows, thinned evenly where there are too many.

use crate::json::{number, quoted};
use perigrain_output::rows::{Row, Tables};

/// So many numbers a page has at most; more rows than that allows are thinned.
const CELLS: usize = 400_000;

/// A column of the step tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// As the deck names it.
    pub name: String,
    /// First and last value, and the least and the greatest.
    pub ends: [f64; 4],
    /// The value at each row that is shown; no number where a row has none.
    pub values: Vec<f64>,
}

/// All columns over one list of rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curves {
    /// Steps of the rows that are shown.
    pub steps: Vec<i64>,
    /// Their times.
    pub times: Vec<f64>,
    /// The columns in the order in which they first came.
    pub columns: Vec<Column>,
    /// Rows that there are.
    pub rows: usize,
}

impl Curves {
    /// The tables of all runs, one after the other.
    pub fn of(tables: &Tables) -> Self {
        let mut names: Vec<&str> = vec![];
        for name in tables.0.iter().flat_map(|t| &t.columns) {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        let rows: usize = tables.0.iter().map(|t| t.rows.len()).sum();
        let stride = (rows * names.len().max(1)).div_ceil(CELLS).max(1);
        let mut out = Self { rows, ..Self::default() };
        out.columns = names.iter().map(|name| Column::new(name)).collect();
        let mut at = 0;
        for table in &tables.0 {
            let place: Vec<_> =
                names.iter().map(|name| table.columns.iter().position(|c| c == name)).collect();
            for row in &table.rows {
                // The last row is the one that readers look for.
                let shown = at % stride == 0 || at + 1 == rows;
                at += 1;
                for (column, k) in out.columns.iter_mut().zip(&place) {
                    let value = k.and_then(|k| row.values.get(k)).copied();
                    column.take(value, shown);
                }
                if shown {
                    out.steps.push(row.step);
                    out.times.push(row.time);
                }
            }
        }
        out
    }

    /// The page's remark where rows are left out.
    pub fn thinned(&self) -> Option<String> {
        let shown = self.steps.len();
        let left = shown < self.rows;
        left.then(|| format!("Curves show {shown} of {} rows of the step table, evenly chosen.", self.rows))
    }

    /// For the page's script.
    pub fn json(&self) -> String {
        let columns: Vec<String> = self
            .columns
            .iter()
            .map(|c| {
                let values: Vec<String> = c.values.iter().map(|v| number(*v)).collect();
                format!("{{\"name\":{},\"values\":[{}]}}", quoted(&c.name), values.join(","))
            })
            .collect();
        let steps: Vec<String> = self.steps.iter().map(ToString::to_string).collect();
        let times: Vec<String> = self.times.iter().map(|t| number(*t)).collect();
        format!(
            "{{\"steps\":[{}],\"times\":[{}],\"columns\":[{}]}}",
            steps.join(","),
            times.join(","),
            columns.join(",\n")
        )
    }
}

/// One row with its columns, for a page that is open.
pub fn row_json(columns: &[String], row: &Row) -> String {
    let names: Vec<String> = columns.iter().map(|c| quoted(c)).collect();
    let values: Vec<String> = row.values.iter().map(|v| number(*v)).collect();
    format!(
        "{{\"step\":{},\"time\":{},\"columns\":[{}],\"values\":[{}]}}",
        row.step,
        number(row.time),
        names.join(","),
        values.join(",")
    )
}

impl Column {
    fn new(name: &str) -> Self {
        Self { name: name.into(), ends: [f64::NAN; 4], values: vec![] }
    }

    /// Takes the value of the next row, if that has one.
    fn take(&mut self, value: Option<f64>, shown: bool) {
        if let Some(value) = value {
            let [first, last, least, most] = &mut self.ends;
            if first.is_nan() {
                *first = value;
            }
            // `min` and `max` pass over what is no number.
            (*last, *least, *most) = (value, least.min(value), most.max(value));
        }
        if shown {
            self.values.push(value.unwrap_or(f64::NAN));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_other_columns_follow_each_other_and_long_ones_are_thinned() {
        let mut tables = Tables::default();
        let row = |step, values: &[f64]| Row { step, time: 0.5 * step as f64, values: values.to_vec() };
        tables.push(vec!["pe".into()], row(0, &[3.0]));
        tables.push(vec!["ke".into(), "pe".into()], row(1, &[7.0, f64::NAN]));
        tables.push(vec!["ke".into(), "pe".into()], row(2, &[8.0, 2.0]));
        let curves = Curves::of(&tables);
        assert_eq!(
            curves.json(),
            "{\"steps\":[0,1,2],\"times\":[0e0,5e-1,1e0],\"columns\":[{\"name\":\"pe\",\"values\":[3e0,null,2e0]},\n\
             {\"name\":\"ke\",\"values\":[null,7e0,8e0]}]}"
        );
        assert_eq!((curves.columns[0].ends, curves.thinned()), ([3.0, 2.0, 2.0, 3.0], None));
        let mut tables = Tables::default();
        let n = CELLS + 10;
        (0..n).for_each(|k| tables.push(vec!["ke".into()], row(k as i64, &[k as f64])));
        let curves = Curves::of(&tables);
        assert_eq!((curves.steps[..2].to_vec(), curves.steps.last()), (vec![0, 2], Some(&(n as i64 - 1))));
        assert_eq!(curves.columns[0].ends, [0.0, n as f64 - 1.0, 0.0, n as f64 - 1.0]);
        assert!(curves.thinned().unwrap().contains("of 400010 rows"));
    }
}
