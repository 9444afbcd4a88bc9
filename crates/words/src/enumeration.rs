//! An enum: one of several words, each with words of its own behind it.

use super::attributes::{Attributes, imports, literals, wrong};
use super::parts::Field;
use proc_macro2::TokenStream;
use quote::quote;
use syn::{DataEnum, DeriveInput, Fields, Variant};

/// The variants, each with its word.
#[derive(Default)]
struct Built {
    words: Vec<String>,
    abouts: Vec<String>,
    /// Whether each time that a keyword stands there is shown.
    repeats: Vec<bool>,
    parts: Vec<Vec<TokenStream>>,
    /// The expressions that read the words behind a variant's.
    reads: Vec<TokenStream>,
}

pub fn derive(input: &DeriveInput, data: &DataEnum) -> syn::Result<TokenStream> {
    let own = Attributes::read(&input.attrs)?;
    if let Some(head) = &own.forms {
        return forms(input, data, &own, head);
    }
    let mut built = Built::default();
    for variant in &data.variants {
        let given = Attributes::read(&variant.attrs)?;
        if given.skip {
            continue;
        }
        let (parts, read) = fields(variant)?;
        built.words.push(word(&given, variant));
        built.abouts.push(given.about);
        built.repeats.push(!given.once);
        built.parts.push(parts);
        built.reads.push(read);
    }
    let body = if own.keywords { keywords(input, &own, &built) } else { choice(input, &own, &built) };
    let (of, imports) = (of(input, data, &own), imports());
    Ok(quote! {
        #[allow(clippy::needless_question_mark)]
        const _: () = {
            #imports
            #body
            #of
        };
    })
}

/// A variant's word.
fn word(given: &Attributes, variant: &Variant) -> String {
    given.word.clone().unwrap_or_else(|| variant.ident.to_string().to_lowercase())
}

/// The call that takes one of the words.
fn taken(own: &Attributes, words: &[String]) -> TokenStream {
    let (known, refused) = (literals(words), literals(&own.refused));
    let what = match own.own_what() {
        Some(what) => quote!(#what),
        None => quote!(what),
    };
    match own.style {
        true => quote!(style_of(#what, args, #known, #refused)?),
        false => quote!(one_of(#what, args, #known, #refused)?),
    }
}

/// One of several words.
fn choice(input: &DeriveInput, own: &Attributes, built: &Built) -> TokenStream {
    let (ident, Built { words, abouts, parts, reads, .. }) = (&input.ident, built);
    let (known, refused, taken) = (literals(words), literals(&own.refused), taken(own, words));
    quote! {
        impl Value for #ident {
            const KIND: Kind =
                Kind::Choice(&[#(Alternative { word: #words, about: #abouts, parts: &[#(#parts),*] }),*]);
            #[allow(unreachable_code)]
            fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
                Ok(match #taken {
                    #(#words => #reads,)*
                    _ => unreachable!("none but these words are taken"),
                })
            }
            fn begins(word: &Word) -> bool {
                let (known, refused): (&[&str], &[&str]) = (#known, #refused);
                known.iter().chain(refused).any(|k| *k == word.text)
            }
        }
    }
}

/// Keywords of a line, of which each counts.
fn keywords(input: &DeriveInput, own: &Attributes, built: &Built) -> TokenStream {
    let (ident, Built { words, abouts, repeats, parts, reads }) = (&input.ident, built);
    let refused = literals(&own.refused);
    quote! {
        impl Keywords for #ident {
            const GRAMMAR: &'static Grammar = &Grammar {
                parts: &[],
                keywords: &[#(Keyword {
                    word: #words, values: &[#(#parts),*], about: #abouts, default: "", repeats: #repeats
                }),*],
                refused: #refused,
            };
            fn keyword(word: &Word, args: &mut Args, cx: &BuildCx) -> Result<Option<Self>> {
                Ok(Some(match word.text.as_str() {
                    #(#words => #reads,)*
                    _ => return Ok(None),
                }))
            }
        }
    }
}

/// The variant of another type that each variant names.
fn of(input: &DeriveInput, data: &DataEnum, own: &Attributes) -> TokenStream {
    let (Some(of), ident) = (&own.of, &input.ident) else { return quote!() };
    let variants: Vec<_> = data.variants.iter().map(|v| &v.ident).collect();
    quote! {
        impl From<#ident> for #of {
            fn from(named: #ident) -> Self {
                match named {
                    #(#ident::#variants => Self::#variants,)*
                }
            }
        }
    }
}

/// Forms of a line: a word says which words and keywords stand behind it.
fn forms(input: &DeriveInput, data: &DataEnum, own: &Attributes, head: &str) -> syn::Result<TokenStream> {
    let ident = &input.ident;
    let (mut words, mut forms, mut reads) = (vec![], vec![], vec![]);
    for variant in &data.variants {
        let (given, name) = (Attributes::read(&variant.attrs)?, &variant.ident);
        let word = word(&given, variant);
        let (head, about) = (format!("{head} {word}").trim().to_string(), &given.about);
        let foreign = match &own.foreign {
            Some(foreign) => quote!(|w| #foreign(#word, w)),
            None => quote!(|_| None),
        };
        let (grammar, read) = match &variant.fields {
            Fields::Unit => (quote!(Grammar::NONE), quote!({ nothing(args, #foreign)?; Self::#name })),
            Fields::Unnamed(one) if one.unnamed.len() == 1 => {
                let ty = &one.unnamed[0].ty;
                (quote!(<#ty as Words>::GRAMMAR), quote!(Self::#name(read_or(args, cx, #foreign)?)))
            }
            _ => return wrong(name.span(), "a form has one struct, which declares its words"),
        };
        forms.push(quote!(Form { head: #head, about: #about, grammar: #grammar }));
        words.push(word);
        reads.push(read);
    }
    let (taken, imports) = (taken(own, &words), imports());
    Ok(quote! {
        #[allow(clippy::needless_question_mark)]
        const _: () = {
            #imports
            impl Forms for #ident {
                const FORMS: &'static [Form] = &[#(#forms),*];
                #[allow(unreachable_code)]
                fn form(args: &mut Args, cx: &BuildCx) -> Result<Self> {
                    Ok(match #taken {
                        #(#words => #reads,)*
                        _ => unreachable!("none but these words are taken"),
                    })
                }
            }
        };
    })
}

/// The words behind a variant's, and the expression that reads it.
fn fields(variant: &Variant) -> syn::Result<(Vec<TokenStream>, TokenStream)> {
    let ident = &variant.ident;
    let (mut parts, mut values) = (vec![], vec![]);
    for (k, field) in variant.fields.iter().enumerate() {
        let name = field.ident.as_ref().map_or_else(|| format!("value{}", k + 1), ToString::to_string);
        let given = Attributes::read(&field.attrs)?;
        let value = match given.skip {
            true => quote!(Default::default()),
            false => {
                let field = Field::new(given, name.trim_end_matches('_'), &field.ty);
                parts.append(&mut field.parts()?);
                field.read()?
            }
        };
        values.push(match &field.ident {
            Some(name) => quote!(#name: #value),
            None => value,
        });
    }
    let read = match &variant.fields {
        Fields::Named(_) => quote!(Self::#ident { #(#values),* }),
        Fields::Unnamed(_) => quote!(Self::#ident(#(#values),*)),
        Fields::Unit => quote!(Self::#ident),
    };
    Ok((parts, read))
}
