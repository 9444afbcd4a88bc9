//! Any text as a formula: equal, vector and atom style, in a scene with particles.
#![no_main]

use libfuzzer_sys::fuzz_target;
use perigrain::diag::Span;
use perigrain::session::Mode;

const SCENE: &str = "units si\natom_style sphere\nregion b block 0 2 0 2 0 2\ncreate_box 1 b\n\
    create_atoms 1 single 0.5 0.5 0.5\ncreate_atoms 1 single 1.5 0.5 0.5\nvariable l vector [1,2,3]\n";

fuzz_target!(|text: &str| {
    let Ok(_) = perigrain::lang::Expr::parse(text, Span::default()) else { return };
    // Commands would be another matter: one formula, on one line.
    if text.contains(['\n', '\r', '"', '\'', '$', '#', '&']) {
        return;
    }
    let deck = format!(
        "{SCENE}variable e equal \"{text}\"\nvariable p atom \"{text}\"\nvariable q equal v_p[1]\nprint \"${{e}}\"\nprint \"${{q}}\"\n"
    );
    perigrain_fuzz::work_off(&deck, Mode::Run, std::path::Path::new("."));
});
