//! Files that are whole come back; all others are refused in one sentence.

use super::*;
use perigrain_world::{AtomStyle, Boundary, Domain, Key};
use proptest::prelude::*;
use std::path::PathBuf;

fn world(n: u32) -> World {
    let mut w = World { types: 2, type_mass: vec![None, Some(0.5)].into(), ..World::default() };
    w.particles.style = AtomStyle { chosen: true, sphere: true, peri: true, ..AtomStyle::default() };
    w.domain = Some(Domain::new([0.0; 3], [1.0; 3], Boundary::default())).into();
    for k in 1..=n {
        let a = f64::from(k);
        w.particles.push(k, 1 + (k % 2) as u16, [0.1 / a, a.sqrt() * 1e-3, -0.0]);
    }
    w.columns.scalar(Key::new("move/1"), n as usize)[0] = f64::MIN_POSITIVE;
    w.memo.insert(Key::new("dt/reset/2"), vec![1.0 / 3.0, f64::INFINITY]);
    w.clock.step = i64::MAX - 7;
    w
}

fn saved(folder: &tempfile::TempDir, w: &World) -> PathBuf {
    let path = folder.path().join("a.restart");
    let declared = ["fix 1 all nve".to_string()];
    write(&path, &Saving { world: w, ran: true, standing: false, pair: &[], declared: &declared }).unwrap();
    path
}

#[test]
fn everything_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let w = world(5);
    let back = read(&saved(&folder, &w)).unwrap();
    assert!(back.ran && !back.standing);
    assert_eq!(back.declared, ["fix 1 all nve"]);
    let bits = |w: &World| w.particles.x.iter().flatten().map(|a| a.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&back.world), bits(&w));
    assert_eq!((&*back.world.memo, back.world.clock.step), (&*w.memo, w.clock.step));
    // A density that was never set is NaN, and that comes back too.
    assert!(back.world.particles.density.iter().all(|d| d.is_nan()));
    let before = resume(&w, vec![]);
    assert_eq!(fingerprint(&back.world, &before), before.fingerprint);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_changed_scene_has_another_fingerprint() {
    let w = world(5);
    let before = resume(&w, vec![]);
    let differs = |change: fn(&mut World)| {
        let mut other = w.clone();
        change(&mut other);
        fingerprint(&other, &before) != before.fingerprint
    };
    assert!(differs(|w| w.particles.x[3][1] += 1e-18));
    assert!(differs(|w| w.clock.dt *= 0.5));
    assert!(differs(|w| w.settings.neighbor.skin = 0.1));
    assert!(differs(|w| w.memo.clear()));
    // What the deck adds does not count.
    assert!(!differs(|w| {
        let bit = w.groups.find_or_add("new").unwrap().bit();
        w.particles.mask[0] |= bit;
    }));
    assert!(!differs(|w| w.columns.scalar(Key::new("displace/2"), 5)[1] = 2.0));
}

#[test]
fn foreign_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = saved(&folder, &world(3));
    let whole = std::fs::read(&path).unwrap();
    let refusal = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        read(&path).unwrap_err().0.remove(0).message
    };
    // The first bytes of what LAMMPS 22Jul2025 writes.
    assert!(refusal(b"LammpS RestartT\0\x01\0\0\0\x03\0\0\0").contains("is one of LAMMPS"));
    assert!(refusal(b"ITEM: TIMESTEP\n0\n").contains("is none of perigrain"));
    assert!(refusal(b"").contains("is none of perigrain"));
    let mut newer = whole.clone();
    newer[8] = 9;
    assert!(refusal(&newer).contains("is of format 9; this perigrain reads formats up to 1"));
    let mut other = whole.clone();
    other[12] ^= 1;
    let end = other.len() - TAIL as usize;
    let crc = crc32fast::hash(&other[..end + 8]).to_le_bytes();
    other[end + 8..end + 12].copy_from_slice(&crc);
    assert!(refusal(&other).contains("stored otherwise than by this one"));
    for cut in [3, 9, 15, 40, whole.len() - 1] {
        assert!(refusal(&whole[..cut]).contains("is cut off"), "{cut}");
    }
    let mut more = whole.clone();
    more.push(0);
    assert!(refusal(&more).contains("is cut off"));
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 0x10;
    assert!(refusal(&flipped).contains("its checksum is wrong"));
    std::fs::remove_file(&path).unwrap();
    assert!(read(&path).unwrap_err().0[0].message.contains("cannot read the restart file"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Arbitrary bytes, and a whole file cut anywhere or with any bits flipped: refused, never a panic.
    #[test]
    fn no_file_makes_it_panic(
        bytes in proptest::collection::vec(any::<u8>(), 0..200), cut in any::<prop::sample::Index>(),
        at in any::<prop::sample::Index>(), bit in 0u8..8, resealed in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = saved(&folder, &world(4));
        let whole = std::fs::read(&path).unwrap();
        for bytes in [bytes.clone(), [&MAGIC[..], &bytes].concat(), whole[..cut.index(whole.len())].to_vec()] {
            std::fs::write(&path, bytes).unwrap();
            prop_assert!(read(&path).is_err());
        }
        let mut flipped = whole.clone();
        flipped[at.index(whole.len())] ^= 1 << bit;
        if resealed {
            // A forger's file: the checksum fits. It may be read or refused.
            let end = flipped.len() - TAIL as usize;
            let crc = crc32fast::hash(&flipped[..end + 8]).to_le_bytes();
            flipped[end + 8..end + 12].copy_from_slice(&crc);
        }
        std::fs::write(&path, flipped).unwrap();
        let outcome = read(&path);
        prop_assert!(resealed || outcome.is_err());
    }
}
