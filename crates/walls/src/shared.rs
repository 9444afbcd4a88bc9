//! What walls share with other fixes: directions, the ID of a region, state below a key, the need for spheres.

use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::vec3::{Vec3, dot};
use perigrain_lang::Args;
use perigrain_styles::BuildCx;
use perigrain_styles::words::{Kind, Value};
use perigrain_world::{Numbers, World};

/// Parses three numbers as a direction, normalized to length 1.
///
/// # Errors
/// Words that are not numbers, and the direction 0 0 0.
pub fn direction(args: &mut Args, _: &BuildCx) -> Result<Vec3> {
    let span = args.here();
    let unknown = args.peek().is_some_and(|w| w.unknown);
    let n = [args.number("x")?, args.number("y")?, args.number("z")?];
    let length = dot(n, n).sqrt();
    if length > 0.0 {
        return Ok(n.map(|a| a / length));
    }
    if unknown { Ok([1.0, 0.0, 0.0]) } else { fail(Code::BAD_VALUE, span, "0 0 0 is no direction") }
}

/// Deletes all state below a key.
pub fn forget(w: &mut World, key: Numbers) {
    let below = format!("{key}/");
    w.memo.retain(|name| !name.text().starts_with(&below));
}

/// Refuses particles without a radius.
///
/// # Errors
/// Another atom style.
pub fn needs_spheres(cx: &BuildCx, style: &str) -> Result<()> {
    if cx.world.particles.style.sphere {
        return Ok(());
    }
    let text = format!("fix {style} needs particles with a radius");
    let d = Diagnostic::error(Code::WRONG_ORDER, cx.span, text);
    Err(d.help("put `atom_style sphere` (or `hybrid sphere peri`) at the top of the deck").into())
}

/// The ID of a region.
#[derive(Clone)]
pub struct RegionId(pub String);

impl Value for RegionId {
    const KIND: Kind = Kind::Region;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("the region's ID")?;
        cx.region(word).map(|_| Self(word.text.clone()))
    }
}
