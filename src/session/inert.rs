//! Commands about processes and accelerators: read whole, with one note that they have no effect; and `partition`.

use super::{Session, refuse};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Command, Script};

const PACKAGES: [&str; 5] = ["gpu", "intel", "kokkos", "omp", "opt"];

impl Session {
    /// Handles a command that LAMMPS needs for its processes and accelerators; `false` if it is none.
    ///
    /// # Errors
    /// Every mistake in the line.
    pub(super) fn inert(&mut self, cmd: &Command) -> Result<bool> {
        let mut args = Args::new(cmd);
        let why = match cmd.name.text.as_str() {
            "suffix" => {
                suffix(&mut args)?;
                "perigrain chooses its kernels itself"
            }
            "package" => {
                if self.world.domain.is_some() {
                    let text = "`package` must come before the simulation box is defined";
                    return refuse(Code::WRONG_ORDER, cmd.span, text);
                }
                args.choice("package", &PACKAGES)?;
                args.rest();
                "perigrain chooses its kernels itself; threads are set by `-threads N`"
            }
            "comm_style" => {
                let style = args.choice("communication style", &["brick", "tiled"])?;
                args.finish()?;
                self.world.settings.tiled = style == "tiled";
                "the box is not divided among processes"
            }
            "balance" => {
                balance(&mut args)?;
                "the box is not divided among processes, and threads share the work by themselves"
            }
            _ => return Ok(false),
        };
        let text = format!("`{}` is without effect here: {why}", cmd.name.text);
        if self.noted.insert(cmd.name.text.clone()) {
            self.notes.push(Diagnostic::note(Code::NO_EFFECT, cmd.span, text));
        }
        Ok(true)
    }

    /// `partition yes|no N command …`.
    ///
    /// # Errors
    /// A partition that does not exist, and what the command refuses.
    pub(super) fn partition(&mut self, script: &mut Script, cmd: &Command) -> Result<Option<i32>> {
        let mut args = Args::new(cmd);
        let wanted = args.flag("whether these or the other partitions are meant")?;
        let which = args.expect("the number of a partition")?;
        let (own, of) = self.vars.partition();
        let Some((first, last)) = range(&which.text, of) else {
            let text = match of {
                1 => format!("`{}` is no partition: there is one, with the number 1", which.text),
                _ => format!("`{}` names no partitions: they have the numbers 1 to {of}", which.text),
            };
            return refuse(Code::BAD_VALUE, which.span, text);
        };
        let name = args.expect("a command")?.clone();
        if wanted != (first..=last).contains(&(own + 1)) {
            return Ok(None);
        }
        let words = args.rest().to_vec();
        let text =
            std::iter::once(&name).chain(&words).map(|w| w.text.as_str()).collect::<Vec<_>>().join(" ");
        let span = words.last().map_or(name.span, |w| name.span.to(w.span));
        self.command(script, &Command { name, args: words, span, text })
    }
}

/// The numbers that `3`, `*`, `*3`, `2*` or `2*3` mean.
fn range(word: &str, of: usize) -> Option<(usize, usize)> {
    let number = |word: &str, open: usize| match word {
        "" => Some(open),
        word => word.parse().ok().filter(|n| (1..=of).contains(n)),
    };
    let (first, last) = match word.split_once('*') {
        Some((a, b)) => (number(a, 1)?, number(b, of)?),
        None => (number(word, 0).filter(|n| *n > 0)?, number(word, 0)?),
    };
    (first <= last).then_some((first, last))
}

/// `off`, `on`, a package, or `hybrid` with two of them.
fn suffix(args: &mut Args) -> Result<()> {
    const KNOWN: [&str; 8] = ["off", "on", "hybrid", "gpu", "intel", "kk", "omp", "opt"];
    if args.choice("suffix", &KNOWN)? == "hybrid" {
        args.choice("first suffix", &KNOWN[3..])?;
        args.choice("second suffix", &KNOWN[3..])?;
    }
    args.finish()
}

/// `balance thresh x|y|z uniform|FRACTIONS … | shift dims iterations stop | rcb`, then options.
fn balance(args: &mut Args) -> Result<()> {
    args.positive("the imbalance that is borne")?;
    let style = args.expect("a style: x, y, z, shift or rcb")?;
    match style.text.as_str() {
        "x" | "y" | "z" => {
            if !args.eat("uniform") {
                args.non_negative("uniform, or the places of the cuts")?;
                while args.peek_text().parse::<f64>().is_ok() {
                    args.non_negative("a cut")?;
                }
            }
            while ["x", "y", "z"].contains(&args.peek_text()) {
                args.next();
                if !args.eat("uniform") {
                    args.non_negative("uniform, or the places of the cuts")?;
                }
            }
        }
        "shift" => {
            let dims = args.expect("the directions, as xyz")?;
            if dims.text.is_empty() || !dims.text.chars().all(|c| "xyz".contains(c)) {
                let text = format!("`{}` names no directions: write some of x, y, z", dims.text);
                return refuse(Code::BAD_VALUE, dims.span, text);
            }
            args.integer_from(1, "the number of iterations")?;
            args.positive("the imbalance at which to stop")?;
        }
        "rcb" => {}
        other => {
            let text = format!("unknown style of balance: `{other}`; one of x y z shift rcb");
            return refuse(Code::UNKNOWN_STYLE, style.span, text);
        }
    }
    while let Some(word) = args.next() {
        match word.text.as_str() {
            "old" => {}
            "out" => {
                args.expect("a file name")?;
            }
            "weight" => {
                args.choice("weight", &["group", "neigh", "time", "var", "store"])?;
                args.expect("what the weight is made from")?;
                while !["", "weight", "out", "old"].contains(&args.peek_text()) {
                    args.next();
                }
            }
            _ => return Err(args.unknown(word, &["weight", "out", "old"])),
        }
    }
    Ok(())
}
