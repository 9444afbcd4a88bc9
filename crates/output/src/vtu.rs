//! `.vtu` and `.vtp` files: points with data, appended raw, zlib blocks compressed in parallel; lists of pieces `.pvtu` and `.pvtp`, and
//! `.pvd` time series.

use std::io::Write;
use std::path::{Path, PathBuf};

use flate2::{Compression, write::ZlibEncoder};

use super::{file, make};
use perigrain_base::diag::Result;

/// Bytes per compressed block; VTK's own default, so that readers keep little in memory.
const BLOCK: usize = 1 << 15;

/// Values of a data array, one entry per point.
#[derive(Clone, Copy, Debug)]
pub enum Values<'a> {
    /// One double each.
    F64(&'a [f64]),
    /// One float each.
    F32(&'a [f32]),
    /// One whole number each.
    I32(&'a [i32]),
    /// Three doubles each.
    Vectors(&'a [[f64; 3]]),
    /// Three doubles each, stored as floats.
    Vectors32(&'a [[f64; 3]]),
}

/// A named array of point data.
#[derive(Clone, Copy, Debug)]
pub struct Array<'a> {
    /// Name shown by readers.
    pub name: &'a str,
    /// One entry per point.
    pub values: Values<'a>,
}

/// How a file is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Storage {
    /// Whether blocks are compressed.
    pub compress: bool,
    /// 1 (fast) to 9 (small).
    pub level: u32,
}

impl Default for Storage {
    fn default() -> Self {
        Self { compress: true, level: 3 }
    }
}

impl Values<'_> {
    fn kind(&self) -> &'static str {
        match self {
            Self::F64(_) | Self::Vectors(_) => "Float64",
            Self::F32(_) | Self::Vectors32(_) => "Float32",
            Self::I32(_) => "Int32",
        }
    }

    fn components(&self) -> usize {
        if matches!(self, Self::Vectors(_) | Self::Vectors32(_)) { 3 } else { 1 }
    }

    fn size(&self) -> usize {
        match self {
            Self::F64(v) => 8 * v.len(),
            Self::F32(v) => 4 * v.len(),
            Self::I32(v) => 4 * v.len(),
            Self::Vectors(v) => 24 * v.len(),
            Self::Vectors32(v) => 12 * v.len(),
        }
    }

    /// Little-endian bytes `from..to`, which fall on whole numbers.
    fn bytes(&self, from: usize, to: usize) -> Vec<u8> {
        match self {
            Self::F64(v) => v[from / 8..to / 8].iter().flat_map(|x| x.to_le_bytes()).collect(),
            Self::F32(v) => v[from / 4..to / 4].iter().flat_map(|x| x.to_le_bytes()).collect(),
            Self::I32(v) => v[from / 4..to / 4].iter().flat_map(|x| x.to_le_bytes()).collect(),
            Self::Vectors(v) => {
                v.as_flattened()[from / 8..to / 8].iter().flat_map(|x| x.to_le_bytes()).collect()
            }
            Self::Vectors32(v) => {
                let flat = &v.as_flattened()[from / 4..to / 4];
                flat.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect()
            }
        }
    }
}

/// Arrays that every file has besides the user's: points and one vertex cell per point.
enum Source<'a> {
    Values(Values<'a>),
    /// 0, 1, 2, … as Int32: the connectivity.
    Counting {
        from: usize,
        count: usize,
    },
    /// The VTK type of a vertex, as UInt8.
    Vertices(usize),
}

impl Source<'_> {
    fn size(&self) -> usize {
        match self {
            Self::Values(v) => v.size(),
            Self::Counting { count, .. } => 4 * count,
            Self::Vertices(count) => *count,
        }
    }

    fn bytes(&self, from: usize, to: usize) -> Vec<u8> {
        match self {
            Self::Values(v) => v.bytes(from, to),
            Self::Counting { from: first, .. } => {
                (from / 4..to / 4).flat_map(|k| ((first + k) as i32).to_le_bytes()).collect()
            }
            Self::Vertices(_) => vec![1; to - from],
        }
    }

    /// The appended form: header of sizes, then the blocks.
    fn appended(&self, storage: Storage) -> std::io::Result<Vec<u8>> {
        let size = self.size();
        if !storage.compress {
            let mut all = (size as u64).to_le_bytes().to_vec();
            for block in make(size.div_ceil(BLOCK), |k| self.bytes(k * BLOCK, size.min((k + 1) * BLOCK))) {
                all.extend_from_slice(&block);
            }
            return Ok(all);
        }
        let blocks = make(size.div_ceil(BLOCK), |k| {
            let raw = self.bytes(k * BLOCK, size.min((k + 1) * BLOCK));
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(storage.level.min(9)));
            encoder.write_all(&raw)?;
            encoder.finish()
        });
        let blocks = blocks.into_iter().collect::<std::io::Result<Vec<_>>>()?;
        let mut all = vec![];
        for word in [blocks.len(), BLOCK, size % BLOCK].into_iter().chain(blocks.iter().map(Vec::len)) {
            all.extend_from_slice(&(word as u64).to_le_bytes());
        }
        for block in &blocks {
            all.extend_from_slice(block);
        }
        Ok(all)
    }
}

