//! K7: what pictures and reports show.

use super::{decks, text};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Runs a deck in a folder that stays, with this in place of the usual `PATH` if given.
fn run_in(folder: &Path, deck: &str, arguments: &[&str], path: Option<&Path>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_perigrain"));
    command.arg("-in").arg(decks().join(deck)).args(["-log", "none"]).args(arguments).current_dir(folder);
    if let Some(path) = path {
        command.env("PATH", path);
    }
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", text(&output));
    output
}

/// Width and pixels of a PPM file as perigrain writes it.
fn pixels(path: &Path) -> (usize, Vec<[u8; 3]>) {
    let bytes = fs::read(path).unwrap();
    let head = bytes.iter().enumerate().filter(|(_, b)| **b == b'\n').nth(2).unwrap().0;
    let width = std::str::from_utf8(&bytes[3..head]).unwrap().split(' ').next().unwrap().parse().unwrap();
    (width, bytes[head + 1..].chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect())
}

/// Places at which two pictures differ, above their lowest `below` rows.
fn differ(a: &Path, b: &Path, below: usize) -> Vec<[usize; 2]> {
    let ((width, a), (_, b)) = (pixels(a), pixels(b));
    let rows = a.len() / width - below;
    (0..rows * width).filter(|k| a[*k] != b[*k]).map(|k| [k % width, k / width]).collect()
}

#[test]
fn a_first_picture_of_nothing_frames_the_box() {
    let folder = tempfile::tempdir().unwrap();
    run_in(folder.path(), "picture_of_an_empty_scene.in", &[], None);
    let [first, last] = ["e.0.ppm", "e.500.ppm"].map(|name| folder.path().join(name));
    let grains = differ(&first, &last, 30);
    let wide = |d: usize| {
        let along = || grains.iter().map(|p| p[d]);
        along().max().unwrap() - along().min().unwrap()
    };
    // They fall from a cylinder 0.06 wide in a box of 0.1, whose corners fill 400 pixels; they were 20 pixels wide.
    assert!(wide(0) > 100 && wide(0) < 300, "{} {}", wide(0), wide(1));
}

#[cfg(unix)]
#[test]
fn spheres_that_hide_each_other_are_cheap() {
    let took = super::processor("picture_of_huge_spheres.in", &[]);
    // Builds for tests take 3.5 s, where they took more than 10.
    assert!(took < 7.0, "{took}");
}

#[cfg(unix)]
#[test]
fn pictures_of_many_grains_are_cheap() {
    let of = |pictures: &str| super::processor("picture_of_grains.in", &["-var", "pictures", pictures]);
    let each = (of("4") - of("0")) / 4.0;
    // Builds for tests take three times as long as those for use, and other tests run beside this one.
    assert!(each < 1.2, "{each}");
}

#[test]
fn walls_are_drawn_where_they_are_and_can_be_left_out() {
    let folder = tempfile::tempdir().unwrap();
    run_in(folder.path(), "picture_of_walls.in", &[], None);
    let of = |name: &str, step: u32| folder.path().join(format!("{name}.{step}.ppm"));
    let walls = differ(&of("with", 0), &of("without", 0), 0);
    // The hopper, 0.06 by 0.09 in a box of 0.1 by 0.11, and the floor.
    assert!(walls.len() > 6000 && walls.len() < 36_000, "{}", walls.len());
    // It moves down by 0.1 times 5e-3 s, half a millimetre: a pixel.
    let moved = differ(&of("with", 0), &of("with", 100), 20);
    let grain = differ(&of("without", 0), &of("without", 100), 20);
    assert!(moved.len() > grain.len() + 50, "{} {}", moved.len(), grain.len());
}

/// The number of pictures in an animated PNG's header.
fn frames(path: &Path) -> u32 {
    let bytes = fs::read(path).unwrap();
    assert!(bytes.starts_with(b"\x89PNG") && &bytes[37..41] == b"acTL" && bytes.ends_with(b"IEND\xaeB`\x82"));
    u32::from_be_bytes(bytes[41..45].try_into().unwrap())
}

#[test]
fn movies_need_no_other_program() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_in(folder.path(), "picture_of_walls.in", &[], Some(folder.path()));
    assert_eq!(frames(&folder.path().join("walls.apng")), 3);
    assert!(!text(&output).contains("ffmpeg"), "{}", text(&output));
    let output =
        run_in(folder.path(), "picture_of_walls.in", &["-var", "name", "film.mp4"], Some(folder.path()));
    let printed = text(&output);
    assert!(printed.contains("the movie is written as `film.apng`"), "{printed}");
    assert_eq!(frames(&folder.path().join("film.apng")), 3);
    assert!(!folder.path().join("film.mp4").exists());
}

#[cfg(unix)]
#[test]
fn where_ffmpeg_is_found_it_gets_the_pictures() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("ffmpeg");
    // Keeps what it gets, and how it was called.
    fs::write(&program, "#!/bin/sh\necho \"$@\" > called\n/bin/cat > got\n").unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    run_in(folder.path(), "picture_of_walls.in", &["-var", "name", "film.mp4"], Some(folder.path()));
    let called = fs::read_to_string(folder.path().join("called")).unwrap();
    assert!(
        called.contains("-r 25 -i -") && called.trim_end().ends_with("-b:v 2000k -r 25 file:film.mp4"),
        "{called}"
    );
    // Three pictures of 64 by 48 pixels, each behind its head of 13 bytes.
    assert_eq!(fs::read(folder.path().join("got")).unwrap().len(), 3 * (13 + 3 * 64 * 48));
}

#[test]
fn a_leaning_box_leans_in_the_report() {
    let folder = tempfile::tempdir().unwrap();
    run_in(folder.path(), "report_of_a_leaning_box.in", &["-report", "run.html"], None);
    let page = fs::read_to_string(folder.path().join("run.html")).unwrap();
    let edges = "\"edges\":[[2e-2,0e0,0e0],[1e-2,2e-2,0e0],[0e0,0e0,2e-2]]";
    assert!(page.contains(edges), "{:?}", page.split("\"edges\":").nth(1).map(|rest| &rest[..80]));
    assert!(page.contains(">finished</p>") && page.contains("\"units\":[\"m\",\"s\",\"m/s\"]"));
}

#[test]
fn solids_in_reports_leave_no_specks_and_walls_are_there() {
    let folder = tempfile::tempdir().unwrap();
    run_in(folder.path(), "picture_of_huge_spheres.in", &["-report", "run.html"], None);
    let page = fs::read_to_string(folder.path().join("run.html")).unwrap();
    // Half the diagonal of a face of a cube of 0.5 mm, as in pictures.
    let radius = page.split("{\"name\":\"radius\",\"bits\":0,\"lo\":").nth(1).unwrap();
    let radius: f64 = radius.split(',').next().unwrap().parse().unwrap();
    assert!((radius / (0.5e-3 / 2f64.sqrt()) - 1.0).abs() < 1e-9, "{radius}");
    run_in(folder.path(), "picture_of_walls.in", &["-report", "run.html"], None);
    let page = fs::read_to_string(folder.path().join("run.html")).unwrap();
    assert!(page.contains("\"walls\":\"") && page.contains("id=\"walls\""));
}
