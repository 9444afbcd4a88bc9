//! Averages of LIGGGHTS over bins, and steps of limited length: words that LAMMPS has since changed.

use crate::Translator;
use crate::native::{Line, instead};
use crate::reading::{choice, number, unknown, without_counterpart};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Command};

/// Keywords that belong to the averages, each with its number of values.
const KEPT: &[(&str, usize)] =
    &[("norm", 1), ("file", 1), ("overwrite", 0), ("title1", 1), ("title2", 1), ("title3", 1)];

impl Translator {
    /// `fix ID group ave/spatial Nevery Nrepeat Nfreq dim origin delta … values keywords`: `compute ID_bins chunk/atom`, and `fix ave/chunk`.
    pub(crate) fn bins(&mut self, cmd: &Command, args: &mut Args) -> Result<Option<Vec<Command>>> {
        let id = &cmd.args[0];
        let name = instead(id, format!("{}_bins", id.text));
        let mut bins = Line::new(cmd, "compute");
        bins.word(&name).word(&cmd.args[1]).put("chunk/atom", cmd.args[2].span);
        let mut line = Line::styled(cmd, "ave/chunk");
        for what in ["how often values are read", "how many are averaged", "how often averages are made"] {
            line.word(&number(args, what)?);
        }
        line.word(&name);
        let (mut axes, at) = (vec![], args.here());
        while args.peek().is_some_and(|word| ["x", "y", "z"].contains(&word.text.as_str())) {
            for what in ["an axis", "the origin of the bins", "the thickness of the bins"] {
                axes.push(args.expect(what)?.clone());
            }
        }
        if axes.is_empty() {
            let text = "`ave/spatial` lacks its bins";
            let d = Diagnostic::error(Code::MISSING_ARGUMENT, at, text);
            return Err(d.help("write `z lower 0.01` behind the three numbers").into());
        }
        bins.put(&format!("bin/{}d", axes.len() / 3), axes[0].span).words(&axes);
        while let Some(word) = args.next() {
            let text = word.text.as_str();
            match text {
                "units" | "region" => drop(bins.word(word).word(args.expect("a value")?)),
                "ave" => {
                    line.word(word).word(args.expect("how averages continue")?);
                    if let Some(count) = args.peek().filter(|w| w.text.parse::<f64>().is_ok()).cloned() {
                        args.next();
                        line.word(&count);
                    }
                }
                "write_ts" => {
                    choice(args, "state", &["yes", "no"])?;
                    self.idle(word, "each block of averages has a line with its step");
                }
                "std" => {
                    let help = "`compute reduce … ave` and `avesq` of the values";
                    return Err(without_counterpart(word, "deviations from averages", help).into());
                }
                _ if KEPT.iter().any(|(known, _)| *known == text) => {
                    line.word(word);
                    let count = KEPT.iter().find(|(known, _)| *known == text).map_or(0, |(_, n)| *n);
                    for _ in 0..count {
                        line.word(args.expect("a value")?);
                    }
                }
                _ => drop(line.word(word)),
            }
        }
        self.bins.insert(id.text.clone());
        Ok(Some(vec![bins.done(), line.done()]))
    }
}

/// `fix ID group nve/limit absolute X`, or `radius_ratio F` of each radius (measured: a step of F R).
pub(crate) fn limit(cmd: &Command, args: &mut Args) -> Result<Option<Vec<Command>>> {
    let Some(word) = args.peek().cloned() else { return Ok(None) };
    match word.text.as_str() {
        "absolute" => {
            let mut line = Line::styled(cmd, "nve/limit");
            args.next();
            line.words(args.rest());
            Ok(Some(vec![line.done()]))
        }
        "radius_ratio" => {
            let mut line = Line::styled(cmd, "nve/limit");
            line.put("radius", word.span);
            args.next();
            line.words(args.rest());
            Ok(Some(vec![line.done()]))
        }
        text if text.parse::<f64>().is_ok() || word.unknown || text.contains('$') => Ok(None),
        _ => Err(unknown(&word, "way to limit steps", &["absolute", "radius_ratio"]).into()),
    }
}
