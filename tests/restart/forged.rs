//! Restart files with a right checksum and wrong contents: refused by name, or continued; never a panic.

use super::{run, scenes::*};
use crate::fuzz_loop::bodies::forged::Case;
use crate::random::Random;
use perigrain::output::restart::{Saving, read, write};
use perigrain::world::World;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

/// A change of a scene, and the message about it.
type Forgery = (fn(&mut World), &'static str, &'static str);

/// Writes a file in the middle of a scene and forges it in all these ways.
fn forge(name: &str, forgeries: &[Forgery]) {
    let s = SCENES.iter().find(|s| s.name == name).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.restart");
    let deck = format!("{}{}run {}\nwrite_restart DIR/a.restart", s.make, s.again, s.steps / 2);
    run(folder.path(), &deck, s.list);
    let saved = read(&path).unwrap();
    for (k, (change, section, what)) in forgeries.iter().enumerate() {
        let mut world = saved.world.clone();
        change(&mut world);
        let (pair, declared) = (&saved.pair, &saved.declared);
        write(&path, &Saving { world: &world, ran: true, standing: true, pair, declared }).unwrap();
        let printed = match read(&path) {
            Ok(_) => panic!("{name}, forgery {k}: {section} {what} is believed"),
            Err(printed) => printed.0[0].message.clone(),
        };
        let expected = format!("a.restart` contradicts itself in its section `{section}`: ");
        assert!(printed.contains(&expected) && printed.contains(what), "{name}, forgery {k}: {printed}");
    }
}

macro_rules! families {
    (|$f:ident| $change:expr) => {
        |w| {
            let $f = w.families.as_mut().unwrap();
            $change;
        }
    };
}

macro_rules! body {
    (|$b:ident| $change:expr) => {
        |w| {
            let $b = &mut w.families.as_mut().unwrap().lattices[0];
            $change;
        }
    };
}

macro_rules! list {
    (|$l:ident| $change:expr) => {
        |w| {
            let $l = &mut w.families.as_mut().unwrap().list;
            $change;
        }
    };
}

#[test]
fn lattices_lead_where_there_is_something() {
    let s = "families";
    forge(
        "lattice",
        &[
            (
                body!(|b| b.stencil[3] = [1000, 0, 2000]),
                s,
                "body 1 of lattices: a vector of its stencil leads too far",
            ),
            (body!(|b| b.stencil[3][0] -= 1), s, "stencil is not that of its lattice"),
            (body!(|b| b.reach = [-1; 3]), s, "reaches backwards"),
            (body!(|b| b.reach[2] += 1), s, "the number of its rows"),
            (body!(|b| b.steps[0].1 = 77), s, "the row steps"),
            (body!(|b| b.step_of[2] = 999), s, "the row steps"),
            (body!(|b| b.stride += 8), s, "the stride of its displacements"),
            (body!(|b| b.stride = usize::MAX), s, "the stride of its displacements"),
            (body!(|b| b.u[0].truncate(9)), s, "former displacements is 9"),
            (body!(|b| b.width = usize::MAX), s, "the number of its rows"),
            (body!(|b| b.planes = 0), s, "it has no rows"),
            (
                body!(|b| b.rows.iter_mut().filter(|r| r.len > 0).for_each(|r| r.lo += r.start as i32)),
                s,
                "is not where",
            ),
            (
                body!(|b| b.rows.iter_mut().for_each(|r| r.start += 8)),
                s,
                "the first cell of a row is 8, not 0",
            ),
            (body!(|b| b.rows[0].len = 8), s, "in its margin"),
            (body!(|b| b.particle[0] = 1_000_000), s, "none of the scene"),
            (body!(|b| b.particle.swap(0, 1)), s, "is not where"),
            (body!(|b| b.alive.fill(0xff)), s, "a living bond leads to no particle"),
            (body!(|b| b.alive.push(0)), s, "bits of bonds"),
            (body!(|b| b.intact.fill(true)), s, "said to be intact"),
            (body!(|b| b.tables.truncate(16)), s, "constants is 16"),
            (body!(|b| b.kinds.clear()), s, "the number of its constants"),
            (body!(|b| b.kinds[0] = 7), s, "none of the scene"),
            (body!(|b| b.broken.push((0, 9999))), s, "a bond that broke was none"),
            (body!(|b| b.first_place = 3), s, "the first place of a body is 3, not 0"),
            (body!(|b| b.basis[0] = b.basis[1]), s, "its lattice is none"),
            (body!(|b| b.spacing = f64::NAN), s, "is no length"),
            (body!(|b| b.state.memory.push(1.0)), s, "bonds remember is 1, not 0"),
            (families!(|f| f.place.swap(0, 1)), s, "not at its place"),
            (families!(|f| f.near.loose.push((4_000_000, [0.0; 3]))), s, "a loose particle"),
            (families!(|f| f.family_size.clear()), s, "the number of sizes"),
            (families!(|f| f.lasting.push(true)), s, "lasting particles"),
        ],
    );
    forge(
        "eps",
        &[
            (body!(|b| b.state.memory.truncate(1)), s, "bonds remember"),
            (body!(|b| b.state.touched.clear()), s, "touched chunks"),
            (body!(|b| b.state.awake.truncate(1)), s, "ever woke"),
            (body!(|b| b.state.theta.clear()), s, "dilatations is 0"),
            (body!(|b| b.state.theta[40] = f64::NAN), s, "one of the dilatations is no number"),
            (
                body!(|b| b.state.memory[3] = f64::NAN),
                s,
                "one of the numbers that bonds remember is no number",
            ),
            (body!(|b| b.u[1][30] = f64::NAN), s, "one of the displacements is no number"),
            (families!(|f| f.family_volume[1] = f64::NAN), s, "one of the volumes of families is no number"),
        ],
    );
}

