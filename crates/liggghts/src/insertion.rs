//! `insert/pack`, `insert/rate/region`, `insert/stream`: one native fix.

use crate::Translator;
use crate::native::Line;
use crate::reading::{choice, number, rounded, unknown, vector, without_counterpart};
use perigrain_base::diag::{Code, Diagnostic, Result, nearest};
use perigrain_lang::{Args, Command, Word};

/// Keywords of all three.
const COMMON: &[&str] = &[
    "seed",
    "distributiontemplate",
    "maxattempt",
    "insert_every",
    "start",
    "overlapcheck",
    "all_in",
    "vel",
    "omega",
    "orientation",
    "set_property",
    "verbose",
    "ntry_mc",
    "random_distribute",
    "check_dist_from_subdomain_border",
    "compress_tags",
    "warn_region",
    "print_stats_start",
];
const PACK: &[&str] = &["region", "volumefraction_region", "particles_in_region", "mass_in_region"];
const RATE: &[&str] = &["region", "nparticles", "mass", "particlerate", "massrate"];
const STREAM: &[&str] = &[
    "insertion_face",
    "extrude_length",
    "duration",
    "parallel",
    "nparticles",
    "mass",
    "particlerate",
    "massrate",
];

/// What a line has set, as native words.
#[derive(Default)]
struct Parts {
    mixture: Option<Word>,
    place: Vec<Word>,
    amount: Vec<Word>,
    rate: Vec<Word>,
    length: Vec<Word>,
    vel: Vec<Word>,
    tries: Vec<Word>,
    seed: Vec<Word>,
    rest: Vec<Word>,
}

impl Translator {
    /// The line of an insertion.
    pub(crate) fn insert(
        &mut self,
        cmd: &Command,
        args: &mut Args,
        form: &str,
    ) -> Result<Option<Vec<Command>>> {
        let own = match form {
            "pack" => PACK,
            "rate" => RATE,
            _ => STREAM,
        };
        let mut parts = Parts::default();
        while let Some(word) = args.next() {
            let name = word.text.as_str();
            if !COMMON.contains(&name) && !own.contains(&name) {
                let known: Vec<&str> = own.iter().chain(COMMON).copied().collect();
                return Err(unknown(word, &format!("keyword of {}", cmd.args[2].text), &known).into());
            }
            self.keyword(word, args, &mut parts)?;
        }
        let Some(mixture) = &parts.mixture else { return lacks(cmd, "distributiontemplate ID") };
        if parts.place.is_empty() {
            return lacks(cmd, if form == "stream" { "insertion_face ID" } else { "region ID" });
        }
        if parts.amount.is_empty() {
            return lacks(cmd, if form == "pack" { "particles_in_region N" } else { "nparticles N" });
        }
        let mut line = Line::styled(cmd, "insert");
        line.word(mixture).put(form, cmd.args[2].span);
        for words in [
            &parts.place,
            &parts.amount,
            &parts.rate,
            &parts.length,
            &parts.vel,
            &parts.tries,
            &parts.seed,
            &parts.rest,
        ] {
            line.words(words);
        }
        Ok(Some(vec![line.done()]))
    }

