//! A session behind a lock, driven by the package `perigrain`.

use super::errors;
use super::functions::Library;
use super::inner::{CLOSED, Inner};
use super::memory::Memory;
use super::outside::{Handle, Hook, each_of};
use super::screen::Screen;
use super::values;
use super::working::{at_once, beside, words};
use perigrain::cli::deck::host;
use perigrain::diag::Result as Deck;
use perigrain::output::table_row::RowValue;
use perigrain::session::{Columns, Heard, Newcomers, Session};
use perigrain::world::Outside;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use pyo3::{PyTraverseError, PyVisit};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};

/// A box: its corners, tilts (xy, xz, yz) [length] and which axes are periodic.
type Edges = ([f64; 3], [f64; 3], [f64; 3], [bool; 3]);

/// A row of the step table: the step, and the columns with their values.
type Row = (i64, Vec<(String, Py<PyAny>)>);

/// A column of a step table: its heading, whether it holds integers, and the numbers as bytes.
type TableColumn<'py> = (String, bool, Bound<'py, PyBytes>);

/// A scene: the state of a deck that is executed line by line.
#[pyclass(frozen, module = "perigrain._core")]
pub struct Scene(pub(super) Mutex<Inner>);

impl Scene {
    /// A scene to be filled by [`Scene::show`].
    pub(super) fn of_a_moment() -> Self {
        let mut inner = Inner::default();
        inner.moment = true;
        Self(Mutex::new(inner))
    }

    fn lock(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, Inner>> {
        match self.0.try_lock() {
            Ok(inner) => Ok(inner),
            Err(TryLockError::Poisoned(e)) => Ok(e.into_inner()),
            Err(TryLockError::WouldBlock) => Err(errors::busy(py)),
        }
    }

    /// Something short, done at once; `lent` says whether columns that are looked at must be kept from moving.
    fn with_session<T>(
        &self,
        py: Python<'_>,
        lent: bool,
        job: impl FnOnce(&mut Session) -> Deck<T>,
    ) -> PyResult<T> {
        if self.lock(py)?.moment {
            return Err(errors::within(py));
        }
        self.look(py, lent, job)
    }

    /// Like [`Scene::ask`], for operations that are also allowed within a step.
    fn look<T>(&self, py: Python<'_>, lent: bool, job: impl FnOnce(&mut Session) -> Deck<T>) -> PyResult<T> {
        let mut inner = self.lock(py)?;
        let Inner { session, looked, screen, library, why, .. } = &mut *inner;
        let Some(session) = session else { return Err(errors::closed(py, why)) };
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            if !lent {
                return job(session);
            }
            let outcome = looked.lend(session, false).and_then(|()| job(session));
            looked.give_back(session);
            outcome
        }));
        screen.show(py);
        if let Some(e) = library.raised() {
            return Err(e);
        }
        match outcome {
            Ok(outcome) => outcome.map_err(|e| {
                let e = session.sources.adopt(e);
                errors::deck(py, &e, &session.sources)
            }),
            Err(panic) => Err(inner.broken(py, &words(&*panic))),
        }
    }

    /// Executes lines of a deck, which may take long.
    fn work(
        &self,
        py: Python<'_>,
        light: bool,
        job: impl FnOnce(&mut Session) -> Deck<Heard> + Send,
    ) -> PyResult<Option<i32>> {
        let mut inner = self.lock(py)?;
        if inner.moment {
            return Err(errors::within(py));
        }
        let Inner { session, looked, screen, hooks, library, why, .. } = &mut *inner;
        let Some(session) = session else { return Err(errors::closed(py, why)) };
        let lent = looked.lend(session, !light);
        if let Err(e) = lent {
            looked.give_back(session);
            return Err(errors::deck(py, &e, &session.sources));
        }
        let stop = session.stop_flag();
        let ended = match light {
            true => at_once(|| job(session)),
            false => beside(py, screen, &stop, || job(session)),
        };
        stop.store(false, Ordering::Relaxed);
        let outcome = match ended.outcome {
            Ok(outcome) => outcome,
            Err(words) => return Err(inner.broken(py, &words)),
        };
        looked.give_back(session);
        screen.show(py);
        // An exception raised by a Python function is raised again.
        let raised = |library: &Library| library.raised().filter(|_| outcome.is_err());
        let raised = ended.raised.or_else(|| raised(library));
        if let Some(e) = raised.or_else(|| hooks.values().find_map(|hook| hook.raised())) {
            return Err(e);
        }
        outcome.map(|heard| heard.quit).map_err(|e| {
            let e = session.sources.adopt(e);
            errors::deck(py, &e, &session.sources)
        })
    }
}

