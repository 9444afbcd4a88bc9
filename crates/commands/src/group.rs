//! `group`: named sets of particles.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, Param, ValueRef, Word};
use perigrain_styles::common::{self, free_id, in_group, setting, whole};
use perigrain_styles::surface::{check_volumes, choose};
use perigrain_styles::words::{
    Alternative, At, AtomVariable, Forms, Grammar, Kind, Part, Syntax, Value, Words,
};
use perigrain_styles::{ActCx, BuildCx, Doc, Style, UseKind};
use perigrain_world::region::Variable;
use perigrain_world::surface::{Rule, Surface};
use perigrain_world::{Dynamic, GroupId, Key, Particles, Region};
use std::collections::BTreeSet;

/// The command.
pub struct Group;

impl Style for Group {
    fn name(&self) -> &'static str {
        "group"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(Line::FORMS),
            summary: "Names a set of particles, or adds particles to it.",
            text: "Membership is decided now and stays, but for dynamic groups. A group that exists already gains the particles \
                   named. `A:B:C` counts from A to B by C; `<> A B` is between, both included. At most 32 groups, `all` among them.\n\n\
                   A dynamic group is chosen when forces have been computed, before fixes act on them.\n\n\
                   `surface` is for the hybrid particles of peridynamic solids, which meet grains, other solids and walls as \
                   spheres (`set … peri/radius`). Neighbours are counted in bonds that live, before the first run in places closer \
                   than 1.25 V^⅓. With `every` cracks and craters get surfaces.\n\n\
                   As long as a surface exists, other particles of PARENT have no contacts, and two particles that were in one \
                   family have none with each other, whether their bond lives or not (`peri_modify family broken`: as long as it \
                   lives): a solid meets itself only farther apart. The short-range force of peridynamic styles acts besides, \
                   unless `peri_modify repulsion no`. Hybrid particles do not turn: move them by `fix nve`.",
            example: "group bullet region ball",
        }
    }
}

#[derive(Words)]
#[word(forms = "group ID", what = "style of group", style)]
#[allow(clippy::large_enum_variant)] // there is one at a time, while a line is read
enum Line {
    /// Particles of these types.
    Type(OfTypes),
    /// Particles with these ids.
    Id(WithIds),
    /// Particles of molecules with these IDs.
    Molecule(OfMolecules),
    /// All molecules of which some particle is in the group already.
    Include(Included),
    /// Particles inside a region.
    Region(InRegion),
    /// Particles for which an atom-style variable is not zero.
    Variable(Chosen),
    /// Particles that are in one of the groups at least.
    Union(AnyOf),
    /// Particles that are in all of the groups.
    Intersect(Several),
    /// Members of the first group that are in none of the others.
    Subtract(Several),
    /// No particles.
    Empty,
    /// The group stays, without members.
    Clear,
    /// The group is gone.
    Delete,
    /// The members are chosen anew at the start of each run and every N steps.
    Dynamic(Following),
    /// The particles at the surface of the solids in a group.
    Surface(AtSurface),
    /// A dynamic group stays as it is.
    Static,
}

#[derive(Words)]
struct OfTypes {
    #[word(name = "A:B:C…", what = "a type")]
    numbers: Numbers,
}

#[derive(Words)]
struct WithIds {
    #[word(name = "A:B:C…", what = "an id")]
    numbers: Numbers,
}

#[derive(Words)]
struct OfMolecules {
    #[word(name = "A:B:C…", what = "a molecule")]
    numbers: Numbers,
}

#[derive(Words)]
struct Included {
    #[word(name = "what")]
    _what: Molecule,
}

#[derive(Words)]
#[word(what = "style of group include")]
enum Molecule {
    Molecule,
}

#[derive(Words)]
struct InRegion {
    #[word(name = "ID")]
    region: Region,
}

#[derive(Words)]
struct Chosen {
    #[word(name = "NAME")]
    variable: AtomVariable,
}

#[derive(Words)]
struct AnyOf {
    #[word(name = "ID", least = 1)]
    groups: Vec<GroupId>,
}

#[derive(Words)]
struct Several {
    #[word(name = "ID", least = 2)]
    groups: Vec<GroupId>,
}

