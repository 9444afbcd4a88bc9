//! Any bytes as a data file. The first byte chooses the atom style.
#![no_main]

use libfuzzer_sys::fuzz_target;

const STYLES: [&str; 4] = ["atomic", "sphere", "peri", "hybrid sphere peri"];

fuzz_target!(|bytes: &[u8]| {
    let Some((first, rest)) = bytes.split_first() else { return };
    let style = STYLES[usize::from(*first) % STYLES.len()];
    perigrain_fuzz::with_file(rest, &format!("atom_style {style}\nread_data FILE\n"));
});
