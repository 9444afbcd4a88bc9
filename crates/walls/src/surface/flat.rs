//! Whether a surface is one flat face (`planar`).

use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::vec3::{Vec3, cross, dot, length, scale, sub};
use perigrain_lang::Word;
use perigrain_mesh::{Triangle, area};
use perigrain_styles::common::about;

/// Refuses triangles that do not lie in one plane, to a thousandth of their extent.
///
/// # Errors
/// Triangles outside the plane of the largest one.
pub fn check(triangles: &[Triangle], file: &Word, span: Span) -> Result<()> {
    let largest = triangles.iter().max_by(|a, b| area(a).total_cmp(&area(b)));
    let Some([a, b, c]) = largest else { return Ok(()) };
    let normal = cross(sub(*b, *a), sub(*c, *a));
    let normal = scale(1.0 / length(normal), normal);
    let from = |p: &Vec3| sub(*p, *a);
    let extent = triangles.as_flattened().iter().map(|p| length(from(p))).fold(0.0, f64::max);
    let out = |t: &Triangle| t.iter().map(|p| dot(from(p), normal).abs()).fold(0.0, f64::max);
    let Some(k) = triangles.iter().position(|t| out(t) > 1e-3 * extent) else { return Ok(()) };
    let text = format!(
        "the surface `{}` is not planar: triangle {} lies {} outside the plane of the largest one",
        file.text,
        k + 1,
        about(out(&triangles[k]))
    );
    let d = Diagnostic::error(Code::BAD_VALUE, file.span, text).label(span, "it must be");
    Err(d.help("take a file with one flat face").into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_base::diag::FileId;

    #[test]
    fn a_bent_face_is_named() {
        let flat = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let bent = [[0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.1]];
        let (file, span) = (Word::new("f.stl", Span::new(FileId(0), 0, 1)), Span::new(FileId(0), 2, 3));
        assert!(check(&[flat], &file, span).is_ok());
        let text = check(&[flat, bent], &file, span).unwrap_err().to_string();
        assert!(text.contains("triangle"), "{text}");
    }
}
