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
variable half equal 0.00275
region right block v_half INF INF INF INF INF units box
group right region right
material glass E 70e9 nu 0.25 rho 2400 Gc 10
LAW
pair_coeff 1 1 material glass horizon HORIZON
peri_modify break energy OPTIONS
set group all volume VOLUME density 2400
variable n equal count(all)
timestep 1e-9
fix hold all move linear 0 0 0
fix pull right move linear 1 0 0
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
            .replace("STEPS", "3000");
        let (text, well) = run(&deck, list);
        assert!(well, "{text}");
        let numbers = printed(&text, "G ");
        assert!(numbers[1].abs() < 1e-12, "bonds are left: {law} {options} {text}");
        assert!((numbers[0] / 10.0 - 1.0).abs() < 0.01, "{law} {options}: {numbers:?}");
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
            "use `break strain` or `break energy`",
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
        ("pair_style peri/pmb\nperi_modify break energy every 0", "every"),
    ] {
        let (text, well) = run(&format!("{start}{lines}\n"), false);
        assert!(!well && text.contains(wanted), "{lines}: {text}");
    }
}
