//! `peri_modify family broken`: members of one family that touch once their bond is broken.

use super::Solid;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_styles::BuildCx;
use perigrain_world::World;

/// Whether a particle is at the surface of its solid, and so meets others.
pub(super) fn outside(w: &World, i: usize) -> bool {
    w.groups.surfaces().iter().any(|(g, _)| w.particles.mask[i] & g.bit() != 0)
}

/// Warns where nothing depends on whether two particles are of one family.
pub(super) fn check(style: &Solid, cx: &BuildCx) {
    // A deck that is only checked has no particles to find surfaces among.
    let none = cx.world.groups.surfaces().is_empty() && !cx.checking;
    let Some((_, span)) = style.reunite.filter(|_| none) else { return };
    cx.note(
        Diagnostic::warning(
            Code::SUSPICIOUS,
            span,
            "peri_modify family concerns contacts of surfaces, and there are none",
        )
        .help("add `group ID surface GROUP`, or leave this line out"),
    );
}

/// Refuses spheres that overlap as long as their bond is whole: the contact would fling them apart when it breaks.
///
/// # Errors
/// The first such pair.
pub(super) fn check_spheres(style: &Solid, w: &World) -> Result<()> {
    let (Some((true, span)), Some(families)) = (style.reunite, &*w.families) else { return Ok(()) };
    let p = &w.particles;
    let radius = |i: usize| p.radius.get(i).copied().unwrap_or(0.0);
    for i in (0..p.len()).filter(|&i| outside(w, i)) {
        let near = families.neighbours_apart(i).into_iter();
        // Radii and lengths are both rounded from the deck's numbers: 1e-9 is no overlap.
        let deep = near.filter(|(b, _)| b.alive).find(|(b, length)| {
            let j = b.partner as usize;
            outside(w, j) && radius(i) + radius(j) > length * (1.0 + 1e-9)
        });
        let Some((b, _)) = deep else { continue };
        let (one, other) = (p.tag[i], p.tag[b.partner as usize]);
        let text = format!(
            "the spheres of particles {one} and {other} overlap while they are bonded: they would be flung apart when the bond breaks"
        );
        return Err(Diagnostic::error(Code::CONFLICT, span, text)
            .help("say `set group … peri/radius half`: spheres of neighbours then just touch")
            .help("or let broken bonds themselves push, `peri_modify broken compress yes`")
            .into());
    }
    Ok(())
}
