//! How thermo rows look: columns, formats and the three line styles.

use super::{Kind, keyword};
use crate::formats::Formats;
use perigrain_base::diag::{Code, Diagnostic, Result, fail, nearest};
use perigrain_base::math::cformat::{Format, Value};

/// How a row is laid out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Line {
    /// All on one line under a header.
    #[default]
    One,
    /// Three named values per line under a dashed line.
    Multi,
    /// A YAML list.
    Yaml,
}

/// One thermo column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// As written in the deck: `step`, `c_dmg`, `v_x[2]`.
    pub name: String,
    /// As it stands above the column.
    pub header: String,
    /// Whole numbers or not.
    pub kind: Kind,
    /// Whether `norm yes` divides it by the number of particles.
    pub extensive: bool,
}

impl Column {
    /// A column for a thermo keyword; `None` if LAMMPS has no such keyword.
    pub fn keyword(name: &str) -> Option<Self> {
        let k = keyword(name)?;
        let (name, header) = (k.name.into(), k.header.into());
        Some(Self { name, header, kind: k.kind, extensive: k.extensive })
    }

    /// A column for `c_ID`, `f_ID`, `v_name`; its header is the word itself.
    pub fn reference(word: &str, extensive: bool) -> Self {
        Self { name: word.into(), header: word.into(), kind: Kind::Float, extensive }
    }

    /// The header of the column unless `colname` sets another.
    pub fn usual_header(&self) -> String {
        keyword(&self.name).map_or(self.name.clone(), |k| k.header.into())
    }
}

/// Columns and formats of a thermo table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// How a row is laid out.
    pub line: Line,
    /// The columns from left to right.
    pub columns: Vec<Column>,
    /// Whether extensive columns are divided by the number of particles.
    pub norm: bool,
    /// Whether each row is flushed.
    pub flush: bool,
    formats: Formats,
}

impl Layout {
    /// A table of these columns.
    pub fn new(columns: Vec<Column>, line: Line) -> Self {
        Self { columns, line, ..Self::default() }
    }

    /// `thermo_style one`.
    pub fn one() -> Self {
        Self::of(&["step", "temp", "epair", "emol", "etotal", "press"], Line::One)
    }

    /// `thermo_style multi`.
    pub fn multi() -> Self {
        let words = "etotal ke temp pe ebond eangle edihed eimp evdwl ecoul elong press";
        Self::of(&words.split(' ').collect::<Vec<_>>(), Line::Multi)
    }

    /// `thermo_style yaml`.
    pub fn yaml() -> Self {
        let words = "step temp ke pe ebond eangle edihed eimp evdwl ecoul elong press";
        Self::of(&words.split(' ').collect::<Vec<_>>(), Line::Yaml)
    }

    fn of(words: &[&str], line: Line) -> Self {
        Self::new(words.iter().filter_map(|w| Column::keyword(w)).collect(), line)
    }

    /// `thermo_modify format line "…"`: one conversion per column, separated by blanks.
    pub fn format_line(&mut self, text: &str) -> Result<()> {
        let kinds: Vec<Kind> = self.columns.iter().map(|c| c.kind).collect();
        self.formats.set_line(text, &kinds)
    }

    /// `thermo_modify format int %…`.
    pub fn format_int(&mut self, text: &str) -> Result<()> {
        self.formats.set_int(text)
    }

    /// `thermo_modify format float %…`.
    pub fn format_float(&mut self, text: &str) -> Result<()> {
        self.formats.set_float(text)
    }

    /// `thermo_modify format ID %…`: `which` counts from 1, from -1 backwards, or names a column.
    pub fn format_column(&mut self, which: &str, text: &str) -> Result<()> {
        let k = self.find(which)?;
        self.formats.set_column(k, self.columns[k].kind, text)
    }

    /// `thermo_modify format none`.
    pub fn format_none(&mut self) {
        self.formats.clear();
    }

