//! `run_style respa`: levels of steps within each other, in LAMMPS' words.

use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail};
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{At, Grammar, Kind, Part, Value, Words};
use perigrain_world::{Respa, RunStyle};

/// Forces that LAMMPS orders: none may act in shorter steps than the one before.
const ORDER: [&str; 6] = ["bond", "angle", "dihedral", "improper", "pair", "kspace"];

/// A line's choices of levels, from 0; `None` where it makes none.
struct Choices {
    levels: [Option<(usize, Span)>; 6],
    subs: Option<(Vec<usize>, Span)>,
}

/// What a level keeps, without forces of particles.
const BYTES_PER_LEVEL: f64 = 1000.0;

/// The words of a line.
#[derive(Words)]
pub struct Line {
    #[word(name = "levels")]
    levels: Levels,
    /// The level of bonds, peridynamic ones included; 1 by default.
    #[word(keyword, name = "M", what = "the level of bond forces, from 1", from = 1)]
    bond: Option<At<usize>>,
    /// The level of angles, which exert nothing here.
    #[word(keyword, name = "M", what = "the level of angle forces, from 1", from = 1)]
    angle: Option<At<usize>>,
    /// The level of dihedrals, which there are none of here.
    #[word(keyword, name = "M", what = "the level of dihedral forces, from 1", from = 1)]
    dihedral: Option<At<usize>>,
    /// The level of impropers, which there are none of here.
    #[word(keyword, name = "M", what = "the level of improper forces, from 1", from = 1)]
    improper: Option<At<usize>>,
    /// The level of the pair style; N by default.
    #[word(keyword, name = "M", what = "the level of pair forces, from 1", from = 1)]
    pair: Option<At<usize>>,
    /// The level of each sub-style of pair_style hybrid, in its order.
    #[word(keyword, name = "levels", placed)]
    hybrid: Option<At<Hybrid>>,
    /// The level of long-range forces, which there are none of here.
    #[word(keyword, name = "M", what = "the level of kspace forces, from 1", from = 1)]
    kspace: Option<At<usize>>,
}

/// The levels of sub-styles.
#[derive(Words)]
struct Hybrid {
    #[word(name = "M", what = "the level of a sub-style, from 1", least = 1)]
    levels: Vec<At<Level>>,
}

/// A level, from 1.
#[derive(Clone, Copy)]
struct Level(usize);

impl Value for Level {
    const KIND: Kind = Kind::Whole;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.integer_from(1, what).map(|level| Self(level as usize))
    }
    fn begins(word: &Word) -> bool {
        word.text.parse::<i64>().is_ok()
    }
}

/// How many levels, and how many steps of each make one of the next.
struct Levels(Vec<i64>);

impl Value for Levels {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[Part::bare("N", Kind::Whole), Part::Many(&[Part::bare("n", Kind::Whole)], 0)],
        ..*Grammar::NONE
    });
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let count = args.count("the number of levels", BYTES_PER_LEVEL)?;
        let (mut loops, mut all) = (vec![], 1i64);
        for k in 1..count {
            let span = args.here();
            let what = format!("how many steps of level {k} fill one of level {}", k + 1);
            let times = args.integer_from(1, &what)?;
            all = all.saturating_mul(times);
            super::refuse_many(all, span)?;
            loops.push(times);
        }
        Ok(Self(loops))
    }
}

impl Line {
    /// The style, and the lines that list which forces act at which level.
    ///
    /// # Errors
    /// Levels that there are not, and those against LAMMPS' order.
    pub fn read(self) -> Result<(RunStyle, Vec<String>)> {
        let count = self.levels.0.len() + 1;
        let of = |named: Option<At<usize>>| named.map(|at| level(at.value, at.span, count)).transpose();
        let levels = [
            of(self.bond)?,
            of(self.angle)?,
            of(self.dihedral)?,
            of(self.improper)?,
            of(self.pair)?,
            of(self.kspace)?,
        ];
        let subs = match self.hybrid {
            Some(At { value, span, .. }) => {
                let each = value.levels.iter().map(|at| Ok(level(at.value.0, at.span, count)?.0));
                Some((each.collect::<Result<Vec<_>>>()?, span))
            }
            None => None,
        };
        Choices { levels, subs }.settle(self.levels.0)
    }
}

/// A level counted from 0, with its place.
fn level(level: usize, span: Span, count: usize) -> Result<(usize, Span)> {
    if level > count {
        let text = format!("there are {count} levels, and this is number {level}");
        return Err(Diagnostic::error(Code::BAD_VALUE, span, text)
            .help("LAMMPS takes such a level and leaves the forces out")
            .into());
    }
    Ok((level - 1, span))
}

/// The refusal of a pair style cut up by distance.
pub fn not_split(form: &str, word: &Word) -> Option<Diagnostics> {
    if form != "respa" || !["inner", "middle", "outer"].contains(&word.text.as_str()) {
        return None;
    }
    let text = format!("`{}` cuts pair forces up by distance, which no pair style here does", word.text);
    let d = Diagnostic::error(Code::NOT_SUPPORTED, word.span, text)
        .help("give the pair style one level (`pair M`), or each sub-style of hybrid its own (`hybrid M1 M2 …`)")
        .help("LAMMPS refuses it for its granular and peridynamic styles too");
    Some(d.into())
}

