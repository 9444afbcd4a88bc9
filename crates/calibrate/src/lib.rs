//! `calibrate`: stiffness and strength of bonded bodies without a run, and coefficients of bonds that give them.
//!
//! The command reads its line, makes a body of the scene and leaves the work to `statics`; results are kept in the world. The
//! crate knows no other command.

// Units stand in brackets in doc comments, as [length]; they are no links.
#![allow(rustdoc::broken_intra_doc_links)]

mod cell;
mod conflicts;
mod dsm;
mod fit;
mod found;
mod kinds;
mod line;
mod messages;
mod model;
mod scene;
mod setup;
mod softer;
mod ste;
mod strength;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_large;
mod touch;
mod words;

use found::Found;
use line::{Calibration, Head};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::{self, populated};
use perigrain_styles::words::{Forms, Syntax};
use perigrain_styles::{Act, ActCx, BuildCx, CommandStyle, Compute, Doc, Style};
use perigrain_world::GroupId;
use perigrain_world::Registration;
use scene::Scene;
use touch::Hertz;
use words::{Solver, Words};

/// The commands of this crate.
pub const COMMANDS: &[&dyn CommandStyle] = &[&Calibrate];

/// The command.
pub struct Calibrate;

impl Style for Calibrate {
    fn name(&self) -> &'static str {
        "calibrate"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(Calibration::FORMS),
            summary: "Stiffness and strength of bonded bodies without a run, and coefficients of bonds that give them.",
            text: DOC,
            example: "units si\natom_style hybrid sphere bond\nboundary f f f\nlattice fcc 1.4142e-3\n\
                      region b block -0.1 2.9 -0.1 2.9 -0.1 2.9\ncreate_box 1 b bond/types 1 extra/bond/per/atom 12\ncreate_atoms 1 box\n\
                      set group all diameter 1e-3\nspecial_bonds lj/coul 0 1 1\ncreate_bonds many all all 1 0.9e-3 1.1e-3\n\
                      bond_style harmonic\nbond_coeff 1 2.5e5 1e-3\n\
                      calibrate dsm a all axis z strain -0.01 low plate high plate\ncalibrate ste b all axis z\n\
                      calibrate fit c all target K 2.0e4 vary bond 1 k low plate high plate\n\
                      print \"before: $(c_a[1]:%.5g) N/m, estimated $(c_b[1]:%.5g) N/m; now $(c_c[1]:%.5g) N/m with k = $(c_c[11]:%.5g) N/m\"",
        }
    }
    fn registrations(&self) -> &'static [&'static Registration] {
        const { &[&found::FIELDS] }
    }
}

