//! The page about wall time against error.

use super::Entry;
use perigrain_styles::Doc;
use perigrain_styles::words::Syntax;

pub(super) const BENCH: Entry = (
    "bench",
    Doc {
        syntax: Syntax::Written(
            "perigrain bench DECK -each NAME VALUE… … -measure WORD… [-against finest [NAME…]|file FILE|form FORM…] [-norm NORM] [-repeat N] [-threads N…] [SWITCH…]\n\
            perigrain bench -suite [-list] [-only PATTERN] [-deck] [-lammps PATH] [-threads N] [-repeat N] [-out DIR] [-anew] [-markdown FILE]",
        ),
        summary: "A deck over knobs such as time step and spacing: wall time against error, observed orders, the Pareto front.",
        text: TEXT,
        example: "perigrain bench in.ball -each dt 0.04 0.02 0.01 0.005 -measure ke v_height\n\
            perigrain bench in.ball -each dt 0.04 0.02 0.01 -measure v_height -against form cos(0.4) -norm end -repeat 2 -out closed\n\
            perigrain bench in.ball -threads 1 2 -each dt 0.04 0.02 0.01 -measure ke -norm rel-l2 -out threads\n\
            perigrain bench -suite -only hertz_impact -markdown hertz.md",
    },
);

const TEXT: &str = "Which time step, spacing, horizon, law or scheme gives the wanted error in the least time? `bench` runs the deck once for each \
    setting of its knobs, one run at a time (`-jobs N` changes that, and so does `mpirun -n N` or `-ranks N`, where each rank makes one at a time; runs on one machine disturb each other's times), and says of each how long its steps took, how far each measure is off, and by \
    which power of the knob errors fall. How to choose is explained in [Weigh time against error](../howto/bench.md); results of the suite on one machine are in [Benchmarks](../benchmarks.md).\n\n\
    **Knobs** are variables of the deck, given as for [sweep](sweep.md): `-each NAME VALUE…` (ranges too), several for all combinations, `-zip` for lists that go in step, `-table FILE`, or the deck's own `sweep` line. \
    Values go from coarse to fine: the last one of a list is its finest. `-threads 1 2 4` and `-layout list auto` are knobs of the program.\n\n\
    **Measures** (`-measure`) are words of thermo output, `c_ID[N]`, `f_ID`, `v_name`, or formulas of them. What the step table of the deck lacks is added to it, so that each has a row wherever the deck's `thermo` has one.\n\n\
    **References** (`-against`):\n\n\
    - `finest` (the default): the run with the last value of each knob; `finest dt` takes only the last `dt`, and the other knobs as they are, so that each law has its own reference. Switches of the program have their first value;\n\
    - `form FORM…`: for each measure a number, a formula, or a word of the deck such as `v_exact`, which may change over time;\n\
    - `file FILE`: a table with a line of names, `time` and the measures among them, or a log of LAMMPS or perigrain whose step table has `time`.\n\n\
    **Norms** (`-norm`): `rel` (the default) and `end` compare the values at the end; `max`, `l1` (mean) and `l2` (root of the mean square) the rows of the step table. `rel` and `rel-max`, `rel-l1`, `rel-l2` are parts of the same norm of the reference. \
    Series are compared at the times of the one with fewer rows; where the other has no row, a cubic through four is taken, so let rows be at the same times. Series that end at other times are refused.\n\n\
    **Orders** are slopes over three settings along a knob, log against log, positive where the error falls along the list; `~` marks one whose two halves differ by more than a half, as where one error is small by chance. Where the reference is itself a run along that knob, errors are C (hᵖ − h_refᵖ), and p is solved from that; then the reference counts as one of the three.\n\n\
    **Times** are wall times of the steps, setups not included. A setting is run until its runs have taken 50 ms together (100 runs at most), `-repeat N` runs it N times; all settings come once before the second turn, and the least time counts.\n\n\
    In the folder (`-out DIR`, else the deck's name with `.bench`) are `bench.csv` with all numbers, a picture of time against error for each measure as SVG and PNG with the Pareto front in rings, `table.csv`, and the runs' own folders as sweep makes them, each with \
    `series.csv`. The terminal shows table and pictures. Stopped or killed at any moment, the same command continues; `-anew` begins anew, `-status` prints the state.\n\n\
    A knob that the deck does not read and a measure that it does not have are named with their place and left out; runs that fail, a reference that is missing or has another length are named, too. The rest continues, and the exit code is 1.\n\n\
    `-suite` runs the benches that the program carries: impacts, a peridynamic wave, the moduli of a patch, a ball on a plate, beds, a cantilever and a wave of bonds, a running crack, spheres in shear, each with one thread unless `-threads` says otherwise. \
    `-lammps PATH` lets a LAMMPS run the same decks where it can, and compares times and numbers; `-markdown FILE` writes the page, its pictures in a folder beside it; `-list`, `-only` and `-deck` are as in [verify](verify.md).\n\n\
    `-scaling` measures a solid and a bed on this machine, on a thread, on two, and on two ranks, and forecasts a step on many machines: `-cores N` of each (64), `-memory GB` of each (what is free here), `-bandwidth GB` and `-latency US` of what connects \
    them (20 and 2; `mpirun perigrain ranks` measures both), `-repeat N` (3). [Forecast on many machines](../scaling.md) says what it counts.";
