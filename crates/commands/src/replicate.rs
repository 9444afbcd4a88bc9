//! `replicate`: the scene repeated along the edges of its box.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::{self, on_particles};
use perigrain_styles::{ActCx, BuildCx, Doc, Style, matter};
use perigrain_world::{Bond, Domain, memory};

/// The command.
pub struct Replicate;

impl Style for Replicate {
    fn name(&self) -> &'static str {
        "replicate"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "replicate NX NY NZ",
            summary: "Repeats the scene along the edges of its box.",
            text: "The box grows to NX, NY, NZ times its lengths, and each particle gets a copy in each repetition, with \
                   everything that belongs to it; bonds join the copies of one repetition, and molecules get new IDs. Repetitions follow each other as in LAMMPS (z fastest in storage, x \
                   fastest in ids). It must come before the first run of a scene with peridynamic bonds.",
            example: "units lj\nlattice sc 0.5\nregion cell block 0 2 0 2 0 2\ncreate_box 1 cell\ncreate_atoms 1 box\n\
                      mass 1 1.0\nreplicate 2 2 1\nprint \"$(atoms) particles\"",
        }
    }
}

impl CommandStyle for Replicate {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let mut count = [1; 3];
        for (d, n) in count.iter_mut().enumerate() {
            let span = a.here();
            *n = a.integer_from(1, "the number of repetitions")?;
            if d == 2 && *n > 1 && cx.world.settings.two_dimensional {
                return fail(Code::CONFLICT, span, "a flat scene cannot be repeated along z");
            }
        }
        if a.peek_text() == "bbox" {
            // LAMMPS' faster way to the same particles.
            a.next();
        }
        if let Some(word) = a.peek().filter(|w| w.text == "bond/periodic") {
            return Err(common::not_here(word, "replicate"));
        }
        Ok(on_particles(vec![], move |cx| repeat(cx, count)))
    }
}

fn repeat(cx: &mut ActCx, count: [i64; 3]) -> Result<()> {
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
        cx.say(line);
    }
    let old = cx.world.domain()?.clone();
    let [nx, ny, nz] = count;
    cx.say(format!("Replication is creating a {nx}x{ny}x{nz} = {copies} times larger system..."));
    if (0..3).any(|d| count[d] > 1 && !old.boundary.periodic(d)) {
        let text = "the scene is repeated along a dimension whose faces are not periodic";
        cx.note(Diagnostic::warning(Code::SUSPICIOUS, None, text));
    }
    let domain = larger(&old, count);
    let unwrapped: Vec<[f64; 3]> = (0..n).map(|i| matter::unwrapped(cx.world, i)).collect();
    let from: Vec<usize> = (0..copies).flat_map(|_| 0..n).collect();
    let edges = old.edges();
    let world = &mut *cx.world;
    let molecules = world.particles.last_molecule();
    let (bonds, special) = (std::mem::take(&mut world.bonds.list), std::mem::take(&mut world.bonds.special));
    let turned = std::mem::take(&mut world.bonds.turned);
    let memory = std::mem::take(&mut world.bonds.memory);
    world.contacts.values_mut().for_each(|c| *c = Default::default());
    world.wall_contacts.values_mut().for_each(|c| *c = Default::default());
    world.gather(&from);
    let p = &mut world.particles;
    for copy in 0..copies {
        let place = [copy / (ny * nz), copy / nz % ny, copy % nz];
        let offset = (place[2] * ny * nx + place[1] * nx + place[0]) * last;
        let shift = edges.shift(place.map(|k| k as f64));
        let number = (place[2] * ny * nx + place[1] * nx + place[0]) as u32;
        let moved = |ends: [u32; 2]| ends.map(|t| t + offset as u32);
        world.bonds.list.extend(bonds.iter().map(|b| Bond { ends: moved(b.ends), ..*b }));
        world.bonds.special.extend(special.iter().map(|p| moved(*p)));
        world.bonds.memory.extend(memory.iter().map(|(ends, m)| (moved(*ends), *m)));
        world.bonds.turned.extend(turned.iter().map(|(ends, q)| (moved(*ends), *q)));
        for (k, old) in unwrapped.iter().enumerate() {
            let i = copy as usize * n + k;
            p.tag[i] += offset as u32;
            if let Some(m) = p.molecule.get_mut(i).filter(|m| **m > 0) {
                *m += number * molecules;
            }
            let (mut x, mut image) = ([0, 1, 2].map(|d| old[d] + shift[d]), [0; 3]);
            if let Some(x0) = p.x0.get_mut(i) {
                *x0 = [0, 1, 2].map(|d| x0[d] + shift[d]);
            }
            domain.wrap(&mut x, &mut image);
            p.x[i] = x;
            p.image.set(i, image);
        }
    }
    world.bonds.special.sort_unstable();
    world.bonds.changes += 1;
    world.domain = Some(domain).into();
    world.touch();
    say_box(cx)?;
    if let Some(domain) = &mut *cx.world.domain {
        domain.open_shrinking_faces();
    }
    cx.say("  1 by 1 by 1 MPI processor grid");
    cx.say(format!("  {} atoms", cx.world.n()));
    if !cx.world.bonds.is_empty() {
        cx.say(format!("  {} bonds", cx.world.bonds.len()));
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

/// Says where the box is, as LAMMPS does.
pub fn say_box(cx: &mut ActCx) -> Result<()> {
    let domain = cx.world.domain()?;
    let line = format!("  {}", domain.told(domain.lo, domain.hi));
    cx.say(line);
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
        let said = act(&mut w, "replicate 2 1 2", &[]).unwrap();
        assert_eq!(said[0], "Replication is creating a 2x1x2 = 4 times larger system...");
        assert_eq!(said[3], "  8 atoms");
        let p = &w.particles;
        assert_eq!(p.tag, [1, 2, 5, 6, 3, 4, 7, 8]);
        // Unwrapped at 2.2: the copy lies at 4.2 of a box of 4.
        assert!((p.x[0][0] - 2.2).abs() < 1e-12 && (p.x[4][0] - 0.2).abs() < 1e-12);
        assert_eq!((p.image[0], p.image[4], p.x[2][2]), ([0; 3], [1, 0, 0], 5.0));
        assert_eq!((p.radius[7], p.v[7][0], p.kind[7]), (0.15, 7.0, 2));
        assert_eq!(refused(&w, "replicate 1 0 1").0, "0");
        assert_eq!(refused(&w, "replicate 1 1 1 bond/periodic").0, "bond/periodic");
    }
}
