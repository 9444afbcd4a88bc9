//! Abaqus' `.inp` files: `*NODE`, `*ELEMENT`, `*ELSET`; what makes nodes or elements otherwise is refused by name.

use super::super::file::not_read;
use super::cell::Shape;
use super::gmsh::unsigned;
use super::{Element, Mesh, Numbered, no_element};
use crate::text::{Line, Lines, number};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};

/// Keywords that make or move nodes and elements in other ways.
const MAKERS: [&str; 13] = [
    "INCLUDE",
    "INSTANCE",
    "SYSTEM",
    "NGEN",
    "NFILL",
    "NCOPY",
    "NMAP",
    "ELGEN",
    "ELCOPY",
    "SUBSTRUCTURE GENERATE",
    "USER ELEMENT",
    "IMPORT",
    "IMPORT ELSET",
];

/// Reads a file.
pub fn read(text: &str) -> Result<Mesh> {
    let reader = Reader {
        lines: Lines::new(text),
        mesh: Mesh::default(),
        nodes: Numbered::default(),
        cells: Numbered::default(),
        parts: 0,
    };
    reader.file()
}

struct Reader<'a> {
    lines: Lines<'a>,
    mesh: Mesh,
    nodes: Numbered,
    cells: Numbered,
    parts: usize,
}

/// A line that begins with a star: its keyword and parameters in capitals, values as written.
struct Keyword<'a> {
    line: Line<'a>,
    name: String,
    parameters: Vec<(String, &'a str)>,
}

impl Keyword<'_> {
    fn value(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|(n, _)| n == name).map(|(_, v)| *v)
    }
}

fn keyword<'a>(line: &Line<'a>) -> Option<Keyword<'a>> {
    let text = line.text.trim().strip_prefix('*').filter(|t| !t.starts_with('*'))?;
    let mut parts = text.split(',').map(str::trim);
    let name = parts.next()?.split_ascii_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
    let parameter = |p: &'a str| match p.split_once('=') {
        Some((n, v)) => (n.trim().to_ascii_uppercase(), v.trim().trim_matches('"')),
        None => (p.to_ascii_uppercase(), ""),
    };
    Some(Keyword { line: *line, name, parameters: parts.filter(|p| !p.is_empty()).map(parameter).collect() })
}

/// What a type of element is.
fn element(name: &str) -> Option<Element> {
    use Element::{Cell, Less};
    let name = name.to_ascii_uppercase();
    let (head, count) = split(&name)?;
    Some(match (head, count) {
        ("C3D" | "DC3D" | "AC3D", 4) => Cell(Shape::Tetrahedron, 4),
        ("C3D" | "DC3D" | "AC3D", 10) => Cell(Shape::Tetrahedron, 10),
        ("C3D" | "DC3D" | "AC3D", 5) => Cell(Shape::Pyramid, 5),
        ("C3D" | "DC3D" | "AC3D", 6) => Cell(Shape::Wedge, 6),
        ("C3D" | "DC3D" | "AC3D", 15) => Cell(Shape::Wedge, 15),
        ("C3D" | "DC3D" | "AC3D", 8) => Cell(Shape::Hexahedron, 8),
        ("C3D" | "DC3D" | "AC3D", 20) => Cell(Shape::Hexahedron, 20),
        ("C3D", 27) => Cell(Shape::Hexahedron, 27),
        ("CPS" | "CPE" | "CPEG" | "DC2D" | "S" | "M3D" | "R3D" | "STRI" | "SFM3D", 3) => {
            Cell(Shape::Triangle, 3)
        }
        ("CPS" | "CPE" | "CPEG" | "DC2D" | "M3D" | "STRI" | "SFM3D", 6) => Cell(Shape::Triangle, 6),
        ("CPS" | "CPE" | "CPEG" | "DC2D" | "S" | "M3D" | "R3D" | "SFM3D", 4) => Cell(Shape::Quad, 4),
        ("CPS" | "CPE" | "CPEG" | "DC2D" | "S" | "M3D" | "SFM3D", 8) => Cell(Shape::Quad, 8),
        ("T2D" | "T3D", 2) | ("B", 21 | 31) => Less("lines", 2),
        ("T2D" | "T3D", 3) | ("B", 22 | 32) => Less("lines", 3),
        _ => return None,
    })
}