#[derive(Words)]
#[word(refused = "property exclude include within")]
struct Following {
    /// The group of which members are chosen.
    #[word(name = "PARENT", what = "the parent group", kind = Kind::Group)]
    parent: Word,
    /// Only inside this region.
    #[word(keyword, name = "ID")]
    region: Option<Key<Region>>,
    /// Only where this atom-style variable is not zero.
    #[word(keyword, name = "NAME")]
    var: Option<AtomVariable>,
    /// The interval [steps].
    #[word(keyword, name = "N", from = 1, default = 1)]
    every: i64,
}

#[derive(Words)]
struct AtSurface {
    /// The group of the solids.
    #[word(name = "PARENT", kind = Kind::Group)]
    parent: Word,
    /// Particles with fewer nearest neighbours.
    #[word(keyword, name = "K", what = "the number of nearest neighbours inside", from = 1, shown = "6")]
    nn: Option<At<usize>>,
    /// Particles whose Σ r² V is below F times the largest, in place of `nn`.
    #[word(keyword, name = "F", what = "the part of the largest weighted volume", positive)]
    mfrac: Option<At<f64>>,
    /// The number of layers in all.
    #[word(keyword, name = "S", from = 1, default = 1)]
    shells: usize,
    /// The choice is made anew in the setup of each run and every N steps.
    #[word(keyword, name = "N", what = "the interval", from = 1)]
    every: Option<i64>,
}

/// Which particles join.
enum Choice {
    Empty,
    Kind(Numbers),
    Tag(Numbers),
    Molecule(Numbers),
    /// Whole molecules of which a particle is in the group.
    Include,
    Region(Box<Region>),
    Variable(ValueRef),
    Union(Vec<GroupId>),
    Intersect(Vec<GroupId>),
    Subtract(Vec<GroupId>),
}

/// A set of whole numbers.
enum Numbers {
    /// First, last, step.
    Listed(Vec<(i64, i64, i64)>),
    Compared(&'static str, i64),
    Between(i64, i64),
}

/// The words that compare with a number.
const OPERATORS: [&str; 6] = ["<", "<=", ">", ">=", "==", "!="];

/// A number behind one of them.
const NUMBER: [Part; 1] = [Part::bare("N", Kind::Whole)];

impl Value for Numbers {
    const KIND: Kind = Kind::Or(
        &Kind::Choice(&[
            Alternative { word: "<", about: "", parts: &NUMBER },
            Alternative { word: "<=", about: "", parts: &NUMBER },
            Alternative { word: ">", about: "", parts: &NUMBER },
            Alternative { word: ">=", about: "", parts: &NUMBER },
            Alternative { word: "==", about: "", parts: &NUMBER },
            Alternative { word: "!=", about: "", parts: &NUMBER },
            Alternative {
                word: "<>",
                about: "",
                parts: &[Part::bare("A", Kind::Whole), Part::bare("B", Kind::Whole)],
            },
        ]),
        &Kind::Words(&Grammar {
            parts: &[Part::Many(&[Part::bare("A", Kind::Text)], 1)],
            keywords: &[],
            refused: &[],
        }),
    );
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        numbers(args, what)
    }
}

impl Numbers {
    fn contain(&self, k: i64) -> bool {
        match self {
            Numbers::Listed(list) => list.iter().any(|&(a, b, c)| k >= a && k <= b && (k - a) % c == 0),
            Numbers::Between(a, b) => k >= *a && k <= *b,
            Numbers::Compared(op, v) => match *op {
                "<" => k < *v,
                "<=" => k <= *v,
                ">" => k > *v,
                ">=" => k >= *v,
                "==" => k == *v,
                _ => k != *v,
            },
        }
    }
}

