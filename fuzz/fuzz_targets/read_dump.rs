//! Any bytes as a text dump. The first byte chooses between read_dump and rerun.
#![no_main]

use libfuzzer_sys::fuzz_target;

const SCENE: &str = "region b block 0 2 0 2 0 2\ncreate_box 1 b\ncreate_atoms 1 single 0.5 0.5 0.5\nmass 1 1\n";

fuzz_target!(|bytes: &[u8]| {
    let Some((first, rest)) = bytes.split_first() else { return };
    let line = match first % 2 {
        0 => "read_dump FILE 5 x y z vx ix add yes",
        _ => "rerun FILE dump x y z vx ix trim yes add keep",
    };
    perigrain_fuzz::with_file(rest, &format!("{SCENE}{line}\n"));
});
