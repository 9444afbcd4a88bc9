//! Load steps of solids: equilibria, their work, cracks that grow at equilibria, and runs behind them.

use super::decks::run_with;

/// A bar of glass of 14 x 6 x 4 points with a notch in the middle, its left end held, its right end pulled by 1 micrometre in
/// each unit of time; `LAW` and `STEPS` are filled in.
const BAR: &str = "\
units si
atom_style peri
boundary s s s
lattice sc 1.0e-3
region world block -0.001 0.015 -0.001 0.007 -0.001 0.005 units box
region bar block 0 0.0135 0 0.0055 0 0.0035 units box
region notch block 0.0065 0.0075 -1 0.0024 -1 1 units box
region left block -1 0.0014 -1 1 -1 1 units box
region right block 0.0116 1 -1 1 -1 1 units box
create_box 1 world
create_atoms 1 region bar
delete_atoms region notch
LAW
set group all density 2440
set group all volume 1.0e-9
peri_modify force newton
group lo region left
group hi region right
group rest subtract all lo hi
fix 1 all nve
fix base lo move linear 0 0 0 units box
fix pull hi move linear 1.0e-6 0 0 units box
timestep 1
thermo 1
thermo_style custom step time pe ke
thermo_modify format float %23.17g
STEPS
";

const PMB: &str = "pair_style peri/pmb\npair_coeff 1 1 3.05e21 3.0151e-3 S00 0.0";
const LPS: &str = "pair_style peri/lps\npair_coeff 1 1 4.4e10 3.0e10 3.0151e-3 S00 0.0";

fn deck(law: &str, s00: &str, steps: &str) -> String {
    BAR.replace("LAW", &law.replace("S00", s00)).replace("STEPS", steps)
}

fn run(deck: &str) -> String {
    let (text, well) = run_with(deck, &[]);
    assert!(well, "{text}");
    text
}

/// The numbers behind a label in printed lines.
fn printed(text: &str, label: &str) -> Vec<f64> {
    let of = |line: &str| -> Option<Vec<f64>> {
        let rest = line.strip_prefix(label)?;
        Some(rest.split_whitespace().filter_map(|word| word.parse().ok()).collect())
    };
    text.lines().filter_map(of).next_back().unwrap_or_else(|| panic!("no `{label}` in\n{text}"))
}

/// Work, change of energy, released and relaxed energy and the error of all load steps.
fn ledger(text: &str) -> [f64; 5] {
    let line = text.lines().rev().find(|line| line.trim_start().starts_with("Work =")).unwrap();
    let numbers: Vec<f64> = line.split(['=', '+']).filter_map(|word| word.trim().parse().ok()).collect();
    numbers.try_into().unwrap()
}

/// `minimize` from there finds nothing left to do: the energy that it finds differs by 1e-12 of it, where an unbalanced force of
/// 1e-6 of the reactions could give up (1e-6)². Both laws.
#[test]
fn minimize_finds_no_lower_energy() {
    for law in [PMB, LPS] {
        let steps = "statics 3 tol 1.0e-7\nprint \"E $(pe:%.15g)\"\nfix h lo setforce 0 0 0\nfix k hi setforce 0 0 0\n\
                     min_style cg\nmin_modify dmax 1.0e-7\nminimize 0 1.0e-9 200 400\nprint \"M $(pe:%.15g)\"";
        let text = run(&deck(law, "1.0", steps));
        let (found, least) = (printed(&text, "E ")[0], printed(&text, "M ")[0]);
        assert!(found > 0.0 && (found - least).abs() < 1e-12 * found, "{law}: {found} {least}");
    }
}

