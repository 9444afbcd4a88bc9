//! Pages about runs, made by the program as a user would call it.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

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
dump d all custom 20 d.dump id type x y z vx vy vz radius element
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
        "<p class=\"verdict passed\">finished</p>",
        "\"units\":[\"m\",\"s\",\"m/s\"]",
        "<dt>particles</dt><dd>2</dd>",
        "<dt>steps</dt><dd>100</dd>",
        "a&lt;b",
        "compute erotate/sphere",
        "\"steps\":[0,10,20,30,40,50,60,70,80,90,100]",
        "data:image/png;base64,",
        "p.50.png",
        "pair granular",
        "units si",
        "id=\"view\"",
        "{\"name\":\"speed\",",
    ] {
        assert!(page.contains(part), "{part}");
    }
    // The beginning, and sixty intervals of two steps are one too many for a hundred.
    assert_eq!(page.matches("id=\"frame-").count(), 51);
    assert_eq!(page.matches("\"follows\":true").count(), 50);
    assert!(!page.contains("<script>alert"), "the deck's text is escaped");
    // The screen and the log are those of a run without a page.
    let log = fs::read_to_string(home.join("log.lammps")).unwrap();
    assert!(!log.contains("Report in"), "{log}");
}

#[test]
fn a_failed_run_has_a_page_with_the_reason() {
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

/// Rows of the step table and of dumps: all that a run computes.
fn numbers(folder: &Path) -> String {
    let log = fs::read_to_string(folder.join("log.lammps")).unwrap();
    let rows =
        log.lines().filter(|l| l.trim_start().starts_with(|c: char| c.is_ascii_digit()) && !l.contains('%'));
    rows.collect::<Vec<_>>().join("\n") + &fs::read_to_string(folder.join("d.dump")).unwrap()
}

#[test]
fn a_run_that_is_looked_at_gives_the_same_bits() {
    // Steps of solids are made with the next one's beginning where nothing reads the scene.
    let solid = "\
units si
atom_style peri
boundary s s s
lattice sc 0.001
region box block -0.02 0.02 -0.02 0.02 -0.005 0.005 units box
region plate block -0.006 0.006 -0.006 0.006 -0.001 0.001 units box
create_box 1 box
create_atoms 1 region plate
material glass file soda-lime-glass.toml
set group all volume 1e-9
pair_style peri/pmb
pair_coeff 1 1 material glass horizon 3.015
velocity all ramp vx -9 9 x -0.006 0.006 units box
fix motion all nve
thermo_style custom step pe ke
thermo_modify format float %.17g
thermo 83
timestep 1e-7
dump d all custom 250 d.dump id x y z vx vy vz
dump_modify d format float %.17g
run 400
run 100
";
    for deck in [DECK, solid] {
        let both = [&["in.deck"][..], &["in.deck", "-report", "run.html"]].map(|args| {
            let folder = tempfile::tempdir().unwrap();
            fs::write(folder.path().join("in.deck"), deck.replace("radius element", "radius")).unwrap();
            let o = perigrain(folder.path(), args);
            assert_eq!(o.status.code(), Some(0), "{}", err(&o));
            numbers(folder.path())
        });
        assert!(both[0].lines().count() > 20);
        assert_eq!(both[0], both[1]);
    }
}

/// A folder with a log and a dump.
fn after_a_run() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.fall"), DECK).unwrap();
    let o = perigrain(folder.path(), &["in.fall"]);
    assert_eq!(o.status.code(), Some(0), "{}", err(&o));
    folder
}

