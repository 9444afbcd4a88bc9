//! Syntax lines that are written by hand as something to be walked along: which word of them stands where the cursor is.

use super::walk::Offer;

/// A word of a syntax line, or something in brackets.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Part {
    Word(String),
    Optional(Vec<String>),
}

/// One form of a command: `region ID block XLO … | sphere X Y Z R  [side in|out]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Form {
    /// Words before the alternatives begin.
    head: Vec<Part>,
    /// What stands between ` | `; one if there is nothing to choose.
    choices: Vec<Vec<Part>>,
    /// What follows whichever was chosen: the part behind two blanks.
    tail: Vec<Part>,
}

/// What a form says of the word at some place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Place {
    /// What may stand here: words as they are, or placeholders such as `ID`, `FILE`, `yes|no`.
    pub here: Vec<String>,
    /// The placeholder or word before.
    pub before: String,
    /// The rest of the form from here on.
    pub rest: String,
    /// What may stand here, of lines whose words are declared.
    pub offers: Vec<Offer>,
}

impl Form {
    /// Reads a syntax line. `name` is the word that names what the form is about: alternatives begin behind it.
    pub fn read(line: &str, name: &str) -> Self {
        let (body, tail) = line.split_once("  ").unwrap_or((line, ""));
        let mut choices: Vec<Vec<Part>> = vec![vec![]];
        for token in tokens(body) {
            if token == "|" {
                choices.push(vec![]);
            } else if let Some(last) = choices.last_mut() {
                last.extend(part(&token));
            }
        }
        let mut head = vec![];
        if choices.len() > 1 {
            let first = &mut choices[0];
            let named = first.iter().position(|p| *p == Part::Word(name.into())).unwrap_or(0);
            let begin = (named + 1..first.len()).find(|&k| begins_choice(&first[k])).unwrap_or(named + 1);
            head = first.drain(..begin.min(first.len())).collect();
        }
        Self { head, choices, tail: tokens(tail).iter().filter_map(|t| part(t)).collect() }
    }

    /// Its words from left to right, with the choice that the words typed have made.
    fn along(&self, typed: &[&str]) -> Option<Vec<&Part>> {
        let chosen = match self.choices.as_slice() {
            [only] => only,
            all => {
                let word = typed.get(self.head.len())?;
                all.iter().find(|c| c.first().is_some_and(|p| p.takes(word)))?
            }
        };
        Some(self.head.iter().chain(chosen).chain(&self.tail).collect())
    }

    /// Its words as they are shown, and which of them the word after those typed is.
    pub fn shown(&self, typed: &[&str]) -> (Vec<String>, Option<usize>) {
        let n = typed.len();
        let text = |parts: &[Part]| parts.iter().map(Part::text).collect::<Vec<_>>();
        let Some(parts) = self.along(typed) else {
            let choices: Vec<String> = self.choices.iter().map(|c| text(c).join(" ")).collect();
            let all = [text(&self.head), vec![choices.join(" | ")], text(&self.tail)].concat();
            return (all, (n <= self.head.len()).then_some(n));
        };
        let words: Vec<String> = parts.iter().map(|p| p.text()).collect();
        let fixed = parts.iter().map_while(|p| p.word()).count();
        if n < fixed {
            return (words, Some(n));
        }
        let begun = typed.iter().enumerate().skip(fixed).rev().find_map(|(k, word)| {
            let at = parts[fixed..].iter().position(|p| p.takes(word))?;
            (n - k < parts[fixed + at].words().len()).then_some(fixed + at)
        });
        let again = || parts[..fixed].last().is_some_and(|p| p.text().ends_with('…')).then(|| fixed - 1);
        let next = begun.or_else(again).or_else(|| (fixed < words.len()).then_some(fixed));
        (words, next)
    }

    /// The word that it begins with.
    pub fn first(&self) -> Option<&str> {
        self.head.iter().chain(self.choices.iter().flatten()).next()?.word()
    }

    /// Where a word called `name` stands in it.
    pub fn index_of(&self, name: &str) -> Option<usize> {
        let words = self.head.iter().chain(self.choices.iter().flatten());
        words.map_while(Part::word).position(|w| w == name)
    }

    /// How well the words typed fit: words that are written as they are count for it or against it.
    pub fn fit(&self, typed: &[&str]) -> i32 {
        let parts = self.along(typed).unwrap_or_else(|| self.head.iter().collect());
        let fixed = parts.iter().map_while(|p| p.word()).zip(typed);
        fixed.filter(|(w, _)| w.split('|').all(is_word)).map(|(w, t)| if takes(w, t) { 1 } else { -1 }).sum()
    }

