//! Detects the format of a surface file, and reads its triangles.

use super::check::flat;
use super::{Triangle, legacy, obj, ply, stl, vtp};
use thiserror::Error;

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
    /// VTK's legacy text format.
    Vtk,
}

impl Format {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Format::Stl(_) => "STL",
            Format::Obj => "OBJ",
            Format::Ply => "PLY",
            Format::Vtp => "VTP",
            Format::Vtk => "VTK",
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

/// Why the triangles of a file cannot be read. Messages continue the file's name: `gear.stl` "is no STL file: …".
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Error {
    /// No STL file, as text or binary.
    #[error("is no STL file: {0}")]
    Stl(#[from] stl::Error),
    /// No OBJ file.
    #[error("is no OBJ file: {0}")]
    Obj(#[from] obj::Error),
    /// No PLY file.
    #[error("is no PLY file: {0}")]
    Ply(#[from] ply::Error),
    /// No VTP file.
    #[error("is no VTP file: {0}")]
    Vtp(#[from] vtp::Error),
    /// No VTK file.
    #[error("is no VTK file: {0}")]
    Vtk(#[from] legacy::Error),
    /// A corner at no place.
    #[error("is no {name} file: triangle {number} has a coordinate that is no finite number", name = .format.name())]
    NotFinite {
        /// The format of the file.
        format: Format,
        /// The number of the triangle, from 1.
        number: usize,
    },
}

/// Reads the triangles of a file: PLY, VTP and VTK are recognized by their first bytes, OBJ by the file name
/// extension, everything else is STL.
///
/// # Errors
/// The error, with line or position.
pub fn read(file: &str, bytes: &[u8]) -> Result<Surface, Error> {
    let start = bytes.trim_ascii_start();
    let ends = |end: &str| file.len() >= end.len() && file.to_ascii_lowercase().ends_with(end);
    let mut comments = 0;
    let (format, name, triangles) = if bytes.starts_with(b"ply") || ends(".ply") {
        (Format::Ply, String::new(), ply::read(bytes)?)
    } else if start.starts_with(legacy::MARK) {
        (Format::Vtk, String::new(), legacy::read(bytes)?)
    } else if start.starts_with(b"<") || ends(".vtp") {
        (Format::Vtp, String::new(), vtp::read(bytes)?)
    } else if ends(".obj") {
        let (name, triangles) = obj::read(bytes)?;
        (Format::Obj, name, triangles)
    } else {
        let read = stl::read(bytes)?;
        comments = read.comments;
        (Format::Stl(stl::is_binary(bytes)), read.name, read.triangles)
    };
    if let Some(bad) = triangles.iter().position(|t| !t.as_flattened().iter().all(|x| x.is_finite())) {
        return Err(Error::NotFinite { format, number: bad + 1 });
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