#[test]
fn a_page_is_made_from_a_log_and_a_dump() {
    let folder = after_a_run();
    let home = folder.path();
    let o = perigrain(home, &["report", "log.lammps", "d.dump", "-o", "run.html"]);
    assert_eq!(o.status.code(), Some(0), "{}", err(&o));
    let page = fs::read_to_string(home.join("run.html")).unwrap();
    for part in [
        "<title>log.lammps</title>",
        "<p class=\"verdict passed\">finished</p>",
        "<dt>particles</dt><dd>2</dd>",
        "\"steps\":[0,10,20,30,40,50,60,70,80,90,100]",
        "{\"name\":\"speed\",",
        "{\"name\":\"vx\",",
        "\"step\":40,\"time\":4e-3,\"n\":2,",
        ">Log</h2>",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert_eq!(page.matches("id=\"frame-").count(), 6);
    assert!(!page.contains("<script>alert") && !page.contains("{\"name\":\"element\""));
}

#[test]
fn odd_logs_and_dumps_are_noted_on_the_page_or_refused() {
    let folder = after_a_run();
    let home = folder.path();
    let read = |name: &str| fs::read_to_string(home.join(name)).unwrap();
    let (log, dump) = (read("log.lammps"), read("d.dump"));
    let write = |name: &str, text: &str| fs::write(home.join(name), text).unwrap();
    write("cut.log", &log[..log.find("Loop time").unwrap()]);
    write("cut.dump", &dump[..dump.len() - 30]);
    write("bare.log", "no table\n");
    write("other.dump", &dump.replace("TIMESTEP\n", "TIMESTEP\n77777"));
    write("words.dump", &dump.replace("0.", "zero."));
    write("head.dump", "ITEM: TIMESTEP\n");
    write("empty", "");
    for (args, printed) in [
        (&["cut.log", "d.dump"][..], "it has no end"),
        (&["log.lammps", "cut.dump"], "can be read up to some snapshot only"),
        (&["log.lammps", "other.dump"], "the dump seems to be of another run"),
        (&["bare.log"], "no step table that could be read"),
        (&["empty"], "no step table that could be read"),
        (&["log.lammps"], "No dump was given"),
        (&["d.dump"], "No log was given"),
    ] {
        let all: Vec<&str> = ["report"].iter().chain(args).chain(&["-o", "run.html"]).copied().collect();
        let o = perigrain(home, &all);
        assert_eq!(o.status.code(), Some(0), "{args:?}: {}", err(&o));
        assert!(read("run.html").contains(printed), "{args:?}: {printed}");
    }
    for (args, code, printed) in [
        (&["report", "no.log"][..], 1, "cannot read `no.log`"),
        (&["report", "head.dump"], 1, "the file ends where the step should be"),
        (&["report", "words.dump"], 1, "zero"),
        (&["report", "log.lammps", "-o", "./log.lammps"], 2, "would be written over `log.lammps`"),
        (&["report", "log.lammps", "-o", "no/run.html"], 1, "cannot write the report"),
        (&["report"], 2, "no log and no dump"),
    ] {
        let o = perigrain(home, args);
        assert_eq!(o.status.code(), Some(code), "{args:?}: {}", err(&o));
        assert!(err(&o).contains(printed), "{args:?}: {}", err(&o));
    }
    assert_eq!(read("log.lammps"), log);
}

/// What a server answers to these lines.
fn asked(address: &str, lines: &str) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    write!(stream, "{lines}\r\n\r\n").unwrap();
    let mut bytes = vec![];
    stream.read_to_end(&mut bytes).unwrap();
    String::from_utf8_lossy(&bytes).into_owned()
}

#[test]
fn a_run_is_shown_paused_and_stopped_while_it_runs() {
    let folder = tempfile::tempdir().unwrap();
    let home = folder.path();
    // Without weight they stay in their box however long it takes.
    let deck = DECK.replace("run 100", "run 2000000000").replace("dump ", "#").replace("fix g ", "#");
    fs::write(home.join("in.fall"), deck).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(["in.fall", "-view", "-screen", "none", "-report", "run.html"])
        .current_dir(home)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stderr.take().unwrap()).read_line(&mut line).unwrap();
    let (address, token) =
        line.trim().strip_prefix("The run is shown at http://").unwrap().split_once("/?").unwrap();
    let host = format!("HTTP/1.1\r\nHost: {address}");
    let get = |path: &str| asked(address, &format!("GET /{path}?{token}&since=0 {host}"));
    let post =
        |path: &str| asked(address, &format!("POST /{path}?{token} {host}\r\nOrigin: http://{address}"));
    // A connection without a request delays no other one.
    let _idle = TcpStream::connect(address).unwrap();
    let page = get("");
    assert!(
        page.starts_with("HTTP/1.1 200")
            && page.contains("connect-src 'self'")
            && page.contains("id=\"live\"")
    );
    for lines in [
        format!("GET / {host}"),
        format!("GET /?token=0 {host}"),
        format!("GET /?{token} HTTP/1.1\r\nHost: evil.example"),
        format!("POST /stop?{token} {host}\r\nOrigin: http://evil.example"),
    ] {
        assert!(asked(address, &lines).starts_with("HTTP/1.1 403"), "{lines}");
    }
    let until = |status: &str| {
        let begin = Instant::now();
        loop {
            let state = get("state");
            if state.contains(status) {
                return state;
            }
            assert!(begin.elapsed() < Duration::from_secs(20), "{state}");
            std::thread::sleep(Duration::from_millis(20));
        }
    };
    assert!(until("\"running\"").contains("\"columns\":[\"step\",\"time\",\"ke\",\"c_v\"]"));
    post("pause");
    std::thread::sleep(Duration::from_millis(200));
    let done = |state: &str| -> i64 {
        state.split("\"done\":").nth(1).unwrap().split(',').next().unwrap().parse().unwrap()
    };
    let before = done(&until("\"paused\""));
    assert_eq!(done(&get("state")), before, "it waits");
    assert!(
        get("frame").contains(&format!("\"step\":{before},")),
        "what is shown is the step it waits after"
    );
    post("step");
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(done(&get("state")), before + 1);
    post("stop");
    // The end waits for a reader until that has seen all.
    while child.try_wait().unwrap().is_none() {
        if let Ok(mut stream) = TcpStream::connect(address) {
            let _ = write!(stream, "GET /frame?{token}&since=99999 {host}\r\n\r\n");
            let _ = stream.read_to_end(&mut vec![]);
        }
    }
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(fs::read_to_string(home.join("run.html")).unwrap().contains("interrupted at a whole step"));
}

#[test]
fn a_port_that_is_taken_is_named_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.fall"), DECK).unwrap();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let o = perigrain(folder.path(), &["in.fall", "-view", &port]);
    assert_eq!(o.status.code(), Some(1));
    assert!(err(&o).contains(&format!("`-view {port}`: the port cannot be had")), "{}", err(&o));
    assert!(err(&o).contains("another program has it"), "{}", err(&o));
}
