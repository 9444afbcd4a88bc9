//! The words of `perigrain sweep`.

use crate::cli::args::{self, Deck, Options, Target, Usage, is_switch};
use perigrain_base::diag::nearest;
use std::path::PathBuf;

/// One list of values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum List {
    /// `-each NAME VALUE…`.
    Each(String, Vec<String>),
    /// `-table FILE`.
    Table(PathBuf),
}

/// The parsed words of `perigrain sweep`; none has been applied yet.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Request {
    /// The deck and LAMMPS' switches.
    pub options: Options,
    /// The lists, in their order.
    pub lists: Vec<List>,
    /// Lists that go in step.
    pub zips: Vec<Vec<String>>,
    /// What each run reports.
    pub report: Vec<String>,
    /// How many run at once.
    pub jobs: Option<usize>,
    /// Where the runs are.
    pub out: Option<PathBuf>,
    /// How often a failed run is tried again.
    pub retry: usize,
    /// An earlier sweep there is discarded.
    pub anew: bool,
    /// Only print the state of the sweep.
    pub status: bool,
}

/// The switches that are only for sweeps.
pub const SWITCHES: [&str; 9] =
    ["-each", "-zip", "-table", "-report", "-jobs", "-out", "-retry", "-anew", "-status"];

impl Request {
    /// Reads the words behind `sweep`.
    ///
    /// # Errors
    /// Words that are not understood.
    pub fn parse(words: Vec<String>) -> Result<Self, Usage> {
        let mut request = Self::default();
        let mut rest = vec![];
        let mut words = words.into_iter().peekable();
        while let Some(word) = words.next() {
            if !SWITCHES.contains(&word.as_str()) {
                rest.push(word);
                continue;
            }
            let mut values: Vec<String> = vec![];
            while let Some(value) = words.next_if(|w| !is_switch(w) && wants(&word, values.len())) {
                values.push(value);
            }
            request.set(&word, values)?;
        }
        let misspelt = rest
            .iter()
            .find(|w| is_switch(w) && !args::SWITCHES.iter().any(|s| s.names.contains(&w.as_str())));
        if let Some((word, near)) = misspelt.and_then(|w| Some((w, nearest(w, SWITCHES)?))) {
            return Err(
                Usage::new(format!("unknown switch `{word}`")).help(format!("did you mean `{near}`?"))
            );
        }
        request.options = args::parse(rest)?;
        request.check()?;
        Ok(request)
    }

    fn set(&mut self, switch: &str, mut values: Vec<String>) -> Result<(), Usage> {
        let needs = |what: &str| Err(Usage::new(format!("`{switch}` needs {what}")));
        match switch {
            "-anew" => self.anew = true,
            "-status" => self.status = true,
            "-each" if values.len() < 2 => return needs("a variable's name and its values"),
            "-each" => self.lists.push(List::Each(values.remove(0), values)),
            "-zip" if values.len() < 2 => return needs("the names of at least two variables"),
            "-zip" => self.zips.push(values),
            "-report" if values.is_empty() => return needs("at least one word such as c_ID, v_name or pe"),
            "-report" => self.report.extend(values),
            "-table" | "-out" if values.is_empty() => return needs("a name"),
            "-table" => self.lists.push(List::Table(values.remove(0).into())),
            "-out" => self.out = Some(values.remove(0).into()),
            _ => {
                let Some(n) = values.first().and_then(|v| v.parse::<usize>().ok()) else {
                    return needs("a number");
                };
                match switch {
                    "-retry" => self.retry = n,
                    _ if n == 0 => return Err(Usage::new("`-jobs 0`: at least 1 is needed")),
                    _ => self.jobs = Some(n),
                }
            }
        }
        Ok(())
    }

