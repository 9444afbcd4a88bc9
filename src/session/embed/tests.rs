//! Requests of a host to a session, on two spheres and a chain.

use super::columns::{packed, unpacked};
use super::{Column, Global, Newcomers, Order, Rows, VariableValue};
use crate::session::{Options, Session};

const SPHERES: &str = "units si\natom_style sphere\nboundary p p f\nregion b block 0 1 0 1 0 1\ncreate_box 2 b\n\
                       create_atoms 1 single 0.3 0.3 0.3\ncreate_atoms 2 single 0.7 0.7 0.7\n\
                       set group all diameter 0.1\nset group all density 1000\n\
                       compute k all ke\ncompute pa all property/atom x y z\ncompute t all temp\n\
                       variable e equal step*2\nvariable a atom x*2\nvariable s string hello\n\
                       variable v vector [1,2,3]\nvariable int internal 3\nvelocity all set 1 0 0\n";

fn spheres() -> Session {
    let mut s = Session::new(Options::default()).unwrap();
    s.eval("deck", SPHERES).unwrap();
    s
}

#[test]
fn values_are_returned_by_kind() {
    let mut s = spheres();
    assert_eq!(s.variable("e").unwrap(), Some(VariableValue::Number(0.0)));
    assert_eq!(s.variable("a").unwrap(), Some(VariableValue::Particles(vec![0.6, 1.4])));
    assert_eq!(s.variable("s").unwrap(), Some(VariableValue::Text("hello".into())));
    assert_eq!(s.variable("v").unwrap(), Some(VariableValue::Vector(vec![1.0, 2.0, 3.0])));
    assert_eq!(s.variable("nosuch").unwrap(), None);
    s.set_number("int", 4.5).unwrap();
    s.set_text("s", "other").unwrap();
    assert_eq!(s.variable("int").unwrap(), Some(VariableValue::Number(4.5)));
    assert_eq!(s.expand("${s} $(2*v_int:%.6g)").unwrap(), "other 9");
    for (name, known) in [("e", "equal"), ("nosuch", "no variable")] {
        assert!(s.set_number(name, 1.0).unwrap_err().to_string().contains(known), "{name}");
    }
    assert_eq!(s.number("atoms + step").unwrap(), 2.0);
    let texts = s.sources.texts().count();
    s.number("atoms + step").unwrap();
    assert_eq!(s.sources.texts().count(), texts, "the same words are kept once");
}

#[test]
fn computes_and_fixes_give_all_they_have() {
    let mut s = spheres();
    // two spheres of 1000 kg/m³ and diameter 0.1 m at 1 m/s: 2 · ½ · 0.5236 kg
    let ke = s.compute_values("k").unwrap();
    assert!((ke.scalar - std::f64::consts::PI / 6.0).abs() < 1e-12 && ke.offers.scalar && !ke.offers.atom);
    let places = s.compute_values("pa").unwrap();
    assert_eq!((places.cols, places.atom.as_slice()), (3, [0.3, 0.3, 0.3, 0.7, 0.7, 0.7].as_slice()));
    assert!(s.compute_values("kk").unwrap_err().0[0].help[0].contains("`k`"));
    assert!(s.fix_values("nosuch").is_err());
    assert!(s.ids("compute").unwrap().contains(&"thermo_press".to_string()));
    assert!(s.ids("nosuch").is_none() && Session::styles("region").unwrap().contains(&"block"));
}

#[test]
fn columns_have_lammps_names_and_what_cannot_be_is_refused() {
    let mut s = spheres();
    assert!(matches!(s.column("x"), Some(Column::Threes(x)) if x[1] == [0.7; 3]));
    assert!(matches!(s.column("radius"), Some(Column::Ones(r)) if r[0] == 0.05));
    assert!(s.column("x0").is_none() && s.column("nosuch").is_none());
    assert_eq!(s.whole_column("type").unwrap(), [1, 2]);
    s.set_whole_column("type", &[2, 2]).unwrap();
    assert_eq!(s.whole_column("type").unwrap(), [2, 2]);
    for (name, values) in
        [("type", vec![0, 1]), ("type", vec![1]), ("id", vec![2, 1]), ("mask", vec![3, 1]), ("x", vec![1, 1])]
    {
        assert!(s.set_whole_column(name, &values).is_err(), "{name} {values:?}");
    }
    s.set_whole_column("id", &[1, 2]).unwrap();
    // LAMMPS' own number for one period along x and minus one along z
    assert_eq!((packed([1, 0, -1]), unpacked(536347137)), (536347137, [1, 0, -1]));
}