/// Work is the change of energy where nothing breaks. The mean of forces at both ends of a load step is exact for forces that
/// are linear in its strain; those of bonds that turn are so but for a part of that strain, which is 1e-4 here.
#[test]
fn work_is_the_energy_of_an_elastic_body() {
    for law in [PMB, LPS] {
        let text = run(&deck(law, "1.0", "statics 4"));
        let [work, energy, released, relaxed, error] = ledger(&text);
        assert!(work > 0.0 && released == 0.0 && relaxed == 0.0, "{text}");
        assert!((work - energy).abs() < 1e-4 * work && error.abs() < 1e-4 * work, "{text}");
    }
}

/// A bar that breaks gives back what it took: W = dU + D + R but for the mean of forces in load steps (as above), with energy set
/// free by bonds and given up between equilibria, whichever of the bonds beyond their limit break first.
#[test]
fn a_notched_bar_tears_and_the_ledger_closes() {
    for (law, way) in [(PMB, "one"), (PMB, "batch 0.5"), (PMB, "all"), (LPS, "one")] {
        let text = run(&deck(law, "2.0e-4", &format!("statics 8 break {way}")));
        let [work, energy, released, relaxed, error] = ledger(&text);
        let broken = printed(&text, "  Bonds broken =")[0];
        assert!(broken > 20.0, "{law} {way}: {text}");
        assert!(released > 0.0 && relaxed > 0.0, "{law} {way}: {text}");
        assert!((work - energy - released - relaxed).abs() < 1e-4 * work, "{law} {way}: {text}");
        assert!(error.abs() < 1e-4 * work, "{law} {way}: {text}");
        // Torn: what is left is far below what was put in.
        assert!(energy < 0.2 * work, "{law} {way}: {text}");
    }
}

/// A weight that grows from 0 works the energy of the body (Clapeyron), as exactly as equilibria are found.
#[test]
fn a_weight_that_grows_works_the_energy() {
    let steps =
        "unfix pull\nvariable g equal 1.0e4*time/4\nfix weight all gravity v_g vector 1 0 0\nstatics 4";
    let text = run(&deck(PMB, "1.0", steps));
    let [work, energy, ..] = ledger(&text);
    assert!(work > 0.0 && (work / energy - 1.0).abs() < 1e-6, "{text}");
}

/// A run behind load steps finds nothing to do: its kinetic energy stays below 1e-10 of the energy.
#[test]
fn a_run_behind_load_steps_stays_at_rest() {
    let steps = "statics 2 tol 1.0e-7\nunfix pull\nunfix base\nfix h lo setforce 0 0 0\nfix k hi setforce 0 0 0\ntimestep 5.0e-8\nthermo 200\n\
                 run 200\nprint \"K $(ke:%.15g) $(pe:%.15g)\"";
    let text = run(&deck(PMB, "1.0", steps));
    let numbers = printed(&text, "K ");
    assert!(numbers[0] < 1e-10 * numbers[1], "{numbers:?}");
}

/// The same bytes for any number of threads, cracks included; and for ranks, each of which balances the whole body.
#[test]
fn threads_and_ranks_leave_the_same_bits() {
    let steps = "statics 6 break one\nwrite_dump all custom end.txt id x y z modify format float %.17g\nshell cat end.txt";
    let clean = |text: String| -> String {
        let timed = |line: &&str| {
            !["thread", "Loop time", "CPU use", "Total wall", "|"].iter().any(|w| line.contains(w))
        };
        // The last column of the table of load steps is their time.
        text.lines()
            .filter(timed)
            .filter(|line| line.split_whitespace().count() != 9)
            .collect::<Vec<_>>()
            .join("\n")
    };
    let deck = deck(PMB, "2.0e-4", steps);
    let one = clean(run_with(&deck, &["-threads", "1"]).0);
    assert!(one.contains("ITEM: ATOMS"), "{one}");
    for words in [&["-threads", "2"][..], &["-threads", "7"]] {
        let other = clean(run_with(&deck, words).0);
        assert!(other == one, "{words:?}\n{other}\n{one}");
    }
    // Their logs say on how many ranks they ran.
    let particles = |text: &str| {
        text[text.find("ITEM: ATOMS").unwrap()..].lines().take(325).map(String::from).collect::<Vec<_>>()
    };
    let several = run_with(&deck, &["-ranks", "3", "-threads", "1"]).0;
    assert!(particles(&several) == particles(&one), "{several}");
}

