//! `write_restart` and `read_restart`: a session continues in another run of the program.

use super::{Session, refuse};
use crate::graph::Role;
use crate::graph::build::declare;
use crate::graph::declaration::Context;
use crate::graph::regions::place_all;
use crate::graph::restarts::writing::{claimable, save};
use crate::graph::restarts::{divided, pattern};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, unseen};
use perigrain_base::gate;
use perigrain_fixes::python_invoke::HOST;
use perigrain_lang::{Command, Word};
use perigrain_output::restart::{Saved, fingerprint, read, resume};
use perigrain_styles::words::Words;
use perigrain_world::{DeclaredLine, Halt, Key, Numbers, Particles, Promise, Unseen, World};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Facts of a scene that a restart file settles.
const SETTLES: [&str; 5] = ["particles", "volume", "density", "mass", "diameter"];

/// The words of a `write_restart` line.
#[derive(Words)]
pub struct WriteRestart {
    /// The file; `*` in its name becomes the step.
    #[word(name = "FILE", what = "a file name", kind = Kind::File)]
    file: Word,
}

/// The words of a `read_restart` line.
#[derive(Words)]
pub struct ReadRestart {
    /// The file; a `*` in its name stands for the latest step.
    #[word(name = "FILE", what = "a file name", kind = Kind::File)]
    file: Word,
    /// Without effect: particles outside a periodic box are wrapped anyway.
    #[word(flag, placed)]
    remap: Option<Span>,
}

impl Session {
    pub(super) fn write_restart(&mut self, cmd: &Command) -> Result<()> {
        if self.world.domain.is_none() {
            return refuse(Code::WRONG_ORDER, cmd.span, "there is nothing to write: no box has been defined");
        }
        let word = self.read_line_or::<WriteRestart>(cmd, divided)?.file;
        let name = pattern(&word.text).map_err(|e| e.at(word.span))?;
        self.record(cmd, Role::Act, None, vec![], vec![]);
        if self.looking() {
            self.promise_restart(name.text().to_string());
            return Ok(());
        }
        self.save_restart(&word.text).map_err(|e| e.at(word.span))?;
        self.report_file(&word.text);
        Ok(())
    }

