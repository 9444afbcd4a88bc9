//! Columns of particles that Python looks into: the scene's own memory where it lies as LAMMPS has it, else a mirror.
//!
//! While a command works, the scene has copies of the columns that somebody looks into, and the memory seen from outside
//! stands still. Afterwards it is the scene's again, with the new values; where particles have come or gone it is nobody's, holds
//! no numbers any more, and lives as long as it is looked at.

use perigrain::diag::Result;
use perigrain::session::{Column, Session};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

/// Up to this many numbers it is found out at once whether somebody has changed them from outside.
const QUICK: usize = 1 << 17;

/// Forces are made anew in any case.
const MADE_ANEW: [&str; 2] = ["f", "torque"];

/// Memory taken out of a scene.
enum Store {
    Ones(Vec<f64>),
    Threes(Vec<[f64; 3]>),
    Fours(Vec<[f64; 4]>),
    Wholes(Vec<i32>),
}

impl Store {
    fn reals(&mut self) -> &mut [f64] {
        match self {
            Self::Ones(list) => list,
            Self::Threes(list) => list.as_flattened_mut(),
            Self::Fours(list) => list.as_flattened_mut(),
            Self::Wholes(_) => &mut [],
        }
    }

    /// Nothing that could be taken for a number of the scene.
    fn void(&mut self) {
        self.reals().fill(f64::NAN);
        if let Self::Wholes(list) = self {
            list.fill(i32::MIN);
        }
    }
}

/// A column that somebody looks into.
pub struct Held {
    name: String,
    width: usize,
    whole: bool,
    state: Mutex<State>,
}

struct State {
    /// Where it lies.
    at: usize,
    rows: usize,
    /// The memory, while it is not the scene's.
    kept: Option<Store>,
    /// Of a mirror: what the scene had.
    before: Vec<i32>,
    /// A print of the numbers as the scene has left them, where it was taken.
    print: Option<u64>,
    /// Why it means nothing any more.
    stale: Option<&'static str>,
}

/// Tells lists of numbers apart.
fn print(list: &[f64]) -> u64 {
    let mut sums = [0x9e37_79b9_7f4a_7c15_u64, 1, 2, 3];
    for chunk in list.chunks(4) {
        for (sum, a) in sums.iter_mut().zip(chunk) {
            *sum = (*sum ^ a.to_bits()).wrapping_mul(0xff51_afd7_ed55_8ccd).rotate_left(31);
        }
    }
    sums.iter().fold(0, |all, sum| (all ^ sum).wrapping_mul(0xc4ce_b9fe_1a85_ec53).rotate_left(29))
}

impl Held {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The column under a name; `None` if the scene has none.
    fn of(session: &mut Session, name: &str) -> Option<Self> {
        let held = |width, whole, state| Self { name: name.into(), width, whole, state: Mutex::new(state) };
        let own = |list: &[f64], rows| State {
            at: list.as_ptr() as usize,
            rows,
            kept: None,
            before: vec![],
            print: (list.len() <= QUICK).then(|| print(list)),
            stale: None,
        };
        match session.column(name) {
            Some(Column::Ones(list)) => return Some(held(1, false, own(list, list.len()))),
            Some(Column::Threes(list)) => return Some(held(3, false, own(list.as_flattened(), list.len()))),
            Some(Column::Fours(list)) => return Some(held(4, false, own(list.as_flattened(), list.len()))),
            None => {}
        }
        let list = session.whole_column(name)?;
        let (at, rows, before) = (list.as_ptr() as usize, list.len(), list.clone());
        let kept = Some(Store::Wholes(list));
        Some(held(1, true, State { at, rows, kept, before, print: None, stale: None }))
    }

    /// Takes the memory out of the scene, which goes on with a copy; what was changed from outside counts.
    fn lend(&self, session: &mut Session, counts: bool) -> Result<()> {
        let mut state = self.state();
        if state.stale.is_some() {
            return Ok(());
        }
        if self.whole {
            let Some(Store::Wholes(list)) = &mut state.kept else { return Ok(()) };
            let list = list.clone();
            if list == state.before {
                return Ok(());
            }
            let outcome = session.set_whole_column(&self.name, &list);
            if outcome.is_err() {
                let before = state.before.clone();
                if let Some(Store::Wholes(list)) = &mut state.kept {
                    list.copy_from_slice(&before);
                }
            }
            return outcome;
        }
        let mut store = match session.column(&self.name) {
            Some(Column::Ones(own)) => Store::Ones(std::mem::replace(own, own.clone())),
            Some(Column::Threes(own)) => Store::Threes(std::mem::replace(own, own.clone())),
            Some(Column::Fours(own)) => Store::Fours(std::mem::replace(own, own.clone())),
            None => return Ok(()),
        };
        debug_assert_eq!(store.reals().as_ptr() as usize, state.at, "`{}` was moved while lent", self.name);
        let changed = match state.print {
            Some(before) => before != print(store.reals()),
            None => counts,
        };
        state.kept = Some(store);
        drop(state);
        if changed && !MADE_ANEW.contains(&self.name.as_str()) {
            session.changed_from_outside();
        }
        Ok(())
    }

