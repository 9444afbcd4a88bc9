//! compute property/local: which particles touch, and which are bonded.

use super::near::{bonds, bonds_within, within};
use super::{Compute, ComputeStyle};
use crate::diag::{Code, Diagnostic, Result, fail};
use crate::lang::{Args, Word};
use crate::neigh::list::Reach;
use crate::plan::{Op, Stage, When};
use crate::styles::step_op::{Wanted, fill};
use crate::styles::{BuildCx, Doc, SealCx, Shape, Style};
use crate::world::{GroupId, SlotId, World};

/// The style.
pub struct PropertyLocal;

impl Style for PropertyLocal {
    fn name(&self) -> &'static str {
        "property/local"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "compute ID group property/local patom1|patom2|ptype1|ptype2 … cutoff radius\n\
                     compute ID group property/local batom1|batom2|btype …",
            summary: "Ids and types of the two ends of every contact, or of every bond.",
            text: "Local vector for one attribute, array for several; a row for each pair with both ends in the group, in the \
                   order of their ids. `patom1 patom2 ptype1 ptype2`: ids and types of spheres that touch, with `cutoff \
                   radius` (closer than the sum of their radii). `batom1 batom2 btype`: ids of the ends and type of every \
                   bond, in the order of the first one's place in storage; without an atom style that has bonds, of every unbroken \
                   peridynamic bond, whose type is 1 (in LAMMPS these have no such list). Attributes of pairs and of bonds \
                   do not mix. LAMMPS' `cutoff type`, `natom1 …` (its neighbour lists, with their skin) and those of angles, \
                   dihedrals and impropers are refused. `dump local` writes them, `compute reduce … inputs local` adds \
                   them up.",
            example: "compute b all property/local batom1 batom2",
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Of {
    Contact,
    Bond,
}

/// A contact or bond: ids and types of the ends, type of the bond.
struct Row {
    tags: [u32; 2],
    kinds: [u16; 2],
    bond: i32,
}

impl Row {
    fn of(w: &World, i: u32, j: u32) -> Self {
        let (p, ends) = (&w.particles, [i as usize, j as usize]);
        Row { tags: ends.map(|i| p.tag[i]), kinds: ends.map(|i| p.kind[i]), bond: 1 }
    }
}

type Getter = fn(&Row) -> f64;

const ATTRIBUTES: &[(&str, Of, Getter)] = &[
    ("patom1", Of::Contact, |r| f64::from(r.tags[0])),
    ("patom2", Of::Contact, |r| f64::from(r.tags[1])),
    ("ptype1", Of::Contact, |r| f64::from(r.kinds[0])),
    ("ptype2", Of::Contact, |r| f64::from(r.kinds[1])),
    ("batom1", Of::Bond, |r| f64::from(r.tags[0])),
    ("batom2", Of::Bond, |r| f64::from(r.tags[1])),
    ("btype", Of::Bond, |r| f64::from(r.bond)),
];

/// LAMMPS' attributes that perigrain does not have.
const ELSEWHERE: &[&str] = &[
    "natom1", "natom2", "ntype1", "ntype2", "aatom1", "aatom2", "aatom3", "atype", "datom1", "datom2",
    "datom3", "datom4", "dtype", "iatom1", "iatom2", "iatom3", "iatom4", "itype",
];

impl ComputeStyle for PropertyLocal {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let mut list: Vec<(Of, Getter)> = vec![];
        while let Some(word) = args.peek().filter(|w| w.text != "cutoff") {
            args.next();
            let (of, getter) = attribute(word)?;
            if list.first().is_some_and(|(first, _)| *first != of) {
                let text = format!("`{}` cannot stand beside the attributes before it", word.text);
                return Err(Diagnostic::error(Code::CONFLICT, word.span, text)
                    .help("use one compute for contacts and another for bonds")
                    .into());
            }
            list.push((of, getter));
        }
        let Some((of, _)) = list.first().copied() else {
            args.expect("an attribute, as `batom1`")?;
            return fail(Code::MISSING_ARGUMENT, args.here(), "an attribute is missing before `cutoff`");
        };
        if args.eat("cutoff") {
            let word = args.expect("`radius`")?;
            if word.text != "radius" {
                let text = format!("`cutoff {}` is not in perigrain: write `cutoff radius`", word.text);
                return fail(Code::NOT_SUPPORTED, word.span, text);
            }
        } else if of == Of::Contact {
            return Err(Diagnostic::error(Code::MISSING_ARGUMENT, args.here(), "`cutoff radius` is missing")
                .help("LAMMPS' default `cutoff type` is not in perigrain; `cutoff radius` lists spheres that touch")
                .into());
        }
        args.finish()?;
        let style = cx.world.particles.style;
        let (there, need) =
            if of == Of::Bond { (style.peri || style.bonded, "bond") } else { (style.sphere, "sphere") };
        if !there {
            let text = format!("these attributes need `atom_style {need}`");
            return fail(Code::INCOMPLETE, cx.span, text);
        }
        let getters = list.into_iter().map(|(_, g)| g).collect();
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, of, getters }))
    }
}

