//! What is the same for all bonds during one evaluation, and the form in which viscous bonds remember.

/// Columns that force kernels read, at most.
pub const COLUMNS: usize = 6;

/// In which form viscous bonds remember the stretch D of their Maxwell element: as decay D − fresh s, s being the bond's
/// stretch at the last step that advanced. With the shares of the next step that needs only its own stretch, since
/// D' = decay D + fresh (s' − s).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Held {
    /// Factor of D.
    pub decay: f64,
    /// Factor of −s.
    pub fresh: f64,
}

impl Default for Held {
    /// D itself.
    fn default() -> Self {
        Self { decay: 1.0, fresh: 0.0 }
    }
}

impl Held {
    /// The form for steps in which `decay` of a stretch is left and `fresh` of the step's own. Where hardly anything is left,
    /// D itself: it could not be had back.
    pub fn for_steps(decay: f64, fresh: f64) -> Self {
        if decay > 0.5 { Self { decay, fresh } } else { Self::default() }
    }
}

/// What is the same for all bonds during one evaluation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moment {
    /// Share of a Maxwell element's stretch that is left after the step.
    pub decay: f64,
    /// Share of this step's stretch that the element still has at its end.
    pub fresh: f64,
    /// Share of the shear modulus that relaxes.
    pub lambda: f64,
    /// 1 if plastic flow happens, 0 if the state only is looked at.
    pub flow: f64,
    /// The form in which viscous bonds have remembered.
    pub held: Held,
    /// The form in which they shall.
    pub hold: Held,
    /// Energies asked for are those that damage has taken.
    pub lost: bool,
    /// Flow under LAMMPS' laws is that of 2026.
    pub mended: bool,
}

impl Moment {
    /// Whether viscous bonds remember what this step needs and need not look back.
    pub fn steady(&self) -> bool {
        self.held == Held { decay: self.decay, fresh: self.fresh }
    }
}
