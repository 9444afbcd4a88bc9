//! Numbers of particles in the order of their ids, taken out and put back.

use super::columns::column;
use super::{Column, unknown};
use crate::session::Session;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};

/// Which particles, in which order.
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// All, by id.
    Ids,
    /// All, as they stand.
    Places,
    /// Those with these ids, in this order.
    Chosen(Vec<i64>),
}

/// Numbers, some for each particle in turn.
#[derive(Clone, Debug, PartialEq)]
pub enum Rows {
    /// Whole ones.
    Wholes(Vec<i32>),
    /// Any.
    Reals(Vec<f64>),
}

impl Session {
    /// The numbers under a name, with how many each particle has; `image` has three with `apart`, else one. Besides the columns
    /// of particles: `d2_NAME` and `i2_NAME`, `c_ID`, `f_ID`.
    ///
    /// # Errors
    /// Unknown names, unknown ids.
    pub fn gathered(&mut self, name: &str, apart: bool, order: &Order) -> Result<(Rows, usize)> {
        let places = self.places(order)?;
        let pick = |list: &[f64], width: usize| {
            let mut out = Vec::with_capacity(places.len() * width);
            places.iter().for_each(|&i| out.extend_from_slice(&list[i * width..(i + 1) * width]));
            (Rows::Reals(out), width)
        };
        if name == "image" && apart {
            let image = &self.world.particles.image;
            return Ok((Rows::Wholes(places.iter().flat_map(|&i| image[i]).collect()), 3));
        }
        if let Some(list) = self.whole_column(name) {
            return Ok((Rows::Wholes(places.iter().map(|&i| list[i]).collect()), 1));
        }
        match column(&mut self.world, name) {
            Some(Column::Ones(list)) => return Ok(pick(list, 1)),
            Some(Column::Threes(list)) => return Ok(pick(list.as_flattened(), 3)),
            Some(Column::Fours(list)) => return Ok(pick(list.as_flattened(), 4)),
            None => {}
        }
        if name == "mass"
            && let Some(masses) = self.type_masses()
        {
            let kind = &self.world.particles.kind;
            return Ok((Rows::Reals(places.iter().map(|&i| masses[usize::from(kind[i])]).collect()), 1));
        }
        if name.starts_with("d2_") || name.starts_with("i2_") {
            let parts = self.property_parts(name);
            if !parts.is_empty() {
                let all = places.iter().flat_map(|&i| parts.iter().map(move |part| part[i]));
                return Ok(match name.starts_with("i2_") {
                    true => (Rows::Wholes(all.map(|a| a as i32).collect()), parts.len()),
                    false => (Rows::Reals(all.collect()), parts.len()),
                });
            }
        }
        let n = self.world.n();
        let slot = match name.split_at_checked(2) {
            Some(("c_", id)) => self.compute_values(id)?,
            Some(("f_", id)) => self.fix_values(id)?,
            _ => return Err(unknown("column of particles", name, COLUMNS.into_iter())),
        };
        if !slot.offers.atom || slot.cols == 0 {
            return fail(Code::WRONG_KIND, None, format!("`{name}` has no values per particle"));
        }
        let mut list = slot.atom.clone();
        let width = slot.cols;
        // Particles that have joined since have none yet.
        list.resize(n * width, 0.0);
        Ok(pick(&list, width))
    }

