//! `region … mesh`: the body within a closed surface of triangles from a file.

use super::shapes::Mesh;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::body::{apply, matrix, turn};
use perigrain_base::math::cformat::general;
use perigrain_base::math::vec3::{length, scale};
use perigrain_mesh::Solid;
use perigrain_styles::BuildCx;
use perigrain_styles::triangles;

/// Reads the body in the file of a line; the body, and lines for the log about it.
pub fn read(
    Mesh { file, placing, turn: turns, options }: &Mesh,
    cx: &BuildCx,
) -> Result<(Solid, Vec<String>)> {
    let Some(surface) = triangles::read_faces(file, cx)? else { return Ok((Solid::default(), vec![])) };
    let mut placed = surface.triangles.clone();
    placing.apply(&mut placed, options.units.scales(cx.world));
    for (x, y, z, angle) in turns {
        let (span, axis) = (x.span, [x.value, *y, *z]);
        let size = length(axis);
        if size == 0.0 {
            return fail(Code::BAD_VALUE, span, "the axis of the turn has no direction");
        }
        let m = matrix(turn(scale(1.0 / size, axis), angle.to_radians()));
        placed.as_flattened_mut().iter_mut().for_each(|p| *p = apply(&m, *p));
    }
    triangles::doubt_size(file, &placed, cx);
    let solid = Solid::new(placed).map_err(|fault| {
        let text = format!("`{}` is no surface of a body: {}", file.text, fault.text(&surface));
        Diagnostic::error(Code::BAD_VALUE, file.span, text).help(fault.help())
    })?;
    let place = |x: [f64; 3]| x.map(|x| general(x, 6)).join(" ");
    let (lo, hi) = solid.bounds().unwrap_or_default();
    let (count, kind, volume) = (solid.triangles().len(), surface.format.name(), general(solid.volume(), 8));
    let mut lines = vec![
        format!("Reading a body of {count} triangles from {kind} file {}", file.text),
        format!("  volume {volume}, from ({}) to ({})", place(lo), place(hi)),
    ];
    if solid.turned() > 0 {
        let turned = solid.turned();
        lines.push(format!("  turned {turned} of them, whose corners ran the wrong way round"));
    }
    Ok((solid, lines))
}
