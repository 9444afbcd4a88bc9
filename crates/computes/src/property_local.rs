//! compute property/local: ids and types of particles in contact and of bonded particles.

use super::pair_local::{Cutoff, answering, of_group};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Word};
use perigrain_neigh::list::Reach;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::near::{bonds, bonds_within, within};
use perigrain_styles::probe::{Request, look_all};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Alternative, Syntax, Words, alternatives, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MEMO, MOLECULE, OMEGA, RADIUS,
    TAG, TRAVEL, V, VOLUME, X, X0,
};
use perigrain_world::{GroupId, SlotId, World};

/// The style.
pub struct PropertyLocal;

impl Style for PropertyLocal {
    fn name(&self) -> &'static str {
        "property/local"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Ids and types of the two ends of every pair, contact or bond.",
            text: "Local vector for one attribute, array for several; a row for each pair with both ends in the group, in the \
                   order of their ids. `dump local` writes them, `compute reduce … inputs local` adds them up.\n\n\
                   The pairs of `natom1 …` are those of the neighbour list, which reaches one skin further and is as old as its last \
                   rebuild. The bonds of `batom1 …` stand in the order of the first end's place in storage; without an atom style that \
                   has bonds they are the unbroken peridynamic bonds, whose type is 1 (in LAMMPS these have no such list).\n\n\
                   Attributes of the three kinds do not mix. Those of angles, dihedrals and impropers are refused; peridynamic \
                   styles have no pairs and lists here yet.",
            example: "compute b all property/local batom1 batom2",
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Of {
    /// Pairs as in pair/local.
    Contact,
    /// Pairs in neighbour lists.
    List,
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

const ATTRIBUTES: [(&str, (Of, Getter)); 11] = [
    ("patom1", (Of::Contact, |r| f64::from(r.tags[0]))),
    ("patom2", (Of::Contact, |r| f64::from(r.tags[1]))),
    ("ptype1", (Of::Contact, |r| f64::from(r.kinds[0]))),
    ("ptype2", (Of::Contact, |r| f64::from(r.kinds[1]))),
    ("natom1", (Of::List, |r| f64::from(r.tags[0]))),
    ("natom2", (Of::List, |r| f64::from(r.tags[1]))),
    ("ntype1", (Of::List, |r| f64::from(r.kinds[0]))),
    ("ntype2", (Of::List, |r| f64::from(r.kinds[1]))),
    ("batom1", (Of::Bond, |r| f64::from(r.tags[0]))),
    ("batom2", (Of::Bond, |r| f64::from(r.tags[1]))),
    ("btype", (Of::Bond, |r| f64::from(r.bond))),
];

const NAMES: &[Alternative] = &alternatives(&ATTRIBUTES);

/// LAMMPS' attributes that perigrain does not have.
const ELSEWHERE: &[&str] = &[
    "aatom1", "aatom2", "aatom3", "atype", "datom1", "datom2", "datom3", "datom4", "dtype", "iatom1",
    "iatom2", "iatom3", "iatom4", "itype",
];

#[derive(Words)]
struct Line {
    /// `patom1 patom2 ptype1 ptype2`: ids and types of the pairs of compute pair/local with the same `cutoff`; `natom1 natom2 ntype1
    /// ntype2`: those of the pairs of the neighbour list; `batom1 batom2 btype`: ids of the ends and type of every bond.
    #[word(name = "attribute", what = "an attribute, as `batom1`", kind = Kind::Choice(NAMES), least = 1)]
    attributes: Vec<Word>,
    #[word(keyword)]
    cutoff: Cutoff,
}

impl ComputeStyle for PropertyLocal {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { attributes, cutoff } = read(args, cx)?;
        let mut list: Vec<(Of, Getter)> = vec![];
        for word in &attributes {
            let (of, getter) = attribute(word)?;
            if list.first().is_some_and(|(first, _)| *first != of) {
                let text = format!("`{}` cannot stand beside the attributes before it", word.text);
                return Err(Diagnostic::error(Code::CONFLICT, word.span, text)
                    .help("use one compute for pairs, another for lists and a third for bonds")
                    .into());
            }
            list.push((of, getter));
        }
        let (of, touching) = (list[0].0, cutoff == Cutoff::Radius);
        let style = cx.world.particles.style;
        if of == Of::Bond && !style.peri && !style.bonded {
            return fail(Code::INCOMPLETE, cx.span, "these attributes need `atom_style bond`");
        }
        if touching {
            super::need_spheres("`cutoff radius`", cx)?;
        }
        let getters = list.into_iter().map(|(_, g)| g).collect();
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, of, touching, getters }))
    }
}

fn attribute(word: &Word) -> Result<(Of, Getter)> {
    let name = word.text.as_str();
    if let Some((_, found)) = ATTRIBUTES.iter().find(|a| a.0 == name) {
        return Ok(*found);
    }
    if ELSEWHERE.contains(&name) {
        let d = Diagnostic::error(Code::NOT_SUPPORTED, word.span, format!("`{name}` is not in perigrain"));
        return Err(d.help("pairs are patom1 patom2 ptype1 ptype2, lists natom1 …, bonds batom1 …").into());
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
    /// `cutoff radius`.
    touching: bool,
    getters: Vec<Getter>,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { local: self.getters.len(), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let me = self.clone();
        let alone = me.of == Of::Bond || (me.of == Of::Contact && me.touching);
        let mut probes = if alone { vec![] } else { answering(&self.id, cx)? };
        let reads = if alone {
            X | RADIUS | MASK | FAMILIES | TAG | BOX | BONDS | KIND | MOLECULE
        } else {
            X | V
                | OMEGA
                | RADIUS
                | MASS
                | KIND
                | MASK
                | CONTACTS
                | BONDS
                | BOX
                | COLUMNS
                | FACTS
                | FAMILIES
                | TAG
                | LISTS
                | MEMO
                | MOLECULE
                | TRAVEL
                | VOLUME
                | X0
        };
        Ok(fill(&self.id, &Wanted { slot, stage, when }, reads, move |w, _, out| {
            let has = |i: usize| w.particles.mask[i] & me.group.bit() != 0;
            let mut rows: Vec<Row> = vec![];
            match me.of {
                Of::List => {
                    for probe in &probes {
                        let listed = probe.listed(w)?.into_iter();
                        let chosen = listed.filter(|p| p.iter().all(|&i| has(i as usize)));
                        rows.extend(chosen.map(|[i, j]| Row::of(w, i, j)));
                    }
                    rows.sort_by_key(|r| r.tags);
                }
                Of::Contact if !me.touching => {
                    let found = look_all(&mut probes, w, Request::Idle)?;
                    let chosen = found.iter().filter(|p| of_group(w, me.group, p));
                    rows.extend(chosen.map(|p| Row::of(w, p.i, p.j)));
                }
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn touching_spheres() {
        let style = AtomStyle { sphere: true, ..AtomStyle::default() };
        let mut b = Bench::new(style, &[[0.0; 3], [0.9, 0.0, 0.0], [0.9, 0.9, 0.0], [5.0; 3]]);
        b.world.particles.radius.fill(0.5);
        let c = b.compute(&PropertyLocal, "patom2 patom1 cutoff radius").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().local, [2.0, 1.0, 3.0, 2.0]);
        for words in [
            "",
            "patom1 batom1 cutoff radius",
            "patom1 natom1",
            "batom1",
            "patom1 cutoff skin",
            "patom3",
            "cutoff radius",
        ] {
            assert!(b.compute(&PropertyLocal, words).is_err(), "{words}");
        }
    }
}
