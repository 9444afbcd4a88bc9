//! Fields of compute continuum/chunk: what they must add up to, and a pile whose stress is known.

use super::thermo::run_in;
use perigrain::session::set_threads;
use std::fs;

/// What `fix ave/time … mode vector file ${dir}/fields` left: the rows of its last block, without their numbers.
fn rows(deck: &str) -> (Vec<Vec<f64>>, super::thermo::Table) {
    let folder = tempfile::tempdir().unwrap();
    let (_, table) = run_in(folder.path(), "continuum", deck, false);
    let text = fs::read_to_string(folder.path().join("fields")).unwrap();
    let lines = text.lines().filter(|l| !l.starts_with('#'));
    let numbers: Vec<Vec<f64>> =
        lines.map(|l| l.split_whitespace().map(|w| w.parse().unwrap()).collect()).collect();
    let last = numbers.iter().rposition(|r| r.len() == 2).unwrap();
    (numbers[last + 1..].iter().map(|r| r[1..].to_vec()).collect(), table)
}

const WRITE: &str =
    "fix out all ave/time 1 1 1 c_c[*] mode vector file ${dir}/fields format ' %.17g'\nrun 0\n";

fn sum(rows: &[Vec<f64>], column: usize) -> f64 {
    rows.iter().map(|r| r[column]).sum()
}

/// Grains of diameter 0.9 and mass 1 that overlap, in a periodic box of side 4.
fn gas() -> String {
    format!(
        "units lj\natom_style sphere\nregion b block 0 4 0 4 0 4\ncreate_box 1 b\n\
         create_atoms 1 random 70 7711 b overlap 0.75 maxtry 2000\nset type 1 diameter 0.9\n\
         set group all density {}\nvelocity all create 0.4 4321 loop geom\n\
         velocity all set 0.3 -0.1 0.2 sum yes\ncomm_modify vel yes\npair_style granular\n\
         pair_coeff * * hertz 1e3 0.5 tangential linear_nohistory 1.0 0.4\ncompute p all pressure NULL virial\n\
         compute f all fabric radius contact\nthermo_style custom step atoms c_p[*] c_f\n\
         thermo_modify norm no format float %.15g\n",
        6.0 / std::f64::consts::PI / 0.729
    )
}

fn close(got: f64, wanted: f64, scale: f64, what: &str) {
    // Sums over bins a quarter apart of kernels 0.4 wide: the kink at the cutoff of four widths, exp(−8) high, is left.
    assert!((got - wanted).abs() < 1e-4 * scale, "{what}: {got} for {wanted}");
}

// Kernels integrate to 1: fields add up over a periodic box to what they are made of.
#[test]
fn fields_add_up_to_their_particles_and_contacts() {
    for bins in [
        "bin/3d x lower 0.25 y lower 0.25 z lower 0.25",
        "bin/2d z center 0.25 x lower 0.25",
        "bin/1d y lower 0.25",
    ] {
        let fields =
            "density momentum/* volume/fraction stress/contacts/* fabric/* stress/zz stress/ke/zz natoms";
        let deck = format!(
            "{}compute cc all chunk/atom {bins} units box\ncompute c all continuum/chunk cc 1.6 0.4 {fields}\n{WRITE}",
            gas()
        );
        let (rows, table) = rows(&deck);
        let number = |k: usize| table[1][k].parse::<f64>().unwrap();
        let n = number(1);
        assert!(n > 50.0);
        // The volume behind each bin: the box over their number.
        let v = 64.0 / rows.len() as f64;
        close(v * sum(&rows, 0), n, n, bins);
        for (k, u) in [0.3, -0.1, 0.2].iter().enumerate() {
            close(v * sum(&rows, 1 + k), n * u, n, bins);
        }
        close(v * sum(&rows, 4), n * 0.729 * std::f64::consts::PI / 6.0, n, bins);
        // −V times the contact virial of compute pressure, whose off-diagonals are d_x F_y, d_x F_z and d_y F_z: columns
        // yx, zx and zy here.
        let trace = 64.0 * (number(2) + number(3) + number(4));
        assert!(trace > 100.0, "{trace}");
        for (column, pressure) in [(5, 2), (9, 3), (13, 4), (8, 5), (11, 6), (12, 7)] {
            close(v * sum(&rows, column), -64.0 * number(pressure), trace, bins);
        }
        let fabric = [14, 18, 22].map(|k| v * sum(&rows, k)).iter().sum::<f64>();
        close(fabric, number(8) * 0.729 * std::f64::consts::PI / 6.0, number(8), bins);
        for r in &rows {
            assert!((r[23] - r[24] - r[13]).abs() < 1e-9 && r[24] <= 0.0 && r[25] >= 1.0);
        }
    }
}

