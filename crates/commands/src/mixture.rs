//! `mixture`: kinds of grains with their shares, for fixes that insert them.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{self, naming};
use perigrain_styles::words::{At, OneType, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::{Ingredient, Mixture};

/// The command.
pub struct MixtureCommand;

impl Style for MixtureCommand {
    fn name(&self) -> &'static str {
        "mixture"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Names a mixture of grains, which `fix insert` puts into the scene.",
            text: "Not in LAMMPS. A share of the mass counts w/m grains, with m the mass of a grain of that kind; a share of the \
                   number counts w. Shares that do not sum to 1 are divided by their sum, with a warning. Of N grains that are \
                   inserted at a time, each kind gets N times its share of the number, rounded down; only the rest is drawn at random, \
                   by what was cut off. The largest grains find their places first. A later line with the same ID replaces the mixture for \
                   fixes below it; those above keep what they have. A restart file does not hold mixtures: the line \
                   stands again in the deck that reads it.\n\n\
                   Source: LIGGGHTS manual, fix particledistribution/discrete, whose shares are those of the mass by default; how many \
                   of each kind a batch holds: measured with LIGGGHTS 3.8.0.",
            example: "mixture gravel mass 32452843 sphere 2 0.0005 2500 0.3 sphere 2 0.0008 2500 0.7",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The mixture's ID.
    #[word(name = "ID", what = "the ID of a mixture")]
    id: Word,
    #[word(name = "shares")]
    by: By,
    /// The seed of the random numbers of fixes that insert it and have no seed of their own.
    #[word(name = "SEED", from = 1)]
    seed: u32,
    #[word(name = "kind", least = 1)]
    kinds: Vec<At<Grains>>,
}

/// What shares are parts of.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "meaning of shares")]
enum By {
    /// Shares are parts of the mass.
    Mass,
    /// Shares are parts of the number.
    Number,
}

/// A kind of grain.
#[derive(Words)]
#[word(what = "kind of grain")]
enum Grains {
    /// Spheres of a type: their diameter, density and share.
    Sphere(
        #[word(name = "TYPE", what = "the type")] OneType,
        #[word(name = "DIAM", what = "the diameter", positive)] f64,
        #[word(name = "DENS", what = "the density", positive)] f64,
        #[word(name = "SHARE", what = "the share", non_negative)] f64,
    ),
}

impl CommandStyle for MixtureCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        if !cx.world.particles.style.sphere {
            let d = Diagnostic::error(Code::WRONG_ORDER, cx.span, "mixture needs particles with a radius");
            return Err(d.help("put `atom_style sphere` at the top of the deck").into());
        }
        let Line { id: word, by, seed, kinds } = read(a, cx)?;
        let id = common::id(&word, "the mixture's ID")?;
        let list: Vec<Ingredient> = kinds
            .iter()
            .map(|At { value: Grains::Sphere(kind, diameter, density, share), .. }| Ingredient {
                kind: kind.0,
                radius: 0.5 * diameter,
                density: *density,
                share: *share,
            })
            .collect();
        let place = kinds[0].span.to(kinds[kinds.len() - 1].span);
        let sum: f64 = list.iter().map(|kind| kind.share).sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return fail(Code::BAD_VALUE, place, format!("the shares sum to {sum}"));
        }
        // As many digits as decks write shares with.
        if (sum - 1.0).abs() > 1e-6 {
            let text = format!("the shares sum to {}, not to 1: each is divided by that", common::about(sum));
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, place, text));
        }
        let mixture = Mixture::new(seed, list, by == By::Mass);
        Ok(naming(move |cx| {
            cx.world.mixtures.insert(id, mixture.into());
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{act, refused, scene};

    const SPHERES: &str = "atom_style sphere\nregion b block 0 1 0 1 0 1\ncreate_box 2 b\n";

    // 1/1 and 1/8 of the number, as the masses 1 : 8 of diameters 1 and 2 with equal shares of the mass.
    #[test]
    fn shares_become_those_of_the_number() {
        let w = scene(&format!("{SPHERES}mixture m mass 17 sphere 1 1 1 1 sphere 2 2 1 1"));
        let m = &w.mixtures["m"];
        assert_eq!((m.seed, m.kinds[0].kind, m.kinds[1].kind), (17, 2, 1));
        assert!((m.kinds[0].share - 1.0 / 9.0).abs() < 1e-15 && (m.kinds[1].share - 8.0 / 9.0).abs() < 1e-15);
    }

    #[test]
    fn mistakes_are_named() {
        let mut w = scene(SPHERES);
        for (line, word) in [
            ("mixture m", "mixture m"),
            ("mixture m volume 1 sphere 1 1 1 1", "volume"),
            ("mixture m mass 0 sphere 1 1 1 1", "0"),
            ("mixture m mass 1 sphere 3 1 1 1", "3"),
            ("mixture m mass 1 sphere 1 0 1 1", "0"),
            ("mixture m mass 1 sphere 1 1 -1 1", "-1"),
            ("mixture m mass 1 cube 1 1 1 1", "cube"),
            ("mixture a-b mass 1 sphere 1 1 1 1", "a-b"),
        ] {
            let (blame, text) = refused(&w, line);
            assert!(blame == word || word == "mixture m", "{line}: {blame}: {text}");
        }
        assert!(refused(&w, "mixture m number 1 sphere 1 1 1 0").1.contains("sum to 0"));
        act(&mut w, "mixture m number 1 sphere 1 1 1 1", &[]).unwrap();
        act(&mut w, "mixture m number 1 sphere 1 4 1 1", &[]).unwrap();
        assert_eq!(w.mixtures["m"].kinds[0].radius, 2.0);
        assert!(
            refused(&scene("region b block 0 1 0 1 0 1\ncreate_box 1 b"), "mixture m").1.contains("radius")
        );
    }
}
