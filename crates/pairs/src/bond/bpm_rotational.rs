//! bond bpm/rotational: bonds that stretch, shear, twist, bend and break.

use super::driver::{Bonded, Driven, ends_of, pull_of};
use super::options::{Options, Springs};
use super::store_local::Store;
use super::{BondForce, BondStyle, Pull, Stretched, needs_orientations};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::cformat::general;
use perigrain_base::math::vec3::scale;
use perigrain_bonded::law::BondLaw;
use perigrain_bonded::rotational::{Coeffs, Rotational};
use perigrain_bonded::stiffness::Stiffness;
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::bond::{Loaded, Standing, Swing};
use perigrain_styles::words::{Alternative, At, Form, NonNegative, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Fix, SealCx, Style};
use perigrain_world::field::{Fields, OMEGA, QUAT};
use perigrain_world::{Bond, World};
use std::collections::BTreeMap;

/// The style.
pub struct BpmRotational;

impl Style for BpmRotational {
    fn name(&self) -> &'static str {
        "bpm/rotational"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed("bond_coeff T", Own::GRAMMAR)] },
            ),
            summary: "Bonds between spheres that stretch, shear, twist, bend and break.",
            text: with_store!("bpm_rotational.md"),
            example: "units lj\natom_style bpm/sphere\nlattice sc 1.0\nregion b block 0 3 0 3 0 3\n\
                      create_box 1 b bond/types 1 extra/bond/per/atom 6\ncreate_atoms 1 box\nset group all diameter 1.0\n\
                      create_bonds many all all 1 0.9 1.1\nspecial_bonds lj 0 1 1 coul 1 1 1\nbond_style bpm/rotational\n\
                      bond_coeff 1 1.0 0.2 0.02 0.02 0.2 0.04 0.04 0.04 0.1 0.02 0.002 0.002\nvelocity all create 0.1 4928\n\
                      fix 1 all nve/bpm/sphere\nthermo_style custom step ke bonds\nrun 10",
        }
    }
}

/// The words of the style.
#[derive(Words)]
struct Line {
    #[word(flatten)]
    springs: Springs,
    /// What newer LAMMPS calls the frame of this style.
    #[word(keyword = "frame", with = frame, kind = Kind::Choice(PARTICLE))]
    _frame: Option<Here>,
    /// What newer LAMMPS calls the dashpots of this style.
    #[word(keyword = "damping", with = damping, kind = Kind::Choice(DEM))]
    _damping: Option<Here>,
}

/// A word of newer LAMMPS for the behaviour of this style.
struct Here;

const PARTICLE: &[Alternative] = &[Alternative { word: "particle", about: "", parts: &[] }];
const DEM: &[Alternative] = &[Alternative { word: "dem", about: "", parts: &[] }];

/// The words of `bond_coeff`.
#[derive(Words)]
struct Own {
    /// Stiffnesses against stretch and shear [force/length].
    #[word(name = "kr ks", what = "the stiffness {}")]
    springs: [NonNegative; 2],
    /// Stiffnesses against twist and bending [torque].
    #[word(name = "kt kb", what = "the stiffness {}")]
    turning: [NonNegative; 2],
    /// Forces along and across the bond at which it breaks [force].
    #[word(name = "frc fsc", what = "the force {} at which it breaks")]
    forces: [At<f64>; 2],
    /// Torques of twist and bending at which it breaks [torque].
    #[word(name = "ttc tbc", what = "the torque {} at which it breaks")]
    torques: [At<f64>; 2],
    /// Dashpots along and across the bond [force/velocity].
    #[word(name = "gn gs", what = "the damping {}")]
    dashpots: [NonNegative; 2],
    /// Dashpots against rolling and twist [torque time].
    #[word(name = "gr gt", what = "the damping {}")]
    rolling: [NonNegative; 2],
}