#[test]
fn threads_leave_fields_as_they_are() {
    let _alone = super::super::threads::alone();
    let deck = format!(
        "{}compute cc all chunk/atom bin/2d x lower 0.25 z lower 0.5 units box\n\
         compute c all continuum/chunk cc 1.6 0.4 density stress/* temperature\n{WRITE}",
        gas()
    );
    set_threads(1);
    let one = rows(&deck).0;
    set_threads(3);
    assert_eq!(one, rows(&deck).0);
    set_threads(2);
}

/// 20 grains of diameter 1 and weight 1 on each other, at rest under linear springs of stiffness 10⁴; `below` of them
/// carry the rest and no force from below.
fn pile(below: usize) -> String {
    let (n, k) = (20, 1e4);
    let mut deck = format!(
        "units lj\natom_style sphere\nboundary p p f\nregion b block 0 1.5 0 1.5 -3 24\ncreate_box 1 b\n\
         pair_style granular\npair_coeff * * hooke {k} 0 tangential linear_nohistory 0 0\n"
    );
    let mut z = 0.5 - f64::from(n) / k;
    if below > 0 {
        deck += &format!("create_atoms 1 single 0.7 0.7 {:.17}\n", z - 1.0 + f64::from(n) / k);
    }
    for above in (0..n).rev() {
        deck += &format!("create_atoms 1 single 0.7 0.7 {z:.17}\n");
        z += 1.0 - f64::from(above) / k;
    }
    deck + &format!("set group all diameter 1\nset group all density {}\n", 6.0 / std::f64::consts::PI)
}

/// Bins of 0.1 along z from −3, farther below the floor than the kernel reaches, on an area of 1.5².
fn stands(deck: &str) {
    let (rows, _) = rows(deck);
    let (area, h) = (2.25, 0.1);
    let (density, stress, boundary) = (0, 1, 2);
    assert!((h * sum(&rows, density) * area - 20.0).abs() < 1e-3);
    assert!((h * sum(&rows, boundary) * area + 20.0).abs() < 1e-3);
    let mut above = 0.0;
    for k in (1..rows.len() - 1).rev() {
        let z = -3.0 + (k as f64 + 0.5) * h;
        above += 0.5 * h * (rows[k][density] + rows[k + 1][density]);
        // A still body: ∂σ_zz/∂z = ρ g + boundary force. Differences over 2 h leave h²/6 of the third derivative, as
        // large as the weight over the cube of the kernel's width.
        let slope = (rows[k + 1][stress] - rows[k - 1][stress]) / (2.0 * h);
        let wanted = rows[k][density] + rows[k][boundary];
        assert!((slope - wanted).abs() < 0.02 * 20.0 / area, "{z}: {slope} {wanted}");
        // Farther from the floor than the kernel reaches, the stress is the weight above: as the kernel smears it to
        // the error of the sum, and of whole grains to a few per cent of the pile's.
        if z > 2.5 {
            assert!((rows[k][stress] + above).abs() < 2e-3 * 20.0 / area, "{z}: {} {above}", rows[k][stress]);
            let weight = (20.0 - z).max(0.0) / area;
            assert!(
                (rows[k][stress] + weight).abs() < 0.02 * 20.0 / area,
                "{z}: {} {weight}",
                rows[k][stress]
            );
        }
    }
}

