//! `pair_style granular`: contacts of spheres, with models chosen per pair of types.

mod declared;
pub mod force;
pub mod heating;
mod images;
pub mod mdr;
pub mod ranks;
pub mod reach;

pub use declared::{Declared, classic};

use super::{Pair, PairStyle};
use perigrain_base::diag::Result;
use perigrain_contact::normal::{STYLES, Style as Normal};
use perigrain_lang::Args;
use perigrain_styles::words::Syntax;
use perigrain_styles::{BuildCx, Doc, Style};
use std::sync::LazyLock;

/// The style.
pub struct GranularStyle;

impl Style for GranularStyle {
    fn name(&self) -> &'static str {
        "granular"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Written(&PAGE[0]),
            summary: "Contacts of spheres: a law along the normal, damping, friction, rolling and twisting resistance.",
            text: &PAGE[1],
            example: "pair_style granular\n\
                      pair_coeff * * hertz/material 5.0e7 0.7 0.3 damping tsuji tangential mindlin NULL 1.0 0.4\n\n\
                      pair_style granular\n\
                      pair_coeff * * eepa 5.0e7 0.7 0.3 0.6 0.0 2.0 1.5 1.5 damping coeff_restitution \
                      tangential mindlin NULL 1.0 0.4",
        }
    }
}

impl PairStyle for GranularStyle {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        declared::needs_spheres(self.name(), cx)?;
        let number = args.peek_text().starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
        let cutoff = if number { Some(args.positive("the global cutoff")?) } else { None };
        Ok(Box::new(Declared::new(self.name(), cutoff)))
    }
}

const SYNTAX: &str = "pair_style granular [cutoff]\n\
    pair_coeff i j normal … tangential … [damping …] [rolling …] [twisting …] [heat …] [limit_damping] [synchronized_verlet] \
    [cutoff C] [average none|particle|body] [curvature both|impactor] [arms middle|point]\n\
    normal: {normals}\n\
    damping: none | velocity | mass_velocity | viscoelastic | tsuji | coeff_restitution | mdr 1|2\n\
    tangential: none | linear_nohistory x_gamma mu | linear_history kt x_gamma mu | \
    linear_history_classic kt x_gamma mu | mindlin_classic kt x_gamma mu | \
    mindlin[/force] kt|NULL x_gamma mu | mindlin_rescale[/force] kt|NULL x_gamma mu\n\
    rolling: none | sds k gamma mu\n\
    twisting: none | marshall | sds k gamma mu\n\
    heat: none | area h | radius k";

