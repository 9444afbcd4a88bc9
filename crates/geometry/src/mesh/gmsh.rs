//! Gmsh's `.msh` files as text: what both versions share, and version 2.2.

use super::super::file::{File, not_read};
use super::cell::Shape;
use super::{Element, Mesh, Numbered, gmsh4, no_element};
use crate::text::{Line, Lines, number, whole};
use perigrain_base::diag::{Code, Diagnostics, Result, fail};
use std::collections::BTreeMap;

/// The words of a cell's line, one place kept for each.
pub(super) struct Reader<'a> {
    pub lines: Lines<'a>,
    pub mesh: Mesh,
    pub numbered: Numbered,
    /// Names of physical groups, by dimension and number.
    pub names: BTreeMap<(i64, i64), String>,
    /// Cells and the physical groups they belong to, by dimension and number.
    pub groups: BTreeMap<(i64, i64), Vec<u32>>,
    /// Version 4: the physical groups of each entity, by its dimension and number.
    pub entities: BTreeMap<(i64, i64), Vec<i64>>,
    seen: Vec<&'a str>,
}

/// Reads a file.
pub fn read(file: &File) -> Result<Mesh> {
    // A binary file is marked in its second line, which is a text in any case.
    let head = String::from_utf8_lossy(&file.bytes[..file.bytes.len().min(200)]).into_owned();
    let kind = head.lines().nth(1).and_then(|l| l.split_ascii_whitespace().nth(1));
    if head.starts_with("$MeshFormat") && kind == Some("1") {
        let d = not_read(file.at, "a binary .msh file");
        return Err(d.help("`gmsh -save -format msh4` or `Mesh.Binary = 0` writes it as text").into());
    }
    let lines = Lines::new(file.text()?);
    let (names, groups, entities) = Default::default();
    let (mesh, numbered) = (Mesh::default(), Numbered::default());
    Reader { lines, mesh, numbered, names, groups, entities, seen: vec![] }.file()
}

/// What Gmsh calls by a number.
fn element(kind: i64) -> Option<Element> {
    use Element::{Cell, Less};
    Some(match kind {
        1 => Less("lines", 2),
        8 => Less("lines", 3),
        15 => Less("points", 1),
        2 => Cell(Shape::Triangle, 3),
        9 => Cell(Shape::Triangle, 6),
        3 => Cell(Shape::Quad, 4),
        10 => Cell(Shape::Quad, 9),
        16 => Cell(Shape::Quad, 8),
        4 => Cell(Shape::Tetrahedron, 4),
        11 => Cell(Shape::Tetrahedron, 10),
        5 => Cell(Shape::Hexahedron, 8),
        12 => Cell(Shape::Hexahedron, 27),
        17 => Cell(Shape::Hexahedron, 20),
        6 => Cell(Shape::Wedge, 6),
        13 => Cell(Shape::Wedge, 18),
        18 => Cell(Shape::Wedge, 15),
        7 => Cell(Shape::Pyramid, 5),
        14 => Cell(Shape::Pyramid, 14),
        19 => Cell(Shape::Pyramid, 13),
        _ => return None,
    })
}

impl<'a> Reader<'a> {
    fn file(mut self) -> Result<Mesh> {
        let Some(first) = self.lines.take_filled().filter(|l| l.text.trim() == "$MeshFormat") else {
            return fail(
                Code::BAD_FILE,
                self.lines.end(),
                "this is no .msh file: it must begin with $MeshFormat",
            );
        };
        let line = self.line(&first)?;
        let four = match line.word(0) {
            "2.2" | "2.1" | "2" => false,
            "4.1" => true,
            other => {
                let d = not_read(line.span(), format!("version {other} of .msh files"));
                return Err(d.help("versions 2.2 and 4.1 are: `gmsh -save -format msh41`").into());
            }
        };
        self.close(&first)?;
        while let Some(title) = self.lines.take_filled() {
            self.section(&title, four)?;
        }
        for needed in ["$Nodes", "$Elements"] {
            if !self.seen.contains(&needed) {
                let text = format!("the file ends without a section {needed}");
                return fail(Code::INCOMPLETE, self.lines.end(), text);
            }
        }
        for ((dimension, number), cells) in std::mem::take(&mut self.groups) {
            let name = self.names.get(&(dimension, number)).cloned().unwrap_or_default();
            self.mesh.set(&name, Some(number)).cells.extend(cells);
        }
        Ok(self.mesh)
    }

    fn section(&mut self, title: &Line<'a>, four: bool) -> Result<()> {
        let name = title.text.trim();
        if !name.starts_with('$') {
            return fail(Code::SYNTAX, title.span(), "a section must begin here, with a word such as $Nodes");
        }
        if self.seen.contains(&name) && matches!(name, "$Nodes" | "$Elements" | "$Entities") {
            return fail(Code::DUPLICATE_NAME, title.span(), format!("a second section {name}"));
        }
        self.seen.push(name);
        match (name, four) {
            ("$PhysicalNames", _) => self.physical_names(title)?,
            ("$Nodes", false) => self.nodes(title)?,
            ("$Elements", false) => self.elements(title)?,
            ("$Nodes", true) => gmsh4::nodes(self, title)?,
            ("$Elements", true) => gmsh4::elements(self, title)?,
            ("$Entities", true) => gmsh4::entities(self, title)?,
            ("$PartitionedEntities", _) => {
                return Err(not_read(title.span(), "a mesh in partitions").into());
            }
            // Data on nodes and elements, and comments: nothing that a particle could take.
            _ => return self.pass(title),
        }
        if name == "$Nodes"
            && let Some(number) = self.numbered.settle()
        {
            return fail(Code::DUPLICATE_NAME, title.span(), format!("there are two nodes {number}"));
        }
        self.close(title)
    }

