//! compute property/atom: attributes of particles as per-atom values.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use perigrain_base::math::vec3::length;
use perigrain_base::par;
use perigrain_lang::{Args, Word};
use perigrain_peri::linked::Strain;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::matter::{Masses, unwrapped};
use perigrain_styles::peri_view::BOND_FACTORS;
use perigrain_styles::peri_view::view;
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::columns::{HEATFLOW, TEMPERATURE};
use perigrain_world::field::{
    BOX, CHARGE, COLUMNS, F, FAMILIES, Fields, IMAGE, KIND, MASK, MASS, MOLECULE, MU, OMEGA, QUAT, RADIUS,
    SITES, TAG, TORQUE, TYPE_MASS, V, VOLUME, X, X0,
};
use perigrain_world::index::Index;
use perigrain_world::{AtomStyle, GroupId, Numbers, SlotId, World};
use std::borrow::Cow;

/// The style.
pub struct PropertyAtom;

impl Style for PropertyAtom {
    fn name(&self) -> &'static str {
        "property/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Attributes of each particle.",
            text: "Per-atom vector for one attribute, array for several; 0 outside the group. All are in the deck's units. LAMMPS' other \
                   attributes belong to atom styles that perigrain does not have and are refused.\n\n\
                   - `id type proc mass x y z`; `xs ys zs` as fractions of the box; `xu yu zu` unwrapped across periodic faces; `ix iy iz` image \
                   counts; `vx vy vz fx fy fz`.\n\
                   - With atom_style sphere `radius diameter omegax omegay omegaz tqx tqy tqz`; with bpm/sphere `quatw quati quatj quatk`, the \
                   orientation; with dipole `mux muy muz`, the dipole moment, and `mu`, its size; with charges `q`.\n\
                   - With atom_style peri `vfrac`, the volume, `peri/strength` and `peri/stiffness`, the factors of `set`, and `s0`.\n\
                   - With molecules `mol` and `nbonds`, how many bonds are listed with the particle (with its first end only, under `newton off` \
                   with both).\n\
                   - With `bond_style bpm/peri` `s0`, the least critical stretch s00 − α smin of a particle's bonds, `smin`, their smallest \
                   stretch, and `lambda`, its plastic multiplier (0 without bonds).\n\
                   - `i_NAME d_NAME i2_NAME[k] d2_NAME[k]`, `temperature`, `heatflow`: those of `fix property/atom`.\n\n\
                   `s0` of pair styles peri/… is LAMMPS' critical stretch: the largest s00 − α s of the bonds that a particle had before the \
                   last step broke some, s being their stretches in that step. Under `-compat lammps` the next step breaks by it, else by \
                   s00 − α s_min of each pair of types, which is the same where all pairs have one s00 and α. Without bonds, and before the first \
                   step, it is the largest number there is (1.8·10³⁰⁸), as in LAMMPS.",
            example: "compute r all property/atom radius",
        }
    }
}

#[derive(Words)]
struct Line {
    /// What each column holds.
    #[word(name = "attribute", what = "an attribute, as `radius`", kind = Kind::Attribute, least = 1)]
    attributes: Vec<Word>,
}

/// What a particle needs to have an attribute.
#[derive(Clone, Copy, PartialEq)]
enum Needs {
    Nothing,
    Sphere,
    Oriented,
    Charge,
    Moment,
    Peri,
    Molecules,
    Linked,
    Breaking,
}

impl Needs {
    fn met(self, style: AtomStyle) -> bool {
        match self {
            Needs::Nothing => true,
            Needs::Sphere => style.sphere,
            Needs::Oriented => style.oriented,
            Needs::Charge => style.charged,
            Needs::Moment => style.dipole,
            Needs::Peri => style.peri,
            Needs::Molecules => style.molecules,
            Needs::Linked => style.bonded,
            Needs::Breaking => style.peri || style.bonded,
        }
    }
}

type Read = fn(&World, usize) -> f64;

