//! `mixture`: kinds of grains with their shares, for fixes that insert them.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::cformat::general;
use perigrain_geometry::union::Union;
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{self, naming};
use perigrain_styles::molecules::{check_types, fits, named};
use perigrain_styles::words::{At, Nullable, OneType, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::{Clump, Ingredient, Mixture, Template};
use std::sync::Arc;

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
                   by what was cut off. The largest grains find their places first.\n\n\
                   `mol` is a grain of several spheres, which `clump` or `molecule` describes: mass, centre and moments of inertia are \
                   those of the space that the spheres fill, at one density. What several spheres have in common counts once; the error \
                   is below 1e-9. The masses of the spheres sum to that of the grain, in the ratio of their volumes. Where the template \
                   has a mass of its own, the density gives the volume. With `fix rigid/small … mol` such grains move as bodies.\n\n\
                   A later line with the same ID replaces the mixture for fixes below it; those above keep what they have. A restart file does not hold mixtures: the line \
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
    /// Copies of a molecule template of spheres: its ID, their density (`NULL` where the template has a mass), and their share.
    Mol(
        #[word(name = "TEMPLATE", kind = Kind::Molecule, what = "a molecule template")] Word,
        #[word(name = "DENS", what = "the density")] At<Nullable<f64>>,
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
        let list: Vec<Ingredient> =
            kinds.iter().map(|kind| ingredient(&kind.value, cx)).collect::<Result<_>>()?;
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
            for clump in mixture.clumps() {
                let (name, t) = (&clump.name, &clump.template);
                let [volume, mass] = [clump.volume, clump.mass].map(|x| general(x, 10));
                cx.print(format!("Grain {name} of {} spheres: volume {volume}, mass {mass}", t.count));
                // The masses of single spheres hold for the mixture alone.
                let masses = cx.world.templates.get(name).map_or(vec![], |set| set[0].masses.clone());
                cx.world.templates.insert(name.clone(), vec![Template { masses, ..t.clone() }].into());
            }
            cx.world.mixtures.insert(id, mixture.into());
            Ok(())
        }))
    }
}

/// A kind of grain of a line.
fn ingredient(grains: &Grains, cx: &BuildCx) -> Result<Ingredient> {
    let (word, density, share) = match grains {
        Grains::Sphere(kind, diameter, density, share) => {
            let (kind, radius) = (kind.0, 0.5 * diameter);
            return Ok(Ingredient { kind, radius, density: *density, share: *share, clump: None });
        }
        Grains::Mol(word, density, share) => (word, density, *share),
    };
    let set = named(word, cx)?;
    let wrong = |text: String, help: &str| -> Result<Ingredient> {
        Err(Diagnostic::error(Code::BAD_VALUE, word.span, text).help(help).into())
    };
    let [t] = &*set else {
        let text = format!("template `{}` has {} molecules", word.text, set.len());
        return wrong(text, "declare a template for each of them");
    };
    fits(t, cx, word.span)?;
    check_types(t, 0, cx.world.types, word.span)?;
    if t.radii.len() != t.count || t.count < 2 {
        let text = format!("template `{}` is not made of two spheres or more", word.text);
        return wrong(text, "give the molecule file a section `Diameters`, or declare it with `clump`");
    }
    let Some(union) = Union::new(&t.places, &t.radii) else {
        return wrong(format!("template `{}` has no spheres", word.text), "declare it with `clump`");
    };
    let clump = weighed(t, &union, density, word)?;
    let kind = t.kinds.first().copied().unwrap_or(1);
    let (radius, density) = (clump.reach(), clump.mass / clump.volume);
    Ok(Ingredient { kind, radius, density, share, clump: Some(Arc::new(clump)) })
}