    /// One keyword with its values.
    fn keyword(&mut self, word: &Word, args: &mut Args, parts: &mut Parts) -> Result<()> {
        let one = |name: &str, value: Word| vec![Word::new(name, word.span), value];
        match word.text.as_str() {
            "seed" => parts.seed = one("seed", self.count(args, "the seed")?),
            "distributiontemplate" => parts.mixture = Some(self.mixture(args)?),
            "maxattempt" => parts.tries = one("tries", self.count(args, "the number of attempts")?),
            "insert_every" if args.eat("once") => {}
            "insert_every" => parts.length.extend(one("every", self.count(args, "the number of steps")?)),
            "start" => parts.rest.extend(one("start", self.count(args, "the first step")?)),
            "overlapcheck" if choice(args, "state", &["yes", "no"])? == "no" => {
                parts.rest.push(Word::new("overlap", word.span));
                parts.rest.push(Word::new("no", word.span));
            }
            "all_in" if choice(args, "state", &["yes", "no"])? == "yes" => {
                parts.rest.push(Word::new("inside", word.span));
                parts.rest.push(Word::new("yes", word.span));
            }
            "overlapcheck" | "all_in" => {}
            "vel" => parts.vel = velocity(word, args)?,
            "omega" => {
                choice(args, "random style", &["constant"])?;
                parts.rest.push(Word::new("omega", word.span));
                parts.rest.extend(vector(args, "a component of the angular velocity")?);
            }
            "region" => parts.place = one("region", args.expect("the ID of a region")?.clone()),
            "insertion_face" => {
                let face = args.expect("the ID of a fix mesh/surface")?.clone();
                self.surface_of(&face)?;
                parts.place = one("face", face);
            }
            "volumefraction_region" => parts.amount = one("share", number(args, "the volume fraction")?),
            "particles_in_region" => parts.amount = one("number", self.count(args, "the number of grains")?),
            "mass_in_region" => parts.amount = one("mass", number(args, "the mass")?),
            "nparticles" if args.peek_text() == "INF" => parts.amount = one("number", next(args, "INF")?),
            "nparticles" => parts.amount = one("number", self.count(args, "the number of grains")?),
            "mass" if args.peek_text() == "INF" => parts.amount = one("mass", next(args, "INF")?),
            "mass" => parts.amount = one("mass", number(args, "the mass")?),
            "particlerate" => parts.rate = one("rate", number(args, "the grains in a unit of time")?),
            "massrate" => parts.rate = one("massrate", number(args, "the mass in a unit of time")?),
            "extrude_length" => parts.length.extend(one("length", number(args, "the length of the stream")?)),
            "duration" => parts.length.extend(one("during", self.count(args, "the number of steps")?)),
            _ => self.idle_keyword(word, args, parts)?,
        }
        Ok(())
    }

    /// Keywords that change nothing here, and those that cannot be had.
    fn idle_keyword(&mut self, word: &Word, args: &mut Args, parts: &mut Parts) -> Result<()> {
        match word.text.as_str() {
            "orientation" => {
                let at = args.here();
                let style = choice(args, "orientation", &["constant", "random", "template"])?;
                let count = if style == "constant" { 4 } else { 0 };
                let turn = (0..count).map(|_| number(args, "a component of the quaternion"));
                let turn = turn.collect::<Result<Vec<Word>>>()?;
                if !self.has_clumps() {
                    self.idle(word, "a sphere has none");
                } else if style != "template" {
                    parts.rest.extend([Word::new("orientation", word.span), Word::new(style, at)]);
                    parts.rest.extend(turn);
                }
            }
            "set_property" => {
                let help = "write `set group ID d_NAME …` behind the run that inserts the grains";
                return Err(without_counterpart(word, "a property of new grains", help).into());
            }
            "compress_tags" => {
                if choice(args, "state", &["yes", "no"])? == "yes" {
                    let help = "`reset_atoms id` numbers grains anew";
                    return Err(without_counterpart(word, "new IDs for all grains", help).into());
                }
            }
            _ => {
                args.expect("a value")?;
                self.idle(word, "places are found another way");
            }
        }
        Ok(())
    }

    /// A whole number.
    fn count(&mut self, args: &mut Args, what: &str) -> Result<Word> {
        let (word, note) = rounded(&number(args, what)?);
        self.notes.0.extend(note);
        Ok(word)
    }

    /// The ID of a distribution.
    fn mixture(&self, args: &mut Args) -> Result<Word> {
        let word = args.expect("the ID of a fix particledistribution")?;
        if self.mixtures.contains(&word.text) || word.unknown {
            return Ok(word.clone());
        }
        let text = format!("there is no particledistribution `{}`", word.text);
        let d = Diagnostic::error(Code::UNKNOWN_FIX, word.span, text);
        let near = nearest(&word.text, self.mixtures.iter().map(String::as_str));
        Err(near.into_iter().fold(d, |d, near| d.help(format!("did you mean `{near}`?"))).into())
    }
}

/// `vel constant x y z`, or random about it.
fn velocity(word: &Word, args: &mut Args) -> Result<Vec<Word>> {
    let at = args.here();
    let style = choice(args, "random style", &["constant", "uniform", "gaussian"])?;
    let mut out = vec![Word::new("vel", word.span)];
    out.extend(vector(args, "a component of the velocity")?);
    if style != "constant" {
        out.push(Word::new(style, at));
        out.extend(vector(args, "how far a component is from its mean")?);
    }
    Ok(out)
}

/// The next word.
fn next(args: &mut Args, what: &str) -> Result<Word> {
    args.expect(what).cloned()
}

/// The error for a line that lacks something.
fn lacks<T>(cmd: &Command, what: &str) -> Result<T> {
    let text = format!("`{}` lacks `{what}`", cmd.args[2].text);
    Err(Diagnostic::error(Code::MISSING_ARGUMENT, cmd.args[2].span, text).into())
}