impl CommandStyle for Group {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let word = a.expect("the group's ID")?;
        let name = free_id(word, "the group's ID")?;
        let (style, span) = (a.peek_text(), a.here());
        if !["delete", "clear", "static"].contains(&style) {
            if name == "all" {
                return fail(Code::BAD_VALUE, word.span, "the group `all` cannot be changed");
            }
            if cx.world.groups.find(&name).is_none() && cx.world.groups.names().count() == 32 {
                return fail(Code::TOO_LARGE, word.span, "there are 32 groups already; delete one first");
            }
        }
        if ["molecule", "include"].contains(&style) && !cx.world.particles.style.molecules {
            return fail(Code::CONFLICT, span, "particles of this atom_style belong to no molecules");
        }
        let choice = match Line::form(a, cx)? {
            Line::Delete => return delete(cx, word, name),
            Line::Clear => return clear(cx, word),
            Line::Static => return make_static(cx, word),
            Line::Dynamic(line) => return dynamic(line, cx, name),
            Line::Surface(line) => return surface(line, cx, span, name),
            Line::Type(line) => Choice::Kind(line.numbers),
            Line::Id(line) => Choice::Tag(line.numbers),
            Line::Molecule(line) => Choice::Molecule(line.numbers),
            Line::Include(_) => Choice::Include,
            Line::Region(line) => Choice::Region(Box::new(line.region)),
            Line::Variable(line) => Choice::Variable(line.variable.0),
            Line::Union(line) => Choice::Union(line.groups),
            Line::Intersect(line) => Choice::Intersect(line.groups),
            Line::Subtract(line) => Choice::Subtract(line.groups),
            Line::Empty => Choice::Empty,
        };
        if cx.world.groups.find(&name).is_some_and(|g| cx.world.groups.dynamic(g).is_some()) {
            let text = format!("the dynamic group `{name}` chooses its particles itself");
            let d = Diagnostic::error(Code::CONFLICT, word.span, text);
            return Err(d.help(format!("write `group {name} static` first")).into());
        }
        Ok(setting(move |cx| join(cx, &name, &choice)))
    }
}

fn delete(cx: &BuildCx, word: &Word, name: String) -> Result<Box<dyn Act>> {
    let group = cx.group(word)?;
    if group == GroupId::ALL {
        return fail(Code::BAD_VALUE, word.span, "the group `all` cannot be deleted");
    }
    cx.unused(UseKind::Group, word)?;
    if let Some(child) = cx.world.groups.child_of(&name) {
        let text = format!("group `{name}` is the parent of the dynamic group `{child}`");
        return fail(Code::CONFLICT, word.span, text);
    }
    let n = &cx.world.settings.neighbor;
    let pair = |&(a, b): &(u32, u32)| a == group.bit() || b == group.bit();
    if n.exclude_groups.iter().any(pair) || n.exclude_molecules.iter().any(|(g, _)| *g == group.bit()) {
        let text = format!("group `{name}` is still used by neigh_modify exclude");
        return fail(Code::CONFLICT, word.span, text);
    }
    Ok(setting(move |cx| {
        if let Some(group) = cx.world.groups.find(&name) {
            cx.world.particles.mask.iter_mut().for_each(|m| *m &= !group.bit());
            cx.world.groups.remove(group);
        }
        Ok(())
    }))
}

fn clear(cx: &BuildCx, word: &Word) -> Result<Box<dyn Act>> {
    let group = cx.group(word)?;
    if group == GroupId::ALL {
        return fail(Code::BAD_VALUE, word.span, "the group `all` cannot be cleared");
    }
    Ok(setting(move |cx| {
        cx.world.particles.mask.iter_mut().for_each(|m| *m &= !group.bit());
        Ok(())
    }))
}

fn make_static(cx: &BuildCx, word: &Word) -> Result<Box<dyn Act>> {
    let group = cx.group(word)?;
    let name = word.text.clone();
    Ok(setting(move |cx| {
        cx.world.groups.set_dynamic(group, None);
        if let Some((_, s)) = cx.world.groups.surfaces().iter().find(|(g, _)| *g == group).copied() {
            cx.world.groups.set_surface(group, Some(Surface { every: None, ..s }));
        }
        log_count(cx, group, &name);
        Ok(())
    }))
}

fn dynamic(line: Following, cx: &BuildCx, name: String) -> Result<Box<dyn Act>> {
    let Following { parent: parent_word, region, var, every } = line;
    let parent = cx.group(&parent_word)?;
    if parent_word.text == name || cx.world.groups.dynamic(parent).is_some() {
        let text = format!("the parent `{}` of a dynamic group must be a static group", parent_word.text);
        return fail(Code::CONFLICT, parent_word.span, text);
    }
    if let Some(child) = cx.world.groups.child_of(&name) {
        let text = format!("`{name}` cannot be dynamic: the dynamic group `{child}` chooses from it");
        return fail(Code::CONFLICT, cx.span, text);
    }
    let variable = var.map(|AtomVariable(r)| Variable { name: r.name, span: r.span });
    let rule = Dynamic { parent, region: region.map(|key| key.text().to_string()), variable, every };
    Ok(setting(move |cx| {
        let Some(group) = cx.world.groups.find_or_add(&name) else {
            return fail(Code::TOO_LARGE, None, "there are 32 groups already; delete one first");
        };
        cx.world.groups.set_dynamic(group, Some(rule));
        cx.print(format!("dynamic group {name} defined"));
        Ok(())
    }))
}