    fn check(&self) -> Result<(), Usage> {
        let o = &self.options;
        if o.help || o.version {
            return Ok(());
        }
        if o.log != Target::Usual || o.echo.is_some() || matches!(o.screen, Target::File(_)) {
            let usage = Usage::new("`-log`, `-echo` and `-screen FILE` have no meaning for a sweep");
            return Err(usage.help("each run has a log.lammps in its own folder; `-screen none` keeps quiet"));
        }
        if !o.partition.is_empty() {
            let usage = Usage::new(
                "`-partition` needs several processes for one deck, and each run of a sweep is one",
            );
            return Err(usage.help(
                "give the values of `world` variables by `-each NAME VALUE…`; `-jobs N` makes N runs at once",
            ));
        }
        if o.timeout.is_some() {
            let usage = Usage::new("`-timeout` has no meaning for a sweep");
            return Err(
                usage.help("end it with Ctrl-C: started again, it continues with the runs that are left")
            );
        }
        if o.report.is_some() {
            let usage = Usage::new("`--report FILE` shows one run, and a sweep makes many");
            return Err(usage.help("with one dash, `-report WORD…` names what the table is to have"));
        }
        if o.safe.is_some() {
            return Err(Usage::new("`-safe` and `-limit` keep one deck in one folder, and each run of a sweep has a folder of its own")
                .help("make the runs one by one: `perigrain in.deck -safe -var NAME VALUE`"));
        }
        if let Some((name, _)) = o
            .vars
            .iter()
            .find(|(name, _)| self.lists.iter().any(|list| matches!(list, List::Each(n, _) if n == name)))
        {
            return Err(Usage::new(format!("`{name}` is given by `-var` and by `-each`"))
                .help("leave one of them out"));
        }
        if self.status && o.deck == Deck::Stdin && self.out.is_none() {
            return Err(
                Usage::new("no sweep").help("name its folder: `perigrain sweep in.deck.sweep -status`")
            );
        }
        Ok(())
    }

    /// Where the runs are: `-out`, else beside where one is, under the deck's name with this ending.
    pub fn folder(&self, ending: &str) -> PathBuf {
        if let Some(out) = &self.out {
            return out.clone();
        }
        match &self.options.deck {
            Deck::Stdin => ending.into(),
            Deck::File(path) if self.status && path.is_dir() => path.clone(),
            Deck::File(path) => {
                let mut name = path.file_name().unwrap_or_default().to_owned();
                name.push(format!(".{ending}"));
                name.into()
            }
        }
    }
}

/// Whether a switch takes a further value after so many.
fn wants(switch: &str, have: usize) -> bool {
    match switch {
        "-each" | "-zip" | "-report" => true,
        "-anew" | "-status" => false,
        _ => have == 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Result<Request, Usage> {
        Request::parse(line.split_whitespace().map(String::from).collect())
    }

    #[test]
    fn lists_take_all_words_up_to_the_next_switch() {
        let r = read("in.x -each v 10 -20 1..3 -each s a b -zip v s -report c_k pe -jobs 3 -anew -threads 2")
            .unwrap();
        let [List::Each(v, values), List::Each(..)] = &r.lists[..] else { panic!("{r:?}") };
        assert_eq!((v.as_str(), values.join(" ").as_str()), ("v", "10 -20 1..3"));
        assert_eq!((r.jobs, r.anew, r.options.threads, r.report.len()), (Some(3), true, Some(2), 2));
        assert_eq!(r.folder("sweep"), PathBuf::from("in.x.sweep"));
        let r = read("-table runs.csv dir/in.y -out here -var w 1 2").unwrap();
        assert_eq!(r.folder("sweep"), PathBuf::from("here"));
        assert_eq!(
            (r.lists, r.options.deck),
            (vec![List::Table("runs.csv".into())], Deck::File("dir/in.y".into()))
        );
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        for line in [
            "in.x -each v",
            "in.x -each v 1 2 -safe",
            "in.x -each",
            "in.x -zip a",
            "in.x -jobs 0",
            "in.x -jobs many",
            "in.x -retry",
            "in.x -each v 1 -var v 2",
            "in.x -log a",
            "in.x -screen a",
            "in.x -echo both",
            "in.x -each v 1 2 -partition 2x1",
            "-status",
        ] {
            assert!(read(line).is_err(), "{line}");
        }
        assert!(read("in.x -eahc v 1").unwrap_err().help.unwrap().contains("-each"));
        assert!(read("in.x -screen none -each v 1").is_ok());
    }
}
