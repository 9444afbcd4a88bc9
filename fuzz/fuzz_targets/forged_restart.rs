//! Any bytes as changes to a real restart file whose checksum is mended: read, and gone on with for a few steps.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| perigrain_fuzz::forged_restart(bytes));
