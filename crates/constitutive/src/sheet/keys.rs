//! The keys of a data sheet.

/// What a number measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// [pressure].
    Pressure,
    /// [energy/area].
    EnergyPerArea,
    /// [1/time].
    Rate,
    /// [temperature].
    Temperature,
    /// Degrees.
    Angle,
    /// Without a unit.
    Number,
}

/// Which numbers a key may have.
#[derive(Clone, Copy)]
enum Range {
    /// Above 0.
    Positive,
    /// 0 or more.
    NonNegative,
    /// Degrees from 0 to below 90.
    Angle,
    /// Any.
    Any,
}

macro_rules! keys {
    ($($variant:ident $name:literal $quantity:ident $range:ident $example:literal $about:literal;)*) => {
        /// A number of a data sheet.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Key { $(#[doc = $about] $variant),* }

        impl Key {
            /// How many there are.
            pub const COUNT: usize = Self::ALL.len();

            /// All keys.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$variant),*];

            /// As files and lines call it.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }

            /// What it measures.
            pub fn quantity(self) -> Quantity {
                match self { $(Self::$variant => Quantity::$quantity),* }
            }

            /// How a file gives it.
            pub fn example(self) -> &'static str {
                match self { $(Self::$variant => $example),* }
            }

            fn range(self) -> Range {
                match self { $(Self::$variant => Range::$range),* }
            }
        }
    };
}

keys! {
    Yield "yield" Pressure Positive "\"90 MPa\"" "First yield stress σ₀, A of Johnson and Cook.";
    H "H" Pressure NonNegative "\"100 MPa\"" "Modulus H of linear hardening, of a yield stress or of a cohesion.";
    SigmaInf "sigma_inf" Pressure Positive "\"600 MPa\"" "Saturation stress σ∞ of Voce.";
    SmallB "b" Number Positive "10.0" "Exponent b of Voce.";
    N "n" Number Positive "0.31" "Exponent n of Swift, of Johnson and Cook.";
    Eps0 "eps0" Number Positive "0.01" "Strain ε₀ of Swift.";
    B "B" Pressure NonNegative "\"292 MPa\"" "Modulus B of Johnson and Cook.";
    C "C" Number NonNegative "0.025" "Coefficient C of the rate, of Johnson and Cook.";
    M "m" Number Positive "1.09" "Exponent m of temperature, of Johnson and Cook.";
    Rate0 "rate0" Rate Positive "\"1 1/s\"" "Rate ε̄̇₀ below which rates have no effect.";
    Tr "Tr" Temperature NonNegative "\"298 K\"" "Temperature T_r up to which temperatures have no effect.";
    Tm "Tm" Temperature Positive "\"1356 K\"" "Melting temperature T_m.";
    D1 "D1" Number Any "0.54" "D₁ of the fracture strain of Johnson and Cook.";
    D2 "D2" Number Any "4.89" "D₂ of the fracture strain.";
    D3 "D3" Number Any "-3.03" "D₃ of the fracture strain.";
    D4 "D4" Number Any "0.014" "D₄ of the fracture strain.";
    D5 "D5" Number Any "1.12" "D₅ of the fracture strain.";
    EpsF "eps_f" Number Positive "0.3" "Equivalent plastic strain ε_f at which damage begins.";
    Gf "Gf" EnergyPerArea Positive "\"20 kJ/m2\"" "Fracture energy G_f of softening after damage has begun.";
    Cohesion "cohesion" Pressure Positive "\"10 MPa\"" "Cohesion c₀ of Drucker and Prager.";
    Phi "phi" Angle Angle "30.0" "Angle of friction φ of Drucker and Prager.";
    Psi "psi" Angle Angle "10.0" "Angle of dilation ψ of Drucker and Prager.";
}

impl Key {
    /// Why a value is none of this key; `None` if it is.
    pub(super) fn fault(self, value: f64) -> Option<&'static str> {
        if !value.is_finite() {
            return Some("must be a finite number");
        }
        match self.range() {
            Range::Positive if value <= 0.0 => Some("must be positive"),
            Range::NonNegative if value < 0.0 => Some("must not be negative"),
            Range::Angle if !(0.0..90.0).contains(&value) => {
                Some("must be an angle from 0 to below 90 degrees")
            }
            _ => None,
        }
    }
}
