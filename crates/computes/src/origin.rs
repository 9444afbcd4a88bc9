//! Positions of particles at the time a compute was declared: a per-particle column.

use perigrain_styles::matter::unwrapped;
use perigrain_world::{Key, Numbers, Registration, Under, Vectors, World};

/// Where the way of particles is counted from.
pub static PLACES: Registration = Registration::moved("compute ", " origin", Under::Anchor);

/// The columns of a compute.
#[derive(Clone, Copy)]
pub struct Origin {
    /// The positions.
    pub places: Vectors,
    /// Flag of particles whose position is stored.
    known: Numbers,
}

impl Origin {
    /// The columns of the compute with this ID.
    pub fn of(id: &str) -> Self {
        let own = format!("compute {id}");
        Self { places: PLACES.key(&own), known: Key::new(&format!("{own} known")) }
    }

    /// The names of the columns.
    pub fn names(self) -> [&'static str; 2] {
        [self.places.text(), self.known.text()]
    }

    /// Stores the current unwrapped position of every particle, less `shift`.
    pub fn capture(self, w: &mut World, shift: [f64; 3]) {
        self.forget(w);
        self.extend(w, shift);
    }

    /// Stores the position of every particle that has none yet.
    pub fn extend(self, w: &mut World, shift: [f64; 3]) {
        let n = w.n();
        w.columns.resize(n);
        w.columns.vector(self.places, n);
        let new: Vec<usize> = {
            let known = w.columns.scalar(self.known, n);
            let new = (0..n).filter(|&i| known[i] == 0.0).collect();
            known.fill(1.0);
            new
        };
        for i in new {
            let x = unwrapped(w, i);
            w.columns.vector(self.places, n)[i] = std::array::from_fn(|d| x[d] - shift[d]);
        }
    }

    /// Deletes the columns.
    pub fn forget(self, w: &mut World) {
        w.columns.remove(self.places);
        w.columns.remove(self.known);
    }
}
