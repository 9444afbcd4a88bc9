//! bond bpm/spring: damped springs that break, at rest as they are when a run first meets them.

use super::{BondForce, BondStyle, Pull, Stretched, breaking_weights};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_base::math::vec3::{dot, sub};
use perigrain_lang::Args;
use perigrain_plan::{About, Needs, Op, Stage, Tick};
use perigrain_styles::bond::Stiffness;
use perigrain_styles::pull::{Found, apart, find, periods, tally};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::World;
use perigrain_world::field::{BONDS, BOX, F, LISTS, TAG, TALLY, V, X};
use std::collections::BTreeMap;

/// The style.
pub struct BpmSpring;

impl Style for BpmSpring {
    fn name(&self) -> &'static str {
        "bpm/spring"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "bond_style bpm/spring [overlay/pair yes|no] [smooth yes|no] [normalize yes|no] [break yes|no]\nbond_coeff T k ec gamma",
            summary: "Damped springs that break at a strain.",
            text: "F = w (k (r − r0) + γ r̂·v) pulls the ends together, with the distance r0 at which a run first met the bond and w = 1 − ((r − r0)/(r0 ec))⁸ \
                   unless `smooth no` is said. With `normalize yes` the spring's force is k (r − r0)/r0. At a strain beyond ±ec a bond breaks: it is gone \
                   from the next step on, and pair forces act between its ends then. `break no` lets no bond break and needs `smooth no`. \
                   The energy is k (r − r0)²/2, with `normalize yes` k (r − r0)²/(2 r0). Pair forces between bonded particles are off, `special_bonds lj 0 1 1 coul 1 1 1`, or with `overlay/pair yes` on, \
                   `special_bonds lj/coul 1 1 1`. Restart files hold r0, data files do not. `store/local` and `volume/factor` are refused. \
                   Clemmer and Robbins, Phys. Rev. Lett. 129, 078002 (2022).",
            example: "units lj\natom_style bond\nlattice sc 1.0\nregion b block 0 4 0 4 0 4\n\
                      create_box 1 b bond/types 1 extra/bond/per/atom 6\ncreate_atoms 1 box\nmass 1 1.0\n\
                      create_bonds many all all 1 0.9 1.1\nspecial_bonds lj 0 1 1 coul 1 1 1\nbond_style bpm/spring\n\
                      bond_coeff 1 5.0 0.1 0.4\nvelocity all create 0.1 4928\nfix 1 all nve\nthermo_style custom step ebond bonds\nrun 10",
        }
    }
}

#[derive(Clone, Copy)]
struct Options {
    overlay: bool,
    smooth: bool,
    normalize: bool,
    breaks: bool,
}

impl BondStyle for BpmSpring {
    fn build(&self, args: &mut Args, _cx: &BuildCx) -> Result<Box<dyn BondForce>> {
        let mut options = Options { overlay: false, smooth: true, normalize: false, breaks: true };
        let mut last = args.here();
        while let Some(word) = args.next() {
            last = word.span;
            match word.text.as_str() {
                "overlay/pair" => options.overlay = args.flag("overlay/pair")?,
                "smooth" => options.smooth = args.flag("smooth")?,
                "normalize" => options.normalize = args.flag("normalize")?,
                "break" => options.breaks = args.flag("break")?,
                "store/local" | "volume/factor" => {
                    let text = format!("bond_style bpm/spring: `{}` is not in perigrain yet", word.text);
                    return fail(Code::NOT_SUPPORTED, word.span, text);
                }
                _ => return Err(args.unknown(word, &["overlay/pair", "smooth", "normalize", "break"])),
            }
        }
        if options.smooth && !options.breaks {
            let d = Diagnostic::error(Code::CONFLICT, last, "`break no` does not go with smoothed forces");
            return Err(d.help("add `smooth no`").into());
        }
        Ok(Box::new(Declared { options, springs: BTreeMap::new() }))
    }
}

#[derive(Clone)]
struct Declared {
    options: Options,
    /// Stiffness, breaking strain, damping by type.
    springs: BTreeMap<u16, [f64; 3]>,
}

