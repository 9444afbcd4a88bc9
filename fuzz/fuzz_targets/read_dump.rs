//! Any bytes as a text dump. The first byte chooses between read_dump and rerun.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| perigrain_fuzz::read_dump(bytes));
