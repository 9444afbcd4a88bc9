//! Text dumps against LAMMPS' own files, byte for byte.
//!
//! `golden/` holds what LAMMPS 22Jul2025 writes for `in.dumps` (`lmp -in in.dumps -var dir golden`), where `g.dump`
//! began with the line `before`; `golden_forms/`, `golden_times/` and `golden_binary/` the same for `in.forms`, `in.times` and `in.binary`. Formats show at most eight digits: the last ones of a double depend on the order of
//! additions into forces.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use perigrain::session::{Options, Session};
use perigrain::world::Compat;

mod jpeg;
mod vtu;

/// All files of a folder by name.
fn files(folder: &Path) -> BTreeMap<String, String> {
    let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap());
    entries.map(|e| (e.file_name().into_string().unwrap(), fs::read_to_string(e.path()).unwrap())).collect()
}

/// Faces of the box are written with all digits, and a shrink-wrapped one follows a particle: equal to 1e-12.
fn close(a: &str, b: &str) -> bool {
    let numbers = |t: &str| -> Vec<f64> { t.split(' ').map(|n| n.parse().unwrap()).collect() };
    let (ours, theirs) = (numbers(a), numbers(b));
    a.len() == b.len() && ours.iter().zip(&theirs).all(|(x, y)| (x - y).abs() <= 1e-12 * y.abs())
}

#[test]
fn the_same_bytes_as_lammps() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/dumps");
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("g.dump"), "before\n").unwrap();
    let dir = folder.path().to_str().unwrap().to_string();
    // LAMMPS' unfolded fractions carry the rounding of its image offset: an artefact of compat.
    let options =
        Options { compat: Compat::Lammps2025, vars: vec![("dir".into(), vec![dir])], ..Options::default() };
    let mut session = Session::new(options).unwrap();
    let deck = fs::read_to_string(here.join("in.dumps")).unwrap();
    session.run_text("in.dumps", &deck).unwrap();
    let (ours, theirs) = (files(folder.path()), files(&here.join("golden")));
    assert_eq!(ours.keys().collect::<Vec<_>>(), theirs.keys().collect::<Vec<_>>());
    for (name, text) in &ours {
        assert_eq!(text.lines().count(), theirs[name].lines().count(), "{name}");
        let mut bounds = 0;
        for (k, (a, b)) in text.lines().zip(theirs[name].lines()).enumerate() {
            let same = if bounds > 0 { close(a, b) } else { a == b };
            assert!(same, "{name}, line {}:\nours   {a}\nLAMMPS {b}", k + 1);
            bounds = if a.starts_with("ITEM: BOX BOUNDS") { 3 } else { bounds.max(1) - 1 };
        }
    }
}

#[test]
fn other_forms_are_the_same_bytes_too() {
    writes_the_same("forms");
}

/// Runs `in.NAME`, whose files are those of `golden_NAME`.
fn writes_the_same(name: &str) {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/dumps");
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap().to_string();
    let options =
        Options { compat: Compat::Lammps2025, vars: vec![("dir".into(), vec![dir])], ..Options::default() };
    let file = format!("in.{name}");
    let deck = fs::read_to_string(here.join(&file)).unwrap();
    Session::new(options).unwrap().run_text(&file, &deck).unwrap();
    same(&files(folder.path()), &files(&here.join(format!("golden_{name}"))));
}

fn same(ours: &BTreeMap<String, String>, theirs: &BTreeMap<String, String>) {
    assert_eq!(ours.keys().collect::<Vec<_>>(), theirs.keys().collect::<Vec<_>>());
    for (name, text) in ours {
        assert_eq!(text, &theirs[name], "{name}");
    }
}

