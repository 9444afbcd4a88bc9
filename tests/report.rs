//! Pages about runs, made by the program as a user would call it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Grains that fall, with a picture and a table; a text that is a script in a careless page.
const DECK: &str = "\
units si
atom_style sphere
boundary f f f
region box block 0 1 0 1 0 1 units box
create_box 1 box
create_atoms 1 single 0.3 0.5 0.6 units box
create_atoms 1 single 0.7 0.5 0.8 units box
set group all diameter 0.1 density 1000
pair_style granular
pair_coeff * * hertz 1e6 0.5 tangential linear_nohistory 0 0 damping velocity
fix 1 all nve/sphere
fix g all gravity 9.81 vector 0 0 -1
compute v all erotate/sphere
thermo_style custom step time ke c_v
thermo 10
timestep 1e-4
print \"</script><script>alert(1)</script>\"
dump p all image 50 p.*.png type type size 40 30
run 100
";

fn perigrain(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_perigrain")).args(args).current_dir(folder).output().unwrap()
}

fn err(o: &Output) -> String {
    String::from_utf8_lossy(&o.stderr).into_owned()
}

#[test]
fn a_run_leaves_a_page_of_all_that_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let home = folder.path();
    fs::write(home.join("in.fall"), DECK).unwrap();
    let o = perigrain(home, &["-in", "in.fall", "-report", "run.html", "-var", "unused", "a<b"]);
    assert_eq!(o.status.code(), Some(0), "{}", err(&o));
    assert!(String::from_utf8_lossy(&o.stdout).contains("Report in run.html"));
    let page = fs::read_to_string(home.join("run.html")).unwrap();
    for part in [
        "<title>in.fall</title>",
        "worked off to its end",
        "<dt>particles</dt><dd>2</dd>",
        "<dt>steps</dt><dd>100</dd>",
        "a&lt;b",
        "compute erotate/sphere",
        "\"steps\":[0,10,20,30,40,50,60,70,80,90,100]",
        "data:image/png;base64,",
        "p.50.png",
        "pair granular",
        "units si",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("<script>alert"), "the deck's text is escaped");
    // The screen and the log are those of a run without a page.
    let log = fs::read_to_string(home.join("log.lammps")).unwrap();
    assert!(!log.contains("Report in"), "{log}");
}

#[test]
fn a_run_that_fails_has_a_page_that_says_why() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.bad"), DECK.replace("run 100", "run 10\nunfix <g>")).unwrap();
    let o = perigrain(folder.path(), &["in.bad", "-report", "run.html"]);
    assert_eq!(o.status.code(), Some(1), "{}", err(&o));
    let page = fs::read_to_string(folder.path().join("run.html")).unwrap();
    assert!(page.contains("ended with an error") && page.contains("unfix &lt;g&gt;"), "no reason");
    assert!(page.contains("\"steps\":[0,10]"), "no rows");
}

#[test]
fn a_page_that_cannot_be_written_is_found_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.fall"), DECK).unwrap();
    let o = perigrain(folder.path(), &["in.fall", "-report", "no/such/run.html"]);
    assert_eq!(o.status.code(), Some(1));
    assert!(err(&o).contains("cannot write the report `no/such/run.html`"), "{}", err(&o));
    assert!(err(&o).contains("create the folder `no/such` first"), "{}", err(&o));
    assert!(!folder.path().join("p.0.png").exists(), "nothing was run");
    let o = perigrain(folder.path(), &["check", "in.fall", "-report", "run.html"]);
    assert_eq!(o.status.code(), Some(2), "{}", err(&o));
    assert!(err(&o).contains("`-report` shows a run, and `check` makes none"), "{}", err(&o));
}