#[test]
fn listed_bonds_lead_where_there_is_something() {
    let s = "families";
    forge(
        "list",
        &[
            (list!(|l| l.partner[1] = 1_000_000), s, "list of bonds: a bond leads to no record"),
            (list!(|l| l.partner[1] = 0), s, "list of bonds: a living bond leads to no particle"),
            (list!(|l| l.start[1] = 0), s, "the owner of a group"),
            (list!(|l| l.start.reverse()), s, "first groups are out of order"),
            (list!(|l| l.slab.push(1)), s, "moving slabs"),
            (list!(|l| l.slab[1] = u32::MAX), s, "slabs are out of order"),
            (
                list!(|l| l.partner[8 * l.owner.iter().position(|i| *i > 2).unwrap()] = 0),
                s,
                "a bond leads back",
            ),
            (list!(|l| l.kind[0] = 255), s, "the type of a record"),
            (list!(|l| l.group_kind[0] = 9), s, "the type of a group"),
            (list!(|l| l.owner[0] = 5), s, "the owner of a group"),
            (list!(|l| l.back[0] = u32::MAX), s, "a way back"),
            (list!(|l| l.back.truncate(3)), s, "first ways back are out of order"),
            (list!(|l| l.back_start.clear()), s, "first ways back"),
            (list!(|l| l.close.push((0.0, u32::MAX))), s, "first close bonds"),
            (list!(|l| l.broken.push(u32::MAX)), s, "a bond that broke was none"),
            (list!(|l| l.record[2].reference[0] += 1e-9), s, "is not where its particle was"),
            (list!(|l| l.pairs.clear()), s, "pairs of types"),
            (list!(|l| l.particle[0] = l.particle[1]), s, "its particle was"),
            (list!(|l| l.first_place = 1), s, "the first place of a body"),
        ],
    );
    forge("eps, list", &[(list!(|l| l.state.memory.truncate(1)), s, "bonds remember")]);
}

