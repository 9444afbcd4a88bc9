//! Lattice bases: the lattice spanned by vectors, its shortest basis, and bases with a given first vector.

use super::vec3::{Vec3, cross, dot, length, scale, sub};

/// Three vectors; a point of their lattice is n₀ a + n₁ b + n₂ c.
pub type Basis = [Vec3; 3];

/// The point with these coordinates.
pub fn point(basis: &Basis, n: [i32; 3]) -> Vec3 {
    let mut x = [0.0; 3];
    for (n, a) in n.into_iter().zip(basis) {
        (0..3).for_each(|k| x[k] += f64::from(n) * a[k]);
    }
    x
}

/// The vectors whose dot products with a point are its coordinates; `None` for a degenerate basis.
pub fn reciprocal(basis: &Basis) -> Option<Basis> {
    let [a, b, c] = *basis;
    let volume = dot(a, cross(b, c));
    // Orthogonal vectors have a volume of 1 here; rounding leaves about 1e-16 for degenerate ones.
    let flat = 1e-14 * length(a) * length(b) * length(c);
    (volume.abs() > flat).then(|| [cross(b, c), cross(c, a), cross(a, b)].map(|v| scale(1.0 / volume, v)))
}

/// Real-valued coordinates of a point.
pub fn coordinates(reciprocal: &Basis, x: Vec3) -> Vec3 {
    reciprocal.map(|r| dot(r, x))
}

/// a − n b with the n that gives the shortest vector.
fn shortened(a: Vec3, b: Vec3) -> Vec3 {
    sub(a, scale((dot(a, b) / dot(b, b)).round(), b))
}

/// Reduces a basis to short vectors, the shortest first.
pub fn reduce(basis: &mut [Vec3]) {
    let by_length = |a: &Vec3, b: &Vec3| dot(*a, *a).total_cmp(&dot(*b, *b));
    // Each iteration makes one vector shorter by more than rounding, or is the last.
    for _ in 0..100 {
        basis.sort_by(by_length);
        let mut shorter = false;
        for k in (1..basis.len()).rev() {
            let (rest, own) = basis.split_at_mut(k);
            let own = &mut own[0];
            let mut best = rest.iter().fold(*own, |v, b| shortened(v, *b));
            if let [a, b] = rest {
                // Rounded coordinates may miss the nearest point of a plane by one.
                for (m, n) in [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (-1.0, -1.0), (1.0, 1.0)] {
                    let other = sub(sub(best, scale(m, *a)), scale(n, *b));
                    best = if dot(other, other) < dot(best, best) { other } else { best };
                }
            }
            if dot(best, best) < (1.0 - 1e-9) * dot(*own, *own) {
                (*own, shorter) = (best, true);
            }
        }
        if !shorter {
            return;
        }
    }
}

/// The lattice spanned by vectors that are known up to an error.
#[derive(Clone, Debug)]
pub struct Span {
    basis: Vec<Vec3>,
    /// Shorter vectors count as zero.
    error: f64,
    /// Lattices with shorter vectors are rejected.
    shortest: f64,
}

impl Span {
    /// Without vectors.
    pub fn new(error: f64, shortest: f64) -> Self {
        Self { basis: vec![], error, shortest }
    }

    /// The number of independent vectors.
    pub fn rank(&self) -> usize {
        self.basis.len()
    }

    /// Its shortest basis; missing vectors are replaced by perpendicular ones.
    pub fn basis(&self) -> Option<Basis> {
        let &first = self.basis.first()?;
        let size = length(first);
        let second = self.basis.get(1).copied().unwrap_or_else(|| {
            let flattest = (0..3).min_by(|&j, &k| first[j].abs().total_cmp(&first[k].abs())).unwrap_or(0);
            let mut axis = [0.0; 3];
            axis[flattest] = 1.0;
            let across = cross(first, axis);
            scale(size / length(across), across)
        });
        let third = self.basis.get(2).copied().unwrap_or_else(|| {
            let across = cross(first, second);
            scale(size / length(across), across)
        });
        Some([first, second, third])
    }

