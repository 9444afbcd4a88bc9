//! `pair_style peri/pmb`: bond-based peridynamics with the prototype microelastic brittle model.

use super::start;
use crate::{Pair, PairStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_peri::law;
use perigrain_styles::words::Syntax;
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct PeriPmb;

impl Style for PeriPmb {
    fn name(&self) -> &'static str {
        "peri/pmb"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Written(
                "pair_style peri/pmb\n\
                     pair_coeff i j c horizon s00 alpha\n\
                     pair_coeff i j material ID horizon H [form bulk|shear|young] [s00 value] [alpha value]\n\
                     pair_coeff i j mix arithmetic|harmonic|geometric\n\
                     peri_modify [force density|newton] [volume lammps|none|full] [calibrate no|bulk|young] [influence one|inverse|gaussian] [surface no|energy|tensor] [horizon lattice|own] [broken compress no|yes] [nofail region ID]… [repulsion yes|no] [family exclude|broken]",
            ),
            summary: "Bond-based peridynamics: elastic bonds that break when stretched too far.",
            text: "Every particle has bonds to all others within the `horizon` δ at the first run. A bond of reference \
                length |ξ| and stretch s = (r − |ξ|)/|ξ| pulls with the force density `c` s w V_j; w is the partial \
                volume weight. It breaks for good when s > `s00` − `alpha` max(s_min,i, s_min,j), with s_min the smallest \
                stretch of each particle's live bonds in the step before; nothing breaks in the first step. Particles \
                closer than min(0.9 of their distance at creation, 1.35 lattice spacings) repel each other with \
                15 c/δ, bonded or not (Silling & Askari 2005; Parks et al. 2008).\n\n\
                Units: c energy/length⁷ (force per volume²), horizon length, s00 and alpha without dimension. \
                With numbers as coefficients forces are force densities and `mass` is the density, as in LAMMPS. \
                A `material` turns engineering data into c and s00, its horizon counted in lattice spacings, and makes \
                forces true forces and masses ρV (`peri_modify force newton`). `form` says which modulus the bonds keep, as they fix \
                ν = 1/4: c = 18K/(πδ⁴) (`bulk`, the default), 30G/(πδ⁴) (`shear`, Walayat et al. 2023) or 12E/(πδ⁴) (`young`); \
                s00 = √(10 G_c/(π c δ⁵)), or what is said here or by the material. `mix`, for two types that both have a \
                material (no ranges), takes means of their data. Materials and plain numbers do not go together in one body.\n\n\
                `peri_modify volume`: `lammps` weighs bonds within half a spacing of the horizon by \
                (δ + dx/2 − |ξ|)/dx, `none` not at all, `full` extends the family to δ + dx/2, where that weight \
                vanishes. On a lattice the sum over bonds is not the integral that c stands for: with LAMMPS' weights and a \
                horizon of 3.015 spacings the bulk modulus comes out at 0.89 of K, Young's modulus along an axis at 0.82 of \
                E. `calibrate` divides c by that ratio, reckoned for a simple cubic lattice of the present spacing: `bulk` \
                makes K right, `young` E (for ν = 1/4); s00 stays. `influence` makes the micro-modulus depend on a bond's \
                length: c g(|ξ|) with g proportional to 1, δ/|ξ| or exp(−|ξ|²/δ²), all with the same K; a crack then costs \
                0.94 and 0.95 of the G_c that s00 stands for. `surface energy` makes the bonds of each particle as much \
                stiffer as its family is poorer than a whole one (by the energy of an even growth, λ = πδ⁴/Σ g w |ξ| V, a \
                bond taking the mean of both ends): surfaces are no longer soft, and K is right inside, but a thin bar pulled along \
                its faces is too stiff (by 27 % with six particles across it, 13 % with twelve), as what its families lack are bonds across. \
                `surface tensor` makes families whole in each direction: bonds get factors (a polynomial of their direction, \
                0.2 to 5) that give Σ c w |ξ| n⊗n⊗n⊗n V of each particle the value of a whole ball, at surfaces, between \
                irregular neighbours and inside of lattices, where shear is then the same in all directions. Bars with \
                six particles and more across, on a lattice, jittered, meshed, of voxels, have E to 2 % with `volume full`; with four across bonds are 5 % too stiff. Flat scenes have no balls: there it is refused. State-based laws have \
                it, too. `horizon own`: a material's horizon counts in the spacing around each particle, the cube root of the \
                mean volume of the particles within two edges of its own, in place of the lattice's. There is a bond where \
                one end is within the horizon of the other; it has the mean of what it is in both families, c ∝ δ⁻⁴ and partial volumes of each, \
                nothing where it is beyond one of them (dual horizons, Ren et al. 2016), so that forces are equal and opposite and the energy under even \
                strain is the material's; s00 of a G_c goes with δ^(−½), the longer horizon counts. It needs materials, and no `calibrate`. \
                All three are said before the first run; bodies of several types or volumes run as lists with `surface energy`, all \
                bodies with the others; the log says what they change. `broken compress yes`: a broken bond \
                still pushes with c s w V_j while it is shorter than at the start, so that crushed parts do not pass through \
                each other; bonds of `peri_crack` too, and under state-based laws with c = 18K/(πδ⁴). `nofail region` makes \
                bonds last whose one end lies in the region at the start. `repulsion no` leaves the short-range force out, \
                where contact laws keep particles apart (`group … surface`). Strength and stiffness may differ from particle to particle, also at random: `set … peri/strength` and \
                `peri/stiffness`. Of those laws `family exclude` keeps members of one \
                family out for good, whether their bond lives or not; `family broken` as long as it lives: surfaces that were \
                torn apart meet again from the step after. Spheres of bonded neighbours must then not overlap \
                (`set … peri/radius half`).",
            example: "pair_style peri/pmb\npair_coeff * * 1.6863e22 0.0015001 5.0e-4 0.25",
        }
    }
}

impl PairStyle for PeriPmb {
    fn build(&self, _args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        start("peri/pmb", law::PMB, cx)
    }
}