#[test]
fn numbers_are_gathered_by_id_and_put_back() {
    let mut s = spheres();
    let (x, width) = s.gathered("x", false, &Order::Ids).unwrap();
    assert_eq!((x, width), (Rows::Reals(vec![0.3, 0.3, 0.3, 0.7, 0.7, 0.7]), 3));
    assert_eq!(s.gathered("type", false, &Order::Chosen(vec![2])).unwrap().0, Rows::Wholes(vec![2]));
    assert_eq!(s.gathered("image", true, &Order::Places).unwrap().1, 3);
    assert_eq!(s.gathered("c_pa", false, &Order::Chosen(vec![2, 1])).unwrap().1, 3);
    s.scatter("v", &Order::Chosen(vec![2]), &Rows::Reals(vec![0.0, 3.0, 0.0])).unwrap();
    // ½ · 0.5236 kg · (1 + 9) (m/s)²
    assert!((s.number("c_k").unwrap() - 10.0 * std::f64::consts::PI / 12.0).abs() < 1e-12);
    let ids = Order::Ids;
    for (name, rows) in [
        ("x", Rows::Reals(vec![0.1; 5])),
        ("x", Rows::Reals(vec![f64::NAN; 6])),
        ("x", Rows::Wholes(vec![1; 6])),
        ("type", Rows::Reals(vec![1.0; 2])),
        ("nosuch", Rows::Reals(vec![1.0; 2])),
        ("type", Rows::Wholes(vec![1, 3])),
    ] {
        assert!(s.scatter(name, &ids, &rows).is_err(), "{name} {rows:?}");
    }
    assert!(s.gathered("x", false, &Order::Chosen(vec![3])).is_err());
    s.eval("deck", "group a id 1\ndelete_atoms group a compress no\n").unwrap();
    let e = s.gathered("x", false, &Order::Ids).unwrap_err();
    assert!(e.0[0].help[0].contains("reset_atoms"), "{e}");
}

#[test]
fn particles_are_made_in_the_box_alone() {
    let mut s = spheres();
    let before = s.roster();
    let new = Newcomers {
        kinds: vec![1, 2, 1],
        x: vec![[0.1; 3], [0.5, 0.5, 1.5], [1.25, 0.5, 0.5]],
        v: Some(vec![[1.0, 2.0, 3.0]; 3]),
        ..Newcomers::default()
    };
    // the second is beyond a fixed face, the third comes in by a periodic one
    assert_eq!(s.make_particles(&new).unwrap(), 2);
    assert_eq!(s.gathered("id", false, &Order::Places).unwrap().0, Rows::Wholes(vec![1, 2, 3, 5]));
    assert!(matches!(s.column("x"), Some(Column::Threes(x)) if x[3] == [0.25, 0.5, 0.5]));
    assert_ne!(s.roster(), before);
    for wrong in [
        Newcomers { kinds: vec![3, 1, 1], ..new.clone() },
        Newcomers { kinds: vec![1], ..new.clone() },
        Newcomers { ids: Some(vec![1, 7, 8]), ..new.clone() },
        Newcomers { ids: Some(vec![7, 7, 8]), ..new.clone() },
        Newcomers { ids: Some(vec![0, 7, 8]), ..new.clone() },
        Newcomers { x: vec![[f64::INFINITY; 3]; 3], ..new.clone() },
    ] {
        assert!(s.make_particles(&wrong).is_err(), "{wrong:?}");
    }
    assert_eq!(s.global("natoms"), Some(Global::Large(4)));
    assert!(s.reset_box([0.0; 3], [2.0; 3], [0.0; 3]).is_err());
}

#[test]
fn an_empty_box_can_be_set_anew() {
    let mut s = Session::new(Options::default()).unwrap();
    assert!(
        s.make_particles(&Newcomers::default()).is_err()
            && s.reset_box([0.0; 3], [1.0; 3], [0.0; 3]).is_err()
    );
    assert_eq!((s.global("boxlo"), s.global("nosuch")), (None, None));
    s.eval("deck", "region b block 0 1 0 1 0 1\ncreate_box 1 b\n").unwrap();
    s.reset_box([0.0; 3], [2.0, 3.0, 4.0], [0.0; 3]).unwrap();
    assert!(s.reset_box([0.0; 3], [2.0, 0.0, 4.0], [0.0; 3]).is_err());
    assert_eq!(s.global("boxhi"), Some(Global::Reals(vec![2.0, 3.0, 4.0])));
    assert_eq!(s.global("boxzhi"), Some(Global::Real(4.0)));
    assert_eq!(s.global("units"), Some(Global::Text("lj".into())));
}

#[test]
fn a_file_in_between_may_jump_and_names_files_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let deck = folder.path().join("in.loop");
    std::fs::write(&deck, "label a\nvariable i loop 3\nnext i\njump SELF a\ninclude in.beside\n").unwrap();
    std::fs::write(folder.path().join("in.beside"), "variable found string yes\n").unwrap();
    let mut s = Session::new(Options::default()).unwrap();
    s.eval_file(&deck).unwrap();
    assert_eq!(s.variable("found").unwrap(), Some(VariableValue::Text("yes".into())));
    assert!(s.eval_file(&folder.path().join("nosuch")).is_err());
    assert!(s.eval("typed", "include in.beside\n").is_err(), "the folder was the file's alone");
}
