//! fix bond/create: bonds between particles that have come close.

mod choice;

use super::{Fix, FixStyle};
use choice::{Count, chosen};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail};
use perigrain_base::math::rng::Marsaglia;
use perigrain_lang::{Args, Word};
use perigrain_plan::{Needs, Op, Stage, Tick, When};
use perigrain_styles::matter::publish;
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, BondType, Fraction, Kind, MarsagliaSeed, Syntax, Value, Words, read_or};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BONDS, BOX, COLUMNS, KIND, LISTS, MASK, MEMO, MOLECULE, SLOTS, TAG, X};
use perigrain_world::{Bond, GroupId, Key, Numbers, World};

/// The style.
pub struct BondCreate;

impl Style for BondCreate {
    fn name(&self) -> &'static str {
        "bond/create"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Makes bonds between particles that have come close.",
            text: "At multiples of N, after particles have moved and before forces act, each particle of type itype of \
                   the group looks for the nearest one of type jtype of the group within R that it may be bonded to, \
                   and the other way round; two that have chosen each other get a bond, so that no particle gets more \
                   than one at a time. Of equal distances that to the pair with the lower IDs counts. Pairs that are \
                   bonded already are left out, and those that `neigh_modify exclude` or two weights 0 of \
                   `special_bonds` keep out of neighbour lists (with the default weights those two or three bonds \
                   apart).\n\n\
                   Pair forces between the ends cease at once, as `special_bonds` says, and bond forces begin in the \
                   same step. Bonds of `bpm/*` styles are at rest as they are made: length and axis are those of this \
                   step. A style whose rest length is a coefficient (`harmonic`) sets the energy free that it has at \
                   that distance.\n\n\
                   LAMMPS also needs a pair style that reaches as far as R; perigrain does not. Angles and dihedrals \
                   (`atype`, `dtype`, `itype`) are refused. LAMMPS counts bonds when the first run begins and adds \
                   those it makes, so that one that has broken counts on: so it is under `-compat lammps` alone.\n\n\
                   Vector of 2 (intensive): how many it made when it last looked, and in all; a second run, or one from \
                   a restart file, counts on.",
            example: "units lj\natom_style bond\nregion b block 0 6 0 4 0 4\ncreate_box 1 b bond/types 1 extra/bond/per/atom 2\n\
                      create_atoms 1 single 1 1 1\ncreate_atoms 1 single 2.1 1 1\nmass 1 1.0\n\
                      bond_style harmonic\nbond_coeff 1 5.0 1.0\nvelocity all create 1.0 4928\nfix 1 all nve\n\
                      fix glue all bond/create 10 1 1 1.2 1 iparam 1 1 jparam 1 1\n\
                      thermo_style custom step bonds f_glue[2]\nrun 100",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Looks at multiples of N [steps].
    #[word(name = "N", what = "the number of steps N", from = 1)]
    every: i64,
    /// The types of the two ends.
    #[word(name = "itype jtype")]
    types: [ParticleType; 2],
    /// The distance R within which bonds are made [length].
    #[word(name = "R", non_negative)]
    range: f64,
    /// The type of the bonds.
    #[word(name = "bondtype")]
    kind: BondType,
    /// A particle of type itype that has MAX bonds of the type gets no more (0: no limit), and when it has reached MAX it becomes
    /// one of type newtype. Where both types are one, `iparam` and `jparam` must be the same.
    #[word(keyword, name = "MAX newtype", what = "the largest number of bonds")]
    iparam: Option<(usize, ParticleType)>,
    /// The same for particles of type jtype.
    #[word(keyword, name = "MAX newtype", what = "the largest number of bonds")]
    jparam: Option<(usize, ParticleType)>,
    /// Only where a random number of the stream of this seed is below P: that of the end with the lower ID. The numbers are LAMMPS'
    /// where particles are created in the order of their IDs and not sorted (`atom_modify sort 0 0`).
    #[word(keyword, name = "P SEED")]
    prob: Option<(Fraction, MarsagliaSeed)>,
    #[word(keyword, shown = "off")]
    molecule: Option<At<Molecules>>,
}

