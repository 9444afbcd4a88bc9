//! What `perigrain -version` prints: version, commit, target, and the lanes that kernels use on this processor.

use crate::sweep::starter::is_hosted;
use perigrain_base::math::form::Form;

/// Hash and date of the commit; empty in debug builds and where the build found neither git nor an archive's note.
const COMMIT: &str = env!("PERIGRAIN_COMMIT");

/// One line, as `perigrain 0.2.0 (abcdef123 2026-11-29) x86_64-unknown-linux-gnu, avx512`.
pub fn line() -> String {
    let commit = match COMMIT {
        "" if cfg!(debug_assertions) => "debug build",
        "" => "unknown commit",
        known => known,
    };
    let python = if is_hosted() { ", python" } else { "" };
    format!(
        "perigrain {} ({commit}) {}, {}{python}",
        env!("CARGO_PKG_VERSION"),
        env!("PERIGRAIN_TARGET"),
        lanes()
    )
}

/// The vector instructions of the kernels' fastest form here.
fn lanes() -> &'static str {
    match Form::here() {
        #[cfg(target_arch = "x86_64")]
        Form::Gathers { .. } | Form::Eight { .. } => "avx512",
        #[cfg(target_arch = "x86_64")]
        Form::Four { .. } => "avx2",
        Form::Plain => "portable",
    }
}
