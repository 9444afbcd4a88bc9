//! `peri_modify`: options of peridynamic styles.

use super::{Calibrate, Solid, bond_weights, breaking};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_peri::families::{BondWeights, Criterion, Families, ForceUnit, Influence, VolumeRule};
use perigrain_styles::words::{At, Kind, Value, Words, alternatives, one_in};
use perigrain_styles::{BuildCx, UseKind};
use perigrain_world::Region;

/// The words of `peri_modify`.
#[derive(Words)]
pub struct Line {
    /// What forces are.
    #[word(keyword, like = Units, shown = "density, with materials newton")]
    force: Option<ForceUnit>,
    #[word(keyword, like = Volumes, shown = "lammps")]
    volume: Option<VolumeRule>,
    #[word(keyword, shown = "no", placed)]
    calibrate: Option<At<Calibrate>>,
    /// How the stiffness of a bond depends on its length |ξ|: as 1/|ξ|, 1 or exp(−|ξ|²/δ²).
    #[word(keyword, like = Influences, shown = "one, of state-based laws inverse", placed)]
    influence: Option<At<Influence>>,
    /// What makes up for bonds that lack at surfaces.
    #[word(keyword, shown = "no", placed)]
    surface: Option<At<Surface>>,
    /// In which spacing horizons of materials count.
    #[word(keyword, shown = "lattice", placed)]
    horizon: Option<At<Spacing>>,
    /// Whether a broken bond still pushes with c s w V_j while it is shorter than at the start, so that crushed parts do not pass
    /// through each other; bonds of `peri_crack` too, and under state-based laws with c = 18K/(πδ⁴).
    #[word(keyword, name = "compress compress", what = "broken compress", shown = "no")]
    broken: Option<(Compress, bool)>,
    /// A region: bonds of which one end lies in it at the start never break.
    #[word(keyword, name = "region ID")]
    nofail: Vec<(Within, Region)>,
    /// Whether close particles repel each other; contact laws keep them apart in place of that (`group … surface`).
    #[word(keyword, what = "repulsion", shown = "yes")]
    repulsion: Option<bool>,
    #[word(keyword, placed)]
    family: Option<At<Members>>,
    /// By what bonds break. Only bonds that are longer than at the start do, whatever the criterion.
    #[word(keyword = "break", what = "break", shown = "stretch", placed)]
    criterion: Option<At<Break>>,
    /// Bonds are judged by a criterion other than their stretch at multiples of N steps.
    #[word(
        keyword,
        name = "N",
        what = "the number of steps from one judgement of bonds to the next",
        from = 1,
        shown = "1"
    )]
    every: Option<i64>,
}

/// What forces are.
#[derive(Words)]
#[word(what = "unit of forces", of = ForceUnit)]
enum Units {
    /// Force densities, with the density in the place of mass, as in LAMMPS.
    Density,
    /// True forces and masses ρV.
    Newton,
}

/// How bonds near the horizon are weighed.
#[derive(Words)]
#[word(what = "volume rule", of = VolumeRule)]
enum Volumes {
    /// Bonds within half a spacing of the horizon count (δ + dx/2 − |ξ|)/dx.
    Lammps,
    /// All bonds count wholly.
    None,
    /// The family extends to δ + dx/2, where LAMMPS' weight vanishes.
    Full,
}

/// An influence function.
struct Influences(Influence);

impl From<Influences> for Influence {
    fn from(named: Influences) -> Self {
        named.0
    }
}

impl Value for Influences {
    const KIND: Kind = Kind::Choice(&alternatives(&Influence::NAMES));
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        one_in("influence function", args, &Influence::NAMES).map(Self)
    }
}

/// What makes up for bonds that lack at surfaces.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "correction of surfaces")]
enum Surface {
    /// Nothing.
    No,
    /// The bonds of each particle of a bond-based law are as much stiffer as its family is poorer than a whole one.
    Energy,
    /// Families are made whole in each direction.
    Tensor,
}

/// In which spacing horizons of materials count.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "spacing that horizons count in")]
enum Spacing {
    /// In the spacing of the lattice.
    Lattice,
    /// In the spacing around each particle, the cube root of the mean volume of the particles within two edges of its own.
    Own,
}

/// What broken bonds may do.
#[derive(Words)]
#[word(what = "what broken bonds do")]
enum Compress {
    Compress,
}

/// Where bonds last.
#[derive(Words)]
#[word(what = "what lasts")]
enum Within {
    Region,
}

/// Which members of one family contact laws keep out.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "rule of contacts in a family")]
enum Members {
    /// Contact laws keep members of one family out for good, whether their bond lives or not.
    Exclude,
    /// They keep them out as long as the bond lives: surfaces that were torn apart meet again from the step after. Spheres of bonded
    /// neighbours must then not overlap (`set … peri/radius half`).
    Broken,
}

/// By what bonds break.
#[derive(Words)]
#[word(what = "criterion of breaking")]
enum Break {
    /// Their stretch beyond s00, which alpha raises under compression.
    Stretch,
    /// The work done on them: a bond breaks at the one work at which a crack along a lattice plane costs the fracture energy
    /// that its s00 stands for.
    Energy,
    /// The normal stress along them, as the mean of that at both ends.
    Stress {
        /// The strength.
        #[word(name = "S", what = "the tensile strength", positive)]
        most: f64,
    },
    /// The Green-Lagrange strain along them, as the mean of that at both ends.
    Strain {
        /// The largest strain.
        #[word(name = "E", what = "the largest strain", positive)]
        most: f64,
    },
    /// Von Mises' stress, as the mean of that at both ends.
    Shear {
        /// The strength.
        #[word(name = "Y", what = "the largest von Mises stress", positive)]
        most: f64,
    },
    /// A formula: a bond breaks where its value is 1 or more.
    Formula {
        /// A bond-style variable. Its formula may name the stretch `s` of the bond, its length `L` at the start, its direction `nx ny nz`
        /// now, temperature `T1 T2` and damage `d1 d2` of its ends, and atom-style variables of an end, `v_NAME[1]` and `v_NAME[2]`.
        #[word(name = "v_NAME", with = bond_variable, kind = Kind::Reference)]
        of: ValueRef,
    },
}

