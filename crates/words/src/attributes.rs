//! What stands in `#[word(…)]`, and what a doc comment says.

use proc_macro2::{Span, TokenStream};
use syn::{Attribute, Expr, Lit, LitInt, LitStr, Meta, Path};

/// What a field, a variant or a type says of itself.
#[derive(Default)]
pub struct Attributes {
    pub about: String,
    pub unit: String,
    what: Option<String>,
    pub name: Option<String>,
    /// The word of a variant.
    pub word: Option<String>,
    /// `Some(None)`: the field's own name.
    pub keyword: Option<Option<String>>,
    pub flag: bool,
    pub default: Option<Expr>,
    pub shown: Option<String>,
    pub list: bool,
    /// A keyword that stands there once.
    pub once: bool,
    pub least: usize,
    pub positive: bool,
    pub non_negative: bool,
    pub from: Option<LitInt>,
    pub with: Option<Expr>,
    pub kind: Option<Expr>,
    pub flatten: bool,
    pub skip: bool,
    /// A place is that of the keyword.
    pub placed: bool,
    /// A type that is read as this one.
    pub like: Option<Path>,
    /// The type whose variants an enum names.
    pub of: Option<Path>,
    /// Unknown words are unknown styles.
    pub style: bool,
    /// The words of an enum are keywords of a line.
    pub keywords: bool,
    /// The variants of an enum are forms of a line; what stands before them.
    pub forms: Option<String>,
    /// What refuses keywords of other forms.
    pub foreign: Option<Path>,
    pub refused: Vec<String>,
}

impl Attributes {
    /// Reads the attributes of an item.
    pub fn read(attributes: &[Attribute]) -> syn::Result<Self> {
        let mut given = Self::default();
        let mut lines = vec![];
        for a in attributes {
            if a.path().is_ident("doc")
                && let Meta::NameValue(meta) = &a.meta
                && let Expr::Lit(value) = &meta.value
                && let Lit::Str(text) = &value.lit
            {
                lines.push(text.value().trim().to_string());
            }
            if a.path().is_ident("word") {
                given.attribute(a)?;
            }
        }
        (given.about, given.unit) = without_unit(&lines.join(" "));
        Ok(given)
    }

    fn attribute(&mut self, a: &Attribute) -> syn::Result<()> {
        if let Ok(word) = a.parse_args::<LitStr>() {
            self.word = Some(word.value());
            return Ok(());
        }
        a.parse_nested_meta(|meta| {
            let name = meta.path.get_ident().map(ToString::to_string).unwrap_or_default();
            let text = |meta: &syn::meta::ParseNestedMeta| {
                Ok::<_, syn::Error>(meta.value()?.parse::<LitStr>()?.value())
            };
            match name.as_str() {
                "name" => self.name = Some(text(&meta)?),
                "what" => self.what = Some(text(&meta)?),
                "word" => self.word = Some(text(&meta)?),
                "shown" => self.shown = Some(text(&meta)?),
                "refused" => self.refused = text(&meta)?.split_whitespace().map(String::from).collect(),
                "keyword" if meta.input.peek(syn::Token![=]) => self.keyword = Some(Some(text(&meta)?)),
                "keyword" => self.keyword = Some(None),
                "flag" if meta.input.peek(syn::Token![=]) => {
                    (self.flag, self.keyword) = (true, Some(Some(text(&meta)?)));
                }
                "flag" => (self.flag, self.keyword) = (true, Some(None)),
                "default" => self.default = Some(meta.value()?.parse()?),
                "least" => self.least = meta.value()?.parse::<LitInt>()?.base10_parse()?,
                "from" => self.from = Some(meta.value()?.parse()?),
                "with" => self.with = Some(meta.value()?.parse()?),
                "kind" => self.kind = Some(meta.value()?.parse()?),
                "list" => self.list = true,
                "once" => self.once = true,
                "positive" => self.positive = true,
                "non_negative" => self.non_negative = true,
                "flatten" => self.flatten = true,
                "skip" => self.skip = true,
                "placed" => self.placed = true,
                "style" => self.style = true,
                "keywords" => self.keywords = true,
                "like" => self.like = Some(meta.value()?.parse()?),
                "of" => self.of = Some(meta.value()?.parse()?),
                "forms" => self.forms = Some(text(&meta)?),
                "foreign" => self.foreign = Some(meta.value()?.parse()?),
                _ => return Err(meta.error("unknown here: see the page of `perigrain_words`")),
            }
            Ok(())
        })
    }

    /// The name in messages: `what`, or the first words of the sentence with a small letter.
    pub fn what(&self, name: &str) -> String {
        if let Some(what) = &self.what {
            return what.clone();
        }
        let end = self.about.find([',', ':', ';', '.', '(', '[']).unwrap_or(self.about.len());
        let head = self.about[..end].trim();
        let article = ["The ", "A ", "An "].iter().find(|a| head.starts_with(**a));
        match article {
            Some(_) => head[..1].to_lowercase() + &head[1..],
            None if self.about.is_empty() => name.to_string(),
            None => head.to_string(),
        }
    }

    /// What a type says in `what = …`.
    pub fn own_what(&self) -> Option<&str> {
        self.what.as_deref()
    }
}

/// A sentence, and the unit that stands in its first brackets.
fn without_unit(text: &str) -> (String, String) {
    let found = text.find(" [").and_then(|open| Some((open, open + text[open..].find(']')?)));
    match found {
        Some((open, close)) => {
            (format!("{}{}", &text[..open], &text[close + 1..]), text[open + 2..close].to_string())
        }
        None => (text.to_string(), String::new()),
    }
}

/// An error at a place.
pub fn wrong<T>(span: Span, text: &str) -> syn::Result<T> {
    Err(syn::Error::new(span, text))
}

/// Strings as a list of literals.
pub fn literals(words: &[String]) -> TokenStream {
    quote::quote!(&[#(#words),*])
}

/// What the code that is written names: one by one, so that types of the deriving module keep their names.
pub fn imports() -> TokenStream {
    quote::quote! {
        #[allow(unused_imports)]
        use ::perigrain_styles::words::{
            Alternative, Args, At, BuildCx, Form, Forms, Grammar, Keyword, Keywords, Kind, Part, Placeholder, Result,
            Value, Whole, Word, Words, inner, lacking, nothing, one_of, read_or, style_of, twice,
        };
    }
}
