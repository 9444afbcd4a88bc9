//! compute property/local: which particles touch, and which are bonded.

use super::near::{bonds, within};
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
                   radius` (closer than the sum of their radii). `batom1 batom2`: ids of the ends of every unbroken \
                   peridynamic bond, `btype`: 1; in LAMMPS these are the bonds of molecules. Attributes of pairs and of bonds \
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

type Getter = fn(&World, u32, u32) -> f64;

fn tag(w: &World, i: u32) -> f64 {
    f64::from(w.particles.tag[i as usize])
}

fn kind(w: &World, i: u32) -> f64 {
    f64::from(w.particles.kind[i as usize])
}

const ATTRIBUTES: &[(&str, Of, Getter)] = &[
    ("patom1", Of::Contact, |w, i, _| tag(w, i)),
    ("patom2", Of::Contact, |w, _, j| tag(w, j)),
    ("ptype1", Of::Contact, |w, i, _| kind(w, i)),
    ("ptype2", Of::Contact, |w, _, j| kind(w, j)),
    ("batom1", Of::Bond, |w, i, _| tag(w, i)),
    ("batom2", Of::Bond, |w, _, j| tag(w, j)),
    ("btype", Of::Bond, |_, _, _| 1.0),
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
        let (there, need) = if of == Of::Bond { (style.peri, "peri") } else { (style.sphere, "sphere") };
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
            let mut pairs: Vec<(u32, u32)> = vec![];
            match me.of {
                Of::Contact => {
                    let found = within(w, Reach::Touch, &|i, j| has(i) && has(j));
                    pairs.extend(found.iter().map(|p| (p.i, p.j)));
                }
                Of::Bond => bonds(w, |i, j| {
                    if has(i as usize) && has(j as usize) {
                        pairs.push((i, j));
                    }
                }),
            }
            out.local_cols = me.getters.len();
            out.local.clear();
            for (i, j) in pairs {
                out.local.extend(me.getters.iter().map(|g| g(w, i, j)));
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
