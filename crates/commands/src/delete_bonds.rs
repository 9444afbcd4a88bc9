//! `delete_bonds`: bonds turned off, on again, or removed.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_styles::common::{self, not_here, on_particles, range_from, unknown_style};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::index::Index;
use perigrain_world::{GroupId, World};

/// The command.
pub struct DeleteBonds;

impl Style for DeleteBonds {
    fn name(&self) -> &'static str {
        "delete_bonds"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "delete_bonds GROUP multi | atom TYPES | bond TYPES | stats  [any] [undo] [remove] [special]",
            summary: "Turns bonds off, on again, or removes them.",
            text: "Meant are bonds with both ends in the group, or with `any` one of them: all of them (`multi`), those with an end \
                   of some types (`atom`), those of some bond types (`bond`); `stats` only counts. Types are `A`, `*`, `A*`, `*B` or \
                   `A*B`. A bond turned off has its type negative: it exerts no force but still counts as bonded for `special_bonds`. \
                   `undo` turns on what is off. `remove` then removes all bonds of the scene that are off, for good, and `special` \
                   decides anew which pairs count as bonded. `angle` and the like are refused.",
            example: "units lj\natom_style bond\nlattice sc 1.0\nregion b block 0 4 0 4 0 4\n\
                      create_box 1 b bond/types 1 extra/bond/per/atom 6\ncreate_atoms 1 box\nmass 1 1.0\n\
                      create_bonds many all all 1 0.9 1.1\ndelete_bonds all bond 1\ndelete_bonds all stats",
        }
    }
}

#[derive(Clone, Copy)]
enum Choice {
    Multi,
    Atom(i64, i64),
    Bond(i64, i64),
    Stats,
}

#[derive(Clone, Copy)]
struct How {
    any: bool,
    undo: bool,
    remove: bool,
    special: bool,
}

impl CommandStyle for DeleteBonds {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        if !cx.world.particles.style.bonded {
            let text = format!("particles of atom_style {} have no bonds", cx.world.particles.style.name());
            let d = Diagnostic::error(Code::CONFLICT, a.name_span(), text);
            return Err(d.help("`atom_style bond`, alone or in a hybrid, has them").into());
        }
        let group = cx.group(a.expect("a group")?)?;
        let style = a.expect("multi, atom, bond or stats")?;
        let choice = match style.text.as_str() {
            "multi" => Choice::Multi,
            "stats" => Choice::Stats,
            "atom" => {
                let (lo, hi) = range_from(a.expect("particle types")?, 0, cx.world.types as i64)?;
                Choice::Atom(lo, hi)
            }
            "bond" => {
                let (lo, hi) = range_from(a.expect("bond types")?, 0, cx.world.bonds.types as i64)?;
                Choice::Bond(lo, hi)
            }
            "angle" | "dihedral" | "improper" => return Err(not_here(style, "delete_bonds")),
            _ => {
                const KNOWN: [&str; 4] = ["multi", "atom", "bond", "stats"];
                return Err(unknown_style(style, "style of delete_bonds", &KNOWN));
            }
        };
        let mut how = How { any: false, undo: false, remove: false, special: false };
        while let Some(word) = a.next() {
            let flag = match word.text.as_str() {
                "any" => &mut how.any,
                "undo" => &mut how.undo,
                "remove" => &mut how.remove,
                "special" => &mut how.special,
                _ => return Err(a.unknown(word, &["any", "undo", "remove", "special"])),
            };
            *flag = true;
        }
        Ok(on_particles(vec![], move |cx| delete(cx, group, choice, how)))
    }
}

fn delete(cx: &mut ActCx, group: GroupId, choice: Choice, how: How) -> Result<()> {
    cx.print("Deleting bonds ...");
    switch(cx.world, group, choice, how);
    let bonds = &mut cx.world.bonds;
    if how.remove {
        bonds.retain(|b| b.kind > 0);
    }
    let (all, on) = (bonds.len(), bonds.list.iter().filter(|b| b.is_on()).count());
    if how.special {
        bonds.find_special();
    }
    cx.world.touch();
    cx.print(format!("  {all} total bonds, {on} turned on, {} turned off", all - on));
    Ok(())
}

fn switch(w: &mut World, group: GroupId, choice: Choice, how: How) {
    let p = &w.particles;
    let index = Index::new(&p.tag);
    for bond in &mut w.bonds.list {
        let ends: Vec<usize> = bond.ends.iter().filter_map(|t| index.find(*t, &p.tag)).collect();
        let inside = ends.iter().filter(|&&i| p.mask[i] & group.bit() != 0).count();
        let meant = if how.any { inside > 0 } else { inside == 2 };
        let kind = if how.undo { -bond.kind } else { bond.kind };
        let chosen = match choice {
            Choice::Multi => true,
            Choice::Stats => false,
            Choice::Atom(lo, hi) => ends.iter().any(|&i| (lo..=hi).contains(&i64::from(p.kind[i]))),
            Choice::Bond(lo, hi) => (lo..=hi).contains(&i64::from(kind)),
        };
        // Only what is on can be turned off, and the other way round.
        if meant && chosen && kind > 0 {
            bond.kind = -bond.kind;
        }
    }
    w.bonds.changes += 1;
}
