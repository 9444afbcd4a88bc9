//! Data sheets become laws, or say what is wrong.

use super::*;
use crate::Flow;
use crate::sheet::{Curve, Fault, Key, Quantity, Sheet, Strain};

const ELASTIC: Elastic = Elastic { bulk: 2.0, shear: 1.0 };

/// A sheet with these numbers.
fn sheet(hardening: Option<Curve>, numbers: &[(Key, f64)]) -> Sheet {
    let mut sheet = Sheet { hardening, ..Sheet::default() };
    numbers.iter().for_each(|(key, value)| sheet.set(*key, *value));
    sheet
}

/// The key of a fault, and whether it is missing.
fn fault(sheet: &Sheet) -> (&'static str, bool) {
    match sheet.material(ELASTIC, None).unwrap_err() {
        Fault::Missing { key, .. } => (key, true),
        Fault::Refused { key, .. } => (key, false),
    }
}

#[test]
fn an_empty_sheet_is_elastic() {
    for (strain, law) in
        [(None, Law::Hencky), (Some(Strain::Linear), Law::Linear), (Some(Strain::NeoHooke), Law::NeoHooke)]
    {
        let sheet = Sheet { elastic: strain, ..Sheet::default() };
        assert_eq!(sheet.material(ELASTIC, None), Ok(Material { elastic: ELASTIC, law }));
        assert_eq!(sheet.given().is_empty(), strain.is_none());
    }
}

#[test]
fn numbers_become_laws() {
    use Key::*;
    let law = |sheet: &Sheet| sheet.material(ELASTIC, None).unwrap().law;
    let perfect = law(&sheet(None, &[(Yield, 2.0)]));
    assert_eq!(perfect, flowing(Hardening::Linear { yields: 2.0, modulus: 0.0 }));
    let voce = law(&sheet(Some(Curve::Voce), &[(Yield, 2.0), (SigmaInf, 3.0), (SmallB, 4.0), (H, 5.0)]));
    assert_eq!(voce, flowing(Hardening::Voce { yields: 2.0, saturation: 3.0, exponent: 4.0, modulus: 5.0 }));
    let swift = law(&sheet(Some(Curve::Swift), &[(Yield, 2.0), (Eps0, 0.1), (N, 0.2)]));
    assert_eq!(swift, flowing(Hardening::Swift { yields: 2.0, strain: 0.1, exponent: 0.2 }));
    let cone = law(&sheet(None, &[(Cohesion, 2.0), (Phi, 30.0), (Psi, 10.0), (H, 3.0)]));
    let expected = crate::DruckerPrager::from_angles(2.0, 3.0, 30.0, 10.0);
    assert_eq!(cone, Law::Plastic { flow: Flow::DruckerPrager(expected), damage: None });
    let torn = law(&sheet(None, &[(Yield, 2.0), (EpsF, 0.3), (Gf, 7.0)]));
    let damage = crate::Damage { onset: crate::Onset::Strain(0.3), energy: 7.0 };
    assert!(matches!(torn, Law::Plastic { damage: Some(found), .. } if found == damage));
}

#[test]
fn a_tensile_strength_begins_damage_where_nothing_else_does() {
    let law = |numbers: &[(Key, f64)]| sheet(None, numbers).material(ELASTIC, Some(3.0)).unwrap().law;
    assert_eq!(law(&[(Key::Gf, 7.0)]), Law::Brittle(crate::Brittle { strength: 3.0, energy: 7.0 }));
    let onset = |law| match law {
        Law::Plastic { damage, .. } => damage.map(|damage| damage.onset),
        _ => None,
    };
    assert_eq!(onset(law(&[(Key::Yield, 2.0), (Key::Gf, 7.0)])), Some(crate::Onset::Stress(3.0)));
    let strain = [(Key::Yield, 2.0), (Key::Gf, 7.0), (Key::EpsF, 0.1)];
    assert_eq!(onset(law(&strain)), Some(crate::Onset::Strain(0.1)));
    // Without Gf it is the strength of bonds.
    assert_eq!((law(&[]), onset(law(&[(Key::Yield, 2.0)]))), (Law::Hencky, None));
}

/// Numbers of Johnson and Cook, fracture included.
fn copper() -> Sheet {
    use Key::*;
    let strength = [(Yield, 90.0), (B, 292.0), (N, 0.31), (C, 0.025), (M, 1.09)];
    let reference = [(Rate0, 1.0), (Tr, 298.0), (Tm, 1356.0)];
    let fracture = [(D1, 0.54), (D2, 4.89), (D3, -3.03), (D4, 0.014), (D5, 1.12), (Gf, 20.0)];
    sheet(Some(Curve::JohnsonCook), &[&strength[..], &reference, &fracture].concat())
}