    /// Puts the memory back into the scene with the new values, or lets it be nobody's where particles are others now.
    fn give_back(&self, session: &mut Session, same: bool) {
        let mut state = self.state();
        if state.stale.is_some() {
            return;
        }
        if self.whole {
            let now = session.whole_column(&self.name).filter(|list| same && list.len() == state.rows);
            match (now, &mut state.kept) {
                (Some(now), Some(Store::Wholes(list))) => {
                    list.copy_from_slice(&now);
                    state.before = now;
                }
                _ => state.end("particles have come, gone or changed places"),
            }
            return;
        }
        // It was the scene's all the time: nothing has been lent.
        let Some(mut store) = state.kept.take() else { return };
        let back = match (&mut store, session.column(&self.name)) {
            (Store::Ones(list), Some(Column::Ones(own))) => put(list, own, same),
            (Store::Threes(list), Some(Column::Threes(own))) => put(list, own, same),
            (Store::Fours(list), Some(Column::Fours(own))) => put(list, own, same),
            _ => None,
        };
        match back {
            Some(print) => state.print = Some(print),
            None => {
                state.kept = Some(store);
                state.end("particles have come, gone or changed places");
            }
        }
    }

    /// The scene is over.
    fn end(&self, why: &'static str) {
        self.state().end(why);
    }
}

impl State {
    fn end(&mut self, why: &'static str) {
        self.stale = Some(why);
        if let Some(store) = &mut self.kept {
            store.void();
        }
    }
}

/// A row of numbers.
trait Row: Copy {
    fn flat(list: &[Self]) -> &[f64];
}

impl Row for f64 {
    fn flat(list: &[Self]) -> &[f64] {
        list
    }
}

impl<const N: usize> Row for [f64; N] {
    fn flat(list: &[Self]) -> &[f64] {
        list.as_flattened()
    }
}

/// Gives the values of `own` to `list` and this to the scene; the print of the values, or nothing where they are for others.
fn put<T: Row>(list: &mut Vec<T>, own: &mut Vec<T>, same: bool) -> Option<u64> {
    if !same || list.len() != own.len() {
        return None;
    }
    list.copy_from_slice(own);
    *own = std::mem::take(list);
    Some(print(T::flat(own)))
}

/// All columns that somebody looks into.
#[derive(Default)]
pub struct Looked {
    held: Vec<Weak<Held>>,
    /// Handed out since the last command: what was written counts, even if nobody looks any more.
    recent: Vec<Arc<Held>>,
    roster: [u64; 3],
}

impl Looked {
    /// The column under a name, the same for all who ask while one of them looks; `None` if the scene has none.
    pub fn at(&mut self, session: &mut Session, name: &str) -> Option<Memory> {
        self.held.retain(|held| held.strong_count() > 0);
        let mut all = self.held.iter().filter_map(Weak::upgrade);
        let known = all.find(|held| held.name == name && held.state().stale.is_none());
        let held = match known {
            Some(held) => held,
            None => {
                let held = Arc::new(Held::of(session, name)?);
                self.held.push(Arc::downgrade(&held));
                held
            }
        };
        if !self.recent.iter().any(|own| Arc::ptr_eq(own, &held)) {
            self.recent.push(held.clone());
        }
        Some(Memory(held))
    }

    /// Before a command. `counts`: columns of which it is not known whether they were changed are taken for changed.
    ///
    /// # Errors
    /// Whole numbers from outside that cannot be; they are as before then.
    pub fn lend(&mut self, session: &mut Session, counts: bool) -> Result<()> {
        self.held.retain(|held| held.strong_count() > 0);
        if self.held.is_empty() {
            return Ok(());
        }
        let outcomes: Vec<_> = self.live().map(|held| held.lend(session, counts)).collect();
        self.roster = session.roster();
        outcomes.into_iter().collect()
    }

    /// After a command.
    pub fn give_back(&mut self, session: &mut Session) {
        if self.held.is_empty() {
            return;
        }
        let same = self.roster == session.roster();
        self.live().for_each(|held| held.give_back(session, same));
        self.recent.clear();
    }

    /// The scene ends: what is looked at belongs to who looks. Also after a panic, when nothing of the scene is touched.
    pub fn end(&mut self, session: Option<&mut Session>, why: &'static str) {
        if let Some(session) = session {
            // What cannot be taken over any more changes nothing.
            let _ = self.lend(session, false);
        }
        self.live().for_each(|held| held.end(why));
        self.held.clear();
        self.recent.clear();
    }

    fn live(&self) -> impl Iterator<Item = Arc<Held>> {
        self.held.iter().filter_map(Weak::upgrade)
    }
}

/// A column of particles in memory; `numpy.asarray` and `ctypes` look into it.
#[pyclass(frozen, module = "perigrain._core")]
pub struct Memory(Arc<Held>);

#[pymethods]
impl Memory {
    /// Where it lies.
    #[getter]
    fn address(&self) -> usize {
        self.0.state().at
    }

    /// How many particles.
    #[getter]
    fn rows(&self) -> usize {
        self.0.state().rows
    }

    /// How many numbers each of them has.
    #[getter]
    fn width(&self) -> usize {
        self.0.width
    }

    /// Whether the numbers are whole ones, of 32 bits.
    #[getter]
    fn whole(&self) -> bool {
        self.0.whole
    }

    /// Whether it is a mirror that is read before and written after each command, not the scene's own memory.
    #[getter]
    fn mirror(&self) -> bool {
        self.0.whole
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Why it means nothing any more; `None` while it does.
    #[getter]
    fn stale(&self) -> Option<&'static str> {
        self.0.state().stale
    }

    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let state = self.0.state();
        let out = PyDict::new(py);
        let order = if cfg!(target_endian = "little") { '<' } else { '>' };
        out.set_item("version", 3)?;
        out.set_item("typestr", format!("{order}{}", if self.0.whole { "i4" } else { "f8" }))?;
        out.set_item("data", (state.at, self.0.name == "id"))?;
        match self.0.width {
            1 => out.set_item("shape", (state.rows,))?,
            width => out.set_item("shape", (state.rows, width))?,
        }
        Ok(out)
    }
}
