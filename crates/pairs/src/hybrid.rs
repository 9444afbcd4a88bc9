//! `pair_style hybrid` and `hybrid/overlay`: several pair styles, each for its own pairs of types.

use super::{ByPart, Deck, Facts, PAIRS, Pair, PairOption, PairStyle, Scales, TypePairs};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, fail, nearest};
use perigrain_lang::{Args, Word, blame};
use perigrain_plan::Op;
use perigrain_styles::probe::Probe;
use perigrain_styles::words::Syntax;
use perigrain_styles::{BuildCx, Doc, SealCx, Style, lammps};
use perigrain_world::World;
use std::collections::BTreeMap;

/// `hybrid`: one sub-style per pair of types.
pub struct Hybrid;

/// `hybrid/overlay`: sub-styles add up.
pub struct Overlay;

const TEXT: &str = "Sub-styles follow with their own words. `pair_coeff i j sub …` gives coefficients of one sub-style; \
    with `hybrid` a later line for the same types replaces the earlier sub-style, with `hybrid/overlay` it adds \
    to it. `pair_coeff i j none` leaves a pair without forces. Two types without a line of their own take the \
    sub-style that both use alone, with its mixed coefficients. A sub-style that no pair uses is an error, and each \
    can be named once.";

impl Style for Hybrid {
    fn name(&self) -> &'static str {
        "hybrid"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Written(
                "pair_style hybrid style args style args …\npair_coeff i j style|none args",
            ),
            summary: "Different pair styles for different pairs of types.",
            text: TEXT,
            example: "pair_style hybrid peri/pmb granular\n\
                      pair_coeff * * granular hertz/material 5.0e7 0.7 0.3 damping tsuji tangential mindlin NULL 1.0 0.4\n\
                      pair_coeff 1 1 peri/pmb 1.6863e22 0.0015001 5.0e-4 0.25",
        }
    }
}

impl Style for Overlay {
    fn name(&self) -> &'static str {
        "hybrid/overlay"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Written(
                "pair_style hybrid/overlay style args style args …\npair_coeff i j style|none args",
            ),
            summary: "Several pair styles whose forces add up.",
            text: TEXT,
            example: "pair_style hybrid/overlay peri/pmb granular\n\
                      pair_coeff * * granular hertz/material 5.0e7 0.7 0.3 damping tsuji tangential mindlin NULL 1.0 0.4\n\
                      pair_coeff 1 1 peri/pmb 1.6863e22 0.0015001 5.0e-4 0.25",
        }
    }
}

impl PairStyle for Hybrid {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        Ok(Box::new(build("hybrid", false, args, cx)?))
    }
}

impl PairStyle for Overlay {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        Ok(Box::new(build("hybrid/overlay", true, args, cx)?))
    }
}

/// The name of a style without the ending of LAMMPS' accelerated ones.
fn plain(name: &str) -> &str {
    lammps::plain("pair", name)
}

fn build(name: &'static str, overlay: bool, args: &mut Args, cx: &BuildCx) -> Result<Declared> {
    let known: Vec<&'static str> =
        PAIRS.iter().map(|s| s.name()).filter(|n| !n.starts_with("hybrid")).collect();
    let mut subs: Vec<Box<dyn Pair>> = vec![];
    while subs.is_empty() || !args.is_empty() {
        let first = args.expect("a sub-style")?;
        let Some(style) = PAIRS.iter().find(|s| s.name() == plain(&first.text) && known.contains(&s.name()))
        else {
            return Err(unknown(first, None, &known));
        };
        let (sub, word) = (style.name(), first.span);
        if subs.iter().any(|s| s.facts().name == sub) {
            return Err(Diagnostic::error(Code::NOT_SUPPORTED, word, format!("`{sub}` is named twice"))
                .help("one is enough: coefficients may differ for every pair of types")
                .into());
        }
        let solid = |name: &str| name.starts_with("peri/");
        if let Some(first) = subs.iter().map(|s| s.facts().name).find(|name| solid(name) && solid(sub)) {
            let text = format!("`{sub}` beside `{first}`: one scene has one peridynamic style");
            return Err(Diagnostic::error(Code::NOT_SUPPORTED, word, text)
                .help(
                    "coefficients may differ for every pair of types; LAMMPS crashes here without a message",
                )
                .into());
        }
        let mut own = args.until(|word| known.contains(&plain(word)));
        subs.push(style.build(&mut own, cx)?);
        if let Some(word) = own.next() {
            return Err(unknown(word, Some(*style), &known));
        }
    }
    Ok(Declared { name, overlay, subs, users: BTreeMap::new() })
}

