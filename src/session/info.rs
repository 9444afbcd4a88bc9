//! `info`: what the session holds, in LAMMPS' categories.

use super::{Session, timer};
use crate::graph::catalogue::{self, Tables};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Word};
use std::fmt::Write;
use std::path::Path;

const CATEGORIES: [&str; 16] = [
    "all",
    "configuration",
    "memory",
    "communication",
    "system",
    "coeffs",
    "groups",
    "regions",
    "computes",
    "dumps",
    "fixes",
    "variables",
    "time",
    "styles",
    "accelerator",
    "fft",
];

const LINE: &str = "Info-Info-Info-Info-Info-Info-Info-Info-Info-Info-Info";

/// Where the text goes.
enum Target<'a> {
    Screen,
    Log,
    File(&'a Word, bool),
}

impl Session {
    /// The `info` command.
    ///
    /// # Errors
    /// Unknown categories, files that cannot be written.
    pub(super) fn info(&mut self, args: &mut Args) -> Result<()> {
        let mut text = format!("{LINE}\n");
        let mut target = Target::Screen;
        args.clone().expect("a category such as system or variables")?;
        while let Some(word) = args.next() {
            if word.text == "out" {
                target = match args.choice("target", &["screen", "log", "append", "overwrite"])? {
                    "screen" => Target::Screen,
                    "log" => Target::Log,
                    how => Target::File(args.expect("a file name")?, how == "append"),
                };
                continue;
            }
            let category = category(word)?;
            if category == "styles" {
                let which = styles(args);
                text += &list_of_styles(&self.graph.tables, which);
                continue;
            }
            match category {
                "all" => CATEGORIES[1..].iter().for_each(|c| text += &self.category(c)),
                one => text += &self.category(one),
            }
        }
        let _ = write!(text, "{LINE}");
        if self.looking() {
            if let Target::File(word, append) = target {
                self.world.promised.print(&word.text, Some(text), append);
            }
            return Ok(());
        }
        match target {
            Target::Screen => self.options.log.to_screen(&text),
            Target::Log => self.options.log.to_log(&text)?,
            Target::File(word, append) => {
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
    if let Some(c) = CATEGORIES.iter().find(|c| !word.text.is_empty() && c.starts_with(word.text.as_str())) {
        return Ok(c);
    }
    let text = format!("`{}` is no category of info", word.text);
    let d = Diagnostic::error(Code::UNKNOWN_KEYWORD, word.span, text);
    Err(match perigrain_base::diag::nearest(&word.text, CATEGORIES) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help(format!("out, or one of {}", CATEGORIES.join(" "))),
    }
    .into())
}

/// The category of styles that may follow.
fn styles(args: &mut Args) -> &'static str {
    let next = args.peek_text();
    let mut known = catalogue::CATEGORIES.into_iter().chain(["all"]);
    let Some(found) = known.find(|s| *s == next) else { return "all" };
    args.next();
    found
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
