//! Fixes external and the program they talk to.

use super::Session;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_fixes::external;
use perigrain_world::outside::Each;
use perigrain_world::{Key, Outside};
use std::sync::Arc;

impl Session {
    /// Has a fix external talk to a program from now on, until the fix is gone.
    ///
    /// # Errors
    /// No such fix, or one of another style.
    pub fn talk(&mut self, id: &str, program: Arc<dyn Outside>) -> Result<()> {
        let style = self.known_fix(id)?.style;
        if style != "external" {
            let text = format!("fix `{id}` is a fix {style}, not a fix external");
            return fail(Code::WRONG_KIND, None, text);
        }
        self.world.facts.insert(external::program(Key::new(&external::name(id))), program);
        Ok(())
    }

    /// Whether a fix external talks to this program.
    pub fn talks(&self, id: &str, program: &Arc<dyn Outside>) -> bool {
        let key = external::program(Key::new(&external::name(id)));
        self.world.facts.get(key).is_some_and(|now| Arc::ptr_eq(now, program))
    }

    /// Sets the values of a fix external for each particle, in the order of the particles.
    ///
    /// # Errors
    /// No such fix, or fewer values than particles.
    pub fn set_each(&mut self, id: &str, each: Each) -> Result<()> {
        self.known_fix(id)?;
        external::Kept::new(id).keep(&mut self.world, id, each)
    }

    /// Refuses an index behind the values that a fix offers.
    ///
    /// # Errors
    /// No such fix, or fewer values.
    pub fn has_value(&self, id: &str, index: usize) -> Result<()> {
        let length = self.known_fix(id)?.fix.shape().vector;
        if (1..=length).contains(&index) {
            return Ok(());
        }
        let d = Diagnostic::error(
            Code::BAD_VALUE,
            None,
            format!("fix `{id}` has {length} values, and no value {index}"),
        );
        Err(d.help("`fix_external_set_vector_length` sets how many there are").into())
    }
}