/// The page's text.
const DOC: &str = "\
    Statics of a body of bonded particles as it stands now: no time passes, nothing moves; displacements are small and directions stay, unless `large yes` \
    or `mu` is given. Stiffnesses of bonds come from the bond style: `bpm/beam` and `bpm/rotational` have all four (stretch, shear, twist, bend), \
    `bpm/spring` and `harmonic` resist stretch alone. Pieces that nothing holds are left out and counted. Particles without a radius count as spheres that \
    reach half way to their partners. After Jarolin and Dosta, Comput. Part. Mech. 8 (2021) 1065.\n\n\
    **dsm**: the field begins with the affine one and is improved by conjugate gradients until three times what the last five steps have taken from the \
    energy is below the part P (`tol`) of it: K approaches from above. That is an estimate and no bound: K of four random packings was 2 to 5 times nearer \
    than P, of inverse opals 6 to 13 times. ν is of the field and converges as the root of that.\n\n\
    Bodies that do not follow the load evenly (struts that bend, pores) are solved by clusters of particles that move as rigid bodies from the 15th step \
    on: one of 2·10⁶ bonds around pores takes 66 steps to 1e-5 in place of 449.\n\n\
    **Contacts** between particles count where the pair style has Hertz contacts (`hertz/material … tangential mindlin NULL …`) unless `contacts no` is \
    given: pairs whose bonds do not bar them (`special_bonds`), found once, closed and opened by Newton's method, without slip. K is F/Δ then.\n\n\
    **`large yes`**: bonds are those of `bpm/beam` with the given stiffnesses (springs where these resist stretch alone), contacts push along the line of \
    centres as it is, and what they bear across counts from where they came to touch. K is F/Δ under the strain S, as a slow run has it: bodies whose \
    struts bend (inverse opals) are 3 to 6 % off at 2 % without it.\n\n\
    **`mu M`** does the same as `large yes` and lets surfaces slip where they bear M times the normal force: agglomerates in which contacts carry much are \
    up to twice too stiff without it, within a percent of a run with it. Walls stay without friction. Each of the `steps` of the load is balanced by \
    Newton's method; K of an agglomerate with 80 % of its contacts slipping changed by 0.05 % from 1 to 20. Contacts that cannot slip at all may have no \
    balance, which gives a warning; so do contacts that bear more than a tenth of the energy where no `mu` is given.\n\n\
    **ste**: on bodies with free faces 5 to 15 % off. Where struts bend between pores it is worthless, 4 to 7 times too stiff in inverse opals: of bodies \
    with less than 40 % of solid a dozen steps of `dsm` look whether it is, and a warning says so. `calibrate dsm … tol 0.1` is 1 % off there. Walls are \
    put in series with the slabs. Contacts that close under the strain count as springs; with `mu M` as those of the whole way to it, and across as far as \
    M lets them bear. `map` gives c_ID[1] to [3] per particle.\n\n\
    **strength** loads the body ever more: S above 0 pulls, below 0 presses; its size does not matter. All that bonds bear is proportional to the load, so \
    the one nearest to its strength gives the load at which it breaks (`strength`, `criterion`, `weibull` of bpm/beam, the limits of bpm/rotational and \
    bpm/spring). Without it the body is solved again from where it was, to the part P (`tol`) of what the break has changed. This ends when the force is \
    below `until` P of the largest one, after `most` N breaks, or when the body is in two.\n\n\
    - `avalanche` applies where a break leaves other bonds beyond their strength.\n\
    - `together P` gives the way of a body of which some strengths are up to P smaller, in far fewer solutions (90,000 bonds with P of 0.005: a quarter of \
    the time, 0.2 % less).\n\
    - Small displacements, no waves, no contacts (cracks that close bear nothing, so that strength under pressure is underestimated), no damping, `smooth` \
    left out.\n\
    - A slow, damped run follows the same breaks until the first avalanche swings beyond where it will come to rest: three packings bore 0.3 to 3 % less.\n\n\
    After Schlangen and van Mier, Cem. Concr. Compos. 14, 105 (1992).\n\n\
    **fit** varies the coefficients until the targets are reached to the part P (`tol`); K is N/m of dsm and ste. `radius` of bpm/beam is the ratio where \
    that is given; `strength` multiplies all strengths of a type. A strength is searched for once the other targets are reached, to 1e-3 of what a break \
    has changed, and only once where all strengths vary: it is proportional to them. One coefficient that all bonds are proportional to takes one solve. \
    Where there are fewer targets than coefficients the change is the smallest one, and a note names the direction left open.\n\n\
    Results are a vector, with the distance l of the ends, the section A and E = K l/A:\n\n\
    | | dsm, ste | periodic | strength |\n\
    |---|---|---|---|\n\
    | c_ID[1] | K | bulk modulus | the largest force |\n\
    | c_ID[2] | E | E, mean over the axes | the largest force over the section |\n\
    | c_ID[3] | ν | ν, mean over the axes | the strain there |\n\
    | c_ID[4] | lower bound of K (NaN where there is none) | | K of the unbroken body |\n\
    | c_ID[5] | upper bound of K (NaN where there is none) | bulk modulus of the mean field | its E |\n\
    | c_ID[6] | the force | shear modulus | its ν |\n\
    | c_ID[7] | the displacement Δ of the high end | the volume | bonds broken before the largest force |\n\
    | c_ID[8] | iterations (ste: the order) | | bonds broken in all |\n\
    | c_ID[9] | share of contacts and walls in the energy (ste: in Σ k L²) | | the energy they set free |\n\
    | c_ID[10] | particles left out | | the force at the first break |\n\n\
    Bulk and shear modulus of periodic are means of the bounds of Voigt and Reuss. fit has the results of its method, and from c_ID[11] on the \
    coefficients found, in the order of the words `vary`. periodic and ste have the tensor c_ID[i][j], too (xx yy zz yz xz xy, engineering shears). \
    `fields yes`: per particle c_ID[1] to [3] the displacement, [4] to [6] the rotation.";