fn attribute(word: &Word) -> Result<(Of, Getter)> {
    let name = word.text.as_str();
    if let Some((_, of, getter)) = ATTRIBUTES.iter().find(|a| a.0 == name) {
        return Ok((*of, *getter));
    }
    if ELSEWHERE.contains(&name) {
        let d = Diagnostic::error(Code::NOT_SUPPORTED, word.span, format!("`{name}` is not in perigrain"));
        return Err(d.help("contacts are patom1 patom2 ptype1 ptype2, bonds batom1 batom2 btype").into());
    }
    let known: Vec<&str> = ATTRIBUTES.iter().map(|a| a.0).collect();
    Err(Diagnostic::error(
        Code::UNKNOWN_KEYWORD,
        word.span,
        format!("`{name}` is no attribute of pairs or bonds"),
    )
    .help(format!("attributes: {}", known.join(" ")))
    .into())
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    of: Of,
    getters: Vec<Getter>,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { local: self.getters.len(), ..Shape::default() }
    }

    fn op(&self, _cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let me = self.clone();
        Ok(fill(&self.id, &Wanted { slot, stage, when }, "x radius mask families", move |w, _, out| {
            let has = |i: usize| w.particles.mask[i] & me.group.bit() != 0;
            let mut rows: Vec<Row> = vec![];
            match me.of {
                Of::Contact => {
                    let found = within(w, Reach::Touch, &|i, j| has(i) && has(j));
                    rows.extend(found.iter().map(|p| Row::of(w, p.i, p.j)));
                }
                Of::Bond if w.particles.style.bonded => {
                    rows.extend(bonds_within(w, me.group).iter().map(|b| Row {
                        tags: b.ends,
                        kinds: [0; 2],
                        bond: b.kind,
                    }));
                }
                Of::Bond => bonds(w, |i, j| {
                    if has(i as usize) && has(j as usize) {
                        rows.push(Row::of(w, i, j));
                    }
                }),
            }
            out.local_cols = me.getters.len();
            out.local.clear();
            for row in rows {
                out.local.extend(me.getters.iter().map(|g| g(&row)));
            }
            Ok(())
        }))
    }

    fn boxed(&self) -> Box<dyn Compute> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::styles::testing::Bench;
    use crate::world::AtomStyle;

    #[test]
    fn touching_spheres() {
        let style = AtomStyle { sphere: true, ..AtomStyle::default() };
        let mut b = Bench::new(style, &[[0.0; 3], [0.9, 0.0, 0.0], [0.9, 0.9, 0.0], [5.0; 3]]);
        b.world.particles.radius.fill(0.5);
        let c = b.compute(&PropertyLocal, "patom2 patom1 cutoff radius").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().local, [2.0, 1.0, 3.0, 2.0]);
        for words in [
            "",
            "patom1",
            "natom1",
            "patom1 batom1 cutoff radius",
            "batom1",
            "patom1 cutoff type",
            "patom3",
            "cutoff radius",
        ] {
            assert!(b.compute(&PropertyLocal, words).is_err(), "{words}");
        }
    }
}