/// The kind of data set that the points are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grid {
    /// `.vtu`: an unstructured grid of vertex cells.
    Unstructured,
    /// `.vtp`: polygonal data of vertices.
    Poly,
}

impl Grid {
    /// That of files with this name, or of the pieces of a list with this name.
    pub fn of(path: &Path) -> Self {
        match ending(path) {
            "vtp" | "pvtp" => Self::Poly,
            _ => Self::Unstructured,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Unstructured => "UnstructuredGrid",
            Self::Poly => "PolyData",
        }
    }

    /// The numbers of points and cells, one for each point.
    fn counts(self, n: usize) -> String {
        match self {
            Self::Unstructured => format!("NumberOfPoints=\"{n}\" NumberOfCells=\"{n}\""),
            Self::Poly => {
                let none = "NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\"";
                format!("NumberOfPoints=\"{n}\" NumberOfVerts=\"{n}\" {none}")
            }
        }
    }
}

fn ending(path: &Path) -> &str {
    path.extension().and_then(|end| end.to_str()).unwrap_or_default()
}

/// The file of points that belongs to a list of pieces `NAME.pvtu` or `NAME.pvtp`: `NAME_0.vtu` or `NAME_0.vtp`.
pub fn piece(path: &Path) -> Option<PathBuf> {
    let end = ending(path).strip_prefix('p').filter(|end| ["vtu", "vtp"].contains(end))?;
    let name = path.file_stem()?.to_str()?;
    Some(path.with_file_name(format!("{name}_0.{end}")))
}

/// Writes a list of one piece, which [`write`] has written.
pub fn write_list(path: &Path, piece: &Path, points: Values<'_>, arrays: &[Array<'_>]) -> Result<()> {
    let name = format!("P{}", Grid::of(path).name());
    let entry = |name: &str, values: &Values<'_>| {
        let parts = match values.components() {
            1 => String::new(),
            parts => format!(" NumberOfComponents=\"{parts}\""),
        };
        format!("      <PDataArray type=\"{}\" Name=\"{}\"{parts}/>\n", values.kind(), escape(name))
    };
    let data: String = arrays.iter().map(|array| entry(array.name, &array.values)).collect();
    let source = piece.file_name().unwrap_or_default().to_string_lossy();
    let xml = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{name}\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n  <{name} GhostLevel=\"0\">\n    <PPointData>\n{data}    </PPointData>\n    <PPoints>\n{}    \
         </PPoints>\n    <Piece Source=\"{}\"/>\n  </{name}>\n</VTKFile>\n",
        entry("Points", &points),
        escape(&source)
    );
    file::replace(path, |w| w.write_all(xml.as_bytes()))
}

/// Writes points with data at a time to a file that appears whole or not at all; its ending chooses the kind of data set. All
/// arrays have one entry per point.
pub fn write(
    path: &Path,
    time: f64,
    points: Values<'_>,
    arrays: &[Array<'_>],
    storage: Storage,
) -> Result<()> {
    let n = points.size() / if points.kind() == "Float32" { 12 } else { 24 };
    let grid = Grid::of(path);
    let mut body: Vec<Vec<u8>> = vec![];
    let mut offset = 0;
    let mut outcome = Ok(());
    let mut entry = |name: &str, kind: &str, components: usize, source: &Source<'_>| {
        let bytes = source.appended(storage).unwrap_or_else(|e| {
            outcome = Err(e);
            vec![]
        });
        let parts =
            if components > 1 { format!(" NumberOfComponents=\"{components}\"") } else { String::new() };
        let line = format!(
            "        <DataArray type=\"{kind}\" Name=\"{}\"{parts} format=\"appended\" offset=\"{offset}\"/>\n",
            escape(name)
        );
        offset += bytes.len();
        body.push(bytes);
        line
    };
    let values = |v| Source::Values(v);
    let name = grid.name();
    let compressor = if storage.compress { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
    let mut xml = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{name}\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\"{compressor}>\n  <{name}>\n    <FieldData>\n      \
         <DataArray type=\"Float64\" Name=\"TIME\" NumberOfTuples=\"1\" format=\"ascii\">{time:?}</DataArray>\n    \
         </FieldData>\n    <Piece {}>\n      <PointData>\n",
        grid.counts(n)
    );
    for a in arrays {
        xml += &entry(a.name, a.values.kind(), a.values.components(), &values(a.values));
    }
    xml += "      </PointData>\n      <Points>\n";
    xml += &entry("Points", points.kind(), 3, &values(points));
    let cells = if grid == Grid::Poly { "Verts" } else { "Cells" };
    xml += &format!("      </Points>\n      <{cells}>\n");
    xml += &entry("connectivity", "Int32", 1, &Source::Counting { from: 0, count: n });
    xml += &entry("offsets", "Int32", 1, &Source::Counting { from: 1, count: n });
    if grid == Grid::Unstructured {
        xml += &entry("types", "UInt8", 1, &Source::Vertices(n));
    }
    xml += &format!("      </{cells}>\n    </Piece>\n  </{name}>\n  <AppendedData encoding=\"raw\">\n_");
    outcome.map_err(|e| file::trouble("compress", path, &e))?;
    file::replace(path, |w| {
        w.write_all(xml.as_bytes())?;
        for bytes in &body {
            w.write_all(bytes)?;
        }
        w.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
    })
}

