//! `replicate`: the scene repeated along the edges of its box.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::{self, on_particles};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{ActCx, BuildCx, Doc, Style, matter, rigid_bodies};
use perigrain_world::bonds::ascending;
use perigrain_world::index::Index;
use perigrain_world::{Angle, Bond, Domain, memory};

/// The command.
pub struct Replicate;

impl Style for Replicate {
    fn name(&self) -> &'static str {
        "replicate"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Repeats the scene along the edges of its box.",
            text: "The box grows to NX, NY, NZ times its lengths, and each particle gets a copy in each repetition, with everything \
                   that belongs to it, places that it is held to or counts its way from moved along (`fix move`, `fix spring/self`, \
                   `compute displace/atom`); contacts begin anew, and rigid bodies too; bonds join the copies of one repetition, \
                   and molecules get new IDs. Repetitions follow each other as in LAMMPS (z fastest in storage, x fastest in ids). \
                   It must come before the first run of a scene with peridynamic bonds.\n\n\
                   Without `bond/periodic` bonds through a periodic face span a whole repetition, which a warning counts.",
            example: "units lj\nlattice sc 0.5\nregion cell block 0 2 0 2 0 2\ncreate_box 1 cell\ncreate_atoms 1 box\n\
                      mass 1 1.0\nreplicate 2 2 1\nprint \"$(atoms) particles\"",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The numbers of repetitions along the edges.
    #[word(name = "NX NY", what = "the number of repetitions", from = 1)]
    across: [i64; 2],
    #[word(name = "NZ", what = "the number of repetitions", from = 1)]
    along: At<i64>,
    /// Each bond through a periodic face joins the nearest copies, so that a bonded crystal continues through all repetitions.
    #[word(flag = "bond/periodic")]
    nearest: bool,
    /// LAMMPS' faster way to the same particles; without effect.
    #[word(flag)]
    bbox: bool,
}

impl CommandStyle for Replicate {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let Line { across: [x, y], along: At { value: z, span, .. }, nearest, .. } = read(a, cx)?;
        if z > 1 && cx.world.settings.two_dimensional {
            return fail(Code::CONFLICT, span, "a flat scene cannot be repeated along z");
        }
        Ok(on_particles(vec![], move |cx| repeat(cx, [x, y, z], nearest)))
    }
}

/// Which particles of all repetitions a bond joins.
struct Joints {
    old: Domain,
    count: [i64; 3],
    /// Distance of the ids of one repetition from those of the one before.
    ids: i64,
    /// Ids and places of the particles that are repeated; images undone [length].
    tags: Vec<u32>,
    places: Vec<[f64; 3]>,
    /// Bonds join the nearest copies, not those of one repetition.
    nearest: bool,
}

impl Joints {
    /// By how many repetitions the nearest copy of the second end is away from the first.
    fn reach(&self, index: &Index, ends: [u32; 2]) -> [i64; 3] {
        let [Some(a), Some(b)] = ends.map(|tag| index.find(tag, &self.tags)) else { return [0; 3] };
        let (a, b) = (self.places[a], self.places[b]);
        let d = self.old.minimum_image([0, 1, 2].map(|k| b[k] - a[k]));
        let [here, there] = [b, [0, 1, 2].map(|k| a[k] + d[k])].map(|x| self.old.fractions(&x));
        [0, 1, 2].map(|k| if self.count[k] > 1 { (there[k] - here[k]).round() as i64 } else { 0 })
    }

    /// The ids of particles of one repetition lie this far behind those of the first.
    fn offset(&self, place: [i64; 3]) -> u32 {
        let [nx, ny, _] = self.count;
        ((place[2] * ny * nx + place[1] * nx + place[0]) * self.ids) as u32
    }

    /// The ends of a bond in the repetition at `place`.
    fn ends(&self, index: &Index, [a, b]: [u32; 2], place: [i64; 3]) -> [u32; 2] {
        let reach = if self.nearest { self.reach(index, [a, b]) } else { [0; 3] };
        let there = [0, 1, 2].map(|k| (place[k] + reach[k]).rem_euclid(self.count[k]));
        [a + self.offset(place), b + self.offset(there)]
    }
}

