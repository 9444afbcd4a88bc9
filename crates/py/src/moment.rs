//! A scene in the middle of a step, passed to a function of `fix python/invoke`.

use super::errors;
use super::functions::{Library, names};
use super::inner::Inner;
use super::scene::Scene;
use perigrain::lang::python::Functions;
use perigrain::session::{Options, Session};
use perigrain::world::World;
use perigrain::world::outside::{Host, Invoked};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::sync::PoisonError;

/// Reason for a missing scene, after the function.
const RETURNED: &str = "the function that was shown this scene has returned";

impl Host for Library {
    fn has(&self, function: &str) -> bool {
        Functions::has(self, function)
    }

    fn invoke(&self, function: &str, when: Invoked, w: &mut World) -> Result<(), String> {
        Python::attach(|py| called(py, function, when, w).map_err(|e| self.keep(e)))
    }
}

/// Passes the scene to a function; changes of columns are applied afterwards.
fn called(py: Python<'_>, function: &str, when: Invoked, w: &mut World) -> PyResult<()> {
    let Some(known) = names(py)?.get_item(function)? else {
        return Err(PyTypeError::new_err(format!("there is no function `{function}` any more")));
    };
    let scene = Bound::new(py, Scene::of_a_moment())?;
    scene.get().show(py, w)?;
    let outcome = match when {
        Invoked::PostForce(flag) => known.call1((&scene, flag)),
        Invoked::EndOfStep => known.call1((&scene,)),
    };
    let back = scene.get().take_back(py, w);
    outcome.and(back)
}

impl Scene {
    /// Moves a world in, until [`Scene::take_back`].
    fn show(&self, py: Python<'_>, w: &mut World) -> PyResult<()> {
        let made = Session::new(Options::default());
        let mut session = made.map_err(|e| errors::raised(py, "InternalError", (e.to_string(),)))?;
        session.world = std::mem::take(w);
        self.0.lock().unwrap_or_else(PoisonError::into_inner).session = Some(session);
        Ok(())
    }

    /// Moves it out again; remaining views become stale.
    fn take_back(&self, py: Python<'_>, w: &mut World) -> PyResult<()> {
        let mut inner = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Inner { session, looked, why, .. } = &mut *inner;
        let Some(mut own) = session.take() else {
            return Err(errors::raised(py, "InternalError", ("the scene was lost within a function",)));
        };
        let lent = looked.lend(&mut own, true);
        looked.end(None, RETURNED);
        *why = RETURNED;
        *w = std::mem::take(&mut own.world);
        // Positions may have been written through a view that is gone.
        w.touch();
        lent.map_err(|e| errors::deck(py, &e, &own.sources))
    }
}
