//! `#[derive(Words)]`: the words of a line, declared once.
//!
//! A struct's fields are the words behind a style's name, in order, and its keywords; an enum's variants are the words of which
//! one stands. From the declaration come the reading of the line with its messages, the syntax line, the table on the manual's
//! page, and what Tab and editors offer (`perigrain_styles::words`).
//!
//! A field's doc comment is its sentence in the manual. Its first words, up to a comma, colon, bracket or full stop, are its
//! name in messages; a bracket behind them is its unit: `/// The drag coefficient γ [force/velocity].` A keyword of `yes` or `no` is
//! called by itself. A field may say:
//!
//! | in `#[word(…)]` | meaning |
//! |---|---|
//! | `name = "lo hi"` | placeholders of the syntax line, one for each word; without it the field's own name |
//! | `what = "the seed"` | the name in messages; `{}` in it is the placeholder of the word that is read |
//! | `keyword`, `keyword = "type"` | a keyword (by its own name) with values; may stand in any order behind the others |
//! | `flag` | a keyword without values: whether it stands there |
//! | `default = 1.0` | the value of a keyword that is not there; without it `Default::default()` |
//! | `shown = "none"` | what the manual shows as that default; `"required"` where the keyword must stand there |
//! | `list` | the values of a keyword are all words up to the next keyword |
//! | `once` | a keyword (an `Option` or a `Vec`) of which a second one is refused |
//! | `least = 1` | how many of a list must be there |
//! | `positive`, `non_negative`, `from = 1` | bounds of numbers |
//! | `placed` | the place of an `At` is that of the keyword, of an `At` in it that of the value; a `flag` is an `Option<Span>` then |
//! | `like = Type` | it is read as this type, from which it can be made |
//! | `with = path, kind = Kind::Number` | a reading function of its own (or a call that makes one), and what it reads |
//! | `flatten` | the words and keywords of another struct stand here |
//! | `skip` | no word at all: `Default::default()` |
//!
//! A struct may say `#[word(least = 1)]`: one of its keywords must be there (in messages `what`, or "a keyword"). A default may look at the scene: `cx` is at hand.
//!
//! An enum says `#[word(what = "direction")]`, its variants `#[word("word")]` where the word is not the variant's name in small
//! letters, and `#[word(once)]` where a keyword of an enum is shown and offered once. Both may list words of LAMMPS that are refused by name: `#[word(refused = "gradient")]`.
//!
//! | in `#[word(…)]` of an enum | meaning |
//! |---|---|
//! | `style` | other words are unknown styles, not unknown keywords |
//! | `of = Type` | each variant names that of another type, which is made from it: for `like` |
//! | `keywords` | the words are keywords, of which each counts, in their order: the line has an `Each` of it, flattened |
//! | `forms = "head"` | the words are forms of a line, with the words before them; each has a struct with its words and keywords |
//! | `foreign = path` | what refuses keywords of other forms: from the form's word and the keyword to an error, if it has one |
//!
//! Types of fields: what has `Value`; `Option` (may be left out), `Vec` (several), tuples, arrays and `At` (with its place) of
//! those.

mod attributes;
mod enumeration;
mod parts;
mod structure;

use proc_macro::TokenStream;
use syn::{Data, DeriveInput, parse_macro_input};

/// See the crate's page.
#[proc_macro_derive(Words, attributes(word))]
pub fn words(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    let out = match &input.data {
        Data::Struct(data) => structure::derive(&input, data),
        Data::Enum(data) => enumeration::derive(&input, data),
        Data::Union(_) => Err(syn::Error::new_spanned(&input.ident, "a union is no line of words")),
    };
    out.unwrap_or_else(|e| e.to_compile_error()).into()
}
