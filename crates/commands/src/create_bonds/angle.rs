//! `create_bonds single/angle`: an angle between two bonds.

use super::Id;
use crate::Act;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::Args;
use perigrain_styles::BuildCx;
use perigrain_styles::common::on_particles;
use perigrain_styles::words::{At, Words};
use perigrain_world::Angle;
use perigrain_world::index::Index;

/// The words of a line.
#[derive(Words)]
pub struct Line {
    /// The angle type.
    #[word(name = "TYPE", from = 1)]
    kind: At<i64>,
    #[word(name = "ID1 ID2 ID3")]
    ids: [At<Id>; 3],
    /// Without effect: angles do not decide which pairs count as bonded.
    #[word(keyword)]
    special: Option<bool>,
}

impl Line {
    /// The act.
    ///
    /// # Errors
    /// Particles without angles, types that there are not, particles named twice.
    pub(super) fn read(self, a: &Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let (style, types) = (cx.world.particles.style, cx.world.bonds.angles.types);
        let Self { kind: At { value: kind, span, .. }, ids, .. } = self;
        if !style.angled {
            let text = format!("particles of atom_style {} have no angles", style.name());
            let d = Diagnostic::error(Code::CONFLICT, a.name_span(), text);
            return Err(d.help("`atom_style angle`, alone or in a hybrid, has them").into());
        }
        let Some(kind) = u16::try_from(kind).ok().filter(|k| usize::from(*k) <= types) else {
            return fail(Code::BAD_VALUE, span, format!("there are angle types 1 to {types}, not {kind}"));
        };
        let (ends, at) = (ids.map(|id| id.value.0), ids[0].span);
        if ends[0] == ends[1] || ends[1] == ends[2] || ends[0] == ends[2] {
            return fail(Code::BAD_VALUE, at, "an angle needs three different particles");
        }
        Ok(made(kind, ends, at))
    }
}

/// Adds the angle.
fn made(kind: u16, ends: [u32; 3], at: Span) -> Box<dyn Act> {
    on_particles(vec![], move |cx| {
        let p = &cx.world.particles;
        let index = Index::new(&p.tag);
        if let Some(gone) = ends.iter().find(|t| index.find(**t, &p.tag).is_none()) {
            return fail(Code::UNKNOWN_NAME, at, format!("there is no particle {gone}"));
        }
        cx.world.bonds.angles.list.push(Angle { kind, ends });
        cx.world.bonds.changes += 1;
        cx.world.touch();
        Ok(())
    })
}
