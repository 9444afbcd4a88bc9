//! `create_bonds`: bonds between particles that are there.

mod angle;
mod gap;

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::Args;
use perigrain_neigh::list::{Pair, Reach, View, pairs};
use perigrain_styles::common::{self, on_particles};
use perigrain_styles::near::{every_type, room_for_pairs};
use perigrain_styles::words::{At, BondType, Forms, Kind, Syntax, Value, Words};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::index::Index;
use perigrain_world::{Allowed, Bond, GroupId, Partners, World};

/// The command.
pub struct CreateBonds;

impl Style for CreateBonds {
    fn name(&self) -> &'static str {
        "create_bonds"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(Line::FORMS),
            summary: "Makes bonds between particles.",
            text: "Of `many` and `gap`: pairs that `neigh_modify exclude` or the weights of `special_bonds` (0 for both kinds) take \
                   out of neighbour lists get no bond: so no pair is bonded twice, and the weight of bonded pairs must be 0. With \
                   the default weights particles two or three bonds apart are left out, too: a warning says how many and what would \
                   bond them. LAMMPS also needs a pair style that reaches as far; perigrain does not.\n\n\
                   A negative GMIN takes in spheres that overlap so far, as packings leave them; a warning counts those that a \
                   larger one leaves out. `single/dihedral` and `single/improper` are refused.",
            example: "units lj\natom_style bond\nlattice sc 1.0\nregion b block 0 4 0 4 0 4\n\
                      create_box 1 b bond/types 1 extra/bond/per/atom 6\ncreate_atoms 1 box\nmass 1 1.0\n\
                      create_bonds many all all 1 0.9 1.1\nprint \"$(bonds) bonds\"",
        }
    }
}

#[derive(Words)]
#[word(
    forms = "create_bonds",
    what = "style of create_bonds",
    style,
    refused = "single/dihedral single/improper"
)]
enum Line {
    /// A bond between each particle of one group and each of the other whose distance lies between RMIN and RMAX, both included.
    Many(Many),
    /// As `many`, for spheres whose surfaces are GMIN to GMAX apart (distance less both radii, both ends included); perigrain's own.
    Gap(gap::Line),
    /// One bond between two ids.
    #[word("single/bond")]
    Bond(One),
    /// An angle at the second of three ids, which exerts nothing (`angle_style zero`).
    #[word("single/angle")]
    Angle(angle::Line),
}

#[derive(Words)]
struct Many {
    #[word(name = "GROUP1 GROUP2")]
    groups: [GroupId; 2],
    #[word(name = "TYPE")]
    kind: BondType,
    /// The smallest distance [length].
    #[word(name = "RMIN", non_negative)]
    least: f64,
    /// The largest distance [length].
    #[word(name = "RMAX", non_negative)]
    most: At<f64>,
    #[word(flatten)]
    special: Special,
}

#[derive(Words)]
struct One {
    #[word(name = "TYPE")]
    kind: BondType,
    #[word(name = "ID1 ID2")]
    ids: [At<Id>; 2],
    #[word(flatten)]
    special: Special,
}

/// Whether it is decided anew which pairs count as bonded.
#[derive(Words)]
struct Special {
    /// `no` leaves open for now which pairs count as bonded, of `single/bond` alone: the last of many such lines needs `yes`.
    #[word(keyword = "special", what = "special", shown = "yes")]
    given: Option<At<bool>>,
}

impl Special {
    fn is_on(&self) -> bool {
        self.given.as_ref().is_none_or(|given| given.value)
    }

    /// Refuses `no`, which goes with single bonds.
    fn refuse_no(&self) -> Result<()> {
        match &self.given {
            Some(given) if !given.value => {
                fail(Code::CONFLICT, given.span, "`special no` goes with single/bond only")
            }
            _ => Ok(()),
        }
    }
}

/// The id of a particle.
#[derive(Clone, Copy)]
struct Id(u32);

impl Value for Id {
    const KIND: Kind = Kind::Whole;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let span = args.here();
        let k = args.integer_from(1, "an id")?;
        match u32::try_from(k) {
            Ok(k) => Ok(Self(k)),
            Err(_) => fail(Code::BAD_VALUE, span, format!("ids go from 1 to {}, not {k}", u32::MAX)),
        }
    }
}

