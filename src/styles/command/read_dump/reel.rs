//! Snapshots of several dumps one after the other, as `rerun` takes them.

use super::super::data::dump;
use super::super::data::text::{Lines, comes, find};
use super::Wish;
use super::snapshot::{enter, particles};
use crate::diag::{Code, Result, Source, fail};
use crate::lang::{Args, Word};
use crate::styles::BuildCx;
use crate::world::World;
use std::sync::Arc;

/// Snapshots of several dumps one after the other, as `rerun` takes them.
pub struct Reel {
    files: std::vec::IntoIter<Word>,
    now: Option<(Arc<Source>, usize)>,
    /// No snapshot before this step.
    pub first: i64,
    /// None after this one.
    pub last: i64,
    every: i64,
    skip: i64,
    wish: Wish,
    /// Step of the last snapshot taken.
    step: Option<i64>,
    /// Snapshots that could have been taken since then.
    passed: i64,
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

impl Rerun {
    /// Reads the words of `rerun`.
    ///
    /// # Errors
    /// Every mistake in the line.
    pub fn read(a: &mut Args, cx: &BuildCx) -> Result<Self> {
        const KEYS: [&str; 8] = ["first", "last", "every", "skip", "start", "stop", "post", "dump"];
        let mut files = vec![a.expect("a dump to read")?.clone()];
        while let Some(word) = a.peek().filter(|w| !KEYS.contains(&w.text.as_str())) {
            files.push(word.clone());
            a.next();
        }
        let (mut first, mut last, mut every, mut skip) = (0, i64::MAX, 0, 1);
        let (mut start, mut stop, mut post) = (None, None, false);
        let wish = loop {
            match a.expect("the keyword `dump` with the fields to read")?.text.as_str() {
                "first" => first = a.integer_from(0, "the first step")?,
                "last" => last = a.integer_from(0, "the last step")?,
                "every" => every = a.integer_from(0, "the interval of snapshots")?,
                "skip" => skip = a.integer_from(1, "the number of snapshots for one that is read")?,
                "start" => start = Some(a.integer_from(0, "the first step of ramps")?),
                "stop" => stop = Some(a.integer_from(0, "the last step of ramps")?),
                "post" => post = a.flag("post")?,
                _ => break Wish::read(a, cx)?,
            }
        };
        if last < first {
            return fail(
                Code::BAD_VALUE,
                a.span(),
                format!("`last` must not be before `first`: {last} is before {first}"),
            );
        }
        let files = files.into_iter();
        let reel = Reel { files, now: None, first, last, every, skip, wish, step: None, passed: 0 };
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

    /// Puts the next snapshot into the world; `false` when there is none.
    ///
    /// # Errors
    /// Dumps that cannot be read.
    pub fn next(&mut self, w: &mut World) -> Result<bool> {
        loop {
            let (text, at) = match self.now.take() {
                Some(now) => now,
                None => match self.files.next() {
                    Some(file) => (find(w, &file, "dump")?, 0),
                    None => return Ok(false),
                },
            };
            let mut lines = Lines::at(&text.text, at);
            let taken = self.advance(&mut lines, w).map_err(|e| e.within(&text))?;
            let at = lines.position();
            if let Some(step) = taken {
                // The clock belongs to the snapshot whatever `timestep` says.
                w.clock.reset(step);
                self.now = Some((text, at));
                return Ok(true);
            }
        }
    }

    /// The next wanted snapshot of one file; its step.
    fn advance(&mut self, lines: &mut Lines, w: &mut World) -> Result<Option<i64>> {
        while let Some(s) = dump::next(lines)? {
            if s.step > self.last {
                self.files = vec![].into_iter();
                return Ok(None);
            }
            if s.step < self.first || self.step.is_some_and(|last| s.step <= last) {
                continue;
            }
            if self.step.is_some() {
                if self.every > 0 && s.step % self.every != 0 {
                    continue;
                }
                self.passed += 1;
                if self.passed < self.skip {
                    continue;
                }
            }
            (self.step, self.passed) = (Some(s.step), 0);
            let list = particles(&s, &self.wish, w)?;
            enter(w, &s, &list, &self.wish);
            return Ok(Some(s.step));
        }
        Ok(None)
    }
}
