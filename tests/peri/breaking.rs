//! Criteria of breaking in whole scenes: what a crack costs, what does not go together.

use perigrain::output::log::{Buffer, Log};
use perigrain::session::{Options, Session};

/// Executes a deck; its output, and whether it went well.
fn run(deck: &str, force_list: bool) -> (String, bool) {
    let screen = Buffer::default();
    let log = Log::new(Some(Box::new(screen.clone())));
    let mut session = Session::new(Options { log, force_list, ..Options::default() }).unwrap();
    let outcome = session.run_text("breaking.in", deck);
    let more = outcome.as_ref().err().map(ToString::to_string).unwrap_or_default();
    (screen.text() + &more, outcome.is_ok())
}

/// The numbers behind a label in printed lines.
fn printed(text: &str, label: &str) -> Vec<f64> {
    let of = |line: &str| -> Option<Vec<f64>> {
        let rest = line.strip_prefix(label)?;
        Some(rest.split_whitespace().filter_map(|word| word.parse().ok()).collect())
    };
    text.lines().filter_map(of).next_back().unwrap_or_else(|| panic!("no `{label}` in\n{text}"))
}

/// Two halves of a crystal that repeats across, which are drawn apart as rigid bodies until no bond is left. `LATTICE`, `LAW` and
/// `OPTIONS` are filled in; the glass has Gc = 10.
const HALVES: &str = r#"units si
atom_style peri
boundary s p p
LATTICE
region world block -0.001 0.0062 0 0.008 0 0.008 units box
region solid block -0.0001 0.0056 -0.0001 0.00799 -0.0001 0.00799 units box
create_box 1 world
create_atoms 1 region solid
region right block 0.00275 INF INF INF INF INF units box
group right region right
group left subtract all right
material glass E 70e9 nu 0.25 rho 2400 Gc 10
LAW
pair_coeff 1 1 material glass horizon HORIZON
peri_modify break energy OPTIONS
set group all volume VOLUME density 2400
variable n equal count(all)
timestep 2e-9
fix hold left move linear 0 0 0 units box
fix pull right move linear 1 0 0 units box
compute e all energy/ledger
thermo_style custom step c_e[3] c_e[7]
thermo 1000
run STEPS
print "G $(c_e[7]/6.4e-5:%.10g) $(c_e[3]:%.10g)"
"#;

/// The energy that a plane sets free for each area is Gc: bonds break at their work, which the last step exceeds by up to twice the
/// step over the critical opening, below half a per cent here.
#[test]
fn a_plane_costs_the_fracture_energy() {
    let cubic = ("lattice sc 0.001", "3.015", "1e-9");
    let centred = ("lattice bcc 0.001", "2.2", "0.5e-9");
    for (lattice, law, options, list) in [
        (cubic, "peri/pmb", "", false),
        (cubic, "peri/pmb", "volume full", true),
        (cubic, "peri/lps", "volume none", false),
        (cubic, "peri/lps", "influence gaussian", true),
        (centred, "peri/pmb", "", false),
    ] {
        let (lattice, horizon, volume) = lattice;
        let deck = HALVES
            .replace("LATTICE", lattice)
            .replace("LAW", &format!("pair_style {law}"))
            .replace("HORIZON", horizon)
            .replace("OPTIONS", options)
            .replace("VOLUME", volume)
            .replace("STEPS", "1400");
        let (text, well) = run(&deck, list);
        assert!(well, "{text}");
        let numbers = printed(&text, "G ");
        assert!(numbers[1].abs() < 1e-12, "bonds are left: {law} {options} {text}");
        assert!((numbers[0] / 10.0 - 1.0).abs() < 0.01, "{law} {options}: {numbers:?}");
    }
}

/// A block that bursts, of which the lines `MORE` decide how; the sums of its damages and places at the end.
const BLOCK: &str = "\
units si
atom_style peri
boundary s s s
lattice sc 0.001
region blk block 0 7 0 5 0 5
create_box 1 blk
create_atoms 1 region blk
set group all density 2400
set group all volume 1e-9
variable u atom 6000.0*(x-0.0035)
velocity all set v_u 0 0 units box
pair_style peri/pmb
MORE
fix 1 all nve
timestep 5.0e-8
compute dmg all damage/atom
compute d all reduce sum c_dmg
variable m atom x*x+3*y*y+7*z*z
compute m all reduce sum v_m
thermo_style custom step c_d c_m
thermo_modify format float %.17g
run 40
print \"END $(c_d:%.17g) $(c_m:%.17g)\"
";

fn burst(more: &str, list: bool) -> Vec<f64> {
    let (text, well) = run(&BLOCK.replace("MORE", more), list);
    assert!(well, "{text}");
    printed(&text, "END ")
}

