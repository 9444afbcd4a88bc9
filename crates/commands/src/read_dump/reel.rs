//! Snapshots of several dumps one after the other, as `rerun` takes them.

use super::super::data::dump;
use super::snapshot::{enter, particles};
use super::{Wanted, Wish};
use perigrain_base::diag::{Code, Result, Source, fail};
use perigrain_geometry::text::{Lines, comes, find};
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{Grammar, Keyword, Kind, Part, Words, read};
use perigrain_world::World;
use std::sync::Arc;

/// Snapshots of several dumps one after the other, as `rerun` takes them.
pub struct Reel {
    files: std::vec::IntoIter<Word>,
    /// The file that is being read, and where its next snapshot begins.
    now: Option<(Arc<Source>, usize)>,
    /// The snapshot that comes next, once one has been taken.
    ahead: Option<Place>,
    /// No snapshot before this step.
    pub first: i64,
    /// None after this one.
    pub last: i64,
    every: i64,
    skip: i64,
    /// None may be behind this step.
    stop: i64,
    wish: Wish,
    /// Step of the last snapshot found.
    step: Option<i64>,
    /// Snapshots since one could have been taken.
    passed: i64,
}

/// Where a snapshot begins.
struct Place {
    text: Arc<Source>,
    at: usize,
    step: i64,
}

/// A snapshot that is in the world.
pub struct Shown {
    /// Its step.
    pub step: i64,
    /// Whether none follows.
    pub last: bool,
}

/// A `rerun` line.
pub struct Rerun {
    /// The snapshots.
    pub reel: Reel,
    /// Where ramps begin.
    pub start: Option<i64>,
    /// Where ramps end.
    pub stop: Option<i64>,
    /// Whether tables of time follow.
    pub post: bool,
}

/// The words of `rerun` before `dump`.
#[derive(Words)]
struct Snapshots {
    /// Text dumps, read one after the other.
    #[word(name = "FILE", what = "a dump to read", least = 1, kind = Kind::File)]
    files: Vec<Word>,
    /// Snapshots before this step are left out.
    #[word(keyword, name = "N", what = "the first step", from = 0, default = 0)]
    first: i64,
    /// Snapshots behind this step are left out.
    #[word(keyword, name = "N", what = "the last step", from = 0, default = i64::MAX, shown = "no limit")]
    last: i64,
    /// Steps of snapshots must be multiples of it; 0 takes all.
    #[word(keyword, name = "N", what = "the interval of snapshots", from = 0, default = 0)]
    every: i64,
    /// After the first snapshot one in `skip` is looked at.
    #[word(
        keyword,
        name = "N",
        what = "the number of snapshots for one that is read",
        from = 1,
        default = 1
    )]
    skip: i64,
    /// The first step of ramps, as for `run`.
    #[word(keyword, name = "N", what = "the first step of ramps", from = 0, shown = "first")]
    start: Option<i64>,
    /// The last step of ramps, as for `run`; no snapshot may be behind it.
    #[word(keyword, name = "N", what = "the last step of ramps", from = 0, shown = "last")]
    stop: Option<i64>,
    /// Whether tables of time follow.
    #[word(keyword, default = false)]
    post: bool,
}

/// The end of a `rerun` line.
const FIELDS_OF_DUMPS: &Grammar = &Grammar {
    parts: &[],
    keywords: &[Keyword {
        word: "dump",
        values: &[Part::bare("fields", Kind::Words(Wanted::GRAMMAR))],
        about: "Must stand there: the fields to read and how, as for `read_dump`.",
        default: "",
        repeats: false,
    }],
    refused: &[],
};

/// A whole `rerun` line.
pub const RERUN: Grammar = Grammar {
    parts: &[Part::All(Snapshots::GRAMMAR), Part::All(FIELDS_OF_DUMPS)],
    keywords: &[],
    refused: &[],
};

