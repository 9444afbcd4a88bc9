//! Declared lines as something to be walked along: what may stand at the cursor, and what it means.

use super::syntax::Place;
use perigrain_styles::words::{Alternative, Form, Grammar, Keyword, Kind, Part, Placeholder};

/// What may stand at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Offer {
    /// This word, and a sentence about it.
    Word(&'static str, &'static str),
    /// A word of this kind.
    Place(Placeholder),
}

impl Offer {
    /// The sentence about it, if a word is it or may be it.
    pub fn about(&self, word: &str) -> Option<String> {
        match self {
            Self::Word(known, about) => {
                (*known == word && !about.is_empty()).then(|| format!("`{known}`: {about}"))
            }
            Self::Place(p) if p.about.is_empty() => None,
            Self::Place(p) if p.unit.is_empty() => Some(format!("`{}`: {}", p.name, p.about)),
            Self::Place(p) => Some(format!("`{}` [{}]: {}", p.name, p.unit, p.about)),
        }
    }
}

/// A declared line with the words that stand before what is declared.
#[derive(Clone, Debug, PartialEq)]
pub struct Declared {
    head: Vec<String>,
    grammar: &'static Grammar,
}

/// The way along a line.
struct Walk<'a> {
    typed: &'a [&'a str],
    at: usize,
    grammar: &'static Grammar,
    offers: Vec<Offer>,
    /// What stands from the cursor on.
    rest: Vec<String>,
    /// The part at the cursor, or the keyword, counted behind the parts.
    within: Option<usize>,
    /// The words of which one stands behind the part in order: they end lists in it.
    behind: &'static [Alternative],
    /// Which words typed are none that may stand there.
    strays: Vec<usize>,
}

impl Declared {
    /// A form of a style; `head` is what stands before a style of its kind.
    pub fn new(form: &Form, head: &str) -> Self {
        let head = if form.head.is_empty() { head } else { form.head };
        Self { head: head.split_whitespace().map(String::from).collect(), grammar: form.grammar }
    }

    /// The syntax line.
    pub fn line(&self) -> String {
        format!("{} {}", self.head.join(" "), self.grammar.line()).trim_end().to_string()
    }

    /// The words before what is declared.
    pub fn head(&self) -> &[String] {
        &self.head
    }

    /// The words that are declared.
    pub fn grammar(&self) -> &'static Grammar {
        self.grammar
    }

    /// What may stand behind the words typed.
    pub fn place(&self, typed: &[&str]) -> Place {
        let n = typed.len();
        let before = typed.last().map_or(String::new(), |w| (*w).to_string());
        if n < self.head.len() {
            let rest = format!("{} {}", self.head[n..].join(" "), self.grammar.line());
            let before = n.checked_sub(1).map_or(String::new(), |k| self.head[k].clone());
            return Place {
                here: vec![self.head[n].clone()],
                before,
                rest: rest.trim_end().into(),
                offers: vec![],
            };
        }
        let walk = self.walk(&typed[self.head.len()..]);
        let here = walk.offers.iter().map(|offer| match offer {
            Offer::Word(word, _) => (*word).to_string(),
            Offer::Place(p) => p.name.to_string(),
        });
        Place { here: here.collect(), before, rest: walk.rest.join(" "), offers: walk.offers }
    }

    /// Its words as they are shown, and which of them the word after those typed is.
    pub fn shown(&self, typed: &[&str]) -> (Vec<String>, Option<usize>) {
        let (parts, keywords) = (self.grammar.in_order(), self.grammar.every());
        let groups = keywords.iter().map(|k| k.bracketed());
        let words: Vec<String> =
            self.head.iter().cloned().chain(parts.iter().map(|p| p.shown())).chain(groups).collect();
        let n = typed.len();
        if n < self.head.len() {
            return (words, Some(n));
        }
        let within = self.walk(&typed[self.head.len()..]).within;
        (words, within.map(|k| self.head.len() + k))
    }

    /// Which of the words typed are none that is declared for their places.
    pub fn strays(&self, typed: &[&str]) -> Vec<usize> {
        let n = self.head.len();
        let walk = self.walk(typed.get(n..).unwrap_or_default());
        walk.strays.iter().map(|k| n + k).collect()
    }

    fn walk<'a>(&self, typed: &'a [&'a str]) -> Walk<'a> {
        let mut walk = Walk {
            typed,
            at: 0,
            grammar: self.grammar,
            offers: vec![],
            rest: vec![],
            within: None,
            behind: &[],
            strays: vec![],
        };
        walk.line();
        walk
    }
}

