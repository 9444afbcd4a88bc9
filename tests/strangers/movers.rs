//! K1: whatever moves or turns particles as a whole turns everything that has a direction.

use super::{numbers, run, text};
use perigrain::graph::catalogue::Tables;
use perigrain::session::{Options, Session};
use perigrain::world::field::UNDER;
use perigrain::world::{Compat, Particles, Under, World};
use perigrain_base::math::body::{Quat, after, back, turn, turned};
use perigrain_base::math::vec3::{Vec3, length, sub};
use std::process::Command;

// LAMMPS 22Jul2025 on the same decks: forces up to 8.3e-5 N and torques up to 1.5e-4 N m, which are the roundings of its acos; before
// orientations turned along there were 2,000 N here.
#[test]
fn bonds_do_not_notice_that_all_is_turned() {
    for style in ["rotational", "beam"] {
        for how in ["displace", "move", "transrot"] {
            let out = run("turned_bonded.in", &["-var", "how", how, "-var", "style", style]);
            let out = text(&out);
            let load = numbers(&out, "LOAD");
            // Coordinates of about 1 m round by 1e-16, and 1e4 N/m times some of these is 1e-11 N.
            assert!(load.len() == 2 && load.iter().all(|a| *a < 1e-9), "{style} {how}: {out}");
        }
    }
}

// LAMMPS 22Jul2025 on the same deck; the bond was torn to 2.41 lengths before members of rigid bodies turned.
#[test]
fn members_of_rigid_bodies_turn_with_them() {
    for (fix, wanted) in [
        ("rigid", [1.00054842974255, 4.18771625683358e-6]),
        ("rigid/small", [1.00054842974255, 4.18771625683358e-6]),
        ("rigid/nve", [1.00054842970483, 4.19173872166296e-6]),
        ("rigid/nve/small", [1.00054842970483, 4.19173872166296e-6]),
    ] {
        let out = text(&run("rigid_beam.in", &["-var", "fx", fix, "-compat", "lammps/2025"]));
        let beam = numbers(&out, "BEAM");
        // 1571 steps of roundings of 1e-16, and angles that LAMMPS takes from acos.
        assert!((beam[0] - wanted[0]).abs() < 1e-9, "{fix}: {out}");
        assert!((beam[1] - wanted[1]).abs() < 1e-8, "{fix}: {out}");
        // Right by default as well.
        let out = text(&run("rigid_beam.in", &["-var", "fx", fix]));
        assert!((numbers(&out, "BEAM")[0] - wanted[0]).abs() < 1e-7, "{fix}: {out}");
    }
}

// LAMMPS 22Jul2025 leaves the springs of contacts where they were: what it prints on the same deck. A quarter turn about z makes -y, x, z of
// what stood before.
#[test]
fn springs_of_contacts_turn_with_their_grains() {
    let near = |a: &[f64], b: [f64; 6]| a.len() == 6 && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-7);
    let compat = text(&run("turned_springs.in", &["-compat", "lammps/2025"]));
    let first = [-86.46999398, 8.072550946, 10.23606585, -0.1308792673, -0.3846568722, -0.7932612349];
    let lammps = [-9.694384605, -87.89526907, 10.23606585, 0.3019829884, -0.03836096333, -0.04328795259];
    assert!(near(&numbers(&compat, "BEFORE"), first) && near(&numbers(&compat, "AFTER"), lammps), "{compat}");
    let out = text(&run("turned_springs.in", &[]));
    let [fx, fy, fz, tx, ty, tz] = numbers(&out, "BEFORE").try_into().unwrap();
    assert!(near(&numbers(&out, "AFTER"), [-fy, fx, fz, -ty, tx, tz]), "{out}");
}

/// The warnings of a row of spheres with bonds that bend about its integrators.
fn warned(fixes: &str, check: bool) -> String {
    let folder = tempfile::tempdir().unwrap();
    let deck = folder.path().join("in.row");
    std::fs::write(&deck, format!("{ROW}{fixes}\nthermo_style custom step\nrun 1\n")).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_perigrain"));
    if check {
        program.arg("check").arg(&deck);
    } else {
        program.arg("-in").arg(&deck).args(["-log", "none"]);
    }
    text(&program.current_dir(folder.path()).output().unwrap())
}