/// A formula that says what the stretch says breaks the same bonds; so does one of variables of both ends, and of temperature.
#[test]
fn formulas_are_what_they_say() {
    const COEFF: &str = "pair_coeff * * 1.6e21 0.0030001 S00 0";
    for list in [false, true] {
        let plain = burst(&COEFF.replace("S00", "0.0015"), list);
        assert!(plain[0] > 10.0, "{plain:?}");
        let formula = |variables: &str| {
            let never = COEFF.replace("S00", "1e3");
            burst(&format!("{never}\n{variables}\nperi_modify break formula v_b"), list)
        };
        assert_eq!(plain, formula("variable b bond \"s/0.0015\""));
        let ends = "variable half atom 0.00075+0*x\nvariable both bond v_half[1]+v_half[2]\nvariable b bond \"s/v_both*(nx^2+ny^2+nz^2)*(L<0.0030001)\"";
        // Rounding of nx² + ny² + nz² decides about no bond.
        assert_eq!(plain, formula(ends));
        let warm = "fix p all property/atom temperature\nset group all temperature 300\nvariable b bond \"s/0.0015*(T1+T2)/600+0*(d1-d2)\"";
        assert_eq!(plain, formula(warm));
        // Judged at every fourth step alone, bonds break later.
        let late = format!(
            "{}\nvariable b bond s/0.0015\nperi_modify break formula v_b every 4",
            COEFF.replace("S00", "1e3")
        );
        let late = burst(&late, list);
        assert!(late[0] > 0.0 && late != plain, "{late:?} {plain:?}");
    }
}

/// A variable that gives the factors which `set` has given leaves the same bits; one that falls with time breaks more.
#[test]
fn strengths_follow_a_variable() {
    const COEFF: &str = "pair_coeff * * 1.6e21 0.0030001 0.0015 0.25";
    for list in [false, true] {
        for criterion in ["", "\nperi_modify break energy", "\nperi_modify break strain 0.001"] {
            let factor = "variable f atom 0.8+40*x";
            let given =
                burst(&format!("{COEFF}{criterion}\n{factor}\nset group all peri/strength v_f"), list);
            let fixed =
                burst(&format!("{COEFF}{criterion}\n{factor}\nfix s all peri/strength 1000 v_f"), list);
            // In the setup of the run the variable sees the same places as `set`.
            assert_eq!(given, fixed, "{criterion}");
            let falls = "variable f atom 1-0.5*(step>=10)";
            let falls = burst(&format!("{COEFF}{criterion}\n{falls}\nfix s all peri/strength 5 v_f"), list);
            assert!(falls[0] > given[0], "{criterion}: {falls:?} {given:?}");
        }
    }
}

/// What does not go together is refused, with a way out.
#[test]
fn criteria_that_do_not_fit_are_refused() {
    let start = "units si\natom_style peri\nboundary s s s\nlattice sc 0.001\nregion b block 0 0.004 0 0.004 0 0.004 units box\n\
                 create_box 1 b\ncreate_atoms 1 box\nset group all volume 1e-9 density 2400\nmaterial m E 70e9 nu 0.25 rho 2400 Gc 10\n";
    for (lines, wanted) in [
        (
            "pair_style peri/pmb/softening\npair_coeff * * material m horizon 3.015 peak 1e-4\nperi_modify break energy\nrun 0",
            "fracture energy in their curve",
        ),
        (
            "pair_style peri/eps\npair_coeff * * 4e10 3e10 0.003015 0.001 0 1e8\nperi_modify break stress 1e8\nrun 0",
            "the stress is that of an elastic solid",
        ),
        (
            "pair_style peri/pmb/plastic\npair_coeff * * material m horizon 3.015 syc -0.001\nperi_modify break shear 1e8\nrun 0",
            "its bonds flow, relax or soften",
        ),
        (
            "pair_style peri/pmb\npair_coeff * * material m horizon 3.015\nperi_modify break energy horizon own\nrun 0",
            "horizon own",
        ),
        (
            "pair_style peri/pmb\npair_coeff * * material m horizon 3.015\nrun 0\nperi_modify break energy\nrun 0",
            "comes too late",
        ),
        ("pair_style peri/pmb\nperi_modify break stress", "the tensile strength"),
        ("pair_style peri/pmb\nperi_modify break stress -1", "the tensile strength"),
        ("pair_style peri/pmb\nperi_modify break strength 1", "criterion of breaking"),
        ("pair_style peri/pmb\nperi_modify break energy every 0", "at least 1, not 0"),
        ("pair_style peri/pmb\nperi_modify break formula 2", "a bond-style variable"),
        (
            "pair_style peri/pmb\npair_coeff * * material m horizon 3.015\nperi_modify break formula v_none\nrun 0",
            "variable",
        ),
        (
            "variable b equal 1\npair_style peri/pmb\npair_coeff * * material m horizon 3.015\nperi_modify break formula v_b\nrun 0",
            "bond-style",
        ),
        (
            "variable a atom x\nvariable b bond s+v_a\npair_style peri/pmb\npair_coeff * * material m horizon 3.015\nperi_modify break formula v_b\nrun 2",
            "a bond has two ends",
        ),
        (
            "variable b bond T1/300\npair_style peri/pmb\npair_coeff * * material m horizon 3.015\nperi_modify break formula v_b\nrun 2",
            "have no temperature",
        ),
        ("variable b bond s\nvariable e equal v_b\nprint \"$(v_e)\"", "one value per bond"),
        (
            "variable f atom 0*x\npair_style peri/pmb\npair_coeff * * material m horizon 3.015\nfix s all peri/strength 1 v_f\nrun 1",
            "it must be positive",
        ),
    ] {
        let (text, well) = run(&format!("{start}{lines}\n"), false);
        assert!(!well && text.contains(wanted), "{lines}: {text}");
    }
}