/// A `.pvd` file that lists snapshots with their times; rewritten whole after each one.
#[derive(Clone, Debug)]
pub struct Series {
    path: PathBuf,
    entries: Vec<(f64, PathBuf)>,
}

impl Series {
    /// A series that is still empty; nothing is written yet.
    pub fn new(path: PathBuf) -> Self {
        Self { path, entries: vec![] }
    }

    /// Adds a snapshot (or replaces the one in the same file) and rewrites the list.
    pub fn add(&mut self, time: f64, snapshot: &Path) -> Result<()> {
        self.entries.retain(|e| e.1 != snapshot);
        self.entries.push((time, snapshot.into()));
        let folder = self.path.parent();
        let mut xml = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  \
             <Collection>\n",
        );
        for (time, file) in &self.entries {
            let near = folder.and_then(|f| file.strip_prefix(f).ok()).unwrap_or(file);
            let name = escape(&near.to_string_lossy());
            xml += &format!("    <DataSet timestep=\"{time:?}\" group=\"\" part=\"0\" file=\"{name}\"/>\n");
        }
        xml += "  </Collection>\n</VTKFile>\n";
        file::replace(&self.path, |w| w.write_all(xml.as_bytes()))
    }
}

/// Text inside an XML attribute.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_blocks_have_no_rest() {
        // An array of whole blocks has no partial one, and its size is written as 0 as VTK does (vtkio 0.7 loses
        // such arrays; VTK 9.6 through PyVista reads them).
        let d = vec![0.25; BLOCK / 4];
        let bytes = Source::Values(Values::F64(&d)).appended(Storage::default()).unwrap();
        let word = |k: usize| u64::from_le_bytes(bytes[8 * k..8 * k + 8].try_into().unwrap()) as usize;
        assert_eq!([word(0), word(1), word(2)], [2, BLOCK, 0]);
    }

    #[test]
    fn a_list_names_its_piece() {
        let dir = tempfile::tempdir().unwrap();
        for (list, own, kind) in
            [("a_10.pvtp", "a_10_0.vtp", "PPolyData"), ("b.2.pvtu", "b.2_0.vtu", "PUnstructuredGrid")]
        {
            let (path, own) = (dir.path().join(list), dir.path().join(own));
            assert_eq!(piece(&path).as_deref(), Some(&*own));
            let arrays = [Array { name: "f_Temp[0]", values: Values::F64(&[300.0]) }];
            write_list(&path, &own, Values::Vectors(&[[0.0; 3]]), &arrays).unwrap();
            let text = std::fs::read_to_string(&path).unwrap();
            for part in [
                format!("<VTKFile type=\"{kind}\""),
                format!("<Piece Source=\"{}\"/>", own.file_name().unwrap().to_str().unwrap()),
                "<PDataArray type=\"Float64\" Name=\"f_Temp[0]\"/>".into(),
                "<PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>".into(),
            ] {
                assert!(text.contains(&part), "{part}: {text}");
            }
        }
        assert_eq!((piece(Path::new("a.vtu")), piece(Path::new("a.pvd"))), (None, None));
    }

    #[test]
    fn series() {
        let dir = tempfile::tempdir().unwrap();
        let mut series = Series::new(dir.path().join("run.pvd"));
        for (k, time) in [0.0, 1e-6, 2e-6].into_iter().enumerate() {
            series.add(time, &dir.path().join(format!("run.{k}.vtu"))).unwrap();
        }
        series.add(2.5e-6, &dir.path().join("run.2.vtu")).unwrap();
        let text = std::fs::read_to_string(dir.path().join("run.pvd")).unwrap();
        assert_eq!(text.matches("<DataSet").count(), 3);
        assert!(text.contains("timestep=\"2.5e-6\" group=\"\" part=\"0\" file=\"run.2.vtu\""), "{text}");
    }
}
