//! Volume meshes: points, cells, and the file's data on cells, for all formats.

mod abaqus;
pub mod cell;
mod gmsh;
mod gmsh4;
pub mod types;
mod vtk;
mod vtk_words;
mod vtu;

use super::file::{File, not_read, place};
use cell::Shape;
use perigrain_base::diag::{Code, Result, Span, fail};
use std::collections::BTreeMap;

/// Cells of a file that have a name or a number together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Set {
    /// Its name, empty where it has only a number.
    pub name: String,
    /// Its number, where it has one.
    pub number: Option<i64>,
    /// The cells, as they come in the mesh, in their order.
    pub cells: Vec<u32>,
}

/// A volume mesh.
#[derive(Debug, Default)]
pub struct Mesh {
    /// The points.
    pub points: Vec<[f64; 3]>,
    /// The shape of each cell.
    pub shapes: Vec<Shape>,
    /// The number that the file gives each cell.
    pub numbers: Vec<u64>,
    /// Where each cell stands in the file, where it is a text: the bytes of its line.
    pub places: Vec<(u32, u32)>,
    /// The corners of all cells, behind each other.
    corners: Vec<u32>,
    /// Where those of each cell begin.
    first: Vec<u32>,
    /// Physical groups or element sets.
    pub sets: Vec<Set>,
    /// Numbers by cell, with names.
    pub arrays: Vec<(String, Vec<f64>)>,
    /// What else was in the file and is no cell: lines, points.
    pub skipped: BTreeMap<&'static str, usize>,
    /// Cells with nodes between corners.
    pub curved: usize,
}

/// What a file calls a shape: the shape, and its nodes, the corners first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Element {
    /// A cell with so many nodes.
    Cell(Shape, usize),
    /// Something without area, with so many nodes.
    Less(&'static str, usize),
}

impl Element {
    /// Its nodes.
    pub fn nodes(self) -> usize {
        match self {
            Element::Cell(_, n) | Element::Less(_, n) => n,
        }
    }
}

impl Mesh {
    /// A cell with all of its nodes, or what is less than a cell.
    ///
    /// # Errors
    /// Nodes that there are not.
    pub fn add(&mut self, element: Element, nodes: &[usize], number: u64, at: Span) -> Result<()> {
        let shape = match element {
            Element::Less(what, _) => {
                *self.skipped.entry(what).or_default() += 1;
                return Ok(());
            }
            Element::Cell(shape, _) => shape,
        };
        if let Some(node) = nodes.iter().find(|n| **n >= self.points.len()) {
            let text =
                format!("cell {number} has point {node}, and there are {} (from 0)", self.points.len());
            return fail(Code::BAD_VALUE, at, text);
        }
        self.curved += usize::from(nodes.len() > shape.corners());
        self.first.push(self.corners.len() as u32);
        self.corners.extend(nodes.iter().take(shape.corners()).map(|n| *n as u32));
        self.shapes.push(shape);
        self.numbers.push(number);
        self.places.push((at.start, at.end));
        Ok(())
    }

    /// The number of cells.
    pub fn count(&self) -> usize {
        self.shapes.len()
    }

    /// The corners of a cell.
    pub fn corners(&self, k: usize) -> &[u32] {
        let first = self.first[k] as usize;
        &self.corners[first..first + self.shapes[k].corners()]
    }

    /// Where a cell stands.
    pub fn place(&self, k: usize) -> Span {
        place(self.places[k].0 as usize, self.places[k].1 as usize)
    }

    /// A cell that has the same corners as an earlier one, and that one.
    pub fn twice(&self) -> Option<(usize, usize)> {
        let key = |k: u32| {
            let mut corners = self.corners(k as usize).to_vec();
            corners.sort_unstable();
            corners
        };
        let mut order: Vec<u32> = (0..self.count() as u32).collect();
        // The sum of corners first: sorted copies of them are made for the few that share it.
        let sum = |k: u32| self.corners(k as usize).iter().map(|c| u64::from(*c)).sum::<u64>();
        order.sort_unstable_by_key(|&k| (self.shapes[k as usize], sum(k), k));
        let mut found: Option<(usize, usize)> = None;
        for group in
            order.chunk_by(|&a, &b| sum(a) == sum(b) && self.shapes[a as usize] == self.shapes[b as usize])
        {
            if group.len() < 2 {
                continue;
            }
            let mut keyed: Vec<(Vec<u32>, u32)> = group.iter().map(|&k| (key(k), k)).collect();
            keyed.sort_unstable();
            let same =
                keyed.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| (w[1].1 as usize, w[0].1 as usize));
            found = found.into_iter().chain(same).min();
        }
        found
    }

    /// The set of this name or number, made if there is none.
    pub fn set(&mut self, name: &str, number: Option<i64>) -> &mut Set {
        let at = self.sets.iter().position(|s| s.name == name && s.number == number);
        let at = at.unwrap_or_else(|| {
            self.sets.push(Set { name: name.to_string(), number, cells: vec![] });
            self.sets.len() - 1
        });
        &mut self.sets[at]
    }
}

/// The endings of files that are meshes.
pub const ENDINGS: [&str; 4] = [".vtk", ".vtu", ".msh", ".inp"];

/// Reads a mesh in the format of its name's extension.
///
/// # Errors
/// Other extensions, and errors in the file, with their place there.
pub fn read(file: &File, name: &str) -> Result<Mesh> {
    let plain = name.strip_suffix(".gz").unwrap_or(name).to_ascii_lowercase();
    let mesh = match ENDINGS.iter().find(|e| plain.ends_with(**e)) {
        Some(&".vtk") => vtk::read(&file.bytes),
        Some(&".vtu") => vtu::read(&file.bytes),
        Some(&".msh") => gmsh::read(file),
        Some(_) => abaqus::read(file.text()?),
        None => {
            let text =
                format!("`{name}` is no mesh that can be read: its name must end in {}", ENDINGS.join(", "));
            return fail(Code::BAD_FILE, file.at, text);
        }
    }?;
    Ok(mesh)
}

/// Points by the numbers that a file gives them.
#[derive(Debug, Default)]
struct Numbered {
    /// Number and place in the mesh, sorted once all are there.
    list: Vec<(u64, u32)>,
    sorted: bool,
}

impl Numbered {
    fn push(&mut self, number: u64) {
        self.list.push((number, self.list.len() as u32));
        self.sorted = false;
    }

    /// Sorts; a number that occurs twice.
    fn settle(&mut self) -> Option<u64> {
        if !std::mem::replace(&mut self.sorted, true) {
            self.list.sort_unstable();
        }
        self.list.windows(2).find(|w| w[0].0 == w[1].0).map(|w| w[0].0)
    }

    /// The place of a number.
    fn find(&self, number: u64) -> Option<usize> {
        let k = self.list.binary_search_by_key(&number, |(n, _)| *n).ok()?;
        Some(self.list[k].1 as usize)
    }
}

/// The refusal of a kind of element.
fn no_element(at: Span, what: impl std::fmt::Display) -> perigrain_base::diag::Diagnostics {
    let d = not_read(at, what);
    let known: Vec<&str> = Shape::ALL.iter().map(|s| s.name()).collect();
    d.help(format!("cells may be {}", known.join(", "))).into()
}

#[cfg(test)]
mod tests;