const ROW: &str = "\
units si
newton on off
atom_style bpm/sphere
boundary f f f
region box block -6 6 -6 6 -6 6
create_box 1 box bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4
create_atoms 1 single -1 0 0
create_atoms 1 single 0 0 0
create_atoms 1 single 1 0 0
create_atoms 1 single 4 0 0
set group all diameter 0.9 density 1
group left id 1 2
group right id 3
group apart id 4
group row id 1 2 3
special_bonds lj 0 1 1 coul 1 1 1
bond_style bpm/rotational
bond_coeff 1 10.0 10.0 5 5 5 5 5 5 0 0 0 0
pair_style gran/hooke 1.0 NULL 0.0 NULL 0.0 0
pair_coeff * *
create_bonds single/bond 1 1 2
create_bonds single/bond 1 2 3 special yes
timestep 1e-3
";

#[test]
fn ends_of_bonds_that_bend_need_an_integrator_that_turns_them() {
    let warns = |out: &str| out.contains("does not turn") && out.contains("nve/bpm/sphere");
    for style in ["nve", "nve/sphere", "nve/limit 0.1", "move linear 0 NULL 0"] {
        let fixes = format!("fix 1 all {style}");
        for check in [false, true] {
            let out = warned(&fixes, check);
            assert!(warns(&out), "{style} {check}: {out}");
        }
    }
    // Part of the row is enough, and the sphere that has no bond may fly as it likes; what is held on a path of its own keeps its orientation.
    let out = warned("fix 1 left nve/sphere\nfix 2 right nve/bpm/sphere", false);
    assert!(warns(&out) && out.contains("particle 1,"), "{out}");
    for fixes in [
        "fix 1 row nve/bpm/sphere\nfix 2 apart nve/sphere",
        "fix 1 left move linear 0.1 0 0\nfix 2 right nve/bpm/sphere",
        "fix 1 left nve/noforce\nfix 2 right nve/bpm/sphere",
        "fix 1 row rigid single\nfix 2 apart nve/sphere",
    ] {
        for check in [false, true] {
            let out = warned(fixes, check);
            assert!(!out.contains("does not turn"), "{fixes} {check}: {out}");
        }
    }
}

/// Three spheres that touch, the last two bonded; everything that has a direction is there, and places that they are held to.
const SCENE: &str = "\
units si
newton on off
comm_modify vel yes cutoff 4
atom_style hybrid bpm/sphere dipole
boundary p p p
region b block -5 5 -5 5 -5 5
create_box 2 b bond/types 1 extra/bond/per/atom 6 extra/special/per/atom 20
create_atoms 1 single -1 0 0.1
create_atoms 1 single -0.05 0.2 0
create_atoms 2 single 0.7 0.6 0.3
group body id 1 2 3
set group all diameter 1.0 density 1.0 mol 1
set atom 1 quat 1 2 3 40
set atom 2 quat 0 1 0 -70
set group all dipole 0.3 -0.4 0.5
set type 2 dipole 0.1 0.5 0.2 charge 0.7
set group all omega 1 -2 0.5
velocity all set 0.3 0.1 -0.2
fix own all property/atom d_own
set group all d_own 7
create_bonds single/bond 1 2 3
pair_style granular
pair_coeff * * hooke 1000 0 tangential linear_history 300 0 0.5 rolling sds 50 0 0.5 damping velocity
bond_style bpm/rotational break no smooth no
bond_coeff 1 1e3 1e2 1e2 1e2 1 1 1 1 0 0 0 0
special_bonds lj 0 1 1 coul 1 1 1
fix hold all spring/self 1e-9
compute away all displace/atom
compute flight all vacf
fix start all store/state 0 xu yu zu
timestep 1e-3
thermo_style custom step c_flight[4]
fix 1 all nve/bpm/sphere
run 5
unfix 1
";

/// Three points of a template that do not stand in line.
const TEMPLATE: &str = "\
three

3 atoms

Coords

1 0 0 0
2 1 0 0
3 0 1 0

Types

1 1
2 1
3 1
";

/// How a mover moves matter.
#[derive(Clone, Copy, PartialEq)]
enum How {
    /// As one piece, which it turns.
    Turned,
    /// As one piece, which it does not turn.
    Shifted,
    /// It makes pieces that are turned.
    Made,
    /// It copies all there is.
    Copied,
    /// Each particle by itself.
    Each,
}

