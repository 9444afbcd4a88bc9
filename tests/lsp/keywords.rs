//! Keywords at the ends of lines, as LAMMPS' manual and our pages list them: said here by hand, not taken from the declarations.

use super::{labels, start};
use serde_json::json;

/// What stands above each line.
const ABOVE: &str = "\
units lj
atom_style hybrid sphere peri
region low block 0 1 0 1 0 1
create_box 2 low
group bottom region low
compute chunks all chunk/atom bin/1d z lower 1.0
compute t all temp
fix move all nve
dump d all custom 10 d.txt id x
dump p all image 10 p_*.png type type
";

/// A line, and keywords that may follow.
const LINES: &[(&str, &str)] = &[
    (
        "fix 1 all ave/histo 1 1 10 0 1 10 vx",
        "mode kind ave start beyond file append overwrite title1 title2 title3",
    ),
    (
        "fix 1 all ave/histo 1 1 10 0 1 10 vx mode vector",
        "kind ave start beyond file append overwrite title1",
    ),
    ("fix 1 all ave/time 1 1 10 c_t", "mode ave start off format file append overwrite title1 title2 title3"),
    ("fix 1 all ave/time 1 1 10 c_t off 1", "mode ave start off format file"),
    (
        "fix 1 all ave/chunk 1 1 10 chunks vx",
        "norm ave adof cdof bias format file append overwrite title1 title2 title3",
    ),
    ("fix 1 all rigid single", "force torque reinit infile gravity"),
    ("fix 1 all rigid/small molecule", "reinit infile mol gravity"),
    ("fix 1 all deform 1 x scale 2.0", "y z xy xz yz remap flip units"),
    ("fix 1 all move linear 1 0 0", "units"),
    ("fix 1 all langevin 1.0 1.0 0.1 4711", "angmom omega scale tally zero"),
    ("fix 1 all addforce 1 0 0", "every region energy"),
    ("fix 1 all indent 10.0 sphere 0 0 0 1.0", "side units"),
    ("fix 1 all gravity 1.0 vector 0 0 -1", "disable"),
    ("fix 1 all pour 10 1 4711", "region diam id vol rate dens vel mol molfrac rigid"),
    (
        "fix 1 all deposit 10 1 10 4711",
        "region id global local near attempt rate vx vy vz target units mol molfrac rigid",
    ),
    ("fix 1 all wall/gran hooke 1 NULL 1 NULL 0.5 0 zplane 0 NULL", "wiggle shear contacts temperature"),
    ("fix 1 all print 10 text", "file append screen title"),
    ("fix 1 all halt 10 v_x > 1", "error message path"),
    ("fix 1 all adapt 1 atom diameter v_d", "reset scale mass"),
    ("fix 1 all efield 1 0 0", "region energy"),
    ("fix 1 all nve/sphere", "update disc"),
    ("fix 1 all momentum 1", "linear angular rescale"),
    ("fix 1 all recenter INIT INIT INIT", "shift units"),
    (
        "compute 1 all chunk/atom bin/1d z lower 1.0",
        "region nchunk limit ids compress discard bound pbc units",
    ),
    ("compute 1 all reduce max vx", "replace inputs"),
    ("compute 1 all erotate/sphere", ""),
    ("thermo_modify", "lost lost/bond warn norm flush line colname format temp press energy"),
    ("thermo_modify norm yes", "lost warn flush line colname format temp press"),
    ("thermo_modify format", "line int float none"),
    ("thermo_style", "one multi yaml custom"),
    ("thermo_style custom step", "step elapsed dt time temp press pe ke etotal vol lx c_t"),
    (
        "dump_modify d",
        "append buffer every every/time first flush format header maxfiles pad region skip sort thresh time units",
    ),
    ("dump_modify p", "acolor adiam backcolor boxcolor"),
    ("dump 1 all image 10 p.png type type", "adiam atom axes box center fsaa shiny size ssao up view zoom"),
    ("min_modify", "dmax line norm integrator"),
    (
        "min_modify dmax 0.1",
        "line norm integrator tmax tmin delaystep dtgrow dtshrink alpha0 alphashrink halfstepback initialdelay vdfmax",
    ),
    ("neigh_modify delay 0", "every check once cluster include exclude page one binsize"),
    ("velocity all create 1.0 4711", "dist sum mom rot temp bias loop rigid units"),
    ("velocity all set 0 0 0", "sum units"),
    ("create_atoms 1 region low", "mol basis ratio subset var set rotate units"),
    ("displace_atoms all move 0 0 1", "units"),
    ("read_data a.data", "add offset shift extra/atom/types group nocoeff fix"),
    ("read_dump a.dump 0 x y", "vx fx ix box replace purge trim add label scaled wrapped format"),
    ("rerun a.dump", "first last every skip start stop dump"),
    ("rerun a.dump first 10 dump x", "y z vx box replace format"),
    ("write_data a.data", "nocoeff nofix types"),
    ("change_box all", "x y z xy xz yz boundary remap units"),
    ("delete_atoms overlap 0.5 all all", "compress bond mol"),
    ("set type 1", "type mol diameter density mass x y z omega"),
    ("run 100", "upto start stop pre post every"),
    ("run 100 pre no", "upto start stop post every"),
    ("print text", "file append screen universe"),
    ("timer", "off loop normal full sync nosync timeout every"),
    (
        "info",
        "out all configuration memory communication system coeffs groups regions computes dumps fixes variables time styles",
    ),
    ("info out", "screen log append overwrite"),
    ("pair_modify", "pair mix shift tail table compute"),
    ("pair_modify mix", "geometric arithmetic sixthpower"),
    ("compute_modify t", "extra/dof extra dynamic/dof dynamic"),
    ("fix_modify move", "energy virial respa"),
    ("atom_style", "atomic sphere peri bond angle molecular full charge dipole bpm/sphere hybrid"),
    ("atom_style hybrid sphere", "peri bond charge"),
    ("angle_style", "zero none"),
    ("bond_style", "none harmonic bpm/rotational zero hybrid"),
    ("pair_style", "none granular peri/pmb soft hybrid hybrid/overlay"),
    ("fix 1 all", "nve viscous setforce ave/time"),
    ("fix 1", "all bottom"),
    ("compute 1 all", "temp reduce pressure"),
    ("dump 1 all", "atom custom image"),
    ("unfix", "move"),
    ("uncompute", "t chunks"),
    ("undump", "d p"),
    ("echo", "none screen log both"),
    ("log", "none"),
    ("compat", "none lammps lammps/2025 lammps/2026"),
    ("suffix", "off on hybrid gpu intel kk omp opt"),
    ("suffix hybrid", "gpu intel kk omp opt"),
    ("package", "gpu intel kokkos omp opt"),
    ("comm_style", "brick tiled"),
    ("partition", "yes no"),
    ("sweep each v 1 2", "each zip table report"),
    ("read_restart a.restart", "remap"),
];

#[test]
fn every_keyword_is_offered_where_it_may_stand() {
    let (mut client, server) = start();
    let uri = "file:///nowhere/in.keywords";
    let mut wrong = vec![];
    for (line, wanted) in LINES {
        let text = format!("{ABOVE}{line} ");
        client.open(uri, &text);
        let found = client.at("textDocument/completion", uri, &text, &format!("\n{line} ^"), json!({}));
        let labels = labels(&found);
        let missing: Vec<&str> = wanted.split(' ').filter(|w| !w.is_empty() && !labels.contains(w)).collect();
        if !missing.is_empty() {
            wrong.push(format!("{line}: {missing:?} of {labels:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    client.end(server);
}
