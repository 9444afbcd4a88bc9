//! What a deck says of a normal model: a word with its numbers, and how those of two types mix.

use super::{Force, STYLES};

/// The most numbers behind a word.
pub const MOST: usize = 8;

/// The numbers behind a word; the rest are zeros.
pub type Numbers = [f64; MOST];

/// What may stand for a number.
#[derive(Clone, Copy, Debug)]
pub enum Bound {
    /// Greater than zero.
    Positive,
    /// Not below zero.
    NonNegative,
    /// Where `ok` says so.
    Where {
        /// Whether a number is good.
        ok: fn(f64) -> bool,
        /// What to say of one that is not, which stands for `{}`.
        wrong: &'static str,
        /// What to write instead, or why.
        help: Option<&'static str>,
    },
}

/// What a number is to the rest of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Young's modulus [pressure].
    Young,
    /// Poisson's ratio.
    Poisson,
    /// Damping coefficient or, for damping models that ask for it, coefficient of restitution.
    Eta,
    /// The law's own; of two types the geometric mean.
    Own,
    /// The law's own, the same for types that are mixed.
    Same,
}

/// One number behind a word.
#[derive(Clone, Copy, Debug)]
pub struct Number {
    /// How the help page's line calls it.
    pub word: &'static str,
    /// How messages call it.
    pub name: &'static str,
    /// What may stand for it.
    pub bound: Bound,
    /// What it is to the rest.
    pub role: Role,
}

impl Number {
    /// Young's modulus.
    pub const YOUNG: Number =
        Number { word: "E", name: "Young's modulus E", bound: Bound::Positive, role: Role::Young };
    /// The damping coefficient or restitution.
    pub const ETA: Number = Number::own("eta", "the damping eta", Role::Eta);
    /// Poisson's ratio.
    pub const POISSON: Number = Number {
        word: "nu",
        name: "Poisson's ratio nu",
        bound: Bound::Where {
            ok: |nu| (-1.0..=0.5).contains(&nu),
            wrong: "Poisson's ratio lies between -1 and 0.5, {} does not",
            help: None,
        },
        role: Role::Poisson,
    };
    /// Surface energy γ [energy/area].
    pub const GAMMA: Number = Number::own("gamma", "the surface energy gamma", Role::Own);

    /// A number that is not negative.
    pub const fn own(word: &'static str, name: &'static str, role: Role) -> Self {
        Number { word, name, bound: Bound::NonNegative, role }
    }
}

/// The numbers of a pair of types: √(a b) of each, and E* of the materials.
#[derive(Clone, Copy, Debug)]
pub struct Mixed {
    /// In the order of [`Style::numbers`].
    pub numbers: Numbers,
    /// E* [pressure]; NaN of models without a material.
    pub young: f64,
}

/// A normal model as decks name it.
#[derive(Debug)]
pub struct Style {
    /// The word decks use.
    pub name: &'static str,
    /// The numbers behind it.
    pub numbers: &'static [Number],
    /// Its formula, for the list on the help page.
    pub formula: &'static str,
    /// A paragraph of its own on the help page; may be empty.
    pub text: &'static str,
    /// n of a force that grows as δⁿ.
    pub exponent: fn(&Numbers) -> f64,
    /// Whether the force can pull: then it is not cut off at zero.
    pub pulls: fn(&Numbers) -> bool,
    /// Whether damping may be made from a coefficient of restitution.
    pub restitution: bool,
    /// Whether the grains themselves remember: then all of them have the same numbers.
    pub in_grains: bool,
    /// The law of two types.
    pub force: fn(&Mixed) -> Force,
}

impl Style {
    /// What most laws have: a force that grows as δ^(3/2) and only pushes.
    pub const PUSHES: Style = Style {
        name: "",
        numbers: &[],
        formula: "",
        text: "",
        exponent: |_| 1.5,
        pulls: |_| false,
        restitution: true,
        in_grains: false,
        force: |_| Force::Nothing(super::nothing::Nothing),
    };
}

/// A normal model with the coefficients a deck gives it.
#[derive(Clone, Copy)]
pub struct Normal {
    style: &'static Style,
    numbers: Numbers,
}

impl PartialEq for Normal {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name() && self.numbers == other.numbers
    }
}

