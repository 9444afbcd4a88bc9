//! Computes peri/defgrad/atom, peri/strain/atom and peri/stress/atom: deformation of peridynamic families.

use super::peri_state_atom::need_stress;
use super::{Compute, ComputeStyle, Share};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use perigrain_base::par;
use perigrain_lang::Args;
use perigrain_peri::kinematics::{Tensor, determinant, green_lagrange, neo_hooke, von_mises};
use perigrain_peri::moduli::Elastic;
use perigrain_peri::stress::State;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::peri_view::view;
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{At, Form, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style, UseKind};
use perigrain_world::field::{BOX, FAMILIES, KIND, MASK, SITES, VOLUME, X, X0};
use perigrain_world::{GroupId, SlotId};

/// `compute … peri/defgrad/atom`.
pub struct DefgradAtom;

/// `compute … peri/strain/atom`.
pub struct StrainAtom;

/// `compute … peri/stress/atom`.
pub struct CauchyAtom;

impl Style for DefgradAtom {
    fn name(&self) -> &'static str {
        "peri/defgrad/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Deformation gradient of each peridynamic particle, from its unbroken bonds.",
            text: "Per-atom array of 10 columns: F_xx F_xy F_xz F_yx … F_zz, and J = det F, without dimension. \
                   F = (Σ ω w Y⊗ξ V_j) K⁻¹ with K = Σ ω w ξ⊗ξ V_j over the unbroken bonds, ξ a bond at the first run and Y \
                   the same bond now (Silling et al. 2007; Hartmann et al. 2023, equations 26 and 27); the influence ω is that of \
                   the pair style. Exact for every family when the body deforms evenly, at surfaces too.\n\nA layer of \
                   particles that stays in a plane of constant z, as in two dimensions, has F_zz = 1. All columns are 0, J \
                   among them, where no three bonds have independent directions, \
                   before the first run, for particles without a family, and outside the group.\n\n\
                   The few bonds of a torn family are a mechanism: its F shows how hinges turn, not how a solid is strained, and \
                   its stress may be hundreds of times what a bond ever bears. A family is torn beyond `damage`, or where the least \
                   eigenvalue of K is below 0.05 of that of the whole family. `compute reduce` with min and max passes over NaN; means and sums of \
                   a body with torn families are NaN unless `torn zero` is given, and then count those as 0.",
            example: "compute F all peri/defgrad/atom",
        }
    }
}

impl Style for StrainAtom {
    fn name(&self) -> &'static str {
        "peri/strain/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Green–Lagrange strain of each peridynamic particle.",
            text: "Per-atom array of 6 columns xx yy zz xy xz yz: E = ½(FᵀF − 1), without dimension, F as that of compute \
                   peri/defgrad/atom; rotations have no strain. Shear components are half the change of angle. 0 where there is \
                   no F, NaN (or 0) in torn families: `torn` and `damage` as of that compute.",
            example: "compute E all peri/strain/atom",
        }
    }
}

impl Style for CauchyAtom {
    fn name(&self) -> &'static str {
        "peri/stress/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const {
                    &[
                        Form::behind(OfNumbers::GRAMMAR),
                        Form::behind(OfMaterial::GRAMMAR),
                        Form::behind(OfPair::GRAMMAR),
                    ]
                },
            ),
            summary: "Cauchy stress of each peridynamic particle: that of pair_style peri/cauchy, or as of a Neo-Hooke solid that is deformed alike.",
            text: "Per-atom array of 8 columns: σ_xx yy zz xy xz yz and von Mises' equivalent stress in pressure units, and \
                   J = det F. σ = (G/J)(FFᵀ − 1) + (λ/2J)(J² − 1)1 with F as that of compute peri/defgrad/atom and K, G, \
                   λ = K − 2G/3 of Young's modulus `E` and Poisson's ratio `nu`, or of a `material` (Hartmann et al. 2023, equations \
                   28 to 30). Where temperatures strain the solid, F is divided by 1 + α_T (T − T0), but for J. With `pair` it is the \
                   stress of the material under `pair_style peri/cauchy`, of the latest force evaluation.\n\n\
                   That of `neohooke` is a picture of the strain in terms of stress: forces come from the pair style, which knows nothing \
                   of it; compute stress/atom has what bonds bear, torn families included. 0 where there is no F, and but for J where J is not \
                   positive; NaN (or 0) in torn families: `torn` and `damage` as of compute peri/defgrad/atom.",
            example: "compute S all peri/stress/atom neohooke 1.0e5 0.48",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(keyword)]
    torn: Gap,
    /// A family is torn where more than this share of its volume is broken.
    #[word(
        keyword,
        name = "PHI",
        what = "the share of a family beyond which it is torn",
        default = Share(0.7),
        shown = "0.7"
    )]
    damage: Share,
}

