//! Any bytes as a restart file.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    perigrain_fuzz::with_file(bytes, "read_restart FILE\nrun 0\n");
});
