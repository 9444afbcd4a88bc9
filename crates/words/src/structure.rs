//! A struct: words in order, then keywords.

use super::attributes::{Attributes, imports, literals, wrong};
use super::parts::Field;
use proc_macro2::TokenStream;
use quote::quote;
use syn::{DataStruct, DeriveInput, Fields, Ident};

/// The parts of both implementations.
#[derive(Default)]
struct Built {
    parts: Vec<TokenStream>,
    keywords: Vec<TokenStream>,
    /// `let field = …;`, in the order of the line.
    begin: Vec<TokenStream>,
    /// `"word" => …`.
    arms: Vec<TokenStream>,
    /// Structs whose keywords stand here, too.
    nested: Vec<TokenStream>,
    fields: Vec<Ident>,
}

pub fn derive(input: &DeriveInput, data: &DataStruct) -> syn::Result<TokenStream> {
    let ident = &input.ident;
    let Fields::Named(fields) = &data.fields else {
        return wrong(ident.span(), "the fields of a line of words have names");
    };
    let own = Attributes::read(&input.attrs)?;
    let mut built = Built::default();
    for field in &fields.named {
        let (Some(name), given) = (&field.ident, Attributes::read(&field.attrs)?) else { continue };
        built.add(name, given, &field.ty)?;
    }
    let Built { parts, keywords, begin, arms, nested, fields } = built;
    let refused = literals(&own.refused);
    let imports = imports();
    let what = own.own_what().unwrap_or("a keyword");
    let some = match own.least {
        0 => quote!(),
        _ => quote!(if args.is_empty() {
            args.expect(#what)?;
        }),
    };
    Ok(quote! {
        #[allow(clippy::needless_question_mark)]
        const _: () = {
            #imports
            impl Words for #ident {
                const GRAMMAR: &'static Grammar =
                    &Grammar { parts: &[#(#parts),*], keywords: &[#(#keywords),*], refused: #refused };
                fn begin(args: &mut Args, cx: &BuildCx) -> Result<Self> {
                    #(#begin)*
                    #some
                    Ok(Self { #(#fields),* })
                }
                fn keyword(&mut self, word: &Word, args: &mut Args, cx: &BuildCx) -> Result<bool> {
                    match word.text.as_str() {
                        #(#arms)*
                        _ => return Ok(false #(|| #nested)*),
                    }
                    #[allow(unreachable_code)]
                    Ok(true)
                }
            }
            impl Value for #ident {
                const KIND: Kind = Kind::Words(<Self as Words>::GRAMMAR);
                fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
                    inner(args, cx)
                }
            }
        };
    })
}

impl Built {
    fn add(&mut self, ident: &Ident, given: Attributes, ty: &syn::Type) -> syn::Result<()> {
        self.fields.push(ident.clone());
        if given.skip {
            self.begin.push(quote!(let #ident = Default::default();));
            return Ok(());
        }
        if given.flatten {
            self.parts.push(quote!(Part::All(<#ty as Words>::GRAMMAR)));
            self.begin.push(quote!(let #ident = <#ty as Words>::begin(args, cx)?;));
            self.nested.push(quote!(Words::keyword(&mut self.#ident, word, args, cx)?));
            return Ok(());
        }
        let name = ident.to_string();
        let name = name.trim_start_matches("r#").trim_end_matches('_');
        let field = Field::new(given, name, ty);
        let Some(word) = field.keyword(name) else {
            self.parts.append(&mut field.parts()?);
            let value = field.read()?;
            self.begin.push(quote!(let #ident = #value;));
            return Ok(());
        };
        let (values, repeats, given) = (field.values()?, field.repeats()?, &field.given);
        let about = &given.about;
        let shown =
            given.shown.clone().or_else(|| given.default.as_ref().and_then(shown)).unwrap_or_default();
        self.keywords.push(quote! {
            Keyword { word: #word, values: &[#(#values),*], about: #about, default: #shown, repeats: #repeats }
        });
        let default = match &given.default {
            Some(value) => quote!(#value),
            None => quote!(Default::default()),
        };
        self.begin.push(quote!(let #ident: #ty = #default;));
        let value = field.read_value()?;
        if given.once {
            let given = if field.is_list()? {
                quote!(!self.#ident.is_empty())
            } else {
                quote!(self.#ident.is_some())
            };
            self.arms.push(quote!(#word if #given => return twice(word),));
        }
        self.arms.push(match field.is_list()? && !given.list {
            true => quote!(#word => self.#ident.push(#value),),
            false => quote!(#word => self.#ident = #value,),
        });
        Ok(())
    }
}

/// A default as the manual shows it: numbers, `yes` and `no`, and choices by their names.
fn shown(default: &syn::Expr) -> Option<String> {
    match default {
        syn::Expr::Lit(value) => Some(match &value.lit {
            syn::Lit::Int(k) => k.base10_digits().to_string(),
            syn::Lit::Float(x) => x.base10_digits().trim_end_matches(".0").to_string(),
            syn::Lit::Bool(b) => if b.value { "yes" } else { "no" }.to_string(),
            syn::Lit::Str(text) => text.value(),
            _ => return None,
        }),
        syn::Expr::Path(path) if path.path.segments.len() > 1 => {
            Some(path.path.segments.last()?.ident.to_string().to_lowercase())
        }
        _ => None,
    }
}