/// What load steps cannot be made with is refused by name.
#[test]
fn what_cannot_be_balanced_is_refused() {
    for (steps, wanted) in [
        ("unfix base\nunfix pull\nstatics 1", "nothing holds the piece of 324 particles"),
        ("unfix 1\nstatics 1", "no particle moves freely"),
        ("fix heat all langevin 1 1 1 1\nstatics 1", "fix langevin cannot act in the load steps"),
        ("statics 0", "the number of load steps"),
        ("statics 1 break none", "break"),
        ("statics 1 break batch 2", "the fraction must lie between 0 and 1"),
        ("statics 1 tol 0", "the tolerance"),
        ("statics 1 control damage break all", "`control damage` breaks one bond after another"),
        ("statics 1 control opening 0", "the opening of a load step"),
        ("statics 1 control opening 1e-5 solver adr", "`control opening` finds time and places together"),
        ("statics 1 until 2", "the fraction must lie between 0 and 1"),
    ] {
        let (text, well) = run_with(&deck(PMB, "1.0", steps), &[]);
        assert!(!well && text.contains(wanted), "{steps}: {text}");
    }
}

/// Columns of the last row of thermo output.
fn last_row(text: &str) -> Vec<f64> {
    let lines: Vec<&str> = text.lines().collect();
    let end = lines.iter().rposition(|line| line.starts_with("Loop time")).unwrap();
    lines[end - 1].split_whitespace().map(|word| word.parse().unwrap()).collect()
}

const NUMBERS: &str = "compute s all statics\nthermo_style custom step time pe c_s[6] c_s[7] c_s[8] c_s[9] c_s[11] c_s[12]\n\
                       thermo_modify format float %23.17g\n";

/// The load at which the first bond breaks is proportional to its limit, but for the turning of bonds, which is of the order of
/// strains (2e-4), and for the search, which ends 1e-3 above the limit at most.
#[test]
fn damage_control_finds_the_limit_forwards_and_back() {
    let onset = |s00: &str| {
        let text = run(&deck(PMB, s00, &format!("{NUMBERS}statics 1 control damage")));
        let row = last_row(&text);
        assert!(row[3] >= 1.0, "{text}");
        row[1]
    };
    let (once, twice) = (onset("2.0e-4"), onset("4.0e-4"));
    assert!((twice / once - 2.0).abs() < 4e-3, "{once} {twice}");
    // The load of each break, none of which gives up more than the bond itself: the body unloads where a crack would run on.
    let text = run(&deck(PMB, "2.0e-4", &format!("{NUMBERS}statics 40 control damage")));
    let [work, energy, released, relaxed, error] = ledger(&text);
    assert!((work - energy - released - relaxed).abs() < 1e-4 * work && error.abs() < 1e-4 * work, "{text}");
    assert!(released > 0.0 && relaxed < 0.3 * released, "{text}");
    let times: Vec<f64> = text
        .lines()
        .filter_map(|line| {
            let row: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            (row.len() == 9 && row[0] >= 1.0 && line.split_whitespace().count() == 9 && row[3] > 0.0)
                .then(|| row[1])
        })
        .collect();
    assert!(times.windows(2).any(|t| t[1] < t[0]), "{times:?}");
}