const TEXT: &str = "Spheres with overlap δ = R_i + R_j − r > 0 push each other along the normal with F_n − η v_n; \
    R̄ = R_i R_j/(R_i + R_j), m̄ = m_i m_j/(m_i + m_j), a = √(R̄ δ). `limit_damping` cuts this force off at \
    zero.\n\n\
    Normal: {formulas}. `eta` is a damping coefficient or a coefficient of restitution e, as `damping` says.\n\n\
    `damping`: η = eta (`velocity`), eta m̄ (`mass_velocity`), eta a m̄ (`viscoelastic`, the default), \
    √2 α_T(e) √(m̄ k) (`tsuji`; for hooke 2/√5 of it), 2β √(m̄ k) for hooke and √5 β √(m̄ k) for the others \
    (`coeff_restitution`, β = −ln e/√(π²+ln²e)); k = F_n/δ. For the last two 0 < e ≤ 1; they do not go \
    with dmt and jkr.\n\n\
    {paragraphs}\n\n\
    Which damping makes a wanted e: `coeff_restitution` does, exactly and at any velocity, `tsuji` as \
    well as its polynomial (0.2 %, 0.5 % at e = 0.1). \
    A constant `eta` does so only for hooke: 2β √(m̄ kn) as `velocity`, 2β √(kn/m̄) as `mass_velocity` \
    (and as gamma_n of pair_style gran/hooke). With hertz and a constant eta, and with `viscoelastic`, e \
    falls as grains get faster. `limit_damping` takes the pull at the end of a contact away, so that grains \
    leave faster than asked. Measured:\n\n\
    | e asked | 0.1 | 0.2 | 0.3 | 0.4 | 0.5 | 0.7 | 0.8 | 0.9 | 0.95 |\n\
    |---|---|---|---|---|---|---|---|---|---|\n\
    | coeff_restitution | 0.100 | 0.200 | 0.300 | 0.400 | 0.500 | 0.700 | 0.800 | 0.900 | 0.950 |\n\
    | the same with limit_damping | 0.253 | 0.325 | 0.397 | 0.472 | 0.550 | 0.718 | 0.808 | 0.902 | 0.951 |\n\
    | tsuji | 0.100 | 0.200 | 0.300 | 0.399 | 0.500 | 0.700 | 0.799 | 0.900 | 0.951 |\n\
    | the same with limit_damping | 0.252 | 0.325 | 0.397 | 0.472 | 0.550 | 0.718 | 0.807 | 0.902 | 0.952 |\n\
    | tsuji of LAMMPS 22Jul2025, hertz | 0.235 | 0.343 | 0.440 | 0.530 | 0.616 | 0.778 | 0.853 | 0.928 | 0.965 |\n\
    | the same with limit_damping | 0.350 | 0.429 | 0.503 | 0.574 | 0.646 | 0.788 | 0.858 | 0.929 | 0.965 |\n\n\
    `tangential`: F_t = −k_t ξ − x_gamma η v_t, at most `mu` times the force that presses, F_n − η v_n; what a dashpot pulls at the end \
    of a contact rubs nothing. For dmt and jkr the limit is mu |F_n + 2 F_pulloff| \
    with F_n before damping. Such a pull takes back some of the impulse along the normal and nothing of that across it, so that a sphere \
    that slides through all of an impact leaves with more than the mu (1 + e) v_n of textbooks: 3.3 % more at e = 0.5, where LAMMPS' tests \
    dem06-spin-wall and dem06-mindlin-spin-heavy allow 2 % (dem15-hertz-oblique, e = 0.7, is met to 0.1 %). With `limit_damping` nothing pulls, and the impulse \
    across is mu times that along the normal. ξ is the slip accumulated while the contact lasts, turned with the tangent \
    plane and shortened to what slides (Luding 2008). `linear_nohistory` has no spring; `mindlin…` take \
    k_t a for k_t, and with `NULL` k_t = 8 G*, 1/G* = (2−ν_i)/G_i + (2−ν_j)/G_j. `…/force` remembers the \
    force, dF = −k_t a v_t dt; `…_rescale` shrinks what is remembered with a when the contact unloads, so \
    that unloading makes no energy (Thornton et al. 2013). `…_classic` drops the part of ξ along the \
    normal, as pair_style gran/*. Torques act at the middle of the overlap. A point of a peridynamic solid does not turn: friction on it \
    turns the grain alone, and the pair loses the angular momentum F_t (R_j − δ/2) per time, R_j the radius of the point. Of a grain of 20 mm \
    that hits a block of points 6.2 mm wide (`peri/radius quasi`) obliquely that is a quarter of the spin it gets; it falls with the \
    spacing of the points. With `arms point` friction takes hold at the point itself, for the slip and for the torque: the grain's arm is \
    all of the distance, angular momentum is kept to rounding, and the grain rolls as one larger by R_j − δ.\n\n\
    `rolling sds`: a spring, dashpot and slider for the rolling velocity R̄ (ω_i − ω_j) × n; its force, at \
    most mu times the normal force, acts only as a torque with arm R̄. `twisting`: the same for the spin \
    about the normal; `marshall` takes k_t a²/2, x_gamma η a²/2 and 2/3 a mu of the tangential model \
    (k_t before any factor a).\n\n\
    `synchronized_verlet` (Vyas et al. 2025, doi 10.1016/j.cpc.2025.109524): slip is what the velocities of the middle of the step make across \
    the normal of that moment, and springs, those against rolling too, are turned into its plane and from there into that of the end of the step. Without the word \
    the normal is that of the end throughout, so that small grains between ones that are more than three times as large creep and stick. \
    For `tangential linear_nohistory` there is nothing to turn. LAMMPS, and perigrain under `-compat lammps`, lets all forces act along the \
    normal of the middle, which brakes grains that roll about each other though nothing rubs; by default they act along that of the end.\n\n\
    Without dashpot and slider, laws whose stiffness follows the area of contact make energy, here as in LAMMPS: `mindlin`, \
    `mindlin_classic` and `mindlin/force` where contacts unload with a spring across them, `twisting marshall` where they change \
    while the spring is wound up. `mindlin_rescale` and `twisting sds` do not ([Stability](../stability.md) has figures).\n\n\
    `heat`: between particles of temperatures T flows h π a² (T_j − T_i) (`area`) or 2 k a (T_j − T_i) \
    (`radius`), see fix heat/flow.\n\n\
    Type pairs without a line of their own mix those of the like pairs, of which the words must be the \
    same: geometric means, E* and G* as above. `cutoff` sets the reach of the neighbour list by hand.\n\n\
    Not in LAMMPS: `none` for normal, damping and tangential; `average` divides the force of each contact \
    by the number N of simultaneous ones, of the two particles (the larger number) or of the two bodies; \
    action and reaction stay equal. `curvature impactor` takes R̄ = R of the grain where it meets a \
    peridynamic solid, whose surface counts as flat (Walayat et al., table 1). `arms point`: above.\n\n\
    `-compat lammps` has LAMMPS' faults: tsuji without its √2 (until 2026; and without its 2/√5 for hooke); springs of `mindlin_classic` and \
    `linear_history_classic` that forget the contact radius when they slide (until 2026); the shear stiffness of mixed types from E* \
    in the place of both moduli; springs of `…_rescale` that shrink twice, in the setup and in the first step, where grains have \
    been moved apart between two runs; springs of `mindlin`, `…_classic` and `…_rescale` that slide in young contacts and are set \
    beyond rest by the drag, so that results depend on the step; friction up to mu |F_n| where a dashpot pulls; a sliding twist that takes the direction of the spin even where its \
    spring pushes the other way; for mdr a contact that sticks only where a step takes more than a hundredth of its radius, and \
    neither yielding nor (of new contacts) damping in the setup of a run.";

/// Syntax and text of the page, with the paragraphs of the normal models.
static PAGE: LazyLock<[String; 2]> = LazyLock::new(|| {
    let line = |style: &&Normal| {
        [style.name].into_iter().chain(style.numbers.iter().map(|n| n.word)).collect::<Vec<_>>().join(" ")
    };
    let formula = |style: &&Normal| format!("`{}` {}", style.name, style.formula);
    let normals: Vec<String> = STYLES.iter().map(line).collect();
    let formulas: Vec<String> = STYLES.iter().filter(|style| style.name != "none").map(formula).collect();
    let paragraphs: Vec<&str> =
        STYLES.iter().map(|style| style.text).filter(|text| !text.is_empty()).collect();
    let text = TEXT.replace("{formulas}", &formulas.join("; "));
    [
        SYNTAX.replace("{normals}", &normals.join(" | ")),
        text.replace("{paragraphs}", &paragraphs.join("\n\n")),
    ]
});