#[test]
fn binary_dumps_are_the_same_bytes_and_are_read_again() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/dumps");
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap().to_string();
    let options = || Options { vars: vec![("dir".into(), vec![dir.clone()])], ..Options::default() };
    let deck = fs::read_to_string(here.join("in.binary")).unwrap();
    let mut written = Session::new(options()).unwrap();
    written.run_text("in.binary", &deck).unwrap();
    let bytes = |folder: &Path| -> BTreeMap<String, Vec<u8>> {
        let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap());
        entries.map(|e| (e.file_name().into_string().unwrap(), fs::read(e.path()).unwrap())).collect()
    };
    let (ours, theirs) = (bytes(folder.path()), bytes(&here.join("golden_binary")));
    assert_eq!(ours.keys().collect::<Vec<_>>(), theirs.keys().collect::<Vec<_>>());
    for (name, file) in &ours {
        assert!(file == &theirs[name], "{name}");
    }
    // The file that LAMMPS has written, from the state of the beginning.
    let begin = deck.split("dump a").next().unwrap();
    let golden = here.join("golden_binary");
    let again = format!("{begin}read_dump {}/c.bin 4 y z vx ix iz\n", golden.display());
    let mut read = Session::new(options()).unwrap();
    read.run_text("again", &again).unwrap();
    let (a, b) = (&written.world.particles, &read.world.particles);
    assert_eq!((a.x[2][1], a.x[2][2], a.v[0][0]), (b.x[2][1], b.x[2][2], b.v[0][0]));
    let rerun = format!("{begin}rerun {}/a.bin every 2 dump x y z\n", golden.display());
    let mut shown = Session::new(options()).unwrap();
    shown.run_text("rerun", &rerun).unwrap();
    assert_eq!((shown.world.clock.step, shown.world.particles.x[1]), (4, a.x[1]));
    let broken = ours["a.bin"][..200].to_vec();
    fs::write(folder.path().join("broken.bin"), broken).unwrap();
    let bad = format!("{begin}read_dump {dir}/broken.bin 0 x y z\n");
    let message = Session::new(options()).unwrap().run_text("bad", &bad).unwrap_err().to_string();
    assert!(message.contains("breaks off"), "{message}");
}

// A picture is the same in every kind of file, but for what JPEG takes off.
#[test]
fn pictures_of_every_kind_show_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap().to_string();
    let options = Options { vars: vec![("dir".into(), vec![dir])], ..Options::default() };
    let mut deck = String::from(
        "atom_style sphere\nregion b block 0 4 0 4 0 4\ncreate_box 2 b\ncreate_atoms 1 single 1 1 1\n\
         create_atoms 2 single 3 1 1\nset group all diameter 1.5\n",
    );
    for ending in ["png", "ppm", "jpg", "JPEG"] {
        deck += &format!("write_dump all image ${{dir}}/p.{ending} type auto modify size 101 60\n");
    }
    Session::new(options).unwrap().run_text("in.pictures", &deck).unwrap();
    let file = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let ppm = file("p.ppm");
    let head = b"P6\n101 60\n255\n";
    assert_eq!((&ppm[..head.len()], ppm.len()), (&head[..], head.len() + 101 * 60 * 3));
    let pixels = &ppm[head.len()..];
    let mut png = png::Decoder::new(std::io::Cursor::new(file("p.png"))).read_info().unwrap();
    let mut exact = vec![0; png.output_buffer_size().unwrap()];
    png.next_frame(&mut exact).unwrap();
    assert!(exact == pixels);
    assert_eq!(file("p.jpg"), file("p.JPEG"));
    let jpeg = zune_jpeg::JpegDecoder::new(std::io::Cursor::new(file("p.jpg"))).decode().unwrap();
    let off: f64 = jpeg.iter().zip(pixels).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    // Smooth spheres on a plain ground: at this quality colours are off by less than 3 of 255 in the mean, most of it at their edges.
    assert!(jpeg.len() == pixels.len() && off / (pixels.len() as f64) < 3.0, "{off}");
}

#[test]
fn times_columns_and_rows_are_the_same_bytes() {
    writes_the_same("times");
}

