//! The rows of step tables, kept as numbers for plots.

/// One printed row.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The step.
    pub step: i64,
    /// Elapsed time [time units of the deck].
    pub time: f64,
    /// The values, one per column.
    pub values: Vec<f64>,
}

/// The rows of one run, or of several with the same columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The columns as the deck names them.
    pub columns: Vec<String>,
    /// The rows in the order they were printed.
    pub rows: Vec<Row>,
}

/// All step tables of a session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tables(pub Vec<Table>);

/// Where the tables ended at some moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mark {
    tables: usize,
    rows: usize,
}

impl Tables {
    /// Takes a row in; other columns than before begin a new table.
    pub fn push(&mut self, columns: Vec<String>, row: Row) {
        match self.0.last_mut() {
            Some(table) if table.columns == columns => table.rows.push(row),
            _ => self.0.push(Table { columns, rows: vec![row] }),
        }
    }

    /// The last row with its columns.
    pub fn last(&self) -> Option<(&[String], &Row)> {
        let table = self.0.last()?;
        Some((&table.columns, table.rows.last()?))
    }

    /// Where the tables end now.
    pub fn mark(&self) -> Mark {
        Mark { tables: self.0.len(), rows: self.0.last().map_or(0, |t| t.rows.len()) }
    }

    /// Drops the rows after a mark.
    pub fn back_to(&mut self, mark: Mark) {
        self.0.truncate(mark.tables);
        if let Some(table) = self.0.last_mut() {
            table.rows.truncate(mark.rows);
        }
    }

    /// Step, time and value of a column wherever a table has it, in the order printed.
    pub fn column(&self, name: &str) -> Vec<(i64, f64, f64)> {
        let mut found = vec![];
        for table in &self.0 {
            let Some(k) = table.columns.iter().position(|c| c == name) else { continue };
            found.extend(table.rows.iter().map(|r| (r.step, r.time, r.values[k])));
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(step: i64, values: &[f64]) -> Row {
        Row { step, time: 0.5 * step as f64, values: values.to_vec() }
    }

    #[test]
    fn columns_go_through_tables_and_marks_cut_them() {
        let mut tables = Tables::default();
        tables.push(vec!["pe".into()], row(0, &[1.0]));
        let mark = tables.mark();
        tables.push(vec!["pe".into()], row(2, &[2.0]));
        tables.push(vec!["ke".into(), "pe".into()], row(4, &[7.0, 3.0]));
        assert_eq!(tables.column("pe"), [(0, 0.0, 1.0), (2, 1.0, 2.0), (4, 2.0, 3.0)]);
        assert_eq!(tables.last().map(|(c, r)| (c.len(), r.step)), Some((2, 4)));
        tables.back_to(mark);
        assert_eq!(tables.column("pe"), [(0, 0.0, 1.0)]);
        assert!(tables.column("ke").is_empty());
    }
}