/// The refusal of LAMMPS' keywords for angles and dihedrals.
fn angles(word: &Word) -> Option<Diagnostics> {
    if !["atype", "dtype", "itype", "aconstrain"].contains(&word.text.as_str()) {
        return None;
    }
    let text = format!("`{}` makes angles or dihedrals, which this fix does not", word.text);
    let d = Diagnostic::error(Code::NOT_SUPPORTED, word.span, text);
    let help = "leave it out: they would exert nothing; bonds of `bpm/rotational` and `bpm/beam` bend";
    Some(d.help(help).into())
}

impl FixStyle for BondCreate {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        if !cx.world.particles.style.bonded {
            let text = "fix bond/create needs particles with bonds";
            let d = Diagnostic::error(Code::WRONG_ORDER, cx.span, text);
            return Err(d.help("`atom_style bond`, alone or in a hybrid, has them").into());
        }
        let line: Line = read_or(args, cx, angles)?;
        let (types, kind) = (line.types.map(|t| t.0), line.kind.0);
        let mut limits = types.map(|becomes| Limit { most: 0, becomes });
        for (limit, given) in limits.iter_mut().zip([line.iparam, line.jparam]) {
            if let Some((most, becomes)) = given {
                *limit = Limit { most, becomes: becomes.0 };
            }
        }
        let molecules = molecules(line.molecule, cx)?;
        if types[0] == types[1] && limits[0] != limits[1] {
            let d = Diagnostic::error(
                Code::CONFLICT,
                cx.span,
                "itype and jtype are one, and iparam is not jparam",
            );
            return Err(d.help("give both the same numbers").into());
        }
        let key = |what: &str| Key::new(&format!("bond/create/{}{what}", cx.id));
        Ok(Box::new(Declared {
            id: cx.id.to_string(),
            key: key(""),
            counts: key("/counts"),
            every: line.every,
            rule: Rule { group: cx.group, types, range: line.range, kind, limits, molecules },
            chance: line.prob.map(|(p, seed)| (p.0, seed.0)),
            span: cx.span,
        }))
    }
}

/// A type of particles.
struct ParticleType(u16);

impl Value for ParticleType {
    const KIND: Kind = Kind::Types;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let span = args.here();
        let k = args.integer_from(1, "a type of particles")?;
        match u16::try_from(k) {
            Ok(kind) if usize::from(kind) <= cx.world.types => Ok(Self(kind)),
            _ => fail(
                Code::BAD_VALUE,
                span,
                format!("there are {} types of particles, no type {k}", cx.world.types),
            ),
        }
    }
}

fn molecules(named: Option<At<Molecules>>, cx: &BuildCx) -> Result<Molecules> {
    let Some(named) = named else { return Ok(Molecules::Off) };
    if named.value != Molecules::Off && !cx.world.particles.style.molecules {
        let text = "the particles of this scene belong to no molecules";
        let d = Diagnostic::error(Code::CONFLICT, named.span, text);
        return Err(d.help("`atom_style bond` or `fix … property/atom mol` has them").into());
    }
    Ok(named.value)
}

/// Maximum number of bonds per particle, and the type a particle gets when it reaches it.
#[derive(Clone, Copy, PartialEq)]
struct Limit {
    /// 0: no limit.
    most: usize,
    becomes: u16,
}

/// Whether molecule IDs matter.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "value of molecule")]
enum Molecules {
    /// Molecules do not matter.
    Off,
    /// Only between molecules.
    #[word("inter")]
    Between,
    /// Only within molecules.
    #[word("intra")]
    Within,
}

/// Rule for the bonds to create.
#[derive(Clone)]
struct Rule {
    group: GroupId,
    types: [u16; 2],
    range: f64,
    /// Bond type.
    kind: u16,
    limits: [Limit; 2],
    molecules: Molecules,
}

#[derive(Clone)]
struct Declared {
    id: String,
    /// Key of the number created at the last check and in total, and of the state of the random stream.
    key: Numbers,
    /// Column of LAMMPS' bond counts.
    counts: Numbers,
    every: i64,
    rule: Rule,
    /// Probability and seed.
    chance: Option<(f64, u32)>,
    span: Span,
}