/// A growing file is packed snapshot by snapshot, a file of one snapshot as a whole: both unpack to what is written
/// without `.gz`.
#[test]
fn packed_files_unpack_to_the_same_text() {
    use std::io::Read;
    let folder = tempfile::tempdir().unwrap();
    let deck = "units lj\nlattice sc 1\nregion b block 0 4 0 4 0 4\ncreate_box 1 b\ncreate_atoms 1 box\nmass 1 1\n\
        velocity all set 1 2 3\nfix 1 all nve\ndump 1 all atom 2 ${dir}/a.txt\ndump 2 all atom 2 ${dir}/a.txt.gz\n\
        dump 3 all yaml 4 ${dir}/b.*.txt id x\ndump 4 all yaml 4 ${dir}/b.*.txt.gz id x\nrun 4\n";
    let dir = folder.path().to_str().unwrap().to_string();
    let options = Options { vars: vec![("dir".into(), vec![dir])], ..Options::default() };
    Session::new(options).unwrap().run_text("in.packed", deck).unwrap();
    for name in ["a.txt", "b.0.txt", "b.4.txt"] {
        let packed = fs::File::open(folder.path().join(format!("{name}.gz"))).unwrap();
        let mut text = String::new();
        flate2::read::MultiGzDecoder::new(packed).read_to_string(&mut text).unwrap();
        assert_eq!(text, fs::read_to_string(folder.path().join(name)).unwrap(), "{name}");
    }
}

/// What an earlier run has left in a file is gone when a run begins, even if the first snapshot comes later or never.
#[test]
fn a_growing_file_begins_with_the_run() {
    use std::io::Read;
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    ["late.txt", "late.gz", "more.txt"].iter().for_each(|name| fs::write(at(name), "stale").unwrap());
    let deck = "units lj\nlattice sc 1\nregion b block 0 4 0 4 0 4\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\nmass 1 1\nfix 1 all nve\n\
        reset_timestep 3\ndump 1 all custom 100 ${dir}/late.txt id\ndump 2 all custom 100 ${dir}/late.gz id\n\
        dump 3 all custom 4 ${dir}/more.txt id\ndump_modify 3 append yes header no\ndump 4 all custom 100 ${dir}/none.*.txt id\n\
        run 2\n";
    let dir = folder.path().to_str().unwrap().to_string();
    let options = Options { vars: vec![("dir".into(), vec![dir])], ..Options::default() };
    Session::new(options).unwrap().run_text("in.late", deck).unwrap();
    assert_eq!(fs::read_to_string(at("late.txt")).unwrap(), "");
    let mut text = String::new();
    flate2::read::MultiGzDecoder::new(fs::File::open(at("late.gz")).unwrap())
        .read_to_string(&mut text)
        .unwrap();
    assert_eq!(text, "");
    assert_eq!(fs::read_to_string(at("more.txt")).unwrap(), "stale1\n");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
}

/// The styles that end in `/gz`: the text of those without, packed as tightly as `compression_level` says.
#[test]
fn styles_that_pack_write_the_same_text() {
    use std::io::Read;
    let folder = tempfile::tempdir().unwrap();
    let dumps = [
        ("atom", "a", ""),
        ("custom", "b.*", "id x vy"),
        ("cfg", "c.*", "mass type xs ys zs vx"),
        ("xyz", "d", ""),
        ("local", "e.*", "index c_q[1] c_q[2]"),
    ];
    let mut deck = String::from(
        "units lj\natom_style sphere\nlattice sc 1\nregion b block 0 6 0 6 0 6\ncreate_box 1 b\ncreate_atoms 1 box\n\
         set group all diameter 1.1\nset group all density 1\npair_style granular\npair_coeff * * hooke 1e-3 0 tangential \
         linear_nohistory 0 0\nvelocity all set 1 2 3\nfix 1 all nve/sphere\ncompute q all property/local patom1 patom2\n",
    );
    let mut line = |text: String| deck += &format!("{text}\n");
    for (style, name, what) in dumps {
        line(format!("dump {style} all {style} 2 ${{dir}}/{name}.txt {what}"));
        for level in [-1, 0, 1, 9] {
            line(format!("dump {style}{level} all {style}/gz 2 ${{dir}}/{name}.{level}.gz {what}"));
            line(format!("dump_modify {style}{level} compression_level {level}"));
        }
    }
    line("run 4".into());
    let dir = folder.path().to_str().unwrap().to_string();
    let options = Options { vars: vec![("dir".into(), vec![dir])], ..Options::default() };
    Session::new(options).unwrap().run_text("in.packed", &deck).unwrap();
    for (style, name, _) in dumps {
        let name = name.replace('*', "4");
        let plain = fs::read_to_string(folder.path().join(format!("{name}.txt"))).unwrap();
        let sizes = [-1, 0, 1, 9].map(|level| {
            let bytes = fs::read(folder.path().join(format!("{name}.{level}.gz"))).unwrap();
            let mut text = String::new();
            flate2::read::MultiGzDecoder::new(&bytes[..]).read_to_string(&mut text).unwrap();
            assert_eq!(text, plain, "{style} {level}");
            bytes.len()
        });
        let [usual, none, fast, tight] = sizes;
        assert!(none > plain.len() && fast < none && usual < fast && tight < fast, "{style}: {sizes:?}");
    }
}