fn repeat(cx: &mut ActCx, count: [i64; 3], nearest: bool) -> Result<()> {
    if cx.world.families.is_some() {
        let d = Diagnostic::error(Code::WRONG_ORDER, None, "peridynamic bonds cannot be repeated");
        return Err(d.help("put `replicate` before the first run").into());
    }
    let (n, last) = (cx.world.n(), i64::from(cx.world.particles.last_tag()));
    let copies = count.iter().try_fold(1, |product: i64, k| product.checked_mul(*k));
    let ids = i64::from(u32::MAX);
    let Some(copies) = copies.filter(|k| last.max(1).checked_mul(*k).is_some_and(|n| n <= ids)) else {
        let [x, y, z] = count;
        let asked = count.iter().fold(last.max(1) as f64, |product, k| product * *k as f64);
        let text = format!("{x} x {y} x {z} repetitions are {asked:.3e} particles: there are ids for {ids}");
        return fail(Code::TOO_LARGE, None, text);
    };
    if let Some(line) = memory::forecast(cx.world, (n as i64 * (copies - 1)) as f64)? {
        cx.print(line);
    }
    let old = cx.world.domain()?.clone();
    let [nx, ny, nz] = count;
    cx.print(format!("Replication is creating a {nx}x{ny}x{nz} = {copies} times larger system..."));
    if (0..3).any(|d| count[d] > 1 && !old.boundary.periodic(d)) {
        let text = "the scene is repeated along a dimension whose faces are not periodic";
        cx.note(Diagnostic::warning(Code::SUSPICIOUS, None, text));
    }
    let domain = larger(&old, count);
    let unwrapped: Vec<[f64; 3]> = (0..n).map(|i| matter::unwrapped(cx.world, i)).collect();
    let from: Vec<usize> = (0..copies).flat_map(|_| 0..n).collect();
    let edges = old.edges();
    let tags = cx.world.particles.tag.to_vec();
    let index = Index::new(&tags);
    let joints = Joints { old: old.clone(), count, ids: last, tags, places: unwrapped, nearest };
    if !nearest {
        let far = cx.world.bonds.list.iter().filter(|b| joints.reach(&index, b.ends) != [0; 3]).count();
        if far > 0 {
            let text = format!("{far} bonds through periodic faces will span whole repetitions");
            let d = Diagnostic::warning(Code::SUSPICIOUS, None, text);
            cx.note(d.help("`replicate … bond/periodic` joins the nearest copies instead"));
        }
    }
    let world = &mut *cx.world;
    let molecules = world.particles.last_molecule();
    let (bonds, special) = (std::mem::take(&mut world.bonds.list), std::mem::take(&mut world.bonds.special));
    let angles = std::mem::take(&mut world.bonds.angles.list);
    let turned = std::mem::take(&mut world.bonds.turned);
    let memory = std::mem::take(&mut world.bonds.memory);
    world.contacts.values_mut().for_each(|c| *c = Default::default());
    world.wall_contacts.values_mut().for_each(|c| *c = Default::default());
    rigid_bodies::forget(world);
    world.gather(&from);
    for copy in 0..copies {
        let place = [copy / (ny * nz), copy / nz % ny, copy % nz];
        let offset = joints.offset(place);
        let shift = edges.shift(place.map(|k| k as f64));
        let number = (place[2] * ny * nx + place[1] * nx + place[0]) as u32;
        let at = copy as usize * n;
        world.shift_copies(at..at + n, shift);
        let p = &mut world.particles;
        let moved = |ends: [u32; 2]| joints.ends(&index, ends, place);
        world.bonds.list.extend(bonds.iter().map(|b| Bond { ends: moved(b.ends), ..*b }));
        world.bonds.angles.list.extend(angles.iter().map(|angle| {
            // Both sides begin at the corner, whose copy is in this repetition.
            let [a, corner, c] = angle.ends;
            let ([corner, a], [_, c]) = (moved([corner, a]), moved([corner, c]));
            Angle { ends: [a, corner, c], ..*angle }
        }));
        world.bonds.special.extend(special.iter().map(|p| ascending(moved(*p))));
        world.bonds.memory.extend(memory.iter().map(|(ends, m)| (ascending(moved(*ends)), *m)));
        world.bonds.turned.extend(turned.iter().map(|(ends, q)| {
            // The turn is that from the lower id to the higher one; in another repetition the other end may be the lower.
            let [a, b] = moved(*ends);
            ([a.min(b), a.max(b)], if a < b { *q } else { [q[0], -q[1], -q[2], -q[3]] })
        }));
        for (k, old) in joints.places.iter().enumerate() {
            let i = at + k;
            p.tag[i] += offset;
            if let Some(m) = p.molecule.get_mut(i).filter(|m| **m > 0) {
                *m += number * molecules;
            }
            let (mut x, mut image) = ([0, 1, 2].map(|d| old[d] + shift[d]), [0; 3]);
            domain.wrap(&mut x, &mut image);
            p.x[i] = x;
            p.image.set(i, image);
        }
    }
    world.bonds.special.sort_unstable();
    world.bonds.changes += 1;
    world.domain = Some(domain).into();
    world.touch();
    log_box(cx)?;
    if let Some(domain) = &mut *cx.world.domain {
        domain.open_shrinking_faces();
    }
    cx.print("  1 by 1 by 1 MPI processor grid");
    cx.print(format!("  {} atoms", cx.world.n()));
    if !cx.world.bonds.is_empty() {
        cx.print(format!("  {} bonds", cx.world.bonds.len()));
    }
    if !cx.world.bonds.angles.list.is_empty() {
        cx.print(format!("  {} angles", cx.world.bonds.angles.list.len()));
    }
    Ok(())
}

