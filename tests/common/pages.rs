//! The small scene in which examples of the manual run.

use perigrain::cli::manual::Page;
use perigrain::session::Session;
use perigrain::world::World;
use perigrain::world::outside::{Host, Invoked};
use std::fmt::Write as _;
use std::sync::{Arc, MutexGuard};

/// A bonded plate of type 1 and a sphere of type 2 above it, with everything that examples name.
///
/// An example takes the place of the scene's own lines of the same kind ([`subject`]), so that `atom_style …` or `lattice …`
/// stand where such a line belongs; all others come before the last line. The ball has the mass of a grain and bonds of force
/// densities: its energy does not matter.
pub const SCENE: &str = "\
units si
dimension 3
boundary s s s
atom_style hybrid sphere peri
atom_modify map array
newton on
processors * * *
package omp 1
lattice sc 0.001
region world block -0.006 0.006 -0.006 0.006 -0.003 0.009 units box
create_box 3 world
region plate block -0.004 0.004 -0.004 0.004 -0.001 0.001 units box
region disc cylinder z 0 0 0.004 -0.001 0.001 units box
region notch block -0.0005 0.0005 -0.006 0.0 -0.002 0.002 units box
region half block INF INF INF 0.0 INF INF units box
region ball sphere 0 0 0.004 0.001 units box
create_atoms 1 region plate
create_atoms 2 single 0 0 0.004 units box
group plate type 1
group ball type 2
group bullet type 2
group grains type 2
group wall type 3
group foot region half
group top region half
set group ball diameter 0.001
set group all density 2235.0
set group all volume 1e-9
timestep 1.0e-8
neighbor 0.0005 bin
neigh_modify every 5 delay 0 check yes
pair_style peri/pmb
pair_coeff * * 1.6863e22 0.0030001 5.0e-4 0.25
velocity ball set 0 0 -1 units box
fix motion all nve
compute dmg all damage/atom
compute damage all damage/atom
variable force equal fcm(plate,z)
variable speed equal vcm(ball,z)
variable z equal 0.006-2*time
thermo_style custom step time pe ke
thermo 1
thermo_modify energy ignore
run 1
";

/// What a line of the scene is about, if an example's line about the same takes its place: a setting that is
/// there once, or a thing with a name.
fn subject(line: &str) -> Option<Vec<&str>> {
    let mut words = line.split_whitespace();
    let first = words.next()?;
    match first {
        "units" | "dimension" | "boundary" | "atom_style" | "atom_modify" | "newton" | "package"
        | "processors" | "lattice" | "create_box" | "timestep" | "neighbor" | "neigh_modify"
        | "pair_style" | "pair_coeff" | "thermo" | "thermo_style" => Some(vec![first]),
        "region" | "group" | "compute" | "fix" | "variable" => Some(vec![first, words.next()?]),
        _ => None,
    }
}

/// A plate that conducts heat.
const CONDUCTING: &str = "material glass E 72e9 nu 0.25 rho 2440 conductivity 1 heat_capacity 800
pair_coeff * * material glass horizon 3.0001";

/// Pages whose examples need other lines in the scene: title, how the scene's line begins, what stands in its place.
const CHANGED: &[(&str, &str, &str)] = &[
    // Only an atom style without masses of its own takes them by type.
    ("mass", "atom_style", "atom_style atomic"),
    ("mass", "set group", ""),
    ("mass", "pair_style", "pair_style none"),
    ("mass", "pair_coeff", ""),
    ("mass", "compute", ""),
    // A flat scene is periodic along z.
    ("fix enforce2d", "dimension", "dimension 2"),
    ("fix enforce2d", "boundary", "boundary s s p"),
    ("fix deform", "boundary", "boundary f s s"),
    ("fix deform/pressure", "boundary", "boundary f s s"),
    ("fix enforce2d", "lattice", "lattice sq 0.001"),
    (
        "fix enforce2d",
        "region world",
        "region world block -0.006 0.006 -0.006 0.006 -0.0005 0.0005 units box",
    ),
    ("fix enforce2d", "create_atoms 2", "create_atoms 2 single 0 0.005 0 units box"),
    ("fix enforce2d", "velocity", "velocity ball set 0 -1 0 units box"),
    // Heat needs a material.
    ("fix heat/held", "pair_coeff", CONDUCTING),
    ("fix heat/flux", "pair_coeff", CONDUCTING),
    ("fix heat/convect", "pair_coeff", CONDUCTING),
    // One integrator per particle: the fix moves these itself.
    ("fix move", "fix motion", "group rest subtract all top\nfix motion rest nve"),
];