#[test]
fn check_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap().to_string();
    let mode = perigrain::session::Mode::Check;
    let mut session =
        Session::new(Options { mode, vars: vec![("dir".into(), vec![dir])], ..Options::default() }).unwrap();
    session.run_text("in.dumps", include_str!("in.dumps")).unwrap();
    assert!(files(folder.path()).is_empty());
}

/// A small block in two types, one half moving, with pictures and points for ParaView.
const PICTURES: &str = "
units si
atom_style peri
boundary s s s
lattice sc 0.001
region box block -0.01 0.01 -0.01 0.01 -0.01 0.01 units box
create_box 2 box
region body block 0 0.004 0 0.003 0 0.002 units box
create_atoms 1 region body
region half block INF INF INF 0.0015 INF INF units box
set region half type 2
group near type 2
set group all density 2200
set group all volume 1e-9
pair_style peri/pmb
pair_coeff * * 1.0e20 0.0030001 0.010 0.0
velocity near set 0 0 1 units box
fix 1 all nve
timestep 5e-8
variable speed atom vz
dump p all image 5 ${dir}/p.*.png v_speed auto view 60 30 size 200 150 map damage range 0 1 legend speed time yes
dump_modify p pad 2 region half title two_halves first yes
dump k near image 10 ${dir}/k.*.png type auto size 64 48 box yes 0.1 acolor 2 '#ff0000' fsaa no
dump v all vtk 10 ${dir}/v_*.vtu id type vx vy vz v_speed
run 10
run 10
write_dump all image ${dir}/once.png type auto size 50 40
";

/// Width and height of a PNG, and how many colours it has.
fn picture(path: &Path) -> (u32, u32, usize) {
    let mut reader =
        png::Decoder::new(std::io::BufReader::new(fs::File::open(path).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let colours: std::collections::BTreeSet<&[u8]> = bytes.chunks(3).collect();
    (info.width, info.height, colours.len())
}

#[test]
fn pictures_and_points() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap().to_string();
    let mut session =
        Session::new(Options { vars: vec![("dir".into(), vec![dir])], ..Options::default() }).unwrap();
    session.run_text("in.pictures", PICTURES).unwrap();
    let mut names: Vec<String> =
        fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let expected = "k.0.png k.10.png k.20.png once.png p.00.png p.05.png p.10.png p.15.png p.20.png v.pvd v_0.vtu v_10.vtu \
                    v_20.vtu";
    assert_eq!(names.join(" "), expected);
    let (width, height, colours) = picture(&folder.path().join("p.10.png"));
    assert!((width, height) == (200, 150) && colours > 200, "{width} {height} {colours}");
    assert_eq!(picture(&folder.path().join("k.10.png")).0, 64);
    assert_eq!(picture(&folder.path().join("once.png")).1, 40);
    let series = fs::read_to_string(folder.path().join("v.pvd")).unwrap();
    // Three snapshots, 10 steps of 5e-8 s apart, named without the folder.
    assert_eq!(series.matches("<DataSet ").count(), 3);
    assert!(series.contains("timestep=\"5e-7\" group=\"\" part=\"0\" file=\"v_10.vtu\""), "{series}");
    let points = fs::read(folder.path().join("v_20.vtu")).unwrap();
    let head = String::from_utf8_lossy(&points[..2000]).into_owned();
    for part in
        ["NumberOfPoints=\"60\"", "Name=\"id\"", "Name=\"v\" NumberOfComponents=\"3\"", "Name=\"v_speed\""]
    {
        assert!(head.contains(part), "{part} in {head}");
    }
}
