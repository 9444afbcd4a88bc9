//! Shared code of the targets: a deck executed in a folder of its own, with a file of any bytes beside it.

pub mod forged;

pub use forged::forged_restart;
use perigrain::session::{Mode, Options, Session};
use std::path::Path;

/// Works the deck off; the outcome means nothing, a panic everything.
pub fn execute(deck: &str, mode: Mode, folder: &Path) {
    let options = Options { mode, folder: folder.to_path_buf(), ..Options::default() };
    if let Ok(mut session) = Session::new(options) {
        let _ = session.run_text("fuzz.in", deck);
    }
}

/// Works a deck off that reads the bytes as a file; `FILE` in it stands for the file's path.
pub fn with_file(bytes: &[u8], deck: &str) {
    with_file_named("input", bytes, deck);
}

/// The same where the file's name matters.
pub fn with_file_named(name: &str, bytes: &[u8], deck: &str) {
    let Ok(folder) = tempfile::tempdir() else { return };
    let path = folder.path().join(name);
    if std::fs::write(&path, bytes).is_ok() {
        execute(&deck.replace("FILE", &path.display().to_string()), Mode::Run, folder.path());
    }
}

/// Any text as a deck that is only checked: words, quotes, substitution, flow, and every command's own reader.
pub fn lexer(text: &str) {
    let _ = perigrain::lang::is_unfinished(text);
    execute(text, Mode::Check, Path::new("/nonexistent"));
}

/// Any text as a formula: equal, vector and atom style, in a scene with particles.
pub fn expression(text: &str) {
    const SCENE: &str = "units si\natom_style sphere\nregion b block 0 2 0 2 0 2\ncreate_box 1 b\n\
        create_atoms 1 single 0.5 0.5 0.5\ncreate_atoms 1 single 1.5 0.5 0.5\nvariable l vector [1,2,3]\n";
    let Ok(_) = perigrain::lang::Expr::parse(text, perigrain::diag::Span::default()) else { return };
    // Commands would be another matter: one formula, on one line.
    if text.contains(['\n', '\r', '"', '\'', '$', '#', '&']) {
        return;
    }
    let deck = format!(
        "{SCENE}variable e equal \"{text}\"\nvariable p atom \"{text}\"\nvariable q equal v_p[1]\nprint \"${{e}}\"\nprint \"${{q}}\"\n"
    );
    execute(&deck, Mode::Run, Path::new("."));
}

/// Any bytes as a data file. The first byte chooses the atom style.
pub fn read_data(bytes: &[u8]) {
    const STYLES: [&str; 4] = ["atomic", "sphere", "peri", "hybrid sphere peri"];
    let Some((first, rest)) = bytes.split_first() else { return };
    let style = STYLES[usize::from(*first) % STYLES.len()];
    with_file(rest, &format!("atom_style {style}\nread_data FILE\n"));
}

/// Any bytes as a text dump. The first byte chooses between read_dump and rerun.
pub fn read_dump(bytes: &[u8]) {
    const SCENE: &str =
        "region b block 0 2 0 2 0 2\ncreate_box 1 b\ncreate_atoms 1 single 0.5 0.5 0.5\nmass 1 1\n";
    let Some((first, rest)) = bytes.split_first() else { return };
    let line = match first % 2 {
        0 => "read_dump FILE 5 x y z vx ix add yes",
        _ => "rerun FILE dump x y z vx ix trim yes add keep",
    };
    with_file(rest, &format!("{SCENE}{line}\n"));
}

/// Any bytes as a surface of triangles: a body that is filled, or a cut. The first byte chooses the name's end.
pub fn read_surface(bytes: &[u8]) {
    const SCENE: &str = "units si\natom_style peri\nlattice sc 0.5 origin 0.5 0.5 0.5\nregion b block -2 2 -2 2 -2 2 units box\n\
        create_box 1 b\nperi_crack mesh FILE units box\nregion m mesh FILE units box\ncreate_atoms 1 region m volumes cut\n";
    let Some((first, rest)) = bytes.split_first() else { return };
    with_file_named(if first % 2 == 0 { "input" } else { "input.obj" }, rest, SCENE);
}

/// Any bytes as a mesh, a table of points or an image. The first byte chooses the format.
pub fn read_body(bytes: &[u8]) {
    const LINES: [&str; 9] = [
        "read_mesh input.vtk types cell Material",
        "read_mesh input.vtu type 1",
        "read_mesh input.msh type 1 types physical rock 1",
        "read_mesh input.inp type 1 types set rock 1",
        "read_points input.csv columns volume Vol",
        "read_voxels input.nrrd types 0:255 1 resample 0.7 spacing 0.5",
        "read_voxels input.vti types 0:255 1",
        "read_voxels input.png types 0:255 1 spacing 0.1",
        "read_voxels input.tif types 0:255 1 spacing 0.1",
    ];
    const SCENE: &str =
        "atom_style hybrid sphere peri\nregion b block -10 10 -10 10 -10 10\ncreate_box 3 b\n";
    let Some((first, rest)) = bytes.split_first() else { return };
    let line = LINES[usize::from(*first) % LINES.len()];
    let Ok(folder) = tempfile::tempdir() else { return };
    let name = line.split(' ').nth(1).unwrap_or("input");
    if std::fs::write(folder.path().join(name), rest).is_ok() {
        execute(&format!("{SCENE}{line}\n"), Mode::Run, folder.path());
    }
}

/// Any bytes as a restart file.
pub fn read_restart(bytes: &[u8]) {
    with_file(bytes, "read_restart FILE\nrun 0\n");
}
