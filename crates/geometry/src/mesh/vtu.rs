//! VTK's XML files with an unstructured grid (`.vtu`).

use super::super::file::place;
use super::Mesh;
use super::vtk::{Grid, cells, on_cells};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_mesh::vtk::xml::{Array, Document};

/// Reads a file.
pub fn read(bytes: &[u8]) -> Result<Mesh> {
    let document = Document::read(bytes, "UnstructuredGrid")?;
    let mut mesh = Mesh::default();
    let mut whole = Grid::default();
    let mut arrays: Vec<(String, Vec<f64>)> = vec![];
    for piece in &document.pieces {
        let at = piece.at;
        let count = piece.count("NumberOfCells")?;
        let need = |name: &str, of: &str| match document.array(piece, of, name) {
            Some(array) => Ok(array),
            None => fail(Code::INCOMPLETE, at, format!("this piece has no array {name} in {of}")),
        };
        let x = document.numbers(need("", "Points")?)?;
        let base = mesh.points.len();
        if let Some(k) = x.iter().position(|x| !x.is_finite()) {
            return fail(Code::BAD_NUMBER, at, format!("a coordinate of point {} is no number", k / 3));
        }
        check(x.len(), 3 * piece.count("NumberOfPoints")?, "coordinates", at)?;
        mesh.points.extend(x.chunks_exact(3).map(|x| [x[0], x[1], x[2]]));
        let grid = Grid {
            connectivity: document.numbers(need("connectivity", "Cells")?)?,
            ends: document.numbers(need("offsets", "Cells")?)?,
            kinds: document.numbers(need("types", "Cells")?)?,
            places: vec![],
        };
        check(grid.ends.len(), count, "offsets", at)?;
        let first = mesh.count();
        cells(&mut mesh, &grid, base, at)?;
        let own = document.arrays(piece, "CellData").filter(|a| a.components == 1);
        let own =
            own.map(|a: &Array| Ok((a.name.clone(), document.numbers(a)?))).collect::<Result<Vec<_>>>()?;
        whole.kinds.extend(&grid.kinds);
        join(&mut arrays, own, first == 0);
    }
    mesh.arrays = on_cells(arrays, &whole, &mesh);
    Ok(mesh)
}

/// Puts the arrays of one more piece behind those of the same names.
fn join(all: &mut Vec<(String, Vec<f64>)>, own: Vec<(String, Vec<f64>)>, first: bool) {
    for (name, values) in own {
        match all.iter_mut().find(|(n, _)| *n == name) {
            Some((_, list)) => list.extend(values),
            None if first => all.push((name, values)),
            None => {}
        }
    }
}

fn check(have: usize, promised: usize, what: &str, at: Span) -> Result<()> {
    if have == promised {
        return Ok(());
    }
    fail(
        Code::INCOMPLETE,
        place(at.start as usize, at.end as usize),
        format!("there are {have} {what}, the piece promises {promised}"),
    )
}
