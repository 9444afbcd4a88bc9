//! Columns of particles viewed from Python: the scene's own memory if it has LAMMPS' layout, else a mirror.
//!
//! While a command executes, the scene works on copies of the viewed columns, and the viewed memory does not
//! change. Afterwards it becomes the scene's again, with the new values; if particles have been added or
//! deleted, it is orphaned: it holds no numbers any more, and lives as long as it is viewed.

use perigrain::diag::Result;
use perigrain::session::{Column, Session};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

/// Up to this many numbers, changes from outside are detected at once.
const QUICK: usize = 1 << 17;

/// Forces are recomputed in any case.
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

    /// Fills it with values that cannot be mistaken for the scene's.
    fn void(&mut self) {
        self.reals().fill(f64::NAN);
        if let Self::Wholes(list) = self {
            list.fill(i32::MIN);
        }
    }
}

/// A column viewed from Python.
pub struct Held {
    name: String,
    width: usize,
    whole: bool,
    state: Mutex<State>,
}

struct State {
    /// Its address.
    at: usize,
    rows: usize,
    /// The memory, while it does not belong to the scene.
    kept: Option<Store>,
    /// For a mirror: the scene's values.
    before: Vec<i32>,
    /// Hash of the numbers as the scene left them, if computed.
    print: Option<u64>,
    /// Reason why it is stale.
    stale: Option<&'static str>,
}

/// Hash of a list of numbers.
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

    /// The column of a name; `None` if the scene has none.
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

    /// Takes the memory out of the scene, which continues with a copy; changes from outside are applied.
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

    /// Returns the memory to the scene with the new values, or orphans it if the particles are different
    /// ones.
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
        // It stayed with the scene: nothing has been lent.
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

    /// The scene has ended.
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

/// Writes the values of `own` to `list` and moves it into the scene; returns the hash of the values, or
/// `None` if they belong to other particles.
fn put<T: Row>(list: &mut Vec<T>, own: &mut Vec<T>, same: bool) -> Option<u64> {
    if !same || list.len() != own.len() {
        return None;
    }
    list.copy_from_slice(own);
    *own = std::mem::take(list);
    Some(print(T::flat(own)))
}

/// All viewed columns.
#[derive(Default)]
pub struct Looked {
    held: Vec<Weak<Held>>,
    /// Views created since the last command: their changes count even if they are gone.
    recent: Vec<Arc<Held>>,
    roster: [u64; 3],
}

impl Looked {
    /// The column of a name, shared by all views while one exists; `None` if the scene has none.
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

    /// Before a command. `counts`: columns that may have been changed count as changed.
    ///
    /// # Errors
    /// Invalid integers from outside; the previous values are kept.
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

    /// Ends the scene; viewed memory is left to the viewers. Also after a panic, when the scene is not
    /// touched.
    pub fn end(&mut self, session: Option<&mut Session>, why: &'static str) {
        if let Some(session) = session {
            // Changes that cannot be applied any more are ignored.
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

/// A column of particles in memory, viewed by `numpy.asarray` and `ctypes`.
#[pyclass(frozen, module = "perigrain._core")]
pub struct Memory(Arc<Held>);

#[pymethods]
impl Memory {
    /// Its address.
    #[getter]
    fn address(&self) -> usize {
        self.0.state().at
    }

    /// The number of particles.
    #[getter]
    fn rows(&self) -> usize {
        self.0.state().rows
    }

    /// Numbers per particle.
    #[getter]
    fn width(&self) -> usize {
        self.0.width
    }

    /// Whether the numbers are 32-bit integers.
    #[getter]
    fn whole(&self) -> bool {
        self.0.whole
    }

    /// Whether it is a mirror, read before and written after each command, instead of the scene's own memory.
    #[getter]
    fn mirror(&self) -> bool {
        self.0.whole
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Reason why it is stale; `None` if it is valid.
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