enum Choice {
    Many { groups: [GroupId; 2], range: [f64; 2], at: Span },
    Gap(gap::Gap),
    Single { ids: [u32; 2], spans: [Span; 2] },
}

impl CommandStyle for CreateBonds {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        if !cx.world.particles.style.bonded {
            let text = format!("particles of atom_style {} have no bonds", cx.world.particles.style.name());
            let d = Diagnostic::error(Code::CONFLICT, a.name_span(), text);
            return Err(d.help("`atom_style bond`, alone or in a hybrid, has them").into());
        }
        let style = a.here();
        let (kind, choice, special) = match Line::form(a, cx)? {
            Line::Many(line) => many(line, a, cx)?,
            Line::Gap(line) => line.read(style, a, cx)?,
            Line::Bond(line) => single(line)?,
            Line::Angle(line) => return line.read(a, cx),
        };
        if !matches!(choice, Choice::Single { .. }) {
            special.refuse_no()?;
        }
        Ok(on_particles(vec![], move |cx| create(cx, kind.0, &choice, special.is_on())))
    }
}

fn many(line: Many, a: &Args, cx: &BuildCx) -> Result<(BondType, Choice, Special)> {
    let Many { groups, kind, least, most: At { value: most, span, .. }, special } = line;
    if most < least {
        let text = format!("the largest distance {most} is below the smallest, {least}");
        return fail(Code::BAD_VALUE, span, text);
    }
    needs_zero_weights("many", a, cx)?;
    Ok((kind, Choice::Many { groups, range: [least, most], at: span }, special))
}

/// Refuses weights that leave bonded pairs in neighbour lists.
fn needs_zero_weights(style: &str, a: &Args, cx: &BuildCx) -> Result<()> {
    let weights = cx.world.bonds.weights;
    if weights.lj[0] == 0.0 && weights.coul[0] == 0.0 {
        return Ok(());
    }
    let text = format!(
        "create_bonds {style} needs `special_bonds` weights 0 for bonded pairs, or they would be bonded twice"
    );
    let d = Diagnostic::error(Code::CONFLICT, a.name_span(), text);
    Err(d.help("put `special_bonds lj/coul 0.0 1.0 1.0` before this line").into())
}

fn single(One { kind, ids, special }: One) -> Result<(BondType, Choice, Special)> {
    let (spans, ids) = (ids.map(|id| id.span), ids.map(|id| id.value.0));
    if ids[0] == ids[1] {
        return fail(Code::BAD_VALUE, spans[1], "a bond needs two different particles");
    }
    Ok((kind, Choice::Single { ids, spans }, special))
}

fn create(cx: &mut ActCx, kind: u16, choice: &Choice, special: bool) -> Result<()> {
    let kind = i32::from(kind);
    match choice {
        Choice::Single { ids, spans } => {
            let p = &cx.world.particles;
            let index = Index::new(&p.tag);
            if let Some(k) = (0..2).find(|&k| index.find(ids[k], &p.tag).is_none()) {
                return fail(Code::UNKNOWN_NAME, spans[k], format!("there is no particle {}", ids[k]));
            }
            cx.world.bonds.push(Bond::new(kind, *ids));
        }
        Choice::Many { groups, range, at } => {
            common::settle(cx.world);
            // Both ends of the range count: the list's own test is open above.
            let reach = Reach::Fixed(range[1] * (1.0 + 1e-12));
            room_for_pairs(cx.world, &every_type(cx.world, reach), 0.0).map_err(|e| e.at(*at))?;
            let near = |_: &Pair, square: f64| square >= range[0] * range[0] && square <= range[1] * range[1];
            let found = within(cx.world, *groups, reach, near);
            found.note_left_out(cx);
            add(cx, found.ends.into_iter().map(|ends| Bond::new(kind, ends)));
        }
        Choice::Gap(gap) => {
            common::settle(cx.world);
            let new = gap.find(cx, kind)?;
            add(cx, new.into_iter());
        }
    }
    if special {
        cx.world.bonds.find_special();
    }
    cx.world.touch();
    Ok(())
}

/// Adds bonds and logs their number.
fn add(cx: &mut ActCx, new: impl Iterator<Item = Bond>) {
    let before = cx.world.bonds.len();
    new.for_each(|bond| cx.world.bonds.push(bond));
    let now = cx.world.bonds.len();
    cx.print(format!("Added {} bonds, new total = {now}", now - before));
}