impl Declared {
    /// Whether particles can change their type.
    fn changes_types(&self) -> bool {
        let becomes =
            |k: usize| self.rule.limits[k].most > 0 && self.rule.limits[k].becomes != self.rule.types[k];
        becomes(0) || becomes(1)
    }

    /// Bonds these pairs.
    fn join(&self, w: &mut World, ends: &[[usize; 2]], mut count: Count) {
        for pair in ends {
            let tags = perigrain_world::bonds::ascending(pair.map(|i| w.particles.tag[i]));
            w.bonds.push(Bond::new(i32::from(self.rule.kind), tags));
            w.bonds.special.push(tags);
            for &i in pair {
                count.0[i] += 1;
                let own = w.particles.kind[i];
                let limit = self.rule.limits[usize::from(own != self.rule.types[0])];
                if limit.most > 0 && count.0[i] == limit.most && limit.becomes != own {
                    w.particles.kind[i] = limit.becomes;
                }
            }
        }
        w.bonds.special.sort_unstable();
        w.bonds.special.dedup();
        // Bonded pairs leave the neighbour lists, and types may have changed.
        w.rebuild.due = true;
        if self.changes_types() {
            w.rebuild.roster += 1;
        }
        if w.settings.lammps() {
            let n = w.n();
            *w.columns.scalar(self.counts, n) = count.0.iter().map(|k| *k as f64).collect();
        }
    }

    /// The number of bonds of the type at each particle.
    fn count(&self, w: &mut World) -> Count {
        let n = w.n();
        if w.settings.lammps() {
            return Count(w.columns.scalar(self.counts, n).iter().map(|k| *k as usize).collect());
        }
        Count::of(w, self.rule.kind)
    }
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        w.columns.remove(self.counts);
        let mut memory = vec![0.0, 0.0];
        memory.extend(self.chance.iter().flat_map(|(_, seed)| Marsaglia::new(*seed).stand()));
        w.memo.insert(self.key, memory);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key);
        w.columns.remove(self.counts);
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        if self.changes_types() && cx.world().families.is_some() {
            let text = "points of peridynamic solids keep their types during a run";
            let d = Diagnostic::error(Code::NOT_SUPPORTED, self.span, text);
            return Err(d.help("let `newtype` be the type they have").into());
        }
        let (me, key, slot) = (self.clone(), self.key, cx.slot(&format!("f_{}", self.id)));
        let known = move |w: &World| -> [f64; 2] {
            w.memo.get(key).and_then(|m| m.first_chunk().copied()).unwrap_or_default()
        };
        let w = cx.world();
        let counts = known(w).to_vec();
        w.slots.get_mut(slot).vector = counts;
        if w.settings.lammps() && w.columns.get_scalar(self.counts).is_none() {
            let (count, n) = (Count::of(w, self.rule.kind), w.n());
            *w.columns.scalar(self.counts, n) = count.0.iter().map(|k| *k as f64).collect();
        }
        let mut access = Needs::new().read(X | BOX | TAG | MASK | KIND | MOLECULE);
        access = access
            .write(BONDS | LISTS | SLOTS)
            .keep(MEMO | COLUMNS)
            .only(&[self.key.text(), self.counts.text()]);
        if self.changes_types() {
            access = access.write(KIND);
        }
        let act = move |w: &mut World, t: &Tick| {
            let [_, all] = known(w);
            let stand = w.memo.get(key).and_then(|m| m.get(2..)).unwrap_or_default().to_vec();
            let mut stream = me.chance.and_then(|(p, _)| Some((p, Marsaglia::resumed(&stand)?)));
            let count = me.count(w);
            let ends = chosen(w, &me.rule, &count, stream.as_mut());
            if !ends.is_empty() {
                me.join(w, &ends, count);
            }
            let made = [ends.len() as f64, all + ends.len() as f64];
            let rest = stream.iter().flat_map(|(_, stream)| stream.stand());
            w.memo.insert(key, made.into_iter().chain(rest).collect());
            publish(w, slot, t, 0.0, &made);
            Ok(())
        };
        let op = StepOp::new(format!("fix {} bond/create", self.id), Stage::PostIntegrate, access, act);
        Ok(vec![op.when(When::Every(self.every)).boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { vector: 2, ..Shape::default() }
    }
}

#[cfg(test)]
mod tests;
