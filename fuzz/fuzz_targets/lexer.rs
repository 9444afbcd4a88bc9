//! Any text as a deck that is only checked: words, quotes, substitution, flow, and every command's own reader.
#![no_main]

use libfuzzer_sys::fuzz_target;
use perigrain::session::Mode;

fuzz_target!(|text: &str| {
    let _ = perigrain::lang::is_unfinished(text);
    perigrain_fuzz::work_off(text, Mode::Check, std::path::Path::new("/nonexistent"));
});