/// What torn families have.
#[derive(Default, Words)]
#[word(what = "value of torn families")]
enum Gap {
    /// NaN in all columns of torn families.
    #[default]
    Nan,
    /// 0 in all columns of torn families.
    Zero,
}

#[derive(Words)]
struct OfNumbers {
    law: Law,
    /// Young's modulus E [pressure].
    #[word(name = "E", positive)]
    young: f64,
    /// Poisson's ratio nu, between −1 and 0.5.
    #[word(what = "Poisson's ratio nu")]
    nu: At<f64>,
    #[word(flatten)]
    rest: Line,
}

#[derive(Words)]
struct OfMaterial {
    law: Law,
    material: Named,
    #[word(flatten)]
    rest: Line,
}

#[derive(Words)]
struct OfPair {
    source: Source,
    #[word(flatten)]
    rest: Line,
}

/// Where the stress comes from.
#[derive(Words)]
#[word(what = "source of the stress")]
enum Source {
    /// That of `pair_style peri/cauchy`.
    Pair,
}

/// The material law of the stress.
#[derive(Words)]
#[word(what = "material law of the stress")]
enum Law {
    Neohooke,
}

/// A material of the deck.
#[derive(Words)]
enum Named {
    /// Its Young's modulus and Poisson's ratio.
    Material(#[word(name = "ID", with = of_material, kind = Kind::Material)] Elastic),
}

impl ComputeStyle for DefgradAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        declared(Measure::Gradient, &read(args, cx)?, cx)
    }
}

impl ComputeStyle for StrainAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        declared(Measure::Strain, &read(args, cx)?, cx)
    }
}

impl ComputeStyle for CauchyAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        if args.peek_text() == "pair" {
            let OfPair { source: Source::Pair, rest } = read(args, cx)?;
            return declared(Measure::Own, &rest, cx);
        }
        let (solid, rest) = if args.peek_at(1).is_some_and(|w| w.text == "material") {
            let OfMaterial { law: Law::Neohooke, material: Named::Material(solid), rest } = read(args, cx)?;
            (solid, rest)
        } else {
            let OfNumbers { law: Law::Neohooke, young, nu: At { value: nu, span, unknown }, rest } =
                read(args, cx)?;
            let possible = nu > -1.0 && nu < 0.5;
            if !unknown && !possible {
                return fail(Code::BAD_VALUE, span, "nu must lie between -1 and 0.5");
            }
            (Elastic { young, nu }, rest)
        };
        declared(Measure::Stress { bulk: solid.bulk(), shear: solid.shear() }, &rest, cx)
    }
}

/// The material given by `material ID`.
fn of_material(args: &mut Args, cx: &BuildCx) -> Result<Elastic> {
    let id = args.expect("the material's ID")?;
    let Some(m) = cx.world.materials.get(&id.text) else {
        let known = cx.world.materials.keys().map(String::as_str);
        let text = format!("there is no material `{}`", id.text);
        let d = Diagnostic::error(Code::UNKNOWN_MATERIAL, id.span, text);
        return Err(match nearest(&id.text, known) {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d.help("define it before this line with `material ID …`"),
        }
        .into());
    };
    cx.uses(UseKind::Material, &id.text);
    Ok(Elastic { young: m.young, nu: m.nu })
}

fn declared(measure: Measure, line: &Line, cx: &BuildCx) -> Result<Box<dyn Compute>> {
    let value = if matches!(line.torn, Gap::Zero) { 0.0 } else { f64::NAN };
    let torn = Torn { most: line.damage.0, value };
    super::need_bonds(measure.name(), cx)?;
    Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, span: cx.span, measure, torn }))
}

/// Output for families with too few bonds to define a deformation gradient.
#[derive(Clone, Copy)]
struct Torn {
    /// The broken fraction above which a family is treated this way.
    most: f64,
    /// The value written to all columns.
    value: f64,
}