/// Which calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Dsm,
    Ste,
    Periodic,
    Strength,
    Fit,
}

impl CommandStyle for Calibrate {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        if common::domain(cx)?.tilted() {
            return Err(common::orthogonal("calibrate").at(cx.span));
        }
        let name = a.peek_text();
        let (Head { id: word, group }, words) = Words::new(Calibration::form(a, cx)?, cx)?;
        let kind = match name {
            "dsm" => Kind::Dsm,
            "ste" => Kind::Ste,
            "periodic" => Kind::Periodic,
            "strength" => Kind::Strength,
            _ => Kind::Fit,
        };
        if !word.unknown && !word.text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
            let text = format!("`{}` is no ID: it may hold letters, digits and underscores", word.text);
            return fail(Code::BAD_VALUE, word.span, text);
        }
        if let Some(style) = cx.names.compute_style(&word.text).filter(|s| *s != self.name()) {
            let text = format!("there is a compute {style} of the ID `{}` already", word.text);
            let d = Diagnostic::error(Code::DUPLICATE_NAME, word.span, text);
            return Err(d.help("choose another ID: results are read as `c_ID[1]`").into());
        }
        if cx.world.bonds.coeffs.is_none() {
            let text = "there is no bond_style: bonds have no stiffness";
            let d = Diagnostic::error(Code::WRONG_ORDER, a.name_span(), text);
            return Err(d.help("put `bond_style` and `bond_coeff` before this line").into());
        }
        let fields = if words.fields { 2 } else { usize::from(words.map.is_some()) };
        let tensor = match kind {
            Kind::Dsm | Kind::Strength => false,
            Kind::Ste | Kind::Periodic => true,
            Kind::Fit => words.solver != Solver::Dsm,
        };
        if kind == Kind::Fit && (words.targets.is_empty() || words.vary.is_empty()) {
            let text = "a fit needs a `target` and something to `vary`";
            let d = Diagnostic::error(Code::INCOMPLETE, a.name_span(), text);
            return Err(d.help("as `target K 2.0e4 vary bond 1 E`").into());
        }
        let found = Found::new(&word.text, words.vary.len(), tensor, fields);
        Ok(Box::new(Line { kind, id: word.text.clone(), group, words, found }))
    }
}

/// A `calibrate` line to be executed.
struct Line {
    kind: Kind,
    id: String,
    group: GroupId,
    words: Words,
    found: Found,
}

impl Act for Line {
    fn apply(self: Box<Self>, cx: &mut ActCx) -> Result<()> {
        populated(cx.world, "calibrate", cx.span)?;
        common::settle(cx.world);
        let Some(style) = cx.values.bonds() else {
            return fail(Code::WRONG_ORDER, cx.span, "there is no bond_style");
        };
        if cx.world.adaptations() > 0.0 {
            let text = "bonds count with the coefficients of the deck's lines, not with those that fix adapt has given";
            cx.note(Diagnostic::warning(Code::NO_EFFECT, cx.span, text));
        }
        let named = matches!(self.kind, Kind::Fit | Kind::Strength);
        let scene = Scene::new(cx.world, self.group, style.as_ref(), named, cx.span)?;
        let bonds_alone =
            matches!(self.kind, Kind::Periodic | Kind::Strength) || self.words.solver == Solver::Periodic;
        let hertz = match bonds_alone {
            true => None,
            false => Hertz::new(cx, &self.words, scene.sample(0).mean_radius())?,
        };
        match self.kind {
            Kind::Dsm => dsm::run(cx, &self, &scene, hertz.as_ref()),
            Kind::Ste => ste::run(cx, &self, &scene, hertz.as_ref()),
            Kind::Periodic => cell::periodic(cx, &self, &scene),
            Kind::Strength => strength::run(cx, &self, &scene, style.as_ref()),
            Kind::Fit => fit::run(cx, &self, scene, hertz.as_ref(), style.as_ref()),
        }
    }

    fn leaves(&self) -> Option<(String, Box<dyn Compute>)> {
        Some((self.id.clone(), Box::new(self.found.clone())))
    }
}
