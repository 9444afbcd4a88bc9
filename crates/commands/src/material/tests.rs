//! `material`: values of lines and files, and mistakes in them.

use super::*;
use perigrain_base::units::UnitSystem;
use perigrain_constitutive::Law;
use perigrain_constitutive::sheet::Key;
use perigrain_lang::Command;
use perigrain_styles::{Names, Shape, UseKind};
use perigrain_world::World;
use std::cell::RefCell;

struct Nothing;

impl Names for Nothing {
    fn compute(&self, _: &str) -> Option<Shape> {
        None
    }
    fn fix(&self, _: &str) -> Option<Shape> {
        None
    }
    fn variable_shape(&self, _: &str) -> Option<perigrain_styles::Shape> {
        None
    }
    fn all(&self, _: UseKind) -> Vec<String> {
        vec![]
    }
}

/// Reads `material` with these words in this world.
fn parse(world: &World, line: &str) -> Result<Material> {
    let mut at = 0;
    let mut words = line.split(' ').map(|w| {
        at += w.len() + 1;
        Word::new(w, Span::new(FileId(0), at - 1 - w.len(), at - 1))
    });
    let name = words.next().unwrap();
    let span = Span::new(FileId(0), 0, line.len());
    let command = Command { name, args: words.collect(), span, text: line.to_owned() };
    let (notes, uses) = (RefCell::default(), RefCell::default());
    let cx = BuildCx {
        world,
        names: &Nothing,
        id: "",
        group: perigrain_world::GroupId(0),
        span,
        checking: false,
        notes: &notes,
        uses: &uses,
    };
    let mut args = Args::new(&command);
    args.next();
    super::read("m", &mut args, &cx)
}

fn si() -> World {
    let mut w = World::default();
    w.settings.units = UnitSystem::Si;
    w
}

#[test]
fn numbers_in_the_line() {
    let m = parse(&si(), "material m E 7e10 nu 0.25 rho 2500 Gc 8 alpha 0.25").unwrap();
    assert_eq!((m.young, m.nu, m.density, m.alpha), (7e10, 0.25, 2500.0, 0.25));
    assert_eq!(m.strength, Some(Strength::FractureEnergy(8.0)));
}

#[test]
fn heat_in_the_line() {
    let line =
        "material m E 1 nu 0.25 rho 1 conductivity 401 heat_capacity 385 expansion 1.7e-5 stress_free 293";
    let heat = Thermal {
        conductivity: 401.0,
        heat_capacity: 385.0,
        expansion: 1.7e-5,
        stress_free: 293.0,
        ..Thermal::default()
    };
    assert_eq!(parse(&si(), line).unwrap().thermal, heat);
    assert!(parse(&si(), "material m E 1 nu 0.25 rho 1 conductivity -1").is_err());
}

#[test]
fn values_replace_those_of_the_file() {
    let m = parse(&si(), "material m file brittle-plate.toml Gc 50").unwrap();
    assert_eq!((m.young, m.strength), (22.35e9, Some(Strength::FractureEnergy(50.0))));
    let m = parse(&si(), "material m file brittle-plate.toml s00 0.001").unwrap();
    assert_eq!(m.strength, Some(Strength::Stretch(0.001)));
}

#[test]
fn files_speak_the_units_of_the_deck() {
    let mut w = si();
    w.settings.units = UnitSystem::Cgs;
    let m = parse(&w, "material m file steel.toml").unwrap();
    // 206 GPa = 2.06e12 dyn/cm², 7833 kg/m³ = 7.833 g/cm³.
    assert!((m.young / 2.06e12 - 1.0).abs() < 1e-14 && (m.density / 7.833 - 1.0).abs() < 1e-14);
    w.settings.units = UnitSystem::Lj;
    assert!(parse(&w, "material m file steel.toml").is_err());
}

