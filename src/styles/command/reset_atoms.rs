//! `reset_atoms id`: ids without gaps, in storage order or by place.

use super::common::{self, on_particles};
use super::{Act, CommandStyle};
use crate::diag::{Code, Diagnostic, Result, fail};
use crate::lang::Args;
use crate::styles::{BuildCx, Doc, Style};
use crate::world::World;

/// The command.
pub struct ResetAtoms;

/// Its old name.
pub struct ResetAtomIds;

impl Style for ResetAtoms {
    fn name(&self) -> &'static str {
        "reset_atoms"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "reset_atoms id [sort yes|no]",
            summary: "Gives particles new ids from 1 without gaps.",
            text: "Ids follow the order of storage. With `sort yes` they follow the places: small cells along x, then y, \
                   then z, and within a cell the coordinates, as in LAMMPS. What belongs to particles stays with them. \
                   The styles `image` and `mol` belong to molecules and are refused.",
            example: "reset_atoms id sort yes",
        }
    }
}

impl Style for ResetAtomIds {
    fn name(&self) -> &'static str {
        "reset_atom_ids"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "reset_atom_ids [sort yes|no]",
            summary: "The old name of `reset_atoms id`.",
            text: "LAMMPS has renamed the command; both names do the same.",
            example: "reset_atom_ids",
        }
    }
}

impl CommandStyle for ResetAtoms {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let style = a.expect("id")?;
        match style.text.as_str() {
            "id" => ids(a, cx),
            "image" | "mol" => {
                let text = format!("`reset_atoms {}` needs an atom style with molecules", style.text);
                fail(Code::CONFLICT, style.span, text)
            }
            _ => Err(common::unknown_style(style, "style of reset_atoms", &["id"])),
        }
    }
}

impl CommandStyle for ResetAtomIds {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let d = Diagnostic::note(
            Code::NO_EFFECT,
            a.name_span(),
            "`reset_atom_ids` is called `reset_atoms id` now",
        );
        cx.note(d);
        ids(a, cx)
    }
}

fn ids(a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
    common::domain(cx)?;
    let mut sorted = false;
    while let Some(word) = a.next() {
        match word.text.as_str() {
            "sort" => sorted = a.flag("sort")?,
            _ => return Err(a.unknown(word, &["sort"])),
        }
    }
    Ok(on_particles(vec![], move |cx| {
        cx.say("Resetting atom IDs ...");
        common::settle(cx.world);
        match sorted {
            false => cx.world.renumber(),
            true => {
                let ids = by_place(cx.world);
                cx.world.rename(ids);
            }
        }
        cx.world.slots.invalidate();
        Ok(())
    }))
}

/// About how many particles a cell holds.
const PER_CELL: usize = 10;

/// The id of each particle when they are counted cell by cell, and by coordinates within a cell.
fn by_place(w: &World) -> Vec<u32> {
    let x = &w.particles.x;
    let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for x in x {
        (0..3).for_each(|d| (lo[d], hi[d]) = (lo[d].min(x[d]), hi[d].max(x[d])));
    }
    for d in 0..3 {
        let rim = 0.0001 * (hi[d] - lo[d]);
        (lo[d], hi[d]) = (lo[d] - rim, hi[d] + rim);
    }
    let flat = w.settings.two_dimensional;
    let length = |d: usize| hi[d] - lo[d];
    let volume = length(0) * length(1) * if flat { 1.0 } else { length(2) };
    let cells = (x.len() / PER_CELL + 1) as f64;
    let size = (volume / cells).powf(if flat { 0.5 } else { 1.0 / 3.0 });
    let count =
        [0, 1, 2].map(|d| if size > 0.0 && !(flat && d == 2) { (length(d) / size) as usize + 1 } else { 1 });
    let cell = |x: &[f64; 3], d: usize| match length(d) > 0.0 {
        true => ((((x[d] - lo[d]) / length(d)) * count[d] as f64) as usize).min(count[d] - 1),
        false => 0,
    };
    let index = |x: &[f64; 3]| (cell(x, 2) * count[1] + cell(x, 1)) * count[0] + cell(x, 0);
    let mut order: Vec<usize> = (0..x.len()).collect();
    let place = |i: usize| (index(&x[i]), x[i]);
    order.sort_by(|&a, &b| {
        let ((ca, a), (cb, b)) = (place(a), place(b));
        ca.cmp(&cb).then_with(|| (0..3).fold(std::cmp::Ordering::Equal, |o, d| o.then(a[d].total_cmp(&b[d]))))
    });
    let mut ids = vec![0; x.len()];
    for (id, i) in (1..).zip(order) {
        ids[i] = id;
    }
    ids
}

#[cfg(test)]
mod tests {
    use super::super::testing::{more, refused, scene};

    #[test]
    fn gaps_are_closed() {
        let mut w =
            scene("units si\nregion b block 0 4 0 3 0 3\ncreate_box 1 b\nlattice sc 1\ncreate_atoms 1 box");
        more(&mut w, "group g id 3:7\ndelete_atoms group g compress no");
        assert!(w.particles.tag.contains(&36));
        let first = w.particles.x[0];
        more(&mut w, "reset_atoms id");
        assert_eq!((w.particles.tag.iter().max(), w.particles.x[0]), (Some(&31), first));
        more(&mut w, "reset_atoms id sort yes");
        let mut ids = w.particles.tag.clone();
        ids.sort_unstable();
        assert_eq!(ids, (1..=31).collect::<Vec<u32>>());
        assert_eq!(refused(&w, "reset_atoms mol all").0, "mol");
        assert_eq!(refused(&w, "reset_atoms id order yes").0, "order");
    }
}
