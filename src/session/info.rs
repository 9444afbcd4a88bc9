//! `info`: what the session holds, in LAMMPS' categories.

use super::{Session, timer};
use crate::graph::catalogue::{self, Tables};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{Alternative, Kind, Part, Value, Words};
use std::fmt::Write;
use std::path::Path;

/// The categories, each with what it shows.
const CATEGORIES: [(&str, &str); 16] = [
    ("all", "Everything."),
    ("configuration", "Version and system."),
    ("memory", "How much memory is used."),
    ("communication", "Processes and threads."),
    ("system", "Units, atom style, particles, box, time step."),
    ("coeffs", "Which pairs of types have coefficients."),
    ("groups", "The groups."),
    ("regions", "The regions."),
    ("computes", "The computes."),
    ("dumps", "The dumps."),
    ("fixes", "The fixes."),
    ("variables", "The variables."),
    ("time", "The time since the session began."),
    ("styles", "Which styles there are, of one kind or all."),
    ("accelerator", "None here."),
    ("fft", "None here."),
];

const LINE: &str = "Info-Info-Info-Info-Info-Info-Info-Info-Info-Info-Info";

/// The place of `styles` among them.
const STYLES: usize = 13;

/// The words of an `info` line.
#[derive(Words)]
pub struct Info {
    #[word(name = "category", least = 1)]
    wanted: Vec<Wanted>,
}

