//! Particles and a box that come from outside.

use super::columns::unpacked;
use crate::session::Session;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_styles::common::settle;
use perigrain_world::Face;
use std::collections::BTreeSet;

/// Particles to be made.
#[derive(Clone, Debug, Default)]
pub struct Newcomers {
    /// Their ids; without, those after the largest.
    pub ids: Option<Vec<i64>>,
    /// Their types.
    pub kinds: Vec<i32>,
    /// Where.
    pub x: Vec<[f64; 3]>,
    /// Their velocities; without, none moves.
    pub v: Option<Vec<[f64; 3]>>,
    /// How often they have crossed periodic faces, in LAMMPS' packed form.
    pub images: Option<Vec<i32>>,
    /// Faces that follow particles open for those beyond them.
    pub open: bool,
}

impl Session {
    /// Makes particles; those outside the box are left out, as in LAMMPS. How many were made.
    ///
    /// # Errors
    /// No box, lists of different lengths, types, ids and places that cannot be; nothing is made then.
    pub fn make_particles(&mut self, new: &Newcomers) -> Result<usize> {
        let w = &mut self.world;
        let Some(domain) = (*w.domain).clone() else {
            return fail(Code::WRONG_ORDER, None, "particles need a box: `create_box` comes first");
        };
        let n = new.kinds.len();
        let lengths = [
            Some(new.x.len()),
            new.ids.as_ref().map(Vec::len),
            new.v.as_ref().map(Vec::len),
            new.images.as_ref().map(Vec::len),
        ];
        if let Some(other) = lengths.into_iter().flatten().find(|&len| len != n) {
            return fail(Code::BAD_VALUE, None, format!("{n} types, but {other} of something else"));
        }
        if let Some(kind) = new.kinds.iter().find(|&&k| k < 1 || k as usize > w.types) {
            return fail(
                Code::BAD_VALUE,
                None,
                format!("there is no particle type {kind}: there are {}", w.types),
            );
        }
        let numbers = new.x.iter().chain(new.v.iter().flatten()).flatten();
        if let Some(wrong) = numbers.into_iter().find(|a| !a.is_finite()) {
            return fail(Code::BAD_VALUE, None, format!("{wrong} is no coordinate and no velocity"));
        }
        let last = w.particles.last_tag();
        let ids = self.new_ids(new, last)?;
        let w = &mut self.world;
        let mut made = 0;
        w.fall_back();
        w.particles.reserve(n);
        for i in 0..n {
            let (mut x, mut image) = (new.x[i], new.images.as_ref().map_or([0; 3], |list| unpacked(list[i])));
            domain.wrap(&mut x, &mut image);
            let at = domain.upright(&x);
            let kept = (0..3).all(|k| {
                let follows =
                    domain.boundary.0[k].iter().any(|f| matches!(f, Face::Shrink | Face::ShrinkMin));
                (new.open && follows) || (at[k] >= domain.lo[k] && at[k] < domain.hi[k])
            });
            if !kept {
                continue;
            }
            let p = &mut w.particles;
            p.push(ids[i], new.kinds[i] as u16, x);
            let at = p.len() - 1;
            p.image.set(at, image);
            if let Some(v) = &new.v {
                p.v[at] = v[i];
            }
            made += 1;
        }
        let n = w.n();
        w.columns.resize(n);
        w.spread_type_masses();
        settle(w);
        w.slots.invalidate();
        w.rebuild.roster += 1;
        w.touch();
        Ok(made)
    }

    fn new_ids(&self, new: &Newcomers, last: u32) -> Result<Vec<u32>> {
        let too_many = || fail(Code::TOO_LARGE, None, "more particles than there are ids");
        let Some(ids) = &new.ids else {
            let n = new.kinds.len();
            let end = u32::try_from(n).ok().and_then(|n| last.checked_add(n));
            return end.map_or_else(too_many, |end| Ok((last + 1..=end).collect()));
        };
        let mut known: BTreeSet<u32> = self.world.particles.tag.iter().copied().collect();
        let take = |&id: &i64| match u32::try_from(id) {
            Ok(id) if id > 0 && id <= i32::MAX as u32 => match known.insert(id) {
                true => Ok(id),
                false => fail(Code::BAD_VALUE, None, format!("there is a particle {id} already")),
            },
            _ => fail(Code::BAD_VALUE, None, format!("{id} is no id of a particle")),
        };
        ids.iter().map(take).collect()
    }

    /// Gives an empty box other corners, and other tilts where it has some.
    ///
    /// # Errors
    /// No box, particles in it, corners that enclose nothing, tilts of a box that has none.
    pub fn reset_box(&mut self, lo: [f64; 3], hi: [f64; 3], tilt: [f64; 3]) -> Result<()> {
        if self.world.n() > 0 {
            let d =
                Diagnostic::error(Code::WRONG_ORDER, None, "the box holds particles and cannot be set anew");
            return Err(d.help("use `change_box`, which has an option for them").into());
        }
        let sound = (0..3).all(|k| lo[k].is_finite() && hi[k].is_finite() && lo[k] < hi[k]);
        if !sound {
            return fail(Code::BAD_VALUE, None, format!("no box has the corners {lo:?} and {hi:?}"));
        }
        let Some(domain) = &mut *self.world.domain else {
            return fail(Code::WRONG_ORDER, None, "there is no box: `create_box` comes first");
        };
        if !tilt.iter().all(|x| x.is_finite()) {
            return fail(Code::BAD_VALUE, None, format!("no box leans by {tilt:?}"));
        }
        match &mut domain.tilt {
            Some(leans) => *leans = tilt,
            None if tilt == [0.0; 3] => {}
            None => {
                let d = Diagnostic::error(Code::CONFLICT, None, "an orthogonal box cannot lean");
                return Err(d.help("`change_box all triclinic` makes it one that may").into());
            }
        }
        (domain.lo, domain.hi, domain.min_lo, domain.min_hi) = (lo, hi, lo, hi);
        self.changed_from_outside();
        Ok(())
    }
}
