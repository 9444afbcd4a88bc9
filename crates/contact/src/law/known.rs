//! Frequent combinations of models, for which the loop over contacts is compiled on its own.

use super::{Arm, Cohesion, Damping, Force, Friction, Granular, Loop, Rolling, Slip, Spring, Sync, Twisting};
use crate::cohesion::Pull;
use crate::slider::Look;
use crate::turning::Cdt;

impl Granular {
    /// Runs a loop with this law, with a separate call for each frequent combination of models, so that the
    /// compiler specializes the loop for it.
    #[inline(always)]
    pub(crate) fn within(&self, work: impl Loop) {
        use {Damping::*, Friction::*};
        let (bare, whole, alone) = ((free, loose), Slip::Whole, Slip::Spring);
        match (self.damping, self.spring.kind) {
            (Viscoelastic, MindlinClassic) => {
                let spring = (MindlinClassic, whole);
                if let Some(law) = self.known(hertz, Viscoelastic, spring, Arm::Radius, bare) {
                    return work.run(&law);
                }
            }
            (MassVelocity, LinearHistoryClassic) => {
                let spring = (LinearHistoryClassic, whole);
                if let Some(law) = self.known(hooke, MassVelocity, spring, Arm::Radius, bare) {
                    return work.run(&law);
                }
            }
            (Tsuji, Mindlin) => {
                if let Some(law) = self.known(hertz, Tsuji, (Mindlin, whole), Arm::Middle, bare) {
                    return work.run(&law);
                }
            }
            // Decks of LIGGGHTS: one loop for all four, because each takes 13 s of a test build, and what it could leave out takes
            // a per cent or two of a bed.
            (CoeffRestitution, Mindlin) => {
                let (damping, spring, arm) = (CoeffRestitution, (Mindlin, alone), Arm::Middle);
                if let Some(law) = self.known(hertz, damping, spring, arm, (free_or_cdt, loose_or_sjkr)) {
                    return work.run(&law);
                }
            }
            _ => {}
        }
        work.run(self);
    }

    /// This law, if it has the given models and no resistance to twisting, in a form in which the compiler
    /// knows the models.
    #[inline(always)]
    fn known(
        &self,
        normal: impl Fn(&Force) -> Option<Force>,
        damping: Damping,
        (kind, slip): (Friction, Slip),
        arm: Arm,
        (rolling, cohesion): (impl Fn(&Rolling) -> Option<Rolling>, impl Fn(&Cohesion) -> Option<Cohesion>),
    ) -> Option<Self> {
        let normal = normal(&self.normal)?;
        let (rolling, cohesion) = (rolling(&self.rolling)?, cohesion(&self.cohesion)?);
        let (look, sync, of_normal) = (Look::First, Sync::Off, false);
        let s = &self.spring;
        let same = self.damping == damping
            && (s.kind, s.slip, s.look, s.sync, s.of_normal) == (kind, slip, look, sync, of_normal)
            && self.arm == arm
            && self.twisting == Twisting::None
            && !self.is_on_wall;
        if !same {
            return None;
        }
        Some(Self {
            normal,
            damping,
            spring: Spring { kind, slip, look, sync, of_normal, ..self.spring },
            rolling,
            twisting: Twisting::None,
            cohesion,
            arm,
            is_on_wall: false,
            by_radius: kind.by_radius() || normal.by_radius(),
            ..*self
        })
    }
}

/// The force, if it is Hertz'.
#[inline(always)]
fn hertz(force: &Force) -> Option<Force> {
    let Force::Hertz(law) = force else { return None };
    Some(Force::Hertz(*law))
}

/// The force, if it is Hooke's.
#[inline(always)]
fn hooke(force: &Force) -> Option<Force> {
    let Force::Hooke(law) = force else { return None };
    Some(Force::Hooke(*law))
}

/// No resistance to rolling.
#[inline(always)]
fn free(rolling: &Rolling) -> Option<Rolling> {
    matches!(rolling, Rolling::None).then_some(Rolling::None)
}

/// The resistance to rolling, if it is none or `cdt`.
#[inline(always)]
fn free_or_cdt(rolling: &Rolling) -> Option<Rolling> {
    match *rolling {
        Rolling::None => Some(Rolling::None),
        Rolling::Cdt(Cdt { mu, full: false }) => Some(Rolling::Cdt(Cdt { mu, full: false })),
        _ => None,
    }
}

/// No cohesion.
#[inline(always)]
fn loose(cohesion: &Cohesion) -> Option<Cohesion> {
    matches!(cohesion, Cohesion::None).then_some(Cohesion::None)
}

/// The cohesion, if it is none or `sjkr`.
#[inline(always)]
fn loose_or_sjkr(cohesion: &Cohesion) -> Option<Cohesion> {
    match *cohesion {
        Cohesion::None => Some(Cohesion::None),
        Cohesion::Sjkr(Pull { density, reduces: false }) => {
            Some(Cohesion::Sjkr(Pull { density, reduces: false }))
        }
        _ => None,
    }
}