/// The error for a word that is no sub-style, nor one of those of the sub-style `before` it.
fn unknown(word: &Word, before: Option<&dyn PairStyle>, known: &[&'static str]) -> Diagnostics {
    let own = before.map_or(vec![], |style| style.options());
    let text = match before {
        Some(style) => format!("`{}` is neither a word of `{}` nor a sub-style", word.text, style.name()),
        None => format!("unknown sub-style: `{}`", word.text),
    };
    let d = blame(word, Code::UNKNOWN_KEYWORD, text);
    if let Some(n) = nearest(&word.text, own.iter().copied()) {
        return d.help(format!("did you mean `{n}`?")).into();
    }
    if let Some(refusal) = lammps::refusal("pair", "pair style", word) {
        return refusal;
    }
    if let Some(n) = nearest(&word.text, known.iter().copied()) {
        return d.help(format!("did you mean `{n}`?")).into();
    }
    let d = if own.is_empty() { d } else { d.help(format!("may stand here: {}", own.join(" "))) };
    d.help(format!("sub-styles: {}", known.join(" "))).into()
}

#[derive(Clone)]
struct Declared {
    name: &'static str,
    overlay: bool,
    subs: Vec<Box<dyn Pair>>,
    /// The sub-styles of each pair of types that has been spoken of; none for `none`.
    users: BTreeMap<(u16, u16), Vec<usize>>,
}

impl Declared {
    /// The sub-styles that act between two types: as given, or the one both types use alone.
    fn users(&self, i: u16, j: u16) -> Option<Vec<usize>> {
        if let Some(list) = self.users.get(&(i, j)) {
            return Some(list.clone());
        }
        match (self.users.get(&(i, i)).map(Vec::as_slice), self.users.get(&(j, j)).map(Vec::as_slice)) {
            (Some([a]), Some([b])) if a == b && self.subs[*a].covers(i, j) => Some(vec![*a]),
            _ => None,
        }
    }

    /// The pairs of types that sub-style `k` acts on.
    fn pairs_of(&self, k: usize, types: usize) -> Vec<(u16, u16)> {
        let all = (1..=types as u16).flat_map(|i| (i..=types as u16).map(move |j| (i, j)));
        all.filter(|&(i, j)| self.users(i, j).is_some_and(|list| list.contains(&k))).collect()
    }

    /// Sub-style `k`, limited to its pairs.
    fn limited(&self, k: usize, types: usize) -> Box<dyn Pair> {
        let mut sub = self.subs[k].clone();
        sub.restrict(&self.pairs_of(k, types));
        sub
    }
}

impl Pair for Declared {
    fn facts(&self) -> Facts {
        let own = self.users.iter().filter(|((i, j), _)| i == j).map(|((i, _), list)| (*i, list));
        let solid = |i: &u16, list: &[usize]| list.iter().any(|&k| self.subs[k].facts().solids.contains(i));
        let solids = own.filter(|(i, list)| solid(i, list)).map(|(i, _)| i).collect();
        let mixes = self.subs.iter().any(|s| s.facts().mixes);
        Facts { name: self.name, solids, mixes, ..Facts::default() }
    }

    fn coeff(&mut self, pairs: &TypePairs, args: &mut Args, cx: &BuildCx) -> Result<()> {
        if args.eat("none") {
            self.users.extend(pairs.iter().map(|&p| (p, vec![])));
            return Ok(());
        }
        let names: Vec<&'static str> = self.subs.iter().map(|s| s.facts().name).collect();
        let first = args.peek().map(|word| plain(&word.text));
        let name = match names.iter().find(|name| first == Some(**name)) {
            Some(name) => {
                args.next();
                *name
            }
            None => args.choice(&format!("sub-style of this {}", self.name), &names)?,
        };
        let k = names.iter().position(|n| *n == name).unwrap_or(0);
        self.subs[k].coeff(pairs, args, cx)?;
        for p in pairs {
            let list = self.users.entry(*p).or_default();
            if !self.overlay {
                list.clear();
            }
            if !list.contains(&k) {
                list.push(k);
            }
        }
        Ok(())
    }

    fn declare(&self, w: &mut World) {
        self.subs.iter().for_each(|s| s.declare(w));
    }

    fn covers(&self, i: u16, j: u16) -> bool {
        self.users(i.min(j), i.max(j)).is_some()
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<ByPart<dyn Op>> {
        let types = cx.world().types;
        // Solids first: contacts need to know which particles belong to one.
        let mut order: Vec<usize> = (0..self.subs.len()).collect();
        order.sort_by_key(|&k| self.subs[k].facts().true_forces.is_none());
        let mut all = vec![];
        for k in order {
            all.extend(self.limited(k, types).ops(cx)?.into_iter().map(|(_, op)| (k, op)));
        }
        Ok(all)
    }

    fn probes(&self, w: &World, _bonds: bool) -> Result<ByPart<dyn Probe>> {
        let mut all = vec![];
        for k in 0..self.subs.len() {
            all.extend(self.limited(k, w.types).probes(w, false)?.into_iter().map(|(_, probe)| (k, probe)));
        }
        Ok(all)
    }

    fn scales(&self, w: &World, deck: Deck) -> Scales {
        let cutoff = |k| self.limited(k, w.types).scales(w, deck).cutoff;
        let cutoff = (0..self.subs.len()).filter_map(cutoff).reduce(f64::max);
        // Callers that need times query each sub-style.
        Scales { cutoff, ..Scales::default() }
    }

    fn modify(&mut self, option: PairOption, cx: &BuildCx) -> Result<()> {
        if let PairOption::Mix(rule) = option {
            let mut mixing = self.subs.iter_mut().filter(|s| s.facts().mixes);
            return mixing.try_for_each(|sub| sub.modify(PairOption::Mix(rule), cx));
        }
        match self.subs.iter_mut().find(|s| s.facts().true_forces.is_some()) {
            Some(sub) => sub.modify(option, cx),
            None => {
                let text = format!("`peri_modify` concerns no sub-style of this {}", self.name);
                fail(Code::CONFLICT, cx.span, text)
            }
        }
    }

    fn parts(&self) -> Vec<&dyn Pair> {
        self.subs.iter().map(AsRef::as_ref).collect()
    }

    fn check(&self, cx: &BuildCx) {
        let types = cx.world.types;
        for (k, sub) in self.subs.iter().enumerate() {
            if self.pairs_of(k, types).is_empty() {
                let name = sub.facts().name;
                let text = format!("no pair of types uses the sub-style {name} of {}", self.name);
                cx.note(
                    Diagnostic::error(Code::CONFLICT, cx.span, text)
                        .help(format!("give it coefficients: `pair_coeff i j {name} …`"))
                        .help("with `hybrid` a later pair_coeff replaces an earlier one: put `* *` first"),
                );
            }
            self.limited(k, types).check(cx);
        }
    }
}
