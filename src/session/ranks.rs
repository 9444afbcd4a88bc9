//! Messages about a run on several ranks.

use super::Session;
use perigrain_base::comm;
use perigrain_base::diag::Result;

/// So many grains a rank has at least where several are faster than one process: a step of them takes as long as some messages between
/// processes of one machine.
const PAYS: usize = 1000;

impl Session {
    /// Warns once where ranks have so few grains that they wait for each other.
    pub(super) fn warn_of_few_grains(&mut self) -> Result<()> {
        let (n, ranks) = (self.world.n(), comm::present().size());
        let grains = self.world.particles.style.sphere && self.world.families.is_none();
        if !grains
            || ranks < 2
            || n == 0
            || n >= ranks * PAYS
            || std::mem::replace(&mut self.warned_of_few, true)
        {
            return Ok(());
        }
        let line = format!(
            "ranks: {n} grains are few for {ranks} ranks: from some {PAYS} grains a rank on they are faster than one process"
        );
        self.options.log.line(&line)
    }
}
