//! A normal model in a deck: a word with its parameters, and mixing of two types.

use super::{Force, STYLES};

/// The largest number of parameters.
pub const MOST: usize = 8;

/// The parameters of a word, padded with zeros.
pub type Numbers = [f64; MOST];

/// The allowed values of a parameter.
#[derive(Clone, Copy, Debug)]
pub enum Bound {
    /// Greater than zero.
    Positive,
    /// Not below zero.
    NonNegative,
    /// As `ok` decides.
    Where {
        /// Whether a value is allowed.
        ok: fn(f64) -> bool,
        /// Message for a refused value, which replaces `{}`.
        wrong: &'static str,
        /// What to write instead, or the reason.
        help: Option<&'static str>,
    },
}

/// Role of a parameter in the rest of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Young's modulus [pressure].
    Young,
    /// Poisson's ratio.
    Poisson,
    /// Damping coefficient or, for damping models that use it, coefficient of restitution.
    Eta,
    /// A parameter of the law; for two types the geometric mean.
    Own,
    /// A parameter of the law that must be equal for types that are mixed.
    Same,
}

/// One parameter.
#[derive(Clone, Copy, Debug)]
pub struct Number {
    /// Its name in the syntax line.
    pub word: &'static str,
    /// Its name in messages.
    pub name: &'static str,
    /// Allowed values.
    pub bound: Bound,
    /// Role in the model.
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

    /// A non-negative parameter.
    pub const fn own(word: &'static str, name: &'static str, role: Role) -> Self {
        Number { word, name, bound: Bound::NonNegative, role }
    }
}

/// The parameters of a pair of types: √(a b) of each, and E* of the materials.
#[derive(Clone, Copy, Debug)]
pub struct Mixed {
    /// In the order of [`Style::numbers`].
    pub numbers: Numbers,
    /// E* [pressure]; NaN for models without a material.
    pub young: f64,
}

/// A normal model.
#[derive(Debug)]
pub struct Style {
    /// The word in decks.
    pub name: &'static str,
    /// Its parameters.
    pub numbers: &'static [Number],
    /// Its formula, for the help page.
    pub formula: &'static str,
    /// An extra paragraph on the help page; may be empty.
    pub text: &'static str,
    /// n for a force that grows like δⁿ.
    pub exponent: fn(&Numbers) -> f64,
    /// Whether the force can be attractive: then it is not cut off at zero.
    pub pulls: fn(&Numbers) -> bool,
    /// Whether damping may be derived from a coefficient of restitution.
    pub restitution: bool,
    /// Whether the state belongs to the grains: then all of them must have the same parameters.
    pub in_grains: bool,
    /// The law of two types.
    pub force: fn(&Mixed) -> Force,
}

impl Style {
    /// Defaults for most laws: a repulsive force that grows like δ^(3/2).
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

/// A normal model with its parameters from a deck.
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
    /// A model of the table with the first of its parameters.
    pub fn new(style: &'static Style, numbers: &[f64]) -> Self {
        let mut all = [0.0; MOST];
        all.iter_mut().zip(numbers).for_each(|(to, from)| *to = *from);
        Self { style, numbers: all }
    }

    /// The model of this name.
    pub fn style(name: &str) -> Option<&'static Style> {
        STYLES.iter().copied().find(|style| style.name == name)
    }

    /// The word in decks.
    pub fn name(&self) -> &'static str {
        self.style.name
    }

    /// The parameters.
    pub fn numbers(&self) -> &Numbers {
        &self.numbers
    }

    fn in_role(&self, role: Role) -> Option<f64> {
        let at = self.style.numbers.iter().position(|number| number.role == role)?;
        Some(self.numbers[at])
    }

    /// Damping coefficient or restitution; 0 for models without one.
    pub fn eta(&self) -> f64 {
        self.in_role(Role::Eta).unwrap_or(0.0)
    }

    /// Young's modulus and Poisson's ratio, if the model has them.
    pub fn material(&self) -> Option<(f64, f64)> {
        self.in_role(Role::Young).zip(self.in_role(Role::Poisson))
    }

    /// The same model with another material; `None` if it has none, or if all grains must share one.
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

    /// Whether the force can be attractive.
    pub fn pulls(&self) -> bool {
        (self.style.pulls)(&self.numbers)
    }

    /// Whether damping may be derived from a coefficient of restitution.
    pub fn takes_restitution(&self) -> bool {
        self.style.restitution
    }

    /// Whether the state belongs to the grains instead of the contacts.
    pub fn in_grains(&self) -> bool {
        self.style.in_grains
    }

    /// n for a force that grows like δⁿ.
    pub fn exponent(&self) -> f64 {
        (self.style.exponent)(&self.numbers)
    }

    /// The name of the first parameter that must be equal for mixing and is not.
    pub fn unlike(&self, other: &Normal) -> Option<&'static str> {
        let numbers = self.numbers.iter().zip(&other.numbers).zip(self.style.numbers);
        let unlike = |((a, b), number): &((&f64, &f64), &Number)| number.role == Role::Same && a != b;
        numbers.into_iter().find(unlike).map(|(_, number)| number.name)
    }

    /// The law between two grains with models of one kind: parameters are mixed geometrically, materials as
    /// E*.
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
