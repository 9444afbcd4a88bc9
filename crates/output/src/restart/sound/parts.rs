//! The parts that have a length: particles and what belongs to them, one by one or in pairs.

use super::{Outcome, must};
use perigrain_world::index::twice;
use perigrain_world::{World, contacts};

pub fn particles(w: &World) -> Outcome {
    let (p, n, style) = (&w.particles, w.n(), w.particles.style);
    let own = |there: bool| if there { n } else { 0 };
    for (what, len, expected) in [
        ("ids", p.tag.len(), n),
        ("types", p.kind.len(), n),
        ("groups", p.mask.len(), n),
        ("velocities", p.v.len(), n),
        ("forces", p.f.len(), n),
        ("masses", p.mass.len(), n),
        ("radii", p.radius.len(), own(style.sphere)),
        ("angular velocities", p.omega.len(), own(style.sphere)),
        ("torques", p.torque.len(), own(style.sphere)),
        ("orientations", p.quat.len(), own(style.oriented)),
        ("dipole moments", p.mu.len(), own(style.dipole)),
        ("charges", p.charge.len(), own(style.charged)),
        ("volumes", p.volume.len(), own(style.peri)),
        ("places at creation", p.x0.len(), own(style.peri)),
        ("densities", p.density.len(), own(style.own_mass())),
        ("molecules", p.molecule.len(), own(style.molecules)),
        ("ranks", p.rank.len(), if p.rank.is_empty() { 0 } else { n }),
    ] {
        must(len == expected, &format!("the number of {what} is {len}, not {expected}"))?;
    }
    must(p.image.past().are_for(n), "images and particles differ in number")?;
    let counts = (0..n).flat_map(|i| p.image.past()[i]);
    must(counts.into_iter().all(|c| c.unsigned_abs() < 1 << 30), "a particle has crossed the box too often")?;
    let types = 1..=w.types;
    must(
        p.kind.past().iter().all(|k| types.contains(&usize::from(*k))),
        "a particle's type is beyond the number of types",
    )?;
    must(
        !p.tag.past().contains(&0) && !p.tag.past().contains(&u32::MAX),
        "a particle has an id that cannot be",
    )?;
    must(twice(p.tag.past()).is_none(), "two particles have one id")?;
    must(p.x.past().as_flattened().iter().all(|x| x.is_finite()), "a particle is nowhere")?;
    must(p.radius.past().iter().all(|r| r.is_finite() && *r >= 0.0), "a radius is no length")?;
    for (what, triples) in [
        ("velocity", p.v.past()),
        ("force", p.f.past()),
        ("angular velocity", p.omega.past()),
        ("torque", p.torque.past()),
        ("dipole moment", p.mu.past()),
    ] {
        must(!triples.as_flattened().iter().any(|x| x.is_nan()), &format!("a {what} is no number"))?;
    }
    // A density that was never set is none.
    for (what, all) in [("mass", p.mass.past()), ("volume", p.volume.past()), ("charge", p.charge.past())] {
        must(!all.iter().any(|x| x.is_nan()), &format!("a {what} is no number"))?;
    }
    must(!p.quat.past().as_flattened().iter().any(|x| x.is_nan()), "an orientation is no number")?;
    let mut seen = vec![false; p.rank.len()];
    let first = |r: &u32| seen.get_mut(*r as usize).is_some_and(|seen| !std::mem::replace(seen, true));
    must(p.rank.past().iter().all(first), "ranks are no order")
}

pub fn regions(w: &World) -> Outcome {
    let cracks = w.cracks.iter().filter_map(|c| c.region.as_ref());
    must(
        w.regions.past().values().chain(cracks).all(|r| r.is_sound()),
        "a region has a direction or a number that cannot be",
    )?;
    let sound = w.cracks.iter().filter_map(|c| c.sheet.as_ref()).all(|s| s.is_sound());
    must(sound, "a surface that cuts bonds has a corner that is nowhere")
}