    /// `thermo_modify colname ID string`.
    pub fn rename(&mut self, which: &str, header: &str) -> Result<()> {
        let k = self.find(which)?;
        self.columns[k].header = header.into();
        Ok(())
    }

    /// `thermo_modify colname default`.
    pub fn rename_default(&mut self) {
        for c in &mut self.columns {
            c.header = c.usual_header();
        }
    }

    /// Finds a column by number or name.
    fn find(&self, which: &str) -> Result<usize> {
        let n = self.columns.len();
        if let Ok(k) = which.parse::<i64>() {
            let index = if k < 0 { n as i64 + k } else { k - 1 };
            return match usize::try_from(index) {
                Ok(index) if index < n && k != 0 => Ok(index),
                _ => fail(Code::BAD_VALUE, None, format!("there is no column {k}: the table has {n}")),
            };
        }
        if let Some(k) = self.columns.iter().position(|c| c.name == which) {
            return Ok(k);
        }
        let d = Diagnostic::error(Code::UNKNOWN_NAME, None, format!("no thermo column is called `{which}`"));
        let names = self.columns.iter().map(|c| c.name.as_str());
        Err(match nearest(which, names) {
            Some(near) => d.help(format!("did you mean `{near}`?")).into(),
            None => d.into(),
        })
    }

    /// What stands above the rows, without the last newline; empty for `multi`.
    pub fn header(&self) -> String {
        match self.line {
            Line::Multi => String::new(),
            Line::One => self.heads().join(" "),
            Line::Yaml => {
                let names: String = self.columns.iter().map(|c| format!("'{}', ", c.header)).collect();
                format!("---\nkeywords: [{names}]\ndata:")
            }
        }
    }

    fn heads(&self) -> Vec<String> {
        let head = |c: &Column| match c.kind {
            Kind::Int => format!("{:^11}", c.header),
            _ => format!("{:^14}", c.header),
        };
        self.columns.iter().map(head).collect()
    }