impl BondForce for Declared {
    fn name(&self) -> &'static str {
        "bpm/spring"
    }

    fn coeff(&mut self, kinds: &[u16], args: &mut Args, _cx: &BuildCx) -> Result<()> {
        let k = args.non_negative("the stiffness k")?;
        let spring = [k, args.positive("the breaking strain")?, args.non_negative("the damping gamma")?];
        self.springs.extend(kinds.iter().map(|&k| (k, spring)));
        Ok(())
    }

    fn covers(&self, kind: u16) -> bool {
        self.springs.contains_key(&kind)
    }

    fn restrict(&mut self, kinds: &[u16]) {
        self.springs.retain(|k, _| kinds.contains(k));
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        if self.options.breaks {
            breaking_weights(cx.world(), self.options.overlay, span)?;
        }
        Ok(vec![Box::new(Springs { law: self.clone(), span, made: None, list: vec![] })])
    }

    fn single(&self, _w: &World, bond: &Stretched) -> Option<Pull> {
        self.springs.get(&bond.kind).map(|s| self.options.pull(*s, bond))
    }

    fn stiffness(&self, kind: u16, length: f64, _radii: [f64; 2]) -> Option<Stiffness> {
        let [k, ..] = *self.springs.get(&kind)?;
        let normal = if self.options.normalize { k / length } else { k };
        Some(Stiffness { normal, ..Stiffness::default() })
    }

    fn tunable(&self) -> &'static [&'static str] {
        &["k"]
    }

    fn tuned(&self, name: &str, kind: u16, factor: f64) -> Option<(Box<dyn BondForce>, f64)> {
        let mut tuned = self.clone();
        let k = tuned.springs.get_mut(&kind).filter(|_| name == "k").map(|s| &mut s[0])?;
        *k *= factor;
        let k = *k;
        Some((Box::new(tuned), k))
    }

    fn written(&self, kind: u16) -> Option<String> {
        self.springs.get(&kind).map(|s| s.map(|a| general(a, 16)).join(" "))
    }
}

impl Options {
    /// The force of a spring of this stiffness, breaking strain and damping.
    fn pull(&self, [k, limit, gamma]: [f64; 3], bond: &Stretched) -> Pull {
        let (r, strain) = (bond.length(), bond.strain());
        let longer = if bond.rest == 0.0 { 0.0 } else { r - bond.rest };
        let spring = if self.normalize { -k * strain } else { -k * longer };
        let mut force_per_length = (spring - gamma * dot(bond.d, bond.v) / r) / r;
        if self.smooth {
            let near = (strain / limit).powi(2).powi(2).powi(2);
            force_per_length *= 1.0 - near;
        }
        Pull { energy: -0.5 * spring * longer, force_per_length }
    }
}

/// Forces of all springs, and their breaking.
struct Springs {
    law: Declared,
    span: Span,
    /// Rebuild and change of bonds at which `list` was made.
    made: Option<(u64, u64)>,
    list: Vec<(usize, Found)>,
}

impl Op for Springs {
    fn about(&self) -> About {
        About::new(
            "bond bpm/spring",
            Stage::Force,
            Needs::new().read(X | V | BONDS | BOX | LISTS | TAG).add(F).write(BONDS | TALLY | LISTS),
        )
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let now = (w.rebuild.generation, w.bonds.changes);
        if t.setup || self.made != Some(now) {
            self.list = find(w, |b| self.law.springs.contains_key(&(b.kind as u16)), self.span)?;
            self.made = Some(now);
        }
        let lengths = periods(w)?;
        let mut broken = vec![];
        for (at, found) in &self.list {
            let Some(spring) = self.law.springs.get(&found.kind).copied() else { continue };
            let d = apart(w, &lengths, found.ends);
            let v = sub(w.particles.v[found.ends[0]], w.particles.v[found.ends[1]]);
            let bond = &mut w.bonds.list[*at];
            let mut now = Stretched { kind: found.kind, d, v, rest: bond.length };
            if bond.length == 0.0 {
                bond.length = now.length();
                now.rest = bond.length;
            }
            if self.law.options.breaks && now.strain().abs() > spring[1] {
                broken.push(*at);
                continue;
            }
            let pull = self.law.options.pull(spring, &now);
            tally(w, t, found.ends, &d, &d.map(|d| d * pull.force_per_length), pull.energy);
        }
        if !broken.is_empty() {
            take_away(w, &broken);
        }
        Ok(())
    }
}

/// Removes bonds by their place in the list (ascending); pair forces act between their ends from the next step on.
fn take_away(w: &mut World, broken: &[usize]) {
    let pairs: Vec<[u32; 2]> =
        broken.iter().map(|&k| w.bonds.list[k].ends).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    let mut at = 0;
    w.bonds.retain(|_| {
        at += 1;
        broken.binary_search(&(at - 1)).is_err()
    });
    w.bonds.special.retain(|p| !pairs.contains(p));
    // Lists of contacts leave bonded pairs out.
    w.rebuild.freed = true;
}
