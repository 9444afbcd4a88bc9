//! The words of `perigrain bench`.

use crate::bench::norm::{NAMES, Norm};
use crate::bench::reference::Against;
use crate::bench::{LAYOUT, THREADS};
use crate::cli::args::{Usage, is_switch};
use crate::cli::sweeping::args::Request as Sweep;
use crate::session::axes::Axis;
use perigrain_base::diag::nearest;
use std::path::PathBuf;

/// The parsed words of `perigrain bench`; none has been applied yet.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Request {
    /// The deck, its knobs, and what all sweeps have.
    pub sweep: Sweep,
    /// Knobs of the program itself, in front of the deck's.
    pub switches: Vec<(&'static str, Vec<String>)>,
    /// What is measured.
    pub measures: Vec<String>,
    /// Against what: `finest`, a file, or a form for each measure.
    pub against: Reference,
    /// The norm's name.
    pub norm: Option<String>,
    /// How often each setting is run; `None` until its runs have taken [`crate::bench::LEAST`].
    pub repeat: Option<usize>,
    /// The words as they were typed, for messages.
    pub typed: String,
}

/// The value of `-against`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reference {
    /// The finest run, along these knobs.
    Finest(Vec<String>),
    /// A table or a log.
    File(PathBuf),
    /// A closed form for each measure.
    Forms(Vec<String>),
}

impl Default for Reference {
    fn default() -> Self {
        Self::Finest(vec![])
    }
}

/// The switches that are only for benches, with those of the program that may be knobs.
pub const SWITCHES: [&str; 6] = ["-measure", "-against", "-norm", "-repeat", THREADS, LAYOUT];

impl Request {
    /// Reads the words behind `bench`.
    ///
    /// # Errors
    /// Words that are not understood.
    pub fn parse(words: Vec<String>) -> Result<Self, Usage> {
        let typed = format!("perigrain bench {}", words.join(" "));
        let mut request = Self { typed, ..Self::default() };
        let mut rest = vec![];
        let mut words = words.into_iter().peekable();
        while let Some(word) = words.next() {
            if !SWITCHES.contains(&word.as_str()) {
                rest.push(word);
                continue;
            }
            let one = ["-norm", "-repeat"].contains(&word.as_str());
            let mut values: Vec<String> = vec![];
            while let Some(value) = words.next_if(|w| !(is_switch(w) || one && values.len() == 1)) {
                values.push(value);
            }
            let knob = [THREADS, LAYOUT].into_iter().find(|k| *k == word);
            match knob {
                Some(knob) if values.len() > 1 => request.switches.push((knob, values)),
                Some(_) => rest.extend(std::iter::once(word).chain(values)),
                None => request.set(&word, values)?,
            }
        }
        if let Some(word) =
            rest.iter().find(|w| is_switch(w) && !crate::cli::sweeping::args::SWITCHES.contains(&w.as_str()))
            && crate::cli::args::SWITCHES.iter().all(|s| !s.names.contains(&word.as_str()))
            && let Some(near) = nearest(word, SWITCHES)
        {
            return Err(
                Usage::new(format!("unknown switch `{word}`")).help(format!("did you mean `{near}`?"))
            );
        }
        if rest.iter().any(|w| w == "-report") {
            return Err(Usage::new("a bench reports what it measures").help("use `-measure WORD…`"));
        }
        request.sweep = Sweep::parse(rest)?;
        request.check()?;
        Ok(request)
    }

    fn set(&mut self, switch: &str, mut values: Vec<String>) -> Result<(), Usage> {
        let needs = |what: &str| Err(Usage::new(format!("`{switch}` needs {what}")));
        match switch {
            "-measure" if values.is_empty() => return needs("at least one word such as c_ID, v_name or pe"),
            "-measure" => self.measures.extend(values),
            "-norm" => match values.pop() {
                Some(name) if Norm::named(&name).is_some() => self.norm = Some(name),
                Some(name) => return Err(no_norm(&name)),
                None => return needs("a name"),
            },
            "-repeat" => match values.first().and_then(|v| v.parse::<usize>().ok()).filter(|n| *n > 0) {
                Some(n) => self.repeat = Some(n),
                None => return needs("a number from 1"),
            },
            _ => {
                let kind = if values.is_empty() { String::new() } else { values.remove(0) };
                self.against = match (kind.as_str(), values.len()) {
                    ("finest", _) => Reference::Finest(values),
                    ("file", 1) => Reference::File(values.remove(0).into()),
                    ("form", n) if n > 0 => Reference::Forms(values),
                    _ => return needs("`finest [KNOB…]`, `file FILE` or `form FORM…`"),
                };
            }
        }
        Ok(())
    }