fn surface(line: AtSurface, cx: &BuildCx, style: Span, name: String) -> Result<Box<dyn Act>> {
    if !cx.world.particles.style.peri || !cx.world.particles.style.sphere {
        let text =
            "hybrid particles have a volume and a radius, and particles of this atom_style have not both";
        return Err(Diagnostic::error(Code::CONFLICT, style, text)
            .help("put `atom_style hybrid sphere peri` at the top of the deck")
            .into());
    }
    let AtSurface { parent: word, nn, mfrac, shells, every } = line;
    let parent = cx.group(&word)?;
    if word.text == name {
        return fail(Code::CONFLICT, word.span, "a surface cannot be that of itself");
    }
    let rule = match (&nn, &mfrac) {
        (nn, Some(part)) if nn.as_ref().is_none_or(|nn| nn.span.start < part.span.start) => {
            Rule::Weight(part.value)
        }
        (Some(nn), _) => Rule::Neighbours(nn.value),
        (None, _) => Rule::Neighbours(6),
    };
    let found = Surface { parent, rule, shells, every };
    let span = word.span;
    let made = Some(name.clone());
    Ok(in_group(vec![], made, move |cx| {
        let bit = found.parent.bit();
        let mask = &cx.world.particles.mask;
        let solid: Vec<usize> = (0..mask.len()).filter(|&i| mask[i] & bit != 0).collect();
        check_volumes(cx.world, &solid, span)?;
        let Some(group) = cx.world.groups.find_or_add(&name) else {
            return fail(Code::TOO_LARGE, None, "there are 32 groups already; delete one first");
        };
        cx.world.groups.set_surface(group, Some(found));
        choose(cx.world, group.bit(), &found);
        cx.world.touch();
        log_count(cx, group, &name);
        Ok(())
    }))
}

/// Logs how many particles a group has now.
fn log_count(cx: &mut ActCx, group: GroupId, name: &str) {
    let count = cx.world.particles.mask.iter().filter(|m| **m & group.bit() != 0).count();
    cx.print(format!("{count} atoms in group {name}"));
}

fn numbers(a: &mut Args, what: &str) -> Result<Numbers> {
    if a.eat("<>") {
        return Ok(Numbers::Between(a.integer(what)?, a.integer(what)?));
    }
    if let Some(op) = OPERATORS.iter().find(|op| a.peek_text() == **op) {
        a.next();
        return Ok(Numbers::Compared(op, a.integer(what)?));
    }
    let mut list = vec![sequence(a.expect(what)?, what)?];
    while let Some(word) = a.next() {
        list.push(sequence(word, what)?);
    }
    Ok(Numbers::Listed(list))
}

/// `A`, `A:B` or `A:B:C`.
fn sequence(word: &Word, what: &str) -> Result<(i64, i64, i64)> {
    let bad =
        || fail(Code::BAD_NUMBER, word.span, format!("`{}` is not {what} or a sequence A:B:C", word.text));
    let mut parts = vec![];
    for part in word.text.split(':') {
        let Ok(k) = whole(&Word { text: part.to_string(), ..word.clone() }, what) else { return bad() };
        parts.push(k);
    }
    match *parts.as_slice() {
        [a] => Ok((a, a, 1)),
        [a, b] if a <= b => Ok((a, b, 1)),
        [a, b, c] if a <= b && c >= 1 => Ok((a, b, c)),
        _ => bad(),
    }
}

fn join(cx: &mut ActCx, name: &str, choice: &Choice) -> Result<()> {
    let values = match choice {
        Choice::Variable(r) if cx.world.n() > 0 => cx.per_atom(&Param::Ref(r.clone()))?,
        _ => vec![],
    };
    let Some(group) = cx.world.groups.find_or_add(name) else {
        return fail(Code::TOO_LARGE, None, "there are 32 groups already; delete one first");
    };
    let particles = &mut cx.world.particles;
    if matches!(choice, Choice::Include) {
        include_molecules(particles, group);
    }
    let joins: Vec<bool> = (0..particles.len()).map(|i| chosen(choice, particles, &values, i)).collect();
    for (mask, _) in particles.mask.iter_mut().zip(joins).filter(|(_, j)| *j) {
        *mask |= group.bit();
    }
    log_count(cx, group, name);
    Ok(())
}

