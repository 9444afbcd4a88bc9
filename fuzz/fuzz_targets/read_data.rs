//! Any bytes as a data file. The first byte chooses the atom style.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| perigrain_fuzz::read_data(bytes));