#[pymethods]
impl Scene {
    /// A scene before its first line, with the options of a command line.
    #[new]
    fn new(py: Python<'_>, words: Vec<String>) -> PyResult<Self> {
        let screen = Screen::default();
        let mut session = host(words, Box::new(screen.clone())).map_err(|usage| {
            let help = usage.help.map_or(String::new(), |help| format!(" ({help})"));
            PyValueError::new_err(format!("{}{help}", usage.message))
        })?;
        screen.show(py);
        let library = Arc::new(Library::default());
        session.set_functions(library.clone());
        session.set_host(library.clone());
        let mut inner = Inner::default();
        (inner.library, inner.session, inner.screen) = (library, Some(session), screen);
        Ok(Self(Mutex::new(inner)))
    }

    /// Executes lines of a deck; returns the status of `quit`, if given.
    fn command(&self, py: Python<'_>, text: &str, name: &str) -> PyResult<Option<i32>> {
        self.work(py, Session::is_light(text), |session| session.eval(name, text))
    }

    /// Executes a deck from a file.
    fn file(&self, py: Python<'_>, path: PathBuf) -> PyResult<Option<i32>> {
        self.work(py, false, |session| session.eval_file(&path))
    }

    /// The value of a formula or a thermo keyword.
    fn number(&self, py: Python<'_>, formula: &str) -> PyResult<f64> {
        self.with_session(py, true, |session| session.number(formula))
    }

    /// A text with variables substituted.
    fn expand(&self, py: Python<'_>, text: &str) -> PyResult<String> {
        self.with_session(py, true, |session| session.expand(text))
    }

    /// A variable's kind and value.
    fn variable<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<Option<(&'static str, Bound<'py, PyAny>)>> {
        let value = self.with_session(py, true, |session| session.variable(name))?;
        value.map(|value| values::variable(py, value)).transpose()
    }

    /// Sets a variable of style internal.
    fn set_number(&self, py: Python<'_>, name: &str, value: f64) -> PyResult<()> {
        self.with_session(py, false, |session| session.set_number(name, value))
    }

    /// Sets a variable of style string.
    fn set_text(&self, py: Python<'_>, name: &str, text: &str) -> PyResult<()> {
        self.with_session(py, false, |session| session.set_text(name, text))
    }

    /// A column of particles in memory.
    fn memory(&self, py: Python<'_>, name: &str) -> PyResult<Option<Memory>> {
        let mut inner = self.lock(py)?;
        let Inner { session, looked, why, .. } = &mut *inner;
        let Some(session) = session else { return Err(errors::closed(py, why)) };
        Ok(looked.at(session, name))
    }

    /// Masses of the types, from index 1 on.
    fn type_masses<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyBytes>>> {
        let masses = self.look(py, false, |session| Ok(session.type_masses()))?;
        Ok(masses.map(|list| values::reals(py, &list)))
    }

    /// A number of the scene with LAMMPS' code of its type.
    #[pyo3(name = "global_")]
    fn global<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<(i32, Bound<'py, PyAny>)>> {
        let found = self.look(py, false, |session| Ok(session.global(name)))?;
        found.map(|found| values::global(py, found)).transpose()
    }

