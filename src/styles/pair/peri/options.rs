//! `peri_modify`: options of peridynamic styles.

use super::{Calibrate, Solid};
use crate::diag::{Code, Result, fail};
use crate::lang::Args;
use crate::styles::BuildCx;
use crate::world::families::{ForceUnit, Influence, VolumeRule};

const KNOWN: [&str; 6] = ["force", "volume", "influence", "calibrate", "nofail", "repulsion"];

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
                if style.law.kind.bond_based() {
                    let text =
                        "peri_modify influence concerns state-based styles: peri/lps, peri/ves, peri/eps";
                    return fail(Code::CONFLICT, word.span, text);
                }
                let name = args.choice("influence function", &Influence::NAMES.map(|n| n.0))?;
                let found = Influence::NAMES.iter().find(|n| n.0 == name);
                style.law.influence = found.map_or_else(Influence::default, |n| n.1);
            }
            "calibrate" => {
                let how = args.choice("what to calibrate", &["no", "bulk", "young"])?;
                if !style.law.kind.bond_based() && how != "no" {
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
            "broken" | "family" => {
                return fail(
                    Code::NOT_SUPPORTED,
                    word.span,
                    format!("peri_modify {} is not there yet", word.text),
                );
            }
            _ => return Err(args.unknown(word, &KNOWN)),
        }
    }
    Ok(())
}