/// Reads an attribute of a particle.
#[derive(Clone)]
pub enum Getter {
    /// Computed per particle.
    Own(Read),
    /// Computed for all particles at once.
    Whole(fn(&World) -> Vec<f64>),
    /// A column of fix property/atom.
    Column(Numbers),
}

impl Getter {
    /// The getter for a run that begins: the fix of a property may have been deleted.
    ///
    /// # Errors
    /// No fix has the property any more.
    pub fn present(&self, w: &World, span: Span) -> Result<Self> {
        let Getter::Column(full) = self else { return Ok(self.clone()) };
        w.columns.present(*full).map(Getter::Column).ok_or_else(|| gone(full.text(), span).into())
    }

    /// The current values.
    pub fn values<'w>(&self, w: &'w World) -> Values<'w> {
        match self {
            Getter::Own(read) => Values::Own(w, *read),
            Getter::Whole(find) => Values::Found(Cow::Owned(find(w))),
            Getter::Column(key) => {
                Values::Found(Cow::Borrowed(w.columns.get_scalar(*key).unwrap_or_default()))
            }
        }
    }
}

/// Values of an attribute at one time.
pub enum Values<'w> {
    /// Computed on access.
    Own(&'w World, Read),
    /// Computed in advance.
    Found(Cow<'w, [f64]>),
}

impl Values<'_> {
    /// The value of particle `i`.
    pub fn get(&self, i: usize) -> f64 {
        match self {
            Values::Own(w, read) => read(w, i),
            Values::Found(all) => all.get(i).copied().unwrap_or(0.0),
        }
    }
}