const FIELDS: &str = "compute cc all chunk/atom bin/1d z lower 0.1 units box\n\
                      compute c all continuum/chunk cc 2.4 0.6 density stress/contacts/zz boundary/force/z";

#[test]
fn stress_in_a_pile_is_the_weight_above() {
    stands(&format!(
        "{}{FIELDS} boundary/fix\nfix floor all wall/gran granular hooke 1e4 0 tangential linear_nohistory 0 0 zplane 0 NULL contacts\n{WRITE}",
        pile(0)
    ));
    stands(&format!("{}group low id 1\n{FIELDS} boundary/atom low\n{WRITE}", pile(1)));
}

#[test]
fn walls_of_a_boundary_must_report_their_contacts() {
    let failing = |walls: &str| {
        let deck = format!("{}{FIELDS} boundary/fix\n{walls}\n{WRITE}", pile(0));
        let folder = tempfile::tempdir().unwrap();
        let run = std::panic::catch_unwind(|| run_in(folder.path(), "continuum", &deck, false));
        *run.map(|_| ()).unwrap_err().downcast::<String>().unwrap()
    };
    assert!(failing("").contains("needs a wall"));
    let text =
        failing("fix floor all wall/gran granular hooke 1e4 0 tangential linear_nohistory 0 0 zplane 0 NULL");
    assert!(text.contains("needs the contacts of fix floor"), "{text}");
}

// Of v_x = y + 2 z on a lattice, with bins of its spacing: what the kernel smears is as linear.
#[test]
fn gradients_of_a_linear_flow_are_exact() {
    let deck = format!(
        "units lj\natom_style sphere\nboundary p f f\nlattice sc 1.0\nregion b block 0 4 0 10 0 10\ncreate_box 1 b\n\
         create_atoms 1 box\nset group all diameter 1\npair_style none\nvelocity all ramp vx 0 10 y 0 10\n\
         velocity all ramp vx 0 20 z 0 10 sum yes\n\
         compute cc all chunk/atom bin/3d x lower 2.0 y lower 1.0 z lower 1.0 units box\n\
         compute c all continuum/chunk cc 2.0 0.7 velocity/grad/* strain/rate/* momentum/grad/xy density temperature\n{WRITE}"
    );
    let (rows, _) = rows(&deck);
    assert_eq!(rows.len(), 200);
    for (k, r) in rows.iter().enumerate() {
        let inside = |a: usize| (3..7).contains(&a);
        if inside(k / 10 % 10) && inside(k % 10) {
            let wanted = [0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            let strain = [0.0, 0.5, 1.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0];
            for (got, wanted) in r.iter().zip(wanted.iter().chain(&strain)) {
                assert!((got - wanted).abs() < 1e-12, "{k}: {r:?}");
            }
            assert!((r[18] - r[19]).abs() < 1e-12 * r[19], "{k}: {r:?}");
        }
    }
}

// Two discs that pass each other at ±1 left and right of a bin's centre: V_c is 0 there.
#[test]
fn what_moves_about_the_mean_is_heat() {
    let deck = format!(
        "units lj\ndimension 2\natom_style sphere\nboundary p f p\nregion b block 0 6 0 5 -0.5 0.5\ncreate_box 1 b\n\
         create_atoms 1 single 2.7 2.5 0\ncreate_atoms 1 single 3.3 2.5 0\nset group all diameter 0.5\n\
         group left id 1\ngroup right id 2\nvelocity left set 0 1 NULL\nvelocity right set 0 -1 NULL\npair_style none\n\
         compute cc all chunk/atom bin/2d x lower 6 y lower 1 units box\n\
         compute c all continuum/chunk cc 2.0 1.0 temperature density stress/ke/* natoms velocity/grad/yx\n{WRITE}"
    );
    let (rows, _) = rows(&deck);
    let middle = &rows[2];
    assert!((middle[0] - 0.5 * middle[1]).abs() < 1e-14 && middle[1] > 0.01);
    assert!((middle[5] + middle[1]).abs() < 1e-14 && middle[2] == 0.0 && middle[3] == 0.0);
    assert_eq!((middle[6], middle[7]), (2.0, 0.0));
}