/// Letters with the 2D or 3D in them, and the number of nodes behind.
fn split(name: &str) -> Option<(&str, u32)> {
    let from = match name.find("2D").or(name.find("3D")) {
        Some(k) => k + 2,
        None => name.find(|c: char| c.is_ascii_digit())?,
    };
    let (head, rest) = name.split_at(from);
    let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    Some((head, rest[..end].parse().ok()?))
}

impl<'a> Reader<'a> {
    fn file(mut self) -> Result<Mesh> {
        while let Some(line) = self.next() {
            let Some(k) = keyword(&line) else {
                // Data of a keyword that is passed over, or the text of *HEADING.
                continue;
            };
            match k.name.as_str() {
                "NODE" => self.node_lines()?,
                "ELEMENT" => self.element_lines(&k)?,
                "ELSET" => self.set_lines(&k)?,
                "PART" => {
                    self.parts += 1;
                    if self.parts > 1 {
                        return Err(not_read(k.line.span(), "a second *PART of an .inp file").into());
                    }
                }
                // The part where it is: nothing is moved.
                "INSTANCE" if self.peek_data().is_none() => {}
                name if MAKERS.contains(&name) => {
                    return Err(not_read(k.line.span(), format!("*{name} of an .inp file")).into());
                }
                _ => {}
            }
        }
        if self.mesh.points.is_empty() || self.cells.list.is_empty() {
            let what = if self.mesh.points.is_empty() { "*NODE" } else { "*ELEMENT" };
            return fail(Code::INCOMPLETE, self.lines.end(), format!("the file has no {what}"));
        }
        Ok(self.mesh)
    }