impl Walk<'_> {
    fn ended(&self) -> bool {
        self.at >= self.typed.len()
    }

    fn at_keyword(&self) -> bool {
        let behind = |word: &str| self.behind.iter().any(|a| a.word == word);
        self.typed.get(self.at).is_some_and(|word| self.grammar.has(word) || behind(word))
    }

    fn line(&mut self) {
        let (parts, all) = (self.grammar.in_order(), self.grammar.every());
        for (k, part) in parts.iter().enumerate() {
            let before = self.offers.len();
            self.behind = match parts.get(k + 1) {
                Some(Part::Word(next)) => next.kind.choices(),
                _ => &[],
            };
            let passed = self.along(&[*part]);
            if self.within.is_none() && self.offers.len() > before {
                self.within = Some(k);
            }
            if !passed {
                self.rest.extend(parts[k + 1..].iter().map(|part| part.shown()));
                self.rest.extend(all.iter().map(|keyword| keyword.bracketed()));
                return;
            }
        }
        let mut used: Vec<&str> = vec![];
        while let Some(word) = self.typed.get(self.at) {
            self.at += 1;
            let Some(k) = all.iter().position(|k| k.word == *word) else {
                self.strays.push(self.at - 1);
                continue;
            };
            used.push(all[k].word);
            if !self.along(&all[k].values.iter().collect::<Vec<_>>()) {
                self.within = Some(parts.len() + k);
                return;
            }
        }
        let left = all.iter().position(|k| k.repeats || !used.contains(&k.word));
        self.within = self.within.or(left.map(|k| parts.len() + k));
        self.offer_keywords(&all, &used);
    }

    fn offer_keywords(&mut self, all: &[&'static Keyword], used: &[&str]) {
        for keyword in all.iter().filter(|k| k.repeats || !used.contains(&k.word)) {
            self.offers.push(Offer::Word(keyword.word, keyword.about));
            self.rest.push(keyword.bracketed());
        }
    }

    /// Walks along parts; `false` where the cursor is reached before what must stand there.
    fn along(&mut self, parts: &[&'static Part]) -> bool {
        for (k, part) in parts.iter().enumerate() {
            let before = self.offers.len();
            let passed = match part {
                Part::Word(word) => self.word(word),
                Part::Maybe(inner) => {
                    if self.at_keyword() || !self.at_first(inner) {
                        continue;
                    }
                    self.some(inner)
                }
                Part::Many(inner, least) => self.many(inner, *least),
                Part::All(grammar) => self.along(&grammar.in_order()),
            };
            if !passed {
                if self.rest.is_empty() {
                    self.rest = parts[k..].iter().map(|part| part.shown()).collect();
                }
                return false;
            }
            if self.offers.len() > before {
                self.rest.push(part.shown());
            }
        }
        true
    }

    /// Words that may be left out: the cursor may stand at them and at what comes behind.
    fn some(&mut self, parts: &'static [Part]) -> bool {
        let first = self.ended();
        self.along(&parts.iter().collect::<Vec<_>>()) || {
            if first {
                self.rest.clear();
            }
            first
        }
    }

    /// Whether parts may begin here: the line ends, or a word stands there that may be their first one.
    fn at_first(&self, parts: &[Part]) -> bool {
        match (self.typed.get(self.at), parts.first()) {
            (Some(word), Some(Part::Word(place))) => may_be(place.kind, word),
            _ => true,
        }
    }

    fn many(&mut self, parts: &'static [Part], least: usize) -> bool {
        let mut count = 0;
        while !self.ended() && !self.at_keyword() && (count < least || self.at_first(parts)) {
            if !self.along(&parts.iter().collect::<Vec<_>>()) {
                return false;
            }
            count += 1;
        }
        if self.ended() {
            self.some(parts);
            return count >= least;
        }
        true
    }

    fn word(&mut self, place: &Placeholder) -> bool {
        if self.ended() {
            self.offer(place, place.kind);
            return false;
        }
        self.taken(place.kind)
    }

    /// Passes what a word of a kind takes.
    fn taken(&mut self, kind: Kind) -> bool {
        match kind {
            Kind::Choice(all) | Kind::Models(all) => {
                let word = self.typed[self.at];
                self.at += 1;
                match all.iter().find(|a| a.word == word) {
                    Some(one) => self.alternative(one.parts),
                    None => {
                        self.strays.push(self.at - 1);
                        true
                    }
                }
            }
            Kind::Words(grammar) => self.nested(grammar),
            Kind::OrNull(inner) if self.typed[self.at] != "NULL" => self.taken(*inner),
            Kind::Or(words, other) => {
                self.taken(*if is_one(*words, self.typed[self.at]) { words } else { other })
            }
            _ => {
                self.at += 1;
                true
            }
        }
    }

    /// The parts of a word that is one of several; the keywords of a declaration that ends them stand behind it.
    fn alternative(&mut self, parts: &'static [Part]) -> bool {
        match parts {
            [before @ .., Part::All(grammar)] => {
                self.along(&before.iter().collect::<Vec<_>>()) && self.nested(grammar)
            }
            _ => self.along(&parts.iter().collect::<Vec<_>>()),
        }
    }

    /// A declaration within another: its keywords end it.
    fn nested(&mut self, grammar: &'static Grammar) -> bool {
        if !self.along(&grammar.in_order()) {
            return false;
        }
        let all = grammar.every();
        while let Some(keyword) = self.typed.get(self.at).and_then(|w| all.iter().find(|k| k.word == *w)) {
            self.at += 1;
            if !self.along(&keyword.values.iter().collect::<Vec<_>>()) {
                return false;
            }
        }
        if self.ended() {
            self.offer_keywords(&all, &[]);
        }
        true
    }

    fn offer(&mut self, place: &Placeholder, kind: Kind) {
        match kind {
            Kind::Choice(all) | Kind::Models(all) => {
                let about = |own: &'static str| if own.is_empty() { place.about } else { own };
                self.offers.extend(all.iter().map(|a| Offer::Word(a.word, about(a.about))));
            }
            Kind::Switch => {
                self.offers.extend(["yes", "no"].map(|word| Offer::Word(word, place.about)));
            }
            Kind::OrNull(inner) => {
                self.offers.push(Offer::Word("NULL", ""));
                self.offer(place, *inner);
            }
            Kind::Or(words, other) => {
                self.offer(place, *words);
                self.offer(place, *other);
            }
            Kind::Words(grammar) => {
                let parts = grammar.in_order();
                if let Some(Part::Word(first)) = parts.first() {
                    self.offer(first, first.kind);
                }
            }
            _ => self.offers.push(Offer::Place(Placeholder { kind, ..*place })),
        }
    }
}

/// Whether a word is one of the words of a kind.
fn is_one(kind: Kind, word: &str) -> bool {
    match kind {
        Kind::Reference => word.starts_with("v_"),
        _ => kind.has(word),
    }
}

/// Whether a word may be the first one of a kind, as far as the kind has words of its own.
fn may_be(kind: Kind, word: &str) -> bool {
    match kind {
        Kind::Choice(_) | Kind::Models(_) | Kind::Reference => is_one(kind, word),
        Kind::Or(first, second) => may_be(*first, word) || may_be(*second, word),
        Kind::OrNull(inner) => word == "NULL" || may_be(*inner, word),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NUMBER: Part =
        Part::Word(Placeholder { name: "R", kind: Kind::Number, about: "The radius.", unit: "length" });
    const GROUP: Part = Part::Word(Placeholder { name: "group-ID", kind: Kind::Group, about: "", unit: "" });
    const SIDES: Part = Part::Word(Placeholder {
        name: "side",
        kind: Kind::Choice(&[
            Alternative { word: "in", about: "Inside.", parts: &[] },
            Alternative { word: "near", about: "", parts: &[NUMBER] },
        ]),
        about: "",
        unit: "",
    });
    const LINE: Grammar = Grammar {
        parts: &[NUMBER, Part::Many(&[GROUP], 1)],
        keywords: &[
            Keyword { word: "side", values: &[SIDES], about: "", default: "", repeats: false },
            Keyword { word: "scale", values: &[NUMBER, NUMBER], about: "", default: "", repeats: true },
        ],
        refused: &[],
    };

    #[track_caller]
    fn check(typed: &str, here: &[&str], rest: &str) {
        let line = Declared::new(&Form::behind(&LINE), "fix ID group ball");
        let place = line.place(&typed.split_whitespace().collect::<Vec<_>>());
        assert_eq!(
            (place.here, place.rest.as_str()),
            (here.iter().map(|h| (*h).into()).collect(), rest),
            "{typed}"
        );
    }

    #[test]
    fn words_in_order_then_keywords() {
        let keywords = "[side in | near R] [scale R R]";
        check("fix 1 all", &["ball"], &format!("ball R group-ID … {keywords}…"));
        check("fix 1 all ball", &["R"], &format!("R group-ID … {keywords}"));
        check("fix 1 all ball 1", &["group-ID"], &format!("group-ID … {keywords}"));
        check("fix 1 all ball 1 a", &["group-ID", "side", "scale"], &format!("group-ID … {keywords}"));
        check("fix 1 all ball 1 a side", &["in", "near"], "in | near R");
        check("fix 1 all ball 1 a side near", &["R"], "R");
        check("fix 1 all ball 1 a side near 2", &["scale"], "[scale R R]");
        check("fix 1 all ball 1 a scale 2", &["R"], "R");
        check("fix 1 all ball 1 a scale 2 3 side in", &["scale"], "[scale R R]");
    }

    #[test]
    fn words_without_a_place_are_strays() {
        let line = Declared::new(&Form::behind(&LINE), "fix ID group ball");
        let strays = |typed: &str| line.strays(&typed.split_whitespace().collect::<Vec<_>>());
        assert!(strays("fix 1 all ball 1 a b side near 2").is_empty());
        assert_eq!(strays("fix 1 all ball 1 a side far scale 1 2 wrong"), [7, 11]);
    }

    #[test]
    fn sentences_stand_beside_what_is_offered() {
        let line = Declared::new(&Form::behind(&LINE), "fix ID group ball");
        let about = |typed: &str, word: &str| {
            let place = line.place(&typed.split_whitespace().collect::<Vec<_>>());
            place.offers.iter().find_map(|o| o.about(word))
        };
        assert_eq!(about("fix 1 all ball", "2.0").as_deref(), Some("`R` [length]: The radius."));
        assert_eq!(about("fix 1 all ball 1 a side", "in").as_deref(), Some("`in`: Inside."));
        assert_eq!(about("fix 1 all ball 1 a side", "near"), None);
    }
}