    /// The description of the word after those typed; the first of them is the command.
    pub fn place(&self, typed: &[&str]) -> Place {
        let n = typed.len();
        let Some(parts) = self.along(typed) else { return self.choose(n) };
        let fixed: Vec<&str> = parts.iter().map_while(|p| p.word()).collect();
        let options: Vec<&[String]> = parts[fixed.len()..].iter().map(|p| p.words()).collect();
        let optional =
            |all: &[&[String]]| all.iter().map(|g| format!(" [{}]", g.join(" "))).collect::<String>();
        if n < fixed.len() {
            let rest = fixed[n..].join(" ") + &optional(&options);
            return Place {
                here: vec![fixed[n].into()],
                before: fixed[n - 1].into(),
                rest,
                ..Place::default()
            };
        }
        // Behind the last keyword typed its own words follow, then other keywords.
        for (k, word) in typed.iter().enumerate().skip(fixed.len()).rev() {
            let Some(group) = options.iter().find(|g| g.first().is_some_and(|w| takes(w, word))) else {
                continue;
            };
            let into = n - k;
            if let Some(here) = group.get(into) {
                let rest = group[into..].join(" ");
                return Place {
                    here: vec![here.clone()],
                    before: group[into - 1].clone(),
                    rest,
                    ..Place::default()
                };
            }
            break;
        }
        let left: Vec<&[String]> = options
            .iter()
            .filter(|g| !typed[fixed.len()..].iter().any(|t| takes(&g[0], t)))
            .copied()
            .collect();
        let here = left.iter().map(|g| g[0].clone());
        let last = fixed.last().copied().unwrap_or_default();
        // `attribute …`: the last word may be repeated.
        let again = last.ends_with('…').then(|| last.to_string());
        let rest = [again.clone().unwrap_or_default(), optional(&left)].concat();
        let before = typed.last().map_or(String::new(), |w| (*w).to_string());
        Place {
            here: again.into_iter().chain(here).collect(),
            before,
            rest: rest.trim_start().into(),
            ..Place::default()
        }
    }

    /// The place where the alternatives begin, or one before it.
    fn choose(&self, n: usize) -> Place {
        let text = |parts: &[Part]| parts.iter().map(Part::text).collect::<Vec<_>>().join(" ");
        let choices: Vec<String> = self.choices.iter().map(|c| text(c)).collect();
        let all = [choices.join(" | "), text(&self.tail)].join("  ").trim_end().to_string();
        if n < self.head.len() {
            let rest = text(&self.head[n..]) + " " + &all;
            let here = self.head[n].word().unwrap_or_default().to_string();
            let before =
                self.head.get(n.wrapping_sub(1)).and_then(Part::word).unwrap_or_default().to_string();
            return Place { here: vec![here], before, rest, ..Place::default() };
        }
        if n > self.head.len() {
            return Place::default();
        }
        let here = self.choices.iter().filter_map(|c| c.first()?.word()).map(String::from).collect();
        let before = self.head.last().and_then(Part::word).unwrap_or_default().to_string();
        Place { here, before, rest: all, ..Place::default() }
    }

    /// Words of optional parts that are written as they are, for keywords in lists.
    pub fn keywords(&self) -> impl Iterator<Item = &str> {
        let parts = self.head.iter().chain(self.choices.iter().flatten()).chain(&self.tail);
        parts.filter_map(|p| match p {
            Part::Optional(words) => words.first().map(String::as_str),
            Part::Word(_) => None,
        })
    }
}

impl Part {
    fn word(&self) -> Option<&str> {
        if let Part::Word(w) = self { Some(w) } else { None }
    }

    fn words(&self) -> &[String] {
        match self {
            Part::Word(w) => std::slice::from_ref(w),
            Part::Optional(words) => words,
        }
    }

    fn text(&self) -> String {
        match self {
            Part::Word(w) => w.clone(),
            Part::Optional(words) => format!("[{}]", words.join(" ")),
        }
    }

    fn takes(&self, word: &str) -> bool {
        self.words().first().is_some_and(|w| takes(w, word))
    }
}

/// Whether a word of a syntax line, `yes|no` say, is this word.
fn takes(pattern: &str, word: &str) -> bool {
    pattern.trim_end_matches('…').split('|').any(|w| w == word)
}

