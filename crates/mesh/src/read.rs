//! Detects the format of a surface file, and reads its triangles.

use super::check::flat;
use super::{Triangle, obj, ply, stl, vtp};

/// File formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// STL as text or, if true, binary.
    Stl(bool),
    /// Wavefront OBJ.
    Obj,
    /// Polygon file format, in any of its three encodings.
    Ply,
    /// VTK XML `PolyData`.
    Vtp,
}

impl Format {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Format::Stl(_) => "STL",
            Format::Obj => "OBJ",
            Format::Ply => "PLY",
            Format::Vtp => "VTP",
        }
    }
}

/// Contents of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// The object's name, if the file gives one.
    pub name: String,
    /// Format of the file.
    pub format: Format,
    /// The triangles in file order; polygons are cut into fans.
    pub triangles: Vec<Triangle>,
    /// Numbers, from 0, of omitted triangles.
    pub left_out: Vec<usize>,
    /// Comment lines in a format that has none.
    pub comments: usize,
}

impl Surface {
    /// Omits degenerate triangles, which have no normal and enclose nothing.
    pub fn leave_out_flat(&mut self) {
        let flat = |t: &Triangle| flat(std::slice::from_ref(t)).is_some();
        self.left_out = (0..self.triangles.len()).filter(|k| flat(&self.triangles[*k])).collect();
        self.triangles.retain(|t| !flat(t));
    }

    /// The number in the file, from 1, of triangle `k`, from 0.
    pub fn number(&self, k: usize) -> usize {
        self.left_out.iter().fold(k, |k, out| k + usize::from(*out <= k)) + 1
    }
}

/// Reason why a file cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreadable {
    /// Assumed format.
    pub format: Format,
    /// The error.
    pub what: String,
}

impl Unreadable {
    /// The message for a file of this name.
    pub fn of(&self, file: &str) -> String {
        format!("`{file}` is no {} file: {}", self.format.name(), self.what)
    }
}

/// Reads the triangles of a file: PLY and VTP are recognized by their first bytes, OBJ by the file name
/// extension, everything else is STL.
///
/// # Errors
/// The error, with line or position.
pub fn read(file: &str, bytes: &[u8]) -> Result<Surface, Unreadable> {
    let start = bytes.trim_ascii_start();
    let ends = |end: &str| file.len() >= end.len() && file.to_ascii_lowercase().ends_with(end);
    let mut comments = 0;
    let (format, found) = if bytes.starts_with(b"ply") || ends(".ply") {
        (Format::Ply, ply::read(bytes).map(|t| (String::new(), t)))
    } else if start.starts_with(b"<") || ends(".vtp") {
        (Format::Vtp, vtp::read(bytes).map(|t| (String::new(), t)))
    } else if ends(".obj") {
        (Format::Obj, obj::read(bytes))
    } else {
        let binary = stl::is_binary(bytes);
        (
            Format::Stl(binary),
            stl::read(bytes).map(|read| {
                comments = read.comments;
                (read.name, read.triangles)
            }),
        )
    };
    let (name, triangles) = found.map_err(|what| Unreadable { format, what })?;
    if let Some(bad) = triangles.iter().position(|t| !t.as_flattened().iter().all(|x| x.is_finite())) {
        let what = format!("triangle {} has a coordinate that is no finite number", bad + 1);
        return Err(Unreadable { format, what });
    }
    Ok(Surface { name, format, triangles, left_out: vec![], comments })
}

/// Cuts a polygon into triangles around its first corner; fewer than three corners give none.
pub fn fan(polygon: &[usize], points: &[[f64; 3]], triangles: &mut Vec<Triangle>) -> Result<(), usize> {
    let place = |k: usize| points.get(k).copied().ok_or(k);
    for pair in polygon.get(1..).unwrap_or_default().windows(2) {
        triangles.push([place(polygon[0])?, place(pair[0])?, place(pair[1])?]);
    }
    Ok(())
}