/// Three points in a row: the bond of the first two softens from the stretch 1e-3 on, that of the last two does not.
const TWO: &str = "\
units si
atom_style peri
boundary s s s
lattice sc 1e-3 origin 0.5 0.5 0.5
region box block 0 0.003 0 0.001 0 0.001 units box
create_box 2 box
create_atoms 1 box
region right block 0.002 INF INF INF INF INF units box
region left block INF 0.001 INF INF INF INF units box
group hi region right
group lo region left
group mid subtract all lo hi
set group hi type 2
set group all volume 1e-9 density 2440
pair_style peri/pmb/softening LAW
pair_coeff 1 1 1e22 1.5e-3 1e-3 40
pair_coeff * 2 1e22 1.5e-3 0.5 1e9
peri_modify force newton
fix 1 all nve
fix base lo move linear 0 0 0 units box
fix pull hi move linear 1.0e-7 0 0 units box
compute x mid reduce ave x
compute r hi reduce ave x
variable s1 equal (c_x-0.0015)/0.001
variable s2 equal (c_r-c_x-0.001)/0.001
timestep 1
thermo 1
thermo_style custom step time v_s1 v_s2
thermo_modify format float %23.17g
statics 24 tol 1e-10 control opening 1e-4
";

/// Two springs in series, of which one softens more steeply than the other is stiff: the load falls with its path going back. Both bear the
/// same force, so that the second's stretch is g(s) of the first: s below the peak s₀, beyond it s₀ (s_f − s)/(s_f − s₀) or
/// s₀ exp(ln 10⁻³ (s − s₀)/(s_f − s₀)), with πcδ⁵/5 ∫ g ds = 40 J/m². 1e-8 of the peak: the forces differ by 1e-10 of them, the rest is the
/// turn of nothing (a row stays a row) and rounding.
#[test]
fn a_snap_back_of_two_springs_is_followed() {
    let (peak, scale): (f64, f64) = (1e-3, std::f64::consts::PI * 1e22 * 1.5e-3f64.powi(5) / 5.0);
    let area = 40.0 / scale;
    for law in ["linear", "exponential"] {
        let text = run(&TWO.replace("LAW", law));
        let rest = 1e-3f64;
        let last = match law {
            "linear" => 2.0 * area / peak,
            _ => peak + (area / peak - 0.5 * peak) / (1.0 - rest) * -rest.ln(),
        };
        let force = |s: f64| match law {
            _ if s <= peak => s,
            "linear" => (peak * (last - s) / (last - peak)).max(0.0),
            _ => peak * (rest.ln() * (s - peak) / (last - peak)).exp(),
        };
        let (rows, _) = text.split_once("Loop time").unwrap();
        let rows: Vec<Vec<f64>> = rows
            .lines()
            .map(|line| line.split_whitespace().filter_map(|word| word.parse().ok()).collect::<Vec<f64>>())
            .filter(|row| row.len() == 4)
            .collect();
        assert_eq!(rows.len(), 25, "{text}");
        let mut back = 0;
        for pair in rows.windows(2) {
            let [before, now]: [[f64; 4]; 2] = [0, 1].map(|k| pair[k][..].try_into().unwrap());
            let [step, time, s1, s2] = now;
            // By 1e-4 of its length, as long as it lives.
            let grown = (1.0 + s1) / (1.0 + before[2]) - 1.0;
            assert!(s1 > last || (grown - 1e-4).abs() < 1e-12, "{law} {step}: {grown}");
            assert!((s2 - force(s1)).abs() < 1e-8 * peak, "{law} {step}: {s1} {s2} {}", force(s1));
            assert!((time * 1e-7 - 1e-3 * (s1 + s2)).abs() < 1e-8 * 1e-3 * peak, "{law} {step}: {time}");
            back += usize::from(time < before[1]);
        }
        assert!(back >= 3, "{law}: {rows:?}");
    }
}

/// Brittle bonds break where their opening passes the limit, each at the load that keeps the next one's length: the same energies as elsewhere.
#[test]
fn an_opening_breaks_brittle_bonds_too() {
    let steps = format!("{NUMBERS}statics 40 control opening 2.0e-5 until 0.3");
    let text = run(&deck(PMB, "2.0e-4", &steps));
    let [work, energy, released, relaxed, error] = ledger(&text);
    assert!((work - energy - released - relaxed).abs() < 1e-4 * work && error.abs() < 1e-4 * work, "{text}");
    assert!(released > 0.0 && printed(&text, "  Bonds broken =")[0] > 5.0, "{text}");
}

