//! One snapshot of a dump on its way into the world.

use super::super::data::dump::Snapshot;
use super::{Add, FIELDS, Wish};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_geometry::text::{number, whole};
use perigrain_styles::common::settle;
use perigrain_world::index::{Index, twice};
use perigrain_world::{Domain, World};

/// A snapshot's data for one particle.
pub(super) struct Particle {
    tag: u32,
    kind: u16,
    values: [f64; 12],
}

/// The rows of a snapshot, checked.
pub(super) fn particles(s: &Snapshot, wish: &Wish, w: &World) -> Result<Vec<Particle>> {
    let id = wish.named(s, "id")?;
    let kind = if wish.add == Add::No { None } else { Some(wish.named(s, "type")?) };
    let mut columns = vec![];
    for &f in &wish.fields {
        columns.push((f, wish.column(s, f)?));
    }
    // Fractions of a leaning box make places together.
    let scaled = columns.iter().filter(|(f, (_, scaled, _))| *f < 3 && *scaled).count();
    let leans = s.tilt.is_some_and(|tilt| tilt != [0.0; 3]) && scaled > 0;
    if leans && scaled < 3 {
        let text = "scaled positions of a triclinic box are of use only together: x, y and z";
        return fail(Code::BAD_VALUE, s.title, text);
    }
    let mut list = Vec::with_capacity(s.len());
    s.rows(|line, words| {
        let tag = whole(line, words[id], "the id")?;
        let Some(tag) = u32::try_from(tag).ok().filter(|t| *t >= 1) else {
            return fail(Code::BAD_VALUE, line.span_of(words[id]), format!("`{tag}` is no id"));
        };
        let mut p = Particle { tag, kind: 1, values: [0.0; 12] };
        if let Some(k) = kind {
            let t = whole(line, words[k], "the type")?;
            p.kind = match u16::try_from(t) {
                Ok(t) if t >= 1 && usize::from(t) <= w.types => t,
                _ => {
                    let text = format!("there are types 1 to {}, not {t}", w.types);
                    return fail(Code::BAD_VALUE, line.span_of(words[k]), text);
                }
            };
        }
        for &(f, (k, scaled, _)) in &columns {
            let a = number(line, words[k], FIELDS[f])?;
            p.values[f] = if scaled && !leans { s.lo[f] + a * (s.hi[f] - s.lo[f]) } else { a };
        }
        if leans {
            let there = s.at([p.values[0], p.values[1], p.values[2]]);
            p.values[..3].copy_from_slice(&there);
        }
        list.push(p);
        Ok(())
    })?;
    let tags: Vec<u32> = list.iter().map(|p| p.tag).collect();
    if let Some((a, _)) = twice(&tags) {
        return fail(Code::DUPLICATE_NAME, s.title, format!("the snapshot has two particles {}", tags[a]));
    }
    Ok(list)
}

/// Puts a snapshot into the world; how many particles were purged, replaced, trimmed and added.
pub(super) fn enter(w: &mut World, s: &Snapshot, list: &[Particle], wish: &Wish) -> [usize; 4] {
    if wish.timestep {
        w.clock.reset(s.step);
    }
    if wish.domain {
        let flat = w.settings.two_dimensional;
        let mut domain = Domain { flat, tilt: s.tilt, ..Domain::new(s.lo, s.hi, w.settings.boundary) };
        domain.open_shrinking_faces();
        w.domain = Some(domain).into();
    }
    let tags: Vec<u32> = list.iter().map(|p| p.tag).collect();
    let index = Index::new(&tags);
    let gone: Vec<bool> = w
        .particles
        .tag
        .iter()
        .map(|t| wish.purge || (wish.trim && index.find(*t, &tags).is_none()))
        .collect();
    let left = gone.iter().filter(|g| **g).count();
    if left > 0 {
        w.delete(&gone, false);
        w.forget_touches();
    }
    let here = Index::new(&w.particles.tag);
    let known: Vec<Option<usize>> = list.iter().map(|p| here.find(p.tag, &w.particles.tag)).collect();
    let unwrapped = unwraps(s, wish);
    let (mut replaced, mut added) = (0, 0);
    let mut next = w.particles.last_tag();
    for (p, place) in list.iter().zip(known) {
        match place {
            Some(i) if wish.replace => {
                set(w, i, p, wish, unwrapped);
                replaced += 1;
            }
            None if wish.add != Add::No => {
                next += u32::from(wish.add == Add::Yes);
                let tag = if wish.add == Add::Yes { next } else { p.tag };
                w.particles.push(tag, p.kind, [0.0; 3]);
                let i = w.n() - 1;
                set(w, i, p, wish, false);
                if let Some(x0) = w.particles.x0.get_mut(i) {
                    *x0 = w.particles.x[i];
                }
                added += 1;
            }
            _ => {}
        }
    }
    let n = w.n();
    w.columns.resize(n);
    w.spread_type_masses();
    settle(w);
    w.slots.invalidate();
    w.touch();
    let (purged, trimmed) = if wish.purge { (left, 0) } else { (0, left) };
    [purged, replaced, trimmed, added]
}

/// Whether positions of the snapshot have never been wrapped, so that image flags begin anew.
fn unwraps(s: &Snapshot, wish: &Wish) -> bool {
    let places = wish.fields.iter().filter(|f| **f < 3);
    places.filter_map(|f| wish.column(s, *f).ok()).any(|(_, _, wrapped)| !wrapped)
}

fn set(w: &mut World, i: usize, p: &Particle, wish: &Wish, unwrapped: bool) {
    let mut image = if unwrapped { [0; 3] } else { w.particles.image[i] };
    for &f in &wish.fields {
        let (value, d) = (p.values[f], f % 3);
        match f / 3 {
            0 => w.particles.x[i][d] = value,
            1 => w.particles.v[i][d] = value,
            2 => image[d] = value as i32,
            _ => w.particles.f[i][d] = value,
        }
    }
    w.particles.image.set(i, image);
}