/// Every command and fix that puts particles elsewhere, with the lines that let it do so.
const MOVERS: &[(&str, How, &str)] = &[
    ("displace_atoms", How::Turned, "displace_atoms body rotate 0.3 0.1 0 1 2 3 77 units box"),
    ("displace_atoms", How::Shifted, "displace_atoms body move 0.3 0.1 0.2 units box"),
    ("displace_atoms", How::Shifted, "displace_atoms body ramp x 0.1 0.1 y 0 1 units box"),
    ("displace_atoms", How::Each, "displace_atoms body random 0.01 0.01 0.01 4711 units box"),
    ("create_atoms", How::Made, "create_atoms 1 single 3 3 3 mol three 4711 rotate 50 3 2 1"),
    ("create_atoms", How::Made, "create_atoms 1 single 3 3 3 mol three 4711"),
    ("replicate", How::Copied, "replicate 2 1 1"),
    ("change_box", How::Each, "change_box all x scale 1.1 remap"),
    ("move", How::Turned, "fix 2 body move rotate 0.3 0.1 0 1 2 3 1.0\nrun 70"),
    ("move", How::Turned, "fix 2 body move transrot 0.1 0.2 0.3 0.3 0.1 0 1 2 3 1.0\nrun 70"),
    ("move", How::Shifted, "fix 2 body move linear 1 2 3\nrun 70"),
    ("move", How::Shifted, "fix 2 body move wiggle 1 2 3 1.0\nrun 70"),
    (
        "move",
        How::Shifted,
        "variable d equal 0.002*(step-5)\nvariable e equal 2\nfix 2 body move variable v_d NULL NULL v_e v_e v_e\nrun 70",
    ),
    ("rigid", How::Turned, "fix 2 body rigid single\nrun 70"),
    ("rigid/small", How::Turned, "fix 2 body rigid/small molecule\nrun 70"),
    ("rigid/nve", How::Turned, "fix 2 body rigid/nve group 1 body\nrun 70"),
    ("rigid/nve/small", How::Turned, "fix 2 body rigid/nve/small molecule\nrun 70"),
    (
        "recenter",
        How::Shifted,
        "velocity body set 0 0 0\nfix 2 body nve/noforce\nfix 1 body recenter 0.3 0.2 0.1 units box\nrun 3",
    ),
    (
        "deposit",
        How::Made,
        "group new empty\nfix 2 new deposit 1 0 1 4711 region up mol three near 0.1\nrun 2",
    ),
    (
        "pour",
        How::Made,
        "group new empty\nfix 3 all gravity 1 vector 0 0 -1\nfix 2 new pour 1 0 4711 region up mol three\nrun 2",
    ),
    ("insert", How::Each, ""),
    ("nve", How::Each, ""),
    ("nve/sphere", How::Each, ""),
    ("nve/bpm/sphere", How::Each, ""),
    ("nve/limit", How::Each, ""),
    ("nve/noforce", How::Each, ""),
    ("wall/reflect", How::Each, ""),
    ("deform", How::Each, ""),
    ("deform/pressure", How::Each, ""),
];

/// Commands that put no particle elsewhere, or read where it is from a file.
const STAY: &[&str] = &[
    "units",
    "dimension",
    "boundary",
    "atom_style",
    "atom_modify",
    "newton",
    "processors",
    "comm_modify",
    "lattice",
    "region",
    "create_box",
    "read_data",
    "read_dump",
    "read_mesh",
    "read_points",
    "read_voxels",
    "group",
    "set",
    "delete_atoms",
    "velocity",
    "reset_atoms",
    "reset_atom_ids",
    "reset_mol_ids",
    "mass",
    "material",
    "peri_crack",
    "timestep",
    "reset_timestep",
    "run_style",
    "neighbor",
    "min_style",
    "min_modify",
    "neigh_modify",
    "write_data",
    "create_bonds",
    "calibrate",
    "delete_bonds",
    "special_bonds",
    "angle_style",
    "angle_coeff",
    "molecule",
    "clump",
    "mixture",
];

fn mover(name: &str) -> bool {
    MOVERS.iter().any(|(mover, ..)| *mover == name)
}

