//! Whether the scene is still that of a restart file which was read.

use super::sum_of;
use perigrain_world::{Named, Resume, World};

/// The description of a scene that has just been read.
pub fn resume(w: &World, declared: Vec<String>) -> Resume {
    let names = w.regions.keys().map(|key| key.to_string()).chain(w.materials.keys().cloned());
    let names = names.chain(w.memo.keys().map(|key| key.to_string()));
    let names = names.chain(w.columns.names().into_iter().map(str::to_string)).collect();
    let bits = w.groups.names().filter_map(|n| w.groups.find(n)).fold(0, |bits, g| bits | g.bit());
    let new = Resume { declared, fingerprint: 0, bits, names };
    Resume { fingerprint: fingerprint(w, &new), ..new }
}

/// A checksum over everything that forces, bonds and motion depend on, limited to the groups and names that `of` knows:
/// what a deck defines besides does not count.
pub fn fingerprint(w: &World, of: &Resume) -> u32 {
    fn known<'a, T>(all: impl Iterator<Item = (&'a str, &'a T)>, of: &Resume) -> Vec<(&'a str, &'a T)> {
        all.filter(|(name, _)| of.names.iter().any(|n| n == name)).collect()
    }
    fn named<T>(all: &Named<T>) -> impl Iterator<Item = (&str, &T)> {
        all.iter().map(|(key, value)| (key.text(), value))
    }
    let p = &w.particles;
    let masks: Vec<u32> = p.mask.iter().map(|m| m & of.bits).collect();
    let mut columns = w.columns.clone();
    columns.split_off(|name| of.names.iter().any(|n| n == name));
    let motion = (&p.tag, &p.kind, masks, &p.image, &p.x, &p.v, &p.f);
    let matter =
        (&p.mass, &p.radius, &p.omega, &p.torque, &p.quat, &p.volume, &p.x0, &p.density, &p.molecule);
    let electric = (&p.mu, &p.charge);
    let c = &w.clock;
    let clock = (c.step, c.dt, c.time_base, c.time_step);
    let materials = w.materials.iter().map(|(name, material)| (name.as_str(), material));
    let names = (known(named(&w.regions), of), known(materials, of), known(named(&w.memo), of));
    let scene = (&w.settings, &w.domain, p.style, w.types, &w.type_mass, &w.lattice);
    sum_of(&(
        clock,
        scene,
        motion,
        (matter, electric),
        columns,
        names,
        (&w.rebuild, &w.families, &w.contacts, &w.wall_contacts, &w.bonds.list, &w.bonds.weights),
    ))
}