/// Whether energies and places of the last rebuild are those of the particles that are there: not where some have come or gone
/// since.
pub fn stand(w: &World) -> bool {
    let (t, r) = (w.tally.past(), w.rebuild.past());
    let energies = [t.atom.len(), t.bond_atom.len(), t.fix_atom.len()];
    let virials = [t.atom_virial.len(), t.atom_bonds.len(), t.atom_fixes.len()];
    let places = [r.held.len(), r.kept.x.len()];
    // Where no particle had moved since creation no places are held.
    let held = r.unmoved || r.held.len() == w.n();
    held && energies.into_iter().chain(virials).chain(places).all(|len| len == 0 || len == w.n())
}

pub fn rebuild(w: &World) -> Outcome {
    let r = w.rebuild.past();
    // No turns where no particle has gone around the box since.
    let turns = r.kept.turns.len();
    must(turns == 0 || turns == r.kept.x.len(), "places of kept lists and their turns differ in number")?;
    must(
        !r.unmoved || w.particles.style.peri,
        "nothing has moved since a creation whose places are not stored",
    )?;
    let kept = (r.kept.corners, r.kept.tilt);
    let box_of_kept = kept.0.as_flattened().iter().chain(&kept.1).all(|x| x.is_finite())
        && (0..3).all(|d| r.kept.x.is_empty() || kept.0[0][d] < kept.0[1][d]);
    must(box_of_kept, "the box of kept lists is none")?;
    let places = r.held.iter().chain(&r.kept.x);
    must(places.flatten().all(|x| x.is_finite()), "a particle was nowhere")
}

/// Whether pairs of ids ascend, the lower one first.
fn pairs_ascend<'a>(mut pairs: impl Iterator<Item = &'a [u32; 2]>) -> bool {
    let mut before = None;
    pairs.all(|p| p[0] < p[1] && before.replace(p).is_none_or(|b| b < p))
}

pub fn bonds(w: &World) -> Outcome {
    let b = w.bonds.past();
    must(b.types <= usize::from(u16::MAX), "there are more types of bonds than can be")?;
    let known = |kind: i32| (1..=b.types).contains(&(kind.unsigned_abs() as usize));
    must(b.list.iter().all(|b| known(b.kind)), "a bond's type is beyond the number of types")?;
    must(b.list.iter().all(|b| b.ends[0] != b.ends[1]), "a bond leads from a particle to itself")?;
    must(b.list.is_empty() || w.particles.style.bonded, "there are bonds of particles that have none")?;
    must(pairs_ascend(b.special.iter()), "pairs that count as bonded are out of order")?;
    must(
        b.turned.keys().chain(b.memory.keys()).all(|e| e[0] < e[1]),
        "the history of a bond belongs to no pair",
    )?;
    // Counted from type 0, which no particle has.
    must(b.power.len() <= b.types + 1, "there are dashpots of more types than there are")?;
    let angles = &b.angles;
    must(angles.types <= usize::from(u16::MAX), "there are more types of angles than can be")?;
    let in_range = angles.list.iter().all(|a| (1..=angles.types).contains(&usize::from(a.kind)));
    must(in_range, "an angle's type is beyond the number of types")?;
    let coeffs = b.coeffs.iter().flat_map(|(_, all)| all.keys());
    must(coeffs.into_iter().all(|k| (1..=b.types).contains(k)), "coefficients belong to no type")
}

/// Grains that touch each other are two, in order; those that touch a wall are stored with the part of it.
pub fn contacts(w: &World) -> Outcome {
    let sound = |c: &contacts::Contacts| {
        must(c.sound(), "contacts and their history differ in length")?;
        must(!c.history.iter().any(|x| x.is_nan()), "the history of a contact is no number")?;
        must(c.keys.is_sorted_by(|a, b| a < b), "contacts are out of order")
    };
    for c in w.contacts.past().values() {
        sound(c)?;
        must(pairs_ascend(c.keys.iter()), "a grain touches itself")?;
    }
    w.wall_contacts.past().values().try_for_each(sound)
}

pub fn families(w: &World) -> Outcome {
    let Some(f) = w.families.past() else { return Ok(()) };
    // Particles that were made after the last run have no family yet.
    must(f.place.len() <= w.n(), "families are of more particles than there are")?;
    must(w.volumes().len() == w.n(), "there are families of particles without volumes")?;
    must(
        w.particles.style.peri || f.reference.is_some(),
        "the first places of the particles of families are missing",
    )?;
    let x0 = w.particles.x0.past();
    f.sound(w.types, &x0[..x0.len().min(f.place.len())])
}