/// Ops that move particles are listed in `tests/stated.rs`.
#[test]
fn every_command_is_known_to_move_particles_or_not() {
    let tables = Tables::default();
    for command in &tables.commands {
        let name = command.name();
        assert!(mover(name) != STAY.contains(&name), "say in MOVERS or STAY what `{name}` does to particles");
    }
    for (name, ..) in MOVERS {
        let mut there = tables.commands.iter().map(|c| c.name()).chain(tables.fixes.iter().map(|f| f.name()));
        assert!(there.any(|n| n == *name), "{name} is gone");
    }
}

/// The scene before and after a mover has acted.
fn moved(lines: &str) -> (World, World) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("three.mol"), TEMPLATE).unwrap();
    let options =
        Options { folder: folder.path().to_path_buf(), compat: Compat::Perigrain, ..Options::default() };
    let mut session = Session::new(options).unwrap();
    let scene = format!("{SCENE}molecule three three.mol\nregion up block -3 3 -3 3 2 4\n");
    session.run_text("scene", &scene).unwrap();
    let before = session.world.clone();
    session.run_text("mover", &format!("{lines}\n")).unwrap_or_else(|e| panic!("{lines}: {e:?}"));
    (before, session.world.clone())
}

fn near(a: Vec3, b: Vec3) -> bool {
    // Some hundred roundings of coordinates up to 5.
    length(sub(a, b)) < 1e-12
}

fn alike(a: Quat, b: Quat) -> bool {
    (0..4).all(|k| (a[k] - b[k]).abs() < 1e-12)
}

/// Where particle `i` is, images undone.
fn place(w: &World, i: usize) -> Vec3 {
    let by = w.edges().shift(w.particles.image[i].map(f64::from));
    [0, 1, 2].map(|d| w.particles.x[i][d] + by[d])
}

/// How the mover has turned the first particle.
fn turn_of(before: &Particles, after_it: &Particles) -> Quat {
    after(after_it.quat[0], back(before.quat[0]))
}

/// What a field of moved particles has to be after a mover that moves them as one piece; `None` where it is right.
fn wrong(name: &str, under: Under, before: &World, now: &World, lines: &str) -> Option<String> {
    let acts = !lines.contains("run");
    let (old, new) = (&before.particles, &now.particles);
    let q = turn_of(old, new);
    let all = |fits: &dyn Fn(usize) -> bool| (0..3).all(fits);
    let right = match (name, under) {
        ("x", Under::Place) => all(&|i| {
            let arm = |w: &World| sub(place(w, i), place(w, 0));
            near(arm(now), turned(q, arm(before)))
        }),
        // Looked at with places.
        ("image", Under::Place) => true,
        ("quat", Under::Orientation) => all(&|i| alike(new.quat[i], after(q, old.quat[i]))),
        ("mu", Under::Orientation) => {
            all(&|i| near(new.mu[i], turned(q, old.mu[i])) && length(new.mu[i]) > 0.3)
        }
        ("charge", Under::Nothing) => new.charge == old.charge && new.charge.contains(&0.7),
        // Step by step whatever moves particles sets them.
        ("v", Under::Motion) => !acts || new.v == old.v,
        ("omega", Under::Motion) => !acts || new.omega == old.omega,
        ("contacts", Under::Springs) => !acts || springs_turned(before, now, q),
        ("columns", Under::Columns) => columns_right(before, now),
        ("x0", Under::Anchor) => new.x0 == old.x0,
        // There are no walls here, and what is made anew has no state before that.
        ("wall_contacts", Under::Anchor) | (_, Under::Anew) => true,
        ("radius", Under::Nothing) => new.radius == old.radius,
        ("mass", Under::Nothing) => new.mass == old.mass,
        ("type", Under::Nothing) => new.kind == old.kind,
        ("mask", Under::Nothing) => new.mask == old.mask,
        ("volume", Under::Nothing) => new.volume == old.volume,
        ("id", Under::Nothing) => new.tag == old.tag,
        ("molecule", Under::Nothing) => new.molecule == old.molecule,
        ("density", Under::Nothing) => format!("{:?}", new.density) == format!("{:?}", old.density),
        ("type_mass", Under::Nothing) => now.type_mass == before.type_mass,
        ("bonds", Under::Nothing) => {
            now.bonds.list == before.bonds.list && now.bonds.turned == before.bonds.turned
        }
        ("families" | "sites", Under::Nothing) => now.families.is_none(),
        // Of no particle, or of the order in which they stand.
        (
            "rank" | "memo" | "rigid" | "controls" | "box" | "regions" | "travel" | "clock" | "facts",
            Under::Nothing,
        ) => true,
        _ => return Some(format!("nothing looks at `{name}`, which is {under:?}")),
    };
    (!right).then(|| format!("`{name}`, which is {under:?}, is wrong after `{lines}`"))
}

