//! Pages of the step table: thermo, thermo_style, thermo_modify.

use super::Entry;
use crate::graph::thermo::words::{Interval, Modify, Style};
use perigrain_styles::Doc;
use perigrain_styles::words::{Forms, Syntax, Words};

pub(super) const THERMO: Entry = (
    "thermo",
    Doc {
        syntax: Syntax::Behind(Interval::GRAMMAR),
        summary: "Prints a row of the step table every N steps.",
        text: "The columns are those of `thermo_style`; `thermo_modify` sets how they look.",
        example: "thermo 2",
    },
);

pub(super) const THERMO_STYLE: Entry = (
    "thermo_style",
    Doc {
        syntax: Syntax::Forms(Style::FORMS),
        summary: "Chooses the columns of the step table.",
        text: COLUMNS,
        example: "compute d all reduce max c_dmg\n\
            variable height equal xcm(ball,z)\n\
            thermo_style custom step time dt pe ke etotal press c_d c_thermo_press[*] v_height",
    },
);

const COLUMNS: &str = "Where the box follows the particles `one`, `multi` and `yaml` show `vol` too. A new \
    `thermo_style` forgets formats, names and `norm` given before.\n\n\
    Columns of `custom`:\n\n\
    - steps and time: `step`, `elapsed` (steps of this run), `elaplong` (steps since `run … start`), `dt`, `time`, `cpu` \
    (seconds of this run), `tpcpu` (simulated time per second), `spcpu` (steps per second), `cpuremain` (seconds left), \
    `timeremain` (seconds left by `timer timeout`, 0 without), `part` (0);\n\
    - energy, over all particles: `pe` (potential, with that of fixes with `fix_modify energy yes`), `ke`, `etotal` (their sum), \
    `ecouple` (taken by fixes langevin that tally it), `econserve` (etotal + ecouple), `enthalpy` (etotal + press·vol), `evdwl` and `epair` (of the pair style);\n\
    - `temp`, `press`, `pxx pyy pzz pxy pxz pyz`, by the computes `thermo_temp` and `thermo_press` or those `thermo_modify` \
    names;\n\
    - the scene: `atoms`, `vol`, `density`, box `lx ly lz xlo xhi ylo yhi zlo zhi cella cellb cellc cellalpha cellbeta \
    cellgamma` (angles 90), its edges `avecx avecy avecz bvecx bvecy bvecz cvecx cvecy cvecz`, `xy xz yz` (0), the spacings \
    of the lattice `xlat ylat zlat`, `fmax` (largest force component), `fnorm` (root of the sum of squared force \
    components), `nbuild` and `ndanger` (neighbour lists built, and built perhaps too late);\n\
    - bonds between particles: `bonds`, their number (under `compat lammps` with those that have been lost with both ends), and `ebond` = `emol`, their energy;\n\
    - always 0 here, for LAMMPS' decks: `ecoul eangle edihed eimp elong etail angles dihedrals impropers`;\n\
    - `c_ID`, `c_ID[i]`, `c_ID[i][j]` of a compute, `f_ID …` of a fix, `v_NAME` of an equal-style variable; `c_ID[*]` and \
    `c_ID[2*3]` stand for one column per element.\n\n\
    Values per particle have to go through `compute reduce`.";

pub(super) const THERMO_MODIFY: Entry = (
    "thermo_modify",
    Doc {
        syntax: Syntax::Behind(Modify::GRAMMAR),
        summary: "Sets how the step table looks and what it uses.",
        text: "With `energy error` a run ends where energy has been made from nothing, mostly by a \
            time step that is too long. That is a mean speed beyond 10 times that of waves, by the stiffness of bonds and contacts, \
            and 1000 times that at the run's beginning; among peridynamic solids on which no fix does work also a kinetic energy of 10⁶ \
            times all energy at the beginning, if a row has shown it. It is checked with each row and every 1000 steps.\n\n\
            Formats and names belong to the present columns: put the line behind `thermo_style`.",
        example: "thermo_style custom step pe ke\nthermo_modify norm no flush yes format float %20.12g format step %8d colname pe energy",
    },
);
