//! compute fragments: pieces of a body that are connected by bonds, their velocities, and the mass eroded.

use super::{Compute, ComputeStyle, Share};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_peri::families::ForceUnit;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::matter::{Masses, check_masses, unwrapped};
use perigrain_styles::near::{Clusters, held_together};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::columns::VOLUME_PROPERTY;
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, FAMILIES, IMAGE, KIND, MASK, MASS, RADIUS, TAG, TYPE_MASS, V, VOLUME, X,
};
use perigrain_world::{GroupId, SlotId, World};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// The style.
pub struct Fragments;

impl Style for Fragments {
    fn name(&self) -> &'static str {
        "fragments"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Spectrum of the fragments that unbroken bonds hold together: masses, velocities, eroded mass and volume.",
            text: "Fragments are those of compute fragment/atom within the group; a particle without any unbroken bond is one by itself. \
                   The heaviest is the body, the rest is eroded. Global vector of 8: 1 the number of fragments of at \
                   least n particles, 2 the mass of the body, 3 the mass of the other fragments of at \
                   least n particles, 4 that of the dust (all smaller ones), 5 the eroded mass (3 and 4), 6 its volume: that \
                   of the crater, reckoned before the first run, 7 its speed, root of the mean square weighted with mass, 8 the speed of its fastest \
                   fragment.\n\n\
                   Global array, a row for each fragment of at least n particles, the heaviest first (equal \
                   ones by id): the smallest id in it, the number of particles, mass, volume, centre of mass x y z, its velocity x y z, \
                   kinetic energy of its particles.\n\n\
                   Masses are true masses also where LAMMPS' convention has densities in \
                   their place; volumes are the peridynamic ones, elsewhere those of spheres. Bonds are those of families and those of the bond table \
                   (`bond_style bpm/*`, `harmonic`), turned off or not.\n\n\
                   A crack leaves crushed particles behind it, and single bonds across such dust are enough to make one fragment \
                   of its two sides unless `damage` parts them. Particles at a clean crack through \
                   planes of bonds have lost up to a half, less farther from it; values of 0.5 to 0.8 part what is crushed from what \
                   is not.",
            example: "compute pieces plate fragments least 5 damage 0.6",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The least number of particles of a fragment that is no dust.
    #[word(keyword, name = "n", what = "the least number of particles", from = 1, default = 2)]
    least: usize,
    /// A peridynamic particle that has lost this share of its family or more (compute damage/atom) holds nothing together: it counts
    /// as one by itself, with the dust.
    #[word(keyword, name = "phi", what = "the damage of what holds nothing together", placed)]
    damage: Option<At<Share>>,
}

impl ComputeStyle for Fragments {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let w = cx.world;
        let families = w.particles.style.peri || w.columns.property(*VOLUME_PROPERTY).is_some();
        if !w.particles.style.bonded {
            super::need_bonds("fragments", cx)?;
        }
        let Line { least, damage } = read(args, cx)?;
        if let Some(At { span, .. }) = damage.as_ref().filter(|_| !families) {
            let text = "only peridynamic particles have a damage: bonds of the bond table hold or are gone";
            let d = Diagnostic::error(Code::CONFLICT, *span, text);
            return Err(d.help("leave `damage` out").into());
        }
        let damage = damage.map(|d| d.value.0);
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, least, damage }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    least: usize,
    /// Damage from which on a particle connects nothing.
    damage: Option<f64>,
}

/// One piece.
#[derive(Clone, Copy, Debug, Default)]
struct Piece {
    /// Smallest id.
    name: u32,
    count: usize,
    mass: f64,
    volume: f64,
    /// Σ m x.
    place: [f64; 3],
    /// Σ m v.
    momentum: [f64; 3],
    kinetic: f64,
}

impl Piece {
    fn velocity(&self) -> [f64; 3] {
        self.momentum.map(|p| if self.mass > 0.0 { p / self.mass } else { 0.0 })
    }

    fn speed(&self) -> f64 {
        perigrain_base::math::vec3::length(self.velocity())
    }
}