/// The quantity computed from a deformation gradient.
#[derive(Clone, Copy)]
enum Measure {
    Gradient,
    Strain,
    Stress {
        bulk: f64,
        shear: f64,
    },
    /// Of the pair style.
    Own,
}

impl Measure {
    fn name(self) -> &'static str {
        match self {
            Self::Gradient => "peri/defgrad/atom",
            Self::Strain => "peri/strain/atom",
            Self::Stress { .. } | Self::Own => "peri/stress/atom",
        }
    }

    fn columns(self) -> usize {
        match self {
            Self::Gradient => 10,
            Self::Strain => 6,
            Self::Stress { .. } | Self::Own => 8,
        }
    }

    /// Fills a row of zeros; stress is that of F over 1 + ε, with the thermal strain ε. `own` is what the pair style has of the
    /// particle.
    fn put(self, f: &Tensor, thermal: f64, own: impl FnOnce() -> Option<State>, row: &mut [f64]) {
        match self {
            Self::Gradient => {
                row[..9].copy_from_slice(f.as_flattened());
                row[9] = determinant(f);
            }
            Self::Strain => row.copy_from_slice(&green_lagrange(f)),
            Self::Stress { bulk, shear } => {
                row[7] = determinant(f);
                let elastic = match thermal == 0.0 {
                    true => *f,
                    false => f.map(|row| row.map(|a| a / (1.0 + thermal))),
                };
                if let Some(stress) = neo_hooke(&elastic, bulk, shear) {
                    row[..6].copy_from_slice(&stress);
                    row[6] = von_mises(&stress);
                }
            }
            Self::Own => {
                row[7] = determinant(f);
                let Some(state) = own().filter(|_| row[7] > 0.0) else { return };
                let stress = state.stress.map(|tau| tau / row[7]);
                row[..6].copy_from_slice(&stress);
                row[6] = von_mises(&stress);
            }
        }
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    span: Span,
    measure: Measure,
    torn: Torn,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(self.measure.columns()), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let mut reads = X | FAMILIES | VOLUME | MASK | BOX | KIND | X0;
        if matches!(self.measure, Measure::Own) {
            need_stress(&self.id, self.span, cx)?;
            reads |= SITES;
        }
        let (bit, measure, width) = (self.group.bit(), self.measure, self.measure.columns());
        let torn = self.torn;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, reads, move |w, _, out| {
            out.cols = width;
            out.atom.clear();
            out.atom.resize(width * w.n(), 0.0);
            let Some(families) = &*w.families else { return Ok(()) };
            let view = view(w)?;
            let rows = par::Rows { data: &mut out.atom[..], width };
            par::each((rows, &w.particles.mask[..]), |start, (rows, mask)| {
                for (k, (row, mask)) in rows.data.chunks_exact_mut(width).zip(mask).enumerate() {
                    if mask & bit == 0 {
                        continue;
                    }
                    if families.torn(&view, start + k, torn.most) {
                        row.fill(torn.value);
                    } else if let Some(f) = families.gradient(&view, start + k) {
                        let thermal = families.thermal_strain(start + k);
                        measure.put(&f, thermal, || families.state(start + k), row);
                    }
                }
            });
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    // The closed forms are tested in laws::peri::kinematics, the decks in
    // tests/scripts/good/peri_measures.in.
    #[test]
    fn nothing_before_the_first_run_and_mistakes() {
        let mut b = Bench::new(AtomStyle { peri: true, ..AtomStyle::default() }, &[[0.0; 3]; 2]);
        for (style, words, columns) in [
            (&DefgradAtom as &dyn ComputeStyle, "", 10),
            (&StrainAtom, "", 6),
            (&CauchyAtom, "neohooke 1e5 0.48", 8),
        ] {
            let c = b.compute(style, words).unwrap();
            assert_eq!(b.evaluate(&*c).unwrap().atom, vec![0.0; 2 * columns]);
            let bare = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
            assert!(bare.compute(style, words).is_err());
        }
        for words in ["", "hooke 1 0.2", "neohooke 1e5 0.5", "neohooke -1 0.2", "neohooke material none"] {
            assert!(b.compute(&CauchyAtom, words).is_err(), "{words}");
        }
    }
}