impl Own {
    fn coeffs(self, options: &Options) -> Result<Coeffs> {
        let four = |[normal, shear]: [NonNegative; 2], [twist, bend]: [NonNegative; 2]| Stiffness {
            normal: normal.0,
            shear: shear.0,
            twist: twist.0,
            bend: bend.0,
        };
        let [normal, shear] = self.forces;
        let [twist, bend] = self.torques;
        let strength = Stiffness {
            normal: options.limit(normal, "the force frc at which it breaks")?,
            shear: options.limit(shear, "the force fsc at which it breaks")?,
            twist: options.limit(twist, "the torque ttc at which it breaks")?,
            bend: options.limit(bend, "the torque tbc at which it breaks")?,
        };
        // Roll comes before twist here.
        let [roll, twist] = self.rolling;
        let damping = four(self.dashpots, [twist, roll]);
        Ok(Coeffs { stiffness: four(self.springs, self.turning), strength, damping })
    }
}

impl BondStyle for BpmRotational {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn BondForce>> {
        needs_orientations(self.name(), cx)?;
        let options = read::<Line>(args, cx)?.springs.options()?;
        Ok(Box::new(Declared { options, types: BTreeMap::new(), compat_lammps: cx.world.settings.lammps() }))
    }
}

/// The value of `frame` for which this style's behaviour stands.
fn frame(args: &mut Args, _: &BuildCx) -> Result<Here> {
    same_as_here(args, "frame", ["particle", "average"])
}

/// The value of `damping` for which this style's behaviour stands.
fn damping(args: &mut Args, _: &BuildCx) -> Result<Here> {
    same_as_here(args, "damping", ["dem", "derivative"])
}