/// Whether a word is written as it stands in the syntax line, not a placeholder.
pub fn is_word(text: &str) -> bool {
    const PLACEHOLDERS: [&str; 22] = [
        "group",
        "style",
        "args",
        "arg",
        "word",
        "value",
        "values",
        "formula",
        "keyword",
        "file",
        "attribute",
        "input",
        "command",
        "name",
        "angle",
        "type",
        "ratio",
        "dim",
        "pos",
        "cutoff",
        "condition",
        "horizon",
    ];
    text.len() > 1
        && text.chars().next().is_some_and(|c| c.is_ascii_lowercase())
        && text.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || "_/".contains(c))
        && !PLACEHOLDERS.contains(&text)
}

fn is_literal(part: &Part) -> bool {
    part.word().is_some_and(|w| w.trim_end_matches('…').split('|').all(is_word))
}

/// Whether alternatives may begin with it: with a word as it is written, or with several of which one is (`type|id|molecule`).
fn begins_choice(part: &Part) -> bool {
    is_literal(part) || part.word().is_some_and(|w| w.contains('|') && w.split('|').any(is_word))
}

/// Words at blanks; what stands in brackets is one.
fn tokens(text: &str) -> Vec<String> {
    let mut out: Vec<String> = vec![];
    let mut open = 0usize;
    for word in text.split_whitespace() {
        match out.last_mut() {
            Some(last) if word == "…" => last.push('…'),
            Some(last) if open > 0 => {
                last.push(' ');
                last.push_str(word);
            }
            _ => out.push(word.to_string()),
        }
        // `c_ID[k]` opens and closes within the word.
        open = (open + word.matches('[').count()).saturating_sub(word.matches(']').count());
    }
    out
}

/// A word or what stands in brackets; `…` behind a word stays with it.
fn part(token: &str) -> Option<Part> {
    let Some(inside) = token.trim_end_matches('…').strip_prefix('[').and_then(|t| t.strip_suffix(']'))
    else {
        return Some(Part::Word(token.to_string()));
    };
    let words = inside.replace(['[', ']', '…'], "");
    let words: Vec<String> = words.split_whitespace().map(String::from).collect();
    (!words.is_empty()).then_some(Part::Optional(words))
}

#[cfg(test)]
mod tests {
    use super::*;

    const REGION: &str =
        "region ID block XLO XHI | sphere X Y Z R | union N ID ID …  [side in|out] [units lattice|box]";

    fn place(line: &str, name: &str, typed: &str) -> Place {
        Form::read(line, name).place(&typed.split_whitespace().collect::<Vec<_>>())
    }

    #[test]
    fn words_stand_one_after_the_other() {
        let p = place("fix ID group viscous gamma [scale type ratio]…", "viscous", "fix 1 all viscous");
        assert_eq!((p.here, p.rest.as_str()), (vec!["gamma".to_string()], "gamma [scale type ratio]"));
        let p =
            place("fix ID group viscous gamma [scale type ratio]…", "viscous", "fix 1 all viscous 1.0 scale");
        assert_eq!((p.here[0].as_str(), p.rest.as_str()), ("type", "type ratio"));
    }

    #[test]
    fn alternatives_are_chosen_by_their_first_word() {
        let p = place(REGION, "region", "region a");
        assert_eq!(p.here, ["block", "sphere", "union"]);
        let p = place(REGION, "region", "region a sphere 0 0");
        assert_eq!(p.rest, "Z R [side in|out] [units lattice|box]");
        let p = place(REGION, "region", "region a sphere 0 0 0 1");
        assert_eq!(p.here, ["side", "units"]);
        let p = place(REGION, "region", "region a sphere 0 0 0 1 side");
        assert_eq!(p.here, ["in|out"]);
        let p = place(REGION, "region", "region a sphere 0 0 0 1 side in");
        assert_eq!(p.here, ["units"]);
    }

    #[test]
    fn alternatives_may_begin_with_several_words() {
        let line = "group ID type|id|molecule A … | type|id|molecule <> A B | region ID | union ID …";
        assert_eq!(place(line, "group", "group g region").here, ["ID"]);
        assert_eq!(place(line, "group", "group g type").here, ["A…"]);
    }

    #[test]
    fn placeholders_before_the_alternatives_are_no_alternatives() {
        let line = "fix ID group indent K sphere x y z R | plane dim pos lo|hi [side in|out]";
        assert_eq!(place(line, "indent", "fix 1 all indent").here, ["K"]);
        assert_eq!(place(line, "indent", "fix 1 all indent 10").here, ["sphere", "plane"]);
        assert_eq!(place(line, "indent", "fix 1 all indent 10 plane z").rest, "pos lo|hi [side in|out]");
    }
}