/// Name, requirement and value of every attribute.
const ATTRIBUTES: &[(&str, Needs, Getter)] = &[
    ("id", Needs::Nothing, Getter::Own(|w, i| f64::from(w.particles.tag[i]))),
    ("type", Needs::Nothing, Getter::Own(|w, i| f64::from(w.particles.kind[i]))),
    ("proc", Needs::Nothing, Getter::Own(|_, _| 0.0)),
    ("mass", Needs::Nothing, Getter::Own(|w, i| Masses::of(w).get(i))),
    ("x", Needs::Nothing, Getter::Own(|w, i| w.particles.x[i][0])),
    ("y", Needs::Nothing, Getter::Own(|w, i| w.particles.x[i][1])),
    ("z", Needs::Nothing, Getter::Own(|w, i| w.particles.x[i][2])),
    ("xs", Needs::Nothing, Getter::Own(|w, i| scaled(w, i, 0))),
    ("ys", Needs::Nothing, Getter::Own(|w, i| scaled(w, i, 1))),
    ("zs", Needs::Nothing, Getter::Own(|w, i| scaled(w, i, 2))),
    ("xu", Needs::Nothing, Getter::Own(|w, i| unwrapped(w, i)[0])),
    ("yu", Needs::Nothing, Getter::Own(|w, i| unwrapped(w, i)[1])),
    ("zu", Needs::Nothing, Getter::Own(|w, i| unwrapped(w, i)[2])),
    ("ix", Needs::Nothing, Getter::Own(|w, i| f64::from(w.particles.image[i][0]))),
    ("iy", Needs::Nothing, Getter::Own(|w, i| f64::from(w.particles.image[i][1]))),
    ("iz", Needs::Nothing, Getter::Own(|w, i| f64::from(w.particles.image[i][2]))),
    ("vx", Needs::Nothing, Getter::Own(|w, i| w.particles.v[i][0])),
    ("vy", Needs::Nothing, Getter::Own(|w, i| w.particles.v[i][1])),
    ("vz", Needs::Nothing, Getter::Own(|w, i| w.particles.v[i][2])),
    ("fx", Needs::Nothing, Getter::Own(|w, i| w.particles.f[i][0])),
    ("fy", Needs::Nothing, Getter::Own(|w, i| w.particles.f[i][1])),
    ("fz", Needs::Nothing, Getter::Own(|w, i| w.particles.f[i][2])),
    ("radius", Needs::Sphere, Getter::Own(|w, i| w.particles.radius[i])),
    ("diameter", Needs::Sphere, Getter::Own(|w, i| 2.0 * w.particles.radius[i])),
    ("omegax", Needs::Sphere, Getter::Own(|w, i| w.particles.omega[i][0])),
    ("omegay", Needs::Sphere, Getter::Own(|w, i| w.particles.omega[i][1])),
    ("omegaz", Needs::Sphere, Getter::Own(|w, i| w.particles.omega[i][2])),
    ("tqx", Needs::Sphere, Getter::Own(|w, i| w.particles.torque[i][0])),
    ("tqy", Needs::Sphere, Getter::Own(|w, i| w.particles.torque[i][1])),
    ("tqz", Needs::Sphere, Getter::Own(|w, i| w.particles.torque[i][2])),
    ("quatw", Needs::Oriented, Getter::Own(|w, i| w.particles.quat[i][0])),
    ("quati", Needs::Oriented, Getter::Own(|w, i| w.particles.quat[i][1])),
    ("quatj", Needs::Oriented, Getter::Own(|w, i| w.particles.quat[i][2])),
    ("quatk", Needs::Oriented, Getter::Own(|w, i| w.particles.quat[i][3])),
    ("q", Needs::Charge, Getter::Own(|w, i| w.particles.charge[i])),
    ("mux", Needs::Moment, Getter::Own(|w, i| w.particles.mu[i][0])),
    ("muy", Needs::Moment, Getter::Own(|w, i| w.particles.mu[i][1])),
    ("muz", Needs::Moment, Getter::Own(|w, i| w.particles.mu[i][2])),
    ("mu", Needs::Moment, Getter::Own(|w, i| length(w.particles.mu[i]))),
    ("vfrac", Needs::Peri, Getter::Own(|w, i| w.particles.volume[i])),
    ("peri/strength", Needs::Peri, Getter::Whole(|w| bond_factors(w, 0))),
    ("peri/stiffness", Needs::Peri, Getter::Whole(|w| bond_factors(w, 1))),
    ("s0", Needs::Breaking, Getter::Whole(critical)),
    ("nbonds", Needs::Molecules, Getter::Whole(bonds_of)),
    ("smin", Needs::Linked, Getter::Own(|w, i| strain(w, i).map_or(0.0, |s| s.smallest))),
    ("lambda", Needs::Linked, Getter::Own(|w, i| w.families.as_ref().map_or(0.0, |f| f.plastic_strain(i)))),
    ("mol", Needs::Molecules, Getter::Own(|w, i| f64::from(w.particles.molecule[i]))),
];

/// LAMMPS' attributes of atom styles that perigrain does not have.
const ELSEWHERE: &[&str] = &[
    "spx", "spy", "spz", "sp", "fmx", "fmy", "fmz", "angmomx", "angmomy", "angmomz", "shapex", "shapey",
    "shapez", "end1x", "end1y", "end1z", "end2x", "end2y", "end2z", "corner1x", "corner1y", "corner1z",
    "corner2x", "corner2y", "corner2z", "corner3x", "corner3y", "corner3z", "espin", "eradius", "ervel",
    "erforce", "rho", "drho", "e", "de", "cv", "buckling",
];

/// The error for a property of fix property/atom that is read but not defined.
pub fn gone(full: &str, span: Span) -> Diagnostic {
    let key = full.splitn(4, '/').nth(3).unwrap_or(full);
    let name = key.split('/').next().unwrap_or(key);
    let text = format!("the particles have no `{name}` any more: its fix property/atom is gone");
    Diagnostic::error(Code::INCOMPLETE, span, text).help("leave out the `unfix`, or what reads the property")
}

/// The strain of a particle's bonds under `bond_style bpm/peri`.
fn strain(w: &World, i: usize) -> Option<Strain> {
    let families = w.families.as_ref().filter(|f| !f.of_bonds.is_empty())?;
    families.strain(&view(w).ok()?, i)
}