impl Choices {
    /// LAMMPS' defaults, and its order.
    fn settle(self, loops: Vec<i64>) -> Result<(RunStyle, Vec<String>)> {
        let outermost = loops.len();
        if let (Some((_, span)), Some(_)) = (&self.subs, self.levels[4]) {
            return fail(Code::CONFLICT, *span, "`pair` and `hybrid` exclude each other");
        }
        let subs = self.subs.as_ref().map(|(list, _)| list.clone());
        let mut levels = [0; 6];
        for k in 0..6 {
            let before = if k == 0 { 0 } else { levels[k - 1] };
            levels[k] = match (self.levels[k], ORDER[k], &subs) {
                (Some((level, _)), ..) => level,
                // Kspace belongs to the slowest sub-style then.
                (None, "pair", Some(list)) => list.iter().copied().max().unwrap_or(outermost),
                (None, "pair", None) => outermost,
                (None, ..) => before,
            };
            let bound = !matches!((ORDER[k], &subs), ("pair" | "kspace", Some(_)));
            if let (true, true, Some(span)) = (bound, levels[k] < before, self.blame(k)) {
                let text = format!(
                    "{} forces at level {} would act in shorter steps than {} forces at level {}",
                    ORDER[k],
                    levels[k] + 1,
                    ORDER[k - 1],
                    before + 1
                );
                return Err(Diagnostic::error(Code::CONFLICT, span, text)
                    .help(format!("LAMMPS' order from short steps to long ones: {}", ORDER.join(", ")))
                    .into());
            }
        }
        let lines = describe(&levels, subs.as_deref(), outermost);
        if outermost == 0 {
            return Ok((RunStyle::Verlet, lines));
        }
        Ok((RunStyle::Respa(Respa { loops, bond: levels[0], pair: levels[4], subs }), lines))
    }

    /// The word that is to blame where force `k` stands below the one before.
    fn blame(&self, k: usize) -> Option<Span> {
        self.levels[..=k].iter().rev().flatten().map(|(_, span)| *span).next()
    }
}

/// LAMMPS' lines about its levels.
fn describe(levels: &[usize; 6], subs: Option<&[usize]>, outermost: usize) -> Vec<String> {
    let mut lines = vec!["Respa levels:".to_string()];
    for level in 0..=outermost {
        let mut line = format!("  {} =", level + 1);
        for (name, at) in ORDER.iter().zip(levels) {
            match (*name, subs) {
                ("pair", Some(list)) => {
                    let here = (1..).zip(list).filter(|(_, at)| **at == level);
                    here.for_each(|(k, _): (usize, _)| line += &format!(" hybrid-{k}"));
                }
                _ if *at == level => line += &format!(" {name}"),
                _ => {}
            }
        }
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::refused;
    use perigrain_world::World;

    fn read(words: &str) -> RunStyle {
        super::super::tests::read(&format!("respa {words}"))
    }

    #[test]
    fn forces_that_are_not_named_stand_where_lammps_puts_them() {
        let respa = |loops: &[i64], bond, pair, subs: Option<&[usize]>| {
            let (loops, subs) = (loops.to_vec(), subs.map(<[usize]>::to_vec));
            RunStyle::Respa(Respa { loops, bond, pair, subs })
        };
        assert_eq!(read("1"), RunStyle::Verlet);
        assert_eq!(read("1 bond 1 pair 1"), RunStyle::Verlet);
        assert_eq!(read("2 8"), respa(&[8], 0, 1, None));
        assert_eq!(read("3 4 2 pair 2"), respa(&[4, 2], 0, 1, None));
        assert_eq!(read("4 2 2 2 bond 1 dihedral 2 pair 3 kspace 4"), respa(&[2, 2, 2], 0, 2, None));
        assert_eq!(read("3 4 2 bond 1 hybrid 2 2 1 kspace 3"), respa(&[4, 2], 0, 1, Some(&[1, 1, 0])));
        assert_eq!(read("2 5 hybrid 1 2"), respa(&[5], 0, 1, Some(&[0, 1])));
    }

    #[test]
    fn mistakes_are_refused_at_their_word() {
        for (words, word) in [
            ("0", "0"),
            ("2", "2"),
            ("2 0", "0"),
            ("3 2 pair 1", "pair"),
            ("2 4 pair 3", "3"),
            ("2 4 pair 0", "0"),
            ("2 4 hybrid", "hybrid"),
            ("2 4 hybrid 1 2 3", "3"),
            ("2 4 hybrid 1 2 pair 2", "hybrid"),
            ("2 4 bond 2 pair 1", "1"),
            ("2 4 angle 2 bond 1 dihedral 1", "1"),
            ("2 4 kspace 1", "1"),
            ("2 4 inner 1 4 5 outer 2", "inner"),
            ("2 4 pairs 1", "pairs"),
        ] {
            let (found, _) = refused(&World::default(), &format!("run_style respa {words}"));
            assert_eq!(found, word, "{words}");
        }
    }
}