/// Files that examples read: name, text.
const FILES: &[(&str, &str)] = &[
    (
        "dump.grains",
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n\
         ITEM: ATOMS id type x y z diameter\n1 1 0.2 0.5 0.5 0.3\n2 1 0.7 0.5 0.5 0.3\n",
    ),
    ("plate.inc", "print \"from the other file\"\n"),
    (
        "blade.stl",
        "solid blade\nfacet normal 0 0 1\nouter loop\nvertex -3 -3 0\nvertex 3 -3 0\nvertex 0 3 0\nendloop\nendfacet\n\
         endsolid blade\n",
    ),
    (
        "gear.obj",
        "v 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n\
         f 2 1 6\nf 3 2 6\nf 4 3 6\nf 1 4 6\n",
    ),
    (
        "body.msh",
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 \"rock\"\n3 2 \"binder\"\n$EndPhysicalNames\n$Nodes\n5\n\
         1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 4 2 2 2 2 3 4 5\n\
         $EndElements\n",
    ),
];

/// Files of bytes that examples read.
const BYTES: &[(&str, &[u8])] = &[("stack.nrrd", include_bytes!("../geometry/files/raw8.nrrd"))];

/// A program that hosts a session; its functions do nothing.
#[derive(Debug)]
struct Program;

impl Host for Program {
    fn has(&self, _: &str) -> bool {
        true
    }
    fn invoke(&self, _: &str, _: Invoked, _: &mut World) -> Result<(), String> {
        Ok(())
    }
}

/// Makes a program host the session, as `fix python/invoke` requires.
pub fn hosted(mut session: Session) -> Session {
    session.set_host(Arc::new(Program));
    session
}

/// A folder of its own as the working folder, with the files that examples read.
pub struct Folder {
    path: tempfile::TempDir,
    _alone: MutexGuard<'static, ()>,
}

impl Folder {
    /// The working folder belongs to the whole process: `alone` keeps it for one test at a time.
    pub fn new(alone: MutexGuard<'static, ()>) -> Self {
        let path = tempfile::tempdir().unwrap();
        std::env::set_current_dir(&path).unwrap();
        for (name, text) in FILES {
            std::fs::write(name, text).unwrap();
        }
        for (name, bytes) in BYTES {
            std::fs::write(name, bytes).unwrap();
        }
        Self { path, _alone: alone }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // The folder cannot be the working folder when it goes.
        let _ = std::env::set_current_dir(self.path.path().parent().unwrap());
    }
}

/// The first word of a line.
fn command(line: &str) -> &str {
    line.split_whitespace().next().unwrap_or("")
}

/// Whether an example brings its own integrator for all particles.
fn integrates(example: &str) -> bool {
    example.lines().any(|l| {
        let words: Vec<&str> = l.split_whitespace().collect();
        words.first() == Some(&"fix") && words.get(3).is_some_and(|s| s.starts_with("nve"))
    })
}

/// A line that draws a picture without a given size draws one of 320 × 240 pixels, not of 1280 × 960: with these, drawing was
/// half of the time of `tests/stated.rs`.
fn small(line: &str) -> String {
    let words: Vec<&str> = line.split_whitespace().collect();
    let style = match words.first() {
        Some(&"dump") => words.get(3),
        Some(&"write_dump") => words.get(2),
        _ => None,
    };
    let sized = words.contains(&"size") || words.last() == Some(&"&");
    if style == Some(&"image") && !sized { format!("{line} size 320 240\n") } else { format!("{line}\n") }
}

/// The scene with an example in it.
pub fn deck(title: &str, example: &str) -> String {
    let example = &example.lines().map(small).collect::<String>();
    if is_whole(example) {
        return example.to_string();
    }
    let subjects: Vec<_> = example.lines().filter_map(subject).collect();
    let no_motion = integrates(example);
    let mut waiting = Some(example.trim_end());
    let mut deck = String::new();
    for line in SCENE.lines() {
        let replaced = subject(line).is_some_and(|s| subjects.contains(&s));
        if (replaced || line == "run 1")
            && let Some(text) = waiting.take()
        {
            let _ = writeln!(deck, "{text}");
        }
        let changed = CHANGED.iter().find(|(t, begin, _)| *t == title && line.starts_with(begin));
        match changed {
            _ if replaced || (no_motion && line.starts_with("fix motion")) => {}
            Some((.., text)) => drop(writeln!(deck, "{text}")),
            None => drop(writeln!(deck, "{line}")),
        }
    }
    deck
}

/// Whether an example is a deck by itself.
fn is_whole(example: &str) -> bool {
    command(example) == "units" && example.lines().count() > 1
}

/// The example of the page about the program itself is for the shell.
pub fn is_for_the_shell(page: &Page) -> bool {
    command(page.doc.example) == "perigrain"
}