impl std::fmt::Debug for Normal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {:?}", self.name(), &self.numbers[..self.style.numbers.len()])
    }
}

impl Normal {
    /// A model of the table with the first of its numbers.
    pub fn new(style: &'static Style, numbers: &[f64]) -> Self {
        let mut all = [0.0; MOST];
        all.iter_mut().zip(numbers).for_each(|(to, from)| *to = *from);
        Self { style, numbers: all }
    }

    /// The model that decks name so.
    pub fn style(name: &str) -> Option<&'static Style> {
        STYLES.iter().copied().find(|style| style.name == name)
    }

    /// The word decks use.
    pub fn name(&self) -> &'static str {
        self.style.name
    }

    /// The numbers behind it.
    pub fn numbers(&self) -> &Numbers {
        &self.numbers
    }

    fn in_role(&self, role: Role) -> Option<f64> {
        let at = self.style.numbers.iter().position(|number| number.role == role)?;
        Some(self.numbers[at])
    }

    /// Damping coefficient or restitution; 0 of models without one.
    pub fn eta(&self) -> f64 {
        self.in_role(Role::Eta).unwrap_or(0.0)
    }

    /// Young's modulus and Poisson's ratio, where the model has them.
    pub fn material(&self) -> Option<(f64, f64)> {
        self.in_role(Role::Young).zip(self.in_role(Role::Poisson))
    }

    /// The same model of another material; `None` where it has none, or where all grains are of one.
    #[must_use]
    pub fn with_material(&self, young: f64, poisson: f64) -> Option<Self> {
        self.material().filter(|_| !self.style.in_grains)?;
        let mut other = *self;
        for (to, number) in other.numbers.iter_mut().zip(self.style.numbers) {
            match number.role {
                Role::Young => *to = young,
                Role::Poisson => *to = poisson,
                _ => {}
            }
        }
        Some(other)
    }

    /// Whether the force can pull.
    pub fn pulls(&self) -> bool {
        (self.style.pulls)(&self.numbers)
    }

    /// Whether damping may be made from a coefficient of restitution.
    pub fn takes_restitution(&self) -> bool {
        self.style.restitution
    }

    /// Whether the grains themselves remember, not the contacts.
    pub fn in_grains(&self) -> bool {
        self.style.in_grains
    }

    /// n of a force that grows as δⁿ.
    pub fn exponent(&self) -> f64 {
        (self.style.exponent)(&self.numbers)
    }

    /// The number that both must have alike to be mixed, and have not: how decks call it.
    pub fn unlike(&self, other: &Normal) -> Option<&'static str> {
        let numbers = self.numbers.iter().zip(&other.numbers).zip(self.style.numbers);
        let unlike = |((a, b), number): &((&f64, &f64), &Number)| number.role == Role::Same && a != b;
        numbers.into_iter().find(unlike).map(|(_, number)| number.name)
    }

    /// The law between two grains with these models of one kind: numbers mix geometrically, materials as E*.
    pub fn force(&self, other: &Normal) -> Force {
        let mut numbers = self.numbers;
        numbers.iter_mut().zip(&other.numbers).for_each(|(a, b)| *a = geometric(*a, *b));
        let young = match (self.material(), other.material()) {
            (Some((e1, nu1)), Some((e2, nu2))) => effective_young([e1, e2], [nu1, nu2]),
            _ => f64::NAN,
        };
        (self.style.force)(&Mixed { numbers, young })
    }
}

/// The geometric mean √(a b); a itself when both are the same number.
pub fn geometric(a: f64, b: f64) -> f64 {
    if a == b { a } else { (a * b).sqrt() }
}

/// E* = 1 / ((1 − ν_i²)/E_i + (1 − ν_j²)/E_j).
pub fn effective_young(e: [f64; 2], nu: [f64; 2]) -> f64 {
    1.0 / ((1.0 - nu[0] * nu[0]) / e[0] + (1.0 - nu[1] * nu[1]) / e[1])
}

/// G* = 1 / ((2 − ν_i)/G_i + (2 − ν_j)/G_j) with G = E / (2 (1 + ν)).
pub fn effective_shear(e: [f64; 2], nu: [f64; 2]) -> f64 {
    let part = |k: usize| 2.0 * (2.0 - nu[k]) * (1.0 + nu[k]) / e[k];
    1.0 / (part(0) + part(1))
}
