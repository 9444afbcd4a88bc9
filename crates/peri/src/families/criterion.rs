//! By what bonds break.

/// By what bonds break (`peri_modify break`). Under any but the first one a bond breaks only while it is longer than at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Criterion {
    /// The stretch of the bond beyond s00, which compression raises.
    #[default]
    Stretch,
    /// The work done on the bond, from [`Families::work_limits`](crate::families::Families::work_limits) on.
    Work,
    /// The normal stress along the bond [pressure], mean of both ends.
    Stress(f64),
    /// The Green-Lagrange strain along the bond, mean of both ends.
    Strain(f64),
    /// Von Mises' stress [pressure], mean of both ends.
    Shear(f64),
    /// A ratio that a formula gives each bond, [`Families::ratios`](crate::families::Families::ratios).
    Formula,
}

impl Criterion {
    /// Whether the sites of bonds are looked at, not the bonds alone.
    pub fn of_sites(self) -> bool {
        matches!(self, Self::Stress(_) | Self::Strain(_) | Self::Shear(_))
    }

    /// Whether bonds without a critical stretch may break.
    pub fn by_itself(self) -> bool {
        self.of_sites() || self == Self::Formula
    }

    /// Whether bonds are judged by a Neo-Hookean stress of their ends.
    pub fn of_stress(self) -> bool {
        matches!(self, Self::Stress(_) | Self::Shear(_))
    }
}
