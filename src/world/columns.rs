//! Named per-particle columns beyond the core ones: they follow every reordering and deletion.

/// Named scalar and vector columns, kept in step with the particles.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    scalars: Vec<(String, Vec<f64>)>,
    vectors: Vec<(String, Vec<[f64; 3]>)>,
}

impl Columns {
    /// The scalar column of this name, made of zeros for `n` particles if it is new.
    pub fn scalar(&mut self, name: &str, n: usize) -> &mut Vec<f64> {
        let k = match self.scalars.iter().position(|(s, _)| s == name) {
            Some(k) => k,
            None => {
                self.scalars.push((name.to_string(), vec![0.0; n]));
                self.scalars.len() - 1
            }
        };
        &mut self.scalars[k].1
    }

    /// The vector column of this name, made of zeros for `n` particles if it is new.
    pub fn vector(&mut self, name: &str, n: usize) -> &mut Vec<[f64; 3]> {
        let k = match self.vectors.iter().position(|(s, _)| s == name) {
            Some(k) => k,
            None => {
                self.vectors.push((name.to_string(), vec![[0.0; 3]; n]));
                self.vectors.len() - 1
            }
        };
        &mut self.vectors[k].1
    }

    /// The vector column of this name, if there is one.
    pub fn get_vector(&self, name: &str) -> Option<&[[f64; 3]]> {
        self.vectors.iter().find(|(s, _)| s == name).map(|(_, v)| v.as_slice())
    }

    /// The scalar column of this name, if there is one.
    pub fn get_scalar(&self, name: &str) -> Option<&[f64]> {
        self.scalars.iter().find(|(s, _)| s == name).map(|(_, v)| v.as_slice())
    }

    /// Forgets a column of either kind.
    pub fn remove(&mut self, name: &str) {
        self.scalars.retain(|(s, _)| s != name);
        self.vectors.retain(|(s, _)| s != name);
    }

    /// Gives every column room for `n` particles, zeros for new ones.
    pub fn resize(&mut self, n: usize) {
        for (_, c) in &mut self.scalars {
            c.resize(n, 0.0);
        }
        for (_, c) in &mut self.vectors {
            c.resize(n, [0.0; 3]);
        }
    }

    /// Keeps `old[new_index]` at each new index.
    pub fn gather(&mut self, old: &[usize]) {
        for (_, c) in &mut self.scalars {
            *c = old.iter().map(|&k| c[k]).collect();
        }
        for (_, c) in &mut self.vectors {
            *c = old.iter().map(|&k| c[k]).collect();
        }
    }
}
