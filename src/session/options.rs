//! How a session is set up.

use super::{Limit, Overlay};
use crate::graph::catalogue::Tables;
use perigrain_lang::Partition;
use perigrain_output::log::Log;
use perigrain_world::Compat;
use std::path::PathBuf;
use std::sync::Arc;

/// The mode of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Run it.
    #[default]
    Run,
    /// Read it and report every problem; change nothing, write nothing.
    Check,
    /// Print each run's sealed plan instead of running it.
    Plan,
    /// Run, then print each run's plan with time and bytes per op.
    Measure,
}

/// How a session is set up.
#[derive(Clone)]
pub struct Options {
    /// What to do.
    pub mode: Mode,
    /// The log of the session.
    pub log: Log,
    /// LAMMPS' artefacts too.
    pub compat: Compat,
    /// The list layout for every peridynamic body.
    pub force_list: bool,
    /// Work also where everything is at rest.
    pub no_skipping: bool,
    /// The portable kernels only.
    pub portable: bool,
    /// Index variables from the command line.
    pub vars: Vec<(String, Vec<String>)>,
    /// The deck's folder, for files named in it.
    pub folder: PathBuf,
    /// Which of several partitions this is.
    pub partition: Option<Partition>,
    /// Texts that count in place of files, where lines are read.
    pub overlay: Overlay,
    /// The styles that decks may name: the program's own, and what a host program adds.
    pub tables: Arc<Tables>,
    /// How long runs may take in all.
    pub limit: Option<Limit>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            mode: Mode::Run,
            log: Log::silent(),
            compat: Compat::Perigrain,
            force_list: false,
            no_skipping: false,
            portable: false,
            vars: vec![],
            folder: PathBuf::new(),
            partition: None,
            overlay: Overlay::default(),
            tables: Arc::default(),
            limit: None,
        }
    }
}
