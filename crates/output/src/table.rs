//! Tables as comma-separated values, one row per line, numbers in their shortest exact form.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use super::file;
use perigrain_base::diag::Result;
use perigrain_base::math::cformat::Value;

/// A CSV file being written.
#[derive(Debug)]
pub struct Table {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Table {
    /// Starts a file with a line of column names.
    pub fn create(path: &Path, columns: &[&str]) -> Result<Self> {
        let mut table = Self { path: path.into(), file: file::open(path, false)? };
        let names: Vec<Value<'_>> = columns.iter().map(|c| Value::Text(c)).collect();
        table.row(&names)?;
        Ok(table)
    }

    /// Adds a row.
    pub fn row(&mut self, values: &[Value<'_>]) -> Result<()> {
        let line = csv_line(values);
        self.file.write_all(line.as_bytes()).map_err(|e| file::trouble("write", &self.path, &e).into())
    }

    /// Hands everything written so far to the system.
    pub fn flush(&mut self) -> Result<()> {
        self.file.flush().map_err(|e| file::trouble("write", &self.path, &e).into())
    }
}

/// One line of CSV with its newline; text with commas, quotes or line breaks is quoted.
pub fn csv_line(values: &[Value<'_>]) -> String {
    let mut line = String::new();
    for (k, value) in values.iter().enumerate() {
        if k > 0 {
            line.push(',');
        }
        match value {
            Value::Int(i) => line.push_str(&i.to_string()),
            Value::Float(x) if x.is_nan() => line.push_str("nan"),
            Value::Float(x) => line.push_str(&format!("{x:?}")),
            Value::Text(t) if t.contains([',', '"', '\n', '\r']) => {
                line.push('"');
                line.push_str(&t.replace('"', "\"\""));
                line.push('"');
            }
            Value::Text(t) => line.push_str(t),
        }
    }
    line.push('\n');
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("t.csv");
        let mut table = Table::create(&path, &["step", "a,b"]).unwrap();
        table.row(&[Value::Int(3), Value::Float(0.1)]).unwrap();
        table.row(&[Value::Int(4), Value::Float(-1e-30)]).unwrap();
        table.row(&[Value::Text("say \"x\""), Value::Float(f64::INFINITY)]).unwrap();
        table.flush().unwrap();
        let expected = "step,\"a,b\"\n3,0.1\n4,-1e-30\n\"say \"\"x\"\"\",inf\n";
        assert_eq!(std::fs::read_to_string(&path).unwrap(), expected);
    }
}