impl Rerun {
    /// Reads the words of `rerun`.
    ///
    /// # Errors
    /// Every mistake in the line.
    pub fn read(a: &mut Args, cx: &BuildCx) -> Result<Self> {
        let mut chosen = a.until(|word| FIELDS_OF_DUMPS.has(word));
        let Snapshots { files, first, last, every, skip, start, stop, post } = read(&mut chosen, cx)?;
        a.expect("the keyword `dump` with the fields to read")?;
        let wish = Wish::read(a, cx)?;
        if last < first {
            return fail(
                Code::BAD_VALUE,
                a.span(),
                format!("`last` must not be before `first`: {last} is before {first}"),
            );
        }
        let (files, end) = (files.into_iter(), stop.unwrap_or(i64::MAX));
        let (now, ahead, step, passed) = (None, None, None, 0);
        let reel = Reel { files, now, ahead, first, last, every, skip, stop: end, wish, step, passed };
        Ok(Self { reel, start, stop, post })
    }
}

impl Reel {
    /// In check mode: all dumps are there, or may be there by then.
    ///
    /// # Errors
    /// One will not be.
    pub fn comes(&self, w: &World) -> Result<()> {
        self.files.as_slice().iter().try_for_each(|file| comes(w, file, "dump"))
    }

    /// Puts the next snapshot into the world; `None` when there is none.
    ///
    /// # Errors
    /// Dumps that cannot be read, or hold no snapshot that is wanted, or one behind the end of ramps.
    pub fn next(&mut self, w: &mut World) -> Result<Option<Shown>> {
        let place = match self.ahead.take() {
            Some(place) => Some(place),
            None if self.step.is_some() => None,
            None => Some(self.first_of_all(w)?),
        };
        let Some(Place { text, at, step }) = place else { return Ok(None) };
        if step > self.stop {
            let text = format!("the snapshot of step {step} is behind `stop`, which is {}", self.stop);
            return fail(Code::BAD_VALUE, self.wish.span, text);
        }
        self.show(&text, at, w).map_err(|e| e.within(&text))?;
        // The clock belongs to the snapshot regardless of `timestep`.
        w.clock.reset(step);
        self.ahead = self.find(w)?;
        Ok(Some(Shown { step, last: self.ahead.is_none() }))
    }

    /// Puts the snapshot that begins at a place of a file into the world.
    fn show(&self, text: &Source, at: usize, w: &mut World) -> Result<()> {
        let Some(s) = dump::next(&mut Lines::at(&text.text, at))? else { return Ok(()) };
        let list = particles(&s, &self.wish, w)?;
        enter(w, &s, &list, &self.wish);
        Ok(())
    }

    fn first_of_all(&mut self, w: &World) -> Result<Place> {
        let Some(place) = self.find(w)? else {
            let text = match self.last {
                i64::MAX => format!("the dumps have no snapshot from step {} on", self.first),
                last => format!("the dumps have no snapshot between the steps {} and {last}", self.first),
            };
            return fail(Code::BAD_VALUE, self.wish.span, text);
        };
        Ok(place)
    }

    /// Where the next wanted snapshot begins.
    fn find(&mut self, w: &World) -> Result<Option<Place>> {
        loop {
            let (text, at) = match self.now.take() {
                Some(now) => now,
                None => match self.files.next() {
                    Some(file) => (find(w, &file, "dump")?, 0),
                    None => return Ok(None),
                },
            };
            let mut lines = Lines::at(&text.text, at);
            let found = self.advance(&mut lines, w.settings.lammps()).map_err(|e| e.within(&text))?;
            if let Some((at, step)) = found {
                self.now = Some((text.clone(), lines.position()));
                return Ok(Some(Place { text, at, step }));
            }
        }
    }

    /// The next wanted snapshot of one file: where it begins, and its step. LAMMPS tests `first` only for the first one.
    fn advance(&mut self, lines: &mut Lines, lammps: bool) -> Result<Option<(usize, i64)>> {
        loop {
            let at = lines.position();
            let Some(s) = dump::next(lines)? else { return Ok(None) };
            if s.step > self.last && !(lammps && self.step.is_none() && s.step >= self.first) {
                self.files = vec![].into_iter();
                return Ok(None);
            }
            if s.step >= self.first && self.wants(s.step) {
                self.step = Some(s.step);
                return Ok(Some((at, s.step)));
            }
        }
    }

    /// Whether a snapshot not before `first` is wanted: the first one, then one in `skip` of those with increasing times, if it
    /// is a multiple of `every`.
    fn wants(&mut self, step: i64) -> bool {
        let Some(before) = self.step else { return true };
        if step <= before {
            return false;
        }
        self.passed += 1;
        if self.passed < self.skip {
            return false;
        }
        self.passed = 0;
        self.every == 0 || step % self.every == 0
    }
}