/// Pairs of ids in range, ascending.
struct Found {
    /// Those to be bonded.
    ends: Vec<[u32; 2]>,
    /// Those two or three bonds apart whose weights keep them out of neighbour lists.
    apart: Vec<[u32; 2]>,
    /// Those that `neigh_modify exclude` keeps out.
    excluded: Vec<[u32; 2]>,
}

impl Found {
    /// Warns of pairs in range that get no bond, with what would give them one.
    fn note_left_out(&self, cx: &ActCx) {
        let ways = [
            (
                &self.apart,
                "two or three bonds apart, which `special_bonds` gives the weight 0",
                "put `special_bonds lj/coul 0 1 1` before this line to bond them too",
            ),
            (
                &self.excluded,
                "excluded by `neigh_modify exclude`",
                "put `neigh_modify exclude` behind this line to bond them too",
            ),
        ];
        for (pairs, why, help) in ways.into_iter().filter(|way| !way.0.is_empty()) {
            let n = pairs.len();
            let subject = if n == 1 {
                "pair in range was left out: it is"
            } else {
                "pairs in range were left out: they are"
            };
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, None, format!("{n} {subject} {why}")).help(help));
        }
    }
}

/// Finds the pairs within reach that `near` takes by the square of their distance, and that have no bond yet.
fn within(w: &World, groups: [GroupId; 2], reach: Reach, mut near: impl FnMut(&Pair, f64) -> bool) -> Found {
    let p = &w.particles;
    let wanted = every_type(w, reach);
    let view = View { x: &p.x, tag: &p.tag, kind: &p.kind, radius: &p.radius, period: w.periods() };
    let is = |i: usize, g: GroupId| p.mask[i] & g.bit() != 0;
    let partners = Partners::new(w);
    let tags = |q: &Pair| {
        let [i, j] = [q.i, q.j].map(|k| p.tag[k as usize]);
        [i.min(j), i.max(j)]
    };
    let keep =
        |i: usize, j: usize| (is(i, groups[0]) && is(j, groups[1])) || (is(j, groups[0]) && is(i, groups[1]));
    let square = |q: &Pair| {
        let d = view.difference(q);
        d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
    };
    let allowed = Allowed::excluded(w);
    let mut found = Found { ends: vec![], apart: vec![], excluded: vec![] };
    for q in pairs(&view, &wanted, 0.0, &keep).iter().filter(|q| q.i != q.j) {
        if !near(q, square(q)) {
            continue;
        }
        let (ends, apart) = (tags(q), partners.unlisted([q.i, q.j].map(|k| k as usize)));
        let list = match apart {
            Some(1) => continue,
            Some(_) => &mut found.apart,
            None if allowed.pair(q.i as usize, q.j as usize) => &mut found.ends,
            None => &mut found.excluded,
        };
        // Of several images of one pair one is enough.
        if list.last() != Some(&ends) {
            list.push(ends);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::{act, more, refused, scene};

    // Oracle: the same lines in LAMMPS add 81 bonds, then none (bonded pairs are out of its lists), then 6.
    #[test]
    fn neighbours_on_a_lattice() {
        let mut w = scene(
            "units lj\natom_style bond\nlattice sc 1\nregion b block 0 3 0 3 0 3\ncreate_box 1 b bond/types 2",
        );
        more(&mut w, "create_atoms 1 box");
        assert_eq!(
            act(&mut w, "create_bonds many all all 1 0.9 1", &[]).unwrap(),
            ["Added 81 bonds, new total = 81"]
        );
        assert_eq!(
            act(&mut w, "create_bonds many all all 1 0.9 1", &[]).unwrap(),
            ["Added 0 bonds, new total = 81"]
        );
        assert_eq!(refused(&w, "create_bonds many all all 3 0.9 1").0, "3");
        assert_eq!(refused(&w, "create_bonds many all all 1 1.9 1").0, "1");
        assert_eq!(refused(&w, "create_bonds single/bond 1 7 7").0, "7");
        // Particles of atom_style bond have no angles.
        assert_eq!(refused(&w, "create_bonds single/angle 1 7 8 9").0, "create_bonds");
        more(&mut w, "special_bonds lj 0 1 1 coul 1 1 1");
        assert_eq!(refused(&w, "create_bonds many all all 1 1.9 2").0, "create_bonds");
    }
}
