//! Templates of grains and their distributions: native mixtures.

use crate::Translator;
use crate::native::{Line, instead};
use crate::reading::{choice, is_open, number, rounded, twice, unknown, value, without_counterpart};
use perigrain_base::diag::{Code, Diagnostic, Result, nearest};
use perigrain_lang::{Args, Command, Word};

/// A kind of grain.
#[derive(Clone, Debug)]
pub(crate) struct Template {
    pub kind: Word,
    pub radius: Word,
    pub density: Word,
    /// It has several spheres: a native molecule template.
    pub clump: bool,
}

const KEYWORDS: &[&str] = &["atom_type", "density", "radius", "volume_limit", "relative"];
const STYLES: &[&str] = &["constant", "uniform", "gaussian", "lognormal"];

impl Translator {
    /// `fix ID group particletemplate/sphere SEED …`.
    pub(crate) fn template(&mut self, cmd: &Command, args: &mut Args) -> Result<Option<Vec<Command>>> {
        seed(args)?;
        let at = cmd.args[2].span;
        let one = |text: &str| Word::new(text, at);
        let mut template = Template { kind: one("1"), radius: one("1"), density: one("1"), clump: false };
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "atom_type" => {
                    let (kind, note) = rounded(&number(args, "the atom type")?);
                    self.notes.0.extend(note);
                    template.kind = kind;
                }
                "density" => template.density = constant(args, "the density")?,
                "radius" => template.radius = constant(args, "the radius")?,
                "volume_limit" => {
                    number(args, "the smallest volume")?;
                    self.idle(word, "grains of any volume are made");
                }
                "relative" if choice(args, "state of `relative`", &["yes", "no"])? == "yes" => {
                    let help = "write the radius as a number";
                    return Err(without_counterpart(word, "a radius relative to another", help).into());
                }
                "relative" => {}
                _ => return Err(unknown(word, "keyword of particletemplate/sphere", KEYWORDS).into()),
            }
        }
        self.in_all(cmd);
        let id = cmd.args[0].text.clone();
        let mut lines = vec![];
        if is_open(&template.radius) {
            // The text of the radius under a name, so that twice that number has the deck's digits.
            let name = format!("{id}_radius");
            let mut line = Line::new(cmd, "variable");
            line.put(&format!("{name} string"), at).word(&template.radius);
            lines.push(line.done());
            template.radius = instead(&template.radius, format!("${{{name}}}"));
        }
        self.own.insert(id.clone());
        self.templates.insert(id, template);
        Ok(Some(lines))
    }

    /// `fix ID group particledistribution/discrete SEED n ID w …`, with shares by mass or by number.
    pub(crate) fn distribution(
        &mut self,
        cmd: &Command,
        args: &mut Args,
        by: &str,
    ) -> Result<Option<Vec<Command>>> {
        let seed = seed(args)?;
        let count = number(args, "the number of templates")?;
        let wanted = value(&rounded(&count).0).map_or(0, |n| n as usize);
        let mut line = Line::new(cmd, "mixture");
        line.word(&cmd.args[0]).put(by, cmd.args[2].span).word(&seed);
        let mut found = 0;
        while let Some(word) = args.next() {
            let Some(template) = self.templates.get(&word.text) else {
                let text = format!("there is no particletemplate `{}`", word.text);
                let d = Diagnostic::error(Code::UNKNOWN_FIX, word.span, text);
                let near = nearest(&word.text, self.templates.keys().map(String::as_str));
                return Err(near.into_iter().fold(d, |d, n| d.help(format!("did you mean `{n}`?"))).into());
            };
            if template.clump {
                line.put("mol", word.span).word(word);
            } else {
                line.put("sphere", word.span).word(&template.kind).word(&twice(&template.radius));
            }
            line.word(&template.density);
            line.word(&number(args, "the share of the template")?);
            found += 1;
        }
        if found != wanted && wanted > 0 {
            let text = format!("{wanted} templates are announced, and {found} follow");
            return Err(Diagnostic::error(Code::BAD_VALUE, count.span, text).into());
        }
        self.in_all(cmd);
        let id = cmd.args[0].text.clone();
        self.own.insert(id.clone());
        self.mixtures.insert(id);
        Ok(Some(vec![line.done()]))
    }

    /// Newcomers are members of `all` and of the group of the fix that inserts them.
    pub(crate) fn in_all(&mut self, cmd: &Command) {
        let group = &cmd.args[1];
        if group.text != "all" {
            let text = format!("new grains do not join group `{}` through this line", group.text);
            let help = "they join the group of the fix that inserts them";
            self.notes.push(Diagnostic::note(Code::DIALECT, group.span, text).help(help));
        }
    }
}

/// A seed, of which any is taken.
fn seed(args: &mut Args) -> Result<Word> {
    number(args, "the seed").map(|word| rounded(&word).0)
}

/// `constant X`; random styles are refused by name.
pub(crate) fn constant(args: &mut Args, what: &str) -> Result<Word> {
    let word = args.peek().cloned();
    match choice(args, "random style", STYLES)? {
        "constant" => number(args, what),
        _ => {
            let word = word.unwrap_or_else(|| Word::new("", args.here()));
            let help = "write several templates with `radius constant` into the distribution";
            Err(without_counterpart(&word, "a random size or density", help).into())
        }
    }
}
