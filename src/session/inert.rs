//! Commands about processes and accelerators: read whole, with one note that they have no effect; and `partition`.

use super::{Session, refuse};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Command, Script, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{Kind, Value, Words, alternatives, one_in};

/// The words of a `package` line.
#[derive(Words)]
pub struct Package {
    #[word(name = "package")]
    _package: Accelerator,
    #[word(name = "word")]
    _options: Vec<Word>,
}

/// LAMMPS' packages for accelerators.
#[derive(Words)]
#[word(what = "package")]
enum Accelerator {
    Gpu,
    Intel,
    Kokkos,
    Omp,
    Opt,
}

/// The words of a `suffix` line.
#[derive(Words)]
pub struct Suffix {
    #[word(name = "suffix")]
    _suffix: Suffixes,
}

/// No suffix, one, or two.
#[derive(Words)]
#[word(what = "suffix")]
enum Suffixes {
    Off,
    On,
    Hybrid(
        #[word(name = "SUFFIX", what = "first suffix")] Variant,
        #[word(name = "SUFFIX", what = "second suffix")] Variant,
    ),
    Gpu,
    Intel,
    Kk,
    Omp,
    Opt,
}

/// A suffix of LAMMPS' variants of styles.
struct Variant;

const VARIANTS: [(&str, ()); 5] = [("gpu", ()), ("intel", ()), ("kk", ()), ("omp", ()), ("opt", ())];

impl Value for Variant {
    const KIND: Kind = Kind::Choice(&alternatives(&VARIANTS));
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        one_in(what, args, &VARIANTS).map(|()| Self)
    }
}

/// The word of a `comm_style` line.
#[derive(Words)]
pub struct CommStyle {
    #[word(name = "style")]
    style: Dividing,
}

/// How LAMMPS divides the box among processes.
#[derive(PartialEq, Words)]
#[word(what = "communication style")]
enum Dividing {
    Brick,
    Tiled,
}

/// The words of a `partition` line.
#[derive(Words)]
pub struct Partition {
    /// With `yes` the command is carried out in these partitions as if it stood alone and passed over in the others, with `no` the other way round.
    #[word(name = "wanted", what = "whether these or the other partitions are meant")]
    wanted: bool,
    /// A number or a range: `*`, `*3`, `2*`, `2*3`.
    #[word(name = "N", what = "the number of a partition")]
    which: Word,
    #[word(name = "command", what = "a command")]
    command: Word,
    #[word(name = "word")]
    words: Vec<Word>,
}

impl CommStyle {
    /// Whether the box is divided into tiles.
    pub(super) fn is_tiled(&self) -> bool {
        self.style == Dividing::Tiled
    }
}

/// Why commands have no effect.
pub(super) const KERNELS: &str = "perigrain chooses its kernels itself";
pub(super) const THREADS: &str = "perigrain chooses its kernels itself; threads are set by `-threads N`";
pub(super) const WHOLE: &str = "the box is not divided among processes";
pub(super) const SHARED: &str =
    "the box is not divided among processes, and threads share the work by themselves";

impl Session {
    /// Refuses a line behind the box.
    ///
    /// # Errors
    /// There is a box.
    pub(super) fn before_box(&self, cmd: &Command) -> Result<()> {
        if self.world.domain.is_none() {
            return Ok(());
        }
        let text = format!("`{}` must come before the simulation box is defined", cmd.name.text);
        refuse(Code::WRONG_ORDER, cmd.span, text)
    }

    /// Notes, once, that a command has no effect.
    pub(super) fn is_idle(&mut self, cmd: &Command, why: &str) {
        let text = format!("`{}` is without effect here: {why}", cmd.name.text);
        if self.noted.insert(cmd.name.text.clone()) {
            self.notes.push(Diagnostic::note(Code::NO_EFFECT, cmd.span, text));
        }
    }

    /// `partition yes|no N command …`.
    ///
    /// # Errors
    /// A partition that does not exist, and what the command refuses.
    pub(super) fn partition(&mut self, script: &mut Script, cmd: &Command) -> Result<Option<i32>> {
        let Partition { wanted, which, command: name, words } = self.read_line(cmd)?;
        let (own, of) = self.vars.partition();
        let Some((first, last)) = range(&which.text, of) else {
            let text = match of {
                1 => format!("`{}` is no partition: there is one, with the number 1", which.text),
                _ => format!("`{}` names no partitions: they have the numbers 1 to {of}", which.text),
            };
            return refuse(Code::BAD_VALUE, which.span, text);
        };
        if wanted != (first..=last).contains(&(own + 1)) {
            return Ok(None);
        }
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

/// `balance thresh x|y|z uniform|FRACTIONS … | shift dims iterations stop | rcb`, then options.
pub(super) fn balance(args: &mut Args) -> Result<()> {
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
