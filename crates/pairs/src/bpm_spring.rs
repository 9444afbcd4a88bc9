//! `pair_style bpm/spring`: damped repulsion of particles of bonded solids.

use super::shared::{admit, built_at, near, push};
use super::{ByPart, Deck, Facts, Pair, PairStyle, Scales, TypePairs};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{dot, sub};
use perigrain_lang::Args;
use perigrain_neigh::list::{Pair as Near, Reach, Wanted, difference};
use perigrain_plan::{About, Needs, Op, Stage, Tick};
use perigrain_styles::near::room_for_pairs;
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::adapted::Coefficient;
use perigrain_world::field::{
    BONDS, BOX, F, FAMILIES, KIND, LISTS, MASK, MEMO, MOLECULE, RADIUS, TAG, TALLY, V, X, X0,
};
use perigrain_world::{Allowed, Constant, Numbers, World};
use std::collections::BTreeMap;

/// The style.
pub struct BpmSpringStyle;

impl Style for BpmSpringStyle {
    fn name(&self) -> &'static str {
        "bpm/spring"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "pair_style bpm/spring\npair_coeff I J k rc gamma",
            summary: "Damped repulsion within a distance, for particles of bonded solids.",
            text: "F = k (rc − r) − γ (1 − (r/rc)⁸) r̂·v pushes particles apart while r < rc, with the energy k (rc − r)²/2. Bonded particles \
                   are left out as `special_bonds` says. Every pair of types needs coefficients of its own (LAMMPS mixes).",
            example: "pair_style bpm/spring\npair_coeff * * 1.0 0.0009 0.5",
        }
    }
}

impl PairStyle for BpmSpringStyle {
    fn build(&self, _args: &mut Args, _cx: &BuildCx) -> Result<Box<dyn Pair>> {
        Ok(Box::<Springs>::default())
    }
}

/// Stiffness, cutoff and damping by pair of types.
#[derive(Clone, Default)]
struct Springs {
    table: BTreeMap<(u16, u16), [f64; 3]>,
    /// Where fixes leave the stiffness and damping they have changed.
    keys: BTreeMap<(u16, u16), [Numbers; 2]>,
}

impl Springs {
    /// With what fixes have made of it.
    fn adapted(&self, w: &World) -> Self {
        let mut new = self.clone();
        for (types, [k, _, gamma]) in &mut new.table {
            let [of_k, of_gamma] = self.keys[types].map(|key| w.adapted(key));
            *k = of_k.unwrap_or(*k);
            *gamma = of_gamma.unwrap_or(*gamma);
        }
        new
    }
}

impl Pair for Springs {
    fn facts(&self) -> Facts {
        Facts { name: "bpm/spring", coefficients: &["k", "gamma"], ..Facts::default() }
    }

    fn coeff(&mut self, pairs: &TypePairs, args: &mut Args, _cx: &BuildCx) -> Result<()> {
        let k = args.non_negative("the stiffness k")?;
        let spring = [k, args.positive("the cutoff rc")?, args.non_negative("the damping gamma")?];
        self.table.extend(pairs.iter().map(|p| (*p, spring)));
        let of = |types, name: &str| {
            let (style, name) = ("bpm/spring".to_string(), name.to_string());
            Coefficient { bond: false, style, name, types }.key()
        };
        self.keys.extend(pairs.iter().map(|&p| (p, ["k", "gamma"].map(|name| of(p, name)))));
        Ok(())
    }

    fn covers(&self, i: u16, j: u16) -> bool {
        self.table.contains_key(&(i.min(j), i.max(j)))
    }

    fn restrict(&mut self, pairs: &TypePairs) {
        self.table.retain(|p, _| pairs.contains(p));
    }

    fn coefficient(&self, name: &str, types: (u16, u16)) -> Option<f64> {
        let [k, _, gamma] = self.table.get(&types)?;
        Some(if name == "k" { *k } else { *gamma })
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<ByPart<dyn Op>> {
        let mut wanted = Wanted::new(cx.world().types);
        self.table.iter().for_each(|((a, b), s)| wanted.set(*a, *b, Reach::Fixed(s[1])));
        let op = Repulsion {
            said: self.clone(),
            law: self.clone(),
            adapted: 0.0,
            wanted,
            made: None,
            list: vec![],
        };
        Ok(vec![(0, Box::new(op))])
    }

    fn scales(&self, _w: &World, _deck: Deck) -> Scales {
        Scales { cutoff: self.table.values().map(|c| c[1]).reduce(f64::max), ..Scales::default() }
    }
}

static NAME: Constant<f64> = Constant::new("bpm/spring");

/// The op.
struct Repulsion {
    /// As the deck's lines said.
    said: Springs,
    /// As fixes have changed it.
    law: Springs,
    /// Which of their changes have been seen.
    adapted: f64,
    wanted: Wanted,
    /// Rebuild and change of bonds at which the list was made.
    made: Option<(u64, u64)>,
    list: Vec<Near>,
}

impl Repulsion {
    /// The list, as it stands: made anew, or with the pairs that bonds have freed.
    fn renew(&mut self, w: &World, t: &Tick) -> Result<()> {
        let now = (w.rebuild.generation, w.bonds.changes);
        if !t.setup && self.made == Some(now) {
            return Ok(());
        }
        let skin = w.settings.neighbor.skin;
        let freed = self.made.filter(|_| !t.setup).and_then(|(since, _)| w.rebuild.only_parted(since));
        if let Some(pairs) = freed {
            admit(w, pairs, &self.wanted, &Allowed::new(w), &mut self.list);
        } else {
            room_for_pairs(w, &self.wanted, skin)?;
            self.list = near(w, built_at(w), &self.wanted, skin, &Allowed::new(w));
        }
        self.made = Some(now);
        Ok(())
    }
}

impl Op for Repulsion {
    fn about(&self) -> About {
        About::new(
            "pair bpm/spring",
            Stage::Force,
            Needs::new()
                .read(
                    X | V
                        | KIND
                        | BONDS
                        | BOX
                        | MEMO
                        | LISTS
                        | RADIUS
                        | FAMILIES
                        | TAG
                        | MOLECULE
                        | X0
                        | MASK,
                )
                .add(F)
                .write(TALLY),
        )
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let period = w.periods();
        self.renew(w, t)?;
        if self.adapted != w.adaptations() {
            self.adapted = w.adaptations();
            self.law = self.said.adapted(w);
        }
        let farthest = self.law.table.values().fold(0.0, |far: f64, s| far.max(s[1]));
        let mut energy = 0.0;
        for pair in &self.list {
            let (i, j) = (pair.i as usize, pair.j as usize);
            let p = &w.particles;
            let d = difference(&p.x, &period, pair);
            let square = dot(d, d);
            if square >= farthest * farthest {
                continue;
            }
            let kinds = (p.kind[i].min(p.kind[j]), p.kind[i].max(p.kind[j]));
            let Some([k, cut, gamma]) = self.law.table.get(&kinds).copied() else { continue };
            if square >= cut * cut {
                continue;
            }
            let r = square.sqrt();
            let near = 1.0 - (r / cut).powi(2).powi(2).powi(2);
            let v = sub(p.v[i], p.v[j]);
            let force = (k * (cut - r) - gamma * dot(d, v) * near / r) / r;
            let f = d.map(|d| d * force);
            let own = 0.5 * k * (cut - r) * (cut - r);
            energy += own;
            push(w, t, [i, j], d, f, own);
        }
        if t.energy {
            w.tally.add_pair(*NAME, energy);
        }
        Ok(())
    }
}