#[test]
fn particles_and_pairs_are_those_of_the_scene() {
    let contacts = "contacts";
    forge(
        "pile",
        &[
            (|w| w.contacts.values_mut().for_each(|c| c.width = usize::MAX), contacts, "differ in length"),
            (|w| w.contacts.values_mut().for_each(|c| c.keys.reverse()), contacts, "out of order"),
            (|w| w.contacts.values_mut().for_each(|c| c.keys[0] = [0, 0]), contacts, "touches itself"),
            (|w| w.contacts.values_mut().for_each(|c| c.history.truncate(1)), contacts, "differ in length"),
            (|w| w.particles.tag[1] = w.particles.tag[0], "particles", "two particles have one id"),
            (|w| w.particles.kind[1] = 0, "particles", "beyond the number of types"),
            (|w| w.particles.x[1][2] = f64::NAN, "particles", "is nowhere"),
            (|w| w.particles.v[1][2] = f64::NAN, "particles", "a velocity is no number"),
            (|w| w.particles.mass[0] = f64::NAN, "particles", "a mass is no number"),
            (|w| w.contacts.values_mut().for_each(|c| c.history[0] = f64::NAN), contacts, "is no number"),
            (|w| w.particles.omega.truncate(1), "particles", "angular velocities is"),
            (|w| w.particles.rank = vec![0; w.n()].into(), "particles", "ranks are no order"),
            (|w| w.particles.radius[0] = f64::INFINITY, "particles", "a radius is no length"),
            (|w| w.types = 60_000, "types", "differ in number"),
            (|w| w.clock.dt = f64::NAN, "clock", "no time"),
            (|w| w.clock.time_step = i64::MIN, "clock", "a step is negative"),
            (|w| w.settings.neighbor.skin = f64::NAN, "settings", "no length"),
            (|w| w.settings.neighbor.every = 0, "settings", "at no step"),
            (|w| w.domain.as_mut().unwrap().hi[1] = -9.0, "box", "not the lower ones"),
            (|w| w.domain.as_mut().unwrap().lo[1] = f64::NEG_INFINITY, "box", "is nowhere"),
            (|w| w.lattice.spacing[0] = 0.0, "lattice", "a length or direction"),
            (|w| w.rebuild.kept.turns.push([0; 3]), "neighbours", "differ in number"),
        ],
    );
    forge(
        "beams",
        &[
            (|w| w.bonds.list[0].kind = 3, "bonds", "beyond the number of types"),
            (|w| w.bonds.list[0].ends = [4, 4], "bonds", "to itself"),
            (|w| w.bonds.types = usize::MAX, "bonds", "more types"),
            (|w| w.bonds.special.reverse(), "bonds", "out of order"),
            (|w| w.particles.quat.truncate(1), "particles", "orientations"),
        ],
    );
}

/// A family of another style would be read by kernels that look for what it does not have.
#[test]
fn another_style_does_not_find_what_it_remembers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.restart");
    run(folder.path(), &format!("{BLOCK}{BLOCK_AGAIN}run 5\nwrite_restart DIR/a.restart"), false);
    let case = Case { file: std::fs::read(&path).unwrap(), again: EPS_AGAIN.into(), list: false };
    let printed = case.read_whole(&case.file, &path).unwrap();
    assert!(printed.contains("were made under another style"), "{printed}");
}

/// Particles may have joined since the last step: forces are computed anew then, regardless of the file.
#[test]
fn what_is_not_of_all_particles_does_not_stand() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.restart");
    run(folder.path(), &format!("{PILE}{PILE_AGAIN}run 20\nwrite_restart DIR/a.restart"), false);
    let mut saved = read(&path).unwrap();
    assert!(saved.standing);
    for some in [3, 0] {
        saved.world.rebuild.held.truncate(some);
        let (pair, declared) = (&saved.pair, &saved.declared);
        write(&path, &Saving { world: &saved.world, ran: true, standing: true, pair, declared }).unwrap();
        assert!(!read(&path).unwrap().standing);
    }
    let again = format!("read_restart DIR/a.restart\n{PILE_AGAIN}run 2");
    run(folder.path(), &again, false);
    // New particles have no family until the next run.
    let more = "create_atoms 1 single -0.002 0.002 0.002 units box\nvariable last equal atoms\n\
        set atom ${last} density 2400\nset atom ${last} volume 1e-9\n";
    let deck = format!("{BLOCK}{BLOCK_AGAIN}run 5\n{more}write_restart DIR/b");
    let n = run(folder.path(), &deck, false).0.n();
    assert_eq!(run(folder.path(), &format!("read_restart DIR/b\n{BLOCK_AGAIN}run 2"), false).0.n(), n);
}

