//! `create_bonds single/angle`: an angle between two bonds.

use crate::Act;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::BuildCx;
use perigrain_styles::common::on_particles;
use perigrain_world::Angle;
use perigrain_world::index::Index;

/// Reads `TYPE ID1 ID2 ID3 [special yes|no]`; angles do not decide which pairs count as bonded, so that `special` makes no
/// difference.
///
/// # Errors
/// Every mistake in the line.
pub(super) fn parse(a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
    let (style, types, at) = (cx.world.particles.style, cx.world.bonds.angles.types, a.here());
    if !style.angled {
        let text = format!("particles of atom_style {} have no angles", style.name());
        let d = Diagnostic::error(Code::CONFLICT, a.name_span(), text);
        return Err(d.help("`atom_style angle`, alone or in a hybrid, has them").into());
    }
    let kind = a.integer_from(1, "the angle type")?;
    let Some(kind) = u16::try_from(kind).ok().filter(|k| usize::from(*k) <= types) else {
        return fail(Code::BAD_VALUE, at, format!("there are angle types 1 to {types}, not {kind}"));
    };
    let (mut ends, at) = ([0; 3], a.here());
    for id in &mut ends {
        let span = a.here();
        let k = a.integer_from(1, "an id")?;
        *id = u32::try_from(k)
            .or_else(|_| fail(Code::BAD_VALUE, span, format!("ids go from 1 to {}, not {k}", u32::MAX)))?;
    }
    if ends[0] == ends[1] || ends[1] == ends[2] || ends[0] == ends[2] {
        return fail(Code::BAD_VALUE, at, "an angle needs three different particles");
    }
    if a.eat("special") {
        a.flag("special")?;
    }
    a.finish()?;
    Ok(on_particles(vec![], move |cx| {
        let p = &cx.world.particles;
        let index = Index::new(&p.tag);
        if let Some(gone) = ends.iter().find(|t| index.find(**t, &p.tag).is_none()) {
            return fail(Code::UNKNOWN_NAME, at, format!("there is no particle {gone}"));
        }
        cx.world.bonds.angles.list.push(Angle { kind, ends });
        cx.world.bonds.changes += 1;
        cx.world.touch();
        Ok(())
    }))
}