    fn check(&self) -> Result<(), Usage> {
        let o = &self.sweep.options;
        if o.help || o.version || self.sweep.status {
            return Ok(());
        }
        if self.measures.is_empty() {
            return Err(Usage::new("a bench needs something to measure")
                .help("use `-measure WORD…`, as `-measure pe c_ID v_name`"));
        }
        if let Reference::Forms(forms) = &self.against
            && forms.len() != self.measures.len()
        {
            let (forms, measures) = (forms.len(), self.measures.len());
            return Err(Usage::new(format!("`-against form` has {forms} forms for {measures} measures"))
                .help("give one for each, in their order"));
        }
        for (knob, values) in &self.switches {
            let fits = |v: &&String| match *knob {
                THREADS => v.parse::<usize>().is_ok_and(|n| n > 0),
                _ => ["list", "auto"].contains(&v.as_str()),
            };
            if let Some(bad) = values.iter().find(|v| !fits(v)) {
                return Err(Usage::new(format!("`{knob} {bad}` makes no sense")));
            }
        }
        Ok(())
    }

    /// The program's own knobs as axes.
    pub fn own_axes(&self) -> Vec<Axis> {
        let axis = |(name, values): &(&str, Vec<String>)| Axis {
            names: vec![(*name).into()],
            rows: values.iter().map(|v| vec![v.clone()]).collect(),
        };
        self.switches.iter().map(axis).collect()
    }

    /// The reference of a measure.
    pub fn against(&self, measure: usize) -> Against {
        match &self.against {
            Reference::Finest(knobs) => Against::Finest(knobs.clone()),
            Reference::File(path) => Against::File(path.clone()),
            Reference::Forms(forms) => Against::Form(forms[measure].clone()),
        }
    }
}

fn no_norm(name: &str) -> Usage {
    let names: Vec<&str> = NAMES.iter().map(|(name, _)| *name).collect();
    let help = match nearest(name, names.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("there are {}", names.join(", ")),
    };
    Usage::new(format!("there is no norm `{name}`")).help(help)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Result<Request, Usage> {
        Request::parse(line.split_whitespace().map(String::from).collect())
    }

    #[test]
    fn knobs_measures_and_references_are_read() {
        let r = read(
            "in.x -each dt 2 1 -threads 1 2 -measure pe c_k -against form 0 v_k -norm l2 -repeat 3 -jobs 1",
        )
        .unwrap();
        assert_eq!(
            (r.measures.join(" ").as_str(), r.repeat, r.norm.as_deref()),
            ("pe c_k", Some(3), Some("l2"))
        );
        assert_eq!(r.against(1), Against::Form("v_k".into()));
        assert_eq!((r.own_axes().len(), r.own_axes()[0].rows.len(), r.sweep.lists.len()), (1, 2, 1));
        let r = read("in.x -threads 2 -each dt 2 1 -measure pe -against finest dt").unwrap();
        assert_eq!((r.sweep.options.threads, r.against(0)), (Some(2), Against::Finest(vec!["dt".into()])));
        assert_eq!(read("in.x -each a 1 2 -measure pe").unwrap().against(0), Against::Finest(vec![]));
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        for line in [
            "in.x -each a 1 2",
            "in.x -each a 1 2 -measure",
            "in.x -each a 1 2 -measure pe -against",
            "in.x -each a 1 2 -measure pe -against file",
            "in.x -each a 1 2 -measure pe -against form 1 2",
            "in.x -each a 1 2 -measure pe -repeat 0",
            "in.x -each a 1 2 -measure pe -report ke",
            "in.x -each a 1 2 -measure pe -threads 1 x",
            "in.x -each a 1 2 -measure pe -layout list auot",
        ] {
            assert!(read(line).is_err(), "{line}");
        }
        let near = |line: &str| read(line).unwrap_err().help.unwrap();
        assert!(near("in.x -measure pe -norm rel-mx").contains("rel-max"));
        assert!(near("in.x -mesure pe").contains("-measure"));
    }
}