/// The critical stretch of each particle.
fn critical(w: &World) -> Vec<f64> {
    let Some((families, view)) = w.families.as_ref().zip(view(w).ok()) else { return vec![f64::MAX; w.n()] };
    if families.of_bonds.is_empty() {
        return families.critical_stretches(&view);
    }
    (0..w.n()).map(|i| families.strain(&view, i).map_or(0.0, |s| s.critical)).collect()
}

/// The per-particle factors set by `set … peri/strength` (0) or `peri/stiffness` (1).
fn bond_factors(w: &World, which: usize) -> Vec<f64> {
    let factors = w.columns.get_scalar(*BOND_FACTORS[which]).unwrap_or_default();
    let of = |i: usize| factors.get(i).copied().filter(|f| *f > 0.0).unwrap_or(1.0);
    (0..w.n()).map(of).collect()
}

/// Number of bonds stored with each particle.
fn bonds_of(w: &World) -> Vec<f64> {
    let tags = &w.particles.tag;
    let (index, mut counts) = (Index::new(tags), vec![0.0; w.n()]);
    let ends = if w.settings.newton.bond { 1 } else { 2 };
    for bond in w.bonds.list.iter().filter(|b| b.kind != 0) {
        for i in bond.ends[..ends].iter().filter_map(|t| index.find(*t, tags)) {
            counts[i] += 1.0;
        }
    }
    counts
}

fn scaled(w: &World, i: usize, d: usize) -> f64 {
    w.domain.as_ref().map_or(0.0, |b| match b.tilted() {
        true => b.fractions(&w.particles.x[i])[d],
        false => (w.particles.x[i][d] - b.lo[d]) / (b.hi[d] - b.lo[d]),
    })
}

impl ComputeStyle for PropertyAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { attributes } = read(args, cx)?;
        let reads = attributes.iter().fold(Fields::NONE, |reads, word| reads | reads_of(&word.text));
        let getters = attributes.iter().map(|word| read_attribute(word, cx)).collect::<Result<_>>()?;
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, span: cx.span, getters, reads }))
    }
}

/// The fields of an attribute that few particle styles have.
fn reads_of(name: &str) -> Fields {
    match name {
        "quatw" | "quati" | "quatj" | "quatk" => QUAT,
        "mux" | "muy" | "muz" | "mu" => MU,
        "q" => CHARGE,
        _ => Fields::NONE,
    }
}

/// The attribute's static name, if there is one.
pub fn find_attribute(name: &str) -> Option<&'static str> {
    ATTRIBUTES.iter().map(|a| a.0).find(|a| *a == name)
}

