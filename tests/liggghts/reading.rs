//! What a run of LIGGGHTS or of perigrain has printed and written, as numbers.

use std::collections::BTreeMap;

/// Rows of a table, by their columns.
#[derive(Debug, Default, PartialEq)]
pub struct Frame {
    pub columns: Vec<String>,
    pub rows: Vec<Vec<f64>>,
    /// How many rows there are, where they are not listed.
    pub count: Option<usize>,
}

/// A field of a surface, by triangle.
pub type Fields = BTreeMap<String, Vec<f64>>;

/// The numbers of one run.
#[derive(Debug, Default)]
pub struct Golden {
    /// Rows of the step table, those of setups among them.
    pub thermo: Vec<Vec<f64>>,
    /// Snapshots of the dump by step.
    pub dumps: BTreeMap<i64, Frame>,
    /// Corners of surfaces by step, three numbers each.
    pub surfaces: BTreeMap<i64, Vec<f64>>,
    /// Fields of surfaces by step.
    pub fields: BTreeMap<i64, Fields>,
}

/// A line of numbers alone.
pub fn numbers(line: &str) -> Option<Vec<f64>> {
    let row: Vec<f64> = line.split_whitespace().map(str::parse).collect::<Result<_, _>>().ok()?;
    (!row.is_empty()).then_some(row)
}

/// Reads `NAME.txt`, whose lines `tests/liggghts/golden/README.md` explains.
pub fn golden(text: &str) -> Golden {
    let mut out = Golden::default();
    let (mut step, mut field) = (None, None);
    for line in text.lines() {
        let mut words = line.split_whitespace();
        let first = words.next().unwrap_or("");
        if first == "step" {
            let at: i64 = words.next().unwrap().parse().unwrap();
            let columns = words.skip(1).map(String::from).collect();
            out.dumps.insert(at, Frame { columns, ..Frame::default() });
            (step, field) = (Some(at), None);
        } else if let Some(at) = first.strip_suffix(".stl") {
            let corners = line.split(['|', ' ']).filter_map(|w| w.parse().ok()).collect();
            out.surfaces.insert(at.parse().unwrap(), corners);
        } else if let Some(at) = first.strip_suffix(".vtk") {
            step = at.parse().ok();
            field = Some(String::new());
            out.fields.insert(step.unwrap(), Fields::new());
        } else if let Some(count) = line.strip_prefix('(').and_then(|l| l.strip_suffix(" rows)")) {
            out.dumps.get_mut(&step.unwrap()).unwrap().count = count.parse().ok();
        } else if let Some(row) = numbers(line) {
            match (step, &field) {
                (None, _) => out.thermo.push(row),
                (Some(at), None) => out.dumps.get_mut(&at).unwrap().rows.push(row),
                (Some(at), Some(name)) => {
                    out.fields.get_mut(&at).unwrap().entry(name.clone()).or_default().extend(row);
                }
            }
        } else if field.is_some() && words.clone().count() == 3 {
            field = Some(first.to_string());
        }
    }
    out
}

/// Snapshots of a dump in LAMMPS' text format.
pub fn dump(text: &str) -> BTreeMap<i64, Frame> {
    let snapshots = text.split("ITEM: TIMESTEP\n").skip(1);
    let frame = |snapshot: &str| {
        let step = snapshot.lines().next().unwrap().trim().parse().unwrap();
        let table = snapshot.rsplit("ITEM: ").next().unwrap();
        let columns = table.lines().next().unwrap().split_whitespace().skip(1).map(String::from).collect();
        let rows: Vec<Vec<f64>> = table.lines().skip(1).filter_map(numbers).collect();
        (step, Frame { columns, rows, count: None })
    };
    snapshots.map(frame).collect()
}

/// Corners of an STL file, three numbers each.
pub fn stl(text: &str) -> Vec<f64> {
    let corners = text.lines().filter_map(|l| l.trim().strip_prefix("vertex"));
    corners.flat_map(|l| l.split_whitespace().map(|w| w.parse().unwrap())).collect()
}

/// Fields of the cells of a legacy VTK file.
pub fn vtk(text: &str) -> Fields {
    let mut out = Fields::new();
    let mut name = None;
    for line in text.split("CELL_DATA").nth(1).unwrap_or("").lines().skip(1) {
        let words: Vec<&str> = line.split_whitespace().collect();
        match (numbers(line), &name) {
            (Some(row), Some(name)) => out.entry(String::clone(name)).or_default().extend(row),
            (None, _) if words.len() == 4 && words[0] != "FIELD" => name = Some(words[0].to_string()),
            (None, _) if words.first() == Some(&"SCALARS") => name = Some(words[1].to_string()),
            (None, _) if words.first() == Some(&"VECTORS") => name = Some(words[1].to_string()),
            _ => {}
        }
    }
    out
}

#[test]
fn golden_files_are_read_whole() {
    let text = "# LIGGGHTS\nthermo Step Atoms\n0 1\n1 2\nstep 1 ATOMS id x y\n1 0.5 -1\n(3 rows)\n\
                7.stl 0 0 1 | 1 0 0\n1.vtk\nFIELD FieldData 1\nstress 3 1 double\n1 2 3\n";
    let g = golden(text);
    assert_eq!(g.thermo, [[0.0, 1.0], [1.0, 2.0]]);
    assert_eq!((g.dumps[&1].rows.len(), g.dumps[&1].count), (1, Some(3)));
    assert_eq!(g.surfaces[&7], [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
    assert_eq!(g.fields[&1]["stress"], [1.0, 2.0, 3.0]);
}