    /// How many columns of a row and its header are no wider than `width` characters, one at least; the other line styles are
    /// never wide.
    pub fn fitting(&self, width: usize, atoms: u64, values: &[Value<'_>]) -> usize {
        if self.line != Line::One {
            return self.columns.len();
        }
        let (mut head, mut row) = (0, 0);
        let fits = |(h, c): &(String, String)| -> bool {
            // Of a heading blanks at the end do no harm; what is blank in this row may be digits in the next one.
            let fits = head + h.trim_end().chars().count() <= width && row + c.chars().count() <= width;
            head += h.chars().count() + 1;
            row += c.chars().count() + 1;
            fits
        };
        self.heads().into_iter().zip(self.cells(atoms, values)).take_while(fits).count().max(1)
    }

    /// The header's first `n` columns.
    pub fn header_of(&self, n: usize) -> String {
        match self.line {
            Line::One => self.heads()[..n.min(self.columns.len())].join(" ").trim_end().into(),
            _ => self.header(),
        }
    }

    /// The first `n` columns of a row, as [`Layout::row`] has them.
    pub fn row_of(&self, n: usize, step: i64, cpu: f64, atoms: u64, values: &[Value<'_>]) -> String {
        match self.line {
            Line::One => {
                let cells = self.cells(atoms, values);
                cells[..n.min(cells.len())].join(" ").trim_end().into()
            }
            _ => self.row(step, cpu, atoms, values),
        }
    }

    /// One row without the last newline. `values` are in column order and not yet divided by `atoms`;
    /// `step` and the seconds since the start of the run stand in the dashed line of `multi`.
    pub fn row(&self, step: i64, cpu: f64, atoms: u64, values: &[Value<'_>]) -> String {
        let cells = self.cells(atoms, values);
        match self.line {
            Line::One => cells.join(" "),
            Line::Yaml => format!("  - [{}]", cells.iter().map(|c| format!("{c}, ")).collect::<String>()),
            Line::Multi => {
                let cpu = Format::parse("%12.7g").map(|f| f.text(&[Value::Float(cpu)])).unwrap_or_default();
                let mut text = format!("------------ Step {step:14} ----- CPU = {cpu} (sec) -------------\n");
                for (k, (cell, column)) in cells.iter().zip(&self.columns).enumerate() {
                    match k {
                        0 => (),
                        _ if k % 3 == 0 => text.push_str(" \n"),
                        _ => text.push(' '),
                    }
                    text.push_str(&format!("{:<8} = {cell}", column.header));
                }
                text
            }
        }
    }

    /// What closes the table at the end of a run, if anything.
    pub fn footer(&self) -> Option<&'static str> {
        (self.line == Line::Yaml).then_some("...")
    }

    /// The values as text.
    fn cells(&self, atoms: u64, values: &[Value<'_>]) -> Vec<String> {
        let defaults = self.defaults();
        let pairs = self.columns.iter().zip(values).enumerate();
        let cell = |(k, (column, &value)): (usize, (&Column, &Value<'_>))| {
            let value = match value {
                Value::Float(x) if self.norm && column.extensive && atoms > 0 => {
                    Value::Float(x / atoms as f64)
                }
                other => other,
            };
            let fallback = &defaults[usize::from(column.kind == Kind::Float)];
            let format = self.formats.of(k, column.kind).unwrap_or(fallback);
            format.text(&[value])
        };
        pairs.map(cell).collect()
    }

    /// LAMMPS' formats for whole and other numbers.
    fn defaults(&self) -> [Format; 2] {
        let (int, float) = match self.line {
            Line::One => ("%10d ", "% -14.8g"),
            Line::Multi => ("%14d", "%14.4f"),
            Line::Yaml => ("%d", "%.15g"),
        };
        [int, float].map(|text| Format::parse(text).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn custom(words: &str) -> Layout {
        let column = |w: &str| Column::keyword(w).unwrap_or_else(|| Column::reference(w, false));
        Layout::new(words.split(' ').map(column).collect(), Line::One)
    }

    /// Step 5 of the probe deck below: 27 spheres on a 3×3×3 lattice flying at (0.1, 0.2, -0.3), units lj.
    const STEP: Value<'static> = Value::Int(5);
    const TEMP: Value<'static> = Value::Float(0.0253744022020714);
    const PRESS: Value<'static> = Value::Float(0.0244346095280566);
    const ZERO: Value<'static> = Value::Float(0.0);
    const KE: Value<'static> = Value::Float(0.0366519142918809);

    // All expected texts below are lines of logs of LAMMPS 22Jul2025 for that deck under the same thermo commands.

    #[test]
    fn style_one() {
        let one = Layout::one();
        assert_eq!(
            one.header(),
            "   Step          Temp          E_pair         E_mol          TotEng         Press     "
        );
        assert_eq!(
            one.row(5, 0.0, 27, &[STEP, TEMP, ZERO, ZERO, KE, PRESS]),
            "         5   0.025374402    0              0              0.036651914    0.02443461   "
        );
    }

    #[test]
    fn style_multi() {
        let multi = Layout::multi();
        assert_eq!(multi.header(), "");
        let row = multi.row(
            5,
            2.7828e-05,
            27,
            &[KE, KE, TEMP, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, PRESS],
        );
        let expected = "\
------------ Step              5 ----- CPU =   2.7828e-05 (sec) -------------
TotEng   =         0.0367 KinEng   =         0.0367 Temp     =         0.0254 \n\
PotEng   =         0.0000 E_bond   =         0.0000 E_angle  =         0.0000 \n\
E_dihed  =         0.0000 E_impro  =         0.0000 E_vdwl   =         0.0000 \n\
E_coul   =         0.0000 E_long   =         0.0000 Press    =         0.0244";
        assert_eq!(row, expected);
    }

    #[test]
    fn style_yaml() {
        let yaml = Layout { line: Line::Yaml, ..custom("step atoms temp v_q") };
        assert_eq!(yaml.header(), "---\nkeywords: ['Step', 'Atoms', 'Temp', 'v_q', ]\ndata:");
        let row = yaml.row(5, 0.0, 27, &[STEP, Value::Int(27), TEMP, Value::Float(3.25)]);
        assert_eq!(row, "  - [5, 27, 0.0253744022020714, 3.25, ]");
        assert_eq!(yaml.footer(), Some("..."));
    }

    #[test]
    fn formats() {
        let mut t = custom("step atoms temp v_q c_k");
        let values = [STEP, Value::Int(27), TEMP, Value::Float(3.25), KE];
        t.format_column("v_q", "%3.1f").unwrap();
        assert_eq!(t.row(5, 0.0, 27, &values), "         5          27   0.025374402   3.2  0.036651914  ");
        t.format_none();
        t.format_column("1", "%-12d|").unwrap();
        t.format_float("%-8.2f").unwrap();
        assert_eq!(t.row(5, 0.0, 27, &values), "5           |         27  0.03     3.25     0.04    ");
        let mut t = custom("step pe c_dsum");
        t.format_float("%20.15g").unwrap();
        // From the log of the reference deck pd_pmb_collide (columns step, pe, c_dsum).
        let values = [Value::Int(400), Value::Float(953197427.879776), Value::Float(0.582840536388923)];
        assert_eq!(t.row(400, 0.0, 455, &values), "       400      953197427.879776    0.582840536388923");
        t.format_none();
        t.format_line("%d a%g %20.15g|").unwrap();
        assert_eq!(t.row(400, 0.0, 455, &values), "400 a9.53197e+08    0.582840536388923|");
    }

    #[test]
    fn names_and_norm() {
        let mut t = custom("step atoms temp v_q c_k");
        t.rename("3", "T").unwrap();
        t.rename("v_q", "Q").unwrap();
        t.rename("step", "STEP").unwrap();
        assert_eq!(t.header(), "   STEP        Atoms          T              Q             c_k      ");
        t.rename_default();
        assert_eq!(t.header(), "   Step        Atoms         Temp           v_q            c_k      ");
        // norm yes: LAMMPS prints 0.036651914 where norm no prints 0.98960169 for 27 particles.
        let mut t = Layout::new(vec![Column::keyword("ke").unwrap()], Line::One);
        let total = [Value::Float(0.98960168588)];
        assert_eq!(t.row(0, 0.0, 27, &total).trim(), "0.98960169");
        t.norm = true;
        assert_eq!(t.row(0, 0.0, 27, &total).trim(), "0.036651914");
    }

    #[test]
    fn a_narrow_screen_gets_whole_columns() {
        let mut t = custom("step atoms temp v_q");
        let values = [STEP, Value::Int(27), TEMP, Value::Float(3.25)];
        // Cells end at 11, 23, 38 and 53 characters, the blanks between them included; a heading without those at its end.
        let fit = |t: &Layout, width| t.fitting(width, 27, &values);
        assert_eq!([10, 25, 37, 38, 80].map(|width| fit(&t, width)), [1, 2, 2, 3, 4]);
        assert_eq!(t.header_of(2), "   Step        Atoms");
        assert_eq!(t.row_of(3, 5, 0.0, 27, &values), "         5          27   0.025374402");
        t.format_float("%40.15g").unwrap();
        assert_eq!(fit(&t, 37), 2);
        assert_eq!(Layout::multi().fitting(10, 27, &values), 12);
    }

    #[test]
    fn nonsense_is_refused() {
        let mut t = custom("step temp v_q");
        assert!(t.format_line("%d %g").is_err());
        assert!(t.format_column("0", "%g").is_err());
        assert!(t.format_column("-4", "%g").is_err());
        assert!(t.format_column("tmp", "%g").unwrap_err().0[0].help[0].contains("temp"));
        assert!(t.format_column("-1", "%g").is_ok());
    }
}
