//! Any bytes as changes to a real restart file with a corrected checksum: read, and continued for a few steps.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| perigrain_fuzz::forged_restart(bytes));
