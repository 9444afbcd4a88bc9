//! Legacy VTK files (`.vtk`) with an unstructured grid, as text and as binary.

use super::super::file::{broken, not_read, place};
use super::cell::Shape;
use super::vtk_words::Words;
use super::{Element, Mesh, no_element};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_mesh::vtk::numbers::Kind;

/// Reads a file.
pub fn read(bytes: &[u8]) -> Result<Mesh> {
    let mut words = Words::new(bytes);
    if !words.line().starts_with(b"# vtk DataFile Version") {
        return Err(broken(0, "this is no legacy VTK file: it must begin with `# vtk DataFile Version`"));
    }
    words.line();
    let kind = words.expect("ASCII or BINARY")?;
    words.binary = match kind.text.to_ascii_uppercase().as_str() {
        "ASCII" => false,
        "BINARY" => true,
        _ => return fail(Code::SYNTAX, kind.span(), "ASCII or BINARY must stand here"),
    };
    Reader { words, mesh: Mesh::default(), grid: Grid::default(), target: None }.file()
}

/// Corners as the file has them.
#[derive(Default)]
pub struct Grid {
    /// The point numbers of all cells behind each other.
    pub connectivity: Vec<f64>,
    /// Where those of each cell end.
    pub ends: Vec<f64>,
    /// VTK's number of each cell's shape.
    pub kinds: Vec<f64>,
    /// Where each cell begins and ends in a text.
    pub places: Vec<(u32, u32)>,
}

/// VTK's shapes: what it is, and the order in which the corners come.
fn shape(kind: f64, count: usize) -> Option<(Element, Option<&'static [usize]>)> {
    use Element::{Cell, Less};
    // VTK counts the corners of pixels and voxels along the axes.
    const PIXEL: &[usize] = &[0, 1, 3, 2];
    const VOXEL: &[usize] = &[0, 1, 3, 2, 4, 5, 7, 6];
    let element = match kind as i64 {
        1 | 2 => return Some((Less("points", count), None)),
        3 | 4 | 21 => return Some((Less("lines", count), None)),
        5 => Cell(Shape::Triangle, 3),
        8 => return (count == 4).then_some((Cell(Shape::Quad, 4), Some(PIXEL))),
        9 => Cell(Shape::Quad, 4),
        10 => Cell(Shape::Tetrahedron, 4),
        11 => return (count == 8).then_some((Cell(Shape::Hexahedron, 8), Some(VOXEL))),
        12 => Cell(Shape::Hexahedron, 8),
        13 => Cell(Shape::Wedge, 6),
        14 => Cell(Shape::Pyramid, 5),
        22 => Cell(Shape::Triangle, 6),
        23 => Cell(Shape::Quad, 8),
        28 => Cell(Shape::Quad, 9),
        24 => Cell(Shape::Tetrahedron, 10),
        25 => Cell(Shape::Hexahedron, 20),
        29 => Cell(Shape::Hexahedron, 27),
        26 => Cell(Shape::Wedge, 15),
        32 => Cell(Shape::Wedge, 18),
        27 => Cell(Shape::Pyramid, 13),
        _ => return None,
    };
    Some((element, None))
}

/// Puts the cells of a grid into the mesh; points are there.
///
/// # Errors
/// Shapes that are not known, numbers of points that do not fit; `at` is blamed where no place is known.
pub fn cells(mesh: &mut Mesh, grid: &Grid, base: usize, at: Span) -> Result<()> {
    if grid.ends.len() != grid.kinds.len() {
        let text = format!("there are {} cells and shapes of {}", grid.ends.len(), grid.kinds.len());
        return fail(Code::INCOMPLETE, at, text);
    }
    let mut first = 0;
    for (k, (end, kind)) in grid.ends.iter().zip(&grid.kinds).enumerate() {
        let here = grid.places.get(k).map_or(at, |(a, b)| place(*a as usize, *b as usize));
        let number = k as u64;
        let end = *end as usize;
        let Some(nodes) = grid.connectivity.get(first..end) else {
            return fail(Code::INCOMPLETE, here, format!("cell {k} has more points than the file lists"));
        };
        first = end;
        let Some((element, order)) = shape(*kind, nodes.len()) else {
            return Err(no_element(
                here,
                format!("cell {k}, of VTK's kind {kind} with {} points,", nodes.len()),
            ));
        };
        if element.nodes() != nodes.len() {
            let text = format!(
                "cell {k} is of VTK's kind {kind} with {} points, not {}",
                element.nodes(),
                nodes.len()
            );
            return fail(Code::BAD_VALUE, here, text);
        }
        if let Some(bad) = nodes.iter().find(|n| !(**n >= 0.0 && n.fract() == 0.0)) {
            return fail(Code::BAD_VALUE, here, format!("cell {k} has point {bad}"));
        }
        let nodes: Vec<usize> = nodes.iter().map(|n| base.saturating_add(*n as usize)).collect();
        let nodes = order.map_or(nodes.clone(), |order| order.iter().map(|i| nodes[*i]).collect());
        mesh.add(element, &nodes, number, here)?;
    }
    Ok(())
}

