//! `peri_modify`: options of peridynamic styles.

use super::{Calibrate, Solid, bond_weights};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_lang::Args;
use perigrain_peri::families::{BondWeights, Families, ForceUnit, Influence, VolumeRule};
use perigrain_styles::BuildCx;

const KNOWN: [&str; 10] = [
    "force",
    "volume",
    "influence",
    "surface",
    "horizon",
    "calibrate",
    "nofail",
    "broken",
    "repulsion",
    "family",
];

/// Reads the words of a `peri_modify`.
///
/// # Errors
/// Every mistake in the line.
pub fn read(style: &mut Solid, command: &str, args: &mut Args, cx: &BuildCx) -> Result<()> {
    if command != "peri_modify" {
        return fail(
            Code::CONFLICT,
            cx.span,
            format!("`{command}` does not concern pair_style {}", style.name),
        );
    }
    if args.is_empty() {
        let text = format!("peri_modify needs an option: {}", KNOWN.join(", "));
        return fail(Code::MISSING_ARGUMENT, args.here(), text);
    }
    while let Some(word) = args.next() {
        match word.text.as_str() {
            "force" => {
                style.unit = Some(match args.choice("unit of forces", &["density", "newton"])? {
                    "newton" => ForceUnit::Newton,
                    _ => ForceUnit::Density,
                });
            }
            "volume" => {
                style.volume = match args.choice("volume rule", &["lammps", "none", "full"])? {
                    "none" => VolumeRule::None,
                    "full" => VolumeRule::Full,
                    _ => VolumeRule::Lammps,
                };
            }
            "influence" => {
                let name = args.choice("influence function", &Influence::NAMES.map(|n| n.0))?;
                let found = Influence::NAMES.iter().find(|n| n.0 == name);
                style.law.influence = found.map_or_else(Influence::default, |n| n.1);
                settled(style, &word.text, word.span, cx)?;
            }
            "surface" => {
                let how = args.choice("correction of surfaces", &["no", "energy", "tensor"])?;
                if !style.law.kind.bond_based && how == "energy" {
                    let text = "peri_modify surface energy concerns peri/pmb: a state-based particle weighs its own family (`surface tensor` corrects it, too)";
                    return fail(Code::CONFLICT, word.span, text);
                }
                // Bonds that remember have no columns of sites: each is weighed by itself.
                let remember = style.law.kind.edge.is_some();
                style.law.surface = how == "energy" && !remember;
                style.weights.whole_energies = how == "energy" && remember;
                style.weights.whole_families = how == "tensor";
                settled(style, &word.text, word.span, cx)?;
            }
            "horizon" => {
                style.weights.own_horizons =
                    args.choice("spacing that horizons count in", &["lattice", "own"])? == "own";
                bond_weights::needs_materials(style, word.span)?;
                settled(style, &word.text, word.span, cx)?;
            }
            "broken" => {
                args.choice("what broken bonds do", &["compress"])?;
                style.compress = args.flag("broken compress")?;
            }
            "calibrate" => {
                let how = args.choice("what to calibrate", &["no", "bulk", "young"])?;
                if !style.law.kind.bond_based && how != "no" {
                    let text = "peri_modify calibrate concerns bond-based styles: a state-based solid has its bulk modulus on any lattice";
                    return fail(Code::CONFLICT, word.span, text);
                }
                style.calibrate = match how {
                    "bulk" => Calibrate::Bulk,
                    "young" => Calibrate::Young,
                    _ => Calibrate::No,
                };
            }
            "repulsion" => style.no_repulsion = !args.flag("repulsion")?,
            "nofail" => {
                args.choice("what lasts", &["region"])?;
                style.lasting.push(cx.region(args.expect("a region")?)?.clone());
            }
            "family" => {
                let how = args.choice("rule of contacts in a family", &["exclude", "broken"])?;
                style.reunite = Some((how == "broken", word.span));
            }
            _ => return Err(args.unknown(word, &KNOWN)),
        }
    }
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