/// The pieces of a group, the heaviest first.
fn pieces(w: &World, group: GroupId, damage: Option<f64>) -> Vec<Piece> {
    let p = &w.particles;
    let of = |i: usize| p.mask[i] & group.bit() != 0;
    let mut lost = vec![];
    if let (Some(_), Some(families)) = (damage, &*w.families) {
        lost.resize(w.n(), 0.0);
        families.damage_all(w.volumes(), &mut lost);
    }
    let holds = |i: usize| of(i) && damage.is_none_or(|d| lost.get(i).is_none_or(|lost| *lost < d));
    let mut clusters = Clusters::new(&p.tag);
    held_together(w, |i, j| {
        if holds(i as usize) && holds(j as usize) {
            clusters.join(i, j);
        }
    });
    let (masses, energy) = (Masses::of(w), w.settings.units.constants().mvv2e);
    let volumes = w.volumes();
    let densities = w.families.as_ref().is_some_and(|f| f.options.unit == ForceUnit::Density);
    let mut found: BTreeMap<u32, Piece> = BTreeMap::new();
    for i in (0..w.n()).filter(|&i| of(i)) {
        let volume = volumes.get(i).copied().unwrap_or_else(|| sphere(p.radius.get(i)));
        let m = if densities && volume > 0.0 { masses.get(i) * volume } else { masses.get(i) };
        let name = clusters.name(i) as u32;
        let piece = found.entry(name).or_insert(Piece { name, ..Piece::default() });
        let (x, v) = (unwrapped(w, i), p.v[i]);
        piece.count += 1;
        piece.mass += m;
        piece.volume += volume;
        for k in 0..3 {
            piece.place[k] += m * x[k];
            piece.momentum[k] += m * v[k];
            piece.kinetic += 0.5 * energy * m * v[k] * v[k];
        }
    }
    let mut list: Vec<Piece> = found.into_values().collect();
    list.sort_by(|a, b| b.mass.total_cmp(&a.mass).then(a.name.cmp(&b.name)));
    list
}

/// The volume of a sphere; 0 for a point.
fn sphere(radius: Option<&f64>) -> f64 {
    radius.map_or(0.0, |r| 4.0 / 3.0 * PI * r.powi(3))
}

/// The global vector: the spectrum of pieces.
fn spectrum(list: &[Piece], least: usize) -> Vec<f64> {
    let (body, rest) = list.split_at(list.len().min(1));
    let large = |p: &&Piece| p.count >= least;
    let mass = |pick: &dyn Fn(&&Piece) -> bool| rest.iter().filter(|p| pick(p)).map(|p| p.mass).sum::<f64>();
    let (others, dust) = (mass(&|p| large(p)), mass(&|p| !large(p)));
    let square: f64 = rest.iter().map(|p| p.mass * p.speed().powi(2)).sum();
    let eroded = others + dust;
    vec![
        list.iter().filter(large).count() as f64,
        body.iter().map(|p| p.mass).sum(),
        others,
        dust,
        eroded,
        rest.iter().map(|p| p.volume).sum(),
        if eroded > 0.0 { (square / eroded).sqrt() } else { 0.0 },
        rest.iter().map(Piece::speed).fold(0.0, f64::max),
    ]
}

/// Columns of the array.
const WIDTH: usize = 11;

impl Compute for Declared {
    fn elements(&self) -> Vec<String> {
        ["fragments", "body", "others", "dust", "eroded", "volume", "speed", "fastest"]
            .map(String::from)
            .to_vec()
    }

