//! Gravity on rigid bodies: M g at the centre, for bodies whose mass and centre are not the sums over their
//! particles.

use super::Declared;
use super::mold::Mold;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::vec3::{Vec3, add, cross, scale, sub};
use perigrain_styles::matter::Masses;
use perigrain_styles::{Gravity, SealCx};
use perigrain_world::{GroupId, SlotId, World};

/// The gravity fixes that act on bodies as a whole.
#[derive(Clone, Default)]
pub struct Weight {
    /// The one named by `gravity`: it acts in addition to all forces on particles.
    named: Option<SlotId>,
    /// Those that act on particles of bodies with a mass of their own: group bit and slot of the
    /// acceleration.
    pulling: Vec<(u32, SlotId)>,
}

/// Accelerations of such fixes at a step [force/mass].
#[derive(Default)]
pub struct Pulls {
    /// On every body, at its centre.
    centre: Option<Vec3>,
    /// On all particles of the group with this bit.
    particles: Vec<(u32, Vec3)>,
}

/// A particle of a body: mass, position relative to the centre, and group mask.
type Member = (f64, Vec3, u32);

impl Weight {
    /// The effect of the deck's gravity fixes on the bodies of `fix`.
    ///
    /// # Errors
    /// `gravity` names a fix that is not a fix gravity.
    pub fn find(fix: &Declared, cx: &mut dyn SealCx) -> Result<Self> {
        let (all, span) = (cx.gravities(), cx.span());
        let named = match &fix.gravity {
            Some(word) => match all.iter().find(|g| g.id == word.text) {
                Some(gravity) => Some(gravity),
                None => {
                    let text = format!("there is no fix gravity `{}`", word.text);
                    let help = format!(
                        "write for example `fix {} all gravity 9.81 vector 0 0 -1 disable`",
                        word.text
                    );
                    return Err(Diagnostic::error(Code::UNKNOWN_FIX, word.span, text).help(help).into());
                }
            },
            None => None,
        };
        let w = cx.world();
        let shares = |g: &&Gravity| {
            let both = g.group.bit() | fix.group.bit();
            let same = g.group == fix.group || g.group == GroupId::ALL;
            g.acts && (same || w.particles.mask.iter().any(|m| m & both == both))
        };
        let lammps = w.settings.lammps();
        // Bodies may be added later: which particles feel gravity is evaluated at each step.
        let other = |g: &&Gravity| g.acts && fix.gives() && named.is_none_or(|n| n.id != g.id);
        let pulling: Vec<&Gravity> = all.iter().filter(other).collect();
        let note = match named {
            Some(_) => named.filter(shares).map(|g| twice(g, span)),
            // LAMMPS has no mixtures.
            None if fix.infile.is_none() && !fix.molds.iter().any(Mold::reads) => None,
            None => pulling.iter().copied().find(shares).map(|g| mass_warning(fix, g, lammps, span)),
        };
        note.into_iter().for_each(|note| w.notes.push(note));
        // LAMMPS leaves gravity on particles unchanged.
        let kept = if lammps { vec![] } else { pulling };
        Ok(Self {
            named: named.map(|g| g.slot),
            pulling: kept.into_iter().map(|g| (g.group.bit(), g.slot)).collect(),
        })
    }

    /// Whether no fix gravity acts on bodies as a whole.
    pub fn is_none(&self) -> bool {
        self.named.is_none() && self.pulling.is_empty()
    }

    /// The current accelerations.
    pub fn accelerations(&self, w: &World) -> Pulls {
        let at = |slot: SlotId| w.slots.get(slot).vector.first_chunk().copied().unwrap_or([0.0; 3]);
        Pulls {
            centre: self.named.map(at),
            particles: self.pulling.iter().map(|(bit, slot)| (*bit, at(*slot))).collect(),
        }
    }
}

/// The warning for a fix gravity that acts both on particles and on their bodies.
fn twice(g: &Gravity, span: Span) -> Diagnostic {
    let text =
        format!("fix gravity `{}` pulls these bodies twice: at their centres, and their particles", g.id);
    let help = "write `disable` at the end of fix gravity, so that it acts through this fix alone";
    Diagnostic::warning(Code::SUSPICIOUS, span, text).help(help)
}

/// The warning that gravity acts on particles whose masses differ from the body's.
fn mass_warning(fix: &Declared, g: &Gravity, lammps: bool, span: Span) -> Diagnostic {
    let source = if fix.infile.is_some() { "`infile`" } else { "the template" };
    let help = format!("write `gravity {}` here and `disable` at the end of fix gravity", g.id);
    if lammps {
        let text = format!(
            "gravity pulls the particles of these bodies by their own masses, not the bodies by those that {source} gives"
        );
        return Diagnostic::warning(Code::SUSPICIOUS, span, text).help(help);
    }
    let text = format!(
        "bodies whose mass or centre {source} gives fall with the acceleration of fix gravity, pulled at their centres; in LAMMPS \
         their particles are pulled, so that they fall at another rate and may turn"
    );
    Diagnostic::note(Code::COMPAT, span, text).help(format!("for the same in LAMMPS {help}"))
}

impl Pulls {
    /// Gravity on all particles of the group with this bit.
    #[cfg(test)]
    pub fn of_particles(bit: u32, a: Vec3) -> Self {
        Self { centre: None, particles: vec![(bit, a)] }
    }

    /// Whether it is empty.
    pub fn is_none(&self) -> bool {
        self.centre.is_none() && self.particles.is_empty()
    }

    /// Force and torque about the centre that a body of this mass feels in addition to the forces on its
    /// particles: M g of the named fix; and, if all particles were pulled one by one, M g in place of their
    /// weights Σ m g and Σ m d × g.
    pub fn on(&self, mass: f64, members: impl Iterator<Item = Member> + Clone) -> [Vec3; 2] {
        let mut force = self.centre.map_or([0.0; 3], |a| scale(mass, a));
        let mut torque = [0.0; 3];
        for (bit, a) in &self.particles {
            if members.clone().next().is_none() || !members.clone().all(|(.., mask)| mask & bit != 0) {
                continue;
            }
            let (mut sum, mut lever) = (0.0, [0.0; 3]);
            for (m, d, _) in members.clone() {
                (sum, lever) = (sum + m, add(lever, scale(m, d)));
            }
            force = add(force, scale(mass - sum, *a));
            torque = sub(torque, cross(lever, *a));
        }
        [force, torque]
    }
}

/// The data of particle `i` that [`Pulls::on`] needs.
pub fn member(masses: &Masses, mask: &[u32], i: usize, d: Vec3) -> Member {
    (masses.get(i), d, mask[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_particles_become_that_of_the_body() {
        let a = [0.0, 0.0, -2.0];
        let all = [(1.0, [0.5, 0.0, 0.0], 1), (1.0, [0.25, 0.0, 0.0], 1)];
        // Σ m a + what is added = M a; Σ m d × a + what is added = 0.
        let [force, torque] = Pulls { centre: None, particles: vec![(1, a)] }.on(1.5, all.into_iter());
        assert_eq!((force, torque), ([0.0, 0.0, 1.0], [0.0, -1.5, 0.0]));
        // A body of which only a part is pulled follows the deck literally.
        let some = [all[0], (1.0, [0.25, 0.0, 0.0], 2)];
        let [force, torque] = Pulls { centre: Some(a), particles: vec![(1, a)] }.on(1.5, some.into_iter());
        assert_eq!((force, torque), ([0.0, 0.0, -3.0], [0.0; 3]));
    }
}
