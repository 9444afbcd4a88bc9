//! Version 4.1 of Gmsh's files: nodes and elements in blocks, physical groups by entity.

use super::Element;
use super::gmsh::{Reader, dimension, unsigned};
use crate::text::{Line, whole};
use perigrain_base::diag::{Code, Result, fail};

/// Reads the physical groups of all entities.
pub fn entities<'a>(r: &mut Reader<'a>, title: &Line<'a>) -> Result<()> {
    let line = r.line(title)?;
    let mut counts = [0; 4];
    for (k, count) in counts.iter_mut().enumerate() {
        *count = unsigned(&line, line.word(k), "the number of entities")?;
    }
    for (dimension, count) in (0..).zip(counts) {
        // A point has its place, others have a box around them.
        let before = if dimension == 0 { 4 } else { 7 };
        for _ in 0..count {
            let line = r.line(title)?;
            let number = whole(&line, line.word(0), "the number of the entity")?;
            let groups = unsigned(&line, line.word(before), "the number of physical groups")?;
            let words: Vec<&str> = line.words().skip(before + 1).collect();
            let Some(words) = usize::try_from(groups).ok().and_then(|n| words.get(..n)) else {
                let text = format!("this entity has {groups} physical groups, and the line ends before");
                return fail(Code::SYNTAX, line.span(), text);
            };
            let mut list = vec![];
            for word in words {
                // The sign of a number is the orientation of the entity.
                list.push(whole(&line, word, "the number of a physical group")?.saturating_abs());
            }
            r.entities.insert((dimension, number), list);
        }
    }
    Ok(())
}

/// Reads all blocks of nodes.
pub fn nodes<'a>(r: &mut Reader<'a>, title: &Line<'a>) -> Result<()> {
    let head = r.line(title)?;
    let blocks = unsigned(&head, head.word(0), "the number of blocks")?;
    let promised = unsigned(&head, head.word(1), "the number of nodes")?;
    let mut ids = vec![];
    for _ in 0..blocks {
        let line = r.line(title)?;
        let count = unsigned(&line, line.word(3), "the number of nodes in the block")?;
        ids.clear();
        for _ in 0..count {
            let line = r.line(title)?;
            ids.push(unsigned(&line, line.word(0), "the number of the node")?);
        }
        for id in &ids {
            let line = r.line(title)?;
            r.node(*id, &line, 0)?;
        }
    }
    let have = r.mesh.points.len() as u64;
    if have != promised {
        let text = format!("there are {have} nodes, the section promises {promised}");
        return fail(Code::INCOMPLETE, head.span(), text);
    }
    Ok(())
}

/// Reads all blocks of elements.
pub fn elements<'a>(r: &mut Reader<'a>, title: &Line<'a>) -> Result<()> {
    let head = r.line(title)?;
    let blocks = unsigned(&head, head.word(0), "the number of blocks")?;
    let promised = unsigned(&head, head.word(1), "the number of elements")?;
    let mut have = 0;
    for _ in 0..blocks {
        let block = r.line(title)?;
        let entity = whole(&block, block.word(1), "the number of the entity")?;
        let kind = r.kind(&block, block.word(2))?;
        let count = unsigned(&block, block.word(3), "the number of elements in the block")?;
        for _ in 0..count {
            let line = r.line(title)?;
            let id = unsigned(&line, line.word(0), "the number of the element")?;
            let cell = r.mesh.count() as u32;
            r.element(&line, id, kind, 1)?;
            have += 1;
            let Element::Cell(shape, _) = kind else { continue };
            let dimension = dimension(shape);
            for group in r.entities.get(&(dimension, entity)).into_iter().flatten() {
                r.groups.entry((dimension, *group)).or_default().push(cell);
            }
        }
    }
    if have != promised {
        let text = format!("there are {have} elements, the section promises {promised}");
        return fail(Code::INCOMPLETE, head.span(), text);
    }
    Ok(())
}
