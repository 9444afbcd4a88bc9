//! `special_bonds`: how much pair forces count between bonded particles.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::setting;
use perigrain_styles::words::{Each, Kind, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::bonds::Weights;

/// The command.
pub struct SpecialBonds;

impl Style for SpecialBonds {
    fn name(&self) -> &'static str {
        "special_bonds"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Says whether pair forces act between particles that are one, two or three bonds apart.",
            text: "Each line begins anew from 0 0 0 for both kinds of weights. Peridynamic bonds are a matter of their own and have \
                   no such weights.\n\n\
                   A weight `lj` of 0 leaves the pairs out of all pair forces. One between 0 and 1 is a factor on forces and \
                   energies of `soft` and `bpm/spring`; granular styles know no half contacts, as in LAMMPS. `coul` belongs to \
                   electric forces; here only `create_bonds` looks at it.",
            example: "special_bonds lj 0.0 1.0 1.0 coul 1.0 1.0 1.0",
        }
    }
}

#[derive(Words)]
#[word(least = 1)]
struct Line {
    #[word(flatten)]
    weights: Each<Kinds>,
}

/// What weights are set.
#[derive(Words)]
#[word(keywords)]
enum Kinds {
    /// The weights of both kinds for particles one, two and three bonds apart.
    #[word("lj/coul")]
    Both(Three),
    /// Those of forces that are not electric.
    Lj(Three),
    /// Those of electric forces.
    Coul(Three),
    /// As `lj 0 0 0.5 coul 0 0 0.8333`.
    Amber,
    /// All weights are 0.
    Charmm,
    /// All weights are 0, but for 1 of particles three bonds apart.
    Dreiding,
    /// All weights are 1, but for 0 of particles one bond apart.
    Fene,
    /// `yes` belongs to interactions that perigrain does not have, and is refused.
    Angle(#[word(what = "angle")] bool),
    /// As `angle`.
    Dihedral(#[word(what = "dihedral")] bool),
}

/// The weights of one kind.
#[derive(Clone, Copy, Words)]
struct Three {
    #[word(name = "W12", what = "the weight of particles one bond apart")]
    one: Weight,
    #[word(name = "W13", what = "the weight of particles two bonds apart")]
    two: Weight,
    #[word(name = "W14", what = "the weight of particles three bonds apart")]
    three: Weight,
}

impl From<Three> for [f64; 3] {
    fn from(Three { one, two, three }: Three) -> Self {
        [one.0, two.0, three.0]
    }
}

/// A weight from 0 to 1.
#[derive(Clone, Copy)]
struct Weight(f64);

impl Value for Weight {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let span = args.here();
        let weight = args.number(what)?;
        match (0.0..=1.0).contains(&weight) {
            true => Ok(Self(weight)),
            false => fail(Code::BAD_VALUE, span, format!("a weight must lie between 0 and 1: {weight}")),
        }
    }
}

impl CommandStyle for SpecialBonds {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let line: Line = read(a, cx)?;
        let mut weights = Weights::default();
        for kind in line.weights.0 {
            match kind.value {
                Kinds::Both(three) => weights = Weights { lj: three.into(), coul: three.into() },
                Kinds::Lj(three) => weights.lj = three.into(),
                Kinds::Coul(three) => weights.coul = three.into(),
                Kinds::Amber => weights = Weights { lj: [0.0, 0.0, 0.5], coul: [0.0, 0.0, 5.0 / 6.0] },
                Kinds::Charmm => weights = Weights::default(),
                Kinds::Dreiding => weights = Weights { lj: [0.0, 0.0, 1.0], coul: [0.0, 0.0, 1.0] },
                Kinds::Fene => weights = Weights { lj: [0.0, 1.0, 1.0], coul: [0.0, 1.0, 1.0] },
                Kinds::Angle(yes) | Kinds::Dihedral(yes) => {
                    if yes {
                        let key = kind.word.text;
                        let text = format!("special_bonds {key} yes: perigrain has no {key} interactions");
                        return fail(Code::NOT_SUPPORTED, kind.word.span, text);
                    }
                }
            }
        }
        Ok(setting(move |cx| {
            cx.world.bonds.weights = weights;
            cx.world.bonds.changes += 1;
            cx.world.touch();
            Ok(())
        }))
    }
}