/// The grain of a template at a density.
fn weighed(t: &Template, union: &Union, density: &At<Nullable<f64>>, word: &Word) -> Result<Clump> {
    let given = density.value.0;
    if given.is_some_and(|rho| !(rho > 0.0 && rho.is_finite())) {
        return fail(Code::BAD_VALUE, density.span, "the density must be positive");
    }
    // What an earlier mixture gave is made anew.
    let own = t.mass.filter(|_| t.density.is_none());
    let (mass, volume) = match (own, given) {
        (Some(mass), Some(rho)) => (mass, mass / rho),
        (Some(mass), None) => (mass, union.volume),
        (None, Some(rho)) => (rho * union.volume, union.volume),
        (None, None) => {
            let text = format!("template `{}` has no mass, so its grains need a density", word.text);
            return fail(Code::BAD_VALUE, density.span, text);
        }
    };
    if let (Some(before), Some(rho)) = (t.density, given)
        && before != rho
    {
        let text = format!("grains of template `{}` have the density {before} in another mixture", word.text);
        let d = Diagnostic::error(Code::CONFLICT, density.span, text);
        return Err(d.help("declare another template of the same spheres for this density").into());
    }
    let (com, inertia) = match own {
        Some(_) => (t.com.unwrap_or(union.centre), t.inertia),
        None => (union.centre, None),
    };
    let inertia = inertia.unwrap_or(union.inertia.map(|i| i * mass / union.volume));
    let cubes: f64 = t.radii.iter().map(|r| r.powi(3)).sum();
    let template = Template {
        masses: t.radii.iter().map(|r| mass * r.powi(3) / cubes).collect(),
        mass: Some(mass),
        com: Some(com),
        inertia: Some(inertia),
        density: if own.is_some() { None } else { given },
        ..t.clone()
    };
    Ok(Clump { name: word.text.clone(), template, centre: com, volume, mass })
}

#[cfg(test)]
mod tests {
    use super::super::testing::{act, more, refused, scene};

    const SPHERES: &str = "atom_style sphere\nregion b block 0 1 0 1 0 1\ncreate_box 2 b\n";

    // 1/1 and 1/8 of the number, as the masses 1 : 8 of diameters 1 and 2 with equal shares of the mass.
    #[test]
    fn shares_become_those_of_the_number() {
        let w = scene(&format!("{SPHERES}mixture m mass 17 sphere 1 1 1 1 sphere 2 2 1 1"));
        let m = &w.mixtures["m"];
        assert_eq!((m.seed, m.kinds[0].kind, m.kinds[1].kind), (17, 2, 1));
        assert!((m.kinds[0].share - 1.0 / 9.0).abs() < 1e-15 && (m.kinds[1].share - 8.0 / 9.0).abs() < 1e-15);
    }

    // Specification: r 5 mm at 0, 5 and 10 mm, density 2500 (LIGGGHTS 3.8.0: 3.110495e-3, of random points).
    #[test]
    fn overlaps_count_once() {
        let mut w = scene(SPHERES);
        more(
            &mut w,
            "clump c 1 spheres 0 0 0 .005 .005 0 0 .005 .01 0 0 .005\nmixture m mass 17 mol c 2500 1",
        );
        let clump = w.mixtures["m"].clumps().next().unwrap().clone();
        assert!((clump.volume / 1.243547092e-6 - 1.0).abs() < 1e-8, "{clump:?}");
        assert!((clump.mass / 3.108867730e-3 - 1.0).abs() < 1e-8);
        assert!((clump.template.masses.iter().sum::<f64>() / clump.mass - 1.0).abs() < 1e-14);
        assert!(
            (clump.density() * 3.0 / 2500.0 - clump.volume / (4.0 / 3.0 * std::f64::consts::PI * 1.25e-7))
                .abs()
                < 1e-9
        );
        assert!((clump.reach() - 0.01).abs() < 1e-10);
        // The template has them for rigid bodies; seven digits in the specification.
        let t = &w.templates["c"][0];
        let [xx, yy, ..] = t.inertia.unwrap();
        assert!((xx / 3.384984e-8 - 1.0).abs() < 2e-7 && (yy / 9.597606e-8 - 1.0).abs() < 2e-7);
        assert!((t.com.unwrap()[0] - 0.005).abs() < 1e-10 && t.masses.is_empty());
        assert_eq!(refused(&w, "mixture n mass 17 mol c 2600 1").0, "2600");
        assert_eq!(refused(&w, "mixture n mass 17 mol d 2600 1").0, "d");
        assert_eq!(refused(&w, "mixture n mass 17 mol c 0 1").0, "0");
        more(&mut w, "mixture n mass 17 mol c 2500 1 sphere 1 0.01 2500 1");
        more(
            &mut w,
            "clump e 1 spheres 0 0 0 .005 .005 0 0 .005 mass 2 inertia 1 2 3 0 0 0\nmixture o mass 17 mol e NULL 1",
        );
        assert_eq!(w.mixtures["o"].mean_mass(), 2.0);
        assert_eq!(w.templates["e"][0].inertia, Some([1.0, 2.0, 3.0, 0.0, 0.0, 0.0]));
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