/// `until` ends where the load has fallen.
#[test]
fn load_steps_end_where_the_load_has_fallen() {
    let text = run(&deck(PMB, "2.0e-4", &format!("{NUMBERS}statics 8 until 0.5\nprint \"S $(step)\"")));
    assert!(printed(&text, "S ")[0] < 8.0, "{text}");
}

/// Damped motion ends where Newton's method does: energies differ by the square of what both leave of the force, 1e-6 of it,
/// times the condition of the body (1e3 at most). And pieces that nothing holds are balanced too.
#[test]
fn relaxation_finds_the_same_place() {
    for law in [PMB, LPS] {
        let energy =
            |words: &str| last_row(&run(&deck(law, "1.0", &format!("{NUMBERS}statics 2 {words}"))))[2];
        let (newton, relaxed) = (energy(""), energy("solver adr"));
        assert!((newton / relaxed - 1.0).abs() < 1e-8, "{law}: {newton} {relaxed}");
    }
    let loose = "unfix base\nunfix pull\nfix a all addforce 0 0 0\nstatics 1 solver adr";
    run(&deck(PMB, "1.0", loose));
}

/// What relaxes under a load that grows evenly is exact for any number of load steps but for how the strain is distributed over
/// the body, and held under a fixed strain the body loses energy without work.
#[test]
fn what_relaxes_does_so_over_the_time_of_load_steps() {
    let ves = "pair_style peri/ves\npair_coeff 1 1 4.4e10 3.0e10 3.0151e-3 1.0 0.0 0.5 2.0";
    let held = "unfix pull\nfix still hi move linear 0 0 0 units box\nstatics 2 time 8";
    let row = |steps: i32| {
        let text =
            run(&deck(ves, "", &format!("{NUMBERS}statics {steps} time 6\nprint \"E $(pe:%.15g)\"\n{held}")));
        (printed(&text, "E ")[0], last_row(&text))
    };
    let ((three, _), (six, last)) = (row(3), row(6));
    assert!((three / six - 1.0).abs() < 2e-3, "{three} {six}");
    assert!(last[4] == 0.0 && last[5] < 0.0 && (last[5] + last[8]).abs() < 1e-9 * last[8], "{last:?}");
}

/// Plastic flow within a load step is that of the place where it ends, however often places are tried: few load steps and many
/// leave nearly the same energies (what flows on a straight path does not depend on its parts; strains turn a little), and what
/// flows is lost.
#[test]
fn what_flows_does_so_at_equilibria() {
    let eps = "pair_style peri/eps\npair_coeff 1 1 4.4e10 3.0e10 3.0151e-3 1.0 0.0 1.0e7";
    let row = |steps: i32| last_row(&run(&deck(eps, "", &format!("{NUMBERS}statics {steps} time 4"))));
    let (few, many) = (row(4), row(16));
    assert!(many[8] > many[5] && many[5] > 0.0, "{many:?}");
    assert!((few[5] / many[5] - 1.0).abs() < 0.02, "{few:?} {many:?}");
    assert!((few[7] / many[7] - 1.0).abs() < 0.01, "{few:?} {many:?}");
}

