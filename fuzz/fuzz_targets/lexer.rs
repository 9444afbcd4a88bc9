//! Any text as a deck that is only checked: words, quotes, substitution, flow, and every command's own reader.
#![no_main]

libfuzzer_sys::fuzz_target!(|text: &str| perigrain_fuzz::lexer(text));
