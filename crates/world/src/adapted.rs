//! Coefficients of pair and bond styles that `fix adapt` has changed: they differ from the values in the deck's lines.

use super::World;
use super::named::{Constant, Key, Numbers};

/// How the names of coefficients that a fix has changed begin.
const CHANGES: &str = "adapted";
/// Grows with every change, so that ops notice.
static COUNT: Constant<Vec<f64>> = Constant::new(CHANGES);

/// A coefficient of a pair of particle types, or of a bond type (twice the same).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coefficient {
    /// Of a bond style, not of a pair style.
    pub bond: bool,
    /// The style's name.
    pub style: String,
    /// The coefficient's name.
    pub name: String,
    /// The types, the smaller first.
    pub types: (u16, u16),
}

impl Coefficient {
    /// Where the value is that a fix has given to it.
    pub fn key(&self) -> Numbers {
        let (kind, (a, b)) = (if self.bond { "bond" } else { "pair" }, self.types);
        Key::new(&format!("{CHANGES}/{kind}/{}/{}/{a}/{b}", self.style, self.name))
    }
}

/// Whether something remembered is a coefficient that a fix has made, or their count.
pub fn is(name: &str) -> bool {
    name.strip_prefix(CHANGES).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

impl World {
    /// The value a fix has given to the coefficient of this key.
    pub fn adapted(&self, key: Numbers) -> Option<f64> {
        self.memo.get(key).and_then(|m| m.first().copied())
    }

    /// Gives a coefficient a value, or takes it away again: the deck's then holds.
    pub fn adapt(&mut self, key: Numbers, value: Option<f64>) {
        let next = self.adaptations() + 1.0;
        for (key, value) in [(key, value), (*COUNT, Some(next))] {
            match value {
                Some(value) => drop(self.memo.insert(key, vec![value])),
                None => drop(self.memo.remove(key)),
            }
        }
    }

    /// A number that grows with every change; 0 as long as there was none.
    pub fn adaptations(&self) -> f64 {
        self.adapted(*COUNT).unwrap_or(0.0)
    }

    /// All values that fixes have given, as they are remembered.
    pub fn adaptations_made(&self) -> Vec<(Numbers, Vec<f64>)> {
        let made = self.memo.iter().filter(|(key, _)| is(key.text()));
        made.map(|(key, value)| (key, value.clone())).collect()
    }

    /// A line of the deck has set coefficients: what fixes have made of those of these types (of all: `None`) is past.
    pub fn set_anew(&mut self, bond: bool, types: Option<&[(u16, u16)]>) {
        if self.adaptations() == 0.0 {
            return;
        }
        let begin = format!("{CHANGES}/{}/", if bond { "bond" } else { "pair" });
        let past = |key: &str| {
            key.starts_with(&begin)
                && types.is_none_or(|list| list.iter().any(|(a, b)| key.ends_with(&format!("/{a}/{b}"))))
        };
        self.memo.retain(|key| !past(key.text()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_fix_has_changed_and_a_line_sets_anew() {
        let mut w = World::default();
        let of =
            |types| Coefficient { bond: false, style: "peri/pmb".into(), name: "s00".into(), types }.key();
        assert_eq!((w.adapted(of((1, 2))), w.adaptations()), (None, 0.0));
        w.adapt(of((1, 2)), Some(3.0));
        w.adapt(of((1, 1)), Some(4.0));
        assert_eq!((w.adapted(of((1, 2))), w.adaptations()), (Some(3.0), 2.0));
        w.set_anew(true, None);
        w.set_anew(false, Some(&[(1, 2)]));
        assert_eq!((w.adapted(of((1, 2))), w.adapted(of((1, 1)))), (None, Some(4.0)));
        w.adapt(of((1, 1)), None);
        assert_eq!((w.adapted(of((1, 1))), w.adaptations()), (None, 3.0));
    }
}