/// A restart file between two lines of load steps leaves the same bits as none.
#[test]
fn a_restart_between_load_steps_leaves_the_same_bits() {
    let end = "write_dump all custom end.txt id x y z modify format float %.17g\nshell cat end.txt";
    let whole = deck(PMB, "2.0e-4", &format!("statics 2\nstatics 1\n{end}"));
    let again = format!(
        "statics 2\nwrite_restart mid.restart\nclear\nread_restart mid.restart\n{}\nFIXES\ntimestep 1\nstatics 1\n{end}",
        PMB.replace("S00", "2.0e-4")
    );
    let fixes = "fix 1 all nve\nfix base lo move linear 0 0 0 units box\nfix pull hi move linear 1.0e-6 0 0 units box\nthermo 1\nthermo_style custom step time pe ke";
    let again = deck(PMB, "2.0e-4", &again.replace("FIXES", fixes));
    let places = |text: &str| {
        text[text.find("ITEM: ATOMS").unwrap()..].lines().take(325).map(String::from).collect::<Vec<_>>()
    };
    assert!(places(&run(&whole)) == places(&run(&again)));
}

/// Bonds that soften: what they lose is known, so that the ledger shows its error; each line takes the time that it says, also where a
/// load step is cut; and what is lost counts as fracture in the ledger of a run.
#[test]
fn what_softens_is_booked() {
    let law = "pair_style peri/pmb/softening\npair_coeff 1 1 3.05e21 3.0151e-3 1.0e-4 12";
    let lines = "compute s all statics\ncompute e all energy/ledger\nthermo_style custom step time pe c_s[7] c_s[8] c_s[9] c_s[10] c_s[12]\n\
                 thermo_modify format float %23.17g\nstatics 60 time 3\nrun 0\nprint \"taken $(c_e[7]) time $(time)\"";
    let text = run(&deck(law, "1.0", lines));
    let row = last_row(&text);
    let [work, energy, released, relaxed, lost] = row[3..8] else { panic!("{row:?}") };
    let error = work - energy - released - relaxed - lost;
    // The mean of forces over load steps of a thirtieth of the peak's strain: of second order.
    assert!(lost > 0.05 * work && error.abs() < 1e-2 * work, "{text}");
    let taken = printed(&text, "taken ");
    assert!(
        (taken[0] - released - lost).abs() < 1e-6 * work && (taken[1] - 3.0).abs() < 1e-9,
        "{taken:?} {released} {lost}"
    );
}

/// Bonds that are cut between two lines of load steps leave the body out of balance: what it gives up on the way to the next equilibrium is
/// booked as relaxed, not as an error.
#[test]
fn what_is_cut_between_lines_relaxes() {
    let lines = "statics 2\nregion more block INF INF INF 0.0039 INF INF units box\n\
                 peri_crack plane 0.007 0 0 1 0 0 region more units box\nfix pull hi move linear 0 0 0 units box\nstatics 1";
    let [work, energy, released, relaxed, error] = ledger(&run(&deck(PMB, "1.0", lines)));
    // Nothing moves but what is free: no work, and all that is missing was given up.
    assert!(work.abs() < 1e-12 && released == 0.0 && error == 0.0, "{work} {released} {error}");
    assert!(relaxed > 0.0 && (relaxed + energy).abs() < 1e-9 * relaxed, "{relaxed} {energy}");
}

/// A crack that runs away under a fixed load: after as many equilibria as a load step may have the line ends with a warning, and a run lets the
/// crack run.
#[test]
fn a_crack_that_runs_away_is_left_to_a_run() {
    let lines = "compute s all statics\ncompute d all damage/atom\ncompute most all reduce ave c_d\n\
                 thermo_style custom step time pe ke c_most\nstatics 8 most 3\nprint \"left $(c_s[6]) $(c_most)\"\n\
                 unfix base\nunfix pull\nfix base lo setforce 0 0 0\nfix pull hi setforce 0 0 0\ntimestep 2e-8\nrun 400\nprint \"ran $(c_most) $(ke)\"";
    let text = run(&deck(PMB, "2.0e-4", lines));
    assert!(text.contains("bonds still break after 3 equilibria"), "{text}");
    let (left, ran) = (printed(&text, "left "), printed(&text, "ran "));
    assert!(left[0] > 0.0 && ran[0] > 2.0 * left[1] && ran[1] > 0.0, "{left:?} {ran:?}");
}