/// Takes in the whole of each molecule of which a member is there; molecule 0 is none.
fn include_molecules(p: &mut Particles, group: GroupId) {
    let there: BTreeSet<u32> = p
        .mask
        .iter()
        .zip(&p.molecule)
        .filter(|(m, id)| **m & group.bit() != 0 && **id != 0)
        .map(|(_, id)| *id)
        .collect();
    for (mask, _) in p.mask.iter_mut().zip(&p.molecule).filter(|(_, id)| there.contains(id)) {
        *mask |= group.bit();
    }
}

fn chosen(choice: &Choice, p: &Particles, values: &[f64], i: usize) -> bool {
    let within = |g: &GroupId| p.mask[i] & g.bit() != 0;
    match choice {
        Choice::Empty => false,
        Choice::Kind(set) => set.contain(i64::from(p.kind[i])),
        Choice::Tag(set) => set.contain(i64::from(p.tag[i])),
        Choice::Molecule(set) => set.contain(i64::from(p.molecule[i])),
        Choice::Include => false,
        Choice::Region(region) => region.contains(p.x[i]),
        Choice::Variable(_) => values[i] != 0.0,
        Choice::Union(list) => list.iter().any(within),
        Choice::Intersect(list) => list.iter().all(within),
        Choice::Subtract(list) => within(&list[0]) && !list[1..].iter().any(within),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{act, more, refused, scene};
    use perigrain_world::World;

    fn bar() -> World {
        let mut w = scene("units si\nboundary s p f\nlattice sc 0.5\nregion b block 0 4 0 3 0 3 units box");
        more(&mut w, "create_box 2 b\ncreate_atoms 1 box");
        w
    }

    fn count(w: &World, name: &str) -> usize {
        let bit = w.groups.find(name).unwrap().bit();
        w.particles.mask.iter().filter(|m| **m & bit != 0).count()
    }

    // Oracle: the same lines on the same 324 particles; LAMMPS prints 50, 12, 9, 56, 44, 6.
    #[test]
    fn counts_are_lammps_counts() {
        let mut w = bar();
        assert_eq!(w.n(), 324);
        assert_eq!(act(&mut w, "group odd id 1:99:2", &[]).unwrap(), ["50 atoms in group odd"]);
        more(&mut w, "group lo id <= 12\ngroup mid id <> 12 20\ngroup u union odd lo");
        more(
            &mut w,
            "group s subtract odd lo\ngroup i intersect odd lo\nregion r block INF 0.5 INF INF INF INF units box",
        );
        assert_eq!(["lo", "mid", "u", "s", "i"].map(|g| count(&w, g)), [12, 9, 56, 44, 6]);
        more(
            &mut w,
            "group e region r\ngroup lo id 13 20:21\ngroup mid clear\ngroup u delete\ngroup t type != 2",
        );
        assert_eq!(["e", "lo", "mid", "t"].map(|g| count(&w, g)), [72, 15, 0, 324]);
        assert!(w.groups.find("u").is_none());
        let small = |w: &World, i: usize| f64::from(u8::from(w.particles.x[i][0] < 0.1));
        act(&mut w, "group v variable small", &[("small", small)]).unwrap();
        assert_eq!(count(&w, "v"), 36);
    }

    #[test]
    fn blames_the_right_word() {
        let w = bar();
        assert_eq!(refused(&w, "group all type 1").0, "all");
        assert_eq!(refused(&w, "group g union a").0, "a");
        assert_eq!(refused(&w, "group g intersect all").1, "`group` ends too early: a group is missing");
        assert_eq!(refused(&w, "group g id 5:3").0, "5:3");
        assert_eq!(refused(&w, "group g dynamic all every 0").0, "0");
        assert_eq!(refused(&w, "group g dynamic all within 2").0, "within");
        assert_eq!(refused(&w, "group g molecule 2").0, "molecule");
        assert_eq!(refused(&w, "group g variable nix").0, "nix");
        assert_eq!(refused(&w, "group all clear").0, "all");
        assert!(refused(&World::default(), "group g type 1").1.contains("box is not defined"));
    }
}