/// What the arrays that follow belong to.
#[derive(Clone, Copy, PartialEq)]
enum Target {
    Cells(usize),
    Points(usize),
}

struct Reader<'a> {
    words: Words<'a>,
    mesh: Mesh,
    grid: Grid,
    target: Option<Target>,
}

impl Reader<'_> {
    fn file(mut self) -> Result<Mesh> {
        let word = self.words.expect("DATASET")?;
        let set = self.words.expect("the kind of data set")?;
        if !word.text.eq_ignore_ascii_case("DATASET") {
            return fail(Code::SYNTAX, word.span(), "DATASET must stand here");
        }
        if !set.text.eq_ignore_ascii_case("UNSTRUCTURED_GRID") {
            let d = not_read(set.span(), format!("a mesh from a data set {}", set.text));
            return Err(d.help("an UNSTRUCTURED_GRID is read").into());
        }
        let mut arrays: Vec<(String, Vec<f64>)> = vec![];
        let mut cells_at = None;
        while let Some(word) = self.words.next() {
            match word.text.to_ascii_uppercase().as_str() {
                "POINTS" => self.points()?,
                "CELLS" => {
                    cells_at = Some(word.span());
                    self.cells()?;
                }
                "CELL_TYPES" => {
                    let count = self.words.count("the number of cells")?;
                    self.grid.kinds = self.words.block(Kind::I32, count, "CELL_TYPES")?.0;
                }
                "CELL_DATA" => self.target = Some(Target::Cells(self.words.count("the number of cells")?)),
                "POINT_DATA" => self.target = Some(Target::Points(self.words.count("the number of points")?)),
                "METADATA" => while !self.words.line().is_empty() || self.first_of_metadata() {},
                name => {
                    let found = self.array(name, word.span())?;
                    if matches!(self.target, Some(Target::Cells(_))) {
                        arrays.extend(found);
                    }
                }
            }
        }
        let Some(at) = cells_at else {
            return Err(broken(self.words.end(), "the file has no CELLS"));
        };
        cells(&mut self.mesh, &self.grid, 0, at)?;
        self.mesh.arrays = on_cells(arrays, &self.grid, &self.mesh);
        Ok(self.mesh)
    }

    /// Behind the word METADATA the line ends; the section itself ends with an empty line.
    fn first_of_metadata(&self) -> bool {
        self.words.peek().is_some_and(|w| matches!(w.text, "INFORMATION" | "COMPONENT_NAMES"))
    }

    fn points(&mut self) -> Result<()> {
        let count = self.words.count("the number of points")?;
        let kind = self.words.kind()?;
        let (x, places) = self.words.block(kind, 3 * count, "POINTS")?;
        if let Some(k) = x.iter().position(|x| !x.is_finite()) {
            let at = places
                .get(k)
                .map_or(place(self.words.end(), self.words.end()), |(a, b)| place(*a as usize, *b as usize));
            return fail(Code::BAD_NUMBER, at, format!("a coordinate of point {} is no number", k / 3));
        }
        self.mesh.points = x.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect();
        Ok(())
    }

    fn cells(&mut self) -> Result<()> {
        let count = self.words.count("the number of cells")?;
        let size = self.words.count("the length of the list of cells")?;
        let grid = &mut self.grid;
        if self.words.peek().is_some_and(|w| w.text.eq_ignore_ascii_case("OFFSETS")) {
            self.words.next();
            let kind = self.words.kind()?;
            let (offsets, _) = self.words.block(kind, count, "OFFSETS")?;
            let word = self.words.expect("CONNECTIVITY")?;
            if !word.text.eq_ignore_ascii_case("CONNECTIVITY") {
                return fail(Code::SYNTAX, word.span(), "CONNECTIVITY must stand here");
            }
            let kind = self.words.kind()?;
            grid.connectivity = self.words.block(kind, size, "CONNECTIVITY")?.0;
            grid.ends = offsets.into_iter().skip(1).collect();
            return Ok(());
        }
        let (list, places) = self.words.block(Kind::I32, size, "CELLS")?;
        let mut at = 0;
        while at < list.len() {
            let n = list[at];
            let end = (at + 1).saturating_add(n.max(0.0) as usize);
            let Some(nodes) = list.get(at + 1..end) else {
                let text = format!("cell {} has more points than the list of cells", grid.ends.len());
                let at = places.get(at).map_or(place(self.words.end(), self.words.end()), |(a, b)| {
                    place(*a as usize, *b as usize)
                });
                return fail(Code::INCOMPLETE, at, text);
            };
            grid.connectivity.extend(nodes);
            grid.ends.push(grid.connectivity.len() as f64);
            if let (Some((a, _)), Some((_, b))) = (places.get(at), places.get(end - 1)) {
                grid.places.push((*a, *b));
            }
            at = end;
        }
        if grid.ends.len() != count {
            let text = format!("CELLS promises {count} cells and lists {}", grid.ends.len());
            return Err(broken(self.words.end(), text));
        }
        Ok(())
    }

    /// Arrays of cells or points that open with this word; those of one number are kept.
    fn array(&mut self, word: &str, at: Span) -> Result<Vec<(String, Vec<f64>)>> {
        let count = match self.target {
            Some(Target::Cells(n) | Target::Points(n)) => n,
            None if word == "FIELD" => 0,
            None => return fail(Code::SYNTAX, at, format!("`{word}` opens no section of a grid")),
        };
        let mut name = || self.words.expect("a name").map(|w| decoded(w.text));
        Ok(match word {
            "SCALARS" => {
                let name = name()?;
                let kind = self.words.kind()?;
                let per = match self.words.peek().and_then(|w| w.text.parse::<usize>().ok()) {
                    Some(per) => {
                        self.words.next();
                        per.clamp(1, 4)
                    }
                    None => 1,
                };
                if self.words.peek().is_some_and(|w| w.text.eq_ignore_ascii_case("LOOKUP_TABLE")) {
                    self.words.next();
                    self.words.expect("the name of a table")?;
                }
                let values = self.words.block(kind, count.saturating_mul(per), "SCALARS")?.0;
                if per == 1 { vec![(name, values)] } else { vec![] }
            }
            "VECTORS" | "NORMALS" | "TENSORS" => {
                name()?;
                let kind = self.words.kind()?;
                let per = if word == "TENSORS" { 9 } else { 3 };
                self.words.block(kind, count.saturating_mul(per), word)?;
                vec![]
            }
            "LOOKUP_TABLE" => {
                name()?;
                let size = self.words.count("the length of the table")?;
                self.words.block(Kind::U8, size.saturating_mul(4), word)?;
                vec![]
            }
            "GLOBAL_IDS" | "PEDIGREE_IDS" => {
                let name = name()?;
                let kind = self.words.kind()?;
                vec![(name, self.words.block(kind, count, word)?.0)]
            }
            "FIELD" => {
                name()?;
                self.field()?
            }
            _ => {
                return fail(
                    Code::NOT_SUPPORTED,
                    at,
                    format!("{word} of a legacy VTK file is not in perigrain yet"),
                );
            }
        })
    }

    fn field(&mut self) -> Result<Vec<(String, Vec<f64>)>> {
        let mut kept = vec![];
        for _ in 0..self.words.count("the number of arrays")? {
            while self.words.peek().is_some_and(|w| w.text == "METADATA") {
                self.words.next();
                while !self.words.line().is_empty() || self.first_of_metadata() {}
            }
            let name = decoded(self.words.expect("the name of an array")?.text);
            let per = self.words.count("the number of components")?;
            let tuples = self.words.count("the length of the array")?;
            let kind = self.words.kind()?;
            let values = self.words.block(kind, per.saturating_mul(tuples), "an array")?.0;
            if per == 1 {
                kept.push((name, values));
            }
        }
        Ok(kept)
    }
}

/// A name in which VTK writes blanks as %20.
fn decoded(name: &str) -> String {
    name.replace("%20", " ").replace("%22", "\"")
}

/// The arrays of all that the file calls cells, for those that are.
pub fn on_cells(arrays: Vec<(String, Vec<f64>)>, grid: &Grid, mesh: &Mesh) -> Vec<(String, Vec<f64>)> {
    let is_cell = |kind: &f64| shape(*kind, 0).is_none_or(|(e, _)| matches!(e, Element::Cell(..)));
    let kept: Vec<bool> = grid.kinds.iter().map(is_cell).collect();
    let pick = |values: Vec<f64>| -> Vec<f64> {
        values.into_iter().zip(&kept).filter(|(_, keep)| **keep).map(|(x, _)| x).collect()
    };
    let arrays = arrays.into_iter().filter(|(_, values)| values.len() == kept.len());
    arrays.map(|(name, values)| (name, pick(values))).filter(|(_, v)| v.len() == mesh.count()).collect()
}
