//! One field as words: what the grammar says of it, and the expression that reads it.

use super::attributes::{Attributes, wrong};
use proc_macro2::TokenStream;
use quote::quote;
use syn::spanned::Spanned;
use syn::{Expr, GenericArgument, Lit, PathArguments, Type};

/// A field's words.
pub struct Field {
    pub given: Attributes,
    /// Its placeholders, one for each word that a value has.
    names: Vec<String>,
    what: String,
    ty: Type,
}

/// How a type is made of others.
enum Shape<'a> {
    One,
    Maybe(&'a Type),
    Many(&'a Type),
    Placed(&'a Type),
    Tuple(Vec<&'a Type>),
    Array(&'a Type, usize),
}

impl Field {
    /// A field of this name, which stands in the syntax line unless the field says another.
    pub fn new(given: Attributes, name: &str, ty: &Type) -> Self {
        let names = given.name.as_deref().unwrap_or(name).split_whitespace().map(String::from).collect();
        let what = match is_switch(ty) && given.own_what().is_none() {
            true => given.keyword.clone().flatten().unwrap_or_else(|| name.to_string()),
            false => given.what(name),
        };
        Self { what, names, given, ty: ty.clone() }
    }

    /// The keyword, if it is one.
    pub fn keyword(&self, name: &str) -> Option<String> {
        self.given.keyword.as_ref().map(|k| k.clone().unwrap_or_else(|| name.to_string()))
    }

    /// Its place in the grammar, where it stands in order.
    pub fn parts(&self) -> syn::Result<Vec<TokenStream>> {
        let mut names = self.names.iter();
        let parts = match shape(&self.ty)? {
            Shape::Maybe(of) => {
                let inner = self.of(of, &mut names)?;
                vec![quote!(Part::Maybe(&[#(#inner),*]))]
            }
            Shape::Many(of) => {
                let (inner, least) = (self.of(of, &mut names)?, self.given.least);
                vec![quote!(Part::Many(&[#(#inner),*], #least))]
            }
            _ => self.of(&self.ty, &mut names)?,
        };
        match names.next() {
            Some(name) => wrong(self.ty.span(), &format!("no word is left that `{name}` could name")),
            None => Ok(parts),
        }
    }

    /// The words behind it, where it is a keyword.
    pub fn values(&self) -> syn::Result<Vec<TokenStream>> {
        if self.given.flag {
            return Ok(vec![]);
        }
        match shape(&self.ty)? {
            Shape::Many(_) if self.given.list => self.parts(),
            Shape::Maybe(of) | Shape::Many(of) => self.of(of, &mut self.names.iter()),
            _ => self.of(&self.ty, &mut self.names.iter()),
        }
    }

    /// Whether it holds several values.
    pub fn is_list(&self) -> syn::Result<bool> {
        Ok(matches!(shape(&self.ty)?, Shape::Many(_)))
    }

    /// Whether each time that the keyword stands there counts.
    pub fn repeats(&self) -> syn::Result<bool> {
        Ok(self.is_list()? && !self.given.list && !self.given.once)
    }

    fn of<'a>(
        &self,
        ty: &Type,
        names: &mut impl Iterator<Item = &'a String>,
    ) -> syn::Result<Vec<TokenStream>> {
        let all = |types: Vec<&Type>, names: &mut dyn Iterator<Item = &'a String>| {
            let mut parts = vec![];
            for ty in types {
                parts.append(&mut self.of_one(ty, names)?);
            }
            Ok(parts)
        };
        match shape(ty)? {
            Shape::Tuple(types) => all(types, names),
            Shape::Array(of, count) => all(vec![of; count], names),
            Shape::Placed(of) => self.of(of, names),
            _ => self.of_one(ty, names),
        }
    }

    fn of_one(&self, ty: &Type, names: &mut dyn Iterator<Item = &String>) -> syn::Result<Vec<TokenStream>> {
        if let Shape::Placed(of) = shape(ty)? {
            return self.of_one(of, names);
        }
        let Some(name) = names.next() else {
            return wrong(ty.span(), "say in `name` how each word is called");
        };
        let (about, unit) = (&self.given.about, &self.given.unit);
        let kind = match (&self.given.kind, &self.given.like) {
            (Some(kind), _) => quote!(#kind),
            (None, Some(like)) => quote!(<#like as Value>::KIND),
            (None, None) => quote!(<#ty as Value>::KIND),
        };
        Ok(vec![quote!(Part::Word(Placeholder { name: #name, kind: #kind, about: #about, unit: #unit }))])
    }

    /// The expression that reads it in order.
    pub fn read(&self) -> syn::Result<TokenStream> {
        self.reading(&self.ty, true, 0)
    }

    /// The expression that reads the words behind the keyword: of a list one of its members, unless all stand there.
    pub fn read_value(&self) -> syn::Result<TokenStream> {
        if self.given.flag {
            return Ok(if self.given.placed { quote!(Some(word.span)) } else { quote!(true) });
        }
        match shape(&self.ty)? {
            Shape::Maybe(of) => {
                let value = self.reading(of, false, 0)?;
                Ok(quote!(Some(#value)))
            }
            Shape::Many(of) if !self.given.list => self.reading(of, false, 0),
            _ => self.reading(&self.ty, true, 0),
        }
    }

    /// The expression that reads a type; `k` counts the words of a group.
    fn reading(&self, ty: &Type, open: bool, k: usize) -> syn::Result<TokenStream> {
        let what = self.what.replace("{}", self.names.get(k).map_or("", String::as_str));
        if let Some(with) = &self.given.with {
            return Ok(match shape(ty)? {
                Shape::Maybe(_) if open => {
                    quote!(if args.is_empty() || args.at_keyword() { None } else { Some(#with(args, cx)?) })
                }
                Shape::Many(_) if open => {
                    let least = self.given.least;
                    quote!({
                        let mut all = vec![];
                        while all.len() < #least || !(args.is_empty() || args.at_keyword()) {
                            all.push(#with(args, cx)?);
                        }
                        all
                    })
                }
                _ => quote!(#with(args, cx)?),
            });
        }
        Ok(match shape(ty)? {
            Shape::Maybe(of) if open => {
                let (value, first) = (self.reading(of, false, k)?, first(of)?);
                quote!(match args.peek() {
                    Some(w) if !args.at_keyword() && <#first as Value>::begins(w) => Some(#value),
                    _ => None,
                })
            }
            Shape::Many(of) if open => {
                let (value, least, first) = (self.reading(of, false, k)?, self.given.least, first(of)?);
                quote!({
                    let mut all = vec![];
                    while all.len() < #least || args.peek().is_some_and(|w| !args.at_keyword() && <#first as Value>::begins(w)) {
                        if args.at_keyword() {
                            return lacking(#what, args);
                        }
                        all.push(#value);
                    }
                    all
                })
            }
            Shape::Placed(of) if self.given.placed => {
                let value = match shape(of)? {
                    Shape::Placed(inner) => {
                        let value = self.reading(inner, false, k)?;
                        quote!(At::read(args, |args| Ok(#value))?)
                    }
                    _ => self.reading(of, false, k)?,
                };
                quote!(At { value: #value, span: word.span, unknown: word.unknown })
            }
            Shape::Placed(of) => {
                let value = self.reading(of, false, k)?;
                quote!(At::read(args, |args| Ok(#value))?)
            }
            Shape::Tuple(types) => {
                let values = types.iter().enumerate().map(|(k, t)| self.reading(t, false, k));
                let values = values.collect::<syn::Result<Vec<_>>>()?;
                quote!((#(#values),*))
            }
            Shape::Array(of, count) => {
                let values =
                    (0..count).map(|k| self.reading(of, false, k)).collect::<syn::Result<Vec<_>>>()?;
                quote!([#(#values),*])
            }
            _ if self.given.positive => quote!(args.positive(#what)?),
            _ if self.given.non_negative => quote!(args.non_negative(#what)?),
            _ => match (&self.given.from, &self.given.like) {
                (Some(least), _) => quote!(<#ty as Whole>::from(args, #least, #what)?),
                (None, Some(like)) => quote!(<#ty>::from(<#like as Value>::value(#what, args, cx)?)),
                (None, None) => quote!(<#ty as Value>::value(#what, args, cx)?),
            },
        })
    }
}

/// Whether it is `yes` or `no`, whose name in messages is the keyword.
fn is_switch(ty: &Type) -> bool {
    matches!(ty, Type::Path(path) if path.path.is_ident("bool"))
}

/// The type of the first word of a value.
fn first(ty: &Type) -> syn::Result<&Type> {
    match shape(ty)? {
        Shape::Placed(of) | Shape::Array(of, _) => first(of),
        Shape::Tuple(types) => types.first().map_or(Ok(ty), |of| first(of)),
        _ => Ok(ty),
    }
}

fn shape(ty: &Type) -> syn::Result<Shape<'_>> {
    Ok(match ty {
        Type::Tuple(tuple) => Shape::Tuple(tuple.elems.iter().collect()),
        Type::Array(array) => match &array.len {
            Expr::Lit(len) if matches!(len.lit, Lit::Int(_)) => {
                let Lit::Int(count) = &len.lit else { return wrong(ty.span(), "a number is needed") };
                Shape::Array(&array.elem, count.base10_parse()?)
            }
            _ => return wrong(ty.span(), "the length of a list of words is written as a number"),
        },
        Type::Path(path) => {
            let Some(last) = path.path.segments.last() else { return Ok(Shape::One) };
            let PathArguments::AngleBracketed(of) = &last.arguments else { return Ok(Shape::One) };
            let Some(GenericArgument::Type(of)) = of.args.first() else { return Ok(Shape::One) };
            match last.ident.to_string().as_str() {
                "Option" => Shape::Maybe(of),
                "Vec" => Shape::Many(of),
                "At" => Shape::Placed(of),
                _ => Shape::One,
            }
        }
        _ => Shape::One,
    })
}
