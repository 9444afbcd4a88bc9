//! K7: Python, editors, help, packings.
//!
//! Python is tested in `crates/py/tests`, Neovim by `tests/clients/editor.sh`.

use std::process::Command;

/// What the program prints for a command line, run in a folder of its own.
fn output_of(arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_perigrain"));
    let output = command.args(arguments).current_dir(folder.path()).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Row 44: the how-tos are in the program.
#[test]
fn help_finds_how_tos() {
    let notch = output_of(&["help", "notch"]);
    assert!(
        notch.starts_with("# A crack from a notch\n") && notch.contains("How do I simulate a crack"),
        "{notch}"
    );
    assert!(notch.contains("peri_crack") && !notch.contains("](../styles/"), "{notch}");
    let movie = output_of(&["help", "movie"]);
    assert!(movie.contains("howto movie") || movie.contains("How do I make a movie"), "{movie}");
    for (word, howto) in
        [("angle of repose", "howto repose"), ("paraview", "howto results"), ("kill", "howto long-runs")]
    {
        let found = output_of(&["help", word]);
        assert!(found.contains(&format!("\n  {howto} ")), "{word}: {found}");
    }
    assert!(output_of(&["help"]).contains("\nhow-tos\n"));
}

/// Row 43: several sizes in one packing, a number to reach, a box that leans.
#[test]
fn packings_of_two_sizes_fill_a_leaning_box() {
    let folder = tempfile::tempdir().unwrap();
    let deck = "units si\natom_style sphere\nregion b prism 0 4 0 4 0 4 1 0.7 -0.7 units box\ncreate_box 2 b\n\
                create_atoms 1 pack b number 300 4711 sizes mix number 0.5 4 0.8 1 types 1 2\n\
                variable small atom type==1\ngroup small variable small\n\
                variable big equal count(all)-count(small)\nprint \"counts $(count(small)) ${big}\"\n\
                write_data packed.data\n";
    std::fs::write(folder.path().join("in.deck"), deck).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_perigrain"));
    let output =
        command.args(["-in", "in.deck", "-log", "none"]).current_dir(folder.path()).output().unwrap();
    let text =
        format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && text.contains("\ncounts 240 60\n"), "{text}");
    let data = std::fs::read_to_string(folder.path().join("packed.data")).unwrap();
    let atoms = data.split("\nAtoms").nth(1).unwrap();
    let rows: Vec<Vec<f64>> = atoms
        .lines()
        .skip(2)
        .take_while(|line| !line.trim().is_empty())
        .map(|line| line.split_whitespace().map(|word| word.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 300);
    // id type diameter density x y z: each type has its size, and every pair, through the leaning faces too, overlaps by less than
    // a twentieth (a thousandth on average is the goal).
    let vectors = [[4.0, 0.0, 0.0], [1.0, 4.0, 0.0], [0.7, -0.7, 4.0]];
    let shift = |n: [f64; 3]| [0, 1, 2].map(|d: usize| (0..3).map(|k| n[k] * vectors[k][d]).sum::<f64>());
    let step = |k: i32| f64::from(k % 3 - 1);
    let images: Vec<[f64; 3]> = (0..27).map(|k| shift([step(k), step(k / 3), step(k / 9)])).collect();
    let mut deepest: f64 = 0.0;
    for (k, a) in rows.iter().enumerate() {
        assert_eq!(a[2], if a[1] == 1.0 { 0.5 } else { 0.8 });
        for b in &rows[..k] {
            let touch = 0.5 * (a[2] + b[2]);
            for image in &images {
                let square: f64 = (0..3).map(|d| (a[4 + d] - b[4 + d] - image[d]).powi(2)).sum();
                deepest = deepest.max(1.0 - square.sqrt() / touch);
            }
        }
    }
    assert!(deepest < 0.05, "{deepest}");
}