fn same_as_here(args: &mut Args, word: &str, [here, elsewhere]: [&'static str; 2]) -> Result<Here> {
    let given = args.expect(here)?;
    if given.text == here {
        return Ok(Here);
    }
    if given.text != elsewhere {
        return Err(args.unknown(given, &[here]));
    }
    let text = format!("bond_style bpm/rotational: `{word} {elsewhere}` is not in perigrain");
    let d = Diagnostic::error(Code::NOT_SUPPORTED, given.span, text);
    Err(d.help(format!("`{word} {here}` is; `bond_style bpm/beam` treats both ends alike")).into())
}

#[derive(Clone)]
struct Declared {
    options: Options,
    types: BTreeMap<u16, Coeffs>,
    compat_lammps: bool,
}

impl Driven<0> for Declared {
    type Law = Rotational;
    const NAME: &'static str = "bpm/rotational";

    fn law(&self) -> Rotational {
        let Options { smooth, normalize, .. } = self.options;
        Rotational { smooth, normalize, compat_lammps: self.compat_lammps }
    }
    fn coeffs(&self, kind: u16) -> Option<Coeffs> {
        self.types.get(&kind).copied()
    }
    fn measures(&self) -> bool {
        true
    }
    fn damped(&self) -> bool {
        self.types.values().any(|k| k.damping != Stiffness::default())
    }
    fn store(&self) -> Option<&Store> {
        self.options.store.as_ref()
    }
    fn breaks(&self) -> bool {
        self.options.breaks
    }
    fn axes_in_space(&self) -> bool {
        self.compat_lammps
    }
    fn own(&self, _w: &World, _k: &Coeffs, _bond: &Bond, _ends: [usize; 2]) -> [f64; 0] {
        []
    }
}

impl BondForce for Declared {
    fn name(&self) -> &'static str {
        "bpm/rotational"
    }

    fn coeff(&mut self, kinds: &[u16], args: &mut Args, cx: &BuildCx) -> Result<()> {
        let coeffs = read::<Own>(args, cx)?.coeffs(&self.options)?;
        self.types.extend(kinds.iter().map(|&k| (k, coeffs)));
        Ok(())
    }

    fn covers(&self, kind: u16) -> bool {
        self.types.contains_key(&kind)
    }

    fn restrict(&mut self, kinds: &[u16]) {
        self.types.retain(|k, _| kinds.contains(k));
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        self.options.check(cx.world(), span)?;
        Ok(vec![Box::new(Bonded::new(self.clone(), span))])
    }

    fn fixes(&self) -> Vec<(String, Box<dyn Fix>)> {
        self.options.fixes()
    }

    fn single(&self, w: &World, bond: &Stretched) -> Option<Pull> {
        let mut pull = pull_of(self, w, bond)?;
        if self.compat_lammps {
            // LAMMPS calls force what is force over length.
            pull.force_per_length *= bond.length();
        }
        Some(pull)
    }

    fn extras(&self) -> &'static [&'static str] {
        &["b1", "b2", "b3", "b4", "b5", "b6", "b7"]
    }

    fn looks_at(&self) -> Fields {
        QUAT | OMEGA
    }

    fn extra(&self, w: &World, bond: &Stretched) -> Vec<f64> {
        let Some(k) = self.types.get(&bond.kind) else { return vec![0.0; 7] };
        let (ends, motion) = ends_of(w, bond, true);
        let force = self.law().act(k, &[], &ends, Some(&motion)).force;
        // Seen from the end that is listed first.
        let sign = if bond.bond.ends[0] < bond.bond.ends[1] { 1.0 } else { -1.0 };
        // LAMMPS' direction has the length at rest.
        let long = if self.compat_lammps { ends.length } else { 1.0 };
        let axis = scale(sign * long, ends.axis);
        [&[ends.length][..], &axis, &scale(sign, force)].concat()
    }

    fn stiffness(&self, kind: u16, length: f64, _radii: [f64; 2]) -> Option<Stiffness> {
        let k = self.types.get(&kind)?.stiffness;
        let per = if self.options.normalize { length } else { 1.0 };
        Some(Stiffness { normal: k.normal / per, shear: k.shear / per, ..k })
    }

    fn turns(&self, kind: u16) -> bool {
        self.types.contains_key(&kind)
    }

    fn may_break(&self, kind: u16) -> bool {
        self.options.breaks && self.types.contains_key(&kind)
    }

    fn used(&self, bond: &Loaded) -> Option<f64> {
        let k = self.types.get(&bond.kind).filter(|_| self.options.breaks)?.strength;
        let [tension, shear, bend, twist] = bond.bears;
        Some((tension / k.normal + shear / k.shear + bend / k.bend + twist / k.twist).max(0.0))
    }

    fn swing(&self, bond: &Standing) -> Option<Swing> {
        let stiffness = self.stiffness(bond.kind, bond.length, bond.radii)?;
        let d = self.types.get(&bond.kind)?.damping;
        let dashpots = Stiffness { twist: 0.5 * d.twist, bend: 0.5 * d.bend * bond.length, ..d };
        Some(Swing { stiffness, dashpots })
    }

    fn tunable(&self) -> &'static [&'static str] {
        &["kr", "ks", "kt", "kb", "strength"]
    }

    fn tuned(&self, name: &str, kind: u16, factor: f64) -> Option<(Box<dyn BondForce>, f64)> {
        let mut tuned = self.clone();
        let k = tuned.types.get_mut(&kind)?;
        let value = match name {
            "kr" => &mut k.stiffness.normal,
            "ks" => &mut k.stiffness.shear,
            "kt" => &mut k.stiffness.twist,
            "kb" => &mut k.stiffness.bend,
            "strength" => {
                // All four, so that they stay in proportion.
                k.strength = k.strength.times(factor);
                let value = k.strength.normal;
                return Some((Box::new(tuned), value));
            }
            _ => return None,
        };
        *value *= factor;
        let value = *value;
        Some((Box::new(tuned), value))
    }

    fn written(&self, kind: u16) -> Option<String> {
        let k = self.types.get(&kind)?;
        let ([s, b], d) = ([&k.stiffness, &k.strength], &k.damping);
        let numbers = [
            s.normal, s.shear, s.twist, s.bend, b.normal, b.shear, b.twist, b.bend, d.normal, d.shear,
            d.bend, d.twist,
        ];
        Some(numbers.map(|a| general(a, 16)).join(" "))
    }
}