    /// Adds a vector, by Euclid's algorithm; returns `false` if there is no lattice.
    #[must_use]
    pub fn add(&mut self, vector: Vec3) -> bool {
        let mut vector = vector;
        // The volume of the cell is at least halved each time.
        for _ in 0..32 {
            let rank = self.rank();
            let Some(basis) = self.basis() else {
                self.basis.push(vector);
                return true;
            };
            let Some(reciprocal) = reciprocal(&basis) else { return false };
            let at = coordinates(&reciprocal, vector);
            let across = (rank..3).map(|k| scale(at[k], basis[k])).fold([0.0; 3], sub);
            if length(across) > self.error {
                self.basis.push(vector);
                reduce(&mut self.basis);
                return length(self.basis[0]) >= self.shortest;
            }
            let part: Vec<f64> = (0..rank).map(|k| at[k] - at[k].round()).collect();
            let rest = (0..rank).fold([0.0; 3], |sum, k| sub(sum, scale(-part[k], basis[k])));
            if length(rest) <= self.error {
                return true;
            }
            if length(rest) < self.shortest {
                return false;
            }
            let most = (0..rank).max_by(|&j, &k| part[j].abs().total_cmp(&part[k].abs())).unwrap_or(0);
            vector = std::mem::replace(&mut self.basis[most], rest);
            reduce(&mut self.basis);
        }
        false
    }
}

/// Determinant of three rows.
fn determinant(m: &[[i32; 3]; 3]) -> i32 {
    let minor = |a: usize, b: usize| m[1][a] * m[2][b] - m[1][b] * m[2][a];
    m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1)
}

/// A change of basis within a lattice; the new vectors have the coordinates `rows`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// Coordinates of the new vectors.
    pub rows: [[i32; 3]; 3],
    back: [[i32; 3]; 3],
}

impl Turn {
    /// `None` unless the rows span the whole lattice.
    pub fn new(rows: [[i32; 3]; 3]) -> Option<Self> {
        let volume = determinant(&rows);
        if volume.abs() != 1 {
            return None;
        }
        let mut back = [[0; 3]; 3];
        for (j, row) in back.iter_mut().enumerate() {
            for (k, out) in row.iter_mut().enumerate() {
                let (a, b, c, d) = ((k + 1) % 3, (k + 2) % 3, (j + 1) % 3, (j + 2) % 3);
                *out = volume * (rows[a][c] * rows[b][d] - rows[a][d] * rows[b][c]);
            }
        }
        Some(Self { rows, back })
    }

    /// The new coordinates of a point.
    pub fn of(&self, at: [i32; 3]) -> [i32; 3] {
        [0, 1, 2].map(|k| (0..3).map(|j| at[j] * self.back[j][k]).sum())
    }

    /// The new vectors.
    pub fn basis(&self, old: &Basis) -> Basis {
        self.rows.map(|n| point(old, n))
    }

    /// With the last two vectors exchanged.
    #[must_use]
    pub fn exchanged(self) -> Self {
        let [a, b, c] = self.rows;
        Self { rows: [a, c, b], back: self.back.map(|[x, y, z]| [x, z, y]) }
    }
}

