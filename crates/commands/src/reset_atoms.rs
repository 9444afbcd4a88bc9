//! `reset_atoms`: ids without gaps, molecules and image counts by what bonds hold together.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_lang::Args;
use perigrain_styles::common::{self, on_particles};
use perigrain_styles::near::{Clusters, held_together};
use perigrain_styles::words::{Forms, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::{GroupId, World};
use std::collections::BTreeMap;

/// The command.
pub struct ResetAtoms;

/// The old name of `reset_atoms id`.
pub struct ResetAtomIds;

/// The old name of `reset_atoms mol`.
pub struct ResetMolIds;

impl Style for ResetAtoms {
    fn name(&self) -> &'static str {
        "reset_atoms"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(Line::FORMS),
            summary: "Numbers particles or molecules anew, or brings image counts back to zero.",
            text: "`mol` and `image` need an atom_style with bonds; bonds that are turned off hold, too.",
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
            syntax: Syntax::Behind(Ids::GRAMMAR),
            summary: "The old name of `reset_atoms id`.",
            text: "LAMMPS has renamed the command; both names do the same.",
            example: "reset_atom_ids",
        }
    }
}

impl Style for ResetMolIds {
    fn name(&self) -> &'static str {
        "reset_mol_ids"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Molecules::GRAMMAR),
            summary: "The old name of `reset_atoms mol`.",
            text: "LAMMPS has renamed the command; both names do the same.",
            example: BONDED,
        }
    }
}

#[derive(Words)]
struct Ids {
    /// Whether ids follow the places: small cells along x, then y, then z, and within a cell the coordinates, as in LAMMPS.
    #[word(keyword, default = false)]
    sort: bool,
}

/// How molecules are numbered.
#[derive(Words)]
struct Molecules {
    #[word(name = "GROUP")]
    group: GroupId,
    /// Whether molecules are numbered in the order of their smallest ids, or have these as numbers.
    #[word(keyword, default = true)]
    compress: bool,
    /// Numbers begin behind N; for −1, from 1 or, for a group other than all, behind the largest number outside of it.
    #[word(keyword, name = "N", what = "the offset", from = -1, default = -1)]
    offset: i64,
    /// Whether particles without bonds get a number, too, or 0.
    #[word(keyword, default = false)]
    single: bool,
}

#[derive(Words)]
struct Images {
    #[word(name = "GROUP")]
    group: GroupId,
}

#[derive(Words)]
#[word(forms = "reset_atoms", what = "style of reset_atoms", style)]
enum Line {
    /// Ids from 1 without gaps in the order of storage. What belongs to particles stays with them.
    Id(Ids),
    /// Particles of the group that bonds between them hold together are a molecule.
    Mol(Molecules),
    /// Takes the mean of the largest and the smallest image count of each molecule (a whole number, rounded down) from those of its particles
    /// that are in the group.
    Image(Images),
}

impl CommandStyle for ResetAtoms {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let (style, span) = (a.peek_text(), a.here());
        if ["mol", "image"].contains(&style) {
            needs_bonds(&format!("reset_atoms {style}"), span, cx)?;
        }
        common::domain(cx)?;
        Ok(match Line::form(a, cx)? {
            Line::Id(line) => ids(line),
            Line::Mol(how) => molecules(how),
            Line::Image(line) => images(line),
        })
    }
}

impl CommandStyle for ResetAtomIds {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        renamed("`reset_atom_ids` is called `reset_atoms id` now", a, cx);
        common::domain(cx)?;
        read(a, cx).map(ids)
    }
}

impl CommandStyle for ResetMolIds {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        renamed("`reset_mol_ids` is called `reset_atoms mol` now", a, cx);
        needs_bonds("reset_mol_ids", a.name_span(), cx)?;
        common::domain(cx)?;
        read(a, cx).map(molecules)
    }
}

/// A scene for the example of the old name.
const BONDED: &str = "units lj\natom_style bond\nregion b block 0 4 0 4 0 4\ncreate_box 1 b bond/types 1 extra/bond/per/atom 2\n\
    create_atoms 1 single 1 1 1\ncreate_atoms 1 single 2.1 1 1\ncreate_bonds single/bond 1 1 2\nreset_mol_ids all";

fn renamed(text: &str, a: &Args, cx: &BuildCx) {
    cx.note(Diagnostic::note(Code::NO_EFFECT, a.name_span(), text));
}

fn needs_bonds(what: &str, span: Span, cx: &BuildCx) -> Result<()> {
    if cx.world.particles.style.bonded {
        return Ok(());
    }
    let text = format!("`{what}` needs an atom_style with bonds");
    Err(Diagnostic::error(Code::CONFLICT, span, text)
        .help("`atom_style bond` has them; `set … mol` and `set … image` serve particles without bonds")
        .into())
}

fn ids(Ids { sort: sorted }: Ids) -> Box<dyn Act> {
    on_particles(vec![], move |cx| {
        cx.print("Resetting atom IDs ...");
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
    })
}