/// A bond-style variable with its `v_`; whether it is one is known when a run begins.
fn bond_variable(args: &mut Args, cx: &BuildCx) -> Result<ValueRef> {
    let word = args.expect("the bond-style variable after formula")?;
    match ValueRef::parse(&word.text, word.span)? {
        Some(r) if r.kind == RefKind::Variable && r.index.is_empty() => {
            cx.uses(UseKind::Variable, &r.name);
            Ok(r)
        }
        _ => {
            let text = format!("`break formula` takes v_NAME of a bond-style variable, not `{}`", word.text);
            fail(Code::WRONG_KIND, word.span, text)
        }
    }
}

impl From<&Break> for Criterion {
    fn from(named: &Break) -> Self {
        match *named {
            Break::Stretch => Self::Stretch,
            Break::Energy => Self::Work,
            Break::Stress { most } => Self::Stress(most),
            Break::Strain { most } => Self::Strain(most),
            Break::Shear { most } => Self::Shear(most),
            Break::Formula { .. } => Self::Formula,
        }
    }
}

/// Reads the words of a `peri_modify`.
///
/// # Errors
/// Every mistake in the line.
pub fn read(style: &mut Solid, args: &mut Args, cx: &BuildCx) -> Result<()> {
    if args.is_empty() {
        let text = format!("peri_modify needs an option: {}", Line::GRAMMAR.keywords().join(", "));
        return fail(Code::MISSING_ARGUMENT, args.here(), text);
    }
    let line: Line = perigrain_styles::words::read(args, cx)?;
    style.unit = line.force.or(style.unit);
    style.volume = line.volume.unwrap_or(style.volume);
    if let Some(at) = line.influence {
        style.law.influence = at.value;
        settled(style, "influence", at.span, cx)?;
    }
    if let Some(at) = line.surface {
        correct(style, at)?;
        settled(style, "surface", at.span, cx)?;
    }
    if let Some(at) = line.horizon {
        style.weights.own_horizons = at.value == Spacing::Own;
        bond_weights::needs_materials(style, at.span)?;
        settled(style, "horizon", at.span, cx)?;
    }
    if let Some((Compress::Compress, compress)) = line.broken {
        style.compress = compress;
    }
    if let Some(at) = line.calibrate {
        if !style.law.kind.bond_based && at.value != Calibrate::No {
            let text = "peri_modify calibrate concerns bond-based styles: a state-based solid has its bulk modulus on any lattice";
            return fail(Code::CONFLICT, at.span, text);
        }
        style.calibrate = at.value;
    }
    if let Some(repulsion) = line.repulsion {
        style.no_repulsion = !repulsion;
    }
    style.lasting.extend(line.nofail.into_iter().map(|(Within::Region, region)| region));
    if let Some(at) = line.family {
        style.reunite = Some((at.value == Members::Broken, at.span));
    }
    if let Some(at) = line.criterion {
        breaking::choose(style, (&at.value).into(), at.span, cx)?;
        style.breaking.formula = if let Break::Formula { of } = at.value { Some(of) } else { None };
    }
    style.breaking.every = line.every.unwrap_or(style.breaking.every);
    Ok(())
}

/// Sets the correction of surfaces.
fn correct(style: &mut Solid, surface: At<Surface>) -> Result<()> {
    let how = surface.value;
    if !style.law.kind.bond_based && how == Surface::Energy {
        let text = "peri_modify surface energy concerns peri/pmb: a state-based particle weighs its own family (`surface tensor` corrects it, too)";
        return fail(Code::CONFLICT, surface.span, text);
    }
    // Bonds that remember have no columns of sites: each is weighed by itself.
    let remember = style.law.kind.edge.is_some();
    style.law.surface = how == Surface::Energy && !remember;
    style.weights.whole_energies = how == Surface::Energy && remember;
    style.weights.whole_families = how == Surface::Tensor;
    Ok(())
}

/// Refuses options that shape bonds where they cannot: bonds that flow or soften are alike at any length; nothing changes once bonds
/// have been weighed.
fn settled(style: &Solid, option: &str, at: Span, cx: &BuildCx) -> Result<()> {
    if option == "influence" && style.law.kind.edge.is_some() {
        let text = format!("peri_modify {option} does not concern pair_style {}", style.name);
        return fail(Code::CONFLICT, at, text);
    }
    // A restart file says its lines again.
    let other = |f: &Families| match option {
        "influence" => f.law.influence != style.law.influence,
        "horizon" => f.options.weights.own_horizons != style.weights.own_horizons,
        _ => {
            let surfaces = |surface: bool, w: BondWeights| (surface, w.whole_families, w.whole_energies);
            surfaces(f.law.surface, f.options.weights) != surfaces(style.law.surface, style.weights)
        }
    };
    if cx.world.families.as_ref().is_some_and(other) {
        let text = format!("peri_modify {option} comes too late: bonds were weighed at the first run");
        return fail(Code::WRONG_ORDER, at, text);
    }
    Ok(())
}
