//! What command lines are taken for.

use super::*;

fn read(line: &str) -> Result<Options, Usage> {
    parse(line.split_whitespace().map(String::from).collect())
}

#[test]
fn a_deck_is_a_file_a_switch_or_standard_input() {
    assert_eq!(read("in.plate").unwrap().deck, Deck::File("in.plate".into()));
    assert_eq!(read("-i in.plate").unwrap().deck, Deck::File("in.plate".into()));
    assert_eq!(read("").unwrap().deck, Deck::Stdin);
    assert!(read("in.plate in.other").is_err());
    assert!(read("in.plate -in in.other").is_err());
}

#[test]
fn lammps_switches_are_understood_long_and_short() {
    assert_eq!(read("a --threads 3 --var v 1"), read("a -threads 3 -var v 1"));
    let long = read("-in a -log none -screen s.txt -echo both -nocite -suffix omp -package omp 3").unwrap();
    let short = read("-i a -l none -sc s.txt -e both -nc -sf omp -pk omp 3 neigh yes").unwrap();
    assert_eq!(long, short);
    assert_eq!(long.log, Target::None);
    assert_eq!(long.screen, Target::File("s.txt".into()));
    assert_eq!(long.threads, Some(3));
    assert_eq!(read("a -pk omp 0").unwrap().threads, None);
}

#[test]
fn variables_take_all_words_up_to_the_next_switch() {
    let o = read("in.x -var v 35 70 -var depth -1e-3 -v t a-b -threads 2").unwrap();
    let vars: Vec<(&str, String)> = o.vars.iter().map(|(n, v)| (n.as_str(), v.join(","))).collect();
    assert_eq!(vars, [("v", "35,70".into()), ("depth", "-1e-3".into()), ("t", "a-b".into())]);
    assert_eq!(o.threads, Some(2));
}

#[test]
fn what_is_not_understood_is_named_with_the_nearest() {
    let usage = read("-thread 2").unwrap_err();
    assert_eq!(usage.help.as_deref(), Some("did you mean `-threads`?"));
    assert_eq!(read("-echo scren").unwrap_err().help.as_deref(), Some("did you mean `-echo screen`?"));
    for line in
        ["-in", "-var v", "-var a:b 1", "-threads 0", "-threads two", "-compat hoomd", "-sf gpu", "-pk gpu 1"]
    {
        assert!(read(line).is_err(), "{line}");
    }
    let help = read("a -compat lammps/2024").unwrap_err().help.unwrap();
    assert!(help.contains("lammps/2026"), "{help}");
    for (word, compat) in [
        ("lammps", Compat::Lammps2026),
        ("lammps/2025", Compat::Lammps2025),
        ("lammps/2026", Compat::Lammps2026),
    ] {
        assert_eq!(read(&format!("a -compat {word}")).unwrap().compat, compat);
    }
    assert!(read("a -compat none").is_err());
    assert_eq!(read("a -p 2x1 3 -ps none").unwrap().partition, [1, 1, 3]);
    assert!(read("-reorder nth 2").unwrap_err().message.contains("LAMMPS"));
    for switch in ["-r", "-restart2data", "-r2dump"] {
        assert!(read(&format!("{switch} a b")).unwrap_err().help.unwrap().contains("write_data"), "{switch}");
    }
}

#[test]
fn limits_have_names_and_close_the_gate() {
    let o = read("a -limit steps 5e3 -safe -limit memory 100").unwrap();
    assert_eq!(o.safe, Some(Limits { steps: 5000, memory: 100, ..Limits::default() }));
    assert_eq!((read("a -safe").unwrap().safe, read("a").unwrap().safe), (Some(Limits::default()), None));
    for line in ["a -limit", "a -limit steps", "a -limit steps 0", "a -limit time 5", "a -limit lines 1.5"] {
        assert!(read(line).is_err(), "{line}");
    }
}

#[test]
fn hidden_switches_choose_a_path_and_stay_out_of_the_help() {
    let o = read("a -layout list -rest full -portable").unwrap();
    assert!(o.list_layout && o.no_skipping && o.portable);
    let o = read("a -layout auto -rest skip").unwrap();
    assert!(!o.list_layout && !o.no_skipping && !o.portable);
    assert!(read("a -layout lattice").is_err());
}