/// The box of all repetitions.
fn larger(old: &Domain, count: [i64; 3]) -> Domain {
    let lengths = old.lengths();
    let hi = [0, 1, 2].map(|d| old.lo[d] + count[d] as f64 * lengths[d]);
    // An edge carries its tilts along.
    let times = count.map(|n| n as f64);
    let tilt = old.tilt.map(|[xy, xz, yz]| [times[1] * xy, times[2] * xz, times[2] * yz]);
    Domain { flat: old.flat, tilt, ..Domain::new(old.lo, hi, old.boundary) }
}

/// Logs where the box is, as LAMMPS does.
pub fn log_box(cx: &mut ActCx) -> Result<()> {
    let domain = cx.world.domain()?;
    let line = format!("  {}", domain.describe(domain.lo, domain.hi));
    cx.print(line);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::testing::{act, more, refused, scene};

    // Oracle: the numbers of the deck `repeated` in tests/scripts/good/scene_change.in follow the same rules.
    #[test]
    fn copies_follow_each_other_with_z_fastest_and_ids_with_x_fastest() {
        let mut w = scene("units si\natom_style sphere\nregion b block 0 2 0 3 0 4\ncreate_box 2 b");
        more(
            &mut w,
            "create_atoms 1 single 1 1 1\ncreate_atoms 2 single 0.5 2 3\ndisplace_atoms all move 1.2 0 0",
        );
        assert_eq!(w.particles.image[0], [1, 0, 0]);
        more(&mut w, "set atom 2 diameter 0.3 vx 7");
        let lines = act(&mut w, "replicate 2 1 2", &[]).unwrap();
        assert_eq!(lines[0], "Replication is creating a 2x1x2 = 4 times larger system...");
        assert_eq!(lines[3], "  8 atoms");
        let p = &w.particles;
        assert_eq!(p.tag, [1, 2, 5, 6, 3, 4, 7, 8]);
        // Unwrapped at 2.2: the copy lies at 4.2 of a box of 4.
        assert!((p.x[0][0] - 2.2).abs() < 1e-12 && (p.x[4][0] - 0.2).abs() < 1e-12);
        assert_eq!((p.image[0], p.image[4], p.x[2][2]), ([0; 3], [1, 0, 0], 5.0));
        assert_eq!((p.radius[7], p.v[7][0], p.kind[7]), (0.15, 7.0, 2));
        assert_eq!(refused(&w, "replicate 1 0 1").0, "0");
        assert_eq!(refused(&w, "replicate 1 1 1 bond/periodical").0, "bond/periodical");
    }
}
