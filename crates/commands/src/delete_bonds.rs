//! `delete_bonds`: bonds turned off, on again, or removed.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_styles::common::{self, on_particles, range_from};
use perigrain_styles::words::{Kind, Syntax, Value, Words, read};
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
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Turns bonds off, on again, or removes them.",
            text: "Meant are bonds with both ends in the group. Types are `A`, `*`, `A*`, `*B` or `A*B`. A bond turned off has its \
                   type negative: it exerts no force but still counts as bonded for `special_bonds`. `angle` and the like are \
                   refused.",
            example: "units lj\natom_style bond\nlattice sc 1.0\nregion b block 0 4 0 4 0 4\n\
                      create_box 1 b bond/types 1 extra/bond/per/atom 6\ncreate_atoms 1 box\nmass 1 1.0\n\
                      create_bonds many all all 1 0.9 1.1\ndelete_bonds all bond 1\ndelete_bonds all stats",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "GROUP")]
    group: GroupId,
    #[word(name = "style")]
    choice: Choice,
    #[word(flatten)]
    how: How,
}

#[derive(Clone, Copy, Words)]
#[word(what = "style of delete_bonds", style, refused = "angle dihedral improper")]
enum Choice {
    /// All of them are turned off.
    Multi,
    /// Those with an end of some types are turned off.
    Atom(#[word(name = "TYPES")] AtomTypes),
    /// Those of some bond types are turned off.
    Bond(#[word(name = "TYPES")] BondTypes),
    /// None is: they are only counted.
    Stats,
}

/// Particle types from 0.
#[derive(Clone, Copy)]
struct AtomTypes(i64, i64);

impl Value for AtomTypes {
    const KIND: Kind = Kind::Types;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        range_from(args.expect("particle types")?, 0, cx.world.types as i64).map(|(lo, hi)| Self(lo, hi))
    }
}

/// Bond types from 0.
#[derive(Clone, Copy)]
struct BondTypes(i64, i64);

impl Value for BondTypes {
    const KIND: Kind = Kind::Types;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        range_from(args.expect("bond types")?, 0, cx.world.bonds.types as i64).map(|(lo, hi)| Self(lo, hi))
    }
}

#[derive(Clone, Copy, Words)]
struct How {
    /// Meant are bonds with one end in the group at least.
    #[word(flag)]
    any: bool,
    /// Bonds that are off are turned on.
    #[word(flag)]
    undo: bool,
    /// All bonds of the scene that are off then are removed for good.
    #[word(flag)]
    remove: bool,
    /// Decides anew which pairs count as bonded.
    #[word(flag)]
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
        let Line { group, choice, how } = read(a, cx)?;
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
            Choice::Atom(AtomTypes(lo, hi)) => {
                ends.iter().any(|&i| (lo..=hi).contains(&i64::from(p.kind[i])))
            }
            Choice::Bond(BondTypes(lo, hi)) => (lo..=hi).contains(&i64::from(kind)),
        };
        // Only what is on can be turned off, and the other way round.
        if meant && chosen && kind > 0 {
            bond.kind = -bond.kind;
        }
    }
    w.bonds.changes += 1;
}