#[test]
fn each_number_that_a_law_needs_is_missed_by_its_key() {
    let whole = copper();
    assert!(whole.material(ELASTIC, None).is_ok());
    for key in Key::ALL.into_iter().filter(|key| whole.get(*key).is_some()) {
        let numbers = Key::ALL.into_iter().filter(|k| *k != key);
        let numbers: Vec<_> = numbers.filter_map(|k| Some((k, whole.get(k)?))).collect();
        assert_eq!(fault(&sheet(whole.hardening, &numbers)), (key.name(), true));
    }
    assert_eq!(fault(&sheet(Some(Curve::Table), &[])), ("table", true));
    assert_eq!(fault(&sheet(Some(Curve::Linear), &[(Key::Yield, 1.0)])), ("H", true));
    assert_eq!(fault(&sheet(None, &[(Key::Cohesion, 1.0)])), ("phi", true));
    assert_eq!(fault(&sheet(None, &[(Key::Gf, 1.0)])), ("ft", true));
    assert_eq!(fault(&sheet(None, &[(Key::Yield, 1.0), (Key::Gf, 1.0)])), ("ft", true));
}

#[test]
fn numbers_without_a_use_or_out_of_range_are_refused() {
    use Key::*;
    let refused = |hardening, numbers: &[(Key, f64)]| {
        let (key, missing) = fault(&sheet(hardening, numbers));
        assert!(!missing);
        key
    };
    assert_eq!(refused(None, &[(H, 1.0)]), "H");
    assert_eq!(refused(None, &[(EpsF, 1.0)]), "eps_f");
    assert_eq!(refused(None, &[(Yield, 1.0), (H, 1.0)]), "H");
    assert_eq!(refused(Some(Curve::Linear), &[(Yield, 1.0), (H, 1.0), (SmallB, 1.0)]), "b");
    assert_eq!(refused(None, &[(Yield, 1.0), (Cohesion, 1.0)]), "yield");
    assert_eq!(refused(Some(Curve::Voce), &[(Cohesion, 1.0)]), "hardening");
    assert_eq!(refused(None, &[(Yield, -1.0)]), "yield");
    assert_eq!(refused(None, &[(Cohesion, 1.0), (Phi, 90.0)]), "phi");
    assert_eq!(refused(None, &[(Cohesion, 1.0), (Phi, 20.0), (Psi, 30.0)]), "psi");
    assert_eq!(refused(Some(Curve::Voce), &[(Yield, 2.0), (SigmaInf, 1.0), (SmallB, 1.0)]), "sigma_inf");
    let mut cold = copper();
    cold.set(Tm, 100.0);
    assert_eq!(fault(&cold), ("Tm", false));
    assert_eq!(cold.given()[..3], ["hardening", "yield", "n"]);
    let both = Sheet { elastic: Some(Strain::Linear), ..sheet(None, &[(Yield, 1.0)]) };
    assert_eq!(fault(&both), ("elastic", false));
    for table in [vec![[0.1, 1.0]], vec![[0.0, 1.0], [0.0, 2.0]], vec![[0.0, -1.0]], vec![[0.0, f64::NAN]]] {
        assert_eq!(fault(&Sheet { table, ..sheet(Some(Curve::Table), &[]) }), ("table", false));
    }
    let idle = Sheet { table: vec![[0.0, 1.0]], ..sheet(None, &[(Yield, 1.0)]) };
    assert_eq!(fault(&idle), ("table", false));
}

#[test]
fn units_are_converted_by_quantity() {
    let mut sheet = copper();
    sheet.table = vec![[0.0, 90.0]];
    sheet.convert(|quantity| match quantity {
        Quantity::Pressure => 10.0,
        Quantity::EnergyPerArea => 1e3,
        Quantity::Rate => 1e-6,
        Quantity::Temperature | Quantity::Angle | Quantity::Number => 1.0,
    });
    let get = |key| sheet.get(key).unwrap();
    assert_eq!([get(Key::Yield), get(Key::Gf), get(Key::Rate0), get(Key::Tm)], [900.0, 2e4, 1e-6, 1356.0]);
    assert_eq!((get(Key::D3), sheet.table[0]), (-3.03, [0.0, 900.0]));
}
