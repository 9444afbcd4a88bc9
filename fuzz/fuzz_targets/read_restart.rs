//! Any bytes as a restart file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| perigrain_fuzz::read_restart(bytes));