fn molecules(how: Molecules) -> Box<dyn Act> {
    on_particles(vec![], move |cx| {
        cx.print("Resetting molecule IDs ...");
        let count = number(cx.world, &how);
        let count = count.map_or("unknown".to_string(), |n| n.to_string());
        cx.print(format!("  number of new molecule IDs = {count}"));
        cx.world.slots.invalidate();
        Ok(())
    })
}

/// Numbers the molecules of a group; how many there are where they are counted.
fn number(w: &mut World, how: &Molecules) -> Option<usize> {
    let group = how.group;
    let of = |w: &World, i: usize| w.particles.mask[i] & group.bit() != 0;
    let names = fragments(w, |i| of(w, i), how.single);
    let mut numbers: BTreeMap<u32, u32> = names.iter().copied().filter(|k| *k > 0).map(|k| (k, k)).collect();
    let mut count = None;
    if how.compress {
        let outside = (0..w.n()).filter(|i| !of(w, *i)).map(|i| w.particles.molecule[i]).max().unwrap_or(0);
        let offset = match how.offset {
            ..0 => outside,
            n => n.min(i64::from(i32::MAX)) as u32,
        };
        numbers.values_mut().zip(1..).for_each(|(number, k)| *number = offset + k);
        count = Some(numbers.len());
    }
    for (i, name) in names.iter().enumerate().filter(|(i, _)| w.particles.mask[*i] & group.bit() != 0) {
        w.particles.molecule[i] = numbers.get(name).copied().unwrap_or(0);
    }
    count
}

/// The smallest id in what holds together of the chosen particles; 0 for a particle by itself unless `single`.
fn fragments(w: &World, chosen: impl Fn(usize) -> bool, single: bool) -> Vec<u32> {
    let mut clusters = Clusters::new(&w.particles.tag);
    let mut named: Vec<bool> = (0..w.n()).map(|i| single && chosen(i)).collect();
    held_together(w, |i, j| {
        let (a, b) = (i as usize, j as usize);
        if chosen(a) && chosen(b) {
            clusters.join(i, j);
            (named[a], named[b]) = (true, true);
        }
    });
    (0..w.n()).map(|i| if named[i] { clusters.name(i) as u32 } else { 0 }).collect()
}

fn images(Images { group }: Images) -> Box<dyn Act> {
    on_particles(vec![], move |cx| {
        cx.print("Resetting image flags ...");
        let w = &mut *cx.world;
        let names = fragments(w, |_| true, true);
        let mut range: BTreeMap<u32, [[i32; 3]; 2]> = BTreeMap::new();
        for (i, name) in names.iter().enumerate() {
            let image = w.particles.image[i];
            let [low, high] = range.entry(*name).or_insert([image; 2]);
            (0..3).for_each(|d| (low[d], high[d]) = (low[d].min(image[d]), high[d].max(image[d])));
        }
        for (i, name) in names.iter().enumerate().filter(|(i, _)| w.particles.mask[*i] & group.bit() != 0) {
            let Some([low, high]) = range.get(name) else { continue };
            let image = w.particles.image[i];
            let mean = |d: usize| low[d].saturating_add(high[d]).div_euclid(2);
            w.particles.image.set(i, [0, 1, 2].map(|d| image[d] - mean(d)));
        }
        cx.world.slots.invalidate();
        Ok(())
    })
}

/// About how many particles a cell holds.
const PER_CELL: usize = 10;

/// By which part of their extent cells reach beyond the outermost particles.
const RIM: f64 = 0.0001;

/// The id of each particle when they are counted cell by cell, and by coordinates within a cell.
fn by_place(w: &World) -> Vec<u32> {
    let x = &w.particles.x;
    let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for x in x {
        (0..3).for_each(|d| (lo[d], hi[d]) = (lo[d].min(x[d]), hi[d].max(x[d])));
    }
    for d in 0..3 {
        // The upper rim is a part of what the lower one has made longer: sites of a lattice in the middle are below a border.
        lo[d] -= RIM * (hi[d] - lo[d]);
        hi[d] += RIM * (hi[d] - lo[d]);
    }
    let flat = w.settings.two_dimensional;
    let length = |d: usize| hi[d] - lo[d];
    let volume = length(0) * length(1) * if flat { 1.0 } else { length(2) };
    let cells = (x.len() / PER_CELL + 1) as f64;
    let size = (volume / cells).powf(if flat { 0.5 } else { 1.0 / 3.0 });
    let count =
        [0, 1, 2].map(|d| if size > 0.0 && !(flat && d == 2) { (length(d) / size) as usize + 1 } else { 1 });
    // By the reciprocal, as LAMMPS does: sites of a lattice lie on the borders of cells.
    let cell = |x: &[f64; 3], d: usize| match length(d) > 0.0 {
        true => (((x[d] - lo[d]) * (1.0 / length(d)) * count[d] as f64) as usize).min(count[d] - 1),
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
