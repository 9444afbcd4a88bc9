//! Cracks that a deck cuts explicitly.

use crate::Region;
use perigrain_base::diag::{Code, Diagnostic};
use perigrain_mesh::Sheet;

/// Where bonds are cut.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Crack {
    /// A point of a plane and its normal; bonds that cross the plane are cut, inside `region` if there is one.
    pub plane: Option<([f64; 3], [f64; 3])>,
    /// Without a plane: bonds that pass through the region are cut.
    pub region: Option<Region>,
    /// A surface of triangles: bonds that cross it are cut.
    pub sheet: Option<Sheet>,
    /// The line that made it.
    pub line: String,
}

/// Points of a bond that are looked at in a region, ends included.
const POINTS: usize = 33;

impl Crack {
    /// The warning about a crack that meets no bond.
    pub fn missed(&self) -> Diagnostic {
        let text = format!("`{}` meets no living bond", self.line);
        Diagnostic::error(Code::BAD_VALUE, None, text)
            .help("compare the plane, region or surface with where the particles are: `units box` takes the numbers as they stand")
    }

    /// Whether a bond between two places is cut.
    pub fn cuts(&self, a: [f64; 3], b: [f64; 3]) -> bool {
        if let Some(sheet) = &self.sheet {
            return sheet.cuts(a, b);
        }
        let between = |t: f64| [0, 1, 2].map(|k| a[k] + t * (b[k] - a[k]));
        let holds = |x: [f64; 3]| self.region.as_ref().is_none_or(|r| r.contains(x));
        let Some((point, normal)) = self.plane else {
            return (0..POINTS).any(|k| holds(between(k as f64 / (POINTS - 1) as f64)));
        };
        let side = |x: [f64; 3]| (0..3).map(|k| (x[k] - point[k]) * normal[k]).sum::<f64>();
        let (near, far) = (side(a), side(b));
        (near < 0.0) != (far < 0.0) && holds(between(near / (near - far)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region::Shape;

    #[test]
    fn planes_and_regions() {
        let plane = Some(([0.5, 0.0, 0.0], [1.0, 0.0, 0.0]));
        let whole = Crack { plane, region: None, sheet: None, line: String::new() };
        let (a, b) = ([0.0, 0.0, 0.0], [1.0, 1.0, 0.0]);
        assert!(whole.cuts(a, b) && whole.cuts(b, a) && !whole.cuts(a, [0.4, 5.0, 0.0]));
        let (lo, hi) = ([-9.0, 0.6, -9.0], [9.0, 9.0, 9.0]);
        let above = Some(Region::inside(Shape::Block { lo, hi }));
        let part = Crack { plane, region: above.clone(), sheet: None, line: String::new() };
        // The bond crosses at y = 0.5.
        assert!(!part.cuts(a, b) && part.cuts([0.0, 0.5, 0.0], b));
        let through = Crack { plane: None, region: above, sheet: None, line: String::new() };
        assert!(through.cuts(a, b) && !through.cuts(a, [1.0, 0.5, 0.0]));
    }
}