    fn shape(&self) -> Shape {
        Shape { vector: 8, array: WIDTH, array_rows: Shape::OPEN, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, least, damage, span) = (self.group, self.least, self.damage, cx.span());
        check_masses(cx.world(), span)?;
        let reads = KIND
            | TAG
            | TYPE_MASS
            | BOX
            | X
            | V
            | IMAGE
            | MASS
            | VOLUME
            | COLUMNS
            | RADIUS
            | MASK
            | FAMILIES
            | BONDS;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, reads, move |w, _, out| {
            let list = pieces(w, group, damage);
            out.vector = spectrum(&list, least);
            out.array_cols = WIDTH;
            out.array.clear();
            for p in list.iter().filter(|p| p.count >= least) {
                let place = p.place.map(|x| if p.mass > 0.0 { x / p.mass } else { 0.0 });
                out.array.extend([f64::from(p.name), p.count as f64, p.mass, p.volume]);
                out.array.extend(place.into_iter().chain(p.velocity()).chain([p.kinetic]));
            }
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_peri::families::{Families, FamilyOptions, PmbCoeff, PmbTable};
    use perigrain_styles::peri_view::view;
    use perigrain_styles::testing::Bench;
    use perigrain_world::{AtomStyle, Bond};

    /// Six points in a row with spacing 1, mass 2 and volume 3, bonds to the next one only; cut after the
    /// third and fifth.
    fn row() -> Bench {
        let places: Vec<[f64; 3]> = (0..6).map(|i| [f64::from(i), 0.0, 0.0]).collect();
        let mut b = Bench::new(AtomStyle { peri: true, ..AtomStyle::default() }, &places);
        b.world.particles.volume = vec![3.0; 6].into();
        let mut table = PmbTable::new(1);
        table.set(1, 1, PmbCoeff { c: 1.0, horizon: 1.5, s00: 1.0, alpha: 0.0 }).unwrap();
        let options = FamilyOptions { unit: ForceUnit::Newton, ..FamilyOptions::new(1.0) };
        let mut families = Families::build(&view(&b.world).unwrap(), &table, options).unwrap();
        families.cut(&view(&b.world).unwrap(), |p, q| {
            let middle = 0.5 * (p[0] + q[0]);
            middle == 2.5 || middle == 4.5
        });
        b.world.families = Some(families).into();
        b.world.particles.v[5] = [0.0, 0.0, 4.0];
        b.world.particles.v[3] = [0.0, 2.0, 0.0];
        b
    }

    #[test]
    fn pieces_by_hand() {
        let mut b = row();
        let c = b.compute(&Fragments, "").unwrap();
        let slot = b.evaluate(&*c).unwrap();
        // Three, two and one particle; the pair's centre moves at 1, the single one at 4: √((4·1 + 2·16)/6).
        assert_eq!(slot.vector, [2.0, 6.0, 4.0, 2.0, 6.0, 9.0, 6f64.sqrt(), 4.0]);
        assert_eq!(slot.array[..7], [1.0, 3.0, 6.0, 9.0, 1.0, 0.0, 0.0]);
        assert_eq!(slot.array[11..], [4.0, 2.0, 4.0, 6.0, 3.5, 0.0, 0.0, 0.0, 1.0, 0.0, 4.0]);
        let c = b.compute(&Fragments, "least 1").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().vector[..4], [3.0, 6.0, 6.0, 0.0]);
        // Those beside the cuts have lost one half, the last one all.
        let c = b.compute(&Fragments, "damage 0.5").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().vector[..4], [1.0, 4.0, 0.0, 8.0]);
        let c = b.compute(&Fragments, "damage 0.6").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().vector[..4], [2.0, 6.0, 4.0, 2.0]);
        let c = b.compute(&Fragments, "least 1").unwrap();
        // Densities instead of masses: the volume converts them.
        b.world.families.as_mut().unwrap().options.unit = ForceUnit::Density;
        assert_eq!(b.evaluate(&*c).unwrap().vector[1], 18.0);
        b.world.particles.mask.fill(0);
        assert_eq!(b.evaluate(&*c).unwrap().vector, [0.0; 8]);
        for words in ["least 0", "most 3", "least", "damage 0", "damage 1.5", "damage"] {
            assert!(b.compute(&Fragments, words).is_err(), "{words}");
        }
    }

    #[test]
    fn bonds_of_the_table_hold_spheres_together() {
        let places: Vec<[f64; 3]> = (0..5).map(|i| [f64::from(i), 0.0, 0.0]).collect();
        let style = AtomStyle { sphere: true, bonded: true, ..AtomStyle::default() };
        let mut b = Bench::new(style, &places);
        b.world.particles.radius = vec![0.5; 5].into();
        for ends in [[1, 2], [3, 2], [5, 4]] {
            b.world.bonds.push(Bond::new(1, ends));
        }
        let c = b.compute(&Fragments, "").unwrap();
        let slot = b.evaluate(&*c).unwrap();
        let volume = PI / 6.0;
        assert_eq!(slot.vector[..5], [2.0, 6.0, 4.0, 0.0, 4.0]);
        assert!((slot.vector[5] - 2.0 * volume).abs() < 1e-15);
        assert_eq!((slot.array[0], slot.array[1], slot.array[11], slot.array[12]), (1.0, 3.0, 4.0, 2.0));
        b.world.bonds.lose(&[([1, 2], 1)]);
        assert_eq!(b.evaluate(&*c).unwrap().vector[..4], [2.0, 4.0, 4.0, 2.0]);
        assert!(b.compute(&Fragments, "damage 0.5").is_err());
    }
}