#[test]
fn mistakes_are_underlined() {
    let wrong = |line: &str| {
        let d = parse(&si(), line).unwrap_err().0.remove(0);
        let s = d.span.unwrap();
        (line[s.start as usize..s.end as usize].to_owned(), d.code)
    };
    let full = "material m E 1 nu 0.25 rho 1";
    assert_eq!(wrong("material m E 1 nu 0.25 roh 1"), ("roh".into(), Code::UNKNOWN_KEYWORD));
    assert_eq!(wrong("material m E 1 nu 0.7 rho 1"), ("0.7".into(), Code::BAD_VALUE));
    assert_eq!(wrong("material m E 1 nu 0.2").1, Code::MISSING_ARGUMENT);
    assert_eq!(wrong(&format!("{full} Gc 1 s00 1")), ("s00".into(), Code::CONFLICT));
    assert_eq!(wrong(&format!("{full} E 2")), ("E".into(), Code::CONFLICT));
    assert_eq!(wrong(&format!("{full} syc -1")), ("syc".into(), Code::NOT_SUPPORTED));
    assert_eq!(wrong("material m file stel.toml"), ("stel.toml".into(), Code::NO_FILE));
}

#[test]
fn flow_in_the_line_and_over_a_file() {
    let full = "material m E 117e9 nu 0.35 rho 8930";
    let m = parse(&si(), &format!("{full} yield 400e6 hardening linear H 100e6 eps_f 0.3 Gf 2e4")).unwrap();
    assert!(matches!(m.constitutive().unwrap().law, Law::Plastic { damage: Some(_), .. }));
    let m = parse(&si(), &format!("{full} elastic neohooke")).unwrap();
    assert_eq!(m.constitutive().unwrap().law, Law::NeoHooke);
    let m = parse(&si(), "material m file ofhc-copper.toml yield 120e6").unwrap();
    assert_eq!((m.sheet.get(Key::Yield), m.sheet.get(Key::B)), (Some(120e6), Some(292e6)));
}

#[test]
fn mistakes_of_flow_name_the_key_the_law_and_an_example() {
    let wrong = |line: &str| {
        let d = parse(&si(), line).unwrap_err().0.remove(0);
        let s = d.span.unwrap();
        (line[s.start as usize..s.end as usize].to_owned(), d.code, d.message, d.help.join(" "))
    };
    let full = "material m E 117e9 nu 0.35 rho 8930";
    let line = format!("{full} yield 400e6 hardening linear");
    let (place, code, message, help) = wrong(&line);
    assert_eq!((place, code), (line.clone(), Code::MISSING_ARGUMENT));
    assert_eq!(message, "material `m` has no H, which hardening linear needs");
    assert!(help.contains("`H = \"100 MPa\"`"), "{help}");
    let line = "material m file steel.toml yield 400e6 hardening voce";
    let (place, _, message, help) = wrong(line);
    assert_eq!(place, "steel.toml");
    assert_eq!(message, "material `m` (steel.toml) has no sigma_inf, which hardening voce needs");
    assert!(help.contains("in steel.toml"), "{help}");
    let (place, code, message, _) = wrong(&format!("{full} yield 400e6 H 1e8"));
    assert_eq!((place.as_str(), code), ("1e8", Code::BAD_VALUE));
    assert!(message.contains("does not use `H`"), "{message}");
    assert_eq!(wrong(&format!("{full} yield 1 yield 2")).1, Code::CONFLICT);
    assert_eq!(wrong(&format!("{full} yield -1")).0, "-1");
    assert_eq!(wrong(&format!("{full} hardening vice")).0, "vice");
    assert_eq!(wrong(&format!("{full} yield 1 elastic linear")).0, "elastic");
}

#[test]
fn a_wrong_file_is_reported_by_its_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("mine.toml"), "name = 'x'\nsource = 'y'\nG_c = 3\n").unwrap();
    let mut w = si();
    w.folder = folder.path().to_owned();
    let d = parse(&w, "material m file mine.toml").unwrap_err().0.remove(0);
    assert!(d.message.contains("mine.toml:3: "), "{}", d.message);
}