/// Lists of a file are valid until they are rebuilt; an evaluation of contacts before that makes lists of its own.
#[test]
fn a_giant_in_a_file_is_refused_at_the_first_search_for_its_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.restart");
    run(folder.path(), &format!("{PILE}{PILE_AGAIN}run 20\nwrite_restart DIR/a.restart"), false);
    let mut saved = read(&path).unwrap();
    saved.world.particles.radius[7] = 1e200;
    let (pair, declared) = (&saved.pair, &saved.declared);
    write(&path, &Saving { world: &saved.world, ran: true, standing: true, pair, declared }).unwrap();
    let mut session = perigrain::session::Session::new(perigrain::session::Options::default()).unwrap();
    let deck = format!("read_restart {}\n{PILE_AGAIN}run 2", path.display());
    let printed = session.run_text("in", &deck).unwrap_err();
    assert!(printed.0[0].message.contains("do not go with the periodic box"), "{printed}");
    // In the setup, not at the next list.
    assert!(printed.0[0].help.iter().any(|h| h == "in op `contact watch` at step 20"), "{printed}");
}

/// Regions in regions in a file use up no stack.
#[test]
fn regions_are_no_deeper_than_the_limit_for_files() {
    let mut deck = "region r0 block 0 1 0 1 0 1\n".to_string();
    (1..100).for_each(|k| deck += &format!("region r{k} union 2 r0 r{}\n", k - 1));
    let folder = tempfile::tempdir().unwrap();
    let deck = format!(
        "{deck}create_box 1 r0\nwrite_restart DIR/a\nclear\nread_restart DIR/a\nregion more union 2 r0 r99"
    );
    let mut session = perigrain::session::Session::new(perigrain::session::Options::default()).unwrap();
    let printed = session.run_text("in", &deck.replace("DIR", folder.path().to_str().unwrap())).unwrap_err();
    assert!(printed.0[0].message.contains("nested more than 100 deep"), "{printed}");
}

/// So many forged files in the ordinary tests.
const FORGED: u64 = 500;

/// Files of all scenes with a few bytes changed and the checksum corrected: refused or continued. As many as above from a fixed
/// seed; with `PERIGRAIN_FUZZ_SECONDS` for that long, from `PERIGRAIN_FUZZ_SEED` on.
#[test]
fn bytes_changed_at_random_never_make_it_panic() {
    let number = |name: &str| std::env::var(name).ok().and_then(|s| s.parse::<u64>().ok());
    let (seconds, seed) = (number("PERIGRAIN_FUZZ_SECONDS"), number("PERIGRAIN_FUZZ_SEED").unwrap_or(4711));
    let cases: Vec<Case> =
        SCENES.iter().map(|s| Case::new(s.make, s.again, s.steps / 2 + 3, s.list)).collect();
    let folder = tempfile::tempdir().unwrap();
    let (begin, mut slowest, mut refused, mut failed) = (Instant::now(), (Duration::ZERO, 0), 0, vec![]);
    let mut count = 0;
    while seconds.map_or(count < FORGED, |s| begin.elapsed() < Duration::from_secs(s)) {
        let mut r = Random(seed.wrapping_add(count.wrapping_mul(0x2545_f491_4f6c_dd1d)));
        let which = (r.next() % cases.len() as u64) as usize;
        let recipe: Vec<u8> = (0..6 * (1 + r.next() % 2)).map(|_| r.next() as u8).collect();
        let start = Instant::now();
        match catch_unwind(AssertUnwindSafe(|| cases[which].read(&recipe, &folder.path().join("a")))) {
            Ok(why) => refused += u64::from(why.is_some()),
            Err(_) => {
                let name = SCENES[which].name;
                eprintln!("case {count} of seed {seed}, scene `{name}`, recipe {recipe:?}");
                keep(&cases[which], &recipe, seed, count);
                failed.push(count);
            }
        }
        if start.elapsed() > slowest.0 {
            slowest = (start.elapsed(), count);
        }
        count += 1;
    }
    println!("{count} forged files (seed {seed}), {refused} refused, the slowest {slowest:?}");
    assert!(failed.is_empty(), "cases {failed:?} of seed {seed} panic");
}

/// Writes a file that causes a panic into the folder `PERIGRAIN_FUZZ_KEEP`.
fn keep(case: &Case, recipe: &[u8], seed: u64, count: u64) {
    if let Ok(folder) = std::env::var("PERIGRAIN_FUZZ_KEEP") {
        let name = format!("{seed}.{count}.restart");
        let _ = std::fs::write(
            Path::new(&folder).join(name),
            crate::fuzz_loop::bodies::forged::forge(&case.file, recipe),
        );
    }
}
