//! Any text as a formula: equal, vector and atom style, in a scene with particles.
#![no_main]

libfuzzer_sys::fuzz_target!(|text: &str| perigrain_fuzz::expression(text));
