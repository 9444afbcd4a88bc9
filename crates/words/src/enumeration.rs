//! An enum: one of several words, each with words of its own behind it.

use super::attributes::{Said, imports, literals};
use super::parts::Field;
use proc_macro2::TokenStream;
use quote::quote;
use syn::{DataEnum, DeriveInput, Fields, Variant};

pub fn derive(input: &DeriveInput, data: &DataEnum) -> syn::Result<TokenStream> {
    let ident = &input.ident;
    let own = Said::read(&input.attrs)?;
    let (mut words, mut alternatives, mut arms) = (vec![], vec![], vec![]);
    for variant in &data.variants {
        let said = Said::read(&variant.attrs)?;
        if said.skip {
            continue;
        }
        let word = said.word.clone().unwrap_or_else(|| variant.ident.to_string().to_lowercase());
        let (parts, read) = fields(variant)?;
        let about = &said.about;
        alternatives.push(quote!(Alternative { word: #word, about: #about, parts: &[#(#parts),*] }));
        arms.push(quote!(#word => #read,));
        words.push(word);
    }
    let known = literals(&words);
    let refused = literals(&own.refused);
    let what = match own.own_what() {
        Some(what) => quote!(#what),
        None => quote!(what),
    };
    let imports = imports();
    Ok(quote! {
        const _: () = {
            #imports
            impl Value for #ident {
                const KIND: Kind = Kind::Choice(&[#(#alternatives),*]);
                #[allow(unreachable_code)]
                fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
                    Ok(match one_of(#what, args, #known, #refused)? {
                        #(#arms)*
                        _ => unreachable!("`one_of` takes none but these words"),
                    })
                }
                fn begins(word: &Word) -> bool {
                    let (known, refused): (&[&str], &[&str]) = (#known, #refused);
                    known.iter().chain(refused).any(|k| *k == word.text)
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
        let said = Said::read(&field.attrs)?;
        let value = match said.skip {
            true => quote!(Default::default()),
            false => {
                let field = Field::new(said, name.trim_end_matches('_'), &field.ty);
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
