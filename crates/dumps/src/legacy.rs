//! Legacy VTK files of points with data, as text.

use perigrain_base::math::cformat::general;
use perigrain_output::vtu::{Array, Values};
use std::fmt::Write;

/// Digits of doubles and of floats.
const DIGITS: [usize; 2] = [15, 7];

/// The file: points, a vertex cell for each, and their data.
pub fn text(time: f64, points: &[[f64; 3]], arrays: &[Array<'_>]) -> String {
    let n = points.len();
    let mut text = format!(
        "# vtk DataFile Version 3.0\nperigrain, time {}\nASCII\nDATASET POLYDATA\nPOINTS {n} double\n",
        general(time, DIGITS[0])
    );
    rows(&mut text, points.iter(), DIGITS[0]);
    let _ = writeln!(text, "VERTICES {n} {}", 2 * n);
    for k in 0..n {
        let _ = writeln!(text, "1 {k}");
    }
    if arrays.is_empty() {
        return text;
    }
    let _ = writeln!(text, "POINT_DATA {n}\nFIELD FieldData {}", arrays.len());
    for Array { name, values } in arrays {
        let (width, kind) = match values {
            Values::F64(_) => (1, "double"),
            Values::F32(_) => (1, "float"),
            Values::I32(_) => (1, "int"),
            Values::Vectors(_) => (3, "double"),
            Values::Vectors32(_) => (3, "float"),
        };
        // A name is one word.
        let _ = writeln!(text, "{} {width} {n} {kind}", name.replace(char::is_whitespace, "_"));
        match values {
            Values::F64(all) => rows(&mut text, all.iter().map(std::slice::from_ref), DIGITS[0]),
            Values::F32(all) => {
                for x in *all {
                    let _ = writeln!(text, "{}", general(f64::from(*x), DIGITS[1]));
                }
            }
            Values::I32(all) => {
                for k in *all {
                    let _ = writeln!(text, "{k}");
                }
            }
            Values::Vectors(all) => rows(&mut text, all.iter(), DIGITS[0]),
            Values::Vectors32(all) => rows(&mut text, all.iter(), DIGITS[1]),
        }
    }
    text
}

/// Rows of numbers.
fn rows<'n, R: AsRef<[f64]> + ?Sized + 'n>(
    text: &mut String,
    all: impl Iterator<Item = &'n R>,
    digits: usize,
) {
    for row in all {
        for (k, x) in row.as_ref().iter().enumerate() {
            if k > 0 {
                text.push(' ');
            }
            text.push_str(&general(*x, digits));
        }
        text.push('\n');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_with_numbers_and_vectors() {
        let arrays = [
            Array { name: "id", values: Values::I32(&[7, 8]) },
            Array { name: "v", values: Values::Vectors(&[[1.0, 0.5, 0.0], [0.0, 0.0, -2.0]]) },
        ];
        let text = text(0.25, &[[0.0; 3], [0.1, 0.0, 0.0]], &arrays);
        let expected = "# vtk DataFile Version 3.0\nperigrain, time 0.25\nASCII\nDATASET POLYDATA\nPOINTS 2 double\n0 0 0\n\
                        0.1 0 0\nVERTICES 2 4\n1 0\n1 1\nPOINT_DATA 2\nFIELD FieldData 2\nid 1 2 int\n7\n8\nv 3 2 double\n\
                        1 0.5 0\n0 0 -2\n";
        assert_eq!(text, expected);
    }
}