    /// The next line that is no comment.
    fn next(&mut self) -> Option<Line<'a>> {
        loop {
            let line = self.lines.take_filled()?;
            if !line.text.trim_start().starts_with("**") {
                return Some(line);
            }
        }
    }

    /// The next line of data, not taken.
    fn peek_data(&self) -> Option<Line<'a>> {
        let mut ahead = Reader {
            lines: self.lines,
            mesh: Mesh::default(),
            nodes: Numbered::default(),
            cells: Numbered::default(),
            parts: 0,
        };
        ahead.next().filter(|l| !l.text.trim_start().starts_with('*'))
    }

    /// The next line of data.
    fn data(&mut self) -> Option<Line<'a>> {
        self.peek_data()?;
        self.next()
    }

    fn node_lines(&mut self) -> Result<()> {
        while let Some(line) = self.data() {
            let fields = fields(&line);
            if fields.len() < 3 || fields.len() > 7 {
                return fail(
                    Code::SYNTAX,
                    line.span(),
                    "a node is a number and its coordinates, with commas between",
                );
            }
            let id = unsigned(&line, fields[0], "the number of the node")?;
            let mut x = [0.0; 3];
            for (d, x) in x.iter_mut().enumerate() {
                if let Some(word) = fields.get(1 + d).filter(|w| !w.is_empty()) {
                    *x = number(&line, word, ["x", "y", "z"][d])?;
                }
            }
            self.nodes.push(id);
            self.mesh.points.push(x);
        }
        match self.nodes.settle() {
            None => Ok(()),
            Some(id) => fail(Code::DUPLICATE_NAME, self.lines.end(), format!("there are two nodes {id}")),
        }
    }

    fn element_lines(&mut self, k: &Keyword) -> Result<()> {
        let at = k.line.span();
        let Some(name) = k.value("TYPE") else {
            return fail(Code::INCOMPLETE, at, "*ELEMENT needs a TYPE");
        };
        let Some(kind) = element(name) else {
            return Err(no_element(at, format!("element type `{name}`")));
        };
        let set = k.value("ELSET").map(str::to_ascii_uppercase);
        while let Some(line) = self.data() {
            self.element(&line, kind, set.as_deref())?;
        }
        match self.cells.settle() {
            None => Ok(()),
            Some(id) => fail(Code::DUPLICATE_NAME, at, format!("there are two elements {id}")),
        }
    }

    /// An element, which may extend over several lines.
    fn element(&mut self, line: &Line<'a>, kind: Element, set: Option<&str>) -> Result<()> {
        let (mut id, mut nodes) = (None, vec![]);
        let mut here = *line;
        loop {
            for word in fields(&here).into_iter().filter(|w| !w.is_empty()) {
                let Some(_) = id else {
                    id = Some(unsigned(&here, word, "the number of the element")?);
                    continue;
                };
                let node = unsigned(&here, word, "the number of a node")?;
                let Some(at) = self.nodes.find(node) else {
                    return fail(Code::UNKNOWN_NAME, here.span_of(word), format!("there is no node {node}"));
                };
                nodes.push(at);
            }
            if nodes.len() >= kind.nodes() {
                break;
            }
            here = match self.data() {
                Some(next) => next,
                None => break,
            };
        }
        let id = id.unwrap_or_default();
        if nodes.len() != kind.nodes() {
            let text = format!("element {id} has {} nodes, not {}", kind.nodes(), nodes.len());
            return fail(Code::SYNTAX, line.span(), text);
        }
        let cell = self.mesh.count();
        self.mesh.add(kind, &nodes, id, line.span())?;
        if matches!(kind, Element::Cell(..)) {
            self.cells.list.push((id, cell as u32));
            self.cells.sorted = false;
            if let Some(set) = set {
                self.mesh.set(set, None).cells.push(cell as u32);
            }
        }
        Ok(())
    }

    fn set_lines(&mut self, k: &Keyword) -> Result<()> {
        let Some(name) = k.value("ELSET").map(str::to_ascii_uppercase) else {
            return fail(Code::INCOMPLETE, k.line.span(), "*ELSET needs a name: ELSET=");
        };
        self.cells.settle();
        let generate = k.value("GENERATE").is_some();
        let mut cells = vec![];
        while let Some(line) = self.data() {
            let fields: Vec<&str> = fields(&line).into_iter().filter(|w| !w.is_empty()).collect();
            if generate {
                self.generate(&line, &fields, &mut cells)?;
                continue;
            }
            for word in fields {
                if word.starts_with(|c: char| c.is_ascii_digit()) {
                    let id = unsigned(&line, word, "the number of an element")?;
                    cells.extend(self.cells.find(id).map(|k| k as u32));
                    continue;
                }
                let other = word.trim_matches('"').to_ascii_uppercase();
                match self.mesh.sets.iter().find(|s| s.name == other) {
                    Some(set) => cells.extend(&set.cells),
                    None => {
                        let text = format!("there is no element set `{other}` before this line");
                        return fail(Code::UNKNOWN_NAME, line.span_of(word), text);
                    }
                }
            }
        }
        self.mesh.set(&name, None).cells.extend(cells);
        Ok(())
    }

    /// First, last and step of numbers of elements.
    fn generate(&self, line: &Line, fields: &[&str], cells: &mut Vec<u32>) -> Result<()> {
        if fields.len() < 2 || fields.len() > 3 {
            return fail(
                Code::SYNTAX,
                line.span(),
                "GENERATE needs the first element, the last one, and the step",
            );
        }
        let first = unsigned(line, fields[0], "the first element")?;
        let last = unsigned(line, fields[1], "the last element")?;
        let step = fields.get(2).map_or(Ok(1), |w| unsigned(line, w, "the step"))?;
        if step == 0 || last < first {
            let d = Diagnostic::error(
                Code::BAD_VALUE,
                line.span(),
                "these are no elements: the step must be above 0, the last not below the first",
            );
            return Err(d.into());
        }
        let inside = self.cells.list.iter().filter(|(id, _)| *id >= first && *id <= last);
        cells.extend(inside.filter(|(id, _)| (id - first) % step == 0).map(|(_, k)| *k));
        Ok(())
    }
}

/// What stands between the commas of a line.
fn fields<'a>(line: &Line<'a>) -> Vec<&'a str> {
    let mut fields: Vec<&str> = line.text.split(',').map(str::trim).collect();
    if fields.last() == Some(&"") {
        fields.pop();
    }
    fields
}