    /// Writes the scene as it is to a restart file; `*` in its name stands for the step.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub(super) fn save_restart(&mut self, name: &str) -> Result<()> {
        let name = pattern(name)?;
        self.world.spread_type_masses();
        let path = name.at(self.world.clock.step);
        let (pair, declared) = (self.graph.force_lines(), self.graph.declared());
        save(&path, &self.world, self.ran, &pair, &declared)
    }

    /// Where nothing is written: files that a line would have written, for the lines that read them.
    pub(super) fn promise_restart(&mut self, name: String) {
        let scene = Promise::Scene(Arc::new(self.world.clone()), self.graph.force_lines());
        self.world.promised.keep(&name, scene);
    }

    /// Where nothing is written: files that a run would have written.
    pub(super) fn promise_outputs(&mut self) {
        self.graph.restarts.names().into_iter().for_each(|name| self.promise_restart(name));
        let fixes = self.graph.fixes.iter().filter_map(|f| f.fix.facts(&self.world).file);
        let fixes: Vec<String> = fixes.filter_map(|path| path.to_str().map(str::to_string)).collect();
        let dumps = self.graph.dumps.iter().map(|d| &d.file);
        let promised = &mut self.world.promised;
        fixes.iter().chain(dumps).for_each(|name| promised.keep(name, Promise::Unseen));
    }

    pub(super) fn read_restart(&mut self, cmd: &Command) -> Result<()> {
        if self.world.domain.is_some() {
            return Err(Diagnostic::error(
                Code::WRONG_ORDER,
                cmd.name.span,
                "read_restart brings the box along, and the box is defined already",
            )
            .help("put `clear` before this line")
            .into());
        }
        let ReadRestart { file: word, remap } = self.read_line(cmd)?;
        let word = &word;
        pattern(&word.text).map_err(|e| e.at(word.span))?;
        if let Some(span) = remap {
            let text = "without effect: particles outside a periodic box are wrapped anyway";
            self.notes.push(Diagnostic::note(Code::NO_EFFECT, span, text));
        }
        let began = std::time::Instant::now();
        let (path, saved) = match self.promised(word)? {
            Some(saved) => (PathBuf::from(&word.text), saved),
            None => {
                let path = self.find(word)?;
                self.world.read_files.note(&path);
                let saved = read(&path).map_err(|e| e.at(word.span))?;
                (path, saved)
            }
        };
        self.enter(saved, cmd.span)?;
        self.record(cmd, Role::Act, None, vec![], SETTLES.to_vec());
        if self.checking() {
            return Ok(());
        }
        self.log_restart(&path)?;
        let text = format!("  read_restart CPU = {:.3} seconds", began.elapsed().as_secs_f64());
        self.options.log.line_or(&text, None)
    }

    /// Where nothing is written: the scene that an earlier line would have written.
    fn promised(&self, word: &Word) -> Result<Option<Saved>> {
        let (name, span) = (word.text.as_str(), word.span);
        if !self.looking() {
            return Ok(None);
        }
        let promised = &self.world.promised;
        Ok(match promised.get(name) {
            Some(Promise::Scene(world, pair)) => Some(Saved {
                world: world.stored(),
                ran: false,
                standing: false,
                pair: pair.clone(),
                declared: vec![],
            }),
            Some(Promise::Text(_)) => {
                let text =
                    format!("the restart file `{name}` is none of perigrain: the deck prints text into it");
                return refuse(Code::BAD_FILE, span, text);
            }
            Some(Promise::Unseen) => return Err(unseen(span, name)),
            None if promised.anything && self.find(word).is_err() => return Err(unseen(span, name)),
            None => None,
        })
    }

    /// The file that a word names: beside the working folder, with a `*` the one of the latest step.
    fn find(&self, word: &Word) -> Result<PathBuf> {
        let missing = |text: String| -> Diagnostics {
            Diagnostic::error(Code::NO_FILE, word.span, text)
                .help("it is looked for in the working folder and beside the deck")
                .into()
        };
        let places = [PathBuf::new(), self.world.folder.clone()];
        if !word.text.contains('*') {
            let mut paths = places.iter().map(|p| p.join(&word.text));
            let found = paths.find(|p| gate::refuses(p) || gate::exists(p));
            return found.ok_or_else(|| missing(format!("there is no restart file `{}`", word.text)));
        }
        let latest = places.iter().find_map(|p| latest(&p.join(&word.text)));
        latest.ok_or_else(|| missing(format!("no file `{}` has a step in the place of the `*`", word.text)))
    }

    /// Makes a stored scene the present one.
    fn enter(&mut self, saved: Saved, span: Span) -> Result<()> {
        let Saved { mut world, ran, standing, pair, declared } = saved;
        world.fall_back();
        world.register(self.graph.tables.registrations());
        let resume = resume(&world, declared);
        let old = &mut self.world;
        let (settings, now) = (&mut world.settings, &old.settings);
        settings.stop = now.stop.clone();
        (settings.deadline, settings.limit_every, settings.agreed) =
            (now.deadline, now.limit_every, now.agreed);
        (settings.force_list, settings.no_skipping) = (now.force_list, now.no_skipping);
        (settings.portable, settings.compat) = (now.portable, now.compat);
        if let Some(families) = &mut *world.families {
            (families.options.skip_rest, families.options.portable) = (!now.no_skipping, now.portable);
        }
        world.folder = std::mem::take(&mut old.folder);
        world.read_files = std::mem::take(&mut old.read_files);
        world.promised = std::mem::take(&mut old.promised);
        if let Some(host) = old.facts.remove(*HOST) {
            world.facts.insert(*HOST, host);
        }
        (world.clock.running, world.clock.halt) = (false, Halt::No);
        let state = world.memo.keys().map(Key::text).chain(world.columns.names()).filter(|n| claimable(n));
        let names = world.regions.keys().map(|n| format!("region/{n}"));
        let names = names.chain(world.materials.keys().map(|n| format!("material/{n}")));
        world.restored = names.chain(state.map(str::to_string)).collect();
        if self.checking() {
            *world.unseen = Unseen { space: world.unseen.space, ..Unseen::in_a_check() };
        }
        self.world = world;
        self.scenes += 1;
        self.replay(&pair, span)?;
        self.world.touch();
        self.world.resume = standing.then(|| Arc::new(resume));
        self.ran = ran;
        if self.checking() {
            without_particles(&mut self.world);
        }
        Ok(())
    }

    /// Repeats the lines of the stored pair and bond styles, each with the lattice that was in force. Changes of their
    /// coefficients by fixes are kept.
    fn replay(&mut self, pair: &[DeclaredLine], span: Span) -> Result<()> {
        let (lattice, adapted) = (self.world.lattice.clone(), self.world.adaptations_made());
        (self.graph.pair, self.graph.bond) = (None, None);
        for lines in pair {
            self.world.lattice = lines.lattice.clone();
            let mut words = lines.words.iter().map(|w| Word::new(w.as_str(), span));
            let Some(name) = words.next() else { continue };
            let text = lines.words.join(" ");
            let cmd = Command { name, args: words.collect(), span, text };
            let (notes, uses) = (RefCell::default(), RefCell::default());
            let cx = Context { span, checking: self.checking(), notes: &notes, uses: &uses };
            declare(&mut self.graph, &mut self.world, &cmd, &cx)?;
        }
        self.world.lattice = lattice;
        self.world.memo.extend(adapted);
        Ok(())
    }

    fn log_restart(&self, path: &Path) -> Result<()> {
        let (log, w) = (&self.options.log, &self.world);
        let mut lines = vec![format!("Reading restart file {} ...", path.display())];
        lines.push(format!("  restoring atom style {} from restart", w.particles.style.name()));
        if let Some(d) = &*w.domain {
            lines.push(format!("  {}", d.describe(d.lo, d.hi)));
        }
        if let Some(node) = &self.graph.pair {
            lines.push(format!("  restoring pair style {} from restart", node.pair.facts().name));
        }
        if let Some(node) = &self.graph.bond {
            lines.push(format!("  restoring bond style {} from restart", node.force.name()));
        }
        let count = format!("  {} atoms at step {}", w.n(), w.clock.step);
        log.line_or(&lines.join("\n"), None)?;
        log.line_or(&count, Some(&format!("Reading restart file {}:{}", path.display(), &count[1..])))
    }

    /// At the first run after read_restart: whether the scene with its forces is still the one that was stored, and what
    /// becomes of state that no fix has claimed.
    pub(super) fn settle_resume(&mut self, span: Span) -> Result<()> {
        self.drop_unclaimed(span);
        let Some(resume) = self.world.resume.take() else { return Ok(()) };
        place_all(&mut self.world, &self.graph, &self.vars);
        let declared = self.graph.declared();
        let other = declared.iter().find(|l| !resume.declared.contains(l));
        let gone = resume.declared.iter().find(|l| !declared.contains(l));
        let why = match (other, gone) {
            (Some(line), _) => format!("the restart file was not written under `{line}`"),
            (None, Some(line)) => format!("the restart file was written under `{line}`"),
            _ if declared != resume.declared => "the declarations come in another order".to_string(),
            _ if fingerprint(&self.world, &resume) != resume.fingerprint => {
                "settings, particles or bonds are not those of the restart file".to_string()
            }
            _ => {
                *self.world.changed = false;
                return Ok(());
            }
        };
        if self.world.settings.lammps() {
            return Ok(());
        }
        self.options.log.line(&format!("  forces are computed anew: {why}"))
    }

    /// State of fixes that the deck has not declared again is dropped, as in LAMMPS.
    fn drop_unclaimed(&mut self, span: Span) {
        let left = std::mem::take(&mut *self.world.restored);
        let state: Vec<String> =
            left.into_iter().filter(|n| !n.starts_with("region/") && !n.starts_with("material/")).collect();
        if state.is_empty() {
            return;
        }
        for name in &state {
            let key: Numbers = Key::new(name);
            self.world.memo.remove(key);
            self.world.columns.remove(key);
        }
        let text = format!(
            "the restart file holds state of {}, which no fix or compute has claimed: it is dropped",
            state.join(", ")
        );
        let note = Diagnostic::note(Code::SUSPICIOUS, span, text);
        self.note_once(
            note.help("declare a fix of the same style and ID before the run to continue with its state"),
        );
    }
}

/// The file of the latest step among those that fit a name with a `*`.
fn latest(pattern: &Path) -> Option<PathBuf> {
    let name = pattern.file_name()?.to_str()?;
    let (before, after) = name.split_once('*')?;
    let folder = match pattern.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let step = |file: &str| -> Option<u64> {
        let step = file.strip_prefix(before)?.strip_suffix(after)?;
        step.bytes().all(|b| b.is_ascii_digit()).then(|| step.parse().ok()).flatten()
    };
    let files = gate::names(folder).ok()?;
    let names = files.iter().filter_map(|f| f.file_name()?.to_str().map(String::from));
    let last = names.filter_map(|n| step(&n).map(|s| (s, n))).max()?;
    Some(pattern.with_file_name(last.1))
}

/// `perigrain check` keeps no particles.
fn without_particles(w: &mut World) {
    w.particles = Particles { style: w.particles.style, ..Particles::default() };
    w.families = None.into();
    w.contacts.clear();
    w.wall_contacts.clear();
    w.columns = Default::default();
    (w.bonds.list, w.bonds.special, w.bonds.angles.list) = (vec![], vec![], vec![]);
    w.tally = Default::default();
    w.rebuild = Default::default();
}
