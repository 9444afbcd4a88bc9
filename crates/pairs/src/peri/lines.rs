//! The lines of `pair_coeff` and `bond_coeff` for the laws of bonds as data, from the laws' table.

use super::materials::{ALPHA, Blend, FORM, HORIZON, S00};
use super::numbers::{Area, Elastic, Lasting, Micromodulus, Reach};
use super::options::Line as Options;
use perigrain_peri::law::style::Number;
use perigrain_peri::law::{LAWS, Style};
use perigrain_styles::words::{Alternative, Form, Grammar, Keyword, Kind, Part, Placeholder, Words};

/// The lines of a style: `own` behind its name, its coefficients, and `peri_modify` where its page describes that.
pub fn forms(law: &'static Style, own: &'static Grammar, options: bool) -> &'static [Form] {
    const COEFF: &str = "pair_coeff I J";
    let mut numbers = numbers(law);
    if law.unloading.is_some() {
        let words = unloading().map(|word| Alternative { word, about: "", parts: &[] });
        let kind = Kind::Choice(words.collect::<Vec<_>>().leak());
        let choice = Placeholder { name: "unloading", kind, about: UNLOADING, unit: "" };
        numbers.push(Part::Maybe(vec![Part::Word(choice)].leak()));
    }
    let mut forms = vec![
        Form::behind(own),
        Form::headed(COEFF, grammar(numbers, vec![])),
        Form::headed("pair_coeff I J material", grammar(vec![MATERIAL], keywords(law))),
        Form::headed("pair_coeff I J mix", Blend::GRAMMAR),
    ];
    if options {
        forms.push(Form::headed("peri_modify", Options::GRAMMAR));
    }
    forms.leak()
}

/// The lines of a style whose coefficients come from materials alone: `own` behind its name, and `peri_modify`.
pub fn of_materials(law: &'static Style, own: &'static Grammar) -> &'static [Form] {
    let forms = vec![
        Form::behind(own),
        Form::headed("pair_coeff I J material", grammar(vec![MATERIAL], keywords(law))),
        Form::headed("pair_coeff I J mix", Blend::GRAMMAR),
        Form::headed("peri_modify", Options::GRAMMAR),
    ];
    forms.leak()
}

/// The lines of a style of bonds: `own` behind its name, and coefficients of each law behind its name.
pub fn of_bonds(laws: impl Iterator<Item = &'static Style>, own: &'static Grammar) -> &'static [Form] {
    let of = |law: &'static Style| {
        let stiffness = stiffness(law);
        let parts = [stiffness].into_iter().chain(law.numbers.iter().map(place)).chain([LASTING]);
        Form::headed(format!("bond_coeff T {}", law.name).leak(), grammar(parts.collect(), vec![]))
    };
    [Form::behind(own)].into_iter().chain(laws.map(of)).collect::<Vec<_>>().leak()
}

/// The value of a keyword.
const VALUE: &[Part] = &[Part::number("value")];

const LASTING: Part = Part::All(Lasting::GRAMMAR);

const MATERIAL: Part =
    Part::Word(Placeholder { name: "ID", kind: Kind::Material, about: "The material's ID.", unit: "" });

fn grammar(parts: Vec<Part>, keywords: Vec<Keyword>) -> &'static Grammar {
    Box::leak(Box::new(Grammar { parts: parts.leak(), keywords: keywords.leak(), refused: &[] }))
}

fn stiffness(law: &Style) -> Part {
    Part::All(if law.bond_based { Micromodulus::GRAMMAR } else { Elastic::GRAMMAR })
}

/// A law's line of numbers.
fn numbers(law: &'static Style) -> Vec<Part> {
    let own = law.numbers.iter().map(place);
    let stiffness = [stiffness(law)].into_iter();
    match law.curve {
        Some(_) => {
            let horizon = [Part::All(Reach::GRAMMAR)];
            stiffness.chain(horizon).chain(own).chain([Part::All(Area::GRAMMAR)]).collect()
        }
        None => stiffness.chain([LASTING]).chain(own).collect(),
    }
}

/// A number of a law as a word.
fn place(number: &Number) -> Part {
    let about = sentence(number).leak();
    Part::Word(Placeholder { name: number.keyword, kind: Kind::Number, about, unit: "" })
}

fn sentence(number: &Number) -> String {
    let [what, _] = number.what;
    let (first, rest) = what.split_at(1);
    format!("{}{rest}.", first.to_uppercase())
}

/// The keywords behind a material's ID.
pub fn keywords(law: &'static Style) -> Vec<Keyword> {
    let own = law.numbers.iter().map(|number| Keyword {
        word: number.keyword,
        values: VALUE,
        about: sentence(number).leak(),
        // The peak of bonds that soften may follow from the material.
        default: if law.softens() { "" } else { Keyword::NEEDED },
        repeats: false,
    });
    let common: &[Keyword] = if law.softens() { &[] } else { &[S00, ALPHA] };
    let form = law.bond_based.then_some(FORM);
    let unloading = unloading().filter(|_| law.unloading.is_some());
    let unloading =
        unloading.map(|word| Keyword { word, values: &[], about: UNLOADING, default: "", repeats: false });
    let own = [HORIZON].into_iter().chain(own);
    own.chain(form).chain(common.iter().copied()).chain(unloading).collect()
}

const UNLOADING: &str = "What bonds that have flowed do on their way back; the last word of the line.";

/// What bonds that flow do on their way back, as words.
fn unloading() -> impl Iterator<Item = &'static str> {
    LAWS.iter().filter_map(|law| law.unloading)
}