    /// Puts numbers that were taken out, and perhaps changed, back.
    ///
    /// # Errors
    /// Names that cannot be written, too many or too few numbers, numbers that cannot be; nothing is changed then.
    pub fn scatter(&mut self, name: &str, order: &Order, rows: &Rows) -> Result<()> {
        let places = self.places(order)?;
        let n = places.len();
        let fits = |have: usize, width: usize| {
            if have == n * width {
                return Ok(());
            }
            let text = format!("`{name}` of {n} particles are {} numbers, not {have}", n * width);
            fail(Code::BAD_VALUE, None, text)
        };
        match rows {
            Rows::Wholes(list) => {
                if name == "image" && list.len() == 3 * n && n > 0 {
                    for (&i, image) in places.iter().zip(list.chunks_exact(3)) {
                        self.world.particles.image.set(i, [image[0], image[1], image[2]]);
                    }
                    self.changed_from_outside();
                    return Ok(());
                }
                let Some(mut all) = self.whole_column(name) else {
                    return Err(self.not_of_this_kind(name, "whole numbers"));
                };
                fits(list.len(), 1)?;
                places.iter().zip(list).for_each(|(&i, &k)| all[i] = k);
                self.set_whole_column(name, &all)
            }
            Rows::Reals(list) => {
                if let Some(k) = list.iter().position(|a| !a.is_finite()) {
                    return fail(Code::BAD_VALUE, None, format!("number {k} of `{name}` is {}", list[k]));
                }
                let (own, width): (&mut [f64], usize) = match column(&mut self.world, name) {
                    Some(Column::Ones(own)) => (own, 1),
                    Some(Column::Threes(own)) => (own.as_flattened_mut(), 3),
                    Some(Column::Fours(own)) => (own.as_flattened_mut(), 4),
                    None => return Err(self.not_of_this_kind(name, "numbers with fractions")),
                };
                fits(list.len(), width)?;
                for (&i, row) in places.iter().zip(list.chunks_exact(width)) {
                    own[i * width..(i + 1) * width].copy_from_slice(row);
                }
                self.changed_from_outside();
                Ok(())
            }
        }
    }

    fn not_of_this_kind(&mut self, name: &str, kind: &str) -> perigrain_base::diag::Diagnostics {
        if self.whole_column(name).is_some() || column(&mut self.world, name).is_some() {
            return Diagnostic::error(Code::WRONG_KIND, None, format!("`{name}` does not hold {kind}"))
                .into();
        }
        unknown("column of particles", name, COLUMNS.into_iter())
    }

    /// The columns `NAME[1]`, `NAME[2]` … of fix property/atom.
    fn property_parts(&self, name: &str) -> Vec<&[f64]> {
        let columns = &self.world.columns;
        let part = |k: usize| columns.get_scalar(columns.custom(&format!("{name}[{k}]"))?);
        (1..).map_while(part).collect()
    }

    /// Where the particles of an order stand.
    fn places(&self, order: &Order) -> Result<Vec<usize>> {
        let tags = &self.world.particles.tag;
        match order {
            Order::Places => Ok((0..tags.len()).collect()),
            Order::Ids => {
                let mut places = vec![usize::MAX; tags.len()];
                for (i, &tag) in tags.iter().enumerate() {
                    match places.get_mut((tag as usize).wrapping_sub(1)) {
                        Some(place) => *place = i,
                        None => return Err(gaps()),
                    }
                }
                if places.contains(&usize::MAX) { Err(gaps()) } else { Ok(places) }
            }
            Order::Chosen(ids) => {
                let place = |id: &i64| {
                    let found = u32::try_from(*id).ok().and_then(|tag| self.world.particles.index_of(tag));
                    let missing = || fail(Code::UNKNOWN_NAME, None, format!("there is no particle {id}"));
                    found.map_or_else(missing, Ok)
                };
                ids.iter().map(place).collect()
            }
        }
    }
}

/// Ids with holes have no place in a list by ids.
fn gaps() -> perigrain_base::diag::Diagnostics {
    Diagnostic::error(Code::WRONG_KIND, None, "the ids of the particles are not 1, 2, 3 … without a gap")
        .help("gather as they stand (`gather_atoms_concat`, with the ids beside it), or use `reset_atoms id` first")
        .into()
}

/// Names for "did you mean".
const COLUMNS: [&str; 17] = [
    "id",
    "type",
    "mask",
    "molecule",
    "image",
    "x",
    "v",
    "f",
    "omega",
    "torque",
    "x0",
    "quat",
    "radius",
    "rmass",
    "vfrac",
    "mass",
    "temperature",
];