/// A basis with `first` as its first vector; the others lead to the nearest parallel lines with the smallest
/// component along it. `None` if `first` is a multiple of another point, or too long.
pub fn beside(basis: &Basis, first: [i32; 3]) -> Option<Turn> {
    let unit = |k: usize| [0, 1, 2].map(|j| i32::from(j == k));
    let square = |j: usize, k: usize| dot(basis[j], basis[k]).abs() < 1e-9 * dot(basis[k], basis[k]);
    if let Some(k) = (0..3).find(|&k| unit(k) == first)
        && square(0, 1)
        && square(1, 2)
        && square(2, 0)
    {
        return Turn::new([first, unit((k + 1) % 3), unit((k + 2) % 3)]);
    }
    let along = point(basis, first);
    let mut others: Vec<(f64, f64, [i32; 3])> = vec![];
    for n in (0..125).map(|k| [k % 5 - 2, k / 5 % 5 - 2, k / 25 - 2]) {
        let v = point(basis, n);
        let share = dot(v, along) / dot(along, along);
        let across = sub(v, scale(share, along));
        others.push((dot(across, across), share.abs(), n));
    }
    // Lengths equal up to rounding count as equal: then the smaller component along it decides, then the
    // positive direction.
    let size = dot(along, along);
    let key = |v: &(f64, f64, [i32; 3])| ((v.0 / size * 1e6).round(), (v.1 * 1e6).round());
    others.sort_by(|a, b| {
        let (p, q) = (key(a), key(b));
        p.0.total_cmp(&q.0).then(p.1.total_cmp(&q.1)).then(b.2.cmp(&a.2))
    });
    let apart = |n: &[i32; 3]| {
        let c = [1, 2, 0].map(|k: usize| first[k] * n[(k + 1) % 3] - first[(k + 1) % 3] * n[k]);
        c != [0; 3]
    };
    let second = others.iter().map(|v| v.2).find(apart)?;
    others.iter().find_map(|v| Turn::new([first, second, v.2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(b: &Basis) -> f64 {
        dot(b[0], cross(b[1], b[2])).abs()
    }

    #[test]
    fn vectors_span_their_lattice() {
        let bcc = [[-0.5, 0.5, 0.5], [0.5, -0.5, 0.5], [0.5, 0.5, 0.5], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mut span = Span::new(1e-3, 0.3);
        assert!(bcc.iter().all(|v| span.add(*v)));
        let basis = span.basis().unwrap();
        assert!((volume(&basis) - 0.5).abs() < 1e-12 && (length(basis[2]) - 0.75f64.sqrt()).abs() < 1e-12);
        // Neighbours in hexagonal close packing, c = 1.6: every third row of the lattice they span is
        // occupied.
        let (h, c) = (3f64.sqrt() / 2.0, 0.8);
        let hcp = [
            [1.0, 0.0, 0.0],
            [0.5, h, 0.0],
            [0.0, 2.0 * h / 3.0, c],
            [0.5, -h / 3.0, c],
            [0.5, -h / 3.0, -c],
        ];
        let mut span = Span::new(1e-3, 0.3);
        assert!(hcp.iter().all(|v| span.add(*v)));
        assert!((volume(&span.basis().unwrap()) - h * c / 3.0).abs() < 1e-12);
        // No lattice.
        let mut span = Span::new(1e-3, 0.3);
        assert!(![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.61, 0.17, 0.0]].iter().all(|v| span.add(*v)));
        // A plane, a line.
        let mut span = Span::new(1e-3, 0.3);
        assert!(
            span.add([0.0, 0.0, 2.0]) && span.rank() == 1 && span.add([0.0, 1.0, 1.0]) && span.rank() == 2
        );
        assert!(span.add([0.0, 3.0, -3.0]) && span.rank() == 2);
        assert!(volume(&span.basis().unwrap()) > 1.0);
    }

    #[test]
    fn bases_turn_into_each_other() {
        let fcc = [[0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
        // (1, 0, 0) = a + b − c.
        let turn = beside(&fcc, [1, 1, -1]).unwrap();
        let new = turn.basis(&fcc);
        assert_eq!(new[0], [1.0, 0.0, 0.0]);
        assert!((volume(&new) - 0.25).abs() < 1e-15);
        for at in [[3, -2, 5], [0, 1, 0], [-7, 4, 4]] {
            let (p, q) = (point(&fcc, at), point(&new, turn.of(at)));
            assert!((0..3).all(|k| (p[k] - q[k]).abs() < 1e-12));
            let other = turn.exchanged();
            let q = point(&other.basis(&fcc), other.of(at));
            assert!((0..3).all(|k| (p[k] - q[k]).abs() < 1e-12));
        }
        assert!(beside(&fcc, [2, 0, 0]).is_none());
        // A square lattice keeps its axes.
        let cubic = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
        assert_eq!(beside(&cubic, [0, 1, 0]).unwrap().rows, [[0, 1, 0], [0, 0, 1], [1, 0, 0]]);
        let r = reciprocal(&fcc).unwrap();
        let at = coordinates(&r, [1.5, 1.0, -0.5]);
        assert!(
            (0..3)
                .all(|k| (point(&fcc, at.map(|n| n.round() as i32))[k] - [1.5, 1.0, -0.5][k]).abs() < 1e-12)
        );
    }
}