/// What a word of the line requests.
enum Wanted {
    Out(Target),
    Category(&'static str),
    Styles(&'static str),
}

/// Where the text goes.
#[derive(Words)]
#[word(what = "target")]
enum Target {
    /// The screen alone.
    Screen,
    /// The log file.
    Log,
    /// The end of a file.
    Append(#[word(name = "FILE", what = "a file name", kind = Kind::File)] Word),
    /// A file of its own.
    Overwrite(#[word(name = "FILE", what = "a file name", kind = Kind::File)] Word),
}

/// The kinds of styles that `styles` shows, as choices.
const KINDS: [Alternative; catalogue::CATEGORIES.len() + 1] = {
    let mut all = [Alternative { word: "all", about: "", parts: &[] }; catalogue::CATEGORIES.len() + 1];
    let mut k = 0;
    while k < catalogue::CATEGORIES.len() {
        all[k].word = catalogue::CATEGORIES[k];
        k += 1;
    }
    all
};

/// All words of a line, as choices.
const WORDS: [Alternative; CATEGORIES.len() + 1] = {
    const OUT: &[Part] = &[Part::bare("target", Target::KIND)];
    const OF_STYLES: &[Part] = &[Part::Maybe(&[Part::bare("kind", Kind::Choice(&KINDS))])];
    let out =
        Alternative { word: "out", about: "Where the text goes; without it to the screen.", parts: OUT };
    let mut all = [out; CATEGORIES.len() + 1];
    let mut k = 0;
    while k < CATEGORIES.len() {
        let (word, about) = CATEGORIES[k];
        let parts = if k == STYLES { OF_STYLES } else { &[] };
        all[k] = Alternative { word, about, parts };
        k += 1;
    }
    all
};

impl Value for Wanted {
    const KIND: Kind = Kind::Choice(&WORDS);
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("a category such as system or variables")?;
        if word.text == "out" {
            return Target::value("target", args, cx).map(Self::Out);
        }
        Ok(match category(word)? {
            "styles" => Self::Styles(styles(args)),
            one => Self::Category(one),
        })
    }
}

impl Session {
    /// The `info` command.
    ///
    /// # Errors
    /// Unknown categories, files that cannot be written.
    pub(super) fn info(&mut self, line: Info) -> Result<()> {
        let mut text = format!("{LINE}\n");
        let mut target = Target::Screen;
        for wanted in line.wanted {
            match wanted {
                Wanted::Out(other) => target = other,
                Wanted::Styles(which) => text += &list_of_styles(&self.graph.tables, which),
                Wanted::Category("all") => {
                    CATEGORIES[1..].iter().for_each(|(name, _)| text += &self.category(name));
                }
                Wanted::Category(one) => text += &self.category(one),
            }
        }
        let _ = write!(text, "{LINE}");
        let append = matches!(target, Target::Append(_));
        if self.looking() {
            if let Target::Append(word) | Target::Overwrite(word) = target {
                self.world.promised.print(&word.text, Some(text), append);
            }
            return Ok(());
        }
        match target {
            Target::Screen => self.options.log.to_screen(&text),
            Target::Log => self.options.log.to_log(&text)?,
            Target::Append(word) | Target::Overwrite(word) => {
                use std::io::Write;
                let path = Path::new(&word.text);
                let mut out = perigrain_output::file::open(path, append).map_err(|e| e.at(word.span))?;
                let failed = writeln!(out, "{text}").and_then(|()| out.flush());
                failed.map_err(|e| perigrain_output::file::trouble("write", path, &e).at(word.span))?;
            }
        }
        Ok(())
    }

    fn category(&self, name: &str) -> String {
        match name {
            "configuration" => format!(
                "\nperigrain version: {}\nReads decks of LAMMPS 22 Jul 2025 / 20250722\nOS information: {} {}\n",
                env!("CARGO_PKG_VERSION"),
                std::env::consts::OS,
                std::env::consts::ARCH
            ),
            "memory" => format!(
                "\nMemory allocation information:\nParticles, lists and families: {:.4} Mbyte\n",
                self.bytes() as f64 / 1048576.0
            ),
            "communication" => {
                format!(
                    "\nCommunication information:\nNprocs = 1,   Nthreads = {}\n",
                    perigrain_base::par::most_threads()
                )
            }
            "system" => self.system_text(),
            "coeffs" => self.coeffs_text(),
            "groups" | "regions" | "computes" | "dumps" | "fixes" => self.declared_text(name),
            "variables" => self.variables_text(),
            "time" => format!(
                "\nTotal time information:\n Wall time:    {}\n",
                timer::clock(self.born.elapsed().as_secs())
            ),
            "styles" => list_of_styles(&self.graph.tables, "all"),
            "accelerator" => {
                "\nAccelerator configuration:\nnone: perigrain has no such packages\n".to_owned()
            }
            _ => "\nFFT information:\nnone: perigrain has no long-range forces\n".to_owned(),
        }
    }

    fn system_text(&self) -> String {
        let w = &self.world;
        let style = &w.particles.style;
        let atom = if style.sphere && style.peri { "hybrid sphere peri" } else { style.name() };
        let pair = self.graph.pair.as_ref().map_or("none", |p| p.pair.facts().name);
        let mut text = format!(
            "\nSystem information:\nUnits         = {}\nAtom style    = {atom}\nAtoms     = {:>12},  types = {:>8},  style = {pair}\nDimensions = {}\n",
            w.settings.units.name(),
            w.n(),
            w.types,
            if w.settings.two_dimensional { 2 } else { 3 },
        );
        match &*w.domain {
            None => text += "\nBox has not yet been created\n",
            Some(d) => {
                let l = d.lengths();
                let kind = if d.tilt.is_some() { "Triclinic" } else { "Orthogonal" };
                let _ = writeln!(text, "{kind} box = {} x {} x {}", l[0], l[1], l[2]);
                if let Some([xy, xz, yz]) = d.tilt {
                    let _ = writeln!(text, "Xy, xz, yz = {xy}, {xz}, {yz}");
                }
                for (k, axis) in ["x", "y", "z"].iter().enumerate() {
                    let _ = writeln!(text, "{axis}lo, {axis}hi = {}, {}", d.lo[k], d.hi[k]);
                }
            }
        }
        let _ = writeln!(
            text,
            "Current timestep number = {}\nCurrent timestep size = {}",
            w.clock.step, w.clock.dt
        );
        text
    }

    fn coeffs_text(&self) -> String {
        let mut text = "\nCoeff status information:\n".to_owned();
        let Some(node) = &self.graph.pair else { return text };
        text += "\nPair coeffs\n";
        let types = self.world.types as u16;
        for i in 1..=types {
            for j in i..=types {
                let state = if node.pair.covers(i, j) { "is set" } else { "is not set" };
                let _ = writeln!(text, "{i:>6} {j:>6}: {state}");
            }
        }
        text
    }

    fn declared_text(&self, category: &str) -> String {
        let w = &self.world;
        let mut text = String::new();
        let comma = |s: &str| format!("{s},");
        match category {
            "groups" => {
                text += "\nGroup information:\n";
                for (k, name) in w.groups.names().enumerate() {
                    let dynamic = w.groups.find(name).is_some_and(|id| w.groups.dynamic(id).is_some());
                    let kind = if dynamic { "(dynamic)" } else { "(static)" };
                    let _ = writeln!(text, "Group[{k:>2}]:     {name:<16} {kind}");
                }
            }
            "regions" => {
                text += "\nRegion information:\n";
                for (k, (name, region)) in w.regions.iter().enumerate() {
                    let _ = write!(text, "Region[{k:>3}]:  {:<16}", comma(name.text()));
                    let _ = match region.bounds() {
                        Some((lo, hi)) => writeln!(
                            text,
                            " Boundary:  lo {} {} {}  hi {} {} {}",
                            lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]
                        ),
                        None => writeln!(text, " No Boundary"),
                    };
                }
            }
            "computes" => {
                text += "\nCompute information:\n";
                for (k, c) in self.graph.computes.iter().enumerate() {
                    let _ = writeln!(text, "Compute[{k:>3}]:  {:<16} style = {}", comma(&c.id), c.style);
                }
            }
            "dumps" => {
                text += "\nDump information:\n";
                for (k, d) in self.graph.dumps.iter().enumerate() {
                    let (id, style) = (comma(&d.id), comma(d.style));
                    let _ =
                        writeln!(text, "Dump[{k:>3}]:     {id:<16} style = {style:<16} every = {}", d.every);
                }
            }
            _ => {
                text += "\nFix information:\n";
                for (k, f) in self.graph.fixes.iter().enumerate() {
                    let (id, style) = (comma(&f.id), comma(f.style));
                    let group = w.groups.name(f.group);
                    let _ = writeln!(text, "Fix[{k:>3}]:      {id:<16} style = {style:<16} group = {group}");
                }
            }
        }
        text
    }

    fn variables_text(&self) -> String {
        let mut text = "\nVariable information:\n".to_owned();
        for (k, name) in self.vars.names().enumerate() {
            let style = self.vars.kind(name).map_or("", |k| k.name());
            let (id, style) = (format!("{name},"), format!("{style},"));
            let definition = self.vars.definition(name).unwrap_or_default();
            let _ = writeln!(text, "Variable[{k:>3}]: {id:<16} style = {style:<16} def = {definition}");
        }
        text
    }
}

/// The category a word names; as in LAMMPS its beginning is enough.
fn category(word: &Word) -> Result<&'static str> {
    let mut names = CATEGORIES.iter().map(|(name, _)| *name);
    if let Some(found) = names.find(|name| !word.text.is_empty() && name.starts_with(word.text.as_str())) {
        return Ok(found);
    }
    let names = CATEGORIES.map(|(name, _)| name);
    let text = format!("`{}` is no category of info", word.text);
    let d = Diagnostic::error(Code::UNKNOWN_KEYWORD, word.span, text);
    Err(match perigrain_base::diag::nearest(&word.text, names) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help(format!("out, or one of {}", names.join(" "))),
    }
    .into())
}

/// The category of styles that may follow.
fn styles(args: &mut Args) -> &'static str {
    let next = args.peek_text();
    let Some(found) = KINDS.iter().find(|kind| kind.word == next) else { return "all" };
    args.next();
    found.word
}

fn list_of_styles(tables: &Tables, which: &str) -> String {
    let mut text = "\nStyles information:\n".to_owned();
    for kind in catalogue::CATEGORIES.into_iter().filter(|kind| which == "all" || which == *kind) {
        let mut names = tables.names(kind).unwrap_or_default();
        names.sort_unstable();
        let title = kind[..1].to_uppercase() + &kind[1..];
        let _ = writeln!(text, "\n{title} styles:\n\n{}", names.join(" "));
    }
    text
}
