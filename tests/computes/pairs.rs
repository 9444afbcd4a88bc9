//! What compute pair/local shows of a contact, as LIGGGHTS' compute pair/gran/local has it.

use crate::decks::run_with;

// LIGGGHTS-PUBLIC 3.8.0, `compute pair/gran/local` at step 0 with model hertz, tangential history: radii of 5 and 8 mm, 0.1 mm of overlap,
// 0.1 m/s towards each other and 0.2 m/s across, six printed digits. Its dashpot across is that of the spring, √(k_t/S_n) of the one along,
// which is 0.842424 for ν = 0.45: 2 √(G*/Y*) with G*/Y* = (1 − ν)/(2 (2 − ν)).
#[test]
fn columns_are_those_of_liggghts() {
    let ratio: f64 = 2.0 * (0.55 / (2.0 * 1.55_f64)).sqrt();
    let deck = format!(
        "units si\natom_style sphere\nboundary p f f\nregion reg block -0.1 0.1 -0.1 0.1 -0.1 0.1 units box\ncreate_box 1 reg\n\
         neighbor 0.002 bin\ntimestep 1e-5\npair_style granular\n\
         pair_coeff * * hertz/material 5e6 0.7 0.45 damping coeff_restitution tangential mindlin NULL {ratio} 0.5\n\
         create_atoms 1 single SHIFT 0 0 units box\ncreate_atoms 1 single BESIDE 0 0 units box\n\
         set atom 1 diameter 0.01 density 2500\nset atom 2 diameter 0.016 density 2500\n\
         velocity all set 0 0 0\ngroup a id 1\nvelocity a set 0.1 0.2 0\n\
         compute c all pair/local x1 y1 z1 x2 y2 z2 vx1 vy1 vz1 vx2 vy2 vz2 id1 id2 crosses forcex forcey forcez fx fy fz p1 p2 p3 \
         torquex torquey torquez h1 h2 h3 area delta cx cy cz cutoff radius\n\
         compute s all reduce sum c_c[*] inputs local\nthermo_style custom step c_s[*]\nthermo_modify format float %.8g\nrun 0\n"
    );
    let deck = deck.replace("c_s[*]", &(1..=35).map(|k| format!("c_s[{k}]")).collect::<Vec<_>>().join(" "));
    let row = |shift: &str, beside: &str| -> Vec<f64> {
        let (text, good) = run_with(&deck.replace("SHIFT", shift).replace("BESIDE", beside), &[]);
        assert!(good, "{text}");
        let numbers =
            |line: &str| line.split_whitespace().map(|w| w.parse().ok()).collect::<Option<Vec<f64>>>();
        text.lines().filter_map(numbers).find(|row| row.len() == 36).unwrap()[1..].to_vec()
    };
    let found = row("0", "0.0129");
    let golden = [
        [0.0, 0.0, 0.0, 0.0129, 0.0, 0.0, 0.1, 0.2, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.0].as_slice(),
        &[-0.271247, -0.0663781, 0.0, -0.271247, 0.0, 0.0, 0.0, -0.0663781, 0.0],
        &[0.0, 0.0, -0.000328572, 0.0, 0.0, 0.0],
        &[1.92417e-6, 0.0001, 0.00496154, 0.0, 0.0],
    ]
    .concat();
    for (k, (found, golden)) in found.iter().zip(&golden).enumerate() {
        assert!((found - golden).abs() <= 4e-6 * golden.abs() + 1e-15, "column {}: {found} {golden}", k + 1);
    }
    // Across a periodic face the second one shows as the image that meets the first.
    let found = row("0.095", "-0.0921");
    assert!(
        (found[3] - 0.1079).abs() < 1e-9 && found[14] == 1.0 && (found[31] - 1e-4).abs() < 1e-9,
        "{found:?}"
    );
}
