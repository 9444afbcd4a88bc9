//! The page about decks of LIGGGHTS.

use super::Entry;
use perigrain_styles::Doc;
use perigrain_styles::words::Syntax;

pub(super) const LIGGGHTS: Entry = (
    "liggghts",
    Doc {
        syntax: Syntax::Written(
            "perigrain DECK [-compat liggghts]\n\
            perigrain translate IN [-o OUT] [-to perigrain|lammps]",
        ),
        summary: "Decks of LIGGGHTS: recognised by their words, read as native lines, rewritten on request.",
        text: TEXT,
        example: "perigrain in.grains\n\
            perigrain check in.grains\n\
            perigrain translate in.grains -o in.native\n\
            perigrain in.native",
    },
);

const TEXT: &str = "A deck with a word that only LIGGGHTS has (`atom_style granular`, `communicate`, `hard_particles`, \
    `soft_particles`, `pair_style gran`, `fix property/global`, `particletemplate/sphere`, `insert/stream`, `mesh/surface`, \
    `wall/gran model`, `check/timestep/gran`, `dump custom/vtk` …) is one of LIGGGHTS from there on; the note PG0305 says so. \
    `-compat liggghts` or `compat liggghts` does it from the first line, `compat none` above the word forbids it. Each line becomes \
    native lines, and messages point at the words of the deck. `translate` prints them, each below its line as a comment; variables \
    and loops stay.\n\n\
    What lines become:\n\n\
    - `property/global`: a table; before a run it becomes `pair_coeff` lines, and again when a property has changed;\n\
    - `pair_style gran model hertz|hooke|hertz/stiffness|hooke/stiffness|hooke/hysteresis`: `pair_style granular` with \
    `hertz/material`, `hooke/velocity`, `hertz`, `hooke`; `tangential history` with `slip spring`; `limitForce` is \
    `limit_damping`;\n\
    - `rolling_friction cdt|epsd|epsd2|epsd3`, `cohesion sjkr|sjkr2`: `rolling`, `cohesion` of pair_coeff;\n\
    - `wall/gran model … primitive type T`: `wall/gran coeff T`; `… mesh`: `wall/mesh coeff T of` surfaces;\n\
    - `mesh/surface`, also `/stress`, `/planar`, `/stress/servo`: `fix surface`; `move` is `shift`, `rotate` is `turn`, \
    `surface_vel` is `speed`, `surface_ang_vel` is `spin`, `reference_point` is `about`;\n\
    - `particletemplate/sphere` with `particledistribution/discrete`: `mixture`, with shares of the mass, or of the number behind \
    `/numberbased`;\n\
    - `particletemplate/multisphere`: `clump`, and `mol` of a mixture; `fix multisphere`: `fix rigid/small` of these templates, with \
    `neigh_modify exclude molecule/intra all`; `ke/multisphere`, `erotate/multisphere`, `compute rigid property`: `ke/rigid`, \
    `erotate/rigid`, `rigid/local`;\n\
    - `region mesh/tet`: `region mesh`; `region wedge`: `region intersect` of a cylinder and half-spaces;\n\
    - `insert/pack`, `insert/rate/region`, `insert/stream`: `fix insert` with `pack`, `rate`, `stream`;\n\
    - `heat/gran`, `heat/gran/conduction`: `fix property/atom temperature initial T`, `fix heat/flow … source`, and `heat contact` of \
    pair_coeff; `set … property/atom Temp|heatSource` sets these properties, `f_Temp[0]`, `f_heatFlux[0]`, `f_heatSource[0]` are \
    computes;\n\
    - `check/timestep/gran`: `fix dt/grain`; `dump custom/vtk`: `dump vtk`; `dump mesh/gran/VTK`: `dump mesh/vtk`;\n\
    - walls, `pour` and pair styles with numbers, as before LIGGGHTS 3: those of LAMMPS.\n\n\
    Words about processes and neighbour lists have a note that they change nothing. Words without counterpart (superquadrics, \
    fluids, coupled programs, bonds of forks) are refused by name, PG0148, with what comes nearest. \
    [Coming from LIGGGHTS](../coming-from-liggghts.md) lists what differs.";