    /// All values of a compute.
    fn compute<'py>(&self, py: Python<'py>, id: &str) -> PyResult<Bound<'py, PyTuple>> {
        let (slot, n) = self.with_session(py, true, |session| {
            let slot = session.compute_values(id)?.clone();
            Ok((slot, session.world.n()))
        })?;
        values::slot(py, &slot, n)
    }

    /// All values of a fix.
    fn fix<'py>(&self, py: Python<'py>, id: &str) -> PyResult<Bound<'py, PyTuple>> {
        let (slot, n) = self.with_session(py, true, |session| {
            let slot = session.fix_values(id)?.clone();
            Ok((slot, session.world.n()))
        })?;
        values::slot(py, &slot, n)
    }

    /// Per-particle numbers as bytes, whether they are integers, and their number per particle.
    fn gather<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        apart: bool,
        order: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyBytes>, bool, usize)> {
        let order = values::order(order)?;
        if self.lock(py)?.moment && (name.starts_with("c_") || name.starts_with("f_")) {
            return Err(errors::within(py));
        }
        // Integers written from outside take effect at the next command.
        let (rows, width) = self.look(py, true, |session| session.gathered(name, apart, &order))?;
        let (bytes, whole) = values::rows(py, &rows);
        Ok((bytes, whole, width))
    }

    /// Writes per-particle numbers.
    fn scatter(
        &self,
        py: Python<'_>,
        name: &str,
        order: &Bound<'_, PyAny>,
        data: &[u8],
        whole: bool,
    ) -> PyResult<()> {
        let (order, rows) = (values::order(order)?, values::taken(data, whole)?);
        self.look(py, true, |session| session.scatter(name, &order, &rows))
    }

    /// Creates particles; returns their number.
    #[pyo3(signature = (ids, kinds, x, v, images, open))]
    fn create(
        &self,
        py: Python<'_>,
        ids: Option<Vec<i64>>,
        kinds: Vec<i32>,
        x: Vec<f64>,
        v: Option<Vec<f64>>,
        images: Option<Vec<i32>>,
        open: bool,
    ) -> PyResult<usize> {
        let x = values::threes(&x)?;
        let v = v.map(|list| values::threes(&list)).transpose()?;
        let new = Newcomers { ids, kinds, x, v, images, open };
        self.with_session(py, true, |session| session.make_particles(&new))
    }

    /// Changes the corners of an empty box, and the tilts (xy, xz, yz) of a triclinic one.
    fn reset_box(&self, py: Python<'_>, lo: [f64; 3], hi: [f64; 3], tilt: [f64; 3]) -> PyResult<()> {
        self.with_session(py, true, |session| session.reset_box(lo, hi, tilt))
    }

    /// The box: corners, tilts (xy, xz, yz) and which axes are periodic.
    fn domain(&self, py: Python<'_>) -> PyResult<Option<Edges>> {
        self.look(py, false, |session| {
            let domain = session.world.domain.as_ref();
            Ok(domain.map(|d| (d.lo, d.hi, d.edges().tilt, [0, 1, 2].map(|k| d.boundary.periodic(k)))))
        })
    }

    /// The index of the particle with an id.
    fn place(&self, py: Python<'_>, id: i64) -> PyResult<Option<usize>> {
        self.look(py, false, |session| {
            Ok(u32::try_from(id).ok().and_then(|tag| session.world.particles.index_of(tag)))
        })
    }

    /// Keeps all rows of step tables from now on.
    fn keep_rows(&self, py: Python<'_>) -> PyResult<()> {
        self.with_session(py, false, |session| {
            session.keep_table_rows();
            Ok(())
        })
    }

    /// The rows kept so far, by column: heading, whether it holds integers, and the numbers as bytes; tables
    /// with other columns separately.
    fn rows<'py>(&self, py: Python<'py>) -> PyResult<Vec<Vec<TableColumn<'py>>>> {
        let tables = self.look(py, false, |session| Ok(session.table_rows()))?;
        let column = |(name, (whole, values)): (String, (bool, Vec<f64>))| {
            let bytes: Vec<u8> = values.iter().flat_map(|a| a.to_ne_bytes()).collect();
            (name, whole, PyBytes::new(py, &bytes))
        };
        let columns = |table: Columns| {
            table.headings.into_iter().zip(table.whole.into_iter().zip(table.values)).map(column).collect()
        };
        Ok(tables.into_iter().map(columns).collect())
    }

    /// The latest row of the step table.
    fn last_row(&self, py: Python<'_>) -> PyResult<Option<Row>> {
        let row = self.with_session(py, false, |session| Ok(session.table_row().cloned()))?;
        let Some(row) = row else { return Ok(None) };
        let mut values = vec![];
        for (name, value) in row.values {
            let value = match value {
                RowValue::Whole(k) => k.into_pyobject(py)?.into_any(),
                RowValue::Real(a) => a.into_pyobject(py)?.into_any(),
            };
            values.push((name, value.unbind()));
        }
        Ok(Some((row.step, values)))
    }

    /// The ids of a category; `None` if there is no such category.
    fn ids(&self, py: Python<'_>, category: &str) -> PyResult<Option<Vec<String>>> {
        self.with_session(py, false, |session| Ok(session.ids(category)))
    }

    /// 1 for each particle in a group, 0 for the others.
    fn members<'py>(&self, py: Python<'py>, group: &str) -> PyResult<Bound<'py, PyBytes>> {
        let list = self.look(py, false, |session| session.members(group))?;
        Ok(values::wholes(py, &list))
    }

    /// Bonds: type and the two ids of each.
    fn bonds(&self, py: Python<'_>) -> PyResult<Vec<(i32, u32, u32)>> {
        self.look(py, false, |session| {
            let bond = |b: &perigrain::world::Bond| (b.kind, b.ends[0], b.ends[1]);
            Ok(session.world.bonds.list.iter().map(bond).collect())
        })
    }

    /// The number of particles.
    fn count(&self, py: Python<'_>) -> PyResult<usize> {
        self.look(py, false, |session| Ok(session.world.n()))
    }

    /// Links a fix external: its functions and values.
    fn outside(&self, py: Python<'_>, id: &str) -> PyResult<Handle> {
        let known = self.lock(py)?.hooks.get(id).cloned();
        let hook = self.with_session(py, false, |session| {
            let program = |hook: &Arc<Hook>| -> Arc<dyn Outside> { hook.clone() };
            if let Some(hook) = known.filter(|hook| session.talks(id, &program(hook))) {
                return Ok(hook);
            }
            let hook = Arc::new(Hook::default());
            session.talk(id, program(&hook))?;
            Ok(hook)
        })?;
        self.lock(py)?.hooks.insert(id.to_string(), hook.clone());
        Ok(Handle(hook))
    }

    /// Sets per-particle energies and virials of a fix external, between commands.
    #[pyo3(signature = (id, energy, virial))]
    fn external_each(
        &self,
        py: Python<'_>,
        id: &str,
        energy: Option<&[u8]>,
        virial: Option<&[u8]>,
    ) -> PyResult<()> {
        let each = each_of(energy, virial)?;
        self.with_session(py, false, |session| session.set_each(id, each))
    }

    /// Refuses an index beyond the values that a fix offers.
    fn has_value(&self, py: Python<'_>, id: &str, index: usize) -> PyResult<()> {
        self.with_session(py, false, |session| session.has_value(id, index))
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        match self.0.try_lock() {
            Ok(inner) => inner.hooks.values().try_for_each(|hook| hook.traverse(&visit)),
            Err(_) => Ok(()),
        }
    }

    fn __clear__(&self) {
        if let Ok(inner) = self.0.try_lock() {
            inner.hooks.values().for_each(|hook| hook.forget());
        }
    }

    /// Whether a command is executing.
    #[getter]
    fn at_work(&self) -> bool {
        self.0.try_lock().map_or_else(|e| matches!(e, TryLockError::WouldBlock), |inner| inner.moment)
    }

    /// Reason why the scene has ended; `None` while it exists.
    #[getter]
    fn ended(&self, py: Python<'_>) -> PyResult<Option<&'static str>> {
        let inner = self.lock(py)?;
        Ok(if inner.session.is_some() { None } else { Some(inner.why) })
    }

    /// Flushes all output.
    fn flush(&self, py: Python<'_>) -> PyResult<()> {
        self.with_session(py, false, |session| session.flush())
    }

    /// Ends the scene; viewed memory is left to the viewers.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        let mut inner = self.lock(py)?;
        if inner.moment {
            // It belongs to the run, which continues.
            return Ok(());
        }
        if let Some(session) = &mut inner.session {
            // A log that cannot be written has been value of before.
            let _ = session.flush();
        }
        inner.screen.show(py);
        if inner.session.is_some() {
            inner.end(CLOSED);
        }
        Ok(())
    }
}

/// The styles of a category; `None` if there is no such category.
#[pyfunction]
pub fn styles(category: &str) -> Option<Vec<&'static str>> {
    Session::styles(category)
}