/// Whether the history of all contacts is the former one, turned.
fn springs_turned(before: &World, now: &World, q: Quat) -> bool {
    before.contacts.iter().all(|(key, old)| {
        let Some(new) = now.contacts.get(key) else { return false };
        let three = |row: &[f64], at: usize| [row[at], row[at + 1], row[at + 2]];
        let mut pairs = old.history.chunks(old.width).zip(new.history.chunks(new.width));
        // The spring across the normal, then that against rolling.
        let same =
            |(a, b): (&[f64], &[f64])| [0, 3].iter().all(|at| near(three(b, *at), turned(q, three(a, *at))));
        old.keys == new.keys && !old.keys.is_empty() && pairs.all(same)
    })
}

/// Whether columns hold what their owners have registered. No style keeps vectors that matter carries so far.
fn columns_right(before: &World, now: &World) -> bool {
    let (mut old, new) = (before.columns.clone(), &now.columns);
    let mut seen = 0;
    let vectors = old.vectors_mut().all(|(key, was)| {
        seen += 1;
        match key.under() {
            Some(Under::Anchor | Under::Nothing | Under::Record) => {
                new.get_vector(key) == Some(was.as_slice())
            }
            Some(Under::Anew) => true,
            _ => false,
        }
    });
    let own = new.custom("d_own").and_then(|key| new.get_scalar(key));
    vectors && seen >= 3 && own == Some(&[7.0; 3][..])
}

#[test]
fn every_mover_follows_the_rule_of_every_field() {
    for (name, how, lines) in MOVERS {
        if lines.is_empty() || matches!(how, How::Each | How::Made | How::Copied) {
            continue;
        }
        let (before, now) = moved(lines);
        let spun =
            sub(turned(turn_of(&before.particles, &now.particles), [1.0, 2.0, -2.0]), [1.0, 2.0, -2.0]);
        assert_eq!(length(spun) > 0.01, *how == How::Turned, "{name}: `{lines}` turns by {spun:?}");
        for (field, under) in UNDER {
            let printed = wrong(&field.to_string(), *under, &before, &now, lines);
            assert_eq!(printed, None, "{name}");
        }
    }
}

// Bonds, contacts and all between the members turn along, so that forces do.
#[test]
fn forces_turn_with_what_displace_atoms_turns() {
    let (before, now) = moved(
        "fix 1 all nve/bpm/sphere\nrun 0\ndisplace_atoms body rotate 0.3 0.1 0 1 2 3 77 units box\nrun 0",
    );
    let q = turn([1.0, 2.0, 3.0].map(|a: f64| a / 14f64.sqrt()), 77f64.to_radians());
    for i in 0..3 {
        // Springs of 1000 N/m and places of 1e-16 m; `spring/self` pulls with 1e-9 N/m.
        let difference = sub(now.particles.f[i], turned(q, before.particles.f[i]));
        assert!(length(difference) < 1e-7 && length(before.particles.f[i]) > 1.0, "{difference:?}");
    }
}

// A template has no orientations of its own: its particles lie as the copy does.
#[test]
fn molecules_lie_as_they_are_turned() {
    for (name, _, lines) in MOVERS.iter().filter(|(_, how, _)| *how == How::Made) {
        let (before, now) = moved(lines);
        let (first, p) = (before.n(), &now.particles);
        assert_eq!(p.len(), first + 3, "{name}");
        for (k, arm) in [(1, [1.0, 0.0, 0.0]), (2, [0.0, 1.0, 0.0])] {
            let found = sub(place(&now, first + k), place(&now, first));
            assert!(near(found, turned(p.quat[first], arm)), "{name}: {found:?} {:?}", p.quat[first]);
            assert_eq!(p.quat[first + k], p.quat[first], "{name}");
        }
    }
    // LAMMPS 22Jul2025 makes them with the orientation 1 0 0 0.
    let mut session = Session::new(Options { compat: Compat::Lammps2025, ..Options::default() }).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("three.mol");
    std::fs::write(&file, TEMPLATE).unwrap();
    let scene = format!("{SCENE}molecule three {}\n{}\n", file.display(), MOVERS[4].2);
    session.run_text("scene", &scene).unwrap();
    assert_eq!(session.world.particles.quat[3], [1.0, 0.0, 0.0, 0.0]);
}