    /// Passes over a section.
    fn pass(&mut self, title: &Line<'a>) -> Result<()> {
        let end = title.text.trim().replacen('$', "$End", 1);
        while let Some(line) = self.lines.take() {
            if line.text.trim() == end {
                return Ok(());
            }
        }
        Err(self.cut(title))
    }

    /// The last line of a section.
    fn close(&mut self, title: &Line<'a>) -> Result<()> {
        let end = title.text.trim().replacen('$', "$End", 1);
        let line = self.line(title)?;
        match line.text.trim() == end {
            true => Ok(()),
            false => fail(
                Code::SYNTAX,
                line.span(),
                format!("{end} must stand here: the section is as long as its header states"),
            ),
        }
    }

    /// The next line of a section, which must be there.
    pub fn line(&mut self, title: &Line<'a>) -> Result<Line<'a>> {
        self.lines.take_filled().ok_or_else(|| self.cut(title))
    }

    fn cut(&self, title: &Line<'a>) -> Diagnostics {
        let text = format!("the file ends within the section {}", title.text.trim());
        perigrain_base::diag::Diagnostic::error(Code::INCOMPLETE, self.lines.end(), text)
            .label(title.span(), "it begins here")
            .into()
    }

    fn physical_names(&mut self, title: &Line<'a>) -> Result<()> {
        let count = self.count(title)?;
        for _ in 0..count {
            let line = self.line(title)?;
            let dimension = whole(&line, line.word(0), "the dimension")?;
            let number = whole(&line, line.word(1), "the number of the group")?;
            let quoted = line.text.split_once('"').and_then(|(_, rest)| rest.rsplit_once('"'));
            let Some((name, _)) = quoted else {
                return fail(Code::SYNTAX, line.span(), "the name of a physical group must stand in quotes");
            };
            self.names.insert((dimension, number), name.to_string());
        }
        Ok(())
    }

    /// A line with the length of a section.
    fn count(&mut self, title: &Line<'a>) -> Result<u64> {
        let line = self.line(title)?;
        unsigned(&line, line.word(0), "the length of the section")
    }

    fn nodes(&mut self, title: &Line<'a>) -> Result<()> {
        for _ in 0..self.count(title)? {
            let line = self.line(title)?;
            let id = unsigned(&line, line.word(0), "the number of the node")?;
            self.node(id, &line, 1)?;
        }
        Ok(())
    }

    /// A node whose coordinates begin at this word.
    pub fn node(&mut self, id: u64, line: &Line, first: usize) -> Result<()> {
        let mut x = [0.0; 3];
        for (d, x) in x.iter_mut().enumerate() {
            *x = number(line, line.word(first + d), ["x", "y", "z"][d])?;
        }
        self.point(id, x);
        Ok(())
    }

    fn point(&mut self, id: u64, x: [f64; 3]) {
        self.numbered.push(id);
        self.mesh.points.push(x);
    }

    fn elements(&mut self, title: &Line<'a>) -> Result<()> {
        for _ in 0..self.count(title)? {
            let line = self.line(title)?;
            let id = unsigned(&line, line.word(0), "the number of the element")?;
            let kind = self.kind(&line, line.word(1))?;
            let tags = unsigned(&line, line.word(2), "the number of tags")?;
            let Ok(tags) = usize::try_from(tags.min(64)) else { continue };
            let physical = match tags {
                0 => 0,
                _ => whole(&line, line.word(3), "the physical group")?,
            };
            let cell = self.mesh.count() as u32;
            self.element(&line, id, kind, 3 + tags)?;
            if let (Element::Cell(shape, _), true) = (kind, physical != 0) {
                self.groups.entry((dimension(shape), physical)).or_default().push(cell);
            }
        }
        Ok(())
    }

    /// The kind of element that a word names.
    pub fn kind(&self, line: &Line, word: &str) -> Result<Element> {
        let kind = whole(line, word, "the kind of element")?;
        element(kind).ok_or_else(|| no_element(line.span(), format!("kind {kind} of Gmsh's elements")))
    }

    /// An element whose nodes begin at this word.
    pub fn element(&mut self, line: &Line, id: u64, kind: Element, first: usize) -> Result<()> {
        let words = line.words().count();
        if words != first + kind.nodes() {
            let text =
                format!("element {id} has {} nodes, not {}", kind.nodes(), words.saturating_sub(first));
            return fail(Code::SYNTAX, line.span(), text);
        }
        let mut nodes = [0; 27];
        for (node, word) in nodes.iter_mut().zip(line.words().skip(first)) {
            let number = unsigned(line, word, "the number of a node")?;
            let Some(at) = self.numbered.find(number) else {
                return fail(Code::UNKNOWN_NAME, line.span_of(word), format!("there is no node {number}"));
            };
            *node = at;
        }
        self.mesh.add(kind, &nodes[..kind.nodes()], id, line.span())
    }
}

/// The dimension of a shape.
pub(super) fn dimension(shape: Shape) -> i64 {
    if shape.solid() { 3 } else { 2 }
}

/// Reads a whole number from 0.
pub(super) fn unsigned(line: &Line, word: &str, what: &str) -> Result<u64> {
    let k = whole(line, word, what)?;
    match u64::try_from(k) {
        Ok(k) => Ok(k),
        Err(_) => fail(Code::BAD_VALUE, line.span_of(word), format!("{what} must not be negative: {word}")),
    }
}
