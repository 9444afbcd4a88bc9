//! The columns of particles by LAMMPS' names, to be read and written by a program that hosts the session.

use crate::session::Session;
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::body::Quat;
use perigrain_fixes::external;
use perigrain_world::World;

/// Numbers of particles as they lie in memory.
pub enum Column<'a> {
    /// One per particle.
    Ones(&'a mut Vec<f64>),
    /// Three per particle.
    Threes(&'a mut Vec<[f64; 3]>),
    /// Four per particle.
    Fours(&'a mut Vec<Quat>),
}

/// How the column of forces that a fix external adds is called: with the fix's ID behind it.
const EXTERNAL: &str = "external:";

/// Bits of an image count in LAMMPS' packed form.
const BITS: i32 = 10;
/// What a count of zero is there.
const ZERO: i32 = 512;

/// LAMMPS' packed form of image counts.
pub fn packed(image: [i32; 3]) -> i32 {
    let part = |k: usize| (image[k].wrapping_add(ZERO) & ((1 << BITS) - 1)) << (BITS * k as i32);
    part(0) | part(1) | part(2)
}

/// Image counts from LAMMPS' packed form.
pub fn unpacked(image: i32) -> [i32; 3] {
    [0, 1, 2].map(|k| ((image >> (BITS * k)) & ((1 << BITS) - 1)) - ZERO)
}

impl Session {
    /// The numbers of particles under this name, which may be changed in place; `None` if the scene has none.
    ///
    /// A caller that changes some has to call [`Session::changed_from_outside`].
    pub fn column(&mut self, name: &str) -> Option<Column<'_>> {
        column(&mut self.world, name)
    }

    /// The whole numbers of particles under this name: `id type mask molecule image`, `i_NAME`; `None` if the scene has none.
    pub fn whole_column(&self, name: &str) -> Option<Vec<i32>> {
        let p = &self.world.particles;
        let signed = |list: &Vec<u32>| list.iter().map(|&a| a as i32).collect();
        Some(match name {
            _ if self.world.domain.is_none() => return None,
            "id" => signed(&p.tag),
            "type" => p.kind.iter().map(|&k| i32::from(k)).collect(),
            "mask" => signed(&p.mask),
            "molecule" if p.style.molecules => signed(&p.molecule),
            "image" => (0..p.len()).map(|i| packed(p.image[i])).collect(),
            _ if name.starts_with("i_") => {
                let key = self.world.columns.custom(name)?;
                self.world.columns.get_scalar(key)?.iter().map(|&a| a as i32).collect()
            }
            _ => return None,
        })
    }

    /// Gives particles other whole numbers.
    ///
    /// # Errors
    /// Numbers that cannot be; nothing is changed then.
    pub fn set_whole_column(&mut self, name: &str, values: &[i32]) -> Result<()> {
        let (types, groups) = (self.world.types, self.world.groups.names().count());
        let columns = &mut self.world.columns;
        let p = &mut self.world.particles;
        if values.len() != p.len() {
            let text = format!("`{name}` has {} values, not {}", p.len(), values.len());
            return fail(Code::BAD_VALUE, None, text);
        }
        let sound = |k: i32| match name {
            "type" => k > 0 && k as usize <= types,
            "molecule" => k >= 0,
            // Bits of groups that do not exist would appear when some are made.
            "mask" => k & 1 == 1 && (groups >= 32 || (k as u32) >> groups == 0),
            _ => true,
        };
        if let Some(i) = values.iter().position(|&k| !sound(k)) {
            let text = format!("{} is no {name} for the particle with id {}", values[i], p.tag[i]);
            return fail(Code::BAD_VALUE, None, text);
        }
        match name {
            "type" => p.kind.iter_mut().zip(values).for_each(|(to, &k)| *to = k as u16),
            "mask" => p.mask.iter_mut().zip(values).for_each(|(to, &k)| *to = k as u32),
            "molecule" if p.style.molecules => {
                p.molecule.iter_mut().zip(values).for_each(|(to, &k)| *to = k as u32)
            }
            "image" => values.iter().enumerate().for_each(|(i, &k)| p.image.set(i, unpacked(k))),
            "id" => {
                let same = p.tag.iter().zip(values).all(|(own, &k)| *own as i32 == k);
                if !same {
                    let text = "ids of particles cannot be changed from outside: use `reset_atoms id`";
                    return fail(Code::NOT_SUPPORTED, None, text);
                }
                return Ok(());
            }
            _ => match columns.custom(name) {
                Some(key) if name.starts_with("i_") => {
                    let own = columns.scalar(key, p.len());
                    own.iter_mut().zip(values).for_each(|(to, &k)| *to = f64::from(k));
                }
                _ => {
                    return fail(
                        Code::UNKNOWN_NAME,
                        None,
                        format!("particles have no whole numbers `{name}`"),
                    );
                }
            },
        }
        self.changed_from_outside();
        Ok(())
    }

    /// Masses of the types, the one of type 1 at index 1 as in LAMMPS; `None` where particles have their own or none is set.
    pub fn type_masses(&self) -> Option<Vec<f64>> {
        if self.world.particles.style.own_mass() || self.world.type_mass.iter().all(Option::is_none) {
            return None;
        }
        let masses = self.world.type_mass.iter().map(|m| m.unwrap_or(0.0));
        Some(std::iter::once(0.0).chain(masses).collect())
    }
}

/// The column of this name.
pub(super) fn column<'a>(w: &'a mut World, name: &str) -> Option<Column<'a>> {
    w.domain.as_ref()?;
    let n = w.n();
    let p = &mut w.particles;
    let style = p.style;
    Some(match name {
        "x" => Column::Threes(&mut p.x),
        "v" => Column::Threes(&mut p.v),
        "f" => Column::Threes(&mut p.f),
        "omega" if style.sphere => Column::Threes(&mut p.omega),
        "torque" if style.sphere => Column::Threes(&mut p.torque),
        "x0" if style.peri => Column::Threes(&mut p.x0),
        "quat" if style.oriented => Column::Fours(&mut p.quat),
        "radius" if style.sphere => Column::Ones(&mut p.radius),
        "rmass" if style.own_mass() => Column::Ones(&mut p.mass),
        "vfrac" if style.peri => Column::Ones(&mut p.volume),
        _ if name.starts_with("d_") || name == "temperature" || name == "heatflow" => {
            let key = w.columns.custom(name)?;
            Column::Ones(w.columns.scalar(key, n))
        }
        _ => {
            let key = w.columns.vector_named(&external::name(name.strip_prefix(EXTERNAL)?))?;
            Column::Threes(w.columns.vector(key, n))
        }
    })
}
