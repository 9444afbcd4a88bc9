//! Meshes, tables of points and images of any bytes. The first byte chooses the format.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| perigrain_fuzz::read_body(bytes));
