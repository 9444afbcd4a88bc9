//! `.vtu` files: points with data, appended raw, zlib blocks compressed in parallel; `.pvd` time series.

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

/// Writes points with data at a time to a file that appears whole or not at all. All arrays have one entry
/// per point.
pub fn write(
    path: &Path,
    time: f64,
    points: Values<'_>,
    arrays: &[Array<'_>],
    storage: Storage,
) -> Result<()> {
    let n = points.size() / if points.kind() == "Float32" { 12 } else { 24 };
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
    let compressor = if storage.compress { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
    let mut xml = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\"{compressor}>\n  <UnstructuredGrid>\n    <FieldData>\n      \
         <DataArray type=\"Float64\" Name=\"TIME\" NumberOfTuples=\"1\" format=\"ascii\">{time:?}</DataArray>\n    \
         </FieldData>\n    <Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{n}\">\n      <PointData>\n"
    );
    for a in arrays {
        xml += &entry(a.name, a.values.kind(), a.values.components(), &values(a.values));
    }
    xml += "      </PointData>\n      <Points>\n";
    xml += &entry("Points", points.kind(), 3, &values(points));
    xml += "      </Points>\n      <Cells>\n";
    xml += &entry("connectivity", "Int32", 1, &Source::Counting { from: 0, count: n });
    xml += &entry("offsets", "Int32", 1, &Source::Counting { from: 1, count: n });
    xml += &entry("types", "UInt8", 1, &Source::Vertices(n));
    xml += "      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_";
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