/// The getter of the attribute that a word names.
///
/// # Errors
/// Unknown attributes, and those that these particles do not have.
pub fn read_attribute(word: &Word, cx: &BuildCx) -> Result<Getter> {
    let name = word.text.as_str();
    if let Some((_, needs, getter)) = ATTRIBUTES.iter().find(|a| a.0 == name) {
        if needs.met(cx.world.particles.style) {
            return Ok(getter.clone());
        }
        let style = match needs {
            Needs::Sphere => "atom_style sphere",
            Needs::Oriented => "atom_style bpm/sphere",
            Needs::Charge => "atom_style charge",
            Needs::Moment => "atom_style dipole",
            Needs::Molecules => "atom_style bond",
            Needs::Linked => "bond_style bpm/peri",
            Needs::Breaking => "atom_style peri` or `bond_style bpm/peri",
            _ => "atom_style peri",
        };
        return Err(Diagnostic::error(
            Code::INCOMPLETE,
            word.span,
            format!("the particles of this scene have no `{name}`"),
        )
        .help(format!("`{style}`, alone or in a hybrid, has it"))
        .into());
    }
    if let Some(column) = cx.world.columns.custom(name) {
        return Ok(Getter::Column(column));
    }
    if ["i_", "d_", "i2_", "d2_"].iter().any(|p| name.starts_with(p)) {
        let d = Diagnostic::error(Code::UNKNOWN_NAME, word.span, format!("there is no property `{name}`"));
        return Err(d
            .help("`fix ID all property/atom NAME` makes one; of several columns choose one, as `d2_x[1]`")
            .into());
    }
    if [TEMPERATURE.text(), HEATFLOW.text()].contains(&name) {
        let text = format!("the particles of this scene have no `{name}`");
        let d = Diagnostic::error(Code::INCOMPLETE, word.span, text);
        return Err(d.help(format!("`fix ID all property/atom {name}` gives them one")).into());
    }
    if ELSEWHERE.contains(&name) {
        return fail(Code::NOT_SUPPORTED, word.span, format!("the attribute `{name}` is not in perigrain"));
    }
    let d =
        Diagnostic::error(Code::UNKNOWN_KEYWORD, word.span, format!("`{name}` is no attribute of particles"));
    let known = ATTRIBUTES.iter().map(|a| a.0);
    Err(match nearest(name, known.clone()) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help(format!("attributes: {}", known.collect::<Vec<_>>().join(" "))),
    }
    .into())
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    span: Span,
    getters: Vec<Getter>,
    /// Fields read by attributes of orientation.
    reads: Fields,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(self.getters.len()), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let w = &*cx.world();
        let getters: Result<Vec<Getter>> = self.getters.iter().map(|g| g.present(w, self.span)).collect();
        let (group, getters) = (self.group, getters?);
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            X | BOX
                | COLUMNS
                | FAMILIES
                | SITES
                | TAG
                | IMAGE
                | MASK
                | MASS
                | OMEGA
                | RADIUS
                | TORQUE
                | KIND
                | TYPE_MASS
                | VOLUME
                | X0
                | F
                | V
                | MOLECULE
                | self.reads,
            move |w, _, out| {
                let (bit, columns) = (group.bit(), getters.len());
                out.cols = columns;
                out.atom.resize(w.n() * columns, 0.0);
                let values: Vec<Values> = getters.iter().map(|g| g.values(w)).collect();
                par::each(&mut out.atom[..], |start, all| {
                    for (k, value) in all.iter_mut().enumerate() {
                        let (i, column) = ((start + k) / columns, (start + k) % columns);
                        *value = if w.particles.mask[i] & bit != 0 { values[column].get(i) } else { 0.0 };
                    }
                });
                Ok(())
            },
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;

    #[test]
    fn attributes_of_all_kinds() {
        let style = AtomStyle { sphere: true, peri: true, hybrid: true, ..AtomStyle::default() };
        let mut b = Bench::new(style, &[[1.0, 5.0, -10.0], [0.0; 3]]);
        b.world.particles.image[0] = [1, 0, -1];
        b.world.particles.volume[0] = 0.125;
        b.world.particles.mask[1] = 0;
        let c = b.compute(&PropertyAtom, "id xs ys zs xu zu iz mass diameter vfrac").unwrap();
        let slot = b.evaluate(&*c).unwrap();
        assert_eq!(slot.cols, 10);
        // The box reaches from -10 to 10; the bench sets mass 2 and radius 0.5.
        assert_eq!(slot.atom[..10], [1.0, 0.55, 0.75, 0.0, 21.0, -30.0, -1.0, 2.0, 1.0, 0.125]);
        assert_eq!(slot.atom[10..], [0.0; 10]);
    }

    #[test]
    fn what_is_missing_is_named() {
        let b = Bench::new(AtomStyle::default(), &[]);
        let code = |words: &str| b.compute(&PropertyAtom, words).err().unwrap().0[0].code;
        assert_eq!(code(""), Code::MISSING_ARGUMENT);
        assert_eq!(code("x radius"), Code::INCOMPLETE);
        assert_eq!(code("vfrac"), Code::INCOMPLETE);
        assert_eq!(
            [code("mol"), code("quatw"), code("espin")],
            [Code::INCOMPLETE, Code::INCOMPLETE, Code::NOT_SUPPORTED]
        );
        assert_eq!(code("d_mine"), Code::UNKNOWN_NAME);
        assert_eq!(code("radus"), Code::UNKNOWN_KEYWORD);
    }
}