// A copy is held to places that are as far away as it is, and lies and moves as what it is a copy of.
#[test]
fn copies_are_held_to_places_of_their_own() {
    let lines = "fix 2 body move linear 1 2 3\nrun 10\nreplicate 2 1 1\nrun 10";
    let (_, now) = moved(lines);
    let p = &now.particles;
    assert_eq!(p.len(), 6);
    for i in 0..3 {
        assert!(near(sub(place(&now, i + 3), place(&now, i)), [10.0, 0.0, 0.0]), "{i}");
        assert!(p.quat[i] == p.quat[i + 3] && p.v[i] == p.v[i + 3]);
    }
    let mut columns = now.columns.clone();
    for (key, column) in columns.vectors_mut() {
        let far = if key.under() == Some(Under::Anchor) { 10.0 } else { 0.0 };
        let fits = |i: usize| near(sub(column[i + 3], column[i]), [far, 0.0, 0.0]);
        assert!(key.under() == Some(Under::Anew) || (0..3).all(fits), "{key}");
    }
    // Rigid bodies of copies are bodies of their own.
    let (_, now) = moved("fix 2 body rigid/small molecule\nrun 10\nreplicate 2 1 1\nrun 10");
    for i in 0..3 {
        assert!(near(sub(place(&now, i + 3), place(&now, i)), [10.0, 0.0, 0.0]), "{i}");
    }
}

// LAMMPS 22Jul2025 on the same deck, of spheres of half a kilogramme; of heavy ones it inverts what rounding leaves of an inertia that has no
// inverse (`compute omega/chunk` gives -0.5 -0.25 1.25, `velocity zero angular` leaves 6 % of the energy).
#[test]
fn straight_groups_have_an_angular_velocity() {
    let wanted = [-0.019753086204542, 0.290123453629211, 1.00246912488051];
    for (mass, compat) in [("0.5", "none"), ("5e5", "none"), ("0.5", "lammps/2025")] {
        let output_of = |what: &str| {
            let how = ["-var", "what", what, "-var", "m", mass, "-compat", compat];
            // By default there is nothing to be compatible with.
            text(&run("straight_group.in", if compat == "none" { &how[..6] } else { &how }))
        };
        let out = output_of("omega");
        // Ten digits of what rounding leaves of sums of nine products.
        let fits = |(k, a): (usize, f64)| (a - wanted[k % 3]).abs() < 1e-10;
        let found = numbers(&out, "OMEGA");
        assert!(found.len() == 6 && found.into_iter().enumerate().all(fits), "{mass} {compat}: {out}");
        for (what, left) in [("zero", 1e-25), ("momentum", 1e-8)] {
            // Of 0.22 J/kg; the fix acts once the step is done (LAMMPS 2.4e-9).
            let out = output_of(what);
            assert!(numbers(&out, "ENERGY")[0] < left, "{mass} {compat}: {out}");
        }
    }
}

// 2/5 m R² with m = 1000 π/6 and R = 1/2, and three times that for a spin of 3 (LAMMPS' pull request 4999 of 2026, in which `omega/chunk`
// stays as it was); LAMMPS 22Jul2025 prints zeros.
#[test]
fn spheres_have_an_inertia_of_their_own() {
    let own = 0.1 * 1000.0 * std::f64::consts::PI / 6.0;
    for (compat, wanted) in [
        ("none", [own, 3.0 * own, 3.0, own, 3.0 * own, 3.0]),
        ("lammps/2026", [own, 3.0 * own, 3.0, own, 3.0 * own, 0.0]),
        ("lammps/2025", [0.0; 6]),
    ] {
        let how = ["-compat", compat];
        let out = text(&run("finite_spheres.in", if compat == "none" { &[] } else { &how }));
        let found = numbers(&out, "SPHERE");
        // Some roundings of a product.
        let fits = |(a, b): (&f64, f64)| (a - b).abs() <= 1e-13 * own;
        assert!(found.len() == 6 && found.iter().zip(wanted).all(fits), "{compat}: {out}");
    }
}
