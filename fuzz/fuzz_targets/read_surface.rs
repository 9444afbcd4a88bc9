//! Any bytes as a file of triangles. The first byte chooses between OBJ and the other kinds.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| perigrain_fuzz::read_surface(bytes));
